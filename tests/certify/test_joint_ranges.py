"""A range of the spring of a joint: what is said of all its values holds at each, and what is no joint is refused.

    PYTHONPATH=. python -m tests.certify.test_joint_ranges

proves and verifies those of CASES and tries every forgery of each.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator
from dataclasses import replace
from fractions import Fraction
from types import SimpleNamespace
from typing import Any

import flint
import pytest
from flint import arb

import freebeam as fb
from freebeam_derive.certify import verifier
from freebeam_derive.certify.balls import Range, exact
from freebeam_derive.certify.beam import NoSeries
from freebeam_derive.certify.column_forms import ColumnForms, over_both
from freebeam_derive.certify.frequency_gaps import FrequencyGaps
from freebeam_derive.certify.load_size import load_size as size_of_prover
from freebeam_derive.certify.stepped_section import SteppedSection
from freebeam_derive.certify.system_ranges import OverSystem
from freebeam_derive.certify.verifier_boxes import Box
from freebeam_derive.certify.verifier_claims import Refused
from freebeam_derive.certify.verifier_load_size import load_size
from freebeam_derive.certify.verifier_of_sections import Frequencies, Gaps
from freebeam_derive.certify.verifier_over_sections import FORMATS, OverPieces, between, check_one_condition
from freebeam_derive.certify.verifier_pieces import Pieces
from freebeam_derive.certify.verifier_waves import Apart
from tests.certify.refusals import try_forgeries
from tests.certify.test_frequency_gaps import system
from tests.certify.test_joint_certificates import column

F = Fraction
JOINTS = {"crack": F(5, 2), "shear": F(60)}  # another spring than the column's of that name
CASES: dict[str, tuple[str, tuple[str, str, str], dict[str, Any]]] = {
    "crack": ("crack", ("k", "5", "5.2"), {}),
    "shear": ("shear-joint", ("k", "50", "51"), {"a": "0.5"}),
    "external damping": ("crack", ("k", "1", "1.02"), {"a": "0.5", "beta": "0.3"}),
    "of external damping": ("crack", ("beta", "0.3", "0.31"), {"k": "1", "a": "0.5"}),
}


def pair(case: str) -> tuple[Any, Any, Any]:
    """The column, the same with another spring of its joint, and that place."""
    _, of = column(case)
    (place,) = of.joints
    return of, replace(of, joints={place: JOINTS[case]}), place


@pytest.mark.parametrize("case", JOINTS)
def test_f_is_linear_in_the_spring_and_the_provers_balls_hold_it(case: str) -> None:
    """Though it stands in the conditions of both sides."""
    it, of = column(case)
    low, high = sorted([*of.joints.values(), JOINTS[case]])
    whole, third = OverSystem(it.kernel, it.own | {"k": Range(low, high)}), (2 * low + high) / 3
    with flint.ctx.workprec(64):
        P, s, orders = arb(2), arb(50), ((0, 0), (0, 1))
        ends = [each.taylor(P, s, orders) for each in (whole.low, whole.high)]
        held, at = whole.taylor(P, s, orders), OverSystem(it.kernel, it.own | {"k": Range(low, third)})
        for order in orders:
            mixed, value = (2 * ends[0][order] + ends[1][order]) / 3, at.high.taylor(P, s, orders)[order]
            assert value.overlaps(mixed) and (value - mixed).rad() < abs(ends[1][order] - ends[0][order]) / 10**6
            assert held[order].contains(value.mid())


def test_what_stands_in_two_sums_is_no_range() -> None:
    """The spring in another sum on one side than on the other; and the place of the joint."""
    it, _ = column("crack")
    whole = OverSystem(it.kernel, it.own | {"k": Range(F(2), F(3))})

    def conditions(*rates: Any, k: Any, **given: Any) -> Any:
        rows = [dict(row) for row in it.kernel.conditions(*rates, k=k, **given)]
        holding = [row for row in rows if any(k in getattr(v, "free_symbols", ()) for v in row.values())]
        assert len(holding) == 2
        key = next(key for row in rows for key in row if key not in holding[0])
        return [row | {key: k} if row is holding[0] else row for row in rows]

    whole._is_linear_in("k", True)
    whole.kernel = SimpleNamespace(**vars(it.kernel) | {"conditions": conditions})
    with pytest.raises(NoSeries, match="in one condition alone, linearly"):
        whole._is_linear_in("k", True)
    with pytest.raises(NoSeries, match="give it one value"):
        OverSystem(it.kernel, it.own | {"a": Range(F(2, 5), F(1, 2))})


def test_gaps_and_waves_of_a_range_of_a_joint_hold_those_of_each_value() -> None:
    it, ends = system("crack", {"k": "4", "a": "0.5"}), (F(4), F(41, 10))
    with flint.ctx.workprec(64):
        whole = FrequencyGaps(OverSystem(it.kernel, it.own | {"k": Range(*ends)}), arb(1) / 10)
        both = over_both(*(ColumnForms(it.kernel, it.own | {"k": k}) for k in ends))
        held, _ = SteppedSection(both)._waves(1 / arb(20), arb(20))
        for k in (F(4), F(81, 20), F(41, 10)):
            forms = ColumnForms(it.kernel, it.own | {"k": k})
            section, size = SteppedSection(forms), size_of_prover(forms)
            for n, g in enumerate(section.lowest(arb(1), 3)):
                assert whole.interval(n + 1).overlaps(g**2)
                assert whole.interval(n + 1).rad() < 0.05 * g**2
            for low in (30, 300):
                assert size.at(arb(low), arb(low + 30)) <= whole.needed(arb(low), arb(low + 30))
            waves, _ = section._waves(1 / arb(20), arb(20))
            assert all(held[wave][0].overlaps(B[0]) for wave, B in waves.items())
        spring = both.joints[F(1, 2), 1]
        assert spring.contains(exact(F(81, 20))) and spring.rad() < 0.051


@pytest.mark.parametrize("case", JOINTS)
def test_the_verifiers_f_is_linear_in_the_inverse_of_the_spring(case: str) -> None:
    of, other, place = pair(case)
    check_one_condition(of, other)
    inner = between(of, other, F(1, 3))
    k, a, b = (each.joints[place] for each in (inner, of, other))
    t = (1 / k - (1 / a + 1 / b) / 2) / ((1 / b - 1 / a) / 2)
    assert -1 < t < 1
    with flint.ctx.workprec(64):
        whole, p, s = OverPieces([Pieces(of), Pieces(other)]), arb(2), arb(50)
        middle, half = (Box(whole, p, s, 0, of=n).value(p, s) for n in (0, 1))
        apart = Box(Pieces(inner), p, s, 0).value(p, s) - middle
        assert apart.overlaps(half * exact(t)) and (apart - half * exact(t)).rad() < abs(half) / 10**6


def test_the_verifiers_frequencies_sizes_and_waves_of_a_range_hold_those_between() -> None:
    of, other, _ = pair("crack")
    inner = between(of, other, F(1, 3))
    with flint.ctx.workprec(64):
        gaps = Gaps([(each, Pieces(each)) for each in (of, other)], 1, F(1))
        both = gaps._frequencies(arb(6), arb(1))
        for (low, high), (below, above) in zip(both, Frequencies(Pieces(inner), arb(6), arb(1)).all(), strict=False):
            assert low < above and below < high
        for low in (arb(30), arb(300)):
            assert load_size([inner]).at(low, low + 30) <= gaps.size.at(low, low + 30)
        whole, one = Apart(of, other), Apart(inner)
        for wave, (B,) in one.stages[-1].items():
            for held, value in zip(whole.stages[-1][wave][0].coeffs(), B.coeffs(), strict=True):
                assert held.overlaps(value) and held.real.rad() < 1


def test_columns_that_differ_in_more_than_a_joint_are_refused() -> None:
    of, other, (node, order) = pair("crack")
    at_tip = {(2, 0): F(1)}
    for unlike, why in (
        (replace(other, joints={}), "more than masses, springs and forces"),
        (replace(other, joints={(node, 1 - order): F(1)}), "more than masses, springs and forces"),
        (replace(other, masses=at_tip), "more than one condition"),
        (replace(other, springs=at_tip), "more than one condition"),
    ):
        with pytest.raises(Refused, match=why):
            check_one_condition(of, unlike)
    forces = {key: 2 * f for key, f in of.forces.items()}
    with pytest.raises(Refused, match="over a range of a force the load acts at a place without a mass"):
        load_size([of, replace(of, forces=forces)])


def forgeries(data: dict[str, Any]) -> Iterator[tuple[str, dict[str, Any]]]:
    (piece, *others), joints = data["pieces"], data["joints"]
    stiffer = [[*spring[:2], str(F(spring[2]) * F("1.2"))] for spring in joints[1]]
    yield "a stiffer joint at the upper end", data | {"joints": [joints[0], stiffer]}
    yield "a stiffer joint at both ends", data | {"joints": [stiffer, stiffer]}
    yield "no joint", {key: value for key, value in data.items() if key != "joints"}
    yield "a joint at one end alone", data | {"joints": [joints[0], []]}
    yield "joints that are not given at both ends", data | {"joints": joints[0]}
    yield "a joint of the other kind", data | {"joints": [[[n, 1 - p, k] for n, p, k in each] for each in joints]}
    moved = [str(F(v) * F("1.05")) for v in piece["load"]]
    yield "a load that is moved", data | {"pieces": [piece | {"load": moved}, *others]}
    for factor in ("1/3", "3"):
        yield "a line that is moved", data | {"pieces": [piece | {"line": str(F(piece["line"]) * F(factor))}, *others]}


def main(*cases: str) -> None:
    for case in cases or CASES:
        name, ranged, given = CASES[case]
        data = json.loads(json.dumps(fb.exact_range(fb.column(name), *ranged, **given).unverified))
        print(case, "accepted:", verifier.verify(data, FORMATS))
        try_forgeries(case, lambda forged: verifier.verify(forged, FORMATS), forgeries(data))


if __name__ == "__main__":
    main(*sys.argv[1:])
