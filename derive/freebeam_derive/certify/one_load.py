"""Whether two parts of a column lose stability at exactly one load: two roots of polynomials in P over the fractions.

Where a part loses stability det K is zero, or h and g have a common root x, so that the resultant of h and g by x
vanishes there. A product of two such polynomials, with each factor once, that is monotone on an interval of loads has
one root in it at most: two critical loads that both lie in it are one then.

Where two motions of one part rest at a load, det K and its slope in P vanish, and so does what det(λ² M + λ C + K) has
of the first order in λ: a shaft that turns, as it sees itself, has both of its planes at rest at its critical speed.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import Any

import numpy as np
from flint import arb, arb_mat, arb_poly, fmpq, fmpq_mat, fmpq_poly

from freebeam_derive.certify.balls import exact, precision
from freebeam_derive.certify.parts import Part, Powers

MOST_ROWS = 24  # of a part that flutters: the resultant of 24 is of degree 552 in P, and takes half a minute
MOST_BITS = 20_000


def equal(parts: Sequence[tuple[Part, bool]], limit: bool, low: Fraction, high: Fraction) -> bool:
    """Whether critical loads of parts, all from low to high, are known to be one load. parts: with whether lost by
    flutter. limit: of vanishing damping."""
    product = fmpq_poly([1])
    for part, flutter in parts:
        own = vanishing(part, flutter, limit)
        if own is None or not own.coeffs():
            return False
        product *= own // product.gcd(own)
    slope = (product // product.gcd(product.derivative())).derivative()
    bits = 500
    while bits <= MOST_BITS:
        with precision(bits):
            middle, radius = exact((low + high) / 2), exact((high - low) / 2)
            about = arb_poly(slope)(arb_poly([middle, 1]))
            if not about(radius * arb(0, 1)).contains(0):
                return True
            if about[0] != 0:  # no want of bits, but another root near
                return False
        bits *= 4
    return False


def undecided(parts: Sequence[tuple[Part, bool]], low: Fraction, high: Fraction) -> str:
    """That critical loads of two parts from low to high are not known to be one load, nor to be two, and why."""
    each = [f"{'flutter' if lost else 'divergence'} of {' and '.join(part.names)}" for part, lost in parts]
    digits, why = len(str(int(high / (high - low)))) - 1, obstacle(parts)
    text = f"{' and '.join(each) or 'two crossings'}, at loads near {float(high):.10g} that agree to {digits} digits: "
    text += "whether these are one load, or which is the lower one, is not known" + (f": {why}" if why else "")
    apart = len({part.names for part, _ in parts}) > 1
    return text + ("; they leave each other alone: state a column of each, and prove these one by one" if apart else "")


def obstacle(parts: Sequence[tuple[Part, bool]]) -> str:
    """Why critical loads of parts are not told to be one, in words; empty where nothing is in the way."""
    for part, flutter in parts:
        if flutter and part.beside:
            return "rates stay where damping vanishes, or that acts on displacements"
        every = [X for powers in part.together or (part.M, part.C, part.K) for X in powers]
        if any(isinstance(v, arb) for X in every for v in X.flat):
            return "a factor is no fraction, and no number of digits tells that two loads are one"
        if flutter and len(every[0]) > MOST_ROWS:
            return f"a part that flutters has {len(every[0])} functions, and up to {MOST_ROWS} are feasible; lower N"
    return ""


def vanishing(part: Part, flutter: bool, limit: bool) -> fmpq_poly | None:
    """A polynomial in P that is zero where a part has a flutter, or a divergence; None where there is an obstacle."""
    if obstacle([(part, flutter)]):
        return None
    terms = part.together or (part.M, part.C, part.K)  # of the motions of several roots h and g are products
    M, C, K = ([fmpq_mat(X.tolist()) for X in powers] for powers in terms)
    if not flutter:
        loads = [fmpq(k) for k in range(1, 2 + K[0].nrows() * (len(K) - 1))]
        return _through(fmpq(1), [sum((X * P**a for a, X in enumerate(K)), 0 * K[0]).det() for P in loads])
    h, g = _boundary(M, C, K, limit)
    if len(h) < 2 or not g:
        return None
    count = sum((len(one) - 1) * max(p.degree() for p in other) for one, other in ((h, g), (g, h))) + 1
    values, P = list[fmpq](), fmpq(0)
    while len(values) < count:
        P += 1
        if h[-1](P) == 0 or g[-1](P) == 0:  # the resultant is not that of these degrees
            values = []
        else:
            one, other = (fmpq_poly([p(P) for p in which]) for which in (h, g))
            values.append(one.resultant(other))
    return _through(P - count + 1, values)


def zeros_twice(part: Part) -> list[arb]:
    """Positive loads at which a part is known to have two motions at rest, K v = 0, and so two eigenvalues zero.

    Where K of all motions together is symmetric and falls, a root of det K is as many times one as motions rest there,
    and so it is of each part. Raises Unproven.
    """
    still = None if part.beside else vanishing(part, False, False)
    if still is None or not still.coeffs() or part.turn or not all((X == X.T).all() for X in part.whole):
        return []
    double = still.gcd(still.derivative())
    more = double.gcd(double.derivative())
    double //= more
    double //= double.gcd(more)  # of the order 2 alone
    roots: list[Any] = double.numer().complex_roots() if double.degree() > 0 else []
    loads = [root.real for root, _ in roots if root.imag == 0]

    def at(K: Powers, P: arb) -> arb_mat:
        return arb_mat([[arb(v) for v in row] for row in sum((X * P**a for a, X in enumerate(K)), 0 * K[0]).tolist()])

    slopes = [X * a for a, X in enumerate(part.whole)][1:]
    return [
        P
        for P in loads
        if P > 0 and all(v > 0 for v in at(slopes, P).charpoly()) and all(at(K, P).det() != 0 for K in part.others)
    ]


def _boundary(
    M: list[fmpq_mat], C: list[fmpq_mat], K: list[fmpq_mat], limit: bool
) -> tuple[list[fmpq_poly], list[fmpq_poly]]:
    """h and g of det(K + λ² M + λ C) = h(x) + λ g(x), but for a factor: polynomials in P by powers of x = λ²."""
    n = M[0].nrows()
    loads = [fmpq(k) for k in range(1, 2 + n * (max(map(len, (M, C, K))) - 1))]
    rates = [fmpq(k) for k in range(n + 1 if limit else 2 * n + 1)]
    of_h, of_g = [], []
    for P in loads:
        m, c, k = (sum((X * P**a for a, X in enumerate(of)), 0 * M[0]) for of in (M, C, K))
        if limit:  # of damping ε C the first order in ε
            whole = [_through(fmpq(0), [(k + x * m + e * c).det() for e in rates]) for x in rates]
            h, g = (_through(fmpq(0), [p[order] for p in whole]) for order in (0, 1))
        else:
            p = _through(fmpq(0), [(rate * rate * m + rate * c + k).det() for rate in rates])
            h, g = (fmpq_poly([p[2 * b + odd] for b in range(n + 1)]) for odd in (0, 1))
        of_h.append(h)
        of_g.append(g)
    by_x = [_without_zeros([_through(fmpq(1), [p[b] for p in of]) for b in range(n + 1)]) for of in (of_h, of_g)]
    return by_x[0], by_x[1] or [b * p for b, p in enumerate(by_x[0])][1:]


def _without_zeros(of: list[fmpq_poly]) -> list[fmpq_poly]:
    while of and not of[-1].coeffs():
        of.pop()
    return of


def _through(first: fmpq, values: Sequence[fmpq]) -> fmpq_poly:
    """The polynomial that has these values at a number, that and 1, and so on, by their differences."""
    scale = fmpq(1)
    for value in values:
        scale *= (value * scale).q
    left: Any = np.array([(value * scale).p for value in values], dtype=object)  # whole: no fractions to be reduced
    factors = []
    for k in range(len(values)):
        factors.append(left[0])
        left = left[1:] - left[:-1]
        scale *= max(k, 1)
        factors[-1] = fmpq(factors[-1]) / scale
    found = fmpq_poly([0])
    for k, factor in reversed([*enumerate(factors)]):
        found = found * fmpq_poly([-first - k, 1]) + fmpq_poly([factor])
    return found
