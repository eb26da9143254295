"""Ziegler's double pendulum in exact numbers: two bars of length l, 2m at the middle joint and m at the end.

T = m l²(3 φ̇₁² + 2 φ̇₁ φ̇₂ + φ̇₂²)/2, V = k(φ₁² + (φ₂ − φ₁)²)/2, two dampers δW = −c (φ̇₁ δφ₁ + (φ̇₂ − φ̇₁)(δφ₂ − δφ₁)),
and a force P along the second bar, δW = P l (φ₁ − φ₂) δφ₁. With l = k = m = 1:

    M = [[3, 1], [1, 1]],   C = c [[2, −1], [−1, 1]],   K = [[2 − P, P − 1], [−1, 1]].
"""

from __future__ import annotations

from fractions import Fraction as Q

from mpmath import mp, mpf, workdps


def polynomial(P: Q, c: Q) -> list[Q]:
    """det(λ²M + λC + K), from λ⁴ down to 1."""
    rows = (([3, 2 * c, 2 - P], [1, -c, P - 1]), ([1, -c, -1], [1, c, 1]))

    def product(a: list[Q], b: list[Q]) -> list[Q]:
        out = [Q(0)] * 5
        for i, u in enumerate(a):
            for j, v in enumerate(b):
                out[i + j] += u * v
        return out

    (a, b), (d, e) = ([[Q(x) for x in entry] for entry in row] for row in rows)
    return [u - v for u, v in zip(product(a, e), product(b, d), strict=True)]


def undamped(digits: int = 30) -> mpf:
    """The lowest P at which the two ω² meet: the discriminant of the polynomial in λ², quadratic in P, vanishes."""

    def discriminant(P: Q) -> Q:
        a, _, b, _, c = polynomial(P, Q(0))
        return b * b - 4 * a * c

    low, mid, high = (discriminant(Q(P)) for P in (-1, 0, 1))
    first, second = (high - low) / 2, (high + low) / 2 - mid
    with workdps(digits):
        spread = mp.sqrt(mpf(1) * (first**2 - 4 * second * mid))
        both = [(sign * spread - first) / (mpf(2) * second) for sign in (-1, 1)]
        return min(both)


def slight_damping() -> Q:
    """P of the limit of vanishing equal dampers: Routh's a₁a₂a₃ = a₀a₃² + a₁²a₄, where a₁ and a₃ are c times numbers.

    To second order in c it is linear in P."""

    def routh(P: Q) -> Q:
        a0, a1, a2, a3, a4 = polynomial(P, Q(1))
        a2 = polynomial(P, Q(0))[2]  # without c²
        return a1 * a2 * a3 - a0 * a3**2 - a1**2 * a4

    start, end = routh(Q(0)), routh(Q(1))
    assert routh(Q(2)) == 2 * end - start
    return start / (start - end)
