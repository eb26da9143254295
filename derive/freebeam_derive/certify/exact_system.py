"""The exact system of any column, without a Ritz series: its characteristic function F(P, s) as balls. Eqs. (6), (15).

All unknowns as e^(λt) turn the equations of motion into ordinary differential equations on each segment. Taylor steps
(taylor_steps.py) carry the fields and their derivatives below the order of their equations, z, from the left end of
each segment to its right end, and to places that are seen from elsewhere. Unknowns are z at the left ends and the
coordinates; F is the determinant of all conditions on them, those of ends and breaks and the equations of the
coordinates. Its zeros are the eigenvalues. It is a function of s = −λ² where no rate enters, else of s = −λ; where
damping vanishes, of s = −λ² and of w, the damping times λ, of which the first order counts.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from copy import copy
from fractions import Fraction
from typing import Any, NamedTuple

import flint
from flint import acb, arb

from freebeam_derive.certify.balls import Exact, array, exact, one, parameters, precision
from freebeam_derive.certify.beam import NoSeries, Taylor
from freebeam_derive.certify.numbers import reason
from freebeam_derive.certify.taylor_steps import Jet, Jets, Segment, Term


class _Tables(NamedTuple):
    """equations: those of each segment. conditions: (unknown, p, m, d, k, place) -> factor of P^k (−s)^m w^d."""

    equations: tuple[list[Term], ...]
    conditions: tuple[dict[tuple[str, int, int, int, int, Any], arb], ...]


class ExactSystem:
    """A column's characteristic function, at whatever precision is in force when it is asked.

    kernel: an emitted module of a column beyond the textbook's. own: the column's own parameters as rational numbers,
    defaults where left out. vanishing: alpha and beta are the direction of a damping that vanishes. Raises NoSeries,
    and ValueError for unknown parameters.
    """

    by_damping: tuple[ExactSystem, ...] | None = None
    """Over a range of a damping the factors of the powers of t, |t| ≤ 1, the last for each t (`system_ranges`)."""

    def __init__(
        self,
        kernel: Any,
        own: Mapping[str, Fraction] | None = None,
        alpha: Exact | int = 0,
        beta: Exact | int = 0,
        vanishing: bool = False,
    ) -> None:
        self.kernel = kernel
        self.name: str = kernel.COLUMN["name"]
        if reason := kernel.COLUMN["inexact"]:
            raise NoSeries(f"{self.name}: {reason}")
        self.rigid: int = kernel.COLUMN["rigid"]
        self.own = parameters(kernel, own)
        self.dampings, self.vanishing = (alpha, beta), vanishing
        self.breaks, self.sensors = self._fractions(kernel.places), self._fractions(kernel.sensors)
        self.sizes = {name: 2 * joined for name, (joined, _, _) in kernel.FIELDS.items()}
        self.width = sum(self.sizes.values())
        begin = [sum([*self.sizes.values()][:n]) for n in range(len(self.sizes))]
        self.begin = dict(zip(self.sizes, begin, strict=True))
        before = (len(self.breaks) - 1) * self.width  # what is unknown at the left ends of the segments
        self.columns = {name: before + n for n, name in enumerate(kernel.COORDINATES)}
        self._known: dict[int, _Tables] = {}
        self._rows: frozenset[int] | None = None  # of the conditions, where not all names are its own
        self._damped = self._rated(self.dampings)
        if vanishing:
            if self._rated((0, 0)):
                raise NoSeries(f"{self.name}: a damper or a gyroscopic term stays when alpha and beta vanish")
            if not self._damped:
                raise NoSeries(f"{self.name}: has no damping that could vanish")
            self._damped = False

    def _fractions(self, places: Any) -> tuple[Fraction, ...]:
        try:
            found = tuple(places(Fraction(1), **self.own))
        except (TypeError, AttributeError, ValueError) as error:
            raise NoSeries(f"{self.name}: its places are not to be had as fractions: {reason(error)}") from None
        for place in found:
            if not isinstance(place, Fraction | int) or not 0 <= place <= 1:
                raise NoSeries(f"{self.name}: the place {float(place):.6g} is no fraction from 0 to 1")
        return tuple(map(Fraction, found))

    # ---------------------------------------------------------------- what the kernel says

    def _rated(self, dampings: tuple[Exact | int, Exact | int]) -> bool:
        """Whether odd rates enter at such dampings."""
        with precision(64):
            equations, conditions = self._stated(dampings)
        rates = {r for table in equations for (*_, r, _), factor in table.items() if _some(factor)}
        rates |= {r for row in conditions for (_, _, r, _, _), factor in row.items() if _some(factor)}
        return any(r % 2 for r in rates)

    def _stated(self, dampings: tuple[Exact | int, Exact | int]) -> tuple[Any, Any]:
        """Equations and conditions as the kernel has them, of balls at the precision in force."""
        own = {name: exact(value) for name, value in self.own.items()}
        given = (*map(exact, dampings), arb(1))
        try:
            return self.kernel.equations(*given, **own), self.kernel.conditions(*given, **own)
        except (TypeError, AttributeError) as error:
            raise NoSeries(
                f"{self.name}: a factor of its equations is not to be had as a ball: {reason(error)}"
            ) from None

    def _tables(self) -> _Tables:
        bits = flint.ctx.prec
        if bits not in self._known:
            equations, conditions = self._stated(self.dampings)
            numbers = {name: n for n, name in enumerate(self.sizes)}
            self._known[bits] = _Tables(
                tuple(
                    [
                        Term(numbers[row], numbers[of], p, self._power(r), k, self._factor(factor), self._shares(r))
                        for (row, of, p, r, k), factor in table.items()
                        if row in numbers and of in numbers and _some(factor)
                    ]
                    for table in equations
                ),
                tuple(
                    {
                        (name, p, self._power(r), self._shares(r), k, place): self._ball(factor)
                        for (name, p, r, k, place), factor in row.items()
                        if (name in numbers or name in self.columns) and _some(factor)
                    }
                    for n, row in enumerate(conditions)
                    if self._rows is None or n in self._rows
                ),
            )
        return self._known[bits]

    @property
    def rated(self) -> bool:
        """Whether rates enter, so that F is a function of s = −λ."""
        return self._damped

    def _power(self, r: int) -> int:
        """m of λ^r = (−s)^m, or of (−s)^m λ where damping vanishes."""
        return r if self._damped else r // 2

    def _shares(self, r: int) -> int:
        """d of λ^r = (−s)^m w^d."""
        return r % 2 if self.vanishing else 0

    def _factor(self, factor: Any) -> Any:
        return factor if callable(factor) else [self._ball(value) for value in factor]

    def _ball(self, value: Any) -> arb:
        if isinstance(value, float) and not (value * 2**20).is_integer():
            raise NoSeries(f"{self.name}: the factor {value!r} of its equations is a rounded number, not an exact one")
        return arb(value)

    # ---------------------------------------------------------------- the characteristic function

    def undamped(self, alpha: Exact, beta: Exact) -> bool:
        """Whether F is a function of −λ² alone. The dampings are those that the system was made with."""
        return not self._damped and not self.vanishing

    def of(self, names: Sequence[str], rows: frozenset[int]) -> ExactSystem:
        """The same of some fields and coordinates alone, with so many of the conditions."""
        one = copy(self)
        one.sizes = {name: size for name, size in self.sizes.items() if name in names}
        one.width = sum(one.sizes.values())
        one.begin = {name: sum([*one.sizes.values()][:n]) for n, name in enumerate(one.sizes)}
        before = (len(self.breaks) - 1) * one.width
        one.columns = {name: before + n for n, name in enumerate(name for name in self.columns if name in names)}
        one._known, one._rows = {}, rows
        return one

    def still(self) -> ExactSystem:
        """The same column without alpha and beta."""
        return ExactSystem(self.kernel, self.own)

    def pencil(self, P: Any, value: Any, alpha: Exact, beta: Exact) -> tuple[Any, Any, Any, Any, Any]:
        """P and s of an eigenvalue λ, their slopes in λ, and that of the first in P."""
        if self._damped:
            return P, -value, arb(0), arb(-1), arb(1)
        return P, -value * value, arb(0), -2 * value, arb(1)

    def trivial(self) -> int:
        """The order of the zero of F at s = 0 that is the rigid motions', which have no part in stability.

        The derivation shows that each is a factor λ (λ + c), where c may be nothing. Should a lower power of s be seen
        not to vanish, it is that one.
        """
        most = self.rigid * (2 if self._damped else 1)
        t = self.taylor(arb(1) / 3, arb(0), tuple((0, j) for j in range(most + 1)))
        return next((j for j in range(most) if not t[0, j].contains(0)), most)

    def taylor(self, P: Any, s: Any, orders: Sequence[Any]) -> Taylor:
        """Coefficients of F(P + u, s + v) in powers of u and v: (i, j) -> ball of ∂^{i+j}F/∂P^i∂s^j / (i! j!).

        orders: with each all lower ones; of three numbers, the last is that of w. Raises Unproven.
        """
        tables = self._tables()
        real = not isinstance(P, acb) and not isinstance(s, acb)
        smooth = all(not callable(term.factor) for terms in tables.equations for term in terms)
        jets = Jets(P, s, orders, is_complex=not (real and smooth))
        carried: dict[Any, Any] = {}
        for number, terms in enumerate(tables.equations if self.width else ()):
            carried |= self._carried(number, Segment(terms, [*self.sizes.values()], jets))
        rows = [self._row(condition, carried, jets) for condition in tables.conditions]
        if len(rows) != (len(self.breaks) - 1) * self.width + len(self.columns):
            raise NoSeries(f"{self.name}: its conditions do not determine its motion")
        F: list[Any] = jets.determinant(rows)
        if real and not smooth:
            F = [value.real for value in F]
        found: dict[Any, Any] = dict(zip(jets.orders, F, strict=True))
        return found

    def _carried(self, number: int, segment: Segment) -> dict[Any, Any]:
        """Segment and what carries z from its left end there, for its right end and the sensors on it."""
        low, high = self.breaks[number : number + 2]
        seen = {n: at for n, at in enumerate(self.sensors) if sum(b <= at for b in self.breaks[1:-1]) == number}
        found: dict[Any, Any] = {}
        total = segment.start()
        for stop in sorted({*seen.values(), high}):
            total, low = segment.carry(low, stop, total), stop
            found |= {n: (number, total) for n, at in seen.items() if at == stop}
        return found | {(number, 1): (number, total)}

    def _row(self, condition: Mapping[Any, arb], carried: Mapping[Any, Any], jets: Jets) -> dict[int, Jet]:
        """A condition on the unknowns: column -> factor."""
        row: dict[int, Jet] = {}
        for (name, p, m, d, k, place), factor in condition.items():
            scale = [factor * v for v in jets.monomial(k, m, d)]
            for column, value in self._value(name, p, place, carried, jets):
                more = jets.times(value, scale)
                row[column] = [a + b for a, b in zip(row[column], more, strict=True)] if column in row else more
        return row

    def _value(self, name: str, p: int, place: Any, carried: Any, jets: Jets) -> Iterator[tuple[int, Jet]]:
        """A derivative of a field at a place, or a coordinate, by the unknowns."""
        if place is None:
            yield self.columns[name], jets.one
            return
        state = self.begin[name] + p
        if place not in carried:  # a left end
            yield place[0] * self.width + state, jets.one
            return
        number, total = carried[place]
        for start in range(self.width):
            rows = range(state, total.nrows(), self.width)
            yield number * self.width + start, [total[i, start] for i in rows]


def _some(factor: Any) -> bool:
    """Whether a factor, or one of its powers of x, is not known to be nothing."""
    if callable(factor):  # a function of x is nothing where it is exactly zero over the whole beam: a damping of 0, say
        return not one(factor(array([acb(arb(0.5, 0.5))]))) == 0
    return not all(v == 0 for v in (factor if isinstance(factor, tuple) else (factor,)))
