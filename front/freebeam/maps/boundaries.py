"""Stability boundaries: the critical load as a curve over one parameter, with the places where its kind changes."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from freebeam_sym.checks import InputError, computable, finite, positive, refusal
from freebeam_sym.columns import Column, is_column
from freebeam_sym.question import Question
from freebeam_sym.stability.critical import CriticalLoad, answer
from freebeam_sym.stability.problem import Kind, Real

__all__ = ["Boundary", "BoundaryEvent", "trace_boundary"]

_PLACED = 1e-10
"""How closely events are placed, relative to the range."""
_CURVED = 1 / 4096
"""Least distance of points that follow the curve alone, relative to the range."""
_HELD = 0.8
"""A change over an interval that a half of it still holds to this share is a jump; a square root has 0.71."""


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
        """dP/dp along the curve, (m,), p the parameter: of `CriticalLoad.gradient`, from the eigenvectors at each point
        and not from its neighbours; nan where there is no load or no derivative. Computed when first asked for."""
        rates = (point.gradient.get(self.parameter) if point.kind != "none" else None for point in self.points)
        return np.array([math.nan if rate is None else rate for rate in rates])

    @cached_property
    def error(self) -> Real:
        """`CriticalLoad.error` of each point, (m,), nan where there is none; computed when first asked for."""
        return np.array([math.nan if point.error is None else point.error for point in self.points])

    @cached_property
    def converged(self) -> NDArray[np.bool_]:
        """`CriticalLoad.converged` of each point, (m,)."""
        return np.array([point.converged for point in self.points])


@dataclass
class _Tracer:
    at: Callable[[float], CriticalLoad]
    tolerance: float
    found: dict[float, CriticalLoad] = field(default_factory=dict)
    events: list[tuple[float, float]] = field(default_factory=list)

    def ask(self, t: float) -> CriticalLoad:
        if t not in self.found:
            self.found[t] = self.at(t)
        return self.found[t]

    def follow(self, a: float, b: float, before: float = math.inf) -> None:
        """Points between a and b as the curve needs them. before: the change over the interval that these halve."""
        one, two = self.ask(a), self.ask(b)
        change = _change(one, two)
        width, jump = b - a, one.kind != two.kind or 1e-3 < change > _HELD * before
        if jump and width <= _PLACED:
            self.events.append((a, b))
            return
        if one.kind == two.kind and width <= _CURVED and not jump:
            return
        middle = (a + b) / 2
        between = self.ask(middle)
        if one.kind == two.kind == between.kind and _bend(one, between, two) <= self.tolerance and not jump:
            return
        self.follow(a, middle, change)
        self.follow(middle, b, change)


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
    (over the logarithm of the parameter with `log`), and jumps and changes of kind are placed by bisection to 1e-10 of
    the range. Each point is the first loss of stability, found by itself among all: a branch cannot be followed past
    the place where another takes over. An event and its undoing both inside one of the first 32 intervals may be
    missed.
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

    def value(t: float) -> float:
        x = low * (high / low) ** t if log else low + (high - low) * t
        return min(max(x, low), high)

    tracer = _Tracer(lambda t: answer(question.at(**{parameter: value(t)})), tolerance)
    ends = np.linspace(0.0, 1.0, 33).tolist()
    for a, b in pairwise(ends):
        tracer.follow(a, b)
    places = sorted(tracer.found)
    points = [tracer.found[t] for t in places]
    return Boundary(
        parameter,
        np.array([value(t) for t in places]),
        np.array([np.nan if p.load is None else p.load for p in points]),
        np.array([np.nan if p.frequency is None else p.frequency for p in points]),
        np.array([p.kind for p in points]),
        tuple(_event(value((a + b) / 2), tracer.found[a], tracer.found[b]) for a, b in tracer.events),
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


def _bend(one: CriticalLoad, between: CriticalLoad, two: CriticalLoad) -> float:
    """How far load or frequency in the middle are from the mean of the ends, relative."""
    triples = ((p.load, m.load, q.load) for p, m, q in ((one, between, two),))
    others = ((p.frequency, m.frequency, q.frequency) for p, m, q in ((one, between, two),))
    return max((abs(m - (p + q) / 2) / m for p, m, q in (*triples, *others) if p and m and q), default=0.0)


def _event(value: float, one: CriticalLoad, two: CriticalLoad) -> BoundaryEvent:
    names: dict[Kind, str] = {"none": "no loss of stability", "flutter": "flutter", "divergence": "divergence"}
    what = "another branch" if one.kind == two.kind else f"{names[one.kind]} to {names[two.kind]}"
    return BoundaryEvent(what, value, (one.load, two.load), (one.frequency, two.frequency))
