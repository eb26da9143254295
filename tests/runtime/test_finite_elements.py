"""Critical loads of the Ritz series against finite elements, against the beam itself, and against plain eigenvalues.

The finite elements are cubic Hermite ones with consistent mass and geometric stiffness, assembled here. The beam
itself is its differential equation, (1 + αλ) y'''' + P (n y')' + (λ² + βλ) y = 0, solved by power series or in closed
form. Neither shares anything with the modes of the unloaded beam.
"""

from __future__ import annotations

import math
from functools import cache
from itertools import pairwise
from typing import Any

import mpmath as mp
import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import freebeam as fb

NAMES = ("free-free", "beck", "euler-pinned")


def own(name: str, eta: float) -> dict[str, float]:
    return {"eta": eta} if name == "beck" else {}


# Finite elements


@cache
def finite_elements(name: str, elements: int, eta: float) -> tuple[Any, Any, Any]:
    """M, E, H of equal cubic Hermite elements: nodal deflections and slopes, those that an end holds struck out."""
    h = 1 / elements
    nodes, weights = np.polynomial.legendre.leggauss(4)  # exact to degree 7
    z, w = (nodes + 1) / 2, weights * h / 2
    shapes = np.array([1 - 3 * z**2 + 2 * z**3, h * (z - 2 * z**2 + z**3), 3 * z**2 - 2 * z**3, h * (z**3 - z**2)])
    slopes = np.array([6 * z**2 - 6 * z, h * (1 - 4 * z + 3 * z**2), 6 * z - 6 * z**2, h * (3 * z**2 - 2 * z)]) / h
    bends = np.array([12 * z - 6, h * (6 * z - 4), 6 - 12 * z, h * (6 * z - 2)]) / h**2
    size = 2 * elements + 2
    M, E, H = np.zeros((3, size, size))
    for k in range(elements):
        part = slice(2 * k, 2 * k + 4)
        axial = (k + z) * h if name == "free-free" else np.ones_like(z)  # Eq. (3), or the same all along
        M[part, part] += (shapes * w) @ shapes.T
        E[part, part] += (bends * w) @ bends.T
        H[part, part] -= (slopes * w * axial) @ slopes.T
    # virtual work −η P y'(1) δy(1): row of the end's deflection, column of its slope
    H[-2, -1] += {"free-free": 1.0, "beck": eta, "euler-pinned": 0.0}[name]
    held = {"free-free": [], "beck": [0, 1], "euler-pinned": [0, size - 2]}[name]
    free = np.setdiff1d(np.arange(size), held)
    return M[np.ix_(free, free)], E[np.ix_(free, free)], H[np.ix_(free, free)]


def grows(matrices: tuple[Any, Any, Any], load: float, alpha: float, beta: float) -> bool:
    """Whether an eigenvalue has a positive real part, beyond rounding.

    |λ| < 1 is left out for the free beam: rigid motion, λ = 0 and −β, defective and scattered by rounding.
    """
    M, E, H = matrices
    free = np.linalg.matrix_rank(E) < len(E)
    if not (alpha or beta):
        s = np.linalg.eigvals(np.linalg.solve(M, E + load * H)).astype(complex)
        s = s[np.abs(s) > 1] if free else s
        return bool(((np.abs(s.imag) > 1e-6 * np.abs(s)) | (s.real < 0)).any())
    n = len(M)
    A = np.block(
        [[np.zeros((n, n)), np.eye(n)], [-np.linalg.solve(M, E + load * H), -np.linalg.solve(M, alpha * E + beta * M)]]
    )
    values = np.linalg.eigvals(A)
    values = values[np.abs(values) > 1] if free else values
    return bool(values.real.max() > 1e-9)


def first_growth(matrices: tuple[Any, Any, Any], alpha: float, beta: float, below: float) -> float:
    """First load with a growing eigenvalue, by a scan up to `below` and bisection."""
    low, high = 0.0, math.nan
    for load in np.linspace(0, below, 25)[1:]:
        if grows(matrices, load, alpha, beta):
            high = float(load)
            break
        low = float(load)
    assert math.isfinite(high)
    for _ in range(36):
        middle = (low + high) / 2
        low, high = (low, middle) if grows(matrices, middle, alpha, beta) else (middle, high)
    return (low + high) / 2


@pytest.mark.parametrize(
    ("name", "eta", "alpha", "beta", "kind"),
    [
        ("free-free", 1.0, 0.0, 0.0, "flutter"),
        ("free-free", 1.0, 1e-3, 0.1, "flutter"),
        ("free-free", 1.0, 0.02, 0.0, "flutter"),
        ("beck", 1.0, 0.0, 0.0, "flutter"),
        ("beck", 1.0, 0.01, 0.5, "flutter"),
        ("beck", 0.8, 0.0, 0.0, "flutter"),
        ("beck", 0.3, 0.0, 0.0, "divergence"),
        ("beck", 0.0, 0.01, 0.5, "divergence"),
        ("euler-pinned", 1.0, 0.0, 0.0, "divergence"),
        ("euler-pinned", 1.0, 0.01, 0.5, "divergence"),
    ],
)
def test_finite_elements_converge_to_the_ritz_load_with_the_fourth_power_of_their_length(
    name: str, eta: float, alpha: float, beta: float, kind: str
) -> None:
    ritz = fb.critical_load(fb.column(name, "modes"), modes=48, alpha=alpha, beta=beta, **own(name, eta))
    assert ritz.kind == kind
    loads = [first_growth(finite_elements(name, n, eta), alpha, beta, 1.5 * ritz.load) for n in (8, 16, 32)]
    first, second = np.diff(loads)
    assert math.log2(first / second) == pytest.approx(4, abs=0.25)
    extrapolated = loads[2] + second / 15  # the h⁴ term taken off
    truncation = 8e-4 if 0 < eta < 1 else 3e-5  # of 48 modes; see the rates below
    assert ritz.load == pytest.approx(extrapolated, rel=truncation)


def test_finite_elements_flutter_at_the_same_frequency() -> None:
    M, E, H = finite_elements("beck", 20, 1.0)
    found = fb.critical_load(fb.column("beck", "modes"), modes=24)
    s = np.linalg.eigvals(np.linalg.solve(M, E + found.load * H)).astype(complex)
    pair = np.sort_complex(np.sqrt(s))[:2]  # the two that meet; near there they differ by the root of the error
    assert pair.mean().real == pytest.approx(found.frequency, rel=1e-4)


# The beam itself


def end_values(name: str, p: Any, s: Any, terms: int = 64) -> list[list[Any]]:
    """y, y', y'', y''' at x = 1 of both solutions of y'''' + p (n y')' = s y that meet the left end, by series."""
    starts = {"free-free": (0, 1), "beck": (2, 3), "euler-pinned": (1, 3)}[name]
    result = []
    for start in starts:
        a = [mp.mpf(0)] * 4
        a[start] = mp.mpf(1)
        for k in range(terms):
            axial = (k + 1) ** 2 * a[k + 1] if name == "free-free" else (k + 2) * (k + 1) * a[k + 2]
            a.append((s * a[k] - p * axial) / ((k + 1) * (k + 2) * (k + 3) * (k + 4)))
        result.append([mp.fsum(math.perm(k, d) * a[k] for k in range(d, len(a))) for d in range(4)])
    return result


def characteristic(name: str, p: Any, s: Any, eta: Any = 1) -> Any:
    """Determinant of the right end's conditions; the free beam's without its rigid factor s²."""
    u, v = end_values(name, p, s)

    def conditions(y: list[Any]) -> tuple[Any, Any]:
        return (y[0], y[2]) if name == "euler-pinned" else (y[2], y[3] + p * (1 - eta) * y[1])

    (a, b), (c, d) = conditions(u), conditions(v)
    return (a * d - b * c) / (s**2 if name == "free-free" else 1)


def closed_form(p: Any, s: Any, eta: Any = 1) -> Any:
    """The cantilever's determinant in trigonometric functions, scaled like that of the series."""
    root = mp.sqrt(p * p / 4 + s)
    a, b = mp.sqrt(root + p / 2), mp.sqrt(root - p / 2)
    ca, sa, ch, sh = mp.cos(a), mp.sin(a), mp.cosh(b), mp.sinh(b)
    u1, u2, u3 = -a * sa - b * sh, -a * a * ca - b * b * ch, a**3 * sa - b**3 * sh  # cos ax − cosh bx
    v1, v2, v3 = ca - ch, -a * sa - b * sh, -a * a * ca - b * b * ch  # sin ax / a − sinh bx / b
    return 12 / (p * p + 4 * s) * (u2 * (v3 + p * (1 - eta) * v1) - v2 * (u3 + p * (1 - eta) * u1))


@cache
def exact_load(name: str, eta: float = 1.0, alpha: float = 0.0, beta: float = 0.0) -> tuple[float, float]:
    """Flutter load and frequency of the beam itself: the root that the Ritz value points to, to 15 digits at least.

    Without damping the double root (F, ∂F/∂s) = 0; with it F = 0 at λ = iω.
    """
    near = fb.critical_load(fb.column(name, "modes"), modes=8, alpha=alpha, beta=beta, **own(name, eta))
    eta = mp.mpf(eta)
    with mp.workdps(30):
        if not (alpha or beta):
            step = mp.mpf(10) ** -10

            def double(p: Any, s: Any) -> tuple[Any, Any]:
                low, high = (characteristic(name, p, s + k * step, eta) for k in (-1, 1))
                return (low + high) / 2, (high - low) / (2 * step)

            p, s = mp.findroot(double, (mp.mpf(near.load), mp.mpf(near.frequency) ** 2), tol=1e-30)
            return float(p), float(mp.sqrt(s))

        def single(P: Any, omega: Any) -> tuple[Any, Any]:
            lam = 1j * omega
            p, s = P / (1 + alpha * lam), -(lam**2 + beta * lam) / (1 + alpha * lam)
            F = characteristic(name, p, s, eta)
            return mp.re(F), mp.im(F)

        P, omega = mp.findroot(single, (mp.mpf(near.load), mp.mpf(near.frequency)))
        return float(P), float(omega)


@pytest.mark.parametrize(("p", "s", "eta"), [(20, 121, 1), (5, 30, 0.3), (11 + 4j, 90 - 20j, 0.7)])
def test_series_and_closed_form_are_the_same_function(p: complex, s: complex, eta: float) -> None:
    ratio = characteristic("beck", p, s, eta) / closed_form(mp.mpmathify(p), mp.mpmathify(s), eta)
    assert abs(ratio - 1) < 1e-12


def test_becks_load() -> None:
    """20.05 of Beck (1952), from his determinant: where two roots of F(P, ·) meet."""
    near = fb.critical_load(fb.column("beck", "modes"), modes=32)
    with mp.workdps(30):
        p, s = mp.findroot(
            lambda p, s: (closed_form(p, s), mp.diff(lambda z: closed_form(p, z), s)), (mp.mpf(20), mp.mpf(121))
        )
    assert near.load == pytest.approx(float(p), rel=1e-6)
    assert near.frequency == pytest.approx(math.sqrt(s), rel=1e-5)
    assert f"{float(p):.2f}" == "20.05"  # as the literature has it
    assert exact_load("beck")[0] == pytest.approx(float(p), rel=1e-13)


@pytest.mark.parametrize(
    ("name", "eta", "alpha", "beta", "modes", "relative"),
    [
        ("free-free", 1.0, 0.0, 0.0, 48, 2e-7),
        ("free-free", 1.0, 1e-3, 0.1, 48, 2e-7),
        ("free-free", 1.0, 0.03, 1.0, 48, 1e-6),
        ("beck", 1.0, 0.005, 0.0, 48, 2e-6),
        ("beck", 1.0, 0.0, 3.0, 48, 2e-7),
        ("beck", 0.8, 0.01, 0.1, 48, 2e-4),
    ],
)
def test_the_ritz_load_is_near_that_of_the_beam_itself(
    name: str, eta: float, alpha: float, beta: float, modes: int, relative: float
) -> None:
    load, frequency = exact_load(name, eta, alpha, beta)
    ritz = fb.critical_load(fb.column(name, "modes"), modes=modes, alpha=alpha, beta=beta, **own(name, eta))
    assert ritz.load == pytest.approx(load, rel=relative)
    assert ritz.frequency == pytest.approx(frequency, rel=10 * relative)
    coarse = fb.critical_load(fb.column(name, "modes"), modes=8, alpha=alpha, beta=beta, **own(name, eta))
    assert abs(coarse.load / load - 1) > relative  # so that the tolerance says something


@pytest.mark.parametrize(
    ("name", "eta", "rate"),
    [("free-free", 1.0, 5), ("beck", 1.0, 4), ("beck", 0.7, 2), ("beck", 0.0, 3)],
)
def test_ritz_loads_converge_at_an_algebraic_rate(name: str, eta: float, rate: int) -> None:
    """|load(N) − exact| ~ N^−rate. The modes meet the unloaded beam's end conditions, not the loaded one's or its
    adjoint's, which limits the rate; nothing says from which side the values come, and both sides occur."""
    exact = math.pi**2 / 4 if eta == 0 else exact_load(name, eta)[0]
    orders = (8, 16, 32, 64)
    errors = [abs(fb.critical_load(fb.column(name, "modes"), modes=N, **own(name, eta)).load - exact) for N in orders]
    slopes = [math.log2(coarse / fine) for coarse, fine in pairwise(errors)]
    assert slopes[-1] == pytest.approx(rate, abs=0.35)
    for slope, following in pairwise(slopes):  # and the slope tends to the rate
        assert abs(following - rate) < abs(slope - rate)


def test_ritz_loads_are_no_bounds() -> None:
    """At N = 8 the free beam's lies above the exact load, Beck's below."""
    free, beck = (
        fb.critical_load(fb.column(name, "modes"), modes=8).load - exact_load(name)[0] for name in ("free-free", "beck")
    )
    assert free > 1e-3 and beck < -1e-4


# Known limits


@pytest.mark.parametrize("modes", [1, 2, 9, 40])
def test_eulers_load(modes: int) -> None:
    """sin √P = 0: the modes of the pinned beam are exact, so that every N gives π²."""
    found = fb.critical_load(fb.column("euler-pinned", "modes"), modes=modes, alpha=0.01, beta=0.1)
    assert found.kind == "divergence" and found.frequency == 0
    assert found.load == pytest.approx(math.pi**2, rel=1e-13)


@pytest.mark.parametrize("eta", [-0.5, 0.0, 0.2, 0.4, 0.45])
def test_divergence_of_the_sub_tangential_cantilever(eta: float) -> None:
    """At ω = 0 the determinant is 1 − (1 − η)(1 − cos √P) = 0: cos √P = −η / (1 − η), π²/4 for a dead load."""
    found = fb.critical_load(fb.column("beck", "modes"), modes=40, eta=eta)
    exact = math.acos(-eta / (1 - eta)) ** 2
    assert found.kind == "divergence"
    assert found.load == pytest.approx(exact, rel=1e-2 if eta > 0.41 else 2e-3)
    coarse = fb.critical_load(fb.column("beck", "modes"), modes=10, eta=eta).load
    assert abs(found.load - exact) < abs(coarse - exact) / 2


def test_kind_changes_at_half_follower_share() -> None:
    """cos √P = −η / (1 − η) has a root for η ≤ ½ only: divergence below, flutter above; the series' own limit, where
    det(E + P H) loses its roots, tends to ½."""
    beck = fb.column("beck", "modes")

    def kind(eta: float, modes: int) -> str:
        return fb.critical_load(beck, modes=modes, eta=eta).kind

    assert kind(0.49, 8) == "divergence" and kind(0.51, 8) == "flutter"
    gaps = []
    for modes in (6, 12, 24):
        low, high = 0.4, 0.6
        assert kind(low, modes) == "divergence" and kind(high, modes) == "flutter"
        while high - low > 1e-9:
            middle = (low + high) / 2
            low, high = (middle, high) if kind(middle, modes) == "divergence" else (low, middle)
        gaps.append(abs(low - 0.5))
    assert gaps[0] < 0.02
    assert all(fine < coarse / 3 for coarse, fine in pairwise(gaps))


# Stability just below and instability just above, by plain eigenvalues


@settings(max_examples=120, deadline=None, derandomize=True)
@given(
    name=st.sampled_from(NAMES),
    modes=st.integers(1, 14),
    eta=st.floats(0, 1.3),
    alpha=st.one_of(st.just(0.0), st.floats(-5, 1).map(lambda k: 10.0**k)),
    beta=st.one_of(st.just(0.0), st.floats(-2, 3).map(lambda k: 10.0**k)),
)
def test_the_reported_load_parts_stability_from_instability(
    name: str, modes: int, eta: float, alpha: float, beta: float
) -> None:
    assume(alpha or beta)
    column = fb.column(name, "modes")
    found = fb.critical_load(column, modes=modes, alpha=alpha, beta=beta, load_max=500.0, **own(name, eta))
    M, E, H = column.matrices(modes, **own(name, eta))
    scale = 1 / np.sqrt(np.diag(M))
    M, E, H = (X * np.outer(scale, scale) for X in (M, E, H))

    def growth(load: float) -> float:
        A = np.block([[np.zeros_like(M), np.eye(modes)], [-(E + load * H), -(alpha * E + beta * M)]])
        return float(np.linalg.eigvals(A).real.max())

    reach = found.load if found.kind != "none" else 500.0
    below = [reach * (1 - 1e-3), *np.linspace(0.02, 0.98, 25) * reach]
    assert max(growth(load) for load in below) < 1e-6
    if found.kind != "none":
        assert growth(reach * (1 + 1e-3)) > 0
