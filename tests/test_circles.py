"""No module imports one that imports it, by whatever way."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
PACKAGES = ("derive/freebeam_derive", "freebeam_sym", "front/freebeam")


def modules(package: Path) -> dict[str, Path]:
    """The modules of a package by their dotted names; a package's own is that of its `__init__`."""
    names = (path.relative_to(package.parent).with_suffix("").parts for path in sorted(package.rglob("*.py")))
    return {".".join(name): Path(package.parent, *name) for name in names}


def plain(name: str) -> str:
    return name.removesuffix(".__init__")


def imports(package: Path) -> dict[str, set[str]]:
    """Who imports whom: inside functions and for type checkers too, relative imports and names of modules resolved.

    That a module's own package is loaded before it does not count.
    """
    files = modules(package)
    known = {plain(name) for name in files}
    graph: dict[str, set[str]] = {}
    for name, path in files.items():
        found: set[str] = set()
        for node in ast.walk(ast.parse(path.with_suffix(".py").read_text(encoding="utf-8"))):
            if isinstance(node, ast.Import):
                found |= {alias.name for alias in node.names}
            elif isinstance(node, ast.ImportFrom):
                base = node.module or ""
                if node.level:
                    base = ".".join([*name.split(".")[: -node.level], *base.split(".")]).strip(".")
                inside = {f"{base}.{alias.name}" for alias in node.names}
                found |= {n if n in known else base for n in inside}
        graph[plain(name)] = found & known - {plain(name)}
    return graph


def circle(graph: dict[str, set[str]]) -> list[str]:
    """Modules each of which imports the next, and the last the first; empty where there are none."""
    left = {name: set(found) for name, found in graph.items()}
    while ends := {name for name, found in left.items() if not found & set(left)}:
        for name in ends:
            del left[name]
    path: list[str] = []
    while left and (not path or path[-1] not in path[:-1]):
        path.append(min(left[path[-1]] & set(left) if path else left))
    return path[path.index(path[-1]) :] if path else []


@pytest.mark.parametrize("package", PACKAGES)
def test_no_module_imports_one_that_imports_it(package: str) -> None:
    graph = imports(ROOT / package)
    assert sum(map(len, graph.values())) > 20  # the scan is no proof where it finds nothing
    assert circle(graph) == []


@pytest.mark.parametrize(
    "one",
    [
        "from pack import two",
        "from . import two",
        "from .two import f",
        "def g():\n    import pack.two",
        "import pack.two",
    ],
)
def test_a_circle_is_found(one: str, tmp_path: Path) -> None:
    package = tmp_path / "pack"
    package.mkdir()
    guarded = "from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n    from pack.one import g\n"
    for name, text in {"__init__": "", "one": one, "two": guarded, "three": "from pack import one"}.items():
        (package / f"{name}.py").write_text(text, encoding="utf-8")
    assert circle(imports(package)) in (["pack.one", "pack.two", "pack.one"], ["pack.two", "pack.one", "pack.two"])
    (package / "two.py").write_text("", encoding="utf-8")
    assert circle(imports(package)) == []
