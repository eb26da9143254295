"""Comparison modes for all pairs of ends, against the 4 × 4 determinant in sin, cos, sinh and cosh at 60 digits.

Eqs. (14), (16)-(23).
"""

from __future__ import annotations

import dataclasses
import itertools
import random
from collections.abc import Callable
from functools import cache
from typing import Any

import mpmath
import numpy as np
import pytest
import sympy as sp
from mpmath import mpf

from freebeam_derive import comparison, roots
from freebeam_derive.comparison import ComparisonBeam, comparison_beam, epsilon, eta, sigma
from freebeam_derive.notation import alpha, beta, gamma, lambda_, x
from freebeam_derive.pipeline import Derived

ORDERS = {"free": (2, 3), "pinned": (0, 2), "sliding": (1, 3), "clamped": (0, 1)}  # Eq. (20) and its like, typed
PAIRS = list(itertools.product(ORDERS, repeat=2))
DIGITS = 60


def classical(g: Any, place: int, order: int) -> list[Any]:
    """The order-th derivatives, over γ^order, of sin, cos, sinh, cosh at an end."""
    u = g * place
    s, c, sh, ch = mpmath.sin(u), mpmath.cos(u), mpmath.sinh(u), mpmath.cosh(u)
    return [*((s, c), (c, -s), (-s, -c), (-c, s))[order], *((sh, ch) if order % 2 == 0 else (ch, sh))]


def determinant(ends: tuple[str, str], g: Any) -> Any:
    return mpmath.det(mpmath.matrix([classical(g, end, d) for end, kind in enumerate(ends) for d in ORDERS[kind]]))


@cache
def root(ends: tuple[str, str], index: int) -> Any:
    return roots.root(comparison_beam(ends), index, DIGITS)


@cache
def function(expression: Any, beam: ComparisonBeam, index: int) -> Any:
    return sp.lambdify((gamma, x), beam.numeric(sp.sympify(expression), index), "mpmath")


def value(expression: Any, beam: ComparisonBeam, index: int, place: Any = 0) -> Any:
    """An expression of the index-th mode at a place, at working precision."""
    return function(expression, beam, index)(root(beam.ends, index), mpf(place))


@pytest.mark.parametrize("ends", PAIRS, ids="-".join)
def test_characteristic_equation_is_the_determinant(ends: tuple[str, str]) -> None:
    """Eq. (21) and its like: proportional to the determinant at every γ, root or not."""
    equation = comparison_beam(ends).equation
    derived = sp.lambdify(gamma, equation.lhs - equation.rhs, "mpmath")
    with mpmath.workdps(DIGITS):
        ratios = [determinant(ends, mpf(g)) / derived(mpf(g)) for g in ("0.7", "1.9", "3.3", "5.8", "9.1")]
        assert max(abs(r / ratios[0] - 1) for r in ratios) < mpf(10) ** (8 - DIGITS)


@pytest.mark.parametrize("ends", PAIRS, ids="-".join)
def test_roots_are_all_roots_of_the_determinant(ends: tuple[str, str]) -> None:
    """It changes sign across each, to the last digits; and eight times, no more, from 0.2 to past the eighth."""
    found = [root(ends, n) for n in range(1, 9)]
    with mpmath.workdps(DIGITS + 40):
        for g in found:
            near = g * mpf(10) ** (2 - DIGITS)
            assert determinant(ends, g - near) * determinant(ends, g + near) < 0
    # in exponentials, which the determinant changes by a factor without zeros, floats do for the count
    g = np.linspace(0.2, float(found[-1]) + 0.1, 600)
    rows = []
    for end, kind in enumerate(ends):
        for d in ORDERS[kind]:
            circular = [np.sin(g * end + d * np.pi / 2), np.cos(g * end + d * np.pi / 2)]
            rows.append([*circular, (-1) ** d * np.exp(-g * end), np.exp(-g * (1 - end))])
    signs = np.sign(np.linalg.det(np.moveaxis(np.array(rows), 2, 0)))
    assert np.count_nonzero(np.diff(signs)) == 8


TEXTBOOK = {
    ("free", "free"): 4.730040744862704,
    ("clamped", "free"): 1.8751040687119611,
    ("clamped", "pinned"): 3.9266023120479187,
    ("clamped", "clamped"): 4.730040744862704,
    ("sliding", "clamped"): 2.365020372431352,
}


@pytest.mark.parametrize("ends", TEXTBOOK, ids="-".join)
def test_first_roots_are_the_textbook_s(ends: tuple[str, str]) -> None:
    assert float(root(ends, 1)) == pytest.approx(TEXTBOOK[ends], rel=1e-15)


def test_closed_roots() -> None:
    with mpmath.workdps(DIGITS):
        for n in (1, 2, 7):
            for ends, expected in (
                (("pinned", "pinned"), n * mpmath.pi),
                (("sliding", "sliding"), n * mpmath.pi),
                (("pinned", "sliding"), (n - mpf(1) / 2) * mpmath.pi),
            ):
                assert abs(root(ends, n) / expected - 1) < mpf(10) ** (2 - DIGITS)


def test_roots_to_any_digits_and_precision_is_left_alone() -> None:
    before = mpmath.mp.dps
    beam = comparison_beam(("free", "free"))
    coarse, fine = roots.root(beam, 3, 20), roots.root(beam, 3, 120)
    assert mpmath.mp.dps == before
    with mpmath.workdps(130):
        assert abs(coarse / fine - 1) < mpf(10) ** -20
        assert abs(mpmath.cos(fine) * mpmath.cosh(fine) - 1) < mpf(10) ** -110
        assert abs(mpmath.cos(coarse) * mpmath.cosh(coarse) - 1) > mpf(10) ** -110
    with pytest.raises(ValueError, match="index = 0"):
        roots.root(beam, 0)


@pytest.mark.parametrize("ends", PAIRS, ids="-".join)
def test_modes_meet_the_equation_and_all_four_conditions(ends: tuple[str, str]) -> None:
    """χ'''' = γ⁴ χ identically, four end conditions at 40 digits, and end values as they are listed."""
    beam = comparison_beam(ends)
    shape = beam.mode()
    assert sp.expand(shape.diff(x, 4) - gamma**4 * shape) == 0
    for d in range(4):
        assert sp.expand(shape.diff(x, d) - gamma**d * beam.mode(d)) == 0
    with mpmath.workdps(DIGITS):
        for index in (1, 4):
            largest = max(abs(value(shape, beam, index, mpf(k) / 16)) for k in range(17))
            assert largest > mpf("0.9")
            for end, kind in enumerate(ends):
                for d in range(4):
                    exact = value(beam.mode(d), beam, index, end)
                    assert abs(exact - value(beam.values[end][d], beam, index)) < mpf(10) ** -40
                    assert (abs(exact) < mpf(10) ** -40) == (d in ORDERS[kind])
            g = root(ends, index)
            assert abs(value(beam.sine, beam, index) - mpmath.sin(g)) < mpf(10) ** -40
            assert abs(value(beam.cosine, beam, index) - mpmath.cos(g)) < mpf(10) ** -40


def test_equation_22() -> None:
    """The paper's free-free mode, typed with its sinh and cosh, at 40 digits."""
    beam = comparison_beam(("free", "free"))
    with mpmath.workdps(DIGITS + 30):
        for index in (1, 2, 3, 8, 12):
            g = roots.root(beam, index, DIGITS + 30)
            factor = (mpmath.cos(g) - mpmath.cosh(g)) / (mpmath.sin(g) + mpmath.sinh(g))
            derived = sp.lambdify((gamma, x), beam.numeric(beam.mode(), index), "mpmath")
            for place in (mpf(0), mpf("0.1"), mpf(1) / 3, mpf("0.77"), mpf(1)):
                u = g * place
                printed = mpmath.sin(u) + mpmath.sinh(u) + factor * (mpmath.cos(u) + mpmath.cosh(u))
                assert abs(derived(g, place) - printed) < mpf(10) ** -40


def test_equation_21() -> None:
    assert comparison_beam(("free", "free")).equation == sp.Eq(sp.cos(gamma) * sp.cosh(gamma), 1)


@pytest.mark.parametrize("ends", PAIRS, ids="-".join)
def test_modes_are_orthogonal(ends: tuple[str, str]) -> None:
    """In mass and in bending, to each other and to the rigid functions, by quadrature."""
    beam = comparison_beam(ends)
    with mpmath.workdps(30):
        nodes = [
            ((1 + node) / 2, weight / 2)
            for node, weight in mpmath.calculus.quadrature.GaussLegendre(mpmath.mp).calc_nodes(4, mpmath.mp.prec)
        ]

        def samples(d: int) -> list[list[Any]]:
            rows = []
            for index in (1, 2, 3):
                function = sp.lambdify((gamma, x), beam.numeric(beam.mode(d), index), "mpmath")
                rows.append([function(root(ends, index), node) for node, _ in nodes])
            return rows

        rigid = [[sp.lambdify(x, f, "mpmath")(node) for node, _ in nodes] for f in beam.rigid]
        for rows in ([*rigid, *samples(0)], samples(2)):
            for (i, one), (j, other) in itertools.combinations_with_replacement(enumerate(rows), 2):
                product = sum(w * a * b for (_, w), a, b in zip(nodes, one, other, strict=True))
                assert (abs(product) < mpf(10) ** -25) == (i != j)


@pytest.mark.parametrize("ends", PAIRS, ids="-".join)
def test_rigid_functions_are_all_cubics_that_the_ends_allow(ends: tuple[str, str]) -> None:
    """As many as the kernel of the conditions on cubics is wide, and each in it."""
    functions = comparison_beam(ends).rigid
    conditions = sp.Matrix(
        [[sp.diff(x**k, x, d).subs(x, end) for k in range(4)] for end, kind in enumerate(ends) for d in ORDERS[kind]]
    )
    coefficients = sp.Matrix(
        [[sp.Poly(f, x).coeff_monomial(x**k) for k in range(4)] for f in functions] or [[0, 0, 0, 0]]
    )
    assert coefficients.rank() == len(functions) == 4 - conditions.rank()
    assert (conditions * coefficients.T).is_zero_matrix


def test_rigid_functions_of_the_free_beam() -> None:
    assert comparison_beam(("free", "free")).rigid == (1, x - sp.Rational(1, 2))
    one, other = comparison_beam(("free", "free")).rigid
    assert sp.integrate(one * other, (x, 0, 1)) == 0


@pytest.mark.parametrize("ends", list(itertools.combinations(ORDERS, 2)), ids="-".join)
def test_a_beam_turned_round_has_the_same_modes(ends: tuple[str, str]) -> None:
    beam, turned = comparison_beam(ends), comparison_beam((ends[1], ends[0]))
    with mpmath.workdps(DIGITS):
        for index in (1, 4):
            assert abs(root(ends, index) / root(turned.ends, index) - 1) < mpf(10) ** (2 - DIGITS)
            ratios = [
                value(beam.mode(), beam, index, place) / value(turned.mode(), turned, index, 1 - place)
                for place in (mpf("0.13"), mpf("0.42"), mpf("0.81"))
            ]
            assert max(abs(r / ratios[0] - 1) for r in ratios) < mpf(10) ** -40


def test_natural_orders_come_out_of_the_bending_energy() -> None:
    """Moment where the slope is free, shear force where the deflection is: what ORDERS types for free ends."""
    assert comparison.natural_orders() == {0: 3, 1: 2}
    assert {kind: tuple(sorted(comparison.end_orders(kind))) for kind in ORDERS} == ORDERS


def test_damped_eigenvalues_solve_equation_19(derived: Callable[[str], Derived]) -> None:
    """λ² + βλ + γ⁴ (1 + αλ) = 0, and Eq. (23) as printed."""
    damped = derived("free-free").damped
    assert damped is not None
    for eigenvalue in damped.eigenvalues:
        assert sp.expand(eigenvalue**2 + beta * eigenvalue + gamma**4 * (1 + alpha * eigenvalue)) == 0
    first, second = damped.eigenvalues
    assert sp.expand(first - second) != 0
    root_ = sp.sqrt((beta + alpha * gamma**4) ** 2 - 4 * gamma**4)
    printed = {sp.expand(-(beta + alpha * gamma**4) / 2 + sign * root_ / 2) for sign in (1, -1)}
    assert {sp.expand(e) for e in damped.eigenvalues} == printed
    assert sp.simplify(damped.quartic + (lambda_**2 + lambda_ * beta) / (1 + lambda_ * alpha)) == 0


def test_damped_eigenvalues_on_a_foundation(derived: Callable[[str], Derived]) -> None:
    """λ² + βλ + γ⁴ (1 + αλ) + k_w = 0: the foundation is elastic and does not damp."""
    derivation = derived("foundation")
    (k_w,) = (p.symbol for p in derivation.column.parameters)
    assert derivation.damped is not None
    for eigenvalue in derivation.damped.eigenvalues:
        assert sp.expand(eigenvalue**2 + beta * eigenvalue + gamma**4 * (1 + alpha * eigenvalue) + k_w) == 0


@pytest.mark.parametrize("ends", PAIRS, ids="-".join)
def test_section_3_1_has_four_conditions(ends: tuple[str, str]) -> None:
    steps = comparison.admissibility(comparison_beam(ends))
    assert [step.why[:2] for step in steps] == ["1)", "2)", "3)", "4)"]
    assert all(step.equation == "section 3.1" for step in steps)
    held = [
        (d, end)
        for end, kind in enumerate(ends)
        for d in {"pinned": (0,), "sliding": (1,), "clamped": (0, 1)}.get(kind, ())
    ]
    assert len(steps[0].after) == len(held)


def test_functions_that_are_not_admissible_are_found() -> None:
    """A clamped end that moves; conditions that are not self-adjoint; a shape whose derivatives leave the cycle."""
    beam = comparison_beam(("clamped", "free"))
    moving = dataclasses.replace(beam, values=((sp.S.One, *beam.values[0][1:]), beam.values[1]))
    with pytest.raises(AssertionError, match="geometric"):
        comparison.admissibility(moving)
    with pytest.raises(AssertionError, match="not admissible"):
        comparison.admissibility(dataclasses.replace(beam, orders=((0, 3), beam.orders[1])))
    sine, *rest = beam.coefficients
    with pytest.raises(AssertionError, match="not admissible"):
        comparison.admissibility(dataclasses.replace(beam, coefficients=(sine + x, *rest)))


def test_canonical_form_keeps_the_value() -> None:
    """With signs squared away and denominators made rational, on random expressions."""
    dice = random.Random(4)
    square = 2 + 2 * epsilon**4
    for _ in range(5):
        a, b, c, d = (sp.Integer(dice.randint(1, 9)) for _ in range(4))
        e = (a + b * sigma * epsilon + c * comparison.root) / (d + epsilon + sigma * comparison.root)
        for sign in (1, -1):
            numbers = {
                sigma: sign,
                epsilon: sp.Rational(1, 3),
                eta: sp.Rational(sign, 3),
            }
            numbers |= {comparison.root: sp.sqrt(square.subs(epsilon, sp.Rational(1, 3)))}
            kept = comparison.canonical(e, square).subs(numbers)
            assert abs(sp.N(kept - e.subs(numbers), 30)) < 1e-25
