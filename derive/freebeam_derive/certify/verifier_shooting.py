"""F(p, s) of the beam itself for the verifier: four solutions by power series, all conditions in one determinant.

Of the verifier of certificates of the beam itself (`verifier_of_beam`); it shares no code with the prover. The series'
coefficients are polynomials in p and s, so F is one polynomial for all boxes and a rest, which docs/theorem.md bounds;
`verifier_boxes` has it on a box. Of a range of a parameter τ₀ + t δ, |t| ≤ 1, they are polynomials in t too.
"""

from __future__ import annotations

import math
from fractions import Fraction
from itertools import combinations, zip_longest
from math import factorial, perm
from typing import Any, NamedTuple

import flint
from flint import arb, arb_mat, arb_poly

from freebeam_derive.certify.verifier_claims import ORDERS, Form, ball, greatest, require

Table = dict[Any, list[Fraction]]  # place -> [part without load, the load's part]; then what these grow by with t
Rows = list[arb_poly]  # for each power of s − s₀ a polynomial in p/P
# of t; what is beyond is in the rest. At least as many as there are conditions. With 3, a dead load over 10 % and a
# weight over 1 % in one piece are refused
POWERS = 4


# --- functions of p and s ------------------------------------------------------------------------------------------


class Part(NamedTuple):
    """A function where |p| ≤ P, |s − s₀| ≤ S, |t| ≤ 1: Σ c_ljk t^l (p/P)^j ((s − s₀)/S)^k and at most `rest`.

    levels: for each l ≤ POWERS and each k a polynomial in p/P. size: no less than Σ |c_ljk| θ^l over all l.
    """

    levels: list[Rows]
    size: arb
    rest: arb = arb(0)

    def plus(self, other: Part, factor: Any = 1) -> Part:
        f = arb(factor)
        size, rest = (a + abs(f) * b for a, b in ((self.size, other.size), (self.rest, other.rest)))
        return Part(added(self.levels, other.levels, f), size.upper(), rest.upper())

    def times(self, other: Part, most: int, powers: int = POWERS) -> Part:
        """most: so many powers of s − s₀ are kept; powers: so many of t."""
        levels: list[Rows] = [[] for _ in range(min(powers + 1, max(0, len(self.levels) + len(other.levels) - 1)))]
        for k, first in enumerate(self.levels):
            for n, second in enumerate(other.levels[: max(0, len(levels) - k)], k):
                levels[n] = combined(levels[n], _product(first, second, most), arb(1))
        (a, b), (e, g) = (self.size, other.size), (self.rest, other.rest)
        return Part(levels, (a * b).upper(), (a * g + e * b + e * g).upper())

    def short(self, share: arb | int = 0) -> Part:
        """Without coefficients below the precision, or below a share of the size, which go to the rest."""
        least, rest, levels = self.size * arb(share).max(arb(2) ** (-8 - flint.ctx.prec)), self.rest, []
        for level in self.levels:
            rows: Rows = []
            for row in level:
                c = row.coeffs()
                while c and abs(c[-1]) < least:
                    rest += abs(c.pop())
                rows.append(arb_poly(c))
            while rows and rows[-1].length() == 0:
                rows.pop()
            levels.append(rows)
        while levels and not levels[-1]:
            levels.pop()
        return Part(levels, self.size, rest.upper())


NOTHING = Part([], arb(0))


def combined(a: Rows, b: Rows, factor: arb) -> Rows:
    """Rows of a + factor · b."""
    both = [x + factor * y for x, y in zip(a, b, strict=False)]
    return both + a[len(both) :] + [factor * y for y in b[len(both) :]]


def added(a: list[Rows], b: list[Rows], factor: arb) -> list[Rows]:
    """Levels of a + factor · b."""
    none: Rows = []
    return [combined(x, y, factor) for x, y in zip_longest(a, b, fillvalue=none)]


def _in_line(rows: Rows, width: int) -> arb_poly:
    """One polynomial with row n at the powers from n · width on: one product of such is that of all rows."""
    line: list[arb] = []
    for n, row in enumerate(rows):
        line += [arb(0)] * (n * width - len(line)) + row.coeffs()
    return arb_poly(line)


def _product(a: Rows, b: Rows, most: int) -> Rows:
    count = min(most, max(0, len(a) + len(b) - 1))
    width = 1 + sum(max((row.length() for row in rows), default=0) for rows in (a, b))
    c = (_in_line(a, width) * _in_line(b, width)).coeffs()
    return [arb_poly(c[n * width : (n + 1) * width]) for n in range(count)]


# --- the equation, its conditions, and their determinant -------------------------------------------------------------


class Shooting:
    """F(p, s) of y'''' + … = s y with natural conditions, from ends and forms E = ∫ y'' v'' + …, H. Raises Refused.

    moved: what E and H grow by with t, over a range of a parameter.
    """

    ranged = False

    def __init__(self, ends: list[str], E: Form, H: Form, moved: tuple[Form, ...] = ()) -> None:
        self.ranged, none = bool(moved), [Fraction(0)] * (2 + len(moved))
        self.terms: Table = {}  # (order d, power k) of x^k y^(d)
        free = [(e, d) for e in (0, 1) for d in (0, 1) if d not in ORDERS[ends[e]]]
        rows: dict[tuple[int, int], Table] = {}
        for e, d in free:  # ∫ y'' v'' = [y'' v'] − [y''' v] + ∫ y'''' v
            sign = 2 * e - 1
            rows[e, d] = {(e, 3 - d): [Fraction(sign if d else -sign), *none[1:]]}

        def add(table: Table, key: Any, which: int, value: Fraction) -> None:
            table.setdefault(key, [*none])[which] += value

        for which, (along, points) in enumerate((E, H, *moved)):
            for k, i, j, f in along:
                if (which, k, i, j) == (0, 0, 2, 2) and f == 1:
                    continue
                require(i < 2 and j < 2, "a form acts on curvatures")
                if i == 0:
                    add(self.terms, (j, k), which, f)
                    continue
                add(self.terms, (j + 1, k), which, -f)
                if k:
                    add(self.terms, (j, k - 1), which, -k * f)
                for e in (0, 1):
                    if (e, 0) in rows and (e == 1 or k == 0):
                        add(rows[e, 0], (e, j), which, f * (2 * e - 1))
            for a, i, b, j, f in points:
                require(i < 2 and j < 2, "a form acts on curvatures")
                if (a, i) in rows:
                    add(rows[a, i], (b, j), which, f)
        held = [{(e, d): [Fraction(1), *none[1:]]} for e in (0, 1) for d in ORDERS[ends[e]] if d < 2]
        # those of x = 0 alone are first: of them a determinant has few minors
        self.conditions = sorted([*held, *rows.values()], key=lambda row: max(e for e, _ in row))
        self._known: dict[tuple[Any, ...], Whole] = {}

    def on(self, p: arb, s: arb) -> Whole:
        """F where |p| and |s| are at most so large, and somewhat beyond, at the precision in force."""
        P, S = (base ** math.ceil(math.log(float(size), base)) for size, base in ((p, 4), (s, 16)))
        key = flint.ctx.prec, P, S
        if key not in self._known:
            self._known[key] = self.whole(arb(P), arb(0), arb(S), 2000)
        return self._known[key]

    def at(self, p: arb, s: arb, order: int) -> Whole:
        """F where |p| is at most so large, and somewhat beyond, and so many derivatives at one s."""
        P = 2 ** math.ceil(math.log2(float(p)))
        key = flint.ctx.prec, P, s.mid().man_exp(), order
        if key not in self._known:
            self._known[key] = self.whole(arb(P), s, arb(1), order + 1)
        return self._known[key]

    def whole(self, P: arb, s: arb, S: arb, most: int) -> Whole:
        return Whole(self, P, s, S, most)


class Whole:
    """F where |p| ≤ P, |s − s₀| ≤ S and |t| ≤ 1: Σ C_ljk t^l (p/P)^j ((s − s₀)/S)^k and at most `rest`. most: so many
    powers of s − s₀ are known. Raises ArithmeticError where the series could not be bounded."""

    def __init__(self, shooting: Shooting, P: arb, s: arb, S: arb, most: int) -> None:
        self.P, self.s, self.S, self._most = P, s, S, most
        size, bits = (abs(s) + S).upper(), flint.ctx.prec
        if not (size < 1e10 and P < 1e5):
            raise ArithmeticError("the power series is too long")
        # more bits, for large terms cancel: they decide how sharp F is, no more
        self.precision = bits + 64 + int(3 * (float(size) ** 0.25 + float(P) ** 0.5))
        with flint.ctx.workprec(self.precision):
            self._terms = [(d, k, [*map(ball, parts)]) for (d, k), parts in shooting.terms.items()]
            self._conditions, self._ends = shooting.conditions, dict[int, list[Part]]()
            self._theta, beyond = self._how_far(size)
            self._share = beyond / 1024  # too small to matter beside that
            norms = [(d, k, self._norm(parts)) for d, k, parts in self._terms] + [(0, 0, size)]
            self._sizes, self._tails = majorants(norms, bits)
            self._by_p = arb_poly([0, P])
            F = self._determinant().short(self._share)
            self.rest = (F.rest + beyond * F.size).upper()
            J = max(row.length() for rows in F.levels for row in rows)
            K = max(map(len, F.levels))
            self.levels = [
                arb_mat([[rows[k][j] if k < len(rows) else arb(0) for k in range(K)] for j in range(J)])
                for rows in F.levels
            ]

    def _norm(self, parts: list[arb]) -> arb:
        """Of f + g p + (f' + g' p) t where |p| ≤ P, |t| ≤ θ."""
        sizes = [abs(f) + abs(g) * self.P for f, g in zip(parts[::2], parts[1::2], strict=True)]
        return sizes[0] + sum((self._theta * size for size in sizes[1:]), arb(0))

    def _how_far(self, size: arb) -> tuple[arb, arb]:
        """θ ≥ 1, any will do; and what part of F's size the powers of t beyond have."""
        self._theta = arb(1)
        if all(f.is_zero() for _, _, parts in self._terms for f in parts[2:]):
            return arb(1), arb(0)  # F is linear in each of four conditions, and these in t
        orders = [(d, float(self._norm(parts[:2])), float(self._norm(parts[2:]))) for d, _, parts in self._terms]

        def part(theta: float) -> float:
            """The logarithm of F's size times θ^(−POWERS−1), about, with solutions of the size exp x."""
            x = 1.0
            for _ in range(40):
                x = (float(size) + sum((f + theta * g) * x**d for d, f, g in orders)) ** 0.25
            return 2 * x - (POWERS + 1) * math.log(theta)

        theta = arb(min((2.0**k for k in range(1, 40)), key=part))
        return theta, theta ** (-POWERS - 1)

    def _determinant(self) -> Part:
        """By minors of the first two conditions and the last two (Laplace)."""
        total = NOTHING
        for a, b in combinations(range(4), 2):
            c, d = (k for k in range(4) if k not in (a, b))
            upper = self._minor(0, 1, a, b)
            if not upper.size.is_zero():
                total = total.plus(self._times(upper, self._minor(2, 3, c, d)), (-1) ** (a + b + 1))
        return total

    def _minor(self, i: int, j: int, a: int, b: int) -> Part:
        one, other = (self._times(self._on(i, x), self._on(j, y)) for x, y in ((a, b), (b, a)))
        return one.plus(other, -1)

    def _times(self, one: Part, other: Part) -> Part:
        return one.times(other, self._most)

    def _on(self, condition: int, r: int) -> Part:
        """A condition on the solution x^r + …"""
        total = NOTHING
        for (e, d), parts in self._conditions[condition].items():
            if e == 0 and d != r:
                continue
            value = self._at_one(r)[d] if e else Part([[arb_poly([factorial(d)])]], arb(factorial(d)))
            f = [*map(ball, parts)]
            factor = Part([[arb_poly([a, b * self.P])] for a, b in zip(f[::2], f[1::2], strict=True)], self._norm(f))
            total = total.plus(self._times(value, factor.short(self._share)))
        return total

    def _at_one(self, r: int) -> list[Part]:
        if r not in self._ends:
            self._ends[r] = self._solution(r)
        return self._ends[r]

    def _solution(self, r: int) -> list[Part]:
        """Derivatives 0 to 3 at x = 1 of the solution Σ a_n x^n = x^r + …"""
        count = len(self._sizes[r])
        a: list[list[Rows]] = [[[arb_poly([1])]] if n == r else [] for n in range(4)]
        for n in range(count - 4):
            still: list[Rows] = []
            load: list[Rows] = []
            for d, k, parts in self._terms:
                if n < k:
                    continue
                source, factor = a[n - k + d], perm(n - k + d, d)
                for power, (f, g) in enumerate(zip(parts[::2], parts[1::2], strict=True)):
                    moved = [*[[]] * power, *source][: POWERS + 1] if source else []
                    still = still if f.is_zero() else added(still, moved, f * factor)
                    load = load if g.is_zero() else added(load, moved, g * factor)
            total = added(still, [[row * self._by_p for row in rows] for rows in load], arb(1))
            total = added(total, a[n], -self.s)
            total = added(total, [([arb_poly([]), *rows] if rows else [])[: self._most] for rows in a[n]], -self.S)
            inverse = arb(-1) / perm(n + 4, 4)
            a.append([[row * inverse for row in rows] for rows in total])
        found = []
        for d in range(4):
            levels: list[Rows] = []
            for n in range(d, count):
                levels = added(levels, a[n], arb(perm(n, d)))
            size = sum((perm(n, d) * self._sizes[r][n] for n in range(d, count)), arb(0))
            found.append(Part(levels, size.upper(), self._tails[r][d]).short(self._share))
        return found


def majorants(
    norms: list[tuple[int, int, arb]], bits: int, base: arb | int = 2
) -> tuple[list[list[arb]], list[list[arb]]]:
    """Of each of the four solutions: bounds of ‖a_n‖ up to where they are nothing, and of what all later terms add to
    derivatives 0 to 3 at x = 1. norms: (d, k, that of the factor of x^k y^(d)), where that of y^(4) is 1 at x = 0.
    base: by which coefficients fall from there on."""
    reach = max(4 + k - d for d, k, _ in norms)
    sizes = [[arb(int(n == r)) for n in range(4)] for r in range(4)]
    last = 3
    while True:
        n, last = last - 3, last + 1
        for of_one in sizes:
            total = sum((c * perm(n - k + d, d) * of_one[n - k + d] for d, k, c in norms if n >= k), arb(0))
            of_one.append((total / perm(last, 4)).upper())
        # from here on each coefficient is at most 1/base of the largest of those before, see docs/theorem.md
        share = sum((c * base ** (4 + k - d) / perm(last + 1 - d, 4 - d) for d, k, c in norms), arb(0))
        top = [greatest(s[last - i] * arb(base) ** -i for i in range(min(reach, last))) for s in sizes]
        if last > 20 and share <= 1 and all(x < arb(2) ** (-bits - 8) for x in top):
            break
        if last > 2000:
            raise ArithmeticError("the power series does not end")
    rests = [perm(last + 1, d) / arb(base) / (1 - (last + 2) / (arb(base) * (last + 2 - d))) for d in range(4)]
    return sizes, [[(x * rest).upper() for rest in rests] for x in top]
