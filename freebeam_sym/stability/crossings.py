"""First loss of stability of a problem as its load grows from zero: flutter, divergence, or none up to a stated load.

What can end stability is a divergence, λ = 0, or a flutter, λ = ±iω. `first_loss` takes both in the order of their
loads and decides of each, in one place, whether stability is lost there: a simple root loses it; two roots that
rounding cannot tell apart are a touch, unless eigenvalues grow beyond it. A count of the eigenvalues that grow just
below the answer confirms that none was missed. "Stable" means the elastic spectrum: rigid motion of a free beam drifts
at any load.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from freebeam_sym.stability.problem import NEAR, Crossing, Event, Problem

__all__ = ["FirstLoss", "first_loss", "scan"]

MARGIN = 1e-3
"""Relative. So far below a load it is confirmed that nothing grows, and so far above a touch, or half the way to its
neighbour: far enough for the counts, since at a touch ω² falls as the square of the distance."""


@dataclass(frozen=True)
class FirstLoss:
    """`crossing`: the first loss of stability, None where there is none. `touches`: loads below it at which an
    eigenvalue comes to the imaginary axis and goes back, or passes it and returns within rounding: no loss."""

    crossing: Crossing | None
    touches: tuple[Crossing, ...] = ()


def first_loss(problem: Problem, load_max: float = 1000.0) -> FirstLoss:
    """First loss of stability for 0 < P ≤ load_max. Raises InputError where the problem's flutters cannot be had."""
    crossing, touches = _decided(problem, load_max)
    top = math.inf if crossing is None else crossing.load * (1 - NEAR)
    return FirstLoss(crossing, tuple(touch for touch in touches if touch.load < top))


def _decided(problem: Problem, load_max: float) -> tuple[Crossing | None, list[Crossing]]:
    """The first loss, and the touches met on the way to it: one may stand at the same load but for rounding."""
    touches: list[Crossing] = []
    stable = 0.0
    events = _in_order(problem, load_max)
    event = next(events, None)
    while event is not None:
        crossing, beyond = event.crossing, math.inf
        if not event.simple:
            following = next(events, None)
            ahead = math.inf if following is None else following.crossing.load / crossing.load - 1
            beyond = crossing.load * (1 + min(MARGIN, ahead / 2))
            if ahead < 2 * NEAR or not problem.unstable(beyond):
                if not crossing.frequency >= 0:  # it may be off by as much as the next one is away
                    high = min(load_max, crossing.load * (1 + 0.9 * min(ahead, 1.0)))
                    if (found := scan(problem, stable, high, 16)) is not None:
                        return found, touches
                touches += [] if crossing.frequency < 0 else [crossing]
                event, stable = following, stable if ahead < 2 * NEAR else crossing.load
                continue
        below = crossing.load * (1 - min(MARGIN, abs(1 - stable / crossing.load) / 2))
        if problem.unstable(below):
            return scan(problem, stable if stable < below else 0.0, below), touches
        if not crossing.frequency >= 0:
            # rounding hides how slow is what begins where K is singular
            rests = [e.crossing for e in problem.divergences if abs(e.crossing.load / crossing.load - 1) < NEAR]
            crossing = replace(rests[0], kind="flutter") if rests else problem.onset(bisected(problem, below, beyond))
        return crossing if crossing.load <= load_max else None, touches
    top = load_max * (1 - MARGIN)
    if stable < top and problem.unstable(top):
        return scan(problem, stable, top), touches
    return None, touches


def _in_order(problem: Problem, load_max: float) -> Iterator[Event]:
    """Divergences, flutters and touches, ascending, up to `load_max` and the first simple divergence, beyond which
    nothing can be the first loss; found when they are asked for."""
    waiting = [event for event in problem.divergences if event.crossing.load <= load_max * (1 + NEAR)]
    last = next((event.crossing.load for event in waiting if event.simple), load_max)
    for flutter in problem.flutters(last):
        # what touches λ = 0 comes before a flutter that begins there, whichever rounding puts first
        while waiting and waiting[0].crossing.load <= flutter.crossing.load * (1 + (not waiting[0].simple) * NEAR):
            yield waiting.pop(0)
        yield flutter
    yield from waiting


def scan(problem: Problem, low: float, high: float, count: int = 256) -> Crossing | None:
    """A crossing between a stable load and one where something grows, by counts at equal steps and bisection: slow,
    plain, and blind between steps. What is left where Arnoldi's method has missed a crossing."""
    steps = np.linspace(low, high, count + 1).tolist()
    k = next((k for k, load in enumerate(steps) if load > 0 and problem.unstable(load)), None)
    return None if k is None else problem.onset(bisected(problem, steps[max(k - 1, 0)], steps[k]))


def bisected(problem: Problem, low: float, high: float) -> float:
    """The least load at which something grows, between one at which nothing does and one at which it does."""
    while high - low > 4e-16 * high:
        middle = (low + high) / 2
        if problem.unstable(middle):
            high = middle
        else:
            low = middle
    return high
