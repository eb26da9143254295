"""Hauger's column: a cantilever under a follower load that falls linearly to zero at the tip; undamped."""

from freebeam_derive.notation import P, t, x, y
from freebeam_derive.statement import Column, delta, integral

column = Column(
    name="hauger",
    title="Cantilever under a triangular follower load",
    T=integral(y.diff(t) ** 2) / 2,
    V=integral(y.diff(x, 2) ** 2) / 2,
    W_c=P * integral((1 - x) ** 2 * y.diff(x) ** 2) / 4,
    dW_nc=-P * integral((1 - x) * y.diff(x) * delta(y)),
    ends=("clamped", "free"),
)
