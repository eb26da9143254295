"""Proven bounds of what rounding does to emitted NumPy kernels: their own operations, carried out on balls.

The model of floats: each of + − × ÷ and √ gives the exact result times 1 + d, |d| ≤ u = 2⁻⁵³, and what is below the
normal numbers is off by 2⁻¹⁰⁷⁴ at most; a number that 53 bits hold is not rounded. Sums in a product of matrices may be
taken in any order, with or without fused multiplication. Assumed and not proven: exp, sin, cos and general powers of
the library are within four units in the last place.

A number is a ball that holds every result that such floats can have, so that the distance of its farthest point from
the exact result is a bound of the error. The exact results are the same operations in balls of many digits, from proven
enclosures of the roots, or in fractions (certify/balls.py).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from contextlib import suppress
from decimal import ROUND_CEILING, Context, Decimal
from fractions import Fraction
from functools import partialmethod
from types import ModuleType, SimpleNamespace
from typing import Any

import numpy as np
from flint import arb

from freebeam_derive.certify import balls
from freebeam_derive.independent import fraction
from freebeam_derive.kernel import BeamKernel
from freebeam_derive.verify import Sizes, load, scale_of

ASSUMING = (
    "floats of IEEE 754, rounded to nearest, none beyond their range; functions of the library (exp, sin, cos and "
    "others, powers) within 4 units in the last place"
)
UNIT = arb(2) ** -53
TINY = arb(2) ** -1074
LIBRARY = 8  # u: four units in the last place
BITS = 160  # of the balls' middles

_ROUNDED, _OF_LIBRARY = 1 + UNIT * arb(0, 1), 1 + LIBRARY * UNIT * arb(0, 1)


def _held(value: arb) -> bool:
    """Whether a ball is one number, which 53 bits hold."""
    return bool(value.is_exact()) and int(value.man_exp()[0]).bit_length() <= 53


def _power_of_two(value: arb) -> bool:
    return bool(value.is_exact()) and abs(int(value.man_exp()[0])) == 1


class Rounded:
    """Every float that a kernel can have computed at one place of its program."""

    __slots__ = ("value",)

    def __init__(self, value: arb) -> None:
        self.value = value

    def _with(self, other: Any, operation: Callable[[Any, Any], Any]) -> Any:
        if not isinstance(other, Rounded | int | float):
            return NotImplemented
        value = _value(other)
        if _held(self.value) and _held(value):  # of two floats there is one result
            with suppress(ArithmeticError):
                return Rounded(arb(operation(float(self.value), float(value))))
        return _rounded(operation(self.value, value))

    def __add__(self, other: Any) -> Any:
        if isinstance(other, int | float) and other == 0:
            return self
        return self._with(other, lambda a, b: a + b)

    __radd__ = __add__

    def __sub__(self, other: Any) -> Any:
        return self._with(other, lambda a, b: a - b)

    def __rsub__(self, other: Any) -> Any:
        return self._with(other, lambda a, b: b - a)

    def __mul__(self, other: Any) -> Any:
        if isinstance(other, Rounded | int | float) and (_power_of_two(_value(other)) or _power_of_two(self.value)):
            product = self.value * _value(other)  # exact, but for what is below the normal numbers
            return Rounded(product if _held(product) else product + TINY * arb(0, 1))
        return self._with(other, lambda a, b: a * b)

    __rmul__ = __mul__

    def __truediv__(self, other: Any) -> Any:
        return self._with(other, lambda a, b: a / b)

    def __rtruediv__(self, other: Any) -> Any:
        return self._with(other, lambda a, b: b / a)

    def __neg__(self) -> Rounded:
        return Rounded(-self.value)

    def __abs__(self) -> Rounded:
        return Rounded(abs(self.value))

    def __pow__(self, power: int) -> Any:
        if power == 0:
            return Rounded(arb(1))
        if power == 1:
            return self
        return Rounded(self.value**power * _OF_LIBRARY + TINY * arb(0, 1))

    def __mod__(self, other: int) -> Rounded:
        return Rounded(arb(self._whole() % other))

    def _whole(self) -> int:
        found = self.value.unique_fmpz()
        if found is None or not self.value.is_exact():
            raise ArithmeticError(f"{self.value}: is no whole number")
        return int(found)

    def _decided(self, other: Any, found: Callable[[arb, arb], bool], otherwise: Callable[[arb, arb], bool]) -> bool:
        """A comparison; raises ArithmeticError where rounding may decide it."""
        value = other.value if isinstance(other, Rounded) else arb(other)
        if not found(self.value, value) and not otherwise(self.value, value):
            raise ArithmeticError(f"rounding may decide whether {self.value} is below {value}")
        return found(self.value, value)

    def __eq__(self, other: object) -> bool:
        return self._decided(other, lambda a, b: a == b, lambda a, b: a != b)

    def __lt__(self, other: Any) -> bool:
        return self._decided(other, lambda a, b: a < b, lambda a, b: a >= b)

    def __le__(self, other: Any) -> bool:
        return self._decided(other, lambda a, b: a <= b, lambda a, b: a > b)

    def __gt__(self, other: Any) -> bool:
        return self._decided(other, lambda a, b: a > b, lambda a, b: a <= b)

    def __ge__(self, other: Any) -> bool:
        return self._decided(other, lambda a, b: a >= b, lambda a, b: a < b)

    __hash__ = None  # type: ignore[assignment]

    def _function(self, name: str) -> Rounded:
        return Rounded(getattr(self.value, name)() * _OF_LIBRARY + TINY * arb(0, 1))

    def sqrt(self) -> Any:
        return Rounded(arb(math.sqrt(self.value))) if _held(self.value) else _rounded(self.value.sqrt())


for _name in ("exp", "log", "sin", "cos", "tan", "sinh", "cosh", "tanh"):  # as NumPy asks an object for them
    setattr(Rounded, _name, partialmethod(Rounded._function, _name))


def _rounded(value: arb) -> Rounded:
    return Rounded(value if _held(value) else value * _ROUNDED + TINY * arb(0, 1))


class _Array(np.ndarray[Any, Any]):
    """An array of them, whose products of matrices hold what any order of summation gives."""

    def __matmul__(self, other: Any) -> Any:
        left = [[(k, v) for k, v in enumerate(map(_value, row)) if v != 0] for row in np.atleast_2d(self)]
        right = [[_value(v) for v in column] for column in (other.T if other.ndim == 2 else [other])]
        found = np.empty((len(left), len(right)), dtype=object)
        for i, row in enumerate(left):
            for j, column in enumerate(right):
                found[i, j] = _summed([v * column[k] for k, v in row])
        shape = (*self.shape[:-1], *other.shape[1:])
        return found.reshape(shape).view(_Array)


def _value(number: Any) -> arb:
    return number.value if isinstance(number, Rounded) else arb(number)


def _summed(terms: list[arb]) -> Rounded:
    """The sum of products that are not rounded yet, in any order."""
    terms = [term for term in terms if term != 0]
    total, sizes = sum(terms, arb(0)), sum((abs(term) for term in terms), arb(0))
    if all(map(_held, terms)):
        least = min((int(term.man_exp()[1]) for term in terms), default=0)
        if sizes <= arb(2) ** (least + 53):
            return Rounded(total)  # every partial sum is a multiple of 2^least that 53 bits hold
    rounding = (1 + UNIT) ** len(terms) - 1
    return Rounded(total + (sizes * rounding + len(terms) * TINY) * arb(0, 1))


class _Numpy:
    """NumPy, of whose functions arrays of objects come as `_Array`."""

    def __getattr__(self, name: str) -> Any:
        found = getattr(np, name)
        if isinstance(found, type) or not callable(found):
            return found

        def wrapped(*given: Any, **options: Any) -> Any:
            result = found(*given, **options)
            return result.view(_Array) if isinstance(result, np.ndarray) and result.dtype == object else result

        return wrapped


def numbers(values: Any) -> Any:
    """Numbers that a kernel is given, floats or whole, as an array to be computed with."""
    found = np.empty(len(values), dtype=object)
    found[:] = [Rounded(arb(value)) for value in values]
    return found.view(_Array)


def instrumented(module: ModuleType) -> ModuleType:
    """The same module on arrays of `Rounded`: it must be one that nobody else uses."""
    module.__dict__["np"] = _Numpy()
    return module


def basis(module: ModuleType, N: int) -> Any:
    """The basis of an instrumented module with every rounding that making it takes."""
    if hasattr(module, "mass_terms"):
        return module.complete(numbers(range(N + 2)))
    space = SimpleNamespace(arange=lambda count, **_: numbers(range(count)), exp=_Numpy().exp, float64=None)
    return module.basis(N, space)


def given(values: dict[str, float]) -> dict[str, Any]:
    """A column's own parameters, floats that are given exactly."""
    return {name: Rounded(arb(value)) for name, value in values.items()}


def of_beam(kernel: BeamKernel, text: str, N: int, sizes: Callable[[ModuleType, Any], Sizes]) -> float:
    """The bound of rounding in an entry of M, E and H, the rigid functions with them, for functions up to N, over the
    norms of its terms, at the parameters' defaults. Raises Unproven.

    sizes: made of the plain module and its basis in balls or fractions.
    """
    module, plainly = (load(text, kernel.column.module) for _ in range(2))
    values = {p.name: float(p.default) for p in kernel.column.parameters}
    with balls.precision(BITS):
        balls.stated_exactly(plainly, {name: Fraction(value) for name, value in values.items()})
        exactly, computed = balls.basis_of(plainly, N), basis(instrumented(module), N)
        found = sizes(plainly, exactly)
        kind = fraction if plainly.COLUMN["basis"] == "legendre" else arb
        worst = 0.0
        for letter, name in (("M", "mass"), ("E", "stiffness_elastic"), ("H", "stiffness_load")):
            exact = getattr(plainly, name)(exactly, True, **{key: kind(value) for key, value in values.items()})
            rounded = getattr(module, name)(computed, True, **given(values))
            scale = scale_of(getattr(kernel.system, letter), values, found)
            worst = max(worst, largest(rounded, exact, scale))
    return upward(worst)


def largest(computed: Any, exact: Any, scale: Any) -> float:
    """The largest proven error of an entry, over its scale; not below. Raises Unproven where there is no bound."""
    worst = arb(0)
    for (i, j), number in np.ndenumerate(computed):
        error = abs(_value(number) - arb(exact[i, j]))
        if error == 0:
            continue
        found = error / (arb(float(scale[i, j])) * (1 - arb(2) ** -40))  # scales are floats, good to many digits
        if not found.is_finite():
            raise balls.Unproven(f"row {i + 1}, column {j + 1}: has no bound")
        worst = worst.max(found.upper())
    return math.nextafter(float(worst.mid()), math.inf) if worst != 0 else 0.0


def upward(value: float) -> float:
    """A decimal of two digits, not below."""
    return float(Decimal(value).normalize(Context(prec=2, rounding=ROUND_CEILING)))
