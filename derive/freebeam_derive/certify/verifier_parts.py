"""What the verifier knows of motions that leave each other alone, and of two that a frame couples which turns."""

from __future__ import annotations

from flint import fmpq, fmpq_mat


def _nothing(*matrices: fmpq_mat) -> bool:
    return all(v == 0 for X in matrices for v in X.entries())


def taken(terms: list[fmpq_mat], rows: list[int], columns: list[int]) -> list[fmpq_mat]:
    """Some rows and columns of matrices."""
    return [fmpq_mat([[X[i, j] for j in columns] for i in rows]) for X in terms]


def from_rest(M: list[fmpq_mat], C: list[fmpq_mat], K: list[fmpq_mat]) -> tuple[list[list[fmpq_mat]], fmpq] | None:
    """Of two halves that are alike and coupled by 2c [[0, M], [−M, 0]] alone: M and K + c² M of one, and |c|.

    With w = one ± i other is M ẅ ∓ 2ic M ẇ + K w = 0, at w = e^(iωt) therefore det(K + c² M − (ω ∓ c)² M) = 0.
    None where they are not so.
    """
    n, odd = divmod(M[0].nrows(), 2)
    if odd or not n or len(C) != 1 or len(M) != 1:
        return None
    one, two = list(range(n)), list(range(n, 2 * n))
    for X in (*M, *K):
        (a,), (b,), (c,), (d,) = (taken([X], i, j) for i in (one, two) for j in (one, two))
        if a != d or not _nothing(b, c):
            return None
    (mass,), stiff = taken(M, one, one), taken(K, one, one)
    (a,), (b,), (c,), (d,) = (taken(C, i, j) for i in (one, two) for j in (one, two))
    unit = next(((i, j) for i in one for j in one if mass[i, j] != 0), None)
    if unit is None:
        return None
    rate = b[unit] / mass[unit] / 2
    if not _nothing(a, d) or b != 2 * rate * mass or c != -b:
        return None
    return [[mass], [], [stiff[0] + rate * rate * mass, *stiff[1:]]], abs(rate)
