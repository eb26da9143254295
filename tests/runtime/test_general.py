"""First losses of problems with any damping, against dense scans of eigenvalues, exact values and the proportional
form."""

from __future__ import annotations

import math

import mpmath
import numpy as np
import pytest
from scipy.linalg import eigh

import freebeam_sym as fb
from freebeam.maps.surface import first_crossing
from freebeam_sym.checks import InputError
from freebeam_sym.stability.arnoldi import _told_apart
from freebeam_sym.stability.crossings import first_loss
from freebeam_sym.stability.derivatives import crossing_derivative
from freebeam_sym.stability.equations import newton
from freebeam_sym.stability.general import General
from freebeam_sym.stability.pencil import Pencil
from freebeam_sym.stability.problem import Crossing

Matrices = list[np.ndarray]


def value(X: Matrices, P: float) -> np.ndarray:
    return sum(P**k * A for k, A in enumerate(X))


def growth(M: Matrices, C: Matrices, K: Matrices, P: float) -> float:
    """Largest real part of the eigenvalues at a load, by inverting the mass matrix."""
    n = len(M[0])
    A = np.linalg.solve(value(M, P), np.hstack([-value(K, P), -value(C, P)]))
    return float(np.linalg.eigvals(np.vstack([np.hstack([np.zeros((n, n)), np.eye(n)]), A])).real.max())


def scanned(M: Matrices, C: Matrices, K: Matrices, top: float, tiny: float = 1e-12, count: int = 1500) -> float | None:
    """The first load up to `top` at which something grows, by equal steps and bisection."""
    low = 0.0
    for P in np.linspace(top / count, top, count):
        if growth(M, C, K, P) > tiny:
            high = float(P)
            while high - low > 1e-12 * high:
                middle = (low + high) / 2
                low, high = (low, middle) if growth(M, C, K, middle) > tiny else (middle, high)
            return high
        low = float(P)
    return None


def random_system(rng: np.random.Generator) -> tuple[Matrices, Matrices, Matrices]:
    """Springs, masses, dashpots, gyroscopic terms and loads of degree 1 to 3, nothing symmetric, stable at load 0."""
    n = int(rng.integers(1, 13))
    while True:
        L = rng.normal(size=(n, n)) / math.sqrt(n)
        M0 = np.eye(n) + 0.3 * L @ L.T
        E = np.diag(np.arange(1, n + 1.0) ** 2) + 0.3 * rng.normal(size=(n, n)) * rng.integers(2)
        H = [rng.normal(size=(n, n)) / 3 ** (k + 1) for k in range(rng.integers(1, 4))]
        G, s = rng.normal(size=(n, n)), rng.normal(size=n)
        C0 = 10 ** rng.uniform(-3, 0) * np.outer(s, s) + 10 ** rng.uniform(-3, -1) * np.eye(n)
        C0 = C0 + rng.integers(2) * (G - G.T)
        C = [C0] if rng.integers(2) else [C0, 0.1 * rng.normal(size=(n, n))]
        M = [M0] if rng.integers(4) else [M0, 0.02 * L]
        if growth(M, C, [E], 0.0) < -1e-4:
            return M, C, [E, *H]


@pytest.mark.parametrize("seed", range(200))
def test_random_systems_lose_stability_where_a_scan_says(seed: int) -> None:
    M, C, K = random_system(np.random.default_rng(seed))
    found = first_loss(General(M, C, K), 8.0).crossing
    expected = scanned(M, C, K, 8.0 if found is None else min(8.0, 1.01 * found.load), count=400)
    if expected is None:
        assert found is None
        return
    assert found is not None
    assert found.load == pytest.approx(expected, rel=1e-6)
    G = value(K, found.load) + 1j * found.frequency * value(C, found.load) - found.frequency**2 * value(M, found.load)
    assert np.abs(G @ found.vector).max() < 1e-10 * np.abs(value(K, 0.0)).max()
    assert (found.frequency == 0) == (found.kind == "divergence")


ZIEGLER = (
    np.array([[3.0, 1], [1, 1]]),
    np.array([[2.0, -1], [-1, 1]]),
    np.array([[-1.0, 1], [0, 0]]),
)


def test_zieglers_pendulum() -> None:
    """Undamped, and in the limit of equal joint dampers: Ziegler's paradox, exactly."""
    M, E, H = ZIEGLER
    undamped = first_loss(General([M], [0 * E], [E, H])).crossing
    vanishing = first_loss(General([M], [E], [E, H], vanishing=True)).crossing
    assert undamped is not None and vanishing is not None
    assert undamped.load == pytest.approx(7 / 2 - math.sqrt(2), rel=1e-14)
    assert vanishing.load == pytest.approx(41 / 28, rel=1e-14)
    assert General([M], [E], [E, H], vanishing=True).rounding(vanishing) < 1e-12


def test_an_undamped_part_beside_a_damped_one_is_lost_where_it_is_alone() -> None:
    """Its frequencies meet, where damping elsewhere decides nothing of the load to first order."""
    M, E, H = (np.kron(np.eye(2), X) for X in ZIEGLER)
    half = np.kron(np.diag([2.0, 0.0]), ZIEGLER[1])  # with it the damped one is lost at 3.46
    problem = General([M], [half], [E, H])
    found = first_loss(problem).crossing
    assert found is not None and found.kind == "flutter"
    assert found.load == pytest.approx(7 / 2 - math.sqrt(2), rel=1e-9) and problem.rounding(found) == 1.0


@pytest.mark.parametrize("name", ["beck", "free-free"])
@pytest.mark.parametrize("modes", [4, 9])
@pytest.mark.parametrize(
    ("alpha", "beta", "kappa"),
    [(1e-3, 0.1, None), (0, 0, None), (0, 0, 0.0), (0, 0, 3.0), (1e-8, 0, None), (0, 1e-6, None), (1, 2, None)],
)
def test_proportional_damping_is_a_case_of_any(
    name: str, modes: int, alpha: float, beta: float, kappa: float | None
) -> None:
    M, E, H = fb.column(name).matrices(modes, False)
    expected = first_crossing(Pencil(M, E, H), alpha, beta, kappa=kappa)
    C = alpha * E + beta * M if kappa is None else E + kappa * M
    problem = General([M], [C], [E, H], vanishing=kappa is not None)
    found = first_loss(problem).crossing
    assert expected is not None and found is not None
    assert (found.load, found.kind) == (pytest.approx(expected.load, rel=1e-9), expected.kind)
    assert found.frequency == pytest.approx(expected.frequency, rel=1e-6)
    assert problem.rounding(found) < 1e-6


def pipe(modes: int, beta: float) -> tuple[Matrices, Matrices, Matrices]:
    """A cantilevered pipe that conveys fluid, u = P, in powers of x from x² on, made orthonormal."""
    x, weight = np.polynomial.legendre.leggauss(3 * modes + 6)
    x, weight = (x + 1) / 2, weight / 2
    powers = [
        np.polynomial.Polynomial([0, 0, 1])
        * np.polynomial.Legendre.basis(k, domain=[0, 1]).convert(kind=np.polynomial.Polynomial)
        for k in range(modes)
    ]
    f, d, dd = (np.array([p.deriv(k)(x) if k else p(x) for p in powers]) for k in range(3))
    C = 2 * math.sqrt(beta) * (f * weight) @ d.T
    return [(f * weight) @ f.T], [0 * C, C], [(dd * weight) @ dd.T, 0 * C, (f * weight) @ dd.T]


def test_a_pipe_is_damped_by_its_flow() -> None:
    """C = 0 without flow. Gregory and Paidoussis's problem: 4.74989677312 from the exact solution."""
    found = first_loss(General(*pipe(12, 0.1)), 20.0).crossing
    assert found is not None
    assert found.load == pytest.approx(4.74989677312, rel=1e-9)


@pytest.mark.parametrize("beta", [1e-13, 1e-10, 1e-7, 1e-5])
def test_light_damping_beside_that_of_the_load_moves_the_load_by_little(beta: float) -> None:
    """A pipe in air: without flow it is hardly damped, and at its first loss of stability by the flow."""
    M, C, K = pipe(12, 0.1)
    found = first_loss(General(M, [beta * M[0], C[1]], K), 20.0).crossing
    assert found is not None and found.frequency > 1
    assert found.load == pytest.approx(4.74989677312, rel=1e-9 + beta)


def test_a_rotation_restored_by_the_load_alone() -> None:
    """E is singular: ω² of the rotation is P k near 0; then two frequencies meet, by the discriminant of s."""
    M, E = np.eye(2), np.diag([0.0, 4.0])
    H = np.array([[1.0, 2.0], [-2.0, 0.0]])
    # s² − (4 + P) s + 4 P + 4 P² = 0: discriminant (4 + P)² − 16 P − 16 P² = 16 − 8 P − 15 P²
    found = first_loss(General([M], [0 * M], [E, H]), 5.0).crossing
    assert found is not None
    assert found.load == pytest.approx((-8 + math.sqrt(64 + 960)) / 30, rel=1e-12)
    damped = first_loss(General([M], [0.1 * M], [E, H]), 5.0).crossing
    assert damped is not None
    assert damped.load == pytest.approx(scanned([M], [0.1 * M], [E, H], 2.0), rel=1e-8)


def test_what_is_unstable_from_the_start_is_refused() -> None:
    with pytest.raises(InputError, match="smallest loads"):
        first_loss(General([np.eye(2)], [0.1 * np.eye(2)], [np.diag([0.0, 4.0]), -np.eye(2)]), 5.0)
    with pytest.raises(InputError, match="singular at every load"):
        first_loss(General([np.eye(2)], [np.eye(2)], [np.diag([0.0, 4.0])]), 5.0)


def triples(seed: int) -> tuple[Matrices, Matrices, Matrices, Matrices]:
    rng = np.random.default_rng(seed)
    while True:
        M, C, K = random_system(rng)
        if len(M[0]) > 2:
            return M, C, K, [0.1 * rng.normal(size=M[0].shape) for _ in range(3)]


@pytest.mark.parametrize("seed", range(12))
def test_derivative_of_a_crossing_by_differences(seed: int) -> None:
    M, C, K, d = triples(seed)

    def crossing(p: float) -> np.ndarray:
        system = ([X[0] + p * D, *X[1:]] for X, D in zip((M, C, K), d, strict=True))
        found = first_loss(General(*system)).crossing
        assert found is not None
        return np.array([found.load, found.frequency])

    load, frequency = crossing(0.0)
    at = tuple(value(X, load) for X in (M, C, K))
    slope = tuple(value([(k + 1) * A for k, A in enumerate(X[1:])] or [0 * X[0]], load) for X in (M, C, K))
    h = 1e-6 * min(1.0, load)
    found = crossing_derivative(frequency, at, slope, tuple(d))
    assert found == pytest.approx((crossing(h) - crossing(-h)) / (2 * h), rel=1e-4, abs=1e-6)


@pytest.mark.parametrize("vanishing", [False, True])
def test_derivative_where_frequencies_meet_or_damping_vanishes(vanishing: bool) -> None:
    """Ziegler's pendulum with a spring 1 + p at the root, without damping and with one that vanishes; damping makes the
    load jump where frequencies meet, and is refused."""
    M, E, H = ZIEGLER
    spring, zero = np.diag([1.0, 0.0]), np.zeros((2, 2))
    C = np.array([[2.0, -1], [-1, 1]]) if vanishing else zero

    def flutter(p: float) -> np.ndarray:
        found = first_loss(General([M], [C + p * C @ C], [E + p * spring, H], vanishing)).crossing
        assert found is not None
        return np.array([found.load, found.frequency])

    P, omega = flutter(0.0)
    at, slope = (M, C, E + P * H), (zero, zero, H)
    expected = (flutter(1e-5) - flutter(-1e-5)) / 2e-5
    found = crossing_derivative(omega, at, slope, (zero, C @ C, spring), vanishing)
    assert found == pytest.approx(expected, rel=1e-7)
    if not vanishing:
        with pytest.raises(InputError, match="frequencies meet"):
            crossing_derivative(omega, at, slope, (zero, spring, zero))


def test_derivatives_of_one_motion_and_of_weakly_coupled_ones() -> None:
    """Of q̈ + ε(3 − P + p)q̇ + (4 + p)q = 0, lost at P = 3 + p with ω² = 4 + p; and of ω² = 4, 5 − P − p coupled by ±k,
    which meet at P = 1 − p − 2k with ω² = 4 + k; and of λ = P − 1 − p ± i, without mass. Two motions of one frequency,
    not coupled, are refused."""
    one = np.ones((1, 1))
    found = crossing_derivative(2.0, (one, 0 * one, 4 * one), (0 * one, -one, 0 * one), (0 * one, one, one), True)
    assert found == pytest.approx((1, 0.25), rel=1e-9)
    zero, last, turn = np.zeros((2, 2)), np.diag([0.0, -1]), np.array([[0.0, 1], [-1, 0]])
    for k in (1e-1, 1e-3, 1e-5):
        at = np.eye(2), zero, np.diag([4.0, 4 + 2 * k]) + k * turn
        found = crossing_derivative(math.sqrt(4 + k), at, (zero, zero, last), (zero, zero, turn + last))
        assert found == pytest.approx((-3, 0.25 / math.sqrt(1 + k / 4)), rel=1e-6)
    found = crossing_derivative(1.0, (zero, np.eye(2), turn), (zero, zero, -np.eye(2)), (zero, zero, np.eye(2)))
    assert found == pytest.approx((1, 0), abs=1e-12)
    with pytest.raises(InputError, match="one frequency"):
        crossing_derivative(2.0, (np.eye(2), zero, 4 * np.eye(2)), (zero, zero, turn), (zero, zero, last))


def test_gyroscopic_stabilisation_is_lost_as_flutter() -> None:
    """K = −(1 + P), C = 4J: (λ² − 1 − P)² + 16 λ² = 0 has its roots on the axis up to 1 + P = 4."""
    J = np.array([[0.0, -1], [1, 0]])
    found = first_loss(General([np.eye(2)], [4 * J], [-np.eye(2), -np.eye(2)]), 10.0).crossing
    assert found is not None and found.kind == "flutter"
    assert (found.load, found.frequency) == (pytest.approx(3, rel=1e-9), pytest.approx(2, rel=1e-4))


@pytest.mark.parametrize("damping", ["none", "vanishing", "light", "any"])
@pytest.mark.parametrize("seed", range(6))
def test_counts_are_those_of_the_eigenvalues(seed: int, damping: str) -> None:
    """How many eigenvalues grow at a load: undamped the ω² that are complex or negative, one of λ = ±√(−ω²) each; in
    the limit of vanishing damping those of a damping that is small."""
    rng = np.random.default_rng(1000 + seed)
    n = 6
    L = rng.normal(size=(n, n))
    M, E, H = np.eye(n) + 0.1 * L @ L.T, np.diag(np.arange(1.0, n + 1) ** 2), rng.normal(size=(n, n))
    S = rng.normal(size=(n, n))
    C = np.eye(n) + 0.5 * S @ S.T / n
    size = {"none": 0.0, "vanishing": 1.0, "light": 1e-6, "any": 0.1}[damping]
    problem = General([M], [size * C], [E, H], vanishing=damping == "vanishing")
    seen = set()
    for P in np.linspace(0.3, 12.0, 30):
        K = E + P * H
        squares = np.linalg.eigvals(np.linalg.solve(M, K))
        gap = np.abs(squares[:, None] - squares[None]) + 1e9 * np.eye(n)
        if gap.min() < 0.05 or np.abs(squares).min() < 0.05:
            continue  # next to a crossing
        if damping == "none":
            expected = int(((np.abs(squares.imag) > 1e-9) | (squares.real < 0)).sum())
        else:
            c = {"vanishing": 1e-8}.get(damping, size) * C
            A = np.block([[np.zeros((n, n)), np.eye(n)], [-np.linalg.solve(M, K), -np.linalg.solve(M, c)]])
            growth = np.linalg.eigvals(A).real
            if np.abs(growth).min() < {"any": 1e-6}.get(damping, 1e-11):
                continue
            expected = int((growth > 0).sum())
        assert (problem.unstable(P) > 0) == (expected > 0)
        seen.add(expected > 0)
        if damping in ("none", "any"):
            assert problem.unstable(P) == expected
    assert seen == {True, False}


def test_a_coordinate_without_mass_does_not_hide_a_flutter() -> None:
    """Links whose follower force takes its direction from r = q: as where r is eliminated. r has s = ∞ exactly."""
    M, E = np.array([[3.0, 1.0], [1.0, 1.0]]), np.array([[2.0, -1.0], [-1.0, 1.0]])
    H = np.array([[-1.0, 1.0], [0.0, 0.0]])
    with_r = [np.zeros((3, 3)) for _ in range(3)]
    with_r[0][:2, :2], with_r[1][:2, :2] = M, E
    with_r[1][2] = 0.0, -1.0, 1.0
    with_r[2][0] = -1.0, 0.0, 1.0
    found, known = (first_loss(General([X], [0 * X], [Y, Z])).crossing for X, Y, Z in (tuple(with_r), (M, E, H)))
    assert known is not None and known.kind == "flutter" and known.load == pytest.approx(7 / 2 - 2**0.5)
    assert found is not None and found.kind == "flutter" and found.load == pytest.approx(known.load, rel=1e-9)


@pytest.mark.parametrize("seed", range(3))
def test_a_load_that_enters_squared_is_the_root_of_one_that_does_not(seed: int) -> None:
    """K = E + P²H loses stability at the root of the load of K = E + P H, undamped and where damping vanishes."""
    rng = np.random.default_rng(seed)
    n, none = 4, np.zeros((4, 4))
    E, H, S = np.diag(np.arange(1.0, n + 1) ** 2), rng.normal(size=(n, n)), rng.normal(size=(n, n))
    H, C = H - H.T + 0.3 * np.diag(np.arange(n)), np.eye(n) + 0.2 * S @ S.T
    for damping in (none, C):
        once, twice = (
            first_loss(General([np.eye(n)], [damping], K, vanishing=damping is C), top).crossing
            for K, top in (([E, H], 100.0), ([E, none, H], 10.0))
        )
        assert once is not None and twice is not None and once.kind == twice.kind == "flutter"
        assert twice.load == pytest.approx(math.sqrt(once.load), rel=1e-9)


def test_a_meeting_of_two_that_grow_is_no_flutter() -> None:
    """det(K − s) = (s + 3)² − (2 − P)² + 1 has a double root at P = 1: s = −3, of two λ that are real."""
    M, zero = np.array([np.eye(2)]), np.zeros((1, 2, 2))
    K = np.array([[[-1.0, 1], [-1, -5]], [[-1.0, 0], [0, 1]]])
    for lift, expected in ((0.0, -1.0), (4.0, 1.0)):
        K[0] += lift * np.eye(2)
        found = newton(M, M + zero, K, 0.0, lift - 3 + 1e-5, 1 + 1e-5, np.array([1, -1 + 1e-5]), -np.ones(2) / 2, 3.0)
        assert found is not None and found[:2] == pytest.approx((expected, 1.0), rel=1e-6)


@pytest.mark.parametrize("seed", range(6))
def test_rates_that_turn_or_damp_lose_nothing_before_stiffness_does(seed: int) -> None:
    """Thomson and Tait: with M and K symmetric the first loss is where K is singular. One part of
    K or of the rates that is not so makes another problem."""
    dice = np.random.default_rng(seed)
    n = 5
    X, Y, Z, W = dice.standard_normal((4, n, n))
    M, K, H, G = X @ X.T + np.eye(n), Y @ Y.T + np.eye(n), Z + Z.T - 9 * np.eye(n), W - W.T
    damps = X.T @ X if seed % 2 else 0 * X
    problem = General([M], [damps, 3 * G], [K, H])
    first = 1 / eigh(-H, K, eigvals_only=True)[-1]
    found = first_loss(problem, 100.0).crossing
    assert found is not None and found.kind == "divergence" and found.load == pytest.approx(first, rel=1e-9)
    assert problem.quiet == found.load and not problem.unstable(0.999 * first)
    for C, stiff in (([damps, 3 * G + X @ X.T], [K, H]), ([damps, 3 * G], [K, H + W]), ([damps - 9 * K, G], [K, H])):
        assert General([M], C, stiff).quiet == 0.0
    assert General([M, 1e-3 * K], [damps, 3 * G], [K, H]).quiet == 0.0
    assert General([M], [damps, 3 * G], [-K, H]).quiet == 0.0


def test_a_scan_sees_what_grows_between_two_of_its_steps() -> None:
    """Something grows on a stretch of loads that is little more than a step of the scan, wherever that is."""
    for low in np.linspace(0.1, 0.9, 9):
        problem = object.__new__(General)
        problem.__dict__ |= {"_operator": None, "quiet": 0.0}
        problem.unstable = lambda P, manner=None, low=low: int(low < P < low + 1.1 / 256)  # type: ignore[method-assign]
        problem.onset = lambda P: Crossing(P, 1.0, np.ones(1, complex), "flutter")  # type: ignore[method-assign]
        (event,) = problem.flutters(1.0)
        assert event.crossing.load == pytest.approx(low, rel=1e-12)


def test_rounding_of_a_load_is_not_that_of_rates_alone_where_something_is_damped() -> None:
    """With no damping rounding splits frequencies that meet by its root; with little the load has most digits. With
    C = 40 J + c and w = ω²: P = c (2w − 5) / 80 and (2 − w)(3 − w) − c²w + P² = 1600 w."""
    J, c = np.array([[0.0, -1], [1, 0]]), 0.01
    problem = General([np.eye(2)], [40 * J + c * np.eye(2)], [np.diag([2.0, 3.0]), J])
    found = first_loss(problem, 100.0).crossing
    assert found is not None and found.kind == "flutter"
    with mpmath.workdps(40):
        s = mpmath.mpf(c) ** 2
        w = max(mpmath.polyroots([1 + s / 1600, -1605 - s - s / 320, 6 + s / 256], extraprec=200))
        exact = mpmath.mpf(c) * (2 * w - 5) / 80
        assert abs(found.load / exact - 1) <= problem.rounding(found) < 1e-11


@pytest.mark.parametrize("unit", [1e-6, 1.0, 1e6])
def test_loads_that_differ_are_told_apart_in_any_unit_of_the_eigenvalues(unit: float) -> None:
    """One load of both where they differ by less than their eigenvalues; else that of the mean eigenvalue."""
    mu = unit * np.array([1 + 1e-6j, 1 - 1e-6j])
    for apart, at in ((1e-9, 2.0), (1e-6, 3.0)):
        roots: list[Crossing | None] = [
            Crossing(2 * (1 + side * apart / 2), 1.0, np.ones(1, complex), "flutter") for side in (-1, 1)
        ]
        (event,) = _told_apart(mu, roots, lambda _: 3.0, 1)
        assert event.crossing.load == pytest.approx(at, rel=1e-12) and not event.simple
