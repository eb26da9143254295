"""From matrices to stability: the pencil, where frequencies meet, what damping and the load's work do. Eqs. (24)-(26).

Matrices stand as symbols that do not commute; what is said of them holds for every N. Damping is C = β M + α E, as
in Eq. (12): where the energies shift the factors, α and β stand for the shifted ones.
"""

from __future__ import annotations

from typing import Any

import mpmath
from sympy import (
    Derivative,
    Eq,
    Expr,
    Function,
    I,
    Matrix,
    S,
    Symbol,
    cancel,
    cos,
    exp,
    expand,
    factor_terms,
    pi,
    re,
    sin,
    sqrt,
    symbols,
)

from freebeam_derive import integrals, motions, step_proofs, variation_proofs
from freebeam_derive.comparison import ComparisonBeam
from freebeam_derive.derivation import Derivation
from freebeam_derive.notation import P, alpha, beta, chi, lambda_, omega, t, x, y
from freebeam_derive.record import Step
from freebeam_derive.ritz import Form
from freebeam_derive.statement import jets, show

STAGE = "stability"

M, C, E, H, K, one = symbols("M C E H K I", commutative=False)
q_hat, v, A = symbols("q_hat v A", commutative=False)
kappa = Symbol("kappa", nonnegative=True)
p, s = symbols("p s")
branch = Function("s")
D = Function("D")
P_star, s_star = symbols("P_star s_star", positive=True)


def load_matrix(beam: ComparisonBeam, form: Form) -> Step:
    """The load's matrix H over the comparison modes, entry by entry. Eqs. (11), (13)."""
    different, same = S.Zero, S.Zero
    at = integrals.end_values(beam)
    sides = {suffix: at.of(suffix).at for suffix in ("i", "j")}
    roots = {"i": integrals.gamma_i, "j": integrals.gamma_j}
    for (k, r, q), f in form.along.items():
        different += f * integrals.assembled(integrals.integral_modes(beam, k, r, q))
        same += f * integrals.integral_same(beam, k, r, q)
    for (a, r, b, q), f in form.points.items():
        first = sides["i"][int(a)][r] * roots["i"] ** r
        different += f * first * sides["j"][int(b)][q] * roots["j"] ** q
        same += f * first * sides["i"][int(b)][q] * roots["i"] ** q
    squared = {Symbol("sigma_i", real=True) ** 2: S.One}
    same = factor_terms(expand(expand(same).subs(squared)))
    return Step(
        "integrals",
        "Write the load's matrix in closed form",
        "each of its integrals is a few end values; σ alternates from mode to mode",
        Eq(Symbol("H_ij"), form.expression),
        (Eq(Symbol("H_ij"), different), Eq(Symbol("H_ii"), same)),
        "Eq. (13)",
        "quadrature of the first modes, 40 digits",
    )


def steps(derivation: Derivation) -> tuple[Step, ...]:
    """What follows for the stability of a column. Eqs. (24)-(26)."""
    found = [*eigenproblem(), _pencil(), *_reference(derivation), *meeting(), *_damping(), *_energy(derivation)]
    return (*found, *_rigid(derivation), *_beam_itself(derivation))


# --- eigenvalues ----------------------------------------------------------------------------------------------


def eigenproblem() -> tuple[Step, ...]:
    motion = q_hat * exp(lambda_ * t)
    equation = (lambda_**2 * M + lambda_ * C + K) * q_hat
    state = Matrix([[0, one], [-(M**-1) * K, -(M**-1) * C]])

    def exponential() -> Any:
        left = M * motion.diff(t, 2) + C * motion.diff(t) + K * motion
        return expand(left - expand(equation) * exp(lambda_ * t))

    def linear() -> Any:
        upper, lower = q_hat, lambda_ * q_hat
        A_z = (lower, expand(state[1, 0] * upper + state[1, 1] * lower))
        return (A_z[0] - lambda_ * upper, expand(A_z[1] - lambda_ * lower + M**-1 * expand(equation)))

    q = Function("q")(t)
    return (
        Step(
            STAGE,
            "Let all coordinates move alike",
            "without a force, motions that keep their shape and grow or decay are all there is to know",
            Eq(q, motion),
            Eq(equation, 0),
            "Eq. (24)",
            "put into the equation of the coordinates, the factor e^(λt) apart",
            exponential,
        ),
        Step(
            STAGE,
            "Write it as an eigenvalue problem of the first order",
            "a rate for each coordinate makes it linear in λ, at the price of twice the size",
            Eq(equation, 0),
            Eq(A, state.as_immutable(), evaluate=False),
            "Eq. (25)",
            "A times (q, λq) is λ (q, λq), less the inverse of M times the equation above",
            linear,
        ),
    )


def _pencil() -> Step:
    reduced = (P / (1 + alpha * lambda_), -(lambda_**2 + beta * lambda_) / (1 + alpha * lambda_))

    def identity() -> Any:
        whole = lambda_**2 * M + lambda_ * (beta * M + alpha * E) + E + P * H
        return (expand((1 + alpha * lambda_) * E + P * H - reduced[1] * (1 + alpha * lambda_) * M - whole),)

    return Step(
        STAGE,
        "Divide by 1 + αλ",
        "every damping of this kind is then in two numbers, p and s, and the matrices are those of the undamped column",
        Eq((lambda_**2 * M + lambda_ * (beta * M + alpha * E) + E + P * H) * v, 0),
        (Eq((E + p * H - s * M) * v, 0), Eq(p, reduced[0]), Eq(s, reduced[1])),
        "",
        "multiplied by 1 + αλ it is the equation before, as an identity in matrices that do not commute",
        identity,
    )


def _reference(derivation: Derivation) -> tuple[Step, ...]:
    if derivation.damped is None:
        return ()
    half, product = derivation.damped.half, derivation.damped.product
    scale = sqrt(expand(product - half**2))

    def magnitude() -> Any:
        first = derivation.damped.eigenvalues[0]  # type: ignore[union-attr]
        return (expand((first + half) ** 2 + scale**2), expand(scale**2 + half**2 - product))

    return (
        Step(
            STAGE,
            "Measure eigenvalues in units of the first frequency",
            "the frequency of mode 1 of the unloaded beam, γ being its first root; there is none where it is "
            "overdamped",
            derivation.damped.eigenvalues,
            Eq(Symbol("lambda_bar"), lambda_ / scale),
            "Eq. (26)",
            "the imaginary part of the eigenvalues of the comparison beam, squared",
            magnitude,
        ),
    )


# --- where frequencies meet -------------------------------------------------------------------------------------


def meeting() -> tuple[Step, ...]:
    d_P, d_s, d_ss = symbols("D_P D_s D_ss")
    away = Symbol("Delta")
    c = Symbol("c")
    square = -2 * d_P / d_ss

    def square_root() -> Any:
        """Taylor's polynomial of D about the meeting, at s = s* + c Δ and P = P* + Δ², to the second order in Δ."""
        departure = sqrt(c) * away
        taylor = d_P * away**2 + d_s * departure + d_ss * departure**2 / 2
        return cancel(taylor.subs(d_s, 0).subs(c, square))

    def jacobi() -> Any:
        """dD/ds = −tr(adj(A) M), and adj(A) = c v uᵀ where A = E + P H − s M has a null vector on either side."""
        e, h, m = (Matrix(2, 2, symbols(f"{name}0:4")) for name in "ehm")
        whole = e + P * h - s * m
        rule = expand(whole.det(method="berkowitz").diff(s) + (whole.adjugate() * m).trace())
        # a matrix of numbers with null vectors on either side: adj(A) is their product
        left, right = Matrix([1, -2, 3]), Matrix([2, 1, -1])
        regular = Matrix(3, 3, range(1, 10)) ** 2 + 5 * Matrix.diag(1, 2, 3)
        singular = (Matrix.eye(3) - left * left.T / 14) * regular * (Matrix.eye(3) - right * right.T / 6)
        adjugate = singular.adjugate()
        ratio = adjugate[0, 0] / (right[0] * left[0])
        return (rule, *(adjugate - ratio * right * left.T))

    determinant = D(P, s)
    return (
        Step(
            STAGE,
            "Look at the place where two frequencies meet",
            "a double root of D(P, s) = det(E + P H − s M): a parabola lying on its side, so the frequencies meet "
            "vertically and leave the real axis as a square root, which has either sign",
            (Eq(determinant, 0), Eq(Derivative(determinant, s), 0)),
            (Eq(s, s_star + sqrt(c * (P - P_star))), Eq(c, square)),
            "",
            "Taylor's polynomial about the meeting vanishes to the second order",
            square_root,
        ),
        Step(
            STAGE,
            "Look at the shapes there",
            "the two modes have become one; u and v are the null vectors of E + P H − s M on either side",
            Eq(Derivative(determinant, s), 0),
            Eq(Symbol("u^T", commutative=False) * M * v, 0),
            "",
            "the derivative of a determinant, as an identity; the adjugate of a singular matrix is v uᵀ",
            jacobi,
        ),
    )


# --- vanishing damping ------------------------------------------------------------------------------------------


def _damping() -> tuple[Step, ...]:
    rate = branch(P).diff(P)
    growth = (alpha * (P * rate - branch(P)) - beta) / 2
    small, first = symbols("epsilon lambda_1")

    def perturbed() -> Any:
        """λ = iω + ε λ_1 in s(p) = −(λ² + βλ)/(1 + αλ), dampings ε α and ε β: nothing of the first order is left."""
        lam = I * omega + small * first
        internal, external = small * alpha, small * beta
        load = P / (1 + internal * lam)
        slope, value = symbols("slope value")
        curve = value + slope * (load - P)  # to the first order in p − P, which is of the order of ε
        whole = curve * (1 + internal * lam) + lam**2 + external * lam
        order_1 = whole.diff(small).subs(small, 0).subs(value, omega**2)
        wanted = growth.subs(rate, slope).subs(branch(P), omega**2)
        zeroth = whole.subs(small, 0).subs(value, omega**2)
        return (expand(zeroth), expand(order_1.subs(first, wanted)))

    def tangent() -> Any:
        logarithmic = P / branch(P) * rate
        return (
            expand(growth.subs(beta, kappa * alpha) - alpha / 2 * (P * rate - branch(P) - kappa)),
            expand((P * rate - branch(P)) / branch(P) - (logarithmic - 1)),
        )

    rule = Eq(P * rate - branch(P), kappa)
    return (
        Step(
            STAGE,
            "Damp it a little",
            "to first order damping moves the eigenvalue iω of a branch ω² = s(P) off the axis, to this side or that: "
            "internal damping by how steep the branch is",
            (Eq(s, branch(p)), Eq(lambda_, I * omega + small * first)),
            Eq(re(Symbol("lambda")), growth),
            "",
            "put into the pencil, nothing of the first order in the dampings is left",
            perturbed,
        ),
        Step(
            STAGE,
            "Let the damping vanish",
            "with β = κα the sign of the growth no longer depends on how small α is",
            Eq(re(Symbol("lambda")), growth),
            (rule, Eq(P * rate / branch(P), 1)),
            "",
            "the growth with β = κα, divided by α / 2; the second form is κ = 0",
            tangent,
        ),
    )


# --- work over a cycle --------------------------------------------------------------------------------------------


def _energy(derivation: Derivation) -> tuple[Step, ...]:
    circulatory = derivation.system.H + derivation.system.H.transposed.map(lambda f: -f)

    def asymmetric() -> Any:
        f, g = (motions.admissible(derivation.column.ends, S.One, seed) for seed in (3, 6))
        h = derivation.system.H
        return expand(
            step_proofs.form_value(circulatory, f, g)
            - step_proofs.form_value(h, f, g)
            + step_proofs.form_value(h, g, f)
        )

    return (
        cycle_of(H, P),
        Step(
            STAGE,
            "Keep what does not cancel",
            "only the part of H that is not symmetric does work over a cycle; it is zero for a load with a potential",
            Eq(Symbol("H_ij"), derivation.system.H.expression),
            Eq(Symbol("H_ij") - Symbol("H_ji"), circulatory.expression),
            "",
            "the form less its transpose, on polynomials",
            asymmetric,
        ),
    )


def cycle_of(matrix: Expr, factor: Expr) -> Step:
    """The work over a cycle of what a matrix of forces, times a factor, gives, and of damping."""
    a, b = symbols("a b", commutative=False)
    a_T, b_T = symbols("a^T b^T", commutative=False)
    work = pi * factor * (b_T * matrix * a - a_T * matrix * b)

    def cycle() -> Any:
        """Both integrals over one period, for matrices of letters."""
        n = 2
        h = Matrix(n, n, symbols(f"h0:{n * n}"))
        first, second = (Matrix(symbols(f"{letter}0:{n}")) for letter in "ab")
        frequency = Symbol("omega", positive=True)
        q = first * cos(frequency * t) - second * sin(frequency * t)
        period = 2 * pi / frequency

        def over(density: Expr) -> Expr:
            """∫ over a period: of a density of second degree in cos ωt and sin ωt, four instants have the mean."""
            return expand(period * sum(density.subs(t, k * period / 4) for k in range(4)) / 4)

        done = -factor * over((q.diff(t).T * h * q)[0])
        taken = over((q.diff(t).T * h * q.diff(t))[0])
        return (
            expand(done - pi * factor * (second.T * h * first - first.T * h * second)[0]),
            expand(taken - pi * frequency * (first.T * h * first + second.T * h * second)[0]),
        )

    swing = Eq(Function("q")(t), re(v * exp(I * omega * t)), evaluate=False)
    what = "the load" if matrix == H else "what is not symmetric in K"
    return Step(
        STAGE,
        "Add up the work over one cycle",
        f"v = a + ib; {what} gives in one period what this says, and damping takes πω (aᵀC a + bᵀC b)",
        swing,
        Eq(Symbol("W"), work),
        "",
        "both integrals over one period, for matrices of letters",
        cycle,
    )


# --- rigid functions ------------------------------------------------------------------------------------------------


def _rigid(derivation: Derivation) -> tuple[Step, ...]:
    if not derivation.beam.rigid:
        return ()
    beam, system = derivation.beam, derivation.system
    columns = Matrix([[integrals.rigid_mode(system.H, beam, r, True) for r in beam.rigid]])
    corner, mass = (
        Matrix([[integrals.rigid_pair(form, f, g) for g in beam.rigid] for f in beam.rigid])
        for form in (system.H, system.M)
    )

    def quadrature() -> Any:
        """Forms of a rigid function and of the first modes, by quadrature; of two rigid ones, exactly."""
        own = variation_proofs.own_values(derivation.column)
        form, found = derivation.system.H.map(lambda f: f.subs(own)), []
        with mpmath.workdps(motions.DIGITS):
            for entry, r in zip(columns, derivation.beam.rigid, strict=True):
                written = entry.subs(own)
                suffixed = written.xreplace({
                    symbol: Symbol(f"{symbol}_i", **symbol.assumptions0) for symbol in written.free_symbols
                })  # fmt: skip
                for k in range(step_proofs.MODES):
                    numeric = step_proofs.sampled(derivation.beam).with_trial(form, k, r)
                    found.append(numeric - step_proofs.closed_form(derivation, suffixed, k, k))
        for i, f in enumerate(derivation.beam.rigid):
            for j, g in enumerate(derivation.beam.rigid):
                found += [step_proofs.form_value(derivation.system.H, f, g) - corner[i, j]]
                found += [step_proofs.form_value(derivation.system.M, f, g) - mass[i, j]]
        return tuple(found)

    return (
        Step(
            STAGE,
            "Put the rigid functions in front",
            "the load's matrix over rigid and elastic functions: what a rigid motion does to the elastic rows (a "
            "column for each rigid function), and what it does to the rigid ones",
            Eq(Symbol("H_ij"), derivation.system.H.expression),
            (
                Eq(Symbol("H_er"), columns.as_immutable(), evaluate=False),
                Eq(Symbol("H_rr"), corner.as_immutable(), evaluate=False),
                Eq(Symbol("M_rr"), mass.as_immutable(), evaluate=False),
            ),
            "section 3.1",
            "quadrature with the first modes, 40 digits; rigid entries exactly",
            quadrature,
        ),
    )


# --- without a series -------------------------------------------------------------------------------------------------


def _beam_itself(derivation: Derivation) -> tuple[Step, ...]:
    strong = derivation.motion.strong
    shape = {j: lambda_ ** int(j.args[2]) * chi.diff(x, int(j.args[1])) for j in jets(strong)}
    exact = expand(strong.xreplace(shape))

    def separated() -> Any:
        """The same from the equation of motion in y(x, t)."""
        return expand(show(strong).subs(y, chi * exp(lambda_ * t)).doit() - exact * exp(lambda_ * t))

    return (
        Step(
            STAGE,
            "Leave the series out",
            "the loaded beam itself, y = χ(x) e^(λt): its coefficients are polynomials in x, so a power series "
            "solves it",
            derivation.motion.equation,
            Eq(exact, 0),
            "",
            "put into the equation of motion, the factor e^(λt) apart",
            separated,
        ),
    )
