"""The application that commands register with."""

from __future__ import annotations

import typer

app = typer.Typer(
    name="freebeam",
    help="Stability of columns under follower forces, from kernels derived from their energies.",
    add_completion=False,
    pretty_exceptions_enable=False,
)
