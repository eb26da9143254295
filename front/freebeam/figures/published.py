"""The paper's figures, Figs. 1 to 10: what each shows, with which settings, its numbers and its drawing.

The settings are the paper's. `CHOSEN` says what it leaves unstated.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from freebeam.figures import curves
from freebeam.figures.diagrams import draw_critical, draw_locus, draw_part, stability_map
from freebeam.figures.look import INK, MUTED, figure, shades, style
from freebeam.figures.marks import colour, digits, dot, key, legend, mark, note, plain
from freebeam.figures.shapes import history, trajectory
from freebeam.figures.sketch import beam, centre_line
from freebeam_sym.checks import InputError
from freebeam_sym.columns import column as column_of
from freebeam_sym.response import Response, respond
from freebeam_sym.spectra import spectrum
from freebeam_sym.stability.critical import critical_load

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from freebeam_sym.columns import Column, System

__all__ = ["NUMBERS", "Picture", "as_printed", "paper", "picture"]

COLUMN, MODES = "free-free", 8
DAMPED = {"alpha": 1e-3, "beta": 0.1}
SETTINGS: dict[int, dict[str, Any]] = {
    1: {"x_s": 0.15, "x_F": 0.7},
    2: {"load_max": 120.0, "alpha": 0.0, "beta": 0.0, "scan_step": 0.1},
    3: {"load_max": 120.0, "alpha": 0.0, "beta": 0.0, "scan_step": 0.01},
    4: {"alpha": (1e-6, 1e-1, 101), "beta": 0.0},
    5: {"alpha": 0.0, "beta": (1e-2, 1e0, 61)},
    6: {"alpha": (1e-6, 1e-1, 51), "beta": (1e-2, 1e0, 17), "beta_also": 0.0},
    7: {"load_max": 120.0, **DAMPED, "scan_step": 0.1},
    8: {"load": 9.0, **DAMPED, "x_s": 0.1, "q_1": 0.001, "duration": 10.0, "step": 0.002},
    9: {"load": 112.0, **DAMPED, "x_s": 0.1, "q_1": 0.001, "duration": 1.5, "step": 0.001},
    10: {
        "loads": (5.0, 50.0), "amplitudes": (0.001, 0.002), "frequency": 3.0, **DAMPED,
        "x_s": 0.1, "x_F": 1.0, "duration": 20.0, "step": 0.005,
    },
}  # fmt: skip
CHOSEN: dict[int, str] = {
    1: "x_s and x_F are drawn at places where they can be seen; the deflection is the lowest mode, turned a little.",
    2: "The range of the load is chosen here.",
    3: "The range of the load is chosen here.",
    6: "The values of β are chosen here, over the range of Fig. 5.",
    7: "The range of the load is chosen here.",
    8: "The paper does not state its initial condition: here the first mode at rest, q₁ = 0.001 in Eq. (9) with the "
    "modes of Eq. (22). Elastic motion only; the duration is chosen here.",
    9: "The paper does not state its initial condition: here the first mode at rest, q₁ = 0.001 in Eq. (9) with the "
    "modes of Eq. (22). Elastic motion only; the duration is chosen here.",
    10: "The beam starts at rest; the duration is chosen here.",
}
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
    settings = {"column": COLUMN, "modes": MODES, **SETTINGS[number]}
    title, text, marks, table, draw = _FIGURES[number](column_of(COLUMN), SETTINGS[number])
    caption = f"{title}. {text}"
    if number in CHOSEN:
        caption += f" {CHOSEN[number]}"
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


_Parts = tuple[str, str, dict[str, Any], dict[str, Any], Callable[[], "Figure"]]


def _fig_1(column: Column, s: dict[str, Any]) -> _Parts:
    x, y, _ = centre_line(column)

    def draw() -> Figure:
        fig = figure((6.4, 2.7))
        beam(column, x_s=s["x_s"], x_F=s["x_F"], ax=fig.subplots())
        return fig

    text = "The follower force P₀ stays normal to the cross-section at x = L; F₀(t) stays transversal."
    return "A free-free beam subjected to follower and transversal forces", text, {}, {"x": x, "y": y}, draw


def _scanned(load: float, step: float) -> str:
    """The first multiple of a step at or above a load: what a scan prints."""
    return f"{math.ceil(load / step) * step:.{max(0, -math.floor(math.log10(step)))}f}"


def _locus(column: Column, s: dict[str, Any]) -> tuple[curves.Locus, str, dict[str, Any]]:
    found = curves.locus(column, s["load_max"], modes=MODES, alpha=s["alpha"], beta=s["beta"])
    critical = found.critical
    assert critical.load is not None and critical.frequency is not None
    text = (
        f"α = {s['alpha']:g}, β = {s['beta']:g}, N = {MODES}; eigenvalues divided by λ₀ = {found.scale(True):.6g} as "
        f"in Eq. (26). Critical load {critical.load:.4f} ({critical.kind}, ω = {critical.frequency:.4f}); a scan in "
        f"steps of {s['scan_step']:g}, which the paper used, prints {_scanned(critical.load, s['scan_step'])}. "
        "Solid: stable; dashed: growing."
    )
    marks = {"critical_load": critical.load, "critical_frequency": critical.frequency, "lambda_0": found.scale(True)}
    return found, text, marks


def _fig_2(column: Column, s: dict[str, Any]) -> _Parts:
    found, text, marks = _locus(column, s)

    def draw() -> Figure:
        fig = figure((7.6, 3.1))
        for ax, part, name in zip(fig.subplots(1, 2), ("real", "imaginary"), "ab", strict=True):
            draw_part(ax, column, found, part, True)
            ax.set_title(f"({name}) {part} part")
            if name == "a":
                key(ax, loc="lower left")
        return fig

    title = "Variation of the first two eigenvalues of matrix A due to the changes in P₀"
    return title, text, marks, found.table(True), draw


def _fig_in_the_plane(column: Column, s: dict[str, Any]) -> _Parts:
    found, text, marks = _locus(column, s)

    def draw() -> Figure:
        fig = figure((5.4, 4.2))
        draw_locus(fig.subplots(), column, found, True)
        return fig

    title = "Variation of the first two eigenvalues of matrix A due to the changes in P₀ in the complex plane"
    return title, text, marks, found.table(True), draw


def _range(limits: tuple[float, float, int]) -> Any:
    return np.geomspace(*limits)


def _fig_4(column: Column, s: dict[str, Any]) -> _Parts:
    found = curves.critical_curve(column, "alpha", _range(s["alpha"]), modes=MODES, beta=s["beta"])
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

    text = (
        f"β = 0, N = {MODES}. Without damping the load is {undamped:.4f}; the least α takes it at once to "
        f"{first:.4f} (α → 0⁺: {limit:.4f}, the tangent rule), and more α raises it, to {last:.4f} at "
        f"α = {found.values[-1]:g}. All are flutter."
    )
    marks = {"undamped": undamped, "vanishing_alpha": limit, "least_alpha": first, "greatest_alpha": last}
    return "Effect of α on the value of P₀cr (assuming β = 0)", text, marks, found.table(), draw


def _fig_5(column: Column, s: dict[str, Any]) -> _Parts:
    found = curves.critical_curve(column, "beta", _range(s["beta"]), modes=MODES, alpha=s["alpha"])
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

    text = (
        f"α = 0, N = {MODES}. From {first:.5f} at β = {found.values[0]:g} to {last:.5f} at β = {found.values[-1]:g}; "
        f"{undamped:.5f} without damping. The whole range of the axis is {last - first:.2g}. All are flutter."
    )
    marks = {"undamped": undamped, "least_beta": first, "greatest_beta": last}
    return "Effect of β on the value of P₀cr (assuming α = 0)", text, marks, found.table(), draw


def _fig_6(column: Column, s: dict[str, Any]) -> _Parts:
    alphas, betas = _range(s["alpha"]), np.append(s["beta_also"], _range(s["beta"]))
    family = [curves.critical_curve(column, "alpha", alphas, modes=MODES, beta=beta) for beta in betas.tolist()]
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

    least = "; ".join(f"β = {beta}: {load:.2f} at α = {alpha:.2g}" for beta, (alpha, load) in lowest.items())
    text = (
        f"N = {MODES}. At a given α, more β raises the load. At a given β, more α first lowers it and then raises it; "
        f"least among the values of α computed: {least}. Dotted: no damping, {undamped:.4f}. All are flutter."
    )
    grid = np.meshgrid(betas, alphas, indexing="ij")
    table = {"alpha": grid[1].ravel(), "beta": grid[0].ravel(), "P_cr": loads.ravel()}
    table["omega"] = np.concatenate([found.frequencies for found in family])
    marks = {"undamped": undamped, "least": {beta: {"alpha": a, "load": load} for beta, (a, load) in lowest.items()}}
    return "Effect of α and β on the value of P₀cr", text, marks, table, draw


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

    text = (
        f"N = {MODES}. The slowest motion goes as exp({plain(rate)} t): {'it grows' if rate > 0 else 'it decays'}. "
        f"Newmark's average acceleration, step {s['step']:g}, relative error of the first period "
        f"{found.period_error:.1e}."
    )
    title = (
        f"Vibrational properties for the case of P₀ = {s['load']:g}, α = {s['alpha']:g}, β = {s['beta']:g} and F₀ = 0 "
        f"at point x_s = {s['x_s']:g}"
    )
    table = {"t": found.t, "y": found.y[:, 0], "dy": found.dy[:, 0], "ddy": found.ddy[:, 0]}
    return title, text, {"growth_rate": rate}, table, draw


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
    text = (
        f"F₀ sin({s['frequency']:g} t) at x_F = {s['x_F']:g}, N = {MODES}. (a) to (d): the elastic part, which tends "
        f"to a steady amplitude; from P₀ = {low:g} to {high:g} that grows by {100 * (growth['derived'] - 1):.0f} % "
        f"with the equation as derived and by {100 * (growth['printed'] - 1):.0f} % with the end term of Eq. (11) as "
        "printed, transposed. (e): the rigid motion that the free beam adds at the sensor: at the end more than "
        f"10^{math.floor(math.log10(drift / largest))} times the elastic amplitude, and far beyond small motion."
    )
    table = {"t": runs["derived", low, size].t}
    for (kind, load, amplitude), run in runs.items():
        values = run.y_rigid if kind == "rigid" else run.y_elastic
        table[f"y_{kind}_P{load:g}_F{amplitude:g}"] = values[:, 0]
    marks = {
        "growth_derived": growth["derived"], "growth_printed": growth["printed"],
        "steady": {f"{kind}_P{load:g}_F{size:g}": value for (kind, load, size), value in steady.items()},
    }  # fmt: skip
    title = (
        f"Increase in the displacement of point x_s = {s['x_s']:g} due to the increase in the follower and transversal "
        f"forces for the case of β = {s['beta']:g}, α = {s['alpha']:g}, x_F = {s['x_F']:g}"
    )
    return title, text, marks, table, draw


def _power(value: float) -> str:
    """A small number as 1.23·10⁻⁶, for a label."""
    mantissa, exponent = f"{value:.2e}".split("e")
    return rf"${mantissa}\cdot 10^{{{int(exponent)}}}$"


_FIGURES: dict[int, Callable[[Column, dict[str, Any]], _Parts]] = {
    1: _fig_1, 2: _fig_2, 3: _fig_in_the_plane, 4: _fig_4, 5: _fig_5, 6: _fig_6, 7: _fig_in_the_plane,
    8: _fig_in_time, 9: _fig_in_time, 10: _fig_10,
}  # fmt: skip
