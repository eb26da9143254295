"""Signs of F(P, s) of the beam itself for real s, for the verifier: that its lowest eigenvalues are real and apart.

Of the verifier of certificates of the beam itself (`verifier_of_beam`); it shares no code with the prover.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

import flint
from flint import arb

from freebeam_derive.certify.verifier_boxes import Box
from freebeam_derive.certify.verifier_claims import ball, require
from freebeam_derive.certify.verifier_equations import Equations, Interval, over

BITS = 128


@dataclass(frozen=True)
class Stretch:
    """Loads from start to end with m + 1 points s between which F changes sign, the first 0.

    moving: the index of one that moves through the crossing with the slope, or None.
    """

    start: Fraction
    end: Fraction
    points: tuple[Fraction, ...]
    moving: int | None
    slope: Fraction


class Signs:
    """top: the line R_m, left of which all points must be."""

    def __init__(self, equations: Equations, top: arb) -> None:
        self.F, self.R, self.top = equations.F, equations.R, top

    def sign(self, low: arb, high: arb, s: arb) -> int:
        """Of F(P, s), at s = 0 of F / s^R, for all P of an interval."""
        R, P = self.R if s.is_zero() else 0, low.union(high)
        value = Box(self.F, P, s, R).value(P, s, 0, R)
        return 1 if value > 0 else -1 if value < 0 else 0

    def alternate(self, low: arb, high: arb, points: tuple[Fraction, ...], moving: int | None) -> list[int]:
        """The signs at the points, each other than the last; that of a moving one follows from the others."""
        where = f"between the loads {float(low):.10g} and {float(high):.10g}"
        signs = [0 if k == moving else self.sign(low, high, ball(x)) for k, x in enumerate(points)]
        known = next(k for k in range(len(points)) if k != moving)
        wanted = [signs[known] * (-1) ** (k - known) for k in range(len(points))]
        right = all(s != 0 and s == w for k, (s, w) in enumerate(zip(signs, wanted, strict=True)) if k != moving)
        require(right, f"F is not known to change sign from each point to the next {where}")
        return wanted

    def at_rest(self, stretches: list[Stretch]) -> None:
        """All eigenvalues are real, positive and simple at P = 0: what one stretch says."""
        stable = "not known to be stable at P = 0"
        require(len(stretches) == 1, stable)
        (s,) = stretches
        require(s.start == s.end == 0 and s.moving is None, stable)
        self._left(s)
        self.alternate(arb(0), arb(0), s.points, None)

    def above(self, s: Fraction, stretches: list[Stretch]) -> None:
        """At P = 0 no eigenvalue is from 0 to s: the first point is beyond, and up to there F changes sign once."""
        if s == 0:
            return
        signs = [self.sign(arb(0), arb(0), x) for x in (arb(0), ball(s))]
        damps = self.R == 0 and s < stretches[0].points[1] and signs[0] * signs[1] > 0
        require(damps, "the lowest frequency is not known to be damped at P = 0")

    def _left(self, stretch: Stretch) -> None:
        require(bool(ball(stretch.points[-1]) < self.top), "the last point is beyond the line that is free")

    def check_order(self, stretches: Sequence[Stretch], moves: bool) -> None:
        """What is seen of stretches before anything is computed: there is no gap from 0 on, all points are left of the
        line, and on the last one moves, or none does. Raises Refused."""
        reached = Fraction(0)
        require(bool(stretches), "there are no stretches")
        for n, s in enumerate(stretches, 1):
            require(s.start == reached < s.end, "the stretches leave a gap")
            moving = "a point moves that should not, or does not where it should"
            require((s.moving is not None) == (moves and n == len(stretches)), moving)
            self._left(s)
            reached = s.end

    def stable(self, stretches: Sequence[Stretch], load: Interval, crossing: list[arb] | None) -> None:
        """Theorem 1 on [0, P*), given the crossing's P and s (0 at a divergence); without one on all of [0, P*]."""
        self.check_order(stretches, crossing is not None)
        for n, s in enumerate(stretches, 1):
            last = crossing is not None and n == len(stretches)
            with flint.ctx.workprec(BITS):
                low, high = ball(s.start), ball(load[1] if last else s.end)
                wanted = self.alternate(low, high, s.points, s.moving)
            if last:
                assert crossing is not None
                self._through(low, s, wanted, crossing)
        to_load = (load[1] if crossing is None else load[0]) <= stretches[-1].end
        require(to_load, "stability is not shown up to the load")

    def _through(self, low: arb, stretch: Stretch, wanted: list[int], crossing: list[arb]) -> None:
        """F on the line through the crossing has the wanted sign below it: its derivative has the other."""
        (P_, s_), moving, slope, points = crossing, stretch.moving, ball(stretch.slope), stretch.points
        flutter = not s_.is_zero()
        assert moving is not None
        require((moving > 0) == flutter, "another point moves than the crossing's")
        if flutter:
            ends = [s_ + slope * (P - P_) for P in (low, P_)]
            between = all(ball(points[moving - 1]) < x < ball(points[moving + 1]) for x in ends)
            require(between, "the line through the crossing does not stay between its neighbours")
        waiting = [(low, P_.upper(), 0)]
        while waiting:
            a, b, depth = waiting.pop()
            P = a.union(b)
            s = s_ + slope * (P - P_) if flutter else arb(0)
            with flint.ctx.workprec(BITS):
                box = Box(self.F, P, s, self.R + 1)
                rising = along(box, P, s, slope) if flutter else box.value(P, s, 1, self.R)
            if bool(rising * wanted[moving] < 0):
                continue
            require(depth < 8, "the sign of F is not known on the line through the crossing")
            middle = P.mid()
            waiting += [(a, middle, depth + 1), (middle, b, depth + 1)]

    def static(self, top: Fraction, known: list[Interval]) -> None:
        """F(P, 0) / s^R has no zero for 0 ≤ P ≤ top but one in each of some intervals, in which there is one."""
        waiting, covered = [(Fraction(0), top)], Fraction(0)
        while waiting:
            a, b = waiting.pop()
            if self.sign(ball(a), ball(b), arb(0)) or self._one_zero(a, b, known):
                covered += b - a
                continue
            require(b - a > top / 2**14, f"F(P, 0) is not known to differ from zero near the load {float(a):.6g}")
            middle = a + (b - a) * Fraction(33, 64)  # crossings like round loads
            waiting += [(a, middle), (middle, b)]
        require(covered == top, "not all loads are looked at for F(P, 0)")

    def _one_zero(self, a: Fraction, b: Fraction, known: list[Interval]) -> bool:
        """Whether F(P, 0) / s^R is monotonic from a to b, with a known zero there, or with none by its signs."""
        near = [k for k in known if k[0] <= b and a <= k[1]]
        if len(near) > 1 or any(low < a or b < high for low, high in near):
            return False
        P = over((a, b))
        if Box(self.F, P, arb(0), self.R).value(P, arb(0), 1, self.R).contains(0):
            return False
        signs = [self.sign(ball(x), ball(x), arb(0)) for x in (a, b)]
        return bool(near) or signs[0] * signs[1] > 0


def along(box: Box, P: arb, s: arb, slope: arb) -> arb:
    """dF/dP on a line s = … + slope P."""
    return arb(box.value(P, s, 1, 0) + slope * box.value(P, s, 0, 1))
