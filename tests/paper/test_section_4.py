"""Section 4, Numerical results and discussion: every number and claim, at the paper's N = 8."""

from __future__ import annotations

import math
from dataclasses import replace
from decimal import ROUND_CEILING, Decimal
from functools import cache
from typing import Any

import numpy as np
import pytest

import freebeam as fb

# A real part below this is taken for zero. Rounding gives the undamped beam some 1e-13 before coalescence; the least
# that a first unstable step gives is 6e-7, at α = 1e-6.
TOLERANCE = 1e-9


def system(load: float, alpha: float = 1e-3, beta: float = 0.1, rigid: bool = False) -> fb.System:
    return fb.column("free-free").system(8, load, alpha, beta, rigid)


def critical(alpha: float, beta: float) -> float:
    found = fb.critical_load(fb.column("free-free"), modes=8, alpha=alpha, beta=beta)
    assert found.kind == "flutter"  # "all the obtained critical follower forces cause flutter to occur" (section 5)
    assert found.load is not None
    return found.load


def real_parts(loads: Any, alpha: float, beta: float) -> Any:
    """Largest real part of the eigenvalues of the matrix A, Eq. (25), at each load."""
    s = system(0.0, alpha, beta)
    inverse = np.linalg.inv(s.M)
    A = np.zeros((len(loads), 16, 16))
    A[:, :8, 8:] = np.eye(8)
    A[:, 8:, :8] = -inverse @ (s.E + np.asarray(loads)[:, None, None] * s.H)
    A[:, 8:, 8:] = -inverse @ s.C
    return np.linalg.eigvals(A).real.max(axis=1)


def scan(step: str, alpha: float, beta: float, start: str = "0") -> str:
    """The paper's way to a critical load: raise P₀ in steps until a real part turns positive; that load, as printed."""
    loads = [Decimal(start) + k * Decimal(step) for k in range(2000)]
    for part in range(0, len(loads), 100):
        growing = real_parts([float(P) for P in loads[part : part + 100]], alpha, beta) > TOLERANCE
        if growing.any():
            return str(loads[part + int(growing.argmax())])
    raise AssertionError("no real part turned positive")


def digits(load: float, step: str) -> str:
    """The first multiple of a step at or above a load."""
    unit = Decimal(step)
    return str((Decimal(load) / unit).to_integral_value(ROUND_CEILING) * unit)


@pytest.mark.parametrize(
    ("alpha", "beta", "step", "start", "printed"),
    [
        (0.0, 0.0, "0.1", "0", "109.8"),  # section 4.1
        (0.0, 0.0, "0.01", "105.00", "109.73"),  # section 4.1; "if two significant figures had been considered"
        (1e-6, 0.0, "0.1", "0", "88.2"),  # section 4.2
        (1e-3, 0.1, "0.1", "0", "90.9"),  # section 4.4
    ],
)
def test_the_printed_critical_loads_are_steps_of_a_scan(
    alpha: float, beta: float, step: str, start: str, printed: str
) -> None:
    assert scan(step, alpha, beta, start) == printed
    load = critical(alpha, beta)
    assert digits(load, step) == printed
    assert 0 <= Decimal(printed) - Decimal(load) < Decimal(step)


# 4.1, no damping


def test_the_scans_tolerance_parts_rounding_from_growth() -> None:
    load = critical(0.0, 0.0)
    assert real_parts(np.linspace(0, load - 1e-3, 300), 0.0, 0.0).max() < TOLERANCE / 10
    assert real_parts([109.8, 109.73], 0.0, 0.0).min() > 1e-2
    assert real_parts([88.2], 1e-6, 0.0).min() > 10 * TOLERANCE


def test_rounding_to_the_nearest_does_not_explain_the_first_two_digits() -> None:
    assert f"{critical(0.0, 0.0):.1f}" != "109.8" and f"{critical(0.0, 0.0):.2f}" != "109.73"


def test_the_lowest_two_meet_and_leave_the_axis_to_both_sides() -> None:
    """The print has "equal" real parts that turn positive; past coalescence they are r and −r."""
    load = critical(0.0, 0.0)
    before = fb.spectrum(system(0.999 * load, 0, 0)).eigenvalues
    after = fb.spectrum(system(1.001 * load, 0, 0)).eigenvalues
    assert not before.real.any()
    upper = after[(after.real != 0) & (after.imag > 0)]
    assert len(upper) == 2
    assert upper[0].imag == pytest.approx(upper[1].imag, rel=1e-12)
    assert upper[0].real == pytest.approx(-upper[1].real, rel=1e-9) and abs(upper[0].real) > 0.1
    frequencies = np.sort(before.imag[before.imag > 0])
    assert frequencies[0] < upper[0].imag < frequencies[1]  # the first and the second


# 4.2, internal damping alone


def test_internal_damping_lowers_the_load_at_once() -> None:
    """Constant at 88.2 from 1e-6 to 1e-3 in the paper's digits; the value itself rises by 0.02."""
    loads = [critical(alpha, 0.0) for alpha in np.geomspace(1e-6, 1e-3, 13)]
    assert {digits(load, "0.1") for load in loads} == {"88.2"}
    assert (np.diff(loads) > 0).all()
    assert critical(1e-9, 0.0) == pytest.approx(loads[0], abs=1e-6)  # a limit, not the undamped load


def test_more_internal_damping_raises_the_load() -> None:
    loads = [critical(alpha, 0.0) for alpha in np.geomspace(1e-3, 1e-1, 25)]
    assert (np.diff(loads) > 0).all()
    assert loads[-1] - loads[0] > 10
    assert loads[-1] < critical(0.0, 0.0)


# 4.3, external damping alone


def test_a_little_external_damping_changes_nothing_in_the_printed_digits() -> None:
    loads = [critical(0.0, beta) for beta in np.geomspace(1e-2, 1e-1, 9)]
    assert {digits(load, "0.01") for load in loads} == {"109.73"}


def test_more_external_damping_raises_the_load_negligibly() -> None:
    loads = [critical(0.0, beta) for beta in (0.0, *np.geomspace(1e-2, 1, 13))]
    assert (np.diff(loads) > 0).all()
    assert loads[-1] - loads[0] < 0.03
    assert digits(loads[-1], "0.01") > "109.73"


# 4.4, both


@cache
def map_of_loads() -> Any:
    """Loads at α (rows) and β (columns) over the ranges of Figs. 4 and 5."""
    alphas, betas = np.geomspace(1e-6, 1e-1, 16), np.concatenate([[0.0], np.geomspace(1e-2, 1, 7)])
    return np.array([[critical(alpha, beta) for beta in betas] for alpha in alphas])


def test_at_given_alpha_external_damping_raises_the_load() -> None:
    assert (np.diff(map_of_loads(), axis=1) > 0).all()


def test_at_given_beta_internal_damping_lowers_the_load_and_then_raises_it() -> None:
    for loads in map_of_loads().T[1:]:
        lowest = int(np.argmin(loads))
        assert 0 < lowest < len(loads) - 1
        assert (np.diff(loads[: lowest + 1]) < 0).all() and (np.diff(loads[lowest:]) > 0).all()
    assert (np.diff(map_of_loads()[:, 0]) > 0).all()  # without β it only rises


def test_one_pair_crosses_the_axis() -> None:
    """Fig. 7, α = 0.001 and β = 0.1: from left to right as P₀ rises through 90.9."""
    loads = np.arange(0.0, 111.0, 10.0)
    followed = fb.branches(fb.column("free-free"), loads, modes=8, alpha=1e-3, beta=0.1)
    upper = followed.eigenvalues[:, followed.eigenvalues[0].imag > 0]
    order = np.argsort(upper[0].imag)
    first, second = upper[:, order[0]], upper[:, order[1]]
    assert (first.real[loads < 90] < 0).all() and (first.real[loads > 91] > 0).all()
    assert (second.real < 0).all()
    for load, values in zip(loads, followed.eigenvalues, strict=True):
        expected = fb.spectrum(system(float(load))).eigenvalues
        assert np.abs(values[:, None] - expected).min(axis=1).max() < 1e-8 * np.abs(expected).max()


# 4.5, vibration


def peaks(y: Any, parts: int) -> list[float]:
    return [float(np.abs(piece).max()) for piece in np.array_split(y, parts)]


def test_the_beam_settles_at_9_and_flutters_at_112() -> None:
    """Figs. 8 and 9, each to the exact growth of the slowest mode."""
    stable = fb.respond(system(9.0), 40.0, 0.01, sensors=[0.1])
    rate = fb.spectrum(system(9.0)).growth_rate
    for values in (stable.y, stable.dy, stable.ddy):
        first, *_, last = peaks(values[:, 0], 8)
        assert last < first * math.exp(0.9 * rate * 35)
    unstable = fb.respond(system(112.0), 5.0, 0.002, sensors=[0.1])
    rate = fb.spectrum(system(112.0)).growth_rate
    assert rate > 1
    one, two = peaks(unstable.y[1250:, 0], 2)
    assert math.log(two / one) / 1.25 == pytest.approx(rate, rel=0.05)


def steady(s: fb.System, amplitude: float, elastic: bool = True) -> Any:
    """Response at 0.1 to amplitude · sin 3t at the end, over the last ten periods of 80 time units."""
    response = fb.respond(s, 80.0, 0.01, force=lambda t: amplitude * np.sin(3 * t), force_position=1.0, sensors=[0.1])
    last = response.t > 80.0 - 20 * math.pi / 3
    return response.t[last], (response.y_elastic if elastic else response.y)[last, 0]


def amplitude(s: fb.System, force: float) -> float:
    return float(np.abs(steady(s, force)[1]).max())


def test_the_force_is_slower_than_the_beam() -> None:
    """The force's frequency is "taken to be smaller than that of the model"."""
    for load in (5.0, 50.0):
        assert np.abs(fb.spectrum(system(load)).eigenvalues.imag).min() > 3


@pytest.mark.parametrize("load", [5.0, 50.0])
def test_forced_motion_settles_to_the_frequency_of_the_force(load: float) -> None:
    """Fig. 10: the free oscillation dies, the amplitude "tends to a fixed value"."""
    t, y = steady(system(load), 0.001)
    waves = np.column_stack([np.sin(3 * t), np.cos(3 * t)])
    fitted = waves @ np.linalg.lstsq(waves, y)[0]
    assert np.abs(y - fitted).max() < 1e-6 * np.abs(y).max()
    s = system(load)  # and to the amplitude of the exact transfer function
    transfer = s.shapes(0.1) @ np.linalg.solve(-9 * s.M + 3j * s.C + s.K, s.Q(1.0))
    assert np.abs(y).max() == pytest.approx(0.001 * abs(transfer), rel=1e-3)


@pytest.mark.parametrize("load", [5.0, 50.0])
def test_twice_the_transversal_force_is_twice_the_motion(load: float) -> None:
    one, two = steady(system(load), 0.001)[1], steady(system(load), 0.002)[1]
    np.testing.assert_allclose(two, 2 * one, rtol=0, atol=1e-12 * np.abs(two).max())


def test_more_follower_force_is_more_motion_by_how_much() -> None:
    """Fig. 10, elastic part: from P₀ = 5 to 50 the amplitude rises by 28 % with the equation as derived, by 151 %
    with Eq. (11) as printed (end term transposed)."""

    def printed(s: fb.System) -> fb.System:
        end = np.outer(s.shapes(1.0), s.shapes(1.0, 1))
        return replace(s, K=s.K + s.load * (end.T - end))

    derived = amplitude(system(50.0), 0.001) / amplitude(system(5.0), 0.001)
    transposed = amplitude(printed(system(50.0)), 0.001) / amplitude(printed(system(5.0)), 0.001)
    assert 1.25 < derived < 1.32
    assert 2.4 < transposed < 2.6
    # and it rises throughout
    rising = [amplitude(system(load), 0.001) for load in (0.0, 5.0, 20.0, 35.0, 50.0)]
    assert (np.diff(rising) > 0).all()


def test_the_free_beam_itself_does_not_tend_to_a_fixed_amplitude() -> None:
    """The claim holds for the elastic part. The rigid motion that an unsteered beam adds at the sensor drifts."""
    _, whole = steady(system(5.0, rigid=True), 0.001, elastic=False)
    _, elastic = steady(system(5.0, rigid=True), 0.001)
    _, alone = steady(system(5.0), 0.001)
    np.testing.assert_allclose(elastic, alone, rtol=0, atol=1e-9 * np.abs(alone).max())
    assert abs(whole[-1] - whole[0]) > 1e3 * np.abs(elastic).max()
