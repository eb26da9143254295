"""Stability boundaries: the critical load as a curve over one parameter, with the places where its kind changes.

The curve is steered by its tangents (`CriticalLoad.derivative`): two points and their tangents say how far it leaves
the chord between them, and what to find half-way, which is confirmed there by counting what grows just below and just
beyond; only where it leaves the chord or is not confirmed is a point searched. Where the kind changes, tangents say
where: two curves meet, or one turns back, as a root of the distance.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.polynomial import Polynomial
from numpy.typing import NDArray

from freebeam.maps.known import answer
from freebeam_sym.checks import InputError, computable, finite, positive, refusal
from freebeam_sym.columns import Column, is_column
from freebeam_sym.question import Question
from freebeam_sym.stability.critical import CriticalLoad
from freebeam_sym.stability.problem import Kind, Real

__all__ = ["Boundary", "BoundaryEvent", "trace_boundary"]

_PLACED = 1e-10
"""How closely events are placed, relative to the range."""
_CURVED = 1 / 4096
"""Least distance of points that follow the curve alone, relative to the range."""
_HELD = 0.8
"""A change over an interval that a half of it still holds to this share is a jump; a square root has 0.71."""
_SEEN = 1e-3
"""Relative. So far below and beyond a predicted load it is counted what grows there."""
_CLOSER = 0.1
"""How far beyond the place where tangents have an event its other side is looked for, as a share of how far that is
from the nearer end of the interval: where they are right, the interval becomes ten times smaller with each search."""


@dataclass(frozen=True)
class BoundaryEvent:
    """Where the boundary changes its nature, between two neighbouring values of the parameter.

    `what`: such as "flutter to divergence", or "another branch" where flutter of one frequency gives way to flutter of
    another; `value` of the parameter; `load` and `frequency` (before, after), None where no load is found.
    """

    what: str
    value: float
    load: tuple[float | None, float | None]
    frequency: tuple[float | None, float | None]


@dataclass(frozen=True)
class Boundary:
    """First loss of stability over one parameter: `values` ascending, `load`, `frequency` (m,), nan where there is
    none up to the largest load, `kind` (m,) of "none", "flutter" or "divergence", and `events` in the order of `value`.
    Nondimensional. A curve is broken at its events: the two values next to one differ by a rounding only. `points`
    (m,): the answers themselves."""

    parameter: str
    values: Real
    load: Real
    frequency: Real
    kind: NDArray[np.str_]
    events: tuple[BoundaryEvent, ...]
    points: tuple[CriticalLoad, ...] = field(repr=False, compare=False)

    @cached_property
    def slope(self) -> Real:
        """dP/dp along the curve, (m,), p the parameter: of `CriticalLoad.derivative`, from the eigenvectors at each
        point and not from its neighbours; nan where there is no load or no derivative."""
        return np.array([_tangent(point, self.parameter)[0] for point in self.points])

    @cached_property
    def error(self) -> Real:
        """`CriticalLoad.error` of each point, (m,), nan where there is none; computed when first asked for."""
        return np.array([math.nan if point.error is None else point.error for point in self.points])

    @cached_property
    def converged(self) -> NDArray[np.bool_]:
        """`CriticalLoad.converged` of each point, (m,)."""
        return np.array([point.converged for point in self.points])


class _Tracer:
    """Points of a boundary by t, 0 to 1 over the range. value: of the parameter at t, and how fast it changes there."""

    def __init__(
        self, question: Question, parameter: str, value: Callable[[float], tuple[float, float]], tolerance: float
    ):
        self.question, self.parameter, self.value, self.tolerance = question, parameter, value, tolerance
        self.found: dict[float, CriticalLoad] = {}
        self.events: list[tuple[float, float]] = []
        self.beside: set[float] = set()
        self._tangents: dict[float, Real] = {}

    def at(self, t: float) -> Question:
        return self.question.at(**{self.parameter: self.value(t)[0]})

    def ask(self, t: float) -> CriticalLoad:
        if t not in self.found:
            self.found[t] = answer(self.at(t))
        return self.found[t]

    def tangent(self, t: float) -> Real:
        """dP/dt and dω/dt at a point, (2,), nan where there are none."""
        if t not in self._tangents:
            self._tangents[t] = _tangent(self.found[t], self.parameter) * self.value(t)[1]
        return self._tangents[t]

    def follow(self, a: float, b: float, before: float = math.inf) -> None:
        """Points between a and b as the curve needs them. before: the change over the interval that these halve."""
        one, two = self.ask(a), self.ask(b)
        change = _change(one, two)
        if one.kind != two.kind or 1e-3 < change > _HELD * before:
            self.place(a, b)
        elif b - a > _CURVED and not (self.straight(a, b) and self.confirmed(a, b)):
            middle = (a + b) / 2
            self.follow(a, middle, change)
            self.follow(middle, b, change)

    def straight(self, a: float, b: float) -> bool:
        """Whether load and frequency keep to the chord from a to b: by the cubics that have the tangents there, or by a
        point half-way where there are none."""
        one, two = _pair(self.found[a]), _pair(self.found[b])
        moving = (one > 0) & (two > 0)
        low, high = ((b - a) * self.tangent(t) - (two - one) for t in (a, b))
        u = np.array([0.25, 0.5, 0.75])[:, None]
        off = u * (1 - u) * ((1 - u) * low - u * high)
        if not np.isfinite(off[:, moving]).all():
            middle = self.ask((a + b) / 2)
            off = _pair(middle)[None] - (one + two) / 2
            moving &= middle.kind == self.found[a].kind
        return bool((np.abs(off[:, moving] / np.maximum(one, two)[moving]) <= self.tolerance).all())

    def confirmed(self, a: float, b: float) -> bool:
        """Whether the curve from a to b is the first loss of stability between them too: half-way, and at ever smaller
        distances from an end that was looked for beside an event, where others may be near."""
        middle = self.found.get((a + b) / 2)
        if middle is not None and middle.kind != self.found[a].kind:
            return False
        halves = [0.5**k for k in range(2, 32) if 0.5**k * (b - a) > _CURVED]
        left, right = (halves if end in self.beside else [] for end in (a, b))
        shares = [*([0.5] if middle is None else []), *left, *(1 - u for u in right)]
        return all(self.counted(a, b, u) for u in shares)

    def counted(self, a: float, b: float, u: float) -> bool:
        """Whether nothing grows just below what the curve from a to b has at a share u of the way, or below the largest
        load, and something grows just beyond."""
        problem, limit = self.at(a + u * (b - a)).problem, self.question.load_max
        if self.found[a].load is None:
            return not problem.unstable(limit * (1 - _SEEN))
        load = float(self.cubic(a, b, u)[0])
        return not problem.unstable(load * (1 - _SEEN)) and problem.unstable(load * (1 + _SEEN)) > 0

    def cubic(self, a: float, b: float, u: float = 0.5) -> Real:
        """Load and frequency at a share u of the way from a to b; on the chord where there are no tangents."""
        one, two = _pair(self.found[a]), _pair(self.found[b])
        low, high = (np.nan_to_num((b - a) * self.tangent(t) - (two - one)) for t in (a, b))
        return np.asarray(one + u * (two - one) + u * (1 - u) * ((1 - u) * low - u * high))

    def place(self, a: float, b: float) -> None:
        """Close in on a jump or a change of kind between a and b, by where tangents have it or by halves, and follow
        what is left."""
        passed: list[tuple[float, float]] = []
        change, halve = _change(self.found[a], self.found[b]), False
        while b - a > _PLACED and change > 1e-3:
            width, held, middle = b - a, change, (a + b) / 2
            guess = None if halve else self.guess(a, b)
            if guess is not None:
                off = max(_CLOSER * min(guess - a, b - guess), _PLACED / 4)
                middle = guess + (off if guess - a < b - guess else -off)
            self.beside.add(middle)
            if _alike(self.found[a], self.ask(middle), self.found[b]):
                passed.append((a, middle))
                a = middle
            else:
                passed.append((middle, b))
                b = middle
            change = _change(self.found[a], self.found[b])
            if change < _HELD * held:  # no jump, but a slope
                break
            halve = b - a > width / 2
        if b - a <= _PLACED:
            self.events.append((a, b))
        else:
            passed.append((a, b))
        for low, high in sorted(passed):
            self.follow(low, high)

    def guess(self, a: float, b: float) -> float | None:
        """Where the curve from a ends and that from b begins, by their tangents; None where these do not say."""
        places = sorted(self.found)
        before, after = places[max(places.index(a) - 1, 0)], places[min(places.index(b) + 1, len(places) - 1)]
        for end, other in ((a, before), (b, after)):
            turn = self.turn(end, other)
            if a < turn < b:
                return turn
        curves = [self.curve(end, other) for end, other in ((a, before), (b, after))]
        roots = (curves[0] - curves[1]).roots()
        meet = roots.real[(np.abs(roots.imag) < 1e-9) & (roots.real > a) & (roots.real < b)]
        return float(meet[0]) if len(meet) else None

    def turn(self, end: float, other: float) -> float:
        """Where a curve turns back, its load as a root of the distance: 1/slope² goes to zero as a straight line."""
        if end == other or self.found[end].kind != self.found[other].kind:
            return math.nan
        with np.errstate(divide="ignore", invalid="ignore"):
            near, far = 1 / self.tangent(end)[0] ** 2, 1 / self.tangent(other)[0] ** 2
        return float(end + near * (end - other) / (far - near)) if near < far else math.nan

    def curve(self, end: float, other: float) -> Polynomial:
        """The load near an end as a parabola, or a line where there is no other point of its kind; the largest load
        where there is none."""
        found = self.found[end]
        if found.load is None:
            return Polynomial([self.question.load_max])
        slope, bend = float(self.tangent(end)[0]), 0.0
        if end != other and self.found[other].kind == found.kind:
            bend = float(slope - self.tangent(other)[0]) / (end - other)
        if not math.isfinite(slope + bend):
            slope = bend = 0.0
        shifted = Polynomial([-end, 1.0])
        return found.load + slope * shifted + bend / 2 * shifted**2


def trace_boundary(
    column: Column,
    parameter: str,
    low: float,
    high: float,
    *,
    modes: int | None = None,
    log: bool = False,
    tolerance: float = 1e-3,
    load_max: float = 1000.0,
    **fixed: float,
) -> Boundary:
    """Critical load of `column` over `parameter` (alpha, beta or one of its own) from `low` to `high`.

    Points are added where load or frequency leave the straight line between their neighbours by `tolerance`, relative
    (over the logarithm of the parameter with `log`), as their derivatives say; jumps and changes of kind are placed to
    1e-10 of the range. Each point is the first loss of stability, found by itself among all: a branch cannot be
    followed past the place where another takes over. Half-way between points, and closer and closer to an event,
    eigenvalues that grow just below and just beyond the curve are counted. An event and its undoing both inside one of
    the first 32 intervals may be missed.
    `fixed`: the other parameters. Raises InputError for bad values.

    >>> import freebeam as fb
    >>> curve = fb.trace_boundary(fb.column("beck"), "eta", 0.4, 0.6, modes=4, load_max=100)
    >>> [event.what for event in curve.events]
    ['divergence to flutter']
    """
    is_column(column)
    low, high = (computable(name, finite(name, value)) for name, value in (("low", low), ("high", high)))
    if not isinstance(parameter, str):
        raise refusal("parameter", parameter, "must be the name of one, such as 'beta'")
    if parameter not in ("alpha", "beta", *(p.name for p in column.parameters)):
        raise column.no_such(parameter)
    if parameter in fixed:
        raise InputError(f"{parameter} = {fixed[parameter]}: is the parameter that is traced; it cannot be fixed too")
    if not low < high:
        raise InputError(f"low = {low}, high = {high}: low must be below high")
    if log and low <= 0:
        raise InputError(f"low = {low}: must be above zero on a logarithmic scale; or leave log out")
    tolerance = positive("tolerance", tolerance, "relative, of load and frequency")
    question = Question.of(column, modes, load_max=load_max, **fixed)

    def value(t: float) -> tuple[float, float]:
        x = low * (high / low) ** t if log else low + (high - low) * t
        return min(max(x, low), high), x * math.log(high / low) if log else high - low

    tracer = _Tracer(question, parameter, value, tolerance)
    for a, b in pairwise(np.linspace(0.0, 1.0, 33).tolist()):
        tracer.follow(a, b)
    places = sorted(tracer.found)
    points = [tracer.found[t] for t in places]
    return Boundary(
        parameter,
        np.array([value(t)[0] for t in places]),
        np.array([_pair(point)[0] for point in points]),
        np.array([_pair(point)[1] for point in points]),
        np.array([p.kind for p in points]),
        tuple(_event(value((a + b) / 2)[0], tracer.found[a], tracer.found[b]) for a, b in sorted(tracer.events)),
        tuple(points),
    )


def _change(one: CriticalLoad, two: CriticalLoad) -> float:
    """Relative change of load or frequency, the greater; inf where the kind changes."""
    if one.kind != two.kind:
        return math.inf
    return max(
        (abs(x - y) / max(x, y) for x, y in ((one.load, two.load), (one.frequency, two.frequency)) if x and y),
        default=0.0,
    )


def _alike(one: CriticalLoad, between: CriticalLoad, two: CriticalLoad) -> bool:
    """Whether what lies between two points that are unlike is of the first one's curve."""
    if one.kind != two.kind:
        return between.kind == one.kind
    return _change(one, between) < _change(between, two)


def _pair(point: CriticalLoad) -> Real:
    """Load and frequency, (2,), nan where there are none."""
    return np.array([math.nan if x is None else x for x in (point.load, point.frequency)])


def _tangent(point: CriticalLoad, parameter: str) -> Real:
    return np.array(point.derivative(parameter) if point.kind != "none" else (math.nan, math.nan))


def _event(value: float, one: CriticalLoad, two: CriticalLoad) -> BoundaryEvent:
    names: dict[Kind, str] = {"none": "no loss of stability", "flutter": "flutter", "divergence": "divergence"}
    what = "another branch" if one.kind == two.kind else f"{names[one.kind]} to {names[two.kind]}"
    return BoundaryEvent(what, value, (one.load, two.load), (one.frequency, two.frequency))
