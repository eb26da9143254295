"""Leipholz's column: a cantilever under a uniformly distributed follower load, P in all."""

from freebeam_derive.notation import F_0, P, alpha, beta, t, x, x_F, y
from freebeam_derive.references import TWO_ROUTES
from freebeam_derive.statement import Column, Reference, at, delta, integral

column = Column(
    name="leipholz",
    title="Cantilever under a uniformly distributed follower load",
    family="Distributed follower load",
    T=integral(y.diff(t) ** 2) / 2,
    V=integral(y.diff(x, 2) ** 2) / 2,
    W_c=P * integral((1 - x) * y.diff(x) ** 2) / 2,
    dW_nc=-integral(beta * y.diff(t) * delta(y) + alpha * y.diff(x, 2, t) * delta(y.diff(x, 2)))
    - P * integral(y.diff(x) * delta(y))
    + F_0 * at(delta(y), x_F),
    ends=("clamped", "free"),
    source="Leipholz, Die Knicklast des einseitig eingespannten Stabes mit gleichmässig verteilter, "
    "tangentialer Längsbelastung, ZAMP 13 (1962) 581-589",
    references=(Reference("40.053736514940", "flutter", TWO_ROUTES),),
)
