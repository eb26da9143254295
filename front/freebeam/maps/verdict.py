"""What a map's loads are off by: the beam itself at each point, as far as polynomials tell."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np
from numpy.typing import NDArray

from freebeam.maps.arrays import solve_points
from freebeam.maps.grid import crossed, solve_grid
from freebeam_sym.question import Question
from freebeam_sym.stability.convergence import Answers, beam_losses, judge
from freebeam_sym.stability.problem import Real

__all__ = ["verdict"]


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
            answers = found.shaped(-1).at(which)
        elif 2 * len(which) >= size:  # what a grid's points share saves more than half of them
            answers = solve_grid(asked, axes).shaped(-1).at(which)
        else:
            answers = solve_points(asked, {name: x[which] for name, x in points.items()})
        done += 1
        if step is not None:
            step(min(done / 4, 0.9))
        return answers

    beam, uncertainty = beam_losses(ask, size)
    if step is not None:
        step(1.0)
    error, converged = judge(found.shaped(-1), beam, uncertainty)
    return error.reshape(shape), converged.reshape(shape)
