"""`freebeam figures`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from freebeam_sym.cli.application import app
from freebeam_sym.cli.options import JsonOption
from freebeam_sym.cli.output import print_json, working, written


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
    from freebeam_sym.checks import InputError
    from freebeam_sym.figures import published
    from freebeam_sym.figures.files import FORMATS, csv_of, image_of
    from freebeam_sym.figures.look import style

    if format not in FORMATS:
        raise InputError(f"--format {format}: must be one of {', '.join(FORMATS)}")
    wanted = dict.fromkeys(_number(text, published.NUMBERS) for text in number or map(str, published.NUMBERS))
    files = {n: [output / f"figure-{n:02}.{kind}" for kind in (format, "csv")] for n in wanted}
    done: list[dict[str, Any]] = []
    with style(), working("figures") as report:
        # What is in the way is said before the work, not after it.
        try:
            output.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise InputError(f"{output}: is no folder to write to ({error.strerror})") from None
        kept = [file for pair in files.values() for file in pair if file.exists() and not force]
        if kept:
            more = f" (and {len(kept) - 1} more)" if kept[1:] else ""
            raise InputError(f"{kept[0]}{more}: exists and is kept; give another folder, or --force to replace it")
        for count, n in enumerate(wanted, 1):
            report(f"Fig. {n} ({count} of {len(wanted)})")
            found = published.picture(n)
            image = image_of(found.draw(), format, f"Fig. {n}. {found.title}")
            for file, content in zip(files[n], (image, csv_of(found).encode()), strict=True):
                with written(file, force) as stream:
                    stream.write(content)
            done.append({
                "number": n, "title": found.title, "caption": found.caption, "settings": found.settings,
                "marks": found.marks, "picture": files[n][0], "data": files[n][1],
            })  # fmt: skip
    if as_json:
        print_json({"output": output, "format": format, "figures": done})
        return
    for entry in done:
        typer.echo(f"{entry['picture']}: {entry['title']}")


def _number(text: str, known: tuple[int, ...]) -> int:
    from freebeam_sym.checks import InputError

    if not text.isdecimal() or int(text) not in known:
        raise InputError(f"figure {text}: there is none; the paper's figures are {known[0]} to {known[-1]}")
    return int(text)
