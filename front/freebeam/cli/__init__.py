"""The command line, `freebeam`. A command loads what it needs when it runs.

Bad input ends in one line on standard error and exit status 2, a check that fails in status 1. With `--json`
a command prints one JSON object on standard output and nothing else there.
"""

from __future__ import annotations

import errno
import os
import re
import signal
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a command line and return its exit status; the entry point."""
    if arguments is None:
        # Matrices are small: threads of linear algebra wait for each other, and where the machine has other work a
        # vehicle's report takes 34 s of processor time instead of 3. Read when NumPy is loaded; a user's setting holds.
        os.environ.setdefault("OMP_NUM_THREADS", "1")
    try:
        with _ended_tidily():
            from freebeam.cli.application import app  # here, where an interrupt is caught

            status = app(args=arguments, prog_name="freebeam", standalone_mode=False)
            sys.stdout.flush()
            if status == 130:  # what typer makes of an interrupt
                raise KeyboardInterrupt
    except KeyboardInterrupt:
        return _told("interrupted", 130)
    except _Ended as end:
        return _told("ended by a signal", 128 + end.number)
    except BrokenPipeError:
        _quiet()
        return 1
    except Exception as error:
        line = _line_of(error)
        if line is None:
            raise
        return _told(line, 2)
    return status if isinstance(status, int) else 0


class _Ended(BaseException):
    """The process was asked to end."""

    def __init__(self, number: int) -> None:
        self.number = number


@contextmanager
def _ended_tidily() -> Iterator[None]:
    """Have signals that end the process raise an exception, so that what is half written is removed."""

    def end(number: int, frame: object) -> None:
        raise _Ended(number)

    before = {}
    try:
        for name in ("SIGTERM", "SIGHUP"):
            number = getattr(signal, name, None)
            if number is not None and signal.getsignal(number) is signal.SIG_DFL:
                before[number] = signal.signal(number, end)
    except ValueError:  # not in the main thread, which alone has to do with signals
        pass
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def _told(line: str, status: int) -> int:
    line = re.sub(r"\S{400,}", lambda word: f"{word[0][:60]}...", line)  # a number of thousands of digits
    print(f"freebeam: {line}", file=sys.stderr)
    return status


def _quiet() -> None:
    """Have Python write no more to a standard output that takes nothing, as it would when it ends."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _line_of(error: Exception) -> str | None:
    """The one line for a user's mistake; None for a fault of the program."""
    from freebeam_sym.checks import InputError

    show = getattr(error, "format_message", None)  # what every usage error of click has, bundled or not
    if show is not None:
        context = getattr(error, "ctx", None)
        command = "freebeam" if context is None else context.command_path
        return " ".join(show().split()).rstrip(".") + f"; see {command} --help"
    if isinstance(error, InputError):
        return " ".join(str(error).split())
    if isinstance(error, MemoryError):
        return "not enough memory; fewer modes, sensors or steps need less"
    if isinstance(error, OSError) and error.filename is not None:
        return f"{error.filename}: {error.strerror}"
    if isinstance(error, OSError) and error.errno in (errno.ENOSPC, errno.EFBIG, errno.EIO, errno.EBADF):
        _quiet()
        return f"standard output: cannot be written ({error.strerror})"
    return None
