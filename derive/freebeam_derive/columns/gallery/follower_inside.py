"""A cantilever under a follower force at a place inside; beyond it the beam is free of load."""

from sympy import Symbol

from freebeam_derive.notation import F_0, P, alpha, beta, t, x, x_F, y
from freebeam_derive.references import TWO_ROUTES
from freebeam_derive.statement import Column, Parameter, Reference, at, delta, integral

a = Symbol("a", real=True)

column = Column(
    name="follower-inside",
    title="Cantilever under a follower force at a place along it",
    family="Distributed follower load",
    T=integral(y.diff(t) ** 2) / 2,
    V=integral(y.diff(x, 2) ** 2) / 2,
    W_c=P * integral(y.diff(x) ** 2, 0, a) / 2,
    dW_nc=-integral(beta * y.diff(t) * delta(y) + alpha * y.diff(x, 2, t) * delta(y.diff(x, 2)))
    - P * at(y.diff(x), a) * at(delta(y), a)
    + F_0 * at(delta(y), x_F),
    ends=("clamped", "free"),
    parameters=(Parameter(a, "place of the force", 0.7, 0.2, 0.98),),
    source="Stated for this project; no open paper of it was found",
    references=(Reference("21.433028408332", "flutter", TWO_ROUTES),),
)
