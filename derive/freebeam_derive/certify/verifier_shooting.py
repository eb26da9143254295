"""F(p, s) of the beam itself for the verifier: four solutions by power series, all conditions in one determinant.

Of the verifier of certificates of the beam itself (`verifier_of_beam`); it shares no code with the prover. Coefficients
are polynomials in the distance from a centre. docs/theorem.md has the bound of what a series leaves out.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from itertools import combinations
from math import comb, factorial, perm
from typing import Any

import flint
from flint import acb, acb_poly, arb, arb_poly

from freebeam_derive.certify import verifier as v
from freebeam_derive.certify.verifier import ball, require

DEGREE = 14
Table = dict[Any, list[Fraction]]  # place -> [part without load, the load's part]


# --- polynomials in the distance from a centre, cut off ------------------------------------------------------------


class Polynomials:
    """Σ c_ij u^i v^j, p = centre + units[0] u, s = centre + units[1] v, a polynomial in v for each power of u; lengths:
    how many powers of v are kept with each, never more than with the one before."""

    def __init__(self, p: Any, s: Any, units: tuple[arb, arb], lengths: Sequence[int]) -> None:
        complex_ = isinstance(p, acb) or isinstance(s, acb)
        self.poly: Any = acb_poly if complex_ else arb_poly
        self.lengths, self._p, self._units = list(lengths), p, units
        self._s = self.poly([s, units[1]])
        self._sizes = abs(p).upper() + units[0], abs(s).upper() + units[1]
        self.zero = [self.poly([0])] * len(self.lengths)

    def constant(self, value: Any) -> list[Any]:
        return [self.poly([value]), *self.zero[1:]]

    def times(self, rows: list[Any], which: int) -> list[Any]:
        """By p (0) or s (1)."""
        if which:
            return [(row * self._s).truncate(n) for row, n in zip(rows, self.lengths, strict=True)]
        found = [row * self._p for row in rows]
        moved = (row.truncate(n) * self._units[0] for row, n in zip(rows, self.lengths[1:], strict=False))
        return [found[0], *(row + other for row, other in zip(found[1:], moved, strict=True))]

    def product(self, a: list[Any], b: list[Any]) -> list[Any]:
        found = []
        for i, n in enumerate(self.lengths):
            total = self.zero[0]
            for k in range(i + 1):
                total += a[k].truncate(n) * b[i - k].truncate(n)
            found.append(total.truncate(n))
        return found

    def norm(self, rows: list[Any]) -> arb:
        return sum((abs(c).upper() for row in rows for c in row.coeffs()), arb(0)).upper()

    def sizes(self) -> tuple[arb, arb]:
        """Norms of p and s."""
        return self._sizes[0].upper(), self._sizes[1].upper()

    def blurred(self, rows: list[Any], error: arb) -> list[Any]:
        """With an error of so much in every coefficient."""
        blur = arb(0, error.upper())
        of_all = acb(blur, blur) if self.poly is acb_poly else blur
        return [row + self.poly([of_all] * n) for row, n in zip(rows, self.lengths, strict=True)]


def plus(a: list[Any], b: list[Any], factor: Any = 1) -> list[Any]:
    scale = factor if isinstance(factor, arb) else arb(factor)
    return [x + y * scale for x, y in zip(a, b, strict=True)]


# --- the equation, its conditions, and their determinant -------------------------------------------------------------


class Shooting:
    """F(p, s) of y'''' + … = s y with natural conditions, from ends and forms E = ∫ y'' v'' + …, H. Raises Refused."""

    def __init__(self, ends: list[str], E: v.Form, H: v.Form) -> None:
        self.terms: Table = {}  # (order d, power k) of x^k y^(d)
        free = [(e, d) for e in (0, 1) for d in (0, 1) if d not in v.ORDERS[ends[e]]]
        rows: dict[tuple[int, int], Table] = {}
        for e, d in free:  # ∫ y'' v'' = [y'' v'] − [y''' v] + ∫ y'''' v
            sign = 2 * e - 1
            rows[e, d] = {(e, 3 - d): [Fraction(sign if d else -sign), Fraction(0)]}
        for which, (along, points) in enumerate((E, H)):
            for k, i, j, f in along:
                if (which, k, i, j) == (0, 0, 2, 2):
                    continue
                require(i < 2 and j < 2, "a form acts on curvatures")
                if i == 0:
                    _add(self.terms, (j, k), which, f)
                    continue
                _add(self.terms, (j + 1, k), which, -f)
                if k:
                    _add(self.terms, (j, k - 1), which, -k * f)
                for e in (0, 1):
                    if (e, 0) in rows and (e == 1 or k == 0):
                        _add(rows[e, 0], (e, j), which, f * (2 * e - 1))
            for a, i, b, j, f in points:
                require(i < 2 and j < 2, "a form acts on curvatures")
                if (a, i) in rows:
                    _add(rows[a, i], (b, j), which, f)
        held = [{(e, d): [Fraction(1), Fraction(0)]} for e in (0, 1) for d in v.ORDERS[ends[e]] if d < 2]
        self.conditions = [*held, *rows.values()]

    def values(self, P: Polynomials) -> list[Any]:
        """The coefficients of F. Raises ArithmeticError where the series could not be bounded."""
        solutions = [self._solution(P, r) for r in range(4)]
        rows = []
        for condition in self.conditions:
            row = []
            for ends in solutions:
                total = P.zero
                for place, (still, load) in condition.items():
                    value = ends[place]
                    if still:
                        total = plus(total, value, ball(still))
                    if load:
                        total = plus(total, P.times(value, 0), ball(load))
                row.append(total)
            rows.append(row)
        return _determinant(P, rows)

    def _solution(self, P: Polynomials, r: int) -> dict[tuple[int, int], list[Any]]:
        """Derivatives 0 to 3 at both ends of the solution x^r + …"""
        bits, sizes = flint.ctx.prec, P.sizes()
        terms = [(d, k, still, load) for (d, k), (still, load) in self.terms.items() if still or load]
        norms = [(d, k, abs(ball(still)) + abs(ball(load)) * sizes[0]) for d, k, still, load in terms]
        norms.append((0, 0, sizes[1]))
        reach = max(4 + k - d for d, k, _ in norms)
        a = [P.constant(arb(int(n == r))) for n in range(4)]
        quiet = 0
        while True:
            n = len(a) - 4
            of_still, of_load = P.zero, P.zero
            for d, k, still, load in terms:
                if n < k:
                    continue
                source, factor = a[n - k + d], perm(n - k + d, d)
                if still:
                    of_still = plus(of_still, source, ball(still) * factor)
                if load:
                    of_load = plus(of_load, source, ball(load) * factor)
            total = plus(plus(of_still, P.times(of_load, 0)), P.times(a[n], 1), -1)
            inverse = arb(-1) / perm(n + 4, 4)
            a.append([row * inverse for row in total])
            quiet = quiet + 1 if P.norm(a[-1]) < arb(2) ** (-bits - 8) else 0
            # from here on each coefficient is at most half of the largest of those before, see docs/theorem.md
            if quiet >= reach and len(a) > 12:
                last = len(a) - 1
                share = sum((c * 2 ** (4 + k - d) / perm(last + 1 - d, 4 - d) for d, k, c in norms), arb(0))
                if share <= 1:
                    break
            if len(a) > 4000:
                raise ArithmeticError("the power series does not end")
        last = len(a) - 1
        top = arb(0)
        for i in range(reach):
            top = top.max(P.norm(a[last - i]) * arb(2) ** -i)
        found = {}
        for d in range(4):
            found[0, d] = [row * arb(factorial(d)) for row in a[d]]
            total = P.zero
            for n in range(d, last + 1):
                total = plus(total, a[n], perm(n, d))
            rest = top * perm(last + 1, d) / 2 / (1 - arb(last + 2) / (2 * (last + 2 - d)))
            found[1, d] = P.blurred(total, rest)
        return found


def _add(table: Table, key: Any, which: int, value: Fraction) -> None:
    table.setdefault(key, [Fraction(0), Fraction(0)])[which] += value


def _determinant(P: Polynomials, rows: list[list[list[Any]]]) -> list[Any]:
    """Of four rows, by minors of the first two and the last two (Laplace)."""
    total = P.zero
    for a, b in combinations(range(4), 2):
        c, d = (k for k in range(4) if k not in (a, b))
        upper = plus(P.product(rows[0][a], rows[1][b]), P.product(rows[0][b], rows[1][a]), -1)
        lower = plus(P.product(rows[2][c], rows[3][d]), P.product(rows[2][d], rows[3][c]), -1)
        total = plus(total, P.product(upper, lower), (-1) ** (a + b + 1))
    return total


# --- F on a box ----------------------------------------------------------------------------------------------------


class Box:
    """F and its derivatives on a box of p and s: Taylor's polynomial, the last coefficients those on all of the box."""

    def __init__(self, shooting: Shooting, p: Any, s: Any, lengths: Sequence[int]) -> None:
        kind: Any = acb if isinstance(p, acb) or isinstance(s, acb) else arb
        # of a rectangle powers of u alone are summed, and derivatives by s are those on all of s
        whole = lengths[0] == lengths[-1]
        self._box, least = (kind(p), kind(s)), arb(2) ** -10
        self._centre = kind(p.mid()), kind(s) if whole else kind(s.mid())
        reach = abs(p - p.mid()).upper(), abs(s - s.mid()).upper()
        self._units = reach[0].max(least), reach[1].max(least)
        at, over = (shooting.values(Polynomials(*place, self._units, lengths)) for place in (self._centre, self._box))
        beyond = [*lengths[1:], 0]  # the last power of u with each power of v is what it is on the box
        rows = [[(at if j < beyond[i] else over)[i][j] for j in range(n)] for i, n in enumerate(lengths)]
        poly: Any = acb_poly if kind is acb else arb_poly
        # derivatives by v over j!, a polynomial in v for each power of u; of a rectangle the coefficient alone
        self._by_s = [
            [poly([row[j]]) if whole else poly([comb(b, j) * row[b] for b in range(j, len(row))]) for row in rows]
            for j in range(lengths[0] if whole else 3)
        ]

    def value(self, p: Any, s: Any, i: int = 0, j: int = 0) -> Any:
        """∂^{i+j} F / ∂p^i ∂s^j / (i! j!). Raises ArithmeticError outside of the box."""
        if not (self._box[0].contains(p) and self._box[1].contains(s)):
            raise ArithmeticError("a value was asked for outside of its box")
        u, w = ((x - c) / unit for x, c, unit in zip((p, s), self._centre, self._units, strict=True))
        total = 0 * u
        for a in range(len(self._by_s[j]) - 1, i - 1, -1):
            total = total * u + self._by_s[j][a](w) * comb(a, i)
        return total / (self._units[0] ** i * self._units[1] ** j)


def rectangle(of_s: int) -> list[int]:
    return [of_s + 1] * 7


def triangle(degree: int) -> list[int]:
    return [degree + 1 - i for i in range(degree + 1)]
