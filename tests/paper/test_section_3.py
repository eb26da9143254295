"""Section 3, Ritz method: Eqs. (7)-(26) in numbers at the paper's N = 8, from the equations as they stand.

Where the print is at fault the test says so and takes what docs/errata.md derives.
"""

from __future__ import annotations

import math
from functools import cache
from typing import Any

import mpmath as mp
import numpy as np
import pytest

import freebeam as fb

N = 8
P, ALPHA, BETA = 50.0, 1e-3, 0.1
DAMPINGS = [(0.0, 0.0), (1e-3, 0.1), (0.05, 2.0)]


def system(load: float = P, alpha: float = ALPHA, beta: float = BETA) -> fb.System:
    return fb.column("free-free").system(N, load, alpha, beta)


@cache
def roots() -> tuple[Any, ...]:
    """The first eight positive roots of Eq. (21), by bisection in 30 digits."""
    with mp.workdps(30):
        return tuple(
            mp.findroot(lambda g: mp.cos(g) * mp.cosh(g) - 1, ((n + 0.3) * mp.pi, (n + 0.7) * mp.pi), solver="anderson")
            for n in range(1, N + 1)
        )


def chi(gamma: Any, x: Any, derivative: int = 0) -> Any:
    """Eq. (22) as printed, or a derivative of it, in the arithmetic at hand."""
    ratio = (mp.cos(gamma) - mp.cosh(gamma)) / (mp.sin(gamma) + mp.sinh(gamma))
    sine = (mp.sin, mp.cos, lambda z: -mp.sin(z), lambda z: -mp.cos(z))
    hyperbolic = (mp.sinh, mp.cosh)
    z, d = gamma * x, derivative
    first = sine[d % 4](z) + hyperbolic[d % 2](z)
    second = sine[(d + 1) % 4](z) + hyperbolic[(d + 1) % 2](z)
    return gamma**d * (first + ratio * second)


@cache
def printed_modes(derivative: int, places: tuple[float, ...]) -> Any:
    with mp.workdps(30):
        return np.array([[float(chi(g, mp.mpf(x), derivative)) for x in places] for g in roots()])


NODES, WEIGHTS = np.polynomial.legendre.leggauss(48)
X, W = tuple(((NODES + 1) / 2).tolist()), WEIGHTS / 2


def integral(i: int, j: int, weight: Any = 1.0) -> Any:
    """∫ weight χᵢ⁽ⁱ⁾ χⱼ⁽ʲ⁾ dx of the printed modes, (8, 8)."""
    return (printed_modes(i, X) * (W * weight)) @ printed_modes(j, X).T


def energies(q: Any, dq: Any) -> tuple[float, float, float]:
    """T, V and W_c of Eq. (8) by quadrature, for y = Σ qᵢ φᵢ. Eq. (9)."""
    y_t, y_x, y_xx = dq @ printed_modes(0, X), q @ printed_modes(1, X), q @ printed_modes(2, X)
    x = np.array(X)
    return W @ y_t**2 / 2, W @ y_xx**2 / 2, P * (W * x) @ y_x**2 / 2


def test_equations_7_to_11_from_the_energies() -> None:
    """Lagrange's equations of T − V + W_c with the virtual work of Eq. (8); central differences are exact for energies
    quadratic in q. The follower force's virtual work is −P₀ y'(1) δy(1); the print lacks δy(1)."""
    s, rng = system(), np.random.default_rng(3)
    q, dq, ddq = rng.normal(size=(3, N)) / s.gamma**2
    unit, step = np.eye(N), 1e-2

    def gradient(which: int, at: Any) -> Any:
        return np.array(
            [
                (energies(at + step * e, at + step * e)[which] - energies(at - step * e, at - step * e)[which])
                for e in unit
            ]
        ) / (2 * step)

    inertia = gradient(0, ddq)  # d/dt ∂T/∂q̇
    conservative = gradient(1, q) - gradient(2, q)
    damping = (W * (dq @ printed_modes(0, X)) * BETA) @ printed_modes(0, X).T
    damping += (W * (dq @ printed_modes(2, X)) * ALPHA) @ printed_modes(2, X).T
    follower = P * (q @ printed_modes(1, (1.0,)))[0] * printed_modes(0, (1.0,))[:, 0]
    force = 0.7 * printed_modes(0, (0.4,))[:, 0]
    residual = inertia + damping + conservative + follower - force
    ours = s.M @ ddq + s.C @ dq + s.K @ q - 0.7 * s.Q(0.4)
    np.testing.assert_allclose(ours, residual, rtol=0, atol=1e-8 * np.abs(conservative).max())
    # as printed, follower term transposed: something else
    tip, slope = s.shapes(1.0), s.shapes(1.0, 1)
    transposed = ours + P * (np.outer(slope, tip) - np.outer(tip, slope)) @ q
    assert np.abs(transposed - residual).max() > 1e-2 * np.abs(conservative).max()


def test_equation_9_the_series() -> None:
    """y(x, t) = Σ φᵢ(x) qᵢ(t) at the sensors, with its velocity and acceleration; Eq. (10) at every step."""
    s = system()
    response = fb.respond(s, 2.0, 0.01, force=np.sin, force_position=1.0, sensors=[0.1, 0.9], states=True)
    places = printed_modes(0, (0.1, 0.9))
    np.testing.assert_allclose(response.y, response.q @ places, rtol=0, atol=1e-11 * np.abs(response.y).max())
    np.testing.assert_allclose(response.dy, response.dq @ places, rtol=0, atol=1e-11 * np.abs(response.dy).max())
    forces = np.outer(np.sin(response.t), s.Q(1.0)) - response.dq @ s.C.T - response.q @ s.K.T
    expected = np.linalg.solve(s.M, forces.T).T @ places
    np.testing.assert_allclose(response.ddy, expected, rtol=0, atol=1e-9 * np.abs(expected).max())


def test_equations_11_to_13_the_matrices() -> None:
    s = system()
    gamma = np.outer(s.gamma, s.gamma)
    end = np.outer(
        printed_modes(0, (1.0,))[:, 0], printed_modes(1, (1.0,))[:, 0]
    )  # row: test function (printed: column)
    geometric = P * (end - integral(1, 1, np.array(X)))  # Eq. (13)
    M, E = integral(0, 0), integral(2, 2)
    for ours, expected, scale in (
        (s.M, M, 1),
        (s.C, BETA * M + ALPHA * E, gamma**2),
        (s.K, E + geometric, gamma**2),
        (s.C, BETA * s.M + ALPHA * (s.K - geometric), gamma**2),  # Eq. (12)
    ):
        np.testing.assert_allclose(ours / scale, expected / scale, rtol=0, atol=1e-13)
    np.testing.assert_allclose(s.Q(0.37), printed_modes(0, (0.37,))[:, 0], rtol=1e-12)
    # "does not appear as C = βM + αK": the whole K would be wrong
    assert np.abs(s.C - BETA * s.M - ALPHA * s.K).max() > 1e-2


@pytest.mark.parametrize(("alpha", "beta"), DAMPINGS)
def test_equations_14_to_20_the_unloaded_beam(alpha: float, beta: float) -> None:
    """χ e^(λ₀t) solves Eq. (14) and meets Eq. (15) with λ₀ of Eq. (23): Eqs. (16)-(20)."""
    s = system(0.0, alpha, beta)
    x = np.linspace(0, 1, 21)
    four = s.gamma[:, None] ** 4
    np.testing.assert_allclose(s.shapes(x, 4), four * s.shapes(x), rtol=0, atol=1e-13 * four.max())  # Eq. (19)
    for lam in s.column.kernel.frequencies(s.gamma, alpha, beta):
        lam = lam[:, None]
        # Eq. (17), fourth derivatives where the text shows three primes
        terms = lam**2 * s.shapes(x), lam * beta * s.shapes(x), (1 + lam * alpha) * s.shapes(x, 4)
        assert np.abs(sum(terms) / four).max() < 1e-12
        np.testing.assert_allclose(-(lam**2 + lam * beta) / (1 + lam * alpha), four, rtol=1e-11)  # Eq. (19)
    for place in (0.0, 1.0):  # Eqs. (15), (18), (20)
        for order in (2, 3):
            assert (np.abs(s.shapes(place, order)) < 1e-13 * s.gamma**order).all()


def test_equation_21_the_characteristic_equation() -> None:
    gamma = system().gamma
    np.testing.assert_allclose(gamma, [float(g) for g in roots()], rtol=4e-16, atol=0)
    assert max(abs(float(mp.cos(g) * mp.cosh(g) - 1)) for g in roots()) < 1e-6  # they are roots
    grid = np.linspace(0.5, gamma[-1] + 0.5, 4000)
    value = np.cos(grid) - 1 / np.cosh(grid)
    assert (np.sign(value[1:]) != np.sign(value[:-1])).sum() == N  # and there are no others below


def test_equation_22_the_modes_and_their_normalisation() -> None:
    """As printed, the coefficient of sin γx being 1. Typed into floats it loses its digits, the kernels keep them."""
    s = system()
    places = tuple(np.linspace(0, 1, 17).tolist())
    for d in range(4):
        expected = printed_modes(d, places)
        np.testing.assert_allclose(
            s.shapes(places, d) / s.gamma[:, None] ** d, expected / s.gamma[:, None] ** d, atol=2e-14
        )
    # the coefficient of sin alone: χ − χ''/γ² = 2 (sin γx + ratio cos γx), fitted
    wave = (s.shapes(places) - s.shapes(places, 2) / s.gamma[:, None] ** 2) / 2
    for g, values in zip(s.gamma, wave, strict=True):
        basis = np.column_stack([np.sin(g * np.array(places)), np.cos(g * np.array(places))])
        assert np.linalg.lstsq(basis, values)[0][0] == pytest.approx(1, abs=1e-12)
    g, x = s.gamma[:, None], np.array(places)
    ratio = (np.cos(g) - np.cosh(g)) / (np.sin(g) + np.sinh(g))
    typed = np.sin(g * x) + np.sinh(g * x) + ratio * (np.cos(g * x) + np.cosh(g * x))
    assert 1e-7 < np.abs(typed - s.shapes(x))[-1].max() < 1e-3


def test_the_modes_do_not_depend_on_damping_but_the_frequencies_do() -> None:
    """Section 3.1, below Eq. (22)."""
    light, heavy = system(0.0, 0.0, 0.0), system(0.0, 0.01, 2.0)
    assert light.shapes(0.3).tolist() == heavy.shapes(0.3).tolist()
    first = [np.abs(fb.spectrum(s).eigenvalues.imag).min() for s in (light, heavy)]
    assert first[1] < 0.999 * first[0]


@pytest.mark.parametrize(("alpha", "beta"), DAMPINGS)
def test_equation_23_the_damped_frequencies(alpha: float, beta: float) -> None:
    s = system(0.0, alpha, beta)
    four = s.gamma**4
    root = np.sqrt((beta + alpha * four) ** 2 - 4 * four + 0j)
    printed = np.concatenate([(-(beta + alpha * four) + sign * root) / 2 for sign in (1, -1)])
    kernel = np.concatenate(s.column.kernel.frequencies(s.gamma, alpha, beta))
    for values in (kernel, fb.spectrum(s).eigenvalues):
        gap = np.abs(values[:, None] - printed).min(axis=1)
        assert (gap < 1e-9 * np.abs(values).max()).all()


@pytest.mark.parametrize(("alpha", "beta"), DAMPINGS)
@pytest.mark.parametrize("load", [0.0, 50.0, 112.0])
def test_equations_24_and_25_the_eigenvalue_problem(load: float, alpha: float, beta: float) -> None:
    """q̂ e^(λt) solves Eq. (10) without force, and the λ are those of the matrix A as printed."""
    s = system(load, alpha, beta)
    found = fb.spectrum(s)
    for lam, q in zip(found.eigenvalues, found.vectors.T, strict=True):
        residual = (lam**2 * s.M + lam * s.C + s.K) @ q
        terms = abs(lam) ** 2 * np.abs(s.M) + abs(lam) * np.abs(s.C) + np.abs(s.K)
        assert np.abs(residual).max() < 1e-12 * terms.max()
        assert np.abs(q).max() == pytest.approx(1)
    inverse = np.linalg.inv(s.M)
    A = np.block([[np.zeros((N, N)), np.eye(N)], [-inverse @ s.K, -inverse @ s.C]])
    gap = np.abs(np.linalg.eigvals(A)[:, None] - found.eigenvalues)
    assert max(gap.min(axis=0).max(), gap.min(axis=1).max()) < 1e-9 * np.abs(found.eigenvalues).max()


def test_equation_26_the_reference_frequency() -> None:
    """The second term of Eq. (23) for γ₁, whatever the load; none where mode 1 is overdamped."""
    gamma = float(roots()[0])
    for load, alpha, beta in ((0.0, 0.0, 0.0), (50.0, 1e-3, 0.1), (88.0, 0.05, 3.0)):
        reference = fb.spectrum(system(load, alpha, beta)).reference_frequency
        expected = math.sqrt(4 * gamma**4 - (beta + alpha * gamma**4) ** 2) / 2
        assert reference == pytest.approx(expected, rel=1e-12)
    normalised = fb.spectrum(system(0.0, 1e-3, 0.1)).normalised
    assert np.abs(normalised.imag).min() == pytest.approx(1, rel=1e-9)
    limit = 2 / gamma**2  # inside the range of Fig. 4
    assert 1e-3 < limit < 1e-1
    assert fb.spectrum(system(50.0, limit * (1 - 1e-9), 0.0)).reference_frequency is not None
    assert fb.spectrum(system(50.0, limit * (1 + 1e-9), 0.0)).reference_frequency is None
