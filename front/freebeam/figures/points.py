"""A drawing of a column of segments: what stands at its places is read off the forms of its matrices."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from freebeam.figures import sketch
from freebeam.figures.look import ACCENT, INK, MUTED, drawing
from freebeam.figures.marks import arrow, colour, symbol
from freebeam_sym.checks import InputError, positions
from freebeam_sym.spectra import spectrum

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from freebeam_sym.columns import Column

__all__ = ["Parts", "beam", "parts"]

SMALL = 1e-12


@dataclass(frozen=True)
class Parts:
    """What is at places along a column, at given parameters: breaks, 0 and 1 with them; places of masses, and of
    springs and dampers to the ground or to a coordinate; loads (place, force in units of P, share that follows the
    slope); whether the axial force changes between them; sensors (place of the sensor, place of the force)."""

    breaks: tuple[float, ...]
    masses: tuple[float, ...] = ()
    springs: tuple[float, ...] = ()
    dampers: tuple[float, ...] = ()
    loads: tuple[tuple[float, float, float], ...] = ()
    spread: bool = False
    sensors: tuple[tuple[float, float], ...] = ()
    joints: Mapping[float, int] = field(default_factory=dict)
    """Break -> order of what may jump there: 1 for the slope, 0 for the deflection."""


def parts(column: Column, **parameters: Any) -> Parts:
    """What stands at places, from the forms of M, C and K; where a factor is no polynomial the breaks and joints alone.

    Raises InputError for unknown parameters.
    """
    own = column.own_parameters(parameters)
    kernel = column.kernel
    with column._sound_places():
        breaks = tuple(float(place) for place in kernel.places(1.0, **own))
    joints: dict[float, int] = {}
    for _, _, opened in kernel.FIELDS.values():
        for number, order in opened:
            joints[breaks[number]] = min(order, joints.get(breaks[number], 1))
    if not hasattr(kernel, "forms"):
        return Parts(breaks, joints=joints)
    forms = kernel.forms(1.0, 1.0, 1.0, **own)
    masses, dampers, springs = (_on_the_diagonal(forms[letter][:1]) for letter in "MCK")
    rows = forms["K"][1][1] if len(forms["K"]) > 1 else []
    loads, spread = _loads(breaks, forms["K"][1:2], rows)
    return Parts(breaks, masses, springs, dampers, loads, spread, _sensors(forms), joints)


def _on_the_diagonal(powers: Any) -> tuple[float, ...]:
    """Places at which a form has a square of the deflection or the slope; inner springs, which see a jump, are none."""
    places = set()
    for _, points in powers:
        for test, trial, factor in points:
            if test == trial and test[2] is not None and not test[3] and abs(factor) > SMALL:
                places.add(float(test[2]))
    return tuple(sorted(places))


def _loads(breaks: tuple[float, ...], powers: Any, rows: Any) -> tuple[tuple[tuple[float, float, float], ...], bool]:
    """Where the axial force of the load falls, by how much, and how much of that follows the slope; and whether it
    changes along a segment."""
    axial = np.zeros((len(breaks) - 1, 2))  # at both ends of each segment
    spread = False
    for along, _ in powers:
        for segments, test, p, trial, q, factors in along:
            if (test, p, trial, q) != ("y", 1, "y", 1):
                continue
            spread = spread or any(abs(f) > SMALL for f in factors[1:])
            for segment in segments:
                axial[segment] -= [np.polyval(factors[::-1], breaks[segment + side]) for side in (0, 1)]
    found = []
    for number, place in enumerate(breaks):
        before = axial[number - 1, 1] if number else 0.0
        after = axial[number, 0] if number < len(axial) else 0.0
        if before - after > SMALL and number:
            turned = sum(
                factor
                for test, trial, factor in rows
                if test[:2] == ("y", 0) and _at(test, place) and _at(trial, place) and _turns(trial)
            )
            found.append((place, float(before - after), float(turned / (before - after))))
    return tuple(found), spread


def _turns(value: Any) -> bool:
    """Whether it is a slope, or another field, which is an angle."""
    return bool(value[:2] == ("y", 1) or (value[0] != "y" and value[1] == 0))


def _at(value: Any, place: float) -> bool:
    return value[2] is not None and abs(float(value[2]) - place) < 1e-9


def _sensors(forms: Any) -> tuple[tuple[float, float], ...]:
    """Pairs of places: a force at the second that what is measured at the first steers, and not the reverse."""
    found = set()
    for letter in "CK":
        for _, points in forms[letter]:
            table = {(test, trial): factor for test, trial, factor in points}
            for (test, trial), factor in table.items():
                here, there = test[2], trial[2]
                mirrored = table.get((trial, test), 0.0)
                if None in (here, there) or abs(here - there) < 1e-9 or abs(factor - mirrored) < SMALL:
                    continue
                found.add((float(there), float(here)))
    return tuple(sorted(found))


def beam(
    column: Column, *, x_s: float | None = 0.15, x_F: float | None = 0.7, ax: Axes | None = None, **parameters: Any
) -> Axes:
    """The column deflected as in its lowest mode: ends, load with the direction that it keeps, force and sensor.

    x_s, x_F: where the sensor and the transversal force are drawn; None leaves one out, as does a column without a
    transversal force. The load's direction is read off the end's condition (a follower is normal to the
    cross-section). A column of segments also shows its hinges, cracks, masses, springs and dampers, the places at which
    loads act, and sensors that steer a force. Raises InputError for places off the beam, unknown parameters, and a
    column without a deflection along a beam.
    """
    if not column.general:
        return sketch.beam(column, x_s=x_s, x_F=x_F, ax=ax, **parameters)
    if "y" not in [each["name"] for each in column.kernel.COLUMN["fields"]]:
        raise InputError(f"{column.name}: has no deflection y along a beam to draw")
    there = parts(column, **parameters)
    places = {"x_s": x_s, "x_F": x_F} if column.forced else {}
    for name, place in places.items():
        if place is not None:
            positions(name, place)
    line = _line(column, there, parameters)
    with drawing(ax, (6.4, 2.7)) as ax:
        ax.set_aspect("equal")
        ax.axis("off")
        ax.plot([-0.06, 1.02], [0, 0], color=MUTED, lw=0.8, ls=(0, (6, 3)), zorder=1)
        for x, y, slope in line:
            sketch.body(ax, x, y, slope)
        for end, (x, y, _), k, side in ((0, line[0], 0, -1), (1, line[-1], -1, 1)):
            sketch.support(ax, column.ends[end], float(x[k]), float(y[k]), side)
        _things(ax, there, line, [x_s] if places.get("x_s") is not None else [])
        letter = symbol(column, "P")
        for place, force, follows in there.loads:
            _, y, slope = _there(line, place)
            name = letter if abs(force - 1) < 1e-9 else f"{force:.3g} {letter}"
            sketch.force(ax, np.array([place, y]), math.atan(follows * slope), name, follows, slope)
        if there.spread and not there.loads:
            _spread(ax, line, letter)
        if (x_F := places.get("x_F")) is not None:
            sketch.transversal(ax, column, x_F, _there(line, x_F)[1])
        low, high = (f(f(y) for _, y, _ in line) for f in (min, max))
        ax.set_xlim(-0.24, 1.28)
        ax.set_ylim(min(low, 0.0) - 0.24, max(high, 0.0) + 0.16)
        sketch.frame(ax)
    return ax


def _line(column: Column, there: Parts, parameters: Any) -> list[tuple[Any, Any, Any]]:
    """x, y and y′ on each segment, of the lowest mode without load."""
    system = column.system(None, 0.0, **parameters)
    found = spectrum(system)
    values, vectors = found.eigenvalues, found.vectors
    swings = np.where(values.imag > 1e-9 * np.abs(values).max(), np.abs(values), np.inf)
    vector = vectors[:, int(swings.argmin())]
    n = len(system.shapes(0.5))
    vector = vector[:n] * np.exp(-1j * np.angle(vector[np.abs(vector[:n]).argmax()]))
    pieces = []
    for low, high in pairwise(there.breaks):
        x = np.linspace(low, high, max(int(200 * (high - low)), 12))
        inner = np.clip(x, low + 1e-9, high - 1e-9)
        y, slope = ((vector @ system.shapes(inner, order, "y")).real for order in (0, 1))
        pieces.append((x, y, slope))
    top = max(np.abs(y).max() for _, y, _ in pieces) or 1.0
    scale = (0.1 if "free" in column.ends else 0.07) / top * (-1 if pieces[-1][1][-1] < 0 else 1)
    return [(x, scale * y, scale * slope) for x, y, slope in pieces]


def _there(line: list[tuple[Any, Any, Any]], place: float) -> tuple[float, float, float]:
    """The point of the line at a place, of the segment left of it."""
    x, y, slope = next(piece for piece in line if place <= piece[0][-1] + 1e-12)
    return place, float(np.interp(place, x, y)), float(np.interp(place, x, slope))


def _things(ax: Axes, there: Parts, line: list[tuple[Any, Any, Any]], more: list[Any]) -> None:
    """Joints, masses, springs and dampers, sensors; more: places of other sensors."""
    from matplotlib.patches import Rectangle

    for place, order in there.joints.items():
        _, y, _ = _there(line, place)
        if order:
            ax.plot([place], [y], "o", color="white", mec=INK, mew=1.2, ms=6, zorder=7)
        else:
            ax.plot([place, place], [y - 0.05, y + 0.05], color=INK, lw=1.2, ls=":", zorder=7)
    for place in there.masses:
        _, y, _ = _there(line, place)
        ax.plot([place], [y], "o", color=INK, ms=9, zorder=7)
    for places, shift in ((there.springs, -0.012), (there.dampers, 0.012)):
        for place in places:
            _, y, _ = _there(line, place)
            low = y - sketch.HALF
            x = place + shift * (place in there.springs and place in there.dampers)
            if places is there.springs:
                steps = np.linspace(low, low - 0.12, 9)
                ax.plot(x + 0.012 * np.array([0, 0, 1, -1, 1, -1, 1, 0, 0]), steps, color=INK, lw=1.0, zorder=4)
            else:
                ax.plot([x, x], [low, low - 0.05], color=INK, lw=1.0, zorder=4)
                ax.add_patch(Rectangle((x - 0.012, low - 0.085), 0.024, 0.035, fc="white", ec=INK, lw=1.0, zorder=4))
                ax.plot([x, x], [low - 0.085, low - 0.12], color=INK, lw=1.0, zorder=4)
    for place in sorted({*more, *(place for place, _ in there.sensors)}):
        _, y, _ = _there(line, place)
        ax.plot([place], [y], "s", color=colour(3), mec=INK, mew=0.9, ms=7.5, zorder=8)
        ax.annotate(
            "sensor", (place, y), (8, 11), textcoords="offset points", color=colour(3), fontsize=10,
        )  # fmt: skip


def _spread(ax: Axes, line: list[tuple[Any, Any, Any]], letter: str) -> None:
    """Small arrows along the beam: a load that is spread."""
    for x, y, _ in line:
        for k in range(6, len(x) - 4, 20):
            arrow(ax, (x[k] + 0.045, y[k]), (x[k] - 0.02, y[k]), ACCENT, 1.0, 9, zorder=6)
    ax.text(1.04, line[-1][1][-1], letter, color=ACCENT, va="center", fontsize=12)
