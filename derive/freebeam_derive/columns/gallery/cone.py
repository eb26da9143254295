"""Beck's column as a cone: EI falls with the fourth power of the diameter, the mass with its square."""

from sympy import Symbol

from freebeam_derive.notation import F_0, P, alpha, beta, t, x, x_F, y
from freebeam_derive.references import TWO_ROUTES
from freebeam_derive.statement import Column, Parameter, Reference, at, delta, integral

tau = Symbol("tau", real=True)

column = Column(
    name="cone",
    title="Conical cantilever under a follower force",
    family="Variable section",
    T=integral((1 - tau * x) ** 2 * y.diff(t) ** 2) / 2,
    V=integral((1 - tau * x) ** 4 * y.diff(x, 2) ** 2) / 2,
    W_c=P * integral(y.diff(x) ** 2) / 2,
    dW_nc=-integral(beta * y.diff(t) * delta(y))
    - integral(alpha * (1 - tau * x) ** 4 * y.diff(x, 2, t) * delta(y.diff(x, 2)))
    - P * at(y.diff(x), 1) * at(delta(y), 1)
    + F_0 * at(delta(y), x_F),
    ends=("clamped", "free"),
    parameters=(Parameter(tau, "what the diameter loses up to the tip, as a share", 0.5, 0.0, 0.8, r"\tau"),),
    source="Stated for this project; no open paper of it was found",
    references=(Reference("6.50560305109434", "flutter", TWO_ROUTES),),
)
