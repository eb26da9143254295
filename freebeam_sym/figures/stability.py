"""Drawings of stability: root loci, frequency and load, the tangent construction, critical loads, maps.

Each takes a column and its parameters, draws in the axes `ax` or in new ones, and returns the axes. Nondimensional.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from freebeam_sym.figures import curves
from freebeam_sym.figures.marks import branch, colour, dashes, digits, key, legend, mark, note, symbol
from freebeam_sym.figures.style import ACCENT, INK, MUTED, drawing

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from freebeam_sym.columns import Column

__all__ = ["coalescence", "frequency_load", "tangent"]


def frequency_load(
    column: Column,
    loads: ArrayLike | None = None,
    *,
    modes: int = 8,
    count: int = 2,
    ax: Axes | None = None,
    **parameters: Any,
) -> Axes:
    """Squared frequencies ω² of the undamped column along the load, and where two of them meet.

    loads: a sequence, the largest load, or None for a quarter beyond the critical load. count: how many frequencies.
    Solid while a branch is a vibration; dashed, where a pair has met, the real part that both then share.
    Raises InputError for bad values, and without a critical load where no loads are given.
    """
    found = curves.frequency_load(column, loads, modes=modes, count=count, **parameters)
    with drawing(ax) as ax:
        _squares(ax, column, found)
        critical = found.critical
        if critical.load is not None and critical.frequency is not None and critical.load <= found.loads.max():
            kind = "coalescence" if critical.frequency else "divergence"
            text = f"{kind}: {symbol(column, 'P')} = {digits(critical.load)}"
            mark(ax, critical.load, critical.frequency**2, text, (-11, 0 if critical.frequency else 9))
        key(ax, loc="upper right")
    return ax


def _squares(ax: Axes, column: Column, found: curves.FrequencyLoad, top: float | None = None) -> None:
    """The curves ω²(P), each named where it enters the picture, whose height is `top`, or what all of them need."""
    low = min(0.0, float(found.squares.real.min()))
    limit = 1.1 * float(found.squares.real.max()) if top is None else top
    for k, s in enumerate(found.squares.T):
        branch(ax, found.loads, s.real, found.unstable[:, k], k)
        inside = int(np.argmax(s.real <= limit))
        at = (7.0, 7.0) if inside == 0 else (-7.0, -4.0)
        note(ax, found.loads[inside], s[inside].real, f"mode {k + 1}", at, color=colour(k))
    ax.set_xlim(found.loads[0], found.loads[-1])
    ax.set_ylim(1.08 * low, limit)
    ax.set_xlabel(f"load {symbol(column, 'P')}")
    ax.set_ylabel(r"squared frequency $\omega^2$")


def tangent(column: Column, *, kappa: float = 0.0, modes: int = 8, ax: Axes | None = None, **parameters: Any) -> Axes:
    """The damping paradox, constructed: vanishing damping at β/α = `kappa` moves the critical load from where two
    frequencies meet to where a line through (0, −κ) touches the curve ω²(P).

    Raises InputError where the column does not flutter, and for κ = ∞.
    """
    found = curves.tangent(column, kappa=kappa, modes=modes, **parameters)
    critical = found.curves.critical
    assert critical.load is not None and critical.frequency is not None
    letter, meeting = symbol(column, "P"), critical.frequency**2
    start = float(found.curves.squares[0, 0].real)
    with drawing(ax) as ax:
        # the second frequency's beginning is far above the construction, which is what there is to see
        top = 2.3 * max(meeting, start)
        _squares(ax, column, found.curves, top)
        low = min(0.0, -found.kappa)
        bottom = min(-0.06 * top, 1.3 * low)
        ax.set_ylim(bottom, top)
        reach = min(found.curves.loads[-1], found.load + (0.9 * top - found.square) / found.slope)
        ends = np.array([0.0, reach])
        ax.axhline(0.0, color=MUTED, lw=0.7, zorder=1)
        ax.plot(ends, found.line(ends), color=ACCENT, lw=1.2, zorder=4)
        for load, square in ((found.load, found.square), (critical.load, meeting)):
            ax.plot([load, load], [bottom, square], color=MUTED, lw=0.8, ls=(0, (1, 2)), zorder=1)
        arrow = {"arrowstyle": "-|>", "color": INK, "lw": 0.9, "shrinkA": 0, "shrinkB": 0, "mutation_scale": 8}
        ax.annotate("", (found.load, bottom / 2), (critical.load, bottom / 2), arrowprops=arrow, zorder=5)
        middle = (found.load + critical.load) / 2
        note(ax, middle, bottom / 2, f"{-100 * found.drop:+.1f} %".replace("-", "−"), (0, 3), ha="center", va="bottom")
        ax.plot([0.0], [-found.kappa], "o", color=ACCENT, ms=4.5, zorder=6, clip_on=False)
        mark(
            ax,
            found.load,
            found.square,
            f"tangent: {letter} = {digits(found.load)}",
            (-16, 15),
            ha="center",
            va="bottom",
        )
        ax.plot([critical.load], [meeting], "o", color=INK, mec="white", mew=1.1, ms=7.5, zorder=6)
        note(ax, critical.load, meeting, f"coalescence: {letter} = {digits(critical.load)}", (-11, 0))
        if low < 0:
            note(ax, 0.0, -found.kappa, rf"$-\kappa$ = {-found.kappa:.4g}".replace("-", "−"), (9, -2), color=ACCENT)
        key(ax, loc="upper right")
    return ax


def coalescence(
    column: Column, *, modes: int = 8, width: float = 0.04, ax: Axes | None = None, **parameters: Any
) -> Axes:
    """Two undamped eigenvalues where they meet: frequencies before, growth after, both a square root of the load.

    λ = iω ± √(c (P − P_cr)) to first order: the exceptional point, at which no power series in the load begins.
    width: what is shown on either side, a share of the load. Raises InputError where no two frequencies meet.
    """
    found = curves.coalescence(column, modes=modes, width=width, **parameters)
    before, after = found.loads <= found.load, found.loads >= found.load
    away = found.eigenvalues - 1j * found.frequency
    letter = symbol(column, "P")
    with drawing(ax) as ax:
        law = found.law(found.loads)
        for sign, name in ((1, rf"$\pm\sqrt{{c\,({letter[1:-1]} - P_{{\mathrm{{cr}}}})}}$"), (-1, None)):
            dots = (0, (1, 1.4))
            ax.plot(found.loads, sign * (law.real + law.imag), color=INK, lw=1.0, ls=dots, zorder=4, label=name)
        for k in (0, 1):
            ax.plot(found.loads[before], away[before, k].imag, color=colour(1 - k))
            lines = dashes() if k == 0 else "-"
            ax.plot(found.loads[after], away[after, k].real, color=ACCENT if k == 0 else MUTED, ls=lines)
        ax.plot([found.load], [0.0], "o", color=ACCENT, mec="white", mew=1.1, ms=7.5, zorder=6)
        note(
            ax, found.load, 0.0, f"{letter} = {digits(found.load)}\n$\\omega$ = {digits(found.frequency)}",
            (-10, 0), color=ACCENT,
        )  # fmt: skip
        a, b = found.loads[0], found.loads[-1]
        note(ax, a, away[0, 0].imag, r"faster: Im$\,\lambda-\omega$", (8, 8), color=colour(1))
        note(ax, a, away[0, 1].imag, r"slower: Im$\,\lambda-\omega$", (8, -8), color=colour(0))
        note(ax, b, away[-1, 0].real, r"grows: Re$\,\lambda$", (-8, 8), color=ACCENT)
        note(ax, b, away[-1, 1].real, r"decays: Re$\,\lambda$", (-8, -8), color=MUTED)
        ax.set_xlim(a, b)
        ax.margins(y=0.14)
        ax.set_xlabel(f"load {letter}")
        ax.set_ylabel(r"$\lambda - i\omega$: imaginary before, real after")
        legend(ax, loc="center right")
    return ax
