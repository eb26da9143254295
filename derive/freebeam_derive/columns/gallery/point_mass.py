"""Beck's column with a mass at any place."""

from sympy import Symbol

from freebeam_derive.notation import F_0, P, alpha, beta, t, x, x_F, y
from freebeam_derive.references import TWO_ROUTES
from freebeam_derive.statement import Column, Parameter, Reference, at, delta, integral

mu, a = (Symbol(name, real=True) for name in ("mu", "a"))

column = Column(
    name="point-mass",
    title="Cantilever with a point mass along it under a follower force",
    family="Masses, springs and dampers",
    T=integral(y.diff(t) ** 2) / 2 + mu * at(y.diff(t), a) ** 2 / 2,
    V=integral(y.diff(x, 2) ** 2) / 2,
    W_c=P * integral(y.diff(x) ** 2) / 2,
    dW_nc=-integral(beta * y.diff(t) * delta(y) + alpha * y.diff(x, 2, t) * delta(y.diff(x, 2)))
    - P * at(y.diff(x), 1) * at(delta(y), 1)
    + F_0 * at(delta(y), x_F),
    ends=("clamped", "free"),
    parameters=(
        Parameter(mu, "mass in units of the beam's", 0.5, 0.0, 5.0, r"\mu"),
        Parameter(a, "place of the mass", 0.5, 0.05, 0.95),
    ),
    source="Sugiyama et al., Effect of concentrated mass on stability of cantilevers under rocket thrust, "
    "AIAA Journal 33 (1995) 499-503",
    references=(Reference("22.8770428843", "flutter", TWO_ROUTES),),
)
