"""A system as control engineers take it: states, inputs and outputs. Eq. (25)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from freebeam_sym.checks import place, positions
from freebeam_sym.columns import is_system
from freebeam_sym.massless import reduced, without_mass
from freebeam_sym.response.results import names_of
from freebeam_sym.response.solution import rows_of, with_masses
from freebeam_sym.spectra import state_matrix

if TYPE_CHECKING:
    from scipy.signal import StateSpace

    from freebeam_sym.columns import System

__all__ = ["state_space"]


def state_space(
    system: System,
    force_position: float,
    sensors: ArrayLike = (0.1,),
    outputs: Sequence[str] = ("y",),
    field: str = "",
    derivative: int = 0,
) -> StateSpace:
    """The same system as a `scipy.signal.StateSpace`: state (q, dq), input F₀, outputs at sensors. Eq. (25).

    The outputs are those named, of "y", "dy", "ddy", each at all sensors, in that order; field and derivative as
    `respond` has them. Of a coordinate without mass the rate, or the coordinate too, is no state. Raises InputError for
    positions off the beam and for an unknown output.
    """
    is_system(system)
    names_of(outputs, False, False, None)
    x_s = positions("sensors", sensors)
    Q = np.asarray(system.Q(place("force_position", force_position)), dtype=float)
    from scipy.signal import StateSpace  # half a second, so only where it is used

    free = states = None
    if without_mass(system.M):
        found = reduced(system.M, system.C, system.K)
        system, Q = with_masses(system, found, Q)
        free, states = found.free, found.states
    rows, direct = rows_of(system, outputs, x_s, Q, field, derivative)
    B = np.concatenate([np.zeros(Q.size), np.linalg.solve(system.M, Q)])
    C, D = (np.concatenate([part[name] for name in outputs]) for part in (rows, direct))
    A = state_matrix(system.M, system.C, system.K)
    if states is not None:
        A, B, C = (A @ states)[free], B[free], C @ states
    return StateSpace(A, B[:, None], C, D[:, None])
