"""Motions that leave each other alone where factors are no fractions, exp(-x) or a root: that two planes are the same,
or a sum and a difference, is known exactly. Held against a plane alone and dense eigenvalues; forged files are refused.
"""

from __future__ import annotations

import copy
import itertools
import json
import tempfile
from fractions import Fraction
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from flint import arb, fmpq, fmpq_mat
from scipy.linalg import eigvals

import freebeam as fb
from freebeam_derive.certify import balls, parts, verifier, verifier_lists
from freebeam_derive.certify.boundary_polynomials import Question, boundaries
from freebeam_derive.certify.verifier_of_matrices import FORMATS, OfMatrices
from tests.certify.test_motions_apart import PLANES as PLANES_ALIKE
from tests.certify.test_motions_apart import SPINS, planes
from tests.stated import file_of

F = Fraction
Data = dict[str, Any]
BOTH = {
    "T": "integral(y.diff(t) ** 2 + mu * psi.diff(t) ** 2) / 2",
    "V": "integral(exp(-x) * (y.diff(x, 2) ** 2 + psi.diff(x, 2) ** 2)) / 2"
    " + sqrt(2) * k * (at(y, 1) - at(psi, 1)) ** 2 / 2 + exp(-20) * c * at(psi, 1) ** 2 / 2",
    "W_c": "P * integral(y.diff(x) ** 2 + psi.diff(x) ** 2) / 2",
    "dW_nc": "follower - P * at(psi.diff(x), 1) * at(delta(psi), 1)",
    "parameters": "(own(mu, 1.0), own(k, 0.0), own(c, 0.0))",
}
PLANES = {"alike": {}, "heavy": {"mu": 4}, "tied": {"k": 1}, "unlike": {"c": 1}}


@cache
def column() -> fb.Column:
    with tempfile.TemporaryDirectory() as folder:
        return fb.column(file_of(Path(folder), "sample", BOTH))


@cache
def proven(name: str) -> fb.Certified:
    return fb.certified_load(column(), 2, digits=10, **PLANES[name])


def stated(name: str) -> dict[str, F]:
    return {"mu": F(1), "k": F(0), "c": F(0)} | {key: F(value) for key, value in PLANES[name].items()}


def check(data: Data) -> OfMatrices:
    found = verifier.verify(json.loads(json.dumps(data)), FORMATS)
    assert isinstance(found, OfMatrices)
    return found


@pytest.mark.parametrize(("name", "times", "scales"), [("alike", 2, {1}), ("heavy", 2, {1, 4}), ("tied", 1, {1})])
def test_planes_are_lost_where_one_alone_is_and_a_verifier_says_so(name: str, times: int, scales: set[int]) -> None:
    """Of the tied ones their sum, which the spring leaves alone: all at one load, which floats find too."""
    alone, found = proven("alike").load, proven(name)
    assert alone is not None and found.load is not None
    assert max(F(alone[0]), F(found.load[0])) < min(F(alone[1]), F(found.load[1]))
    assert fb.critical_load(column(), 2, **PLANES[name]).load == pytest.approx(float(alone[0]), rel=1e-7)
    said = check(dict(found.unverified or {}))
    assert said.times == said.record()["times"] == times and len(said.parts) == 2
    assert {max(s, 1 / s) for s in said.scales} == scales
    assert ("with the same numbers" in str(said)) == (times > 1)


@pytest.mark.parametrize("name", ["alike", "heavy", "tied"])
def test_between_listed_crossings_as_many_eigenvalues_grow_as_is_said(name: str) -> None:
    found = fb.certified_crossings(column(), 2, load_max=60, digits=10, **PLANES[name])
    loads = [0.0, *(float(c.load[0]) for c in found), 60.0]
    counts = [*(c.unstable_below for c in found), found[-1].unstable_above]
    for (low, high), count in zip(itertools.pairwise(loads), counts, strict=True):
        if high - low > 1e-6:
            M, _, K = column().coefficients(2, **PLANES[name]).at((low + high) / 2)
            assert (np.sqrt(eigvals(-K, M).astype(complex)).real > 1e-6).sum() == count
    said = verifier_lists.verify(json.loads(json.dumps(found.unverified)))
    assert len(said.passings) == len(found) > 0


def test_planes_that_differ_are_not_taken_for_one_another() -> None:
    """By a billionth, of which floats hold nothing; the weaker one, y, is lost first."""
    with balls.precision(300):
        of_y, of_psi = (of.part for of in boundaries(column().kernel, Question(2, own=stated("unlike")), 300))
        same = [of.part for of in boundaries(column().kernel, Question(2, own=stated("alike")), 300)]
    assert of_y and of_psi and same[0] and same[1] and same[0].scale(same[1]) == 1
    assert of_y.scale(of_psi) is None
    assert proven("unlike").load == proven("alike").load
    assert check(dict(proven("unlike").unverified or {})).times == 1


def test_parts_in_balls_have_the_determinant_of_all_and_nothing_between_them() -> None:
    with balls.precision(300):
        *terms, names, letters = balls.named_matrices(column().kernel, 3, stated("tied"), (F(0), F(0)))
        found = parts.split(*terms, names, letters, False, None)
        assert len(found) == 2
        for P, rate in ((fmpq(1, 3), fmpq(2, 7)), (fmpq(-2), fmpq(5))):
            values = []
            for M, K in ((terms[0], terms[2]), *((of.M, of.K) for of in found)):
                whole = rate**2 * M[0] + K[0] + P * K[1]
                unit = M[0] + K[0]
                values += [determinant(whole) / determinant(unit)]
            assert values[0].overlaps(values[1] * values[2]) and values[0].rel_accuracy_bits() > 100
        # U and V take what is fractions times each letter apart
        assert letters is not None
        sums = [fmpq_mat(X.tolist()) for powers in letters for X in powers]
        swap = fmpq_mat([[int((i + 3) % 6 == j) for j in range(6)] for i in range(6)])
        assert all(swap * X == X * swap for X in sums)


def determinant(X: Any) -> arb:
    return balls.ball_matrices([X], [], [X])[0][0].det()


def test_equal_planes_in_a_ring_are_taken_apart_by_roots(tmp_path: Path) -> None:
    """Springs of -exp(-1) between the tips of three: by the frequencies of the ring, the one that is double first."""
    ring = planes("y u v", "yu uv vy", "- half")
    of = fb.column(file_of(tmp_path, "ring", ring | {"V": ring["V"].replace("half", "exp(-1)")}))
    found = fb.certified_load(of, 2, digits=8)
    said = check(dict(found.unverified or {}))
    assert (len(said.parts), said.times) == (3, 2) and found.load is not None and said.load is not None
    assert said.load[0] < F(found.load[1]) and F(found.load[0]) < said.load[1]
    listed = fb.certified_crossings(of, 2, load_max=3, digits=8)
    loads = [0.0, *(float(c.load[0]) for c in listed), 3.0]
    for (low, high), count in zip(itertools.pairwise(loads), (0, 2, 3), strict=True):
        M, _, K = of.coefficients(2).at((low + high) / 2)
        assert (eigvals(K, M).real < 0).sum() == count
    assert [(c.unstable_below, c.unstable_above) for c in listed] == [(0, 2), (2, 3)]


def test_planes_of_a_taper_that_a_disc_couples_by_rates_are_seen_from_a_frame(tmp_path: Path) -> None:
    """Forward and backward whirl pass each other; as many eigenvalues grow as is said. No file holds such a frame."""
    of = fb.column(file_of(tmp_path, "disc", PLANES_ALIKE | SPINS | {"V": BOTH["V"].split(" + sqrt(2)")[0]}))
    found = fb.certified_crossings(of, 2, load_max=6, digits=8)
    loads = [0.0, *(float(c.load[0]) for c in found), 6.0]
    counts = [*(c.unstable_below for c in found), found[-1].unstable_above]
    assert len(found) == 2 and "frame" in (found.missing or "")
    for (low, high), count in zip(itertools.pairwise(loads), counts, strict=True):
        M, C, K = of.coefficients(2).at((low + high) / 2)
        one, none = np.eye(len(K)), 0 * K
        values = eigvals(np.block([[none, one], [-K, -C]]), np.block([[one, none], [none, M]]))
        assert (values.real > 1e-5 * abs(values).max()).sum() == count
    first = fb.certified_load(of, 2, digits=8)
    assert first.load is not None and F(first.load[0]) < F(found[0].load[1]) and F(found[0].load[0]) < F(first.load[1])


PIPE = {  # b is the share of the fluid in the mass, P its speed
    "W_c": "P ** 2 * integral(y.diff(x) ** 2) / 2", "dW_nc": "-2 * sqrt(b) * P * integral(y.diff(x, t) * delta(y))",
    "ends": "('pinned', 'pinned')", "parameters": "(own(b, 0.1),)",
}  # fmt: skip


def test_a_pipe_held_at_both_ends_diverges_whatever_its_mass_ratio(tmp_path: Path) -> None:
    """At the speed π, but for the series: sqrt(1/10) stands before the rates, which do not work."""
    found = fb.certified_load(fb.column(file_of(tmp_path, "pipe", PIPE)), 4, digits=8)
    assert found.kind == "divergence" and found.load is not None and all(found.proof.values())
    assert np.pi < float(found.load[0]) < np.pi * 1.0005
    data: Data = json.loads(json.dumps(found.unverified))
    said = check(data)
    assert said.gyroscopic and not said.damped and "M and K symmetric and C skew" in str(said)
    for letter, k, i, j in (("M", 0, 1, 0), ("K", 0, 0, 2), ("K", 2, 0, 2), ("C", 1, 0, 1), ("C", 1, 3, 2)):
        unlike = copy.deepcopy(data)  # by what no digit of the load shows
        entry = unlike[letter][k][i][j]
        changed = F(entry if isinstance(entry, str) else entry[0]) + F(1, 10**90)
        unlike[letter][k][i][j] = str(changed) if isinstance(entry, str) else [str(changed), entry[1]]
        with pytest.raises(verifier.Refused):
            check(unlike)


def test_forged_parts_that_are_the_first_again_are_refused() -> None:
    data: Data = json.loads(json.dumps(proven("heavy").unverified))
    assert data["beside"] == [None]

    def refused(changed: Data, match: str) -> None:
        with pytest.raises(verifier.Refused, match=match):
            check(changed)

    for letter, i, j in (("M", 2, 2), ("M", 0, 1), ("K", 2, 3), ("K", 0, 0)):
        for k in (0, 1):  # of a radius, or a middle, by what no digit shows
            unlike = copy.deepcopy(data)
            entry = unlike[letter][0][i][j]
            if isinstance(entry, str):
                unlike[letter][0][i][j] = str(F(entry) + F(1, 10**90))
            else:
                entry[k] = str(F(entry[k]) + F(1, 10**90))
            refused(unlike, "not the first again")
    backwards = copy.deepcopy(data)
    for table in backwards["K"]:
        for row in table[2:]:
            row[2:] = [str(-F(v)) if isinstance(v, str) else [str(-F(v[0])), v[1]] for v in row[2:]]
    refused(backwards, "not the first again")
    tied: Data = json.loads(json.dumps(proven("tied").unverified))
    refused(tied | {"beside": [None]}, "not the first again")
    damped = data | {"C": [[["1" if i == j else "0" for j in range(4)] for i in range(4)]]}
    refused(damped, "not the first again")  # a unit of time is none with damping
