"""A critical load at N = 8: ours against a bracketing search and the paper's scan, all with `numpy.linalg.eigvals`."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import freebeam as fb
from freebeam.maps.surface import first_crossing
from freebeam_sym.stability import pencil

CASES = {
    "free-free, undamped": ("free-free", 0.0, 0.0),
    "free-free, α = 0.001, β = 0.1": ("free-free", 1e-3, 0.1),
    "free-free, α = 1e-6": ("free-free", 1e-6, 0.0),
    "free-free, α = 10": ("free-free", 10.0, 0.0),
    "free-free, β = 1000": ("free-free", 0.0, 1000.0),
    "beck, α = 0.001, β = 0.1": ("beck", 1e-3, 0.1),
    "beck, α = 10": ("beck", 10.0, 0.0),
    "beck, α = 10, β = 1000": ("beck", 10.0, 1000.0),
}
CLAIM = "a critical load at N = 8"
SEARCH = "a search from the matrices on, free-free, α = 0.001, β = 0.1"
FIRST = "the first question of a column, a critical load at N = 8"


def growth(name: str, alpha: float, beta: float) -> Callable[[float], float]:
    """Largest real part as a function of the load, from the state matrix of Eq. (25)."""
    system = fb.column(name).system(modes=8, alpha=alpha, beta=beta)
    mass = np.linalg.inv(system.M)
    E, H, C = mass @ system.E, mass @ system.H, mass @ system.C
    A = np.block([[np.zeros((8, 8)), np.eye(8)], [-E, -C]])

    def largest(load: float) -> float:
        A[8:, :8] = -(E + load * H)
        return float(np.linalg.eigvals(A).real.max())

    return largest


@pytest.mark.parametrize("case", CASES)
def bench_ours(contender: Any, case: str) -> None:
    name, alpha, beta = CASES[case]
    column = fb.column(name)
    reference = column_load(name, alpha, beta)
    for _ in range(60):  # a column's first few questions are computed each, then tabulated
        fb.critical_load(column, modes=8, alpha=alpha, beta=beta)
    contender(
        CLAIM,
        f"ours, {case}",
        lambda: fb.critical_load(column, modes=8, alpha=alpha, beta=beta).load,
        error=lambda load: f"{abs(load / reference - 1):.0e} from a bisection to 1e-13",
        bound=5e-4,
    )


@pytest.mark.parametrize("case", CASES)
def bench_ours_first(contender: Any, case: str) -> None:
    """Nothing is kept of the column's matrices."""
    name, alpha, beta = CASES[case]
    column = fb.column(name)

    def first() -> Any:
        pencil._kept.cache_clear()
        return fb.critical_load(column, modes=8, alpha=alpha, beta=beta).load

    reference = column_load(name, alpha, beta)
    contender(FIRST, f"ours, {case}", first, error=lambda load: f"{abs(load / reference - 1):.0e} from a bisection")


@pytest.mark.parametrize(("modes", "bound"), [(8, 1e-3), (16, 2e-3), (32, 3e-3)])
def bench_ours_of_a_new_pencil(contender: Any, modes: int, bound: float) -> None:
    """The search by itself, from the matrices on: free-free at the dampings of section 4.4."""
    matrices = fb.column("free-free").matrices(modes)

    def search() -> float:
        found = first_crossing(pencil.Pencil(*matrices), 1e-3, 0.1)
        assert found is not None
        return found.load

    contender(SEARCH, f"ours, N = {modes}", search, bound=bound)


def column_load(name: str, alpha: float, beta: float) -> float:
    """Bisection of the largest real part after a scan in steps of 1; undamped growth is told from rounding at 1e-6."""
    largest, threshold = growth(name, alpha, beta), 1e-6 if alpha == beta == 0 else 0.0
    high = next(float(p) for p in range(1, 2000) if largest(p) > threshold)
    low = high - 1
    while high - low > 1e-13 * high:
        middle = (low + high) / 2
        if not low < middle < high:
            break
        low, high = (low, middle) if largest(middle) > threshold else (middle, high)
    return high


def bench_bracket_and_bisection(contender: Any) -> None:
    """Steps of 5, then bisection to ten digits; the case of section 4.4."""
    largest = growth("free-free", 1e-3, 0.1)

    def search() -> float:
        high = 5.0
        while largest(high) <= 0:
            high += 5
        low = high - 5
        while high - low > 1e-10 * high:
            middle = (low + high) / 2
            low, high = (low, middle) if largest(middle) > 0 else (middle, high)
        return high

    reference = column_load("free-free", 1e-3, 0.1)
    contender(
        CLAIM,
        "bracket and bisection with eigvals, free-free, α = 0.001, β = 0.1",
        search,
        error=lambda load: f"{abs(load / reference - 1):.0e}",
    )


def bench_scan_of_the_paper(contender: Any) -> None:
    """Steps of 0.1 until a real part turns positive: one digit after the point."""
    largest = growth("free-free", 1e-3, 0.1)
    contender(
        CLAIM,
        "the paper's scan, free-free, α = 0.001, β = 0.1",
        lambda: next(n / 10 for n in range(1, 20000) if largest(n / 10) > 0),
        error=lambda load: f"{load:.1f}",
        rounds=3,
    )
