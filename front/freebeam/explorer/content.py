"""What the page is told of a column beside its kernel: names, parameters, the start of its controls. Nondimensional."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from freebeam_sym.checks import InputError

if TYPE_CHECKING:
    from freebeam_derive.statement import Column as Statement
    from freebeam_sym.columns import Column

__all__ = ["content", "statement_of"]

MODES = 16
"""Largest number N of functions that a page shows, of a field and a segment where there are several."""
COORDINATES = 40
"""Most coordinates of a system that a page looks for flutter in; its eigenvalues then take some 10 ms a load."""
LOAD_MAX = 1000.0
"""Loads are searched up to here, as by `critical_load`."""
CASE = {"alpha": 1e-3, "beta": 0.1}
"""Dampings of the case that a page opens with, where the column has them: Section 4.4."""
FLOWS = ("inside", "outside")
"""Loads that are no forces, so that their size in SI units is none of EI/L²."""


def content(column: Column) -> dict[str, Any]:
    """What a page is told, as JSON has it.

    Raises InputError where the column needs more coordinates than a page bears, and for a general column whose
    statement is not at hand.
    """
    from freebeam_sym.spectra import spectrum

    alpha, beta = (CASE[name] if name in dampings(column) else 0.0 for name in ("alpha", "beta"))
    fields, coordinates = _unknowns(column)
    drawn = _drawn(column)
    N, most = min(8, MODES), _most(column)
    first = _first_load(column, min(N, most), alpha, beta)
    span = _nice(1.6 * first) if first else LOAD_MAX
    start = 0.4 * span
    frequency = float(np.abs(spectrum(column.system(min(N, most), start)).eigenvalues).min())
    return {
        "name": column.name,
        "title": column.title,
        "basis": column.basis_name,
        "general": column.general,
        "load_unit": column.load_unit,
        "ends": list(column.ends) or ["pinned", "free"],
        "rigid": column.rigid_count,
        "damping": list(dampings(column)),
        "forced": column.forced,
        "parameters": [
            {"name": p.name, "symbol": _symbol(p.name), "meaning": p.meaning, "default": p.default, "low": p.low,
             "high": p.high}
            for p in column.parameters
        ],
        "reads": [*(_read(letter) for letter in fields), *(f"coordinate {letter}" for letter in coordinates)],
        "links": 0 if fields else len(coordinates),
        "drawn": drawn,
        "si": bool(column.load_unit) and not column.kernel.scales.__kwdefaults__,
        "least": int(column.kernel.COLUMN.get("least", 1)),
        "modes": most,
        "load_range": span,
        "load_max": LOAD_MAX,
        "start": {
            "P": start, "alpha": alpha, "beta": beta, "N": min(N, most), "sensor": _far(column), "place": _far(column),
            "rate": float(f"{frequency:.3g}"),
        },
    }  # fmt: skip


def dampings(column: Column) -> tuple[str, ...]:
    """Those of alpha and beta that a page has a control of: not one that couples rigid motions to bending."""
    return tuple(name for name in column.damping if name not in column.kernel.COLUMN.get("coupled", ()))


def _unknowns(column: Column) -> tuple[list[str], list[str]]:
    """Letters of the fields and of the coordinates of time alone."""
    stated = column.kernel.COLUMN
    if not column.general:
        return ["y"], []
    fields, coordinates = ([_letter(each) for each in stated[kind]] for kind in ("fields", "coordinates"))
    return fields, coordinates


def _letter(unknown: dict[str, str]) -> str:
    """The letter of a field or a coordinate without LaTeX, as far as that goes: φ₁; else its name."""
    import re

    text = re.sub(r"\\(?:var)?([a-z]+)", lambda found: _symbol(found[1]), unknown["latex"])
    text = re.sub(r"_\{?(\d)\}?", lambda found: chr(0x2080 + int(found[1])), text)
    return unknown["name"] if set(text) & set("\\{}_^") else text


def _read(letter: str) -> str:
    return "deflection y" if letter == "y" else f"field {letter}"


def _far(column: Column) -> float:
    """A place that moves: near the left end where that is free, else near the right one."""
    return 0.1 if not column.ends or column.ends[0] == "free" else 1.0 if column.ends[-1] == "free" else 0.4


def _most(column: Column) -> int:
    """The largest N that a page shows. Raises InputError where even the least has too many coordinates."""
    if not column.general:
        return MODES
    least = int(column.kernel.COLUMN["least"])
    sizes = {N: int(column.basis(N).size) for N in (least, least + 1)}
    step = max(1, sizes[least + 1] - sizes[least])
    most = min(MODES, least + (COORDINATES - sizes[least]) // step)
    if most < least:
        raise InputError(
            f"{column.name}: has {sizes[least]} coordinates at the least, and a page searches systems of up to "
            f"{COORDINATES}; freebeam critical takes it"
        )
    return most


def _first_load(column: Column, modes: int, alpha: float, beta: float) -> float | None:
    """The first loss without α and β, or with those of the case where it grows at once without; None for none."""
    from freebeam.maps.known import critical_load

    for dampings in ((0.0, 0.0), (alpha, beta)):
        try:
            return critical_load(column, modes, *dampings).load
        except InputError:  # something grows at the smallest loads
            continue
    return None


def statement_of(column: Column) -> Statement:
    """The statement that a column's kernel is emitted from.

    Raises InputError for a column of which only an emitted kernel is at hand.
    """
    from freebeam_derive import pipeline
    from freebeam_derive.statement import StatementError
    from freebeam_sym.kernels import is_kernel, read_source

    target: str | Path = column.name
    if not column.kernel.__name__.startswith("freebeam_kernels."):
        if column.path is None or is_kernel(read_source(column.path)[1]):
            raise InputError(
                f"{column.path or column.name}: a page runs the column's kernel in JavaScript, which is emitted from "
                "its statement; give the file of the statement"
            )
        target = column.path
    try:
        return pipeline.find(target)
    except StatementError as error:
        raise InputError(str(error)) from error


def _drawn(column: Column) -> dict[str, Any]:
    """What there is to draw of a general column; a textbook's load is read from its form. A place is a number, or the
    number of a break, which parameters move."""
    from freebeam_derive.drawn import parts_of

    statement = statement_of(column)
    parts = parts_of(statement)
    flow = parts.load in FLOWS
    if not column.general:
        return {"marks": [], "flow": flow, "sensors": False}
    breaks = [float(place.subs(statement.defaults)) for place in statement.energies.beam.places]

    def at(place: float) -> Any:
        inner = [k for k, known in enumerate(breaks) if known == place and 0 < k < len(breaks) - 1]
        return {"break": inner[0]} if inner else place

    grounds = [*parts.springs, *parts.dampers]
    names = {f"${p.latex}$": p.name for p in column.parameters}  # what is of size 0 is not there
    marks = [
        *(["mass", at(place), names.get(letter, "")] for place, letter in (*parts.masses, *parts.absorbers)),
        *(["joint", at(place), ""] for _, place in parts.jumps),
        *(["ground", at(place), names.get(letter, "")] for place, letter in grounds),
    ]
    followers = [place for place, _, share in parts.loads if share]
    spread = parts.load in ("follower", "axis") and not followers
    dead = not (flow or spread or followers or statement.coordinates)
    followers = followers if statement.fields else [1.0]
    return {
        "marks": marks,
        "flow": flow,
        "sensors": bool(parts.sensors),
        "followers": [at(place) for place in followers],
        "axial": [1.0, -1.0] if spread else [1.0] if dead else [0.0],
        "along": [1.0] if spread and parts.load == "follower" else [0.0],
    }


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
