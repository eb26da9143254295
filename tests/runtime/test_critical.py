"""Critical loads against routes that share nothing with them: matrices by quadrature, scans in P, exact formulas."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterator
from fractions import Fraction
from functools import cache
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import freebeam as fb
from freebeam.maps.known import _refined, near
from freebeam.maps.surface import first_crossing
from freebeam.maps.verdict import digits_that_hold
from freebeam.proofs import enclosed_load
from freebeam_sym.checks import Unstable
from freebeam_sym.stability import critical
from freebeam_sym.stability.arnoldi import Krylov
from freebeam_sym.stability.critical import critical_load
from freebeam_sym.stability.crossings import _in_order, first_loss
from freebeam_sym.stability.crossings import scan as scan_for
from freebeam_sym.stability.equations import ROUNDING
from freebeam_sym.stability.pencil import Pencil, diagonalise
from freebeam_sym.stability.problem import NEAR, Crossing, Event
from freebeam_sym.stability.proportional import Proportional, _Operator
from tests.reference.dense import Case, answer, cases, disagreement

NAMES = ("free-free", "beck", "euler-pinned")


# --- an independent assembly: modes in decaying exponentials, Gauss-Legendre quadrature ----------------------------


def comparison_modes(free: bool, modes: int, x: np.ndarray, derivative: int) -> np.ndarray:
    """Free-free or clamped-free modes (scaled freely) or a derivative of them, shape (modes, x.size)."""
    sign = 1.0 if free else -1.0  # cos γ cosh γ = ±1
    g = (np.arange(1, modes + 1) + 0.5 * sign) * np.pi
    for _ in range(30):
        g = g - (np.cos(g) - sign / np.cosh(g)) / (-np.sin(g) + sign * np.tanh(g) / np.cosh(g))
    g = g[:, None]
    s, c, q = np.sin(g), np.cos(g), np.exp(-g)
    turn = derivative * np.pi / 2
    decay = (-1.0) ** derivative
    if free:
        sigma, tail = (c - np.cosh(g)) / (s + np.sinh(g)), (s + c - q) / (2 * q * s + 1 - q * q)
    else:
        sigma, tail = -(s + np.sinh(g)) / (c + np.cosh(g)), (s - c - q) / (2 * q * c + 1 + q * q)
    shape = np.sin(g * x + turn) + sigma * np.cos(g * x + turn) - sign * decay * np.exp(-g * x)
    shape += tail * (np.exp(-g * (1 - x)) + decay * np.exp(-g * (1 + x)))
    return shape * g**derivative


@cache
def matrices(name: str, modes: int, eta: float = 1.0) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """M, E, H of a column by quadrature of its energies."""
    if name == "euler-pinned":
        n = np.pi * np.arange(1, modes + 1)
        return np.eye(modes) / 2, np.diag(n**4) / 2, -np.diag(n**2) / 2
    x, weight = np.polynomial.legendre.leggauss(40 + 6 * modes)
    x, weight = (x + 1) / 2, weight / 2
    f, slope, curvature = (comparison_modes(name == "free-free", modes, x, d) for d in range(3))
    tip, tip_slope = (comparison_modes(name == "free-free", modes, np.ones(1), d)[:, 0] for d in range(2))
    axial = x if name == "free-free" else np.ones_like(x)
    H = -(slope * weight * axial) @ slope.T + eta * np.outer(tip, tip_slope)
    return (f * weight) @ f.T, (curvature * weight) @ curvature.T, H


@cache
def pencil(name: str, modes: int, eta: float = 1.0) -> Pencil:
    return Pencil(*matrices(name, modes, eta))


def growth(name: str, modes: int, eta: float, alpha: float, beta: float, loads: np.ndarray) -> np.ndarray:
    """Largest Re λ of the 2N eigenvalues at each load."""
    M, E, H = matrices(name, modes, eta)
    m = np.sqrt(np.diag(M))
    E, H = E / np.outer(m, m), H / np.outer(m, m)
    A = np.zeros((len(loads), 2 * modes, 2 * modes))
    A[:, :modes, modes:] = np.eye(modes)
    A[:, modes:, :modes] = -(E + loads[:, None, None] * H)
    A[:, modes:, modes:] = -(alpha * E + beta * np.eye(modes))
    return np.linalg.eigvals(A).real.max(axis=1)


def scan(name: str, modes: int, eta: float, alpha: float, beta: float, load_max: float) -> float | None:
    """First load with a growing eigenvalue, by steps and bisection."""
    loads = np.concatenate([np.linspace(0, load_max / 20, 300)[1:], np.linspace(load_max / 20, load_max, 900)])
    previous = 0.0
    for start in range(0, len(loads), 100):
        part = loads[start : start + 100]
        bad = growth(name, modes, eta, alpha, beta, part) > 0
        if bad.any():
            k = int(bad.argmax())
            low, high = (part[k - 1] if k else previous), part[k]
            for _ in range(45):
                middle = (low + high) / 2
                if growth(name, modes, eta, alpha, beta, np.array([middle]))[0] > 0:
                    high = middle
                else:
                    low = middle
            return float(high)
        previous = part[-1]
    return None


# --- first crossings ----------------------------------------------------------------------------------------


def log_uniform(low: float, high: float) -> st.SearchStrategy[float]:
    return st.floats(math.log(low), math.log(high)).map(math.exp)


@settings(max_examples=120, deadline=None, derandomize=True)
@given(
    name=st.sampled_from(NAMES),
    modes=st.integers(1, 12),
    eta=st.floats(0.0, 1.2),
    alpha=st.one_of(st.just(0.0), log_uniform(1e-6, 10.0)),
    beta=st.one_of(st.just(0.0), log_uniform(1e-3, 1000.0)),
)
def test_first_crossing_agrees_with_a_scan(name: str, modes: int, eta: float, alpha: float, beta: float) -> None:
    if alpha == beta == 0:
        alpha = 1e-3
    eta = eta if name == "beck" else 1.0
    found = first_crossing(pencil(name, modes, eta), alpha, beta, 400.0)
    expected = scan(name, modes, eta, alpha, beta, 400.0)
    if expected is None:
        assert found is None
    else:
        assert found is not None and found.load == pytest.approx(expected, rel=1e-6)


@settings(max_examples=70, deadline=None, derandomize=True)
@given(data=st.data(), modes=st.integers(2, 6), seed=st.integers(0, 10**6))
def test_first_crossing_of_any_matrices(data: st.DataObject, modes: int, seed: int) -> None:
    """H without symmetry, of rank one or full: flutter of weakly coupled modes over a short interval of loads too."""
    rng = np.random.default_rng(seed)
    e = np.sort(10 ** rng.uniform(0, 2, modes))
    H = rng.normal(size=(modes, modes)) * np.sqrt(np.outer(e, e))
    if data.draw(st.booleans()):
        H = np.outer(rng.normal(size=modes), rng.normal(size=modes))
    alpha, beta = data.draw(log_uniform(1e-5, 1.0)), data.draw(log_uniform(1e-3, 10.0))
    root = np.sqrt(np.outer(e, e))
    load_max = 20 / np.linalg.norm(H / root, 2)
    any_pencil = Pencil(np.eye(modes), np.diag(e), H)
    found = first_crossing(any_pencil, alpha, beta, load_max)
    problem = Proportional(any_pencil, alpha, beta)
    grows = [load for load in np.linspace(0, load_max, 501)[1:] if problem.unstable(load)]
    if found is None:
        assert not grows
    else:
        assert not grows or found.load <= grows[0] * (1 + 1e-9)
        assert problem.unstable(found.load * (1 + 1e-6)) > 0


@settings(max_examples=60, deadline=None, derandomize=True)
@given(
    name=st.sampled_from(NAMES[:2]),
    modes=st.integers(2, 12),
    alpha=st.one_of(st.just(0.0), log_uniform(1e-12, 10.0)),
    beta=st.one_of(st.just(0.0), log_uniform(1e-3, 1000.0)),
)
def test_the_crossing_is_an_eigenvalue_on_the_axis(name: str, modes: int, alpha: float, beta: float) -> None:
    """(K − ω² M + iω C) q̂ = 0 at the load found, for the vector found."""
    alpha = alpha if alpha or beta else 1e-12
    M, E, H = matrices(name, modes)
    found = first_crossing(pencil(name, modes), alpha, beta, 1000.0)
    if found is None:
        return
    terms = [
        (E + found.load * H) @ found.vector,
        -(found.frequency**2) * M @ found.vector,
        1j * found.frequency * (alpha * E + beta * M) @ found.vector,
    ]
    size = np.sqrt(np.diag(M)) * sum(np.abs(t / np.sqrt(np.diag(M))).max() for t in terms)
    assert np.abs(sum(terms) / size).max() < 1e-11


# --- values known otherwise ---------------------------------------------------------------------------------


def test_a_bubble_of_flutter_between_rungs_is_not_stepped_over() -> None:
    """Two branches that cross with a coupling so weak that flutter lasts for a thousandth of the load."""
    e, coupling = np.array([1.0, 4.0, 30.0]), 1e-3
    H = np.array([[1.0, coupling, 0.0], [-coupling, -0.5, 0.0], [0.0, 0.0, -1.0]])
    found = first_crossing(Pencil(np.eye(3), np.diag(e), H), load_max=7.0)
    # the gap of the pair: (3 − 1.5 P)² = 4 coupling² P²
    assert found is not None and found.kind == "flutter"
    assert found.load == pytest.approx(3 / (1.5 + 2 * coupling), rel=1e-12)


def test_paper_scan_steps_at_eight_modes() -> None:
    """The printed loads are the first scan step at or above the value."""
    p = pencil("free-free", 8)

    def step_above(load: float, step: float) -> float:
        return math.ceil(load / step) * step

    undamped, light = first_crossing(p), first_crossing(p, 1e-6)
    both = first_crossing(p, 1e-3, 0.1)
    assert undamped is not None and light is not None and both is not None
    assert step_above(undamped.load, 0.01) == pytest.approx(109.73)
    assert step_above(undamped.load, 0.1) == pytest.approx(109.8)
    assert step_above(light.load, 0.1) == pytest.approx(88.2)
    assert step_above(both.load, 0.1) == pytest.approx(90.9)


@pytest.mark.parametrize("modes", [1, 3, 8])
def test_euler_load_of_the_pinned_column_is_pi_squared(modes: int) -> None:
    for alpha, beta in [(0.0, 0.0), (1e-3, 0.1), (10.0, 1000.0)]:
        found = first_crossing(pencil("euler-pinned", modes), alpha, beta)
        assert found is not None and found.kind == "divergence"
        assert found.load == pytest.approx(math.pi**2, rel=1e-13)


def test_dead_load_on_the_cantilever_tends_to_a_quarter_pi_squared_from_above() -> None:
    """A conservative column: the Ritz series bounds the load from above and converges."""
    loads = [found.load for n in (2, 4, 8, 16, 32) if (found := first_crossing(pencil("beck", n, 0.0)))]
    errors = np.array(loads) / (math.pi**2 / 4) - 1
    assert (errors > 0).all() and (errors[1:] < 0.6 * errors[:-1]).all() and errors[-1] < 3e-5


def test_the_follower_share_of_one_half_parts_divergence_from_flutter() -> None:
    """Divergence below a share that tends to ½ with N, flutter above it."""

    def change_of_kind(modes: int) -> float:
        low, high = 0.4, 0.6
        while high - low > 1e-6:
            middle = (low + high) / 2
            found = first_crossing(Pencil(*matrices.__wrapped__("beck", modes, middle)), 0.0, 0.0, 60.0)
            assert found is not None
            low, high = (middle, high) if found.kind == "divergence" else (low, middle)
        return low

    off = [abs(change_of_kind(n) - 0.5) for n in (4, 8, 16)]
    assert off[0] < 0.03 and off[1] < 0.6 * off[0] and off[2] < 0.6 * off[1]


def test_divergence_roots_of_the_free_beam_are_artefacts_that_wander_with_modes() -> None:
    loads = [pencil("free-free", n).divergences[0].crossing.load for n in (1, 3, 8)]
    for n, load in zip((1, 3, 8), loads, strict=True):
        _, E, H = matrices("free-free", n)
        assert abs(np.linalg.det(np.linalg.solve(E, E + load * H))) < 1e-9
    assert loads[1] > 4 * loads[0] and loads[2] > 4 * loads[1]


def test_the_first_crossing_of_becks_column_jumps_between_frequencies() -> None:
    """Internal damping 1.05 to 1.1: another crossing of the same branch comes first, which no continuation sees."""
    before, after = (first_crossing(pencil("beck", 8), alpha) for alpha in (1.05, 1.1))
    assert before is not None and after is not None
    assert before.frequency > 10 * after.frequency
    for alpha, found in ((1.05, before), (1.1, after), (10.0, first_crossing(pencil("beck", 8), 10.0))):
        assert found is not None and found.load == pytest.approx(scan("beck", 8, 1.0, alpha, 0.0, 400.0), rel=1e-8)


def test_restabilisation_is_not_taken_for_stability() -> None:
    """The free beam is stable again above 406 (N = 8, undamped): the first loss is still the coalescence."""
    p = pencil("free-free", 8)
    assert Proportional(p).unstable(400.0) > 0
    found = first_crossing(p, 0.0, 0.0, 420.0)
    assert found is not None and found.load < 110


# --- limits of vanishing damping ----------------------------------------------------------------------------


@pytest.mark.parametrize("name", NAMES[:2])
@pytest.mark.parametrize("kappa", [0.0, 3.0, 500.0])
def test_small_damping_tends_to_its_limit_with_the_square(name: str, kappa: float) -> None:
    p = pencil(name, 8)
    limit = first_crossing(p, kappa=kappa)
    assert limit is not None
    off = []
    for alpha in (4e-5, 2e-5, 1e-12):
        found = first_crossing(p, alpha, kappa * alpha)
        assert found is not None
        off.append(found.load / limit.load - 1)
    assert off[0] / off[1] == pytest.approx(4, rel=1e-2)
    assert abs(off[2]) < 1e-12


@pytest.mark.parametrize("name", NAMES[:2])
def test_tangent_rule_and_coalescence(name: str) -> None:
    """The limit κ = 0 is where d ln s/d ln P = 1, by finite differences; κ = ∞ is where two s meet."""
    M, E, H = matrices(name, 8)

    def squares(load: float) -> np.ndarray:
        return np.sort(np.linalg.eigvals(np.linalg.solve(M, E + load * H)).real)

    tangent, fold = (first_crossing(pencil(name, 8), kappa=k) for k in (0.0, math.inf))
    undamped = first_crossing(pencil(name, 8))
    assert tangent is not None and fold is not None and undamped is not None
    j = int(np.abs(squares(tangent.load) - tangent.frequency**2).argmin())
    h = 1e-4 * tangent.load
    slope = (squares(tangent.load + h)[j] - squares(tangent.load - h)[j]) / (2 * h)
    assert tangent.load * slope == pytest.approx(tangent.frequency**2, rel=1e-5)
    assert fold.load == pytest.approx(undamped.load, rel=1e-13)
    below = squares(fold.load * (1 - 1e-8))
    assert np.abs(below[:2] - fold.frequency**2).max() < 1e-3 * fold.frequency**2
    assert np.abs(np.linalg.eigvals(np.linalg.solve(M, E + fold.load * (1 + 1e-8) * H)).imag).max() > 0


def test_limits_join_internal_and_external_damping() -> None:
    """The limit grows with κ from the tangent point to the coalescence."""
    p = pencil("free-free", 8)
    loads = [found.load for k in (0.0, 1.0, 1e2, 1e4, 1e6, math.inf) if (found := first_crossing(p, kappa=k))]
    assert len(loads) == 6 and (np.diff(loads) > 0).all()
    assert loads[-2] == pytest.approx(loads[-1], rel=1e-4)


# --- the front door -----------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize(("alpha", "beta"), [(0.0, 0.0), (1e-3, 0.1), (10.0, 0.0), (1e-3, 1000.0)])
def test_emitted_kernels_give_the_load_of_the_quadrature(name: str, alpha: float, beta: float) -> None:
    found = fb.critical_load(fb.column(name, "modes"), 8, alpha, beta)
    other = first_crossing(pencil(name, 8), alpha, beta)
    assert other is not None and found.kind == other.kind
    assert found.load == pytest.approx(other.load, rel=1e-11)
    assert found.frequency == pytest.approx(other.frequency, rel=1e-10)


def test_another_basis_gives_the_same_load() -> None:
    """Any independent combination of the modes: E and M are then full."""
    rng = np.random.default_rng(3)
    T = np.linalg.qr(rng.normal(size=(8, 8)))[0] + 0.1 * rng.normal(size=(8, 8))
    for alpha, beta in [(0.0, 0.0), (1e-3, 0.1), (1.0, 0.0)]:
        M, E, H = matrices("beck", 8)
        mixed = first_crossing(Pencil(T.T @ M @ T, T.T @ E @ T, T.T @ H @ T), alpha, beta)
        plain = first_crossing(pencil("beck", 8), alpha, beta)
        assert mixed is not None and plain is not None
        assert mixed.load == pytest.approx(plain.load, rel=1e-10)
        vector = T @ mixed.vector
        assert np.abs(vector / vector[np.abs(vector).argmax()] - plain.vector).max() < 1e-8


def test_verdict_on_convergence() -> None:
    beck = fb.column("beck", "modes")
    assert fb.critical_load(fb.column("free-free", "modes")).converged
    one = fb.critical_load(fb.column("free-free", "modes"), 1)  # divergence at one mode
    assert one.kind == "divergence" and one.beam.kind == "flutter" and not one.converged
    artefact = fb.critical_load(beck, 8, 10.0)  # of the truncation: the beam has none
    assert artefact.kind == "flutter" and artefact.beam.kind == "none" and artefact.error is None
    assert not artefact.converged
    none = fb.critical_load(beck, 8, load_max=5.0)
    assert (none.load, none.kind, none.frequency, none.mode, none.error) == (None, "none", None, None, None)
    assert none.converged and none.beam.kind == "none"


def test_a_load_that_a_longer_series_does_not_have_is_not_converged(monkeypatch: pytest.MonkeyPatch) -> None:
    """As of an absorber close to the tip, where rounding makes a motion of the short segment grow at N = 24."""
    found = fb.critical_load(fb.column("beck"), 8)

    def grows(*_: object) -> None:
        raise Unstable("something grows at the smallest loads")

    monkeypatch.setattr(critical, "answer", grows)
    assert found.beam is None and found.error is None and not found.converged


def test_many_modes_that_change_little_are_not_converged() -> None:
    """Next to η = 1/2 the modes still diverge where the beam flutters."""
    found = fb.critical_load(fb.column("beck", "modes"), 64, eta=0.50001)
    assert found.kind == "divergence" and found.beam.kind == "flutter" and not found.converged
    assert found.error == pytest.approx(1 - found.load / 16.0524615771634, rel=1e-3)


@settings(max_examples=60, deadline=None, derandomize=True)
@given(
    name=st.sampled_from(["beck", "beck", "free-free"]),
    basis=st.sampled_from(["modes", "legendre"]),
    modes=st.integers(3, 24),
    eta=st.floats(0.0, 1.5).map(lambda x: round(x, 3)),
    damping=st.one_of(
        st.just((0.0, 0.0)), st.tuples(log_uniform(1e-6, 1e-1), st.one_of(st.just(0.0), log_uniform(1e-2, 10.0)))
    ),
)
def test_the_error_bounds_the_true_one_and_is_near_it(
    name: str, basis: str, modes: int, eta: float, damping: tuple[float, float]
) -> None:
    """The true one by the exact beam in balls, where that can be enclosed near the beam's load of the same kind."""
    own = {"eta": eta} if name == "beck" else {}
    alpha, beta = damping
    found = fb.critical_load(fb.column(name, basis), modes, alpha, beta, **own)
    if found.error is None or found.beam is None or found.beam.kind != found.kind:
        return
    try:
        exact = enclosed_load(fb.column(name, "legendre"), alpha, beta, digits=25, **own)
    except fb.InputError:
        return
    assert exact.kind == found.kind and exact.load is not None and found.load is not None
    true = abs(float(Fraction(found.load) / Fraction(exact.load[0]) - 1))
    assert true <= found.error < max(100 * true, 1e-12)


@pytest.mark.parametrize("alpha", [1e-12, 5e-9, 2e-8, 3e-8, 1e-7])
def test_internal_damping_that_is_heavy_for_high_modes_alone_has_the_load_of_its_limit(alpha: float) -> None:
    """A stepped column with a mass inside: damping of the lowest mode from 1e-11 to 1e-6, of the highest far above."""
    column, own = fb.column("step"), {"s": 0.746, "r": 0.89, "mu": 1.612, "a": 0.667}
    limit, found = fb.critical_load(column, 10, kappa=0.0, **own), fb.critical_load(column, 10, alpha=alpha, **own)
    assert found.load == pytest.approx(limit.load, rel=1e-10) and found.frequency == pytest.approx(limit.frequency)


@pytest.mark.parametrize("apart", [-1e-5, -1e-8, 1e-8, 1e-5])
def test_two_motions_that_lose_stability_at_nearly_one_load_have_each_its_own(apart: float) -> None:
    """About an η at which two branches have one load, far apart in frequency: the lower load to all digits, and its."""
    column = fb.column("beck", "modes")
    eta = 0.9792844460 + apart
    found, proven = fb.critical_load(column, 6, alpha=1.0, eta=eta), fb.certified_load(column, 6, alpha=1.0, eta=eta)
    assert proven.load is not None and proven.frequency is not None
    assert found.load == pytest.approx(float(proven.load[0]), rel=1e-11)
    assert found.frequency == pytest.approx(float(proven.frequency[0]), rel=1e-9)


# --- touches --------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("modes", [10, 12, 16, 24, 40])
@pytest.mark.parametrize(("alpha", "beta", "kappa"), [(0, 0, None), (0, 0.1, None), (1e-4, 1.0, None), (0, 0, 1e4)])
def test_a_touch_is_no_loss_of_stability(modes: int, alpha: float, beta: float, kappa: float | None) -> None:
    """η = 1/2: det K has a double root at π² and ω² touches zero; flutter comes at 16.05 or beyond."""
    p = Pencil(*fb.column("beck", "legendre").matrices(modes, eta=0.5))
    found = first_loss(Proportional(p, alpha, beta, kappa))
    assert found.crossing is not None and found.crossing.kind == "flutter"
    assert found.crossing.load > 16.05 * (1 - 1e-5)
    assert [touch.load for touch in found.touches] == pytest.approx([math.pi**2], rel=1e-12)


@pytest.mark.parametrize("alpha", [1e-12, 1e-6, 1e-3, 1.0])
def test_internal_damping_alone_makes_the_touch_a_flutter(alpha: float) -> None:
    """With s = a (P − π²)² near the touch, P s′ − s changes its sign there: what grows beyond it starts at λ = 0."""
    p = Pencil(*fb.column("beck", "legendre").matrices(16, eta=0.5))
    found = first_crossing(p, alpha)
    assert found is not None and (found.kind, found.frequency) == ("flutter", 0.0)
    assert found.load == pytest.approx(math.pi**2, rel=1e-12)
    assert not Proportional(p, alpha, 0.0).unstable(found.load * (1 - 1e-3))
    assert Proportional(p, alpha, 0.0).unstable(found.load * (1 + 1e-3))


@pytest.mark.parametrize("modes", range(8, 18))
def test_what_begins_at_a_touch_is_called_alike_whatever_rounding_puts_first(modes: int) -> None:
    """At η = 1/2 the touch of λ = 0 and the flutter that internal damping makes of it stand at one load."""
    found = fb.critical_load(fb.column("beck", "legendre"), modes, 1e-3, eta=0.5)
    assert (found.kind, found.frequency, found.touches) == ("flutter", 0.0, ())


@pytest.mark.parametrize("side", [1e-3, 1e-6, 1e-9])
def test_next_to_a_touch_divergence_and_flutter_are_told_apart(side: float) -> None:
    """For η < 1/2 divergence at arccos²(−η/(1 − η)); for η > 1/2 none."""
    eta = 0.5 - side
    below = first_loss(Proportional(Pencil(*fb.column("beck", "legendre").matrices(16, eta=eta))))
    load = math.acos(-eta / (1 - eta)) ** 2
    assert below.crossing is not None and below.crossing.kind == "divergence" and not below.touches
    assert below.crossing.load == pytest.approx(load, rel=1e-14 / math.sqrt(side))
    above = first_loss(Proportional(Pencil(*fb.column("beck", "legendre").matrices(16, eta=0.5 + side))))
    assert above.crossing is not None and above.crossing.kind == "flutter" and not above.touches


def test_two_equal_columns_flutter_together_or_are_refused() -> None:
    """Side by side, coupled by nothing: every load is double, and stability is lost there."""
    one = np.array([[1.0, 0.6], [-0.6, -0.5]])
    twice = Pencil(np.eye(4), np.diag([1.0, 4.0, 1.0, 4.0]), np.kron(np.eye(2), one))
    alone = first_crossing(Pencil(np.eye(2), np.diag([1.0, 4.0]), one), 0.01, 0.02)
    both = first_loss(Proportional(twice, 0.01, 0.02))
    assert alone is not None and both.crossing is not None and not both.touches
    assert both.crossing.load == pytest.approx(alone.load, rel=1e-7)
    with pytest.raises(fb.InputError, match="one frequency"):
        first_crossing(twice)


@pytest.mark.parametrize(("alpha", "beta", "kappa"), [(0, 0, None), (0, 0, 3.0), (1e-9, 0, None), (0.01, 0.5, None)])
@pytest.mark.parametrize("name", ["free-free", "beck", "euler-pinned"])
def test_the_last_resort_finds_the_same_loads(name: str, alpha: float, beta: float, kappa: float | None) -> None:
    """Counts at equal steps and bisection, from where nothing grows to where something does."""
    problem = Proportional(pencil(name, 6), alpha, beta, kappa)
    found = first_loss(problem).crossing
    assert found is not None
    plain = scan_for(problem, 0.0, 1.05 * found.load)
    assert (plain.kind, plain.load) == (found.kind, pytest.approx(found.load, rel=1e-9))
    assert plain.frequency == pytest.approx(found.frequency, rel=1e-6, abs=1e-6)


def test_branches_that_cross_and_do_not_meet_are_no_flutter() -> None:
    """Two modes without coupling: their squared frequencies agree at one load, and nothing grows."""
    crossing = Pencil(np.eye(3), np.diag([1.0, 4.0, 30.0]), np.array([[1.0, 0, 0], [0, -0.5, 0], [0, 0.1, -1.0]]))
    for alpha, beta in ((0.0, 0.0), (0.0, 0.1)):
        found = first_loss(Proportional(crossing, alpha, beta), 7.0)
        assert found.crossing is None
        assert alpha or beta or [touch.load for touch in found.touches] == pytest.approx([2.0], rel=1e-6)


@pytest.mark.parametrize("ahead", [1e-5, 5e-4, 2e-3])
def test_flutter_soon_after_branches_that_cross_is_told_from_them(ahead: float) -> None:
    """s of 1 and 4 without coupling are equal at the load 1; s of 9 and 12 meet a little above it."""
    turn = 1.5 / (1 + ahead)
    H = np.array([[3.0, 0, 0, 0], [0, 0, 0, 0], [0, 0, 0, turn], [0, 0, -turn, 0]])
    found = first_loss(Proportional(Pencil(np.eye(4), np.diag([1.0, 4.0, 9.0, 12.0]), H)), 3.0)
    assert found.crossing is not None and found.crossing.load == pytest.approx(1 + ahead, rel=1e-9)
    (touch,) = found.touches
    assert touch.load == pytest.approx(1.0, rel=1e-6)
    assert math.isnan(touch.frequency) or touch.frequency == pytest.approx(2.0, rel=1e-3)


@dataclasses.dataclass(frozen=True)
class Missed:
    """A problem that is unstable from a load on, of which its searches find nothing."""

    load: float
    divergences: tuple[Event, ...] = ()

    def flutters(self, bound: float) -> Iterator[Event]:
        return iter(())

    def unstable(self, load: float) -> int:
        return int(load >= self.load)

    def onset(self, load: float) -> Crossing:
        return Crossing(load, 1.0, np.ones(1, complex), "flutter")


@pytest.mark.parametrize("load", [0.3, 2.0, 4.99])
def test_a_crossing_that_the_search_missed_is_not_passed_over(load: float) -> None:
    found = first_loss(Missed(load), 5.0).crossing
    assert found is not None and found.load == pytest.approx(load, rel=1e-12)
    assert first_loss(Missed(load), 0.9 * load).crossing is None


@dataclasses.dataclass(frozen=True)
class Listed(Missed):
    """The same, with flutters of its own."""

    own: tuple[float, ...] = ()

    def flutters(self, bound: float) -> Iterator[Event]:
        return (event(load, "flutter") for load in self.own if load < bound)


def event(load: float, kind: str, simple: bool = True) -> Event:
    return Event(Crossing(load, float(kind == "flutter"), np.ones(1, complex), kind), simple)


@settings(max_examples=100, deadline=None, derandomize=True)
@given(
    buckles=st.lists(st.tuples(st.floats(0.1, 9.0), st.booleans()), max_size=4),
    flutters=st.lists(st.floats(0.1, 9.0), max_size=4),
)
def test_what_may_end_stability_is_taken_in_the_order_of_loads(
    buckles: list[tuple[float, bool]], flutters: list[float]
) -> None:
    """Up to the first simple divergence, beyond which nothing can be the first."""
    divergences = tuple(event(load, "divergence", simple) for load, simple in sorted(buckles))
    loads = [e.crossing.load for e in _in_order(Listed(10.0, divergences, tuple(sorted(flutters))), 10.0)]
    assert all(a <= b * (1 + 2 * NEAR) for a, b in pairwise(loads))
    last = min((load for load, simple in buckles if simple), default=10.0)
    assert {load for load in (*flutters, *(load for load, _ in buckles)) if load < last} <= set(loads)


@pytest.mark.parametrize("share", [1 + 1e-6, 1.05, 1.5])
def test_what_grows_at_a_load_is_not_given_another_load(share: float) -> None:
    """What begins to grow close by is that crossing; further away Newton's method would name one that it is not."""
    problem = Proportional(pencil("free-free", 8), 1e-3, 0.1)
    first = first_loss(problem).crossing
    assert first is not None
    found = problem.onset(share * first.load)
    assert found.load == pytest.approx(first.load if share < 1.001 else share * first.load, rel=1e-9)
    assert found.kind == "flutter"


@pytest.mark.parametrize("kappa", [None, 0.0, 1.0, math.inf])
@pytest.mark.parametrize("eta", [0.06, 0.25])
def test_what_grows_beyond_a_divergence_is_told_as_one_where_damping_vanishes(eta: float, kappa: float | None) -> None:
    problem = Proportional(pencil("beck", 10, eta), kappa=kappa)
    first = first_loss(problem).crossing
    assert first is not None and first.kind == "divergence"
    for beyond in (1e-12, 1e-9, 1e-6):
        found = problem.onset(first.load * (1 + beyond))
        assert (found.kind, found.frequency) == ("divergence", 0.0)
        assert found.load == pytest.approx(first.load, rel=2 * beyond)


@settings(max_examples=40, deadline=None, derandomize=True)
@given(
    name=st.sampled_from(NAMES[:2]),
    stiff=log_uniform(1e-9, 1e9),
    force=log_uniform(1e-6, 1e6),
    alpha=st.one_of(st.just(0.0), log_uniform(1e-9, 1e-2)),
)
def test_units_of_stiffness_and_load_do_not_matter(name: str, stiff: float, force: float, alpha: float) -> None:
    """E by c and H by c/d: loads by d, frequencies by √c, internal damping by 1/√c, in the search and in its parts."""
    M, E, H = matrices(name, 6)
    plain = Proportional(pencil(name, 6), alpha, 0.0, None if alpha else 0.0)
    other = Proportional(Pencil(M, stiff * E, stiff / force * H), alpha / math.sqrt(stiff), 0.0, plain.kappa)
    one, two = first_loss(plain).crossing, first_loss(other, 1000 * force).crossing
    assert one is not None and two is not None
    again = near(other, two.load, two.frequency, np.linalg.solve(other.pencil.basis, two.vector))
    beyond = other.onset(two.load * (1 + 1e-9))
    for found in (two, again, beyond):
        assert found is not None and found.kind == one.kind
        assert found.load == pytest.approx(force * one.load, rel=2e-9)
        assert found.frequency == pytest.approx(math.sqrt(stiff) * one.frequency, rel=1e-8)


@pytest.mark.parametrize("seed", [0, 1, 3, 4, 7, 9])
@pytest.mark.parametrize(("alpha", "beta"), [(0.0, 0.0), (1e-3, 0.1), (0.3, 0.0), (0.0, 2.0)])
def test_rounding_is_what_a_change_of_the_matrices_does(seed: int, alpha: float, beta: float) -> None:
    """Matrices changed at random by δ of their norm: the load moves by no more, and in some direction by nearly that.
    δ P H stands for any change of E + P H."""
    rng, p = np.random.default_rng(seed), sample(seed, 4)
    problem = Proportional(p, alpha, beta)
    found = first_loss(problem, 1e6).crossing
    assert found is not None and found.kind == "flutter"
    delta = 1e-7
    most = problem.rounding(found) / ROUNDING * delta
    root, moved = np.sqrt(np.outer(p.e, p.e)), []
    for _ in range(200):
        g = rng.normal(size=(4, 4))
        g *= delta * (1 + found.load * p.norm) / np.linalg.norm(g) / found.load
        changed = Proportional(Pencil(np.eye(4), np.diag(p.e), p.H + root * g), alpha, beta)
        again = near(changed, found.load, found.frequency, np.linalg.solve(p.basis, found.vector))
        if again is not None:
            moved.append(abs(again.load / found.load - 1))
    assert len(moved) > 100
    assert 0.5 * most < max(moved) < 1.05 * most


@settings(max_examples=60, deadline=None, derandomize=True)
@given(
    name=st.sampled_from(NAMES[:2]),
    modes=st.integers(2, 12),
    alpha=log_uniform(1e-6, 10.0),
    beta=log_uniform(0.01, 1e3),
)
def test_newtons_method_starts_from_the_eigenvector_itself(name: str, modes: int, alpha: float, beta: float) -> None:
    """The frequency that is read from an eigenvector of T is the flutter's, however strong the damping."""
    problem, starts = Proportional(pencil(name, modes), alpha, beta), []

    def recorded(problem: Proportional, w: float, P: float, a: np.ndarray, b: np.ndarray) -> Crossing | None:
        found = newton(problem, w, P, a, b)
        if found is not None and abs(found.load / P - 1) < 1e-6:
            starts.append((w, found.frequency**2))
        return found

    newton = Proportional.newton
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Proportional, "newton", recorded)
        found = next(iter(problem.flutters(1000.0)), None)
    if found is not None and found.crossing.frequency > 0.01:
        assert starts and min(abs(start / end - 1) for start, end in starts) < 1e-4


@settings(max_examples=40, deadline=None, derandomize=True)
@given(name=st.sampled_from(NAMES[:2]), modes=st.integers(3, 12), alpha=log_uniform(1e-9, 1.0), off=st.floats(-1, 1))
def test_a_flutter_of_the_surface_is_confirmed_where_it_is_and_nowhere_else(
    name: str, modes: int, alpha: float, off: float
) -> None:
    problem = Proportional(pencil(name, modes), alpha, 0.0)
    found = first_loss(problem).crossing
    if found is None or found.kind != "flutter":
        return
    again = _refined(problem, found.load * (1 + 1e-10 * off), found.frequency * (1 + 1e-10 * off))
    assert again is not None and again.load == pytest.approx(found.load, rel=1e-10)
    assert _refined(problem, found.load * 1.001, found.frequency) is None


@settings(max_examples=100, deadline=None, derandomize=True)
@given(m=st.lists(log_uniform(1e-3, 1e3), min_size=1, max_size=6), seed=st.integers(0, 10**6), full=st.booleans())
def test_squared_frequencies_ascend_whatever_the_functions_order(m: list[float], seed: int, full: bool) -> None:
    rng, n = np.random.default_rng(seed), len(m)
    T = np.eye(n) + full * 0.3 * rng.normal(size=(n, n)) / n
    M, E = T.T @ np.diag(m) @ T, T.T @ np.diag(np.array(m) * 10 ** rng.uniform(-2, 2, n)) @ T
    e, B = diagonalise(M, E)
    assert (np.diff(e) >= 0).all()
    for matrix, wanted in ((M, np.eye(n)), (E, np.diag(e))):
        got = B.T @ matrix @ B
        assert np.abs(got - wanted).max() < 1e-9 * np.abs(wanted).max()


@settings(max_examples=200, deadline=None, derandomize=True)
@given(value=log_uniform(1e-3, 1e3), error=log_uniform(1e-17, 10.0))
def test_digits_that_are_printed_hold(value: float, error: float) -> None:
    """What is printed is off by no more than half of a last digit that the error leaves, and has ten digits at most."""
    text = digits_that_hold(value, error)
    digits = len(text.replace(".", "").lstrip("0").split("e")[0])
    assert 1 <= digits <= 10 and abs(float(text) - value) <= 0.5 * 10.0 ** (1 - digits) * value
    assert error > 0.1 or digits == 1 or 10.0**-digits >= error * (1 - 1e-12)


def test_a_load_max_just_below_finds_nothing_and_just_above_finds_it() -> None:
    for name in NAMES:
        column = fb.column(name, "modes")
        load = critical_load(column, 6, 1e-3, 0.1).load
        assert load is not None
        for share in (1e-9, 1e-6, 1e-4, 1e-2):
            assert critical_load(column, 6, 1e-3, 0.1, load_max=load * (1 - share)).kind == "none"
            above = critical_load(column, 6, 1e-3, 0.1, load_max=load * (1 + share))
            assert above.load == pytest.approx(load, rel=1e-12)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"alpha": -0.1}, "alpha"),
        ({"beta": math.nan}, "beta"),
        ({"load_max": 0.0}, "load_max"),
        ({"kappa": -1.0}, "kappa"),
        ({"kappa": 1.0, "alpha": 1e-3}, "kappa"),
        ({"modes": 0}, "modes"),
        ({"alpha": 1e200}, "alpha"),
        ({"zeta": 1.0}, "zeta"),
    ],
)
def test_bad_input_is_refused_by_name(arguments: dict[str, float], words: str) -> None:
    with pytest.raises(fb.InputError, match=words):
        fb.critical_load(fb.column("beck", "modes"), **arguments)


def test_a_column_unstable_without_load_is_refused() -> None:
    with pytest.raises(fb.InputError, match="load 0"):
        Pencil(np.eye(2), np.diag([-1.0, 2.0]), np.eye(2))
    with pytest.raises(fb.InputError, match="independent"):
        Pencil(np.ones((2, 2)), np.eye(2), np.eye(2))


# --- the operator -------------------------------------------------------------------------------------------


def sample(seed: int, size: int) -> Pencil:
    """A pencil of a load that is not conservative."""
    rng = np.random.default_rng(seed)
    e = np.sort(10 ** rng.uniform(0, 3, size))
    return Pencil(np.eye(size), np.diag(e), np.sqrt(np.outer(e, e)) * rng.normal(size=(size, size)))


@pytest.mark.parametrize(("seed", "size"), [(0, 2), (1, 3), (2, 4), (3, 5)])
@pytest.mark.parametrize(("alpha", "beta"), [(0.3, 0.0), (0.0, 2.0), (0.01, 0.5)])
def test_at_every_eigenvalue_of_the_operator_two_eigenvalues_add_up_to_zero(
    seed: int, size: int, alpha: float, beta: float
) -> None:
    """At complex loads too, and all N (N − 1) are there."""
    p = sample(seed, size)
    damping = Proportional(p, alpha, beta)
    operator = _Operator(damping)
    mu = np.linalg.eigvals(np.stack([operator(unit) for unit in np.eye(operator.order)], axis=1))
    assert len(mu) == size * (size - 1)
    for load in 1 / mu[np.abs(mu) > 1e-8 * np.abs(mu).max()]:
        K, C = np.diag(p.e) + load * p.H, np.diag(damping.size * damping.shape)
        values = np.linalg.eigvals(np.block([[np.zeros((size, size)), np.eye(size)], [-K, -C]]))
        sums = np.abs(values[:, None] + values)[np.triu_indices(2 * size, 1)]
        assert sums.min() < 1e-6 * np.abs(values).max()


@pytest.mark.parametrize("floor", [0.1, 0.5])
def test_arnoldis_method_finds_all_eigenvalues_of_greater_modulus(floor: float) -> None:
    rng = np.random.default_rng(7)
    A = rng.normal(size=(60, 60)) / math.sqrt(60)
    dense = np.linalg.eigvals(A)
    found, vectors = Krylov(lambda z: A @ z, 60).values(floor, math.inf)
    real = dense.real[(dense.imag == 0) & (dense.real > floor)]
    wanted = dense[(np.abs(dense) >= max(real.max(initial=0.0), floor)) & (dense.real > floor)]
    assert all(np.abs(found - value).min() < 1e-7 for value in wanted)
    for value, vector in zip(found, vectors, strict=True):
        assert np.linalg.norm(A @ vector - value * vector) < 1e-7 * np.linalg.norm(vector)


def test_random_questions_against_dense_eigenvalues_and_roots_at_200_bits() -> None:
    """Every column, both bases, N to 24, all damping and its limits, many next to the touch at η = 1/2. More of them:
    python -m tests.reference.dense 1000 1."""
    wrong = [(case, why) for case in cases(70, 3, most=24) if (why := disagreement(case, answer(case))) is not None]
    assert not wrong


@pytest.mark.parametrize(
    "case", [Case("beck", "legendre", 8, {}, 1e-3, 0.1, None), Case("beck", "modes", 6, {}, 0, 0, 0.0)]
)
def test_the_reference_sees_wrong_answers(case: Case) -> None:
    found = answer(case)
    assert disagreement(case, found) is None
    off = disagreement(case, dataclasses.replace(found, load=found.load * (1 + 3e-8)))
    later = disagreement(case, dataclasses.replace(found, load=found.load * 1.5))
    none = disagreement(case, dataclasses.replace(found, load=None, frequency=None, mode=None, kind="none"))
    assert off is not None and off[0] == "load off"
    assert later is not None and none is not None and later[0] == none[0] == "grows below"
