"""The strong form of any column as tables: what its exact system is made of. mathematics.md, section 11.

Equations of motion on each segment, and the conditions at ends and breaks: held, joined, natural, and the equations of
the coordinates. Factors are split by powers of the load P.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from sympy import Expr, Lambda, Max, Min, NumberSymbol, Piecewise, Poly, S, cos, cosh, exp, expand, sin, sinh, tan, tanh

from freebeam_derive.jets import ALWAYS, Beam, beside, jets, name_of, segment_of, show
from freebeam_derive.notation import F_0, P, x
from freebeam_derive.variation import EquationOfMotion

Equation = dict[tuple[str, str, int, int, int], tuple[Expr, ...] | Lambda]
"""(equation, unknown, p, r, k) -> factor of Pᵏ ∂ᵖ⁺ʳ/∂xᵖ∂tʳ of the unknown, ascending in powers of x, or a function."""
Place = tuple[int, int] | int | None
"""(segment, 0 or 1) for its left or right end; the number of a sensor; None for a coordinate."""
Row = dict[tuple[str, int, int, int, Place], Expr]
"""(unknown, p, r, k, place) -> factor of Pᵏ ∂ᵖ⁺ʳ/∂xᵖ∂tʳ of the unknown there."""

_MEROMORPHIC = (exp, sin, cos, tan, sinh, cosh, tanh)


class NoStrongForm(ValueError):
    """A column that is not a system of ordinary differential equations in the fields; the message says why."""


@dataclass(frozen=True)
class StrongForm:
    """equations: those of each segment. conditions: each is zero. sensors: places, not breaks, that conditions see."""

    equations: tuple[Equation, ...]
    conditions: tuple[Row, ...]
    sensors: tuple[Expr, ...]


def strong_form(motion: EquationOfMotion) -> StrongForm:
    """The tables of a column. Raises NoStrongForm."""
    orders = {space.name: 2 * space.joined for space in motion.spaces}
    if flat := [name for name, order in orders.items() if not order]:
        raise NoStrongForm(f"no energy holds a derivative of {flat[0]} in x")
    equations: list[Equation] = [{} for _ in motion.beam.segments]
    for (name, segment), factor in motion.equations.items():
        for j, k, part in _terms(factor):
            place = segment_of(j.args[3])
            if place is None:
                raise NoStrongForm(f"the coordinate {show(j)} stands under an integral")
            key = (name, *_derivative(j, orders, highest=True), k)
            equations[segment][key] = _along(part)
    sensors: list[Expr] = []
    rows = [*_geometric(motion), *(_row(c.factor, motion.beam, orders, sensors) for c in motion.conditions)]
    for name, work in motion.of_coordinates.items():
        if work.density != 0:
            raise NoStrongForm(f"the coordinate {name} stands under an integral")
        rows.append(_row(work.points, motion.beam, orders, sensors))
    return StrongForm(tuple(equations), tuple(rows), tuple(sensors))


def _terms(factor: Expr) -> list[tuple[Expr, int, Expr]]:
    """What a factor of a variation is made of, without force: jet, power of P, and what multiplies them."""
    found = []
    for j in jets(factor, 0):
        coefficient = expand(factor.coeff(j).xreplace({F_0: S.Zero}))
        for (k,), part in Poly(coefficient, P).terms():
            if part.atoms(NumberSymbol) or part.has(Piecewise, Max, Min):
                raise NoStrongForm(f"the factor {part} of {show(j)} is not to be had exactly; make it a parameter")
            if part != 0:
                found.append((j, int(k), part))
    return found


def _derivative(j: Expr, orders: dict[str, int], highest: bool = False) -> tuple[str, int, int]:
    """Unknown, p and r of a jet. Raises NoStrongForm for a derivative that a state does not hold."""
    name, p, r = name_of(j.args[0]), int(j.args[1]), int(j.args[2])
    if name in orders and p >= orders[name] + highest:
        raise NoStrongForm(f"{show(j)} is beyond the derivatives of {name} that its own equation is of")
    return name, p, r


def _along(factor: Expr) -> tuple[Expr, ...] | Lambda:
    if factor.is_polynomial(x):
        return tuple(Poly(factor, x).all_coeffs()[::-1])
    if not _meromorphic(factor):  # Taylor's series are bounded on discs, which must hold no branch
        raise NoStrongForm(f"the factor {factor} is not made of polynomials, quotients, exp, sin and cos of x")
    return Lambda(x, factor.rewrite([sinh, cosh, tanh], exp))  # what power series in balls have


def _meromorphic(e: Expr) -> bool:
    if not e.has(x) or e == x:
        return True
    known = e.is_Add or e.is_Mul or isinstance(e, _MEROMORPHIC) or (e.is_Pow and e.exp.is_Integer)
    return bool(known) and all(map(_meromorphic, e.args))


def _geometric(motion: EquationOfMotion) -> list[Row]:
    """What supports hold, and what is joined at breaks."""
    rows: list[Row] = []
    last = len(motion.beam.segments) - 1
    for space in motion.spaces:
        for end, order in sorted(space.held):
            rows.append({(space.name, order, 0, 0, (end * last, end)): S.One})
        for number in range(1, last + 1):
            for order in range(space.joined):
                if (number, order) not in space.opened:
                    left, right = ((space.name, order, 0, 0, place) for place in ((number - 1, 1), (number, 0)))
                    rows.append({right: S.One, left: S.NegativeOne})
    return rows


def _row(factor: Expr, beam: Beam, orders: dict[str, int], sensors: list[Expr]) -> Row:
    row: Row = {}
    for j, k, part in _terms(factor):
        name, p, r = _derivative(j, orders)
        key = (name, p, r, k, _place(j.args[3], beam, sensors))
        row[key] = row.get(key, S.Zero) + part
    return row


def _place(place: Any, beam: Beam, sensors: list[Expr]) -> Place:
    """Where a jet is taken; a place that is no break is added to the sensors."""
    if place == ALWAYS:
        return None
    where, side = (place.args[0], int(place.args[1])) if place.func == beside else (place, 0)
    number, last = beam.index(where), len(beam.segments) - 1
    if number is None:
        if where not in sensors:
            sensors.append(where)
        return sensors.index(where)
    return (number - 1, 1) if side < 0 or number > last else (number, 0)
