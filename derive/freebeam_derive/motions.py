"""Functionals evaluated on motions that are polynomials: exactly, and by no rule of the variation. Eqs. (7), (8).

A stage's result is proven here by what it says of a motion: both sides are numbers times parameters, and equal.
"""

from __future__ import annotations

from functools import cache

from sympy import QQ, Add, Dummy, Expr, Integer, Rational, S, Symbol, expand
from sympy.polys.rings import PolyElement, PolyRing

from freebeam_derive.notation import F_0, t, x
from freebeam_derive.statement import ALONG, GEOMETRIC, Functional, jets


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
    u = x / length
    cubics = {
        (0, 0): 1 - 3 * u**2 + 2 * u**3,
        (0, 1): length * (u - 2 * u**2 + u**3),
        (1, 0): 3 * u**2 - 2 * u**3,
        (1, 1): length * (u**3 - u**2),
    }
    free = [cubic for (end, order), cubic in cubics.items() if order not in GEOMETRIC[ends[end]]]
    return expand(vanishing(length, seed) + Add(*((k + 2) * cubic for k, cubic in enumerate(free))))


def _ring(symbols: frozenset[Symbol]) -> PolyRing:
    return PolyRing(tuple(sorted(symbols, key=str)), QQ)


@cache
def _name(number: int) -> Dummy:
    """What stands for a jet while an expression is evaluated."""
    return Dummy(f"jet_{number}")


def _along(expression: Expr, y: Expr, virtual: Expr, pushed: Expr | None) -> PolyElement:
    """An expression in jets and F_0, at a motion, a virtual displacement and a force (by default `force`)."""
    names = {j: _name(k) for k, j in enumerate((F_0, *jets(expression)))}
    plain = expression.xreplace(names)
    symbols = (e.free_symbols for e in (plain, y, virtual, *(j.args[3] for j in jets(expression))))
    ring = _ring(frozenset({*names.values(), x, t}.union(*symbols)))
    fields = tuple(ring.from_expr(field) for field in (y, virtual))
    generator = dict(zip(ring.symbols, ring.gens, strict=True))
    values = [(generator[names[F_0]], ring.from_expr(force() if pushed is None else pushed))]
    for j, name in names.items():
        if j == F_0:
            continue
        which, p, r, place = j.args
        found = fields[int(which)]
        for variable, order in ((x, int(p)), (t, int(r))):
            for _ in range(order):
                found = found.diff(generator[variable])
        if place != ALONG:
            found = found.compose(generator[x], ring.from_expr(place))
        values.append((generator[name], found))
    return ring.from_expr(plain).compose(values)


def integral(density: Expr, variable: Expr, length: Expr) -> Expr:
    """∫ of a polynomial from 0 to a length, a number."""
    return _integral(_ring(frozenset({*density.free_symbols, variable})).from_expr(density), variable, length)


def _integral(density: PolyElement, variable: Expr, length: Expr) -> Expr:
    place = density.ring.symbols.index(variable)
    total = density.ring.zero
    for powers, coefficient in density.terms():
        n = powers[place]
        reduced = tuple(0 if k == place else power for k, power in enumerate(powers))
        total += density.ring.from_dict({reduced: coefficient * QQ(length.p, length.q) ** (n + 1) / (n + 1)})
    return total.as_expr()


def value(work: Functional, y: Expr, virtual: Expr = S.Zero, length: Expr = S.One, pushed: Expr | None = None) -> Expr:
    """A functional at a motion and a virtual displacement, a function of t. length: a number."""
    density, points = (_along(part, y, virtual, pushed) for part in (work.density, work.points))
    return _integral(density, x, length) + points.as_expr()


def varied(work: Functional, y: Expr, virtual: Expr, length: Expr) -> Expr:
    """The first variation of a quadratic energy, as half the difference of its values on either side. Eq. (7)."""
    return expand((value(work, y + virtual, length=length) - value(work, y - virtual, length=length)) / 2)


def over_time(expression: Expr) -> Expr:
    """∫ from t = 0 to 1."""
    return integral(expand(expression), t, Integer(1))
