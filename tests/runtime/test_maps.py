"""Maps, boundaries and arrays of critical loads against plain counts of growing eigenvalues, and laws of theirs."""

from __future__ import annotations

import csv
import itertools
import json
import math
import sys
from itertools import pairwise
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
import xarray as xr
from hypothesis import given, settings
from hypothesis import strategies as st

import freebeam as fb
from freebeam import cli
from freebeam.maps import arrays
from freebeam.maps.boundaries import _change, _Tracer
from freebeam.maps.grid import solve_grid
from freebeam.maps.known import settled
from freebeam.maps.surface import Surface, _filled, _Patch, first_crossing, surface_of
from freebeam_sym.question import Question
from freebeam_sym.stability import pencil
from freebeam_sym.stability.proportional import Proportional

KINDS = ("none", "flutter", "divergence")


def growing(column: fb.Column, modes: int, alpha: float, beta: float, loads: np.ndarray, **own: float) -> np.ndarray:
    """How many of the 2N eigenvalues of Eq. (25) grow at each load. The inverse of the state matrix keeps the slow ones
    apart from the rounding of the fast ones."""
    M, E, H = column.matrices(modes, **own)
    m = np.sqrt(np.diag(M))
    M, E, H = (X / np.outer(m, m) for X in (M, E, H))
    inverse = np.linalg.inv(E + loads[:, None, None] * H)
    A = np.zeros((len(loads), 2 * modes, 2 * modes))
    A[:, :modes, :modes] = -inverse @ (alpha * E + beta * M)
    A[:, :modes, modes:] = -inverse @ M
    A[:, modes:, :modes] = np.eye(modes)
    return (np.linalg.eigvals(A).real > 1e-13 * np.linalg.norm(A, axis=(1, 2))[:, None]).sum(axis=1)


def leaves(patch: _Patch) -> list[_Patch]:
    """All patches that were made and not cut."""
    return [x for part in patch.parts for x in leaves(part)] if patch.parts else [patch]


def log_uniform(low: float, high: float) -> st.SearchStrategy[float]:
    return st.floats(math.log(low), math.log(high)).map(math.exp)


DAMPINGS = st.tuples(
    st.one_of(st.just(0.0), log_uniform(1e-4, 10.0)), st.one_of(st.just(0.0), log_uniform(1e-2, 1000.0))
).filter(lambda pair: pair[0] + pair[1] > 0)


@settings(max_examples=25, deadline=None, derandomize=True)
@given(
    name=st.sampled_from(["free-free", "beck", "beck", "euler-pinned"]),
    basis=st.sampled_from(["modes", "legendre"]),
    modes=st.integers(2, 9),
    eta=st.floats(0.0, 1.2),
    dampings=st.lists(DAMPINGS, min_size=16, max_size=16),
)
def test_loads_are_where_stability_is_lost_first(
    name: str, basis: str, modes: int, eta: float, dampings: list[tuple[float, float]]
) -> None:
    """Nothing grows at many loads below, and something just above, whatever the damping: by brute force."""
    column = fb.column(name, basis)
    own = {"eta": round(eta, 3)} if name == "beck" else {}
    alpha, beta = np.array(dampings).T
    found = arrays.solve(fb.Question.of(column, modes, load_max=400.0, **own), alpha, beta)
    for k in range(0, 16, 3):
        top = found.load[k] if found.kind[k] else 400.0
        below = np.concatenate([np.linspace(0.004, 0.98, 60), np.linspace(0.981, 0.9999, 12)]) * top
        assert not growing(column, modes, alpha[k], beta[k], below, **own).any(), (alpha[k], beta[k])
        if found.kind[k]:
            assert growing(column, modes, alpha[k], beta[k], np.array([top * 1.0005]), **own)[0]
            assert (found.frequency[k] == 0) == (found.kind[k] == 2)
        else:
            assert np.isnan(found.load[k]) and np.isnan(found.frequency[k])


@pytest.mark.parametrize(("name", "basis"), [("free-free", "modes"), ("free-free", "legendre"), ("beck", "modes")])
def test_the_surface_covers_all_damping_and_agrees_with_the_search(name: str, basis: str) -> None:
    column, rng = fb.column(name, basis), np.random.default_rng(5)
    surface = surface_of(pencil.Pencil(*column.matrices(8)), 1000.0)
    alpha, beta = 10 ** rng.uniform(-6, 1, 400), 10 ** rng.uniform(-3, 3, 400)
    alpha[:40], beta[40:80] = 0.0, 0.0
    load, frequency, known = surface.at(alpha, beta)
    assert known.mean() > 0.9  # where few points lie in small patches, they are left to the search
    for k in np.flatnonzero(known)[::20]:
        found = first_crossing(surface.pencil, alpha[k], beta[k])
        assert found is not None
        assert load[k] == pytest.approx(found.load, rel=1e-10)
        assert frequency[k] == pytest.approx(found.frequency, rel=1e-9)


def test_where_one_branch_takes_over_the_lesser_of_two_crossings_is_the_first() -> None:
    """Beck's column between alpha 1.05 and 1.1: the load is continuous with a kink, the frequency jumps."""
    surface = surface_of(pencil.Pencil(*fb.column("beck", "modes").matrices(8)), 1000.0)
    alpha = np.linspace(1.04, 1.08, 401)
    load, frequency, known = surface.at(alpha, np.zeros(401))
    assert known.all() and frequency[0] > 10 * frequency[-1]
    assert max(len(leaf.series) for leaf in leaves(surface._root) if leaf.series is not None) > 1
    jump = int(np.abs(np.diff(frequency)).argmax())
    for k in (0, jump, jump + 1, 400):
        found = first_crossing(surface.pencil, alpha[k])
        assert found is not None and load[k] == pytest.approx(found.load, rel=1e-10)
        assert frequency[k] == pytest.approx(found.frequency, rel=1e-9)


@pytest.mark.parametrize("seed", [9, 15])
def test_flutter_that_ends_as_the_damping_grows_is_not_passed_over(seed: int) -> None:
    """Matrices whose branches cross early and part again: at light damping only, flutter comes long before the rest."""
    rng = np.random.default_rng(seed)
    e = np.array([1.0, 4.0, 30.0])
    coupling = rng.uniform(0.02, 0.05)
    H = np.array([[1.0, coupling, 0.0], [-coupling, -0.5, 0.0], [0.0, 0.0, -1.0]])
    one = pencil.Pencil(np.eye(3), np.diag(e), H)
    beta = np.geomspace(1e-4, 10.0, 24)
    load, _, known = surface_of(one, 7.0).at(np.zeros(24), beta)
    top = surface_of(one, 7.0).divergence
    for k in range(24):
        found = first_crossing(one, 0.0, float(beta[k]), 1000.0)
        here = load[k] if load[k] < top else top
        assert found is not None and (not known[k] or here == pytest.approx(found.load, rel=1e-9))
    lightest = load[0] if known[0] else None
    # the gap of the pair: (3 − 1.5 P)² = 4 coupling² P²
    assert lightest is None or lightest == pytest.approx(3 / (1.5 + 2 * coupling), rel=1e-4)


@pytest.mark.parametrize(("alpha", "beta"), [(1e-3, 0.1), (0.05, 0.0), (0.0, 3.0)])
def test_steps_to_the_surface_leave_the_third_power_of_an_error(alpha: float, beta: float) -> None:
    one = pencil.Pencil(*fb.column("beck", "modes").matrices(6))
    surface, found = surface_of(one, 1000.0), first_crossing(one, alpha, beta)
    assert found is not None
    xi, rest, chi = surface.coordinates(np.array([alpha]), np.array([beta]))
    exact = np.array([[found.load], [found.frequency**2 / rest[0]]])
    off = []
    for h in (8e-3, 4e-3, 2e-3):
        near = surface._solve(xi, chi, exact * (1 + h * np.array([[1.0], [-0.5]])), steps=1, rough=True)
        off.append(np.abs(near / exact - 1).max())
    assert min(math.log2(a / b) for a, b in pairwise(off)) > 2.7


@pytest.mark.parametrize("share", [1.005, 0.995])
def test_no_patch_is_said_to_be_without_flutter_that_has_some_just_below_its_bound(share: float) -> None:
    one = pencil.Pencil(*fb.column("free-free", "modes").matrices(6))
    alpha, beta = np.array([1e-3]), np.array([0.1])
    found = first_crossing(one, alpha[0], beta[0])
    assert found is not None
    surface = Surface(one, share * found.load)
    xi, _, chi = surface.coordinates(alpha, beta)
    patch = _Patch((xi[0] - 1e-4, chi[0] - 1e-4), (xi[0] + 1e-4, chi[0] + 1e-4), None)
    assert surface._none_there(patch) == (share < 1)


def test_a_patch_is_taken_where_the_first_crossing_is_and_nowhere_else() -> None:
    one = pencil.Pencil(*fb.column("beck", "modes").matrices(6))
    surface = surface_of(one, 1000.0)
    surface.at(np.geomspace(1e-4, 1e-1, 40), np.full(40, 0.1))
    flutter = [leaf for leaf in leaves(surface._root) if leaf.state == "flutter"]
    assert flutter
    for patch in flutter:
        assert patch.series is not None and surface._first_there(patch, patch.series)
        for by in ([-1, 1], [1, -1], [1.02, 1], [0.98, 1], [1, 1.1]):
            assert not surface._first_there(patch, patch.series * np.array(by)[:, None, None])


@pytest.mark.parametrize("name", ["free-free", "beck"])
def test_the_undamped_branches_know_the_limit_of_vanishing_damping_to_some_digits(name: str) -> None:
    one = pencil.Pencil(*fb.column(name, "modes").matrices(6))
    surface = surface_of(one, 1000.0)
    for chi in (0.0, 0.1, 0.3, 0.5, 0.7, 0.9):
        exact = first_crossing(one, kappa=surface.kappa0 * chi / (1 - chi))
        load, square = surface._vanishing(chi)
        assert exact is not None and load == pytest.approx(exact.load, rel=3e-3)
        assert square == pytest.approx(exact.frequency**2, rel=3e-2)


def test_the_corner_of_the_surface_is_the_column_without_damping() -> None:
    one = pencil.Pencil(*fb.column("beck", "modes").matrices(6))
    load, frequency, known = surface_of(one, 1000.0).at(np.zeros(1), np.zeros(1))
    undamped = first_crossing(one)
    assert undamped is not None and known[0]
    assert load[0] == pytest.approx(undamped.load, rel=1e-9)
    assert frequency[0] == pytest.approx(undamped.frequency, rel=1e-6)


@pytest.mark.parametrize("seed", range(4))
def test_what_is_missing_of_a_guess_is_taken_from_the_nearest(seed: int) -> None:
    rng = np.random.default_rng(seed)
    whole = rng.normal(size=(2, 6, 6))
    lost = rng.random((6, 6)) < 0.6
    filled = _filled(np.where(lost, np.nan, whole))
    assert filled is not None and (filled[:, ~lost] == whole[:, ~lost]).all()
    there = np.argwhere(~lost)
    for place in np.argwhere(lost):
        distance = np.linalg.norm(there - place, axis=1)
        nearest = there[distance == distance.min()]
        assert any((filled[:, *place] == whole[:, *other]).all() for other in nearest)
    assert _filled(np.full((2, 6, 6), np.nan)) is None


@pytest.mark.parametrize("name", ["free-free", "beck"])
def test_the_limit_of_vanishing_damping_lies_on_the_surface(name: str) -> None:
    """Along beta = kappa alpha the loads tend to the tangent rule's, kappa from 0 to infinity (the coalescence)."""
    column = fb.column(name, "modes")
    for kappa, (a, b) in {0.0: (1, 0), 3.0: (1, 3), 500.0: (1, 500), math.inf: (0, 1)}.items():
        size = np.array([1e-14, 1e-12, 1e-10, 1e-9] * 4)
        found = fb.critical_loads(column, alpha=a * size, beta=b * size)
        limit = fb.critical_load(column, kappa=kappa)
        assert limit.load is not None and limit.frequency is not None
        assert np.abs(found.load / limit.load - 1).max() < 1e-11
        assert np.abs(found.frequency / limit.frequency - 1).max() < 1e-8


def test_single_questions_and_maps_agree_in_either_order() -> None:
    """A surface that earlier questions have built changes no answer."""
    column = fb.column("free-free", "modes")
    cold = [
        settled(Proportional(pencil.Pencil(*column.matrices(8)), a, 0.3), 1000.0).crossing for a in (1e-5, 1e-2, 10.0)
    ]
    shared = pencil.Pencil(*column.matrices(8))
    for _ in range(6):
        warm = [settled(Proportional(shared, a, 0.3), 1000.0).crossing for a in (1e-5, 1e-2, 10.0)]
    assert surface_of(shared, 1000.0)._root is not None
    for one, other in zip(cold, warm, strict=True):
        assert one is not None and other is not None
        assert other.load == pytest.approx(one.load, rel=1e-12)
        assert other.frequency == pytest.approx(one.frequency, rel=1e-10)
        assert np.abs(other.vector - one.vector).max() < 1e-6


@pytest.mark.parametrize(("kappa", "first"), [(None, 16.05), (1.0, 10.06)])
def test_what_is_known_up_to_one_load_serves_every_other(kappa: float | None, first: float) -> None:
    """Beck's column touches λ = 0 at π² where half of the force follows, and flutters beyond."""
    matrices = fb.column("beck", "legendre").matrices(12, eta=0.5)
    shared = pencil.Pencil(*matrices)
    for load_max in (5.0, 12.0, 100.0, 20.0, 12.0, 5.0):
        warm = settled(Proportional(shared, kappa=kappa), load_max)
        cold = settled(Proportional(pencil.Pencil(*matrices), kappa=kappa), load_max)
        assert [x.load for x in warm.touches] == pytest.approx([x.load for x in cold.touches], rel=1e-12)
        assert (warm.crossing is None) == (cold.crossing is None) == (load_max < first)
        if warm.crossing is not None and cold.crossing is not None:
            assert warm.crossing.load == pytest.approx(cold.crossing.load, rel=1e-12)


def test_blocks_give_the_same_bits_in_any_order() -> None:
    column = fb.column("free-free", "modes")
    alpha, beta = np.geomspace(1e-4, 1.0, 12), np.geomspace(1e-2, 10.0, 10)
    blocks = [{"alpha": a, "beta": b} for a, b in itertools.product(np.split(alpha, 2), np.split(beta, 2))]
    question = fb.Question.of(column, 8)
    runs = []
    for order in ((0, 1, 2, 3), (3, 1, 0, 2)):
        pencil._kept.cache_clear()
        runs.append({k: solve_grid(question, blocks[k]) for k in order})
    for k in range(4):
        for one, other in zip(runs[0][k], runs[1][k], strict=True):
            assert one.tobytes() == other.tobytes()
    whole = solve_grid(question, {"alpha": alpha, "beta": beta})
    assert np.allclose(whole.load[:6, :5], runs[0][0].load, rtol=1e-12, atol=0)


def test_a_map_is_labelled_in_the_order_of_its_axes() -> None:
    column = fb.column("beck", "modes")
    axes = {"beta": np.array([0.1, 1.0]), "eta": np.array([0.3, 0.8, 1.0]), "alpha": np.array([0.0, 1e-3, 1e-2, 0.1])}
    done: list[float] = []
    found = fb.stability_map(column, 6, load_max=300.0, step=done.append, **axes)
    assert found["load"].dims == ("beta", "eta", "alpha") and done == sorted(done) and done[-1] == pytest.approx(1)
    assert found.attrs["modes"] == 6 and found.attrs["column"] == "beck" and found.attrs["load_max"] == 300.0
    kinds = np.array(found["kind"].attrs["flag_meanings"].split())[found["kind"]]
    for (i, b), (j, e), (k, a) in itertools.product(*(enumerate(x) for x in axes.values())):
        one = fb.critical_load(column, 6, a, b, load_max=300.0, eta=e)
        assert found["load"].values[i, j, k] == pytest.approx(one.load, rel=1e-10)
        assert found["frequency"].values[i, j, k] == pytest.approx(one.frequency, rel=1e-8)
        assert kinds[i, j, k] == one.kind and one.kind == ("divergence" if e < 0.5 else "flutter")
        assert found["converged"].values[i, j, k] == one.converged
        assert found["error"].values[i, j, k] == pytest.approx(one.error, rel=0.1)


def test_a_load_that_truncation_invents_is_marked() -> None:
    """Beck's crossing at internal damping 10 wanders with N; at light damping N = 8 has converged."""
    found = fb.stability_map(fb.column("beck", "modes"), alpha=np.array([1e-3, 10.0]), beta=np.array([0.0, 0.1]))
    assert found["converged"].values[0].all() and not found["converged"].values[1].any()


def test_a_map_survives_its_file(tmp_path: Path) -> None:
    pytest.importorskip("h5py")
    xarray = pytest.importorskip("xarray")
    found = fb.stability_map(
        fb.column("free-free", "modes"), 4, alpha=np.geomspace(1e-4, 1, 5), beta=np.geomspace(0.1, 10, 4)
    )
    path = tmp_path / "map.nc"
    axes = ["--alpha", "1e-4", "1", "5", "--beta", "0.1", "10", "4"]
    assert cli.main(["map", "--modes", "4", *axes, "--output", str(path)]) == 0
    with xarray.open_dataset(path, engine="h5netcdf") as read:
        xarray.testing.assert_identical(read.load(), found)


# --- arrays ---------------------------------------------------------------------------------------------------


def test_loads_broadcast() -> None:
    column = fb.column("beck", "modes")
    alpha, beta, eta = (
        np.array([[0.0], [1e-3], [2.0]]),
        np.array([0.0, 0.1, 30.0, 1000.0]),
        np.array([[[0.4]], [[1.0]]]),
    )
    found = fb.critical_loads(column, 5, alpha, beta, eta=eta, load_max=500.0)
    assert found.load.shape == found.kind.shape == (2, 3, 4)
    for where in np.ndindex(found.load.shape):
        a, b, e = (float(np.broadcast_to(x, found.load.shape)[where]) for x in (alpha, beta, eta))
        one = fb.critical_load(column, 5, a, b, eta=e, load_max=500.0)
        assert found.kind[where] == one.kind
        if one.load is not None:
            assert found.load[where] == pytest.approx(one.load, rel=1e-10)
    assert fb.critical_loads(fb.column("euler-pinned", "modes")).load == pytest.approx(math.pi**2, rel=1e-12)
    assert fb.critical_loads(column, alpha=np.empty((0, 3))).load.shape == (0, 3)


def test_spectra_broadcast() -> None:
    column = fb.column("beck", "modes")
    load, alpha, eta = np.array([[0.0], [15.0], [40.0]]), np.array([0.0, 1e-2]), np.array([[[0.6]], [[1.0]]])
    found = fb.eigenvalues(column, load, alpha, modes=4, eta=eta)
    assert found.shape == (2, 3, 2, 8)
    for where in np.ndindex(found.shape[:-1]):
        P, a, e = (float(np.broadcast_to(x, found.shape[:-1])[where]) for x in (load, alpha, eta))
        one = fb.spectrum(column.system(4, P, a, eta=e)).eigenvalues
        assert np.abs(found[where] - one).max() < 1e-9 * np.abs(one).max()


# --- boundaries ---------------------------------------------------------------------------------------------


def test_the_boundary_of_becks_column_over_eta_turns_from_divergence_to_flutter() -> None:
    column = fb.column("beck", "modes")
    curve = fb.trace_boundary(column, "eta", 0.3, 0.7, modes=4, load_max=100.0)
    (event,) = curve.events
    assert event.what == "divergence to flutter"
    for off, kind in ((-1e-8, "divergence"), (1e-8, "flutter")):
        assert fb.critical_load(column, 4, eta=event.value + off, load_max=100.0).kind == kind
    assert (np.diff(curve.values) > 0).all()
    assert (curve.kind == np.where(curve.values < event.value, "divergence", "flutter")).all()
    middle = (curve.values[1:] + curve.values[:-1]) / 2
    for k in range(0, len(middle), 7):  # what lies between the points is near the chord
        one = fb.critical_load(column, 4, eta=float(middle[k]), load_max=100.0)
        assert one.load == pytest.approx((curve.load[k] + curve.load[k + 1]) / 2, rel=3e-3)


def test_the_boundary_over_internal_damping_has_the_place_where_another_branch_takes_over() -> None:
    curve = fb.trace_boundary(fb.column("beck", "modes"), "alpha", 1e-3, 10.0, log=True)
    (event,) = curve.events
    assert event.what == "another branch" and 1.05 < event.value < 1.1
    assert event.load[0] == pytest.approx(event.load[1], rel=1e-7)
    assert event.frequency[0] > 10 * event.frequency[1]  # type: ignore[operator]


@pytest.mark.parametrize("damping", [{}, {"kappa": 2.0}, {"alpha": 1e-3, "beta": 0.1}, {"alpha": 1.0}, {"beta": 100.0}])
def test_points_of_a_boundary_are_first_critical_loads(damping: dict[str, float]) -> None:
    """Random points against proven loads, those next to the events against the search."""
    column = fb.column("beck", "modes")
    curve = fb.trace_boundary(column, "eta", 0.2, 1.0, modes=6, **damping)
    assert curve.events[0].what == "divergence to flutter"
    near = [int(np.searchsorted(curve.values, event.value)) for event in curve.events]
    near += [k - 1 for k in near]  # two crossings are at one load there, and no proof tells them apart
    others = np.setdiff1d(np.arange(len(curve.values)), near)
    for k in np.random.default_rng(3).choice(others, 5):
        proven = fb.certified_load(column, 6, eta=float(curve.values[k]), **damping)
        assert proven.load is not None and proven.frequency is not None
        assert curve.kind[k] == proven.kind
        assert curve.load[k] == pytest.approx(float(proven.load[0]), rel=1e-11)
        square = float(proven.frequency[0]) ** 2  # where ω goes to zero rounding is that of ω² beside mode 1's, 12
        assert curve.frequency[k] ** 2 == pytest.approx(square, rel=2e-8, abs=1e-14)
    for k in near:
        own = pencil.Pencil(*column.matrices(6, eta=float(curve.values[k])))
        one = first_crossing(own, damping.get("alpha", 0.0), damping.get("beta", 0.0), 1000.0, damping.get("kappa"))
        assert one is not None and curve.kind[k] == one.kind
        assert curve.load[k] == pytest.approx(one.load, rel=1e-9)


@pytest.mark.parametrize("damping", [{}, {"kappa": 2.0}, {"alpha": 1e-3, "beta": 0.1}])
def test_a_boundary_lies_on_the_axis_and_has_the_slope_of_its_neighbours(damping: dict[str, float]) -> None:
    """G = K + iωC − ω²M is singular at its points, and loads found a step aside differ by the slope times the step."""
    column = fb.column("crack")
    curve = fb.trace_boundary(column, "k", 0.5, 20.0, modes=5, log=True, **damping)
    own = {name: x for name, x in damping.items() if name != "kappa"}
    assert (np.diff(curve.values) > 0).all() and not curve.events
    for k in range(3, len(curve.values), 13):
        spring, load, omega = curve.values[k], curve.load[k], curve.frequency[k]
        s = column.system(5, load, **own, k=spring)
        size = np.sqrt(np.diag(s.E))
        G = (s.K + 1j * omega * s.C - omega**2 * s.M) / np.outer(size, size)
        assert np.linalg.svd(G, compute_uv=False)[-1] < 1e-12
        down, up = (fb.critical_load(column, 5, k=spring * (1 + h), **damping).load for h in (-1e-4, 1e-4))
        assert curve.slope[k] == pytest.approx((up - down) / (2e-4 * spring), rel=1e-6)


def test_between_points_of_a_boundary_it_is_counted_what_grows() -> None:
    """What the tangents at two points have half-way is the first loss there, but where another branch takes over."""
    question = Question.of(fb.column("beck", "modes"), alpha=1.0)
    for low, high, first in ((0.2, 0.25, True), (1.0, 1.1, False)):
        tracer = _Tracer(question, "alpha", lambda t, low=low, high=high: (low + t * (high - low), high - low), 1e-3)
        for t in (0.0, 1.0):
            tracer.ask(t)
        assert tracer.confirmed(0.0, 1.0) == first
        assert (tracer.cubic(0.0, 1.0)[0] == pytest.approx(tracer.ask(0.5).load, rel=1e-5)) == first


def test_closer_to_an_event_it_is_counted_at_ever_smaller_distances(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where one branch takes over another may soon: no gap between counts is longer than its distance from there."""
    tracer = _Tracer(Question.of(fb.column("beck", "modes"), 4), "alpha", lambda t: (0.2 + t / 20, 0.05), 1e-3)
    places: list[float] = []
    monkeypatch.setattr(tracer, "counted", lambda a, b, u: places.append(a + u * (b - a)) or True)
    for t in (0.0, 1.0):
        tracer.ask(t)
    for beside in (0.0, 1.0):
        tracer.beside = {beside}
        assert tracer.confirmed(0.0, 1.0)
        off = np.sort(np.abs(np.array(places) - beside))
        assert off[0] < 1e-3 and (np.diff(off) <= off[:-1]).all()
        places.clear()


@pytest.mark.parametrize("modes", [12, 20])
def test_with_polynomials_divergence_gives_way_to_flutter_at_one_half(modes: int) -> None:
    """And the verdict: their error against the beam itself is small on either side."""
    curve = fb.trace_boundary(fb.column("beck", "legendre"), "eta", 0.4, 0.6, modes=modes, tolerance=0.1)
    (event,) = curve.events
    assert event.what == "divergence to flutter" and event.value == pytest.approx(0.5, abs=1e-6)
    assert curve.converged.all() and curve.error.max() < 1e-8


def test_a_boundary_without_events() -> None:
    curve = fb.trace_boundary(fb.column("euler-pinned", "modes"), "beta", 0.0, 10.0, modes=3)
    assert not curve.events and np.allclose(curve.load, math.pi**2, rtol=1e-12) and (curve.frequency == 0).all()
    assert len(curve.values) == 33  # of a straight line no interval of the 32 is cut
    curve = fb.trace_boundary(fb.column("free-free", "modes"), "alpha", 1e-6, 10.0, log=True)
    limit = fb.critical_load(fb.column("free-free", "modes"), kappa=0.0).load
    assert not curve.events and curve.load[0] == pytest.approx(limit, rel=1e-9)


# --- bad input -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({}, "needs an axis"),
        ({"alpha": 0.1}, "needs an axis"),
        ({"alpha": [0.1, -0.1]}, "alpha = -0.1"),
        ({"alpha": [0.1, math.nan]}, r"alpha\[1\] = nan"),
        ({"alpha": [[0.1]]}, r"shape \(1, 1\)"),
        ({"alpha": []}, r"shape \(0,\)"),
        ({"alpha": [0.1, 0.1]}, "distinct"),
        ({"alpha": ["x", "y"]}, "must be a real number"),
        ({"zeta": [0.1, 0.2]}, "no such parameter"),
        ({"alpha": [0.1, 0.2], "load_max": -1.0}, "load_max"),
        ({"alpha": [0.1, 0.2], "modes": 0}, "modes"),
        ({"alpha": np.arange(10**5), "beta": np.arange(10**5)}, "points of the map"),
    ],
)
def test_maps_refuse_what_makes_no_sense(given: dict, message: str) -> None:
    with pytest.raises(fb.InputError, match=message):
        fb.stability_map(fb.column("beck", "modes"), **given)


def test_arrays_of_a_damping_that_a_column_has_not_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    column = fb.column("beck", "modes")
    monkeypatch.setitem(column.kernel.COLUMN, "damping", ["beta"])
    with pytest.raises(fb.InputError, match="states no such damping"):
        fb.critical_loads(column, alpha=[0.0, 0.1])
    assert (fb.critical_loads(column, alpha=[0.0], beta=[0.1]).load > 0).all()


def test_boundaries_and_arrays_refuse_what_makes_no_sense() -> None:
    beck = fb.column("beck", "modes")
    with pytest.raises(fb.InputError, match="low must be below high"):
        fb.trace_boundary(beck, "eta", 1.0, 0.0)
    with pytest.raises(fb.InputError, match="no such parameter"):
        fb.trace_boundary(beck, "zeta", 0.0, 1.0)
    with pytest.raises(fb.InputError, match="low = nan"):
        fb.trace_boundary(beck, "eta", math.nan, 1.0)
    with pytest.raises(fb.InputError, match="above zero"):
        fb.trace_boundary(beck, "alpha", 0.0, 1.0, log=True)
    with pytest.raises(fb.InputError, match="cannot be fixed"):
        fb.trace_boundary(beck, "eta", 0.0, 1.0, eta=0.5)
    with pytest.raises(fb.InputError, match=r"alpha \(2,\), beta \(3,\)"):
        fb.critical_loads(beck, alpha=[0.1, 0.2], beta=[0.1, 0.2, 0.3])
    with pytest.raises(fb.InputError, match="do not broadcast"):
        fb.eigenvalues(beck, load=[1.0, 2.0], beta=[0.1, 0.2, 0.3])
    with pytest.raises(fb.InputError, match="load = inf"):
        fb.eigenvalues(beck, load=math.inf)


# --- the command line ----------------------------------------------------------------------------------------

GRID = ["--alpha", "1e-4", "1", "4", "--beta", "0.1", "10", "3"]


def test_the_command_prints_the_map(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["map", "--column", "beck", "--modes", "4", "--set", "eta=0.9", *GRID, "--json"]) == 0
    record = json.loads(capsys.readouterr().out)
    found = fb.critical_loads(
        fb.column("beck"), 4, np.geomspace(1e-4, 1, 4)[:, None], np.geomspace(0.1, 10, 3), eta=0.9
    )
    assert record["alpha"] == np.geomspace(1e-4, 1, 4).tolist() and record["beta"] == np.geomspace(0.1, 10, 3).tolist()
    assert np.allclose(record["load"], found.load, rtol=1e-10) and record["kind"] == found.kind.tolist()
    assert np.allclose(record["frequency"], found.frequency, rtol=1e-8)
    assert (
        cli.main(["map", "--linear", "--alpha", "0", "1", "3", "--beta", "0", "2", "2", "--modes", "2", "--json"]) == 0
    )
    assert json.loads(capsys.readouterr().out)["alpha"] == [0.0, 0.5, 1.0]
    assert cli.main(["map", "--modes", "2", *GRID]) == 0
    assert "12 points" in capsys.readouterr().out


def test_the_command_draws_the_map_and_keeps_what_exists(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "map.png"
    arguments = ["map", "--modes", "2", "--no-convergence", *GRID, "--output", str(path)]
    assert cli.main(arguments) == 0
    first = path.read_bytes()
    assert first.startswith(b"\x89PNG")
    assert cli.main(arguments) == 2
    assert "--force" in capsys.readouterr().err and path.read_bytes() == first
    assert cli.main([*arguments, "--force"]) == 0 and list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--alpha", "0", "1", "3", "--beta", "1", "2", "2"], "--linear"),
        (["--alpha", "-1", "1", "3", "--beta", "1", "2", "2", "--linear"], "LO = -1"),
        (["--alpha", "2", "1", "3", "--beta", "1", "2", "2"], "HI = 1"),
        (["--alpha", "1", "2", "0", "--beta", "1", "2", "2"], "COUNT"),
        (["--alpha", "1", "2", "2.5", "--beta", "1", "2", "2"], "COUNT = 2.5"),
        (["--alpha", "1", "x", "2", "--beta", "1", "2", "2"], "'x' is not a number"),
        ([], "a map needs an axis"),
        (["--alpha", "1", "2"], "--alpha LO HI COUNT: COUNT is missing"),
        (["--axis", "eta", "1"], "--axis NAME LO HI COUNT: HI COUNT is missing"),
        (["--axis", "eta", "0", "1", "3"], "eta: free-free has no such parameter"),
        (["--alpha", "1", "2", "2", "--axis", "alpha", "1", "2", "2"], "alpha: is an axis twice"),
        (["--column", "beck", "--axis", "eta", "0", "1", "3", "--set", "eta=1"], "leave one of them out"),
        (["--alpha", "1", "2", "2", "--output", "map.png"], "two axes"),
        ([*GRID, "--output", "map.txt"], ".csv, .nc, .png"),
        ([*GRID, "--set", "zeta=1"], "zeta"),
        (["--alpha", "1", "2", "--beta", "1", "2", "2"], "--alpha LO HI COUNT: COUNT is missing"),
        ([*GRID, "3"], "3: belongs to no option"),
        (["--alpha", "1", "2", "9" * 30, "--beta", "1", "2", "2"], "points of the map = 1999"),
        (["--alpha", "1", "2", "100000", "--beta", "1", "2", "100000"], "points of the map = 10000000000"),
        (["--alpha", "1", "1e101", "2", "--beta", "1", "2", "2"], "below 1e60"),
        ([*GRID, "--set", "alpha=1"], "alpha is an axis of this map"),
        ([*GRID, "--load-max", "0"], "load_max = 0"),
        ([*GRID, "--chunks", "5"], "chunks = 5: must be a whole number, 1 to 4"),
        ([*GRID, "--chunks", "2", "--store", "no/such.zarr"], "no/such.zarr: cannot be written"),
        ([*GRID, "--output", "map"], ".csv, .nc, .png"),
        (["--alpha", "1", "2", "1", "--beta", "1", "2", "2", "--output", "map.png"], "two values or more"),
        (["--alpha", "1", "2", "200", "--beta", "1", "2", "51", "--json"], "10200 points"),
    ],
)
def test_the_command_refuses_in_one_line(
    arguments: list[str], message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert cli.main(["map", *arguments]) == 2
    out, err = capsys.readouterr()
    assert out == "" and message in err and err.count("\n") == 1 and err.startswith("freebeam: ")


@pytest.mark.parametrize(
    ("axes", "names"),
    [
        (["--beta", "0.1", "1", "3"], ["beta"]),
        (["--axis", "eta", "0.6", "1", "3"], ["eta"]),
        (["--axis", "eta", "0.6", "1", "2", "--axis", "alpha", "1e-3", "1e-1", "3", "--beta", "1", "2", "2"], None),
    ],
)
def test_any_parameter_is_an_axis_in_every_format(
    axes: list[str], names: list[str] | None, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Each point is `critical_load` there; JSON, CSV and NetCDF hold the same floats."""
    command = ["map", "--column", "beck", "--modes", "3", *axes]
    assert cli.main([*command, "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    names = names or ["beta", "eta", "alpha"]
    for suffix in ("csv", "nc"):
        assert cli.main([*command, "--output", str(tmp_path / f"map.{suffix}")]) == 0
    lines = (tmp_path / "map.csv").read_text(encoding="utf-8").splitlines()
    rows = [*csv.DictReader(lines[1:])]
    assert lines[0].startswith("# freebeam map {") and len(rows) == np.size(found["load"])
    with xr.open_dataset(tmp_path / "map.nc", engine="h5netcdf") as stored:
        assert sorted(stored["load"].dims) == sorted(names)
        np.testing.assert_array_equal(stored["load"].values, found["load"])
        np.testing.assert_array_equal(stored["load"].values.ravel(), [float(row["load"]) for row in rows])
    for row, load, kind in zip(rows, np.ravel(found["load"]), np.ravel(found["kind"]), strict=True):
        there = {name: float(row[name]) for name in names}
        one = fb.critical_load(fb.column("beck"), 3, **there)
        assert one.load == pytest.approx(load, rel=1e-9) and one.kind == kind == row["kind"]


ONE_DAMPING = """
from freebeam_derive.notation import P, beta, t, x, y
from freebeam_derive.statement import Column, delta, integral

column = Column(
    name="one-damping",
    title="Pinned-pinned beam under a dead load, with external damping alone",
    T=integral(y.diff(t) ** 2) / 2,
    V=integral(y.diff(x, 2) ** 2) / 2,
    W_c=P * integral(y.diff(x) ** 2) / 2,
    dW_nc=-integral(beta * y.diff(t) * delta(y)),
    ends=("pinned", "pinned"),
)
"""


def test_a_column_with_one_damping_is_mapped(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    file = tmp_path / "one.py"
    file.write_text(ONE_DAMPING, encoding="utf-8")
    assert fb.column(file).damping == ("beta",)
    command = ["map", "--column", str(file), "--modes", "12", "--beta", "0.1", "1", "3", "--json"]
    assert cli.main(command) == 0
    assert np.allclose(json.loads(capsys.readouterr().out)["load"], math.pi**2, rtol=1e-12)


def test_an_own_parameter_has_no_unit_among_si_axes(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    axes = ["--axis", "eta", "0.6", "1", "2", "--alpha", "1e-3", "1e-2", "2", "--modes", "3", "--column", "beck"]
    beam = ["--bending-stiffness", "2e6", "--mass-per-length", "50", "--length", "20"]
    assert cli.main(["map", *axes, *beam, "--output", str(tmp_path / "map.nc"), "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    sizes = fb.column("beck").scales(2e6, 50, 20)
    bare = fb.critical_loads(fb.column("beck"), 3, np.array(found["alpha"])[:, None] / sizes["alpha"], eta=found["eta"])
    np.testing.assert_allclose(found["load"], bare.load * sizes["load"], rtol=1e-9)
    with xr.open_dataset(tmp_path / "map.nc", engine="h5netcdf") as stored:
        assert (stored["alpha"].attrs["units"], stored["eta"].attrs["units"]) == ("s", "1")


@pytest.mark.parametrize("suffix", [".nc", ".png"])
def test_an_output_that_cannot_be_is_refused_before_the_map_is_computed(
    suffix: str, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Exists, is a folder, lies in no folder, or the package that writes it is missing; nothing is left behind."""

    def computed(*_: object, **__: object) -> None:
        raise AssertionError("the map was computed")

    monkeypatch.setattr("freebeam.maps.labelled.solve_grid", computed)
    monkeypatch.chdir(tmp_path)
    Path(f"kept{suffix}").write_text("precious")
    Path(f"folder{suffix}").mkdir()

    def refused(*more: str) -> str:
        assert cli.main(["map", *GRID, *more]) == 2
        out, err = capsys.readouterr()
        assert out == "" and err.count("\n") == 1 and err.startswith("freebeam: ")
        return err

    assert "--force" in refused("--output", f"kept{suffix}")
    assert "is a folder" in refused("--output", f"folder{suffix}", "--force")
    assert "its folder does not exist" in refused("--output", f"no/such/map{suffix}")
    assert "its folder does not exist" in refused("--output", f"kept{suffix}/map{suffix}")
    for package in ("h5netcdf", "h5py", "xarray") if suffix == ".nc" else ("matplotlib", "xarray"):
        with monkeypatch.context() as patch:
            patch.setitem(sys.modules, package, None)
            says = refused("--output", f"map{suffix}")
            assert f"needs {package}, which is not installed: pip install 'freebeam[" in says
    assert sorted(x.name for x in tmp_path.iterdir()) == [f"folder{suffix}", f"kept{suffix}"]
    assert Path(f"kept{suffix}").read_text() == "precious"


def test_a_patch_is_stable_below_its_critical_load_and_not_beyond() -> None:
    """What makes a patch's load the first: its middle is looked at further below."""
    surface = surface_of(pencil.Pencil(*fb.column("beck", "modes").matrices(6)), 1000.0)
    surface.at(np.geomspace(1e-4, 1e-1, 40), np.full(40, 0.1))
    for leaf in [x for x in leaves(surface._root) if x.state == "flutter"][:5]:
        middle = [np.array([(a + b) / 2]) for a, b in zip(leaf.low, leaf.high, strict=True)]
        load = min(
            load
            for load in np.linspace(5, 200, 400).tolist()
            if (surface._eigenvalues(*middle, np.array([load])).real > 0).any()
        )
        assert surface._below(leaf, 0.98 * load) and not surface._below(leaf, 1.3 * load)


def test_the_change_along_a_boundary_is_relative() -> None:
    one, two = (SimpleNamespace(kind="flutter", load=load, frequency=2.0) for load in (100.0, 80.0))
    assert _change(one, two) == pytest.approx(0.2) == _change(two, one)  # type: ignore[arg-type]
    other = SimpleNamespace(kind="divergence", load=100.0, frequency=2.0)
    assert _change(one, one) == 0 and _change(one, other) == math.inf  # type: ignore[arg-type]
