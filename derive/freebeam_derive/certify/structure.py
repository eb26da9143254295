"""What holds exactly of det(λ² M + λ C + K) of fractions: balls cannot tell a zero from a small number. Of balls that
follows from the entries that are exactly nothing (`of_balls`).

A coordinate without mass lowers the degree in λ. With μ = 1/λ the determinant is λ^(2n) det(M + μ C + μ² K), and a
matrix polynomial A(μ) whose determinant vanishes at μ = 0 has there a zero of an order that is at least the number of
independent v(μ) = v_0 + … + v_k μ^k with A(μ) v(μ) = O(μ^(k+1)). Those that serve every power of the load are counted.

A gyroscopic column without damping has no odd powers of λ: transposed, or with the signs of some coordinates changed,
its matrices are those of −λ.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from flint import fmpq, fmpq_mat

LONGEST_CHAIN = 4
"""Powers of μ looked at, and one: a degree that is taken too high is not used up by roots, and nothing is proven."""
Rational = Any
"""An array of fractions, (n, n)."""


@dataclass(frozen=True)
class Structure:
    """degree: the highest power of λ at most. even: there are no odd ones. rests: how many motions K has no stiffness
    for at P = 0; left_alone: C does not act on them there, or nothing of C acts along them; tangent: neither, and to
    first order in P nothing of C acts on them along them, so that their damping is of second order in P."""

    degree: int
    even: bool
    rests: int = 0
    left_alone: bool = False
    tangent: bool = False

    def shared(self, count: int) -> Structure:
        """That of each of so many parts of which it holds exactly alike, those of the roots of one polynomial."""
        return replace(self, degree=self.degree // count, rests=self.rests // count)

    def vanishes(self, a: int, power: int) -> bool:
        """Whether P^a λ^power has no part in the determinant, because of the motions that rest at P = 0.

        Each takes a row whose terms are all of the first order in P and λ; left alone by C, of the second in λ or
        first in P, where the rest of its row is.
        """
        return 2 * a + power < 2 * self.rests if self.left_alone else a + power < self.rests


@dataclass(frozen=True)
class Beside:
    """What there is beside damping ε C that vanishes, of det(λ² M + λ (G + ε C) + K + ε S), by powers of the load:
    rates G that stay, and what the damping does on displacements, S. Without damping there are no odd powers of λ.

    letters: G and S of matrices in balls, as fractions that stand with the same products of names.
    """

    G: list[Rational]
    S: list[Rational]
    letters: tuple[list[Rational], list[Rational]] | None = None

    @property
    def acts(self) -> bool:
        """Whether the damping acts on displacements."""
        return any(held(X).any() for X in self.S)

    def taken(self, at: Any) -> Beside | None:
        """Of some rows and columns; None where there is nothing in these."""
        G, S, *others = ([X[at] for X in terms] for terms in (self.G, self.S, *(self.letters or ())))
        if not any(held(X).any() for X in (*G, *S)):
            return None
        return Beside(G, S, (others[0], others[1]) if others else None)


def structure(M: Sequence[Rational], C: Sequence[Rational], K: Sequence[Rational]) -> Structure:
    """Of matrices by powers of the load; C empty without damping."""
    C = [] if all(map(_is_nothing, C)) else list(C)
    right, left = null_space(K[0]), null_space(K[0].T)
    sides = [_is_nothing(X) for X in (C[0] @ right, left.T @ C[0])] if C else [True]
    tangent = bool(C) and right.shape[1] > 0 and not _is_nothing(C[0]) and all(sides)
    tangent = tangent and all(_is_nothing(left.T @ X @ right) for X in C[1:2])
    even, most = is_even(M, C, K), degree(M, C, K)
    return Structure(most - most % 2 if even else most, even, right.shape[1], any(sides), tangent)


def of_balls(M: Sequence[Any], C: Sequence[Any], K: Sequence[Any], even: bool = False) -> Structure:
    """The same of matrices some of whose entries are balls, by the entries that are exactly nothing.

    even: there is known to be no odd power of λ; else that is decided by these entries too. A row takes no higher power
    of λ than its matrices give it, and so does a column. A row of K that is nothing at P = 0 is one of a motion that
    rests.
    """
    C = [] if all(map(_is_nothing, C)) else list(C)
    of_M, of_C = (np.any([held(X) for X in (*terms, 0 * K[0])], axis=0) for terms in (M, C))
    most = min(int(np.where(of_M.any(axis=k), 2, of_C.any(axis=k)).sum()) for k in (0, 1))
    still = [~held(K[0]).any(axis=k) for k in (1, 0)]  # rows, and columns
    rests = int(min(side.sum() for side in still))
    sides = [not held(C[0])[still[0]].any(), not held(C[0])[:, still[1]].any()] if C else [True]
    even = even or is_even(M, C, K)
    return Structure(most - most % 2 if even else most, even, rests, any(sides))


def held(X: Any) -> Any:
    """Where a matrix of fractions or balls is not known to be nothing, booleans."""
    return np.array([not v == 0 for v in X.flat], dtype=bool).reshape(X.shape)


def _is_nothing(X: Any) -> bool:
    return not held(X).any()


def null_space(A: Rational) -> Rational:
    """Vectors that a matrix takes to nothing, as columns."""
    whole, rank = fmpq_mat(A.tolist()).rref()
    n = A.shape[1]
    leading = [next(j for j in range(n) if whole[i, j] != 0) for i in range(rank)]
    free = [j for j in range(n) if j not in leading]
    found = np.full((n, len(free)), fmpq(0), dtype=object)
    for k, j in enumerate(free):
        found[j, k] = fmpq(1)
        for i, pivot in enumerate(leading):
            found[pivot, k] = -whole[i, j]
    return found


def degree(M: Sequence[Rational], C: Sequence[Rational], K: Sequence[Rational]) -> int:
    """The highest power of λ at most; 0 or less where the determinant vanishes altogether."""
    n, powers = len(M[0]), max(len(M), len(C), len(K))
    if fmpq_mat(M[0].tolist()).det() != 0:
        return 2 * n
    none = np.full((n, n), fmpq(0), dtype=object)
    A = [np.concatenate([X[a] if a < len(X) else none for a in range(powers)]) for X in (M, C, K)]
    order = 0
    for k in range(LONGEST_CHAIN):
        rows = [[A[j - i] if 0 <= j - i < 3 else 0 * A[0] for i in range(k + 1)] for j in range(k + 1)]
        more = n * (k + 1) - fmpq_mat(np.block(rows).tolist()).rank()
        if more == order:
            break
        order = more
    return 2 * n - order


def is_even(M: Sequence[Rational], C: Sequence[Rational], K: Sequence[Rational]) -> bool:
    """Whether the determinant is known to have no odd powers of λ."""
    if all(map(_is_nothing, C)) or (all((X == X.T).all() for X in (*M, *K)) and all((X == -X.T).all() for X in C)):
        return True
    like, unlike = (np.any([held(X) | held(X).T for X in terms], axis=0) for terms in ((*M, *K), C))
    signs = np.zeros(len(M[0]), dtype=int)
    for first in range(len(signs)):
        waiting, signs[first] = ([], signs[first]) if signs[first] else ([first], 1)
        while waiting:
            i = waiting.pop()
            for linked, sign in ((like[i], signs[i]), (unlike[i], -signs[i])):
                waiting += np.flatnonzero(linked & (signs == 0)).tolist()
                signs[linked & (signs == 0)] = sign
                if (signs[linked] != sign).any():
                    return False
    return True
