"""Verification finds what is wrong with a kernel: texts changed in one place each, and what is said of them."""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path
from typing import Any

import mpmath
import pytest
import sympy as sp

from freebeam_derive import emit, independent, pipeline, ritz, statement, verify
from freebeam_derive.bases import legendre, modes
from freebeam_derive.pipeline import Derived
from freebeam_derive.verify import VerificationError

Derived = Callable[[str], Derived]
Text = Callable[[str], str]


# the reference depends on the ends alone: computed once for all tampered texts
independent_mode = cache(independent.independent_mode)
products = cache(independent.Products)


@pytest.fixture(autouse=True)
def few_modes(monkeypatch: pytest.MonkeyPatch) -> None:
    """The same checks on fewer modes; the full ones run where a kernel is generated (test_pipeline.py)."""
    monkeypatch.setattr(modes, "MATRIX_MODES", 8)
    monkeypatch.setattr(modes, "EXACT_MODES", 7)
    monkeypatch.setattr(modes, "HIGH_MODES", (9,))
    monkeypatch.setattr(modes, "independent_mode", independent_mode)
    monkeypatch.setattr(modes, "Products", lambda modes, rigid: products(tuple(modes), rigid))


def function_of(text: str, name: str) -> tuple[int, int]:
    """Where the body of a function begins and ends."""
    start = text.index(f"def {name}(")
    start = text.index('"""', text.index('"""', start) + 3)
    end = text.find("\n\n\n", start)
    return start, len(text) if end < 0 else end


def changed(text: str, name: str, pattern: str, replacement: str) -> str:
    """A text with one change in a function: the pattern's last match there."""
    start, end = function_of(text, name)
    matches = list(re.finditer(pattern, text[start:end], re.MULTILINE))
    assert matches, f"{name} has no {pattern}"
    last = matches[-1]
    result = text[: start + last.start()] + last.expand(replacement) + text[start + last.end() :]
    assert result != text
    return result


TAMPERED: dict[str, tuple[str, str, str, str, tuple[str, ...]]] = {
    # case: column, function, pattern, replacement, what is said
    "a constant of H in its 13th digit": (
        "free-free",
        "stiffness_load",
        r"-0\.5 \*",
        "-0.5000000000001 *",
        ("entries of H", "row", "column"),
    ),
    "a constant of M in its 13th digit": (
        "free-free",
        "mass",
        r"0\.25 \*",
        "0.2500000000001 *",
        ("entries of M", "row"),
    ),
    "a constant of E": ("beck", "stiffness_elastic", r"0\.25 \*", "0.2500000000001 *", ("entries of E", "row")),
    "H transposed": ("beck", "stiffness_load", r"return H$", "return H.T", ("entries of H", "row", "column")),
    "the sign of H": ("beck", "stiffness_load", r"return H$", "return -H", ("entries of H", "row")),
    "one entry of H": (
        "beck",
        "stiffness_load",
        r"    return H$",
        "    H[3, 1] += 1e-11\n    return H",
        ("entries of H", "row 4, column 2"),
    ),
    "a parameter's share": ("beck", "stiffness_load", r"return H$", "return H + 1e-11 * (1 - eta)", ("entries of H",)),
    "the push of the translation": (
        "free-free",
        "stiffness_load",
        r"\(0, 1\): one",
        "(0, 1): 0 * one",
        ("entries of H", "row 1, column 2"),
    ),
    "the rotation's mass": ("free-free", "mass", r"one / 12", "one / 13", ("entries of M", "row 2, column 2")),
    "rigid and elastic parts that differ": (
        "free-free",
        "stiffness_load",
        r"return H$",
        "return H if rigid else 1.5 * H",
        ("without the rigid functions",),
    ),
    "the first mode skipped": ("free-free", "basis", r"quarter = 6 \+", "quarter = 10 +", ("first root",)),
    "the first mode of another": ("beck", "basis", r"quarter = 2 \+", "quarter = 6 +", ("first root",)),
    "a later mode skipped": (
        "free-free",
        "basis",
        r"quarter = 6 \+ 4 \* n",
        "quarter = 6 + 4 * (n + (n > 10))",
        ("neighbouring roots",),
    ),
    "a mode twice": (
        "free-free",
        "basis",
        r"quarter = 6 \+ 4 \* n",
        "quarter = 6 + 4 * (n - (n > 10))",
        ("neighbouring roots",),
    ),
    "roots without Newton's steps": ("beck", "basis", r"in range\(\d\)", "in range(0)", ("root",)),
    "one Newton step too few": ("beck", "basis", r"in range\(\d\)", "in range(1)", ("root",)),
    "a derivative's sign": (
        "free-free",
        "shapes",
        r"\(cosine, -sine\)",
        "(cosine, sine)",
        ("derivative 1", "mode"),
    ),
    "a third derivative's sign": (
        "free-free",
        "shapes",
        r"\(-cosine, sine\)",
        "(-cosine, -sine)",
        ("derivative 3", "mode"),
    ),
    "the force's place": (
        "free-free",
        "force",
        r"shapes\(basis, x_F",
        "shapes(basis, 1 - x_F",
        ("generalised force", "x_F = 0.3"),
    ),
    "dampings exchanged": (
        "free-free",
        "damping_factors",
        r"return beta, alpha",
        "return alpha, beta",
        ("entries of C", "row"),
    ),
    "the external damping halved": (
        "free-free",
        "frequencies",
        r"0\.5 \* beta",
        "0.25 * beta",
        ("eigenvalues of Eq. (23)", "beta"),
    ),
    "a power in the scales": ("beck", "scales", r"float\(EI / L\)", "float(EI / L**2)", ("scales", "SI")),
    "Newmark's limit": ("beck", "newmark_limit", r"-0\.25", "-0.2500000000001", ("largest stable Newmark step", "xi")),
    "Newmark's limit left out": ("beck", "newmark_limit", r"float\(1 / inverse\)", "np.inf", ("newmark_limit", "grow")),
    "Newmark's limit too small": (
        "beck",
        "newmark_limit",
        r"float\(1 / inverse\)",
        "float(0.5 / inverse)",
        ("newmark_limit", "stable"),
    ),
    "Newmark's weight": (
        "beck",
        "newmark_step",
        r"0\.5 - b",
        "0.25 - b",
        ("Newmark step", "two coordinates"),
    ),
}


@pytest.mark.parametrize("case", TAMPERED)
def test_tampered_kernels_are_refused(case: str, derived: Derived, text_of: Text) -> None:
    column, function, pattern, replacement, words = TAMPERED[case]
    text = changed(text_of(column), function, pattern, replacement)
    with pytest.raises(VerificationError) as caught:
        verify.verify(derived(column).kernel("modes"), text)
    message = str(caught.value)
    assert all(word in message for word in words), message
    assert "\n" not in message


@pytest.mark.parametrize("column", ["free-free", "beck", "foundation"])
def test_true_kernels_pass(column: str, derived: Derived, text_of: Text) -> None:
    """With figures for all that is promised, each within its bound, and none of them exactly nothing."""
    told: list[str] = []
    figures = verify.verify(derived(column).kernel("modes"), text_of(column), told.append)
    assert all(figure.error <= figure.bound for figure in figures)
    assert sum(figure.error > 0 for figure in figures) > len(figures) / 2
    whats = " ".join(figure.what for figure in figures)
    for part in (
        "roots",
        "derivative 0",
        "derivative 3",
        "entries of M",
        "of E",
        "of H",
        "of C",
        "force",
        "Newmark",
        "SI",
    ):
        assert part in whats
    assert told == ["roots", "modes", "matrices", "the rest"]


TABLES = """
from sympy import Symbol, sqrt

from freebeam_derive.notation import P, t, x, y
from freebeam_derive.statement import Column, Parameter, at, delta, integral

k, mu = Symbol("k", real=True), Symbol("mu", positive=True)

column = Column(
    name="tables",
    title="A column whose matrices hold every kind of table",
    T=integral((1 + mu * x) * y.diff(t) ** 2) / 2 + sqrt(mu) * at(y.diff(t), 1) ** 2 / 2,
    V=integral((1 + k**2 * x**3) * y.diff(x, 2) ** 2 + k * mu * y**2) / 2 + 3 * k * at(y, 1) ** 2 / 2,
    W_c=P * integral((1 - k * x) * y.diff(x) ** 2) / 2,
    dW_nc=-P * k * (1 - k) * at(y.diff(x), 1) * at(delta(y), 1) - P * mu / 7 * integral(x * y.diff(x) * delta(y)),
    ends=("clamped", "free"),
    parameters=(Parameter(k, "k", RANGE), Parameter(mu, "mu", 0.5, 0.1, 1)),
)
"""
BASES = statement.bases()


def stated(folder: Path, text: str) -> Derived:
    file = folder / "column.py"
    file.write_text(text, encoding="utf-8")
    return pipeline.derive(statement.load_column(file))


def altered(form: ritz.Form) -> Iterator[tuple[str, ritz.Form]]:
    """Forms with one thing changed in one of their constant tables: a constant, the order of its indices."""
    for part, factors in (("along", form.along), ("points", form.points)):
        for key, factor in factors.items():
            for term in sp.Add.make_args(factor):
                changed_ = {**factors, key: factor + term / 10**12}
                yield f"constant of {term} at {key}", dataclasses.replace(form, **{part: changed_})
            turned = (key[0], key[2], key[1]) if part == "along" else (key[2], key[3], key[0], key[1])
            if turned != key:
                others = {other: value for other, value in factors.items() if other != key}
                yield f"indices at {key}", dataclasses.replace(form, **{part: {**others, turned: factor}})


@pytest.mark.parametrize("basis", BASES)
@pytest.mark.parametrize("letter", ["M", "E", "H"])
def test_every_constant_table_is_verified(
    letter: str, basis: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A kernel that is wrong in one table, in whatever power of the parameters, is none of the statement."""
    monkeypatch.setattr(legendre, "POLYNOMIALS", 6)
    monkeypatch.setattr(verify, "_figures_rest", lambda *_: ())  # what is no matrix
    derivation = stated(tmp_path, TABLES.replace("RANGE", "0.5, 0, 1"))
    true = derivation.kernel(basis)
    verify.verify(true, emit.emit(true))
    seen = 0
    for what, form in altered(getattr(derivation.system, letter)):
        wrong = dataclasses.replace(derivation, system=dataclasses.replace(derivation.system, **{letter: form}))
        with pytest.raises(VerificationError, match=rf"\b{letter}\b"):
            verify.verify(true, emit.emit(wrong.kernel(basis)))
            raise AssertionError(f"not seen: {what}")
        seen += 1
    assert seen >= 3


@pytest.mark.parametrize("basis", BASES)
def test_a_parameter_that_a_matrix_does_not_depend_on(basis: str, derived: Derived) -> None:
    kernel = derived("foundation").kernel(basis)
    text = changed(emit.emit(kernel), "mass", r"return M$", "return M * (1 + (k_w - 100) / 10**12)")
    with pytest.raises(VerificationError, match=r"\bM\b"):
        verify.verify(kernel, text)


NEAR = {  # terms that nearly cancel, at an end of the range or throughout it
    "a softening foundation at a natural frequency": ("- k * integral(y**2) / 2", "10.0, 0.0, 9135000.0"),
    "a spring on a foundation": ("+ k * integral(y.diff(x) ** 2) / 2 - k * at(y, 1) ** 2 / 2", "10.0, 0.0, 1e6"),
    "a factor": ("+ (k - k**2 / 1000001) * at(y, 1) ** 2 / 2", "10.0, 0.0, 1e6"),
    "a factor at its default": ("+ (k - k**2 / 1000001) * at(y, 1) ** 2 / 2", "1e6, 0.0, 1e6"),
}


@pytest.mark.parametrize("case", NEAR)
@pytest.mark.parametrize("basis", BASES)
def test_sums_that_nearly_cancel_are_no_errors(
    case: str, basis: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """And a declared range decides nothing: figures with another one are the same."""
    monkeypatch.setattr(modes, "MATRIX_MODES", 20)
    monkeypatch.setattr(modes, "HIGH_MODES", (20,))
    monkeypatch.setattr(legendre, "POLYNOMIALS", 12)
    more, range_ = NEAR[case]
    plain = (
        TABLES[: TABLES.index("    T=")]
        + "    T=integral(y.diff(t) ** 2) / 2,\n"
        + f"    V=integral(y.diff(x, 2) ** 2) / 2 {more},\n"
        + "    W_c=P * integral(y.diff(x) ** 2) / 2,\n    dW_nc=0,\n"
        + '    ends=("clamped", "free"),\n    parameters=(Parameter(k, "k", RANGE),),\n)\n'
    )
    figures = []
    for given in (range_, range_.split(",")[0] + ", -1e7, 1e7"):
        kernel = stated(tmp_path, plain.replace("RANGE", given)).kernel(basis)
        figures.append(verify.verify(kernel, emit.emit(kernel)))
    assert figures[0] == figures[1]


@pytest.mark.parametrize("function", ["sqrt(1 + k**2)", "exp(-k)", "Max(k, 1)"])
def test_functions_of_a_parameter_are_verified_at_all_its_sizes(function: str, tmp_path: Path) -> None:
    """What agrees at the default, and near it, is not what was stated."""
    text = TABLES.replace("RANGE", "0.5, 0, 1").replace("import Symbol", "import Max, Symbol, exp")
    kernel = stated(tmp_path, text.replace("3 * k * at(y, 1)", f"({function}) * at(y, 1)")).kernel("modes")
    emitted = emit.emit(kernel)
    verify.verify(kernel, emitted)
    for bound in ("k if k < 1000 else 1000.0", "k if k > -0.25 else -0.25"):
        wrong = changed(emitted, "stiffness_elastic", r"    moment_0 = basis\.moment_0$", rf"\g<0>\n    k = {bound}")
        with pytest.raises(VerificationError, match=r"\bE\b"):
            verify.verify(kernel, wrong)


def test_another_statement_s_kernel_is_refused(derived: Derived, text_of: Text) -> None:
    """Beck's kernel is not Leipholz's: the forms decide, not the text."""
    with pytest.raises(VerificationError, match="entries of H"):
        verify.verify(derived("leipholz").kernel("modes"), text_of("beck"))


def test_the_closed_forms_are_not_believed(derived: Derived, text_of: Text) -> None:
    """A form changed behind the kernel's back is noticed, so the reference is computed from the forms themselves."""
    built = derived("free-free").kernel("modes")
    form = dataclasses.replace(built.system.H, points={})
    system = dataclasses.replace(built.system, H=form)
    with pytest.raises(VerificationError, match="entries of H"):
        verify.verify(dataclasses.replace(built, system=system), text_of("free-free"))
    scaled = dataclasses.replace(built.system, M=built.system.M.map(lambda f: f * (1 + sp.Rational(1, 10**12))))
    with pytest.raises(VerificationError, match="entries of M"):
        verify.verify(dataclasses.replace(built, system=scaled), text_of("free-free"))


def test_a_text_that_is_no_module_is_not_passed(derived: Derived) -> None:
    for text in ("basis = ", "", "import numpy as np\n"):
        with pytest.raises((SyntaxError, AttributeError)):
            verify.verify(derived("beck").kernel("modes"), text)


def test_error_is_an_arithmetic_error() -> None:
    assert issubclass(VerificationError, ArithmeticError)


def test_precision_is_left_alone(derived: Derived, text_of: Text) -> None:
    import mpmath

    before: Any = mpmath.mp.dps
    verify.verify(derived("beck").kernel("modes"), text_of("beck"))
    assert mpmath.mp.dps == before


def test_the_rule_of_gauss_integrates_its_degrees_exactly() -> None:
    """n nodes are exact to degree 2n − 1 and no further."""
    with mpmath.workprec(300):
        rule = independent.gauss(6, 300)
        left = [abs(mpmath.fsum(w * x**n for x, w in rule) * (n + 1) - 1) for n in range(13)]
    assert max(left[:12]) < mpmath.mpf(2) ** -280 < left[12]
