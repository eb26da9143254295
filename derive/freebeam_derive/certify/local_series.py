"""F(p, s) of the beam itself on a box, as a polynomial whose last coefficients are balls: many values for one series.

With p = p₀ + ρ u and s = s₀ + σ v, |u|, |v| ≤ 1 on the box, Taylor's theorem along the segment from the centre gives

    F = Σ_{i+j<N} F_ij u^i v^j + Σ_{i+j=N} G_ij u^i v^j,    F_ij at the centre, G_ij in what they are on the box,

and for the derivatives the derivatives of this, term by term: their coefficients are (i+1) G_{i+1,j} and so on.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from math import comb
from typing import Any

from flint import acb, acb_mat, acb_poly, arb, arb_mat, arb_poly

from freebeam_derive.certify.balls import Exact, Unproven
from freebeam_derive.certify.beam import Beam, Jets, Order, Taylor
from freebeam_derive.certify.exact_system import ExactSystem
from freebeam_derive.certify.parameter_series import OverEquation, summed

DEGREE = 14  # N: of 8 to 22 the fastest for the free-free column with damping; Beck's takes 10, by little

DEGREE_OF_ANY = (
    8  # the same where F comes from Taylor steps: of 4, 5, 6 and 8 it proves the widest range of a tip mass;
)
# and over a range of a foundation: of 6, 8, 10 and 14 all prove the same, and 14 takes half as long again
# the same of the factors of t and t² over a range of a damping: Pflüger's column, beta from 0.5 to 0.6, takes 15, 11
# and 17 s with (4, 3), (5, 3) and (6, 4), and 38, 22 and 18 series
DEGREES_OF_DAMPING = 5, 3
FINER = 11  # where that is too coarse: at Pflüger's column with damping and ω > 120 one of these stands for 150


@lru_cache(maxsize=4)
def _orders(degree: int) -> tuple[Order, ...]:
    return tuple((i, j) for i in range(degree + 1) for j in range(degree + 1 - i))


@lru_cache(maxsize=4)
def _shifts(degree: int) -> tuple[tuple[int, ...], tuple[int, ...]]:
    """Where the coefficient of u^i v^j comes from in the product by u, and by v; −1: from nowhere."""
    orders = _orders(degree)
    place = {order: t for t, order in enumerate(orders)}
    return tuple(tuple(place.get((i - a, j - b), -1) for i, j in orders) for a, b in ((1, 0), (0, 1)))  # type: ignore[return-value]


class _Linear:
    """To multiply rows of coefficients by constant + u · first + v · second."""

    def __init__(self, grid: _Grid, linear: tuple[Any, Any, Any]) -> None:
        self.grid, self.linear = grid, linear

    def __rmul__(self, matrix: Any) -> Any:
        constant, *rest = self.linear
        total = matrix * constant
        entries, J = matrix.entries(), len(self.grid.orders)
        width = matrix.ncols()
        for sources, factor in zip(self.grid.shifts, rest, strict=True):
            if factor.is_zero():
                continue
            moved = [entries[start + t] if t >= 0 else 0 for start in range(0, len(entries), J) for t in sources]
            total = total + self.grid.matrix(matrix.nrows(), width, moved) * factor
        return total


class _Grid(Jets):
    """All orders up to a degree together, u and v counted in units of their own."""

    def __init__(self, degree: int, is_complex: bool, units: tuple[arb, arb]) -> None:
        super().__init__(_orders(degree), is_complex)
        self.degree, self.units, self.shifts = degree, units, _shifts(degree)
        self._poly: Any = acb_poly if is_complex else arb_poly

    def scaled(self, linear: tuple[Any, Any, Any]) -> tuple[Any, Any, Any]:
        return linear[0], linear[1] * self.units[0], linear[2] * self.units[1]

    def row(self, linear: tuple[Any, Any, Any]) -> Any:
        return super().row(self.scaled(linear))

    def operator(self, factor: Any, copies: int = 1) -> Any:
        return _Linear(self, self.scaled(factor))

    def product(self, first: Any, second: Any) -> Any:
        N = self.degree
        a, b = (self._rows(row) for row in (first, second))
        rows = []
        for i in range(N + 1):
            total = self._poly([0])
            for k in range(i + 1):
                total += a[k] * b[i - k]
            rows.append(total)
        return self.matrix(1, len(self.orders), [rows[i][j] for i, j in self.orders])

    def _rows(self, row: Any) -> list[Any]:
        entries, found, start = row.entries(), [], 0
        for i in range(self.degree + 1):
            found.append(self._poly(entries[start : start + self.degree + 1 - i]))
            start += self.degree + 1 - i
        return found


class Local:
    """Stands for a beam on a box of p and s; what it is asked for beyond is refused (Unproven).

    rates: orders are of three, the last that of a damping that vanishes, up to its first. degree: N.
    """

    def __init__(
        self, beam: Beam | ExactSystem, p: Any, s: Any, rates: bool = False, degree: int | None = None
    ) -> None:
        self._powers: list[Local] = []
        if isinstance(beam, ExactSystem) and beam.by_damping is not None:
            beam, *others = beam.by_damping
            degrees = [min(n, degree or n) for n in DEGREES_OF_DAMPING]
            self._powers = [Local(of, p, s, rates, n) for of, n in zip(others, degrees, strict=True)]
        self.beam, self.is_complex = beam, isinstance(p, acb) or isinstance(s, acb)
        kind: Any = acb if self.is_complex else arb
        self._box = kind(p), kind(s)
        self._centre = tuple(kind(side.mid()) for side in self._box)
        self._units = tuple(_reach(side - middle) for side, middle in zip(self._box, self._centre, strict=True))
        degree = degree or (DEGREE_OF_ANY if isinstance(beam, ExactSystem | OverEquation) else DEGREE)
        grid = _Grid(degree, self.is_complex, self._units)  # type: ignore[arg-type]
        self._C: list[Any] = []
        for at, over in zip(*(self._entries(grid, x, y, rates) for x, y in (self._centre, self._box)), strict=True):
            self._C.append(grid.matrix(degree + 1, degree + 1))
            for t, (i, j) in enumerate(grid.orders):
                self._C[-1][i, j] = over[t] if i + j == degree else at[t]

    def _entries(self, grid: _Grid, p: Any, s: Any, rates: bool) -> list[list[Any]]:
        """By the order of the rate; one list where there is none."""
        if isinstance(self.beam, Beam):
            return [self.beam.expanded(p, s, grid).entries()]
        last: list[tuple[int, ...]] = [(0,), (1,)] if rates else [()]
        t: dict[Any, Any] = self.beam.taylor(p, s, [(*order, *d) for d in last for order in grid.orders])
        return [[t[i, j, *d] * self._units[0] ** i * self._units[1] ** j for i, j in grid.orders] for d in last]

    def damping(self, alpha: Exact, beta: Exact) -> tuple[arb, arb]:
        assert isinstance(self.beam, Beam)
        return self.beam.damping(alpha, beta)

    def pencil(self, P: Any, value: Any, alpha: Exact, beta: Exact) -> tuple[Any, Any, Any, Any, Any]:
        return self.beam.pencil(P, value, alpha, beta)

    def taylor(self, p: Any, s: Any, orders: Sequence[Any]) -> Taylor:
        """As `Beam.taylor`, up to the second order in each. Raises Unproven outside of the box."""
        if not (self._box[0].contains(p) and self._box[1].contains(s)):
            raise Unproven("a value was asked for outside of the box of a series")
        top = max(max(order[:2]) for order in orders)
        kind: Any = acb if self.is_complex else arb
        u, v = ((kind(x) - c) / unit for x, c, unit in zip((p, s), self._centre, self._units, strict=True))
        last = self._C[0].nrows() - 1
        rows = [_powers(u, k, last) for k in range(top + 1)]
        columns = [_powers(v, k, last) for k in range(top + 1)]
        matrix: Any = acb_mat if self.is_complex else arb_mat
        found = [matrix(rows) * C * matrix(columns).transpose() for C in self._C]
        if any(i + j > last for i, j, *_ in orders):
            raise Unproven("a derivative was asked for of a higher order than a series has")
        units = self._units
        t = {(i, j, *d): found[sum(d)][i, j] / (units[0] ** i * units[1] ** j) for i, j, *d in orders}
        return summed([t, *(of.taylor(p, s, orders) for of in self._powers)])


def _reach(side: Any) -> arb:
    """How far a box about 0 goes; never 0."""
    reach: arb = abs(side).upper()
    return reach if reach > 0 else arb(2) ** -30


def _powers(x: Any, order: int, last: int) -> list[Any]:
    """C(n, order) x^(n − order) for n = 0 … N: the derivative of the powers over order!."""
    found, power = [x * 0] * order, x * 0 + 1
    for n in range(order, last + 1):
        found.append(comb(n, order) * power)
        power = power * x
    return found
