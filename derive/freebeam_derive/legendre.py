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

from dataclasses import dataclass, field, replace
from functools import cache

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
    integrate,
    legendre,
)
from sympy.polys.matrices import DomainMatrix

from freebeam_derive.modes import comparison_beam
from freebeam_derive.notation import x
from freebeam_derive.record import Step, equal
from freebeam_derive.statement import GEOMETRIC

STAGE = "polynomials"

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
