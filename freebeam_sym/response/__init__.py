"""Response in time: Eq. (10) exactly or by Newmark's method, without a loop.

All quantities are nondimensional, Eq. (5).
"""

from freebeam_sym.response.inputs import Harmonic
from freebeam_sym.response.results import Response
from freebeam_sym.response.solution import respond

__all__ = ["Harmonic", "Response", "respond"]
