"""Vehicles from their files: what a table means in SI units, what is computed of it, and what is refused."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import freebeam as fb
from freebeam.cli import main

EXAMPLE = Path(__file__).parents[2] / "examples" / "vehicle.toml"
EI, M, L = 2e6, 50.0, 20.0
UNIFORM = {"x": [0.0, L], "EI": [EI, EI], "m": [M, M]}
TAPERED = {"x": [2.0, 8.0, 8.0, 14.0], "EI": [1e6, 3e6, 5e6, 4e6], "m": [20.0, 60.0, 90.0, 80.0]}
PARTS = {"kind": ["mass", "sprung"], "x": [2.0, 6.0], "m": [120.0, 60.0], "k": [None, 4e3], "c": [None, 20.0]}


def table(folder: Path, text: str, name: str = "v.csv") -> Path:
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return path


def asked(capsys: pytest.CaptureFixture[str], *words: object) -> tuple[int, str, str]:
    status = main(["vehicle", *map(str, words)])
    out, err = capsys.readouterr()
    return status, out, err


def test_a_table_alone_is_a_free_vehicle_with_its_thrust_at_the_largest_x(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = table(tmp_path, f"x,EI,m\n3,{EI},{M}\n{3 + L},{EI},{M}\n")
    status, out, _ = asked(capsys, path, "--json")
    record = json.loads(out)
    paper = fb.critical_load(fb.column("free-free", "legendre"), 24)
    units = fb.column("free-free").scales(EI, M, L)
    assert paper.load is not None and paper.frequency is not None and status == 0
    assert record["load"] == pytest.approx(paper.load * units["load"], rel=1e-11)
    assert record["frequency"] == pytest.approx(paper.frequency * units["frequency"], rel=1e-11)
    assert record["kind"] == "flutter" and 0 < record["error"] < 1e-10 and record["factor"] is None
    free = fb.column("free-free").basis(5).gamma ** 2 * units["frequency"]
    assert record["frequencies"][:5] == pytest.approx(free.tolist(), rel=1e-9)
    assert abs(record["load"] / (paper.load * units["load"]) - 1) <= record["error"]


def test_a_tapered_vehicle_turned_round_is_another() -> None:
    """The end of the thrust matters: the heavy end in front, the axial force is larger along the beam."""
    ahead = fb.vehicle({"x": [0, 10], "EI": [1e6, 1e6], "m": [90, 10]}).load
    behind = fb.vehicle({"x": [0, 10], "EI": [1e6, 1e6], "m": [10, 90]}).load
    assert ahead is not None and behind is not None and ahead < behind


@pytest.mark.parametrize("factor", [1e-3, 1e6])
def test_units_are_si(factor: float) -> None:
    """Loads go with EI, rates with its root; lengths and masses by Eq. (5)."""
    one = fb.vehicle(TAPERED, parts=PARTS, damping={"ratio": 0.01})
    scaled = {**TAPERED, "EI": [factor * v for v in TAPERED["EI"]]}
    springs = {**PARTS, "k": [None, 4e3 * factor], "c": [None, 20 * math.sqrt(factor)]}
    two = fb.vehicle(scaled, parts=springs, damping={"ratio": 0.01})
    assert one.load is not None and one.frequency is not None
    assert two.load == pytest.approx(one.load * factor, rel=1e-9)
    assert two.frequency == pytest.approx(one.frequency * math.sqrt(factor), rel=1e-8)
    assert one.mass == pytest.approx(40 * 6 + 85 * 6 + 180) and one.low < one.centre < one.low + one.length


def test_a_station_given_twice_is_a_step(tmp_path: Path) -> None:
    steps = {"x": [0, 4, 10], "EI": [1e6, 2e6, 7.0], "m": [30, 50, 7.0]}
    twice = {"x": [0, 4, 4, 10], "EI": [1e6, 1e6, 2e6, 2e6], "m": [30, 30, 50, 50]}
    one, two = fb.vehicle(steps, interpolation="steps"), fb.vehicle(twice)
    assert one.load == two.load and one.mass == two.mass == 4 * 30 + 6 * 50


def test_a_search_that_ends_before_the_loss_says_so(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = table(tmp_path, f"x,EI,m\n0,{EI},{M}\n{L},{EI},{M}\n")
    record = json.loads(asked(capsys, path, "--load-max", 1e5, "--json")[1])
    assert (record["load"], record["kind"], record["frequency"], record["load_max"]) == (None, "none", None, 1e5)
    out = asked(capsys, path, "--load-max", 1e5)[1]
    assert "not lost up to a thrust of 100000 N\n" in out


def test_dampings_are_those_of_eq_12() -> None:
    """Of a uniform vehicle C_alpha and C_beta are the paper's; a ratio is that of each mode without thrust."""
    units = fb.column("free-free").scales(EI, M, L)
    vehicle = fb.vehicle(UNIFORM, damping={"C_alpha": 1e-3, "C_beta": 4.0})
    paper = fb.critical_load(
        fb.column("free-free", "legendre"), 24, alpha=1e-3 / units["alpha"], beta=4.0 / units["beta"]
    )
    assert paper.load is not None
    assert vehicle.load == pytest.approx(paper.load * units["load"], rel=1e-9)
    modes = fb.vehicle(TAPERED, damping={"ratio": 0.02}).modes(0.0, 5)
    np.testing.assert_allclose(-modes.growth / np.hypot(modes.growth, modes.frequency), 0.02, rtol=1e-7)


@pytest.mark.parametrize(("damping", "more"), [({"ratio": 0.01}, 1), ({}, 3)])
def test_the_loss_is_where_growth_begins_and_its_error_holds(damping: dict[str, float], more: int) -> None:
    vehicle = fb.vehicle(TAPERED, parts=PARTS, damping=damping, thrust=2e4)
    loss = vehicle.loss
    assert loss.load is not None and loss.error is not None and loss.error < 1e-4
    for share, grows in ((1 - 1e-4, False), (1 + 1e-4, True)):
        growth = vehicle.modes(loss.load * share, 6).growth
        assert (growth.max() > 1e-9) == grows
    finer = fb.critical_load(vehicle.column(), loss.degree + more, **vehicle.question().parameters).load
    assert finer is not None
    assert abs(loss.load / (finer * vehicle.units["load"]) - 1) <= loss.error
    assert vehicle.factor == pytest.approx(loss.load / 2e4)


def test_the_error_holds_of_rough_tables() -> None:
    """Of tables with noise and many masses, on which the trial functions converge slowly."""
    random = np.random.default_rng(3)
    for _ in range(5):
        x = np.linspace(0, 30, 60)
        stiffness, mass = (np.exp(np.cumsum(random.normal(0, 0.1, 60))) for _ in range(2))
        parts = {"x": np.sort(random.uniform(0, 30, 8)), "m": random.uniform(50, 500, 8)}
        vehicle = fb.vehicle({"x": x, "EI": 1e8 * stiffness, "m": 100 * mass}, parts=parts)
        loss = vehicle.loss
        finer = fb.critical_load(vehicle.column(), loss.degree + 4).load
        assert loss.load is not None and loss.error is not None and finer is not None and loss.error < 1e-3
        assert abs(loss.load / (finer * vehicle.units["load"]) - 1) <= loss.error


def test_the_map_agrees_with_the_losses_along_it() -> None:
    law = {"gain": 0.3, "rate": 0.2, "sensor": 10.0, "actuator": 30.0}
    vehicle = fb.vehicle(TAPERED, damping={"ratio": 0.01}, gimbal=law)
    free = fb.vehicle(TAPERED, damping={"ratio": 0.01}).load
    assert free is not None and vehicle.load is not None
    found = vehicle.map([0.0, 0.3], np.array([0.5, 0.98, 1.02]) * vehicle.load)
    assert found.load[1] == pytest.approx(vehicle.load, rel=1e-3)
    np.testing.assert_array_equal(found.growth[1] > 0, [False, False, True])
    assert math.isnan(found.load[0]) == (free > 1.02 * vehicle.load)


def test_the_state_space_is_newtons_law_and_the_spectrum() -> None:
    """Slow forces move it as one body; its poles are the eigenvalues; a response is that of the same system."""
    vehicle = fb.vehicle(TAPERED, parts=PARTS, damping={"ratio": 0.01}, thrust=1e4, imu=5.0, control=vehicle_end())
    high = vehicle.state_space(1e-3, input="control", outputs=("ddy",), sensors=vehicle.centre)
    omega = 0.01 * vehicle.frequencies[0]
    slow = vehicle.frequency_response([omega], 1e-3, input="control", outputs=("ddy",), sensors=vehicle.centre)
    assert slow[0, 0].real == pytest.approx(1 / vehicle.mass, rel=1e-3)
    poles = np.sort_complex(np.linalg.eigvals(high.A))
    modes = vehicle.modes(1e-3, 3)
    for growth, frequency in zip(modes.growth, modes.frequency, strict=True):
        assert np.abs(poles - (growth + 1j * frequency)).min() < 1e-6 * frequency
    w = 1.7 * vehicle.frequencies[0]
    found = vehicle.respond(1.0, 0.002, lambda t: 1e-3 * np.sin(w * t), outputs=("angle", "rate", "ddy", "y"))
    s = vehicle.state_space(outputs=("angle", "ddy"))
    from scipy.signal import lsim

    _, wanted, _ = lsim(s, 1e-3 * np.sin(w * found["t"]), found["t"])
    for k, name in enumerate(("angle", "ddy")):
        np.testing.assert_allclose(found[name][:, 0], wanted[:, k], atol=1e-6 * np.abs(wanted[:, k]).max())
    rate = np.gradient(found["angle"][:, 0], found["t"])
    np.testing.assert_allclose(found["rate"][5:-5, 0], rate[5:-5], atol=1e-2 * np.abs(rate).max())


def vehicle_end() -> float:
    return TAPERED["x"][-1]


def test_a_law_closed_by_hand_is_the_law() -> None:
    """The gimbal input fed back from the sensor has the poles of the vehicle that is steered."""
    law = {"gain": 0.3, "rate": 0.05, "sensor": 9.0}
    steered = fb.vehicle(TAPERED, thrust=2e4, gimbal=law, damping={"ratio": 0.01})
    free = fb.vehicle(TAPERED, thrust=2e4, damping={"ratio": 0.01})
    s = free.state_space(outputs=("angle", "rate"), sensors=9.0, degree=steered._fine)
    closed = np.linalg.eigvals(s.A + s.B @ (np.array([[law["gain"], law["rate"]]]) @ s.C))
    modes = steered.modes(number=4)
    for growth, frequency in zip(modes.growth, modes.frequency, strict=True):
        assert np.abs(closed - (growth + 1j * frequency)).min() < 2e-4 * math.hypot(growth, frequency)


def test_a_file_that_names_all_is_what_its_options_are(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    rows = "\n".join(f"{x},{k},{m}" for x, k, m in zip(*TAPERED.values(), strict=True))
    stations = table(tmp_path, f"# a remark\nx [m], EI [kN m^2], m\n{rows}\n".replace("000000.0", "000.0"))
    parts = table(tmp_path, "kind,x,m,k,c\nmass,2,120,,\nsprung,6,60,4e3,20\n", "parts.csv")
    all_in = table(
        tmp_path,
        'stations = "v.csv"\nthrust = "20 kN"\nimu = 5\n[[mass]]\nx = 2\nm = 120\n[[sprung]]\nx = 6\nm = 60\nk = 4e3\n'
        "c = 20\n[damping]\nratio = 0.01\n[gimbal]\ngain = 0.1\nsensor = 10\nrate = 0.1\nactuator = 40\n",
        "v.toml",
    )
    options = ["--thrust", 20000, "--imu", 5, "--damping-ratio", 0.01, "--gain", 0.1, "--rate", 0.1, "--sensor", 10]
    one = json.loads(asked(capsys, all_in, "--json")[1])
    two = json.loads(asked(capsys, stations, "--parts", parts, *options, "--actuator", 40, "--json")[1])
    assert {**one, "report": 0} == {**two, "report": 0}
    assert one["settings"]["thrust"] == 20000 and one["factor"] == pytest.approx(one["load"] / 2e4)


WRONG = {
    "gap": ("x,EI,m\n0,2e6,50\n1,,50\n2,2e6,50\n", "row 3, column EI: is empty"),
    "not a number": ("x,EI,m\n0,2e6,50\n1,soft,50\n", "row 3, column EI: 'soft' is not a number"),
    "nan": ("x,EI,m\n0,2e6,50\n1,2e6,nan\n", "row 3, column m = nan: must be finite"),
    "infinite": ("x,EI,m\n0,2e6,50\n1,inf,50\n", "row 3, column EI = inf: must be finite"),
    "short row": ("x,EI,m\n0,2e6,50\n1,2e6\n", "row 3: has 2 cells where the header has 3"),
    "order": ("x,EI,m\n0,2e6,50\n2,2e6,50\n1,2e6,50\n", "row 4, column x = 1: must be greater than 2"),
    "thrice": ("x,EI,m\n0,1,1\n1,1,1\n1,1,1\n1,1,1\n2,1,1\n", "row 5, column x = 1: must be greater"),
    "negative stiffness": ("x,EI,m\n0,2e6,50\n1,-2e6,50\n", "row 3, column EI = -2e+06: must be greater than zero"),
    "no stiffness": ("x,EI,m\n0,2e6,50\n1,0,50\n", "row 3, column EI = 0: must be greater than zero"),
    "negative mass": ("x,EI,m\n0,2e6,50\n1,2e6,-1\n", "row 3, column m = -1: must be zero or greater"),
    "no mass": ("x,EI,m\n0,2e6,50\n1,2e6,0\n2,2e6,0\n", "row 3, column m = 0: the vehicle has no mass"),
    "missing": ("x,EI\n0,2e6\n1,2e6\n", "the column m is missing"),
    "unknown": ("x,EI,m,rho\n0,2e6,5,5\n1,2e6,5,5\n", "the column rho is not known"),
    "unit": ("x,EI [kg],m\n0,2e6,50\n1,2e6,50\n", "column EI: the unit kg does not fit N m^2"),
    "no unit": ("x,EI [furbs],m\n0,2e6,50\n1,2e6,50\n", "column EI: the unit furbs is no unit"),
    "one station": ("x,EI,m\n0,2e6,50\n", "has 1 station; a vehicle needs two or more"),
    "empty": ("", "is empty"),
}


def one_line(status: int, out: str, err: str, *says: str) -> None:
    assert status == 2 and not out and err.count("\n") == 1 and err.startswith("freebeam: ") and "Traceback" not in err
    for text in says:
        assert text in err


@pytest.mark.parametrize("case", WRONG)
def test_a_bad_table_is_one_line_with_row_and_column(
    case: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text, says = WRONG[case]
    one_line(*asked(capsys, table(tmp_path, text)), says, "v.csv")


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("x,m\n30,5\n", "row 2, column x = 30: a mass must lie on the vehicle, from 0 to 20 m"),
        ("x,m\n3,-5\n", "row 2, column m = -5: must be zero or greater"),
        ("kind,x,m\nmass,3,\n", "row 2, column m: is missing; a mass needs its mass"),
        ("kind,x,m,k\nballoon,3,1,\n", "row 2, column kind = 'balloon': must be one of mass, sprung, spring, joint"),
        ("kind,x,k\njoint,20,5\n", "row 2, column x = 20: a joint must lie inside the vehicle"),
        ("kind,x,m,k\nmass,3,1,9\n", "row 2, column k = 9: a mass has m and J"),
        ("kind,x,k\nspring,3,9\n", "one spring to the ground"),
    ],
)
def test_bad_parts_are_one_line(text: str, says: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    stations = table(tmp_path, f"x,EI,m\n0,{EI},{M}\n20,{EI},{M}\n")
    one_line(*asked(capsys, stations, "--parts", table(tmp_path, text, "p.csv")), says)


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("thrust = 0", "thrust = 0: has no direction"),
        ("thrust = -5e5", "thrust = -500000: has no direction"),
        ('thrust = "strong"', "thrust: must be a number in N"),
        ('thrust = "5 m"', "thrust: the unit m does not fit N"),
        ("imu = 21", "imu = 21: must lie on the vehicle, from 0 to 20 m"),
        ("trust = 5", "trust is not known (did you mean thrust?)"),
        ("[gimbal]\ngain = 0.2", "gimbal.sensor is missing"),
        ("[gimbal]\ngian = 0.2", "gimbal.gian is not known (did you mean gimbal.gain?)"),
        ("[gimbal]\nrate = 0.2\nsensor = 3", "gimbal.rate = 0.2: needs a gain too"),
        ("[damping]\nratio = -0.1", "damping.ratio = -0.1: must be zero or greater"),
        ("[damping]\nratio = 0.1\nC_alpha = 1", "give a ratio, or C_alpha and C_beta"),
        ('interpolation = "cubic"', 'must be "linear" or "steps"'),
        ("[[mass]]\nx = 25\nm = 3", "mass 1, x = 25: a mass must lie on the vehicle"),
        ("parts = [1]", "parts: must be the name of a table"),
        ("thrust 5", "is no TOML"),
    ],
)
def test_a_bad_file_is_one_line(text: str, says: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    table(tmp_path, f"x,EI,m\n0,{EI},{M}\n20,{EI},{M}\n")
    one_line(*asked(capsys, table(tmp_path, f'stations = "v.csv"\n{text}\n', "v.toml")), says)


def test_without_pint_other_units_are_refused_with_the_cure(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    import sys

    monkeypatch.setitem(sys.modules, "pint", None)
    path = table(tmp_path, "x [m],EI [N*m**2],m [lb/ft]\n0,2e6,50\n20,2e6,50\n")
    one_line(*asked(capsys, path), "the unit lb/ft is not kg/m", "freebeam[units]")


def test_a_law_that_grows_at_once_says_so() -> None:
    vehicle = fb.vehicle(UNIFORM, gimbal={"gain": -0.5, "sensor": 10.0})
    with pytest.raises(fb.InputError, match=r"gimbal law with gain -0.5 .*smallest loads"):
        _ = vehicle.load
    found = vehicle.map([-0.5], [1e4])
    assert found.load[0] == 0 and found.growth[0, 0] > 0


def test_the_report_stands_alone_and_overwrites_nothing(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("freebeam.vehicles.report.GAINS", 2)
    monkeypatch.setattr("freebeam.vehicles.report.THRUSTS", 4)
    path = tmp_path / "r.html"
    status, out, _ = asked(capsys, EXAMPLE, "--report", path)
    text = path.read_text(encoding="utf-8")
    assert status == 0 and str(path) in out
    assert text.count("<img") == 7 and text.count("data:image/svg+xml;base64") == 7 and "http" not in text
    load = fb.vehicle(EXAMPLE).load
    assert load is not None and f"{load:.4g}"[:4] in text
    one_line(*asked(capsys, EXAMPLE, "--report", path), "exists", "--force")
    assert path.read_text(encoding="utf-8") == text
    one_line(*asked(capsys, EXAMPLE, "--report", tmp_path / "r.docx"), "must end in .html or .pdf")
    assert not (tmp_path / "r.docx").exists()


def test_a_report_as_pdf_has_a_page_for_each_picture(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    stations = table(tmp_path, f"x,EI,m\n0,{EI},{M}\n20,{EI},{M}\n")
    for more, pages in (([], 5), (["--load-max", 1e5], 4)):  # without a loss there is no motion of it
        path = tmp_path / f"r{pages}.pdf"
        assert asked(capsys, stations, *more, "--report", path)[0] == 0
        data = path.read_bytes()
        assert data.startswith(b"%PDF") and data.count(b"/Type /Page ") == pages


def test_python_refuses_what_is_no_vehicle() -> None:
    bad: Any
    for bad, says in ((5, "must be the path"), ({"x": [0, 1], "EI": [1], "m": [1, 1]}, "different lengths")):
        with pytest.raises(fb.InputError, match=says):
            fb.vehicle(bad)
    with pytest.raises(fb.InputError, match=r"EI\[1\] = -1"):
        fb.vehicle({"x": [0, 1], "EI": [1, -1], "m": [1, 1]})
    with pytest.raises(fb.InputError, match="imu is missing"):
        fb.vehicle(UNIFORM, thrust=1.0).state_space()
    with pytest.raises(fb.InputError, match="thrust is missing"):
        fb.vehicle(UNIFORM).modes()


def test_nothing_is_proven_of_tables_and_a_shape_starts_a_motion(tmp_path: Path) -> None:
    """Every proof refuses in one line; a function of x is an initial state as for any other column."""
    file = tmp_path / "uniform.csv"
    file.write_text("x,EI,m\n0,1,1\n1,1,1\n", encoding="utf-8")
    column = fb.vehicle(file).column()
    proofs: list[Callable[[], object]] = [
        lambda: fb.certified_load(column, 3), lambda: fb.certified_crossings(column, 3), lambda: fb.exact_load(column),
        lambda: fb.exact_spectrum(column, 1.0), lambda: fb.truncation_error(column, 3),
        lambda: fb.certified_pulse(column, 3, load=1, frequency=3, amplitude="0.1"),
    ]  # fmt: skip
    for proof in proofs:
        with pytest.raises(fb.InputError, match="assembled from tables in floats, of which nothing can be proven"):
            proof()
    system = column.system(load=0.0)
    bent = fb.respond(system, 0.1, 0.1, initial=lambda x: x**2 - x + 1 / 6, sensors=[0.0, 0.5])
    assert bent.initial_lost < 1e-3 and bent.y[0] == pytest.approx([1 / 6, -1 / 12], abs=1e-3)
    assert fb.figures.beam(column).get_figure() is not None
