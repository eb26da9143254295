"""Bases: the trial functions that a column's kernels are made for, a file each.

A file holds `build`, which makes its kernel of a derivation, `steps`, the record of how its functions were derived, and
SUFFIX, what the names of its modules end in. kernel.py has the protocol that its kernel fills; the template of its name
in emit/ writes it.
"""

from __future__ import annotations

from importlib import import_module
from types import ModuleType
from typing import cast

from freebeam_derive.derivation import Derivation
from freebeam_derive.kernel import Kernel
from freebeam_derive.record import Step
from freebeam_derive.statement import Column


def build(basis: str, derivation: Derivation) -> Kernel:
    """The kernel graph of a column in a basis: its forms lowered to programs. Eq. (11)."""
    return cast(Kernel, _file(basis).build(derivation))


def steps(basis: str, derivation: Derivation) -> tuple[Step, ...]:
    """The record of how a basis was derived."""
    return cast(tuple[Step, ...], _file(basis).steps(derivation))


def module_of(column: Column, basis: str) -> str:
    """Name of a column's emitted module in a basis."""
    return f"{column.module}{_file(basis).SUFFIX}"


def _file(basis: str) -> ModuleType:
    return import_module(f"{__name__}.{basis}")
