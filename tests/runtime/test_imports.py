"""The walls between derivation, kernels and runtime, and what importing the runtime costs."""

import ast
import importlib
import json
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType

import pytest

import freebeam_sym

ROOT = Path(__file__).parents[2]
PACKAGE = ROOT / "freebeam_sym"
RUNTIME = sorted(PACKAGE.rglob("*.py"))
DERIVATION = sorted((ROOT / "derive" / "freebeam_derive").rglob("*.py"))
KERNELS = sorted((ROOT / "generated" / "freebeam_kernels").rglob("*.py"))
FRONTS = {  # which may reach the derivation, inside functions
    "cli/derivation.py", "cli/output.py", "ledger/proven.py", "lesson/__init__.py", "lesson/derivation.py",
    "lesson/physics.py", "own.py", "proofs.py",
}  # fmt: skip
SYMBOLIC = {"sympy", "mpmath", "flint"}
LATE = {"matplotlib", "xarray", "dask", "distributed", "zarr"}  # inside functions, where they are used


def imported(file: Path, everywhere: bool = True) -> Iterator[str]:
    """Top-level packages that a file imports; without `everywhere` only what importing the file imports."""
    queue: list[ast.AST] = [ast.parse(file.read_text(encoding="utf-8"))]
    while queue:
        node = queue.pop()
        if isinstance(node, ast.Import):
            yield from (alias.name.split(".")[0] for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and not node.level and node.module:
            yield node.module.split(".")[0]
        elif (
            not everywhere
            and isinstance(node, ast.If)
            and isinstance(node.test, ast.Name)
            and node.test.id == "TYPE_CHECKING"
        ):
            queue.extend(node.orelse)
        elif everywhere or not isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef, ast.Lambda)):
            queue.extend(ast.iter_child_nodes(node))


def modules_after(code: str) -> set[str]:
    """Top-level modules loaded in a fresh interpreter after some code."""
    code += "\nimport json, sys; print(json.dumps(sorted(sys.modules)))"
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=ROOT)
    return {name.split(".")[0] for name in json.loads(run.stdout.splitlines()[-1])}


@pytest.mark.parametrize("file", DERIVATION, ids=lambda file: file.stem)
def test_derivation_never_imports_the_runtime(file: Path) -> None:
    assert "freebeam_sym" not in set(imported(file))


@pytest.mark.parametrize("file", RUNTIME, ids=lambda file: file.stem)
def test_runtime_never_imports_the_symbolic_side(file: Path) -> None:
    assert not SYMBOLIC & set(imported(file))
    front = file.relative_to(PACKAGE).as_posix() in FRONTS
    assert "freebeam_derive" not in set(imported(file, everywhere=not front))
    assert not LATE & set(imported(file, everywhere=False))


@pytest.mark.parametrize("file", KERNELS, ids=lambda file: file.stem)
def test_kernels_import_numpy_alone(file: Path) -> None:
    assert set(imported(file)) <= {"__future__", "typing", "numpy", "freebeam_kernels"}


def test_the_walls_stand_somewhere() -> None:
    """The scans above are no proof where they find no files."""
    assert {file.relative_to(PACKAGE).as_posix() for file in RUNTIME} >= {"__init__.py", *FRONTS}
    assert len(DERIVATION) > 5
    assert {file.stem for file in KERNELS} >= {"free_free", "beck", "euler_pinned"}
    assert "numpy" in set(imported(ROOT / "freebeam_sym" / "checks.py"))


def test_importing_the_runtime_loads_nothing_heavy() -> None:
    assert not modules_after("import freebeam_sym") & {*SYMBOLIC, *LATE, "scipy", "freebeam_derive", "typer", "rich"}


def test_using_the_runtime_never_loads_the_symbolic_side() -> None:
    code = "import freebeam_sym as fb; fb.critical_load(fb.column('free-free'), alpha=1e-3, beta=0.1)"
    loaded = modules_after(code)
    assert "freebeam_kernels" in loaded
    assert not loaded & {*SYMBOLIC, *LATE, "freebeam_derive"}


@pytest.mark.parametrize("more", [["--json"], ["--output", "map.csv"], []])
def test_a_map_as_text_loads_nothing_of_labelled_arrays_or_pictures(more: list[str], tmp_path: Path) -> None:
    axes = ["--alpha", "1e-3", "1", "3", "--beta", "1e-2", "1", "2"]
    command = ["map", *axes, *more]
    code = f"import os; os.chdir({str(tmp_path)!r}); from freebeam_sym.cli import main; assert main({command}) == 0"
    assert not modules_after(code) & {*SYMBOLIC, *LATE, "pandas"}


def test_help_loads_no_numerics() -> None:
    code = "from freebeam_sym.cli import main; assert main(['--help']) == 0"
    assert not modules_after(code) & {*SYMBOLIC, *LATE, "scipy", "numpy", "freebeam_derive"}


def test_front_door_opens_in_any_order() -> None:
    """A module of the package must not take the place of a function of the same name when it is imported."""
    modules = {file.stem for file in PACKAGE.glob("*.py")} - {"__init__"}
    for module in modules:
        importlib.import_module(f"freebeam_sym.{module}")
    for name in freebeam_sym.__all__:
        assert not isinstance(getattr(freebeam_sym, name), ModuleType), name
    assert not set(freebeam_sym.__all__) & modules
    assert set(freebeam_sym.__all__) <= set(dir(freebeam_sym))


def test_front_door_is_the_same_for_type_checkers() -> None:
    tree = ast.parse((ROOT / "freebeam_sym" / "__init__.py").read_text(encoding="utf-8"))
    (guard,) = (node for node in tree.body if isinstance(node, ast.If))
    declared = {
        alias.asname or alias.name: (node.module.removeprefix("freebeam_sym."), alias.name)
        for node in guard.body
        if isinstance(node, ast.ImportFrom) and node.module
        for alias in node.names
    }
    assert declared == freebeam_sym._HOMES
    assert {*declared, "__version__"} == set(freebeam_sym.__all__)


def test_unknown_names_are_attribute_errors() -> None:
    with pytest.raises(AttributeError, match="no attribute 'flutter'"):
        freebeam_sym.flutter  # noqa: B018
