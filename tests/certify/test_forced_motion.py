"""Eigenvalues and amplitudes in balls against NumPy's, on the runtime's own matrices. Eqs. (11), (22)-(25)."""

from __future__ import annotations

from fractions import Fraction as F
from itertools import pairwise

import numpy as np
import pytest

import freebeam as fb
from freebeam_derive.certify import forced_motion

KERNEL = fb.column("free-free", "modes").kernel
ALPHA, BETA, FREQUENCY, FORCE, SENSOR = F(1, 1000), F(1, 10), F(3), F(1), F(1, 10)


def system(load: float) -> fb.System:
    return fb.column("free-free", "modes").system(5, load, float(ALPHA), float(BETA))


@pytest.mark.parametrize("load", [F(0), F(20), F(95)])
def test_eigenvalues_are_all_there_and_apart(load: F) -> None:
    balls = forced_motion.eigenvalues(KERNEL, 5, load, ALPHA, BETA)
    known = fb.spectrum(system(float(load))).eigenvalues
    near = [min(range(10), key=lambda k: abs(known[k] - complex(ball))) for ball in balls]
    assert sorted(near) == list(range(10))
    for ball, k in zip(balls, near, strict=True):
        assert abs(complex(ball) - known[k]) < 1e-9 * abs(known[k]) and float(ball.rad()) < 1e-30


@pytest.mark.parametrize("transposed", [False, True])
def test_the_amplitude_is_that_of_the_linear_equations(transposed: bool) -> None:
    found = forced_motion.amplitude(KERNEL, 5, ALPHA, BETA, FREQUENCY, FORCE, SENSOR, transposed)
    w = float(FREQUENCY)
    for load in (0.0, 7.0, 60.0):
        s = system(load)
        K = system(0).K + (s.K - system(0).K).T if transposed else s.K
        wanted = abs(s.shapes(float(SENSOR)) @ np.linalg.solve(K - w * w * s.M + 1j * w * s.C, s.Q(float(FORCE))))
        ball = found.at(F(load))
        assert float(ball) == pytest.approx(float(wanted), rel=1e-9) and float(ball.rad()) < 1e-30


def test_where_it_rises_and_falls_is_told_without_gaps() -> None:
    found = forced_motion.amplitude(KERNEL, 5, ALPHA, BETA, FREQUENCY, FORCE, SENSOR)
    pieces = found.slope_signs(F(0), F(90), F(1, 100))
    assert pieces[0][0] == 0 and pieces[-1][1] == 90
    assert all(one[1] == two[0] and one[2] != two[2] for one, two in pairwise(pieces))
    assert {sign for *_, sign in pieces} >= {-1, 1}
    for start, end, sign in pieces:
        assert sign or end - start <= F(1, 100)
        at = [float(found.at(start + (end - start) * F(k, 8))) for k in range(9)]
        assert not sign or (np.diff(at) * sign > 0).all()
