"""A column of one deflection as its forms say it: stiffness, mass, what stands at places, and how large its load is.

The elastic energy is ∫ EI y''² dx and what is of lower order (springs, a foundation, a dead load), the mass m(x) and
point masses, which may have a rotary inertia; EI and m are polynomials on each segment, and y and y' go on from one
to the next but at joints, where a spring holds their jump. load_size.py has how large the load is.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from copy import copy
from fractions import Fraction
from functools import cached_property
from itertools import product
from math import comb, prod
from typing import Any

from flint import arb

from freebeam_derive.certify.balls import Range, exact, greatest, least, parameters
from freebeam_derive.certify.comparison_form import ORDERS
from freebeam_derive.certify.numbers import reason
from freebeam_derive.certify.strips import Line, NoStrips, rigid_motions

PIECES = 64  # of a segment, on each of which coefficients are one ball
Polynomial = list[Fraction]  # of x, ascending
Place = tuple[Fraction, int]  # place, order of the derivative there
OF_CLAMPED = {0: arb(1) / 3, 1: arb("0.7072")}, {0: arb(2) / 3, 1: arb(1)}
"""`ColumnForms.reach` with a clamped end e: y'(x)² ≤ |x − e| ∫ y''² dx."""
JOINT = {(-1, -1): 1, (-1, 1): -1, (1, -1): -1, (1, 1): 1}  # the square of a jump, by the sides of its two factors


class ColumnForms:
    """What a kernel of the one field y says, at the precision in force.

    own: its parameters as rational numbers. m, EI: a polynomial a segment. elastic, load: order, or (test order, trial
    order), -> polynomial, a table a segment. masses, springs, joints: (place, order) -> factor. Raises NoStrips for a
    column that is not of the kind above.
    """

    opened: frozenset[Place] = frozenset()  # where y or y' jumps

    def __init__(self, kernel: Any, own: Mapping[str, Fraction]) -> None:
        self.name, self._own = kernel.COLUMN["name"], parameters(kernel, own)
        if kernel.COLUMN.get("circulatory"):
            raise self.other("has a damping that acts on displacements")
        if list(kernel.FIELDS) != ["y"] or kernel.COORDINATES:
            raise self.other("has more than the one deflection y")
        try:
            self.breaks = tuple(Fraction(v) for v in kernel.places(Fraction(1), **self._own))
            forms = kernel.forms(Fraction(1), **self._own)
        except (AttributeError, TypeError, ValueError) as error:
            raise self.other(f"has a factor that is no fraction: {reason(error)}") from None
        if len(forms["M"]) != 1 or len(forms["K"]) != 2:
            raise self.other("has a mass that changes with the load, or a load that enters squared")
        self.kinds = (str(kernel.COLUMN["ends"][0]), str(kernel.COLUMN["ends"][1]))
        if kernel.COLUMN["rigid"]:
            raise self.other("moves rigidly")
        self.opened = frozenset((self.breaks[node], order) for node, order in kernel.FIELDS["y"][2])
        stiffness, apart = self._joints(forms["K"][0][1])
        self.joints: dict[Place, Fraction] = stiffness
        (mass, points), (elastic, springs), (load, self.load_points) = (
            self.read(*part) for part in (*forms["M"], (forms["K"][0][0], apart), forms["K"][1])
        )
        self.m, self.EI = ([part.pop(orders, []) for part in parts] for parts, orders in
                           ((mass, (0, 0)), (elastic, (2, 2))))  # fmt: skip
        if any((1, 1) in part for part in mass):
            raise self.other("has a rotary inertia along the beam")
        if any(mass) or any(max(pair) > 1 for part in (*elastic, *load) for pair in part):
            raise self.other("has an energy of another order than ∫ m yₜ² and ∫ EI y''²")
        if not all(over(f, x)[0] > 0 for n, x in self.pieces() for f in (self.m[n], self.EI[n])):
            raise self.other("has a mass or a stiffness that is not known to be positive")
        self.masses, self.springs = self._own_places(points), self._own_places(springs)
        if any(p != q for part in elastic for p, q in part):
            raise self.other("has an elastic energy that is not symmetric")
        self.elastic = [{p: f for (p, _), f in part.items()} for part in elastic]
        self.load = load
        self.share = self._bending_share()

    def other(self, what: str) -> NoStrips:
        """A refusal."""
        return NoStrips(f"{self.name} {what}, which no proof by gaps between frequencies serves")

    @property
    def stepped(self) -> bool:
        """Whether it has more than one segment or mass, or is held by springs alone: Lemma 7 does not serve it."""
        return len(self.m) > 1 or len(self.masses) > 1 or bool(self.lines)

    def _joints(self, points: Any) -> tuple[dict[Place, Fraction], list[Any]]:
        """The springs between the two sides of where y or y' jumps, and the terms that are none of them."""
        tables: dict[Place, dict[tuple[int, int], Fraction]] = {place: {} for place in self.opened}
        others = []
        for term in points:
            (_, p, a, side), (_, q, b, across), factor = term
            if (a, p) == (b, q) and (a, p) in tables:
                table = tables[Fraction(a), p]
                table[side, across] = table.get((side, across), Fraction(0)) + Fraction(factor)
            else:
                others.append(term)
        found = {place: table.get((1, 1), Fraction(0)) for place, table in tables.items()}
        for place, k in found.items():
            if not k > 0 or tables[place] != {sides: sign * k for sides, sign in JOINT.items()}:
                raise self.other("has a joint that is no spring between its two sides")
        return found, others

    @property
    def lines(self) -> list[Line]:
        """Straight lines that the ends allow, constant and slope, which springs alone hold then."""
        return [line for line, _ in rigid_motions(self.kinds)]

    def pieces(self) -> Iterator[tuple[int, arb]]:
        """Segment and stretch of x, which are all of the beam together."""
        for n, (low, high) in enumerate(zip(self.breaks, self.breaks[1:], strict=False)):
            for k in range(PIECES):
                yield n, exact(low) + exact(high - low) * (arb(k).union(arb(k + 1)) / PIECES)

    def read(
        self, along: Any, points: Any
    ) -> tuple[list[dict[tuple[int, int], Polynomial]], dict[tuple[Place, Place], Fraction]]:
        """Of each segment (test order, trial order) -> polynomial; (place, order) twice -> factor."""
        inner: list[dict[tuple[int, int], Polynomial]] = [{} for _ in self.breaks[1:]]
        for segments, _, p, _, q, factors in along:
            for n in segments:
                inner[n][p, q] = added(inner[n].get((p, q), []), [Fraction(v) for v in factors])
        found: dict[tuple[Place, Place], Fraction] = {}
        for (_, p, a, _), (_, q, b, _), factor in points:
            if not factor:
                continue
            if {(a, p), (b, q)} & self.opened:
                raise self.other("has a mass, a spring, a damper or a force on what jumps at a joint")
            if a not in self.breaks or b not in self.breaks or max(p, q) > 1:
                raise self.other("has a force or a sensor that is not at an end or where segments meet")
            if not (self.is_held(a, p) or self.is_held(b, q)):
                key = (Fraction(a), p), (Fraction(b), q)
                found[key] = found.get(key, Fraction(0)) + Fraction(factor)
        kept = [{key: f for key, f in part.items() if any(f)} for part in inner]
        return kept, {key: f for key, f in found.items() if f}

    def is_held(self, place: Any, order: int) -> bool:
        """Whether a geometric condition holds the displacement of an order at a place."""
        return place in (0, 1) and order in ORDERS[self.kinds[int(place)]]

    def _own_places(self, points: Mapping[tuple[Place, Place], Fraction]) -> dict[Place, Fraction]:
        """Springs or masses, each of a place of its own."""
        if any(row != of or factor < 0 for (row, of), factor in points.items()):
            raise self.other("has a mass or a spring that couples two places or is negative")
        return {row: factor for (row, _), factor in points.items()}

    # ---------------------------------------------------------------- energy and mass

    @cached_property
    def reach(self) -> tuple[dict[int, arb], dict[int, arb]]:
        """κ with ‖y^(q)‖ ≤ κ ‖y''‖ on (0, 1), and with |y^(q)(x)| ≤ κ ‖y''‖ at any x. Raises NoStrips."""
        one = arb(1)
        if self.lines:
            raise self.other("is held by springs alone, and not under a load of the follower kind")
        if "clamped" in self.kinds:
            return OF_CLAMPED
        if "sliding" in self.kinds:  # the same, and y vanishes at the other end
            return {0: one / 2, 1: (one / 2).sqrt()}, {0: 2 * one / 3, 1: one}
        return {0: one / 2, 1: one}, {0: one / 2, 1: one}  # y' has a zero between two ends that are held

    def by_energy(self, norms: Mapping[int, arb]) -> dict[int, arb]:
        """What `reach` has in parts of ‖y''‖, in parts of the root of ∫ EI y''² and the joints' energy together.

        y less its jumps, each times a function of two straight parts that meets the conditions and has no value or
        slope above 1, is without a jump.
        """
        jumps = sum((1 / exact(k).sqrt() for k in self.joints.values()), arb(0))
        return {order: norm / self.least.sqrt() + jumps for order, norm in norms.items()}

    @cached_property
    def lowest(self) -> arb:
        """A frequency ω that is not above the first without load.

        Held by springs alone y is a line, y(0) + y'(0) x, and a rest as of a clamped end. With s the least of the
        springs' energy over the mass of lines, c² and d² those of the rest at most, over its energy,
        √mass ≤ √energy ((1 + c)/√s + d).
        """
        norms, points = map(self.by_energy, OF_CLAMPED if self.lines else self.reach)
        energy, mass = (
            sum((exact(f) * points[order] ** 2 for (_, order), f in table.items()), arb(0))
            for table in (self.springs, self.masses)
        )
        mass += norms[0] ** 2 * greatest(over(self.m[n], x)[0].upper() for n, x in self.pieces())
        if not self.lines:
            return (self.share / mass).sqrt().lower()
        pairs = [*product(self.lines, self.lines)]
        S = [_of_points(self.springs, *pair) for pair in pairs]
        M = [_of_points(self.masses, *pair) + self._mass_of(*pair) for pair in pairs]
        if len(self.lines) == 1:
            s = S[0] / M[0]
        else:  # det(S − s M) = 0; its smaller root is at least the product over the sum of both
            s = (S[0] * S[3] - S[1] * S[2]) / (S[0] * M[3] + S[3] * M[0] - 2 * S[1] * M[1])
        if s == 0:
            raise self.other("is held in part alone")
        return (1 / ((1 + energy.sqrt()) / exact(s).sqrt() + mass.sqrt())).lower()

    def _mass_of(self, one: Line, other: Line) -> Fraction:
        """∫ m of the product of two lines."""
        total = Fraction(0)
        for n, f in enumerate(self.m):
            total += self._integral(n, _product(f, _product([*one], [*other])))
        return total

    def _integral(self, n: int, f: Polynomial) -> Fraction:
        """∫ f dx on a segment."""
        whole = [Fraction(0), *(v / (i + 1) for i, v in enumerate(f))]
        return at(whole, self.breaks[n + 1]) - at(whole, self.breaks[n])

    @cached_property
    def least(self) -> arb:
        """Of EI."""
        return least(over(self.EI[n], x)[0].lower() for n, x in self.pieces())

    def _bending_share(self) -> arb:
        """θ with a(y, y) ≥ θ ∫ EI y''² dx: 1 unless a dead load is part of the energy."""
        lost = arb(0)
        for n, part in enumerate(self.elastic):
            for p, f in part.items():
                if self.never_negative(n, f):
                    continue
                turned = [e for e in (0, 1) if self.is_held(e, 1)]
                if p == 0 or not turned or self.joints or not self.never_negative(n, [-v for v in f]):
                    raise self.other("has an elastic energy that is not known to be positive")
                away = _product(f, [Fraction(0), Fraction(1)] if turned[0] == 0 else [Fraction(1), Fraction(-1)])
                lost -= exact(self._integral(n, away))
        share: arb = 1 - lost / self.least
        if not share > 0:
            raise self.other("has an elastic energy that is not known to be positive")
        return share

    def never_negative(self, n: int, f: Polynomial) -> bool:
        """Whether all of Bernstein's coefficients on a segment are at least zero."""
        low, high = self.breaks[n : n + 2]
        degree = len(f) - 1
        g = [(high - low) ** i * sum(comb(k, i) * f[k] * low ** (k - i) for k in range(i, degree + 1))
             for i in range(degree + 1)]  # fmt: skip
        return all(
            sum(Fraction(comb(i, j), comb(degree, j)) * g[j] for j in range(i + 1)) >= 0 for i in range(degree + 1)
        )


def _of_points(points: Mapping[Place, Fraction], one: Line, other: Line) -> Fraction:
    """Springs' energy, or masses', of two lines."""
    lines = [*one], [*other]
    return sum(
        (
            f * prod(at(line if order == 0 else line[1:], place) for line in lines)
            for (place, order), f in points.items()
        ),
        Fraction(0),
    )


def over_both(low: ColumnForms, high: ColumnForms) -> ColumnForms:
    """Of all values of a parameter between, that masses or springs alone hang on: these as balls.

    Raises NoStrips where more than that hangs on it, and where not all frequencies rise with it or not all fall.
    """
    both: Any = copy(low)
    same = ("breaks", "kinds", "m", "EI", "elastic", "load", "load_points", "opened")
    if any(getattr(low, part) != getattr(high, part) for part in same):
        raise low.other("has a parameter over a range that more than masses and springs hang on")
    stiffer = {
        (other.get(key, Fraction(0)) > f) == rises
        for one, other, rises in (
            (low.masses, high.masses, False),
            (low.springs, high.springs, True),
            (low.joints, high.joints, True),
        )
        for key, f in ({key: Fraction(0) for key in other} | one).items()
        if f != other.get(key, Fraction(0))
    }
    if len(stiffer) != 1:
        raise low.other("has a parameter over a range by which not all frequencies rise, or all fall")
    both.masses, both.springs, both.joints = (
        {key: exact(Range(*sorted((one.get(key, Fraction(0)), other.get(key, Fraction(0)))))) for key in {*one, *other}}
        for one, other in ((low.masses, high.masses), (low.springs, high.springs), (low.joints, high.joints))
    )
    found: ColumnForms = both
    return found


def at(f: Polynomial, x: Fraction) -> Fraction:
    """f at a place."""
    return sum((v * x**i for i, v in enumerate(f)), Fraction(0))


def value(f: Polynomial, x: Any) -> Any:
    """f on a ball."""
    total = x * 0
    for a in reversed(f):
        total = total * x + exact(a)
    return total


def over(f: Polynomial, x: arb, order: int = 1) -> list[arb]:
    """f and its first derivatives over j!, each in Taylor's form about the middle of x."""
    middle = x.mid()
    found = []
    for j in range(order):
        total = arb(0)
        for i in reversed(range(j, len(f))):
            total = total * (x - middle) + comb(i, j) * value([comb(n, i) * f[n] for n in range(i, len(f))], middle)
        found.append(total)
    return found


def added(f: Polynomial, g: Polynomial) -> Polynomial:
    """f + g."""
    return [(f[n] if n < len(f) else Fraction(0)) + (g[n] if n < len(g) else 0) for n in range(max(len(f), len(g)))]


def _product(f: Polynomial, g: Polynomial) -> Polynomial:
    total = [Fraction(0)] * (len(f) + len(g) - 1)
    for i, a in enumerate(f):
        for j, b in enumerate(g):
            total[i + j] += a * b
    return total
