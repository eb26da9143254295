"""A column from its statement, the gallery's or a user's own: from its file to a verified kernel, kept in the user's
cache."""

from __future__ import annotations

import hashlib
import importlib.util
import json
import os
import tempfile
from contextlib import suppress
from importlib.metadata import version
from pathlib import Path
from types import ModuleType

from freebeam_sym import columns
from freebeam_sym.checks import InputError
from freebeam_sym.columns import Column, file_of
from freebeam_sym.kernels import is_kernel, load, read_source

__all__ = ["cache_folder", "column", "column_names"]

MANIFEST = "MANIFEST.json"


def column(name: str | os.PathLike[str], basis: str | None = None) -> Column:
    """A column by its name, or by the path of a user's own column file (or of a kernel emitted from one).

    basis: the trial functions, "modes" of the unloaded beam or "legendre": polynomials, with which critical loads
    converge exponentially in their number; where None, what the column states: polynomials, if nothing else. A kernel's
    file has the one that it was emitted for.
    A column of the gallery, or of a file, is derived, emitted and verified when it is first used, and kept for later.

    >>> column("free-free", basis="legendre").basis_name
    'legendre'

    Raises InputError for a name that no column has, a file that makes no sense and a basis that there is not.
    """
    path = file_of(name, basis, _gallery())
    if path is None:
        return columns.column(name, basis)
    source, tree = read_source(path)
    if is_kernel(tree):
        return columns.column(path, basis)
    kernel = _kernel_of(path, source, basis or "legendre")
    stated = str(kernel.COLUMN["default"]["basis"])
    if not basis and stated != "legendre":
        kernel = _kernel_of(path, source, stated)
    return Column(kernel, path, lambda basis: column(path, basis))


def column_names() -> tuple[str, ...]:
    """Names of the columns that come with the package, the gallery's among them; `freebeam columns` says what they are.

    >>> {"free-free", "pflueger"} <= set(column_names())
    True
    """
    return (*columns.column_names(), *_gallery())


def _derivation() -> Path | None:
    """The folder of the derivation, found without importing it."""
    spec = importlib.util.find_spec("freebeam_derive")
    return None if spec is None else Path(next(iter(spec.submodule_search_locations or ())))


def _gallery() -> dict[str, Path]:
    """As `freebeam_derive.statement.gallery`, without importing it."""
    folder = _derivation()
    files = () if folder is None else sorted((folder / "columns" / "gallery").glob("[a-z]*.py"))
    return {file.stem.replace("_", "-"): file for file in files}


def cache_folder() -> Path:
    """Where kernels that are derived when they are first used are kept: XDG_CACHE_HOME, or the system's usual place."""
    if os.name == "nt" and os.environ.get("LOCALAPPDATA"):
        base = Path(os.environ["LOCALAPPDATA"])
    else:
        given = os.environ.get("XDG_CACHE_HOME", "")
        # The specification says to ignore a relative path.
        base = Path(given) if os.path.isabs(given) else Path(os.path.expanduser("~")) / ".cache"
    return base / "freebeam"


def _key(path: Path, source: bytes, basis: str) -> str:
    """Hash of all that the emitted kernel depends on. Needs no import of the derivation."""
    digest = hashlib.sha256()
    derivation = _derivation()
    if derivation is None:
        raise InputError(f"{path}: freebeam_derive is not installed, which derives a column from its file")
    versions = [version(name).encode() for name in ("freebeam", "sympy", "mpmath")]
    parts = [path.name.encode(), source, basis.encode(), *versions]
    # other columns decide nothing
    files = [file for file in sorted(derivation.rglob("*")) if derivation / "columns" not in file.parents]
    parts += [file.read_bytes() for file in files if file.suffix in (".py", ".jinja")]
    for part in parts:
        digest.update(len(part).to_bytes(8, "big") + part)
    return digest.hexdigest()


def _kernel_of(path: Path, source: bytes, basis: str) -> ModuleType:
    """The kernel of a statement in a basis: derived, emitted and verified when it is first seen, or has changed; later
    read from the cache, where that is the user's alone and holds it as it was emitted. Raises InputError where it
    states no sound column."""
    key = _key(path, source, basis)
    folder = cache_folder()
    kept = folder / key[:32]
    if _private(folder) and _private(kept) and (found := _emitted(kept, key)) is not None:
        return load(*found)
    try:
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        if not _private(folder):
            raise PermissionError
        temporary = tempfile.TemporaryDirectory(dir=folder, prefix=".new-", ignore_cleanup_errors=True)
    except OSError:  # it cannot be written to, or not by the user alone: the kernel serves this process only
        temporary = tempfile.TemporaryDirectory(prefix="freebeam-", ignore_cleanup_errors=True)
    with temporary as new:
        made = Path(new) / "kernel"
        made.mkdir(mode=0o700)
        _generate(path, basis, made)
        if path.read_bytes() != source:  # what was derived is perhaps not what was read before
            raise InputError(f"{path}: was changed while its kernel was derived; run it again")
        manifest = json.loads((made / MANIFEST).read_text(encoding="utf-8"))
        (made / MANIFEST).write_text(json.dumps({**manifest, "key": key}, indent=2) + "\n", encoding="utf-8")
        emitted = _emitted(made, key)
        if emitted is None:
            raise RuntimeError(f"{path}: no kernel was emitted")
        file, source = emitted
        if Path(new).parent == folder:
            with suppress(OSError):  # the disk is full, or another process puts its own there
                if os.path.lexists(kept):  # not as it was emitted, or of another process that was first
                    os.replace(kept, Path(new) / "old")
                os.replace(made, kept)
                file = kept / file.name
        return load(file, source)


def _generate(path: Path, basis: str, output: Path) -> None:
    from freebeam_derive import pipeline
    from freebeam_derive.statement import StatementError
    from freebeam_derive.verify import VerificationError

    try:
        pipeline.generate([path], output, only=[basis], prove=False)
    except StatementError as error:
        raise InputError(str(error)) from error
    except VerificationError as error:
        raise InputError(f"{path}: its kernel fails verification and cannot be used: {error}") from error


def _private(folder: Path) -> bool:
    """Whether a folder is there that nobody but its user can have put anything into."""
    try:
        found = folder.stat()
    except OSError:
        return False
    if os.name == "nt":  # where the cache lies in the user's profile, and modes say nothing
        return True
    return found.st_uid == os.geteuid() and not found.st_mode & 0o022


def _emitted(folder: Path, key: str) -> tuple[Path, bytes] | None:
    """The kernel's file in a folder and its text, where the manifest beside it is of this key and has its hash."""
    try:
        manifest = json.loads((folder / MANIFEST).read_text(encoding="utf-8"))
        ((name, entry),) = manifest["files"].items()
        source = (folder / name).read_bytes()
        sound = manifest["key"] == key and entry["sha256"] == hashlib.sha256(source).hexdigest()
    except (OSError, ValueError, LookupError, TypeError, AttributeError, RecursionError):
        return None
    return (folder / name, source) if sound else None
