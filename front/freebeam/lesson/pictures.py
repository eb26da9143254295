"""The lesson's drawings as files and as SVG that follows a page's colours."""

from __future__ import annotations

import logging
import re
from typing import TYPE_CHECKING

from freebeam.lesson.blocks import Figure

if TYPE_CHECKING:
    from matplotlib.figure import Figure as Drawing

__all__ = ["image", "inline_svg"]

# Colours of the drawings (figures/look.py) and the variables of the page that stand for them.
_THEMED = {
    "#222222": "var(--ink)", "#000000": "var(--ink)", "#ffffff": "var(--paper)", "#e4e4e4": "var(--grid)",
    "#757575": "var(--muted)", "#0072b2": "var(--blue)", "#e69f00": "var(--amber)", "#009e73": "var(--green)",
    "#d55e00": "var(--accent)", "#f1f1f1": "var(--shade)", "#d6e3ec": "var(--body)",
}  # fmt: skip


def _drawn(figure: Figure) -> Drawing:
    from freebeam.figures.look import style

    with style():
        made = figure.draw()
    return getattr(made, "figure", made)  # type: ignore[no-any-return]


def image(figure: Figure, format: str) -> bytes:
    """A drawing as the bytes of a file: svg, png or pdf."""
    from matplotlib import pyplot

    from freebeam.figures.saving import image_of

    drawn = _drawn(figure)
    fonts = logging.getLogger("fontTools")  # it logs the dates of each font that a PDF takes letters from
    level = fonts.level
    fonts.setLevel(logging.ERROR)
    try:
        return image_of(drawn, format)
    finally:
        fonts.setLevel(level)
        pyplot.close(drawn)


def inline_svg(figure: Figure) -> str:
    """A drawing as SVG within HTML: no namespaces or references, ids of its own, colours of the page."""
    text = image(figure, "svg").decode()
    text = text[text.index("<svg") :]
    text = re.sub(r"<metadata>.*?</metadata>", "", text, flags=re.DOTALL)
    text = re.sub(r'\sxmlns(:\w+)?="[^"]*"', "", text)
    text = re.sub(r"<!--.*?-->", "", text, flags=re.DOTALL)
    text = re.sub(r'\b(id="|xlink:href="#|url\(#)', rf"\g<1>{figure.key}-", text).replace("xlink:href", "href")
    for colour, variable in _THEMED.items():
        text = re.sub(colour, variable, text, flags=re.IGNORECASE)
    # attributes take no variables: what is drawn without a style is ink
    text = re.sub(
        r'<svg\b[^>]*?viewBox="([^"]*)"[^>]*>', r'<svg viewBox="\1" role="img" aria-label="@@">', text, count=1
    )
    return text.strip()
