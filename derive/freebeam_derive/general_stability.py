"""From the matrices of any column to its stability, as a record: eigenvalues, damping, work, the exact system."""

from __future__ import annotations

from typing import Any

from sympy import Eq, Expr, Function, I, Integer, Lambda, S, Subs, Symbol, exp, expand, symbols

from freebeam_derive import motions, pulsation
from freebeam_derive.derivation import GeneralDerivation
from freebeam_derive.display import gathered
from freebeam_derive.eigenproblem import STAGE, C, K, M, cycle_of, eigenproblem, meeting, v
from freebeam_derive.forms import BilinearForm
from freebeam_derive.jets import ALWAYS, name_of, segment_of
from freebeam_derive.notation import F_0, alpha, beta, chi, lambda_, omega, t, x
from freebeam_derive.record import Step, equal
from freebeam_derive.statement import jets
from freebeam_derive.variation import leaping


def undamped(d: GeneralDerivation) -> bool:
    """Whether there are no forces with rates where alpha and beta are zero."""
    none = {alpha: S.Zero, beta: S.Zero}
    return not any(f.subs(none) != 0 for form in d.system.C for f in (*form.along.values(), *form.points.values()))


def linear(d: GeneralDerivation) -> bool:
    """Whether the load enters as in K = E + P H."""
    return len(d.system.M) == 1 and len(d.system.K) == 2


def circulatory(d: GeneralDerivation) -> bool:
    """Whether a stiffness is not symmetric."""
    return any(form and not _symmetric(form) for form in d.system.K)


def _symmetric(form: BilinearForm) -> bool:
    other = form.transposed
    along = all(expand(form.along.get(k, S.Zero) - f) == 0 for k, f in other.along.items())
    return along and all(expand(form.points.get(k, S.Zero) - f) == 0 for k, f in other.points.items())


def steps(d: GeneralDerivation) -> tuple[Step, ...]:
    """What follows for the stability of a column. Eqs. (24), (25)."""
    found = [*eigenproblem()]
    if undamped(d):
        found += [*(meeting() if linear(d) else ()), _damped()]
    return (*found, cycle_of(K, S.One), *_exact_system(d), *pulsation.steps())


def _damped() -> Step:
    small, rate = symbols("epsilon lambda_1")
    u_T, w = symbols("u^T w", commutative=False)

    def perturbed() -> Any:
        """λ = iω + ε λ_1, v + ε w and damping ε C in the eigenvalue problem: its first order, times uᵀ."""
        value = I * omega + small * rate
        whole = expand((value**2 * M + value * small * C + K) * (v + small * w))
        first = expand(u_T * whole.coeff(small, 1))
        known = expand(first - u_T * K * w + omega**2 * u_T * M * w)  # uᵀ K = ω² uᵀ M
        return expand(known - I * omega * (2 * rate * u_T * M * v + u_T * C * v))

    return Step(
        STAGE,
        "Damp any column a little",
        "u and v are the null vectors of K − ω² M on either side: to first order damping C moves the eigenvalue iω of "
        "a mode off the axis, to the side that the sign of uᵀ C v says",
        Eq((lambda_**2 * M + lambda_ * small * C + K) * v, 0, evaluate=False),
        (
            Eq(lambda_, I * omega + small * rate, evaluate=False),
            Eq(2 * rate * u_T * M * v, -u_T * C * v, evaluate=False),
        ),
        "",
        "put into the eigenvalue problem, the first order times uᵀ from the left",
        perturbed,
    )


# --- without a series -------------------------------------------------------------------------------------------------


def _shape(name: str, coordinates: tuple[str, ...]) -> Expr:
    """What an unknown is but for e^(λt)."""
    if name == "y":
        return chi
    return Symbol(f"shape_{name}") if name in coordinates else Function(f"shape_{name}", real=True)(x)


def _separated(d: GeneralDerivation, part: Expr) -> Expr:
    """An expression in jets with each unknown a shape times e^(λt), that factor apart and without force."""
    names = d.column.coordinates
    values: dict[Expr, Expr] = {}
    for j in jets(part):
        which, order, rate, place = j.args
        shape = _shape(name_of(which), names)
        if place != ALWAYS:
            shape = shape.diff(x, int(order)) if int(order) else shape
            if segment_of(place) is None:
                shape = Subs(shape, x, place)
        values[j] = lambda_ ** int(rate) * shape
    return part.xreplace(values).xreplace({F_0: S.Zero})


def _exact_system(d: GeneralDerivation) -> tuple[Step, ...]:
    motion, names = d.motion, d.column.coordinates
    if not motion.spaces:
        return ()
    along = {key: _separated(d, gathered(factor)) for key, factor in motion.equations.items()}
    distinct = tuple(dict.fromkeys(along.values()))
    coordinates = [_separated(d, leaping(work.points)) for work in motion.of_coordinates.values() if work.density == 0]

    def separated() -> Any:
        """Polynomials for the shapes, times e^(λt), in the equations of motion."""
        shapes = {name: motions.polynomial(3 + k, 6) for k, name in enumerate(d.column.fields)}
        left = []
        for key, factor in motion.equations.items():
            values = {}
            for j in jets(factor):
                which, order, rate, place = j.args
                name = name_of(which)
                whole = (Integer(2) if place == ALWAYS else shapes[name]) * exp(lambda_ * t)
                values[j] = whole.diff((x, int(order)), (t, int(rate)))
            stated = factor.xreplace(values).xreplace({F_0: S.Zero})
            found = along[key]
            for name, shape in shapes.items():
                found = found.replace(_shape(name, names).func, Lambda(x, shape))
            found = found.subs({_shape(name, names): 2 for name in names}).doit()
            left.append(expand((stated - found * exp(lambda_ * t)).rewrite(exp)))
        return tuple(left)

    return (
        Step(
            STAGE,
            "Leave the series out",
            "each unknown a shape times e^(λt): ordinary differential equations on each segment. Power series solve "
            "them, and the conditions at ends and breaks join the solutions",
            motion.written,
            tuple(equal(e, 0) for e in (*distinct, *coordinates)),
            "",
            "put into the equations of motion, the factor e^(λt) apart",
            separated,
        ),
    )
