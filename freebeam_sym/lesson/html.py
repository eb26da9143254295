"""The lesson as one page of HTML: offline, MathML, SVG; no script, nothing fetched."""

from __future__ import annotations

from html import escape
from pathlib import Path

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
from freebeam_sym.lesson.mathematics import mathml
from freebeam_sym.lesson.pictures import inline_svg

__all__ = ["files"]


def files(lesson: Lesson, output: Path) -> dict[Path, bytes]:
    """The page."""
    body = "\n".join(_Page().blocks(lesson.blocks))
    contents = "\n".join(
        f'<li><a href="#{block.key}">{inline(block.text)}</a></li>'
        for block in lesson.blocks
        if isinstance(block, Heading) and block.level == 2
    )
    style = Path(__file__).with_name("page.css").read_text(encoding="utf-8")
    text = f"""<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="color-scheme" content="light dark">
<title>{escape(lesson.title)}</title>
<style>
{style}
</style>
</head>
<body>
<header>
<p class="kicker">A lesson that derives itself</p>
<h1>{inline(lesson.title)}</h1>
<p class="subtitle">{inline(lesson.subtitle)}</p>
</header>
<nav aria-label="Contents">
<details open>
<summary>Contents</summary>
<ol>
{contents}
</ol>
</details>
</nav>
<main>
{body}
</main>
</body>
</html>
"""
    return {output: text.encode()}


def inline(text: str) -> str:
    """Text with its marks as HTML."""
    tags = {"strong": "strong", "emphasis": "em", "code": "code"}
    parts = []
    for kind, piece in spans(text):
        if kind == "text":
            parts.append(escape(piece, quote=False))
        elif kind == "math":
            parts.append(mathml(piece))
        elif kind == "display":
            parts.append(f'<span class="wide">{mathml(piece.strip(), True)}</span>')
        elif kind == "code":
            parts.append(f"<code>{escape(piece, quote=False)}</code>")
        else:
            parts.append(f"<{tags[kind]}>{inline(piece)}</{tags[kind]}>")
    return "".join(parts)


def _left(residual: float) -> str:
    return f" &middot; leaves {residual:.0e}" if residual else " &middot; leaves nothing"


class _Page:
    def __init__(self) -> None:
        self.exercises = self.figures = 0

    def blocks(self, blocks: tuple[Block, ...]) -> list[str]:
        return [self.block(block) for block in blocks]

    def block(self, block: Block) -> str:
        match block:
            case Heading():
                key = f' id="{block.key}"' if block.key else ""
                return f"<h{block.level}{key}>{inline(block.text)}</h{block.level}>"
            case Prose():
                return f"<p>{inline(block.text)}</p>"
            case Equation():
                number = f'<span class="number">({block.number})</span>' if block.number else ""
                return f'<div class="equation"><div class="formula">{mathml(block.latex, True)}</div>{number}</div>'
            case Check():
                return f'<p class="check"><b>checked:</b> {inline(block.text)}{_left(block.residual)}</p>'
            case Folded():
                inner = "\n".join(self.blocks(block.blocks))
                return f"<details><summary>{inline(block.summary)}</summary>\n{inner}\n</details>"
            case Erratum():
                inner = "\n".join(f"<p>{inline(p.removeprefix('- '))}</p>" for p in block.paragraphs)
                return (
                    f'<aside class="erratum"><p class="label">Erratum of the paper</p><h3>{inline(block.title)}</h3>'
                    f"\n{inner}\n</aside>"
                )
            case Figure():
                self.figures += 1
                picture = inline_svg(block).replace("@@", escape(block.caption), 1)
                caption = f"<b>Figure {self.figures}. {inline(block.title)}.</b> {inline(block.caption)}"
                return f"<figure>\n{picture}\n<figcaption>{caption}</figcaption>\n</figure>"
            case Table():
                head = "".join(f"<th>{inline(cell)}</th>" for cell in block.header)
                rows = "\n".join(
                    "<tr>" + "".join(f"<td>{inline(cell)}</td>" for cell in row) + "</tr>" for row in block.rows
                )
                whole = f"<thead><tr>{head}</tr></thead>\n<tbody>\n{rows}\n</tbody>"
                return f'<div class="table"><table>\n{whole}\n</table></div>'
            case Exercise():
                self.exercises += 1
                return (
                    f'<section class="exercise"><p><b>Exercise {self.exercises}.</b> {inline(block.question)}</p>\n'
                    f"<details><summary>Answer</summary><p>{inline(block.answer)}</p></details></section>"
                )
            case Listing():
                return f"<pre><code>{escape(block.code, quote=False)}</code></pre>"
            case Cell():
                return "\n".join(self.blocks(block.blocks))
