"""Hauger's column: a cantilever under a follower load that falls linearly to zero at the tip."""

from freebeam_derive.notation import F_0, P, alpha, beta, t, x, x_F, y
from freebeam_derive.references import TWO_ROUTES
from freebeam_derive.statement import Column, Reference, at, delta, integral

column = Column(
    name="hauger",
    title="Cantilever under a triangular follower load",
    family="Distributed follower load",
    T=integral(y.diff(t) ** 2) / 2,
    V=integral(y.diff(x, 2) ** 2) / 2,
    W_c=P * integral((1 - x) ** 2 * y.diff(x) ** 2) / 4,
    dW_nc=-integral(beta * y.diff(t) * delta(y) + alpha * y.diff(x, 2, t) * delta(y.diff(x, 2)))
    - P * integral((1 - x) * y.diff(x) * delta(y))
    + F_0 * at(delta(y), x_F),
    ends=("clamped", "free"),
    source="Stated for this project; no open paper of it was found",
    references=(Reference("150.64159540449", "flutter", TWO_ROUTES),),
)
