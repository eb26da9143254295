"""A map in blocks on two workers against half the time of the same blocks one after the other.

The workers are there before the clock runs, with the settings of those that a map starts by itself, and every process
has its tables from a first run: both cost some seconds once. The bits are compared.
"""

from __future__ import annotations

import time
from typing import Any

import dask
import numpy as np
from distributed import Client, LocalCluster

import freebeam_sym as fb
from freebeam_sym.sweeps import LOCAL

CLAIM = "a map of 2,000 × 2,000 points, N = 8, in blocks of 500 × 500: overhead of Dask on two workers"
COLUMN = fb.column("free-free")
AXES: dict[str, Any] = {"alpha": np.geomspace(1e-6, 1e-1, 2000), "beta": np.geomspace(1e-2, 1, 2000)}


def mapped(scheduler: Any) -> Any:
    return fb.stability_map(COLUMN, chunks=500, scheduler=scheduler, **AXES)


def bench_two_workers(contender: Any, benchmark: Any) -> None:
    """Serial and distributed runs in turn, the least of each: what else runs on the machine disturbs both."""
    times: dict[str, list[float]] = {"serial": [], "two workers": []}
    found = {}
    with (
        dask.config.set(LOCAL),
        LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=":0", silence_logs=50) as cluster,
        Client(cluster, set_as_default=False) as client,
    ):
        mapped("synchronous"), mapped(client)
        for _ in range(6):
            for name, scheduler in (("serial", "synchronous"), ("two workers", client)):
                start = time.perf_counter()
                found[name] = mapped(scheduler)
                times[name].append(time.perf_counter() - start)
    serial, distributed = (min(values) for values in times.values())
    same = all(
        found["serial"][name].values.tobytes() == found["two workers"][name].values.tobytes()
        for name in ("load", "frequency", "kind", "converged")
    )
    contender(CLAIM, "ours, two workers", lambda: None, rounds=1)
    overhead = distributed / (serial / 2) - 1
    error = f"{overhead:+.1%} of half the serial time; the same bits"
    benchmark.extra_info.update(seconds=distributed, bound=1.05 * serial / 2, error=error)
    assert same


def bench_serial(contender: Any) -> None:
    contender(CLAIM, "one after the other", lambda: mapped("synchronous"), rounds=1)
