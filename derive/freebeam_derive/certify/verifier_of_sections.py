"""Check certificates of the first crossing of a column of variable or stepped section (format 6): code of its own.

It shares none with the prover. In a file are ends, breaks, forms, damping, the claim, m, the line R_m and points
between which F(P, s) changes sign. Computed here are F (`verifier_pieces`), the load's size (`verifier_sections`),
all frequencies without load up to one beyond which `verifier_waves` knows them to be apart, and from these that no
eigenvalue passes a line from m on (Lemmas 6 and 12 of docs/theorem.md), nor with damping reaches the axis beyond line m
(`verifier_damping`). The crossing, the signs and the cells are looked at as for a uniform beam.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from fractions import Fraction
from functools import reduce
from typing import Any

import flint
from flint import arb, arb_poly

from freebeam_derive.certify import verifier_sections
from freebeam_derive.certify.verifier_claims import Statement, ball, greatest, least, require
from freebeam_derive.certify.verifier_damping import Damped
from freebeam_derive.certify.verifier_damping_forms import damped, of_all_alike, statement
from freebeam_derive.certify.verifier_equations import Equations
from freebeam_derive.certify.verifier_load_size import load_size
from freebeam_derive.certify.verifier_of_beam import First, High
from freebeam_derive.certify.verifier_pieces import OfPieces, Pieces
from freebeam_derive.certify.verifier_rates import Rates
from freebeam_derive.certify.verifier_sections import OfSections, Place, Sections
from freebeam_derive.certify.verifier_signs import BITS
from freebeam_derive.certify.verifier_waves import Apart

STEP = Fraction(197, 1024)  # of γ L, in which zeros are looked for: an odd share, for zeros like round places
DEEPEST, HALVINGS = 30, 40  # of such a step; of an interval with one zero
MOST_FREQUENCIES = 400
WIDER = 4  # with damping high gaps are looked for that are so many times as wide as the load needs them to be


class Gaps(High):
    """The lines of a column between its frequencies without load; as `verifier_of_beam.High` of a uniform beam.

    columns: each with its F: one, or both ends of a range in which one natural condition changes: each frequency is
    between those of the ends (docs/theorem.md, Theorem 5).
    """

    def __init__(
        self, columns: Sequence[tuple[Sections, Pieces]], m: int, line: Fraction, damping: Damped | None = None
    ) -> None:
        self.columns, self.m, self.top, self.damping = columns, m, ball(line), damping
        self.size = load_size([column for column, _ in columns])
        self.known: list[tuple[arb, arb]] = []

    def check(self, load: Fraction, equations: Equations) -> None:
        """No eigenvalue on any line from m on, for |p| up to a load: Lemmas 6 and 12; with damping 10 and 11."""
        P, damping = ball(load), self.damping
        if damping is not None and damping.of_mass:  # p is real, and high eigenvalues with it
            damping = None
        served = damping is None or not (self.size.places or any(column.joints for column, _ in self.columns))
        require(served, "there are joints, or loads where no mass is, with other than external damping alone")

        def needed(low: arb, high: arb) -> arb:
            return arb((P * self.size.at(low, high)).upper())

        loaded = (P * self.size.constant).upper()
        apart = Apart(*(column for column, _ in self.columns))
        beyond, gap = apart.gap(lambda *pair: needed(*pair) * (1 if damping is None else WIDER))
        beyond = beyond.max(self.top.root(4))
        if damping is not None and damping.bare:
            beyond = beyond.max(damping.served_from(loaded).sqrt())
        known = self.known = self._frequencies(beyond, apart.whole)
        require(self.m < len(known), "the line is above all frequencies that are looked at")
        for k in range(self.m + 1, len(known)):
            low, high = known[k - 1][1], known[k][0]
            wide = f"the gap between the frequencies {k} and {k + 1} without load is too narrow for such a load"
            require(bool(high - low > needed(low, high)), wide)
            gap = gap.min(high - low)
        # R is a b with ω_m ≤ a, b ≤ ω_{m+1}
        below, above = known[self.m - 1][1], known[self.m][0]
        a = below.max(self.top / above)
        around = (self.top / below - below).min(above - self.top / above)
        require(bool(needed(a, self.top / a) < around), f"line {self.m} is not known to be free of eigenvalues")
        if damping is not None:
            modes = self._motions(damping, beyond, apart.whole)
            damping.check(loaded, gap.min(around).lower(), known[self.m - 1][0].lower(), modes)
        F: Any = equations.F
        if damping is None:
            F.ready(P * 3 / 2 + 1, self.top + 1)  # one series for all signs: so far a box of all loads from 0 to P asks
        else:
            F.on(P, self.top)

    def _motions(self, damping: Damped, beyond: arb, length: arb) -> list[tuple[arb, dict[Place, arb]]]:
        """Of known modes beyond line m: at most ω, and the squares of y⁽ⁱ⁾ where damping acts without a mass."""
        still = [Frequencies(F, beyond, length) for _, F in self.columns]
        found = [(low, dict[Place, arb]()) for low, _ in self.known[self.m :]]
        for place in damping.bare:
            stiffer = []
            for column, _ in self.columns:
                springs = column.springs | {place: column.springs.get(place, Fraction(0)) + 1}
                stiffer.append(Frequencies(Pieces(replace(column, springs=springs)), beyond, length))
            for sides, (_, squares) in zip(self.known[self.m :], found, strict=True):
                squares[place] = square(still, stiffer, sides)
        return found if damping.bare else []

    def _frequencies(self, beyond: arb, length: arb) -> list[tuple[arb, arb]]:
        """Bounds of those of each column, ascending, up to the first that is beyond² of all."""
        each = [Frequencies(F, beyond, length) for _, F in self.columns]
        lists = [of.all() for of in each]
        count = max(map(len, lists))
        lists = [found if len(found) == count else of.all(count) for of, found in zip(each, lists, strict=True)]
        sides = (zip(*both, strict=True) for both in zip(*lists, strict=True))
        return [(least(low), greatest(high)) for low, high in sides]

    def highest(self, equations: Equations, load: Fraction) -> Fraction:
        top = self.top.upper()
        if not equations.real:
            assert self.damping is not None
            top = self.damping.highest(top, ball(load) * self.size.constant)
        upper = top.fmpq()
        return Fraction(int(upper.p), int(upper.q))


class Frequencies:
    """All frequencies without load, from the zeros of F(0, s). beyond: γ up to which all are needed, and one more;
    length: of all waves."""

    def __init__(self, F: Pieces, beyond: arb, length: arb) -> None:
        self.beyond, self.step = beyond, STEP / Fraction(str(float(length.mid())))
        top = (beyond + 12 / length).upper()
        # what is left out is small beside F on the whole disc |s| ≤ S, but F is small near 0
        with flint.ctx.workprec(flint.ctx.prec + int(4 * float(top * length))):
            whole = OfPieces(F, arb(0), (2 * top**4).upper())
        self.scale, self.bits, self.rest = whole.S, whole.precision, whole.rest
        self.F = arb_poly(whole.levels[0].entries())

    def all(self, count: int = 1) -> list[tuple[arb, arb]]:
        """Bounds of ω, ascending, so many at least and up to the first with ω > beyond². Raises Refused."""
        found: list[tuple[arb, arb]] = []
        low = Fraction(0)
        with flint.ctx.workprec(self.bits):
            while len(found) < count or not found[-1][0] > self.beyond**2:
                for a, b in self._between(low, low + self.step, 0):
                    found.append((ball(a) ** 2, ball(b) ** 2))
                require(len(found) < MOST_FREQUENCIES, "there are too many frequencies without load")
                low += self.step
        return found

    def _place(self, gamma: Fraction) -> arb:
        u = ball(gamma) ** 4 / self.scale
        require(bool(u < arb(1) / 2), "frequencies were looked for too far")
        return u

    def _sign(self, gamma: Fraction) -> int:
        value = self.F(self._place(gamma)) + self.rest * arb(0, 1)
        return 1 if value > 0 else -1 if value < 0 else 0

    def _between(self, low: Fraction, high: Fraction, depth: int) -> list[tuple[Fraction, Fraction]]:
        """Intervals of γ with one zero each, all of those on a stretch."""
        a, b = self._place(low), self._place(high)
        middle, half = ((a + b) / 2).mid(), ((b - a) / 2).upper()
        c = self.F(arb_poly([middle, half * (1 + arb(2) ** -20)])).coeffs()
        far = sum((abs(v) for v in c[1:]), arb(0)) + self.rest
        if abs(c[0]) > far:
            return []
        # by Cauchy's estimate from twice the places the slope of the rest is at most 2 rest, for u < 1/2
        bend = sum((n * abs(v) for n, v in enumerate(c[2:], 2)), arb(0)) + 2 * self.rest * half * 2
        if len(c) > 1 and abs(c[1]) > bend:
            signs = self._sign(low), self._sign(high)
            if signs[0] * signs[1] > 0:
                return []
            if signs[0] * signs[1] < 0:
                return [self._narrowed(low, high, signs[0])]
        require(
            depth < DEEPEST, f"the frequencies about {float(middle * self.scale) ** 0.5:.6g} without load are not known"
        )
        at = low + (high - low) * Fraction(33, 64)
        return self._between(low, at, depth + 1) + self._between(at, high, depth + 1)

    def _narrowed(self, low: Fraction, high: Fraction, below: int) -> tuple[Fraction, Fraction]:
        for _ in range(HALVINGS):
            middle = (low + high) / 2
            sign = self._sign(middle)
            if sign == 0:
                break
            low, high = (middle, high) if sign == below else (low, middle)
        return low, high


def square(still: Sequence[Frequencies], stiffer: Sequence[Frequencies], sides: tuple[arb, arb]) -> arb:
    """Of y⁽ⁱ⁾ where the other columns' spring is stiffer by 1, in a mode of mass 1 with ω between two sides.

    still: one column, or both ends of a range. It is dω²/dk; F is linear in k and in the range's parameter, and nothing
    at ω².
    """
    scale = still[0].scale
    u = sides[0].union(sides[1]) ** 2 / scale
    middle, away = u.mid(), u - u.mid()
    grown, slopes = list[arb](), list[arb]()
    for of, other in zip(still, stiffer, strict=True):
        require(bool(of.scale == scale == other.scale), "frequencies of a range are looked at on different scales")
        with flint.ctx.workprec(max(of.bits, other.bits)):
            value, stiff = (each.F(arb_poly([middle, 1])) for each in (of, other))
            grown.append(stiff(away) + other.rest * arb(0, 1))
            slopes.append(value.derivative()(away) + 2 * of.rest * arb(0, 1))  # of the rest as in `_between`
    with flint.ctx.workprec(still[0].bits):
        return -scale * reduce(arb.union, grown) / reduce(arb.union, slopes)


def verify_sections(data: dict[str, Any]) -> OfSections:
    """Check a certificate of such a column; what it proves. Raises Refused, ArithmeticError."""
    stated, column, m, line, stretches = verifier_sections.read(data)
    none = Fraction(0), Fraction(0)
    with flint.ctx.workprec(BITS):
        F, damping = Pieces(column), damped(data["damping"], column)
        stated = replace(stated, **statement(damping))
        if damping is not None and of_all_alike(damping):
            damping = None
        gaps = Gaps([(column, F)], m, line, damping)
    equations = Equations(F, 0, none, none, False) if damping is None else Rates(F, damping)
    First(equations, gaps, stated, ranged=False).check(stretches)
    return replace(stated, modes=len(gaps.known))


FORMATS: dict[str, Callable[[dict[str, Any]], Statement]] = {verifier_sections.SECTIONS: verify_sections}
