"""A drawing of any column from its statement: ends, section, loads, masses, springs, dampers, joints and sensors."""

from __future__ import annotations

import math
from collections.abc import Callable
from itertools import pairwise
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from freebeam.figures import sketch
from freebeam.figures.look import ACCENT, INK, MUTED, drawing
from freebeam.figures.marks import arrow, colour, symbol
from freebeam.vehicles.tabulated import Tabulated
from freebeam_sym.checks import InputError, positions
from freebeam_sym.kernels import is_kernel, read_source
from freebeam_sym.spectra import spectrum

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from freebeam_derive.drawn import Parts
    from freebeam_derive.statement import Column as Statement
    from freebeam_sym.columns import Column

__all__ = ["beam", "centre_line"]

Array = np.ndarray[Any, np.dtype[np.float64]]


class Piece(NamedTuple):
    """A segment of the beam as it is drawn, (n,) each: place, height and slope."""

    x: Array
    y: Array
    slope: Array


def beam(
    column: Column, *, x_s: float | None = 0.15, x_F: float | None = 0.7, ax: Axes | None = None, **parameters: Any
) -> Axes:
    """The column bent as in its lowest mode without load, with all that its statement holds: ends, section, the load
    with the direction that it keeps, masses, springs, dampers, joints, and sensors that steer a force. A chain of links
    is drawn at rest but for a turn.

    x_s, x_F: where the sensor and the transversal force are drawn; None leaves one out, and a column without a
    transversal force has neither. parameters: the column's own.

    Raises InputError for places off the beam, unknown parameters, a kernel's file, which holds no statement, and
    coordinates that are neither a beam with a deflection y nor a chain of links.
    """
    own = column.own_parameters(parameters)
    tables: Any = column.kernel if isinstance(column.kernel, Tabulated) else None
    stated = None if tables else _statement(column)
    if "y" not in column.fields:
        return _links(column, stated, own, ax)
    places = {name: x for name, x in (("x_s", x_s), ("x_F", x_F)) if column.forced and x is not None}
    for name, place in places.items():
        positions(name, place)
    pieces = centre_line(column, **parameters)
    parts, ends, depths = _of_tables(tables) if stated is None else _of_statement(stated, own)
    with drawing(ax, (6.4, 2.7)) as ax:
        _draw(ax, pieces, parts, ends, depths)
        if "x_s" in places:
            sketch.sensor(ax, places["x_s"], _at(pieces, places["x_s"])[0])
        if "x_F" in places:
            sketch.transversal(ax, symbol(column, "F_0"), places["x_F"], _at(pieces, places["x_F"])[0])
        lowest = _lowest(pieces, parts)
        if places:
            sketch.measures(ax, places, lowest - 0.1)
        sketch.frame(ax)
        ax.set_xlim(-0.24, 1.36)
        top = max(0.0, *(piece.y.max() for piece in pieces), 0.18 * (parts.load == "outside"))
        ax.set_ylim(lowest - 0.05 - 0.06 * (len(places) + 1) * bool(places), top + 0.16)
    return ax


def _statement(column: Column) -> Statement:
    """What a column is derived from. Raises InputError where it is a kernel's file alone."""
    from freebeam_derive import pipeline
    from freebeam_derive.statement import load_column

    path = column.path
    if path is None and column.kernel.__name__.startswith("freebeam_kernels."):
        path = pipeline.known()[column.name]
    if path is None or is_kernel(read_source(path)[1]):
        raise InputError(
            f"{column.name}: is a kernel, and a column is drawn from the statement that it was derived from; give the "
            "column's file"
        )
    return load_column(path)


Depths = Callable[[Array], Array]


def _of_statement(stated: Statement, own: dict[str, float]) -> tuple[Parts, tuple[str, str], Depths]:
    from freebeam_derive.drawn import depths, parts_of

    values = {p.symbol: own[p.name] for p in stated.parameters}
    return parts_of(stated, values), stated.supports("y"), lambda x: np.array(depths(stated, x.tolist(), values))


def _of_tables(kernel: Tabulated) -> tuple[Parts, tuple[str, str], Depths]:
    """Of a column of tables, such as a vehicle, which has no statement."""
    from freebeam_derive.drawn import Parts

    parts = Parts("$P$", loads=[(1.0, "$P$", 1.0)], sensors=[] if kernel.law is None else [(kernel.law.sensor, 1.0)])
    for part in kernel.parts:
        if part.kind == "joint":
            parts.jumps[1, part.x] = ""
        elif part.kind == "mass":
            (parts.masses if part.mass else parts.inertias).append((part.x, ""))
        else:
            (parts.absorbers if part.kind == "sprung" else parts.springs).append((part.x, ""))
    table = kernel.table

    def depths(x: Array) -> Array:
        k = np.clip(np.searchsorted(table.x, x, "right") - 1, 0, len(table.x) - 2)
        share = (x - table.x[k]) / (table.x[k + 1] - table.x[k])
        bending = (1 - share) * table.bending[k, 0] + share * table.bending[k, 1]
        return np.asarray((bending / table.bending.max()) ** (1 / 3))

    return parts, ("free", "free"), depths


def centre_line(column: Column, points: int = 400, **parameters: Any) -> list[Piece]:
    """The beam as it is drawn, segment by segment, so many points in all: its lowest mode without load; where both ends
    are free, and nothing holds the beam, turned a little."""
    system = column.system(None, 0.0, **parameters)
    found = spectrum(system)
    values = found.eigenvalues
    swings = np.where(values.imag > 1e-9 * np.abs(values).max(), np.abs(values), np.inf)
    vector = found.vectors[:, int(swings.argmin())][: len(system.M)]
    vector = vector * np.exp(-1j * np.angle(vector[np.abs(vector).argmax()]))
    breaks = [0.0, 1.0]
    if column.general:
        with column._sound_places():
            breaks = [float(place) for place in column.kernel.places(1.0, **column.own_parameters(parameters))]
    pieces = []
    for low, high in pairwise(breaks):
        x = np.linspace(low, high, max(int(points * (high - low)) + 1, 12))
        inner = np.clip(x, low + 1e-9, high - 1e-9) if column.general else x
        pieces.append(Piece(x, *((vector @ system.shapes(inner, order, "y")).real for order in (0, 1))))
    y = np.concatenate([piece.y for piece in pieces])
    top = float(np.abs(y).max()) or 1.0
    decides = y[-1] if abs(y[-1]) > 1e-6 * top else y[np.abs(y).argmax()]
    scale = math.copysign(0.1 if "free" in column.ends else 0.07, decides) / top
    turn = 0.06 if column.rigid_count > 1 else 0.0
    return [Piece(x, scale * y + turn * (x - 0.5), scale * slope + turn) for x, y, slope in pieces]


def _at(pieces: list[Piece], place: float) -> tuple[float, float]:
    """Height and slope at a place, of the segment left of it."""
    piece = next(piece for piece in pieces if place <= piece.x[-1] + 1e-12)
    return float(np.interp(place, piece.x, piece.y)), float(np.interp(place, piece.x, piece.slope))


def _lowest(pieces: list[Piece], parts: Parts) -> float:
    """How low the drawing reaches: 0.2 below the beam where something hangs on it or stands on the ground."""
    below = parts.springs or parts.dampers or parts.absorbers or parts.foundation
    return min(0.0, *(float(piece.y.min()) for piece in pieces)) - 0.2 * bool(below)


def _draw(ax: Axes, pieces: list[Piece], parts: Parts, ends: tuple[str, str], depths: Depths) -> None:
    ax.set_aspect("equal")
    ax.axis("off")
    ax.plot([-0.06, 1.02], [0, 0], color=MUTED, lw=0.8, ls=(0, (6, 3)), zorder=1)
    half = depths(np.concatenate([np.clip(piece.x, piece.x[0] + 1e-9, piece.x[-1] - 1e-9) for piece in pieces]))
    half = half * sketch.HALF * (1.0 if half.min() > 1 - 1e-9 else 2.2)  # what varies is to be seen
    opened = {place for _, place in parts.jumps}
    cuts = [0, *(k for k in range(1, len(pieces)) if float(pieces[k].x[0]) in opened), len(pieces)]
    ends_at = np.cumsum([0, *(len(piece.x) for piece in pieces)])
    line = [np.concatenate(part) for part in zip(*pieces, strict=True)]
    for k, n in pairwise(int(ends_at[cut]) for cut in cuts):
        x, y, slope = (part[k:n] for part in line)
        sketch.body(ax, x, y, slope, half[k:n])
    for end, piece, k, side in ((0, pieces[0], 0, -1), (1, pieces[-1], -1, 1)):
        sketch.support(ax, ends[end], float(piece.x[k]), float(piece.y[k]), side)
    _on_the_beam(ax, pieces, parts)
    _below_the_beam(ax, pieces, parts, _lowest(pieces, parts) + 0.04)
    _loads(ax, pieces, parts)


def _on_the_beam(ax: Axes, pieces: list[Piece], parts: Parts) -> None:
    for place, name in parts.masses:
        sketch.mass(ax, place, _at(pieces, place)[0], name)
    for place, name in parts.inertias:
        y, _ = _at(pieces, place)
        ax.plot([place], [y], "o", mfc="none", mec=INK, ms=17, zorder=6)
        ax.text(place - 0.05, y - 0.05, name, ha="right", va="top", fontsize=11)
    for place, name in parts.turning:
        sketch.spiral(ax, place, _at(pieces, place)[0], name)
    for (order, place), name in parts.jumps.items():
        sketch.joint(ax, place, _at(pieces, place)[0], order, name)
    for seen, moved in parts.sensors:
        (y, _), (other, _) = _at(pieces, seen), _at(pieces, moved)
        sketch.sensor(ax, seen, y)
        arrow(ax, (seen, y - 0.03), (moved, other - 0.03), colour(3), 0.9, 8, zorder=2)


def _below_the_beam(ax: Axes, pieces: list[Piece], parts: Parts, bottom: float) -> None:
    beside = 0.03 * bool({place for place, _ in parts.springs} & {place for place, _ in parts.dampers})
    for place, name in parts.springs:
        sketch.spring(ax, place - beside, _at(pieces, place)[0], bottom, name if not beside else "")
    for place, name in parts.dampers:
        sketch.dashpot(ax, place + beside, _at(pieces, place)[0], bottom, name)
    for place, name in parts.absorbers:
        sketch.absorber(ax, place, _at(pieces, place)[0], bottom, name)
    if parts.foundation:
        for place in np.linspace(0.08, 0.96, 9):
            sketch.spring(ax, float(place), _at(pieces, float(place))[0], bottom, "", 0.008)
        ax.text(1.0, bottom, parts.foundation, fontsize=11, va="center")
    if parts.medium:
        low, high, name = parts.medium
        for x, y, _ in pieces:
            ax.fill_between(
                x, y - 0.075, y + 0.075, where=(x >= low - 1e-9) & (x <= high + 1e-9), color="#E4E4E4", lw=0, zorder=0
            )
        ax.text((low + high) / 2, _at(pieces, (low + high) / 2)[0] + 0.09, name, fontsize=11, ha="center")


def _loads(ax: Axes, pieces: list[Piece], parts: Parts) -> None:
    """The load: at places with its direction, or along the beam; and a load of the column's own."""
    tip, _ = _at(pieces, 1.0)
    name, spread = parts.weight
    for place in np.linspace(0.1, 0.97, 7) if spread else [1.0] * bool(name):
        y, _ = _at(pieces, float(place))
        sketch.push(ax, (place + (0.05 if spread else 0.14), y - 0.035), (place, y - 0.035), MUTED, 1.2)
    ax.text(1.16, tip - 0.04, name, color=MUTED, va="center", fontsize=12)
    if parts.fixed_line:
        sketch.push(ax, (1.24, 0.0), (1.02, 0.0), width=2.2)
        ax.plot([1.0, 1.0], [0.0, tip], color=INK, lw=2.0)
        ax.text(1.26, 0.0, parts.symbol, color=ACCENT, va="center", fontsize=13)
        return
    for place, letters, follows in parts.loads:
        y, slope = _at(pieces, place)
        sketch.force(ax, np.array([place, y]), math.atan(follows * slope), letters, follows, slope)
    if not parts.loads:
        _along(ax, pieces, parts, tip)


def _along(ax: Axes, pieces: list[Piece], parts: Parts, tip: float) -> None:
    """A load along the beam: a flow inside or outside, or forces that are spread, with their direction."""
    at = (1.06, tip + 0.03)
    if parts.load == "inside":
        for start in (0.1, 0.42, 0.74):
            low, high = _at(pieces, start)[0], _at(pieces, start + 0.2)[0]
            sketch.push(ax, (start, low), (start + 0.2, high), width=1.2)
        at = (1.04, tip)
    elif parts.load == "outside":
        for up in (0.17, 0.24):
            for start in (0.05, 0.55):
                sketch.push(ax, (start, up), (start + 0.3, up), width=1.2)
        at = (1.04, 0.2)
    elif parts.load in ("follower", "axis"):
        for place in np.linspace(0.1, 0.97, 7):
            y, slope = _at(pieces, float(place))
            rise = 0.06 * slope * (parts.load == "follower")
            sketch.push(ax, (place + 0.06, y + rise + 0.03), (place, y + 0.03), width=1.2)
    ax.text(*at, parts.symbol, color=ACCENT, va="center", fontsize=12)


def _links(column: Column, stated: Statement | None, own: dict[str, float], ax: Axes | None) -> Axes:
    """A chain of rigid links, one for each coordinate, under a force at its end."""
    from freebeam_derive.drawn import chain

    values = {p.symbol: own[p.name] for p in stated.parameters} if stated else {}
    found = chain(stated, values) if stated and not stated.fields else None
    if found is None:
        raise InputError(f"{column.name}: has no deflection y along a beam to draw, and is no chain of links")
    names, lengths, follows = found
    angles = np.linspace(0.12, 0.3, len(names))
    steps = np.array(lengths)[:, None] * np.stack([np.cos(angles), np.sin(angles)], 1)
    points = np.concatenate([[[0.0, 0.0]], np.cumsum(steps, 0)])
    with drawing(ax, (6.4, 2.7)) as ax:
        ax.set_aspect("equal")
        ax.axis("off")
        sketch.support(ax, "clamped", 0.0, 0.0, -1)
        ax.plot([-0.06, 1.02], [0, 0], color=MUTED, lw=0.8, ls=(0, (6, 3)), zorder=1)
        ax.plot(points[:, 0], points[:, 1], color=INK, lw=3.0, zorder=4)
        for (x, y), step, name in zip(points, steps, names, strict=False):
            sketch.spiral(ax, x, y, "")
            ax.plot([x], [y], "o", color="white", mec=INK, ms=6, zorder=6)
            ax.text(x + 0.4 * step[0], y + 0.4 * step[1] + 0.03, name, fontsize=11, va="bottom", ha="right")
        for x, y in points[1:]:
            ax.plot([x], [y], "o", color=INK, ms=10, zorder=7)
        angle = math.atan(follows * math.tan(angles[-1]))
        sketch.force(ax, points[-1], angle, symbol(column, "P"), follows, 0.0)
        ax.set_xlim(-0.24, 1.36)
        ax.set_ylim(-0.1, 0.42)
    return ax
