"""Each printed equation against the derived one: confirmed, or an erratum with the difference shown. Eqs. (1)-(26).

Both are SymPy forms: the printed one as the reader has it (reader.py), the derived one from the stages of `pipeline`.
An equation is confirmed where printed minus derived vanishes identically, each as left side minus right side. Beside
that each row has a check that does not go the way of the derivation (equilibrium of an element, Lagrange's equations,
the equation put back), which raises `NotShown` where it fails.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import sympy as sp
from sympy import Derivative, Eq, Expr, Function, Integral, S, Subs, Symbol

from freebeam.paper import printed as p
from freebeam.paper.printed import EQUATIONS, Printed
from freebeam.paper.reader import delta
from freebeam.paper.typeset import latex
from freebeam_derive import comparison, pipeline, scaling, variation
from freebeam_derive.notation import EI, F_0, C_alpha, C_beta, L, P, alpha, beta, chi, gamma, m, t, variation_of_y, x, y
from freebeam_derive.notation import lambda_ as derived_lambda
from freebeam_derive.ritz import phi_i, phi_j, q_j
from freebeam_derive.statement import ALONG, Functional, jet, show
from freebeam_derive.units import SCALES

__all__ = ["Comparison", "NotShown", "compare"]

CONFIRMED, ERRATUM, FAILED = "confirmed", "erratum", "failed"


class NotShown(ArithmeticError):
    """A check of an equation that failed."""


@dataclass(frozen=True)
class Comparison:
    """An equation as printed and as derived. difference: printed minus derived, one a statement; check: what else
    was shown, in words."""

    printed: Printed
    derived: tuple[Eq, ...]
    difference: tuple[Any, ...]
    check: str

    @property
    def derived_latex(self) -> tuple[str, ...]:
        """The derived equations as LaTeX."""
        return tuple(latex(equation) for equation in self.derived)

    @property
    def difference_latex(self) -> tuple[str, ...]:
        """The differences as LaTeX, "0" where there is none."""
        return tuple(latex(part) for part in self.difference)

    @property
    def verdict(self) -> str:
        """Confirmed where nothing differs."""
        if not self.derived:
            return FAILED
        return ERRATUM if any(part != 0 for part in self.difference) else CONFIRMED

    @property
    def passed(self) -> bool:
        """Whether the verdict is the one that the paper's data names a misprint for, and the print was read aright."""
        read = self.printed.read() == self.printed.typed
        return read and self.verdict == (ERRATUM if self.printed.misprint else CONFIRMED)


@dataclass(frozen=True)
class Found:
    """What a row of the comparison finds. Where no difference is given it is taken from the residuals."""

    derived: tuple[Eq, ...]
    check: str
    difference: tuple[Any, ...] | None = None


@dataclass(frozen=True)
class Context:
    """The derivation, with dimensions and without."""

    derivation: pipeline.Derived
    dimensional: variation.EquationOfMotion


_ROWS: dict[int, Callable[[Context], Found]] = {}


def _equation(number: int) -> Callable[[Callable[[Context], Found]], Callable[[Context], Found]]:
    def register(row: Callable[[Context], Found]) -> Callable[[Context], Found]:
        _ROWS[number] = row
        return row

    return register


def compare(progress: Callable[[str], None] | None = None) -> tuple[Comparison, ...]:
    """The 26 equations of the paper against what its energies give; a row whose check fails has failed."""
    context = derived_context()
    rows = []
    for printed in EQUATIONS:
        if progress:
            progress(f"equation ({printed.number})")
        rows.append(row(printed, context))
    return tuple(rows)


@lru_cache(maxsize=1)
def derived_context() -> Context:
    """The paper's column derived."""
    derivation = pipeline.derive(pipeline.find("free-free"))
    assert derivation.column.dimensional is not None
    return Context(derivation, variation.derive(derivation.column.dimensional, derivation.column.ends, True))


def row(printed: Printed, context: Context) -> Comparison:
    """One equation against the derived one."""
    try:
        found = _ROWS[printed.number](context)
    except NotShown as error:
        return Comparison(printed, (), (), f"not shown: {error}")
    difference = found.difference
    if difference is None:
        pairs = zip(printed.typed, found.derived, strict=True)
        difference = tuple(canonical(residual(a) - residual(b)) for a, b in pairs)
    return Comparison(printed, found.derived, difference, found.check)


def residual(equation: Eq) -> Any:
    """Left side minus right side."""
    return equation.lhs - equation.rhs


def canonical(expression: Any) -> Any:
    """An expression with derivatives carried out and integrals split into terms, so that equal forms are the same."""
    expression = expression.replace(lambda e: isinstance(e, Derivative), lambda e: e.doit())
    expression = expression.replace(
        lambda e: isinstance(e, Subs) and not e.expr.has(Derivative), lambda e: e.doit(deep=False)
    )
    return sp.expand(expression.replace(lambda e: isinstance(e, Integral), _split))


def _split(integral: Integral) -> Expr:
    (variable, low, high), *_ = integral.limits
    if variable != x:
        return integral
    total = S.Zero
    for term in sp.Add.make_args(sp.expand(integral.function)):
        factor, rest = term.as_independent(variable, as_Add=False)
        total += factor * Integral(rest, (variable, low, high))
    return total


def _show(claim: str, expression: Any) -> None:
    entries = list(expression) if isinstance(expression, sp.MatrixBase) else [expression]
    if any(sp.simplify(canonical(entry)) != 0 for entry in entries):
        raise NotShown(claim)


def _eq(left: Any, right: Any) -> Eq:
    return Eq(left, right, evaluate=False)


# --- section 2 ----------------------------------------------------------------------------------------------


@_equation(1)
def _moment(context: Context) -> Found:
    factor = context.dimensional.weak.density.coeff(jet(S.One, sp.Integer(2), S.Zero, ALONG))
    # plane sections of a Kelvin-Voigt material, rectangular: strain z y'', stress E (strain + C_alpha d/dt strain)
    z, width, height, E = sp.symbols("z b h E", positive=True)
    curvature = y.diff(x, 2)
    stress = E * z * (curvature + C_alpha * curvature.diff(t))
    moment = sp.integrate(sp.expand(stress * z) * width, (z, -height / 2, height / 2))
    _show("Eq. (1) from stresses", moment - show(factor).subs(EI, E * width * height**3 / 12))
    return Found(
        (_eq(p.moment, show(factor)),),
        "factor of δy″ in the virtual work; and the moment of the stresses of a Kelvin-Voigt material over a section",
    )


def _equilibrium() -> Expr:
    """Transversal equilibrium of an element: inertia, external damping, moment of Eq. (1), axial and lateral force."""
    moment = EI * (y.diff(x, 2) + C_alpha * y.diff(x, 2, t))
    return m * y.diff(t, 2) + C_beta * y.diff(t) + moment.diff(x, 2) + (p.axial * y.diff(x)).diff(x) - p.lateral


@_equation(2)
def _motion(context: Context) -> Found:
    # any axial force P(x) in place of P x / L, then by parts
    density = sp.expand(context.dimensional.weak.density.subs(P, p.axial * L / x))
    interior, _ = variation.by_parts(density)
    derived = show(interior) - p.lateral
    _show("Eq. (2) from equilibrium", derived - _equilibrium())
    return Found(
        (_eq(derived, 0),),
        "from the energies with any axial force P(x), by parts; the same from the equilibrium of an element",
    )


@_equation(3)
def _axial(context: Context) -> Found:
    acceleration = Symbol("a")
    force = sp.integrate(m * acceleration, (x, 0, x))  # nothing pushes at x = 0; each slice needs m a
    (rate,) = sp.solve(force.subs(x, L) - P, acceleration)
    found = force.subs(acceleration, rate)
    pushed = jet(S.Zero, S.One, S.Zero, ALONG) * jet(S.One, S.One, S.Zero, ALONG)
    _show("Eq. (3) is what the energies hold", found + context.dimensional.weak.density.coeff(pushed))
    return Found(
        (_eq(p.axial, found),), "Newton's law for the part of the beam between its free end x = 0 and a section"
    )


@_equation(4)
def _transversal(context: Context) -> Found:
    ((place, force),) = context.dimensional.forces
    derived = force * sp.DiracDelta(x - place)
    inside = Symbol("x_F", positive=True)
    totals = [
        sp.integrate(side.subs(place, inside).subs(L, inside + Symbol("rest", positive=True)), (x, 0, sp.oo))
        for side in (derived, EQUATIONS[3].typed[0].rhs * L)
    ]
    _show("the total force is F_0", totals[0] - F_0)
    _show("the print has F_0 / L", totals[1] - F_0)
    return Found(
        (_eq(p.lateral, derived),),
        "the force in the virtual work F_0 δy(x_F); its integral over the beam is F_0, that of the print F_0/L",
    )


@_equation(5)
def _scales(context: Context) -> Found:
    size = SCALES
    derived = tuple(
        _eq(p.bar[name], value / size[unit])
        for name, value, unit in (
            ("y", p.y_here, "length"),
            ("x", x, "length"),
            ("t", t, "time"),
            ("P_0", P, "load"),
            ("F_0", F_0, "force"),
            ("beta", C_beta, "beta"),
            ("alpha", C_alpha, "alpha"),
        )
    )
    # no unit is left: kilogram, metre and second enter each quantity with exponent zero
    kg, metre, second = sp.symbols("kg m s", positive=True)
    newton = kg * metre / second**2
    units = {EI: newton * metre**2, m: kg / metre, L: metre, C_alpha: second, C_beta: kg / metre / second}
    units |= {P: newton, p.y_here: metre, x: metre, t: second, F_0: newton}
    for equation in derived:
        _show("Eq. (5) leaves no unit", equation.rhs.xreplace(units).subs(F_0, newton) - 1)
    return Found(
        derived,
        "the dimensional energies become the nondimensional ones term by term; no unit is left in any of the seven",
    )


@_equation(6)
def _nondimensional(context: Context) -> Found:
    motion = context.derivation.motion
    # Eq. (2) with Eqs. (3) and (5) put in
    functional = scaling.nondimensional(Functional(context.dimensional.weak.density, S.Zero))
    _show("Eq. (6) from Eq. (2)", show(variation.by_parts(functional.density)[0]) - show(motion.strong))
    return Found((motion.equation,), "from the nondimensional energies; and Eq. (2) with Eqs. (3) and (5) put in")


# --- section 3 ----------------------------------------------------------------------------------------------


@_equation(7)
def _principle(context: Context) -> Found:
    energies = context.derivation.column.energies
    T, V, W_c, dW_nc = (energies.functional(name) for name in ("T", "V", "W_c", "dW_nc"))
    first = variation.first_variation
    action = variation.off_the_rates(first(T) + first(V).scaled(-1) + first(W_c) + dW_nc)
    interior, _ = variation.by_parts(action.density)
    _show("the principle gives the equation of motion", show(interior) + show(context.derivation.motion.strong))
    interval = (t, p.t_1, p.t_2)
    derived = _eq(delta(Integral(p.T - p.V + p.W_c, interval)) + Integral(p.dW_nc, interval), 0)
    return Found((derived,), "with these signs, and the virtual work δW_nc, the principle gives the equation of motion")


@_equation(8)
def _energies(context: Context) -> Found:
    column = context.derivation.column
    derived = tuple(
        _eq(symbol, canonical(value))
        for symbol, value in ((p.T, column.T), (p.V, column.V), (p.W_c, column.W_c), (p.dW_nc, column.dW_nc))
    )
    # a virtual work is linear in the virtual displacement
    scale = Symbol("scale", positive=True)
    for linear, work in ((True, derived[3].rhs), (False, EQUATIONS[7].typed[3].rhs)):
        scaled = canonical(work).replace(variation_of_y.func, lambda a, b: scale * variation_of_y.func(a, b))
        if (sp.expand(canonical(scaled) - scale * canonical(work)) == 0) is not linear:
            raise NotShown("the derived virtual work is linear in δy, the printed one is not")
    # the end conditions that follow are those of Eq. (15): the load drops out of them
    if any(condition.has(P) for condition in context.derivation.motion.natural.values()):
        raise NotShown("the load drops out of the end conditions")
    return Found(
        derived,
        "the dimensional energies in nondimensional quantities; the derived virtual work is linear in δy, the print is "
        "not; with it the load drops out of the end conditions, as Eq. (15) has them",
    )


def _lagrange(context: Context) -> Expr:
    """Lagrange's equation of the first of two coordinates, less the row of Eq. (10) with the derived matrices."""
    column, system = context.derivation.column, context.derivation.system
    shapes = [Function(f"phi_{k}", real=True)(x) for k in (1, 2)]
    q = [Function(f"q_{k}", real=True)(t) for k in (1, 2)]
    series = sum(shape * coordinate for shape, coordinate in zip(shapes, q, strict=True))

    def put(energy: Any, virtual: Any = 0) -> Any:
        fields = {y: series, variation_of_y: virtual}
        return canonical(energy.subs(fields).doit(integrals=False))  # the coordinates then stand before the integrals

    T, V, W_c = (put(getattr(column, name)) for name in ("T", "V", "W_c"))
    work = put(column.dW_nc, shapes[0])
    row = T.diff(q[0].diff(t)).diff(t) + V.diff(q[0]) - W_c.diff(q[0]) - work
    for form, rate in ((system.M, 2), (system.C, 1), (system.K, 0)):
        for shape, coordinate in zip(shapes, q, strict=True):
            entry = form.expression.replace(phi_i.func, shapes[0].func).replace(phi_j.func, shape.func)
            row -= canonical(entry * (coordinate.diff(t, rate) if rate else coordinate))
    force = sum(factor * shapes[0].subs(x, place) for place, factor in system.forces)
    return row + force * F_0


@_equation(9)
def _series(context: Context) -> Found:
    _show("Lagrange's equations", _lagrange(context))
    return Found(
        EQUATIONS[8].typed,
        "an approximation, stated; with two functions Lagrange's equations of the energies are Eqs. (10) and (11)",
    )


@_equation(10)
def _coordinates(context: Context) -> Found:
    _show("Lagrange's equations", _lagrange(context))
    left = p.M_ij * q_j.diff(t, 2) + p.C_ij * q_j.diff(t) + p.K_ij * q_j
    return Found((_eq(left, Symbol("Q_i")),), "Lagrange's equations of the energies, with two functions")


def _forms(context: Context) -> dict[str, Any]:
    system = context.derivation.system
    geometric = system.H.map(lambda factor: P * factor)
    return {
        name: canonical(form.expression)
        for name, form in (("M", system.M), ("C", system.C), ("K", system.K), ("KG", geometric))
    }


@_equation(11)
def _matrices(context: Context) -> Found:
    forms, system = _forms(context), context.derivation.system
    if not (system.M.symmetric and system.C.symmetric):
        raise NotShown("M and C are symmetric")
    transposed = canonical(system.K.transposed.expression)
    _show("the printed K is the derived one transposed", EQUATIONS[10].typed[2].rhs - transposed)
    ((place, factor),) = system.forces
    force = factor * F_0 * phi_j.subs(x, place)
    return Found(
        (_eq(p.M_ij, forms["M"]), _eq(p.C_ij, forms["C"]), _eq(p.K_ij, forms["K"]), _eq(p.Q_j, force)),
        "coefficients of the series in the weak form; M and C are symmetric and the printed K is the derived one "
        "transposed, so that det(λ²M + λC + K) is the same",
    )


@_equation(12)
def _damping(context: Context) -> Found:
    forms = _forms(context)
    put = {p.M_ij: forms["M"], p.C_ij: forms["C"], p.K_ij: forms["K"], p.KG_ij: forms["KG"]}
    identity = canonical(residual(EQUATIONS[11].typed[0]).subs(put))
    whole = canonical((p.C_ij - beta * p.M_ij - alpha * p.K_ij).subs(put))
    if whole == 0:
        raise NotShown("C = βM + αK does not hold")
    system = context.derivation.system
    derived = _eq(p.C_ij, system.c_M * p.M_ij + system.c_E * (p.K_ij - p.KG_ij))
    return Found((derived,), "an identity of the derived forms; C = βM + αK is none", (identity,))


@_equation(13)
def _geometric(context: Context) -> Found:
    return Found((_eq(p.KG_ij, _forms(context)["KG"]),), "the coefficient of the load in K")


# --- section 3.1 --------------------------------------------------------------------------------------------


def _damped(context: Context) -> comparison.DampedModes:
    damped = context.derivation.damped
    assert damped is not None
    return damped


def _step(context: Context, equation: str) -> Any:
    """What the derivation arrived at for an equation of the unloaded beam."""
    return next(step.after for step in _damped(context).steps if step.equation == equation)


def _named(expression: Any) -> Any:
    """The derivation's λ is the λ₀ of these equations."""
    return expression.subs(derived_lambda, p.lambda_0)


@_equation(14)
def _unloaded(context: Context) -> Found:
    derived = _step(context, "Eq. (14)")
    equation = context.derivation.motion.equation.lhs.subs({P: 0, F_0: 0})
    _show("Eq. (14) is Eq. (6) at P = 0 and F_0 = 0", equation - derived.lhs)
    return Found((derived,), "Eq. (6) as derived, at P = 0 and F_0 = 0")


def _at_both_ends(typed: tuple[Eq, ...], derived: dict[tuple[int, int], Any]) -> tuple[tuple[Eq, ...], tuple[Any, ...]]:
    """Conditions at x = 0 and x = 1: the first printed one is against the slope, the second against the deflection."""
    conditions, places = typed[:2], typed[2:]
    equations, differences = [], []
    for order, condition in ((1, conditions[0]), (0, conditions[1])):
        gaps = []
        for end, place in enumerate(places):
            here = condition.lhs.replace(
                lambda e: isinstance(e, Derivative), lambda e, at=place.rhs: Subs(e.doit(), x, at)
            )
            found = derived[end, order]
            # a condition may be multiplied by −1
            gaps.append(min((canonical(here - found), canonical(here + found)), key=sp.count_ops))
            if end == 0:
                first = found if canonical(here - found) == gaps[-1] else -found
                equations.append(_eq(first.replace(lambda e: isinstance(e, Subs), lambda e: e.expr), 0))
        differences.append(gaps[0] if gaps[0] != 0 else gaps[1])
    return (*equations, *places), (*differences, *(S.Zero for _ in places))


@_equation(15)
def _natural(context: Context) -> Found:
    natural = {key: show(value) for key, value in context.derivation.motion.natural.items()}
    derived, difference = _at_both_ends(EQUATIONS[14].typed, natural)
    return Found(derived, "natural conditions of the energies, at any load: its part drops out", difference)


@_equation(16)
def _separated(context: Context) -> Found:
    equation = _step(context, "Eq. (14)").lhs
    put = equation.subs(y, chi * sp.exp(p.lambda_0 * t)).doit() / sp.exp(p.lambda_0 * t)
    if sp.simplify(put).has(t):
        raise NotShown("the motion separates")
    return Found(EQUATIONS[15].typed, "put into Eq. (14), every term keeps the factor of time")


@_equation(17)
def _shape(context: Context) -> Found:
    separated = _named(_step(context, "Eq. (17)")[0])
    return Found((separated,), "Eq. (16) put into Eq. (14)")


@_equation(18)
def _shape_ends(context: Context) -> Found:
    natural = context.derivation.motion.natural
    keys = sorted(natural)
    separated = {}
    for key, equation in zip(keys, _step(context, "Eq. (17)")[1:], strict=True):
        value, place = sp.factor(_named(equation.lhs)), sp.Integer(key[0])
        separated[key] = value.replace(lambda e: isinstance(e, Derivative), lambda e, at=place: Subs(e, x, at))
    derived, difference = _at_both_ends(EQUATIONS[17].typed, separated)
    return Found(derived, "Eq. (16) put into the derived end conditions", difference)


@_equation(19)
def _quartic(context: Context) -> Found:
    shape, quartic = (_named(equation) for equation in _step(context, "Eq. (19)"))
    gap = sp.simplify(EQUATIONS[18].typed[1].rhs - quartic.rhs)
    first = canonical(residual(EQUATIONS[18].typed[0]) - residual(shape))
    return Found((shape, quartic), "Eq. (17) as derived, divided by the factor of χ⁗", (first, gap))


@_equation(20)
def _free_ends(context: Context) -> Found:
    orders = context.derivation.beam.orders
    if orders[0] != orders[1]:
        raise NotShown("the ends are alike")
    derived = (*(_eq(chi.diff(x, d), 0) for d in orders[0]), *EQUATIONS[19].typed[2:])
    return Found(derived, "the factor 1 + λ₀α struck out; orders from the bending energy by parts")


@_equation(21)
def _characteristic(context: Context) -> Found:
    # the determinant of the four conditions on the printed functions
    shapes = (sp.sin(gamma * x), sp.cos(gamma * x), sp.sinh(gamma * x), sp.cosh(gamma * x))
    conditions = sp.Matrix([[f.diff(x, d).subs(x, end) / gamma**d for f in shapes] for end in (0, 1) for d in (2, 3)])
    determinant = sp.expand(conditions.det().rewrite(sp.exp))
    stated = sp.expand((2 * (sp.cos(gamma) * sp.cosh(gamma) - 1)).rewrite(sp.exp))
    if sp.simplify(determinant - stated) != 0 and sp.simplify(determinant + stated) != 0:
        raise NotShown("Eq. (21) from the determinant")
    return Found((context.derivation.beam.equation,), "the determinant of the four end conditions, in two bases")


@_equation(22)
def _mode(context: Context) -> Found:
    """In decaying exponentials the derived mode is sin γx + B cos γx + C e^(−γx) + D e^(−γ(1−x))."""
    beam = context.derivation.beam
    e = comparison.epsilon
    values = {sp.cos(gamma): beam.cosine, sp.sin(gamma): beam.sine}
    values |= {sp.cosh(gamma): (e + 1 / e) / 2, sp.sinh(gamma): (1 / e - e) / 2}
    ratio = ((sp.cos(gamma) - sp.cosh(gamma)) / (sp.sin(gamma) + sp.sinh(gamma))).subs(values)  # as printed
    typed = (S.One, ratio, (ratio - 1) / 2, (ratio + 1) / 2 / e)  # e^(γx) = e^(−γ(1−x)) / ε
    gaps = [
        comparison.canonical(a - b.subs(comparison.eta, comparison.sigma * e))
        for a, b in zip(typed, beam.coefficients, strict=True)
    ]
    return Found(
        (_eq(chi, beam.mode()),),
        "equal in decaying exponentials, with tail = ±e^(−γ) and sin γ, cos γ on the roots of Eq. (21); all four end "
        "conditions vanish identically",
        (sum((abs(gap) for gap in gaps), S.Zero),),
    )


@_equation(23)
def _frequencies(context: Context) -> Found:
    first, second = _damped(context).eigenvalues
    return Found((_eq(p.lambda_01, first), _eq(p.lambda_02, second)), "both put back solve Eq. (19)")


# --- section 3.2 --------------------------------------------------------------------------------------------


@_equation(24)
def _exponential(context: Context) -> Found:
    row = EQUATIONS[9].typed[0].lhs.subs(q_j, p.qhat_j * sp.exp(p.lambda_ * t)).doit() / sp.exp(p.lambda_ * t)
    pencil = (p.lambda_**2 * p.M_ij + p.lambda_ * p.C_ij + p.K_ij) * p.qhat_j
    _show("Eq. (24) turns Eq. (10) into (λ²M + λC + K) q̂ = 0", row - pencil)
    return Found(EQUATIONS[23].typed, "put into Eq. (10) without force it leaves (λ²M + λC + K) q̂ = 0")


@_equation(25)
def _state_matrix(context: Context) -> Found:
    M, C, K = p.M, p.C, p.K
    q, lam = Symbol("q", commutative=False), p.lambda_
    A = EQUATIONS[24].typed[0].rhs.subs(p.identity, 1)
    state = sp.Matrix([q, lam * q])
    rows = A * state - lam * state
    _show("the first row of A", rows[0])
    pencil = sp.expand(M * rows[1]) + sp.expand((lam**2 * M + lam * C + K) * q)
    _show("A (q, λq) = λ (q, λq) is (λ²M + λC + K) q = 0", pencil)
    rate = Symbol("rate", commutative=False)
    solved = sp.expand(M**-1 * (-K * q - C * rate))  # the acceleration of Eq. (10) without force
    blocks = [(solved - solved.subs(vector, 0)).subs(vector, 1) for vector in (q, rate)]
    derived = sp.Matrix([[0, p.identity], blocks]).as_immutable()
    gap = tuple(sp.expand(entry) for entry in EQUATIONS[24].typed[0].rhs - derived)
    return Found(
        (_eq(p.A, derived),),
        "Eq. (10) without force as a first-order system; A (q, λq) = λ (q, λq) is (λ²M + λC + K) q = 0, "
        "in noncommuting matrices",
        gap,
    )


@_equation(26)
def _normalised(context: Context) -> Found:
    """λ₀₁ is the square root in Eq. (23) divided by 2i: real where mode 1 oscillates, and else not."""
    root = _damped(context).eigenvalues[0] - _damped(context).eigenvalues[1]
    square = sp.expand((root / 2) ** 2)  # −λ₀₁², negative where mode 1 oscillates
    edge = sp.solve(square.subs(beta, 0), alpha)
    (limit,) = [value for value in edge if value.is_positive]
    _show("mode 1 is overdamped from α = 2/γ₁² at β = 0", limit - 2 / gamma**2)
    with_sign = Eq(p.reference, sp.sqrt(-square), evaluate=False)
    inside = float(limit.subs(gamma, first_root())) < 0.1
    undefined = Function("undefined")(sp.Ge(alpha, limit))
    return Found(
        (*EQUATIONS[25].typed, with_sign),
        "λ₀₁ of the second term of Eq. (23) is real only for β + αγ₁⁴ < 2γ₁²; at β = 0 up to α = 2/γ₁² = "
        f"{float(limit.subs(gamma, first_root())):.4f}, and Fig. 4 goes to 0.1",
        (undefined if inside else S.Zero,),
    )


def first_root() -> float:
    """γ₁ of Eq. (21)."""
    return float(sp.nsolve(sp.cos(gamma) * sp.cosh(gamma) - 1, gamma, 4.73))
