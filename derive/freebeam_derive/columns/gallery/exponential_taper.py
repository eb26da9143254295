"""Beck's column with a stiffness that falls exponentially."""

from sympy import Symbol, exp

from freebeam_derive.notation import F_0, P, alpha, beta, t, x, x_F, y
from freebeam_derive.references import TWO_ROUTES
from freebeam_derive.statement import Column, Parameter, Reference, at, delta, integral

tau = Symbol("tau", real=True)

column = Column(
    name="exponential-taper",
    title="Cantilever of exponentially falling stiffness under a follower force",
    family="Variable section",
    T=integral(y.diff(t) ** 2) / 2,
    V=integral(exp(-tau * x) * y.diff(x, 2) ** 2) / 2,
    W_c=P * integral(y.diff(x) ** 2) / 2,
    dW_nc=-integral(beta * y.diff(t) * delta(y) + alpha * exp(-tau * x) * y.diff(x, 2, t) * delta(y.diff(x, 2)))
    - P * at(y.diff(x), 1) * at(delta(y), 1)
    + F_0 * at(delta(y), x_F),
    ends=("clamped", "free"),
    parameters=(Parameter(tau, "rate at which the stiffness falls", 1.0, 0.0, 3.0, r"\tau"),),
    source="Stated for this project; no open paper of it was found",
    references=(Reference("12.237286729359", "flutter", TWO_ROUTES),),
)
