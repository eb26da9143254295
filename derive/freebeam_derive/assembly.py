"""The weak form of any column as forms of M, C and K, and the rigid motions that decide nothing. Eqs. (9)-(13).

A rigid motion r costs no elastic energy, K(0) r = 0. A subspace R of such motions is left out of the elastic spectrum
where it is invariant, K(P) R ⊂ M R and C(P) R ⊂ M R for every load, and holds nothing but λ = 0 and decay: then
eigenvalues of the whole are those of R and those of what is M-orthogonal to it. Both sides are compared as
functionals of the test function, densities and factors at places after integration by parts, so that this is proven
for the beam itself and for every series.
"""

from __future__ import annotations

from typing import Any

from sympy import Add, Expr, Integer, Integral, Matrix, Poly, S, cancel, expand, eye, zeros

from freebeam_derive.forms import Along, BilinearForm, GeneralSystem, Space, Value
from freebeam_derive.jets import ALWAYS, beside, name_of, segment_of, trial
from freebeam_derive.notation import F_0, P, alpha, beta, x, x_F
from freebeam_derive.statement import Column, StatementError, jet, jets, show
from freebeam_derive.variation import EquationOfMotion, ends_of, joined_values, parts

Powers = dict[int, BilinearForm]


def assemble(column: Column, motion: EquationOfMotion) -> GeneralSystem:
    """The matrices of a column as forms, by powers of the load, with the rigid motions that are left out.

    Raises StatementError for a force that is not F_0 at x_F, and a load that does no work on any stiffness or damping.
    """
    found: dict[int, Powers] = {0: {}, 1: {}, 2: {}}
    force: list[tuple[Value, Expr]] = []
    for part, along in ((motion.weak.density, True), (bounded(motion), False)):
        for test in jets(part, 1):
            factor = part.coeff(test)
            force += _force(test, factor, along)
            for seen in jets(factor, 0):
                _put(found[int(seen.args[2])], test, seen, factor.coeff(seen))
    M, C, K = (_by_power(found[rate]) for rate in (2, 1, 0))
    if max(map(len, (M, C, K))) < 2:
        raise StatementError("the load P does no work on the column: it enters no matrix")
    letters = {str(f): getattr(f, "letter", str(f)) for f in column.unknowns}
    coordinates = tuple((name, letters[name]) for name in column.coordinates)
    rigid = rigid_motions(motion)
    coupled = tuple(str(d) for d in (alpha, beta) if len(rigid_motions(motion, (d,))) < len(rigid))
    return GeneralSystem(
        motion.beam.places, motion.spaces, coordinates, M, C, K, tuple(force), rigid, column.parameters, coupled
    )


def bounded(motion: EquationOfMotion) -> Expr:
    """The point values of the weak form without those that the energies do not bound, as far as a natural condition
    says what they are: the slope of a Timoshenko beam at its end is the rotation there, where no shear force is. A
    series of functions that need not meet that condition would not converge."""
    joined = {space.name: space.joined for space in motion.spaces}
    points = motion.weak.points
    for condition in motion.conditions:
        place, side = motion.beam.places[condition.place], condition.side
        where = beside(place, Integer(side)) if side else place
        order = joined[condition.field]
        steep = jet(trial(condition.field), Integer(order), Integer(0), where)
        share = condition.factor.coeff(steep)
        rates = any(int(j.args[2]) for j in jets(condition.factor))
        if condition.order != order - 1 or not points.has(steep) or share == 0 or rates:
            continue
        instead = expand(cancel(-(condition.factor - share * steep) / share))
        if instead.is_polynomial(P) and all(int(j.args[1]) < joined.get(name_of(j.args[0]), 1) for j in jets(instead)):
            points = expand(points.xreplace({steep: instead}))
    return points


def _value(j: Expr) -> Value:
    which, order, _, place = j.args
    if place == ALWAYS:
        return Value(name_of(which))
    sided = place.func == beside
    return Value(name_of(which), int(order), place.args[0] if sided else place, int(place.args[1]) if sided else 0)


def _put(powers: Powers, test: Expr, seen: Expr, factor: Expr) -> None:
    """Add a term of the weak form to the forms, split by powers of the load."""
    places = [segment_of(j.args[3]) for j in (test, seen)]
    for (k,), coefficient in Poly(factor, P).terms():
        form = powers.setdefault(k, BilinearForm())
        if places == [None, None]:
            pair = (_value(test), _value(seen))
            form.points[pair] = form.points.get(pair, S.Zero) + coefficient
            continue
        (segment,) = {p for p in places if p is not None}
        key = Along(segment, name_of(test.args[0]), int(test.args[1]), name_of(seen.args[0]), int(seen.args[1]))
        form.along[key] = form.along.get(key, S.Zero) + coefficient


def _by_power(powers: Powers) -> tuple[BilinearForm, ...]:
    """Forms in the order of their powers; nothing where a power is missing."""
    kept = {
        k: BilinearForm(
            {key: f for key, v in form.along.items() if (f := expand(v)) != 0},
            {key: f for key, v in form.points.items() if (f := expand(v)) != 0},
        )
        for k, form in powers.items()
    }
    highest = max((k for k, form in kept.items() if form), default=-1)
    return tuple(kept.get(k, BilinearForm()) for k in range(highest + 1))


def _force(test: Expr, factor: Expr, along: bool) -> list[tuple[Value, Expr]]:
    """What F_0 does on a value of the test function."""
    alone = expand(-factor.xreplace(dict.fromkeys(jets(factor, 0), S.Zero)))
    if alone == 0:
        return []
    size = expand(alone / F_0)
    if along:
        raise StatementError(
            "a force along the beam without y is not supported; the transversal force is F_0 * at(delta(y), x_F)"
        )
    at_force = name_of(test.args[0]) == "y" and int(test.args[1]) == 0 and test.args[3] == x_F
    if not (at_force or test.args[3] == ALWAYS) or size.has(F_0, x, P) or (at_force and size != 1):
        raise StatementError(
            f"the work {show(alone * test)} is not supported; the transversal force is F_0 * at(delta(y), x_F)"
        )
    return [(_value(test), size)]


# --- rigid motions -------------------------------------------------------------------------------------------

Motion = dict[tuple[str, Any], Expr]
"""A motion whose fields are polynomials of first degree on each segment: (field, segment) or (coordinate, None)."""
Acting = dict[tuple[Expr, Expr], Expr]
"""What a motion gives, as a functional of the test function: (variation, function of x) -> factor."""


def rigid_motions(motion: EquationOfMotion, dampings: tuple[Expr, ...] = ()) -> tuple[Motion, ...]:
    """A basis of the rigid motions that are left out of the elastic spectrum, where there is no alpha and beta but the
    dampings that are given; empty where each of them decides."""
    motions = _straight(motion)
    try:
        elastic = [_acting(motion, m, 0).get((0, S.One), {}) for m in motions]
        motions = _combined(motions, _null_space(_columns(elastic)))
        while motions:
            driven, kept = _driven(motion, motions, dampings), eye(len(motions))
            for forces, inertia in driven.values():
                kept = _common(kept, _spanned(forces, inertia))
            if kept.cols == len(motions):
                return tuple(motions) if _harmless(driven, len(motions)) else ()
            motions = _combined(motions, kept)
    except _Unplaced:
        pass
    return ()


def _straight(motion: EquationOfMotion) -> list[Motion]:
    """Motions of first degree on each segment that meet the supports and the joints."""
    keys = [(space, segment) for space in motion.spaces for segment in range(len(motion.beam.segments))]
    every = [(space.name, segment, power) for space, segment in keys for power in range(2)]
    rows = []
    last = len(motion.beam.places) - 1
    for space in motion.spaces:
        for number, place in enumerate(motion.beam.places):
            for order in range(space.joined):
                end = {0: 0, last: 1}.get(number)
                if end is not None:
                    if (end, order) in space.held:
                        rows.append(_taken(every, space, ((min(number, last - 1), 1),), place, order))
                elif (number, order) not in space.opened:
                    rows.append(_taken(every, space, ((number - 1, -1), (number, 1)), place, order))
    null = _null_space(Matrix(rows) if rows else zeros(1, len(every)))
    basis: list[Motion] = []
    for column in range(null.cols):
        found: Motion = {}
        for value, (name, segment, power) in zip(null[:, column], every, strict=True):
            found[name, segment] = found.get((name, segment), S.Zero) + value * x**power
        basis.append(found)
    return basis + [{(name, None): S.One} for name in motion.of_coordinates]


def _taken(
    every: list[tuple[str, int, int]], space: Space, sides: tuple[tuple[int, int], ...], place: Expr, order: int
) -> list[Expr]:
    """A row: the derivative at a place of what is stated by coefficients, from one side, or the difference of both."""
    signs = dict(sides)
    return [
        signs[segment] * (x**power).diff(x, order).subs(x, place) if name == space.name and segment in signs else S.Zero
        for name, segment, power in every
    ]


def _combined(motions: list[Motion], factors: Matrix) -> list[Motion]:
    """Linear combinations of motions, a column of factors each."""
    result = []
    for column in range(factors.cols):
        total: Motion = {}
        for factor, one in zip(factors[:, column], motions, strict=True):
            for key, value in one.items():
                total[key] = expand(total.get(key, S.Zero) + factor * value)
        result.append(total)
    return result


def _acting(motion: EquationOfMotion, m: Motion, rate: int) -> dict[tuple[int, Expr], Acting]:
    """M m, C m or K m by powers of the load and by the damping alpha or beta, or 1."""
    values = {}
    for j in jets(motion.weak.density + motion.weak.points, 0):
        values[j] = _of_motion(motion, m, j) if int(j.args[2]) == rate else S.Zero
    density, points = S.Zero, motion.weak.points.xreplace(values)
    for test in jets(motion.weak.density, 1):
        factor = motion.weak.density.coeff(test)
        if test.args[3] != ALWAYS:
            density += test * factor.xreplace(values)
            continue
        for j in jets(factor, 0):  # a coordinate, moved along a segment
            low, high = motion.beam.places[segment_of(j.args[3]) :][:2]
            points += test * Integral(factor.coeff(j) * values[j], (x, low, high)).doit()
    factors, bracket = parts(expand(density))
    boundary = joined_values(expand(points + ends_of(bracket, motion.beam)), motion.beam, motion.spaces)
    found: dict[tuple[int, Expr], Acting] = {}
    for j, total in (*factors.items(), *((j, boundary.coeff(j)) for j in jets(boundary, 1))):
        if _held(motion, j):
            continue
        for term in Add.make_args(expand(total.xreplace({F_0: S.Zero}))):
            number, function = term.as_independent(x, as_Add=False)
            if number == 0:
                continue
            power = Poly(number, P).degree()
            damping = next((d for d in (alpha, beta) if number.has(d)), S.One)
            part = found.setdefault((int(power), damping), {})
            part[j, function] = part.get((j, function), S.Zero) + number.subs({P: 1, alpha: 1, beta: 1})
    return found


def _held(motion: EquationOfMotion, j: Expr) -> bool:
    """Whether a variation is one at an end that the support holds."""
    place = j.args[3]
    if place == ALWAYS or segment_of(place) is not None:
        return False
    end = {0: 0, len(motion.beam.places) - 1: 1}.get(motion.beam.index(place))  # type: ignore[arg-type]
    return any(s.name == name_of(j.args[0]) and (end, int(j.args[1])) in s.held for s in motion.spaces)


def _of_motion(motion: EquationOfMotion, m: Motion, j: Expr) -> Expr:
    """A derivative of a motion along a segment, at a place or beside it, or a coordinate."""
    which, order, _, place = j.args
    name, segment = name_of(which), segment_of(place)
    if place == ALWAYS:
        return m.get((name, None), S.Zero)
    where, side = (place.args[0], int(place.args[1])) if place.func == beside else (place, 0)
    if segment is None:
        segment = _segment_at(motion, m, name, where, side)
    taken = m.get((name, segment), S.Zero).diff(x, int(order))
    return taken if segment_of(place) is not None else taken.subs(x, where)


def _segment_at(motion: EquationOfMotion, m: Motion, name: str, place: Expr, side: int) -> int:
    """The segment that a value at a place is taken from."""
    last = len(motion.beam.segments) - 1
    number = motion.beam.index(place)
    if number is not None:
        return min(number - 1 if side < 0 else number, last)
    if len({m.get((name, k), S.Zero) for k in range(last + 1)}) > 1:
        raise _Unplaced  # a sensor between breaks, and a motion that is not the same on all segments
    return 0


class _Unplaced(Exception):
    """A sensor whose segment is not known."""


def _columns(functionals: list[Acting], keys: list[Any] | None = None) -> Matrix:
    """Functionals as the columns of a matrix, a row for each of their parts."""
    keys = sorted({key for f in functionals for key in f}, key=str) if keys is None else keys
    return Matrix(max(len(keys), 1), len(functionals), lambda i, k: functionals[k].get(keys[i], S.Zero) if keys else 0)


def _driven(
    motion: EquationOfMotion, motions: list[Motion], dampings: tuple[Expr, ...]
) -> dict[Any, tuple[Matrix, Matrix]]:
    """The forces of K and C by powers of the load and damping, beside the inertia forces of the same motions: columns
    over the same parts of the test function."""
    inertia = [_acting(motion, m, 2).get((0, S.One), {}) for m in motions]
    found: dict[Any, tuple[Matrix, Matrix]] = {}
    acting = {rate: [_acting(motion, m, rate) for m in motions] for rate in (0, 1, 2)}
    for rate, each in acting.items():
        for key in sorted({k for one in each for k in one}, key=str):
            if (rate == 2 and key == (0, S.One)) or key[1] in {alpha, beta} - {*dampings}:
                continue
            forces = [one.get(key, {}) for one in each]
            keys = sorted({k for f in (*forces, *inertia) for k in f}, key=str)
            found[rate, *key] = (_columns(forces, keys), _columns(inertia, keys))
    return found


def _null_space(matrix: Matrix) -> Matrix:
    """A basis of the null space, a column each."""
    basis = matrix.nullspace(simplify=cancel)
    return Matrix.hstack(*basis) if basis else zeros(matrix.cols, 0)


def _spanned(forces: Matrix, inertia: Matrix) -> Matrix:
    """Combinations of motions whose forces are inertia forces of motions among them."""
    null = _null_space(Matrix.hstack(forces, -inertia))
    return null[: forces.cols, :]


def _common(one: Matrix, other: Matrix) -> Matrix:
    """A basis of what two spans share."""
    null = _null_space(Matrix.hstack(one, -other))
    basis = (one * null[: one.cols, :]).columnspace(simplify=cancel) if null.cols else []
    return Matrix.hstack(*basis) if basis else zeros(one.rows, 0)


def _harmless(driven: dict[Any, tuple[Matrix, Matrix]], count: int) -> bool:
    """Whether motions driven among themselves have λ = 0 alone, and decay at one rate that alpha or beta gives."""
    stiffness = zeros(count, count)
    for (rate, power, damping), (forces, inertia) in driven.items():
        among = (inertia.T * inertia).LUsolve(inertia.T * forces).applyfunc(cancel)
        if rate == 0:
            stiffness += damping * P**power * among
        elif rate == 2 or damping == 1 or power:
            if not among.is_zero_matrix:
                return False
        elif not (among - among[0, 0] * eye(count)).applyfunc(cancel).is_zero_matrix:
            return False
    return bool((stiffness**count).applyfunc(cancel).is_zero_matrix)
