"""M, C, K, Q against the principle itself, for trial functions that are no modes of anything. Eqs. (9)-(13)."""

from __future__ import annotations

import dataclasses
import random
from collections.abc import Callable
from typing import Any

import pytest
import sympy as sp

from freebeam_derive import ritz, variation
from freebeam_derive.notation import F_0, P, alpha, beta, t, x, x_F, y
from freebeam_derive.pipeline import Derived
from freebeam_derive.ritz import Form
from freebeam_derive.statement import GEOMETRIC, StatementError, at, delta, integral

Derived = Callable[[str], Derived]
ONE, HALF = sp.S.One, sp.Rational(1, 2)


def entry(form: Form, test: Any, trial: Any, values: dict[Any, Any]) -> Any:
    """One entry of a bilinear form by exact integration."""
    total = sp.S.Zero
    for (k, p, q), factor in form.along.items():
        product = sp.Poly(x**k * test.diff(x, p) * trial.diff(x, q), x)
        total += factor.xreplace(values) * product.integrate().eval(1)
    for (a, p, b, q), factor in form.points.items():
        total += factor.xreplace(values) * test.diff(x, p).subs(x, a) * trial.diff(x, q).subs(x, b)
    return sp.expand(total)


def functions(dice: random.Random, ends: tuple[str, str]) -> list[Any]:
    """Two polynomials that meet the geometric conditions."""
    factor = ONE
    for place, kind in zip((x, 1 - x), ends, strict=True):
        factor *= place ** (max(GEOMETRIC[kind], default=-1) + 1)
    return [sp.expand(factor * sum(dice.randint(-5, 5) * x**n for n in range(3)) + factor * x) for _ in range(2)]


def numbers(dice: random.Random, derivation: Derived) -> dict[Any, Any]:
    symbols = (P, alpha, beta, x_F, *(p.symbol for p in derivation.column.parameters))
    return {s: sp.Rational(dice.randint(1, 9), 10) for s in symbols}


def test_equations_of_the_coordinates_are_the_principle(unlike: str, derived: Derived, principle: Any) -> None:
    """Eqs. (9)-(11): for y = Σ φ_j q_j and δy = φ_i the principle gives row i of M q̈ + C q̇ + K q − F_0 Q, exactly.

    The trial functions are not orthogonal and meet no natural condition; H is not symmetric.
    """
    dice, derivation = random.Random(unlike), derived(unlike)
    system, values, force = derivation.system, numbers(dice, derivation), sp.Rational(5, 3)
    phi = functions(dice, derivation.column.ends)
    q = [sum(sp.Rational(dice.randint(1, 9), 4) * t**n for n in range(3)) for _ in phi]
    now = sp.Rational(2, 3)
    for test in phi:
        work = principle(derivation.column, sum(f * c for f, c in zip(phi, q, strict=True)), test, values, now, force)
        row = sp.S.Zero
        for trial, c in zip(phi, q, strict=True):
            for rate, form in enumerate((system.K, system.C, system.M)):
                row += entry(form, test, trial, values) * c.diff(t, rate).subs(t, now)
        row -= sum(force * size * test.subs(x, values[place]) for place, size in system.forces)
        assert sp.expand(row - work) == 0


def test_equation_11(derived: Derived) -> None:
    """The paper's third line with its end term put right: the row belongs to the test function."""
    system = derived("free-free").system
    assert system.M == Form({(0, 0, 0): ONE})
    assert system.E == Form({(0, 2, 2): ONE})
    assert system.C == Form({(0, 0, 0): beta, (0, 2, 2): alpha})
    assert system.K == Form({(0, 2, 2): ONE, (1, 1, 1): -P}, {(ONE, 0, ONE, 1): P})
    assert system.forces == ((x_F, ONE),)


def test_equation_11_as_printed_is_the_transpose(derived: Derived) -> None:
    """Same M, C and E; H transposed, and H is not symmetric: docs/errata.md."""
    system = derived("free-free").system
    printed = Form({(1, 1, 1): -ONE}, {(ONE, 1, ONE, 0): ONE})
    assert system.H.transposed == printed and system.H != printed
    assert not system.H.symmetric
    assert system.M.symmetric and system.C.symmetric and system.E.symmetric
    dice = random.Random(3)
    one, other = functions(dice, ("free", "free"))
    assert entry(printed, one, other, {}) == entry(system.H, other, one, {}) != entry(system.H, one, other, {})


@pytest.mark.parametrize(("column", "symmetric"), [("euler-pinned", True), ("foundation", True), ("leipholz", False)])
def test_dead_loads_have_a_potential_and_followers_none(column: str, symmetric: bool, derived: Derived) -> None:
    """Of H as a form: as numbers too, on functions that meet the geometric conditions."""
    derivation = derived(column)
    one, other = functions(random.Random(2), derivation.column.ends)
    H = derivation.system.H
    assert (entry(H, one, other, {}) == entry(H, other, one, {})) is symmetric


def test_beck_under_a_dead_load_has_a_potential(derived: Derived) -> None:
    derivation = derived("beck")
    (eta,) = (p.symbol for p in derivation.column.parameters)
    assert derivation.system.H.map(lambda f: f.subs(eta, 0)).symmetric
    assert not derivation.system.H.map(lambda f: f.subs(eta, 1)).symmetric


def test_equations_12_and_13(name: str, derived: Derived) -> None:
    """C = c_M M + c_E (K − K^G) with K^G = P H, on numbers; the load does not damp."""
    dice, derivation = random.Random(name), derived(name)
    system, values = derivation.system, numbers(dice, derivation)
    geometric = system.H.map(lambda f: P * f)
    c_M, c_E = (sp.nsimplify(c.xreplace(values), rational=True) for c in (system.c_M, system.c_E))
    for test in functions(dice, derivation.column.ends):
        for trial in functions(dice, derivation.column.ends):
            M, C, K, G, E = (
                entry(form, test, trial, values) for form in (system.M, system.C, system.K, geometric, system.E)
            )
            assert sp.expand(C - c_M * M - c_E * (K - G)) == 0
            assert sp.expand(K - G - E) == 0
    assert not system.C.map(lambda f: f.coeff(P)) and system.K.map(lambda f: f.coeff(P)) == system.H


@pytest.mark.parametrize("name", ["free-free", "beck", "euler-pinned", "leipholz"])
def test_damping_factors_are_the_paper_s(name: str, derived: Derived) -> None:
    system = derived(name).system
    assert (system.c_M, system.c_E) == (beta, alpha)


def test_a_foundation_shifts_the_external_damping(derived: Derived) -> None:
    """E holds the foundation, which internal damping does not reach: c_M = beta − alpha k_w."""
    derivation = derived("foundation")
    (k_w,) = (p.symbol for p in derivation.column.parameters)
    assert sp.expand(derivation.system.c_M - beta + alpha * k_w) == 0
    assert derivation.system.c_E == alpha


def test_without_damping_there_is_none(derived: Derived) -> None:
    system = derived("hauger").system
    assert not system.C and (system.c_M, system.c_E) == (0, 0)
    assert not system.forces


@pytest.mark.parametrize(
    ("extra", "shown"),
    [
        (-alpha * at(y.diff(t), 1) * at(delta(y), 1), "alpha φᵢ(1) φⱼ(1)"),
        (-beta * integral(x * y.diff(t) * delta(y)), "beta ∫ x φᵢ φⱼ dx"),
        (-beta * integral(y.diff(x, t) * delta(y.diff(x))), "beta ∫ φᵢ′ φⱼ′ dx"),
        (-integral(y.diff(x, t) * delta(y)), "∫ φᵢ φⱼ′ dx"),
    ],
)
def test_damping_that_is_not_proportional_is_refused(extra: Any, shown: str, derived: Derived) -> None:
    """A dashpot at the tip, damping that varies along the beam, a gyroscopic term: outside Eq. (12), and it is said."""
    column = derived("beck").column
    other = dataclasses.replace(column, dW_nc=column.dW_nc + extra, dimensional=None)
    with pytest.raises(StatementError) as caught:
        ritz.derive(variation.derive_column(other))
    assert shown in str(caught.value) and "Eq. (12)" in str(caught.value) and "\n" not in str(caught.value)


def test_forms_add_scale_and_transpose() -> None:
    one = Form({(0, 1, 2): ONE, (1, 0, 0): HALF}, {(ONE, 0, ONE, 1): P})
    assert one + one.map(lambda f: -f) == Form()
    assert not Form() and one
    assert one + one == one.map(lambda f: 2 * f)
    assert one.transposed.transposed == one != one.transposed


def test_form_in_words_is_the_form(derived: Derived) -> None:
    """The line in docstrings, read back: each term's sign, power and primes."""
    form = Form({(1, 1, 1): -ONE, (0, 2, 2): HALF, (3, 3, 0): P + 1}, {(ONE, 0, sp.S.Zero, 1): -ONE})
    assert ritz.display_form(form) == ("1/2 ∫ φᵢ″ φⱼ″ dx − ∫ x φᵢ′ φⱼ′ dx + (P + 1) ∫ x³ φᵢ‴ φⱼ dx − φᵢ(1) φⱼ′(0)")


def test_expression_is_the_form(derived: Derived) -> None:
    """Eq. (11) as SymPy, evaluated on polynomials, equals the entry of the form."""
    form = derived("free-free").system.K
    one, other = functions(random.Random(8), ("free", "free"))
    written = form.expression
    for phi, given in ((ritz.phi_i, one), (ritz.phi_j, other)):
        written = written.replace(phi.func, lambda place, g=given: g.subs(x, place))
    written = written.doit()
    assert sp.expand(written - entry(form, one, other, {})) == 0


def test_the_force_enters_through_q_alone(derived: Derived) -> None:
    system = derived("free-free").system
    assert not any(form.map(lambda f: f.coeff(F_0)) for form in (system.M, system.C, system.K))
