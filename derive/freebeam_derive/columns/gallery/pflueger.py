"""Pflüger's column: Beck's with a mass at its tip, which may have a rotary inertia."""

from sympy import Symbol

from freebeam_derive.notation import EI, F_0, C_alpha, C_beta, L, P, alpha, beta, m, t, x, x_F, y
from freebeam_derive.references import TWO_ROUTES
from freebeam_derive.statement import Column, Energies, Parameter, Reference, at, delta, integral

mu, J = (Symbol(name, real=True) for name in ("mu", "J"))
m_tip, J_tip = (Symbol(name, real=True) for name in ("m_tip", "J_tip"))

column = Column(
    name="pflueger",
    title="Cantilever with a tip mass under a follower force",
    family="Masses, springs and dampers",
    T=integral(y.diff(t) ** 2) / 2 + mu * at(y.diff(t), 1) ** 2 / 2 + J * at(y.diff(x, t), 1) ** 2 / 2,
    V=integral(y.diff(x, 2) ** 2) / 2,
    W_c=P * integral(y.diff(x) ** 2) / 2,
    dW_nc=-integral(beta * y.diff(t) * delta(y) + alpha * y.diff(x, 2, t) * delta(y.diff(x, 2)))
    - P * at(y.diff(x), 1) * at(delta(y), 1)
    + F_0 * at(delta(y), x_F),
    ends=("clamped", "free"),
    parameters=(
        Parameter(mu, "tip mass in units of the beam's", 1.0, 0.0, 5.0, r"\mu"),
        Parameter(J, "rotary inertia of the tip mass", 0.0, 0.0, 0.2),
    ),
    dimensional=Energies(
        T=m * integral(y.diff(t) ** 2, L) / 2
        + m_tip * at(y.diff(t), L) ** 2 / 2
        + J_tip * at(y.diff(x, t), L) ** 2 / 2,
        V=EI * integral(y.diff(x, 2) ** 2, L) / 2,
        W_c=P * integral(y.diff(x) ** 2, L) / 2,
        dW_nc=-integral(C_beta * y.diff(t) * delta(y) + C_alpha * EI * y.diff(x, 2, t) * delta(y.diff(x, 2)), L)
        - P * at(y.diff(x), L) * at(delta(y), L)
        + F_0 * at(delta(y), x_F),
        length=L,
        scaling={m_tip: mu * m * L, J_tip: J * m * L**3},
    ),
    source="Bigoni et al., Flutter and divergence instability in the Pflüger column, arXiv:1804.07378; "
    "rotary inertia: Andersen and Thomsen, Int. J. Non-Linear Mechanics 37 (2002) 135-151",
    references=(
        Reference("16.2121289425", "flutter", TWO_ROUTES),
        Reference("16.1235358663", "flutter", TWO_ROUTES, beta=0.5),
        Reference("8.8696660652", "flutter", TWO_ROUTES, own={"J": 0.1}),
    ),
)
