"""The cache of own columns: what is run from it stands as it was emitted, in a folder that is the user's alone."""

from __future__ import annotations

import importlib.util
import json
import os
import py_compile
import shutil
import sys
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

import freebeam as fb
from freebeam import own

SOURCE = Path(__file__).parents[1] / "derive/columns/leipholz.py"
FILES = ("leipholz_legendre.py", "MANIFEST.json", "__init__.py", "report.json")
HARM = b"\nraise SystemExit('what was put here was run')\n"
POSIX = pytest.mark.skipif(os.name == "nt", reason="folders have no modes there")

generate = own._generate


@pytest.fixture(scope="module")
def emitted(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A kernel as it was emitted."""
    folder = tmp_path_factory.mktemp("emitted") / "kernel"
    generate(SOURCE, "legendre", folder)
    return folder


@pytest.fixture
def made(emitted: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> list[Path]:
    """The folders that kernels were derived into, with an empty cache of this test's own to begin with."""
    folders: list[Path] = []

    def again(path: Path, basis: str, output: Path) -> None:
        folders.append(output)
        for file in emitted.iterdir():
            shutil.copy(file, output)

    monkeypatch.setattr(own, "_generate", again)
    for name in ("XDG_CACHE_HOME", "LOCALAPPDATA"):
        monkeypatch.setenv(name, str(tmp_path / "cache"))
    return folders


def asked() -> Any:
    """The kernel, as another process would find it."""
    for name in [name for name in sys.modules if name.startswith("freebeam_own_")]:
        del sys.modules[name]
    kernel = own.column(SOURCE, "legendre").kernel
    assert kernel.COLUMN["name"] == "leipholz"
    assert not hasattr(kernel, "harm")
    return kernel


def entry() -> Path:
    (found,) = own.cache_folder().iterdir()
    return found


def test_what_was_emitted_is_taken_from_the_cache(made: list[Path]) -> None:
    first = asked()
    assert sorted(file.name for file in entry().iterdir()) == sorted(FILES)
    assert Path(first.__file__) == entry() / FILES[0]
    assert asked().COLUMN == first.COLUMN
    assert len(made) == 1


@pytest.mark.parametrize("changed", ["variation.py", "bases/legendre.py", "emit/module.py.jinja"])
def test_another_derivation_derives_again(
    changed: str, made: list[Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What it emits hangs on each of its files, templates too."""
    found = importlib.util.find_spec
    derivation = found("freebeam_derive")
    assert derivation is not None and derivation.submodule_search_locations
    copy = Path(shutil.copytree(derivation.submodule_search_locations[0], tmp_path / "derivation"))
    there = SimpleNamespace(submodule_search_locations=[str(copy)])
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: there if name == "freebeam_derive" else found(name))
    for _ in range(2):
        asked()
    assert len(made) == 1
    with (copy / changed).open("a", encoding="utf-8") as file:
        file.write("\n")
    asked()
    assert len(made) == 2


@POSIX
def test_the_folder_is_the_user_s_alone(made: list[Path]) -> None:
    before = os.umask(0)
    try:
        asked()
    finally:
        os.umask(before)
    assert [folder.stat().st_mode & 0o777 for folder in (own.cache_folder(), entry())] == [0o700, 0o700]
    asked()
    assert len(made) == 1


def flipped(file: Path) -> None:
    content = bytearray(file.read_bytes())
    content[len(content) // 2] ^= 1
    file.write_bytes(content)


TAMPERED: dict[str, tuple[str, Callable[[Path], Any], bool]] = {
    # case: file, what is done to it, whether the kernel must be derived anew
    "code at the kernel's end": (FILES[0], lambda file: file.write_bytes(file.read_bytes() + HARM), True),
    "one bit of the kernel": (FILES[0], flipped, True),
    "half a kernel": (FILES[0], lambda file: file.write_bytes(file.read_bytes()[: file.stat().st_size // 2]), True),
    "no kernel": (FILES[0], Path.unlink, True),
    "another hash": (
        FILES[1],
        lambda file: file.write_text(file.read_text().replace('"sha256": "', '"sha256": "0')),
        True,
    ),
    "half a manifest": (FILES[1], lambda file: file.write_bytes(file.read_bytes()[:-9]), True),
    "another kind of manifest": (FILES[1], lambda file: file.write_text("[1, 2]"), True),
    "deep nesting": (FILES[1], lambda file: file.write_text("[" * 100_000), True),
    "no manifest": (FILES[1], Path.unlink, True),
    "code in the index": (FILES[2], lambda file: file.write_bytes(HARM), False),
    "another report": (FILES[3], lambda file: file.write_bytes(HARM), False),
    "a further module": ("numpy.py", lambda file: file.write_bytes(HARM), False),
}


@pytest.mark.parametrize("case", TAMPERED)
def test_what_was_changed_in_the_cache_is_not_run(made: list[Path], emitted: Path, case: str) -> None:
    """The kernel is derived anew where it or its manifest was changed, and put in the place of what was."""
    name, change, anew = TAMPERED[case]
    asked()
    change(entry() / name)
    kernel = asked()
    assert importlib.util.decode_source((emitted / FILES[0]).read_bytes()) == kernel.__loader__.get_source("")
    assert len(made) == 1 + anew
    asked()
    assert len(made) == 1 + anew


def test_bytecode_in_the_cache_is_not_run(made: list[Path], tmp_path: Path) -> None:
    """Python itself would take it for the kernel's: it says that it is of a file of this size and time."""
    asked()
    kernel = entry() / FILES[0]
    false = tmp_path / FILES[0]
    false.write_bytes(b"harm = 1\n".ljust(kernel.stat().st_size, b"\n"))
    os.utime(false, (kernel.stat().st_atime, kernel.stat().st_mtime))
    cached = importlib.util.cache_from_source(str(kernel))
    py_compile.compile(str(false), cfile=cached, dfile=str(kernel))
    asked()
    assert len(made) == 1


def test_another_column_s_kernel_is_not_taken(made: list[Path]) -> None:
    """Whole and sound as it is: its manifest is of another key."""
    asked()
    manifest = entry() / FILES[1]
    content = json.loads(manifest.read_text(encoding="utf-8"))
    assert content["key"].startswith(entry().name)
    manifest.write_text(json.dumps({**content, "key": content["key"][::-1]}), encoding="utf-8")
    asked()
    assert len(made) == 2


@POSIX
@pytest.mark.parametrize("mode", [0o777, 0o770, 0o722, 0o707, 0o1777])
@pytest.mark.parametrize("inner", [False, True])
def test_a_folder_that_others_can_write_to_is_not_trusted(made: list[Path], mode: int, inner: bool) -> None:
    """Nothing is read from it, and nothing written there is relied on."""
    asked()
    folder = entry() if inner else own.cache_folder()
    folder.chmod(mode)
    before = sorted(own.cache_folder().rglob("*"))
    kernel = asked()
    assert len(made) == 2
    if not inner:  # the folder is left as it is, and what serves this process stands elsewhere
        assert own.cache_folder() not in made[-1].parents and not made[-1].exists()
        assert sorted(own.cache_folder().rglob("*")) == before and folder.stat().st_mode & 0o7777 == mode
        assert kernel.basis(3).order.shape == kernel.basis(3).sigma.shape


@POSIX
@pytest.mark.parametrize("mode", [0o755, 0o750, 0o700])
def test_a_folder_that_others_can_read_is_trusted(made: list[Path], mode: int) -> None:
    asked()
    own.cache_folder().chmod(mode)
    asked()
    assert len(made) == 1


@POSIX
def test_another_s_folder_is_not_trusted(made: list[Path], monkeypatch: pytest.MonkeyPatch) -> None:
    asked()
    user = os.geteuid()
    monkeypatch.setattr(os, "geteuid", lambda: user + 1)
    asked()
    assert len(made) == 2 and not made[-1].exists()


@POSIX
def test_a_map_of_a_kernel_that_is_not_kept(made: list[Path]) -> None:
    """Blocks are sent its text, which no file holds any more."""
    own.cache_folder().mkdir(parents=True)
    own.cache_folder().chmod(0o777)
    for name in [name for name in sys.modules if name.startswith("freebeam_own_")]:
        del sys.modules[name]
    column = fb.column(SOURCE, "legendre")
    assert not Path(str(column.kernel.__file__)).exists()
    found = fb.stability_map(column, 4, alpha=[1e-3, 1e-2], beta=[0.1, 1], chunks=2, scheduler="synchronous")
    load = fb.critical_load(column, 4, alpha=1e-3, beta=0.1).load
    assert found["load"].values[0, 0] == pytest.approx(load, rel=1e-9)
