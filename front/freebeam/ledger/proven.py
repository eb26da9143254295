"""What the ledger has proven for it: critical loads, ranges of damping, eigenvalues, amplitudes, equations.

The front to the derivation and its balls; each is computed once.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from fractions import Fraction
from functools import lru_cache
from typing import TYPE_CHECKING

from freebeam.ledger.scanned import MODES
from freebeam.maps.known import critical_load
from freebeam.proofs import Certified, certified_load, enclosed_load
from freebeam_sym.columns import Column, column

if TYPE_CHECKING:
    from freebeam.ledger.finding import Interval
    from freebeam.paper.compare import Comparison
    from freebeam_derive.certify.ranges import Cell, Line

__all__ = ["amplitude", "cells", "eigenvalues", "equations", "exact", "interval", "line", "none_before", "ritz"]

DIGITS = 20  # proven; fewer are printed


def beam(name: str = "free-free") -> Column:
    """A column by its name."""
    return column(name)


@lru_cache(maxsize=64)
def ritz(alpha: str = "0", beta: str = "0", kappa: str | None = None, name: str = "free-free", **own: str) -> Certified:
    """The certified critical load of the Ritz series at the paper's N = 8."""
    return certified_load(beam(name), MODES, alpha, beta, digits=DIGITS, kappa=kappa, **own)  # type: ignore[arg-type]


@lru_cache(maxsize=64)
def exact(alpha: str = "0", beta: str = "0", kappa: str | None = None, name: str = "free-free") -> Certified:
    """The certified crossing of the beam itself."""
    return enclosed_load(beam(name), alpha, beta, digits=DIGITS, kappa=kappa)


def interval(bounds: tuple[str, str] | None) -> Interval:
    """Bounds as text, as fractions."""
    assert bounds is not None
    return Fraction(bounds[0]), Fraction(bounds[1])


@lru_cache(maxsize=8)
def line(name: str, which: str, held: str = "0") -> Line:
    """A line of damping: "internal" (α) or "external" (β) varies, the other is held."""
    from freebeam_derive.certify.ranges import Line

    return Line(beam(name).kernel, MODES, which, Fraction(held))  # type: ignore[arg-type]


@lru_cache(maxsize=32)
def cells(name: str, which: str, held: str, low: str, high: str, pieces: int) -> tuple[Cell, ...]:
    """Proofs that the first crossing at `low` goes on to `high`, with the sign of its slope, on cells of damping."""
    span = math.log(float(high) / float(low))
    inner = [Fraction(repr(float(low) * math.exp(span * k / pieces))) for k in range(1, pieces)]
    dampings = [Fraction(low), *inner, Fraction(high)]
    near = []
    for damping in dampings:
        alpha, beta = (float(damping), float(held)) if which == "internal" else (float(held), float(damping))
        found = critical_load(beam(name), MODES, alpha, beta)
        assert found.load is not None and found.frequency is not None
        near.append((found.load, found.frequency))
    return tuple(line(name, which, held).cells(dampings, near))


@lru_cache(maxsize=32)
def none_before(name: str, which: str, held: str, low: str, high: str, pieces: int, share: str) -> Fraction:
    """Proof that the column is stable up to the crossings of `cells`, but for a share of the load; that share."""
    return line(name, which, held).none_before(cells(name, which, held, low, high, pieces), Fraction(share))


@lru_cache(maxsize=32)
def eigenvalues(load: str, alpha: str = "0", beta: str = "0") -> tuple[tuple[Interval, Interval], ...]:
    """Real and imaginary part of each of the 16 eigenvalues of A, Eq. (25), enclosed; ascending in |Im λ|."""
    from freebeam_derive.certify.balls import ends
    from freebeam_derive.certify.forced_motion import eigenvalues as found

    values = found(beam().kernel, MODES, Fraction(load), Fraction(alpha), Fraction(beta))
    pairs = [(ends(value.real), ends(value.imag)) for value in values]
    return tuple(sorted(pairs, key=lambda pair: (abs(float(pair[1][0])), float(pair[1][0]))))


class Amplitude:
    """The elastic amplitude at x_s under sin ωt at x_F = 1 for α = 0.001, β = 0.1, as a function of the load."""

    def __init__(self, x_s: str, frequency: str, transposed: bool) -> None:
        from freebeam_derive.certify.forced_motion import amplitude as found

        alpha, beta, w, x_F, x = map(Fraction, ("0.001", "0.1", frequency, "1", x_s))
        self._found = found(beam().kernel, MODES, alpha, beta, w, x_F, x, transposed)

    def at(self, load: str) -> Interval:
        """The amplitude at a load."""
        from freebeam_derive.certify.balls import ends

        return ends(self._found.at(Fraction(load)))

    def ratio(self, high: str, low: str) -> Interval:
        """The quotient of the amplitudes at two loads."""
        a, b = self.at(high), self.at(low)
        return a[0] / b[1], a[1] / b[0]

    def slope_signs(self, low: str, high: str) -> list[tuple[Fraction, Fraction, int]]:
        """Where it rises (+1) and falls (−1) between two loads, 0 on pieces of at most 0.001."""
        return self._found.slope_signs(Fraction(low), Fraction(high), Fraction(1, 1000))


@lru_cache(maxsize=8)
def amplitude(x_s: str = "0.1", frequency: str = "3", transposed: bool = False) -> Amplitude:
    """See `Amplitude`. transposed: with Eq. (11) as printed."""
    return Amplitude(x_s, frequency, transposed)


_compared: list[Comparison] = []


def equations(progress: Callable[[str], None] | None = None) -> Sequence[Comparison]:
    """The 26 equations, printed against derived."""
    if not _compared:
        from freebeam.paper.compare import compare

        _compared.extend(compare(progress))
    return _compared
