"""`freebeam explore`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from freebeam.cli.application import app
from freebeam.cli.options import BasisOption, ColumnOption, JsonOption
from freebeam.cli.output import print_json, working, written


@app.command(epilog="Example: freebeam explore --column beck --output beck.html")
def explore(
    output: Annotated[Path, typer.Option("--output", metavar="FILE", help="The .html file to write.")],
    column: ColumnOption = "free-free",
    basis: BasisOption = None,
    force: Annotated[bool, typer.Option("--force", help="Replace an output that exists.")] = False,
    as_json: JsonOption = False,
) -> None:
    """Write a page to play with: one file that works offline, in any browser."""
    import freebeam as fb
    from freebeam_sym.checks import InputError

    if output.suffix not in (".html", ".htm"):
        raise InputError(f"{output}: the name must end in .html")
    with written(output, replace=force) as stream, working("explorer"):
        from freebeam.explorer import page

        chosen = fb.column(column, basis)
        text = page(chosen, column).encode()
        stream.write(text)
    if as_json:
        print_json({"output": output, "column": chosen.name, "basis": chosen.basis_name, "bytes": len(text)})
    else:
        typer.echo(f"{output}: {len(text) / 1e3:.0f} kB; open it in a browser")
