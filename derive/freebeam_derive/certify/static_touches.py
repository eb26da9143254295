"""Loads at which the static equation has a solution and stability is yet not lost, exactly. Eqs. (6), (15).

For a beam with y'''' + P y'' = 0 at rest the conditions at its ends on 1, x, cos kx, sin kx, k² = P, have a
determinant in closed form. Where it is c kⁿ (1 + cos k) or c kⁿ (1 − cos k), all zeros of F(P, 0) are double, and it
passes zero nowhere: balls could never tell. So it is in the cantilever whose tip force follows half of the slope, at
P = π², 9π² and so on.
"""

from __future__ import annotations

from inspect import signature

from flint import arb

from freebeam_derive.certify.balls import exact
from freebeam_derive.certify.beam import Beam


def touches(beam: Beam, load: arb) -> list[int] | None:
    """All n with F((nπ)², 0) = 0 up to a load, each a double zero in P, where these are all zeros of F(P, 0) for P > 0.

    None where that is not known: the beam is of another kind, or F(P, 0) passes zero.
    """
    sign = _sign(beam)
    if sign == 0:
        return None
    first = 1 if sign > 0 else 2  # 1 + cos k = 0, or 1 − cos k = 0
    found = []
    while not (place := exact(first) * arb.pi()) * place > load:
        found.append(first)
        first += 2
    return found


def _sign(beam: Beam) -> int:
    """1 or −1 for a determinant c kⁿ (1 ± cos k); 0 where it is another."""
    import sympy as sp

    if beam.rigid:
        return 0
    k, c, s = sp.symbols("k c s", positive=True)
    own = {name: sp.Rational(value.numerator, value.denominator) for name, value in beam.own.items()}
    if "one" in signature(beam.kernel.equation).parameters:
        own["one"] = sp.Integer(1)
    try:
        equation, conditions = beam.kernel.equation(k**2, 0, 0, **own), beam.kernel.end_conditions(k**2, 0, 0, **own)
    except (AttributeError, TypeError):  # a root or another function of a number, which NumPy takes of no symbol
        return 0
    still = {p: row for (p, r), row in equation.items() if r == 0}
    if any(sp.simplify(v) != 0 for p, row in still.items() for v in (row if p not in (2, 4) else row[1:])):
        return 0
    if sp.simplify(still[4][0] - 1) != 0 or sp.simplify(still.get(2, (0,))[0] - k**2) != 0:
        return 0
    rows = []
    for x, end in enumerate(conditions):
        turning = ((1, 0), (c, s))[x]  # cos kx, sin kx
        for condition in end:
            row = [sp.Integer(0)] * 4
            for (p, r), factor in condition.items():
                if r:
                    continue
                row[0] += factor * int(p == 0)
                row[1] += factor * (x if p == 0 else int(p == 1))
                for column in (0, 1):
                    # (cos kx)^(p) = kᵖ cos(kx + pπ/2), and sin the same a quarter later
                    quarter = (p - column) % 4
                    wave = (turning[0], -turning[1], -turning[0], turning[1])[quarter]
                    row[2 + column] += factor * k**p * wave
            rows.append(row)
    found = sp.Poly(sp.rem(sp.expand(sp.Matrix(rows).det()), s**2 + c**2 - 1, s), c, s)
    terms = {power: sp.expand(f) for power, f in found.terms() if sp.expand(f) != 0}
    if set(terms) != {(0, 0), (1, 0)} or len(sp.Add.make_args(terms[0, 0])) != 1:
        return 0
    return {1: 1, -1: -1}.get(sp.simplify(terms[1, 0] / terms[0, 0]), 0)
