"""Hamilton's principle and integration by parts: from energies to the equation of motion. Eqs. (2), (6), (7), (15).

    energies, virtual work  ->  first variation  ->  weak form  ->  strong form + natural end conditions

The weak form is kept as a functional that is linear in the virtual displacement and whose sum is zero; the
strong form is the factor of delta_y along the beam, and the natural conditions are the factors of delta_y and
its slope at the ends that the geometric conditions leave free.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property

from sympy import Add, DiracDelta, Dummy, Eq, Expr, Integer, Mul, S, Symbol, expand

from freebeam_derive.display import gathered
from freebeam_derive.forms import Space
from freebeam_derive.jets import ALWAYS, Beam, beside, both_sides, leap, name_of, segment_of, trial, varying
from freebeam_derive.notation import F_0, P, alpha, beta, x
from freebeam_derive.record import Step, equal
from freebeam_derive.statement import (
    GEOMETRIC,
    WORKS,
    Column,
    Energies,
    Functional,
    StatementError,
    at_place,
    display,
    jet,
    jets,
    joined,
    show,
    varied,
)

STAGE = "variation"


@dataclass(frozen=True)
class Condition:
    """What vanishes at an end or at a break: the factor of the order-th derivative of a field's variation there.

    place: number of the break, 0 for x = 0. side: −1 or +1 where the field is free to jump at the break, else 0.
    factor: in jets, equal to zero.
    """

    place: int
    side: int
    field: str
    order: int
    factor: Expr


@dataclass(frozen=True)
class EquationOfMotion:
    """What the principle gives.

    weak: the virtual work balance, linear in the variations, equal to zero. equations: (field, segment) -> factor of
    its variation along the segment, in jets, point forces apart. of_coordinates: coordinate -> the factor of its
    variation, an integral and point values, equal to zero. forces: place -> force there. conditions: the natural
    conditions at ends and breaks. beam, spaces: where it is cut, and how each field is held and joined.
    """

    weak: Functional
    equations: dict[tuple[str, int], Expr]
    of_coordinates: dict[str, Functional]
    forces: tuple[tuple[Expr, Expr], ...]
    conditions: tuple[Condition, ...]
    beam: Beam
    spaces: tuple[Space, ...]
    steps: tuple[Step, ...]

    @property
    def textbook(self) -> bool:
        """Whether it is a deflection's alone, along one segment."""
        return [*self.equations] == [("y", 0)] and not self.of_coordinates

    @property
    def length(self) -> Expr:
        return self.beam.length

    @property
    def strong(self) -> Expr:
        """The factor of δy along a beam that is one segment, in jets, point forces apart."""
        (factor,) = self.equations.values()
        return factor

    @cached_property
    def natural(self) -> dict[tuple[int, int], Expr]:
        """(end, order) -> factor of the order-th derivative of δy at the end, of a beam that is one segment."""
        return {(c.place, c.order): c.factor for c in self.conditions}

    @property
    def written(self) -> tuple[Eq, ...]:
        """Equations of motion of the fields, segment by segment, and of the coordinates."""
        along = [self._field(*key) for key in self.equations]
        return (*along, *(equal(_of_coordinate(w, self.beam), 0) for w in self.of_coordinates.values()))

    def _field(self, name: str, segment: int) -> Eq:
        forces = self.forces if name == "y" else ()
        along = show(gathered(self.equations[name, segment]))
        return equal(along - Add(*(force * DiracDelta(x - place) for place, force in forces)), 0)

    @property
    def equation(self) -> Eq:
        """Equation of motion in y(x, t). Eq. (2) with dimensions, Eq. (6) without."""
        return self._field("y", 0)

    def condition(self, end: int, order: int) -> Eq:
        """Natural condition at an end. Eq. (15)."""
        return equal(show(self.natural[end, order]), 0)


def _of_coordinate(factor: Functional, beam: Beam) -> Expr:
    return display(factor, beam.length, beam.cuts)


def raised(j: Expr, p: int = 0, r: int = 0) -> Expr:
    """A jet with p more derivatives in x and r more in t."""
    which, order, rate, place = j.args
    return jet(which, order + p, rate + r, place)


def total_derivative(expression: Expr) -> Expr:
    """d/dx of an expression in x and in jets along the beam: factor by factor."""
    total = []
    for term in Add.make_args(expand(expression)):
        factors = Mul.make_args(term)
        for n, factor in enumerate(factors):
            base, power = factor.as_base_exp()
            if base.func == jet and segment_of(base.args[3]) is not None:
                changed = power * base ** (power - 1) * raised(base, p=1)
            elif base.func != jet and factor.has(x):
                changed = factor.diff(x)
            else:
                continue
            total.append(Mul(*factors[:n], changed, *factors[n + 1 :]))
    return expand(Add(*total))


def parts(density: Expr) -> tuple[dict[Expr, Expr], Expr]:
    """Move every x-derivative off the variations: density = Σ factor * variation + d/dx(bracket).

    Returns the factors, by the variations, and the bracket. The identity is checked before it is returned.
    """
    factors: dict[Expr, Expr] = {}
    bracket = S.Zero
    for virtual in jets(density, 1):
        which, p, _, place = virtual.args
        bare = jet(which, Integer(0), Integer(0), place)
        factor = density.coeff(virtual)
        for order in range(int(p)):
            bracket += (-1) ** order * factor * raised(bare, p=int(p) - 1 - order)
            factor = total_derivative(factor)
        factors[bare] = factors.get(bare, S.Zero) + (-1) ** int(p) * factor
    factors, bracket = {bare: expand(f) for bare, f in factors.items()}, expand(bracket)
    if expand(density - Add(*(f * bare for bare, f in factors.items())) - total_derivative(bracket)) != 0:
        raise AssertionError("integration by parts left a remainder")
    return factors, bracket


def by_parts(density: Expr) -> tuple[Expr, Expr]:
    """The factor of δy and the bracket, of a deflection along one segment: density = factor * δy + d/dx(bracket)."""
    factors, bracket = parts(density)
    return Add(*factors.values()), bracket


def first_variation(work: Functional) -> Functional:
    """δ of a functional in the jets of y. Eq. (7)."""

    return Functional(varied(work.density), varied(work.points))


def off_the_rates(work: Functional) -> Functional:
    """Integration by parts in time: f δẏ becomes −ḟ δy, for δy vanishes at both instants. Eq. (7)."""

    def move(part: Expr) -> Expr:
        result = part
        for virtual in jets(part, 1):
            rate = int(virtual.args[2])
            if rate:
                factor = part.coeff(virtual)
                moved = Add(*(factor.coeff(j) * raised(j, r=rate) for j in jets(factor, 0)))
                result = result - factor * virtual + (-1) ** rate * moved * raised(virtual, r=-rate)
        return expand(result)

    return Functional(move(work.density), move(work.points))


def at_end(expression: Expr, place: Expr) -> Expr:
    """An expression along the beam, taken at a place."""
    return expand(at_place(expression, place))


def derive(
    energies: Energies,
    ends: tuple[str, str] | tuple[Space, ...],
    dimensional: bool = False,
) -> EquationOfMotion:
    """Hamilton's principle applied to energies and virtual work. Eqs. (7), (8) to (6), (15).

    ends: kinds of both ends of a deflection, or the spaces of all fields. Raises StatementError where the ends
    contradict what the statement gives there, or a force is counted twice.
    """
    beam = energies.beam
    works = {name: energies.functional(name) for name in WORKS}
    T, V, W_c, dW_nc = works.values()
    spaces = tuple(space for space in ends if isinstance(space, Space))
    if len(spaces) < len(ends):
        spaces = (_deflection(ends),)  # type: ignore[arg-type]
    _refuse_double_work(W_c, dW_nc, beam, spaces)
    steps: list[Step] = []

    def shown(work: Functional) -> Expr:
        return display(Functional(work.density, leaping(work.points)), beam.length, beam.cuts)

    of_T, of_V, of_W_c = map(first_variation, (T, V, W_c))
    action = of_T + of_V.scaled(-1) + of_W_c + dW_nc
    steps.append(
        Step(
            STAGE,
            "Take the first variation of the energies and add the virtual work",
            "Hamilton's principle: between two instants at which the motion is given, the sum is zero for every δy",
            tuple(equal(s, shown(w)) for s, w in _named(T, V, W_c, dW_nc)),
            equal(shown(action), 0),
            "Eq. (7)",
            "degree one in the variation",
        )
    )

    balance = off_the_rates(action).scaled(-1)
    steps.append(
        Step(
            STAGE,
            "Integrate the kinetic term by parts in time",
            "δy vanishes at both instants, so the rate moves from δy to the motion with a change of sign",
            shown(of_T),
            shown(off_the_rates(of_T)),
            "Eq. (7)",
            "no rate of δy is left",
        )
    )
    steps.append(
        Step(
            STAGE,
            "Read off the weak form",
            "virtual work of inertia, stiffness and damping less that of the forces",
            equal(shown(action), 0),
            equal(shown(balance), 0),
            "Eq. (8)",
            "sum of the terms above, negated",
        )
    )

    balance = balance.map(lambda part: joined_values(part, beam, spaces))
    along, bracket = parts(balance.density)
    boundary = joined_values(balance.points + ends_of(bracket, beam), beam, spaces)
    fields = {bare: factor for bare, factor in along.items() if bare.args[3] != ALWAYS}
    if spaces:
        inside = Add(*(gathered(factor) * bare for bare, factor in along.items()))
        steps.append(
            Step(
                STAGE,
                "Integrate by parts along the beam until δy stands bare",
                "δy is arbitrary inside, so what multiplies it must vanish; the rest has gone to the ends",
                shown(Functional(balance.density, S.Zero)),
                shown(Functional(inside, expand(boundary - balance.points))),
                "Eq. (2)" if dimensional else "Eq. (6)",
                "density = strong form times δy + d/dx of the bracket, expanded to zero",
            )
        )

    of_coordinates = _coordinates(along, boundary)
    conditions, forces = _conditions(boundary, beam, spaces)
    for space in spaces:
        for end in range(2):
            _refuse_contradiction(space, end, beam, balance.points, conditions)
    held = tuple(c for c in conditions if not _is_held(c, beam, spaces))

    equations = {(name_of(bare.args[0]), segment_of(bare.args[3]) or 0): factor for bare, factor in fields.items()}
    order = {space.name: k for k, space in enumerate(spaces)}
    equations = {key: equations[key] for key in sorted(equations, key=lambda key: (order[key[0]], key[1]))}
    motion = EquationOfMotion(balance, equations, of_coordinates, forces, held, beam, spaces, ())
    written = motion.written
    steps.append(
        Step(
            STAGE,
            "State the equation of motion",
            "the factor of δy along the beam",
            equal(shown(balance), 0),
            written[0] if len(written) == 1 else written,
            "Eq. (2)" if dimensional else "Eq. (6)",
            "weak form minus strong form is a boundary term",
        )
    )
    if spaces:
        said = [_said(space, beam) for space in spaces]
        steps.append(
            Step(
                STAGE,
                "State the natural end conditions",
                "at each end the factors of δy and of its slope vanish, save where the support holds them",
                show(leaping(boundary)),
                tuple(equal(show(leaping(c.factor)), 0) for c in held),
                "Eq. (15)",
                "; ".join(said),
            )
        )
    return EquationOfMotion(balance, equations, of_coordinates, forces, held, beam, spaces, tuple(steps))


def _deflection(ends: tuple[str, str]) -> Space:
    """The space of a deflection whose ends are of these kinds."""
    held = frozenset((end, order) for end, kind in enumerate(ends) for order in GEOMETRIC[kind])
    return Space("y", "y", 2, held)


def _said(space: Space, beam: Beam) -> str:
    orders = [tuple(sorted(o for e, o in space.held if e == end)) for end in range(2)]
    if space.name == "y" and not beam.cuts and space.joined == 2:
        kinds = [next(kind for kind, held in GEOMETRIC.items() if held == o) for o in orders]
        return f"ends {kinds[0]} and {kinds[1]}: held are the orders {orders[0]} and {orders[1]}"
    return f"of {space.name} are held the orders {orders[0]} at x = 0 and {orders[1]} at x = {beam.length}"


def ends_of(bracket: Expr, beam: Beam) -> Expr:
    """Σ over the segments of a bracket's value at their right ends less that at their left ends."""
    total = S.Zero
    for segment, place in enumerate(beam.segments):
        here = Add(*(term for term in Add.make_args(bracket) if any(j.args[3] == place for j in jets(term))))
        for number, sign, side in ((segment + 1, 1, -1), (segment, -1, 1)):
            where = beam.places[number]
            inside = 0 < number < len(beam.places) - 1
            total += sign * at_place(here, beside(where, Integer(side)) if inside else where)
    return expand(total)


def joined_values(expression: Expr, beam: Beam, spaces: Iterable[Space]) -> Expr:
    """Values just beside a break written as values at the break, of what is continuous there.

    Raises StatementError for a value at a break at which it jumps.
    """
    of = {space.name: space for space in spaces}
    replaced = {}
    for j in jets(expression):
        which, order, rate, place = j.args
        if place == ALWAYS or segment_of(place) is not None:
            continue
        sided = place.func == beside
        number = beam.index(place.args[0] if sided else place)
        if number in (None, 0, len(beam.places) - 1):
            if sided and number is not None:
                replaced[j] = jet(which, order, rate, beam.places[number])
            continue
        space = of[name_of(which)]
        continuous = int(order) < space.joined and (number, int(order)) not in space.opened
        if continuous and sided:
            replaced[j] = jet(which, order, rate, beam.places[number])
        elif not continuous and not sided:
            raise StatementError(
                f"{show(j)} jumps there: say on which side it is taken, such as at(..., {place}, -1) for the left"
            )
    return expand(expression.xreplace(replaced))


def leaping(expression: Expr) -> Expr:
    """An expression with what jumps written as a jump, where that is shorter: f(a⁺) is f(a⁻) and the jump at a."""
    short = expression
    right = sorted((j for j in jets(expression) if j.args[3].func == beside and j.args[3].args[1] == 1), key=str)
    places = dict.fromkeys(j.args[3].args[0] for j in right)
    for group in (*([j for j in right if j.args[3].args[0] == place] for place in places), *([j] for j in right)):
        written = {j: _leap(j) + jet(*j.args[:3], beside(j.args[3].args[0], Integer(-1))) for j in group}
        tried = expand(short.xreplace(written))
        if len(Add.make_args(tried)) < len(Add.make_args(short)):
            short = tried
    return short


def _leap(j: Expr) -> Expr:
    return jet(*j.args[:3], leap(j.args[3].args[0]))


def _coordinates(along: dict[Expr, Expr], boundary: Expr) -> dict[str, Functional]:
    """The factors of the variations of the coordinates, in the order of their names."""
    found: dict[str, Functional] = {}
    bare = {j for j in (*along, *jets(boundary, 1)) if j.args[3] == ALWAYS}
    for j in sorted(bare, key=str):
        found[name_of(j.args[0])] = Functional(along.get(j, S.Zero), boundary.coeff(j))
    return found


def _conditions(
    boundary: Expr, beam: Beam, spaces: tuple[Space, ...]
) -> tuple[tuple[Condition, ...], tuple[tuple[Expr, Expr], ...]]:
    """Factors of the variations at ends and breaks, held ones too, and the forces inside.

    Raises StatementError for work at a place on what is no force or moment.
    """
    conditions, known = [], {}
    last = len(beam.places) - 1
    for number, place in enumerate(beam.places):
        for space in spaces:
            for order in range(space.joined):
                open_here = (number, order) in space.opened and 0 < number < last
                for side in (-1, 1) if open_here else (0,):
                    where = beside(place, Integer(side)) if side else place
                    j = jet(varying(space.name), Integer(order), Integer(0), where)
                    conditions.append(Condition(number, side, space.name, order, boundary.coeff(j)))
                    known[j] = True
    forces: list[tuple[Expr, Expr]] = []
    for j in jets(boundary, 1):
        place = j.args[3]
        if j in known or place == ALWAYS:
            continue
        if beam.index(place.args[0] if place.func == beside else place) is not None:
            raise StatementError(f"work on {show(j)}: an end of a beam takes a force or a moment, nothing higher")
        if int(j.args[1]) or name_of(j.args[0]) != "y":
            raise StatementError(f"work on {show(j)}: inside the beam only transversal forces are known, on delta(y)")
        forces.append((place, expand(-boundary.coeff(j))))
    return tuple(conditions), tuple(forces)


def _is_held(condition: Condition, beam: Beam, spaces: tuple[Space, ...]) -> bool:
    end = {0: 0, len(beam.places) - 1: 1}.get(condition.place)
    return any(s.name == condition.field and (end, condition.order) in s.held for s in spaces)


def spaces_of(column: Column) -> tuple[Space, ...]:
    """The spaces of a column's fields: how each is held, joined and opened.

    Raises StatementError for a jump where there is nothing to open.
    """
    works = {name: column.energies.functional(name) for name in WORKS}
    beam = column.energies.beam
    opened = {jump for work in works.values() for jump in work.opened}
    opened |= {("y", 1, release.place) for release in column.releases}
    for work in works.values():
        _refuse_two_sides(work, beam, opened, works)
    letters = {str(f): getattr(f, "letter", "y") for f in column.unknowns}
    spaces = []
    for name in column.fields:
        degree = joined(works, name)
        here = set()
        for field, order, place in opened:
            number = beam.index(place)
            if field != name:
                continue
            if number in (None, 0, len(beam.places) - 1) or order >= degree:
                what = f"{name}.diff(x, {order})" if order > 1 else f"{name}.diff(x)" if order else name
                raise StatementError(
                    f"the jump of {what} at {place}: what may jump is the {'value or slope' if degree > 1 else 'value'}"
                    f" of {name}, inside the beam"
                )
            here.add((number, order))
        spaces.append(Space(name, letters[name], degree, column.held(name, degree), frozenset(here)))
    return tuple(spaces)


def _refuse_two_sides(
    work: Functional, beam: Beam, opened: set[tuple[str, int, Expr]], works: Mapping[str, Functional]
) -> None:
    """Both sides of a place, of what is continuous there, but as their mean: the statement may mean that it jumps."""
    for right, left in both_sides(work.points):
        name, order, place = name_of(right.args[0]), int(right.args[1]), right.args[3].args[0]
        if order >= joined(works, name) or any(
            (field, at) == (name, order) and beam.index(where) == beam.index(place) for field, at, where in opened
        ):
            continue
        half = Dummy("half")
        if expand(work.points.xreplace({right: right + half, left: left - half})).has(half):
            what = show(right).args[0]
            raise StatementError(
                f"both sides of {what} at {place} are taken, and nothing says whether it jumps there: write "
                f"jump({what}, {place}) for what jumps, and at({what}, {place}) for what does not"
            )


def derive_column(column: Column) -> EquationOfMotion:
    """The nondimensional equation of motion of a column. Eqs. (6), (15)."""
    return derive(column.energies, spaces_of(column))


def _named(*works: Functional) -> list[tuple[Expr, Functional]]:
    return list(zip(map(Symbol, ("T", "V", "W_c", "delta_W_nc")), works, strict=True))


def _refuse_double_work(W_c: Functional, dW_nc: Functional, beam: Beam, spaces: tuple[Space, ...]) -> None:
    """The same force in W_c and in δW_nc: a term of both alike, or all of W_c's again in δW_nc after parts.

    A part of W_c's may well return: Beck's tip force takes back an end term, Leipholz's load a slope.
    """
    for force in (P, F_0):
        conservative = first_variation(W_c.coefficient(force))
        other = dW_nc.coefficient(force)
        if not conservative or not other:
            continue
        (inside, bracket), (twice, again_bracket) = parts(conservative.density), parts(other.density)
        once, more = (expand(Add(*(f * bare for bare, f in found.items()))) for found in (inside, twice))
        # a follower force on links is often a dead load less its share across them: that is no double work
        alike = {t for t in _terms(conservative.points) & _terms(other.points) if not _of_links(t)}
        if _terms(once) & _terms(more):
            alike |= _terms(conservative.density) & _terms(other.density)
        if once != 0:
            again = _contains(more, once)
        else:  # it works at the ends alone
            ends = [
                joined_values(w.points + ends_of(b, beam), beam, spaces)
                for w, b in ((other, again_bracket), (conservative, bracket))
            ]
            again = _contains(*map(expand, ends))
        if alike or (again and not _of_links(once + conservative.points)):
            raise StatementError(
                f"the force {force} does the same work in W_c and in dW_nc, so it is counted twice; "
                f"keep it in W_c where it has a potential, else in dW_nc"
            )


def _of_links(expression: Expr) -> bool:
    """Whether it is of coordinates alone."""
    return all(j.args[3] == ALWAYS for j in jets(expression))


def _contains(whole: Expr, part: Expr) -> bool:
    """Whether an expression in jets and x holds every term of another, all times the same constant."""
    lead = Add.make_args(part)[0].as_independent(jet, x)
    same = [
        term.as_independent(jet, x)[0] for term in Add.make_args(whole) if term.as_independent(jet, x)[1] == lead[1]
    ]
    return bool(same) and not _terms(part) & _terms(expand(whole - Add(*same) / lead[0] * part))


def _terms(expression: Expr) -> set[Expr]:
    """The products of jets and powers of x that an expression is made of, without their constants."""
    result = set()
    for term in Add.make_args(expression):
        if term != 0:
            result.add(term.as_independent(jet, x)[1])
    return result


def _refuse_contradiction(space: Space, end: int, beam: Beam, points: Expr, conditions: tuple[Condition, ...]) -> None:
    """Ends that contradict the statement: work where the support moves not, or no condition where it does.

    What else stands in a natural condition, such as a spring, does no harm: Ritz's series need not meet it.
    """
    number = end * (len(beam.places) - 1)
    place = beam.places[number]
    held = tuple(order for e, order in sorted(space.held) if e == end)
    kind = next((kind for kind, orders in GEOMETRIC.items() if orders == held), "held")
    for j in jets(points):
        name, order, rate = name_of(j.args[0]), int(j.args[1]), int(j.args[2])
        if name == space.name and j.args[3] == place and order in held and rate == 0:
            raise StatementError(
                f"the end x = {place} is stated {kind}, which holds {show(j)} at zero, but the statement lets a force "
                "do work there"
            )
    for condition in conditions:
        if (condition.place, condition.field) != (number, space.name) or condition.order in held:
            continue
        # of the comparison beam: bending moment against the slope, shear force against the deflection
        resisting = jet(trial(space.name), Integer(2 * space.joined - 1 - condition.order), Integer(0), place)
        if condition.factor.coeff(resisting).subs({P: 0, alpha: 0, beta: 0}) == 0:
            what = "shear force" if condition.order == 0 else "bending moment"
            raise StatementError(
                f"the end x = {place} is stated {kind}, but bending gives no {what} there, so no natural condition of "
                f"a {kind} end; a bending stiffness that vanishes at an end that moves is not supported"
            )
