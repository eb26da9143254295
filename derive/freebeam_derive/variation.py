"""Hamilton's principle and integration by parts: from energies to the equation of motion. Eqs. (2), (6), (7), (15).

    energies, virtual work  ->  first variation  ->  weak form  ->  strong form + natural end conditions

The weak form is kept as a functional that is linear in the virtual displacement and whose sum is zero; the
strong form is the factor of delta_y along the beam, and the natural conditions are the factors of delta_y and
its slope at the ends that the geometric conditions leave free.
"""

from __future__ import annotations

from dataclasses import dataclass

from sympy import Add, DiracDelta, Eq, Expr, Integer, Mul, S, Symbol, expand

from freebeam_derive.notation import F_0, P, alpha, beta, x
from freebeam_derive.record import Step, equal
from freebeam_derive.statement import (
    ALONG,
    GEOMETRIC,
    Column,
    Energies,
    Functional,
    StatementError,
    at_place,
    display,
    jet,
    jets,
    show,
    varied,
)

STAGE = "variation"


@dataclass(frozen=True)
class EquationOfMotion:
    """What the principle gives.

    weak: the virtual work balance, linear in delta_y, equal to zero. strong: the factor of delta_y along the
    beam, in jets, point forces apart. forces: place -> force there. natural: (end, order) -> factor of
    the order-th derivative of delta_y at the end (0 or 1), in jets, equal to zero.
    """

    weak: Functional
    strong: Expr
    forces: tuple[tuple[Expr, Expr], ...]
    natural: dict[tuple[int, int], Expr]
    length: Expr
    steps: tuple[Step, ...]

    @property
    def equation(self) -> Eq:
        """Equation of motion in y(x, t). Eq. (2) with dimensions, Eq. (6) without."""
        return equal(show(self.strong) - Add(*(force * DiracDelta(x - place) for place, force in self.forces)), 0)

    def condition(self, end: int, order: int) -> Eq:
        """Natural condition at an end. Eq. (15)."""
        return equal(show(self.natural[end, order]), 0)


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
            if base.func == jet and base.args[3] == ALONG:
                changed = power * base ** (power - 1) * raised(base, p=1)
            elif base.func != jet and factor.has(x):
                changed = factor.diff(x)
            else:
                continue
            total.append(Mul(*factors[:n], changed, *factors[n + 1 :]))
    return expand(Add(*total))


def by_parts(density: Expr) -> tuple[Expr, Expr]:
    """Move every x-derivative off delta_y: density = interior * delta_y + d/dx(bracket).

    Returns (interior, bracket). The identity is checked before it is returned.
    """
    interior, bracket = S.Zero, S.Zero
    delta_0 = jet(Integer(1), Integer(0), Integer(0), ALONG)
    for virtual in jets(density, 1):
        factor, p = density.coeff(virtual), int(virtual.args[1])
        for order in range(p):
            bracket += (-1) ** order * factor * raised(delta_0, p=p - 1 - order)
            factor = total_derivative(factor)
        interior += (-1) ** p * factor
    interior, bracket = expand(interior), expand(bracket)
    if expand(density - interior * delta_0 - total_derivative(bracket)) != 0:
        raise AssertionError("integration by parts left a remainder")
    return interior, bracket


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


def derive(energies: Energies, ends: tuple[str, str], dimensional: bool = False) -> EquationOfMotion:
    """Hamilton's principle applied to energies and virtual work. Eqs. (7), (8) to (6), (15).

    Raises StatementError where the ends contradict what the statement gives there, or a force is counted twice.
    """
    length = energies.length
    T, V, W_c, dW_nc = (energies.functional(name) for name in ("T", "V", "W_c", "dW_nc"))
    _refuse_double_work(W_c, dW_nc)
    steps: list[Step] = []

    of_T, of_V, of_W_c = map(first_variation, (T, V, W_c))
    action = of_T + of_V.scaled(-1) + of_W_c + dW_nc
    steps.append(
        Step(
            STAGE,
            "Take the first variation of the energies and add the virtual work",
            "Hamilton's principle: between two instants at which the motion is given, the sum is zero for every δy",
            tuple(equal(s, display(w, length)) for s, w in _named(T, V, W_c, dW_nc)),
            equal(display(action, length), 0),
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
            display(of_T, length),
            display(off_the_rates(of_T), length),
            "Eq. (7)",
            "no rate of δy is left",
        )
    )
    steps.append(
        Step(
            STAGE,
            "Read off the weak form",
            "virtual work of inertia, stiffness and damping less that of the forces",
            equal(display(action, length), 0),
            equal(display(balance, length), 0),
            "Eq. (8)",
            "sum of the terms above, negated",
        )
    )

    strong, bracket = by_parts(balance.density)
    places = (S.Zero, length)
    boundary = expand(balance.points + at_end(bracket, length) - at_end(bracket, S.Zero))
    steps.append(
        Step(
            STAGE,
            "Integrate by parts along the beam until δy stands bare",
            "δy is arbitrary inside, so what multiplies it must vanish; the rest has gone to the ends",
            display(Functional(balance.density, S.Zero), length),
            display(
                Functional(strong * jet(Integer(1), Integer(0), Integer(0), ALONG), expand(boundary - balance.points)),
                length,
            ),
            "Eq. (2)" if dimensional else "Eq. (6)",
            "density = strong form times δy + d/dx of the bracket, expanded to zero",
        )
    )

    forces = []
    natural: dict[tuple[int, int], Expr] = {}
    for end, place in enumerate(places):
        for order in range(2):
            natural[end, order] = boundary.coeff(jet(Integer(1), Integer(order), Integer(0), place))
    for varied_jet in jets(boundary, 1):
        place, order = varied_jet.args[3], int(varied_jet.args[1])
        if place in places and order < 2:
            continue
        if place in places:
            raise StatementError(
                f"work on {show(varied_jet)}: an end of a beam takes a force or a moment, nothing higher"
            )
        if order:
            raise StatementError(
                f"work on {show(varied_jet)}: inside the beam only transversal forces are known, on delta(y)"
            )
        forces.append((place, expand(-boundary.coeff(varied_jet))))
    for end, place in enumerate(places):
        _refuse_contradiction(ends[end], end, place, balance.points, natural)
        for order in GEOMETRIC[ends[end]]:
            del natural[end, order]

    motion = EquationOfMotion(balance, strong, tuple(forces), natural, length, ())
    steps.append(
        Step(
            STAGE,
            "State the equation of motion",
            "the factor of δy along the beam",
            equal(display(balance, length), 0),
            motion.equation,
            "Eq. (2)" if dimensional else "Eq. (6)",
            "weak form minus strong form is a boundary term",
        )
    )
    steps.append(
        Step(
            STAGE,
            "State the natural end conditions",
            "at each end the factors of δy and of its slope vanish, save where the support holds them",
            show(boundary),
            tuple(motion.condition(*key) for key in sorted(natural)),
            "Eq. (15)",
            f"ends {ends[0]} and {ends[1]}: held are the orders {GEOMETRIC[ends[0]]} and {GEOMETRIC[ends[1]]}",
        )
    )
    return EquationOfMotion(balance, strong, tuple(forces), natural, length, tuple(steps))


def derive_column(column: Column) -> EquationOfMotion:
    """The nondimensional equation of motion of a column. Eqs. (6), (15)."""
    return derive(column.energies, column.ends)


def _named(*works: Functional) -> list[tuple[Expr, Functional]]:
    return list(zip(map(Symbol, ("T", "V", "W_c", "delta_W_nc")), works, strict=True))


def _refuse_double_work(W_c: Functional, dW_nc: Functional) -> None:
    """The same force in W_c and in δW_nc: a term of both alike, or all of W_c's again in δW_nc after parts.

    A part of W_c's may well return: Beck's tip force takes back an end term, Leipholz's load a slope.
    """
    for force in (P, F_0):
        conservative = first_variation(W_c.coefficient(force))
        other = dW_nc.coefficient(force)
        if not conservative or not other:
            continue
        inside, twice = by_parts(conservative.density), by_parts(other.density)
        alike = _terms(conservative.points) & _terms(other.points)
        if _terms(inside[0]) & _terms(twice[0]):
            alike |= _terms(conservative.density) & _terms(other.density)
        if inside[0] != 0:
            again = _contains(twice[0], inside[0])
        else:  # it works at the ends alone
            ends = [
                w.points + at_end(b, S.One) - at_end(b, S.Zero)
                for w, b in ((other, twice[1]), (conservative, inside[1]))
            ]
            again = _contains(*map(expand, ends))
        if alike or again:
            raise StatementError(
                f"the force {force} does the same work in W_c and in dW_nc, so it is counted twice; "
                f"keep it in W_c where it has a potential, else in dW_nc"
            )


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


def _refuse_contradiction(kind: str, end: int, place: Expr, points: Expr, natural: dict[tuple[int, int], Expr]) -> None:
    """Ends that contradict the statement: work where the support moves not, or no condition where it does.

    What else stands in a natural condition, such as a spring, does no harm: Ritz's series need not meet it.
    """
    held = GEOMETRIC[kind]
    for j in jets(points):
        if j.args[3] == place and int(j.args[1]) in held and int(j.args[2]) == 0:
            raise StatementError(
                f"the end x = {place} is stated {kind}, which holds {show(j)} at zero, but the statement lets a force "
                "do work there"
            )
    for order in sorted(set(range(2)) - set(held)):
        # of the comparison beam: bending moment against the slope, shear force against the deflection
        bent = natural[end, order].coeff(jet(Integer(0), Integer(3 - order), Integer(0), place))
        if bent.subs({P: 0, alpha: 0, beta: 0}) == 0:
            what = "shear force" if order == 0 else "bending moment"
            raise StatementError(
                f"the end x = {place} is stated {kind}, but bending gives no {what} there, so no natural condition of "
                f"a {kind} end; a bending stiffness that vanishes at an end that moves is not supported"
            )
