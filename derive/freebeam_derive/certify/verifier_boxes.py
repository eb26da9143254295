"""F(p, s) of the beam itself on a box, for the verifier: its polynomial about the centre, and what is beyond.

Of the verifier of certificates of the beam itself (`verifier_of_beam`); it shares no code with the prover. F is one
function (`Shooting`), or one for each value of a parameter in which it is linear (`Between`).
"""

from __future__ import annotations

from fractions import Fraction
from math import comb
from typing import Any

import flint
from flint import acb, acb_mat, acb_poly, arb, arb_mat, arb_poly

from freebeam_derive.certify.verifier_claims import ball, require
from freebeam_derive.certify.verifier_shooting import Shooting, Whole

DEGREE = 14


class Between:
    """F for each value of a parameter in which it is linear: from a share of the way between two functions to another.

    Linear it is where all conditions but one are the same, for it is their determinant. Raises Refused.
    """

    def __init__(self, one: Shooting, other: Shooting, shares: tuple[Fraction, Fraction]) -> None:
        differ = sum(a != b for a, b in zip(one.conditions, other.conditions, strict=True))
        require(one.terms == other.terms and differ <= 1, "the parameter stands elsewhere than in one condition")
        self.one, self.other, self.shares = one, other, shares

    @property
    def ends(self) -> list[Between]:
        """F at either end."""
        return [Between(self.one, self.other, (share, share)) for share in self.shares]

    def hull(self, each: list[list[Any]]) -> list[Any]:
        """What holds a number of every F, for it lies between those at the ends."""
        at_ends = [[(1 - t) * x + t * y for x, y in zip(*each, strict=True)] for t in map(ball, self.shares)]
        return [x.union(y) for x, y in zip(*at_ends, strict=True)]


Function = Shooting | Between


class Box:
    """F and its derivatives on a box of p and s: its polynomial about the centre up to a degree, and what is beyond.

    order: of the derivatives by s, where s is one point.
    """

    def __init__(self, F: Function, p: Any, s: Any, order: int = 2) -> None:
        kind: Any = acb if isinstance(p, acb) or isinstance(s, acb) else arb
        self._box = kind(p), kind(s)
        self._centre = kind(p.mid()), kind(s.mid())
        reach = [abs(side - middle).upper() for side, middle in zip(self._box, self._centre, strict=True)]
        sizes = [abs(side).upper() for side in self._centre]
        point = isinstance(s, arb) and s.rad().is_zero()
        functions = [F] if isinstance(F, Shooting) else [F.one, F.other]
        if point:
            wholes = [f.at(sizes[0] + 2 * reach[0] + 1, s, order) for f in functions]
        else:
            sides = [size + 2 * r + 1 for size, r in zip(sizes, reach, strict=True)]
            wholes = [f.on(*sides) for f in functions]
        whole = wholes[0]
        room = [whole.P - sizes[0] - 2 * reach[0], whole.S if point else whole.S - sizes[1] - 2 * reach[1]]
        if not all(left > 1 / 2 for left in room):
            raise ArithmeticError("the box is too large")
        # a side without width has any unit, small enough for the terms beyond the degree to be nothing
        self._units = tuple(r.max(arb(2) ** -(flint.ctx.prec // 8)) for r in reach)
        J, K = (max(size(w.C) for w in wholes) for size in (arb_mat.nrows, arb_mat.ncols))
        with flint.ctx.workprec(whole.precision):
            each = [self._about_centre(w, J, K, kind) for w in wholes]
            entries = each[0] if isinstance(F, Shooting) else F.hull(each)
        poly: Any = acb_poly if kind is acb else arb_poly
        rows = [[entries[i * K + j] for j in range(min(K, DEGREE + 1 - i))] for i in range(min(J, DEGREE + 1))]
        # derivatives by v over j!, a polynomial in v for each power of u
        self._by_s = [[poly([comb(b, j) * row[b] for b in range(j, len(row))]) for row in rows] for j in range(5)]
        self._beyond = [
            (i, j, abs(entries[i * K + j]).upper()) for i in range(J) for j in range(max(0, DEGREE + 1 - i), K)
        ]
        self._rest = max((w.rest for w in wholes), key=float)
        self._left_out = dict[tuple[int, int], arb]()
        self._orders = order if point else 4

    def _about_centre(self, whole: Whole, J: int, K: int, kind: Any) -> list[Any]:
        """Coefficients in units of the box from its centre, row by row."""
        middles = self._centre[0], self._centre[1] - whole.s
        left, right = (
            _about(middle / scale, unit / scale, n, kind)
            for middle, unit, scale, n in zip(middles, self._units, (whole.P, whole.S), (J, K), strict=True)
        )
        C, rows, columns = whole.C, whole.C.nrows(), whole.C.ncols()
        if (rows, columns) != (J, K):
            known = [[C[i, j] if i < rows and j < columns else arb(0) for j in range(K)] for i in range(J)]
            C = arb_mat(known)
        found: list[Any] = (left.transpose() * (acb_mat(C) if kind is acb else C) * right).entries()
        return found

    def _error(self, i: int, j: int) -> arb:
        """What all terms beyond the degree are at most, of a derivative; and the rest, by Cauchy's estimate from twice
        the units: at most Σ C(a, i) C(b, j) rest / 2^(a+b) = 4 rest."""
        if (i, j) not in self._left_out:
            total = 4 * self._rest
            for a, b, size in self._beyond:
                total += comb(a, i) * comb(b, j) * size
            self._left_out[i, j] = total.upper()
        return self._left_out[i, j]

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


def _about(middle: Any, unit: arb, count: int, kind: Any) -> Any:
    """Rows by the powers of x, columns by those of u, of x = middle + unit u."""
    powers, units = [kind(1)], [arb(1)]
    for _ in range(count - 1):
        powers.append(powers[-1] * middle)
        units.append(units[-1] * unit)
    flat = [comb(j, a) * powers[j - a] * units[a] if a <= j else 0 for j in range(count) for a in range(count)]
    return (acb_mat if kind is acb else arb_mat)(count, count, flat)
