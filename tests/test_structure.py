"""The walls between derivation, kernels and runtime, and what importing the runtime costs."""

import ast
import importlib
import json
import pickle
import subprocess
import sys
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType

import pytest

import freebeam
import freebeam_sym
from tests.sampled import EVERY

ROOT = Path(__file__).parents[1]
HOUSES = {
    "freebeam_derive": ROOT / "derive" / "freebeam_derive",
    "freebeam_kernels": ROOT / "generated" / "freebeam_kernels",
    "freebeam_sym": ROOT / "freebeam_sym",
    "freebeam": ROOT / "front" / "freebeam",
}
"""The four houses. Data flows from each to those after it, and imports point the other way alone."""
MAY_IMPORT = {
    "freebeam_derive": {"freebeam_derive"},
    "freebeam_kernels": {"freebeam_kernels"},
    "freebeam_sym": {"freebeam_kernels", "freebeam_sym"},
    "freebeam": set(HOUSES),
}
SYMBOLIC = {"sympy", "mpmath", "flint"}
LATE = {"matplotlib", "xarray", "dask", "distributed", "zarr"}  # inside functions, where they are used


def files(house: str) -> list[Path]:
    return sorted(HOUSES[house].rglob("*.py"))


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


@pytest.mark.parametrize("house", HOUSES)
def test_no_import_runs_back(house: str) -> None:
    assert files(house)
    reached = {package for file in files(house) if file.name != "verifier_claims.py" for package in imported(file)}
    assert house in reached or house == "freebeam_kernels"  # the scan sees imports
    assert reached & set(HOUSES) <= MAY_IMPORT[house]


def test_the_verifier_alone_reads_the_emitted_kernels() -> None:
    """It tells whether a certificate's forms are those of the column that it names; else it is of the derivation."""
    (verifier,) = HOUSES["freebeam_derive"].rglob("verifier_claims.py")
    assert set(imported(verifier)) & set(HOUSES) == {"freebeam_derive", "freebeam_kernels"}


def test_no_two_modules_have_one_name() -> None:
    """A column's statement and its kernels have the column's name."""
    kernels = {file.stem for file in files("freebeam_kernels")}
    names = Counter(file.stem for house in HOUSES for file in files(house) if file.stem not in ("__init__", "__main__"))
    columns = {file.stem for file in files("freebeam_derive") if file.parent.name == "columns"}
    assert {name for name, count in names.items() if count > 1} <= columns & kernels


@pytest.mark.parametrize("file", [*files("freebeam_sym"), *files("freebeam")], ids=lambda file: file.stem)
def test_what_is_heavy_is_loaded_where_it_is_used(file: Path) -> None:
    """The derivation inside functions; SymPy and the like by it alone, and by what reads the paper's equations."""
    if file.parent.name != "paper":
        assert not SYMBOLIC & set(imported(file))
        assert "freebeam_derive" not in set(imported(file, everywhere=False))
    assert not LATE & set(imported(file, everywhere=False))


@pytest.mark.parametrize("file", files("freebeam_kernels"), ids=lambda file: file.stem)
def test_kernels_import_numpy_alone(file: Path) -> None:
    assert set(imported(file)) <= {"__future__", "typing", "numpy", "freebeam_kernels"}


@pytest.mark.parametrize("package", ["freebeam_sym", "freebeam"])
def test_importing_loads_nothing_heavy(package: str) -> None:
    assert not modules_after(f"import {package}") & {*SYMBOLIC, *LATE, "scipy", "freebeam_derive", "typer", "rich"}


def test_using_the_runtime_never_loads_the_symbolic_side() -> None:
    code = "import freebeam as fb; fb.critical_load(fb.column('free-free'), alpha=1e-3, beta=0.1)"
    loaded = modules_after(code)
    assert "freebeam_kernels" in loaded
    assert not loaded & {*SYMBOLIC, *LATE, "freebeam_derive"}


@pytest.mark.parametrize("more", [["--json"], ["--output", "map.csv"], []])
def test_a_map_as_text_loads_nothing_of_labelled_arrays_or_pictures(more: list[str], tmp_path: Path) -> None:
    axes = ["--alpha", "1e-3", "1", "3", "--beta", "1e-2", "1", "2"]
    command = ["map", *axes, *more]
    code = f"import os; os.chdir({str(tmp_path)!r}); from freebeam.cli import main; assert main({command}) == 0"
    assert not modules_after(code) & {*SYMBOLIC, *LATE, "pandas"}


def test_help_loads_no_numerics() -> None:
    code = "from freebeam.cli import main; assert main(['--help']) == 0"
    assert not modules_after(code) & {*SYMBOLIC, *LATE, "scipy", "numpy", "freebeam_derive"}


@pytest.mark.parametrize("package", [freebeam_sym, freebeam])
def test_front_doors_open_in_any_order(package: ModuleType) -> None:
    """A module of the package must not take the place of a function of the same name when it is imported."""
    modules = {file.stem for file in HOUSES[package.__name__].glob("*.py")} - {"__init__"}
    for module in modules:
        importlib.import_module(f"{package.__name__}.{module}")
    for name in package.__all__:
        assert not isinstance(getattr(package, name), ModuleType), name
    assert not set(package.__all__) & modules
    assert set(package.__all__) <= set(dir(package))


@pytest.mark.parametrize("package", [freebeam_sym, freebeam])
def test_front_doors_are_the_same_for_type_checkers(package: ModuleType) -> None:
    tree = ast.parse((HOUSES[package.__name__] / "__init__.py").read_text(encoding="utf-8"))
    (guard,) = (node for node in tree.body if isinstance(node, ast.If))
    declared = {
        alias.asname or alias.name: getattr(importlib.import_module(node.module), alias.name)
        for node in guard.body
        if isinstance(node, ast.ImportFrom) and node.module
        for alias in node.names
    }
    assert {*declared, "__version__"} == set(package.__all__)
    for name, value in declared.items():
        assert getattr(package, name) is value, name


@pytest.mark.parametrize("package", [freebeam_sym, freebeam])
def test_what_is_offered_can_be_sent_to_another_process(package: ModuleType) -> None:
    for name in package.__all__:
        value = getattr(package, name)
        assert pickle.loads(pickle.dumps(value)) == value, name


def test_freebeam_offers_all_that_the_runtime_does() -> None:
    assert set(freebeam_sym.__all__) <= set(freebeam.__all__)
    # these know the statements that are derived when they are first used, where the runtime's know kernels alone
    others = {"column", "column_names"} | {"critical_load"}  # the last asks with what is known from earlier questions
    for name in set(freebeam_sym.__all__) - others:
        assert getattr(freebeam, name) is getattr(freebeam_sym, name)


@pytest.mark.parametrize("package", [freebeam_sym, freebeam])
def test_unknown_names_are_attribute_errors(package: ModuleType) -> None:
    with pytest.raises(AttributeError, match="no attribute 'flutter'"):
        package.flutter  # noqa: B018


def test_the_runtime_alone_runs_a_kernel_from_its_file(tmp_path: Path) -> None:
    """One emitted file and the runtime, without what derives: load, map, spectrum and response."""
    kernel = tmp_path / "taken.py"
    kernel.write_bytes((HOUSES["freebeam_kernels"] / "beck_legendre.py").read_bytes())
    code = (
        f"import freebeam_sym as r; a, b = (r.critical_load(r.column(x), 16) for x in ({str(kernel)!r}, 'beck'))\n"
        "assert a.load == b.load\n"
        "column = a.question.column; system = column.system(8, 5.0, 1e-3)\n"
        "loads = [r.critical_load(column, 8, alpha, 0.1).load for alpha in (1e-3, 1e-2)]; assert loads[0] != loads[1]\n"
        "assert r.spectrum(system).unstable == 0 and r.respond(system, 1.0, 0.1).y.shape == (11, 1)"
    )
    assert not modules_after(code) & {*SYMBOLIC, "freebeam", "freebeam_derive"}
    statement = ROOT / "derive" / "freebeam_derive" / "columns" / "beck.py"
    with pytest.raises(freebeam_sym.InputError, match=r"is no emitted kernel; .*`import freebeam`"):
        freebeam_sym.column(statement)


@pytest.mark.parametrize("law", EVERY)
def test_a_law_of_which_some_cases_are_run_exists(law: str) -> None:
    file, name = law.split("::")
    assert f"def {name}(" in (ROOT / "tests" / file).read_text(encoding="utf-8")
