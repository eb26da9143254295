"""The independent route that emitted kernels are held to: modes by quadrature at 50 digits, polynomials in fractions.

Nothing of the derivation's closed forms is used. Roots are those of the 4 × 4 determinant of the end conditions in
sin, cos, sinh and cosh, modes its null vectors (computed with as many digits as cosh loses; their values come in balls
whose radii show it), integrals mpmath's Gauss-Legendre sums. What is taken over is the statement: the bilinear forms of
Eq. (11) and the orders that vanish at the ends.

Polynomials are made anew in powers of x, in exact fractions, from the conditions at the ends and Gram and Schmidt.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cache, lru_cache
from types import ModuleType
from typing import Any

import mpmath
import numpy as np
from flint import arb, arb_mat, fmpq, fmpq_poly
from sympy import Expr, Poly, Rational, lambdify

from freebeam_derive.certify.balls import precision
from freebeam_derive.kernel import PolynomialKernel
from freebeam_derive.notation import x
from freebeam_derive.ritz import Form
from freebeam_derive.statement import GEOMETRIC

DIGITS = 50
BITS = 200  # fixed point in which the sums are taken: 60 digits
_SHARP = arb(2) ** -180  # radius within which a mode is known: 54 digits


class VerificationError(ArithmeticError):
    """An emitted kernel differs from the independent route by more than its bound."""


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
    bits = BITS + 60 + math.ceil(3 * near)  # cosh loses γ / ln 2 bits in the determinant and again in the mode
    with mpmath.workprec(bits):

        def determinant(g: mpmath.mpf) -> mpmath.mpf:
            with precision(bits):
                return mpmath.mpf(arb_mat(_conditions(g, orders).tolist()).det().mid())

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
            if residual < mpmath.mpf(2) ** (-BITS) * max(abs(f) for f in factors):
                return Mode(root, tuple(factors), bits)
        raise VerificationError(f"mode {index}: no null vector at {near}")


def none_skipped(module: ModuleType, orders: tuple[tuple[int, ...], tuple[int, ...]], modes: int) -> None:
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
    """Nodes and fixed-point weights of a composite Gauss-Legendre rule for products of the first 64 modes.

    Three panels of 96 nodes: products up to γ_i + γ_j = 410 turn through 137 radians a panel, which 96 nodes
    integrate to better than 1e-55 of the largest value.
    """
    panels = 3
    with mpmath.workdps(DIGITS + 20):
        rule = gauss(96, mpmath.mp.prec)
        nodes = [(k + node) / panels for k in range(panels) for node, _ in rule]
        weights = [_fixed(weight / panels) for _ in range(panels) for _, weight in rule]
    return tuple(nodes), tuple(weights)


def gauss(count: int, bits: int) -> list[tuple[mpmath.mpf, mpmath.mpf]]:
    """Nodes and weights of the Gauss-Legendre rule on 0 ≤ x ≤ 1, (count,)."""
    with precision(bits):
        pairs = (arb.legendre_p_root(count, k, weight=True) for k in range(count))
        return [(mpmath.mpf(((1 + node) / 2).mid()), mpmath.mpf((weight / 2).mid())) for node, weight in pairs]


class Products:
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
        """The whole matrix of a bilinear form, rigid functions first, in integers of 2^-BITS."""
        size = len(self.rigid) + self.count
        total = np.zeros((size, size), dtype=object)
        for key, factor in form.along.items():
            total = total + (_fixed(number_of(factor, parameters)) * self._integral(*key) >> BITS)
        for (a, p, b, q), factor in form.points.items():
            product = self._at(int(a), p)[:, None] * self._at(int(b), q) >> BITS
            total = total + (_fixed(number_of(factor, parameters)) * product >> BITS)
        return total

    def errors(self, computed: Any, form: Form, parameters: dict[str, float]) -> Any:
        """|computed − exact| of each entry of a form's matrix, in floats."""
        mantissa, exponent = np.frexp(computed)
        shifts = (exponent - 53 + BITS).ravel().tolist()
        pairs = zip((int(v) for v in np.ldexp(mantissa, 53).ravel()), shifts, strict=True)
        whole = np.array([v << n if n >= 0 else v >> -n for v, n in pairs], dtype=object)
        return np.abs(whole.reshape(computed.shape) - self.form(form, parameters)).astype(float) * 2.0**-BITS

    def norms(self, order: int) -> Any:
        """(∫ (φ^(order))² dx)^½ of each function, rigid ones first, in floats."""
        return np.sqrt(np.diagonal(self._integral(0, order, order)).astype(float)) * 2.0 ** (-BITS / 2)

    def at_end(self, end: int, order: int) -> Any:
        """φ^(order) at an end of each function, rigid ones first, in floats."""
        return self._at(end, order).astype(float) * 2.0**-BITS

    def _integral(self, k: int, p: int, q: int) -> Any:
        if (k, p, q) not in self._integrals:
            powers = np.array([_fixed(node**k) for node in self.nodes], dtype=object)
            left, right = self._rows(p), self._rows(q)
            summed = ((left * ((self.weights * powers) >> BITS)) >> BITS) @ right.T
            self._integrals[k, p, q] = ((summed * self._powers(p)[:, None]) >> 2 * BITS) * self._powers(q) >> BITS
        return self._integrals[k, p, q]

    def _powers(self, order: int) -> Any:
        return np.array([_fixed(g**order) for g in [mpmath.mpf(1)] * len(self.rigid) + self.roots], dtype=object)

    def _rows(self, order: int) -> Any:
        rigid = [[_fixed(polynomial_at(f, order, node)) for node in self.nodes] for f in self.rigid]
        return np.array([*rigid, *self.values[order]], dtype=object)

    def _at(self, end: int, order: int) -> Any:
        rigid = [polynomial_at(f, order, mpmath.mpf(end)) for f in self.rigid]
        values = [*rigid, *(v * g**order for v, g in zip(self.ends[end, order], self.roots, strict=True))]
        return np.array([_fixed(v) for v in values], dtype=object)


def _fixed(value: mpmath.mpf) -> int:
    """A number in units of 2^-BITS."""
    return int(mpmath.ldexp(value, BITS))


def _middle(ball: arb) -> int:
    """The middle of a ball in units of 2^-BITS."""
    mantissa, exponent = ball.mid().man_exp()
    shift = int(exponent) + BITS
    return int(mantissa) << shift if shift >= 0 else int(mantissa) >> -shift


def polynomial_at(function: Expr, order: int, place: mpmath.mpf) -> mpmath.mpf:
    return mpmath.polyval([mpmath.mpf(p) / q for p, q in _coefficients(function, order)], place)


@cache
def _coefficients(function: Expr, order: int) -> tuple[tuple[int, int], ...]:
    derivative = function.diff(x, order) if order else function
    return tuple((int(c.p), int(c.q)) for c in Poly(derivative, x).all_coeffs())


def number_of(factor: Expr, parameters: dict[str, float]) -> mpmath.mpf:
    """A factor of a form at given parameters, to the digits of the scope."""
    symbols = sorted(factor.free_symbols, key=str)
    value = lambdify(symbols, factor, "mpmath")(*(mpmath.mpf(parameters[str(s)]) for s in symbols))
    return mpmath.mpf(value)


# --- polynomials ---------------------------------------------------------------------------------------------


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
            polynomial -= other * (integral_of(polynomial * other) / integral_of(other * other))
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


def integral_of(polynomial: fmpq_poly) -> fmpq:
    """∫ over 0 ≤ x ≤ 1."""
    return polynomial.integral()(1)


def fraction(value: float) -> fmpq:
    return fmpq(*float(value).as_integer_ratio())


def exactly(value: fmpq) -> Fraction:
    return Fraction(int(value.p), int(value.q))


class PolynomialProducts:
    """Integrals of x^k φ_i^(p) φ_j^(q) and end values of polynomials, exact."""

    def __init__(self, functions: list[list[fmpq_poly]]) -> None:
        self.functions = functions
        self._integrals: dict[tuple[int, int, int], Any] = {}

    def form(self, form: Form, parameters: dict[str, float]) -> Any:
        """The whole matrix of a bilinear form, rigid functions first: exact, irrational factors to 60 digits."""
        total = np.full((len(self.functions),) * 2, fmpq(0), dtype=object)
        for key, factor in form.along.items():
            total = total + _rational(factor, parameters)[0] * self._integral(*key)
        for (a, p, b, q), factor in form.points.items():
            product = self._at(int(a), p)[:, None] * self._at(int(b), q)
            total = total + _rational(factor, parameters)[0] * product
        return total

    def errors(self, computed: Any, form: Form, parameters: dict[str, float]) -> Any:
        """|computed − exact| of each entry of a form's matrix, in floats."""
        pairs = zip(computed.ravel().tolist(), self.form(form, parameters).flat, strict=True)
        return np.array([abs(float(exactly(fraction(v) - e))) for v, e in pairs]).reshape(computed.shape)

    def norms(self, order: int) -> Any:
        """(∫ (φ^(order))² dx)^½ of each function, rigid ones first, in floats."""
        return np.sqrt([float(exactly(integral_of(f[order] * f[order]))) for f in self.functions])

    def at_end(self, end: int, order: int) -> Any:
        """φ^(order) at an end of each function, rigid ones first, in floats."""
        return np.array([float(exactly(v)) for v in self._at(end, order)])

    def _integral(self, k: int, p: int, q: int) -> Any:
        if (k, p, q) not in self._integrals:
            left = [fmpq_poly([0] * k + [1]) * f[p] for f in self.functions]
            rows = [[integral_of(a * f[q]) for f in self.functions] for a in left]
            self._integrals[k, p, q] = np.array(rows, dtype=object)
        return self._integrals[k, p, q]

    def _at(self, end: int, order: int) -> Any:
        return np.array([f[order](end) for f in self.functions], dtype=object)


def rational(form: Form, parameters: dict[str, float]) -> bool:
    """Whether a form's factors are all rational at given parameters."""
    return all(_rational(factor, parameters)[1] for factor in (*form.along.values(), *form.points.values()))


def _rational(factor: Expr, parameters: dict[str, float]) -> tuple[fmpq, bool]:
    """A factor of a form at given parameters, and whether it is exact: an irrational one has 60 digits."""
    given = {s: Rational(*parameters[str(s)].as_integer_ratio()) for s in factor.free_symbols}
    value = factor.xreplace(given)
    if value.is_Rational:
        return fmpq(int(value.p), int(value.q)), True
    return fmpq(_fixed(number_of(factor, parameters)), 2**BITS), False
