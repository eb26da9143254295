"""The chapters that derive: from the statement to the matrices, printed from the record of the pipeline."""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING, Any

from freebeam.lesson.blocks import Block, Cell, Check, Equation, Erratum, Figure, Folded, Heading, Listing, Prose
from freebeam.lesson.errata import entries
from freebeam.lesson.phrases import data, heading, prose, summary, text, words

if TYPE_CHECKING:
    from freebeam_derive.pipeline import Derived, GeneralDerived
    from freebeam_derive.record import Step
    from freebeam_sym.columns import Column

__all__ = ["Chapter", "derivation_chapters", "newmark_chapter", "statement_blocks"]

RIGID = "Keep what the ends let move as a rigid body"
CONDITIONS = "State the natural end conditions"
PLACED = ("State the equation of motion", CONDITIONS)
"""Steps whose results hold at a place, or on a segment."""
LONG = 420
"""Characters of LaTeX beyond which a formula is folded."""

SHOWS_MORE = {
    "Compare the damping with mass and elastic stiffness", "Name the factor of χ", "Set the determinant to zero",
    "Write the load's matrix in closed form",
}  # fmt: skip
"""Steps whose cell shows something else than the record does, so that the record's result is shown too."""


class Chapter:
    """Steps of a record as blocks: each with what it started from, its result, and its check."""

    def __init__(self, derived: Derived | GeneralDerived, paper: bool, short: bool = False) -> None:
        from freebeam_derive.derivation import GeneralDerivation
        from freebeam_derive.latex import printer

        self.derived, self.paper, self.short = derived, paper, short
        self.general = isinstance(derived, GeneralDerivation)
        self.printer = printer(derived.column)
        self.steps = derived.steps
        self.told: set[str] = set()
        self.residuals: dict[tuple[str, str, str], float] = {}
        self.shown: set[tuple[str, ...]] = set()

    def of(self, stage: str) -> list[Step]:
        return [step for step in self.steps if step.stage == stage and self.wanted(step)]

    def wanted(self, step: Step) -> bool:
        """Whether a step is told; a lesson of one lecture tells some."""
        return not self.short or step.what in data("record.toml")["short"]["steps"]

    def find(self, what: str) -> Step | None:
        return next((step for step in self.steps if step.what == what), None)

    def named(self, *names: str) -> list[Block]:
        """The steps with these names as blocks; those that this column's record lacks are left out."""
        found = (self.find(name) for name in names)
        return [block for step in found if step is not None and self.wanted(step) for block in self.step(step)]

    def lines(self, step: Step, part: Any) -> tuple[str, ...]:
        """LaTeX of what a step has before or after it."""
        self.printer.own.pop("lambda", None)
        if step.stage == "modes":
            self.printer.own["lambda"] = r"\lambda_{0}"
        record = data("record.toml")
        if part is step.after and step.what in record["names"]:
            part = part[record["shown"][step.what]] if step.what in record["shown"] else part
            return tuple(self.printer.labelled(part, tuple(record["names"][step.what])))
        if part is step.after and step.what == RIGID:
            names = tuple(rf"r_{{{k + 1}}}" for k in range(len(part)))
            return tuple(self.printer.labelled(part, names))
        if part is step.after and step.what in PLACED:
            return self.placed(step)
        return tuple(self.printer.lines(part))

    def placed(self, step: Step) -> tuple[str, ...]:
        """Equations of motion and conditions with the places where they hold before them; what is the same, once."""
        motion, place = self.derived.motion, self.printer.place
        relations = step.after if isinstance(step.after, tuple) else (step.after,)
        if step.what == CONDITIONS:
            where = [f"x = {place(motion.beam.places[c.place])}" for c in motion.conditions]
        else:
            edges = [place(edge) for edge in motion.beam.places]
            where = [f"{edges[k]} < x < {edges[k + 1]}" if motion.beam.cuts else "" for _, k in motion.equations]
            where += [""] * len(motion.of_coordinates)
        found: dict[Any, list[str]] = {}
        for relation, at in zip(relations, where, strict=True):
            found.setdefault(relation, []).append(at)
        lines: list[str] = []
        for relation, places in found.items():
            written = self.printer.lines(relation)
            label = r",\; ".join(places)
            if label:
                first = written[0].removeprefix("& ").replace(" &= ", " = ", 1)
                written = [rf"{label}\colon \quad & {first}", *written[1:]]
            lines += written
        return tuple(lines)

    def step(self, step: Step, said: bool = True) -> tuple[Block, ...]:
        """One step: why, from what, what came of it, what proved it; then the errata of its equation."""
        number = step.equation.removeprefix("Eq. (").removesuffix(")") if step.equation.startswith("Eq.") else ""
        what = step.what[0].upper() + step.what[1:]
        for plain, letter in (("T", "T"), ("V", "V"), ("W_c", "W_{c}"), ("dW_nc", r"\delta W_{\mathrm{nc}}")):
            what = what.replace(f"Write {plain} in", f"Write ${letter}$ in")
        shown: list[Block] = []
        if _formula(step.before) and step.stage != "scaling":
            start = self.lines(step, step.before)
            if start not in self.shown:
                shown.append(Folded("What it started from", (Equation(start),)))
                self.shown.add(start)
        if _formula(step.after):
            after = step.after
            if step.stage == "scaling":
                name = {"W_c": "W_{c}", "dW_nc": r"\delta W_{\mathrm{nc}}"}.get(
                    step.what.split()[1], step.what.split()[1]
                )
                lines = self.scaled(step, name)
                result = Equation(lines, number)
            else:
                result = Equation(self.lines(step, after), number)
            long = sum(map(len, result.lines)) > LONG * (2 if len(result.lines) > 2 else 1) and step.stage == "newmark"
            shown.append(Folded("The formula, which is long", (result,)) if long else result)
            self.shown.add(result.lines)
        shown.append(Check(written(step.check), self.residual(step)))
        code = data("record.toml")["general" if self.general else "cells"].get(step.what, "")
        quiet = ", shown=True" if code and step.what not in SHOWS_MORE else ""
        cell = Cell((code + "\n" if code else "") + f"proven(derived, {step.what!r}{quiet})", tuple(shown))
        text = f"**{what}.** {_sentence(step.why)}" if said else f"**{what}.**"
        return (Prose(text), cell, *self.errata(step.equation))

    def section(
        self, stage: str, chapter: str = "", said: bool = True, more: tuple[Block, ...] = (), **values: str
    ) -> list[Block]:
        """A chapter of text.toml, by default named as the stage: its opening, then the stage's steps without the
        conditions that are numbered, and its summary. said: whether each step tells why it is taken. more: blocks
        before the summary."""
        found: list[Block] = [heading(chapter or stage), prose(f"{chapter or stage}.opening", **values)]
        for step in self.of(stage):
            if not _numbered(step):
                found += self.step(step, said)
        return [*found, *more, *self.summed(chapter or stage)]

    def summed(self, chapter: str) -> list[Block]:
        """The summary of a chapter, where it has one that holds of any column."""
        return [summary(f"{chapter}.summary")] if "summary" in words()[chapter] else []

    def residual(self, step: Step) -> float:
        """What the step's proof leaves; it is run once."""
        key = (step.stage, step.what, step.why)
        if key not in self.residuals:
            self.residuals[key] = step.residual()
        return self.residuals[key]

    def scaled(self, step: Step, name: str) -> tuple[str, ...]:
        with_dimensions = self.printer.labelled(step.before, (name,))
        without = self.printer.labelled(step.after, (rf"\frac{{L}}{{EI}}\,{name}",))
        return (*with_dimensions, *without)

    def errata(self, *places: str) -> tuple[Block, ...]:
        """Errata about these places of the paper, each told once."""
        if not self.paper:
            return ()
        found = []
        for entry in entries():
            if entry.title not in self.told and set(entry.places) & set(places):
                self.told.add(entry.title)
                kept = tuple(p for p in entry.paragraphs if not p.startswith("Checked by"))
                found.append(Erratum(entry.title, kept))
        return tuple(found)


def _numbered(step: Step) -> bool:
    """Whether a step is one of the four conditions on trial functions, "1)" to "4)"."""
    return step.why[1:2] == ")"


def _formula(part: Any) -> bool:
    """Whether a record's object is mathematics to print, and not a name or a list of orders."""
    if isinstance(part, tuple):
        return bool(part) and all(_formula(item) for item in part)
    return not isinstance(part, str | int) and part is not None


_LETTERS = "lambda omega Omega rho Phi Psi xi kappa gamma alpha beta".split()


def written(text: str) -> str:
    """A sentence of the record with its formulas as mathematics: e^(λt), h^2, omega, λ₀ and the like."""
    text = re.sub(r"e\^\(([^)]*)\)", lambda m: rf"$\mathrm{{e}}^{{{_greek(m[1])}}}$", text)
    text = re.sub(r"\b([a-zA-Z]+)\^(\d)\b", lambda m: rf"${_greek(m[1])}^{{{m[2]}}}$", text)
    return re.sub(rf"\b({'|'.join(_LETTERS)})\b(?![^$]*\$(?:[^$]*\$[^$]*\$)*[^$]*$)", lambda m: rf"$\{m[1]}$", text)


def _greek(text: str) -> str:
    for letter, name in {"λ₀": r"\lambda_{0} ", "λ": r"\lambda ", "γ": r"\gamma ", "−": "-"}.items():
        text = text.replace(letter, name)
    return re.sub(rf"\b({'|'.join(_LETTERS)})\b", r"\\\1", text) if "\\" not in text else text


def _sentence(text: str) -> str:
    text = text.strip()
    first = text.split()[0] if text else ""
    if (first.isascii() and first.isalpha() and len(first) > 1) or first.lower() == "a":
        text = text[0].upper() + text[1:]
    return written(text) + ("" if text.endswith(".") else ".")


def derivation_chapters(chapter: Chapter, kernels: Column, source: Path | None) -> tuple[Block, ...]:
    """From the statement to the matrices. Eqs. (1)-(23)."""
    from freebeam import figures
    from freebeam_derive.notation import P, x

    column = chapter.derived.column
    blocks: list[Block] = [
        heading("statement"),
        prose("statement.opening", left=column.ends[0], right=column.ends[1]),
        Cell("", (Figure("beam", lambda: figures.beam(kernels), "Deflected as in its lowest mode.", "The column"),)),
        *statement_blocks(chapter, source),
    ]
    blocks += [*chapter.errata("Eq. (1)", "Eq. (2)", "Eq. (3)", "Eq. (4)"), *chapter.summed("statement")]
    if chapter.derived.scaling:
        blocks += chapter.section("scaling", said=False)
    varies = chapter.derived.motion.strong.coeff(P).has(x)
    return (
        *blocks,
        *chapter.section("variation"),
        *chapter.section("Ritz series", "ritz", reason=text(f"ritz.{'varying' if varies else 'constant'}_load")),
        *chapter.section("modes", more=(*_admissible(chapter, "modes"), *chapter.errata("Section 3.1"))),
        *chapter.section("integrals"),
        *chapter.section("polynomials", more=_admissible(chapter, "polynomials")),
    )


def statement_blocks(chapter: Chapter, source: Path | None) -> list[Block]:
    """The statement as the program reads it, and as formulas."""
    blocks: list[Block] = []
    if source is not None:
        code = source.read_text(encoding="utf-8").strip()
        blocks.append(Cell(f"{code}", (Folded("The statement as the program reads it", (Listing(code),)),)))
    cell = (
        "derived = pipeline.derived(column)\n"
        'for name in ("T", "V", "W_c", "dW_nc"):\n'
        "    show(Eq(Symbol(name), display(column.energies.functional(name), 1, column.cuts), evaluate=False))"
    )
    return [*blocks, Cell(cell, _statement(chapter))]


def _statement(chapter: Chapter) -> tuple[Block, ...]:
    """The statement as formulas: it is what the proof of the variation evaluates."""
    step = chapter.find("Take the first variation of the energies and add the virtual work")
    assert step is not None
    lines = tuple(chapter.printer.lines(step.before))
    text = "read from the statement into its derivatives; the variation of what was read equals that of the energies"
    return (Equation(lines, "8"), Check(text, chapter.residual(step)), *chapter.errata("Eq. (8)"))


def _admissible(chapter: Chapter, stage: str) -> tuple[Block, ...]:
    """The four conditions on trial functions."""
    blocks: list[Block] = [prose(f"{stage}.admissible")]
    for step in chapter.of(stage):
        if not _numbered(step):
            continue
        shown: list[Block] = []
        if _formula(step.after) and stage == "modes" and step.why[0] in "23":
            shown.append(Equation(chapter.lines(step, step.after)))
        shown.append(Check(written(step.check), chapter.residual(step)))
        blocks += [
            Prose(written(step.why) + "."),
            Cell(f"proven(derived, {step.what!r}, {step.why[:2]!r}, {stage!r})", tuple(shown)),
        ]
    return tuple(blocks)


def newmark_chapter(chapter: Chapter) -> tuple[Block, ...]:
    """Newmark's method, which the paper uses and does not print: an appendix."""
    _, *blocks = chapter.section("newmark")
    title = text("opening.appendix", title=text("newmark.title"))
    return (Heading(title, 2, "newmark"), *blocks, *chapter.errata("Section 4.5", "Abstract"))
