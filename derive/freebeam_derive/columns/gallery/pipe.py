"""A cantilevered pipe that conveys fluid, on an elastic foundation if need be; the load is the velocity of the flow."""

from sympy import Symbol, sqrt

from freebeam_derive.notation import EI, F_0, C_alpha, C_beta, L, P, alpha, beta, m, t, x, x_F, y
from freebeam_derive.references import TWO_ROUTES
from freebeam_derive.statement import Column, Energies, Parameter, Reference, at, delta, integral

b, k = (Symbol(name, real=True) for name in ("b", "k"))
M_f, k_f = (Symbol(name, real=True) for name in ("M_f", "k_f"))  # kg/m of fluid, N/m² of the foundation

column = Column(
    name="pipe",
    title="Cantilevered pipe that conveys fluid",
    family="Flow",
    T=integral(y.diff(t) ** 2) / 2,
    V=integral(y.diff(x, 2) ** 2) / 2 + k * integral(y**2) / 2,
    dW_nc=-integral(beta * y.diff(t) * delta(y) + alpha * y.diff(x, 2, t) * delta(y.diff(x, 2)))
    - P**2 * integral(y.diff(x, 2) * delta(y))
    - 2 * sqrt(b) * P * integral(y.diff(x, t) * delta(y))
    + F_0 * at(delta(y), x_F),
    ends=("clamped", "free"),
    parameters=(
        Parameter(b, "mass of the fluid, as a share of that of pipe and fluid", 0.1, 0.01, 0.9),
        Parameter(k, "stiffness of the foundation", 0.0, 0.0, 200.0),
    ),
    dimensional=Energies(
        T=m * integral(y.diff(t) ** 2, L) / 2,
        V=EI * integral(y.diff(x, 2) ** 2, L) / 2 + k_f * integral(y**2, L) / 2,
        dW_nc=-integral(C_beta * y.diff(t) * delta(y) + C_alpha * EI * y.diff(x, 2, t) * delta(y.diff(x, 2)), L)
        - M_f * P**2 * integral(y.diff(x, 2) * delta(y), L)
        - 2 * M_f * P * integral(y.diff(x, t) * delta(y), L)
        + F_0 * at(delta(y), x_F),
        length=L,
        scaling={P: P * sqrt(EI / (b * m)) / L, M_f: b * m, k_f: k * EI / L**4},
    ),
    source="Païdoussis, Fluid-Structure Interactions: Slender Structures and Axial Flow, vol. 1",
    references=(
        Reference("4.74989677311", "flutter", TWO_ROUTES),
        Reference("8.4376423464509", "flutter", TWO_ROUTES, own={"b": 0.3, "k": 50.0}),
        # Both seen on 27 November 2026. The page does not say how 7.0 was found: three modes of the cantilever give
        # 6.98, and 5.60 at b = 0.2; four give 7.37, and the beam itself loses stability at 7.26.
        Reference(
            "7.0",
            "flutter",
            "Païdoussis, Fluid-Structure Interactions, vol. 1, page 112, after Gregory and Païdoussis (1966)",
            own={"b": 0.295},
            seen="https://digilib.universitaspertamina.ac.id/ebook/Fluid%20Structure%20Interactions%20Slender%"
            "20Structure%20and%20Axial%20Flow%20(Volume%201)/files/basic-html/page130.html",
            modes=3,
        ),
        Reference(
            "5.6",
            "flutter",
            "Païdoussis, Fluid-Structure Interactions, vol. 1, page 112, after Gregory and Païdoussis (1966)",
            own={"b": 0.2},
            seen="https://digilib.universitaspertamina.ac.id/ebook/Fluid%20Structure%20Interactions%20Slender%"
            "20Structure%20and%20Axial%20Flow%20(Volume%201)/files/basic-html/page130.html",
        ),
    ),
)
