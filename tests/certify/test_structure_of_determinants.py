"""What is said exactly of det(λ² M + λ C + K), by prover and verifier, against the determinant itself in fractions."""

from __future__ import annotations

import itertools
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from flint import arb, fmpq, fmpq_mat, fmpq_poly

from freebeam_derive.certify import structure, verifier_degrees
from freebeam_derive.certify.balls import precision
from freebeam_derive.certify.boundary_polynomials import ball_matrices, expansion
from freebeam_derive.certify.numbers import Number, plain

N = 4
Arrays = list[Any]


def drawn(seed: int, massless: int, damped: bool, resting: int, kind: str) -> tuple[Arrays, Arrays, Arrays]:
    """M, C, K by powers of the load. kind: of C and K, "any", "skew" C with symmetric K, or "signed"."""
    dice = np.random.default_rng(seed)

    def matrix(low: int = -4, high: int = 5) -> Any:
        return np.array([[fmpq(int(v)) for v in row] for row in dice.integers(low, high, (N, N))])

    def symmetric() -> Any:
        half = matrix()
        return half @ half.T

    M, C, K = [symmetric()], [matrix() for _ in range(1 if massless else 2)], [symmetric(), matrix()]
    M[0][:massless] = M[0][:, :massless] = fmpq(0)
    K[0][N - resting :] = K[0][:, N - resting :] = fmpq(0)
    if not damped:
        for X in C:
            X[:massless, :massless] = fmpq(0)
            X[N - resting :] = fmpq(0)
    if kind == "skew":
        C, K[1] = [X - X.T for X in C], K[1] + K[1].T
    if kind == "signed":
        sign = np.where(np.arange(N) % 2, 1, -1)
        M, K = ([np.where(np.equal.outer(sign, sign), X, fmpq(0)) for X in terms] for terms in (M, K))
        C = [np.where(np.equal.outer(sign, sign), fmpq(0), X) for X in C]
    return M, C, K


def powers(M: Arrays, C: Arrays, K: Arrays) -> dict[tuple[int, int], fmpq]:
    """(a, p) -> factor of P^a λ^p of the determinant, from its values in fractions; none where it is zero."""
    loads, rates = range(2 * N + 1), range(2 * N + 1)

    def at(P: int, rate: int) -> fmpq:
        return fmpq_mat(sum((
            X * fmpq(P) ** a * fmpq(rate) ** p for terms, p in ((M, 2), (C, 1), (K, 0)) for a, X in enumerate(terms)
        ), np.full((N, N), fmpq(0))).tolist()).det()  # fmt: skip

    def through(values: list[fmpq]) -> list[fmpq]:
        whole = fmpq_poly([0])
        for k, value in enumerate(values):
            others = [j for j in range(len(values)) if j != k]
            part = fmpq_poly([value])
            for j in others:
                part *= fmpq_poly([fmpq(-j, k - j), fmpq(1, k - j)])
            whole += part
        return [whole[k] for k in range(len(values))]

    rows = [through([at(P, rate) for rate in rates]) for P in loads]
    columns = [through([row[p] for row in rows]) for p in range(2 * N + 1)]
    return {(a, p): v for p, column in enumerate(columns) for a, v in enumerate(column) if v != 0}


@pytest.mark.parametrize("kind", ["any", "skew", "signed"])
@pytest.mark.parametrize("damped", [False, True])
@pytest.mark.parametrize(("massless", "resting"), [(0, 0), (1, 0), (2, 0), (0, 1), (0, 2), (1, 1)])
def test_degree_evenness_and_what_vanishes_are_the_determinant_s(
    massless: int, resting: int, damped: bool, kind: str
) -> None:
    M, C, K = drawn(7 * massless + resting, massless, damped, resting, kind)
    true = powers(M, C, K)
    known = structure.structure(M, C, K)
    theirs = verifier_degrees.degrees(*([fmpq_mat(X.tolist()) for X in terms] for terms in (M, C, K)))
    assert known.degree == theirs.highest == max(p for _, p in true)
    assert known.even == theirs.even == (not any(p % 2 for _, p in true))
    assert known.rests == theirs.resting == resting and known.left_alone == theirs.apart
    assert not known.tangent and not theirs.touching  # C acts along what rests, or on it
    for a, p in itertools.product(range(3), range(6)):
        assert known.vanishes(a, p) == theirs.absent(a, p)
        assert not (known.vanishes(a, p) and (a, p) in true)
    assert resting == 0 or known.vanishes(0, 0)


@pytest.mark.parametrize("resting", [1, 2])
def test_where_damping_vanishes_with_the_load_h_and_g_begin_alike(resting: int) -> None:
    """Factors of P^a λ^(2b+1), a + b = r, are c times those of P^a λ^(2b); not where C_1 acts on what rests."""
    M, C, K = drawn(5, 0, False, resting, "any")
    C[0][:, N - resting :] = fmpq(0)
    for meets in (True, False):
        C[1][N - resting :, N - resting :] = fmpq(int(meets))
        C[1][N - resting :, : N - resting] = fmpq(3)
        known = structure.structure(M, C, K)
        theirs = verifier_degrees.degrees(*([fmpq_mat(X.tolist()) for X in terms] for terms in (M, C, K)))
        assert known.tangent == theirs.touching == (not meets)
        true = powers(M, C, K)
        pairs = [(true.get((a, 2 * b + 1), fmpq(0)), true[a, 2 * b]) for a in range(resting + 1) for b in [resting - a]]
        assert (len({odd / even for odd, even in pairs}) == 1) == (not meets)


def test_h_and_g_of_massless_and_resting_coordinates_are_the_determinant() -> None:
    """Up to one factor; what vanishes is exactly nothing."""
    for massless, resting, damped in ((1, 0, True), (1, 0, False), (0, 1, True), (0, 2, False)):
        M, C, K = drawn(3, massless, damped, resting, "any")
        true, known = powers(M, C, K), structure.structure(M, C, K)
        with precision(300):
            found = expansion(*ball_matrices(M, C, K), False, known)
            assert found.odd == bool(known.degree % 2) and found.N == known.degree // 2
            (a, p), value = next(iter(true.items()))
            factor = (-1) ** (p // 2) * (found.g if p % 2 else found.h).rows[a][p // 2] / value
            for which, odd in ((found.h, 0), (found.g, 1)):
                for a, row in enumerate(which.rows):
                    for b in range(row.degree() + 1):
                        expected = true.get((a, 2 * b + odd), fmpq(0))
                        assert (row[b] - (-1) ** b * factor * expected).contains(0)
                        assert row[b] == 0 or not known.vanishes(a, 2 * b + odd)


def test_numbers_are_fractions_until_a_root_is_taken() -> None:
    with precision(200):
        third, quarter = Number(fmpq(1, 3)), Number(fmpq(1, 4))
        assert plain(2 * third - fmpq(1, 6) + 0.5) == fmpq(1) and plain(1 / third) == 3
        assert plain(np.sqrt(quarter)) == fmpq(1, 2) and isinstance(np.sqrt(third), arb)
        both = np.array([third, quarter]) @ np.array([np.sqrt(third), fmpq(2)])
        assert both.overlaps(arb(1) / 3 * (arb(1) / 3).sqrt() + arb(1) / 2) and both.rad() < 1e-50
        assert (4 * np.arctan(Number(1))).overlaps(arb.pi()) and np.exp(Number(1)).overlaps(arb(1).exp())
        assert third > quarter and quarter <= fmpq(1, 4) and third == fmpq(1, 3) and float(quarter) == 0.25
        for rounded in (0.1, Fraction(1, 3)):
            with pytest.raises(TypeError):
                _ = third * rounded
