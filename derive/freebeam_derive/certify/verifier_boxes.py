"""F(p, s) of the beam itself on a box, for the verifier: its polynomial about the centre, and what is beyond.

Of the verifier of certificates of the beam itself (`verifier_of_beam`); it shares no code with the prover. F is one
function, or one for each value of a parameter: Σ F_l t^l, |t| ≤ 1.
"""

from __future__ import annotations

from math import comb
from typing import Any

import flint
from flint import acb, acb_mat, acb_poly, arb, arb_mat, arb_poly

from freebeam_derive.certify.verifier_shooting import Shooting, Whole

DEGREE = 14


class Box:
    """F and its derivatives on a box of p and s: its polynomial about the centre up to a degree, and what is beyond.

    order: of the derivatives by s, where s is one point. of: the power of t whose factor stands for F; the rest of F is
    with that of t⁰.
    """

    def __init__(self, F: Shooting, p: Any, s: Any, order: int = 2, of: int | None = None) -> None:
        kind: Any = acb if isinstance(p, acb) or isinstance(s, acb) else arb
        self._box = kind(p), kind(s)
        self._centre = kind(p.mid()), kind(s.mid())
        reach = [abs(side - middle).upper() for side, middle in zip(self._box, self._centre, strict=True)]
        sizes = [abs(side).upper() for side in self._centre]
        point = isinstance(s, arb) and s.rad().is_zero()
        sides = [size + 2 * r + 1 for size, r in zip(sizes, reach, strict=True)]
        whole = F.at(sides[0], s, order) if point else F.on(*sides)
        # how far the rest is bounded, from the centre on
        bounds = whole.P - sizes[0], whole.S - abs(self._centre[1] - whole.s).upper()
        if not all(far - 2 * r > 1 / 2 for far, r in zip(bounds, reach, strict=True)):
            raise ArithmeticError("the box is too large")
        # a side without width has any unit, small enough for the terms beyond the degree to be nothing
        self._units = tuple(r.max(arb(2) ** -(flint.ctx.prec // 8)) for r in reach)
        self.whole = whole
        levels = whole.levels if of is None else whole.levels[of : of + 1] or [0 * whole.levels[0]]
        J, K = levels[0].nrows(), levels[0].ncols()
        with flint.ctx.workprec(whole.precision):
            entries = self._about_centre(whole, levels, kind)
        poly: Any = acb_poly if kind is acb else arb_poly
        rows = [[entries[i * K + j] for j in range(min(K, DEGREE + 1 - i))] for i in range(min(J, DEGREE + 1))]
        # derivatives by v over j!, a polynomial in v for each power of u
        self._by_s = [[poly([comb(b, j) * row[b] for b in range(j, len(row))]) for row in rows] for j in range(5)]
        self._beyond = [
            (i, j, abs(entries[i * K + j]).upper()) for i in range(J) for j in range(max(0, DEGREE + 1 - i), K)
        ]
        self._rest = arb(0) if of else whole.rest
        self._room = [(far / unit).lower() for far, unit in zip(bounds, self._units, strict=True)]
        self._left_out = dict[tuple[int, int], arb]()
        self._orders = order if point else 4

    def _about_centre(self, whole: Whole, levels: list[arb_mat], kind: Any) -> list[Any]:
        """Coefficients in units of the box from its centre, row by row, each for all t."""
        middles, sizes = (self._centre[0], self._centre[1] - whole.s), (levels[0].nrows(), levels[0].ncols())
        left, right = (
            _about(middle / scale, unit / scale, n, kind)
            for middle, unit, scale, n in zip(middles, self._units, (whole.P, whole.S), sizes, strict=True)
        )
        left, matrix = left.transpose(), acb_mat if kind is acb else arb_mat
        each = [(left * matrix(C) * right).entries() for C in levels]
        return [sum((f * power(n) for n, f in enumerate(parts[1:], 1)), parts[0]) for parts in zip(*each, strict=True)]

    def _error(self, i: int, j: int) -> arb:
        """What all terms beyond the degree are at most, of a derivative; and the rest, by Cauchy's estimate where it is
        bounded up to r > 1 units: at most Σ C(a, i) rest / r^a = rest r / (r − 1)^(i+1) for p, and so for s."""
        if (i, j) not in self._left_out:
            total = self._of_rest(i, j)
            for a, b, size in self._beyond:
                total += comb(a, i) * comb(b, j) * size
            self._left_out[i, j] = total.upper()
        return self._left_out[i, j]

    def _of_rest(self, i: int, j: int) -> arb:
        by_p, by_s = (r / (r - 1) ** (n + 1) for r, n in zip(self._room, (i, j), strict=True))
        return arb(self._rest * by_p * by_s)

    def rest(self, i: int, j: int) -> arb:
        """What a derivative of all that F is besides its polynomial is at most."""
        return arb(self._of_rest(i, j) / (self._units[0] ** i * self._units[1] ** j))

    def value(self, p: Any, s: Any, i: int = 0, j: int = 0) -> Any:
        """∂^{i+j} F / ∂p^i ∂s^j / (i! j!). Raises ArithmeticError outside of the box, or for an order too high."""
        if j > self._orders:
            raise ArithmeticError("a derivative was asked for of a higher order than the box has")
        if not (self._box[0].contains(p) and self._box[1].contains(s)):
            raise ArithmeticError("a value was asked for outside of its box")
        u, w = ((x - c) / unit for x, c, unit in zip((p, s), self._centre, self._units, strict=True))
        total = 0 * u
        for a in range(len(self._by_s[j]) - 1, i - 1, -1):
            total = total * u + self._by_s[j][a](w) * comb(a, i)
        error = arb(0, self._error(i, j))
        total += acb(error, error) if isinstance(total, acb) else error
        return total / (self._units[0] ** i * self._units[1] ** j)


def power(n: int) -> arb:
    """t^n, |t| ≤ 1."""
    return arb(1) if n == 0 else arb(0, 1) if n % 2 else arb(0.5, 0.5)


def _about(middle: Any, unit: arb, count: int, kind: Any) -> Any:
    """Rows by the powers of x, columns by those of u, of x = middle + unit u."""
    line: Any = (acb_poly if kind is acb else arb_poly)([middle, unit])
    row, flat = line**0, list[Any]()
    for j in range(count):
        flat += row.coeffs() + [0] * (count - 1 - j)
        row *= line
    return (acb_mat if kind is acb else arb_mat)(count, count, flat)
