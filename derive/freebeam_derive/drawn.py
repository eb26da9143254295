"""What there is to draw of a column: what its statement holds at places and along the beam, with letters in LaTeX."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise

from sympy import Add, Expr, S, Symbol, cancel, expand

from freebeam_derive.jets import ALWAYS, beside, jet, jets, name_of, trial, varying, virtual
from freebeam_derive.latex import Printer, printer
from freebeam_derive.notation import NOTATION, P, alpha, beta, x
from freebeam_derive.statement import Column, Functional

__all__ = ["Parts", "Values", "chain", "depths", "parts_of"]

Named = list[tuple[float, str]]
Values = Mapping[Symbol, float]
SMALL = 1e-12


@dataclass
class Parts:
    """Places are numbers; a letter is that of the parameter that a part is stated with.

    loads: place, force in letters, and share of it that turns with the slope there: 1 for a follower, 0 for a dead
    load. sensors: where something is measured, and where the force acts that it sets. jumps: order of the derivative
    that jumps, and place, with the letter of the joint's spring. load: where it is stated along the beam, "inside" (a
    flow through a pipe), "outside" (over a panel), "follower" or "axis" (along the beam, by its direction); else "end".
    weight: letter of an axial load of the column's own, and whether it is spread. medium: where a part of the beam is
    damped outside, with the letter.
    """

    symbol: str
    masses: Named = field(default_factory=list)
    inertias: Named = field(default_factory=list)
    springs: Named = field(default_factory=list)
    turning: Named = field(default_factory=list)
    dampers: Named = field(default_factory=list)
    absorbers: Named = field(default_factory=list)
    loads: list[tuple[float, str, float]] = field(default_factory=list)
    sensors: list[tuple[float, float]] = field(default_factory=list)
    jumps: dict[tuple[int, float], str] = field(default_factory=dict)
    fixed_line: bool = False
    foundation: str = ""
    load: str = "end"
    weight: tuple[str, bool] = ("", False)
    medium: tuple[float, float, str] | None = None


@dataclass(frozen=True)
class _Stated:
    """A column at values of its parameters, and how their letters are printed."""

    column: Column
    values: Values
    printer: Printer

    def number(self, value: Expr) -> float:
        return float(value.subs(self.values))

    def letters(self, term: Expr) -> str:
        """Those of the column's own parameters that a term is stated with; not those of its places."""
        own = {p.symbol for p in self.column.parameters}
        at_places = {s for j in jets(term) for s in j.free_symbols}
        names = sorted((term.free_symbols & own) - at_places, key=str)
        return f"${' '.join(self.printer.doprint(s) for s in names)}$" if names else ""

    def at_places(self, work: Functional) -> list[tuple[list[Expr], list[float | None], Expr]]:
        """The point values that a work or an energy sums, each as its jets, their places and the whole term; a
        coordinate has no place."""
        found = []
        for term in Add.make_args(work.points):
            if term == 0:
                continue
            here = [j for j in jets(term) for _ in range(int(term.as_powers_dict().get(j, 1)))]
            stated = [j.args[3].args[0] if j.args[3].func == beside else j.args[3] for j in here]
            places = [place.subs(self.values) for place in stated]
            found.append((here, [float(v) if v.is_number else None for v in places], term))
        return found


def parts_of(column: Column, values: Values | None = None) -> Parts:
    """What there is to draw of a column. values: of its parameters, the defaults of those that are left out."""
    stated = _Stated(column, {**column.defaults, **(values or {})}, printer(column))
    parts = Parts(f"${NOTATION['P'].latex}$")
    T, V, W_c, W = (column.energies.functional(name) for name in ("T", "V", "W_c", "dW_nc"))
    opened = {(order, place) for name, order, place in V.opened if name == "y"}
    opened |= {(1, release.place) for release in column.releases}
    parts.jumps = dict.fromkeys(sorted((order, stated.number(place)) for order, place in opened), "")
    for here, (place, *_), term in stated.at_places(V):
        if place is not None and any(j.args[3].func == beside for j in here):
            parts.jumps[int(here[0].args[1]), place] = stated.letters(term)
    coupled = [
        (place, stated.letters(term))
        for _, places, term in stated.at_places(V)
        for place in places
        if None in places and place is not None
    ]
    parts.absorbers = list(dict.fromkeys(coupled))
    _squares(stated, T, (parts.masses, parts.inertias), parts)
    _squares(stated, V, (parts.springs, parts.turning), parts)
    _along(stated, V, W, parts)
    parts.load = _load(W_c.density, W.density)
    _loads(stated, W_c, W, parts, _forces(stated, W, parts))
    return parts


def _squares(stated: _Stated, energy: Functional, by_order: tuple[Named, Named], parts: Parts) -> None:
    """Energies of the square of y or of its slope at a place: masses and springs that are no joint's or absorber's."""
    taken = {(0, place) for place, _ in parts.absorbers} | set(parts.jumps)
    for here, (place, *_), term in stated.at_places(energy):
        if len(here) != 2 or here[0] != here[1] or place is None:
            continue
        order = int(_turns(here[0]))
        if (order, place) not in taken:
            by_order[order].append((place, stated.letters(term)))


def _turns(value: Expr) -> bool:
    """Whether it is a slope, or another field, which is an angle."""
    return bool(value.args[0] not in (0, 1) or value.args[1] == 1)


def _forces(stated: _Stated, work: Functional, parts: Parts) -> dict[float, Expr]:
    """Virtual work at places: dampers, sensors and a force on a fixed line; the forces by their places that turn with
    the slope there are handed back."""
    taken = {(0, place) for place, _ in parts.absorbers} | set(parts.jumps)
    turned: dict[float, Expr] = {}
    steered: dict[tuple[tuple[Expr, float], tuple[Expr, float]], float] = {}
    for here, places, term in stated.at_places(work):
        pairs = [(j, place) for j, place in zip(here, places, strict=True) if place is not None]
        if len(pairs) != 2:
            continue
        (sight, seen), (change, moved) = sorted(pairs, key=lambda pair: virtual(pair[0].args[0]))
        factor, rate = term / (sight * change), int(sight.args[2])
        if seen != moved:
            key = (_alike(sight), seen), (_alike(change), moved)
            steered[key] = steered.get(key, 0.0) + stated.number(factor.subs({P: 1, alpha: 1, beta: 1}))
        elif term.has(P) and _turns(change) and not _turns(sight):
            parts.fixed_line = True
        elif term.has(P) and _turns(sight) and not _turns(change):
            turned[moved] = turned.get(moved, S.Zero) - factor
        elif rate == 1 and _alike(sight)[:2] == _alike(change)[:2] and not term.has(alpha, beta):
            if (int(_turns(change)), moved) not in taken:
                parts.dampers.append((moved, stated.letters(term)))
    sensors = {
        (seen, moved)
        for ((sight, seen), (change, moved)), factor in steered.items()
        if abs(factor - steered.get(((change, moved), (sight, seen)), 0.0)) > SMALL
    }
    parts.sensors = sorted(sensors)
    return turned


def _alike(value: Expr) -> tuple[str, int]:
    """The unknown and the order of its derivative along the beam, the same for its variation."""
    return name_of(value.args[0]), int(value.args[1])


def _loads(stated: _Stated, axial: Functional, work: Functional, parts: Parts, turned: dict[float, Expr]) -> None:
    """Where the axial force of the load falls, by how much, and how much of that turns with the slope. A force of which
    all turns may be stated along the beam, −P ∫ y″ δy dx."""
    beam = stated.column.energies.beam
    pressed = [2 * axial.density.coeff(jet(0, 1, 0, along), 2) for along in beam.segments]
    along_all = parts.load == "end"
    following = [-along_all * work.density.coeff(jet(0, 2, 0, s)).coeff(jet(1, 0, 0, s)) for s in beam.segments]

    def fall_of(forces: list[Expr], number: int) -> Expr:
        return cancel((forces[number] - (*forces, S.Zero)[number + 1]).subs(x, beam.places[number + 1]))

    for number, place in enumerate(beam.places[1:]):
        at, follows = stated.number(place), fall_of(following, number)
        fall, share = fall_of(pressed, number) + follows, turned.pop(at, S.Zero) + follows
        size = stated.number((fall or share).subs(P, 1))
        if size > SMALL:
            letters = f"${stated.printer.doprint(fall or share)}$"
            parts.loads.append((at, letters, stated.number(share.subs(P, 1)) / size))
    for at, force in turned.items():
        if stated.number(force.subs(P, 1)) > SMALL:
            parts.loads.append((at, f"${stated.printer.doprint(force)}$", 1.0))


def _along(stated: _Stated, V: Functional, W: Functional, parts: Parts) -> None:
    """A foundation, an axial load of the column's own, and a medium around a part of the beam."""
    column = stated.column
    beam = column.energies.beam
    for k, along in enumerate(beam.segments):
        spring, axial = (V.density.coeff(jet(0, order, 0, along), 2) for order in (0, 1))
        damping = W.density.coeff(jet(0, 0, 1, along)).coeff(jet(1, 0, 0, along)).subs({alpha: 0, beta: 0})
        if spring != 0:
            parts.foundation = stated.letters(spring)
        if axial != 0 and column.fields == ("y",):
            parts.weight = stated.letters(axial), axial.has(x)
        if damping != 0 and beam.cuts:
            low, high = (stated.number(place) for place in beam.places[k : k + 2])
            parts.medium = low, high, stated.letters(damping)


def _load(axial: Expr, work: Expr) -> str:
    """How the load acts along the beam, from the densities of W_c and δW_nc."""
    pressed, pushed = ([t for t in Add.make_args(part) if t.has(P)] for part in (axial, work))
    if any(int(j.args[2]) for t in pushed for j in jets(t)):
        return "inside"
    if pushed and not pressed and all({int(j.args[1]) for j in jets(t)} == {0, 1} for t in pushed):  # y′ δy
        return "outside"
    if any(t.has(x) for t in pressed or pushed):
        return "follower" if pushed else "axis"
    return "end"


def chain(column: Column, values: Values | None = None) -> tuple[list[str], list[float], float] | None:
    """A chain of links on rotational springs, held at its first joint, under a force at its end: letters of the links'
    angles, their lengths as shares of the whole, and the share of the force that turns with the last link. None where
    the coordinates are something else."""
    given = {**column.defaults, **(values or {}), P: 1.0}
    angles = [trial(str(f)) for f in column.unknowns]
    here = [jet(angle, 0, 0, ALWAYS) for angle in angles]
    V, W_c, W = (column.energies.functional(name).points for name in ("V", "W_c", "dW_nc"))
    springs = [expand(V).coeff(j, 2) for j in here]  # of the joint itself, and of the next one
    stiffness = [sum((-1) ** (k - i) * springs[k] for k in range(i, len(here))) for i in range(len(here))]
    turns = [here[0], *(b - a for a, b in pairwise(here))]
    lengths = [2 * W_c.coeff(j, 2) for j in here]
    if expand(V - Add(*(k * t**2 for k, t in zip(stiffness, turns, strict=True)))) != 0:
        return None
    if expand(W_c - Add(*(length * j**2 / 2 for length, j in zip(lengths, here, strict=True)))) != 0:
        return None
    first = jet(varying(str(column.unknowns[0])), 0, 0, ALWAYS)
    share = -expand(W).coeff(first).coeff(here[-1]) / lengths[0] if lengths[0] != 0 else S.Zero
    forced = (
        share
        * here[-1]
        * Add(
            *(length * jet(varying(str(f)), 0, 0, ALWAYS) for length, f in zip(lengths, column.unknowns, strict=True))
        )
    )
    if expand(Add(*(t for t in Add.make_args(expand(W)) if t.has(P))) + forced) != 0:
        return None
    sizes = [float(length.subs(given)) for length in lengths]
    if min(sizes) <= 0:
        return None
    return [f"${f.letter}$" for f in column.unknowns], [size / sum(sizes) for size in sizes], float(share.subs(given))


def depths(column: Column, places: Sequence[float], values: Values | None = None) -> list[float]:
    """The depth of the beam at places, its largest 1: the cube root of the bending stiffness; 1 where y has none."""
    V, beam = column.energies.functional("V"), column.energies.beam
    given = {**column.defaults, **(values or {})}
    bounds = [float(place.subs(given)) for place in beam.places]
    found = []
    for place in places:
        segment = min(sum(bound <= place for bound in bounds[1:-1]), len(beam.segments) - 1)
        factor = 2 * V.density.coeff(jet(trial("y"), 2, 0, beam.segments[segment]), 2)
        found.append(float(factor.subs({**given, x: place})) ** (1 / 3) if factor != 0 else 1.0)
    return [depth / max(found) for depth in found]
