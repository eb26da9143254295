"""Polynomials as a second set of trial functions, for any pair of ends. Eq. (9), section 3.1.

P_k is Legendre's polynomial of order k on the beam, P_k(2x − 1). Of all polynomials that meet the geometric
conditions, φ_d is the one of degree d that is orthogonal to all of lower degree. For a free-free beam these are the
P_d themselves; elsewhere P_d less its conditions' representatives among the lower orders:

    φ_d = P_d − Σ_(k<d) (2k + 1) [σ_d σ_k Σ_0 ν_l ℓ_l(k) + Σ_1 ν_l ℓ_l(k)] P_k,    σ_k = (−1)^k

with ℓ_l(k) what condition l makes of P_k (σ_k apart at x = 0), Σ_0 and Σ_1 over the conditions at either end, and
factors ν_l that are rational in d. The first of the sequence are the rigid functions; the elastic ones follow, and
are orthogonal to them. Everything is rational, and solved for once and for all d.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from functools import cache, reduce
from types import ModuleType
from typing import Any

import numpy as np
from flint import fmpq, fmpq_poly
from sympy import (
    QQ,
    Add,
    Expr,
    Function,
    Integral,
    Matrix,
    Poly,
    Rational,
    S,
    Subs,
    Sum,
    Symbol,
    cancel,
    expand,
    factor,
    fraction,
    integrate,
    lcm,
    legendre,
    together,
)
from sympy.polys.matrices import DomainMatrix

from freebeam_derive import independent, rounding
from freebeam_derive.comparison import comparison_beam, integral_polynomials
from freebeam_derive.derivation import Derivation
from freebeam_derive.kernel import MATRICES, BeamKernel, Figure, Program, Progress
from freebeam_derive.notation import PRIMES, QUANTITIES, x
from freebeam_derive.record import Step, equal
from freebeam_derive.ritz import Form, display_form
from freebeam_derive.statement import GEOMETRIC
from freebeam_derive.verify import BOUND, PLACES, matrix_figures

STAGE = "polynomials"
SUFFIX = "_legendre"
POLYNOMIALS = 40  # verified: elastic polynomials, all entries and derivatives up to the third

k = Symbol("order", integer=True, nonnegative=True)  # order of a Legendre polynomial
d = Symbol("degree", integer=True, nonnegative=True)  # degree of a trial function


# --- Legendre's polynomials ---------------------------------------------------------------------------------


@cache
def end_value(p: int) -> Expr:
    """P_k^(p) at x = 1, a polynomial in k; at x = 0 it is (−1)^(k + p) times that.

    From Legendre's equation, differentiated: at x = 1 its highest derivative drops out.
    """
    if p == 0:
        return S.One
    polynomial = Function("P")(x)
    equation = (x * (1 - x) * polynomial.diff(x)).diff(x) + k * (k + 1) * polynomial
    held = equation.diff(x, p - 1).doit().expand()
    terms = {q: held.coeff(polynomial.diff(x, q) if q else polynomial).subs(x, 1) for q in range(p + 2)}
    assert terms[p + 1] == 0
    return factor(-sum(f * end_value(q) for q, f in terms.items() if q < p) / terms[p])


@cache
def products(power: int) -> tuple[Expr, ...]:
    """∫ x^power P_k P_(k+s) dx for s = 0…power, rational in k; it is zero for other distances.

    From the recurrence (k + 1) P_(k+1) = (2k + 1) (2x − 1) P_k − k P_(k−1).
    """
    shifted = {0: S.One}  # x^n P_k as a combination of P_(k+s)
    for _ in range(power):
        grown: dict[int, Expr] = {}
        for s, f in shifted.items():
            order = k + s
            for step, share in ((1, (order + 1) / (2 * order + 1)), (0, S.One), (-1, order / (2 * order + 1))):
                grown[s + step] = grown.get(s + step, S.Zero) + f * share / 2
        shifted = grown
    return tuple(factor(cancel(shifted[s] / (2 * (k + s) + 1))) for s in range(power + 1))


def summed(term: Expr, alternating: bool = False) -> Expr:
    """Σ_(k<d) term(k), or Σ_(k<d) (−1)^(d+k) term(k), for a polynomial term: a polynomial in d.

    Raises AssertionError where an alternating sum is none.
    """
    rest, total = Poly(term, k).replace(k, d), Poly(0, d)
    while not rest.is_zero:
        # S(d + 1) ∓ S(d) = ± term(d), the highest power first
        n = rest.degree()
        piece = Poly(rest.LC() * (Rational(-1, 2) * d**n if alternating else d ** (n + 1) / (n + 1)), d)
        grown = piece.compose(Poly(d + 1, d))
        rest -= -grown - piece if alternating else grown - piece
        total += piece
    if total.eval(0) != 0:
        raise AssertionError(f"the alternating sum of {term} is no polynomial times (−1)^d")
    return total.as_expr()


# --- trial functions ----------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Condition:
    """A geometric condition: the derivative of an order that vanishes at an end, 0 or 1.

    of: ℓ(k), what it makes of P_k, times (−1)^k at x = 0. weight: ν(d), how much of its representative φ_d lacks.
    """

    end: int
    order: int
    of: Expr
    weight: Expr = S.Zero


@dataclass(frozen=True)
class Polynomials:
    """The trial polynomials of a pair of ends.

    first: degree of the first elastic function; they take every degree from there. norm: ∫ φ_d² dx, rational in d.
    rigid: the rigid functions, which come before them.
    """

    ends: tuple[str, str]
    conditions: tuple[Condition, ...]
    first: int
    norm: Expr
    rigid: tuple[Expr, ...]
    steps: tuple[Step, ...] = field(compare=False)

    def value(self, end: int, order: int) -> Expr:
        """φ_d^(order) at x = 1, or (−1)^d times that at x = 0; rational in d."""
        of = end_value(order) if end else (-1) ** order * end_value(order)
        total = of.subs(k, d)
        for condition in self.conditions:
            term = (2 * k + 1) * condition.of * of
            total -= condition.weight * summed(expand(term), condition.end != end)
        return factor(cancel(total))


@cache
def polynomials(ends: tuple[str, str]) -> Polynomials:
    """Derive the trial polynomials of a pair of ends. Eq. (9)."""
    conditions = [
        Condition(end, order, end_value(order) if end else (-1) ** order * end_value(order))
        for end, kind in enumerate(ends)
        for order in GEOMETRIC[kind]
    ]
    norm = 1 / (2 * d + 1)
    if conditions:
        gram = Matrix([
            [summed(expand((2 * k + 1) * a.of * b.of), a.end != b.end) for b in conditions] for a in conditions
        ])  # fmt: skip
        right = Matrix([c.of.subs(k, d) for c in conditions])
        field_of_degree = QQ.frac_field(d)
        system = (DomainMatrix.from_Matrix(m).convert_to(field_of_degree) for m in (gram, right))
        weights = [factor(w) for w in next(system).lu_solve(next(system)).to_Matrix()]
        conditions = [replace(c, weight=w) for c, w in zip(conditions, weights, strict=True)]
        norm += sum(c.weight * c.of.subs(k, d) for c in conditions)
    rigid = comparison_beam(ends).rigid
    found = Polynomials(ends, tuple(conditions), len(conditions) + len(rigid), factor(cancel(norm)), rigid, ())
    return replace(found, steps=(*_steps(found), *admissibility(found)))


def coefficients(basis: Polynomials, degree: int) -> tuple[Rational, ...]:
    """φ_degree in P_0, P_1, …, exact."""
    held = [(c.end, c.weight.subs(d, degree), Poly(c.of, k)) for c in basis.conditions]
    lower = [
        -(2 * order + 1)
        * sum((w * of.eval(order) * (1 if end else (-1) ** (degree + order)) for end, w, of in held), S.Zero)
        for order in range(degree)
    ]
    return (*lower, S.One)


def series(polynomial: Expr) -> tuple[Rational, ...]:
    """A polynomial in x as a combination of P_0, P_1, …, exact."""
    return tuple(
        (2 * n + 1) * integrate(expand(polynomial * legendre(n, 2 * x - 1)), (x, 0, 1))
        for n in range(Poly(polynomial, x).degree() + 1)
    )


def _steps(basis: Polynomials) -> tuple[Step, ...]:
    phi, P = Function("phi_d")(x), Function("P")
    held = tuple(
        equal(Subs(phi.diff(x, c.order), x, c.end) if c.order else phi.subs(x, c.end), 0) for c in basis.conditions
    )
    weights = tuple(equal(Symbol(f"nu_{n}"), c.weight) for n, c in enumerate(basis.conditions, 1))
    lacking = Add(
        *(w.lhs * c.of * (1 if c.end else (-1) ** (d + k)) for w, c in zip(weights, basis.conditions, strict=True))
    )
    series_of = P(d, x) - (Sum((2 * k + 1) * lacking * P(k, x), (k, 0, d - 1)) if held else 0)
    return (
        Step(
            STAGE,
            "Take a polynomial of each degree that meets the geometric conditions",
            "each orthogonal to all of lower degree, made of Legendre's polynomials of 2x − 1; natural conditions are "
            "the energies' own and need not be met",
            held,
            (equal(phi, series_of), *weights),
            "Eq. (9)",
            "the conditions vanish identically in the degree",
        ),
        Step(
            STAGE,
            "Integrate their squares",
            "with the rigid functions they are orthogonal, so these are all integrals without derivatives",
            Integral(phi**2, (x, 0, 1)),
            basis.norm,
            "Eq. (11)",
            "Parseval's sum over Legendre's polynomials, in closed form",
        ),
    )


def admissibility(basis: Polynomials) -> tuple[Step, ...]:
    """Section 3.1's four conditions on admissible functions, checked for the polynomials of a pair of ends.

    Raises AssertionError where one does not hold.
    """
    values = tuple(basis.value(c.end, c.order) for c in basis.conditions)
    if any(values):
        raise AssertionError(f"the polynomials of {basis.ends} miss a geometric condition")
    # of degree ≤ n there are n + 1 − conditions independent polynomials, and as many trial functions: those of
    # degree `first` to n and the rigid ones
    degrees = [Poly(f, x).degree() for f in basis.rigid]
    if basis.first != len(basis.conditions) + len(basis.rigid) or any(n >= basis.first for n in degrees):
        raise AssertionError(f"the polynomials of {basis.ends} do not span those that meet the conditions")
    numerator, denominator = basis.norm.subs(d, d + basis.first).as_numer_denom()
    if any(c < 0 for part in (numerator, denominator) for c in Poly(part, d).all_coeffs()):
        raise AssertionError(f"the mass of a polynomial of {basis.ends} is not known to be positive")
    phi = Function("phi")(x)
    P = Function("P")
    slope = equal(P(k + 1, x).diff(x) - P(k - 1, x).diff(x), 2 * (2 * k + 1) * P(k, x))
    conditions = (
        ("1) they satisfy the geometric conditions", basis.ends, values, "each vanishes identically in the degree"),
        ("2) they can be differentiated as often as needed", phi, slope, "they are polynomials"),
        (
            "3) they are complete: with the rigid functions they span all polynomials that meet the conditions, which "
            "are dense (Weierstrass) in the functions of finite bending energy that do",
            d + 1 - len(basis.conditions),
            d + 1 - basis.first + len(basis.rigid),
            "one function for each dimension, all of different degree",
        ),
        (
            "4) they are linearly independent",
            Integral(phi**2, (x, 0, 1)),
            basis.norm,
            "orthogonal in mass, each of positive mass: no coefficient changes the sign",
        ),
    )
    return tuple(
        Step(STAGE, "Check that the functions are admissible", why, before, after, "section 3.1", proof)
        for why, before, after, proof in conditions
    )


# --- the kernel ---------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class SeriesProgram(Program):
    """One matrix over polynomials: a factor of the diagonal of ∫ φ², sums over series, products of end values.

    along: (p, q) -> factors of ∫ x^k φ_i^(p) φ_j^(q) by the power k. points: factor, row and column, each a field
    of the basis (`slope_1`).
    """

    diagonal: Expr
    along: dict[tuple[int, int], dict[int, Expr]]
    points: tuple[tuple[Expr, str, str], ...]
    symmetric: bool

    @property
    def scales(self) -> dict[tuple[int, int], Expr]:
        """What stands before the product of two series: the one factor, or 1 over the common denominator of several."""
        return {
            pair: 1 / reduce(lcm, (fraction(together(c))[1] for c in cs.values()))
            if len(cs) > 1
            else next(iter(cs.values()))
            for pair, cs in self.along.items()
        }

    @property
    def between(self) -> dict[tuple[int, int], dict[int, Expr]]:
        """What stands between them: factors of the integrals with x^k."""
        return {pair: {k: cancel(c / self.scales[pair]) for k, c in cs.items()} for pair, cs in self.along.items()}

    @property
    def terms(self) -> list[tuple[Expr, Any]]:
        """The matrix as a sum: factors of the norms, of products of series (by their orders), of end values."""
        along = [(scale, pair) for pair, scale in self.scales.items()]
        points = [(c, (row, column)) for c, row, column in self.points]
        norm = [(self.diagonal, "norm")] if self.diagonal != 0 or not (along or points) else []
        return [*norm, *along, *points]


@dataclass(frozen=True)
class LegendreKernel(BeamKernel):
    """All that is emitted for a column with polynomials as trial functions.

    values: (name, end, order, factor) of the end values: a function of the degree, times (−1)^degree at x = 0.
    """

    basis_name = "legendre"

    matrices: tuple[SeriesProgram, ...]
    basis: Polynomials
    values: tuple[tuple[str, int, int, Expr], ...]

    @property
    def orders(self) -> tuple[int, ...]:
        """The derivatives whose series are needed, 0 first."""
        used = {order for matrix in self.matrices for pair in matrix.along for order in pair}
        return tuple(range(max(used) + 1))

    @property
    def powers(self) -> tuple[int, ...]:
        """Powers of x in the matrices' sums over series."""
        return tuple(sorted({k for m in self.matrices for factors in m.along.values() for k in factors}))

    @property
    def fields(self) -> tuple[tuple[str, str], ...]:
        first, R = self.basis.first, len(self.rigid)
        every = f"{R} + N" if R else "N"
        size = f"({every},)"
        return (
            ("order", f"orders k of Legendre's polynomials P_k(2x − 1), ({first} + N,)"),
            ("sigma", f"(−1)^k, ({first} + N,)"),
            ("norm", f"∫ φ² dx, {size}"),
            *((name, f"φ{PRIMES[order]}({end}), {size}") for name, end, order, _ in self.values),
            *((QUANTITIES[p], f"φ{PRIMES[p]} in P_0, P_1, …, ({every}, {first} + N)") for p in self.orders),
        )

    def context(self) -> dict[str, Any]:
        first = self.basis.first
        numbered = list(enumerate(self.basis.conditions, start=1))
        squares = [integral_polynomials(f, f) for f in self.rigid]
        vectors = [("norm", squares, self.basis.norm, "")]
        for name, end, order, value in self.values:
            at_end = [f.diff(x, order).subs(x, end) for f in self.rigid]
            vectors.append((name, at_end, value, "" if end else f"sigma[{first}:] * "))
        return {
            "first": first,
            "shares": [[(n, c.of) for n, c in numbered if c.end == end] for end in range(2)],
            "weights": [c.weight for c in self.basis.conditions],
            "rigid_series": [[(n, c) for n, c in enumerate(series(f)) if c != 0] for f in self.rigid],
            "vectors": vectors,
            "integrals": {power: products(power) for power in self.powers},
        }

    def cost(self) -> dict[str, int]:
        products = max(2 * len(matrix.along) for matrix in self.matrices)
        return {"matrix_products": products, "exact_in_fractions_up_to": POLYNOMIALS}

    def bounds(self) -> dict[str, float]:
        return {
            f"matrix entries up to N = {POLYNOMIALS}, of the norms of their terms": BOUND,
            f"polynomials up to N = {POLYNOMIALS} and their derivatives to the third, of the largest value": BOUND,
        }

    def proven(self, text: str) -> tuple[str, float]:
        return next(iter(self.bounds())), rounding.of_beam(self, text, POLYNOMIALS, _Sizes)

    def measured(self, module: ModuleType, say: Progress) -> Iterator[Figure]:
        say("polynomials")
        functions = independent.independent_polynomials(self.column.ends, self.rigid, POLYNOMIALS)
        yield from _functions_figures(module, functions)
        say("matrices")
        in_fractions = None
        if hasattr(module, "complete"):  # other languages have no fractions
            orders = np.empty(len(module.basis(POLYNOMIALS).order), dtype=object)
            orders[:] = [fmpq(n) for n in range(len(orders))]
            in_fractions = module.complete(orders, np.array([(-1) ** n for n in range(len(orders))]))
        reference = independent.PolynomialProducts(functions)
        yield from matrix_figures(self, module, reference, POLYNOMIALS, in_fractions)


def build(derivation: Derivation) -> LegendreKernel:
    """Lower the forms of a column to programs over its trial polynomials. Eq. (11)."""
    given, basis = derivation, polynomials(derivation.column.ends)
    held = {(c.end, c.order) for c in basis.conditions}
    matrices: list[SeriesProgram] = []
    ends: set[tuple[int, int]] = set()
    for name, letter, equation in MATRICES:
        form: Form = getattr(given.system, letter)
        along: dict[tuple[int, int], dict[int, Expr]] = {}
        for (power, p, q), factor_ in sorted(form.along.items()):
            if (power, p, q) != (0, 0, 0):
                along.setdefault((p, q), {})[power] = factor_
        points = []
        for (a, p, b, q), factor_ in form.points.items():
            pair = (int(a), p), (int(b), q)
            if not held & set(pair):
                row, column = (f"{QUANTITIES[order]}_{end}" for end, order in pair)
                points.append((factor_, row, column))
                ends |= set(pair)
        diagonal = form.along.get((0, 0, 0), S.Zero)
        program = (name, letter, display_form(form), equation)
        matrices.append(SeriesProgram(*program, diagonal, along, tuple(points), form.symmetric))
    values = tuple((f"{QUANTITIES[p]}_{end}", end, p, basis.value(end, p)) for end, p in sorted(ends))
    handed = (given.column, given.newmark, given.motion, given.system, basis.rigid)
    return LegendreKernel(*handed, tuple(matrices), basis, values)


def steps(derivation: Derivation) -> tuple[Step, ...]:
    """How the polynomials were derived. Eqs. (9), (11)."""
    return polynomials(derivation.column.ends).steps


@dataclass(frozen=True)
class _Sizes:
    """How large the functions are, from their series in fractions, for `rounding.of_beam`."""

    module: ModuleType
    basis: Any

    def _series(self, order: int) -> Any:
        found = self.basis.deflection
        for _ in range(order):
            found = found @ self.module._derivative(self.basis.order, self.basis.sigma)
        return found

    def norms(self, order: int) -> Any:
        return np.sqrt((self._series(order) ** 2 @ (1 / (2 * self.basis.order + 1))).astype(float))

    def at_end(self, end: int, order: int) -> Any:
        return (self._series(order) @ (self.basis.sigma ** (1 - end))).astype(float)


def _functions_figures(module: ModuleType, functions: list[list[fmpq_poly]]) -> Iterator[Figure]:
    """Functions and their derivatives up to the third, relative to the largest value along the beam."""
    basis = module.basis(POLYNOMIALS)
    for order in range(4):
        computed = module.shapes(basis, PLACES, order, True)
        largest = np.abs(module.shapes(basis, np.linspace(0, 1, 2001), order, True)).max(axis=1)
        worst = ("", 0.0)
        for n, function in enumerate(functions):
            for place, value in zip(PLACES, computed[n].tolist(), strict=True):
                difference = independent.fraction(value) - function[order](independent.fraction(place))
                error = abs(float(difference))
                error = error and (error / largest[n] if largest[n] else math.inf)
                if error >= worst[1]:
                    worst = (f"function {n + 1}, x = {place:.4g}", error)
        yield Figure(f"derivative {order} of polynomials up to N = {POLYNOMIALS}, of the largest value", *worst, BOUND)
