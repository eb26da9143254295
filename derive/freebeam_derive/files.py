"""Files that appear whole or not at all, and in nobody's place; all that is written goes through here."""

from __future__ import annotations

import errno
import os
import secrets
from collections.abc import Iterator
from contextlib import contextmanager
from itertools import count
from pathlib import Path
from typing import IO


@contextmanager
def written(path: Path, replace: bool) -> Iterator[IO[bytes]]:
    """A stream whose content stands at `path` when all of it is written; where that fails nothing is left.

    Without `replace` a file that exists is kept, and one that appears in the meantime too: this content is then left
    beside it, under a name that the error tells. With `replace` a link is followed, and a pipe or a device, which
    cannot be replaced, is written to. Raises OSError whose `filename` and `strerror` say what is wrong.
    """

    def fail(number: int, text: str) -> OSError:
        return OSError(number, text, str(path))

    if path.is_dir():
        raise fail(errno.EISDIR, "is a folder; give the name of a file")
    if os.path.lexists(path) and not replace:
        raise fail(errno.EEXIST, "exists and is kept; give another name, or --force to replace it")
    place = path.resolve() if path.is_symlink() else path
    if not place.parent.is_dir():
        raise fail(errno.ENOENT, "cannot be written (its folder does not exist); make it, or give another name")
    try:
        if place.exists() and not place.is_file():
            with open(place, "wb") as through:
                yield through
            return
        with _beside(place) as (stream, beside):
            yield stream
            stream.close()  # now, because only then is all of it known to be on the disk
            if replace:
                os.replace(beside, place)
            elif not _put(beside, place):
                other = next(p for k in count(1) if _put(beside, p := place.with_stem(f"{place.stem}-{k}")))
                raise fail(errno.EEXIST, f"appeared in the meantime and is kept; what this run has made is {other}")
    except OSError as error:
        if error.filename is not None and str(error.filename) == str(path):
            raise
        if isinstance(error, BrokenPipeError):
            raise
        raise fail(error.errno or errno.EIO, f"cannot be written ({error.strerror or error})") from None


@contextmanager
def _beside(place: Path) -> Iterator[tuple[IO[bytes], str]]:
    """A new file in the same folder, and its name; it is gone in the end unless it was moved away."""
    # the name is known before the file is there: a signal in between leaves none behind
    name = place.with_name(f".{place.name[:100]}-{secrets.token_hex(8)}")
    try:
        with open(name, "xb") as stream:
            yield stream, str(name)
    finally:
        name.unlink(missing_ok=True)


def _put(beside: str, place: Path) -> bool:
    """Give a file the name `place` too; False where there is one."""
    try:
        os.link(beside, place)
    except FileExistsError:
        return False
    except OSError:  # a file system without links: take the name first, then its place
        try:
            os.close(os.open(place, os.O_CREAT | os.O_EXCL))
        except FileExistsError:
            return False
        os.replace(beside, place)
    return True
