"""Stability maps over both dampings: ours against the ways that a user has today, on the same grid.

Ours starts from nothing each time but the column's matrices: pencil, surface of first crossings, its guard and the
labelled dataset are in the time. The peers are slow: they do every k-th point, and their time is scaled to all.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
import pytest
from scipy.optimize import brentq

import freebeam as fb
from freebeam.maps.surface import first_crossing
from freebeam_sym.stability import pencil

CLAIM = "a map of 100 × 100 points at N = 8, α from 1e-6 to 0.1, β from 0.01 to 1"
LARGE = "a map of 1000 × 1000 points at N = 8, the same ranges"
GROWTH = "cost in N of a map of 100 × 100 points"


def axes(count: int) -> dict[str, Any]:
    return {"alpha": np.geomspace(1e-6, 1e-1, count), "beta": np.geomspace(1e-2, 1.0, count)}


def ours(name: str, count: int, modes: int = 8, convergence: bool = False) -> Callable[[], Any]:
    column, grid = fb.column(name), axes(count)
    fb.stability_map(column, 2, alpha=[0.1], beta=[0.1])  # imports xarray

    def make() -> Any:
        pencil._kept.cache_clear()
        return fb.stability_map(column, modes, convergence=convergence, **grid)

    return make


def off(found: Any, name: str, points: int = 60) -> str:
    """Greatest error at random points against the search, which shares no series with the map."""
    rng, worst = np.random.default_rng(1), 0.0
    one = pencil.Pencil(*fb.column(name).matrices(int(found.attrs["modes"])))
    for _ in range(points):
        i, j = (int(rng.integers(len(found[x]))) for x in ("alpha", "beta"))
        reference = first_crossing(one, float(found["alpha"][i]), float(found["beta"][j]))
        assert reference is not None
        worst = max(worst, abs(float(found["load"].values[i, j]) / reference.load - 1))
    return f"{worst:.0e} from the search, {points} points"


@pytest.mark.parametrize("name", ["free-free", "beck"])
def bench_ours(contender: Any, name: str) -> None:
    bound = {"bound": 30e-3} if name == "free-free" else {}
    contender(CLAIM, f"ours, {name}", ours(name, 100), error=lambda found: off(found, name), **bound)


def bench_ours_with_convergence(contender: Any) -> None:
    """The verdict on N takes a second map, at 16 modes."""
    contender(CLAIM, "ours, free-free, with the verdict on N", ours("free-free", 100, convergence=True), rounds=5)


def bench_ours_large(contender: Any) -> None:
    make = ours("free-free", 1000)
    contender(LARGE, "ours, free-free", make, error=lambda found: off(found, "free-free"), bound=2.0, rounds=5)


@pytest.mark.parametrize("modes", [8, 16, 32, 64])
def bench_cost_in_modes(contender: Any, benchmark: Any, modes: int) -> None:
    """Promised: no faster than N³, from N = 8 on."""
    bound = {"bound": eight() * (modes / 8) ** 3} if modes > 8 else {}
    make = ours("free-free", 100, modes)
    contender(GROWTH, f"ours, N = {modes}", make, error=lambda found: off(found, "free-free", 5), rounds=5, **bound)
    benchmark.extra_info.update(modes=modes, seconds=benchmark.stats.stats.min)


@cache
def eight() -> float:
    """Least time of a map at N = 8."""
    make, best = ours("free-free", 100), np.inf
    for _ in range(5):
        start = time.perf_counter()
        make()
        best = min(best, time.perf_counter() - start)
    return float(best)


# --- peers -------------------------------------------------------------------------------------------------------


@cache
def blocks() -> tuple[np.ndarray, np.ndarray]:
    """M⁻¹E and M⁻¹H of the free-free column."""
    M, E, H = fb.column("free-free").matrices(8)
    return np.linalg.solve(M, E), np.linalg.solve(M, H)


def growth(alpha: np.ndarray, beta: np.ndarray, load: np.ndarray) -> np.ndarray:
    """Largest real part of the state matrices of Eq. (25), (n,)."""
    E, H = blocks()
    A = np.zeros((len(load), 16, 16))
    A[:, :8, 8:] = np.eye(8)
    A[:, 8:, :8] = -(E + load[:, None, None] * H)
    A[:, 8:, 8:] = -(beta[:, None, None] * np.eye(8) + alpha[:, None, None] * E)
    return np.linalg.eigvals(A).real.max(axis=1)


def scaled(contender: Any, benchmark: Any, name: str, stride: int, solve: Callable[[Any, Any], Any]) -> None:
    """Time `solve` on every stride-th point and scale to all."""
    grid = axes(100)
    alpha, beta = (x.ravel()[::stride] for x in np.meshgrid(grid["alpha"], grid["beta"], indexing="ij"))
    one = pencil.Pencil(*fb.column("free-free").matrices(8))

    def error(found: Any) -> str:
        pairs = zip(found, (first_crossing(one, a, b) for a, b in zip(alpha, beta, strict=True)), strict=True)
        return f"{max(abs(load / right.load - 1) for load, right in pairs if right):.0e}, {len(found)} points"

    contender(CLAIM, f"{name}, every {stride}th point scaled", lambda: solve(alpha, beta), error=error, rounds=1)
    benchmark.extra_info["seconds"] = benchmark.stats.stats.min * stride


def bench_batched_eigvals(contender: Any, benchmark: Any) -> None:
    """Steps of 5 for all points at once, then bisection to ten digits."""

    def solve(alpha: Any, beta: Any) -> Any:
        high = np.full(len(alpha), 5.0)
        while (stable := growth(alpha, beta, high) <= 0).any():
            high[stable] += 5
        low = high - 5
        for _ in range(36):
            middle = (low + high) / 2
            grows = growth(alpha, beta, middle) > 0
            low, high = np.where(grows, low, middle), np.where(grows, middle, high)
        return high

    scaled(contender, benchmark, "batched eigvals with bisection", 37, solve)


def bench_bracket_and_brent(contender: Any, benchmark: Any) -> None:
    """Point by point: steps of 5, then Brent's method."""

    def solve(alpha: Any, beta: Any) -> list[float]:
        loads = []
        for a, b in zip(alpha, beta, strict=True):
            at = lambda P, a=a, b=b: float(growth(np.array([a]), np.array([b]), np.array([P]))[0])  # noqa: E731
            high = 5.0
            while at(high) <= 0:
                high += 5
            loads.append(brentq(at, high - 5, high, xtol=1e-10))
        return loads

    scaled(contender, benchmark, "bracket and Brent's method with eigvals", 251, solve)


def bench_scan_of_the_paper(contender: Any, benchmark: Any) -> None:
    """Steps of 0.1 until a real part turns positive."""

    def solve(alpha: Any, beta: Any) -> list[float]:
        return [
            next(n / 10 for n in range(1, 20000) if growth(np.array([a]), np.array([b]), np.array([n / 10]))[0] > 0)
            for a, b in zip(alpha, beta, strict=True)
        ]

    scaled(contender, benchmark, "the paper's scan", 2503, solve)
