"""docs/equations.md: every row's names import and cite the equation, every file named tests it."""

from __future__ import annotations

import re
from importlib import import_module
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).parent.parent
ROWS = [
    [cell.strip() for cell in line.strip("|\n").split("|")]
    for line in (ROOT / "docs" / "equations.md").read_text(encoding="utf-8").splitlines()
    if re.match(r"\| \(\d+\)", line)
]


def cited(text: str) -> set[int]:
    """Numbers of the equations that a text cites: Eq. (3), Eqs. (1)-(5), (8)."""
    found: set[int] = set()
    for match in re.finditer(r"Eqs?\.\s+(\(\d+\)(?:(?:\s*[-–,]\s*|,?\s+(?:and|to)\s+)\(\d+\))*)", text):
        previous: int | None = None
        for joint, number in re.findall(r"(-|–|to)?[\s,and]*\((\d+)\)", match[1]):
            first = previous if joint and previous is not None else int(number)
            found |= set(range(first, int(number) + 1))
            previous = int(number)
    return found


def resolved(name: str) -> Any:
    """What a dotted name stands for: the longest importable module, then attributes."""
    parts = name.split(".")
    for cut in range(len(parts), 0, -1):
        try:
            found: Any = import_module(".".join(parts[:cut]))
        except ModuleNotFoundError:
            continue
        for attribute in parts[cut:]:
            found = getattr(found, attribute)
        return found
    raise ModuleNotFoundError(name)


def test_the_reader_of_citations() -> None:
    assert cited("Eqs. (9)-(11), (13), and Eq. (22). Also (7).") == {9, 10, 11, 13, 22}
    assert cited("Eqs. (7), (8) to (10)") == {7, 8, 9, 10}
    assert cited("equation (3)") == set()


def test_every_numbered_equation_has_its_row() -> None:
    assert [row[0] for row in ROWS] == [f"({n})" for n in range(1, 27)]


@pytest.mark.parametrize("row", ROWS, ids=lambda row: row[0])
def test_names_import_and_cite_their_equation(row: list[str]) -> None:
    number = int(row[0].strip("()"))
    for cell in row[2:5]:
        for name in re.findall(r"`([\w.]+)`", cell):
            document = resolved(name).__doc__ or ""
            assert number in cited(document), f"{name} does not cite Eq. ({number})"


@pytest.mark.parametrize("row", ROWS, ids=lambda row: row[0])
def test_files_of_tests_exist_and_cite_their_equation(row: list[str]) -> None:
    number = int(row[0].strip("()"))
    files = re.findall(r"`([\w./]+\.py)`", row[5])
    assert files
    for file in files:
        assert number in cited((ROOT / file).read_text(encoding="utf-8")), f"{file} does not cite Eq. ({number})"


def test_what_the_architecture_names_is_there() -> None:
    page = (ROOT / "docs" / "architecture.md").read_text(encoding="utf-8")
    names = set(re.findall(r"`(freebeam(?:_\w+)?\.[\w.]+)`", page))
    assert len(names) > 15
    for name in names:
        assert resolved(name) is not None, name
