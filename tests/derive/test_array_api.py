"""Emitted functions on arrays of other libraries: the strict array API, JAX and PyTorch where they are installed."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator
from fractions import Fraction
from functools import cache
from types import ModuleType
from typing import Any

import flint
import numpy as np
import pytest

from freebeam_derive import emit, verify
from freebeam_derive.certify import balls
from freebeam_derive.pipeline import Derivation

Derived = Callable[[str], Derivation]
COLUMNS = ("free-free", "sprung-tip")
MODES = 5
LIBRARIES = ("array_api_strict", "jax.numpy", "torch")


@pytest.fixture(params=LIBRARIES)
def xp(request: pytest.FixtureRequest) -> Iterator[Any]:
    """A namespace, with double precision where that must be asked for."""
    library = pytest.importorskip(request.param)
    with contextlib.ExitStack() as stack:
        if request.param == "jax.numpy":
            import jax

            stack.enter_context(jax.enable_x64(True))
        yield library


@pytest.fixture
def kernels(derived: Derived) -> Callable[[str, str], ModuleType]:
    return lambda name, basis: emitted(derived, name, basis)


@cache
def emitted(derived: Derived, name: str, basis: str) -> ModuleType:
    derivation = derived(name)
    built = derivation.kernel if basis == "modes" else derivation.polynomials
    return verify.load(emit.emit(built), f"{name.replace('-', '_')}_{basis}")


def plain(array: Any) -> Any:
    """As NumPy's, whatever library it is of, which must not be NumPy."""
    assert not isinstance(array, np.ndarray | np.generic | float)
    return np.asarray(getattr(array, "_array", array))  # the strict library hides its own


def same(found: Any, expected: Any) -> bool:
    """To the last digits: other libraries round exp, sin and sums otherwise."""
    found = plain(found)
    return bool(
        found.dtype == expected.dtype
        and found.shape == expected.shape
        and np.all(np.abs(found - expected) <= 1e-13 * max(np.abs(expected).max(initial=0), 1e-300))
    )


@pytest.mark.parametrize("which", ["modes", "legendre"])
@pytest.mark.parametrize("column", COLUMNS)
def test_functions_are_what_they_are_in_numpy(column: str, which: str, xp: Any, kernels: Any) -> None:
    module = kernels(column, which)
    ours, theirs = module.basis(MODES), module.basis(MODES, xp)
    for a, b in zip(ours, theirs, strict=True):
        assert same(b, a) if np.ndim(a) else a == b
    places = np.linspace(0, 1, 6).reshape(2, 3)
    own = {p["name"]: 0.37 for p in module.COLUMN["parameters"]}
    for rigid in (False, True):
        for name in ("mass", "stiffness_elastic", "stiffness_load"):
            function = getattr(module, name)
            assert same(function(theirs, rigid, **own), function(ours, rigid, **own)), name
        assert same(module.damping(theirs, 0.1, 0.2, rigid, **own), module.damping(ours, 0.1, 0.2, rigid, **own))
        for order in range(4):
            assert same(
                module.shapes(theirs, xp.asarray(places), order, rigid), module.shapes(ours, places, order, rigid)
            )
        assert same(module.shapes(theirs, 0.3, 1, rigid), module.shapes(ours, 0.3, 1, rigid))
        if module.COLUMN["force"]:
            assert same(module.force(theirs, 0.3, rigid), module.force(ours, 0.3, rigid))


def test_frequencies_and_steps_are_what_they_are_in_numpy(xp: Any, kernels: Any) -> None:
    module = kernels("beck", "modes")
    ours, theirs = module.basis(MODES), module.basis(MODES, xp)
    for a, b in zip(
        module.frequencies(ours.gamma, 1e-3, 0.1), module.frequencies(theirs.gamma, 1e-3, 0.1), strict=True
    ):
        assert same(b, a)
    steps = []
    for basis, made in ((ours, np.asarray), (theirs, xp.asarray)):
        M, K = module.mass(basis), module.stiffness_elastic(basis) + 5.0 * module.stiffness_load(basis)
        C = module.damping(basis, 1e-3, 0.1)
        state = [made(np.linspace(a, a + 1, MODES)) for a in range(4)]
        steps.append(module.newmark_step(M, C, K, *state, 0.01))
    assert all(same(b, a) for a, b in zip(*steps, strict=True))


def test_nothing_is_written_in_place(kernels: Any) -> None:
    """JAX's arrays cannot be written to, so jit and derivatives go through: here by a parameter of the column."""
    jax = pytest.importorskip("jax")
    module = kernels("beck", "modes")
    with jax.enable_x64(True):
        basis = module.basis(MODES, jax.numpy)
        slope = jax.jacfwd(lambda eta: jax.jit(module.stiffness_load)(basis, eta=eta))(0.4)
    ours = module.basis(MODES)
    assert same(slope, module.stiffness_load(ours, eta=1.0) - module.stiffness_load(ours, eta=0.0))


def test_matrices_are_new_each_time(kernels: Any) -> None:
    """A caller may write into what NumPy users get."""
    for which in ("modes", "legendre"):
        module = kernels("free-free", which)
        basis = module.basis(MODES)
        before = [field.copy() for field in basis if np.ndim(field)]
        for name in ("mass", "stiffness_elastic", "stiffness_load"):
            matrix = getattr(module, name)(basis, True)
            matrix[:] = 7.0
        assert all(np.array_equal(a, b) for a, b in zip(before, (f for f in basis if np.ndim(f)), strict=True))


def test_balls_take_the_rigid_functions_along(kernels: Any) -> None:
    """Matrices of Arb's balls hold those of floats, 1/12 included, which no float is."""
    module = kernels("free-free", "modes")
    with balls.precision(100):
        quarter, sigma, delta = balls.roots(module, MODES)
        basis = module.complete(quarter, sigma, delta, flint.arb.pi() / 4)
        for name in ("mass", "stiffness_elastic", "stiffness_load"):
            found = getattr(module, name)(basis, True)
            expected = getattr(module, name)(module.basis(MODES), True)
            size = np.outer(*[np.concatenate([np.ones(2), module.basis(MODES).gamma])] * 2)
            for ball, value, scale in zip(found.flat, expected.flat, size.flat, strict=True):
                ball = flint.arb(ball)
                assert ball.rad() < 1e-25 * scale and abs(float(ball.mid()) - value) <= 1e-14 * max(scale, abs(value))
        assert flint.arb(module.mass(basis, True)[1, 1]).contains(flint.arb(1) / 12)
        assert not flint.arb(module.mass(basis, True)[1, 1]).contains(flint.arb(1 / 12))


def test_fractions_stay_fractions(kernels: Any) -> None:
    """Polynomials' matrices in Python's own fractions are exact: the mass of the rotation is 1/12."""
    module = kernels("free-free", "legendre")
    order = np.array([Fraction(n) for n in range(MODES + 2)], dtype=object)
    basis = module.complete(order, np.array([(-1) ** n for n in range(MODES + 2)]))
    for name in ("mass", "stiffness_elastic", "stiffness_load"):
        matrix = getattr(module, name)(basis, True)
        assert all(isinstance(v, Fraction | int) for v in matrix.flat)
        assert np.allclose(matrix.astype(float), getattr(module, name)(module.basis(MODES), True), rtol=1e-13)
    assert module.mass(basis, True)[1, 1] == Fraction(1, 12)
