"""The lesson as PDF, typeset by Typst, which needs no installation beside its wheel."""

from __future__ import annotations

import re
import tempfile
from pathlib import Path

from freebeam_sym.checks import InputError
from freebeam_sym.lesson.blocks import (
    Block,
    Cell,
    Check,
    Equation,
    Erratum,
    Exercise,
    Figure,
    Folded,
    Heading,
    Lesson,
    Listing,
    Prose,
    Table,
    spans,
)
from freebeam_sym.lesson.mathematics import typst
from freebeam_sym.lesson.pictures import image

__all__ = ["files", "source"]

HEAD = r"""
#set page(paper: "a4", margin: (x: 2.6cm, y: 2.4cm), numbering: "1")
#set text(font: ("Libertinus Serif", "New Computer Modern"), size: 10.5pt, lang: "en")
#set par(justify: true, leading: 0.68em, spacing: 1.05em)
#set heading(numbering: "1")
#show heading.where(level: 1): it => block(above: 2.2em, below: 0.9em, text(size: 15pt, it))
#show raw: set text(size: 7.6pt)
#show link: set text(fill: rgb("#00609b"))
#let grey = rgb("#5c666e")
#let formula(number, body) = block(above: 0.9em, below: 0.7em, width: 100%, layout(size => {
  let room = size.width - if number == none { 0pt } else { 32pt }
  let wide = measure(body).width
  let shown = if wide > room { scale(x: room / wide * 100%, y: room / wide * 100%, reflow: true, body) } else { body }
  if number == none { align(center, shown) } else {
    grid(columns: (1fr, 30pt), align: (center + horizon, right + horizon), shown, text(fill: grey)[(#number)])
  }
}))
#let checked(body) = block(above: 0.5em, below: 1.3em,
  text(size: 8.5pt, fill: grey)[#text(fill: rgb("#00815e"))[✓ *checked:*] #body])
#let aside(title, body) = block(fill: rgb("#fff6ec"), stroke: (left: 2pt + rgb("#e0a566")), inset: 9pt, width: 100%,
  breakable: true, text(size: 9.3pt)[#text(size: 7.5pt, fill: rgb("#c24e00"))[ERRATUM OF THE PAPER] \ *#title*

#body])
#let folded(title, body) = block(inset: (left: 8pt), stroke: (left: 0.7pt + rgb("#cfd5d9")),
  text(size: 9pt)[#text(fill: grey)[_#(title)_] #body])
"""


def files(lesson: Lesson, output: Path) -> dict[Path, bytes]:
    """The PDF. Raises InputError without typst."""
    try:
        import typst as compiler
    except ImportError:
        raise InputError(
            "PDF needs typst, which is not installed: pip install 'freebeam[lesson]'; --format tex and html need it not"
        ) from None
    text, pictures = source(lesson)
    with tempfile.TemporaryDirectory() as folder:
        for name, data in pictures.items():
            (Path(folder) / name).write_bytes(data)
        main = Path(folder) / "lesson.typ"
        main.write_text(text, encoding="utf-8")
        return {output: bytes(compiler.compile(main, format="pdf"))}


def source(lesson: Lesson) -> tuple[str, dict[str, bytes]]:
    """Typst's source, and the drawings that it needs by name."""
    page = _Page()
    body = "\n\n".join(page.blocks(lesson.blocks))
    title = f'#text(size: 9pt, fill: grey)[A LESSON THAT DERIVES ITSELF]\n\n#text(size: 22pt, weight: "bold")[{inline(lesson.title)}]\n\n#text(fill: grey)[{inline(lesson.subtitle)}]\n\n#v(0.5em)\n#outline(depth: 1, title: none)\n#pagebreak()\n'  # noqa: E501
    document = f"#set document(title: {_quoted(lesson.title)}, date: none)\n"
    return document + HEAD + title + body + "\n", page.pictures


def _quoted(text: str) -> str:
    return '"' + text.replace("\\", "\\\\").replace('"', '\\"') + '"'


def _escape(text: str) -> str:
    return re.sub(r"([\\#$*_`@<>~\[\]/=+-])", r"\\\1", text)


def inline(text: str) -> str:
    """Text with its marks as Typst."""
    parts = []
    for kind, piece in spans(text):
        if kind == "math":
            parts.append(f"${typst(piece)}$")
        elif kind == "display":
            parts.append(f"#formula(none, $ {typst(piece.strip())} $)")
        elif kind == "code":
            parts.append(f"#raw({_quoted(piece)})")
        elif kind == "text":
            parts.append(_escape(piece))
        else:
            parts.append(f"#{'strong' if kind == 'strong' else 'emph'}[{inline(piece)}]")
    return "".join(parts)


class _Page:
    def __init__(self) -> None:
        self.pictures: dict[str, bytes] = {}
        self.exercises = self.figures = 0

    def blocks(self, blocks: tuple[Block, ...]) -> list[str]:
        return [text for block in blocks if (text := self.block(block))]

    def block(self, block: Block) -> str:
        match block:
            case Heading():
                return f"{'=' * (block.level - 1)} {inline(block.text)}"
            case Prose():
                return inline(block.text)
            case Equation():
                number = _quoted(block.number) if block.number else "none"
                return f"#formula({number}, $ {typst(block.latex)} $)"
            case Check():
                left = f"{block.residual:.0e}" if block.residual else "nothing"
                return f"#checked[{inline(block.text)} · leaves {_escape(left)}]"
            case Folded():
                inner = "\n\n".join(self.blocks(block.blocks))
                return f"#folded({_quoted(block.summary)})[{inner}]"
            case Erratum():
                inner = "\n\n".join(inline(p) for p in block.paragraphs)
                return f"#aside([{inline(block.title)}])[{inner}]"
            case Figure():
                self.figures += 1
                name = f"{block.key}.svg"
                self.pictures[name] = image(block, "svg")
                caption = f"*Figure {self.figures}. {inline(block.title)}.* {inline(block.caption)}"
                return (
                    f"#block(breakable: false, width: 100%)[#align(center, image({_quoted(name)}, width: 68%))\n"
                    f"#text(size: 9pt, fill: grey)[{caption}]]"
                )
            case Table():
                cells = [f"[*{inline(c)}*]" for c in block.header] + [f"[{inline(c)}]" for r in block.rows for c in r]
                return (
                    f"#align(center, text(size: 9pt, table(columns: {len(block.header)}, stroke: none, align: left, "
                    "table.hline(stroke: 0.6pt), "
                    + ", ".join(cells[: len(block.header)])
                    + ", table.hline(stroke: 0.4pt), "
                    + ", ".join(cells[len(block.header) :])
                    + ", table.hline(stroke: 0.6pt))))"
                )
            case Exercise():
                self.exercises += 1
                return (
                    f"*Exercise {self.exercises}.* {inline(block.question)}\n\n"
                    f"#block(inset: (left: 8pt), text(size: 9.3pt, fill: grey)[_Answer._ {inline(block.answer)}])"
                )
            case Listing():
                return f'#raw({_quoted(block.code)}, lang: "python", block: true)'
            case Cell():
                return "\n\n".join(self.blocks(block.blocks))
