"""Beck's column on Winkler's elastic foundation, which does not change its undamped load."""

from sympy import Symbol

from freebeam_derive.notation import F_0, P, alpha, beta, t, x, x_F, y
from freebeam_derive.references import TWO_ROUTES
from freebeam_derive.statement import Column, Parameter, Reference, at, delta, integral

k = Symbol("k", real=True)

column = Column(
    name="foundation",
    title="Cantilever on an elastic foundation under a follower force",
    family="Masses, springs and dampers",
    T=integral(y.diff(t) ** 2) / 2,
    V=integral(y.diff(x, 2) ** 2) / 2 + k * integral(y**2) / 2,
    W_c=P * integral(y.diff(x) ** 2) / 2,
    dW_nc=-integral(beta * y.diff(t) * delta(y) + alpha * y.diff(x, 2, t) * delta(y.diff(x, 2)))
    - P * at(y.diff(x), 1) * at(delta(y), 1)
    + F_0 * at(delta(y), x_F),
    ends=("clamped", "free"),
    parameters=(Parameter(k, "stiffness of the foundation", 100.0, 0.0, 500.0),),
    source="The column of Herrmann and Smith's paradox, as Nano and viscoelastic Beck's column on elastic "
    "foundation, arXiv:1408.2686, tells it",
    references=(
        Reference(
            "20.050953618974",
            "flutter",
            "computed: Beck's load, since the foundation adds k to each squared frequency, at any load",
        ),
        Reference("13.0572701169", "flutter", TWO_ROUTES, alpha=0.01, beta=0.1),
    ),
)
