"""Proofs over ranges of damping: they enclose what the runtime finds, and refuse what is not so. Eqs. (24), (25)."""

from __future__ import annotations

import dataclasses
from fractions import Fraction as F
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from flint import arb, arb_poly

import freebeam as fb
from freebeam_derive.certify.balls import Unproven, exact, precision
from freebeam_derive.certify.first_crossing import cover
from freebeam_derive.certify.ranges import BITS, Cell, Line, _Family

CASES = [("free-free", "internal", "0"), ("free-free", "external", "0"), ("free-free", "internal", "0.1")]
CASES += [("beck", "internal", "0"), ("beck", "external", "0.001")]


def critical(name: str, which: str, damping: float, held: float, modes: int) -> tuple[float, float]:
    alpha, beta = (damping, held) if which == "internal" else (held, damping)
    found = fb.critical_load(fb.column(name, "modes"), modes, alpha, beta)
    assert found.load is not None and found.frequency is not None
    return found.load, found.frequency


@pytest.mark.parametrize(("name", "which", "held"), CASES)
def test_stable_below_and_unstable_above(name: str, which: str, held: str) -> None:
    """Over a narrow range of damping what is proven stable ends where what is proven unstable begins."""
    modes = 5
    line = Line(fb.column(name, "modes").kernel, modes, which, F(held))
    low, high = F(1, 100), F(101, 10000)
    loads = [critical(name, which, float(damping), float(held), modes)[0] for damping in (low, high)]
    bottom, top = (F(v) for v in (min(loads) * 0.999, max(loads) * 1.001))
    line.stable(low, high, bottom)
    line.unstable(low, high, top)
    with pytest.raises(Unproven, match="stab"):
        line.stable(low, high, top)
    with pytest.raises(Unproven, match="not known to be unstable"):
        line.unstable(low, high, bottom)


@pytest.mark.parametrize(("name", "which", "held"), CASES)
def test_cells_follow_the_crossing(name: str, which: str, held: str) -> None:
    """Cells are without gaps, hold the runtime's crossing, and know its direction from finite differences."""
    modes = 5
    line = Line(fb.column(name, "modes").kernel, modes, which, F(held))
    dampings = [F(1, 100), F(2, 100), F(4, 100)]
    near = [critical(name, which, float(damping), float(held), modes) for damping in dampings]
    cells = line.cells(dampings, near)
    assert (cells[0].low, cells[-1].high) == (line.of(dampings[0]), line.of(dampings[-1]))
    assert all(a.high == b.low for a, b in pairwise(cells))
    for cell in cells:
        taus = [float(cell.low + (cell.high - cell.low) * part) for part in (F(1, 5), F(4, 5))]
        found = [critical(name, which, t**0.5 if line.squared else t, float(held), modes) for t in taus]
        for load, frequency in found:
            assert cell.load[0] * (1 - F(1, 10**9)) < load < cell.load[1] * (1 + F(1, 10**9))
            assert cell.square[0] * (1 - F(1, 10**7)) < frequency**2 < cell.square[1] * (1 + F(1, 10**7))
        assert cell.rises == np.sign(found[1][0] - found[0][0])


def test_slow_flutter_of_heavy_damping_is_proven_as_well() -> None:
    """Beck's column swings ever more slowly as external damping grows, its load rising: ω < 1 from β of 200 on."""
    line = Line(fb.column("beck", "modes").kernel, 4, "external")
    dampings = [F(300), F(310)]
    cells = line.cells(dampings, [critical("beck", "external", float(d), 0.0, 4) for d in dampings])
    for cell in cells:
        assert 0 < cell.square[0] < cell.square[1] < 1 and cell.rises == 1


def test_no_crossing_before_the_first() -> None:
    """Stability up to a share of the load below the crossings; of a second crossing it is refused."""
    line = Line(fb.column("free-free", "modes").kernel, 4, "internal")
    dampings = [F(2, 100), F(4, 100)]
    cells = line.cells(dampings, [critical("free-free", "internal", float(d), 0.0, 4) for d in dampings])
    assert 0 < line.none_before(cells, F(1, 20)) <= F(1, 20)
    beyond = [dataclasses.replace(cell, load=(cell.load[0] * 2, cell.load[1] * 2)) for cell in cells]
    with pytest.raises(Unproven):
        line.none_before(beyond[:1], F(1, 20))


def test_stability_is_shown_from_no_load_on() -> None:
    """Of Beck's column under the load 60 (1 − P)², which is beyond its own where P is small and below from P = 1 on."""
    line, falling = Line(fb.column("beck", "modes").kernel, 3, "internal"), arb_poly([60, -120, 60])
    for table in (table for curves in (line.h, line.g) for table in curves):
        powers, columns = [falling**a for a in range(len(table))], range(len(table[0]))
        table[:] = [
            [sum((p[k] * row[b] for p, row in zip(powers, table, strict=True)), arb_poly()) for b in columns]
            for k in range(2 * len(table) - 1)
        ]
    with precision(BITS):
        cover(_Family(line, line.of(F(1, 100)), line.of(F(1, 100))).over, F(1), F(13, 10))
    with pytest.raises(Unproven):
        line.stable(F(1, 100), F(1, 100), F(13, 10))


def test_a_wrong_start_proves_nothing() -> None:
    line = Line(fb.column("free-free", "modes").kernel, 5, "internal")
    with pytest.raises(Unproven):
        line.cells([F(1, 100), F(2, 100)], [(30.0, 11.0), (30.0, 11.0)], depth=2)


@pytest.mark.parametrize(("name", "which", "held"), CASES)
def test_the_mean_value_form_holds_every_damping_of_the_cell(name: str, which: str, held: str) -> None:
    """h and g along a line in P, for dampings inside a wide cell, lie in what the cell gives."""
    line = Line(fb.column(name, "modes").kernel, 4, which, F(held))
    low, high = line.of(F(1, 100)), line.of(F(3, 100))
    with precision(BITS):
        wide = _Family(line, low, high)
        for part in (F(0), F(1, 3), F(9, 10), F(1)):
            tau = low + (high - low) * part
            narrow = _Family(line, tau, tau)
            for over, at in ((wide.over.h, narrow.over.h), (wide.over.g, narrow.over.g)):
                outer = over.along(arb(10), arb(500), arb(0))
                inner = at.along(arb(10), arb(500), arb(0))
                assert all(outer[k].contains(inner[k].mid()) for k in range(5))
                assert over(exact(F(7)), exact(F(90))).contains(at(exact(F(7)), exact(F(90))).mid())


def test_the_polynomials_are_those_of_the_eigenvalues() -> None:
    """h + iωg vanishes at an eigenvalue on the axis: the runtime's crossing, at one damping."""
    for name, which, held in CASES:
        line = Line(fb.column(name, "modes").kernel, 6, which, F(held))
        load, frequency = critical(name, which, 0.02, float(held), 6)
        tau = line.of(F(2, 100))
        with precision(BITS):
            family = _Family(line, tau, tau)
            for part in (family.centre.h, family.centre.g):
                at = arb(load), arb(frequency) ** 2
                assert abs(float(part(*at))) < 1e-7 * abs(float(part.by_x(*at))) * frequency**2


@pytest.mark.parametrize(
    "loads",
    [
        [(100, 101), (100, 102), (103, 104), (90, 91), (60, 61), (61, 62), (60, 63), (30, 31)],
        [(100, 101), (50, 51), (100, 101)],
        [(100, 101), (100, 101), (100, 101)],
        [(100, 150), (100, 101), (149, 150)],
    ],
)
def test_each_damping_is_stable_up_to_the_share_of_its_load_that_is_said(loads: list[tuple[int, int]]) -> None:
    """Whatever cells are taken together: each is in one range of dampings, below all of its loads and near them."""
    share, asked = F(1, 10), list[tuple[F, F, F]]()
    cells = [Cell(F(n), F(n + 1), (F(low), F(high)), (F(1), F(2)), 1) for n, (low, high) in enumerate(loads)]
    them: Any = object.__new__(Line)
    object.__setattr__(them, "_throughout", lambda low, high, show: asked.append((low, high, show.keywords["end"])))
    worst = them.none_before(cells, share)
    assert [low for low, *_ in asked] == [F(0), *(high for _, high, _ in asked[:-1])] and asked[-1][1] == len(cells)
    for cell in cells:
        (end,) = (end for low, high, end in asked if low <= cell.low and cell.high <= high)
        assert end < cell.load[0] and end >= (1 - worst) * cell.load[1]
        assert worst <= share or any(high * (1 - share) > low for low, high in loads)
    assert (len(asked) == 1) == (len({*loads}) == 1)
