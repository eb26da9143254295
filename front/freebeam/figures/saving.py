"""Pictures and their data as files: the same bytes each time for the same picture."""

from __future__ import annotations

import io
from typing import TYPE_CHECKING, Any

from freebeam.figures.look import style

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from freebeam.figures.published import Picture

__all__ = ["FORMATS", "csv_of", "image_of"]

# What a file would say of when and by which version it was made, left out.
FORMATS: dict[str, dict[str, Any]] = {
    "svg": {"Date": None, "Creator": None},
    "png": {"Software": None},
    "pdf": {"CreationDate": None, "Creator": None, "Producer": None},
}


def image_of(drawn: Figure, format: str, title: str = "") -> bytes:
    """A figure as the bytes of a file of one of FORMATS, which bears a title where one is given."""
    stream = io.BytesIO()
    with style():
        drawn.savefig(stream, format=format, metadata=FORMATS[format] | ({"Title": title} if title else {}))
    return stream.getvalue()


def csv_of(picture: Picture) -> str:
    """The picture's numbers as CSV. Its head, lines that begin with #, holds caption, settings and marked values.

    Numbers are written so that they read back as the same floats.
    """
    head = [f"Fig. {picture.number}. {picture.caption}"]
    head += [f"{name} = {value}" for name, value in {**picture.settings, **picture.marks}.items()]
    lines = [*(f"# {' '.join(line.split())}" for line in head), ",".join(picture.table)]
    columns = [getattr(column, "tolist", lambda column=column: column)() for column in picture.table.values()]
    lines += [",".join(map(str, row)) for row in zip(*columns, strict=True)]
    return "\n".join(lines) + "\n"
