"""Derivatives of critical loads with respect to a parameter, from left and right null vectors."""

from __future__ import annotations

import numpy as np

from freebeam_sym.checks import InputError
from freebeam_sym.stability.problem import Real

__all__ = ["crossing_derivative"]

Triple = tuple[Real, Real, Real]
"""Of M, C, K at a load, or of their derivatives, each (n, n)."""
DOUBLE = 1e-7
"""Relative. uᴴ G_λ v below which an eigenvalue is double: it is off by the root of rounding."""
LIGHT = 1e-5
"""A damping that stands for one that vanishes, relative to how far other motions are: derivatives are off by its
square, and by rounding over it. Of Beck's column they are by 1e-10, up to N = 40."""


def crossing_derivative(
    omega: float, at: Triple, slope: Triple, change: Triple, vanishing: bool = False
) -> tuple[float, float]:
    """dP/dp and dω/dp of a crossing: a load P at which λ = iω, ω = `omega`, stands on the axis (flutter, or divergence
    with ω = 0).

    at, slope, change: M, C, K at that load, and their derivatives with respect to P and to p; vanishing: C is the
    direction of a damping that vanishes. With the null vectors u and v of G = K + iωC − ω²M,
    uᴴ(G_P dP + G_ω dω + G_p dp)v = 0 in both parts. A damping that vanishes is taken as light; where frequencies meet
    without any, so is C = M, in whose limit they meet. Raises InputError where they meet and p brings damping, by which
    the load jumps, and where the load is not simple.
    """
    damped = bool(np.any(at[1]) or np.any(slope[1]))
    light = omega > 0 and (vanishing or not damped)
    rate, inertia = 1j * omega, omega**2 * at[0]
    if light:
        if not damped and np.any(change[1]):
            raise InputError("two frequencies meet: with damping the load has no derivative there")
        D = 1 if damped else 0
        terms = np.linalg.solve(at[2] + inertia, np.array([at[2] - inertia, omega * at[D], omega * slope[D]]))
        gap = float(np.linalg.svd(terms[0], compute_uv=False)[:-1].min(initial=1.0))
        if gap <= DOUBLE:
            raise InputError("two motions have one frequency: the load has no derivative there")
        size = LIGHT * gap / float(np.linalg.norm(terms[1:]))
        at, slope, change = ((X[0], size * X[D], X[2]) for X in (at, slope, change))
    G, G_P, G_p = (rate * rate * M + rate * C + K for M, C, K in (at, slope, change))
    G_omega = 1j * (2 * rate * at[0] + at[1])
    # else the rounding of the stiffest motions hides what is of the others; one may have no mass, but then has damping
    whole = (
        G + 2 * inertia + (0 if light else rate * at[1]) if omega else np.diag(np.linalg.norm([G, G_P], axis=(0, 2)))
    )
    G, G_P, G_omega, G_p = np.linalg.solve(whole, np.array([G, G_P, G_omega, G_p]))
    left, sizes, right = np.linalg.svd(G)
    if not omega and len(G) > 1 and sizes[-2] <= DOUBLE**1.5:  # two planes of a shaft, say
        each = np.linalg.solve(*(left[:, -2:].conj().T @ X @ right[-2:].conj().T for X in (G_P, G_p)))
        if np.abs(each - each[0, 0] * np.eye(2)).max() > DOUBLE * np.abs(each).max():
            raise InputError("two motions are lost at once, and not alike: the load has no derivative there")
        return -float(each[0, 0].real), 0.0
    u, v = left[:, -1].conj(), right[-1].conj()
    a, b, c = (complex(u @ X @ v) for X in (G_P, G_omega, G_p))
    if not omega:
        b = 1j * a
    elif not light and abs(b) <= DOUBLE * np.linalg.norm(G_omega):
        raise InputError("two frequencies meet: the load has no derivative there")
    bottom = (b.conjugate() * a).imag
    if abs(bottom) <= DOUBLE**2 * abs(a) * max(abs(a), abs(b)):
        raise InputError("the load is not simple, so it has no derivative")
    return -(b.conjugate() * c).imag / bottom, (a.conjugate() * c).imag / bottom if omega else 0.0
