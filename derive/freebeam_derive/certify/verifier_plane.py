"""Where h and g have no common root, for whole intervals of loads: cells in the plane of P and x.

On a cell each of the two is a number, two slopes and a rest in a ball, by Taylor's theorem about its middle. Where h,
g, or a sum of the two by a row of the inverse of their Jacobian, is not zero on it, no root of both is there. Other
cells are cut in half. The two sums vanish together near a root alone, at whatever angle the curves h = 0 and g = 0 meet
there, so that few cells are needed even next to an interval of loads that holds a crossing.
"""

from __future__ import annotations

from functools import cached_property

from flint import arb, arb_poly

from freebeam_derive.certify.verifier_claims import Refused

Rows = list[arb_poly]  # over the powers of x, polynomials in P
EVEN = 16  # how far the ratio of what is not known in P and in x counts; 4 and 256 need as many cells
MOST_CELLS = 100_000  # 100 to 3,000 are usual between two crossings of 15 digits, up to 8 functions


def check_apart(h: Rows, g: Rows, low: arb, high: arb, finest: int) -> None:
    """h and g have no common root x ≥ 0 at any load from low to high, by cells of a size of 2^−finest or more. Raises
    Refused."""
    least = arb(2) ** -finest
    # from 0 to 1, and from 1 on in 1/x
    waiting = [(_Slab([which[::side] for which in (h, g)], low, high), arb(0), arb(1)) for side in (1, -1)]
    for _ in range(MOST_CELLS):
        if not waiting:
            return
        slab, a, b = waiting.pop()
        apart, by_load = slab.apart(a, b)
        if apart:
            continue
        middle = arb(((a + b) / 2).mid())
        wide = a < middle < b and slab.low < slab.middle < slab.high
        if not wide or b - a < least * b or b < least or slab.high - slab.low < least * slab.high:
            break  # a root, or about so
        if by_load:
            waiting += [(half, a, b) for half in slab.halves]
        else:
            waiting += [(slab, a, middle), (slab, middle, b)]
    raise Refused("another crossing may lie between those that are listed")


class _Slab:
    """Two functions over an interval of loads: polynomials in x at its middle, their slopes by P there, and a rest."""

    def __init__(self, functions: list[Rows], low: arb, high: arb) -> None:
        self.functions, self.low, self.high = functions, low, high
        self.middle = arb(((low + high) / 2).mid())
        self.width = low.union(high) - self.middle
        self.terms = [self._terms(which) for which in functions]

    def _terms(self, which: Rows) -> tuple[arb_poly, arb_poly, arb_poly]:
        rows = [p(arb_poly([self.middle, 1])) for p in which]
        rest = [_from(p, 2)(self.width) for p in rows]
        return arb_poly([p[0] for p in rows]), arb_poly([p[1] for p in rows]), arb_poly(rest)

    @cached_property
    def halves(self) -> tuple[_Slab, _Slab]:
        return _Slab(self.functions, self.low, self.middle), _Slab(self.functions, self.middle, self.high)

    def apart(self, low: arb, high: arb) -> tuple[bool, bool]:
        """Whether the two have no common root with x from low to high; and whether more of what is not known of them
        comes from the loads than from x."""
        middle = arb(((low + high) / 2).mid())
        across, shift = low.union(high) - middle, arb_poly([middle, 1])
        values, by_x, by_P, ratio = [], [], [], arb(1)
        for still, slope, rest in self.terms:
            at_middle, along = still(shift), slope(shift)
            bent = _from(at_middle, 2)(across) * across * across
            far = (_from(along, 1)(across) * across + rest(shift)(across) * self.width) * self.width
            values.append(at_middle[0] + bent + far)
            by_x.append(at_middle[1])
            by_P.append(along[0])
            of_x, of_P = (at_middle[1] * across + bent).rad(), (along[0] * self.width + far).rad()
            least = (of_P + of_x) / EVEN
            ratio *= (of_P + least) / (of_x + least)
        sums = [(arb(1), arb(0)), (arb(0), arb(1)), (by_x[1], -by_x[0]), (by_P[1], -by_P[0])]
        for pair in sums:
            value, of_across, of_width = (
                pair[0] * each[0] + pair[1] * each[1] for each in (values, by_x, by_P)
            )  # fmt: skip
            if value + of_across * across + of_width * self.width != 0:
                return True, False
        return False, bool(ratio * 2 > 1)


def _from(p: arb_poly, order: int) -> arb_poly:
    """A polynomial without its lowest factors, divided by the power that is left."""
    return arb_poly([p[k] for k in range(order, p.degree() + 1)])
