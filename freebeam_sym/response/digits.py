"""Numbers of more digits than floats have: a power that is made by squaring floats drifts with the number of steps.

A `Double` is the sum of two arrays of floats. A product of such matrices is a sum of products of slices, each of so few
bits that a float product of matrices is exact (Ozaki's scheme). A `Fixed` is a complex number: two whole numbers over
2^BITS, which is quicker for the few eigenvalues of a step.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache
from types import SimpleNamespace
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]
Fixed = tuple[int, int]

SLICES = 4
BITS = 128
ONE = 1 << BITS


@dataclass(frozen=True, eq=False)
class Double:
    """The sum of two arrays of floats, the second below the rounding of the first: some 32 digits.

    It stands in a kernel for an array: sums and products by NumPy's rules, `solve` by its namespace.
    """

    high: Array
    low: Array

    __array_ufunc__ = None  # with an array on the left, too, the operators below are taken

    @classmethod
    def of(cls, value: Any) -> Double:
        """Of floats, exactly; of a fraction, to the digits there are."""
        high = np.asarray(value, dtype=float)
        low = float(value - Fraction(float(high))) if isinstance(value, Fraction) else 0.0
        return cls(high, np.full_like(high, low))

    def __array_namespace__(self, api_version: str | None = None) -> Any:
        return SimpleNamespace(linalg=SimpleNamespace(solve=solve))

    def __getitem__(self, key: Any) -> Double:
        return Double(self.high[key], self.low[key])

    def __neg__(self) -> Double:
        return Double(-self.high, -self.low)

    def __add__(self, other: Any) -> Double:
        y = _lifted(other)
        high, low = _two_sum(self.high, y.high)
        return Double(*_two_sum(high, low + (self.low + y.low)))

    __radd__ = __add__

    def __sub__(self, other: Any) -> Double:
        return self + -_lifted(other)

    def __rsub__(self, other: Any) -> Double:
        return _lifted(other) + -self

    def __mul__(self, other: Any) -> Double:
        y = _lifted(other)
        product = self.high * y.high
        (a, b), (c, d) = _halves(self.high), _halves(y.high)
        error = ((a * c - product) + a * d + b * c) + b * d
        return Double(*_two_sum(product, error + (self.low * y.high + self.high * y.low)))

    __rmul__ = __mul__

    def __pow__(self, exponent: int) -> Double:
        return math.prod([self] * (exponent - 1), start=self)

    def __matmul__(self, other: Any) -> Double:
        """An entry to 2⁻⁹⁰ or so of the largest in its row on the left times the largest in its column on the right."""
        y = _lifted(other)
        rows, inner = self.high.shape
        bits = (55 - (inner - 1).bit_length()) // 2
        products = np.concatenate(_slices(self, bits, 1)) @ np.concatenate(_slices(y, bits, 0), axis=1)
        p = products.reshape(SLICES, rows, SLICES, -1).swapaxes(1, 2)
        second, error = _two_sum(p[0, 1], p[1, 0])
        tail = p[0, 2] + p[1, 1] + p[2, 0] + (p[0, 3] + p[1, 2] + p[2, 1] + p[3, 0])
        high, low = _two_sum(p[0, 0], second)
        return Double(*_two_sum(high, low + (error + tail)))

    def squared(self) -> Double:
        return self @ self


def _lifted(value: Any) -> Double:
    return value if isinstance(value, Double) else Double.of(value)


def stacked(*parts: Double, axis: int = 0) -> Double:
    """Parts one below another, or one beside another along axis 1."""
    return Double(np.concatenate([x.high for x in parts], axis), np.concatenate([x.low for x in parts], axis))


def _two_sum(a: Array, b: Array) -> tuple[Array, Array]:
    """a + b exactly."""
    total = a + b
    part = total - a
    return total, (a - (total - part)) + (b - part)


def _halves(a: Array) -> tuple[Array, Array]:
    scaled = 134217729.0 * a  # 2^27 + 1
    high = scaled - (scaled - a)
    return high, a - high


def _slices(x: Double, bits: int, axis: int) -> list[Array]:
    """x as a sum of arrays of `bits` bits each, with respect to the largest entry along an axis."""
    high, low = x.high, x.low
    exponent = np.frexp(np.abs(high).max(axis=axis, keepdims=True))[1]
    found = []
    for k in range(SLICES):
        rounder = np.ldexp(1.5, 53 - bits + exponent - k * bits)  # adding it rounds at its last place
        found.append((high + rounder) - rounder)
        high, low = _two_sum(high - found[-1], low)
    return found


def solve(a: Double, b: Double) -> Double:
    """x with a x = b, to 2⁻⁸⁰ or so where a is well conditioned: by residuals in more digits."""
    inverse = np.linalg.inv(a.high)
    x = Double.of(inverse @ b.high)
    size = np.abs(x.high).max()
    for _ in range(8):
        correction = inverse @ (b - a @ x).high
        x = x + correction
        if not np.abs(correction).max() > 1e-19 * size:  # the next one is smaller by ten digits
            break
    return x


def expm(x: Double) -> Double:
    """The exponential of a matrix: Taylor's polynomial of degree 12 where it is below 2⁻⁹⁷, and squares of that.

    A square doubles what rounding has left: 2⁻⁹⁰ ‖x‖ or so in all where no power of the result grows.
    """
    halvings = max(0, math.frexp(float(np.abs(x.high).sum(axis=1).max()))[1] + 5)  # to a norm below 2⁻⁵
    part, unit = x * 0.5**halvings, np.eye(len(x.high))
    total = Double.of(unit)
    for k in range(12, 0, -1):
        total = (part @ total) * Double.of(Fraction(1, k)) + unit
    for _ in range(halvings):
        total = total.squared()
    return total


# Complex numbers as pairs of whole numbers over 2^BITS


def fixed(value: float) -> int:
    return math.floor(Fraction(value) * ONE)


@lru_cache(maxsize=64)
def exponential(z: Fixed) -> Fixed:
    """e^z of a complex z."""
    halvings = max(0, max(map(abs, z)).bit_length() - BITS) + 8
    (a, b), (x, y) = (part >> halvings for part in z), (ONE, 0)
    for k in range(14, 0, -1):  # Taylor's polynomial of the halved one, below 2^-8
        x, y = ONE + (x * a - y * b >> BITS) // k, (x * b + y * a >> BITS) // k
    for _ in range(halvings):
        x, y = square((x, y))
    return x, y


def square(z: Fixed) -> Fixed:
    """z², or z where that is far beyond floats."""
    a, b = z
    if max(a.bit_length(), b.bit_length()) > BITS + 1100:
        return z
    return (a + b) * (a - b) >> BITS, a * b >> (BITS - 1)


def rounded(z: Fixed) -> complex:
    """z as a complex float; infinite beyond the range of floats."""
    try:
        return complex(z[0] / ONE, z[1] / ONE)
    except OverflowError:
        return complex(math.inf, math.inf)


@dataclass(frozen=True)
class Roots:
    """Complex numbers that multiply coordinates: the diagonal of a matrix."""

    numbers: list[Fixed]

    def squared(self) -> Roots:
        return Roots([square(z) for z in self.numbers])

    @property
    def high(self) -> Complex:
        return np.array([rounded(z) for z in self.numbers])
