"""The application that commands register with."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import MISSING, Field, dataclass, fields
from importlib import import_module
from inspect import Parameter, Signature
from typing import Annotated, Any, Protocol, TypeVar, get_type_hints

import typer
from typer.core import TyperCommand, TyperGroup

from freebeam.cli.options import number


class Runs(Protocol):
    def run(self) -> None: ...


Command = TypeVar("Command", bound=Runs)

# As a newcomer would need them; commands that are not named follow.
ORDER = (
    "columns", "show", "critical", "spectrum", "map", "pulse", "respond", "vehicle",
    "figures", "lesson", "explore",
    "verify", "validate", "generate",
)  # fmt: skip


FIRST = "\n".join(f"    {line}" for line in (
    "freebeam show beck                                    # a column at a glance, in plain text",
    "freebeam critical --column beck --digits 30           # its critical load, proven to 30 digits",
    "freebeam lesson --column beck --format html --output beck.html",
))  # fmt: skip
"""What a newcomer may type first."""


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
        typer.echo(f"Try:\n\n{FIRST}\n")


def command(example: str, cls: type[TyperCommand] | None = None) -> Callable[[type[Command]], type[Command]]:
    """Register a class as a command of its name: its fields are the options, its docstring the help, `run` does it.
    The required options come first in the help, --force and --json last."""

    def register(asked: type[Command]) -> type[Command]:
        asked = dataclass(frozen=True, kw_only=True)(asked)

        def run(**typed: Any) -> None:
            asked(**typed).run()

        hints = get_type_hints(asked)
        given = [_parameter(field, hints[field.name]) for field in fields(asked)]  # type: ignore[arg-type]
        given.sort(key=lambda x: (x.default is not x.empty, x.name == "as_json", x.name == "force"))
        run.__signature__ = Signature(given)  # type: ignore[attr-defined]  # what typer reads
        run.__doc__ = asked.__doc__
        app.command(asked.__name__.lower(), cls=cls, epilog=f"Example: {example}")(run)
        return asked

    return register


def _parameter(field: Field[Any], hint: Any) -> Parameter:
    """A dataclass's field as typer reads a command's parameter."""
    more = dict(field.metadata)
    kind, names = more.pop("kind"), more.pop("names")
    if kind is typer.Option and not names:
        names = (f"--{field.name.replace('_', '-')}",)
    if "Number" in str(field.type):
        more.setdefault("parser", number)
    default = Parameter.empty if field.default is MISSING else field.default
    described = Annotated[hint, kind(*names, **more)]
    return Parameter(field.name, Parameter.KEYWORD_ONLY, default=default, annotation=described)


MODULES = (
    "asking", "deriving", "flying", "mapping", "publishing", "pulsing", "responding", "showing", "validating",
)  # fmt: skip
for module in MODULES:
    import_module(f"freebeam.cli.{module}")  # they register their commands
