"""Nondimensional quantities and the substitution that makes them. Eq. (5).

`SCALES` is what one nondimensional unit of each quantity is in terms of bending stiffness, mass per length and
length; the runtime's SI input and output are emitted from it. `nondimensional` substitutes them into a
dimensional statement; a column that gives both must agree with itself.
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction

from sympy import Expr, Rational, S, expand, powdenest, sqrt, sympify

from freebeam_derive.jets import ALWAYS, beside, name_of, segment_of
from freebeam_derive.notation import EI, F_0, C_alpha, C_beta, L, P, alpha, beta, m, x, x_F
from freebeam_derive.record import Step
from freebeam_derive.statement import Column, Functional, StatementError, display, jet, jets

_time = sqrt(m * L**4 / EI)

SCALES: dict[str, Expr] = {
    "length": L,
    "time": _time,
    "load": EI / L**2,
    "force": EI / L**2,
    "alpha": _time,
    "beta": m / _time,
    "frequency": 1 / _time,
    "velocity": L / _time,
    "acceleration": L / _time**2,
    "energy": EI / L,
}

UNITS: dict[str, str] = {
    "length": "m",
    "time": "s",
    "load": "N",
    "force": "N",
    "alpha": "s",
    "beta": "kg/(m s)",
    "frequency": "rad/s",
    "velocity": "m/s",
    "acceleration": "m/s^2",
    "energy": "J",
}


def squares(bending_stiffness: Fraction, mass_per_length: Fraction, length: Fraction) -> dict[str, Fraction]:
    """The squares of the sizes in SCALES for a beam in SI units (N m², kg/m, m): rational numbers, unlike the sizes."""
    beam = {symbol: Rational(value) for symbol, value in ((EI, bending_stiffness), (m, mass_per_length), (L, length))}
    values = {name: (size**2).subs(beam) for name, size in SCALES.items()}
    return {name: Fraction(int(value.p), int(value.q)) for name, value in values.items()}


def nondimensional(functional: Functional, own: Mapping[Expr, Expr] | None = None) -> Functional:
    """A dimensional functional in nondimensional quantities, divided by EI / L. Eq. (5).

    Every length (x, y and places) is L times the nondimensional one, time and loads as `SCALES` has them. own: what
    further quantities are in nondimensional ones, such as {m_tip: mu * m * L}, and further unknowns, such as
    {q: L * q}; an unknown that is not among them is taken for an angle.
    """
    given = {key: sympify(value) for key, value in (own or {}).items()}
    sizes = {str(getattr(key, "func", key)): value / key for key, value in given.items() if not key.is_Symbol}
    quantities = {
        **{key: value for key, value in given.items() if key.is_Symbol},
        P: SCALES["load"] * P,
        F_0: SCALES["force"] * F_0,
        C_alpha: SCALES["alpha"] * alpha,
        C_beta: SCALES["beta"] * beta,
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


def scales(load_unit: str) -> dict[str, Expr]:
    """`SCALES`, the load's in a unit of its own: "N", "N m" of a torque, "N/m" of a force per length."""
    return {**SCALES, "load": SCALES["load"] * {"N m": L, "N/m": 1 / L}.get(load_unit, 1)}


def derive_scaling(column: Column) -> tuple[Step, ...]:
    """Derive the nondimensional statement of a column from its dimensional one, term by term. Eqs. (1)-(5), (8).

    Raises StatementError where the two differ; gives no step where the column has no dimensional statement.
    """
    if column.dimensional is None:
        return ()
    steps = []
    for name in ("T", "V", "W_c", "dW_nc"):
        given = column.dimensional.functional(name)
        derived = nondimensional(given, column.dimensional.scaling)
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
                "lengths in L, time in (m L^4 / EI)^(1/2), forces in EI / L^2, energies in EI / L",
                display(given, column.dimensional.length, column.dimensional.cuts),
                display(derived, S.One, column.cuts),
                "Eq. (5)",
                "equals the nondimensional statement, Eq. (8)",
            )
        )
    return tuple(steps)
