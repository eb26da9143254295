"""Stability of columns under follower forces: spectra, critical loads and responses, with pictures and proofs.

    import freebeam as fb
    column = fb.column("free-free")
    fb.critical_load(column, modes=8, alpha=1e-3, beta=0.1).load

Each name loads its module when it is first used, so that importing this package costs next to nothing.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

import freebeam_sym as _runtime

if TYPE_CHECKING:
    import freebeam.figures  # noqa: F401 (fb.figures, for type checkers)
    from freebeam.certificates import verify_certificate
    from freebeam.control import state_space
    from freebeam.damping import proportional_damping
    from freebeam.exact_ranges import ExactPiece, ExactRange, OpenPiece, exact_range
    from freebeam.loci import Branches, branches
    from freebeam.maps.arrays import CriticalLoads, critical_loads, eigenvalues
    from freebeam.maps.boundaries import Boundary, BoundaryEvent, trace_boundary
    from freebeam.maps.known import critical_load
    from freebeam.maps.labelled import stability_map
    from freebeam.own import column, column_names
    from freebeam.proofs import (
        Certified,
        CertifiedCrossing,
        CertifiedCrossings,
        CertifiedPulse,
        ExactSpectrum,
        Truncation,
        certified_crossings,
        certified_load,
        certified_pulse,
        exact_crossings,
        exact_load,
        exact_spectrum,
        truncation_error,
    )
    from freebeam.pulsating import PulsatingRegion, PulsatingRegions, pulse
    from freebeam.vehicles import Vehicle, vehicle
    from freebeam_sym import (
        Column,
        CriticalLoad,
        Harmonic,
        InputError,
        Question,
        Response,
        Spectrum,
        System,
        respond,
        spectrum,
    )

__all__ = [
    "column", "column_names", "Column", "System", "Question",
    "spectrum", "branches", "eigenvalues", "proportional_damping", "Spectrum", "Branches",
    "critical_load", "CriticalLoad",
    "critical_loads", "stability_map", "trace_boundary", "CriticalLoads", "Boundary", "BoundaryEvent",
    "pulse", "PulsatingRegions", "PulsatingRegion",
    "certified_load", "certified_crossings", "certified_pulse", "exact_load", "exact_crossings", "exact_spectrum",
    "truncation_error", "Certified", "CertifiedCrossing", "CertifiedCrossings", "CertifiedPulse", "ExactSpectrum",
    "Truncation", "verify_certificate", "exact_range", "ExactRange", "ExactPiece", "OpenPiece",
    "respond", "state_space", "Harmonic", "Response",
    "vehicle", "Vehicle",
    "InputError",
    "__version__",
]  # fmt: skip

# Modules of this package by the names that they give; every other name is the runtime's. No name may be that of a
# module, because importing the module would put it in the name's place.
_HOMES = {
    "own": ["column", "column_names"],
    "loci": ["branches", "Branches"],
    "control": ["state_space"],
    "damping": ["proportional_damping"],
    "maps.arrays": ["critical_loads", "CriticalLoads", "eigenvalues"],
    "maps.known": ["critical_load"],
    "maps.labelled": ["stability_map"],
    "maps.boundaries": ["trace_boundary", "Boundary", "BoundaryEvent"],
    "pulsating": ["pulse", "PulsatingRegions", "PulsatingRegion"],
    "exact_ranges": ["exact_range", "ExactRange", "ExactPiece", "OpenPiece"],
    "proofs": [
        "certified_load", "certified_crossings", "certified_pulse", "exact_load", "exact_crossings", "exact_spectrum",
        "truncation_error", "Certified", "CertifiedCrossing", "CertifiedCrossings", "CertifiedPulse", "ExactSpectrum",
        "Truncation",
    ],
    "certificates": ["verify_certificate"],
    "vehicles": ["vehicle", "Vehicle"],
}  # fmt: skip
_PACKAGES = ("figures",)  # of this package, whose names are used through theirs: fb.figures.root_locus


def __getattr__(name: str) -> object:
    home = next((module for module, names in _HOMES.items() if name in names), None)
    value: object
    if name in _PACKAGES:
        value = import_module(f"{__name__}.{name}")
    elif home is not None:
        value = getattr(import_module(f"{__name__}.{home}"), name)
    elif name in __all__:
        value = getattr(_runtime, name)
    else:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*__all__, *_PACKAGES})
