"""What a series' critical load is off by: the beam itself, as far as polynomials tell. Section 3.2.

Values of a non-self-adjoint Ritz series are no bounds, and one that changes little with N may still be of another kind
than the beam's. But series of polynomials converge exponentially, so that two of them which agree, at different N, are
the beam's load to their difference and rounding.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from freebeam_sym.stability.problem import Kind, Real

__all__ = ["CONVERGED", "KINDS", "Answers", "BeamLoss", "beam_losses", "judge"]

CONVERGED = 1e-3
"""Relative error, against the beam itself, up to which a critical load is called converged."""
AGREE = 1e-10
"""Relative change from N to more polynomials that is taken at once; else N grows as far as it may."""
ENOUGH = 1e-4
"""The same, that is taken where N may grow no more."""
MODES = (12, 16, 20, 26, 34, 44)
"""N of the polynomials that are compared, one after the other."""
UNSEEN = 20
"""N from which on two series that find no loss of stability are believed: fewer polynomials do not bend enough for the
crossings at loads of some hundreds."""


KINDS: tuple[Kind, ...] = ("none", "flutter", "divergence")
"""What the numbers of `Answers.kind` stand for."""


class Answers(NamedTuple):
    """Arrays of one shape: load and frequency (nan where there is none; frequency 0 in divergence), and kind, int8."""

    load: Real
    frequency: Real
    kind: NDArray[np.int8]

    def at(self, which: Any) -> Answers:
        """The answers of some points."""
        return Answers(self.load[which], self.frequency[which], self.kind[which])

    @staticmethod
    def none(*shape: int) -> Answers:
        """Of points where nothing is lost."""
        return Answers(np.full(shape, np.nan), np.full(shape, np.nan), np.zeros(shape, dtype=np.int8))


class BeamLoss(NamedTuple):
    """First loss of stability of the beam itself up to the largest load asked for, nondimensional: `load` and
    `frequency` None where `kind` is "none". `uncertainty` of the load, relative, estimated."""

    load: float | None
    kind: Kind
    frequency: float | None
    uncertainty: float


def beam_losses(ask: Callable[[int, NDArray[np.intp]], Answers], points: int) -> tuple[Answers, Real]:
    """First losses of the beam itself at so many points, and the relative change (points,) from N to more polynomials:
    inf where they do not agree. ask: for N and the numbers of points, what a series of N polynomials answers there."""
    best = Answers.none(points)
    change, left = np.full(points, np.inf), np.arange(points)
    before = ask(MODES[0], left)
    for fewer, modes in pairwise(MODES):
        now = ask(modes, left)
        with np.errstate(invalid="ignore"):
            off = np.where(now.kind > 0, np.abs(now.load / before.load - 1), 0.0 if fewer >= UNSEEN else np.inf)
        off = np.where(now.kind == before.kind, off, np.inf)
        change[left] = off
        best.load[left], best.frequency[left], best.kind[left] = now
        more = off > AGREE
        left, before = left[more], now.at(more)
        if not len(left):
            break
    return best, np.where(change <= ENOUGH, change, np.inf)


def judge(found: Answers, beam: Answers, uncertainty: Real) -> tuple[Real, NDArray[np.bool_]]:
    """Estimated error of loads against the beam's, relative, nan where either has none or the beam's is not known; and
    whether the beam loses stability alike, at a load that differs by CONVERGED at most. All of one shape."""
    known = np.isfinite(uncertainty)
    with np.errstate(invalid="ignore"):
        error = np.where(known, np.abs(found.load - beam.load) / beam.load + uncertainty, np.nan)
        alike = (found.kind == 0) | (error <= CONVERGED)
    return error, np.asarray(known & (found.kind == beam.kind) & alike)
