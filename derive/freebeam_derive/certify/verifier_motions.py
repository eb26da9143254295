"""What the verifier knows of motions that all matrices leave to themselves, by what commutes with all of them.

Let B = G⁻¹X for each matrix X, G regular, and T B = B T for all of them, T of fractions. Let the product of the
different factors g of det(x − T) over the fractions take T to nothing. Then the null spaces of all g(T) are all
motions, each left to itself by every B, and det Σ c X is a product of factors, one for each g.

Let g be of degree d, all its roots real, and v_1, …, v_s such that T^l v_j, l < d, are a basis of the null space of
g(T). There B v_j = Σ_l Σ_i B_l,ij T^l v_i. For a root r and h = g/(x − r) the h(T) v_j are a basis of the null space of
T − r, and h(T) times the equation says that B is Σ_l r^l B_l there. So the factor of g is the product of those of its
roots. Whether a polynomial in r with fractions vanishes is alike for all of them: degrees, ranks, and what is nothing,
are had from the whole of g, in fractions.

Where M and K are symmetric, G a sum of them, C skew and G T symmetric, the null spaces of T − r are G-orthogonal to one
another, G is regular on each, and its determinant is even in λ: transposed, the matrices are those of −λ.

Let W commute with all B. Where a basis of the null space of T − r, taken by W, has a regular product with one of that
of the transposed T − r', W and a polynomial of T take the one motions to all of the others: there the B are the same,
in other bases.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cmp_to_key
from typing import Any

import flint
from flint import arb, arb_mat, fmpq, fmpq_mat, fmpq_poly, fmpz, nmod_mat

from freebeam_derive.certify.verifier_claims import require

Terms = list[list[fmpq_mat]]  # M, C and K, each by powers of the load
MOST_PRIMES = 8  # of 61 bits; one sufficed for all of the tests
SUMS = 24  # of what commutes: as many as are tried for real roots
BITS = 500  # to tell roots, and parts, apart


@dataclass(frozen=True)
class Motion:
    """M, C and K, with the row of the whole that each row stands for. g: they are of all its roots, of which a number
    is meant. kind: shared by those that are the same. even: the determinant is known to be even in λ."""

    terms: Terms
    stands: list[int]
    g: fmpq_poly | None = None
    number: int = 0
    even: bool = False
    kind: int = -1

    @property
    def count(self) -> int:
        """Into how many the motions of `terms` are taken apart."""
        return int(self.g.degree()) if self.g else 1

    def matrices(self) -> list[list[arb_mat]]:
        """M, C and K of the motion alone, at the precision in hand."""
        if not self.g:
            return [[arb_mat(X) for X in powers] for powers in self.terms]
        r, s = real_roots(self.g)[self.number], self.terms[0][0].nrows() // self.count

        def at(X: fmpq_mat) -> arb_mat:
            blocks = (fmpq_mat([[X[k * s + i, j] for j in range(s)] for i in range(s)]) for k in range(self.count))
            return sum((r**k * arb_mat(block) for k, block in enumerate(blocks)), arb_mat(s, s))

        return [[at(X) for X in powers] for powers in self.terms]


def real_roots(g: fmpq_poly) -> list[arb]:
    """All roots, ascending; none where not all are real."""
    pairs: list[Any] = g.numer().complex_roots()
    real = all(root.imag == 0 for root, _ in pairs)
    return sorted((root.real for root, _ in pairs), key=arb.mid) if real else []


def motions(terms: Terms, limit: bool) -> list[Motion]:
    """Those that leave each other alone, in an order of their own. limit: of vanishing damping, where determinants need
    not be even."""
    M, C, K = terms
    G = sum((X / (2 * k + 3) for k, X in enumerate(M + K)), 0 * K[0])
    require(G.det() != 0, "the motions cannot be told apart")
    inverse = G.inv()
    B = [inverse * X for X in M + C + K if any(X.entries())]
    algebra = commuting(B)
    if not algebra:
        return [Motion(terms, list(range(G.nrows())))]
    rates = not limit and any(any(X.entries()) for X in C)
    side = -1 if rates else 1
    symmetric = all(X == X.transpose() for X in M + K) and all(X == side * X.transpose() for X in C)
    tried = [*algebra, *(_combined(algebra, k) for k in range(SUMS))]
    if symmetric:  # and what commutes is so with this too, for G T = T^T G
        tried = [T + inverse * T.transpose() * G for T in tried]
    with flint.ctx.workprec(BITS):
        each = [(T, _factors(T, symmetric or not rates)) for T in tried]
        T, factors = max(each, key=lambda item: sum(d for _, d in item[1]))
        if sum(d for _, d in factors) < 2:
            return [Motion(terms, list(range(G.nrows())))]
        fits = all(X * T == T * X for X in B) and (not symmetric or G * T == (G * T).transpose())
        require(fits, "the motions are not left to themselves")
        V = [_generators(T, g) if d > 1 else _null(g, T) for g, d in factors]
        whole = [_beside(_powers(T, of, d)) for of, (_, d) in zip(V, factors, strict=True)]
        basis = _beside(whole)
        require(basis.nrows() == basis.ncols() and basis.det() != 0, "the motions are not all motions")
        dual, low = (G * basis).inv(), 0
        found: list[tuple[Motion, arb_mat | None, arb_mat | None]] = []
        for of, (g, d) in zip(whole, factors, strict=True):
            rows = range(low, low + of.ncols())
            left = fmpq_mat([[dual[i, j] for j in range(G.nrows())] for i in rows])
            if symmetric and d == 1:
                left = of.transpose()
            own = [[left * X * of for X in powers] for powers in terms]
            last = [max(i for i in range(G.nrows()) if of[i, j] != 0) for j in range(of.ncols())]
            for k in range(d):
                motion = Motion(own, last, g if d > 1 else None, k, symmetric and rates)
                spaces = [_space(A, g, k) if d == g.degree() else None for A in (T, T.transpose())]
                found.append((motion, spaces[0], spaces[1]))
            low += of.ncols()
        return sorted(_alike(found, _combined(algebra, SUMS)), key=cmp_to_key(_before))


def in_other_coordinates(one: Terms, other: Terms) -> fmpq | None:
    """λ² of another over those of one, at every load, where M, C and K, or all transposed, are those of one in other
    coordinates, K times that number without C; None where that is not known."""
    if [*map(len, one)] != [*map(len, other)] or one[2][0].nrows() != other[2][0].nrows():
        return None
    flat = [[X for powers in of for X in powers] for of in (one, other)]
    adjoint = [X.transpose() for X in flat[1]]  # of the same determinant
    if alike(flat[0], flat[1]) or alike(flat[0], adjoint):
        return fmpq(1)
    if any(any(X.entries()) for of in (one, other) for X in of[1]) or one[0][0].det() == 0 or other[0][0].det() == 0:
        return None
    first, second = (sum((X for X in of[2][1:]), of[2][0]) for of in (one, other))
    traces = [_trace(of[0][0].inv() * X) for of, X in ((one, first), (other, second))]
    if traces[0] == 0 or traces[1] / traces[0] <= 0:
        return None
    factor = traces[1] / traces[0]
    scaled = [*one[0], *one[1], *(X * factor for X in one[2])]
    return factor if alike(scaled, flat[1]) or alike(scaled, adjoint) else None


def _trace(X: fmpq_mat) -> fmpq:
    return sum((X[i, i] for i in range(X.nrows())), fmpq(0))


# --- what commutes with all matrices ------------------------------------------------------------------------------


def alike(one: list[fmpq_mat], other: list[fmpq_mat]) -> bool:
    """Whether det Σ c X of some matrices is that of others, times a number: each G⁻¹X is T⁻¹ (H⁻¹Y) T, G and H the same
    sum of either. No wherever no T is found."""
    G, H = (sum((X / (2 * k + 3) for k, X in enumerate(of)), 0 * of[0]) for of in (one, other))
    if G.det() == 0 or H.det() == 0:
        return False
    B, A = ([of_sum.inv() * X for X in of] for of_sum, of in ((G, one), (H, other)))
    found = commuting(B, A)
    return any(T.det() != 0 for T in [*found, *(_combined(found, k) for k in range(SUMS) if found)])


def commuting(B: list[fmpq_mat], A: list[fmpq_mat] | None = None) -> list[fmpq_mat]:
    """Matrices T without trace that commute with all of B, independent ones; with any trace and A T = T B, of each two
    of A and B, where there is an A. None where there are none, or where none are found.

    They are had modulo primes; that they are such is checked in fractions.
    """
    n, total, residues = B[0].nrows(), 1, list[int]()
    primes = (p for p in range(2**61 + 1, 2**61 + 100_000, 2) if fmpz(p).is_prime())
    for _, p in zip(range(MOST_PRIMES), primes, strict=False):
        if any(int(v.q) % p == 0 for X in B + (A or []) for v in X.entries()):
            continue
        reduced = [
            [nmod_mat(n, n, [int(v.p) * pow(int(v.q), -1, p) for v in X.entries()], p) for X in of]
            for of in (B, A or B)
        ]
        found = _commuting_modulo(reduced[0], reduced[1], p, A is None)
        if not found:
            return []
        if len(found) != len(residues):
            total, residues = 1, [0] * len(found)
        step = pow(total, -1, p)
        residues = [a + total * ((b - a) * step % p) for a, b in zip(residues, found, strict=True)]
        total *= p
        entries = [_rational(a, total) for a in residues]
        algebra = [fmpq_mat(n, n, entries[k : k + n * n]) for k in range(0, len(entries), n * n)]
        if all(Y * T == T * X for X, Y in zip(B, A or B, strict=True) for T in algebra):
            return algebra
    return []


def _commuting_modulo(B: list[nmod_mat], A: list[nmod_mat], p: int, without: bool) -> list[int]:
    """Entries of a basis in echelon form. From some motions v all others come by products b of matrices B, for which
    T b v = a T v, a the same product of A; T v is what T X e = Y T e leaves free, for some motions e. Empty where that
    is nothing. without: a trace."""
    n = B[0].nrows()

    def column(k: int) -> nmod_mat:
        return nmod_mat(n, 1, [pow(k + 2, i + 3, p) for i in range(n)], p)

    one = nmod_mat(n, n, [int(i == j) for i in range(n) for j in range(n)], p)
    start, made, reached = list[nmod_mat](), list[tuple[int, nmod_mat]](), list[nmod_mat]()
    pairs = list(zip(B, A, strict=True))
    while len(reached) < n and len(start) < 2 * n:
        v = column(len(start))
        start.append(v)
        waiting = [(one, one)]
        for b, a in waiting:  # which grows
            if len(reached) < n and _beside([*reached, b * v]).rank() > len(reached):
                reached.append(b * v)
                made.append((len(start) - 1, a))
                waiting += [(X * b, Y * a) for X, Y in pairs]
    if len(reached) < n:
        return []
    back = _beside(reached).inv()

    def of(u: nmod_mat) -> Any:
        """T u over T v, for each v."""
        parts, factors = [0 * one for _ in start], back * u
        for k, (i, a) in enumerate(made):
            parts[i] += factors[k, 0] * a
        return _beside(parts)

    rows = [
        (of(X * e) - Y * of(e)).transpose() for e in map(column, range(2 * n, 2 * n + len(start))) for X, Y in pairs
    ]
    free, count = _beside(rows).transpose().nullspace()
    found = []
    for k in range(count):
        images = [nmod_mat(n, 1, [free[n * i + j, k] for j in range(n)], p) for i in range(len(start))]
        T = _beside([a * images[i] for i, a in made]) * back
        trace = sum(int(T[i, i]) for i in range(n)) * pow(n, -1, p) % p if without else 0
        found += (T - trace * one).entries()
    echelon, rank = nmod_mat(count, n * n, found, p).rref()
    return [int(v) for v in echelon.entries()[: rank * n * n]]


def _rational(a: int, modulus: int) -> fmpq:
    """A fraction that is a for a modulus, of a numerator no larger than its root."""
    one, other = (modulus, 0), (a, 1)
    while other[0] ** 2 > modulus:
        quotient = one[0] // other[0]
        one, other = other, (one[0] - quotient * other[0], one[1] - quotient * other[1])
    return fmpq(*other)


def _beside(columns: list[Any]) -> Any:
    n = columns[0].nrows()
    entries = [X[i, j] for i in range(n) for X in columns for j in range(X.ncols())]
    if isinstance(columns[0], nmod_mat):
        return nmod_mat(n, len(entries) // n, entries, columns[0].modulus())
    return fmpq_mat(n, len(entries) // n, entries)


# --- its null spaces ------------------------------------------------------------------------------------------------


def _combined(algebra: list[fmpq_mat], k: int) -> fmpq_mat:
    factors = (pow(n + 3, k + 2, 103) - 51 for n in range(len(algebra)))
    return sum((factor * T for factor, T in zip(factors, algebra, strict=True)), 0 * algebra[0])


def _factors(T: fmpq_mat, apart: bool) -> list[tuple[fmpq_poly, int]]:
    """Different factors whose product takes T to nothing, and how many parts each makes; apart: one for a root."""
    found = [g for g, _ in T.charpoly().factor()[1]]
    whole = _of(fmpq_poly([1]), T)
    for g in found:
        whole *= _of(g, T)
    if any(whole.entries()):
        return []
    return [(g, len(real_roots(g)) if apart and real_roots(g) else 1) for g in found]


def _of(g: fmpq_poly, T: fmpq_mat) -> fmpq_mat:
    """A polynomial of a matrix."""
    n = T.nrows()
    one = fmpq_mat([[fmpq(int(i == j)) for j in range(n)] for i in range(n)])
    whole = 0 * T
    for factor in reversed(g.coeffs()):
        whole = T * whole + factor * one
    return whole


def _null(g: fmpq_poly, T: fmpq_mat) -> list[fmpq_mat]:
    """A basis of the null space of g(T), each with a last entry 1 that no other has."""
    n = T.nrows()
    found, count = _of(g, T).numer_denom()[0].nullspace()
    back = fmpq_mat([[fmpq(found[i, k]) for i in reversed(range(n))] for k in range(count)]).rref()[0]
    return [fmpq_mat(n, 1, [back[k, i] for i in reversed(range(n))]) for k in range(count)]


def _powers(T: fmpq_mat, vectors: list[fmpq_mat], count: int) -> list[fmpq_mat]:
    """All vectors, then T times all of them, and so on."""
    return vectors + (_powers(T, [T * v for v in vectors], count - 1) if count > 1 else [])


def _generators(T: fmpq_mat, g: fmpq_poly) -> list[fmpq_mat]:
    """Vectors v for which the T^l v, l below g's degree, are independent, as many as the null space of g(T) has."""
    d, found = g.degree(), list[fmpq_mat]()
    for v in _null(g, T):
        if _beside(_powers(T, [*found, v], d)).rank() == d * (len(found) + 1):
            found.append(v)
    return found


def _space(T: fmpq_mat, g: fmpq_poly, number: int) -> arb_mat:
    """The null space of T − r, r a root of g."""
    roots, d = real_roots(g), g.degree()
    quotient, vectors = [arb(1)], _beside(_generators(T, g))
    for k in range(d - 1, 0, -1):  # g is monic
        quotient.insert(0, quotient[0] * roots[number] + g[k] / g[d])
    total = arb_mat(vectors.nrows(), vectors.ncols())
    for factor in quotient:
        total, vectors = total + factor * arb_mat(vectors), T * vectors
    return total


def _alike(found: list[tuple[Motion, arb_mat | None, arb_mat | None]], W: fmpq_mat) -> list[Motion]:
    """Each with its kind: that of the first to which W takes it, all of it."""
    kinds: list[int] = []
    for k, (_, right, _) in enumerate(found):
        for j, (_, _, left) in enumerate(found[:k]):
            if right is None or left is None or kinds[j] != j or left.ncols() != right.ncols():
                continue
            if (left.transpose() * (arb_mat(W) * right)).det() != 0:
                kinds.append(j)
                break
        else:
            kinds.append(k)
    return [replace(motion, kind=kind) for (motion, _, _), kind in zip(found, kinds, strict=True)]


def _before(one: Motion, other: Motion) -> int:
    """Which comes first: by size, then by det(x (M_0 + K_0) − M_0), a monic polynomial, from its lowest factor on, then
    with the sum of all K for K_0; by the first numbers that are known to differ."""
    for a, b in zip(_marks(one), _marks(other), strict=False):
        if a < b or a > b:
            return -1 if a < b else 1
    return 0


def _marks(motion: Motion) -> list[arb]:
    (M, *_), _, K = motion.matrices()
    found = [arb(M.nrows())]
    for stiff in (K[0], sum(K[1:], K[0])):
        whole = M + stiff
        found += [] if whole.det().contains(0) else whole.solve(M).charpoly()
    return found
