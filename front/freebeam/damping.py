"""Damping as it is measured, at two frequencies, as the two dampings of a column."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from freebeam_sym.checks import InputError, reals

__all__ = ["proportional_damping"]


def proportional_damping(ratios: ArrayLike, frequencies: ArrayLike) -> tuple[float, float]:
    """alpha and beta with which two modes of an unloaded beam have given damping ratios: ζ = (α ω + β/ω)/2, Eq. (12).

    ratios, frequencies: (2,), of the two modes, nondimensional. (In SI units, rad/s, they give C_α in s and C_β/m in
    1/s.) Raises InputError for bad values, and where one of the two dampings would be negative.

    >>> alpha, beta = proportional_damping([0.01, 0.02], [10.0, 50.0])
    >>> round((alpha * 50 + beta / 50) / 2, 12)
    0.02
    """
    zeta, omega = reals("ratios", ratios), reals("frequencies", frequencies)
    if zeta.shape != (2,) or omega.shape != (2,) or not (omega > 0).all() or omega[0] == omega[1]:
        raise InputError(f"ratios = {zeta}, frequencies = {omega}: must be of two modes, frequencies above 0")
    alpha, beta = np.linalg.solve(np.column_stack([omega / 2, 0.5 / omega]), zeta)
    if (zeta < 0).any() or min(alpha * omega.max(), beta / omega.min()) < -1e-12 * zeta.max():
        low, high = sorted(omega[::-1] / omega)
        raise InputError(
            f"ratios = {zeta}: no alpha, beta of zero or more give them at frequencies {omega}; the second may "
            f"be {low:.4g} to {high:.4g} times the first"
        )
    return max(float(alpha), 0.0), max(float(beta), 0.0)
