"""Emitted modules: text, imports and docstrings; values against quadrature by other means."""

from __future__ import annotations

import ast
import dataclasses
import hashlib
import itertools
import json
import os
import subprocess
import sys
import warnings
from collections.abc import Callable
from fractions import Fraction
from pathlib import Path
from types import ModuleType
from typing import Any

import mpmath
import numpy as np
import pytest
import sympy as sp
from flint import arb, arb_mat
from scipy.integrate import quad_vec
from scipy.linalg import eigh
from scipy.optimize import brentq

from freebeam_derive import bases, emit, roots, statement, verify
from freebeam_derive.certify import balls
from freebeam_derive.certify.beam import Beam
from freebeam_derive.emit import source
from freebeam_derive.notation import alpha, beta
from freebeam_derive.pipeline import Derived
from freebeam_derive.statement import Parameter, StatementError

Derived = Callable[[str], Derived]
Text = Callable[[str], str]
Module = Callable[[str], ModuleType]
MATRICES = ("mass", "stiffness_elastic", "stiffness_load")


# --- text ---------------------------------------------------------------------------------------------------

SCRIPT = """
import hashlib, json, sys
from freebeam_derive import emit, pipeline, statement
kernels = [pipeline.derive(statement.load_column(path)).kernel("modes") for path in sys.argv[1:]]
texts = [text for kernel in kernels for each in emit.LANGUAGES for text in emit.files(kernel, each, "any").values()]
print(json.dumps([hashlib.sha256(text.encode()).hexdigest() for text in texts]))
"""


def test_same_bytes_under_any_hash_seed(derived: Derived, statement_of: Callable[[str], Path]) -> None:
    """A fresh process, another seed, no column before it: byte for byte what this process emits, in every language."""
    names = ("foundation",)
    done = subprocess.run(
        [sys.executable, "-c", SCRIPT, *(str(statement_of(name)) for name in names)],
        env=os.environ | {"PYTHONHASHSEED": "4294967295"},
        capture_output=True,
        check=True,
        text=True,
    )
    kernels = [derived(name).kernel("modes") for name in names]
    texts = [text for kernel in kernels for each in emit.LANGUAGES for text in emit.files(kernel, each, "any").values()]
    assert json.loads(done.stdout) == [hashlib.sha256(text.encode()).hexdigest() for text in texts]


def test_imports_numpy_alone(name: str, text_of: Text) -> None:
    imported = set()
    for node in ast.walk(ast.parse(text_of(name))):
        if isinstance(node, ast.Import):
            imported |= {alias.name.split(".")[0] for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            imported.add(str(node.module).split(".")[0])
    assert imported == {"__future__", "typing", "numpy"}


def test_text_is_clean(name: str, text_of: Text) -> None:
    """Compiles without a warning, ends in one newline; no tabs, trailing spaces, paths or lines out of sight."""
    text = text_of(name)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        compile(text, name, "exec")
    assert text.endswith("\n") and not text.endswith("\n\n") and "\t" not in text and "\r" not in text
    for line in text.splitlines():
        assert line == line.rstrip()
        assert len(line) <= 120
    assert str(Path(emit.__file__).parent) not in text


@pytest.mark.parametrize("basis", statement.bases())
def test_a_basis_is_a_file_and_a_template(basis: str, derived: Derived) -> None:
    """Nothing else names it: what is there is built, emitted, told in the record and asked for by its file's name."""
    derivation = derived("beck")
    assert (Path(emit.__file__).parent / f"{basis}.py.jinja").is_file()
    module = verify.load(emit.emit(derivation.kernel(basis)), "beck")
    assert module.COLUMN["basis"] == basis == derivation.kernel(basis).basis_name
    assert {step.what for step in bases.steps(basis, derivation)} <= {step.what for step in derivation.steps}


EQUATIONS = {
    "basis": "(19)-(22)",
    "shapes": "(22)",
    "mass": "(11)",
    "stiffness_elastic": "(11)",
    "stiffness_load": "(11)",
    "damping_factors": "(12)",
    "damping": "(12)",
    "force": "(11)",
    "frequencies": "(23)",
    "newmark_step": "(10)",
    "scales": "(5)",
}


def test_docstrings_cite_the_paper_and_state_shapes(name: str, text_of: Text, derived: Derived) -> None:
    functions = {node.name: node for node in ast.parse(text_of(name)).body if isinstance(node, ast.FunctionDef)}
    column = derived(name).column
    for function, equation in EQUATIONS.items():
        if (function == "force" and not derived(name).system.forces) or (
            function == "frequencies" and derived(name).damped is None
        ):
            assert function not in functions
            continue
        doc = ast.get_docstring(functions[function]) or ""
        assert equation in doc and "Eq" in doc, function
        assert all(argument.annotation for argument in functions[function].args.args)
        assert functions[function].returns is not None
    for function, letter in zip(MATRICES, "MEH", strict=True):
        doc = ast.get_docstring(functions[function]) or ""
        assert "(N, N)" in doc and f"{letter}[i, j] = " in doc
        assert all(parameter.meaning in doc for parameter in column.parameters)


def test_a_user_s_words_come_through(text_of: Text, module_of: Module, derived: Derived) -> None:
    """Backslashes, quotes and triple quotes in a title or source are data, not syntax."""
    column = derived("sliding-free").column
    module = module_of("sliding-free")
    assert "\\" in column.title and '"""' in column.title and "\\x" in column.source
    doc = module.__dict__["__doc__"]
    assert doc is not None and " ".join(doc.split()).startswith(column.title)
    assert column.source in " ".join(doc.split())
    assert module.COLUMN["title"] == column.title and module.COLUMN["source"] == column.source


def test_what_the_runtime_must_know_is_emitted(name: str, module_of: Module, derived: Derived) -> None:
    derivation, data = derived(name), module_of(name).COLUMN
    column = derivation.column
    assert (data["name"], data["title"], data["ends"]) == (column.name, column.title, column.ends)
    assert data["rigid"] == len(derivation.beam.rigid)
    assert [p["name"] for p in data["parameters"]] == [p.name for p in column.parameters]
    for emitted, stated in zip(data["parameters"], column.parameters, strict=True):
        assert emitted["low"] <= emitted["default"] <= emitted["high"]
        assert emitted["default"] == stated.default and emitted["latex"]
    assert data["damping"] == [str(s) for s in (alpha, beta) if derivation.system.C.map(lambda f, s=s: f.coeff(s))]
    assert data["force"] == bool(derivation.system.forces) == hasattr(module_of(name), "force")


@pytest.mark.parametrize("taken", ["H", "apart", "sigma", "shapes", "c_E", "Basis"])
def test_a_parameter_named_as_something_emitted_is_refused(taken: str, derived: Derived) -> None:
    """It would hide the emitted thing, or be hidden by it."""
    built = derived("beck").kernel("modes")
    parameter = Parameter(sp.Symbol(taken, real=True), "a stiffness", 1.0, 0.0, 2.0)
    column = dataclasses.replace(built.column, parameters=(*built.column.parameters, parameter))
    with pytest.raises(StatementError, match=f"parameter '{taken}'"):
        emit.emit(dataclasses.replace(built, column=column))


# --- values -------------------------------------------------------------------------------------------------


def gauss(panels: int) -> tuple[Any, Any]:
    nodes, weights = np.polynomial.legendre.leggauss(40)
    starts = np.arange(panels)[:, None]
    return ((starts + (1 + nodes) / 2) / panels).ravel(), np.tile(weights / 2 / panels, panels)


@pytest.mark.parametrize("N", [1, 2, 7, 19])
def test_free_free_matrices_are_the_integrals_of_equation_11(N: int, module_of: Module) -> None:
    """M, E, H and Q typed, integrated by NumPy; with and without the rigid functions."""
    module = module_of("free-free")
    basis = module.basis(N)
    x, w = gauss(N + 4)
    for rigid in (False, True):
        phi, slope, bent = (module.shapes(basis, x, d, rigid=rigid) for d in range(3))
        tip = [module.shapes(basis, 1.0, d, rigid=rigid) for d in range(2)]
        size = np.concatenate([np.ones(2 if rigid else 0), basis.gamma])
        size = np.outer(size, size)
        assert np.all(np.abs(module.mass(basis, rigid) - (phi * w) @ phi.T) < 1e-13 * size)
        elastic = (bent * w) @ bent.T
        assert np.all(np.abs(module.stiffness_elastic(basis, rigid) - elastic) < 1e-12 * np.maximum(abs(elastic), size))
        load = -((slope * x * w) @ slope.T) + np.outer(tip[0], tip[1])
        assert np.all(np.abs(module.stiffness_load(basis, rigid) - load) < 1e-12 * size)
        assert np.all(module.force(basis, 0.3, rigid) == module.shapes(basis, 0.3, rigid=rigid))


def test_leipholz_by_scipy(module_of: Module) -> None:
    """H = −∫ (1 − x) φ_i' φ_j' dx + ∫ φ_i φ_j' dx, by adaptive quadrature."""
    module = module_of("leipholz")
    basis = module.basis(6)

    def integrand(place: float) -> Any:
        phi, slope = module.shapes(basis, place), module.shapes(basis, place, 1)
        return -(1 - place) * np.outer(slope, slope) + np.outer(phi, slope)

    load, _ = quad_vec(integrand, 0, 1, epsabs=1e-11, epsrel=1e-12)
    assert np.all(np.abs(module.stiffness_load(basis) - load) < 1e-11 * np.outer(basis.gamma, basis.gamma))


def test_every_column_by_quadrature_of_its_forms(name: str, module_of: Module, derived: Derived) -> None:
    """At values of the column's own parameters within their range, neither default nor an end of it."""
    module, derivation = module_of(name), derived(name)
    own = {p.name: p.low + 0.37 * (p.high - p.low) for p in derivation.column.parameters}
    symbols = {p.symbol: own[p.name] for p in derivation.column.parameters}
    basis = module.basis(7)
    x, w = gauss(10)
    shapes = [module.shapes(basis, x, d, rigid=True) for d in range(4)]
    ends = [[module.shapes(basis, float(end), d, rigid=True) for d in range(4)] for end in range(2)]
    size = np.concatenate([np.ones(len(derivation.beam.rigid)), basis.gamma])
    size = np.outer(size, size)
    system = derivation.system
    for form, found in (
        (system.M, module.mass(basis, True, **own)),
        (system.E, module.stiffness_elastic(basis, True, **own)),
        (system.H, module.stiffness_load(basis, True, **own)),
        (system.C, module.damping(basis, 0.3, 0.7, True, **own)),
    ):
        total = np.zeros_like(size)
        given = symbols | {alpha: 0.3, beta: 0.7}
        for (k, p, q), factor in form.along.items():
            total += float(factor.subs(given)) * ((shapes[p] * w * x**k) @ shapes[q].T)
        for (a, p, b, q), factor in form.points.items():
            total += float(factor.subs(given)) * np.outer(ends[int(a)][p], ends[int(b)][q])
        scale = np.maximum(np.abs(total), size) * max(1.0, *own.values(), 1.0)
        assert np.all(np.abs(found - total) < 1e-12 * scale)


def test_own_parameters_are_keywords_with_their_defaults(module_of: Module) -> None:
    module = module_of("beck")
    basis = module.basis(3)
    assert np.array_equal(module.stiffness_load(basis), module.stiffness_load(basis, eta=1.0))
    assert not np.array_equal(module.stiffness_load(basis), module.stiffness_load(basis, eta=0.0))
    dead = module.stiffness_load(basis, eta=0.0)
    assert np.allclose(dead, dead.T, atol=1e-12)
    assert np.array_equal(module.mass(basis), module.mass(basis, eta=0.3))
    with pytest.raises(TypeError):
        module.stiffness_load(basis, False, 0.3)
    with pytest.raises(TypeError):
        module.stiffness_load(basis, kappa=0.3)
    bedded = module_of("foundation")
    basis = bedded.basis(3)
    stiff = bedded.stiffness_elastic(basis, k_w=7.0) - bedded.stiffness_elastic(basis, k_w=0.0)
    assert np.allclose(stiff, 7 * bedded.mass(basis), rtol=1e-13)
    assert bedded.damping_factors(0.1, 0.5, k_w=3.0) == pytest.approx((0.5 - 0.3, 0.1))


def test_elastic_modes_are_eigenvectors(name: str, module_of: Module) -> None:
    """E = diag(γ⁴) M for modes; a foundation adds its stiffness times the mass, what is at a tip its own share."""
    module = module_of(name)
    basis = module.basis(9)
    mass, elastic = (getattr(module, which)(basis) for which in MATRICES[:2])
    if name == "sprung-tip":
        mass, elastic = module.mass(basis, mu=0.0), module.stiffness_elastic(basis, k=0.0)
        tip = np.outer(module.shapes(basis, 1.0), module.shapes(basis, 1.0))
        assert np.allclose(module.mass(basis, mu=3.0) - mass, 3 * tip, rtol=1e-13)
        assert np.allclose(module.stiffness_elastic(basis, k=3.0) - elastic, 3 * tip, atol=1e-11)
    shift = module.COLUMN["parameters"][0]["default"] if name == "foundation" else 0.0
    expected = (np.diag(basis.gamma**4) + shift * np.eye(9)) @ mass
    assert np.all(np.abs(elastic - expected) <= 1e-13 * np.abs(expected).max(axis=1, keepdims=True))


def test_shapes_take_places_of_any_shape(name: str, module_of: Module) -> None:
    module = module_of(name)
    basis, R = module.basis(4), module.COLUMN["rigid"]
    grid = np.linspace(0, 1, 6).reshape(2, 3)
    for d in range(6):
        whole = module.shapes(basis, grid, d)
        assert whole.shape == (4, 2, 3)
        assert np.array_equal(whole[:, 1, 2], module.shapes(basis, 1.0, d))
        with_rigid = module.shapes(basis, grid.tolist(), d, rigid=True)
        assert with_rigid.shape == (R + 4, 2, 3) and np.array_equal(with_rigid[R:], whole)
    assert np.allclose(module.shapes(basis, grid, 4), basis.gamma[:, None, None] ** 4 * module.shapes(basis, grid))


def test_derivatives_are_derivatives(name: str, module_of: Module) -> None:
    """By Chebyshev interpolation of each order, differentiated."""
    module = module_of(name)
    basis = module.basis(3)
    nodes = (1 + np.cos(np.pi * (np.arange(48) + 0.5) / 48)) / 2
    inside = np.linspace(0, 1, 7)
    for d in range(4):
        for n, (row, following) in enumerate(
            zip(module.shapes(basis, nodes, d, True), module.shapes(basis, inside, d + 1, True), strict=True)
        ):
            fitted = np.polynomial.Chebyshev.fit(nodes, row, 40, domain=[0, 1]).deriv()
            assert np.allclose(fitted(inside), following, atol=1e-9 * max(1.0, basis.gamma[-1] ** (d + 1))), (d, n)


def test_modes_depend_on_their_number_alone(name: str, module_of: Module) -> None:
    """The first eight of 200 are the eight: nothing is scaled by what else is computed."""
    module = module_of(name)
    few, many = module.basis(8), module.basis(200)
    for one, other in zip(few, many, strict=True):
        assert np.array_equal(one, other[:8] if np.ndim(other) else other)


def test_two_hundred_modes_without_a_warning(name: str, module_of: Module) -> None:
    """No overflow, no division by zero, no invalid value; finite everywhere, of size one along the beam."""
    module = module_of(name)
    with warnings.catch_warnings(), np.errstate(over="raise", divide="raise", invalid="raise"):
        warnings.simplefilter("error")
        basis = module.basis(200)
        for which in MATRICES:
            assert np.isfinite(getattr(module, which)(basis, True)).all()
        shapes = module.shapes(basis, np.linspace(0, 1, 401), rigid=False)
        pairs = module.frequencies(basis.gamma, 1e-3, 0.1) if hasattr(module, "frequencies") else ()
    largest = np.abs(shapes).max(axis=1)
    assert np.all((largest > 0.9) & (largest < 3))
    assert all(np.isfinite(values).all() for values in pairs)
    assert np.allclose(np.diff(basis.gamma[5:]), np.pi, atol=1e-12)


HIGH = {("free", "free"): ((2, 3), (2, 3)), ("clamped", "free"): ((0, 1), (2, 3))}


@pytest.mark.parametrize("column", ["free-free", "leipholz"])
def test_high_entries_against_quadrature(column: str, module_of: Module, derived: Derived) -> None:
    """H for modes 150 to 200 against sums of sinh and cosh at 330 digits, in balls: no table, nothing cancels."""
    module, derivation = module_of(column), derived(column)
    pairs = [(200, 199), (200, 1), (150, 200), (200, 200)]
    basis = module.basis(200)
    H = module.stiffness_load(basis)
    orders = HIGH[derivation.column.ends]
    with mpmath.workdps(330), balls.precision(1100):
        panels = 16
        rule = mpmath.calculus.quadrature.GaussLegendre(mpmath.mp).calc_nodes(5, mpmath.mp.prec)
        places = [arb((k + (1 + node) / 2) / panels) for k in range(panels) for node, _ in rule]
        weights = [arb(weight / 2 / panels) for _ in range(panels) for _, weight in rule]
        values: dict[int, Any] = {}
        for n in {n for pair in pairs for n in pair}:
            g = arb(roots.root(derivation.beam, n, 310))

            def at(place: Any, d: int, g: Any = g) -> list[Any]:
                s, c = (g * place).sin_cos()
                grow = (g * place).exp()
                sh, ch = (grow - 1 / grow) / 2, (grow + 1 / grow) / 2
                return [*((s, c), (c, -s), (-s, -c), (-c, s))[d], *((sh, ch), (ch, sh))[d % 2]]

            rows = [at(arb(end), d) for end in range(2) for d in orders[end]][:3]
            left, right = arb_mat([row[1:] for row in rows]), arb_mat([[-row[0]] for row in rows])
            factors = [arb(1), *left.solve(right).entries()]
            values[n] = [
                [g**d * sum(f * v for f, v in zip(factors, at(place, d), strict=True)) for place in (*places, arb(1))]
                for d in range(2)
            ]
        for i, j in pairs:
            (phi, slope_i), slope_j = values[i], values[j][1]
            along = zip(places, weights, phi[:-1], slope_i[:-1], slope_j[:-1], strict=True)
            if column == "free-free":
                exact = sum((-w * u * a * b for u, w, _, a, b in along), arb(0)) + phi[-1] * slope_j[-1]
            else:
                exact = sum((w * (f * b - (1 - u) * a * b) for u, w, f, a, b in along), arb(0))
            size = basis.gamma[i - 1] * basis.gamma[j - 1]
            assert abs(arb(float(H[i - 1, j - 1])) - exact) < 1e-14 * abs(exact).max(arb(size)), (i, j, exact)


def test_damped_frequencies_solve_the_quadratic(name: str, module_of: Module, derived: Derived) -> None:
    """λ² + c_M λ + γ⁴ (1 + c_E λ) = 0 for the comparison beam, light to heavy damping: Eqs. (19), (23).

    With a mass or a spring at its end the unloaded beam vibrates otherwise, and its module does not say how.
    """
    module = module_of(name)
    assert hasattr(module, "frequencies") == (name != "sprung-tip")
    if name == "sprung-tip":
        return
    gamma = module.basis(6).gamma
    used = set(derived(name).column.damping)
    shift = module.COLUMN["parameters"][0]["default"] if name == "foundation" else 0.0
    for a, b in ((0.0, 0.0), (1e-9, 0.0), (1e-3, 0.1), (10.0, 0.0), (10.0, 1e3)):
        alpha_, beta_ = a * ("alpha" in used), b * ("beta" in used)
        for value in module.frequencies(gamma, a, b):
            terms = np.array([value**2, beta_ * value, gamma**4 * (1 + 0 * value), gamma**4 * alpha_ * value])
            assert np.all(np.abs(terms.sum(axis=0) + shift) < 1e-11 * np.abs(terms).max(axis=0))


def test_a_spring_at_a_free_end_is_met_by_the_series(module_of: Module, derived: Derived) -> None:
    """Its shear force is a natural condition: frequencies fall to the exact ones, where F of the beam is zero."""
    module, k = module_of("sprung-tip"), 10.0

    def condition(g: float) -> float:
        s, c, sh, ch = np.sin(g), np.cos(g), np.sinh(g), np.cosh(g)
        share = (ch + c) / (sh + s)  # y = cosh γx − cos γx − share (sinh γx − sin γx), y'' = 0 at the tip
        return float(g**3 * ((sh - s) - share * (ch + c)) - k * ((ch - c) - share * (sh - s)))

    exact = [brentq(condition, a, b, xtol=1e-14) for a, b in ((1.9, 3.9), (3.9, 6.0), (7.0, 9.0))]
    errors = []
    for N in (5, 10, 20, 40):
        basis = module.basis(N)
        squares = eigh(module.stiffness_elastic(basis, k=k), module.mass(basis, mu=0.0), eigvals_only=True)[:3]
        errors.append(squares / np.array(exact) ** 4 - 1)
    assert np.all(np.array(errors) > 0)  # Rayleigh: from above
    assert np.all(np.array(errors[1:]) < 0.2 * np.array(errors[:-1])) and np.max(errors[-1]) < 2e-6
    polynomials = verify.load(emit.emit(derived("sprung-tip").kernel("legendre")), "sprung_tip_legendre")
    basis = polynomials.basis(14)
    squares = eigh(polynomials.stiffness_elastic(basis, k=k), polynomials.mass(basis, mu=0.0), eigvals_only=True)[:3]
    assert np.allclose(squares, np.array(exact) ** 4, rtol=1e-10)
    beam = Beam(module, {"mu": Fraction(0), "k": Fraction(10)})
    with balls.precision(100):
        for g in exact:
            signs = [beam.taylor(arb(0), arb(g**4 * f), ((0, 0),))[0, 0] for f in (1 - 1e-11, 1 + 1e-11)]
            assert signs[0] * signs[1] < 0


@pytest.mark.parametrize(
    ("stiffness", "called"),
    [("tan(k / 9)", "_tan("), ("atan(k)", "_atan("), ("Abs(k) + sinh(k)", "_sinh("), ("Max(k, 1)", "max(")],
)
def test_functions_of_a_parameter(stiffness: str, called: str, derived: Derived) -> None:
    """Whatever NumPy has is emitted, and has its value."""
    text, module = with_stiffness(sp.sympify(stiffness, {"k": K}), derived)
    assert called in text
    basis = module.basis(3)
    foundation = module.stiffness_elastic(basis, k_w=1.0, k=0.7).diagonal() / module.mass(basis).diagonal()
    expected = float(sp.sympify(stiffness).subs("k", 0.7))
    assert np.allclose(foundation - basis.gamma**4, expected, atol=1e-10)


@pytest.mark.parametrize("unknown", [sp.gamma, sp.erf, sp.Function("f")])
def test_a_function_that_kernels_do_not_have_is_refused(unknown: Any, derived: Derived) -> None:
    with pytest.raises(StatementError, match=r"in .*\(k\) is none that kernels have; write") as caught:
        with_stiffness(unknown(K), derived)
    assert "\n" not in str(caught.value)


K = sp.Symbol("k", real=True)


def with_stiffness(stiffness: Any, derived: Derived) -> tuple[str, ModuleType]:
    """The foundation's column with k_w times a function of a parameter k for its stiffness, emitted and verified."""
    derivation = derived("foundation")
    parameter = Parameter(K, "a stiffness", 1.0, 0.5, 2.0)
    column = dataclasses.replace(derivation.column, parameters=(*derivation.column.parameters, parameter))
    k_w = derivation.column.parameters[0].symbol
    form = derivation.system.E.map(lambda f: f.subs(k_w, k_w * stiffness))
    system = dataclasses.replace(derivation.system, E=form, C=form.map(lambda f: f * 0))
    text = emit.emit(dataclasses.replace(derivation, column=column, system=system, damped=None).kernel("modes"))
    return text, verify.load(text, "foundation")


def test_code_means_the_expression() -> None:
    """Products of whole powers, above and below the stroke, with any number before them."""
    a, b = sp.symbols("a b", positive=True)
    values = {"a": Fraction(3, 2), "b": Fraction(5, 7)}
    numbers = (1, -1, 60, sp.Rational(-3, 16), sp.Rational(2, 7))
    for n, m, number in itertools.product(range(-9, 10), (-5, -3, -1, 0, 1, 3), numbers):
        expression = number * a**n * b**m
        exact = Fraction(str(expression.subs({a: sp.Rational(3, 2), b: sp.Rational(5, 7)})))
        assert eval(source.code(expression), values) == pytest.approx(float(exact), rel=1e-14), expression


def test_long_lines_are_broken_and_mean_the_same(derived: Derived) -> None:
    """A factor of many terms, in a matrix, in the forms and in the equation of motion."""
    many = [sp.Symbol(f"coefficient_{n}", real=True) for n in range(12)]
    derivation = derived("foundation")
    k_w = derivation.column.parameters[0].symbol
    total = sum(s * sp.sin(s + k_w) for s in many)
    motion = dataclasses.replace(derivation.motion, equations={("y", 0): derivation.motion.strong.subs(k_w, total)})
    own = tuple(Parameter(s, "a number", n / 7, 0.0, 2.0) for n, s in enumerate(many))
    column = dataclasses.replace(derivation.column, parameters=(*derivation.column.parameters, *own))
    form = derivation.system.E.map(lambda f: f.subs(k_w, total))
    system = dataclasses.replace(derivation.system, E=form)
    text = emit.emit(dataclasses.replace(derivation, column=column, motion=motion, system=system).kernel("modes"))
    assert max(map(len, text.splitlines())) <= 120
    module = verify.load(text, "long")
    expected = float(total.subs({k_w: 100.0, **{p.symbol: p.default for p in own}}))
    basis = module.basis(3)
    assert np.allclose(
        module.stiffness_elastic(basis).diagonal(), (basis.gamma**4 + expected) * module.mass(basis).diagonal()
    )
    assert module.forms()["E"][0][0, 0, 0] == pytest.approx(expected)
    assert module.equation(1.0)[0, 0][0] == pytest.approx(expected)


def test_shapes_of_nothing(name: str, module_of: Module, derived: Derived) -> None:
    """No places: no values, of the right shape, in both bases."""
    polynomials = verify.load(emit.emit(derived(name).kernel("legendre")), "polynomials") if name == "beck" else None
    for module in filter(None, (module_of(name), polynomials)):
        for places, shape in (([], (0,)), (np.zeros((2, 0)), (2, 0))):
            for rigid in (False, True):
                found = module.shapes(module.basis(4), places, 1, rigid)
                assert found.shape == (4 + rigid * module.COLUMN["rigid"], *shape)


def test_load_without_a_file(text_of: Text) -> None:
    """verify.load makes a module of a text, and leaves no trace among the imported ones."""
    module = verify.load(text_of("beck"), "beck")
    assert module.basis(1).gamma[0] == pytest.approx(1.8751040687119611, rel=1e-15)
    assert not any("beck" in loaded and "emitted" in loaded for loaded in sys.modules)


def test_code_of_constants_that_are_no_fractions() -> None:
    a = sp.Symbol("a")
    for constant in (sp.E, sp.pi, sp.exp(1) * a / 3, sp.exp(sp.Rational(-1, 2)) - sp.pi * a):
        found = eval(source.code(constant), {"a": 0.7, "_exp": np.exp, "np": np})
        assert found == pytest.approx(float(constant.subs(a, 0.7)), rel=1e-14)


def test_roots_of_numbers_are_of_the_caller_s_kind() -> None:
    """√2 and a fraction are taken of `one`, in as many digits as that has."""

    def root(number: Any) -> Any:
        assert isinstance(number, mpmath.mpf)  # of a number of Python's it would be a float
        return mpmath.sqrt(number)

    a = sp.Symbol("a")
    with mpmath.workdps(50):
        given = {"a": mpmath.mpf(3), "one": mpmath.mpf(1), "_sqrt": root}
        for expression in (sp.sqrt(2) * a, a**2 + sp.sqrt(sp.Rational(3, 7)), sp.Rational(1, 3) + 1 / sp.sqrt(5)):
            found = eval(source.exact(expression), given)
            assert abs(found - mpmath.mpf(str(expression.subs(a, 3).evalf(50)))) < 1e-45
