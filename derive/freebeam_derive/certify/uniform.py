"""A uniform beam whose kernel is of the kind of any column, read as one of the textbook's: one field y on one segment.

Such are columns whose damping is not C = alpha E + beta M, since a dead load or a foundation is without it. Without
internal damping `Beam` and `Strips` serve them; they look themselves at what the equation, the mass and the load are.
"""

from __future__ import annotations

from typing import Any


def uniform(kernel: Any, **own: Any) -> Uniform | None:
    """None where a column has more than one deflection on one segment, of mass and bending stiffness 1, without damping
    but alpha and beta on rates. own: its own parameters; their defaults where left out."""
    fields = getattr(kernel, "FIELDS", {})
    plain = list(fields) == ["y"] and fields["y"][0] == 2 and not fields["y"][2]
    if not plain or kernel.COORDINATES or kernel.COLUMN["breaks"] != ["0", "1"] or kernel.COLUMN["inexact"]:
        return None
    if kernel.COLUMN.get("circulatory"):
        return None  # alpha or beta acts on displacements too
    try:
        found = Uniform(kernel)
        found.equation(0, 0, 0, **own), found.end_conditions(0, 0, 0, **own)
        forms = found.forms(1, **own)
        dampers = [_form(*part) for part in kernel.forms(1, 0, 0, **own)["C"]]
    except (NotUniform, AttributeError, TypeError, ValueError):
        return None
    plain = forms["M"] == ({(0, 0, 0): 1}, {}) and forms["E"][0].get((0, 2, 2)) == 1
    return found if plain and not any(v for form in dampers for part in form for v in part.values()) else None


class NotUniform(ValueError):
    """What is not of the textbook's kind."""


class Uniform:
    """What `Beam` and `Strips` ask of a kernel, at its own parameters in numbers of any kind."""

    def __init__(self, kernel: Any) -> None:
        self._kernel = kernel
        self.COLUMN = {key: value for key, value in kernel.COLUMN.items() if key != "general"}

    def equation(self, P: Any, alpha: Any, beta: Any, one: Any = 1, **own: Any) -> dict[Any, Any]:
        """(p, r) -> factor of ∂ᵖ⁺ʳy/∂xᵖ∂tʳ, ascending in powers of x."""
        (table,) = self._kernel.equations(alpha, beta, one, **own)
        found: dict[Any, list[Any]] = {}
        for (_, _, p, r, k), factor in table.items():
            if callable(factor):
                raise NotUniform
            row = found.setdefault((p, r), [])
            row += [0] * (len(factor) - len(row))
            for n, value in enumerate(factor):
                row[n] = row[n] + value * P**k
        return {key: tuple(row) for key, row in found.items()}

    def end_conditions(self, P: Any, alpha: Any, beta: Any, one: Any = 1, **own: Any) -> tuple[Any, Any]:
        """Two conditions at x = 0 and two at x = 1: (p, r) -> factor."""
        ends: tuple[list[Any], list[Any]] = [], []
        for condition in self._kernel.conditions(alpha, beta, one, **own):
            places = {place for *_, place in condition}
            if places not in ({(0, 0)}, {(0, 1)}):
                raise NotUniform
            row: dict[Any, Any] = {}
            for (_, p, r, k, _), factor in condition.items():
                row[p, r] = row.get((p, r), 0) + factor * P**k
            ends[places.pop()[1]].append(row)
        if len(ends[0]) != 2 or len(ends[1]) != 2:
            raise NotUniform
        return tuple(ends[0]), tuple(ends[1])

    def forms(self, one: Any = 1, **own: Any) -> dict[str, Any]:
        """M, E, H as a kernel of the textbook's has them."""
        stated = self._kernel.forms(one, 0, 0, **own)
        if len(stated["M"]) != 1 or len(stated["K"]) != 2:
            raise NotUniform
        return {name: _form(*form) for name, form in zip("MEH", (*stated["M"], *stated["K"]), strict=True)}

    def damping_factors(self, alpha: Any, beta: Any, **own: Any) -> tuple[Any, Any]:
        """Without internal damping, which `Beam.damping` holds to."""
        return beta, alpha


def _form(along: Any, points: Any) -> tuple[dict[Any, Any], dict[Any, Any]]:
    inner: dict[Any, Any] = {}
    at_ends: dict[Any, Any] = {}
    for _, _, p, _, q, factors in along:
        for k, factor in enumerate(factors):
            inner[k, p, q] = inner.get((k, p, q), 0) + factor
    for (_, p, a, _), (_, q, b, _), factor in points:
        places = tuple(next((e for e in (0, 1) if place == e), None) for place in (a, b))
        if None in places:
            raise NotUniform
        key = places[0], p, places[1], q
        at_ends[key] = at_ends.get(key, 0) + factor
    return inner, at_ends
