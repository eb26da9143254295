"""The drawing of a column from its statement: what it shows is what is stated, where it is stated."""

from __future__ import annotations

import dataclasses
import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import sympy as sp

import freebeam as fb
from freebeam.figures.look import ACCENT, figure, style
from freebeam.ledger.reference_values import statements
from freebeam.vehicles.tabulated import Law, Part, Table, tabulated
from freebeam_derive import pipeline
from freebeam_derive.drawn import Parts, chain, parts_of
from freebeam_derive.notation import P, t, x, y
from freebeam_derive.statement import Coordinate, Field, Parameter, at, delta, hinge, integral, jump

STATED = statements()
a, k, g = (sp.Symbol(name, real=True) for name in ("a", "k", "g"))
OWN = tuple(Parameter(symbol, "", value, 0.0, 1.0) for symbol, value in ((a, 0.6), (k, 1.0), (g, 0.5)))
LINE = {
    "T": integral(y.diff(t) ** 2) / 2,
    "V": integral(y.diff(x, 2) ** 2) / 2,
    "W_c": P * integral(y.diff(x) ** 2) / 2,
    "dW_nc": -P * at(y.diff(x), 1) * at(delta(y), 1),
    "dimensional": None,
}


def changed(values: dict[sp.Symbol, float] | None = None, **changes: Any) -> Parts:
    """What there is to draw of Beck's column with changes."""
    stated = dataclasses.replace(STATED["beck"], name="changed", parameters=OWN, **{**LINE, **changes})
    return parts_of(stated, values)


def drawn(name: str, **asked: Any) -> Any:
    """A column of the gallery, drawn."""
    with style():
        return fb.figures.beam(fb.column(name), x_s=None, x_F=None, ax=figure((6.4, 2.7)).subplots(), **asked)


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("pflueger", {"masses": [(1.0, r"$\mu$")], "inertias": [(1.0, "$J$")], "loads": [(1.0, "$P_0$", 1.0)]}),
        ("point-mass", {"masses": [(0.5, r"$\mu$")], "springs": []}),
        ("tip-spring", {"springs": [(1.0, "$k$")], "masses": []}),
        ("tip-damper", {"dampers": [(1.0, "$c$")], "springs": []}),
        ("elastic-root", {"turning": [(0.0, "$c$")]}),
        ("absorber", {"absorbers": [(0.7, "$k$")], "springs": [], "dampers": [], "sensors": []}),
        ("crack", {"turning": [], "springs": [], "jumps": {(1, 0.4): "$k$"}}),
        ("foundation", {"foundation": "$k$"}),
        ("beck-self-weight", {"weight": ("$g$", True)}),
        ("beck-dead-load", {"weight": ("$w$", False)}),
        ("partial-damping", {"medium": (0.5, 1.0, "$c$"), "dampers": []}),
        ("follower-inside", {"loads": [(0.7, "$P_0$", 1.0)]}),
        ("reut", {"fixed_line": True}),
        ("feedback", {"sensors": [(0.4, 1.0)], "loads": [(1.0, "$P_0$", 1.0)]}),
        ("panel-pinned", {"loads": [], "foundation": "", "load": "outside"}),
        ("pipe", {"loads": [], "load": "inside"}),
        ("leipholz", {"loads": [], "load": "follower"}),
        ("self-weight", {"loads": [], "load": "axis"}),
        ("free-free-mass", {"loads": [(1.0, "$P_0$", 1.0)], "masses": [(0.0, r"$\mu$")]}),
    ],
)
def test_what_acts_at_places_is_found_there(name: str, expected: dict[str, Any]) -> None:
    found = vars(parts_of(STATED[name]))
    assert {key: found[key] for key in expected} == expected


def test_masses_springs_dampers_and_joints_stand_where_they_are_stated() -> None:
    q = Coordinate("q")
    stated: dict[str, Any] = {
        "T": LINE["T"] + at(y.diff(t), a) ** 2 / 2 + q.diff(t) ** 2 / 2,
        "V": LINE["V"] + k * (at(y, 0.75) - q) ** 2 / 2 + k * jump(y.diff(x), 0.25) ** 2 / 2 + k * at(y, 0.5) ** 2,
        "dW_nc": -at(y.diff(t), 0.875) * at(delta(y), 0.875),
        "releases": (hinge(0.125),),
        "ends": ("clamped", "pinned"),
    }
    found = changed(**stated)
    assert (found.masses, found.absorbers, found.dampers) == ([(0.6, "")], [(0.75, "$k$")], [(0.875, "")])
    assert changed({a: 0.7}, **stated).masses == [(0.7, "")]
    assert found.springs == [(0.5, "$k$")] and found.jumps == {(1, 0.125): "", (1, 0.25): "$k$"}
    assert not found.sensors and not found.turning


def test_a_torque_is_no_flow_over_the_beam() -> None:
    z = Field("z")
    turning = P * integral(z.diff(x) * delta(y.diff(x, 2)) - y.diff(x) * delta(z.diff(x, 2)))
    energies = {"T": LINE["T"] + integral(z.diff(t) ** 2) / 2, "V": LINE["V"] + integral(z.diff(x, 2) ** 2) / 2}
    assert changed(**energies, W_c=0, dW_nc=turning).load == "end"


def test_loads_act_where_the_axial_force_ends_and_follow_in_part() -> None:
    assert changed().loads == [(1.0, "$P_0$", 1.0)]
    share = changed(W_c=P * integral(y.diff(x) ** 2, 0, a), dW_nc=-g * P * at(y.diff(x), a) * at(delta(y), a))
    assert share.loads == [(0.6, "$2 P_0$", 0.25)]  # twice the load, of which a quarter follows
    dead = changed(dW_nc=sp.S.Zero)
    assert dead.loads == [(1.0, "$P_0$", 0.0)]
    hung = changed(W_c=P * integral((1 - x) * y.diff(x) ** 2) / 2, dW_nc=sp.S.Zero)
    assert hung.load == "axis" and not hung.loads


def test_a_follower_is_the_same_however_its_work_is_stated() -> None:
    """By parts, P ∫ y′ δy′ − P y′(1) δy(1) is −P ∫ y″ δy."""
    along = changed(W_c=sp.S.Zero, dW_nc=-P * integral(y.diff(x, 2) * delta(y)))
    assert along.loads == changed().loads and along.load == "end"


def test_a_sensor_is_where_something_is_measured_that_acts_elsewhere() -> None:
    steered = {"dW_nc": LINE["dW_nc"] - g * P * at(y.diff(x), a) * at(delta(y), 1)}
    assert changed(**steered).sensors == [(0.6, 1.0)] and not changed({g: 0.0}, **steered).sensors
    apart = at(y, a) - at(y, 1)
    between = changed(dW_nc=LINE["dW_nc"] - k * apart.diff(t) * delta(apart))
    assert not between.sensors  # a damper between two places acts on both alike


def test_a_chain_is_known_by_its_springs_and_its_load() -> None:
    assert chain(STATED["ziegler"]) == ([r"$\varphi_{1}$", r"$\varphi_{2}$"], [0.5, 0.5], 1.0)
    p, q = Coordinate("p"), Coordinate("q")
    links: dict[str, Any] = {
        "ends": (), "parameters": (), "dimensional": None, "T": (p.diff(t) ** 2 + q.diff(t) ** 2) / 2,
        "V": (p**2 + 3 * (q - p) ** 2) / 2, "W_c": P * (p**2 + 3 * q**2) / 2, "dW_nc": -P * q * delta(p + 3 * q) / 2,
    }  # fmt: skip
    unequal = dataclasses.replace(STATED["beck"], name="links", **links)
    assert chain(unequal) == (["$p$", "$q$"], [0.25, 0.75], 0.5)
    for other in ({"V": (p**2 + (q + p) ** 2) / 2}, {"W_c": P * p * q}, {"dW_nc": -P * q * delta(p)}):
        assert chain(dataclasses.replace(unequal, **other)) is None


@pytest.mark.parametrize(
    "name", ["beck", "pipe", "panel-trailing", "leipholz", "self-weight", "euler-clamped", "ziegler", "reut"]
)
def test_the_load_is_drawn_once(name: str) -> None:
    texts = [text.get_text() for text in drawn(name).texts]
    assert texts.count("$P_0$") == 1


def test_it_is_drawn_with_every_part() -> None:
    words = [text.get_text() for text in drawn("feedback").texts]
    assert words.count("sensor") == 1 and "$F_0(t)$" not in words
    with style():
        axes = fb.figures.beam(fb.column("feedback"), ax=figure((6.4, 2.7)).subplots())
    words = [text.get_text() for text in axes.texts]
    assert words.count("sensor") == 2 and "$F_0(t)$" in words and "$x_s$" in words
    with pytest.raises(fb.InputError, match="x_F"):
        fb.figures.beam(fb.column("feedback"), x_F=1.5)
    with pytest.raises(fb.InputError, match="nothing"):
        fb.figures.beam(fb.column("feedback"), nothing=1)


def test_a_taper_is_thinner_at_its_tip() -> None:
    """The outline of a wedge loses half its depth, that of a step as its parts are, that of a uniform beam nothing."""
    for name, share in (("wedge", 0.5), ("beck", 1.0), ("step", 0.5 ** (1 / 3))):
        outline = np.array(next(patch.get_xy() for patch in drawn(name).patches if len(patch.get_xy()) > 100))
        n = len(outline) // 2
        root, tip = (np.hypot(*(outline[k] - outline[2 * n - 1 - k])) for k in (0, n - 1))
        assert tip / root == pytest.approx(share, rel=1e-6)


def test_what_has_no_statement_is_not_drawn(tmp_path: Path) -> None:
    """A kernel's file does not say what stands where; the kernels that come with freebeam are of known statements."""
    kernel = shutil.copy(pipeline.tree() / "beck.py", tmp_path / "beck.py")
    with pytest.raises(fb.InputError, match="give the column's file"):
        fb.figures.beam(fb.column(kernel))


def test_tables_are_drawn_with_their_parts() -> None:
    """A column of tables has no statement; its masses, springs and sensor stand where they were given."""
    table = Table(np.array([0.0, 0.5, 1.0]), np.array([[1.0, 1.0], [8.0, 8.0]]), np.ones((2, 2)))
    parts = (Part("mass", 0.2, mass=1.0), Part("sprung", 0.7, mass=0.1, stiffness=50.0))
    with style():
        column = tabulated(table, parts, Law(0.4))
        axes = fb.figures.beam(column, x_s=None, x_F=None, ax=figure((6.4, 2.7)).subplots())
    at_marks = {round(float(line.get_xdata()[0]), 6) for line in axes.lines if line.get_marker() in "os"}
    assert at_marks == {0.2, 0.7, 0.4}
    arrows = [text.arrow_patch for text in axes.texts if getattr(text, "arrow_patch", None) is not None]
    assert sum(np.allclose(patch.get_edgecolor()[:3], figure_colour(ACCENT)) for patch in arrows) == 1
    outline = np.array(next(patch.get_xy() for patch in axes.patches if len(patch.get_xy()) > 100))
    n = len(outline) // 2
    root, tip = (np.hypot(*(outline[k] - outline[2 * n - 1 - k])) for k in (0, n - 1))
    assert tip / root == pytest.approx(2.0, rel=1e-6)


def figure_colour(name: str) -> tuple[float, ...]:
    from matplotlib.colors import to_rgb

    return to_rgb(name)
