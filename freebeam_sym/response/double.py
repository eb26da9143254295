"""Matrices of twice the digits, and complex numbers of more: what powers of a step need so as not to drift.

An entry is an unevaluated sum of two floats. A product of such matrices is a sum of products of slices, each of so few
bits that a float product of matrices is exact (Ozaki's scheme). Complex numbers are pairs of whole numbers over 2^BITS.
"""

from __future__ import annotations

import math
from fractions import Fraction
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Fixed = tuple[int, int]

SLICES = 4
BITS = 128
ONE = 1 << BITS
UNIT = 2.0**-BITS


class Double(NamedTuple):
    """The sum of two arrays of floats, the second below the rounding of the first."""

    high: Array
    low: Array

    def block(self, *key: slice) -> Double:
        return Double(self.high[key], self.low[key])


def two_sum(a: Array, b: Array) -> Double:
    """a + b exactly."""
    total = a + b
    part = total - a
    return Double(total, (a - (total - part)) + (b - part))


def two_product(a: Array, b: Array) -> Double:
    """a b exactly, barring overflow and underflow."""
    product = a * b
    (a_1, a_2), (b_1, b_2) = _halves(a), _halves(b)
    return Double(product, ((a_1 * b_1 - product) + a_1 * b_2 + a_2 * b_1) + a_2 * b_2)


def _halves(a: Array) -> tuple[Array, Array]:
    scaled = 134217729.0 * a  # 2^27 + 1
    high = scaled - (scaled - a)
    return high, a - high


def add(x: Double, y: Double) -> Double:
    high, low = two_sum(x.high, y.high)
    return two_sum(high, low + (x.low + y.low))


def multiply(x: Double, b: Array) -> Double:
    """x b, entry by entry, for floats b."""
    product = two_product(x.high, b)
    return two_sum(product.high, product.low + x.low * b)


def times(factor: Fraction, x: Double) -> Double:
    """An exact factor times a matrix, to 2⁻¹⁰⁰ or so."""
    high = float(factor)
    product = multiply(x, np.asarray(high))
    return two_sum(product.high, product.low + float(factor - Fraction(high)) * x.high)


def matmul(x: Double, y: Double) -> Double:
    """x @ y, an entry to 2⁻⁹⁰ or so of the largest in its row of x times the largest in its column of y."""
    rows, inner = x.high.shape
    bits = (55 - (inner - 1).bit_length()) // 2
    left, right = _slices(x, bits, 1), _slices(y, bits, 0)
    products = np.concatenate(left) @ np.concatenate(right, axis=1)
    p = products.reshape(SLICES, rows, SLICES, -1).swapaxes(1, 2)
    second, error = two_sum(p[0, 1], p[1, 0])
    tail = p[0, 2] + p[1, 1] + p[2, 0] + (p[0, 3] + p[1, 2] + p[2, 1] + p[3, 0])
    high, low = two_sum(p[0, 0], second)
    return two_sum(high, low + (error + tail))


def _slices(x: Double, bits: int, axis: int) -> list[Array]:
    """x as a sum of arrays of `bits` bits each, with respect to the largest entry along an axis."""
    high, low = x
    exponent = np.frexp(np.abs(high).max(axis=axis, keepdims=True))[1]
    found = []
    for k in range(SLICES):
        rounder = np.ldexp(1.5, 53 - bits + exponent - k * bits)  # adding it rounds at its last place
        found.append((high + rounder) - rounder)
        high, low = two_sum(high - found[-1], low)
    return found


def solve(a: Double, b: Double, guess: Array) -> Double:
    """x with a x = b, from a guess of some digits. Rounding is left to 2⁻⁸⁰ or so where a is well conditioned."""
    inverse = np.linalg.inv(a.high)
    x = Double(guess, np.zeros_like(guess))
    size = np.abs(guess).max()
    for _ in range(8):
        residual = add(b, Double(*(-part for part in matmul(a, x))))
        correction = inverse @ residual.high
        x = add(x, Double(correction, np.zeros_like(correction)))
        if not np.abs(correction).max() > 1e-19 * size:  # the next one is smaller by ten digits
            break
    return x


def expm(x: Double) -> Double:
    """The exponential of a matrix: Taylor's polynomial of degree 12 where it is below 2⁻⁹⁷, and squares of that.

    A square doubles what rounding has left: 2⁻⁹⁰ ‖x‖ or so in all where no power of the result grows.
    """
    halvings = max(0, math.frexp(float(np.abs(x.high).sum(axis=1).max()))[1] + 5)  # to a norm below 2⁻⁵
    part, one = Double(*(np.ldexp(matrix, -halvings) for matrix in x)), np.eye(len(x.high))
    unit = Double(one, np.zeros_like(one))
    total = unit
    for k in range(12, 0, -1):
        total = add(unit, times(Fraction(1, k), matmul(part, total)))
    for _ in range(halvings):
        total = matmul(total, total)
    return total


# Complex numbers as pairs of whole numbers over 2^BITS


def fixed(value: float) -> int:
    numerator, denominator = value.as_integer_ratio()
    return (numerator << BITS) // denominator


@lru_cache(maxsize=64)
def exponential(z: Fixed) -> Fixed:
    """e^z of a complex z."""
    a, b = z
    halvings = max(0, max(abs(a), abs(b)).bit_length() - BITS) + 8
    a, b = a >> halvings, b >> halvings
    total, term, k = (ONE, 0), (ONE, 0), 0
    while max(abs(term[0]), abs(term[1])) > 1:  # Taylor's series of the halved one
        k += 1
        term = ((term[0] * a - term[1] * b >> BITS) // k, (term[0] * b + term[1] * a >> BITS) // k)
        total = (total[0] + term[0], total[1] + term[1])
    for _ in range(halvings):
        total = square(total)
    return total


def square(z: Fixed) -> Fixed:
    """z², or z where that is far beyond floats."""
    a, b = z
    if max(a.bit_length(), b.bit_length()) > BITS + 1100:
        return z
    return (a + b) * (a - b) >> BITS, a * b >> (BITS - 1)


def rounded(z: Fixed) -> complex:
    """z as a complex float; infinite beyond the range of floats."""
    try:
        return complex(float(z[0]) * UNIT, float(z[1]) * UNIT)
    except OverflowError:
        return complex(math.inf, math.inf)
