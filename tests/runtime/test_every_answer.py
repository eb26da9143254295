"""What any column answers beyond its critical load: responses of all that moves, pulsating loads, limits of damping.

The column is the guide's own example (docs/guides/columns.md): a crack, a point mass, an absorber, a damper.
"""

from __future__ import annotations

import math
import re
from functools import cache
from pathlib import Path

import numpy as np
import pytest

import freebeam as fb
from freebeam import cli
from freebeam_derive.certify.verifier import Refused, verify
from tests.stated import file_of

GUIDE = Path(__file__).parents[2] / "docs" / "guides" / "columns.md"
N = 4


@pytest.fixture(scope="module")
def cracked(tmp_path_factory: pytest.TempPathFactory) -> fb.Column:
    (text,) = (part for part in re.findall(r"```python\n(.*?)```", GUIDE.read_text("utf-8"), re.S) if "cracked" in part)
    file = tmp_path_factory.mktemp("own") / "cracked.py"
    file.write_text(text, "utf-8")
    return fb.column(file)


@cache
def pflueger(folder: Path) -> fb.Column:
    """A column that is not the textbook's, with internal and external damping and no other."""
    changes = {
        "T": "T + mu * at(y.diff(t), 1) ** 2 / 2 + mu * at(y.diff(t), 0.5) ** 2 / 8",
        "dW_nc": "follower + internal + external",
        "parameters": "(own(mu, 1.0),)",
    }
    return fb.column(file_of(folder, "pflueger", changes))


@pytest.fixture(scope="module")
def damped(tmp_path_factory: pytest.TempPathFactory) -> fb.Column:
    return pflueger(tmp_path_factory.mktemp("own"))


def test_sensors_read_every_field_slope_and_coordinate(cracked: fb.Column) -> None:
    """In a mode of motion all that a sensor may read is one function of time, e^(λt), times its own value."""
    system = cracked.system(N, 5.0, beta=0.1)
    n = len(system.M)
    A = np.block([[np.zeros((n, n)), np.eye(n)], [-np.linalg.solve(system.M, part) for part in (system.K, system.C)]])
    values, vectors = np.linalg.eig(A)
    first = int(np.argmin(np.abs(values.imag) + 1e9 * (values.imag <= 0)))
    shape, rate = vectors[:n, first], values[first]
    start = {"initial": shape.real, "initial_velocity": (rate * shape).real}
    places = np.array([0.3, 0.9])
    for field, derivative in (("y", 0), ("y", 1), ("q", 0)):
        read = fb.respond(system, 2.0, 0.05, sensors=places, field=field, derivative=derivative, **start)
        of_places = system.shapes(places, derivative, field).T @ shape
        for order, quantity in enumerate((read.y, read.dy, read.ddy)):
            expected = (rate**order * of_places * np.exp(rate * read.t)[:, None]).real
            assert np.abs(quantity - expected).max() < 1e-7 * np.abs(expected).max()
    q = system.shapes(places, field="q")
    assert np.array_equal(q[:, 0], q[:, 1]) and np.count_nonzero(q[:, 0]) == 1
    with pytest.raises(fb.InputError, match="field = 'psi': must be one of y, q"):
        fb.respond(system, 1.0, 0.1, field="psi")


def test_the_slope_jumps_at_the_crack_and_the_deflection_does_not(cracked: fb.Column) -> None:
    system = cracked.system(N, 5.0)
    sides = [system.shapes(np.array([0.4]), order, side=side) for order in (0, 1) for side in (-1, 1)]
    assert np.abs(sides[0] - sides[1]).max() < 1e-13 and np.abs(sides[2] - sides[3]).max() > 0.1


def test_an_initial_shape_leaves_the_absorber_at_rest(cracked: fb.Column) -> None:
    system = cracked.system(N, 5.0)
    found = fb.respond(system, 0.1, 0.1, initial=lambda x: x**2, sensors=[0.2, 0.7, 1.0])
    assert found.initial_lost < 1e-12
    assert np.abs(found.y[0] - np.array([0.04, 0.49, 1.0])).max() < 1e-12
    absorber = fb.respond(system, 0.1, 0.1, initial=lambda x: x**2, field="q")
    assert np.abs(absorber.y[0]).max() < 1e-14


def test_every_function_has_a_mode(cracked: fb.Column) -> None:
    """Modes of the unloaded column are M-orthonormal, as many as there are functions."""
    system = cracked.system(N, 0.0)
    n = len(system.M)
    modes = np.array([system.mode(k + 1) for k in range(n)])
    assert np.abs(modes @ system.M @ modes.T - np.eye(n)).max() < 1e-10
    with pytest.raises(fb.InputError, match=f"mode = {n + 1}"):
        system.mode(n + 1)


@pytest.mark.parametrize(("frequency", "kind"), [("3", "stable"), ("4", "unstable")])
def test_pulsating_loads_are_proven_as_floats_find_them(damped: fb.Column, frequency: str, kind: str) -> None:
    proven = fb.certified_pulse(damped, 2, 0, "0.1", load=5, frequency=frequency, amplitude="0.8")
    found = fb.pulse(damped, 2, beta=0.1, load=5.0, frequency=[float(frequency)], amplitude=[0.8])
    low, high = proven.growth
    assert low is not None and float(low) - 1e-9 <= found.growth[0, 0] <= float(high) + 1e-9
    assert proven.kind == kind == ("unstable" if found.growth[0, 0] > 0 else "stable")


@pytest.mark.parametrize("kappa", [0, 10, 1000])
def test_the_limit_of_vanishing_damping_is_proven(damped: fb.Column, kappa: int) -> None:
    """It is what ever less damping leads to, as the square of it, and what floats find; its certificate is accepted."""
    limit = fb.certified_load(damped, 4, kappa=kappa, digits=12)
    assert limit.load is not None and all(limit.proof.values())
    low, high = map(float, limit.load)
    assert low <= fb.critical_load(damped, 4, kappa=float(kappa)).load * (1 + 1e-11)
    apart = []
    for alpha in (1e-4, 1e-5):
        near = fb.certified_load(damped, 4, alpha, kappa * alpha, digits=14).load
        assert near is not None
        apart.append(abs(float(near[0]) - high))
    assert apart[1] < apart[0] * 0.02 or apart[0] < 1e-9
    data = dict(limit.unverified or {})
    said = str(verify(data))
    assert "in the limit of vanishing damping" in said and limit.load[0][:8] in said
    for forged in ({"kappa": str(kappa + 5)}, {"kappa": None, "alpha": "1/100"}, {"alpha": "1/100"}, {"kappa": "-1"}):
        with pytest.raises(Refused):
            verify(data | forged)


def test_what_stays_when_damping_vanishes_is_no_limit(cracked: fb.Column) -> None:
    with pytest.raises(fb.InputError, match="a damper of its own, which stays"):
        fb.critical_load(cracked, N, kappa=math.inf)
    with pytest.raises(fb.InputError, match=re.escape("kappa = 0.5: cracked states no damping alpha")):
        fb.critical_load(cracked, N, kappa=0.5, c=0.0)
    assert fb.critical_load(cracked, N, kappa=math.inf, c=0.0).load > 0


def test_the_command_reads_a_coordinate_and_a_slope(cracked: fb.Column, capsys: pytest.CaptureFixture[str]) -> None:
    words = [*"respond --load 5 --beta 0.1 --modes 4 --duration 0.2 --step 0.1 --quantity dy".split(), "--column"]
    found = fb.respond(cracked.system(N, 5.0, beta=0.1), 0.2, 0.1, field="q")
    assert cli.main([*words, str(cracked.path), "--field", "q"]) == 0
    head, *rows = capsys.readouterr().out.split()
    assert head == "t,dq"
    assert [float(row.split(",")[1]) for row in rows] == pytest.approx(found.dy[:, 0].tolist(), rel=1e-12)
    assert cli.main([*words, str(cracked.path), "--derivative", "1"]) == 0
    assert capsys.readouterr().out.startswith("t,dy'(0.1)\n")
    in_si = "beck --derivative 1 --bending-stiffness 1 --mass-per-length 1 --length 1".split()
    assert cli.main([*words, *in_si]) == 0
    assert capsys.readouterr().out.startswith("t [s],dy'(0.1) [rad/s]\n")
