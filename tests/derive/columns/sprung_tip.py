"""Beck's column with a mass on a spring at the tip, damped in proportion: mass and stiffness matrices that are full."""

from sympy import Symbol

from freebeam_derive.notation import P, alpha, t, x, y
from freebeam_derive.statement import Column, Parameter, at, delta, integral

mu, k = Symbol("mu", real=True), Symbol("k", real=True)

column = Column(
    name="sprung-tip",
    title="Cantilever with a mass on a spring at its tip under a follower force",
    T=integral(y.diff(t) ** 2) / 2 + mu * at(y.diff(t), 1) ** 2 / 2,
    V=integral(y.diff(x, 2) ** 2) / 2 + k * at(y, 1) ** 2 / 2,
    W_c=P * integral(y.diff(x) ** 2) / 2,
    dW_nc=-alpha * integral(y.diff(x, 2, t) * delta(y.diff(x, 2)))
    - alpha * k * at(y.diff(t), 1) * at(delta(y), 1)
    - P * at(y.diff(x), 1) * at(delta(y), 1),
    ends=("clamped", "free"),
    parameters=(
        Parameter(mu, "tip mass in units of the beam's", 0.5, 0.0, 10.0, r"\mu"),
        Parameter(k, "stiffness of the spring, in units of the bending stiffness by the length cubed", 2.0, 0.0, 50.0),
    ),
)
