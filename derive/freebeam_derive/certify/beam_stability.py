"""That a crossing of the beam itself is the first, and that the column is stable below it. Eqs. (6), (14), (15).

`strips`, or `frequency_gaps`, leaves finitely many eigenvalues to look at: the m lowest. Without damping they are shown
to be real, positive and simple on [0, P*) by changes of sign of F(P, s); at the crossing the point between the two that
meet moves with the load. With damping F(P, iω) is shown to have no other zero on a rectangle of loads and frequencies,
outside of which the strips leave none. docs/theorem.md has the statements and their proofs.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import pairwise, product
from typing import Any

import numpy as np
from flint import acb, arb

from freebeam_derive.certify import energy
from freebeam_derive.certify.balls import Exact, Range, Unproven, exact, least, precision, rational
from freebeam_derive.certify.beam import Beam
from freebeam_derive.certify.beam_cells import Cells, OpenStep
from freebeam_derive.certify.beam_itself import (
    Damped,
    ExactCrossing,
    Itself,
    Onset,
    Proof,
    VanishingDamping,
    VanishingRates,
)
from freebeam_derive.certify.complete_spectrum import counted_to
from freebeam_derive.certify.damped_gaps import damped_gaps
from freebeam_derive.certify.exact_system import ExactSystem
from freebeam_derive.certify.frequency_gaps import FrequencyGaps
from freebeam_derive.certify.local_series import Local
from freebeam_derive.certify.strips import NoStrips, Strips

BITS = 128
BITS_OF_ANY = 64  # where F comes from Taylor steps, which cost more; but in a limit series up to the rate need BITS
COUNTS = (40, 60, 120, 200)  # modes in balls; with internal damping from the second on, which leaves a smaller m
DEEPEST = 40  # bisections before a proof is given up
MOST_TRIES = 400  # of stretches, with their signs: some minutes where F comes from Taylor steps
TERMS = 6  # of Taylor's series in the load, over a stretch


@dataclass(frozen=True)
class Stretch:
    """Loads over which the m lowest eigenvalues are apart: F changes sign from each separator to the next.

    start, end: loads. separators: s = point + slope (P − origin), ascending, the first 0, the last the line R_m.
    moving: the index of the one through the crossing, None on other stretches.
    """

    start: Fraction
    end: Fraction
    separators: tuple[Fraction, ...]
    moving: tuple[int, Fraction] | None = None


@dataclass(frozen=True)
class Evidence:
    """What a proof of `first` and `stable_below` stands on.

    lowest: m. modes: how many are in balls (beyond the uniform beam: how many frequencies without load). reach: a load
    up to which all lines from m on are free of eigenvalues.
    stretches: of the sign changes; cells: how many boxes of load and frequency hold no zero; frequency: up to which
    they go (0 where there are none).
    """

    lowest: int
    reach: Fraction
    modes: int
    stretches: tuple[Stretch, ...]
    cells: int = 0
    frequency: float = 0.0

    @property
    def numbers(self) -> dict[str, float]:
        """In short."""
        return {
            "lowest": self.lowest,
            "reach": float(self.reach),
            "stretches": len(self.stretches),
            "cells": self.cells,
            "frequency": self.frequency,
        }


def complete(
    beam: Itself, crossing: ExactCrossing, alpha: Exact, beta: Exact, kappa: Exact | None = None
) -> tuple[ExactCrossing, Evidence | None, str]:
    """The crossing with `first` and `stable_below` where they are proven; the evidence; else the step that failed."""
    with precision(BITS if isinstance(beam, Beam) or beam.vanishing else BITS_OF_ANY):
        try:
            if isinstance(beam, Beam):
                evidence = _prove(beam, crossing, alpha, beta, kappa)
            elif _prove_by_energy(beam, crossing):
                proof = Proof(first=True, stable_below=True)
                return replace(crossing, proof=proof), None, "no certificate holds a proof by the column's energy"
            else:
                evidence = _prove_of_any(beam, crossing)
        except Unproven as error:
            return crossing, None, str(error)
    return replace(crossing, proof=Proof(first=True, stable_below=True)), evidence, ""


def _prove(beam: Beam, crossing: ExactCrossing, alpha: Exact, beta: Exact, kappa: Exact | None) -> Evidence:
    load, frequency = +crossing.load, +crossing.frequency
    c_E, c_M = damping_factors(beam, alpha, beta, kappa)
    undamped, flutter = kappa is None and beam.undamped(alpha, beta), crossing.kind == "flutter"
    grows = growing(c_E, c_M)
    strips, m, reach = strips_for(beam, load, None if undamped else grows)
    proof = Below(beam, strips, m, load)
    if grows is not None:
        proof.above(grows)
    if undamped:
        at = None if crossing.kind == "divergence" else frequency * frequency
        return Evidence(m, rational(reach, 60), strips.modes.count, tuple(proof.real_and_simple(at)))
    if kappa is not None:
        below = proof.real_and_simple(None) if crossing.kind == "divergence" else proof.real_and_simple_throughout()
        stretches = tuple(below)
        problem: Onset = VanishingDamping(beam, kappa)
        top, known = strips.line(m).upper(), [[load, frequency * frequency]] if flutter else []
        cells = Cells(beam, strips.rigid, load, known).no_other_zero(problem, top)
        return Evidence(m, rational(reach, 60), strips.modes.count, stretches, cells, float(top) ** 0.5)
    known = [[load, frequency]] if flutter else []
    start = proof.real_and_simple_at(Fraction(0))
    proof.no_divergence(crossing.kind)
    top = proof.highest_frequency(c_E, c_M)
    cells = Cells(beam, strips.rigid, load, known).no_other_zero(Damped(beam, alpha, beta), top)
    return Evidence(m, rational(reach, 60), strips.modes.count, (start,), cells, float(top))


def damping_factors(beam: Beam, alpha: Exact, beta: Exact, kappa: Exact | None) -> tuple[arb, arb]:
    """c_E and c_M of C = c_E E + c_M M, in the limit α → 0⁺ per α. Raises OpenStep where c_E may be negative, or c_M
    without c_E.

    A range, in which they are linear, is looked at in its ends.
    """
    dampings = (alpha, beta) if kappa is None else (Fraction(1), kappa)
    at_ends = [(v.low, v.high) if isinstance(v, Range) else (v,) for v in dampings]
    found = [beam.damping(*ends) for ends in product(*at_ends)]
    if not all(c_E >= 0 and (c_M >= 0 or c_E > 0) for c_E, c_M in found):
        raise OpenStep("damping: a factor of C = c_E E + c_M M is not known to be positive")
    if not (all(c_E > 0 for c_E, _ in found) or all(c_E.is_zero() for c_E, _ in found)):
        raise OpenStep("damping: internal damping is nothing at an end of the range, where the load jumps")
    return beam.damping(*dampings)


def growing(c_E: arb, c_M: arb) -> arb | None:
    """With internal damping, the s below which a motion at s is not damped by c_E s + c_M; None without it."""
    return (-c_M / c_E).upper().max(arb(0)) if c_E > 0 else None


def keeps_energy(beam: Itself) -> bool:
    """Whether it is a gyroscopic column whose energy is kept, which is first lost by divergence."""
    if not isinstance(beam, ExactSystem) or not beam.rated or beam.rigid:
        return False
    return energy.kept(beam.kernel, beam.own, beam.dampings)


def _prove_by_energy(system: ExactSystem, crossing: ExactCrossing) -> bool:
    """Whether a divergence is the first loss of a gyroscopic column whose energy is kept. Raises Unproven."""
    if crossing.kind != "divergence" or not keeps_energy(system):
        return False
    energy.positive_below(system, +crossing.load)
    return True


def _prove_of_any(system: ExactSystem, crossing: ExactCrossing) -> Evidence:
    """The same where no modes are known in closed form: by the gaps between frequencies."""
    load, frequency = +crossing.load, +crossing.frequency
    square = None if crossing.kind == "divergence" else frequency * frequency
    alpha, beta = (Fraction(v) if isinstance(v, int) else v for v in system.dampings)
    damped = system.vanishing or not system.undamped(alpha, beta)
    still = system.still() if damped else system
    try:
        if damped:
            found = damped_gaps(still, load.upper(), alpha, beta, system.vanishing)
            gaps, m, reach, top = found.gaps, found.lowest, found.reach, found.top
        else:
            gaps = FrequencyGaps(system, load.upper())
            m, reach = gaps.lowest, gaps.reach
    except Unproven as error:
        raise OpenStep(f"{'damping' if damped else 'frequency gaps'}: {error}") from None
    proof = Below(still, gaps, m, load)
    if not damped:
        stretches = tuple(proof.real_and_simple(square))
        return Evidence(m, rational(reach, 60), gaps.count, stretches)
    if system.vanishing:
        below = proof.real_and_simple(None) if square is None else proof.real_and_simple_throughout()
        stretches = tuple(below)
        problem: Onset = VanishingRates(system)
        known = [] if square is None else [[load, square]]
    else:
        proof.no_divergence(crossing.kind)
        stretches, problem = (proof.real_and_simple_at(Fraction(0)),), Damped(system, alpha, beta)
        known = [] if square is None else [[load, frequency]]
    cells = Cells(system, 0, load, known).no_other_zero(problem, top)
    highest = float(top) ** 0.5 if system.vanishing else float(top)
    return Evidence(m, rational(reach, 60), gaps.count, stretches, cells, highest)


def complete_to(beam: Any, load: Exact, alpha: Exact, beta: Exact, known: Sequence[acb]) -> tuple[arb | None, str]:
    """A bound up to which in |λ| no eigenvalue of the beam itself at a load is missing among the known; else why not.

    known: enclosures of eigenvalues λ, each of a simple one, no two of the same; both of a conjugate pair.
    """
    if not isinstance(beam, Beam):
        return None, "the modes of a uniform beam serve columns of the textbook's kind alone"
    with precision(BITS):
        c_E, c_M = beam.damping(alpha, beta)
        if not (c_E.is_zero() and c_M >= 0):
            return counted_to(beam, load, alpha, beta, known)
        try:
            strips, least, _ = strips_for(beam, abs(exact(load)), None)
        except Unproven as error:
            return None, str(error)
        # each of the m eigenvalues s left of line m has two λ, λ² + c_M λ + s = 0
        squares = [-(value * value + c_M * value) for value in known]
        places = [s.real for s in squares if not s.contains(0)]  # which a rigid motion has
        for m in range(strips.modes.count * 3 // 4, least - 1, -1):
            R = strips.line(m)
            if sum(bool(s < R) for s in places) == 2 * m:
                return ((c_M * c_M + 4 * R).sqrt() - c_M).lower() / 2, ""
    return None, f"fewer than the {2 * least} lowest are known"


def strips_for(beam: Beam, load: arb, grows: arb | None) -> tuple[Strips, int, arb]:
    """The strips, m, and the load up to which they hold. grows: with internal damping, up to which s C damps nothing;
    then Cauchy's estimate needs P sup |s_j'| < R_{j−1} less that for all j > m: see `docs/theorem.md`."""
    failure: Unproven | None = None
    for count in COUNTS if grows is None else COUNTS[1:]:
        try:
            strips = Strips(beam.kernel, beam.own, count)
            for m, reach in sorted(strips.reaches(load.upper()).items()):
                R, above = strips.line(m), strips.line(m + 1)
                if grows is None or above / R - 1 < arb.pi() / 2 * (reach - load) / load * (1 - grows / R):
                    return strips, m, reach
            failure = NoStrips("high modes are not known to stay on their side of the boundary")
        except Unproven as error:
            failure = error
            if isinstance(error, NoStrips) and "could not" not in str(error):
                break
    raise OpenStep(f"strips: {failure}") from None


class Below:
    """The proofs for one column and one load: R_m is the first line that is free."""

    def __init__(self, beam: Itself, strips: Strips | FrequencyGaps, m: int, load: arb) -> None:
        self.beam, self.strips, self.m, self.load = beam, strips, m, load
        self.trivial = strips.rigid
        self.R = strips.line(m)

    # ---------------------------------------------------------------- signs of F(P, s) for real s

    def _estimates(self, P: float) -> Any:
        return self.strips.estimates(P, self.m + 1)

    def _taylor(self, low: arb, high: arb, s: arb) -> tuple[list[arb], arb]:
        """Coefficients of F in powers of the load about the middle, the last over all of it; and half the width.

        At s = 0 those of F / s^R, R the number of rigid motions.
        """
        middle, whole = ((low + high) / 2).mid(), low.union(high)
        R = self.trivial if s.is_zero() else 0
        orders = tuple((i, j) for i in range(TERMS + 1) for j in range(R + 1))
        at, over = (self.beam.taylor(P, s, orders) for P in (middle, whole))
        return [*(at[i, R] for i in range(TERMS)), over[TERMS, R]], whole - middle

    def sign(self, low: arb, high: arb, s: arb) -> int:
        """Of F(P, s) for all P of an interval; 0 where it is not known."""
        coefficients, h = self._taylor(low, high, s)
        total = arb(0)
        for c in reversed(coefficients):
            total = total * h + c
        return 1 if total > 0 else -1 if total < 0 else 0

    def rising(self, low: arb, high: arb) -> int:
        """The sign of d/dP of F(P, 0) / s^R for all P of an interval; 0 where it is not known."""
        middle, whole = ((low + high) / 2).mid(), low.union(high)
        R = self.trivial
        orders = tuple((i, j) for i in range(3) for j in range(R + 1))
        at, over = (self.beam.taylor(P, arb(0), orders) for P in (middle, whole))
        slope = at[1, R] + 2 * over[2, R] * (whole - middle)
        return 1 if slope > 0 else -1 if slope < 0 else 0

    def _separators(self, *loads: float) -> tuple[Fraction, ...] | None:
        """Points between the estimates at all of some loads; the first 0, the last just below R_m."""
        values = np.array([self._estimates(P) for P in loads])
        scale = np.abs(values).max(axis=0)
        if np.any(np.abs(values.imag) > 1e-9 * scale):
            return None
        low, high = values.real.min(axis=0), values.real.max(axis=0)
        between = [(a + b) / 2 for a, b in zip(high[: self.m - 1], low[1 : self.m], strict=True)]
        points = (Fraction(0), *(Fraction(v) for v in between), rational(self.R * (1 - arb(2) ** -30), 60))
        return points if all(a < b for a, b in pairwise(points)) else None

    def _alternate(
        self, low: arb, high: arb, separators: Sequence[Fraction], moving: int | None = None
    ) -> list[int] | None:
        """The signs of F at the separators, where they alternate (that of a moving one is left open as 0)."""
        fixed = [k for k in range(len(separators)) if k != moving]
        signs = dict.fromkeys(fixed, 0)
        for k in reversed(fixed):  # the highest is the one that fails first
            signs[k] = self.sign(low, high, exact(separators[k]))
            if signs[k] == 0 or signs[k] * signs[fixed[-1]] != (-1) ** (k - fixed[-1]):
                return None
        return [signs[fixed[0]] * (-1) ** (k - fixed[0]) for k in range(len(separators))]

    def _covered(self, start: Fraction, end: Fraction) -> Iterator[Stretch]:
        """Stretches from start to end."""
        a, width, tries = start, end - start, 0
        while a < end:
            b, tries = min(a + width, end), tries + 1
            separators = self._separators(float(a), float((a + b) / 2), float(b))
            if separators is not None and self._alternate(exact(a), exact(b), separators):
                yield Stretch(a, b, separators)
                a, width = b, 2 * width
                continue
            width = (b - a) / 2
            if width < (end - start) / 2**14 or tries == MOST_TRIES:
                raise OpenStep(
                    f"low frequencies: the {self.m} lowest are not known to be real, positive and simple between the "
                    f"loads {float(a):.10g} and {float(b):.10g}"
                )

    def real_and_simple_at(self, P: Fraction) -> Stretch:
        """All eigenvalues are real, positive and simple at a load."""
        separators = self._separators(float(P))
        if separators is None or not self._alternate(exact(P), exact(P), separators):
            raise OpenStep(f"low frequencies: not known to be real, positive and simple at the load {float(P):.6g}")
        return Stretch(P, P, separators)

    def above(self, s: arb) -> None:
        """At rest no eigenvalue is from 0 to s: all change the sign of F once, and none has done so at s."""
        if not s > 0:
            return
        first, none = self.real_and_simple_at(Fraction(0)).separators[1], arb(0)
        signs = [self.sign(none, none, value) for value in (none, s)]
        if self.trivial or not s < exact(first) or signs[0] * signs[1] <= 0:
            raise OpenStep("damping: it is not known to damp the lowest frequency without load")

    def real_and_simple_throughout(self) -> Iterator[Stretch]:
        """The same for all loads up to and with the one of the crossing."""
        return self._covered(Fraction(0), rational(self.load.upper(), 60) + Fraction(1, 2**40))

    def real_and_simple(self, square: arb | None) -> Iterator[Stretch]:
        """The same below the crossing; square: ω² there, None for a divergence."""
        end = rational(self.load, 80)
        share = Fraction(1, 4)
        for _ in range(12):
            start = rational(float(end * (1 - share)), 30)
            last = self._towards(start, end, square)
            if last is not None:
                yield from self._covered(Fraction(0), start)
                yield last
                return
            share /= 2
        raise OpenStep("low frequencies: those just below the crossing are not known to be real, positive and simple")

    def _towards(self, start: Fraction, end: Fraction, square: arb | None) -> Stretch | None:
        """A stretch up to the crossing, where the sign of F along one separator follows from its derivative."""
        just_below = float(end) * (1 - 1e-7)
        separators = self._separators(float(start), float((start + end) / 2), just_below)
        estimates = self._estimates(float(start)).real
        if square is None:
            moving, slope = 0, Fraction(0)
        else:
            at = float(square)
            # the two that meet are on either side of the point
            moving = int(np.searchsorted(estimates[: self.m], at))
            if not 0 < moving < self.m:
                return None
            mean = (estimates[moving - 1] + estimates[moving]) / 2
            slope = rational((mean - at) / float(start - end), 30)
            fixed = self._fixed(start, end, just_below, moving)
            if fixed is None:
                return None
            separators = fixed
        if separators is None:
            return None
        low, high = exact(start), self.load
        wanted = self._alternate(low, high.upper(), separators, moving)
        if wanted is None:
            return None
        point = arb(0) if square is None else square
        if square is not None:
            # the line ascends between its neighbours
            line = [point, point + exact(slope) * (low - self.load)]
            if not all(exact(separators[moving - 1]) < v < exact(separators[moving + 1]) for v in line):
                return None
        rising = self._rising(low, high, point, exact(slope))
        # F is zero at the crossing, so below it F has the sign that is opposite to that of its derivative
        if rising == 0 or -rising != wanted[moving]:
            return None
        return Stretch(start, end, separators, (moving, slope))

    def _fixed(self, start: Fraction, end: Fraction, below: float, moving: int) -> tuple[Fraction, ...] | None:
        """Separators but for the moving one, in whose place stands the crossing's."""
        values = np.array([self._estimates(P).real for P in (float(start), float((start + end) / 2), below)])
        low, high = values.min(axis=0), values.max(axis=0)
        points = [Fraction(0)]
        for k in range(1, self.m):
            middle = (values[-1][k - 1] + values[-1][k]) / 2 if k == moving else (high[k - 1] + low[k]) / 2
            points.append(Fraction(middle))
        points.append(rational(self.R * (1 - arb(2) ** -30), 60))
        return tuple(points) if all(a < b for a, b in pairwise(points)) else None

    def _rising(self, low: arb, high: arb, point: arb, slope: arb) -> int:
        """The sign of dF/dP along s = point + slope (P − P*), for all P up to the crossing; 0 where it is not known."""
        R = self.trivial if point.is_zero() else 0
        orders = tuple((i, j) for i in range(3) for j in range(R + 3) if i + max(0, j - R) <= 2)
        signs = set()
        waiting = [(low, high.upper(), 0)]
        while waiting:
            a, b, depth = waiting.pop()
            middle, whole = ((a + b) / 2).mid(), a.union(b)
            beam: Itself | Local = self.beam
            if isinstance(beam, ExactSystem) and any(isinstance(v, Range) for v in beam.own.values()):
                beam = Local(beam, whole, point + slope * (whole - high))  # wide balls are too much for Taylor steps
            at = beam.taylor(middle, point + slope * (middle - high), orders)
            over = beam.taylor(whole, point + slope * (whole - high), orders)
            if point.is_zero():
                value, bend = at[1, R], 2 * over[2, R]
            else:
                value = at[1, 0] + slope * at[0, 1]
                bend = 2 * (over[2, 0] + slope * over[1, 1] + slope * slope * over[0, 2])
            value += bend * (whole - middle)
            if value.contains(0):
                if depth == 8:
                    return 0
                waiting += [(a, middle, depth + 1), (middle, b, depth + 1)]
                continue
            signs.add(1 if value > 0 else -1)
            if len(signs) == 2:
                return 0
        return signs.pop()

    # ---------------------------------------------------------------- with damping

    def no_divergence(self, kind: str) -> None:
        """λ = 0 is no eigenvalue, but for rigid motions, below the crossing, nor at it unless that is a divergence."""
        end = rational(self.load, 80)
        waiting = [(Fraction(0), end, 0)]
        while waiting:
            a, b, depth = waiting.pop()
            high = self.load.upper() if b == end else exact(b)
            if self.sign(exact(a), high, arb(0)):
                continue
            if kind == "divergence" and b == end and self._rising(exact(a), self.load, arb(0), arb(0)):
                continue
            if depth == DEEPEST or b - a < end / 2**14:
                raise OpenStep(f"divergence: F(P, 0) is not known to differ from zero at the load {float(a):.10g}")
            middle = (a + b) / 2
            waiting += [(middle, b, depth + 1), (a, middle, depth + 1)]

    def highest_frequency(self, c_E: arb, c_M: arb) -> arb:
        """Ω such that no eigenvalue iω with ω ≥ Ω is one of the m lowest, or none is there at all."""
        strips = self.strips
        assert isinstance(strips, Strips)
        if not c_E > 0:
            return self.R.sqrt().upper()  # Re s = ω²
        found = []
        # Re s = ω² (1 − αβ) / (1 + α² ω²) ≥ R_m from there on
        product = c_E * c_M
        rest = 1 - product - c_E * c_E * self.R
        if rest > 0:
            found.append((self.R / rest).sqrt().upper())
        # for αω ≥ 1 − 2 min(0, αβ) is Re s ≤ |Im s|, so |ν − s| ≥ ν / √2 for all ν > 0, such as eigenvalues with T₊;
        # then √2 (‖T₋‖ + |p| ‖B‖) < 1 with |p| ≤ P/√(1 + α²ω²)
        spare = 1 / arb(2).sqrt() - strips.softening.norm(arb(0))
        if spare > 0:
            ratio = self.load * strips.B.norm(arb(0)) / spare
            found.append((ratio.max(1 - 2 * product.min(arb(0))) / c_E).upper())
        if not found:
            raise OpenStep("large frequencies: no bound is known beyond which there is no crossing")
        return least(found)
