"""A column of variable or stepped section with masses, springs and joints, for the verifier.

Of the verifier of certificates of the beam itself (`verifier_of_sections`); it shares no code with the prover. One
deflection y goes on with its slope from each segment to the next, but at joints, where a spring holds the jump of one
of them. EI, m and the factors of forms are polynomials in x on each segment; masses, springs and what the load does at
places stand at the ends and where segments meet.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import cached_property
from itertools import pairwise
from typing import Any

from flint import arb, arb_poly, fmpq_poly

from freebeam_derive.certify import verifier_beam_claims as claims
from freebeam_derive.certify import verifier_claims as v
from freebeam_derive.certify.decimals import said
from freebeam_derive.certify.verifier_claims import ball, exact, least, require
from freebeam_derive.certify.verifier_signs import Stretch

SECTIONS = "freebeam certificate 6"
FIELDS = {"format", "column", "parameters", "ends", "breaks", "forms", "lowest", "line", "kind", "load",
          "frequency_squared", "proof", "stretches", "damping", "joints"}  # fmt: skip
MOST_SEGMENTS = 8  # there are as many waves as a power of two by it
PIECES = 256  # of a segment, on each of which a factor is one ball
Place = tuple[int, int]  # a break's number, order of the derivative there
LENGTHS = {True: (arb(1) / 3, arb("0.7072")), False: (arb(1) / 2, arb(1))}
"""κ with ‖y^(q)‖ ≤ κ ‖y''‖, where an end holds y and y', and else (docs/theorem.md, Lemma 6)."""


@dataclass(frozen=True)
class OfSections(claims.OfBeamItself):
    """A statement of such a column. In words, joints: what jumps where, and the spring that holds it; beside: what its
    damping C has besides c_M M + c_E E."""

    breaks: tuple[Fraction, ...]
    joints: tuple[str, ...]
    beside: tuple[str, ...]

    @property
    def forms(self) -> str:
        inner = [said(place) for place in self.breaks[1:-1]]
        return ", ".join([super().forms, *([f"breaks at {' and '.join(inner)}"] if inner else []), *self.joints])

    @property
    def damped(self) -> str:
        if self.damping is None:
            return "undamped"
        factors = [f"{said(f)} {name}" for f, name in ((self.damping.of_M, "M"), (self.damping.of_E, "E")) if f]
        limit = "in the limit of vanishing damping in the direction of " if self.damping.vanishing else ""
        return f"{limit}C = {' + '.join([*factors, *self.beside])}"

    def record(self) -> dict[str, Any]:
        stated = super().record() | {"breaks": [*map(said, self.breaks)], "joints": [*self.joints]}
        if self.damping is not None:
            stated["damping"] |= {"beside": [*self.beside]}
        return {key: value for key, value in stated.items() if key not in ("modes", "basis")}


@dataclass(frozen=True)
class Sections:
    """What the forms in a file say.

    EI, m: a polynomial a segment. elastic: order -> polynomial, load: (test order, trial order) -> polynomial, a table
    a segment. masses, springs: of places. forces: of the load, (test place, trial place) -> factor. joints: of what
    jumps at a place, the spring that holds the jump.
    """

    ends: tuple[str, str]
    breaks: tuple[Fraction, ...]
    EI: list[fmpq_poly]
    m: list[fmpq_poly]
    elastic: list[dict[int, fmpq_poly]]
    load: list[dict[tuple[int, int], fmpq_poly]]
    masses: dict[Place, Fraction]
    springs: dict[Place, Fraction]
    forces: dict[tuple[Place, Place], Fraction]
    joints: dict[Place, Fraction] = field(default_factory=dict)

    def held(self, place: Place) -> bool:
        """Whether a geometric condition holds the displacement there."""
        node, order = place
        return node in (0, len(self.breaks) - 1) and order in v.ORDERS[self.ends[1 if node else 0]]

    def pieces(self, segment: int) -> Iterator[tuple[arb, arb]]:
        """Stretches of x that are all of a segment, and their length."""
        low, high = map(ball, self.breaks[segment : segment + 2])
        for k in range(PIECES):
            yield low + (high - low) * (arb(k).union(arb(k + 1)) / PIECES), (high - low) / PIECES

    # ---------------------------------------------------------------- energy

    @cached_property
    def bending(self) -> arb:
        """What a(y, y) is at least, in parts of ∫ EI y''² dx."""
        lost, sides = arb(0), [e for e in (0, 1) if self.held((e * len(self.m), 1))]
        for segment, table in enumerate(self.elastic):
            for order, f in table.items():
                for x, width in self.pieces(segment):
                    value = at(f, x)
                    if value >= 0:
                        continue
                    # y'(x)² ≤ |x − e| ∫ y''² dx where the end e holds y'
                    known = order == 1 and bool(sides) and not self.joints
                    require(known, "the elastic energy is not known to be positive")
                    lost += (-value).upper() * abs(x - sides[0]).upper() * width
        share = arb(1 - lost / self.softest)
        require(bool(share > 0), "the elastic energy is not known to be positive")
        return arb(share.lower())

    @cached_property
    def softest(self) -> arb:
        """The least EI."""
        return least(at(f, x).lower() for n, f in enumerate(self.EI) for x, _ in self.pieces(n))

    def reach(self, order: int) -> tuple[arb, arb]:
        """κ with ‖y^(q)‖ ≤ κ ‖y''‖, and with |y^(q)(x)| ≤ κ ‖y''‖ at any x."""
        last = len(self.m)
        lines = [f for f in ((1, 0), (0, 1), (1, -1)) if all(
            sum(f) * e + f[0] * (1 - e) == 0 if order == 0 else f[1] == 0
            for e in (0, 1) for order in (0, 1) if self.held((e * last, order))
        )]  # fmt: skip
        require(not lines, "the column is held by springs alone, under a load that is none of a follower")
        norm = LENGTHS["clamped" in self.ends][order]
        return norm, arb(1) if order or "clamped" not in self.ends else arb(2) / 3


def at(f: fmpq_poly, x: arb) -> arb:
    """A polynomial on a ball, from its middle."""
    middle, far = x.mid(), x - x.mid()
    g = arb_poly(f)
    value, slope, bend = g(middle), g.derivative()(middle), g.derivative().derivative()(x)
    return arb(value + far * (slope + far * bend / 2))


def add(table: dict[Any, fmpq_poly], key: Any, f: fmpq_poly) -> None:
    table[key] = table.get(key, fmpq_poly([0])) + f


# --- reading -------------------------------------------------------------------------------------------------------


def read(data: dict[str, Any]) -> tuple[OfSections, Sections, int, Fraction, tuple[Stretch, ...]]:
    """Of a file: what is claimed, the column, m, the line R_m, and the stretches. Raises Refused."""
    claims.fields({"joints": []} | data, FIELDS)
    still = {"modes": v.MOST_MODES, "alpha": "0", "beta": "0", "load_max": None}
    given = v.claims_of(data | still)
    require(given["kind"] != "none" and given["load"][1] < claims.HIGHEST, claims.NO_CROSSING)
    stated, column = stated_of(data, given)
    m, line = claims.lowest(data | still), v.number(data["line"])
    return stated, column, m, line, claims.stretches_of(data, m)


def stated_of(data: dict[str, Any], given: dict[str, Any]) -> tuple[OfSections, Sections]:
    """A statement of the column in a file, with these claims and without damping, and the column. Raises Refused."""
    left, right = data["ends"]
    require(left in v.ORDERS and right in v.ORDERS, "the ends are not known")
    require(type(data["breaks"]) is list and 1 < len(data["breaks"]) < MOST_SEGMENTS + 2,
            f"there are no segments, or more than {MOST_SEGMENTS}")  # fmt: skip
    breaks = tuple(map(v.number, data["breaks"]))
    whole = breaks[0] == 0 and breaks[-1] == 1 and all(a < b for a, b in pairwise(breaks))
    require(whole, "the breaks do not ascend from 0 to 1")
    none: dict[str, Any] = {"ours": False, "basis": "", "kappa": None, "damping": None, "beside": ()}
    column = sections((left, right), breaks, data["forms"], data.get("joints", []))
    return OfSections(**given, **none, ends=(left, right), breaks=breaks, joints=joints_said(column)), column


def joints_said(*columns: Sections) -> tuple[str, ...]:
    """Those of a column in words, or of two with the same jumps and of all between."""
    breaks, found = columns[0].breaks, list[str]()
    for node, order in columns[0].joints:
        springs = dict.fromkeys(said(column.joints[node, order]) for column in columns)
        jumps = "y" + order * "'" + f" jumps at x = {said(breaks[node])}"
        found.append(f"{jumps}, held by a spring of {' to '.join(springs)}")
    return tuple(found)


def sections(
    ends: tuple[str, str], breaks: tuple[Fraction, ...], forms: dict[str, Any], joints: Sequence[Any] = ()
) -> Sections:
    require(set(forms) == set("MEH"), "the forms are not M, E and H")
    count = len(breaks) - 1
    found = Sections(ends, breaks, [], [], [{} for _ in range(count)], [], {}, {}, {}, _joints(joints, count))
    each = {name: form(forms[name], found) for name in "MEH"}
    tables, points = {name: of[0] for name, of in each.items()}, {name: of[1] for name, of in each.items()}
    for n in range(count):
        found.m.append(tables["M"][n].pop((0, 0), fmpq_poly([0])))
        found.EI.append(tables["E"][n].pop((2, 2), fmpq_poly([0])))
        require(not tables["M"][n], "the mass is none of the displacement along the beam")
        positive = all(at(f, x) > 0 for f in (found.m[n], found.EI[n]) for x, _ in found.pieces(n))
        require(positive, "a mass or a stiffness along the beam is not known to be positive")
        require(all(p == q for p, q in tables["E"][n]), "the elastic energy is not symmetric")
        require((2, 2) not in tables["H"][n], "a form acts on curvatures")
        found.elastic[n].update({p: f for (p, _), f in tables["E"][n].items()})
        found.load.append(tables["H"][n])
    for name, table in (("M", found.masses), ("E", found.springs)):
        for (row, of), f in points[name].items():
            require(row == of and f >= 0, "a mass or a spring couples two places, or is negative")
            table[row] = f
    require(all(row[0] == of[0] or {row[0], of[0]} <= {0, count} for row, of in points["H"]),
            "the load at a place depends on another one")  # fmt: skip
    at_places = {*found.masses, *found.springs, *(place for pair in points["H"] for place in pair)}
    require(not at_places & {*found.joints}, "a mass, a spring or a force acts on what jumps at a joint")
    return replace(found, forces=points["H"])


def _joints(data: Sequence[Any], last: int) -> dict[Place, Fraction]:
    """Of what jumps, the spring. Raises Refused."""
    require(type(data) in (list, tuple) and len(data) < 2 * last, "there are too many joints")
    found = dict[Place, Fraction]()
    for node, order, k in data:
        _whole((node, last - 1), (order, 1))
        found[node, order] = v.number(k)
        require(node > 0 and found[node, order] > 0, "a joint is at an end, or has no spring")
    require(len(found) == len(data), "a joint is named twice")
    return found


def form(
    data: dict[str, Any], column: Sections
) -> tuple[list[dict[tuple[int, int], fmpq_poly]], dict[tuple[Place, Place], Fraction]]:
    """Of each segment (test order, trial order) -> polynomial; (test place, trial place) -> factor. Raises Refused."""
    require(set(data) == {"along", "points"}, "a form has other parts than integrals and values at places")
    require(len(data["along"]) + len(data["points"]) <= v.MOST_TERMS, "a form has too many terms")
    count, points = len(column.breaks) - 1, dict[tuple[Place, Place], Fraction]()
    tables: list[dict[tuple[int, int], fmpq_poly]] = [{} for _ in range(count)]
    for n, k, p, q, f in data["along"]:
        _whole((n, count - 1), (k, v.HIGHEST_POWER), (p, 2), (q, 2))
        require((p, q) == (2, 2) if 2 in (p, q) else True, "a form acts on curvatures")
        add(tables[n], (p, q), fmpq_poly([0] * k + [exact(v.number(f))]))
    for a, p, b, q, f in data["points"]:
        _whole((a, count), (p, 1), (b, count), (q, 1))
        if not (column.held((a, p)) or column.held((b, q))):
            key = (a, p), (b, q)
            points[key] = points.get(key, Fraction(0)) + v.number(f)
    return tables, points


def _whole(*given: tuple[Any, int]) -> None:
    right = all(type(n) is int and 0 <= n <= most for n, most in given)
    require(right, "a form has no such segment, power, order or place")
