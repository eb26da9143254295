"""A load that pulsates, P (1 + ε cos Ωt): multipliers, and where motion grows for a small amplitude.

Of one mode alone, whose squared frequency is s(P): its edges to first order in ε. All regions are the runtime's,
freebeam_sym/stability/pulse.py.
"""

from __future__ import annotations

from typing import Any

from sympy import Eq, Expr, Function, Matrix, Symbol, cos, diff, exp, expand, pi, sin, sqrt, symbols

from freebeam_derive.eigenproblem import branch, s
from freebeam_derive.notation import P, t
from freebeam_derive.record import Step

STAGE = "pulsation"

epsilon = Symbol("epsilon", positive=True)
Omega = Symbol("Omega", positive=True)


def steps() -> tuple[Step, ...]:
    """What holds of any column whose load pulsates."""
    return (_hill(), _volume(), _edges())


def _hill() -> Step:
    u, load = Function("u")(t), P * (1 + epsilon * cos(Omega * t))
    slope = branch(P).diff(P)

    def first_order() -> Any:
        """Taylor's polynomial of s about P, for a curve of the third degree, to the first power of ε."""
        c = symbols("c0:4")
        polynomial = sum(c[k] * P**k for k in range(4))
        moved = polynomial.subs(P, load)
        return expand(moved.diff(epsilon).subs(epsilon, 0) - P * polynomial.diff(P) * cos(Omega * t))

    return Step(
        STAGE,
        "Follow one mode while the load pulsates",
        "one mode alone, whose squared frequency is s at the load P: to first order in ε it swings as a child's swing "
        "whose length is changed in time (Mathieu's equation)",
        Eq(u.diff(t, 2) + branch(load) * u, 0, evaluate=False),
        Eq(u.diff(t, 2) + (branch(P) + epsilon * P * slope * cos(Omega * t)) * u, 0, evaluate=False),
        "",
        "Taylor's polynomial of s about P, for a curve of the third degree",
        first_order,
    )


def _volume() -> Step:
    M, C, Phi = symbols("M C Phi", commutative=False)
    trace, determinant = Function("tr"), Function("det")
    period = 2 * pi / Omega

    def liouville() -> Any:
        """d det Φ/dt = tr(A) det Φ where dΦ/dt = A Φ, for matrices of letters; tr A = −tr(M⁻¹C) of the state matrix."""
        n = 2
        A = Matrix(n, n, symbols(f"a0:{n * n}"))
        entries = [Function(f"f_{k}")(t) for k in range(n * n)]
        F = Matrix(n, n, entries)
        rates = dict(zip((diff(e, t) for e in entries), A * F, strict=True))
        identity = expand(F.det().diff(t).subs(rates) - A.trace() * F.det())
        c, k = (Matrix(n, n, symbols(f"{letter}0:{n * n}")) for letter in "ck")
        state = Matrix.vstack(Matrix.hstack(Matrix.zeros(n), Matrix.eye(n)), Matrix.hstack(-k, -c))
        return (identity, expand(state.trace() + c.trace()))

    return Step(
        STAGE,
        "Multiply the multipliers",
        "Φ takes the state at the beginning of a period T to that at its end; its eigenvalues are the multipliers, and "
        "motion grows where one is greater than 1 in size. Their product is known beforehand: without damping it is 1, "
        "so that either all lie on the unit circle or one lies outside",
        Eq(Symbol("T"), period),
        Eq(determinant(Phi), exp(-Symbol("T") * trace(M**-1 * C)), evaluate=False),
        "",
        "the derivative of a determinant, for matrices of letters, two by two",
        liouville,
    )


def _edges() -> Step:
    slope = branch(P).diff(P)
    value, rate = symbols("value rate")
    edges = tuple(4 * branch(P) + sign * 2 * epsilon * P * slope for sign in (-1, 1))

    def balanced() -> Any:
        """cos(Ωt/2) and sin(Ωt/2) put in: the mean of what is left times the motion itself vanishes on an edge."""
        left: list[Expr] = []
        for trial, square in ((cos(Omega * t / 2), edges[1]), (sin(Omega * t / 2), edges[0])):
            whole = trial.diff(t, 2) + (value + epsilon * P * rate * cos(Omega * t)) * trial
            # of a polynomial of this degree in cos and sin of Ωt/2, eight instants of two periods have the mean
            mean = sum(((whole * trial).subs(t, 4 * pi / Omega * k / 8) for k in range(8)), start=whole * 0) / 8
            known = square.subs(slope, rate).subs(branch(P), value)
            left.append(expand(mean.subs(Omega, sqrt(known))))
        return tuple(left)

    return Step(
        STAGE,
        "Find the edges of the principal region",
        "on an edge the motion has twice the period of the load; between the edges it grows. The width goes with the "
        "slope of the branch, the same P s' that the rule of vanishing damping asks for",
        Eq(s, branch(P)),
        tuple(Eq(Omega**2, edge, evaluate=False) for edge in edges),
        "",
        "put into the equation, what is left has no part of the period of the motion itself, to first order",
        balanced,
    )
