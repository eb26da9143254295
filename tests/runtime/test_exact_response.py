"""The exact method against SciPy's exponential and an integrator of high order, and what steps do to both methods."""

from __future__ import annotations

import math
from decimal import Decimal
from fractions import Fraction
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import expm

import freebeam as fb
from freebeam_sym.checks import InputError
from freebeam_sym.response.inputs import moments

X = np.array([0.1, 0.6])
FREE = fb.column("free-free", "modes")


def generator(system: Any) -> tuple[Any, Any]:
    n = len(system.M)
    G, B = np.zeros((2 * n, 2 * n)), np.zeros(2 * n)
    G[:n, n:] = np.eye(n)
    G[n:] = np.linalg.solve(system.M, -np.hstack([system.K, system.C]))
    B[n:] = np.linalg.solve(system.M, system.Q(1.0)) if system.column.forced else 0
    return G, B


def coalescing(modes: int) -> float:
    return float(fb.critical_load(FREE, modes=modes).load)


SYSTEMS = {
    "undamped": FREE.system(6, 50),
    "damped": FREE.system(6, 50, 1e-3, 0.1),
    "overdamped": FREE.system(4, 50, 0.05, 3),
    "coalescing": FREE.system(4, coalescing(4)),
    "flutter": FREE.system(4, 115),
    "rigid": FREE.system(4, 50, 1e-3, 0, rigid=True),
    "rigid, external damping": FREE.system(4, 50, 1e-3, 0.1, rigid=True),
    "polynomials": fb.column("free-free", "legendre").system(5, 50, 1e-3, 0.1),
}


@pytest.fixture(params=SYSTEMS)
def system(request: pytest.FixtureRequest) -> Any:
    return SYSTEMS[request.param]


def close(actual: Any, expected: Any, tolerance: float) -> None:
    assert np.abs(actual - expected).max() <= tolerance * np.abs(expected).max()


@pytest.mark.parametrize("step", [0.0371, 0.7])
def test_free_motion_is_the_exponential(system: Any, step: float) -> None:
    """At any step, also one of many periods of most modes."""
    n, rng = len(system.M), np.random.default_rng(0)
    x = np.concatenate([0.01 * rng.normal(size=n), rng.normal(size=n)])
    found = fb.respond(system, 10 * step, step, initial=x[:n], initial_velocity=x[n:], sensors=X)
    shapes, G = system.shapes(X), generator(system)[0]
    states = np.array([expm(k * step * G) @ x for k in range(11)])
    close(found.y, states[:, :n] @ shapes, 2e-11)
    close(found.dy, states[:, n:] @ shapes, 2e-11)
    close(found.ddy, (states @ G.T)[:, n:] @ shapes, 2e-11)


@pytest.mark.parametrize("kind", ["constant", "harmonic", "array", "function"])
def test_forced_motion_is_that_of_an_integrator(system: Any, kind: str) -> None:
    """Dormand and Prince's method of order 8, from kink to kink of the force."""
    step, steps, (G, B) = 0.05, 20, generator(system)
    knots = step * np.arange(steps + 1)
    values = np.random.default_rng(1).normal(size=steps + 1)
    force: Any = {
        "constant": 0.7, "harmonic": fb.Harmonic(0.7, 9.0, 0.3), "array": values,
        "function": lambda t: np.interp(t, knots, values),
    }[kind]  # fmt: skip

    def at(t: float) -> float:
        return float(0.7 if kind == "constant" else force(t) if kind == "harmonic" else np.interp(t, knots, values))

    n = len(system.M)
    x, states = np.concatenate([np.full(n, 1e-3), np.zeros(n)]), []
    states.append(x)
    for between in pairwise(knots):
        found = solve_ivp(lambda t, x: G @ x + B * at(t), between, states[-1], "DOP853", rtol=1e-12, atol=1e-16)
        states.append(found.y[:, -1])
    expected, shapes = np.array(states), system.shapes(X)
    got = fb.respond(system, steps * step, step, force=force, force_position=1, initial=x[:n], sensors=X)
    close(got.y, expected[:, :n] @ shapes, 1e-9)
    close(got.dy, expected[:, n:] @ shapes, 1e-9)
    forces = np.array([at(t) for t in knots])
    close(got.ddy, (expected @ G.T + forces[:, None] * B)[:, n:] @ shapes, 1e-9)


@pytest.mark.parametrize("force", [None, 0.3, fb.Harmonic(1.0, 40.0, 1.0)])
def test_the_step_is_sampling_alone(system: Any, force: Any) -> None:
    options: dict[str, Any] = {"sensors": X, "initial": np.full(len(system.M), 1e-3)}
    if force is not None:
        options |= {"force": force, "force_position": 0.8}
    coarse, fine = (fb.respond(system, 6, step, **options) for step in (0.3, 0.01))
    for name in ("y", "dy", "ddy"):
        close(getattr(coarse, name), getattr(fine, name)[::30], 1e-11)


def test_a_piecewise_linear_force_may_be_sampled_anew(system: Any) -> None:
    """Values in the middle of each step add nothing."""
    values = np.random.default_rng(2).normal(size=101)
    halved = np.interp(np.arange(201) / 2, np.arange(101), values)
    one, other = (
        fb.respond(system, 5, 5 / (len(f) - 1), force=f, force_position=1, sensors=X).y for f in (values, halved)
    )
    close(other[::2], one, 1e-11)


@pytest.mark.parametrize("force", [None, 0.3, fb.Harmonic(1.0, 40.0), np.random.default_rng(3).normal(size=301)])
@pytest.mark.parametrize("method", ["exact", "newmark"])
def test_rigid_functions_leave_the_elastic_part_alone(method: str, force: Any) -> None:
    """They make λ = 0 defective, so that no eigenvectors serve: the same elastic part, to rounding, without them."""
    options: dict[str, Any] = {"sensors": X, "force": force, "force_position": 1, "method": method}
    with_rigid, without = (
        fb.respond(system, 30, 0.1, initial=1e-3 * system.mode(1), **options)
        for system in (FREE.system(6, 50, 1e-3, 0.1, rigid=rigid) for rigid in (True, False))
    )
    for name in ("y", "dy", "ddy"):
        close(getattr(with_rigid, f"{name}_elastic"), getattr(without, name), 1e-12)


def test_newmark_s_method_converges_to_it() -> None:
    """With the second power of the step, under each kind of force."""
    system = FREE.system(3, 60, 1e-3, 0.1)
    for force in (None, fb.Harmonic(1.0, 9.0), 0.3):
        options: dict[str, Any] = {"sensors": X, "force": force, "force_position": 1, "initial": [0.01, 0, 0]}
        true = fb.respond(system, 2, 1e-3, **options).y[-1]
        errors = [
            np.abs(fb.respond(system, 2, h, method="newmark", **options).y[-1] - true).max() for h in (1e-3, 5e-4)
        ]
        assert math.log2(errors[0] / errors[1]) == pytest.approx(2, abs=0.1)


# What is told of the step


def local_error(system: Any, duration: float, step: float, **options: Any) -> tuple[float, Any]:
    """Largest difference of Newmark's method in y, relative to the largest y within half a unit of time about."""
    true, found = (fb.respond(system, duration, step, method=m, **options) for m in ("exact", "newmark"))
    apart, size = np.abs(found.y - true.y)[:, 0], np.abs(true.y)[:, 0]
    near = round(0.25 / step)
    envelope = np.array([size[max(0, k - near) : k + near + 1].max() for k in range(size.size)])
    return float((apart / envelope).max()), found


@pytest.mark.parametrize("duration", [2.0, 10.0, 20.0])
def test_the_phase_error_is_estimated(duration: float) -> None:
    """The README's own response of old, and others: 5, 26 and 52 % off at t = 2, 10 and 20."""
    for settings, step in (((50, 1e-3, 0), 0.01), ((50, 1e-3, 0), 0.002), ((109.9, 0, 0), 0.01), ((20, 0, 0), 0.004)):
        error, found = local_error(FREE.system(8, *settings), duration, step)
        assert found.phase_error == pytest.approx(error, rel=0.25)
        assert any("out of phase" in warning for warning in found.warnings) == (found.phase_error > 0.01)
    waves = {"force": fb.Harmonic(1.0, 12.0), "force_position": 1}
    error, found = local_error(FREE.system(8, 50, 1e-3, 0.1), duration, 0.01, **waves)
    assert found.phase_error == pytest.approx(error, rel=0.35)


def test_the_phase_error_of_other_forces_is_not_told_too_small() -> None:
    for rigid in (False, True):
        system = FREE.system(8, 50, 1e-3, 0.1, rigid=rigid)
        noise = np.random.default_rng(4).normal(size=2001)
        found = fb.respond(system, 20, 0.01, force=noise, force_position=1, method="newmark", outputs=("y",))
        true = fb.respond(system, 20, 0.01, force=noise, force_position=1, outputs=("y",))
        error = np.abs(found.y_elastic - true.y_elastic).max() / np.abs(true.y_elastic).max()
        assert 0.5 * error < found.phase_error <= 2


def test_the_modes_that_carry_the_motion_decide() -> None:
    """The same step is fine for mode 1 and wrong for mode 5, unloaded; the sensor at a node does not see a mode."""
    system = FREE.system(5, 0)
    first, fifth = (fb.respond(system, 1, 0.001, initial=0.01 * np.eye(5)[k], method="newmark") for k in (0, 4))
    omega = system.gamma**2
    for found, w in ((first, omega[0]), (fifth, omega[4])):
        turned = w - 2 / 0.001 * math.atan(0.001 * w / 2)
        assert found.phase_error == pytest.approx(abs(1 - np.exp(1j * turned)), rel=0.05)
    assert not first.warnings and fifth.warnings
    exact = fb.respond(system, 10, 0.02, initial=0.01 * np.eye(5)[0])
    assert exact.samples_per_period == pytest.approx(2 * np.pi / (0.02 * omega[0])) and not exact.warnings
    (warning,) = fb.respond(system, 10, 0.02, initial=0.01 * np.eye(5)[4]).warnings
    assert "each value is right" in warning
    (warning,) = fb.respond(
        system, 10, 0.5, force=fb.Harmonic(1e-9, 70.0), force_position=1, initial=np.ones(5)
    ).warnings
    assert f"{2 * np.pi / 0.5 / omega[4]:.2g} times" in warning


@pytest.mark.parametrize("factor", [1 - 1e-4, 1 + 1e-4, 1.05])
@pytest.mark.parametrize("column", ["free-free", "beck", "euler-pinned"])
@pytest.mark.parametrize("damping", [(0, 0), (1e-3, 0.1)])
def test_instability_is_warned_of_from_the_critical_load_on(column: str, damping: Any, factor: float) -> None:
    """Whatever the method, and by the growth of the spectrum."""
    beam = fb.column(column)
    load = fb.critical_load(beam, modes=4, alpha=damping[0], beta=damping[1]).load
    system = beam.system(4, factor * load, *damping)
    for method in ("exact", "newmark"):
        found = fb.respond(system, 0.5, 0.001, method=method)
        assert any("unstable" in warning for warning in found.warnings) == (factor > 1)


def test_rounding_is_no_growth() -> None:
    """Undamped, below the first loss, with and without rigid functions, and at a sharp coalescence."""
    for modes, load, rigid in ((8, 0, False), (8, 109, True), (20, 60, False), (4, coalescing(4) * (1 - 1e-12), False)):
        assert not fb.respond(FREE.system(modes, load, rigid=rigid), 0.2, 0.01).warnings


# Times


@pytest.mark.parametrize("step", ["0.01", "0.1", "0.003", "1e-7", "0.7", "123.456", "0.001953125"])
def test_times_print_as_multiples_of_the_step(step: str) -> None:
    times = moments(Fraction(step), 0, 2000)
    assert [float(Decimal(step) * k) for k in range(2000)] == times.tolist()
    found = fb.respond(FREE.system(1), 200 * float(step), float(step), outputs=("y",))
    assert found.t.tolist() == times[:201].tolist()
    seen: list[Any] = []
    fb.respond(
        FREE.system(1), 200 * float(step), float(step), force=lambda t: seen.append(t) or 0.0 * t, force_position=1
    )
    assert set(np.concatenate([np.atleast_1d(t) for t in seen])) <= set(times.tolist())


def test_a_phase_that_no_digits_hold_is_refused() -> None:
    """The phase ω t of a matrix of 16 digits; one that dies away before is none."""
    with pytest.raises(InputError, match="radians"):
        fb.respond(FREE.system(2), 1e10, 1e9)
    with pytest.raises(InputError, match=r"force\.frequency"):
        fb.respond(FREE.system(2), 1e3, 0.1, force=fb.Harmonic(1.0, 1e12), force_position=1)
    settled = fb.respond(FREE.system(2, 0, 1e-3, 0.1), 1e10, 1e9)
    assert not settled.y[1:].any() and settled.y[0].any()


def test_a_growth_beyond_floats_is_refused_at_once() -> None:
    """Powers of a root that no float holds are not made: e^(500 · 2²⁰) would take the machine's memory."""
    system = FREE.system(2, 5000)
    with pytest.raises(InputError, match=r"at t = 10: (flutter|divergence) grows"):
        fb.respond(system, 1e7, 10)
