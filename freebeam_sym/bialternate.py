"""All flutter loads of a pencil at once, as the real eigenvalues of one matrix: no search, and none is missed.

Where x = (v, iωv) is a state of Eq. (25) with A x = iωx, the antisymmetric X = Im(x xᴴ) solves A X + X Aᵀ = 0, and
some X ≠ 0 does so exactly where two eigenvalues of A add up to zero (the bialternate product of A with I is singular:
Fuller 1968; Guckenheimer, Myers and Sturmfels 1997). Below the first loss of stability none do. With K = E + P H and
C = size · diag(D), the blocks of X are made of S = −ω Re(v vᴴ) = Sᵀ and Y = Im(v vᴴ)/size = −Yᵀ, for which

    Y Kᵀ − K Y + S D + D S = 0
    S Kᵀ − K S = size² (D W + W D),    W = (Y Kᵀ + K Y + S D − D S)/2

linear in P, and regular down to size = 0, the limit of vanishing damping. At P = 0 each pair of modes stands alone, so
this is z = P T z with T dense, of order N (N − 1): the loads are the inverses of the real eigenvalues of T.
"""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from freebeam_sym.counts import unstable
from freebeam_sym.pencil import Crossing, Damping, Pencil, Real, newton

__all__ = ["MOST", "direct_crossing"]

MOST = 10
"""Modes up to which this is quicker than the search: it costs as the sixth power of their number."""
_NEAR = 1e-6
"""Relative. Nothing may grow so far below a first load, and something must so far above it; a pair of loads that is so
close to the real axis, or a flutter so close to divergence, is left to the search."""


def direct_crossing(pencil: Pencil, damping: Damping, load_max: float, limit: bool) -> tuple[bool, Crossing | None]:
    """Whether this route settles the question, and the first loss of stability up to `load_max`, None where there is
    none. limit: that damping vanishes.

    What is found is polished by Newton's method and confirmed by counts of the eigenvalues that grow below and above.
    """
    known, bound = None, load_max
    if len(pencil.divergence_loads) and pencil.divergence_loads[0] <= load_max * (1 + _NEAR):
        known = pencil.divergence(float(pencil.divergence_loads[0]))
        known, bound = (known, known.load) if known.load <= load_max else (None, load_max)
    if not pencil.conservative:
        T, S, Y = _products(pencil, damping)
        mu = np.linalg.eigvals(T)
        k = int(np.where(mu.imag == 0, mu.real, -np.inf).argmax())
        first = max(float(mu[k].real), 0.0) if mu[k].imag == 0 else 0.0
        if abs(first * bound - 1) <= _NEAR:
            return False, None
        rivals = np.delete(mu, k)
        rivals = rivals[rivals.real > (1 - _NEAR) * max(first, 1 / bound)]
        if (np.abs(rivals.imag[rivals.imag != 0]) < _NEAR * rivals.real[rivals.imag != 0]).any():
            return False, None  # two loads that are about to meet, or have just met
        if first * bound > 1:
            apart = np.abs(rivals - first).min(initial=np.inf) / first
            known = _polished(pencil, damping, T, S, Y, 1 / first)
            if known is None or not abs(known.load * first - 1) < min(_NEAR, apart / 4):
                return False, None
            bound = known.load
    if unstable(pencil, damping, bound * (1 - _NEAR), limit):
        return False, None
    if known is not None and not unstable(pencil, damping, bound * (1 + _NEAR), limit):
        return False, None
    return True, known


@lru_cache(maxsize=8)
def _pairs(n: int) -> tuple[NDArray[np.intp], NDArray[np.intp], Real]:
    """Pairs of modes i < j, (m,) each, and the antisymmetric matrix of each pair, (m, n, n)."""
    i, j = np.triu_indices(n, 1)
    k, unit = np.arange(len(i)), np.zeros((len(i), n, n))
    unit[k, i, j], unit[k, j, i] = 1.0, -1.0
    return i, j, unit


def _products(pencil: Pencil, damping: Damping) -> tuple[Real, Real, Real]:
    """T (2m, 2m), m = N (N − 1)/2, and S, Y (2m, N, N) that each unit vector is taken to.

    A vector holds Y above its diagonal and there too q = S Hᵀ − H S, which is all that P multiplies.
    """
    e, H, D, square = pencil.e, pencil.H, damping.shape, damping.size**2
    i, j, unit = _pairs(pencil.size)
    m = len(i)
    gap, both = e - e[:, None], D + D[:, None]
    # what P multiplies, on the right-hand sides of the two equations
    HY = H @ unit
    turned = np.swapaxes(HY, 1, 2)
    first = np.concatenate([HY + turned, np.zeros_like(HY)])
    second = np.concatenate([square / 2 * both * (HY - turned), -unit])
    # the two equations of each pair at P = 0: both S + gap Y = first, slope S − weight Y = second
    slope = gap - square / 2 * both * (D - D[:, None])
    weight = square / 2 * both * (e + e[:, None])
    determinant = gap**2 + square * both * (np.outer(e, D) + np.outer(D, e))
    np.fill_diagonal(weight, 1.0)  # a mode by itself: S = first / both, at vanishing damping too
    np.fill_diagonal(determinant, np.diag(both))
    S = (weight * first + gap * second) / determinant
    Y = (slope * first - both * second) / determinant
    HS = H @ S
    q = np.swapaxes(HS, 1, 2) - HS
    T = np.empty((2 * m, 2 * m))
    T[:m], T[m:] = Y[:, i, j].T, q[:, i, j].T
    return T, S, Y


def _polished(pencil: Pencil, damping: Damping, T: Real, S: Real, Y: Real, load: float) -> Crossing | None:
    """The flutter at a load of the matrix, by inverse iteration for its motion and Newton's method."""
    z = np.cos(np.arange(len(T)))  # any vector
    shifted = T - np.eye(len(T)) / load
    try:
        for _ in range(2):
            z = np.linalg.solve(shifted, z)
            z /= np.abs(z).max()
    except np.linalg.LinAlgError:
        return None
    # S ~ a aᵀ + ω² size² b bᵀ with a and b at right angles, and Y ~ a bᵀ − b aᵀ
    S, Y = np.tensordot(z, S, 1), np.tensordot(z, Y, 1)
    sizes, vectors = np.linalg.eigh(S)
    top = int(np.abs(sizes).argmax())
    a = vectors[:, top]
    b = -(Y @ a) / sizes[top]
    square = a @ (pencil.e * a + load * (pencil.H @ a)) / (a @ a + damping.size**2 * (a @ (damping.shape * b)))
    root = newton(pencil, damping, float(square), load, a, b)
    if root is None and 0 < square < _NEAR * pencil.e[0]:  # next to ω = 0, where rounding keeps ω² from settling
        root = float(square), load, a, b
    if root is None or root[0] <= 0:
        return None
    omega = math.sqrt(root[0])
    return Crossing(root[1], omega, pencil.vector(root[2] + 1j * omega * damping.size * root[3]))
