"""Beck's column with a mass on a spring and a damper at a place of its own."""

from sympy import Symbol, sqrt

from freebeam_derive.notation import EI, F_0, C_alpha, C_beta, L, P, alpha, beta, m, t, x, x_F, y
from freebeam_derive.references import TWO_ROUTES
from freebeam_derive.statement import Column, Coordinate, Energies, Parameter, Reference, at, delta, integral

mu, k, c, a = (Symbol(name, real=True) for name in ("mu", "k", "c", "a"))
m_q, k_q, c_q, a_q = (Symbol(name, real=True) for name in ("m_q", "k_q", "c_q", "a_q"))
q = Coordinate("q")  # the absorber

column = Column(
    name="absorber",
    title="Cantilever with an absorber under a follower force",
    family="Masses, springs and dampers",
    T=integral(y.diff(t) ** 2) / 2 + mu * q.diff(t) ** 2 / 2,
    V=integral(y.diff(x, 2) ** 2) / 2 + k * (at(y, a) - q) ** 2 / 2,
    W_c=P * integral(y.diff(x) ** 2) / 2,
    dW_nc=-c * (at(y.diff(t), a) - q.diff(t)) * delta(at(y, a) - q)
    - integral(beta * y.diff(t) * delta(y) + alpha * y.diff(x, 2, t) * delta(y.diff(x, 2)))
    - P * at(y.diff(x), 1) * at(delta(y), 1)
    + F_0 * at(delta(y), x_F),
    ends=("clamped", "free"),
    parameters=(
        Parameter(mu, "mass of the absorber in units of the beam's", 0.1, 0.01, 1.0, r"\mu"),
        Parameter(k, "stiffness of its spring", 5.0, 0.5, 50.0),
        Parameter(c, "coefficient of its damper", 0.1, 0.0, 1.0),
        Parameter(a, "its place", 0.7, 0.05, 0.95),
    ),
    dimensional=Energies(
        T=m * integral(y.diff(t) ** 2, L) / 2 + m_q * q.diff(t) ** 2 / 2,
        V=EI * integral(y.diff(x, 2) ** 2, L) / 2 + k_q * (at(y, a_q) - q) ** 2 / 2,
        W_c=P * integral(y.diff(x) ** 2, L) / 2,
        dW_nc=-c_q * (at(y.diff(t), a_q) - q.diff(t)) * delta(at(y, a_q) - q)
        - integral(C_beta * y.diff(t) * delta(y) + C_alpha * EI * y.diff(x, 2, t) * delta(y.diff(x, 2)), L)
        - P * at(y.diff(x), L) * at(delta(y), L)
        + F_0 * at(delta(y), x_F),
        length=L,
        scaling={q: L * q, m_q: mu * m * L, k_q: k * EI / L**3, c_q: c * sqrt(EI * m) / L, a_q: a * L},
    ),
    source="Stated for this project; no open paper of it was found",
    references=(Reference("17.512540396912", "flutter", TWO_ROUTES, alpha=0.01, beta=0.1),),
)
