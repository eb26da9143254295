"""The kernel graph: roots, per-mode and per-pair programs, and what they cost."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from types import ModuleType, SimpleNamespace
from typing import Any

import mpmath
import numpy as np
import pytest
import sympy as sp
from mpmath import mpf

from freebeam_derive import roots
from freebeam_derive.bases import modes
from freebeam_derive.comparison import comparison_beam, epsilon, sigma
from freebeam_derive.pipeline import Derived

PAIRS = list(itertools.product(("free", "pinned", "sliding", "clamped"), repeat=2))


class Counted(np.ndarray[Any, Any]):
    """An array that counts the operations on whole matrices that it takes part in."""

    matrices = 0

    def __array_ufunc__(self, ufunc: Any, method: str, *inputs: Any, out: Any = None, **options: Any) -> Any:
        plain = [np.asarray(a) if isinstance(a, Counted) else a for a in inputs]
        if out is not None:
            options["out"] = tuple(np.asarray(a) if isinstance(a, Counted) else a for a in out)
        result = getattr(ufunc, method)(*plain, **options)
        if np.ndim(result) == 2 and min(np.shape(result)) > 1:
            Counted.matrices += 1
        return np.asarray(result).view(Counted) if np.ndim(result) else result


@pytest.mark.parametrize("matrix", ["mass", "stiffness_elastic", "stiffness_load"])
def test_at_most_forty_operations_an_entry(
    name: str, matrix: str, derived: Callable[[str], Derived], module_of: Callable[[str], ModuleType]
) -> None:
    """What NumPy is asked to do to N × N arrays, counted as it runs; the kernel's own count is not below it."""
    module, built = module_of(name), derived(name).kernel("modes")
    basis = module.basis(5)
    Counted.matrices = 0
    getattr(module, matrix)(
        type(basis)(*(np.asarray(field).view(Counted) if np.ndim(field) else field for field in basis))
    )
    (program,) = (m for m in built.matrices if m.name == matrix)
    assert Counted.matrices <= 40
    assert Counted.matrices <= program.operations + 2 <= built.operations + 2
    assert built.operations <= 40


@pytest.mark.parametrize("ends", PAIRS, ids="-".join)
def test_newton_reaches_the_last_digit(ends: tuple[str, str]) -> None:
    """Asymptote, start and number of steps, run in floats, give γ less its asymptote to its last digits."""
    beam = comparison_beam(ends)
    program = modes._roots(beam)
    symbols = (modes.delta, epsilon, sigma)
    pair = (program.function, program.derivative)
    exactly = sp.lambdify(symbols, pair, "mpmath") if program.function is not None else None
    plainly = sp.lambdify(symbols, (*pair, program.start), "math") if exactly else None
    for index in (1, 2, 3, 8, 12):
        quarter = program.first + 4 * (index - 1)
        with mpmath.workdps(50):
            asymptote = quarter * mpmath.pi / 4
            exact = roots.root(beam, index, 45) - asymptote
            if exactly is None or plainly is None:
                assert abs(exact) < mpf(10) ** -40
                continue
            values = (exact, mpmath.exp(-asymptote - exact), (-1) ** (index - 1))
            residual, slope = exactly(*values)
            assert abs(residual) < mpf(10) ** -40
            step = mpf(10) ** -20
            shifted = [exact + step, mpmath.exp(-asymptote - exact - step), (-1) ** (index - 1)]
            assert abs((exactly(*shifted)[0] - residual) / step - slope) < mpf(10) ** -15
        tail, sign = math.exp(-quarter * math.pi / 4), (-1) ** (index - 1)
        d = plainly(0.0, tail, sign)[2]
        for _ in range(program.iterations):
            value, slope, _start = plainly(d, math.exp(-quarter * math.pi / 4 - d), sign)
            d -= value / slope
        assert abs(d - float(exact)) <= 2.0**-51 * quarter * abs(float(exact)) + 1e-40


def test_coefficients_are_numbers_or_named_fields(name: str, derived: Callable[[str], Derived]) -> None:
    program = derived(name).kernel("modes").basis
    fields = {field for field, _, _ in program.fields}
    assert len(program.coefficients) == 4
    assert all(c.is_number or str(c) in fields for c in program.coefficients)
    assert len(fields) == len(program.fields)


def test_pair_programs_close_over_what_is_known(name: str, derived: Callable[[str], Derived]) -> None:
    """Each symbol of an entry is a mode's field, an earlier statement or a parameter of the column: in this order."""
    derivation = derived(name)
    built = derivation.kernel("modes")
    own = {p.name for p in derivation.column.parameters}
    for matrix in built.matrices:
        known = {"gamma", "sigma", *own, *(field for field, _, _ in built.basis.fields)}
        for statement, expression in matrix.mode_statements:
            assert {str(s) for s in expression.free_symbols} <= known
            known.add(statement)
        for statement, expression in matrix.pair_statements:
            assert {str(s).removesuffix("_i").removesuffix("_j") for s in expression.free_symbols} <= known
            known.add(statement)
        for part in (*matrix.entry, matrix.diagonal, *matrix.rows, *matrix.columns):
            assert {str(s).removesuffix("_i").removesuffix("_j") for s in part.free_symbols} <= known


def test_rigid_border_has_a_row_and_a_column_a_function(name: str, derived: Callable[[str], Derived]) -> None:
    derivation = derived(name)
    rigid = len(derivation.beam.rigid)
    for matrix in derivation.kernel("modes").matrices:
        assert (len(matrix.rows), len(matrix.columns), len(matrix.corner)) == (rigid,) * 3


def test_the_rigid_block_is_triangular(derived: Callable[[str], Derived]) -> None:
    """Free-free: the elastic rows of H do not see the rigid motion; translation is pushed by P times the rotation."""
    (H,) = (m for m in derived("free-free").kernel("modes").matrices if m.letter == "H")
    assert H.columns == (0, 0)
    assert all(row != 0 for row in H.rows)
    assert H.corner == ((0, 1), (0, 0))


@pytest.mark.parametrize("text", ["2*g**2*s", "g", "s/3", "(g + s)*g", "g + s", "sqrt(g)", "g/s", "sqrt(g + s)"])
def test_quantities_are_named_where_they_are_products_of_powers(text: str) -> None:
    """The name stands in an emitted module, so it is an identifier."""
    symbols = {name: sp.Symbol(name, positive=True) for name in "gs"}
    quantity = sp.sympify(text, locals=symbols)
    monomial = quantity.is_polynomial() and sp.Poly(quantity, *symbols.values()).is_monomial
    assert modes._name(quantity).isidentifier() if monomial else modes._name(quantity) == ""


@pytest.mark.parametrize("wrong", [(0.0, 0.0), (1e-6, 0.0), (1e-3, 0.1), (10.0, 1000.0)])
def test_eigenvalues_that_are_off_at_any_damping_are_seen(
    wrong: tuple[float, float], derived: Callable[[str], Derived], module_of: Callable[[str], ModuleType]
) -> None:
    """Eq. (23) is held against the quadratic without damping, at light and at heavy damping."""
    kernel, module = derived("beck").kernel("modes"), module_of("beck")
    roots = module.basis(8).gamma
    exact = {n: modes.independent_mode(n, float(roots[n - 1]), kernel.beam.orders) for n in range(1, 9)}

    def frequencies(gamma: Any, *given: float, **own: float) -> list[Any]:
        return [pair * (1 + 1e-9 * (given == wrong)) for pair in module.frequencies(gamma, *given, **own)]

    changed = SimpleNamespace(basis=module.basis, frequencies=frequencies)
    true, off = (modes._frequencies_figure(kernel, kernel.damped, m, exact) for m in (module, changed))
    assert true.error < true.bound < off.error == pytest.approx(1e-9, rel=1e-2)


def test_high_modes_are_held_to_the_bound_that_is_recorded(
    derived: Callable[[str], Derived], module_of: Callable[[str], ModuleType]
) -> None:
    """In units of γ 2⁻⁵³, where that is more than the bound of the first modes."""
    kernel, module, high = derived("beck").kernel("modes"), module_of("beck"), max(modes.HIGH_MODES)
    exact = modes.independent_mode(high, float(module.basis(high).gamma[-1]), kernel.beam.orders)
    (units,) = (value for what, value in kernel.bounds().items() if "2^-53" in what)
    beyond = [f for f in modes._shapes_figures(module, {high: exact}) if "beyond" in f.what]
    assert len(beyond) == 4
    for figure in beyond:
        assert 0 < figure.error < figure.bound == pytest.approx(units * 2**-53 * float(exact.gamma), rel=1e-12, abs=0)
