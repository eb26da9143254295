"""Beck's column with a mass on a spring and a damper at a place of its own."""

from sympy import Symbol

from freebeam_derive.notation import F_0, P, alpha, beta, t, x, x_F, y
from freebeam_derive.references import TWO_ROUTES
from freebeam_derive.statement import Column, Coordinate, Parameter, Reference, at, delta, integral

mu, k, c, a = (Symbol(name, real=True) for name in ("mu", "k", "c", "a"))
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
    source="Stated for this project; no open paper of it was found",
    references=(Reference("17.512540396912", "flutter", TWO_ROUTES, alpha=0.01, beta=0.1),),
)
