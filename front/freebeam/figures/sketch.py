"""A drawing of a column: its ends, its load, the transversal force and a sensor. Fig. 1 of the paper."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from freebeam.figures import curves
from freebeam.figures.look import ACCENT, INK, MUTED, drawing
from freebeam.figures.marks import arrow, colour, symbol
from freebeam_sym.checks import positions
from freebeam_sym.question import Question

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from freebeam_sym.columns import Column

__all__ = ["beam", "centre_line"]

HALF = 0.011  # of the beam's depth, in its length
BODY = "#D6E3EC"


def centre_line(column: Column, points: int = 201) -> tuple[Any, Any, Any]:
    """x, y, y′ of the beam as it is drawn: its lowest mode, and where both ends are free a little rotation."""
    x = np.linspace(0.0, 1.0, points)
    system = column.system(1)
    y, slope = (np.asarray(system.shapes(x, derivative))[0] for derivative in (0, 1))
    scale = (0.1 if "free" in column.ends else 0.07) / np.abs(y).max()
    scale = -scale if y[-1] < 0 or (abs(y[-1]) < 1e-9 and y[points // 2] < 0) else scale
    turn = 0.06 if column.rigid_count > 1 else 0.0
    return x, scale * y + turn * (x - 0.5), scale * slope + turn


def beam(
    column: Column, *, x_s: float | None = 0.15, x_F: float | None = 0.7, ax: Axes | None = None, **parameters: Any
) -> Axes:
    """`beam` of points.py, of a column that is one segment."""
    x, y, slope = centre_line(column)
    follows = curves.follower_share(Question.of(column, **parameters))
    axial = column.kernel.equation(1.0, **column.own_parameters(parameters)).get((2, 0), ())
    places = {"x_s": x_s, "x_F": x_F if column.forced else None}
    for name, place in places.items():
        if place is not None:
            positions(name, place)
    with drawing(ax, (6.4, 2.7)) as ax:
        ax.set_aspect("equal")
        ax.axis("off")
        ax.plot([-0.06, 1.02], [0, 0], color=MUTED, lw=0.8, ls=(0, (6, 3)), zorder=1)
        body(ax, x, y, slope)
        for k, end in ((0, column.ends[0]), (-1, column.ends[1])):
            support(ax, end, float(x[k]), float(y[k]), -1 if k == 0 else 1)
        letter = symbol(column, "P")
        if sum(axial):
            force(ax, np.array([x[-1], y[-1]]), math.atan(follows * slope[-1]), letter, follows, slope[-1])
        elif any(axial):  # no force at the end: the load is spread along the beam
            for k in range(10, len(x), 20):
                _arrow(ax, (x[k] + 0.045, y[k]), (x[k] - 0.02, y[k]), ACCENT, 1.0)
            ax.text(1.04, y[-1], letter, color=ACCENT, va="center", fontsize=12)
        if places["x_F"] is not None:
            transversal(ax, column, places["x_F"], float(np.interp(places["x_F"], x, y)))
        if places["x_s"] is not None:
            at = float(np.interp(places["x_s"], x, y))
            ax.plot([places["x_s"]], [at], "s", color=colour(3), mec=INK, mew=0.9, ms=7.5, zorder=5)
            ax.annotate(
                "sensor", (places["x_s"], at), (8, 11), textcoords="offset points", color=colour(3), fontsize=10,
            )  # fmt: skip
        _measures(ax, column, places, float(min(y.min(), 0.0)))
        frame(ax)
        ax.set_xlim(-0.24, 1.28)
        ax.set_ylim(min(y.min(), 0.0) - 0.24, max(y.max(), 0.0) + 0.12)
    return ax


def body(ax: Axes, x: Any, y: Any, slope: Any) -> None:
    """The beam along its centre line, with a depth."""
    from matplotlib.patches import Polygon

    normal = np.stack([-slope, np.ones_like(slope)]) / np.hypot(1, slope)
    line = np.stack([x, y])
    outline = np.concatenate([(line + HALF * normal).T, (line - HALF * normal).T[::-1]])
    ax.add_patch(Polygon(outline, fc=BODY, ec=INK, lw=1.0, zorder=3))


def transversal(ax: Axes, column: Column, place: float, at: float) -> None:
    """The transversal force F_0 from below, at a place of the beam whose height is `at`."""
    tip = at - HALF - 0.004
    _arrow(ax, (place, tip - 0.125), (place, tip), colour(0))
    ax.text(place + 0.016, tip - 0.1, f"${symbol(column, 'F_0')[1:-1]}(t)$", color=colour(0), fontsize=12)


def _arrow(ax: Axes, tail: tuple[float, float], head: tuple[float, float], tone: str, width: float = 1.8) -> None:
    arrow(ax, tail, head, tone, width, 9 * width**0.5, zorder=6)


def force(ax: Axes, end: Any, angle: float, letter: str, follows: float, slope: float) -> None:
    """The load at x = 1, pushing along the tangent (a follower), the axis (a dead load), or between."""
    along = np.array([math.cos(angle), math.sin(angle)])
    tip, tail = end + 0.008 * along, end + 0.2 * along
    _arrow(ax, tuple(tail), tuple(tip), ACCENT, 2.2)
    beyond = tail + 0.02 * along
    ax.text(beyond[0], beyond[1], letter, color=ACCENT, va="center", fontsize=13)
    if follows == 1 and abs(slope) > 0.05:  # the right angle between the force and the cross-section
        across, foot = np.array([-along[1], along[0]]), end + 0.004 * along
        corner = [foot + 0.026 * across, foot + 0.026 * (across + along), foot + 0.026 * along]
        for path in ([foot, foot + 0.062 * across], corner):
            ax.plot(*np.transpose(path), color=INK, lw=0.9, zorder=4)


def support(ax: Axes, kind: str, x: float, y: float, side: int) -> None:
    """An end's symbol, on the side -1 (left) or 1."""
    from matplotlib.patches import Polygon, Rectangle

    if kind == "clamped":
        ax.add_patch(
            Rectangle((x if side > 0 else x - 0.035, y - 0.09), 0.035, 0.18, fc="white", ec="none", hatch="/////")
        )
        ax.plot([x, x], [y - 0.09, y + 0.09], color=INK, lw=1.6, zorder=4)
    elif kind == "pinned":
        foot = y - 0.055
        ax.add_patch(Polygon([(x, y), (x - 0.03, foot), (x + 0.03, foot)], fc="white", ec=INK, lw=1.0, zorder=4))
        if side > 0:  # on rollers: the load can come in
            for shift in (-0.016, 0.016):
                ax.plot([x + shift], [foot - 0.011], "o", color="white", mec=INK, ms=4, zorder=4)
            foot -= 0.022
        ax.plot([x - 0.045, x + 0.045], [foot, foot], color=INK, lw=1.2, zorder=4)
        ax.plot([x], [y], "o", color="white", mec=INK, ms=4.5, zorder=5)
    elif kind == "sliding":
        for at in (x, x + side * 0.03):
            ax.plot([at, at], [y - 0.09, y + 0.09], color=INK, lw=1.2, zorder=4)
        for shift in (-0.05, 0.05):
            ax.plot([x + side * 0.015], [y + shift], "o", color="white", mec=INK, ms=5, zorder=4)


def _measures(ax: Axes, column: Column, places: dict[str, float | None], lowest: float) -> None:
    """Distances from x = 0, below the beam."""
    rows = [(p, name) for name, p in places.items() if p is not None]
    levels = [lowest - 0.1 - 0.06 * k for k in range(3)]
    for level, (place, name) in zip(levels, [*sorted(rows), (1.0, "1")], strict=False):
        label = "$L$" if name == "1" else {"x_s": "$x_s$", "x_F": "$x_F$"}[name]
        arrow(ax, (place, level), (0.0, level), MUTED, 0.8, 7, "<|-|>")
        ax.plot([place, place], [level - 0.012, 0.0], color=MUTED, lw=0.6, ls=(0, (1, 2)), zorder=0)
        ax.plot([0.0, 0.0], [level - 0.012, 0.0], color=MUTED, lw=0.6, ls=(0, (1, 2)), zorder=0)
        ax.text(place / 2, level + 0.008, label, ha="center", va="bottom", fontsize=10.5)


def frame(ax: Axes) -> None:
    """The axes x and y at the left end."""
    at = -0.2
    _arrow(ax, (at, 0.0), (at, 0.11), MUTED, 1.0)
    _arrow(ax, (at, 0.0), (at + 0.11, 0.0), MUTED, 1.0)
    ax.text(at + 0.012, 0.1, "$y$", fontsize=10.5)
    ax.text(at + 0.1, 0.014, "$x$", fontsize=10.5, ha="right")
