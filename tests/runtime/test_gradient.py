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
    with pytest.raises(fb.InputError, match="vanishing damping"):
        _ = fb.critical_load(beck, 12, kappa=1.0).gradient
