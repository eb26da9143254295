"""Polynomials in the load P and in x = ω², in balls: values, lines, Taylor's form, and signs by Bernstein's."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from fractions import Fraction
from functools import cached_property
from itertools import zip_longest
from math import comb
from typing import Any

import numpy as np
from flint import acb, acb_poly, arb, arb_mat, arb_poly

from freebeam_derive.certify.balls import exact


class Bivariate:
    """Σ P^a p_a(x). rows: the polynomials p_a in x, over the powers of P."""

    def __init__(self, rows: Sequence[arb_poly]) -> None:
        self.rows = list(rows)

    def __call__(self, P: arb, x: arb) -> arb:
        """The value at a point or over a box."""
        total = arb(0)
        for p in reversed(self.rows):
            total = total * P + p(x)
        return total

    def at(self, P: arb) -> arb_poly:
        """A polynomial in x at one load."""
        total = arb_poly([0])
        for p in reversed(self.rows):
            total = total * P + p
        return total

    def along(self, origin: arb, point: arb, slope: arb) -> arb_poly:
        """A polynomial in t on the line P = origin + t, x = point + slope t."""
        t, x = arb_poly([origin, 1]), arb_poly([point, slope])
        if slope == 0:
            return arb_poly([p(point) for p in self.rows])(t)
        total = arb_poly([0])
        for p in reversed(self.rows):
            total = total * t + p(x)
        return total

    @cached_property
    def by_P(self) -> Bivariate:
        """∂/∂P."""
        return Bivariate([a * p for a, p in enumerate(self.rows)][1:])

    @cached_property
    def by_x(self) -> Bivariate:
        """∂/∂x."""
        return Bivariate([p.derivative() for p in self.rows])

    def about(self, P: arb, x: arb) -> Bivariate:
        """The same in P and x counted from a point, so that over a small box about it little is lost."""
        rows = [p(arb_poly([x, 1])) for p in self.rows]
        for low in range(len(rows) - 1):
            for k in range(len(rows) - 2, low - 1, -1):
                rows[k] += P * rows[k + 1]
        return Bivariate(rows)

    def combined(self, factor: arb, other: Bivariate, share: arb) -> Bivariate:
        """factor times this and share times another."""
        pairs = zip_longest(self.rows, other.rows, fillvalue=arb_poly())
        return Bivariate([factor * p + share * q for p, q in pairs])

    @property
    def table(self) -> arb_mat:
        """Coefficients, by powers of P in rows and of x in columns."""
        width = 1 + max(p.degree() for p in self.rows)
        return arb_mat([[p[b] for b in range(width)] for p in self.rows])


# --- signs ----------------------------------------------------------------------------------------------------


def sign(ball: arb) -> int:
    """+1 or −1, 0 where it is not known."""
    return 1 if ball > 0 else -1 if ball < 0 else 0


def one_sign(balls: Sequence[arb]) -> int:
    """The sign that all have, 0 where they do not, or one is not known."""
    first = sign(balls[0])
    return first if first and all(sign(v) == first for v in balls) else 0


def bernstein(a: Fraction, b: Fraction, n: int) -> arb_mat:
    """Matrix from the coefficients of a polynomial of degree n to its Bernstein coefficients on a ≤ t ≤ b.

    The i-th of t^j is the mean of the products of j out of n − i numbers a and i numbers b.
    """
    left, right = arb_poly([1, exact(a)]), arb_poly([1, exact(b)])
    lefts, rights = [arb_poly([1])], [arb_poly([1])]
    for _ in range(n):
        lefts.append(lefts[-1] * left)
        rights.append(rights[-1] * right)
    rows = [lefts[n - i] * rights[i] for i in range(n + 1)]
    return arb_mat([[row[j] / comb(n, j) for j in range(n + 1)] for row in rows])


def signs_on(polynomials: Iterable[arb_poly], a: Fraction, b: Fraction) -> Iterator[int]:
    """Of each polynomial, when it is asked for: +1 or −1 where its Bernstein coefficients prove that sign for all
    a ≤ t ≤ b, else 0."""
    matrices: dict[int, arb_mat] = {}  # by the degree, which most of them share
    for p in polynomials:
        n = max(0, p.degree())
        if n not in matrices:
            matrices[n] = bernstein(a, b, n)
        yield one_sign((matrices[n] * arb_mat([[p[k]] for k in range(n + 1)])).entries())


def keeps_sign(rows: Sequence[arb_poly], low: Fraction, high: Fraction | None, n: int) -> bool:
    """Whether a function keeps its sign for low ≤ x ≤ high, or for x ≥ low > 0 where high is None.

    rows: polynomials in x of degree n at most, one for each Bernstein coefficient in the load. Their own Bernstein
    coefficients are, but for positive factors, the coefficients of (1 + t)ⁿ p((low + high t) / (1 + t)).
    """
    first = 0
    start, width = (exact(low), exact(high - low)) if high is not None else (arb(0), exact(1 / low))
    for p in rows:
        if high is None:  # in 1/x, from the highest power on
            p = _reversed(p, n)
        turned = _reversed(p(arb_poly([start, width])), n)(arb_poly([1, 1]))
        signs = {sign(turned[k]) for k in range(n + 1)}
        if len(signs) != 1 or 0 in signs or first * signs.pop() < 0:
            return False
        first = first or sign(turned[0])
    return True


def _reversed(p: arb_poly, n: int) -> arb_poly:
    return arb_poly([p[n - k] for k in range(n + 1)])


# --- where to look: approximations, and no more ---------------------------------------------------------------


CLOSE = 1e-6  # points between zeros need no more


def zeros(polynomial: arb_poly) -> list[acb]:
    """Approximations of all zeros, to CLOSE of their sizes."""
    degree = polynomial.degree()
    if degree < 1:
        return []
    try:
        found: Any = acb_poly(polynomial).roots()
        # isolated is all that these are: of two that are far apart one may be off by nearly as much
        if any(z.real.rad() > CLOSE * abs(z.mid()) for z in found):
            sizes = [abs(c) for c in polynomial.coeffs() if not c.contains(0)]
            least = sizes[0] / sum(sizes, arb(0))  # which no zero but 0 is below
            found = acb_poly(polynomial).roots(tol=max(CLOSE * float(least), 1e-300))
        return list(found)
    except (ValueError, ArithmeticError):
        # double zeros, or about so: floats will do
        coefficients = [float(polynomial[k].mid()) for k in range(degree, -1, -1)]
        found = np.roots(coefficients) if np.isfinite(coefficients).all() else []
        return [acb(z.real, 0 if abs(z.imag) < 1e-9 * abs(z) else z.imag) for z in map(complex, found)]


def real_zeros(polynomial: arb_poly) -> list[arb]:
    """Approximations of the real zeros, ascending."""
    return sorted((z.real.mid() for z in zeros(polynomial) if z.imag.contains(0)), key=float)
