"""Polynomials as the second basis: the exact beam's loads to ten digits, the same spectra, the same contracts."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Iterator
from itertools import pairwise
from pathlib import Path
from typing import Any

import mpmath
import numpy as np
import pytest
from numpy.polynomial import legendre

import freebeam as fb
from freebeam import cli
from freebeam_sym.checks import InputError
from freebeam_sym.columns import Column

NAMES = ("free-free", "beck", "euler-pinned")

SLIDING = """
from freebeam_derive.notation import P, t, x, y
from freebeam_derive.statement import Column, delta, integral

column = Column(
    name="pinned-sliding",
    title="Pinned below, guided above, under a dead load",
    T=integral(y.diff(t) ** 2) / 2,
    V=integral(y.diff(x, 2) ** 2) / 2,
    W_c=P * integral(y.diff(x) ** 2) / 2,
    dW_nc=0,
    ends=("pinned", "sliding"),
)
"""


@pytest.fixture(autouse=True)
def private_cache(tmp_path_factory: pytest.TempPathFactory, monkeypatch: pytest.MonkeyPatch) -> None:
    """One cache for this run of the tests, apart from the user's."""
    for name in ("XDG_CACHE_HOME", "LOCALAPPDATA"):
        monkeypatch.setenv(name, str(tmp_path_factory.getbasetemp() / "cache"))


@pytest.fixture
def digits() -> Iterator[None]:
    with mpmath.workdps(30):
        yield


@pytest.fixture
def own_file(tmp_path: Path) -> Path:
    file = tmp_path / "guided.py"
    file.write_text(SLIDING, encoding="utf-8")
    return file


def polynomials(name: str) -> Column:
    return fb.column(name, basis="legendre")


# --- the exact beam, by its power series in x ---------------------------------------------------------------


def solution(p: Any, s: Any, start: int, graded: bool) -> list[Any]:
    """y, y′, y″, y‴ at x = 1 of y'''' + p (n y′)′ = s y with y = x^start at first, n = x (graded) or 1."""
    c = [mpmath.mpf(0)] * 4
    c[start] = mpmath.mpf(1)
    for m in range(120):
        load = (m + 1) ** 2 * c[m + 1] if graded else (m + 1) * (m + 2) * c[m + 2]
        c.append((s * c[m] - p * load) / ((m + 1) * (m + 2) * (m + 3) * (m + 4)))
    return [mpmath.fsum(math.perm(m, d) * a for m, a in enumerate(c) if m >= d) for d in range(4)]


def characteristic(name: str, p: Any, s: Any) -> Any:
    """What vanishes at an eigenvalue of the exact free-free beam (its rigid factor struck out) and of Beck's column."""
    starts, orders = ((0, 1), (2, 3)) if name == "free-free" else ((2, 3), (2, 3))
    u, v = (solution(p, s, start, name == "free-free") for start in starts)
    value = u[orders[0]] * v[orders[1]] - u[orders[1]] * v[orders[0]]
    return value / s**2 if name == "free-free" else value


def exact_load(name: str, near: float, frequency: float, alpha: float, beta: float) -> Any:
    """The exact beam's flutter load near a given one: a double root in s undamped, else a root at λ = iω."""

    def undamped(P: Any, w: Any) -> tuple[Any, Any]:
        return characteristic(name, P, w**2), mpmath.diff(lambda s: characteristic(name, P, s), w**2)

    def damped(P: Any, w: Any) -> tuple[Any, Any]:
        lam = 1j * w
        value = characteristic(name, P / (1 + alpha * lam), -(lam**2 + beta * lam) / (1 + alpha * lam))
        return value.real, value.imag

    found = mpmath.findroot(damped if alpha or beta else undamped, (near, frequency), tol=1e-40, verify=False)
    return found[0]


@pytest.mark.usefixtures("digits")
@pytest.mark.parametrize("name", ["free-free", "beck"])
@pytest.mark.parametrize(("alpha", "beta"), [(0.0, 0.0), (1e-3, 0.0), (1e-3, 0.1), (0.02, 1.0)])
def test_eighteen_polynomials_give_ten_digits_of_the_exact_flutter_load(
    name: str, alpha: float, beta: float
) -> None:  # fmt: skip
    found = fb.critical_load(polynomials(name), 18, alpha, beta)
    assert found.load is not None and found.frequency is not None and found.kind == "flutter"
    exact = exact_load(name, found.load, found.frequency, alpha, beta)
    assert abs(found.load - exact) < 1e-11 * exact
    more = fb.critical_load(polynomials(name), 40, alpha, beta)
    assert more.load is not None and abs(more.load - exact) < 1e-11 * exact


@pytest.mark.usefixtures("digits")
@pytest.mark.parametrize("name", ["free-free", "beck"])
def test_convergence_is_exponential(name: str) -> None:
    """Each two polynomials more divide the error by 30 at least, and then by more: faster than any power."""
    loads = [fb.critical_load(polynomials(name), N).load for N in range(6, 14, 2)]
    found = fb.critical_load(polynomials(name), 20)
    assert found.load is not None and found.frequency is not None
    exact = float(exact_load(name, found.load, found.frequency, 0, 0))
    errors = [abs(load - exact) for load in loads if load is not None]
    ratios = [a / b for a, b in pairwise(errors)]
    assert len(ratios) == 3 and all(ratio > 30 for ratio in ratios) and ratios[1] > ratios[0]
    modes = fb.critical_load(fb.column(name, "modes"), 12).load
    assert modes is not None and errors[-1] < 1e-3 * abs(modes - exact)


@pytest.mark.parametrize(
    ("name", "own", "exact"), [("euler-pinned", {}, math.pi**2), ("beck", {"eta": 0.0}, math.pi**2 / 4)]
)
def test_few_polynomials_give_euler_s_loads(name: str, own: dict[str, float], exact: float) -> None:
    found = fb.critical_load(polynomials(name), 10, **own)
    assert found.kind == "divergence" and found.load == pytest.approx(exact, rel=1e-12)


# --- the same system in two bases ---------------------------------------------------------------------------


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("rigid", [False, True])
def test_spectra_of_both_bases_agree_as_they_grow(name: str, rigid: bool) -> None:
    """The six lowest eigenvalues; what is left is the truncation of the modes, which falls as N grows."""
    gaps = []
    for modes in (12, 24, 48):
        values = [
            fb.spectrum(column.system(N, load=8.0, alpha=1e-6, beta=0.1, rigid=rigid)).eigenvalues[:6]
            for column, N in ((fb.column(name, "modes"), modes), (polynomials(name), 20))
        ]
        gaps.append(np.abs(values[0] - values[1]).max() / np.abs(values[1]).max())
    assert gaps[-1] < 2e-7
    assert max(gaps) < 1e-9 or (gaps[0] > 4 * gaps[1] > 16 * gaps[2])


@pytest.mark.parametrize("name", NAMES)
def test_unloaded_frequencies_are_those_of_the_modes(name: str) -> None:
    gamma = fb.column(name, "modes").system(4).gamma
    values = fb.spectrum(polynomials(name).system(20)).eigenvalues
    found = np.sort(values.imag[values.imag > 0])[:4]
    np.testing.assert_allclose(found, gamma**2, rtol=1e-9)


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("modes", [1, 7, 40])
def test_matrices_by_quadrature(name: str, modes: int) -> None:
    """M, E, H from the shapes, rigid functions first; within rounding of the norms of what is integrated."""
    column = polynomials(name)
    system = column.system(modes, rigid=True)
    nodes, weights = legendre.leggauss(modes + 6)
    x, w = (nodes + 1) / 2, weights / 2
    f, slope, bend = (system.shapes(x, d) for d in range(3))
    axial = x if name == "free-free" else np.ones_like(x)
    follower = {"free-free": 1.0, "beck": 1.0, "euler-pinned": 0.0}[name]
    end = np.outer(system.shapes(1.0), system.shapes(1.0, 1))

    def close(found: Any, expected: Any, *factors: Any) -> None:
        sizes = [np.sqrt((factor**2) @ w) for factor in factors]
        assert (np.abs(found - expected) <= 1e-12 * (np.outer(*sizes) + np.abs(end))).all()

    close(system.M, (f * w) @ f.T, f, f)
    close(system.E, (bend * w) @ bend.T, bend, bend)
    close(system.H, -(slope * axial * w) @ slope.T + follower * end, slope, slope)
    assert (system.E == system.E.T).all() and np.count_nonzero(system.M) == len(system.M)
    r = system.rigid_count
    sharp = column.system(modes)
    for whole, block in ((system.M, sharp.M), (system.E, sharp.E), (system.H, sharp.H)):
        np.testing.assert_array_equal(whole[r:, r:], block)
    assert len(sharp.M) == modes and len(system.M) == modes + r


def test_rigid_motion_does_not_act_on_the_elastic_rows() -> None:
    """Section 2 of the theory in any basis: block triangular, the rigid block a translation driven by a rotation."""
    system = polynomials("free-free").system(20, load=1.0, rigid=True)
    size = np.abs(system.H[2:, 2:]).max()
    assert np.abs(system.K[2:, :2]).max() < 1e-14 * size and not system.M[2:, :2].any()
    np.testing.assert_allclose(system.K[:2, :2], [[0, 1], [0, 0]], atol=1e-15)
    assert np.abs(system.K[:2, 2:]).min() > 0.1


@pytest.mark.parametrize("name", NAMES)
def test_shapes_are_derivatives_of_each_other(name: str) -> None:
    """∫ₐᵇ φ⁽ᵈ⁺¹⁾ dx = φ⁽ᵈ⁾(b) − φ⁽ᵈ⁾(a), for places of any shape."""
    system = polynomials(name).system(12, rigid=True)
    nodes, weights = legendre.leggauss(20)
    a, b = 0.17, 0.83
    x = a + (b - a) * (nodes + 1) / 2
    for order in range(5):
        rise = system.shapes(b, order) - system.shapes(a, order)
        largest = np.abs(system.shapes(np.linspace(0, 1, 201), order)).max()
        np.testing.assert_allclose(
            (b - a) / 2 * system.shapes(x, order + 1) @ weights, rise, atol=1e-12 * largest, rtol=0
        )
    places = np.linspace(0, 1, 6).reshape(2, 3)
    np.testing.assert_array_equal(system.shapes(places).reshape(-1, 6), system.shapes(places.ravel()))


def test_a_free_beam_s_functions_are_legendre_s() -> None:
    x = np.linspace(0, 1, 101)
    found = polynomials("free-free").system(30).shapes(x)
    expected = [legendre.legval(2 * x - 1, np.eye(32)[n]) for n in range(2, 32)]
    np.testing.assert_allclose(found, expected, atol=1e-13)


def test_the_response_does_not_depend_on_the_basis() -> None:
    """A force at the end, seen by two sensors, with the rigid motion: that of the modes converges to it with 1/N²."""

    def response(column: Column, modes: int) -> Any:
        system = column.system(modes, load=9, alpha=1e-3, beta=0.1, rigid=True)
        excitation: dict[str, Any] = {"force": lambda t: np.sin(3 * t), "force_position": 1.0}
        return fb.respond(system, duration=2.0, step=0.002, sensors=[0.1, 0.8], **excitation).y

    sharp = response(polynomials("free-free"), 14)
    size = np.abs(sharp).max()
    assert np.abs(response(polynomials("free-free"), 18) - sharp).max() < 1e-9 * size
    coarse, fine = (np.abs(response(fb.column("free-free", "modes"), N) - sharp).max() for N in (12, 24))
    assert fine < 2e-3 * size and 3 < coarse / fine < 5


# --- contracts ----------------------------------------------------------------------------------------------


def test_a_column_of_either_basis_is_one_object() -> None:
    for name in NAMES:
        assert fb.column(name, basis="modes") is fb.column(name, "modes")
        assert polynomials(name) is polynomials(name) is not fb.column(name, "modes")
        assert (fb.column(name, "modes").basis_name, polynomials(name).basis_name) == ("modes", "legendre")
        assert polynomials(name).parameters == fb.column(name, "modes").parameters
        assert polynomials(name).rigid_count == fb.column(name, "modes").rigid_count


def test_bad_input_is_refused() -> None:
    with pytest.raises(InputError, match=r"basis = 'chebyshev': must be one of modes, legendre"):
        fb.column("beck", basis="chebyshev")
    with pytest.raises(InputError, match=r"modes = 129: must be a whole number, 1 to 128"):
        polynomials("beck").system(129)
    with pytest.raises(InputError, match=r"gamma: the basis is legendre"):
        _ = polynomials("beck").system(3).gamma
    with pytest.raises(InputError, match=r"x = 1\.5"):
        polynomials("beck").system(3).shapes(1.5)


def test_a_user_s_column(own_file: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Pinned and guided: Euler's load π²/4. Emitted in both bases; a kernel's file has its own basis."""
    for N in (4, 8):
        found = fb.critical_load(fb.column(own_file, basis="legendre"), N)
        assert found.kind == "divergence"
        assert found.load == pytest.approx(math.pi**2 / 4, rel=1e-4 if N == 4 else 1e-11)
    kernels = tmp_path / "kernels"
    assert cli.main(["generate", str(own_file), "--output", str(kernels)]) == 0
    capsys.readouterr()
    emitted = kernels / "pinned_sliding_legendre.py"
    assert fb.column(emitted).basis_name == "legendre"
    assert fb.critical_load(fb.column(emitted), 8) == found
    assert fb.column(kernels / "pinned_sliding.py", basis="modes").basis_name == "modes"
    with pytest.raises(InputError, match=r"is a kernel in the basis modes, not legendre; give the column's file"):
        fb.column(kernels / "pinned_sliding.py", basis="legendre")


@pytest.fixture
def freebeam(capsys: pytest.CaptureFixture[str]) -> Callable[..., tuple[int, str, str]]:
    def run(*arguments: object) -> tuple[int, str, str]:
        return (cli.main([str(a) for a in arguments]), *capsys.readouterr())

    return run


def test_command_line(freebeam: Any, own_file: Path) -> None:
    status, out, err = freebeam("critical", "--basis", "legendre", "--modes", 18, "--json")
    found = json.loads(out)
    assert (status, err) == (0, "")
    assert (found["basis"], found["modes"], found["kind"], found["converged"]) == ("legendre", 18, "flutter", True)
    assert found["load"] == fb.critical_load(polynomials("free-free"), 18).load
    assert found["beam"]["load"] == pytest.approx(found["load"], rel=1e-12)
    assert json.loads(freebeam("critical", "--json")[1])["basis"] == "modes"
    assert "basis = legendre" in freebeam("critical", "--basis", "legendre", "--column", own_file)[1]
    status, out, _ = freebeam("spectrum", "--basis", "legendre", "--load", 9, "--json")
    assert status == 0 and len(json.loads(out)["eigenvalues"]) == 32
    status, out, err = freebeam("critical", "--basis", "fourier")
    assert (status, out) == (2, "") and "basis = 'fourier': must be one of modes, legendre" in err
