"""What the verifier knows of two loads that are one: both are roots of a polynomial that has but one root near.

A part of M, C and K is lost where det K = 0, or where h and g have a common root x. Both are found here as polynomials
in P and x over the fractions, of determinants at whole P and λ; their resultant by x vanishes at each such load. So it
does of the motions of all roots of a polynomial together, whose determinant is the product of theirs.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from itertools import pairwise
from typing import Any

import flint
from flint import arb, arb_mat, arb_poly, fmpq, fmpq_mat, fmpq_poly

from freebeam_derive.certify.verifier_claims import ball, require

Terms = list[list[fmpq_mat]]  # M, C and K, each by powers of the load
MOST_ROWS, MOST_BITS = 24, 20_000


def check_one_load(parts: list[tuple[Terms, bool]], limit: bool, loads: arb) -> None:
    """Loads in an interval at which each of two parts is lost, by flutter (true) or by divergence, are one load. limit:
    of vanishing damping. Raises Refused."""
    each = [_lost(terms, flutter, limit) for terms, flutter in parts]
    require(all(p.coeffs() for p in each), "two loads are not known to be one: a frequency is double at every load")
    both = each[0] * each[1]
    once = both // both.gcd(both.derivative())
    bits = flint.ctx.prec
    while bits <= MOST_BITS:
        with flint.ctx.workprec(bits):
            middle = arb(loads.mid())
            slope = arb_poly(once.derivative())(arb_poly([middle, 1]))
            if slope(loads - middle) != 0:
                return
        bits *= 2
    require(False, "two loads are not known to be one: they are narrowed down too little, or differ")


def check_pair_at_rest(terms: Terms, whole: Sequence[fmpq_mat], low: Fraction, high: Fraction) -> arb:
    """The one load from low to high at which K takes two motions to nothing, and det K has a double root. Raises
    Refused.

    whole: K of all motions, of which these are a part that is left to itself. Where it is symmetric and its slope in P
    is negative definite, each of its eigenvalues passes zero at a speed: a root of det K, and of that of each part, is
    as many times one as there are motions that K takes to nothing. Of n rows of rank n − 2 all cofactors are zero: the
    slope of det K, and what det(λ² M + λ C + K) has of the first order in λ.
    """
    require(all(X == X.transpose() for X in whole), "K is not symmetric, and one motion alone may rest")
    still = _lost(terms, False, False)
    twice = still.gcd(still.derivative())
    thrice = twice.gcd(twice.derivative())
    once = twice // thrice
    once //= once.gcd(thrice)
    roots: list[Any] = once.numer().complex_roots() if once.degree() > 0 else []
    loads: list[arb] = [root.real for root, _ in roots if root.imag == 0 and ball(low) < root.real < ball(high)]
    require(len(loads) == 1, "two motions are not known to rest at one load")
    slope = sum((arb_mat(X) * (a * loads[0] ** (a - 1)) for a, X in enumerate(whole) if a), 0 * arb_mat(whole[0]))
    require(all(v > 0 for v in slope.charpoly()), "K may not fall with the load, and one motion alone may rest")
    return loads[0]


def _lost(terms: Terms, flutter: bool, limit: bool) -> fmpq_poly:
    """A polynomial in P that is zero where a part is lost."""
    rows = terms[2][0].nrows()
    if not flutter:
        loads = range(rows * (len(terms[2]) - 1) + 1)
        K = (sum((X * fmpq(P) ** k for k, X in enumerate(terms[2])), 0 * terms[2][0]) for P in loads)
        return fmpq_poly([v[0] for v in _solved(loads, fmpq_mat([[X.det()] for X in K])).tolist()])
    require(rows <= MOST_ROWS, f"of more than {MOST_ROWS} functions two loads of flutter are not known to be one")
    h, g = ([fmpq_poly([X[a, b] for a in range(X.nrows())]) for b in range(X.ncols())] for X in _both(terms, limit))
    g = g if any(p.coeffs() for p in g) else [b * p for b, p in enumerate(h)][1:]
    for of in (h, g):
        while of and not of[-1].coeffs():
            of.pop()
    require(bool(h and g), "two loads are not known to be one: the determinant is nothing")
    degree = sum((len(a) - 1) * max(p.degree() for p in b) for a, b in ((h, g), (g, h)))
    first = 1  # where degrees in x are less, a resultant is not that polynomial's value
    while any(of[-1](fmpq(first + k)) == 0 for of in (h, g) for k in range(degree + 1)):
        first += 1
    both = (tuple(fmpq_poly([p(fmpq(first + k)) for p in of]) for of in (h, g)) for k in range(degree + 1))
    return _through_values(first, [one.resultant(other) for one, other in both])


def _through_values(first: int, values: list[fmpq]) -> fmpq_poly:
    """The polynomial with these values at a, a + 1, …: Σ Δ^k f(a) (P − a) … (P − a − k + 1) / k!, by Newton."""
    found, product, factorial = fmpq_poly([0]), fmpq_poly([1]), 1
    for k in range(len(values)):
        found += product * (values[0] / factorial)
        product *= fmpq_poly([-first - k, 1])
        factorial *= k + 1
        values = [b - a for a, b in pairwise(values)]
    return found


def _both(terms: Terms, limit: bool) -> tuple[fmpq_mat, fmpq_mat]:
    """h and g of det(K − x M + iωC) = h + iωg, in rows by powers of P, in columns of x."""
    n = terms[2][0].nrows()
    loads = range(n * (max(map(len, terms)) - 1) + 1)
    across = range(n + 1 if limit else 2 * n + 1)
    of_h, of_g = [], []
    for P in loads:
        M, C, K = (sum((X * fmpq(P) ** k for k, X in enumerate(of)), 0 * terms[2][0]) for of in terms)
        if limit:  # columns: of x; rows: of the damping's size, to first order
            values = [[(K - x * M + size * C).det() for x in across] for size in across]
            first = _solved(across, fmpq_mat(values))
            of_x = _solved(across, fmpq_mat([[first[k, x] for k in (0, 1)] for x in across]))
            of_h.append([of_x[b, 0] for b in across])
            of_g.append([of_x[b, 1] for b in across])
        else:
            p = _solved(across, fmpq_mat([[(rate * rate * M + rate * C + K).det()] for rate in across]))
            of_h.append([(-1) ** b * p[2 * b, 0] for b in range(n + 1)])
            of_g.append([(-1) ** b * p[2 * b + 1, 0] for b in range(n)] + [fmpq(0)])
    return _solved(loads, fmpq_mat(of_h)), _solved(loads, fmpq_mat(of_g))


def _solved(places: range, values: fmpq_mat) -> fmpq_mat:
    """Coefficients of the polynomials that have some values, a column each."""
    return fmpq_mat([[fmpq(x) ** k for k in range(len(places))] for x in places]).solve(values)
