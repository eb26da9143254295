"""Beck's column with a crack: a rotational spring inside the beam."""

from sympy import Symbol

from freebeam_derive.notation import F_0, P, alpha, beta, t, x, x_F, y
from freebeam_derive.references import TWO_ROUTES
from freebeam_derive.statement import Column, Parameter, Reference, at, delta, integral, jump

k, a = (Symbol(name, real=True) for name in ("k", "a"))

column = Column(
    name="crack",
    title="Cracked cantilever under a follower force",
    family="Joints",
    T=integral(y.diff(t) ** 2) / 2,
    V=integral(y.diff(x, 2) ** 2) / 2 + k * jump(y.diff(x), a) ** 2 / 2,
    W_c=P * integral(y.diff(x) ** 2) / 2,
    dW_nc=-integral(beta * y.diff(t) * delta(y) + alpha * y.diff(x, 2, t) * delta(y.diff(x, 2)))
    - P * at(y.diff(x), 1) * at(delta(y), 1)
    + F_0 * at(delta(y), x_F),
    ends=("clamped", "free"),
    parameters=(
        Parameter(k, "stiffness of the crack", 10.0, 0.5, 100.0),
        Parameter(a, "its place", 0.4, 0.05, 0.95),
    ),
    # seen on 27 November 2026 at extrica.com/article/18982
    source="Sokół, An influence of the parameters of the loading heads on stability and free vibrations of a "
    "damaged column subjected to a specific load (2018), has a crack as a rotational spring, under "
    "another load; as stated for this project",
    references=(
        Reference("16.994377060550", "flutter", TWO_ROUTES),
        Reference("8.6850375767349", "flutter", TWO_ROUTES, own={"k": 2.0, "a": 0.5}),
    ),
)
