"""A lesson for one lecture: the chapters that carry the argument, each with its picture and one exercise."""

from __future__ import annotations

from collections.abc import Iterable

from freebeam.lesson.blocks import Block, Cell, Equation, Exercise, Figure, Heading, Points, Prose, Summary
from freebeam.lesson.phrases import data

__all__ = ["minutes", "shortened"]

WORDS, FORMULA, PICTURE, EXERCISE = 130, 1.0, 1.0, 2.0
"""Words a minute of reading aloud, and minutes for what a lecturer writes, shows and asks: an estimate."""


def shortened(blocks: Iterable[Block]) -> list[Block]:
    """The chapters of record.toml's `short`, with the first exercise of each."""
    chapters = data("record.toml")["short"]["chapters"]
    kept: list[Block] = []
    chapter, asked = "", False
    for block in blocks:
        if isinstance(block, Heading) and block.level == 2:
            chapter, asked = block.key, False
        if chapter not in chapters or (isinstance(block, Exercise) and asked):
            continue
        asked = asked or isinstance(block, Exercise)
        kept.append(block)
    return kept


def minutes(blocks: Iterable[Block]) -> float:
    """About how long a lecture takes that says all words, and writes all formulas that are not folded away."""
    total = 0.0
    for block in blocks:
        match block:
            case Cell():
                total += minutes(block.blocks)
            case Prose() | Summary():
                total += len(block.text.split()) / WORDS
            case Points():
                total += sum(len(item.split()) for item in block.items) / WORDS
            case Equation():
                total += FORMULA
            case Figure():
                total += PICTURE
            case Exercise():
                total += EXERCISE
            case _:
                pass
    return total
