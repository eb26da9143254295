"""What a file says of damping: a form, taken apart into c_E E + c_M M + R, for the verifier.

Of the verifier of certificates of the beam itself (`verifier_of_sections`); it shares no code with the prover.
"""

from __future__ import annotations

from fractions import Fraction
from typing import Any

from flint import fmpq_poly

from freebeam_derive.certify import verifier_claims as v
from freebeam_derive.certify.verifier_claims import exact, require
from freebeam_derive.certify.verifier_damping import Damped, fraction, ratios
from freebeam_derive.certify.verifier_sections import Place, Sections, add, at, form

Tables = tuple[list[dict[tuple[int, int], fmpq_poly]], dict[tuple[Place, Place], Fraction]]


def damped(data: Any, column: Sections) -> Damped | None:
    """What a file says of damping. Raises Refused."""
    return None if data is None else split(*stated(data, column), data["vanishing"], column)


def stated(data: Any, column: Sections) -> Tables:
    """The form of damping in a file. Raises Refused."""
    require(set(data) == {"form", "vanishing"} and type(data["vanishing"]) is bool, "the damping is no form of its own")
    return form(data["form"], column)


def between(one: Tables, other: Tables, share: Fraction) -> Tables:
    """The form at a share of the way from one to another."""
    tables: list[dict[tuple[int, int], fmpq_poly]] = [{} for _ in one[0]]
    points: dict[tuple[Place, Place], Fraction] = {}
    for weight, (along, at_places) in ((1 - share, one), (share, other)):
        for table, part in zip(tables, along, strict=True):
            for key, f in part.items():
                add(table, key, f * exact(weight))
        for place, factor in at_places.items():
            points[place] = points.get(place, Fraction(0)) + weight * factor
    return tables, points


def split(
    tables: list[dict[tuple[int, int], fmpq_poly]],
    points: dict[tuple[Place, Place], Fraction],
    vanishing: bool,
    column: Sections,
) -> Damped:
    """c_E E + c_M M + R of a form of damping. Raises Refused."""
    tables = [dict(table) for table in tables]
    require(all(p == q for table in tables for p, q in table), "the damping couples motions")
    require(all(row == of for row, of in points), "the damping couples motions")
    # so that it takes energy
    positive = all(_never_negative(column, n, f) for n, table in enumerate(tables) for f in table.values())
    require(positive and all(f >= 0 for f in points.values()), "the damping is not known to take energy")
    shares = {_quotient(table.pop((2, 2), fmpq_poly([0])), column.EI[n]) for n, table in enumerate(tables)}
    require(len(shares) == 1 and None not in shares, "the internal damping is not the bending stiffness times a number")
    c_E = shares.pop() or Fraction(0)
    at_places = {key: f for (key, _), f in points.items()}
    beside = (
        [_less({p: f for (p, _), f in table.items()}, column.elastic[n], c_E) for n, table in enumerate(tables)],
        {key: at_places.get(key, Fraction(0)) - c_E * column.springs.get(key, Fraction(0))
         for key in {**at_places, **column.springs, **column.masses}},
    )  # fmt: skip
    bare = any(f and not column.masses.get(key, 0) for key, f in beside[1].items())
    require(not bare or (vanishing and c_E > 0), "a damper, or a spring without internal damping, is where no "
            "mass is, and other than in the limit of vanishing internal damping")  # fmt: skip
    c_M = _of_mass(column, [table.get(0, fmpq_poly([0])) for table in beside[0]])
    along = [_less(table, {0: column.m[n]}, c_M) for n, table in enumerate(beside[0])]
    points_left = {key: f - c_M * column.masses.get(key, Fraction(0)) for key, f in beside[1].items()}
    found = Damped(column, c_E, c_M, vanishing, along, points_left, beside)
    require(c_E > 0 or c_M > 0, "there is no damping at all along the beam")
    return found


def _of_mass(column: Sections, parts: list[fmpq_poly]) -> Fraction:
    """c_M, any number from 0 on: where the damping is the mass times a number that one, else one in the middle."""
    each = {_quotient(f, column.m[n]) for n, f in enumerate(parts)}
    number = each.pop() if len(each) == 1 else None
    if number is None:
        low, high = ratios(column, parts)
        number = Fraction(float(low) + float(high)) / 2
    return max(number, Fraction(0))


def _less(table: dict[int, fmpq_poly], other: dict[int, fmpq_poly], factor: Fraction) -> dict[int, fmpq_poly]:
    found = dict(table)
    for order, f in other.items():
        add(found, order, -f * exact(factor))
    return found


def _quotient(f: fmpq_poly, g: fmpq_poly) -> Fraction | None:
    """The number that f is of g."""
    c = f[g.degree()] / g[g.degree()]
    return fraction(c) if f == g * c else None


def _never_negative(column: Sections, n: int, f: fmpq_poly) -> bool:
    return all(f[k] >= 0 for k in range(f.degree() + 1)) or all(at(f, x) >= 0 for x, _ in column.pieces(n))


def of_all_alike(found: Damped) -> bool:
    """Whether external damping alone vanishes, and damps all motions alike."""
    return found.vanishing and found.of_mass


def statement(found: Damped | None) -> dict[str, Any]:
    """Damping and the rest in words: C as c_M M + c_E E; where that is not all of it, as c_E E and the rest."""
    if found is None:
        return {}
    plain = found.plain
    stated = v.Damping(found.c_M if plain else Fraction(0), found.c_E, found.vanishing)
    return {"damping": stated, "beside": () if plain else tuple(found.words)}


def halfway(one: Damped, other: Damped) -> tuple[Damped, Fraction]:
    """The damping in the middle of two of one column, and what of its R the first has. Raises Refused."""
    half = exact(Fraction(1, 2))
    along = [{order: (a.get(order, fmpq_poly([0])) + b.get(order, fmpq_poly([0]))) * half for order in {**a, **b}}
             for a, b in zip(one.along, other.along, strict=True)]  # fmt: skip
    points = {key: (one.points.get(key, Fraction(0)) + other.points.get(key, Fraction(0))) / 2
              for key in {**one.points, **other.points}}  # fmt: skip
    c_E, c_M = (one.c_E + other.c_E) / 2, (one.c_M + other.c_M) / 2
    middle = Damped(one.column, c_E, c_M, one.vanishing, along, points, ([], {}))
    pairs = [(table.get(order, fmpq_poly([0])), f) for table, part in zip(one.along, along, strict=True)
             for order, f in part.items() if f.degree() >= 0]  # fmt: skip
    pairs += [
        (fmpq_poly([exact(one.points.get(key, Fraction(0)))]), fmpq_poly([exact(f)])) for key, f in points.items() if f
    ]
    shares = {_quotient(*pair) for pair in pairs} or {Fraction(1)}
    share = shares.pop()
    require(
        not shares and share is not None and (bool(pairs) or one.plain), "the range changes what is left of damping"
    )
    assert share is not None
    return middle, share
