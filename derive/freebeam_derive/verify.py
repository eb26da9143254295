"""Emitted kernels against an independent high-precision route: quadrature of the modes themselves, 50 digits.

Nothing of the derivation's closed forms is used. Roots are those of the 4 × 4 determinant of the end conditions in
sin, cos, sinh and cosh, modes its null vectors (computed with as many digits as cosh loses; their values come in balls
whose radii show it), integrals mpmath's Gauss-Legendre sums. What is taken over is the statement: the bilinear forms of
Eq. (11) and the orders that vanish at the ends.

Polynomials are made anew in powers of x, in exact fractions, from the conditions at the ends and Gram and Schmidt;
their integrals are exact, and what a module computes in fractions must equal them.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cache, lru_cache
from types import ModuleType
from typing import Any

import mpmath
import numpy as np
from flint import arb, fmpq, fmpq_poly
from sympy import Expr, Poly, Rational, lambdify

from freebeam_derive.certify.balls import precision
from freebeam_derive.kernel import ColumnKernel, Kernel, PolynomialKernel
from freebeam_derive.notation import EI, L, gamma, m, x
from freebeam_derive.ritz import Form
from freebeam_derive.scaling import SCALES
from freebeam_derive.statement import GEOMETRIC

MATRIX_MODES = 64  # all entries up to here
EXACT_MODES = 40  # modes and derivatives within BOUND up to here
HIGH_MODES = (48, 64, 100, 200)  # and within 4 u gamma at these
POLYNOMIALS = 40  # elastic polynomials, all entries and derivatives up to the third
BOUND = 1e-14
SERIES_BOUND = BOUND  # of polynomials, their derivatives and matrices
DIGITS = 50
_BITS = 200  # fixed point in which the sums are taken: 60 digits
_SHARP = arb(2) ** -180  # radius within which a mode is known: 54 digits
_UNIT = 2.0**-53

Progress = Callable[[str], None]


class VerificationError(ArithmeticError):
    """An emitted kernel differs from the independent route by more than its bound."""


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


# --- the independent route ----------------------------------------------------------------------------------


@dataclass(frozen=True)
class Mode:
    """A mode in classical functions: χ = a sin γx + b cos γx + c sinh γx + d cosh γx, a or else b being 1."""

    gamma: mpmath.mpf
    factors: tuple[mpmath.mpf, ...]
    bits: int

    def values(self, places: Sequence[mpmath.mpf]) -> list[list[arb]]:
        """χ^(d) / γ^d at places for d = 0…3, in balls."""
        rows: list[list[arb]] = [[], [], [], []]
        with precision(self.bits):
            root, (a, b, c, d) = arb(self.gamma), map(arb, self.factors)
            for place in places:
                u = root * arb(place)
                sine, cosine = u.sin_cos()
                growing = u.exp()
                decaying = 1 / growing
                s, h = (growing - decaying) / 2, (growing + decaying) / 2
                circular, turned = a * sine + b * cosine, a * cosine - b * sine
                even, odd = c * s + d * h, c * h + d * s
                for row, value in zip(
                    rows, (circular + even, turned + odd, even - circular, odd - turned), strict=True
                ):
                    if not value.rad() < _SHARP:
                        raise VerificationError(f"a mode at x = {place} is known to {value} only")
                    row.append(value)
        return rows


def _conditions(g: mpmath.mpf, orders: tuple[tuple[int, ...], tuple[int, ...]]) -> mpmath.matrix:
    """End conditions over (sin, cos, sinh, cosh), each row divided by γ^d and, at x = 1, by e^γ."""
    rows = []
    for place, ds in enumerate(orders):
        cosine, sine = mpmath.cos_sin(g * place)
        s, h = mpmath.sinh(g * place), mpmath.cosh(g * place)
        scale = mpmath.exp(-g * place)
        for d in ds:
            circular = [(sine, cosine), (cosine, -sine), (-sine, -cosine), (-cosine, sine)][d]
            hyperbolic = (s, h) if d % 2 == 0 else (h, s)
            rows.append([scale * v for v in (*circular, *hyperbolic)])
    return mpmath.matrix(rows)


def independent_mode(index: int, near: float, orders: tuple[tuple[int, ...], tuple[int, ...]]) -> Mode:
    """The mode whose root lies near a float, from the determinant of the end conditions."""
    bits = _BITS + 60 + math.ceil(3 * near)  # cosh loses γ / ln 2 bits in the determinant and again in the mode
    with mpmath.workprec(bits):

        def determinant(g: mpmath.mpf) -> mpmath.mpf:
            return mpmath.det(_conditions(g, orders))

        width = mpmath.mpf(2) ** -20
        if determinant(near - width) * determinant(near + width) >= 0:
            raise VerificationError(f"mode {index}: the determinant has no simple root near {near}")
        root = mpmath.findroot(
            determinant, (near, near + width / 1000), solver="secant", tol=0, maxsteps=60, verify=False
        )
        if abs(root - near) > width:
            raise VerificationError(
                f"mode {index}: the determinant's root {mpmath.nstr(root, 20)} is not the kernel's {near}"
            )
        matrix = _conditions(root, orders)
        for lead in (0, 1):
            fixed = [mpmath.mpf(0)] * lead + [mpmath.mpf(1)]
            unknown = range(lead + 1, 4)
            try:
                # any rows of full rank will do; the ones left out hold because the determinant vanishes
                choice = (0, 1, 2, 3) if lead else (0, 1, 2)
                left = mpmath.matrix([[matrix[r, c] for c in unknown] for r in choice])
                right = mpmath.matrix([-sum(matrix[r, c] * f for c, f in enumerate(fixed)) for r in choice])
                solution = mpmath.lu_solve(left, right)
            except ZeroDivisionError:
                continue
            factors = (*fixed, *solution)
            residual = max(abs(sum(matrix[r, c] * f for c, f in enumerate(factors))) for r in range(4))
            if residual < mpmath.mpf(2) ** (-_BITS) * max(abs(f) for f in factors):
                return Mode(root, tuple(factors), bits)
        raise VerificationError(f"mode {index}: no null vector at {near}")


def _none_skipped(module: ModuleType, orders: tuple[tuple[int, ...], tuple[int, ...]], modes: int) -> None:
    """The determinant changes sign once between neighbouring midpoints, and not before the first root."""
    roots = module.basis(modes).gamma
    with mpmath.workprec(120 + math.ceil(3 * float(roots[-1]))):
        near = [mpmath.mpf(float(roots[0])) * k / 16 for k in range(3, 16)]
        between = [(mpmath.mpf(float(a)) + mpmath.mpf(float(b))) / 2 for a, b in itertools.pairwise(roots)]
        signs = [mpmath.sign(mpmath.det(_conditions(g, orders))) for g in (*near, *between)]
    if len(set(signs[: len(near)])) != 1:
        raise VerificationError("the kernel's first root is not the first of the determinant")
    if any(a * b >= 0 for a, b in zip(signs[len(near) - 1 :], signs[len(near) :], strict=False)):
        raise VerificationError("the determinant does not change sign between neighbouring roots of the kernel")
    if max(np.diff(roots), default=3) > 4.5:
        raise VerificationError("neighbouring roots of the kernel lie too far apart: one was skipped")


@lru_cache(maxsize=1)
def _quadrature() -> tuple[tuple[mpmath.mpf, ...], tuple[int, ...]]:
    """Nodes and fixed-point weights of a composite Gauss-Legendre rule for products of modes up to MATRIX_MODES.

    Three panels of 96 nodes: products up to γ_i + γ_j = 410 turn through 137 radians a panel, which 96 nodes
    integrate to better than 1e-55 of the largest value.
    """
    panels = 3
    with mpmath.workdps(DIGITS + 20):
        rule = mpmath.calculus.quadrature.GaussLegendre(mpmath.mp).calc_nodes(6, mpmath.mp.prec)
        nodes = [(k + (1 + node) / 2) / panels for k in range(panels) for node, _ in rule]
        weights = [_fixed(weight / 2 / panels) for _ in range(panels) for _, weight in rule]
    return tuple(nodes), tuple(weights)


class _Products:
    """Integrals of x^k φ_i^(p) φ_j^(q) of many modes at once, from values at the nodes in exact integers."""

    def __init__(self, modes: list[Mode], rigid: tuple[Expr, ...]) -> None:
        nodes, weights = _quadrature()
        self.count, self.rigid, self.nodes = len(modes), rigid, nodes
        self._integrals: dict[tuple[int, int, int], Any] = {}
        self.weights = np.array(weights, dtype=object)
        self.roots = [mode.gamma for mode in modes]
        self.values = np.empty((4, len(modes), len(nodes)), dtype=object)
        self.ends = np.empty((2, 4, len(modes)), dtype=object)
        for n, mode in enumerate(modes):
            inside, outside = mode.values(nodes), mode.values([mpmath.mpf(0), mpmath.mpf(1)])
            for d in range(4):
                self.values[d, n] = [_middle(v) for v in inside[d]]
                for end in range(2):
                    self.ends[end, d, n] = mpmath.mpf(outside[d][end])

    def form(self, form: Form, parameters: dict[str, float]) -> Any:
        """The whole matrix of a bilinear form, rigid functions first, in integers of 2^-_BITS."""
        size = len(self.rigid) + self.count
        total = np.zeros((size, size), dtype=object)
        for (k, p, q), factor in form.along.items():
            if (k, p, q) not in self._integrals:
                powers = np.array([_fixed(node**k) for node in self.nodes], dtype=object)
                left, right = self._rows(p), self._rows(q)
                summed = ((left * ((self.weights * powers) >> _BITS)) >> _BITS) @ right.T
                self._integrals[k, p, q] = ((summed * self._powers(p)[:, None]) >> 2 * _BITS) * self._powers(q) >> _BITS
            total = total + (_fixed(_number(factor, parameters)) * self._integrals[k, p, q] >> _BITS)
        for (a, p, b, q), factor in form.points.items():
            product = self._at(int(a), p)[:, None] * self._at(int(b), q) >> _BITS
            total = total + (_fixed(_number(factor, parameters)) * product >> _BITS)
        return total

    def _powers(self, order: int) -> Any:
        return np.array([_fixed(g**order) for g in [mpmath.mpf(1)] * len(self.rigid) + self.roots], dtype=object)

    def _rows(self, order: int) -> Any:
        rigid = [[_fixed(_polynomial(f, order, node)) for node in self.nodes] for f in self.rigid]
        return np.array([*rigid, *self.values[order]], dtype=object)

    def _at(self, end: int, order: int) -> Any:
        rigid = [_polynomial(f, order, mpmath.mpf(end)) for f in self.rigid]
        values = [*rigid, *(v * g**order for v, g in zip(self.ends[end, order], self.roots, strict=True))]
        return np.array([_fixed(v) for v in values], dtype=object)


def _fixed(value: mpmath.mpf) -> int:
    """A number in units of 2^-_BITS."""
    return int(mpmath.ldexp(value, _BITS))


def _middle(ball: arb) -> int:
    """The middle of a ball in units of 2^-_BITS."""
    mantissa, exponent = ball.mid().man_exp()
    shift = int(exponent) + _BITS
    return int(mantissa) << shift if shift >= 0 else int(mantissa) >> -shift


def _polynomial(function: Expr, order: int, place: mpmath.mpf) -> mpmath.mpf:
    return mpmath.polyval([mpmath.mpf(p) / q for p, q in _coefficients(function, order)], place)


@cache
def _coefficients(function: Expr, order: int) -> tuple[tuple[int, int], ...]:
    derivative = function.diff(x, order) if order else function
    return tuple((int(c.p), int(c.q)) for c in Poly(derivative, x).all_coeffs())


def _number(factor: Expr, parameters: dict[str, float]) -> mpmath.mpf:
    """A factor of a form at given parameters."""
    symbols = sorted(factor.free_symbols, key=str)
    value = lambdify(symbols, factor, "mpmath")(*(mpmath.mpf(parameters[str(s)]) for s in symbols))
    return mpmath.mpf(value)


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
    _none_skipped(module, orders, 24)
    gamma_float = module.basis(max(HIGH_MODES)).gamma
    modes: dict[int, Mode] = {}
    for index in sorted({*range(1, MATRIX_MODES + 1), *HIGH_MODES}):
        modes[index] = independent_mode(index, float(gamma_float[index - 1]), orders)
    figures = [*_figures_roots(gamma_float, modes)]
    say("modes")
    figures += _figures_shapes(module, modes)
    say("matrices")
    products = _Products([modes[n] for n in range(1, MATRIX_MODES + 1)], kernel.rigid)
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


def _figures_matrices(kernel: ColumnKernel, module: ModuleType, products: _Products) -> Iterator[Figure]:
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
            errors = np.abs((_in_units(computed) - exact).astype(float)) * 2.0**-_BITS
            errors /= np.maximum(np.abs(exact.astype(float)) * 2.0**-_BITS, np.outer(size, size))
            i, j = np.unravel_index(int(errors.argmax()), errors.shape)
            if errors[i, j] >= worst[1]:
                worst = (f"row {i + 1}, column {j + 1}, {own or 'no parameters'}", float(errors[i, j]))
        yield Figure(f"entries of {letter} up to N = {MATRIX_MODES}, of max(|entry|, γ_i γ_j)", *worst, BOUND)


def _in_units(array: Any) -> Any:
    """A float array in integers of 2^-_BITS, exactly."""
    mantissa, exponent = np.frexp(array)
    whole = np.array([int(v) for v in np.ldexp(mantissa, 53).ravel()], dtype=object)
    shifts = exponent.ravel().astype(int) - 53 + _BITS
    shifted = [v << n if n >= 0 else v >> -n for v, n in zip(whole, shifts.tolist(), strict=True)]
    return np.array(shifted, dtype=object).reshape(array.shape)


def _figures_rest(kernel: Kernel, module: ModuleType) -> Iterator[Figure]:
    basis = module.basis(8)
    if kernel.system.forces:
        error = float(np.abs(module.force(basis, 0.3) - module.shapes(basis, 0.3)).max())
        rigid = module.force(basis, 0.3, True)
        for n, function in enumerate(kernel.rigid):
            error = max(error, float(abs(mpmath.mpf(float(rigid[n])) - _polynomial(function, 0, mpmath.mpf(0.3)))))
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


def independent_polynomials(kernel: PolynomialKernel, count: int) -> list[list[fmpq_poly]]:
    """The rigid functions and `count` elastic ones in powers of x, exact, each with its derivatives to the third."""
    hermite = {(0, 0): [1, 0, -3, 2], (0, 1): [0, 1, -2, 1], (1, 0): [0, 0, 3, -2], (1, 1): [0, 0, -1, 1]}
    held = {(end, order) for end, kind in enumerate(kernel.column.ends) for order in GEOMETRIC[kind]}
    # cubics that meet the conditions, and what meets all four that there may be
    spanning = [fmpq_poly(c) for place, c in hermite.items() if place not in held]
    spanning += [fmpq_poly([0] * n + [0, 0, 1, -2, 1]) for n in range(count)]
    of_degree: dict[int, fmpq_poly] = {}
    for polynomial in spanning:
        while polynomial.degree() in of_degree:
            other = of_degree[polynomial.degree()]
            polynomial -= other * (_leading(polynomial) / _leading(other))
        of_degree[polynomial.degree()] = polynomial
    orthogonal: list[fmpq_poly] = []
    for n in sorted(of_degree)[: len(kernel.rigid) + count]:
        polynomial = of_degree[n]
        for other in orthogonal:
            polynomial -= other * (_integral(polynomial * other) / _integral(other * other))
        orthogonal.append(polynomial * (math.comb(2 * n, n) / _leading(polynomial)))
    rigid = [fmpq_poly([fmpq(int(c.p), int(c.q)) for c in Poly(f, x).all_coeffs()[::-1]]) for f in kernel.rigid]
    functions = []
    for function in (*rigid, *orthogonal[len(rigid) :]):
        derivatives = [function]
        for _ in range(3):
            derivatives.append(derivatives[-1].derivative())
        functions.append(derivatives)
    return functions


def _leading(polynomial: fmpq_poly) -> fmpq:
    return polynomial[polynomial.degree()]


def _integral(polynomial: fmpq_poly) -> fmpq:
    """∫ over 0 ≤ x ≤ 1."""
    return polynomial.integral()(1)


def _fraction(value: float) -> fmpq:
    return fmpq(*float(value).as_integer_ratio())


def _figures_polynomials(module: ModuleType, functions: list[list[fmpq_poly]]) -> Iterator[Figure]:
    """Functions and their derivatives up to the third, relative to the largest value along the beam."""
    basis = module.basis(POLYNOMIALS)
    for order in range(4):
        computed = module.shapes(basis, _PLACES, order, True)
        largest = np.abs(module.shapes(basis, np.linspace(0, 1, 2001), order, True)).max(axis=1)
        worst = ("", 0.0)
        for n, function in enumerate(functions):
            for place, value in zip(_PLACES, computed[n].tolist(), strict=True):
                error = abs(float(_exactly(_fraction(value) - function[order](_fraction(place)))))
                error = error and (error / largest[n] if largest[n] else math.inf)
                if error >= worst[1]:
                    worst = (f"function {n + 1}, x = {place:.4g}", error)
        yield Figure(
            f"derivative {order} of polynomials up to N = {POLYNOMIALS}, of the largest value", *worst, SERIES_BOUND
        )


def _exactly(value: fmpq) -> Fraction:
    return Fraction(int(value.p), int(value.q))


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
            integrals[k, p, q] = np.array([[_integral(a * b[q]) for b in functions] for a in left], dtype=object)
        return integrals[k, p, q]

    def at_end(end: int, order: int) -> Any:
        return np.array([f[order](end) for f in functions], dtype=object)

    norms = [np.sqrt([float(_exactly(_integral(f[p] * f[p]))) for f in functions]) for p in range(4)]
    for letter, (form, function) in _matrices(kernel, module).items():
        worst = ("", 0.0)
        for own in _samples(kernel):
            exact = np.full((len(functions),) * 2, fmpq(0), dtype=object)
            scale, rational = np.zeros(exact.shape), True
            for (k, p, q), factor in form.along.items():
                size, sharp = _rational(factor, own | _DAMPING)
                rational &= sharp
                exact = exact + size * integral(k, p, q)
                scale += abs(float(_exactly(size))) * np.outer(norms[p], norms[q])
            for (a, p, b, q), factor in form.points.items():
                size, sharp = _rational(factor, own | _DAMPING)
                rational &= sharp
                product = at_end(int(a), p)[:, None] * at_end(int(b), q)
                exact = exact + size * product
                scale += abs(float(_exactly(size))) * np.abs([[float(_exactly(v)) for v in row] for row in product])
            computed = function(basis, True, **own)
            if not np.array_equal(function(basis, False, **own), computed[-POLYNOMIALS:, -POLYNOMIALS:]):
                raise VerificationError(
                    f"{letter} without the rigid functions is not the elastic block of the one with them"
                )
            if letter != "C" and rational:
                found = function(in_fractions, True, **{name: _fraction(value) for name, value in own.items()})
                if any(a != b for a, b in zip(found.flat, exact.flat, strict=True)):
                    raise VerificationError(f"{letter} in exact fractions is not what the integrals are")
            errors = np.array(
                [
                    [abs(float(_exactly(_fraction(v) - e))) for v, e in zip(*rows, strict=True)]
                    for rows in zip(computed.tolist(), exact.tolist(), strict=True)
                ]
            )
            errors = np.divide(errors, scale, out=np.where(errors > 0, np.inf, 0.0), where=scale > 0)
            i, j = np.unravel_index(int(errors.argmax()), errors.shape)
            if errors[i, j] >= worst[1]:
                worst = (f"row {i + 1}, column {j + 1}, {own or 'no parameters'}", float(errors[i, j]))
        yield Figure(f"entries of {letter} up to N = {POLYNOMIALS}, of the norms of their terms", *worst, SERIES_BOUND)


def _rational(factor: Expr, parameters: dict[str, float]) -> tuple[fmpq, bool]:
    """A factor of a form at given parameters, and whether it is exact: an irrational one has 60 digits."""
    given = {s: Rational(*parameters[str(s)].as_integer_ratio()) for s in factor.free_symbols}
    value = factor.xreplace(given)
    if value.is_Rational:
        return fmpq(int(value.p), int(value.q)), True
    return fmpq(_fixed(_number(factor, parameters)), 2**_BITS), False
