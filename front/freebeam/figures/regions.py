"""Drawings of regions: in which motion grows under a load that pulsates, in which a critical load is proven to lie."""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING, Any

import numpy as np

from freebeam.figures.look import COLOURS, drawing
from freebeam.figures.marks import legend, symbol
from freebeam.pulsating.growth import KINDS, PulsatingRegions
from freebeam_sym.checks import InputError

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from freebeam.exact_ranges import ExactRange
    from freebeam.pulsating.growth import Centre

__all__ = ["proven_range", "pulsating_regions"]

LOOK = {
    "principal-2T": (COLOURS[0], "principal, period 2T"),
    "principal-T": (COLOURS[3], "principal, period T"),
    "combination": (COLOURS[1], "combination"),
}
"""Colour and name of each kind of region."""
FAINTEST = 0.3
"""Opacity of what grows least."""
APART = 0.03
"""Least distance of two labels of centres, a share of the axis: a line of text."""
ABOVE = 0.05
"""Height of the labels above the axes, a share of these."""


def pulsating_regions(
    found: PulsatingRegions, *, ax: Axes | None = None, title: str = "", size: float = 1.0, unit: str = ""
) -> Axes:
    """Regions of frequency Ω and amplitude ε in which motion grows, a colour a kind, darker where it grows faster.

    found: what `freebeam.pulse` returns, of two frequencies and amplitudes or more. Each point of the grid is one
    rectangle of the picture: nothing is smoothed. Lines mark where regions begin for small ε and damping: Ω = 2ω_j and
    ω_i ± ω_j, and halves of these where there is room. size, unit: of one nondimensional unit of frequency, for SI.
    Raises InputError where there is no grid.
    """
    if min(found.kind.shape) < 2:
        shape = " x ".join(map(str, found.kind.shape))
        raise InputError(f"regions: a grid of {shape} points; a picture needs two frequencies and two amplitudes")
    with drawing(ax, (6.4, 4.4)) as ax:
        ax.grid(False)
        across = found.frequency * size
        image = np.array([_rgba(found, name) for name in LOOK]).sum(axis=0)
        ax.pcolormesh(across, found.amplitude, image, shading="nearest", rasterized=True)
        ax.set_xlim(across[0], across[-1])
        ax.set_ylim(found.amplitude[0], found.amplitude[-1])
        longest = _centres(ax, found, size)
        ax.set_title(title, pad=18 + 4.2 * longest)
        ax.set_xlabel(r"frequency of the load $\Omega$" + (f", {unit}" if unit else ""))
        ax.set_ylabel(r"amplitude of the load $\varepsilon$")
        _key(ax, found)
    return ax


def proven_range(found: ExactRange, *, ax: Axes | None = None) -> Axes:
    """The boxes in which the critical load of the beam itself is proven to lie, over a parameter, a colour a kind.

    found: what `freebeam.exact_range` returns. Each box holds the load of every value of the parameter below it; what
    is left open is grey from bottom to top.
    """
    from matplotlib.patches import Rectangle

    column, name = found.question.column, found.parameter
    with drawing(ax, (5.6, 3.8)) as ax:
        named = set()
        for piece in found.pieces:
            colour = COLOURS[0] if piece.kind == "flutter" else COLOURS[1]
            low, high, bottom, top = (_float(v) for v in (piece.low, piece.high, *piece.load))
            label = None if piece.kind in named else piece.kind
            named.add(piece.kind)
            box = Rectangle((low, bottom), high - low, top - bottom, fc=colour, ec=colour, lw=0.7, label=label)
            ax.add_patch(box)
        for k, part in enumerate(found.open):
            ax.axvspan(_float(part.low), _float(part.high), color="0.85", lw=0, label=None if k else "not proven")
        ends = [(_float(part.low), _float(part.high)) for part in found.pieces]
        ends += [(_float(part.low), _float(part.high)) for part in found.open]
        ax.set_xlim(min(ends)[0], max(ends)[1])
        top = max(_float(piece.load[1]) for piece in found.pieces)
        ax.set_ylim(0, 1.06 * top)
        if len(named) + bool(found.open) > 1:
            legend(ax)
        ax.set_xlabel(symbol(column, name))
        letter = symbol(column, "P")[1:-1].removesuffix("_0")
        ax.set_ylabel(rf"critical load ${letter}_{{\mathrm{{cr}}}}$, the beam itself")
    return ax


def _float(text: str) -> float:
    return float(Fraction(text))


def _rgba(found: PulsatingRegions, name: str) -> Any:
    """Colours of one kind of region, (m, n, 4), and nothing elsewhere; opacity by growth in a unit of time."""
    from matplotlib.colors import to_rgb

    here = found.kind == KINDS.index(name)
    rate = np.where(found.kind > 0, found.rate, 0.0)
    share = np.sqrt(np.clip(rate / max(rate.max(), 1e-300), 0, 1))
    colour = np.append(to_rgb(LOOK[name][0]), 1.0) * here[..., None]
    colour[..., 3] *= FAINTEST + (1 - FAINTEST) * share
    return colour.transpose(1, 0, 2)


def _centres(ax: Axes, found: PulsatingRegions, size: float) -> int:
    """Lines at the centres of small regions, with their names above; the number of letters of the longest name."""
    shown = _chosen(found)
    low, width = float(found.frequency[0]), float(found.frequency[-1] - found.frequency[0])
    places = _apart(np.array([(centre.frequency - low) / width for centre in shown]))
    above = ax.get_xaxis_transform()
    for centre, place in zip(shown, places.tolist(), strict=True):
        x, label = centre.frequency * size, (low + place * width) * size
        kind = "combination" if centre.combination else "principal-2T" if centre.k == 1 else "principal-T"
        ax.plot([x, x, label], [0, 1, 1 + ABOVE * 0.8], color=LOOK[kind][0], lw=0.8, ls=(0, (1, 1.6)), zorder=2.5,
                transform=above, clip_on=False)  # fmt: skip
        ax.text(label, 1 + ABOVE, centre.label, transform=above, rotation=90, ha="center", va="bottom", fontsize=8)
    return max((len(centre.label.replace("\\omega", "w").strip("$")) for centre in shown), default=0)


def _chosen(found: PulsatingRegions) -> list[Centre]:
    """The centres that are named, ascending: those of order 1, as far as there is room, and halves between them."""
    chosen: list[Centre] = []
    room = APART * float(found.frequency[-1] - found.frequency[0])
    for centre in sorted(found.centres(), key=lambda x: (x.k, x.combination, x.frequency)):
        free = all(abs(centre.frequency - other.frequency) > room for other in chosen)
        if free or (centre.k == 1 and len(chosen) < 0.4 / APART):
            chosen.append(centre)
    return sorted(chosen)


def _apart(places: Any) -> Any:
    """Places (n,), ascending, moved as little as need be so that neighbours are APART."""
    steps = APART * np.arange(len(places))
    rising = np.maximum.accumulate(places - steps) + steps
    falling = np.minimum.accumulate((places - steps)[::-1])[::-1] + steps
    return (rising + falling) / 2


def _key(ax: Axes, found: PulsatingRegions) -> None:
    """What the colours mean that are there, below the axes."""
    from matplotlib.patches import Patch

    there = [LOOK[name] for number, name in enumerate(KINDS) if number and (found.kind == number).any()]
    if there:
        handles = [Patch(facecolor=colour, label=label) for colour, label in there]
        legend(ax, handles=handles, loc="upper center", bbox_to_anchor=(0.5, -0.16), ncols=len(handles))
