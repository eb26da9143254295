"""Pictures: the paper's figures, and drawings of any column's stability and motion.

    import freebeam_sym as fb
    ax = fb.figures.tangent(fb.column("beck"))

Each drawing takes `ax`, or makes axes, and returns them. matplotlib is loaded when the first one is made.
"""

from __future__ import annotations

from freebeam_sym.figures.motion import mode_shape, work, work_loop
from freebeam_sym.figures.stability import coalescence, frequency_load, tangent
from freebeam_sym.figures.style import style

__all__ = ["coalescence", "frequency_load", "mode_shape", "style", "tangent", "work", "work_loop"]
