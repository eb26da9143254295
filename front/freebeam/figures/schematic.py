"""A drawing of any column from its statement: ends, section, loads, masses, springs, dampers, joints and sensors."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from freebeam.figures.look import ACCENT, INK, MUTED, drawing
from freebeam.figures.marks import arrow, colour
from freebeam.figures.sketch import BODY, HALF, _arrow
from freebeam.figures.sketch import force as _force
from freebeam.figures.sketch import support as _support

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from freebeam_derive.drawn import Parts
    from freebeam_derive.statement import Column

__all__ = ["schematic"]

SHAPES: dict[tuple[str, str], Callable[[Any], Any]] = {
    ("clamped", "free"): lambda x: 0.06 * x**2 * (3 - x),
    ("free", "clamped"): lambda x: 0.06 * (1 - x) ** 2 * (2 + x),
    ("pinned", "free"): lambda x: 0.04 * x + 0.045 * x**2 * (3 - x),
    ("pinned", "pinned"): lambda x: 0.07 * np.sin(np.pi * x),
    ("clamped", "clamped"): lambda x: 1.1 * x**2 * (1 - x) ** 2,
    ("clamped", "pinned"): lambda x: 0.27 * x**2 * (1 - x) * (3 - 2 * x) / 0.75,
    ("free", "free"): lambda x: 0.1 * (x - 0.5) + 0.06 * (1 - 4 * x * (1 - x)),
}
"""How a beam is drawn bent, by its ends; a joint adds a kink or a step."""


def schematic(statement: Column, *, ax: Axes | None = None) -> Axes:
    """A column as it is stated, bent a little: its ends, section, loads and all that acts at places.

    statement: a `freebeam_derive.statement.Column`. Parameters are at their defaults. Raises InputError without
    matplotlib.
    """
    from freebeam_derive.drawn import parts_of

    parts = parts_of(statement)
    with drawing(ax, (6.4, 2.7)) as ax:
        ax.set_aspect("equal")
        ax.axis("off")
        if statement.fields:
            _beam(ax, statement, parts)
        else:
            _links(ax, parts)
        ax.set_xlim(-0.24, 1.36)
        ax.set_ylim(-0.3, 0.36)
    return ax


def _line(ends: tuple[str, str], jumps: list[tuple[int, float]], x: Any) -> Any:
    y = SHAPES[ends](x)
    for order, place in jumps:
        y = y + np.where(x > place, 0.2 * (x - place) if order else 0.04, 0.0)
    return y


def _beam(ax: Axes, statement: Column, parts: Parts) -> None:
    from matplotlib.patches import Polygon

    from freebeam_derive.drawn import depths

    x = np.linspace(0.0, 1.0, 401)
    ends = statement.supports(statement.fields[0])
    y = _line(ends, parts.jumps, x)
    slope = np.gradient(y, x)
    depth = np.array(depths(statement, x.tolist()))
    depth = depth * HALF * (1.2 if depth.min() == depth.max() else 2.2)  # what varies is to be seen
    ax.plot([-0.06, 1.02], [0, 0], color=MUTED, lw=0.8, ls=(0, (6, 3)), zorder=1)
    outline = np.concatenate([np.stack([x, y + depth], 1), np.stack([x, y - depth], 1)[::-1]])
    ax.add_patch(Polygon(outline, fc=BODY, ec=INK, lw=1.0, zorder=3))
    for k, side in ((0, -1), (-1, 1)):
        _support(ax, ends[0 if k == 0 else 1], float(x[k]), float(y[k]), side)

    def height(place: float) -> float:
        return float(np.interp(place, x, y))

    for place, name in parts.masses:
        ax.plot([place], [height(place)], "o", color=INK, ms=11, zorder=6)
        ax.text(place, height(place) + 0.05, name, ha="center", va="bottom", fontsize=11)
    for place, name in parts.inertias:
        ax.plot([place], [height(place)], "o", mfc="none", mec=INK, ms=17, zorder=6)
        ax.text(place - 0.05, height(place) - 0.05, name, ha="right", va="top", fontsize=11)
    for place, name in parts.springs:
        _zigzag(ax, place, height(place), -0.16, name)
    for place, name in parts.dampers:
        _dashpot(ax, place, height(place), -0.16, name)
    for place, _ in parts.absorbers:
        _zigzag(ax, place, height(place), -0.1, "")
        ax.plot([place], [-0.14], "s", color=INK, ms=11, zorder=6)
        ax.text(place + 0.05, -0.14, "$q$", va="center", fontsize=11)
    for place, name in parts.turning:
        _spiral(ax, place, height(place), name)
    for order, place in parts.jumps:
        look: dict[str, Any] = {"color": "white", "mec": INK, "zorder": 6}
        ax.plot([place], [height(place)], "o" if order else "s", ms=8, **look)
    if parts.foundation:
        for place in np.linspace(0.08, 0.96, 9):
            _zigzag(ax, float(place), height(float(place)), -0.13, "", 0.008)
        ax.text(1.0, -0.15, parts.foundation, fontsize=11, va="center")
    if parts.medium:
        low, high, name = parts.medium
        ax.fill_between(x, y - 0.075, y + 0.075, where=(x >= low) & (x <= high), color="#E4E4E4", lw=0, zorder=0)
        ax.text((low + high) / 2, height((low + high) / 2) + 0.09, name, fontsize=11, ha="center")
    name, spread = parts.weight
    for k in range(40, len(x), 60) if spread else [len(x) - 1] * bool(name):
        reach = 0.05 if spread else 0.14
        _arrow(ax, (x[k] + reach, y[k] - 0.035), (x[k], y[k] - 0.035), MUTED, 1.2)
    ax.text(1.16, y[-1] - 0.04, name, color=MUTED, va="center", fontsize=12)
    for seen, moved in parts.sensors:
        ax.plot([seen], [height(seen)], "s", color=colour(3), mec=INK, ms=7.5, zorder=7)
        ax.annotate("sensor", (seen, height(seen)), (0, 12), textcoords="offset points", ha="center", fontsize=9)
        arrow(ax, (seen, height(seen) - 0.03), (moved, height(moved) - 0.03), colour(3), 0.9, 8, zorder=2)
    _loads(ax, parts, x, y, slope)


def _loads(ax: Axes, parts: Parts, x: Any, y: Any, slope: Any) -> None:
    """The load: at places with its direction, or along the beam."""
    letter = parts.symbol
    for at in parts.followers:
        k = round(at * (len(x) - 1))
        _force(ax, np.array([x[k], y[k]]), math.atan(slope[k]), letter, 1.0, float(slope[k]))
    if parts.fixed_line:
        _arrow(ax, (1.24, 0.0), (1.02, 0.0), ACCENT, 2.2)
        ax.plot([1.0, 1.0], [0.0, y[-1]], color=INK, lw=2.0)
        ax.text(1.26, 0.0, letter, color=ACCENT, va="center", fontsize=13)
    if parts.followers or parts.fixed_line:
        return
    if parts.load == "inside":
        for start in (0.1, 0.42, 0.74):
            i, j = (int(s * (len(x) - 1)) for s in (start, start + 0.2))
            _arrow(ax, (x[i], y[i]), (x[j], y[j]), ACCENT, 1.2)
        ax.text(1.04, y[-1], letter, color=ACCENT, va="center", fontsize=13)
    elif parts.load == "outside":
        for up in (0.17, 0.24):
            for start in (0.05, 0.55):
                _arrow(ax, (start, up), (start + 0.3, up), ACCENT, 1.2)
        ax.text(1.04, 0.2, letter, color=ACCENT, va="center", fontsize=13)
    elif parts.load in ("follower", "axis"):
        for k in range(40, len(x), 60):
            reach = 0.06
            tilt = slope[k] if parts.load == "follower" else 0.0
            _arrow(ax, (x[k] + reach, y[k] + reach * tilt + 0.03), (x[k], y[k] + 0.03), ACCENT, 1.2)
        ax.text(1.06, y[-1] + 0.03, letter, color=ACCENT, va="center", fontsize=13)
    else:
        _arrow(ax, (1.22, y[-1]), (1.01, y[-1]), ACCENT, 2.2)
        ax.text(1.25, y[-1], letter, color=ACCENT, va="center", fontsize=13)


def _links(ax: Axes, parts: Parts) -> None:
    """A chain of rigid links, one for each coordinate, under a force along the last."""
    count = len(parts.angles)
    angles = np.linspace(0.12, 0.3, count)
    points = np.concatenate([[[0.0, 0.0]], np.cumsum(np.stack([np.cos(angles), np.sin(angles)], 1), 0) / count])
    _support(ax, "clamped", 0.0, 0.0, -1)
    ax.plot([-0.06, 1.02], [0, 0], color=MUTED, lw=0.8, ls=(0, (6, 3)), zorder=1)
    ax.plot(points[:, 0], points[:, 1], color=INK, lw=3.0, zorder=4)
    for k, (px, py) in enumerate(points[:-1]):
        _spiral(ax, px, py, "")
        ax.plot([px], [py], "o", color="white", mec=INK, ms=6, zorder=6)
        ax.text(px + 0.2, py + 0.02, parts.angles[k], fontsize=11, va="bottom")
    for px, py in points[1:]:
        ax.plot([px], [py], "o", color=INK, ms=10, zorder=7)
    _force(ax, points[-1], float(angles[-1]), parts.symbol, 1.0, 0.0)


def _ground(ax: Axes, x: float, y: float) -> None:
    ax.plot([x - 0.03, x + 0.03], [y, y], color=INK, lw=1.2)
    for k in range(4):
        ax.plot([x - 0.03 + 0.02 * k, x - 0.04 + 0.02 * k], [y, y - 0.015], color=INK, lw=0.8)


def _zigzag(ax: Axes, x: float, top: float, bottom: float, name: str, wide: float = 0.014) -> None:
    """A spring from the beam down, to the ground."""
    count = 8
    heights = np.linspace(top, bottom, count + 2)
    sides = [0.0, *(wide * (-1) ** k for k in range(count)), 0.0]
    ax.plot(x + np.array(sides), heights, color=INK, lw=1.0, zorder=2)
    _ground(ax, x, bottom)
    ax.text(x + 0.035, (top + bottom) / 2 - 0.02, name, fontsize=11, va="center")


def _dashpot(ax: Axes, x: float, top: float, bottom: float, name: str) -> None:
    """A damper from the beam down, to the ground."""
    middle = (top + bottom) / 2
    for path in (
        [(0, top), (0, middle)],
        [(-0.016, middle), (0.016, middle)],
        [(-0.024, middle + 0.03), (-0.024, middle - 0.03), (0.024, middle - 0.03), (0.024, middle + 0.03)],
        [(0, middle - 0.03), (0, bottom)],
    ):
        ax.plot([x + dx for dx, _ in path], [h for _, h in path], color=INK, lw=1.1, zorder=2)
    _ground(ax, x, bottom)
    ax.text(x + 0.04, middle, name, fontsize=11, va="center")


def _spiral(ax: Axes, x: float, y: float, name: str) -> None:
    """A rotational spring."""
    turn = np.linspace(0, 4.5 * np.pi, 120)
    radius = 0.008 + 0.034 * turn / turn[-1]
    ax.plot(x + radius * np.cos(turn), y + radius * np.sin(turn), color=INK, lw=0.9, zorder=5)
    ax.text(x - 0.02, y - 0.06, name, fontsize=11, va="top", ha="center")
