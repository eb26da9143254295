"""Certificates of matrices that are known in balls alone: true ones are accepted, what is accepted holds of matrices
drawn from within by dense eigenvalues, and forged ones are refused."""

from __future__ import annotations

import copy
import json
import sys
import tempfile
from fractions import Fraction
from functools import cache
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from flint import fmpq, fmpq_mat
from scipy.linalg import eigvals

import freebeam as fb
from freebeam_derive.certify import verifier, verifier_degrees, verifier_lists, verifier_loads, verifier_of_matrices
from freebeam_derive.certify.verifier_of_matrices import FORMATS, OfMatrices
from tests.stated import file_of

F = Fraction
Data = dict[str, Any]
STIFF = {"V": "integral(exp(-x) * y.diff(x, 2) ** 2) / 2", "dW_nc": "follower + external + internal"}
TWO = {
    "T": "integral(y.diff(t) ** 2 + psi.diff(t) ** 2) / 2",
    "V": "integral(exp(-x) * y.diff(x, 2) ** 2 + psi.diff(x, 2) ** 2) / 2",
    "W_c": "P * integral(y.diff(x) ** 2 + psi.diff(x) ** 2) / 2",
    "dW_nc": "follower - P * at(psi.diff(x), 1) * at(delta(psi), 1)",
}
CASES: dict[str, tuple[dict[str, str], dict[str, str]]] = {
    "undamped": (STIFF, {}),
    "damped": (STIFF, {"alpha": "0.01", "beta": "0.1"}),
    "in the limit": (STIFF, {"kappa": "1"}),
    "two planes": (TWO, {}),
}


@cache
def column(two: bool) -> fb.Column:
    with tempfile.TemporaryDirectory() as folder:
        return fb.column(file_of(Path(folder), "sample", TWO if two else STIFF))


@cache
def proven(name: str) -> fb.Certified:
    return fb.certified_load(column(name == "two planes"), 2, digits=12, **CASES[name][1])


def written(name: str) -> Data:
    data: Data = json.loads(json.dumps(proven(name).unverified))
    return data


def check(data: Data) -> OfMatrices:
    found = verifier.verify(data, FORMATS)
    assert isinstance(found, OfMatrices)
    return found


def refused(data: Data, match: str | None = None) -> None:
    with pytest.raises(verifier.Refused, match=match):
        verifier.verify(data, FORMATS)


@pytest.mark.parametrize("name", CASES)
def test_a_true_certificate_is_accepted_and_says_of_what_it_is(name: str, tmp_path: Path) -> None:
    found, data = proven(name), written(name)
    said = check(data)
    assert said.load is not None and found.load is not None and data["format"].endswith("9")
    assert said.record()["stable_at_zero_load"] is (None if said.above_zero else True)
    assert F(found.load[0]) < said.load[1] and said.load[0] < F(found.load[1])
    assert "of every M, C and K within those in this file" in str(said) and "is not checked" in str(said)
    assert said.damped == (name in ("damped", "in the limit")) and len(said.parts) == 1 + (name == "two planes")
    assert ("leaving each other alone" in str(said)) == ("of one of these" in str(said)) == (name == "two planes")
    assert 0 < said.widest < F(1, 10**60)
    near = fb.critical_load(column(name == "two planes"), 2, **{k: float(v) for k, v in CASES[name][1].items()})
    assert float(said.load[0]) == pytest.approx(near.load, rel=1e-9)
    file = tmp_path / "c.json"
    file.write_text(json.dumps(data))
    assert str(fb.verify_certificate(str(file))) == str(said)


def test_forged_matrices_are_refused() -> None:
    data = written("damped")
    for letter in "MCK":
        for k, table in enumerate(data[letter]):
            unlike = copy.deepcopy(data)
            value = table[0][0] if isinstance(table[0][0], str) else table[0][0][0]
            unlike[letter][k][0][0] = str(F(value) * F(1000001, 1000000))
            refused(unlike)
            refused(data | {letter: data[letter][:k]})
            refused(data | {letter: [*data[letter][:k], table[:-1], *data[letter][k + 1 :]]}, "rows and columns")
    for entry in (["1"], ["1", "0"], ["1", "-1/10"], ["1", "1", "1"], 1, None, ["1", "1e-3"]):
        unlike = copy.deepcopy(data)
        unlike["K"][0][0][0] = entry
        refused(unlike)
    for changed in (
        {"names": ["y"]}, {"names": [1, 1]}, {"parts": []}, {"parts": [["y"], ["y"]]}, {"parts": [["psi"]]},
        {"beside": [data["stretches"]]}, {"kappa": "1"}, {"forms": {}}, {"format": "freebeam certificate 2"},
    ):  # fmt: skip
        refused(data | changed)
    refused({key: value for key, value in data.items() if key != "beside"}, "beside")


def test_what_is_no_list_of_matrices_is_refused() -> None:
    """Even where nothing would be read from it; and more powers of the load than are served, of matrices of nothing."""
    data = written("undamped")
    nothing = [["0"] * len(row) for row in data["K"][0]]
    for letter in "MCK":
        for junk in ({}, "", "00", {"0": nothing}, (nothing,), None, 0, [nothing] * 10, data[letter] + [nothing] * 10):
            refused(data | {letter: junk}, "no list by powers of the load, or too many")
        refused(data | {letter: [[*nothing, nothing[0]]]}, "rows and columns")


def test_parts_of_matrices_have_exactly_nothing_between_them() -> None:
    data = written("two planes")
    for entry in ("1/1000000", ["0", "1/1000000"]):
        for letter in "MK":
            unlike = copy.deepcopy(data)
            unlike[letter][0][0][-1] = entry
            refused(unlike, "do not leave each other alone")
    refused(data | {"parts": data["parts"][::-1]})
    refused(data | {"beside": [None]})


# --- what is accepted holds of all matrices within --------------------------------------------------------------------


def wider(data: Data, share: float, end: float) -> Data:
    """Of every entry that is not nothing a ball, of a share of its size, and stability up to a load."""

    def entry(v: Any) -> Any:
        middle = F(v if isinstance(v, str) else v[0])
        return "0" if v == "0" else [str(middle), str(abs(middle) * F(share))]

    tables = {letter: [[[entry(v) for v in row] for row in X] for X in data[letter]] for letter in "MCK"}
    none = {"kind": "none", "load": None, "frequency_squared": None, "load_max": str(F(end)),
            "proof": {"crossing": False, "first": False, "stable_below": True, "kind": True}}  # fmt: skip
    stretches = [s for s in data["stretches"] if F(s["start"]) < F(end)]
    last = stretches[-1] | {"end": str(F(end))}
    return data | tables | none | {"stretches": [*stretches[:-1], last]}


def within(data: Data, dice: np.random.Generator) -> list[list[Any]]:
    """Matrices from within, at the edges of the balls."""

    def drawn(v: Any) -> float:
        middle, radius = (F(v), 0) if isinstance(v, str) else map(F, v)
        return float(middle + radius * int(dice.choice([-1, 1])))

    return [[np.array([[drawn(v) for v in row] for row in X]) for X in data[letter]] for letter in "MCK"]


def growth(terms: list[list[Any]], load: float) -> float:
    M, C, K = (sum((load**k * X for k, X in enumerate(powers)), 0 * terms[2][0]) for powers in terms)
    one, none = np.eye(len(K)), 0 * K
    values = eigvals(np.block([[none, one], [-K, -C]]), np.block([[one, none], [none, M]]))
    return float(values.real.max() / abs(values).max())


def held(name: str, shares: tuple[float, ...], count: int) -> list[bool]:
    """Of each width whether it is accepted; then matrices from within are stable."""
    data, dice, accepted = written(name), np.random.default_rng(5), []
    end = 0.5 * float(F(data["load"][0]))
    for share in shares:
        wide = wider(data, share, end)
        try:
            said = check(wide)
        except verifier.Refused:
            accepted.append(False)
            continue
        accepted.append(True)
        assert said.end == F(end)
        for _ in range(count):
            terms = within(wide, dice)
            assert all(growth(terms, end * k / 8) < 1e-6 for k in range(9))
    return accepted


def test_a_list_of_all_crossings_is_one_of_matrices_in_balls_too() -> None:
    listed = fb.certified_crossings(column(False), 2, load_max=30, digits=12, **CASES["damped"][1])
    data = json.loads(json.dumps(listed.unverified))
    (said,) = verifier_lists.verify(data).passings
    assert F(listed[0].load[0]) < said.load[1] and said.load[0] < F(listed[0].load[1]) and said.change == 2
    with pytest.raises(verifier.Refused, match="may lie between"):
        verifier_lists.verify(data | {"crossings": [[]]})


@pytest.mark.parametrize("name", ["undamped", "damped"])
def test_what_is_accepted_of_wide_balls_holds_of_matrices_within(name: str) -> None:
    accepted = held(name, (1e-9, 1e-5, 1e-3, 0.5), 5)
    assert accepted[0] and not accepted[-1] and accepted == sorted(accepted, reverse=True)


@pytest.mark.parametrize("seed", range(6))
def test_what_entries_alone_tell_of_a_determinant_is_so(seed: int) -> None:
    """Of sparse matrices in fractions, against the determinant's polynomials."""
    dice = np.random.default_rng(seed)
    n = 3

    def sparse(share: float) -> Any:
        return np.where(dice.random((n, n)) < share, dice.integers(1, 5, (n, n)), 0)

    M, C, K = [np.diag(dice.integers(0, 2, n))], [sparse(0.3)], [sparse(0.4), sparse(0.5)]
    K[0][:, 0] = K[0][0] = 0
    of = [[fmpq_mat([[fmpq(int(v)) for v in row] for row in X]) for X in terms] for terms in (M, C, K)]
    entries = [[[[bool(v) for v in row] for row in X.tolist()] for X in terms] for terms in (M, C, K)]
    told, known = verifier_degrees.of_entries(*entries), verifier_degrees.degrees(*of)
    assert told.highest >= known.highest - 1 and told.resting >= 1 and (known.even or not told.even)
    h, g = verifier_loads._both(of, False)
    for odd, X in ((0, h), (1, g)):
        for a in range(X.nrows()):
            for b in range(X.ncols()):
                power = 2 * b + odd
                assert X[a, b] == 0 or not (told.absent(a, power) or power > told.highest or (odd and told.even))


if __name__ == "__main__":  # python -m tests.certify.test_certificates_of_matrices 200: so many matrices of each width
    for name in ("undamped", "damped", "in the limit"):
        print(name, held(name, (1e-9, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 0.1, 0.5), int(sys.argv[1])), flush=True)


@pytest.mark.parametrize(
    ("C", "limit", "even", "damped"),
    [
        (0, False, False, False),
        (0, True, True, False),
        (1, False, True, False),
        (1, False, False, True),
        (1, True, True, True),
    ],
)
def test_a_part_is_damped_by_what_is_no_gyroscopic_term_or_vanishes(
    C: int, limit: bool, even: bool, damped: bool
) -> None:
    part: Any = object.__new__(verifier_of_matrices._Part)
    for name, value in (("C", [None] * C), ("limit", limit), ("known", SimpleNamespace(even=even))):
        object.__setattr__(part, name, value)
    assert part.damped == damped
