"""The lesson as Markdown, with mathematics in dollars; its drawings are files beside it."""

from __future__ import annotations

import re
from pathlib import Path

from freebeam.lesson import blocks
from freebeam.lesson.phrases import text
from freebeam.lesson.writer import Writer, proven

__all__ = ["Markdown", "files"]


def files(lesson: blocks.Lesson, output: Path) -> dict[Path, bytes]:
    """The text, and its drawings in a folder named after it."""
    page = Markdown(output.with_name(f"{output.stem}_files"))
    text = f"{page.opening(lesson)}\n\n{page.joined(lesson.blocks)}\n"
    return {output: text.encode(), **page.pictures}


class Markdown(Writer):
    """Prints blocks; texts have Markdown's marks as they are."""

    def inline(self, text: str) -> str:
        return text

    def plain(self, text: str) -> str:
        """What Markdown, HTML or a renderer of mathematics would take for a mark is given by its number."""
        return re.sub(r"[\\`*_{}\[\]<>&$#~|^@]", lambda found: f"&#{ord(found[0])};", text)

    def opening(self, lesson: blocks.Lesson) -> str:
        return f"# {self.plain(lesson.title)}\n\n*{self.plain(lesson.subtitle)}*"

    def heading(self, block: blocks.Heading) -> str:
        return f"{'#' * block.level} {block.text}"

    def equation(self, block: blocks.Equation) -> str:
        tag = rf" \tag{{{block.number}}}" if block.number else ""
        return f"$$\n{block.latex}{tag}\n$$"

    def check(self, block: blocks.Check) -> str:
        return f"<details><summary>{text('proof.title')}</summary>\n\n{proven(block)}\n\n</details>"

    def folded(self, block: blocks.Folded) -> str:
        return f"<details><summary>{block.summary}</summary>\n\n{self.joined(block.blocks)}\n\n</details>"

    def erratum(self, block: blocks.Erratum) -> str:
        lines = [f"**Erratum of the paper. {block.title}**", *block.paragraphs]
        return "\n>\n".join(f"> {line}" for line in lines)

    def figure(self, block: blocks.Figure) -> str:
        path = f"{self.folder.name}/{self.picture(block, 'svg').name}"
        return f"![{block.title}]({path})\n\n*Figure {self.count['figure']}. {block.title}.* {block.caption}"

    def table(self, block: blocks.Table) -> str:
        rows = [block.header, tuple("---" for _ in block.header), *block.rows]
        return "\n".join("| " + " | ".join(row) + " |" for row in rows)

    def exercise(self, block: blocks.Exercise) -> str:
        question = f"**Exercise {self.count['exercise']}.** {block.question}"
        answer = f"\n\n<details><summary>Answer</summary>\n\n{block.answer}\n\n</details>"
        return question + (answer if block.answer else "")

    def summary(self, block: blocks.Summary) -> str:
        return f"**In short.** {block.text}"

    def points(self, block: blocks.Points) -> str:
        return f"**{block.title}**\n\n" + "\n".join(f"- {item}" for item in block.items)

    def listing(self, block: blocks.Listing) -> str:
        fence = "`" * max(3, *(len(ticks) + 1 for ticks in re.findall("`+", block.code + "`")))
        return f"{fence}python\n{block.code}\n{fence}"
