"""Polynomials as trial functions: operators, any pair of ends, emitted modules in fractions, intervals and floats."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache
from itertools import product
from types import ModuleType
from typing import Any

import flint
import numpy as np
import pytest
import sympy as sp
from flint import arb, fmpq, fmpq_mat

from freebeam_derive import emit, kernel, legendre, pipeline, ritz, variation, verify
from freebeam_derive.legendre import d, k
from freebeam_derive.notation import P, alpha, beta, t, x, y
from freebeam_derive.statement import GEOMETRIC, Column, delta, integral
from freebeam_derive.verify import VerificationError

PAIRS = list(product(GEOMETRIC, repeat=2))
pairs = pytest.mark.parametrize("ends", PAIRS, ids="-".join)


def along(f: Any) -> Any:
    """∫ over 0 ≤ x ≤ 1."""
    return sum(c / (n + 1) for (n,), c in sp.Poly(f, x).terms())


@cache
def polynomial(n: int) -> Any:
    """P_n(2x − 1), by Rodrigues' formula."""
    return sp.expand(sp.diff((x * (x - 1)) ** n, x, n) / sp.factorial(n))


def function(basis: legendre.Polynomials, degree: int) -> Any:
    """φ_degree in powers of x."""
    return sp.expand(sum(c * polynomial(n) for n, c in enumerate(legendre.coefficients(basis, degree))))


@cache
def column(ends: tuple[str, str]) -> Column:
    """A dead axial load on a beam with any ends."""
    return Column(
        name="-".join(("beam", *ends)),
        title="A beam under a dead load",
        T=integral(y.diff(t) ** 2) / 2,
        V=integral(y.diff(x, 2) ** 2) / 2,
        W_c=P * integral(x * y.diff(x) ** 2) / 2,
        dW_nc=-integral(beta * y.diff(t) * delta(y) + alpha * y.diff(x, 2, t) * delta(y.diff(x, 2))),
        ends=ends,
    )


@cache
def built(ends: tuple[str, str]) -> kernel.PolynomialKernel:
    motion = variation.derive_column(column(ends))
    return kernel.build_polynomials(column(ends), motion, ritz.derive(motion), pipeline.newmark_method())


@cache
def module(ends: tuple[str, str]) -> ModuleType:
    return verify.load(emit.emit(built(ends)), "polynomials")


def exact(emitted: ModuleType, count: int, number: Callable[[int], Any] = fmpq) -> Any:
    """The emitted basis in exact numbers (or in intervals)."""
    orders = np.empty(len(emitted.basis(count).order), dtype=object)
    orders[:] = [number(n) for n in range(len(orders))]
    return emitted.complete(orders, np.array([(-1) ** n for n in range(len(orders))]))


def pivots(matrix: Any) -> list[fmpq]:
    """Those of the exact elimination without exchange, all positive where a symmetric matrix is positive definite."""
    minors = [fmpq_mat([[matrix[i, j] for j in range(n)] for i in range(n)]).det() for n in range(1, len(matrix) + 1)]
    return [b / a for a, b in zip([fmpq(1), *minors], minors, strict=False)]


# --- operators ----------------------------------------------------------------------------------------------


def test_end_values_are_those_of_the_polynomials() -> None:
    for n, p in product(range(9), range(5)):
        value = legendre.end_value(p).subs(k, n) if p else 1
        assert polynomial(n).diff(x, p).subs(x, 1) == value
        assert polynomial(n).diff(x, p).subs(x, 0) == (-1) ** (n + p) * value


@pytest.mark.parametrize("power", range(4))
def test_products_are_integrals(power: int) -> None:
    bands = legendre.products(power)
    for m, n in product(range(7), repeat=2):
        band = bands[abs(m - n)].subs(k, min(m, n)) if abs(m - n) < len(bands) else 0
        assert along(x**power * polynomial(m) * polynomial(n)) == band


def test_sums_are_sums() -> None:
    for term in (sp.S.One, k**3, (2 * k + 1) * k**2 * (k + 1) ** 2):
        for n in range(8):
            assert legendre.summed(term).subs(d, n) == sum(term.subs(k, m) for m in range(n))
    odd = sp.expand((2 * k + 1) * k * (k + 1))
    for n in range(8):
        assert legendre.summed(odd, True).subs(d, n) == sum((-1) ** (n + m) * odd.subs(k, m) for m in range(n))
    with pytest.raises(AssertionError, match="no polynomial"):
        legendre.summed(k, True)


def test_a_series_is_its_polynomial() -> None:
    for f in (sp.S.One, x - sp.Rational(1, 2), x**3 - 2 * x):
        assert sp.expand(sum(c * polynomial(n) for n, c in enumerate(legendre.series(f))) - f) == 0


def test_the_emitted_derivative_is_the_derivative() -> None:
    """In exact numbers, to the seventh order and degree 12: P_n′ by differentiation against one row of the operator."""
    emitted = module(("free", "free"))
    basis = exact(emitted, 11)
    operator = emitted._derivative(basis.order, basis.sigma)
    for n in range(13):
        found = sum(sp.Rational(int(c.p), int(c.q)) * polynomial(m) for m, c in enumerate(map(fmpq, operator[n])))
        assert sp.expand(found - polynomial(n).diff(x)) == 0


# --- trial functions ----------------------------------------------------------------------------------------


@pairs
def test_functions_meet_the_conditions_and_are_orthogonal(ends: tuple[str, str]) -> None:
    """Exactly, for eight degrees; with the rigid functions, one for each dimension of what meets the conditions."""
    basis = legendre.polynomials(ends)
    held = [(end, order) for end, kind in enumerate(ends) for order in GEOMETRIC[kind]]
    degrees = range(basis.first, basis.first + 8)
    functions = [*basis.rigid, *(function(basis, n) for n in degrees)]
    for n, f in enumerate(functions):
        assert all(f.diff(x, order).subs(x, end) == 0 for end, order in held)
        assert all(along(f * other) == 0 for other in functions[:n])
        assert sp.Poly(f, x).degree() < degrees[0] if n < len(basis.rigid) else True
    assert len(functions) == degrees[-1] + 1 - len(held)


@pairs
def test_closed_forms_are_the_functions_own(ends: tuple[str, str]) -> None:
    basis = legendre.polynomials(ends)
    for n in range(basis.first, basis.first + 4):
        f = function(basis, n)
        assert basis.norm.subs(d, n) == along(f**2) > 0
        for order in range(4):
            assert basis.value(1, order).subs(d, n) == f.diff(x, order).subs(x, 1)
            assert (-1) ** n * basis.value(0, order).subs(d, n) == f.diff(x, order).subs(x, 0)


def test_a_free_beam_has_legendre_s_own_polynomials() -> None:
    basis = legendre.polynomials(("free", "free"))
    assert basis.first == 2 and not basis.conditions
    assert all(function(basis, n) == polynomial(n) for n in range(2, 8))


def test_a_clamped_end_leaves_jacobi_s_polynomials() -> None:
    """x² times polynomials orthogonal with the weight x⁴."""
    basis = legendre.polynomials(("clamped", "free"))
    for n in range(2, 8):
        jacobi = sp.jacobi(n - 2, 0, 4, 2 * x - 1)
        ratio = sp.cancel(function(basis, n) / sp.expand(x**2 * jacobi))
        assert ratio.is_number and ratio != 0


@pairs
def test_reflection_changes_the_ends(ends: tuple[str, str]) -> None:
    one, other = legendre.polynomials(ends), legendre.polynomials((ends[1], ends[0]))
    assert sp.cancel(one.norm - other.norm) == 0
    for n in range(one.first, one.first + 4):
        mirrored = sp.expand(function(other, n).subs(x, 1 - x))
        assert sp.expand(function(one, n) - (-1) ** n * mirrored) == 0


@pairs
def test_the_four_conditions_of_section_3_1_are_recorded(ends: tuple[str, str]) -> None:
    basis = legendre.polynomials(ends)
    listed = [step.why[:2] for step in basis.steps if step.equation == "section 3.1"]
    assert listed == ["1)", "2)", "3)", "4)"]


def test_what_is_not_admissible_is_refused() -> None:
    sound = legendre.polynomials(("clamped", "free"))
    heavier = replace(sound.conditions[0], weight=2 * sound.conditions[0].weight)
    for unsound, why in (
        (replace(sound, conditions=(heavier, sound.conditions[1])), "geometric"),
        (replace(sound, first=3), "span"),
        (replace(sound, norm=-sound.norm), "mass"),
    ):
        with pytest.raises(AssertionError, match=why):
            legendre.admissibility(unsound)
    assert legendre.admissibility(sound)


# --- emitted modules ----------------------------------------------------------------------------------------


@pairs
def test_modules_are_exact_in_fractions(ends: tuple[str, str]) -> None:
    """M, E, H of every pair of ends against integrals in powers of x; M and E positive definite by exact pivots."""
    count, emitted = 9, module(ends)
    functions = verify.independent_polynomials(built(ends), count)
    rigid = len(functions) - count
    basis = exact(emitted, count)
    power = flint.fmpq_poly([0, 1])
    found = {name: getattr(emitted, name)(basis, True) for name in ("mass", "stiffness_elastic", "stiffness_load")}
    for i, j in product(range(len(functions)), repeat=2):
        f, g = functions[i], functions[j]
        assert found["mass"][i, j] == (f[0] * g[0]).integral()(1)
        assert found["stiffness_elastic"][i, j] == (f[2] * g[2]).integral()(1)
        assert found["stiffness_load"][i, j] == -(power * f[1] * g[1]).integral()(1)
    assert all(pivot > 0 for pivot in pivots(found["mass"]))
    assert all(pivot > 0 for pivot in pivots(emitted.stiffness_elastic(basis)))
    assert not found["stiffness_elastic"][:rigid].any()


def test_columns_are_exact_and_accurate(
    name: str, derived: Callable[[str], pipeline.Derivation]
) -> None:  # fmt: skip
    """The tree's columns and users' ones, as they are verified when they are emitted."""
    polynomials = derived(name).polynomials
    figures = verify.verify(polynomials, emit.emit(polynomials))
    assert {figure.bound for figure in figures if "up to N = 40" in figure.what} == {verify.SERIES_BOUND}
    assert sum("entries of" in figure.what for figure in figures) == 4


def test_modules_work_on_intervals() -> None:
    """Arb balls hold what fractions say, at any precision."""
    before = flint.ctx.prec
    try:
        flint.ctx.prec = 300
        for ends in (("clamped", "free"), ("sliding", "clamped")):
            emitted = module(ends)
            balls, fractions = exact(emitted, 12, arb), exact(emitted, 12)
            for name in ("mass", "stiffness_elastic", "stiffness_load"):
                wide, sharp = (getattr(emitted, name)(basis) for basis in (balls, fractions))
                for ball, fraction in zip(wide.flat, sharp.flat, strict=True):
                    assert arb(ball).contains(fmpq(fraction))
                    assert arb(ball).rad() < arb(10) ** -70
    finally:
        flint.ctx.prec = before


def test_a_module_for_more_functions_begins_with_that_for_fewer() -> None:
    emitted = module(("sliding", "pinned"))
    few, many = (emitted.stiffness_load(exact(emitted, count)) for count in (5, 9))
    assert (few == many[:5, :5]).all()


@pytest.mark.parametrize(
    ("true", "wrong"),
    [
        ("weight_1 = (-2 * degree - 4)", "weight_1 = (-2 * degree - 5)"),  # a condition missed
        ("np.tril((1 - sigma[:, None] * sigma)", "np.tril((1 + sigma[:, None] * sigma)"),  # a derivative
        ("np.diag(1 / (2 * order + 1))", "np.diag(1 / (2 * order + 1 + 1e-14 * order))"),  # an integral, hardly
        ("eta * basis.deflection_1[:, None] * basis.slope_1", "eta * basis.slope_1[:, None] * basis.deflection_1"),
        ("near = np.minimum(x, 1 - x)", "near = 1 - x"),
        ("degree**2 + degree - 4)", "degree**2 + degree - 3)"),  # an end value
        ("M: Array = np.diag(basis.norm)", "M: Array = np.diag(basis.norm * (1 + 1e-13))"),
    ],
)
def test_a_wrong_module_is_refused(true: str, wrong: str, derived: Callable[[str], pipeline.Derivation]) -> None:
    polynomials = derived("beck").polynomials
    text = emit.emit(polynomials)
    assert text.count(true) >= 1
    with pytest.raises((VerificationError, TypeError)):
        verify.verify(polynomials, text.replace(true, wrong))
