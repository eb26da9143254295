"""Laws of the emitted kernels: modes, matrices, rigid functions, reciprocity, Newmark's step."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.linalg import expm

import freebeam as fb

NAMES = ("free-free", "beck", "euler-pinned")
AXIAL = {"free-free": lambda x: x, "beck": np.ones_like, "euler-pinned": np.ones_like}  # axial force / P, Eq. (3)


def own(name: str, eta: float) -> dict[str, float]:
    return {"eta": eta} if name == "beck" else {}


def share(name: str, eta: float) -> float:
    """The part of the end force that follows the slope."""
    return {"free-free": 1.0, "beck": eta, "euler-pinned": 0.0}[name]


def gauss(modes: int) -> tuple[Any, Any]:
    """Gauss-Legendre nodes and weights on [0, 1], enough for products of three functions with γ up to (N + ½)π."""
    nodes, weights = np.polynomial.legendre.leggauss(50 + 6 * modes)
    return (nodes + 1) / 2, weights / 2


def state(M: Any, C: Any, K: Any) -> Any:
    """The matrix of Eq. (25)."""
    n = len(M)
    return np.block([[np.zeros((n, n)), np.eye(n)], [-np.linalg.solve(M, K), -np.linalg.solve(M, C)]])


def assert_same_eigenvalues(A: Any, B: Any, tolerance: float) -> None:
    """Each eigenvalue of A has one of B within tolerance, and the other way round."""
    a, b = (np.linalg.eigvals(X) if X.ndim == 2 else X for X in (np.asarray(A), np.asarray(B)))
    gap = np.abs(a[:, None] - b)
    assert a.shape == b.shape
    assert max(gap.min(axis=0).max(), gap.min(axis=1).max()) < tolerance * np.abs(a).max()


# Modes


@pytest.mark.parametrize("name", NAMES)
def test_modes_solve_the_beam_equation_and_its_end_conditions(name: str) -> None:
    """φ'''' = γ⁴ φ, and at each end the two derivatives that its kind strikes out. Eqs. (19), (20)."""
    zero = {"free": (2, 3), "clamped": (0, 1), "pinned": (0, 2), "sliding": (1, 3)}
    system = fb.column(name, "modes").system(40)
    x, gamma = np.linspace(0, 1, 101), system.gamma
    np.testing.assert_allclose(system.shapes(x, 4), gamma[:, None] ** 4 * system.shapes(x), rtol=1e-12)
    for place, end in enumerate(fb.column(name, "modes").ends):
        for d in zero[end]:
            assert (np.abs(system.shapes(float(place), d)) < 1e-12 * gamma**d).all()
        for d in set(range(4)) - set(zero[end]):  # and no other, so the conditions are not met by zero functions
            assert (np.abs(system.shapes(float(place), d)) > 0.5 * gamma**d).all()


@pytest.mark.parametrize("name", NAMES)
def test_derivatives_are_derivatives(name: str) -> None:
    """∫ₐᵇ φ⁽ᵈ⁺¹⁾ dx = φ⁽ᵈ⁾(b) − φ⁽ᵈ⁾(a)."""
    system = fb.column(name, "modes").system(12, rigid=True)
    x, w = gauss(12)
    a, b = 0.17, 0.83
    for d in range(5):
        rise = system.shapes(b, d) - system.shapes(a, d)
        integral = (b - a) * system.shapes(a + (b - a) * x, d + 1) @ w
        np.testing.assert_allclose(integral, rise, rtol=0, atol=1e-12 * np.abs(system.shapes(x, d)).max())


@pytest.mark.parametrize("name", NAMES)
def test_mode_n_has_the_nodes_of_mode_n(name: str) -> None:
    """Sturm's oscillation: no root is skipped or found twice. A free beam's first mode has two nodes."""
    column = fb.column(name, "modes")
    x = (np.arange(20000) + 0.37) / 20000  # no node at a point
    signs = np.sign(column.system(100).shapes(x))
    changes = (signs[:, 1:] != signs[:, :-1]).sum(axis=1)
    np.testing.assert_array_equal(changes, np.arange(100) + column.rigid_count)


@pytest.mark.parametrize("modes", [8, 60, 200])
@pytest.mark.parametrize("name", NAMES)
def test_modes_are_orthogonal(name: str, modes: int) -> None:
    """In mass and in bending energy, rigid functions included; the diagonals are M and E."""
    system = fb.column(name, "modes").system(modes, rigid=True)
    x, w = gauss(modes)
    f, bend = system.shapes(x), system.shapes(x, 2)
    gamma = np.concatenate([np.ones(system.rigid_count), system.gamma])
    np.testing.assert_allclose((f * w) @ f.T, system.M, rtol=0, atol=1e-12)
    np.testing.assert_allclose(
        (bend * w) @ bend.T / np.outer(gamma, gamma) ** 2, system.E / np.outer(gamma, gamma) ** 2, rtol=0, atol=1e-11
    )


@pytest.mark.parametrize("name", NAMES)
def test_bending_energy_is_the_mass_times_gamma_to_the_fourth(name: str) -> None:
    system = fb.column(name, "modes").system(200)
    np.testing.assert_allclose(system.E, np.diag(system.gamma**4 * np.diag(system.M)), rtol=1e-14, atol=0)
    assert (np.diff(system.gamma) > 0).all() and np.count_nonzero(system.M) == 200


# Matrices


@settings(max_examples=40, deadline=None, derandomize=True)
@given(name=st.sampled_from(NAMES), modes=st.integers(1, 64), eta=st.floats(-0.5, 1.5), rigid=st.booleans())
def test_load_matrix_by_quadrature(name: str, modes: int, eta: float, rigid: bool) -> None:
    """H[i, j] = −∫ n φᵢ′φⱼ′ dx + η φᵢ(1) φⱼ′(1), with n the axial force at P = 1 and i the test function. Eq. (11)."""
    system = fb.column(name, "modes").system(modes, rigid=rigid, **own(name, eta))
    x, w = gauss(modes)
    slope = system.shapes(x, 1)
    H = -(slope * (w * AXIAL[name](x))) @ slope.T
    H += share(name, eta) * np.outer(system.shapes(1.0), system.shapes(1.0, 1))
    gamma = np.concatenate([np.ones(system.rigid_count), system.gamma])
    np.testing.assert_allclose(system.H / np.outer(gamma, gamma), H / np.outer(gamma, gamma), rtol=0, atol=3e-13)


@settings(max_examples=30, deadline=None, derandomize=True)
@given(
    name=st.sampled_from(NAMES),
    modes=st.integers(1, 30),
    load=st.floats(-100, 100),
    alpha=st.floats(0, 1),
    beta=st.floats(0, 10),
    rigid=st.booleans(),
)
def test_damping_leaves_out_the_geometric_stiffness(
    name: str, modes: int, load: float, alpha: float, beta: float, rigid: bool
) -> None:
    """Eq. (12), C = β M + α (K − K^G), against C of Eq. (11) by quadrature."""
    column = fb.column(name, "modes")
    system = column.system(modes, load, alpha, beta, rigid)
    x, w = gauss(modes)
    f, bend = system.shapes(x), system.shapes(x, 2)
    C = beta * (f * w) @ f.T + alpha * (bend * w) @ bend.T
    scale = np.concatenate([np.ones(system.rigid_count), system.gamma]) ** 2
    np.testing.assert_allclose(
        system.C / np.outer(scale, scale), C / np.outer(scale, scale), rtol=0, atol=1e-12 * (1 + beta)
    )
    geometric = load * column.system(modes, rigid=rigid).H  # Eq. (13)
    rounding = 1e-14 * np.abs(system.K).max()
    np.testing.assert_allclose(
        system.C, beta * system.M + alpha * (system.K - geometric), rtol=1e-13, atol=rounding * alpha
    )
    emitted = column.kernel.damping(system.basis, alpha, beta, rigid)
    np.testing.assert_array_equal(system.C, emitted)


# Rigid functions of the free beam


@pytest.mark.parametrize("beta", [0.0, 0.4])
@pytest.mark.parametrize("modes", [1, 8, 25])
def test_the_free_beam_is_block_triangular(modes: int, beta: float) -> None:
    """Rigid columns of the elastic rows vanish in M, C and K by quadrature too, with external damping; the reverse
    coupling does not: elastic motion drives the rigid."""
    system = fb.column("free-free", "modes").system(modes, 50.0, 1e-3, beta, rigid=True)
    x, w = gauss(modes)
    f, slope = system.shapes(x), system.shapes(x, 1)
    M = (f * w) @ f.T
    H = -(slope * w * x) @ slope.T + np.outer(system.shapes(1.0), system.shapes(1.0, 1))
    for matrix in (M, H / np.concatenate([[1, 1], system.gamma])[:, None]):
        assert np.abs(matrix[2:, :2]).max() < 1e-12
    for matrix in (system.M, system.C, system.K):
        assert not matrix[2:, :2].any()
    assert (np.abs(system.K[:2, 2:]) > 50).all()
    # The rigid block: the translation row feels the rotation with P; nothing restores either.
    np.testing.assert_allclose(system.K[:2, :2], [[0, 50], [0, 0]], atol=1e-12)
    np.testing.assert_allclose(H[:2, :2], [[0, 1], [0, 0]], atol=1e-12)
    np.testing.assert_allclose(system.C[:2, :2], beta * np.diag([1, 1 / 12]), rtol=1e-15)


@pytest.mark.parametrize(("alpha", "beta"), [(0.0, 0.0), (1e-3, 0.1), (0.05, 2.0)])
@pytest.mark.parametrize("load", [0.0, 60.0, 130.0])
def test_rigid_functions_leave_the_elastic_spectrum_as_it_is(load: float, alpha: float, beta: float) -> None:
    """Theorem: "the first two rigid body modes are not involved in the instability" (section 3.1)."""
    column = fb.column("free-free", "modes")
    elastic = column.system(6, load, alpha, beta)
    whole = column.system(6, load, alpha, beta, rigid=True)
    expected = np.concatenate([np.linalg.eigvals(state(elastic.M, elastic.C, elastic.K)), [0, 0, -beta, -beta]])
    # rounding scatters the defective λ = 0 by its fourth root, so the characteristic polynomial is compared:
    # det(z − A) at points on circles round the spectrum
    for z in 1.5 * np.abs(expected).max() * np.exp(2j * np.pi * np.arange(1, 30) / 30):
        n = len(whole.M)
        ratio = np.linalg.det((z * np.eye(2 * n) - state(whole.M, whole.C, whole.K)) / z) / np.prod(1 - expected / z)
        assert ratio == pytest.approx(1, abs=1e-9)
    result = fb.spectrum(whole)
    assert_same_eigenvalues(result.eigenvalues, expected, 1e-10)
    assert_same_eigenvalues(result.elastic, fb.spectrum(elastic).eigenvalues, 1e-10)


def rigid_state(load: float, alpha: float, beta: float, modes: int = 1) -> Any:
    system = fb.column("free-free", "modes").system(modes, load, alpha, beta, rigid=True)
    return state(system.M, system.C, system.K)


@pytest.mark.parametrize(
    ("load", "beta", "chains"), [(0.0, 0.0, [2, 2]), (50.0, 0.0, [4]), (0.0, 20.0, [1, 1]), (50.0, 20.0, [2])]
)
def test_jordan_chains_of_the_rigid_motion(load: float, beta: float, chains: list[int]) -> None:
    """λ = 0 is defective: rank Aᵏ⁻¹ − rank Aᵏ counts the chains of length k or more."""
    # deflections in units of their motion at ω = 20: entries of like size
    unit = np.repeat([1.0, 20.0], 3)
    A = rigid_state(load, 1e-3, beta) / 20 * unit / unit[:, None]
    power, ranks = np.eye(6), [6]
    for _ in range(6):
        power = power @ A
        values = np.linalg.svd(power, compute_uv=False)
        rank = int((values > 1e-12 * values[0]).sum())
        assert not ((values > 1e-14 * values[0]) & (values < 1e-7 * values[0])).any()  # a clear gap
        ranks.append(rank)
    drops = -np.diff(ranks)
    np.testing.assert_array_equal(drops, [sum(c >= k for c in chains) for k in range(1, 7)])


@pytest.mark.parametrize(("beta", "order"), [(0.0, 3), (0.5, 1)])
def test_an_unsteered_beam_drifts(beta: float, order: int) -> None:
    """Once the elastic motion has died, the deflection is a polynomial in time: of degree 3 without external damping
    (the beam tumbles), of degree 1 with it. From the exact exponential of the first-order system."""
    A = rigid_state(40.0, 0.02, beta, modes=2)
    start = np.zeros(len(A))
    start[2] = 0.01  # elastic motion alone: it drives the rigid
    once = expm(A * 8.0)
    states = [np.linalg.matrix_power(once, k + 7) @ start for k in range(8)]
    translation = np.array([s[0] for s in states])
    drift = np.diff(translation, order)
    assert np.abs(drift).max() > 1e-6
    np.testing.assert_allclose(drift, drift[0], rtol=1e-6)  # all differences of that order are the same
    assert max(abs(s[2]) for s in states) < 1e-9


def test_a_turned_beam_falls_to_its_side() -> None:
    """Rigid part alone, by hand: ÿ = −P θ, θ̈ = 0 at β = 0; βẏ → −P θ at β > 0."""
    P = 30.0
    start = np.array([0, 0, 0, 0, 1.0, 0])  # θ̇ = 1
    for t in (0.5, 2.0, 7.0):
        free = expm(rigid_state(P, 1e-3, 0.0) * t) @ start
        assert free[0] == pytest.approx(-P * t**3 / 6, rel=1e-9) and free[1] == pytest.approx(t, rel=1e-9)
    beta = 2.0
    damped = expm(rigid_state(P, 1e-3, beta) * 40.0) @ start
    assert damped[1] == pytest.approx(1 / beta, rel=1e-9)
    assert damped[3] == pytest.approx(-P / beta**2, rel=1e-9)


# Eq. (11) as printed: the end term transposed


def printed(system: Any) -> Any:
    """The same system with +P φᵢ′(1) φⱼ(1) in place of +P φᵢ(1) φⱼ′(1)."""
    tip, slope = system.shapes(1.0), system.shapes(1.0, 1)
    return replace(system, K=system.K - system.load * (np.outer(tip, slope) - np.outer(slope, tip)))


def test_the_printed_equation_has_the_spectrum_and_not_the_eigenvectors() -> None:
    for load in (5.0, 50.0, 100.0, 130.0):
        derived = fb.column("free-free", "modes").system(8, load, 1e-3, 0.1)
        other = printed(derived)
        scale = np.abs(derived.K).max()
        np.testing.assert_allclose(other.K, derived.K.T, rtol=0, atol=1e-13 * scale)
        ours, theirs = fb.spectrum(derived), fb.spectrum(other)
        assert_same_eigenvalues(ours.eigenvalues, theirs.eigenvalues, 1e-12)
        k = int(np.argmin(np.abs(ours.eigenvalues.imag - np.abs(ours.eigenvalues.imag).min())))
        m = int(np.argmin(np.abs(theirs.eigenvalues - ours.eigenvalues[k])))
        u, v = ours.vectors[:, k], theirs.vectors[:, m]
        aligned = abs(np.vdot(u, v)) / np.linalg.norm(u) / np.linalg.norm(v)
        assert aligned < 1 - 1e-5 * load


def test_the_printed_equation_with_rigid_functions_lets_the_drift_into_the_elastic_part() -> None:
    """Transposed, the triangle turns over: the rigid motion drives the elastic."""
    derived = fb.column("free-free", "modes").system(8, 50.0, 1e-3, 0.1, rigid=True)
    other = printed(derived)
    assert not derived.K[2:, :2].any() and np.abs(other.K[2:, :2]).min() > 50
    forced = {"force": np.sin, "force_position": 1.0, "sensors": [0.1]}
    ours, theirs = (fb.respond(s, 40.0, 0.01, **forced).y_elastic for s in (derived, other))
    late = slice(2000, None)
    assert np.abs(theirs[late]).max() > 100 * np.abs(ours[late]).max()


@settings(max_examples=25, deadline=None, derandomize=True)
@given(
    load=st.floats(1, 120),
    alpha=st.floats(0, 0.05),
    beta=st.floats(0, 2),
    sensor=st.floats(0, 1),
    place=st.floats(0, 1),
    rigid=st.booleans(),
    lam=st.complex_numbers(min_magnitude=1, max_magnitude=60),
)
def test_reciprocity(
    load: float, alpha: float, beta: float, sensor: float, place: float, rigid: bool, lam: complex
) -> None:
    """Transfer functions: the printed one from x_F to x_s is the derived one from x_s to x_F."""
    lam = complex(abs(lam.real) + 5, lam.imag)  # off the spectrum
    derived = fb.column("free-free", "modes").system(8, load, alpha, beta, rigid)

    def transfer(system: Any, x_s: float, x_F: float) -> complex:
        return complex(
            system.shapes(x_s) @ np.linalg.solve(lam**2 * system.M + lam * system.C + system.K, system.Q(x_F))
        )

    ours, theirs = transfer(derived, place, sensor), transfer(printed(derived), sensor, place)
    size = sum(abs(transfer(derived, x, x)) for x in (sensor, place)) + abs(ours)
    assert abs(ours - theirs) < 1e-10 * size


@pytest.mark.parametrize("rigid", [False, True])
def test_reciprocity_in_time_and_that_the_responses_differ(rigid: bool) -> None:
    derived = fb.column("free-free", "modes").system(8, 50.0, 1e-3, 0.1, rigid)

    def response(system: Any, sensor: float, place: float) -> Any:
        return fb.respond(
            system, 6.0, 0.01, force=lambda t: np.sin(3 * t) + t, force_position=place, sensors=[sensor]
        ).y[:, 0]

    theirs = response(printed(derived), 0.1, 1.0)
    swapped, ours = response(derived, 1.0, 0.1), response(derived, 0.1, 1.0)
    np.testing.assert_allclose(theirs, swapped, rtol=0, atol=1e-9 * np.abs(swapped).max())
    assert np.abs(theirs - ours).max() > 0.2 * np.abs(ours).max()
    # without follower force Betti's theorem holds for the derived system alone
    free = fb.column("free-free", "modes").system(8, 0.0, 1e-3, 0.1, rigid)
    there, back = response(free, 0.1, 1.0), response(free, 1.0, 0.1)
    np.testing.assert_allclose(there, back, rtol=0, atol=1e-9 * np.abs(there).max())


# Damped frequencies, Eq. (23)


@pytest.mark.parametrize(("alpha", "beta"), [(0.0, 0.0), (1e-3, 0.1), (0.2, 3.0), (0.0, 44.0)])
@pytest.mark.parametrize("name", NAMES)
def test_frequencies_are_the_eigenvalues_without_load(name: str, alpha: float, beta: float) -> None:
    system = fb.column(name, "modes").system(8, 0.0, alpha, beta)
    pair = np.concatenate(system.column.kernel.frequencies(system.gamma, alpha, beta))
    assert_same_eigenvalues(state(system.M, system.C, system.K), pair, 1e-10)


def test_heavy_damping_costs_the_slow_eigenvalue_no_digits() -> None:
    """λ₁ λ₂ = γ⁴ and λ₁ + λ₂ = −(β + αγ⁴), where the textbook's formula would lose the small one."""
    kernel = fb.column("free-free", "modes").kernel
    gamma = fb.column("free-free", "modes").system(50).gamma
    for alpha, beta in ((0.0, 1e9), (1e3, 0.0), (1e-3, 0.1)):
        first, second = kernel.frequencies(gamma, alpha, beta)
        np.testing.assert_allclose(first * second, gamma**4, rtol=1e-14)
        np.testing.assert_allclose(first + second, -(beta + alpha * gamma**4), rtol=1e-14)


# Newmark's step


def test_newmark_step_satisfies_what_defines_it() -> None:
    """The equation of motion at the new time and Newmark's two expansions of displacement and velocity."""
    system = fb.column("beck", "modes").system(6, 15.0, 1e-3, 0.3)
    rng = np.random.default_rng(4)
    M, C, K, h = system.M, system.C, system.K, 0.013
    for b, g in ((0.25, 0.5), (0.0, 0.5), (1 / 6, 0.5), (0.3025, 0.6), (0.1, 0.3)):
        q, dq, ddq, F = rng.normal(size=(4, 6, 3))
        q1, dq1, ddq1 = system.column.kernel.newmark_step(M, C, K, q, dq, ddq, F, h, (b, g))
        residual = M @ ddq1 + C @ dq1 + K @ q1 - F
        assert np.abs(residual).max() < 1e-11 * np.abs(K @ q1).max()
        np.testing.assert_allclose(q1, q + h * dq + h * h * ((0.5 - b) * ddq + b * ddq1), rtol=1e-12, atol=1e-13)
        np.testing.assert_allclose(dq1, dq + h * ((1 - g) * ddq + g * ddq1), rtol=1e-12, atol=1e-12)


def amplification(xi: float, reach: float, newmark: tuple[float, float]) -> Any:
    """(q, q̇) after a step from unit states of q̈ + 2ξ q̇ + q = 0, step `reach` = ωh."""
    one = np.ones((1, 1))
    q, dq = one * [1.0, 0.0], one * [0.0, 1.0]
    step = fb.column("free-free", "modes").kernel.newmark_step
    q, dq, _ = step(one, 2 * xi * one, one, q, dq, -q - 2 * xi * dq, 0 * q, reach, newmark)
    return np.vstack([q, dq])


def radius(xi: float, reach: float, newmark: tuple[float, float]) -> float:
    return float(np.abs(np.linalg.eigvals(amplification(xi, reach, newmark))).max())


@settings(max_examples=150, deadline=None, derandomize=True)
@given(xi=st.floats(0, 2), b=st.floats(0, 0.6), g=st.floats(0.0, 1.2))
def test_newmark_limit_parts_decay_from_growth(xi: float, b: float, g: float) -> None:
    limit = fb.column("beck", "modes").kernel.newmark_limit(xi, (b, g))
    assert limit >= 0
    for part in (0.05, 0.5, 0.99):
        if limit > 0:
            assert radius(xi, part * min(limit, 50.0), (b, g)) <= 1 + 1e-7
    if math.isinf(limit):
        assert all(radius(xi, reach, (b, g)) <= 1 + 1e-7 for reach in np.geomspace(0.01, 1e3, 20))
    else:
        # just above; from zero where no step is stable
        assert max(radius(xi, reach, (b, g)) for reach in (1.02 * limit + 0.01, 1.05 * limit + 0.05)) > 1


def test_newmark_limits_of_the_textbook() -> None:
    limit = fb.column("free-free", "modes").kernel.newmark_limit
    assert limit(0.0, (0.25, 0.5)) == math.inf  # average acceleration
    assert limit(0.0, (1 / 6, 0.5)) == pytest.approx(2 * math.sqrt(3), rel=1e-14)  # linear acceleration
    assert limit(0.0, (0.0, 0.5)) == pytest.approx(2.0, rel=1e-14)  # central differences
    assert limit(0.3, (0.0, 0.5)) == pytest.approx(2.0, rel=1e-14)  # where damping does not help


def test_average_acceleration_keeps_the_energy_without_load_and_damping() -> None:
    system = fb.column("beck", "modes").system(6)
    rng = np.random.default_rng(1)
    q, dq = rng.normal(size=(2, 6)) / system.gamma**2
    ddq = np.linalg.solve(system.M, -system.K @ q)
    energies = []
    for _ in range(300):
        energies.append((dq @ system.M @ dq + q @ system.K @ q) / 2)
        q, dq, ddq = system.column.kernel.newmark_step(system.M, system.C, system.K, q, dq, ddq, 0 * q, 0.02)
    np.testing.assert_allclose(energies, energies[0], rtol=1e-10)


@pytest.mark.parametrize(("newmark", "order"), [((0.25, 0.5), 2), ((1 / 6, 0.5), 2), ((0.3, 0.6), 1)])
def test_the_order_of_newmarks_method(newmark: tuple[float, float], order: int) -> None:
    """Against the exact exponential, at a fixed time: the error falls by 2^order where the step is halved."""
    xi = 0.05
    exact = expm(np.array([[0, 1], [-1, -2 * xi]]) * 2.0)
    error = [
        np.abs(np.linalg.matrix_power(amplification(xi, 2.0 / n, newmark), n) - exact).max() for n in (100, 200, 400)
    ]
    for coarse, fine in pairwise(error):
        assert math.log2(coarse / fine) == pytest.approx(order, abs=0.05)
