"""What the page computes with: a column's matrices, trial functions and loads, as numbers. All nondimensional.

Whatever depends on the column's own parameters (eta, say) is a series in Chebyshev polynomials of each, from samples
of the emitted kernel: exact to rounding where the dependence is polynomial, and as long as it must be elsewhere.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from itertools import product
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import NDArray

from freebeam_sym.checks import InputError

if TYPE_CHECKING:
    from freebeam_sym.columns import Column

__all__ = ["content"]

Array = NDArray[np.float64]

MODES = 16
"""Largest number N of functions that a page holds."""
LOAD_MAX = 1000.0
"""Loads are searched up to here, as by `critical_load`."""
TOLERANCE = 1e-14
"""What a series may leave out of each entry, relative to the largest of its kind."""
LONGEST = 32
"""Terms of a series in one parameter up to which it is made longer."""
CASE = {"alpha": 1e-3, "beta": 0.1}
"""Dampings of the case that a page opens with, where the column has them: Section 4.4."""


def content(column: Column) -> dict[str, Any]:
    """All numbers of the page of a column, as JSON has them. Eqs. (9)-(13), (22).

    Raises InputError where the column is not stable without load, or where it depends on its parameters in a way that
    no series of `LONGEST` terms holds.
    """
    column.textbook("a page")
    names = [p.name for p in column.parameters]
    low, high = np.array([[p.low, p.high] for p in column.parameters]).reshape(-1, 2).T
    axial = _axial_terms(column)

    def sample(own: Mapping[str, float]) -> list[Array]:
        matrices = [matrix.ravel() for matrix in column.matrices(MODES, False, **own)]
        return [*matrices, _damping(column, own), _loads(column, own, axial)]

    degrees, series = _series(sample, names, low, high)
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
        "degrees": degrees,
        "series": series.tolist(),
        "axial_terms": axial,
        "shapes": _shapes(column).tolist(),
    }  # fmt: skip


def _series(
    sample: Callable[[Mapping[str, float]], list[Array]], names: list[str], low: Array, high: Array
) -> tuple[list[int], Array]:
    """Degrees (d,) and coefficients (terms, values) of the tensor series, the last parameter fastest."""
    if not names:
        return [], np.concatenate(sample({}))[None]
    degrees = [2] * len(names)
    while True:
        values = _sampled(sample, names, low, high, degrees)
        coefficients = [_transformed(part, degrees) for part in values]
        short = [_too_short(coefficients, axis) for axis in range(len(names))]
        if not any(short):
            break
        degrees = [2 * d if more else d for d, more in zip(degrees, short, strict=True)]
        if max(degrees) > LONGEST:
            name = names[int(np.argmax(degrees))]
            raise InputError(
                f"{name}: the column depends on it in a way that no series of {LONGEST} terms holds from "
                f"{low[names.index(name)]:g} to {high[names.index(name)]:g}; state a narrower range of interest"
            )
    kept, coefficients = _trimmed(coefficients, degrees)
    terms = int(np.prod([d + 1 for d in kept]))
    return kept, np.concatenate([part.reshape(terms, -1) for part in coefficients], axis=1)


def _sampled(sample: Any, names: list[str], low: Array, high: Array, degrees: list[int]) -> list[Array]:
    """Values at the Chebyshev points, each kind (d₁ + 1, …, values)."""
    points = [(np.cos(np.pi * (np.arange(d + 1) + 0.5) / (d + 1))) for d in degrees]
    axes = [a + (b - a) * (u + 1) / 2 for a, b, u in zip(low, high, points, strict=True)]
    rows = [sample({name: float(x) for name, x in zip(names, place, strict=True)}) for place in product(*axes)]
    shape = [d + 1 for d in degrees]
    return [np.array(part).reshape(*shape, -1) for part in zip(*rows, strict=True)]


def _transformed(values: Array, degrees: list[int]) -> Array:
    for axis, d in enumerate(degrees):
        u = np.cos(np.pi * (np.arange(d + 1) + 0.5) / (d + 1))
        T = chebyshev.chebvander(u, d) * (2 / (d + 1))
        T[:, 0] /= 2
        values = np.moveaxis(np.tensordot(T.T, values, axes=(1, axis)), 0, axis)
    return values


def _negligible(coefficients: list[Array], axis: int) -> NDArray[np.bool_]:
    """Which terms of a parameter are rounding in every kind of value."""
    verdicts = []
    for part in coefficients:
        size = np.abs(np.moveaxis(part, axis, 0))
        verdicts.append(size.reshape(len(size), -1).max(axis=1) <= TOLERANCE * max(float(size.max()), 1e-300))
    return np.asarray(np.all(verdicts, axis=0))


def _too_short(coefficients: list[Array], axis: int) -> bool:
    return not _negligible(coefficients, axis)[-1]


def _trimmed(coefficients: list[Array], degrees: list[int]) -> tuple[list[int], list[Array]]:
    """Without the terms at each series' end that are rounding."""
    kept = []
    for axis in range(len(degrees)):
        needed = np.flatnonzero(~_negligible(coefficients, axis))
        kept.append(int(needed[-1]) if len(needed) else 0)
    cut = tuple(slice(d + 1) for d in kept)
    return kept, [part[cut] for part in coefficients]


def _damping(column: Column, own: Mapping[str, float]) -> Array:
    """c_M = c₀ + c₁ alpha + c₂ beta and c_E alike, (6,). Eq. (12)."""

    def factors(alpha: float, beta: float) -> Array:
        return np.array(column.damping_factors(alpha, beta, **own))

    none, alpha, beta = factors(0, 0), factors(1, 0), factors(0, 1)
    if np.abs(factors(2, 3) - (2 * alpha + 3 * beta - 4 * none)).max() > 1e-12:
        raise InputError(
            f"{column.name}: the damping matrix is not linear in alpha and beta, which the page takes it for"
        )
    return np.stack([none, alpha - none, beta - none]).T.ravel()


def _forms(column: Column, own: Mapping[str, float]) -> tuple[dict[Any, Any], dict[Any, Any]]:
    forms: tuple[dict[Any, Any], dict[Any, Any]] = column.kernel.forms(**own)["H"]
    return forms


def _axial_terms(column: Column) -> int:
    powers = [k for k, p, q in _forms(column, {})[0] if (p, q) in ((1, 1), (0, 1))]
    return max(powers, default=0) + 1


def _loads(column: Column, own: Mapping[str, float], terms: int) -> Array:
    """What acts on the beam per unit of P, read from the load's bilinear form H, (2 + 2 terms,).

    The transversal parts −c y′ of forces at the ends x = 0 and x = 1: of a follower force c is the axial force there,
    of a dead load 0. Then, ascending in powers of x, the axial force (compression), and the transversal part of a
    load along the beam.
    """
    along, points = _forms(column, own)
    ends = [float(points.get((a, 0, a, 1), 0)) for a in (0, 1)]
    axial = [-float(along.get((k, 1, 1), 0)) for k in range(terms)]
    follower = [float(along.get((k, 0, 1), 0)) for k in range(terms)]
    return np.array([*ends, *axial, *follower])


def _shapes(column: Column) -> Array:
    """Trial functions as Chebyshev series on 0 ≤ x ≤ 1, (MODES, terms). Eq. (22)."""
    terms = 128
    u = np.cos(np.pi * (np.arange(terms) + 0.5) / terms)
    values = np.asarray(column.kernel.shapes(column.basis(MODES), (u + 1) / 2), dtype=float)
    coefficients = _transformed(values.T, [terms - 1]).T
    size = np.abs(coefficients).max(axis=0)
    return coefficients[:, : int(np.flatnonzero(size > 1e-15 * size.max())[-1]) + 1]


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
