"""The lesson as one page of HTML: offline, MathML with its own letters, SVG; no script, nothing fetched."""

from __future__ import annotations

from base64 import b64encode
from functools import partial
from html import escape
from pathlib import Path
from typing import ClassVar

from freebeam.lesson import blocks
from freebeam.lesson.mathematics import mathml, width
from freebeam.lesson.phrases import text
from freebeam.lesson.pictures import inline_svg
from freebeam.lesson.writer import Writer, proven

__all__ = ["files"]

ROOM = 88
"""Letters of a formula that fit a line of the page; a longer one is set smaller. Measured at a width of 1100 pixels."""


def files(lesson: blocks.Lesson, output: Path) -> dict[Path, bytes]:
    """The page."""
    page = _Page()
    body = page.joined(lesson.blocks)
    contents = "\n".join(
        f'<li><a href="#{block.key}">{page.inline(block.text)}</a></li>'
        for block in lesson.blocks
        if isinstance(block, blocks.Heading) and block.level == 2
    )
    here = Path(__file__).parent
    letters = b64encode((here / "font" / "math.woff2").read_bytes()).decode()
    style = (here / "page.css").read_text(encoding="utf-8").replace("math.woff2", f"data:font/woff2;base64,{letters}")
    text = page.filled("page.html", lesson, name=escape(lesson.title), style=style, contents=contents, body=body)
    return {output: text.encode()}


class _Page(Writer):
    between = "\n"
    spans: ClassVar = {
        "text": partial(escape, quote=False),
        "math": mathml,
        "display": lambda piece: f'<span class="wide">{mathml(piece.strip(), True)}</span>',
        "code": lambda piece: f"<code>{escape(piece, quote=False)}</code>",
        "strong": "<strong>{}</strong>".format,
        "emphasis": "<em>{}</em>".format,
    }

    def heading(self, block: blocks.Heading) -> str:
        key = f' id="{block.key}"' if block.key else ""
        return f"<h{block.level}{key}>{self.inline(block.text)}</h{block.level}>"

    def prose(self, block: blocks.Prose) -> str:
        return f"<p>{self.inline(block.text)}</p>"

    def equation(self, block: blocks.Equation) -> str:
        number = f'<span class="number">({block.number})</span>' if block.number else ""
        wide = max(map(width, block.lines))
        size = f' style="font-size: {max(ROOM / wide, 0.5):.2f}em"' if wide > ROOM else ""
        return f'<div class="equation"><div class="formula"{size}>{mathml(block.latex, True)}</div>{number}</div>'

    def check(self, block: blocks.Check) -> str:
        title = text("proof.title")
        return f'<details class="proof"><summary>{title}</summary><p>{self.inline(proven(block))}</p></details>'

    def folded(self, block: blocks.Folded) -> str:
        summary = self.inline(block.summary)
        return f"<details><summary>{summary}</summary>\n{self.joined(block.blocks)}\n</details>"

    def erratum(self, block: blocks.Erratum) -> str:
        inner = "\n".join(f"<p>{self.inline(p.removeprefix('- '))}</p>" for p in block.paragraphs)
        return (
            f'<aside class="erratum"><p class="label">Erratum of the paper</p><h3>{self.inline(block.title)}</h3>'
            f"\n{inner}\n</aside>"
        )

    def figure(self, block: blocks.Figure) -> str:
        picture = inline_svg(block).replace("@@", escape(block.caption), 1)
        title = f"<b>Figure {self.count['figure']}. {self.inline(block.title)}.</b>"
        return f"<figure>\n{picture}\n<figcaption>{title} {self.inline(block.caption)}</figcaption>\n</figure>"

    def table(self, block: blocks.Table) -> str:
        head, *rows = (
            "".join(f"<{tag}>{self.inline(cell)}</{tag}>" for cell in row)
            for tag, row in [("th", block.header), *(("td", row) for row in block.rows)]
        )
        body = "\n".join(f"<tr>{row}</tr>" for row in rows)
        whole = f"<thead><tr>{head}</tr></thead>\n<tbody>\n{body}\n</tbody>"
        return f'<div class="table"><table>\n{whole}\n</table></div>'

    def exercise(self, block: blocks.Exercise) -> str:
        question = f"<p><b>Exercise {self.count['exercise']}.</b> {self.inline(block.question)}</p>"
        answer = f"\n<details><summary>Answer</summary><p>{self.inline(block.answer)}</p></details>"
        return f'<section class="exercise">{question}{answer if block.answer else ""}</section>'

    def summary(self, block: blocks.Summary) -> str:
        return f'<p class="summary"><b>In short.</b> {self.inline(block.text)}</p>'

    def points(self, block: blocks.Points) -> str:
        items = "\n".join(f"<li>{self.inline(item)}</li>" for item in block.items)
        return f"<p><b>{self.inline(block.title)}</b></p>\n<ul>\n{items}\n</ul>"

    def listing(self, block: blocks.Listing) -> str:
        return f"<pre><code>{escape(block.code, quote=False)}</code></pre>"
