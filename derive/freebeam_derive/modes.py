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

from sympy import (
    Eq,
    Expr,
    Function,
    Integer,
    Matrix,
    Poly,
    S,
    Subs,
    Symbol,
    cancel,
    cos,
    cosh,
    exp,
    expand,
    factor,
    fraction,
    gcd,
    integrate,
    nan,
    pi,
    prod,
    sin,
    sinh,
    solve,
    sqrt,
    together,
    zoo,
)

from freebeam_derive.notation import P, alpha, chi, gamma, lambda_, x
from freebeam_derive.record import Step
from freebeam_derive.statement import ALONG, GEOMETRIC, jet, jets, show
from freebeam_derive.variation import EquationOfMotion, by_parts

STAGE = "modes"

epsilon = Symbol("epsilon", positive=True)  # e^(-gamma)
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
            for j in bracket.coeff(jet(Integer(1), Integer(order), Integer(0), ALONG)).atoms(jet)
            if j.args[0] == 0
        )
        for order in range(2)
    }


def end_orders(kind: str) -> tuple[int, ...]:
    """Orders of the derivatives that vanish at an end of a kind: geometric, then natural. Eq. (20)."""
    held = GEOMETRIC[kind]
    return (*held, *sorted(natural_orders()[order] for order in range(2) if order not in held))


@dataclass(frozen=True)
class ComparisonBeam:
    """The modes of a uniform beam with given ends, in closed form.

    equation: the characteristic equation in γ, Eq. (21). p, q, r: its factors as in the module's head.
    first: m of the first root's asymptote γ₀ = m π/4 (the n-th has first + 4 (n − 1)). sine, cosine: sin γ, cos γ
    on the roots. coefficients: of sin γx, cos γx, e^(−γx), e^(−γ(1−x)). values[end][d]: φ^(d)(end) / γ^d.
    square: what `root` is the square root of (1 where it is not needed). rigid: the functions of γ = 0.
    """

    ends: tuple[str, str]
    orders: tuple[tuple[int, ...], tuple[int, ...]]
    equation: Eq
    p: Expr
    q: Expr
    r: Expr
    first: int
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
        sine, cosine = ((sin(u), cos(u)), (cos(u), -sin(u)), (-sin(u), -cos(u)), (-cos(u), sin(u)))[derivative % 4]
        return A * sine + B * cosine + (-1) ** derivative * C * exp(-u) + D * exp(-v)

    def numeric(self, expression: Expr, index: int) -> Expr:
        """Replace ε, σ, η and root of the `index`-th mode (from 1) by functions of γ."""
        sign = Integer((-1) ** (index - 1))
        values = {eta: sign * exp(-gamma), epsilon: exp(-gamma), sigma: sign}
        return expression.subs(root, sqrt(self.square)).subs(values)


def canonical(expression: Expr, square: Expr = S.One) -> Expr:
    """A rational expression in ε, σ (σ² = 1) and root (root² = square(ε)), in its simplest form over η = σ ε."""
    square_eta = square.subs(epsilon, eta)  # even in ε
    written = expression.subs(epsilon, sigma * eta)

    def rewrite(numerator: Expr) -> Expr:
        polynomial = Poly(expand(numerator), sigma, root)
        total = S.Zero
        for (i, j), factor_ in polynomial.terms():
            total += factor_ * sigma ** (i % 2) * square_eta ** (j // 2) * root ** (j % 2)
        return expand(total)

    numerator, denominator = fraction(together(written))
    numerator, denominator = rewrite(numerator), rewrite(denominator)
    for generator in (sigma, root):
        if denominator.has(generator):
            conjugate = denominator.subs(generator, -generator)
            numerator, denominator = rewrite(numerator * conjugate), rewrite(denominator * conjugate)
    parts = Poly(numerator, sigma, root) if numerator != 0 else None
    if parts is None:
        return S.Zero
    return sum((factor(cancel(f / denominator)) * sigma**i * root**j for (i, j), f in parts.terms()), S.Zero)


def _trig(which: int, d: int) -> Expr:
    """d-th derivative of sin (0) or cos (1) at γ, divided by γ^d, in the symbols for sin γ and cos γ."""
    cycle = (_s, _c, -_s, -_c)
    return cycle[(d + which) % 4]


def _conditions(orders: tuple[tuple[int, ...], tuple[int, ...]]) -> Matrix:
    """The four end conditions as rows over (sin γx, cos γx, e^(−γx), e^(−γ(1−x)))."""
    at_0 = [[_trig(0, d).subs({_s: 0, _c: 1}), _trig(1, d).subs({_s: 0, _c: 1}), (-1) ** d, epsilon] for d in orders[0]]
    at_1 = [[_trig(0, d), _trig(1, d), (-1) ** d * epsilon, 1] for d in orders[1]]
    return Matrix([*at_0, *at_1])


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


def _rigid(orders: tuple[tuple[int, ...], tuple[int, ...]]) -> tuple[Expr, ...]:
    """Functions of γ = 0: cubics that meet the end conditions, orthogonalised on 0 ≤ x ≤ 1."""
    unknown = [Symbol(f"c{k}") for k in range(4)]
    cubic = sum(c * x**k for k, c in enumerate(unknown))
    conditions = [cubic.diff(x, d).subs(x, end) for end, ds in enumerate(orders) for d in ds]
    (general,) = solve(conditions, unknown, dict=True)
    free = [c for c in unknown if c not in general]
    functions: list[Expr] = []
    for c in free:
        function = cubic.subs(general).subs({other: int(other == c) for other in free})
        for earlier in functions:
            function -= earlier * integrate(function * earlier, (x, 0, 1)) / integrate(earlier**2, (x, 0, 1))
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
    first = _first_asymptote(p, q, r, offset)
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

    coefficients = _null_vector(conditions.subs({_s: sine, _c: cosine}).subs(eta, sigma * epsilon), square)
    A, B, C, D = coefficients
    values_0 = tuple(
        canonical(
            A * _trig(0, d).subs({_s: 0, _c: 1}) + B * _trig(1, d).subs({_s: 0, _c: 1}) + (-1) ** d * C + D * epsilon,
            square,
        )
        for d in range(4)
    )
    values_1 = tuple(
        canonical(
            A * _trig(0, d).subs({_s: sine, _c: cosine})
            + B * _trig(1, d).subs({_s: sine, _c: cosine})
            + (-1) ** d * C * epsilon
            + D,
            square,
        )
        for d in range(4)
    )
    equation = _classical(*split)
    beam = ComparisonBeam(
        ends,
        orders,
        equation,
        p,
        q,
        r,
        first,
        sine,
        cosine,
        coefficients,
        (values_0, values_1),
        square,
        _rigid(orders),
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
    damped = tuple(Eq((1 + lambda_ * alpha if d > 1 else 1) * _at_end(d, end), 0) for d, end in held)
    written = {_s: sin(gamma), _c: cos(gamma), epsilon: exp(-gamma)}
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
            tuple(Eq(_at_end(d, end), 0) for d, end in held),
            "Eq. (20)",
            "division by the factor",
        ),
        Step(
            STAGE,
            "Set the determinant to zero",
            "four conditions on four coefficients have a solution besides zero only where it vanishes",
            conditions.xreplace(written).as_immutable(),
            (Eq(found, 0), beam.equation),
            "Eq. (21)",
            "the determinant, expanded; e^γ and e^(−γ) written as cosh and sinh",
        ),
        Step(
            STAGE,
            "Solve for the coefficients",
            "on a root three conditions decide the mode up to its size; the coefficient of sin γx is taken as 1",
            conditions.xreplace(written).as_immutable(),
            Eq(chi, beam.mode()),
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
                Eq(chi.diff(x, 4), 0),
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
        Eq(_at_end(d, end), beam.values[end][d]) for end, kind in enumerate(beam.ends) for d in GEOMETRIC[kind]
    )
    cycle = [expand(beam.mode(d + 1) - beam.mode(d).diff(x) / gamma) for d in range(4)]
    cycle.append(expand(beam.mode(4) - beam.mode()))
    # the bracket u‴v − u″v′ + u′v″ − uv‴ vanishes at an end where each product holds an order that does
    adjoint = all(r in orders or 3 - r in orders for orders in beam.orders for r in range(4))
    if any(beam.values[end][d] for end, kind in enumerate(beam.ends) for d in GEOMETRIC[kind]):
        raise AssertionError(f"the modes of {beam.ends} miss a geometric condition")
    if any(cycle) or not adjoint:
        raise AssertionError(f"the modes of {beam.ends} are not admissible")
    u, v = Function("u")(x), Function("v")(x)
    bracket = sum(((-1) ** r * u.diff(x, 3 - r) * v.diff(x, r) for r in range(4)), S.Zero)
    conditions = (
        ("1) they satisfy the geometric conditions", beam.ends, geometric, "each vanishes identically"),
        (
            "2) they can be differentiated as often as needed",
            beam.mode(),
            Eq(chi.diff(x, 4), gamma**4 * chi),
            "each derivative is the next in a cycle of four, times γ",
        ),
        (
            "3) they are complete: with the rigid functions, the eigenfunctions of a regular self-adjoint problem",
            beam.orders,
            Eq(bracket, 0, evaluate=False),
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


def _first_asymptote(p: Expr, q: Expr, r: Expr, offset: int) -> int:
    """The integer m of the first positive root's asymptote m π/4 (roots.py isolates the roots themselves)."""
    from freebeam_derive.roots import first_root

    estimate = first_root(p, q, r)
    return int(min(range(offset, offset + 40, 4), key=lambda k: abs(k * 0.7853981633974483 - estimate)))


def _null_vector(conditions: Matrix, square: Expr) -> tuple[Expr, ...]:
    """Coefficients of the mode, the sine's (or else the cosine's) being 1, as in Eq. (22)."""
    unknown = Matrix([Symbol(n) for n in NAMES])
    for fixed in ({unknown[0]: S.One}, {unknown[0]: S.Zero, unknown[1]: S.One}):
        rest = [u for u in unknown if u not in fixed]
        for last in (2, 3):
            equations = [conditions.row(k).dot(unknown).subs(fixed) for k in (0, 1, last)]
            solution = solve(equations, rest, dict=True)
            if not solution or len(solution[0]) != len(rest):
                continue
            vector = Matrix([canonical((fixed | solution[0])[u], square) for u in unknown])
            if vector.has(zoo, nan):
                continue
            if not any(canonical(conditions.row(k).dot(vector), square) for k in range(4)):
                return tuple(vector)
    raise AssertionError("no mode meets the four end conditions")


def _classical(p: Expr, q: Expr, r: Expr) -> Eq:
    """The characteristic equation in circular and hyperbolic functions. Eq. (21)."""
    # 2ε cosh γ = 1 + ε², 2ε sinh γ = 1 − ε²: the factors of degree two are combinations of these
    a, b = Symbol("a"), Symbol("b")

    def hyperbolic(f: Expr) -> Expr:
        f2 = Poly(f, epsilon)
        even = f2.coeff_monomial(1), f2.coeff_monomial(epsilon**2)
        (s,) = solve([a + b - even[0], a - b - even[1]], [a, b], dict=True)
        return s[a] * cosh(gamma) + s[b] * sinh(gamma) + f2.coeff_monomial(epsilon) / 2

    left = hyperbolic(p) * cos(gamma) + hyperbolic(q) * sin(gamma)
    right = -hyperbolic(r)
    if right == 0:
        return Eq(left, 0)
    left = expand(left / right)
    return Eq(-left, -1) if left.could_extract_minus_sign() else Eq(left, 1)


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

    None where it does not separate into χ'''' = γ⁴ χ (a stiffness that varies along the beam, say).
    """
    unloaded = motion.strong.subs(P, 0)
    shape = {j: lambda_ ** int(j.args[2]) * chi.diff(x, int(j.args[1])) for j in jets(unloaded)}
    separated = expand(unloaded.xreplace(shape))
    order = {int(j.args[1]) for j in jets(unloaded)}
    if order != {0, 4} or separated.subs(chi.diff(x, 4), 0).coeff(chi, 1).has(x):
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
        Eq(
            expand(
                e.subs(P, 0).xreplace({j: lambda_ ** int(j.args[2]) * chi.diff(x, int(j.args[1])) for j in jets(e)})
            ),
            0,
        )
        for e in (factor_ for _, factor_ in sorted(motion.natural.items()))
    )
    steps = (
        Step(
            STAGE,
            "Take the load and the force away",
            "the comparison beam: free vibration of the same beam",
            motion.equation,
            Eq(show(unloaded), 0),
            "Eq. (14)",
            "the equation of motion at P = 0 and F_0 = 0",
        ),
        Step(
            STAGE,
            "Separate the variables",
            "every term keeps the factor e^(λ₀t)",
            Eq(show(unloaded), 0),
            (Eq(separated, 0), *conditions),
            "Eq. (17)",
            "each derivative in time becomes a factor λ₀",
        ),
        Step(
            STAGE,
            "Name the factor of χ",
            "the damping has gone into the eigenvalue: the shapes are those of the undamped beam",
            Eq(separated, 0),
            (Eq(chi.diff(x, 4) - gamma**4 * chi, 0), Eq(gamma**4, quartic)),
            "Eq. (19)",
            "division by the factor of χ''''",
        ),
        Step(
            STAGE,
            "Solve for the eigenvalues",
            "a quadratic equation in λ₀",
            Eq(gamma**4, quartic),
            eigenvalues,
            "Eq. (23)",
            "put back, both solve the quadratic",
        ),
    )
    return DampedModes(quartic, eigenvalues, half, product, steps)
