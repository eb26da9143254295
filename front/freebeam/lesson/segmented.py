"""The chapters that derive a column of segments, fields and coordinates: from its statement to its matrices."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from freebeam.lesson.blocks import Block, Cell, Figure, Table
from freebeam.lesson.phrases import heading, prose, text
from freebeam.lesson.stages import statement_blocks

if TYPE_CHECKING:
    from freebeam.lesson.stages import Chapter
    from freebeam_derive.statement import Column as Statement
    from freebeam_sym.columns import Column

__all__ = ["general_derivation"]


def general_derivation(chapter: Chapter, kernels: Column, source: Path | None) -> tuple[Block, ...]:
    """From the statement to the matrices of any column. Eqs. (5)-(13), (15)."""
    column, motion = chapter.derived.column, chapter.derived.motion
    letter = chapter.printer
    names = [f"${letter.own.get(name, name)}$" for name in (*column.fields, *column.coordinates)]
    ends = "; ".join(
        text("statement.held", letter=letter.own.get(name, name), left=left, right=right)
        for name in column.fields
        for left, right in [column.supports(name)]
    )
    opening = prose("statement.fields", unknowns=_listed(names), ends=ends) if ends else prose("statement.links")
    return (
        heading("statement"),
        opening,
        *_picture(kernels, column),
        *statement_blocks(chapter, source),
        *chapter.summed("statement"),
        *(chapter.section("scaling", said=False) if chapter.derived.scaling else ()),
        *chapter.section("variation"),
        *(_segments(chapter) if motion.beam.cuts else ()),
        *chapter.section("series"),
        *(chapter.section("shapes") if motion.spaces else ()),
        *(chapter.section("rigid", "rigid_general") if chapter.of("rigid") else ()),
    )


def _listed(names: list[str]) -> str:
    return names[0] if len(names) == 1 else ", ".join(names[:-1]) + " and " + names[-1]


def _picture(kernels: Column, statement: Statement) -> list[Block]:
    from freebeam import figures
    from freebeam_derive.drawn import chain

    if "y" not in statement.fields and (statement.fields or chain(statement) is None):
        return []
    caption = text("statement.drawn" if statement.fields else "statement.turned")
    return [Cell("", (Figure("beam", lambda: figures.beam(kernels, x_s=None), caption, "The column"),))]


def _segments(chapter: Chapter) -> list[Block]:
    """Where the beam is cut, what is joined there, and what may jump."""
    motion, printer = chapter.derived.motion, chapter.printer
    rows = []
    last = len(motion.beam.places) - 1
    for number, place in enumerate(motion.beam.places):
        held, joined, free = [], [], []
        for space in motion.spaces:
            letter = printer.own.get(space.name, space.name)
            for order in range(space.joined):
                written = f"${letter}" + r"^{\prime}" * order + "$"
                end = {0: 0, last: 1}.get(number)
                if end is not None and (end, order) in space.held:
                    held.append(written)
                elif end is None and (number, order) not in space.opened:
                    joined.append(written)
                elif end is None:
                    free.append(written)
        cells = (", ".join(held) or "—", ", ".join(joined) or "—", ", ".join(free) or "—")
        rows.append((f"$x = {printer.place(place)}$", *cells))
    header = ("place", "held at zero", "continuous", "free to jump")
    count = len(motion.beam.segments)
    return [
        heading("segments"),
        prose("segments.opening", count=count),
        Table(header, tuple(rows)),
        prose("segments.conditions"),
        *([prose("segments.jumps")] if any(space.opened for space in motion.spaces) else []),
        *chapter.summed("segments"),
    ]
