"""That nothing reaches the boundary on a rectangle but the crossings of a certificate, for the verifier: cells.

Of the verifier of certificates of the beam itself (`verifier_of_beam`); it shares no code with the prover. Cells are
cut in half in fractions, and their areas are added up: none is left out.
"""

from __future__ import annotations

from fractions import Fraction
from itertools import pairwise
from typing import Any

from flint import arb

from freebeam_derive.certify.verifier_claims import ball, require
from freebeam_derive.certify.verifier_equations import Equations, Interval, krawczyk, one_to_one, over

MOST_CELLS, MOST_CUTS, MOST_BOXES = 60, 7, 3000


class Cells:
    """crossings: boxes of the two unknowns, each with one crossing of each value of the range in it, alone."""

    def __init__(self, equations: Equations, load: Fraction, crossings: list[list[arb]]) -> None:
        self.equations, self.load, self.crossings = equations, load, crossings
        self.boxes, self.covered = 0, Fraction(0)

    def check(self, top: Fraction) -> None:
        """No crossing but those for 0 ≤ P ≤ load and 0 ≤ x ≤ top."""
        power = 4 if self.equations.real else 2  # x is of the size of γ⁴ or γ²
        count = max(1, int(float(top) ** (1 / power)) + 1)
        edges = [top * Fraction(k, count) ** power for k in range(count + 1)]
        for band in pairwise(edges):
            for P in _halves((Fraction(0), self.load)):
                self.tile(P, band, 0)
        require(self.covered == self.load * top, "the cells do not cover all loads and frequencies")

    def tile(self, P: Interval, x: Interval, cuts: int) -> None:
        """The same on a part, on which one box serves, or its quarters."""
        self.boxes += 1
        require(self.boxes <= MOST_BOXES, "it would take too long to exclude other crossings")
        if self._with_one_box(P, x):
            self.covered += (P[1] - P[0]) * (x[1] - x[0])
            return
        require(cuts < MOST_CUTS, f"another crossing could be near the load {float(over(P)):.6g}")
        for half in _halves(P):
            for other in _halves(x):
                self.tile(half, other, cuts + 1)

    def _with_one_box(self, P: Interval, x: Interval) -> bool:
        around = [over(P), over(x)]
        near = self._near(around)
        for crossing in near:
            around = [side.union(part) for side, part in zip(around, crossing, strict=True)]
        try:
            box = self.equations.box(*self.equations.place(*(side + (side - side.mid()) / 1024 for side in around)))
        except ArithmeticError:
            return False
        waiting, left = [(P, x)], (P[1] - P[0]) * (x[1] - x[0])
        for _ in range(MOST_CELLS):
            P, x = waiting.pop()
            axis = self.excluded(box, over(P), over(x), near)
            if axis is None:
                left -= (P[1] - P[0]) * (x[1] - x[0])
                if not waiting:
                    return left == 0
            else:
                waiting += [(half, x) if axis == 0 else (P, half) for half in _halves(P if axis == 0 else x)]
        return False

    def _near(self, X: list[arb]) -> list[list[arb]]:
        """Crossings in a part, or no farther from it than half its width: over a range the equations are blurred."""
        wider = [side + (side - side.mid()) for side in X]
        return [c for c in self.crossings if all(side.overlaps(part) for side, part in zip(wider, c, strict=True))]

    def excluded(self, box: Any, P: arb, x: arb, near: list[list[arb]]) -> int | None:
        """None where a cell holds no zero but a crossing that is known, else along which axis it is cut.

        near: the crossings on whose hull with a cell the box serves.
        """
        equations, X = self.equations, [P, x]
        bottom = not x.lower() > 0
        reduced = bottom and equations.R > 0
        values, J = equations.system(equations.reduced(P, x) if reduced else box.value, P, x)
        if any(not y.contains(0) for y in values):
            return None
        # the imaginary part is zero at ω = 0 alone, where F(P, 0) is looked at
        if bottom and not equations.real and not J[1][1].contains(0):
            return None
        if reduced:
            return 0 if P.rad() > ball(self.load) / 64 else 1
        middle = [side.mid() for side in X]
        at = equations.centre(box.value, *middle)
        parts = [[J[i][j] * (X[j] - middle[j]) for j in (0, 1)] for i in (0, 1)]
        if any(not (at[i] + parts[i][0] + parts[i][1]).contains(0) for i in (0, 1)):
            return None
        if self._known_alone(box, X, near) or self._led_out(X, middle, at, J):
            return None
        size = [
            sum(float(abs(parts[i][j]).upper()) / (float(abs(at[i]).upper()) + 1e-300) for i in (0, 1)) for j in (0, 1)
        ]
        return 0 if size[0] >= size[1] else 1

    def _known_alone(self, box: Any, X: list[arb], near: list[list[arb]]) -> bool:
        """Whether a cell and a crossing together hold no two points with equal values, so that it is the only zero."""
        near = self._near(X) or near
        if len(near) != 1:
            return False
        hull = [side.union(c) for side, c in zip(X, near[0], strict=True)]
        return one_to_one(self.equations.system(box.value, *hull)[1])

    def _led_out(self, X: list[arb], middle: list[arb], at: list[arb], J: list[list[arb]]) -> bool:
        """Whether Krawczyk's image of a cell, which holds its zeros, does not meet it."""
        image = krawczyk(X, middle, [(at, arb(1))], J)
        return image is not None and any(not side.overlaps(part) for side, part in zip(X, image, strict=True))


def _halves(side: Interval) -> tuple[Interval, Interval]:
    middle = (side[0] + side[1]) / 2
    return (side[0], middle), (middle, side[1])
