"""`freebeam columns` and `freebeam generate`."""

from __future__ import annotations

import sys
from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import typer

from freebeam.cli.application import app
from freebeam.cli.options import JsonOption
from freebeam.cli.output import print_json, print_table, working


@app.command(epilog="Example: freebeam columns")
def columns(as_json: JsonOption = False) -> None:
    """List the columns with their ends and parameters.

    Of each parameter: its default and, in brackets, the range of interest, which is what plots show. It is no limit.
    """
    import freebeam as fb

    found = [fb.column(name) for name in fb.column_names()]
    if as_json:
        keys = ("name", "title", "ends", "damping")
        print_json({
            "columns": [
                {key: getattr(column, key) for key in keys}
                | {"parameters": [asdict(parameter) for parameter in column.parameters]}
                for column in found
            ]
        })  # fmt: skip
        return
    rows = [
        [
            column.name,
            column.title,
            "-".join(column.ends),
            "; ".join(
                f"{p.name} = {p.default:g} (of interest {p.low:g} to {p.high:g}): {p.meaning}"
                for p in column.parameters
            ),
        ]
        for column in found
    ]
    print_table(rows, ["name", "title", "ends", "parameters"])
    print("A range of interest is what plots show; any value may be set.")


@app.command(epilog="Example: freebeam generate path/to/column.py --output kernels")
def generate(
    targets: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="[COLUMN|FILE]...",
            help="Columns to derive; freebeam's own by default. A column's file is a Python program, which is run.",
        ),
    ] = None,
    output: Annotated[
        Path | None, typer.Option(metavar="DIR", help="Folder of the kernels; freebeam's own by default.")
    ] = None,
    check: Annotated[
        bool, typer.Option("--check", help="Write nothing; print a diff and exit 1 where the folder differs.")
    ] = False,
    as_json: JsonOption = False,
) -> None:
    """Derive columns from their energies, emit their kernels and verify them."""
    from freebeam_derive import pipeline
    from freebeam_derive.statement import StatementError
    from freebeam_derive.verify import VerificationError
    from freebeam_sym.checks import InputError

    files = [target for target in targets or () if target not in pipeline.columns()]
    if files and output is None:
        raise InputError(f"{files[0]}: is not freebeam's own; name a folder for its kernel with --output")
    try:
        with working("generate") as report:
            outcome = pipeline.generate(targets or (), output, report, check)
    except StatementError as error:
        raise InputError(str(error)) from error
    except VerificationError as error:
        print(f"freebeam: nothing is written: {error}", file=sys.stderr)
        raise typer.Exit(1) from error
    worst = {
        name: max(figures, key=lambda figure: figure.error / figure.bound) for name, figures in outcome.figures.items()
    }
    if as_json:
        print_json({
            "columns": outcome.columns,
            "output": outcome.output,
            "check": check,
            "written": outcome.written,
            "difference": outcome.difference,
            "errors": {name: asdict(figure) for name, figure in worst.items()},
        })  # fmt: skip
    elif check:
        sys.stdout.write(outcome.difference or f"{outcome.output}: is what the derivation emits\n")
    else:
        rows = [
            [name, f"{figure.error:.1e}", f"{figure.bound:.1e}", f"{figure.what}, {figure.where}"]
            for name, figure in worst.items()
        ]
        header = ["column", "largest error", "bound", "of"]
        print_table(rows, header, f"Emitted to {outcome.output}, verified")
    if outcome.difference:
        raise typer.Exit(1)
