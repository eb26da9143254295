"""Newmark's method for Eq. (10): recurrence, amplification matrix, order and stability limit, derived.

The paper solves Eq. (10) by "the Newmark method (Craig, Jr and Kurdila (2006))" and prints none of it. Here
all of it follows from the two assumptions on displacement and velocity over a step and the equation of
motion at its end. The parameters are written `newmark = (b, g)`, because alpha, beta and gamma are the
damping and the roots.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import Any

import sympy as sp

from freebeam_derive.record import Step, equal

__all__ = ["Newmark", "derive_newmark"]

STAGE = "newmark"
HALF = sp.Rational(1, 2)

h, Omega = sp.symbols("h Omega", positive=True)
b, g, xi = sp.symbols("b g xi", nonnegative=True)
rho = sp.Symbol("rho")


@dataclass(frozen=True)
class Newmark:
    """What is derived about Newmark's method, and the steps that led there.

    `formulas` is the recurrence as ordered (name, expression) pairs, to be evaluated from top to bottom: a
    name may stand in the expressions below it. They are SymPy matrix expressions: a product of matrix
    symbols (MatMul) is a matrix product, a factor h, b or g a scalar one, and `Inverse(X) * v` is one
    linear solve, never an inverse formed. All from `amplification` on but `pencil` concerns one oscillator,
    ddq + 2 ξ ω dq + ω² q = 0 with Ω = ω h, which stands for every mode of a system that decouples. `xi`,
    `b` and `g` are zero or greater.
    """

    h, b, g, xi, Omega, rho = h, b, g, xi, Omega, rho  # the symbols that all of it is made of

    matrices: tuple[sp.MatrixSymbol, ...]
    """M, C, K, each (n, n)."""
    state: tuple[sp.MatrixSymbol, ...]
    """q, dq, ddq at the beginning of the step, each (n, 1)."""
    force: sp.MatrixSymbol
    """F = Q(x_F) F_0 at the end of the step, (n, 1)."""
    formulas: tuple[tuple[str, sp.MatrixExpr], ...]
    amplification: sp.Matrix
    """A(Ω, ξ): (q, h dq) at a step's end from its beginning."""
    amplification_full: sp.Matrix
    """The same in (q, h dq, h² ddq); its third eigenvalue is zero."""
    radius: sp.Expr
    """Spectral radius of A(Ω, ξ)."""
    pencil: tuple[sp.Expr, sp.Expr, sp.Expr]
    """m, c, k of any system, decoupled or not: ρ is a root of det(m M + c C + k K) = 0."""
    order: sp.Expr
    """Order of accuracy as a function of g: 2 or 1."""
    inverse_limit: sp.Expr
    """1 / Ω_crit as a function of xi, b, g; zero where every step is stable."""
    limit: sp.Expr
    """Ω_crit for 2 b < g and g ≥ 1/2, in the textbook's form."""
    period_elongation: sp.Expr
    """Leading term of (period − exact period) / exact period, undamped, g = 1/2."""
    numerical_damping: sp.Expr
    """Leading term of the damping ratio that the method adds, undamped."""
    steps: tuple[Step, ...]


def _prove(difference: Any, claim: str) -> None:
    """Stop the derivation unless `difference`, a polynomial or a matrix of them, vanishes identically."""
    entries = list(difference) if isinstance(difference, sp.MatrixBase) else [difference]
    if any(sp.expand(entry) != 0 for entry in entries):
        raise ArithmeticError(f"not proven: {claim}")


def _recurrence() -> tuple[dict[str, Any], list[Step]]:
    """The step, in noncommutative symbols for the matrices and vectors of any dimension."""
    names = "M C K F q dq ddq ddq_next q_predicted dq_predicted effective right_side"
    s = {name: sp.Symbol(name, commutative=False) for name in names.split()}
    M, C, K, F, q, dq, ddq, a = (s[name] for name in names.split()[:8])
    q_next = q + h * dq + h**2 * ((HALF - b) * ddq + b * a)
    dq_next = dq + h * ((1 - g) * ddq + g * a)
    steps = [
        Step(
            STAGE,
            "Newmark's two assumptions",
            "over a step the acceleration is known at both ends only; b and g say how it is averaged: b "
            "twice integrated, for the displacement, g once, for the velocity",
            (q, dq, ddq, a),
            (q_next, dq_next),
        )
    ]
    motion = M * a + C * dq_next + K * q_next - F
    steps.append(
        Step(
            STAGE,
            "the equation of motion at the end of the step",
            "the assumptions leave one unknown, the new acceleration; Eq. (10) at the new time decides it",
            M * a + C * sp.Symbol("dq_next", commutative=False) + K * sp.Symbol("q_next", commutative=False) - F,
            motion,
            "Eq. (10)",
        )
    )
    # Every term is linear in the new acceleration: what stands left of it is its coefficient, the rest is
    # known.
    expanded = sp.expand(motion)
    effective = sp.expand(sum(term * a**-1 for term in expanded.args if term.has(a)))
    known = -sum(term for term in expanded.args if not term.has(a))
    q_predicted, dq_predicted = q_next.subs(a, 0), dq_next.subs(a, 0)
    right_side = F - C * s["dq_predicted"] - K * s["q_predicted"]
    _prove(
        right_side.xreplace({s["q_predicted"]: q_predicted, s["dq_predicted"]: dq_predicted}) - known,
        "the known terms of the equation of motion are those of the predicted state",
    )
    solved = s["effective"] ** -1 * s["right_side"]
    mass = s["effective"] - (effective - M)  # M from the effective matrix, so that S S⁻¹ = 1 can act
    residual = motion.xreplace({a: solved, M: mass}).xreplace({s["right_side"]: known})
    _prove(residual, "the recurrence satisfies the equation of motion")
    steps.append(
        Step(
            STAGE,
            "solved for the new acceleration",
            "it stands linearly in the equation: its coefficient is the effective matrix, the rest the "
            "right side in terms of the state predicted without it; one linear solve a step",
            motion,
            (effective, right_side, solved),
            check="the recurrence put back into the equation of motion leaves zero, as an identity in "
            "noncommuting matrices",
        )
    )
    formulas = {
        "q_predicted": q_predicted,
        "dq_predicted": dq_predicted,
        "effective": effective,
        "right_side": right_side,
        "ddq_next": solved,
        "q_next": s["q_predicted"] + b * h**2 * a,
        "dq_next": s["dq_predicted"] + g * h * a,
    }
    _prove(formulas["q_next"].xreplace({s["q_predicted"]: q_predicted}) - q_next, "displacement update")
    _prove(formulas["dq_next"].xreplace({s["dq_predicted"]: dq_predicted}) - dq_next, "velocity update")

    # Change of coordinates q = Φ z with the equations multiplied by Ψ: Newmark's step goes along.
    left, right = sp.symbols("Psi Phi", commutative=False)
    moved = {matrix: left * matrix * right for matrix in (M, C, K)}
    moved |= {vector: right**-1 * vector for vector in (q, dq, ddq, a)} | {F: left * F}
    _prove(motion.xreplace(moved) - left * motion, "Newmark's method commutes with a change of coordinates")
    steps.append(
        Step(
            STAGE,
            "a change of coordinates",
            "q = Phi z, the equations multiplied by Psi: the recurrence of the new matrices is the old "
            "one in new coordinates, so where M, C and K are diagonal together (P = 0, Eq. (12)) a system "
            "is as many scalar oscillators, and what holds for one, for any damping ratio, holds for all",
            motion,
            sp.expand(motion.xreplace(moved)),
            "Eq. (12)",
            "the transformed equation equals Psi times the old one, identically",
        )
    )
    return {"symbols": s, "formulas": formulas}, steps


def _emitted(s: dict[str, sp.Symbol], formulas: dict[str, Any]) -> dict[str, Any]:
    """The noncommutative symbols replaced by matrix symbols, the form that a printer turns into code."""
    n = sp.Symbol("n", integer=True, positive=True)
    square = {"M", "C", "K", "effective"}
    typed = {symbol: sp.MatrixSymbol(name, n, n if name in square else 1) for name, symbol in s.items()}
    matrix = {name: typed[symbol] for name, symbol in s.items()}
    lifted = {name: expression.xreplace(typed) for name, expression in formulas.items()}
    lifted["ddq_next"] = sp.Inverse(matrix["effective"]) * matrix["right_side"]
    return {"matrix": matrix, "formulas": tuple(lifted.items())}


def _amplification(recurrence: dict[str, Any]) -> tuple[sp.Matrix, sp.Matrix, sp.Expr, list[Step]]:
    """A(Ω, ξ) of the scalar oscillator, from the recurrence with M = 1, C = 2 ξ ω, K = ω², F = 0.

    Returns the numerators, 3 x 3 and 2 x 2, and the denominator that all entries share, the effective matrix.
    """
    s, formulas = recurrence["symbols"], recurrence["formulas"]
    d, v, a, whole = sp.symbols("d v a D")  # q, h dq, h² ddq: one unit for all three
    values = {
        s["M"]: sp.Integer(1),
        s["C"]: 2 * xi * Omega / h,
        s["K"]: (Omega / h) ** 2,
        s["F"]: sp.Integer(0),
    }
    values |= {s["q"]: d, s["dq"]: v / h, s["ddq"]: a / h**2}
    for name, expression in formulas.items():
        values[s.get(name, sp.Symbol(name))] = expression.xreplace(values | {s["effective"]: whole})
    denominator = values[s["effective"]]
    new = (values[sp.Symbol("q_next")], h * values[sp.Symbol("dq_next")], h**2 * values[s["ddq_next"]])
    rows = [sp.expand(sp.expand(entry * whole).subs(whole, denominator)) for entry in new]
    full = sp.Matrix([[row.coeff(unit) for unit in (d, v, a)] for row in rows])
    motion = sp.Matrix([[-(Omega**2), -2 * xi * Omega]])  # h² ddq of (q, h dq), by the equation of motion
    _prove(full[2, :] - motion * full[:2, :], "the new state satisfies the equation of motion")
    two = (full[:2, :2] + full[:2, 2] * motion).applyfunc(sp.expand)
    step = Step(
        STAGE,
        "the amplification matrix",
        "without a force a step is one matrix; its powers are the response, so its eigenvalues decide "
        "what grows. Omega = omega h; the acceleration follows from the equation of motion, which every "
        "step satisfies, so two numbers make the state",
        full / denominator,
        two / denominator,
        check="the third row of the 3 x 3 matrix equals the equation of motion applied to the first two",
    )
    return full, two, denominator, [step]


def _pencil() -> tuple[tuple[Any, Any, Any], Step]:
    """Growth by ρ a step in any system: put q, dq, ddq proportional to ρⁿ into the two assumptions."""
    lam = sp.Symbol("lambda")
    # (ρ − 1) q = h dq + h² first ddq and (ρ − 1) dq = h second ddq, so q : dq : ddq = k : c : m
    first, second = HALF - b + b * rho, 1 - g + g * rho
    m, c = (rho - 1) ** 2, h * (rho - 1) * second
    k = sp.expand(h**2 * (first * (rho - 1) + second))
    _prove((rho - 1) * k - h * c - h**2 * first * m, "displacement over a step")
    _prove((rho - 1) * c - h * second * m, "velocity over a step")
    half_sum = [part.subs({b: sp.Rational(1, 4), g: HALF}) for part in (m, c, k)]
    bilinear = 2 * (rho - 1) / (h * (rho + 1))
    for part, power in zip(half_sum, (2, 1, 0), strict=True):
        difference = part - (h * (rho + 1) / 2) ** 2 * bilinear**power
        _prove(difference, "average acceleration is the bilinear map")
    step = Step(
        STAGE,
        "growth in any system",
        "a follower force couples the modes (K is not symmetric, C no combination of M and K); rho is "
        "then a root of det(m M + c C + k K) = 0 with these m, c, k. For (1/4, 1/2) they are lambda^2, "
        "lambda and 1 at lambda = 2 (rho - 1) / (h (rho + 1)): the exact eigenvalues mapped one to one, "
        "|rho| < 1 where Re lambda < 0. Average acceleration invents no flutter and hides none",
        (
            equal(sp.Symbol("q_next"), rho * sp.Symbol("q")),
            equal(sp.Symbol("dq_next"), rho * sp.Symbol("dq")),
        ),
        ((m, c, k), equal(lam, bilinear)),
        "Eq. (24)",
        "both assumptions hold identically for q : dq : ddq = k : c : m; m / k and c / k of (1/4, 1/2) equal "
        "lambda^2 and lambda identically",
    )
    return (m, c, k), step


def _stability(trace: sp.Expr, determinant: sp.Expr, denominator: sp.Expr) -> tuple[Any, Any, list[Step]]:
    """The map ρ = (1 + z)/(1 − z) takes the unit disc to the left half plane, where Hurwitz decides.

    `trace` and `determinant` are the numerators over `denominator`.
    """
    z, u = sp.symbols("z u")
    plus, minus = 1 + z, 1 - z
    mapped = sp.Poly(denominator * plus**2 - trace * plus * minus + determinant * minus**2, z)
    if mapped.degree() != 2:
        raise ArithmeticError("the mapped characteristic polynomial is not of degree 2")
    flip, grow, static = (sp.factor(coefficient) for coefficient in mapped.all_coeffs())
    conditions = (flip, grow, static)
    steps = [
        Step(
            STAGE,
            "stability conditions",
            "rho = (1 + z)/(1 - z) maps the unit disc to the left half plane; a quadratic in z has its "
            "roots there where its coefficients have one sign (Hurwitz). The first says when a root "
            "leaves through -1 (the sign flips each step), the second when a pair leaves the circle; the "
            "third always holds",
            denominator * plus**2 - trace * plus * minus + determinant * minus**2,
            conditions,
            check="the polynomial in z has degree 2; its coefficients are read off",
        )
    ]
    s, t = sp.symbols("s t", nonnegative=True)  # the region 2 b ≥ g ≥ 1/2
    region = {g: HALF + s, b: (HALF + s) / 2 + t}
    for condition in conditions:
        within = sp.Poly(sp.expand(condition.subs(region, simultaneous=True)), Omega, xi, s, t)
        if any(coefficient < 0 for coefficient in within.coeffs()):
            raise ArithmeticError("not proven: unconditional stability for 2 b >= g >= 1/2")
    steps.append(
        Step(
            STAGE,
            "unconditional stability",
            "with g = 1/2 + s and b = g/2 + t every condition is a polynomial whose coefficients are all positive",
            conditions,
            tuple(sp.expand(condition.subs(region, simultaneous=True)) for condition in conditions),
            check="no coefficient in Omega, xi, s, t is negative: stable for every step where 2 b >= g >= 1/2",
        )
    )
    # In u = 1/Ω the first bound met as the step grows from zero is the largest positive root.
    flip_u = sp.Poly(sp.expand(flip.subs(Omega, 1 / u) * u**2 / 4), u)
    grow_u = sp.Poly(sp.expand(sp.expand(grow.subs(Omega, 1 / u)) * u**2 / 2), u)
    p, e = sp.factor(flip_u.coeff_monomial(u) / 2), -flip_u.coeff_monomial(1)
    root = sp.sqrt(p**2 + e) - p
    _prove(flip_u.as_expr() - (u - root) * (u + root + 2 * p), "the larger root of the flip condition")
    pair = -sp.factor(grow_u.coeff_monomial(1)) / grow_u.coeff_monomial(u)
    inverse = sp.Max(
        0,
        sp.Piecewise((root, sp.Ge(p**2 + e, 0)), (0, True)),
        sp.Piecewise((0, sp.Ge(g, HALF)), (sp.oo, sp.Eq(xi, 0)), (pair, True)),
        evaluate=False,  # keeps the three bounds as they were found, and is quick
    )
    limit = (p + sp.sqrt(p**2 + e)) / e
    _prove((p + sp.sqrt(p**2 + e)) * root - e, "the two forms of the limit agree")
    steps.append(
        Step(
            STAGE,
            "the largest stable step",
            "where g/2 > b >= 0 and g >= 1/2 the first condition fails beyond one step; in 1/Omega it is "
            "a monic quadratic, its larger root the bound. Where g < 1/2 the second condition bounds the "
            "step too, and without damping no step is stable",
            conditions,
            (inverse, limit),
            check="the root put back makes the condition vanish; the textbook's form times the inverse one is 1",
        )
    )
    return inverse, limit, steps


def _accuracy(
    two: sp.Matrix, trace: sp.Expr, determinant: sp.Expr, denominator: sp.Expr
) -> tuple[Any, Any, Any, list[Step]]:
    """Order by series in h against the exact propagator; leading errors of period and damping."""
    # ω = 1, so h = Ω and the state (q, dq)
    generator = sp.Matrix([[0, 1], [-1, -2 * xi]])
    exact, power = sp.eye(2), sp.eye(2)
    for k in range(1, 4):
        power = generator * power * Omega / k
        exact += power
    # Entry (i, j) in (q, dq) is that in (q, h dq) times h^(j - i). The denominator is 1 + O(h): multiplied
    # by it, the leading term of the error is what it was.
    ring = sp.polys.rings.PolyRing((xi, b, g, Omega), sp.QQ)
    scaled = sp.Matrix(2, 2, lambda i, j: two[i, j] * Omega ** (1 + j - i))
    whole, unit = ring.from_expr(denominator), ring.from_expr(Omega)
    error = [ring.from_expr(a) - unit * whole * ring.from_expr(e) for a, e in zip(scaled, exact, strict=True)]
    terms = [sp.Matrix(2, 2, [sp.factor(entry.coeff_wrt(unit, k + 1).as_expr()) for entry in error]) for k in range(4)]
    _prove(terms[0], "consistency, h^0")
    _prove(terms[1], "consistency, h^1")
    # No damping ratio makes all coefficients vanish: the polynomials in ξ have no common root, complex ones
    # included.
    slope = [sp.Poly(entry, g).exquo(sp.Poly(g - HALF, g)).as_expr() for entry in terms[2][1, :]]
    _prove(terms[2] - (g - HALF) * sp.Matrix([[0, 0], slope]), "h^2 vanishes at g = 1/2")
    third = terms[3].subs(g, HALF).applyfunc(sp.factor)
    if sp.gcd(*slope).has(xi) or third[1, :].has(b) or sp.gcd(*third[1, :]).has(xi):
        raise ArithmeticError("not proven: h^2 vanishes at g = 1/2 only, and h^3 for no b")
    order = sp.Piecewise((2, sp.Eq(g, HALF)), (1, True))
    steps = [
        Step(
            STAGE,
            "order of accuracy",
            "one step against the exact propagator exp(h L), in powers of h (omega = 1): the terms h^0 "
            "and h^1 agree, h^2 where g = 1/2 and only there, h^3 for no b; over a time T there are T/h "
            "steps, so the order is one less than the first term that differs",
            (two, exact),
            (terms[2], third, order),
            check="the factor g - 1/2 split off; the polynomials in xi that remain have no common root",
        )
    ]
    # Eigenvalues: log ρ = s Ω + c2 Ω² + c3 Ω³, with s² + 2 ξ s + 1 = 0 solved for ξ so that all stays
    # polynomial.
    s, c2, c3 = sp.symbols("s c2 c3")
    exponent = s * Omega + c2 * Omega**2 + c3 * Omega**3
    damping = -(s**2 + 1) / (2 * s)
    ring = sp.polys.rings.PolyRing((Omega, s, c2, c3, b, g), sp.QQ)

    def known(polynomial: Any) -> Any:  # through Ω⁴
        return ring.from_dict({powers: value for powers, value in polynomial.terms() if powers[0] <= 4})

    step, power, growth = ring.from_expr(exponent), ring.one, ring.one
    for k in range(1, 5):
        power = known(power * step) * sp.QQ(1, k)
        growth += power
    whole, first, last = (
        ring.from_expr(sp.expand(s * part.subs(xi, damping))) for part in (denominator, trace, determinant)
    )
    series = known(whole * known(growth**2) - first * growth + last).as_expr()
    for k in range(3):
        _prove(series.coeff(Omega, k), "the exact eigenvalue is the limit")
    c2_value = _linear_root(series.coeff(Omega, 3), c2)
    c3_value = _linear_root(series.coeff(Omega, 4), c3).subs(c2, c2_value)
    undamped = {s: sp.I}
    numerical_damping = sp.factor(-sp.expand(c2_value.subs(undamped))) * Omega
    elongation = sp.factor(sp.expand(sp.I * sp.expand(c3_value.subs(undamped | {g: HALF})))) * Omega**2
    steps.append(
        Step(
            STAGE,
            "errors of period and damping",
            "log rho is h times the numerical eigenvalue; its series about the exact one, s = lambda / "
            "omega, shows what a step size costs: at zero damping the method damps by the first, and "
            "lengthens the period by the second (g = 1/2)",
            equal(sp.log(sp.Symbol("rho")), exponent),
            (c2_value, c3_value, numerical_damping, elongation),
            check="the characteristic polynomial vanishes through Omega^4 with these coefficients, for any damping",
        )
    )
    return order, elongation, numerical_damping, steps


def _linear_root(expression: Any, unknown: sp.Symbol) -> Any:
    slope, constant = sp.Poly(expression, unknown).all_coeffs()
    return -sp.factor(constant) / sp.factor(slope)


def _energy() -> Step:
    """(1/4, 1/2) keeps ½ dqᵀ M dq + ½ qᵀ K q exactly where C = 0, F = 0 and K = Kᵀ.

    Scalars xᵀ X y are words of noncommuting symbols; a scalar equals its transpose, so with symmetric
    matrices a word and its reversal are one.
    """
    names = ("q", "dq", "ddq", "ddq_next")
    vector = {name: sp.Symbol(name, commutative=False) for name in names}
    row = {vector[name]: sp.Symbol(name + "^T", commutative=False) for name in names}
    M, K = sp.symbols("M K", commutative=False)
    column = {transposed: plain for plain, transposed in row.items()}
    q, dq, ddq, a = (vector[name] for name in names)
    quarter = h**2 / 4
    q_next, dq_next = q + h * dq + quarter * (ddq + a), dq + h / 2 * (ddq + a)

    def energy(x: Any, v: Any) -> Any:
        return (v.xreplace(row) * M * v + x.xreplace(row) * K * x) / 2

    def reduced(expression: Any, symmetric: tuple[Any, ...]) -> Any:
        total = sp.Integer(0)
        for term in sp.Add.make_args(sp.expand(expression)) if expression != 0 else ():
            numbers, (left, matrix, right) = term.args_cnc()
            scalar = sp.Mul(*numbers)
            solved = matrix == M and right in motion
            if matrix in symmetric and not solved and names.index(column[left].name) > names.index(right.name):
                left, right = row[right], column[left]
            if solved:  # M ddq = −K q at both ends of the step
                total += scalar * left * motion[right]
            else:
                total += scalar * left * matrix * right
        return sp.expand(total)

    motion = {ddq: -K * q, a: -K * q_next}
    gain = sp.expand(energy(q_next, dq_next) - energy(q, dq))
    kept, asymmetric = gain, gain
    for _ in range(3):  # each pass removes one kind of M ddq
        kept, asymmetric = reduced(kept, (M, K)), reduced(asymmetric, (M,))
    if kept != 0 or asymmetric == 0:
        raise ArithmeticError("not proven: energy conservation for symmetric K, and for symmetric K only")
    return Step(
        STAGE,
        "energy",
        "average acceleration changes the energy of an undamped, unforced step by nothing where K is "
        "symmetric; under a follower force the work of its circulatory part remains",
        gain,
        (kept, asymmetric),
        check="M ddq = -K q at both ends and a scalar equal to its transpose reduce the gain to zero; "
        "without K = K^T they do not",
    )


@cache
def derive_newmark() -> Newmark:
    """Derive Newmark's method; pure. Raises ArithmeticError where a step of the proof fails."""
    recurrence, steps = _recurrence()
    emitted = _emitted(recurrence["symbols"], recurrence["formulas"])
    full, two, denominator, more = _amplification(recurrence)
    steps += more
    determinant_squared = sp.expand(two[0, 0] * two[1, 1] - two[0, 1] * two[1, 0])
    product, rest = sp.div(determinant_squared, denominator, Omega, xi, b, g)
    _prove(rest, "one factor of the denominator cancels in the determinant")
    sum_of_roots, product = sp.collect(two[0, 0] + two[1, 1], Omega), sp.collect(product, Omega)
    trace, determinant = sum_of_roots / denominator, product / denominator
    characteristic = rho**2 - trace * rho + determinant
    exact = sp.polys.matrices.DomainMatrix.from_Matrix(full)
    by_power = [exact.domain.to_sympy(coefficient) for coefficient in exact.charpoly()]
    expected = (1, -sum_of_roots, product * denominator, 0)
    _prove(sp.Matrix(by_power) - sp.Matrix(expected), "the third eigenvalue is zero")
    discriminant = sp.sqrt(trace**2 / 4 - determinant, evaluate=False)
    moduli = (sp.Abs(trace / 2 + sign * discriminant, evaluate=False) for sign in (1, -1))
    radius = sp.Max(*moduli, evaluate=False)
    steps.append(
        Step(
            STAGE,
            "characteristic polynomial and spectral radius",
            "two roots, their sum and product the invariants of A",
            two,
            (characteristic, radius),
            check="the 3 x 3 matrix has the same polynomial times rho",
        )
    )
    pencil, step = _pencil()
    steps.append(step)
    m, c, k = (sp.expand(part / h**power) for power, part in enumerate(pencil))
    _prove(
        m + 2 * xi * Omega * c + Omega**2 * k - (denominator * rho**2 - sum_of_roots * rho + product),
        "pencil and amplification matrix have the same roots",
    )
    invariants = (sum_of_roots, product, denominator)
    inverse_limit, limit, more = _stability(*invariants)
    steps += more
    order, elongation, damping, more = _accuracy(two, *invariants)
    steps += more
    steps.append(_energy())
    matrix = emitted["matrix"]
    return Newmark(
        matrices=(matrix["M"], matrix["C"], matrix["K"]),
        state=(matrix["q"], matrix["dq"], matrix["ddq"]),
        force=matrix["F"],
        formulas=emitted["formulas"],
        amplification=two / denominator,
        amplification_full=full / denominator,
        radius=radius,
        pencil=pencil,
        order=order,
        inverse_limit=inverse_limit,
        limit=limit,
        period_elongation=elongation,
        numerical_damping=damping,
        steps=tuple(steps),
    )
