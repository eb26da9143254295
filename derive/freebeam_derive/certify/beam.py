"""The beam itself, without a Ritz series: its characteristic function F(p, s) as balls. Eqs. (6), (14), (15).

y(x, t) = Y(x) e^(λt) turns a column's equation of motion and its end conditions into

    (e + p h − s m) Y = 0        p = P / (1 + αλ),  s = −(λ² + βλ) / (1 + αλ)

with linear differential operators e (elastic), h (the load's), m (the mass's), whose coefficients are polynomials in
x and which are read off the emitted kernel. Two solutions satisfy the conditions at x = 0; F is the determinant of
the conditions at x = 1 on them. F is entire in p and s, and its zeros are the eigenvalues, for all damping of the
kind of Eq. (12).

The solutions are power series about x = 0, Y = Σ aₙ xⁿ. What is left out is bounded as follows. With c the
coefficients of (e + p h − s m), divided by the constant one of Y'''' (p here also counts derivatives),

    aₘ = −Σ c_{p,k} (m−d)(m−d−1)…(m−d−p+1) / (m (m−1)(m−2)(m−3)) · a_{m−d},    d = 4 + k − p ≥ 1,
    so |aₘ| ≤ Σ_d g_d(m) |a_{m−d}|,    g_d(m) = Σ |c_{p,k}| / ((m−p)…(m−3)),

and g_d falls as m grows. Let the series be cut after a_N, T = max of |a_{N−i}| 2^(−i) over i = 0 … d_max − 1. If
Σ_d g_d(N+1) 2^d ≤ 1 then |aₘ| ≤ T 2^(N−m) for all m > N − d_max: it holds up to N by the choice of T, and then by
induction, |aₘ| ≤ Σ g_d(m) T 2^(N−m+d) ≤ T 2^(N−m). The terms m (m−1)…(m−j+1) T 2^(N−m) of the bound for the j-th
derivative at x = 1 then shrink by the factor (N+2)/(N+2−j)/2 at least from one to the next beyond N + 1, which gives
a geometric sum. Derivatives with respect to p and s are carried along as truncated Taylor polynomials; the same
proof holds with the sum of the absolute coefficients in place of | |, for that norm is submultiplicative.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from functools import lru_cache
from inspect import signature
from itertools import combinations
from typing import Any, NamedTuple

import flint
from flint import acb, acb_mat, arb, arb_mat

from freebeam_derive.certify.balls import Exact, Unproven, exact, parameters, precision

Order = tuple[int, int]
Taylor = dict[Order, Any]
_Sources = list[tuple[int, arb_mat | None]]  # (block, how it is gathered from)
_Part = tuple[tuple[int, tuple[Any, ...]], ...]  # (d, factors of n!/(n−k)! for k = 0, 1, …)
_Terms = tuple[_Part, ...]  # of e, h, m and the slopes of e and h


Linear = tuple[Any, ...]  # constant, factor of u, factor of v, and of their products with a parameter the first two
_ZERO = arb(0)


class NoSeries(ValueError):
    """A column whose equation is not of the kind that the power series serves; the message says why."""


class Coefficient(NamedTuple):
    """One coefficient of e + p h − s m; e_t, h_t: the slopes of e and h in a parameter, of `parameter_series`."""

    e: arb
    h: arb
    m: arb
    e_t: arb = _ZERO
    h_t: arb = _ZERO

    def __bool__(self) -> bool:
        return not all(part.is_zero() for part in self)

    def at(self, p: Any, s: Any) -> Linear:
        """Value and slopes in p and s of e + p h − s m; where a parameter counts, the slopes of the first two in it."""
        value: Any = self.e
        if not self.h.is_zero():
            value = value + p * self.h
        if not self.m.is_zero():
            value = value - s * self.m
        if self.e_t.is_zero() and self.h_t.is_zero():
            return value, self.h, -self.m
        return value, self.h, -self.m, self.e_t + p * self.h_t, self.h_t


class _Parts(NamedTuple):
    """The operators at some precision.

    equation: (p, power of x) -> coefficient; left, right: two conditions each.
    """

    equation: dict[tuple[int, int], Coefficient]
    left: tuple[dict[int, Coefficient], ...]
    right: tuple[dict[int, Coefficient], ...]
    batches: _Batches


class Beam:
    """A column's characteristic function, at whatever precision is in force when it is asked.

    kernel: an emitted module, or anything that has its COLUMN, equation and end_conditions. own: the column's own
    parameters as rational numbers, defaults where left out. Raises NoSeries, and ValueError for unknown parameters.
    """

    def __init__(self, kernel: Any, own: Mapping[str, Fraction] | None = None) -> None:
        self.kernel = kernel
        self.name: str = kernel.COLUMN["name"]
        if kernel.COLUMN.get("general"):
            raise NoSeries(f"{self.name} goes beyond one equation of motion along one segment")
        self.rigid: int = kernel.COLUMN["rigid"]
        self.own = parameters(kernel, own)
        self._known: dict[int, _Parts] = {}
        self._damping: dict[tuple[int, Exact, Exact], tuple[arb, arb]] = {}
        self._one = "one" in signature(kernel.equation).parameters
        self._parts()

    # ---------------------------------------------------------------- what the kernel says

    def _tables(self, load: int, alpha: Any = 0, beta: Any = 0) -> list[Any]:
        """The equation, two conditions at x = 0, two at x = 1, as {(p, r): (balls of the powers of x)}."""
        own = {name: exact(value) for name, value in self.own.items()}
        if self._one:
            own["one"] = arb(1)  # what fractions that no float holds are made from
        arguments = (arb(load), arb(alpha), arb(beta))
        equation = {key: tuple(map(self._ball, row)) for key, row in self.kernel.equation(*arguments, **own).items()}
        ends = [
            [{key: (self._ball(value),) for key, value in row.items()} for row in end]
            for end in self.kernel.end_conditions(*arguments, **own)
        ]
        return [equation, *ends[0], *ends[1]]

    def _ball(self, value: Any) -> arb:
        if isinstance(value, float) and not (value * 2**20).is_integer():
            raise NoSeries(
                f"{self.name}: the coefficient {value!r} of its equation is a rounded number, not an exact one"
            )
        return arb(value)

    def _parts(self) -> _Parts:
        bits = flint.ctx.prec
        found = self._known.get(bits) or self._known.get(0)
        if found is not None:
            return found
        split = [self._split(*tables) for tables in zip(*(self._tables(load) for load in range(3)), strict=True)]
        lead = split[0].pop((4, 0), None)
        if lead is None or not (lead.h.is_zero() and lead.m.is_zero()) or any(p > 3 for p, _ in split[0]):
            raise NoSeries(f"{self.name}: the bending stiffness must be constant for the exact beam's power series")
        equation = {key: Coefficient(*(part / lead.e for part in c)) for key, c in split[0].items()}
        rows = [{p: c for (p, _), c in row.items()} for row in split[1:]]
        if len(rows) != 4:
            raise NoSeries(f"{self.name}: two conditions are needed at each end")
        found = _Parts(equation, tuple(rows[:2]), tuple(rows[2:]), _batches(equation))
        every = [*equation.values(), *(c for row in rows for c in row.values())]
        self._known[0 if all(part.is_exact() for c in every for part in c) else bits] = found
        return found

    def _split(self, at_0: Any, at_1: Any, at_2: Any) -> dict[tuple[int, int], Coefficient]:
        """One equation or condition: (p, power of x) -> coefficient, those that vanish left out."""
        found = {}
        for p, k in _places(at_1):
            e, one, two, m = (_entry(table, p, r, k) for table, r in ((at_0, 0), (at_1, 0), (at_2, 0), (at_1, 2)))
            if not (two - 2 * one + e).contains(0):
                raise NoSeries(f"{self.name}: its equation must be linear in the load P")
            coefficient = Coefficient(e, one - e, m)
            if coefficient:
                found[p, k] = coefficient
        return found

    def damping(self, alpha: Exact, beta: Exact) -> tuple[arb, arb]:
        """c_E and c_M of C = c_E E + c_M M, Eq. (12). Raises NoSeries for damping of another kind."""
        key = flint.ctx.prec, alpha, beta
        if key not in self._damping:
            self._damping[key] = self._read_damping(alpha, beta)
        return self._damping[key]

    def _read_damping(self, alpha: Exact, beta: Exact) -> tuple[arb, arb]:
        still, damped = self._tables(0), self._tables(0, exact(alpha), exact(beta))
        c_E = _entry(damped[0], 4, 1, 0) / _entry(still[0], 4, 0, 0)
        p, k = next((p, k) for (p, r), row in still[0].items() if r == 2 for k, v in enumerate(row) if v != 0)
        c_M = (_entry(damped[0], p, 1, k) - c_E * _entry(still[0], p, 0, k)) / _entry(still[0], p, 2, k)
        parts = self._parts()
        for n, (row, rates) in enumerate(zip(still, damped, strict=True)):
            loaded = n == 0 or any(not c.h.is_zero() for c in (*parts.left, *parts.right)[n - 1].values())
            if not loaded and not any(r for _, r in rates):
                continue  # a geometric condition, which may be multiplied by 1 + αλ
            for p, k in _places(rates):
                proportional = c_E * _entry(row, p, 0, k) + c_M * _entry(row, p, 2, k)
                if not (_entry(rates, p, 1, k) - proportional).contains(0):
                    raise NoSeries(f"{self.name}: its damping is not of the form C = beta M + alpha E")
        return c_E, c_M

    # ---------------------------------------------------------------- the characteristic function

    def undamped(self, alpha: Exact, beta: Exact) -> bool:
        """Whether F is a function of λ² at these dampings."""
        return alpha == beta == 0

    def pencil(self, P: Any, value: Any, alpha: Exact, beta: Exact) -> tuple[Any, Any, Any, Any, Any]:
        """p and s of an eigenvalue λ, their slopes in λ, and 1 / (1 + αλ), the slope of p in P."""
        c_E, c_M = self.damping(alpha, beta)
        inverse = 1 / (1 + c_E * value)
        p, s = P * inverse, -value * (value + c_M) * inverse
        return p, s, -p * c_E * inverse, -(2 * value + c_M + s * c_E) * inverse, inverse

    def taylor(self, p: Any, s: Any, orders: Sequence[Order]) -> Taylor:
        """Coefficients of F(p + u, s + v) in powers of u and v: (i, j) -> ball of ∂^{i+j}F/∂p^i∂s^j / (i! j!).

        p, s: balls, real (arb) or complex (acb). orders: the pairs (i, j) that are wanted, with every pair below each.
        Raises Unproven where the balls are so wide that the series could not be bounded.
        """
        jets = Jets(tuple(orders), isinstance(p, acb) or isinstance(s, acb))
        return dict(zip(jets.orders, self.expanded(p, s, jets).entries(), strict=True))

    def expanded(self, p: Any, s: Any, jets: Jets) -> Any:
        """The same as a row, for jets of any kind."""
        parts = self._parts()
        needed = tuple(sorted({derivative for row in parts.right for derivative in row}))
        values = self._ends(p, s, jets, needed)
        on = []  # conditions at x = 1 on both solutions
        for condition in parts.right:
            for k in range(2):
                total = None
                for derivative, c in condition.items():
                    value = jets.times(values[derivative][k], c.at(p, s))
                    total = value if total is None else total + value
                on.append(jets.zero() if total is None else total)
        return jets.product(on[0], on[3]) - jets.product(on[1], on[2])

    def trivial(self) -> int:
        """R of the factor s^R that the rigid motions put into F, which has no part in stability.

        The derivation shows that the rigid motions are not acted on by the elastic ones; should a lower power of s
        be seen not to vanish, it is that one.
        """
        t = self.taylor(arb(1) / 3, arb(0), tuple((0, j) for j in range(self.rigid + 1)))
        return next((j for j in range(self.rigid) if not t[0, j].contains(0)), self.rigid)

    def _start(self, p: Any, s: Any, jets: Jets) -> Any:
        """Derivatives 0 to 3 at x = 0 of two solutions of the conditions there, (4, 2 orders).

        Two of the four derivatives are free, the other two follow by Cramer's rule, with a determinant that depends
        neither on p nor on s: so no zero of F is lost or gained.
        """
        left, pivots = self._parts().left, self.pivots()
        (a, b), (c, d) = [[row.get(q, _NONE) for q in pivots] for row in left]
        determinant = a.e * d.e - b.e * c.e
        rows = [[jets.zero(), jets.zero()] for _ in range(4)]
        for k, q in enumerate(q for q in range(4) if q not in pivots):
            rows[q][k] = jets.row((arb(1), arb(0), arb(0)))
            if any(q in row for row in left):
                first, second = (jets.row(row.get(q, _NONE).at(p, s)) for row in left)
                above, beside, below, other = (entry.at(p, s) for entry in (a, b, c, d))
                rows[pivots[0]][k] = (jets.times(second, beside) - jets.times(first, other)) / determinant
                rows[pivots[1]][k] = (jets.times(first, below) - jets.times(second, above)) / determinant
        return jets.matrix(4, 2 * len(jets.orders), [e for both in rows for row in both for e in row.entries()])

    def pivots(self) -> tuple[int, int]:
        """Which two derivatives at x = 0 follow from the conditions there. Raises NoSeries."""
        left = self._parts().left
        for pivots in combinations((3, 2, 1, 0), 2):
            (a, b), (c, d) = [[row.get(q, _NONE) for q in pivots] for row in left]
            # every coefficient of a d − b c in p and s but the constant one
            n = len(a)
            others = [
                a[i] * d[j] + a[j] * d[i] - b[i] * c[j] - b[j] * c[i] for i in range(n) for j in range(max(i, 1), n)
            ]
            if not (a.e * d.e - b.e * c.e).contains(0) and all(other.is_zero() for other in others):
                return pivots
        raise NoSeries(f"{self.name}: the conditions at x = 0 do not determine two derivatives there")

    def _operators(self, p: Any, s: Any, jets: Jets) -> tuple[Any, ...]:
        """What the parts of the recurrence are multiplied by; None: by −1."""
        return None, jets.operator((-p, arb(-1), arb(0)), 2), jets.operator((s, arb(0), arb(1)), 2)

    def _ends(self, p: Any, s: Any, jets: Jets, needed: tuple[int, ...]) -> dict[int, list[Any]]:
        """Some derivatives at x = 1 of both solutions, as balls: derivative -> one (1, orders) for each solution."""
        parts = self._parts()
        norms = {}
        for key, c in parts.equation.items():
            norms[key] = sum((_upper(part) for part in jets.scaled(c.at(p, s))), arb(0)).upper()
        bits = flint.ctx.prec
        sizes = _sizes(norms, bits)
        batch = parts.batches
        count = -(-(len(sizes) - 4) // batch.size)
        operators = self._operators(p, s, jets)
        blocks = [self._start(p, s, jets)]
        try:
            for t, sources in enumerate(batch.first(count)):
                if t % 8 == 0:  # small terms need fewer bits
                    flint.ctx.prec = max(32, bits + 16 + min(0, sizes[4 + t * batch.size]))
                total = None
                for part, operator in zip(sources, operators, strict=False):
                    value = None
                    for u, gather in part:
                        product = blocks[u] if gather is None else gather * blocks[u]
                        value = product if value is None else value + product
                    if value is not None:
                        value = -value if operator is None else value * operator
                        total = value if total is None else total + value
                blocks.append(jets.matrix(batch.size, 2 * len(jets.orders)) if total is None else total)
        finally:
            flint.ctx.prec = bits
        J = len(jets.orders)
        sums = jets.matrix(len(needed), 2 * J)
        # one set of weights serves some numbers of terms and of bits
        weights = _weights(batch.size, -(-count // 32) * 32, -(-bits // 128) * 128, needed)
        for weight, block in zip(weights, blocks, strict=False):
            sums = sums + weight * block
        errors = _tail(norms, blocks, batch.size, needed)
        entries = (sums + jets.matrix([[jets.blur(error)] * (2 * J) for error in errors])).entries()
        return {
            derivative: [jets.matrix(1, J, entries[(2 * t + k) * J : (2 * t + k + 1) * J]) for k in range(2)]
            for t, derivative in enumerate(needed)
        }


class _Batches:
    """The recurrence of the coefficients bₙ = n! aₙ, which are the derivatives at x = 0, several terms at a time.

        bₙ₊₄ = −Σ c_{q,k} n!/(n−k)! b_{n−k+q}

    As many terms are found at once as do not need each other. They are gathered from earlier blocks for e, h and m
    apart, so that there are two products, by p and by s, whatever the axial force is. The matrices that gather depend
    on neither. Block 0 holds b₀ … b₃.
    """

    def __init__(self, terms: _Terms) -> None:
        self.size = min((d for part in terms for d, _ in part), default=4)
        self._terms = terms
        self._found: list[tuple[_Sources, ...]] = []

    def first(self, count: int) -> list[tuple[_Sources, ...]]:
        """For each of the first blocks after block 0, for each part: which blocks it is gathered from, and how."""
        while len(self._found) < count:
            begin = 4 + len(self._found) * self.size
            self._found.append(tuple(self._sources(terms, begin) for terms in self._terms))
        return self._found[:count]

    def _sources(self, terms: _Part, begin: int) -> _Sources:
        entries: dict[int, dict[tuple[int, int], Any]] = {}
        for row in range(self.size):
            n = begin + row - 4
            for d, factors in terms:
                factor = factors[-1]
                for k in range(len(factors) - 2, -1, -1):
                    factor = factor * (n - k) + factors[k]
                source = n + 4 - d
                if factor == 0 or source < 0:  # it is zero where n < k
                    continue
                block = 0 if source < 4 else 1 + (source - 4) // self.size
                place = source if source < 4 else (source - 4) % self.size
                entries.setdefault(block, {})[row, place] = factor
        found: _Sources = []
        for block, known in entries.items():
            columns = 4 if block == 0 else self.size
            same = columns == self.size and known == {(i, i): 1 for i in range(columns)}
            flat = [known.get((i, j), 0) for i in range(self.size) for j in range(columns)]
            found.append((block, None if same else arb_mat(self.size, columns, flat)))
        return found


_shared = lru_cache(maxsize=16)(_Batches)


def _batches(equation: Mapping[tuple[int, int], Coefficient]) -> _Batches:
    """Where all factors are whole numbers, what was built before for them serves again."""
    parts = []
    for part in range(len(_NONE)):
        terms: dict[int, list[Any]] = {}
        for (q, k), c in equation.items():
            if not c[part].is_zero():
                row = terms.setdefault(4 + k - q, [])
                row += [0] * (k + 1 - len(row))
                row[k] = int(str(c[part].unique_fmpz())) if c[part].is_integer() else c[part]
        parts.append(tuple((d, tuple(row)) for d, row in terms.items()))
    while len(parts) > 3 and not parts[-1]:
        parts.pop()  # slopes that there are none of, most often
    whole = all(isinstance(factor, int) for part in parts for _, row in part for factor in row)
    return (_shared if whole else _Batches)(tuple(parts))


class Jets:
    """Polynomials in u and v truncated to some orders, as rows of balls; to multiply is to apply a matrix."""

    def __init__(self, orders: tuple[Order, ...], is_complex: bool) -> None:
        self.orders = orders
        self.place = {order: t for t, order in enumerate(orders)}
        self.matrix: Callable[..., Any] = acb_mat if is_complex else arb_mat

    def zero(self) -> Any:
        return self.matrix(1, len(self.orders))

    def scaled(self, linear: Linear) -> Linear:
        """Constant, factor of u, factor of v, in the units that u and v are counted in."""
        return linear

    def product(self, first: Any, second: Any) -> Any:
        """Of two rows."""
        return first * self.operator(second)

    def blur(self, error: arb) -> Any:
        """The ball of so great an error."""
        return arb(0, error) if self.matrix is arb_mat else acb(arb(0, error), arb(0, error))

    def row(self, linear: Linear) -> Any:
        """The polynomial constant + u · first + v · second."""
        known = dict(zip(((0, 0), (1, 0), (0, 1)), linear, strict=True))
        return self.matrix(1, len(self.orders), [known.get(order, 0) for order in self.orders])

    def times(self, row: Any, linear: Linear) -> Any:
        """A row times constant + u · first + v · second."""
        value, first, second = linear
        if first.is_zero() and second.is_zero():
            return row if value == 1 else row * value
        return row * self.operator(linear)

    def operator(self, factor: Any, copies: int = 1) -> Any:
        """Multiplication by a row, or by (constant, factor of u, factor of v), of so many rows side by side."""
        if isinstance(factor, tuple):
            known = list(zip(((0, 0), (1, 0), (0, 1)), factor, strict=True))
        else:
            known = list(zip(self.orders, factor.entries(), strict=True))
        J = len(self.orders)
        width = copies * J
        entries: list[Any] = [0] * (width * width)
        for (i, j), value in known:
            for t, (a, b) in enumerate(self.orders):
                target = self.place.get((a + i, b + j))
                if target is not None:
                    for corner in range(0, width * width, J * (width + 1)):
                        entries[corner + t * width + target] = value
        return self.matrix(width, width, entries)


def _places(table: Any) -> list[tuple[int, int]]:
    """Every (order of ∂/∂x, power of x) there is."""
    return sorted({(p, k) for (p, _), row in table.items() for k in range(len(row))})


def _entry(table: Any, p: int, r: int, k: int) -> arb:
    row = table.get((p, r), ())
    return row[k] if k < len(row) else arb(0)


_NONE = Coefficient(_ZERO, _ZERO, _ZERO)


def _upper(ball: Any) -> arb:
    bound: arb = abs(ball).upper()
    return bound


def _sizes(norms: Mapping[tuple[int, int], arb], bits: int) -> list[int]:
    """How many terms to take, and about log2 |aₙ| of each.

    An estimate: what it decides is the number of terms and their bits. The error is bounded afterwards, in balls.
    """
    if not all(norm.is_finite() and norm < 1e100 for norm in norms.values()):
        raise Unproven("the balls are too wide for the series of the exact beam")
    rough = []
    for (q, k), norm in norms.items():
        mantissa, power = math.frexp(float(norm))
        rough.append((4 + k - q, q, math.ldexp(math.ceil(mantissa * 32), power - 5)))
    sizes = _majorant(tuple(rough), 1 << (bits - 1).bit_length())
    last = len(sizes)
    while last > 12 and sizes[last - 1] < -bits - 8:
        last -= 1
    while not _contracts(norms, last - 1) and last < len(sizes):
        last += 1
    return sizes[:last]


@lru_cache(maxsize=64)
def _majorant(plan: tuple[tuple[int, int, float], ...], bits: int) -> list[int]:
    """log2 of the bounds of |aₙ|, by their recurrence in floats, from (d, q, |c|), until they are below 2^-bits."""
    reach = max((d for d, *_ in plan), default=1)
    bound, sizes, scale, m = [0.0] * reach + [1.0] * 4, [0] * 4, 0, 4
    while True:
        fourth = 1.0 / (m - 3)
        third = fourth / (m - 2)
        second = third / (m - 1)
        inverse = (second / m, second, third, fourth)
        value = weight = 0.0
        for d, q, norm in plan:
            weight += 2.0**d * norm * inverse[q]
            value += norm * inverse[q] * bound[-d]
        if not 1e-100 < value < 1e100 and value:  # floats have only so many exponents
            shift = math.frexp(value)[1]
            scale += shift
            bound = [math.ldexp(v, -shift) for v in bound[-reach:]]
            value = math.ldexp(value, -shift)
        bound.append(value)
        size = scale + math.frexp(value)[1] if value else -bits - 9
        sizes.append(size)
        if size < -bits - 8 and weight < 0.99 and m > 8:
            return sizes
        m += 1


def _contracts(norms: Mapping[tuple[int, int], arb], last: int) -> bool:
    """Σ_d g_d(N+1) 2^d ≤ 1, which the tail bound stands on."""
    total = arb(0)
    for (q, k), norm in norms.items():
        total += norm * 2 ** (4 + k - q) / math.prod(last + 1 - i for i in range(q, 4))
    return bool(total <= 1)


def _tail(
    norms: Mapping[tuple[int, int], arb], blocks: list[Any], size: int, derivatives: tuple[int, ...]
) -> list[arb]:
    """Bounds of what is left out after the last term, for derivatives at x = 1; see the head of the file.

    blocks: bₙ as `_Batches` has them, of one solution and of the other side by side.
    """
    last = 3 + (len(blocks) - 1) * size
    if last < 8 or not _contracts(norms, last):
        raise Unproven("the series of the exact beam was cut too early for its tail to be bounded")
    reach = max((4 + k - q for q, k in norms), default=1)
    entries = [entry for block in blocks[-reach // size :] for entry in block.entries()]
    width = blocks[-1].ncols()
    largest = arb(0)
    factorial = arb(math.factorial(last))
    for i in range(min(reach, len(entries) // width)):
        row = entries[len(entries) - (i + 1) * width : len(entries) - i * width]
        for solution in (row[: width // 2], row[width // 2 :]):
            total = sum((_upper(entry) for entry in solution), arb(0))
            largest = largest.max(total / (factorial * 2**i))
        factorial = factorial / (last - i)
    errors = []
    for j in derivatives:
        ratio = arb(last + 2) / (2 * (last + 2 - j))
        errors.append((largest * math.perm(last + 1, j) / 2 / (1 - ratio)).upper())
    return errors


@lru_cache(maxsize=8)
def _weights(size: int, count: int, bits: int, derivatives: tuple[int, ...]) -> list[arb_mat]:
    """For each block, 1 / (n − j)! of its bₙ in a row for each derivative j (zero for n < j): from x = 0 to x = 1."""
    with precision(bits):
        inverse = [arb(1)]
        for n in range(1, 4 + size * count):
            inverse.append(inverse[-1] / n)
        rows = [[arb(0)] * j + inverse for j in derivatives]
        ends = [(0, 4), *((4 + t * size, 4 + (t + 1) * size) for t in range(count))]
        return [arb_mat([row[begin:end] for row in rows]) for begin, end in ends]
