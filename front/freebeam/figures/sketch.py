"""Symbols of a drawn column: the beam itself, its ends, forces, springs, dampers, masses and joints."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from freebeam.figures.look import ACCENT, HALO, INK, MUTED
from freebeam.figures.marks import arrow, colour

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = [
    "absorber", "body", "dashpot", "force", "frame", "joint", "mass", "measures", "push", "sensor", "spiral",
    "spring", "support", "transversal",
]  # fmt: skip

HALF = 0.011  # of the beam's depth, in its length
BODY = "#D6E3EC"


def body(ax: Axes, x: Any, y: Any, slope: Any, half: Any) -> None:
    """The beam along its centre line, with half its depth there, (n,) each."""
    from matplotlib.patches import Polygon

    normal = np.stack([-slope, np.ones_like(slope)]) / np.hypot(1, slope)
    line = np.stack([x, y])
    outline = np.concatenate([(line + half * normal).T, (line - half * normal).T[::-1]])
    ax.add_patch(Polygon(outline, fc=BODY, ec=INK, lw=1.0, zorder=3))


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


def push(
    ax: Axes, tail: tuple[float, float], head: tuple[float, float], tone: str = ACCENT, width: float = 1.8
) -> None:
    """An arrow whose head grows with its width."""
    arrow(ax, tail, head, tone, width, 9 * width**0.5, zorder=6)


def force(ax: Axes, end: Any, angle: float, letter: str, follows: float, slope: float) -> None:
    """The load at a place, pushing along the tangent (a follower), the axis (a dead load), or between."""
    along = np.array([math.cos(angle), math.sin(angle)])
    tip, tail = end + 0.008 * along, end + 0.2 * along
    push(ax, tuple(tail), tuple(tip), width=2.2)
    beyond = tail + 0.02 * along
    ax.text(beyond[0], beyond[1], letter, color=ACCENT, va="center", fontsize=13)
    if follows == 1 and abs(slope) > 0.05:  # the right angle between the force and the cross-section
        across, foot = np.array([-along[1], along[0]]), end + 0.004 * along
        corner = [foot + 0.026 * across, foot + 0.026 * (across + along), foot + 0.026 * along]
        for path in ([foot, foot + 0.062 * across], corner):
            ax.plot(*np.transpose(path), color=INK, lw=0.9, zorder=4)


def transversal(ax: Axes, letter: str, place: float, at: float) -> None:
    """The transversal force F_0 from below, at a place of the beam whose height is `at`."""
    from matplotlib.patheffects import withStroke

    tip = at - HALF - 0.004
    push(ax, (place, tip - 0.125), (place, tip), colour(0))
    ax.text(place + 0.016, tip - 0.1, f"${letter[1:-1]}(t)$", color=colour(0), fontsize=12, path_effects=[
        withStroke(linewidth=2.6, foreground=HALO)
    ])  # fmt: skip


def mass(ax: Axes, x: float, y: float, name: str) -> None:
    """A point mass."""
    ax.plot([x], [y], "o", color=INK, ms=11, zorder=7)
    ax.text(x - 0.035 * (x > 0.95), y + 0.05, name, ha="center", va="bottom", fontsize=11)  # clear of a load


def joint(ax: Axes, x: float, y: float, order: int, name: str) -> None:
    """Where the slope (order 1) or the deflection (0) may jump."""
    ax.plot([x], [y], "o" if order else "s", color="white", mec=INK, mew=1.2, ms=8, zorder=6)
    ax.text(x, y + 0.045, name, ha="center", va="bottom", fontsize=11)


def sensor(ax: Axes, x: float, y: float) -> None:
    """What is measured at a place."""
    ax.plot([x], [y], "s", color=colour(3), mec=INK, mew=0.9, ms=7.5, zorder=8)
    ax.annotate("sensor", (x, y), (8, 11), textcoords="offset points", color=colour(3), fontsize=10)


def _ground(ax: Axes, x: float, y: float) -> None:
    ax.plot([x - 0.03, x + 0.03], [y, y], color=INK, lw=1.2)
    for k in range(4):
        ax.plot([x - 0.03 + 0.02 * k, x - 0.04 + 0.02 * k], [y, y - 0.015], color=INK, lw=0.8)


def spring(
    ax: Axes, x: float, top: float, bottom: float, name: str, wide: float = 0.014, grounded: bool = True
) -> None:
    """A spring from the beam down, to the ground."""
    count = 8
    heights = np.linspace(top, bottom, count + 2)
    sides = [0.0, *(wide * (-1) ** k for k in range(count)), 0.0]
    ax.plot(x + np.array(sides), heights, color=INK, lw=1.0, zorder=2)
    if grounded:
        _ground(ax, x, bottom)
    ax.text(x + 0.035, (top + bottom) / 2 - 0.02, name, fontsize=11, va="center")


def absorber(ax: Axes, x: float, top: float, bottom: float, name: str) -> None:
    """A mass on a spring below the beam."""
    spring(ax, x, top, bottom + 0.04, name, grounded=False)
    ax.plot([x], [bottom], "s", color=INK, ms=11, zorder=6)


def dashpot(ax: Axes, x: float, top: float, bottom: float, name: str) -> None:
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


def spiral(ax: Axes, x: float, y: float, name: str) -> None:
    """A rotational spring."""
    turn = np.linspace(0, 4.5 * np.pi, 120)
    radius = 0.008 + 0.034 * turn / turn[-1]
    ax.plot(x + radius * np.cos(turn), y + radius * np.sin(turn), color=INK, lw=0.9, zorder=5)
    ax.text(x - 0.02, y - 0.06, name, fontsize=11, va="top", ha="center")


def measures(ax: Axes, places: dict[str, float], top: float) -> None:
    """Distances from x = 0, below the beam, and its length."""
    rows = [*sorted((place, f"${name}$") for name, place in places.items()), (1.0, "$L$")]
    for k, (place, label) in enumerate(rows):
        level = top - 0.06 * k
        arrow(ax, (place, level), (0.0, level), MUTED, 0.8, 7, "<|-|>")
        for at in (place, 0.0):
            ax.plot([at, at], [level - 0.012, 0.0], color=MUTED, lw=0.6, ls=(0, (1, 2)), zorder=0)
        ax.text(place / 2, level + 0.008, label, ha="center", va="bottom", fontsize=10.5)


def frame(ax: Axes) -> None:
    """The axes x and y at the left end."""
    at = -0.2
    push(ax, (at, 0.0), (at, 0.11), MUTED, 1.0)
    push(ax, (at, 0.0), (at + 0.11, 0.0), MUTED, 1.0)
    ax.text(at + 0.012, 0.1, "$y$", fontsize=10.5)
    ax.text(at + 0.1, 0.014, "$x$", fontsize=10.5, ha="right")
