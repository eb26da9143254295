"""Beck's column with a dead load on its tip besides the follower force."""

from sympy import Symbol

from freebeam_derive.notation import F_0, P, alpha, beta, t, x, x_F, y
from freebeam_derive.references import TWO_ROUTES
from freebeam_derive.statement import Column, Parameter, Reference, at, delta, integral

w = Symbol("w", real=True)

column = Column(
    name="beck-dead-load",
    title="Cantilever under a follower force and a dead load at its tip",
    family="Tip force",
    T=integral(y.diff(t) ** 2) / 2,
    V=integral(y.diff(x, 2) ** 2) / 2 - w * integral(y.diff(x) ** 2) / 2,
    W_c=P * integral(y.diff(x) ** 2) / 2,
    dW_nc=-integral(beta * y.diff(t) * delta(y) + alpha * y.diff(x, 2, t) * delta(y.diff(x, 2)))
    - P * at(y.diff(x), 1) * at(delta(y), 1)
    + F_0 * at(delta(y), x_F),
    ends=("clamped", "free"),
    parameters=(Parameter(w, "dead load at the tip", 1.0, 0.0, 2.4),),
    # seen on 27 November 2026 at revistas.udea.edu.co/index.php/ingenieria, article 14229
    source="Arboleda-Monsalve, Zapata-Medina and Aristizabal-Ochoa, Reut and Beck columns: effects of end "
    "gravity force, translation and rotational inertias; as stated for this project, where the load "
    "shared in a fixed ratio is the sub-tangential force of the column beck",
    references=(Reference("18.2946320604", "flutter", TWO_ROUTES),),
)
