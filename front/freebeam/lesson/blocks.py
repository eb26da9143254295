"""The lesson as a tree: what it says, apart from how any format prints it.

Text is plain, with `$mathematics$` in LaTeX, `*emphasis*`, `**strong**` and `` `code` ``: every printer knows the four.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any

__all__ = [
    "Block", "Cell", "Check", "Equation", "Erratum", "Exercise", "Figure", "Folded", "Heading", "Lesson", "Listing",
    "Points", "Prose", "Summary", "Table", "spans", "walk",
]  # fmt: skip


@dataclass(frozen=True)
class Heading:
    text: str
    level: int = 2
    key: str = ""


@dataclass(frozen=True)
class Prose:
    text: str


@dataclass(frozen=True)
class Equation:
    """Lines of LaTeX, `&` before what is aligned, printed from one object. number: the paper's, such as "11"."""

    lines: tuple[str, ...]
    number: str = ""

    @property
    def latex(self) -> str:
        """The lines as one formula."""
        if len(self.lines) == 1:
            return (
                re.sub(r"^& ?|(?<!\\)&", "", self.lines[0]) if "pmatrix" not in self.lines[0] else _bare(self.lines[0])
            )
        return r"\begin{split} " + r" \\ ".join(self.lines) + r" \end{split}"


def _bare(line: str) -> str:
    """A line without its alignment; the marks inside a matrix stay."""
    line = line.removeprefix("& ").removeprefix("&")
    return line.replace(" &= ", " = ", 1)


@dataclass(frozen=True)
class Check:
    """What proved the equation above, and what was left of what must vanish: 0.0 where arithmetic is exact."""

    text: str
    residual: float


@dataclass(frozen=True)
class Folded:
    """Long algebra, shown when asked for."""

    summary: str
    blocks: tuple[Block, ...]


@dataclass(frozen=True)
class Erratum:
    """Where the printed paper differs from what is derived."""

    title: str
    paragraphs: tuple[str, ...]


@dataclass(frozen=True)
class Figure:
    """A drawing: `draw` makes matplotlib's axes or figure, `caption` says what is seen."""

    key: str
    draw: Callable[[], Any] = field(compare=False)
    caption: str = ""
    title: str = ""


@dataclass(frozen=True)
class Table:
    header: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]


@dataclass(frozen=True)
class Exercise:
    """A question, the answer that the program computed, and how to come to it."""

    question: str
    answer: str
    method: str = ""


@dataclass(frozen=True)
class Summary:
    """What a chapter comes to, in a sentence or two."""

    text: str


@dataclass(frozen=True)
class Points:
    """A short list with a title: what a lesson presumes, what it is for."""

    title: str
    items: tuple[str, ...]


@dataclass(frozen=True)
class Listing:
    """Python source, as it is."""

    code: str


@dataclass(frozen=True)
class Cell:
    """What a notebook does here in code; other formats print the blocks that it came to."""

    code: str
    blocks: tuple[Block, ...]


Block = (
    Heading
    | Prose
    | Equation
    | Check
    | Folded
    | Erratum
    | Figure
    | Table
    | Exercise
    | Summary
    | Points
    | Listing
    | Cell
)


@dataclass(frozen=True)
class Lesson:
    """A lesson on one column. title, subtitle: words in which no sign has a meaning."""

    title: str
    subtitle: str
    column: str
    blocks: tuple[Block, ...]

    @property
    def all_blocks(self) -> list[Block]:
        return list(walk(self.blocks))

    @property
    def checks(self) -> list[Check]:
        return [block for block in self.all_blocks if isinstance(block, Check)]


def walk(blocks: tuple[Block, ...]) -> Iterator[Block]:
    """Every block, in the order of reading."""
    for block in blocks:
        yield block
        if isinstance(block, Folded | Cell):
            yield from walk(block.blocks)


_SPAN = re.compile(r"\$\$(.+?)\$\$|\$([^$]+)\$|\*\*(.+?)\*\*|\*(.+?)\*|`([^`]+)`")


def spans(text: str) -> Iterator[tuple[str, str]]:
    """Pieces of a text and their kinds: text, display, math, strong, emphasis, code."""
    place = 0
    for match in _SPAN.finditer(text):
        if match.start() > place:
            yield "text", text[place : match.start()]
        kinds = ("display", "math", "strong", "emphasis", "code")
        kind, inner = next((k, g) for k, g in zip(kinds, match.groups(), strict=True) if g is not None)
        yield kind, inner
        place = match.end()
    if place < len(text):
        yield "text", text[place:]
