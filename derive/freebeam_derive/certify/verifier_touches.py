"""Loads at which λ = 0 is an eigenvalue of the beam itself and none passes zero, for the verifier.

Of the verifier of certificates of the beam itself (`verifier_of_beam`); it shares no code with the prover. For a beam
at rest with y'''' + k² y'' = 0, k² = P, the determinant of the end conditions on 1, x, cos kx and sin kx is a
polynomial in k, cos k and sin k. Where it is a kⁿ (1 ± cos k) its zeros for P > 0 are known, and each is double.
"""

from __future__ import annotations

from fractions import Fraction
from itertools import permutations, product

from flint import arb

from freebeam_derive.certify.verifier_claims import ball, require
from freebeam_derive.certify.verifier_shooting import Shooting

PASSES = "F(P, 0) is not known to pass zero nowhere"
Waves = dict[tuple[int, int, int], Fraction]  # powers of k, cos k, sin k -> factor


def touches(F: Shooting, R: int, load: Fraction) -> list[int]:
    """All n with F((nπ)², 0) = 0 up to a load, where F(P, 0) has no other zeros for P > 0. Raises Refused."""
    first = 1 if _sign(F, R) > 0 else 2
    found = range(first, int(float(load) ** 0.5) + 3, 2)  # more than there are, for π > 1
    up_to = [n for n in found if not (n * arb.pi()) ** 2 > ball(load)]
    require(all((n * arb.pi()) ** 2 < ball(load) for n in up_to), "a touch is at the end of the loads")
    return up_to


def _sign(F: Shooting, R: int) -> int:
    """1 or −1 for a determinant a kⁿ (1 ± cos k). Raises Refused for another."""
    terms = {key: parts for key, parts in F.terms.items() if any(parts)}
    require(R == 0 and terms == {(2, 0): [0, 1]}, "no touch is known of such a column")
    rows = []
    for condition in F.conditions:
        row: list[Waves] = [{} for _ in range(4)]
        for (end, order), (still, load) in condition.items():
            for column, waves in enumerate(_solutions(end, order)):
                for (k, c, s), f in waves.items():
                    _add(row[column], (k, c, s), f * still)
                    _add(row[column], (k + 2, c, s), f * load)
        rows.append(row)
    whole = {key: f for key, f in _determinant(rows).items() if f}
    require(len(whole) == 2, PASSES)
    ((k, c, s), one), (other, cosine) = sorted(whole.items())
    require((c, s) == (0, 0) and other == (k, 1, 0) and abs(one) == abs(cosine), PASSES)
    return 1 if one == cosine else -1


def _solutions(end: int, order: int) -> list[Waves]:
    """A derivative of 1, x, cos kx and sin kx at an end."""
    one = Fraction(1)
    wave = [((1, 0), one), ((0, 1), -one), ((1, 0), -one), ((0, 1), one)]  # of cos; of sin three later
    turned = [wave[(order + shift) % 4] for shift in (0, 3)]
    found: list[Waves] = [{(0, 0, 0): one} if order == 0 else {}]
    found.append({(0, 0, 0): one} if order == 1 or (order == 0 and end == 1) else {})
    for (c, s), sign in turned:
        found.append({(order, c, s): sign} if end else {(order, 0, 0): sign} if c else {})
    return found


def _determinant(rows: list[list[Waves]]) -> Waves:
    """With sin² = 1 − cos²."""
    total: Waves = {}
    for columns in permutations(range(4)):
        sign = (-1) ** sum(columns[i] > columns[j] for i in range(4) for j in range(i + 1, 4))
        for parts in product(*(rows[i][column].items() for i, column in enumerate(columns))):
            factor, powers = Fraction(sign), [0, 0, 0]
            for key, f in parts:
                factor, powers = factor * f, [a + b for a, b in zip(powers, key, strict=True)]
            _add_squared(total, powers, factor)
    return total


def _add_squared(total: Waves, powers: list[int], factor: Fraction) -> None:
    k, c, s = powers
    if s < 2:
        _add(total, (k, c, s), factor)
        return
    _add_squared(total, [k, c, s - 2], factor)
    _add_squared(total, [k, c + 2, s - 2], -factor)


def _add(total: Waves, key: tuple[int, int, int], factor: Fraction) -> None:
    total[key] = total.get(key, Fraction(0)) + factor
