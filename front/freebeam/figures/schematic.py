"""A drawing of any column from its statement: ends, section, loads, masses, springs, dampers, joints and sensors."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from freebeam.figures.look import ACCENT, INK, MUTED, drawing
from freebeam.figures.marks import arrow, colour
from freebeam.figures.sketch import BODY, HALF, _arrow, _force, _support

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from freebeam_derive.statement import Column

__all__ = ["schematic"]

SHAPES: dict[tuple[str, str], Callable[[Any], Any]] = {
    ("clamped", "free"): lambda x: 0.06 * x**2 * (3 - x),
    ("free", "clamped"): lambda x: 0.06 * (1 - x) ** 2 * (2 + x),
    ("pinned", "free"): lambda x: 0.04 * x + 0.045 * x**2 * (3 - x),
    ("pinned", "pinned"): lambda x: 0.07 * np.sin(np.pi * x),
    ("clamped", "clamped"): lambda x: 1.1 * x**2 * (1 - x) ** 2,
    ("clamped", "pinned"): lambda x: 0.27 * x**2 * (1 - x) * (3 - 2 * x) / 0.75,
    ("free", "free"): lambda x: 0.1 * (x - 0.5) + 0.06 * (1 - 4 * x * (1 - x)),
}
"""How a beam is drawn bent, by its ends; a joint adds a kink or a step."""


@dataclass
class Parts:
    """What a statement holds at places, each with its letter in LaTeX, and along the beam."""

    masses: list[tuple[float, str]] = field(default_factory=list)
    inertias: list[tuple[float, str]] = field(default_factory=list)
    springs: list[tuple[float, str]] = field(default_factory=list)
    turning: list[tuple[float, str]] = field(default_factory=list)
    dampers: list[tuple[float, str]] = field(default_factory=list)
    absorbers: list[tuple[float, str]] = field(default_factory=list)
    followers: list[float] = field(default_factory=list)
    sensors: list[tuple[float, float]] = field(default_factory=list)
    fixed_line: bool = False
    foundation: str = ""
    weight: tuple[str, bool] = ("", False)
    """The letter of an axial load of a parameter's own, and whether it is spread along the beam."""
    medium: tuple[float, float, str] | None = None
    """Where a part of the beam is damped outside, and the letter of it."""


def _places(statement: Column, expression: Any) -> list[tuple[Any, Any, Any]]:
    """(jets of a term, their places as floats, its factor) of the terms of point values that a work or energy holds."""
    from sympy import Add

    from freebeam_derive.jets import beside, jets

    found = []
    for term in Add.make_args(expression):
        here = [j for j in jets(term) for _ in range(int(term.as_powers_dict().get(j, 1)))]
        places = []
        for j in here:
            place = j.args[3].args[0] if j.args[3].func == beside else j.args[3]
            value = place.subs(statement.defaults)
            places.append(float(value) if value.is_number else None)
        found.append((here, places, term))
    return found


def parts_of(statement: Column) -> Parts:
    """What there is to draw."""
    from freebeam_derive.latex import printer
    from freebeam_derive.notation import P, alpha, beta

    tex, parts, uncut = printer(statement), Parts(), statement.energies
    own = {p.symbol for p in statement.parameters}

    def letters(term: Any) -> str:
        names = sorted(
            (s for s in term.free_symbols & own if not any(s in j.free_symbols for j in _jets(term))), key=str
        )
        return f"${' '.join(tex.doprint(s) for s in names)}$" if names else ""

    T, V, W = (uncut.functional(name) for name in ("T", "V", "dW_nc"))
    jumps = {(name, order, float(place.subs(statement.defaults))) for name, order, place in V.opened}
    for energy, by_order in ((T, (parts.masses, parts.inertias)), (V, (parts.springs, parts.turning))):
        for here, places, term in _places(statement, energy.points):
            if len(here) != 2 or places[0] is None or places[0] != places[1] or here[0] != here[1]:
                continue
            order = int(here[0].args[1])
            if order < 2 and ("y", order, places[0]) not in jumps:
                by_order[order].append((places[0], letters(term)))
    coupled = [
        (place, letters(term))
        for here, places, term in _places(statement, V.points)
        for place in places
        if None in places and place is not None
    ]
    parts.absorbers = list(dict.fromkeys(coupled))
    at = {place for place, _ in parts.absorbers}
    parts.springs = [(place, name) for place, name in parts.springs if place not in at]
    for here, places, term in _places(statement, W.points):
        if len(here) != 2 or None in places:
            continue
        (order, rate), (turned, _) = ((int(j.args[1]), int(j.args[2])) for j in _seen_first(here))
        seen, moved = (places[here.index(j)] for j in _seen_first(here))
        if term.has(P) and turned == 1 and order == 0:
            parts.fixed_line = True
        elif term.has(P) and seen == moved:
            parts.followers.append(moved)
        elif term.has(P):
            parts.sensors.append((seen, moved))
        elif rate == 1 and order == 0 and moved not in at and not term.has(alpha, beta):
            parts.dampers.append((moved, letters(term)))
    parts.followers = sorted(set(parts.followers))
    _along(statement, V.density, W.density, parts, letters)
    return parts


def _along(statement: Column, V: Any, W: Any, parts: Parts, letters: Callable[[Any], str]) -> None:
    """What acts along the beam, or along a part of it."""
    from freebeam_derive.jets import jet
    from freebeam_derive.notation import alpha, beta, x

    beam = statement.energies.beam
    bounds = [float(p.subs(statement.defaults)) for p in beam.places]
    for k, along in enumerate(beam.segments):
        spring, axial = (V.coeff(jet(0, order, 0, along), 2) for order in (0, 1))
        damping = W.coeff(jet(0, 0, 1, along)).coeff(jet(1, 0, 0, along)).subs({alpha: 0, beta: 0})
        if spring != 0:
            parts.foundation = letters(spring)
        if axial != 0 and statement.fields == ("y",):
            parts.weight = letters(axial), axial.has(x)
        if damping != 0 and beam.cuts:
            parts.medium = bounds[k], bounds[k + 1], letters(damping)


def _jets(term: Any) -> list[Any]:
    from freebeam_derive.jets import jets

    return jets(term)


def _seen_first(here: list[Any]) -> list[Any]:
    from freebeam_derive.jets import virtual

    return sorted(here, key=lambda j: virtual(j.args[0]))


def _profile(statement: Column, x: Any) -> Any:
    """Half the depth along the beam: the cube root of the bending stiffness, of the beam's own first field."""
    from freebeam_derive.jets import jet, trial
    from freebeam_derive.notation import x as place

    V, beam = statement.energies.functional("V"), statement.energies.beam
    bounds = [float(p.subs(statement.defaults)) for p in beam.places]
    depth = np.ones_like(x)
    for k, along in enumerate(beam.segments):
        factor = 2 * V.density.coeff(jet(trial("y"), 2, 0, along), 2)
        if factor == 0:
            return depth
        here = (x >= bounds[k]) & (x <= bounds[k + 1])
        values = [float(factor.subs({**statement.defaults, place: v})) for v in x[here]]
        depth[here] = np.maximum(values, 0.0) ** (1 / 3)
    return depth / depth.max()


def schematic(statement: Column, *, ax: Axes | None = None) -> Axes:
    """A column as it is stated, bent a little: its ends, section, loads and all that acts at places.

    statement: a `freebeam_derive.statement.Column`. Parameters are at their defaults. Raises InputError without
    matplotlib.
    """
    with drawing(ax, (6.4, 2.7)) as ax:
        ax.set_aspect("equal")
        ax.axis("off")
        if statement.fields:
            _beam(ax, statement)
        else:
            _links(ax, statement)
        ax.set_xlim(-0.24, 1.36)
        ax.set_ylim(-0.3, 0.36)
    return ax


def _line(statement: Column, x: Any) -> Any:
    y = SHAPES[statement.supports(statement.fields[0])](x)
    for work in ("V", "dW_nc"):
        for name, order, place in statement.energies.functional(work).opened:
            beyond = x - float(place.subs(statement.defaults))
            if name == "y":
                y = y + np.where(beyond > 0, 0.2 * beyond if order else 0.04, 0.0)
    return y


def _beam(ax: Axes, statement: Column) -> None:
    from matplotlib.patches import Polygon

    x = np.linspace(0.0, 1.0, 401)
    y, parts, ends = _line(statement, x), parts_of(statement), statement.supports(statement.fields[0])
    slope = np.gradient(y, x)
    depth = _profile(statement, x)
    depth = depth * HALF * (1.2 if depth.min() == depth.max() else 2.2)  # what varies is to be seen
    ax.plot([-0.06, 1.02], [0, 0], color=MUTED, lw=0.8, ls=(0, (6, 3)), zorder=1)
    outline = np.concatenate([np.stack([x, y + depth], 1), np.stack([x, y - depth], 1)[::-1]])
    ax.add_patch(Polygon(outline, fc=BODY, ec=INK, lw=1.0, zorder=3))
    for k, side in ((0, -1), (-1, 1)):
        _support(ax, ends[0 if k == 0 else 1], float(x[k]), float(y[k]), side)

    def height(place: float) -> float:
        return float(np.interp(place, x, y))

    for place, name in parts.masses:
        ax.plot([place], [height(place)], "o", color=INK, ms=11, zorder=6)
        ax.text(place, height(place) + 0.05, name, ha="center", va="bottom", fontsize=11)
    for place, name in parts.inertias:
        ax.plot([place], [height(place)], "o", mfc="none", mec=INK, ms=17, zorder=6)
        ax.text(place - 0.05, height(place) - 0.05, name, ha="right", va="top", fontsize=11)
    for place, name in parts.springs:
        _zigzag(ax, place, height(place), -0.16, name)
    for place, name in parts.dampers:
        _dashpot(ax, place, height(place), -0.16, name)
    for place, _ in parts.absorbers:
        _zigzag(ax, place, height(place), -0.1, "")
        ax.plot([place], [-0.14], "s", color=INK, ms=11, zorder=6)
        ax.text(place + 0.05, -0.14, "$q$", va="center", fontsize=11)
    for place, name in parts.turning:
        _spiral(ax, place, height(place), name)
    for _, order, place in _opened(statement):
        look: dict[str, Any] = {"color": "white", "mec": INK, "zorder": 6}
        ax.plot([place], [height(place)], "o" if order else "s", ms=8, **look)
    if parts.foundation:
        for place in np.linspace(0.08, 0.96, 9):
            _zigzag(ax, float(place), height(float(place)), -0.13, "", 0.008)
        ax.text(1.0, -0.15, parts.foundation, fontsize=11, va="center")
    if parts.medium:
        low, high, name = parts.medium
        ax.fill_between(x, y - 0.075, y + 0.075, where=(x >= low) & (x <= high), color="#E4E4E4", lw=0, zorder=0)
        ax.text((low + high) / 2, height((low + high) / 2) + 0.09, name, fontsize=11, ha="center")
    name, spread = parts.weight
    for k in range(40, len(x), 60) if spread else [len(x) - 1] * bool(name):
        reach = 0.05 if spread else 0.14
        _arrow(ax, (x[k] + reach, y[k] - 0.035), (x[k], y[k] - 0.035), MUTED, 1.2)
    ax.text(1.16, y[-1] - 0.04, name, color=MUTED, va="center", fontsize=12)
    for seen, moved in parts.sensors:
        ax.plot([seen], [height(seen)], "s", color=colour(3), mec=INK, ms=7.5, zorder=7)
        ax.annotate("sensor", (seen, height(seen)), (0, 12), textcoords="offset points", ha="center", fontsize=9)
        arrow(ax, (seen, height(seen) - 0.03), (moved, height(moved) - 0.03), colour(3), 0.9, 8, zorder=2)
    _loads(ax, statement, parts, x, y, slope)


def _opened(statement: Column) -> list[tuple[str, int, float]]:
    found = statement.energies.functional("V").opened
    return [(name, order, float(place.subs(statement.defaults))) for name, order, place in found]


def _loads(ax: Axes, statement: Column, parts: Parts, x: Any, y: Any, slope: Any) -> None:
    """What holds the load P: at places with their direction, or along the beam."""
    from sympy import Add

    from freebeam_derive.notation import NOTATION, P
    from freebeam_derive.notation import x as place

    letter = f"${NOTATION['P'].latex}$"
    for at in parts.followers:
        k = round(at * (len(x) - 1))
        _force(ax, np.array([x[k], y[k]]), math.atan(slope[k]), letter, 1.0, float(slope[k]))
    if parts.fixed_line:
        _arrow(ax, (1.24, 0.0), (1.02, 0.0), ACCENT, 2.2)
        ax.plot([1.0, 1.0], [0.0, y[-1]], color=INK, lw=2.0)
        ax.text(1.26, 0.0, letter, color=ACCENT, va="center", fontsize=13)
    if parts.followers or parts.fixed_line:
        return
    works = {name: statement.energies.functional(name) for name in ("W_c", "dW_nc")}
    axial = Add(*(t for t in Add.make_args(works["W_c"].density) if t.has(P)))
    rates = works["dW_nc"].density.has(P) and any(
        t.has(P) and any(int(j.args[2]) for j in _jets(t)) for t in Add.make_args(works["dW_nc"].density)
    )
    if rates:  # a flow inside
        for start in (0.1, 0.42, 0.74):
            i, j = (int(s * (len(x) - 1)) for s in (start, start + 0.2))
            _arrow(ax, (x[i], y[i]), (x[j], y[j]), ACCENT, 1.2)
        ax.text(1.04, y[-1], letter, color=ACCENT, va="center", fontsize=13)
    elif axial == 0:  # a flow outside
        for up in (0.17, 0.24):
            for start in (0.05, 0.55):
                _arrow(ax, (start, up), (start + 0.3, up), ACCENT, 1.2)
        ax.text(1.04, 0.2, letter, color=ACCENT, va="center", fontsize=13)
    elif axial.has(place):  # along the beam: with its direction, or with the axis
        turns = works["dW_nc"].density.has(P)
        for k in range(40, len(x), 60):
            reach = 0.06
            tilt = slope[k] if turns else 0.0
            _arrow(ax, (x[k] + reach, y[k] + reach * tilt + 0.03), (x[k], y[k] + 0.03), ACCENT, 1.2)
        ax.text(1.06, y[-1] + 0.03, letter, color=ACCENT, va="center", fontsize=13)
    else:
        _arrow(ax, (1.22, y[-1]), (1.01, y[-1]), ACCENT, 2.2)
        ax.text(1.25, y[-1], letter, color=ACCENT, va="center", fontsize=13)


def _links(ax: Axes, statement: Column) -> None:
    """A chain of rigid links, one for each coordinate, under a force along the last."""
    from freebeam_derive.notation import NOTATION

    count = len(statement.coordinates)
    angles = np.linspace(0.12, 0.3, count)
    points = np.concatenate([[[0.0, 0.0]], np.cumsum(np.stack([np.cos(angles), np.sin(angles)], 1), 0) / count])
    _support(ax, "clamped", 0.0, 0.0, -1)
    ax.plot([-0.06, 1.02], [0, 0], color=MUTED, lw=0.8, ls=(0, (6, 3)), zorder=1)
    ax.plot(points[:, 0], points[:, 1], color=INK, lw=3.0, zorder=4)
    for k, (px, py) in enumerate(points[:-1]):
        _spiral(ax, px, py, "")
        ax.plot([px], [py], "o", color="white", mec=INK, ms=6, zorder=6)
        ax.text(px + 0.2, py + 0.02, f"${getattr(statement.unknowns[k], 'letter', '')}$", fontsize=11, va="bottom")
    for px, py in points[1:]:
        ax.plot([px], [py], "o", color=INK, ms=10, zorder=7)
    _force(ax, points[-1], float(angles[-1]), f"${NOTATION['P'].latex}$", 1.0, 0.0)


def _ground(ax: Axes, x: float, y: float) -> None:
    ax.plot([x - 0.03, x + 0.03], [y, y], color=INK, lw=1.2)
    for k in range(4):
        ax.plot([x - 0.03 + 0.02 * k, x - 0.04 + 0.02 * k], [y, y - 0.015], color=INK, lw=0.8)


def _zigzag(ax: Axes, x: float, top: float, bottom: float, name: str, wide: float = 0.014) -> None:
    """A spring from the beam down, to the ground."""
    count = 8
    heights = np.linspace(top, bottom, count + 2)
    sides = [0.0, *(wide * (-1) ** k for k in range(count)), 0.0]
    ax.plot(x + np.array(sides), heights, color=INK, lw=1.0, zorder=2)
    _ground(ax, x, bottom)
    ax.text(x + 0.035, (top + bottom) / 2 - 0.02, name, fontsize=11, va="center")


def _dashpot(ax: Axes, x: float, top: float, bottom: float, name: str) -> None:
    """A damper from the beam down, to the ground."""
    middle = (top + bottom) / 2
    for path in (
        [(0, top), (0, middle)],
        [(-0.016, middle), (0.016, middle)],
        [(-0.024, middle + 0.03), (-0.024, middle - 0.03), (0.024, middle - 0.03), (0.024, middle + 0.03)],
        [(0, middle - 0.03), (0, bottom)],
    ):
        ax.plot([x + dx for dx, _ in path], [h for _, h in path], color=INK, lw=1.1, zorder=2)
    _ground(ax, x, bottom)
    ax.text(x + 0.04, middle, name, fontsize=11, va="center")


def _spiral(ax: Axes, x: float, y: float, name: str) -> None:
    """A rotational spring."""
    turn = np.linspace(0, 4.5 * np.pi, 120)
    radius = 0.008 + 0.034 * turn / turn[-1]
    ax.plot(x + radius * np.cos(turn), y + radius * np.sin(turn), color=INK, lw=0.9, zorder=5)
    ax.text(x - 0.02, y - 0.06, name, fontsize=11, va="top", ha="center")
