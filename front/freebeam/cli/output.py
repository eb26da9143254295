"""What commands print and write: JSON, tables, signs of work, files that appear whole or not at all."""

from __future__ import annotations

import json
import math
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import asdict, is_dataclass
from pathlib import Path
from typing import IO, Any

from freebeam.cli.options import Number


def plain(value: Any) -> Any:
    """A value as JSON has it: dataclasses as objects, arrays as lists, complex numbers as [re, im], what is not finite
    as null."""
    if hasattr(value, "tolist"):
        value = value.tolist()
    if is_dataclass(value) and not isinstance(value, (type, Number)):
        value = asdict(value)
    if isinstance(value, Mapping):
        return {str(key): plain(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [plain(item) for item in value]
    if isinstance(value, complex):
        return [plain(value.real), plain(value.imag)]
    if isinstance(value, Number):
        return float(value) if math.isfinite(float(value)) else str(value)
    if isinstance(value, float) and not math.isfinite(value):
        return None
    if isinstance(value, Path):
        return str(value)
    return value


def print_json(record: Mapping[str, Any]) -> None:
    sys.stdout.write(json.dumps(plain(record), allow_nan=False, ensure_ascii=False) + "\n")


def print_table(rows: Sequence[Sequence[str]], header: Sequence[str] | None = None, title: str = "") -> None:
    """Print rows of cells as a table; a last column that is too wide for the terminal is folded."""
    from rich import box
    from rich.console import Console
    from rich.table import Table
    from rich.text import Text

    table = Table(box=box.SIMPLE_HEAD if header else None, show_header=header is not None, pad_edge=False)
    for name in header or [""] * len(rows[0]):
        table.add_column(name, overflow="fold")
    for row in rows:
        table.add_row(*(Text(cell) for cell in row))
    # Without a terminal there is no width to fit, so that no cell of a file or a pipe is folded.
    console = Console(width=None if sys.stdout.isatty() else 1000, highlight=False)
    with console.capture() as printed:
        if title:
            console.print(Text(title, style="bold"))
        console.print(table)
    sys.stdout.write("".join(f"{line.rstrip()}\n" for line in printed.get().rstrip().split("\n")))


@contextmanager
def working(text: str) -> Iterator[Callable[[str], None]]:
    """Show on a terminal, on standard error, that work goes on, and what it is about."""
    if not sys.stderr.isatty():
        yield lambda _: None
        return
    from rich.console import Console

    with Console(stderr=True).status(text) as status:
        yield lambda step: status.update(f"{text}: {step}")


@contextmanager
def written(path: Path, replace: bool) -> Iterator[IO[bytes]]:
    """A file that appears at `path` whole or not at all; `freebeam_derive.files.written`. Raises OSError, which the
    command line tells in one line."""
    from freebeam_derive.files import written

    with written(path, replace) as stream:
        yield stream


def write_picture(path: Path, replace: bool, draw: Callable[[], Any], title: str) -> None:
    """Draw a figure and write it as the kind of file that the path names. Raises InputError, before it is drawn, for a
    kind that there is not, a file that is in the way and packages that are missing."""
    from freebeam.cli.options import refuse
    from freebeam.figures.look import style
    from freebeam.figures.saving import FORMATS, image_of

    format = path.suffix.removeprefix(".")
    refuse(format not in FORMATS, f"{path}: the name must end in {', '.join('.' + name for name in FORMATS)}")
    with written(path, replace) as stream, style():
        stream.write(image_of(draw(), format, title))


def folder(path: Path) -> None:
    """A folder to write to, made if need be. Raises InputError."""
    from freebeam_sym.checks import InputError

    try:
        path.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(f"{path}: is no folder to write to ({error.strerror})") from None
