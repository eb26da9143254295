"""Emitted kernels against an independent high-precision route, the one of independent.py, each figure with its bound.

What a module of polynomials computes in fractions must equal the exact integrals; all else has a measured error.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator
from fractions import Fraction
from types import ModuleType
from typing import Any, Protocol

import mpmath
import numpy as np
from flint import acb, arb, fmpq, fmpq_mat
from sympy import Add, Expr, Rational, Symbol, expand, lambdify

from freebeam_derive.certify.balls import precision
from freebeam_derive.independent import (
    BITS,
    DIGITS,
    Reference,
    VerificationError,
    fraction,
    number_of,
    polynomial_at,
    rational,
)
from freebeam_derive.kernel import BeamKernel, Figure, Kernel, Progress
from freebeam_derive.notation import EI, L, m
from freebeam_derive.ritz import Form

__all__ = ["Figure", "VerificationError", "load", "verify"]

BOUND = 1e-14
PLACES = (0.0, 1e-3, 0.1, 0.25, 1 / 3, 0.5, 0.5773502691896258, 0.7, 0.9, 0.999, 1.0)


def load(text: str, name: str) -> ModuleType:
    """The module that an emitted text makes, without a file."""
    module = ModuleType(f"emitted_{name}")
    exec(compile(text, f"<emitted {name}>", "exec"), module.__dict__)
    return module


# --- the comparison -----------------------------------------------------------------------------------------


def verify(kernel: Kernel, text: str, progress: Progress | None = None) -> tuple[Figure, ...]:
    """Compare an emitted NumPy module with the independent route; the measured errors, each within its bound.

    Raises VerificationError where one is not.
    """
    return measure(kernel, load(text, kernel.column.module), progress)


def measure(kernel: Kernel, module: ModuleType, progress: Progress | None = None) -> tuple[Figure, ...]:
    """The same for a module at hand, of any language that has the functions of the NumPy one (foreign.py)."""
    say = progress or (lambda _: None)
    with mpmath.workdps(DIGITS + 15), precision(BITS):
        figures = [*kernel.measured(module, say)]
        say("the rest")
        figures += _figures_rest(kernel, module)
    for figure in figures:
        if not figure.error <= figure.bound:
            raise VerificationError(
                f"{kernel.column.name}: {figure.what} at {figure.where} is off by {figure.error:.2e}, "
                f"bound {figure.bound:.2e}"
            )
    return tuple(figures)


# --- matrices -----------------------------------------------------------------------------------------------

DAMPING = {"alpha": 0.0123, "beta": 0.456}
_POWERS = (0, 2, -2, 5, -5, 10, -10, 20, -20, 40, -40)


def matrix_figures(
    kernel: BeamKernel, module: ModuleType, reference: Reference, N: int, in_fractions: Any = None
) -> Iterator[Figure]:
    """Each entry within the bound of what its terms can be: monomials times norms (∫ φ² dx)^½ and end values.

    Raises VerificationError where M, E or H of a basis in fractions is not exactly what the integrals are.
    """
    basis, system = module.basis(N), kernel.system
    defaults = {p.name: float(p.default) for p in kernel.column.parameters}
    matrices: dict[str, tuple[Form, Callable[..., Any]]] = {
        "M": (system.M, module.mass),
        "E": (system.E, module.stiffness_elastic),
        "H": (system.H, module.stiffness_load),
        "C": (system.C, lambda basis, rigid, **own: module.damping(basis, rigid=rigid, **own)),
    }
    for letter, (form, function) in matrices.items():
        damping = DAMPING if letter == "C" else {}
        worst = ("", 0.0)
        for values in samples(form, defaults | damping):
            computed = function(basis, True, **values)
            where = ", ".join(f"{name} = {value:.6g}" for name, value in values.items()) or "no parameters"
            if not np.isfinite(computed).all():
                raise VerificationError(f"{letter} is not finite at {where}")
            if not np.array_equal(function(basis, False, **values), computed[-N:, -N:]):
                raise VerificationError(
                    f"{letter} without the rigid functions is not the elastic block of the one with them"
                )
            if letter == "C":  # a sum of two matrices, whose own terms may cancel
                shares = ((system.c_M, system.M), (system.c_E, system.E))
                scale = sum(size(c, values) * scale_of(part, values, reference) for c, part in shares)
            else:
                scale = scale_of(form, values, reference)
            if in_fractions is not None and letter != "C" and rational(form, values):
                exact = reference.form(form, values)
                found = function(in_fractions, True, **{name: fraction(value) for name, value in values.items()})
                if any(a != b for a, b in zip(found.flat, exact.flat, strict=True)):
                    raise VerificationError(f"{letter} in exact fractions is not what the integrals are, at {where}")
            errors = reference.errors(computed, form, values)
            errors[errors <= 1e-40 * np.max(scale)] = 0  # of the reference, in what vanishes
            errors = np.divide(errors, scale, out=np.where(errors > 0, np.inf, 0.0), where=scale > 0)
            i, j = np.unravel_index(int(errors.argmax()), errors.shape)
            if errors[i, j] >= worst[1]:
                worst = (f"row {i + 1}, column {j + 1}, {where}", float(errors[i, j]))
        yield Figure(f"entries of {letter} up to N = {N}, of the norms of their terms", *worst, BOUND)


class Sizes(Protocol):
    """How large functions are, in floats: (∫ (φ^(order))² dx)^½ and φ^(order) at an end of each."""

    def norms(self, order: int) -> Any: ...
    def at_end(self, end: int, order: int) -> Any: ...


def scale_of(form: Form, values: dict[str, float], sizes: Sizes) -> Any:
    """What the terms of each entry can be: nothing cancels in it."""
    scale: Any = 0.0
    for (_, p, q), factor in form.along.items():
        scale = scale + size(factor, values) * np.outer(sizes.norms(p), sizes.norms(q))
    for (a, p, b, q), factor in form.points.items():
        product = np.outer(sizes.at_end(int(a), p), sizes.at_end(int(b), q))
        scale = scale + size(factor, values) * np.abs(product)
    return scale


def size(factor: Expr, values: dict[str, float]) -> float:
    """The sum of the sizes of a factor's monomials."""
    return float(sum(abs(number_of(term, values)) for term in Add.make_args(expand(factor))))


def samples(form: Form, defaults: dict[str, float]) -> list[dict[str, float]]:
    """Values of the parameters at which the form's constant tables are seen, one after the other.

    A form is a sum of constant tables, each times a monomial in the parameters. Beside the defaults there is a place
    for each table, at which its monomial has as large a share as can be had; parameters that are in none take another
    value too. Functions of a parameter are looked at for all sizes of it and both signs, as far as they are real and
    its assumptions allow.
    """
    sizes: dict[Expr, float] = {}  # of the largest number before each monomial
    for factor in (*form.along.values(), *form.points.values()):
        for number, monomial in (term.as_coeff_Mul() for term in Add.make_args(expand(factor))):
            sizes[monomial] = max(sizes.get(monomial, 0.0), abs(float(number)))
    symbols = sorted({s for monomial in sizes for s in monomial.free_symbols}, key=str)
    compiled = lambdify(symbols, list(sizes), "mpmath")

    def shares(place: tuple[float, ...]) -> list[float]:
        """Of each monomial in the sum of their sizes; all nothing where the form has no value."""
        try:
            found = [abs(mpmath.mpf(v)) * size for v, size in zip(compiled(*place), sizes.values(), strict=True)]
        except (ArithmeticError, TypeError, ValueError):  # a pole, or not real
            found = []
        total = sum(found)
        sound = all(map(_allowed, symbols, place)) and 0 < total < 1e100
        return [float(v / total) for v in found] if sound else [0.0] * len(sizes)

    def beside(place: tuple[float, ...], n: int) -> list[tuple[float, ...]]:
        """Places with other values of the n-th parameter: sums of few powers of two, unlike for each parameter."""
        values = (sign * math.ldexp(17 + 2 * n, power - 4) for power in _POWERS for sign in (1, -1))
        return [(*place[:n], value, *place[n + 1 :]) for value in values]

    start = tuple(defaults[str(symbol)] for symbol in symbols)
    places = [start]
    for k in range(len(sizes)):
        place = start
        for n in [*range(len(symbols))] * 2:
            tried = [place, *beside(place, n)]
            place = max(tried, key=lambda p: -1.0 if p in places else shares(p)[k] or -1.0)
        places.append(place)
    if not all(monomial.is_polynomial(*symbols) for monomial in sizes):
        places += [place for n in range(len(symbols)) for place in beside(start, n) if any(shares(place))]
    others = {name: value + 0.8125 for name, value in defaults.items()}
    found = [others | dict(zip(map(str, symbols), place, strict=True)) for place in dict.fromkeys(places)]
    return [defaults, *(values for values in found if values != defaults)]


def _allowed(symbol: Symbol, value: float) -> bool:
    """Whether a parameter's assumptions allow a value."""
    number = Rational(*value.as_integer_ratio())
    said = ((getattr(symbol, kind), getattr(number, kind)) for kind in ("is_positive", "is_negative", "is_integer"))
    return all(assumed in (None, true) for assumed, true in said)


def _figures_rest(kernel: Kernel, module: ModuleType) -> Iterator[Figure]:
    if isinstance(kernel, BeamKernel) and kernel.system.forces:
        basis = module.basis(8)
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
    given |= {p.symbol: Fraction(float(p.default)) for p in kernel.column.parameters}
    exact_scales = {
        n: mpmath.mpmathify(e.subs({s: v.numerator / v.denominator for s, v in given.items()}).evalf(40))
        for n, e in kernel.column.scales.items()
    }
    error = max(float(abs(mpmath.mpf(scales[n]) / exact_scales[n] - 1)) for n in exact_scales)
    yield Figure("scales of the SI units", "one beam", error, BOUND)


def _figure_newmark(module: ModuleType) -> Figure:
    """The step against the equations that define it, solved in exact fractions for a system of two coordinates."""
    M, C, K = (fmpq_mat(2, 2, entries) for entries in ([2, 1, 1, 3], [1, 0, 2, 1], [40, -8, 5, 30]))
    q, dq, ddq, F = (fmpq_mat(2, 1, entries) for entries in ([1, 2], [-3, 1], [4, -5], [7, 6]))
    h, b, g = fmpq(1, 8), fmpq(3, 8), fmpq(5, 8)

    predicted, rate = q + h * dq + h * h * (fmpq(1, 2) - b) * ddq, dq + h * (1 - g) * ddq
    a = (M + g * h * C + b * h * h * K).solve(F - C * rate - K * predicted)
    exact_step = predicted + b * h * h * a, rate + g * h * a, a

    def floats(matrix: fmpq_mat) -> Any:
        return np.array([[float(v) for v in row] for row in matrix.tolist()])

    computed = module.newmark_step(*map(floats, (M, C, K, q, dq, ddq, F)), 0.125, (0.375, 0.625))
    pairs = zip(computed, map(floats, exact_step), strict=True)
    error = max(float((np.abs(found - exact) / np.maximum(1, np.abs(exact))).max()) for found, exact in pairs)
    return Figure("one Newmark step", "a system of two coordinates", error, BOUND)


_METHODS = ((0.25, 0.5), (1 / 6, 0.5), (0.0, 0.5), (0.1, 0.6), (0.4, 0.7), (0.2, 0.45), (0.3, 0.4))


def _figure_limit(module: ModuleType) -> Figure:
    """The largest stable step against the growth of one step of one oscillator, as its own definition gives it."""
    worst = ("", 0.0)
    for (b, g), xi in itertools.product(_METHODS, (0.0, 0.05, 3.0)):
        where = f"xi = {xi}, newmark = ({b:.4g}, {g:.4g})"
        limit = module.newmark_limit(xi, (b, g))
        below = np.geomspace(1e-3, 1e5, 5) if limit == math.inf else limit * np.linspace(0.1, 0.999, 6)
        if any(_grows(step, xi, b, g) for step in below):
            raise VerificationError(f"newmark_limit at {where} is {limit}, but steps below it grow")
        if limit == math.inf:
            continue
        low, high = limit * (1 - 1e-9), limit * (1 + 1e-9) + 1e-6 * (limit == 0)
        if not _grows(high, xi, b, g):
            raise VerificationError(f"newmark_limit at {where} is {limit}, but steps beyond it are stable")
        ends = [arb(low), arb(high)]
        for _ in range(40 if limit else 0):
            middle = (ends[0] + ends[1]) / 2
            ends[_grows(middle, xi, b, g)] = middle
        error = float(abs(limit / ends[0] - 1)) if limit else 0.0
        if error >= worst[1]:
            worst = (where, error)
    return Figure("relative error of the largest stable Newmark step", *worst, BOUND)


def _grows(step: Any, *method: float) -> bool:
    """Whether a Newmark step of ddq + 2 xi step dq + step² q = 0 over a unit of time has a spectral radius above 1."""
    step, xi, b, g = map(arb, (step, *method))
    columns = []
    for q, dq in ((1, 0), (0, 1)):
        ddq = -2 * xi * step * dq - step**2 * q
        predicted, rate = q + dq + (arb(0.5) - b) * ddq, dq + (1 - g) * ddq
        new = -(2 * xi * step * rate + step**2 * predicted) / (1 + 2 * xi * g * step + b * step**2)
        columns.append((predicted + b * new, rate + g * new))
    half = (columns[0][0] + columns[1][1]) / 2
    root = acb(half**2 - columns[0][0] * columns[1][1] + columns[0][1] * columns[1][0]).sqrt()
    limit = 1 + arb("1e-25")  # a radius of 1 is rounded
    return bool(abs(half + root) > limit or abs(half - root) > limit)
