"""Krawczyk's test: a box of balls is proven to hold one zero of a system of equations, and only one.

With x in the box, F(x), its derivatives J over the whole box and any matrix Y (here the inverse of J's midpoint),

    K = x − Y F(x) + (1 − Y J) (box − x)

holds every zero that the box holds; that K lies in the box's interior proves that there is one and that it is alone.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

from flint import arb, arb_mat

from freebeam_derive.certify.balls import Unproven, ball


class System(Protocol):
    """n equations in n unknowns."""

    def value(self, x: Sequence[arb]) -> list[arb]:
        """The equations at a point or on a box."""

    def slopes(self, x: Sequence[arb]) -> arb_mat:
        """The matrix of their derivatives there."""


def inverse(J: arb_mat) -> arb_mat:
    """Raises Unproven where a matrix of derivatives is not known to be regular."""
    try:
        return J.inv()
    except ZeroDivisionError:
        raise Unproven("the crossing is not known to be simple") from None


def image(x: Sequence[arb], value: Sequence[arb], slopes: arb_mat, box: Sequence[arb]) -> list[arb]:
    """K of a box: value of the equations at the point x in it, slopes on all of it."""
    n = len(x)
    Y = inverse(slopes.mid())
    rest = arb_mat(n, n, [int(i == j) for i in range(n) for j in range(n)]) - Y * slopes
    away = arb_mat([[side - middle] for side, middle in zip(box, x, strict=True)])
    step = rest * away - Y * arb_mat([[v] for v in value])
    return [middle + step[i, 0] for i, middle in enumerate(x)]


def inside(box: Sequence[arb], found: list[arb]) -> list[arb]:
    """The image of a box, where that proves a zero. Raises Unproven where it does not: there may be none, or more."""
    if not all(side.contains_interior(part) for side, part in zip(box, found, strict=True)):
        raise Unproven("a small box about it is not proven to hold one zero and only one")
    return found


def newton(system: System, x: Sequence[arb]) -> list[arb]:
    """One step of Newton's method from the middles. Raises Unproven."""
    x = [side.mid() for side in x]
    step = inverse(system.slopes(x)) * arb_mat([[v] for v in system.value(x)])
    return [middle - step[i, 0] for i, middle in enumerate(x)]


def enclose(system: System, x: Sequence[arb], bits: int) -> list[arb]:
    """Balls about a zero of which an approximation of so many bits is known, alone in them. Raises Unproven."""
    x = [side.mid() for side in x]
    value, moved = system.value(x), newton(system, x)
    for slack in range(4, bits // 2, 12):
        box = [
            ball(m, 2 * abs(m - n).upper() + abs(m).upper() * arb(2) ** (slack - bits))
            for m, n in zip(x, moved, strict=True)
        ]
        try:
            return inside(box, image(x, value, system.slopes(box), box))
        except Unproven:
            continue
    raise Unproven("no box around the candidate could be shown to hold a crossing")


def one_to_one(slopes: arb_mat) -> bool:
    """Whether no two points of a box have equal values: of two that had, d apart, d = (1 − Y J) d for any Y, and no d
    but 0 has |d| ≤ R |d| where R ≥ |1 − Y J| has its eigenvalues below 1, which all leading minors of 1 − R > 0 say."""
    n = slopes.nrows()
    try:
        rest = inverse(slopes.mid()) * slopes
    except Unproven:
        return False
    Z = [[int(i == j) - abs(int(i == j) - rest[i, j]).upper() for j in range(n)] for i in range(n)]
    return all(arb_mat([row[:k] for row in Z[:k]]).det() > 0 for k in range(1, n + 1))


def contracts(at_centre: arb_mat, over_box: arb_mat, radii: Sequence[arb]) -> bool:
    """Whether 1 − J(centre)⁻¹ J is a contraction on a box in units of its radii; then it is one to one too."""
    try:
        rest = inverse(at_centre) * over_box
    except Unproven:
        return False
    n = len(radii)
    sums = (sum((abs(rest[i, j] - int(i == j)) * radii[j] for j in range(n)), arb(0)) for i in range(n))
    return all(total < radius for total, radius in zip(sums, radii, strict=True))
