"""Nondimensional quantities and the substitution that makes them. Eq. (5).

`nondimensional` substitutes the sizes of `units.SCALES`, and those that a column gives to quantities of its own, into a
dimensional statement; a column that gives both must agree with itself.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from fractions import Fraction
from typing import Any

from sympy import Expr, Rational, S, Symbol, expand, powdenest, simplify, sympify

from freebeam_derive.jets import ALWAYS, beside, name_of, segment_of
from freebeam_derive.notation import EI, F_0, C_alpha, C_beta, L, P, alpha, beta, m, x, x_F
from freebeam_derive.record import Step
from freebeam_derive.statement import Column, Functional, StatementError, display, jet, jets
from freebeam_derive.units import SCALES


def squares(
    column: Mapping[str, Any],
    beam: Sequence[Fraction],
    own: Mapping[str, Fraction] | None = None,
    names: Iterable[str] | None = None,
) -> dict[str, Fraction]:
    """The squares of a column's SI sizes for a beam (EI in N m², m in kg/m, L in m): rational, unlike the sizes.

    column: what its module says of it. own: its parameters, on which the load's may depend. names: of the quantities,
    all where None. Raises ValueError where a square is not rational.
    """
    letters = {str(symbol): symbol for symbol in (EI, m, L)} | {name: Symbol(name) for name in own or {}}
    given = map(Fraction.as_integer_ratio, (*beam, *(own or {}).values()))
    numbers = {symbol: Rational(*ratio) for symbol, ratio in zip(letters.values(), given, strict=True)}
    sizes = SCALES | {name: told["size"] for name, told in column.get("quantities", {}).items()}
    found = {}
    for name in names or sizes:
        value = simplify((sympify(sizes[name], letters) ** 2).subs(numbers))
        if not value.is_Rational:
            raise ValueError(f"{name}: the square of its size {sizes[name]} is no rational number")
        found[name] = Fraction(int(value.p), int(value.q))
    return found


def nondimensional(functional: Functional, own: Mapping[Expr, Expr] | None = None) -> Functional:
    """A dimensional functional in nondimensional quantities, divided by EI / L. Eq. (5).

    Every length (x, y and places) is L times the nondimensional one, time and loads as `SCALES` has them. own: what
    further quantities are in nondimensional ones, such as {m_tip: mu * m * L}, the load where it is no force in
    EI / L², and further unknowns, such as {q: L * q}; an unknown that is not among them is taken for an angle.
    """
    given = {key: sympify(value) for key, value in (own or {}).items()}
    sizes = {str(key.func): value / key for key, value in given.items() if not key.is_Symbol}
    quantities = {
        P: SCALES["load"] * P,
        F_0: SCALES["force"] * F_0,
        C_alpha: SCALES["alpha"] * alpha,
        C_beta: SCALES["beta"] * beta,
        **{key: value for key, value in given.items() if key.is_Symbol},
    }

    def shorter(place: Expr) -> Expr:
        """A place in lengths of the beam; x_F stands for itself in both."""
        return place if place == x_F else expand(place.xreplace(quantities) / L)

    def substitute(part: Expr, measure: Expr) -> Expr:
        fields = {}
        for j in jets(part):
            which, order, rate, place = j.args
            size = L if name_of(which) == "y" else sizes.get(name_of(which), S.One)
            if place.func == beside:
                place = beside(shorter(place.args[0]), place.args[1])
            elif segment_of(place) is None and place != ALWAYS:
                place = shorter(place)
            fields[j] = size / L ** int(order) / SCALES["time"] ** int(rate) * jet(which, order, rate, place)
        scaled = part.xreplace(fields).xreplace(quantities).xreplace({x: L * x})
        return expand(powdenest(expand(scaled * measure / SCALES["energy"]), force=True))

    return Functional(substitute(functional.density, L), substitute(functional.points, S.One))


def derive_scaling(column: Column) -> tuple[Step, ...]:
    """Derive the nondimensional statement of a column from its dimensional one, term by term. Eqs. (1)-(5), (8).

    Raises StatementError where the two differ; gives no step where the column has no dimensional statement.
    """
    if column.dimensional is None:
        return ()
    sizes = "".join(f", {name} in {told.size}" for name, told in column.quantities.items())
    steps = []
    for name in ("T", "V", "W_c", "dW_nc"):
        given = column.dimensional.functional(name)
        derived = nondimensional(given, column.scaling)
        stated = column.energies.functional(name)
        if derived != stated:
            raise StatementError(
                f"{name}: the dimensional statement gives {display(derived, S.One, column.cuts)}, but "
                f"{display(stated, S.One, column.cuts)} is stated; "
                f"correct one of them, or leave the dimensional statement out"
            )
        steps.append(
            Step(
                "scaling",
                f"Write {name} in nondimensional quantities",
                f"lengths in L, time in (m L^4 / EI)^(1/2), forces in EI / L^2, energies in EI / L{sizes}",
                display(given, column.dimensional.length, column.dimensional.cuts),
                display(derived, S.One, column.cuts),
                "Eq. (5)",
                "equals the nondimensional statement, Eq. (8)",
            )
        )
    return tuple(steps)
