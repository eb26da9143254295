"""Derivatives of eigenvalues and of critical loads with respect to a parameter, from left and right null vectors."""

from __future__ import annotations

import numpy as np

from freebeam_sym.checks import InputError
from freebeam_sym.stability.problem import Complex, Real

__all__ = ["eigenvalue_derivative", "load_derivative"]

Triple = tuple[Real, Real, Real]
"""Of M, C, K at a load, or of their derivatives, each (n, n)."""
DOUBLE = 1e-7
"""Relative. uᴴ G_λ v below which an eigenvalue is double: it is off by the root of rounding."""


def eigenvalue_derivative(rate: complex, at: Triple, change: Triple) -> complex:
    """dλ/dp of a simple eigenvalue λ = `rate` of λ²M + λC + K: −uᴴ(λ²M_p + λC_p + K_p)v / uᴴ(2λM + C)v.

    at, change: M, C, K and their derivatives with respect to p. Raises InputError where λ is not simple.
    """
    u, v = _null(_matrix(rate, at))
    slope = u @ (2 * rate * at[0] + at[1]) @ v
    if abs(slope) <= DOUBLE * _size(rate, at):
        raise InputError(f"eigenvalue {rate}: is not simple, so it has no derivative")
    return complex(-(u @ _matrix(rate, change) @ v) / slope)


def load_derivative(omega: float, at: Triple, slope: Triple, change: Triple) -> float:
    """dP/dp of a load P at which λ = iω, ω = `omega`, stands on the axis (flutter, or divergence with ω = 0).

    at, slope, change: M, C, K at that load, and their derivatives with respect to P and to p. With the null vectors u
    and v of G = K + iωC − ω²M, uᴴ(G_P dP + G_ω dω + G_p dp)v = 0 in both parts. Where two frequencies meet without
    damping uᴴ G_ω v = 0, which leaves one. Raises InputError there where p brings damping, by which the load jumps, and
    where the load is not simple. For a damping that vanishes it does not hold.
    """
    rate = 1j * omega
    u, v = _null(_matrix(rate, at))
    a, c = (complex(u @ _matrix(rate, X) @ v) for X in (slope, change))
    b = complex(1j * (u @ (2 * rate * at[0] + at[1]) @ v))
    if omega and abs(b) * omega <= DOUBLE * _size(rate, at):
        if np.any(at[1]) or np.any(slope[1]) or np.any(change[1]):
            raise InputError("two frequencies meet: with damping the load has no derivative there")
        b = 0j
    if omega == 0 or b == 0:
        top, bottom = -(a.conjugate() * c).real, abs(a) ** 2
    else:
        top, bottom = -(b.conjugate() * c).imag, (b.conjugate() * a).imag
    if abs(bottom) <= DOUBLE**2 * abs(a) * max(abs(a), abs(b)):
        raise InputError("the load is not simple, so it has no derivative")
    return float(top / bottom)


def _matrix(rate: complex, at: Triple) -> Complex:
    M, C, K = at
    return np.asarray(rate * rate * M + rate * C + K, dtype=complex)


def _null(G: Complex) -> tuple[Complex, Complex]:
    """Left null vector, conjugated, and right null vector."""
    left, _, right = np.linalg.svd(G)
    return left[:, -1].conj(), right[-1].conj()


def _size(rate: complex, at: Triple) -> float:
    """Of λ G_λ: the norms of its terms."""
    return float(abs(2 * rate**2) * np.linalg.norm(at[0]) + abs(rate) * np.linalg.norm(at[1]))
