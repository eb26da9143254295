"""What the printers of the lesson's formats share: one walk over the blocks, a method for each kind of block."""

from __future__ import annotations

import re
from abc import ABC, abstractmethod
from collections import Counter
from collections.abc import Callable, Iterable, Mapping
from importlib.resources import files
from pathlib import Path
from typing import ClassVar

from freebeam.lesson import blocks
from freebeam.lesson.phrases import text
from freebeam.lesson.pictures import image

__all__ = ["Writer", "proven"]


class Writer(ABC):
    """Prints blocks as text. `folder` is where its drawings go, `pictures` are the files that they need."""

    between: ClassVar[str] = "\n\n"
    """What stands between two blocks."""
    spans: ClassVar[Mapping[str, Callable[[str], str]]]
    """How pieces of a text are printed: text, math, display, code; strong and emphasis around what they mark."""

    def __init__(self, folder: Path | None = None) -> None:
        self.folder = folder or Path()
        self.pictures: dict[Path, bytes] = {}
        self.count: Counter[str] = Counter()
        self.proofs: list[str] = []
        """Of a format in which nothing folds: what goes to the end."""

    def joined(self, some: Iterable[blocks.Block]) -> str:
        """Blocks one after the other; those that print nothing are left out."""
        return self.between.join(text for block in some if (text := self.block(block)))

    def block(self, block: blocks.Block) -> str:
        """A block, by the method that is named after its kind. `count` numbers the blocks of each kind."""
        kind = type(block).__name__.lower()
        self.count[kind] += 1
        return str(getattr(self, kind)(block))

    def inline(self, text: str) -> str:
        """A text with its marks."""
        nested = ("strong", "emphasis")
        return "".join(
            self.spans[kind](self.inline(piece) if kind in nested else piece) for kind, piece in blocks.spans(text)
        )

    def plain(self, text: str) -> str:
        """A text without marks: whatever stands in it is shown."""
        return self.spans["text"](text)

    def picture(self, figure: blocks.Figure, format: str) -> Path:
        """Draw a figure into a file of `pictures`."""
        path = self.folder / f"{figure.key}.{format}"
        self.pictures[path] = image(figure, format)
        return path

    def noted(self, check: blocks.Check) -> int:
        """Keep a proof for the end; its number."""
        left = text("proof.left", check=check.text, residual=check.residual) if check.residual else check.text
        self.proofs.append(self.inline(left))
        return len(self.proofs)

    def filled(self, template: str, lesson: blocks.Lesson, **values: str) -> str:
        """A file of this package with what stands for «title», «subtitle» and other names in it."""
        values |= {"title": self.plain(lesson.title), "subtitle": self.plain(lesson.subtitle)}
        text = (files("freebeam.lesson") / template).read_text(encoding="utf-8")
        return re.sub("«([a-z]+)»", lambda place: values[place[1]], text)

    def prose(self, block: blocks.Prose) -> str:
        return self.inline(block.text)

    def cell(self, block: blocks.Cell) -> str:
        return self.joined(block.blocks)

    @abstractmethod
    def heading(self, block: blocks.Heading) -> str: ...

    @abstractmethod
    def equation(self, block: blocks.Equation) -> str: ...

    @abstractmethod
    def check(self, block: blocks.Check) -> str: ...

    @abstractmethod
    def folded(self, block: blocks.Folded) -> str: ...

    @abstractmethod
    def erratum(self, block: blocks.Erratum) -> str: ...

    @abstractmethod
    def figure(self, block: blocks.Figure) -> str: ...

    @abstractmethod
    def table(self, block: blocks.Table) -> str: ...

    @abstractmethod
    def exercise(self, block: blocks.Exercise) -> str: ...

    @abstractmethod
    def summary(self, block: blocks.Summary) -> str: ...

    @abstractmethod
    def points(self, block: blocks.Points) -> str: ...

    @abstractmethod
    def listing(self, block: blocks.Listing) -> str: ...


def proven(check: blocks.Check) -> str:
    """What a check's proof did and left, in a teacher's words."""
    if not check.residual:
        return text("proof.exact", check=check.text)
    return text("proof.rounded", check=check.text, residual=check.residual)
