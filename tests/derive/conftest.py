"""What the tests of the derivation share: columns derived once, and the principle evaluated on given motions."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cache
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
import sympy as sp

from freebeam_derive import emit, pipeline, statement, verify
from freebeam_derive.notation import F_0, t, variation_of_y, x, y
from freebeam_derive.statement import Column

OWN = Path(__file__).parent / "columns"  # columns that the tree does not hold, as a user states them
# Leipholz's adds nothing to Hauger's but its dimensions, its force and its damping: the tests that want these name it.
NAMES = (*statement.columns(), *sorted({path.stem.replace("_", "-") for path in OWN.glob("[a-z]*.py")} - {"leipholz"}))
UNLIKE = ("free-free", "foundation", "sliding-free", "sprung-tip")  # between them every term that a statement may have


def file_of(name: str) -> Path:
    return {**statement.columns(), **{path.stem.replace("_", "-"): path for path in OWN.glob("[a-z]*.py")}}[name]


@cache
def derive(name: str) -> pipeline.Derived:
    return pipeline.derive(statement.load_column(file_of(name)))


@cache
def emitted_text(name: str) -> str:
    return emit.emit(derive(name).kernel("modes"))


@cache
def emitted_module(name: str) -> ModuleType:
    return verify.load(emitted_text(name), name.replace("-", "_"))


@pytest.fixture(params=NAMES)
def name(request: pytest.FixtureRequest) -> str:
    """Each column in turn, the tree's and the users'."""
    return str(request.param)


@pytest.fixture(params=UNLIKE)
def unlike(request: pytest.FixtureRequest) -> str:
    """Some columns that have little in common, for what takes long."""
    return str(request.param)


@pytest.fixture
def derived() -> Callable[[str], pipeline.Derived]:
    return derive


@pytest.fixture
def text_of() -> Callable[[str], str]:
    return emitted_text


@pytest.fixture
def module_of() -> Callable[[str], ModuleType]:
    return emitted_module


@pytest.fixture
def statement_of() -> Callable[[str], Path]:
    return file_of


def evaluated(expression: Any, motion: Any, virtual: Any) -> Any:
    """A statement's expression at a given motion and virtual displacement, polynomials both; integrals done exactly."""
    for field, given in ((y.func, motion), (variation_of_y.func, virtual)):
        expression = expression.replace(field, lambda place, time, g=given: g.subs({x: place, t: time}))
    expression = expression.replace(lambda e: isinstance(e, sp.Derivative | sp.Subs), lambda e: e.doit())
    return sp.expand(expression.replace(sp.Integral, lambda f, limits: integral(f, limits[2])))


def integral(polynomial: Any, length: Any = sp.S.One) -> Any:
    """∫ of a polynomial over 0 ≤ x ≤ length."""
    terms = sp.Poly(sp.expand(polynomial), x).terms()
    return sp.expand(sum(c * length ** (n + 1) / (n + 1) for (n,), c in terms))


def virtual_work(
    column: Column, motion: Any, virtual: Any, values: Mapping[Any, Any], time: Any, force: Any = sp.S.Zero
) -> Any:
    """Virtual work of inertia, stiffness and damping less that of the forces: Lagrange's form of the principle.

    motion: polynomial in x and t. virtual: polynomial in x. values: numbers for parameters. The program's variation
    is not used: energies are quadratic, so [E(u + δu) − E(u − δu)] / 2 is their variation.
    """
    stated = {
        name: sp.nsimplify(getattr(column, name), rational=True).xreplace({**values, F_0: force})
        for name in ("T", "V", "W_c", "dW_nc")
    }
    shape, pushed = motion.subs(t, time), motion.diff(t, 2).subs(t, time)

    def varied(energy: Any, u: Any, du: Any) -> Any:
        return (evaluated(energy, u + du, sp.S.Zero) - evaluated(energy, u - du, sp.S.Zero)) / 2

    # T is a quadratic form of the rates, the time derivative of its momentum that of the accelerations
    inertia = varied(stated["T"], pushed * t, virtual * t)
    stiffness = varied(stated["V"] - stated["W_c"], shape, virtual)
    return sp.expand(inertia + stiffness - evaluated(stated["dW_nc"], motion, virtual).subs(t, time))


@pytest.fixture
def principle() -> Callable[..., Any]:
    return virtual_work


@pytest.fixture
def evaluate() -> Callable[..., Any]:
    return evaluated


@pytest.fixture
def integrate() -> Callable[..., Any]:
    return integral
