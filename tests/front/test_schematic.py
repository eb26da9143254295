"""The drawing of a column from its statement: what it shows is what is stated, where it is stated."""

from __future__ import annotations

from typing import Any

import pytest

from freebeam.figures.look import figure, style
from freebeam.figures.schematic import schematic
from freebeam.ledger.reference_values import statements
from freebeam_derive.drawn import parts_of

STATED = statements()


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("pflueger", {"masses": [(1.0, r"$\mu$")], "inertias": [(1.0, "$J$")], "followers": [1.0]}),
        ("point-mass", {"masses": [(0.5, r"$\mu$")], "springs": []}),
        ("tip-spring", {"springs": [(1.0, "$k$")], "masses": []}),
        ("tip-damper", {"dampers": [(1.0, "$c$")], "springs": []}),
        ("elastic-root", {"turning": [(0.0, "$c$")]}),
        ("absorber", {"absorbers": [(0.7, "$k$")], "springs": [], "dampers": [], "followers": [1.0]}),
        ("crack", {"turning": [], "springs": [], "followers": [1.0]}),
        ("foundation", {"foundation": "$k$"}),
        ("beck-self-weight", {"weight": ("$g$", True)}),
        ("beck-dead-load", {"weight": ("$w$", False)}),
        ("partial-damping", {"medium": (0.5, 1.0, "$c$"), "dampers": []}),
        ("follower-inside", {"followers": [0.7]}),
        ("reut", {"fixed_line": True, "followers": []}),
        ("feedback", {"sensors": [(0.4, 1.0)], "followers": [1.0]}),
        ("panel-pinned", {"followers": [], "foundation": ""}),
    ],
)
def test_what_acts_at_places_is_found_there(name: str, expected: dict[str, Any]) -> None:
    found = vars(parts_of(STATED[name]))
    assert {key: found[key] for key in expected} == expected


@pytest.mark.parametrize(
    "name", ["beck", "pipe", "panel-trailing", "leipholz", "self-weight", "euler-clamped", "ziegler"]
)
def test_the_load_is_drawn_once(name: str) -> None:
    with style():
        axes = schematic(STATED[name], ax=figure((6.4, 2.7)).subplots())
    texts = [text.get_text() for text in axes.texts]
    assert texts.count("$P_0$") == 1


def test_a_taper_is_thinner_at_its_tip() -> None:
    """The outline of a wedge loses half its depth, that of a uniform beam none."""
    for name, share in (("wedge", 0.5), ("beck", 1.0)):
        with style():
            axes = schematic(STATED[name], ax=figure((6.4, 2.7)).subplots())
        outline = max((patch.get_xy() for patch in axes.patches if hasattr(patch, "get_xy")), key=lambda p: len(str(p)))
        n = len(outline) // 2
        root, tip = (abs(outline[k, 1] - outline[2 * n - 1 - k, 1]) for k in (0, n - 1))
        assert tip / root == pytest.approx(share, rel=1e-6)
