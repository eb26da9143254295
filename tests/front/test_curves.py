"""Curves of a column of segments: the tangent, the share of the load that follows, a motion."""

from __future__ import annotations

import dataclasses
from functools import cache
from typing import Any

import numpy as np
import pytest

import freebeam as fb
from freebeam.figures import curves
from freebeam_derive import emit, pipeline, statement, verify
from freebeam_derive.notation import P, alpha, beta, t, x, y
from freebeam_derive.statement import at, delta, integral
from freebeam_sym.columns import Column
from freebeam_sym.question import Question
from tests.front.test_schematic import LINE, OWN, a, g

BECK = statement.load_column(statement.columns()["beck"])


def general(**changes: Any) -> Column:
    """Beck's column with changes, as a column of segments whatever it is; emitted and not verified."""
    stated = dataclasses.replace(BECK, name="changed", parameters=OWN, **{**LINE, **changes})
    return Column(verify.load(emit.emit(pipeline.general(stated).kernel), "changed"))


@cache
def beck_itself() -> Column:
    return Column(verify.load(emit.emit(pipeline.general(BECK).kernel), "beck_segments"))


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
    turned = general(dW_nc=LINE["dW_nc"] - alpha * integral((y.diff(x, 2, t) + P * y.diff(x, 2)) * delta(y.diff(x, 2))))
    with pytest.raises(fb.InputError, match="not of the form C = c_M M"):
        curves.tangent(Question.of(turned, 8, kappa=0.0))
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
