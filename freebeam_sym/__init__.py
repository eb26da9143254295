"""Stability of columns under follower forces: spectra, critical loads and responses.

    import freebeam_sym as fb
    column = fb.column("free-free")
    fb.critical_load(column, modes=8, alpha=1e-3, beta=0.1).load

Each name loads its module when it is first used, so that importing this package costs next to nothing.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import freebeam_sym.figures  # noqa: F401 (fb.figures, for type checkers)
    from freebeam_sym.boundaries import Boundary, BoundaryEvent, trace_boundary
    from freebeam_sym.checks import InputError
    from freebeam_sym.columns import Column, System, column
    from freebeam_sym.columns import names as column_names
    from freebeam_sym.critical import CriticalLoad, critical_load
    from freebeam_sym.maps import CriticalLoads, critical_loads, stability_map
    from freebeam_sym.proofs import (
        Certified,
        CertifiedCrossing,
        ExactSpectrum,
        Truncation,
        certified_crossings,
        certified_load,
        exact_load,
        exact_spectrum,
        truncation_error,
        verify_certificate,
    )
    from freebeam_sym.response import Harmonic, Response, respond, state_space
    from freebeam_sym.spectra import Branches, Spectrum, branches, eigenvalues, spectrum

__all__ = [
    "column", "column_names", "Column", "System",
    "spectrum", "branches", "eigenvalues", "Spectrum", "Branches",
    "critical_load", "CriticalLoad",
    "critical_loads", "stability_map", "trace_boundary", "CriticalLoads", "Boundary", "BoundaryEvent",
    "certified_load", "certified_crossings", "exact_load", "exact_spectrum", "truncation_error",
    "Certified", "CertifiedCrossing", "ExactSpectrum", "Truncation", "verify_certificate",
    "respond", "state_space", "Harmonic", "Response",
    "InputError",
    "__version__",
]  # fmt: skip

# Where each name lives: a module of this package and the name there. No name may be that of a module, because
# importing the module would put it in the name's place.
_HOMES = {
    "column": ("columns", "column"),
    "column_names": ("columns", "names"),
    "Column": ("columns", "Column"),
    "System": ("columns", "System"),
    "spectrum": ("spectra", "spectrum"),
    "branches": ("spectra", "branches"),
    "eigenvalues": ("spectra", "eigenvalues"),
    "Spectrum": ("spectra", "Spectrum"),
    "Branches": ("spectra", "Branches"),
    "critical_load": ("critical", "critical_load"),
    "CriticalLoad": ("critical", "CriticalLoad"),
    "critical_loads": ("maps", "critical_loads"),
    "stability_map": ("maps", "stability_map"),
    "CriticalLoads": ("maps", "CriticalLoads"),
    "trace_boundary": ("boundaries", "trace_boundary"),
    "Boundary": ("boundaries", "Boundary"),
    "BoundaryEvent": ("boundaries", "BoundaryEvent"),
    "certified_load": ("proofs", "certified_load"),
    "certified_crossings": ("proofs", "certified_crossings"),
    "exact_load": ("proofs", "exact_load"),
    "exact_spectrum": ("proofs", "exact_spectrum"),
    "truncation_error": ("proofs", "truncation_error"),
    "CertifiedCrossing": ("proofs", "CertifiedCrossing"),
    "ExactSpectrum": ("proofs", "ExactSpectrum"),
    "Truncation": ("proofs", "Truncation"),
    "Certified": ("proofs", "Certified"),
    "verify_certificate": ("proofs", "verify_certificate"),
    "respond": ("response", "respond"),
    "state_space": ("response", "state_space"),
    "Harmonic": ("response", "Harmonic"),
    "Response": ("response", "Response"),
    "InputError": ("checks", "InputError"),
}

_PACKAGES = ("figures",)  # of this package, whose names are used through theirs: fb.figures.root_locus


def __getattr__(name: str) -> object:
    value: object
    if name == "__version__":
        value = import_module("importlib.metadata").version("freebeam")
    elif name in _PACKAGES:
        value = import_module(f"{__name__}.{name}")
    elif name in _HOMES:
        module, attribute = _HOMES[name]
        value = getattr(import_module(f"{__name__}.{module}"), attribute)
    else:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*__all__, *_PACKAGES})
