"""The lesson as Markdown, with mathematics in dollars; its drawings are files beside it."""

from __future__ import annotations

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
)
from freebeam_sym.lesson.pictures import image

__all__ = ["Markdown", "files"]


def files(lesson: Lesson, output: Path) -> dict[Path, bytes]:
    """The text, and its drawings in a folder named after it."""
    folder = output.with_name(f"{output.stem}_files")
    page = Markdown(folder)
    body = "\n\n".join(page.blocks(lesson.blocks))
    text = f"# {lesson.title}\n\n*{lesson.subtitle}*\n\n{body}\n"
    return {output: text.encode(), **page.pictures}


class Markdown:
    """Prints blocks; `pictures` are the files that they need."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.pictures: dict[Path, bytes] = {}
        self.exercises = self.figures = 0

    def blocks(self, blocks: tuple[Block, ...]) -> list[str]:
        return [text for block in blocks if (text := self.block(block))]

    def block(self, block: Block) -> str:
        match block:
            case Heading():
                return f"{'#' * block.level} {block.text}"
            case Prose():
                return block.text
            case Equation():
                tag = rf" \tag{{{block.number}}}" if block.number else ""
                return f"$$\n{block.latex}{tag}\n$$"
            case Check():
                return (
                    f"> ✓ *checked:* {block.text} · leaves {f'{block.residual:.0e}' if block.residual else 'nothing'}"
                )
            case Folded():
                inner = "\n\n".join(self.blocks(block.blocks))
                return f"<details><summary>{block.summary}</summary>\n\n{inner}\n\n</details>"
            case Erratum():
                lines = [f"**Erratum of the paper. {block.title}**", *block.paragraphs]
                return "\n>\n".join(f"> {line}" for line in lines)
            case Figure():
                self.figures += 1
                path = self.folder / f"{block.key}.svg"
                self.pictures[path] = image(block, "svg")
                caption = f"*Figure {self.figures}. {block.title}.* {block.caption}"
                return f"![{block.title}]({self.folder.name}/{path.name})\n\n{caption}"
            case Table():
                rows = [block.header, tuple("---" for _ in block.header), *block.rows]
                return "\n".join("| " + " | ".join(row) + " |" for row in rows)
            case Exercise():
                self.exercises += 1
                answer = f"<details><summary>Answer</summary>\n\n{block.answer}\n\n</details>"
                return f"**Exercise {self.exercises}.** {block.question}\n\n{answer}"
            case Listing():
                return f"```python\n{block.code}\n```"
            case Cell():
                return "\n\n".join(self.blocks(block.blocks))
