"""A clamped-pinned column on an elastic foundation under a dead axial load, with numbers as a user may type them."""

from sympy import Symbol

from freebeam_derive.notation import F_0, P, alpha, beta, t, x, x_F, y
from freebeam_derive.statement import Column, Parameter, at, delta, integral

k_w = Symbol("k_w", real=True)

column = Column(
    name="foundation",
    title="Clamped-pinned column on an elastic foundation",
    T=0.5 * integral(y.diff(t) ** 2),
    V=0.5 * integral(y.diff(x, 2) ** 2 + k_w * y**2),
    W_c=0.5 * P * integral(y.diff(x) ** 2),
    dW_nc=-integral(beta * y.diff(t) * delta(y) + alpha * y.diff(x, 2, t) * delta(y.diff(x, 2)))
    + F_0 * at(delta(y), x_F),
    ends=("clamped", "pinned"),
    parameters=(Parameter(k_w, "stiffness of the foundation", 100.0, 0.0, 5000.0, "k_w"),),
)
