"""The command line, `freebeam`. A command loads what it needs when it runs.

Bad input ends in one line on standard error and exit status 2, a check that fails in status 1. With `--json`
a command prints one JSON object on standard output and nothing else there.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence
from typing import Annotated

import typer

from freebeam_sym.cli import (  # noqa: F401 (they register their commands)
    derivation,
    explore,
    figures,
    lesson,
    map,
    respond,
    stability,
    validate,
)
from freebeam_sym.cli.application import app


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


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a command line and return its exit status; the entry point."""
    try:
        status = app(args=arguments, prog_name="freebeam", standalone_mode=False)
        sys.stdout.flush()
    except (KeyboardInterrupt, typer.Abort):
        status = 130
    except BrokenPipeError:
        # Python would write to the closed pipe once more as it ends.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 1
    except Exception as error:
        line = _line_of(error)
        if line is None:
            raise
        print(f"freebeam: {line}", file=sys.stderr)
        return 2
    if status == 130:
        print("freebeam: interrupted", file=sys.stderr)
    return status if isinstance(status, int) else 0


def _line_of(error: Exception) -> str | None:
    """The one line for a user's mistake; None for a fault of the program."""
    from freebeam_sym.checks import InputError

    show = getattr(error, "format_message", None)  # what every usage error of click has, bundled or not
    if show is not None:
        return " ".join(show().split()).rstrip(".") + "; see freebeam --help"
    if isinstance(error, InputError):
        return " ".join(str(error).split())
    if isinstance(error, MemoryError):
        return "not enough memory; fewer modes, sensors or steps need less"
    if isinstance(error, OSError) and error.filename is not None:
        return f"{error.filename}: {error.strerror}"
    return None
