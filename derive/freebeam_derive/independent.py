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
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache, lru_cache
from types import ModuleType
from typing import Any

import mpmath
import numpy as np
from flint import arb, arb_mat, fmpq, fmpq_poly
from sympy import Expr, Poly, Pow, Rational, lambdify

from freebeam_derive.certify.balls import precision
from freebeam_derive.notation import x
from freebeam_derive.ritz import Form
from freebeam_derive.statement import GEOMETRIC

DIGITS = 50
BITS = 200  # in which sums are taken: 60 digits
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
def _quadrature() -> list[tuple[mpmath.mpf, mpmath.mpf]]:
    """Nodes and weights of a composite Gauss-Legendre rule for products of the first 64 modes.

    Three panels of 96 nodes: products up to γ_i + γ_j = 410 turn through 137 radians a panel, which 96 nodes
    integrate to better than 1e-55 of the largest value.
    """
    panels = 3
    with mpmath.workdps(DIGITS + 20):
        rule = gauss(96, mpmath.mp.prec)
        return [((k + node) / panels, weight / panels) for k in range(panels) for node, weight in rule]


def gauss(count: int, bits: int) -> list[tuple[mpmath.mpf, mpmath.mpf]]:
    """Nodes and weights of the Gauss-Legendre rule on 0 ≤ x ≤ 1, (count,)."""
    with precision(bits):
        pairs = (arb.legendre_p_root(count, k, weight=True) for k in range(count))
        return [(mpmath.mpf(((1 + node) / 2).mid()), mpmath.mpf((weight / 2).mid())) for node, weight in pairs]


class Reference(ABC):
    """Matrices of bilinear forms from integrals and end values of functions, rigid ones first, in numbers of a kind."""

    def __init__(self) -> None:
        self._integrals: dict[tuple[int, int, int], Any] = {}

    @abstractmethod
    def number(self, factor: Expr, parameters: dict[str, float]) -> Any:
        """A factor of a form at given parameters."""

    @abstractmethod
    def at(self, end: int, order: int) -> Any:
        """φ^(order) at an end of each function."""

    @abstractmethod
    def between(self, k: int, p: int, q: int) -> list[list[Any]]:
        """∫ x^k φ_i^(p) φ_j^(q) dx of each pair of functions."""

    def integral(self, *key: int) -> Any:
        """The same as an array, computed once."""
        if key not in self._integrals:
            self._integrals[key] = np.array(self.between(*key), dtype=object)  # type: ignore[index]
        return self._integrals[key]  # type: ignore[index]

    def form(self, form: Form, parameters: dict[str, float]) -> Any:
        """The whole matrix of a bilinear form."""
        total: Any = 0
        for key, factor in form.along.items():
            total = total + self.number(factor, parameters) * self.integral(*key)
        for (a, p, b, q), factor in form.points.items():
            total = total + self.number(factor, parameters) * np.outer(self.at(int(a), p), self.at(int(b), q))
        return total

    def errors(self, computed: Any, form: Form, parameters: dict[str, float]) -> Any:
        """|computed − exact| of each entry of a form's matrix, in floats."""
        exact = np.vectorize(fraction, otypes=[object])(computed)
        return np.abs(exact - self.form(form, parameters)).astype(float)

    def norms(self, order: int) -> Any:
        """(∫ (φ^(order))² dx)^½ of each function, in floats."""
        return np.sqrt(np.diagonal(self.integral(0, order, order)).astype(float))

    def at_end(self, end: int, order: int) -> Any:
        """φ^(order) at an end of each function, in floats."""
        return self.at(end, order).astype(float)


class Products(Reference):
    """Modes and the rigid functions before them, by quadrature in balls of BITS bits."""

    def __init__(self, modes: Sequence[Mode], rigid: tuple[Expr, ...]) -> None:
        super().__init__()
        self.nodes, self.weights = zip(*_quadrature(), strict=True)
        places = (*self.nodes, mpmath.mpf(0), mpmath.mpf(1))
        with precision(BITS):
            functions = [
                *([[arb(polynomial_at(f, d, place)) for place in places] for d in range(4)] for f in rigid),
                *([[v * arb(m.gamma) ** d for v in row] for d, row in enumerate(m.values(places))] for m in modes),
            ]
        self.inside = [[function[d][:-2] for function in functions] for d in range(4)]
        self.ends = np.array([[[f[d][end] for f in functions] for d in range(4)] for end in (-2, -1)], dtype=object)

    def number(self, factor: Expr, parameters: dict[str, float]) -> arb:
        return arb(number_of(factor, parameters))

    def at(self, end: int, order: int) -> Any:
        return self.ends[end, order]

    def between(self, k: int, p: int, q: int) -> list[list[arb]]:
        weights = [arb(weight * node**k) for node, weight in zip(self.nodes, self.weights, strict=True)]
        left = arb_mat([[v * weight for v, weight in zip(row, weights, strict=True)] for row in self.inside[p]])
        products: list[list[arb]] = (left * arb_mat(self.inside[q]).transpose()).tolist()
        return products


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


def independent_polynomials(ends: tuple[str, str], rigid: tuple[Expr, ...], count: int) -> list[list[fmpq_poly]]:
    """The rigid functions and `count` elastic ones in powers of x, exact, each with its derivatives to the third."""
    hermite = {(0, 0): [1, 0, -3, 2], (0, 1): [0, 1, -2, 1], (1, 0): [0, 0, 3, -2], (1, 1): [0, 0, -1, 1]}
    held = {(end, order) for end, kind in enumerate(ends) for order in GEOMETRIC[kind]}
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
    for n in sorted(of_degree)[: len(rigid) + count]:
        polynomial = of_degree[n]
        for other in orthogonal:
            polynomial -= other * (integral_of(polynomial * other) / integral_of(other * other))
        orthogonal.append(polynomial * (math.comb(2 * n, n) / _leading(polynomial)))
    listed = [fmpq_poly([fmpq(int(c.p), int(c.q)) for c in Poly(f, x).all_coeffs()[::-1]]) for f in rigid]
    functions = []
    for function in (*listed, *orthogonal[len(rigid) :]):
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


class PolynomialProducts(Reference):
    """Polynomials with their derivatives, exact; an irrational factor has 60 digits."""

    def __init__(self, functions: list[list[fmpq_poly]]) -> None:
        super().__init__()
        self.functions = functions

    def number(self, factor: Expr, parameters: dict[str, float]) -> fmpq:
        return number_with_digits(factor, parameters)[0]

    def at(self, end: int, order: int) -> Any:
        return np.array([f[order](end) for f in self.functions], dtype=object)

    def between(self, k: int, p: int, q: int) -> list[list[fmpq]]:
        left = [fmpq_poly([0] * k + [1]) * f[p] for f in self.functions]
        return [[integral_of(a * f[q]) for f in self.functions] for a in left]


def rational(form: Form, parameters: dict[str, float]) -> bool:
    """Whether a form's factors are all rational at given parameters."""
    return all(number_with_digits(factor, parameters)[1] for factor in (*form.along.values(), *form.points.values()))


def number_with_digits(factor: Expr, parameters: dict[str, float]) -> tuple[fmpq, bool]:
    """A factor of a form at given parameters, and whether it is exact: an irrational one has 60 digits, and no
    fractions compute one with a root or another power that happens to be rational."""
    if all(power.exp.is_Integer for power in factor.atoms(Pow)):
        value = factor.xreplace({s: Rational(*parameters[str(s)].as_integer_ratio()) for s in factor.free_symbols})
        if value.is_Rational:
            return fmpq(int(value.p), int(value.q)), True
    return fmpq(int(mpmath.ldexp(number_of(factor, parameters), BITS)), 2**BITS), False
