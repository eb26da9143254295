"""A response as a recurrence x⁺ = A x + B₀ F + B₁ F⁺, in coordinates that serve: of the eigenvectors, in which A costs
little to make, or the states over their sizes, which serve every system."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property, lru_cache

import numpy as np

from freebeam_sym.response.digits import BITS, Array, Complex, Fixed, Roots, exponential, fixed, rounded
from freebeam_sym.response.eigen import Spectrum, scale_of
from freebeam_sym.response.inputs import Load
from freebeam_sym.response.methods import Exact, Method
from freebeam_sym.response.propagation import Powers

RESOLVED = 1e-2
"""Radians that a force and a mode turn apart in a response, from which on the steady state is told from the mode."""


@dataclass(frozen=True, eq=False)
class Steps:
    """What a method makes of a spectrum with steps of one length."""

    spectrum: Spectrum
    method: Method
    step: float
    errors: Complex
    """See `Exact.errors`."""

    @property
    def period_errors(self) -> Array:
        """Relative errors of the oscillations' periods, by their frequency."""
        at = self.spectrum.oscillating
        exact = self.spectrum.values[at].imag
        with np.errstate(divide="ignore"):  # a root may be real
            return np.asarray(exact / np.abs(self.errors[at].imag + exact) - 1)

    @cached_property
    def exponents(self) -> list[Fixed] | None:
        """hλ of the eigenvalues λ with Im λ ≥ 0, to more digits, where the step has the eigenvectors of the
        differential equation, there is no rigid motion and these are well conditioned."""
        if not self.method.modal or self.spectrum.rigid_count or self.spectrum.refined is None:
            return None
        h = fixed(self.step)
        return [(a * h >> BITS, b * h >> BITS) for a, b in self.spectrum.refined.exact]

    @cached_property
    def powers(self) -> Powers:
        """Of the step, in the eigenvectors."""
        return Powers(Roots([self.method.root(z) for z in self.exponents or ()]))


@lru_cache(maxsize=64)
def steps_of(spectrum: Spectrum, method: Method, h: float) -> Steps:
    """Steps of length h, kept from earlier calls. Raises InputError where the method has none, see `Exact.errors`."""
    return Steps(spectrum, method, h, method.errors(spectrum, h))


@dataclass(frozen=True, eq=False)
class Recurrence:
    """Coordinates x, (d,), of the states (q, dq), (2 n,), and what is made of them in a step."""

    powers: Powers
    into: Array
    """x = (q, dq) @ into, (2 n, d)."""
    out: Array
    """(q, dq) = out @ x, (2 n, d)."""
    modes: Complex
    """x @ modes, (d, m), are the coordinates of the eigenvectors with Im λ ≥ 0; real parts count."""
    before: Array
    after: Array
    """B₀ and B₁, (d,); zero without a force."""
    steady: Complex | None = None
    """Under a wave, whose real and imaginary part are then two more of x at the end: states (q, dq) that it drives
    apart from what the rest says, a unit of it."""
    unsteady: Complex | None = None
    """What `steady` is off from that of the differential equation; None where there is no steady state."""

    def start(self, states: Array, size: Complex | None) -> Array:
        """x of states (cases, 2 n), at first. size: of a wave, (cases, 1)."""
        if size is None or self.steady is None:
            return states @ self.into
        return np.hstack([(states - (size * self.steady).real) @ self.into, size.real, size.imag])

    def rows(self, row: Array, direct: Array) -> Array:
        """What gives outputs from x that are `row` of (q, dq), (s, 2 n), and `direct` of a force, (s,)."""
        own = row @ self.out
        if self.steady is None:
            return own
        wave = row @ self.steady + direct
        return np.hstack([own, wave.real[:, None], -wave.imag[:, None]])


def recurrence_of(steps: Steps, load: Load, duration: float) -> Recurrence:
    """The recurrence of a system under a load."""
    wave, Q = load.size is not None, load.Q.tobytes() if load.acts else None
    angle = fixed(load.frequency) * fixed(steps.step) >> BITS if wave else None
    found = None if steps.exponents is None else _modal(steps, Q, angle, duration if wave else 0.0)
    return found or _of_states(steps, Q, angle)


def _twice(values: Complex, inverse: Complex) -> Complex:
    """Coordinates of eigenvectors of which the real part stands for the conjugate pair."""
    return inverse * np.where(values.imag > 0, 2.0, 1.0)[:, None]


def _floats(numbers: Complex) -> Array:
    """Complex numbers (…, m) as pairs of floats, (…, 2 m)."""
    return np.ascontiguousarray(numbers).view(np.float64)


@lru_cache(maxsize=16)
def _modal(steps: Steps, Q: bytes | None, angle: int | None, duration: float) -> Recurrence | None:
    """In the eigenvectors; None at resonance."""
    refined, exponents = steps.spectrum.refined, steps.exponents
    assert refined is not None and exponents is not None
    m = len(exponents)
    into = _twice(refined.high, refined.inverse[:m]).T
    found = Recurrence(
        steps.powers, _floats(into), _floats(np.conj(refined.vectors[:, :m])),
        np.kron(np.eye(m), np.array([[1], [1j]])), np.zeros(2 * m), np.zeros(2 * m),
    )  # fmt: skip
    if Q is None:
        return found
    M = steps.spectrum.matrices[0]
    drive = steps.step * np.concatenate([np.zeros(len(M)), np.linalg.solve(M, np.frombuffer(Q))])
    if angle is None:
        z = steps.step * refined.high
        gains = steps.method.gains(z, np.array([rounded(steps.method.root(z)) for z in exponents]))
        before, after = (_floats(drive @ into * gain) for gain in gains)
        return replace(found, before=before, after=after)
    steady = _steady(steps, steps.method, drive, angle, duration)
    if steady is None:
        return None
    true = steady if steps.method == Exact() else _steady(steps, Exact(), drive, angle, duration)
    powers = Powers(Roots([*(steps.method.root(z) for z in exponents), exponential((0, angle))]))
    modes = np.kron(np.eye(m + 1), np.array([[1], [1j]]))
    return replace(
        found, powers=powers, modes=modes, steady=steady, unsteady=steady - (steady if true is None else true)
    )


def _steady(steps: Steps, method: Method, drive: Array, angle: int, duration: float) -> Complex | None:
    """The states x̂ of a steady state x̂ e^(iωt), (2 n,); None at resonance."""
    refined, exponents = steps.spectrum.refined, steps.exponents
    assert refined is not None and exponents is not None
    conjugates = [(a, -b) for (a, b), value in zip(exponents, refined.high, strict=True) if value.imag > 0]
    above, below = np.array([method.steady(z, angle) for z in exponents + conjugates]).T
    if not np.abs(below).min() * duration > RESOLVED * steps.step:
        return None
    found: Complex = refined.vectors @ ((refined.inverse @ drive) * above / below)
    found.flags.writeable = False  # it is kept
    return found


@lru_cache(maxsize=16)
def _of_states(steps: Steps, Q: bytes | None, angle: int | None) -> Recurrence:
    """In the states over their sizes."""
    spectrum, wave = steps.spectrum, angle is not None
    scale = scale_of(spectrum.whole[0], spectrum.whole[2])
    d, before, after = scale.size, np.zeros(scale.size), np.zeros(scale.size)
    step = steps.method.step(spectrum.whole, steps.step, None if Q is None else np.frombuffer(Q), angle)
    if Q is not None and not wave:
        step, before, after = step[:d, :d], step.high[:d, -2].copy(), step.high[:d, -1].copy()
    judged = np.arange(d).reshape(2, -1)[:, spectrum.part].ravel()
    modes = np.zeros((d + 2 * wave, np.count_nonzero(spectrum.half)), dtype=complex)
    modes[judged] = scale[judged, None] * _twice(spectrum.values, spectrum.inverse)[spectrum.half].T
    steady = np.zeros(d, dtype=complex) if wave else None
    return Recurrence(Powers(step), np.diag(1 / scale), np.diag(scale), modes, before, after, steady)
