"""What the verifier knows of motions that leave each other alone, and of two planes that rates alone couple."""

from __future__ import annotations

from itertools import zip_longest
from typing import Any

from flint import fmpq, fmpq_mat, fmpq_poly

from freebeam_derive.certify.verifier_claims import require

Terms = list[list[fmpq_mat]]  # M, C and K, each by powers of the load


def _nothing(*matrices: fmpq_mat) -> bool:
    return all(v == 0 for X in matrices for v in X.entries())


def taken(terms: list[fmpq_mat], rows: list[int], columns: list[int]) -> list[fmpq_mat]:
    """Some rows and columns of matrices."""
    return [fmpq_mat([[X[i, j] for j in columns] for i in rows]) for X in terms]


def alike(one: Terms, other: Terms) -> bool:
    """Whether M, C and K are those of another but for one factor, so that their determinants are."""
    if [[(X.nrows(), X.ncols()) for X in terms] for terms in one] != [
        [(X.nrows(), X.ncols()) for X in terms] for terms in other
    ]:
        return False
    these, those = ([v for terms in of for X in terms for v in X.entries()] for of in (one, other))
    k = next(i for i, v in enumerate(these) if v != 0)
    return bool(those[k] != 0) and all(a * those[k] == b * these[k] for a, b in zip(these, those, strict=True))


# --- what all matrices leave to itself ----------------------------------------------------------------------------


def motions(terms: Terms) -> list[tuple[Terms, list[int]]]:
    """M, C and K of motions that leave each other alone, with the rows that these stand for, in an order of their own.

    For v among the motions and test functions u: both are null spaces of f(A), from either side, where f are products
    of factors of the characteristic polynomial of A, a quotient of two sums of all matrices. That each is as large as
    f's degree makes them all motions; that u X v is nothing for u and v of different f is checked for each matrix X.
    """
    M, C, K = terms
    below = sum((X / (2 * k + 3) for k, X in enumerate(M + K)), 0 * K[0])
    above = sum((X * (k + 1) / (k + 3) for k, X in enumerate(M + C + K)), 0 * K[0])
    require(below.det() != 0, "the motions cannot be told apart")
    inverse = below.inv()
    right, left = inverse * above, (above * inverse).transpose()
    factors = [f**power for f, power in right.charpoly().factor()[1]]
    k = 0
    while k < len(factors):  # join what some matrix couples with the k-th
        spaces = [(_null(f, left), _null(f, right)) for f in factors]
        coupled = [
            j for j in range(len(factors)) if j != k
            and not _nothing(*(u * X * v.transpose() for X in M + C + K
                               for u, v in ((spaces[k][0], spaces[j][1]), (spaces[j][0], spaces[k][1]))))
        ]  # fmt: skip
        if coupled:
            for j in coupled:
                factors[k] *= factors[j]
            factors, k = [f for j, f in enumerate(factors) if j not in coupled], 0
        else:
            k += 1
    found: list[tuple[Terms, list[int]]] = []
    for f in factors:
        u, v = _null(f, left), _null(f, right)
        require(u.nrows() == v.nrows() == f.degree(), "the motions are not all motions")
        own = [[u * X * v.transpose() for X in powers] for powers in terms]
        found.append((own, [max(j for j in range(v.ncols()) if v[i, j] != 0) for i in range(v.nrows())]))
    return sorted(found, key=lambda item: _order(item[0]))


def _null(f: fmpq_poly, A: fmpq_mat) -> fmpq_mat:
    """The null space of f(A), as rows each with a last entry 1 that no other has."""
    n = A.nrows()
    one = fmpq_mat([[fmpq(int(i == j)) for j in range(n)] for i in range(n)])
    whole = 0 * A
    for factor in reversed(f.coeffs()):
        whole = A * whole + factor * one
    found, count = whole.numer_denom()[0].nullspace()
    back = fmpq_mat([[fmpq(found[i, k]) for i in reversed(range(n))] for k in range(count)]).rref()[0]
    return fmpq_mat([[back[k, i] for i in reversed(range(n))] for k in range(count)])


def _order(terms: Terms) -> tuple[Any, ...]:
    """By size, then by det(x (M_0 + K_0) − M_0), a monic polynomial, from its lowest factor on, then with the sum of
    all K for K_0."""
    (M, *_), _, K = terms
    found: list[Any] = [M.nrows()]
    for stiff in (K[0], sum(K[1:], K[0])):
        whole = M + stiff
        found.append(whole.solve(M).charpoly().coeffs() if whole.det() != 0 else [])
    return tuple(found)


# --- two planes that rates couple ---------------------------------------------------------------------------------


def seen(terms: Terms, planes: list[list[int]], turn: fmpq) -> tuple[Terms, bool]:
    """Of two planes that are alike and coupled by rates [[0, B], [−B, 0]] alone, M and K of one as seen from a frame
    that turns, with x in place of ω²; and whether x is ω + turn. Rows: those of each plane.

    w = one ± i other is M ẅ ∓ iB ẇ + K w = 0, at w = e^(iωt) therefore det(K ± ωB − ω² M) = 0, and at s = turn ± ω
    det(A + s R − s² M) = 0 with A = K + turn B − turn² M, R = 2 turn M − B. Where R is nothing x is s². Else it is s:
    the determinant is that of the matrices [[0, 1], [A, R]] − s [[1, 0], [0, M]], but for its sign.
    """
    one, two = planes
    require(len(one) == len(two) > 0, "two planes are not of as many motions")
    require(sorted(one + two) == list(range(terms[2][0].nrows())), "two planes are not all of the motions")
    M, C, K = terms
    for X in M + K:
        (a,), (b,), (c,), (d,) = (taken([X], i, j) for i in planes for j in planes)
        require(a == d and _nothing(b, c), "two planes are not alike, or coupled by more than rates")
    for X in C:
        (a,), (b,), (c,), (d,) = (taken([X], i, j) for i in planes for j in planes)
        require(_nothing(a, d) and b == -c, "two planes are not coupled by rates alone")
    M, B, K = taken(M, one, one), taken(C, one, two), taken(K, one, one)
    n, none = len(one), 0 * M[0]
    both = list(zip_longest(M, B, K, fillvalue=none))
    still = [k + turn * b - turn * turn * m for m, b, k in both]
    rates = [2 * turn * m - b for m, b, _ in both]
    if _nothing(*rates):
        require(_nothing(*M[1:]), "a mass that comes with the load is not seen from a frame")
        return [M[:1], [], still], False

    def joined(blocks: list[list[fmpq_mat]]) -> fmpq_mat:
        return fmpq_mat([[X[i, j] for X in row for j in range(n)] for row in blocks for i in range(n)])

    one_ = fmpq_mat([[fmpq(int(i == j)) for j in range(n)] for i in range(n)])
    stiff = [joined([[none, none if k else one_], [A, R]]) for k, (A, R) in enumerate(zip(still, rates, strict=True))]
    masses = [joined([[none if k else one_, none], [none, m]]) for k, m in enumerate(M)]
    return [masses, [], stiff], True
