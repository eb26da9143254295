"""What describes a vehicle, read and checked: tables of stations and parts, and a TOML file that names the rest.

All is in SI units; a unit in a table's header, or with a number in the TOML file, is converted. Each error says where:
the file, the row as a spreadsheet counts them, and the column.
"""

from __future__ import annotations

import csv
import difflib
import io
import re
import tomllib
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal, NamedTuple

import numpy as np

from freebeam.vehicles.tabulated import Array, Part
from freebeam_sym.checks import InputError, finite

__all__ = ["SETTINGS", "Rows", "Stations", "described", "parts_of", "quantity", "stations_of", "tables_of"]

# Of each quantity its SI unit and what it is, in a few words.
STATION = {
    "x": ("m", "place of the station"),
    "EI": ("N m^2", "bending stiffness"),
    "m": ("kg/m", "mass per length"),
    "GA": ("N", "shear stiffness"),
    "J": ("kg m", "rotary inertia per length"),
}
PART = {
    "x": ("m", "place of the part"),
    "m": ("kg", "mass"),
    "J": ("kg m^2", "rotary inertia"),
    "k": ("N/m", "stiffness"),
    "c": ("N s/m", "damping"),
}
JOINT = {**PART, "k": ("N m/rad", "rotational stiffness"), "c": ("N m s/rad", "rotational damping")}
NEEDED = {"mass": ("m",), "sprung": ("m", "k"), "spring": ("k",), "joint": ("k",)}
TAKEN = {"mass": ("m", "J"), "sprung": ("m", "k", "c"), "spring": ("k", "c"), "joint": ("k", "c")}
# Of the settings beside tables and parts: unit and meaning.
SETTINGS: dict[str, tuple[str, str]] = {
    "thrust": ("N", "thrust at the largest x"),
    "load_max": ("N", "largest thrust to look at"),
    "imu": ("m", "place of the IMU"),
    "control": ("m", "place where a control force acts"),
    "gimbal.gain": ("", "gimbal angle per slope at the sensor, rad/rad"),
    "gimbal.rate": ("s", "gimbal angle per rate of the slope, s"),
    "gimbal.sensor": ("m", "place of the sensor"),
    "gimbal.actuator": ("rad/s", "natural frequency of the gimbal's actuator"),
    "gimbal.actuator_ratio": ("", "damping ratio of the actuator"),
    "damping.ratio": ("", "damping ratio of each elastic mode"),
    "damping.C_alpha": ("s", "internal damping"),
    "damping.C_beta": ("kg/(m s)", "external damping"),
}
WORDS = ("name", "stations", "parts", "interpolation")


@dataclass(frozen=True)
class Rows:
    """A table: columns of one length by name, None where a cell is empty; where: what an error calls a cell."""

    columns: Mapping[str, Sequence[Any]]
    where: Callable[[int, str], str]
    name: str

    def __len__(self) -> int:
        return len(next(iter(self.columns.values()), ()))


class Stations(NamedTuple):
    """x (s + 1,) in m, ascending; the others (s, 2) at both ends of each interval: EI (N m²), m (kg/m), GA (N) and
    J (kg m), None where the table has no such column."""

    x: Array
    EI: Array
    m: Array
    GA: Array | None
    J: Array | None


def described(source: Any) -> dict[str, Any]:
    """What a file, or columns by name, says of a vehicle: settings, and under `stations` and `parts` its tables.
    Raises InputError."""
    if isinstance(source, Mapping):
        return {"name": "vehicle", "stations": _given(source)}
    try:
        path = Path(source)
    except TypeError:
        raise InputError(
            f"vehicle: must be the path of a CSV or TOML file, or columns by name, not {type(source).__name__}"
        ) from None
    if path.suffix.lower() != ".toml":
        return {"name": path.stem, "stations": read_table(path)}
    try:
        found = tomllib.loads(_text(path))
    except tomllib.TOMLDecodeError as error:
        raise InputError(f"{path}: is no TOML: {error}") from None
    return _flat(path, found)


def tables_of(parts: Any) -> list[Rows]:
    """Tables of parts: none, the path of a CSV file, or columns by name. Raises InputError."""
    if parts is None:
        return []
    return [_given(parts, "parts") if isinstance(parts, Mapping) else read_table(Path(parts))]


def _flat(path: Path, found: Mapping[str, Any]) -> dict[str, Any]:
    """A TOML file's settings by dotted names, its tables read."""
    sections = {name.split(".")[0] for name in SETTINGS if "." in name}
    out: dict[str, Any] = {"name": path.stem, "file": path}
    tables: list[Rows] = []
    for key, value in found.items():
        if key == "stations":
            out[key] = read_table(path.parent / value) if isinstance(value, str) else _given(value, f"{path}, stations")
        elif key == "parts":
            table = read_table(path.parent / value) if isinstance(value, str) else _given(value, f"{path}, parts")
            tables.append(table)
        elif key in NEEDED:
            tables.append(_listed(path, key, value))
        elif key in sections:
            if not isinstance(value, Mapping):
                raise InputError(f"{path}: {key} = {value!r}: must be a table, [{key}]")
            for name, item in value.items():
                out[_known(path, f"{key}.{name}", SETTINGS)] = item
        else:
            out[_known(path, key, (*SETTINGS, *WORDS, *NEEDED, *sections))] = value
    if "stations" not in out:
        raise InputError(f'{path}: stations is missing: name a table, stations = "stations.csv"')
    return out | {"parts": tables}


def _known(path: Path, name: str, known: Iterable[str]) -> str:
    names = list(known)
    if name in names:
        return name
    near = difflib.get_close_matches(name, names, 1)
    raise InputError(
        f"{path}: {name} is not known" + (f" (did you mean {near[0]}?)" if near else f"; there are {', '.join(names)}")
    )


def _listed(path: Path, kind: str, value: Any) -> Rows:
    """Parts of one kind in a TOML file, [[kind]]."""
    entries = value if isinstance(value, list) else [value]
    if not all(isinstance(entry, Mapping) for entry in entries):
        raise InputError(f"{path}: {kind}: must be a list of tables, [[{kind}]]")
    names = dict.fromkeys(name for entry in entries for name in entry)
    columns = {name: [entry.get(name) for entry in entries] for name in names}
    return Rows(
        {"kind": [kind] * len(entries), **columns}, lambda row, name: f"{path}, {kind} {row + 1}, {name}", str(path)
    )


def _given(source: Any, name: str = "") -> Rows:
    """Columns by name, as sequences of one length."""
    if not isinstance(source, Mapping):
        raise InputError(f"{name or 'stations'}: must be the name of a table or columns by name")
    columns = {}
    for key, values in source.items():
        try:
            columns[str(key)] = np.asarray(values).ravel().tolist()
        except ValueError:
            raise InputError(f"{key}: must be a sequence of numbers") from None
    lengths = {key: len(values) for key, values in columns.items()}
    if len(set(lengths.values())) > 1:
        raise InputError("columns of different lengths: " + ", ".join(f"{k} has {n}" for k, n in lengths.items()))
    before = f"{name}, " if name else ""
    return Rows(columns, lambda row, key: f"{before}{key}[{row}]", name or "stations")


def _text(path: Path) -> str:
    try:
        return path.read_text(encoding="utf-8-sig")
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror})") from None
    except UnicodeDecodeError:
        raise InputError(f"{path}: is no text in UTF-8") from None


def read_table(path: Path) -> Rows:
    """A CSV file with a header, its numbers in SI units. Lines that begin with # are left out."""
    lines = [(row, cells) for row, cells in _cells(path) if any(cells)]
    if not lines:
        raise InputError(f"{path}: is empty; its header is x,EI,m")
    names, factors = [], []
    for place, text in enumerate(lines[0][1], 1):
        matched = re.fullmatch(r"([A-Za-z_]+)\s*(?:[\[(](.*)[\])])?", text)
        if matched is None:
            raise InputError(
                f"{path}, row {lines[0][0]}, column {place}: {text!r} is no name of a column, such as EI or EI [N m^2]"
            )
        names.append(matched[1])
        factors.append(matched[2])
    for name in names:
        if names.count(name) > 1:
            raise InputError(f"{path}, row {lines[0][0]}: the column {name} stands there twice")
    columns: dict[str, list[Any]] = {name: [] for name in names}
    rows: list[int] = []
    for row, cells in lines[1:]:
        if len(cells) != len(names):
            raise InputError(
                f"{path}, row {row}: has {len(cells)} cells where the header has {len(names)} ({', '.join(names)})"
            )
        rows.append(row)
        for name, text, unit in zip(names, cells, factors, strict=True):
            where = f"{path}, row {row}, column {name}"
            columns[name].append(_cell(text, where) if name != "kind" else text)
            if unit and isinstance(columns[name][-1], float):
                columns[name][-1] = (columns[name][-1], unit)
    return Rows(columns, lambda row, name: f"{path}, row {rows[row]}, column {name}", str(path))


def _cells(path: Path) -> Iterable[tuple[int, list[str]]]:
    reader = csv.reader(io.StringIO(_text(path)), strict=True)
    try:
        for cells in reader:
            if not (cells and cells[0].lstrip().startswith("#")):
                yield reader.line_num, [cell.strip() for cell in cells]
    except csv.Error as error:
        raise InputError(f"{path}, row {reader.line_num}: is no CSV: {error}") from None


def _cell(text: str, where: str) -> float | None:
    if not text:
        return None
    try:
        return float(text)
    except ValueError:
        raise InputError(f"{where}: {text!r} is not a number") from None


def quantity(where: str, value: Any, unit: str, meaning: str) -> float:
    """A finite number in an SI unit, from a number that is so, (number, unit), or text such as "1.2 MN"."""
    if isinstance(value, str):
        matched = re.fullmatch(r"\s*([-+0-9.eE]+)\s*(.*)", value)
        try:
            value = (float(matched[1]), matched[2].strip()) if matched else None
        except ValueError:
            value = None
        if value is None:
            raise InputError(f"{where}: must be a number{f' in {unit}' if unit else ''} ({meaning})")
    if isinstance(value, tuple):
        number, given = value
        value = number * (_factor(where, given, unit, meaning) if given else 1.0)
    return finite(where, value, f"{meaning}{f', {unit}' if unit else ''}")


def _plain(unit: str) -> str:
    """A unit as it is compared: N·m², N*m**2 and N m^2 are one."""
    return re.sub(r"[\s*·]", "", unit.replace("**", "^").replace("²", "^2")).replace("^", "")


def _factor(where: str, given: str, unit: str, meaning: str) -> float:
    """What turns a unit that was given into the SI unit. Raises InputError where it does not fit."""
    if _plain(given) == _plain(unit):
        return 1.0
    try:
        import pint
    except ImportError:
        raise InputError(
            f"{where}: the unit {given} is not {unit or '1'} ({meaning}); give it in SI units, or convert units with "
            "pint: pip install 'freebeam[units]'"
        ) from None
    units = pint.application_registry
    try:
        return float(units.Quantity(1.0, given).to(unit or "dimensionless").magnitude)
    except Exception as error:  # whatever pint makes of a text that is no unit
        why = "is no unit" if isinstance(error, pint.UndefinedUnitError) else f"does not fit {unit or 'a number'}"
        raise InputError(f"{where}: the unit {given} {why} ({meaning})") from None


def _value(table: Rows, row: int, name: str, known: Mapping[str, tuple[str, str]]) -> float:
    value = table.columns[name][row]
    if value is None:
        raise InputError(f"{table.where(row, name)}: is empty; each station needs a number ({known[name][1]})")
    return quantity(table.where(row, name), value, *known[name])


def stations_of(table: Rows, interpolation: object) -> Stations:
    """Stations, checked. interpolation: "linear" between stations, where one that is given twice is a step, or
    "steps": what stands at a station holds up to the next. Raises InputError."""
    if interpolation not in ("linear", "steps"):
        raise InputError(f'interpolation = {interpolation!r}: must be "linear" or "steps"')
    for name in table.columns:
        if name not in STATION:
            raise InputError(f"{table.name}: the column {name} is not known; there are {', '.join(STATION)}")
    missing = [name for name in ("x", "EI", "m") if name not in table.columns]
    if missing:
        raise InputError(f"{table.name}: the column {missing[0]} is missing; a table of stations has the header x,EI,m")
    if len(table) < 2:
        raise InputError(
            f"{table.name}: has {len(table)} station{'s' * (len(table) != 1)}; a vehicle needs two or more"
        )
    values = {name: [_value(table, row, name, STATION) for row in range(len(table))] for name in table.columns}
    for name in ("EI", "GA", "m", "J"):
        positive = name in ("EI", "GA")
        for row, value in enumerate(values.get(name, ())):
            if value < 0 or (positive and value == 0):
                rule = "greater than zero" if positive else "zero or greater"
                raise InputError(f"{table.where(row, name)} = {value:g}: must be {rule} ({STATION[name][1]})")
    _check_order(table, values, interpolation == "steps")
    x = np.array(values["x"])
    there = np.diff(x) > 0
    ends = {
        name: np.stack([(a := np.array(v))[:-1], a[:-1] if interpolation == "steps" else a[1:]], axis=1)[there]
        for name, v in values.items()
    }
    return Stations(np.append(x[:-1][there], x[-1]), ends["EI"], ends["m"], ends.get("GA"), ends.get("J"))


def _check_order(table: Rows, values: Mapping[str, Sequence[float]], steps: bool) -> None:
    x, m = values["x"], values["m"]
    for row in range(1, len(x)):
        if x[row] < x[row - 1] or (x[row] == x[row - 1] and (steps or row in (1, len(x) - 1) or x[row - 2] == x[row])):
            cure = "" if x[row] < x[row - 1] or steps else "; a station may be given twice, for a step, between others"
            raise InputError(
                f"{table.where(row, 'x')} = {x[row]:g}: must be greater than {x[row - 1]:g} at the station before{cure}"
            )
        if m[row - 1] == 0 and (steps or m[row] == 0):
            raise InputError(
                f"{table.where(row - 1, 'm')} = 0: the vehicle has no mass from there to the next station; give the "
                "structure's own mass per length"
            )


def parts_of(tables: Iterable[Rows], low: float, high: float) -> tuple[Part, ...]:
    """Parts of a vehicle that reaches from x = low to high, in SI units. Raises InputError."""
    found: list[Part] = []
    for table in tables:
        for name in table.columns:
            if name not in ("kind", *PART):
                raise InputError(f"{table.name}: the column {name} is not known; there are kind, {', '.join(PART)}")
        if "x" not in table.columns:
            raise InputError(f"{table.name}: the column x is missing; a table of parts has the header kind,x,m,J,k,c")
        found += [_part(table, row, low, high) for row in range(len(table))]
    return tuple(sorted(found, key=lambda part: part.x))


def _part(table: Rows, row: int, low: float, high: float) -> Part:
    kind: Any = table.columns["kind"][row] if "kind" in table.columns else "mass"
    if kind not in NEEDED:
        raise InputError(f"{table.where(row, 'kind')} = {kind!r}: must be one of {', '.join(NEEDED)}")
    known = JOINT if kind == "joint" else PART
    given = {
        name: quantity(table.where(row, name), table.columns[name][row], *known[name])
        for name in PART
        if name in table.columns and table.columns[name][row] is not None
    }
    for name, value in given.items():
        if name != "x" and value < 0:
            raise InputError(f"{table.where(row, name)} = {value:g}: must be zero or greater ({known[name][1]})")
        if name != "x" and value and name not in TAKEN[kind]:
            takes = " and ".join(TAKEN[kind])
            raise InputError(f"{table.where(row, name)} = {value:g}: a {kind} has {takes}, and no {known[name][1]}")
    for name in ("x", *NEEDED[kind]):
        if name not in given or (name != "x" and not given[name]):
            raise InputError(
                f"{table.where(row, name)}: is missing; a {kind} needs its {known[name][1]}, {known[name][0]}"
            )
    x = given["x"]
    if not low <= x <= high or (kind == "joint" and x in (low, high)):
        rule = "inside the vehicle, between" if kind == "joint" else "on the vehicle, from"
        to = "and" if kind == "joint" else "to"
        raise InputError(f"{table.where(row, 'x')} = {x:g}: a {kind} must lie {rule} {low:g} {to} {high:g} m")
    place: Literal["mass", "sprung", "spring", "joint"] = kind
    return Part(place, x, given.get("m", 0.0), given.get("J", 0.0), given.get("k", 0.0), given.get("c", 0.0))
