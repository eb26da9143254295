"""Motions that leave each other alone: matrices that fall into parts, each with its own determinant.

Frequencies of different parts may pass through one another: their determinants' product has a double root there, and
nothing happens. So each part is proven by itself. Parts are told by names of fields and coordinates, and where that is
not enough by what all matrices leave to itself (the sum and the difference of two planes that are coupled
symmetrically, what is even and what is odd about the middle): exactly, in fractions.

Of a part of two planes that are alike and that rates alone couple, M ÿ + B ż + K y = 0 and M z̈ − B ẏ + K z = 0, is
w = y ± iz with w = e^(iωt) of det(K − ωB − ω² M) = 0, or of the same at −ω. Seen from a frame that turns at a rate c,
with s = ω + c, that is A_0 + s A_1 − s² M, A_0 = K + cB − c² M, A_1 = 2cM − B. Where A_1 is nothing the theorem is one
of s²; else one of s itself, with c so large that all s are positive.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import combinations, permutations, zip_longest
from typing import Any

import numpy as np
from flint import arb, fmpq, fmpq_mat, fmpq_poly, nmod_mat

from freebeam_derive.certify.structure import held, is_even, null_space

Powers = list[Any]
"""A matrix of fractions by powers of the load, arrays (n, n)."""
Planes = tuple[tuple[str, ...], tuple[str, ...]]
PRIMES = (1_000_003, 1_000_033, 1_000_037, 1_000_039, 1_000_081, 1_000_099, 1_000_117, 1_000_121, 1_000_133, 1_000_151)
MOST_PLANES = 6  # names among which two planes are looked for; the ways to pair them are counted in hundreds then


@dataclass(frozen=True)
class Part:
    """names of its fields and coordinates; M, C, K. motion: which one it is of those that share these names, in the
    order of `_place`. planes: two that are alike, of which M and K are one's as seen from a frame that turns at the
    rate turn; whirls: as a problem in s = ω + turn, else in its square."""

    names: tuple[str, ...]
    M: Powers
    C: Powers
    K: Powers
    motion: int = 0
    planes: Planes | None = None
    turn: Fraction = Fraction(0)
    whirls: bool = False

    def same(self, other: Part) -> bool:
        """Whether it is another part again: the same matrices, but for one factor."""
        pairs = [(self.M, other.M), (self.C, other.C), (self.K, other.K)]
        if self.turn != other.turn or any([X.shape for X in a] != [X.shape for X in b] for a, b in pairs):
            return False
        one, two = (np.concatenate([X.ravel() for pair in pairs for X in pair[side]]) for side in (0, 1))
        k = int(np.flatnonzero(one != 0)[0])
        return bool(two[k] != 0 and (one * two[k] == two * one[k]).all())


def split(M: Powers, C: Powers, K: Powers, names: Sequence[str], limit: bool, rest: bool) -> list[Part]:
    """The parts, in the order of their names; one where damping is finite, with which frequencies may cross as they
    are, and where a part had no mass. Where not all is exact parts are those of names alone.

    names: of the field or coordinate of each row. limit: of vanishing damping, so that C is but a direction. rest: two
    planes that a turning frame couples are seen from rest; else from a frame that turns fast, as any that whirl.
    """
    every = [*M, *C, *K]
    whole = Part(tuple(dict.fromkeys(names)), M, C, K)
    exact = not any(isinstance(v, arb) for X in every for v in X.flat)
    if not (limit or is_even(M, C, K)):
        return [whole]
    linked = np.any([held(X) | held(X).T for X in every], axis=0)
    groups: list[set[str]] = []
    for name in whole.names:
        own = np.array([other == name for other in names])
        joined = {name, *(names[int(j)] for j in np.flatnonzero(linked[own].any(axis=0)))}
        groups = [g for g in groups if not g & joined] + [joined.union(*(g for g in groups if g & joined))]
    parts = []
    for group in sorted(groups, key=lambda g: min(map(whole.names.index, g))):
        rows = np.flatnonzero([name in group for name in names])
        of_M, of_C, of_K = ([X[np.ix_(rows, rows)] for X in terms] for terms in (M, C, K))
        part = Part(tuple(name for name in whole.names if name in group), of_M, of_C, of_K)
        if not exact:
            parts.append(part)
            continue
        for motion, each in _motions(part, [names[int(i)] for i in rows], limit):
            parts.append(motion if limit else _seen_from_frame(motion, each, rest))
    massless = any(not any(held(X).any() for X in part.M) for part in parts)
    return [whole] if massless else parts


# --- what all matrices leave to itself --------------------------------------------------------------------------------


def _motions(part: Part, names: Sequence[str], limit: bool) -> list[tuple[Part, list[str]]]:
    """The parts within a part, each with the names of its rows; the part alone where there are none.

    Subspaces that all matrices leave to themselves are among sums of the null spaces of f(A), f the factors over the
    fractions of the characteristic polynomial of A = G⁻¹Y, with G and Y sums of all matrices times numbers.
    """
    terms = (part.M, part.C, part.K)
    still, every = [*part.M, *part.K], [X for powers in terms for X in powers]
    G = sum(X * fmpq(1, k + 1) for k, X in enumerate(still))
    Y = sum(X * fmpq(1, k * k + 2) for k, X in enumerate(every))
    if _irreducible(G, Y) or fmpq_mat(G.tolist()).det() == 0:
        return [(part, list(names))]
    G, Y = fmpq_mat(G.tolist()), fmpq_mat(Y.tolist())
    A = G.solve(Y)
    factors = [f**power for f, power in A.charpoly().factor()[1]]
    groups = [[f] for f in factors]
    while True:
        spaces = [_spaces(G, A, group) for group in groups]
        linked = next(
            ((i, j) for i, (left, _) in enumerate(spaces) for j, (_, right) in enumerate(spaces)
             if i != j and any((left.T @ X @ right != 0).any() for X in every)), None,
        )  # fmt: skip
        if linked is None:
            break
        groups = [g for k, g in enumerate(groups) if k not in linked] + [groups[linked[0]] + groups[linked[1]]]
    if len(groups) == 1:
        return [(part, list(names))]
    found = []
    for left, right in spaces:
        M, C, K = ([left.T @ X @ right for X in powers] for powers in terms)
        if not (limit or is_even(M, C, K)):
            return [(part, list(names))]
        last = [int(np.flatnonzero(column != 0)[-1]) for column in right.T]  # of each the unit that it stands for
        found.append((replace(part, M=M, C=C, K=K), [names[i] for i in last]))
    found.sort(key=lambda item: _place(item[0]))
    return [(replace(each, motion=k), of) for k, (each, of) in enumerate(found)]


def _irreducible(G: Any, Y: Any) -> bool:
    """Whether the characteristic polynomial of G⁻¹Y is known to have no factors: of no degree modulo all the primes.
    In fractions it takes as long as the proof at 70 functions."""
    degrees = set(range(1, len(G)))
    for p in PRIMES:
        try:
            of_G, of_Y = (
                nmod_mat(len(X), len(X), [int(v.p) * pow(int(v.q), -1, p) for v in X.flat], p) for X in (G, Y)
            )
            factors = of_G.solve(of_Y).charpoly().factor()[1]
        except (ValueError, ZeroDivisionError):
            continue  # a denominator, or det G, is a multiple of p
        sums = {0}
        for f, power in factors:
            for _ in range(power):
                sums |= {size + f.degree() for size in sums}
        degrees &= sums
        if not degrees:
            return True
    return False


def _spaces(G: fmpq_mat, A: fmpq_mat, factors: Sequence[fmpq_poly]) -> tuple[Any, Any]:
    """Left and right null space of G f(A), f the product of some factors, as columns."""
    n = A.nrows()
    one = fmpq_mat([[fmpq(int(i == j)) for j in range(n)] for i in range(n)])
    total, f = 0 * A, fmpq_poly([1])
    for factor in factors:
        f *= factor
    for k in range(f.degree(), -1, -1):
        total = total * A + f[k] * one
    whole = np.array((G * total).tolist())
    return null_space(whole.T), null_space(whole)


def _place(part: Part) -> tuple[Any, ...]:
    """By which parts of the same names are sorted: their size, then det(x (M_0 + K_0) − M_0) as a monic polynomial, by
    its factors from the lowest power on, then the same with K_0 + K_1 + … for K_0."""
    M = fmpq_mat(part.M[0].tolist())
    polynomials = []
    for K in (part.K[0], np.sum(part.K, axis=0)):
        whole = fmpq_mat(K.tolist()) + M
        polynomials += [[]] if whole.det() == 0 else [[*whole.solve(M).charpoly()]]
    return M.nrows(), *polynomials


# --- two planes that rates couple -------------------------------------------------------------------------------------


def _seen_from_frame(part: Part, names: Sequence[str], rest: bool) -> Part:
    """Of two planes that are alike and that rates alone couple, one as seen from a frame that turns; else the part.
    names: of the rows."""
    if not (part.M[0] != 0).any() or not any((X != 0).any() for X in part.C):
        return part
    for planes in _pairs(list(dict.fromkeys(names))):
        one, two = ([i for of in plane for i, name in enumerate(names) if name == of] for plane in planes)
        if len(one) != len(two):
            continue
        M, B, K = (
            [[X[np.ix_(r, c)] for r in (one, two) for c in (one, two)] for X in terms]
            for terms in (part.M, part.C, part.K)
        )  # fmt: skip
        alike = all((a == d).all() and not (b != 0).any() and not (c != 0).any() for a, b, c, d in M + K)
        if alike and all((b == -c).all() and not (a != 0).any() and not (d != 0).any() for a, b, c, d in B):
            masses, stiff, rates = ([X[k] for X in terms] for terms, k in ((M, 0), (K, 0), (B, 1)))
            return _turned(replace(part, planes=planes), masses, rates, stiff, rest)
    return part


def _pairs(names: list[str]) -> Iterator[Planes]:
    """All ways to say which names are of one plane, and which of the other is of the same kind as each."""
    half = len(names) // 2
    if len(names) % 2 or not 0 < len(names) <= MOST_PLANES:
        return
    for rest in combinations(names[1:], half - 1):
        one = names[0], *rest
        yield from ((one, two) for two in permutations(name for name in names if name not in one))


def _turned(part: Part, M: Powers, B: Powers, K: Powers, rest: bool) -> Part:
    mass, rates = M[0], [X for X in B if (X != 0).any()]
    i, j = next(zip(*np.nonzero(mass != 0), strict=True))
    rate = B[0][i, j] / mass[i, j] / 2
    if rate < 0:  # of the other one
        one, two = part.planes or ((), ())
        return _turned(replace(part, planes=(two, one)), M, [-b for b in B], K, rest)
    whirls = not rest or len(rates) > 1 or any((X != 0).any() for X in M[1:]) or bool((B[0] != 2 * rate * mass).any())
    if whirls:
        rate = fmpq(_fast(mass, B[0], K[0]))
    turned = [
        [rate * b - rate * rate * m + k, 2 * rate * m - b] for m, b, k in zip_longest(M, B, K, fillvalue=fmpq(0) * mass)
    ]
    part = replace(part, C=[], turn=Fraction(int(rate.p), int(rate.q)), whirls=whirls)
    if not whirls:
        return replace(part, M=[mass], K=[A for A, _ in turned])
    # (w, s w) has K − s M, with K = [[0, 1], [A_0, A_1]] and M = [[1, 0], [0, M]]
    none = fmpq(0) * mass
    one = none + np.array([[fmpq(int(i == j)) for j in range(len(mass))] for i in range(len(mass))])
    stiff = [np.block([[none, none if k else one], [A, R]]) for k, (A, R) in enumerate(turned)]
    masses = [np.block([[none if k else one, none], [none, m]]) for k, m in enumerate(M)]
    return replace(part, M=masses, K=stiff)


def _fast(M: Any, B: Any, K: Any) -> int:
    """A rate from twice to four times all |ω| without load, about: ω + rate is positive then, and stays so under loads
    that do not double a frequency."""
    m, b, k = (np.array(X, dtype=float) for X in (M, B, K))
    one = np.eye(len(m))
    pencil = np.block([[k, -b], [0 * one, one]]), np.block([[0 * one, m], [one, 0 * one]])
    inverse = np.abs(np.linalg.eigvals(np.linalg.pinv(pencil[0]) @ pencil[1]))  # 1/|ω|; of what has no mass nothing
    return 1 << int(np.ceil(np.log2(2 / min([1.0, *(v for v in inverse if v > 1e-12)]))))
