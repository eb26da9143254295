"""The lesson as a notebook: every step is a cell that does it, executed; change the statement and run on."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

from freebeam.lesson.blocks import Block, Cell, Check, Equation, Figure, Folded, Lesson, Listing, Table, walk
from freebeam.lesson.markdown import Markdown
from freebeam_sym.checks import InputError

__all__ = ["files", "unexecuted"]

IMPORTS = """\
%matplotlib inline
from sympy import Eq, Symbol
import freebeam as fb
from freebeam_derive import comparison, integrals, pipeline, ritz, roots, statement, variation
from freebeam_derive.bases import legendre
from freebeam_derive.statement import display as displayed
from freebeam.lesson import compiled, draw, proven, show

display = displayed  # a functional as integrals and values at points"""
HINT = (
    "*To study another column, change the statement in the next cell (an end, an energy, a force) and run all cells: "
    "the derivation, its proofs and the numbers follow. The text between the cells tells of the column that the "
    "notebook was made for.*"
)


def unexecuted(lesson: Lesson) -> list[tuple[str, str]]:
    """The notebook's cells, ("markdown" | "code", source), before they are run."""
    page, cells = Markdown(), []
    text = [page.opening(lesson), HINT]
    cells.append(("code", IMPORTS))
    for block in lesson.blocks:
        if isinstance(block, Cell):
            if not block.code:  # a drawing that needs the kernels, which come later here
                continue
            if text:
                cells.append(("markdown", "\n\n".join(text)))
            cells.append(("code", block.code))
            text = [page.block(b) for b in block.blocks if not isinstance(b, _SHOWN_BY_CELL) and not _folds_formula(b)]
        else:
            text.append(page.block(block))
    if text:
        cells.append(("markdown", "\n\n".join(text)))
    return cells


_SHOWN_BY_CELL = Equation | Check | Figure | Table  # what the cell's own output shows


def _folds_formula(block: Block) -> bool:
    return isinstance(block, Folded) and any(isinstance(b, Equation | Listing) for b in walk(block.blocks))


def files(lesson: Lesson, output: Path) -> dict[Path, bytes]:
    """The executed notebook. Raises InputError where a package is missing, or a cell fails."""
    try:
        import nbformat
        from nbclient import NotebookClient
        from nbclient.exceptions import CellExecutionError
    except ImportError as error:
        raise InputError(
            f"notebooks need {error.name}, which is not installed: pip install 'freebeam[lesson]'"
        ) from None
    book = nbformat.v4.new_notebook()
    makers: dict[str, Any] = {"markdown": nbformat.v4.new_markdown_cell, "code": nbformat.v4.new_code_cell}
    book.cells = [makers[kind](source) for kind, source in unexecuted(lesson)]
    for k, cell in enumerate(book.cells):
        cell["id"] = f"cell-{k}"  # random ids, too, would make every notebook another
    book.metadata.update(kernelspec={"name": "python3", "display_name": "Python 3", "language": "python"})
    try:
        NotebookClient(
            book,
            timeout=300,
            kernel_name="python3",
            extra_arguments=["--log-level=40"],
            resources={"metadata": {"path": os.getcwd()}},
        ).execute()
    except CellExecutionError as error:
        raise InputError(f"{output}: a cell of the notebook fails: {' '.join(str(error.evalue).split())}") from error
    for cell in book.cells:
        cell.metadata.pop("execution", None)  # the times when it ran, which would make every notebook another
    return {output: nbformat.writes(book).encode()}
