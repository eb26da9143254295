"""All crossings of the beam itself up to a load, and how many eigenvalues are unstable between. Eqs. (6), (14), (15).

`strips` leaves the m lowest eigenvalues s. Up to the load every zero of what brings one to the boundary is found, and
cells (`beam_cells`) show that there is no other: F = F_s = 0 with s > 0 without damping, F = 0 at λ = iω with it, the
limit of that for vanishing damping, and F(P, 0) = 0. At P = 0 no eigenvalue is unstable; the direction of each crossing
gives the number above it. docs/theorem.md has the proof.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from fractions import Fraction
from itertools import pairwise
from typing import Any

from flint import arb

from freebeam_derive.certify import beam_stability
from freebeam_derive.certify.all_crossings import BEYOND, Crossing
from freebeam_derive.certify.balls import Exact, Unproven, ends, exact, precision, rational
from freebeam_derive.certify.beam import Beam
from freebeam_derive.certify.beam_cells import Cells, OpenStep
from freebeam_derive.certify.beam_itself import (
    Coalescence,
    Damped,
    ExactCrossing,
    Itself,
    NoOnset,
    Onset,
    Proof,
    Static,
    VanishingDamping,
    enclose,
)
from freebeam_derive.certify.beam_stability import BITS, Below, Evidence, damping_factors, growing, strips_for
from freebeam_derive.certify.static_touches import touches

FINEST = 40  # halvings of the loads


class AtTheEnd(OpenStep):
    """Whether a crossing is below the highest load is not known."""


@dataclass
class _Passing:
    """A zero that was found: its box, and how many eigenvalues more are unstable above it.

    change: 2 or −2 at a flutter, 1 or −1 at a divergence, 0 at a touch.
    """

    box: list[arb]
    change: int
    flutter: bool
    bits: int


@dataclass
class Survey:
    """The search for one column. alpha, beta, or kappa for the limit α → 0⁺ at β = κα. digits: of each crossing.

    After `run`: found, what crosses; crossings, what is said of that; evidence, on which it stands that it is all (one
    stretch, at P = 0).
    """

    beam: Beam
    alpha: Exact
    beta: Exact
    kappa: Exact | None
    load_max: Fraction
    digits: int
    say: Callable[[str], None] = lambda _: None
    found: list[_Passing] = field(default_factory=list)
    crossings: list[Crossing] = field(default_factory=list)
    evidence: Evidence | None = None

    def run(self) -> list[Crossing]:
        """Every crossing for 0 < P ≤ load_max, ascending. Raises OpenStep with the step that failed, Unproven.

        Where balls do not tell whether one lies at load_max or next to it, that one too, and load_max grows.
        """
        asked = self.load_max
        try:
            return self._run()
        except AtTheEnd:
            self.load_max, self.found = asked * BEYOND, []
        return [crossing for crossing in self._run() if crossing.load[0] <= asked]

    def _run(self) -> list[Crossing]:
        with precision(BITS):
            load = exact(self.load_max)
            c_E, c_M = damping_factors(self.beam, self.alpha, self.beta, self.kappa)
            undamped = self.kappa is None and self.beam.undamped(self.alpha, self.beta)
            grows = growing(c_E, c_M)
            strips, m, reach = strips_for(self.beam, load, None if undamped else grows)
            low = Below(self.beam, strips, m, load)
            if grows is not None:
                low.above(grows)
            at_rest = low.real_and_simple_at(Fraction(0))
            self.say("divergence")
            self._divergences(low, None if undamped else (c_E, c_M))
            damped = not undamped and self.kappa is None
            top = low.highest_frequency(c_E, c_M) if damped else strips.line(m).upper()
            problem = self._problem(undamped)
            cells = Cells(self.beam, strips.rigid, load, [], lambda place: self._seek(problem, place))
            count = cells.no_other_zero(problem, top, self.say)
            self.evidence = Evidence(m, rational(reach, 60), strips.modes.count, (at_rest,), count, float(top) ** 0.5)
        self.crossings = self._counted(damped)
        return self.crossings

    def _problem(self, undamped: bool) -> Onset:
        if undamped:
            return Coalescence(self.beam)
        if self.kappa is not None:
            return VanishingDamping(self.beam, self.kappa)
        return Damped(self.beam, self.alpha, self.beta)

    # ---------------------------------------------------------------- flutter

    def _seek(self, problem: Onset, place: list[arb]) -> list[arb]:
        """A box about a zero, alone in it, which is noted with its direction. Raises Unproven."""
        box, (wide, taylor), bits = enclose(problem, [float(v) for v in place], self.digits + 2)
        known = [c for c in self.found if c.flutter and all(map(arb.overlaps, c.box, box))]
        if known:
            return [+side for side in known[0].box]
        with precision(bits):
            try:
                change = _change(problem, wide, taylor)
            except Unproven:
                change = _change(problem, box, problem.slopes(box)[2])
        self.found.append(_Passing(box, change, True, bits))
        return [+side for side in box]

    # ---------------------------------------------------------------- divergence

    def _divergences(self, low: Below, damping: tuple[arb, arb] | None) -> None:
        """Every zero of F(P, 0) / s^R: all simple, or all double, by its closed form."""
        try:
            self._simple(low, damping)
        except OpenStep:
            numbers = touches(self.beam, exact(self.load_max))
            if numbers is None:
                raise
            for n in numbers:
                self._touch(n, damping)

    def _touch(self, n: int, damping: tuple[arb, arb] | None) -> None:
        """F(P, 0) has a double zero at (nπ)²; a simple eigenvalue comes to zero there and goes back."""
        bits = BITS + round(self.digits * 3.33)
        with precision(bits):
            P = (n * arb.pi()) ** 2
            by_value = self.beam.taylor(P, arb(0), ((0, 0), (0, 1)))[0, 1]
            if damping is not None:
                by_value *= damping[1]  # F_P vanishes
            if by_value.contains(0):
                raise OpenStep(
                    f"divergence: F(P, 0) vanishes at the load {float(P):.10g} and passes zero nowhere, but how the "
                    "eigenvalue moves that is zero there is not known"
                )
        self.found.append(_Passing([P], 0, False, bits))

    def _simple(self, low: Below, damping: tuple[arb, arb] | None) -> None:
        """The same where each zero is simple."""
        waiting = [(Fraction(0), self.load_max, 0)]
        while waiting:
            a, b, depth = waiting.pop()
            if low.sign(exact(a), exact(b), arb(0)):
                continue
            rising = low.rising(exact(a), exact(b))
            at_ends = [low.sign(exact(P), exact(P), arb(0)) for P in (a, b)]
            if rising and all(at_ends):
                if at_ends[0] != at_ends[1]:
                    self._divergence(low, a, b, rising, damping)
                continue
            if depth == FINEST:
                raise (AtTheEnd if b == self.load_max else OpenStep)(
                    f"divergence: F(P, 0) all but vanishes near the load {float(a):.10g}, and it is not known whether "
                    "it passes zero there"
                )
            middle = a + (b - a) * Fraction(33, 64)  # crossings like round loads
            waiting += [(middle, b, depth + 1), (a, middle, depth + 1)]

    def _divergence(self, low: Below, a: Fraction, b: Fraction, rising: int, damping: tuple[arb, arb] | None) -> None:
        problem, start, end = Static(self.beam), a, b
        for _ in range(20):
            middle = (start + end) / 2
            there = low.sign(exact(middle), exact(middle), arb(0))
            start, end = (start, middle) if there == rising else (middle, end)
        box, _, bits = enclose(problem, [float((start + end) / 2)], self.digits + 2)
        with precision(bits):
            P, R = box[0], problem.order
            if not exact(a) < P < exact(b):
                at_end = AtTheEnd if b == self.load_max else OpenStep
                raise at_end(f"divergence: near the load {float(P):.10g} it is not known to be below {float(b):.10g}")
            t = problem.slopes(box)[2]
            # F_λ / s^R at λ = 0, up to its sign; without damping F_s
            by_value = t[0, R + 1] if damping is None else damping[0] * P * t[1, R] + damping[1] * t[0, R + 1]
            way = t[1, R] * by_value
            if way.contains(0):
                raise OpenStep(f"divergence: how the eigenvalue zero moves at the load {float(P):.10g} is not known")
        self.found.append(_Passing(box, 1 if way > 0 else -1, False, bits))

    # ---------------------------------------------------------------- all of them

    def _counted(self, damped: bool) -> list[Crossing]:
        """Those up to the load, in their order, with the number of unstable eigenvalues below each."""
        found = sorted(self.found, key=lambda c: c.box[0].mid())
        top = exact(self.load_max)
        result: list[Crossing] = []
        unstable = 0
        for c, following in pairwise([*found, None]):
            assert c is not None
            with precision(c.bits):
                if following is not None and not c.box[0] < following.box[0]:
                    raise OpenStep(f"order: which of two crossings near the load {float(c.box[0]):.10g} comes first")
                if c.box[0] > top:
                    break
                if not c.box[0] < top:
                    raise AtTheEnd(f"order: whether the crossing near the load {float(top):.10g} is below it")
                square = None if not c.flutter else ends(c.box[1] * c.box[1] if damped else c.box[1])
                load = ends(c.box[0])
            kind = "flutter" if c.flutter else "divergence" if c.change else "touch"
            result.append(Crossing(kind, load, square, c.change, unstable))
            unstable += c.change
            if unstable < 0:
                raise OpenStep(f"count: fewer than no eigenvalue unstable above the load {float(c.box[0]):.10g}")
        return result


def complete(
    beam: Itself, crossing: ExactCrossing, alpha: Exact, beta: Exact, kappa: Exact | None = None
) -> tuple[ExactCrossing, Evidence | None, str, Survey | None]:
    """As `beam_stability.complete`, and where it fails and below there are touches and nothing else, with the survey of
    these and the crossing."""
    found, evidence, missing = beam_stability.complete(beam, crossing, alpha, beta, kappa)
    with precision(BITS):
        above = ends(crossing.load.upper() * (1 + arb(2) ** -20))[1]
        top = Fraction(int(above * 10**6) + 1, 10**6)  # a decimal, for a certificate says it
        if evidence is not None or not isinstance(beam, Beam) or not touches(beam, exact(top)):
            return found, evidence, missing, None
    survey = Survey(beam, alpha, beta, kappa, top, crossing.digits)
    try:
        *below, last = survey.run()
    except Unproven as error:
        return found, None, str(error), None
    if any(c.change for c in below) or (last.kind, last.change > 0) != (crossing.kind, True):
        return found, None, "touches: between them and the crossing there is another", None
    return replace(crossing, proof=Proof(first=True, stable_below=True)), survey.evidence, "", survey


def _change(problem: Onset, x: list[arb], t: Any) -> int:
    """How many eigenvalues more are unstable above a flutter. Raises Unproven."""
    try:
        problem.onset(x, t)
    except NoOnset:
        return -2
    return 2
