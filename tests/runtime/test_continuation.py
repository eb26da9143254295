"""Maps of columns beyond the textbook's: points followed from searched ones answer as a search of each does."""

from __future__ import annotations

import math
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import pytest

import freebeam as fb
from freebeam.maps import continuation
from freebeam.maps.labelled import Solved, solved, split
from freebeam_sym.stability.crossings import first_loss
from freebeam_sym.stability.general import General
from freebeam_sym.stability.problem import Crossing
from tests.stated import file_of

STATED = {
    "T": "T + mu * at(y.diff(t), 1) ** 2 / 2",
    "V": "V + k * at(y, 1) ** 2 / 2",
    "dW_nc": "follower + external + internal - c * at(y.diff(t), 1) * at(delta(y), 1)",
    "parameters": "(own(mu, 0.0), own(k, 0.0), own(c, 0.0))",
}
AXES: dict[str, dict[str, Any]] = {
    "mass and damping": {"mu": np.linspace(0.1, 1.0, 9), "beta": np.linspace(0.1, 2.0, 8)},
    "flutter and divergence": {"k": np.linspace(5.0, 60.0, 12), "beta": np.geomspace(1e-3, 1.0, 7)},
    "without damping, and with": {"beta": np.linspace(0.0, 0.5, 8), "mu": np.linspace(0.1, 2.0, 8), "k": 3.0},
    "none": {"mu": np.linspace(0.1, 2.0, 9), "k": np.linspace(0.0, 9.0, 8), "load_max": 18.0},
    "tip damper": {"k": np.linspace(0.0, 20.0, 10), "c": np.geomspace(1e-2, 10.0, 7)},
    "one axis": {"mu": np.linspace(0.1, 2.0, 33), "alpha": 1e-3, "beta": 0.3},
    "three axes": {"mu": np.linspace(0.1, 0.3, 4), "k": np.linspace(1.0, 2.0, 4), "alpha": np.linspace(1e-3, 1e-2, 4)},
}


@cache
def column() -> fb.Column:
    with TemporaryDirectory() as folder:
        return fb.column(file_of(Path(folder), "sample", STATED))


def asked(given: dict[str, Any], modes: int = 4) -> Solved:
    values = {"load_max": 200.0, **given}
    load_max = values.pop("load_max")
    return solved(*split(column(), modes, values, load_max), convergence=False)


def searched(found: Solved) -> tuple[np.ndarray, np.ndarray]:
    """Loads and frequencies, each point searched by itself; nan where there is none."""
    loads = np.full((2, *found.answers.load.shape), np.nan)
    for at in np.ndindex(found.answers.load.shape):
        here = {name: float(axis[k]) for (name, axis), k in zip(found.axes.items(), at, strict=True)}
        crossing = first_loss(found.question.at(**here).problem, found.question.load_max).crossing
        if crossing is not None:
            loads[(slice(None), *at)] = crossing.load, crossing.frequency
    return loads[0], loads[1]


@pytest.mark.parametrize("name", AXES)
def test_each_point_answers_as_a_search_of_it_alone(name: str) -> None:
    found = asked(AXES[name])
    load, frequency = searched(found)
    np.testing.assert_allclose(found.answers.load, load, rtol=1e-9)
    np.testing.assert_allclose(found.answers.frequency, frequency, rtol=1e-5, atol=1e-5)


def test_the_map_of_two_kinds_has_both_and_that_of_two_limits_jumps() -> None:
    """Or the test before would not be one of what it says."""
    assert set(asked(AXES["flutter and divergence"]).answers.kind.ravel()) == {1, 2}
    assert set(asked(AXES["none"]).answers.kind.ravel()) == {0, 1}
    loads = asked(AXES["without damping, and with"]).answers.load
    assert (loads[1] < 0.98 * loads[0]).any()


def test_few_points_of_a_smooth_map_are_searched(monkeypatch: pytest.MonkeyPatch) -> None:
    calls: list[Any] = []
    monkeypatch.setattr(continuation, "first_loss", lambda *given: (calls.append(given), first_loss(*given))[1])
    found = asked({"mu": np.linspace(0.1, 2, 30), "beta": np.linspace(0.05, 2, 30)})
    assert np.isfinite(found.answers.load).all()
    assert len(calls) <= 900 / 20


def test_where_something_grows_below_what_is_followed_the_point_is_searched(monkeypatch: pytest.MonkeyPatch) -> None:
    calls: list[Any] = []
    true = General.unstable
    monkeypatch.setattr(General, "unstable", lambda problem, P, manner=None: bool(manner) or true(problem, P))
    monkeypatch.setattr(continuation, "first_loss", lambda *given: (calls.append(given), first_loss(*given))[1])
    asked(AXES["mass and damping"])
    assert len(calls) == 72


def test_a_later_crossing_is_not_taken(monkeypatch: pytest.MonkeyPatch) -> None:
    """There are two in this column: Newton's method is sent to the second at each point."""
    given = {"beta": np.linspace(0.1, 1.0, 9), "mu": 0.5}
    found = asked(given)
    load, question = found.answers.load, found.question
    second = [event.crossing for event, _ in zip(question.at(beta=0.5).problem.flutters(500.0), range(2), strict=False)]
    assert len(second) == 2 and second[1].load > 1.5 * second[0].load
    true = General.near
    monkeypatch.setattr(continuation, "CLOSE_BY", math.inf)
    monkeypatch.setattr(General, "near", lambda problem, near: true(problem, second[1]))
    assert true(question.at(beta=0.4).general, second[1]) is not None
    np.testing.assert_allclose(asked(given).answers.load, load, rtol=1e-9)


def test_a_loss_that_shows_at_no_corner_is_seen_to_come() -> None:
    """A pipe of β = 0.83 loses stability at 10.8, regains it and loses it again at 12.7: between corners with one
    crossing, of 12.7, on either side of a fold of its boundary."""
    with TemporaryDirectory() as folder:
        statement = {
            "W_c": "P ** 2 * integral(y.diff(x) ** 2) / 2",
            "dW_nc": "-P ** 2 * at(y.diff(x), 1) * at(delta(y), 1) - 2 * b * P * integral(y.diff(x, t) * delta(y))"
            " - integral(g * y.diff(t) * delta(y))",
            "parameters": "(own(b, 0.3), own(g, 0.1))",
        }
        pipe = fb.column(file_of(Path(folder), "pipe", statement))
    given = {"b": np.linspace(0.475, 0.9, 7), "g": np.linspace(0.1, 0.96, 4)}
    found = solved(*split(pipe, 7, given, 300.0), convergence=False)
    load, _ = searched(found)
    np.testing.assert_allclose(found.answers.load, load, rtol=1e-9)


def test_what_lies_between_is_weighed_linearly() -> None:
    """The corners' loads and squared frequencies, at any point of a box, whatever the phases of their motions."""
    motion, turned = np.array([1.0, 0.5j]), np.array([1.0, 0.5j]) * np.exp(0.7j)
    low, high = (0, 0), (4, 8)
    corners = {
        (i, j): Crossing(10 + i + 2 * j, math.sqrt(5 + 3 * i + j), motion if i else turned, "flutter")
        for i in (0, 4)
        for j in (0, 8)
    }
    for at in ((0, 0), (1, 3), (4, 8), (2, 5)):
        near = continuation._between([(continuation._share(at, c, low, high), x) for c, x in corners.items()])
        assert math.isclose(near.load, 10 + at[0] + 2 * at[1])
        assert math.isclose(near.frequency**2, 5 + 3 * at[0] + at[1])
        assert abs(abs(near.vector.conj() @ motion) / np.linalg.norm(near.vector) - np.linalg.norm(motion)) < 1e-12
