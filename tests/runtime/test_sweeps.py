"""Maps in blocks: the same bits wherever the blocks run, and no block twice."""

from __future__ import annotations

import json
import os
import pickle
import shutil
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray

import freebeam as fb
from freebeam.maps import sweeps
from freebeam_sym.checks import InputError

pytest.importorskip("distributed")
pytest.importorskip("zarr")

ALPHA, BETA = np.geomspace(1e-6, 1e-1, 11), np.geomspace(1e-2, 1, 7)
SETTINGS: dict[str, Any] = {"modes": 4, "alpha": ALPHA, "beta": BETA, "convergence": False, "chunks": (4, 3)}
BLOCKS = 9
SWEEP: Any = (fb.Question.of(fb.column("beck"), 4), {"alpha": ALPHA, "beta": BETA}, False, (4, 3))


def mapped(**options: Any) -> xarray.Dataset:
    return fb.stability_map(fb.column("beck"), **{**SETTINGS, "scheduler": "synchronous", **options})


def same_bits(one: xarray.Dataset, other: xarray.Dataset) -> bool:
    assert set(one.variables) == set(other.variables)
    return all(one[name].values.tobytes() == other[name].values.tobytes() for name in one.variables)


@pytest.fixture(scope="module")
def serial() -> xarray.Dataset:
    return mapped()


@pytest.fixture(scope="module")
def client() -> Iterator[Any]:
    """Two processes on this machine, which are replaced when they die."""
    from distributed import Client, LocalCluster

    with (
        LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=":0", silence_logs=50) as cluster,
        Client(cluster, set_as_default=False) as client,
    ):
        yield client


@pytest.fixture
def computed(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """Sizes of the blocks that are computed in this process."""
    sizes: list[int] = []
    solve_grid = sweeps.solve_grid

    def counted(*arguments: Any) -> Any:
        found = solve_grid(*arguments)
        sizes.append(found.load.size)
        return found

    monkeypatch.setattr(sweeps, "solve_grid", counted)
    return sizes


# Where blocks run


def test_blocks_agree_with_the_whole(serial: xarray.Dataset, computed: list[int]) -> None:
    whole = mapped(chunks=None, scheduler=None)
    np.testing.assert_allclose(serial["load"], whole["load"], rtol=1e-10)
    np.testing.assert_array_equal(serial["kind"], whole["kind"])
    assert serial.attrs == whole.attrs and serial["load"].dims == ("alpha", "beta")
    mapped()
    assert len(computed) == BLOCKS and sum(computed) == serial["load"].size and max(computed) == 12


def test_threads_give_the_same_bits(serial: xarray.Dataset) -> None:
    assert same_bits(mapped(scheduler="threads", workers=3), serial)


def test_a_cluster_gives_the_same_bits_though_a_worker_dies(
    serial: xarray.Dataset, client: Any, tmp_path: Path
) -> None:
    """One of two processes is killed once a block is back; progress goes on to the end."""
    told: list[float] = []

    def killing(share: float) -> None:
        told.append(share)
        if share > 0 and len(told) == 2:
            os.kill(next(iter(client.run(os.getpid).values())), signal.SIGKILL)

    found = mapped(scheduler=client, step=killing, store=tmp_path / "map.zarr")
    assert same_bits(found, serial)
    assert told == sorted(told) and told[0] == 0 and told[-1] == 1 and len(told) == BLOCKS + 1


@pytest.mark.parametrize("shared", [True, False])
def test_memory_that_is_shared_changes_no_bit_and_is_given_back(
    serial: xarray.Dataset, client: Any, monkeypatch: pytest.MonkeyPatch, tmp_path: Path, shared: bool
) -> None:
    """Any folder will do here: of a block's run only what the worker returns and what it leaves there can be seen."""
    monkeypatch.setattr(sweeps, "SHARED", tmp_path if shared else tmp_path / "none")
    read: list[Path] = []

    def taken(path: Path, *where: Any) -> Any:
        read.append(path)
        return original(path, *where)

    original = sweeps.taken
    monkeypatch.setattr(sweeps, "taken", taken)
    assert same_bits(mapped(scheduler=client), serial)
    assert len(read) == (BLOCKS if shared else 0) and all(tmp_path in path.parents for path in read)
    assert not list(tmp_path.iterdir())


def test_where_memory_has_no_room_blocks_come_back(serial: xarray.Dataset, tmp_path: Path) -> None:
    sweep = sweeps.Sweep(*SWEEP)
    values = sweeps.left(str(tmp_path / "gone"), ("block", sweep.part(sweep.blocks()[0])))
    assert values is not None and values["load"].tobytes() == serial["load"].values[:4, :3].tobytes()


def test_the_current_client_is_taken(serial: xarray.Dataset, client: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("distributed.LocalCluster.__init__", None)
    with client.as_current():
        assert same_bits(mapped(scheduler=None), serial)


def test_a_column_of_one_s_own_goes_with_its_source(serial: xarray.Dataset, client: Any, tmp_path: Path) -> None:
    """A kernel's file: its text is sent, so that no worker has to see the file."""
    file = tmp_path / "own.py"
    shutil.copy(fb.column("beck").kernel.__file__, file)
    own = fb.column(file)
    assert str(tmp_path).encode() not in pickle.dumps(own)
    assert same_bits(fb.stability_map(own, **SETTINGS, scheduler=client), serial)


def test_an_error_in_a_block_comes_back(client: Any) -> None:
    """As it was said there: memory has no room for so many modes."""
    axes = {"alpha": np.array([1e-3]), "beta": np.array([0.1, 0.2])}
    sweep = sweeps.Sweep(fb.Question(fb.column("beck"), 10**9), axes, False, (1, 1))
    said = []
    for scheduler in (client, "synchronous"):
        with pytest.raises(InputError, match="modes = 1000000000") as caught:
            sweeps.run(sweep, scheduler)
        said.append(str(caught.value))
    assert said[0] == said[1]


# The store


def test_a_killed_run_goes_on(serial: xarray.Dataset, tmp_path: Path, computed: list[int]) -> None:
    """SIGKILL in mid-run, after some blocks: these are read, the others computed, the bits are those of one run."""
    store = tmp_path / "map.zarr"
    code = (
        "import sys, time, numpy as np, freebeam as fb\n"
        "def step(share):\n"
        "    print(share, flush=True)\n"
        "    if share > 0.4: time.sleep(60)\n"
        "fb.stability_map(fb.column('beck'), modes=4, alpha=np.geomspace(1e-6, 1e-1, 11), "
        "beta=np.geomspace(1e-2, 1, 7), convergence=False, chunks=(4, 3), scheduler='synchronous', "
        f"store={str(store)!r}, step=step)\n"
    )
    with subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        for line in process.stdout:
            if float(line) > 0.4:
                break
        process.kill()
    told: list[float] = []
    assert same_bits(mapped(store=store, step=told.append), serial)
    assert len(computed) == 5 and told[0] == pytest.approx(4 / 9)
    assert same_bits(mapped(store=store), serial) and len(computed) == 5
    # and xarray reads it
    stored = xarray.open_zarr(store, consolidated=False)
    np.testing.assert_array_equal(stored["load"].values, serial["load"].values)
    np.testing.assert_array_equal(stored["alpha"].values, ALPHA)


def test_an_interrupted_run_goes_on(serial: xarray.Dataset, tmp_path: Path, computed: list[int]) -> None:
    def interrupt(share: float) -> None:
        if share > 0.5:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        mapped(store=tmp_path / "map.zarr", step=interrupt)
    assert len(computed) == 5
    assert same_bits(mapped(store=tmp_path / "map.zarr"), serial) and len(computed) == BLOCKS


def test_a_block_cut_off_in_mid_write_is_computed_again(
    serial: xarray.Dataset, tmp_path: Path, computed: list[int]
) -> None:
    """Without its mark, whatever its arrays hold; and where its array cannot be read."""
    store = tmp_path / "map.zarr"
    mapped(store=store)
    computed.clear()
    first, second = (store / "progress" / "done" / "c" / str(k) for k in (0, 1))
    first.unlink()
    (store / "load" / "c" / "0" / "0").write_bytes(b"torn")
    second.write_bytes(b"torn")
    assert same_bits(mapped(store=store), serial) and len(computed) == 2


@pytest.mark.parametrize(
    ("options", "difference"),
    [
        ({"modes": 5}, "modes = 4, and this one has 5"),
        ({"alpha": 2 * ALPHA}, "alpha = 11 values from 1e-06 .*, and this one has 11 values from 2e-06"),
        ({"chunks": (4, 4)}, r"chunks = \[4, 3\]"),
        ({"load_max": 500.0}, "load_max = 1000.0"),
        ({"convergence": True}, "convergence = False"),
        ({"eta": 0.9}, "eta = 1.0, and this one has 0.9"),
    ],
)
def test_a_store_of_other_settings_is_kept(
    serial: xarray.Dataset, tmp_path: Path, options: dict[str, Any], difference: str
) -> None:
    store = tmp_path / "map.zarr"
    mapped(store=store)
    with pytest.raises(InputError, match=difference) as caught:
        mapped(store=store, **options)
    assert "give another store, or delete this one" in str(caught.value) and "\n" not in str(caught.value)
    assert same_bits(mapped(store=store), serial)


def test_what_is_no_store_is_kept(tmp_path: Path) -> None:
    folder = tmp_path / "folder"
    folder.mkdir()
    (folder / "precious").write_text("precious", encoding="utf-8")
    for path in (folder, folder / "precious"):
        with pytest.raises(InputError, match="no store of a map"):
            mapped(store=path)
    assert [file.name for file in folder.iterdir()] == ["precious"]
    with pytest.raises(InputError, match="cannot be written"):
        mapped(store=tmp_path / "none" / "map.zarr")


# Bad input


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"chunks": 0}, "chunks = 0"),
        ({"chunks": 2.5}, "chunks = 2.5"),
        ({"chunks": 12}, "chunks = 12"),
        ({"chunks": "auto"}, "chunks"),
        ({"chunks": (4, 8)}, r"chunks\['beta'\] = 8"),
        ({"chunks": (4,)}, r"one of each axis: alpha, beta"),
        ({"chunks": {"eta": 1}}, r"chunks\['eta'\]: is no axis"),
        ({"scheduler": "cluster"}, "scheduler = 'cluster': must be one of synchronous, threads, processes"),
        ({"scheduler": 3}, "scheduler = 3"),
        ({"workers": 0, "scheduler": "threads"}, "workers = 0"),
        ({"workers": 2}, "leave it out"),
        ({"chunks": None, "store": "map.zarr", "scheduler": None}, "store needs chunks"),
        ({"chunks": None, "scheduler": "threads"}, "scheduler needs chunks"),
        ({"chunks": None, "scheduler": None, "workers": 2}, "workers needs chunks"),
    ],
)
def test_bad_input(options: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message) as caught:
        mapped(**options)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("package", ["distributed", "zarr"])
def test_what_is_not_installed_is_named(monkeypatch: pytest.MonkeyPatch, tmp_path: Path, package: str) -> None:
    monkeypatch.setitem(sys.modules, package, None)
    needed = "a store needs zarr" if package == "zarr" else "chunks need Dask"
    with pytest.raises(InputError, match=rf"{needed}, which is not installed: pip install 'freebeam\[distributed\]'"):
        mapped(scheduler="threads", store=tmp_path / "map.zarr" if package == "zarr" else None)


def test_chunks_of_one_number_leave_shorter_axes_whole() -> None:
    axes = {"alpha": ALPHA, "beta": BETA}
    assert sweeps.chunk_sizes(10, axes) == (10, 7)
    assert sweeps.chunk_sizes({"beta": 2}, axes) == (11, 2)


# The command


def test_the_command_goes_on_from_a_store(
    tmp_path: Path, computed: list[int], capsys: pytest.CaptureFixture[str]
) -> None:
    """Blocks kept by another run, here from Python, are those of the command: all is read, nothing computed."""
    from freebeam.cli import main

    whole = mapped(store=tmp_path / "map.zarr", chunks=4)
    computed.clear()
    axes = ["--alpha", "1e-6", "1e-1", "11", "--beta", "1e-2", "1", "7"]
    command = ["map", "--column", "beck", "--modes", "4", *axes, "--no-convergence", "--json"]
    assert main([*command, "--chunks", "4", "--store", str(tmp_path / "map.zarr")]) == 0
    assert json.loads(capsys.readouterr().out)["load"] == whole["load"].values.tolist() and not computed
    for wrong, says in (
        (["--chunks", "0"], "chunks = 0"),
        (["--chunks", "12"], "chunks = 12"),
        (["--store", "map.zarr"], "--store needs --chunks K"),
        (["--chunks", "3", "--store", str(tmp_path / "map.zarr")], "chunks = [4, 4], and this one has [3, 3]"),
    ):
        assert main([*command, *wrong]) == 2
        captured = capsys.readouterr()
        assert says in captured.err and captured.err.count("\n") == 1 and not captured.out
