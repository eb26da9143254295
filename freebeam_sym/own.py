"""A user's own column: from its file to a verified kernel, kept in the user's cache."""

from __future__ import annotations

import ast
import hashlib
import importlib.util
import os
import sys
import tempfile
from importlib.metadata import version
from pathlib import Path
from types import ModuleType

from freebeam_sym.checks import InputError

__all__ = ["cache_folder", "kernel_of"]


def kernel_of(path: str | Path, basis: str | None = None) -> ModuleType:
    """The kernel module of a column's file: a statement, or a kernel that was emitted from one in whichever basis.

    A statement is derived, emitted in the basis asked for (its own where None) and verified when it is first seen, or
    has changed; later it is read from the cache. Raises InputError where the file cannot be read, does not parse, or
    states no sound column.
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
        return _load(path, hashlib.sha256(source).hexdigest())
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
    kept = cache_folder() / key[:32]
    if (found := _kernel_file(kept)) is not None:
        return _load(found, key)
    try:
        kept.parent.mkdir(parents=True, exist_ok=True)
        temporary = tempfile.TemporaryDirectory(dir=kept.parent, prefix=".new-", ignore_cleanup_errors=True)
    except OSError:  # a home that cannot be written to: the kernel serves this process only
        temporary = tempfile.TemporaryDirectory(prefix="freebeam-", ignore_cleanup_errors=True)
    with temporary as folder:
        emitted = Path(folder) / "kernel"
        _generate(path, basis, emitted)
        file = _kernel_file(emitted)
        if file is None:
            raise RuntimeError(f"{path}: no kernel was emitted")
        if Path(folder).parent == kept.parent:
            try:
                os.replace(emitted, kept)
                file = kept / file.name
            except OSError:  # another process was first, or the disk is full: ours is as good
                pass
        return _load(file, key)


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


def _kernel_file(folder: Path) -> Path | None:
    files = [file for file in sorted(folder.glob("*.py")) if file.name != "__init__.py"]
    return files[0] if len(files) == 1 else None


def _load(file: Path, key: str) -> ModuleType:
    """Import a file under a name of its own, without touching sys.path; once a process."""
    name = f"freebeam_own_{file.stem}_{key[:16]}"
    if name in sys.modules:
        return sys.modules[name]
    spec = importlib.util.spec_from_file_location(name, file)
    if spec is None or spec.loader is None:
        raise InputError(f"{file}: is not a Python file")
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    try:
        spec.loader.exec_module(module)
    except Exception as error:
        del sys.modules[name]
        reason = " ".join(str(error).split())
        raise InputError(f"{file}: fails with {type(error).__name__}: {reason}") from error
    except BaseException:
        del sys.modules[name]
        raise
    return module
