"""A column as data, for the two references `transfer` and `elements`. Nothing here is the program's.

With y(x, t) = Re y(x) e^(λt) a `Beam` states, for every δy,

    ∫ [EI (1 + α λ) y'' δy'' + (λ² r − N) y' δy' + (λ² m + λ c + k) y δy + (λ g + h) y' δy] dx + Σ terms = 0,

x in [0, 1], all nondimensional. N > 0 is compression (V = −∫N y'²/2). With `shear` s it is Timoshenko's beam,

    ∫ [EI (1 + α λ) ψ' δψ' + s (1 + α λ)(y' − ψ)(δy' − δψ) − N y' δy' + (λ² m + λ c + k) y δy + λ² r ψ δψ] dx + ...,

where r is the rotary inertia and the kinds "slope" and "jump slope" below mean ψ; the kind "dy" is y'.
Numbers are fractions, so that each reference takes them at its own precision.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction as Q
from typing import Any

Of_x = Callable[[Any], Any]
Of_load = Callable[[Any], Any]
Of_both = Callable[[Any, Any], Any]


def one(x: Any) -> Any:
    return 1 + 0 * x


def zero(x: Any) -> Any:
    return 0 * x


def uniform(value: Any, x: Any) -> Any:
    return 0 * x + value


def root(value: Q, like: Any) -> Any:
    """√value with the digits of `like`."""
    return (0 * like + value) ** 0.5


def nothing(x: Any, P: Any) -> Any:
    return 0 * x


def exp(x: Any) -> Any:
    """Of a series or of a float, whichever the reference gives."""
    return x.exp() if hasattr(x, "exp") else math.exp(x)


@dataclass(frozen=True)
class Segment:
    """Coefficients between two breaks: functions of x, and of the load where that may enter."""

    low: Q = Q(0)
    high: Q = Q(1)
    EI: Of_x = one
    mass: Of_x = one
    rotary: Of_x = zero
    axial: Of_both = nothing
    damping: Of_x = zero
    spring: Of_x = zero
    gyro: Of_both = nothing
    flow: Of_both = nothing


@dataclass(frozen=True)
class At:
    """What a term sees or moves: "y", "slope", "dy", "jump y", "jump slope" at a place, or "q", the coordinate `place`.

    Where something jumps, side −1 is just left and +1 just right of it."""

    kind: str
    place: Q = Q(0)
    side: int = -1


@dataclass(frozen=True)
class Term:
    """(λ² mass + λ damping + stiffness(P)) · (what `sees` sees) · δ(what `moves` moves), on the left-hand side."""

    moves: At
    sees: At
    mass: Q = Q(0)
    damping: Q = Q(0)
    stiffness: Of_load = lambda P: 0


def energy(form: Sequence[tuple[At, int]], mass: Q = Q(0), damping: Q = Q(0), spring: Q = Q(0)) -> tuple[Term, ...]:
    """Terms of mass·u̇²/2, damping·u̇²/2 and spring·u²/2, where u sums what `form` names, each with its factor."""
    return tuple(
        Term(a, b, mass * i * j, damping * i * j, lambda P, k=spring * i * j: k) for a, i in form for b, j in form
    )


@dataclass(frozen=True)
class Beam:
    """`rigid` counts motions that cost no energy and feel no load: 1, y = 1; 2, also y = x. They are left out."""

    segments: tuple[Segment, ...] = (Segment(),)
    ends: tuple[str, str] = ("clamped", "free")
    terms: tuple[Term, ...] = ()
    alpha: Q = Q(0)
    rigid: int = 0
    shear: Q | None = None

    @property
    def sights(self) -> list[At]:
        """Everything that a term sees or moves, each once."""
        return list(dict.fromkeys(at for term in self.terms for at in (term.moves, term.sees)))

    @property
    def damped(self) -> bool:
        """Whether a rate enters, so that λ and not λ² is the eigenvalue."""
        rates = any(s.damping is not zero or s.gyro is not nothing for s in self.segments)
        return rates or self.alpha != 0 or any(term.damping for term in self.terms)


def follower(place: Q = Q(1), sees: str = "slope", share: Of_load = lambda P: P) -> Term:
    """δW = −share(P) y'(place) δy(place): a compressive force that turns with the tangent."""
    return Term(At("y", place), At(sees, place), stiffness=share)
