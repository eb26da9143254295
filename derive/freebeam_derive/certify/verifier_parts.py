"""What the verifier knows of motions that leave each other alone, and of two planes that rates alone couple."""

from __future__ import annotations

from itertools import zip_longest

from flint import fmpq, fmpq_mat

from freebeam_derive.certify.verifier_claims import require

Terms = list[list[fmpq_mat]]  # M, C and K, each by powers of the load


def _nothing(*matrices: fmpq_mat) -> bool:
    return all(v == 0 for X in matrices for v in X.entries())


def taken(terms: list[fmpq_mat], rows: list[int], columns: list[int]) -> list[fmpq_mat]:
    """Some rows and columns of matrices."""
    return [fmpq_mat([[X[i, j] for j in columns] for i in rows]) for X in terms]


def _factor(one: list[fmpq_mat], other: list[fmpq_mat]) -> fmpq | None:
    """The number, not 0, that matrices are of others; None where there is none."""
    if [(X.nrows(), X.ncols()) for X in one] != [(X.nrows(), X.ncols()) for X in other]:
        return None
    pairs = [(u, v) for X, Y in zip(one, other, strict=True) for u, v in zip(X.entries(), Y.entries(), strict=True)]
    factor = next((v / u for u, v in pairs if u != 0), fmpq(0))
    return factor if factor != 0 and all(u * factor == v for u, v in pairs) else None


def alike(one: Terms, other: Terms) -> bool:
    """Whether M, C and K are those of another but for one factor, so that their determinants are."""
    same = [*map(len, one)] == [*map(len, other)]
    return same and _factor(*([X for terms in of for X in terms] for of in (one, other))) is not None


def rescaled(one: Terms, other: Terms) -> fmpq | None:
    """λ² of another over those of one whose M and K are the other's but for a positive factor each, without C; None
    where it is not so."""
    of_M, of_K = (_factor(one[k], other[k]) for k in (0, 2))
    if of_M is None or of_K is None or not _nothing(*one[1], *other[1]):
        return None
    return of_K / of_M if of_M > 0 and of_K > 0 else None


# --- two planes that rates couple ---------------------------------------------------------------------------------


def seen(terms: Terms, planes: list[list[int]], turn: fmpq) -> tuple[Terms, bool]:
    """Of two planes that are alike and coupled by rates [[0, B], [−B, 0]] alone, M and K of one as seen from a frame
    that turns, with x in place of ω²; and whether x is ω + turn. Rows: those of each plane.

    w = one ± i other is M ẅ ∓ iB ẇ + K w = 0, at w = e^(iωt) therefore det(K ± ωB − ω² M) = 0, and at s = turn ± ω
    det(A + s R − s² M) = 0 with A = K + turn B − turn² M, R = 2 turn M − B. Where R is nothing x is s². Else it is s:
    the determinant is that of the matrices [[0, 1], [A, R]] − s [[1, 0], [0, M]], but for its sign.
    """
    M, B, K = _of_planes(terms, planes)
    rates = [2 * turn * m - b for m, b in zip_longest(M, B, fillvalue=0 * M[0])]
    if not _nothing(*rates):
        return _pencil(M, B, K, turn, [], []), True
    require(_nothing(*M[1:]), "a mass that comes with the load is not seen from a frame")
    return [M[:1], [], [k + turn * b - turn * turn * m for m, b, k in zip_longest(M, B, K, fillvalue=0 * M[0])]], False


def seen_damped(terms: Terms, planes: list[list[int]], turn: fmpq) -> Terms:
    """The same of M, C, K, G and S, rates G that stay where damping C vanishes, which acts on displacements by S: the
    matrices with ω + turn in place of ω².

    With C = [[C, D], [−D, C]] and S = [[E, S], [−S, E]] the damping adds iε (ωC ± S) to what w has, and of real
    matrices ε (E ± ωD), which no motion grows by to first order; [0, 1]ᵀ [S − turn C, C] is S + ωC of (w, s w).
    """
    M, C, K, G, S = terms
    M, B, K = _of_planes([M, G, K], planes)
    for X in C + S:
        (a,), (b,), (c,), (d,) = (taken([X], i, j) for i in planes for j in planes)
        require(a == d and b == -c, "what vanishes is not alike in two planes")
    return _pencil(M, B or [0 * M[0]], K, turn, taken(C, planes[0], planes[0]), taken(S, planes[0], planes[1]))


def _of_planes(terms: Terms, planes: list[list[int]]) -> Terms:
    """M and K of each of two planes, and by what rates they are coupled; C of these alone."""
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
    return [taken(M, one, one), taken(C, one, two), taken(K, one, one)]


def _pencil(
    M: list[fmpq_mat], B: list[fmpq_mat], K: list[fmpq_mat], turn: fmpq, C: list[fmpq_mat], S: list[fmpq_mat]
) -> Terms:
    """[[0, 1], [A, R]] − s [[1, 0], [0, M]], and [[0, 0], [S − turn C, C]]."""
    n, none = M[0].nrows(), 0 * M[0]
    one = fmpq_mat([[fmpq(int(i == j)) for j in range(n)] for i in range(n)])

    def joined(blocks: list[list[fmpq_mat]]) -> fmpq_mat:
        return fmpq_mat([[X[i, j] for X in row for j in range(n)] for row in blocks for i in range(n)])

    both = enumerate(zip_longest(M, B, K, fillvalue=none))
    stiff = [
        joined([[none, none if k else one], [x + turn * b - turn * turn * m, 2 * turn * m - b]])
        for k, (m, b, x) in both
    ]
    masses = [joined([[none if k else one, none], [none, m]]) for k, m in enumerate(M)]
    rates = [joined([[none, none], [s - turn * c, c]]) for c, s in zip_longest(C, S, fillvalue=none)]
    return [masses, rates, stiff]
