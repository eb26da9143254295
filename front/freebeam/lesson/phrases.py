"""The lesson's words, from text.toml, with numbers put in; and the pieces that its chapters are made of."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Callable, Mapping
from functools import lru_cache
from importlib.resources import files
from typing import Any

from freebeam.lesson.blocks import Cell, Exercise, Figure, Heading, Prose, Summary

__all__ = ["arguments", "data", "exercise", "figure", "heading", "n", "percent", "prose", "summary", "text", "words"]


@lru_cache(maxsize=8)
def data(name: str) -> Mapping[str, Any]:
    """A file of this package, text.toml or record.toml."""
    return tomllib.loads((files("freebeam.lesson") / name).read_text(encoding="utf-8"))


@lru_cache(maxsize=1)
def words() -> Mapping[str, Any]:
    """All texts, those of text.toml and those of general.toml, which may share a chapter."""
    found = {chapter: dict(texts) for chapter, texts in data("text.toml").items()}
    for chapter, texts in data("general.toml").items():
        found[chapter] = found.get(chapter, {}) | texts
    return found


def at(key: str) -> Any:
    """A text, or a table of texts, by its place. Raises KeyError for one that there is not."""
    found: Any = words()
    for part in key.split("."):
        found = found[part]
    return found


def text(key: str, **values: Any) -> str:
    """A text by its place in text.toml, such as "work.opening", with its values; how they are written stands there.

    Raises KeyError for a place that there is not, and for a value that is missing.
    """
    found = at(key)

    def written(place: re.Match[str]) -> str:
        value = values[place[1]]
        if place[3]:
            return format(value, place[3])
        return n(value, int(place[2] or 5)) if isinstance(value, float) else str(value)

    return re.sub(r"«(\w+)(?: (\d+)|:([^»]+))?»", written, " ".join(found.split()))


def prose(key: str, **values: Any) -> Prose:
    """A paragraph of text.toml."""
    return Prose(text(key, **values))


def heading(chapter: str) -> Heading:
    """The heading of a chapter of text.toml, with its name as the key."""
    return Heading(text(f"{chapter}.title"), 2, chapter)


def exercise(key: str, answer: str = "answer", **values: Any) -> Exercise:
    """An exercise of text.toml; answer: which of its answers, where it has several."""
    question, answered = text(f"{key}.question", **values), text(f"{key}.{answer}", **values)
    method = text(f"{key}.method", **values) if "method" in at(key) else ""
    return Exercise(question, answered, method)


def summary(key: str, **values: Any) -> Summary:
    """What a chapter comes to, of text.toml."""
    return Summary(text(key, **values))


def n(value: float, digits: int = 5) -> str:
    """A number for a sentence."""
    value = value or 0.0  # no minus zero
    if value == 0 or 1e-3 <= abs(value) < 1e5:
        return f"${value:.{digits}g}$" if abs(value) < 10**digits else f"${value:.0f}$"
    mantissa, exponent = f"{value:.{max(digits - 3, 1)}e}".split("e")
    return rf"${mantissa} \cdot 10^{{{int(exponent)}}}$"


def arguments(values: Mapping[str, float]) -> str:
    """Values by name as further arguments of a call."""
    return "".join(f", {name}={value:g}" for name, value in values.items())


def percent(share: float) -> str:
    """A share's size in per cent."""
    size = abs(100 * share)
    if size < 1e-11:
        return "0 %"
    return f"{size:.2g} %" if size < 10 else f"{size:.0f} %"


def figure(key: str, name: str, call: str, draw: Callable[[], Any], caption: str) -> Cell:
    """A drawing of `fb.figures`, and the notebook's cell that draws it."""
    function, _, arguments = call.partition("(")
    return Cell(f"draw(fb.figures.{function}, {arguments}", (Figure(key, draw, caption, name),))
