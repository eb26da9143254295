"""The critical loads that the paper prints, against those that the runtime computes.

The paper raised the follower force in steps until a real part turned positive, so that it prints the first step at
or above the Ritz value. A row is confirmed where that rule gives the printed digits, all of them.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from decimal import Decimal
from fractions import Fraction
from typing import NamedTuple

from freebeam.maps.known import critical_load
from freebeam_sym.columns import column

__all__ = ["MODES", "PRINTED", "Printed", "Row", "scanned", "step_of", "validate"]

MODES = 8  # section 3.2: "as many as eight terms of the mode shapes are considered (N=8)"


@dataclass(frozen=True)
class Row:
    """One printed critical load and what the program makes of it; all nondimensional.

    printed: the digits in the paper. explained: the first multiple of `step` at or above the computed load.
    """

    section: str
    alpha: float
    beta: float
    printed: str
    step: str
    modes: int
    load: float | None
    kind: str
    frequency: float | None
    explained: str | None
    passed: bool


class Printed(NamedTuple):
    """Where the paper prints a critical load: section, dampings, the digits as printed."""

    section: str
    alpha: float
    beta: float
    printed: str


PRINTED = (
    Printed("4.1", 0.0, 0.0, "109.8"),
    Printed("4.1", 0.0, 0.0, "109.73"),
    Printed("4.2", 1e-6, 0.0, "88.2"),
    Printed("4.4", 1e-3, 0.1, "90.9"),
)


def step_of(printed: str) -> str:
    """The scan's step: the unit of the last printed digit (section 4.1 says so of its two).

    >>> step_of("109.73")
    '0.01'
    """
    return str(Decimal(1).scaleb(Decimal(printed).as_tuple().exponent))  # type: ignore[arg-type]


def scanned(load: float | Fraction, step: str) -> str:
    """The load at which a scan in steps of `step`, from 0, first reaches or passes `load`; in the step's digits."""
    unit = Fraction(step)
    reached = math.ceil(Fraction(load) / unit) * unit
    return str((Decimal(reached.numerator) / Decimal(reached.denominator)).quantize(Decimal(step)))


def validate(progress: Callable[[str], None] | None = None) -> list[Row]:
    """Compute the critical loads that the paper prints, at its N = 8. Sections 4.1, 4.2, 4.4."""
    beam = column("free-free")
    rows = []
    for section, alpha, beta, printed in PRINTED:
        if progress:
            progress(f"section {section}: {printed}")
        step = step_of(printed)
        found = critical_load(beam, MODES, alpha, beta)
        explained = None if found.load is None else scanned(found.load, step)
        passed = explained == printed and found.kind == "flutter"
        rows.append(
            Row(section, alpha, beta, printed, step, MODES, found.load, found.kind, found.frequency, explained, passed)
        )
    return rows
