"""SI sizes of one nondimensional unit of each quantity, Eq. (5), and the unit that follows from a size."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from sympy import Expr, Integer, simplify, sqrt

from freebeam_derive.notation import EI, L, m

_time = sqrt(m * L**4 / EI)

SCALES: dict[str, Expr] = {
    "length": L,
    "time": _time,
    "load": EI / L**2,
    "force": EI / L**2,
    "alpha": _time,
    "beta": m / _time,
    "frequency": 1 / _time,
    "velocity": L / _time,
    "acceleration": L / _time**2,
    "energy": EI / L,
}

UNITS: dict[str, str] = {
    "length": "m",
    "time": "s",
    "load": "N",
    "force": "N",
    "alpha": "s",
    "beta": "kg/(m s)",
    "frequency": "rad/s",
    "velocity": "m/s",
    "acceleration": "m/s^2",
    "energy": "J",
}


@dataclass(frozen=True)
class Quantity:
    """A quantity in SI: what one nondimensional unit of it is in EI, m, L and parameters, and its unit.

    of: the column's own parameter that it is the quantity of; "" of the load.
    """

    size: Expr
    unit: str
    of: str = ""


def told(quantities: Mapping[str, Quantity]) -> dict[str, Any]:
    """What a module's COLUMN says of SI quantities that are the column's own."""
    found = {name: {"unit": q.unit, "size": str(q.size), "of": q.of} for name, q in quantities.items()}
    return {"quantities": found} if found else {}


_DIMENSIONS = {EI: (1, 3, -2), m: (1, -1, 0), L: (0, 1, 0)}  # powers of kg, m and s
_NAMED = {
    (1, 1, -2): "N",
    (1, 2, -2): "N m",
    (1, 3, -2): "N m^2",
    (1, 0, -2): "N/m",
    (1, -1, -2): "N/m^2",
    (1, 0, -1): "N s/m",
    (1, 2, -1): "N m s",
    (0, 0, -1): "rad/s",
    (0, 0, 0): "1",
}


def unit_of(size: Expr) -> str:
    """The SI unit of a size in EI, m and L: "N", "m/s", "kg m^2"; "1" where it has no dimension.

    Raises ValueError where the size is no product of whole powers of kg, m and s.
    """
    powers = {symbol: simplify(symbol * size.diff(symbol) / size) for symbol in _DIMENSIONS}
    found = tuple(sum((powers[s] * _DIMENSIONS[s][k] for s in powers), Integer(0)) for k in range(3))
    if not all(power.is_Integer for power in found):
        raise ValueError(f"{size} is no product of powers of EI, m and L")
    whole = tuple(map(int, found))
    if whole in _NAMED:
        return _NAMED[whole]
    above, below = (
        [
            name + (f"^{sign * n}" if sign * n > 1 else "")
            for name, n in zip(("kg", "m", "s"), whole, strict=True)
            if sign * n > 0
        ]
        for sign in (1, -1)
    )
    under = "" if not below else f"/{below[0]}" if len(below) == 1 else f"/({' '.join(below)})"
    return (" ".join(above) or "1") + under
