"""A simply supported panel in a supersonic flow, by piston theory without damping: the load is the dynamic pressure."""

from freebeam_derive.notation import P, t, x, y
from freebeam_derive.statement import Column, delta, integral

column = Column(
    name="panel",
    title="Simply supported panel in a supersonic flow",
    T=integral(y.diff(t) ** 2) / 2,
    V=integral(y.diff(x, 2) ** 2) / 2,
    W_c=0,
    dW_nc=-P * integral(y.diff(x) * delta(y)),
    ends=("pinned", "pinned"),
)
