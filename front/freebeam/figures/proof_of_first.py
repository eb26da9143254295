"""The picture of the proof that a loss of stability is the first: eigenvalues, strips, and where discs are mapped."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from freebeam.figures.look import ACCENT, COLOURS, INK, MUTED, drawing
from freebeam.figures.marks import digits, dot, legend, note, symbol
from freebeam_sym.checks import InputError

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from freebeam_sym.columns import Column

__all__ = ["strips"]

POINTS = 121
"""Of half a circle |p| = P and of each line."""


def strips(column: Column, *, above: int = 3, ax: Axes | None = None, **parameters: Any) -> Axes:
    """Eigenvalues s of the beam itself at its undamped critical load, and the lines that the proof of it stands on.

    Drawn over s^(1/4), where the lines are about π apart. Dots: s at p = P. Curves: where s goes as p runs over the
    circle |p| = P in the complex plane; those right of line m are each alone in a strip, `above` of them are drawn, and
    that no curve meets a line is proven. The dots and curves are of a series of 40 modes, in floats; m, the lines and
    the load are those of the proof. docs/theorem.md. Raises InputError where it is not proven.
    """
    from freebeam.proofs import exact_load

    found = exact_load(column, digits=15, **parameters)
    if found.evidence is None or found.load is None or column.general:
        raise InputError(f"{column.name}: has no strips to draw: {found.missing or 'its proof is another one'}")
    m, P = int(found.evidence["lowest"]), float(found.load[0])
    lines, values, circles = _computed(column, parameters, m, P, m + above)
    with drawing(ax, (6.4, 3.4)) as ax:
        height = 0.5 * lines[m] ** 0.25 / m  # half of the mean distance of the lowest
        for k, R in lines.items():
            x, y = _line(R, height)
            ax.plot(x, y, color=INK if k == m else MUTED, lw=1.4 if k == m else 0.8, zorder=2)
            note(ax, x[-1], height, f"$R_{{{k}}}$", (0, 3), ha="center")
            if k == m:
                ax.fill_betweenx(y, 0, x, color=COLOURS[0], alpha=0.07, lw=0, zorder=0)
        for j in range(m, m + above):
            for sign in (1, -1):
                w = circles[:, j] ** 0.25
                label = "$s_j(p)$, $|p| = P$" if (j, sign) == (m, 1) else None
                ax.plot(w.real, sign * w.imag, color=COLOURS[0], lw=1.2, label=label, zorder=3)
        low = np.concatenate([circles[:, :m].ravel(), circles[:, :m].ravel().conj()]) ** 0.25
        ax.plot(low.real, low.imag, ".", color=COLOURS[1], ms=2, zorder=2, label=f"the {m} lowest, $|p| = P$")
        for s in values[: m + above]:
            w = complex(s) ** 0.25
            dot(ax, w.real, w.imag, INK, ms=5)
        if found.kind == "flutter" and found.frequency is not None:
            dot(ax, float(found.frequency[0]) ** 0.5, 0.0, ACCENT)
        ax.set_xlim(0, lines[m + above] ** 0.25 + 0.4)
        ax.set_ylim(-height, height)
        ax.set_xlabel(r"Re$\,s^{1/4}$")
        ax.set_ylabel(r"Im$\,s^{1/4}$")
        title = f"{m} eigenvalues left of $R_{m}$, one in each strip beyond"
        ax.set_title(f"{title}; {symbol(column, 'P')} = {digits(P)}", pad=14)
        legend(ax, loc="lower left")
    return ax


def _computed(
    column: Column, parameters: dict[str, Any], m: int, P: float, last: int
) -> tuple[dict[int, float], Any, Any]:
    """The lines from m to last, the eigenvalues at P, and those on |p| = P, (POINTS, last)."""
    from freebeam.proofs import rational
    from freebeam_derive.certify.balls import precision
    from freebeam_derive.certify.strips import Strips

    own = {name: rational(name, value)[0] for name, value in parameters.items()}
    with precision(128):
        strips_of = Strips(column.kernel, own, 40)
        lines = {k: float(strips_of.line(k)) for k in range(m, last + 1)}
        turns = np.exp(1j * np.linspace(0, np.pi, POINTS))
        circles = np.array([strips_of.estimates(P * turn, last) for turn in turns])
        return lines, strips_of.estimates(P, last), circles


def _line(R: float, height: float) -> tuple[Any, Any]:
    """Re s = R over s^(1/4), up to a height."""
    w = (R + 1j * R * np.sinh(np.linspace(-4, 4, 4 * POINTS))) ** 0.25
    inside = np.abs(w.imag) <= height
    return w[inside].real, w[inside].imag
