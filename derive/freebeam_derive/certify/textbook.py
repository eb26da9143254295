"""A kernel of the textbook's kind read as one of any column: with a mass at an end, a taper, or another stiffness.

Its modes are not those of the comparison beam, so that `ExactSystem` and `FrequencyGaps` serve it; uniform.py is the
other way about.
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from inspect import signature
from typing import Any

from freebeam_derive.certify.comparison_form import ORDERS

UNIFORM = {(0, 0, 0): 1}, {(0, 2, 2): 1}
"""∫ y² and ∫ y''², the mass and the bending of the comparison beam."""


def of_any(kernel: Any, *own: Mapping[str, Fraction]) -> Any:
    """The kernel, read as of any column where it is not of the comparison beam's mass and bending stiffness at some
    own parameters. One with rigid motions stays as it is."""
    if kernel.COLUMN.get("general") or kernel.COLUMN["rigid"]:
        return kernel
    try:
        forms = [kernel.forms(Fraction(1), **of) for of in own]
    except TypeError:  # of a factor such as √2, which is no fraction
        return kernel
    return kernel if all(map(_uniform, forms)) else OfAny(kernel)


def _uniform(forms: Mapping[str, Any]) -> bool:
    (mass, points), (elastic, _) = forms["M"], forms["E"]
    bending = {key: f for key, f in elastic.items() if key[1:] == (2, 2) and f}
    return ({key: f for key, f in mass.items() if f}, bending) == UNIFORM and not any(points.values())


class OfAny:
    """What a kernel of any column says, at its own parameters in numbers of any kind: y on one segment from 0 to 1."""

    COORDINATES = ()

    def __init__(self, kernel: Any) -> None:
        self._kernel, self.basis = kernel, kernel.basis
        self.COLUMN = {**kernel.COLUMN, "general": True, "inexact": "", "breaks": ["0", "1"]}
        held = {(end, order) for end, kind in enumerate(kernel.COLUMN["ends"]) for order in ORDERS[kind] if order < 2}
        self.FIELDS: dict[str, Any] = {"y": (2, frozenset(held), frozenset())}
        self._one = "one" in signature(kernel.equation).parameters

    def places(self, one: Any, **own: Any) -> tuple[Any, Any]:
        """The ends."""
        return 0 * one, one

    def sensors(self, one: Any, **own: Any) -> tuple[()]:
        """None: what acts on an end is seen at an end."""
        return ()

    def equations(self, alpha: Any, beta: Any, one: Any, **own: Any) -> tuple[dict[Any, Any]]:
        """(y, y, p, r, k) -> factor of P^k ∂ᵖ⁺ʳy/∂xᵖ∂tʳ, ascending in powers of x."""
        still, loaded = self._at(self._kernel.equation, alpha, beta, one, own)
        return ({("y", "y", *key, k): row for key in loaded for k, row in enumerate(_split(still[key], loaded[key]))},)

    def conditions(self, alpha: Any, beta: Any, one: Any, **own: Any) -> tuple[dict[Any, Any], ...]:
        """(y, p, r, k, (0, end)) -> factor of P^k, of the conditions at each end."""
        both = self._at(self._kernel.end_conditions, alpha, beta, one, own)
        return tuple(
            {
                ("y", p, r, k, (0, end)): value
                for p, r in loaded
                for k, (value,) in enumerate(_split((still[p, r],), (loaded[p, r],)))
            }
            for end in (0, 1)
            for still, loaded in zip(both[0][end], both[1][end], strict=True)
        )

    def _at(self, table: Any, alpha: Any, beta: Any, one: Any, own: Any) -> tuple[Any, Any]:
        """At the loads 0 and 1."""
        exactly = own | {"one": one} if self._one else own
        return table(0 * one, alpha, beta, **exactly), table(one, alpha, beta, **exactly)

    def forms(self, one: Any, alpha: Any = 0, beta: Any = 0, **own: Any) -> dict[str, Any]:
        """M, C and K by powers of the load: integrals along the beam and values at places."""
        found = self._kernel.forms(one, **own)
        c_M, c_E = (_exactly(factor, one) for factor in self._kernel.damping_factors(alpha, beta, **own))
        M, E, H = (_form(found[name], one) for name in "MEH")
        C = tuple([*_scaled(a, c_M), *_scaled(b, c_E)] for a, b in zip(M, E, strict=True))
        return {"breaks": (0 * one, one), "rigid": (), "M": [M], "C": [C], "K": [E, H]}

    def mass(self, basis: Any, P: float, **own: float) -> Any:
        """M of a series."""
        return self._kernel.mass(basis, **own)

    def stiffness(self, basis: Any, P: float, **own: float) -> Any:
        """K of a series at a load."""
        return self._kernel.stiffness_elastic(basis, **own) + P * self._kernel.stiffness_load(basis, **own)


def _split(still: tuple[Any, ...], loaded: tuple[Any, ...]) -> tuple[tuple[Any, ...], tuple[Any, ...]]:
    """A row without load, and what the load adds: exactly nothing where the two are one number, or one ball."""
    return still, tuple(0 if repr(a) == repr(b) else b - a for a, b in zip(still, loaded, strict=True))


def _form(form: Any, one: Any) -> tuple[list[Any], list[Any]]:
    along, points = form
    inner = [((0,), "y", p, "y", q, [0 * one] * k + [f * one]) for (k, p, q), f in along.items()]
    return inner, [(("y", p, a * one, 0), ("y", q, b * one, 0), f * one) for (a, p, b, q), f in points.items()]


def _exactly(factor: Any, one: Any) -> Any:
    """A factor that the kernel has as a float, as a number of the same kind as the others. Raises ValueError."""
    if not isinstance(factor, float):
        return factor
    if not (factor * 2**20).is_integer():
        raise ValueError(f"{factor!r} is a rounded number")
    numerator, denominator = factor.as_integer_ratio()
    return one * numerator / denominator


def _scaled(terms: list[Any], factor: Any) -> list[Any]:
    return [(*where, [factor * v for v in f] if isinstance(f, list) else factor * f) for *where, f in terms]
