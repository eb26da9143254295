"""A free-free beam with a point mass at its front, driven by a follower force at its rear."""

from sympy import Symbol

from freebeam_derive.notation import F_0, P, t, x, x_F, y
from freebeam_derive.references import TWO_ROUTES
from freebeam_derive.statement import Column, Parameter, Reference, at, delta, integral

mu = Symbol("mu", real=True)

column = Column(
    name="free-free-mass",
    title="Free-free beam with a point mass under an end follower force",
    family="Free in space, with control",
    T=integral(y.diff(t) ** 2) / 2 + mu * at(y.diff(t), 0) ** 2 / 2,
    V=integral(y.diff(x, 2) ** 2) / 2,
    W_c=P * integral((x + mu) / (1 + mu) * y.diff(x) ** 2) / 2,
    dW_nc=-P * at(y.diff(x), 1) * at(delta(y), 1) + F_0 * at(delta(y), x_F),
    ends=("free", "free"),
    parameters=(Parameter(mu, "mass in units of the beam's", 0.5, 0.0, 2.0, r"\mu"),),
    source="Park and Mote, The maximum controlled follower force on a free-free beam carrying a concentrated"
    " mass, J. Sound and Vibration 98 (1985) 247-256, without the control",
    references=(Reference("45.4509031990150885", "divergence", TWO_ROUTES),),
)
