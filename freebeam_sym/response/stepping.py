"""One step of Newmark's method as a matrix: what it is to the last digit, where it is stable, what its period error is.

The recurrence is the emitted `newmark_step`. It is linear, so applied to unit states it gives the step's matrix.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property, lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from freebeam_sym.checks import InputError
from freebeam_sym.response.double import Double, add, scaled, solve
from freebeam_sym.response.modal import Modes, modes_of, trapezoidal
from freebeam_sym.response.powers import ModalPowers

if TYPE_CHECKING:
    from freebeam_sym.columns import System

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

# Rounding of log |ρ|: a double root, as at the stability limit of an undamped mode, has half the digits.
ROUNDING = 1e-8
# Growth that is real may come out larger by this factor: the method's error, not an instability.
FOLLOWED = 1.1


def acceleration(M: Array, C: Array, K: Array, Q: Array) -> tuple[Array, Array]:
    """ddq = a (q, dq) + f F₀, the equation of motion (10) solved: a of shape (n, 2n), f of shape (n,)."""
    n = len(M)
    solved = np.linalg.solve(M, np.concatenate([-K, -C, Q[:, None]], axis=1))
    return solved[:, : 2 * n], solved[:, 2 * n]


@dataclass(frozen=True, eq=False)
class Spectrum:
    """The exact eigenvalues (2 n,) of the part that is judged, their vectors, what Newmark's method makes of them."""

    matrices: tuple[Array, Array, Array]
    """M, C, K of that part."""
    step: float
    values: Complex
    vectors: Complex
    frequencies: Array
    period_errors: Array

    @cached_property
    def modes(self) -> Modes | None:
        """Eigenvalues and vectors to more digits, where they are well conditioned."""
        M, C, K = self.matrices
        return modes_of(M, C, K, self.values, self.vectors, scale_of(M, K))

    @cached_property
    def powers(self) -> ModalPowers | None:
        """Powers of what average acceleration makes of them in a step."""
        return None if self.modes is None else ModalPowers(trapezoidal(self.modes, self.step))


def step_matrix(
    recurrence: Callable[..., Any],
    M: Array,
    C: Array,
    K: Array,
    Q: Array,
    h: float,
    newmark: tuple[float, float],
) -> tuple[Array, Array, Array]:
    """A, B₀, B₁ of one step of (q, dq): the recurrence applied to unit states and unit forces."""
    n = len(M)
    state, force = acceleration(M, C, K, Q)
    unit = np.zeros((2 * n, 2 * n + 2))
    unit[:, :-2] = np.eye(2 * n)
    ddq = np.hstack([state, force[:, None], np.zeros((n, 1))])
    F = np.zeros((n, 2 * n + 2))
    F[:, -1] = Q
    q, dq, _ = recurrence(M, C, K, unit[:n], unit[n:], ddq, F, h, newmark)
    step = np.vstack([q, dq])
    return step[:, :-2], step[:, -2], step[:, -1]


def exact_step(M: Array, C: Array, K: Array, h: float, newmark: tuple[float, float], A: Array, scale: Array) -> Double:
    """The step's matrix A to 2⁻⁸⁰ or so, of the state (q, dq) / scale, from A in floats.

    It satisfies both of Newmark's formulas with ddq from Eq. (10), each multiplied by M.
    """
    H, b, g = (Fraction(value) for value in (h, *newmark))
    half = Fraction(1, 2) - b

    def combined(*terms: tuple[Fraction | int, Array]) -> Double:
        parts = [scaled(Fraction(factor), matrix) for factor, matrix in terms]
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
    return solve(left, right, A * scale / scale[:, None])


def scale_of(M: Array, K: Array) -> Array:
    """Sizes of q and dq, powers of two, (2 n,), with which the entries of a step's matrix are of one order."""
    stiffness, mass = np.abs(np.diag(K)), np.diag(M)
    rates = np.sqrt(np.where(stiffness > 0, stiffness, mass) / mass)
    return np.concatenate([np.ones(len(M)), np.exp2(np.round(np.log2(rates)))])


def _coupled(M: Array, C: Array, K: Array, r: int) -> bool:
    """Whether the r rigid functions take part in the elastic spectrum; those of the free beam do not."""
    small = 1e-9 * np.abs(K[r:]).max(axis=1, keepdims=True)
    if (np.abs(K[r:, :r]) > small).any() or (np.abs(C[r:, :r]) > small).any():
        return True
    own = np.linalg.solve(M[:r, :r], K[:r, :r])
    return bool(np.abs(np.linalg.eigvals(own)).max() > 1e-6 * max(np.abs(own).max(), 1e-300))


def checked_step(system: System, h: float, newmark: tuple[float, float]) -> Spectrum:
    """The exact spectrum and Newmark's period errors; InputError where roots grow that should not.

    Rigid functions of a free beam make λ = 0 defective, of a size that rounding decides: the elastic part
    is judged. Kept from earlier calls, by value.
    """
    matrices = (np.asarray(part, dtype=float).tobytes() for part in (system.M, system.C, system.K))
    return _judged(system.column.kernel.newmark_step, len(system.M), system.rigid_count, *matrices, h, newmark)


@lru_cache(maxsize=64)
def _judged(
    recurrence: Callable[..., Any],
    size: int,
    r: int,
    mass: bytes,
    damping: bytes,
    elasticity: bytes,
    h: float,
    newmark: tuple[float, float],
) -> Spectrum:
    whole = [np.frombuffer(part).reshape(size, size) for part in (mass, damping, elasticity)]
    part = slice(0 if r and _coupled(whole[0], whole[1], whole[2], r) else r, None)
    M, C, K = (matrix[part, part] for matrix in whole)
    n = len(M)
    Q = np.zeros(n)
    generator = np.zeros((2 * n, 2 * n))
    generator[:n, n:] = np.eye(n)
    generator[n:] = acceleration(M, C, K, Q)[0]
    exact, vectors = (found.astype(complex) for found in np.linalg.eig(generator))
    rates = np.sort(np.maximum(exact.real, 0))[::-1]
    fastest = 0.0  # the rigid part's own decay, β, which a step may overshoot where g < 1/2
    if part.start:
        fastest = float(np.abs(np.linalg.eigvals(np.linalg.solve(whole[0][:r, :r], whole[1][:r, :r]))).max())
    b, g = newmark
    hopeless = g < 0.5 and not C.any()  # damping of the wrong sign at any step

    def roots(h: float) -> Complex | None:
        half = exact * (h / 2)
        if (b, g) == (0.25, 0.5) and (half != 1).all():  # average acceleration is the trapezoidal rule
            mapped: Complex = (1 + half) / (1 - half)
            return mapped
        try:
            with np.errstate(all="ignore"):
                found = np.linalg.eigvals(step_matrix(recurrence, M, C, K, Q, h, newmark)[0])
        except np.linalg.LinAlgError:  # a singular effective matrix, or overflow
            return None
        return found.astype(complex)

    # The step multiplies K by h² and takes it off again: rounding grows with (ω h)² (measured factor: 1).
    stiffness = np.abs(np.linalg.eigvals(generator[n:, :n])).max()
    noise = 4 * np.finfo(float).eps * max(float(stiffness), 1e-300)
    if h > math.sqrt(1e-5 / noise):
        raise InputError(
            f"step = {h:g}: the fastest part, ω = {math.sqrt(stiffness):.6g}, would lose its digits to "
            f"rounding, which grows with (ω step)²; choose a step below {math.sqrt(1e-5 / noise):.3g} or "
            "fewer modes"
        )

    def stable(h: float, found: Complex | None) -> bool:
        if found is None or not np.isfinite(found).all() or (1 - 2 * g) * fastest * h > 2:
            return False
        growth = np.sort(np.log(np.maximum(np.abs(found), 1e-300)))[::-1]
        return bool((growth <= FOLLOWED * h * rates + ROUNDING + noise * h**2).all())

    found = roots(h)
    if hopeless or not stable(h, found):
        growth = math.exp(min(700.0, h * rates[0]))
        radius = math.nan if found is None else float(np.abs(found).max())
        raise InputError(
            f"step = {h:g}: beyond the stability limit of newmark = ({b:g}, {g:g}): a step multiplies a "
            f"part of the response by up to {radius:.6g}, the exact growth is {growth:.6g}; "
            + _cure(None if hopeless else _largest(lambda h: stable(h, roots(h)), h), rates[0] > 0)
        )
    oscillating = exact[exact.imag > 0]
    oscillating = oscillating[np.argsort(oscillating.imag)]
    assert found is not None  # stable
    errors = _period_errors(recurrence, oscillating, found, h, newmark)
    frequencies = oscillating.imag.copy()
    for array in (frequencies, errors):  # they are shared by responses
        array.flags.writeable = False
    return Spectrum((M, C, K), h, exact, vectors, frequencies, errors)


def _cure(largest: float | None, growing: bool) -> str:
    if largest is None:
        return "no step is stable with these parameters: choose g ≥ 1/2, such as newmark = (0.25, 0.5)"
    digits = 5 - math.floor(math.log10(largest))
    # rounded down, so that it may be used as printed
    shown = math.floor(largest * 10.0**digits) / 10.0**digits
    cure = f"the largest stable step is {shown:.6g}"
    return cure if growing else cure + "; newmark = (0.25, 0.5) has no limit here"


def _largest(stable: Callable[[float], bool], h: float) -> float | None:
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
    return low


def _period_errors(
    recurrence: Callable[..., Any],
    exact: Complex,
    roots: Complex,
    h: float,
    newmark: tuple[float, float],
) -> Array:
    """Numerical period / exact period − 1 of each λ.

    Its root of the step is the one nearest to where the method takes a single oscillator of that λ, which
    is the root itself where the system decouples.
    """
    if not exact.size:
        return np.empty(0)
    if newmark == (0.25, 0.5):  # the trapezoidal rule
        turned: Array = exact.imag * h / np.angle((1 + exact * (h / 2)) / (1 - exact * (h / 2))) - 1
        return turned
    one = np.ones((exact.size, 1, 1))
    M, C, K = one, -2 * exact.real[:, None, None], (np.abs(exact) ** 2)[:, None, None]
    q, dq = one * [1.0, 0.0], one * [0.0, 1.0]
    q, dq, _ = recurrence(M, C, K, q, dq, -K * q - C * dq, 0 * q, h, newmark)
    single = np.linalg.eigvals(np.concatenate([q, dq], axis=1))
    single = single[np.arange(exact.size), np.argmax(single.imag, axis=1)]
    nearest = roots[np.argmin(np.abs(roots - single[:, None]), axis=1)]
    with np.errstate(divide="ignore"):
        errors: Array = exact.imag * h / np.abs(np.angle(nearest)) - 1
    return errors


def overflow(t: float, exact: Complex) -> InputError:
    worst = exact[np.argmax(exact.real)]
    if worst.real * t < 1:
        return InputError(
            f"the response passes the range of floats at t = {t:.6g}: the force or the initial state is too large"
        )
    kind = "flutter" if worst.imag else "divergence"
    return InputError(
        f"the response passes the range of floats at t = {t:.6g}: {kind} grows as exp({worst.real:.6g} "
        "t); choose a shorter duration or a load below the critical one"
    )
