"""The equations at the boundary where damping leaves a form of its own, for the verifier.

Of the verifier of certificates of the beam itself (`verifier_of_sections`); it shares no code with the prover. With
C = c_E E + c_M M + R, p = P/(1 + c_E λ), q = λ/(1 + c_E λ), s = −(λ² + c_M λ)/(1 + c_E λ) an eigenvalue is a zero of
F(p, s, q), that of E + p B + q R − s M. In the limit of vanishing damping, at a simple s, the growth rate is
−(c_E p F_p + (c_E s + c_M) F_s − F_q) / (2 F_s) times the factor that vanishes, to first order.
"""

from __future__ import annotations

from copy import copy
from fractions import Fraction
from typing import Any

from flint import acb, arb

from freebeam_derive.certify.verifier_boxes import Box, power
from freebeam_derive.certify.verifier_claims import ball, require
from freebeam_derive.certify.verifier_damping import Damped
from freebeam_derive.certify.verifier_damping_forms import halfway
from freebeam_derive.certify.verifier_equations import Equations, Matrix, Two, over
from freebeam_derive.certify.verifier_pieces import Pieces
from freebeam_derive.certify.verifier_shooting import Shooting


class Powers:
    """F(p, s, q) on a box of p and s, by powers of q, |q|² ≤ |s|."""

    def __init__(self, F: Pieces, p: Any, s: Any) -> None:
        first = Box(F, p, s, of=0)
        self.Q = first.whole.Q  # type: ignore[attr-defined]
        self._boxes = [first, *(Box(F, p, s, of=n) for n in range(1, len(first.whole.levels)))]

    def value(self, p: Any, s: Any, i: int, j: int, q: Any, k: int = 0) -> Any:
        """∂^{i+j+k} F / ∂p^i ∂s^j ∂q^k / (i! j!), k at most 1. Raises ArithmeticError outside of the box."""
        t = q / self.Q
        if not abs(t) < arb(3) / 4:
            raise ArithmeticError("a value was asked for outside of its box")
        total = 0 * t
        for n in range(len(self._boxes) - 1, k - 1, -1):
            total = total * t + (n if k else 1) * self._boxes[n].value(p, s, i, j)
        if k:  # the rest stands with q⁰; its slope is at most that over the way to |q| = Q
            error = arb(0, (self._boxes[0].rest(i, j) / (1 - abs(t))).upper())
            total = (total + (acb(error, error) if isinstance(total, acb) else error)) / self.Q
        return total


class _Both:
    """The same box of two."""

    def __init__(self, *boxes: Powers) -> None:
        self.value = tuple(box.value for box in boxes)


class Rates(Equations):
    """As `Equations`. F: without damping, for real s and at s = 0."""

    bits = 64  # a function of three variables takes four times as long with 128

    def __init__(self, F: Pieces, damping: Damped) -> None:
        of_E, of_M = ((f, f) for f in (damping.c_E, damping.c_M))
        super().__init__(F, 0, of_E, of_M, damping.vanishing)
        self.whole = F if damping.plain else Pieces(F.column, damping)
        self.scale = arb(1)  # of R

    @property
    def undamped_to(self) -> Fraction:
        """0: c_M is not negative, and what R takes is in Lemma 11."""
        return Fraction(0)

    def box(self, p: Any, s: Any) -> Powers:
        return Powers(self.whole, p, s)

    def system(self, f: Any, P: Any, x: Any) -> tuple[Two, Matrix]:
        """f(p, s, i, j, q, k): as `Powers.value`."""
        p, s = self.place(P, x)
        a, b = self.alpha, self.beta
        if self.limit:
            q = arb(0)
            F, F_p, F_s, F_q = f(p, s, 0, 0, q), f(p, s, 1, 0, q), f(p, s, 0, 1, q), f(p, s, 0, 0, q, 1)
            r, mixed = a * s + b, f(p, s, 1, 1, q)
            of_p = a * (F_p + 2 * p * f(p, s, 2, 0, q)) + r * mixed - f(p, s, 1, 0, q, 1)
            of_s = a * (p * mixed + F_s) + 2 * r * f(p, s, 0, 2, q) - f(p, s, 0, 1, q, 1)
            return [F, a * p * F_p + r * F_s - F_q], [[F_p, F_s], [of_p, of_s]]
        lam = acb(0, x)
        below = 1 + a * lam
        rate = self.scale * lam / below
        F, F_p, F_s, F_q = (f(p, s, i, j, rate, k) for i, j, k in ((0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)))
        by_P = F_p / below
        by_x = acb(0, 1) * (self.scale * F_q / below - a * p * F_p - (2 * lam + b + a * s) * F_s) / below
        return [F.real, F.imag], [[by_P.real, by_x.real], [by_P.imag, by_x.imag]]

    def at(self, P: arb, x: arb, near: tuple[Any, Any]) -> list[tuple[Two, arb]]:
        return [(self.system(self.box(*near).value, P, x)[0], arb(1))]

    def _direction(self, X: list[arb]) -> arb:
        p, s = (side + (side - side.mid()) / 8 for side in self.place(*X))
        J = self.system(self.box(p, s).value, *X)[1]
        if self.limit:
            (F_p, F_s), (of_p, of_s) = J
            return arb((of_s * F_p / F_s - of_p) / F_s)
        by_P, by_x = (acb(J[0][k], J[1][k]) for k in (0, 1))
        return arb((by_P * by_x.conjugate()).imag)

    def rate(self, box: Box, P: arb, slope: arb) -> arb:
        by_s = box.value(P, arb(0), 0, 1)
        require(not (self.limit and by_s.contains(0)), "s = 0 is not known to be simple there")
        by_q = Powers(self.whole, P, arb(0)).value(P, arb(0), 0, 0, arb(0), 1)
        return arb(self.alpha * P * slope + self.beta * by_s - self.scale * by_q)


class RatesOver(Rates):
    """Of each column and damping between two: equations are linear in the parameter, and between those at its ends.

    F: without damping, over the range.
    """

    def __init__(self, F: Shooting, low: Rates, high: Rates) -> None:
        of_E, of_M = ((min(a[0], b[0]), max(a[1], b[1])) for a, b in ((low.of_E, high.of_E), (low.of_M, high.of_M)))
        Equations.__init__(self, F, 0, of_E, of_M, low.limit)
        self.both = low, high

    def box(self, p: Any, s: Any) -> Any:
        return _Both(*(of.box(p, s) for of in self.both))

    def system(self, f: Any, P: Any, x: Any) -> tuple[Two, Matrix]:
        """f: of both ends."""
        (low, by_low), (high, by_high) = (of.system(value, P, x) for of, value in zip(self.both, f, strict=True))
        return _hull(low, high), [_hull(*rows) for rows in zip(by_low, by_high, strict=True)]

    def at(self, P: arb, x: arb, near: tuple[Any, Any]) -> list[tuple[Two, arb]]:
        low, high = (of.system(of.box(*near).value, P, x)[0] for of in self.both)
        pairs = [*zip(low, high, strict=True)]
        return [([(a + b) / 2 for a, b in pairs], arb(1)), ([(b - a) / 2 for a, b in pairs], power(1))]

    def rate(self, box: Box, P: arb, slope: arb) -> arb:
        low, high = (of.rate(box, P, slope) for of in self.both)
        return low.union(high)


class RatesOverDamping(Rates):
    """Of one column and each damping between two whose R are the same form times a number. Raises Refused."""

    def __init__(self, F: Pieces, low: Damped, high: Damped) -> None:
        self.middle, share = halfway(low, high)
        super().__init__(F, self.middle)
        self.of_E, self.of_M, of_R = (
            (min(pair), max(pair)) for pair in ((low.c_E, high.c_E), (low.c_M, high.c_M), (share, 2 - share))
        )
        self.scale = over(of_R)
        self.grown = (high.c_E - low.c_E) / 2, (high.c_M - low.c_M) / 2, 1 - share  # from the middle to the high end

    def at(self, P: arb, x: arb, near: tuple[Any, Any]) -> list[tuple[Two, arb]]:
        """The middle, and the slope from there to the high end over all of the range."""
        return self._from_middle(self.box(*near).value, P, x)

    def centre(self, f: Any, P: arb, x: arb) -> Two:
        parts = self._from_middle(f, P, x)
        return [sum((value[k] * weight for value, weight in parts), arb(0)) for k in (0, 1)]

    def _from_middle(self, f: Any, P: arb, x: arb) -> list[tuple[Two, arb]]:
        middle = copy(self)
        middle.of_E, middle.of_M, middle.scale = (self.middle.c_E,) * 2, (self.middle.c_M,) * 2, arb(1)
        p, s = self.place(P, x)
        lam = acb(0, x)
        step = lam / (1 + self.alpha * lam)
        q = self.scale * step
        F_p, F_s, F_q = (f(p, s, i, j, q, k) for i, j, k in ((1, 0, 0), (0, 1, 0), (0, 0, 1)))
        of_E, of_M, of_R = map(ball, self.grown)
        slope = step * (F_q * of_R - F_s * of_M - (p * F_p + s * F_s + q * F_q) * of_E)
        return [(middle.system(f, P, x)[0], arb(1)), ([slope.real, slope.imag], power(1))]


def _hull(low: Two, high: Two) -> Two:
    return [a.union(b) for a, b in zip(low, high, strict=True)]
