"""The command line: names, options and keys are a contract, bad input is one line and exit status 2."""

import csv
import dataclasses
import inspect
import io
import json
import math
import os
import re
import subprocess
import sys
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest

import freebeam as fb
from freebeam import cli, own

# A column that the tree does not hold: clamped at both ends under a dead load, which diverges at 4 π².
CLAMPED = """
from freebeam_derive.notation import P, alpha, beta, t, x, y
from freebeam_derive.statement import Column, delta, integral

column = Column(
    name="clamped-clamped",
    title="Clamped at both ends under a dead load",
    T=integral(y.diff(t) ** 2) / 2,
    V=integral(y.diff(x, 2) ** 2) / 2,
    W_c=P * integral(y.diff(x) ** 2) / 2,
    dW_nc=-integral(beta * y.diff(t) * delta(y) + alpha * y.diff(x, 2, t) * delta(y.diff(x, 2))),
    ends=("clamped", "clamped"),
)
"""

BEAM = {"bending-stiffness": 2.5e6, "mass-per-length": 40.0, "length": 12.0}
RESPOND = ["respond", "--load", "9", "--duration", "1", "--step", "0.01"]


class Run:
    def __init__(self, status: int, out: str, err: str) -> None:
        self.status, self.out, self.err = status, out, err

    @property
    def json(self) -> dict:
        """The one object on standard output, which holds nothing else and no number that is not finite."""
        assert (self.status, self.err) == (0, "")
        assert self.out.endswith("}\n")

        def refuse(name: str) -> None:
            raise AssertionError(f"{name} in JSON")

        return json.loads(self.out, parse_constant=refuse)

    @property
    def table(self) -> dict[str, np.ndarray]:
        """The CSV on standard output, by column."""
        assert self.status == 0
        header, *rows = csv.reader(io.StringIO(self.out))
        return dict(zip(header, np.array(rows, dtype=float).T, strict=True))


@pytest.fixture
def freebeam(capsys):
    def run(*arguments: object) -> Run:
        status = cli.main([str(argument) for argument in arguments])
        return Run(status, *capsys.readouterr())

    return run


@pytest.fixture(autouse=True)
def private_cache(tmp_path_factory, monkeypatch):
    """One cache for this run of the tests, apart from the user's."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path_factory.getbasetemp() / "cache"))
    monkeypatch.setenv("LOCALAPPDATA", str(tmp_path_factory.getbasetemp() / "cache"))


@pytest.fixture
def clamped(tmp_path) -> Path:
    file = tmp_path / "clamped.py"
    file.write_text(CLAMPED, encoding="utf-8")
    return file


def beam_options(beam: dict[str, float]) -> list[object]:
    return [word for name, value in beam.items() for word in (f"--{name}", value)]


def scales(beam: dict[str, float]) -> tuple[float, float]:
    """Load EI / L² and time (m L⁴ / EI)^(1/2) of one nondimensional unit, Eq. (5)."""
    stiffness, mass, length = beam.values()
    return stiffness / length**2, math.sqrt(mass * length**4 / stiffness)


# --- the contract -------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "command", ["columns", "generate", "critical", "figures", "spectrum", "respond", "validate", "pulse"]
)
def test_help_has_an_example(freebeam, command):
    run = freebeam(command, "--help")
    assert run.status == 0
    assert f"Example: freebeam {command}" in run.out
    assert "--json" in run.out


def test_columns(freebeam):
    found = {column["name"]: column for column in freebeam("columns", "--json").json["columns"]}
    assert set(found) == set(fb.column_names()) >= {"free-free", "beck", "euler-pinned"}
    (eta,) = found["beck"]["parameters"]
    assert eta["name"] == "eta" and eta["low"] <= eta["default"] <= eta["high"]
    text = freebeam("columns").out
    assert all(name in text for name in found)


def test_critical_is_the_boundary_of_the_spectrum(freebeam):
    """Just below the critical load no eigenvalue of the spectrum command grows, just above one does."""
    options = ["--column", "beck", "--set", "eta=0.9", "--alpha", "1e-3", "--beta", "0.1", "--json"]
    found = freebeam("critical", *options).json
    keys = "column modes alpha beta load kind frequency converged load_max"
    assert set(found) >= set(keys.split())
    assert (found["column"], found["modes"], found["alpha"], found["beta"]) == ("beck", 16, 1e-3, 0.1)
    assert found["kind"] == "flutter" and isinstance(found["converged"], bool)
    growth = []
    for factor in (1 - 1e-6, 1 + 1e-6):
        load = repr(found["load"] * factor)
        values = freebeam("spectrum", "--load", load, *options).json["eigenvalues"]
        growth.append(max(re for re, _ in values))
    assert growth[0] < 0 < growth[1]


def test_critical_says_none_up_to_the_load_searched(freebeam):
    found = freebeam("critical", "--load-max", "50", "--json").json
    assert (found["kind"], found["load"], found["frequency"], found["load_max"]) == ("none", None, None, 50)
    assert "50" in freebeam("critical", "--load-max", "50").out


def test_spectrum_is_sorted_and_complete(freebeam):
    found = freebeam("spectrum", "--load", "50", "--beta", "0.1", "--modes", "5", "--json").json
    values = [complex(*pair) for pair in found["eigenvalues"]]
    assert len(values) == 10
    keys = [(round(abs(value.imag), 9), value.real) for value in values]
    assert keys == sorted(keys)
    assert sum(values).imag == pytest.approx(0, abs=1e-9)
    gamma = fb.column("free-free").system(modes=1).gamma[0]
    assert found["reference_frequency"] == pytest.approx(math.sqrt(gamma**4 - 0.1**2 / 4), rel=1e-6)


def test_reference_frequency_is_null_where_mode_1_is_overdamped(freebeam):
    gamma = fb.column("free-free").system(modes=1).gamma[0]
    for factor, exists in ((0.99, True), (1.01, False)):
        alpha = repr(float(factor * 2 / gamma**2))
        found = freebeam("spectrum", "--load", "1", "--alpha", alpha, "--json").json
        assert (found["reference_frequency"] is not None) == exists


def test_rigid_functions_add_eigenvalues(freebeam):
    elastic, whole = (
        freebeam("spectrum", "--load", "50", "--modes", "4", *flag, "--json").json["eigenvalues"]
        for flag in ([], ["--rigid"])
    )
    assert len(whole) == len(elastic) + 4


def test_response_of_mode_1_is_a_cosine(freebeam):
    """Unloaded and undamped, q = 0.01 cos(γ₁² t): the default state, with y, dy, ddy beside one another."""
    run = freebeam("respond", "--load", "0", "--duration", "0.5", "--step", "0.005", "--sensor", "0.1")
    assert run.out.splitlines()[0] == "t,y(0.1),dy(0.1),ddy(0.1)"
    table = run.table
    system = fb.column("free-free").system(modes=1, load=0)
    omega, shape = system.gamma[0] ** 2, system.shapes(np.array([0.1]))[0, 0]
    phase = omega * table["t"]
    assert table["t"][-1] == pytest.approx(0.5)
    motion = {"y": np.cos(phase), "dy": -omega * np.sin(phase), "ddy": -(omega**2) * np.cos(phase)}
    for name, expected in motion.items():
        error = np.abs(table[f"{name}(0.1)"] - 0.01 * shape * expected).max()
        assert error < 1e-12 * np.abs(table[f"{name}(0.1)"]).max()


def test_initial_velocity_sets_the_rate_alone(freebeam):
    options = ["--initial-mode", "2", "--initial-velocity", "0.3", "--json"]
    found = freebeam(*RESPOND, *options).json
    shape = fb.column("free-free").system(modes=2, load=0).shapes(np.array([0.1]))[1, 0]
    assert found["y"][0] == [0]
    assert found["dy"][0][0] == pytest.approx(0.3 * shape)


def test_forced_response_starts_at_rest_and_is_linear_in_the_force(freebeam):
    def response(amplitude: float) -> np.ndarray:
        force = ["--force-amplitude", amplitude, "--force-frequency", "3", "--force-position", "1"]
        return np.array(freebeam(*RESPOND, "--sensor", "0.1", "--sensor", "1", *force, "--json").json["y"])

    one, three = response(1e-3), response(3e-3)
    assert one.shape == (101, 2) and not one[0].any() and one[-1].all()
    np.testing.assert_allclose(three, 3 * one, rtol=1e-9, atol=1e-18)


def test_a_response_is_the_same_in_either_basis(freebeam):
    """To a force at mid-span; the modes' series converges from 8 to 32 functions to what the polynomials give."""
    force = ["--force-amplitude", "1", "--force-frequency", "3", "--force-position", "0.5", "--quantity", "y", "--json"]

    def response(*options: str) -> np.ndarray:
        return np.array(freebeam(*RESPOND, *force, *options).json["y"])

    polynomials = response("--basis", "legendre", "--modes", "16")
    errors = [np.abs(response("--modes", N) - polynomials).max() / np.abs(polynomials).max() for N in ("8", "32")]
    assert errors[1] < errors[0] / 4 < 1e-3


def test_sensors_may_follow_one_option(freebeam):
    either = freebeam(*RESPOND, "--sensor", "0.1", "0.50", "1")
    assert either.out == freebeam(*RESPOND, "--sensor", "0.1", "--sensor", "0.50", "--sensor", "1").out
    assert "ddy(0.1),y(0.50),dy(0.50)" in either.out.splitlines()[0]


def test_outputs_agree_and_are_whole(freebeam, tmp_path):
    printed = freebeam(*RESPOND, "--rigid", "--sensor", "0.1", "0.7")
    found = freebeam(*RESPOND, "--rigid", "--sensor", "0.1", "0.7", "--json").json
    for file in (tmp_path / "r.csv", tmp_path / "r.npz"):
        run = freebeam(*RESPOND, "--rigid", "--sensor", "0.1", "0.7", "--output", file, "--json")
        assert Path(run.json["output"]) == file
    settings, table = (tmp_path / "r.csv").read_text(encoding="utf-8").split("\n", 1)
    assert table == printed.out and settings.startswith("# freebeam respond {")
    settings = json.loads(settings.removeprefix("# freebeam respond "))
    assert {**settings, "load": 9, "rigid": True, "step": 0.01, "sensors": [0.1, 0.7]} == settings
    with np.load(tmp_path / "r.npz") as stored:
        assert stored["sensors"].tolist() == [0.1, 0.7]
        for name in ("t", "y", "dy", "ddy"):
            assert stored[name].tolist() == found[name]
        assert json.loads(str(stored["settings"])) == settings | {
            key: found[key] for key in ("period_error", "phase_error", "samples_per_period", "growth", "warnings")
        }
        np.testing.assert_array_equal(stored["y"][:, 1], printed.table["y(0.7)"])
    assert sorted(file.name for file in tmp_path.iterdir()) == ["r.csv", "r.npz"]


@pytest.mark.parametrize("suffix", ["csv", "npz"])
def test_a_long_response_is_written_part_by_part(freebeam, tmp_path, monkeypatch, suffix):
    """As the whole of it, and only what is asked for."""
    monkeypatch.setattr("freebeam_sym.response.propagation.STRETCH", 8)
    file = tmp_path / f"r.{suffix}"
    options = ["respond", "--load", "9", "--duration", "3", "--step", "0.001", "--sensor", "0.1", "--quantity", "ddy"]
    freebeam(*options, "--output", file)
    monkeypatch.undo()
    whole = freebeam(*options, "--json").json
    if suffix == "csv":  # as NumPy reads it, and pandas
        stored = np.genfromtxt(file, delimiter=",", names=True, deletechars="", skip_header=1)
        frame = pytest.importorskip("pandas").read_csv(file, comment="#")
        assert list(frame) == ["t", "ddy(0.1)"] and frame["t"].tolist() == whole["t"]
    else:
        stored = np.load(file)
    assert len(whole["t"]) == 3001 and "y" not in whole
    np.testing.assert_array_equal(stored["t"], whole["t"])
    found = stored["ddy"][:, 0] if suffix == "npz" else stored["ddy(0.1)"]
    expected = np.array(whole["ddy"])[:, 0]
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-12 * np.abs(found).max())


def test_an_output_that_exists_is_kept_unless_forced(freebeam, tmp_path):
    file = tmp_path / "r.csv"
    file.write_text("precious", encoding="utf-8")
    run = freebeam(*RESPOND, "--output", file)
    assert run.status == 2 and "--force" in run.err and file.read_text(encoding="utf-8") == "precious"
    assert freebeam(*RESPOND, "--output", file, "--force").status == 0
    assert file.read_text(encoding="utf-8").split("\n")[1].startswith("t,y(0.1)")


@pytest.mark.parametrize("failure", [KeyboardInterrupt, fb.InputError("too much")])
def test_a_response_that_ends_early_leaves_the_old_file(freebeam, tmp_path, monkeypatch, failure):
    file = tmp_path / "r.csv"
    file.write_text("precious", encoding="utf-8")

    def fail(*_: object, **__: object) -> None:
        raise failure

    monkeypatch.setattr("freebeam.cli.responding.write_csv", fail)
    run = freebeam(*RESPOND, "--output", file, "--force")
    assert run.status == (130 if failure is KeyboardInterrupt else 2)
    assert len(run.err.split("\n")) == 2 and run.err.startswith("freebeam: ")
    assert [(f.name, f.read_text(encoding="utf-8")) for f in tmp_path.iterdir()] == [("r.csv", "precious")]


def test_si_units_in_and_out(freebeam):
    """A beam in SI units gives the nondimensional answers times Eq. (5)."""
    load, time = scales(BEAM)
    bare = freebeam("critical", "--alpha", "1e-3", "--beta", "0.1", "--json").json
    damping = ["--alpha", repr(1e-3 * time), "--beta", repr(0.1 * BEAM["mass-per-length"] / time)]
    si = freebeam("critical", *damping, *beam_options(BEAM), "--json").json
    assert (bare["units"], si["units"]) == ("nondimensional", "SI")
    assert si["load"] == pytest.approx(bare["load"] * load, rel=1e-9)
    assert si["frequency"] == pytest.approx(bare["frequency"] / time, rel=1e-9)
    assert " N" in freebeam("critical", *beam_options(BEAM)).out


@pytest.mark.parametrize("name", ["panel-pinned", "pipe"])
def test_what_is_proven_in_si_units_holds_the_float_in_si_units(freebeam, name):
    """Of a load per length and of a velocity too, whose sizes are others than a force's."""
    found = freebeam("critical", "--column", name, *beam_options(BEAM), "--digits", "9", "--json").json
    assert float(found["load_lower"]) <= found["beam"]["load"] <= float(found["load_upper"])
    column = fb.column(name)
    bare = fb.critical_load(column)
    assert found["beam"]["load"] == pytest.approx(bare.load * column.scales(*BEAM.values())["load"], rel=1e-11)


def test_parameters_in_si_units(freebeam, tmp_path):
    """By the names of the dimensional statement; a velocity that makes a pipe flutter is u (EI / M_f)^½ / L."""
    beam = BEAM | {"mass-per-length": 41.0}
    stiffness, line, length = beam.values()
    found = freebeam("critical", "--column", "pipe", *beam_options(beam), "--set", "M_f=10", "--json").json
    bare = freebeam("critical", "--column", "pipe", "--set", f"b={10 / line}", "--json").json
    assert found["load"] == pytest.approx(bare["load"] * math.sqrt(stiffness / 10) / length, rel=1e-12)
    assert found["parameters"]["b"] == 10 / line
    given = {"m_q": 48.0, "k_q": 1e4, "c_q": 300.0, "a_q": 9.0}
    own = {
        "mu": 48 / (line * length),
        "k": 1e4 * length**3 / stiffness,
        "c": 300 * length / math.sqrt(stiffness * line),
    }
    sets = [word for name, value in given.items() for word in ("--set", f"{name}={value}")]
    found = freebeam("critical", "--column", "absorber", *beam_options(beam), *sets, "--json").json
    assert found["parameters"] == pytest.approx(own | {"a": 0.75}, rel=1e-15)
    for words, says in (
        (["--set", "M_f=10"], "M_f = 10: is what b is in kg/m; give the beam's three quantities"),
        ([*beam_options(beam), "--set", "M_f=10", "--set", "b=0.1"], "and b is set too"),
    ):
        assert says in freebeam("critical", "--column", "pipe", *words).err
    negative = freebeam("critical", "--column", "pipe", *beam_options(beam), "--set", "b=-0.1")
    assert negative.status == 2 and "at {'b': -0.1} must lie" in negative.err
    share = ("map", "--column", "pipe", *beam_options(beam), "--axis", "b", "0.1", "0.5", "3")
    assert "b: is an axis on which the size of the load depends" in freebeam(*share).err
    (tmp_path / "own.py").write_text(
        inspect.getsource(import_module("freebeam_derive.columns.gallery.pflueger"))
        .replace("mu * m * L", "mu * m * L * pi")
        .replace("+ m_tip * ", "+ m_tip / pi * ")
        .replace("import Symbol", "import Symbol, pi")
    )
    found = freebeam(
        "critical", "--column", tmp_path / "own.py", *beam_options(beam), "--set", "m_tip=480", "--json"
    ).json
    assert found["parameters"]["mu"] == pytest.approx(480 / (math.pi * line * length), rel=1e-14)
    run = freebeam("critical", "--column", "absorber", *beam_options(beam), "--set", "c_q=300", "--digits", "9")
    assert run.status == 2 and "c: 300 in SI units is no rational number of it" in run.err


@pytest.mark.parametrize(
    ("column", "words", "power"),
    [
        ("beck", (), 1),
        ("beck", ("--derivative", "2"), -1),
        ("timoshenko", ("--field", "psi"), 0),
        ("absorber", ("--field", "q"), 1),
        ("ziegler", (), 0),
    ],
)
def test_responses_in_si_units(freebeam, column, words, power):
    """A length, its derivatives, an angle and coordinates: L^power over the time of their rates."""
    (load, time), length = scales(BEAM), BEAM["length"]
    asked = ("respond", "--column", column, *words, "--json")
    bare = freebeam(*asked, "--load", "0.5", "--duration", "2", "--step", "0.1").json
    span = ("--load", 0.5 * load, "--duration", 2 * time, "--step", 0.1 * time)
    found = freebeam(*asked, *map(str, span), *beam_options(BEAM)).json
    metre = {1: "m", 0: "rad", -1: "1/m"}[power]
    assert found["unit"] == {
        "t": "s",
        "y": metre,
        "dy": "1/(m s)" if power < 0 else f"{metre}/s",
        "ddy": "1/(m s^2)" if power < 0 else f"{metre}/s^2",
    }
    for rate, name in enumerate(("y", "dy", "ddy")):
        size = length**power / time**rate
        largest = np.abs(bare[name]).max() * size
        assert np.array(found[name]) == pytest.approx(np.array(bare[name]) * size, rel=1e-8, abs=1e-9 * largest)


def test_a_coordinate_without_an_si_unit_is_not_read_in_one(freebeam, tmp_path):
    stated = inspect.getsource(import_module("freebeam_derive.columns.gallery.absorber"))
    (tmp_path / "own.py").write_text(stated.split("    dimensional=")[0] + ")\n")
    asked = (
        "respond",
        "--column",
        tmp_path / "own.py",
        "--field",
        "q",
        "--load",
        "1",
        "--duration",
        "2",
        "--step",
        "1",
    )
    assert freebeam(*asked).status == 0
    assert "no dimensional statement gives this coordinate an SI unit" in freebeam(*asked, *beam_options(BEAM)).err


def test_si_map(freebeam, tmp_path):
    """The nondimensional map times Eq. (5): on standard output, in NetCDF and on the axes of a picture."""
    xarray = pytest.importorskip("xarray")
    load, time = scales(BEAM)
    alpha, beta = np.geomspace(1e-4, 1, 3), np.array([20.0, 2000.0])
    bare = fb.critical_loads(
        fb.column("beck"),
        4,
        alpha[:, None] / time,
        beta * time / BEAM["mass-per-length"],
        load_max=1.5e6 / load,
        eta=0.9,
    )
    assert (bare.kind == "flutter").any() and (bare.kind == "none").any()
    file, axes = tmp_path / "map.nc", ["--alpha", "1e-4", "1", "3", "--beta", "20", "2000", "2"]
    command = ["map", "--column", "beck", "--modes", "4", "--set", "eta=0.9", "--load-max", "1.5e6", *axes]
    found = freebeam(*command, *beam_options(BEAM), "--output", file, "--json").json
    assert (found["units"], found["load_max"]) == ("SI", pytest.approx(1.5e6))
    assert found["kind"] == bare.kind.tolist() and found["alpha"] == pytest.approx(alpha)
    np.testing.assert_allclose(np.array(found["load"], dtype=float), bare.load * load, rtol=1e-9)
    np.testing.assert_allclose(np.array(found["frequency"], dtype=float), bare.frequency / time, rtol=1e-9)
    with xarray.open_dataset(file, engine="h5netcdf") as stored:
        np.testing.assert_array_equal(stored["load"].values, np.array(found["load"], dtype=float))
        assert stored["beta"].values.tolist() == found["beta"] == beta.tolist()
        units = {name: stored[name].attrs["units"] for name in ("alpha", "beta", "load", "frequency")}
        assert units == {"alpha": "s", "beta": "kg/(m s)", "load": "N", "frequency": "rad/s"}
        assert stored.attrs["units"] == "SI" and stored.attrs["length"] == BEAM["length"]
        drawn = fb.figures.stability_map(stored)
        assert drawn.get_xlabel().endswith(", s") and drawn.get_ylabel().endswith(", kg/(m s)")
        assert any(re.search(", [kMG]?N$", ax.get_ylabel()) for ax in drawn.figure.axes)
    assert " N\n" in freebeam(*command, *beam_options(BEAM)).out
    assert "--mass-per-length" in freebeam(*command, "--length", "12", "--bending-stiffness", "1").err


def test_si_response(freebeam):
    """A force at mid-span accelerates it by F / (m L) as a rigid body, and φ² / M₁₁ times that in mode 1."""
    _, time = scales(BEAM)
    middle, force, rate = BEAM["length"] / 2, 5e3, 0.01 / time
    table = freebeam(
        "respond", "--rigid", "--load", 0, "--modes", 1, "--duration", repr(time), "--step", repr(time / 100),
        "--force-amplitude", force, "--force-frequency", repr(rate), "--force-position", middle,
        "--sensor", middle, *beam_options(BEAM),
    ).table  # fmt: skip
    mode_1 = fb.column("free-free").system(modes=1, load=0)
    share = mode_1.shapes(np.array([0.5]))[0, 0] ** 2 / mode_1.M[0, 0]
    assert table["t [s]"][-1] == pytest.approx(time)
    assert set(table) == {"t [s]", "y(6.0) [m]", "dy(6.0) [m/s]", "ddy(6.0) [m/s^2]"}
    # at first, before mode 1 has moved: ddy = F (1 + share) / m L, and ω² of mode 1 takes off a part of its share
    t = table["t [s]"][1]
    rigid = force * math.sin(rate * t) / (BEAM["mass-per-length"] * BEAM["length"])
    omega = mode_1.gamma[0] ** 2 / time
    assert table["ddy(6.0) [m/s^2]"][:2] == pytest.approx([0, rigid * (1 + share * math.sin(omega * t) / (omega * t))])


def test_a_long_response_is_a_summary_and_a_plot(freebeam):
    """Its peak and the time from which on it stays below 2 % are those of the series; a short one is a table."""
    options = ["respond", "--load", "9", "--duration", "40", "--step", "0.01", "--alpha", "1e-3", "--sensor", "0.1"]
    found = freebeam(*options, "--json").json
    run = freebeam(*options, "--quantity", "y")
    t, y = np.array(found["t"]), np.abs(np.array(found["y"])[:, 0])
    assert (run.status, run.err) == (0, "") and len(run.out.splitlines()) < 25
    words = re.search(r"peak (\S+) at t = (\S+); below 2 % of it: from t = (\S+) on", run.out)
    peak, at, settled = map(float, words.groups())
    assert peak == pytest.approx(y.max(), rel=1e-5) and y[t == at] == y.max()
    late = t[y > 0.02 * y.max()].max()
    assert late < settled < late + 40 / 1000 + 0.01
    assert "4001, t = 0 to 40, step 0.01" in run.out
    grid = [line[12:] for line in run.out.splitlines() if re.match(r".{10} \|", line)]
    highest = max(range(len(grid)), key=lambda row: -row if "*" in grid[row] else -99)
    assert highest == 0 and grid[0].index("*") < 5 and not any("*" in line[40:] for line in (grid[0], grid[-1]))
    assert len(freebeam(*options[:4], "1", *options[5:]).table["t"]) == 101


def test_what_was_written_is_told(freebeam, tmp_path):
    file = tmp_path / "r.csv"
    options = ["respond", "--load", "50", "--duration", "20", "--step", "0.01", "--alpha", "1e-3", "--output", file]
    run = freebeam(*options)
    assert run.status == 0 and run.err == "" and str(file) in run.out
    assert "2001, t = 0 to 20" in run.out and "samples a period" in run.out and "peak" in run.out
    found = freebeam(*options, "--force", "--json").json
    table = np.loadtxt(file, delimiter=",", skiprows=2)
    assert found["rows"] == len(table) == 2001
    for told, column in zip(found["peaks"], table.T[1:], strict=True):
        assert told["peak"] == np.abs(column).max() == np.abs(column[table[:, 0] == told["t"]])[0]
    # the float nearest to each multiple of the step, which prints as that
    assert [line.split(",")[0] for line in file.read_text(encoding="utf-8").splitlines()[2:]] == [
        repr(k / 100) for k in range(2001)
    ]


@pytest.mark.parametrize(
    ("options", "says"),
    [
        (["--load", "112", "--duration", "20", "--step", "5"], ["unstable", "flutter", "0.05"]),
        (["--load", "112", "--duration", "20", "--step", "5", "--method", "newmark"], ["unstable", "out of phase"]),
        (["--load", "112", "--duration", "2", "--step", "0.01"], ["unstable"]),
        (["--load", "50", "--alpha", "1e-3", "--duration", "20", "--step", "0.01", "--method", "newmark"], ["phase"]),
        (["--load", "50", "--alpha", "1e-3", "--duration", "20", "--step", "0.01"], []),
        (["--load", "50", "--alpha", "1e-3", "--duration", "2", "--step", "1e-3", "--method", "newmark"], []),
    ],
)
def test_responses_that_mislead_are_warned_of(freebeam, options, says):
    """In the terminal, a line each, and in the JSON."""
    run, found = freebeam("respond", *options), freebeam("respond", *options, "--json").json
    assert run.status == 0
    assert run.err == "".join(f"warning: {warning}\n" for warning in found["warnings"])
    assert all(word in run.err for word in says) and bool(says) == bool(run.err)
    assert len(found["warnings"]) == (2 if "5" in options else len(says[:1]))


@pytest.mark.parametrize(
    ("options", "says"),
    [
        (["--duration", "2", "--step", "5"], "step = 5 s: must not be longer than the duration, 2 s"),
        (["--duration", "2", "--step", "1", "--sensor", "13"], "--sensor 13: must be from 0 to 12 m"),
        (["--duration", "1e18", "--step", "1e17"], " rad/s turns by "),
        (["--duration", "1e9", "--step", "1e8", "--method", "newmark"], " s or fewer modes"),
        (["--duration", "1000", "--step", "0.1", "--load", "6e7"], " 1/s; choose a shorter duration"),
    ],
)
def test_errors_of_a_response_in_si_units_speak_in_them(freebeam, options, says):
    load = [] if "--load" in options else ["--load", "100"]
    run = freebeam("respond", *load, *options, *beam_options(BEAM))
    assert (run.status, run.out) == (2, "") and says in run.err and "nondimensional" not in run.err
    assert run.err.count("\n") == 1


def test_warnings_in_si_units(freebeam):
    """The growth is that of the spectrum, over the unit of time."""
    load, time = scales(BEAM)
    run = freebeam(
        "respond", "--load", repr(112 * load), "--duration", repr(time), "--step", repr(time / 100),
        *beam_options(BEAM),
    )  # fmt: skip
    growth = fb.spectrum(fb.column("free-free").system(8, 112)).growth_rate / time
    assert float(re.search(r"r = (\S+) 1/s", run.err).group(1)) == pytest.approx(growth, rel=1e-5)


# --- a user's own column ------------------------------------------------------------------------------------


def test_own_column_in_every_command(freebeam, clamped, tmp_path):
    found = freebeam("critical", "--column", clamped, "--json").json
    assert (found["column"], found["kind"]) == ("clamped-clamped", "divergence")
    assert found["load"] == pytest.approx(4 * math.pi**2, rel=1e-3)
    assert len(freebeam("spectrum", "--column", clamped, "--load", "1", "--json").json["eigenvalues"]) == 32
    assert len(freebeam(*RESPOND, "--column", clamped).table["t"]) == 101

    kernels = tmp_path / "kernels"
    assert freebeam("generate", clamped, "--output", kernels).status == 0
    assert freebeam("generate", clamped, "--output", kernels, "--check").status == 0
    file, polynomials = sorted(file for file in kernels.glob("*.py") if file.name != "__init__.py")
    assert polynomials.stem == f"{file.stem}_legendre"
    assert freebeam("critical", "--column", polynomials, "--json").json == found
    file.write_text(file.read_text(encoding="utf-8") + "# edited\n", encoding="utf-8")
    run = freebeam("generate", clamped, "--output", kernels, "--check")
    assert run.status == 1 and "# edited" in run.out + run.err


def test_own_column_is_derived_once(clamped, monkeypatch):
    from freebeam_derive import pipeline

    first = own.column(clamped).kernel

    def never(*_: object, **__: object) -> None:
        raise AssertionError("derived again")

    monkeypatch.setattr(pipeline, "generate", never)
    path = list(sys.path)
    assert own.column(clamped).kernel is first
    monkeypatch.delitem(sys.modules, first.__name__)
    assert own.column(clamped).kernel.COLUMN == first.COLUMN
    assert sys.path == path
    clamped.write_text(CLAMPED + "# a change\n", encoding="utf-8")
    with pytest.raises(AssertionError, match="derived again"):
        own.column(clamped)


def test_own_column_without_a_cache(clamped, tmp_path, monkeypatch):
    """Where the cache's folder cannot be made the kernel serves this process."""
    (tmp_path / "file").write_text("in the way", encoding="utf-8")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "file"))
    monkeypatch.setenv("LOCALAPPDATA", str(tmp_path / "file"))
    assert own.column(clamped).kernel.COLUMN["name"] == "clamped-clamped"


# --- bad input ----------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["critical", "--alpha", "nan"], "nan is not finite"),
        (["critical", "--alpha", "inf"], "inf is not finite"),
        (["critical", "--alpha", "1e999999999"], "beyond the range"),
        (["critical", "--alpha", "1e309"], "beyond the range"),
        (["critical", "--alpha", "one"], "'one' is not a number"),
        (["critical", "--alpha", "1/0"], "divides by zero"),
        (["critical", "--alpha", "-1e-3"], "alpha = -1e-3: must be zero or greater"),
        (["critical", "--beta", "-0.1"], "beta = -0.1: must be zero or greater"),
        (["critical", "--modes", "0"], "0"),
        (["critical", "--modes", "1000000000"], "1000000000"),
        (["critical", "--modes", "8.5"], "8.5"),
        (["critical", "--load-max", "0"], "0"),
        (["critical", "--column", "no-such-column"], "no-such-column"),
        (["critical", "--set", "eta=0.7"], "free-free"),
        (["critical", "--column", "beck", "--set", "theta=0.7"], "eta"),
        (["critical", "--column", "beck", "--set", "eta"], "NAME=VALUE"),
        (["critical", "--column", "beck", "--set", "eta=x"], "'x' is not a number"),
        (["critical", "--column", "beck", "--set", "eta=1", "--set", "eta=2"], "twice"),
        (["critical", "--column", "beck", "--exact", "--set", "alpha=0.02..0.03"], "give --alpha 0.02..0.03"),
        (["critical", "--length", "2"], "--bending-stiffness and --mass-per-length"),
        (["critical", *beam_options({**BEAM, "length": -1})], "--length = -1"),
        (["critical", "--no-such-option"], "--no-such-option"),
        (["no-such-command"], "no-such-command"),
        (["spectrum"], "--load"),
        (["spectrum", "--load", "nan"], "nan is not finite"),
        (["respond", "--load", "9", "--duration", "0", "--step", "0.01"], "duration = 0"),
        (["respond", "--load", "9", "--duration", "1", "--step", "0"], "step = 0"),
        (["respond", "--load", "9", "--duration", "1", "--step", "-0.01"], "step = -0.01"),
        (["respond", "--load", "9", "--duration", "1", "--step", "2"], "step"),
        (["respond", "--load", "9", "--duration", "1e15", "--step", "1"], "GiB"),
        ([*RESPOND, "--sensor", "1.2"], "1.2"),
        ([*RESPOND, "--sensor", "-0.1"], "-0.1"),
        ([*RESPOND, "0.3"], "0.3"),
        ([*RESPOND, "--force-amplitude", "1"], "--force-frequency"),
        ([*RESPOND, "--force-position", "1"], "--force-amplitude"),
        ([*RESPOND, "--force-amplitude", "1", "--force-frequency", "3", "--force-position", "2"], "2"),
        ([*RESPOND, "--initial-mode", "9"], "--initial-mode = 9"),
        ([*RESPOND, "--initial-mode", "0"], "--initial-mode = 0"),
        ([*RESPOND, "--output", "response.txt"], ".csv or .npz"),
        ([*RESPOND, "--quantity", "speed"], "--quantity speed: must be one of y, dy, ddy"),
        ([*RESPOND, "--output", "no-such-folder/response.csv"], "no-such-folder"),
        (["respond", "--load", "5000", "--duration", "1000", "--step", "0.01"], "t = "),
        (["generate", "no-such-column"], "no-such-column"),
    ],
    ids=lambda value: " ".join(map(str, value)) if isinstance(value, list) else "",
)  # fmt: skip
def test_bad_input_is_one_line_and_status_2(freebeam, monkeypatch, tmp_path, arguments, says):
    monkeypatch.chdir(tmp_path)
    run = freebeam(*arguments)
    assert (run.status, run.out) == (2, "")
    assert run.err.startswith("freebeam: ") and run.err.endswith("\n") and run.err.count("\n") == 1
    assert says in run.err
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("column = Column(", "line 1"),
        ("nothing = 1", "column"),
        ("1 / 0", "ZeroDivisionError"),
        ("import no_such_module", "no_such_module"),
        (CLAMPED.replace("* delta(y) ", "* delta(y) * delta(y) "), "not linear in the variation"),
        (CLAMPED.replace('("clamped", "clamped")', '("clamped", "welded")'), "welded"),
        ("\0", "parse"),
    ],
)
def test_bad_column_file_is_one_line_and_status_2(freebeam, tmp_path, text, says):
    file = tmp_path / "own.py"
    file.write_text(text, encoding="utf-8")
    for command in (["critical", "--column", file], ["generate", file, "--output", tmp_path / "kernels"]):
        run = freebeam(*command)
        assert (run.status, run.out) == (2, "")
        assert run.err.startswith("freebeam: ") and run.err.count("\n") == 1
        assert says in run.err and "own.py" in run.err
    assert not (tmp_path / "kernels").exists()


def test_interrupt_is_one_line_and_status_130(freebeam, monkeypatch):
    def interrupt(*_: object, **__: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(fb, "column", interrupt)
    run = freebeam("critical")
    assert (run.status, run.out) == (130, "") and run.err.strip() == "freebeam: interrupted"


def test_a_reader_that_stops_early_is_no_error():
    command = [sys.executable, "-m", "freebeam.cli", *RESPOND[:-1], "1e-5"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        assert process.stdout is not None and process.stderr is not None
        process.stdout.readline()
        process.stdout.close()
        assert process.stderr.read() == b""


def test_entry_point_gives_the_exit_status():
    run = subprocess.run(
        [sys.executable, "-m", "freebeam.cli", "critical", "--alpha", "-1"],
        capture_output=True, text=True, env={**os.environ, "PYTHONHASHSEED": "1"},
    )  # fmt: skip
    assert (run.returncode, run.stdout) == (2, "") and "Traceback" not in run.stderr


@pytest.mark.skipif(not Path("/proc/self/task").exists(), reason="threads are counted in Linux's /proc")
@pytest.mark.parametrize("given", [None, "2"])
def test_linear_algebra_runs_on_one_thread_unless_told_otherwise(given):
    """Threads that wait for each other on small matrices cost ten times the processor's time."""
    run = (
        "import os, sys; from freebeam import cli; sys.argv = ['freebeam', '--help']; cli.main(); import numpy;"
        "numpy.linalg.eigvals(numpy.ones((200, 200))); print(len(os.listdir('/proc/self/task')), file=sys.stderr)"
    )
    plain = {name: value for name, value in os.environ.items() if not name.endswith("_NUM_THREADS")}
    told = {"OMP_NUM_THREADS": given} if given else {}
    found = subprocess.run([sys.executable, "-c", run], capture_output=True, text=True, env=plain | told, check=True)
    assert int(found.stderr) == int(given or 1)


# --- the paper's critical loads -----------------------------------------------------------------------------


def test_validate_passes(freebeam):
    """The quick table; the whole ledger is with the tests of the paper."""
    found = freebeam("validate", "--loads", "--json").json
    assert [row["printed"] for row in found["loads"]] == ["109.8", "109.73", "88.2", "90.9"]
    for row in found["loads"]:
        assert row["passed"] and 0 <= float(row["printed"]) - row["load"] < float(row["step"])
    text = freebeam("validate", "--loads")
    assert text.status == 0 and all(row["printed"] in text.out for row in found["loads"])


def test_validate_fails_where_a_load_is_not_explained(freebeam, monkeypatch):
    from freebeam.ledger import scanned

    rows = scanned.validate()
    wrong = [*rows[:-1], dataclasses.replace(rows[-1], passed=False)]
    monkeypatch.setattr(scanned, "validate", lambda _: wrong)
    assert freebeam("validate", "--loads").status == 1
    assert freebeam("validate", "--loads", "--json").status == 1
