"""The lesson: a column's whole derivation and its physics, printed from the record of the program that did it.

    from freebeam.lesson import lesson, printed
    files = printed(lesson("free-free"), "html", "lesson.html")

`lesson` makes the tree (blocks.py), `printed` prints it in one of FORMATS; a notebook's cells use `show`, `proven`,
`compiled` and `draw`.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import replace
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

from freebeam_sym.checks import InputError, Unstable

if TYPE_CHECKING:
    from freebeam.lesson.blocks import Lesson
    from freebeam_sym.stability.convergence import BeamLoss

__all__ = ["FORMATS", "compiled", "draw", "lesson", "printed", "proven", "show", "solutions"]

FORMATS = {"html": "html", "md": "markdown", "tex": "tex", "ipynb": "notebook", "pdf": "pdf"}
"""Formats, and the module that prints each."""

PAPER = "free-free"
"""The column of the paper, whose misprints are marked."""

Progress = Callable[[str], None]


def lesson(
    column: str | os.PathLike[str] = PAPER,
    progress: Progress | None = None,
    *,
    errata: bool = False,
    short: bool = False,
    seed: int | None = None,
) -> Lesson:
    """The lesson on a column, by its name or by the path of its file. Eqs. (1)-(26).

    Every formula is printed from the object that the program computed with, and every step's proof is run.
    progress: told what is being done. errata: with the misprints of the paper, where they arise. short: for one lecture
    of 45 minutes. seed: data of the exercises, and values of the column's own parameters, that are another student's.

    Raises InputError for a column that is not known or has no statement and for a seed that is none, and
    AssertionError where a proof fails.
    """
    from freebeam.lesson.blocks import Heading, Lesson
    from freebeam.lesson.draws import drawn
    from freebeam.lesson.facts import Facts
    from freebeam.lesson.phrases import prose, text
    from freebeam.lesson.physics import physics_chapters
    from freebeam.lesson.segmented import general_derivation
    from freebeam.lesson.short import shortened
    from freebeam.lesson.stages import Chapter, derivation_chapters, newmark_chapter
    from freebeam.lesson.systems import general_physics
    from freebeam.own import column as column_of
    from freebeam_derive import pipeline
    from freebeam_derive.statement import StatementError

    say = progress or (lambda _: None)
    say("kernels")
    name = os.fspath(column)
    kernels = column_of(column)
    try:
        stated = pipeline.find(name)
    except StatementError as error:
        if hasattr(kernels.kernel, "COLUMN") and Path(name).is_file():
            raise InputError(
                f"{name}: is a kernel, and a lesson needs the statement that it was derived from; give the column's "
                "file"
            ) from None
        raise InputError(str(error)) from error
    data, own = drawn(kernels, seed)
    if kernels.general:
        facts = Facts(kernels, kernels, own, data)
    else:
        facts = Facts(column_of(column, "modes"), column_of(column, "legendre"), own, data)
    say("derivation")
    chapter = Chapter(pipeline.derived(stated), errata and stated.name == PAPER and name == PAPER, short)
    source = pipeline.known().get(name, Path(name))
    say("proofs of the derivation")
    derivation = general_derivation if kernels.general else derivation_chapters
    physics = general_physics if kernels.general else physics_chapters
    blocks: list[Any] = [*derivation(chapter, facts.column, source)]
    say("physics")
    blocks += physics(chapter, facts)
    if short:
        blocks = shortened(blocks)
    else:
        say("Newmark's method")
        blocks += newmark_chapter(chapter)
        if rest := _rest(chapter):
            blocks += [Heading(text("opening.errata"), 2, "errata"), *rest]
    made = Lesson(facts.column.title, _subtitle(facts), stated.name, (*_opening(facts, chapter.paper), *blocks))
    residual = max(check.residual for check in made.checks)
    left = text("opening.rounded", residual=residual) if residual else text("opening.exact")
    closing = prose("opening.closing", count=len(made.checks), left=left)
    return replace(made, blocks=(*made.blocks, closing))


def _opening(facts: Any, errata: bool) -> list[Any]:
    """Why one should care, what one can do afterwards, and what is presumed."""
    from freebeam.lesson.blocks import Points, Prose
    from freebeam.lesson.phrases import at, prose, text

    about = text("opening.paper" if facts.column.name == PAPER else "opening.other")
    about += " " + text("opening.misprints") if errata else ""
    blocks: list[Any] = [prose("opening.motivation")]
    blocks += [Points(text("opening.goals_title"), tuple(at("opening.goals")))]
    blocks += [Points(text("opening.presumed_title"), tuple(at("opening.presumed")))]
    blocks += [prose("opening.lesson"), Prose(about)]
    if facts.data.seed is not None:
        blocks.append(prose("opening.seed", seed=facts.data.seed))
    return blocks


def solutions(made: Lesson) -> tuple[Lesson, Lesson]:
    """A lesson without the answers of its exercises, and the worked solutions, numbered as there."""
    from freebeam.lesson.blocks import Exercise, Lesson
    from freebeam.lesson.phrases import text
    from freebeam.lesson.solved import solved

    asked = tuple(replace(b, answer="") if isinstance(b, Exercise) else b for b in made.blocks)
    title = text("solutions.title", title=made.title)
    return replace(made, blocks=asked), Lesson(title, text("solutions.subtitle"), made.column, tuple(solved(made)))


def _subtitle(facts: Any) -> str:
    try:
        found = facts.critical
    except Unstable:
        return "Derived from its energies, to its spectrum: it is unstable at the smallest loads"
    if found.load is None:
        return f"Derived from its energies; stable up to a load of {found.question.load_max:g}"
    kind, beam = "flutter" if facts.flutters else "divergence", found.beam
    known = "" if beam is None or beam.load is None else f"; the beam itself: {_lost(beam)}"
    series = f"{facts.modes} functions a segment" if facts.column.general else "eight modes"
    return f"Derived from its energies, to the {kind} load {found.load:.6g} of {series}{known}"


def _lost(beam: BeamLoss) -> str:
    """Kind and load of the beam's own loss of stability, to the digits that hold."""
    from freebeam.maps.verdict import digits_that_hold

    assert beam.load is not None
    return f"{beam.kind} at {digits_that_hold(beam.load, beam.uncertainty, 6)}"


def _rest(chapter: Any) -> tuple[Any, ...]:
    from freebeam.lesson.errata import entries

    left = [place for entry in entries() for place in entry.places]
    return tuple(chapter.errata(*left))


def printed(made: Lesson, format: str, output: str | os.PathLike[str]) -> dict[Path, bytes]:
    """The files of a lesson in a format: the one at `output`, and pictures beside it where the format needs them.

    Nothing is written. Raises InputError for an unknown format and for a package that is missing.
    """
    if format not in FORMATS:
        raise InputError(f"format = {format!r}: must be one of {', '.join(FORMATS)}")
    files: dict[Path, bytes] = import_module(f"freebeam.lesson.{FORMATS[format]}").files(made, Path(output))
    return files


# --- what a notebook's cells use -------------------------------------------------------------------------------------


def _display(latex: str) -> None:
    from IPython.display import Math, display  # type: ignore[import-not-found, unused-ignore]

    display(Math(latex))  # type: ignore[no-untyped-call, unused-ignore]


def show(*objects: Any) -> None:
    """Show SymPy objects as formulas, as the lesson prints them. For notebooks."""
    from freebeam.lesson.blocks import Equation
    from freebeam_derive.latex import Printer

    printer = Printer()
    for item in objects:
        lines = printer.lines(item)
        if lines:
            _display(Equation(tuple(lines)).latex)


def proven(derived: Any, what: str, why: str = "", stage: str = "", shown: bool = False) -> None:
    """Show the steps of a derivation that are called so (unless they are `shown` already), run their proofs and say
    what proved them. For notebooks."""
    steps = [s for s in derived.steps if s.what == what and s.why.startswith(why) and s.stage.startswith(stage)]
    if not steps:
        print("This column has no such step.")
    for step in steps:
        if not shown and not isinstance(step.after, str | int):
            show(step.after)
        left = step.residual()
        print(f"proven: {step.check or 'put back'}" + (f" (leaves {left:.0e})" if left else ""))


def compiled(column: Any) -> Any:
    """The kernels of a stated column, derived, emitted and loaded: what `freebeam_sym` computes with. For notebooks.

    Raises InputError where the statement makes no sense.
    """
    from freebeam_derive import emit, pipeline, verify
    from freebeam_derive.statement import StatementError
    from freebeam_sym.columns import Column

    try:
        derived = pipeline.derived(column)
        kernel = derived.kernel("modes") if isinstance(derived, pipeline.Derived) else derived.kernel
        return Column(verify.load(emit.emit(kernel), column.module))
    except StatementError as error:
        raise InputError(str(error)) from error


def draw(picture: Callable[..., Any], *arguments: Any, **options: Any) -> None:
    """Make a picture of `fb.figures`, or say in a line why this column has none. For notebooks."""
    try:
        picture(*arguments, **options)
    except InputError as error:
        print(error)
