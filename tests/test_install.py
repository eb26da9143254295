"""What is installed is what stands in the tree: wheel and sdist, each put into an environment of its own, outside."""

import os
import re
import shutil
import subprocess
import sys
import tomllib
import zipfile
from pathlib import Path

import pytest

from freebeam.cli.application import ORDER
from freebeam.cli.mapping import FORMATS

ROOT = Path(__file__).parents[1]
PACKAGES = {
    "freebeam_derive": ROOT / "derive" / "freebeam_derive",
    "freebeam_kernels": ROOT / "generated" / "freebeam_kernels",
    "freebeam_sym": ROOT / "freebeam_sym",
    "freebeam": ROOT / "front" / "freebeam",
}
MADE = shutil.ignore_patterns("__pycache__", "report.json")  # what running leaves in a tree
COMMANDS = [
    "columns",
    "show euler-pinned --modes 4",
    "critical --alpha 1e-3 --beta 0.1 --digits 12 --certificate load.json",
    "verify load.json",
    "critical --column ziegler --digits 12 --exact",
    "spectrum --load 80",
    "map --alpha 1e-3 1e-1 3 --beta 1e-2 1 2 --modes 3 --output map.nc",
    "map --alpha 1e-3 1e-1 3 --beta 1e-2 1 2 --modes 3 --chunks 2 --workers 1 --store store --output map.png",
    "map --column beck --axis eta 0.4 0.6 2 --modes 3",
    "pulse --column beck --load 5 --beta 0.1 --frequency 2 20 5 --amplitude 0 0.5 3 --modes 3",
    "respond --load 50 --duration 1 --step 0.01",
    "vehicle vehicle.csv",
    "figures 2 --output figures",
    "lesson --column euler-pinned --short --format html --output lesson.html",
    "explore --output explorer.html",
    "validate --loads",
    "generate euler-pinned --output kernels",
]


def files(folder: Path) -> dict[str, bytes]:
    """Content by relative path, without what running leaves."""
    made = (path for path in folder.rglob("*") if path.is_file() and "__pycache__" not in path.parts)
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in made if path.name != "report.json"}


def run(*words: object, folder: Path) -> subprocess.CompletedProcess[str]:
    env = {name: value for name, value in os.environ.items() if not name.startswith("PYTHON")}
    return subprocess.run(list(map(str, words)), cwd=folder, env=env, capture_output=True, text=True)


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the wheel and the sdist, made of a copy of the tree that nothing was built in before."""
    copy, made = tmp_path_factory.mktemp("tree"), tmp_path_factory.mktemp("dist")
    for name in ("pyproject.toml", "README.md", "LICENSE"):
        shutil.copy(ROOT / name, copy)
    for folder in PACKAGES.values():
        shutil.copytree(folder, copy / folder.relative_to(ROOT), ignore=MADE)
    code = f"from setuptools import build_meta as b; b.build_sdist({str(made)!r}); b.build_wheel({str(made)!r})"
    done = run(sys.executable, "-c", code, folder=copy)
    assert done.returncode == 0, done.stderr
    return made


def environment(home: Path, distribution: Path) -> Path:
    """The site-packages of a new environment with a distribution; what that depends on comes from this one."""
    assert run(sys.executable, "-m", "venv", "--without-pip", home, folder=home.parent).returncode == 0
    where = "import sysconfig; print(sysconfig.get_path('purelib'))"
    here, there = (Path(run(x, "-c", where, folder=home).stdout.strip()) for x in (sys.executable, home / "bin/python"))
    (there / "dependencies.pth").write_text(f"{here}\n", encoding="utf-8")
    quiet = (
        "--quiet",
        "--disable-pip-version-check",
        "--no-index",
        "--no-deps",
        "--no-build-isolation",
        "--no-compile",
        "--ignore-installed",
    )
    pip = (sys.executable, "-m", "pip", "--python", home / "bin/python", "install")
    done = run(*pip, *quiet, distribution, folder=home)
    assert done.returncode == 0, done.stderr
    return there


@pytest.fixture(scope="module")
def home(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("wheel") / "env"


@pytest.fixture(scope="module")
def installed(built: Path, home: Path) -> Path:
    """The site-packages of the environment `home`, which has the wheel."""
    return environment(home, *built.glob("*.whl"))


@pytest.fixture(scope="module")
def desk(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Where commands are run, away from the tree."""
    desk = tmp_path_factory.mktemp("desk")
    (desk / "vehicle.csv").write_text("x,EI,m\n0,2e6,50\n20,2e6,50\n", encoding="utf-8")
    return desk


def test_the_wheel_holds_all_files_of_the_tree(built: Path, tmp_path: Path) -> None:
    with zipfile.ZipFile(*built.glob("*.whl")) as wheel:
        wheel.extractall(tmp_path)
    for name, folder in PACKAGES.items():
        assert files(tmp_path / name) == files(folder)
    assert {path.name for path in tmp_path.iterdir() if not path.name.endswith(".dist-info")} == {*PACKAGES}


def test_the_sdist_installs_what_the_wheel_installs(built: Path, installed: Path, tmp_path: Path) -> None:
    other = environment(tmp_path / "env", *built.glob("*.tar.gz"))
    for name in PACKAGES:
        assert files(other / name) == files(installed / name)
    assert run(tmp_path / "env" / "bin" / "freebeam", "columns", folder=tmp_path).returncode == 0


def test_every_module_is_imported_from_there(installed: Path, home: Path, desk: Path) -> None:
    code = f"""
import importlib, pkgutil
for name in {[*PACKAGES]}:
    package = importlib.import_module(name)
    assert package.__file__.startswith({str(installed)!r}), package.__file__
    for module in pkgutil.walk_packages(package.__path__, name + "."):
        if not module.name.endswith("__main__"):
            importlib.import_module(module.name)
"""
    done = run(home / "bin" / "python", "-c", code, folder=desk)
    assert (done.returncode, done.stderr) == (0, "")


def test_the_extra_that_a_message_names_brings_what_is_missing() -> None:
    """One extra is enough for a kind of file that a map is written as."""
    extras = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["optional-dependencies"]
    for _, packages, extra in FORMATS.values():
        brought = {re.split(r"\W", needed, maxsplit=1)[0] for needed in extras.get(extra, [])}
        assert set(packages) <= brought


def test_no_command_is_left_out() -> None:
    assert {command.split()[0] for command in COMMANDS} == {*ORDER}


@pytest.mark.usefixtures("installed")
def test_every_command_runs(home: Path, desk: Path) -> None:
    """In this order, for verify reads what critical has written; in one process, which imports once."""
    code = f"""
from freebeam import cli
for command in {COMMANDS}:
    status = cli.main(command.split())
    assert status == 0, (command, status)
"""
    done = run(home / "bin" / "python", "-c", code, folder=desk)
    assert (done.returncode, done.stderr) == (0, "")


def test_generate_does_not_write_to_what_is_installed(installed: Path, home: Path, desk: Path) -> None:
    before = files(installed)
    for targets in ([], ["beck"], ["beck", "--check"]):
        done = run(home / "bin" / "freebeam", "generate", *targets, folder=desk)
        assert (done.returncode, done.stdout) == (2, "")
        assert "--output" in done.stderr and done.stderr.count("\n") == 1
    assert files(installed) == before
