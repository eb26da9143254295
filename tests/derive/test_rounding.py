"""Proven bounds of rounding: balls hold what floats compute, in any order of summation, and errors keep the bounds."""

from __future__ import annotations

import json
import random
import re
from collections.abc import Callable
from fractions import Fraction
from itertools import pairwise
from types import ModuleType
from typing import Any

import mpmath
import numpy as np
import pytest
from flint import arb

from freebeam_derive import emit, pieces, pipeline, rounding, verify
from freebeam_derive.bases import legendre, modes
from freebeam_derive.bases.segments import kernel_of
from freebeam_derive.certify.balls import precision
from freebeam_derive.kernel import Kernel
from freebeam_derive.rounding import Rounded
from tests.derive.test_segments import BEAL, EXPONENTIAL, TAPERED, TIMOSHENKO, Facts

Derived = Callable[[str], pipeline.Derived]


def pair(kernel: Kernel) -> tuple[ModuleType, ModuleType]:
    text = emit.emit(kernel)
    return verify.load(text, "floats"), rounding.instrumented(verify.load(text, "balls"))


def assert_held(floats: Any, found: Any, some: bool = True) -> None:
    balls = np.vectorize(lambda v: v.value if isinstance(v, Rounded) else arb(v), otypes=[object])(found)
    assert np.shape(floats) == balls.shape
    for number, ball in zip(np.ravel(floats), balls.ravel(), strict=True):
        assert ball.contains(arb(float(number)))
        assert ball.rad() <= 1e-11 * abs(ball) + 1e-11  # and they say something
    if some:
        assert any(ball.rad() > 0 for ball in balls.ravel())


@pytest.mark.parametrize("name", ["free-free modes", "beck modes", "sprung-tip modes", "beck legendre"])
def test_balls_hold_every_float(name: str, derived: Derived) -> None:
    """Each field of the basis and each entry, computed by NumPy, lies in the ball of the same operations."""
    column, basis = name.split()
    floats, balls = pair(derived(column).kernel(basis))
    own = {p["name"]: p["default"] for p in floats.COLUMN["parameters"]}
    with precision(rounding.BITS):
        a, b = floats.basis(12), rounding.basis(balls, 12)
        for field in a._fields:
            assert_held(getattr(a, field), getattr(b, field), some=False)
        for matrix in ("mass", "stiffness_elastic", "stiffness_load"):
            exact = getattr(balls, matrix)(b, True, **rounding.given(own))
            assert_held(getattr(floats, matrix)(a, True, **own), exact, some=matrix != "mass")


@pytest.mark.parametrize("system", [BEAL, TAPERED, TIMOSHENKO], ids=["beal", "tapered", "timoshenko"])
def test_balls_hold_every_float_on_segments(system: Any) -> None:
    floats, balls = pair(kernel_of(Facts(system.parameters), system))
    own = {p.name: float(p.default) for p in system.parameters}
    with precision(rounding.BITS):
        found = balls.stiffness_terms(rounding.basis(balls, 6), **rounding.given(own))
        for term, expected in zip(found, floats.stiffness_terms(floats.basis(6), **own), strict=True):
            assert_held(expected, term)


def test_sums_are_held_in_any_order() -> None:
    """Products of rows and columns whose terms cancel, summed forwards, backwards, in pairs and at random."""
    rng = random.Random(3)
    with precision(rounding.BITS):
        for count in (1, 2, 7, 40):
            a = [rng.uniform(-1, 1) * 10 ** rng.randrange(6) for _ in range(count)]
            b = [rng.uniform(-1, 1) for _ in range(count)]
            row = rounding.numbers(a).reshape(1, -1) @ rounding.numbers(b).reshape(-1, 1)
            ball = row[0, 0].value
            for _ in range(30):
                terms = [x * y for x, y in zip(a, b, strict=True)]
                while len(terms) > 1:
                    terms.append(terms.pop(rng.randrange(len(terms))) + terms.pop(rng.randrange(len(terms))))
                assert ball.contains(arb(terms[0]))
            exact = sum((Fraction(x) * Fraction(y) for x, y in zip(a, b, strict=True)), Fraction(0))
            assert abs(ball - arb(exact.numerator) / exact.denominator) < 1e-15 * count * sum(
                abs(x * y) for x, y in zip(a, b, strict=True)
            )


def test_what_is_known_to_the_last_bit_stays_so() -> None:
    """Of two floats there is one sum, difference, product, quotient, root; after a function of the library no more."""
    rng = random.Random(7)
    with precision(rounding.BITS):
        for a, b in ((rng.uniform(-9, 9), rng.uniform(1, 9)) for _ in range(40)):
            x, y = rounding.numbers([a, b])
            for found, expected in ((x + y, a + b), (x - y, a - b), (x * y, a * b), (x / y, a / b), (y.sqrt(), b**0.5)):
                assert found.value.is_exact() and float(found.value) == expected
            assert (0 * x).value == 0 and not y.exp().value.is_exact()
            assert (4 * y.exp()).value.rad() < 4.0001 * y.exp().value.rad()  # a power of two rounds nothing
            with pytest.raises(ArithmeticError, match="rounding may decide"):
                bool(y.exp() < float(np.exp(b)))


@pytest.mark.parametrize("name", ["free-free modes", "euler-pinned legendre"])
def test_measured_errors_keep_the_proven_bound(name: str, derived: Derived, monkeypatch: pytest.MonkeyPatch) -> None:
    """The error that the 50-digit oracle finds is below what is proven of the same entries."""
    for module, N in ((modes, "MATRIX_MODES"), (legendre, "POLYNOMIALS")):
        monkeypatch.setattr(module, N, 8)
    monkeypatch.setattr(modes, "HIGH_MODES", (12,))
    column, basis = name.split()
    kernel = derived(column).kernel(basis)
    text = emit.emit(kernel)
    of, bound = kernel.proven(text)
    assert of in kernel.bounds() and 0 < bound < 1e-13
    assert _worst(kernel, text) <= bound
    # the same in exact numbers, with digits that cancel in floats: the error grows, and the bound with it
    line = r"    (deflection_0|norm) = (.*)\n"
    cancelling = re.sub(line, r"    \1 = (\2) + 2**20 - 2**20\n", text, count=1)
    assert cancelling != text
    assert 1e-12 < _worst(kernel, cancelling) <= kernel.proven(cancelling)[1] < 1e-8


def _worst(kernel: Kernel, text: str) -> float:
    """The largest error of M, E and H that the oracle finds."""
    measured = kernel.measured(verify.load(text, "any"), print)
    with mpmath.workdps(65), precision(200):
        return max(f.error for f in measured if re.match("entries of [MEH]", f.what))


def test_more_functions_have_no_smaller_bound(derived: Derived, monkeypatch: pytest.MonkeyPatch) -> None:
    kernel, found = derived("beck").kernel("modes"), []
    for N in (2, 6, 18):
        monkeypatch.setattr(modes, "MATRIX_MODES", N)
        found.append(kernel.proven(emit.emit(kernel))[1])
    assert all(a <= b for a, b in pairwise(found))


def test_the_manifest_says_what_is_proven_and_nothing_else(monkeypatch: pytest.MonkeyPatch) -> None:
    manifest = json.loads((pipeline.tree() / "MANIFEST.json").read_text(encoding="utf-8"))
    said = [entry for entry in manifest["files"].values() if "proven" in entry]
    assert {"free-free", "beck", "euler-pinned"} <= {entry["column"] for entry in said}
    for entry in said:
        proven = entry["proven"]
        assert proven["of"] in entry["bounds"] and 0 < proven["bound"] < 1e-12
        assert "4 units in the last place" in proven["assuming"]
    monkeypatch.setattr(pieces, "MODES", 4)
    for system, known in ((TAPERED, True), (EXPONENTIAL, False)):
        kernel = kernel_of(Facts(system.parameters), system)
        assert ("proven" in pipeline._entry(kernel, emit.emit(kernel), True)) is known
        assert "proven" not in pipeline._entry(kernel, "", False)
