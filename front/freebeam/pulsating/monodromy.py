"""The monodromy matrix of a load that pulsates, P (1 + ε cos Ωt).

The motion obeys M(P) q̈ + C(P) q̇ + K(P) q = 0 with P a periodic function of time. Over one period it is multiplied by
the monodromy matrix.

The highest functions of a series oscillate thousands of times in a period of the load. No step need follow them: the
propagator over a short step is a smooth function of the phase Ωt at which the step begins, however fast the motion
inside it is. It is known from its values at a few phases, by trigonometric interpolation. The step is doubled, from
one so short that a series of Magnus is exact to rounding,

    U_2h(φ) = U_h(φ + Ωh) U_h(φ),

until it is the distance of two of these phases; then the period is the product of the propagators of all phases.
What grows is held as the difference from the constant load's propagator exp(A h), so that little is rounded away.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import NDArray

from freebeam_sym.checks import InputError
from freebeam_sym.massless import accelerated, without_mass
from freebeam_sym.question import Question
from freebeam_sym.spectra import coordinates
from freebeam_sym.stability.pencil import diagonalise
from freebeam_sym.stability.problem import Complex, Real

__all__ = ["KNOWN", "Pulsating", "monodromy"]

KNOWN = 1e-12
"""Error of a monodromy matrix, relative to its norm, that the settings below are made for; `error` measures it."""
START = 1 / 32
"""Norm of the first step's exponent. Tuned on Mathieu's equation at Ω = 2ω, where the load changes most in a step: the
error of order 6 is then below 1e-12 in a period of a tenth of that frequency."""
STRONGEST = 8
"""Norm of what the load changes times the step, up to which terms of a step that cancel cost no digits that count."""
MOST_PHASES = 2001
"""Phases in a period up to which is computed."""
MOST_KICK, MOST_TURNS = STRONGEST * MOST_PHASES, 1e9
"""Norms, times the period, of what the load changes and of the whole up to which is computed: of so many turns 7 digits
are left in the fastest motion."""
BLOCK = 2**21
"""Numbers in an array of matrices that are multiplied at a time."""


class Pulsating:
    """M(P) q̈ + C(P) q̇ + K(P) q = 0, the matrices polynomials in P: each a sequence of coefficients (n, n) by powers of
    P. The symmetric part of M at P = 0 must be positive definite; nothing else need be symmetric.

    The state is (√ω_j q_j, q̇_j/√ω_j) in the modes of the symmetric parts without load, ω_j their frequencies, 1 at
    least: what couples modes is then of one size for low and high ones. `omega` (n,).
    """

    def __init__(self, M: Sequence[Real], C: Sequence[Real], K: Sequence[Real]) -> None:
        e, B, diagonal = _modes(M[0], K[0])
        self.omega: Real = np.sqrt(np.maximum(np.abs(e), 1.0))
        self._M, self._C, self._K = (np.array([B.T @ X @ B for X in part]) for part in (M, C, K))
        if diagonal:  # what rounding leaves beside the diagonal is as large as the least squared frequency
            self._M[0], self._K[0] = np.eye(len(e)), np.diag(e)
        if len(M) == 1:
            self._C, self._K = (np.linalg.solve(self._M, X) for X in (self._C, self._K))
            self._M = np.eye(len(e))[None]

    @staticmethod
    def of(question: Question) -> Pulsating:
        """The elastic motion of a question's column."""
        if question.column.general:
            M, C, K = question.column.coefficients(
                question.modes, False, question.alpha, question.beta, **question.parameters
            )
            C = C or (np.zeros_like(M[0]),)
            return Pulsating(*((M, C, K) if not without_mass(M[0]) else _with_accelerations(M, C, K)))
        pencil, (c_E, c_M, _) = question.pencil, question.factors
        unit, E = np.eye(pencil.size), np.diag(pencil.e)
        return Pulsating((unit,), (c_M * unit + c_E * E,), (E, pencil.H))

    def state(self, load: float) -> Real:
        """A of z' = A z at a constant load, (2n, 2n)."""
        M, C, K = (_value(X, np.array(load)) for X in (self._M, self._C, self._K))
        return self._matrix(np.linalg.solve(M, C), np.linalg.solve(M, K), self.omega)

    def change(self, load: float, loads: Real) -> Real:
        """A at other loads less A at a load, (..., 2n, 2n), with no difference taken of what is alike."""
        powers = np.array([loads**k - load**k for k in range(max(len(X) for X in (self._M, self._C, self._K)))])
        dM, dC, dK = (np.tensordot(powers[: len(X)], X, (0, 0)) for X in (self._M, self._C, self._K))
        if len(self._M) > 1:
            M = _value(self._M, np.array(load))
            C, K = (np.linalg.solve(M, _value(X, np.array(load))) for X in (self._C, self._K))
            dC, dK = (np.linalg.solve(M + dM, d - dM @ X) for d, X in ((dC, C), (dK, K)))
        return self._matrix(dC, dK, np.zeros(len(self.omega)))

    def _matrix(self, C: NDArray[Any], K: NDArray[Any], upper: Real) -> Real:
        """[[0, upper], [−K, −C]] in the scaled state."""
        n, root = len(self.omega), np.sqrt(self.omega)
        A = np.zeros((*K.shape[:-2], 2 * n, 2 * n))
        A[..., :n, n:] = np.diag(upper)
        A[..., n:, :n] = -K / np.outer(root, root)
        A[..., n:, n:] = -C * np.outer(1 / root, root)
        return A


def _with_accelerations(*terms: Sequence[Real]) -> tuple[Sequence[Real], Sequence[Real], Sequence[Real]]:
    """M, C, K by powers of the load, M singular: of a system with M = I that moves alike, with small multipliers more.

    Raises InputError where the load acts on what has no mass.
    """
    _, B = coordinates(terms[0][0], terms[2][0])
    (M, *more), C, K = ([B.T @ X @ B for X in part] for part in terms)
    found = accelerated(M, C[0], K[0])
    loaded = [*more, *C[1:], *K[1:]]
    if more or any(np.abs(found.idle @ X).max() > 1e-12 * np.abs(X).max() for X in loaded):
        raise InputError("a load that pulsates must not act on a coordinate without mass")
    return (np.eye(len(M)),), (found.C, *(found.rows @ X for X in C[1:])), (found.K, *(found.rows @ X for X in K[1:]))


def _modes(M: Real, K: Real) -> tuple[Real, Real, bool]:
    """Squared frequencies (n,) and modes (n, n) of the symmetric parts of M and K, and whether the modes make M and K
    themselves diagonal. Raises InputError where M's is not positive definite."""
    symmetric = all(np.abs(X - X.T).max() <= 1e-14 * np.abs(X).max() for X in (M, K))
    if symmetric:
        try:
            return *diagonalise(M, K), True
        except InputError:  # K is not positive definite
            pass
    from scipy.linalg import LinAlgError, eigh

    try:
        e, B = eigh((K + K.T) / 2, (M + M.T) / 2)
    except LinAlgError:
        raise InputError("M is not positive definite without load: some motion has no mass") from None
    return e, B, False


def _value(coefficients: Real, loads: Real) -> Real:
    """A polynomial's matrix at loads (...,)."""
    powers = np.array([loads**k for k in range(len(coefficients))])
    return np.asarray(np.tensordot(powers, coefficients, (0, 0)))


# --- one period ---------------------------------------------------------------------------------------------------


def monodromy(
    problem: Pulsating, load: float, frequency: float, amplitudes: Real, finer: bool = False
) -> tuple[Real, Real]:
    """Monodromy matrices over 0 ≤ Ωt ≤ 2π at load (1 + ε cos Ωt) and amplitudes ε (m,), in the problem's state.

    They come as matrices (m, 2n, 2n) and logarithms (m,): each is its matrix times the exponential of its logarithm,
    which keeps what grows for long within a float's range. finer: with steps of less than half the size, to see what
    they hang on. Raises InputError where the period is too long.
    """
    period = _Period.of(problem, load, frequency, float(np.abs(amplitudes).max()), finer)
    while True:
        X, weights = _steps(period, amplitudes)
        if _last(np.fft.rfft(X, axis=0, norm="forward"), 0) < KNOWN / 10:  # its highest harmonics
            break
        period = period.cut(2 * period.phases + 1)
    F = period.constant(period.step)
    U, logarithm = np.broadcast_to(np.eye(len(F)), (len(amplitudes), *F.shape)), np.zeros(len(amplitudes))
    for step in X:
        U = (F + np.tensordot(weights, step, (1, 0))) @ U
        size = np.linalg.norm(U, axis=(1, 2))
        if not (np.isfinite(size) & (size > 0)).all():
            raise period.too_much
        U, logarithm = U / size[:, None, None], logarithm + np.log(size)
    return U, logarithm


class _Period(NamedTuple):
    """A period of the load, cut at an odd number of phases: all that a step hangs on but the amplitude.

    A: the state matrix of the constant load. kick: the norm of what the load changes, times the period. finer: for a
    first step of half the size, and twice as many phases.
    """

    problem: Pulsating
    load: float
    frequency: float
    A: Real
    kick: float
    finer: bool
    phases: int = 0

    @staticmethod
    def of(problem: Pulsating, load: float, frequency: float, amplitude: float, finer: bool) -> _Period:
        """The period of so large an amplitude. Raises InputError."""
        A, T = problem.state(load), 2 * math.pi / frequency
        change = problem.change(load, load * (1 + amplitude * np.array([-1.0, 1.0])))
        kick, turns = (float(np.linalg.norm(X, 2, (-2, -1)).max()) * T for X in (change, A))
        period = _Period(problem, load, frequency, A, kick, finer)
        if not max(kick / MOST_KICK, turns / MOST_TURNS) < 1:
            raise period.too_much
        growth = abs(float(np.linalg.eigvals(A).real.max())) * T
        phases = _phases(kick, growth)
        return period.cut(2 * phases + 1 if finer else phases)

    def cut(self, phases: int) -> _Period:
        """The same with so many phases. Raises InputError where they are too many."""
        if phases > (2 * MOST_PHASES + 1 if self.finer else MOST_PHASES):
            raise self.too_much
        return self._replace(phases=phases)

    @property
    def step(self) -> float:
        """From phase to phase, in time."""
        return 2 * math.pi / self.frequency / self.phases

    def constant(self, h: float) -> Real:
        """The propagator of the constant load, exp(A h)."""
        from scipy.linalg import expm

        return np.asarray(expm(self.A * h))

    @property
    def too_much(self) -> InputError:
        return InputError(
            f"frequency = {self.frequency:g}, load = {self.load:g}: too much happens in a period to be computed; take "
            "a higher frequency, a smaller load or amplitude, or fewer modes"
        )


def _phases(kick: float, growth: float) -> int:
    """An odd number of phases, so that the propagator's harmonics that they cannot tell are below rounding, and what
    grows most in a step, or decays least, does so by e^±100 at most. kick: the norm of what the load changes times the
    period; harmonic r of a step is (kick/2/phases)^r/r! at most. growth: its size in a period of the constant load."""
    r = 4
    while r * math.log(max(kick, 1e-300) / (4 * r + 2)) - math.lgamma(r + 1) > math.log(KNOWN / 1e3):
        r += max(1, r // 8)
    return 2 * max(r, math.ceil(kick / 2 / STRONGEST), math.ceil(growth / 200)) + 1


def _steps(period: _Period, amplitudes: Real) -> tuple[Real, Real]:
    """Propagators from each phase to the next, less that of the constant load: matrices (phases, k, 2n, 2n), and the
    weights (m, k) with which those at m amplitudes follow. Many amplitudes are made of Chebyshev's polynomials in ε, in
    which a step is a series that ends. Raises InputError where a matrix is beyond a float."""
    degree, kick = 2, max(period.kick / period.phases, 1e-300)
    while degree * math.log(kick) - math.lgamma(degree + 1) > math.log(KNOWN / 1e4):
        degree += 1
    low, high = float(amplitudes.min()), float(amplitudes.max())
    while True:
        direct = len(amplitudes) <= degree + 1
        points = chebyshev.chebpts1(degree + 1)
        nodes = amplitudes if direct else low + (points + 1) * (high - low) / 2
        parts = np.array_split(nodes, min(len(nodes), math.ceil(period.phases * len(nodes) * period.A.size / BLOCK)))
        with np.errstate(all="ignore"):
            X = np.concatenate([_doubled(period, part) for part in parts], axis=1)
        if not np.isfinite(X).all():
            raise period.too_much
        if direct:
            return X, np.eye(len(amplitudes))
        X = np.moveaxis(np.tensordot(np.linalg.inv(chebyshev.chebvander(points, degree)), X, (1, 1)), 0, 1)
        if _last(X, 1) < KNOWN / 10:
            return X, np.asarray(chebyshev.chebvander((2 * amplitudes - low - high) / (high - low), degree))
        degree *= 2


def _doubled(period: _Period, amplitudes: Real) -> Real:
    """`_steps` at amplitudes (k,), by doubling of a first step."""
    phases, h = period.phases, period.step
    largest = h * float(np.linalg.norm(period.A, 2)) + period.kick / phases
    doublings = max(0, math.ceil(math.log2(largest / START))) + period.finer
    h /= 2**doublings
    places = np.arange(phases)
    angles = 2 * math.pi * places / phases
    X = _first_step(period, amplitudes, angles, h)
    orders = np.arange(1, phases // 2 + 1)[:, None]
    for _ in range(doublings):
        F = period.constant(h)
        # trigonometric interpolation at φ + Ωh
        weights = (1 + 2 * np.cos(orders * (angles + period.frequency * h)).sum(axis=0)) / phases
        later = np.tensordot(weights[(places[:, None] - places) % phases], X, (1, 0))
        X = F @ X + later @ F + later @ X
        h *= 2
    return X


def _first_step(period: _Period, amplitudes: Real, angles: Real, h: float) -> Real:
    """exp(Σ) − exp(A h), Σ the Magnus series of order 6 on Gauss's three places (Blanes, Casas and Ros, 2002)."""
    places = h * (0.5 + math.sqrt(15) / 10 * np.array([-1.0, 0.0, 1.0]))
    pulses = np.cos(angles[:, None] + period.frequency * places[:, None, None])  # (3, phases, 1)
    one, two, three = h * period.problem.change(period.load, period.load * (1 + pulses * amplitudes))
    constant = h * period.A
    first = constant + two
    second, third = math.sqrt(15) / 3 * (three - one), 10 / 3 * (three - 2 * two + one)
    c = _commutator(first, second)
    d = -_commutator(first, 2 * third + c) / 60
    departure = two + third / 12 + _commutator(-20 * first - third + c, second + d) / 240
    exponent = constant + departure
    power, term, total = constant, departure, departure
    for k in range(2, 11):  # (1/32)^10/10! is below rounding of the first
        term = (exponent @ term + departure @ power) / k
        power = power @ constant / k
        total = total + term
    return np.asarray(total)


def _commutator(X: Real, Y: Real) -> Real:
    return np.asarray(X @ Y - Y @ X)


def _last(series: Real | Complex, axis: int) -> float:
    """Size of the last two of the coefficients along an axis, beside the largest of all, or 1, that of a propagator."""
    sizes = np.abs(np.moveaxis(series, axis, 0)).reshape(series.shape[axis], -1).max(axis=1)
    return float(sizes[-2:].max() / max(1.0, sizes.max()))
