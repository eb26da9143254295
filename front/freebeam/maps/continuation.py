"""Maps of columns beyond the textbook's: a few points searched, what lies between them followed by Newton's method.

The grid is cut into boxes. Corners and centre of a box are searched (`crossings.first_loss`). Where the crossings of
the corners lead to that of the centre, and no eigenvalue comes near the axis at lower loads there, the other points of
the box are followed from the corners, and of each it is counted that nothing grows just below; a point at which that
fails is searched, and a box at which it does is cut in two. A point's answer is thus a crossing of its own matrices, to
all digits. That it is the first is known as far as these signs go: a loss of stability at lower loads that is regained
before the count, and that does not show at the corners and the centre around it, is not seen.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from functools import cached_property
from itertools import product

import numpy as np

from freebeam_sym.question import Question
from freebeam_sym.stability.crossings import first_loss
from freebeam_sym.stability.general import General
from freebeam_sym.stability.problem import Crossing, Real

__all__ = ["continued"]

WIDEST = 8
"""Steps of the grid along a side of a box: of 4, 8 and 12 it took the least time for maps of 30 × 30 (two segments and
one, 16 functions each)."""
AGREE = 1e-9
"""Relative. Loads that Newton's method and a search find of the same crossing differ by less."""
CLOSE_BY = 0.1
"""Relative change of the load up to which Newton's method has stayed with the crossing that it began with."""
FEW = 6
"""Points of a box from which on it takes less time to follow them than to search each."""
BELOW = np.linspace(0.1, 0.9, 9)
LOWEST = 8
"""Parts of a critical load at which the lowest eigenvalues are looked at, and how many: where one of them comes near
the axis there, a box is cut."""
Index = tuple[int, ...]
Corners = dict[Index, "_Corner"]


def continued(
    ask: Callable[[Index], Question], shape: Index, step: Callable[[float], None] | None = None
) -> dict[Index, Crossing | None]:
    """The first loss of stability at each point of a grid, by its index; None where there is none up to the largest
    load. ask: the question at an index, of one number of functions all over. step: told which part is done."""
    grid = _Grid(ask, step, math.prod(shape))
    grid.fill(tuple(0 for _ in shape), tuple(n - 1 for n in shape))
    return grid.found


class _Corner:
    """A point that was searched. manner: how its problem counts what grows."""

    def __init__(self, question: Question) -> None:
        self.question = question
        problem = question.problem
        self.crossing = first_loss(problem, question.load_max).crossing
        self.manner = problem.manner if isinstance(problem, General) else (True, 0.0)

    @cached_property
    def margins(self) -> Real:
        """What must stay below zero at the loads BELOW the crossing, (loads, 2 LOWEST)."""
        assert self.crossing is not None
        problem, load = self.question.general, self.crossing.load
        return np.array([_margins(problem, share * load, self.manner) for share in BELOW])


class _Grid:
    def __init__(self, ask: Callable[[Index], Question], step: Callable[[float], None] | None, size: int) -> None:
        self.ask, self.step, self.size = ask, step, size
        self.found: dict[Index, Crossing | None] = {}
        self.corners: dict[Index, _Corner] = {}

    def fill(self, low: Index, high: Index) -> None:
        """All points of a box, its faces included."""
        corners = {at: self.corner(at) for at in product(*(sorted({a, b}) for a, b in zip(low, high, strict=True)))}
        inside = [at for at in product(*map(_span, low, high)) if at not in self.found]
        if not inside:
            return
        if len(inside) < FEW:
            for at in inside:
                self.corner(at)
            return
        longest = max(range(len(low)), key=lambda k: high[k] - low[k])
        middle = tuple((a + b) // 2 for a, b in zip(low, high, strict=True))
        if high[longest] - low[longest] <= WIDEST and self.leads(corners, middle, low, high):
            for at in inside:
                found = self.found.get(at) or self.followed(at, corners, low, high)
                if found is None:
                    self.corner(at)
                elif at not in self.found:
                    self.keep(at, found)
            return
        cut = middle[longest]
        self.fill(low, tuple(cut if k == longest else b for k, b in enumerate(high)))
        self.fill(tuple(cut if k == longest else a for k, a in enumerate(low)), high)

    def corner(self, at: Index) -> _Corner:
        if at not in self.corners:
            self.corners[at] = found = _Corner(self.ask(at))
            self.keep(at, found.crossing)
        return self.corners[at]

    def keep(self, at: Index, crossing: Crossing | None) -> None:
        self.found[at] = crossing
        if self.step is not None:
            self.step(len(self.found) / self.size)

    def leads(self, corners: Corners, middle: Index, low: Index, high: Index) -> bool:
        """Whether the crossings of the corners lead to that of the middle."""
        kinds = {(None if c.crossing is None else c.crossing.kind, c.manner) for c in corners.values()}
        kind, (_, threshold) = next(iter(kinds))
        if len(kinds) != 1 or kind is None or threshold:  # growth below the threshold is not counted
            return False
        followed, centre = self.followed(middle, corners, low, high), self.corner(middle)
        if followed is None or centre.crossing is None or not abs(followed.load / centre.crossing.load - 1) < AGREE:
            return False
        shares = [_share(middle, corner, low, high) for corner in corners]
        return _stays_below(np.array([c.margins for c in corners.values()]), np.array(shares), centre.margins)

    def followed(self, at: Index, corners: Corners, low: Index, high: Index) -> Crossing | None:
        """The crossing of a point that those of the corners lead to, where nothing grows just below it."""
        near = _between([(_share(at, corner, low, high), c.crossing) for corner, c in corners.items() if c.crossing])
        question = self.ask(at)
        found = question.general.followed(near, CLOSE_BY, next(iter(corners.values())).manner)
        return found if found is not None and found.load <= question.load_max else None


def _margins(problem: General, load: float, manner: tuple[bool, float]) -> Real:
    """What must stay below zero for stability, (LOWEST,) and as many again: Re λ of the eigenvalues with the least |λ|,
    Im λ ≥ 0; to first order in the damping growth, and by how much each ω² is below the next, relative."""
    found = np.full((2, LOWEST), -np.inf)
    if manner[0]:
        rate, _, growth = problem.branches(load)
        square = rate.imag**2 - rate.real**2
        order = np.argsort(square)[: LOWEST + 1]
        square, growth = square[order], growth[order][:LOWEST]
        gaps = (square[:-1] - square[1:]) / np.abs(square[1:])
        found[0, : len(growth)] = growth if problem.damped else -np.inf
        found[1, : len(gaps)] = gaps
    else:
        theta = np.linalg.eigvals(problem.inverse(load)).astype(complex)
        theta = theta[(theta.imag <= 0) & (theta != 0)]
        lowest = 1 / theta[np.argsort(-np.abs(theta))[:LOWEST]]
        found[0, : len(lowest)] = lowest.real
    return found.ravel()


def _stays_below(corners: Real, shares: Real, centre: Real) -> bool:
    """Whether what is below zero at the corners and the centre of a box stays so between them: by more than twice
    what the centre differs from the corners' mean, and than it bends between two loads."""
    with np.errstate(invalid="ignore"):
        most = np.max([*corners, centre], axis=0) + 2 * np.abs(centre - np.tensordot(shares, corners, 1))
        most[1:-1] += np.abs(np.diff(centre, 2, axis=0)) / 4
    return bool((most[~np.isnan(most)] < 0).all())


def _span(low: int, high: int) -> range:
    return range(low, high + 1)


def _share(at: Index, corner: Index, low: Index, high: Index) -> float:
    """The weight of a corner at a point of a box, linear in each index."""
    parts: Iterator[float] = (
        1 - abs(k - c) / (b - a) if b > a else 1.0 for k, c, a, b in zip(at, corner, low, high, strict=True)
    )
    return math.prod(parts)


def _between(known: list[tuple[float, Crossing]]) -> Crossing:
    """The mean of crossings of one kind, their motions turned alike, by their weights."""
    first = max(known, key=lambda each: each[0])[1]
    load, square, vector = 0.0, 0.0, np.zeros_like(first.vector)
    for share, crossing in known:
        along = complex(first.vector.conj() @ crossing.vector)
        turned = crossing.vector * (along.conjugate() / abs(along) if along else 1.0)
        load, square, vector = (
            load + share * crossing.load,
            square + share * crossing.frequency**2,
            vector + share * turned,
        )
    return Crossing(load, math.sqrt(square), vector, first.kind)
