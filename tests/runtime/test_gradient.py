"""Derivatives of critical loads by every parameter, against differences of the loads themselves. Section 3.2."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

import freebeam as fb
from tests.stated import stated

CASES = {
    "beck": ("beck", {}, 12),
    "pflueger": ("pflueger", {}, 12),
    "pflueger, beam damped": ("pflueger, beam damped", {}, 12),
    "tip spring 35": ("tip spring 35", {}, 12),
    "crack": ("crack", {}, 10),
    "mass at a parameter": ("mass at mid-span", {}, 8),
    "absorber": ("absorber", {}, 8),
    "pipe": ("pipe", {}, 12),
}


@pytest.mark.parametrize("case", CASES)
def test_gradients_are_differences_of_loads(case: str, tmp_path: Path) -> None:
    name, more, modes = CASES[case]
    path, asked = stated(tmp_path, name)
    column = fb.column(path)
    given = {**asked, **more}
    found = fb.critical_load(column, modes, **given)
    seen = 0
    for parameter, rate in found.gradient.items():
        value = found.question.values[parameter]
        if math.isnan(rate) or value == 0:
            continue
        h = 1e-4 * abs(value)
        loads = [fb.critical_load(column, modes, **{**given, parameter: value + k * h}).load for k in (-2, -1, 1, 2)]
        differences = (loads[0] - 8 * loads[1] + 8 * loads[2] - loads[3]) / (12 * h)
        assert rate == pytest.approx(differences, rel=2e-6, abs=1e-7)
        seen += 1
    assert seen == len([p for p, v in found.question.values.items() if v and p in found.gradient])


def test_textbook_columns_have_gradients_too() -> None:
    """Beck's by the share that follows, damped by both: by the same formula, and none of damping without it."""
    beck = fb.column("beck")
    damped = fb.critical_load(beck, 12, 0.001, 0.1, eta=0.8)
    for parameter, rate in damped.gradient.items():
        value, h = damped.question.values[parameter], 1e-4 * damped.question.values[parameter]
        up, down = (
            fb.critical_load(beck, 12, **{**damped.question.values, parameter: value + s * h}).load for s in (1, -1)
        )
        assert rate == pytest.approx((up - down) / (2 * h), rel=1e-5)
    undamped = fb.critical_load(beck, 12, eta=0.8)
    assert math.isnan(undamped.gradient["alpha"]) and math.isfinite(undamped.gradient["eta"])


@pytest.mark.parametrize("damping", [{}, {"kappa": 0.5}, {"alpha": 1e-3, "beta": 0.1}])
@pytest.mark.parametrize(("name", "parameter", "value"), [("beck", "eta", 0.8), ("crack", "k", 4.0)])
def test_frequencies_move_as_their_derivatives_say(
    name: str, parameter: str, value: float, damping: dict[str, float]
) -> None:
    """Where frequencies meet, damping vanishes or is there; the load and the frequency by differences."""
    column, h = fb.column(name), 1e-4 * value

    def at(p: float) -> fb.CriticalLoad:
        return fb.critical_load(column, 6, **{parameter: p}, **damping)

    found, up, down = (at(value + k * h) for k in (0, 1, -1))
    differences = [(getattr(up, x) - getattr(down, x)) / (2 * h) for x in ("load", "frequency")]
    assert found.derivative(parameter) == pytest.approx(differences, rel=1e-5)
    if "alpha" not in damping:
        assert math.isnan(found.gradient["alpha"])


def test_light_damping_of_a_long_series_moves_the_load_by_its_square() -> None:
    """P = P₀ + kα²: dP/dα = 2kα, though the stiffness of 40 polynomials ranges over many orders; k from loads. By a
    parameter a long series tells what a short one does, with damping that is light or vanishes and without."""
    beck = fb.column("beck")
    P, twice = (fb.critical_load(beck, 40, alpha, eta=0.8).load for alpha in (5e-4, 1e-3))
    assert P is not None and twice is not None
    light = fb.critical_load(beck, 40, 1e-5, eta=0.8)
    assert light.derivative("alpha")[0] == pytest.approx(2 * (twice - P) / 7.5e-7 * 1e-5, rel=1e-3)
    for damping in ({"alpha": 1e-5}, {"kappa": 0.5}, {}):
        short, long = (fb.critical_load(beck, modes, eta=0.8, **damping).derivative("eta") for modes in (16, 40))
        assert long == pytest.approx(short, rel=2e-10)


def test_what_has_no_derivative_is_refused() -> None:
    beck = fb.column("beck")
    with pytest.raises(fb.InputError, match="load_max = 3: no load is found up to there"):
        _ = fb.critical_load(beck, 4, eta=0.8, load_max=3.0).gradient
    with pytest.raises(fb.InputError, match=r"zeta: beck has no such parameter.*; its own parameters: eta"):
        fb.critical_load(beck, 4, eta=0.8).derivative("zeta")
