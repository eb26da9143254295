"""`freebeam figures`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from freebeam.cli.application import app
from freebeam.cli.options import JsonOption
from freebeam.cli.output import print_json, working, written


@app.command(epilog="Example: freebeam figures 2 10 --output figures --format png")
def figures(
    output: Annotated[Path, typer.Option("--output", metavar="DIR", help="Folder to write to; made if need be.")],
    number: Annotated[list[str] | None, typer.Argument(metavar="[NUMBER]...", help="Which; all where none is.")] = None,
    format: Annotated[str, typer.Option("--format", metavar="svg|png|pdf", help="Kind of picture.")] = "svg",
    force: Annotated[bool, typer.Option("--force", help="Replace files that exist.")] = False,
    as_json: JsonOption = False,
) -> None:
    """Redraw the paper's figures from computed data, each with a CSV of what it shows.

    The CSV's head holds the caption with the settings, and the values that the figure marks.
    """
    from freebeam.figures import published
    from freebeam.figures.look import style
    from freebeam.figures.saving import FORMATS, csv_of, image_of
    from freebeam_sym.checks import InputError

    if format not in FORMATS:
        raise InputError(f"--format {format}: must be one of {', '.join(FORMATS)}")
    wanted = dict.fromkeys(_number(text, published.NUMBERS) for text in number or map(str, published.NUMBERS))
    done: list[dict[str, Any]] = []
    made: dict[Path, bytes] = {}
    with style(), working("figures") as report:
        try:
            output.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise InputError(f"{output}: is no folder to write to ({error.strerror})") from None
        for count, n in enumerate(wanted, 1):
            report(f"Fig. {n} ({count} of {len(wanted)})")
            found = published.picture(n)
            picture, data = (output / f"figure-{n:02}.{kind}" for kind in (format, "csv"))
            made[picture] = image_of(found.draw(), format, f"Fig. {n}. {found.title}")
            made[data] = csv_of(found).encode()
            done.append({
                "number": n, "title": found.title, "caption": found.caption, "settings": found.settings,
                "marks": found.marks, "picture": picture, "data": data,
            })  # fmt: skip
        # a figure's data are the same beside each kind of picture: what is there already is not in the way
        new = {file: content for file, content in made.items() if not _holds(file, content)}
        kept = [str(file) for file in new if file.exists() and not force]
        if kept:
            raise InputError(
                f"{', '.join(kept)}: exists with other content and is kept; give another folder, or --force to replace "
                f"{'them' if kept[1:] else 'it'}"
            )
        for file, content in new.items():
            with written(file, force) as stream:
                stream.write(content)
    if as_json:
        print_json({"output": output, "format": format, "figures": done})
        return
    for entry in done:
        typer.echo(f"{entry['picture']}: {entry['title']}")


def _holds(file: Path, content: bytes) -> bool:
    """Whether a file is there with this content."""
    try:
        return file.read_bytes() == content
    except OSError:
        return False


def _number(text: str, known: tuple[int, ...]) -> int:
    from freebeam_sym.checks import InputError

    if not text.isdecimal() or int(text) not in known:
        raise InputError(f"figure {text}: there is none; the paper's figures are {known[0]} to {known[-1]}")
    return int(text)
