"""Critical loads over a range of damping, proven for every value in it. Eqs. (10), (12), (24), (25).

h and g of `boundary_polynomials.py` are polynomials in one damping more, τ: α², β², or one of α and β with the other
held; they are interpolated. A range of τ is cut into cells. On a cell [τ₀ − r, τ₀ + r] a value is taken as that at τ₀
plus r [−1, 1] times the slope over the cell (the mean value form), so that what cancels at τ₀ stays cancelled. On each
cell is shown:

- the crossing: Krawczyk's test on a box of P and x = ω² holds for every τ of the cell at once, so that there is one
  crossing P*(τ), alone in the box, with x > 0: flutter;
- the sign of dP*/dτ there, from the implicit function theorem.

Stability up to a load is shown by the separators of `first_crossing.py`, for every τ of a cell. That a load is
unstable needs no more than a point u: h > 0 on [0, u] while g changes its sign there. Roots of h and g then do not
interlace; and what h and g may have in common, eigenvalues on the axis, can be divided out, for h has no root where g
has its first: an eigenvalue with a positive real part is left.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property, partial
from itertools import pairwise
from types import ModuleType
from typing import Any, Literal

from flint import arb, arb_mat, arb_poly

from freebeam_derive.certify.balls import Unproven, ball, ends, exact, precision, rational
from freebeam_derive.certify.bivariate import Bivariate, real_zeros, sign, signs_on
from freebeam_derive.certify.boundary_polynomials import Boundary, Question, boundary
from freebeam_derive.certify.first_crossing import cover
from freebeam_derive.certify.krawczyk import image, inside, inverse, newton

BITS = 192
MARGIN = 1 - Fraction(1, 1000)  # of the loads, to stay clear of the crossing
MOST_CUTS = 12  # halvings of a cell before a proof is given up
DEEPEST = 14  # halvings of the loads
Which = Literal["internal", "external"]
Curve = list[list[arb_poly]]  # [power of P][power of x], polynomials in τ


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
        bits = BITS + 32 * modes  # free-free and Beck at N = 8 lose up to 150 in the interpolation

        def at(damping: Fraction) -> Boundary:
            alpha, beta = (damping, held) if which == "internal" else (held, damping)
            return boundary(kernel, Question(modes, alpha, beta), bits)

        with precision(bits):
            # h is even in the damping, g odd: of squares one factor of it is struck out
            count = modes // 2 + 1 if self.squared else modes + 1
            unit = Fraction(1, 1000) if which == "internal" else Fraction(1)
            dampings = [unit * k for k in range(1, count + 1)]
            found = [at(damping) for damping in dampings]
            taus = [exact(self.of(damping)) for damping in dampings]
            factors = [1 / exact(damping) if self.squared else arb(1) for damping in dampings]
            self.h = _through(taus, [b.h.table for b in found])
            self.g = _through(taus, [f * b.g.table for f, b in zip(factors, found, strict=True)])

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
        z = family.newton([arb(near[0]), arb(near[1]) ** 2])
        local = family.about(z)
        half = exact((high - low) / 2)
        box = [
            ball(0, (2 * abs(rate) * half + abs(middle) * arb(2) ** -60).upper())
            for rate, middle in zip(_rates(local, [arb(0), arb(0)]), z, strict=True)
        ]
        at_centre = [arb(0), arb(0)]
        found = inside(box, image(at_centre, local.value(at_centre), local.slopes(box), box))
        P, x = (middle + side for middle, side in zip(z, found, strict=True))
        if not x > 0:
            raise Unproven("the frequency is not known to be positive")
        return Cell(low, high, ends(P), ends(x), sign(_rates(local, found)[0]))

    def stable(self, low: Fraction, high: Fraction, load: Fraction) -> int:
        """Stability for 0 ≤ P ≤ load and every damping from low to high; the number of cells. Raises Unproven."""
        return self._everywhere(low, high, partial(_Family.stable, end=load))

    def unstable(self, low: Fraction, high: Fraction, load: Fraction) -> int:
        """An eigenvalue with a positive real part at a load, for every damping from low to high; the number of cells.
        Raises Unproven."""
        return self._everywhere(low, high, partial(_Family.unstable, load=load))

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
            self._throughout(cells[first].low, cells[last].high, partial(_Family.stable, end=bottom))
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


def _through(taus: Sequence[arb], tables: Sequence[arb_mat]) -> list[Curve]:
    """Polynomials in τ through the coefficients of h or g at some dampings; first, and half of second derivatives."""
    half = arb(1) / 2
    rows, columns = tables[0].nrows(), tables[0].ncols()
    curve = [
        [arb_poly.interpolate(list(taus), [table[a, b] for table in tables]) for b in range(columns)]
        for a in range(rows)
    ]
    slope = [[p.derivative() for p in row] for row in curve]
    return [curve, slope, [[half * p.derivative() for p in row] for row in slope]]


def _at(curve: Curve, tau: arb) -> Bivariate:
    return Bivariate([arb_poly([p(tau) for p in row]) for row in curve])


class Over(Bivariate):
    """h or g for every τ of a cell, in the mean value form.

    parts: at the middle of the cell, its slope in τ there, half of the second derivative over all of the cell. What is
    linear in the polynomial is taken of each part, so that what cancels in them stays cancelled.
    """

    def __init__(self, parts: Sequence[Bivariate], spread: arb) -> None:
        super().__init__(parts[0].rows)
        self.parts, self.spread = tuple(parts), spread

    def _whole(self, values: Sequence[Any]) -> Any:
        value, first, second = values
        return value + self.spread * (first + self.spread * second)

    def _of_each(self, change: Callable[[Bivariate], Bivariate]) -> Over:
        return Over([change(part) for part in self.parts], self.spread)

    def __call__(self, P: arb, x: arb) -> arb:
        found: arb = self._whole([part(P, x) for part in self.parts])
        return found

    def at(self, P: arb) -> arb_poly:
        found: arb_poly = self._whole([part.at(P) for part in self.parts])
        return found

    def along(self, origin: arb, point: arb, slope: arb) -> arb_poly:
        found: arb_poly = self._whole([part.along(origin, point, slope) for part in self.parts])
        return found

    @cached_property
    def by_P(self) -> Over:
        return self._of_each(lambda part: part.by_P)

    @cached_property
    def by_x(self) -> Over:
        return self._of_each(lambda part: part.by_x)

    @property
    def by_tau(self) -> Over:
        """∂/∂τ over all of the cell."""
        _, first, second = self.parts
        return Over([first, second.combined(arb(1), second, arb(1)), Bivariate([])], self.spread)

    def about(self, P: arb, x: arb) -> Over:
        return self._of_each(lambda part: part.about(P, x))

    def combined(self, factor: Any, other: Bivariate, share: Any) -> Over:
        assert isinstance(other, Over)
        pairs = zip(self.parts, other.parts, strict=True)
        return Over([one.combined(factor, two, share) for one, two in pairs], self.spread)


def _rates(local: Boundary, box: Sequence[arb]) -> list[arb]:
    """dP*/dτ and dx*/dτ over a box and the cell. Raises Unproven."""
    assert isinstance(local.h, Over) and isinstance(local.g, Over)
    rates = inverse(local.slopes(box)) * arb_mat([[-f.by_tau(*box)] for f in (local.h, local.g)])
    return rates.entries()


class _Family:
    """h and g for every τ of a cell (`over`), and at its middle (`centre`)."""

    def __init__(self, line: Line, low: Fraction, high: Fraction) -> None:
        middle, spread = exact((low + high) / 2), ball(0, exact((high - low) / 2))
        places = middle, middle, middle + spread
        h, g = (Over([_at(*part) for part in zip(curves, places, strict=True)], spread) for curves in (line.h, line.g))
        self.over, self.centre = (Boundary(line.modes, *pair, True) for pair in ((h, g), (h.parts[0], g.parts[0])))

    # --- the crossing ---

    def newton(self, z: list[arb]) -> list[arb]:
        """The crossing at the middle of the cell, near a guess. Raises Unproven where Newton's method finds none."""
        guess = z[0]
        for _ in range(20):
            before = z[0]
            z = [side.mid() for side in newton(self.centre, z)]
            if not abs(z[0] - guess) < abs(guess) / 2:
                break
            if abs(z[0] - before) < abs(z[0]) * arb(2) ** -40:  # squared, once more
                return z
        raise Unproven("Newton's method leads astray")

    def about(self, z: Sequence[arb]) -> Boundary:
        """h and g combined so that their derivatives at a crossing are about the unit matrix, P and x counted from it:
        they move with the same τ, and what cancels between them does so before the cell's width comes in."""
        Y = inverse(self.centre.slopes(z)).mid()
        h, g = self.over.h.about(*z), self.over.g.about(*z)
        one, other = (h.combined(Y[i, 0], g, Y[i, 1]) for i in range(2))
        return Boundary(self.over.N, one, other, True)

    # --- signs ---

    def stable(self, end: Fraction) -> None:
        """Stability for 0 ≤ P ≤ end and every τ of the cell. Raises Unproven."""
        cover(self.over, Fraction(0), end, DEEPEST, self.centre)

    def unstable(self, load: Fraction) -> None:
        """A point u with h > 0 on [0, u] and g < 0 at u, g > 0 at 0. Raises Unproven."""
        P = exact(load)
        h, g = ([z for z in real_zeros(part.at(P)) if z > 0] for part in (self.centre.h, self.centre.g))
        if g and (not h or g[0] < h[0]):
            u = rational((g[0] + min([*h[:1], *g[1:2], 2 * g[0]], key=float)) / 2, 60)
            turns = self.over.g(P, arb(0)) > 0 and self.over.g(P, exact(u)) < 0
            if turns and _positive(self.over.h, P, Fraction(0), u, 12):
                return
        raise Unproven(f"the load {float(load):.8g} is not known to be unstable")


def _positive(which: Bivariate, P: arb, start: Fraction, end: Fraction, depth: int) -> bool:
    """Whether h or g is positive at a load for start ≤ x ≤ end."""
    if next(signs_on([which.about(P, exact(start)).at(arb(0))], Fraction(0), end - start)) == 1:
        return True
    middle = (start + end) / 2
    halves = ((start, middle), (middle, end))
    return bool(depth) and all(_positive(which, P, low, high, depth - 1) for low, high in halves)
