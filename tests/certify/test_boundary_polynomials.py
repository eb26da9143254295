"""h and g of any matrices, against determinants on the imaginary axis; signs and lines against values. Eq. (24)."""

from __future__ import annotations

import random
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from flint import acb, acb_mat, arb, arb_mat, arb_poly, fmpq, fmpq_mat, fmpq_mpoly_ctx

import freebeam as fb
from freebeam_derive.certify.balls import Unproven, ball, precision
from freebeam_derive.certify.bivariate import Bivariate, keeps_sign, signs_on, zeros
from freebeam_derive.certify.boundary_polynomials import (
    LARGE,
    Boundary,
    Question,
    _fast,
    _of_any,
    boundary,
    characteristic,
    determinant,
    expansion,
    highest_power,
)
from freebeam_derive.certify.krawczyk import contracts, one_to_one


def drawn(N: int, seed: int) -> tuple[arb_mat, arb_mat, arb_mat, arb_mat]:
    """M and E positive definite; C positive, with a gyroscopic part, no sum of the two; H without symmetry."""
    source = random.Random(seed)

    def any_of_size() -> arb_mat:
        return arb_mat([[arb(fmpq(source.randint(-9, 9), 7)) for _ in range(N)] for _ in range(N)])

    def positive() -> arb_mat:
        half = any_of_size()
        return half * half.transpose() + arb_mat([[int(i == j) for j in range(N)] for i in range(N)])

    turning = any_of_size()
    damping = positive() + turning - turning.transpose()
    return positive(), damping, 50 * positive(), any_of_size()


def of_degrees(N: int, seed: int, degrees: tuple[int, int, int]) -> tuple[list[arb_mat], list[arb_mat], list[arb_mat]]:
    """M, C and K by powers of the load, definite without it."""
    source = random.Random(seed)
    M, C, E, _ = drawn(N, seed)
    more = [[drawn(N, source.randint(0, 99))[3] for _ in range(degree)] for degree in degrees]
    return [M, *more[0]], [C, *more[1]], [E, *more[2]]


@pytest.mark.parametrize("degrees", [(0, 0, 1), (0, 1, 2), (1, 0, 2), (0, 3, 1), (2, 2, 2), (0, 2, 0)])
@pytest.mark.parametrize("N", [1, 2, 3, 6])
@pytest.mark.parametrize("kind", ["damped", "limit", "undamped"])
def test_they_are_the_determinant_on_the_imaginary_axis(N: int, kind: str, degrees: tuple[int, int, int]) -> None:
    """det(−ω² M + iω C + K) / det M₀ = h + iω g, M, C and K of any degree in P; in the limit the first order in C;
    without damping g = ∂h/∂x."""
    with precision(300):
        M, C, K = of_degrees(N, N, degrees)
        found = expansion(M, [] if kind == "undamped" else C, K, kind == "limit")
        assert found.damped == (kind != "undamped")
        for P, omega in ((arb(3), arb(2)), (arb(-5) / 3, arb(9)), (arb(7), arb(1) / 10)):
            x = omega**2
            mass, damping, A = (sum((P**k * X for k, X in enumerate(terms)), 0 * M[0]) for terms in (M, C, K))
            A -= x * mass
            h, g = A.det(), arb(0)
            if kind == "damped":
                whole = (acb_mat(A) + acb(0, 1) * omega * acb_mat(damping)).det()
                h, g = whole.real, whole.imag / omega
            elif kind == "limit":
                g = h * A.solve(damping).trace()
            assert found.h(P, x).overlaps(h / M[0].det()) and found.h(P, x).rel_accuracy_bits() > 150
            if kind == "undamped":
                assert found.g(P, x).overlaps(found.h.at(P).derivative()(x))
            else:
                assert found.g(P, x).overlaps(g / M[0].det()) and found.g(P, x).rel_accuracy_bits() > 150


@pytest.mark.parametrize("vanishing", [False, True])
def test_damping_that_comes_with_the_load_is_divided_by_its_power(vanishing: bool) -> None:
    with precision(300):
        M, C, K = of_degrees(3, 8, (0, 0, 1))
        one, other = (expansion(M, [*(0 * C[0] for _ in range(k)), *C], K, vanishing) for k in (0, 2))
        P, x = arb(3) / 2, arb(5)
        assert vanishing == other.g(P, x).overlaps(one.g(P, x))  # else h and g have terms of higher order in C
        assert other.h(P, x).overlaps(one.h(P, x)) == vanishing
        if not vanishing:
            A = K[0] + P * K[1] - x * M[0]
            whole = (acb_mat(A) + acb(0, 1) * x.sqrt() * acb_mat(P**2 * C[0])).det() / M[0].det()
            assert other.g(P, x).overlaps(whole.imag / x.sqrt() / P**2)


def test_matrices_that_may_be_singular_are_refused() -> None:
    with precision(100):
        M, C, E, H = drawn(3, 1)
        with pytest.raises(Unproven):
            expansion([M * arb(0, 1)], [C], [E, H])
        with pytest.raises(Unproven):
            expansion([M], [C], [E * arb(0, 10), H])


def test_what_has_no_theorem_is_refused() -> None:
    """A motion that rests needs mass; some motion a frequency; definite matrices; what damping that vanishes acts on a
    mass, or stiffness and none from the load."""
    one, none = np.array([[fmpq(1)]]), np.array([[fmpq(0)]])

    def block(*diagonal: Any) -> Any:
        return np.array([[fmpq(diagonal[i] if i == j else 0) for j in (0, 1)] for i in (0, 1)])

    with precision(100):
        with pytest.raises(Unproven, match="no motion of it has a frequency"):
            _of_any([none], [one], [one], False)
        assert _of_any([one], [one], [one], False).N == 1
        resting = Boundary(1, Bivariate([arb_poly([0, arb(0, 1)])]), Bivariate([arb_poly([0, 1])]), True, rests=1)
        with pytest.raises(Unproven, match="rests without load is not known to have mass"):
            _ = resting.g_without_tangents
        with pytest.raises(Unproven, match="not known to be positive definite"):
            expansion([arb_mat([[1]])], [], [arb_mat([[-2]]), arb_mat([[1]])])
        balls = np.array([[arb(1), arb(0)], [arb(0), arb(0)]])
        for M, C, K, message in (
            (balls, block(1, 1), block(1, 1), "beside a factor that is no fraction"),
            (block(1, 0), block(1, 1), block(1, 0), "neither mass nor stiffness"),
        ):
            with pytest.raises(Unproven, match=message):
                _of_any([M], [C], [K], True)
        with pytest.raises(Unproven, match="whose mass comes with the load"):
            _fast([block(1, 0), block(0, 1)], [block(1, 1)], [block(1, 1)], 1)
        # μ C + K of the coordinate without mass: 3 μ + 5 + 7 P
        found = _of_any([block(1, 0)], [block(1, 3)], [block(2, 5), block(0, 7)], True)
        assert found.odd and found.N == 1 and len(found.fast) == 2
        factor = found.fast[1](arb(0)) / 3
        assert factor != 0
        for p, wanted in zip(found.fast, ([5, 7], [3, 0]), strict=True):
            assert all((p[k] / factor).overlaps(arb(v)) for k, v in enumerate(wanted))


def test_values_slopes_lines_and_taylors_form_agree() -> None:
    with precision(200):
        M, C, E, H = drawn(4, 5)
        found = expansion([M], [C], [E, H])
        P, x, t = arb(7) / 3, arb(11), arb(2) / 9
        for f in (found.h, found.g):
            assert f.at(P)(x).overlaps(f(P, x))
            assert f.at(P).derivative()(x).overlaps(f.by_x(P, x))
            line = f.along(P, x, arb(5))
            assert line(t).overlaps(f(P + t, x + 5 * t))
            assert line.derivative()(arb(0)).overlaps(f.by_P(P, x) + 5 * f.by_x(P, x))
            assert f.along(P, x, arb(0))(t).overlaps(f(P + t, x))
            assert f.about(P, x)(t, -t).overlaps(f(P + t, x - t))
            assert f.combined(arb(2), found.h, arb(3))(P, x).overlaps(2 * f(P, x) + 3 * found.h(P, x))
        local = found.about(P, x)
        assert isinstance(local, Boundary)
        for one, other in zip(local.slopes([arb(0), arb(0)]).entries(), found.slopes([P, x]).entries(), strict=True):
            assert one.overlaps(other)


def test_a_sign_is_said_only_where_it_holds_throughout() -> None:
    """(t − 1)(t − 2) on intervals with and without its zeros, and at their edges."""
    with precision(100):
        parabola, falling, zero = arb_poly([2, -3, 1]), arb_poly([1, -1]), arb_poly([0])
        quarter = Fraction(1, 4)
        assert [*signs_on([parabola, falling, zero], quarter - 1, quarter)] == [1, 1, 0]
        assert [*signs_on([parabola, falling, -parabola], 1 + quarter, 2 - quarter)] == [-1, -1, 1]
        assert [*signs_on([parabola, falling], 2 + quarter, 9 + quarter)] == [1, -1]
        assert [*signs_on([parabola], quarter, 2 - quarter)] == [0]
        assert [*signs_on([parabola], Fraction(1), Fraction(2))] == [0]
        assert [*signs_on([Bivariate([arb_poly([3])]).at(arb(1))], Fraction(0), Fraction(1))] == [1]


def test_a_sign_is_kept_on_a_strip_where_no_root_is_near() -> None:
    """(x − 1)(x − 3), as it is and at another load, on strips with and without roots, and out to infinity."""
    with precision(100):
        one, other, negative = arb_poly([3, -4, 1]), 2 * arb_poly([3, -4, 1]), arb_poly([-3, 4, -1])
        half = Fraction(1, 2)
        for n in (2, 4):
            high = n == 2  # of degree 4 it is nothing at infinity
            strips = [((0, half), True), ((2 - half, 2 + half), True), ((half, 2), False), ((2, 4), False)]
            for (low, top), kept in [*strips, ((4, None), high), ((2, None), False)]:
                ends = Fraction(low), None if top is None else Fraction(top)
                assert keeps_sign([one, other], *ends, n) == kept
                assert not keeps_sign([one, negative], *ends, n)


@pytest.mark.parametrize("roots", [[2, 3, 7], [3, 3, 5], [4, 4, 4, 1]])
def test_all_zeros_are_seen_also_double_ones(roots: list[int]) -> None:
    with precision(100):
        polynomial = arb_poly([1])
        for root in roots:
            polynomial *= arb_poly([-root, 1])
        found = sorted(float(z.real) for z in zeros(polynomial))
        assert len(found) == len(roots)
        assert all(abs(z - root) < 1e-3 for z, root in zip(found, sorted(roots), strict=True))


@pytest.mark.parametrize(("slope", "holds"), [(ball(1, 0.5), True), (ball(1, 1), False), (ball(2, 0), False)])
def test_values_on_a_box_differ_where_slopes_stay_clear_of_zero(slope: arb, holds: bool) -> None:
    """x and x²/2 about 1 at a slope of 1: of the second, whose slope may be 0, two places may have one value."""
    with precision(100):
        assert contracts(arb_mat([[1]]), arb_mat([[slope]]), [arb(1)]) == holds
        both = arb_mat([[slope, 0], [0, slope]])
        assert contracts(arb_mat([[1, 0], [0, 1]]), both, [arb(1), arb(4)]) == holds


@pytest.mark.parametrize("b, c, holds", [("0.9", "0.9", True), ("1.1", "1.1", False), ("10", "0.05", True)])
def test_a_box_is_one_to_one_where_no_matrix_of_slopes_is_singular(b: str, c: str, holds: bool) -> None:
    """Slopes [[1, β], [γ, 1]], |β| ≤ b, |γ| ≤ c: one is singular where β γ = 1; and with a third that none feels."""
    with precision(100):
        J = [[arb(1), arb(0, b), arb(0)], [arb(0, c), arb(1), arb(0)], [arb(0), arb(0), arb(2)]]
        for n in (2, 3):
            assert one_to_one(arb_mat([row[:n] for row in J[:n]])) == holds
        assert not one_to_one(arb_mat([[arb(1), arb(0)], [arb(0), arb(1, 1)]]))


@pytest.mark.parametrize("seed", range(3))
def test_large_characteristic_polynomials_hold_the_exact_ones(seed: int) -> None:
    """With columns that are eliminated already, and pivots that are zero."""
    source, n = random.Random(seed), LARGE + 2
    rows = [[fmpq(source.randint(-9, 9), 7) for _ in range(n)] for _ in range(n)]
    for k in range(n):
        rows[k][3 * seed] = fmpq(int(k == n - 1 and seed == 1))
        rows[(2 * seed + k) % n][k] = fmpq(0)
    with precision(300):
        found = characteristic(arb_mat([[arb(v) for v in row] for row in rows]))
        true = fmpq_mat(rows).charpoly()
        assert all(found[k].contains(true[k]) and found[k].rad() < 1e-40 for k in range(n + 1))
        assert found.degree() == n


def test_a_load_that_acts_in_few_rows_leaves_a_polynomial_of_their_number() -> None:
    """As many rows as are eliminated where the load acts in all of them; in a few it was refused."""
    source, n, loaded = random.Random(3), LARGE + 2, (1, 4, 9)
    terms = [
        fmpq_mat(n, n, [source.randint(-9, 9) * (k == 0 or i in loaded) for i in range(n) for _ in range(n)])
        for k in range(3)
    ]
    with precision(300):
        found = arb_poly(determinant([arb_mat(X) for X in terms]))
        assert found.degree() <= 2 * len(loaded)
        for P in (fmpq(1, 3), fmpq(-2)):
            assert found(arb(P)).contains((terms[0] + P * terms[1] + P * P * terms[2]).det())
    with pytest.raises(Unproven, match="not known to be regular"):
        determinant([arb_mat(n, n), arb_mat(terms[0])])


def test_zeros_are_found_and_not_only_told_apart() -> None:
    """Of a shaft on springs at P = 203/32; FLINT isolates these in balls of up to a hundred times their size."""
    known = [fmpq(743, 1000), fmpq(181), fmpq(5466, 10), fmpq(1287), fmpq(8995), fmpq(352127)]
    for bits in (160, 400):
        with precision(bits):
            product = arb_poly([1])
            for z in known:
                product *= arb_poly([-z, 1])
            found = sorted(float(z.real.mid()) for z in zeros(product))
            assert found == pytest.approx([int(z.p) / int(z.q) for z in known], rel=1e-6)


@pytest.mark.parametrize(
    "question", [Question(4), Question(4, Fraction("0.01"), Fraction("0.5")), Question(4, kappa=Fraction(1))]
)
def test_what_determinants_do_not_hold_is_exactly_nothing(question: Question) -> None:
    """Of K that is linear in the load, and M and C without: in h P^a x^b up to a + b = N, in g one less."""
    with precision(300):
        found = boundary(fb.column("beck", "modes").kernel, question, 300)
        for which, most in ((found.h.table, 4), (found.g.table, 3)):
            filled = {(a, b) for a in range(which.nrows()) for b in range(which.ncols()) if not which[a, b] == 0}
            assert filled == {(a, b) for a in range(most + 1) for b in range(most + 1 - a)}


@pytest.mark.parametrize("of_K", [0, 1, 2])
@pytest.mark.parametrize("of_C", [-1, 0, 1, 3])
def test_the_highest_power_of_a_rate_is_that_of_full_matrices(of_C: int, of_K: int) -> None:
    """In det(λ² M + λ C + K) of two rows, whose entries are drawn, with each power of the load."""
    draw, (P, rate) = random.Random(5), fmpq_mpoly_ctx.get(("P", "rate"), "lex").gens()

    def entry() -> Any:
        return draw.randint(1, 10**6) * rate**2 + sum(
            (
                draw.randint(1, 10**6) * P**k * rate**power
                for power, top in ((1, of_C), (0, of_K))
                for k in range(top + 1)
            ),
            0 * P,
        )

    (a, b), (c, d) = ((entry(), entry()) for _ in range(2))
    powers = [tuple(map(int, power)) for power in (a * d - b * c).to_dict()]
    for load in range(2 * max(of_C, of_K) + 3):
        known = max((r for p, r in powers if p == load), default=-1)
        assert highest_power(load, 2, 0, of_C, of_K) == known
    assert highest_power(9, 2, 1, of_C, of_K) == 4
