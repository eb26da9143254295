"""Closed forms of ∫ x^k φ_i^(p) φ_j^(q) dx against quadrature of classical modes; antiderivatives by the ODE."""

from __future__ import annotations

import itertools
import random
from fractions import Fraction
from functools import cache
from typing import Any

import mpmath
import pytest
import sympy as sp
from mpmath import mpf

from freebeam_derive import comparison, integrals, roots
from freebeam_derive.comparison import comparison_beam
from freebeam_derive.integrals import gamma_i, gamma_j
from freebeam_derive.notation import x

ORDERS = {"free": (2, 3), "pinned": (0, 2), "sliding": (1, 3), "clamped": (0, 1)}
PAIRS = list(itertools.product(ORDERS, repeat=2))
DIGITS = 60
RIGID = [("free", "free"), ("pinned", "free"), ("free", "pinned"), ("sliding", "free"), ("sliding", "sliding")]
WORDS = ("deflection", "slope", "moment", "shear")


@cache
def nodes() -> list[tuple[Any, Any]]:
    with mpmath.workdps(DIGITS):
        rule = mpmath.calculus.quadrature.GaussLegendre(mpmath.mp).calc_nodes(6, mpmath.mp.prec)
        return [((1 + node) / 2, weight / 2) for node, weight in rule]


def derivatives(g: Any, place: Any) -> list[list[Any]]:
    """sin, cos, sinh, cosh of γx and their derivatives over γ^d, d = 0…3."""
    u = g * place
    s, c, sh, ch = mpmath.sin(u), mpmath.cos(u), mpmath.sinh(u), mpmath.cosh(u)
    return [[s, c, sh, ch], [c, -s, ch, sh], [-s, -c, sh, ch], [-c, s, ch, sh]]


@cache
def mode(ends: tuple[str, str], index: int) -> tuple[Any, list[Any]]:
    """Root and coefficients of sin, cos, sinh, cosh: the null vector of the four conditions, sine's (cosine's) 1."""
    with mpmath.workdps(DIGITS + 20):
        g = roots.root(comparison_beam(ends), index, DIGITS + 20)
        rows = [derivatives(g, mpf(end))[d] for end, kind in enumerate(ends) for d in ORDERS[kind]]
        for fixed in ([mpf(1)], [mpf(0), mpf(1)]):
            n = len(fixed)
            left = mpmath.matrix([row[n:] for row in rows])
            right = mpmath.matrix([-sum(a * b for a, b in zip(row, fixed, strict=False)) for row in rows])
            try:
                found = [*fixed, *mpmath.lu_solve(left, right)]  # least squares
            except ValueError:  # the sine's coefficient cannot be 1
                continue
            if max(abs(sum(a * b for a, b in zip(row, found, strict=True))) for row in rows) < mpf(10) ** -DIGITS:
                return g, found
    raise AssertionError("no null vector")


@cache
def sampled(ends: tuple[str, str], index: int) -> list[list[Any]]:
    """φ^(d) at the nodes, d = 0…3."""
    g, factors = mode(ends, index)
    with mpmath.workdps(DIGITS):
        values = [derivatives(g, place) for place, _ in nodes()]
        return [[g**d * mpmath.fdot(factors, v[d]) for v in values] for d in range(4)]


def names(ends: tuple[str, str], index: int, suffix: str) -> dict[str, Any]:
    """γ, the sign and the end values of a mode under the names that the closed forms use."""
    g, factors = mode(ends, index)
    known = {f"gamma_{suffix}": g, f"sigma_{suffix}": mpf((-1) ** (index - 1))}
    for end, (d, word) in itertools.product(range(2), enumerate(WORDS)):
        known[f"{word}_{end}_{suffix}"] = mpmath.fdot(factors, derivatives(g, mpf(end))[d])
    return known


@cache
def compiled(expression: Any) -> tuple[list[str], Any]:
    symbols = sorted(expression.free_symbols, key=str)
    return [str(s) for s in symbols], sp.lambdify(symbols, expression, "mpmath")


def number(expression: Any, known: dict[str, Any]) -> Any:
    symbols, function = compiled(sp.sympify(expression))
    return mpmath.mpmathify(function(*(known[s] for s in symbols)))


def close(found: Any, expected: Any, size: Any) -> bool:
    return bool(abs(found - expected) < mpf(10) ** -32 * max(abs(expected), size))


@pytest.mark.parametrize("n", range(len(PAIRS)), ids=["-".join(p) for p in PAIRS])
def test_closed_forms_against_quadrature(n: int) -> None:
    """i ≠ j, both ways, and i = j. Every (p, q) is met, a power of x with each."""
    ends = PAIRS[n]
    beam = comparison_beam(ends)
    with mpmath.workdps(DIGITS - 10):
        p, q = divmod(n, 4)
        for k in {0: (1,), 2: (2,), 4: (0, 1), 5: (3,)}.get(n % 8, (0,)):
            apart, same = (
                integrals.assembled(integrals.integral_modes(beam, k, p, q)),
                integrals.integral_same(beam, k, p, q),
            )
            for i, j in ((1, 2), (5, 1), (5, 5)):
                first, second = sampled(ends, i)[p], sampled(ends, j)[q]
                expected = mpmath.fsum(w * u**k * a * b for (u, w), a, b in zip(nodes(), first, second, strict=True))
                known = names(ends, i, "i") | names(ends, j, "j")
                size = mode(ends, i)[0] ** p * mode(ends, j)[0] ** q
                assert close(number(same if i == j else apart, known), expected, size), (k, p, q, i, j)


@pytest.mark.parametrize("ends", RIGID, ids="-".join)
def test_rigid_functions_against_quadrature(ends: tuple[str, str]) -> None:
    beam = comparison_beam(ends)
    dice = random.Random("-".join(ends))
    with mpmath.workdps(DIGITS - 10):
        for function, order, index in itertools.product(beam.rigid, range(4), (1, 4)):
            k = dice.randint(0, 3)
            polynomial = sp.expand(x**k * function)
            found = number(integrals.integral_rigid(beam, polynomial, order), names(ends, index, "i"))
            at = sp.lambdify(x, polynomial, "mpmath")
            rows = zip(nodes(), sampled(ends, index)[order], strict=True)
            expected = mpmath.fsum(w * at(u) * v for (u, w), v in rows)
            assert close(found, expected, mode(ends, index)[0] ** order), (function, k, order, index)


def test_polynomials_are_integrated_exactly() -> None:
    assert comparison.integral_polynomials(x - sp.Rational(1, 2), x**2) == sp.Rational(1, 12)


def derivative(terms: dict[tuple[int, int, int], Fraction], a: Fraction, b: Fraction) -> dict[Any, Fraction]:
    """d/dx of Σ c x^m u^(r) v^(s) with u'''' = a u, v'''' = b v."""
    result: dict[Any, Fraction] = {}
    for (m, r, s), c in terms.items():
        parts = [((m, (r + 1) % 4, s), c * (a if r == 3 else 1)), ((m, r, (s + 1) % 4), c * (b if s == 3 else 1))]
        if m:
            parts.append(((m - 1, r, s), c * m))
        for key, value in parts:
            result[key] = result.get(key, Fraction(0)) + value
    return result


def evaluated(terms: integrals.Antiderivative, a: Fraction, b: Fraction) -> dict[tuple[int, int, int], Fraction]:
    numbers = {sp.Symbol("a", positive=True): sp.Rational(a), sp.Symbol("b", positive=True): sp.Rational(b)}
    result: dict[tuple[int, int, int], Fraction] = {}
    for m, r, s, coefficient in terms:
        value = sp.sympify(coefficient).subs(numbers)
        assert value.is_Rational
        result[m, r, s] = result.get((m, r, s), Fraction(0)) + Fraction(int(value.p), int(value.q))
    return result


@pytest.mark.parametrize("k", range(4))
def test_antiderivatives_differentiate_to_the_integrand(k: int) -> None:
    """By the differential equation alone, in exact fractions: for any ends, any roots."""
    a, b = Fraction(7, 3), Fraction(29, 5)
    for p, q in itertools.product(range(4), repeat=2):
        image = derivative(evaluated(integrals.antiderivative(k, p, q), a, b), a, b)
        assert {key: v for key, v in image.items() if v} == {(k, p, q): 1}
        image = derivative(evaluated(integrals.antiderivative_same(k, p, q), a, a), a, a)
        folded: dict[Any, Fraction] = {}
        for (m, r, s), v in image.items():  # one mode: φ^(r) φ^(s) has no order
            folded[m, *sorted((r, s))] = folded.get((m, *sorted((r, s))), Fraction(0)) + v
        assert {key: v for key, v in folded.items() if v} == {(k, *sorted((p, q))): 1}


@pytest.mark.parametrize("ends", [("free", "free"), ("clamped", "pinned")], ids="-".join)
def test_row_and_column_change_places(ends: tuple[str, str]) -> None:
    """∫ x^k φ_i^(p) φ_j^(q) is ∫ x^k φ_j^(q) φ_i^(p), whatever γ and the end values are: no root is needed."""
    beam, dice = comparison_beam(ends), random.Random(1)
    values = {
        f"{name}_{suffix}": mpf(dice.choice((-1, 1)) if name == "sigma" else dice.randint(1, 99))
        / 7 ** (name != "sigma")
        for name in (
            "gamma",
            "sigma",
            *(f"{w}_{e}" for w in ("deflection", "slope", "moment", "shear") for e in (0, 1)),
        )
        for suffix in "ij"
    }
    swapped = {key[:-1] + ("j" if key[-1] == "i" else "i"): value for key, value in values.items()}
    with mpmath.workdps(DIGITS):
        for k, p, q in [(0, 0, 1), (1, 0, 2)]:
            one = number(integrals.assembled(integrals.integral_modes(beam, k, p, q)), values)
            other = number(integrals.assembled(integrals.integral_modes(beam, k, q, p)), swapped)
            assert one != 0 and abs(one / other - 1) < mpf(10) ** (10 - DIGITS)


@pytest.mark.parametrize(("k", "p", "q"), [(4, 0, 0), (-1, 0, 0), (0, 4, 0), (0, 0, 4), (0, -1, 0)])
def test_out_of_range_is_refused(k: int, p: int, q: int) -> None:
    beam = comparison_beam(("free", "free"))
    for integral in (integrals.integral_modes, integrals.integral_same):
        with pytest.raises(ValueError, match="powers of x up to 3 and derivatives up to the third") as caught:
            integral(beam, k, p, q)
        assert "\n" not in str(caught.value) and f"x^{k}" in str(caught.value)


@pytest.mark.parametrize("ends", PAIRS, ids="-".join)
def test_orthogonality_is_proven_for_all_ends(ends: tuple[str, str]) -> None:
    """E = γ⁴ M with M diagonal: the step holds the zeros and the two diagonal entries."""
    (step,) = integrals.orthogonality(comparison_beam(ends))
    mass, bending, of_mass, of_bending = step.after
    assert (mass, bending) == (0, 0)
    assert sp.simplify(of_bending - gamma_i**4 * of_mass) == 0 and of_mass != 0


def test_the_identity_of_the_slopes() -> None:
    """∫ φ_i' φ_j' dx = [a φ_i φ_j' − b φ_i' φ_j + φ_i'' φ_j''' − φ_i''' φ_j''] / (a − b), typed."""
    a, b = sp.Symbol("a", positive=True), sp.Symbol("b", positive=True)
    found = {(m, r, s): c for m, r, s, c in integrals.antiderivative(0, 1, 1)}
    typed = {(0, 0, 1): a / (a - b), (0, 1, 0): -b / (a - b), (0, 2, 3): 1 / (a - b), (0, 3, 2): -1 / (a - b)}
    assert set(found) == set(typed)
    assert all(sp.cancel(found[key] - typed[key]) == 0 for key in typed)


def test_operations_count_whole_matrices_only() -> None:
    u, v = sp.Symbol("u_i"), sp.Symbol("v_j")
    assert integrals.operations(u**3 * gamma_i + sp.sin(u)) == 0
    assert integrals.operations(u * v) == 1
    assert integrals.operations(u * gamma_i * v + gamma_j**2 * u) == 3
