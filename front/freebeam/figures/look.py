"""How pictures look: colours, type, lines; and the axes that a drawing is made in.

The style is a context. Nothing outside it is changed, and matplotlib is imported where a picture is made.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from freebeam_sym.checks import InputError

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["ACCENT", "COLOURS", "INK", "MUTED", "drawing", "figure", "lightness", "shades", "style"]

# Okabe and Ito's set, which colour-blind readers tell apart, in an order whose neighbours differ in lightness too, so
# that a grey copy can be read; `lightness` measures it.
COLOURS = ("#0072B2", "#E69F00", "#000000", "#009E73")
ACCENT = "#D55E00"
"""Critical points, and nothing else."""
INK = "#222222"
MUTED = "#757575"
GRID = "#E4E4E4"
HALO = "#FFFFFF"
MAP = "cividis"
"""Colour map of loads: its lightness rises throughout."""

_STYLE: dict[str, Any] = {
    "font.family": "DejaVu Sans",
    "mathtext.fontset": "dejavusans",
    "font.size": 9,
    "axes.titlesize": 9.5,
    "axes.titleweight": "normal",
    "axes.titlelocation": "left",
    "axes.titlepad": 7,
    "axes.labelsize": 9.5,
    "axes.labelcolor": INK,
    "axes.edgecolor": MUTED,
    "axes.linewidth": 0.7,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.axisbelow": True,
    "axes.grid": True,
    "axes.formatter.useoffset": False,
    "grid.color": GRID,
    "grid.linewidth": 0.6,
    "text.color": INK,
    "xtick.color": MUTED,
    "ytick.color": MUTED,
    "xtick.labelcolor": INK,
    "ytick.labelcolor": INK,
    "xtick.labelsize": 8.5,
    "ytick.labelsize": 8.5,
    "xtick.major.width": 0.7,
    "ytick.major.width": 0.7,
    "xtick.minor.width": 0.5,
    "ytick.minor.width": 0.5,
    "lines.linewidth": 1.7,
    "lines.solid_capstyle": "round",
    "lines.dash_capstyle": "butt",
    "legend.frameon": False,
    "legend.fontsize": 8.5,
    "legend.handlelength": 2.2,
    "figure.facecolor": "white",
    "axes.facecolor": "white",
    "savefig.facecolor": "white",
    "figure.dpi": 110,
    "savefig.dpi": 200,
    "figure.constrained_layout.use": True,
    "figure.constrained_layout.h_pad": 0.06,
    "figure.constrained_layout.w_pad": 0.06,
    # A fixed salt, and paths for letters: the same picture is the same bytes, whatever fonts a machine has.
    "svg.hashsalt": "freebeam",
    "svg.fonttype": "path",
    "pdf.fonttype": 42,
}

# What of matplotlib's settings is look, and goes back to its default for the time of the style: not what a user has
# set of windows, backends, folders and time zones.
_LOOK = (
    "axes.", "contour.", "font.", "grid.", "hatch.", "image.", "legend.", "lines.", "markers.", "mathtext.", "patch.",
    "path.", "pdf.", "savefig.bbox", "savefig.transparent", "scatter.", "svg.", "text.", "xtick.", "ytick.",
)  # fmt: skip


@contextmanager
def style() -> Iterator[None]:
    """The style of these pictures, for the time of a `with` block. Raises InputError without matplotlib.

    >>> from matplotlib import rcParams
    >>> before = rcParams["axes.spines.top"]
    >>> with style():
    ...     rcParams["axes.spines.top"]
    False
    >>> rcParams["axes.spines.top"] == before
    True
    """
    try:
        import matplotlib
        from cycler import cycler  # which matplotlib brings
    except ImportError:
        raise InputError("pictures need matplotlib, which is not installed: pip install 'freebeam[pictures]'") from None
    settings: dict[Any, Any] = {k: value for k, value in matplotlib.rcParamsDefault.items() if k.startswith(_LOOK)}
    settings |= {**_STYLE, "axes.prop_cycle": cycler(color=COLOURS)}
    interactive = matplotlib.is_interactive()
    try:
        with matplotlib.rc_context(settings):
            try:
                yield
            finally:  # a notebook's first picture turns this on, and it is to stay on
                interactive = matplotlib.is_interactive()
    finally:
        matplotlib.interactive(interactive)


@contextmanager
def drawing(ax: Axes | None, size: tuple[float, float] = (5.2, 3.4)) -> Iterator[Axes]:
    """The axes to draw in, in the style: those given, or new ones in a figure of a size in inches."""
    with style():
        if ax is None:
            from matplotlib import pyplot

            _, ax = pyplot.subplots(figsize=size)
        yield ax
        # Ticks that matplotlib makes after the style's end still look like it.
        for axis in ("x", "y"):
            ax.tick_params(axis=axis, which="both", labelsize=_STYLE["xtick.labelsize"], color=MUTED, labelcolor=INK)
        for side in ("top", "right"):
            if side in ax.spines:
                ax.spines[side].set_visible(False)


def figure(size: tuple[float, float]) -> Figure:
    """An empty figure of a size in inches that no window shows; to be made and filled within `style`."""
    from matplotlib.figure import Figure

    return Figure(figsize=size)


def shades(count: int) -> list[str]:
    """Colours for a family of curves in the order of a parameter, dark to light, (count,).

    >>> shades(2)[0] < shades(2)[1]
    True
    """
    from matplotlib import colormaps
    from matplotlib.colors import to_hex

    places = [0.0] if count == 1 else [0.8 * k / (count - 1) for k in range(count)]
    return [to_hex(colormaps[MAP](place)) for place in places]


def lightness(colour: str) -> float:
    """CIE L* of a colour, 0 (black) to 100 (white): what a grey copy keeps of it.

    >>> round(lightness("#777777"))
    50
    """
    from matplotlib.colors import to_rgb

    linear = [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in to_rgb(colour)]
    luminance = 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]
    return 116 * luminance ** (1 / 3) - 16 if luminance > 0.008856 else 903.3 * luminance
