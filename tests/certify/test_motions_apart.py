"""Frequencies that pass through one another below a proven first loss: what all matrices leave to itself, two planes
that whirl, and parts that are the same. Held against dense eigenvalues, of columns in floats and of systems drawn at
random with 200 bits; certificates of these are forged."""

from __future__ import annotations

import copy
import itertools
import json
import sys
import tempfile
from dataclasses import replace
from fractions import Fraction
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from flint import acb, acb_mat, arb, arb_mat, ctx, fmpq, fmpq_mat
from scipy.linalg import eigvals

import freebeam as fb
from freebeam_derive.certify import (
    all_crossings,
    certificate,
    commutant,
    first_crossing,
    verifier,
    verifier_lists,
    verifier_motions,
    verifier_of_matrices,
    verifier_parts,
)
from freebeam_derive.certify.balls import Unproven, precision
from freebeam_derive.certify.boundary_polynomials import Question, _of_any
from freebeam_derive.certify.parts import Part, split
from tests.stated import file_of

F = Fraction
Data = dict[str, Any]
PLANES = {
    "T": "integral(y.diff(t) ** 2 + psi.diff(t) ** 2) / 2",
    "V": "integral(y.diff(x, 2) ** 2 + psi.diff(x, 2) ** 2) / 2",
    "W_c": "P * integral(y.diff(x) ** 2 + psi.diff(x) ** 2) / 2",
    "dW_nc": "follower - P * at(psi.diff(x), 1) * at(delta(psi), 1)",
}
TILTED = "at(y.diff(x, t), half) ** 2 + at(psi.diff(x, t), half) ** 2"
WHIRLS = (
    " - c * at(psi.diff(x, t), half) * at(delta(y).diff(x), half)"
    " + c * at(y.diff(x, t), half) * at(delta(psi).diff(x), half)"
)


def planes(names: str, tied: str, spring: str) -> dict[str, str]:
    """Equal planes with springs of some sign between the tips of neighbours, without the follower force."""
    field = {name: f"({name} := Field('{name}'))" for name in names.split() if name != "y"}
    first = " + ".join(f"integral({field.get(name, name)}.diff(t) ** 2)" for name in names.split())
    tie = " + ".join(f"(at({pair[0]}, 1) - at({pair[1]}, 1)) ** 2" for pair in tied.split())
    return {
        "T": f"({first}) / 2",
        "V": f"({' + '.join(f'integral({name}.diff(x, 2) ** 2)' for name in names.split())} {spring} * ({tie})) / 2",
        "W_c": f"P * ({' + '.join(f'integral({name}.diff(x) ** 2)' for name in names.split())}) / 2",
        "dW_nc": "0",
    }


SPINS = {
    "T": f"{PLANES['T']} + ({TILTED}) / 40", "dW_nc": PLANES["dW_nc"] + WHIRLS, "parameters": "(own(c, 0.02),)",
}  # fmt: skip


def shafts(spins: tuple[int, int]) -> dict[str, str]:
    """Two shafts in follower loads, of the planes y, u and v, w, with discs that spin at the tips, tied there."""
    names = "y u v w".split()
    field = {name: f"({name} := Field('{name}'))" for name in names if name != "y"}

    def all_of(term: str) -> str:
        return " + ".join(term.format(name) for name in names)

    first = " + ".join(f"integral({field.get(name, name)}.diff(t) ** 2)" for name in names)
    whirls = "".join(
        f" + {spin} * c * (at({a}.diff(x, t), 1) * at(delta({b}).diff(x), 1)"
        f" - at({b}.diff(x, t), 1) * at(delta({a}).diff(x), 1))"
        for spin, a, b in zip(spins, "yv", "uw", strict=True)
    )
    return {
        "T": f"({first} + ({all_of('at({}.diff(x, t), 1) ** 2')}) / 25) / 2",
        "V": f"({all_of('integral({}.diff(x, 2) ** 2)')}"
        " + 5 * (at(y, 1) - at(v, 1)) ** 2 + 5 * (at(u, 1) - at(w, 1)) ** 2) / 2",
        "W_c": f"P * ({all_of('integral({}.diff(x) ** 2)')}) / 2",
        "dW_nc": "-P * (" + all_of("at({0}.diff(x), 1) * at(delta({0}), 1)") + ")" + whirls,
        "parameters": "(own(c, 0.1),)",
    }


PINNED = "{y: ('pinned', 'pinned'), psi: ('pinned', 'pinned')}"
COLUMNS: dict[str, tuple[dict[str, str], int, int, int]] = {  # changes, N, parts, those lost at once
    "two planes": (PLANES, 3, 2, 2),
    "two planes, one heavy": (PLANES | {"T": "integral(y.diff(t) ** 2 + 4 * psi.diff(t) ** 2) / 2"}, 3, 2, 2),
    "two planes and a spring between": (
        PLANES | {"V": PLANES["V"] + " + k * (at(y, 1) - at(psi, 1)) ** 2 / 2", "parameters": "(own(k, 5.0),)"},
        3, 2, 1,
    ),
    "a disc that spins": (PLANES | SPINS, 2, 1, 1),
    "a disc where it does not tilt": (PLANES | SPINS | {"dW_nc": "0" + WHIRLS, "ends": PINNED}, 3, 3, 2),
    "four planes in a row": (planes("y u v w", "yu uv vw", "- half"), 2, 4, 1),
    "three planes in a ring": (planes("y u v", "yu uv vy", "- half"), 2, 3, 2),
    "two shafts at unlike speeds": (shafts((1, 2)), 2, 1, 1),
    "two shafts that counter-rotate": (shafts((1, -1)), 2, 2, 2),
    "a spring at mid-span": (
        {"dW_nc": "0", "V": "V + k * at(y, half) ** 2 / 2", "ends": '("pinned", "pinned")',
         "parameters": "(own(k, 600.0),)"},
        3, 3, 1,
    ),
}  # fmt: skip


@cache
def column(name: str) -> fb.Column:
    with tempfile.TemporaryDirectory() as folder:
        return fb.column(file_of(Path(folder), name, COLUMNS[name][0]))


@cache
def proven(name: str) -> fb.Certified:
    return fb.certified_load(column(name), COLUMNS[name][1], digits=12)


def written(name: str) -> Data:
    data: Data = json.loads(json.dumps(proven(name).unverified))
    return data


def rates(name: str, load: float) -> Any:
    """All eigenvalues λ, in floats."""
    M, C, K = column(name).coefficients(COLUMNS[name][1], False, 0.0, 0.0).at(load)
    one, none = np.eye(len(K)), 0 * K
    return eigvals(np.block([[none, one], [-K, -C]]), np.block([[one, none], [none, M]]))


@pytest.mark.parametrize("name", COLUMNS)
def test_frequencies_pass_and_the_first_loss_is_that_of_a_dense_scan(name: str) -> None:
    found, said = proven(name), verifier.verify(written(name))
    assert found.load is not None and found.frequency is not None and isinstance(said, verifier.OfForms)
    load = float(found.load[0])
    for share in np.linspace(0, 0.9999, 200):
        values = rates(name, share * load)
        assert values.real.max() < 1e-5 * abs(values).max()  # the root of rounding, where frequencies are one
    above = rates(name, 1.001 * load)
    assert above.real.max() > 1e-3
    if found.kind == "flutter":
        assert abs(above[above.real.argmax()].imag) == pytest.approx(float(found.frequency[0]), rel=1e-2)
    assert (len(said.parts), said.times) == COLUMNS[name][2:] and said.load is not None
    assert said.record()["times"] == said.times and ("of them the same" in str(said)) == (said.times > 1)
    assert said.whirls == (name in ("a disc that spins", "two shafts at unlike speeds"))
    assert ("of one of these meet" in str(said)) == (len(said.parts) > 1 and not said.whirls)
    if said.frequency is not None:
        assert float(said.frequency[0]) == pytest.approx(float(found.frequency[0]), rel=1e-9)


def test_two_planes_are_lost_where_one_is_and_a_spring_between_them_leaves_their_sum_alone() -> None:
    """All at the load of a plane alone, Beck's of as many polynomials."""
    alone = fb.certified_load(fb.column("beck", "legendre"), 3, digits=12).load
    assert alone is not None
    for name in ("two planes", "two planes and a spring between"):
        load = proven(name).load
        assert load is not None and max(F(load[0]), F(alone[0])) < min(F(load[1]), F(alone[1]))


def test_two_planes_of_other_mass_are_lost_at_one_load_with_other_frequencies() -> None:
    """The second is 4 times as heavy, and half as fast."""
    name = "two planes, one heavy"
    load, other = proven(name).load, proven("two planes").load
    assert load is not None and other is not None and max(F(load[0]), F(other[0])) < min(F(load[1]), F(other[1]))
    said = verifier.verify(written(name))
    assert isinstance(said, verifier.OfForms) and "unit of time" in str(said)
    assert said.times == 2 and set(said.scales) in ({1, 4}, {1, F(1, 4)})
    found = fb.certified_crossings(column(name), 3, load_max=21, digits=10)
    assert [(c.unstable_below, c.unstable_above) for c in found] == [(0, 2), (2, 4)]
    slow, fast = (float(c.frequency[0]) for c in found)
    assert fast == pytest.approx(2 * slow, rel=1e-9)
    stated = verifier_lists.verify(json.loads(json.dumps(found.unverified))).record()["crossings"]
    assert [float(c["frequency_lower"]) for c in stated] == pytest.approx([slow, fast], rel=1e-9)
    data = written(name)
    for letter, k in (("M", 0), ("K", 0), ("K", 1)):
        for n, term in enumerate(data["forms"][letter][k]["along"]):
            unlike = copy.deepcopy(data)
            unlike["forms"][letter][k]["along"][n][5] = [str(-F(term[5][0]))]
            refused(unlike)
            unlike["forms"][letter][k]["along"][n][5] = ["1", "1/1000000"]
            refused(unlike)
    limp = copy.deepcopy(data)
    for form in limp["forms"]["K"]:
        form["along"] = [term for term in form["along"] if term[1] != "psi"]
        form["points"] = [term for term in form["points"] if term[0][0] != "psi"]
    refused(limp, "not the first again")


def test_a_shaft_buckles_in_both_planes_where_its_disc_does_not_tilt() -> None:
    """Even about the disc no rates act: a divergence at Euler's load, π² but for the series, of both planes at once."""
    found = proven("a disc where it does not tilt")
    assert found.kind == "divergence" and found.load is not None and found.frequency == ("0", "0")
    assert np.pi**2 < float(found.load[0]) < np.pi**2 * 1.0002
    floats = fb.critical_load(column("a disc where it does not tilt"), 3)
    assert floats.kind == "divergence" and floats.load == pytest.approx(float(found.load[0]), rel=1e-12)
    listed = fb.certified_crossings(column("a disc where it does not tilt"), 3, load_max=20, digits=10)
    assert [(c.kind, c.unstable_above) for c in listed] == [("divergence", 2)]


def test_in_a_disc_that_spins_forward_and_backward_whirl_pass_each_other() -> None:
    """What no proof of all in one determinant takes: at some load a forward and a backward frequency are one."""
    name = "a disc that spins"
    load = float((proven(name).load or ("0",))[0])
    orders = set()
    for share in np.linspace(0, 0.999, 300):
        M, C, K = column(name).coefficients(2, False, 0.0, 0.0).at(share * load)
        n = len(M) // 2
        m, b, k = M[:n, :n], C[:n, n:], K[:n, :n]
        omega = eigvals(np.block([[k, -b], [0 * k, np.eye(n)]]), np.block([[0 * k, m], [np.eye(n), 0 * k]])).real
        orders.add(tuple(np.sign(omega[np.argsort(abs(omega))])))
    assert len(orders) > 1


def test_points_that_move_with_frequencies_that_stay_close_need_fewer_stretches(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    name = "two shafts at unlike speeds"
    stretches = written(name)["stretches"]
    assert any(F(slope) for of in stretches[:-1] for _, slope in of["separators"])
    monkeypatch.setattr(first_crossing, "_moving", lambda found, P, roots, at_rest: at_rest)
    still = fb.certified_load(column(name), COLUMNS[name][1], digits=12)
    assert len(still.unverified["stretches"]) > len(stretches)


# --- forgeries ----------------------------------------------------------------------------------------------------


def refused(data: Data, match: str | None = None) -> None:
    with pytest.raises(verifier.Refused, match=match):
        verifier.verify(data)


def test_forged_motions_are_refused() -> None:
    data = written("two planes and a spring between")
    one, other = data["parts"]
    assert one["names"] == other["names"] == ["y", "psi"] and {one["motion"], other["motion"]} == {0, 1}
    for parts in ([other, one], [one, one], [one], [one, other, other], [one, other | {"motion": 2}]):
        refused(data | {"parts": parts})
    refused(data | {"parts": [one], "beside": []})
    refused(data | {"parts": [one, other | {"names": ["psi"]}]})
    refused(data | {"beside": [None]}, "not the first again")
    refused(data | {"beside": [data["stretches"]]})
    short = data["beside"][0][-1] | {"end": data["load"][0]}
    refused(data | {"beside": [[*data["beside"][0][:-1], short]]}, "not shown up to the load")
    for letter, power in (("M", 0), ("K", 0), ("K", 1)):  # of one plane alone: the sum is not left to itself
        for n, term in enumerate(data["forms"][letter][power]["along"]):
            unlike = copy.deepcopy(data)
            unlike["forms"][letter][power]["along"][n][5] = [str(F(term[5][0]) * F(1000001, 1000000))]
            refused(unlike, "not all of the motions|do not leave each other alone")
    stiffer = copy.deepcopy(data)  # of both alike, by more than the interval of loads
    for term in stiffer["forms"]["K"][0]["along"]:
        term[5] = [str(F(term[5][0]) * F(1001, 1000))]
    refused(stiffer)
    damped = copy.deepcopy(data)
    damped["forms"]["C_1"] = [{"along": [[0, name, 0, name, 0, ["1"]] for name in ("y", "psi")], "points": []}]
    refused(damped)


def test_parts_that_only_roots_tell_apart_are_not_taken_for_one_another() -> None:
    """Four planes in a row are lost in one motion alone, of √2; three in a ring in two at once, not in the third."""
    row, ring = written("four planes in a row"), written("three planes in a ring")
    assert [of is None for of in row["beside"]] == [False] * 3 and sorted(of is None for of in ring["beside"]) == [
        False,
        True,
    ]
    for data in (row, ring):
        first, *others = data["parts"]
        for k, of in enumerate(data["beside"]):
            if of is None:
                continue
            without = [None if n == k else lines for n, lines in enumerate(data["beside"])]
            refused(data | {"beside": without}, "not the first again")
            swapped = [others[k], *(first if n == k else part for n, part in enumerate(others))]
            refused(data | {"parts": swapped})
            refused(data | {"parts": swapped, "stretches": of, "beside": without})
            refused(data | {"parts": [first, *others[:k], first, *others[k + 1 :]]}, "not all of the motions")
    again = [data["stretches"] if of is None else of for of in ring["beside"]]
    refused(ring | {"beside": again}, "not shown up to the load")
    for name, data in (("u", row), ("v", ring)):  # a plane unlike the others: two motions are then one
        unlike = copy.deepcopy(data)
        term = next(term for term in unlike["forms"]["K"][0]["along"] if term[1] == name)
        term[5] = [str(F(term[5][0]) * F(1000001, 1000000))]
        refused(unlike, "not all of the motions")


def test_a_part_that_is_not_the_first_again_needs_stretches_of_its_own() -> None:
    data = written("two planes")
    assert data["beside"] == [None]
    for factor in ("1000001/1000000", "9/10", "2"):
        unlike = copy.deepcopy(data)
        for term in unlike["forms"]["K"][0]["along"]:
            if term[1] == "psi":
                term[5] = [str(F(term[5][0]) * F(factor))]
        refused(unlike, "not the first again")
    refused(data | {"beside": []})
    refused(data | {"beside": [None, None]})


def test_forged_whirls_are_refused() -> None:
    data = written("a disc that spins")
    frame = data["parts"][0]["frame"]
    turn = F(frame["turn"])
    for other in (None, *(frame | {"turn": str(v)} for v in (turn / 1024, turn + 1, -turn, 0))):
        refused(data | {"parts": [data["parts"][0] | {"frame": other}]})
    refused(data | {"parts": [data["parts"][0] | {"frame": frame | {"planes": [["y"], ["y"]]}}]})
    refused(data | {"frequency_squared": [str(2 * turn - F(v)) for v in data["frequency_squared"][::-1]]})
    refused(data | {"kind": "divergence", "frequency_squared": None})
    for letter, power, kind in (("M", 0, "along"), ("K", 0, "along"), ("K", 1, "points"), ("C_1", 0, "points")):
        terms = data["forms"][letter][power][kind]
        unlike = copy.deepcopy(data)
        last = terms[0][5] if kind == "along" else [terms[0][2]]
        unlike["forms"][letter][power][kind][0][-1] = (
            [str(F(last[0]) * F(999999, 1000000))] if kind == "along" else str(F(last[0]) * F(999999, 1000000))
        )
        refused(unlike, "two planes are not")


# --- matrices drawn at random ---------------------------------------------------------------------------------------

Terms = tuple[list[Any], list[Any], list[Any]]
ONE, TURN, TIED = [[1, 0], [0, 1]], [[0, 1], [-1, 0]], [[1, -1], [-1, 1]]
TIES = {  # of equal motions
    "tied": TIED,
    "four in a row": [[1, -1, 0, 0], [-1, 2, -1, 0], [0, -1, 2, -1], [0, 0, -1, 1]],
    "three in a ring": [[2, -1, -1], [-1, 2, -1], [-1, -1, 2]],
    "five in a ring": [[2 * (i == j) - ((i - j) % 5 in (1, 4)) for j in range(5)] for i in range(5)],
}


def drawn(seed: int, kind: str) -> tuple[Terms, list[str]]:
    """M, C, K by powers of the load of systems with a symmetry, some in coordinates that hide it, with names."""
    dice = np.random.default_rng(seed)
    m = 1 + seed % 2

    def matrix() -> Any:
        return np.array([[fmpq(int(v)) for v in row] for row in dice.integers(-3, 4, (m, m))])

    def positive() -> Any:
        half = matrix()
        return half @ half.T + 2 * np.array([[fmpq(int(i == j)) for j in range(m)] for i in range(m)])

    def of(pattern: Any, X: Any) -> Any:
        return np.kron(np.array([[fmpq(v) for v in row] for row in pattern]), X)

    mass, stiff, load, tie, B = positive(), 3 * positive(), matrix(), positive(), matrix()
    M, C, K = [of(ONE, mass)], [of(TURN, B + B.T)], [of(ONE, stiff), of(ONE, load)]
    names = [name for name in ("a", "b") for _ in range(m)]
    if kind in TIES:
        ties = TIES[kind]
        M, K = ([of(np.eye(len(ties), dtype=int).tolist(), X) for X in terms] for terms in ([mass], [stiff, load]))
        K[0], K[1], C = K[0] + of(ties, tie), K[1] + of(ties, (seed % 3 - 1) * matrix()), [0 * M[0]]
        names = [name for name in "abcde"[: len(ties)] for _ in range(m)]
        for _ in range(4 * (seed % 3)):
            T = np.array([[fmpq(int(i == j)) for j in range(len(names))] for i in range(len(names))])
            i, j = dice.permutation(len(names))[:2]
            T[i, j] = fmpq(int(dice.integers(-2, 3)))
            M, C, K = ([T.T @ X @ T for X in terms] for terms in (M, C, K))
    if kind == "tied whirls":
        M, C, K = ([of(ONE, X) for X in terms] for terms in (M, C, K))
        K[0] = K[0] + of(TIED, of(ONE, tie))
        names = [name for name in ("a", "b", "c", "d") for _ in range(m)]
    return (M, C, K), names


def at(terms: Terms, P: fmpq, rate: fmpq) -> Any:
    """K + λ C + λ² M, exactly."""
    return sum(X * P**k * rate**p for of, p in zip(terms, (2, 1, 0), strict=True) for k, X in enumerate(of))


def determinant(X: Any) -> arb:
    """Of fractions or balls."""
    return arb_mat([[arb(v) for v in row] for row in X.tolist()]).det()


def growths(terms: Terms, P: Fraction) -> list[float]:
    """All Re λ, from the exact characteristic polynomial by its factors, with 200 bits."""
    load, n = fmpq(P.numerator, P.denominator), len(terms[0][0])
    M, C, K = (sum((X * load**k for k, X in enumerate(of)), 0 * of[0]) for of in terms)
    inverse = fmpq_mat(M.tolist()).inv()
    lower = [np.array((inverse * fmpq_mat((-X).tolist())).tolist()) for X in (K, C)]
    one = np.array([[fmpq(int(i == j)) for j in range(n)] for i in range(n)])
    whole = fmpq_mat(np.block([[0 * one, one], lower]).tolist()).charpoly()
    with ctx.workprec(200):
        return [float(z.real.mid()) for f, power in whole.factor()[1] for z, _ in f.numer().complex_roots() * power]


def growth(terms: Terms, P: Fraction) -> float:
    """The largest Re λ."""
    return max(growths(terms, P))


def first_float(terms: Terms, top: int) -> tuple[float, float] | None:
    """The first load at which something grows, and its frequency, in floats."""
    M, C, K = ([X.astype(float) for X in of] for of in terms)

    def of_load(P: float) -> Any:
        m, c, k = (sum(P**j * X for j, X in enumerate(X)) for X in (M, C, K))
        inverse, one = np.linalg.inv(m), np.eye(len(m))
        return np.linalg.eigvals(np.block([[0 * one, one], [-inverse @ k, -inverse @ c]]))

    low = 0.0
    for high in np.linspace(0, top, 801)[1:]:
        if of_load(high).real.max() > 1e-4:
            for _ in range(50):
                middle = (low + high) / 2
                low, high = (low, middle) if of_load(middle).real.max() > 1e-6 else (middle, high)
            values = of_load(high)
            omega = abs(values[values.real.argmax()].imag)
            return float(high), float(omega) if omega > 1e-3 else 0.0
        low = high
    return None


def first(terms: Terms, names: list[str], near: tuple[float, float] | None, top: int) -> first_crossing.Enclosure:
    bits = first_crossing.bits_for(len(names), 12)
    for rest, times in ((True, 1), (True, 2), (False, 1)):
        try:
            with precision(bits * times):
                parts = split(*terms, names, None, False, rest)
                found = [replace(_of_any(p.M, p.C, p.K, False, p.known), part=p) for p in parts]
                return first_crossing.certify_parts(found, Question(1), near, 12, bits * times, F(top))
        except Unproven as error:
            reason = error
    raise reason


@pytest.mark.parametrize("kind", [*TIES, "whirls", "tied whirls"])
@pytest.mark.parametrize("seed", range(4))
def test_what_is_proven_of_random_systems_is_so_at_200_bits(seed: int, kind: str) -> None:
    terms, names = drawn(seed, kind)
    top = 12
    found = first(terms, names, first_float(terms, top), top)
    low = found.load[0] if found.load else F(top)
    for k in range(12):
        assert growth(terms, round(low * 1000 * k / 12) / F(1000)) < 1e-40
    assert growth(terms, low * F(999999, 1000000)) < 1e-40
    if found.load:
        assert growth(terms, found.load[1] * F(1000001, 1000000)) > 1e-9
    assert len(found.parts) >= (len(TIES.get(kind, ONE)) if kind != "whirls" else 1) or not terms[1][0].any()


def listed(terms: Terms, names: list[str], top: int) -> list[all_crossings.Crossing]:
    bits = 2 * first_crossing.bits_for(len(names), 12)
    with precision(bits):
        for rest in (True, None):
            of = split(*terms, names, None, False, rest)
            parts = [replace(_of_any(p.M, p.C, p.K, False, p.known), part=p) for p in of]
            if all(all_crossings.turns_fast(part, F(top)) for part in parts):
                break
        found = all_crossings._merged(parts, F(top), lambda _: None)
        return all_crossings._refined(parts, found, parts, 12, bits)


@pytest.mark.parametrize("kind", [*TIES, "whirls", "tied whirls"])
def test_between_all_crossings_as_many_eigenvalues_are_unstable_as_is_said(kind: str) -> None:
    """At 200 bits; of parts that are the same, two planes that whirl, and frequencies that pass through one another."""
    assert sum(counted(seed, kind) for seed in (1, 4, 5))


def counted(seed: int, kind: str) -> int:
    """How many crossings are listed, with the eigenvalues between counted."""
    terms, names = drawn(seed, kind)
    found = listed(terms, names, 12)
    edges = [F(0), *(v for c in found for v in c.load), F(12)]
    between = [c.unstable for c in found] + [sum(c.change for c in found)]
    for low, high, unstable in zip(edges[::2], edges[1::2], between, strict=True):
        for share in (F(1, 100), F(1, 2), F(99, 100)):
            assert sum(value > 1e-30 for value in growths(terms, low + share * (high - low))) == unstable
    return len(found)


def test_lists_of_crossings_begin_with_the_proven_first_loss() -> None:
    """Of what the disc couples two by two, forward and backward whirl pass each other below."""
    for name in ("two planes and a spring between", "a disc that spins", "three planes in a ring"):
        load, times = proven(name).load, COLUMNS[name][3]
        found = fb.certified_crossings(column(name), COLUMNS[name][1], load_max=30, digits=10)
        assert load is not None and F(found[0].load[0]) < F(load[1]) and F(load[0]) < F(found[0].load[1])
        assert found[0].stability == "lost" and len(found) > 1
        for one, following in itertools.pairwise(found):
            middle = (F(one.load[1]) + F(following.load[0])) / 2
            values = rates(name, float(middle))
            assert (values.real > 1e-4 * abs(values).max()).sum() == one.unstable_above == following.unstable_below
        assert found[0].unstable_above == (times if found[0].kind == "divergence" else 2 * times)
        said = verifier_lists.verify(json.loads(json.dumps(found.unverified)))
        for one in found:
            (same,) = {(p.unstable, p.unstable + p.change) for p in said.passings if p.load[0] < F(one.load[1]) and
                       F(one.load[0]) < p.load[1]}  # fmt: skip
            assert same == (one.unstable_below, one.unstable_above)


def certificate_of(terms: Terms, found: first_crossing.Enclosure) -> Data:
    """That of a column of coordinates alone, one a row."""
    names = [f"q{i}" for i in range(len(terms[0][0]))]

    def forms(powers: list[Any]) -> list[Data]:
        return [
            {"along": [], "points": [
                [[names[i], 0, None, 0], [names[j], 0, None, 0], str(v)] for (i, j), v in np.ndenumerate(X) if v != 0
            ]} for X in powers
        ]  # fmt: skip

    M, C, K = map(forms, terms)
    return {
        "format": certificate.GENERAL, "column": "drawn", "parameters": {}, "modes": 1, "alpha": "0", "beta": "0",
        "breaks": ["0", "1"], "fields": {}, "coordinates": names, "rigid": [], "kappa": None,
        "forms": {"M": M, "C_1": C, "C_alpha": [], "C_beta": [], "K": K}, **certificate.claimed(found),
    }  # fmt: skip


@pytest.mark.parametrize("kind", [*TIES, "whirls", "tied whirls"])
def test_certificates_of_random_systems_are_accepted_and_with_another_entry_refused_or_true(kind: str) -> None:
    for seed in range(3 if len(TIES.get(kind, ())) < 4 else 2):
        forged(seed, kind)


def forged(seed: int, kind: str) -> None:
    dice = np.random.default_rng(seed + 7)
    terms, _ = drawn(seed, kind)
    found = first(terms, [f"q{i}" for i in range(len(terms[0][0]))], first_float(terms, 12), 12)
    data = certificate_of(terms, found)
    said = verifier.verify(data)
    assert said.load == found.load and said.end == (found.load or (F(12),))[0]
    for letter, k, of in (("M", 0, 0), ("K", 0, 2), ("K", 1, 2), ("C_1", 0, 1)):
        points = data["forms"][letter][k]["points"]
        if not points:
            continue
        n = int(dice.integers(len(points)))
        unlike, other = copy.deepcopy(data), copy.deepcopy(terms)
        (row, *_), (column_, *_), value = points[n]
        changed = F(value) * F(int(dice.integers(800, 1200)), 1000)
        unlike["forms"][letter][k]["points"][n][2] = str(changed)
        other[of][k][int(row[1:]), int(column_[1:])] = fmpq(changed.numerator, changed.denominator)
        try:
            end = verifier.verify(unlike).end
        except verifier.Refused:
            continue
        assert all(growth(other, end * F(share, 10)) < 1e-40 for share in range(10))


@pytest.mark.parametrize("kind", TIES)
@pytest.mark.parametrize("seed", range(3))
def test_the_parts_of_prover_and_verifier_have_the_determinant_of_all_in_one_order(seed: int, kind: str) -> None:
    """In fractions, and in balls where roots tell them apart; which are the same is told by both."""
    terms, names = drawn(seed, kind)
    given = [[fmpq_mat(X.tolist()) for X in of] for of in terms]
    with precision(300):
        ours = split(*terms, ["q"] * len(names), None, False, False)
        theirs = verifier_motions.motions(given, False)
        assert len(ours) == len(theirs) == len(TIES[kind])
        classes = [[[one.kind for one in of].index(each.kind) for each in of] for of in (ours, theirs)]  # type: ignore[attr-defined]
        assert classes[0] == classes[1] and len(set(classes[0])) == (len(TIES[kind]) + ("ring" in kind)) // (
            1 + ("ring" in kind)
        )
        quotients: list[list[arb]] = [[] for _ in range(len(ours) + 1)]
        for P, rate in ((fmpq(1, 3), fmpq(2, 7)), (fmpq(-2), fmpq(5)), (fmpq(4, 9), fmpq(-1, 2))):
            whole = arb(1)
            for k, (one, other) in enumerate(zip(ours, theirs, strict=True)):
                M, _, K = other.matrices()
                value = determinant(at((one.M, one.C, one.K), P, rate))
                again = sum((P**j * X for j, X in enumerate(K)), rate * rate * M[0]).det()
                quotients[k].append(value / again)
                whole *= value
            quotients[-1].append(whole / determinant(at(terms, P, rate)))
        assert all(of[0].rel_accuracy_bits() > 60 and all(of[0].overlaps(q) for q in of) for of in quotients)


@pytest.mark.parametrize("seed", range(4))
def test_of_full_matrices_nothing_commutes_and_of_tied_ones_as_much_as_the_symmetry_says(seed: int) -> None:
    """Sums of powers of the ties alone, where these are symmetric; of a ring its turns and reflections, 4 a double one
    of its frequencies and 1 for the other."""
    for kind, count in (("tied", 2), ("four in a row", 4), ("three in a ring", 5), ("five in a ring", 9)):
        (M, _, K), _ = drawn(seed, kind)
        G, *each = (fmpq_mat(X.tolist()) for X in (M[0] + K[0], *M, *K))
        if len(M[0]) // len(TIES[kind]) > 1:
            assert len(commutant.commuting(G, each)) == count - 1
            assert len(verifier_motions.commuting([G.inv() * X for X in each])) == count - 1
    dice = np.random.default_rng(seed)
    G, *each = (fmpq_mat([[fmpq(int(v), 7) for v in row] for row in dice.integers(-9, 10, (5, 5))]) for _ in range(3))
    assert not commutant.commuting(G, each) and not verifier_motions.commuting([G.inv() * X for X in each])


def tops(count: int) -> tuple[Terms, list[str]]:
    """Tops of rate 3 in a row, the first tied to the ground: K = (3 - P) 1 + L, L without eigenvalues in fractions."""
    L = np.diag([2] * (count - 1) + [1]) - np.eye(count, k=1, dtype=int) - np.eye(count, k=-1, dtype=int)
    one, none = np.eye(count, dtype=int), np.zeros((count, count), dtype=int)

    def both(A: Any, B: Any = none) -> Any:
        return np.array([[fmpq(int(v)) for v in row] for row in np.block([[A, B], [-B, A]])], dtype=object)

    names = [f"q{k}" for k in range(2 * count)]
    return ([both(one)], [both(none, 3 * one)], [both(3 * one + L), both(-one)]), names


@pytest.mark.parametrize("count", [2, 4])
def test_tops_that_only_roots_tell_apart_whirl_each_by_itself(count: int) -> None:
    """ω² ± 3ω - (3 + r - P) = 0 with the roots r of L, r = 2 - 2 cos((2k - 1) π / (2n + 1)): the lowest is lost at
    P = 3 + r + 9/4, at ω = 3/2. Its frequency passes zero below."""
    terms, names = tops(count)
    r = 2 - 2 * np.cos(np.pi / (2 * count + 1))
    load = 3 + r + 9 / 4
    found = first(terms, names, (load, 1.5), 12)
    assert found.load is not None and float(found.load[0]) == pytest.approx(load, rel=1e-11)
    assert found.frequency is not None and float(found.frequency[0]) == pytest.approx(1.5, rel=1e-9)
    assert len(found.parts) == count and all(part.before and part.whirls for part in found.parts)
    data = certificate_of(terms, found)
    said = verifier.verify(data)
    assert isinstance(said, verifier.OfForms) and said.whirls and len(said.parts) == count
    frame = data["parts"][0]["frame"]
    for other in (
        {k: v for k, v in frame.items() if k != "before"}, frame | {"before": False}, frame | {"before": 1},
        frame | {"turn": str(F(frame["turn"]) + 1)}, frame | {"planes": frame["planes"][::-1]}, None,
    ):  # fmt: skip
        refused(data | {"parts": [data["parts"][0] | {"frame": other}, *data["parts"][1:]]})
    refused(data | {"parts": [*data["parts"][1:], data["parts"][0]]})


@pytest.mark.parametrize("turn", [fmpq(3, 2), fmpq(7)])
def test_of_two_planes_that_whirl_the_determinant_is_one_s_at_both_senses(turn: fmpq) -> None:
    """det(K − ω² M + iωC) = p(ω) p(−ω), p(ω) = det(A − (turn + ω) B) of the matrices A and B as seen from the frame."""
    terms, _ = drawn(3, "whirls")
    given = [[fmpq_mat(X.tolist()) for X in of] for of in terms]
    (B, _, A), whirls = verifier_parts.seen(given, [[0, 1], [2, 3]], turn)
    assert whirls
    P = fmpq(2, 5)
    for omega in (fmpq(1), fmpq(-3, 4), fmpq(6)):
        p = [
            (A[0] + P * A[1] - (turn + side * omega) * (B[0] + P * (0 * B[0] if len(B) < 2 else B[1]))).det()
            for side in (1, -1)
        ]
        M, C, K = (sum((X * P**k for k, X in enumerate(of)), 0 * of[0]) for of in given)
        whole = (acb_mat(K - omega * omega * M) + acb(0, omega) * acb_mat(C)).det()
        assert abs(whole - p[0] * p[1]) < 1e-8 * abs(whole)


def turning(*planes: tuple[Any, Any, Any, int]) -> Terms:
    """Pairs of planes alike, each as in a frame that turns at a rate: M, E and H of one of two."""
    blocks: list[list[Any]] = [[], [], [], []]
    for M, E, H, rate in planes:
        for of, one, other in zip(
            blocks, (M, 0 * M, E - rate**2 * M, H), (0 * M, 2 * rate * M, 0 * M, 0 * M), strict=True
        ):
            of.append(np.block([[one, -other], [other, one]]))

    def beside(parts: list[Any]) -> Any:
        n = [0, *itertools.accumulate(map(len, parts))]
        whole = np.full((n[-1], n[-1]), fmpq(0))
        for k, X in enumerate(parts):
            whole[n[k] : n[k + 1], n[k] : n[k + 1]] = [[fmpq(int(v)) for v in row] for row in X]
        return whole

    M, C, K, H = map(beside, blocks)
    return [M], [C], [K, H]


def test_planes_that_are_seen_from_rest_may_be_lost_at_one_load() -> None:
    """At rest two frequencies meet at P = 1, ω = 2; of another mass and stiffness matrix too, in a faster frame."""
    one, T = np.eye(2, dtype=int), np.array([[1, 1], [0, 2]])
    E, H = np.diag([3, 5]), np.array([[0, -1], [1, 0]])
    terms = turning((one, E, H, 1), (T.T @ T, T.T @ E @ T, T.T @ H @ T, 3))
    found = first(terms, [f"q{i}" for i in range(8)], (1.0, 1.0), 12)
    data = certificate_of(terms, found)
    said = verifier.verify(data)
    assert isinstance(said, verifier.OfForms) and said.load is not None and said.load[0] < 1 < said.load[1]
    ((kind, omega),) = found.at_once
    assert kind == "flutter" and omega is not None and omega[0] < 1 < omega[1]  # 3 - 2
    (lost,) = said.at_once
    assert lost.turn == 3 and lost.omega is not None and lost.omega[0] < 2 < lost.omega[1]
    assert str(said).count("as seen from rest") == 2 and said.record()["at_once"][0]["turn"] == "3"
    for n, (row, column_, value) in enumerate(data["forms"]["K"][1]["points"]):
        if {row[0], column_[0]} <= {"q4", "q5", "q6", "q7"}:  # the loads differ, by less than the interval is wide
            unlike = copy.deepcopy(data)
            unlike["forms"]["K"][1]["points"][n][2] = str(F(value) * (1 + F(1, 10**25)))
            refused(unlike)
    (other,) = data["beside"]
    refused(
        data | {"beside": [other | {"kind": "divergence", "frequency_squared": None}]}, "no divergence|not one of a"
    )


def test_what_buckles_as_seen_from_rest_grows_in_the_frame_at_its_rate() -> None:
    E, rate = np.array([[3, 1], [1, 5]]), 2
    terms = turning((np.eye(2, dtype=int), E, -np.eye(2, dtype=int), rate))
    found = first(terms, [f"q{i}" for i in range(4)], (4 - 2**0.5, float(rate)), 12)
    said = verifier.verify(certificate_of(terms, found))
    for of in (found, said):
        assert of.kind == "flutter" and of.load is not None and (4 - of.load[1]) ** 2 < 2 < (4 - of.load[0]) ** 2
        assert of.frequency is not None and of.frequency[0] < rate < of.frequency[1]


def test_a_motion_that_drives_another_is_not_taken_apart_from_it() -> None:
    """K = [[6 − P, 0], [1, 2]]: at P = 4 one frequency is double with one mode, and a motion grows with time there."""
    M, K = [[1, 0], [0, 1]], [[[6, 0], [1, 2]], [[-1, 0], [0, 0]]]
    of_M, of_C, of_K = (
        [np.array([[fmpq(v) for v in row] for row in X]) for X in of] for of in ([M], [[[0, 0], [0, 0]]], K)
    )
    assert len(split(of_M, of_C, of_K, ["p", "q"], None, False, True)) == 1
    with pytest.raises(Unproven, match=r"stability could not be shown|not known to be stable"):
        first((of_M, of_C, of_K), ["p", "q"], None, 5)
    assert first((of_M, of_C, of_K), ["p", "q"], None, 3).kind == "none"
    assert len(split(of_M, of_C, [np.diag(np.diag(X)) for X in of_K], ["p", "q"], None, False, True)) == 2


def test_parts_are_the_same_but_for_factors() -> None:
    """One factor of all; without rates one of M and one of K, which is a change of the unit of time."""
    terms, _ = drawn(1, "whirls")
    one, still = Part(("a",), *terms), Part(("a",), terms[0], [0 * X for X in terms[1]], terms[2])
    for factor in (fmpq(3), fmpq(-1, 2)):
        assert one.scale(Part(("b",), *([factor * X for X in of] for of in terms))) == 1
    for k, scale in enumerate((fmpq(1, 2), fmpq(1), fmpq(2))):
        other = [[2 * X for X in of] if j == k else of for j, of in enumerate(terms)]
        assert one.scale(Part(("b",), *other)) == (None if any(X.any() for X in terms[k]) else 1)
        if k != 1:
            assert still.scale(Part(("b",), other[0], still.C, other[2])) == scale
            negative = [[-X for X in of] if j == k else of for j, of in enumerate(terms)]
            assert still.scale(Part(("b",), negative[0], still.C, negative[2])) is None
    assert one.scale(Part(("b",), terms[0], terms[1], terms[2][:1])) is None
    assert one.scale(Part(("b",), *([X[:1, :1] for X in of] for of in terms))) is None


def test_the_verifier_takes_parts_for_one_another_where_one_factor_or_one_unit_of_time_parts_them() -> None:
    def terms(*factors: int, rate: int = 0, size: int = 2) -> list[list[fmpq_mat]]:
        M, C, K = (fmpq_mat([[i * j + k for j in range(size)] for i in range(size)]) for k in (3, 1, 2))
        return [[factors[0] * M], [rate * factors[1] * C], [factors[2] * K, factors[2] * M]]

    one, still = terms(1, 1, 1, rate=1), terms(1, 1, 1)
    for factors in itertools.product((1, 2, -3), repeat=3):
        same = len(set(factors)) == 1
        assert verifier_parts.alike(one, terms(*factors, rate=1)) == same
        assert verifier_parts.rescaled(one, terms(*factors, rate=1)) is None
        of_time = fmpq(factors[2], factors[0]) if min(factors[::2]) > 0 else None
        assert verifier_parts.rescaled(still, terms(*factors)) == of_time
    for of in (one, still):
        for other in (terms(1, 1, 1, size=3), [of[0], of[1], of[2][:1]], [of[0], of[1], of[2][::-1]]):
            assert not verifier_parts.alike(of, other) and verifier_parts.rescaled(of, other) is None


# --- factors that are no fractions ------------------------------------------------------------------------------------


def test_with_a_factor_in_balls_what_is_exactly_nothing_is_still_known(tmp_path: Path) -> None:
    """A thrust that turns at once, a coordinate without mass, is the follower force."""
    stiff = {"V": "integral(exp(-x) * y.diff(x, 2) ** 2) / 2"}
    at_once = {"dW_nc": "-P * q * at(delta(y), 1) - (c * q.diff(t) + q - at(y.diff(x), 1)) * delta(q)",
               "parameters": "(own(c, 0),)"}  # fmt: skip
    loads = [fb.certified_load(fb.column(file_of(tmp_path, "s", stiff | more)), 2, digits=10) for more in ({}, at_once)]
    (a, b), (c, d) = (tuple(map(F, of.load or ("1", "0"))) for of in loads)
    assert max(a, c) < min(b, d)
    for of in loads:
        verifier.verify(json.loads(json.dumps(of.unverified)), verifier_of_matrices.FORMATS)


def test_refusals_name_what_is_not_supported(tmp_path: Path) -> None:
    for changes in ({"V": "integral(exp(-x) * y.diff(x, 2) ** 2) / 2"}, {"V": "V + sqrt(2) * at(y, 1) ** 2 / 2"}):
        found = fb.exact_load(fb.column(file_of(tmp_path, "sample", changes)), digits=6)
        assert not found.proof["first"] and "no fraction" in found.missing
        assert not any(word in found.missing for word in ("module", "attribute", "ufunc", "callable"))


if __name__ == "__main__":  # python -m tests.certify.test_motions_apart 100: so many systems of each kind
    for kind in (*TIES, "whirls", "tied whirls"):
        open_: list[int] = []
        for seed in range(int(sys.argv[1])):
            try:
                test_what_is_proven_of_random_systems_is_so_at_200_bits(seed, kind)
                forged(seed, kind)
                counted(seed, kind)
            except Unproven:
                open_.append(seed)
        print(f"{kind}: {sys.argv[1]} systems, not proven {open_}", flush=True)


def test_motions_are_told_where_a_sum_of_their_matrices_has_any_determinant_but_zero() -> None:
    """One, such as that of M/3 + K/5 for M = 3, is as good as another."""
    one, none, four = (fmpq_mat([[scale, 0], [0, scale]]) for scale in (3, 0, 12))
    assert all(verifier_motions.alike([X], [Y]) for X in (one, four) for Y in (one, four))
    assert not any(verifier_motions.alike(*pair) for pair in (([none], [one]), ([one], [none]), ([none], [none])))
    assert not verifier_motions.alike([one, one], [one, four])
    (motion,) = verifier_motions.motions([[fmpq_mat([[3]])], [], [fmpq_mat([[0]])]], False)
    assert motion.terms[0][0] == fmpq_mat([[3]])
    with pytest.raises(verifier.Refused, match="the motions cannot be told apart"):
        verifier_motions.motions([[none], [], [none]], False)
