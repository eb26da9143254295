"""`freebeam lesson`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from freebeam.cli.application import app
from freebeam.cli.options import ColumnOption, JsonOption
from freebeam.cli.output import print_json, working, written


@app.command(epilog="Example: freebeam lesson --column beck --format html --output lesson.html")
def lesson(
    format: Annotated[str, typer.Option("--format", metavar="html|md|tex|ipynb|pdf", help="What to write.")],
    output: Annotated[Path, typer.Option("--output", metavar="FILE", help="The file to write.")],
    column: ColumnOption = "free-free",
    force: Annotated[bool, typer.Option("--force", help="Replace what exists.")] = False,
    as_json: JsonOption = False,
) -> None:
    """Write the lesson on a column: its derivation with every step's proof, then the physics, with exercises.

    md and tex write their drawings to a folder beside FILE.
    """
    from freebeam.lesson import FORMATS, printed
    from freebeam.lesson import lesson as made
    from freebeam_sym.checks import InputError

    if format not in FORMATS:
        raise InputError(f"format = {format!r}: must be one of {', '.join(FORMATS)}")
    beside = output.with_name(f"{output.stem}_files") if format in ("md", "tex") else None
    for path in (output, beside):
        if path is not None and path.exists() and not force:
            raise InputError(f"{path}: exists and is kept; give another name, or --force to replace it")
    if not output.parent.is_dir():
        raise InputError(f"{output}: cannot be written (its folder does not exist); make it, or name another --output")
    with working("lesson") as report:
        found = made(column, report)
        report(f"printing {format}")
        files = printed(found, format, output)
    if beside is not None:
        beside.mkdir(exist_ok=True)
    for path, data in sorted(files.items(), key=lambda item: item[0] == output):  # the text last, when all is there
        with written(path, force) as stream:
            stream.write(data)
    if as_json:
        print_json({
            "column": found.column,
            "format": format,
            "written": [*files],
            "checks": len(found.checks),
            "largest_residual": max(check.residual for check in found.checks),
        })  # fmt: skip
        return
    typer.echo(f"{output}: {found.title}; {len(found.checks)} checks, all passed")
