"""Certificates of all crossings of the beam itself and over ranges: true ones accepted, forgeries refused.

    PYTHONPATH=. python -m tests.certify.test_beam_lists_and_ranges 20 1

draws so many random columns by a seed, writes a list and a range of each, and tries every forgery of them.
"""

from __future__ import annotations

import json
import random
import sys
from collections.abc import Iterator
from copy import deepcopy
from dataclasses import replace
from fractions import Fraction
from functools import cache
from itertools import pairwise, product
from math import pi
from types import SimpleNamespace
from typing import Any
from unittest.mock import patch

import numpy as np
import pytest
from flint import arb

import freebeam as fb
import freebeam_kernels.beck as beck
from freebeam.proofs import enclosed_load
from freebeam_derive.certify import (
    beam_cells,
    beam_stability,
    verifier_cells,
    verifier_of_beam,
    verifier_shooting,
    verifier_signs,
    verifier_touches,
)
from freebeam_derive.certify.balls import precision
from freebeam_derive.certify.verifier_beam_claims import listed
from freebeam_derive.certify.verifier_boxes import Box
from freebeam_derive.certify.verifier_cells import Cells
from freebeam_derive.certify.verifier_claims import Form, Refused, ball
from freebeam_derive.certify.verifier_equations import Equations, one_to_one
from freebeam_derive.certify.verifier_shooting import POWERS, Shooting
from freebeam_derive.certify.verifier_signs import Signs
from freebeam_derive.certify.verifier_touches import touches
from tests.certify.test_beam_certificates import Data, computed_once, of_kernel, refused, shifted, verify
from tests.front.test_proofs import run

__all__ = ["computed_once"]  # a fixture that each test uses

F = Fraction
LISTS: dict[str, tuple[str, dict[str, Any]]] = {
    "three": ("beck", {"eta": "0.4", "load_max": 17}),
    "none": ("beck", {"load_max": 12}),
    "damped": ("beck", {"beta": "0.5", "load_max": 21}),
    "limit": ("beck", {"kappa": 0, "load_max": 12}),
}
RANGES: dict[str, tuple[Any, ...]] = {
    "divergence": ("eta", "0.3", "0.305"),
    "flutter": ("eta", "0.6", "0.61"),
    "damped": ("beta", "0.1", "0.15"),
    "limit": ("kappa", "0", "0.1"),
}


@cache
def found(of: str, case: str) -> Any:
    """What is proven; fewer modes in the bounds than without the patch, which would only take the verifier's time; of a
    range the prover's cells are left out, for the verifier makes its own."""
    with patch.object(beam_stability, "COUNTS", (40, 40)):
        if of == "list":
            name, given = LISTS[case]
            return fb.exact_crossings(fb.column(name), **given)
        with patch.object(beam_cells.Cells, "no_other_zero", lambda *_: 1):
            return fb.exact_range(fb.column("beck"), *RANGES[case])


def touch() -> Data:
    """Written by hand: of half of the force that follows, whose eigenvalue touches zero at π²; at rest all is alike."""
    data = certificate("list", "none")
    data["forms"]["H"]["points"][0][4] = "1/2"
    there = {"kind": "touch", "load": ["9.8696", "9.8697"], "frequency_squared": None, "change": 0, "unstable": 0}
    return data | {"parameters": {"eta": "1/2"}, "crossings": [there]}


def certificate(of: str, case: str) -> Data:
    data: Data = json.loads(json.dumps(found(of, case).unverified))
    return data


# ------------------------------------------------------------ true ones


@pytest.mark.parametrize("case", LISTS)
def test_a_list_is_accepted_as_it_was_written(case: str) -> None:
    stated, crossings = verify(certificate("list", case)), found("list", case)
    assert [(p.kind, p.unstable, p.unstable + p.change) for p in stated.passings] == [
        (c.kind, c.unstable_below, c.unstable_above) for c in crossings
    ]
    for passing, c in zip(stated.passings, crossings, strict=True):
        assert passing.load[0] < Fraction(c.load[1]) and Fraction(c.load[0]) < passing.load[1]
    assert "over all modes" in str(stated) and str(stated.load_max) in str(stated)
    assert len(stated.record()["crossings"]) == len(crossings)


@pytest.mark.parametrize("case", RANGES)
def test_a_range_is_accepted_as_it_was_written(case: str) -> None:
    name, low, high = RANGES[case]
    stated = verify(certificate("range", case))
    assert (stated.parameter, stated.low, stated.high) == (name, Fraction(low), Fraction(high))
    middle = (stated.low + stated.high) / 2
    load = Fraction(enclosed_load(fb.column("beck"), **{name: middle}).load[0])
    (at,) = [p for p in stated.pieces if p.low <= middle < p.high]
    assert at.load[0] < load < at.load[1] and at.kind == certificate("range", case)["pieces"][0]["kind"]
    assert all(stated.load[0] <= p.load[0] and p.load[1] <= stated.load[1] for p in stated.pieces)
    assert f"each value of {name} from {low} to {high}" in str(stated)
    record = stated.record()
    changed = [at[name] for at in record["parameters"]] if name == "eta" else record[name]
    assert changed == [low, high] and record["pieces"][0]["low"] == low


# ------------------------------------------------------------ forgeries


def counted(crossings: list[Data]) -> list[Data]:
    """With numbers of unstable eigenvalues that fit the changes."""
    unstable, found = 0, []
    for c in crossings:
        found.append(c | {"unstable": unstable})
        unstable += c["change"]
    return found


def of_list(data: Data) -> Iterator[Data]:
    """The same certificate of something that is not so."""
    crossings = data["crossings"]
    for k, c in enumerate(crossings):
        rest = [crossings[:k], crossings[k + 1 :]]
        yield data | {"crossings": counted(rest[0] + rest[1])}
        kinds = [("flutter", -c["change"])] if c["kind"] == "flutter" else []
        kinds += [("divergence", 1), ("divergence", -1), ("touch", 0)] if c["kind"] != "flutter" else []
        for kind, change in kinds:
            if (kind, change) != (c["kind"], c["change"]):
                yield data | {"crossings": counted([*rest[0], c | {"kind": kind, "change": change}, *rest[1]])}
        yield data | {"crossings": [*rest[0], c | {"unstable": c["unstable"] + 1}, *rest[1]]}
        yield data | {"crossings": [*rest[0], c | {"load": shifted(c["load"], "1.00001")}, *rest[1]]}
        if c["kind"] == "flutter":
            moved = shifted(c["frequency_squared"], "1.001")
            yield data | {"crossings": [*rest[0], c | {"frequency_squared": moved}, *rest[1]]}
    more = {"kind": "divergence", "load": ["1", "1.00001"], "frequency_squared": None, "change": 1, "unstable": 0}
    yield data | {"crossings": counted([more, *crossings])}
    yield data | {"points": [*data["points"][:-1], str(3 * Fraction(data["points"][-1]))]}
    yield data | {"lowest": data["lowest"] + 1}
    if data["lowest"] > 1:
        yield data | {"lowest": data["lowest"] - 1, "points": data["points"][:-1]}
    yield data | {"modes": data["lowest"] + 2}
    yield data | {"alpha": "0.1"}
    yield data | {"ends": ["clamped", "pinned"], "column": "another"}


def at_one(data: Data, value: str) -> Fraction:
    """The load at one value of the parameter, in the prover's words."""
    name = data["range"]
    given = {key: data[key] for key in ("alpha", "beta", "kappa") if data[key] is not None} | data["parameters"]
    return Fraction(enclosed_load(fb.column(data["column"]), **given | {name: value}).load[0])  # type: ignore[index]


def of_range(data: Data) -> Iterator[Data]:
    pieces = data["pieces"]
    for k, p in enumerate(pieces):

        def with_piece(k: int = k, **changes: Any) -> Data:
            return data | {"pieces": [*pieces[:k], pieces[k] | changes, *pieces[k + 1 :]]}

        low, high = map(Fraction, p["load"])
        one, other = sorted(at_one(data, p[end]) for end in ("low", "high"))
        yield data | {"pieces": pieces[:k] + pieces[k + 1 :]}
        narrower = [((one + other) / 2, high), (low, (one + other) / 2)] if other - one > Fraction(1, 10**9) else []
        for load in (*narrower, (high, 2 * high - low)):
            yield with_piece(load=[str(v) for v in load])
        yield with_piece(high=str(Fraction(p["high"]) + 1))
        if p["kind"] == "flutter":
            yield with_piece(frequency_squared=shifted(p["frequency_squared"], "1.1"))
            yield with_piece(kind="divergence", frequency_squared=None)
        else:
            yield with_piece(kind="flutter", frequency_squared=["30", "31"])
        yield with_piece(stretches=p["stretches"][1:])
        yield with_piece(stretches=p["stretches"][:-1])
        yield with_piece(lowest=p["lowest"] + 1)
    yield data | {"open": [[pieces[0]["low"], pieces[0]["high"]]]}
    yield data | {"pieces": pieces[:1] * 2}
    name = data["range"]
    if name in data["parameters"]:
        low, high = data["parameters"][name]
        yield data | {"parameters": {name: [low, str(Fraction(high) + 1)]}}
        yield data | {"parameters": {name: low}}
    else:
        yield data | {name: [data[name][0], str(Fraction(data[name][1]) + 1)]}
        yield data | {name: data[name][0]}
    yield data | {"range": "nothing"}
    yield data | {"column": "another", "ends": ["clamped", "pinned"]}


@pytest.mark.parametrize("case", ["three", "touch"])
def test_lists_of_what_is_not_so_are_refused(case: str) -> None:
    for forged in of_list(touch() if case == "touch" else certificate("list", case)):
        refused(forged, ".")


def test_a_touch_is_told_from_a_crossing() -> None:
    stated = verify(touch())
    assert "touches zero and goes back at a touch between 9.8696" in str(stated)
    assert "changes nowhere;" in str(stated)
    F, internal, none = Shooting(*of_kernel(beck, eta=Fraction(1, 2))), (Fraction(1), Fraction(1)), (Fraction(0),) * 2
    for limit in (False, True):  # two eigenvalues meet in zero there
        with precision(128), pytest.raises(Refused, match="how an eigenvalue leaves zero is not known"):
            verifier_of_beam._touches(Equations(F, 0, internal, none, limit), F, stated.passings, Fraction(12))
    with precision(128):  # and with as little external damping alone as one likes
        little = Equations(F, 0, none, (Fraction(1, 99),) * 2, False)
        verifier_of_beam._touches(little, F, stated.passings, Fraction(12))
    there = touch()["crossings"][0]
    refused(touch() | {"crossings": [there | {"load": ["9.8697", "9.8698"]}]}, "a touch is not in its interval")


@pytest.mark.parametrize("case", RANGES)
def test_ranges_of_what_is_not_so_are_refused(case: str) -> None:
    for forged in of_range(certificate("range", case)):
        refused(forged, ".")


def test_a_list_ends_where_it_says() -> None:
    """Beyond the next crossing, or before the last one."""
    data = certificate("list", "none")
    refused(data | {"load_max": "21"}, "another crossing could be near")
    refused(certificate("list", "three") | {"load_max": "16"}, "a crossing is not below the end of the loads")
    refused(data | {"load_max": "1e299"}, "go on for too long")
    refused(data | {"load_max": "-1"}, "the loads end where they begin")


def test_a_range_beyond_what_was_looked_at_is_refused() -> None:
    """One piece for all of a range that needed two; of a column that is not ours, of other forms at its ends."""
    data = certificate("range", "divergence")
    first, last = (data["pieces"][k] for k in (0, -1))
    one = first | {"high": last["high"], "load": [first["load"][0], last["load"][1]]}
    assert verify(data | {"pieces": [one]}).pieces[0].high == Fraction("0.305")  # so it is, as it happens
    refused(data | {"pieces": [one | {"load": first["load"]}]}, "no crossing in the interval")
    bent = deepcopy(data["forms"])
    bent[1]["H"]["points"][0][4] = "0.4"
    refused(data | {"forms": bent}, "the form H is not those of the column")
    refused(data | {"forms": bent, "column": "another"}, "no crossing in the interval")
    bent[1]["H"]["along"][0][3] = "-1.1"
    refused(data | {"forms": bent, "column": "another"}, "no crossing in the interval")
    stated = verify(data | {"column": "another"})
    assert not stated.ours and "linear in eta between what this file says of its two ends" in str(stated)


def test_damping_that_is_there_at_one_end_alone_is_refused() -> None:
    data = certificate("range", "damped")
    damping = data["damping"]
    (piece,) = data["pieces"]
    still = {"damping": [None, damping[1]], "beta": ["0", data["beta"][1]], "pieces": [piece | {"low": "0"}]}
    refused(data | still, "there is damping at one end of the range alone")
    internal = [damping[0], damping[1] | {"of_E": "0.1"}]
    refused(data | {"damping": internal, "column": "another"}, "internal damping is nothing at one end")


def test_hostile_files_are_refused_before_anything_is_computed(monkeypatch: pytest.MonkeyPatch) -> None:
    data, ranged = certificate("list", "three"), certificate("range", "flutter")
    crossing, piece = data["crossings"][0], ranged["pieces"][0]

    def begun(*given: Any) -> Any:
        raise AssertionError("it was begun")

    for name in ("Bounds", "Shooting", "check_rigid"):
        monkeypatch.setattr(verifier_of_beam, name, begun)
    with pytest.raises(AssertionError, match="begun"):
        verify(data)
    for hostile in (
        data | {"crossings": data["crossings"] * 1000},
        data | {"crossings": {}},
        data | {"crossings": [crossing | {"change": True}]},
        data | {"crossings": [crossing | {"kind": []}]},
        data | {"crossings": [crossing | {"unstable": 10**9}]},
        data | {"load_max": None},
        data | {"load_max": "nan"},
        data | {"load_max": "1e299"},
        data | {"modes": 10**6},
        data | {"points": ["0"] * 10**6},
        ranged | {"pieces": [piece] * 5000},
        ranged | {"pieces": []},
        ranged | {"pieces": [piece | {"modes": 10**6}]},
        ranged | {"pieces": [piece | {"load": ["1e200", "2e200"]}]},
        ranged | {"pieces": [piece | {"stretches": piece["stretches"] * 10**5}]},
        ranged | {"open": [["0.6", "0.6"]]},
        ranged | {"open": [["0.6"]]},
        ranged | {"range": {}},
        ranged | {"range": "alpha"},
        ranged | {"forms": ranged["forms"][0]},
        ranged | {"damping": None},
    ):
        refused(hostile, ".")


# ------------------------------------------------------------ its own steps


def test_a_list_may_be_as_long_as_the_most_and_no_longer() -> None:
    assert listed([1, 2], 2, "cells") == [1, 2]
    for given in ([1, 2, 3], (1, 2), None):
        with pytest.raises(Refused, match="no list of cells, or there are too many"):
            listed(given, 2, "cells")


def test_a_cell_that_is_left_out_is_missed(monkeypatch: pytest.MonkeyPatch) -> None:
    data, halves = certificate("list", "none"), verifier_cells._halves
    for kept in (0, 1):
        monkeypatch.setattr(verifier_cells, "_halves", lambda side, kept=kept: [halves(side)[kept]])
        refused(data, "the cells do not cover all loads and frequencies")


@pytest.mark.parametrize("real", [True, False])
def test_a_zero_next_to_s_or_frequency_zero_is_left_out_with_damping_alone(real: bool) -> None:
    """P = 1 and x = 0.05 on a cell from x = 0 on: with damping the second equation vanishes at ω = 0 alone, as is known
    of it, so that a slope that is not zero leaves nothing else; without, there may be a crossing."""

    def system(value: Any, P: arb, x: arb) -> Any:
        return [P - 1, x - arb("0.05")], [[arb(1), arb(0)], [arb(0), arb(1)]]

    equations = _alone(system, real)
    cells = Cells(equations, Fraction(2), [])
    found = cells.excluded(SimpleNamespace(value=None), arb(1, 1), arb("0.05", "0.0501"), [])  # type: ignore[arg-type]
    assert (found is None) == (not real)


def _alone(system: Any, real: bool = True) -> Any:
    return SimpleNamespace(R=0, real=real, system=system, centre=lambda f, P, x: system(f, P, x)[0])


def test_a_cell_beside_a_blurred_crossing_holds_no_other() -> None:
    """P = 1 and x = 1 up to 1/8, as over a range: a cell that is nearer than that is told by the crossing beside it."""

    def system(value: Any, P: arb, x: arb) -> Any:
        return [P - 1 + arb(0, "0.125"), x - 1 + arb(0, "0.125")], [[arb(1), arb(0)], [arb(0), arb(1)]]

    crossing = [arb(1, "0.01"), arb(1, "0.01")]
    cells = Cells(_alone(system), Fraction(2), [crossing])
    beside = arb("1.09375", "0.03125"), arb(1, "0.03125")
    box: Any = SimpleNamespace(value=None)
    assert cells.excluded(box, *beside, [crossing]) is None
    assert cells.excluded(box, *beside, []) is not None and cells.excluded(box, *beside, [crossing] * 2) is not None
    assert cells._near([arb("1.05", "0.03"), arb(1)]) and not cells._near([arb("1.05", "0.015"), arb(1)])


@pytest.mark.parametrize("b, c, holds", [("0.9", "0.9", True), ("1.1", "1.1", False), ("10", "0.05", True)])
def test_a_box_is_one_to_one_where_no_matrix_of_slopes_is_singular(b: str, c: str, holds: bool) -> None:
    """Slopes [[1, β], [γ, 1]], |β| ≤ b, |γ| ≤ c: one is singular where β γ = 1."""
    assert one_to_one([[arb(1), arb(0, b)], [arb(0, c), arb(1)]]) == holds
    assert not one_to_one([[arb(1), arb(1)], [arb(1), arb(1)]])


def _ranged(one: tuple[list[str], Form, Form], other: tuple[list[str], Form, Form]) -> Shooting:
    """F between two columns, t from −1 to 1."""
    E, H, *moved = (verifier_of_beam.added(one[k], other[k], f, F(1, 2)) for f in (F(1, 2), F(-1, 2)) for k in (1, 2))
    return Shooting(one[0], E, H, tuple(moved))


def _beck(springs: tuple[Any, ...] = (), along: tuple[Any, ...] = (), **own: Fraction) -> tuple[list[str], Form, Form]:
    """Beck's column on more than it stands on."""
    ends, E, H = of_kernel(beck, **own)
    return ends, (E[0] + along, E[1] + springs), H


# what changes: one condition; two of them, and F with the square; the equation in several orders; all of these
MOVED: dict[str, Any] = {
    "end": lambda v: _beck(eta=F(3, 10) + v / 10),
    "springs": lambda v: _beck(((1, 0, 1, 0, 9 + v), (1, 1, 1, 1, 9 - v))),
    "equation": lambda v: _beck(along=((0, 0, 0, 100 + 5 * v), (0, 1, 1, 1 + v / 10), (1, 1, 1, v / 10))),
    "all": lambda v: _beck(((1, 0, 1, 0, 9 + v),), ((0, 0, 0, 100 + 5 * v),), eta=F(6, 10) + v / 50),
}


@pytest.mark.parametrize("what", MOVED)
def test_the_function_of_each_value_is_in_that_of_the_range(what: str) -> None:
    """With its derivatives, and hardly more than these."""
    column = MOVED[what]
    with precision(128):
        over, at = _ranged(column(F(-1)), column(F(1))), (arb(12, 1), arb(150, 10))
        box = Box(over, *at)
        beyond = [Box(Shooting(*column(v)), *at) for v in (F(-4), F(4))]
        for value in (F(-1), F(-1, 3), F(1, 2), F(1)):
            one = Box(Shooting(*column(value)), *at)
            for p, s in ((arb(12), arb(150)), (arb("12.7"), arb(143))):
                for i, j in ((0, 0), (1, 0), (0, 1), (2, 1)):
                    held, exact = box.value(p, s, i, j), one.value(p, s, i, j)
                    assert held.overlaps(exact) and exact.rad() < held.rad() / 100
                    terms = [Box(over, *at, of=n).value(p, s, i, j) * ball(value) ** n for n in range(POWERS + 1)]
                    assert sum(terms, arb(0)).overlaps(exact)
                assert not all(box.value(p, s).overlaps(other.value(p, s)) for other in beyond)
    with pytest.raises(ArithmeticError, match="higher order"):
        Box(over, arb(12, 1), arb(0), 1).value(arb(12), arb(0), 0, 2)


def test_powers_of_the_parameter_that_are_left_out_are_in_the_rest(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where fewer are kept, at the ends of the range; and none is where the equation is without it."""
    column, point = MOVED["equation"], (arb(12), arb(150))
    rests = []
    for powers in (1, 2, 3, 4):
        monkeypatch.setattr(verifier_shooting, "POWERS", powers)
        with precision(128):
            over = _ranged(column(F(-1)), column(F(1)))
            box, whole = Box(over, *point), over.at(arb(13), arb(150), 0)
            for value in (F(-1), F(1)):
                parts = [Box(over, *point, of=n).value(*point) * ball(value) ** n for n in range(len(whole.levels))]
                exact = Box(Shooting(*column(value)), *point).value(*point)
                missing = abs(sum((part.mid() for part in parts), arb(0)) - exact)
                assert 0 < missing < whole.rest and box.value(*point).overlaps(exact)
            rests.append(whole.rest)
    assert all(10 * less < more for more, less in pairwise(rests))
    with precision(128):
        assert _ranged(MOVED["springs"](F(-1)), MOVED["springs"](F(1))).at(arb(13), arb(150), 0).rest < 1e-30


@pytest.mark.parametrize("what", MOVED)
def test_the_equations_of_a_range_hold_those_of_each_function(what: str) -> None:
    """At a point, as the sum that Krawczyk's test takes, for values of the parameter in the range and at its ends; of
    one in the equation with a damping that it changes too."""
    column, (of_E, of_M) = MOVED[what], ((F(0), F(0)), (F(0), F(0)))
    damped = what == "equation"
    if damped:
        of_E, of_M = (F(1, 100), F(1, 100)), (F(2), F(21, 10))
    with precision(128):
        x = arb(16), arb(13 if damped else 170)
        ranged = Equations(_ranged(column(F(-1)), column(F(1))), 0, of_E, of_M, False)
        near = tuple(side + abs(side) * arb(0, 1) / 100 for side in ranged.place(*x))
        parts = ranged.at(*x, near)
        held = [sum((value[i] * weight for value, weight in parts), arb(0)) for i in (0, 1)]
        for share in (F(0), F(3, 10), F(1)):
            c_M = of_M[0] + share * (of_M[1] - of_M[0])
            one = Equations(Shooting(*column(2 * share - 1)), 0, of_E, (c_M, c_M), False)
            values = one.system(Box(one.F, *one.place(*x)).value, *x)[0]
            assert all(h.overlaps(v) and v.rad() < h.rad() / 100 for h, v in zip(held, values, strict=True))


def test_lines_are_looked_at_with_the_forms_of_both_ends_of_a_piece(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[Any] = []
    high = verifier_of_beam.High
    monkeypatch.setattr(verifier_of_beam, "High", lambda *given: asked.append(given[2]) or high(*given))
    data = certificate("range", "divergence")
    verify(data)
    of_ends = [[form["H"][1][0][-1] for form in forms] for forms in asked]
    assert of_ends == [[Fraction(p["low"]), Fraction(p["high"])] for p in data["pieces"]]
    still = Equations(Shooting(*of_kernel(beck)), 0, (F(0), F(0)), (F(0), F(0)), False)
    forms, loaded = asked[0], [form | {"H": (form["H"][0] * 30, form["H"][1])} for form in asked[0]]
    with precision(128):
        for pair in ([forms[0], loaded[1]], [loaded[0], forms[1]]):
            with pytest.raises(Refused, match="not known to be free"):
                high(verifier_of_beam.Bounds(("clamped", "free")), 40, pair, 1).check(Fraction(5), still)
        high(verifier_of_beam.Bounds(("clamped", "free")), 40, forms, 1).check(Fraction(5), still)


@pytest.mark.parametrize("falls", [False, True])
@pytest.mark.parametrize("kind", ["damped", "limit"])
def test_the_equations_of_a_range_hold_those_of_each_damping(kind: str, falls: bool) -> None:
    """At a point, as the sum of numbers times balls that Krawczyk's test takes; where beta falls as alpha grows too."""
    F, limit = Shooting(*of_kernel(beck)), kind == "limit"
    of_E, of_M = (Fraction(1, 10), Fraction(12, 100)), (Fraction(2, 10), Fraction(23, 100))
    of_M = of_M[::-1] if falls else of_M
    with precision(128):
        x = arb(13), arb(90 if limit else 7)
        ranged = Equations(F, 0, of_E, of_M, limit)
        near = tuple(side + abs(side) * arb(0, 1) / 100 for side in ranged.place(*x))
        parts = ranged.at(*x, near)
        held = [sum((value[i] * weight for value, weight in parts), arb(0)) for i in (0, 1)]
        for share in (0, Fraction(1, 3), 1):
            a, b = (of[0] + share * (of[1] - of[0]) for of in (of_E, of_M))
            one = Equations(F, 0, (a, a), (b, b), limit)
            values = one.system(Box(F, *near).value, *x)[0]
            assert all(h.contains(v.mid()) and h.rad() > 0 for h, v in zip(held, values, strict=True) if h.rad() > 0)
        assert any(h.rad() > 0 for h in held)


@pytest.mark.parametrize("limit", [False, True])
def test_equations_of_a_range_change_with_damping_as_their_differences_do(limit: bool) -> None:
    """The slope along both c_E and c_M at a point that is no crossing, and in their ratio in the limit."""
    F, middle, h = Shooting(*of_kernel(beck)), (Fraction(1, 10), Fraction(2, 10)), Fraction(1, 10**8)
    with precision(128):
        x = arb(13), arb(90 if limit else 7)

        def values(of_E: Fraction, of_M: Fraction) -> list[arb]:
            one = Equations(F, 0, (of_E, of_E), (of_M, of_M), limit)
            p, s = one.place(*x)
            return one.system(Box(F, p, s).value, *x)[0]

        for way in ((1, 0), (0, 1), (1, 1), (1, -2)):
            low, high = ([v + side * h * w for v, w in zip(middle, way, strict=True)] for side in (-1, 1))
            wide = Equations(F, 0, *zip(low, high, strict=True), limit)
            ((slopes, far),) = wide._by_damping(Box(F, *wide.place(*x)), *x)
            by = abs(ball(high[1] / high[0] - low[1] / low[0])) / 2 if limit else arb(1)
            assert 0.999 < far.rad() / by < 1.001 and abs(far.mid()) < by / 1000
            turned = -1 if limit and high[1] / high[0] < low[1] / low[0] else 1
            for slope, one, other in zip(slopes, values(*high), values(*low), strict=True):
                change = turned * (one - other) / (2 * by)
                assert abs(change - slope.mid()) < 1e-5 * max(abs(v.mid()) for v in slopes)
            assert any(v.mid() != 0 for v in slopes)


def test_touches_are_known_in_closed_form_alone() -> None:
    for eta, found in ((Fraction(1, 2), [1, 3]), (Fraction(499, 1000), None), (Fraction(1), None)):
        F = Shooting(*of_kernel(beck, eta=eta))
        with precision(128):
            if found is None:
                with pytest.raises(Refused, match="pass zero nowhere"):
                    touches(F, 0, Fraction(100))
            else:
                assert touches(F, 0, Fraction(100)) == found
    with precision(128), pytest.raises(Refused, match="no touch is known"):
        touches(F, 1, Fraction(100))


def test_zeros_of_one_less_the_cosine_are_at_even_multiples(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(verifier_touches, "_sign", lambda F, R: -1)
    with precision(128):
        assert touches(Shooting(*of_kernel(beck)), 0, Fraction(160)) == [2, 4]


def test_one_and_the_cosine_alone_pass_zero_nowhere(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of one size and of one power of k; as powers of k, cos k and sin k with factors."""
    for whole, sign in (
        ({(3, 0, 0): 2, (3, 1, 0): 2}, 1), ({(3, 0, 0): -2, (3, 1, 0): 2}, -1), ({(3, 1, 0): 1, (3, 0, 1): 1}, 0),
        ({(3, 0, 0): 1, (3, 0, 1): 1}, 0), ({(3, 0, 0): 1, (4, 1, 0): 1}, 0), ({(3, 0, 0): 2, (3, 1, 0): 1}, 0),
        ({(3, 0, 0): 1}, 0), ({}, 0), ({(3, 0, 0): 1, (3, 1, 0): 1, (5, 0, 0): 1}, 0),
        ({(3, 1, 0): 1, (4, 0, 0): 1}, 0),
    ):  # fmt: skip
        monkeypatch.setattr(verifier_touches, "_determinant", lambda rows, whole=whole: whole)
        if sign:
            assert verifier_touches._sign(Shooting(*of_kernel(beck)), 0) == sign
        else:
            with pytest.raises(Refused, match="pass zero nowhere"):
                verifier_touches._sign(Shooting(*of_kernel(beck)), 0)


def test_between_ends_of_one_known_sign_what_is_monotone_has_no_zero(monkeypatch: pytest.MonkeyPatch) -> None:
    """Nor is anything known between ends of which one is 0, as far as can be told, unless a zero there is known."""
    monkeypatch.setattr(verifier_signs, "Box", lambda *of: SimpleNamespace(value=lambda *at: arb(1)))
    a, b = Fraction(3), Fraction(5)
    for low, high in product((-1, 0, 1), repeat=2):
        them: Any = object.__new__(Signs)
        them.F, them.R = None, 0
        them.sign = lambda x, y, s, low=low, high=high: low if x == 3 else high
        assert them._one_zero(a, b, []) == (low == high != 0)
        assert them._one_zero(a, b, [(Fraction(4), Fraction(9, 2))])
        assert not them._one_zero(a, b, [(Fraction(4), Fraction(6))])


def test_a_crossing_is_of_one_direction_alone() -> None:
    still = (Fraction(0), Fraction(0))
    equations = Equations(Shooting(*of_kernel(beck, eta=Fraction(2, 5))), 0, still, still, False)
    for passing in verify(certificate("list", "three")).passings:
        verifier_of_beam._passing(equations, passing)
        with pytest.raises(Refused, match="not known to change so"):
            verifier_of_beam._passing(equations, replace(passing, change=-passing.change))


def test_the_direction_in_a_limit_is_the_curvature_of_the_branch() -> None:
    """2 P s″ of the branch s(P) where P s′ = s + κ, by differences of a long series' eigenvalues."""
    kappa = Fraction(1, 10)
    (c,) = (c for c in fb.exact_crossings(fb.column("beck"), kappa=kappa, load_max=12))
    P, s, h = float(c.load[0]), float(c.frequency[0]) ** 2, 0.02
    branch = [
        np.sort(fb.spectrum(fb.column("beck", "legendre").system(24, load)).eigenvalues.imag)
        for load in (P - h, P, P + h)
    ]
    near = [min(w**2 for w in found if abs(w**2 - s) < 20) for found in branch]
    curvature = (near[0] - 2 * near[1] + near[2]) / h**2
    one, ratio = (Fraction(1),) * 2, (kappa,) * 2
    equations = Equations(Shooting(*of_kernel(beck)), 0, one, ratio, True)
    with precision(128):
        direction = equations._direction([arb(P, 1e-9), arb(s, 1e-9)])
    assert float(direction) == pytest.approx(P * curvature, rel=1e-3)


def test_a_static_zero_that_is_not_said_is_found() -> None:
    """Of the dead load at π²/4 and 9π²/4: each in its place, and no other."""
    zeros = [Fraction(round(n * n * pi * pi / 4 * 10**9), 10**9) for n in (1, 3)]
    known = [(z - Fraction(1, 10**6), z + Fraction(1, 10**6)) for z in zeros]
    with precision(128):
        still = (Fraction(0), Fraction(0))
        signs = Signs(Equations(Shooting(*of_kernel(beck, eta=Fraction(0))), 0, still, still, False), arb(100))
        signs.static(Fraction(25), known)
        signs.static(Fraction(2), [])
        with pytest.raises(Refused, match="not known to differ from zero"):
            signs.static(Fraction(25), known[:1])


def test_a_cell_at_the_bottom_of_a_column_that_moves_rigidly() -> None:
    """F holds s²; F/s² does not vanish there, but does with its slope at no load that is looked at."""
    still = (Fraction(0), Fraction(0))
    with precision(128):
        ends, E, H = of_kernel(fb.column("free-free").kernel)
        cells = Cells(Equations(Shooting(ends, E, H), 2, still, still, False), Fraction(40), [])
        cells.check(Fraction(400))
        assert cells.covered == 40 * 400


# ------------------------------------------------------------ from outside


def test_the_command_line_writes_lists_and_ranges(tmp_path: Any, capsys: pytest.CaptureFixture[str]) -> None:
    asked = ["critical", "--column", "beck", "--exact", "--certificate"]
    for name, given, said in (
        ("list", ["--all", "--load-max", "3", "--set", "eta=0"], "changes at exactly 1 of these loads"),
        ("range", ["--set", "eta=0.3..0.302"], "for each value of eta from 0.3 to 0.302"),
    ):
        file = tmp_path / f"{name}.json"
        assert run(capsys, *asked, str(file), *given)[0] == 0
        status, text, _ = run(capsys, "verify", str(file))
        assert status == 0 and said in " ".join(text.split())
        assert run(capsys, *asked, str(file), *given)[0] == 2  # it exists


# ------------------------------------------------------------ many, from the command line


def drawn(seed: int) -> tuple[str, dict[str, Any], tuple[str, str, str]]:
    """A column, its damping, and a range."""
    r = random.Random(seed)
    name = r.choice(["beck", "beck", "euler-pinned", "free-free"])
    given: dict[str, Any] = {} if name != "beck" else {"eta": str(Fraction(r.randint(0, 120), 100))}
    damped = r.choice([{}, {"beta": "0.3"}, {"alpha": "0.02", "beta": "0.1"}, {"kappa": str(r.randint(0, 3))}])
    low = Fraction(r.randint(10, 40), 100)
    of_damping = ("kappa", "0.2", "0.22") if "kappa" in damped else ("beta", "0.2", "0.22")
    ranged = ("eta", str(low), str(low + Fraction(1, 200))) if name == "beck" else of_damping
    return name, given | damped, ranged


def certificates(seed: int) -> Iterator[tuple[Any, Data]]:
    """A list and a range of a random column, each with what forges it."""
    name, given, ranged = drawn(seed)
    load_max = {"beck": 25, "euler-pinned": 45, "free-free": 115}[name]
    others = {key: value for key, value in given.items() if key != ranged[0]}
    for forging, prove, asked in (
        (of_list, fb.exact_crossings, ((), given | {"load_max": load_max})),
        (of_range, fb.exact_range, (ranged, others)),
    ):
        try:
            proven: Any = prove(fb.column(name), *asked[0], **asked[1])
        except fb.InputError as error:
            print(seed, name, given, ranged, "not proven:", error, flush=True)
            continue
        yield forging, json.loads(json.dumps(proven.unverified))


def main(count: int, first: int = 0) -> None:
    tried = accepted = 0
    for seed in range(first, first + count):
        for forging, data in certificates(seed):
            try:
                verify(data)
                accepted += 1
            except Refused as error:
                print(seed, data["format"], "A TRUE ONE IS REFUSED:", error, flush=True)
            for forged in forging(data):
                tried += 1
                try:
                    print(seed, "ACCEPTED:", verify(forged), flush=True)
                except Refused:
                    pass
        print(f"{seed}: {accepted} true ones accepted; {tried} forgeries tried", flush=True)


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
