"""What the lesson says of a column in numbers, each computed when it is first asked for."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from freebeam.lesson.draws import USUAL, Data
from freebeam.maps.known import answer
from freebeam.proofs import enclosed_load, exact_load
from freebeam_sym.checks import InputError
from freebeam_sym.massless import condensed
from freebeam_sym.question import Question
from freebeam_sym.spectra import spectrum
from freebeam_sym.stability.critical import CriticalLoad

if TYPE_CHECKING:
    from freebeam.proofs import Certified
    from freebeam_sym.columns import Coefficients, Column
    from freebeam_sym.stability.pencil import Pencil

__all__ = ["MODES", "Facts"]

MODES = 8
"""Modes of the paper's series, section 3.2."""


@dataclass(frozen=True)
class Facts:
    """Numbers of a column. polynomials: the same column over polynomials. own: its own parameters, all of them where a
    seed has drawn them, else the defaults. data: what the exercises are about, drawn or as usual."""

    column: Column
    polynomials: Column
    own: Mapping[str, Any] = field(default_factory=dict)
    data: Data = USUAL

    @property
    def modes(self) -> int:
        """Number of functions: the paper's eight modes, or of a column of segments what it states."""
        return self.column.number(None) if self.column.general else MODES

    @property
    def values(self) -> dict[str, float]:
        """The column's own parameters."""
        return self.column.own_parameters(dict(self.own))

    @cached_property
    def question(self) -> Question:
        """This number of functions, without damping."""
        return Question.of(self.column, self.modes, **self.own)

    @cached_property
    def critical(self) -> CriticalLoad:
        """Without damping."""
        return answer(self.question)

    @cached_property
    def terms(self) -> Coefficients:
        """M, C and K without damping, by powers of the load."""
        return self.column.coefficients(self.modes, False, **self.own)

    @property
    def damping(self) -> tuple[str, ...]:
        """The dampings that can be asked about: not those that couple rigid motions to the bending."""
        coupled = self.column.kernel.COLUMN.get("coupled", ())
        return tuple(name for name in self.column.damping if name not in coupled)

    @property
    def linear(self) -> bool:
        """Whether the load enters as in K = E + P H."""
        return len(self.terms.M) == 1 and len(self.terms.K) == 2

    @property
    def undamped(self) -> bool:
        """Whether there are no forces with rates at α = β = 0, so that frequencies can meet."""
        return not self.terms.C

    @property
    def flutters(self) -> bool:
        return self.critical.kind == "flutter"

    @property
    def load(self) -> float:
        """The undamped critical load. Raises InputError where there is none."""
        if self.critical.load is None:
            raise InputError(f"{self.column.name}: is stable up to P = {self.question.load_max:g}")
        return self.critical.load

    @property
    def frequency(self) -> float:
        return float(self.critical.frequency or 0.0)

    def limit(self, kappa: float) -> CriticalLoad:
        """The limit of vanishing damping at β = κα."""
        return answer(Question.of(self.column, self.modes, kappa=kappa, **self.own))

    def damped(self, alpha: float, beta: float) -> CriticalLoad:
        """With damping; a damping that the column does not state is left at zero."""
        known = self.damping
        given = {"alpha": alpha, "beta": beta}
        return answer(self.question.at(**{name: value for name, value in given.items() if name in known}))

    @cached_property
    def exact(self) -> Certified | str:
        """The beam itself, undamped, or why it is not enclosed."""
        try:
            own: dict[str, Any] = {name: f"{value:g}" for name, value in self.own.items()}
            if self.column.general:  # where the proof that it is the first takes some seconds, if there is one
                return enclosed_load(self.column, digits=12, **own)
            return exact_load(self.column, digits=12, **own)
        except InputError as error:
            return str(error)

    @cached_property
    def pencil(self) -> Pencil:
        return self.question.pencil

    def operator(self, load: float) -> Any:
        """K at a load in coordinates in which M is the identity, (N, N), fewer where some have no mass: its eigenvalues
        are ω² without damping."""
        if not self.column.general:
            return np.diag(self.pencil.e) + load * self.pencil.H
        M, C, K = (X[None] for X in self.terms.at(load))
        _, _, (M, C, K) = condensed(M, C, K)
        lower = np.linalg.cholesky(M[0])
        return np.linalg.solve(lower, np.linalg.solve(lower, K[0]).T).T

    def squares(self, load: float) -> Any:
        """ω² of the undamped column at a load, ascending in the real part, (N,) complex."""
        found = np.linalg.eigvals(self.operator(load)).astype(complex)
        return found[np.lexsort((found.imag, found.real))]

    def pair(self, load: float) -> tuple[complex, complex]:
        """The two ω² that meet at the critical load, below or above it."""
        s = self.squares(load)
        near = s[np.argsort(np.abs(s - self.frequency**2))[:2]]
        a, b = sorted((complex(v) for v in near), key=lambda v: (v.real, v.imag))
        return a, b

    def overlap(self, load: float) -> float:
        """|cosine| of the angle between the two shapes that meet, in the norm of the mass: 1 where they are one."""
        values, vectors = np.linalg.eig(self.operator(load))
        a, b = np.argsort(np.abs(values - self.frequency**2))[:2]
        u, v = vectors[:, a], vectors[:, b]
        return float(abs(np.vdot(u, v)) / np.linalg.norm(u) / np.linalg.norm(v))

    def growth(self, load: float, alpha: float = 0.0, beta: float = 0.0) -> float:
        """Largest real part of an eigenvalue at a load."""
        return spectrum(self.question.at(alpha=alpha, beta=beta).system(load)).growth_rate

    def ritz(self, modes: int, basis: str = "modes") -> float | None:
        """The undamped critical load at a number of functions; None where another kind of loss comes first."""
        try:
            found = answer(Question.of(self.column if basis == "modes" else self.polynomials, modes, **self.own))
        except InputError:
            return None
        return found.load if found.kind == self.critical.kind else None

    @cached_property
    def beam_load(self) -> float | None:
        """The beam's own critical load, to a float."""
        if isinstance(self.exact, str) or self.exact.load is None:
            return None
        low, high = self.exact.load
        return (float(low) + float(high)) / 2

    @cached_property
    def circulatory(self) -> float:
        """Size of the part of the load's matrix that is not symmetric, relative to the whole of it."""
        if not self.column.general:
            H = self.pencil.H
        else:  # in units of the stiffness, as some coordinate may have no mass
            (*_, E), (*_, K) = self.terms.at(0.0), self.terms.at(1.0)
            size = np.abs(np.diag(E))
            H = (K - E) / np.sqrt(np.outer(*2 * [np.where(size > 0, size, 1.0)]))
        return float(np.abs(H - H.T).max() / np.abs(H).max())
