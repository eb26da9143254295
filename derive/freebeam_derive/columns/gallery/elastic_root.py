"""Beck's column on a root that turns on a spring."""

from sympy import Symbol

from freebeam_derive.notation import F_0, P, alpha, beta, t, x, x_F, y
from freebeam_derive.references import TWO_ROUTES
from freebeam_derive.statement import Column, Parameter, Reference, at, delta, integral

c = Symbol("c", real=True)

column = Column(
    name="elastic-root",
    title="Cantilever on an elastic root under a follower force",
    family="Masses, springs and dampers",
    T=integral(y.diff(t) ** 2) / 2,
    V=integral(y.diff(x, 2) ** 2) / 2 + c * at(y.diff(x), 0) ** 2 / 2,
    W_c=P * integral(y.diff(x) ** 2) / 2,
    dW_nc=-integral(beta * y.diff(t) * delta(y) + alpha * y.diff(x, 2, t) * delta(y.diff(x, 2)))
    - P * at(y.diff(x), 1) * at(delta(y), 1)
    + F_0 * at(delta(y), x_F),
    ends=("pinned", "free"),
    parameters=(Parameter(c, "stiffness of the root's rotational spring", 5.0, 0.1, 100.0),),
    # seen on 27 November 2026 at arxiv.org/abs/1812.09164
    source="Batista, Large deflections and stability of spring-hinged cantilever beam, arXiv:1812.09164, has its "
    "equilibria; as stated for this project",
    references=(Reference("16.6761695961", "flutter", TWO_ROUTES),),
)
