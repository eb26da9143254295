"""Reut's column: a cantilever under a tip force that stays on the line of the undeformed axis."""

from freebeam_derive.notation import F_0, P, alpha, beta, t, x, x_F, y
from freebeam_derive.references import TWO_ROUTES
from freebeam_derive.statement import Column, Reference, at, delta, integral

column = Column(
    name="reut",
    title="Cantilever under a force along a fixed line",
    family="Tip force",
    T=integral(y.diff(t) ** 2) / 2,
    V=integral(y.diff(x, 2) ** 2) / 2,
    W_c=P * integral(y.diff(x) ** 2) / 2,
    dW_nc=-integral(beta * y.diff(t) * delta(y) + alpha * y.diff(x, 2, t) * delta(y.diff(x, 2)))
    - P * at(y, 1) * at(delta(y.diff(x)), 1)
    + F_0 * at(delta(y), x_F),
    ends=("clamped", "free"),
    source="The loading of Bigoni and Misseroni, Structures loaded with a force acting along a fixed "
    "straight line, or the Reut's column problem, arXiv:2002.04432, on Beck's beam",
    references=(Reference("20.050953618974", "flutter", TWO_ROUTES),),
)
