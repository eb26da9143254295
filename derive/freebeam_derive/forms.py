"""Any column as matrices: fields on segments, coordinates, and the bilinear forms of M, C and K. Eqs. (9)-(11).

The nondimensional beam 0 ≤ x ≤ 1 is cut at breaks into segments. A form is a sum of integrals along segments and of
products of point values; a matrix is a polynomial in the load P, whose coefficients are forms.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from sympy import Expr

from freebeam_derive.notation import alpha, beta
from freebeam_derive.statement import Parameter


@dataclass(frozen=True)
class Value:
    """What a point term sees: the order-th derivative in x of a field at a place, or a coordinate, whose place is None.

    side: −1 or +1 for the limit from the left or the right, 0 where it is continuous.
    """

    of: str
    order: int = 0
    place: Expr | None = None
    side: int = 0


@dataclass(frozen=True)
class Along:
    """∫ over a segment of factor(x) D^p test D^q trial; a coordinate counts as the function 1."""

    segment: int
    test: str
    p: int
    trial: str
    q: int


@dataclass(frozen=True)
class BilinearForm:
    """A bilinear form: factors of integrals along segments, in x and parameters, and of products of point values."""

    along: dict[Along, Expr] = field(default_factory=dict)
    points: dict[tuple[Value, Value], Expr] = field(default_factory=dict)

    def __bool__(self) -> bool:
        return bool(self.along or self.points)

    @property
    def transposed(self) -> BilinearForm:
        """Test and trial function with their places changed."""
        return BilinearForm(
            {Along(k.segment, k.trial, k.q, k.test, k.p): f for k, f in self.along.items()},
            {(trial, test): f for (test, trial), f in self.points.items()},
        )

    @property
    def symmetric(self) -> bool:
        return self.transposed == self


@dataclass(frozen=True)
class Space:
    """Trial functions of a field: how they are joined at breaks, and where not.

    joined: 2 where value and slope are continuous (bending), 1 the value alone, 0 neither. held: (end, order) that the
    supports hold at zero. opened: (number of the break, order) that is free to jump.
    """

    name: str
    latex: str
    joined: int
    held: frozenset[tuple[int, int]] = frozenset()
    opened: frozenset[tuple[int, int]] = frozenset()


@dataclass(frozen=True)
class GeneralSystem:
    """M q̈ + C q̇ + K q = F_0 Q of any column; M, C and K by powers of the load P, C and K linear in alpha and beta.

    breaks: 0, …, 1, ascending at the parameters' defaults. coordinates: names and LaTeX. force: values of the test
    function that F_0 works on, with their factors. rigid: motions that are left out of the elastic spectrum, each
    {(field, segment) or (coordinate, None): polynomial in x, or number}. coupled: dampings, of "alpha" and "beta", that
    couple these motions to the bending, so that with them they are not left out.
    """

    breaks: tuple[Expr, ...]
    spaces: tuple[Space, ...]
    coordinates: tuple[tuple[str, str], ...]
    M: tuple[BilinearForm, ...]
    C: tuple[BilinearForm, ...]
    K: tuple[BilinearForm, ...]
    force: tuple[tuple[Value, Expr], ...] = ()
    rigid: tuple[dict[tuple[str, Any], Expr], ...] = ()
    parameters: tuple[Parameter, ...] = ()
    coupled: tuple[str, ...] = ()

    @property
    def circulatory(self) -> tuple[str, ...]:
        """Dampings, of "alpha" and "beta", that act on displacements too: K hangs on them."""
        factors = [f for form in self.K for part in (form.along, form.points) for f in part.values()]
        return tuple(str(d) for d in (alpha, beta) if any(f.has(d) for f in factors))
