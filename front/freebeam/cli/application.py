"""The application that commands register with."""

from __future__ import annotations

from importlib import import_module
from typing import Annotated, Any

import typer
from typer.core import TyperGroup

# As a newcomer would need them; commands that are not named follow.
ORDER = (
    "columns", "critical", "spectrum", "map", "respond",
    "figures", "lesson", "explore",
    "verify", "validate", "generate",
)  # fmt: skip


class InOrder(TyperGroup):
    """Commands in the order of ORDER, whichever module registers first."""

    def list_commands(self, ctx: Any) -> list[str]:
        names = super().list_commands(ctx)
        return sorted(names, key=lambda name: (ORDER.index(name) if name in ORDER else len(ORDER), name))


app = typer.Typer(
    name="freebeam",
    help="Stability of columns under follower forces, from kernels derived from their energies.",
    cls=InOrder,
    add_completion=False,
    pretty_exceptions_enable=False,
)


def _version(wanted: bool) -> None:
    if wanted:
        from importlib.metadata import version

        typer.echo(f"freebeam {version('freebeam')}")
        raise typer.Exit


@app.callback(invoke_without_command=True)
def front(
    context: typer.Context,
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Print the version.")
    ] = False,
) -> None:
    if context.invoked_subcommand is None:
        typer.echo(context.get_help())


for module in ("asking", "deriving", "drawing", "exploring", "mapping", "responding", "teaching", "validating"):
    import_module(f"freebeam.cli.{module}")  # they register their commands
