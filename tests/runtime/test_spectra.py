"""Spectra and branches: Eqs. (23)-(26), block triangularity with rigid functions, continuity along the load."""

from __future__ import annotations

import math
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import freebeam as fb
from freebeam.loci import branches
from freebeam_sym.spectra import spectrum, state_matrix

NAMES = ("free-free", "beck", "euler-pinned")
DAMPINGS = [(0.0, 0.0), (1e-3, 0.1), (1e-6, 0.0), (0.1, 0.0), (10.0, 0.0), (0.0, 30.0), (1e-3, 900.0)]


def distance_of_sets(a: np.ndarray, b: np.ndarray) -> float:
    """Largest distance of a value of one set from the nearest of the other."""
    gap = np.abs(a[:, None] - b)
    return float(max(gap.min(axis=0).max(), gap.min(axis=1).max()))


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize(("alpha", "beta"), DAMPINGS)
def test_eigenpairs_solve_the_quadratic_problem(name: str, alpha: float, beta: float) -> None:
    """(λ² M + λ C + K) q̂ = 0, Eq. (24) in Eq. (10), for every pair."""
    system = fb.column(name, "modes").system(modes=8, load=30.0, alpha=alpha, beta=beta)
    found = spectrum(system)
    assert found.eigenvalues.shape == (16,) and found.vectors.shape == (8, 16)
    m = np.sqrt(np.diag(system.M))
    for lam, q in zip(found.eigenvalues, found.vectors.T, strict=True):
        terms = np.array([lam**2 * system.M @ q, lam * system.C @ q, system.K @ q]) / m
        # an eigenvalue far below the largest one is known to the rounding of that
        known_to = 1e-10 * np.abs(found.eigenvalues).max() / np.abs(lam)
        assert np.abs(terms.sum(axis=0)).max() < known_to * np.abs(terms).max()
        assert q[np.abs(q).argmax()] == pytest.approx(1)


@pytest.mark.parametrize(("alpha", "beta"), DAMPINGS)
def test_unloaded_spectrum_is_the_formula_of_the_modes(alpha: float, beta: float) -> None:
    """Eq. (23) at P = 0 for every mode, and λ₀ of Eq. (26) from mode 1 where it is not overdamped."""
    system = fb.column("free-free", "modes").system(modes=8, load=0.0, alpha=alpha, beta=beta)
    s = system.gamma**4
    half, root = -(beta + alpha * s) / 2, np.sqrt(((beta + alpha * s) / 2) ** 2 - s + 0j)
    fast = half - np.where(root.real > 0, root, 0) - np.where(root.real > 0, 0, root)
    expected = np.concatenate([fast, s / fast])  # the product of the two is γ⁴: no cancellation
    found = spectrum(system)
    assert distance_of_sets(found.eigenvalues / np.abs(expected).max(), expected / np.abs(expected).max()) < 1e-12
    square = s[0] - half[0] ** 2
    if square > 0:
        assert found.reference_frequency == pytest.approx(math.sqrt(square), rel=1e-12)
        assert found.normalised is not None
        assert found.normalised * found.reference_frequency == pytest.approx(found.eigenvalues)
    else:
        assert found.reference_frequency is None and found.normalised is None


def test_reference_frequency_ends_where_mode_one_is_overdamped() -> None:
    """α = 2/γ₁² at β = 0."""
    column = fb.column("free-free", "modes")
    limit = 2 / column.system(modes=1).gamma[0] ** 2
    assert spectrum(column.system(load=10.0, alpha=limit * 0.999)).reference_frequency is not None
    assert spectrum(column.system(load=10.0, alpha=limit * 1.001)).reference_frequency is None


@settings(max_examples=40, deadline=None, derandomize=True)
@given(
    name=st.sampled_from(NAMES),
    modes=st.integers(1, 12),
    load=st.floats(-200.0, 200.0),
    alpha=st.floats(0.0, 1.0),
    beta=st.floats(0.0, 100.0),
)
def test_order_and_conjugation(name: str, modes: int, load: float, alpha: float, beta: float) -> None:
    values = spectrum(fb.column(name, "modes").system(modes=modes, load=load, alpha=alpha, beta=beta)).eigenvalues
    slack = 1e-12 * np.abs(values).max()
    assert (np.diff(np.abs(values.imag)) >= -slack).all()
    assert distance_of_sets(values, values.conj()) < 1e3 * slack


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize(("alpha", "beta"), DAMPINGS[:4])
def test_unstable_count_changes_at_the_critical_load(name: str, alpha: float, beta: float) -> None:
    column = fb.column(name, "modes")
    load = fb.critical_load(column, 8, alpha, beta).load
    assert load is not None
    below, above = (spectrum(column.system(8, load * f, alpha, beta)) for f in (1 - 1e-3, 1 + 1e-3))
    assert below.unstable == 0 and above.unstable > 0
    assert above.growth_rate > 0 and below.growth_rate <= 0


@pytest.mark.parametrize(("alpha", "beta"), DAMPINGS)
def test_rigid_functions_leave_the_elastic_spectrum_alone(alpha: float, beta: float) -> None:
    """Beside the elastic eigenvalues: 0 and −β, each twice, to the last digit, at any load."""
    column = fb.column("free-free", "modes")
    plain = spectrum(column.system(8, 60.0, alpha, beta))
    system = column.system(8, 60.0, alpha, beta, rigid=True)
    whole = spectrum(system)
    assert whole.vectors.shape == (10, 20)
    assert distance_of_sets(whole.elastic, plain.eigenvalues) < 1e-9 * np.abs(plain.eigenvalues).max()
    added = [0, 0, -beta, -beta]
    assert (
        distance_of_sets(whole.eigenvalues, np.append(plain.eigenvalues, added)) < 1e-9 * abs(plain.eigenvalues).max()
    )
    assert (np.abs(whole.eigenvalues) == 0).sum() == (2 if beta else 4)
    assert whole.unstable == plain.unstable == 0
    for lam, q in zip(whole.eigenvalues, whole.vectors.T, strict=True):
        terms = np.array([lam**2 * system.M @ q, lam * system.C @ q, system.K @ q])
        assert np.abs(terms.sum(axis=0)).max() <= 1e-8 * np.abs(terms).max() + 1e-200


def test_transposed_load_matrix_has_the_same_eigenvalues_but_not_vectors() -> None:
    """Eq. (11) as printed has H transposed: M and C are symmetric, so no eigenvalue shows it."""
    system = fb.column("free-free", "modes").system(modes=8, load=50.0, alpha=1e-3, beta=0.1)
    printed = SimpleNamespace(M=system.M, C=system.C, E=system.E, K=system.K.T, alpha=1e-3, beta=0.1, rigid_count=0)
    a, b = spectrum(system), spectrum(printed)
    assert distance_of_sets(a.eigenvalues, b.eigenvalues) < 1e-9 * np.abs(a.eigenvalues).max()
    assert np.abs(a.vectors[:, 0] - b.vectors[:, 0]).max() > 1e-2


def test_state_matrix_is_that_of_the_equation_of_motion() -> None:
    """A (q, q̇) = (q̇, q̈) with M q̈ + C q̇ + K q = 0."""
    rng = np.random.default_rng(0)
    M, C, K = np.eye(3) + 0.1 * rng.normal(size=(3, 3)), rng.normal(size=(3, 3)), rng.normal(size=(3, 3))
    q, dq = rng.normal(size=(2, 3))
    step = state_matrix(M, C, K) @ np.append(q, dq)
    assert step[:3] == pytest.approx(dq)
    assert M @ step[3:] + C @ dq + K @ q == pytest.approx(np.zeros(3), abs=1e-12)
    with pytest.raises(fb.InputError, match="M is singular"):
        state_matrix(np.zeros((2, 2)), np.eye(2), np.eye(2))


# --- branches ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize(("alpha", "beta"), DAMPINGS)
def test_branches_are_the_spectrum_rearranged(name: str, alpha: float, beta: float) -> None:
    column, loads = fb.column(name, "modes"), np.linspace(0.0, 300.0, 31)
    found = branches(column, loads, 8, alpha, beta)
    assert found.eigenvalues.shape == (31, 16) and found.vectors is None
    for load, values in zip(loads, found.eigenvalues, strict=True):
        plain = spectrum(column.system(8, load, alpha, beta)).eigenvalues
        assert distance_of_sets(values, plain) < 1e-8 * np.abs(plain).max()
        assert np.sort(values.imag) == pytest.approx(np.sort(plain.imag), abs=1e-8 * np.abs(plain).max())


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize(("alpha", "beta"), DAMPINGS)
def test_branches_do_not_depend_on_the_loads_between(name: str, alpha: float, beta: float) -> None:
    """The same branch keeps its column whether the loads are few or many, and its steps shrink with theirs."""
    column = fb.column(name, "modes")
    coarse, middle, fine = (
        branches(column, np.linspace(0.0, 300.0, m), 6, alpha, beta).eigenvalues for m in (5, 61, 241)
    )
    scale = np.abs(coarse).max()
    assert np.abs(middle[::15] - coarse).max() < 1e-9 * scale
    assert np.abs(fine[::60] - coarse).max() < 1e-9 * scale
    # a coalescence is a square root in P: a quarter of the step halves the jump, there and nowhere less
    jumps = [np.abs(np.diff(x, axis=0)).max() for x in (middle, fine)]
    assert jumps[1] < 0.62 * jumps[0]


def test_branches_run_on_through_an_undamped_coalescence() -> None:
    """Two frequencies meet and part into growth ±r: the smaller number of each pair grows, above the axis and below."""
    loads = np.linspace(100.0, 120.0, 9)
    found = branches(fb.column("free-free", "modes"), loads, 8).eigenvalues
    critical = fb.critical_load(fb.column("free-free", "modes")).load
    assert critical is not None
    after = found[loads > critical]
    assert (after[:, :2].real > 0).all() and (after[:, 2:4].real < 0).all()
    assert after[:, 0] == pytest.approx(after[:, 1].conj()) and after[:, 0] == pytest.approx(-after[:, 2].conj())
    assert (found[loads < critical].real == 0).all()


def test_branches_with_vectors_and_rigid_functions() -> None:
    column, loads = fb.column("free-free", "modes"), [0.0, 40.0, 80.0]
    found = branches(column, loads, 5, 1e-3, 0.1, rigid=True, vectors=True)
    assert found.vectors is not None and found.vectors.shape == (3, 7, 14)
    for k, load in enumerate(loads):
        system = column.system(5, load, 1e-3, 0.1, rigid=True)
        for lam, q in zip(found.eigenvalues[k], found.vectors[k].T, strict=True):
            terms = np.array([lam**2 * system.M @ q, lam * system.C @ q, system.K @ q])
            assert np.abs(terms.sum(axis=0)).max() <= 1e-8 * np.abs(terms).max() + 1e-200
    assert np.abs(np.diff(found.eigenvalues[:, np.abs(found.eigenvalues[0].imag) == 0], axis=0)).max() < 1e-9


@pytest.mark.parametrize(
    ("loads", "arguments", "words"),
    [([], {}, "loads"), ([math.nan], {}, "loads"), ([1.0], {"alpha": -1.0}, "alpha"), ([1.0], {"modes": 0}, "modes")],
)
def test_branches_refuse_bad_input(loads: list[float], arguments: dict[str, float], words: str) -> None:
    with pytest.raises(fb.InputError, match=words):
        branches(fb.column("beck", "modes"), loads, **arguments)


@pytest.mark.parametrize("ratios", [(0.01, 0.02), (0.02, 0.01), (0.0, 0.0), (0.05, 0.05)])
def test_dampings_from_ratios_and_ratios_from_dampings(ratios: tuple[float, float]) -> None:
    """There and back: two modes of the unloaded beam have the ratios that alpha and beta were chosen for."""
    column = fb.column("beck")
    omega = fb.spectrum(column.system(16, 0.0)).eigenvalues.imag
    omega = np.sort(omega[omega > 0])[[0, 2]]
    alpha, beta = fb.proportional_damping(ratios, omega)
    found = fb.spectrum(column.system(16, 0.0, alpha, beta))
    swinging = np.argsort(np.where(found.eigenvalues.imag > 0, np.abs(found.eigenvalues), np.inf))
    assert found.damping_ratio[swinging[[0, 2]]] == pytest.approx(ratios, rel=1e-7, abs=1e-12)


def test_ratios_that_would_need_a_negative_damping_are_refused() -> None:
    assert fb.proportional_damping([0.01, 0.05], [1.0, 5.0]) == (pytest.approx(0.02), pytest.approx(0, abs=1e-15))
    with pytest.raises(fb.InputError, match=r"the second may be 0\.2 to 5 times the first"):
        fb.proportional_damping([0.01, 0.0501], [1.0, 5.0])
    with pytest.raises(fb.InputError, match="must be of two modes"):
        fb.proportional_damping([0.01, 0.02], [1.0, 1.0])
