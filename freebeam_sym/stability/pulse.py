"""A load that pulsates, P (1 + ε cos Ωt): Floquet's multipliers, and the regions of (Ω, ε) in which motion grows.

The motion obeys M(P) q̈ + C(P) q̇ + K(P) q = 0 with P a periodic function of time. Over one period it is multiplied by
the monodromy matrix, whose eigenvalues are the multipliers: it grows where one of them lies outside the unit circle.

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
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import ArrayLike, NDArray

from freebeam_sym.checks import InputError, computable, count, finite, nonnegative, reals, refusal
from freebeam_sym.columns import Column
from freebeam_sym.massless import accelerated, without_mass
from freebeam_sym.question import Question
from freebeam_sym.spectra import coordinates
from freebeam_sym.stability.maps import labels, program
from freebeam_sym.stability.pencil import diagonalise
from freebeam_sym.stability.problem import Complex, Real

if TYPE_CHECKING:
    import xarray

__all__ = ["KINDS", "Pulsating", "PulsatingRegion", "PulsatingRegions", "grid", "monodromy", "pulse"]

KINDS = ("stable", "principal-2T", "principal-T", "combination")
"""What the numbers of `PulsatingRegions.kind` stand for: the multiplier that grows most is below −1 (the motion has
twice the load's period T), above 1 (the load's own period), or one of a complex pair (two frequencies)."""
GROWN = 1e-6
"""Growth in a period, ln |multiplier|, up to which nothing grows: where two multipliers meet on the unit circle, an
error of 1e-12 of the matrix moves them by its root."""
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
MOST_POINTS = 4_000_000
"""Points of a grid up to which is computed."""
BLOCK = 2**21
"""Numbers in an array of matrices that are multiplied at a time."""
CHECKED = 5
"""Frequencies at which the error is measured."""
BISECTIONS = 44
"""Halvings of a distance of two frequencies, to rounding."""


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


# --- growth -------------------------------------------------------------------------------------------------------


class Growth(NamedTuple):
    """Arrays of one shape: growth ln |multiplier| in a period of the multiplier that is largest, that multiplier
    (infinite where it is beyond a float), and the number of its kind in KINDS, int8."""

    growth: Real
    multiplier: Complex
    kind: NDArray[np.int8]


def judged(problem: Pulsating, load: float, frequency: float, amplitudes: Real) -> Growth:
    """How motion grows in a period at a frequency and amplitudes (m,). Raises InputError as `monodromy` does."""
    U, logarithm = monodromy(problem, load, frequency, amplitudes)
    values = np.linalg.eigvals(U).astype(complex)
    largest = values[np.arange(len(values)), np.abs(values).argmax(axis=1)]
    with np.errstate(over="ignore", invalid="ignore"):
        growth = np.log(np.abs(largest)) + logarithm
        real, imag = (
            np.where(part == 0, 0.0, part * np.exp(logarithm)) for part in (largest.real, np.abs(largest.imag))
        )
    multiplier = np.empty(len(largest), dtype=complex)
    multiplier.real, multiplier.imag = real, imag
    # of a pair, the upper; a double real one, which rounding has parted, is real
    alone = np.abs(largest.imag) <= GROWN * np.abs(largest)
    kind = np.where(alone, np.where(largest.real < 0, 1, 2), 3)
    grows = growth > threshold(problem, load, frequency)
    return Growth(growth, multiplier, np.where(grows, kind, 0).astype(np.int8))


def threshold(problem: Pulsating, load: float, frequency: float) -> float:
    """Growth in a period from which on motion is said to grow, for what is known of a multiplier: with damping the two
    that meet have parted by what the damping takes in a period before one of them grows."""
    decay = -float(np.linalg.eigvals(problem.state(load)).real.max()) * 2 * math.pi / frequency
    return max(10 * KNOWN, min(GROWN, KNOWN / decay)) if decay > 0 else GROWN


class PulsatingRegion(NamedTuple):
    """An interval of Ω in which motion grows at one amplitude: its ends, None where it goes beyond the frequencies
    looked at, its kind of KINDS, and the largest growth in a period that was found in it. Nondimensional."""

    low: float | None
    high: float | None
    kind: str
    growth: float


class Centre(NamedTuple):
    """A frequency Ω about which a region lies when ε and damping are small: 2ω_j/k or (ω_i ± ω_j)/k, as `label` says
    in LaTeX; combination: of two modes. k is the order: the width of a region falls as ε^k."""

    frequency: float
    label: str
    combination: bool
    k: int


@dataclass(frozen=True)
class PulsatingRegions:
    """Where the motion of a column grows under the load P (1 + ε cos Ωt), over a grid of Ω and ε. All nondimensional.

    `frequency` (n,) are Ω, `amplitude` (m,) are ε. Arrays (n, m): `growth`, ln |multiplier| in a period T = 2π/Ω of the
    multiplier that is largest; that `multiplier`, complex, Im ≥ 0; `kind`, numbers of KINDS. `error`: by how much a
    monodromy matrix changes, relative to its norm, when its steps are less than half as long; the largest of some
    frequencies at the largest amplitude. `question`: what was asked, at `load` P.

    A region that is narrower than the grid's step may lie between its points. Where the motion grows
    under the constant load P already (`constant_grows`), its flutter is a "combination" too, its divergence a
    "principal-T".
    """

    question: Question
    load: float
    frequency: Real
    amplitude: Real
    growth: Real
    multiplier: Complex
    kind: NDArray[np.int8]
    error: float

    @property
    def rate(self) -> Real:
        """Growth in a unit of time, Ω/2π times that in a period, (n, m)."""
        return self.growth * self.frequency[:, None] / (2 * math.pi)

    @cached_property
    def problem(self) -> Pulsating:
        """What moves, as the integrator sees it."""
        return Pulsating.of(self.question)

    @cached_property
    def eigenvalues(self) -> Complex:
        """λ under the constant load P, (2N,), sorted by |Im λ|."""
        values = np.linalg.eigvals(self.problem.state(self.load)).astype(complex)
        return values[np.lexsort((values.real, np.abs(values.imag)))]

    @property
    def constant_grows(self) -> bool:
        """Whether motion grows under the constant load P already."""
        values = self.eigenvalues
        return bool((values.real > 1e-9 * np.maximum(np.abs(values), 1.0)).any())

    def centres(self) -> tuple[Centre, ...]:
        """Where small regions lie within the frequencies looked at, of k = 1 and 2, ascending."""
        omega = sorted({float(x) for x in self.eigenvalues.imag if x > 0})
        found = [Centre(w, f"$\\omega_{j}$", False, 2) for j, w in enumerate(omega, 1)]
        found += [Centre(2 * w, f"$2\\omega_{j}$", False, 1) for j, w in enumerate(omega, 1)]
        for j, w in enumerate(omega, 1):
            for i, v in enumerate(omega[: j - 1], 1):
                for total, text in ((w + v, f"\\omega_{i}+\\omega_{j}"), (w - v, f"\\omega_{j}-\\omega_{i}")):
                    found += [Centre(total, f"${text}$", True, 1), Centre(total / 2, f"$({text})/2$", True, 2)]
        low, high = self.frequency[0], self.frequency[-1]
        return tuple(sorted(centre for centre in found if low <= centre.frequency <= high))

    def at(self, amplitude: float) -> tuple[PulsatingRegion, ...]:
        """The regions at one amplitude, ascending, their ends found by bisection between the frequencies of the grid.

        Where the column is damped an end is where a multiplier leaves the unit circle; without damping, where growth in
        a period passes 1e-6. Raises InputError for an amplitude below 0.
        """
        eps = np.array([nonnegative("amplitude", amplitude, "share of the load that pulsates")])
        known = np.flatnonzero(self.amplitude == eps)

        def look(frequency: float) -> tuple[int, float]:
            found = judged(self.problem, self.load, frequency, eps)
            return int(found.kind[0]), float(found.growth[0])

        if len(known):
            column = known[0]
            seen = list(zip(self.kind[:, column].tolist(), self.growth[:, column].tolist(), strict=True))
        else:
            seen = [look(w) for w in self.frequency.tolist()]
        regions: list[PulsatingRegion] = []
        low: float | None = None
        first = 0
        for k in range(1, len(seen) + 1):
            if k < len(seen) and seen[k][0] == seen[first][0]:
                continue
            kind = seen[first][0]
            high = None if k == len(seen) else _end(look, kind, *self.frequency[k - 1 : k + 1].tolist())
            if kind:
                regions.append(PulsatingRegion(low, high, KINDS[kind], max(growth for _, growth in seen[first:k])))
            low, first = high, k
        return tuple(regions)

    def table(self) -> dict[str, Any]:
        """The grid by name, (n, m) each: growth, multiplier_real, multiplier_imag, kind."""
        real, imag = self.multiplier.real, self.multiplier.imag
        kind = np.array(KINDS)[self.kind]
        return {"growth": self.growth, "multiplier_real": real, "multiplier_imag": imag, "kind": kind}

    def dataset(self) -> xarray.Dataset:
        """The grid with labels and settings, as `stability_map` has them; `kind` as numbers. Raises InputError without
        xarray (the extra "maps")."""
        question, values = self.question, self.question.values
        flags = {"flag_values": np.arange(len(KINDS), dtype=np.int8), "flag_meanings": " ".join(KINDS)}
        said: dict[str, tuple[str, dict[str, Any]]] = {
            "growth": ("growth in a period, ln |multiplier|", {}),
            "multiplier_real": ("largest multiplier, real part", {}),
            "multiplier_imag": ("largest multiplier, imaginary part", {}),
            "kind": ("kind of the growth", flags),
        }
        columns: dict[str, Any] = self.table() | {"kind": self.kind}
        axes = {"frequency": "frequency of the pulsation", "amplitude": "amplitude of the pulsation"}
        settings = {
            "title": f"Motion of the column {question.column.name} under the load P (1 + amplitude cos(frequency t))",
            **{name: value for name, value in question.record().items() if name != "load_max"},
            "column_title": question.column.title,
            "load": self.load,
            **values,
            "error": self.error,
            "fixed": " ".join(values),
            "units": "nondimensional, Eq. (5)",
            "source": f"freebeam {program()}",
        }
        held = {
            x: (list(axes), columns[x], {"long_name": text, "units": "1", **more}) for x, (text, more) in said.items()
        }
        coordinates = {x: (x, getattr(self, x), {"long_name": text, "units": "1"}) for x, text in axes.items()}
        labelled: xarray.Dataset = labels().Dataset(held, coordinates, settings)
        return labelled


def _end(look: Callable[[float], tuple[int, float]], kind: int, low: float, high: float) -> float:
    """Where a kind that is found at `low` ends before `high`, by bisection."""
    for _ in range(BISECTIONS):
        middle = (low + high) / 2
        if not low < middle < high:
            break
        if look(middle)[0] == kind:
            low = middle
        else:
            high = middle
    return (low + high) / 2


def pulse(
    column: Column,
    modes: int | None = None,
    alpha: float = 0.0,
    beta: float = 0.0,
    *,
    load: float,
    frequency: ArrayLike,
    amplitude: ArrayLike,
    step: Callable[[float], None] | None = None,
    **parameters: float,
) -> PulsatingRegions:
    """Where the motion of `column` grows under a load P (1 + ε cos Ωt), P = `load`, over a grid of Ω and ε.

    frequency: Ω, one number or ascending ones (n,), greater than 0; amplitude: ε, one or ascending ones (m,), 0 or
    greater; everything is nondimensional. Above ε = 1 the load changes its sign. The rest as in `critical_load`.
    `step` is told which part of the work is done, 0 to 1.

    >>> import freebeam as fb
    >>> column = fb.column("euler-pinned")
    >>> found = fb.pulse(column, beta=0.1, load=3, frequency=[15, 16.5, 18], amplitude=[0, 0.3])
    >>> found.kind.tolist()  # about twice the first frequency, 16.46
    [[0, 0], [0, 1], [0, 0]]

    Raises InputError for bad values, for load 0, which does not pulsate, for a frequency so low that its period takes
    too many steps, and where the column is not stable without load.
    """
    question = Question.of(column, modes, alpha, beta, **parameters)
    return grid(question, load, frequency, amplitude, step)


def grid(
    question: Question,
    load: float,
    frequency: ArrayLike,
    amplitude: ArrayLike,
    step: Callable[[float], None] | None = None,
) -> PulsatingRegions:
    """The regions of a question; all else as in `pulse`."""
    load = computable("load", finite("load", load, "nondimensional load P"))
    if not load:
        raise refusal("load", load, "must differ from 0: the amplitude is a share of it")
    Omega, eps = _axis("frequency", frequency, "of the pulsation"), _axis("amplitude", amplitude, "share of the load")
    if not Omega[0] > 0:
        raise refusal("frequency", float(Omega[0]), "must be greater than zero", "Ω of the load P (1 + ε cos Ωt)")
    if eps[0] < 0:
        raise refusal("amplitude", float(eps[0]), "must be zero or greater", "ε of the load P (1 + ε cos Ωt)")
    count("points of the grid", len(Omega) * len(eps), 1, MOST_POINTS)
    problem = Pulsating.of(question)
    rows = []
    for k, w in enumerate(Omega.tolist(), 1):
        rows.append(judged(problem, load, w, eps))
        if step is not None:
            step(k / len(Omega))
    growth, multiplier, kind = (np.array(part) for part in zip(*rows, strict=True))
    return PulsatingRegions(
        question, load, Omega, eps, growth, multiplier, kind, _error(problem, load, Omega, eps[-1:])
    )


def _axis(name: str, values: ArrayLike, hint: str) -> Real:
    """Ascending values, (n,), one or more. Raises InputError."""
    found = np.atleast_1d(reals(name, values, hint))
    if found.ndim != 1 or not len(found) or (np.diff(found) <= 0).any():
        raise InputError(f"{name}: must be one number, or numbers that ascend, in a sequence of shape (n,) ({hint})")
    computable(name, float(np.abs(found).max()))
    return found


def _error(problem: Pulsating, load: float, frequencies: Real, amplitude: Real) -> float:
    """Largest change of a monodromy matrix with steps of less than half the size, relative to its norm."""
    places = np.unique(np.linspace(0, len(frequencies) - 1, CHECKED).round().astype(int))
    changes = []
    for w in frequencies[places].tolist():
        (U, size), (V, other) = (monodromy(problem, load, w, amplitude, finer) for finer in (False, True))
        changes.append(float(np.linalg.norm(U - V * np.exp(other - size)[:, None, None], axis=(1, 2)).max()))
    return max(changes)
