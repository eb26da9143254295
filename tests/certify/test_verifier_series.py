"""The verifier's power series: what a column says becomes equations on pieces, and their solutions, with bounds."""

from __future__ import annotations

from fractions import Fraction
from math import factorial
from types import SimpleNamespace
from typing import Any

import flint
import numpy as np
import pytest
from flint import arb, arb_poly, fmpq, fmpq_poly
from numpy.polynomial import Polynomial
from scipy.integrate import solve_ivp

from freebeam_derive.certify import verifier_pieces
from freebeam_derive.certify.verifier_pieces import ROOM, OfPieces, Pieces
from freebeam_derive.certify.verifier_sections import Sections
from freebeam_derive.certify.verifier_shooting import POWERS, Part, combined

BITS = 128


def numeric(f: fmpq_poly) -> Polynomial:
    return Polynomial([float(Fraction(int(c.p), int(c.q))) for c in f.coeffs()] or [0.0])


def of_column() -> tuple[Sections, Any]:
    """All there may be along two parts and at the place between them, and what damping leaves."""
    column = Sections(
        ("clamped", "free"), (Fraction(0), Fraction(2, 5), Fraction(1)),
        [fmpq_poly([3, -1]), fmpq_poly([2, 1, 1])], [fmpq_poly([2, 1]), fmpq_poly([3, -2])],
        [{0: fmpq_poly([5, 2])}, {0: fmpq_poly([1]), 1: fmpq_poly([4, 3])}],
        [{(0, 1): fmpq_poly([2, 7])}, {(1, 1): fmpq_poly([-6, 5]), (1, 0): fmpq_poly([1, 2])}],
        {(1, 0): Fraction(3), (1, 1): Fraction(1, 3), (2, 0): Fraction(7)},
        {(0, 1): Fraction(37), (1, 0): Fraction(11), (2, 1): Fraction(13)},
        {((1, 0), (1, 1)): Fraction(17), ((2, 0), (2, 1)): Fraction(19), ((2, 1), (0, 0)): Fraction(23)},
    )  # fmt: skip
    left = SimpleNamespace(
        along=[{0: fmpq_poly([1, 4])}, {1: fmpq_poly([9, 2])}], points={(1, 0): Fraction(29), (2, 0): Fraction(-31)},
        c_E=Fraction(1, 3),
    )  # fmt: skip
    return column, left


def parts(column: Sections, left: Any, n: int) -> list[dict[tuple[int, int], Polynomial]]:
    """Factors of v^(i) y^(j) along a part: without load, of the load, of the mass, of what damping leaves."""
    still = {(2, 2): column.EI[n]} | {(p, p): f for p, f in column.elastic[n].items()}
    each = still, column.load[n], {(0, 0): column.m[n]}, {(p, p): f for p, f in left.along[n].items()}
    return [{key: numeric(f) for key, f in of.items()} for of in each]


@pytest.mark.parametrize("n", [0, 1])
def test_the_equation_on_a_piece_is_that_of_the_forms(n: int) -> None:
    """Σ (−1)^i (f y^(j))^(i), by ξ with x = x₀ + hξ, times h."""
    column, left = of_column()
    x, h = column.breaks[n] + Fraction(1, 20), Fraction(3, 16)
    table = verifier_pieces._equation(column, left, n, x, h)
    y = Polynomial(np.random.default_rng(n).normal(size=8))  # of x
    in_xi = y(Polynomial([float(x), float(h)]))
    for which, forms in enumerate(parts(column, left, n)):
        strong = sum(((-1) ** i * (f * y.deriv(j)).deriv(i) for (i, j), f in forms.items()), Polynomial([0]))
        for xi in (0.0, 0.3, 0.9):
            found = sum(float(f[which]) * xi**k * in_xi.deriv(d)(xi) for (d, k), f in table.items() if d)
            found += sum(float(f[which]) * xi**k * in_xi(xi) for (d, k), f in table.items() if not d)
            assert found == pytest.approx(float(h) * strong(float(x) + float(h) * xi), rel=1e-9, abs=1e-9)


def test_conditions_at_places_are_those_of_the_forms_by_parts() -> None:
    """What stands with v^(order) at a break: EI y'' v' − ((EI y'')' − N y' − …) v of both sides, and what is there."""
    column, left = of_column()
    sides = {side: Polynomial(np.random.default_rng(7 + side).normal(size=6)) for side in (1, -1)}
    for node in (0, 1, 2):
        x = float(column.breaks[node])
        for order in (0, 1):
            expected = [0.0] * 4
            for side, n in ((1, node - 1), (-1, node)):
                if not 0 <= n < 2:
                    continue
                y = sides[side]
                for which, forms in enumerate(parts(column, left, n)):
                    for (i, j), f in forms.items():
                        flux = f * (y.deriv(j) if j else y)
                        if i == 2:
                            expected[which] += side * (flux(x) if order else -flux.deriv()(x))
                        if i == 1 and not order:
                            expected[which] += side * flux(x)
            here = sides[-1 if node == 0 else 1]
            for which, of in ((0, column.springs), (2, column.masses), (3, left.points)):
                expected[which] += float(of.get((node, order), 0)) * (here.deriv() if order else here)(x)
            for (row, (at, j)), force in column.forces.items():
                if row == (node, order):
                    y = here if at == node else sides[1 if at else -1]
                    expected[1] += float(force) * (y.deriv(j) if j else y)(float(column.breaks[at]))
            found = [0.0] * 4
            for (side, d), factors in verifier_pieces._natural(column, left, node, order).items():
                y, at = sides[side], x
                if node == 2 and order == 1 and side == -1:
                    at = 0.0  # of the other end
                for which, factor in enumerate(factors):
                    found[which] += float(factor) * (y.deriv(d) if d else y)(at)
            assert found == pytest.approx(expected, rel=1e-9, abs=1e-9)


def test_pieces_are_all_of_a_part_and_as_long_as_the_stiffness_lets() -> None:
    """Σ |EI_k| (5/4)^k over |EI_0| up to ROOM; three quarters of what would be too long."""
    column, left = of_column()
    for n in (0, 1):
        x, end = column.breaks[n : n + 2]

        def rest(x: Fraction, h: Fraction, n: int = n) -> Fraction:
            f = column.EI[n](fmpq_poly([fmpq(x.numerator, x.denominator), fmpq(h.numerator, h.denominator)]))
            c = [Fraction(int(v.p), int(v.q)) for v in f.coeffs()]
            return sum((abs(v) * Fraction(5, 4) ** k for k, v in enumerate(c) if k), Fraction(0)) / abs(c[0])

        found = list(verifier_pieces._cut(column, left, n))
        for h, table in found:
            assert rest(x, h) <= ROOM and table == verifier_pieces._equation(column, left, n, x, h)
            assert x + h == end or rest(x, h * 4 / 3) > ROOM
            x += h
        assert x == end and len(found) == 1 + 2 * n


def test_the_series_on_a_piece_solve_its_equation() -> None:
    """ξ^r + … and its derivatives at ξ = 1, at loads, s and q within their bounds, as integrated step by step."""
    column, left = of_column()
    P, S, Q = 8, 64, 3
    of: Any = object.__new__(OfPieces)
    with flint.ctx.workprec(BITS):
        of.P, of.S, of.Q, of._bits = arb(P), arb(S), arb(Q), 64
        h, table = next(iter(verifier_pieces._cut(column, left, 1)))
        solutions = of._solutions(table)
    assert float(h) < 0.6
    p, s, q = 5.0, 40.0, -2.0

    def slopes(xi: float, y: Any) -> Any:
        total, lead = 0.0, 0.0
        for (d, k), factors in table.items():
            a, b, c, left_over = map(float, factors)
            factor = (a + p * b - s * c + q * left_over) * xi**k
            if d == 4:
                lead += factor
            else:
                total += factor * y[d]
        return [y[1], y[2], y[3], -total / lead]

    for r, found in enumerate(solutions):
        start = [float(factorial(r) * (d == r)) for d in range(4)]
        exact = solve_ivp(slopes, (0, 1), start, method="DOP853", rtol=1e-10, atol=1e-11).y[:, -1]
        assert [value(part, p / P, s / S, q / Q) for part in found] == pytest.approx(exact, rel=1e-7, abs=1e-8)
        for part in found:
            total = sum(float(abs(c)) for level in part.levels for row in level for c in row.coeffs())
            assert total <= float(part.size) and float(part.rest) < 2**-40 * float(part.size)


def value(part: Part, p: float, s: float, t: float) -> float:
    """Of a part at p/P, s/S and t; of `OfPieces` rows are by p, and polynomials in s."""
    return sum(
        t**n * p**j * sum(float(c) * s**k for k, c in enumerate(row.coeffs()))
        for n, level in enumerate(part.levels) for j, row in enumerate(level)
    )  # fmt: skip


def test_a_factor_is_of_the_size_of_its_parts() -> None:
    """a + b p − c s + r q where |p| ≤ P, |s| ≤ S, |q| ≤ Q."""
    of: Any = object.__new__(OfPieces)
    with flint.ctx.workprec(BITS):
        of.P, of.S, of.Q = arb(2), arb(3), arb(5)
        for factor, levels in (
            ((7, 11, 13, 17), [[[7, -39], [22]], [[85]]]), ((-7, 0, 13, 0), [[[-7, -39]]]),
            ((0, -11, 0, -17), [[[], [-22]], [[-85]]]),
        ):  # fmt: skip
            part = of._linear(tuple(map(Fraction, factor)))
            expected = sum(abs(f) * size for f, size in zip(factor, (1, 2, 3, 5), strict=True))
            assert float(part.size) == pytest.approx(expected) and part.rest == 0
            assert [[[float(c) for c in row.coeffs()] for row in level] for level in part.levels] == levels


def test_f_is_known_up_to_twice_what_q_is_on_the_axis() -> None:
    """|q|² ≤ |s|, and c_E |q| ≤ 1."""
    column, left = of_column()
    them = Pieces(column)
    for c_E, S, Q in ((0, 16, 8), (Fraction(1, 3), 16, 6), (Fraction(1, 3), 4, 4)):
        them.left = SimpleNamespace(c_E=Fraction(c_E)) if c_E else None  # type: ignore[assignment]
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(OfPieces, "_determinant", lambda self: Part([[arb_poly([1])]], arb(1)))
            assert float(OfPieces(them, arb(2), arb(S)).Q) == pytest.approx(Q)
            for P, far in ((2, 10.0**11), (10**5, 4)):
                with pytest.raises(ArithmeticError, match="too long"):
                    OfPieces(them, arb(P), arb(far))
    assert left.c_E


def test_f_that_is_known_serves_where_it_goes_so_far_at_its_precision(monkeypatch: pytest.MonkeyPatch) -> None:
    column, _ = of_column()
    made: list[Any] = []
    them = Pieces(column)
    monkeypatch.setattr(Pieces, "whole", lambda self, P, s, S, most: made.append((P, S)) or (P, S))
    with flint.ctx.workprec(64):
        first = them.on(arb(3), arb(200))
        assert made == [(4, 256)]
        for p, s in ((4, 256), (1, 1), (3, 256), (4, 3)):
            assert them.on(arb(p), arb(s)) is first and len(made) == 1
        assert them.on(arb(5), arb(200)) == (16, 256) and them.on(arb(3), arb(257)) == (4, 4096)
        assert len(made) == 3
        assert them.at(arb(3), arb(-250), 2) is first and len(made) == 3
        assert them.at(arb(3), arb("255.5"), 2) == (4, 4096)
    with flint.ctx.workprec(65):
        them.on(arb(3), arb(200))
    assert len(made) == 4


# --- functions of p, s and t -----------------------------------------------------------------------------------------


def a_part(shape: tuple[int, int, int], size: float, rest: float) -> tuple[Part, Any]:
    c = np.random.default_rng(int(np.prod(shape))).integers(-9, 10, shape)
    return Part([[arb_poly([*map(int, row)]) for row in level] for level in c], arb(size), arb(rest)), c


def filled(part: Part, shape: tuple[int, ...]) -> Any:
    found = np.zeros(shape)
    for index in np.ndindex(*[len(part.levels)]):
        for k, row in enumerate(part.levels[index[0]]):
            for j, c in enumerate(row.coeffs()):
                found[index[0], k, j] = float(c)
    return found


def test_a_product_is_that_of_all_coefficients_up_to_where_they_are_kept() -> None:
    for first, second in (((2, 3, 2), (3, 2, 4)), ((1, 1, 1), (2, 4, 1)), ((4, 3, 3), (4, 3, 2))):
        (a, of_a), (b, of_b) = a_part(first, 3, 0.5), a_part(second, 5, 0.25)
        shape = tuple(m + n - 1 for m, n in zip(first, second, strict=True))
        whole = np.zeros(shape)
        for i in np.ndindex(*first):
            for j in np.ndindex(*second):
                whole[tuple(map(sum, zip(i, j, strict=True)))] += of_a[i] * of_b[j]
        for most, powers in ((2000, POWERS), (2, POWERS), (2000, 1), (3, 0)):
            found = a.times(b, most, powers)
            kept = whole.copy()
            kept[powers + 1 :] = 0
            kept[:, most:] = 0
            assert np.array_equal(filled(found, shape), kept) and len(found.levels) == min(powers + 1, shape[0])
            assert float(found.size) == 15
            assert float(found.rest) == pytest.approx(3 * 0.25 + 0.5 * 5 + 0.5 * 0.25)


def test_a_sum_is_that_of_all_coefficients() -> None:
    (a, of_a), (b, of_b) = a_part((2, 3, 2), 3, 0.5), a_part((3, 2, 4), 5, 0.25)
    expected = np.zeros((3, 3, 4))
    expected[:2, :, :2] += of_a
    expected[:, :2, :] -= 2 * of_b
    found = a.plus(b, -2)
    assert np.array_equal(filled(found, (3, 3, 4)), expected)
    assert float(found.size) == pytest.approx(13) and float(found.rest) == 1
    rows = combined([arb_poly([1])], [arb_poly([2]), arb_poly([3])], arb(5))
    assert [float(row[0]) for row in rows] == [11, 15]
    assert [float(row[0]) for row in combined([arb_poly([1]), arb_poly([4])], [arb_poly([2])], arb(5))] == [11, 4]


def test_what_is_too_small_to_count_goes_to_the_rest() -> None:
    with flint.ctx.workprec(BITS):
        least = arb(2) ** -(BITS + 8)
        rows = [[arb_poly([1, least / 2, 1, least / 3]), arb_poly([least / 4])], [arb_poly([]), arb_poly([least / 5])]]
        short = Part(rows, arb(1), least).short()
        assert [[[float(c) for c in row.coeffs()] for row in level] for level in short.levels] == [
            [[1, float(least / 2), 1]]
        ]
        assert float(short.rest / least) == pytest.approx(1 + 1 / 3 + 1 / 4 + 1 / 5) and short.size == 1
        # as large as that it stays, and a share of the size may be more
        assert (
            Part([[arb_poly([least])]], arb(1)).short().levels
            and not Part([[arb_poly([least])]], arb(2)).short().levels
        )
        for share, stays in ((arb("0.1"), False), (arb("0.01"), True)):
            part = Part([[arb_poly([1, arb("0.05")])]], arb(1)).short(share)
            assert (part.levels[0][0].length() == 2) is stays
            assert float(part.rest) == pytest.approx(0 if stays else 0.05)
