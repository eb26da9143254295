"""What defines a column, as formulas: equations of motion, and all conditions at ends and breaks. Eqs. (6), (15)."""

from __future__ import annotations

from sympy import Add, Expr, factor

from freebeam_derive.jets import beside, jet, jets, show, trial
from freebeam_derive.latex import printer
from freebeam_derive.statement import Column
from freebeam_derive.variation import derive_column


def formulas(column: Column) -> dict[str, list[str]]:
    """What defines a column, in LaTeX, a formula each: its equations of motion without the transversal force, each
    after the part of the beam that it holds on, and all conditions at ends and breaks."""
    motion, tex = derive_column(column), printer(column)
    places = motion.beam.places

    def zero(expression: Expr) -> str:
        """expression = 0, collected by its derivatives."""
        left = Add(*(factor(expression.coeff(j)) * show(j) for j in jets(expression)))
        return f"{tex.doprint(-left if left.could_extract_minus_sign() else left)} = 0"

    def value(name: str, order: int, place: Expr) -> str:
        return str(tex.doprint(show(jet(trial(name), order, 0, place))))

    equations = [
        rf"{tex.doprint(places[k])} < x < {tex.doprint(places[k + 1])}:\quad {zero(factor_)}"
        for (_, k), factor_ in motion.equations.items()
    ]
    equations += [zero(whole.points + whole.density) for whole in motion.of_coordinates.values()]
    held = [
        f"{value(space.name, order, places[-end])} = 0" for space in motion.spaces for end, order in sorted(space.held)
    ]
    joined = [
        f"{value(space.name, order, beside(place, -1))} = {value(space.name, order, beside(place, 1))}"
        for space in motion.spaces
        for number, place in enumerate(places[1:-1], 1)
        for order in range(space.joined)
        if (number, order) not in space.opened
    ]
    return {"equations": equations, "conditions": [*held, *joined, *(zero(c.factor) for c in motion.conditions)]}
