"""The example notebooks run, cell by cell, and what they compute agrees with other routes."""

from __future__ import annotations

import re
from fractions import Fraction
from pathlib import Path
from typing import Any

import jupytext
import matplotlib
import numpy as np
import pytest
from scipy.interpolate import CubicHermiteSpline
from scipy.optimize import minimize_scalar

import freebeam as fb
from freebeam_derive.foreign import missing

FOLDER = Path(__file__).parents[1] / "examples"
NOTEBOOKS = {file.stem: file for file in sorted(FOLDER.glob("*.py"))}


@pytest.fixture(scope="module")
def ran() -> dict[str, dict[str, Any]]:
    """Each notebook's names after its last cell."""
    return {}


@pytest.mark.parametrize("name", sorted(NOTEBOOKS))
def test_a_notebook_runs(name: str, ran: dict[str, dict[str, Any]]) -> None:
    matplotlib.use("Agg")
    from matplotlib import pyplot

    if name == "kernel_in_c" and (lacking := missing("c")):
        pytest.skip(lacking)
    notebook = jupytext.read(NOTEBOOKS[name])
    assert notebook.metadata["kernelspec"]["name"] == "python3"
    assert notebook.cells[0].cell_type == "markdown" and notebook.cells[0].source.startswith("# ")
    assert sum(cell.cell_type == "markdown" for cell in notebook.cells) >= 5
    names: dict[str, Any] = {"__name__": "__main__"}
    try:
        for count, cell in enumerate(notebook.cells):
            if cell.cell_type == "code":
                exec(compile(cell.source, f"{name}, cell {count}", "exec"), names)
    finally:
        drawn = len(pyplot.get_fignums())
        pyplot.close("all")
    assert drawn or name == "derive"
    ran[name] = names


def test_each_is_listed() -> None:
    text = (FOLDER / "README.md").read_text(encoding="utf-8")
    assert set(re.findall(r"^- `(\w+)\.py`", text, re.MULTILINE)) == set(NOTEBOOKS)


def of(ran: dict[str, dict[str, Any]], name: str) -> dict[str, Any]:
    if name not in ran:
        pytest.skip(f"{name} did not run")
    return ran[name]


def test_derive(ran: dict[str, dict[str, Any]]) -> None:
    names = of(ran, "derive")
    assert names["difference"] < 1e-11
    assert {name: found.system.H.symmetric for name, found in names["changed"].items()} == {
        "dead-load": True, "follower": False,
    }  # fmt: skip
    assert names["P"] in names["changed"]["dead-load"].motion.condition(1, 0).free_symbols
    assert names["P"] not in names["changed"]["follower"].motion.condition(1, 0).free_symbols


def test_modes_and_precision(ran: dict[str, dict[str, Any]]) -> None:
    names = of(ran, "modes_and_precision")
    printed, kernel = (np.array(names["lost"][key]) for key in ("as printed", "kernel"))
    assert kernel.max() < 1e-13
    assert printed[-1] > 1e-3 and printed[7] > 1e3 * kernel.max()
    assert names["order"] < -2 and names["errors"]["legendre"][-1] < 1e-9
    assert all(names["certified"].proof.values())
    assert float(names["certified"].load[0]) == pytest.approx(names["critical"].load, rel=1e-12)


def test_flutter(ran: dict[str, dict[str, Any]]) -> None:
    names = of(ran, "flutter")
    below, at, above = names["balance"].values()
    assert below < 0 < above and abs(at) < 1e-8
    assert np.all(np.diff(names["angles"]) < 0) and names["angles"][-1] < 1
    assert round(1 / names["share"], 1) == pytest.approx(7, abs=0.6)  # "a seventh"
    y = np.abs(names["response"].y[:, 0])
    assert y[-400:].max() > 2 * y[:400].max()


def test_damping_paradox(ran: dict[str, dict[str, Any]]) -> None:
    names = of(ran, "damping_paradox")
    words = NOTEBOOKS["damping_paradox"].read_text(encoding="utf-8")
    beck = [fb.critical_load(names["beck"], **limit).load for limit in ({}, {"kappa": 0.0})]
    for load in (names["undamped"].load, names["limit"].load, *beck):
        assert f"{load:.2f}" in words
    assert names["little"][-1] == pytest.approx(names["limit"].load, rel=1e-9)
    for _, rule, rate in names["rates"]:
        assert rate == pytest.approx(rule, rel=1e-3)
    assert (np.diff(names["limits"]) > 0).all()
    assert names["limits"][-1] == pytest.approx(names["undamped"].load, rel=1e-3)
    for i, j in ((0, 0), (10, 4), (20, 8)):
        alpha, beta, load = names["alphas"][i], names["betas"][j], names["loads"][i, j]
        for factor, stable in ((0.9999, True), (1.0001, False)):
            assert (fb.spectrum(names["column"].system(8, load * factor, alpha, beta)).growth_rate < 0) == stable


def test_best_place(ran: dict[str, dict[str, Any]]) -> None:
    """The summit found by gradients is one, by a search without; the curve's slope is that of its loads."""
    names = of(ran, "best_place")
    column, top = names["column"], names["top"]
    by_scan = minimize_scalar(
        lambda a: -names["fb"].critical_load(column, modes=12, k=100.0, a=a).load, bounds=(0.35, 0.5), method="bounded"
    )
    assert names["k_best"] == 100 and abs(names["a_best"] - by_scan.x) < 1e-4
    assert top.load == pytest.approx(-by_scan.fun, rel=1e-9) and abs(top.gradient["a"]) < 1e-3
    assert names["before"].load < top.load < names["beyond"].load
    curve = names["curve"]
    inside = (curve.values > 0.2) & (curve.values < 0.6)
    a, load, slope = (values[inside] for values in (curve.values, curve.load, curve.slope))
    assert load == pytest.approx(CubicHermiteSpline(a[::2], load[::2], slope[::2])(a), rel=1e-4)


def test_sensor(ran: dict[str, dict[str, Any]]) -> None:
    names = of(ran, "sensor")
    EI, m, L = names["EI"], names["m"], names["L"]
    assert names["frequency_1"] == pytest.approx(4.730040744862704**2 / (2 * np.pi) * np.sqrt(EI / (m * L**4)))
    assert names["critical_thrust"] == pytest.approx(names["critical"].load * EI / L**2)
    assert names["agreement"] < 1e-9
    # Newton's law for the centre of mass, in SI: the steering force, the thrust that follows the end, the drag
    system, unit, lasting = names["system"], names["unit"], names["lasting"]
    t = names["response"].t
    force = names["pulse"] * np.where(t < lasting, np.sin(np.pi * t / lasting) ** 2, 0.0)
    end = fb.respond(system, t[-1], t[1], force=force, force_position=1.0, sensors=[0.5], states=True)
    slope = end.q @ system.shapes(1.0, 1)
    total = force * unit["force"] - names["thrust"] * slope
    total -= names["C_beta"] * L * end.dy_rigid[:, 0] * unit["velocity"]
    measured = m * L * names["response"].ddy_rigid[:, 1] * unit["acceleration"]
    np.testing.assert_allclose(measured, total, rtol=0, atol=1e-6 * np.abs(total).max())
    nodes = [places[0] for places in names["places"].values()]
    assert nodes[0] == pytest.approx(0.2242 * L, abs=1e-3 * L)  # of the unloaded beam


def test_vehicle(ran: dict[str, dict[str, Any]]) -> None:
    names = of(ran, "vehicle")
    assert names["free"].factor > 50  # "could grow a hundredfold"
    assert names["vehicle"].load > names["vehicle"].settings["thrust"] > names["borne"][0]
    assert names["difference"] < 1e-4
    assert np.abs(names["felt"]["rate"][-200:]).max() < 0.1 * np.abs(names["felt"]["rate"]).max()
    # "those of the propellant in its tanks": with the tanks frozen they are gone
    parts = [part for part in names["vehicle"].parts if part.kind == "sprung"]
    own = [np.sqrt(part.stiffness / part.mass) / (2 * np.pi) for part in parts]
    assert (names["hertz"][:2] / np.sort(own) > 1).all() and (names["hertz"][:2] / np.sort(own) < 1.3).all()


def test_own_column(ran: dict[str, dict[str, Any]]) -> None:
    """The determinant of the exact solution agrees; Euler's equation and Beck's column are limits."""
    names = of(ran, "own_column")
    critical, by_determinant = names["critical"], names["by_determinant"]
    assert by_determinant == pytest.approx([critical.load, critical.frequency**2], rel=1e-8)
    assert names["stiff"].load == pytest.approx(names["beck"].load, rel=1e-6)
    root = np.sqrt(names["dead"].load)
    assert names["dead"].kind == "divergence" and root * np.tan(root) == pytest.approx(20, rel=1e-9)
    (event,) = names["curve"].events
    assert event.what == "divergence to flutter"


def test_proof(ran: dict[str, dict[str, Any]]) -> None:
    """Two proofs and their difference fit together, and what was forged is refused."""
    names = of(ran, "proof")
    assert all(names["series"].proof.values()) and all(names["beam"].proof.values())
    assert str(names["verified"]).startswith("proven of column beck") and "frequency" in names["refused"]
    low, high = map(Fraction, names["error"].difference)
    series, beam = ([Fraction(end) for end in names[key].load] for key in ("series", "beam"))
    assert series[0] - beam[1] <= high and low <= series[1] - beam[0]
    assert names["off"][-1] < 1e-14 < names["off"][0]


def test_kernel_in_c(ran: dict[str, dict[str, Any]]) -> None:
    names = of(ran, "kernel_in_c")
    assert max(names["difference"].values()) < 1e-15
    assert names["last"] < names["critical"].load < names["last"] + names["loads"][1]
