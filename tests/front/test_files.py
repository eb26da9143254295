"""Files: whole or not at all, nothing of the user's in the way is lost, and what goes wrong is one line."""

from __future__ import annotations

import errno
import os
import resource
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from freebeam.cli import main
from freebeam_derive.files import written

LONG = ["respond", "--load", "9", "--duration", "1000", "--step", "1e-4"]
LONG += ["--sensor", "0.1", "0.2", "0.3", "0.4", "0.5", "0.6", "0.7", "0.8", "0.9"]


def start(folder: Path, *words: object, **more: object) -> subprocess.Popen[str]:
    command = [sys.executable, "-m", "freebeam.cli", *map(str, words)]
    pipe = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE} | more
    return subprocess.Popen(command, cwd=folder, text=True, **pipe)  # type: ignore[call-overload,no-any-return]


def ended(process: subprocess.Popen[str]) -> tuple[int, str]:
    _, err = process.communicate()
    return process.returncode, err


def until(process: subprocess.Popen[str], there: Callable[[], bool]) -> None:
    """Wait for something that a process brings about."""
    while not there():
        assert process.poll() is None, "it ended before"
        time.sleep(0.01)


def one_line(err: str, *says: str) -> None:
    assert err.startswith("freebeam: ") and err.count("\n") == 1 and "Traceback" not in err
    assert all(text in err for text in says)


def test_a_file_that_appears_in_the_meantime_is_kept_and_nothing_is_lost(tmp_path: Path) -> None:
    path = tmp_path / "r.csv"
    for k in (1, 2):
        with pytest.raises(FileExistsError, match=f"in the meantime and is kept; .*r-{k}.csv") as caught:
            with written(path, replace=False) as stream:
                stream.write(b"ours %d" % k)
                path.write_bytes(b"theirs")
        assert caught.value.filename == str(path)
        path.unlink()
    path.write_bytes(b"theirs")
    held = {file.name: file.read_bytes() for file in tmp_path.iterdir()}
    assert held == {"r.csv": b"theirs", "r-1.csv": b"ours 1", "r-2.csv": b"ours 2"}


def test_the_same_without_links_between_files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: object) -> None:
        raise OSError(errno.EOPNOTSUPP, "no links here")

    monkeypatch.setattr(os, "link", refuse)
    test_a_file_that_appears_in_the_meantime_is_kept_and_nothing_is_lost(tmp_path)
    with written(tmp_path / "new", replace=False) as stream:
        stream.write(b"whole")
    assert (tmp_path / "new").read_bytes() == b"whole"


def test_of_two_runs_on_one_name_the_first_to_end_has_it(tmp_path: Path) -> None:
    begun = threading.Barrier(8)
    told: list[str] = []

    def run(k: int) -> None:
        try:
            with written(tmp_path / "name", replace=False) as stream:
                stream.write(b"%d" % k)
                begun.wait()
        except FileExistsError as error:
            told.append(error.strerror)

    threads = [threading.Thread(target=run, args=(k,)) for k in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(told) == 7
    assert sorted(path.read_bytes() for path in tmp_path.iterdir()) == [b"%d" % k for k in range(8)]


def test_replace_follows_a_link_and_keeps_it(tmp_path: Path) -> None:
    for target in ("old", "new"):
        link = tmp_path / f"to-{target}"
        link.symlink_to(target)
    (tmp_path / "old").write_bytes(b"old")
    for target in ("old", "new"):
        link = tmp_path / f"to-{target}"
        with pytest.raises(FileExistsError), written(link, replace=False):
            pass
        with written(link, replace=True) as stream:
            stream.write(b"text")
        assert link.is_symlink() and (tmp_path / target).read_bytes() == b"text"
    assert len([*tmp_path.iterdir()]) == 4


def test_replace_writes_through_a_pipe(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    pipe = tmp_path / "load.json"
    os.mkfifo(pipe)
    process = start(tmp_path, "critical", "--digits", "12", "--certificate", pipe, "--force")
    assert "freebeam certificate" in pipe.read_text(encoding="utf-8")
    assert ended(process) == (0, "")
    assert pipe.is_fifo() and [*tmp_path.iterdir()] == [pipe]
    assert main(["critical", "--digits", "12", "--certificate", str(pipe)]) == 2
    one_line(capsys.readouterr().err, "load.json", "--force")


@contextmanager
def at_most(size: int) -> Iterator[None]:
    """No file may grow beyond a size."""
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)


COMMANDS = {
    "respond": ["respond", "--load", "9", "--duration", "9", "--step", "1e-3", "--output", "made.csv"],
    "respond npz": ["respond", "--load", "9", "--duration", "9", "--step", "1e-3", "--output", "made.npz"],
    "critical": ["critical", "--digits", "40", "--certificate", "made.json"],
    "map": ["map", "--alpha", "1e-3", "1", "9", "--beta", "1e-3", "1", "9", "--output", "made.nc"],
    "explore": ["explore", "--output", "made.html"],
    "figures": ["figures", "2", "--output", "."],
    "generate": ["generate", "euler-pinned", "--output", "kernels"],
}


@pytest.mark.parametrize("command", COMMANDS.values(), ids=COMMANDS)
def test_a_limit_on_files_is_one_line_and_leaves_nothing(
    tmp_path: Path, command: list[str], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    import matplotlib.font_manager  # noqa: F401  its list of fonts is written once on a machine, where nothing limits it

    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "dont_write_bytecode", True)  # which would be cut off
    with at_most(1000):
        status = main(command)
    assert status == 2
    one_line(capsys.readouterr().err, os.strerror(errno.EFBIG))
    assert not [path for path in tmp_path.rglob("*") if path.is_file()]


def test_the_same_where_a_process_ends(tmp_path: Path) -> None:
    with at_most(1000):
        process = start(tmp_path, *COMMANDS["respond"], env={**os.environ, "PYTHONDONTWRITEBYTECODE": "1"})
    status, err = ended(process)
    assert status == 2
    one_line(err, os.strerror(errno.EFBIG))
    assert not [*tmp_path.iterdir()]


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs a device that is always full")
def test_a_full_disk_is_one_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with open("/dev/full", "w", encoding="utf-8") as full:
        for command in (["critical", "--json"], ["--help"]):
            status, err = ended(start(tmp_path, *command, stdout=full))
            assert status == 2
            one_line(err, os.strerror(errno.ENOSPC))
    assert main(["critical", "--digits", "12", "--certificate", "/dev/full", "--force"]) == 2
    one_line(capsys.readouterr().err, "/dev/full", os.strerror(errno.ENOSPC))


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT, signal.SIGHUP])
@pytest.mark.parametrize("suffix", ["csv", "npz"])
def test_a_signal_leaves_no_file(tmp_path: Path, number: signal.Signals, suffix: str) -> None:
    process = start(tmp_path, *LONG, "--output", f"r.{suffix}")
    until(process, lambda: any(tmp_path.iterdir()))
    process.send_signal(number)
    status, err = ended(process)
    assert status == 128 + number and not [*tmp_path.iterdir()]
    one_line(err)


def test_an_interrupt_while_modules_are_imported_is_one_line(tmp_path: Path) -> None:
    """typer and numpy are replaced by modules whose import says that it has begun and waits."""
    for name in ("typer", "numpy"):
        folder = tmp_path / name
        folder.mkdir()
        text = "import pathlib, time\npathlib.Path('begun').touch()\ntime.sleep(60)\n"
        (folder / f"{name}.py").write_text(text, encoding="utf-8")
        code = f"import sys; sys.path.insert(0, {str(folder)!r}); from freebeam.cli import main; sys.exit(main())"
        process = subprocess.Popen(
            [sys.executable, "-c", code, "critical"], cwd=folder, text=True, stderr=subprocess.PIPE
        )  # fmt: skip
        until(process, (folder / "begun").exists)
        process.send_signal(signal.SIGINT)
        status, err = ended(process)
        assert status == 130
        one_line(err, "interrupted")
