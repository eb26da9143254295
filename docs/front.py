"""Draw the picture of the front page: python docs/front.py writes docs/front.svg."""

from __future__ import annotations

from pathlib import Path

import freebeam as fb
from freebeam.figures.look import figure
from freebeam.figures.saving import image_of


def main() -> None:
    column = fb.column("free-free")
    with fb.figures.style():
        drawn = figure((10.0, 3.9))
        left, right = drawn.subplots(1, 2)
        fb.figures.frequency_load(column, ax=left)
        left.set_title("Two frequencies meet: flutter")
        fb.figures.tangent(column, ax=right)
        right.set_title("A trace of internal damping: flutter at once lower")
        Path(__file__).with_name("front.svg").write_bytes(image_of(drawn, "svg"))


if __name__ == "__main__":
    main()
