"""The lesson as PDF, typeset by Typst, which needs no installation beside its wheel."""

from __future__ import annotations

import re
import tempfile
from pathlib import Path
from typing import ClassVar

from freebeam.lesson import blocks
from freebeam.lesson.mathematics import typst
from freebeam.lesson.writer import Writer, left
from freebeam_sym.checks import InputError

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


def files(lesson: blocks.Lesson, output: Path) -> dict[Path, bytes]:
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


def source(lesson: blocks.Lesson) -> tuple[str, dict[Path, bytes]]:
    """Typst's source, and the drawings that it needs by name."""
    page = _Page()
    title = f'#text(size: 9pt, fill: grey)[A LESSON THAT DERIVES ITSELF]\n\n#text(size: 22pt, weight: "bold")[{page.plain(lesson.title)}]\n\n#text(fill: grey)[{page.plain(lesson.subtitle)}]\n\n#v(0.5em)\n#outline(depth: 1, title: none)\n#pagebreak()\n'  # noqa: E501
    document = f"#set document(title: {_quoted(lesson.title)}, date: none)\n"
    return document + HEAD + title + page.joined(lesson.blocks) + "\n", page.pictures


def _quoted(text: str) -> str:
    return '"' + text.replace("\\", "\\\\").replace('"', '\\"') + '"'


def _escape(text: str) -> str:
    return re.sub(r"([!#-&(-/:-@\[-`{-~])", r"\\\1", text)  # all signs of ASCII but quotation marks


class _Page(Writer):
    spans: ClassVar = {
        "text": _escape,
        "math": lambda piece: f"${typst(piece)}$",
        "display": lambda piece: f"#formula(none, $ {typst(piece.strip())} $)",
        "code": lambda piece: f"#raw({_quoted(piece)})",
        "strong": "#strong[{}]".format,
        "emphasis": "#emph[{}]".format,
    }

    def heading(self, block: blocks.Heading) -> str:
        return f"{'=' * (block.level - 1)} {self.inline(block.text)}"

    def equation(self, block: blocks.Equation) -> str:
        number = _quoted(block.number) if block.number else "none"
        return f"#formula({number}, $ {typst(block.latex)} $)"

    def check(self, block: blocks.Check) -> str:
        return f"#checked[{self.inline(block.text)} · {_escape(left(block))}]"

    def folded(self, block: blocks.Folded) -> str:
        return f"#folded({_quoted(block.summary)})[{self.joined(block.blocks)}]"

    def erratum(self, block: blocks.Erratum) -> str:
        inner = "\n\n".join(map(self.inline, block.paragraphs))
        return f"#aside([{self.inline(block.title)}])[{inner}]"

    def figure(self, block: blocks.Figure) -> str:
        name = _quoted(self.picture(block, "svg").name)
        caption = f"*Figure {self.count['figure']}. {self.inline(block.title)}.* {self.inline(block.caption)}"
        return (
            f"#block(breakable: false, width: 100%)[#align(center, image({name}, width: 68%))\n"
            f"#text(size: 9pt, fill: grey)[{caption}]]"
        )

    def table(self, block: blocks.Table) -> str:
        head = ", ".join(f"[*{self.inline(cell)}*]" for cell in block.header)
        body = ", ".join(f"[{self.inline(cell)}]" for row in block.rows for cell in row)
        return (
            f"#align(center, text(size: 9pt, table(columns: {len(block.header)}, stroke: none, align: left, "
            f"table.hline(stroke: 0.6pt), {head}, table.hline(stroke: 0.4pt), {body}, table.hline(stroke: 0.6pt))))"
        )

    def exercise(self, block: blocks.Exercise) -> str:
        return (
            f"*Exercise {self.count['exercise']}.* {self.inline(block.question)}\n\n"
            f"#block(inset: (left: 8pt), text(size: 9.3pt, fill: grey)[_Answer._ {self.inline(block.answer)}])"
        )

    def listing(self, block: blocks.Listing) -> str:
        return f'#raw({_quoted(block.code)}, lang: "python", block: true)'
