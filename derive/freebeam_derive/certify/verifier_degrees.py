"""What the verifier knows exactly of det(λ² M + λ C + K): its degree, whether it is even, what vanishes at P = λ = 0.

Degree: rows u_0, …, u_k with u_0 M = 0, u_1 M + u_0 C = 0, u_2 M + u_1 C + u_0 K = 0 and so on, for every power of the
load, are so many factors of μ = 1/λ in det(M + μ C + μ² K), and so many powers of λ less than 2n.

Even: D(−λ) = D(λ) where M and K are symmetric and C is skew, by transposition; and where coordinates can be given signs
such that M and K link coordinates of one sign alone and C those of different signs, by the change of these signs.

At P = λ = 0: K of rank n − r makes r rows of first order in P and λ; of second order in λ where C has nothing in them.
Touching: with K_0 = [[0, 0], [0, A]] in these rows and r such columns, and all others, C_0 is [[0, 0], [0, B]] and C_1
is [[0, …], …]. With P counted twice the determinant is then det A (1 + λ tr A⁻¹B) times that of the r rows and columns
to lowest order, and what is at least two orders higher.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

from flint import fmpq, fmpq_mat

Terms = list[fmpq_mat]
Held = list[list[list[bool]]]  # by powers of the load: whether an entry is not nothing
LONGEST_CHAIN = 4  # a degree that is taken too high is refused later: the roots do not use it up


@dataclass(frozen=True)
class Degrees:
    """highest: power of λ at most. even: no odd powers. resting: r; apart: C has nothing in those rows, or columns;
    touching: in neither, though it is not nothing there, nor C_1 where these meet."""

    highest: int
    even: bool
    resting: int
    apart: bool
    touching: bool = False

    def each(self, count: int, even: bool) -> Degrees:
        """Of each of so many parts of which all that is said is alike."""
        if count == 1:
            return self
        highest = self.highest // count
        return replace(self, highest=highest - (highest % 2 if even else 0), even=even, resting=self.resting // count)

    def absent(self, of_load: int, of_rate: int) -> bool:
        """Whether P^of_load λ^of_rate has no part in the determinant."""
        if self.apart:
            return 2 * of_load + of_rate < 2 * self.resting
        return of_load + of_rate < self.resting


def degrees(M: Terms, C: Terms, K: Terms) -> Degrees:
    """C: empty where it is nothing. Exact, of matrices by powers of the load."""
    n, still = K[0].nrows(), K[0]
    resting = n - still.rank()
    apart, touching = True, False
    if C and resting:
        # C at P = 0 on what K takes to nothing, from the right and from the left
        rows, columns = kernel(still), kernel(still.transpose()).transpose()
        sides = _only_zeros(rows * C[0]), _only_zeros(C[0] * columns)
        meeting = all(_only_zeros(rows * X * columns) for X in C[1:2])
        apart, touching = any(sides), all(sides) and meeting and not _only_zeros(C[0])
    highest, even = 2 * n - _lost(M, C, K), not C or _skew(M, C, K) or _signed(M, C, K)
    return Degrees(highest - (highest % 2 if even else 0), even, resting, apart, touching)


def of_entries(M: Held, C: Held, K: Held) -> Degrees:
    """The same where it is known only which entries are not nothing, as in matrices of balls.

    A row, or a column, gives the determinant no higher power of λ than it has. Rows of K_0 that are nothing are motions
    that rest.
    """
    n = len(K[0])
    turned = [[[list(column) for column in zip(*table, strict=True)] for table in powers] for powers in (M, C, K)]
    highest, rest = 2 * n, list[list[int]]()
    for m, c, k in ((M, C, K), (turned[0], turned[1], turned[2])):
        any_M, any_C = ([any(any(table[i]) for table in powers) for i in range(n)] for powers in (m, c))
        highest = min(highest, sum(2 if one else int(other) for one, other in zip(any_M, any_C, strict=True)))
        rest.append([i for i in range(n) if not any(k[0][i])])
    sides = [
        not any(any(table[i]) for i in rows) for of, rows in ((C, rest[0]), (turned[1], rest[1])) for table in of[:1]
    ]
    even = not C or _two_signs(n, [(M + K, 1), (C, -1)])
    return Degrees(highest - (highest % 2 if even else 0), even, min(map(len, rest)), any(sides) or not C)


def _lost(M: Terms, C: Terms, K: Terms) -> int:
    """Powers of λ that are missing from 2n; as many as the largest k gives that still adds some."""
    n, none = K[0].nrows(), fmpq_mat(K[0].nrows(), K[0].nrows())
    if M[0].det() != 0:
        return 0
    most, found = max(map(len, (M, C, K))), 0
    for k in range(LONGEST_CHAIN):
        entries = []
        for row in range((k + 1) * n):
            i, r = divmod(row, n)  # row r of u_i
            line: list[fmpq] = []
            for order in range(k + 1):
                terms = (M, C, K)[order - i] if 0 <= order - i < 3 else []
                for power in range(most):
                    X = terms[power] if power < len(terms) else none
                    line += [X[r, c] for c in range(n)]
            entries.append(line)
        rows = fmpq_mat(entries)
        missing = rows.nrows() - rows.rank()
        if missing == found:
            break
        found = missing
    return found


def kernel(A: fmpq_mat) -> fmpq_mat:
    """Rows u with u A = 0, and a row of zeros."""
    found, count = A.transpose().numer_denom()[0].nullspace()
    n = A.nrows()
    return fmpq_mat([*([fmpq(found[i, k]) for i in range(n)] for k in range(count)), [fmpq(0)] * n])


def _only_zeros(A: fmpq_mat) -> bool:
    return all(v == 0 for v in A.entries())


def _skew(M: Terms, C: Terms, K: Terms) -> bool:
    return all(X == X.transpose() for X in M + K) and all(X == -X.transpose() for X in C)


def _signed(M: Terms, C: Terms, K: Terms) -> bool:
    """Whether signs can be found."""
    held = [[[[v != 0 for v in row] for row in X.tolist()] for X in terms] for terms in (M + K, C)]
    return _two_signs(K[0].nrows(), [(held[0], 1), (held[1], -1)])


def _two_signs(n: int, linked: list[tuple[Held, int]]) -> bool:
    """From one coordinate to all that are linked with it, of the same sign or of the other, again and again."""

    def links(i: int) -> Iterator[tuple[int, int]]:
        for terms, product in linked:
            yield from ((j, product) for j in range(n) if any(X[i][j] or X[j][i] for X in terms))

    sign: list[int] = [0] * n
    for start in range(n):
        if sign[start]:
            continue
        sign[start], reached = 1, [start]
        for i in reached:  # which grows
            for j, product in links(i):
                if not sign[j]:
                    sign[j] = product * sign[i]
                    reached.append(j)
                elif sign[j] != product * sign[i]:
                    return False
    return True
