"""F(p, s) of a column of variable or stepped section for the verifier: power series on pieces, joined by conditions.

Of the verifier of certificates of the beam itself (`verifier_of_sections`); it shares no code with the prover. On a
piece x = x₀ + hξ the equation has factors that are polynomials in ξ; pieces are so short that the series in ξ fall.
Where segments meet, y and y' go on but at joints, and the two natural conditions give y'' and y''' on the other side.
"""

from __future__ import annotations

import math
from fractions import Fraction
from math import factorial, perm
from typing import Any

import flint
from flint import arb, arb_mat, arb_poly, fmpq_poly

from freebeam_derive.certify.verifier_claims import ORDERS, ball, exact
from freebeam_derive.certify.verifier_damping import Damped
from freebeam_derive.certify.verifier_sections import Sections
from freebeam_derive.certify.verifier_shooting import NOTHING, Part, Rows, Shooting, Whole, added, majorants

BASE = arb(5) / 4  # by which coefficients fall at least, once enough are known
# of 1, for the part of EI that changes on a piece; the rest is for what falls with n. F of a cone, to 128 bits, takes
# 24 s with 3/4, 11 with 3/10 and 10 with 3/20
ROOM = Fraction(3, 10)
MOST_POWERS = 2000  # of s and of q: all that are not too small to count are kept
Factor = tuple[Fraction, Fraction, Fraction, Fraction]
"""What is there without load, the load's part, the mass, and what is left of damping: a + p b − s c + q r."""


class Pieces(Shooting):
    """F(p, s) of a column; with what damping leaves of its form, F(p, s, q) with q = λ/(1 + c_E λ), |q|² ≤ |s|."""

    def __init__(self, column: Sections, left: Damped | None = None) -> None:
        self.column, self.left = column, left
        self._known = {}
        self.pieces = [[*_cut(column, left, n)] for n in range(len(column.m))]
        last = len(column.m)
        rows = [_natural(column, left, node, d) for node in (0, last) for d in (0, 1) if not column.held((node, d))]
        held = [
            {(e, d): (Fraction(1), Fraction(0), Fraction(0), Fraction(0))}
            for e in (0, 1)
            for d in ORDERS[column.ends[e]]
            if d < 2
        ]
        at_ends = [{(int(side > 0), d): f for (side, d), f in row.items()} for row in rows]
        self.rows = sorted([*held, *at_ends], key=lambda row: max(e for e, _ in row))

    def whole(self, P: arb, s: arb, S: arb, most: int) -> Whole:
        return OfPieces(self, P, S)

    def on(self, p: arb, s: arb) -> Whole:
        """What is known already where it goes so far: a series takes as long as many boxes on it."""
        for (bits, P, S), whole in self._known.items():
            if bits == flint.ctx.prec and p <= P and s <= S:
                return whole
        return super().on(p, s)

    def ready(self, p: arb, s: arb) -> None:
        """A series up to there and no further, which then serves all that is asked of less at this precision."""
        P, S = (math.nextafter(float(size.upper()), math.inf) for size in (p, s))
        key = flint.ctx.prec, P, S
        if key not in self._known:
            self._known[key] = self.whole(arb(P), arb(0), arb(S), 2000)

    def at(self, p: arb, s: arb, order: int) -> Whole:
        """At one s the same as near all: F is one polynomial."""
        return self.on(p, abs(s) + 1)


def _cut(column: Sections, left: Damped | None, n: int) -> Any:
    """Pieces of a segment: their length h, and (d, k) -> factor of ξ^k y^(d) in their equation."""
    x, end = column.breaks[n : n + 2]
    while x < end:
        h = end - x
        while True:
            table = _equation(column, left, n, x, h)
            lead = abs(table[4, 0][0])
            rest = sum(
                (abs(f) * Fraction(5, 4) ** k / lead for (d, k), (f, *_) in table.items() if d == 4 and k), Fraction(0)
            )
            if rest <= ROOM:
                break
            h = h * 3 / 4
        yield h, table
        x += h


def _equation(column: Sections, left: Damped | None, n: int, x: Fraction, h: Fraction) -> dict[tuple[int, int], Factor]:
    found: dict[tuple[int, int], list[Fraction]] = {}
    local = fmpq_poly([exact(x), exact(h)])

    def add(f: fmpq_poly, i: int, j: int, which: int) -> None:
        """∫ f v^(i) y^(j) dx, by parts (−1)^i (f y^(j))^(i)."""
        f = f(local)
        for r in range(i + 1):  # by the product's rule
            g, factor = f, Fraction(math.comb(i, r) * (-1) ** i)
            for _ in range(r):
                g = g.derivative()
            for k in range(g.degree() + 1):
                c = Fraction(int(g[k].p), int(g[k].q)) * factor * h ** (1 - i - j)
                found.setdefault((j + i - r, k), [Fraction(0)] * 4)[which] += c

    add(column.EI[n], 2, 2, 0)
    add(column.m[n], 0, 0, 2)
    for order, f in column.elastic[n].items():
        add(f, order, order, 0)
    for (i, j), f in column.load[n].items():
        add(f, i, j, 1)
    for order, f in left.along[n].items() if left else ():
        add(f, order, order, 3)
    return {key: (a, b, c, r) for key, (a, b, c, r) in found.items() if a or b or c or r}


def _natural(column: Sections, left: Damped | None, node: int, order: int) -> dict[tuple[int, int], Factor]:
    """The factor of v^(order) at a break, which is nothing: (side, derivative of y) -> factor.

    side: −1 for x = 0 or the segment on the right of a break, 1 for the one on its left, and for x = 1.
    """
    found: dict[tuple[int, int], list[Fraction]] = {}
    last, x = len(column.m), exact(column.breaks[node])

    def add(side: int, d: int, which: int, f: Any) -> None:
        value = f if isinstance(f, Fraction) else Fraction(int(f.p), int(f.q))
        found.setdefault((side, d), [Fraction(0)] * 4)[which] += value

    for side, n in ((1, node - 1), (-1, node)):
        if not 0 <= n < last:
            continue
        EI = column.EI[n]
        if order:
            add(side, 2, 0, side * EI(x))
            continue
        add(side, 3, 0, -side * EI(x))
        add(side, 2, 0, -side * EI.derivative()(x))
        for j, f in column.elastic[n].items():
            if j == 1:
                add(side, 1, 0, side * f(x))
        for (i, j), f in column.load[n].items():
            if i == 1:
                add(side, j, 1, side * f(x))
        if left and 1 in left.along[n]:
            add(side, 1, 3, side * left.along[n][1](x))
    here = -1 if node == 0 else 1
    for which, table in ((0, column.springs), (2, column.masses), (3, left.points if left else {})):
        if (node, order) in table:
            add(here, order, which, table[node, order])
    for ((a, i), (b, j)), force in column.forces.items():
        if (a, i) == (node, order):
            add(here if b == a else 1 if b else -1, j, 1, force)
    return {key: (a, b, c, r) for key, (a, b, c, r) in found.items()}


class OfPieces(Whole):
    """F where |p| ≤ P, |s| ≤ S, |q| ≤ Q: Σ C_ljk (q/Q)^l (p/P)^j (s/S)^k and at most `rest`.

    P may be nothing. Q is twice what |q| is on the axis.
    """

    def __init__(self, pieces: Pieces, P: arb, S: arb) -> None:
        self.P, self.s, self.S, self.Q = P, arb(0), S, 2 * S.sqrt()
        if pieces.left and pieces.left.c_E:
            self.Q = self.Q.min(2 / ball(pieces.left.c_E))
        bits = flint.ctx.prec
        if not (S < arb(10) ** 11 and P < 1e5):
            raise ArithmeticError("the power series is too long")
        stiff = max(
            abs(float(f[2] / t[4, 0][0])) * float(S) for row in pieces.pieces for _, t in row for f in t.values()
        )
        waves = sum(stiff**0.25 for row in pieces.pieces for _ in row) + float(P) ** 0.5
        # more bits, for large terms cancel: they decide how sharp F is, no more
        self.precision = bits + 64 + int(3 * waves)
        with flint.ctx.workprec(self.precision):
            self._rows, self._ends, self._pieces, self._bits = pieces.rows, {}, pieces, bits
            self._matrices: dict[tuple[int, int], list[list[Part]]] = {}
            F = self._determinant().short()
            self.rest = F.rest
            self.levels = [_matrix(rows) for rows in F.levels or [[]]]

    def _times(self, one: Part, other: Part) -> Part:
        return one.times(other, MOST_POWERS, MOST_POWERS).short()

    def _linear(self, factor: Factor) -> Part:
        a, b, c, r = map(ball, factor)
        rows = [arb_poly([a, -c * self.S])] + ([arb_poly([b * self.P])] if factor[1] else [])
        levels = [rows] + ([[arb_poly([r * self.Q])]] if factor[3] else [])
        return Part(levels, (abs(a) + abs(b) * self.P + abs(c) * self.S + abs(r) * self.Q).upper())

    def _on(self, condition: int, r: int) -> Part:
        total = NOTHING
        for (e, d), factor in self._rows[condition].items():
            if e == 0 and d != r:
                continue
            part = self._linear(factor)
            total = total.plus(self._times(part, self._at_one(r)[d]) if e else part)
        return total

    def _at_one(self, r: int) -> list[Part]:
        """Derivatives 0 to 3 at x = 1 of the solution with y^(r)(0) = 1, and the others nothing there."""
        if r not in self._ends:
            unit = Part([[arb_poly([1])]], arb(1))
            state = [unit if d == r else NOTHING for d in range(4)]
            for n, row in enumerate(self._pieces.pieces):
                if n:
                    state = self._across(n, state)
                for k in range(len(row)):
                    state = self._applied(self._carrying(n, k), state)
            self._ends[r] = state
        return self._ends[r]

    def _applied(self, matrix: list[list[Part]], state: list[Part]) -> list[Part]:
        found = []
        for line in matrix:
            total = NOTHING
            for a, x in zip(line, state, strict=True):
                if not (x.size.is_zero() or a.size.is_zero()):
                    total = total.plus(self._times(a, x))
            found.append(total)
        return found

    def _across(self, node: int, state: list[Part]) -> list[Part]:
        """All on the right of a break: y'' and y''' by its natural conditions; jumps, each by what the left side feels
        over the joint's spring."""
        column, found = self._pieces.column, state[:2]
        rows = [_natural(column, self._pieces.left, node, order) for order in (0, 1)]
        for (at, order), k in column.joints.items():
            for (side, q), factor in rows[order].items() if at == node else ():
                if side > 0:
                    found[order] = found[order].plus(self._times(self._linear(factor), state[q]), 1 / ball(k))
        for order, d in ((1, 2), (0, 3)):
            row = rows[order]
            total, lead = NOTHING, ball(row[-1, d][0])
            for (side, q), factor in row.items():
                if (side, q) == (-1, d):
                    continue
                part = self._times(self._linear(factor), (state if side > 0 else found)[q])
                total = total.plus(part, -1 / lead)
            found.append(total)
        return found

    def _carrying(self, n: int, k: int) -> list[list[Part]]:
        """Derivatives by x at the right end of a piece of the solutions of one derivative at its left end."""
        if (n, k) not in self._matrices:
            h, table = self._pieces.pieces[n][k]
            columns = self._solutions(table)
            self._matrices[n, k] = [
                [NOTHING.plus(columns[r][d], ball(h ** (r - d) / factorial(r))) for r in range(4)] for d in range(4)
            ]
        return self._matrices[n, k]

    def _solutions(self, table: dict[tuple[int, int], Factor]) -> list[list[Part]]:
        """Derivatives 0 to 3 by ξ at ξ = 1 of ξ^r + …, r = 0, …, 3."""
        lead = table[4, 0][0]
        terms = [
            (d, k, ball(a / lead), ball(b / lead) * self.P, ball(c / lead) * self.S, ball(r / lead) * self.Q)
            for (d, k), (a, b, c, r) in table.items() if (d, k) != (4, 0)
        ]  # fmt: skip
        norms = [(d, k, sum(map(abs, parts), arb(0)).upper()) for d, k, *parts in terms]
        sizes, tails = majorants(norms, self._bits, BASE)
        found = []
        for r in range(4):
            count = len(sizes[r])
            a: list[list[Rows]] = [[[arb_poly([1])]] if n == r else [] for n in range(4)]
            for n in range(count - 4):
                total: list[Rows] = []
                for d, k, still, load, mass, left in terms:
                    if n < k or not a[n - k + d]:
                        continue
                    source, factor = a[n - k + d], perm(n - k + d, d)
                    if mass.is_zero():
                        total = total if still.is_zero() else added(total, source, still * factor)
                    else:
                        line = arb_poly([still * factor, -mass * factor])
                        total = added(total, [[row * line for row in rows] for rows in source], arb(1))
                    if not load.is_zero():
                        total = added(total, [[arb_poly([]), *rows] for rows in source], load * factor)
                    if not left.is_zero():
                        total = added(total, [[], *source], left * factor)
                inverse = arb(-1) / perm(n + 4, 4)
                a.append([[row * inverse for row in rows] for rows in total])
            at_one = []
            for d in range(4):
                levels: list[Rows] = []
                for n in range(d, count):
                    levels = added(levels, a[n], arb(perm(n, d)))
                size = sum((perm(n, d) * sizes[r][n] for n in range(d, count)), arb(0))
                at_one.append(Part(levels, size.upper(), tails[r][d]).short())
            found.append(at_one)
        return found


def _matrix(rows: Rows) -> arb_mat:
    """A row for each power of p, a column for each of s."""
    K = max((row.length() for row in rows), default=1)
    return arb_mat([[row[k] for k in range(K)] for row in rows or [arb_poly([0])]])
