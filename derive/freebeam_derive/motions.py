"""Functionals evaluated on motions that are polynomials: exactly, and by no rule of the variation. Eqs. (7), (8).

A stage's result is proven here by what it says of a motion: both sides are numbers times parameters, and equal. What
multiplies a motion may be any function of x: then integrals of that function times a power of x are left as they are,
and `settled` computes them.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from functools import cache
from typing import Any

import mpmath
from sympy import QQ, Add, Dummy, Expr, Integer, Integral, Poly, Rational, S, cancel, expand, lambdify
from sympy.polys.rings import PolyElement, PolyRing

from freebeam_derive.forms import Space
from freebeam_derive.independent import gauss
from freebeam_derive.jets import ALWAYS, Beam, beside, jet, name_of, segment_of, virtual
from freebeam_derive.notation import F_0, t, x
from freebeam_derive.statement import GEOMETRIC, Functional, jets

DIGITS = 40

Motion = Mapping[str, Any]
"""{field: polynomials in x and t, one a segment; coordinate: function of t}."""


def polynomial(seed: int, degree: int, variable: Expr = x) -> Expr:
    """A polynomial of a degree, of few terms, with rational coefficients that no accident cancels."""
    powers = sorted({degree, degree - 1, degree // 2, 0}, reverse=True)
    return Add(*(Rational((seed * 5 + 7 * k) % 11 + 1, k + 2) * (-1) ** k * variable**n for k, n in enumerate(powers)))


def motion(seed: int = 1, degree: int = 6) -> Expr:
    """A motion y(x, t)."""
    return Add(*(polynomial(seed + k, degree - k) * t**k for k in range(3)))


def force(seed: int = 5) -> Expr:
    """A force F_0(t)."""
    return polynomial(seed, 2, t)


def vanishing(length: Expr, seed: int = 2) -> Expr:
    """A virtual displacement that, with its slope, vanishes at both ends."""
    return expand(x**2 * (length - x) ** 2 * (seed - x))


def admissible(ends: tuple[str, str], length: Expr, seed: int = 3) -> Expr:
    """A virtual displacement that meets the geometric conditions and moves where it may."""
    held = frozenset((end, order) for end, kind in enumerate(ends) for order in GEOMETRIC[kind])
    return _held(Space("y", "y", 2, held), length, seed)


def _held(space: Space, length: Expr, seed: int) -> Expr:
    """A polynomial that vanishes where a field is held, and moves at both ends where it is free."""
    u = x / length
    corners = {
        0: {},
        1: {(0, 0): 1 - u, (1, 0): u},
        2: {
            (0, 0): 1 - 3 * u**2 + 2 * u**3,
            (0, 1): length * (u - 2 * u**2 + u**3),
            (1, 0): 3 * u**2 - 2 * u**3,
            (1, 1): length * (u**3 - u**2),
        },
    }[space.joined]
    free = [corner for where, corner in corners.items() if where not in space.held]
    inside = (x * (length - x)) ** space.joined * (seed - x)
    # values and slopes at the ends differ from seed to seed, so that no two functions have them in common
    weights = ((seed * (k + 2) + k) % 11 + 1 for k in range(len(free)))
    return expand(inside + Add(*(weight * corner for weight, corner in zip(weights, free, strict=True))))


def moving(beam: Beam, spaces: Iterable[Space], coordinates: Iterable[str], seed: int = 1) -> Motion:
    """A motion of all unknowns that is joined at the breaks as the spaces say, and no more; free at the ends."""
    found: dict[str, Any] = {
        space.name: _broken(motion(seed + 2 * k, 5), 1 + t, beam, space, seed) for k, space in enumerate(spaces)
    }
    return found | {name: polynomial(seed + k, 2, t) for k, name in enumerate(coordinates, 3)}


def displaced(beam: Beam, spaces: Iterable[Space], coordinates: Iterable[str], seed: int = 3) -> Motion:
    """A virtual displacement that moves wherever it may: as `moving`, held as the spaces say, without time."""
    found: dict[str, Any] = {
        space.name: _broken(_held(space, beam.length, seed + k), S.One, beam, space, seed)
        for k, space in enumerate(spaces)
    }
    return found | {name: Rational(seed + k, 2) for k, name in enumerate(coordinates)}


def inside(beam: Beam, spaces: Iterable[Space], coordinates: Iterable[str]) -> Motion:
    """A virtual displacement that, with its slope, vanishes at ends and breaks, and moves no coordinate."""
    found: dict[str, Any] = {}
    for k, space in enumerate(spaces):
        edges = zip(beam.places, beam.places[1:], strict=False)
        found[space.name] = tuple(expand((x - a) ** 2 * (b - x) ** 2 * (k + 2 - x)) for a, b in edges)
    return found | dict.fromkeys(coordinates, S.Zero)


def _broken(whole: Expr, factor: Expr, beam: Beam, space: Space, seed: int) -> tuple[Expr, ...]:
    """A polynomial with something more right of each break, which begins there in the orders that need not be
    continuous, and does nothing at the right end."""
    pieces, length = [whole], beam.length
    for number, place in enumerate(beam.cuts, 1):
        away = x - place
        jumps = [order for order in range(space.joined) if (number, order) in space.opened]
        more = Add(*(Rational(seed + k, 3) * away**order for k, order in enumerate((space.joined, space.joined + 1))))
        if 0 in jumps:  # the slope of it is zero at the break
            more += (length - place) + 2 * away
        if 1 in jumps:
            more -= 2 * away
        pieces.append(expand(pieces[-1] + number * factor * (length - x) ** 2 * more))
    return tuple(pieces)


def scaled(of: Motion, factor: Expr) -> Motion:
    """A motion times a function of time."""
    return {n: tuple(factor * p for p in u) if isinstance(u, tuple) else factor * u for n, u in of.items()}


def added(one: Motion, other: Motion, factor: Expr | int = 1) -> Motion:
    """The sum of two motions, the second times a number."""
    return {
        name: tuple(a + factor * b for a, b in zip(u, other[name], strict=True))
        if isinstance(u, tuple)
        else u + factor * other[name]
        for name, u in one.items()
    }


# --- evaluation ---------------------------------------------------------------------------------------------------


def _ring(generators: Iterable[Expr]) -> PolyRing:
    return PolyRing(tuple(sorted(set(generators), key=str)), QQ)


def _generators(expression: Expr) -> set[Expr]:
    """What an expression is a polynomial in: symbols, and what else is no rational number, sum, product or power."""
    if expression.is_Rational:
        return set()
    if expression.is_Add or expression.is_Mul:
        return set().union(*map(_generators, expression.args))
    if expression.is_Pow and expression.exp.is_Integer and expression.exp > 0:
        return _generators(expression.base)
    return {expression}


def polynomial_in_x(expression: Expr) -> bool:
    """Whether it is a polynomial in x, so that all integrals of motions are exact."""
    return not any(g.has(x) and g != x and g.func != jet for g in _generators(expression))


@cache
def _name(number: int) -> Dummy:
    """What stands for a jet while an expression is evaluated."""
    return Dummy(f"jet_{number}")


def _taken(j: Expr, beam: Beam, of: Motion) -> tuple[Expr, Expr | None]:
    """The polynomial that a jet is a derivative of, and the place at which it is taken, None along a segment."""
    which, _, _, place = j.args
    unknown = of.get(name_of(which), S.Zero)
    if place == ALWAYS or not isinstance(unknown, tuple):
        return unknown, None
    segment = segment_of(place)
    if segment is not None:
        return unknown[segment], None
    where, side = (place.args[0], int(place.args[1])) if place.func == beside else (place, 0)
    number = beam.index(where)
    if number is None:  # a sensor or a force inside a segment
        return unknown[_segment_at(beam, where)], where
    return unknown[max(number - 1, 0) if side < 0 or number == len(unknown) else number], where


def _segment_at(beam: Beam, where: Expr) -> int:
    """The segment of a place between breaks: that of its number, or of the middle of the beam where it is none."""
    if not beam.cuts:
        return 0
    return sum(bool(where.is_number and cut.is_number and cut < where) for cut in beam.cuts)


def _evaluated(expression: Expr, beam: Beam, of: Motion, varied_by: Motion, pushed: Expr | None) -> PolyElement:
    """An expression in jets and F_0, at a motion, a virtual displacement and a force (by default `force`)."""
    names = {j: _name(k) for k, j in enumerate((F_0, *jets(expression)))}
    plain = expression.xreplace(names)
    taken = {j: _taken(j, beam, varied_by if virtual(j.args[0]) else of) for j in names if j != F_0}
    shapes = [shape for shape, _ in taken.values()] + [where for _, where in taken.values() if where is not None]
    push = force() if pushed is None else pushed
    ring = _ring({*names.values(), x, t}.union(*map(_generators, (plain, push, *shapes))))
    generator = dict(zip(ring.symbols, ring.gens, strict=True))
    values = [(generator[names[F_0]], ring.from_expr(push))]
    for j, (shape, where) in taken.items():
        found = ring.from_expr(shape)
        for variable, order in ((x, int(j.args[1])), (t, int(j.args[2]))):
            for _ in range(order):
                found = found.diff(generator[variable])
        if where is not None:
            found = found.compose(generator[x], ring.from_expr(where))
        values.append((generator[names[j]], found))
    return ring.from_expr(plain).compose(values)


def integral(density: Expr, variable: Expr, length: Expr) -> Expr:
    """∫ of a polynomial from 0 to a length, a number."""
    return _integral(_ring({*_generators(density), variable}).from_expr(density), variable, S.Zero, length)


def _integral(density: PolyElement, variable: Expr, low: Expr, high: Expr) -> Expr:
    """∫ of an element in one of its generators; of what else depends on that, the integral as it is."""
    ring = density.ring
    place = ring.symbols.index(variable)
    others = [k for k, g in enumerate(ring.symbols) if k != place and g.has(variable) and not g.is_Symbol]
    powers: dict[tuple[int, tuple[int, ...]], Any] = {}
    for exponents, coefficient in density.terms():
        key = (exponents[place], tuple(exponents[k] for k in others))
        rest = tuple(0 if k == place or k in others else power for k, power in enumerate(exponents))
        powers.setdefault(key, {})[rest] = coefficient
    total = S.Zero
    for (n, function), terms in powers.items():
        factor = ring.from_dict(terms).as_expr()
        if any(function):
            weight = variable**n
            for k, power in zip(others, function, strict=True):
                weight *= ring.symbols[k] ** power
            total += factor * Integral(weight, (variable, low, high))
        else:
            total += factor * (high ** (n + 1) - low ** (n + 1)) / (n + 1)
    return total


def on(work: Functional, beam: Beam, of: Motion, varied_by: Motion | None = None, pushed: Expr | None = None) -> Expr:
    """A functional at a motion and a virtual displacement of all unknowns, a function of t."""
    still = varied_by or {}
    total = _evaluated(work.points, beam, of, still, pushed).as_expr()
    for segment, place in enumerate(beam.segments):
        here = Add(*(u for u in Add.make_args(work.density) if any(j.args[3] == place for j in jets(u))))
        density = _evaluated(here, beam, of, still, pushed)
        total += _integral(density, x, *beam.places[segment : segment + 2])
    return expand(total)


def value(work: Functional, y: Expr, virtual: Expr = S.Zero, length: Expr = S.One, pushed: Expr | None = None) -> Expr:
    """A functional of a deflection along one segment. length: a number."""
    return on(work, Beam(length), {"y": (y,)}, {"y": (virtual,)}, pushed)


def varied(work: Functional, beam: Beam, of: Motion, varied_by: Motion) -> Expr:
    """The first variation of a quadratic energy, as half the difference of its values on either side. Eq. (7)."""
    above, below = (on(work, beam, added(of, varied_by, side)) for side in (1, -1))
    return expand((above - below) / 2)


def over_time(expression: Expr) -> Expr:
    """∫ from t = 0 to 1."""
    return integral(expand(expression), t, Integer(1))


def settled(expression: Expr, own: Mapping[Expr, Expr]) -> Any:
    """What is left of a difference: itself, where it holds no integral; else its coefficients in what is free, computed
    with DIGITS digits at `own` values of the column's parameters."""
    left = expand(expression)
    if not left.has(Integral):
        return left if left == 0 else cancel(left)
    left = expand(left.xreplace(dict(own)))
    free = sorted(left.free_symbols, key=str)
    coefficients = Poly(left, *free).coeffs() if free else [left]
    with mpmath.workdps(DIGITS + 15):
        return tuple(_number(coefficient) for coefficient in coefficients)


def _number(expression: Expr) -> Any:
    """A number that holds integrals along segments, by Gauss's rule: 48 nodes leave 10^-60 of what is smooth."""
    names = {i: _name(k) for k, i in enumerate(sorted(expression.atoms(Integral), key=str))}
    return lambdify([*names.values()], expression.xreplace(names), "mpmath")(*map(_quadrature, names))


@cache
def _quadrature(of: Expr) -> Any:
    ((variable, low, high),) = of.limits
    with mpmath.workdps(DIGITS + 15):
        f = lambdify(variable, of.function, "mpmath")
        a, b = (lambdify((), end, "mpmath")() + mpmath.mpf(0) for end in (low, high))
        rule = gauss(48, mpmath.mp.prec)
        return (b - a) * mpmath.fsum(weight * f(a + (b - a) * node) for node, weight in rule)
