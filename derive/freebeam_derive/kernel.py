"""The kernel graph of a column: what is emitted for it, and what a basis, the trial functions, must give for that.

A basis is one file in bases/ and a template of the same name in emit/. The file lowers the bilinear forms to programs,
in SymPy and neutral between languages; the template writes them; `measured` compares what was written with a route
that uses nothing of them.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from types import ModuleType
from typing import Any, ClassVar, Protocol

from sympy import Expr

from freebeam_derive.newmark import Newmark
from freebeam_derive.ritz import RitzSystem
from freebeam_derive.statement import Column, Parameter
from freebeam_derive.units import Quantity
from freebeam_derive.variation import EquationOfMotion

Progress = Callable[[str], None]

MATRICES = (
    ("mass", "M", "Eq. (11), first line"),
    ("stiffness_elastic", "E", "Eq. (11), third line at zero load"),
    ("stiffness_load", "H", "Eq. (11), third line, divided by the load; Eq. (13)"),
)


@dataclass(frozen=True)
class Figure:
    """A measured error: what, where it was largest, how large, and the bound that it must keep."""

    what: str
    where: str
    error: float
    bound: float


@dataclass(frozen=True)
class Program:
    """What is computed for one matrix: the function's name, the matrix's letter, its form as text, its equation."""

    name: str
    letter: str
    text: str
    equation: str


class Facts(Protocol):
    """What a module says of its column; a Column is one."""

    @property
    def name(self) -> str: ...
    @property
    def title(self) -> str: ...
    @property
    def module(self) -> str: ...
    @property
    def parameters(self) -> tuple[Parameter, ...]: ...
    @property
    def damping(self) -> tuple[str, ...]: ...
    @property
    def quantities(self) -> Mapping[str, Quantity]: ...
    @property
    def scales(self) -> Mapping[str, Expr]: ...
    @property
    def source(self) -> str: ...
    @property
    def basis(self) -> str: ...
    @property
    def modes(self) -> int: ...
    @property
    def ends(self) -> Any: ...
    def supports(self, name: str) -> tuple[str, str]: ...


@dataclass(frozen=True)
class Kernel(ABC):
    """What is emitted for a column, in any basis: the protocol that each basis fills.

    basis_name: its file in bases/ and its template in emit/. symbols: names of notation.py that its modules explain
    beside the usual.
    """

    basis_name: ClassVar[str]
    symbols: ClassVar[tuple[str, ...]] = ()

    column: Facts
    newmark: Newmark

    @abstractmethod
    def context(self) -> dict[str, Any]:
        """What the template is filled with beside the kernel itself."""

    @abstractmethod
    def cost(self) -> dict[str, int]:
        """Counts for the manifest."""

    @abstractmethod
    def bounds(self) -> dict[str, float]:
        """For the manifest: what the verification measures, and the bound that it keeps."""

    @abstractmethod
    def proven(self, text: str) -> tuple[str, float]:
        """Of what in the emitted NumPy module rounding is bounded by proof (rounding.py), and the bound.

        Raises ArithmeticError or TypeError where there is no proof.
        """

    @abstractmethod
    def measured(self, module: ModuleType, say: Progress) -> Iterator[Figure]:
        """Errors of the emitted module, of its functions and matrices, against the independent route.

        Raises VerificationError for what is no question of size, such as a mode that was skipped.
        """


@dataclass(frozen=True)
class BeamKernel(Kernel):
    """What is emitted for a beam of one span and one field, K = E + P H and C = c_M M + c_E E."""

    column: Column
    motion: EquationOfMotion
    system: RitzSystem
    rigid: tuple[Expr, ...]
    matrices: tuple[Program, ...]

    @property
    @abstractmethod
    def fields(self) -> tuple[tuple[str, str], ...]:
        """What the emitted basis holds, in order: names and meanings."""
