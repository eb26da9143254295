"""Beck's column with a damper at its tip and no other damping."""

from sympy import Symbol

from freebeam_derive.notation import F_0, P, alpha, beta, t, x, x_F, y
from freebeam_derive.references import TWO_ROUTES
from freebeam_derive.statement import Column, Parameter, Reference, at, delta, integral

c = Symbol("c", real=True)

column = Column(
    name="tip-damper",
    title="Cantilever with a damper at its tip under a follower force",
    family="Masses, springs and dampers",
    T=integral(y.diff(t) ** 2) / 2,
    V=integral(y.diff(x, 2) ** 2) / 2,
    W_c=P * integral(y.diff(x) ** 2) / 2,
    dW_nc=-c * at(y.diff(t), 1) * at(delta(y), 1)
    - integral(beta * y.diff(t) * delta(y) + alpha * y.diff(x, 2, t) * delta(y.diff(x, 2)))
    - P * at(y.diff(x), 1) * at(delta(y), 1)
    + F_0 * at(delta(y), x_F),
    ends=("clamped", "free"),
    parameters=(Parameter(c, "coefficient of the damper", 0.5, 0.0, 5.0),),
    source="Stated for this project; no open paper of it was found",
    references=(Reference("16.0524615771634", "flutter", TWO_ROUTES),),
)
