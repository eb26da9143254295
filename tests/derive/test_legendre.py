"""Polynomials as trial functions: operators, any pair of ends, emitted modules in fractions, intervals and floats."""

from __future__ import annotations

import math
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
from flint import arb, fmpq, fmpq_mat, fmpq_poly
from sympy.core.function import AppliedUndef

from freebeam_derive import emit, independent, pipeline, verify
from freebeam_derive.bases import legendre
from freebeam_derive.bases.legendre import d, k
from freebeam_derive.comparison import comparison_beam
from freebeam_derive.notation import P, alpha, beta, t, x, y
from freebeam_derive.statement import GEOMETRIC, Column, delta, integral
from freebeam_derive.verify import VerificationError

# every kind with every other, and each at either end; a mirror image differs in signs alone
PAIRS = (
    [(kind, kind) for kind in GEOMETRIC]
    + [("free", "pinned"), ("sliding", "free"), ("clamped", "free")]
    + [("pinned", "sliding"), ("clamped", "pinned"), ("sliding", "clamped")]
)
pairs = pytest.mark.parametrize("ends", PAIRS, ids="-".join)


def rational(value: Any) -> fmpq:
    """A fraction of SymPy."""
    return fmpq(int(value.p), int(value.q))


def powers(f: Any) -> fmpq_poly:
    """A polynomial of SymPy in powers of x."""
    return fmpq_poly([rational(c) for c in reversed(sp.Poly(f, x).all_coeffs())])


def along(f: fmpq_poly) -> fmpq:
    """∫ over 0 ≤ x ≤ 1."""
    return f.integral()(1)


def derivative(f: fmpq_poly, order: int) -> fmpq_poly:
    return derivative(f.derivative(), order - 1) if order else f


def polynomial(n: int) -> fmpq_poly:
    """P_n(2x − 1), by Rodrigues' formula."""
    return derivative(fmpq_poly([0, -1, 1]) ** n, n) / math.factorial(n)


def function(basis: legendre.Polynomials, degree: int) -> fmpq_poly:
    """φ_degree in powers of x."""
    series = legendre.coefficients(basis, degree)
    return sum((rational(c) * polynomial(n) for n, c in enumerate(series)), fmpq_poly([0]))


@cache
def column(ends: tuple[str, str]) -> Column:
    """A dead axial load on a beam with any ends; a load that does not turn it where it may turn rigidly."""
    turns = x in {f.diff(x) * x for f in comparison_beam(ends).rigid}
    return Column(
        name="-".join(("beam", *ends)),
        title="A beam under a dead load",
        T=integral(y.diff(t) ** 2) / 2,
        V=integral(y.diff(x, 2) ** 2) / 2,
        W_c=sp.S.Zero if turns else P * integral(x * y.diff(x) ** 2) / 2,
        dW_nc=-integral(beta * y.diff(t) * delta(y) + alpha * y.diff(x, 2, t) * delta(y.diff(x, 2)))
        + (P * integral(x * y.diff(x, 2) * delta(y)) if turns else 0),
        ends=ends,
    )


@cache
def built(ends: tuple[str, str]) -> legendre.LegendreKernel:
    return pipeline.derive(column(ends)).kernel("legendre")


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
        value = rational(sp.S(legendre.end_value(p)).subs(k, n))
        assert derivative(polynomial(n), p)(1) == value
        assert derivative(polynomial(n), p)(0) == (-1) ** (n + p) * value


@pytest.mark.parametrize("power", range(4))
def test_products_are_integrals(power: int) -> None:
    bands = legendre.products(power)
    for m, n in product(range(9), repeat=2):
        band = bands[abs(m - n)].subs(k, min(m, n)) if abs(m - n) < len(bands) else sp.S.Zero
        assert along(fmpq_poly([0, 1]) ** power * polynomial(m) * polynomial(n)) == rational(band)


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
        terms = (rational(c) * polynomial(n) for n, c in enumerate(legendre.series(f)))
        assert sum(terms, fmpq_poly([0])) == powers(f)


def test_the_emitted_derivative_is_the_derivative() -> None:
    """In exact numbers: each row of the operator against P_n differentiated."""
    emitted = module(("free", "free"))
    basis = exact(emitted, 19)
    operator = emitted._derivative(basis.order, basis.sigma)
    for n in range(21):
        row = (fmpq(c) * polynomial(m) for m, c in enumerate(operator[n]))
        assert sum(row, fmpq_poly([0])) == polynomial(n).derivative()


# --- trial functions ----------------------------------------------------------------------------------------


@pairs
def test_functions_meet_the_conditions_and_are_orthogonal(ends: tuple[str, str]) -> None:
    """Exactly, for twelve degrees; with the rigid functions, one for each dimension of what meets the conditions."""
    basis = legendre.polynomials(ends)
    held = [(end, order) for end, kind in enumerate(ends) for order in GEOMETRIC[kind]]
    degrees = range(basis.first, basis.first + 12)
    functions = [*map(powers, basis.rigid), *(function(basis, n) for n in degrees)]
    for n, f in enumerate(functions):
        assert not any(derivative(f, order)(end) for end, order in held)
        assert not any(along(f * other) for other in functions[:n])
        assert (f.degree() < degrees[0]) == (n < len(basis.rigid))
    assert len(functions) == degrees[-1] + 1 - len(held)


@pairs
def test_closed_forms_are_the_functions_own(ends: tuple[str, str]) -> None:
    basis = legendre.polynomials(ends)
    values = {(end, order): basis.value(end, order) for end in range(2) for order in range(4)}
    for n in range(basis.first, basis.first + 4):
        f = function(basis, n)
        assert rational(basis.norm.subs(d, n)) == along(f * f) > 0
        for (end, order), value in values.items():
            sign = 1 if end else (-1) ** n
            assert sign * rational(sp.S(value).subs(d, n)) == derivative(f, order)(end)


@pairs
def test_the_steps_say_what_the_functions_are(ends: tuple[str, str]) -> None:
    """The series and the square's integral that the lesson prints, in numbers, degree by degree."""
    basis = legendre.polynomials(ends)
    series, *weights = next(step for step in basis.steps if step.equation == "Eq. (9)").after
    squares = [step for step in basis.steps if isinstance(step.before, sp.Integral)]
    assert len(squares) == 2
    for step in squares:
        (phi,) = step.before.atoms(AppliedUndef)
        assert step.before == sp.Integral(phi**2, (x, 0, 1)) and step.after == basis.norm
    P = next(f.func for f in series.rhs.atoms(AppliedUndef))
    for n in range(basis.first, basis.first + 3):
        said = series.rhs.subs([(w.lhs, w.rhs) for w in weights]).subs(d, n).doit()
        said = said.replace(P, lambda m, at: sp.legendre(m, 2 * at - 1))
        assert powers(sp.expand(said)) == function(basis, n)


def test_a_free_beam_has_legendre_s_own_polynomials() -> None:
    basis = legendre.polynomials(("free", "free"))
    assert basis.first == 2 and not basis.conditions
    assert all(function(basis, n) == polynomial(n) for n in range(2, 12))


def test_a_clamped_end_leaves_jacobi_s_polynomials() -> None:
    """x² times polynomials orthogonal with the weight x⁴."""
    basis = legendre.polynomials(("clamped", "free"))
    for n in range(2, 8):
        jacobi = powers(x**2 * sp.jacobi(n - 2, 0, 4, 2 * x - 1))
        f = function(basis, n)
        assert f * jacobi[n] == jacobi * f[n]


@pairs
def test_reflection_changes_the_ends(ends: tuple[str, str]) -> None:
    one, other = legendre.polynomials(ends), legendre.polynomials((ends[1], ends[0]))
    assert sp.cancel(one.norm - other.norm) == 0
    for n in range(one.first, one.first + 6):
        mirrored = function(other, n)(fmpq_poly([1, -1]))
        assert function(one, n) == (-1) ** n * mirrored


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
    functions = independent.independent_polynomials(ends, built(ends).rigid, count)
    rigid = len(functions) - count
    basis = exact(emitted, count)
    power, turns = fmpq_poly([0, 1]), column(ends).W_c == 0
    found = {name: getattr(emitted, name)(basis, True) for name in ("mass", "stiffness_elastic", "stiffness_load")}
    for i, j in product(range(len(functions)), repeat=2):
        f, g = functions[i], functions[j]
        assert found["mass"][i, j] == (f[0] * g[0]).integral()(1)
        assert found["stiffness_elastic"][i, j] == (f[2] * g[2]).integral()(1)
        load = f[0] * g[2] if turns else f[1] * g[1]
        assert found["stiffness_load"][i, j] == -(power * load).integral()(1)
    assert all(pivot > 0 for pivot in pivots(found["mass"]))
    assert all(pivot > 0 for pivot in pivots(emitted.stiffness_elastic(basis)))
    assert not found["stiffness_elastic"][:rigid].any()


def test_columns_are_exact_and_accurate(
    name: str, derived: Callable[[str], pipeline.Derived]
) -> None:  # fmt: skip
    """The tree's columns and users' ones, as they are verified when they are emitted."""
    polynomials = derived(name).kernel("legendre")
    figures = verify.verify(polynomials, emit.emit(polynomials))
    assert {figure.bound for figure in figures if "up to N = 40" in figure.what} == {verify.BOUND}
    assert sum("entries of" in figure.what for figure in figures) == 4


def test_a_factor_that_is_no_fraction_is_verified_in_digits() -> None:
    """A user's sqrt(2) in the load's work: exact fractions cannot follow, sixty digits do."""
    stated = replace(column(("pinned", "pinned")), W_c=sp.sqrt(2) * column(("pinned", "pinned")).W_c)
    polynomials = pipeline.derive(stated).kernel("legendre")
    text = emit.emit(polynomials)
    assert verify.verify(polynomials, text)
    assert "_sqrt(2)" in text
    with pytest.raises(VerificationError):
        verify.verify(polynomials, text.replace("_sqrt(2)", "1.41421356"))


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
                    assert (arb(ball) - fmpq(fraction)).contains(0)
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
        ("lower = (1 - sigma[:, None] * sigma)", "lower = (1 + sigma[:, None] * sigma)"),  # a derivative
        ("_diagonal(1 / (2 * order + 1),", "_diagonal(1 / (2 * order + 1 + 1e-14 * order),"),  # an integral, hardly
        ("eta * basis.deflection_1[:, None] * basis.slope_1", "eta * basis.slope_1[:, None] * basis.deflection_1"),
        ("near = xp.minimum(x, 1 - x)", "near = 1 - x"),
        ("degree**2 + degree - 4)", "degree**2 + degree - 3)"),  # an end value
        ("M: Array = _diagonal(basis.norm,", "M: Array = _diagonal(basis.norm * (1 + 1e-13),"),
    ],
)
def test_a_wrong_module_is_refused(true: str, wrong: str, derived: Callable[[str], pipeline.Derived]) -> None:
    polynomials = derived("beck").kernel("legendre")
    text = emit.emit(polynomials)
    assert text.count(true) >= 1
    with pytest.raises((VerificationError, TypeError)):
        verify.verify(polynomials, text.replace(true, wrong))
