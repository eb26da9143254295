"""Leipholz's column: a cantilever under a uniformly distributed follower load, P in all."""

from freebeam_derive.notation import EI, F_0, C_alpha, C_beta, L, P, alpha, beta, m, t, x, x_F, y
from freebeam_derive.statement import Column, Energies, at, delta, integral

column = Column(
    name="leipholz",
    title="Cantilever under a uniformly distributed follower load",
    T=integral(y.diff(t) ** 2) / 2,
    V=integral(y.diff(x, 2) ** 2) / 2,
    W_c=P * integral((1 - x) * y.diff(x) ** 2) / 2,
    dW_nc=-integral(beta * y.diff(t) * delta(y) + alpha * y.diff(x, 2, t) * delta(y.diff(x, 2)))
    - P * integral(y.diff(x) * delta(y))
    + F_0 * at(delta(y), x_F),
    ends=("clamped", "free"),
    dimensional=Energies(
        T=integral(m * y.diff(t) ** 2, L) / 2,
        V=integral(EI * y.diff(x, 2) ** 2, L) / 2,
        W_c=integral(P * (1 - x / L) * y.diff(x) ** 2, L) / 2,
        dW_nc=-integral(C_beta * y.diff(t) * delta(y) + EI * C_alpha * y.diff(x, 2, t) * delta(y.diff(x, 2)), L)
        - integral(P / L * y.diff(x) * delta(y), L)
        + F_0 * at(delta(y), x_F),
        length=L,
    ),
    source="Leipholz, Die Knicklast des einseitig eingespannten Stabes mit gleichmässig verteilter, tangentialer "
    "Längsbelastung, ZAMP 13 (1962) 581-589",
)
