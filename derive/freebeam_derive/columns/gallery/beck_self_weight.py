"""Beck's column standing upright: its own weight acts besides the follower force."""

from sympy import Symbol

from freebeam_derive.notation import F_0, P, alpha, beta, t, x, x_F, y
from freebeam_derive.references import TWO_ROUTES
from freebeam_derive.statement import Column, Parameter, Reference, at, delta, integral

g = Symbol("g", real=True)

column = Column(
    name="beck-self-weight",
    title="Upright cantilever under its own weight and a follower force",
    family="Tip force",
    T=integral(y.diff(t) ** 2) / 2,
    V=integral(y.diff(x, 2) ** 2) / 2 - g * integral((1 - x) * y.diff(x) ** 2) / 2,
    W_c=P * integral(y.diff(x) ** 2) / 2,
    dW_nc=-integral(beta * y.diff(t) * delta(y) + alpha * y.diff(x, 2, t) * delta(y.diff(x, 2)))
    - P * at(y.diff(x), 1) * at(delta(y), 1)
    + F_0 * at(delta(y), x_F),
    ends=("clamped", "free"),
    parameters=(Parameter(g, "weight of the whole beam; negative where it hangs", 3.0, -20.0, 7.5),),
    source="Stated for this project; no open paper of it was found",
    references=(Reference("19.0417033100", "flutter", TWO_ROUTES),),
)
