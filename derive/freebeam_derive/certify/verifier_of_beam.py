"""Check a certificate of the beam itself (format 3): code of its own, which shares none with the prover.

What acceptance proves, and why, stands in docs/theorem.md. In the file are ends, forms, damping, the claim, the number
m of lowest eigenvalues, how many modes the bounds take, and without damping (and in its limit) the points between
which F(P, s) changes sign. Everything else is computed here:

- F(p, s) is the determinant of all four conditions on four solutions, which follow from the forms by parts
  (`verifier_shooting`).
- The load's entries between modes come from integrals of exponentials, the rest of the norms from the lemmas
  (`verifier_lines`).
- The crossing is enclosed by Krawczyk's test in the box of the file (`krawczyk`).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise
from typing import Any

import flint
from flint import acb, arb

from freebeam_derive.certify import verifier as v
from freebeam_derive.certify.decimals import shown
from freebeam_derive.certify.verifier import ball, require
from freebeam_derive.certify.verifier_lines import Lines, check_rigid
from freebeam_derive.certify.verifier_shooting import Box, Shooting

FORMAT = "freebeam certificate 3"
FIELDS = v.CLAIM - {"load_max"} | {"ends", "kappa", "damping", "lowest"}
BITS = 128
MOST_CELLS, MOST_CUTS, MOST_STRETCHES, MOST_BOXES = 60, 7, 10_000, 3000


# --- the claim -------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class OfBeamItself(v.OfBeam):
    """A statement of the partial differential equation; modes: as many as the bounds took."""

    def __str__(self) -> str:
        what = f"column {self.named}" if self.ours else self.forms
        what = f"the beam itself, {what}, {self.ends[0]} at x = 0 and {self.ends[1]} at x = 1, {self.damped}"
        assert self.load is not None
        low, high = shown(*self.load)
        where = "where s = 0"
        if self.frequency is not None:
            where = f"with omega between {' and '.join(shown(*self.frequency))}"
        return (
            f"proven of {what}: exactly one load between {low} and {high} is one of {self.kind}, {where}; "
            "it is the first over all modes, and stable is every load from 0 up to it"
        )

    def record(self) -> dict[str, Any]:
        return super().record() | {"of": "the beam itself: " + super().record()["of"]}


def read(data: dict[str, Any]) -> tuple[OfBeamItself, dict[str, v.Form], int, list[Any]]:
    """What is claimed, the forms, m, and the points of each stretch. Raises Refused."""
    require(set(data) == FIELDS, f"fields are missing, or not known: {', '.join(sorted(FIELDS ^ set(data)))[:100]}")
    left, right = data["ends"]
    require(left in v.ORDERS and right in v.ORDERS, "the ends are not known")
    claims = v._claims(data | {"load_max": None})
    require(claims["kind"] != "none", "of the beam itself a crossing is certified")
    kappa, damping = v.damping_of(data, claims)
    if damping is not None:
        require(damping.of_M >= 0 and damping.of_E >= 0, "the damping is negative")
        inside = damping.of_E > 0
        require(inside or damping.of_M > 0, "there is no damping at all")
        require(inside or not damping.vanishing, "no internal damping is there to vanish")
    require(set(data["forms"]) == set("MEH"), "the forms are not M, E and H")
    forms = {name: v.form(data["forms"][name]) for name in "MEH"}
    require(forms["M"] == (((0, 0, 0, Fraction(1)),), ()), "the mass is not that of the uniform beam")
    bending = [term for term in forms["E"][0] if term[:3] == (0, 2, 2)]
    require(bending == [(0, 2, 2, Fraction(1))], "the bending stiffness is not that of the uniform beam")
    ours = v.is_ours(claims["column"])
    stated = OfBeamItself(**claims, ours=ours, ends=(left, right), basis="modes", kappa=kappa, damping=damping)
    if ours:
        v._check_column(stated, forms)
    m = data["lowest"]
    require(type(m) is int and 0 < m < stated.modes, "the number of lowest eigenvalues is none")
    require(len(data["stretches"]) <= MOST_STRETCHES, "there are too many stretches")
    stretches = [_points(s, m) for s in data["stretches"]]
    return stated, forms, m, stretches


def _points(data: dict[str, Any], m: int) -> Any:
    require(set(data) == {"start", "end", "points", "moving", "slope"}, "a stretch has other parts than it should")
    start, end, slope = (v._number(data[k]) for k in ("start", "end", "slope"))
    points, moving = [v._number(x) for x in data["points"]], data["moving"]
    require(len(points) == m + 1 and points[0] == 0, "there are too few points, or too many")
    require(all(a < b for a, b in pairwise(points)), "the points do not ascend")
    require(moving is None or (type(moving) is int and 0 <= moving < m), "a point that moves is none")
    return start, end, points, moving, slope


def verify(data: dict[str, Any]) -> OfBeamItself:
    """Check a certificate; what it proves. Raises Refused, ArithmeticError."""
    stated, forms, m, stretches = read(data)
    assert stated.load is not None
    with flint.ctx.workprec(BITS):
        ends = list(stated.ends)
        E = tuple(t for t in forms["E"][0] if t[:3] != (0, 2, 2)), forms["E"][1]
        check = _Check(stated, forms, check_rigid(ends, E, forms["H"]), m)
        lines = Lines(ends, stated.modes, E, forms["H"])
        check.strips(lines)
    digits = int(stated.load[1] / (stated.load[1] - stated.load[0])).bit_length()
    with flint.ctx.workprec(3 * digits + BITS):
        crossing = check.crossing()
    with flint.ctx.workprec(BITS + digits):
        if stated.damping is None or stated.damping.vanishing:
            check.stretches(stretches, crossing)
    with flint.ctx.workprec(BITS):
        if stated.damping is not None:
            if not stated.damping.vanishing:
                start, end, points, moving, _ = stretches[0]
                require(len(stretches) == 1 and start == end == 0 and moving is None, "not known to be stable at P = 0")
                check.alternate(arb(0), arb(0), points, None)
                check.no_divergence()
            check.cells(lines, crossing)
    return stated


class _Check:
    """The steps, for one claim."""

    def __init__(self, stated: OfBeamItself, forms: dict[str, v.Form], rigid: int, m: int) -> None:
        self.stated, self.m, self.R = stated, m, rigid
        self.F = Shooting(list(stated.ends), forms["E"], forms["H"])
        assert stated.load is not None
        self.low, self.high = stated.load
        damping = stated.damping
        self.alpha, self.beta = (damping.of_E, damping.of_M) if damping else (Fraction(0), Fraction(0))
        self.limit = damping is not None and damping.vanishing
        self.flutter = stated.kind == "flutter"
        self.boxes = 0

    # ------------------------------------------------------------ strips

    def strips(self, lines: Lines) -> None:
        """Lemmas 3 to 5, and the inequality of Theorems 2 and 3."""
        P, rho = ball(self.high), ball(self.high)
        if self.alpha > 0:
            ratio = lines.line(self.m + 1) / lines.line(self.m) - 1
            rho = (P * (1 + ratio * 2 / arb.pi()) * (1 + arb(2) ** -20)).upper()
        lines.check_free(self.m, rho)
        self.top = lines.line(self.m)

    # ------------------------------------------------------------ the crossing

    def place(self, P: Any, x: Any) -> tuple[Any, Any]:
        """p and s of the unknowns: x is s, or ω with damping."""
        if self.alpha == self.beta == 0 or self.limit:
            return P, x
        a, b = ball(self.alpha), ball(self.beta)
        lam = acb(0, x)
        return P / (1 + a * lam), -(lam * lam + b * lam) / (1 + a * lam)

    def system(self, f: Callable[..., Any], P: Any, x: Any) -> tuple[list[arb], list[list[arb]]]:
        """Two equations and their derivatives by P and x; f(p, s, i, j): Taylor coefficients of F."""
        p, s = self.place(P, x)
        if self.limit:
            r = s + ball(self.beta) / ball(self.alpha)
            first, second = f(p, s, 1, 0), f(p, s, 0, 1)
            mixed = f(p, s, 1, 1)
            values = [f(p, s, 0, 0), p * first + r * second]
            return values, [
                [first, second],
                [first + 2 * p * f(p, s, 2, 0) + r * mixed, p * mixed + second + 2 * r * f(p, s, 0, 2)],
            ]
        if self.stated.damping is None:
            return [f(p, s, 0, 0), f(p, s, 0, 1)], [[f(p, s, 1, 0), f(p, s, 0, 1)], [f(p, s, 1, 1), 2 * f(p, s, 0, 2)]]
        a, b = ball(self.alpha), ball(self.beta)
        lam = acb(0, x)
        below = 1 + a * lam
        F, F_p, F_s = f(p, s, 0, 0), f(p, s, 1, 0), f(p, s, 0, 1)
        by_P = F_p / below
        by_x = acb(0, 1) * (F_p * (-a * p / below) + F_s * (-(2 * lam + b) - a * s) / below)
        return [F.real, F.imag], [[by_P.real, by_x.real], [by_P.imag, by_x.imag]]

    def crossing(self) -> list[arb]:
        """Where it is, by Krawczyk's test in the box of the file; and that it is an onset."""
        P = ball(self.low).union(ball(self.high))
        if not self.flutter:
            box = Box(self.F, P, arb(0))
            R = self.R
            at = [box.value(x, arb(0), 0, R) for x in (ball(self.low), ball(self.high))]
            slope = box.value(P, arb(0), 1, R)
            require(v.opposite(*at) and not slope.contains(0), "there is no crossing in the interval, or more than one")
            require(bool(slope * box.value(P, arb(0), 0, R + 1) > 0), "s does not fall through zero there")
            return [P]
        assert self.stated.square is not None
        square = ball(self.stated.square[0]).union(ball(self.stated.square[1]))
        x = square if self.stated.damping is None or self.limit else square.sqrt()
        X = [P, x]
        p, s = (side + (side - side.mid()) / 8 for side in self.place(P, x))
        box = Box(self.F, p, s)
        middle = [side.mid() for side in X]
        value, J = self.system(box.value, *X)
        value = self.system(box.value, *middle)[0]
        image = krawczyk(X, middle, value, J)
        inside = image is not None and all(a.contains_interior(b) for a, b in zip(X, image, strict=True))
        require(inside, "there is no crossing in the interval, or more than one")
        p, s = self.place(*X)
        F_p, F_s = box.value(p, s, 1, 0), box.value(p, s, 0, 1)
        if self.stated.damping is None:
            onset = F_p * box.value(p, s, 0, 2)
        elif self.limit:
            slope = -F_p / F_s
            onset = (
                p
                * -2
                * (box.value(p, s, 2, 0) + box.value(p, s, 1, 1) * slope + box.value(p, s, 0, 2) * slope * slope)
                / F_s
            )
        else:
            by_P, by_x = (acb(J[0][k], J[1][k]) for k in (0, 1))
            onset = (by_P * by_x.conjugate()).imag
        require(bool(onset > 0), "stability is not lost there")
        assert image is not None
        return [side.intersection(part) for side, part in zip(X, image, strict=True)]

    # ------------------------------------------------------------ real eigenvalues

    def sign(self, low: arb, high: arb, s: arb) -> int:
        """Of F(P, s), at s = 0 of F / s^R, for all P of an interval."""
        R, P = self.R if s.is_zero() else 0, low.union(high)
        value = Box(self.F, P, s, R).value(P, s, 0, R)
        return 1 if value > 0 else -1 if value < 0 else 0

    def alternate(self, low: arb, high: arb, points: list[Fraction], moving: int | None) -> list[int]:
        """The signs at the points, each other than the last; that of a moving one follows from the others."""
        where = f"between the loads {float(low):.10g} and {float(high):.10g}"
        require(bool(ball(points[-1]) < self.top), "the last point is beyond the line that is free")
        signs = [0 if k == moving else self.sign(low, high, ball(x)) for k, x in enumerate(points)]
        known = next(k for k in range(len(points)) if k != moving)
        wanted = [signs[known] * (-1) ** (k - known) for k in range(len(points))]
        right = all(s != 0 and s == w for k, (s, w) in enumerate(zip(signs, wanted, strict=True)) if k != moving)
        require(right, f"F is not known to change sign from each point to the next {where}")
        return wanted

    def stretches(self, stretches: list[Any], crossing: list[arb]) -> None:
        """Theorem 1 on [0, P*), of the limit on [0, P*]."""
        reached = Fraction(0)
        moves = not (self.limit and self.flutter)
        require(bool(stretches), "there are no stretches")
        for n, (start, end, points, moving, slope) in enumerate(stretches):
            require(start == reached < end, "the stretches leave a gap")
            reached, last = end, moves and n == len(stretches) - 1
            require((moving is not None) == last, "a point moves that should not, or does not where it should")
            with flint.ctx.workprec(BITS):
                low, high = ball(start), ball(self.high if last else end)
                wanted = self.alternate(low, high, points, moving)
            if last:
                self._last(low, points, moving, ball(slope), wanted[moving], crossing)
        require(self.low <= reached if moves else self.high <= reached, "stability is not shown up to the load")

    def _last(
        self, low: arb, points: list[Fraction], moving: int, slope: arb, wanted: int, crossing: list[arb]
    ) -> None:
        """F on the line through the crossing has the wanted sign below it: its derivative has the other."""
        P_, s_ = crossing[0], crossing[1] if self.flutter else arb(0)
        require((moving > 0) == self.flutter, "another point moves than the crossing's")
        R = 0 if self.flutter else self.R
        ends = [s_ + slope * (P - P_) for P in (low, P_)]
        if self.flutter:
            between = all(ball(points[moving - 1]) < x < ball(points[moving + 1]) for x in ends)
            require(between, "the line through the crossing does not stay between its neighbours")
        waiting = [(low, P_.upper(), 0)]
        while waiting:
            a, b, depth = waiting.pop()
            P = a.union(b)
            s = s_ + slope * (P - P_) if self.flutter else arb(0)
            with flint.ctx.workprec(BITS):
                box = Box(self.F, P, s)
                value = box.value(P, s, 1, R)
                if self.flutter:
                    value += slope * box.value(P, s, 0, 1)
            if bool(value * wanted < 0):
                continue
            require(depth < 8, "the sign of F is not known on the line through the crossing")
            middle = P.mid()
            waiting += [(a, middle, depth + 1), (middle, b, depth + 1)]

    def no_divergence(self) -> None:
        """F(P, 0) / s^R is not zero below the crossing."""
        waiting = [(Fraction(0), self.high)]
        while waiting:
            a, b = waiting.pop()
            low, high = ball(a), ball(b)
            if self.sign(low, high, arb(0)):
                continue
            if not self.flutter and b == self.high:
                P, R = low.union(high), self.R
                box = Box(self.F, P, arb(0))
                if not box.value(P, arb(0), 1, R).contains(0):
                    continue
            require(b - a > self.high / 2**14, "F(P, 0) is not known to differ from zero")
            waiting += [(a, (a + b) / 2), ((a + b) / 2, b)]

    # ------------------------------------------------------------ cells

    def cells(self, lines: Lines, crossing: list[arb]) -> None:
        """No other zero for 0 ≤ P ≤ high and x up to where none can be."""
        top, power = self.top.upper(), 4
        if not self.limit:
            power, bounds = 2, []
            a, b, P = ball(self.alpha), ball(self.beta), ball(self.high)
            rest = 1 - a * b - a * a * self.top
            if rest > 0:
                bounds.append((self.top / rest).sqrt().upper())
            spare = 1 / arb(2).sqrt() - lines.norm(0, 0)
            if self.alpha > 0 and spare > 0:
                bounds.append(((P * lines.norm(1, 0) / spare).max(arb(1)) / a).upper())
            require(bool(bounds), "no bound of the frequency is known")
            top = min(bounds, key=float)
        count = max(1, int(float(top) ** (1 / power)) + 1)
        edges = [top * (arb(k) / count) ** power for k in range(count)] + [top]
        for low, high in pairwise(edges):
            for P in _halves(arb(0).union(ball(self.high))):
                self._tile(P, low.union(high), crossing, 0)

    def _tile(self, P: arb, x: arb, crossing: list[arb], cuts: int) -> None:
        around = [side + (side - side.mid()) / 1024 for side in (P, x)]
        waiting, count = [(P, x)], 0
        self.boxes += 1
        require(self.boxes <= MOST_BOXES, "it would take too long to exclude other crossings")
        try:
            box = Box(self.F, *self.place(*around))
        except ArithmeticError:
            count = MOST_CELLS
        while waiting and count < MOST_CELLS:
            P_, x_ = waiting.pop()
            count += 1
            axis = self._excluded(box, P_, x_, crossing)
            if axis is not None:
                waiting += [(h, x_) if axis == 0 else (P_, h) for h in _halves(P_ if axis == 0 else x_)]
        if waiting:
            require(cuts < MOST_CUTS, f"another crossing could be near the load {float(P):.6g}")
            for half in _halves(P):
                for other in _halves(x):
                    self._tile(half, other, crossing, cuts + 1)

    def _excluded(self, box: Box, P: arb, x: arb, crossing: list[arb]) -> int | None:
        """None where a cell holds no zero but the crossing, else along which axis it is cut."""
        bottom = not x.lower() > 0
        if bottom and self.R:
            p, s = self.place(P, x)
            s = s.union(0 * s)  # F / s^R is in the hull of ∂^R F / ∂s^R / R! from 0 to s
            total = Box(self.F, p, s).value(p, s, 0, self.R)
            return None if not total.contains(0) else (0 if P.rad() > ball(self.high) / 64 else 1)
        X = [P, x]
        middle = [side.mid() for side in X]
        over, J = self.system(box.value, *X)
        if any(not y.contains(0) for y in over):
            return None
        at = self.system(box.value, *middle)[0]
        parts = [[J[i][j] * (X[j] - middle[j]) for j in (0, 1)] for i in (0, 1)]
        if any(not (at[i] + parts[i][0] + parts[i][1]).contains(0) for i in (0, 1)):
            return None
        if bottom and not self.limit and not J[1][1].contains(0):
            return None
        if self.flutter and all(side.overlaps(c) for side, c in zip(X, crossing, strict=True)):
            hull = [side.union(c) for side, c in zip(X, crossing, strict=True)]
            centre, whole_J = self.system(box.value, *(h.mid() for h in hull))[1], self.system(box.value, *hull)[1]
            if one_to_one(centre, whole_J, [h.rad() for h in hull]):
                return None
        else:
            image = krawczyk(X, middle, at, J)
            if image is not None and any(not side.overlaps(part) for side, part in zip(X, image, strict=True)):
                return None
        size = [
            sum(float(abs(parts[i][j]).upper()) / (float(abs(at[i]).upper()) + 1e-300) for i in (0, 1)) for j in (0, 1)
        ]
        return 0 if size[0] >= size[1] else 1


def _halves(side: arb) -> tuple[arb, arb]:
    middle = side.mid()
    return side.lower().union(middle), middle.union(side.upper())


def _inverse(J: list[list[arb]]) -> list[list[arb]] | None:
    (a, b), (c, d) = J
    det = a * d - b * c
    return None if det.contains(0) else [[d / det, -b / det], [-c / det, a / det]]


def krawczyk(X: list[arb], middle: list[arb], at: list[arb], J: list[list[arb]]) -> list[arb] | None:
    """The image of a box: it holds every zero that the box holds."""
    Y = _inverse([[x.mid() for x in row] for row in J])
    if Y is None:
        return None
    found = []
    for i in (0, 1):
        total = middle[i] - sum((Y[i][k] * at[k] for k in (0, 1)), arb(0))
        for j in (0, 1):
            rest = int(i == j) - sum((Y[i][k] * J[k][j] for k in (0, 1)), arb(0))
            total += rest * (X[j] - middle[j])
        found.append(total)
    return found


def one_to_one(centre: list[list[arb]], over: list[list[arb]], radii: list[arb]) -> bool:
    """Whether no two points of a box have equal values."""
    Y = _inverse(centre)
    if Y is None:
        return False
    for i in (0, 1):
        total = arb(0)
        for j in (0, 1):
            rest = int(i == j) - sum((Y[i][k] * over[k][j] for k in (0, 1)), arb(0))
            total += abs(rest) * radii[j]
        if not total < radii[i]:
            return False
    return True
