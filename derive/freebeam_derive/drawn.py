"""What there is to draw of a column: what its statement holds at places and along the beam, with letters in LaTeX."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

from sympy import Add, Expr

from freebeam_derive.jets import beside, jet, jets, trial, virtual
from freebeam_derive.latex import printer
from freebeam_derive.notation import NOTATION, P, alpha, beta, x
from freebeam_derive.statement import Column, Functional

__all__ = ["Parts", "depths", "parts_of"]

Named = list[tuple[float, str]]


@dataclass
class Parts:
    """Places are numbers, parameters at their defaults; a letter is that of the parameter that a part is stated with.

    followers: places of forces that turn with the slope; sensors: places of slopes, and where the forces act that they
    set. jumps: order of derivative that jumps, and place. load: where it is stated along the beam, "inside" (a flow
    through a pipe), "outside" (over a panel), "follower" or "axis" (along the beam, by its direction); else "end".
    weight: letter of an axial load of the column's own, and whether it is spread. medium: where a part of the beam is
    damped outside, with the letter. angles: letters of the coordinates.
    """

    symbol: str
    masses: Named = field(default_factory=list)
    inertias: Named = field(default_factory=list)
    springs: Named = field(default_factory=list)
    turning: Named = field(default_factory=list)
    dampers: Named = field(default_factory=list)
    absorbers: Named = field(default_factory=list)
    followers: list[float] = field(default_factory=list)
    sensors: list[tuple[float, float]] = field(default_factory=list)
    jumps: list[tuple[int, float]] = field(default_factory=list)
    angles: list[str] = field(default_factory=list)
    fixed_line: bool = False
    foundation: str = ""
    load: str = "end"
    weight: tuple[str, bool] = ("", False)
    medium: tuple[float, float, str] | None = None


def parts_of(column: Column) -> Parts:
    """What there is to draw of a column."""
    tex, own = printer(column), {p.symbol for p in column.parameters}
    parts = Parts(f"${NOTATION['P'].latex}$")
    T, V, W_c, W = (column.energies.functional(name) for name in ("T", "V", "W_c", "dW_nc"))

    def letters(term: Expr) -> str:
        at_places = {s for j in jets(term) for s in j.free_symbols}
        names = sorted((term.free_symbols & own) - at_places, key=str)
        return f"${' '.join(tex.doprint(s) for s in names)}$" if names else ""

    parts.jumps = sorted((order, _number(column, place)) for name, order, place in V.opened if name == "y")
    parts.angles = [f"${f.letter}$" for f in column.unknowns if str(f) in column.coordinates]
    coupled = [
        (place, letters(term))
        for _, places, term in _at_places(column, V)
        for place in places
        if None in places and place is not None
    ]
    parts.absorbers = list(dict.fromkeys(coupled))
    _squares(column, T, (parts.masses, parts.inertias), parts, letters)
    _squares(column, V, (parts.springs, parts.turning), parts, letters)
    _forces(column, W, parts, letters)
    _along(column, V, W, parts, letters)
    parts.load = _load(W_c.density, W.density)
    return parts


def _number(column: Column, place: Expr) -> float:
    return float(place.subs(column.defaults))


def _at_places(column: Column, work: Functional) -> list[tuple[list[Expr], list[float | None], Expr]]:
    """The point values that a work or an energy sums, each as its jets, their places and the whole term; a coordinate
    has no place."""
    found = []
    for term in Add.make_args(work.points):
        if term == 0:
            continue
        here = [j for j in jets(term) for _ in range(int(term.as_powers_dict().get(j, 1)))]
        stated = [j.args[3].args[0] if j.args[3].func == beside else j.args[3] for j in here]
        values = [place.subs(column.defaults) for place in stated]
        found.append((here, [float(v) if v.is_number else None for v in values], term))
    return found


def _squares(
    column: Column, energy: Functional, by_order: tuple[Named, Named], parts: Parts, letters: Callable[[Expr], str]
) -> None:
    """Energies of the square of y or of its slope at a place: masses and springs that are no joint's or absorber's."""
    taken = {(0, place) for place, _ in parts.absorbers} | set(parts.jumps)
    for here, (place, *_), term in _at_places(column, energy):
        if len(here) == 2 and here[0] == here[1] and place is not None and (int(here[0].args[1]), place) not in taken:
            by_order[int(here[0].args[1])].append((place, letters(term)))


def _forces(column: Column, work: Functional, parts: Parts, letters: Callable[[Expr], str]) -> None:
    """Virtual work at places: forces that turn with the slope there or elsewhere, or stay on a line, and dampers."""
    at_absorbers = {place for place, _ in parts.absorbers}
    for here, places, term in _at_places(column, work):
        pairs = [(j, place) for j, place in zip(here, places, strict=True) if place is not None]
        if len(pairs) != 2:
            continue
        (sight, seen), (change, moved) = sorted(pairs, key=lambda pair: virtual(pair[0].args[0]))
        order, rate, turned = int(sight.args[1]), int(sight.args[2]), int(change.args[1])
        if term.has(P) and turned == 1 and order == 0:
            parts.fixed_line = True
        elif term.has(P) and seen != moved:
            parts.sensors.append((seen, moved))
        elif term.has(P) and moved not in parts.followers:
            parts.followers.append(moved)
        elif rate == 1 and order == turned == 0 and moved not in at_absorbers and not term.has(alpha, beta):
            parts.dampers.append((moved, letters(term)))


def _along(column: Column, V: Functional, W: Functional, parts: Parts, letters: Callable[[Expr], str]) -> None:
    """A foundation, an axial load of the column's own, and a medium around a part of the beam."""
    beam = column.energies.beam
    for k, along in enumerate(beam.segments):
        spring, axial = (V.density.coeff(jet(0, order, 0, along), 2) for order in (0, 1))
        damping = W.density.coeff(jet(0, 0, 1, along)).coeff(jet(1, 0, 0, along)).subs({alpha: 0, beta: 0})
        if spring != 0:
            parts.foundation = letters(spring)
        if axial != 0 and column.fields == ("y",):
            parts.weight = letters(axial), axial.has(x)
        if damping != 0 and beam.cuts:
            low, high = (_number(column, place) for place in beam.places[k : k + 2])
            parts.medium = low, high, letters(damping)


def _load(axial: Expr, work: Expr) -> str:
    """How the load acts along the beam, from the densities of W_c and δW_nc."""
    pressed, pushed = ([t for t in Add.make_args(part) if t.has(P)] for part in (axial, work))
    if any(int(j.args[2]) for t in pushed for j in jets(t)):
        return "inside"
    if pushed and not pressed:
        return "outside"
    if any(t.has(x) for t in pressed):
        return "follower" if pushed else "axis"
    return "end"


def depths(column: Column, places: Sequence[float]) -> list[float]:
    """The depth of the beam at places, its largest 1: the cube root of the bending stiffness; 1 where y has none."""
    V, beam = column.energies.functional("V"), column.energies.beam
    bounds = [_number(column, place) for place in beam.places]
    found = []
    for place in places:
        segment = min(sum(bound <= place for bound in bounds[1:-1]), len(beam.segments) - 1)
        factor = 2 * V.density.coeff(jet(trial("y"), 2, 0, beam.segments[segment]), 2)
        found.append(float(factor.subs({**column.defaults, x: place})) ** (1 / 3) if factor != 0 else 1.0)
    return [depth / max(found) for depth in found]
