"""The application that commands register with."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import MISSING, Field, fields
from importlib import import_module
from inspect import Parameter, Signature
from typing import Annotated, Any, TypeVar, get_type_hints

import typer
from typer.core import TyperCommand, TyperGroup

Options = TypeVar("Options")

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


def command(
    options: type[Options], example: str, name: str | None = None, cls: type[TyperCommand] | None = None
) -> Callable[[Callable[[Options], None]], Callable[[Options], None]]:
    """Register a function as a command: the fields of `options`, a dataclass, are its options, and it is called with
    an instance. The required ones come first in its help, and --json last."""

    def register(function: Callable[[Options], None]) -> Callable[[Options], None]:
        def run(**typed: Any) -> None:
            function(options(**typed))

        hints = get_type_hints(options)
        given = [_parameter(field, hints[field.name]) for field in fields(options)]  # type: ignore[arg-type]
        given.sort(key=lambda x: (x.default is not x.empty, x.name == "as_json"))
        run.__signature__ = Signature(given)  # type: ignore[attr-defined]  # what typer reads
        run.__doc__ = function.__doc__
        app.command(name or function.__name__, cls=cls, epilog=f"Example: {example}")(run)
        return function

    return register


def _parameter(field: Field[Any], hint: Any) -> Parameter:
    """A dataclass's field as typer reads a command's parameter."""
    kind, names, *_ = field.metadata.values()
    more = {key: value for key, value in field.metadata.items() if key not in ("kind", "names")}
    if kind is typer.Option and not names:
        names = (f"--{field.name.replace('_', '-')}",)
    default = Parameter.empty if field.default is MISSING else field.default
    annotation = Annotated[hint, kind(*names, **more)]
    return Parameter(field.name, Parameter.KEYWORD_ONLY, default=default, annotation=annotation)


for module in ("asking", "deriving", "mapping", "publishing", "responding", "validating"):
    import_module(f"freebeam.cli.{module}")  # they register their commands
