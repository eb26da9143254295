"""What a map's loads are off by: the beam itself at each point, as far as polynomials tell."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping

import numpy as np
from numpy.typing import NDArray

from freebeam.maps.arrays import shaped, solve_points
from freebeam.maps.grid import crossed, solve_grid
from freebeam_sym.question import Question
from freebeam_sym.stability.convergence import Answers, beam_losses, judge
from freebeam_sym.stability.problem import Real

__all__ = ["digits_that_hold", "verdict"]


def verdict(
    question: Question, axes: Mapping[str, Real], found: Answers, step: Callable[[float], None] | None = None
) -> tuple[Real, NDArray[np.bool_]]:
    """`judge` of the answers of a grid, as `solve_grid` gives them. step: told which part is done, 0 to 1."""
    shape, size = found.load.shape, found.load.size
    polynomials, done = question.column.polynomials, 0
    if polynomials is None:
        return np.full(shape, np.nan), np.zeros(shape, dtype=bool)
    points = crossed(axes)

    def ask(modes: int, which: NDArray[np.intp]) -> Answers:
        nonlocal done
        asked = question.over(polynomials, modes)
        if asked == question:
            answers = shaped(found, -1).at(which)
        elif 2 * len(which) >= size:  # what a grid's points share saves more than half of them
            answers = shaped(solve_grid(asked, axes), -1).at(which)
        else:
            answers = solve_points(asked, {name: x[which] for name, x in points.items()})
        done += 1
        if step is not None:
            step(min(done / 4, 0.9))
        return answers

    beam, uncertainty = beam_losses(ask, size)
    if step is not None:
        step(1.0)
    error, converged = judge(shaped(found, -1), beam, uncertainty)
    return error.reshape(shape), converged.reshape(shape)


def digits_that_hold(value: float, error: float, most: int = 10) -> str:
    """A value as text, to as many significant digits as its relative error leaves, one at least.

    >>> digits_that_hold(9.8696044, 3e-4), digits_that_hold(20.050953619, 1e-14)
    ('9.87', '20.05095362')
    """
    digits = most if error <= 10.0**-most else max(1, math.floor(-math.log10(min(error, 0.1))))
    return f"{value:#.{min(digits, most)}g}".rstrip(".")
