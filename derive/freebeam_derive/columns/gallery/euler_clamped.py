"""Euler's column: clamped-clamped beam under a dead axial load."""

from freebeam_derive.notation import F_0, P, alpha, beta, t, x, x_F, y
from freebeam_derive.references import TWO_ROUTES
from freebeam_derive.statement import Column, Reference, at, delta, integral

column = Column(
    name="euler-clamped",
    title="Clamped-clamped beam under a dead axial load",
    family="Dead loads",
    T=integral(y.diff(t) ** 2) / 2,
    V=integral(y.diff(x, 2) ** 2) / 2,
    W_c=P * integral(y.diff(x) ** 2) / 2,
    dW_nc=-integral(beta * y.diff(t) * delta(y) + alpha * y.diff(x, 2, t) * delta(y.diff(x, 2)))
    + F_0 * at(delta(y), x_F),
    ends=("clamped", "clamped"),
    source="Euler, Methodus inveniendi lineas curvas, Additamentum I (1744)",
    references=(Reference("39.4784176044", "divergence", TWO_ROUTES),),
)
