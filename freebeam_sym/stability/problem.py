"""What a search for the first loss of stability sees of a column: a problem, whatever its matrices and its damping."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal, Protocol

import numpy as np
from numpy.typing import NDArray

__all__ = ["CLOSE", "NEAR", "Complex", "Crossing", "Event", "Kind", "Problem", "Real"]

Real = NDArray[np.float64]
Complex = NDArray[np.complex128]
Kind = Literal["flutter", "divergence", "none"]

CLOSE = 1e-4
"""Relative distance of loads from which on they are looked at together."""
NEAR = 1e-6
"""Relative. Two roots of a matrix's determinant are known apart from here on: they are off by the root of rounding."""


@dataclass(frozen=True)
class Crossing:
    """A load at which an eigenvalue λ = iω stands on the imaginary axis. All nondimensional.

    `vector` (N,) complex are the generalised coordinates of the motion, largest entry 1. A flutter's frequency is 0
    where an eigenvalue comes to λ = 0 and leaves as a pair that grows.
    """

    load: float
    frequency: float
    vector: Complex
    kind: Literal["flutter", "divergence"]


@dataclass(frozen=True)
class Event:
    """A crossing that may end stability. simple: of a single root, which an eigenvalue passes; else of roots that
    rounding cannot tell apart, so that it may come back, with the frequency nan where that is hidden, -1 where it is
    found to be no crossing."""

    crossing: Crossing
    simple: bool


class Problem(Protocol):
    """Matrices at a load with their damping, or a limit of vanishing damping. Stable at load 0."""

    @property
    def divergences(self) -> tuple[Event, ...]:
        """Loads at which λ = 0 is an eigenvalue, ascending, with no regard to flutter before; up to the first simple
        one at least."""

    def flutters(self, bound: float) -> Iterator[Event]:
        """Flutters and their touches below the load `bound`, ascending, found when they are asked for."""

    def unstable(self, load: float) -> int:
        """How many eigenvalues grow at a load."""

    def onset(self, load: float) -> Crossing:
        """The crossing at which what grows most at a load, just beyond it, has begun to grow."""
