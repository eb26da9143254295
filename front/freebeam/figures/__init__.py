"""Pictures: the paper's figures, and drawings of any column's stability and motion.

    import freebeam as fb
    ax = fb.figures.tangent(fb.column("beck"))

Each drawing takes `ax`, or makes axes, and returns them. matplotlib is loaded when the first one is made.
"""

from __future__ import annotations

from freebeam.figures.diagrams import (
    coalescence,
    critical_curve,
    eigenvalues,
    frequency_load,
    root_locus,
    stability_map,
    tangent,
)
from freebeam.figures.look import style
from freebeam.figures.proof_of_first import strips
from freebeam.figures.published import paper
from freebeam.figures.regions import proven_range, pulsating_regions
from freebeam.figures.schematic import beam
from freebeam.figures.shapes import history, mode_shape, trajectory, work, work_loop

__all__ = [
    "beam", "paper",
    "coalescence", "critical_curve", "eigenvalues", "frequency_load", "proven_range", "pulsating_regions",
    "root_locus", "stability_map", "strips", "tangent",
    "history", "mode_shape", "trajectory", "work", "work_loop",
    "style",
]  # fmt: skip
