"""A column in general, as bilinear forms: fields on segments between breaks, discrete coordinates, values at points.

The nondimensional beam is 0 <= x <= 1, cut at breaks into segments 0 … S − 1. Row = test function, column = trial
function. P is the load; alpha, beta the dampings.
"""

from __future__ import annotations

from dataclasses import dataclass

from sympy import Expr

from freebeam_derive.statement import Parameter


@dataclass(frozen=True)
class Value:
    """What a point term sees: a derivative in x of a field at a place, or a coordinate.

    of: name of the field or the coordinate. order: of the derivative. place: in the own parameters, in [0, 1]; None
    for a coordinate. side: −1 or +1 for the limit from the left or the right, 0 where there is no jump.
    """

    of: str
    order: int = 0
    place: Expr | None = None
    side: int = 0


@dataclass(frozen=True)
class Along:
    """∫ factor(x) Dᵖ test D^q trial dx over one segment; a coordinate counts as the function 1, of order 0."""

    segment: int
    test: str
    p: int
    trial: str
    q: int


@dataclass(frozen=True)
class BilinearForm:
    """Factors of integrals, in x and parameters, and of products of point values (test, trial), in parameters."""

    along: dict[Along, Expr]
    points: dict[tuple[Value, Value], Expr]


@dataclass(frozen=True)
class Space:
    """Trial functions of a field: how often they are joined at breaks, and where not.

    joined: 2 where value and slope are continuous (bending), 1 the value alone, 0 neither. held: (end 0 or 1, order)
    that the supports hold at zero. opened: (index of break 1 … S − 1, order) free to jump.
    """

    name: str
    latex: str
    joined: int
    held: frozenset[tuple[int, int]] = frozenset()
    opened: frozenset[tuple[int, int]] = frozenset()


@dataclass(frozen=True)
class GeneralSystem:
    """M q̈ + C q̇ + K q = F_0 Q; every matrix a polynomial in P, its coefficients by the power.

    breaks: 0, …, 1, ascending at the parameters' defaults. coordinates: (name, latex). C: factors linear in alpha and
    beta. force: Q = Σ factor · test value; a place may be x_F. rigid: motions to be deflated, each as
    {(field, segment): polynomial in x of degree 1 at most, (coordinate, None): number}.
    """

    breaks: tuple[Expr, ...]
    spaces: tuple[Space, ...]
    coordinates: tuple[tuple[str, str], ...]
    M: tuple[BilinearForm, ...]
    C: tuple[BilinearForm, ...]
    K: tuple[BilinearForm, ...]
    force: tuple[tuple[Value, Expr], ...] = ()
    rigid: tuple[dict[tuple[str, int | None], Expr], ...] = ()
    parameters: tuple[Parameter, ...] = ()
