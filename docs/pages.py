"""Write a page on each column that comes with freebeam, and its explorer: python docs/pages.py [NAME]... writes
docs/gallery and docs/made/explorer."""

from __future__ import annotations

import math
import os
import sys
from collections.abc import Iterable, Iterator, Mapping
from functools import lru_cache
from html import escape
from itertools import groupby
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

import freebeam as fb
from freebeam import explorer
from freebeam.figures.look import figure, style
from freebeam.figures.saving import image_of
from freebeam.ledger.reference_values import statements
from freebeam_derive import pipeline
from freebeam_derive.definition import formulas
from freebeam_derive.latex import letter, printer
from freebeam_sym.checks import InputError

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from numpy.typing import NDArray

    from freebeam_derive.statement import Column, Reference

FOLDER = Path(__file__).parent / "gallery"
EXPLORERS = Path(__file__).parent / "made" / "explorer"
POINTS, GRID = 61, 18  # of a curve; of each side of a map
DAMPINGS = {"alpha": np.geomspace(1e-4, 1e-1, GRID), "beta": np.geomspace(1e-2, 10, GRID)}


def drawings(statement: Column) -> Iterator[tuple[str, str, tuple[float, float]]]:
    """Names of a column's pictures, their captions and their sizes in inches."""
    yield "sketch", "The column, bent as in its lowest mode, with its parameters at their defaults.", (6.4, 2.7)
    if statement.references[0].kind == "flutter":
        yield "locus", "Its first two eigenvalues as the load grows, α = β = 0.", (5.2, 4.2)
    else:  # eigenvalues that meet at 0 and part along the real axis are seen better as squares
        yield "frequencies", "Its first two squared frequencies as the load grows, α = β = 0.", (5.2, 3.4)
    for p in statement.parameters:
        left_out = POINTS - len(agreed(statement.name, p.name, p.low, p.high))
        told = f" Left out: {left_out} of {POINTS} points, where series of growing N do not agree." if left_out else ""
        yield p.name, f"First loss of stability over ${letter(p)}$: {p.meaning}.{told}", (5.2, 3.4)
    if set(DAMPINGS) <= set(statement.damping):
        yield "map", "First loss of stability over internal damping α and external damping β.", (5.4, 4.0)


def draw(name: str, statement: Column, ax: Axes) -> None:
    column = fb.column(statement.name, "legendre")
    if name == "sketch":
        fb.figures.beam(column, x_s=None, x_F=None, ax=ax)
    elif name == "locus":
        fb.figures.root_locus(column, ax=ax)
    elif name == "frequencies":
        fb.figures.frequency_load(column, ax=ax)
    elif name == "map":
        fb.figures.stability_map(fb.stability_map(column, convergence=False, **DAMPINGS), ax=ax)
    else:
        low, high = next((p.low, p.high) for p in statement.parameters if p.name == name)
        fb.figures.critical_curve(column, name, agreed(statement.name, name, low, high), ax=ax)


@lru_cache
def agreed(column: str, name: str, low: float, high: float) -> NDArray[np.float64]:
    """Values of a column's parameter at which the load is converged. Undamped, high frequencies of a series may meet at
    low loads, for one N here and for another there (Timoshenko's column, whose motions are of two kinds)."""
    every = np.linspace(low, high, POINTS)
    polynomials = fb.column(column, "legendre")
    return every[[fb.critical_load(polynomials, **{name: value}).converged for value in every.tolist()]]


def page(statement: Column, file: Path, refused: Mapping[str, str]) -> str:
    """A column's page, in Markdown. refused: columns without an explorer."""
    name, found = statement.name, formulas(statement)
    opening = (statement_doc(file) or statement.title).replace("\n", " ")
    lines = [f"# {statement.title}", "", f"`{name}`. {opening}", "", f"Source: {statement.source}.", ""]
    pictures = list(drawings(statement))
    lines += _shown(name, *pictures[0][:2])
    if name not in refused:
        lines += [f'<p><a href="../explorer/{name}.html">Try it</a>: turn its knobs in your browser.</p>', ""]
    if statement.parameters:
        lines += ["| parameter | | default | of interest |", "|---|---|---|---|"]
        lines += [
            f"| ${letter(p)}$ (`{p.name}`) | {p.meaning} | {p.default:g} | {p.low:g} to {p.high:g} |"
            for p in statement.parameters
        ]
        lines += [""]
    lines += ["## Equation of motion", "", *_displayed(found["equations"])]
    if found["conditions"]:
        lines += ["with the conditions at its ends and breaks", "", *_displayed(found["conditions"])]
    lines += ["## First loss of stability", "", "| load | kind | at | given by |", "|---|---|---|---|"]
    lines += [_row(statement, reference) for reference in statement.references]
    lines += ["", "```console", f"$ freebeam critical --column {name} --digits 15 --exact", "```", ""]
    for picture, caption, _ in pictures[1:]:
        lines += _shown(name, picture, caption)
    below = os.path.relpath(file, FOLDER)
    return "\n".join([*lines, "## The statement", "", f"```{{literalinclude}} {below}", ":language: python", "```", ""])


def statement_doc(file: Path) -> str:
    """The first paragraph of a statement's docstring."""
    import ast

    return (ast.get_docstring(ast.parse(file.read_text(encoding="utf-8"))) or "").split("\n\n")[0]


def _displayed(formulas: list[str]) -> list[str]:
    return [line for formula in formulas for line in ("$$", formula, "$$", "")]


def _shown(name: str, picture: str, caption: str) -> list[str]:
    return [
        f"```{{figure}} pictures/{name}-{picture}.svg",
        f":alt: {caption.replace('$', '')}",
        ":class: figure",
        "",
        caption,
        "```",
        "",
    ]


def _row(statement: Column, reference: Reference) -> str:
    tex = printer(statement)
    given = {tex.doprint(p.symbol): reference.own[p.name] for p in statement.parameters if p.name in reference.own}
    given |= {r"\alpha": reference.alpha, r"\beta": reference.beta} if reference.alpha or reference.beta else {}
    at = ", ".join(f"${symbol} = {value:g}$" for symbol, value in given.items())
    if reference.kappa is not None:
        at = rf"$\alpha \to 0^{{+}}$, $\beta = {reference.kappa:g}\,\alpha$"
    seen = f", seen at <{reference.seen}>" if reference.seen.startswith("http") and " " not in reference.seen else ""
    seen = seen or (f", seen in {reference.seen}" if reference.seen else "")
    rule = "" if reference.rule == "rounded" else f" ({reference.rule})"
    rule += f" (of {reference.modes} modes, not of the beam)" if reference.modes else ""
    return f"| {reference.load}{rule} | {reference.kind} | {at or 'defaults'} | {reference.by}{seen} |"


def index(stated: Mapping[str, Column]) -> str:
    """The page that lists them by family."""
    lines = ["# Gallery of columns", ""]
    lines += [
        f"{len(stated)} columns of the literature, each stated in one file, with critical loads that others print or",
        "that independent routes compute. `freebeam columns` lists them, and `freebeam validate --gallery` computes",
        "every value and says what agrees. All here is made by the program; certified values of all of them are the",
        "[benchmark](../benchmark/index.md). Each has a page on which you can [try it](try.md).",
        "",
    ]
    for family, columns in groupby(stated.values(), key=lambda column: column.family):
        lines += [f"## {family}", ""]
        lines += [f"- [{column.title}]({column.name}.md)" for column in columns]
        lines += [""]
    return "\n".join([*lines, "```{toctree}", ":hidden:", "", "try", *stated, "```", ""])


def explorers(names: Iterable[str]) -> tuple[dict[str, str], dict[str, str]]:
    """The files of the columns' explorers, and of those that have none, why."""
    made: dict[str, str] = {}
    refused: dict[str, str] = {}
    for name in names:
        print(f"{name}: explorer", flush=True)
        try:
            made |= explorer.site([fb.column(name)])
        except InputError as error:
            refused[name] = str(error)
    return made, refused


def to_try(stated: Mapping[str, Column], refused: Mapping[str, str]) -> str:
    """The page that lists the explorers by family."""
    lines = ["# Try it", ""]
    lines += [
        "A page for each column of the gallery, on which load, dampings and parameters can be moved: the beam in its",
        "least stable mode, frequencies over the load, root locus, a map over any two parameters, a sensor's motion",
        "under a force. They compute in your browser, from kernels that the program emitted, and need no network.",
        "`freebeam explore --column FILE --output page.html` makes one of your own column.",
        "",
    ]
    for family, columns in groupby(stated.values(), key=lambda column: column.family):
        lines += [f"## {family}", ""]
        for column in columns:
            link = f'<a href="../explorer/{column.name}.html">{escape(column.title)}</a>'
            lines += [f"- {column.title}: no page; {refused[column.name]}" if column.name in refused else f"- {link}"]
        lines += [""]
    return "\n".join(lines)


def strips_of_the_paper() -> None:
    """The picture of docs/theorem.md, and what is said below it."""
    made = Path(__file__).parent / "made" / "figures"
    made.mkdir(parents=True, exist_ok=True)
    with style():
        drawn = figure((6.4, 3.4))
        fb.figures.strips(fb.column("free-free"), ax=drawn.subplots())
        (made / "strips.svg").write_bytes(image_of(drawn, "svg", "Eigenvalues, lines and discs"))
    (made / "strips.md").write_text(under_the_strips(), encoding="utf-8")


def under_the_strips() -> str:
    """The figure of docs/theorem.md with its caption, from the proof."""
    found = fb.exact_load(fb.column("free-free"), digits=10)
    if found.evidence is None or found.load is None:
        raise ValueError(f"the paper's beam: {found.missing}")
    m = int(found.evidence["lowest"])
    return f"""```{{figure}} /made/figures/strips.svg
:alt: Eigenvalues of the paper's beam at its critical load, over the fourth root of s, with the lines from R_{m} on
:class: figure
:width: 100%

The paper's beam at its critical load {found.load[0]}, over $s^{{1/4}}$: eigenvalues (dots; the lowest two meet), and
where they go as $p$ runs over $|p| = P_*$ (curves, of a series of 40 modes in floats). Each image of the disc
$|p| \\le P_*$ right of the line $R_{m}$ stays in a strip of its own: that is proven, as are the load, $m = {m}$ and the
lines, for loads up to {math.floor(found.evidence["reach"])}. `fb.figures.strips` draws it for any column of the
textbook's kind.
```
"""


def main(names: list[str]) -> None:
    (FOLDER / "pictures").mkdir(parents=True, exist_ok=True)
    stated, files = statements(), pipeline.known()
    made, refused = explorers(names or stated)
    EXPLORERS.mkdir(parents=True, exist_ok=True)
    for name, text in made.items():
        (EXPLORERS / name).write_text(text, encoding="utf-8")
    for name in names or stated:
        print(name, flush=True)
        (FOLDER / f"{name}.md").write_text(page(stated[name], files[name], refused), encoding="utf-8")
        for picture, caption, size in drawings(stated[name]):
            with style():
                drawn = figure(size)
                draw(picture, stated[name], drawn.subplots())
                image = image_of(drawn, "svg", caption)
            (FOLDER / "pictures" / f"{name}-{picture}.svg").write_bytes(image)
    strips_of_the_paper()
    (FOLDER / "index.md").write_text(index(stated), encoding="utf-8")
    (FOLDER / "try.md").write_text(to_try(stated, refused), encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1:])
