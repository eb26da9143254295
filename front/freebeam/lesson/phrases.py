"""Numbers in sentences, and the pieces that the chapters of physics are made of."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from freebeam.lesson.blocks import Block, Cell, Figure

if TYPE_CHECKING:
    from freebeam.lesson.stages import Chapter

__all__ = ["figure", "n", "percent", "steps"]


def n(value: float, digits: int = 5) -> str:
    """A number for a sentence."""
    value = value or 0.0  # no minus zero
    if value == 0 or 1e-3 <= abs(value) < 1e5:
        return f"${value:.{digits}g}$" if abs(value) < 10**digits else f"${value:.0f}$"
    mantissa, exponent = f"{value:.{max(digits - 3, 1)}e}".split("e")
    return rf"${mantissa} \cdot 10^{{{int(exponent)}}}$"


def percent(share: float) -> str:
    size = abs(100 * share)
    if size < 1e-11:
        return "0 %"
    return f"{size:.2g} %" if size < 10 else f"{size:.0f} %"


def steps(chapter: Chapter, *names: str) -> list[Block]:
    found: list[Block] = []
    for name in names:
        step = chapter.find(name)
        if step is not None:
            found += chapter.step(step)
    return found


def figure(key: str, name: str, call: str, draw: Callable[[], Any], caption: str) -> Cell:
    """A drawing of `fb.figures`, and the notebook's cell that draws it."""
    function, _, arguments = call.partition("(")
    return Cell(f"draw(fb.figures.{function}, {arguments}", (Figure(key, draw, caption, name),))
