"""Stability maps: critical loads over a grid of parameters as a labelled dataset. Section 3.2."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Mapping, Sequence
from functools import cache
from importlib import import_module
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from freebeam.maps.arrays import checked_axes, record
from freebeam.maps.grid import solve_grid
from freebeam.maps.verdict import verdict
from freebeam_sym.checks import InputError, count
from freebeam_sym.columns import Column
from freebeam_sym.question import Question
from freebeam_sym.stability.convergence import CONVERGED, KINDS, Answers

if TYPE_CHECKING:
    import xarray
    from distributed import Client

__all__ = ["Solved", "dataset", "labels", "program", "solved", "split", "stability_map"]

_MEANINGS = {"alpha": "internal damping", "beta": "external damping"}
_BYTES = 200
"""Memory that a point of a map takes while it is computed, at most."""


def stability_map(
    column: Column,
    modes: int | None = None,
    *,
    load_max: float = 1000.0,
    convergence: bool = True,
    step: Callable[[float], None] | None = None,
    chunks: int | Sequence[int] | Mapping[str, int] | None = None,
    scheduler: str | Client | None = None,
    workers: int | None = None,
    store: str | os.PathLike[str] | None = None,
    **parameters: ArrayLike,
) -> xarray.Dataset:
    """First loss of stability over a grid of any of alpha, beta and the column's own parameters. Section 3.2.

    Parameters given as arrays (n_k,) are the axes, in the order given, of the dataset's variables; those given as
    numbers are fixed, and those not given are 0 (damping) or at their default.

    >>> import numpy as np
    >>> import freebeam as fb
    >>> found = fb.stability_map(fb.column("free-free"), alpha=np.logspace(-6, -1, 20), beta=np.logspace(-2, 0, 10))
    >>> found["load"].dims, found["load"].shape
    (('alpha', 'beta'), (20, 10))
    >>> float(found["load"].sel(alpha=1e-6, beta=1e-2, method="nearest").round(3))
    109.224

    Variables: `load` and `frequency` (nan where there is none up to `load_max`; frequency 0 in divergence), `kind`
    (int8: 0 none, 1 flutter, 2 divergence, as its attributes say) and, with `convergence`, `error`: the load's
    estimated error against the beam itself, relative (nan where there is none to compare), and `converged`: whether
    the beam loses stability alike and the error is 1e-3 at most; series of polynomials are then computed too.
    Attributes hold the settings. All nondimensional. `found.to_netcdf(path, engine="h5netcdf")` saves it.
    `step` is told which part of the work is done, 0 to 1. Needs xarray (the extra "maps").

    With `chunks` the map is computed in blocks, of so many values along each axis (or along one axis each), on Dask
    (the extra "distributed"): `scheduler` is a client of any cluster, "processes" or "threads" of this machine, as
    many as `workers` says, or "synchronous": here, one after the other, without Dask. None is the current client, or
    processes where there is none (which need a main module that may be imported). The same blocks give the same bits
    everywhere. `store`: a folder, new or left by a run of the same settings, which holds finished blocks as a Zarr
    group; they are not computed again.

    Raises InputError for bad values, for axes that are not one-dimensional, without two values or not distinct, for a
    map that memory has no room for, for chunks that do not fit, and for a store of other settings.
    """
    question, axes = split(column, modes, parameters, load_max)
    labels()  # said now, not when all is computed
    return dataset(solved(question, axes, convergence, step, chunks, scheduler, workers, store))


class Solved(NamedTuple):
    """A map's arrays, each of the shape of the axes; without a verdict on convergence, `error` and `converged` are
    None. question: what was asked, but for the axes."""

    question: Question
    axes: dict[str, NDArray[np.float64]]
    answers: Answers
    error: NDArray[np.float64] | None
    converged: NDArray[np.bool_] | None

    @property
    def fixed(self) -> dict[str, float]:
        """The parameters that are no axes."""
        return {name: value for name, value in self.question.values.items() if name not in self.axes}


def solved(
    question: Question,
    axes: dict[str, NDArray[np.float64]],
    convergence: bool = True,
    step: Callable[[float], None] | None = None,
    chunks: Any = None,
    scheduler: Any = None,
    workers: int | None = None,
    store: str | os.PathLike[str] | None = None,
) -> Solved:
    """A map as arrays, which need no xarray; all else as in `stability_map`."""
    if chunks is not None:
        from freebeam.maps.sweeps import Sweep, chunk_sizes, run

        values = run(Sweep(question, axes, convergence, chunk_sizes(chunks, axes)), scheduler, workers, store, step)
        answers = Answers(*(values[name] for name in Answers._fields))
        return Solved(question, axes, answers, values.get("error"), values.get("converged"))
    for name, given in (("scheduler", scheduler), ("workers", workers), ("store", store)):
        if given is not None:
            raise InputError(f"{name} needs chunks: values along an axis in a block of the map, such as chunks=100")
    # the polynomials of the verdict cost some five times as much as the map
    done = (lambda x: step(x / 6 if convergence else x)) if step is not None else None
    found = solve_grid(question, axes, done)
    if not convergence:
        return Solved(question, axes, found, None, None)
    later = (lambda x: step((1 + 5 * x) / 6)) if step is not None else None
    return Solved(question, axes, found, *verdict(question, axes, found, later))


def split(
    column: Column, modes: int | None, parameters: Mapping[str, Any], load_max: float = 1000.0
) -> tuple[Question, dict[str, NDArray[np.float64]]]:
    """The question that a map asks, and its axes, each (n_k,): the parameters given as arrays. Raises InputError."""
    values = checked_axes(column, parameters)
    axes = {name: array for name, array in values.items() if array.ndim}
    fixed: dict[str, Any] = {name: float(array) for name, array in values.items() if not array.ndim}
    question = Question.of(column, modes, load_max=load_max, **fixed)
    for name, array in axes.items():
        if array.ndim != 1 or not len(array):
            raise InputError(f"{name} has the shape {array.shape}: an axis of a map is a sequence of one value or more")
        if len(np.unique(array)) != len(array):
            raise InputError(f"{name}: the values of an axis must be distinct")
    if not axes:
        raise InputError("a map needs an axis: give alpha, beta or a parameter of the column as an array")
    counted([len(array) for array in axes.values()])
    return question, axes


def counted(lengths: Sequence[int]) -> int:
    """The points of a map whose axes have these lengths. Raises InputError where memory has no room for them."""
    most = int(4e9 / _BYTES)
    return count("points of the map", math.prod(lengths), 1, most, "cut the grid and compute the parts one by one")


def dataset(solved: Solved) -> xarray.Dataset:
    """The labelled dataset of a map. Raises InputError without xarray."""
    question, axes, found, error, converged = solved
    column = question.column
    meanings = _MEANINGS | {p.name: p.meaning for p in column.parameters}
    names = list(axes)
    variables = {
        "load": (names, found.load, {"long_name": "critical load P", "units": "1"}),
        "frequency": (names, found.frequency, {"long_name": "frequency at the critical load", "units": "1"}),
        "kind": (
            names,
            found.kind,
            {
                "long_name": "kind of the loss of stability",
                "flag_values": np.arange(len(KINDS), dtype=np.int8),
                "flag_meanings": " ".join(KINDS),
            },
        ),
    }
    if error is not None and converged is not None:
        against = "against the beam itself"
        variables["error"] = (names, error, {"long_name": f"relative error of the load {against}", "units": "1"})
        alike = {"long_name": f"converged {against}", "tolerance": CONVERGED}
        variables["converged"] = (names, converged, alike)
    coordinates = {x: (x, axes[x], {"long_name": meanings[x], "units": "1"}) for x in names}
    settings = {
        "title": f"Critical loads of the column {column.name}",
        **record(question),
        "column_title": column.title,
        **solved.fixed,
        "fixed": " ".join(solved.fixed),
        "units": "nondimensional, Eq. (5)",
        "source": f"freebeam {program()}",
    }
    labelled: xarray.Dataset = labels().Dataset(variables, coordinates, settings)
    return labelled


def labels() -> Any:
    """The package that holds a map. Raises InputError without it."""
    try:
        return import_module("xarray")
    except ImportError:
        raise InputError("a map needs xarray, which is not installed: pip install 'freebeam[maps]'") from None


@cache
def program() -> str:
    from importlib.metadata import PackageNotFoundError, version

    try:
        return version("freebeam")
    except PackageNotFoundError:
        return "unknown"
