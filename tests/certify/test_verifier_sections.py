"""What the verifier reads of a column of sections, and the matrices and roots it computes of forms and ends."""

from __future__ import annotations

from fractions import Fraction
from itertools import pairwise
from typing import Any

import flint
import numpy as np
import pytest
from flint import arb, fmpq, fmpq_poly

from freebeam_derive.certify import verifier, verifier_sections
from freebeam_derive.certify.verifier_sections import MOST_SEGMENTS, sections
from tests.certify.refusals import served

F = Fraction
ENDS = "clamped", "free"
HALVES = F(0), F(1, 2), F(1)


def forms(**more: Any) -> dict[str, Any]:
    """Of two uniform parts; more: terms along the beam by name, and at places by name and `_at`."""
    found: dict[str, Any] = {
        "M": {"along": [[n, 0, 0, 0, "2"] for n in (0, 1)], "points": []},
        "E": {"along": [[n, 0, 2, 2, "3"] for n in (0, 1)], "points": []}, "H": {"along": [], "points": []},
    }  # fmt: skip
    for name, terms in more.items():
        found[name[0]]["points" if name.endswith("_at") else "along"] += terms
    return found


def test_forms_are_read_as_a_column() -> None:
    found = sections(
        ENDS, HALVES,
        forms(
            M=[[1, 1, 0, 0, "1/2"]], M_at=[[2, 0, 2, 0, "5"], [1, 1, 1, 1, "1/4"]],
            E=[[0, 0, 1, 1, "7"], [1, 2, 0, 0, "1"]], E_at=[[1, 0, 1, 0, "11"]],
            H=[[0, 0, 0, 1, "2"], [0, 1, 0, 1, "3"]],
            H_at=[[2, 0, 2, 1, "13"], [2, 0, 2, 1, "4"], [2, 0, 0, 0, "1"]],
        ),
    )  # fmt: skip
    assert [[int(2 * c) for c in f.coeffs()] for f in found.m] == [[4], [4, 1]] and [float(f(0)) for f in found.EI] == [
        3,
        3,
    ]
    assert found.elastic == [{1: fmpq_poly([7])}, {0: fmpq_poly([0, 0, 1])}] and found.load == [
        {(0, 1): fmpq_poly([2, 3])},
        {},
    ]
    assert found.masses == {(2, 0): 5, (1, 1): F(1, 4)} and found.springs == {(1, 0): 11}
    assert found.forces == {((2, 0), (2, 1)): 17}  # the clamped end does not move


@pytest.mark.parametrize(("more", "joints", "right"), [
    ({}, [], True), ({"M": [[0, 0, 0, 1, "1"]]}, [], False), ({"M": [[0, 1, 0, 0, "-5"]]}, [], False),
    ({"E": [[1, 0, 2, 2, "-3"]]}, [], False), ({"E": [[0, 0, 0, 1, "1"]]}, [], False),
    ({"H": [[0, 0, 2, 2, "1"]]}, [], False),
    ({"H": [[0, 0, 2, 1, "1"]]}, [], False), ({"H": [[2, 0, 0, 0, "1"]]}, [], False),
    ({"H": [[0, 101, 0, 0, "1"]]}, [], False),
    ({"M_at": [[1, 0, 1, 0, "0"]]}, [], True), ({"M_at": [[1, 0, 1, 0, "-1"]]}, [], False),
    ({"M_at": [[1, 0, 1, 1, "1"]]}, [], False),
    ({"E_at": [[1, 0, 2, 0, "1"]]}, [], False), ({"E_at": [[3, 0, 3, 0, "1"]]}, [], False),
    ({"E_at": [[1, 2, 1, 2, "1"]]}, [], False),
    ({"H_at": [[1, 0, 1, 1, "1"]]}, [], True), ({"H_at": [[1, 0, 2, 0, "1"]]}, [], False),
    ({"H_at": [[2, 0, 1, 0, "1"]]}, [], False),
    ({}, [[1, 0, "1"]], True), ({}, [[1, 1, "1"]], True), ({}, [[1, 0, "1"], [1, 1, "2"]], True),
    ({}, [[1, 0, "1"], [1, 0, "1"]], False),
    ({}, [[0, 0, "1"]], False), ({}, [[2, 0, "1"]], False), ({}, [[1, 2, "1"]], False), ({}, [[1, 0, "0"]], False),
    ({}, [[1, 0, "-1"]], False), ({}, [[1, True, "1"]], False), ({}, "x", False),
    ({"M_at": [[1, 0, 1, 0, "1"]]}, [[1, 0, "1"]], False), ({"M_at": [[1, 0, 1, 0, "1"]]}, [[1, 1, "1"]], True),
    ({"E_at": [[1, 1, 1, 1, "1"]]}, [[1, 1, "1"]], False), ({"H_at": [[1, 0, 1, 1, "1"]]}, [[1, 1, "1"]], False),
    ({"H_at": [[1, 1, 1, 0, "1"]]}, [[1, 1, "1"]], False),
])  # fmt: skip
def test_what_is_no_column_of_sections_is_refused(more: Any, joints: Any, right: bool) -> None:
    assert served(lambda: sections(ENDS, HALVES, forms(**more), joints)) is right


def test_a_force_at_an_end_may_follow_the_other_end() -> None:
    for a, b, right in ((0, 2, True), (2, 0, True), (0, 1, False), (1, 2, False)):
        given = forms(H_at=[[a, 0, b, 0, "1"]])
        assert served(lambda given=given: sections(("free", "free"), HALVES, given)) is right  # type: ignore[misc]


def test_breaks_ascend_from_nothing_to_one_and_are_not_too_many() -> None:
    given: dict[str, Any] = {
        "column": "own", "parameters": {}, "modes": 5, "alpha": F(0), "beta": F(0), "kind": "none", "load": None,
        "square": None,
        "load_max": None,
    }  # fmt: skip
    most = [str(F(k, MOST_SEGMENTS)) for k in range(MOST_SEGMENTS + 1)]
    for breaks, ends, right in (
        (["0", "1"], ENDS, True), (["0", "1/2", "1"], ENDS, True), (most, ENDS, True),
        ([*most[:-1], "19/20", "1"], ENDS, False),
        (["0", "1/2"], ENDS, False), (["1/4", "1"], ENDS, False), (["0", "1", "1"], ENDS, False),
        (["0", "0", "1"], ENDS, False),
        (["0", "1/2", "1/2", "1"], ENDS, False), (["0", "3/4", "1/2", "1"], ENDS, False), (["1"], ENDS, False),
        (("0", "1"), ENDS, False), (["0", "1"], ("clamped", "held"), False), (["0", "1"], ("held", "free"), False),
    ):  # fmt: skip
        along = {name: [[n, 0, p, p, "1"] for n in range(len(breaks) - 1)] for name, p in (("M", 0), ("E", 2))}
        data = {"ends": list(ends), "breaks": breaks, "forms": {"H": {"along": [], "points": []}} | {
            name: {"along": terms, "points": []} for name, terms in along.items()
        }}  # fmt: skip
        assert served(lambda data=data: verifier_sections.stated_of(data, given)) is right  # type: ignore[misc]
    data = {"ends": [*ENDS], "breaks": ["0", "1/2", "1"], "forms": forms(), "joints": [[1, 0, "2"]]}
    stated, _ = verifier_sections.stated_of(data, given)
    assert stated.joints == ("y jumps at x = 0.5, held by a spring of 2",) and "breaks at 0.5, y jumps" in stated.forms
    stated, _ = verifier_sections.stated_of(data | {"joints": [[1, 1, "2"]]}, given)
    assert stated.joints == ("y' jumps at x = 0.5, held by a spring of 2",)


# --- matrices and roots ----------------------------------------------------------------------------------------------


def test_a_matrix_holds_integrals_of_fields_and_coordinates() -> None:
    """Of powers of ξ on each segment, (x − x₀)/h; a coordinate is one number, alone in its row."""
    space = verifier.Space((F(0), F(1, 4), F(1)), {"y": (2, set(), set())}, ("q", "r"), 3)
    f = fmpq_poly([1, 2])
    along: Any = [(1, "y", 1, "y", 2, f), (1, "q", 0, "y", 0, f), (0, "q", 0, "r", 0, fmpq_poly([3]))]
    found = space.matrix((fmpq(2), (along, [(("y", 0, F(1), 0), ("q", 0, None, 0), fmpq(5))])))
    x, weights = np.polynomial.legendre.leggauss(8)
    xi, weights = (x + 1) / 2, weights / 2
    at = 1 + 2 * (0.25 + 0.75 * xi)
    expected = np.zeros((8, 8))
    for i in range(3):
        for j in range(3):
            first = i * xi ** max(i - 1, 0) / 0.75
            second = j * (j - 1) * xi ** max(j - 2, 0) / 0.75**2
            expected[3 + i, 3 + j] += 2 * 0.75 * weights @ (at * first * second)
        expected[6, 3 + i] += 2 * 0.75 * weights @ (at * xi**i)
        expected[3 + i, 6] += 2 * 5
    expected[6, 7] += 2 * 3 * 0.25
    assert np.array([[float(F(int(v.p), int(v.q))) for v in row] for row in found.tolist()]) == pytest.approx(expected)


def test_roots_are_looked_for_from_nothing_on(monkeypatch: pytest.MonkeyPatch) -> None:
    """That there is none near zero is asked for up to where bisection begins, and from there on nothing is left out."""
    near: list[arb] = []
    whole = verifier.characteristic

    def seen(g: arb, ends: Any, terms: int = 2) -> Any:
        if terms != 2:
            near.append(g)
        return whole(g, ends, terms)

    stretches: list[tuple[float, float]] = []
    monkeypatch.setattr(verifier, "characteristic", seen)
    monkeypatch.setattr(
        verifier,
        "within",
        lambda low, high, ends: stretches.append((float(low), float(high))) or ([arb(2)] if high > 2 else []),
    )
    monkeypatch.setattr(verifier, "refined", lambda box, ends: box)
    with flint.ctx.workprec(64):
        assert len(verifier.gammas([*ENDS], 3)) == 3
    edges = sorted((float(g.mid()) - float(g.rad()), float(g.mid()) + float(g.rad())) for g in near)
    assert edges[0][0] <= 0 and all(a[1] >= b[0] for a, b in pairwise(edges))
    assert stretches[0][0] <= edges[-1][1] and stretches[0][0] == 0.5
    assert all(a[1] == b[0] for a, b in pairwise(stretches)) and len(stretches) == 6


def test_a_space_has_as_many_unknowns_as_any_that_is_written() -> None:
    field = {"joined": 2, "held": [], "opened": []}
    data = {
        "breaks": ["0", "1/2", "1"],
        "fields": {"y": field},
        "coordinates": [],
        "modes": verifier.MOST_UNKNOWNS // 2 - 2,
    }
    assert verifier._space(data).size == verifier.MOST_UNKNOWNS
    assert not served(lambda: verifier._space(data | {"coordinates": ["q"]}))
