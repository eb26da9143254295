"""`freebeam validate`."""

from __future__ import annotations

from dataclasses import asdict

import typer

from freebeam_sym.cli.application import app
from freebeam_sym.cli.options import JsonOption
from freebeam_sym.cli.output import print_json, print_table, working


@app.command(epilog="Example: freebeam validate")
def validate(as_json: JsonOption = False) -> None:
    """Compute the critical loads that the paper prints; exit 1 if one is not explained to its last digit."""
    from freebeam_sym.validate import validate as validated

    with working("validate") as report:
        rows = validated(report)
    if as_json:
        print_json({"loads": [asdict(row) for row in rows], "passed": all(row.passed for row in rows)})
    else:
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
    if not all(row.passed for row in rows):
        raise typer.Exit(1)
