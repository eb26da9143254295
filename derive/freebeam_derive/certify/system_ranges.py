"""F(P, s) of a column beyond the textbook's over a range of one of its own parameters, or of alpha or beta.

Eqs. (6), (15). In one condition F is linear in the parameter and lies between its values at the ends of the range; in a
damping it is that in the middle, its slope there and its curvature over all of it. `beam_ranges` has what is proven
with it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import zip_longest
from typing import Any

import flint
from flint import arb

from freebeam_derive.certify.balls import Range
from freebeam_derive.certify.beam import Beam, NoSeries
from freebeam_derive.certify.exact_system import ExactSystem
from freebeam_derive.certify.parameter_series import straight, summed
from freebeam_derive.certify.taylor_steps import Term


class OverSystem(ExactSystem):
    """The same of a column beyond the textbook's: one of its own parameters is a `Range`, or alpha or beta is one.

    own, alpha, beta, vanishing: as of `ExactSystem`. In the limit of vanishing damping the growth rate is linear in
    beta; else F is a series in the damping (`_Power`). Raises NoSeries where the damping is not linear in
    that, or a parameter stands elsewhere than in one condition, at an end or where segments meet, or in one sum of the
    unknowns that several of them have, as the spring of a joint does.
    """

    def __init__(
        self, kernel: Any, own: Mapping[str, Any], alpha: Any = 0, beta: Any = 0, vanishing: bool = False
    ) -> None:
        self.low, self.high, self.middle = (
            ExactSystem(kernel, {name: of(value) for name, value in own.items()}, of(alpha), of(beta), vanishing)
            for of in (_low, _high, middle_of)
        )
        super().__init__(kernel, self.low.own, *self.low.dampings, vanishing)
        if self._rated((0, 0)):
            raise NoSeries(f"{self.name}: no range is served with dampers or gyroscopic terms of its own")
        self.own, self.dampings = {**self.own, **own}, (alpha, beta)
        for name, value in (*own.items(), ("alpha", alpha), ("beta", beta)):
            if isinstance(value, Range):
                self._is_linear_in(name, name in own)
                if name not in own and not vanishing:
                    ends, middle = (self.low, self.high), self.middle.dampings
                    self.by_damping = self.middle, _Power(*ends, *middle, 1), _Power(*ends, alpha, beta, 2)

    def still(self) -> ExactSystem:
        ranged = any(isinstance(value, Range) for value in self.own.values())
        return OverSystem(self.kernel, self.own) if ranged else super().still()

    def _is_linear_in(self, name: str, alone: bool) -> None:
        """alone: and that it stands in conditions as one sum of the unknowns, times a number in each, so that their
        determinant is linear in it. Raises NoSeries."""
        import sympy as sp

        place, one = sp.Symbol(name), sp.Integer(1)
        given: dict[str, Any] = {n: sp.Rational(v.numerator, v.denominator) for n, v in self.low.own.items()}
        given[name] = place
        try:
            dampings: dict[str, Any] = dict(zip(("alpha", "beta"), self.low.dampings, strict=True))
            rates = *(place if n == name else sp.Rational(v.numerator, v.denominator) for n, v in dampings.items()), one
            if not alone:
                del given[name]
            equations, conditions = self.kernel.equations(*rates, **given), self.kernel.conditions(*rates, **given)
            places = *self.kernel.places(one, **given), *self.kernel.sensors(one, **given)
            rows = [[sp.sympify(v) for row in table.values() for v in row] for table in equations]
            rows += [[sp.sympify(v) for v in row.values()] for row in conditions]
            rows += [[sp.sympify(v) for v in places]]
        except (TypeError, ValueError, AttributeError, sp.SympifyError):
            raise NoSeries(f"{self.name}: where {name} stands is not known; give it one value") from None
        if not alone and straight(rows, place):
            return
        outside = [*rows[: len(equations)], rows[-1]]
        names = [*dict.fromkeys(name for row in conditions for name in row)]
        slopes = [[sp.sympify(row.get(of, 0)).diff(place) for of in names] for row in conditions]
        inside = not any(place in v.free_symbols for row in outside for v in row)
        if not straight(rows, place) or not inside or sp.Matrix(slopes).rank() != 1:
            raise NoSeries(
                f"{self.name}: a range of {name} is served where it stands in one condition alone, linearly; "
                "give it one value"
            )

    def taylor(self, P: Any, s: Any, orders: Sequence[Any]) -> Any:
        if self.by_damping is not None:
            return summed([system.taylor(P, s, orders) for system in self.by_damping])
        low, high = (system.taylor(P, s, orders) for system in (self.low, self.high))
        return {order: value.union(high[order]) for order, value in low.items()}

    def terms(self, middle: ExactSystem) -> list[Any]:
        return [*self.by_damping] if self.by_damping else [middle, Half(self.low, self.high, middle)]


class _Power(ExactSystem):
    """∂ⁿF/∂tⁿ/n! of a column whose damping goes linearly from one to another, |t| ≤ 1, in place of F.

    alpha, beta: those in the middle, or ranges, for a ball for all t. Raises NoSeries where there is no damping at one
    of the two.
    """

    def __init__(self, low: ExactSystem, high: ExactSystem, alpha: Any, beta: Any, n: int) -> None:
        super().__init__(low.kernel, low.own, alpha, beta)
        self._ends, self.n, self._with_slopes = (low, high), n, dict[int, Any]()
        if not (low._damped and high._damped):
            raise NoSeries(f"{self.name}: there is no damping at an end of the range")

    def _tables(self) -> Any:
        """The factors of each t, and in the power of w, which is t here, half of what they grow by."""
        bits = flint.ctx.prec
        if bits not in self._with_slopes:
            whole, low, high = super()._tables(), *(of._tables() for of in self._ends)
            equations = [
                [*terms, *(term._replace(d=1) for term in _grown_terms(*sides))]
                for terms, *sides in zip(whole.equations, low.equations, high.equations, strict=True)
            ]
            conditions = [
                row | {(name, p, m, 1, k, place): f for (name, p, m, _, k, place), (f,) in _grown(*sides)}
                for row, *sides in zip(
                    whole.conditions, *(map(_listed, of.conditions) for of in (low, high)), strict=True
                )
            ]
            self._with_slopes[bits] = type(whole)(tuple(equations), tuple(conditions))
        return self._with_slopes[bits]

    def taylor(self, P: Any, s: Any, orders: Sequence[Any]) -> Any:
        found = super().taylor(P, s, [(*order, d) for order in orders for d in range(self.n + 1)])
        return {order: found[*order, self.n] for order in orders}


def _grown_terms(low: Sequence[Term], high: Sequence[Term]) -> list[Term]:
    if any(callable(term.factor) for term in (*low, *high)):
        raise NoSeries("a factor of the equations is no polynomial, and a range of a damping is not served")
    one, other = ({term._replace(factor=None): term.factor for term in terms} for terms in (low, high))
    return [term._replace(factor=factor) for term, factor in _grown(one, other)]


def _listed(row: Mapping[Any, arb]) -> dict[Any, list[arb]]:
    return {key: [factor] for key, factor in row.items()}


def _grown(low: Mapping[Any, list[arb]], high: Mapping[Any, list[arb]]) -> list[tuple[Any, list[arb]]]:
    """Half of what factors grow by from one table to another."""
    found = []
    for key in {**low, **high}:
        pairs = [*zip_longest(low.get(key, []), high.get(key, []), fillvalue=arb(0))]
        if any(a.mid() != b.mid() for a, b in pairs):
            found.append((key, [(b - a) / 2 for a, b in pairs]))
    return found


class Half:
    """Half the way of F from one end of the range to the other, in place of F."""

    def __init__(self, low: Any, high: Any, middle: Any) -> None:
        self._ends, self.pencil = (low, high), middle.pencil
        if isinstance(middle, Beam):
            self.damping = middle.damping

    def taylor(self, p: Any, s: Any, orders: Sequence[Any]) -> Any:
        low, high = (end.taylor(p, s, orders) for end in self._ends)
        return {order: (high[order] - value) / 2 for order, value in low.items()}


def _low(value: Any) -> Any:
    return value.low if isinstance(value, Range) else value


def _high(value: Any) -> Any:
    return value.high if isinstance(value, Range) else value


def middle_of(value: Any) -> Any:
    return (value.low + value.high) / 2 if isinstance(value, Range) else value
