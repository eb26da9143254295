"""Certificates: accepted as they were written; refused with any field altered or left out, and where they claim more
than is so. What is refused is false or unproven; a certificate that claims less than it could is no less a proof."""

from __future__ import annotations

import copy
import json
import math
from collections.abc import Callable, Iterator
from fractions import Fraction
from functools import cache
from itertools import pairwise
from pathlib import Path
from typing import Any

import flint
import pytest
from flint import arb, arb_series

import freebeam_sym as fb
from freebeam_derive.certify import verifier

F = Fraction
Data = dict[str, Any]
Place = tuple[str | int, ...]
CASES: dict[str, tuple[str, str, int, dict[str, Any]]] = {
    "undamped": ("free-free", "legendre", 5, {}),
    "damped": ("beck", "legendre", 4, {"alpha": "0.001", "beta": "0.1"}),
    "limit": ("beck", "legendre", 3, {"kappa": 2}),
    "divergence": ("beck", "legendre", 3, {"eta": "0.25"}),
    "none": ("beck", "legendre", 3, {"alpha": "0.001", "load_max": 8}),
    "undamped, modes": ("free-free", "modes", 3, {}),
    "damped, modes": ("beck", "modes", 3, {"alpha": "0.1"}),
    "limit, modes": ("beck", "modes", 4, {"kappa": 2}),
    "one mode": ("free-free", "modes", 1, {}),
    "one mode, damped": ("euler-pinned", "legendre", 1, {"beta": 2}),
}
FLUTTER = ("undamped", "damped", "limit")


@cache
def written(case: str, digits: int = 20) -> str:
    name, basis, modes, given = CASES[case]
    return json.dumps(fb.certified_load(fb.column(name, basis), modes, digits=digits, **given).certificate)


def certificate(case: str) -> Data:
    data: Data = json.loads(written(case))
    return data


def refused(data: Data, match: str | None = None) -> None:
    with pytest.raises(verifier.Refused, match=match):
        verifier.verify(data)


def at(data: Any, place: Place) -> Any:
    for key in place:
        data = data[key]
    return data


def altered(data: Data, place: Place, value: Any) -> Data:
    """A copy with another value at a place."""
    data = copy.deepcopy(data)
    at(data, place[:-1])[place[-1]] = value
    return data


def places(data: Any, here: Place = ()) -> Iterator[Place]:
    """All places in a certificate, of numbers, words, lists and objects."""
    items = data.items() if isinstance(data, dict) else enumerate(data) if isinstance(data, list) else ()
    for key, value in items:
        yield (*here, key)
        yield from places(value, (*here, key))


def scaled(value: str, by: Fraction) -> str:
    return str(F(value) * by)


@pytest.mark.parametrize("case", CASES)
def test_a_certificate_is_accepted(case: str) -> None:
    data = certificate(case)
    proven = verifier.verify(data)
    assert {"flutter": "flutters", "divergence": "diverges", "none": "stable up to"}[data["kind"]] in proven
    assert f"{float(F((data['load'] or [data['load_max']])[0])):.10g}" in proven


# --- every field ----------------------------------------------------------------------------------------------

MORE, LESS = F(11, 10), F(9, 10)
ALTERED: dict[str, Callable[[Any], list[Any]]] = {
    "format": lambda v: [v + "0", None],
    "ends": lambda v: [["pinned", "pinned"], ["free", "clamped"], [*v, "free"], [v[0], ""]],
    "basis": lambda v: ["modes", "sines", None],
    "modes": lambda v: [v - 1, v + 1, v + 0.5, str(v), 0, -v],
    "alpha": lambda v: ["x", None],
    "beta": lambda v: ["x", None],
    "kappa": lambda v: [None] if v else ["2"],
    "damping": lambda v: [None if v else {"of_M": "1", "of_E": "1", "vanishing": False}],
    "kind": lambda v: [k for k in ("none", "flutter", "divergence", "buckling") if k != v],
    "load": lambda v: [None, [v[0], v[0]], [v[0], scaled(v[0], 1 + F(1, 10**30))], v[::-1], [v[1], scaled(v[1], MORE)],
                       [scaled(x, MORE) for x in v], [scaled(x, LESS) for x in v], [scaled(v[0], LESS), v[1]]],
    "frequency_squared": lambda v: [None, [scaled(v[0], MORE), scaled(v[1], MORE)], [v[0], scaled(v[0], LESS)],
                                    [scaled(v[0], LESS), v[0]], ["-1", v[1]]],
    "load_max": lambda v: ["1000"],
    "proof": lambda v: [None, {}, v | {"more": True}],
    "stretches": lambda v: [[], v[1:], v[:-1], v[::-1], None],
}  # fmt: skip
ALTERED_STRETCH: dict[str, Callable[[Any], list[Any]]] = {
    "start": lambda v: [scaled(v, LESS) if F(v) else "1/1000", None],
    "end": lambda v: [scaled(v, LESS), scaled(v, MORE)],
    "origin": lambda v: [None],
    "separators": lambda v: [[], v[1:], v[:-1], v[::-1], [["0", "0"], *v[1:]], [v[0], v[0], *v[2:]], [*v, v[-1]],
                             [[scaled(v[0][0], F(-1)), v[0][1]], *v[1:]], [*v[:-1], v[-2]],
                             [[v[0][0], str(F(v[0][0]) * 10)], *v[1:]]],
}  # fmt: skip


@pytest.mark.parametrize("case", FLUTTER)
def test_any_field_altered_is_refused(case: str) -> None:
    data = certificate(case)
    assert set(data) == set(ALTERED) | {"column", "parameters", "forms"}
    for field, values in ALTERED.items():
        for value in values(data[field]):
            refused(altered(data, (field,), value))
    for k, stretch in enumerate(data["stretches"]):
        assert set(stretch) == set(ALTERED_STRETCH)
        for field, values in ALTERED_STRETCH.items():
            for value in values(stretch[field]):
                refused(altered(data, ("stretches", k, field), value))
    for claim, held in data["proof"].items():
        refused(altered(data, ("proof", claim), not held))


@pytest.mark.parametrize("case", FLUTTER)
def test_any_number_of_the_column_altered_is_refused(case: str) -> None:
    """Factors, orders of derivatives, powers of x and ends of the forms; the damping's factors."""
    data = certificate(case)
    for place in places(data):
        value = at(data, place)
        if place[0] == "forms" and isinstance(value, str):
            refused(altered(data, place, scaled(value, LESS)))
        elif place[0] == "forms" and isinstance(value, int):
            refused(altered(data, place, value + 1))
        elif place[0] == "damping" and isinstance(value, str):
            refused(altered(data, place, scaled(value, 2)))
        elif place[0] == "damping" and isinstance(value, bool):
            refused(altered(data, place, not value))


@pytest.mark.parametrize("case", [*FLUTTER, "none", "one mode, damped"])
def test_any_part_left_out_is_refused(case: str) -> None:
    data = certificate(case)
    for place in places(data):
        if place[0] in ("column", "parameters"):
            continue
        left = copy.deepcopy(data)
        del at(left, place[:-1])[place[-1]]
        refused(left)


@pytest.mark.parametrize("case", FLUTTER)
def test_what_names_the_column_is_not_what_is_proven(case: str) -> None:
    data = certificate(case)
    proven = verifier.verify(data)
    named = data | {"column": "another", "parameters": {"another": "1"}}
    assert verifier.verify(named) == proven


@pytest.mark.parametrize(
    ("case", "asked"),
    [("undamped", {"alpha": "1"}), ("undamped", {"beta": "1"}), ("limit", {"alpha": "1"}), ("limit", {"beta": "1"}),
     ("damped", {"alpha": "0", "beta": "0"}), ("damped", {"alpha": "0", "beta": "0", "kappa": "100"})],
)  # fmt: skip
def test_damping_that_was_not_asked_for_is_refused(case: str, asked: Data) -> None:
    refused(certificate(case) | asked, "the damping")


@pytest.mark.parametrize("case", ["divergence", "none", "one mode, damped"])
def test_other_kinds_altered_are_refused(case: str) -> None:
    data = certificate(case)
    for field in ("format", "basis", "alpha", "beta", "kappa", "damping", "kind", "proof", "stretches"):
        for value in ALTERED[field](data[field]):
            if value != data[field]:
                refused(altered(data, (field,), value))
    refused(data | {"frequency_squared": ["1", "2"]}, "does not fit the kind")
    if data["kind"] == "none":
        refused(data | {"load": ["8", "9"]}, "does not fit the kind")
        for value in (None, "7", "9", "x"):
            refused(data | {"load_max": value})
    else:
        refused(data | {"load_max": "1000"}, "does not fit the kind")
        for value in ALTERED["load"](data["load"]):
            refused(data | {"load": value})


# --- claims made to deceive -------------------------------------------------------------------------------------


def cut(case: str) -> tuple[Data, float]:
    """A certificate whose stretches end at a load where the column is stable still, and that load."""
    data = certificate(case)
    data["stretches"] = data["stretches"][:1]
    load = F(data["stretches"][0]["end"])
    data["load"] = [str(load), str(load * (1 + F(1, 10**20)))]
    return data, float(load)


@pytest.mark.parametrize("case", ["undamped", "damped", "limit", "damped, modes"])
def test_a_stable_load_does_not_pass_for_flutter(case: str) -> None:
    """At each frequency of a stable column: something vanishes there, but nothing grows."""
    data, load = cut(case)
    name, basis, modes, given = CASES[case]
    damping = {k: float(given[k]) for k in ("alpha", "beta") if k in given}
    values = fb.spectrum(fb.column(name, basis).system(modes, load=load, **damping)).eigenvalues
    for value in values:
        square = F(abs(value.imag)) ** 2
        data["frequency_squared"] = [scaled(str(square), F(99, 100)), scaled(str(square), F(101, 100))]
        refused(data, "no eigenvalue is known to grow")


def test_a_stable_load_does_not_pass_for_divergence() -> None:
    refused(cut("divergence")[0], "det K does not change sign")


def test_a_divergence_on_the_way_does_not_pass_for_flutter() -> None:
    """Beck's column at eta = 0.4 diverges at 15.99, is stable again from 16.05 and flutters at 16.46."""
    column = fb.column("beck", "legendre")
    first = fb.certified_load(column, 6, eta="0.4", digits=10)
    growing = max(fb.spectrum(column.system(6, load=17, eta=0.4)).eigenvalues, key=lambda v: v.real)
    data: Data = json.loads(json.dumps(first.certificate))
    square = F(abs(growing.imag)) ** 2
    near = [scaled(str(square), F(99, 100)), scaled(str(square), F(101, 100))]
    assert data["kind"] == "divergence" and growing.imag != 0
    data |= {"kind": "flutter", "load": [data["load"][0], "17"], "frequency_squared": near}
    refused(data, "det K may vanish")


@pytest.mark.parametrize("case", FLUTTER)
@pytest.mark.parametrize("by", [F(1, 10**15), F(1, 10)])
def test_stability_is_not_shown_beyond_the_crossing(case: str, by: Fraction) -> None:
    data = certificate(case)
    beyond = F(data["load"][1]) * (1 + by)
    data["stretches"][-1]["end"] = str(beyond)
    data["load"] = [str(beyond), str(beyond * 2)]
    refused(data, "roots of . are not separated|do not ascend")


def test_separated_roots_of_h_alone_are_no_stability() -> None:
    """From the damped load on, below the undamped one, the roots of h are apart, but those of g not between them."""
    data, column = certificate("damped"), fb.column("beck", "legendre")
    undamped = fb.critical_load(column, 4).load
    assert undamped is not None
    ends = [F(data["load"][0]), *(F(n, 4) for n in range(72, math.floor(4 * undamped) - 2))]
    for start, end in pairwise(ends):
        values = fb.spectrum(column.system(4, load=float(start + end) / 2)).eigenvalues
        squares = sorted({round(value.imag**2, 6) for value in values})
        between = [a + (b - a) * share for a, b in pairwise(squares) for share in (0.4, 0.6)]
        separators = [[str(F(place)), "0"] for place in (*between, 2 * squares[-1])]
        stretch = {"start": str(start), "end": str(end), "origin": str(start), "separators": separators}
        data["stretches"].append(stretch)
    assert len(ends) > 3
    data |= {"kind": "none", "load": None, "frequency_squared": None, "load_max": str(ends[-1])}
    data["proof"] |= {"crossing": False, "first": False}
    refused(data, "roots of g are not separated")


# --- files ------------------------------------------------------------------------------------------------------


def test_what_is_no_certificate_is_refused_in_one_line(tmp_path: Path) -> None:
    deep = "[" * 100_000
    for content in ("", "{", "[]", "{}", '{"format": "freebeam certificate 1"}', '"text"', "null", "NaN", deep):
        path = tmp_path / "file.json"
        path.write_text(content)
        with pytest.raises(verifier.Refused) as caught:
            verifier.verify_file(path)
        assert "\n" not in str(caught.value) and str(path) in str(caught.value)
    path.write_bytes(b"\xff\xfe")
    with pytest.raises(verifier.Refused, match="is not a certificate"):
        verifier.verify_file(path)
    with pytest.raises(verifier.Refused, match="cannot be read"):
        verifier.verify_file(tmp_path / "missing.json")


# --- the modes' roots -------------------------------------------------------------------------------------------


def test_roots_that_balls_cannot_tell_apart_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    """A double root, one on the edge of two boxes, a function that may vanish near zero, a mode that is not alone."""
    two, ends = arb(2), ["free", "free"]
    functions: dict[str, Callable[[Any], Any]] = {
        "told apart": lambda g: (g - two - arb("0.03")) ** 2,
        "on the edge": lambda g: g - two,
    }
    for match, function in functions.items():
        with monkeypatch.context() as patch:
            patch.setattr(verifier, "characteristic", lambda g, _, f=function: f(arb_series([g, 1], 2)))
            with pytest.raises(verifier.Refused, match=match):
                verifier.within(two, two + arb(1) / 8, ends)
    with flint.ctx.workprec(4), pytest.raises(verifier.Refused, match="close to γ = 0"):
        verifier.roots(ends, 1)
    with monkeypatch.context() as patch:
        patch.setattr(verifier, "roots", lambda *_: [arb(5, 5)])
        with pytest.raises(verifier.Refused, match="a mode could not be computed"):
            verifier.modes(ends, 1)
