"""Beck's column: a cantilever under a tip force of constant size, follower (eta = 1) to dead (eta = 0)."""

from sympy import Symbol

from freebeam_derive.notation import EI, F_0, C_alpha, C_beta, L, P, alpha, beta, m, t, x, x_F, y
from freebeam_derive.references import TWO_ROUTES
from freebeam_derive.statement import Column, Energies, Parameter, Reference, at, delta, integral

eta = Symbol("eta", real=True)

column = Column(
    name="beck",
    title="Cantilever under a tip force, follower or sub-tangential",
    family="Tip force",
    T=integral(y.diff(t) ** 2) / 2,
    V=integral(y.diff(x, 2) ** 2) / 2,
    W_c=P * integral(y.diff(x) ** 2) / 2,
    dW_nc=-integral(beta * y.diff(t) * delta(y) + alpha * y.diff(x, 2, t) * delta(y.diff(x, 2)))
    - eta * P * at(y.diff(x), 1) * at(delta(y), 1)
    + F_0 * at(delta(y), x_F),
    ends=("clamped", "free"),
    parameters=(
        Parameter(
            eta, "share of the tip force that follows the slope: 1 follower, 0 dead load", 1.0, 0.0, 1.5, r"\eta"
        ),
    ),
    dimensional=Energies(
        T=integral(m * y.diff(t) ** 2, L) / 2,
        V=integral(EI * y.diff(x, 2) ** 2, L) / 2,
        W_c=integral(P * y.diff(x) ** 2, L) / 2,
        dW_nc=-integral(C_beta * y.diff(t) * delta(y) + EI * C_alpha * y.diff(x, 2, t) * delta(y.diff(x, 2)), L)
        - eta * P * at(y.diff(x), L) * at(delta(y), L)
        + F_0 * at(delta(y), x_F),
        length=L,
    ),
    source="Beck, Die Knicklast des einseitig eingespannten, tangential gedrückten Stabes, ZAMP 3 (1952) 225-228",
    references=(
        Reference("20.050953618974", "flutter", TWO_ROUTES),
        Reference(
            "20.05",
            "flutter",
            "Beck (1952), summary: 20,05 α/l²",
            seen="https://paperexplained.cn/articles/paper/detail/5e871fdd74584fca18c8b6bd3507ee08cf0e8cbb",
        ),
        Reference(
            "37.7",  # the limit of large damping, which 1e3 reaches to these digits; seen on 27 November 2026
            "flutter",
            "The effect of external damping on the stability of Beck's column, summary: 37.7 EI/L² for large damping",
            beta=1e3,
            seen="https://paperexplained.cn/articles/paper/detail/6febb04be2719338ca4fe1aa75df6378b00c5003",
        ),
        Reference("2.46740110027", "divergence", TWO_ROUTES, own={"eta": 0.0}),
    ),
)
