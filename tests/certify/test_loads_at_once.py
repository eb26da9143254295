"""Parts of a column that are lost at exactly one load, by loads that are known in closed form, by the load of one part
alone, and by dense eigenvalues; loads that differ by less than floats see; certificates of these forged."""

from __future__ import annotations

import copy
import itertools
import json
import sys
import tempfile
from fractions import Fraction
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from flint import fmpq, fmpq_mat, fmpq_poly
from scipy.linalg import eigvals

import freebeam as fb
from freebeam_derive.certify import (
    one_load,
    verifier,
    verifier_lists,
    verifier_loads,
    verifier_motions,
    verifier_of_matrices,
)
from freebeam_derive.certify.balls import precision
from freebeam_derive.certify.one_load import equal, obstacle, undecided, vanishing
from freebeam_derive.certify.parts import Part
from tests.stated import file_of

F = Fraction
# p and q diverge where (3 + b - P)(5 - P) = 1, r and s flutter where P (8 - P) = 14 (1 + 4 β²): at 4 - √2 both
LINKS = {
    "T": "(p.diff(t)**2 + q.diff(t)**2 + (r := Coordinate('r')).diff(t)**2 + (s := Coordinate('s')).diff(t)**2) / 2",
    "V": "((3 + b) * p**2 + 2 * p * q + 5 * q**2 + 3 * r**2 + 5 * s**2) / 2",
    "W_c": "P * (p**2 + q**2) / 2",
    "dW_nc": "P * s * delta(r) - (8 - P) * r * delta(s) / 14 - beta * (r.diff(t) * delta(r) + s.diff(t) * delta(s))",
    "ends": "()",
    "parameters": "(own(b, 0),)",
}
DAMPED = " + external - integral(beta * psi.diff(t) * delta(psi))"
TILTED = " + internal - integral(alpha * psi.diff(x, 2, t) * delta(psi.diff(x, 2)))"
MIRRORED = {  # two of Beck's columns, the second one turned round
    "T": "integral(y.diff(t) ** 2 + psi.diff(t) ** 2) / 2",
    "V": "integral(y.diff(x, 2) ** 2 + psi.diff(x, 2) ** 2) / 2",
    "W_c": "P * integral(y.diff(x) ** 2 + psi.diff(x) ** 2) / 2",
    "dW_nc": "follower + P * at(psi.diff(x), 0) * at(delta(psi), 0)" + DAMPED + TILTED,
    "ends": "{y: ('clamped', 'free'), psi: ('free', 'clamped')}",
}
ALIKE = MIRRORED | {
    "dW_nc": "follower - P * at(psi.diff(x), 1) * at(delta(psi), 1)" + DAMPED, "ends": "('clamped', 'free')"
}  # fmt: skip
REUT = ALIKE | {"dW_nc": "follower - P * at(psi, 1) * at(delta(psi).diff(x), 1)"}
"""Beck's column and Reut's, whose load keeps its line: the one's matrices are the other's, transposed."""
DISC = {  # two planes of Euler's column, a mass at the middle of one of them
    "T": "integral(y.diff(t) ** 2 + psi.diff(t) ** 2) / 2 + at(psi.diff(t), half) ** 2 / 2",
    "V": MIRRORED["V"],
    "W_c": MIRRORED["W_c"],
    "dW_nc": "0",
    "ends": "{y: ('pinned', 'pinned'), psi: ('pinned', 'pinned')}",
}
STATED = {"links": LINKS, "mirrored": MIRRORED, "alike": ALIKE, "disc": DISC}


@cache
def column(name: str) -> fb.Column:
    with tempfile.TemporaryDirectory() as folder:
        return fb.column(file_of(Path(folder), name, STATED[name]))


@cache
def links(b: str = "0") -> fb.Certified:
    return fb.certified_load(column("links"), 1, digits=12, load_max=4, b=b)


def written() -> dict[str, Any]:
    data: dict[str, Any] = json.loads(json.dumps(links().unverified))
    return data


def test_a_divergence_and_a_flutter_at_one_load_are_both_said() -> None:
    found = links()
    assert found.load is not None and all(found.proof.values())
    low, high = (4 - F(v) for v in found.load)
    assert low**2 > 2 > high**2  # 4 - √2
    assert {found.kind, *(kind for kind, _ in found.at_once)} == {"flutter", "divergence"}
    frequencies = dict([(found.kind, found.frequency), *found.at_once])
    assert frequencies["divergence"] == ("0", "0")
    slow, fast = map(F, frequencies["flutter"] or ())
    assert slow**2 < 4 < fast**2  # the mean of 3 and 5
    said = verifier.verify(written())
    (other,) = said.record()["at_once"]
    (kind, _), *_ = found.at_once
    slow, fast = F(other["frequency_lower"]), F(other["frequency_upper"])
    assert "and at exactly that load by" in str(said) and other["kind"] == kind and other["turn"] is None
    assert slow**2 < 4 < fast**2 if kind == "flutter" else slow == fast == 0
    listed = fb.certified_crossings(column("links"), 1, load_max=4, digits=12)
    assert {c.kind for c in listed[:2]} == {"flutter", "divergence"} and listed[1].unstable_above == 3
    all_of = verifier_lists.verify(json.loads(json.dumps(listed.unverified)))
    assert {p.kind for p in all_of.passings} == {"flutter", "divergence"} and "overlap" in str(all_of)
    assert {(p.unstable, p.change) for p in all_of.passings} == {(0, 3)}  # below both, and above both


@pytest.mark.parametrize(("b", "kind"), [("1e-40", "flutter"), ("-1e-40", "divergence")])
def test_loads_that_differ_in_the_fortieth_digit_are_two(b: str, kind: str) -> None:
    """d P / d b is (5 - P) / (8 - 2 P) > 0 at 4 - √2."""
    found = links(b)
    assert found.kind == kind and found.at_once == () and all(found.proof.values())
    assert found.load is not None and F(found.load[1]) - F(found.load[0]) < F(1, 10**9)
    assert verifier.verify(json.loads(json.dumps(found.unverified))).kind == kind


def test_forged_losses_at_once_are_refused() -> None:
    data = written()
    (k,) = (k for k, of in enumerate(data["beside"]) if isinstance(of, dict))
    also = data["beside"][k]

    def beside(of: Any) -> dict[str, Any]:
        return {"beside": [of if j == k else other for j, other in enumerate(data["beside"])]}

    def refused(changed: dict[str, Any], match: str | None = None) -> None:
        with pytest.raises(verifier.Refused, match=match):
            verifier.verify(data | changed)

    for unlike in ({"b": 1}, {"kind": "none"}, {"frequency_squared": ["1", "2"]}, {"stretches": []}):
        refused(beside(also | unlike))
    refused(beside(also["stretches"]), "not shown up to the load")
    refused(beside(None), "not the first again")
    refused({"parts": data["parts"][::-1]})
    refused({"kind": "none", "load": None, "frequency_squared": None, "load_max": data["load"][0]})
    for changed in ("1e-20", "-1e-30"):  # the loads differ, by less than the interval is wide
        forms = copy.deepcopy(data["forms"])
        point = next(v for v in forms["K"][0]["points"] if v[0][0] == v[1][0] == "p")
        point[2] = str(F(point[2]) + F(changed))
        refused({"forms": forms}, "not known to be one")


@pytest.mark.parametrize(
    ("name", "asked"),
    [("mirrored", {}), ("mirrored", {"alpha": "0.01", "beta": "0.1"}), ("mirrored", {"kappa": "0.1"}),
     ("alike", {"beta": "0.1"})],
)  # fmt: skip
def test_two_planes_are_lost_at_the_load_of_one_alone(name: str, asked: dict[str, str]) -> None:
    """Damped, undamped and in the limit; turned round a column has other matrices and the same load."""
    found = fb.certified_load(column(name), 2, digits=12, **asked)
    alone = fb.certified_load(fb.column("beck", "legendre"), 2, digits=12, **asked)
    assert found.load is not None and alone.load is not None and found.frequency is not None
    assert max(F(found.load[0]), F(alone.load[0])) < min(F(found.load[1]), F(alone.load[1]))
    ((kind, frequency),) = found.at_once
    assert kind == "flutter" and F(frequency[0]) < F(found.frequency[1]) and F(found.frequency[0]) < F(frequency[1])
    said = verifier.verify(json.loads(json.dumps(found.unverified)))
    assert isinstance(said, verifier.OfForms) and said.times + len(said.at_once) == 2
    listed = fb.certified_crossings(column(name), 2, load_max=float(found.load[1]) * 1.01, digits=10, **asked)
    assert listed[-1].unstable_above == 4


@pytest.mark.parametrize(("mass", "of"), [("1", MIRRORED), ("3", MIRRORED), ("1", REUT)])
def test_a_column_and_its_mirror_image_or_adjoint_are_lost_at_one_load_whatever_the_functions(
    tmp_path: Path, mass: str, of: dict[str, str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Where there are too many for resultants: they are the same in other coordinates, the second one slower where its
    mass is larger."""
    monkeypatch.setattr(one_load, "MOST_ROWS", 2)
    monkeypatch.setattr(verifier_loads, "MOST_ROWS", 2)
    stated = of | {"T": f"integral(y.diff(t) ** 2 + {mass} * psi.diff(t) ** 2) / 2"}
    found = fb.certified_load(fb.column(file_of(tmp_path, "twins", stated)), 6, digits=8)
    (_, (low, high)), (slow, fast) = found.at_once[0], found.frequency or ("", "")
    assert found.load is not None and float(found.load[0]) == pytest.approx(20.050953619, rel=1e-4)
    ratios = (F(low) / F(fast)) ** 2, (F(high) / F(slow)) ** 2
    assert ratios[0] < (F(mass) if mass == "1" else F(mass) ** (1 if F(low) > F(slow) else -1)) < ratios[1]
    said = verifier.verify(json.loads(json.dumps(found.unverified)))
    assert isinstance(said, verifier.OfForms) and said.times == 2 and not said.at_once


def test_motions_in_other_coordinates_are_told_from_others() -> None:
    """T' M T, T' K T at random, or transposed; K of the other twice as large without C, or nearly the same."""
    dice, n = np.random.default_rng(5), 5
    A, H, T = (dice.integers(-3, 4, (n, n)) for _ in range(3))
    T = np.triu(T, 1) + np.eye(n, dtype=int)
    one = np.eye(n, dtype=int), A @ A.T + np.eye(n, dtype=int), H
    cases = ((1, 0, 0, 1), (2, 0, 0, 2), (1, 1, 0, 1), (2, 1, 0, None), (1, 0, 1, None))
    for adjoint, (factor, C, changed, scale) in itertools.product((False, True), cases):
        other = [T.T @ X @ T for X in one]
        other = [X.T for X in other] if adjoint else other
        other[1][0, 0] += changed
        given = [
            [[M], [C * (E + M)], [k * E, k * X]] for (M, E, X), k in ((one, 1), (other, factor))
        ]  # fmt: skip
        parts = [
            Part((name,), *(matrices([X.tolist() for X in of]) for of in terms))
            for name, terms in zip("rs", given, strict=True)
        ]
        assert parts[0].scale(parts[1]) == scale
        theirs = [[[fmpq_mat(X.tolist()) for X in of] for of in terms] for terms in given]
        assert verifier_motions.in_other_coordinates(*theirs) == scale


def test_two_unlike_planes_with_a_root_are_refused_with_their_names(tmp_path: Path) -> None:
    """A mass at the middle of one of them: they buckle at one load, and are not the same."""
    column_of = fb.column(file_of(tmp_path, "rooted", DISC | {"V": f"sqrt(2) * ({DISC['V']})"}))
    with pytest.raises(
        fb.InputError, match=r"divergence of psi and divergence of y, at loads near 13.9.* state a column of each"
    ):
        fb.certified_crossings(column_of, 3, digits=8, load_max=20)


def test_two_planes_of_unlike_mass_buckle_at_one_load_in_closed_form_but_for_the_series() -> None:
    found = fb.certified_load(column("disc"), 3, digits=12)
    assert found.load is not None and np.pi**2 < float(found.load[0]) < 1.001 * np.pi**2
    assert (found.kind, found.at_once) == ("divergence", (("divergence", ("0", "0")),))
    verifier.verify(json.loads(json.dumps(found.unverified)))


def matrices(rows: list[list[list[int]]]) -> list[Any]:
    return [np.array([[fmpq(v) for v in row] for row in X], dtype=object) for X in rows]


@pytest.mark.parametrize(
    ("b", "kind", "load", "above"),
    [("0", "divergence", 4 - 2**0.5, [1, 3]), ("1", "flutter", 14 / 5, [2, 3])],
)
def test_damped_links_and_undamped_ones_are_proven_each_for_themselves(
    b: str, kind: str, load: float, above: list[int]
) -> None:
    """r and s are damped at a rate of 1/10, and p and q are not: a loss of either, and all losses."""
    found = fb.certified_load(column("links"), 1, beta="0.1", digits=12, load_max=4, b=b)
    assert found.load is not None and found.kind == kind and float(found.load[0]) == pytest.approx(load, rel=1e-11)
    said = verifier.verify(json.loads(json.dumps(found.unverified)))
    assert isinstance(said, verifier.OfForms) and all(found.proof.values())
    for lasting in (found.lasting, tuple("-".join(names) for names in said.lasting)):
        assert sorted(lasting) == ["p-q", "p-q"] if len(lasting) > 1 else ["p-q"]
    assert "undamped (there stable says" in str(said) and said.record()["lasting"]
    listed = fb.certified_crossings(column("links"), 1, beta="0.1", load_max=4, digits=10, b=b)
    all_of = verifier_lists.verify(json.loads(json.dumps(listed.unverified)))
    assert [c.unstable_above for c in listed] == above == [p.unstable + p.change for p in all_of.passings]


def test_in_a_limit_of_damping_undamped_links_are_lost_with_the_others() -> None:
    found = fb.certified_load(column("links"), 1, kappa="inf", digits=12, load_max=4)
    said = verifier.verify(json.loads(json.dumps(found.unverified)))
    assert isinstance(said, verifier.OfForms) and found.load is not None and found.lasting
    low, high = (4 - F(v) for v in found.load)
    assert low**2 > 2 > high**2 and {found.kind, found.at_once[0][0]} == {"flutter", "divergence"}
    assert {said.kind, said.at_once[0].kind} == {"flutter", "divergence"} and said.lasting


def test_what_is_damped_is_not_taken_for_undamped() -> None:
    """In a file r and s are damped, and p and q are not: the other way round, and with damping that makes p grow."""
    found = fb.certified_load(column("links"), 1, beta="0.1", digits=12, load_max=4, b="1")
    data = json.loads(json.dumps(found.unverified))

    def refused(changed: dict[str, Any]) -> None:
        with pytest.raises(verifier.Refused):
            verifier.verify(data | changed)

    for k, of in enumerate(data["beside"]):
        refused({"stretches": of, "beside": [data["stretches"] if j == k else v for j, v in enumerate(data["beside"])]})
    refused({"parts": data["parts"][::-1]})
    refused({"beta": "-1/10"})
    for rate in ("1/10", "-1/1000000"):
        forms = copy.deepcopy(data["forms"])
        forms["C_beta"][0]["points"].append([["p", 0, None, 0], ["p", 0, None, 0], rate])
        refused({"forms": forms})


def test_in_balls_too_an_undamped_part_may_be_beside_a_damped_one(tmp_path: Path) -> None:
    stated = LINKS | {"V": LINKS["V"].replace("5 * q**2", "sqrt(24) * q**2").replace("2 * p * q", "0")}
    found = fb.certified_load(
        fb.column(file_of(tmp_path, "rooted", stated)), 1, beta="0.1", digits=10, load_max=3, b="1"
    )
    data = json.loads(json.dumps(found.unverified))
    said = verifier.verify(data, verifier_of_matrices.FORMATS)
    assert isinstance(said, verifier_of_matrices.OfMatrices) and float(said.end) == pytest.approx(14 / 5)
    assert sorted(said.lasting) == [("p",), ("q",)] and "p and q undamped" in str(said)


@pytest.mark.parametrize(("damping", "limit"), [(0, False), (1, False), (1, True)])
def test_prover_and_verifier_eliminate_to_one_polynomial_that_vanishes_at_crossings(damping: int, limit: bool) -> None:
    dice = np.random.default_rng(3)
    A, B, D = (dice.integers(-3, 4, (3, 3)) for _ in range(3))
    M, C, K = ([np.eye(3, dtype=int) * 4 + B @ B.T], [damping * (D @ D.T + np.eye(3, dtype=int))], [A @ A.T * 3 + 9, B])
    part = Part(("y",), *(matrices([X.tolist() for X in of]) for of in (M, C, K)))
    given = [[fmpq_mat(X.tolist()) for X in of] for of in (part.M, part.C, part.K)]
    for flutter in (True, False):
        ours, theirs = vanishing(part, flutter, limit), verifier_loads._lost(given, flutter, limit)
        assert ours is not None and ours / ours.leading_coefficient() == theirs / theirs.leading_coefficient()
        assert (ours.degree() > 3) == flutter
    assert not equal([(part, True), (part, True)], limit, F(-(10**6)), F(10**6))  # many loads


def test_one_function_flutters_where_its_damping_is_nothing() -> None:
    M, C, K = matrices([[[1]]]), matrices([[[6]], [[-3]]]), matrices([[[3]]])
    found = vanishing(Part(("y",), M, C, K), True, False)
    assert found is not None and found.degree() == 1 and found(2) == 0


def test_the_polynomial_of_a_flutter_known_in_closed_form_holds_it() -> None:
    M, K = matrices([[[1, 0], [0, 1]]]), matrices([[[3, 0], [8, 5]], [[0, -1], [-1, 0]]])
    found = vanishing(Part(("r", "s"), M, [0 * M[0]], K), True, False)  # 4 = 4 P (8 - P)
    assert found is not None and found % fmpq_poly([1, -8, 1]) == 0 and found.degree() == 2


def test_parts_that_leave_each_other_alone_are_told_to_be_so_and_one_part_is_not() -> None:
    M, K = matrices([[[1]]]), matrices([[[3]], [[-1]]])
    one, other = (Part((name,), M, [], K) for name in "rs")
    for second, apart in ((other, True), (one, False)):
        text = undecided([(one, False), (second, False)], F(3) - F(1, 10**9), F(3) + F(1, 10**9))
        assert f"divergence of r and divergence of {second.names[0]}, at loads near 3.000000001 that" in text
        assert ("they leave each other alone" in text) == apart


def test_divergences_of_many_functions_are_told_to_be_at_one_load_and_flutter_is_not() -> None:
    """The least eigenvalue of a matrix of whole numbers, and of the same in other coordinates; 26 of each."""
    dice, n = np.random.default_rng(1), 26
    A, T = dice.integers(-3, 4, (n, n)), np.triu(dice.integers(-2, 3, (n, n)), 1) + np.eye(n, dtype=int)
    E, one = A @ A.T + np.eye(n, dtype=int), np.eye(n, dtype=int)
    parts = [
        Part((name,), *(matrices([X.tolist() for X in of]) for of in ([M], [], [K, -M])))
        for name, M, K in (("r", one, E), ("s", T.T @ T, T.T @ E @ T))
    ]
    least = F(float(np.linalg.eigvalsh(E.astype(float))[0]))
    low, high = least * (1 - F(1, 10**9)), least * (1 + F(1, 10**9))
    assert equal([(part, False) for part in parts], False, low, high)
    given = [([[fmpq_mat(X.tolist()) for X in of] for of in (part.M, part.C, part.K)], False) for part in parts]
    with precision(300):
        verifier_loads.check_one_load(given, False, verifier.ball(low).union(verifier.ball(high)))
        other = [[given[1][0][0], [], [given[1][0][2][0] * fmpq(10**15 + 1, 10**15), given[1][0][2][1]]], False]
        with pytest.raises(verifier.Refused, match="not known to be one"):
            verifier_loads.check_one_load(
                [given[0], tuple(other)], False, verifier.ball(low).union(verifier.ball(high))
            )
    assert not equal([(part, True) for part in parts], False, low, high)
    assert "26 functions, and up to 24 are feasible" in obstacle([(parts[0], False), (parts[1], True)])
    assert obstacle([(part, False) for part in parts]) == ""


# --- at random --------------------------------------------------------------------------------------------------------


def drawn(seed: int) -> tuple[str, str, str]:
    """Two coordinates with a random K of whole numbers, and the same turned into others, of another mass and stiffness
    matrix: T' M T, T' K T."""
    dice = np.random.default_rng(seed)
    T = dice.integers(-3, 4, (2, 2))
    while round(np.linalg.det(T)) == 0:
        T = dice.integers(-3, 4, (2, 2))
    A = dice.integers(-3, 4, (2, 2))
    E, H = A @ A.T + np.diag(dice.integers(1, 6, 2)), dice.integers(-3, 4, (2, 2))
    D = np.diag(dice.integers(1, 4, 2)) * (seed % 2)

    def form(X: Any, one: str, other: str, rate: str = "") -> str:
        names = (one, other)
        return " + ".join(
            f"({X[i, j]}) * {names[j]}{rate} * delta({names[i]})" for i in range(2) for j in range(2)
        )  # fmt: skip

    pairs = [(np.eye(2, dtype=int), E, H, D, "p", "q"), (T.T @ T, T.T @ E @ T, T.T @ H @ T, T.T @ D @ T, "r", "s")]
    mass = " + ".join(
        f"({m[0, 0]} * {a}.diff(t)**2 + {2 * m[0, 1]} * {a}.diff(t) * {b}.diff(t) + {m[1, 1]} * {b}.diff(t)**2) / 2"
        for m, *_, a, b in pairs
    )
    named = mass.replace("r.diff", "(r := Coordinate('r')).diff", 1).replace("s.diff", "(s := Coordinate('s')).diff", 1)
    work = " ".join(
        f"- ({form(e, a, b)}) - P * ({form(h, a, b)}) - ({form(d, a, b, '.diff(t)')})" for _, e, h, d, a, b in pairs
    )
    return named, "0", work


def checked(seed: int) -> str:
    T, V, work = drawn(seed)
    with tempfile.TemporaryDirectory() as folder:
        stated = LINKS | {"T": T, "V": V, "W_c": "0", "dW_nc": work, "parameters": "()"}
        drawn_column = fb.column(file_of(Path(folder), "drawn", stated))
        found = fb.certified_load(drawn_column, 1, digits=10, load_max=20)
    top = 20.0 if found.load is None else float(found.load[0])

    def growing(load: float) -> int:
        M, C, K = drawn_column.coefficients(1, False, 0.0, 0.0).at(load)
        one, none = np.eye(4), np.zeros((4, 4))
        values = eigvals(np.block([[none, one], [-K, -C]]), np.block([[one, none], [none, M]]))
        return int((values.real > 1e-4).sum())  # double where both parts have them: roots of rounding

    assert all(growing(share * top) == 0 for share in np.linspace(0.01, 0.99, 50))
    if found.load is not None:
        assert growing(top * 1.01) in (2, 4) and len(found.at_once) == 1 and found.at_once[0][0] == found.kind
    verifier.verify(json.loads(json.dumps(found.unverified)))
    return found.kind


if __name__ == "__main__":  # python -m tests.certify.test_loads_at_once 40: so many systems drawn at random
    kinds: dict[str, int] = {}
    for seed in range(int(sys.argv[1])):
        try:
            told = checked(seed)
        except fb.InputError as error:
            told = "not proven: " + str(error)[-60:]
        kinds[told] = kinds.get(told, 0) + 1
    print(kinds)
