"""The comparison beam: characteristic equation, modes, rigid functions, for any pair of ends. Eqs. (14)-(23).

The modes are combinations of sin γx, cos γx, e^(−γx) and e^(−γ(1−x)): the decaying exponentials stand for sinh
and cosh, whose difference loses all its digits in floating point. With ε = e^(−γ) the characteristic determinant is

    p(ε) cos γ + q(ε) sin γ + r(ε),

and its asymptotic roots are γ₀ = m π/4 with an integer m. On the roots sin γ and cos γ are functions of ε and of
a sign σ = ±1 that alternates from mode to mode, and so is everything else: coefficients and end values. They are
written in η = σ ε, which leaves most of them rational in η alone.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cache, lru_cache, reduce
from typing import Any

from sympy import (
    QQ,
    Add,
    Eq,
    Expr,
    Function,
    Integer,
    Matrix,
    Poly,
    Rational,
    S,
    Subs,
    Symbol,
    cancel,
    cos,
    cosh,
    exp,
    expand,
    factor,
    gcd,
    pi,
    prod,
    sin,
    sinh,
    sqrt,
    symbols,
)
from sympy.polys.fields import FracField

from freebeam_derive.notation import P, alpha, chi, gamma, lambda_, x
from freebeam_derive.record import Step, equal
from freebeam_derive.roots import Characteristic, first_root
from freebeam_derive.roots import epsilon as epsilon
from freebeam_derive.statement import ALONG, GEOMETRIC, jet, jets, show
from freebeam_derive.variation import EquationOfMotion, by_parts

STAGE = "modes"

sigma = Symbol("sigma", real=True)  # (-1)^(n - 1)
eta = Symbol("tail", real=True)  # sigma * epsilon
root = Symbol("root", positive=True)  # the one square root that some pairs of ends need
_s, _c = Symbol("s", real=True), Symbol("c", real=True)

NAMES = ("A", "B", "C", "D")


@lru_cache(maxsize=1)
def natural_orders() -> dict[int, int]:
    """Order of y' that must vanish where δy^(m) is free, m = 0, 1: from the bending energy by parts. Eq. (20)."""
    bending = jet(Integer(0), Integer(2), Integer(0), ALONG) * jet(Integer(1), Integer(2), Integer(0), ALONG)
    bracket = by_parts(bending)[1]
    return {
        order: next(
            int(j.args[1])
            for j in jets(bracket.coeff(jet(Integer(1), Integer(order), Integer(0), ALONG)))
            if j.args[0] == 0
        )
        for order in range(2)
    }


def end_orders(kind: str) -> tuple[int, ...]:
    """Orders of the derivatives that vanish at an end of a kind: geometric, then natural. Eq. (20)."""
    held = GEOMETRIC[kind]
    return (*held, *sorted(natural_orders()[order] for order in range(2) if order not in held))


@dataclass(frozen=True)
class ComparisonBeam(Characteristic):
    """The modes of a uniform beam with given ends, in closed form.

    orders: of the derivatives that vanish at each end. equation: the characteristic equation in γ, Eq. (21).
    sine, cosine: sin γ, cos γ on the roots. coefficients: of sin γx, cos γx, e^(−γx), e^(−γ(1−x)).
    values[end][d]: φ^(d)(end) / γ^d. square: what `root` is the square root of (1 where it is not needed).
    rigid: the functions of γ = 0.
    """

    orders: tuple[tuple[int, ...], tuple[int, ...]]
    equation: Eq
    sine: Expr
    cosine: Expr
    coefficients: tuple[Expr, ...]
    values: tuple[tuple[Expr, ...], tuple[Expr, ...]]
    square: Expr
    rigid: tuple[Expr, ...]
    steps: tuple[Step, ...] = field(compare=False)

    def mode(self, derivative: int = 0) -> Expr:
        """φ^(d)(x) / γ^d in γ, x and the symbols ε, σ, η, root."""
        A, B, C, D = self.coefficients
        u, v = gamma * x, gamma * (1 - x)
        sine, cosine, left, right = _derivatives(sin(u), cos(u), exp(-u), exp(-v))[derivative % 4]
        return A * sine + B * cosine + C * left + D * right

    def numeric(self, expression: Expr, index: int) -> Expr:
        """Replace ε, σ, η and root of the `index`-th mode (from 1) by functions of γ."""
        sign = Integer((-1) ** (index - 1))
        values = {eta: sign * exp(-gamma), epsilon: exp(-gamma), sigma: sign}
        return expression.subs(root, sqrt(self.square)).subs(values)


_FIELD = FracField((eta, sigma, root), QQ)


def _element(expression: Expr) -> Any:
    """A rational expression in ε, η, σ and root as an element of Q(η, σ, root)."""
    return _FIELD.from_expr(expression.subs(epsilon, sigma * eta))


def _reduced(value: Any, square: Expr) -> Any:
    """An element of Q(η, σ, root) with σ² = 1 and root² = square(ε): denominator in η alone, powers 0 or 1 above it."""
    ring = _FIELD.ring
    square_eta = ring.from_expr(square.subs(epsilon, eta))  # even in ε

    def lowered(polynomial: Any) -> Any:
        terms = polynomial.terms()
        return sum((ring({(n, i % 2, j % 2): f}) * square_eta ** (j // 2) for (n, i, j), f in terms), ring.zero)

    numerator, denominator = lowered(value.numer), lowered(value.denom)
    for place in (1, 2):
        if any(powers[place] for powers in denominator):
            conjugate = ring({powers: -f if powers[place] else f for powers, f in denominator.items()})
            numerator, denominator = lowered(numerator * conjugate), lowered(denominator * conjugate)
    return _FIELD.new(numerator, denominator)


def _written(value: Any) -> Expr:
    """A reduced element as an expression: a sum over the powers of σ and root, factors in lowest terms."""
    parts: dict[tuple[int, int], dict[tuple[int, int, int], Any]] = {}
    for (n, i, j), factor_ in value.numer.terms():
        parts.setdefault((i, j), {})[n, 0, 0] = factor_
    quotients = {powers: _FIELD.new(_FIELD.ring(terms), value.denom) for powers, terms in parts.items()}
    return Add(*(factor(f.as_expr()) * sigma**i * root**j for (i, j), f in quotients.items()))


def canonical(expression: Expr, square: Expr = S.One) -> Expr:
    """A rational expression in ε, σ (σ² = 1) and root (root² = square(ε)), in its simplest form over η = σ ε."""
    return _written(_reduced(_element(expression), square))


def _derivatives(sine: Expr, cosine: Expr, left: Expr, right: Expr) -> tuple[tuple[Expr, ...], ...]:
    """Derivatives 0…3 of sin γx, cos γx, e^(−γx), e^(−γ(1−x)), over γ^d, where they have the values given."""
    return (
        (sine, cosine, left, right),
        (cosine, -sine, -left, right),
        (-sine, -cosine, left, right),
        (-cosine, sine, -left, right),
    )


def _conditions(orders: tuple[tuple[int, ...], tuple[int, ...]]) -> Matrix:
    """The four end conditions as rows over (sin γx, cos γx, e^(−γx), e^(−γ(1−x)))."""
    at_0, at_1 = _derivatives(S.Zero, S.One, S.One, epsilon), _derivatives(_s, _c, epsilon, S.One)
    return Matrix([*(at_0[d] for d in orders[0]), *(at_1[d] for d in orders[1])])


def _split(determinant: Expr) -> tuple[Expr, Expr, Expr]:
    """p, q, r of a determinant, scaled so that the leading one of p(0), q(0) is 1."""
    reduced = Poly(determinant, _s).rem(Poly(_s**2 + _c**2 - 1, _s)).as_expr()
    parts = Poly(expand(reduced), _s, _c)
    p, q, r = (parts.coeff_monomial(monomial) for monomial in (_c, _s, 1))
    lead = next(part.subs(epsilon, 0) for part in (q, p) if part.subs(epsilon, 0) != 0)
    return expand(p / lead), expand(q / lead), expand(r / lead)


def _without_common_factor(p: Expr, q: Expr, r: Expr) -> tuple[Expr, Expr, Expr]:
    """p, q, r freed of a factor in ε that they share (it has no zero for γ > 0)."""
    common = reduce(gcd, (p, q, r))
    common /= common.subs(epsilon, 0)
    return cancel(p / common), cancel(q / common), cancel(r / common)


def integral_polynomials(first: Expr, second: Expr) -> Rational:
    """∫ of a product of polynomials over the beam: a rational number."""
    product = Poly(first, x) * Poly(second, x)
    return Add(*(c / (n + 1) for (n,), c in product.terms()))


@cache
def rigid_functions(ends: tuple[str, str]) -> tuple[Expr, ...]:
    """Functions of γ = 0: cubics that meet the end conditions, orthogonalised on 0 ≤ x ≤ 1."""
    conditions = Matrix(
        [[(x**k).diff(x, d).subs(x, end) for k in range(4)] for end in range(2) for d in end_orders(ends[end])]
    )
    functions: list[Expr] = []
    for coefficients in conditions.nullspace():
        function = sum((c * x**k for k, c in enumerate(coefficients)), S.Zero)
        for earlier in functions:
            function -= earlier * integral_polynomials(function, earlier) / integral_polynomials(earlier, earlier)
        functions.append(expand(function))
    return tuple(functions)


@cache
def comparison_beam(ends: tuple[str, str]) -> ComparisonBeam:
    """Derive the comparison beam of a pair of ends. Eqs. (18)-(22)."""
    orders = (end_orders(ends[0]), end_orders(ends[1]))
    conditions = _conditions(orders)
    determinant = expand(conditions.det(method="berkowitz"))
    split = _split(determinant)
    p, q, r = _without_common_factor(*split)

    # asymptotes: p(0) cos γ + q(0) sin γ = 0
    p_0, q_0 = p.subs(epsilon, 0), q.subs(epsilon, 0)
    offset = next(k for k in range(4) if cancel(p_0 * cos(k * pi / 4) + q_0 * sin(k * pi / 4)) == 0)
    estimate = first_root(p, q, r)
    first = int(min(range(offset, offset + 40, 4), key=lambda m: abs(m * 0.7853981633974483 - estimate)))
    s_0, c_0 = sin(first * pi / 4), cos(first * pi / 4)

    # sin γ and cos γ on the roots: p c + q s + r = 0 with s² + c² = 1
    under = factor(p**2 + q**2 - r**2)
    content, factors = Poly(under, epsilon).factor_list()
    if all(k % 2 == 0 for _, k in factors):
        w, square = prod([sqrt(content), *(f.as_expr() ** (k // 2) for f, k in factors)]), S.One
        w *= 1 if w.subs(epsilon, 0) > 0 else -1
    else:
        w, square = root, expand(under)
    size = p**2 + q**2
    w_0 = sqrt(under.subs(epsilon, 0))
    sign = (
        cancel(s_0 * size.subs(epsilon, 0) / (p_0 * w_0))
        if p_0 != 0
        else cancel(-c_0 * size.subs(epsilon, 0) / (q_0 * w_0))
    )
    sine = canonical((-r * q + sign * sigma * p * w) / size, square)
    cosine = canonical((-r * p - sign * sigma * q * w) / size, square)

    held = [[_element(e.subs({_s: sine, _c: cosine})) for e in conditions.row(k)] for k in range(4)]
    vector = _null_vector(held, square)

    def at_end(*functions: Expr) -> tuple[Expr, ...]:
        rows = [map(_element, row) for row in _derivatives(*functions)]
        sums = (sum((a * e for a, e in zip(vector, row, strict=True)), _FIELD.zero) for row in rows)
        return tuple(_written(_reduced(value, square)) for value in sums)

    beam = ComparisonBeam(
        ends,
        p,
        q,
        r,
        first,
        orders,
        _classical(*split),
        sine,
        cosine,
        tuple(map(_written, vector)),
        (at_end(S.Zero, S.One, S.One, epsilon), at_end(sine, cosine, epsilon, S.One)),
        square,
        rigid_functions(ends),
        (),
    )
    for end in range(2):
        for d in orders[end]:
            if beam.values[end][d] != 0:
                raise AssertionError(f"the derived mode of {ends} misses the condition of order {d} at x = {end}")
    return replace(beam, steps=(*_mode_steps(beam, conditions), *admissibility(beam)))


def _at_end(d: int, end: int) -> Expr:
    return Subs(chi.diff(x, d), x, end) if d else chi.subs(x, end)


def _mode_steps(beam: ComparisonBeam, conditions: Matrix) -> tuple[Step, ...]:
    """What the derivation of the modes did. Eqs. (18), (20)-(22)."""
    held = [(d, end) for end in range(2) for d in beam.orders[end]]
    damped = tuple(equal((1 + lambda_ * alpha if d > 1 else 1) * _at_end(d, end), 0) for d, end in held)
    written = {_s: sin(gamma), _c: cos(gamma), epsilon: exp(-gamma)}
    rows = conditions.xreplace(written).as_immutable()
    found = (beam.p * _c + beam.q * _s + beam.r).xreplace(written)
    steps = [
        Step(
            STAGE,
            "Put the separated motion into the end conditions",
            "what the supports hold, and the natural conditions, which carry the factor 1 + λ₀α",
            tuple(_at_end(d, end) for d, end in held),
            damped,
            "Eq. (18)",
            "orders from the geometric conditions and from the bending energy by parts",
        ),
        Step(
            STAGE,
            "Strike out the damping",
            "the factor 1 + λ₀α cannot vanish for every mode",
            damped,
            tuple(equal(_at_end(d, end), 0) for d, end in held),
            "Eq. (20)",
            "division by the factor",
        ),
        Step(
            STAGE,
            "Set the determinant to zero",
            "four conditions on four coefficients have a solution besides zero only where it vanishes",
            rows,
            (equal(found, 0), beam.equation),
            "Eq. (21)",
            "the determinant, expanded; e^γ and e^(−γ) written as cosh and sinh",
        ),
        Step(
            STAGE,
            "Solve for the coefficients",
            "on a root three conditions decide the mode up to its size; the coefficient of sin γx is taken as 1",
            rows,
            equal(chi, beam.mode()),
            "Eq. (22)",
            "all four end conditions vanish identically",
        ),
    ]
    if beam.rigid:
        steps.append(
            Step(
                STAGE,
                "Keep what the ends let move as a rigid body",
                "the root γ = 0 has polynomials for modes",
                equal(chi.diff(x, 4), 0),
                beam.rigid,
                "section 3.1",
                "cubics that meet the end conditions, orthogonalised",
            )
        )
    return tuple(steps)


def admissibility(beam: ComparisonBeam) -> tuple[Step, ...]:
    """Section 3.1's four conditions on admissible functions, checked for the modes of a pair of ends.

    Raises AssertionError where one does not hold.
    """
    geometric = tuple(
        equal(_at_end(d, end), beam.values[end][d]) for end, kind in enumerate(beam.ends) for d in GEOMETRIC[kind]
    )
    any_mode = replace(beam, coefficients=symbols(NAMES))  # an identity in constant coefficients
    cycle = [expand(any_mode.mode(d + 1) - any_mode.mode(d).diff(x) / gamma) for d in range(4)]
    # the bracket u‴v − u″v′ + u′v″ − uv‴ vanishes at an end where each product holds an order that does
    adjoint = all(r in orders or 3 - r in orders for orders in beam.orders for r in range(4))
    if any(beam.values[end][d] for end, kind in enumerate(beam.ends) for d in GEOMETRIC[kind]):
        raise AssertionError(f"the modes of {beam.ends} miss a geometric condition")
    if any(cycle) or any(c.has(x) for c in beam.coefficients) or not adjoint:
        raise AssertionError(f"the modes of {beam.ends} are not admissible")
    u, v = Function("u")(x), Function("v")(x)
    bracket = sum(((-1) ** r * u.diff(x, 3 - r) * v.diff(x, r) for r in range(4)), S.Zero)
    conditions = (
        ("1) they satisfy the geometric conditions", beam.ends, geometric, "each vanishes identically"),
        (
            "2) they can be differentiated as often as needed",
            beam.mode(),
            equal(chi.diff(x, 4), gamma**4 * chi),
            "each derivative is the next in a cycle of four, times γ",
        ),
        (
            "3) they are complete: with the rigid functions, the eigenfunctions of a regular self-adjoint problem",
            beam.orders,
            equal(bracket, 0),
            "at each end every product of the bracket holds a derivative that vanishes there",
        ),
        (
            "4) they are linearly independent",
            Symbol("M_ij"),
            Symbol("M_ii"),
            "orthogonal in mass, each of positive mass: see the integrals",
        ),
    )
    return tuple(
        Step(STAGE, "Check that the functions are admissible", why, before, after, "section 3.1", proof)
        for why, before, after, proof in conditions
    )


def _null_vector(rows: list[list[Any]], square: Expr) -> list[Any]:
    """Coefficients of the mode, the sine's (or else the cosine's) being 1, as in Eq. (22)."""
    for last in (2, 3):
        # three conditions decide the vector up to its size: their minors
        chosen = (*rows[:2], rows[last])
        minors = [_determinant([row[:c] + row[c + 1 :] for row in chosen]) * (-1) ** c for c in range(4)]
        minors = [_reduced(minor, square) for minor in minors]
        lead = next((minor for minor in minors[:2] if minor), None)
        if lead is None:
            continue
        vector = [_reduced(minor / lead, square) for minor in minors]
        left = (sum((a * v for a, v in zip(row, vector, strict=True)), _FIELD.zero) for row in rows)
        if not any(_reduced(residual, square) for residual in left):
            return vector
    raise AssertionError("no mode meets the four end conditions")


def _determinant(rows: list[list[Any]]) -> Any:
    """By the first row, in as few quotients as the entries bring."""
    if len(rows) == 1:
        return rows[0][0]
    minors = ([[*row[:c], *row[c + 1 :]] for row in rows[1:]] for c in range(len(rows)))
    return sum(
        ((-1) ** c * rows[0][c] * _determinant(minor) for c, minor in enumerate(minors) if rows[0][c]), _FIELD.zero
    )


def _classical(p: Expr, q: Expr, r: Expr) -> Eq:
    """The characteristic equation in circular and hyperbolic functions. Eq. (21)."""

    # 2ε cosh γ = 1 + ε², 2ε sinh γ = 1 − ε²: the factors of degree two are combinations of these
    def hyperbolic(f: Expr) -> Expr:
        constant, linear, squared = (Poly(f, epsilon).coeff_monomial(epsilon**n) for n in range(3))
        return (constant + squared) / 2 * cosh(gamma) + (constant - squared) / 2 * sinh(gamma) + linear / 2

    left = hyperbolic(p) * cos(gamma) + hyperbolic(q) * sin(gamma)
    right = -hyperbolic(r)
    if right == 0:
        return equal(left, 0)
    left = expand(left / right)
    return equal(-left, -1) if left.could_extract_minus_sign() else equal(left, 1)


@dataclass(frozen=True)
class DampedModes:
    """The comparison beam with damping: y = χ(x) e^(λ₀t) leaves the mode shapes as they are. Eqs. (16)-(19), (23).

    quartic: γ⁴ as a function of λ₀. eigenvalues: λ₀ as functions of γ, Eq. (23). half, product: minus half their
    sum, and their product, from which they are computed without cancellation.
    """

    quartic: Expr
    eigenvalues: tuple[Expr, Expr]
    half: Expr
    product: Expr
    steps: tuple[Step, ...]


def damped_modes(motion: EquationOfMotion) -> DampedModes | None:
    """Separate the unloaded, unforced equation of motion. Eqs. (14), (16)-(19), (23).

    None where it does not separate into χ'''' = γ⁴ χ (a stiffness that varies along the beam, say) with the end
    conditions of the comparison beam (there is a mass or a spring at an end, say).
    """
    unloaded = motion.strong.subs(P, 0)
    shape = {j: lambda_ ** int(j.args[2]) * chi.diff(x, int(j.args[1])) for j in jets(unloaded)}
    separated = expand(unloaded.xreplace(shape))
    order = {int(j.args[1]) for j in jets(unloaded)}
    if order != {0, 4} or separated.subs(chi.diff(x, 4), 0).coeff(chi, 1).has(x):
        return None
    if any(len({int(j.args[1]) for j in jets(condition.subs(P, 0))}) != 1 for condition in motion.natural.values()):
        return None
    inertia, stiffness = separated.subs(chi.diff(x, 4), 0).coeff(chi, 1), separated.coeff(chi.diff(x, 4), 1)
    quartic = cancel(-inertia / stiffness)
    polynomial = Poly(expand(inertia + stiffness * gamma**4), lambda_)
    if polynomial.degree() != 2:
        return None
    a, b, c = polynomial.all_coeffs()
    half, product = expand(b / (2 * a)), expand(c / a)
    eigenvalues = (-half + sqrt((2 * half) ** 2 - 4 * product) / 2, -half - sqrt((2 * half) ** 2 - 4 * product) / 2)
    for value in eigenvalues:
        if expand(polynomial.as_expr().subs(lambda_, value)) != 0:
            raise AssertionError("Eq. (23) does not solve the separated equation")
    conditions = tuple(
        equal(
            expand(
                e.subs(P, 0).xreplace({j: lambda_ ** int(j.args[2]) * _at_end(int(j.args[1]), end) for j in jets(e)})
            ),
            0,
        )
        for (end, _), e in sorted(motion.natural.items())
    )
    steps = (
        Step(
            STAGE,
            "Take the load and the force away",
            "the comparison beam: free vibration of the same beam",
            motion.equation,
            equal(show(unloaded), 0),
            "Eq. (14)",
            "the equation of motion at P = 0 and F_0 = 0",
        ),
        Step(
            STAGE,
            "Separate the variables",
            "every term keeps the factor e^(λ₀t)",
            equal(show(unloaded), 0),
            (equal(separated, 0), *conditions),
            "Eq. (17)",
            "each derivative in time becomes a factor λ₀",
        ),
        Step(
            STAGE,
            "Name the factor of χ",
            "the damping has gone into the eigenvalue: the shapes are those of the undamped beam",
            equal(separated, 0),
            (equal(chi.diff(x, 4) - gamma**4 * chi, 0), equal(gamma**4, quartic)),
            "Eq. (19)",
            "division by the factor of χ''''",
        ),
        Step(
            STAGE,
            "Solve for the eigenvalues",
            "a quadratic equation in λ₀",
            equal(gamma**4, quartic),
            eigenvalues,
            "Eq. (23)",
            "put back, both solve the quadratic",
        ),
    )
    return DampedModes(quartic, eigenvalues, half, product, steps)
