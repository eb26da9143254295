"""Newmark's method: its step, to the last digit; where it is stable; what it does to the eigenvalues.

The recurrence is the emitted `newmark_step`. It is linear, so applied to unit states it gives the step's matrix.
Average acceleration, (1/4, 1/2), is the trapezoidal rule: its step has the eigenvectors of the differential equation.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import NDArray

from freebeam_sym.checks import InputError
from freebeam_sym.response.double import BITS, ONE, Double, Fixed, add, solve, times
from freebeam_sym.response.inputs import Wave
from freebeam_sym.response.messages import Message
from freebeam_sym.response.stepping import Spectrum, acceleration

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

# Rounding of log |ρ|: a double root, as at the stability limit of an undamped mode, has half the digits.
ROUNDING = 1e-8
# Growth that is real may come out larger by this factor: the method's error, not an instability.
FOLLOWED = 1.1


@dataclass(frozen=True)
class Newmark:
    """Newmark's method with the parameters b and g. See `stepping.Method`."""

    recurrence: Callable[..., Any]
    b: float
    g: float

    @property
    def modal(self) -> bool:
        return (self.b, self.g) == (0.25, 0.5)

    def root(self, z: Fixed) -> Fixed:
        a, b = z[0] >> 1, z[1] >> 1
        below = ((ONE - a) ** 2 + b * b) >> BITS
        return ((ONE + a) * (ONE - a) - b * b) // below, 2 * ONE * b // below

    def gains(self, z: Complex, roots: Complex) -> tuple[Complex, Complex]:
        half = 0.5 / (1 - z / 2)
        return half, half

    def rate(self, wave: Wave, h: float) -> tuple[float, float] | None:
        cosine, sine = wave.rotation
        if ONE + cosine < ONE >> 20:  # half a turn a step
            return None
        rate = Fraction(2 * sine, ONE + cosine) / Fraction(h)  # (2/h) tan(θ/2)
        return float(rate), float(rate - Fraction(float(rate)))

    def matrix(self, M: Array, C: Array, K: Array, h: float, scale: Array) -> Double:
        """A satisfies both of Newmark's formulas with ddq from Eq. (10), each multiplied by M."""
        H, b, g = (Fraction(value) for value in (h, self.b, self.g))
        half = Fraction(1, 2) - b

        def combined(*terms: tuple[Fraction | int, Array]) -> Double:
            parts = [times(Fraction(factor), Double(matrix, np.zeros_like(matrix))) for factor, matrix in terms]
            return parts[0] if len(parts) == 1 else add(*parts)

        def matrix(*blocks: Double) -> Double:
            rows = [np.block([[blocks[0][k], blocks[1][k]], [blocks[2][k], blocks[3][k]]]) for k in range(2)]
            return Double(*(row * scale / scale[:, None] for row in rows))  # powers of two: exact

        left = matrix(
            combined((1, M), (b * H**2, K)), combined((b * H**2, C)),
            combined((g * H, K)), combined((1, M), (g * H, C)),
        )  # fmt: skip
        right = matrix(
            combined((1, M), (-half * H**2, K)), combined((H, M), (-half * H**2, C)),
            combined(((g - 1) * H, K)), combined((1, M), ((g - 1) * H, C)),
        )  # fmt: skip
        A, _, _ = self._floats(M, C, K, np.zeros(len(M)), h)
        return solve(left, right, A * scale / scale[:, None])

    def pushes(self, M: Array, C: Array, K: Array, Q: Array, h: float, scale: Array, wave: Wave | None) -> Array:
        _, before, after = self._floats(M, C, K, Q, h)
        found = np.stack([before, after], axis=1) / scale[:, None]
        if wave is not None:  # F⁺ is F turned
            cosine, sine = (float(part / ONE) for part in wave.rotation)
            found = found @ np.array([[1.0, 0.0], [cosine, -sine]])
        return found

    def _floats(self, M: Array, C: Array, K: Array, Q: Array, h: float) -> tuple[Array, Array, Array]:
        """A, B₀, B₁ of one step of (q, dq): the recurrence applied to unit states and unit forces."""
        n = len(M)
        state, force = acceleration(M, C, K, Q)
        unit = np.zeros((2 * n, 2 * n + 2))
        unit[:, :-2] = np.eye(2 * n)
        ddq = np.hstack([state, force[:, None], np.zeros((n, 1))])
        F = np.zeros((n, 2 * n + 2))
        F[:, -1] = Q
        q, dq, _ = self.recurrence(M, C, K, unit[:n], unit[n:], ddq, F, h, (self.b, self.g))
        step = np.vstack([q, dq])
        return step[:, :-2], step[:, -2], step[:, -1]

    def errors(self, spectrum: Spectrum, h: float) -> tuple[Complex, Array]:
        """Refused are roots that grow where the exact ones do not, and steps so long that rounding takes the digits."""
        M, C, K = spectrum.matrices
        n, exact, g = len(M), spectrum.values, self.g
        rates = np.sort(np.maximum(exact.real, 0))[::-1]
        hopeless = g < 0.5 and not C.any()  # damping of the wrong sign at any step

        def all_of(h: float) -> Complex | None:
            half = exact * (h / 2)
            if self.modal and (half != 1).all():
                mapped: Complex = (1 + half) / (1 - half)
                return mapped
            try:
                with np.errstate(all="ignore"):
                    found = np.linalg.eigvals(self._floats(M, C, K, np.zeros(n), h)[0])
            except np.linalg.LinAlgError:  # a singular effective matrix, or overflow
                return None
            return found.astype(complex)

        # The step multiplies K by h² and takes it off again: rounding grows with (ω h)² (measured factor: 1).
        stiffness = float(np.abs(np.linalg.eigvals(np.linalg.solve(M, K))).max())
        noise = 4 * np.finfo(float).eps * max(stiffness, 1e-300)
        if h > math.sqrt(1e-5 / noise):
            raise InputError(Message(
                "step = {h:time}: the fastest part, ω = {omega:frequency}, would lose its digits to rounding, which "
                "grows with (ω step)²; choose a step below {limit:time .3g} or fewer modes",
                h=h, omega=math.sqrt(stiffness), limit=math.sqrt(1e-5 / noise),
            ))  # fmt: skip

        def stable(h: float, found: Complex | None) -> bool:
            # the rigid part's own decay, β, is one that a step may overshoot where g < 1/2
            if found is None or not np.isfinite(found).all() or (1 - 2 * g) * spectrum.decay * h > 2:
                return False
            growth = np.sort(np.log(np.maximum(np.abs(found), 1e-300)))[::-1]
            return bool((growth <= FOLLOWED * h * rates + ROUNDING + noise * h**2).all())

        found = all_of(h)
        if hopeless or not stable(h, found):
            growth = math.exp(min(700.0, h * rates[0]))
            radius = math.nan if found is None else float(np.abs(found).max())
            limit = None if hopeless else _largest(lambda h: stable(h, all_of(h)), h)
            raise InputError(Message(
                f"step = {{h:time}}: beyond the stability limit of newmark = ({self.b:g}, {g:g}): a step multiplies a "
                f"part of the response by up to {radius:.6g}, the exact growth is {growth:.6g}; "
                + _cure(limit, rates[0] > 0), h=h, limit=limit or 0.0,
            ))  # fmt: skip
        assert found is not None  # stable
        roots = found if self.modal else self._matched(exact, found, h)
        oscillating = np.flatnonzero(exact.imag > 0)
        oscillating = oscillating[np.argsort(exact[oscillating].imag)]
        with np.errstate(divide="ignore"):  # a root may be zero, or real
            periods: Array = exact[oscillating].imag * h / np.abs(np.angle(roots[oscillating])) - 1
            return np.log(roots) / h - exact, periods

    def _matched(self, exact: Complex, roots: Complex, h: float) -> Complex:
        """Of the step's roots, that of each λ: nearest to where the method takes a single oscillator of that λ, which
        is the root itself where the system decouples; nearest to e^(λh) for a λ that does not oscillate."""
        one = np.ones((exact.size, 1, 1))
        M, C, K = one, -2 * exact.real[:, None, None], (np.abs(exact) ** 2)[:, None, None]
        q, dq = one * [1.0, 0.0], one * [0.0, 1.0]
        q, dq, _ = self.recurrence(M, C, K, q, dq, -K * q - C * dq, 0 * q, h, (self.b, self.g))
        single = np.linalg.eigvals(np.concatenate([q, dq], axis=1))
        single = single[np.arange(exact.size), np.argmax(single.imag, axis=1)]
        single = np.where(exact.imag < 0, np.conj(single), single)
        single = np.where(exact.imag == 0, np.exp(exact * h), single)
        matched: Complex = roots[np.argmin(np.abs(roots - single[:, None]), axis=1)]
        return matched


def _cure(largest: float | None, growing: bool) -> str:
    if largest is None:
        return "no step is stable with these parameters: choose g ≥ 1/2, such as newmark = (0.25, 0.5)"
    cure = "the largest stable step is {limit:time}"
    return cure if growing else cure + "; newmark = (0.25, 0.5) has no limit here"


def _largest(stable: Callable[[float], bool], h: float) -> float | None:
    """The largest stable step below h, rounded down to six digits, so that it may be used as printed."""
    low = h
    for _ in range(80):
        low /= 2
        if stable(low):
            break
    else:
        return None
    high = 2 * low
    for _ in range(40):
        middle = (low + high) / 2
        low, high = (middle, high) if stable(middle) else (low, middle)
    digits = 5 - math.floor(math.log10(low))
    return math.floor(low * 10.0**digits) / 10.0**digits
