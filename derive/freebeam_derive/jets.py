"""Functionals of the unknowns as polynomials: a statement's energies and virtual work, read once and for all.

`jet(which, p, r, place)` is d^p/dx^p d^r/dt^r of an unknown or of its variation, so that an energy is a polynomial in
jets. which: 0 for the deflection y and 1 for δy; other unknowns by their names, `psi` and `delta_psi`. place: ALONG
under the integral, `along_k` where the beam is cut into several segments; an expression at a place; `beside(place, ±1)`
just beside it; ALWAYS for a coordinate, which has no place.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cache, lru_cache
from typing import Any

from sympy import (
    Abs,
    Add,
    Derivative,
    Dummy,
    Expr,
    Function,
    Heaviside,
    Integer,
    Integral,
    Max,
    Min,
    Mul,
    Piecewise,
    S,
    Subs,
    Symbol,
    expand,
    nsimplify,
    sign,
    sympify,
)
from sympy.core.function import AppliedUndef, UndefinedFunction
from sympy.core.relational import Eq, Ne, Relational

from freebeam_derive.notation import F_0, t, variation_of_y, x, y

ALONG = Symbol("along")  # the place of a jet that is a function of x, of a beam that is one segment
ALWAYS = Symbol("always")  # the place of a coordinate
jet = Function("jet")
beside = Function("beside")  # a place, and the side of it: −1 or +1
leap = Function("leap")  # a place at which an expression jumps

_LOST = "a term that is zero is refused, since SymPy may have lost what it was to be"
_numbers = itertools.count()


class StatementError(ValueError):
    """A column's statement that makes no sense; the message is one line with the reason and the cure."""


# --- unknowns ---------------------------------------------------------------------------------------------


def Field(name: str, latex: str = "") -> Expr:
    """A further field along the beam, an expression in x and t like y: psi = Field("psi", latex=r"\\psi").

    Raises StatementError where the name is none.
    """
    return _unknown(name, latex, "field")(x, t)


def Coordinate(name: str, latex: str = "") -> Expr:
    """A coordinate of time alone, such as the motion of an absorber: q = Coordinate("q", r"q"); q.diff(t) is its rate.

    Raises StatementError where the name is none.
    """
    return _unknown(name, latex, "coordinate")(t)


def _unknown(name: str, latex: str, kind: str) -> UndefinedFunction:
    """A function, and the function of its variation. Two of one name are not equal, so that a statement that holds
    both is refused and not merged."""
    if not isinstance(name, str) or not name.isidentifier() or name.startswith("delta_") or name in ("y", "F_0"):
        raise StatementError(
            f"{kind} {name!r}: the name is not usable; choose letters and digits, such as psi, and neither y nor F_0"
        )
    made, number = [], next(_numbers)
    for label in (name, f"delta_{name}"):
        facts = {
            "freebeam_kind": kind,
            "letter": latex or name,
            "class_key": classmethod(lambda _, label=label: (4, number, label)),
        }
        made.append(UndefinedFunction(label, (AppliedUndef,), facts, real=True))
    made[0].variation = made[1]
    return made[0]


def kind_of(function: Any) -> str:
    """ "field" or "coordinate" of a function that is an unknown or its variation; nothing of another."""
    if function in (y.func, variation_of_y.func):
        return "field"
    return str(getattr(function, "freebeam_kind", ""))


def _symbol(function: Any) -> Expr:
    """What stands for a function in a jet."""
    if function == y.func:
        return S.Zero
    return S.One if function == variation_of_y.func else Symbol(function.__name__)


def virtual(which: Expr) -> bool:
    """Whether a jet is one of a variation."""
    return bool(which == 1 or str(which).startswith("delta_"))


def name_of(which: Expr) -> str:
    """The unknown that a jet is of, or whose variation."""
    return "y" if which in (0, 1) else str(which).removeprefix("delta_")


def trial(name: str) -> Expr:
    """What stands for an unknown in its jets."""
    return S.Zero if name == "y" else Symbol(name)


def varying(name: str) -> Expr:
    """What stands for its variation in jets."""
    return S.One if name == "y" else Symbol(f"delta_{name}")


def unknowns(expressions: Iterable[Expr]) -> tuple[Any, ...]:
    """The functions of the unknowns that expressions hold, y first, the others in the order of their names.

    Raises StatementError where two have one name.
    """
    found = {a.func for e in expressions for a in sympify(e).atoms(AppliedUndef) if kind_of(a.func)}
    names = {name_of(_symbol(f)) for f in found}
    for name in sorted(names - {"y"}):
        same = {f for f in found if str(f.__name__) == name}
        if len(same) > 1:
            raise StatementError(f"{name}: two unknowns have this name; give each a name of its own")
    return tuple(sorted(names, key=lambda name: (name != "y", name)))


# --- the beam and its segments ------------------------------------------------------------------------------


@dataclass(frozen=True)
class Beam:
    """Length, and the places inside at which the beam is cut into segments, ascending."""

    length: Expr = S.One
    cuts: tuple[Expr, ...] = ()

    @property
    def places(self) -> tuple[Expr, ...]:
        """Both ends and the cuts."""
        return (S.Zero, *self.cuts, self.length)

    def along(self, segment: int) -> Expr:
        """The place of the jets that are functions of x on a segment."""
        return Symbol(f"along_{segment}") if self.cuts else ALONG

    @property
    def segments(self) -> tuple[Expr, ...]:
        """Those of all segments."""
        return tuple(self.along(k) for k in range(len(self.cuts) + 1))

    def index(self, place: Expr) -> int | None:
        """The number of a place among both ends and the cuts; None where it is not one of them."""
        return next((k for k, known in enumerate(self.places) if expand(known - place) == 0), None)


def segment_of(place: Expr) -> int | None:
    """The segment that a jet runs along; None where it is taken at a place."""
    if place == ALONG:
        return 0
    name = str(place)
    return int(name[6:]) if place.is_Symbol and name.startswith("along_") else None


@dataclass(frozen=True)
class Functional:
    """A work or an energy in jets: a density along the segments, and a sum of products of point values.

    opened: (unknown, order, place) of what it says jumps.
    """

    density: Expr
    points: Expr
    opened: frozenset[tuple[str, int, Expr]] = field(default=frozenset(), compare=False)

    def __add__(self, other: Functional) -> Functional:
        return Functional(
            expand(self.density + other.density), expand(self.points + other.points), self.opened | other.opened
        )

    def scaled(self, factor: Expr | int) -> Functional:
        return Functional(expand(factor * self.density), expand(factor * self.points), self.opened)

    def map(self, function: Callable[[Expr], Expr]) -> Functional:
        """Density and points with a function applied to each."""
        return Functional(function(self.density), function(self.points), self.opened)

    def coefficient(self, symbol: Expr) -> Functional:
        """The part that is linear in a symbol, divided by it."""
        return self.map(lambda part: part.coeff(symbol, 1))

    def __bool__(self) -> bool:
        return bool(self.density != 0 or self.points != 0)


# --- the language: expressions that a statement is written in -------------------------------------------------


def integral(density: Expr, low: Expr = S.One, high: Expr | None = None) -> Expr:
    """Integral of a density over the beam, x from 0 to 1, or to a length that is given; with two places from the first
    to the second.

    Raises StatementError where the density is zero: a term was lost before it came here.
    """
    bounds = (0, low) if high is None else (low, high)
    return Integral(_not_zero("integral", density), (x, *map(sympify, bounds)))


class _Value(Subs):  # type: ignore[misc]
    """A value at a place. Two of SymPy's are equal where their places are equal in name alone, such as `a` of another
    column of the session, declared with other assumptions; and its cache takes what is equal for the same."""

    def _hashable_content(self) -> tuple[Any, ...]:
        return (self.expr, self.variables, self.point)


def at(expression: Expr, place: Expr | float, side: int = 0) -> Expr:
    """Value of an expression in the unknowns at a place along the beam; just beside it at side −1 or +1.

    Raises StatementError where the expression is zero, since a term was lost before it came here, or the side is none.
    """
    if side not in (-1, 0, 1):
        raise StatementError(f"at(..., side={side!r}): the side of a place is -1 (left of it) or 1; leave it out")
    place = sympify(place)
    return _Value(_not_zero("at", expression), x, beside(place, side) if side else place)


def jump(expression: Expr, place: Expr | float) -> Expr:
    """Value of an expression just right of a place less that just left of it. What an energy or a work says jumps is
    free to jump.

    Raises StatementError where the expression is zero: a term was lost before it came here.
    """
    return _Value(_not_zero("jump", expression), x, leap(sympify(place)))


@dataclass(frozen=True)
class Hinge:
    """A place at which the slope of the deflection is free to jump."""

    place: Expr


def hinge(place: Expr | float) -> Hinge:
    """A hinge inside the beam, for `releases` of a Column: the slope jumps there, with no spring."""
    return Hinge(exact(sympify(place)))


def delta(expression: Expr) -> Expr:
    """First variation of an expression in the unknowns, whether along the beam or at a place. Eq. (7).

    Raises StatementError where nothing varies.
    """
    expression = sympify(expression)
    functions = {_symbol(a.func): a.func for a in expression.atoms(AppliedUndef) if kind_of(a.func)}
    functions |= {_symbol(f.variation): f.variation for f in [*functions.values()] if hasattr(f, "variation")}
    variation = show(varied(fields_of(expression, "delta")), functions)
    if variation == 0:
        raise StatementError(f"delta({expression}) is zero: it does not hold the y of freebeam_derive.notation")
    return variation


def _not_zero(helper: str, expression: Expr) -> Expr:
    expression = sympify(expression)
    if expression == 0:
        raise StatementError(f"{helper}(0): {_LOST}")
    return expression


def exact(expression: Expr) -> Expr:
    """0.5 stands for 1/2: nothing is rounded in a derivation."""
    return expression.replace(lambda e: e.is_Float, lambda e: nsimplify(e, rational=True))


# --- reading a statement into jets ------------------------------------------------------------------------


def fields_of(expression: Expr, name: str) -> Expr:
    """Replace derivatives and values of the unknowns and their variations by jets. name: what is read, for messages.

    Raises StatementError for a value at an instant, or at a place that moves along the beam.
    """

    def one(e: Expr, field: AppliedUndef, orders: tuple[int, int]) -> Expr:
        *places, time = field.args
        place = places[0] if places else x
        if time != t:
            raise StatementError(f"{name}: {e} is not taken at the time t; y at other instants is not supported")
        if place != x and place.has(x, t):
            raise StatementError(f"{name}: {e} is not taken at x or at a fixed place; such a place is not supported")
        if place != x and orders[0]:
            raise StatementError(f"{name}: {e} differentiates a value at a place; write at(y.diff(x), {place})")
        where = ALWAYS if not places else ALONG if place == x else place
        return jet(_symbol(field.func), Integer(orders[0]), Integer(orders[1]), where)

    def convert(e: Expr) -> Expr:
        if not any(kind_of(a.func) for a in e.atoms(AppliedUndef)):
            return e
        if isinstance(e, Subs):
            (variable, *others), place, inner = e.variables, e.point[0], e.expr
            if variable not in (x, t) and x not in inner.free_symbols:  # its name is SymPy's choice, and its cache's
                variable, inner = x, inner.xreplace({variable: x})
            if {variable, *others} != {x} or set(e.point) != {place} or place.has(x, t) or inner.has(Integral):
                raise StatementError(f"{name}: {e} is not taken at a fixed place; such a value is not supported")
            return at_place(convert(inner), place, name)
        if isinstance(e, Derivative):
            orders = {v: int(n) for v, n in e.variable_count}
            if isinstance(e.expr, AppliedUndef) and kind_of(e.expr.func) and set(orders) <= {x, t}:
                return one(e, e.expr, (orders.get(x, 0), orders.get(t, 0)))
            done = e.doit(integrals=False)
            if done == 0:
                raise StatementError(f"{name}: the derivative of {e.expr} is zero: {e} does not vary")
            if done == e:
                raise StatementError(f"{name}: {e} is no derivative of y in x and t; others are not supported")
            return convert(done)
        if isinstance(e, AppliedUndef) and kind_of(e.func):
            return one(e, e, (0, 0))
        return e.func(*(convert(a) for a in e.args))

    return expand(convert(expression))


def at_place(expression: Expr, place: Expr, name: str = "") -> Expr:
    """An expression in x and in jets along the beam, taken at a place, beside it or as it leaps there.

    Raises StatementError where what leaps, or is taken beside a place, is not linear in the unknowns, or piecewise.
    """
    moved = {j: jet(*j.args[:3], place) for j in jets(expression) if segment_of(j.args[3]) is not None}
    if place.func == leap:
        if not moved:
            raise StatementError(f"{name}: jump({show(expression)}, {place.args[0]}): it does not vary along the beam")
        for term in Add.make_args(expand(expression)):
            if sum(int(term.as_powers_dict()[j]) for j in moved) != 1 or term.has(Piecewise):
                raise StatementError(
                    f"{name}: jump({show(expression)}, {place.args[0]}) is not linear in y; square the jump itself, "
                    "such as jump(y.diff(x), a)**2"
                )
    bare = place.args[0] if place.func in (leap, beside) else place
    return expression.xreplace(moved).xreplace({x: bare})


def varied(expression: Expr) -> Expr:
    """First variation of an expression in jets. Eq. (7)."""
    changes: dict[Expr, Expr] = {j: jet(varying(name_of(j.args[0])), *j.args[1:]) for j in jets(expression, 0)}
    changes |= {whole: Integral(varied(whole.function), *whole.limits) for whole in expression.atoms(Integral)}
    letters = {changed: Dummy() for changed in changes}
    plain, back = expression.xreplace(letters), {letter: changed for changed, letter in letters.items()}
    parts = (plain.diff(letter).xreplace(back) * changes[changed] for changed, letter in letters.items())
    return expand(Add(*parts))


@dataclass(frozen=True)
class Reading:
    """A work or an energy as it was read: densities between places, in jets ALONG, and its point values."""

    name: str
    densities: tuple[tuple[Expr, Expr, Expr], ...]
    points: Expr
    opened: frozenset[tuple[str, int, Expr]]

    def cuts(self, length: Expr) -> Iterator[Expr]:
        """Places inside at which it wants the beam to be cut: bounds of integrals, steps of what is piecewise, jumps,
        and places at which work is done; a sensor's is none."""
        for low, high, density in self.densities:
            yield from (low, high)
            for condition in _conditions(density):
                yield _threshold(self.name, condition)[0]
        working = set(jets(self.points, 1)) if self.name == "dW_nc" else set(jets(self.points, 0))
        for j in jets(self.points):
            place = j.args[3]
            if place.func == beside:
                yield place.args[0]
            elif j in working and place != ALWAYS and not _forced_only(self.points, j):
                yield place
        yield from (place for _, _, place in self.opened)


def _forced_only(points: Expr, j: Expr) -> bool:
    """Whether nothing but the force F_0 works at a jet."""
    share = Add(*(term for term in Add.make_args(points) if term.has(j)))
    return bool(share.has(F_0) and expand(share.xreplace({F_0: S.Zero})) == 0)


def read(expression: Expr, name: str, length: Expr) -> Reading:
    """Split a work or an energy into its densities and its point values, both in jets.

    Raises StatementError for what is not read: a function beside the unknowns and F_0, a term that is neither an
    integral along the beam nor values at points, and a term that vanishes.
    """
    densities, points = [], []
    for term in Add.make_args(expand(exact(expression))):
        if term.has(S.NaN, S.Infinity, S.NegativeInfinity, S.ComplexInfinity, S.ImaginaryUnit):
            raise StatementError(f"{name}: the term {term} is not a finite real number times y")
        integrals = [f for f in Mul.make_args(term) if isinstance(f, Integral)]
        rest = Mul(*(f for f in Mul.make_args(term) if not isinstance(f, Integral)))
        if not integrals:
            found = fields_of(term, name)
            points.append(found)
        elif len(integrals) > 1 or rest.has(x) or any(kind_of(a.func) == "field" for a in rest.atoms(AppliedUndef)):
            raise StatementError(
                f"{name}: the term {term} multiplies an integral by {rest}; only constants and coordinates may stand "
                "there"
            )
        else:
            (variable, *bounds), *more = integrals[0].limits
            if more or variable != x or len(bounds) != 2 or any(b.has(x, t) for b in bounds):
                raise StatementError(
                    f"{name}: {integrals[0]} does not run over the beam, x from one fixed place to another; "
                    "other integrals are not supported"
                )
            found = fields_of(rest * _with_steps(integrals[0].function), name)
            densities.append((*bounds, found))
        if found == 0 and expression != 0:
            raise StatementError(f"{name}: the term {term} is zero; {_LOST}")
    at_points, opened = _leaps(expand(Add(*points)), name)
    opened |= _differences(at_points)
    _refuse_strays(name, Add(*(d for _, _, d in densities)), at_points)
    return Reading(name, tuple(densities), at_points, opened)


def _with_steps(density: Expr) -> Expr:
    """A density with its steps in x written as Piecewise."""
    stepping = (Heaviside, Abs, Min, Max, sign)
    return density.replace(lambda e: isinstance(e, stepping) and e.has(x), lambda e: e.rewrite(Piecewise))


def _leaps(points: Expr, name: str) -> tuple[Expr, frozenset[tuple[str, int, Expr]]]:
    """Jumps as differences of values on either side, and what they are of."""
    opened, sides = set(), {}
    for j in jets(points):
        which, p, r, place = j.args
        if place.func != leap:
            continue
        sides[j] = jet(which, p, r, beside(place.args[0], 1)) - jet(which, p, r, beside(place.args[0], -1))
        opened.add((name_of(which), int(p), place.args[0]))
    return expand(points.xreplace(sides)), frozenset(opened)


def _differences(points: Expr) -> frozenset[tuple[str, int, Expr]]:
    """What jumps though jump() does not say so: where both sides of a place enter by their difference alone."""
    opened = set()
    for right, left in both_sides(points):
        moved = expand(points.xreplace({right: right + left}))
        if not moved.has(left):
            opened.add((name_of(right.args[0]), int(right.args[1]), right.args[3].args[0]))
    return frozenset(opened)


def both_sides(points: Expr) -> Iterator[tuple[Expr, Expr]]:
    """Values just right and just left of one place, where both are there."""
    found = set(jets(points))
    for right in jets(points):
        place = right.args[3]
        if place.func == beside and place.args[1] == 1:
            left = jet(*right.args[:3], beside(place.args[0], -1))
            if left in found:
                yield right, left


def _refuse_strays(name: str, density: Expr, points: Expr) -> None:
    """What stands where it must not: other functions, values at a place under an integral, y outside of one."""
    for part, inside in ((density, True), (points, False)):
        for applied in sorted(part.atoms(AppliedUndef), key=str):
            if applied.func in (beside, leap) or applied.func == F_0.func:
                continue
            if applied.func != jet:
                raise StatementError(
                    f"{name}: {applied} is never varied; declare it, such as Field({str(applied.func)!r}) or "
                    f"Coordinate({str(applied.func)!r}); other functions beside y and F_0 are not supported"
                )
            if applied.args[3] == ALWAYS or (segment_of(applied.args[3]) is not None) == inside:
                continue
            if inside:
                raise StatementError(
                    f"{name}: {show(applied)} stands under the integral; a value at a place is not supported there"
                )
            raise StatementError(
                f"{name}: {show(applied)} stands outside an integral; use integral(...) for densities "
                "and at(..., place) for values at points"
            )
    if points.has(x):
        raise StatementError(f"{name}: x stands outside an integral; use integral(...) or at(..., place)")


# --- segments ---------------------------------------------------------------------------------------------


def _conditions(density: Expr) -> list[Relational]:
    """The relations that decide what is piecewise in x."""
    relations = {r for p in density.atoms(Piecewise) for r in p.atoms(Relational) if r.has(x)}
    return sorted((r for r in relations if not isinstance(r, Eq | Ne)), key=str)


def _threshold(name: str, relation: Relational) -> tuple[Expr, bool]:
    """The place at which a relation changes, and whether it holds left of it.

    Raises StatementError where that is no one place.
    """
    difference = expand(relation.gts - relation.lts)  # the relation says that it is positive
    slope = difference.coeff(x, 1)
    rest = expand(difference - slope * x)
    if rest.has(x) or not slope.is_number:
        raise StatementError(f"{name}: the condition {relation} does not compare x with a place, such as x < 1/2")
    return -rest / slope, bool(slope < 0)


def on_segments(reading: Reading, beam: Beam) -> Functional:
    """The functional that a reading is, its densities cut into the beam's segments.

    Raises StatementError where an integral or a step is beyond the beam, or a Piecewise has no value somewhere.
    """
    total, points = [], [reading.points]
    for low, high, density in reading.densities:
        first, last = beam.index(low), beam.index(high)
        if first is None or last is None or first >= last:
            raise StatementError(
                f"{reading.name}: the integral from {low} to {high} does not run along the beam, x from 0 to "
                f"{beam.length}; give bounds inside, the lower one first"
            )
        for segment in range(first, last):
            held = _on_segment(reading.name, density, beam, segment)
            bare = Add(*(term for term in Add.make_args(held) if not _runs(term)))
            if bare != 0:  # a coordinate alone does not vary along the beam
                points.append(expand(Integral(bare, (x, *beam.places[segment : segment + 2])).doit()))
            total.append(
                (held - bare).xreplace(
                    {j: jet(*j.args[:3], beam.along(segment)) for j in jets(held) if j.args[3] == ALONG}
                )
            )
    return Functional(expand(Add(*total)), expand(Add(*points)), reading.opened)


def _runs(term: Expr) -> bool:
    return any(segment_of(j.args[3]) is not None for j in jets(term)) or not jets(term)


def _on_segment(name: str, density: Expr, beam: Beam, segment: int) -> Expr:
    """A density without what is piecewise in x, as it is on a segment."""
    if not density.has(Piecewise):
        return density
    decided: dict[Expr, Any] = {}
    for piecewise in density.atoms(Piecewise):
        for relation in piecewise.atoms(Relational):
            if isinstance(relation, Eq | Ne) and relation.has(x):
                decided[relation] = S.false if isinstance(relation, Eq) else S.true
    for relation in _conditions(density):
        place, left = _threshold(name, relation)
        number = beam.index(place)
        if number is None:  # beyond the beam
            number = 0 if place.is_nonpositive else len(beam.places)
        decided[relation] = S.true if (segment < number) == left else S.false

    def chosen(piecewise: Piecewise) -> Expr:
        if not piecewise.has(x) or not any(r in decided for r in piecewise.atoms(Relational)):
            return piecewise
        for value, condition in piecewise.args:
            holds = condition.xreplace(decided)
            if holds == S.true:
                return value
            if holds != S.false:
                raise StatementError(f"{name}: the condition {condition} does not compare x with a place")
        low, high = beam.places[segment : segment + 2]
        raise StatementError(
            f"{name}: {show(piecewise)} has no value between x = {low} and x = {high}; add the piece, such as (1, True)"
        )

    result = density
    while any(p.has(x) for p in result.atoms(Piecewise)):
        before, result = result, result.replace(lambda e: isinstance(e, Piecewise), chosen)
        if before == result:
            break
    return expand(result)


# --- printing -----------------------------------------------------------------------------------------------


def show(expression: Expr, functions: Mapping[Expr, Any] | None = None) -> Expr:
    """A jet expression in derivatives of y(x, t) and delta_y(x, t), and of the other unknowns, for printing.

    functions: those that the other unknowns are; plain ones of their names where not given.
    """
    return expression.xreplace({j: _shown(*j.args, (functions or {}).get(j.args[0])) for j in jets(expression)})


@cache
def _shown(which: Expr, p: Expr, r: Expr, place: Expr, function: Any) -> Expr:
    if function is None and which not in (0, 1):
        function = Function(str(which), real=True)
    if place == ALWAYS:
        return function(t).diff((t, int(r))) if int(r) else function(t)
    f = y if which == 0 else variation_of_y if which == 1 else function(x, t)
    derivative = f.diff((x, int(p)), (t, int(r))) if int(p) or int(r) else f
    if segment_of(place) is not None:
        return derivative
    return Subs(derivative, x, place) if int(p) or place.func in (beside, leap) else derivative.subs(x, place)


@lru_cache(maxsize=4096)  # the jets of each term are asked for again and again while a column is derived
def jets(expression: Expr, which: int | None = None) -> tuple[Expr, ...]:
    """The jets of an expression in a fixed order: all, those of the unknowns (0) or of their variations (1)."""
    # by AppliedUndef, for SymPy asks of each node in Python whether it is of a function's own class
    found = (e for e in expression.atoms(AppliedUndef) if e.func == jet)
    chosen = [j for j in found if which is None or virtual(j.args[0]) == bool(which)]
    return tuple(sorted(chosen, key=lambda j: tuple(str(a) for a in j.args)))
