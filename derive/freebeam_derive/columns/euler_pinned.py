"""Euler's column: pinned at both ends under a dead axial load."""

from freebeam_derive.notation import EI, F_0, C_alpha, C_beta, L, P, alpha, beta, m, t, x, x_F, y
from freebeam_derive.references import TWO_ROUTES
from freebeam_derive.statement import Column, Energies, Reference, at, delta, integral

column = Column(
    name="euler-pinned",
    title="Pinned-pinned beam under a dead axial load",
    family="Dead loads",
    T=integral(y.diff(t) ** 2) / 2,
    V=integral(y.diff(x, 2) ** 2) / 2,
    W_c=P * integral(y.diff(x) ** 2) / 2,
    dW_nc=-integral(beta * y.diff(t) * delta(y) + alpha * y.diff(x, 2, t) * delta(y.diff(x, 2)))
    + F_0 * at(delta(y), x_F),
    ends=("pinned", "pinned"),
    dimensional=Energies(
        T=integral(m * y.diff(t) ** 2, L) / 2,
        V=integral(EI * y.diff(x, 2) ** 2, L) / 2,
        W_c=integral(P * y.diff(x) ** 2, L) / 2,
        dW_nc=-integral(C_beta * y.diff(t) * delta(y) + EI * C_alpha * y.diff(x, 2, t) * delta(y.diff(x, 2)), L)
        + F_0 * at(delta(y), x_F),
        length=L,
    ),
    source="Euler, Methodus inveniendi lineas curvas, Additamentum I (1744)",
    references=(Reference("9.86960440109", "divergence", TWO_ROUTES),),
)
