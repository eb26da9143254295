"""Emitted functions on arrays of other libraries: the strict array API, JAX and PyTorch where they are installed.

In an environment of their own, for PyTorch's builds with CUDA are large: pip install -e '.[dev,arrays]'
"""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator
from fractions import Fraction
from functools import cache
from types import ModuleType
from typing import Any, cast

import flint
import numpy as np
import pytest
import sympy as sp
from scipy.linalg import eig

from freebeam_derive import emit, pipeline, verify
from freebeam_derive.certify import balls
from freebeam_derive.notation import P, alpha, beta, t, x, y
from freebeam_derive.pipeline import Derived
from freebeam_derive.statement import Column, Parameter, at, delta, integral

Derived = Callable[[str], Derived]
pytestmark = pytest.mark.filterwarnings("ignore:`torch.jit.script` is deprecated")  # PyTorch's own call
COLUMNS = ("free-free", "sprung-tip", "floating")
MODES = 5
DIFFERENTIABLE = ("jax.numpy", "torch")
LIBRARIES = ("array_api_strict", *DIFFERENTIABLE)
MATRICES = ("mass", "stiffness_elastic", "stiffness_load")

s, share = sp.Symbol("s", real=True), sp.Symbol("share", real=True)
floating = Column(
    name="floating",
    title="Free-free beam on a foundation of stiffness exp s, with a share of the follower force",
    T=integral(y.diff(t) ** 2) / 2,
    V=integral(y.diff(x, 2) ** 2 + sp.exp(s) * y**2) / 2,
    W_c=share * P * integral(x * y.diff(x) ** 2) / 2,
    dW_nc=-share * P * at(y.diff(x), 1) * at(delta(y), 1)
    - integral(beta * y.diff(t) * delta(y) + alpha * y.diff(x, 2, t) * delta(y.diff(x, 2))),
    ends=("free", "free"),
    parameters=(
        Parameter(s, "logarithm of the foundation's stiffness", 1.0, -3.0, 6.0),
        Parameter(share, "share of the load that the beam carries", 0.5, 0.1, 1.0),
    ),
)


def opened(request: pytest.FixtureRequest) -> Iterator[Any]:
    """A namespace, with double precision where that must be asked for."""
    with enabled(request.param) as library:
        yield library


xp = pytest.fixture(opened, params=LIBRARIES, name="xp")
differentiable = pytest.fixture(opened, params=DIFFERENTIABLE, name="differentiable")


@pytest.fixture
def kernels(derived: Derived) -> Callable[[str, str], ModuleType]:
    return lambda name, basis: emitted(derived, name, basis)


@contextlib.contextmanager
def enabled(library: str) -> Iterator[Any]:
    """A namespace by its name, with double precision where that must be asked for."""
    found = pytest.importorskip(library)
    with contextlib.ExitStack() as stack:
        if library == "jax.numpy":
            import jax

            stack.enter_context(jax.enable_x64(True))
        yield found


@cache
def emitted(derived: Derived, name: str, basis: str) -> ModuleType:
    derivation = pipeline.derive(floating) if name == "floating" else derived(name)
    built = derivation.kernel(basis)
    return verify.load(emit.emit(built), f"{name.replace('-', '_')}_{basis}")


def plain(array: Any) -> Any:
    """As NumPy's, whatever library it is of, which must not be NumPy."""
    assert not isinstance(array, np.ndarray | np.generic | float)
    return np.asarray(getattr(array, "_array", array))  # the strict library hides its own


def same(found: Any, expected: Any, tolerance: float = 1e-13) -> bool:
    """To the last digits: other libraries round exp, sin and sums otherwise."""
    found = plain(found)
    return bool(
        found.dtype == expected.dtype
        and found.shape == expected.shape
        and np.all(np.abs(found - expected) <= tolerance * max(np.abs(expected).max(initial=0), 1e-300))
    )


def jacobian(library: Any, function: Callable[[Any], Any], values: Any, forward: bool = False) -> Any:
    """Derivatives of an array by some numbers, (*array, *numbers), in reverse or forward mode."""
    if library.__name__ == "torch":
        slope = (library.func.jacfwd if forward else library.func.jacrev)(function)
    else:
        import jax

        slope = jax.jit((jax.jacfwd if forward else jax.jacrev)(function))
    return slope(library.asarray(values, dtype=library.float64))


def mapped(library: Any, function: Callable[[Any], Any]) -> Callable[[Any], Any]:
    """A function of one number, of many, compiled where that can be done."""
    if library.__name__ == "torch":
        vectorised: Callable[[Any], Any] = library.func.vmap(function)
        return vectorised
    import jax

    return cast("Callable[[Any], Any]", jax.jit(jax.vmap(function)))


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
        for name in MATRICES:
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


@pytest.mark.parametrize("which", ["modes", "legendre"])
def test_numbers_of_single_precision_stay_so(which: str, xp: Any, kernels: Any) -> None:
    """Nothing is promoted, and no more digits are lost than single precision's own, times the order of the mode."""
    N, places = 24, np.linspace(0, 1, 41, dtype=np.float32)
    for column in ("beck", "floating"):
        module = kernels(column, which)
        ours, theirs = module.basis(N), module.basis(N, xp, xp.float32)
        size = np.arange(1, module.mass(ours, True).shape[0] + 1)[:, None]
        for order in range(3):
            exact = module.shapes(ours, places.astype(float), order, True)
            for given in (xp.asarray(places), places.tolist() if order else places):  # theirs, and of others
                found = plain(module.shapes(theirs, given, order, True))
                assert found.dtype == np.float32
                assert np.all(np.abs(found - exact) <= 3e-6 * size * (1 + np.abs(exact).max(axis=1, keepdims=True)))
        for name in MATRICES:
            exact = getattr(module, name)(ours, True).astype(np.float32)
            assert same(getattr(module, name)(theirs, True), exact, 1e-5), (column, name)
        if hasattr(module, "frequencies"):
            pair = module.frequencies(ours.gamma, 1e-3, 0.1), module.frequencies(theirs.gamma, 1e-3, 0.1)
            assert all(same(b, a.astype(np.complex64), 1e-5) for a, b in zip(*pair, strict=True))


@pytest.mark.parametrize("library", ["array_api_strict", "torch"])
@pytest.mark.parametrize("which", ["modes", "legendre"])
def test_arrays_stay_on_their_device(which: str, library: str, kernels: Any) -> None:
    """A second device of the strict library; PyTorch's "meta", whose tensors refuse to meet those of the CPU."""
    xp = pytest.importorskip(library)
    device = xp.Device("device1") if library == "array_api_strict" else xp.device("meta")
    for column in COLUMNS:
        module = kernels(column, which)
        basis = module.basis(MODES, xp, device=device)
        M, E, H = (getattr(module, name)(basis, True) for name in MATRICES)
        C = module.damping(basis, 1e-3, 0.1, True)
        places = xp.asarray([0.25, 1.0], dtype=xp.float64, device=device)
        values = [module.shapes(basis, given, 1, True) for given in (0.3, [0.25, 1.0], places)]
        state = M[0, :]
        steps = module.newmark_step(M, C, E + 3.0 * H, state, state, state, state, 0.1)
        pair = module.frequencies(basis.gamma, 1e-3, 0.1) if hasattr(module, "frequencies") else ()
        for array in (*(f for f in basis if hasattr(f, "device")), M, E, H, C, *values, *steps, *pair):
            assert array.device == device


@pytest.mark.parametrize("library", ["numpy", *LIBRARIES])
@pytest.mark.parametrize("which", ["modes", "legendre"])
def test_many_parameters_make_as_many_matrices(which: str, library: str, kernels: Any) -> None:
    """Parameters, dampings and loads of shape (..., 1, 1), each matrix that of its numbers."""
    rng = np.random.default_rng(3)
    with enabled(library) as xp:
        for column, rigid in (("beck", False), ("sprung-tip", False), ("floating", True)):
            module = kernels(column, which)
            own = {p["name"]: rng.uniform(0.2, 0.9, (2, 3, 1, 1)) for p in module.COLUMN["parameters"]}
            values = rng.uniform(0.1, 1.0, (2, 3, 1, 1))
            ours, theirs = module.basis(MODES), module.basis(MODES, xp)
            given = {name: xp.asarray(value) for name, value in own.items()}
            found = {name: getattr(module, name)(theirs, rigid, **given) for name in MATRICES}
            C = module.damping(theirs, xp.asarray(values), xp.asarray(2 * values), rigid, **given)
            K = found["stiffness_elastic"] + xp.asarray(5 * values) * found["stiffness_load"]
            n = MODES + rigid * module.COLUMN["rigid"]
            q = rng.normal(size=(4, 2, 3, n, 1))
            M = found["mass"] + xp.zeros((2, 3, 1, 1), dtype=xp.float64)
            steps = module.newmark_step(M, C, K, *(xp.asarray(part) for part in q), 0.01)
            for place in np.ndindex(2, 3):
                numbers = {name: float(value[place][0, 0]) for name, value in own.items()}
                value = float(values[place][0, 0])
                one = {name: getattr(module, name)(ours, rigid, **numbers) for name in MATRICES}
                for name in MATRICES:
                    whole = np.asarray(getattr(found[name], "_array", found[name]))
                    assert np.allclose(np.broadcast_to(whole, (2, 3, n, n))[place], one[name], rtol=1e-13, atol=1e-12)
                damped = module.damping(ours, value, 2 * value, rigid, **numbers)
                stiff = one["stiffness_elastic"] + 5 * value * one["stiffness_load"]
                alone = module.newmark_step(
                    one["mass"], damped, stiff, *(part[(*place, slice(None), 0)] for part in q), 0.01
                )
                for a, b in zip(alone, steps, strict=True):
                    assert np.allclose(np.asarray(getattr(b, "_array", b))[(*place, slice(None), 0)], a, rtol=1e-10)


@pytest.mark.parametrize("forward", [False, True])
@pytest.mark.parametrize("which", ["modes", "legendre"])
def test_derivatives_by_load_damping_and_parameters(
    which: str, forward: bool, differentiable: Any, kernels: Any
) -> None:
    """K = E + P H and C = α E + β M: by P it is H, by α E, by β M; by a share of the load H at share 1, and so on."""
    module, at_once = kernels("floating", which), (3.0, 1e-2, 0.2, 1.1, 0.4)
    ours, theirs = module.basis(MODES), module.basis(MODES, differentiable)

    def both(values: Any) -> Any:
        P_, alpha_, beta_, s_, share_ = (values[n] for n in range(5))
        own = {"s": s_, "share": share_}
        K = module.stiffness_elastic(theirs, True, **own) + P_ * module.stiffness_load(theirs, True, **own)
        return differentiable.stack([K, module.damping(theirs, alpha_, beta_, True, **own)])

    M = module.mass(ours, True)
    E, H, full = (
        module.stiffness_elastic(ours, True, s=1.1),
        module.stiffness_load(ours, True, share=0.4),
        module.stiffness_load(ours, True, share=1.0),
    )
    bending = E - np.exp(1.1) * M
    nothing = 0 * M
    expected = np.stack(
        [
            np.stack([H, nothing, nothing, np.exp(1.1) * M, 3.0 * full], axis=-1),
            np.stack([nothing, bending, M, nothing, nothing], axis=-1),
        ]
    )
    found = jacobian(differentiable, both, at_once, forward)
    assert same(found, expected, 1e-14 * MODES**2)
    many = mapped(differentiable, lambda P_: both((P_, *at_once[1:])))(differentiable.asarray([1.0, 3.0, 7.5]))
    alone = [both((P_, *at_once[1:])) for P_ in (1.0, 3.0, 7.5)]
    assert all(same(many[n], plain(one), 1e-14) for n, one in enumerate(alone))


@pytest.mark.parametrize("which", ["modes", "legendre"])
def test_derivatives_by_a_follower_share(which: str, differentiable: Any, kernels: Any) -> None:
    """H of Beck's column is linear in η, so its derivative is a difference."""
    module = kernels("beck", which)
    ours, theirs = module.basis(MODES), module.basis(MODES, differentiable)
    slope = jacobian(differentiable, lambda eta: module.stiffness_load(theirs, eta=eta), 0.4)
    assert same(slope, module.stiffness_load(ours, eta=1.0) - module.stiffness_load(ours, eta=0.0))


@pytest.mark.parametrize("which", ["modes", "legendre"])
def test_derivatives_by_place(which: str, differentiable: Any, kernels: Any) -> None:
    """Of the functions, up to the third, and of a force by where it acts."""
    module = kernels("free-free", which)
    ours, theirs = module.basis(MODES), module.basis(MODES, differentiable)
    for order in range(3):
        found = jacobian(differentiable, lambda place, d=order: module.shapes(theirs, place, d, True), 0.3)
        assert same(found, module.shapes(ours, 0.3, order + 1, True), 1e-12)
    found = jacobian(differentiable, lambda place: module.force(theirs, place), 0.8, True)
    assert same(found, module.shapes(ours, 0.8, 1), 1e-12)


def test_derivatives_of_a_growth_rate(differentiable: Any, kernels: Any) -> None:
    """Through the library's own eigenvalues; against −wᵀ(λ C′ + K′)v / wᵀ(2λM + C)v with SciPy's eigenvectors."""
    module, (P_, alpha_, beta_, eta_) = kernels("beck", "modes"), (21.0, 2e-3, 0.3, 0.9)
    ours, theirs = module.basis(MODES), module.basis(MODES, differentiable)
    zero, unit = differentiable.zeros((MODES, MODES), dtype=differentiable.float64), differentiable.eye(MODES)

    def growth(values: Any) -> Any:
        K = module.stiffness_elastic(theirs) + values[0] * module.stiffness_load(theirs, eta=values[3])
        C = module.damping(theirs, values[1], values[2])
        below = -differentiable.linalg.solve(module.mass(theirs), differentiable.concat([K, C], axis=1))
        state = differentiable.concat([differentiable.concat([zero, unit + zero], axis=1), below])
        return differentiable.max(differentiable.real(differentiable.linalg.eigvals(state)))

    M, E, H = module.mass(ours), module.stiffness_elastic(ours), module.stiffness_load(ours, eta=eta_)
    C, n = alpha_ * E + beta_ * M, MODES
    below = -np.linalg.solve(M, np.hstack([E + P_ * H, C]))
    values, left, right = eig(np.vstack([np.eye(n, 2 * n, n), below]), left=True)
    k = int(np.argmax(values.real))
    lam, v = values[k], right[:n, k]
    w = np.linalg.solve(M.T, left[n:, k].conj())
    share_slope = P_ * (module.stiffness_load(ours, eta=1.0) - module.stiffness_load(ours, eta=0.0))
    parts = (H, lam * E, lam * M, share_slope)
    expected = np.array([-(w @ part @ v) / (w @ (2 * lam * M + C) @ v) for part in parts]).real
    assert np.all(expected[[0, 2]] * (1, -1) > 0)  # load destabilises, external damping does not
    assert same(jacobian(differentiable, growth, (P_, alpha_, beta_, eta_)), expected, 1e-9)


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
