"""Newmark's method as derived, against matrices of random numbers, exponentials and eigenvalues."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest
import sympy as sp
from hypothesis import example, given, settings
from hypothesis import strategies as st
from scipy.linalg import expm

from freebeam_derive.newmark import Newmark, derive_newmark
from freebeam_derive.record import Step

PARAMETERS = [(0.25, 0.5), (1 / 6, 0.5), (0.0, 0.5), (0.3025, 0.6), (0.1, 0.7), (0.2, 0.4)]


@cache
def derived() -> Newmark:
    return derive_newmark()


@cache
def function(name: str) -> Any:
    method = derived()
    return sp.lambdify(
        (method.Omega, method.xi, method.b, method.g), getattr(method, name), modules=["numpy", {"Max": max}]
    )


def step(
    M: Any, C: Any, K: Any, state: tuple[Any, Any, Any], F: Any, h: float, newmark: tuple[float, float]
) -> dict[str, Any]:
    """The derived formulas, evaluated in their order."""
    method = derived()
    values = dict(zip((m.name for m in (*method.matrices, *method.state)), (M, C, K, *state), strict=True))
    values |= {"F": F, "h": h, "b": newmark[0], "g": newmark[1]}
    for name, expression in method.formulas:
        symbols = sorted(expression.free_symbols, key=str)
        names = [s.name for s in symbols if s.name in values]
        keep = [s for s in symbols if s.name in values]
        values[name] = sp.lambdify(keep, expression, modules="numpy")(*(values[n] for n in names))
    return values


def random_system(n: int, seed: int) -> tuple[Any, ...]:
    rng = np.random.default_rng(seed)
    root = rng.normal(size=(n, n))
    return root @ root.T + np.eye(n), rng.normal(size=(n, n)), rng.normal(size=(n, n)), rng


@pytest.mark.parametrize("newmark", PARAMETERS)
def test_step_satisfies_assumptions_and_motion(newmark: tuple[float, float]) -> None:
    """On matrices without any symmetry: both assumptions and Eq. (10) at the new time."""
    M, C, K, rng = random_system(4, 1)
    q, dq, ddq, F = (rng.normal(size=(4, 1)) for _ in range(4))
    b, g = newmark
    h = 0.3
    new = step(M, C, K, (q, dq, ddq), F, h, newmark)
    a = new["ddq_next"]
    np.testing.assert_allclose(new["q_next"], q + h * dq + h**2 * ((0.5 - b) * ddq + b * a), rtol=1e-13)
    np.testing.assert_allclose(new["dq_next"], dq + h * ((1 - g) * ddq + g * a), rtol=1e-13)
    np.testing.assert_allclose(M @ a + C @ new["dq_next"] + K @ new["q_next"], F, rtol=1e-11, atol=1e-12)


@pytest.mark.parametrize("newmark", PARAMETERS)
def test_amplification_is_the_step_of_one_oscillator(newmark: tuple[float, float]) -> None:
    omega, xi, h = 3.0, 0.2, 0.17
    M, C, K = (np.array([[value]]) for value in (1.0, 2 * xi * omega, omega**2))
    q, dq = np.array([[0.3]]), np.array([[-0.7]])
    ddq = -(C @ dq + K @ q)
    new = step(M, C, K, (q, dq, ddq), np.zeros((1, 1)), h, newmark)
    A = np.array(function("amplification")(omega * h, xi, *newmark))
    expected = A @ [q[0, 0], h * dq[0, 0]]
    np.testing.assert_allclose([new["q_next"][0, 0], h * new["dq_next"][0, 0]], expected, rtol=1e-12)
    full = np.array(function("amplification_full")(omega * h, xi, *newmark))
    expected = full @ [q[0, 0], h * dq[0, 0], h**2 * ddq[0, 0]]
    np.testing.assert_allclose(
        [new["q_next"][0, 0], h * new["dq_next"][0, 0], h**2 * new["ddq_next"][0, 0]], expected, rtol=1e-12
    )
    np.testing.assert_allclose(np.abs(np.linalg.eigvals(full)).min(), 0, atol=1e-12)
    radius = np.abs(np.linalg.eigvals(A)).max()
    derived_radius = function("radius")(complex(omega * h), xi, *newmark)
    np.testing.assert_allclose(abs(derived_radius), radius, rtol=1e-12)


unit = st.floats(0, 1)


@settings(max_examples=200, deadline=None)
@given(b=unit, g=unit, xi=st.floats(0.01, 2))
@example(b=1.0, g=0.0, xi=2.0)
def test_limit_separates_stable_from_unstable_steps(b: float, g: float, xi: float) -> None:
    """Eigenvalues of A on both sides of the derived limit; no limit: bounded at any step."""
    with np.errstate(all="ignore"):
        inverse = float(function("inverse_limit")(1.0, np.float64(xi), b, g))

    def radius(Omega: float) -> float:
        return float(np.abs(np.linalg.eigvals(np.array(function("amplification")(Omega, xi, b, g)))).max())

    if inverse < 1e-6:
        assert all(radius(Omega) <= 1 + 1e-7 for Omega in np.logspace(-2, 4, 60))
    else:
        limit = 1 / inverse
        assert all(radius(limit * part) <= 1 + 1e-10 for part in (0.01, 0.3, 0.7, 0.95, 0.999))
        if abs(xi**2 * (1 - 2 * g) ** 2 - 4 * b + 2 * g) > 1e-4:
            assert radius(limit * 1.001) > 1
        else:  # −1 is a double root of the step's equation there, and nothing grows just above
            assert radius(limit) > 1 - 1e-9


def test_limit_in_the_textbook_form() -> None:
    """Central difference: Ω = 2; linear acceleration: Ω² = 12, undamped."""
    method = derived()
    for b, g, expected in ((0, sp.Rational(1, 2), 2), (sp.Rational(1, 6), sp.Rational(1, 2), 2 * sp.sqrt(3))):
        values = {method.b: b, method.g: g, method.xi: 0}
        assert sp.simplify(method.limit.subs(values) - expected) == 0
        assert sp.simplify(method.inverse_limit.subs(values) - 1 / expected) == 0
    assert method.inverse_limit.subs({method.b: sp.Rational(1, 4), method.g: sp.Rational(1, 2)}) == 0
    assert method.inverse_limit.subs({method.b: 0, method.g: sp.Rational(2, 5), method.xi: 0}) is sp.oo


@pytest.mark.parametrize("newmark", PARAMETERS)
@pytest.mark.parametrize("xi", [0.0, 0.3, 0.5])
def test_order_against_the_exponential(newmark: tuple[float, float], xi: float) -> None:
    """The error at a fixed time falls by 2^order where the step is halved."""
    method = derived()
    exact = expm(np.array([[0, 1], [-1, -2 * xi]]))
    errors = []
    for steps in (128, 256, 512):
        h = 1 / steps
        scale = np.diag([1, h])
        A = np.array(function("amplification")(h, xi, *newmark))
        errors.append(np.abs(np.linalg.solve(scale, np.linalg.matrix_power(A, steps)) @ scale - exact).max())
    order = np.log2(np.array(errors[:-1]) / errors[1:])
    expected = int(method.order.subs(method.g, sp.nsimplify(newmark[1])))
    assert expected == (2 if newmark[1] == 0.5 else 1)
    np.testing.assert_allclose(order, expected, atol=0.05)


@pytest.mark.parametrize("newmark", PARAMETERS)
def test_errors_of_period_and_damping(newmark: tuple[float, float]) -> None:
    """Leading terms against the eigenvalues of A at a small step, undamped."""
    Omega = 1e-2
    A = np.array(function("amplification")(Omega, 0.0, *newmark))
    root = np.log(np.linalg.eigvals(A).astype(complex))
    root = root[root.imag > 0][0]
    added = -root.real / Omega
    np.testing.assert_allclose(added, function("numerical_damping")(Omega, 0, *newmark), atol=2e-2 * Omega**1.5)
    if newmark[1] == 0.5:
        elongation = Omega / root.imag - 1
        np.testing.assert_allclose(elongation, function("period_elongation")(Omega, 0, *newmark), rtol=1e-3, atol=1e-12)


def test_average_acceleration_keeps_the_energy_for_symmetric_stiffness_only() -> None:
    M, _, K, rng = random_system(5, 3)
    gains = []
    for stiffness in (K + K.T, K):
        q, dq = rng.normal(size=(5, 1)), rng.normal(size=(5, 1))
        ddq = np.linalg.solve(M, -stiffness @ q)
        new = step(M, 0 * M, stiffness, (q, dq, ddq), np.zeros((5, 1)), 0.4, (0.25, 0.5))
        before = dq.T @ M @ dq + q.T @ stiffness @ q
        after = new["dq_next"].T @ M @ new["dq_next"] + new["q_next"].T @ stiffness @ new["q_next"]
        gains.append(abs((after - before).item()) / abs(dq.T @ M @ dq).item())
    assert gains[0] < 1e-12
    assert gains[1] > 1e-3


@pytest.mark.parametrize("newmark", PARAMETERS)
def test_pencil_holds_for_coupled_systems(newmark: tuple[float, float]) -> None:
    """Eigenvalues of the step of random nonsymmetric matrices make m M + c C + k K singular."""
    n, h = 3, 0.25
    M, C, K, _ = random_system(n, 5)
    unit = np.eye(2 * n)
    ddq = np.linalg.solve(M, -K @ unit[:n] - C @ unit[n:])
    new = step(M, C, K, (unit[:n], unit[n:], ddq), np.zeros((n, 2 * n)), h, newmark)
    roots = np.linalg.eigvals(np.vstack([new["q_next"], new["dq_next"]]))
    method = derived()
    pencil = sp.lambdify((method.rho, method.h, method.b, method.g), method.pencil, modules="numpy")
    for root in roots:
        m, c, k = pencil(root, h, *newmark)
        singular = np.linalg.svd(m * M + c * C + k * K, compute_uv=False)
        assert singular[-1] < 1e-11 * singular[0]


def test_average_acceleration_maps_the_spectrum() -> None:
    """|ρ| > 1 exactly where Re λ > 0, whatever the step: no flutter invented, none hidden."""
    M, C, K, _ = random_system(4, 7)
    n = len(M)
    generator = np.block([[np.zeros((n, n)), np.eye(n)], [np.linalg.solve(M, -K), np.linalg.solve(M, -C)]])
    exact = np.linalg.eigvals(generator)
    unit = np.eye(2 * n)
    for h in (0.01, 1.0, 30.0):
        new = step(M, C, K, (unit[:n], unit[n:], generator[n:]), np.zeros((n, 2 * n)), h, (0.25, 0.5))
        roots = np.linalg.eigvals(np.vstack([new["q_next"], new["dq_next"]]))
        mapped = 2 / h * (roots - 1) / (roots + 1)
        assert max(np.abs(exact - value).min() for value in mapped) < 1e-9 * np.abs(exact).max()
        assert (np.abs(roots) > 1).sum() == (exact.real > 0).sum() > 0


def test_record() -> None:
    """Every step holds the objects it is about; only the two assumptions need no check and no number."""
    steps = derived().steps
    assert len({record.what for record in steps}) == len(steps)
    for record in steps:
        assert isinstance(record, Step)
        for side in (record.before, record.after):
            for item in sp.flatten(side) if isinstance(side, tuple) else [side]:
                assert isinstance(item, (sp.Basic, sp.MatrixBase, int))
    assert [record.what for record in steps if not (record.check or record.equation)] == [steps[0].what]
    reserved = {"alpha", "beta", "gamma"}
    names = {s.name for _, e in derived().formulas for s in e.free_symbols}
    assert not names & reserved
