"""`freebeam columns` and `freebeam generate`."""

from __future__ import annotations

import sys
from itertools import groupby
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from freebeam.cli.application import command
from freebeam.cli.options import Options, argument, flag, option, refuse
from freebeam.cli.output import print_json, print_table, working

if TYPE_CHECKING:
    from freebeam_derive.pipeline import Outcome
    from freebeam_derive.statement import Column, Parameter


@command("freebeam columns")
class Columns(Options):
    """List the columns by family, with their ends and parameters.

    Each parameter has a default and, in brackets, a range of interest: the range that plots show. Any value may be set.
    A column whose kernel does not come with freebeam is derived when it is first used, which takes a second or two.
    """

    def run(self) -> None:
        from freebeam.ledger.reference_values import statements

        with working("columns"):
            found = [*statements().values()]
        if self.as_json:
            print_json({"columns": [_record(column) for column in found]})
            return
        for family, columns in groupby(found, key=lambda column: column.family):
            rows = [[x.name, x.title, "-".join(_ends(x)), "; ".join(map(_told, x.parameters))] for x in columns]
            print_table(rows, ["name", "title", "ends", "parameters"], family)
            print()
        print("A range of interest is what plots show; any value may be set.")


def _ends(column: Column) -> tuple[str, ...]:
    """Of the first of several fields; none where there is no field."""
    return column.supports(column.fields[0]) if column.fields else ()


def _record(column: Column) -> dict[str, Any]:
    from freebeam_derive.latex import letter

    parameters = [
        {"name": p.name, "latex": letter(p), **{key: getattr(p, key) for key in ("meaning", "default", "low", "high")}}
        for p in column.parameters
    ]
    told = {key: getattr(column, key) for key in ("name", "title", "family", "damping", "source", "references")}
    return {**told, "ends": _ends(column), "parameters": parameters}


def _told(parameter: Parameter) -> str:
    name, low, high = parameter.name, parameter.low, parameter.high
    return f"{name} = {parameter.default:g} (of interest {low:g} to {high:g}): {parameter.meaning}"


@command("freebeam generate path/to/column.py --output kernels")
class Generate(Options):
    """Derive columns from their energies, write their kernels as code, and verify them."""

    targets: list[str] | None = argument(
        "[COLUMN|FILE]...",
        "Columns to derive; freebeam's own if none is given. A column's file is a Python program, which is run.",
    )
    output: Path | None = option("DIR", "Folder of the kernels; freebeam's own if not given.")
    language: str = option(
        "NAME", "Language of the kernels: python, c (C99) or javascript (an ES module).", default="python"
    )
    check: bool = flag("Write nothing; if the folder holds something else, print a diff and exit 1.")

    def run(self) -> None:
        outcome = _generated(self)
        worst = {name: max(found, key=lambda x: x.error / x.bound) for name, found in outcome.figures.items()}
        if self.as_json:
            print_json({
                "columns": outcome.columns,
                "output": outcome.output,
                "check": self.check,
                "written": outcome.written,
                "difference": outcome.difference,
                "errors": worst,
            })  # fmt: skip
        elif self.check:
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


def _generated(asked: Generate) -> Outcome:
    """What was derived and written. Raises InputError for a bad statement; ends with status 1 where a kernel fails."""
    from freebeam_derive import pipeline
    from freebeam_derive.statement import StatementError
    from freebeam_derive.verify import VerificationError
    from freebeam_sym.checks import InputError

    targets = asked.targets or ()
    files = [target for target in targets if target not in pipeline.columns()]
    foreign = f"{files[0]}: its kernel is none of those that are checked in" if files else ""
    refuse(files and asked.output is None, f"{foreign}; name a folder for it by --output")
    try:
        with working("generate") as report:
            return pipeline.generate(targets, asked.output, report, asked.check, language=asked.language)
    except StatementError as error:
        raise InputError(str(error)) from error
    except VerificationError as error:
        print(f"freebeam: nothing is written: {error}", file=sys.stderr)
        raise typer.Exit(1) from error
