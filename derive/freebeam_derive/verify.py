"""Emitted kernels against an independent high-precision route, the one of independent.py, each figure with its bound.

What a module of polynomials computes in fractions must equal the exact integrals; all else has a measured error.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from fractions import Fraction
from types import ModuleType
from typing import Any

import mpmath
import numpy as np
from flint import fmpq, fmpq_poly
from sympy import lambdify

from freebeam_derive.independent import (
    BITS,
    DIGITS,
    Mode,
    Products,
    VerificationError,
    exactly,
    fraction,
    independent_mode,
    independent_polynomials,
    integral_of,
    none_skipped,
    polynomial_at,
    rational_factor,
)
from freebeam_derive.kernel import ColumnKernel, Kernel, PolynomialKernel
from freebeam_derive.notation import EI, L, gamma, m
from freebeam_derive.ritz import Form
from freebeam_derive.scaling import SCALES

__all__ = ["Figure", "VerificationError", "load", "verify"]

MATRIX_MODES = 64  # all entries up to here
EXACT_MODES = 40  # modes and derivatives within BOUND up to here
HIGH_MODES = (48, 64, 100, 200)  # and within 4 u gamma at these
POLYNOMIALS = 40  # elastic polynomials, all entries and derivatives up to the third
BOUND = 1e-14
SERIES_BOUND = BOUND  # of polynomials, their derivatives and matrices
_UNIT = 2.0**-53

Progress = Callable[[str], None]


@dataclass(frozen=True)
class Figure:
    """A measured error: what, where it was largest, how large, and the bound that it must keep."""

    what: str
    where: str
    error: float
    bound: float


def load(text: str, name: str) -> ModuleType:
    """The module that an emitted text makes, without a file."""
    module = ModuleType(f"emitted_{name}")
    exec(compile(text, f"<emitted {name}>", "exec"), module.__dict__)
    return module


# --- the comparison -----------------------------------------------------------------------------------------


def verify(kernel: Kernel, text: str, progress: Progress | None = None) -> tuple[Figure, ...]:
    """Compare an emitted module with the independent route; the measured errors, each within its bound.

    Raises VerificationError where one is not.
    """
    say = progress or (lambda _: None)
    module = load(text, kernel.column.module)
    with mpmath.workdps(DIGITS + 15):
        if isinstance(kernel, PolynomialKernel):
            figures = _verify_polynomials(kernel, module, say)
        else:
            assert isinstance(kernel, ColumnKernel)
            figures = _verify_modes(kernel, module, say)
        say("the rest")
        figures += _figures_rest(kernel, module)
    for figure in figures:
        if not figure.error <= figure.bound:
            raise VerificationError(
                f"{kernel.column.name}: {figure.what} at {figure.where} is off by {figure.error:.2e}, "
                f"bound {figure.bound:.2e}"
            )
    return tuple(figures)


def _verify_modes(kernel: ColumnKernel, module: ModuleType, say: Progress) -> list[Figure]:
    orders = kernel.beam.orders
    say("roots")
    none_skipped(module, orders, 24)
    gamma_float = module.basis(max(HIGH_MODES)).gamma
    modes: dict[int, Mode] = {}
    for index in sorted({*range(1, MATRIX_MODES + 1), *HIGH_MODES}):
        modes[index] = independent_mode(index, float(gamma_float[index - 1]), orders)
    figures = [*_figures_roots(gamma_float, modes)]
    say("modes")
    figures += _figures_shapes(module, modes)
    say("matrices")
    products = Products([modes[n] for n in range(1, MATRIX_MODES + 1)], kernel.rigid)
    figures += _figures_matrices(kernel, module, products)
    if kernel.damped is not None:
        figures += _figures_frequencies(kernel, module, modes)
    return figures


def _figures_roots(gamma_float: Any, modes: dict[int, Mode]) -> Iterator[Figure]:
    worst = max(modes, key=lambda n: abs(float(gamma_float[n - 1]) / modes[n].gamma - 1))
    error = float(abs(mpmath.mpf(float(gamma_float[worst - 1])) / modes[worst].gamma - 1))
    yield Figure("relative error of the roots", f"mode {worst}", error, 4 * _UNIT)


_PLACES = (0.0, 1e-3, 0.1, 0.25, 1 / 3, 0.5, 0.5773502691896258, 0.7, 0.9, 0.999, 1.0)


def _figures_shapes(module: ModuleType, modes: dict[int, Mode]) -> Iterator[Figure]:
    """Modes and their derivatives up to the third, relative to the largest value along the beam."""
    basis = module.basis(max(modes))
    grid = np.linspace(0, 1, 2001)
    exact = {n: _exact_values(mode) for n, mode in modes.items()}
    for d in range(4):
        computed, largest = module.shapes(basis, _PLACES, d), np.abs(module.shapes(basis, grid, d)).max(axis=1)
        worst = {False: ("", 0.0, BOUND), True: ("", 0.0, BOUND)}
        for n, mode in modes.items():
            scale = mode.gamma**d
            for place, value in zip(range(len(_PLACES)), exact[n][d], strict=True):
                error = float(
                    abs(mpmath.mpf(float(computed[n - 1, place])) - value * scale) / mpmath.mpf(float(largest[n - 1]))
                )
                high = n > EXACT_MODES
                bound = max(BOUND, 4 * _UNIT * float(mode.gamma)) if high else BOUND
                if error / bound >= worst[high][1] / worst[high][2]:
                    worst[high] = (f"mode {n}, x = {_PLACES[place]:.4g}", error, bound)
        for high, (where, error, bound) in worst.items():
            reach = f"modes beyond {EXACT_MODES}" if high else f"modes up to {EXACT_MODES}"
            yield Figure(f"derivative {d} of {reach}, of the largest value", where, error, bound)


def _exact_values(mode: Mode) -> list[list[mpmath.mpf]]:
    return [[mpmath.mpf(v) for v in row] for row in mode.values([mpmath.mpf(place) for place in _PLACES])]


def _samples(kernel: Kernel) -> list[dict[str, float]]:
    """Values of the column's own parameters: defaults, and both ends of their ranges."""
    own = kernel.column.parameters
    return [
        {p.name: float(v) for p, v in zip(own, values, strict=True)}
        for values in dict.fromkeys(
            [tuple(p.default for p in own), tuple(p.low for p in own), tuple(p.high for p in own)]
        )
    ]


_DAMPING = {"alpha": 0.0123, "beta": 0.456}


def _matrices(kernel: Kernel, module: ModuleType) -> dict[str, tuple[Form, Callable[..., Any]]]:
    """Each matrix: its form, and the function that computes it."""
    system = kernel.system
    return {
        "M": (system.M, module.mass),
        "E": (system.E, module.stiffness_elastic),
        "H": (system.H, module.stiffness_load),
        "C": (system.C, lambda basis, rigid, **own: module.damping(basis, *_DAMPING.values(), rigid, **own)),
    }


def _figures_matrices(kernel: ColumnKernel, module: ModuleType, products: Products) -> Iterator[Figure]:
    """Each entry within the bound of max(|entry|, γ_i γ_j); γ is taken as 1 for a rigid function."""
    basis = module.basis(MATRIX_MODES)
    size = [1.0] * len(kernel.rigid) + [float(g) for g in products.roots]
    for letter, (form, function) in _matrices(kernel, module).items():
        worst = ("", 0.0)
        for own in _samples(kernel):
            exact = products.form(form, own | _DAMPING)
            computed = function(basis, True, **own)
            if not np.array_equal(function(basis, False, **own), computed[-MATRIX_MODES:, -MATRIX_MODES:]):
                raise VerificationError(
                    f"{letter} without the rigid functions is not the elastic block of the one with them"
                )
            errors = np.abs((_in_units(computed) - exact).astype(float)) * 2.0**-BITS
            errors /= np.maximum(np.abs(exact.astype(float)) * 2.0**-BITS, np.outer(size, size))
            i, j = np.unravel_index(int(errors.argmax()), errors.shape)
            if errors[i, j] >= worst[1]:
                worst = (f"row {i + 1}, column {j + 1}, {own or 'no parameters'}", float(errors[i, j]))
        yield Figure(f"entries of {letter} up to N = {MATRIX_MODES}, of max(|entry|, γ_i γ_j)", *worst, BOUND)


def _in_units(array: Any) -> Any:
    """A float array in integers of 2^-BITS, exactly."""
    mantissa, exponent = np.frexp(array)
    whole = np.array([int(v) for v in np.ldexp(mantissa, 53).ravel()], dtype=object)
    shifts = exponent.ravel().astype(int) - 53 + BITS
    shifted = [v << n if n >= 0 else v >> -n for v, n in zip(whole, shifts.tolist(), strict=True)]
    return np.array(shifted, dtype=object).reshape(array.shape)


def _figures_rest(kernel: Kernel, module: ModuleType) -> Iterator[Figure]:
    basis = module.basis(8)
    if kernel.system.forces:
        error = float(np.abs(module.force(basis, 0.3) - module.shapes(basis, 0.3)).max())
        rigid = module.force(basis, 0.3, True)
        for n, function in enumerate(kernel.rigid):
            error = max(error, float(abs(mpmath.mpf(float(rigid[n])) - polynomial_at(function, 0, mpmath.mpf(0.3)))))
        yield Figure("generalised force", "x_F = 0.3", error, BOUND)
    yield _figure_newmark(module)
    yield _figure_limit(module)
    beam = {"EI": 3.5, "m": 2.25, "L": 1.75}
    given = {symbol: Fraction(beam[str(symbol)]) for symbol in (EI, m, L)}
    scales = module.scales(beam["EI"], beam["m"], beam["L"])
    exact_scales = {
        n: mpmath.mpmathify(e.subs({s: v.numerator / v.denominator for s, v in given.items()}).evalf(40))
        for n, e in SCALES.items()
    }
    error = max(float(abs(mpmath.mpf(scales[n]) / exact_scales[n] - 1)) for n in SCALES)
    yield Figure("scales of the SI units", "one beam", error, BOUND)


def _figures_frequencies(kernel: ColumnKernel, module: ModuleType, modes: dict[int, Mode]) -> Iterator[Figure]:
    """Eq. (23) against the roots of the quadratic, from light to heavy damping."""
    assert kernel.damped is not None
    free = sorted(
        {str(s) for s in (kernel.damped.half + kernel.damped.product).free_symbols} - {"gamma", "alpha", "beta"}
    )
    own = {p.name: float(p.default) for p in kernel.column.parameters if p.name in free}
    symbols = {str(s): s for s in (kernel.damped.half + kernel.damped.product).free_symbols} | {"gamma": gamma}
    worst = ("", 0.0)
    for alpha_value, beta_value in ((0.0, 0.0), (1e-6, 0.0), (1e-3, 0.1), (10.0, 1000.0)):
        first, second = module.frequencies(module.basis(8).gamma, alpha_value, beta_value, **own)
        for n in range(1, 9):
            values = {"gamma": modes[n].gamma, "alpha": mpmath.mpf(alpha_value), "beta": mpmath.mpf(beta_value)}
            values |= {name: mpmath.mpf(v) for name, v in own.items()}
            used = [name for name in symbols if name in values]
            half, product = lambdify(
                [symbols[name] for name in used], (kernel.damped.half, kernel.damped.product), "mpmath"
            )(*(values[name] for name in used))
            roots = mpmath.polyroots([1, 2 * half, product], maxsteps=200, extraprec=400)
            for computed in (first[n - 1], second[n - 1]):
                value = mpmath.mpc(complex(computed))
                error = float(min(abs(value - root) / abs(root) for root in roots))
                if error >= worst[1]:
                    worst = (f"mode {n}, alpha = {alpha_value}, beta = {beta_value}", error)
    yield Figure("relative error of the eigenvalues of Eq. (23)", *worst, 1e-12)


def _figure_newmark(module: ModuleType) -> Figure:
    """The step against the equations that define it, solved in exact fractions for a system of two coordinates."""
    rows = {"M": ((2, 1), (1, 3)), "C": ((1, 0), (2, 1)), "K": ((40, -8), (5, 30))}
    state = {"q": (1, 2), "dq": (-3, 1), "ddq": (4, -5), "F": (7, 6)}
    h, b, g = Fraction(1, 8), Fraction(3, 8), Fraction(5, 8)
    matrices = {n: [[Fraction(v) for v in row] for row in r] for n, r in rows.items()}
    q, dq, ddq, F = ([Fraction(v) for v in state[n]] for n in ("q", "dq", "ddq", "F"))
    # unknown accelerations a: M a + C (v0 + g h a) + K (q0 + b h² a) = F
    q_0 = [q[n] + h * dq[n] + h * h * (Fraction(1, 2) - b) * ddq[n] for n in range(2)]
    v_0 = [dq[n] + h * (1 - g) * ddq[n] for n in range(2)]
    S = [
        [matrices["M"][i][j] + g * h * matrices["C"][i][j] + b * h * h * matrices["K"][i][j] for j in range(2)]
        for i in range(2)
    ]
    r = [F[i] - sum(matrices["C"][i][j] * v_0[j] + matrices["K"][i][j] * q_0[j] for j in range(2)) for i in range(2)]
    det = S[0][0] * S[1][1] - S[0][1] * S[1][0]
    a = [(r[0] * S[1][1] - r[1] * S[0][1]) / det, (S[0][0] * r[1] - S[1][0] * r[0]) / det]
    exact = [[q_0[n] + b * h * h * a[n] for n in range(2)], [v_0[n] + g * h * a[n] for n in range(2)], a]
    arrays = [np.array(v, dtype=float) for v in (rows["M"], rows["C"], rows["K"], *state.values())]
    computed = module.newmark_step(*arrays, float(h), (float(b), float(g)))
    error = max(
        abs(float(c[n]) - float(e[n])) / max(1.0, abs(float(e[n])))
        for c, e in zip(computed, exact, strict=True)
        for n in range(2)
    )
    return Figure("one Newmark step", "a system of two coordinates", error, BOUND)


_METHODS = ((0.25, 0.5), (1 / 6, 0.5), (0.0, 0.5), (0.1, 0.6), (0.4, 0.7), (0.2, 0.45), (0.3, 0.4))


def _figure_limit(module: ModuleType) -> Figure:
    """The largest stable step against the growth of one step of one oscillator, as its own definition gives it."""
    worst = ("", 0.0)
    for (b, g), xi in itertools.product(_METHODS, (0.0, 0.05, 3.0)):
        where = f"xi = {xi}, newmark = ({b:.4g}, {g:.4g})"
        limit = module.newmark_limit(xi, (b, g))
        below = np.geomspace(1e-3, 1e5, 5) if limit == math.inf else limit * np.linspace(0.1, 0.999, 6)
        if not all(_growth(step, xi, b, g) <= 1 for step in below):
            raise VerificationError(f"newmark_limit at {where} is {limit}, but steps below it grow")
        if limit == math.inf:
            continue
        low, high = limit * (1 - 1e-9), limit * (1 + 1e-9) + 1e-6 * (limit == 0)
        if _growth(high, xi, b, g) <= 1:
            raise VerificationError(f"newmark_limit at {where} is {limit}, but steps beyond it are stable")
        ends = [mpmath.mpf(low), mpmath.mpf(high)]
        for _ in range(40 if limit else 0):
            middle = sum(ends) / 2
            ends[int(_growth(middle, xi, b, g) > 1)] = middle
        error = float(abs(limit / ends[0] - 1)) if limit else 0.0
        if error >= worst[1]:
            worst = (where, error)
    return Figure("relative error of the largest stable Newmark step", *worst, BOUND)


def _growth(step: Any, *method: float) -> mpmath.mpf:
    """Spectral radius of a Newmark step of ddq + 2 xi step dq + step² q = 0 over a unit of time, less what rounds."""
    step, xi, b, g = map(mpmath.mpf, (step, *method))
    columns = []
    for q, dq in ((1, 0), (0, 1)):
        ddq = -2 * xi * step * dq - step**2 * q
        predicted, rate = q + dq + (mpmath.mpf(0.5) - b) * ddq, dq + (1 - g) * ddq
        new = -(2 * xi * step * rate + step**2 * predicted) / (1 + 2 * xi * g * step + b * step**2)
        columns.append((predicted + b * new, rate + g * new))
    half = (columns[0][0] + columns[1][1]) / 2
    root = mpmath.sqrt(half**2 - columns[0][0] * columns[1][1] + columns[0][1] * columns[1][0])
    return max(abs(half + root), abs(half - root)) - mpmath.mpf(10) ** -25


# --- polynomials --------------------------------------------------------------------------------------------


def _verify_polynomials(kernel: PolynomialKernel, module: ModuleType, say: Progress) -> list[Figure]:
    say("polynomials")
    functions = independent_polynomials(kernel, POLYNOMIALS)
    figures = [*_figures_polynomials(module, functions)]
    say("matrices")
    return [*figures, *_figures_series(kernel, module, functions)]


def _figures_polynomials(module: ModuleType, functions: list[list[fmpq_poly]]) -> Iterator[Figure]:
    """Functions and their derivatives up to the third, relative to the largest value along the beam."""
    basis = module.basis(POLYNOMIALS)
    for order in range(4):
        computed = module.shapes(basis, _PLACES, order, True)
        largest = np.abs(module.shapes(basis, np.linspace(0, 1, 2001), order, True)).max(axis=1)
        worst = ("", 0.0)
        for n, function in enumerate(functions):
            for place, value in zip(_PLACES, computed[n].tolist(), strict=True):
                error = abs(float(exactly(fraction(value) - function[order](fraction(place)))))
                error = error and (error / largest[n] if largest[n] else math.inf)
                if error >= worst[1]:
                    worst = (f"function {n + 1}, x = {place:.4g}", error)
        yield Figure(
            f"derivative {order} of polynomials up to N = {POLYNOMIALS}, of the largest value", *worst, SERIES_BOUND
        )


def _figures_series(kernel: PolynomialKernel, module: ModuleType, functions: list[list[fmpq_poly]]) -> Iterator[Figure]:
    """Each entry within the bound of what its terms can be: factors times norms (∫ f² dx)^½ and end values.

    Raises VerificationError where M, E or H in fractions is not exactly what the integrals are.
    """
    basis = module.basis(POLYNOMIALS)
    orders = np.empty(len(basis.order), dtype=object)
    orders[:] = [fmpq(n) for n in range(len(orders))]
    in_fractions = module.complete(orders, np.array([(-1) ** n for n in range(len(orders))]))
    integrals: dict[tuple[int, int, int], Any] = {}

    def integral(k: int, p: int, q: int) -> Any:
        if (k, p, q) not in integrals:
            power = fmpq_poly([0] * k + [1])
            left = [power * f[p] for f in functions]
            integrals[k, p, q] = np.array([[integral_of(a * b[q]) for b in functions] for a in left], dtype=object)
        return integrals[k, p, q]

    def at_end(end: int, order: int) -> Any:
        return np.array([f[order](end) for f in functions], dtype=object)

    norms = [np.sqrt([float(exactly(integral_of(f[p] * f[p]))) for f in functions]) for p in range(4)]
    for letter, (form, function) in _matrices(kernel, module).items():
        worst = ("", 0.0)
        for own in _samples(kernel):
            exact = np.full((len(functions),) * 2, fmpq(0), dtype=object)
            scale, rational = np.zeros(exact.shape), True
            for (k, p, q), factor in form.along.items():
                size, sharp = rational_factor(factor, own | _DAMPING)
                rational &= sharp
                exact = exact + size * integral(k, p, q)
                scale += abs(float(exactly(size))) * np.outer(norms[p], norms[q])
            for (a, p, b, q), factor in form.points.items():
                size, sharp = rational_factor(factor, own | _DAMPING)
                rational &= sharp
                product = at_end(int(a), p)[:, None] * at_end(int(b), q)
                exact = exact + size * product
                scale += abs(float(exactly(size))) * np.abs([[float(exactly(v)) for v in row] for row in product])
            computed = function(basis, True, **own)
            if not np.array_equal(function(basis, False, **own), computed[-POLYNOMIALS:, -POLYNOMIALS:]):
                raise VerificationError(
                    f"{letter} without the rigid functions is not the elastic block of the one with them"
                )
            if letter != "C" and rational:
                found = function(in_fractions, True, **{name: fraction(value) for name, value in own.items()})
                if any(a != b for a, b in zip(found.flat, exact.flat, strict=True)):
                    raise VerificationError(f"{letter} in exact fractions is not what the integrals are")
            errors = np.array(
                [
                    [abs(float(exactly(fraction(v) - e))) for v, e in zip(*rows, strict=True)]
                    for rows in zip(computed.tolist(), exact.tolist(), strict=True)
                ]
            )
            errors = np.divide(errors, scale, out=np.where(errors > 0, np.inf, 0.0), where=scale > 0)
            i, j = np.unravel_index(int(errors.argmax()), errors.shape)
            if errors[i, j] >= worst[1]:
                worst = (f"row {i + 1}, column {j + 1}, {own or 'no parameters'}", float(errors[i, j]))
        yield Figure(f"entries of {letter} up to N = {POLYNOMIALS}, of the norms of their terms", *worst, SERIES_BOUND)
