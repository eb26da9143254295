"""z' = A(x) z by Taylor steps in balls, with what is left out bounded, and truncated Taylor polynomials as matrices.

Along a segment L D + N z = 0, where D are the highest derivatives of the fields, one equation each, and z the fields
with their lower ones. A step sums z(x + h) = Σ z_n hⁿ up to n < N. If ‖A‖ ≤ a on the disc of radius ρ > h about x in
the complex plane, then ‖z‖ ≤ ‖z_0‖ e^(aρ) there, by Grönwall's lemma along its radii, ‖z_n‖ ≤ ‖z_0‖ e^(aρ) / ρⁿ by
Cauchy's, and

    ‖Σ_{n ≥ N} z_n hⁿ‖ ≤ ‖z_0‖ e^(aρ) (h/ρ)^N / (1 − h/ρ).

The norm is the largest |z_i| / w_i. With L = L_0 (1 + R) and ‖R‖ ≤ q < 1 on the disc, ‖D‖ ≤ ‖L_0⁻¹ N‖ ‖z‖ / (1 − q),
which gives a. Derivatives with respect to P and s are carried along as truncated Taylor polynomials in u and v: their
coefficients obey a system of the same kind, a larger one, so that the same proof holds for them.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from fractions import Fraction
from itertools import permutations
from typing import Any, NamedTuple

import flint
from flint import acb, acb_mat, arb, arb_mat, arb_poly, arb_series

from freebeam_derive.certify.balls import Unproven, array, ball, exact, one, precision

Order = tuple[int, ...]
Jet = list[Any]
"""A polynomial in u and v (and w), truncated: balls in the order of the `orders` of its `Jets`."""

_LEAST = 36  # a step is not below 2^-36 of its segment: there the leading coefficients are taken to vanish
_COUPLED = (
    16  # the norm of A couples derivatives to lower ones at 1/16 of its size: they cost little, in a and in weights
)
WIDE, WRITTEN_OUT = 1.01, 3  # of a ball's ends; rows of a determinant, of which 3 take six products


class Jets:
    """Polynomials in u and v truncated to some orders, with P + u and s + v among them; where orders are of three, in w
    too, which stands for a damping that vanishes, times λ.

    orders: with each all lower ones. is_complex: whether coefficients are complex balls.
    """

    def __init__(self, P: Any, s: Any, orders: Sequence[Order], is_complex: bool) -> None:
        none = (0,) * len(next(iter(orders), (0, 0)))
        self.orders = sorted({none, *orders}, key=lambda order: (sum(order), order))
        self.place = {order: t for t, order in enumerate(self.orders)}
        self.P, self.s = P, s
        self.ball: Any = acb if is_complex else arb
        self.matrix: Any = acb_mat if is_complex else arb_mat
        self.one: Jet = [self.ball(int(t == 0)) for t in range(len(self.orders))]
        # (a, b, t): the order a times the order b is the order t
        self.products = [
            (a, b, self.place[both])
            for a, one in enumerate(self.orders)
            for b, other in enumerate(self.orders)
            if (both := tuple(i + k for i, k in zip(one, other, strict=True))) in self.place
        ]
        self._monomials: dict[Order, Jet] = {}

    def monomial(self, k: int, m: int, d: int = 0) -> Jet:
        """(P + u)^k (−s − v)^m w^d; w is nothing where orders are of two."""
        if (k, m, d) not in self._monomials:
            self._monomials[k, m, d] = [
                math.comb(k, i) * _power(self.P, k - i) * (math.comb(m, j) * (-1) ** j * _power(-self.s, m - j))
                if i <= k and j <= m and sum(of_w) == d
                else self.ball(0)
                for i, j, *of_w in self.orders
            ]
        return self._monomials[k, m, d]

    def times(self, one: Jet, other: Jet) -> Jet:
        found = [self.ball(0)] * len(self.orders)
        for a, b, t in self.products:
            found[t] += one[a] * other[b]
        return found

    def inverse(self, one: Jet) -> Jet:
        """1 / one, whose first coefficient must not hold zero."""
        found = [1 / one[0]]
        for t in range(1, len(self.orders)):
            rest = sum((one[a] * found[b] for a, b, target in self.products if target == t and b < t), self.ball(0))
            found.append(-found[0] * rest)
        return found

    def whole(self, entries: Mapping[tuple[int, int], Jet], rows: int, columns: int) -> Any:
        """The matrix that multiplies vectors of jets by a matrix of jets; its blocks are in the order of the orders."""
        size = len(self.orders)
        flat: list[Any] = [0] * (size * rows * size * columns)
        for (i, j), jet in entries.items():
            for a, b, t in self.products:
                flat[(t * rows + i) * size * columns + b * columns + j] = jet[a]
        return self.matrix(size * rows, size * columns, flat)

    def inverted(self, matrix: Any, count: int) -> Any:
        """The inverse of what `whole` makes of count × count jets, order by order.

        The inverse of balls would blur each order by the widths of all others. Raises ZeroDivisionError.
        """
        size = matrix.ncols()
        flat = matrix.entries()
        L = [
            self.matrix(count, count, [flat[(t * count + i) * size + j] for i in range(count) for j in range(count)])
            for t in range(len(self.orders))
        ]
        found = [L[0].inv()]
        for t in range(1, len(self.orders)):
            rest = self.matrix(count, count)
            for a, b, target in self.products:
                if target == t and b < t:
                    rest = rest + L[a] * found[b]
            found.append(-(found[0] * rest))
        entries = {(i, j): [X[i, j] for X in found] for i in range(count) for j in range(count)}
        return self.whole(entries, count, count)

    def entries(self, matrix: Any, rows: int) -> dict[tuple[int, int], Jet]:
        """The jets of a matrix whose rows are blocks by the orders."""
        columns, flat = matrix.ncols(), matrix.entries()
        return {
            (i, j): [flat[(t * rows + i) * columns + j] for t in range(len(self.orders))]
            for i in range(rows)
            for j in range(columns)
        }

    def determinant(self, rows: list[dict[int, Jet]]) -> Jet:
        """The determinant of a square matrix, whose rows are {column: jet}.

        Eliminated while an entry is known not to vanish; what is left, of the rank that is lost, is written out. So are
        the last rows of wide balls, which quotients by one would make wider by far; narrow ones are taken first.
        """
        rows, columns, total = [dict(row) for row in rows], list(range(len(rows))), self.one
        while found := [(_narrow(jet[0]), i, j) for i, row in enumerate(rows) for j, jet in row.items()]:
            (narrow, size), i, j = max(found)
            if not size > 0 or (not narrow and len(rows) <= WRITTEN_OUT):
                break
            pivot = rows.pop(i)
            sign = (-1) ** (i + columns.index(j))
            columns.remove(j)
            total = self.times(total, [sign * v for v in pivot[j]])
            unit = self.inverse(pivot.pop(j))
            for row in rows:
                if j in row:
                    factor = self.times(row.pop(j), unit)
                    for column, value in pivot.items():
                        more = self.times(factor, value)
                        had = row.get(column)
                        row[column] = (
                            [-v for v in more] if had is None else [h - v for h, v in zip(had, more, strict=True)]
                        )
        return self.times(total, self._written_out(rows, columns))

    def _written_out(self, rows: list[dict[int, Jet]], columns: list[int]) -> Jet:
        if len(rows) > 6:
            raise Unproven("rounding hides the determinant of the conditions")
        total = [self.ball(0)] * len(self.orders)
        for order in permutations(range(len(rows))):
            if all(columns[j] in row for row, j in zip(rows, order, strict=True)):
                turned = sum(order[a] > order[b] for b in range(len(order)) for a in range(b))
                value = self.one
                for row, j in zip(rows, order, strict=True):
                    value = self.times(value, row[columns[j]])
                total = [v + (-1) ** turned * w for v, w in zip(total, value, strict=True)]
        return total


class Term(NamedTuple):
    """A term of an equation: factor(x) P^k (−s)^m w^d times the p-th derivative of a field; row: its own field."""

    row: int
    field: int
    p: int
    m: int
    k: int
    factor: Any  # balls, ascending in powers of x, or a function of x
    d: int = 0


class Segment:
    """z' = A z between two breaks. sizes: the orders of the fields' equations."""

    def __init__(self, terms: Sequence[Term], sizes: Sequence[int], jets: Jets) -> None:
        self.terms, self.sizes, self.jets = terms, sizes, jets
        self.width, self.count = sum(sizes), len(sizes)
        self.begin = [sum(sizes[:n]) for n in range(len(sizes))]
        self.tops = [begin + size - 1 for begin, size in zip(self.begin, sizes, strict=True)]
        self.smooth = all(not callable(term.factor) for term in terms)
        self.uniform = self.smooth and all(len(term.factor) == 1 for term in terms)

    def carry(self, low: Fraction, high: Fraction, z: Any) -> Any:
        """z at `high` from z at `low`, jets of all of it by the unknowns, (orders · width, columns)."""
        step = None
        while low < high:
            if step is None or not self.uniform:
                local = Local(self, low)
                radius, reach = local.plan(high - low)
                if self.uniform:  # steps of one size, which are one matrix
                    reach = (high - low) / math.ceil((high - low) / reach)
                step = local.step(reach, radius)
                whole = self.jets.whole(self.jets.entries(step, self.width), self.width, self.width)
            z, low = whole * z, low + reach
        return z

    def start(self) -> Any:
        """z of unit values of the unknowns."""
        rows = len(self.jets.orders) * self.width
        return self.jets.matrix(rows, self.width, [int(i == j) for i in range(rows) for j in range(self.width)])

    def raised(self, z: Any, highest: Any) -> Any:
        """z', from z and the highest derivatives."""
        below, above = (m.entries() for m in (z, highest))
        flat, width, above_next = [], self.width, 0
        for i in range(z.nrows()):
            if (i % width) in self.tops:
                flat += above[above_next : above_next + width]
                above_next += width
            else:
                flat += below[(i + 1) * width : (i + 2) * width]
        return self.jets.matrix(z.nrows(), width, flat)


class Local:
    """A segment's equations about a place, and a step from there."""

    def __init__(self, segment: Segment, place: Fraction) -> None:
        self.segment, self.jets, self.place = segment, segment.jets, place
        N, L = self._blocks([factor[0] for factor in self._factors(1)])
        try:
            self.inverse = self.jets.inverted(L, segment.count)
        except ZeroDivisionError:
            raise Unproven(f"the leading coefficients at x = {float(place):.6g} are not known to be regular") from None
        self.weights = self._weights(self.inverse * N)
        self.norms: list[tuple[arb, arb]] = []
        if segment.smooth:
            self.norms = [(self._norm(N), self._norm(L)) for N, L in self._operators(1)]

    # ------------------------------------------------------------ the equations

    def _factors(self, count: int) -> list[list[Any]]:
        """The factors of all terms in powers of the distance, whole where they are polynomials, else so many."""
        here = exact(self.place)
        found: list[list[Any]] = []
        before = flint.ctx.cap
        flint.ctx.cap = count + 1
        try:
            for term in self.segment.terms:
                if callable(term.factor):
                    series: Any = one(term.factor(array([arb_series([here, 1])])))
                    found.append([series[q] for q in range(count)])
                else:
                    found.append(arb_poly(term.factor)(arb_poly([here, 1])).coeffs() or [arb(0)])
        except (ZeroDivisionError, ValueError):
            raise Unproven(f"a factor of the equations at x = {float(self.place):.6g} is not finite") from None
        finally:
            flint.ctx.cap = before
        return found

    def _blocks(self, values: Sequence[Any]) -> tuple[Any, Any]:
        """N and L where the factors of the terms have these values."""
        lower: dict[tuple[int, int], Jet] = {}
        highest: dict[tuple[int, int], Jet] = {}
        for term, value in zip(self.segment.terms, values, strict=True):
            leads = term.p == self.segment.sizes[term.field]
            place = term.row, term.field if leads else self.segment.begin[term.field] + term.p
            entries = highest if leads else lower
            more = [value * w for w in self.jets.monomial(term.k, term.m, term.d)]
            had = entries.get(place)
            entries[place] = more if had is None else [v + w for v, w in zip(had, more, strict=True)]
        count = self.segment.count
        return self.jets.whole(lower, count, self.segment.width), self.jets.whole(highest, count, count)

    def _operators(self, count: int) -> list[tuple[Any, Any]]:
        """L_0⁻¹ N and L_0⁻¹ L by the powers of the distance: all of polynomials, else so many."""
        factors = self._factors(count)
        found = []
        for q in range(max(map(len, factors))):
            blocks = self._blocks([factor[q] if q < len(factor) else arb(0) for factor in factors])
            found.append((self.inverse * blocks[0], self.inverse * blocks[1]))
        return found

    # ------------------------------------------------------------ the bound

    def _weights(self, operator: Any) -> list[int]:
        """log2 of the weights of z, in the order of its rows: such that the norm of A is small.

        Of one order they are about Perron's vector of |A|; of derivatives they are greater.
        """
        size, width, count = len(self.jets.orders), self.segment.width, self.segment.count
        sizes = [_float(v) for v in operator.entries()]
        top = {at: n for n, at in enumerate(self.segment.tops)}

        def row(t: int, n: int) -> list[float]:
            begin = (t * count + n) * size * width
            return sizes[begin : begin + width]

        A = [row(0, top[i]) if i in top else [float(j == i + 1) for j in range(width)] for i in range(width)]
        A = [[v + 1e-3 for v in line] for line in A]  # so that there is such a vector
        w = [1.0] * width
        for _ in range(40):
            w = [math.sqrt(v * _times(line, w)) for v, line in zip(w, A, strict=True)]
            w = [v / max(w) for v in w]
        norm = max(_times(line, w) / v for v, line in zip(w, A, strict=True))
        apart = 1.0
        for t, order in enumerate(self.jets.orders):
            if t:
                coupled = max(_times(row(t, n), w) / w[at] for at, n in top.items())
                apart = max(apart, (_COUPLED * coupled / norm) ** (1 / sum(order)))
        return [round(math.log2(v)) + round(sum(o) * math.log2(apart)) for o in self.jets.orders for v in w]

    def _of_highest(self) -> list[int]:
        """log2 of the weights of the highest derivatives: those of the rows of z' that they are."""
        width, tops = self.segment.width, self.segment.tops
        return [self.weights[t * width + top] for t in range(len(self.jets.orders)) for top in tops]

    def _norm(self, operator: Any) -> arb:
        """Of what gives the highest derivatives from z or from themselves."""
        of_rows = self._of_highest()
        of_columns = self.weights if operator.ncols() > operator.nrows() else of_rows
        flat, width, largest = operator.entries(), operator.ncols(), arb(0)
        for i, w in enumerate(of_rows):
            total = arb(0)
            for v, u in zip(flat[i * width : (i + 1) * width], of_columns, strict=True):
                if not v.is_zero():
                    total += abs(v).upper() * arb(2) ** (u - w)
            largest = largest.max(total.upper())
        return largest

    def size(self, radius: arb) -> arb | None:
        """a ≥ ‖A‖ on the disc of a radius; None where none is known."""
        if self.segment.smooth:
            lower = sum((n * radius**q for q, (n, _) in enumerate(self.norms)), arb(0))
            changed = sum((n * radius**q for q, (_, n) in enumerate(self.norms) if q), arb(0))
        else:
            here = exact(self.place)
            disc = array([acb(ball(here, radius), ball(arb(0), radius))])
            values = []
            for term, factor in zip(self.segment.terms, self._factors(1), strict=True):
                if callable(term.factor):
                    values.append(one(term.factor(disc)))
                else:
                    rest = sum((abs(c) * radius**q for q, c in enumerate(factor) if q), arb(0))
                    values.append(factor[0] + acb(ball(arb(0), rest), ball(arb(0), rest)))
            N, L = self._blocks(values)
            unit = acb_mat(L.nrows(), L.nrows(), [int(i == j) for i in range(L.nrows()) for j in range(L.nrows())])
            lower, changed = self._norm(self.inverse * N), self._norm(self.inverse * L - unit)
        if not changed < 0.5:
            return None
        a = (lower / (1 - changed)).upper()
        for i in range(self.segment.width):  # rows that say that the next one is the derivative
            if i not in self.segment.tops:
                a = a.max(arb(2) ** (self.weights[i + 1] - self.weights[i]))
        return a if a.is_finite() else None

    def remainder(self, size: arb, radius: arb, reach: arb, terms: int) -> arb:
        """Bound of ‖Σ_{n ≥ terms} z_n reachⁿ‖ / ‖z_0‖, where ‖A‖ ≤ size on the disc of the radius."""
        ratio = reach / radius
        return ((size * radius).exp() * ratio**terms / (1 - ratio)).upper()

    # ------------------------------------------------------------ a step

    def plan(self, ahead: Fraction) -> tuple[arb, Fraction]:
        """Radius of the disc and size of a step, at most `ahead`, that cost least; the bound holds for any."""
        bits, best, found = flint.ctx.prec, math.inf, None
        for k in range(4, -_LEAST, -1):
            radius, reach = exact(ahead * Fraction(2) ** k).upper(), min(ahead, ahead * Fraction(2) ** (k - 2))
            size = self.size(radius)
            if size is None or not size * radius < bits / 3:  # or the terms are large and cancel
                continue
            cost = self._terms(size, radius, reach) / float(reach / ahead)
            if cost >= best:
                break
            best, found = cost, (radius, reach)
        if found is None:
            where = f"x = {float(self.place):.6g}"
            raise Unproven(f"the balls are too wide for a step at {where}, or the leading coefficients vanish near it")
        return found

    def _terms(self, size: arb, radius: arb, reach: Fraction) -> int:
        """How many terms are likely to be needed."""
        lost = _float(size * radius) / math.log(2)
        return 4 + math.ceil((flint.ctx.prec + lost) / math.log2(_float(radius) / float(reach)))

    def step(self, reach: Fraction, radius: arb, terms: int | None = None) -> Any:
        """z at `reach` from unit values here, jets of it, (orders · width, width), with what is left out."""
        size = self.size(radius)
        h = exact(reach)
        if size is None or not h < radius:
            raise Unproven(f"no bound is known for a step of {float(reach):.6g} at x = {float(self.place):.6g}")
        count = self._terms(size, radius, reach) if terms is None else terms
        with precision(flint.ctx.prec + math.ceil(1.5 * _float(size * h)) + 16):  # terms may be larger than the sum
            total = self._sum(count, h)
        left_out = self.remainder(size, radius, h, count)
        width, w = self.segment.width, self.weights
        errors: list[Any] = [ball(arb(0), left_out * arb(2) ** (of - w[j])) for of in w for j in range(width)]
        if self.jets.matrix is acb_mat:
            errors = [acb(error, error) for error in errors]
        return total + self.jets.matrix(len(w), width, errors)

    def _sum(self, count: int, h: arb) -> Any:
        """The first terms of z: D_n from all before, and z_(n+1) from D_n and z_n."""
        segment, z = self.segment, self.segment.start()
        of_lower, of_highest = zip(
            *((-N * h**q, -L * h**q) for q, (N, L) in enumerate(self._operators(count))), strict=True
        )
        total, every = z, [z]
        highest: list[Any] = []
        for n in range(count - 1):
            D = of_lower[0] * z
            for q in range(1, min(n + 1, len(of_lower))):
                D = D + of_lower[q] * every[n - q] + of_highest[q] * highest[n - q]
            highest.append(D)
            z = segment.raised(z, D) * (h / (n + 1))
            every.append(z)
            total = total + z
        return total


def _power(value: Any, exponent: int) -> Any:
    """Of a ball that may hold zero, of which flint's own powers are not finite."""
    return math.prod([value] * exponent, start=arb(1))


def _narrow(value: Any) -> tuple[bool, float]:
    """Whether a ball is far from zero beside its width, and how far it is at least."""
    low = abs(value).lower()
    return bool(abs(value).upper() < WIDE * low), float(low)


def _times(row: Sequence[float], column: Sequence[float]) -> float:
    return sum(a * b for a, b in zip(row, column, strict=True))


def _float(value: Any) -> float:
    """An upper bound of a ball's size, for estimates. Raises Unproven where there is none."""
    bound = abs(value).upper()
    if not bound < 1e200:
        raise Unproven("the balls grew without bound")
    return float(bound)
