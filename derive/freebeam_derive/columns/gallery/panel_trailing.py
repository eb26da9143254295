"""A panel in a supersonic flow, clamped at its trailing edge, which diverges.

The load is the dynamic pressure, by piston theory without its damping.
"""

from freebeam_derive.notation import F_0, P, alpha, beta, t, x, x_F, y
from freebeam_derive.references import TWO_ROUTES
from freebeam_derive.statement import Column, Reference, at, delta, integral

column = Column(
    name="panel-trailing",
    title="Panel clamped at its trailing edge in a supersonic flow",
    family="Flow",
    T=integral(y.diff(t) ** 2) / 2,
    V=integral(y.diff(x, 2) ** 2) / 2,
    dW_nc=-integral(beta * y.diff(t) * delta(y) + alpha * y.diff(x, 2, t) * delta(y.diff(x, 2)))
    - P * integral(y.diff(x) * delta(y))
    + F_0 * at(delta(y), x_F),
    ends=("free", "clamped"),
    source="Dowell, Panel flutter, NASA SP-8004 (1972), treats such panels",
    references=(Reference("6.3297031101732", "divergence", TWO_ROUTES),),
)
