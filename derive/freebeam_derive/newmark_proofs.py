"""What proves the steps of Newmark's method: systems of numbers, marched exactly; series compared at small steps."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import mpmath
from sympy import Expr, Integer, Matrix, Rational, S, Symbol, cancel, expand, eye, lambdify, symbols

from freebeam_derive import motions
from freebeam_derive.newmark import STAGE
from freebeam_derive.newmark import derive_newmark as _method
from freebeam_derive.record import Step

__all__ = ["PROOFS", "STAGE"]

HALF, QUARTER = Rational(1, 2), Rational(1, 4)
SMALL, DIGITS = 25, 150  # a step of 10^-25, at which the second term of a series is beyond 20 digits


def _noncommuting(names: str) -> tuple[Symbol, ...]:
    found = symbols(names, commutative=False)
    return found if isinstance(found, tuple) else (found,)


def _assumptions(step: Step) -> Any:
    """exact for constant acceleration, whatever b and g, and for linear acceleration at b = 1/6, g = 1/2."""
    method = _method()
    left = []
    for degree, parameters in ((2, {}), (3, {method.b: Rational(1, 6), method.g: HALF})):
        path = motions.polynomial(3, degree, method.h)
        start = [path.diff(method.h, k).subs(method.h, 0) for k in range(3)]
        values = dict(zip(step.before, (*start, path.diff(method.h, 2)), strict=True))
        for found, exact in zip(step.after, (path, path.diff(method.h)), strict=True):
            left.append(expand(found.subs(parameters).xreplace(values) - exact))
    return tuple(left)


def _at_the_end(step: Step) -> Any:
    """the two assumptions put in for the state at the end."""
    q_next, dq_next = _method().steps[0].after
    both = dict(zip(_noncommuting("q_next dq_next"), (q_next, dq_next), strict=True))
    return expand(step.before.xreplace(both) - step.after)


def _numbers(n: int, seed: int) -> Matrix:
    return Matrix(n, n, lambda i, j: Rational((seed * 13 + 7 * i + 5 * j * j + 3) % 17 - 8, 3) + 9 * (i == j))


def _march(M: Matrix, C: Matrix, K: Matrix, F: Matrix, state: tuple[Matrix, ...], h: Expr, b: Expr, g: Expr) -> Any:
    """One step from the two assumptions and the equation of motion as they stand: linear equations in all unknowns."""
    q, dq, ddq = state
    a = (M + g * h * C + b * h**2 * K).LUsolve(
        F - C * (dq + (1 - g) * h * ddq) - K * (q + h * dq + (HALF - b) * h**2 * ddq)
    )
    return q + h * dq + h**2 * ((HALF - b) * ddq + b * a), dq + h * ((1 - g) * ddq + g * a), a


def _solved(step: Step) -> Any:
    """one step with matrices of numbers: the new state satisfies the equation of motion, exactly."""
    method, n = _method(), 3
    values: dict[str, Any] = {str(m): _numbers(n, k + 1) for k, m in enumerate(method.matrices)}
    values |= {str(v): _numbers(n, k + 5)[:, 0] for k, v in enumerate((*method.state, method.force))}
    h, b, g = Rational(1, 3), Rational(2, 7), Rational(3, 5)
    scalars = {method.h: h, method.b: b, method.g: g}

    def number(e: Any) -> Any:
        if e.is_MatAdd:
            return sum((number(a) for a in e.args[1:]), number(e.args[0]))
        if e.is_MatMul:
            found: Any = S.One
            for a in e.args:
                found = found * (number(a) if getattr(a, "is_Matrix", False) else a.subs(scalars))
            return found
        return number(e.arg).inv() if e.func.__name__ == "Inverse" else values[str(e)]

    for name, expression in method.formulas:
        values[name] = number(expression)
    M, C, K = (values[name] for name in "MCK")
    return M * values["ddq_next"] + C * values["dq_next"] + K * values["q_next"] - values["F"]


def _coordinates(step: Step) -> Any:
    """it is Ψ times the equation before, as an identity in matrices that do not commute."""
    left = Symbol("Psi", commutative=False)
    return expand(step.after - expand(left * step.before))


def _oscillator() -> Matrix:
    """The matrix that marches (q, h dq) of one oscillator, column by column."""
    Omega, xi, b, g = _parameters().values()
    M, C, K = Matrix([1]), Matrix([2 * xi * Omega]), Matrix([Omega**2])
    columns = []
    for d, v in ((1, 0), (0, 1)):
        q, dq = Matrix([d]), Matrix([v])
        q_next, dq_next, _ = _march(M, C, K, Matrix([0]), (q, dq, -C * dq - K * q), Integer(1), b, g)
        columns.append(Matrix([q_next[0], dq_next[0]]))
    return Matrix.hstack(*columns)


def _parameters() -> dict[Symbol, Expr]:
    method = _method()
    numbers = (Rational(3, 4), Rational(1, 7), Rational(2, 7), Rational(3, 5))
    return dict(zip((method.Omega, method.xi, method.b, method.g), numbers, strict=True))


def _amplification(step: Step) -> Any:
    """one step of an oscillator of numbers, from both unit states, exactly."""
    return step.after.subs(_parameters()) - _oscillator()


def _characteristic(step: Step) -> Any:
    """the determinant of ρ − A for a march of numbers, exactly."""
    return cancel(step.after[0].subs(_parameters()) - (_method().rho * eye(2) - _oscillator()).det())


def _pencil(step: Step) -> Any:
    """it vanishes at the growth of a march of numbers; at (1/4, 1/2) the quotients are λ² and λ, exactly."""
    method = _method()
    (m, c, k), bilinear = step.after
    h, rho, Omega, xi = method.h, method.rho, method.Omega, method.xi
    whole = (m + 2 * xi * Omega * c + Omega**2 * k).subs(h, 1).subs(_parameters())
    ratio = cancel(whole / (rho * eye(2) - _oscillator()).det())
    average = {method.b: QUARTER, method.g: HALF}
    lam = bilinear.rhs
    return (
        ratio.diff(rho),
        cancel((m / k).subs(average) - lam**2),
        cancel((c / k).subs(average) - lam),
    )


def _conditions(step: Step) -> Any:
    """the coefficients put back make the polynomial in z."""
    z = Symbol("z")
    flip, grow, static = step.after
    return expand(step.before - flip * z**2 - grow * z - static)


def _unconditional(step: Step) -> Any:
    """the substitution done again; no coefficient is negative."""
    s, t = symbols("s t", nonnegative=True)
    method = _method()
    region = {method.g: HALF + s, method.b: (HALF + s) / 2 + t}
    left = [expand(c.subs(region, simultaneous=True) - a) for c, a in zip(step.before, step.after, strict=True)]
    negative = [c for a in step.after for c in a.as_poly(method.Omega, method.xi, s, t).coeffs() if c < 0]
    return (*left, Integer(len(negative)))


def _largest_step(step: Step) -> Any:
    """at the limit the condition vanishes, for three sets of numbers, 45 digits."""
    method = _method()
    names = (method.b, method.g, method.xi)
    inverse, limit = (lambdify(names, e, "mpmath") for e in step.after)
    flip = lambdify((method.Omega, *names), step.before[0], "mpmath")
    with mpmath.workdps(50):
        left = []
        for fractions in (("0", "1/2", "0"), ("1/12", "1/2", "1/5"), ("1/4", "3/5", "1/3")):
            numbers = [mpmath.mpf(fraction) for fraction in fractions]
            Omega = limit(*numbers)
            left += [inverse(*numbers) * Omega - 1, flip(Omega, *numbers)]
        return tuple(left)


def _matrices_at(Omega: Any, xi: Any, b: Any, g: Any) -> Any:
    method = _method()
    A = lambdify((method.Omega, method.xi, method.b, method.g), method.amplification, "mpmath")
    return A(Omega, xi, b, g)


def _order(step: Step) -> Any:
    """one step of 10⁻²⁵ against the matrix exponential: the leading terms agree to 20 digits."""
    method = _method()
    second, third, _ = step.after
    with mpmath.workdps(DIGITS):
        Omega, xi, b = mpmath.mpf(10) ** -SMALL, mpmath.mpf(2) / 7, mpmath.mpf(1) / 5
        exact = mpmath.expm(mpmath.matrix([[0, 1], [-1, -2 * xi]]) * Omega)
        left = []
        for g, power, series in ((mpmath.mpf(1) / 2, 3, third), (mpmath.mpf(3) / 5, 2, second)):
            A = _matrices_at(Omega, xi, b, g)
            term = lambdify((method.xi, method.b, method.g), series, "mpmath")(xi, b, g)
            for i in range(2):
                for j in range(2):
                    left.append((A[i, j] * Omega ** (j - i) - exact[i, j]) / Omega**power - term[i, j])
        return tuple(left)


def _errors(step: Step) -> Any:
    """the logarithms of the roots at a step of 10⁻²⁵: the leading terms agree to 20 digits."""
    method = _method()
    c2, c3, damping, elongation = step.after
    s = Symbol("s")
    with mpmath.workdps(DIGITS):
        Omega, b = mpmath.mpf(10) ** -SMALL, mpmath.mpf(1) / 5
        left = []
        for xi, g in (
            (mpmath.mpf(2) / 7, mpmath.mpf(3) / 5),
            (mpmath.mpf(0), mpmath.mpf(3) / 5),
            (mpmath.mpf(0), mpmath.mpf(1) / 2),
        ):
            A = _matrices_at(Omega, xi, b, g)
            trace, determinant = A[0, 0] + A[1, 1], A[0, 0] * A[1, 1] - A[0, 1] * A[1, 0]
            grown = mpmath.log(trace / 2 + mpmath.sqrt(trace**2 / 4 - determinant))
            root = -xi + mpmath.sqrt(xi**2 - 1)
            two, three = (lambdify((s, method.b, method.g), e, "mpmath")(root, b, g) for e in (c2, c3))
            left.append((grown - root * Omega - two * Omega**2 - three * Omega**3) / Omega**3)
            numbers = (Omega, b, g)
            if xi == 0 and g != 0.5:
                wanted = lambdify((method.Omega, method.b, method.g), damping, "mpmath")(*numbers)
                left.append(-grown.real / abs(grown) / wanted - 1)
            if xi == 0 and g == 0.5:
                wanted = lambdify((method.Omega, method.b, method.g), elongation, "mpmath")(*numbers)
                left.append((Omega / grown.imag - 1) / wanted - 1)
        return tuple(left)


def _energy(step: Step) -> Any:
    """a step of numbers keeps the energy exactly where K is symmetric, and does not where it is not."""
    n, h = 3, Rational(1, 3)
    M, K = (_numbers(n, k) + _numbers(n, k).T for k in (1, 2))
    gains = []
    for stiffness in (K, K + (_numbers(n, 4) - _numbers(n, 4).T)):
        q, dq = _numbers(n, 5)[:, 0], _numbers(n, 6)[:, 0]
        start = (q, dq, -M.LUsolve(stiffness * q))
        after = _march(M, M * 0, stiffness, q * 0, start, h, QUARTER, HALF)
        energy = [(v.T * M * v + u.T * stiffness * u)[0] / 2 for u, v in ((q, dq), after[:2])]
        gains.append(energy[1] - energy[0])
    return (step.after[0], gains[0], Integer(0 if gains[1] != 0 else 1))


PROOFS: dict[str, Callable[[Step], Any]] = {
    "Newmark's two assumptions": _assumptions,
    "the equation of motion at the end of the step": _at_the_end,
    "solved for the new acceleration": _solved,
    "a change of coordinates": _coordinates,
    "the amplification matrix": _amplification,
    "characteristic polynomial and spectral radius": _characteristic,
    "growth in any system": _pencil,
    "stability conditions": _conditions,
    "unconditional stability": _unconditional,
    "the largest stable step": _largest_step,
    "order of accuracy": _order,
    "errors of period and damping": _errors,
    "energy": _energy,
}
