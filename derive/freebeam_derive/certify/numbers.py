"""Numbers that are fractions as long as they can be, and balls from the first root or other function on."""

from __future__ import annotations

from collections.abc import Callable
from math import isqrt
from typing import Any

from flint import arb, fmpq, fmpz

__all__ = ["Inexact", "Number", "Operators", "exact_value", "plain", "reason"]


class Inexact(TypeError):
    """A number that is neither a fraction nor a ball; the message says which."""


def reason(error: Exception) -> str:
    """Why a kernel could not be computed in fractions or balls, in words: Python's own would name its methods."""
    told = isinstance(error, Inexact) or not isinstance(error, AttributeError | TypeError)
    return str(error) if told else "it is no polynomial in x, or a root or another function of a number"


class Operators:
    """Sums, products and quotients of a number with others, by its `_with`."""

    __slots__ = ()

    def _with(self, other: Any, combine: Callable[[Any, Any], Any], swapped: bool = False) -> Any:
        """combine(self, other), or combine(other, self); NotImplemented where other is no number that it knows."""
        raise NotImplementedError

    def __add__(self, other: Any) -> Any:
        return self._with(other, lambda a, b: a + b)

    def __sub__(self, other: Any) -> Any:
        return self._with(other, lambda a, b: a - b)

    def __rsub__(self, other: Any) -> Any:
        return self._with(other, lambda a, b: a - b, True)

    def __mul__(self, other: Any) -> Any:
        return self._with(other, lambda a, b: a * b)

    def __truediv__(self, other: Any) -> Any:
        return self._with(other, lambda a, b: a / b)

    def __rtruediv__(self, other: Any) -> Any:
        return self._with(other, lambda a, b: a / b, True)

    __radd__, __rmul__ = __add__, __mul__


class Number(Operators):
    """A fraction whose sums, products and quotients with fractions are such, with balls balls; and whose roots and
    functions are balls at the precision in hand, unless a root is a fraction. NumPy calls them by these names."""

    __slots__ = ("value",)

    def __init__(self, value: fmpq | int) -> None:
        self.value = fmpq(value)

    def _with(self, other: Any, combine: Callable[[Any, Any], Any], swapped: bool = False) -> Any:
        one, two = (arb(self.value), other) if isinstance(other, arb) else (self.value, _fraction(other))
        if two is None:
            return NotImplemented
        found = combine(two, one) if swapped else combine(one, two)
        return Number(found) if isinstance(found, fmpq) else found

    def __pow__(self, power: int) -> Number:
        return Number(self.value**power)

    def __neg__(self) -> Number:
        return Number(-self.value)

    def __abs__(self) -> Number:
        return Number(abs(self.value))

    def __float__(self) -> float:
        return int(self.value.p) / int(self.value.q)

    def __lt__(self, other: Any) -> Any:
        return self._with(other, lambda a, b: a < b)

    def __le__(self, other: Any) -> Any:
        return self._with(other, lambda a, b: a <= b)

    def __gt__(self, other: Any) -> Any:
        return self._with(other, lambda a, b: a > b)

    def __ge__(self, other: Any) -> Any:
        return self._with(other, lambda a, b: a >= b)

    def __eq__(self, other: object) -> Any:
        return self._with(other, lambda a, b: a == b)

    def __ne__(self, other: object) -> Any:
        return self._with(other, lambda a, b: a != b)

    def __hash__(self) -> int:
        return hash(self.value)

    def sqrt(self) -> Number | arb:
        p, q = (isqrt(abs(int(part))) for part in (self.value.p, self.value.q))
        root = fmpq(p, q)
        return Number(root) if root * root == self.value else arb(self.value).sqrt()


def _function(name: str) -> Callable[[Number], arb]:
    def of(number: Number) -> arb:
        found: arb = getattr(arb(number.value), name)()
        return found

    return of


for _name in ("exp", "log", "sin", "cos", "tan", "sinh", "cosh", "tanh"):
    setattr(Number, _name, _function(_name))
for _name in ("sin", "cos", "tan", "sinh", "cosh", "tanh"):
    setattr(Number, f"arc{_name}", _function(f"a{_name}"))


def _fraction(value: Any) -> fmpq | None:
    """A number as a fraction; None for what is none, as a float that was rounded."""
    if isinstance(value, Number):
        return value.value
    if isinstance(value, int | fmpq | fmpz):
        return fmpq(value)
    if isinstance(value, float) and (value * 2**20).is_integer():
        return fmpq(*value.as_integer_ratio())
    return None


def exact_value(value: Any) -> fmpq | arb | None:
    """A number as a fraction or a ball; None for what is neither, as a float that was rounded."""
    return value if isinstance(value, arb) else _fraction(value)


def plain(value: Any) -> Any:
    """A fraction or a ball of an entry. Raises Inexact for another number."""
    known = exact_value(value)
    if known is None:
        raise Inexact(f"{value!r} is a rounded number, not an exact one")
    return known
