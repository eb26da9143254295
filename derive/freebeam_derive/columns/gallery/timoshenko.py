"""Beck's column with shear deformation and rotary inertia; the force turns with the cross-section or with the axis."""

from sympy import Symbol

from freebeam_derive.notation import F_0, P, alpha, beta, t, x, x_F, y
from freebeam_derive.references import TWO_ROUTES
from freebeam_derive.statement import Column, Field, Parameter, Reference, at, delta, integral

s, r, e = (Symbol(name, real=True) for name in ("s", "r", "e"))
psi = Field("psi", r"\psi")  # the rotation of the cross-section

column = Column(
    name="timoshenko",
    title="Timoshenko's cantilever under a follower force",
    family="Shear and rotary inertia",
    T=integral(y.diff(t) ** 2 + r * psi.diff(t) ** 2) / 2,
    V=integral(psi.diff(x) ** 2 + s * (y.diff(x) - psi) ** 2) / 2,
    W_c=P * integral(y.diff(x) ** 2) / 2,
    dW_nc=-integral(beta * y.diff(t) * delta(y) + alpha * psi.diff(x, t) * delta(psi.diff(x)))
    - P * ((1 - e) * at(psi, 1) + e * at(y.diff(x), 1)) * at(delta(y), 1)
    + F_0 * at(delta(y), x_F),
    ends=("clamped", "free"),
    parameters=(
        Parameter(s, "shear stiffness in units of EI by the length squared", 100.0, 30.0, 2000.0),
        Parameter(r, "rotary inertia: the square of the radius of gyration", 0.01, 0.001, 0.05),
        Parameter(e, "the force turns with the cross-section (0) or with the axis (1)", 0.0, 0.0, 1.0),
    ),
    source="Kim and Choo, Dynamic stability of a free-free Timoshenko beam subjected to a pulsating follower"
    " force, J. Sound and Vibration 216 (1998) 623-636, has the beam",
    references=(
        Reference("14.391089106038", "flutter", TWO_ROUTES),
        Reference("14.391089106038", "flutter", TWO_ROUTES, own={"e": 1.0}),
        Reference("19.258001279356", "flutter", TWO_ROUTES, own={"s": 1000.0, "r": 0.001}),
        Reference("19.258001279356", "flutter", TWO_ROUTES, own={"s": 1000.0, "r": 0.001, "e": 1.0}),
    ),
)
