"""Drawings of motion: the shape of flutter, the work of the load over a cycle, responses in time.

Each draws in the axes `ax` or in new ones, and returns the axes. Nondimensional.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from freebeam.figures import curves
from freebeam.figures.look import ACCENT, INK, MUTED, drawing, shades
from freebeam.figures.marks import arrow, colour, digits, dot, legend, note, plain, symbol
from freebeam_sym.checks import InputError, count
from freebeam_sym.question import Question

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from freebeam_sym.columns import Column
    from freebeam_sym.response import Response

__all__ = ["history", "mode_shape", "trajectory", "work", "work_loop"]


def mode_shape(
    column: Column,
    load: float | None = None,
    *,
    modes: int | None = None,
    alpha: float = 0.0,
    beta: float = 0.0,
    rigid: bool = False,
    moments: int = 7,
    ax: Axes | None = None,
    **parameters: Any,
) -> Axes:
    """The least stable motion, by default the one at the critical load: the beam at `moments` of half a period, dark
    to light (the other half mirrors it), and between which lines it moves. Largest |Y| is 1; growth is left out.

    rigid: with the rigid motion that the elastic one drives. Raises InputError where that motion does not oscillate,
    and for a column without a field, such as a chain of links.
    """
    if not column.ends:
        raise InputError(f"{column.name}: has no field along a beam whose shape could be drawn")
    found = curves.cycle(Question.of(column, modes, alpha, beta, **parameters), load, rigid=rigid)
    x = np.linspace(0.0, 1.0, 201)
    Y = found.shape(x)
    Y = Y * np.exp(-1j * np.angle(Y[np.abs(Y).argmax()]))
    with drawing(ax, (5.2, 3.0)) as ax:
        ax.fill_between(x, -np.abs(Y), np.abs(Y), color="#F1F1F1", lw=0, zorder=1)
        for k, tone in enumerate(shades(moments)):
            share = k / max(moments - 1, 1)
            name = {0.0: "$t = 0$", 0.5: "$t = T/4$", 1.0: "$t = T/2$"}.get(share)
            ax.plot(x, (Y * np.exp(1j * np.pi * share)).real, color=tone, lw=1.6, zorder=3, label=name)
        ax.plot([0, 1], [0, 0], color=MUTED, lw=0.8, zorder=2)
        ax.set_xlim(-0.02, 1.02)
        ax.set_ylim(-1.1, 1.1)
        ax.set_xlabel("place $x$ on the beam")
        ax.set_ylabel("deflection $y$")
        letter = symbol(column, "P")
        ax.set_title(f"{letter} = {digits(found.system.load)}, $\\omega$ = {digits(found.eigenvalue.imag)}")
        legend(ax, loc="center left", bbox_to_anchor=(1.0, 0.5))
    return ax


def work(
    column: Column,
    load: float | None = None,
    *,
    modes: int | None = None,
    alpha: float = 1e-3,
    beta: float = 0.1,
    ax: Axes | None = None,
    **parameters: Any,
) -> Axes:
    """Why a beam flutters: what the load gives the beam through one period of its least stable motion, beyond what it
    takes back, and what damping takes. Where it gives more, the motion grows; at the critical load, the default, both
    end equal.

    In shares of twice the mean kinetic energy. Raises InputError where that motion does not oscillate.
    """
    found = curves.cycle(Question.of(column, modes, alpha, beta, **parameters), load)
    turn = found.phase / (2 * np.pi)
    given, taken = float(found.work[-1]), float(found.dissipated[-1])
    even = abs(given - taken) <= 1e-9 * max(abs(given), abs(taken))
    with drawing(ax) as ax:
        ax.plot(turn, found.work, color=colour(0), label="given by the load")
        ax.plot(turn, found.dissipated, color=colour(1), label="taken by damping")
        ax.axhline(0.0, color=MUTED, lw=0.8, zorder=1)
        ax.set_xlim(0.0, 1.0)
        ends = [(given, ACCENT)] if even else [(given, colour(0)), (taken, colour(1))]
        for value, tone in ends:
            dot(ax, 1.0, value, tone, clip_on=False)
            note(ax, 1.0, value, f"{plain(value)}{' each' if even else ''}", (9, 0), color=tone)
        low, high = ax.get_ylim()
        ax.set_ylim(0.0 if low > -0.1 * high else low, high + 0.2 * (high - max(low, 0.0)))
        ax.set_xlabel("time in periods")
        ax.set_ylabel("energy, in shares of its mean")
        ax.set_title(_state(column, found))
        legend(ax, loc="upper left")
    return ax


def work_loop(
    column: Column,
    load: float | None = None,
    *,
    modes: int | None = None,
    alpha: float = 1e-3,
    beta: float = 0.1,
    ax: Axes | None = None,
    **parameters: Any,
) -> Axes:
    """The follower force's transversal part, −η P y′(1), against the end's deflection y(1), through one period of the
    least stable motion: the loop's area is the work of the force, positive where the loop runs clockwise. The part of
    the force in step with y(1), which does no work, is left out: it would draw the loop out into a line.

    By default at the critical load. Largest |y| on the beam is 1. Raises InputError where no force follows the end.
    """
    question = Question.of(column, modes, alpha, beta, **parameters)
    follows = curves.follower_share(question)
    if not follows:
        raise InputError(f"{column.name}: its end force does not follow the slope, so it does no work over a cycle")
    found = curves.cycle(question, load)
    turn = np.exp(1j * found.phase)
    end, force = found.shape(1.0), -follows * found.system.load * found.shape(1.0, 1)
    across = 1j * end * float((force / end).imag)
    y, F = (end * turn).real, (across * turn).real
    area = float(np.pi * np.abs(end) ** 2 * (force / end).imag)
    with drawing(ax) as ax:
        ax.fill(y, F, color=colour(0), alpha=0.1, lw=0, zorder=1)
        ax.plot(y, F, color=colour(0))
        for k in range(len(y) // 8, len(y) - 3, len(y) // 4):
            arrow(ax, (y[k], F[k]), (y[k + 2], F[k + 2]), colour(0), 0, 14, zorder=5)
        ax.axhline(0.0, color=MUTED, lw=0.8, zorder=0)
        ax.axvline(0.0, color=MUTED, lw=0.8, zorder=0)
        words = f"work of the force\n= area = {plain(area)}"
        ax.text(0.5, 0.5, words, transform=ax.transAxes, va="center", ha="center", fontsize=8.5)
        ax.margins(0.1, 0.16)
        ax.set_xlabel("deflection of the end, $y(1)$")
        share = "" if follows == 1 else plain(follows)
        ax.set_ylabel(f"$-{share}${symbol(column, 'P')}$\\,y'(1)$, out of step with $y(1)$")
        ax.set_title(_state(column, found))
    return ax


def _state(column: Column, found: curves.Cycle) -> str:
    lam, load = found.eigenvalue, found.system.load
    grows = abs(lam.real) > 1e-9 * abs(lam)
    real = f"{plain(lam.real)} + " if grows else ""
    return f"{symbol(column, 'P')} = {digits(load)}, $\\lambda$ = {real}{lam.imag:.4g}$\\,i$"


QUANTITIES = {"y": "displacement $y$", "dy": r"velocity $\dot{y}$", "ddy": r"acceleration $\ddot{y}$"}


def history(
    response: Response,
    quantity: str = "y",
    *,
    sensor: int = 0,
    label: str | None = None,
    color: str | None = None,
    ax: Axes | None = None,
) -> Axes:
    """What a sensor feels in time: Figs. 8 to 10 of the paper.

    quantity: "y", "dy" or "ddy", or of these the elastic or rigid part, such as "y_elastic". sensor: which of the
    response's, from 0. Raises InputError where there is no such quantity or sensor.
    """
    kind, _, part = quantity.partition("_")
    if kind not in QUANTITIES or part not in ("", "elastic", "rigid"):
        names = [f"{k}{p}" for p in ("", "_elastic", "_rigid") for k in QUANTITIES]
        raise InputError(f"quantity = {quantity!r}: must be one of {', '.join(names)}")
    k = count("sensor", sensor, 0, len(response.sensors) - 1, "the response's sensors, counted from 0")
    with drawing(ax) as ax:
        more: dict[str, Any] = {} if color is None else {"color": color}
        values = getattr(response, quantity)[:, k]
        ax.plot(response.t, values, label=label, lw=1.2, **{"color": colour(0), **more})
        ax.set_xlim(response.t[0], response.t[-1])
        if values.any() and not 1e-3 < np.abs(values).max() < 1e4:
            ax.ticklabel_format(axis="y", useMathText=True)  # a power of ten above the axis
        ax.axhline(0.0, color=MUTED, lw=0.7, zorder=1)
        ax.set_xlabel("time $t$")
        ax.set_ylabel(_read(response, kind) + (f", {part}" if part else ""))
    return ax


def _read(response: Response, kind: str) -> str:
    """The label of what the sensors read, or of its rates."""
    if response.measured == "y":
        return QUANTITIES[kind]
    name = response.measured.rstrip("'")
    dotted = {"y": "{}", "dy": r"\dot{{{}}}", "ddy": r"\ddot{{{}}}"}[kind].format(rf"\mathrm{{{name}}}")
    return f"${dotted}{response.measured[len(name) :]}$"


def trajectory(response: Response, *, sensor: int = 0, color: str | None = None, ax: Axes | None = None) -> Axes:
    """Velocity against displacement at a sensor, from the dot on: Figs. 8(d) and 9(d) of the paper."""
    k = count("sensor", sensor, 0, len(response.sensors) - 1, "the response's sensors, counted from 0")
    y, dy = response.y[:, k], response.dy[:, k]
    with drawing(ax, (4.2, 3.6)) as ax:
        ax.axhline(0.0, color=MUTED, lw=0.7, zorder=1)
        ax.axvline(0.0, color=MUTED, lw=0.7, zorder=1)
        ax.plot(y, dy, color=colour(0) if color is None else color, lw=0.8)
        dot(ax, y[0], dy[0], INK, ms=7, label="$t = 0$")
        legend(ax, loc="upper right", handlelength=1.0)
        ax.margins(0.1)
        ax.set_xlabel(_read(response, "y"))
        ax.set_ylabel(_read(response, "dy"))
    return ax
