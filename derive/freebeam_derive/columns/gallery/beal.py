"""Beal's missile: a free-free beam whose thrust is turned by what a slope sensor sees."""

from sympy import Symbol

from freebeam_derive.notation import F_0, P, t, x, x_F, y
from freebeam_derive.references import TWO_ROUTES
from freebeam_derive.statement import Column, Parameter, Reference, at, delta, integral

k, a = (Symbol(name, real=True) for name in ("k", "a"))

column = Column(
    name="beal",
    title="Free-free beam under an end thrust that a sensor of the slope directs",
    family="Free in space, with control",
    T=integral(y.diff(t) ** 2) / 2,
    V=integral(y.diff(x, 2) ** 2) / 2,
    W_c=P * integral(x * y.diff(x) ** 2) / 2,
    dW_nc=-P * (at(y.diff(x), 1) + k * at(y.diff(x), a)) * at(delta(y), 1) + F_0 * at(delta(y), x_F),
    ends=("free", "free"),
    parameters=(
        Parameter(k, "gain: angle of the thrust by slope at the sensor", 0.1, 0.02, 0.5),
        Parameter(a, "place of the sensor", 0.5, 0.05, 0.95),
    ),
    source="Beal (1965), whom the paper of the column free-free cites; the law as this project states it",
    references=(
        Reference("25.6381813768019637", "divergence", TWO_ROUTES),
        Reference("25.6381813768019637", "divergence", TWO_ROUTES, own={"a": 0.25}),
    ),
)
