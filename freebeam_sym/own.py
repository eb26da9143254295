"""A user's own column: from its file to a verified kernel, kept in the user's cache."""

from __future__ import annotations

import ast
import hashlib
import importlib.util
import json
import os
import sys
import tempfile
from contextlib import suppress
from importlib.abc import InspectLoader
from importlib.metadata import version
from pathlib import Path
from types import ModuleType

from freebeam_sym.checks import InputError

__all__ = ["cache_folder", "kernel_of"]

MANIFEST = "MANIFEST.json"


def kernel_of(path: str | Path, basis: str | None = None) -> ModuleType:
    """The kernel module of a column's file: a statement, or a kernel that was emitted from one in whichever basis.

    A statement is derived, emitted in the basis asked for (its own where None) and verified when it is first seen, or
    has changed; later it is read from the cache, where that is the user's alone and holds it as it was emitted. Raises
    InputError where the file cannot be read, does not parse, or states no sound column.
    """
    path = Path(path)
    try:
        source = path.read_bytes()
    except OSError as error:
        raise InputError(
            f"{path}: cannot be read ({error.strerror}); give the name of a column or the path of its file"
        ) from None
    try:
        tree = ast.parse(source, str(path))
    except (SyntaxError, ValueError) as error:  # ValueError: null bytes
        where = f", line {error.lineno}" if isinstance(error, SyntaxError) and error.lineno else ""
        reason = error.msg if isinstance(error, SyntaxError) else error
        raise InputError(f"{path}{where}: does not parse as Python: {reason}") from None
    if _is_kernel(tree):
        return _load(path, source, hashlib.sha256(source).hexdigest())
    kernel = _generated(path, basis or "legendre", _key(path, source, basis or "legendre"))
    stated = str(kernel.COLUMN["default"]["basis"])
    return kernel if basis or stated == "legendre" else _generated(path, stated, _key(path, source, stated))


def cache_folder() -> Path:
    """Where kernels of users' own columns are kept: XDG_CACHE_HOME, or the system's usual place."""
    if os.name == "nt" and os.environ.get("LOCALAPPDATA"):
        base = Path(os.environ["LOCALAPPDATA"])
    else:
        given = os.environ.get("XDG_CACHE_HOME", "")
        # The specification says to ignore a relative path.
        base = Path(given) if os.path.isabs(given) else Path(os.path.expanduser("~")) / ".cache"
    return base / "freebeam"


def _is_kernel(tree: ast.Module) -> bool:
    assigned = {
        target.id
        for node in tree.body
        if isinstance(node, (ast.Assign, ast.AnnAssign))
        for target in (node.targets if isinstance(node, ast.Assign) else [node.target])
        if isinstance(target, ast.Name)
    }
    functions = {node.name for node in tree.body if isinstance(node, ast.FunctionDef)}
    return "COLUMN" in assigned and {"basis", "stiffness_load"} <= functions


def _key(path: Path, source: bytes, basis: str) -> str:
    """Hash of all that the emitted kernel depends on. Needs no import of the derivation."""
    digest = hashlib.sha256()
    spec = importlib.util.find_spec("freebeam_derive")
    if spec is None or not spec.submodule_search_locations:
        raise InputError(f"{path}: freebeam_derive is not installed, which derives a column from its file")
    derivation = Path(next(iter(spec.submodule_search_locations)))
    versions = [version(name).encode() for name in ("freebeam", "sympy", "mpmath")]
    parts = [path.name.encode(), source, basis.encode(), *versions]
    parts += [file.read_bytes() for file in sorted(derivation.rglob("*.py"))]
    for part in parts:
        digest.update(len(part).to_bytes(8, "big") + part)
    return digest.hexdigest()


def _generated(path: Path, basis: str, key: str) -> ModuleType:
    folder = cache_folder()
    kept = folder / key[:32]
    if _private(folder) and _private(kept) and (found := _emitted(kept, key)) is not None:
        return _load(*found, key)
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
        return _load(file, source, key)


def _generate(path: Path, basis: str, output: Path) -> None:
    from freebeam_derive import pipeline
    from freebeam_derive.statement import StatementError
    from freebeam_derive.verify import VerificationError

    try:
        pipeline.generate([path], output, bases=[basis])
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


class _Text(InspectLoader):
    """Loads a module from its text as it was read and checked: the file is not read again, nor bytecode beside it."""

    def __init__(self, source: bytes) -> None:
        self.source = source

    def get_source(self, fullname: str) -> str:
        return importlib.util.decode_source(self.source)


def _load(file: Path, source: bytes, key: str) -> ModuleType:
    """Import a file's text under a name of its own, without touching sys.path; once a process."""
    name = f"freebeam_own_{file.stem}_{key[:16]}"
    if name in sys.modules:
        return sys.modules[name]
    loader = _Text(source)
    module = ModuleType(name)
    module.__file__, module.__loader__ = str(file), loader
    sys.modules[name] = module
    try:
        exec(loader.source_to_code(source, str(file)), module.__dict__)
    except Exception as error:
        del sys.modules[name]
        reason = " ".join(str(error).split())
        raise InputError(f"{file}: fails with {type(error).__name__}: {reason}") from error
    except BaseException:
        del sys.modules[name]
        raise
    return module
