"""Certificates over ranges of a parameter in the equation of motion or in a spring: accepted, and forgeries refused.

    PYTHONPATH=. python -m tests.certify.test_range_certificates

proves and verifies these and some more, prints how long each took, and tries every forgery of those of one piece; with
cases as arguments those alone.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator
from copy import deepcopy
from fractions import Fraction
from functools import cache
from time import process_time
from typing import Any
from unittest.mock import patch

import pytest

import freebeam as fb
from freebeam.proofs import enclosed_load
from freebeam_derive.certify import beam_stability, verifier_cells
from freebeam_derive.certify.verifier_claims import Refused
from tests.certify.test_beam_certificates import Data, computed_once, refused, shifted, verify
from tests.certify.test_beam_certificates import certificate as certificate_of_one
from tests.certify.test_beam_lists_and_ranges import of_range
from tests.front.test_proofs import run

__all__ = ["computed_once"]  # a fixture that each test uses

F = Fraction
CASES: dict[str, tuple[str, tuple[str, str, str], dict[str, Any]]] = {
    "foundation": ("foundation", ("k", "100", "101"), {}),
    "spring": ("tip-spring", ("k", "35", "35.1"), {}),
}
MORE = {
    "foundation, limit": ("foundation", ("k", "100", "101"), {"kappa": "120"}),
    "foundation, damped": ("foundation", ("k", "100", "101"), {"alpha": "0.01", "beta": "0.1"}),
    "foundation over 10 %": ("foundation", ("k", "100", "110"), {}),
    "dead load": ("beck-dead-load", ("w", "1", "1.1"), {}),
    "dead load over 10 %, damped": ("beck-dead-load", ("w", "1", "1.1"), {"beta": "0.1"}),
    "weight": ("beck-self-weight", ("g", "3", "3.03"), {}),
    "weight, damped": ("beck-self-weight", ("g", "3", "3.03"), {"beta": "0.1"}),
    "weight over 10 %": ("beck-self-weight", ("g", "3", "3.3"), {}),
    "soft spring": ("tip-spring", ("k", "10", "10.1"), {}),
    "soft spring, damped": ("tip-spring", ("k", "10", "10.1"), {"beta": "0.1"}),
}


@cache
def found(case: str) -> Any:
    name, ranged, given = (CASES | MORE)[case]
    with patch.object(beam_stability, "COUNTS", (40, 40)):  # more modes would only take the verifier's time here
        return fb.exact_range(fb.column(name), *ranged, **given)


def certificate(case: str) -> Data:
    data: Data = json.loads(json.dumps(found(case).unverified))
    return data


def assert_within(stated: Any, column: str, given: dict[str, Any]) -> None:
    """The load of one value of the parameter is in that of its piece."""
    exact = enclosed_load(fb.column(column), digits=9, **given)
    value = F(given[stated.parameter])
    (at, *_) = (p for p in stated.pieces if p.low <= value <= p.high)
    assert at.load[0] < F(exact.load[0]) and F(exact.load[1]) < at.load[1] and at.kind == exact.kind  # type: ignore[index]


@pytest.mark.parametrize("case", CASES)
def test_a_range_is_accepted_as_it_was_written(case: str) -> None:
    column, (name, low, high), given = CASES[case]
    stated = verify(certificate(case))
    assert (stated.parameter, stated.low, stated.high) == (name, F(low), F(high)) and not stated.open
    for share in (F(0), F(1, 3), F(1)):
        value = stated.low + share * (stated.high - stated.low)
        assert_within(stated, column, given | {name: value})
    said = str(stated)
    assert f"linear in {name} between what this file says of its two ends" in said
    assert f"for each value of {name} from {low} to {high}" in said and "the first over all modes" in said


def of_any_range(data: Data) -> Iterator[Data]:
    """The same certificate of something that is not so."""
    yield from of_range(data)
    (piece, *others), name = data["pieces"], data["range"]

    def with_piece(**changes: Any) -> Data:
        return data | {"pieces": [piece | changes, *others]}

    wider = str(10 * F(data["parameters"][name][1]))
    bent = deepcopy(data["forms"])
    (place,) = ((part, k) for part in bent[0]["E"] for k, term in enumerate(bent[0]["E"][part])
                if term != bent[1]["E"][part][k])  # fmt: skip
    term = bent[1]["E"][place[0]][place[1]]
    term[-1] = str(10 * F(term[-1]))
    yield data | {"forms": bent}
    if not others:
        yield with_piece(high=wider) | {"forms": bent, "parameters": {name: [piece["low"], wider]}}
    yield data | {"forms": [bent[1], bent[1]]}
    stretches = deepcopy(piece["stretches"])
    stretches[0]["points"][-1] = str(F(3, 2) * F(stretches[0]["points"][-1]))
    yield with_piece(stretches=stretches)
    yield with_piece(modes=piece["lowest"] + 2)
    if piece["lowest"] > 1:
        fewer = [s | {"points": s["points"][:-1]} for s in piece["stretches"]]
        yield with_piece(lowest=piece["lowest"] - 1, stretches=fewer)
    if data["damping"][0] is None:
        damped = {"of_M": "1/2", "of_E": "0", "vanishing": False}
        yield data | {"damping": [damped, damped], "beta": "1/2"}
        stretches = deepcopy(piece["stretches"])
        stretches[-1]["slope"] = str(F(stretches[-1]["slope"]) + 50)
        stretches[-1]["points"][1] = "1"
        yield with_piece(stretches=stretches)
    else:
        yield data | {"damping": [None, None], "beta": "0", "kappa": None}
        for end in (0, 1):
            damping = deepcopy(data["damping"])
            damping[end]["of_M"] = str(F(damping[end]["of_M"]) + 5)
            yield data | {"damping": damping}
    if piece["frequency_squared"] is not None:
        yield with_piece(frequency_squared=shifted(piece["frequency_squared"], "1.02"))
    yield with_piece(load=shifted(piece["load"], "3"))


@pytest.mark.parametrize("case", CASES)
def test_ranges_of_what_is_not_so_are_refused(case: str) -> None:
    for forged in of_any_range(certificate(case)):
        refused(forged, ".")


def of_damped_foundation(high: str = "100.1") -> Data:
    """Written by hand from that of k = 100: here a parameter changes the equation and the damping at once."""
    data = certificate_of_one("foundation, damped")
    load, square = ([str(F(v) * share) for share in (F(499, 500), F(501, 500))]
                    for v in (data["load"][0], data["frequency_squared"][0]))  # fmt: skip
    forms, damping = [deepcopy(data["forms"]), deepcopy(data["forms"])], [data["damping"], deepcopy(data["damping"])]
    (place,) = (k for k, term in enumerate(forms[0]["E"]["along"]) if term[:3] == [0, 0, 0])
    forms[1]["E"]["along"][place][-1], damping[1]["of_M"] = high, str(F(1, 10) - F(high) / 100)
    piece = {key: data[key] for key in ("modes", "lowest", "kind", "stretches")}
    piece |= {"low": "100", "high": high, "load": load, "frequency_squared": square}
    kept = {key: data[key] for key in ("column", "alpha", "beta", "kappa", "ends")}
    varied = {"parameters": {"k": ["100", high]}, "forms": forms, "damping": damping}
    return kept | varied | {"format": "freebeam certificate 5", "range": "k", "pieces": [piece], "open": []}


def test_a_parameter_may_change_equation_and_damping_at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    stated, halves = verify(of_damped_foundation()), verifier_cells._halves
    assert "C = -0.9 M + 0.01 E at one end and C = -0.901 M + 0.01 E at the other" in str(stated)
    refused(of_damped_foundation("120"), "no crossing in the interval")
    for end in (0, 1):
        forged = of_damped_foundation()
        forged["damping"][end] = forged["damping"][end] | {"of_M": "-0.85"}
        refused(forged, "no crossing in the interval")
    monkeypatch.setattr(verifier_cells, "_halves", lambda side: halves(side)[:1])
    refused(of_damped_foundation(), "the cells do not cover all loads and frequencies")


def test_the_command_line_writes_what_it_verifies(tmp_path: Any, capsys: pytest.CaptureFixture[str]) -> None:
    file = str(tmp_path / "range.json")
    asked = ["critical", "--column", "tip-spring", "--exact", "--set", "k=35..35.1", "--certificate", file]
    assert run(capsys, *asked)[0] == 0
    status, text, _ = run(capsys, "verify", file)
    assert status == 0 and "k from 35 to 35.1: exactly one load" in " ".join(text.split())


def main(*cases: str) -> None:
    def of_one_piece(data: Data) -> Iterator[tuple[Data, str]]:
        yield from ((forged, "") for forged in of_any_range(data) if len(data["pieces"]) == 1)

    for case in cases or CASES | MORE:
        report(case, lambda case=case: certificate(case), verify, of_one_piece)


def report(case: str, made: Any, verify: Any, forgeries: Any) -> None:
    """What it takes to prove and to verify, and whether a forgery is accepted. made: to be called for the data."""
    began = process_time()
    data = made()
    proven, tried = process_time(), 0
    try:
        stated = verify(data)
    except Refused as refusal:
        print(f"{case}: proven in {proven - began:.1f} s, REFUSED: {refusal}", flush=True)
        return
    verified = process_time()
    print(f"{case}: {len(stated.pieces)} pieces, {len(stated.open)} open, proven in {proven - began:.1f} s, "
          f"verified in {verified - proven:.1f} s", flush=True)  # fmt: skip
    for forged, _ in forgeries(data):
        tried += 1
        try:
            print("ACCEPTED:", verify(forged), flush=True)
        except Refused:
            pass
    print(f"    {tried} forgeries tried in {process_time() - verified:.1f} s", flush=True)


if __name__ == "__main__":
    main(*sys.argv[1:])
