"""What is told of a vehicle: its facts as a table, and a report with pictures, as HTML in one file or as PDF."""

from __future__ import annotations

import base64
import html
import io
import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from freebeam.figures.look import ACCENT, COLOURS, INK, MUTED, figure, shades, style
from freebeam.figures.marks import legend, note
from freebeam.figures.saving import FORMATS as PLAIN
from freebeam.figures.saving import image_of
from freebeam.maps.verdict import digits_that_hold

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from freebeam.vehicles.vehicle import Vehicle

__all__ = ["FORMATS", "facts", "report"]

FORMATS = (".html", ".pdf")
GAINS, THRUSTS = 17, 24
"""Of the map: some five seconds where a vehicle has sixty trial functions."""


def facts(vehicle: Vehicle) -> list[list[str]]:
    """What a vehicle is and bears, a row each, numbers to the digits that hold."""
    loss, unloaded = vehicle.loss, vehicle.unloaded
    thrust = vehicle.settings.get("thrust")
    several = zip(unloaded.frequency, unloaded.error, strict=True)
    rows = [
        ["length", f"{vehicle.length:.6g} m, from x = {vehicle.low:.6g} m"],
        ["mass", f"{vehicle.mass:.6g} kg, its centre at x = {vehicle.centre:.6g} m"],
        ["frequencies", ", ".join(_held(f, e) for f, e in several) + " rad/s, without thrust"],
    ]
    if loss.load is None or loss.frequency is None:
        told = "" if loss.agreed else "; two series of trial functions do not agree on it"
        return [*rows, ["stability", f"not lost up to a thrust of {loss.load_max:.6g} N{told}"]]
    error = 0.1 if loss.error is None else loss.error
    rows += [["stability is lost at", f"a thrust of {_held(loss.load, error)} N, by {loss.kind}"]]
    if loss.frequency:
        hertz = _held(loss.frequency / (2 * math.pi), max(error, 1e-6))
        rows += [["frequency there", f"{_held(loss.frequency, max(error, 1e-6))} rad/s, {hertz} Hz"]]
    converged = "" if loss.converged else "; not converged"
    told = (
        "not known: two series of trial functions do not agree" if loss.error is None else f"{error:.1e} of the thrust"
    )
    rows += [["error", told + converged]]
    if thrust is not None and vehicle.factor is not None:
        rows += [["load factor", f"{_held(vehicle.factor, error)} times the thrust of {thrust:.6g} N"]]
    return rows


def _held(value: float, error: float) -> str:
    return digits_that_hold(float(value), max(float(error), 1e-16), 6)


@dataclass(frozen=True)
class Shown:
    """A picture of the report with what it shows."""

    title: str
    words: str
    drawn: Figure


def report(vehicle: Vehicle, format: str, say: Callable[[str], object] = lambda _: None) -> bytes:
    """The report as the bytes of a file of one of FORMATS. Raises InputError without matplotlib."""
    with style():
        shown = []
        for picture in _pictures(vehicle):
            say(picture.title)
            shown.append(picture)
        return _pdf(vehicle, shown) if format == ".pdf" else _html(vehicle, shown)


def _pictures(vehicle: Vehicle) -> Iterator[Shown]:
    yield Shown("Stiffness and mass", "As the tables say, with point masses and other parts below.", _tables(vehicle))
    words = "Of the lowest motions; where the dots are orange, the motion grows."
    yield Shown("Frequencies over the thrust", words, _over_thrust(vehicle))
    words = "Of the vehicle without thrust; the largest deflection is 1."
    yield Shown("Lowest modes", words, _modes(vehicle))
    if vehicle.load is not None:
        words = "The vehicle at moments of half a period, dark to light, without the rigid motion that bending drives."
        if not vehicle.frequency:
            words = "The shape that grows, without rigid motion."
        yield Shown("Motion at the first loss of stability", words, _lost(vehicle))
    if "gimbal.sensor" in vehicle.settings:
        words = "Growth of the fastest growing motion; the line is the first loss of stability."
        yield Shown("Stability over gain and thrust", words, _map(vehicle))
    if {"imu", "thrust"} <= set(vehicle.settings) and _calm(vehicle):
        words = "Of the angle and of the acceleration across the vehicle, for a unit gimbal angle at the given thrust."
        yield Shown("The IMU over the frequency of the gimbal", words, _bode(vehicle))
        words = "To one degree of gimbal angle, turned and turned back within half a period of the lowest mode."
        yield Shown("The IMU after a pulse of the gimbal", words, _pulse(vehicle))


def _calm(vehicle: Vehicle) -> bool:
    return not (vehicle.modes(number=12).growth > 0).any()


# --- pictures -----------------------------------------------------------------------------------------------------


def _axes(count: int = 1, height: float = 3.2, **more: Any) -> tuple[Figure, list[Axes]]:
    drawn = figure((6.8, height))
    axes = drawn.subplots(count, 1, squeeze=False, **more)
    return drawn, [*axes[:, 0]]


def _tables(vehicle: Vehicle) -> Figure:
    s = vehicle.stations
    x = np.repeat(s.x, 2)[1:-1]
    quantities = [("EI", "N m²"), ("m", "kg/m"), ("GA", "N"), ("J", "kg m")]
    given = [(name, unit, getattr(s, name)) for name, unit in quantities if getattr(s, name) is not None]
    parts = bool(vehicle.parts)
    drawn, axes = _axes(len(given) + parts, 1.6 * len(given) + 1.2 * parts + 0.4, sharex=True)
    for ax, (name, unit, of) in zip(axes, given, strict=False):
        ax.fill_between(x, of.ravel(), color=COLOURS[0], alpha=0.15, lw=0)
        ax.plot(x, of.ravel(), color=COLOURS[0], lw=1.2)
        ax.set_ylabel(f"{name}, {unit}")
        if of.min() > 0 and of.max() > 30 * of.min():
            ax.set_yscale("log")
        else:
            ax.set_ylim(0, None)
    if parts:
        kinds = [kind for kind in ("mass", "sprung", "joint", "spring") if any(p.kind == kind for p in vehicle.parts)]
        for row, kind in enumerate(kinds):
            of_kind = [part for part in vehicle.parts if part.kind == kind]
            heavy = max(max(part.mass for part in of_kind), 1e-300)
            sizes = [20 + 130 * part.mass / heavy if part.mass else 40 for part in of_kind]
            axes[-1].scatter([part.x for part in of_kind], [row] * len(of_kind), sizes, COLOURS[row], zorder=3)
        axes[-1].set_yticks(range(len(kinds)), kinds)
        axes[-1].set_ylim(len(kinds) - 0.5, -0.5)
    named: dict[float, list[str]] = {}
    for name, place in (("IMU", "imu"), ("sensor", "gimbal.sensor"), ("control", "control")):
        if place in vehicle.settings:
            named.setdefault(vehicle.settings[place], []).append(name)
    for at, names in named.items():
        axes[0].axvline(at, color=MUTED, lw=0.8, ls=(0, (4, 2)))
        where: dict[str, Any] = {
            "transform": axes[0].get_xaxis_transform(),
            "fontsize": 8,
            "va": "bottom",
            "ha": "center",
        }
        axes[0].text(at, 1.0, ", ".join(names), **where)
    axes[-1].set_xlabel("x, m; the thrust acts at the right end, to the left")
    return drawn


def _top(vehicle: Vehicle) -> float:
    """The largest thrust that pictures show, N."""
    thrust = vehicle.settings.get("thrust", 0.0)
    return max(1.25 * (vehicle.load or 0.0), 1.1 * thrust) or vehicle.loss.load_max


def _over_thrust(vehicle: Vehicle) -> Figure:
    from freebeam.maps.arrays import eigenvalues

    thrusts = np.linspace(0, _top(vehicle), 121)[1:]
    q = vehicle.question()
    loads = thrusts / vehicle.units["load"]
    rates = eigenvalues(q.column, loads, q.alpha, q.beta, q.modes, **q.parameters)
    drawn, (ax,) = _axes()
    hertz = rates.imag * vehicle.units["frequency"] / (2 * math.pi)
    top = 1.3 * max(float(np.sort(hertz[0][hertz[0] > 0])[:4].max()), (vehicle.frequency or 0.0) / (2 * math.pi))
    grows = rates.real > 1e-9 * np.maximum(np.abs(rates), 1e-4 * np.abs(rates).max(axis=1, keepdims=True))
    P = np.broadcast_to(thrusts[:, None], rates.shape)
    for which, colour, label in ((~grows, COLOURS[0], None), (grows, ACCENT, "the motion grows")):
        seen = which & (hertz >= 0) & (hertz < top)
        ax.plot(P[seen], hertz[seen], ".", color=colour, ms=3.5, label=label if seen.any() else None)
    _mark(ax, vehicle)
    ax.set_xlim(0, thrusts[-1])
    ax.set_ylim(0, top)
    ax.set_xlabel("thrust, N")
    ax.set_ylabel("frequency, Hz")
    if ax.get_legend_handles_labels()[0]:
        legend(ax, loc="lower left", bbox_to_anchor=(0, 1), ncols=3)
    return drawn


def _mark(ax: Axes, vehicle: Vehicle) -> None:
    if vehicle.load is not None:
        ax.axvline(vehicle.load, color=ACCENT, lw=1.2, label="first loss of stability")
    if "thrust" in vehicle.settings:
        ax.axvline(vehicle.settings["thrust"], color=INK, lw=1, ls=(0, (4, 2)), label="the vehicle's thrust")


def _modes(vehicle: Vehicle) -> Figure:
    found = vehicle.unloaded
    drawn, (ax,) = _axes()
    for k, (shape, frequency, error) in enumerate(zip(found.shape, found.frequency, found.error, strict=True)):
        if k == 3:
            break
        label = f"{_held(frequency / (2 * math.pi), max(error, 1e-4))} Hz"
        ax.plot(found.x, shape.real, color=COLOURS[k], ls=("-", "--", ":")[k], label=label)
    ax.axhline(0, color=MUTED, lw=0.8)
    ax.set_xlim(found.x[0], found.x[-1])
    ax.set_xlabel("x, m")
    ax.set_ylabel("deflection")
    ax.legend(loc="center left", bbox_to_anchor=(1, 0.5))
    return drawn


def _lost(vehicle: Vehicle) -> Figure:
    assert vehicle.load is not None and vehicle.frequency is not None
    found = vehicle.modes(vehicle.load, 12)
    k = int(np.abs(found.frequency - vehicle.frequency).argmin())
    drawn, (ax,) = _axes()
    moments = 7 if vehicle.frequency else 1
    for n, tone in enumerate(shades(moments)):
        share = n / max(moments - 1, 1)
        label = {0.0: "t = 0", 0.5: "t = T/4", 1.0: "t = T/2"}.get(share) if vehicle.frequency else None
        ax.plot(found.x, (found.shape[k] * np.exp(1j * np.pi * share)).real, color=tone, lw=1.5, label=label)
    ax.axhline(0, color=MUTED, lw=0.8)
    ax.set_xlim(found.x[0], found.x[-1])
    ax.set_xlabel("x, m")
    ax.set_ylabel("deflection")
    if vehicle.frequency:
        ax.legend(loc="center left", bbox_to_anchor=(1, 0.5))
    return drawn


def _map(vehicle: Vehicle) -> Figure:
    gain = vehicle.settings.get("gimbal.gain", 0.0)
    gains = np.linspace(0, 2 * gain or 1.0, GAINS)
    top = max(_top(vehicle), 1.25 * (vehicle.settings.get("thrust") or 0.0))
    found = vehicle.map(gains, np.linspace(0, top, THRUSTS + 1)[1:])
    drawn, (ax,) = _axes(height=3.6)
    grows = np.where(found.growth > 0, found.growth, np.nan)
    if np.isfinite(grows).any():
        shown = ax.pcolormesh(found.gain, found.thrust, grows.T, cmap="Oranges", shading="nearest", vmin=0)
        drawn.colorbar(shown, ax=ax, label="growth, 1/s; blank is stable")
    ax.plot(found.gain, found.load, color=ACCENT, marker="o", ms=3)
    if "thrust" in vehicle.settings:
        ax.plot([gain], [vehicle.settings["thrust"]], "s", color=INK, ms=5)
        note(ax, gain, vehicle.settings["thrust"], "the vehicle", (8, 0))
    ax.set_xlabel("gain, rad/rad")
    ax.set_ylabel("thrust, N")
    ax.set_xlim(gains[0], gains[-1])
    ax.set_ylim(0, top)
    return drawn


def _bode(vehicle: Vehicle) -> Figure:
    found = vehicle.modes(number=8)
    own = found.frequency[found.frequency > 0]
    lowest, highest = vehicle.frequencies[0], own[: min(4, len(own))].max()
    omega = np.geomspace(0.05 * lowest, 1.5 * highest, 500)
    near = [w * (1 + s) for w in own for s in np.linspace(-0.02, 0.02, 40) if w < omega[-1]]
    omega = np.unique(np.concatenate([omega, near]))
    response = vehicle.frequency_response(omega, outputs=("angle", "ddy"))
    drawn, axes = _axes(2, 4.4, sharex=True)
    for ax, values, name in zip(axes, response, ("angle, rad/rad", "acceleration, m/s²/rad"), strict=True):
        ax.loglog(omega / (2 * math.pi), np.abs(values), color=COLOURS[0], lw=1.3)
        ax.set_ylabel(name)
    axes[-1].set_xlabel("frequency, Hz")
    return drawn


def _pulse(vehicle: Vehicle) -> Figure:
    period = 2 * math.pi / float(vehicle.frequencies[0])
    last = period / 2
    found = vehicle.respond(
        6 * period, period / 200, lambda t: np.where(t < last, np.radians(1) * np.sin(np.pi * t / last) ** 2, 0.0)
    )
    drawn, axes = _axes(2, 4.4, sharex=True)
    for ax, name, label in zip(axes, ("rate", "ddy"), ("rate of the angle, rad/s", "acceleration, m/s²"), strict=True):
        ax.plot(found["t"], found[name][:, 0], color=COLOURS[0], lw=1.2)
        ax.axhline(0, color=MUTED, lw=0.7)
        ax.set_ylabel(label)
    axes[-1].set_xlabel("time, s")
    axes[-1].set_xlim(0, found["t"][-1])
    return drawn


# --- files --------------------------------------------------------------------------------------------------------

NOTE = (
    "The vehicle is a beam that is free at both ends. The thrust acts at the largest x and follows the end; what it "
    "accelerates compresses the beam: the axial force is the thrust times the share of the mass that lies ahead. "
    "Stable means that no elastic motion grows, with a gimbal law also not the rotation that it steers; a free vehicle "
    "drifts and tumbles at any thrust. Errors are estimated from two series of trial functions, and are those of the "
    "beam as its tables state it."
)
LOOK = """
body { font: 16px/1.5 system-ui, sans-serif; color: #222; max-width: 46rem; margin: 2rem auto; padding: 0 1rem; }
h1 { font-size: 1.6rem; } h2 { font-size: 1.15rem; margin: 2rem 0 .2rem; } p { margin: .3rem 0 .6rem; }
table { border-collapse: collapse; margin: 1rem 0; } td { border-top: 1px solid #ddd; padding: .3rem .8rem .3rem 0; }
td:first-child { color: #666; white-space: nowrap; } img { width: 100%; height: auto; } .note { color: #555; }
@media print { section { break-inside: avoid; } }
"""


def _settings(vehicle: Vehicle) -> list[list[str]]:
    from freebeam.vehicles.tables import SETTINGS

    counts = {kind: sum(part.kind == kind for part in vehicle.parts) for kind in ("mass", "sprung", "spring", "joint")}
    parts = ", ".join(f"{count} {kind}" for kind, count in counts.items() if count)
    rows = [["stations", f"{len(vehicle.stations.x)}"], *([["parts", parts]] if parts else [])]
    for name, value in vehicle.settings.items():
        unit, meaning = SETTINGS[name]
        rows.append([name, f"{value:.6g}{f' {unit}' if unit else ''}: {meaning}"])
    return rows


def _html(vehicle: Vehicle, shown: list[Shown]) -> bytes:
    def table(rows: list[list[str]]) -> str:
        cells = ("".join(f"<td>{html.escape(cell)}</td>" for cell in row) for row in rows)
        return "<table>" + "".join(f"<tr>{row}</tr>" for row in cells) + "</table>"

    title = html.escape(vehicle.name)
    parts = [f"<h1>{title}</h1>", table(facts(vehicle)), f'<p class="note">{html.escape(NOTE)}</p>']
    for picture in shown:
        data = base64.b64encode(image_of(picture.drawn, "svg", picture.title)).decode()
        alt = html.escape(f"{picture.title}. {picture.words}", quote=True)
        parts.append(
            f"<section><h2>{html.escape(picture.title)}</h2><p>{html.escape(picture.words)}</p>"
            f'<img alt="{alt}" src="data:image/svg+xml;base64,{data}"></section>'
        )
    parts += ["<h2>What was computed</h2>", table(_settings(vehicle))]
    head = f'<meta charset="utf-8"><meta name="viewport" content="width=device-width"><title>{title}</title>'
    text = f'<!doctype html>\n<html lang="en"><head>{head}<style>{LOOK}</style></head><body>'
    return (text + "\n".join(parts) + "</body></html>\n").encode()


PAPER = (8.27, 11.69)
"""A4, in inches."""


def _on_paper(picture: Shown) -> Figure:
    """A picture at the top of a page, below its title and words."""
    drawn = picture.drawn
    width, height = drawn.get_size_inches() / PAPER
    drawn.set_size_inches(PAPER)
    drawn.set_layout_engine("constrained", rect=(0.08, 0.89 - height, width, height))
    drawn.text(0.1, 0.93, picture.title, fontsize=13)
    drawn.text(0.1, 0.91, picture.words, fontsize=9, color=MUTED)
    return drawn


def _pdf(vehicle: Vehicle, shown: list[Shown]) -> bytes:
    import textwrap

    from matplotlib.backends.backend_pdf import PdfPages

    stream = io.BytesIO()
    first = figure(PAPER)
    first.text(0.1, 0.93, vehicle.name, fontsize=17)
    place = 0.89
    for rows in (facts(vehicle), _settings(vehicle)):
        for name, value in rows:
            lines = textwrap.wrap(value, 78)
            first.text(0.1, place, name, fontsize=9, color=MUTED, va="top")
            first.text(0.3, place, "\n".join(lines), fontsize=9, va="top", linespacing=1.4)
            place -= 0.008 + 0.0145 * len(lines)
        place -= 0.02
    first.text(0.1, place, "\n".join(textwrap.wrap(NOTE, 100)), fontsize=9, color=MUTED, va="top", linespacing=1.5)
    with PdfPages(stream, metadata=PLAIN["pdf"] | {"Title": vehicle.name}) as pages:
        pages.savefig(first)
        for picture in shown:
            pages.savefig(_on_paper(picture))
    return stream.getvalue()
