"""The paper's column: a free-free beam under an end follower force. Eqs. (1)-(5) and (8)."""

from freebeam_derive.notation import EI, F_0, C_alpha, C_beta, L, P, alpha, beta, m, t, x, x_F, y
from freebeam_derive.references import TWO_ROUTES
from freebeam_derive.statement import Column, Energies, Reference, at, delta, integral

axial_force = P * x / L  # Eq. (3)

column = Column(
    name="free-free",
    title="Free-free beam under an end follower force and a transversal force",
    family="Free in space, with control",
    T=integral(y.diff(t) ** 2) / 2,
    V=integral(y.diff(x, 2) ** 2) / 2,
    W_c=P * integral(x * y.diff(x) ** 2) / 2,
    dW_nc=-integral(beta * y.diff(t) * delta(y) + alpha * y.diff(x, 2, t) * delta(y.diff(x, 2)))
    - P * at(y.diff(x), 1) * at(delta(y), 1)
    + F_0 * at(delta(y), x_F),
    ends=("free", "free"),
    dimensional=Energies(
        T=integral(m * y.diff(t) ** 2, L) / 2,
        V=integral(EI * y.diff(x, 2) ** 2, L) / 2,
        W_c=integral(axial_force * y.diff(x) ** 2, L) / 2,
        dW_nc=-integral(C_beta * y.diff(t) * delta(y) + EI * C_alpha * y.diff(x, 2, t) * delta(y.diff(x, 2)), L)
        - P * at(y.diff(x), L) * at(delta(y), L)
        + F_0 * at(delta(y), x_F),
        length=L,
    ),
    source="Kavianipour and Sadati, Effects of damping on the linear stability of a free-free beam subjected to "
    "follower and transversal forces, Eq. (8)",
    basis="modes",  # section 3.2, with as many as eight terms
    modes=8,
    references=(Reference("109.68919195874", "flutter", TWO_ROUTES),),
)
