"""Beck's column with a mass at the tip: a mass matrix that is full."""

from sympy import Symbol

from freebeam_derive.notation import P, alpha, t, x, y
from freebeam_derive.statement import Column, Parameter, at, delta, integral

mu = Symbol("mu", real=True)

column = Column(
    name="tip-mass",
    title="Cantilever with a tip mass under a follower force",
    T=integral(y.diff(t) ** 2) / 2 + mu * at(y.diff(t), 1) ** 2 / 2,
    V=integral(y.diff(x, 2) ** 2) / 2,
    W_c=P * integral(y.diff(x) ** 2) / 2,
    dW_nc=-alpha * integral(y.diff(x, 2, t) * delta(y.diff(x, 2))) - P * at(y.diff(x), 1) * at(delta(y), 1),
    ends=("clamped", "free"),
    parameters=(Parameter(mu, "tip mass in units of the beam's", 0.5, 0.0, 10.0, r"\mu"),),
)
