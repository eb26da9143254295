"""Beck's column held by a spring at its tip: flutter, or divergence where the spring is stiff."""

from sympy import Symbol

from freebeam_derive.notation import F_0, P, alpha, beta, t, x, x_F, y
from freebeam_derive.references import TWO_ROUTES
from freebeam_derive.statement import Column, Parameter, Reference, at, delta, integral

k = Symbol("k", real=True)

column = Column(
    name="tip-spring",
    title="Cantilever with a spring at its tip under a follower force",
    family="Masses, springs and dampers",
    T=integral(y.diff(t) ** 2) / 2,
    V=integral(y.diff(x, 2) ** 2) / 2 + k * at(y, 1) ** 2 / 2,
    W_c=P * integral(y.diff(x) ** 2) / 2,
    dW_nc=-integral(beta * y.diff(t) * delta(y) + alpha * y.diff(x, 2, t) * delta(y.diff(x, 2)))
    - P * at(y.diff(x), 1) * at(delta(y), 1)
    + F_0 * at(delta(y), x_F),
    ends=("clamped", "free"),
    parameters=(Parameter(k, "stiffness of the spring", 10.0, 0.0, 60.0),),
    source="As in Stability analysis of Beck's column with a tip mass restrained by a spring, without the mass",
    references=(
        Reference("24.2240402684", "flutter", TWO_ROUTES),
        Reference("32.0547602231", "divergence", TWO_ROUTES, own={"k": 35.0}),
    ),
)
