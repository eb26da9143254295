"""Beck's column with a transversal tip force that a slope sensor inside sets, in proportion to the load."""

from sympy import Symbol

from freebeam_derive.notation import F_0, P, alpha, beta, t, x, x_F, y
from freebeam_derive.references import TWO_ROUTES
from freebeam_derive.statement import Column, Parameter, Reference, at, delta, integral

k, a = (Symbol(name, real=True) for name in ("k", "a"))

column = Column(
    name="feedback",
    title="Cantilever under a follower force and a tip force by a remote slope",
    family="Free in space, with control",
    T=integral(y.diff(t) ** 2) / 2,
    V=integral(y.diff(x, 2) ** 2) / 2,
    W_c=P * integral(y.diff(x) ** 2) / 2,
    dW_nc=-integral(beta * y.diff(t) * delta(y) + alpha * y.diff(x, 2, t) * delta(y.diff(x, 2)))
    - P * at(y.diff(x), 1) * at(delta(y), 1)
    - k * P * at(y.diff(x), a) * at(delta(y), 1)
    + F_0 * at(delta(y), x_F),
    ends=("clamped", "free"),
    parameters=(
        Parameter(k, "gain: tip force by slope at the sensor and load", 0.2, -0.5, 0.5),
        Parameter(a, "place of the sensor", 0.4, 0.05, 0.95),
    ),
    # seen on 27 November 2026 at distantreader.org, jtam-4602
    source="Bogacz and Frischmuth, On problems with solution-dependent load, Journal of Theoretical and Applied "
    "Mechanics 56 (2018) 435-446, is about forces that hang on the solution; the law as this project "
    "states it",
    references=(Reference("14.895892307888", "flutter", TWO_ROUTES, alpha=0.01, beta=0.1),),
)
