"""Flutter loads as the eigenvalues of one matrix: against the law that defines them, plain counts and the search."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import freebeam_sym as fb
from freebeam_sym.bialternate import _products, direct_crossing
from freebeam_sym.crossings import first_crossing
from freebeam_sym.pencil import Damping, Pencil


def sample(seed: int, size: int, light: float = 1.0) -> Pencil:
    """A pencil of a load that is not conservative."""
    rng = np.random.default_rng(seed)
    e = np.sort(10 ** rng.uniform(0, 3, size))
    H = rng.normal(size=(size, size)) * light
    return Pencil(np.eye(size), np.diag(e), np.sqrt(np.outer(e, e)) * H)


def state(pencil: Pencil, damping: Damping, load: complex) -> np.ndarray:
    """The matrix of Eq. (25)."""
    n = pencil.size
    K, C = np.diag(pencil.e) + load * pencil.H, np.diag(damping.size * damping.shape)
    return np.block([[np.zeros((n, n)), np.eye(n)], [-K, -C]])


@pytest.mark.parametrize(("seed", "size"), [(0, 2), (1, 3), (2, 4), (3, 5)])
@pytest.mark.parametrize(("alpha", "beta"), [(0.3, 0.0), (0.0, 2.0), (0.01, 0.5)])
def test_at_every_eigenvalue_two_eigenvalues_add_up_to_zero(seed: int, size: int, alpha: float, beta: float) -> None:
    """At complex loads too; and all N (N − 1) are there: the least load at which two add up is the inverse of one."""
    pencil = sample(seed, size)
    damping = Damping.of(pencil.e, alpha, beta, None)
    mu = np.linalg.eigvals(_products(pencil, damping)[0])
    assert len(mu) == size * (size - 1)
    for load in 1 / mu[np.abs(mu) > 1e-8 * np.abs(mu).max()]:
        values = np.linalg.eigvals(state(pencil, damping, load))
        sums = np.abs(values[:, None] + values)[np.triu_indices(2 * size, 1)]
        assert sums.min() < 1e-6 * np.abs(values).max()


@pytest.mark.parametrize(("alpha", "beta"), [(0.0, 1e-5), (1e-6, 0.0), (1e-2, 0.1), (1.0, 0.0), (0.0, 30.0)])
def test_any_pencil_against_plain_counts(alpha: float, beta: float) -> None:
    """Nothing grows at many loads below the answer, and something does above it."""
    unsettled = 0
    for seed in range(20):
        pencil = sample(seed, 2 + seed % 5, 0.3)
        settled, found = direct_crossing(pencil, Damping.of(pencil.e, alpha, beta, None), 50.0, False)
        unsettled += not settled
        if not settled:
            continue
        damping = Damping.of(pencil.e, alpha, beta, None)
        top = 50.0 if found is None else found.load
        loads = np.append(np.linspace(1e-3, 1 - 1e-4, 100), 1 + 1e-3) * top
        growth = np.linalg.eigvals(np.stack([state(pencil, damping, load) for load in loads])).real.max(axis=1)
        assert growth[:-1].max() < 1e-13 * (pencil.e[-1] + damping.size * damping.shape.max())
        assert found is None or growth[-1] > 0
    assert unsettled < 2


@settings(max_examples=40, deadline=None, derandomize=True)
@given(
    name=st.sampled_from(["beck", "beck", "free-free", "euler-pinned"]),
    basis=st.sampled_from(["modes", "legendre"]),
    modes=st.integers(1, 9),
    eta=st.floats(0.0, 1.2).map(lambda x: round(x, 3)),
    damping=st.sampled_from(
        [(0, 0, None), (0, 0, 0.0), (0, 0, 5.0), (0, 0, math.inf)]
        + [(a, b, None) for a, b in ((1e-8, 0), (1e-3, 0.1), (0, 1e-4), (10, 0), (0.1, 300), (0, 1000))]
    ),
    load_max=st.sampled_from([15.0, 1000.0]),
)
def test_columns_against_the_search(
    name: str, basis: str, modes: int, eta: float, damping: tuple[float, float, float | None], load_max: float
) -> None:
    pencil = Pencil(*fb.column(name, basis).matrices(modes, **({"eta": eta} if name == "beck" else {})))
    alpha, beta, kappa = damping
    settled, found = direct_crossing(pencil, Damping.of(pencil.e, alpha, beta, kappa), load_max, kappa is not None)
    searched = first_crossing(pencil, alpha, beta, load_max, kappa, search=True)
    assert settled or eta in (0.5, 0.0)  # η = 1/2: flutter and divergence meet
    if settled:
        assert (found is None) == (searched is None)
    if settled and found is not None and searched is not None:
        assert found.kind == searched.kind and found.load == pytest.approx(searched.load, rel=1e-10)
        assert found.frequency == pytest.approx(searched.frequency, rel=1e-8)
        assert np.abs(found.vector - searched.vector).max() < 1e-5


def test_two_branches_that_flutter_at_one_load_are_no_wrong_answer() -> None:
    """Two equal columns side by side, coupled by nothing: every load is double."""
    one = np.array([[1.0, 0.6], [-0.6, -0.5]])
    twice = Pencil(np.eye(4), np.diag([1.0, 4.0, 1.0, 4.0]), np.kron(np.eye(2), one))
    alone = first_crossing(Pencil(np.eye(2), np.diag([1.0, 4.0]), one), 0.01, 0.02)
    settled, found = direct_crossing(twice, Damping.of(twice.e, 0.01, 0.02, None), 1000.0, False)
    assert alone is not None
    assert not settled or (found is not None and found.load == pytest.approx(alone.load, rel=1e-9))
