"""How large a column's load is against its energy and its mass, for the verifier (docs/theorem.md, Lemmas 6 and 12).

Of the verifier of certificates of the beam itself (`verifier_of_sections`); it shares no code with the prover. By parts
the load is an integral without derivatives of v, and values of v at places. Where a place carries a mass, that bounds
the value; where none is, as at a joint, the energy and the mass of the segments beside it do.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from flint import arb, fmpq_poly

from freebeam_derive.certify import verifier_claims as v
from freebeam_derive.certify.verifier_claims import ball, exact, greatest, least, require
from freebeam_derive.certify.verifier_sections import Place, Sections, add, at

PARTS = [Fraction(4, 5) ** k for k in range(24)]  # lengths that are tried, in parts of the segment
KERNELS: dict[int, list[Any]] = {0: [0, 1, -2, 1], 1: [1, 0, -3, 2]}
"""g with y⁽ⁱ⁾ = ± ∫ y'' g − y g'' dx at 0, by i: of g and g' at both ends all but g⁽¹⁻ⁱ⁾(0) = 1 are nothing."""
Side = tuple[int, int, int]  # a place, and the side that it is seen from where y⁽ⁱ⁾ jumps there, else 0
Table = dict[Side, Fraction]


@dataclass(frozen=True)
class Beside:
    """y⁽ⁱ⁾ at an end of a segment, or a sum of such of two: at most (bend h² + move) h^(−1/2−i), for every h up to a
    length, where y has an energy and a mass of 1."""

    order: int
    bend: arb
    move: arb
    length: arb

    def most(self, of_energy: arb, of_mass: arb) -> arb:
        """What it is at most, with the roots of energy and mass."""
        found = []
        for part in PARTS:
            h = (self.length * ball(part)).lower()
            found.append((self.bend * of_energy * h * h + self.move * of_mass) * h.sqrt() / h ** (1 + self.order))
        return arb(least(found).upper())


def beside(column: Sections, order: int, factors: dict[int, arb]) -> Beside:
    """Σ c y⁽ⁱ⁾ at one place, seen from segments beside it, each with its c."""
    g = fmpq_poly([exact(Fraction(c)) for c in KERNELS[order]])
    of_value, of_bend = (arb((f * f).integral()(1)) for f in (g, g.derivative().derivative()))
    bend, move = arb(0), arb(0)
    for n, c in factors.items():
        m, EI = (least(at(f[n], x).lower() for x, _ in column.pieces(n)) for f in (column.m, column.EI))
        bend, move = bend + c * c * of_value / (EI * column.bending), move + c * c * of_bend / m
    length = least(ball(column.breaks[n + 1] - column.breaks[n]) for n in factors)
    return Beside(order, bend.sqrt(), move.sqrt(), length)


def value(column: Sections, place: Place, factors: dict[int, Fraction]) -> list[Beside]:
    """Bounds of Σ c y⁽ⁱ⁾ at a place; factors: by side. Of what does not jump either side may be taken, or the mean."""
    node, order = place
    if 0 not in factors:
        return [beside(column, order, {node - (side < 0): ball(c) for side, c in factors.items()})]
    near = [n for n in (node - 1, node) if 0 <= n < len(column.m)]
    c = ball(factors[0])
    means = [beside(column, order, dict.fromkeys(near, c / 2))] if len(near) == 2 else []
    return [*(beside(column, order, {n: c}) for n in near), *means]


def most(options: Sequence[Beside], of_energy: arb, of_mass: arb) -> arb:
    """The least of several bounds."""
    return least(each.most(of_energy, of_mass) for each in options)


@dataclass(frozen=True)
class LoadSize:
    """|b(y, v)| ≤ C √a(y, y) ‖v‖ but for q(y) v(e) at places without a mass; or the same with y and v exchanged.

    constant: C. places: bounds of each v(e), of what q(y) is the sum of, and of |q(y)| over √a(y, y); of one column, or
    of each of two that has such places.
    """

    constant: arb
    places: list[list[tuple[list[Beside], list[list[Beside]], arb]]]

    def at(self, low: arb, high: arb) -> arb:
        """What a gap between frequencies from `low` to `high` must be wider than, for a load of 1: Lemma 12."""
        found = [arb(0)]
        for places in self.places:
            total = arb(0)
            for of_v, of_y, still in places:
                felt = sum((most(each, arb(1), 1 / low) for each in of_y), arb(0)).min(still)
                total += most(of_v, high, arb(1)) * felt
            found.append(total)
        return (self.constant + greatest(found)).upper()


def load_size(columns: Sequence[Sections]) -> LoadSize:
    """Of the load; of two columns that of each between them, which differ in one condition. Raises Refused.

    C is convex in a mass, a spring and a force. All that the load does at a place without a mass is at most what it is
    where that spring of a joint or that mass is less, as long as the forces do not change.
    """
    found, refused = list[LoadSize](), list[v.Refused]()
    for turned in (False, True):
        try:
            sizes = [size(column, turned) for column in columns]
            still = all(of.forces == columns[0].forces for of in columns) or not any(of.places for of in sizes)
            require(still, "over a range of a force the load acts at a place without a mass")
        except v.Refused as error:
            refused.append(error)
        else:
            places = [at for of in sizes for at in of.places]
            found.append(LoadSize(greatest(of.constant for of in sizes), places))
            if not found[-1].places:
                return found[-1]
    if not found:
        raise refused[0]
    return min(found, key=lambda of: max(map(len, of.places)))


def size(column: Sections, turned: bool) -> LoadSize:
    """All derivatives go off the factor whose mass bounds it; turned: off the other one. Raises Refused."""
    inner: list[dict[int, fmpq_poly]] = [{} for _ in column.m]
    points: dict[Side, Table] = {}

    def point(place: Place, of: Place, f: Any, side: int) -> None:
        if column.held(place) or column.held(of) or not f:
            return
        row, seen = ((*p, side if p in column.joints else 0) for p in (place, of))
        table = points.setdefault(row, {})
        table[seen] = table.get(seen, Fraction(0)) + f

    for (row, of), force in column.forces.items():
        point(*((of, row) if turned else (row, of)), force, 0)
    for n, table in enumerate(column.load):
        for pair, f in table.items():
            i, j = pair[::-1] if turned else pair
            add(inner[n], i + j, f * (-1) ** i)
            if i:
                add(inner[n], j, -f.derivative())
                for node, side in ((n, 1), (n + 1, -1)):
                    end = f(exact(column.breaks[node]))
                    point((node, 0), (node, j), -side * Fraction(int(end.p), int(end.q)), side)
    along: dict[int, arb] = {}
    for n, parts in enumerate(inner):
        for q, f in parts.items():
            if f.degree() < 0:
                continue
            for x, _ in column.pieces(n):
                square = at(f, x) ** 2 / at(column.m[n], x)
                bent = 1 / (at(column.EI[n], x) * column.bending)
                felt = bent if q == 2 else _by_energy(column, column.reach(q)[0]) ** 2
                along[q] = along.get(q, arb(0)).max((square * felt).upper())
    total, places = arb(sum((square.sqrt() for square in along.values()), arb(0)) ** 2), []
    for of_v, of_y in _rows(points):
        (node, order, _), *_ = of_v
        still = _still(column, of_y)
        if column.masses.get((node, order), 0) > 0:
            total += still**2 / ball(column.masses[node, order])
            continue
        require(order == 0, "the load is a moment at a place without a rotary inertia, and is none of a follower")
        (bounds,) = _values(column, of_v)
        places.append((bounds, _values(column, of_y), still))
    return LoadSize(arb(total.sqrt().upper()), [places] if places else [])


def _rows(points: dict[Side, Table]) -> list[tuple[Table, Table]]:
    """Of v(e), or its jump where both sides are loaded by opposite forces, what it is multiplied by."""
    points = {row: kept for row, table in points.items() if (kept := {of: f for of, f in table.items() if f})}
    found = []
    for (node, order, side), table in points.items():
        across = (node, order, -side)
        if side and points.get(across) == {of: -f for of, f in table.items()}:
            if side > 0:
                found.append(({(node, order, 1): Fraction(1), across: Fraction(-1)}, table))
        else:
            found.append(({(node, order, side): Fraction(1)}, table))
    return found


def _values(column: Sections, table: Table) -> list[list[Beside]]:
    places = {(node, order) for node, order, _ in table}
    return [
        value(column, place, {side: f for (*of, side), f in table.items() if (*of,) == place})
        for place in sorted(places)
    ]


def _by_energy(column: Sections, norm: arb) -> arb:
    """What is at most `norm` times ‖y''‖ without joints, at most in parts of √a(y, y) with them."""
    jumps = sum((1 / ball(k).sqrt() for k in column.joints.values()), arb(0))
    return arb(norm / (column.softest * column.bending).sqrt() + jumps)


def _still(column: Sections, table: Table) -> arb:
    """What |Σ f y⁽ⁱ⁾(e)| is at most over √a(y, y): a jump of its spring's energy, all else of all of it."""
    total, both = arb(0), dict[Place, Fraction]()
    for (node, order, side), f in table.items():
        both[node, order] = both.get((node, order), Fraction(0)) + f
        if side > 0:
            total += abs(ball(f)) / ball(column.joints[node, order]).sqrt()
    for (_, order), f in both.items():
        if f:
            total += abs(ball(f)) * _by_energy(column, column.reach(order)[1])
    return total
