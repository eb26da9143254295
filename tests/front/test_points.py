"""Drawings of a column of segments: what is shown at its places is what was stated there."""

from __future__ import annotations

import dataclasses
from functools import cache
from typing import Any

import numpy as np
import pytest
import sympy as sp

import freebeam as fb
from freebeam.figures import curves
from freebeam.figures.points import parts
from freebeam_derive import emit, pipeline, statement, verify
from freebeam_derive.notation import F_0, P, alpha, beta, t, x, x_F, y
from freebeam_derive.statement import Coordinate, Parameter, at, delta, hinge, integral, jump
from freebeam_sym.columns import Column
from freebeam_sym.question import Question

a, k, g = (sp.Symbol(name, real=True) for name in ("a", "k", "g"))
OWN = tuple(Parameter(symbol, "", value, 0.0, 1.0) for symbol, value in ((a, 0.6), (k, 1.0), (g, 0.5)))
BECK = statement.load_column(statement.columns()["beck"])
LINE = {
    "T": integral(y.diff(t) ** 2) / 2,
    "V": integral(y.diff(x, 2) ** 2) / 2,
    "W_c": P * integral(y.diff(x) ** 2) / 2,
    "dW_nc": -P * at(y.diff(x), 1) * at(delta(y), 1),
    "dimensional": None,
}


def general(**changes: Any) -> Column:
    """Beck's column with changes, as a column of segments whatever it is; emitted and not verified."""
    stated = dataclasses.replace(BECK, name="changed", parameters=OWN, **{**LINE, **changes})
    return Column(verify.load(emit.emit(pipeline.general(stated).kernel), "changed"))


@cache
def beck_itself() -> Column:
    return Column(verify.load(emit.emit(pipeline.general(BECK).kernel), "beck_segments"))


def test_masses_springs_dampers_and_joints_stand_where_they_are_stated() -> None:
    q = Coordinate("q")
    column = general(
        T=LINE["T"] + at(y.diff(t), a) ** 2 / 2 + q.diff(t) ** 2 / 2,
        V=LINE["V"] + k * (at(y, 0.75) - q) ** 2 / 2 + k * jump(y.diff(x), 0.25) ** 2 / 2,
        dW_nc=-at(y.diff(t), 0.875) * at(delta(y), 0.875),
        releases=(hinge(0.125),), ends=("clamped", "pinned"),
    )  # fmt: skip
    found = parts(column)
    assert found.breaks == (0, 0.125, 0.25, 0.6, 0.75, 0.875, 1) and parts(column, a=0.7).breaks[3] == 0.7
    assert (found.masses, found.springs, found.dampers) == ((0.6,), (0.75,), (0.875,))
    assert found.joints == {0.125: 1, 0.25: 1} and not found.sensors


def test_loads_act_where_the_axial_force_ends_and_follow_in_part() -> None:
    whole = general(T=LINE["T"] + at(y.diff(t), 0.5) ** 2)
    assert parts(whole).loads == ((1.0, pytest.approx(1.0), pytest.approx(1.0)),) and not parts(whole).spread
    share = general(
        W_c=P * integral(y.diff(x) ** 2, 0, a), dW_nc=-g * P * at(y.diff(x), a) * at(delta(y), a)
    )  # twice the load, of which a quarter follows
    assert parts(share).loads == ((0.6, pytest.approx(2.0), pytest.approx(0.25)),)
    hung = general(
        T=LINE["T"] + at(y.diff(t), 0.5) ** 2, W_c=P * integral((1 - x) * y.diff(x) ** 2) / 2, dW_nc=sp.S.Zero
    )
    assert parts(hung).spread and not parts(hung).loads


def test_a_sensor_is_where_something_is_measured_that_acts_elsewhere() -> None:
    steered = general(dW_nc=LINE["dW_nc"] - g * P * at(y.diff(x), a) * at(delta(y), 1))
    assert parts(steered).sensors == ((0.6, 1.0),) and not parts(steered, g=0.0).sensors


def test_it_is_drawn_with_every_part() -> None:
    from matplotlib import pyplot

    column = general(
        V=LINE["V"] + k * jump(y, 0.25) ** 2 / 2,
        dW_nc=LINE["dW_nc"] - g * P * at(y.diff(x), a) * at(delta(y), 1) + F_0 * at(delta(y), x_F),
    )
    words = [text.get_text() for text in fb.figures.beam(column).texts]
    assert words.count("sensor") == 2 and "$F_0(t)$" in words and "$P_0$" in words
    words = [text.get_text() for text in fb.figures.beam(column, x_s=None, x_F=None).texts]
    assert words.count("sensor") == 1 and "$F_0(t)$" not in words
    pyplot.close("all")
    with pytest.raises(fb.InputError, match="x_F"):
        fb.figures.beam(column, x_F=1.5)
    p, q = Coordinate("p"), Coordinate("q")
    links = dataclasses.replace(
        BECK, name="links", ends=(), parameters=(), dimensional=None, T=(p.diff(t) ** 2 + q.diff(t) ** 2) / 2,
        V=(p**2 + (q - p) ** 2) / 2, W_c=P * p**2 / 2, dW_nc=-P * q * delta(p),
    )  # fmt: skip
    with pytest.raises(fb.InputError, match="no deflection y"):
        fb.figures.beam(Column(verify.load(emit.emit(pipeline.general(links).kernel), "links")))


def test_the_tangent_of_a_general_kernel_is_that_of_the_textbook_s() -> None:
    """The same column by another kernel: the same point, slope and foot of the line."""
    for kappa in (0.0, 20.0):
        one, other = (
            curves.tangent(Question.of(column, 16, kappa=kappa), points=8)
            for column in (beck_itself(), fb.column("beck", "legendre"))
        )
        assert one.kappa == pytest.approx(other.kappa, abs=1e-9)
        for name in ("load", "square", "slope"):
            assert getattr(one, name) == pytest.approx(getattr(other, name), rel=1e-7)
        assert one.line(0.0) == pytest.approx(-kappa, abs=1e-6)


def test_the_tangent_belongs_to_proportional_damping_alone() -> None:
    partly = general(dW_nc=LINE["dW_nc"] - alpha * integral(y.diff(x, 2, t) * delta(y.diff(x, 2)), 0, a))
    with pytest.raises(fb.InputError, match="not of the form C = c_M M"):
        curves.tangent(Question.of(partly, 8, kappa=0.0))
    damped = general(dW_nc=LINE["dW_nc"] - at(y.diff(t), a) * at(delta(y), a))
    with pytest.raises(fb.InputError, match="dampers or gyroscopic forces of its own"):
        curves.coalescence(Question.of(damped, 8))


def test_the_share_that_follows_is_stated() -> None:
    column = general(dW_nc=-g * P * at(y.diff(x), 1) * at(delta(y), 1) - beta * integral(y.diff(t) * delta(y)))
    for share in (0.25, 1.0):
        assert curves.follower_share(Question.of(column, g=share)) == pytest.approx(share)
    assert curves.follower_share(Question.of(beck_itself())) == pytest.approx(1.0)


def test_a_motion_swings_whatever_the_largest_eigenvalue_is() -> None:
    """Strong internal damping makes the highest eigenvalues huge; the flutter mode is still one that swings."""
    found = curves.cycle(Question.of(beck_itself(), 24, 1e-3))
    assert found.eigenvalue.imag > 1 and abs(found.eigenvalue.real) < 1e-6 * found.eigenvalue.imag
    assert np.abs(found.energy - found.energy[0] - found.work + found.dissipated).max() < 1e-9
