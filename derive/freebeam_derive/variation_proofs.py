"""What proves the steps of scaling and variation of any column, on motions that are polynomials. Eqs. (5)-(8), (15).

Both sides of a step are evaluated on a motion of all unknowns, one polynomial a segment (motions.py). They are equal
for all parameters where arithmetic is exact; with functions of x that are no polynomials, to 40 digits at the defaults.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

from sympy import Add, Expr, Integer, S, expand, nsimplify, powdenest, sympify

from freebeam_derive import motions, variation
from freebeam_derive.derivation import Derivation, GeneralDerivation
from freebeam_derive.jets import ALWAYS, Beam, beside, varying
from freebeam_derive.motions import Motion
from freebeam_derive.notation import EI, C_alpha, C_beta, L, P, alpha, beta, m, t, x, x_F
from freebeam_derive.record import Step
from freebeam_derive.statement import Column, Functional, jet

Either = Derivation | GeneralDerivation


def own_values(column: Column) -> dict[Expr, Expr]:
    """The column's own parameters at their defaults, exactly."""
    return {p.symbol: nsimplify(p.default, rational=True) for p in column.parameters}


def moving(d: Either, seed: int = 1) -> Motion:
    """A motion of a column's unknowns, free at the ends."""
    return motions.moving(d.motion.beam, d.motion.spaces, d.column.coordinates, seed)


def displaced(d: Either, seed: int = 3, held: bool = True) -> Motion:
    """A virtual displacement that moves wherever it may; held: as the ends hold it."""
    spaces = d.motion.spaces if held else tuple(replace(s, held=frozenset()) for s in d.motion.spaces)
    return motions.displaced(d.motion.beam, spaces, d.column.coordinates, seed)


def left(d: Either, work: Functional, of: Motion, virtual: Motion) -> Any:
    """A functional that must vanish, on a motion."""
    return motions.settled(motions.on(work, d.motion.beam, of, virtual), own_values(d.column))


def _scaling(d: Either, step: Step) -> Any:
    """a motion and the same motion scaled, of a beam with numbers for m, EI and L: their works differ by the factor EI
    / L, exactly."""
    name = step.what.split()[1]
    given = d.column.dimensional
    assert given is not None
    length = Integer(2)
    numbers = {m: 9, EI: 4, L: length}  # the unit of time, (m L^4 / EI)^(1/2), is then no root
    unit = {key: size.subs(numbers) for key, size in d.column.scales.items()}
    own = {key: sympify(value).subs(numbers) for key, value in d.column.scaling.items()}
    quantities = {key: value for key, value in own.items() if key.is_Symbol and key != P}
    sizes = {str(key.func): value / key for key, value in own.items() if not key.is_Symbol} | {"y": length}
    scaled = {x: x / length, t: t / unit["time"]}

    def longer(of: Motion) -> Motion:
        found: dict[str, Any] = {}
        for unknown, shape in of.items():
            pieces = shape if isinstance(shape, tuple) else (shape,)
            long = tuple(expand(sizes.get(unknown, S.One) * p.subs(scaled, simultaneous=True)) for p in pieces)
            found[unknown] = long if isinstance(shape, tuple) else long[0]
        return found

    def as_numbers(part: Expr) -> Expr:
        return part.subs(quantities).subs(numbers)

    of, virtual = moving(d), motions.scaled(displaced(d, held=False), 1 + t)
    beam = Beam(length, tuple(as_numbers(cut) for cut in given.cuts))
    work = given.functional(name).map(as_numbers)
    found = motions.on(work, beam, longer(of), longer(virtual), unit["force"] * motions.force().subs(scaled))
    loads = {P: unit["load"] * P, C_alpha: unit["alpha"] * alpha, C_beta: unit["beta"] * beta, x_F: length * x_F}
    wanted = motions.on(d.column.energies.functional(name), d.motion.beam, of, virtual).subs(scaled)
    left = powdenest(expand(found.subs(loads, simultaneous=True)), force=True)  # roots of parameters
    return motions.settled(left - unit["energy"] * wanted, own_values(d.column))


def _works(d: Either) -> tuple[Functional, ...]:
    return tuple(d.column.energies.functional(name) for name in ("T", "V", "W_c", "dW_nc"))


def _action(d: Either) -> Functional:
    T, V, W_c, dW_nc = _works(d)
    return variation.first_variation(T + V.scaled(-1) + W_c) + dW_nc


def _first_variation(d: Either, step: Step) -> Any:
    """half the difference of the energies at y + δy and y − δy, on polynomials, exactly."""
    T, V, W_c, dW_nc = _works(d)
    of, virtual = moving(d), moving(d, 4)
    beam = d.motion.beam
    exact = motions.varied(T + V.scaled(-1) + W_c, beam, of, virtual) + motions.on(dW_nc, beam, of, virtual)
    return motions.settled(motions.on(_action(d), beam, of, virtual) - exact, own_values(d.column))


def _over_time(d: Either, work: Functional) -> Any:
    """∫ of a functional from the instant 0 to 1, at which the virtual displacement vanishes."""
    virtual = motions.scaled(displaced(d), t * (1 - t))
    return motions.settled(motions.over_time(motions.on(work, d.motion.beam, moving(d), virtual)), own_values(d.column))


def _by_parts_in_time(d: Either, step: Step) -> Any:
    """both sides integrated over time, on polynomials with δy = 0 at both instants, exactly."""
    kinetic = variation.first_variation(_works(d)[0])
    return _over_time(d, kinetic + variation.off_the_rates(kinetic).scaled(-1))


def _weak_form(d: Either, step: Step) -> Any:
    """its time integral is that of the line before, negated, on polynomials with δy = 0 at both instants, exactly."""
    return _over_time(d, _action(d) + d.motion.weak)


def _by_parts_along(d: Either, step: Step) -> Any:
    """both sides on polynomials, exactly."""
    factors, bracket = variation.parts(d.motion.weak.density)
    bare = Add(*(factor * virtual for virtual, factor in factors.items()))
    ends = variation.ends_of(bracket, d.motion.beam)
    apart = Functional(d.motion.weak.density - bare, -ends)
    return left(d, apart, moving(d), displaced(d, 4, held=False))


def _strong(d: Either, virtual: Motion) -> Any:
    """Weak form less equations of motion and natural conditions, each times the virtual displacement."""
    motion, beam = d.motion, d.motion.beam
    density, points = motion.weak.density, motion.weak.points
    for (name, segment), factor in motion.equations.items():
        density -= factor * _virtual(name, 0, beam.along(segment))
    for condition in motion.conditions:
        place = beam.places[condition.place]
        where = beside(place, Integer(condition.side)) if condition.side else place
        points -= condition.factor * _virtual(condition.field, condition.order, where)
    for name, work in motion.of_coordinates.items():
        density -= expand(work.density * _virtual(name, 0, ALWAYS))
        points -= expand(work.points * _virtual(name, 0, ALWAYS))
    points += Add(*(force * _virtual("y", 0, place) for place, force in motion.forces))
    return left(d, Functional(expand(density), expand(points)), moving(d), virtual)


def _virtual(name: str, order: int, place: Expr) -> Expr:
    """A derivative of an unknown's variation, at a place."""
    return jet(varying(name), Integer(order), Integer(0), place)


def _equation_of_motion(d: Either, step: Step) -> Any:
    """times δy and integrated it is the weak form, on polynomials with δy = δy′ = 0 at the ends, exactly."""
    if not d.motion.spaces:  # coordinates alone, whose equations are all there is
        return _strong(d, displaced(d))
    inside = motions.inside(d.motion.beam, d.motion.spaces, d.column.coordinates)
    moved = {name: Integer(k + 2) for k, name in enumerate(d.column.coordinates)}
    return _strong(d, {**inside, **moved})


def _natural_conditions(d: Either, step: Step) -> Any:
    """with them, weak and strong form agree on polynomials that move the ends wherever they may move, exactly."""
    return _strong(d, displaced(d))


PROOFS: dict[tuple[str, str], Callable[[Any, Step], Any]] = {
    **{("scaling", f"Write {name} in nondimensional quantities"): _scaling for name in ("T", "V", "W_c", "dW_nc")},
    ("variation", "Take the first variation of the energies and add the virtual work"): _first_variation,
    ("variation", "Integrate the kinetic term by parts in time"): _by_parts_in_time,
    ("variation", "Read off the weak form"): _weak_form,
    ("variation", "Integrate by parts along the beam until δy stands bare"): _by_parts_along,
    ("variation", "State the equation of motion"): _equation_of_motion,
    ("variation", "State the natural end conditions"): _natural_conditions,
}
