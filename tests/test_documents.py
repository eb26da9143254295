"""README and guides: their Python runs, their commands exist with the options that they name."""

from __future__ import annotations

import re
import shlex
from pathlib import Path

import pytest
import typer.main

import freebeam as fb
from freebeam.cli.application import app

ROOT = Path(__file__).parent.parent
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("**/*.md"))]
PAGES = [page for page in PAGES if "made" not in page.parts]
WHOLE = ("engineers.md",)
"""Pages whose pieces of Python go on from one another."""


def pieces(page: Path) -> list[str]:
    found = re.findall(r"```python\n(.*?)```", page.read_text(encoding="utf-8"), re.S)
    return ["\n".join(found)] if page.name in WHOLE else found


PYTHON = [
    pytest.param(code, id=f"{page.name}-{k}")
    for page in PAGES
    for k, code in enumerate(pieces(page))
    if "import leipholz" not in code  # which needs the emitted file beside it: tests/runtime/test_cli.py
    if "import ctypes" not in code  # which needs a compiled kernel: tests/derive/test_languages.py
]
COMMANDS = sorted({
    line.strip().removeprefix("$ ").removeprefix(".venv/bin/")
    for page in PAGES
    for line in page.read_text(encoding="utf-8").splitlines()
    if re.match(r"(    |\$ )(\.venv/bin/)?freebeam [a-z]", line)
})  # fmt: skip


def test_there_is_something_to_test() -> None:
    assert len(PYTHON) >= 3 and len(COMMANDS) >= 15


@pytest.mark.parametrize("code", PYTHON)
def test_python_runs(code: str, capsys: pytest.CaptureFixture[str]) -> None:
    if "import torch" in code:
        pytest.importorskip("torch")
    names: dict[str, object] = {}
    exec(compile(code, "page", "exec"), names)
    if isinstance(names.get("critical"), fb.CriticalLoad):
        assert names["critical"].kind in capsys.readouterr().out


@pytest.mark.parametrize("line", COMMANDS)
def test_commands_are_understood(line: str) -> None:
    """Parsed by the command line itself, up to the point where work would begin."""
    group = typer.main.get_command(app)
    _, name, *arguments = shlex.split(line.split("#")[0])
    command = group.commands[name]  # type: ignore[attr-defined]
    command.make_context(name, arguments)


def test_every_public_name_is_in_the_reference() -> None:
    page = (ROOT / "docs" / "reference" / "runtime.md").read_text(encoding="utf-8")
    named = set(re.findall(r"freebeam\.(\w+)", page))
    assert {name for name in fb.__all__ if not name.startswith("__")} <= named


def test_the_numbers_of_the_theorem_are_those_of_its_proofs() -> None:
    """docs/theorem.md: each row's load, kind, m, norm and stretches."""
    from fractions import Fraction

    from freebeam_derive.certify.balls import precision
    from freebeam_derive.certify.strips import Strips

    _, page = (ROOT / "docs" / "theorem.md").read_text(encoding="utf-8").split("\n## Numbers\n")
    rows = [[cell.strip() for cell in line.split("|")[1:-1]] for line in page.splitlines() if line.startswith("| ")]
    assert len(rows) > 6
    for said, load, kind, lowest, norm, stretches in rows[1:]:
        name, *given = said.split()
        own = dict(item.split("=") for item in given)
        column = fb.column(name)
        found = fb.exact_load(column, digits=20, **own)
        assert all(found.proof.values()) and found.evidence is not None and found.load is not None
        assert (found.kind, found.evidence["lowest"], found.evidence["stretches"]) == (
            kind,
            int(lowest),
            int(stretches),
        )
        assert found.load[0].startswith(load)
        with precision(128):
            strips = Strips(column.kernel, {key: Fraction(value) for key, value in own.items()}, 40)
            bound = float(found.load[1]) * float(strips.B.norm(strips.line(int(lowest))))
        assert float(norm) - 1e-3 < bound <= float(norm)


def test_formulas_of_the_theorems_can_be_set() -> None:
    """What stands between dollars is LaTeX that the documentation can print."""
    from freebeam.lesson.mathematics import mathml

    texts = [(ROOT / "docs" / name).read_text(encoding="utf-8") for name in ("theorem.md", "proofs.md")]
    formulas = [a or b for text in texts for a, b in re.findall(r"\$\$(.+?)\$\$|\$(.+?)\$", text, flags=re.DOTALL)]
    assert len(formulas) > 300 and all(mathml(formula) for formula in formulas)
