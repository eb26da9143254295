"""`freebeam validate`."""

from __future__ import annotations

import shutil
import sys
from collections import Counter
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from freebeam.cli.application import app
from freebeam.cli.options import JsonOption
from freebeam.cli.output import print_json, print_table, working, written

if TYPE_CHECKING:
    from freebeam.ledger.book import ClaimRow, EquationRow, Ledger
    from freebeam.ledger.scanned import Row


@app.command(epilog="Example: freebeam validate --output ledger.md")
def validate(
    as_json: JsonOption = False,
    loads: Annotated[bool, typer.Option("--loads", help="The critical loads alone, at once.")] = False,
    output: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Write the whole ledger there, as Markdown.")
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Replace the file if it exists.")] = False,
) -> None:
    """Check the paper: each numbered equation, each claim with its verdict, and the critical loads that it prints.

    Exit 1 if an equation or a claim has another verdict than it should have, or a critical load is not explained to its
    last digit.
    """
    from freebeam.ledger.book import ledger
    from freebeam.ledger.page import page
    from freebeam.ledger.scanned import validate as validated
    from freebeam_sym.checks import InputError

    if loads:
        if output is not None:
            raise InputError(f"{output}: holds the whole ledger; leave --loads out")
        with working("validate") as report:
            rows = validated(report)
        passed = all(row.passed for row in rows)
        if as_json:
            print_json({"loads": [asdict(row) for row in rows], "passed": passed})
        else:
            _print_loads(rows)
        if not passed:
            raise typer.Exit(1)
        return
    if output is not None:
        with written(output, force) as stream, working("validate") as report:
            stream.write(page(ledger(report)).encode())
    with working("validate") as report:
        rows, book = validated(report), ledger(report)
    passed = book.passed and all(row.passed for row in rows)
    if as_json:
        print_json(
            {
                "loads": [asdict(row) for row in rows],
                "equations": [asdict(row) for row in book.equations],
                "claims": [asdict(row) for row in book.claims],
                "passed": passed,
            }
        )
    else:
        _print_ledger(book)
        _print_loads(rows)
    if not passed:
        raise typer.Exit(1)


def _print_ledger(book: Ledger) -> None:
    """What the ledger finds, a line a row; claims that cannot be checked are counted only."""
    cells = [[row.id, row.section, _said(row), row.misprint] for row in book.equations]
    print_table(cells, ["Eq.", "section", "verdict", ""], "Equations of the paper, as printed against as derived")
    claims = [row for row in book.claims if row.verdict != "not checkable" or not row.passed]
    named, said = max(len(row.id) for row in claims), max(len(_said(row)) for row in claims)
    room = shutil.get_terminal_size().columns - named - said - 8 if sys.stdout.isatty() else 1000
    cells = [[row.id, _said(row), _beginning(row.computed, max(room, 20))] for row in claims]
    print_table(cells, ["claim", "verdict", "computed"], "Claims of the paper")
    counted = ", ".join(f"{n} {verdict}" for verdict, n in Counter(row.verdict for row in book.claims).items())
    typer.echo(f"{len(book.claims)} claims: {counted}.\nQuotes, and all that is computed: --output FILE, or --json.\n")


def _said(row: EquationRow | ClaimRow) -> str:
    verdict = row.verdict.replace("confirmed to the printed digits", "confirmed, digits")
    return verdict if row.passed else f"{verdict} FAILED"


def _beginning(text: str, room: int) -> str:
    return text if len(text) <= room else f"{text[: room - 1]}…"


def _print_loads(rows: Sequence[Row]) -> None:
    cells = [
        [
            row.section,
            f"{row.alpha:g}",
            f"{row.beta:g}",
            row.printed,
            "none" if row.load is None else f"{row.load:.10f}",
            row.kind,
            "none" if row.explained is None else row.explained,
            "yes" if row.passed else "NO",
        ]
        for row in rows
    ]
    header = ["section", "alpha", "beta", "printed", f"N = {rows[0].modes}", "kind", "scanned", "confirmed"]
    print_table(cells, header, "Critical loads of the paper; a scan prints the first step at or above the load")
