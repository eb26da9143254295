"""Maps in blocks: one after the other or on Dask, and kept in a store that a run that was stopped goes on from.

The axes are cut into blocks, and each block is a call of `solve_grid` of its own, so that the bits do not depend on
where or when it ran. Workers of this machine leave blocks in memory that they share with this process; from others
they come over the network. This process alone writes the store: first the block's arrays, then its mark.
"""

from __future__ import annotations

import hashlib
import math
import os
import shutil
import tempfile
import uuid
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import partial
from importlib import import_module
from itertools import islice, product
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from freebeam.maps.arrays import record
from freebeam.maps.grid import solve_grid
from freebeam.maps.verdict import verdict
from freebeam_sym.checks import InputError, count, refusal
from freebeam_sym.kernels import text_of
from freebeam_sym.question import Question

if TYPE_CHECKING:
    from distributed import Client

Block = tuple[slice, ...]
Values = dict[str, NDArray[Any]]

CURE = "pip install 'freebeam[distributed]'"
LOCAL = {
    "distributed.nanny.pre-spawn-environ.MALLOC_MMAP_THRESHOLD_": 2**25,
    "distributed.nanny.pre-spawn-environ.MALLOC_TRIM_THRESHOLD_": 2**28,
    "distributed.worker.profile.enabled": False,
    "distributed.worker.memory.monitor-interval": "1s",
    "distributed.admin.tick.interval": "500ms",
    "distributed.admin.system-monitor.gil.enabled": False,
}
"""Dask's settings for workers of this machine: by default they give all memory back after each array, which costs a
block a quarter of its time, and watch themselves a hundred times a second."""
SHARED = Path("/dev/shm")
"""Memory as a folder, on Linux."""
SCHEDULERS = ("synchronous", "threads", "processes")
TYPES = {"load": np.float64, "frequency": np.float64, "kind": np.int8, "error": np.float64, "converged": np.bool_}


@dataclass(frozen=True)
class Sweep:
    """What is asked of a map: all that its numbers hang on, the axes (name: (n_k,)) in order."""

    question: Question
    axes: Mapping[str, NDArray[np.float64]]
    convergence: bool
    chunks: tuple[int, ...]

    @property
    def shape(self) -> tuple[int, ...]:
        return tuple(len(axis) for axis in self.axes.values())

    @property
    def variables(self) -> tuple[str, ...]:
        return tuple(TYPES)[: None if self.convergence else -2]

    def blocks(self) -> list[Block]:
        """The parts of the map, in the order of its axes; the last ones along an axis may be smaller."""
        cuts = [[slice(a, min(a + k, n)) for a in range(0, n, k)] for n, k in zip(self.shape, self.chunks, strict=True)]
        return list(product(*cuts))

    def part(self, block: Block) -> Sweep:
        """The map of a block."""
        axes = {name: axis[part] for (name, axis), part in zip(self.axes.items(), block, strict=True)}
        return replace(self, axes=axes)

    def computed(self) -> Values:
        """The map's arrays, by name, computed here and at once."""
        found = solve_grid(self.question, self.axes)
        values: Values = found._asdict()
        if self.convergence:
            values["error"], values["converged"] = verdict(self.question, self.axes, found)
        return values

    def settings(self) -> dict[str, Any]:
        """The same as a record that can be compared and stored."""
        from importlib.metadata import version

        return {
            **record(self.question),
            "kernel": _print(text_of(self.question.column.kernel).encode()),
            "convergence": self.convergence,
            "fixed": {name: value for name, value in self.question.values.items() if name not in self.axes},
            "axes": {
                name: f"{len(axis)} values from {axis[0]} to {axis[-1]}, {_print(axis.tobytes())}"
                for name, axis in self.axes.items()
            },
            "chunks": list(self.chunks),
            "freebeam": version("freebeam"),
        }


def chunk_sizes(chunks: Any, axes: Mapping[str, Any]) -> tuple[int, ...]:
    """Values of each axis in a block. One number serves all axes, of which shorter ones are not cut; or one an axis.

    Raises InputError for sizes that are not whole, below one, or larger than their axis.
    """
    lengths = {name: len(axis) for name, axis in axes.items()}
    if isinstance(chunks, Mapping):
        for name in chunks:
            if name not in lengths:
                raise InputError(f"chunks[{name!r}]: is no axis of this map; its axes are {', '.join(lengths)}")
        return tuple(
            count(f"chunks[{name!r}]", chunks.get(name, n), 1, n, f"values of {name}") for name, n in lengths.items()
        )
    if isinstance(chunks, Sequence) and not isinstance(chunks, str):
        if len(chunks) != len(lengths):
            raise refusal("chunks", chunks, f"must be one number, or one of each axis: {', '.join(lengths)}")
        return chunk_sizes(dict(zip(lengths, chunks, strict=True)), axes)
    size = count("chunks", chunks, 1, max(lengths.values()), "values of the longest axis in a block")
    return tuple(min(size, n) for n in lengths.values())


def _flat(settings: Mapping[str, Any]) -> dict[str, Any]:
    """Settings with those of an axis or of a fixed parameter by themselves."""
    parts = [value.items() if isinstance(value, Mapping) else [(name, value)] for name, value in settings.items()]
    return {name: value for part in parts for name, value in part}


def _print(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()[:16]


# --- a block ------------------------------------------------------------------------------------------------------


def left(place: str | None, item: tuple[str, Sweep]) -> Values | None:
    """Put the arrays of a block into a file in memory, of a name; they come back where there is no room."""
    name, sweep = item
    values = sweep.computed()
    if place is None:
        return values
    beside = Path(place, uuid.uuid4().hex)
    try:
        with open(beside, "xb") as file:
            for array in values.values():
                file.write(array.data)
        os.replace(beside, Path(place, name))
    except OSError:
        beside.unlink(missing_ok=True)
        return values
    return None


def taken(path: Path, sweep: Sweep, block: Block) -> Values:
    """The arrays of a block that were `left`; the file goes with them."""
    content = np.memmap(path, np.uint8, "r")
    os.unlink(path)
    shape = [part.stop - part.start for part in block]
    sizes = [math.prod(shape) * np.dtype(TYPES[name]).itemsize for name in sweep.variables]
    parts = np.split(content, np.cumsum(sizes)[:-1])
    return {name: part.view(TYPES[name]).reshape(shape) for name, part in zip(sweep.variables, parts, strict=True)}


# --- where blocks run ---------------------------------------------------------------------------------------------


def run(
    sweep: Sweep,
    scheduler: str | Client | None = None,
    workers: int | None = None,
    store: str | os.PathLike[str] | None = None,
    step: Callable[[float], None] | None = None,
) -> Values:
    """All blocks of a map, put together. Those that a store holds are read, not computed.

    scheduler: "synchronous" (here, one after the other), "threads" or "processes" (of a cluster on this machine, with
    as many `workers`, made for the while), or a client of any Dask cluster; None is the current client, or processes
    where there is none. step: told which part is done, 0 to 1.

    Raises InputError for what makes no sense, for a store of other settings and without Dask.
    """
    _checked(scheduler, workers)
    kept = None if store is None else Store(Path(store), sweep)
    values: Values = {name: np.empty(sweep.shape, dtype=TYPES[name]) for name in sweep.variables}
    blocks = sweep.blocks()
    todo = [k for k, block in enumerate(blocks) if kept is None or not kept.read(k, block, values)]
    done = len(blocks) - len(todo)
    if step is not None:
        step(done / len(blocks))
    for k, found in _computed(sweep, {k: blocks[k] for k in todo}, scheduler, workers):
        for name, array in found.items():
            values[name][blocks[k]] = array
        if kept is not None:
            kept.write(k, blocks[k], found)
        done += 1
        if step is not None:
            step(done / len(blocks))
    return values


def _checked(scheduler: Any, workers: Any) -> None:
    if isinstance(scheduler, str) and scheduler not in SCHEDULERS:
        raise refusal("scheduler", scheduler, f"must be one of {', '.join(SCHEDULERS)}, or a Dask client")
    if workers is not None:
        count("workers", workers, 1, hint="processes or threads")
        if scheduler == "synchronous" or not isinstance(scheduler, str | None):
            raise InputError(f"workers = {workers}: are those of threads or processes on this machine; leave it out")


def _computed(
    sweep: Sweep,
    todo: Mapping[int, Block],
    scheduler: str | Client | None,
    workers: int | None,
) -> Iterator[tuple[int, Values]]:
    """Blocks by number, as they are finished."""
    if not todo:
        return
    if scheduler == "synchronous":
        for k, block in todo.items():
            yield k, sweep.part(block).computed()
        return
    try:
        distributed: Any = import_module("distributed")
    except ImportError:
        raise InputError(f'chunks need Dask, which is not installed: {CURE}, or scheduler="synchronous"') from None
    with _client(scheduler, workers, len(todo)) as client, _place(client) as place:
        name = f"freebeam-map-{uuid.uuid4().hex}"
        numbers = {f"{name}-{k}": k for k in todo}
        waiting = iter(numbers.items())

        def submitted(most: int) -> list[Any]:
            keys = dict(islice(waiting, most))
            items = [(key, sweep.part(todo[k])) for key, k in keys.items()]
            found: list[Any] = client.map(partial(left, place), items, key=list(keys), pure=False) if items else []
            return found

        # A few blocks wait at each worker; results do not pile up there. Lots of them are submitted at a time.
        lot = 2 * max(1, sum(client.nthreads().values()))
        futures = set(submitted(2 * lot))
        running = distributed.as_completed(list(futures), loop=client.loop)
        try:
            for future in running:
                futures.discard(future)
                if len(futures) <= lot:
                    futures.update(new := submitted(lot))
                    running.update(new)
                k = numbers[future.key]
                file = Path(place or "", future.key)
                try:  # a block that was left outlives its worker
                    found = None if place is not None and file.exists() else future.result()
                except distributed.KilledWorker:
                    places = zip(sweep.axes, todo[k], strict=True)
                    where = ", ".join(f"{x}[{part.start}:{part.stop}]" for x, part in places)
                    raise InputError(
                        f"block {where}: its workers died, one after another; memory may be short: take smaller chunks "
                        "or fewer workers"
                    ) from None
                yield k, taken(file, sweep, todo[k]) if found is None else found
        finally:
            client.cancel(list(futures))


@contextmanager
def _client(scheduler: str | Client | None, workers: int | None, blocks: int) -> Iterator[Any]:
    distributed: Any = import_module("distributed")
    here: Any = scheduler

    if here is None and workers is None:
        try:
            here = distributed.Client.current()
        except ValueError:  # there is none
            here = "processes"
    if not isinstance(here, str | None):
        if not isinstance(here, distributed.Client) or here.asynchronous:
            raise refusal("scheduler", scheduler, f"must be one of {', '.join(SCHEDULERS)}, or a Dask client")
        yield here
        return
    number = min(workers or os.cpu_count() or 1, blocks)
    processes = here != "threads"
    with (
        import_module("dask").config.set(LOCAL),
        distributed.LocalCluster(
            n_workers=number if processes else 1,
            threads_per_worker=1 if processes else number,
            processes=processes,
            dashboard_address=":0",
        ) as cluster,
        distributed.Client(cluster, set_as_default=False) as client,
    ):
        yield client


@contextmanager
def _place(client: Any) -> Iterator[str | None]:
    """A folder of memory in which workers of this machine may leave blocks; None where they cannot."""
    here = isinstance(client.cluster, import_module("distributed").LocalCluster) and client.cluster.processes
    if here and os.access(SHARED, os.W_OK):
        with tempfile.TemporaryDirectory(dir=SHARED, prefix="freebeam-map-", ignore_cleanup_errors=True) as place:
            yield place
    else:
        yield None


# --- the store ----------------------------------------------------------------------------------------------------


class Store:
    """A Zarr group on disk: the map's arrays and coordinates, its settings, and a mark for every finished block."""

    def __init__(self, path: Path, sweep: Sweep) -> None:
        try:
            import zarr
        except ImportError:
            raise InputError(f"a store needs zarr, which is not installed: {CURE}") from None
        self.path = path
        if not path.exists():
            self._create(path, sweep, zarr)
        try:
            self.group: Any = zarr.open_group(path, mode="r+", zarr_format=3)
            held: Any = self.group.attrs["settings"]
        except Exception:
            raise InputError(
                f"{path}: exists and is no store of a map; give another name, or delete it if it is of no use"
            ) from None
        held, wanted = _flat(held), _flat(sweep.settings())
        for name in (*wanted, *held):
            if held.get(name) != wanted.get(name):
                raise InputError(
                    f"{path}: holds a map with {name} = {held.get(name)}, and this one has {wanted.get(name)}; give "
                    "another store, or delete this one"
                )

    @staticmethod
    def _create(path: Path, sweep: Sweep, zarr: Any) -> None:
        try:
            beside = Path(tempfile.mkdtemp(dir=path.parent, prefix=f".{path.name}-"))
        except OSError as error:
            raise InputError(f"{path}: cannot be written ({error.strerror})") from None
        try:
            group = zarr.open_group(beside / "store", mode="w", zarr_format=3)
            group.attrs["settings"] = sweep.settings()
            for name in sweep.variables:
                group.create_array(
                    name,
                    shape=sweep.shape,
                    chunks=sweep.chunks,
                    dtype=TYPES[name],
                    fill_value=math.nan if TYPES[name] is np.float64 else 0,
                    dimension_names=list(sweep.axes),
                )
            for name, axis in sweep.axes.items():
                group.create_array(name, data=axis, dimension_names=[name])
            group.create_group("progress").create_array("done", shape=(len(sweep.blocks()),), chunks=(1,), dtype=bool)
            os.replace(beside / "store", path)
        except OSError as error:
            if not path.exists():  # else another run was first: its settings are looked at
                raise InputError(f"{path}: cannot be written ({error.strerror or error})") from None
        finally:
            shutil.rmtree(beside, ignore_errors=True)

    def read(self, k: int, block: Block, values: Values) -> bool:
        """Whether block k is finished; its arrays are copied then."""
        try:
            if not self.group["progress/done"][k]:
                return False
            for name, array in values.items():
                array[block] = self.group[name][block]
        except Exception:  # cut off in mid-write: as if it had not been
            return False
        return True

    def write(self, k: int, block: Block, found: Values) -> None:
        for name, array in found.items():
            self.group[name][block] = array
        self.group["progress/done"][k] = True
