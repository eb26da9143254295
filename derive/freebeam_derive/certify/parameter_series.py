"""F(p, s) of the beam itself over a range of a parameter that stands in its equation of motion. Eqs. (6), (14), (15).

The coefficients of the equation and of the end conditions are linear in the parameter τ₀ + t δ, |t| ≤ 1. The recurrence
of the power series is carried out on polynomials in p, s and t, t up to a degree K, and Taylor's theorem gives

    F = Σ_{k<K} F_k t^k + F_K t^K,    F_k at τ₀, F_K in what it is over all of the range,

for F and for each of its derivatives in p and s. Balls in place of t would count each of its many appearances as a
parameter of its own.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from inspect import signature
from typing import Any

import flint
from flint import arb

from freebeam_derive.certify.balls import Exact, Range
from freebeam_derive.certify.beam import Beam, Coefficient, Jets, Linear, NoSeries, Order, Taylor, _batches, _Parts

# K: a weight from 3 to 3.3 takes 16, 6 and 5 s with K = 1, 2 and 3, a foundation from 100 to 110 13, 27 and 35 s, with
# loads 25 times as wide for K = 1
DEGREE = 2


class Series(Jets):
    """Polynomials in t whose coefficients are jets: those of 1, t, t², … side by side in a row."""

    def __init__(self, inner: Jets, degree: int) -> None:
        self.inner, self.count = inner, degree + 1
        self.orders = tuple((*order, k) for k in range(degree + 1) for order in inner.orders)  # type: ignore[misc]
        self.matrix = inner.matrix

    def scaled(self, linear: Linear) -> Linear:
        return *self.inner.scaled(linear[:3]), *self.inner.scaled(_slope(linear))[:2]

    def row(self, linear: Linear) -> Any:
        parts = [self.inner.row(linear[:3]), self.inner.row(_slope(linear))]
        return self.joined([*parts, *[self.inner.zero()] * self.count][: self.count])

    def times(self, row: Any, linear: Linear) -> Any:
        return row * self.operator(linear)

    def operator(self, factor: Any, copies: int = 1) -> Any:
        return _Multiplied(self, factor)

    def product(self, first: Any, second: Any) -> Any:
        a, b = self.coefficients(first), self.coefficients(second)
        found = []
        for k in range(self.count):
            total = self.inner.zero()
            for i in range(k + 1):
                total = total + self.inner.product(a[i], b[k - i])
            found.append(total)
        return self.joined(found)

    def coefficients(self, row: Any) -> list[Any]:
        """Of 1, t, t², … in a row."""
        entries, J = row.entries(), len(self.inner.orders)
        return [self.matrix(1, J, entries[k * J : (k + 1) * J]) for k in range(self.count)]

    def joined(self, parts: Sequence[Any]) -> Any:
        """The row of such coefficients."""
        return self.matrix(1, len(self.orders), [entry for part in parts for entry in part.entries()])


class _Multiplied:
    """To multiply rows, several side by side, by what is linear in p, s and t."""

    def __init__(self, series: Series, linear: Linear) -> None:
        self.series = series
        plain, slope = linear[:3], _slope(linear)
        self.plain, self.slope = (
            None if all(v.is_zero() for v in part) else series.inner.operator(part) for part in (plain, slope)
        )

    def __rmul__(self, matrix: Any) -> Any:
        kind, J, count = self.series.matrix, len(self.series.inner.orders), self.series.count
        entries = matrix.entries()
        total = None
        if self.plain is not None:
            total = kind(len(entries) // J, J, entries) * self.plain
        if self.slope is not None:
            width = J * count
            moved: list[Any] = []
            for start in range(0, len(entries), width):
                moved += [0] * J + entries[start : start + width - J]
            more = kind(len(entries) // J, J, moved) * self.slope
            total = more if total is None else total + more
        if total is None:
            return kind(matrix.nrows(), matrix.ncols())
        return kind(matrix.nrows(), matrix.ncols(), total.entries())


def _slope(linear: Linear) -> Linear:
    return (*linear[3:], arb(0)) if len(linear) > 3 else (arb(0), arb(0), arb(0))


class _Linear(Beam):
    """A beam whose coefficients go linearly in t from those of one to those of another; of a series alone.

    whole: what is computed holds about each t, else about t = 0.
    """

    def __init__(self, low: Beam, high: Beam, whole: bool) -> None:
        self._sides, self._whole = (low, high), whole
        super().__init__(low.kernel, low.own)

    def _parts(self) -> _Parts:
        bits = flint.ctx.prec
        if bits not in self._known:
            low, high = (side._parts() for side in self._sides)
            equation = self._between(low.equation, high.equation)
            left, right = (
                tuple(self._between(*rows) for rows in zip(*pair, strict=True))
                for pair in ((low.left, high.left), (low.right, high.right))
            )
            self._known[bits] = _Parts(equation, left, right, _batches(equation))
        return self._known[bits]

    def _between(self, low: Mapping[Any, Coefficient], high: Mapping[Any, Coefficient]) -> dict[Any, Coefficient]:
        none = Coefficient(arb(0), arb(0), arb(0))
        found = {}
        for key in {**low, **high}:
            a, b = low.get(key, none), high.get(key, none)
            e, h = (self._about(x, y) for x, y in zip(a[:2], b[:2], strict=True))
            slopes = (arb(0) if x.mid() == y.mid() else (y - x) / 2 for x, y in zip(a[:2], b[:2], strict=True))
            found[key] = Coefficient(e, h, a.m, *slopes)
        return found

    def _about(self, low: arb, high: arb) -> arb:
        if self._whole or low.mid() == high.mid():
            return low.union(high)
        return (low + high) / 2

    def _operators(self, p: Any, s: Any, jets: Jets) -> tuple[Any, ...]:
        none = (arb(0), arb(0), arb(0))
        slopes = (*none, arb(-1), arb(0)), (*none, -p, arb(-1))
        return *super()._operators(p, s, jets), *(jets.operator(slope, 2) for slope in slopes)


class OverEquation(Beam):
    """A beam over a range of one of its own parameters, in which its equation and end conditions are linear: F and its
    derivatives are balls that hold those of each value.

    own: one of them a `Range`. Raises NoSeries where bending stiffness, mass or damping change with it, or where it is
    not linear.
    """

    def __init__(self, kernel: Any, own: Mapping[str, Any]) -> None:
        (name,) = (n for n, value in own.items() if isinstance(value, Range))
        ends = own[name]
        assert isinstance(ends, Range)
        super().__init__(kernel, {**own, name: ends.low})
        _check(self, name)
        self.low, self.high = (Beam(kernel, {**own, name: value}) for value in (ends.low, ends.high))
        self.own = {**self.own, name: ends}
        self._at, self._over = (_Linear(self.low, self.high, whole) for whole in (False, True))
        if self._at.pivots() != self._over.pivots():  # which F stands on
            raise NoSeries(f"{self.name}: the conditions at x = 0 are of another kind within the range of {name}")

    def coefficients(self, p: Any, s: Any, jets: Jets) -> list[Any]:
        """Of 1, t, … t^K in F, each a row of jets; the last holds what it is for each value of the parameter."""
        series = Series(jets, DEGREE)
        at, over = (series.coefficients(beam.expanded(p, s, series)) for beam in (self._at, self._over))
        return [*at[:-1], over[-1]]

    def expanded(self, p: Any, s: Any, jets: Any) -> Any:
        total = jets.zero()
        for k, row in enumerate(self.coefficients(p, s, jets)):
            total = total + row * power(k)
        return total

    def damping(self, alpha: Exact, beta: Exact) -> tuple[arb, arb]:
        """c_E is the same for each value, and c_M linear in the parameter."""
        (c_E, low), (_, high) = (beam.damping(alpha, beta) for beam in (self.low, self.high))
        return c_E, low.union(high)

    def terms(self, middle: Beam) -> list[_Term]:
        """What stands for the beam in equations that are linear in F, to have the coefficients of 1, t, … of them.

        middle: the beam at t = 0, whose damping is taken.
        """
        return [_Term(self, middle, k) for k in range(DEGREE + 1)]


class _Term:
    """A coefficient F_k in place of F."""

    def __init__(self, beam: OverEquation, middle: Beam, k: int) -> None:
        self._beam, self._k = beam, k
        self.damping, self.pencil = middle.damping, middle.pencil

    def taylor(self, p: Any, s: Any, orders: Sequence[Order]) -> Taylor:
        """As `Beam.taylor`."""
        jets = Jets(tuple(orders), not (isinstance(p, arb) and isinstance(s, arb)))
        return dict(zip(jets.orders, self._beam.coefficients(p, s, jets)[self._k].entries(), strict=True))


def power(k: int) -> arb:
    """t^k, |t| ≤ 1."""
    return arb(1) if k == 0 else arb(0, 1) if k % 2 else arb(0.5, 0.5)


def summed(powers: list[Taylor]) -> Taylor:
    """Taylor coefficients for each |t| ≤ 1, of the factors of the powers of t."""
    return {order: sum((of[order] * power(k) for k, of in enumerate(powers[1:], 1)), value)
            for order, value in powers[0].items()}  # fmt: skip


def _check(beam: Beam, name: str) -> None:
    """That all is linear in a parameter, and bending stiffness, mass and internal damping are without it."""
    rows, place = rows_of(beam, name)
    fixed = [v for row in rows_of(beam, name, fixed=True)[0] for v in row]
    if not straight(rows, place) or any(place in v.free_symbols for v in fixed):
        raise NoSeries(
            f"{beam.name}: a range of {name} is served where the equation of motion and the end conditions are linear "
            "in it, and bending stiffness, mass and internal damping do not change with it; give it one value"
        )


def straight(rows: list[list[Any]], place: Any) -> bool:
    import sympy as sp

    return all(sp.expand(sp.diff(v, place, 2)) == 0 for row in rows for v in row)


def rows_of(beam: Beam, name: str, fixed: bool = False) -> tuple[list[list[Any]], Any]:
    """The factors in the equation, in the conditions at x = 0 and at x = 1, and the symbol of a parameter in them.

    fixed: those of the fourth derivative and of the accelerations alone.
    """
    import sympy as sp

    given: dict[str, Any] = dict(zip(("P", "alpha", "beta"), sp.symbols("P alpha beta"), strict=True))
    given |= {n: sp.Rational(v.numerator, v.denominator) for n, v in beam.own.items()}
    if name in beam.own:
        given[name] = sp.Symbol(name)
    if "one" in signature(beam.kernel.equation).parameters:
        given["one"] = sp.Integer(1)
    equation, (left, right) = beam.kernel.equation(**given), beam.kernel.end_conditions(**given)
    rows = [[sp.sympify(v) for key, row in equation.items() if not fixed or key[0] == 4 or key[1] == 2 for v in row]]
    for condition in (*left, *right):
        rows.append([sp.sympify(v) for key, v in condition.items() if not fixed or key[1] == 2])
    return rows, given[name]
