"""Response in time: Newmark's method for Eq. (10) without its loop, and the same system for control engineers.

All quantities are nondimensional, Eq. (5).
"""

from freebeam_sym.response.inputs import Harmonic
from freebeam_sym.response.newmark import respond, state_space
from freebeam_sym.response.results import Response

__all__ = ["Harmonic", "Response", "respond", "state_space"]
