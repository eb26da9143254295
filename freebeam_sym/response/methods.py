"""What a method makes of Eq. (10): a step x⁺ = A x + B₀ F + B₁ F⁺ of the states x = (q, dq). All else is shared.

Both methods answer the same questions, `Exact` says which. Where the step has the eigenvectors of the differential
equation, A, B₀ and B₁ follow from an eigenvalue; else, and where these are ill conditioned, from the matrices.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np

from freebeam_sym.checks import InputError
from freebeam_sym.response.digits import ONE, Array, Complex, Double, Fixed, expm, exponential, rounded, solve, stacked
from freebeam_sym.response.eigen import Spectrum, scale_of
from freebeam_sym.response.inputs import Message

Matrices = tuple[Array, Array, Array]

QUARTER = np.array([[0.0, -1.0], [1.0, 0.0]])
"""A quarter of a turn."""
ROUNDING = 1e-8
"""Of log |ρ|: a double root, as at the stability limit of an undamped mode, has half the digits."""
FOLLOWED = 1.1
"""Growth that is real may come out larger by this factor: the method's error, not an instability."""
LOST = 1e-5
"""Relative rounding in a step of the fastest part from which on the step is refused."""


@dataclass(frozen=True)
class Exact:
    """The matrix exponential over a step, for forces that are harmonic or linear between the steps."""

    modal = True
    """Whether the step has the eigenvectors of the differential equation."""

    def errors(self, spectrum: Spectrum, h: float) -> Complex:
        """log(root of A) / h − λ of each eigenvalue λ. Raises InputError for a step that is not stable or loses its
        digits."""
        return np.zeros_like(spectrum.values)

    def root(self, z: Fixed) -> Fixed:
        """The eigenvalue of A where that of the differential equation is λ = z / h."""
        return exponential(z)

    def gains(self, z: Complex, roots: Complex) -> tuple[Complex, Complex]:
        """What B₀ and B₁ are to h B of x′ = λ x + B F, λ = z / h, `roots` being `root` of z.

        B₁ is φ₂(z) = (e^z − 1 − z) / z², B₀ + B₁ is φ₁(z) = (e^z − 1) / z; series where these cancel.
        """
        small = np.abs(z) < 1
        w, z = np.where(small, z, 0), np.where(small, 1, z)
        one, two = np.zeros_like(w), np.zeros_like(w)
        for k in range(18, -1, -1):
            one, two = one * w + 1 / math.factorial(k + 1), two * w + 1 / math.factorial(k + 2)
        one, two = np.where(small, one, (roots - 1) / z), np.where(small, two, (roots - 1 - z) / z**2)
        return one - two, two

    def steady(self, z: Fixed, angle: int) -> tuple[complex, complex]:
        """Numerator and denominator of x̂, the steady state x̂ e^(iωt) of x′ = λ x + e^(iωt) / h, λ = z / h, where
        `angle` is ωh over 2^BITS. The denominator is what the force and the mode turn apart in a step."""
        return 1.0, rounded((-z[0], angle - z[1]))

    def step(self, matrices: Matrices, h: float, Q: Array | None, angle: int | None) -> Double:
        """A of the states over their sizes, `scale_of`, to 2⁻⁸⁰ or so.

        Q: of a force, which adds two columns, B₀ and B₁. With an `angle` these are what the real and the imaginary part
        of e^(iωt) add, and two more rows turn these: the step of the states and of the force.
        """
        M, C, K = matrices
        n, scale = len(M), scale_of(M, K)
        lower = solve(Double.of(M), Double.of(-np.concatenate([K, C], axis=1)))
        generator = stacked(Double.of(np.eye(n, 2 * n, n)), lower) * (h * scale) * (1 / scale[:, None])
        if Q is None:
            return expm(generator)
        # the force joins the states: as F and what it grows by in a step, or as the wave
        whole = Double(np.pad(generator.high, (0, 2)), np.pad(generator.low, (0, 2)))
        whole.high[n:-2, -2] = h * np.linalg.solve(M, Q) / scale[n:]
        if angle is None:
            whole.high[-2, -1] = 1.0
        else:
            turn = Double.of(Fraction(angle, ONE)) * QUARTER
            whole.high[-2:, -2:], whole.low[-2:, -2:] = turn.high, turn.low
        step = expm(whole)
        if angle is None:
            step.high[:-2, -2] -= step.high[:-2, -1]
        return step


@dataclass(frozen=True)
class Newmark:
    """Newmark's method with the parameters b and g, see `Exact`. `recurrence`: the kernel's `newmark_step`.

    Average acceleration, (1/4, 1/2), is the trapezoidal rule: its step has the eigenvectors of the differential
    equation.
    """

    recurrence: Callable[..., Any]
    b: float
    g: float

    @property
    def modal(self) -> bool:
        return (self.b, self.g) == (0.25, 0.5)

    def root(self, z: Fixed) -> Fixed:
        a, b = z[0] >> 1, z[1] >> 1
        below = (ONE - a) ** 2 + b * b
        return ((ONE * ONE - a * a - b * b) * ONE) // below, 2 * ONE * ONE * b // below

    def gains(self, z: Complex, roots: Complex) -> tuple[Complex, Complex]:
        half = 0.5 / (1 - z / 2)
        return half, half

    def steady(self, z: Fixed, angle: int) -> tuple[complex, complex]:
        cosine, sine = exponential((0, angle))
        root = self.root(z)
        gain = 0.5 / (1 - rounded(z) / 2)
        return gain * rounded((ONE + cosine, sine)), rounded((cosine - root[0], sine - root[1]))

    def step(self, matrices: Matrices, h: float, Q: Array | None, angle: int | None) -> Double:
        scale = scale_of(matrices[0], matrices[2])
        step: Double = self._advance(matrices, h, np.zeros(len(scale) // 2) if Q is None else Q, Double.of, solve)
        step = step * (1 / scale[:, None])  # powers of two: exact
        A, pushes = step[:, :-2] * scale, step[:, -2:]
        if Q is None:
            return A
        if angle is None:
            return stacked(A, pushes, axis=1)
        # F is the real part of e^(iωt) before the step, F⁺ that after it
        cosine, sine = (Double.of(Fraction(part, ONE)) for part in exponential((0, angle)))
        turn = cosine * np.eye(2) + sine * QUARTER
        pushes = pushes @ stacked(Double.of([[1.0, 0.0]]), turn[:1])
        return stacked(stacked(A, pushes, axis=1), stacked(Double.of(np.zeros((2, len(scale)))), turn, axis=1))

    def _advance(
        self, matrices: Matrices, h: float, Q: Array, number: Callable[[Any], Any], solve: Callable[..., Any]
    ) -> Any:
        """(A, B₀, B₁) of (q, dq), shape (2 n, 2 n + 2): the kernel's recurrence applied to unit states and unit forces,
        in the numbers asked for."""
        n = len(Q)
        unit, force, force_next = np.eye(2 * n, 2 * n + 2), np.zeros((n, 2 * n + 2)), np.zeros((n, 2 * n + 2))
        force[:, -2] = force_next[:, -1] = Q
        M, C, K, q, dq, F, F_next = map(number, (*matrices, unit[:n], unit[n:], force, force_next))
        ddq = solve(M, F - C @ dq - K @ q)
        q, dq, _ = self.recurrence(M, C, K, q, dq, ddq, F_next, number(h), (number(self.b), number(self.g)))
        return stacked(q, dq) if isinstance(q, Double) else np.concatenate([q, dq])

    def errors(self, spectrum: Spectrum, h: float) -> Complex:
        """Refused are roots that grow where the exact ones do not, and steps so long that rounding takes the digits."""
        # The step multiplies K by h² and takes it off again: rounding grows with (ω h)² (measured factor: 1).
        stiffness = float(np.abs(np.linalg.eigvals(np.linalg.solve(spectrum.matrices[0], spectrum.matrices[2]))).max())
        noise = 4 * np.finfo(float).eps * max(stiffness, 1e-300)
        if h > math.sqrt(LOST / noise):
            raise InputError(Message(
                "step = {h:time}: the fastest part, ω = {omega:frequency}, would lose its digits to rounding, which "
                "grows with (ω step)²; choose a step below {limit:time .3g} or fewer modes",
                h=h, omega=math.sqrt(stiffness), limit=math.sqrt(LOST / noise),
            ))  # fmt: skip
        if not self._stable(spectrum, h, noise):
            raise self._refusal(spectrum, h, noise)
        roots = self._roots(spectrum, h)
        if not self.modal:  # of the step's roots that of each λ: nearest to the Rayleigh quotient of its vectors
            quotients = np.diag(spectrum.inverse @ self._floats(spectrum, h) @ spectrum.vectors)
            roots = roots[np.argmin(np.abs(roots - quotients[:, None]), axis=1)]
        with np.errstate(divide="ignore"):  # a root may be zero
            return np.asarray(np.log(roots) / h - spectrum.values)

    def _floats(self, spectrum: Spectrum, h: float) -> Array:
        n = len(spectrum.matrices[0])
        step = self._advance(spectrum.matrices, h, np.zeros(n), np.asarray, np.linalg.solve)
        return np.asarray(step[:, :-2])

    def _roots(self, spectrum: Spectrum, h: float) -> Complex:
        """Eigenvalues of A; not finite where there is no step, or one beyond floats."""
        half = spectrum.values * (h / 2)
        if self.modal and (half != 1).all():
            mapped: Complex = (1 + half) / (1 - half)
            return mapped
        try:
            with np.errstate(all="ignore"):
                return np.linalg.eigvals(self._floats(spectrum, h)).astype(complex)
        except np.linalg.LinAlgError:  # a singular effective matrix, or overflow
            return np.full(half.size, np.nan, dtype=complex)

    def _stable(self, spectrum: Spectrum, h: float, noise: float) -> bool:
        # the rigid part's own decay, β, is one that a step may overshoot where g < 1/2
        antidamped = self.g < 0.5 and not spectrum.matrices[1].any()  # at any step
        if antidamped or (1 - 2 * self.g) * spectrum.decay * h > 2:
            return False
        rates = np.sort(np.maximum(spectrum.values.real, 0))[::-1]
        growth = np.sort(np.log(np.maximum(np.abs(self._roots(spectrum, h)), 1e-300)))[::-1]
        return bool((growth <= FOLLOWED * h * rates + ROUNDING + noise * h**2).all())

    def _refusal(self, spectrum: Spectrum, h: float, noise: float) -> InputError:
        roots, rate = self._roots(spectrum, h), max(0.0, float(spectrum.values.real.max()))
        growth, radius = math.exp(min(700.0, h * rate)), float(np.abs(roots).max())
        limit = _largest(lambda h: self._stable(spectrum, h, noise), h)
        if limit is None:
            cure = "no step is stable with these parameters: choose g ≥ 1/2, such as newmark = (0.25, 0.5)"
        else:
            cure = "the largest stable step is {limit:time}"
            cure += "" if rate > 0 else "; newmark = (0.25, 0.5) has no limit here"
        return InputError(Message(
            f"step = {{h:time}}: beyond the stability limit of newmark = ({self.b:g}, {self.g:g}): a step multiplies a "
            f"part of the response by up to {radius:.6g}, the exact growth is {growth:.6g}; {cure}",
            h=h, limit=limit or 0.0,
        ))  # fmt: skip


Method = Exact | Newmark


def _largest(stable: Callable[[float], bool], h: float) -> float | None:
    """The largest stable step below h, rounded down to six digits, so that it may be used as printed."""
    low = next((h * 0.5**k for k in range(1, 81) if stable(h * 0.5**k)), None)
    if low is None:
        return None
    high = 2 * low
    for _ in range(40):
        middle = (low + high) / 2
        low, high = (middle, high) if stable(middle) else (low, middle)
    unit = math.pow(10.0, 5 - math.floor(math.log10(low)))
    return math.floor(low * unit) / unit
