"""Motions that only roots of polynomials tell apart, and those that are the same: four equal planes in a row, three in
a ring.

Let G be a sum of all matrices, and T of fractions commute with each G⁻¹X. Where T's minimal polynomial is a product of
different factors, the null spaces of each factor of T are all motions together, and each is left to itself. Where all
roots r of a factor g are real, the null space of g(T) is one of those of T − r. With v_1, …, v_s such that T^l v_j, l
below the degree of g, are a basis of it, G⁻¹X v_j is Σ_l T^l Σ_i X_l,ij v_i, and on the null space of T − r the
matrix is Σ_l r^l X_l: exact, but for the root, which a ball holds.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import count, islice
from typing import Any

import numpy as np
from flint import arb, arb_mat, fmpq, fmpq_mat, fmpq_poly, fmpz, nmod_mat

from freebeam_derive.certify.structure import null_space

Word = tuple[int, int]
"""A product b of matrices times one of some vectors v: which matrix times which earlier one, or −1 and which v."""
MOST_PRIMES = 8  # of 62 bits; one sufficed for all columns and systems of the tests
MOST_MATRICES, SUMS = 8, 4  # beyond so many, sums of all that stand for them until what joins them is found
TRIALS = 24  # sums of what commutes that are tried for real roots; of a random pair of planes half have them


@dataclass(frozen=True)
class Split:
    """Motions that all matrices leave to themselves: columns V, and rows U of which U X V are the matrices.

    roots: of a polynomial of degree d, in balls, that tell them apart further; then the first s columns of the
    matrices, n = d s, hold X_0, X_1, …, one below the other. None: they are not taken apart further. kinds: for each
    root, or all, a number that those share which are the same motions.
    """

    U: Any
    V: Any
    roots: list[arb]
    kinds: list[int]

    def at(self, k: int, X: Any) -> Any:
        """Of a root, that of a matrix U X V."""
        s = len(X) // len(self.roots)
        return sum(self.roots[k] ** row * X[row * s : row * s + s, :s] for row in range(len(self.roots)))


def splits(G: fmpq_mat, matrices: Sequence[fmpq_mat], symmetric: bool) -> list[Split]:
    """How all matrices fall into parts, G a sum of them; none where they do not. symmetric: each is, or is skew, and
    only a T that is symmetric with respect to G is looked for."""
    found = commuting(G, matrices)
    if not found:
        return []
    inverse = G.inv()
    # first one by one: of two shafts that counter-rotate these have fractions for eigenvalues, sums have roots
    tried = [*found, *(_sum(found, t) for t in range(TRIALS))]
    if symmetric:
        tried = [T + inverse * T.transpose() * G for T in tried]
    most, T, factors = 1, G, list[tuple[fmpq_poly, list[arb]]]()
    for each in tried:
        of = [(g, _real_roots(g)) for g, _ in each.charpoly().factor()[1]]
        parts = sum(len(roots) or 1 for _, roots in of)
        if parts > most and not any(_value([g for g, _ in of], each).entries()):
            most, T, factors = parts, each, of
    if not factors:
        return []
    spaces = [_generators(T, g) if roots else _columns(_value([g], T)) for g, roots in factors]
    bases = [_beside(_powers(T, of, len(r)) if r else of) for of, (_, r) in zip(spaces, factors, strict=True)]
    every = np.array((G * _beside(bases)).inv().tolist())  # as rows, that which takes all X to G⁻¹X in these bases
    # what commutes is no more than sums of powers of T where there are as many: then no two are the same
    kinds = _kinds(T, factors, _sum(found, TRIALS)) if len(found) >= most else range(most)
    numbers, result, low = iter(kinds), [], 0
    for basis, (_, roots) in zip(bases, factors, strict=True):
        high = low + basis.ncols()
        V, U = np.array(basis.tolist()), every[low:high]
        if len(roots) < 2:  # any rows of that span: so that it stays symmetric, or fractions are small
            U = V.T if symmetric else np.array(fmpq_mat(U.tolist()).rref()[0].tolist())
        result.append(Split(U, V, roots, [next(numbers) for _ in range(len(roots) or 1)]))
        low = high
    return result


def commuting(G: fmpq_mat, matrices: Sequence[fmpq_mat]) -> list[fmpq_mat]:
    """A basis of what commutes with all G⁻¹X and has no trace; none where none is found."""
    return _joining((G, matrices), None)


def alike(one: Sequence[fmpq_mat], other: Sequence[fmpq_mat]) -> bool:
    """Whether matrices X and Y, of the same number, are those of the same motions in other coordinates, but for a
    factor: Y T = H T G⁻¹ X with G and H a sum of them and T regular."""
    sums = [sum((X / (k + 1) for k, X in enumerate(of)), 0 * of[0]) for of in (one, other)]
    found = _joining((sums[0], one), (sums[1], other))
    return any(T.det() != 0 for T in [*found, *(_sum(found, t) for t in range(TRIALS) if found)])


def _joining(
    one: tuple[fmpq_mat, Sequence[fmpq_mat]], other: tuple[fmpq_mat, Sequence[fmpq_mat]] | None
) -> list[fmpq_mat]:
    """A basis of all T with H⁻¹Y T = T G⁻¹X for each two matrices X and Y; without another H and Y it is G and X, and T
    has no trace. None where none is found.

    Modulo primes, from which fractions are had; that T joins them is then checked. Where nothing does modulo a prime,
    nothing does in fractions.
    """
    (G, matrices), (H, others) = one, other or one
    n, q, known, words = G.nrows(), 1, [0], list[Word]()
    pairs = [(X, Y) for X, Y in zip(matrices, others, strict=True) if any(X.entries()) or any(Y.entries())]
    tried = pairs
    if len(pairs) > MOST_MATRICES:  # letters of balls: sums of all are more regular than each
        tried = [(_sum(X, t), _sum(Y, t)) for t in range(SUMS) for X, Y in [zip(*pairs, strict=True)]]
    inverse = None
    for prime in islice((p for p in count(1 << 62) if fmpz(p).is_prime()), MOST_PRIMES):
        try:
            small, *reduced = (_reduced(X, prime) for X in (G, *(X for X, _ in tried)))
            B = A = [small.solve(X) for X in reduced]
            if other:
                small, *reduced = (_reduced(Y, prime) for Y in (H, *(Y for _, Y in tried)))
                A = [small.solve(Y) for Y in reduced]
            words = words or _words(B, prime)
            rows = _modulo(B, A, words, prime, traces=other is not None)
        except ZeroDivisionError:
            continue  # a denominator, or a determinant, is a multiple of the prime
        if not rows:
            return []
        known = known if len(known) == len(rows) else [0] * len(rows)
        step = pow(q, -1, prime)
        known = [x + q * ((r - x) * step % prime) for x, r in zip(known, rows, strict=True)]
        q *= prime
        entries = [_fraction(x, q) for x in known]
        inverse = inverse or G.inv()
        found = [fmpq_mat(n, n, entries[k : k + n * n]) for k in range(0, len(entries), n * n)]
        if all(Y * T == left * X for T in found for left in [H * T * inverse] for X, Y in pairs):
            return found
    return []


def _reduced(X: fmpq_mat, prime: int) -> nmod_mat:
    if any(int(x.q) % prime == 0 for x in X.entries()):
        raise ZeroDivisionError
    return nmod_mat(X.nrows(), X.ncols(), [int(x.p) * pow(int(x.q), -1, prime) for x in X.entries()], prime)


def _vector(n: int, k: int, prime: int) -> nmod_mat:
    """Numbers without a pattern that a column would share."""
    return nmod_mat(n, 1, [(7 + 4 * k) * (i + 1) ** 3 % 61 - 30 for i in range(n)], prime)


def _words(B: Sequence[nmod_mat], prime: int) -> list[Word]:
    """Of which vectors b v are a basis."""
    n, start, vectors, words = B[0].nrows(), 0, list[nmod_mat](), list[Word]()
    while len(words) < n and start < 3 * n:
        more = [(-1, start)]
        while more:
            tried = [*vectors, *(_vector(n, j, prime) if k < 0 else B[k] * vectors[j] for k, j in more)]
            echelon, rank = _beside(tried).rref()
            leading = [next(j for j in range(len(tried)) if echelon[i, j] != 0) for i in range(rank)]
            before = len(vectors)
            words += [more[j - before] for j in leading[before:]]
            vectors = [tried[j] for j in leading]
            more = [(k, j) for j in range(before, len(vectors)) for k in range(len(B))]
        start += 1
    return words


def _modulo(B: Sequence[nmod_mat], A: Sequence[nmod_mat], words: Sequence[Word], prime: int, traces: bool) -> list[int]:
    """The entries of a basis of all T with A T = T B, without a trace unless it may have one, reduced to echelon form.

    T is known by all w = T v, for T b v = a w, with a the same product of matrices A as b is of B. Equations for these
    are that T B e = A T e for some vectors e and each two matrices.
    """
    n, starts = B[0].nrows(), [j for k, j in words if k < 0]
    if len(words) < n:
        return []
    one = nmod_mat(n, n, [int(i == j) for i in range(n) for j in range(n)], prime)
    products: list[tuple[int, nmod_mat, nmod_mat]] = []  # the number of v, b, and a
    for k, j in words:
        i, b, a = (starts.index(j), one, one) if k < 0 else products[j]
        products.append((i, b, a) if k < 0 else (i, B[k] * b, A[k] * a))
    basis = _beside([b * _vector(n, starts[i], prime) for i, b, _ in products])

    def image(u: nmod_mat) -> Any:
        """T u as a matrix times all w."""
        factors, found = basis.solve(u), [0 * one for _ in starts]
        for j, (i, _, a) in enumerate(products):
            found[i] += factors[j, 0] * a
        return _beside(found)

    places = [_vector(n, 3 * n + k, prime) for k in range(len(starts))]
    pairs = list(zip(B, A, strict=True))
    rows = _beside([(image(X * e) - Y * image(e)).transpose() for X, Y in pairs for e in places]).transpose()
    free, size = rows.nullspace()
    inverse, found = basis.inv(), []
    for k in range(size):
        w = [nmod_mat(n, 1, [free[n * i + j, k] for j in range(n)], prime) for i in range(len(starts))]
        T = _beside([a * w[i] for i, _, a in products]) * inverse
        trace = 0 if traces else sum(int(T[i, i]) for i in range(n)) * pow(n, -1, prime)
        found.append((T - trace % prime * one).entries())
    whole, rank = nmod_mat(size, n * n, [x for row in found for x in row], prime).rref()
    return [int(x) for x in whole.entries()[: rank * n * n]]


def _fraction(x: int, q: int) -> fmpq:
    """A fraction of small numerator, and denominator if it can be, that is x modulo q."""
    (a, s), (b, t) = (q, 0), (x, 1)
    while 2 * b * b > q:
        a, b, s, t = b, a % b, t, s - a // b * t
    return fmpq(b, t)


def _one(n: int) -> fmpq_mat:
    return fmpq_mat([[int(i == j) for j in range(n)] for i in range(n)])


def _beside(columns: Sequence[Any]) -> Any:
    """Matrices of one height as one, of fractions or modulo a prime."""
    n = columns[0].nrows()
    entries = [X[i, j] for i in range(n) for X in columns for j in range(X.ncols())]
    size = n, len(entries) // n, entries
    return nmod_mat(*size, columns[0].modulus()) if isinstance(columns[0], nmod_mat) else fmpq_mat(*size)


# --- what commutes, taken apart -----------------------------------------------------------------------------------


def _sum(found: Sequence[fmpq_mat], t: int) -> fmpq_mat:
    return sum((T * (pow(k + 2, t + 1, 101) - 50) for k, T in enumerate(found)), 0 * found[0])


def _real_roots(g: fmpq_poly) -> list[arb]:
    """All roots, none where not all are real."""
    found: list[Any] = g.numer().complex_roots()
    return [root.real for root, _ in found] if all(root.imag == 0 for root, _ in found) else []


def _columns(X: fmpq_mat) -> list[fmpq_mat]:
    """A basis of the null space."""
    return [fmpq_mat(X.ncols(), 1, w.tolist()) for w in null_space(np.array(X.tolist())).T]


def _value(factors: Sequence[fmpq_poly], T: fmpq_mat) -> fmpq_mat:
    """A product of polynomials of a matrix."""
    whole, one = _one(T.nrows()), _one(T.nrows())
    for g in factors:
        value = 0 * T
        for factor in reversed(g.coeffs()):
            value = value * T + factor * one
        whole = whole * value
    return whole


def _generators(T: fmpq_mat, g: fmpq_poly) -> list[fmpq_mat]:
    """Vectors v whose T^l v, l below the degree of g, are a basis of the null space of g(T)."""
    found: list[fmpq_mat] = []
    for v in _columns(_value([g], T)):
        more = [*found, v]
        if _beside(_powers(T, more, g.degree())).rank() == len(more) * g.degree():
            found = more
    return found


def _powers(T: fmpq_mat, vectors: Sequence[fmpq_mat], count: int) -> list[fmpq_mat]:
    found = [list(vectors)]
    for _ in range(count - 1):
        found.append([T * v for v in found[-1]])
    return [v for power in found for v in power]


def _kinds(T: fmpq_mat, factors: Sequence[tuple[fmpq_poly, list[arb]]], W: fmpq_mat) -> list[int]:
    """Numbers of kinds, by roots: W commutes with all matrices, and where it takes the null space of T − r to one that
    is regular on that of T − r', both are the same motions."""
    right, left = ([space for g, r in factors for space in _null_spaces(A, g, r)] for A in (T, T.transpose()))
    found: list[int] = []

    def same(one: arb_mat | None, other: arb_mat | None) -> bool:
        if one is None or other is None or one.ncols() != other.ncols():
            return False
        return not (other.transpose() * (arb_mat(W) * one)).det().contains(0)

    for k, space in enumerate(right):
        found.append(next((j for j in range(k) if found[j] == j and same(space, left[j])), k))
    return found


def _null_spaces(T: fmpq_mat, g: fmpq_poly, roots: Sequence[arb]) -> list[arb_mat | None]:
    """Of T − r for each root r of g, g(T)/(T − r) on vectors whose T^l v are a basis of the null space of g(T); None
    for a factor without real roots."""
    if not roots:
        return [None]
    vectors = _beside(_generators(T, g))
    result: list[arb_mat | None] = []
    for r in roots:
        total, factor = arb_mat(vectors.nrows(), vectors.ncols()), arb(0)
        power, factors = vectors, []
        for c in reversed(g.coeffs()[1:]):
            factor = factor * r + c
            factors.append(factor)
        for factor in reversed(factors):
            total += factor * arb_mat(power)
            power = T * power
        result.append(total)
    return result
