"""Critical loads over a grid of parameters, as arrays.

Of the textbook's columns each point is asked by itself, on surfaces that they share; of any other the points are
followed from a few that are searched (`continuation.py`). A layer that spreads a map over processes cuts the axes into
blocks, calls `solve_grid` for each and puts the arrays side by side: the same blocks give the same bits, in whatever
order or process they run.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from freebeam.maps.arrays import put, shaped, solve_points, with_values
from freebeam.maps.continuation import continued
from freebeam_sym.question import Question
from freebeam_sym.stability.convergence import Answers
from freebeam_sym.stability.problem import Real

__all__ = ["crossed", "solve_grid"]


def crossed(axes: Mapping[str, Real]) -> dict[str, Real]:
    """The points of a grid of axes (n_k,), each (n_1 n_2 …,), by name, in the order of the axes."""
    return dict(zip(axes, (mesh.ravel() for mesh in np.meshgrid(*axes.values(), indexing="ij")), strict=True))


def solve_grid(question: Question, axes: Mapping[str, Real], step: Callable[[float], None] | None = None) -> Answers:
    """First loss of stability at every combination of the axes, and of what the question says of all else.

    axes: arrays (n_k,) by name, of alpha, beta and the column's own parameters; the answers' shape is (n_1, n_2, …) in
    their order. step: told which part is done, 0 to 1. The rest as in `arrays.solve`.
    """
    shape = tuple(map(len, axes.values()))
    if not question.column.general:
        return shaped(solve_points(question, crossed(axes), step), *shape)
    answers = Answers.none(*shape)

    def ask(at: tuple[int, ...]) -> Question:
        return with_values(question, {name: float(axis[k]) for (name, axis), k in zip(axes.items(), at, strict=True)})

    for at, found in continued(ask, shape, step).items():
        put(answers, at, found)
    return answers
