"""The monodromy matrix of a load that pulsates, P (1 + ε cos Ωt), in balls, and whether its multipliers lie inside.

M q̈ + C(P) q̇ + K(P) q = 0, C and K polynomials in P, is z' = Σ_d c^d B_d z with c = cos Ωt. A period is cut into equal
steps. In a step c^d is a Taylor polynomial and a remainder, |coefficient j| ≤ (dΩ)^j/j!, and so is z: its coefficients
are at most those of u with u' = Σ_d ‖B_d‖ e^(dΩτ) u, which Cauchy's estimate bounds on a disc that is free to choose.

Powers U^k of the monodromy matrix decide. ‖U^k‖ < 1: each multiplier lies inside the unit circle, motion dies out.
|tr U^k| > n, the order of U: one lies outside, and motion grows. And in each case, of the largest multiplier,

    (1/k) ln(|tr U^k|/n) ≤ ln |multiplier| ≤ (1/k) ln ‖U^k‖.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from types import ModuleType
from typing import Literal

import numpy as np
from flint import arb, arb_mat, arb_poly
from numpy.typing import NDArray

from freebeam_derive.certify.balls import Unproven, ball, coefficients, exact, parameters, precision
from freebeam_derive.certify.boundary_polynomials import Question

LEAST_BITS, MOST_BITS = 128, 1024
REACH = 16
"""Norm of a step's exponent. Steps of 8 take a quarter to a half longer, of 32 a fifth to a third less, with seven
digits fewer (Beck, N = 8)."""
LEAST_STEPS, MOST_STEPS = 8, 20_000
"""Steps in a period up to which a proof is tried. A hundred take some six seconds at N = 8."""
SQUARINGS = 48
"""Powers up to 2^48 are looked at: a decay of 1e-13 in a period is seen."""
FURTHER = 20
"""Squarings after the verdict, which narrow the bounds of the growth by a million."""


Real = NDArray[np.float64]
Kind = Literal["stable", "unstable"]


@dataclass(frozen=True)
class Pulsation:
    """The load P (1 + ε cos Ωt), exactly."""

    load: Fraction
    amplitude: Fraction
    frequency: Fraction


@dataclass(frozen=True)
class Verdict:
    """What is proven of the multipliers. growth: lower and upper bound of ln |multiplier| in a period of the largest;
    the lower one None where no power gave one. monodromy: the matrix, in the coordinates of `Motion`."""

    kind: Kind
    growth: tuple[arb | None, arb]
    monodromy: arb_mat
    steps: int
    bits: int


class Motion:
    """z' = Σ_d cos(Ωt)^d B_d z, in balls. `terms`: the matrices B_d, (2n, 2n).

    z = (√ω_j q_j, q̇_j/√ω_j) in the modes of M and K at P = 0, whose floats are taken for exact numbers: multipliers are
    the same in any coordinates, and in these what couples modes is of one size for low and high ones. `damped`: C is
    not zero.
    """

    def __init__(self, M: arb_mat, C: Sequence[arb_mat], K: Sequence[arb_mat], pulsation: Pulsation) -> None:
        modes, root = _coordinates(M, K[0])
        self.pulsation = pulsation
        self.damped = any(x != 0 for part in C for x in part.entries())
        self.n = n = len(root)
        B, inverse = _matrix(modes), (_matrix(modes).transpose() * M * _matrix(modes)).inv()
        up, down = ([arb(float(x)) for x in values] for values in (root, 1 / root))
        zero = [arb(0)] * n
        terms = [arb_mat(2 * n, 2 * n) for _ in range(max(len(C), len(K)))]
        for k in range(len(terms)):
            damping, stiffness = (
                inverse * (B.transpose() * part[k] * B) if k < len(part) else arb_mat(n, n) for part in (C, K)
            )
            rows = [zero + [up[i] / down[i] if i == j and not k else arb(0) for j in range(n)] for i in range(n)]
            rows += [
                [-down[i] * stiffness[i, j] / up[j] for j in range(n)]
                + [-down[i] * damping[i, j] / down[j] for j in range(n)]
                for i in range(n)
            ]
            # P^k (1 + ε c)^k
            for d in range(k + 1):
                share = exact(pulsation.load**k * math.comb(k, d) * pulsation.amplitude**d)
                terms[d] += share * arb_mat(rows)
        self.terms = terms

    @cached_property
    def norms(self) -> list[arb]:
        """‖B_d‖, largest sums of a row."""
        return [_norm(B) for B in self.terms]

    def monodromy(self, bits: int) -> tuple[arb_mat, int]:
        """The matrix over 0 ≤ Ωt ≤ 2π and the number of steps it took. Raises Unproven where these are too many."""
        frequency = exact(self.pulsation.frequency)
        period = 2 * arb.pi() / frequency
        reach = period * sum(self.norms, arb(0))
        if not reach < REACH * MOST_STEPS:
            raise Unproven(
                f"a period takes more than {MOST_STEPS} steps; fewer functions or a higher frequency need fewer"
            )
        steps = max(LEAST_STEPS, math.ceil(_float(reach) / REACH))
        h = period / steps
        rest = self._rest(h, frequency, bits)
        products: list[tuple[int, arb_mat]] = []  # of 1, 2, 4, … steps, so that each factor is a motion over a time
        for k in range(steps):
            phase = 2 * arb.pi() * k / steps
            size, product = 1, self._step(h, frequency, phase, rest)
            while products and products[-1][0] == size:
                product, size = product * products.pop()[1], 2 * size
            products.append((size, product))
        whole = products.pop()[1]
        while products:
            whole = whole * products.pop()[1]
        return whole, steps

    def _rest(self, h: arb, frequency: arb, bits: int) -> tuple[int, int, arb]:
        """Degrees to which the powers of cos and the motion are taken in a step, and a bound of what is left out."""
        tolerance = arb(2) ** -bits
        total = sum(self.norms, arb(0))
        last = len(self.norms) - 1
        x = last * frequency * h
        J = 1
        while not x ** (J + 1) / arb(J + 2).gamma() < tolerance:  # below 1, so that x < (J + 2) / 2
            J += 1
        left = sum(self.norms[1:], arb(0)) * 2 * x ** (J + 1) / arb(J + 2).gamma()
        of_cosine = h * left * ((total + left) * h).exp()
        radii = [h * 2**j for j in range(1, 10)]
        bounds = [(self.norms[0] * r + self._majorant(r, frequency)) for r in radii]
        m = 8
        while True:
            tails = [bound.exp() * (h / r) ** (m + 1) / (1 - h / r) for r, bound in zip(radii, bounds, strict=True)]
            # a disc so large that its bound is no number is never the one
            for tail in tails:
                if tail < tolerance:
                    return J, m, of_cosine + tail
            m += 4

    def _majorant(self, r: arb, frequency: arb) -> arb:
        """∫ Σ_{d>0} ‖B_d‖ e^(dΩτ) dτ from 0 to r."""
        parts = (size * ((d * frequency * r).exp() - 1) / (d * frequency) for d, size in enumerate(self.norms[1:], 1))
        return sum(parts, arb(0))

    def _step(self, h: arb, frequency: arb, phase: arb, rest: tuple[int, int, arb]) -> arb_mat:
        """The propagator over a step h from a phase on."""
        J, m, left = rest
        cosine = _cosine(frequency, phase, J)
        powers = [arb_poly([1])]
        for _ in self.terms[1:]:
            powers.append(arb_poly([(powers[-1] * cosine)[j] for j in range(J + 1)]))
        size = 2 * self.n
        Y = [arb_mat([[arb(int(i == j)) for j in range(size)] for i in range(size)])]  # coefficients times h^k
        total = Y[0]
        weights = [[h**j * p[j] for j in range(J + 1)] for p in powers[1:]]
        for k in range(m):
            change = self.terms[0] * Y[k]
            for B, weight in zip(self.terms[1:], weights, strict=True):
                mixed = weight[0] * Y[k]
                for j in range(1, min(J, k) + 1):
                    mixed += weight[j] * Y[k - j]
                change += B * mixed
            Y.append(change * (h / (k + 1)))
            total += Y[-1]
        return total + arb_mat([[ball(0, left)] * size] * size)


def _cosine(frequency: arb, phase: arb, degree: int) -> arb_poly:
    """Taylor's polynomial of cos(φ + Ωτ) in τ."""
    values = (phase.cos(), -phase.sin(), -phase.cos(), phase.sin())
    factor, found = arb(1), []
    for j in range(degree + 1):
        found.append(values[j % 4] * factor)
        factor *= frequency / (j + 1)
    return arb_poly(found)


def _coordinates(M: arb_mat, K: arb_mat) -> tuple[Real, Real]:
    """Modes of M and K (n, n) and the roots of their frequencies (n,), in floats; a frequency is 1 at least."""
    m, k = (np.array([[_float(x) for x in row] for row in A.tolist()]) for A in (M, K))
    try:
        lower = np.linalg.inv(np.linalg.cholesky((m + m.T) / 2))
    except np.linalg.LinAlgError:
        raise Unproven("the mass matrix is not positive definite") from None
    e, vectors = np.linalg.eigh(lower @ ((k + k.T) / 2) @ lower.T)
    return lower.T @ vectors, np.maximum(np.abs(e), 1.0) ** 0.25


def _matrix(values: Real) -> arb_mat:
    return arb_mat([[arb(x) for x in row] for row in values.tolist()])


def _float(value: arb) -> float:
    return float(value.mid())


def _norm(A: arb_mat) -> arb:
    """The largest sum of a row's sizes: a norm of matrices that no product exceeds."""
    sums = [sum((abs(x) for x in row), arb(0)) for row in A.tolist()]
    largest = sums[0]
    for other in sums[1:]:
        largest = largest.max(other)
    return largest


def decide(U: arb_mat) -> tuple[Kind, tuple[arb | None, arb]] | None:
    """Whether all multipliers lie inside the unit circle or one outside, and bounds of the logarithm of the largest;
    None where no power of U tells, as where they lie on the circle."""
    order, last, k = U.nrows(), SQUARINGS, 0
    kind: Kind | None = None
    lower: list[arb] = []
    upper: list[arb] = []
    while k <= last:
        norm, trace = _norm(U), abs(U.trace())
        if not norm.is_finite():
            break
        if norm > 0:
            upper.append((norm.log() / 2**k).upper())
        if trace > 0:
            lower.append(((trace / order).log() / 2**k).lower())
        if kind is None and (norm < 1 or trace > order):
            kind, last = "stable" if norm < 1 else "unstable", k + FURTHER
        U, k = U * U, k + 1
    return None if kind is None else (kind, (max(lower, default=None), min(upper)))


def prove(kernel: ModuleType, question: Question, pulsation: Pulsation) -> Verdict:
    """The verdict on a column's elastic motion in a Ritz series. Raises Unproven where there is none."""
    bits = LEAST_BITS
    while True:
        with precision(bits):
            moving = motion(kernel, question, pulsation)
            U, steps = moving.monodromy(bits)
            found = decide(U)
        if found is not None:
            return Verdict(*found, U, steps, bits)
        if not moving.damped:
            raise Unproven(
                "no motion that grows is proven, and without damping none can be proven to die out: its multipliers "
                "lie on the unit circle; give alpha or beta"
            )
        if bits >= MOST_BITS:
            raise Unproven("the largest multiplier is too near the unit circle")
        bits *= 2


def motion(kernel: ModuleType, question: Question, pulsation: Pulsation) -> Motion:
    """The motion of a question's column, at the precision in hand. Raises Unproven."""
    dampings = (question.alpha, question.beta)
    M, C, K = coefficients(kernel, question.modes, parameters(kernel, question.own), dampings)
    if len(M) > 1:
        raise Unproven(f"{kernel.COLUMN['name']}: its mass hangs on the load: no proof where that pulsates")
    return Motion(M[0], C, K, pulsation)
