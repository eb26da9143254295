"""Worked solutions of a lesson's exercises: question, method and answer, under the headings of their chapters."""

from __future__ import annotations

from collections.abc import Iterator

from freebeam.lesson.blocks import Block, Exercise, Heading, Lesson, Prose

__all__ = ["solved"]


def solved(lesson: Lesson) -> Iterator[Block]:
    """The blocks of the second file; exercises have the numbers that they have in the lesson."""
    heading: Heading | None = None
    number = 0
    for block in lesson.blocks:
        if isinstance(block, Heading):
            heading = block
        if isinstance(block, Exercise):
            number += 1
            if heading is not None:
                yield heading
                heading = None
            yield Prose(f"**Exercise {number}.** {block.question}")
            yield Prose(f"*Method.* {block.method}")
            yield Prose(f"*Answer.* {block.answer}")
