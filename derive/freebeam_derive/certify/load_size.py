"""How large a column's load is against its energy and its mass: what Lemmas 6 and 12 of docs/theorem.md ask of it.

By parts on each segment b(y, v) is an integral without derivatives of v, and values of v at places. Where a place
carries a mass, that bounds the value; where it carries none, as at a joint, curvature and mass beside it do.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise

from flint import arb

from freebeam_derive.certify.balls import exact, least
from freebeam_derive.certify.column_forms import ColumnForms, Place, Polynomial, added, at, over
from freebeam_derive.certify.strips import NoStrips

Load = list[dict[tuple[int, int], Polynomial]]
Points = dict[tuple[Place, Place], Fraction]
Seen = tuple[Place, int]  # a place with its order, and the side it is seen from: 0 where both are the same
CUBICS = {
    (0, True): (Fraction(13, 35), Fraction(6, 5), Fraction(12)),  # 1 − 3x² + 2x³
    (1, True): (Fraction(1, 105), Fraction(2, 15), Fraction(4)),  # x − 2x² + x³
    (0, False): (Fraction(33, 140), Fraction(6, 5), Fraction(3)),  # 1 − 3x/2 + x³/2
}
"""∫ v², ∫ v'², ∫ v''² over a unit length of a v that vanishes with its slope at the far end, with v⁽ⁱ⁾(0) = 1 and
whether the other of v(0), v'(0) is nothing."""


@dataclass(frozen=True)
class Value:
    """A deflection or a slope at a place, or its jump there, times a factor: weight, over the segments beside it.

    By parts w(0) = ∫ w'' q − w q'' dx over a length ℓ, w'(0) = ∫ w q'' − w'' q dx. Of two sides it is the mean, or the
    difference, whose weights are their squares' root.
    """

    order: int
    weight: arb
    beside: tuple[int, ...]

    def most(self, forms: ColumnForms, of_energy: arb, of_mass: arb) -> arb:
        """What it is at most where the roots of energy and mass are."""
        EI, m = (least(over(f[n], x)[0].lower() for n, x in forms.pieces() if n in self.beside)
                 for f in (forms.EI, forms.m))  # fmt: skip
        bends, _, moves = map(exact, CUBICS[1 - self.order, True])
        energy, mass = of_energy * (bends / (EI * forms.share)).sqrt(), of_mass * (moves / m).sqrt()
        room = min(forms.breaks[n + 1] - forms.breaks[n] for n in self.beside)
        best = mass / energy * 3 if self.order else mass / energy / 3
        length = best.sqrt().min(exact(room)).lower()
        found: arb = self.weight * (energy * length + mass / length) * length.sqrt() / length**self.order
        return found


@dataclass(frozen=True)
class LoadSize:
    """b(y, v) as what C bounds, |…| ≤ C √a(y, y) ‖v‖ with ‖v‖² the mass of v, and q(y) v(e) at places without a mass;
    or the same with y and v exchanged.

    constant: C. places: of each v(e), values whose sum is q(y), and a bound of |q(y)| over √a(y, y).
    """

    forms: ColumnForms
    constant: arb
    places: tuple[tuple[Value, tuple[Value, ...], arb], ...] = ()

    def at(self, low: arb, high: arb) -> arb:
        """What the gap between two frequencies must be wider than for a load of 1."""
        total = self.constant
        for value, seen, size in self.places:
            felt = sum((of.most(self.forms, arb(1), 1 / low) for of in seen), arb(0)) if low > 0 else size
            total += value.most(self.forms, high, arb(1)) * felt.min(size)
        return total.upper()


def load_size(forms: ColumnForms) -> LoadSize:
    """Of the column's load, without places where that can be. Raises NoStrips."""
    found: list[LoadSize] = []
    refused: NoStrips | None = None
    for turned in (False, True):
        try:
            found.append(_size(forms, forms.load, forms.load_points, turned))
        except NoStrips as error:
            refused = refused or error
    if not found:
        assert refused is not None
        raise refused
    return min(found, key=lambda size: len(size.places))


def size_along(forms: ColumnForms, form: Load) -> arb:
    """C of another form, symmetric and without terms at places. Raises NoStrips."""
    size = _size(forms, form, {}, False)
    if size.places:
        raise forms.other("has a damping of slopes that acts on a place that carries no mass")
    return size.constant


def _size(forms: ColumnForms, load: Load, points: Points, turned: bool) -> LoadSize:
    """turned: for the form with y and v exchanged. All derivatives go off the factor of bounded mass."""
    inner, at_places = _by_parts(forms, load, points, turned)
    squares: dict[int, arb] = {}
    for n, x in forms.pieces():
        for q, f in ((q, f) for q, f in inner[n].items() if any(f)):
            share = over(f, x)[0] ** 2 / over(forms.m[n], x)[0]
            size = 1 / over(forms.EI[n], x)[0] if q == 2 else forms.by_energy(forms.reach[0])[q] ** 2
            squares[q] = squares.get(q, arb(0)).max((share * size).upper())
    along = sum((square.sqrt() for square in squares.values()), arb(0))
    total, places = along * along, []
    for rows, table in _together(at_places):
        ((place, order), _), *_ = rows
        felt = _felt(forms, table)
        if (place, order) in forms.masses:
            total += felt * felt / exact(forms.masses[place, order])
        elif order == 0:
            (value,) = _values(forms, rows)
            places.append((value, _values(forms, table), (felt / forms.share.sqrt()).upper()))
        else:
            where = "an end" if place in (0, 1) else "a place"
            raise forms.other(f"has a moment as a load on {where} that carries no mass with a rotary inertia")
    return LoadSize(forms, (total / forms.share).sqrt().upper(), tuple(places))


def _together(at_places: dict[Seen, dict[Seen, Fraction]]) -> list[tuple[dict[Seen, Fraction], dict[Seen, Fraction]]]:
    """Values of v with what multiplies them: a jump of v where both sides have opposite factors."""
    found = []
    for (place, side), table in sorted(at_places.items()):
        opposite = {seen: -f for seen, f in table.items()}
        if side and at_places.get((place, -side)) == opposite:
            if side > 0:
                found.append(({(place, 1): Fraction(1), (place, -1): Fraction(-1)}, table))
        else:
            found.append(({(place, side): Fraction(1)}, table))
    return found


def _values(forms: ColumnForms, table: dict[Seen, Fraction]) -> tuple[Value, ...]:
    """What a sum of values at places is bounded by."""
    found = []
    for place, order in {place for place, _ in table}:
        factors = {side: exact(f) for (of, side), f in table.items() if of == (place, order)}
        beside = tuple(
            n for n, (low, high) in enumerate(pairwise(forms.breaks))
            if (place == low and factors.keys() & {0, 1}) or (place == high and factors.keys() & {0, -1})
        )  # fmt: skip
        weight = sum((f * f for f in factors.values()), arb(0)).sqrt()
        found.append(Value(order, weight / (arb(len(beside)).sqrt() if 0 in factors else 1), beside))
    return tuple(found)


def _by_parts(
    forms: ColumnForms, load: Load, points: Points, turned: bool
) -> tuple[list[dict[int, Polynomial]], dict[Seen, dict[Seen, Fraction]]]:
    """Of each segment, order of y -> factor of ∫ y^(q) v; of places, v there -> y there -> factor."""
    inner: list[dict[int, Polynomial]] = [{} for _ in load]
    found: dict[Seen, dict[Seen, Fraction]] = {}

    def add(place: Place, of: Place, side: int, factor: Fraction) -> None:
        if forms.is_held(*place) or forms.is_held(*of):
            return
        row, seen = ((value, side if value in forms.opened else 0) for value in (place, of))
        table = found.setdefault(row, {})
        table[seen] = table.get(seen, Fraction(0)) + factor

    for pair, force in points.items():
        place, of = pair[::-1] if turned else pair
        add(place, of, 0, force)
    for n, part in enumerate(load):
        for orders, f in part.items():
            p, q = orders[::-1] if turned else orders
            if p == 1:  # ∫ f y^(q) v' = [f y^(q) v] − ∫ (f y^(q))' v
                for e, side in zip(forms.breaks[n : n + 2], (1, -1), strict=True):
                    add((e, 0), (e, q), side, -side * at(f, e))
                slope = [i * v for i, v in enumerate(f)][1:]
                for order, factor in ((q, slope), (q + 1, f)):
                    inner[n][order] = added(inner[n].get(order, []), [-v for v in factor])
            else:
                inner[n][q] = added(inner[n].get(q, []), f)
    return inner, {row: kept for row, table in found.items() if (kept := {of: f for of, f in table.items() if f})}


def _felt(forms: ColumnForms, table: dict[Seen, Fraction]) -> arb:
    """What Σ f y^(q)(e) is at most, in parts of the root of the energy of y: where y^(q) jumps, its jump alone if the
    factors on both sides are opposite."""
    total = arb(0)
    for (place, side), factor in table.items():
        if side == 0:
            total += abs(exact(factor)) * forms.by_energy(forms.reach[1])[place[1]]
        elif side == 1:
            total += abs(exact(factor)) / exact(forms.joints[place]).sqrt()
    for place in {place for place, side in table if side}:
        both = sum((table.get((place, side), Fraction(0)) for side in (-1, 1)), Fraction(0))
        if both:
            total += abs(exact(both)) * forms.by_energy(forms.reach[1])[place[1]]
    return total
