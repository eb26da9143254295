"""What the page is told of a column beside its kernel: names, parameters, the start of its controls. Nondimensional."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from freebeam_sym.columns import Column

__all__ = ["content"]

MODES = 16
"""Largest number N of functions that a page shows."""
LOAD_MAX = 1000.0
"""Loads are searched up to here, as by `critical_load`."""
CASE = {"alpha": 1e-3, "beta": 0.1}
"""Dampings of the case that a page opens with, where the column has them: Section 4.4."""


def content(column: Column) -> dict[str, Any]:
    """What a page is told, as JSON has it. Raises InputError where the column is not stable without load."""
    column.textbook("a page")
    alpha, beta = (CASE[name] if name in column.damping else 0.0 for name in ("alpha", "beta"))
    first = _first_load(column)
    span = _nice(1.6 * first) if first else LOAD_MAX
    return {
        "name": column.name,
        "title": column.title,
        "basis": column.basis_name,
        "ends": list(column.ends),
        "rigid": column.rigid_count,
        "damping": list(column.damping),
        "parameters": [
            {"name": p.name, "symbol": _symbol(p.name), "meaning": p.meaning, "default": p.default, "low": p.low,
             "high": p.high}
            for p in column.parameters
        ],
        "modes": MODES,
        "load_range": span,
        "load_max": LOAD_MAX,
        "start": {"P": 0.4 * span, "alpha": alpha, "beta": beta, "N": min(8, MODES), "sensor": 0.1},
    }  # fmt: skip


def _first_load(column: Column) -> float | None:
    from freebeam_sym.stability.critical import critical_load

    return critical_load(column, min(8, MODES)).load


def _nice(value: float) -> float:
    """The round number at or above a value."""
    power = 10.0 ** np.floor(np.log10(value))
    return float(next(step * power for step in (1, 1.2, 1.5, 2, 2.5, 3, 4, 5, 6, 8, 10) if step * power >= value))


def _symbol(name: str) -> str:
    """A parameter's name as a page shows it: Greek where it is the name of a letter."""
    import unicodedata

    try:
        return unicodedata.lookup(f"GREEK SMALL LETTER {name.upper()}")
    except KeyError:
        return name
