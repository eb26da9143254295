"""Integrals of factors of x that are no polynomials, such as exp(−x), in balls that enclose them.

A kernel samples such a factor at Gauss's nodes in floats. Here its functions run on numbers that are fractions or balls
(`numbers.py`), with `_along_sampled` in another's place: the moments ∫ f ξ^k dξ are Arb's rigorous integrals, from the
factor's values on complex balls, where it has to be analytic.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from math import comb
from types import FunctionType, ModuleType, SimpleNamespace
from typing import Any

import numpy as np
from flint import acb, arb, fmpq_poly

from freebeam_derive.certify.formal import Formal
from freebeam_derive.certify.numbers import Inexact, Operators, exact_value

MOST_VALUES = 20_000
"""Of a factor in one integral; exp(−x) takes some 100 at 400 bits, √x from 0 on 1,500."""


class _Place(Operators):
    """A complex ball of places, as NumPy calls functions of it; analytic: whether those must be so on all of it."""

    def __init__(self, value: acb, analytic: bool) -> None:
        self.value, self.analytic = value, analytic

    def _with(self, other: Any, combine: Callable[[acb, acb], acb], swapped: bool = False) -> Any:
        two = other.value if isinstance(other, _Place) else exact_value(other)
        if two is None:
            return NotImplemented
        one, two = (acb(two), self.value) if swapped else (self.value, acb(two))
        return _Place(combine(one, two), self.analytic)

    def __pow__(self, power: Any) -> Any:
        if isinstance(power, int):
            return _Place(self.value**power, self.analytic)
        return self._with(power, lambda a, b: a.pow(b, self.analytic))

    def __rpow__(self, base: Any) -> Any:
        return self._with(base, lambda a, b: a.pow(b, self.analytic), True)

    def __neg__(self) -> _Place:
        return _Place(-self.value, self.analytic)

    def sqrt(self) -> _Place:
        return _Place(self.value.sqrt(self.analytic), self.analytic)

    def log(self) -> _Place:
        return _Place(self.value.log(self.analytic), self.analytic)


def _entire(name: str) -> Callable[[_Place], _Place]:
    return lambda place: _Place(getattr(place.value, name)(), place.analytic)


for _name in ("exp", "sin", "cos", "tan", "sinh", "cosh", "tanh"):  # not finite on a ball that holds a pole
    setattr(_Place, _name, _entire(_name))


def enclosing(kernel: ModuleType, formal: bool = False) -> Any:
    """A kernel's functions of M, C and K, which enclose integrals that they sample else; formal: or give them names.
    Inexact is raised for places that are no fractions, ValueError for factors that cannot be integrated."""

    def along(
        matrix: Any, basis: Any, breaks: Any, segment: int, test: Any, trial: Any, factor: Any, text: str
    ) -> None:
        low, size = breaks[segment], len(basis.order)
        length, count = breaks[segment + 1] - low, 2 * size - 1
        if formal:
            moments: list[Any] = [Formal.named(f"∫ {text} from {low} over {length}, {k}") for k in range(count)]
        else:
            moments = _moments(factor, low, length, count)
        if not formal and not all(moment.is_finite() for moment in moments):
            raise ValueError(f"{text}: its integrals from {float(low):.6g} on are not known; it is singular")
        between = np.array([[_combined((P * Q).coeffs(), moments) for Q in _legendre(size)] for P in _legendre(size)])
        block = basis.series[test[0]][test[1]] @ between @ basis.series[trial[0]][trial[1]].T
        kernel._add(matrix, basis, breaks, segment, test, trial, block)

    def checked(places: Any) -> Any:
        if any(isinstance(place, arb) for place in places):
            raise Inexact("a place is no fraction")
        return places

    def at(basis: Any, breaks: Any, name: str, order: int = 0, place: Any = None, *side: int) -> Any:
        return kernel._at(basis, breaks, name, order, *checked([place]), *side)

    def places(one: Any, **own: Any) -> Any:
        return checked(kernel.places(one, **own))

    within = {**vars(kernel), "_along_sampled": along, "_at": at, "places": places}
    return SimpleNamespace(**{
        name: FunctionType(getattr(kernel, name).__code__, within, name)
        for name in ("mass_terms", "rate_terms", "stiffness_terms")
    })  # fmt: skip


def _moments(factor: Callable[[Any], Any], low: Any, length: Any, count: int) -> list[arb]:
    """∫ factor(low + length ξ) ξ^k dξ over 0 ≤ ξ ≤ 1 for k below a count; not finite where not known."""

    def integrand(k: int) -> Callable[[acb, bool], acb]:
        def value(xi: acb, analytic: bool) -> acb:
            place = np.empty(1, dtype=object)
            place[0] = low + length * _Place(xi, analytic)
            (found,) = factor(place) + 0 * place
            total: acb = found.value * xi**k
            return total

        return value

    return [acb.integral(integrand(k), 0, 1, eval_limit=MOST_VALUES).real for k in range(count)]


def _combined(factors: Any, moments: list[Any]) -> Any:
    return sum((moment * c for c, moment in zip(factors, moments, strict=False)), 0 * moments[0])


@cache
def _legendre(count: int) -> tuple[fmpq_poly, ...]:
    """P_k(2ξ − 1) in powers of ξ, for k below a count."""
    return tuple(fmpq_poly([(-1) ** (k + j) * comb(k, j) * comb(k + j, j) for j in range(k + 1)]) for k in range(count))
