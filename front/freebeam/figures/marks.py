"""What the drawings have in common: branches, stable and unstable; critical points; labels that can be read."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from freebeam.figures.look import ACCENT, COLOURS, HALO, INK, MUTED

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from freebeam_sym.columns import Column

__all__ = ["arrow", "branch", "colour", "dashes", "digits", "dot", "key", "legend", "mark", "note", "plain", "symbol"]

DASHES = (2.6, 3.4)
"""What is unstable: length of a dash and of a gap, in widths of the line."""


def dashes(k: int = 0) -> tuple[float, tuple[float, float]]:
    """Line style of what is unstable. That of an odd k fills the gaps of an even one, where two curves are one."""
    return (k % 2) * sum(DASHES) / 2, DASHES


def colour(k: int) -> str:
    """Colour of branch k, from 0."""
    return COLOURS[k % len(COLOURS)]


def digits(value: float) -> str:
    """A number as labels have it, to five significant digits.

    >>> digits(109.7218), digits(20.0502)
    ('109.72', '20.050')
    """
    return f"{value:#.5g}" if value == 0 or 1e-3 <= abs(value) < 1e5 else f"{value:.4g}"


def plain(value: float) -> str:
    """A number to three significant digits, with a minus sign in place of a hyphen.

    >>> plain(-0.21734)
    '−0.217'
    """
    return f"{value:.3g}".replace("-", "−")


def symbol(column: Column, name: str) -> str:
    """A quantity of a column as its formulas have it, for a label, such as $P_0$."""
    letters = dict(column.kernel.COLUMN["latex"])
    letters |= {p.name: p.latex for p in column.parameters}
    return f"${letters.get(name, name)}$"


def branch(
    ax: Axes,
    x: Any,
    y: Any,
    unstable: Any,
    k: int,
    label: str | None = None,
    color: str | None = None,
    lw: float | None = None,
) -> None:
    """Branch k in its colour, solid (lw wide) where it is stable and dashed from the last point that is."""
    cuts = [0, *(np.flatnonzero(np.diff(np.asarray(unstable, dtype=int))) + 1).tolist(), len(x)]
    for a, b in pairwise(cuts):
        part = slice(max(a - 1, 0), b)
        line: Any = {"ls": dashes(k), "zorder": 3.2} if unstable[a] else {"ls": "-", "lw": lw, "zorder": 3.0}
        ax.plot(x[part], y[part], color=color or colour(k), label=label, **line)
        label = None


def dot(ax: Axes, x: float, y: float, color: str = ACCENT, **more: Any) -> None:
    """A dot with a rim of the background's colour."""
    ax.plot([x], [y], "o", color=color, **{"mec": HALO, "mew": 1.1, "ms": 7.5, "zorder": 6, **more})


def arrow(
    ax: Axes, tail: tuple[float, float], head: tuple[float, float], color: str, lw: float, size: float,
    style: str = "-|>", **more: Any,
) -> None:  # fmt: skip
    """An arrow from point to point, with a head of a size in points."""
    look = {"arrowstyle": style, "color": color, "lw": lw, "shrinkA": 0, "shrinkB": 0, "mutation_scale": size}
    ax.annotate("", head, tail, arrowprops=look, **more)


def mark(ax: Axes, x: float, y: float, text: str = "", at: tuple[float, float] = (8, 8), **more: Any) -> None:
    """A critical point, and its value beside it, `at` so many points away."""
    dot(ax, x, y, clip_on=False)
    if text:
        note(ax, x, y, text, at, color=ACCENT, **more)


def note(ax: Axes, x: float, y: float, text: str, at: tuple[float, float] = (6, 6), **more: Any) -> None:
    """Words beside a point, with a rim of the background's colour, so that no line runs through a letter."""
    from matplotlib.patheffects import withStroke

    more = {"color": INK, "fontsize": 8.5, "ha": "left" if at[0] >= 0 else "right", **more}
    more.setdefault("va", "center" if abs(at[1]) < 4 else "bottom" if at[1] > 0 else "top")
    written = ax.annotate(text, (x, y), at, textcoords="offset points", zorder=7, **more)
    written.set_path_effects([withStroke(linewidth=2.6, foreground=HALO)])


def key(ax: Axes, **where: Any) -> None:
    """What solid and dashed lines mean."""
    from matplotlib.lines import Line2D

    lines = [Line2D([], [], color=MUTED, ls=style) for style in ("-", dashes())]
    legend(ax, lines, ["stable", "unstable"], **where)


def legend(ax: Axes, *handles: Any, **where: Any) -> None:
    """A legend on the background's colour."""
    box = ax.legend(*handles, **{"loc": "best", "framealpha": 0.85, "edgecolor": "none", "frameon": True, **where})
    box.set_zorder(8)
