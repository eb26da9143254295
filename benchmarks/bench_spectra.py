"""What a spectrum costs as N grows: ours beside the pencil of twice the size, given to SciPy as it stands."""

from __future__ import annotations

import time
from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
import pytest
from scipy.linalg import eigvals

import freebeam as fb

GROWTH = "cost in N of a spectrum"
MODES = (25, 50, 100, 200)
STATE = {"alpha": 1e-3, "beta": 0.1}
LOAD = 50.0


def ours(modes: int) -> Callable[[], Any]:
    """A column that nothing is kept of: its roots and matrices are in the time."""
    return lambda: fb.eigenvalues(fb.column("free-free"), load=LOAD, modes=modes, **STATE)


@cache
def least(modes: int) -> float:
    """Least time of a spectrum."""
    make, best = ours(modes), np.inf
    for _ in range(10):
        start = time.perf_counter()
        make()
        best = min(best, time.perf_counter() - start)
    return float(best)


def off(values: Any, modes: int) -> str:
    """Backward error of the four slowest: σ of λ²M + λC + K, of the sizes of its terms."""
    M, E, H = fb.column("free-free").matrices(modes)
    C, K = STATE["alpha"] * E + STATE["beta"] * M, E + LOAD * H
    worst = 0.0
    for lam in sorted(values, key=abs)[:4]:
        size = abs(lam) ** 2 * np.linalg.norm(M, 2) + abs(lam) * np.linalg.norm(C, 2) + np.linalg.norm(K, 2)
        worst = max(worst, np.linalg.svd(lam**2 * M + lam * C + K, compute_uv=False)[-1] / size)
    return f"{worst:.0e} backward"


@pytest.mark.parametrize("modes", MODES)
def bench_cost_in_modes(contender: Any, benchmark: Any, modes: int) -> None:
    """Promised: no faster than N³, from the first N on."""
    first = MODES[0]
    bound = {"bound": least(first) * (modes / first) ** 3} if modes > first else {}
    contender(GROWTH, f"ours, N = {modes}", ours(modes), error=lambda values: off(values, modes), rounds=15, **bound)
    benchmark.extra_info.update(modes=modes, seconds=benchmark.stats.stats.min)


@pytest.mark.parametrize("modes", MODES[1:3])
def bench_pencil_of_twice_the_size(contender: Any, modes: int) -> None:
    """scipy.linalg.eigvals of (A, B) with M in B: no M⁻¹, matrices at hand."""
    M, E, H = fb.column("free-free").matrices(modes)
    C, K, one, none = STATE["alpha"] * E + STATE["beta"] * M, E + LOAD * H, np.eye(modes), np.zeros((modes, modes))
    A, B = np.block([[none, one], [-K, -C]]), np.block([[one, none], [none, M]])
    name = f"scipy.linalg.eigvals of the pencil, N = {modes}"
    contender(GROWTH, name, lambda: eigvals(A, B), error=lambda values: off(values, modes), rounds=3)
