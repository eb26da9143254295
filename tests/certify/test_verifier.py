"""Certificates: accepted as they were written; refused with any field altered or left out, and where they claim what is
not so. What is refused is false or unproven; a certificate that claims less than it could is no less a proof.

    PYTHONPATH=. python -m tests.certify.test_verifier 24

tries the forgeries of so many random questions, by seeds from 0 on.
"""

from __future__ import annotations

import copy
import json
import math
import random
import sys
from collections.abc import Callable, Iterator
from contextlib import nullcontext
from fractions import Fraction
from functools import cache
from itertools import pairwise, product
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import flint
import numpy as np
import pytest
from flint import arb, arb_mat, arb_poly, arb_series

import freebeam as fb
from freebeam_derive.certify import verifier
from freebeam_derive.certify.decimals import shown

F = Fraction
Data = dict[str, Any]
Place = tuple[str | int, ...]
CASES: dict[str, tuple[str, str, int, dict[str, Any]]] = {
    "undamped": ("free-free", "legendre", 5, {}),
    "damped": ("beck", "legendre", 4, {"alpha": "0.001", "beta": "0.1"}),
    "limit": ("beck", "legendre", 3, {"kappa": 2}),
    "external limit": ("beck", "legendre", 3, {"kappa": math.inf}),
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
    return json.dumps(fb.certified_load(fb.column(name, basis), modes, digits=digits, **given).unverified)


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
    assert proven.kind == data["kind"] and proven.ours and proven.modes == data["modes"]
    assert proven.load == (None if data["load"] is None else tuple(map(F, data["load"])))
    said = str(proven)
    named = {"flutter": "by flutter", "divergence": "det K = 0", "none": f"from 0 to {proven.end}"}
    assert named[data["kind"]] in said and f"N = {data['modes']} ({data['basis']})" in said and data["column"] in said
    assert f"{float(proven.end):.9g}"[:-1] in said
    for interval in filter(None, (proven.load, proven.frequency)):
        low, high = (F(v) for v in shown(*interval))
        assert low <= interval[0] < interval[1] <= high and high - low < 2 * (interval[1] - interval[0])
        assert all(v in said for v in shown(*interval))


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
def test_what_names_the_column_is_that_of_its_forms(case: str) -> None:
    """Of a column that is not the program's own the proof is one of the forms, and says so."""
    data = certificate(case)
    for named in ({"column": "euler-pinned"}, {"parameters": {**data["parameters"], "another": "1"}}):
        refused(data | named, "those of the column")
    for name, value in data["parameters"].items():
        refused(data | {"parameters": {name: scaled(value, 1 + F(1, 10**30))}}, "form H is not those of the column")
    for name in ("alpha", "beta", "kappa"):
        if F(data[name] or 0):
            refused(data | {name: scaled(data[name], 1 + F(1, 10**30))}, "damping is not those of the column")
    other = verifier.verify(data | {"column": "another", "parameters": {"another": "1"}})
    assert not other.ours and "the forms in this file" in str(other) and "alpha" not in str(other)
    assert other.record()["alpha"] is None is other.record()["parameters"]


@pytest.mark.parametrize(
    ("case", "asked"),
    [("undamped", {"alpha": "1"}), ("undamped", {"beta": "1"}), ("limit", {"alpha": "1"}), ("limit", {"beta": "1"}),
     ("damped", {"alpha": "0", "beta": "0"}), ("damped", {"alpha": "0", "beta": "0", "kappa": "100"})],
)  # fmt: skip
def test_damping_that_was_not_asked_for_is_refused(case: str, asked: Data) -> None:
    refused(certificate(case) | asked, "the damping")


def test_external_damping_that_vanishes_leaves_the_crossing_where_it_is_without_any() -> None:
    """Two frequencies meet there; of any other C, or of none, that is not shown."""
    data = certificate("external limit")
    said, without = verifier.verify(data), fb.certified_load(fb.column("beck", "legendre"), 3, digits=20).load
    assert without is not None and said.load is not None and said.record()["kappa"] == "inf"
    assert F(without[0]) < said.load[1] and said.load[0] < F(without[1])
    data |= {"column": "another"}
    for of_M, of_E in (("0", "0"), ("-1", "0"), ("1", "-1"), ("1", "1"), ("1", "1/1000000")):
        damping = {"of_M": of_M, "of_E": of_E, "vanishing": True}
        refused(data | {"damping": damping}, None if of_E[0] == "1" else "no damping is there to vanish")
    refused(data | {"damping": {"of_M": "1", "of_E": "0", "vanishing": False}}, "does not fit kappa")
    for kappa in ("Infinity", "-inf", "1e9", None):
        refused(data | {"kappa": kappa, "column": "beck"})


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
    """At each frequency of a stable column: something vanishes there, but nothing crosses."""
    data, load = cut(case)
    name, basis, modes, given = CASES[case]
    damping = {k: float(given[k]) for k in ("alpha", "beta") if k in given}
    values = fb.spectrum(fb.column(name, basis).system(modes, load=load, **damping)).eigenvalues
    for value in values:
        square = F(abs(value.imag)) ** 2
        data["frequency_squared"] = [scaled(str(square), F(99, 100)), scaled(str(square), F(101, 100))]
        refused(data, "crossing|root of g|crosses" if square else "not positive")


def test_a_stable_load_does_not_pass_for_divergence() -> None:
    refused(cut("divergence")[0], "det K does not (fall|change sign)")


def test_a_divergence_on_the_way_does_not_pass_for_flutter() -> None:
    """Beck's column at eta = 0.4 diverges at 15.99, is stable again from 16.05 and flutters at 16.46."""
    column = fb.column("beck", "legendre")
    first = fb.certified_load(column, 6, eta="0.4", digits=10)
    growing = max(fb.spectrum(column.system(6, load=17, eta=0.4)).eigenvalues, key=lambda v: v.real)
    data: Data = json.loads(json.dumps(first.unverified))
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


@pytest.mark.parametrize("modes", [2, 3])
def test_a_root_of_g_beyond_all_of_h_is_no_stability(modes: int) -> None:
    """Damping that feeds the highest mode and brakes the others, all but without load: only g's last root is astray."""
    data = json.loads(json.dumps(fb.certified_load(fb.column("free-free"), modes, "0.001", load_max=1).unverified))
    squares = sorted({round(v.imag**2, 9) for v in fb.spectrum(fb.column("free-free").system(modes)).eigenvalues})
    # factors d = of_M + of_E ω²: positive but for the last, which is −1/100 of the first
    slope = -F(101, 100) / (F(squares[-1]) - F(squares[0]))
    of_M, of_E = 1 - slope * F(squares[0]), slope
    damping = [float(of_M) + float(of_E) * square for square in squares]
    assert all(d > 0 for d in damping[:-1]) and damping[-1] < 0
    g = sum(
        d * np.poly([other for other in squares if other != square]) for d, square in zip(damping, squares, strict=True)
    )
    roots = sorted(np.roots(g).real)
    assert roots[-1] > squares[-1] and all(a < r < b for r, a, b in zip(roots, squares, squares[1:-1], strict=False))
    separators = []
    for k, (a, b) in enumerate(pairwise(squares)):
        place = roots[k] if k < modes - 2 else (a + b) / 2
        separators += [[str(F((a + place) / 2)), "0"], [str(F((place + b) / 2)), "0"]]
    separators.append([str(F(2 * squares[-1])), "0"])
    stretch = {"start": "0", "end": "1/1000000", "origin": "0", "separators": separators}
    data |= {"column": "of someone else", "load_max": "1/1000000", "stretches": [stretch]}
    data["damping"] |= {"of_M": str(of_M), "of_E": str(of_E)}
    refused(data, "roots of g are not separated")
    # with the last factor positive as well, the same lines prove stability
    data["damping"] |= {"of_M": "1", "of_E": "0"}
    for k in range(modes - 1):
        middle = F(sorted(np.roots(sum(np.poly([o for o in squares if o != s]) for s in squares)).real)[k])
        low, high = F(squares[k]), F(squares[k + 1])
        separators[2 * k : 2 * k + 2] = [[str((low + middle) / 2), "0"], [str((middle + high) / 2), "0"]]
    verifier.verify(data)


# --- forgeries that mean something ------------------------------------------------------------------------------
# Whole certificates with a false statement, of random columns, bases and damping. The forger knows the column: he takes
# the loads at which it crosses and its eigenvalues from elsewhere, and fits every field to his claim that he can.


def drawn(seed: int) -> tuple[Data, list[Any], fb.Column, int, dict[str, Any]]:
    """A true certificate, all crossings up to three times its load, and its question."""
    draw = random.Random(seed)
    name = draw.choice(["beck", "beck", "beck", "free-free", "euler-pinned"])
    column = fb.column(name, draw.choice(["legendre", "legendre", "legendre", "modes"]))
    given: dict[str, Any] = {"eta": F(draw.randrange(0, 150), 100)} if name == "beck" else {}
    damping = draw.choice(["none", "finite", "finite", "limit"])
    if damping == "finite":
        given |= {"alpha": F(draw.randrange(1, 1000), 10 ** draw.randrange(3, 6)), "beta": F(draw.randrange(0, 9), 10)}
    if damping == "limit":
        given["kappa"] = F(draw.randrange(0, 30), 10)
    modes = draw.randrange(2, 5)
    found = fb.certified_load(column, modes, digits=12, load_max=300, **given)
    top = 3 * F(found.load[1]) if found.load else F(300)
    crossings = list(fb.certified_crossings(column, modes, digits=12, load_max=top, **given)) if found.load else []
    return json.loads(json.dumps(found.unverified)), crossings, column, modes, given


def about(value: float) -> list[str]:
    return [str(F(value) * F(999, 1000)), str(F(value) * F(1001, 1000))]


def reaching(data: Data, low: Fraction) -> Data:
    """The last stretch ends at a load."""
    last = data["stretches"][-1] | {"end": str(low)}
    return data | {"stretches": [*data["stretches"][:-1], last]}


# a list of forgeries, each with its own condition
def forged(data: Data, crossings: list[Any], column: fb.Column, modes: int, given: dict[str, Any]) -> Iterator[Data]:  # noqa: C901
    """Certificates with a false statement."""
    kind, N = data["kind"], data["modes"]
    low, high = map(F, data["load"] or 2 * [data["load_max"]])
    own = {name: float(value) for name, value in given.items() if name != "kappa"}
    crosses = {"crossing": True, "first": True, "stable_below": True, "kind": True}
    flutter, divergence = {"kind": "flutter"}, {"kind": "divergence", "frequency_squared": None}

    def squares(load: Fraction) -> list[float]:
        values = fb.spectrum(column.system(modes, load=float(load), **own)).eigenvalues
        return sorted({round(abs(value.imag) ** 2, 6) for value in values if value.imag}) or [1.0]

    # another column, number of functions, basis, parameter
    yield data | {"column": "euler-pinned" if data["column"] != "euler-pinned" else "beck"}
    yield data | {"basis": "modes" if data["basis"] == "legendre" else "legendre"}
    for more in (-1, 1):
        stretches = []
        for s in data["stretches"]:
            last = F(s["separators"][-1][0])
            count = abs(more) * (2 if data["damping"] else 1)
            added = [[str(last * (k + 2)), "0"] for k in range(count)]
            stretches.append(s | {"separators": s["separators"] + added if more > 0 else s["separators"][:-count]})
        other = fb.certified_load(column, N + more, digits=12, load_max=300, **given)
        if other.kind != kind or (other.load and (F(other.load[0]) > high or F(other.load[1]) < low)):
            yield data | {"modes": N + more, "stretches": stretches}
    for share in (F(1, 10**6), F(1, 10)):
        for name, value in data["parameters"].items():
            moved = F(value) * (1 + share) or share
            yield data | {"parameters": {name: str(moved)}}
            kernel = column.kernel.forms(F(1), **{name: moved})
            points = [[int(a), p, int(b), q, str(F(v))] for (a, p, b, q), v in kernel["H"][1].items()]
            H = data["forms"]["H"] | {"points": points}
            if kind != "none":
                yield data | {"parameters": {name: str(moved)}, "forms": data["forms"] | {"H": H}}
                yield data | {"column": "another", "forms": data["forms"] | {"H": H}}
    # damping
    for name, factor in (("alpha", "of_E"), ("beta", "of_M"), ("kappa", "of_M")):
        if data[name] is None:
            continue
        moved = "1000" if data[name] == "inf" else str(F(data[name]) * F(1001, 1000) or F(1, 1000))
        yield data | {name: moved}
        if data["damping"]:
            yield data | {"damping": data["damping"] | {factor: moved}}
            if kind == "flutter" and (name != "beta" or data["kappa"] is None):
                yield data | {name: moved, "damping": data["damping"] | {factor: moved}}
    if data["damping"] and kind == "flutter":
        of_M, of_E = (F(data["damping"][k]) for k in ("of_M", "of_E"))
        finite = {"kappa": None, "alpha": "1/1000", "beta": str(of_M / of_E / 1000)}
        limit = {"kappa": str(of_M / of_E), "alpha": "0", "beta": "0"}
        factors = {"of_E": finite["alpha"], "of_M": finite["beta"], "vanishing": False}
        if data["damping"]["vanishing"]:
            yield data | finite | {"damping": factors}
        else:
            yield data | limit | {"damping": {"of_E": "1", "of_M": limit["kappa"], "vanishing": True}}
        yield data | {"damping": None, "alpha": "0", "beta": "0", "kappa": None}
    if kind == "none":
        later = fb.certified_load(column, modes, digits=9, load_max=3000, **given).load
        if later:
            yield reaching(data, F(later[1])) | {"load_max": later[1]}
            yield data | {"kind": "flutter", "load": [str(low), later[1]], "load_max": None, "proof": crosses,
                          "frequency_squared": about(squares(low)[0])}  # fmt: skip
        yield data | divergence | {"load": [str(low), str(2 * low)], "load_max": None, "proof": crosses}
        return

    # stability beyond the crossing, or up to a later one
    for load in (high, high * F(11, 10), *(F(c.load[0]) for c in crossings[1:])):
        none = {"crossing": False, "first": False, "stable_below": True, "kind": True}
        yield reaching(data, load) | divergence | {"kind": "none", "load": None, "load_max": str(load), "proof": none}
    # another kind, another crossing, another branch's frequency, and intervals that hold two of them
    edges = [high, *(F(c.load[1]) * (1 + F(1, 10**9)) for c in crossings), high * F(101, 100), 3 * high]
    for edge in dict.fromkeys(edge for edge in edges if edge >= high):
        wide = {"load": [str(low), str(edge)]}
        if kind == "flutter":
            yield data | wide | divergence
        if sum(F(c.load[1]) <= edge for c in crossings) > 1:
            true = data["frequency_squared"] or about(squares(low)[0])
            yield data | wide
            yield data | wide | {"frequency_squared": [str(F(true[0]) / 4), str(F(true[1]) * 4)], **flutter}
        for square in squares(low) + squares(edge):
            here = data["frequency_squared"]
            interval = about(square)
            if kind == "divergence" or not F(interval[0]) < (F(here[0]) + F(here[1])) / 2 < F(interval[1]):
                yield data | wide | flutter | {"frequency_squared": interval}
    for c in crossings[1:]:
        later = {"load": [str(F(c.load[0]) * (1 - F(1, 10**9))), str(F(c.load[1]) * (1 + F(1, 10**9)))]}
        square = about(float(c.frequency[1]) ** 2) if c.kind == "flutter" else None
        claim = data | later | {"kind": c.kind, "frequency_squared": square}
        yield claim
        yield reaching(claim, F(later["load"][0]))


# without two of the modes of a beam, which take longer than the others together; they are in the command above
@pytest.mark.parametrize("seed", [seed for seed in range(24) if seed not in (11, 21)])
def test_forgeries_are_refused_and_true_certificates_accepted(seed: int) -> None:
    case = drawn(seed)
    data, _, column, modes, given = case
    proven = verifier.verify(data)
    near = fb.critical_load(column, modes, **{name: float(value) for name, value in given.items()}, load_max=300.0)
    assert proven.kind == near.kind
    if proven.load is not None and near.load is not None and near.frequency is not None:
        assert math.isclose(float(proven.load[0]), near.load, rel_tol=1e-8)
        if proven.frequency is not None:
            assert math.isclose(float(proven.frequency[0]), near.frequency, rel_tol=1e-6)
    count = 0
    for forgery in forged(*case):
        refused(forgery)
        count += 1
    assert count >= 8


def made(h: list[Any], g: list[Any] | None = None) -> verifier.Series:
    """A series of polynomials made by hand, over the powers of x, each over those of P; without damping, g None."""
    series = object.__new__(verifier.Series)
    series.h = [arb_poly(p) for p in h]
    series.system = verifier.System([], [], [], False)
    series.N, series.damped, series.odd = len(h) - 1, g is not None, False
    series.g = verifier.by_x(series.h) if g is None else [arb_poly(p) for p in g]
    return series


def times(*factors: list[Any]) -> list[Any]:
    """Products of polynomials in x over polynomials in P."""
    total = [arb_poly([1])]
    for factor in factors:
        pairs = [(i, j) for i in range(len(total)) for j in range(len(factor))]
        total = [
            sum((total[i] * arb_poly(factor[j]) for i, j in pairs if i + j == k), arb_poly([0]))
            for k in range(len(total) + len(factor) - 1)
        ]
    return total


LOW, HIGH, BOX = F(999, 1000), F(1001, 1000), (F(19, 20), F(21, 20))
RISING = [[0, 1], [-1]]  # P − x: root x = P
FIXED = [[1], [-1]]  # 1 − x


@pytest.mark.parametrize("beside", [F(1), F(10001, 10000), F(9, 8)])
def test_another_crossing_within_the_loads_is_told_from_none(beside: Fraction) -> None:
    """h and g meet at P = 1, x = 1, and at another x too, at the same load, within the interval, or beyond it."""
    for place in (F(5), F(1, 5), F(70), F(13, 10)):
        P, x = verifier.ball(beside), verifier.ball(place)
        moving = [[x - P, 1], [-1]]  # x − P₀ + P − x: through the place at that load
        still = [[x], [-1]]
        good = made(times(RISING, [[x + 1], [-1]]), times(FIXED, still))
        good.check_crossing(LOW, HIGH, BOX)
        bad = made(times(RISING, moving), times(FIXED, still))
        if LOW < beside < HIGH:
            with pytest.raises(verifier.Refused, match=r"another crossing|may hold more than one"):
                bad.check_crossing(LOW, HIGH, BOX)
        else:
            bad.check_crossing(LOW, HIGH, BOX)


def test_a_root_of_det_K_within_the_loads_is_told() -> None:
    """x = P − P₀ falls through zero, where g is not zero: a divergence beside the flutter."""
    for load, seen in ((F(10001, 10000), True), (F(1, 2), False)):
        through = [[-verifier.ball(load), 1], [1]]  # P − P₀ + x
        series = made(times(RISING, through), times(FIXED, [[1], [1]]))
        if seen:
            with pytest.raises(verifier.Refused, match="det K may vanish"):
                series.check_crossing(LOW, HIGH, BOX)
        else:
            series.check_crossing(LOW, HIGH, BOX)


def test_a_divergence_beside_flutter_is_told() -> None:
    """det K falls through zero at P = 1; h and g meet at x = 5 at that load, or do not. Two or three roots of det K."""
    falling = [[1, -1], [1]]  # 1 − P + x
    made(times(falling, [[5], [-1]]), times([[4], [-1]], [[3], [1]])).check_crossing(LOW, HIGH, None)
    both = made(times(falling, [[4, 1], [-1]]), times([[5], [-1]], [[3], [1]]))
    with pytest.raises(verifier.Refused, match="another crossing"):
        both.check_crossing(LOW, HIGH, None)
    touching = made([*times([[1, -1]], [[verifier.ball(F(10001, 10000)), -1]])], [[1]])
    with pytest.raises(verifier.Refused, match="det K does not"):
        touching.check_crossing(LOW, HIGH, None)
    cubic = made(times([[1, -1]], [[verifier.ball(F(9999, 10000)), -1]], [[verifier.ball(F(10001, 10000)), -1]]), [[1]])
    with pytest.raises(verifier.Refused, match="det K does not fall"):
        cubic.check_crossing(LOW, HIGH, None)


def test_a_touch_in_the_box_is_no_crossing() -> None:
    """h and g meet and part again (a double root of φ), or three times, or never: none is one crossing."""
    P = arb_poly([-1, 1])
    small = arb_poly([verifier.ball(F(1, 10**8))])
    for bend in (P * P, P**3, P * (P * P - small), 10**6 * small):
        series = made([arb_poly([1]) + bend, [-1]], [[1], [-1]])  # x = 1 + bend against x = 1
        with pytest.raises(verifier.Refused, match=r"crossing is not known to be simple|nothing is known to cross"):
            series.check_crossing(LOW, HIGH, BOX)
    undamped = made([arb_poly([1]) + P * P, [-2], [1]])  # (x − 1)² + (P − 1)²: frequencies that meet only at P = 1
    with pytest.raises(verifier.Refused, match="not known to be simple"):
        undamped.check_crossing(LOW, HIGH, BOX)
    made([arb_poly([1]) + P, [-2], [1]]).check_crossing(LOW, HIGH, BOX)  # (x − 1)² + P − 1: two that meet and part


def test_a_frequency_that_is_not_the_crossings_is_told() -> None:
    """h and g meet at x = 1; the interval holds a root of neither, of g alone, or of both at one end of the loads."""
    series = made(times(RISING, [[6], [-1]]), times(FIXED, [[5], [-1]]))
    for square in ((F(2), F(3)), (F(9, 2), F(11, 2)), (F(1), F(2)), (F(1, 2), F(99, 100))):
        with pytest.raises(verifier.Refused, match=r"root of g|another crossing|nothing is known"):
            series.check_crossing(LOW, HIGH, square)


@pytest.mark.parametrize(("given", "high"), [({"eta": "0.55"}, "86.7806"), ({"eta": "0.7", "alpha": "1e-3"}, "102")])
def test_flutter_does_not_pass_for_divergence(given: Data, high: str) -> None:
    """det K is negative at the far end of a wide interval, but it is by flutter that stability is lost."""
    column = fb.column("beck", "modes")
    found = fb.certified_load(column, 3, **given)
    data: Data = json.loads(json.dumps(found.unverified))
    assert data["kind"] == "flutter"
    crossings = fb.certified_crossings(column, 3, load_max=high, **given)
    assert sum(c.kind == "divergence" for c in crossings) % 2 == 1
    refused(data | {"kind": "divergence", "frequency_squared": None, "load": [data["load"][0], high]}, "det K")


# --- files ------------------------------------------------------------------------------------------------------


def test_files_that_would_use_up_time_or_memory_are_not_begun(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Refused on reading, before a matrix is computed; each number that is checked is short by then."""
    monkeypatch.setattr(verifier, "matrices", lambda *_: pytest.fail("a matrix was computed"))
    data, path = certificate("damped"), tmp_path / "file.json"
    along = data["forms"]["M"]["along"][0]
    forms: list[Any] = [[*along[:1], -1, *along[2:]], [-1, *along[1:]], [10**8, *along[1:]], [0, 4, 0, "1"]]
    forms += [[0, 0, 0, 1], [False, 0, 0, "1"], [0, 0, 0], "1234"]
    hostile: list[Data] = [altered(data, ("forms", "M", "along", 0), value) for value in forms]
    hostile += [altered(data, ("forms", "M", "along"), along_) for along_ in ([along] * 1000, {}, None, [along, along])]
    hostile += [altered(data, ("forms", "H", "points", 0, k), v) for k in range(4) for v in (-1, 5, "0", 0.5, None)]
    numbers = ["1e999999999", "9" * 200_000, "1/0", "nan", "inf", "1e", "1e99999", "0x10", "", " 1", "-1", "\n", 5, 1.5]
    for field in ("alpha", "beta", "kappa"):
        hostile += [data | {field: value} for value in [*numbers, None if field != "kappa" else True, [], {}]]
    for k in range(2):
        for field in ("load", "frequency_squared"):
            hostile += [altered(data, (field, k), value) for value in [*numbers, None]]
    for name in ("start", "end", "origin"):
        hostile += [altered(data, ("stretches", 0, name), value) for value in [*numbers[:-4], *numbers[-2:]]]
    hostile += [data | {"modes": value} for value in (10**6, 10**8, 201, True, 4.0, "4", None, [4])]
    hostile += [data | {"ends": value} for value in ("free", ["free"], [["free"], "free"], [{}, {}], None)]
    hostile += [data | {"column": value} for value in (5, None, "x" * 300, "a\nb", {})]
    hostile += [data | {"parameters": value} for value in ([], None, {"eta": 1}, {"": "1"}, {"eta": "1", "x": "1"})]
    hostile += [data | {"basis": value} for value in ([], {}, None, 1)] + [data | {"kind": []}, data | {"more": 1}]
    hostile += [data | {"stretches": value} for value in ({}, "x", [1], [[]], [{}], data["stretches"] * 50)]
    for case in hostile:
        path.write_text(json.dumps(case))
        with pytest.raises(verifier.Refused) as caught:
            verifier.verify_file(path)
        assert "\n" not in str(caught.value) and len(str(caught.value)) < 500, case
    text = json.dumps(data)
    texts = [text[:-1] + ', "kind": "flutter"}', text.replace('"vanishing": false', '"vanishing": false, "of_M": "0"')]
    counts = "4" * 5000, "NaN", "1e400", "Infinity", "-0"
    texts += [text.replace('"modes": 4', f'"modes": {value}') for value in counts]
    texts += ['{"a":' * 50_000, "[" * 1_999_999, "[" * 10**6 + "]" * 10**6]
    texts += ["[" + "[]," * 600_000 + "1]", " " * 2_000_001]
    for content in texts:
        assert content != text
        path.write_text(content)
        with pytest.raises(verifier.Refused) as caught:
            verifier.verify_file(path)
        assert "\n" not in str(caught.value) and len(str(caught.value)) < 500
    path.write_text(text)
    with pytest.raises(pytest.fail.Exception):
        verifier.verify_file(path)


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
        verifier.gammas(ends, 1)
    with monkeypatch.context() as patch:
        patch.setattr(verifier, "gammas", lambda *_: [arb(5, 5)])
        with pytest.raises(verifier.Refused, match="a mode could not be computed"):
            verifier.modes(ends, 1)


# --- parts ------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("ends", [list(pair) for pair in product(verifier.ORDERS, repeat=2)], ids="-".join)
def test_modes_meet_their_conditions_and_are_orthogonal(ends: list[str]) -> None:
    with flint.ctx.workprec(200):
        value, integral = verifier.modes(ends, 3)
        for n in range(3):
            size = sum(abs(value(n, d, x)) for d in range(4) for x in range(2))
            assert size.is_finite() and size > 0
            for x, kind in enumerate(ends):
                assert all(abs(value(n, d, x)) < 1e-30 * size for d in verifier.ORDERS[kind])
            assert integral(0, (n, 0), (n, 0)) > 0
            assert all(abs(integral(0, (n, 0), (m, 0))) < 1e-30 * integral(0, (n, 0), (n, 0)) for m in range(n))


@pytest.mark.parametrize("modes", [201, 10**6, 0, -1, True, 4.0, "4", None])
def test_a_number_of_functions_is_bounded_before_anything_hangs_on_it(modes: Any) -> None:
    refused(certificate("damped") | {"modes": modes}, "the number of functions is not from 1 to 200")


@pytest.mark.parametrize(
    ("along", "points"),
    [([[0, 4, 0, "1"]], []), ([[0, 0, 4, "1"]], []), ([[101, 0, 0, "1"]], []), ([[-1, 0, 0, "1"]], []),
     ([], [[2, 0, 0, 0, "1"]]), ([], [[0, 4, 0, 0, "1"]]), ([], [[0, 0, 2, 0, "1"]]), ([], [[0, 0, 0, 4, "1"]]),
     ([[True, 0, 0, "1"]], [])],
)  # fmt: skip
def test_a_form_of_other_powers_orders_or_ends_is_refused(along: list[Any], points: list[Any]) -> None:
    """Energies have derivatives up to the third; of another column too, of which nothing else is known."""
    data = certificate("damped") | {"column": "another"}
    for name in "MEH":
        held = data["forms"][name]
        refused(altered(data, ("forms", name), {"along": held["along"] + along, "points": held["points"] + points}),
                "no such power, order or end")  # fmt: skip


@pytest.mark.parametrize(("leading", "told"), [([-1, 1], "det M may vanish"), ([1, 1], "")])
def test_a_mass_that_vanishes_within_the_interval_is_refused(leading: list[int], told: str) -> None:
    """h = (1 − P) + (leading) x and g = 1: det K changes sign at P = 1, and there det M does too, or does not."""
    series: Any = object.__new__(verifier.Series)
    series.system = verifier.System([], [], [], False)
    series.h, series.g, series.odd, series.damped = [arb_poly([1, -1]), arb_poly(leading)], [arb_poly([1])], False, True
    interval = Fraction(99, 100), Fraction(101, 100)
    if not told:
        assert verifier.Series.check_crossing(series, *interval, None) == 1
        return
    with pytest.raises(verifier.Refused, match=told):
        verifier.Series.check_crossing(series, *interval, None)


@pytest.mark.parametrize(("power", "told"), [(1, ""), (3, "not known to be simple and alone")])
def test_a_crossing_without_a_speed_is_refused(power: int, told: str) -> None:
    """g = x − P, and h = (P − 1)^power + P − x is (P − 1)^power along its root: of the third power it changes sign, but
    how many cross there is not told."""
    series: Any = object.__new__(verifier.Series)
    series.system = verifier.System([], [], [], False)
    series.h = [arb_poly([-1, 1]) ** power + arb_poly([0, 1]), arb_poly([-1])]
    series.g, series.odd, series.damped = [arb_poly([0, -1]), arb_poly([1])], False, True
    loads, square = (Fraction(99, 100), Fraction(101, 100)), (Fraction(98, 100), Fraction(102, 100))
    if not told:
        assert verifier.Series.check_crossing(series, *loads, square) == -2  # h_P g_x − h_x g_P is 1
        return
    with pytest.raises(verifier.Refused, match=told):
        verifier.Series.check_crossing(series, *loads, square)


@pytest.mark.parametrize("N", [1, 2, 3, 5])
def test_each_root_of_g_is_to_be_between_two_of_h(N: int) -> None:
    """h has the roots 2, 4, …, 2N, g 3, 5, …, 2N − 1: one that is elsewhere is refused, whichever it is."""

    def product_of(roots: list[float]) -> list[arb_poly]:
        factors = np.array([1.0])
        for root in roots:
            factors = np.convolve(factors, [root, -1.0])
        return [arb_poly([float(v)]) for v in factors]

    series: Any = object.__new__(verifier.Series)
    series.N, series.of_g, series.resting, series.damped, series.touching = N, N - 1, 0, True, False
    series.h, between = product_of([2.0 * k for k in range(1, N + 1)]), [2.0 * k + 1 for k in range(1, N)]
    lines = tuple((F(k, 2), F(0)) for k in ([2, *(4 * j + s for j in range(1, N) for s in (1, 3)), 4 * N + 1]))
    stretch = verifier.Stretch(F(0), F(1), F(1), lines)
    series.g = product_of(between)
    series.check_stable(stretch)
    for k in range(N - 1):
        for elsewhere in (1.5, between[k] - 2, between[k] + 2, 2 * N + 1.0):
            series.g = product_of([*between[:k], elsewhere, *between[k + 1 :]])
            with pytest.raises(verifier.Refused, match="the roots of g are not separated"):
                series.check_stable(stretch)


@pytest.mark.parametrize("scale", [1, 100])
def test_places_that_do_not_separate_the_roots_of_h_without_load_are_refused(scale: int) -> None:
    """ω² of 1/10 and of 3/10, in any unit: between 0 and 1/20 there is none."""
    one, K = arb_mat([[1, 0], [0, 1]]), arb_mat([[arb(scale) / 10, 0], [0, arb(3 * scale) / 10]])
    for middle, told in ((F(1, 5), False), (F(1, 20), True)):
        system = verifier.System([one], [], [K, -one], False)
        with pytest.raises(verifier.Refused, match="not separated without load") if told else nullcontext():
            verifier.Series(system, F(scale, 20), [F(0), scale * middle, scale * F(2, 5)])


def test_a_mass_that_vanishes_beside_damping_that_does_not_is_refused() -> None:
    """(m − P) ẍ + ẋ + (1 − P) x = 0 diverges at P = 1; its mass is nothing at P = 1, or at 2."""
    one = arb_mat([[1]])
    for m, told in ((1, "det M may vanish"), (2, None)):
        series = verifier.Series(verifier.System([m * one, -one], [one], [one, -one], False), F(3, 4), [F(0), F(2)])
        if told is None:
            series.check_crossing(F(9, 10), F(11, 10), None)
            continue
        with pytest.raises(verifier.Refused, match=told):
            series.check_crossing(F(9, 10), F(11, 10), None)


def main(count: int) -> None:
    for seed in range(count):
        test_forgeries_are_refused_and_true_certificates_accepted(seed)
        print(f"{seed}: as it should be", flush=True)


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))


@pytest.mark.parametrize(("M", "C", "K", "vanishing", "sign"), [
    (-3, 0, 2, False, -1), (-3, 2, 2, False, 1), (-3, 2, 2, True, -1), (3, -4, 2, False, 1), (3, -6, 2, False, -1)
])  # fmt: skip
def test_the_sign_of_the_determinant_is_that_at_one_without_load(
    M: int, C: int, K: int, vanishing: bool, sign: int
) -> None:
    """M + C + K as they are, for λ = 1; without C in the limit, and what grows with the load left out."""
    of = [[arb_mat([[v]]), arb_mat([[99]])] for v in (M, C, K)]
    them: Any = object.__new__(verifier.Series)
    them.system = SimpleNamespace(known=True, vanishing=vanishing, M=of[0], C=of[1], K=of[2])
    assert them.sign == sign
