"""Beck's column as a wedge: its depth falls linearly, EI with the cube of it."""

from sympy import Symbol

from freebeam_derive.notation import F_0, P, alpha, beta, t, x, x_F, y
from freebeam_derive.references import TWO_ROUTES
from freebeam_derive.statement import Column, Parameter, Reference, at, delta, integral

tau = Symbol("tau", real=True)

column = Column(
    name="wedge",
    title="Wedge-shaped cantilever of constant width under a follower force",
    family="Variable section",
    T=integral((1 - tau * x) * y.diff(t) ** 2) / 2,
    V=integral((1 - tau * x) ** 3 * y.diff(x, 2) ** 2) / 2,
    W_c=P * integral(y.diff(x) ** 2) / 2,
    dW_nc=-integral(beta * y.diff(t) * delta(y))
    - integral(alpha * (1 - tau * x) ** 3 * y.diff(x, 2, t) * delta(y.diff(x, 2)))
    - P * at(y.diff(x), 1) * at(delta(y), 1)
    + F_0 * at(delta(y), x_F),
    ends=("clamped", "free"),
    parameters=(Parameter(tau, "what the depth loses up to the tip, as a share", 0.5, 0.0, 0.9, r"\tau"),),
    # seen on 27 November 2026 at koreascience.or.kr/article/JAKO200622219574371.page
    source="Critical Loads of Tapered Beck's Columns with Clamped and Spring Supports (2006), with linearly "
    "tapered rectangular sections; as stated for this project",
    references=(Reference("8.4207877434", "flutter", TWO_ROUTES),),
)
