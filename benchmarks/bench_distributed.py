"""A map in blocks on two workers against half the time of the same blocks one after the other.

The workers are there before the clock runs, with the settings of those that a map starts by itself, and every process
has its tables from a first run: both cost some seconds once. The bits are compared. Two processes without Dask that
compute half the map each, at the same time, tell what two cores of this machine are worth.
"""

from __future__ import annotations

import multiprocessing
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import dask
import numpy as np
from distributed import Client, LocalCluster

import freebeam as fb
from freebeam.maps.sweeps import LOCAL

CLAIM = "a map of 2,000 × 2,000 points, N = 8, in blocks of 250 × 2,000: overhead of Dask on two workers"
AXES: dict[str, Any] = {"alpha": np.geomspace(1e-6, 1e-1, 2000), "beta": np.geomspace(1e-2, 1, 2000)}
ROUNDS = 12


def mapped(scheduler: Any, rows: slice = slice(None)) -> Any:
    axes = {**AXES, "alpha": AXES["alpha"][rows]}
    return fb.stability_map(fb.column("free-free"), chunks={"alpha": 250}, scheduler=scheduler, **axes)


def work(rows: slice, turn: Any, done: Any) -> None:
    while turn.get():
        mapped("synchronous", rows)
        done.put(True)


@contextmanager
def halves() -> Iterator[Callable[[], None]]:
    """A function that has two processes compute half the map each."""
    context = multiprocessing.get_context("spawn")
    done: Any = context.Queue()
    turns: list[Any] = [context.Queue() for _ in range(2)]
    processes = [
        context.Process(target=work, args=(slice(1000 * k, 1000 * k + 1000), turn, done), daemon=True)
        for k, turn in enumerate(turns)
    ]

    def both() -> None:
        for turn in turns:
            turn.put(True)
        for _ in turns:
            done.get()

    for process in processes:
        process.start()
    try:
        yield both
    finally:
        for turn, process in zip(turns, processes, strict=True):
            turn.put(False)
            process.join()


def bench_two_workers(contender: Any, benchmark: Any) -> None:
    """In turn, the least of each: what else runs on the machine disturbs all."""
    with (
        halves() as both,
        dask.config.set(LOCAL),
        LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=":0", silence_logs=50) as cluster,
        Client(cluster, set_as_default=False) as client,
    ):
        ways: dict[str, Callable[[], Any]] = {
            "serial": lambda: mapped("synchronous"), "two workers": lambda: mapped(client), "halves": both
        }  # fmt: skip
        found = {name: way() for name, way in ways.items()}
        times: dict[str, list[float]] = {name: [] for name in ways}
        for _ in range(ROUNDS):
            for name, way in ways.items():
                start = time.perf_counter()
                found[name] = way()
                times[name].append(time.perf_counter() - start)
    serial, distributed, plain = (min(times[name]) for name in ways)
    same = all(
        found["serial"][name].values.tobytes() == found["two workers"][name].values.tobytes()
        for name in ("load", "frequency", "kind", "converged")
    )
    contender(CLAIM, "ours, two workers", lambda: None, rounds=1)
    error = (
        f"{distributed / (serial / 2) - 1:+.1%} of half the serial time, {distributed / plain - 1:+.1%} of two "
        f"processes without Dask, which take {plain:.3g} s; the same bits"
    )
    benchmark.extra_info.update(seconds=distributed, bound=1.05 * serial / 2, error=error)
    assert same


def bench_serial(contender: Any) -> None:
    contender(CLAIM, "one after the other", lambda: mapped("synchronous"), rounds=1)
