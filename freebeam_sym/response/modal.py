"""Eigenvalues of Eq. (10) to more digits than floats have, and the steady state under a harmonic force."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from freebeam_sym.response.double import BITS, Double, Fixed, add, fixed, matmul, multiply, two_product

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

CONDITION = 100.0  # of an eigenvalue: above it coalescence or rigid motion is near
RESOLVED = 1e-2  # |s − λ| t above which a force and a mode are told apart


class Modes(NamedTuple):
    """Eigenvalues λ with Im λ ≥ 0 as sums of two floats, and the vectors (q, λ q): theirs, then the conjugates'."""

    high: Complex
    low: Complex
    vectors: Complex
    inverse: Complex

    def times(self, h: float) -> list[Fixed]:
        """h λ."""
        width = fixed(h)
        return [
            ((fixed(z.real) + fixed(rest.real)) * width >> BITS, (fixed(z.imag) + fixed(rest.imag)) * width >> BITS)
            for z, rest in zip(self.high.tolist(), self.low.tolist(), strict=True)
        ]

    def coordinates(self, states: Array) -> Complex:
        """Of states (…, 2 n): what each λ with Im λ ≥ 0, its conjugate included, has in them as a real part."""
        found: Complex = states @ self.inverse[: self.high.size].T
        return np.asarray(found * np.where(self.high.imag > 0, 2.0, 1.0))


def modes_of(M: Array, C: Array, K: Array, values: Complex, vectors: Complex, scale: Array) -> Modes | None:
    """Eigenvalues and vectors of λ² M + λ C + K to more digits, from floats; None where they are ill-conditioned.

    One step of Newton's method with the residual in twice the digits: what is left is its square.
    """
    n, half = len(M), np.flatnonzero(values.imag >= 0)
    high = values[half]
    if 2 * half.size - np.count_nonzero(high.imag == 0) != 2 * n:
        return None
    oscillating = high.imag > 0
    V = vectors[:n, half]

    def with_pairs(state: Complex) -> Complex:
        return np.concatenate([state, np.conj(state[:, oscillating])], axis=1)

    X = with_pairs(np.concatenate([V, V * high]))
    try:
        W: Complex = np.linalg.inv(X).astype(complex)
    except np.linalg.LinAlgError:
        return None
    a, b = high.real, high.imag
    a_2, b_2, two_ab = (
        Double(*pair) for pair in zip(*two_product(np.array([a, b, 2 * a]), np.array([a, b, b])), strict=True)
    )
    square = add(a_2, Double(-b_2.high, -b_2.low))
    none = np.zeros_like(a)
    # λ² V and λ V: axes (real and imaginary part of V, of the factor; factor; function; eigenvalue)
    factors = Double(
        np.array([[square.high, a], [two_ab.high, b]])[None, :, :, None],
        np.array([[square.low, none], [two_ab.low, none]])[None, :, :, None],
    )
    p = multiply(factors, np.array([V.real, V.imag])[:, None, None])
    products = add(
        Double(*(np.array([part[0, 0], part[0, 1]]) for part in p)),
        Double(*(np.array([-part[1, 1], part[1, 0]]) for part in p)),
    )
    parts = zip(products, ([V.real, V.imag], np.zeros((2, n, half.size))), strict=True)
    stacked = [np.concatenate([whole, np.array(rest)[:, None]], axis=1) for whole, rest in parts]
    stacked = [whole.reshape(2, 3 * n, -1).swapaxes(0, 1).reshape(3 * n, -1) for whole in stacked]
    matrices = np.concatenate([M, C, K], axis=1)
    found = matmul(Double(matrices, np.zeros_like(matrices)), Double(*stacked)).high
    residual = found[:, : half.size] + 1j * found[:, half.size :]
    E = -W[:, n:] @ np.linalg.solve(M, residual)
    gaps = high - with_pairs(high[None, :])[0][:, None]
    own = np.arange(half.size)
    low = E[own, own]
    gaps[own, own] = np.inf
    with np.errstate(divide="ignore", invalid="ignore"):
        moves = E / gaps
    if not np.abs(moves).max() < 1e-8:
        return None
    V = V + X[:n] @ moves
    X = with_pairs(np.concatenate([V, V * high]))
    W = np.linalg.inv(X).astype(complex)
    sizes = np.linalg.norm(X / scale[:, None], axis=0) * np.linalg.norm(W * scale, axis=1)
    return Modes(high, low, X, W) if sizes.max() < CONDITION else None


def steady(modes: Modes, drive: Array, rate: tuple[float, float], duration: float) -> Complex | None:
    """State x̂ of x′ = G x + `drive` e^(st), s = i (rate[0] + rate[1]); None at resonance."""
    high, low = rate
    apart = [(1j * high - z) + (1j * low - rest) for z, rest in (modes[:2], np.conj(modes[:2]))]
    everywhere = np.concatenate([apart[0], apart[1][modes.high.imag > 0]])
    if not np.abs(everywhere).min() * duration > RESOLVED:
        return None
    found: Complex = modes.vectors @ ((modes.inverse @ drive) / everywhere)
    return found
