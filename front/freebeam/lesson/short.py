"""A lesson for one lecture: the chapters that carry the argument, each with its picture and one exercise."""

from __future__ import annotations

from collections.abc import Iterable

from freebeam.lesson.blocks import Block, Exercise, Heading
from freebeam.lesson.phrases import data

__all__ = ["shortened"]


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
