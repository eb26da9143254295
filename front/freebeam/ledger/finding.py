"""What a check of a claim finds, and how numbers are printed so that every machine prints the same."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from decimal import ROUND_CEILING, ROUND_FLOOR, Context, Decimal
from fractions import Fraction

__all__ = ["CHECKS", "Finding", "Interval", "check", "enclosure", "number"]

Interval = tuple[Fraction, Fraction]

# How a claim was settled, from the strongest to the weakest.
IDENTITY = "identity"  # of symbols
PROVEN = "proven"  # in balls, at the values named
RANGE = "proven over the range"  # in balls, for every value of it
MAP = "map"  # in floats, at many points
FLOATS = "computed"  # in floats, at the values named


@dataclass(frozen=True)
class Finding:
    """holds: whether the claim is true as it is quoted. computed: the numbers, as text. by: how it was settled.
    rule: what maps the computed number to the printed digits, empty where there are none."""

    holds: bool
    computed: str
    by: str
    rule: str = ""


CHECKS: dict[str, Callable[..., Finding]] = {}


def check(function: Callable[..., Finding]) -> Callable[..., Finding]:
    """Make a check known by its name, for the quotes to name it."""
    CHECKS[function.__name__] = function
    return function


def enclosure(interval: Interval, digits: int = 12) -> str:
    """[low, high], rounded outwards to so many significant digits.

    >>> enclosure((Fraction("109.7217602376"), Fraction("109.7217602377")), 6)
    '[109.721, 109.722]'
    """
    low, high = interval
    bounds = (_rounded(low, digits, ROUND_FLOOR), _rounded(high, digits, ROUND_CEILING))
    return bounds[0] if bounds[0] == bounds[1] else f"[{bounds[0]}, {bounds[1]}]"


def _rounded(value: Fraction, digits: int, rounding: str) -> str:
    context = Context(prec=digits, rounding=rounding)
    found = context.divide(Decimal(value.numerator), Decimal(value.denominator))
    if not found:
        return "0"
    return f"{found.quantize(Decimal(1).scaleb(found.adjusted() - digits + 1), rounding):f}"


def number(value: float, digits: int = 5) -> str:
    """A float to so many significant digits, far fewer than it has.

    >>> number(1.2835639)
    '1.2836'
    """
    return f"{value:.{digits}g}"
