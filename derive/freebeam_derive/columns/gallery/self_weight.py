"""Greenhill's column: an upright cantilever under its own weight, P in all."""

from freebeam_derive.notation import F_0, P, alpha, beta, t, x, x_F, y
from freebeam_derive.references import TWO_ROUTES
from freebeam_derive.statement import Column, Reference, at, delta, integral

column = Column(
    name="self-weight",
    title="Upright cantilever under its own weight",
    family="Dead loads",
    T=integral(y.diff(t) ** 2) / 2,
    V=integral(y.diff(x, 2) ** 2) / 2,
    W_c=P * integral((1 - x) * y.diff(x) ** 2) / 2,
    dW_nc=-integral(beta * y.diff(t) * delta(y) + alpha * y.diff(x, 2, t) * delta(y.diff(x, 2)))
    + F_0 * at(delta(y), x_F),
    ends=("clamped", "free"),
    source="Greenhill, Determination of the greatest height consistent with stability that a vertical pole "
    "or mast can be made, Proc. Cambridge Philos. Soc. 4 (1881) 65-73",
    references=(
        Reference("7.83734743894", "divergence", TWO_ROUTES),
        Reference(
            "7.8373",
            "divergence",
            "Greenhill (1881), as tabulated in Timoshenko and Gere (1961) and told by pyBModes",
            seen="https://github.com/SMI-Lab-Inha/pyBModes, tests/fem/test_gravity_and_point_mass.py",
        ),
        Reference(
            "7.83",
            "divergence",
            "Païdoussis, Fluid-Structure Interactions, vol. 1, page 117: a standing cantilever buckles at γ = −7.83",
            rule="cut off",
            seen="https://digilib.universitaspertamina.ac.id/ebook/Fluid%20Structure%20Interactions%20Slender%"
            "20Structure%20and%20Axial%20Flow%20(Volume%201)/files/basic-html/page135.html",
        ),
    ),
)
