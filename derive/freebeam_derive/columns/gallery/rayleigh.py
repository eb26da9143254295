"""Beck's column with the rotary inertia of its cross-sections."""

from sympy import Symbol

from freebeam_derive.notation import F_0, P, alpha, beta, t, x, x_F, y
from freebeam_derive.references import TWO_ROUTES
from freebeam_derive.statement import Column, Parameter, Reference, at, delta, integral

r = Symbol("r", real=True)

column = Column(
    name="rayleigh",
    title="Rayleigh's cantilever under a follower force",
    family="Shear and rotary inertia",
    T=integral(y.diff(t) ** 2) / 2 + r * integral(y.diff(x, t) ** 2) / 2,
    V=integral(y.diff(x, 2) ** 2) / 2,
    W_c=P * integral(y.diff(x) ** 2) / 2,
    dW_nc=-integral(beta * y.diff(t) * delta(y) + alpha * y.diff(x, 2, t) * delta(y.diff(x, 2)))
    - P * at(y.diff(x), 1) * at(delta(y), 1)
    + F_0 * at(delta(y), x_F),
    ends=("clamped", "free"),
    parameters=(Parameter(r, "rotary inertia: the square of the radius of gyration", 0.01, 0.0, 0.05),),
    # seen on 27 November 2026 at revistas.udea.edu.co/index.php/ingenieria, article 14229
    source="Arboleda-Monsalve, Zapata-Medina and Aristizabal-Ochoa, Reut and Beck columns: effects of end "
    "gravity force, translation and rotational inertias; as stated for this project",
    references=(Reference("18.1684874096", "flutter", TWO_ROUTES),),
)
