"""Certificates of all crossings of a series: between those that they state as many eigenvalues are unstable as dense
eigenvalues count; forged lists are refused; and common roots of polynomials made by hand are seen wherever they are."""

from __future__ import annotations

import copy
import json
import sys
from dataclasses import replace
from fractions import Fraction
from functools import cache
from itertools import pairwise
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from flint import arb, arb_poly, fmpq

import freebeam as fb
from freebeam import cli
from freebeam_derive.certify import all_crossings, certificate, first_crossing, verifier, verifier_lists
from freebeam_derive.certify.all_crossings import Crossings
from freebeam_derive.certify.balls import exact, precision
from freebeam_derive.certify.boundary_polynomials import Question, _of_any
from freebeam_derive.certify.decimals import read
from freebeam_derive.certify.parts import split
from freebeam_derive.certify.verifier_claims import Refused
from freebeam_derive.certify.verifier_lists import OfCrossings, verify
from freebeam_derive.certify.verifier_plane import check_apart
from tests.certify import test_motions_apart as apart
from tests.stated import file_of

F = Fraction
Data = dict[str, Any]
CASES: dict[str, tuple[Any, int, float, dict[str, Any]]] = {  # column, N, load_max, what is asked
    "lost, regained, lost": (lambda: fb.column("beck", "modes"), 4, 60, {"eta": "0.4"}),
    "damped": (lambda: fb.column("free-free", "modes"), 3, 300, {"alpha": "0.001", "beta": "0.1"}),
    "none": (lambda: fb.column("beck", "modes"), 3, 15, {}),
}


@cache
def text(name: str) -> str:
    column, N, top, asked = CASES[name]
    return json.dumps(fb.certified_crossings(column(), N, load_max=top, digits=12, **asked).unverified)


def written(name: str) -> Data:
    data: Data = json.loads(text(name))
    return data


@cache
def accepted(name: str) -> OfCrossings:
    return verify(written(name))


def refused(data: Data, match: str | None = None) -> None:
    with pytest.raises(verifier.Refused, match=match):
        verifier.verify(data, verifier_lists.FORMATS)


@pytest.mark.parametrize("name", CASES)
def test_between_stated_crossings_as_many_eigenvalues_grow_as_numpy_counts(name: str) -> None:
    column, N, top, asked = CASES[name]
    said, dampings = accepted(name), [float(asked.get(of, 0)) for of in ("alpha", "beta")]
    own = {key: float(value) for key, value in asked.items() if key not in ("alpha", "beta")}
    assert said.load_max == F(top) and (len(said.passings) == 0) == (name == "none")
    given = dict(zip(("alpha", "beta"), dampings, strict=True)) | own
    edges = [0.0, *(float(v) for p in said.passings for v in p.load), float(top)]
    numbers = [p.unstable for p in said.passings] + [sum({p.load: p.change for p in said.passings}.values())]
    for k, (low, high) in enumerate(zip(edges[::2], edges[1::2], strict=True)):
        if not high - low > 1e-6 * high:
            continue  # crossings of two parts that are one
        for share in (0.02, 0.5, 0.98):
            system = column().system(modes=N, load=low + share * (high - low), **given)
            one, none = np.eye(len(system.K)), 0 * system.K
            inverse = np.linalg.inv(system.M)
            values = np.linalg.eigvals(np.block([[none, one], [-inverse @ system.K, -inverse @ system.C]]))
            assert (values.real > 1e-5 * abs(values).max()).sum() == numbers[k]


def test_a_limit_of_vanishing_damping_has_the_crossings_of_little_damping() -> None:
    limit, little = (
        verify(json.loads(json.dumps(fb.certified_crossings(fb.column("beck", "modes"), 4, load_max=120, **asked)
                                     .unverified)))
        for asked in ({"kappa": "3"}, {"alpha": "1e-7", "beta": "3e-7"})
    )  # fmt: skip
    assert "to first order" in str(limit) and len(limit.passings) == len(little.passings) == 2
    for one, other in zip(limit.passings, little.passings, strict=True):
        assert float(one.load[0]) == pytest.approx(float(other.load[0]), rel=1e-9)
        assert (one.unstable, one.change) == (other.unstable, other.change)


def test_statement_record_and_list_agree_and_say_so_in_one_line(tmp_path: Path, capsys: Any) -> None:
    name, (column, N, top, asked) = "lost, regained, lost", CASES["lost, regained, lost"]
    said, file = accepted(name), tmp_path / "list.json"
    assert "is 0 at first and changes at 3 crossings and nowhere else" in str(said) and "\n" not in str(said)
    assert cli.main(["critical", "--column", "beck", "--set", "eta=0.4", "--modes", str(N), "--load-max", str(top),
                     "--basis", "modes", "--digits", "12", "--all", "--certificate", str(file)]) == 0  # fmt: skip
    capsys.readouterr()
    assert cli.main(["verify", str(file), "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    listed = fb.certified_crossings(column(), N, load_max=top, digits=12, **asked)
    assert [(c["kind"], c["unstable_below"], c["unstable_above"]) for c in told["crossings"]] == [
        (c.kind, c.unstable_below, c.unstable_above) for c in listed
    ]
    assert said.record()["crossings"] == told["crossings"] and told["kind"] == "all"
    assert read(told["stable_to"]) == (said.passings[0].load[0] if said.passings else said.load_max)


def test_a_crossing_at_the_highest_load_is_stated_with_a_load_beyond() -> None:
    """Ziegler's pendulum with equal dampings that vanish: 41/28."""
    found = fb.certified_crossings(fb.column("ziegler"), kappa=0, load_max=F(41, 28), digits=10)
    (passing,) = verify(json.loads(json.dumps(found.unverified))).passings
    assert len(found) == 1 and passing.load[0] < F(41, 28) < passing.load[1]


@pytest.mark.parametrize(("kind", "seed"), [("tied", 3), ("whirls", 2), ("tied whirls", 3)])
def test_lists_of_random_systems_in_parts_are_stated_as_counted_at_200_bits(kind: str, seed: int) -> None:
    assert drawn(kind, seed)


def drawn(kind: str, seed: int) -> int:
    """How many crossings are stated of a random system, with the eigenvalues between counted."""
    terms, names = apart.drawn(seed, kind)
    names = [f"q{i}" for i in range(len(names))]
    bits = 2 * first_crossing.bits_for(len(names), 12)
    with precision(bits):
        for rest in (True, None):
            of = split(*terms, names, None, False, rest)
            parts = [replace(_of_any(p.M, p.C, p.K, False, p.known), part=p) for p in of]
            if all(all_crossings.turns_fast(part, F(12)) for part in parts):
                break
        merged = all_crossings._merged(parts, F(12), lambda _: None)
        listed = Crossings(all_crossings._refined(parts, merged, parts, 12, bits), F(12), parts, bits)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(certificate, "write", lambda _, below, *__: apart.certificate_of(terms, below))
        data = certificate.write_crossings(fb.column("beck").kernel, Question(1), listed)
    said = verify(json.loads(json.dumps(data)))
    assert len(said.passings) >= len(listed)  # parts that are the same are stated together, or each
    for one, following in pairwise([None, *said.passings, None]):
        low, high = (one.load[1] if one else F(0)), (following.load[0] if following else F(12))
        if low < high:
            count = one.unstable + one.change if one else 0
            assert sum(value > 1e-30 for value in apart.growths(terms, (low + high) / 2)) == count
    if "whirls" in kind and "turn" in json.dumps(data):
        for part in data["below"]["parts"]:
            part["frame"] = part["frame"] and part["frame"] | {"turn": "1/100"}
        refused(data)  # a real s = ω + turn may be 0 or less
    return len(said.passings)


# --- forged ones ------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", CASES)
def test_lists_with_a_crossing_less_or_more_or_elsewhere_are_refused(name: str) -> None:
    data, top = written(name), CASES[name][2]
    for k, of in enumerate(data["crossings"]):
        for n, c in enumerate(of):

            def changed(*instead: Data, n: int = n, k: int = k) -> Data:
                lists = copy.deepcopy(data["crossings"])
                lists[k][n : n + 1] = instead
                return data | {"crossings": lists}

            low, high = map(F, c["load"])
            refused(changed(), "may lie between")
            refused(changed(c, c), "do not ascend")
            width = (high - low) / 10
            for a, b in ((low - 9 * width, low), (high, high + 9 * width)):
                refused(changed(c | {"load": [str(a), str(b)]}))
            if c["kind"] == "flutter":
                refused(changed({"kind": "divergence", "load": c["load"], "frequency_squared": None}), "det K does not")
                square = [str(2 * F(v)) for v in c["frequency_squared"]]
                refused(changed(c | {"frequency_squared": square}))
            else:
                refused(changed({"kind": "flutter", "load": c["load"], "frequency_squared": ["1", "2"]}), "det K may")
            refused(changed(c | {"change": 2}), "not known")
        lists = copy.deepcopy(data["crossings"])
        lists[k].append({"kind": "divergence", "load": [str(top - F(1, 100)), str(top - F(1, 200))],
                         "frequency_squared": None})  # fmt: skip
        refused(data | {"crossings": lists})
    refused(data | {"crossings": data["crossings"][1:]}, "crossings of each part")
    refused(data | {"crossings": [*data["crossings"], []]}, "crossings of each part")
    for fewer in data:
        refused({key: value for key, value in data.items() if key != fewer})


def test_a_list_goes_on_from_where_stability_is_shown_to_the_highest_load_alone() -> None:
    data = written("lost, regained, lost")
    refused(data | {"load_max": "17"} | {"crossings": [data["crossings"][0][:2]]}, "another crossing may lie")
    verify(data | {"load_max": "16.5"} | {"crossings": [data["crossings"][0][:2]]})
    refused(data | {"load_max": "4"}, "below the highest")
    refused(data | {"load_max": "16.42"}, "do not ascend")
    for below in (written("none"), "none", {"format": "freebeam certificate 3"}):
        refused(data | {"below": below}, "in none of the formats")
    first = json.loads(json.dumps(fb.certified_load(fb.column("beck", "modes"), 4, eta="0.4").unverified))
    refused(data | {"below": first}, "not stated up to a load")
    refused(data | {"below": data["below"] | {"load_max": "5"}}, "stability is not shown up to the load")
    refused(data | {"below": data["below"] | {"parameters": {"eta": "0.41"}}})


# --- the plane --------------------------------------------------------------------------------------------------------


def rows(*of: list[Any]) -> list[arb_poly]:
    return [arb_poly(p) for p in of]


@pytest.mark.parametrize("turn", [None, 2])
@pytest.mark.parametrize("whirls", [False, True])
def test_frequencies_of_a_crossing_are_those_at_rest(turn: int | None, whirls: bool) -> None:
    """x is ω² in so many units of time, or (ω + turn)², or ω + turn of what whirls; by prover and verifier."""
    rate, scales = (fmpq(turn), [1]) if turn else (None, [1, 4, 4])
    series: Any = SimpleNamespace(system=SimpleNamespace(turn=rate, whirls=whirls))
    part: Any = SimpleNamespace(turn=F(turn or 0), whirls=whirls)

    def both(x: F | None) -> list[list[tuple[float, int]]]:
        near = None if x is None else (x * F(10**9 - 1, 10**9), x * F(10**9 + 1, 10**9))
        ours = verifier_lists._told(series, near, [F(v) for v in scales])
        found = [(kind, of, times) for kind, of, times in ours]
        assert {kind for kind, _, _ in found} == {"divergence" if x is None and not turn else "flutter"}
        assert all(of is None or of[0] < of[1] for _, of, _ in found)
        with precision(128):
            theirs = all_crossings._told(part, [] if x is None else [exact(x)], [fmpq(v) for v in scales])
            return [
                [(float(sum(of) / 2) if of else 0.0, times) for _, of, times in found],
                [(float(of) if of is not None else 0.0, times) for of, times in theirs],
            ]

    cases: dict[F | None, list[tuple[float, int]]] = {None: [(0, 3)], F(9): [(9, 1), (36, 2)]}
    if turn:  # ω = ±3 − 2 and the other sense; −1 where the frame is overtaken
        cases = {None: [(4, 2)], F(25): [(9, 1), (49, 1)], F(1): [(1, 1), (9, 1)]}
        if whirls:
            cases = {None: [(4, 2)], F(5): [(9, 1)], F(1): [(1, 1)]}
    for x, wanted in cases.items():
        for found in both(x):
            counted = {square: sum(n for other, n in found if other == square) for square, _ in found}
            assert sorted(counted.items()) == [(pytest.approx(square, rel=1e-6), n) for square, n in sorted(wanted)]
    if turn:
        x, hair = F(turn if whirls else turn**2), F(1, 100)
        for near in ((x - hair, x + hair), (x - hair, x), (x, x + hair)):
            with pytest.raises(Refused, match="may be zero in the frame"):
                list(verifier_lists._told(series, near, [F(1)]))


@pytest.mark.parametrize("place", [(F(3, 2), F(2)), (F(5, 4), F(1, 10**6)), (F(7, 4), F(10**7)), (F(2), F(5))])
@pytest.mark.parametrize("angle", [F(1), F(1, 10**4)])
def test_a_common_root_is_seen_wherever_it_is_and_at_whatever_angle(
    place: tuple[Fraction, Fraction], angle: Fraction
) -> None:
    """h = x - x₀ - P + P₀ and g = x - x₀ - (1 + angle)(P - P₀)."""
    with precision(300):
        P, x = (verifier.ball(v) for v in place)
        slope = verifier.ball(1 + angle)
        h, g = rows([P - x, -1], [1]), rows([slope * P - x, -slope], [1])
        for low, high in ((1, place[0] - F(1, 10**9)), (place[0] + F(1, 10**9), 3)):
            check_apart(h, g, verifier.ball(F(low)), verifier.ball(F(high)), 100)
        with pytest.raises(verifier.Refused, match="another crossing"):
            check_apart(h, g, arb(1), arb(3), 100)


def test_a_load_that_takes_the_damping_of_each_motion_away(tmp_path: Path) -> None:
    """Of q at P = beta, with ω² = 5; of p at P = 2 beta, with 10: g of each is a function of P alone."""
    stated = {
        "T": "(q.diff(t) ** 2 + p.diff(t) ** 2) / 2", "V": "(5 * q ** 2 + 10 * p ** 2) / 2", "W_c": "0", "ends": "()",
        "dW_nc": "(P - beta) * q.diff(t) * delta(q) + (P / 2 - beta) * p.diff(t) * delta(p)", "parameters": "()",
    }  # fmt: skip
    column = fb.column(file_of(tmp_path, "galloping", stated))
    first = json.loads(json.dumps(fb.certified_load(column, 1, beta="1/10", digits=10).unverified))
    found = fb.certified_crossings(column, 1, beta="1/10", load_max=1, digits=10)
    list_of = json.loads(json.dumps(found.unverified))
    passings = verify(list_of).passings
    for one, other, load, square in zip(found, passings, (F(1, 10), F(1, 5)), (5, 10), strict=True):
        assert F(one.load[0]) < load < F(one.load[1]) and F(one.frequency[0]) ** 2 < square < F(one.frequency[1]) ** 2
        assert other.square is not None and other.load[0] < load < other.load[1]
        assert other.square[0] < square < other.square[1] and other.change == 2
    said = verifier.verify(first)
    assert said.load is not None and said.load[0] < F(1, 10) < said.load[1]
    verifier.verify(first | {"frequency_squared": ["1/2", "15"]})  # true of a wider interval, too
    low, high = map(F, first["load"])
    for changed in ({"load": [str(low), str((low * 3 + high) / 4)]}, {"frequency_squared": ["3", "39/8"]}):
        with pytest.raises(verifier.Refused):
            verifier.verify(first | changed)
    for moved in (["1/8", "1/6"], ["1/4", "1/3"]):
        refused(list_of | {"crossings": [[c | {"load": moved} for c in of] for of in list_of["crossings"]]})


if __name__ == "__main__":  # python -m tests.certify.test_crossing_certificates 20: lists of so many random systems
    for kind in [*apart.TIES, "whirls", "tied whirls"]:
        print(kind, sum(drawn(kind, seed) for seed in range(int(sys.argv[1]))), "crossings", flush=True)


def test_between_two_loads_a_polynomial_has_the_sign_that_it_keeps_and_else_none() -> None:
    for factor in (3, -3):
        p = arb_poly([-2 * factor, factor])
        for low, high, sign in ((F(1), F(3, 2), -1), (F(1), F(3), 0), (F(2), F(3), 0), (F(5, 2), F(3), 1)):
            assert verifier_lists._sign(p, low, high) * (1 if factor > 0 else -1) == sign
