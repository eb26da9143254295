"""Columns with factors such as exp(−x), of which a motion rests without load: by dense eigenvalues of the kernel's own
matrices, and by the sums that say exactly what rests."""

from __future__ import annotations

import json
import tempfile
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from flint import fmpq
from scipy.linalg import eigvals

import freebeam as fb
from freebeam_derive.certify import balls, verifier, verifier_of_matrices
from freebeam_derive.certify.boundary_polynomials import Question, boundaries
from freebeam_derive.certify.formal import Formal, resting
from tests.stated import file_of

PINNED = {  # a load in two places, with tension; y = x rests, with a mass that is tied to the tip
    "T": "integral(y.diff(t) ** 2) / 2 + exp(2) * q.diff(t) ** 2 / 2000",
    "V": "integral(exp(-x) * y.diff(x, 2) ** 2) / 2 + 3 * (at(y, 1) - q) ** 2 / 2",
    "W_c": "-P * integral(y.diff(x) ** 2) / 2", "dW_nc": "-6 * P * at(y, 1) * at(delta(y), half)",
    "ends": "('pinned', 'free')",
}  # fmt: skip
FREE = {  # of another mass, too: the rotation is not left to itself
    "T": "integral(exp(-x) * y.diff(t) ** 2) / 2", "V": "integral(exp(-x) * y.diff(x, 2) ** 2) / 2",
    "W_c": "P * integral(x * y.diff(x) ** 2) / 2", "ends": "('free', 'free')",
}  # fmt: skip
BASE = {"T": "integral(y.diff(t) ** 2) / 2", "dW_nc": "follower", "parameters": "()"}


@cache
def column(name: str) -> fb.Column:
    with tempfile.TemporaryDirectory() as folder:
        return fb.column(file_of(Path(folder), name, BASE | {"pinned": PINNED, "free": FREE}[name]))


@pytest.mark.parametrize("name", ["pinned", "free"])
def test_a_column_of_which_a_motion_rests_is_lost_where_its_eigenvalues_meet(name: str) -> None:
    found = fb.certified_load(column(name), 3, digits=9)
    assert found.load is not None and found.kind == "flutter" and found.above_zero

    def growing(load: float) -> bool:
        M, _, K = column(name).coefficients(3).at(load)
        squares = eigvals(-K, M)
        return bool((np.abs(squares.imag) > 1e-6 * np.abs(squares)).any() or (squares.real > 1e-6).any())

    low, high = (float(v) for v in found.load)
    assert not any(growing(low * share) for share in (0.01, 0.3, 0.6, 0.9, 1 - 1e-7)) and growing(high * (1 + 1e-7))
    said = verifier.verify(json.loads(json.dumps(found.unverified)), verifier_of_matrices.FORMATS)
    assert said.kind == "flutter" and "load P above 0" in str(said)
    floats = fb.critical_load(column(name), 3)  # whose matrix K is singular but for rounding
    assert floats.load == pytest.approx(low, rel=1e-8)


def test_a_motion_that_is_not_known_to_rest_is_refused_with_a_cure(monkeypatch: pytest.MonkeyPatch) -> None:
    """As where q is tied by exp(-1), of which the column above, with their product for q, is the cure."""
    monkeypatch.setattr(balls, "resting", lambda X: None)
    with pytest.raises(balls.Unproven, match=r"a motion of y and q rests.*take the product of the two"):
        boundaries(column("pinned").kernel, Question(3), 300)


def test_what_cancels_is_nothing_and_what_does_not_is_no_fraction() -> None:
    two, three = (np.sqrt(np.array([Formal(k)], dtype=object))[0] for k in (2, 3))
    assert (
        two * (three + 1) - two == two * three and three * two == two * three and (two + 1) / 2 == two / 2 + fmpq(1, 2)
    )
    assert two != three and np.exp(np.array([two], dtype=object))[0] != two and 1 / two == 1 / two != two
    assert Formal(2) ** -2 == 0.25 and Formal(3) > 2 and abs(Formal(-1)) == 1
    for compared in (lambda: two < 2, lambda: float(two), lambda: abs(two), lambda: two + 0.1):
        with pytest.raises(TypeError):
            compared()


def matrix(rows: list[list[Any]]) -> Any:
    return np.array([[v + Formal(0) for v in row] for row in rows], dtype=object)


def test_what_a_matrix_with_roots_takes_to_nothing() -> None:
    a, b = Formal.named("a"), Formal.named("b")
    found = resting(matrix([[a, -2 * a, 0], [-2 * a, 4 * a, 0], [0, 0, b]]))  # (2, 1, 0) from both sides
    assert found is not None and found.rows == found.columns and len(found.rows) == 1
    (k,) = found.columns
    assert [v / found.right[0, k] for v in found.right[:, k]] == [1, fmpq(1, 2), 0]
    assert (matrix([[a, -2 * a, 0], [-2 * a, 4 * a, 0], [0, 0, b]]) @ found.right)[:, k].tolist() == [0, 0, 0]
    assert resting(matrix([[a, b], [b, a]])) is None  # regular
    assert resting(matrix([[a, b], [a, b]])) is None  # from one side, and (b, -a) is no motion of fractions
    twice = resting(matrix([[a, -a, 0], [0, 0, 0], [0, 0, 0]]))
    assert twice is not None and len(twice.rows) == 2 and not twice.holds(np.array([[fmpq(1)], [fmpq(1)], [fmpq(0)]]))
