"""The exact method: the matrix exponential over a step, for forces that are harmonic or linear between the steps."""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from freebeam_sym.response.double import BITS, Double, Fixed, expm, exponential, fixed, solve, times
from freebeam_sym.response.inputs import Wave
from freebeam_sym.response.stepping import Spectrum, acceleration

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]


@dataclass(frozen=True)
class Exact:
    """x⁺ = e^(hG) x + ∫ e^((h−τ)G) B F(τ) dτ of x′ = G x + B F. See `stepping.Method`."""

    @property
    def modal(self) -> bool:
        return True

    def errors(self, spectrum: Spectrum, h: float) -> tuple[Complex, Array]:
        return np.zeros_like(spectrum.values), np.zeros(spectrum.oscillating.size)

    def root(self, z: Fixed) -> Fixed:
        return exponential(z)

    def gains(self, z: Complex, roots: Complex) -> tuple[Complex, Complex]:
        """B₁ is φ₂(z) = (e^z − 1 − z) / z², B₀ + B₁ is φ₁(z) = (e^z − 1) / z; series where these cancel."""
        small = np.abs(z) < 1
        w, z = np.where(small, z, 0), np.where(small, 1, z)
        one, two = np.zeros_like(w), np.zeros_like(w)
        for k in range(18, -1, -1):
            one, two = one * w + 1 / math.factorial(k + 1), two * w + 1 / math.factorial(k + 2)
        one, two = np.where(small, one, (roots - 1) / z), np.where(small, two, (roots - 1 - z) / z**2)
        return one - two, two

    def rate(self, wave: Wave, h: float) -> tuple[float, float] | None:
        return wave.frequency, 0.0

    def matrix(self, M: Array, C: Array, K: Array, h: float, scale: Array) -> Double:
        return expm(_generator(M, C, K, h, scale))

    def pushes(self, M: Array, C: Array, K: Array, Q: Array, h: float, scale: Array, wave: Wave | None) -> Array:
        """The force joins the states: (F, F⁺ − F), of which the second is the growth over a step, or a wave's parts."""
        d = 2 * len(M)
        _, force = acceleration(M, C, K, Q)
        drive = h * np.concatenate([np.zeros(len(M)), force]) / scale
        size = 2.0 ** math.frexp(float(np.abs(drive).max()))[1]  # beside the others' entries it shall be of their order
        whole = Double(*(np.pad(part, (0, 2)) for part in _generator(M, C, K, h, scale)))
        whole.high[:d, d] = drive / size
        if wave is None:
            whole.high[d, d + 1] = 1.0
        else:
            angle = Fraction(fixed(wave.frequency) * fixed(h), 1 << 2 * BITS)
            turn = np.array([[0.0, -1.0], [1.0, 0.0]])
            whole.high[d:, d:] = float(angle) * turn
            whole.low[d:, d:] = float(angle - Fraction(float(angle))) * turn
        found = expm(whole).high[:d, d:] * size
        return found if wave is not None else found @ np.array([[1.0, 0.0], [-1.0, 1.0]])


def _generator(M: Array, C: Array, K: Array, h: float, scale: Array) -> Double:
    """h G to twice the digits, of the states (q, dq) / scale."""
    n = len(M)
    right = np.concatenate([-K, -C], axis=1)
    guess, none = acceleration(M, C, K, np.zeros(n))[0], np.zeros_like(right)
    lower = solve(Double(M, np.zeros_like(M)), Double(right, none), guess)
    upper = np.eye(n, 2 * n, n)
    parts = (np.concatenate([upper, lower.high]), np.concatenate([np.zeros_like(upper), lower.low]))
    return times(Fraction(h), Double(*(part * scale / scale[:, None] for part in parts)))
