"""That F(P, s) of the beam itself has no zeros on a rectangle but those that are known. Eqs. (6), (14), (15).

The zeros are those of an `Onset` problem of `beam_itself`: F = F_s = 0, F = 0 at λ = iω, or the limit of that. The
rectangle, of loads and of s or ω, is cut into cells. On one, a series (`local_series`) stands for F; a smaller part is
excluded by the values there, by the mean value form or by Krawczyk's image, or holds one known zero at most because the
equations are one to one there. docs/theorem.md has the proofs.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from copy import copy
from fractions import Fraction
from itertools import pairwise
from typing import Any

import flint
from flint import arb

from freebeam_derive.certify.balls import Exact, Unproven, ends, exact, precision
from freebeam_derive.certify.beam_itself import Damped, Itself, Onset, VanishingRates
from freebeam_derive.certify.exact_system import ExactSystem
from freebeam_derive.certify.krawczyk import image, one_to_one
from freebeam_derive.certify.local_series import DEGREE_OF_ANY, FINER, Local

MOST_CELLS = 60  # that one series serves, before it is cut into four; of 40 to 400 it matters little
MOST_CELLS_OF_ANY = 400  # the same where F comes from Taylor steps, whose series cost as much as a hundred cells
MOST_CELLS_OVER_DAMPINGS = 100  # the same over a range of a damping: 15 s, and 22 s with 400
MOST_CUTS = 7
BITS_OF_SERIES = 64  # tried first: Beck's column with damping takes half as long as with 128, and no cell more
MOST_SERIES = 2000  # of a proof: some minutes; 400 were the most that one took
MOST_SERIES_OF_ANY = 60  # the same where each takes a second or two; of four columns with damping one took 30

Say = Callable[[str], None]
Side = tuple[Fraction, Fraction]  # of a cell: loads, or values of the second unknown, from one to the other
Seek = Callable[[list[arb]], list[arb]]


class OpenStep(Unproven):
    """A step of a proof of the beam itself that failed; the message names it."""


class Cells:
    """For loads from 0 to a given one. rigid: the number R of rigid motions, which put a factor s^R into F.

    known: boxes, each with one zero alone in it. seek: encloses a zero that is not known yet near a place, or raises
    Unproven; what it finds is added to the known.
    """

    def __init__(self, beam: Itself, rigid: int, load: arb, known: list[list[arb]], seek: Seek | None = None) -> None:
        self.beam, self.rigid, self.load = beam, rigid, load
        self.known, self._seek = known, seek
        self._checked = self._series = 0  # cells, and series that stand for F on them
        self._covered = Fraction(0)  # the area of those cells
        self._over_dampings = isinstance(beam, ExactSystem) and beam.by_damping is not None

    def no_other_zero(self, problem: Onset, top: arb, say: Say = lambda _: None) -> int:
        """That there is no zero but the known for 0 ≤ P ≤ P* (and beyond, to the end of its ball) and 0 ≤ x ≤ top,
        x the problem's second unknown. How many cells it took. Raises OpenStep."""
        loads, highest = (Fraction(0), ends(self.load)[1]), ends(top)[1]
        power = 2 if isinstance(problem, Damped) else 4  # x is of the size of γ² or γ⁴
        steps = max(1, math.ceil(float(top) ** (1 / power)))
        edges = [highest * Fraction(k, steps) ** power for k in range(steps + 1)]
        self._checked = self._series = 0
        self._covered = Fraction(0)
        for k, band in enumerate(pairwise(edges)):
            for P in _halves(loads):
                say(f"cells, {k} of {steps} bands, {len(self.known)} crossings")
                self._tile(problem, P, band, 0)
        if self._covered != loads[1] * highest:  # each cell is half of one, so that none lies on another
            raise OpenStep("cells: they do not cover all loads and frequencies")
        return self._checked

    def _tile(self, problem: Onset, P: Side, x: Side, depth: int) -> None:
        """The same for a part, on which one series stands for F; it is cut where that is too coarse."""
        of_any = isinstance(self.beam, ExactSystem)
        tries: Sequence[tuple[int | None, int | None]] = ((None, BITS_OF_SERIES), (None, None))
        if of_any:  # where a range of a damping is too wide, a finer series does not help
            tries = ((DEGREE_OF_ANY, None), (FINER, None))[: 1 if self._over_dampings else 2]
        if not any(self._with_one_series(problem, P, x, *given) for given in tries):
            cuts = 2 * MOST_CUTS if self._over_dampings else MOST_CUTS
            if depth == cuts or self._series > (MOST_SERIES_OF_ANY if of_any else MOST_SERIES):
                name = "ω" if isinstance(problem, Damped) else "ω²"
                raise OpenStep(
                    "cells: that there is no other crossing is not known near the load "
                    f"{float(_over(P)):.6g} and {name} = {float(_over(x)):.6g}"
                )
            parts, others = [*_halves(P)], [*_halves(x)]
            if self._over_dampings:  # in turn: x alone is enough in most bands
                parts, others = (parts, [x]) if depth % 2 else ([P], others)
            for part in parts:
                for other in others:
                    self._tile(problem, part, other, depth + 1)

    def _with_one_series(self, problem: Onset, P: Side, x: Side, degree: int | None, bits: int | None = None) -> bool:
        """bits: of the series alone, which is a ball whatever they are; the precision in hand where None."""
        around = [side.mid() + (side - side.mid()) * (1 + arb(2) ** -10) for side in (_over(P), _over(x))]
        for known in self._near([_over(P), _over(x)]):  # the equations are looked at on a cell and on it together
            around = [side.union(part) for side, part in zip(around, known, strict=True)]
        local, self._series = copy(problem), self._series + 1
        try:
            rates = isinstance(problem, VanishingRates)
            with precision(bits or flint.ctx.prec):
                local.beam = Local(self.beam, *problem.place(around), rates, degree)  # type: ignore[assignment]
        except Unproven:
            return False
        waiting, count, covered = [(P, x)], 0, Fraction(0)
        of_any = MOST_CELLS_OVER_DAMPINGS if self._over_dampings else MOST_CELLS_OF_ANY
        most = of_any if isinstance(self.beam, ExactSystem) else MOST_CELLS
        while waiting:
            P, x = waiting.pop()
            count += 1
            axis = self._excluded(local, _over(P), _over(x))
            if axis is None:
                covered += (P[1] - P[0]) * (x[1] - x[0])
                continue
            if count > most:
                return False
            for half in _halves(P if axis == 0 else x):
                waiting.append((half, x) if axis == 0 else (P, half))
        self._checked += count
        self._covered += covered
        return True

    def _excluded(self, problem: Onset, P: arb, x: arb) -> int | None:
        """None where a cell holds no zero but a known one, else along which axis to cut it."""
        at_bottom = not x.lower() > 0
        if at_bottom and self.rigid:
            return self._excluded_at_bottom(problem, P, x)
        box = [P, x]
        middle = [side.mid() for side in box]
        values, J, _ = problem.slopes(box)
        if any(not v.contains(0) for v in values):
            return None
        centre = problem.value(middle)
        parts = [[J[i, j] * (box[j] - middle[j]) for j in range(2)] for i in range(2)]
        if any(not (centre[i] + parts[i][0] + parts[i][1]).contains(0) for i in range(2)):
            return None
        if at_bottom and isinstance(problem, Damped) and not J[1, 1].contains(0):
            return None  # the imaginary part is zero at ω = 0 alone, where F(P, 0) is looked at
        try:
            near = self._near(box)
            if not near:
                led_to = image(middle, centre, J, box)
                if any(not side.overlaps(part) for side, part in zip(box, led_to, strict=True)):
                    return None
                near = self._near(led_to) or self._sought(box, led_to)
            if len(near) == 1:
                hull = [side.union(c) for side, c in zip(box, near[0], strict=True)]
                if one_to_one(problem.slopes(hull)[1]):
                    return None
        except Unproven:
            pass
        sizes = [sum(_ratio(parts[i][j], centre[i]) for i in range(2)) for j in range(2)]
        return 0 if sizes[0] >= sizes[1] else 1

    def _near(self, box: list[arb]) -> list[list[arb]]:
        """The known zeros that a cell may hold."""
        return [c for c in self.known if all(side.overlaps(part) for side, part in zip(box, c, strict=True))]

    def _sought(self, box: list[arb], led_to: list[arb]) -> list[list[arb]]:
        """One more zero, where Krawczyk's image of a cell says that it may hold one alone."""
        place = [part.mid() for part in led_to]
        small = all(part.rad() < side.rad() for side, part in zip(box, led_to, strict=True))
        if self._seek is None or not small or not all(s.contains(v) for s, v in zip(box, place, strict=True)):
            return []
        found = self._seek(place)
        if not self._near(found):
            self.known.append(found)
        return self._near(found)

    def _excluded_at_bottom(self, problem: Onset, P: arb, x: arb) -> int | None:
        """Of a column with R rigid motions: the same of F / s^R from s = 0 on.

        Its Taylor coefficients lie in the hull of those of F, R orders higher, on the segment from 0 to s.
        """
        reduced = copy(problem)
        reduced.beam = _Reduced(problem.beam, self.rigid)  # type: ignore[assignment]
        values, J, _ = reduced.slopes([P, x])
        middle = P.mid()
        at_middle = reduced.value([middle, x])
        if any(
            not (value.contains(0) and (centre + slope * (P - middle)).contains(0))
            for value, centre, slope in zip(values, at_middle, (J[0, 0], J[1, 0]), strict=True)
        ):
            return None
        if isinstance(problem, Damped) and not J[1, 1].contains(0):
            return None  # as above
        return 0 if P.rad() > self.load / 64 else 1


class _Reduced:
    """F / s^R of a beam in place of F, R the number of its rigid motions."""

    def __init__(self, beam: Any, rigid: int) -> None:
        self.beam, self.rigid = beam, rigid

    def damping(self, alpha: Exact, beta: Exact) -> tuple[arb, arb]:
        found: tuple[arb, arb] = self.beam.damping(alpha, beta)
        return found

    def pencil(self, *given: Any) -> Any:
        return self.beam.pencil(*given)

    def taylor(self, p: Any, s: Any, orders: Sequence[tuple[int, int]]) -> Any:
        """As `Beam.taylor`."""
        higher = tuple((i, j + self.rigid) for i, j in orders)
        t = self.beam.taylor(p, s.union(s * 0), tuple((i, j) for i, top in higher for j in range(top + 1)))
        return {order: t[more] for order, more in zip(orders, higher, strict=True)}


def _ratio(part: arb, whole: arb) -> float:
    return float(abs(part).upper()) / (float(abs(whole).upper()) + 1e-300)


def _over(side: Side) -> arb:
    return exact(side[0]).union(exact(side[1]))


def _halves(side: Side) -> tuple[Side, Side]:
    middle = (side[0] + side[1]) / 2
    return (side[0], middle), (middle, side[1])
