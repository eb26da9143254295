"""Up to which |λ| a list of eigenvalues of the beam itself lacks none: they are counted by the argument principle.

On the disc |λ| ≤ r, with 1 + c_E λ ≠ 0 there, f(λ) = F(p(λ), s(λ)) is analytic, so that it has as many zeros in it as
its argument grows by 2π along the circle. f(λ̄) is the conjugate of f(λ): half of the circle is enough. It is cut into
arcs, on each of which all values of f are shown to be in one half-plane. docs/theorem.md has the statement.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import NamedTuple

from flint import acb, arb

from freebeam_derive.certify.balls import Exact, Unproven, exact, precision
from freebeam_derive.certify.beam import Beam
from freebeam_derive.certify.local_series import Local

ARCS = 16  # that it is cut into first, each with a series of its own
FINEST = 4  # parts of an arc that one series serves; of 4 to 64 the fastest for the free-free column
MOST_SERIES = 100  # of all circles together: some 15 s
TRIED = 4  # circles, before nothing is said
BEYOND = 1.02  # the first radius over the largest |λ| that is known
APART = 1e-4  # least relative distance of two |λ| between which a circle is laid


def counted_to(beam: Beam, load: Exact, alpha: Exact, beta: Exact, known: Sequence[acb]) -> tuple[arb | None, str]:
    """A radius with no eigenvalue λ of the beam itself inside that is not among the known; else why there is none.

    known: as `beam_stability.complete_to` has them.
    """
    largest = max((float(abs(value).upper()) for value in known), default=0.0)
    # a power series of F at s loses some 1.5 bits for each unit of |s|^(1/4), and s is of the size of λ² or λ/α
    with precision(128 + round(8 * largest**0.5)):
        circle, failure = _Circle(beam, load, alpha, beta), "none is known"
        for radius in circle.radii(known):
            try:
                count, inside = circle.zeros(radius), circle.inside(known, radius)
            except Unproven as error:
                failure = str(error)
                continue
            if inside == count:
                return radius, ""
            failure = f"of {count} with |λ| below {float(radius):.6g} only {inside} are known"
    return None, failure


class _Series(NamedTuple):
    """A series that stands for F on an arc of 1/arcs of half a circle."""

    local: Local
    arcs: int


class _Circle:
    """Zeros of f in discs about 0."""

    def __init__(self, beam: Beam, load: Exact, alpha: Exact, beta: Exact) -> None:
        self.beam, self.load, self.given = beam, exact(load), (alpha, beta)
        self.rigid = int(beam.kernel.COLUMN["rigid"])
        self.c_E, self.c_M = beam.damping(alpha, beta)
        self._made = 0  # series

    def radii(self, known: Sequence[acb]) -> Iterator[arb]:
        """What to try: beyond the largest that is known, then between two of different size, downwards."""
        sizes = sorted({float(abs(value).mid()) for value in known})
        between = [(a * b) ** 0.5 for a, b in pairwise(sizes) if b > a * (1 + APART)]
        wanted = [BEYOND * sizes[-1], *reversed(between)] if sizes else []
        reach = float("inf") if self.c_E.is_zero() else 1 / float(abs(self.c_E).upper())
        fitting = [arb(r) for r in wanted if r < 0.99 * reach]
        yield from fitting[:TRIED]

    def inside(self, known: Sequence[acb], radius: arb) -> int | None:
        """How many zeros in the disc are known, with those of rigid motions; None where one is on the circle."""
        count = self.rigid
        if self.rigid:
            if not (abs(self.c_M) < radius or abs(self.c_M) > radius):
                return None
            count += self.rigid * bool(abs(self.c_M) < radius)  # s^R with s = −λ (λ + c_M) / (1 + c_E λ)
        for value in known:
            if self.rigid and (value * (value + self.c_M)).contains(0):
                continue
            size = abs(value)
            if not (size < radius or size > radius):
                return None
            count += bool(size < radius)
        return count

    def zeros(self, radius: arb) -> int:
        """The number of zeros of f with |λ| < radius. Raises Unproven."""
        if not abs(self.c_E) * radius < 1:
            raise Unproven("the eigenvalues accumulate at −1/α, within that circle")
        total = arb(0)
        waiting: list[tuple[int, int, _Series | None]] = [(k, ARCS, None) for k in reversed(range(ARCS))]
        while waiting:
            k, n, series = waiting.pop()
            low, high = arb(k) / n, arb(k + 1) / n
            if series is None or n > FINEST * series.arcs:
                self._made += 1
                if self._made > MOST_SERIES:
                    raise Unproven(f"the eigenvalues with |λ| below {float(radius):.6g} could not be counted")
                series = self._series(radius, low, high, n)
            turned = None if series is None else self._turned(series, radius, low, high)
            if turned is None:
                waiting += [(2 * k + 1, 2 * n, series), (2 * k, 2 * n, series)]
            else:
                total += turned
        turns = total / arb.pi()
        found = turns.unique_fmpz()
        if found is None:
            raise Unproven(f"the eigenvalues with |λ| below {float(radius):.6g} could not be counted")
        return int(found)

    def _series(self, radius: arb, low: arb, high: arb, arcs: int) -> _Series | None:
        """What stands for F on an arc, from `low` to `high` times π; None where it is too long for one."""
        try:
            p, s, *_ = self.beam.pencil(self.load, _on(radius, low.union(high)), *self.given)
            return _Series(Local(self.beam, acb(p), acb(s)), arcs)
        except Unproven:
            return None

    def _turned(self, series: _Series, radius: arb, low: arb, high: arb) -> arb | None:
        """By how much the argument grows on an arc; None where its values are not seen to be in one half-plane."""
        middle = ((low + high) / 2).mid()
        at, over = _on(radius, middle), _on(radius, low.union(high))
        centre, (_, slope) = self._value(series, at)[0], self._value(series, over)
        if not centre.is_finite() or centre.contains(0) or not (1 + slope * (over - at) / centre).real > 0:
            return None
        ends = [(self._value(series, _on(radius, side))[0] / centre).arg() for side in (low, high)]
        return ends[1] - ends[0]

    def _value(self, series: _Series, value: acb) -> tuple[acb, acb]:
        """f and f'."""
        p, s, p_slope, s_slope, _ = self.beam.pencil(self.load, value, *self.given)
        t = series.local.taylor(acb(p), acb(s), ((0, 0), (1, 0), (0, 1)))
        return acb(t[0, 0]), acb(t[1, 0] * p_slope + t[0, 1] * s_slope)


def _on(radius: arb, turn: arb) -> acb:
    """radius e^(iπ turn); the two real ones exactly."""
    return radius * acb(turn.cos_pi(), turn.sin_pi())
