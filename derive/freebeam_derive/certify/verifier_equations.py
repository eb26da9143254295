"""The equations that hold where an eigenvalue of the beam itself reaches the boundary, for the verifier.

Of the verifier of certificates of the beam itself (`verifier_of_beam`); it shares no code with the prover. C = alpha
E + beta M. In the two unknowns P and x a flutter is F = F_s = 0 without damping (x is s), F = 0 at λ = iω with it (x is
ω), and F = 0, p F_p + (s + β/α) F_s = 0 in the limit of vanishing damping (x is s); a divergence is F/s^R = 0 at s = 0.
Over a range of a parameter all numbers are balls that hold those of each of its values.
"""

from __future__ import annotations

from collections.abc import Callable
from copy import copy
from fractions import Fraction
from typing import Any

from flint import acb, arb

from freebeam_derive.certify.verifier import opposite
from freebeam_derive.certify.verifier_boxes import Box, power
from freebeam_derive.certify.verifier_claims import ball, require
from freebeam_derive.certify.verifier_shooting import POWERS, Shooting

ALONE = "there is no crossing in the interval, or more than one"
Interval = tuple[Fraction, Fraction]
Two = list[arb]
Matrix = list[list[arb]]


def over(interval: Interval) -> arb:
    return ball(interval[0]).union(ball(interval[1]))


def _within(value: arb, interval: Interval) -> bool:
    return bool(ball(interval[0]) < value < ball(interval[1]))


class Equations:
    """At one value of all that is given, or at each value of a range. R: how many rigid motions there are.

    of_E, of_M: alpha and beta at both ends of a range, from one to the other of which they go linearly together; limit:
    of these only the direction counts.
    """

    bits = 128  # of a crossing's box, besides its digits, and of cells

    def __init__(self, F: Shooting, R: int, of_E: Interval, of_M: Interval, limit: bool) -> None:
        self.F, self.R, self.of_E, self.of_M, self.limit = F, R, of_E, of_M, limit
        self.undamped = not any((*of_E, *of_M))
        self.real = self.undamped or limit

    @property
    def alpha(self) -> arb:
        return over(self.of_E)

    @property
    def beta(self) -> arb:
        return over(self.of_M)

    @property
    def undamped_to(self) -> Fraction:
        """The s below which a motion at s is not damped by alpha s + beta, for any value of the range; 0 for none."""
        if not min(self.of_E) > 0:
            return Fraction(0)
        return max(Fraction(0), *(-b / a for a, b in zip(self.of_E, self.of_M, strict=True)))

    @property
    def ratio(self) -> arb:
        """beta over alpha, which is monotonic on the way from one end to the other."""
        a, b = self.of_E, self.of_M
        return over((b[0] / a[0], b[1] / a[1]))

    def box(self, p: Any, s: Any) -> Any:
        """F on a box, for `system`."""
        return Box(self.F, p, s)

    # ---------------------------------------------------------------- their values

    def place(self, P: Any, x: Any) -> tuple[Any, Any]:
        """p and s of the unknowns: x is s, or ω with damping."""
        if self.real:
            return P, x
        lam = acb(0, x)
        return P / (1 + self.alpha * lam), -(lam * lam + self.beta * lam) / (1 + self.alpha * lam)

    def system(self, f: Callable[..., Any], P: Any, x: Any) -> tuple[Two, Matrix]:
        """Two equations and their derivatives by P and x; f(p, s, i, j): Taylor coefficients of F."""
        p, s = self.place(P, x)
        if self.undamped:
            return [f(p, s, 0, 0), f(p, s, 0, 1)], [[f(p, s, 1, 0), f(p, s, 0, 1)], [f(p, s, 1, 1), 2 * f(p, s, 0, 2)]]
        if self.limit:
            r = s + self.ratio
            first, second = f(p, s, 1, 0), f(p, s, 0, 1)
            mixed = f(p, s, 1, 1)
            values = [f(p, s, 0, 0), p * first + r * second]
            return values, [
                [first, second],
                [first + 2 * p * f(p, s, 2, 0) + r * mixed, p * mixed + second + 2 * r * f(p, s, 0, 2)],
            ]
        a, b, lam = self.alpha, self.beta, acb(0, x)
        below = 1 + a * lam
        F, F_p, F_s = f(p, s, 0, 0), f(p, s, 1, 0), f(p, s, 0, 1)
        by_P = F_p / below
        by_x = acb(0, 1) * (F_p * (-a * p / below) + F_s * (-(2 * lam + b) - a * s) / below)
        return [F.real, F.imag], [[by_P.real, by_x.real], [by_P.imag, by_x.imag]]

    def centre(self, f: Callable[..., Any], P: arb, x: arb) -> Two:
        """The two equations at a point, in balls that hold those of each value of the range."""
        return self.system(f, P, x)[0]

    def reduced(self, P: arb, x: arb) -> Callable[..., Any]:
        """F / s^R in place of F on a box next to s = 0, where a value lies in the hull of those of ∂^R F / ∂s^R / R! on
        the way from 0 to s, and so it is with derivatives."""
        p, s = self.place(P, x)
        whole = s.union(0 * s)
        box = Box(self.F, p, whole)
        return lambda p, s, i, j: box.value(p, whole, i, j + self.R)

    def at(self, P: arb, x: arb, near: tuple[Any, Any]) -> list[tuple[Two, arb]]:
        """The two equations at a point, for each value of the range: a sum of two numbers times balls. near: p, s."""
        middle = copy(self)
        middle.of_E, middle.of_M = (((of[0] + of[1]) / 2,) * 2 for of in (self.of_E, self.of_M))
        boxes = [Box(self.F, *near, of=n) for n in range(POWERS + 1 if self.F.ranged else 1)]
        found = [(middle.system(box.value, P, x)[0], power(n)) for n, box in enumerate(boxes)]
        ranged = self.of_E[0] != self.of_E[1] or self.of_M[0] != self.of_M[1]
        return found + (self._by_damping(Box(self.F, *near), P, x) if ranged else [])

    def _by_damping(self, box: Box, P: arb, x: arb) -> list[tuple[Two, arb]]:
        """The slope of the equations from the middle of the dampings to the second end, over all of the range."""
        p, s = self.place(P, x)
        F_p, F_s = box.value(p, s, 1, 0), box.value(p, s, 0, 1)
        if self.limit:
            return [([arb(0), F_s], self.ratio - ball((self.of_M[0] + self.of_M[1]) / (self.of_E[0] + self.of_E[1])))]
        lam = acb(0, x)
        a, b = (ball((of[1] - of[0]) / 2) for of in (self.of_E, self.of_M))
        slope = -lam * (a * (p * F_p + s * F_s) + b * F_s) / (1 + self.alpha * lam)
        return [([slope.real, slope.imag], power(1))]

    # ---------------------------------------------------------------- a crossing

    def flutter(self, load: Interval, square: Interval) -> tuple[list[arb], arb]:
        """Where each value's one crossing is, in the intervals of P and ω²; and a number of the sign of the change."""
        X = [over(load), over(square) if self.real else over(square).sqrt()]
        found = self._image(X)
        # the balls of X are wider than the intervals, by rounding
        sides = ((found[0], load), (found[1] if self.real else found[1] * found[1], square))
        require(all(_within(*side) for side in sides), ALONE)
        return found, self._direction(found)

    def _image(self, X: list[arb]) -> list[arb]:
        """Krawczyk's image, inside X, of which it proves one zero, alone."""
        p, s = (side + (side - side.mid()) / 8 for side in self.place(*X))
        J = self.system(self.box(p, s).value, *X)[1]
        middle = [side.mid() for side in X]
        image = krawczyk(X, middle, self.at(middle[0], middle[1], (p, s)), J)
        require(image is not None, ALONE)
        assert image is not None
        require(all(a.contains_interior(b) for a, b in zip(X, image, strict=True)), ALONE)
        return image

    def _direction(self, X: list[arb]) -> arb:
        """Positive on a box where two eigenvalues more are unstable above a flutter, negative where two less are."""
        p, s = self.place(*X)
        box = Box(self.F, *(side + (side - side.mid()) / 8 for side in (p, s)))
        F_p, F_s = box.value(p, s, 1, 0), box.value(p, s, 0, 1)
        if self.undamped:
            return arb(F_p * box.value(p, s, 0, 2))
        if self.limit:
            slope = -F_p / F_s
            bend = box.value(p, s, 2, 0) + box.value(p, s, 1, 1) * slope + box.value(p, s, 0, 2) * slope * slope
            return arb(-2 * p * bend / F_s)
        J = self.system(box.value, *X)[1]
        by_P, by_x = (acb(J[0][k], J[1][k]) for k in (0, 1))
        return arb((by_P * by_x.conjugate()).imag)

    def divergence(self, load: Interval) -> arb:
        """That F(P, 0) / s^R has one zero in an interval, of each value; and a number of the sign of the change."""
        P, R = over(load), self.R
        box = Box(self.F, P, arb(0), R + 1)
        at = [box.value(ball(x), arb(0), 0, R) for x in load]
        slope = box.value(P, arb(0), 1, R)
        require(opposite(*at) and not slope.contains(0), ALONE)
        return arb(slope * self.rate(box, P, slope))

    def rate(self, box: Box, P: arb, slope: arb) -> arb:
        """∂/∂λ of F / s^R at λ = 0 up to its sign, without damping by s; slope: of F / s^R by P."""
        by_s = box.value(P, arb(0), 0, self.R + 1)
        require(not (self.real and by_s.contains(0)), "s = 0 is not known to be simple there")
        return arb(by_s if self.undamped else self.alpha * P * slope + self.beta * by_s)


# --- Krawczyk's test ----------------------------------------------------------------------------------------------


def _inverse(J: Matrix) -> Matrix | None:
    (a, b), (c, d) = J
    det = a * d - b * c
    return None if det.contains(0) else [[d / det, -b / det], [-c / det, a / det]]


def krawczyk(X: list[arb], middle: list[arb], at: list[tuple[Two, arb]], J: Matrix) -> list[arb] | None:
    """The image of a box: it holds every zero that the box holds. at: the equations at the middle (`Equations.at`)."""
    Y = _inverse([[x.mid() for x in row] for row in J])
    if Y is None:
        return None
    found = []
    for i in (0, 1):
        total = middle[i]
        for value, weight in at:
            total -= sum((Y[i][k] * value[k] for k in (0, 1)), arb(0)) * weight
        for j in (0, 1):
            rest = int(i == j) - sum((Y[i][k] * J[k][j] for k in (0, 1)), arb(0))
            total += rest * (X[j] - middle[j])
        found.append(total)
    return found


def one_to_one(J: Matrix) -> bool:
    """Whether no two points of a box have equal values: with d from one to the other and any Y, d = (1 − Y J) d, and no
    d but 0 has |d| ≤ R |d| where all eigenvalues of R ≥ |1 − Y J| are below 1."""
    Y = _inverse([[x.mid() for x in row] for row in J])
    if Y is None:
        return False
    (a, b), (c, d) = ([abs(int(i == j) - sum((Y[i][k] * J[k][j] for k in (0, 1)), arb(0))).upper() for j in (0, 1)]
                      for i in (0, 1))  # fmt: skip
    return bool(a < 1) and bool(d < 1) and bool((1 - a) * (1 - d) > b * c)
