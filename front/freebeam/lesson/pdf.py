"""The lesson as PDF, typeset by Typst, which needs no installation beside its wheel."""

from __future__ import annotations

import re
import tempfile
from pathlib import Path
from typing import ClassVar

from freebeam.lesson import blocks
from freebeam.lesson.mathematics import typst
from freebeam.lesson.phrases import text
from freebeam.lesson.writer import Writer
from freebeam_sym.checks import InputError

__all__ = ["files", "source"]

ON_A_PAGE = 60
"""Lines of code that are not split between pages."""


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
    body = page.joined(lesson.blocks)
    if page.proofs:
        items = "\n".join(f"+ {proof}" for proof in page.proofs)
        opening = _escape(text("proof.listed"))
        body += f"\n\n= {_escape(text('proof.appendix'))}\n\n{opening}\n\n#text(size: 9pt)[\n{items}\n]"
    return page.filled("page.typ", lesson, name=_quoted(lesson.title), body=body), page.pictures


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

    def prose(self, block: blocks.Prose) -> str:
        text = self.inline(block.text)
        # the name of a step, and words that end in a colon, stay with what they are about
        leads = block.text.startswith("**") or block.text.endswith(":")
        return f"#block(sticky: true)[{text}]" if leads else text

    def heading(self, block: blocks.Heading) -> str:
        return f"{'=' * (block.level - 1)} {self.inline(block.text)}"

    def equation(self, block: blocks.Equation) -> str:
        number = _quoted(block.number) if block.number else "none"
        return f"#formula({number}, $ {typst(block.latex)} $)"

    def check(self, block: blocks.Check) -> str:
        return f"#checked[{text('proof.title')} {self.noted(block)}]"

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
        rules = f"table.hline(stroke: 0.6pt), {head}, table.hline(stroke: 0.4pt), {body}, table.hline(stroke: 0.6pt)"
        table = f"table(columns: {len(block.header)}, stroke: none, align: left, {rules})"
        return f"#block(breakable: false, width: 100%, align(center, text(size: 9pt, {table})))"

    def exercise(self, block: blocks.Exercise) -> str:
        question = f"*Exercise {self.count['exercise']}.* {self.inline(block.question)}"
        answer = f"#block(inset: (left: 8pt), text(size: 9.3pt, fill: grey)[_Answer._ {self.inline(block.answer)}])"
        return f"#block(breakable: false, width: 100%)[{question}\n\n{answer}]" if block.answer else question

    def summary(self, block: blocks.Summary) -> str:
        return f"#short[{self.inline(block.text)}]"

    def points(self, block: blocks.Points) -> str:
        return f"*{self.inline(block.title)}*\n\n" + "\n".join(f"- {self.inline(item)}" for item in block.items)

    def listing(self, block: blocks.Listing) -> str:
        whole = block.code.count("\n") < ON_A_PAGE
        code = f'#raw({_quoted(block.code)}, lang: "python", block: true)'
        return f"#block(breakable: false)[{code}]" if whole else code
