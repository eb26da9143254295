"""Rational numbers as text, exact and of any length: Python itself turns no integer beyond 4,300 digits into text."""

from __future__ import annotations

import math
import re
from fractions import Fraction

from flint import fmpz

LONGEST = 100_000  # characters of one number: 10,000 digits as a quotient take some 30,000
NUMBER = re.compile(r"([+-]?)([0-9]*)\.?([0-9]*)(?:[eE]([+-]?[0-9]{1,5}))?(?:/(0*[1-9][0-9]*))?", re.ASCII)


def read(text: str) -> Fraction:
    """A decimal such as 1e-3, or a quotient such as 1/3, exactly. Raises ValueError for anything else."""
    found = NUMBER.fullmatch(text) if len(text) <= LONGEST else None
    if not found or not found[2] + found[3]:
        raise ValueError(f"{text[:40]!r} is no decimal and no quotient, or too long")
    sign, whole, part, power, under = found.groups()
    value = Fraction(int(fmpz(whole + part)), int(fmpz(under or "1")) * 10 ** len(part))
    return (-value if sign == "-" else value) * Fraction(10) ** int(power or 0)


def written(value: Fraction | int) -> str:
    """An integer or a quotient, exactly."""
    value = Fraction(value)
    under = "" if value.denominator == 1 else f"/{fmpz(value.denominator)}"
    return f"{fmpz(value.numerator)}{under}"


def said(value: Fraction) -> str:
    """A number for print: a decimal where it is a short one, else a quotient."""
    for places in range(20):
        if (value * 10**places).denominator == 1:
            return _decimal(int(value * 10**places), places)
    return written(value)


def outward(low: Fraction, high: Fraction, digits: int) -> tuple[str, str]:
    """Decimals of so many significant digits, rounded down and up."""
    size = max(abs(low), abs(high))
    if size == 0:
        return "0", "0"
    places = digits - 1 - _exponent(size)
    unit = Fraction(10) ** places
    return _decimal(math.floor(low * unit), places), _decimal(math.ceil(high * unit), places)


def shown(low: Fraction, high: Fraction) -> tuple[str, str]:
    """The ends of an interval as decimals that tell them apart, rounded down and up."""
    width = (high - low) / (max(abs(low), abs(high)) or 1)
    return outward(low, high, 4 - _exponent(width) if width else 20)


def roots(low: Fraction, high: Fraction) -> tuple[Fraction, Fraction]:
    """An interval that holds the square roots of a positive one, and is not much wider; of 0 it is 0 alone, of another
    point as narrow as 38 digits tell."""
    if high == 0 == low:
        return low, high
    bits = 64 + (int(high / (high - low)).bit_length() if high > low else 64) + max(0, int(1 / low).bit_length())
    below, above = (math.isqrt(v.numerator * 4**bits // v.denominator) for v in (low, high))
    return Fraction(below, 2**bits), Fraction(above + 1, 2**bits)


def _decimal(scaled: int, places: int) -> str:
    if places <= 0:
        return written(scaled * 10**-places)
    text = written(abs(scaled)).rjust(places + 1, "0")
    return f"{'-' if scaled < 0 else ''}{text[:-places]}.{text[-places:]}"


def _exponent(value: Fraction) -> int:
    """About floor(log10(value)), for any size of the value; at most one too low or high."""
    return math.floor((value.numerator.bit_length() - value.denominator.bit_length()) * math.log10(2))
