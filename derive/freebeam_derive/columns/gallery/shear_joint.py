"""Beck's column with a joint inside that yields to shear."""

from sympy import Symbol

from freebeam_derive.notation import F_0, P, alpha, beta, t, x, x_F, y
from freebeam_derive.references import TWO_ROUTES
from freebeam_derive.statement import Column, Parameter, Reference, at, delta, integral, jump

k, a = (Symbol(name, real=True) for name in ("k", "a"))

column = Column(
    name="shear-joint",
    title="Cantilever with a shear joint under a follower force",
    family="Joints",
    T=integral(y.diff(t) ** 2) / 2,
    V=integral(y.diff(x, 2) ** 2) / 2 + k * jump(y, a) ** 2 / 2,
    W_c=P * integral(y.diff(x) ** 2) / 2,
    dW_nc=-integral(beta * y.diff(t) * delta(y) + alpha * y.diff(x, 2, t) * delta(y.diff(x, 2)))
    - P * at(y.diff(x), 1) * at(delta(y), 1)
    + F_0 * at(delta(y), x_F),
    ends=("clamped", "free"),
    parameters=(
        Parameter(k, "stiffness of the joint", 50.0, 5.0, 500.0),
        Parameter(a, "its place", 0.5, 0.05, 0.95),
    ),
    source="Rotational and shear joints: Mladenov and Sugiyama, Stability of a jointed free-free beam under "
    "end rocket thrust, J. Sound and Vibration 199 (1997) 1-15",
    references=(Reference("15.255492277668", "flutter", TWO_ROUTES),),
)
