"""The paper's figures, Figs. 1 to 10: what each shows, with which settings, its numbers and its drawing.

Words and settings are in published.toml.
"""

from __future__ import annotations

import math
import tomllib
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from importlib.resources import files
from typing import TYPE_CHECKING, Any

import numpy as np

from freebeam.figures import curves
from freebeam.figures.diagrams import draw_critical, draw_locus, draw_part, stability_map
from freebeam.figures.look import INK, MUTED, figure, shades, style
from freebeam.figures.marks import colour, digits, dot, key, legend, mark, note, plain
from freebeam.figures.schematic import beam, centre_line
from freebeam.figures.shapes import history, trajectory
from freebeam.maps.known import critical_load
from freebeam_sym.checks import InputError
from freebeam_sym.columns import column as column_of
from freebeam_sym.question import Question
from freebeam_sym.response import Response, respond
from freebeam_sym.spectra import spectrum

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from freebeam_sym.columns import Column, System

__all__ = ["NUMBERS", "Picture", "as_printed", "paper", "picture"]

COLUMN, MODES = "free-free", 8


def _data() -> dict[int, dict[str, Any]]:
    """The figures of published.toml by their numbers."""
    found = tomllib.loads((files("freebeam.figures") / "published.toml").read_text(encoding="utf-8"))
    for entry in found.values():
        for words in ("title", "caption", "chosen"):
            text = entry.get(words, "")
            text = found[text[1:]][words] if text.startswith("@") else text
            entry[words] = " ".join(text.split())
        entry["settings"] = {
            name: tuple(value) if isinstance(value, list) else value for name, value in entry["settings"].items()
        }
    return {int(number): entry for number, entry in found.items()}


FIGURES = _data()
SETTINGS: dict[int, dict[str, Any]] = {number: entry["settings"] for number, entry in FIGURES.items()}
NUMBERS = tuple(SETTINGS)


@dataclass(frozen=True)
class Picture:
    """A figure of the paper: what it says, the numbers that it shows, and how it is drawn."""

    number: int
    title: str
    caption: str
    settings: dict[str, Any]
    marks: dict[str, Any]
    """Values that the figure marks."""
    table: dict[str, Any]
    """Its data, columns by name."""
    draw: Callable[[], Figure] = field(repr=False)
    """Draws it; to be called within `style`."""


def picture(number: int) -> Picture:
    """The data of a figure of the paper and how to draw it. Raises InputError for a number that it does not have."""
    if number not in SETTINGS or isinstance(number, bool):
        raise InputError(f"figure {number}: there is none; the paper's figures are {NUMBERS[0]} to {NUMBERS[-1]}")
    entry, settings = FIGURES[number], {"column": COLUMN, "modes": MODES, **SETTINGS[number]}
    words, marks, table, draw = _DRAWN[number](column_of(COLUMN), SETTINGS[number])
    values = {**settings, **marks, **words}
    title = entry["title"].format(**values)
    caption = f"{title}. {entry['caption'].format(**values)} {entry['chosen']}".rstrip()
    return Picture(number, title, caption, settings, marks, table, draw)


def paper(number: int) -> Figure:
    """A figure of the paper, redrawn from computed data, as a matplotlib Figure. Raises InputError for a number that
    the paper does not have, and without matplotlib."""
    with style():
        return picture(number).draw()


def as_printed(system: System) -> System:
    """The system with the end term of Eq. (11) as the paper prints it, transposed. The spectrum is the same, responses
    are not: docs/errata.md."""
    end = np.outer(system.shapes(1.0), system.shapes(1.0, 1))
    return replace(system, K=system.K + system.load * (end.T - end), H=system.H + end.T - end)


_Parts = tuple[dict[str, Any], dict[str, Any], dict[str, Any], Callable[[], "Figure"]]
"""What the words of a figure need beside its settings and marks; marks, table and drawing as in `Picture`."""


def _fig_1(column: Column, s: dict[str, Any]) -> _Parts:
    ((x, y, _),) = centre_line(column, 200)

    def draw() -> Figure:
        fig = figure((6.4, 2.7))
        beam(column, x_s=s["x_s"], x_F=s["x_F"], ax=fig.subplots())
        return fig

    return {}, {}, {"x": x, "y": y}, draw


def _scanned(load: float, step: float) -> str:
    """The first multiple of a step at or above a load: what a scan prints."""
    return f"{math.ceil(load / step) * step:.{max(0, -math.floor(math.log10(step)))}f}"


def _locus(column: Column, s: dict[str, Any]) -> tuple[curves.Locus, dict[str, Any], dict[str, Any]]:
    found = curves.locus(Question.of(column, MODES, s["alpha"], s["beta"]), s["load_max"])
    critical = found.critical
    assert critical and critical.load is not None and critical.frequency is not None
    words = {"kind": critical.kind, "scanned": _scanned(critical.load, s["scan_step"])}
    marks = {"critical_load": critical.load, "critical_frequency": critical.frequency, "lambda_0": found.scale(True)}
    return found, words, marks


def _fig_2(column: Column, s: dict[str, Any]) -> _Parts:
    found, words, marks = _locus(column, s)

    def draw() -> Figure:
        fig = figure((7.6, 3.1))
        for ax, part, name in zip(fig.subplots(1, 2), ("real", "imaginary"), "ab", strict=True):
            draw_part(ax, column, found, part, True)
            ax.set_title(f"({name}) {part} part")
            if name == "a":
                key(ax, loc="lower left")
        return fig

    return words, marks, found.table(True), draw


def _fig_in_the_plane(column: Column, s: dict[str, Any]) -> _Parts:
    found, words, marks = _locus(column, s)

    def draw() -> Figure:
        fig = figure((5.4, 4.2))
        draw_locus(fig.subplots(), column, found, True)
        return fig

    return words, marks, found.table(True), draw


def _range(limits: tuple[float, float, int]) -> Any:
    return np.geomspace(*limits)


def _fig_4(column: Column, s: dict[str, Any]) -> _Parts:
    found = curves.critical_curve(Question.of(column, MODES, beta=s["beta"]), "alpha", _range(s["alpha"]))
    undamped = critical_load(column, MODES).load
    limit = critical_load(column, MODES, kappa=0.0).load
    assert undamped is not None and limit is not None
    first, last = float(found.loads[0]), float(found.loads[-1])

    def draw() -> Figure:
        fig = figure((5.4, 3.5))
        ax = fig.subplots()
        ax.axhline(undamped, color=INK, lw=1.0, ls=(0, (1, 1.6)), zorder=2)
        draw_critical(ax, column, found)
        note(ax, found.values[0], undamped, f"no damping: {digits(undamped)}", (6, -6))
        mark(ax, found.values[0], first, digits(first), (9, 8))
        mark(ax, found.values[-1], last, digits(last), (-9, 6))
        ax.set_ylim(limit - 3, undamped + 3)
        return fig

    marks = {"undamped": undamped, "vanishing_alpha": limit, "least_alpha": first, "greatest_alpha": last}
    return {}, marks, found.table(), draw


def _fig_5(column: Column, s: dict[str, Any]) -> _Parts:
    found = curves.critical_curve(Question.of(column, MODES, s["alpha"]), "beta", _range(s["beta"]))
    undamped = critical_load(column, MODES).load
    assert undamped is not None
    first, last = float(found.loads[0]), float(found.loads[-1])

    def draw() -> Figure:
        fig = figure((5.4, 3.5))
        ax = fig.subplots()
        draw_critical(ax, column, found)
        ax.set_xlim(found.values[0], found.values[-1])
        mark(ax, found.values[0], first, f"{first:.4f}", (9, 8))
        mark(ax, found.values[-1], last, f"{last:.4f}", (-11, 0))
        ax.margins(y=0.15)
        return fig

    marks = {"undamped": undamped, "least_beta": first, "greatest_beta": last}
    return {"range": last - first}, marks, found.table(), draw


def _fig_6(column: Column, s: dict[str, Any]) -> _Parts:
    alphas, betas = _range(s["alpha"]), np.append(s["beta_also"], _range(s["beta"]))
    family = [curves.critical_curve(Question.of(column, MODES, beta=beta), "alpha", alphas) for beta in betas.tolist()]
    loads = np.array([found.loads for found in family])
    undamped = critical_load(column, MODES).load
    assert undamped is not None
    drawn = [0, *range(1, len(betas), (len(betas) - 2) // 4)]
    lowest = {f"{betas[k]:.3g}": (float(alphas[loads[k].argmin()]), float(loads[k].min())) for k in drawn[1:]}

    def draw() -> Figure:
        fig = figure((9.2, 3.7))
        left, right = fig.subplots(1, 2, width_ratios=[1.0, 1.12])
        middle = (undamped + float(loads.min())) / 2
        for k, tone in zip(drawn, shades(len(drawn)), strict=True):
            draw_critical(left, column, family[k], rf"$\beta$ = {betas[k]:.2g}", tone)
            if k:
                least = int(loads[k].argmin())
                dot(left, alphas[least], loads[k, least], tone, mew=0.8, ms=5, zorder=5)
                falls = int(np.argmax(loads[k] < middle))
                text, ha = (rf"$\beta$ = {betas[k]:.2g}", "right") if k == 1 else (f"{betas[k]:.2g}", "center")
                at = (-6 if k == 1 else 0, 0)
                note(left, alphas[falls], loads[k, falls], text, at, ha=ha, va="center", color=tone)
        note(left, alphas[0], loads[0, 0], rf"$\beta$ = {betas[0]:g}", (6, 6), color=shades(len(drawn))[0])
        left.axhline(undamped, color=INK, lw=1.0, ls=(0, (1, 1.6)), zorder=2)
        note(left, alphas[-1], undamped, f"no damping: {digits(undamped)}", (-6, 6))
        left.set_ylim(None, undamped + 3)
        left.set_title("(a) along α; dots: least load")
        labels = {"xlabel": r"internal damping $\alpha$", "ylabel": r"external damping $\beta$"}
        stability_map(loads[1:].T, alphas, betas[1:], **labels, ax=right)
        right.set_title(r"(b) over both")
        return fig

    words = {"lowest": "; ".join(f"β = {b}: {load:.2f} at α = {a:.2g}" for b, (a, load) in lowest.items())}
    grid = np.meshgrid(betas, alphas, indexing="ij")
    table = {"alpha": grid[1].ravel(), "beta": grid[0].ravel(), "P_cr": loads.ravel()}
    table["omega"] = np.concatenate([found.frequencies for found in family])
    marks = {"undamped": undamped, "least": {beta: {"alpha": a, "load": load} for beta, (a, load) in lowest.items()}}
    return words, marks, table, draw


def _fig_in_time(column: Column, s: dict[str, Any]) -> _Parts:
    system = column.system(MODES, s["load"], s["alpha"], s["beta"])
    start = s["q_1"] * np.eye(MODES)[0]
    found = respond(system, s["duration"], s["step"], initial=start, sensors=[s["x_s"]], method="newmark")
    rate = spectrum(system).growth_rate

    def draw() -> Figure:
        fig = figure((7.8, 5.4))
        axes = fig.subplots(2, 2)
        for ax, quantity, name in zip(axes.flat, ("y", "dy", "ddy"), "abc", strict=False):
            history(found, quantity, ax=ax)
            ax.set_title(f"({name}) {ax.get_ylabel().split(' ')[0]}")
        trajectory(found, ax=axes[1, 1])
        axes[1, 1].set_title("(d) trajectory")
        return fig

    fate = "it grows" if rate > 0 else "it decays"
    words = {"rate": plain(rate), "fate": fate, "period_error": found.period_error}
    table = {"t": found.t, "y": found.y[:, 0], "dy": found.dy[:, 0], "ddy": found.ddy[:, 0]}
    return words, {"growth_rate": rate}, table, draw


def _steady(system: System, s: dict[str, Any], amplitude: float) -> float:
    """Amplitude at x_s of the steady elastic motion under amplitude · sin ωt at x_F."""
    w = s["frequency"]
    q = np.linalg.solve(-w * w * system.M + 1j * w * system.C + system.K, system.Q(s["x_F"]))
    return amplitude * float(abs(system.shapes(s["x_s"]) @ q))


def _fig_10(column: Column, s: dict[str, Any]) -> _Parts:
    def response(system: System, amplitude: float) -> Response:
        def force(t: Any) -> Any:
            return amplitude * np.sin(s["frequency"] * t)

        return respond(
            system, s["duration"], s["step"], force=force, force_position=s["x_F"], sensors=[s["x_s"]],
            initial=np.zeros(len(system.M)), method="newmark",
        )  # fmt: skip

    makes: dict[str, Callable[[float], System]] = {
        "derived": lambda load: column.system(MODES, load, s["alpha"], s["beta"]),
        "printed": lambda load: as_printed(column.system(MODES, load, s["alpha"], s["beta"])),
        "rigid": lambda load: column.system(MODES, load, s["alpha"], s["beta"], rigid=True),
    }
    cases = [(load, amplitude) for amplitude in s["amplitudes"] for load in s["loads"]]
    runs = {(kind, *case): response(makes[kind](case[0]), case[1]) for kind in makes for case in cases}
    steady = {
        (kind, load, size): _steady(makes[kind](load), s, size)
        for kind in ("derived", "printed")
        for load, size in cases
    }
    low, high = s["loads"]
    size = s["amplitudes"][0]
    growth = {kind: steady[kind, high, size] / steady[kind, low, size] for kind in ("derived", "printed")}
    tones = dict(zip(s["loads"], (colour(0), colour(1)), strict=True))

    def draw() -> Figure:
        fig = figure((9.0, 7.6))
        grid = fig.add_gridspec(3, 2, height_ratios=[1, 1, 1.15])
        heads = {"derived": "as derived", "printed": "as printed, end term of Eq. (11) transposed"}
        for i, amplitude in enumerate(s["amplitudes"]):
            pair: list[Any] = []
            for j, (kind, head) in enumerate(heads.items()):
                ax = fig.add_subplot(grid[i, j], sharey=pair[0] if pair else None)
                pair.append(ax)
                for load in (high, low):
                    label = f"$P_0$ = {load:g}: {_power(steady[kind, load, amplitude])}"
                    history(runs[kind, load, amplitude], color=tones[load], label=label, ax=ax)
                ax.set_ylabel("" if j else f"elastic part of $y$, $F_0$ = {amplitude:g}")
                ax.set_title(f"({'abcd'[2 * i + j]}) {head}")
            largest = max(steady[kind, load, amplitude] for kind in heads for load in s["loads"])
            for ax in pair:
                ax.set_ylim(-1.25 * largest, 2.1 * largest)
                legend(ax, loc="upper right", ncols=2, title="tends to the amplitude", alignment="right")
        ax = fig.add_subplot(grid[2, :])
        for load, amplitude in reversed(cases):
            run = runs["rigid", load, amplitude]
            width = 1.0 + 1.4 * s["amplitudes"].index(amplitude)
            label = f"$P_0$ = {load:g}, $F_0$ = {amplitude:g}"
            ax.plot(run.t, np.abs(run.y_rigid[:, 0]), color=tones[load], lw=width, label=label)
        ax.set_yscale("log")
        ax.set_ylim(1e-7, None)
        ax.axhspan(min(steady[x] for x in steady), max(steady[x] for x in steady), color=MUTED, alpha=0.25, lw=0)
        note(ax, s["duration"], max(steady.values()), "amplitudes of the elastic part", (-6, 5), color=MUTED)
        ax.set_xlim(0, s["duration"])
        ax.set_xlabel("time $t$")
        ax.set_ylabel("rigid part, $|y|$")
        ax.set_title("(e) drift and turning of the free beam at the same sensor, as derived")
        legend(ax, loc="center right", ncols=2)
        return fig

    drift = max(float(np.abs(runs["rigid", *case].y_rigid[:, 0]).max()) for case in cases)
    largest = max(steady["derived", *case] for case in cases)
    words = {kind: 100 * (factor - 1) for kind, factor in growth.items()}
    words["power"] = math.floor(math.log10(drift / largest))
    table = {"t": runs["derived", low, size].t}
    for (kind, load, amplitude), run in runs.items():
        values = run.y_rigid if kind == "rigid" else run.y_elastic
        table[f"y_{kind}_P{load:g}_F{amplitude:g}"] = values[:, 0]
    marks = {
        "growth_derived": growth["derived"], "growth_printed": growth["printed"],
        "steady": {f"{kind}_P{load:g}_F{size:g}": value for (kind, load, size), value in steady.items()},
    }  # fmt: skip
    return words, marks, table, draw


def _power(value: float) -> str:
    """A small number as 1.23·10⁻⁶, for a label."""
    mantissa, exponent = f"{value:.2e}".split("e")
    return rf"${mantissa}\cdot 10^{{{int(exponent)}}}$"


_DRAWN: dict[int, Callable[[Column, dict[str, Any]], _Parts]] = {
    1: _fig_1, 2: _fig_2, 3: _fig_in_the_plane, 4: _fig_4, 5: _fig_5, 6: _fig_6, 7: _fig_in_the_plane,
    8: _fig_in_time, 9: _fig_in_time, 10: _fig_10,
}  # fmt: skip
