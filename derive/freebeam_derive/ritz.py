"""The Ritz series into the weak form: M, C, K, Q as bilinear forms of the trial functions. Eqs. (9)-(13).

The row i belongs to the test function (δy = φ_i δq_i), the column j to the trial function (y = Σ φ_j q_j). A form
is a sum of integrals of x^k φ_i^(p) φ_j^(q) and of products of end values, with factors in the parameters.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from sympy import (
    Add,
    Expr,
    Function,
    Integer,
    Integral,
    Mul,
    Poly,
    PolynomialError,
    S,
    Subs,
    Symbol,
    cancel,
    expand,
)

from freebeam_derive.notation import F_0, PRIMES, P, alpha, beta, t, x, x_F
from freebeam_derive.record import Step, equal
from freebeam_derive.statement import ALONG, StatementError, display, jet, jets, show
from freebeam_derive.variation import EquationOfMotion

STAGE = "Ritz series"


class NotTextbook(StatementError):
    """A column whose matrices are not M, C = c_M M + c_E E and K = E + P H over one segment: assembly.py takes it."""


HIGHEST_POWER = 3  # of x in an integral

phi_i = Function("phi_i", real=True)(x)
phi_j = Function("phi_j", real=True)(x)
q_j = Function("q_j", real=True)(t)

Along = tuple[int, int, int]  # k, p (test), q (trial)
Points = tuple[Expr, int, Expr, int]  # place and order of the test function, of the trial function


@dataclass(frozen=True)
class Form:
    """A bilinear form: factors of ∫ x^k φ_i^(p) φ_j^(q) dx and of φ_i^(p)(a) φ_j^(q)(b)."""

    along: dict[Along, Expr] = field(default_factory=dict)
    points: dict[Points, Expr] = field(default_factory=dict)

    def map(self, function) -> Form:  # type: ignore[no-untyped-def]
        """The form with a function applied to each factor; zero factors are dropped."""
        along = {key: expand(function(value)) for key, value in self.along.items()}
        points = {key: expand(function(value)) for key, value in self.points.items()}
        return Form({k: v for k, v in along.items() if v != 0}, {k: v for k, v in points.items() if v != 0})

    def __add__(self, other: Form) -> Form:
        along, points = dict(self.along), dict(self.points)
        for key, value in other.along.items():
            along[key] = along.get(key, S.Zero) + value
        for place, value in other.points.items():
            points[place] = points.get(place, S.Zero) + value
        return Form(along, points).map(lambda f: f)

    def __bool__(self) -> bool:
        return bool(self.along or self.points)

    @property
    def symmetric(self) -> bool:
        """Whether the form is unchanged when test and trial function change places."""
        return self.transposed == self

    @property
    def transposed(self) -> Form:
        return Form(
            {(k, q, p): v for (k, p, q), v in self.along.items()},
            {(b, q, a, p): v for (a, p, b, q), v in self.points.items()},
        )

    @property
    def expression(self) -> Expr:
        """The form in φ_i(x) and φ_j(x), as Eq. (11) prints it."""
        along = Add(
            *(
                v * Integral(x**k * phi_i.diff(x, p) * phi_j.diff(x, q), (x, 0, 1))
                for (k, p, q), v in sorted(self.along.items())
            )
        )
        return along + Add(*(v * _value(phi_i, a, p) * _value(phi_j, b, q) for (a, p, b, q), v in self.points.items()))


def _value(phi: Expr, place: Expr, order: int) -> Expr:
    return Subs(phi.diff(x, order), x, place) if order else phi.subs(x, place)


@dataclass(frozen=True)
class RitzSystem:
    """M q̈ + C q̇ + K q = F_0 Q with K = E + P H and C = c_M M + c_E E. Eqs. (10)-(13).

    forces: places of F_0, each with its factor. c_M, c_E: β and α, unless the energies shift them.
    """

    M: Form
    C: Form
    E: Form
    H: Form
    c_M: Expr
    c_E: Expr
    forces: tuple[tuple[Expr, Expr], ...]
    steps: tuple[Step, ...]

    @property
    def K(self) -> Form:
        return self.E + self.H.map(lambda f: P * f)


def derive(motion: EquationOfMotion) -> RitzSystem:
    """Substitute the series (9) into the weak form and read off the matrices. Eqs. (10), (11).

    Raises NotTextbook for what the closed forms do not reach: several fields or segments, an x-dependence that is no
    polynomial of degree up to 3, work off the ends, or a damping that is not of the kind of Eq. (12);
    StatementError for what makes no sense.
    """
    if not motion.textbook:
        raise NotTextbook("other fields than y, coordinates or several segments")
    forms = {rate: _form(motion, rate) for rate in range(3)}
    M, C, K = forms[2], forms[1], forms[0]
    E = K.map(lambda f: f.subs(P, 0))
    H = K.map(lambda f: f.coeff(P, 1))
    if _power_of_the_load(K) > 1 or _power_of_the_load(M) or _power_of_the_load(C):
        raise NotTextbook("the load enters beyond K = E + P H")
    if any(f.has(alpha, beta) for part in (K.along, K.points) for f in part.values()):
        raise NotTextbook("alpha or beta acts on a displacement")
    if not H:
        raise StatementError("the load P does no work on the beam: it enters no stiffness")
    for name, form in (("M", M), ("K at zero load", E)):
        if not form.symmetric:
            raise NotTextbook(
                f"{name} = {display_form(form)} is not symmetric; work without a potential is supported of the load P "
                "alone"
            )
    _refuse_driving(C)
    c_M, c_E = _proportions(M, C, E)
    forces = _forces(motion)

    series = equal(show(jet(Integer(0), Integer(0), Integer(0), ALONG)), Symbol("Sigma_j") * phi_j * q_j)
    matrices = {"M": M, "C": C, "K": K}
    force = F_0 * Add(*(size * phi_i.subs(x, place) for place, size in forces))
    stated = (
        *(equal(Symbol(f"{name}_ij"), form.expression) for name, form in matrices.items()),
        equal(Symbol("Q_i"), force),
    )
    geometric = H.map(lambda f: P * f)
    identity = _difference(C, M.map(lambda f: c_M * f) + (K + geometric.map(lambda f: -f)).map(lambda f: c_E * f))
    if identity:
        raise AssertionError("Eq. (12) does not hold for the derived forms")
    steps = (
        Step(
            STAGE,
            "Approximate the deflection by a series",
            "trial functions times generalised coordinates; the test function is one of them",
            series.lhs,
            series,
            "Eq. (9)",
            "section 3.1's four conditions, checked for the basis",
        ),
        Step(
            STAGE,
            "Substitute it into the weak form",
            "the factors of the accelerations, rates and coordinates are the matrices",
            equal(display(motion.weak, motion.length), 0),
            stated,
            "Eq. (11)",
            "each term of the weak form is bilinear in the test and the trial function",
        ),
        Step(
            STAGE,
            "Collect the equation of the coordinates",
            "one equation for each test function",
            stated,
            equal(Add(*(Symbol(f"{n}_ij") * q_j.diff(t, 2 - k) for k, n in enumerate(matrices))), Symbol("Q_i")),
            "Eq. (10)",
            "row i is the test function",
        ),
        Step(
            STAGE,
            "Split the geometric stiffness off",
            "the load's part of the stiffness does not enter the damping",
            equal(Symbol("K_ij"), K.expression),
            equal(Symbol("K^G_ij"), geometric.expression),
            "Eq. (13)",
            "coefficient of the load",
        ),
        Step(
            STAGE,
            "Compare the damping with mass and elastic stiffness",
            "proportional damping, the load's stiffness left out",
            equal(Symbol("C_ij"), C.expression),
            equal(Symbol("C_ij"), c_M * Symbol("M_ij") + c_E * (Symbol("K_ij") - Symbol("K^G_ij"))),
            "Eq. (12)",
            "identity of the bilinear forms, term by term",
        ),
    )
    return RitzSystem(M, C, E, H, c_M, c_E, forces, steps)


def _power_of_the_load(form: Form) -> int:
    return max((int(Poly(f, P).degree()) for f in (*form.along.values(), *form.points.values())), default=0)


def _difference(one: Form, other: Form) -> Form:
    return one + other.map(lambda f: -f)


def _form(motion: EquationOfMotion, rate: int) -> Form:
    """The bilinear form that multiplies the rate-th derivative of the coordinates in the weak form."""
    along: dict[Along, Expr] = {}
    points: dict[Points, Expr] = {}
    for part in (motion.weak.density, motion.weak.points):
        for test in jets(part, 1):
            for trial in jets(part.coeff(test), 0):
                if int(trial.args[2]) != rate:
                    continue
                p, q = int(test.args[1]), int(trial.args[1])
                factor = expand(part.coeff(test).coeff(trial))
                if test.args[3] != ALONG:
                    a, b = test.args[3], trial.args[3]
                    if {a, b} - {S.Zero, motion.length}:
                        raise NotTextbook(
                            f"the work {show(factor * test * trial)}: springs, masses and loads inside the beam, or "
                            "beyond its ends, are not supported; only F_0 acts inside"
                        )
                    points[a, p, b, q] = factor
                    continue
                try:
                    powers = Poly(factor, x)
                except PolynomialError:
                    powers = None
                if powers is None or powers.degree() > HIGHEST_POWER or any(c.has(x) for c in powers.coeffs()):
                    raise NotTextbook(
                        f"the factor {factor} is no polynomial in x of degree {HIGHEST_POWER} or less; others are not "
                        "supported"
                    )
                for (k,), coefficient in powers.terms():
                    along[k, p, q] = along.get((k, p, q), S.Zero) + coefficient
    return Form(along, points).map(lambda f: f)


def _refuse_driving(C: Form) -> None:
    """Damping that feeds energy in whatever the motion and the parameters: a sign that was forgotten."""
    squares: dict[Any, Form] = {}  # what multiplies the square of a rate; powers of x are positive
    for (k, p, q), factor in C.along.items():
        if p == q:
            squares.setdefault(p, Form()).along[k, p, q] = factor
    for (a, p, b, q), factor in C.points.items():
        if (a, p) == (b, q):
            squares.setdefault((a, p), Form()).points[a, p, b, q] = factor
    for form in squares.values():
        if all(factor.is_nonpositive for factor in (*form.along.values(), *form.points.values())):
            raise StatementError(
                f"dW_nc: the damping C = {display_form(form)} feeds energy in, whatever the motion, which is not "
                "supported; damping opposes the motion, such as -beta * y.diff(t) * delta(y); what is meant to drive, "
                "such as wind, takes a parameter of its own, whose value may be negative"
            )


def _proportions(M: Form, C: Form, E: Form) -> tuple[Expr, Expr]:
    """c_M, c_E with C = c_M M + c_E E as forms. Eq. (12)."""
    if not C:
        return S.Zero, S.Zero
    bending = next(key for key in sorted(E.along, reverse=True) if key[1:] == (2, 2))
    c_E = cancel(C.along.get(bending, S.Zero) / E.along[bending])
    rest = _difference(C, E.map(lambda f: c_E * f))
    inertia = min(M.along)
    c_M = cancel(rest.along.get(inertia, S.Zero) / M.along[inertia])
    if _difference(rest, M.map(lambda f: c_M * f)) or c_M.has(x) or c_E.has(x):
        raise NotTextbook(
            f"the damping {display_form(C)} is not of the form C = beta M + alpha E (Eq. (12)) with "
            f"M = {display_form(M)}, E = {display_form(E)}, all masses and all stiffnesses, springs too; no other "
            "damping is supported"
        )
    return expand(c_M), expand(c_E)


def _forces(motion: EquationOfMotion) -> tuple[tuple[Expr, Expr], ...]:
    """Places and factors of F_0 in the virtual work, Q_i = Σ factor φ_i(place). Eq. (11), last line."""
    found = []
    for test in jets(motion.weak.points, 1):
        factor = motion.weak.points.coeff(test)
        alone = Mul(-1, factor.xreplace(dict.fromkeys(jets(factor, 0), S.Zero)))
        if expand(alone) == 0:
            continue
        size = expand(alone / F_0)
        if int(test.args[1]) or test.args[3] != x_F or size != 1:
            raise StatementError(
                f"the work {show(alone * test)} is not supported; the transversal force is F_0 * at(delta(y), x_F)"
            )
        found.append((test.args[3], size))
    if motion.weak.density.xreplace(dict.fromkeys(jets(motion.weak.density, 0), S.Zero)) != 0:
        raise StatementError(
            "a force along the beam without y is not supported; the transversal force is F_0 * at(delta(y), x_F)"
        )
    return tuple(found)


_SUPERSCRIPT = str.maketrans("0123456789", "⁰¹²³⁴⁵⁶⁷⁸⁹")


def display_form(form: Form) -> str:
    """A form in one line of text, such as −∫ x φᵢ′ φⱼ′ dx + φᵢ(1) φⱼ′(1)."""
    terms: list[tuple[Expr, str]] = []
    for (k, p, q), value in sorted(form.along.items()):
        power = "" if k == 0 else "x " if k == 1 else f"x{str(k).translate(_SUPERSCRIPT)} "
        terms.append((value, f"∫ {power}φᵢ{PRIMES[p]} φⱼ{PRIMES[q]} dx"))
    for (a, p, b, q), value in form.points.items():
        terms.append((value, f"φᵢ{PRIMES[p]}({a}) φⱼ{PRIMES[q]}({b})"))
    text = ""
    for value, term in terms:
        negative = value.could_extract_minus_sign()
        size = -value if negative else value
        factor = "" if size == 1 else f"({size}) " if size.is_Add else f"{size} "
        text += (" − " if text else "−") if negative else (" + " if text else "")
        text += f"{factor}{term}"
    return text or "0"
