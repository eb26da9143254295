"""Laws of the response in time, on a free-free beam assembled here by quadrature.

The modes are Eq. (22) in decaying exponentials, the step is the textbook's, written down on its own.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from dataclasses import dataclass, replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from scipy.linalg import eigvals, expm
from scipy.optimize import brentq

import freebeam as fb
from freebeam.control import state_space
from freebeam_sym.checks import InputError
from freebeam_sym.response import Response, respond

X = np.array([0.1, 0.6])


def textbook_step(
    M: Any, C: Any, K: Any, q: Any, dq: Any, ddq: Any, F: Any, h: float, newmark: tuple[float, float]
) -> tuple[Any, Any, Any]:
    b, g = newmark
    q_star = q + h * dq + h * h * (0.5 - b) * ddq
    dq_star = dq + h * (1 - g) * ddq
    a = np.linalg.solve(M + g * h * C + b * h * h * K, F - C @ dq_star - K @ q_star)
    return q_star + b * h * h * a, dq_star + g * h * a, a


def elastic(gamma: Any, x: Any, derivative: int) -> Any:
    g = gamma[:, None]
    s, c, e = np.sin(g), np.cos(g), np.exp(-g)
    low = 2 * e * s + 1 - e**2
    ratio = (2 * e * c - 1 - e**2) / low
    waves = (np.sin(g * x) + ratio * np.cos(g * x), np.cos(g * x) - ratio * np.sin(g * x))
    wave = waves[derivative % 2] * (-1) ** (derivative // 2)
    ends = (s + c - e) / low * np.exp(-g * (1 - x)) - (-1) ** derivative * (1 - ratio) / 2 * np.exp(-g * x)
    return g**derivative * (wave + ends)


@dataclass(frozen=True)
class Beam:
    M: Any
    C: Any
    K: Any
    gamma: Any
    rigid_count: int

    column = SimpleNamespace(kernel=fb.column("free-free").kernel, unknowns=("y",))

    @property
    def modes(self) -> int:
        return len(self.gamma)

    def mode(self, number: int = 1) -> Any:
        return np.eye(len(self.M))[self.rigid_count + number - 1]

    def shapes(self, x: Any, derivative: int = 0) -> Any:
        x = np.asarray(x, dtype=float)
        functions = elastic(self.gamma, x, derivative)
        if not self.rigid_count:
            return functions
        rigid = [[np.ones_like(x), x - 0.5], [0 * x, np.ones_like(x)], [0 * x, 0 * x]][derivative]
        return np.concatenate([rigid, functions])

    def Q(self, x: float) -> Any:
        return self.shapes([x])[:, 0]


def beam(modes: int = 4, load: float = 0, alpha: float = 0, beta: float = 0, rigid: bool = False) -> Any:
    centres = (np.arange(modes) + 1.5) * np.pi
    gamma = [brentq(lambda g: np.cos(g) - 1 / np.cosh(g), c - 0.3, c + 0.3, xtol=1e-14) for c in centres]
    bare = Beam(None, None, None, np.array(gamma), 2 if rigid else 0)
    nodes, weights = np.polynomial.legendre.leggauss(8 * modes + 40)
    x, w = (nodes + 1) / 2, weights / 2
    phi, slope, curvature = (bare.shapes(x, derivative) for derivative in range(3))
    M, E = (phi * w) @ phi.T, (curvature * w) @ curvature.T
    H = np.outer(bare.shapes([1.0])[:, 0], bare.shapes([1.0], 1)[:, 0]) - (slope * w * x) @ slope.T
    if rigid:  # exact zeros, as closed forms give them
        E[:2] = E[:, :2] = M[:2, 2:] = M[2:, :2] = H[2:, :2] = 0
        M[0, 1] = M[1, 0] = H[1, 1] = H[1, 0] = H[0, 0] = 0
    return replace(bare, M=M, C=beta * M + alpha * E, K=E + load * H)


def generator(system: Any) -> Any:
    n = len(system.M)
    lower = [np.linalg.solve(system.M, -system.K), np.linalg.solve(system.M, -system.C)]
    return np.block([[np.zeros((n, n)), np.eye(n)], lower])


def plain_loop(system: Any, f: Any, x_F: float, q: Any, dq: Any, h: float, newmark: Any) -> tuple[Any, ...]:
    Q = system.Q(x_F)
    ddq = np.linalg.solve(system.M, Q * f[0] - system.C @ dq - system.K @ q)
    states = [(q, dq, ddq)]
    for value in f[1:]:
        states.append(textbook_step(system.M, system.C, system.K, *states[-1], Q * value, h, newmark))
    return tuple(np.array(part) for part in zip(*states, strict=True))


def close(actual: Any, expected: Any, tolerance: float) -> None:
    assert np.abs(actual - expected).max() <= tolerance * np.abs(expected).max()


# The blocks are the textbook's loop


@pytest.mark.parametrize("steps", [1, 2, 31, 32, 33, 64, 1000, 3001])
@pytest.mark.parametrize("rigid", [False, True])
def test_blocks_are_the_plain_loop(steps: int, rigid: bool) -> None:
    system = beam(3, load=50, alpha=1e-4, beta=0.01, rigid=rigid)
    rng = np.random.default_rng(steps)
    f, (q, dq) = rng.normal(size=steps + 1), rng.normal(size=(2, len(system.M)))
    expected = plain_loop(system, f, 0.8, q, dq, 0.013, (0.3, 0.55))
    few = {"sensors": X}
    many = {"sensors": np.linspace(0, 1, 40)}  # by way of the states
    for options in (few, many, few | {"states": True}):
        found = respond(
            system, 0.013 * steps, 0.013, force=f, force_position=0.8, initial=q, initial_velocity=dq,
            newmark=(0.3, 0.55), **options,
        )  # fmt: skip
        shapes = system.shapes(options["sensors"])
        for output, state in zip((found.y, found.dy, found.ddy), expected, strict=True):
            close(output, state @ shapes, 1e-11)
        part = slice(system.rigid_count, None)
        close(found.dy_elastic, expected[1][:, part] @ shapes[part], 1e-11)
        np.testing.assert_allclose(found.y, found.y_elastic + found.y_rigid, atol=1e-13 * np.abs(found.y).max())
        if options.get("states"):
            close(found.q, expected[0], 1e-11)
            close(found.dq, expected[1], 1e-11)


def test_blocks_are_the_plain_loop_in_flutter_and_over_chunks() -> None:
    system = beam(3, load=150, alpha=1e-3)
    steps = 3000
    f = np.random.default_rng(0).normal(size=steps + 1)
    found = respond(system, steps * 0.01, 0.01, force=f, force_position=1, sensors=X, method="newmark")
    q, _, _ = plain_loop(system, f, 1, np.zeros(3), np.zeros(3), 0.01, (0.25, 0.5))
    scale = np.abs(q @ system.shapes(X))
    assert found.growth > 1
    np.testing.assert_allclose(found.y, q @ system.shapes(X), rtol=1e-9, atol=1e-11 * scale[:50].max())
    light = beam(2, beta=0.5)
    steps = 150_000
    f = np.random.default_rng(1).normal(size=steps + 1)
    found = respond(light, steps * 0.01, 0.01, force=f, force_position=1, sensors=X, states=True)
    assert found.q is not None and found.dq is not None
    half = respond(
        light, steps * 0.005, 0.01, force=f[steps // 2 :], force_position=1, initial=found.q[steps // 2],
        initial_velocity=found.dq[steps // 2], sensors=X,
    )  # fmt: skip
    close(half.y, found.y[steps // 2 :], 1e-11)


# Accuracy


@pytest.mark.parametrize(("newmark", "order"), [((0.25, 0.5), 2), ((0.0, 0.5), 2), ((0.3025, 0.6), 1)])
@pytest.mark.parametrize("load", [0, 80, 140])
def test_order(newmark: tuple[float, float], order: int, load: float) -> None:
    """Halving the step divides the error against the exact propagator by 2^order; flutter included."""
    system = beam(2, load=load, alpha=1e-3, beta=0.1)
    q = np.array([0.01, -0.003])
    exact = (expm(generator(system)) @ np.concatenate([q, 0 * q]))[:2] @ system.shapes(X)
    errors = [
        np.abs(respond(system, 1, 1 / m, initial=q, newmark=newmark, sensors=X).y[-1] - exact).max()
        for m in (4000, 8000)
    ]
    assert math.log2(errors[0] / errors[1]) == pytest.approx(order, abs=0.1)


def test_modal_solution() -> None:
    """Eq. (23) at P = 0, one damped mode alone."""
    alpha, beta = 2e-3, 0.3
    system = beam(3, alpha=alpha, beta=beta)
    k = 1
    gamma = system.gamma[k]
    damping = beta + alpha * gamma**4
    lam = (-damping + np.sqrt(complex(damping**2 - 4 * gamma**4))) / 2
    found = respond(system, 0.5, 2e-5, initial=np.eye(3)[k], sensors=X)
    history = (np.exp(lam * found.t) * (1 + 1j * lam.real / lam.imag)).real
    close(found.y, history[:, None] * system.shapes(X)[k], 1e-5)


def test_energy_is_kept() -> None:
    system = beam(4)
    rng = np.random.default_rng(2)
    q, dq = rng.normal(size=4), 100 * rng.normal(size=4)
    found = respond(system, 20, 0.01, initial=q, initial_velocity=dq, states=True, method="newmark")
    energy = np.einsum("ti,ij,tj->t", found.dq, system.M, found.dq)
    energy += np.einsum("ti,ij,tj->t", found.q, system.K, found.q)
    np.testing.assert_allclose(energy, energy[0], rtol=1e-10)
    damped = respond(system, 20, 0.01, initial=q, initial_velocity=dq, newmark=(0.3025, 0.6), states=True)
    assert damped.q is not None
    assert np.abs(damped.q[-1]).max() < 0.1 * np.abs(q).max()  # g > 1/2 damps, so the law above can fail


def test_steady_state_is_the_frequency_response() -> None:
    """Average acceleration answers sin(ω t) as the exact system answers (2/h) tan(ω h / 2), to rounding."""
    system = beam(4, load=50, alpha=0.02, beta=4)
    omega, h, steps = 3.0, 0.02, 2000
    force = {"force": lambda t: np.sin(omega * t), "force_position": 1}
    found = respond(system, steps * h, h, sensors=X, method="newmark", **force)
    model = state_space(system, 1, X, outputs=("y", "dy", "ddy"))
    warped = 2 / h * math.tan(omega * h / 2)
    inside = np.linalg.solve(1j * warped * np.eye(8) - model.A, model.B)
    responses = (model.C @ inside + model.D)[:, 0]
    late = found.t > 0.8 * found.t[-1]
    for k, output in enumerate((found.y, found.dy, found.ddy)):
        for s in range(len(X)):
            wave = (responses[k * len(X) + s] * np.exp(1j * omega * found.t[late])).imag
            close(output[late, s], wave, 1e-9)


@pytest.mark.parametrize("method", ["exact", "newmark"])
def test_superposition(method: str) -> None:
    system = beam(3, load=90, alpha=1e-3)
    rng = np.random.default_rng(3)
    f = rng.normal(size=(2, 501))
    q = rng.normal(size=3)

    def run(force: Any, initial: Any) -> Response:
        return respond(system, 5, 0.01, force=force, force_position=0.3, initial=initial, sensors=X, method=method)

    whole = run(2 * f[0] - 3 * f[1], 5 * q)
    parts = 2 * run(f[0], 0 * q).ddy - 3 * run(f[1], 0 * q).ddy + 5 * run(0 * f[0], q).ddy
    close(whole.ddy, parts, 1e-11)


def test_reciprocity() -> None:
    """x_s and x_F change places where K is symmetric; under the follower force K turns to its transpose."""
    h, f = 0.01, np.random.default_rng(4).normal(size=401)
    for load in (0, 60):
        system = beam(4, load=load, alpha=1e-3, beta=0.1)
        turned = replace(system, K=system.K.T)
        there = respond(system, 4, h, force=f, force_position=1, sensors=[0.1]).y
        back = respond(turned, 4, h, force=f, force_position=0.1, sensors=[1]).y
        close(back, there, 1e-12)
        same = respond(system, 4, h, force=f, force_position=0.1, sensors=[1]).y
        assert np.allclose(same, there, rtol=0, atol=1e-10 * np.abs(there).max()) == (load == 0)


# Rigid functions


@pytest.mark.parametrize("method", ["exact", "newmark"])
def test_constant_force_drives_the_rigid_beam_as_newton_says(method: str) -> None:
    """Unit mass, moment of inertia 1/12 about the centre: y = F t²/2 (1 + 12 (x_F − 1/2)(x_s − 1/2))."""
    system = beam(3, rigid=True)
    found = respond(system, 10, 0.01, force=0.2, force_position=1, sensors=X, method=method)
    close(found.y_rigid, 0.1 * found.t[:, None] ** 2 * (1 + 6 * (X - 0.5)), 1e-12)


def test_free_drift() -> None:
    """Linear at P = 0; under the load a turning beam is accelerated by −P ω t: cubic; with β > 0 it stops."""
    turning = {"initial_velocity": lambda x: 0.3 + 0.2 * (x - 0.5), "sensors": X}
    free = respond(beam(3, rigid=True), 10, 0.01, **turning)
    close(free.y, free.t[:, None] * (0.3 + 0.2 * (X - 0.5)), 1e-10)
    assert free.velocity_lost < 1e-13
    loaded = respond(beam(3, load=40, rigid=True), 2, 0.01, **turning)
    np.testing.assert_allclose(np.diff(loaded.y_rigid, 3, axis=0), -40 * 0.2 * 0.01**3, rtol=1e-5)
    np.testing.assert_allclose(loaded.y_elastic, 0, atol=1e-11)
    stopped = respond(beam(3, beta=2, rigid=True), 20, 0.01, **turning)
    close(stopped.y_rigid[-1], (0.3 + 0.2 * (X - 0.5)) / 2, 1e-4)
    assert np.abs(stopped.dy_rigid[-1]).max() < 1e-12


@pytest.mark.parametrize("method", ["exact", "newmark"])
def test_rigid_functions_leave_the_elastic_part_alone(method: str) -> None:
    """The theorem of block triangularity, in time: the same elastic part with and without them."""
    options = {"force": np.cos, "force_position": 1, "sensors": X, "method": method}
    with_rigid = respond(beam(4, 70, 1e-3, 0.1, rigid=True), 5, 0.01, **options)
    without = respond(beam(4, 70, 1e-3, 0.1), 5, 0.01, **options)
    close(with_rigid.ddy_elastic, without.ddy, 1e-11)
    assert not without.y_rigid.any() and with_rigid.y_rigid.any()
    assert with_rigid.growth == pytest.approx(without.growth, rel=1e-8)


# Steps, stable and not


def textbook_limit(xi: float, b: float, g: float) -> float:
    e, p = g / 2 - b, xi * (g - 0.5)
    return (p + math.sqrt(e + p * p)) / e


@pytest.mark.parametrize(("b", "g"), [(0, 0.5), (1 / 6, 0.5), (0.1, 0.6)])
@pytest.mark.parametrize("alpha", [0, 1e-4])
@pytest.mark.parametrize("rigid", [False, True])
def test_stability_limit(b: float, g: float, alpha: float, rigid: bool) -> None:
    """Accepted below Ω_crit / ω of the highest mode and refused above; the message's own step is accepted."""
    system = beam(3, alpha=alpha, rigid=rigid)
    omegas = system.gamma**2
    limit = min(textbook_limit(alpha * omega / 2, b, g) / omega for omega in omegas)
    below = respond(system, 2000 * limit, limit * (1 - 1e-6), newmark=(b, g), initial=lambda x: x**4)
    assert np.abs(below.y).max() < 10
    with pytest.raises(InputError, match="largest stable step") as caught:
        respond(system, 1, limit * (1 + 1e-4), newmark=(b, g))
    named = float(re.search(r"largest stable step is ([\d.e-]+)", str(caught.value)).group(1))  # type: ignore[union-attr]
    assert named == pytest.approx(limit, rel=1e-5)
    respond(system, 1, named, newmark=(b, g))


def test_average_acceleration_takes_any_step_and_lets_flutter_grow() -> None:
    """Steps of up to thousands of periods of the highest mode, near coalescence and far above it."""
    for modes, load in ((1, 0), (8, 109), (20, 60)):
        system = beam(modes, load=load, beta=0.1, alpha=1e-4 if load == 60 else 0)
        for step in (1e-6, 1e-2, 1.0, 20.0):
            found = respond(system, 300 * step, step, sensors=[0.0], method="newmark")
            assert np.abs(found.y).max() < 0.1
    system = beam(4, load=150)
    found = respond(system, 20, 0.001, method="newmark")
    rate = np.log(np.abs(found.y[-2000:]).max() / np.abs(found.y[-12000:-10000]).max()) / 10
    exact = eigvals(generator(system)).real.max()
    assert found.growth == pytest.approx(exact)
    assert rate == pytest.approx(exact, rel=0.02)


def test_negative_numerical_damping_is_refused() -> None:
    with pytest.raises(InputError, match="no step is stable"):
        respond(beam(3, load=50), 1, 1e-6, newmark=(0.25, 0.49))
    damped = beam(3, alpha=1e-3)  # its limit is 4 ξ / (1 − 2 g) of the lowest mode
    limit = 2 * 1e-3 / (1 - 2 * 0.45)
    respond(damped, 1, limit * 0.999, newmark=(0.25, 0.45))
    with pytest.raises(InputError, match="largest stable step"):
        respond(damped, 1, limit * 1.01, newmark=(0.25, 0.45))


def test_a_growth_too_fast_for_the_step_is_refused() -> None:
    """Divergence: at h λ = 2 average acceleration divides by zero, beyond it the sign alternates."""
    system = replace(beam(2), K=np.diag([-100.0, 500.0]), M=np.eye(2))
    respond(system, 2, 0.02, method="newmark")
    for step in (0.2, 0.19):
        with pytest.raises(InputError, match="largest stable step"):
            respond(system, 2, step, method="newmark")


def test_period_error() -> None:
    """Undamped: Ω / (2 arctan(Ω/2)) − 1, and the zeros of the response come later by that."""
    system = beam(3)
    h = 0.02
    found = respond(system, 40, h, sensors=[0.0], method="newmark")
    Omega = system.gamma**2 * h
    np.testing.assert_allclose(found.frequencies, system.gamma**2, rtol=1e-9)
    np.testing.assert_allclose(found.period_errors, Omega / (2 * np.arctan(Omega / 2)) - 1, rtol=1e-8)
    assert found.period_error == found.period_errors[0]
    y = found.y[:, 0]
    k = np.flatnonzero(y[1:] * y[:-1] < 0)
    zeros = found.t[k] + h * y[k] / (y[k] - y[k + 1])
    period = 2 * (zeros[-1] - zeros[0]) / (len(zeros) - 1)
    assert period * system.gamma[0] ** 2 / (2 * np.pi) - 1 == pytest.approx(found.period_error, rel=0.02)
    assert math.isnan(respond(beam(1, beta=100), 1, 0.1).period_error)


# Input


def test_forces_in_every_form_agree() -> None:
    system = beam(3, 50, 1e-3)

    def run(force: Any) -> Any:
        return respond(system, 3, 0.01, force=force, force_position=1, sensors=X).y

    def in_place(t: Any) -> Any:
        t *= 3
        return np.sin(t)

    def only_arrays(t: Any) -> Any:
        return np.sin(3 * t[:])

    reference = run(np.sin(3 * 0.01 * np.arange(301)))
    forms: list[Callable[[Any], Any]] = [
        lambda t: np.sin(3 * t), lambda t: math.sin(3 * t), in_place, only_arrays,
    ]  # fmt: skip
    for force in forms:
        close(run(force), reference, 1e-13)
    pulse = np.where(np.arange(301) <= 100, 1.0, 0.0)
    close(run(lambda t: 1 if t < 1.005 else 0), run(pulse), 1e-13)
    close(run(lambda t: 2), run(np.full(301, 2)), 1e-13)
    close(run(2.0), run(np.full(301, 2)), 1e-13)


def test_default_start() -> None:
    """Mode 1 with q₁ = 0.01; rest where a force or any initial state is given."""
    for rigid in (False, True):
        system = beam(3, rigid=rigid)
        phi = system.shapes(X)[system.rigid_count]
        close(respond(system, 1, 0.1, sensors=X).y[0], 0.01 * phi, 1e-13)
        assert not respond(system, 1, 0.1, sensors=X, force=np.sin, force_position=1).y[0].any()
        moving = respond(system, 1, 0.1, sensors=X, initial_velocity=np.ones(len(system.M)))
        assert not moving.y[0].any() and moving.dy[0].any()


def test_initial_shape_is_projected_and_the_loss_is_told() -> None:
    system = beam(5)
    q = np.array([1, -2, 0.5, 0, 3])
    found = respond(system, 1, 0.1, initial=lambda x: q @ system.shapes(np.atleast_1d(x)), states=True)
    assert found.q is not None
    close(found.q[0], q, 1e-12)
    assert found.initial_lost < 1e-12
    scalar = respond(system, 1, 0.1, initial=lambda x: math.cos(9 * x), initial_velocity=lambda x: 1 + x**3)
    vector = respond(system, 1, 0.1, initial=lambda x: np.cos(9 * x), initial_velocity=lambda x: 1 + x**3)
    close(scalar.y, vector.y, 1e-13)
    assert 0.01 < vector.initial_lost < 1
    # 1 is orthogonal to all elastic modes: of a + φ₁ it alone is lost
    mass = system.M[0, 0]
    mixed = respond(system, 1, 0.1, initial=lambda x: 0.7 + system.shapes(np.atleast_1d(x))[0])
    assert mixed.initial_lost == pytest.approx(0.7 / math.sqrt(0.49 + mass), rel=1e-9)
    with pytest.raises(InputError, match="rigid=True"):
        respond(system, 1, 0.1, initial=lambda x: 1 - 2 * x)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"duration": 0}, "duration = 0"),
        ({"step": -0.1}, "step = -0.1"),
        ({"step": math.nan}, "step = nan"),
        ({"duration": math.inf}, "duration = inf"),
        ({"step": 2}, "must not be longer"),
        ({"sensors": [0.1, 1.1]}, r"sensors\[1\] = 1.1"),
        ({"sensors": [[0.1]]}, "sensors has shape"),
        ({"sensors": []}, "sensors"),
        ({"force": np.zeros(10), "force_position": 1}, r"shape \(10,\).*\(11,\)"),
        ({"force": np.sin}, "force_position is missing"),
        ({"force": np.sin, "force_position": 1.5}, "force_position = 1.5"),
        ({"force": np.sin, "force_position": [1, 0]}, "force_position"),
        ({"force": np.full(11, np.nan), "force_position": 1}, "force = nan at 0"),
        (
            {"force": lambda t: 1 / (0.5 - t) if t < 0.5 else math.inf, "force_position": 1},
            "force = inf at 0.5",
        ),
        ({"force": lambda t: 1j * t, "force_position": 1}, "one real number"),
        ({"force": lambda t: "a", "force_position": 1}, "one real number"),
        ({"initial": [1, 2]}, r"initial has shape \(2,\)"),
        ({"initial": [1, 2, math.inf]}, "initial\\[2\\] = inf"),
        ({"initial_velocity": np.zeros((3, 1))}, "initial_velocity has shape"),
        ({"newmark": 0.25}, "newmark = 0.25"),
        ({"newmark": (-0.1, 0.5)}, r"newmark\[0\] = -0.1"),
        ({"duration": 1e12, "step": 1e-12}, "GiB"),
        ({"duration": 1e300, "step": 1e-300}, "GiB"),
        ({"duration": 1e300, "step": 1e300}, "lose its digits"),
        ({"duration": 1e300, "step": 1e300, "method": "newmark"}, "lose its digits"),
        ({"method": "euler"}, "method = 'euler'"),
        ({"method": "exact", "newmark": (0.25, 0.5)}, "newmark = "),
    ],
)
def test_bad_input(options: dict[str, Any], message: str) -> None:
    arguments = {"duration": 1, "step": 0.1} | options
    with pytest.raises(InputError, match=message) as caught:
        respond(beam(3), **arguments)
    assert "\n" not in str(caught.value)


def test_overflow_says_when() -> None:
    """Past float range about where growth takes the start to 1.8e308; just before, all is finite."""
    system = beam(2, load=200)
    growth = eigvals(generator(system)).real.max()
    with pytest.raises(InputError, match="flutter grows as") as caught:
        respond(system, 2000, 0.01)
    when = float(re.search(r"at t = ([\d.]+)", str(caught.value)).group(1))  # type: ignore[union-attr]
    assert when == pytest.approx((math.log(np.finfo(float).max) - math.log(0.01)) / growth, rel=0.05)
    before = respond(system, when - 0.015, 0.01)
    assert np.isfinite(before.ddy).all() and np.abs(before.ddy).max() > 1e300
    with pytest.raises(InputError, match="too large"):
        respond(beam(2), 1, 0.01, initial=[1e308, 1e308])
    # a beam at rest stays at rest, however long it would have taken to overflow
    late = np.zeros(200_001)
    late[-100:] = 1
    resting = respond(system, 2000, 0.01, force=late, force_position=1, sensors=X)
    assert not resting.y[:-101].any() and resting.y[-1].all()


def test_progress_and_interruption() -> None:
    told: list[float] = []
    respond(beam(2), 2000, 0.01, progress=told.append)
    assert len(told) > 1 and told == sorted(told) and told[-1] == 1

    def stop(_: float) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        respond(beam(2), 2000, 0.01, progress=stop)


def test_times_end_at_the_duration_or_before() -> None:
    assert respond(beam(1), 20, 0.01).t.size == 2001
    assert respond(beam(1), 1, 0.3).t[-1] == pytest.approx(0.9)
    assert respond(beam(1), 0.3, 0.1).t.size == 4


def test_state_space_is_the_same_system() -> None:
    system = beam(3, 80, 1e-3, 0.1, rigid=True)
    model = state_space(system, 0.4, X, outputs=("ddy", "y"))
    np.testing.assert_allclose(model.A, generator(system), rtol=1e-12, atol=1e-9)
    s = 2.0 + 3.0j
    q = np.linalg.solve(s**2 * system.M + s * system.C + system.K, system.Q(0.4))
    transfer = (model.C @ np.linalg.solve(s * np.eye(10) - model.A, model.B) + model.D)[:, 0]
    expected = np.concatenate([s**2 * (q @ system.shapes(X)), q @ system.shapes(X)])
    np.testing.assert_allclose(transfer, expected, rtol=1e-9)
    for outputs in ("y", ["speed"], []):
        with pytest.raises(InputError, match="outputs"):
            state_space(system, 0.4, X, outputs=outputs)


def test_a_force_of_values_that_are_no_load_cases_is_refused() -> None:
    system = fb.column("free-free").system()
    with pytest.raises(fb.InputError, match="force gives values of shape"):
        fb.respond(system, duration=1.0, step=0.1, force=lambda t: [1.0, 2.0], force_position=1)
