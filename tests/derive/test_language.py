"""The language beyond one field and one segment: what is read, varied and integrated by parts is what was stated.

Statements are evaluated as they stand, by SymPy, on motions that are polynomials on each segment; the derivation's weak
form, equations of motion and natural conditions must give the same numbers. Eqs. (6)-(8), (15).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cache
from itertools import pairwise
from typing import Any

import pytest
from sympy import (
    QQ,
    Add,
    Expr,
    Heaviside,
    Integral,
    Lambda,
    Mul,
    Piecewise,
    Rational,
    S,
    Subs,
    Symbol,
    integrate,
    nsimplify,
    sqrt,
)
from sympy.polys.rings import PolyRing

from freebeam_derive import assembly, variation
from freebeam_derive.jets import ALWAYS, beside, jets, leap, name_of, segment_of, virtual
from freebeam_derive.notation import F_0, P, alpha, beta, t, x, x_F, y
from freebeam_derive.statement import (
    Column,
    Coordinate,
    Field,
    Parameter,
    at,
    delta,
    hinge,
    integral,
    jump,
)
from freebeam_derive.variation import EquationOfMotion

a, b, c, k, mu, r, s = (Symbol(name, real=True) for name in ("a", "b", "c", "k", "mu", "r", "s"))
NUMBERS = {a: Rational(3, 10), b: Rational(1, 10), c: 2, k: 3, mu: Rational(1, 2), r: Rational(1, 5), s: 7}
PARAMETERS = tuple(Parameter(symbol, str(symbol), float(value), 0.0, 10.0) for symbol, value in NUMBERS.items())
NUMBERS[x_F] = Rational(1, 4)
RING = PolyRing((x, t, P, alpha, beta), QQ)
HALF = Rational(1, 2)
BEAM_DAMPING = -integral(beta * y.diff(t) * delta(y) + alpha * y.diff(x, 2, t) * delta(y.diff(x, 2)))
FOLLOWER = -P * at(y.diff(x), 1) * at(delta(y), 1)
BECK = {
    "name": "sample",
    "title": "A sample",
    "T": integral(y.diff(t) ** 2) / 2,
    "V": integral(y.diff(x, 2) ** 2) / 2,
    "W_c": P * integral(y.diff(x) ** 2) / 2,
    "dW_nc": FOLLOWER + BEAM_DAMPING + F_0 * at(delta(y), x_F),
    "ends": ("clamped", "free"),
    "parameters": PARAMETERS,
}


def beck(**changes: Any) -> Column:
    return Column(**(BECK | changes))


def timoshenko() -> Column:
    psi = Field("psi", r"\psi")
    return beck(
        T=integral(y.diff(t) ** 2 + r * psi.diff(t) ** 2) / 2,
        V=integral(psi.diff(x) ** 2 + s * (y.diff(x) - psi) ** 2) / 2,
        dW_nc=-P * at(psi, 1) * at(delta(y), 1) - integral(beta * psi.diff(t) * delta(psi)),
    )


def absorber() -> Column:
    q = Coordinate("q", "q_a")
    gap = q - at(y, Rational(7, 10))
    return beck(
        T=BECK["T"] + mu * q.diff(t) ** 2 / 2,
        V=BECK["V"] + k * gap**2 / 2,
        dW_nc=BECK["dW_nc"] - c * gap.diff(t) * delta(gap),
    )


def ziegler() -> Column:
    p, q = Coordinate("p"), Coordinate("q")
    return Column(
        "ziegler",
        "Two links",
        T=(2 * p.diff(t) ** 2 + (p.diff(t) + q.diff(t)) ** 2) / 2,
        V=(p**2 + (q - p) ** 2) / 2,
        W_c=P * (p**2 + q**2) / 2,
        dW_nc=-P * q * (delta(p) + delta(q)) - alpha * (p.diff(t) * delta(p) + (q - p).diff(t) * delta(q - p)),
    )


def turning() -> Column:
    """A beam on a hub that turns: a coordinate under the integral."""
    theta = Coordinate("theta")
    return beck(
        T=integral((y.diff(t) + (x + a) * theta.diff(t)) ** 2) / 2 + theta.diff(t) ** 2,
        V=BECK["V"] + k * theta**2,
    )


def rotating() -> Column:
    """Two planes that turn about the axis: T holds the deflections themselves."""
    z = Field("z")
    return beck(
        T=integral((y.diff(t) - s * z) ** 2 + (z.diff(t) + s * y) ** 2) / 2,
        V=integral(y.diff(x, 2) ** 2 + z.diff(x, 2) ** 2) / 2,
    )


CASES: dict[str, Callable[[], Column]] = {
    "Beck": beck,
    "mass inside": lambda: beck(T=BECK["T"] + mu * at(y.diff(t), HALF) ** 2 / 2),
    "mass at a parameter": lambda: beck(T=BECK["T"] + mu * at(y.diff(t), a) ** 2 / 2 + at(y.diff(x, t), a) ** 2),
    "crack": lambda: beck(V=BECK["V"] + k * jump(y.diff(x), 0.4) ** 2 / 2),
    "damped crack": lambda: beck(
        V=BECK["V"] + k * jump(y.diff(x), 0.4) ** 2 / 2,
        dW_nc=BECK["dW_nc"] - c * jump(y.diff(x, t), 0.4) * delta(jump(y.diff(x), 0.4)),
    ),
    "damped crack by its sides": lambda: beck(
        V=BECK["V"] + k * (at(y.diff(x), 0.4, 1) - at(y.diff(x), 0.4, -1)) ** 2 / 2,
        dW_nc=BECK["dW_nc"]
        - c
        * (at(y.diff(x, t), 0.4, 1) - at(y.diff(x, t), 0.4, -1))
        * (at(delta(y.diff(x)), 0.4, 1) - at(delta(y.diff(x)), 0.4, -1)),
    ),
    "shear joint": lambda: beck(V=BECK["V"] + s * jump(y, a) ** 2 / 2),
    "hinge": lambda: beck(releases=(hinge(HALF),), ends=("clamped", "pinned"), dW_nc=BEAM_DAMPING),
    "two hinges of one field each way": lambda: beck(V=BECK["V"] + k * (jump(y, a) + jump(y.diff(x), HALF)) ** 2),
    "part of the beam": lambda: beck(V=BECK["V"] + k * integral(y**2, a, 0.75) / 2),
    "load at a place": lambda: beck(
        W_c=P * integral(y.diff(x) ** 2, 0, HALF) / 2, dW_nc=-P * at(y.diff(x), HALF) * at(delta(y), HALF)
    ),
    "slope on one side": lambda: beck(
        V=BECK["V"] + k * jump(y.diff(x), HALF) ** 2, dW_nc=-P * at(y.diff(x), HALF, -1) * at(delta(y), 1)
    ),
    "steps": lambda: beck(
        T=integral(Piecewise((1, x < a), (2, x <= HALF), (3, True)) * y.diff(t) ** 2) / 2,
        V=integral(Piecewise((1 + x, HALF >= x), (HALF, True)) * y.diff(x, 2) ** 2) / 2,
        dW_nc=FOLLOWER,
    ),
    "step of Heaviside": lambda: beck(V=integral((2 - Heaviside(x - HALF)) * y.diff(x, 2) ** 2) / 2, dW_nc=FOLLOWER),
    "taper": lambda: beck(V=integral((1 - x / 2) ** 4 * y.diff(x, 2) ** 2) / 2, dW_nc=FOLLOWER),
    "pipe": lambda: beck(
        W_c=0, dW_nc=-(P**2) * integral(y.diff(x, 2) * delta(y)) - 2 * sqrt(b) * P * integral(y.diff(x, t) * delta(y))
    ),
    "pipe by its energies": lambda: beck(
        T=integral(y.diff(t) ** 2 + 2 * b * P * y.diff(t) * y.diff(x)) / 2,
        dW_nc=FOLLOWER,
    ),
    "sensor": lambda: beck(dW_nc=-P * (at(y.diff(x), 1) + k * at(y.diff(x), a)) * at(delta(y), 1)),
    "curvature at a place": lambda: beck(dW_nc=FOLLOWER - k * at(y.diff(x, 2), a) * at(delta(y), 1)),
    "Timoshenko": timoshenko,
    "absorber": absorber,
    "Ziegler": ziegler,
    "hub": turning,
    "rotating frame": rotating,
}


def polynomials(column: Column, motion: EquationOfMotion, seed: int, test: bool) -> dict[str, Any]:
    """Motions of all unknowns, fields as one polynomial a segment, joined and held as the derivation says; a virtual
    one has no time in it."""
    found: dict[str, Any] = {}
    for space in motion.spaces:
        pieces: list[Expr] = []
        for number in range(len(motion.beam.segments)):
            left, right = (place.subs(NUMBERS) for place in motion.beam.places[number : number + 2])
            free = [Rational((seed * 7 + 3 * n + number) % 11 - 4, n + 2) for n in range(4)]
            piece = Add(*(f * (x - left) ** n for n, f in zip((0, 1, 2, 4), free, strict=True)))
            orders = range(space.joined)
            for order in orders:  # begins as the segment before ends, or as it is held
                if number and (number, order) not in space.opened:
                    wanted = pieces[-1].diff(x, order).subs(x, left) if order else pieces[-1].subs(x, left)
                elif not number and (0, order) in space.held:
                    wanted = S.Zero
                else:
                    continue
                now = piece.diff(x, order).subs(x, left) if order else piece.subs(x, left)
                piece += (wanted - now) * (x - left) ** order / (1 if order < 2 else 2)
            if number == len(motion.beam.segments) - 1:
                length = right - left
                for order in sorted(o for e, o in space.held if e == 1):
                    now = piece.diff(x, order).subs(x, right) if order else piece.subs(x, right)
                    # bumps that change one of value and slope at the right end and nothing at the left
                    bump = (x - left) ** 2 * ((3 * length - 2 * (x - left)) / length**3 if order == 0 else 0)
                    turn = (x - left) ** 2 * (x - right) / length**2
                    piece -= now * (turn if order else bump)
            pieces.append(expand(piece))
        found[space.name] = pieces if test else [expand(p * (1 + t + seed * t**2 / 3)) for p in pieces]
    for name in column.coordinates:
        found[name] = Rational(seed + 2, 3) * (1 if test else 1 - t + 2 * t**2)
    return found


def at_motion(expression: Expr, motion: EquationOfMotion, moving: Mapping[str, Any], moved: Mapping[str, Any]) -> Expr:
    """An expression in jets on motions and virtual motions."""
    values = {}
    for j in jets(expression):
        which, order, rate, place = j.args
        of = (moved if virtual(which) else moving)[name_of(which)]
        segment = segment_of(place)
        if place == ALWAYS:
            values[j] = of.diff(t, int(rate)) if int(rate) else of
            continue
        where = place
        if segment is None:
            where, side = (place.args[0], int(place.args[1])) if place.func == beside else (place, 0)
            number = motion.beam.index(where)
            places = [p.subs(NUMBERS) for p in motion.beam.places]
            if number is None:
                segment = max(n for n, p in enumerate(places[:-1]) if p <= where.subs(NUMBERS))
            else:
                segment = max(0, number - 1) if side < 0 or number == len(places) - 1 else number
        value = of[segment]
        for variable, times in ((x, int(order)), (t, int(rate))):
            value = value.diff(variable, times) if times else value
        values[j] = value if segment_of(place) is not None else value.subs(x, where)
    return expand(expression.xreplace(values).xreplace({F_0: 1 + t}).subs(NUMBERS))


def expand(expression: Expr) -> Expr:
    """Multiplied out: what is a polynomial, as nearly all is, in a ring, which takes a tenth of the time."""
    try:
        return RING.from_expr(expression).as_expr()
    except ValueError:
        return expression.expand()


def integrated(density: Expr, variable: Any, low: Expr, high: Expr) -> Expr:
    """∫ density from low to high; of a polynomial, as nearly all are, term by term."""
    try:
        polynomial = RING.from_expr(density)
    except ValueError:
        return integrate(density.expand(), (variable, low, high))
    which, total = RING.symbols.index(variable), S.Zero
    terms: dict[tuple[int, ...], Expr] = {}
    for powers, factor in polynomial.terms():
        n = powers[which] + 1
        rest = tuple(0 if i == which else power for i, power in enumerate(powers))
        terms[rest] = terms.get(rest, S.Zero) + RING.domain.to_sympy(factor) * (high**n - low**n) / n
    for rest, factor in terms.items():
        total += factor * Mul(*(v**power for v, power in zip(RING.symbols, rest, strict=True)))
    return total


def over(work: Any, motion: EquationOfMotion, moving: Mapping[str, Any], moved: Mapping[str, Any]) -> Expr:
    """A functional in jets on motions."""
    total = at_motion(work.points, motion, moving, moved)
    for number, place in enumerate(motion.beam.segments):
        here = Add(*(u for u in Add.make_args(work.density) if any(j.args[3] == place for j in jets(u))))
        bounds = [p.subs(NUMBERS) for p in motion.beam.places[number : number + 2]]
        total += integrated(at_motion(here, motion, moving, moved), x, *bounds)
    return expand(total)


def _at_middle(density: Expr, middle: Expr) -> Expr:
    """A density with each Piecewise as it is at a place."""

    def chosen(piecewise: Expr) -> Expr:
        return next(v for v, condition in piecewise.args if condition.subs(x, middle) == True)  # noqa: E712

    return density.replace(lambda e: isinstance(e, Piecewise), chosen)


def stated(column: Column, name: str, motion: EquationOfMotion, moving: Mapping[str, Any], moved: Any = None) -> Expr:
    """A work or an energy as it stands in the statement, by SymPy alone, on motions that are piecewise polynomials."""
    places = [p.subs(NUMBERS) for p in motion.beam.places]

    def piecewise(of: Any, side: int) -> Lambda:
        if not isinstance(of, list):
            return Lambda(t, of)
        pieces = [(piece, x < place if side > 0 else x <= place) for piece, place in zip(of, places[1:], strict=True)]
        return Lambda((x, t), Piecewise(*pieces[:-1], (pieces[-1][0], True)))

    def on(expression: Expr, side: int) -> Expr:
        for function in column.unknowns:
            expression = expression.replace(function, piecewise(moving[str(function)], side))
            if moved is not None:
                variation_ = getattr(function, "variation", None) or delta(y).func
                expression = expression.replace(variation_, piecewise(moved[str(function)], side))
        return expression

    def points(e: Expr) -> Expr:
        place = e.point[0]
        if place.func == leap:
            return at_side(e.expr, place.args[0], 1) - at_side(e.expr, place.args[0], -1)
        side = int(place.args[1]) if place.func == beside else (-1 if place == 1 else 1)
        return at_side(e.expr, place.args[0] if place.func == beside else place, side)

    def at_side(e: Expr, place: Expr, side: int) -> Expr:
        done = on(e.subs(NUMBERS), side).doit()
        return done.subs(x, place.subs(NUMBERS))

    def along(e: Expr) -> Expr:
        (low, high) = (v.subs(NUMBERS) for v in e.limits[0][1:])
        inner = sorted({low, high, *(p for p in places if low < p < high)})
        density = e.function.subs(NUMBERS)
        total = S.Zero
        for left, right in pairwise(inner):
            segment = max(n for n, p in enumerate(places[:-1]) if p <= left)
            plain = _at_middle(density.rewrite(Piecewise), (left + right) / 2)
            for function in column.unknowns:
                of = moving[str(function)]
                plain = plain.replace(function, Lambda((x, t), of[segment]) if isinstance(of, list) else Lambda(t, of))
                if moved is not None:
                    image = moved[str(function)]
                    image = Lambda((x, t), image[segment]) if isinstance(image, list) else Lambda(t, image)
                    plain = plain.replace(getattr(function, "variation", None) or delta(y).func, image)
            total += integrated(plain.doit(), x, left, right)
        return total

    whole = nsimplify(getattr(column.energies, name), rational=True).subs({F_0: 1 + t})
    whole = whole.replace(lambda e: isinstance(e, Integral), along)
    whole = whole.replace(lambda e: isinstance(e, Subs), points)
    plain = on(whole.subs(NUMBERS), 1).doit()
    return expand(plain)


@cache
def derived(name: str) -> tuple[Column, EquationOfMotion]:
    column = CASES[name]()
    return column, variation.derive_column(column)


@pytest.fixture(params=CASES)
def case(request: pytest.FixtureRequest) -> tuple[Column, EquationOfMotion]:
    return derived(request.param)


def test_the_weak_form_is_hamilton_s_principle_as_stated(case: tuple[Column, EquationOfMotion]) -> None:
    """∫ (δT − δV + δW_c + δW_nc) dt, from the statement evaluated at y + ε δy, is −∫ weak dt; δy = 0 at t = 0, 1."""
    column, motion = case
    moving, still = polynomials(column, motion, 3, False), polynomials(column, motion, 5, True)
    fading = t**2 * (1 - t) ** 2

    def added(factor: Any) -> dict[str, Any]:
        return {
            name: [u + factor * fading * v for u, v in zip(of, still[name], strict=True)]
            if isinstance(of, list)
            else of + factor * fading * still[name]
            for name, of in moving.items()
        }

    moved = {n: [fading * v for v in of] if isinstance(of, list) else fading * of for n, of in still.items()}
    total = stated(column, "dW_nc", motion, moving, moved)
    for name, sign in (("T", 1), ("V", -1), ("W_c", 1)):
        energies = [stated(column, name, motion, added(factor)) for factor in (1, -1)]
        total += sign * (energies[0] - energies[1]) / 2  # exact: energies are quadratic
    weak = over(motion.weak, motion, moving, moved)
    assert integrated(total + weak, t, S.Zero, S.One) == 0


def test_equations_and_conditions_are_the_weak_form(case: tuple[Column, EquationOfMotion]) -> None:
    """Σ ∫ equation δy dx + Σ condition δy + Σ coordinates δq is the weak form, for every motion and virtual motion."""
    column, motion = case
    moving, moved = polynomials(column, motion, 2, False), polynomials(column, motion, 4, True)
    left = over(motion.weak, motion, moving, moved)
    for (name, segment), factor in motion.equations.items():
        bounds = [p.subs(NUMBERS) for p in motion.beam.places[segment : segment + 2]]
        left -= integrated(at_motion(factor, motion, moving, moved) * moved[name][segment], x, *bounds)
    for name, work in motion.of_coordinates.items():
        left -= over(work, motion, moving, moved) * moved[name]
    for condition in motion.conditions:
        last = len(motion.beam.places) - 1
        before = condition.side < 0 or condition.place == last
        of = moved[condition.field][condition.place - 1 if before else condition.place]
        place = motion.beam.places[condition.place].subs(NUMBERS)
        value = (of.diff(x, condition.order) if condition.order else of).subs(x, place)
        left -= at_motion(condition.factor, motion, moving, moved) * value
    for place, force in motion.forces:
        where = Rational(1, 4)
        segment = max(n for n, p in enumerate(motion.beam.places[:-1]) if p.subs(NUMBERS) <= where)
        left += at_motion(force, motion, moving, moved) * moved["y"][segment].subs(x, where)
        assert place == x_F
    assert expand(left) == 0


def _rate(expression: Expr, order: int) -> Expr:
    return expression.diff(t, order) if order else expression


def test_forms_are_the_weak_form(case: tuple[Column, EquationOfMotion]) -> None:
    """Σ P^k (M_k q̈ + C_k q̇ + K_k q) less F_0 Q is the weak form, form by form."""
    column, motion = case
    system = assembly.assemble(column, motion)
    moving, moved = polynomials(column, motion, 6, False), polynomials(column, motion, 1, True)
    places = [p.subs(NUMBERS) for p in motion.beam.places]

    def value(v: Any, of: Mapping[str, Any]) -> Expr:
        if v.place is None:
            return of[v.of]
        where = v.place.subs(NUMBERS)
        segment = max(n for n, p in enumerate(places[:-1]) if p < where or (p == where and v.side >= 0) or n == 0)
        segment = segment if v.side >= 0 or places[segment] < where else segment - 1
        piece = of[v.of][segment]
        return (piece.diff(x, v.order) if v.order else piece).subs(x, where)

    total = S.Zero
    for rate, powers in ((2, system.M), (1, system.C), (0, system.K)):
        accelerated = {
            n: [p.diff(t, rate) if rate else p for p in of]
            if isinstance(of, list)
            else (of.diff(t, rate) if rate else of)
            for n, of in moving.items()
        }
        for power, form in enumerate(powers):
            for key, factor in form.along.items():
                u, v = (
                    of[name]
                    if not isinstance(of[name], list)
                    else (of[name][key.segment].diff(x, order) if order else of[name][key.segment])
                    for of, name, order in ((moved, key.test, key.p), (accelerated, key.trial, key.q))
                )
                bounds = places[key.segment : key.segment + 2]
                total += P**power * integrated(factor.subs(NUMBERS) * u * v, x, *bounds)
            for (test, seen), factor in form.points.items():
                total += P**power * factor.subs(NUMBERS) * value(test, moved) * value(seen, accelerated)
    for seen, factor in system.force:
        total -= (1 + t) * factor * value(seen, moved)
    assert expand(total - over(motion.weak, motion, moving, moved)) == 0
