"""Pictures: the paper's figures, and drawings of any column's stability and motion.

    import freebeam_sym as fb
    ax = fb.figures.tangent(fb.column("beck"))

Each drawing takes `ax`, or makes axes, and returns them. matplotlib is loaded when the first one is made.
"""

from __future__ import annotations

from freebeam_sym.figures.look import style
from freebeam_sym.figures.motion import history, mode_shape, trajectory, work, work_loop
from freebeam_sym.figures.published import paper
from freebeam_sym.figures.sketch import beam
from freebeam_sym.figures.stability import (
    coalescence,
    critical_curve,
    eigenvalues,
    frequency_load,
    root_locus,
    stability_map,
    tangent,
)

__all__ = [
    "beam", "paper",
    "coalescence", "critical_curve", "eigenvalues", "frequency_load", "root_locus", "stability_map", "tangent",
    "history", "mode_shape", "trajectory", "work", "work_loop",
    "style",
]  # fmt: skip
