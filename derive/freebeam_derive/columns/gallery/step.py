"""Beck's column in two parts of other section, with a point mass where they meet."""

from sympy import Piecewise, Symbol

from freebeam_derive.notation import F_0, P, alpha, beta, t, x, x_F, y
from freebeam_derive.references import TWO_ROUTES
from freebeam_derive.statement import Column, Parameter, Reference, at, delta, integral

s, r, mu, a = (Symbol(name, real=True) for name in ("s", "r", "mu", "a"))

column = Column(
    name="step",
    title="Stepped cantilever under a follower force",
    family="Variable section",
    T=integral(Piecewise((1, x < a), (r, True)) * y.diff(t) ** 2) / 2 + mu * at(y.diff(t), a) ** 2 / 2,
    V=integral(Piecewise((1, x < a), (s, True)) * y.diff(x, 2) ** 2) / 2,
    W_c=P * integral(y.diff(x) ** 2) / 2,
    dW_nc=-integral(beta * y.diff(t) * delta(y) + alpha * y.diff(x, 2, t) * delta(y.diff(x, 2)))
    - P * at(y.diff(x), 1) * at(delta(y), 1)
    + F_0 * at(delta(y), x_F),
    ends=("clamped", "free"),
    parameters=(
        Parameter(s, "bending stiffness of the outer part, as a share of the inner one's", 0.5, 0.1, 2.0),
        Parameter(r, "mass per length of the outer part, as a share", 1.0, 0.1, 2.0),
        Parameter(mu, "mass where they meet", 0.0, 0.0, 2.0, r"\mu"),
        Parameter(a, "where they meet", 0.5, 0.1, 0.9),
    ),
    source="Stated for this project; no open paper of it was found",
    references=(
        Reference("12.7155928090377", "flutter", TWO_ROUTES),
        Reference("25.919950122601", "flutter", TWO_ROUTES, own={"a": 0.6, "r": 0.5, "mu": 0.3}),
    ),
)
