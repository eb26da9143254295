"""Certificates over a range of a mass or a spring: accepted as written, forgeries refused.

    PYTHONPATH=. python -m tests.certify.test_section_range_certificates

proves and verifies this one and some more, prints how long each took, and tries every forgery of it; with cases as
arguments those alone.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator
from copy import deepcopy
from dataclasses import replace
from fractions import Fraction
from functools import cache
from typing import Any

import flint
import pytest
from flint import arb, arb_mat

import freebeam as fb
from freebeam_derive.certify import verifier, verifier_of_sections, verifier_over_sections
from freebeam_derive.certify.verifier_boxes import Box
from freebeam_derive.certify.verifier_claims import Refused
from freebeam_derive.certify.verifier_load_size import load_size
from freebeam_derive.certify.verifier_of_sections import Frequencies, Gaps
from freebeam_derive.certify.verifier_over_sections import FORMATS, OverPieces, _filled, between, check_one_condition
from freebeam_derive.certify.verifier_pieces import Pieces
from freebeam_derive.certify.verifier_sections import Sections
from freebeam_derive.certify.verifier_waves import Apart
from tests.certify.test_range_certificates import assert_within, report
from tests.certify.test_section_certificates import KEPT, Data, column, computed_once, shifted

__all__ = ["computed_once"]  # a fixture that each test uses

F = Fraction
CASE = "rotary inertia"
CASES: dict[str, tuple[str, tuple[str, str, str], dict[str, Any]]] = {
    CASE: ("pflueger", ("J", "0.1", "0.102"), {}),
    "tip mass": ("pflueger", ("mu", "0.9", "1.1"), {}),
    "tip mass that turns": ("pflueger", ("mu", "0.9", "1"), {"J": "0.1"}),
    "elastic root": ("elastic-root", ("c", "10", "10.5"), {}),
    "mass at mid-span": ("point-mass", ("mu", "0.45", "0.5"), {}),
    "mass beside a step": ("step", ("mu", "0.3", "0.31"), {"a": "0.6"}),
}


@cache
def found(case: str) -> Any:
    name, ranged, given = CASES[case]
    return fb.exact_range(fb.column(name), *ranged, **given)


def certificate(case: str = CASE) -> Data:
    data: Data = json.loads(json.dumps(found(case).unverified))
    return data


@pytest.fixture(autouse=True)
def functions_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """F of a piece, for all the forgeries that leave it."""

    def over(ends: list[Pieces]) -> OverPieces:
        key = repr([of.column for of in ends])
        if key not in KEPT:
            KEPT[key] = OverPieces(ends)
        known: OverPieces = KEPT[key]
        return known

    monkeypatch.setattr(verifier_over_sections, "Pieces", verifier_of_sections.Pieces)
    monkeypatch.setattr(verifier_over_sections, "OverPieces", over)


def verify(data: Data) -> Any:
    return verifier.verify(data, FORMATS)


def refused(data: Data, match: str) -> None:
    with pytest.raises(Refused, match=match):
        verify(data)


def test_stretches_out_of_order_are_refused_before_anything_is_computed(monkeypatch: pytest.MonkeyPatch) -> None:
    data = certificate()
    for name in ("check", "_frequencies"):
        monkeypatch.setattr(Gaps, name, lambda *_: pytest.fail("computed"))
    (piece,) = data["pieces"]
    for n, stretch in enumerate(piece["stretches"]):
        for unlike, match in (
            ({"start": "1/7"}, "leave a gap"),
            ({"points": [*stretch["points"][:-1], str(2 * F(piece["line"]))]}, "beyond the line"),
            ({"moving": None if stretch["moving"] is not None else 0}, "a point moves"),
        ):
            stretches = [stretch | unlike if k == n else of for k, of in enumerate(piece["stretches"])]
            refused(data | {"pieces": [piece | {"stretches": stretches}]}, match)


def test_a_range_is_accepted_as_it_was_written() -> None:
    name, (parameter, low, high), given = CASES[CASE]
    stated = verify(certificate())
    assert (stated.parameter, stated.low, stated.high, stated.open) == (parameter, F(low), F(high), ())
    assert_within(stated, name, given | {parameter: F("0.1013")})
    text = str(stated)
    assert "linear in J between what this file says of its two ends, for each value of J from 0.1 to 0.102" in text
    assert "undamped" in text and "that they are its is not checked" in text and "the first over all modes" in text
    assert stated.record()["breaks"] == ["0", "1"] and stated.record()["of"].endswith("the forms in this file")


def forgeries(data: Data) -> Iterator[tuple[Data, str]]:
    """The same certificate of something that is not so, and the step that is to fail."""
    (piece, *others), name, ends = data["pieces"], data["range"], data["forms"]
    low, high = data["parameters"][name]

    def with_piece(**changes: Any) -> Data:
        return data | {"pieces": [piece | changes, *others]}

    def with_ends(*forms: Data) -> Data:
        return data | {"forms": [*forms]}

    def changed(end: int, form: str, part: str, k: int, factor: str) -> Data:
        forms = deepcopy(ends)
        term = forms[end][form][part][k]
        term[-1] = str(F(factor) * F(term[-1]))
        return with_ends(*forms)

    (letter, k), = ((form, n) for form in "ME" for n, term in enumerate(ends[0][form]["points"])
                    if term != ends[1][form]["points"][n])  # fmt: skip
    gap = "leave a gap|lie on one another"
    yield with_piece(high=str((F(low) + F(piece["high"])) / 2)), gap
    yield data | {"pieces": [piece, piece, *others]}, gap
    yield data | {"parameters": data["parameters"] | {name: [low, str(2 * F(high))]}}, gap
    yield data | {"pieces": others, "open": [[low, high]]}, "nothing is said|" + gap
    crossing = "no crossing in the interval"
    yield changed(1, letter, "points", k, "3/2"), crossing  # a wider interval of what changes
    yield with_ends(ends[1], changed(1, letter, "points", k, "3/2")["forms"][1]), crossing
    yield changed(0, "M", "along", 0, "101/100"), "more than masses, springs and forces"
    yield changed(1, "E", "along", 0, "101/100"), "more than masses, springs and forces"
    forms = deepcopy(ends)
    forms[1]["E"]["points"].append([len(data["breaks"]) - 1, 0, len(data["breaks"]) - 1, 0, "1/100"])
    if (letter, ends[0][letter]["points"][k][:2]) != ("M", [len(data["breaks"]) - 1, 0]):
        yield with_ends(*forms), "more than one condition"
    yield data | {"damping": [None, {"form": ends[0]["M"], "vanishing": False}]}, "at one end of the range alone"
    yield data | {"range": "more"}, "the parameter of the range is none"
    yield data | {"breaks": ["0", "1/3", "1"]}, "."
    yield with_piece(load=shifted(piece["load"], "1.05")), crossing
    width = F(piece["load"][1]) - F(piece["load"][0])
    yield with_piece(load=[str(F(v) + s * width / 5) for v, s in zip(piece["load"], (1, -1), strict=True)]), crossing
    if piece["kind"] == "flutter":
        yield with_piece(frequency_squared=shifted(piece["frequency_squared"], "1.02")), crossing
        yield with_piece(kind="divergence", frequency_squared=None), crossing
    free = "not known to be free|too narrow|beyond the line|not known to change sign"
    yield with_piece(line=str(3 * F(piece["line"]))), free
    yield with_piece(line=str(F(piece["line"]) / 3)), free
    if piece["lowest"] > 1:
        fewer = [s | {"points": s["points"][:-1]} for s in piece["stretches"]]
        yield with_piece(lowest=piece["lowest"] - 1, stretches=fewer), free + "|a point that moves is none"
    yield with_piece(stretches=piece["stretches"][1:]), "the stretches leave a gap"
    stretches = deepcopy(piece["stretches"])
    stretches[0]["points"][1] = "1/2"
    yield with_piece(stretches=stretches), "not known to change sign|do not ascend"


def test_ranges_of_what_is_not_so_are_refused() -> None:
    for forged, match in forgeries(certificate()):
        refused(forged, match)


@pytest.mark.parametrize("case, name, place", [("step and mass", "masses", (1, 0)), ("tip mass", "springs", (1, 1))])
def test_f_between_two_columns_is_linear(case: str, name: str, place: tuple[int, int]) -> None:
    """Where segments meet, and at an end: F of a column apart."""
    _, of = column(case)
    other = replace(of, **{name: getattr(of, name) | {place: F(2)}})
    with flint.ctx.workprec(64):
        whole, p, s = OverPieces([Pieces(of), Pieces(other)]), arb(2), arb(150)
        middle, half = (Box(whole, p, s, 0, of=n).value(p, s) for n in (0, 1))
        apart = Box(Pieces(between(of, other, F(3, 4))), p, s, 0).value(p, s) - middle
        assert apart.overlaps(half / 2) and (apart - half / 2).rad() < abs(half) / 10**9


def test_frequencies_and_the_loads_size_of_a_range_hold_those_between() -> None:
    """With a mass and a spring in one condition too, where some rise and some fall; a dead load at the tip."""
    _, of = column("tip mass")
    for other in (
        replace(of, masses=of.masses | {(1, 0): F(3, 2)}),
        replace(of, masses=of.masses | {(1, 0): F(3, 2)}, springs={(1, 0): F(30)}),
        replace(of, masses=of.masses | {(1, 0): F(1, 2)}, forces={key: f / 2 for key, f in of.forces.items()}),
    ):
        check_one_condition(of, other)
        inner = between(of, other, F(1, 3))
        with flint.ctx.workprec(64):
            gaps = Gaps([(each, Pieces(each)) for each in (of, other)], 1, F(1))
            both = gaps._frequencies(arb(6), arb(1))
            for (low, high), (below, above) in zip(
                both, Frequencies(Pieces(inner), arb(6), arb(1)).all(), strict=False
            ):
                assert low < above and below < high
            assert load_size([inner]).constant <= gaps.size.constant and len(both) > 2


def test_waves_of_a_range_hold_those_of_each_value() -> None:
    _, of = column("step and mass")
    other: Sections = replace(of, masses={key: 2 * mass for key, mass in of.masses.items()})
    with flint.ctx.workprec(128):
        whole = Apart(of, other)
        for share in (F(0), F(1, 3), F(1)):
            one = Apart(between(of, other, share))
            for wave, (B,) in one.stages[-1].items():
                for held, value in zip(whole.stages[-1][wave][0].coeffs(), B.coeffs(), strict=True):
                    assert held.overlaps(value) and held.real.rad() < 1


def test_a_polynomial_of_fewer_powers_is_the_same_with_more() -> None:
    """So that half of two is the value between them, whichever has more powers of P, and of s."""
    of = arb_mat([[1, 2], [3, 4]])
    assert _filled(of, 3, 4).tolist() == [[1, 2, 0, 0], [3, 4, 0, 0], [0, 0, 0, 0]] and _filled(of, 2, 2) == of


def main(*cases: str) -> None:
    for case in cases or CASES:
        report(case, lambda case=case: certificate(case), verify, forgeries)


if __name__ == "__main__":
    main(*sys.argv[1:])
