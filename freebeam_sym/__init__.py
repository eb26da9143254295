"""The runtime: spectra, critical loads and responses of columns, from the kernels emitted for them.

    import freebeam_sym
    column = freebeam_sym.column("free-free")  # or the path of a kernel's file
    freebeam_sym.critical_load(column, modes=8, alpha=1e-3, beta=0.1).load

It answers one question at a time. `freebeam` offers all of this, and besides what derives, proves and draws, and what
asks many questions: arrays and maps of them, branches along the load, boundaries and loads that pulsate.

Each name loads its module when it is first used, so that importing this package costs next to nothing.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from freebeam_sym.checks import InputError
    from freebeam_sym.columns import Column, System, column, column_names
    from freebeam_sym.question import Question
    from freebeam_sym.response import Harmonic, Response, respond
    from freebeam_sym.spectra import Spectrum, spectrum
    from freebeam_sym.stability.critical import CriticalLoad, critical_load

__all__ = [
    "column", "column_names", "Column", "System", "Question",
    "spectrum", "Spectrum",
    "critical_load", "CriticalLoad",
    "respond", "Harmonic", "Response",
    "InputError",
    "__version__",
]  # fmt: skip

# Modules of this package by the names that they give. No name may be that of a module, because importing the module
# would put it in the name's place.
_HOMES = {
    "columns": ["column", "column_names", "Column", "System"],
    "question": ["Question"],
    "spectra": ["spectrum", "Spectrum"],
    "stability.critical": ["critical_load", "CriticalLoad"],
    "response": ["respond", "Harmonic", "Response"],
    "checks": ["InputError"],
}


def __getattr__(name: str) -> object:
    home = next((module for module, names in _HOMES.items() if name in names), None)
    value: object
    if name == "__version__":
        value = import_module("importlib.metadata").version("freebeam")
    elif home is not None:
        value = getattr(import_module(f"{__name__}.{home}"), name)
    else:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted(__all__)
