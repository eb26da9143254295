"""`freebeam validate`."""

from __future__ import annotations

import shutil
import sys
from collections import Counter
from collections.abc import Sequence
from contextlib import ExitStack
from itertools import groupby
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from freebeam.cli.application import command
from freebeam.cli.options import FileOptions, flag, option, refuse
from freebeam.cli.output import folder, print_json, print_table, working, written

if TYPE_CHECKING:
    from freebeam.ledger.book import ClaimRow, EquationRow, Ledger
    from freebeam.ledger.reference_values import Checked
    from freebeam.ledger.scanned import Row
    from freebeam_derive.references import Reference


@command("freebeam validate --output ledger.md")
class Validate(FileOptions):
    """Check the paper: each numbered equation, each claim with its verdict, and the critical loads that it prints.

    With --gallery, check the columns instead: the reference values of each, published or computed by another route.

    The exit status is 1 if an equation or a claim has another verdict than it should have, or if a critical load is not
    explained to its last digit.
    """

    loads: bool = flag("Check the critical loads only, which is quick.")
    gallery: bool = flag("Check the reference values of all columns that come with freebeam.")
    output: Path | None = option(
        "FILE|DIR", "Write the whole ledger as Markdown; with --gallery a benchmark of certified values to a folder."
    )

    def run(self) -> None:
        refuse(self.loads and self.gallery, "--loads: belongs to the paper; leave it out with --gallery")
        if self.gallery:
            self.columns()
        else:
            self.paper()

    def columns(self) -> None:
        """Check the reference values of the columns; write the benchmark."""
        from freebeam.ledger import benchmark
        from freebeam.ledger.reference_values import validate

        with ExitStack() as files, working("validate") as report:
            streams = {}
            if self.output is not None:
                folder(self.output)
                streams = {
                    file: files.enter_context(written(self.output / file, self.force)) for file in benchmark.FILES
                }
            rows = validate(report)
            if streams:
                found = benchmark.rows(report)
                for file, text in benchmark.written_out(found).items():
                    streams[file].write(text)
        passed = all(row.passed for row in rows)
        if self.as_json:
            print_json({"references": rows, "passed": passed})
        else:
            _print_references(rows)
        if not passed:
            raise typer.Exit(1)

    def paper(self) -> None:
        """Check the paper; write the ledger."""
        from freebeam.ledger.book import ledger
        from freebeam.ledger.page import page
        from freebeam.ledger.scanned import validate as validated

        output = self.output
        refuse(self.loads and output, f"{output}: holds the whole ledger; leave out --loads")
        if output is not None:
            with written(output, self.force) as stream, working("validate") as report:
                stream.write(page(ledger(report)).encode())
        with working("validate") as report:
            rows = validated(report)
            book = None if self.loads else ledger(report)
        passed = all(row.passed for row in rows) and (book is None or book.passed)
        if self.as_json:
            parts = {"equations": book.equations, "claims": book.claims} if book else {}
            print_json({"loads": rows, **parts, "passed": passed})
        else:
            if book:
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


def _print_references(rows: Sequence[Checked]) -> None:
    for family, found in groupby(rows, key=lambda row: row.family):
        cells = [
            [
                row.column,
                _asked(row.reference),
                row.reference.load,
                row.explained,
                row.reference.kind,
                ("yes" if row.passed else "NO")
                + (f", {row.reference.rule}" if row.reference.rule != "rounded" else "")
                + (f", of {row.reference.modes} modes" if row.reference.modes else ""),
                row.reference.by,
            ]
            for row in found
        ]
        print_table(cells, ["column", "of", "reference", "computed", "kind", "agrees", "reference by"], family)
        typer.echo()
    computed = [row.computed for row in rows]
    counted = Counter("none" if found is None else found.proof for found in computed)
    typer.echo(
        f"{len(rows)} values of {len({row.column for row in rows})} columns, {sum(row.passed for row in rows)} agree; "
        + ", ".join(f"{n} {proof}" for proof, n in counted.items())
    )


def _asked(reference: Reference) -> str:
    """Parameters and dampings of a reference value that are not the column's defaults."""
    given = {"alpha": reference.alpha, "beta": reference.beta}
    words = [f"{name} = {value:g}" for name, value in {**reference.own, **given}.items() if value or name not in given]
    return ", ".join(words if reference.kappa is None else [*words, f"alpha = 0+, kappa = {reference.kappa:g}"])


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
