"""Drawings of stability: root loci, frequency and load, the tangent construction, critical loads, maps.

Each takes a column and its parameters, draws in the axes `ax` or in new ones, and returns the axes. Nondimensional.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import ArrayLike

from freebeam.figures import curves
from freebeam.figures.look import ACCENT, INK, MAP, MUTED, drawing
from freebeam.figures.marks import arrow, branch, colour, dashes, digits, dot, key, legend, mark, note, symbol
from freebeam_sym.checks import InputError
from freebeam_sym.question import Question

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from freebeam_sym.columns import Column

__all__ = [
    "coalescence", "critical_curve", "eigenvalues", "frequency_load", "root_locus", "stability_map", "tangent",
]  # fmt: skip

GREEK = {"alpha": r"internal damping $\alpha$", "beta": r"external damping $\beta$", "eta": r"$\eta$"}
"""What a map's dimensions are called."""
NONE = "#D9D9D9"
"""Colour of places without a critical load."""
FLAT = 1e-6
"""A map whose loads differ by no more, relative to their mean, is even: its labels have six digits."""


def frequency_load(
    column: Column,
    loads: ArrayLike | None = None,
    *,
    modes: int | None = None,
    count: int = 2,
    ax: Axes | None = None,
    **parameters: Any,
) -> Axes:
    """Squared frequencies ω² of the undamped column along the load, and where two of them meet.

    loads: a sequence, the largest load, or None for a quarter beyond the critical load. count: how many frequencies.
    Solid while a branch is a vibration; dashed, where a pair has met, the real part that both then share.
    Raises InputError for bad values, and without a critical load where no loads are given.
    """
    found = curves.frequency_load(Question.of(column, modes, **parameters), loads, count=count)
    with drawing(ax) as ax:
        _squares(ax, column, found)
        if crossing := _crossing(found):
            load, frequency = crossing
            kind = "coalescence" if frequency else "divergence"
            text = f"{kind}: {symbol(column, 'P')} = {digits(load)}"
            mark(ax, load, frequency**2, text, (-11, 0 if frequency else 9))
        key(ax, loc="upper right")
    return ax


def _crossing(found: curves.Locus | curves.FrequencyLoad) -> tuple[float, float] | None:
    """Load and frequency of the first loss of stability, where there is one among the loads that are drawn."""
    critical, P = found.critical, found.loads
    if critical is None or critical.load is None or critical.frequency is None:
        return None
    return (critical.load, critical.frequency) if P.min() <= critical.load <= P.max() else None


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


def tangent(
    column: Column, *, kappa: float = 0.0, modes: int | None = None, ax: Axes | None = None, **parameters: Any
) -> Axes:
    """The damping paradox, constructed: vanishing damping at β/α = `kappa` moves the critical load from where two
    frequencies meet to where a line through (0, −κ) touches the curve ω²(P).

    Raises InputError where the column does not flutter, and for κ = ∞.
    """
    found = curves.tangent(Question.of(column, modes, kappa=kappa, **parameters))
    critical = found.curves.critical
    assert critical and critical.load is not None and critical.frequency is not None
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
        arrow(ax, (critical.load, bottom / 2), (found.load, bottom / 2), INK, 0.9, 8, zorder=5)
        middle = (found.load + critical.load) / 2
        note(ax, middle, bottom / 2, f"{-100 * found.drop:+.1f} %".replace("-", "−"), (0, 3), ha="center", va="bottom")
        ax.plot([0.0], [-found.kappa], "o", color=ACCENT, ms=4.5, zorder=6, clip_on=False)
        text = f"tangent: {letter} = {digits(found.load)}"
        mark(ax, found.load, found.square, text, (6, 19), ha="right", va="bottom")
        dot(ax, critical.load, meeting, INK)
        note(ax, critical.load, meeting, f"coalescence: {letter} = {digits(critical.load)}", (-11, 0))
        if low < 0:
            note(ax, 0.0, -found.kappa, rf"$-\kappa$ = {-found.kappa:.4g}".replace("-", "−"), (9, -2), color=ACCENT)
        key(ax, loc="upper right")
    return ax


def coalescence(
    column: Column, *, modes: int | None = None, width: float = 0.04, ax: Axes | None = None, **parameters: Any
) -> Axes:
    """Two undamped eigenvalues where they meet: frequencies before, growth after, both a square root of the load.

    λ = iω ± √(c (P − P_cr)) to first order: the exceptional point, at which no power series in the load begins.
    width: what is shown on either side, a share of the load. Raises InputError where no two frequencies meet.
    """
    found = curves.coalescence(Question.of(column, modes, **parameters), width=width)
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
        dot(ax, found.load, 0.0)
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


def root_locus(
    column: Column,
    loads: ArrayLike | None = None,
    *,
    modes: int | None = None,
    alpha: float = 0.0,
    beta: float = 0.0,
    count: int = 2,
    normalised: bool = False,
    ax: Axes | None = None,
    **parameters: Any,
) -> Axes:
    """The first `count` eigenvalues in the complex plane as the load grows: Figs. 3 and 7 of the paper. Eqs. (24)-(26).

    loads: a sequence, the largest load, or None for a quarter beyond the critical load. normalised: divided by λ₀ of
    Eq. (26). Each branch keeps its colour; dots stand at round loads. Raises InputError for bad values.
    """
    found = curves.locus(Question.of(column, modes, alpha, beta, **parameters), loads, count=count)
    with drawing(ax, (5.2, 4.2)) as ax:
        draw_locus(ax, column, found, normalised)
    return ax


def draw_locus(ax: Axes, column: Column, found: curves.Locus, normalised: bool) -> None:
    """A locus in the complex plane."""
    from matplotlib.ticker import MaxNLocator

    values, P = found.scaled(normalised), found.loads
    for k in range(values.shape[1]):
        branch(ax, values[:, k].real, values[:, k].imag, found.unstable[:, k], k, lw=2.0)
    ax.axvline(0.0, color=MUTED, lw=0.8, zorder=1)
    ax.margins(0.12, 0.1)
    width = max(abs(v) for v in ax.get_xlim())
    if width < 1e-6 * max(abs(v) for v in ax.get_ylim()):  # all on the imaginary axis
        ax.set_xlim(-1, 1)
    over = "/\\lambda_0" if normalised else ""
    ax.set_xlabel(rf"Re$\,\lambda{over}$")
    ax.set_ylabel(rf"Im$\,\lambda{over}$")
    taken: list[Any] = []
    letter = symbol(column, "P")
    if crossing := _crossing(found):
        height = crossing[1] / found.scale(normalised)
        mark(ax, 0.0, height, f"{letter} = {digits(crossing[0])}", (11, -9))
        taken.append(ax.transData.transform((0.0, height)))
    for load in MaxNLocator(6, steps=[1, 2, 2.5, 5, 10]).tick_values(P.min(), P.max()):
        if not P.min() <= load <= P.max():
            continue
        for k in range(values.shape[1]):
            point = complex(np.interp(load, P, values[:, k]))
            dot(ax, point.real, point.imag, colour(k), mew=0.8, ms=5, zorder=5)
            place = ax.transData.transform((point.real, point.imag))
            if all(np.hypot(*(place - other)) > 15 for other in taken):
                taken.append(place)
                text = f"{letter} = {load:g}" if load == 0 else f"{load:g}"
                i = min(max(int(np.searchsorted(P, load)), 1), len(P) - 1)
                ends = values[[i - 1, i], k]
                along, up = np.abs(np.diff(ax.transData.transform(np.column_stack([ends.real, ends.imag])), axis=0)[0])
                at, ha = ((0, 5), "center") if along > up else ((8, 0), "left") if k % 2 else ((-8, 0), "right")
                note(ax, point.real, point.imag, text, at, color=colour(k), fontsize=8, ha=ha)
    key(ax)


def eigenvalues(
    column: Column,
    loads: ArrayLike | None = None,
    *,
    part: Literal["real", "imaginary"] = "imaginary",
    modes: int | None = None,
    alpha: float = 0.0,
    beta: float = 0.0,
    count: int = 2,
    normalised: bool = False,
    ax: Axes | None = None,
    **parameters: Any,
) -> Axes:
    """Real or imaginary part of the first `count` eigenvalues along the load: Fig. 2 of the paper. Eqs. (24)-(26).

    The arguments are those of `root_locus`, and `part`. Raises InputError for bad values.
    """
    if part not in ("real", "imaginary"):
        raise InputError(f"part = {part!r}: must be 'real' or 'imaginary'")
    found = curves.locus(Question.of(column, modes, alpha, beta, **parameters), loads, count=count)
    with drawing(ax) as ax:
        draw_part(ax, column, found, part, normalised)
    return ax


def draw_part(ax: Axes, column: Column, found: curves.Locus, part: str, normalised: bool) -> None:
    """A part of a locus along the load."""
    values, P = found.scaled(normalised), found.loads
    shown = values.real if part == "real" else values.imag
    for k in range(values.shape[1]):
        width = 1.7 if part == "imaginary" or k else 3.6  # real parts may all be 0: the first one's rim shows
        branch(ax, P, shown[:, k], found.unstable[:, k], k, lw=width)
    ax.set_xlim(P.min(), P.max())
    ax.margins(y=0.13)
    if part == "real":
        ax.axhline(0.0, color=MUTED, lw=0.8, zorder=1)
    else:
        for k in range(values.shape[1]):
            note(ax, P[0], shown[0, k], f"mode {k + 1}", (7, 7), color=colour(k))
    if crossing := _crossing(found):
        load, frequency = crossing
        height = 0.0 if part == "real" else frequency / found.scale(normalised)
        at, ha = ((-9, 7), "right") if part == "real" else ((0, -10), "center")
        if part == "imaginary" and not (found.question.alpha or found.question.beta):  # between the two that meet
            at, ha = (-11, 0), "right"
        mark(ax, load, height, f"{symbol(column, 'P')} = {digits(load)}", at, ha=ha)
    ax.set_xlabel(f"load {symbol(column, 'P')}")
    over = "/\\lambda_0" if normalised else ""
    ax.set_ylabel(rf"{'Re' if part == 'real' else 'Im'}$\,\lambda{over}$")


def critical_curve(
    column: Column,
    name: str,
    values: ArrayLike,
    *,
    modes: int | None = None,
    load_max: float = 1000.0,
    label: str | None = None,
    color: str | None = None,
    ax: Axes | None = None,
    **fixed: Any,
) -> Axes:
    """The critical load along one parameter: Figs. 4 and 5 of the paper, and one curve of Fig. 6.

    name: "alpha", "beta" or a parameter of the column's own; values: (m,), on a logarithmic axis where they grow by
    a factor; fixed: the other parameters. Flutter is solid, divergence dashed. Raises InputError for bad values.
    """
    if name in fixed:
        raise InputError(f"{name} = {fixed[name]}: is what the curve runs along; leave it out")
    found = curves.critical_curve(Question.of(column, modes, load_max=load_max, **fixed), name, values)
    with drawing(ax) as ax:
        draw_critical(ax, column, found, label, color)
    return ax


def draw_critical(
    ax: Axes, column: Column, found: curves.CriticalCurve, label: str | None = None, color: str | None = None
) -> None:
    """Critical loads along a parameter."""
    kinds = np.array(found.kinds)
    for kind, line in (("flutter", "-"), ("divergence", dashes())):
        if (kinds == kind).any():
            loads = np.where(kinds == kind, found.loads, np.nan)
            name = label if label or len(set(found.kinds)) == 1 else kind
            ax.plot(found.values, loads, color=color or colour(0), ls=line, label=name)
            label = label and "_" + label  # one entry of a legend for both
    if label is None and len(set(found.kinds)) > 1:
        legend(ax)
    least, most = np.nanmin(found.loads, initial=np.inf), np.nanmax(found.loads, initial=-np.inf)
    if most - least < 1e-6 * most:  # a constant, whose rounding would fill the axis
        ax.set_ylim(0, 2 * most)
    if geometric(found.values):
        ax.set_xscale("log")
    ax.set_xlim(found.values.min(), found.values.max())
    ax.set_xlabel(GREEK.get(found.name, symbol(column, found.name)))
    letter = symbol(column, "P")[1:-1].removesuffix("_0")
    ax.set_ylabel(rf"critical load ${letter}_{{\mathrm{{cr}}}}$")


def geometric(values: Any) -> bool:
    """Whether values span a decade or more and grow by a factor rather than by a step."""
    v = np.sort(np.asarray(values, dtype=float))
    if len(v) < 3 or v[0] <= 0 or v[-1] < 10 * v[0]:
        return False
    return bool(np.ptp(np.diff(np.log(v))) / np.log(v[-1] / v[0]) < np.ptp(np.diff(v)) / (v[-1] - v[0]))


def stability_map(
    loads: Any,
    x: ArrayLike | None = None,
    y: ArrayLike | None = None,
    *,
    xlabel: str | None = None,
    ylabel: str | None = None,
    levels: int | ArrayLike = 10,
    ax: Axes | None = None,
) -> Axes:
    """Critical loads over two parameters, as shades with lines of equal load.

    loads: an xarray Dataset with a variable `load` (and `kind`, so that divergence is hatched), a DataArray, both with
    two dimensions, of which the first is drawn along x, and their attributes `units` ("1" where nondimensional) after
    the names; or an array of shape (len(x), len(y)) with the values x, y.
    NaN, no critical load, stays grey. A map that is even to six digits, which the labels have, shows one value.
    Raises InputError where that does not fit together.
    """
    shown = _map_of(loads, x, y)
    values, across, up = shown.values, shown.across, shown.up
    own = [GREEK.get(name, name) + unit for name, unit in zip(shown.names, shown.units[:2], strict=True)]
    size, unit = 1.0, shown.units[2]
    if unit == ", N":  # newtons by thousands, so that the lines' labels are short
        power = min(3, max(0, math.floor(math.log10(float(np.nanmax(np.abs(values)))) / 3)))
        size, unit = 1000.0**power, f", {('', 'k', 'M', 'G')[power]}N"
        values = values / size
    mean = float(np.nanmean(values))
    flat = not np.ndim(levels) and np.nanmax(np.abs(values - mean)) <= FLAT * abs(mean)
    with drawing(ax, (5.4, 4.0)) as ax:
        ax.set_facecolor(NONE)
        for scale, where in ((ax.set_xscale, across), (ax.set_yscale, up)):
            if geometric(where):
                scale("log")  # before the labels, which are placed on what is seen
        steps = mean + np.array([-0.5, 0.5]) * abs(mean or 1.0) if flat else _steps(levels, values, size)
        filled = ax.contourf(across, up, np.ma.masked_invalid(values.T), steps, cmap=MAP, extend="neither")
        _equal_loads(ax, across, up, values, steps)
        _map_key(ax, shown)
        ax.grid(False)
        ax.set_xlabel(xlabel or own[0])
        ax.set_ylabel(ylabel or own[1])
        bar = ax.figure.colorbar(filled, ax=ax, pad=0.02)
        if flat:
            bar.set_ticks([mean], labels=[digits(mean)])
        bar.set_label(r"critical load $P_{\mathrm{cr}}$" + unit)
        bar.outline.set_visible(False)
    return ax


@dataclass(frozen=True)
class _Map:
    """A map to draw: `values` (len(across), len(up)); `divergence`, where the loss is one, or None where no kinds are
    known; names and units of the two parameters, and the unit of the load, as labels have them."""

    values: Any
    across: Any
    up: Any
    divergence: Any
    names: tuple[str, ...]
    units: tuple[str, ...]


def _map_of(loads: Any, x: ArrayLike | None, y: ArrayLike | None) -> _Map:
    """What `stability_map` is given, checked."""
    kinds = None
    if hasattr(loads, "data_vars"):
        if "load" not in loads:
            raise InputError(f"map: the Dataset has no variable 'load', only {', '.join(map(str, loads.data_vars))}")
        kinds, loads = (loads["kind"] if "kind" in loads else None), loads["load"]
        if kinds is not None and "flag_meanings" in kinds.attrs:
            kinds = np.array(kinds.attrs["flag_meanings"].split())[np.asarray(kinds)]
    names: tuple[str, ...] = ("", "")
    units: tuple[str, ...] = ("", "", "")
    if hasattr(loads, "dims"):
        names = tuple(map(str, loads.dims))
        if len(names) != 2:
            raise InputError(f"map: has the dimensions {', '.join(names) or '()'}; select two of them to draw")
        x = loads[names[0]].values if x is None else x
        y = loads[names[1]].values if y is None else y
        given = (array.attrs.get("units", "1") for array in (loads[names[0]], loads[names[1]], loads))
        units = tuple(f", {unit}" if unit != "1" else "" for unit in given)
    values = np.asarray(loads, dtype=float)
    if x is None or y is None:
        raise InputError("x, y: are needed with a plain array, the values of its two parameters")
    across, up = np.asarray(x, dtype=float), np.asarray(y, dtype=float)
    if values.shape != (len(across), len(up)) or min(values.shape) < 2:
        raise InputError(
            f"map has shape {values.shape}: must be (len(x), len(y)) = ({len(across)}, {len(up)}), two or more each"
        )
    if not np.isfinite(values).any():
        raise InputError("map: holds no critical load, only NaN")
    divergence = None if kinds is None else np.asarray(np.asarray(kinds) == "divergence")
    return _Map(values, across, up, divergence, names, units)


def _steps(levels: Any, values: Any, size: float) -> Any:
    """The loads between two shades: about so many, or those given, in units of `size`."""
    from matplotlib.ticker import MaxNLocator

    if np.ndim(levels):
        return np.asarray(levels) / size
    return MaxNLocator(levels).tick_values(float(np.nanmin(values)), float(np.nanmax(values)))


def _equal_loads(ax: Axes, across: Any, up: Any, values: Any, steps: Any) -> None:
    """Lines of equal load with their labels, but for labels that the frame would cut."""
    inks = ["white" if k < len(steps) * 0.6 else INK for k in range(len(steps))]
    lines = ax.contour(across, up, np.ma.masked_invalid(values.T), steps, colors=inks, linewidths=0.6)
    for text in ax.clabel(lines, fontsize=8, fmt="%g"):
        spot = ax.transAxes.inverted().transform(ax.transData.transform(text.get_position()))
        text.set_visible(bool((np.abs(spot - 0.5) < 0.45).all()))


def _map_key(ax: Axes, shown: _Map) -> None:
    """Hatches where the loss is divergence, and what they and the places without a load mean."""
    from matplotlib.patches import Patch

    keys = []
    if shown.divergence is not None and shown.divergence.any():
        still = shown.divergence.T.astype(float)
        ax.contourf(shown.across, shown.up, still, [0.5, 1.5], colors="none", hatches=["////"])
        keys.append(Patch(facecolor="none", edgecolor=INK, hatch="////", label="divergence"))
    if not np.isfinite(shown.values).all():
        keys.append(Patch(facecolor=NONE, edgecolor=MUTED, label="none found"))
    if keys:
        legend(ax, handles=keys, loc="upper left")
