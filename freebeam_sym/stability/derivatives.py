"""Derivatives of critical loads with respect to a parameter, from left and right null vectors."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from freebeam_sym.checks import InputError
from freebeam_sym.stability.problem import Complex, Real

__all__ = ["crossing_derivative"]

Triple = tuple[Real, Real, Real]
"""Of M, C, K at a load, or of their derivatives, each (n, n)."""
DOUBLE = 1e-7
"""Relative. uᴴ G_λ v below which an eigenvalue is double: it is off by the root of rounding."""


def crossing_derivative(
    omega: float, at: Triple, slope: Triple, change: Triple, vanishing: bool = False
) -> tuple[float, float]:
    """dP/dp and dω/dp of a crossing: a load P at which λ = iω, ω = `omega`, stands on the axis (flutter, or divergence
    with ω = 0).

    at, slope, change: M, C, K at that load, and their derivatives with respect to P and to p; vanishing: C is the
    direction of a damping that vanishes. With the null vectors u and v of G = K + iωC − ω²M,
    uᴴ(G_P dP + G_ω dω + G_p dp)v = 0 in both parts. Where damping vanishes or frequencies meet without any, G is real,
    and beside it uᵀDv stays 0, D = C or M. Raises InputError where frequencies meet and p brings damping, by which
    the load jumps, and where the load is not simple.
    """
    rate = 1j * omega
    if omega and (vanishing or not (np.any(at[1]) or np.any(slope[1]))):
        if not vanishing and np.any(change[1]):
            raise InputError("two frequencies meet: with damping the load has no derivative there")
        return _real(omega, at, slope, change, 1 if vanishing else 0)
    u, v, _ = _null(_matrix(rate, at))
    a, c = (complex(u @ _matrix(rate, X) @ v) for X in (slope, change))
    b = complex(1j * (u @ (2 * rate * at[0] + at[1]) @ v)) if omega else 1j * a
    if omega and abs(b) * omega <= DOUBLE * _size(rate, at):
        raise InputError("two frequencies meet: the load has no derivative there")
    bottom = (b.conjugate() * a).imag
    if abs(bottom) <= DOUBLE**2 * abs(a) * max(abs(a), abs(b)):
        raise InputError("the load is not simple, so it has no derivative")
    return -(b.conjugate() * c).imag / bottom, (a.conjugate() * c).imag / bottom if omega else 0.0


def _real(omega: float, at: Triple, slope: Triple, change: Triple, kind: int) -> tuple[float, float]:
    """The same where G = K − sM is real, s = ω²: uᵀGv = 0 and uᵀDv = 0 of M, C (kind 1) or M (kind 0) for D."""
    s, D = omega**2, at[kind]
    u, v, inverse = _null(at[2] - s * at[0])
    w, z = inverse @ (D @ v), (u @ D) @ inverse

    def both(G: Real, dD: Real) -> list[float]:
        """What a change of G and of D does to uᵀGv and, as u and v move with it, to uᵀDv."""
        return [float(u @ G @ v), float(u @ G @ w + z @ G @ v - u @ dD @ v)]

    load, square = both(slope[2] - s * slope[0], slope[kind]), both(-at[0], np.zeros_like(D))
    if abs(load[0] * square[1] - load[1] * square[0]) <= DOUBLE**2 * math.hypot(*load) * math.hypot(*square):
        raise InputError("the load is not simple, so it has no derivative")
    right = both(change[2] - s * change[0], change[kind])
    moved = np.linalg.solve(np.array([load, square]).T, -np.array(right))
    return float(moved[0]), float(moved[1]) / (2 * omega)


def _matrix(rate: complex, at: Triple) -> Complex:
    M, C, K = at
    return np.asarray(rate * rate * M + rate * C + K, dtype=complex)


def _null(G: NDArray[Any]) -> tuple[NDArray[Any], NDArray[Any], NDArray[Any]]:
    """Left null vector, conjugated, right null vector, and the pseudoinverse of all else."""
    left, sizes, right = np.linalg.svd(G)
    inverse = (right[:-1].conj().T / sizes[:-1]) @ left[:, :-1].conj().T
    return left[:, -1].conj(), right[-1].conj(), inverse


def _size(rate: complex, at: Triple) -> float:
    """Of λ G_λ: the norms of its terms."""
    return float(abs(2 * rate**2) * np.linalg.norm(at[0]) + abs(rate) * np.linalg.norm(at[1]))
