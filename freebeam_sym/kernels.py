"""A kernel's file, as the derivation emitted it: read, and imported under a name of its own."""

from __future__ import annotations

import ast
import hashlib
import importlib.util
import sys
from importlib.abc import InspectLoader
from pathlib import Path
from types import ModuleType
from typing import cast

from freebeam_sym.checks import InputError

__all__ = ["is_kernel", "load", "read_kernel", "read_source", "text_of"]


def read_kernel(path: Path) -> ModuleType:
    """The module of a kernel's file. Raises InputError where it cannot be read or is none."""
    source, tree = read_source(path)
    if not is_kernel(tree):
        raise InputError(
            f"{path}: is no emitted kernel; a column's statement is derived by `import freebeam`, or by "
            f"freebeam generate {path}, which emits its kernel"
        )
    return load(path, source)


def read_source(path: Path) -> tuple[bytes, ast.Module]:
    """The text of a Python file, and its tree. Raises InputError."""
    try:
        source = path.read_bytes()
    except OSError as error:
        raise InputError(
            f"{path}: cannot be read ({error.strerror}); give the name of a column or the path of its file"
        ) from None
    try:
        return source, ast.parse(source, str(path))
    except (SyntaxError, ValueError) as error:  # ValueError: null bytes
        where = f", line {error.lineno}" if isinstance(error, SyntaxError) and error.lineno else ""
        reason = error.msg if isinstance(error, SyntaxError) else error
        raise InputError(f"{path}{where}: does not parse as Python: {reason}") from None


def is_kernel(tree: ast.Module) -> bool:
    """Whether a file's tree is that of an emitted kernel."""
    assignments = (node for node in tree.body if isinstance(node, ast.Assign | ast.AnnAssign))
    names = (name for node in assignments for name in ast.walk(node) if isinstance(name, ast.Name))
    assigned = {name.id for name in names if isinstance(name.ctx, ast.Store)}
    functions = {node.name for node in tree.body if isinstance(node, ast.FunctionDef)}
    return "COLUMN" in assigned and {"basis", "stiffness_load"} <= functions


class _Text(InspectLoader):
    """Loads a module from its text as it was read and checked: the file is not read again, nor bytecode beside it."""

    def __init__(self, source: bytes) -> None:
        self.source = source

    def get_source(self, fullname: str) -> str:
        return importlib.util.decode_source(self.source)


def text_of(kernel: ModuleType) -> str:
    """The text that a kernel was loaded from; its file may be gone."""
    return str(cast(InspectLoader, kernel.__loader__).get_source(kernel.__name__))


def load(file: Path, source: bytes) -> ModuleType:
    """Import a file's text under a name of its own, without touching sys.path; once a process. Raises InputError."""
    name = f"freebeam_own_{file.stem}_{hashlib.sha256(source).hexdigest()[:16]}"
    if name in sys.modules:
        return sys.modules[name]
    loader = _Text(source)
    module = ModuleType(name)
    module.__file__, module.__loader__ = str(file), loader
    sys.modules[name] = module
    try:
        exec(loader.source_to_code(source, str(file)), module.__dict__)
    except BaseException as error:
        del sys.modules[name]
        if not isinstance(error, Exception):
            raise
        raise InputError(f"{file}: fails with {type(error).__name__}: {' '.join(str(error).split())}") from error
    return module
