"""Beck's column in a viscous medium that surrounds its outer part alone."""

from sympy import Symbol

from freebeam_derive.notation import F_0, P, alpha, beta, t, x, x_F, y
from freebeam_derive.references import TWO_ROUTES
from freebeam_derive.statement import Column, Parameter, Reference, at, delta, integral

c, a = (Symbol(name, real=True) for name in ("c", "a"))

column = Column(
    name="partial-damping",
    title="Cantilever with external damping of its outer part under a follower force",
    family="Masses, springs and dampers",
    T=integral(y.diff(t) ** 2) / 2,
    V=integral(y.diff(x, 2) ** 2) / 2,
    W_c=P * integral(y.diff(x) ** 2) / 2,
    dW_nc=-c * integral(y.diff(t) * delta(y), a, 1)
    - integral(beta * y.diff(t) * delta(y) + alpha * y.diff(x, 2, t) * delta(y.diff(x, 2)))
    - P * at(y.diff(x), 1) * at(delta(y), 1)
    + F_0 * at(delta(y), x_F),
    ends=("clamped", "free"),
    parameters=(
        Parameter(c, "damping of the outer part", 1.0, 0.0, 5.0),
        Parameter(a, "where it begins", 0.5, 0.05, 0.95),
    ),
    # seen on 27 November 2026 at paperexplained.cn, 6febb04be2719338ca4fe1aa75df6378b00c5003
    source="The effect of external damping on the stability of Beck's column, of damping along the whole; of its "
    "outer part as stated for this project",
    references=(Reference("20.067842660665", "flutter", TWO_ROUTES),),
)
