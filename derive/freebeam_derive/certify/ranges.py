"""Critical loads over a range of damping, proven for every value in it. Eqs. (10), (12), (24), (25).

h and g of `ritz.py` are polynomials in one damping more, τ: α², β², or one of α and β with the other held. A range of
τ is cut into cells. On a cell [τ₀ − r, τ₀ + r] a value is taken as that at τ₀ plus r [−1, 1] times the slope over the
cell (the mean value form), so that what cancels at τ₀ stays cancelled. On each cell is shown:

- the crossing: Krawczyk's test on a box of P and x = ω² holds for every τ of the cell at once, so that there is one
  crossing P*(τ), alone in the box, with x > 0: flutter;
- the sign of dP*/dτ there, from the implicit function theorem.

Stability up to a load is shown by the separators of `ritz.py`, for every τ of a cell. That a load is unstable needs no
more than a point u: h > 0 on [0, u] while g changes its sign there. Roots of h and g then do not interlace; and what h
and g may have in common, eigenvalues on the axis, can be divided out, for h has no root where g has its first: an
eigenvalue with a positive real part is left.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import partial
from itertools import pairwise
from math import comb, perm
from types import ModuleType
from typing import Literal

from flint import arb, arb_poly

from freebeam_derive.certify.balls import Unproven, ends, exact, precision
from freebeam_derive.certify.ritz import (
    Boundary,
    Question,
    boundary,
    derivative,
    rational,
    separators_at,
    sign_on,
    zeros,
)

BITS = 192
MARGIN = 1 - Fraction(1, 1000)  # of the loads, to stay clear of the crossing
MOST_CUTS = 12  # halvings of a cell before a proof is given up
Curve = list[list[arb_poly]]  # [power of τ][power of P], polynomials in x
Which = Literal["internal", "external"]


@dataclass(frozen=True)
class Cell:
    """What is proven for every τ from low to high. load, square: P* and ω². rises: sign of dP*/dτ, 0 where unknown."""

    low: Fraction
    high: Fraction
    load: tuple[Fraction, Fraction]
    square: tuple[Fraction, Fraction]
    rises: int


class Line:
    """h and g of a column along a line of damping. τ is α ("internal") or β ("external"), its square where the other
    damping is zero."""

    def __init__(self, kernel: ModuleType, modes: int, which: Which, held: Fraction = Fraction(0)) -> None:
        self.modes, self.squared = modes, held == 0
        with precision(BITS):
            f = boundary(kernel, Question(modes), BITS).h
            self.h, self.g = _powers(f, modes, which, exact(held))
            if self.squared:
                # h is even in the damping, g odd: one factor of it is struck out
                self.h, self.g = self.h[0::2], self.g[1::2]

    def of(self, damping: Fraction) -> Fraction:
        """τ of a damping."""
        return damping**2 if self.squared else damping

    def cells(
        self, dampings: Sequence[Fraction], near: Sequence[tuple[float, float]], depth: int = MOST_CUTS
    ) -> list[Cell]:
        """Proofs on the cells between neighbouring dampings, cut finer until the sign of the slope is known as well.

        near: load and frequency of the crossing at each damping, such as the runtime's. Where the last cut does not
        give the sign, it is 0. Raises Unproven where there is no proof of the crossing.
        """
        found: list[Cell] = []
        with precision(BITS):
            for (low, high), (start, end) in zip(pairwise(map(self.of, dampings)), pairwise(near), strict=True):
                guess = (start[0] + end[0]) / 2, (start[1] + end[1]) / 2
                waiting = [(low, high, depth)]
                while waiting:
                    a, b, left = waiting.pop()
                    cell = None
                    try:
                        cell = self._cell(a, b, guess)
                    except Unproven:
                        if not left:
                            raise
                    if cell is not None and (cell.rises or not left):
                        found.append(cell)
                    else:
                        waiting += [((a + b) / 2, b, left - 1), (a, (a + b) / 2, left - 1)]
        return found

    def _cell(self, low: Fraction, high: Fraction, near: tuple[float, float]) -> Cell:
        family = _Family(self, low, high)
        P, x = arb(near[0]), arb(near[1]) ** 2
        P, x = family.newton(P, x)
        here = _Crossing(family, P, x)
        half = exact((high - low) / 2)
        by_load, by_square = here.rates(here.P, here.x)
        reach = abs(by_load) * half * 2 + abs(P) * arb(2) ** -60
        across = abs(by_square) * half * 2 + x * arb(2) ** -60
        image = here.krawczyk((here.P + reach.upper() * arb(0, 1), here.x + across.upper() * arb(0, 1)))
        if not image[1] > 0:
            raise Unproven("the frequency is not known to be positive")
        rate = here.rates(*image)[0]
        sign = 1 if rate > 0 else -1 if rate < 0 else 0
        return Cell(low, high, ends(image[0]), ends(image[1]), sign)

    def stable(self, low: Fraction, high: Fraction, load: Fraction) -> int:
        """Stability for 0 ≤ P ≤ load and every damping from low to high; the number of cells. Raises Unproven."""
        return self._everywhere(low, high, lambda family: family.stable(Fraction(0), load))

    def unstable(self, low: Fraction, high: Fraction, load: Fraction) -> int:
        """An eigenvalue with a positive real part at a load, for every damping from low to high; the number of cells.
        Raises Unproven."""
        return self._everywhere(low, high, lambda family: family.unstable(load))

    def none_before(self, cells: Sequence[Cell], share: Fraction) -> Fraction:
        """Stability for every damping of some cells up to their crossings, but for a share of the load, at most as
        given; that share is returned. Raises Unproven."""
        worst, first = Fraction(0), 0
        while first < len(cells):
            last, bottom, top = first, cells[first].load[0], cells[first].load[1]
            while last + 1 < len(cells):
                low, high = min(bottom, cells[last + 1].load[0]), max(top, cells[last + 1].load[1])
                if low * MARGIN < high * (1 - share):
                    break
                last, bottom, top = last + 1, low, high
            bottom *= MARGIN
            self._throughout(cells[first].low, cells[last].high, partial(_Family.stable, start=Fraction(0), end=bottom))
            worst, first = max(worst, 1 - bottom / top), last + 1
        return worst

    def _everywhere(self, low: Fraction, high: Fraction, show: Callable[[_Family], None]) -> int:
        return self._throughout(self.of(low), self.of(high), show)

    def _throughout(self, low: Fraction, high: Fraction, show: Callable[[_Family], None]) -> int:
        waiting, done = [(low, high, MOST_CUTS)], 0
        with precision(BITS):
            while waiting:
                a, b, depth = waiting.pop()
                try:
                    show(_Family(self, a, b))
                    done += 1
                except Unproven:
                    if not depth:
                        raise
                    waiting += [((a + b) / 2, b, depth - 1), (a, (a + b) / 2, depth - 1)]
        return done


def _powers(f: list[arb_poly], N: int, which: Which, held: arb) -> tuple[Curve, Curve]:
    """Even and odd part in λ of Σ_ab c_ab P^a (−λ² − βλ)^b (1 + αλ)^(N−a−b), over the powers of one damping."""
    one = arb_poly([1])
    fixed = [one]
    factor = arb_poly([0, -held, -1]) if which == "internal" else arb_poly([1, held])
    for _ in range(N):
        fixed.append(fixed[-1] * factor)
    h: Curve = [[] for _ in range(N + 1)]
    g: Curve = [[] for _ in range(N + 1)]
    for n in range(N + 1):
        for a, p in enumerate(f):
            total = arb_poly([0])
            for b in range(min(N - a, p.degree()) + 1):
                if which == "internal":
                    k = N - a - b
                    if n <= k:
                        total += p[b] * comb(k, n) * fixed[b] * arb_poly([*[0] * n, 1])
                elif n <= b:
                    # (−λ² − βλ)^b at β^n: C(b, n) (−λ²)^(b−n) (−λ)^n
                    term = arb_poly([*[0] * (2 * b - n), (-1) ** b])
                    total += p[b] * comb(b, n) * term * fixed[N - a - b]
            coefficients = [total[k] for k in range(2 * N + 1)]
            h[n].append(arb_poly([(-1) ** j * coefficients[2 * j] for j in range(N + 1)]))
            g[n].append(arb_poly([(-1) ** j * coefficients[2 * j + 1] for j in range(N)]))
    return h, g


def _at(curve: Curve, tau: arb, order: int = 0) -> list[arb_poly]:
    """A derivative in τ of h or g, over the powers of P."""
    total = [arb_poly([0]) for _ in curve[0]]
    for n in range(len(curve) - 1, order - 1, -1):
        total = [t * tau + perm(n, order) * p for t, p in zip(total, curve[n], strict=True)]
    return total


class _Local:
    """A polynomial in P and x about a point, so that over a small box little is lost."""

    def __init__(self, which: list[arb_poly], P: arb, x: arb) -> None:
        move = arb_poly([x, 1])
        rows = [p(move) for p in which]
        for low in range(len(rows) - 1):
            for k in range(len(rows) - 2, low - 1, -1):
                rows[k] += P * rows[k + 1]
        self.rows, self.P, self.x = rows, P, x

    def __call__(self, P: arb, x: arb, in_P: int = 0, in_x: int = 0) -> arb:
        """A derivative over a box."""
        return derivative(self.rows, P - self.P, x - self.x, in_P, in_x)


class _Crossing:
    """h and g about a crossing, for every τ of a cell: their values, slopes in P, x and τ over boxes."""

    def __init__(self, family: _Family, P: arb, x: arb) -> None:
        self.P, self.x, self.spread = P.mid(), x.mid(), family.spread
        local = [[_Local(part, self.P, self.x) for part in parts] for parts in family.parts]
        # at the middle of the cell, slope over the cell; the same of the slope
        self.value, self.first, self.second = zip(*local, strict=True)

    def over(self, i: int, P: arb, x: arb, in_P: int = 0, in_x: int = 0) -> arb:
        """A derivative of h (0) or g (1) over a box and the cell."""
        slope = self.first[i](P, x, in_P, in_x) + self.spread * self.second[i](P, x, in_P, in_x)
        found: arb = self.value[i](P, x, in_P, in_x) + self.spread * slope
        return found

    def in_tau(self, i: int, P: arb, x: arb) -> arb:
        """The derivative in τ of h or g over a box and the cell."""
        found: arb = self.first[i](P, x) + self.spread * self.second[i](P, x)
        return found

    def jacobian(self, P: arb, x: arb) -> tuple[arb, arb, arb, arb]:
        """h_P, h_x, g_P, g_x over a box and the cell."""
        return self.over(0, P, x, 1, 0), self.over(0, P, x, 0, 1), self.over(1, P, x, 1, 0), self.over(1, P, x, 0, 1)

    def rates(self, P: arb, x: arb) -> tuple[arb, arb]:
        """dP*/dτ and dx*/dτ over a box and the cell."""
        a, b, c, d = self.jacobian(P, x)
        r, s = self.in_tau(0, P, x), self.in_tau(1, P, x)
        det = a * d - b * c
        if det.contains(0):
            raise Unproven("the crossing is not known to be simple")
        return -(d * r - b * s) / det, -(a * s - c * r) / det

    def krawczyk(self, box: tuple[arb, arb]) -> tuple[arb, arb]:
        """Balls of the crossing for every τ of the cell, alone in the box. Raises Unproven."""
        P, x = self.P, self.x
        a, b, c, d = (entry.mid() for entry in self.jacobian(P, x))
        det = a * d - b * c
        inverse = ((d / det, -b / det), (-c / det, a / det))
        # h and g move with the same τ: what cancels between them does so before the cell's width comes in
        r, s = (self.value[i](P, x) for i in (0, 1))
        r_tau, s_tau = (self.in_tau(i, P, x) for i in (0, 1))
        J = self.jacobian(*box)
        away = box[0] - P, box[1] - x
        image = []
        for i, middle in enumerate((P, x)):
            u, v = inverse[i]
            rest = (int(i == 0) - u * J[0] - v * J[2], int(i == 1) - u * J[1] - v * J[3])
            moved = u * r + v * s + self.spread * (u * r_tau + v * s_tau)
            image.append(middle - moved + rest[0] * away[0] + rest[1] * away[1])
        if not (box[0].contains_interior(image[0]) and box[1].contains_interior(image[1])):
            raise Unproven("the box is not proven to hold one crossing for every damping of the cell")
        return image[0], image[1]


class _Family(Boundary):
    """h and g for every τ of a cell: at its middle, with the slopes over the cell beside."""

    def __init__(self, line: Line, low: Fraction, high: Fraction) -> None:
        self.N = line.modes
        middle, radius = exact((low + high) / 2), exact((high - low) / 2)
        cell = middle + radius * arb(0, 1)
        self.spread = radius * arb(0, 1)
        self.parts = tuple(
            (_at(curve, middle), _at(curve, middle, 1), _at(curve, cell, 2)) for curve in (line.h, line.g)
        )
        self.h, self.g = self.parts[0][0], self.parts[1][0]
        self.slopes = {id(parts[0]): parts[1:] for parts in self.parts}
        self.centre = Boundary.__new__(Boundary)
        self.centre.N, self.centre.h, self.centre.g = self.N, self.h, self.g

    # --- over the cell ---

    def along(self, which: list[arb_poly], origin: arb, point: arb, slope: arb) -> arb_poly:
        plain = super().along(which, origin, point, slope)
        first, second = (super(_Family, self).along(part, origin, point, slope) for part in self.slopes[id(which)])
        return plain + self.spread * (first + self.spread * second)

    def over(self, which: list[arb_poly], P: arb, x: arb, in_P: int = 0, in_x: int = 0) -> arb:
        """A derivative of h or g over a box and the cell."""
        value = self.value(which, P, x, in_P, in_x)
        first, second = (self.value(part, P, x, in_P, in_x) for part in self.slopes[id(which)])
        return value + self.spread * (first + self.spread * second)

    # --- the crossing ---

    def newton(self, P: arb, x: arb) -> tuple[arb, arb]:
        """The crossing at the middle of the cell, near a guess. Raises Unproven where Newton's method finds none."""
        h, g = (_Local(parts[0], P, x) for parts in self.parts)
        for _ in range(20):
            (a, b), (c, d) = ((f(P, x, 1, 0), f(P, x, 0, 1)) for f in (h, g))
            r, s, det = h(P, x), g(P, x), a * d - b * c
            step = (d * r - b * s) / det, (a * s - c * r) / det
            P, x = (P - step[0]).mid(), (x - step[1]).mid()
            if not (P.is_finite() and x.is_finite()):
                break
            if abs(step[0]) < abs(P) * arb(2) ** -40:  # squared, once more
                return P, x
        raise Unproven("Newton's method leads astray")

    @property
    def _g(self) -> list[arb_poly]:
        assert self.g is not None
        return self.g

    # --- signs ---

    def stable(self, start: Fraction, end: Fraction, depth: int = 14) -> None:
        """Stability for start ≤ P ≤ end and every τ of the cell. Raises Unproven."""
        middle = (start + end) / 2
        separators = separators_at(self.centre, middle)
        if separators is None:
            raise Unproven(f"not known to be stable at the load {float(middle):.8g}")
        if self._interlaced(start, end, [point for point, _ in separators]):
            return
        if not depth:
            raise Unproven(f"stability is not shown near the load {float(middle):.8g}")
        self.stable(middle, end, depth - 1)
        self.stable(start, middle, depth - 1)

    def _sign(self, which: list[arb_poly], point: Fraction, start: Fraction, end: Fraction) -> int:
        line = self.along(which, exact(start), exact(point), arb(0))
        return sign_on(line, arb(0), exact(end - start))

    def _interlaced(self, start: Fraction, end: Fraction, points: list[Fraction]) -> bool:
        """The signs at the separators, as `ritz.holds` has them."""
        if self._sign(self.h, Fraction(0), start, end) != 1 or any(b <= a for a, b in pairwise([Fraction(0), *points])):
            return False
        last = 2 * self.N - 2
        for k, point in enumerate(points):
            if self._sign(self.h, point, start, end) != (-1) ** (k // 2 + 1):
                return False
            if k < last and self._sign(self._g, point, start, end) != (-1) ** ((k + 1) // 2):
                return False
        return True

    def unstable(self, load: Fraction) -> None:
        """A point u with h > 0 on [0, u] and g < 0 at u, g > 0 at 0. Raises Unproven."""
        P = exact(load)
        h, g = (_positive_zeros(self.centre.at(part, P)) for part in (self.h, self._g))
        if not g or (h and not g[0] < h[0]):
            raise Unproven(f"the load {float(load):.8g} is not known to be unstable")
        limit = h[0] if h else 2 * g[0]
        if len(g) > 1 and g[1] < limit:
            limit = g[1]
        u = rational((g[0] + limit) / 2, 60)
        if not (self.over(self._g, P, arb(0)) > 0 and self.over(self._g, P, exact(u)) < 0):
            raise Unproven(f"the load {float(load):.8g} is not known to be unstable")
        if not self._positive(P, Fraction(0), u, 12):
            raise Unproven(f"the load {float(load):.8g} is not known to be unstable")

    def _positive(self, P: arb, start: Fraction, end: Fraction, depth: int) -> bool:
        """h > 0 for start ≤ x ≤ end at a load."""
        move = arb_poly([exact(start), 1])
        plain, first, second = (self.centre.at(part, P)(move) for part in self.parts[0])
        if sign_on(plain + self.spread * (first + self.spread * second), arb(0), exact(end - start)) == 1:
            return True
        middle = (start + end) / 2
        return bool(depth) and self._positive(P, start, middle, depth - 1) and self._positive(P, middle, end, depth - 1)


def _positive_zeros(polynomial: arb_poly) -> list[arb]:
    """Approximations of the real positive zeros, ascending: where to look, and no more."""
    return sorted((z.real.mid() for z in zeros(polynomial) if z.imag.contains(0) and z.real > 0), key=float)
