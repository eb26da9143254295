"""Motions that leave each other alone: matrices that fall into parts, each with its own determinant.

Frequencies of different parts may pass through one another: their determinants' product has a double root there, and
nothing happens. So each part is proven by itself. Parts are told by names of fields and coordinates, and where that is
not enough by what all matrices leave to itself (the sum and the difference of two planes that are coupled
symmetrically, what is even and what is odd about the middle): exactly, in fractions.

Of a part of two planes that are alike and that rates alone couple, M ÿ + B ż + K y = 0 and M z̈ − B ẏ + K z = 0, is
w = y ± iz with w = e^(iωt) of det(K − ωB − ω² M) = 0, or of the same at −ω. Seen from a frame that turns at a rate c,
with s = ω + c, that is A_0 + s A_1 − s² M, A_0 = K + cB − c² M, A_1 = 2cM − B. Where A_1 is nothing the theorem is one
of s²; else one of s itself, with c so large that all s are positive. Damping that vanishes, ε C in each plane and ε S
from one on displacements of the other, adds iε (ωC + S) to this to first order, and what makes no motion grow.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cmp_to_key
from itertools import combinations, permutations, zip_longest
from typing import Any

import numpy as np
from flint import arb, arb_mat, fmpq, fmpq_mat

from freebeam_derive.certify.commutant import Split, splits
from freebeam_derive.certify.formal import Letters
from freebeam_derive.certify.same_motions import scale_of
from freebeam_derive.certify.structure import Beside, Structure, held, is_even, of_balls, structure

Powers = list[Any]
"""A matrix of fractions by powers of the load, arrays (n, n)."""
Planes = tuple[tuple[str, ...], tuple[str, ...]]
MOST_PLANES = 8  # names among which two planes are looked for; the ways to pair them are 840 then


@dataclass(frozen=True)
class Part:
    """names of its fields and coordinates; M, C, K. motion: which one it is of those that share these names, in the
    order of `_place`. planes: two that are alike, of which M and K are one's as seen from a frame that turns at the
    rate turn; whirls: as a problem in s = ω + turn, else in its square. kind: shared by those of the same names that
    are the same motions, −1 where that is not known. known: what holds exactly of matrices in balls. together: where it
    is one of those of the roots of a polynomial, M, C and K of all of these, of fractions; others: K of each of the
    other roots. whole: K of all motions of these names. before: seen from the frame
    before it was taken apart from others. letters: of matrices in balls, what they are sums of. beside: rates that stay
    where damping vanishes, and what that does on displacements."""

    names: tuple[str, ...]
    M: Powers
    C: Powers
    K: Powers
    motion: int = 0
    planes: Planes | None = None
    turn: Fraction = Fraction(0)
    whirls: bool = False
    kind: int = -1
    known: Structure | None = None
    together: tuple[Powers, Powers, Powers] | None = None
    others: tuple[Powers, ...] = ()
    whole: Sequence[Any] = ()
    before: bool = False
    letters: Letters | None = None
    beside: Beside | None = None

    @property
    def fractions(self) -> Letters | None:
        """M, C and K by powers of the load, in balls by letters too; None where they are known in balls alone."""
        every = [X for powers in (self.M, self.C, self.K) for X in powers]
        if any(isinstance(v, arb) for X in every for v in X.flat):
            return self.letters
        return self.M, self.C, self.K

    def damped(self, limit: bool) -> bool:
        """Whether something damps it; limit: of damping that vanishes, and may be of any form."""
        if limit:
            return any(held(X).any() for X in (*self.C, *(self.beside.S if self.beside else ())))
        return not (is_even(self.M, self.C, self.K) or (self.letters is not None and is_even(*self.letters)))

    @property
    def gyroscopic(self) -> bool:
        """Whether M and K are symmetric and C skew, exactly, in balls by their letters."""
        terms = self.fractions
        if terms is None or not any(held(X).any() for X in self.C):
            return False
        M, C, K = terms
        return all((X == X.T).all() for X in (*M, *K)) and all((X == -X.T).all() for X in C)

    def scale(self, other: Part) -> fmpq | None:
        """ω² of another over that of this one, where both have these at all loads: 1 for the same motions, else by
        `same_motions`."""
        if self.names == other.names and self.kind == other.kind >= 0:
            return fmpq(1)
        if self.turn != other.turn or self.beside or other.beside:
            return None
        one, two = self.fractions, other.fractions
        if one is None or two is None:
            return None
        return scale_of(one, two, still=not self.turn)


def split(
    M: Powers,
    C: Powers,
    K: Powers,
    names: Sequence[str],
    letters: Letters | None,
    limit: bool,
    rest: bool | None,
    beside: Beside | None = None,
    top: Fraction = Fraction(0),
) -> list[Part]:
    """The parts, in the order of their names, some damped and others not; one where a part had no mass. Where nothing
    is known in fractions parts are those of names alone.

    names: of the field or coordinate of each row. letters: of matrices in balls. limit: of vanishing damping, so that C
    is but a direction. rest: two planes that a turning frame couples are seen from rest; else from a frame that turns
    fast, as any that whirl; None: as they are. beside: what there is beside damping that vanishes.
    top: the highest load of interest.
    """
    every = [*M, *C, *K, *(beside.G + beside.S if beside else [])]
    whole = Part(tuple(dict.fromkeys(names)), M, C, K, letters=letters, beside=beside)
    linked = np.any([held(X) | held(X).T for X in every], axis=0)
    groups: list[set[str]] = []
    for name in whole.names:
        own = np.array([other == name for other in names])
        joined = {name, *(names[int(j)] for j in np.flatnonzero(linked[own].any(axis=0)))}
        groups = [g for g in groups if not g & joined] + [joined.union(*(g for g in groups if g & joined))]
    parts = []
    for group in sorted(groups, key=lambda g: min(map(whole.names.index, g))):
        rows = np.flatnonzero([name in group for name in names])
        own_rows = np.ix_(rows, rows)
        of_M, of_C, of_K, *own_letters = ([X[own_rows] for X in terms] for terms in (M, C, K, *(letters or ())))
        part = Part(tuple(name for name in whole.names if name in group), of_M, of_C, of_K, whole=of_K)
        part = replace(part, letters=(own_letters[0], own_letters[1], own_letters[2]) if own_letters else None)
        part = replace(part, beside=beside and beside.taken(own_rows))
        if not part.fractions:
            parts.append(part)
            continue
        if limit and (part.beside or len(part.names) > 1):
            seen = part if rest is None else _damped_in_frame(part, [names[int(i)] for i in rows], top)
            if seen.turn or part.beside:
                parts.append(seen)
                continue
        of, damped = [names[int(i)] for i in rows], part.damped(limit)
        if part.fractions is part.letters and not damped:
            part = replace(part, known=of_balls(of_M, of_C, of_K, True))
        motions = _motions(part, of, damped)
        if damped or limit or rest is None:
            parts += [motion for motion, _ in motions]
        elif any(motion.together and held(X).any() for motion, _ in motions for X in motion.C):
            parts += _of_frame(part, of, rest, top) or [motion for motion, _ in motions]
        else:
            parts += [_seen_from_frame(motion, each, rest, top) for motion, each in motions]
    massless = any(not any(held(X).any() for X in part.M) for part in parts)
    return [whole] if massless else parts


# --- what all matrices leave to itself --------------------------------------------------------------------------------


def _motions(part: Part, names: Sequence[str], limit: bool) -> list[tuple[Part, list[str]]]:
    """The parts within a part, each with the names of its rows; the part alone where there are none. limit: of damping
    that vanishes, or of any, so that determinants are not even."""
    alone, terms = [(part, list(names))], part.fractions
    if terms is None:
        return alone
    fractions = [*terms[0], *terms[2]]
    G = fmpq_mat(sum(X * fmpq(1, k + 1) for k, X in enumerate(fractions)).tolist())
    rates = not limit and any((X != 0).any() for X in terms[1])
    symmetric = all((X == X.T).all() for X in fractions) and all(
        (X == side * X.T).all() for side in [-1 if rates else 1] for X in terms[1]
    )
    if G.det() == 0:
        return alone
    found = []
    for of in splits(G, [fmpq_mat(X.tolist()) for powers in terms for X in powers], symmetric):
        U, V = fmpq_mat(of.U.tolist()), fmpq_mat(of.V.tolist())
        M, C, K = ([np.array((U * fmpq_mat(X.tolist()) * V).tolist()) for X in powers] for powers in terms)
        last = [int(np.flatnonzero(column != 0)[-1]) for column in of.V.T]  # of each the unit that it stands for
        if len(of.roots) < 2:
            own = replace(part, M=M, C=C, K=K, kind=of.kinds[0])
            if terms is part.letters:
                own = replace(_in_balls(part, (M, C, K), of.U, of.V, limit), kind=of.kinds[0])
            if not limit and own.damped(False):
                return alone
            found.append((own, [names[i] for i in last]))
            continue
        if (rates and not symmetric) or (limit and terms is part.letters):
            return alone
        if terms is part.letters:
            found += [(_root_in_balls(part, (M, C, K), of, k), list[str]()) for k in range(len(of.roots))]
            continue
        known = replace(structure(M, C, K), even=not limit or not any(held(X).any() for X in C))
        if limit and structure(M, [], K).degree != known.degree:
            return alone
        shared = known.shared(len(of.roots))
        every_K = [[of.at(k, X) for X in K] for k in range(len(of.roots))]
        for k, kind in enumerate(of.kinds):
            M_r, C_r = ([of.at(k, X) for X in powers] for powers in (M, C))
            others = (*every_K[:k], *every_K[k + 1 :])
            own = replace(part, M=M_r, C=C_r, K=every_K[k], kind=kind, known=shared, together=(M, C, K), others=others)
            found.append((own, []))
    ordered = sorted(((_place(each), each, of) for each, of in found), key=cmp_to_key(_compared))
    return [(replace(each, motion=k), of) for k, (_, each, of) in enumerate(ordered)] or alone


def _in_balls(part: Part, letters: Letters, U: Any, V: Any, damped: bool) -> Part:
    """U X V of the matrices X in balls, exactly nothing where its letters are; damped: or may be."""
    found = []
    for powers, of in zip((part.M, part.C, part.K), letters, strict=True):
        found.append([U @ X @ V for X in powers])
        for X, entries in zip(found[-1], _entries(of, len(powers)), strict=True):
            X[~entries] = fmpq(0)
    known = None if damped else of_balls(found[0], found[1], found[2], is_even(*letters))
    return replace(part, M=found[0], C=found[1], K=found[2], letters=letters, known=known)


def _entries(letters: Sequence[Any], powers: int) -> list[Any]:
    """Of each power of the load the entries that not all letters say are nothing."""
    count = len(letters) // max(powers, 1)
    return [np.any([held(Y) for Y in letters[k * count : k * count + count]], axis=0) for k in range(powers)]


def _root_in_balls(part: Part, letters: Letters, of: Split, k: int) -> Part:
    """The same of the motions of one root, that nothing damps."""
    found = []
    for powers, own in zip((part.M, part.C, part.K), letters, strict=True):
        found.append([of.at(k, of.U @ X @ of.V) for X in powers])
        for X, rows in zip(found[-1], _entries(own, len(powers)), strict=True):
            X[~np.any([rows[i : i + len(X), : len(X)] for i in range(0, len(rows), len(X))], axis=0)] = fmpq(0)
    known = of_balls(found[0], found[1], found[2], True)
    return replace(part, M=found[0], C=found[1], K=found[2], kind=of.kinds[k], known=known, letters=None, whole=())


def _place(part: Part) -> list[arb]:
    """By which parts of the same names are sorted: their size, then det(x (M_0 + K_0) − M_0) as a monic polynomial, by
    its factors from the lowest power on, then the same with K_0 + K_1 + … for K_0."""
    found = [arb(len(part.M[0]))]
    for K in (part.K[0], np.sum(part.K, axis=0)):
        M, whole = (arb_mat([[arb(v) for v in row] for row in X.tolist()]) for X in (part.M[0], part.M[0] + K))
        found += [] if whole.det().contains(0) else [*whole.solve(M).charpoly()]
    return found


def _compared(one: tuple[list[arb], Any, Any], other: tuple[list[arb], Any, Any]) -> int:
    """By the first numbers that are known to differ."""
    signs = ((a > b) - (a < b) for a, b in zip(one[0], other[0], strict=False))
    return next((sign for sign in signs if sign), 0)


# --- two planes that rates couple -------------------------------------------------------------------------------------


def _seen_from_frame(part: Part, names: Sequence[str], rest: bool, top: Fraction) -> Part:
    """Of two planes that are alike and that rates alone couple, one as seen from a frame that turns; else the part.
    names: of the rows. top: the highest load of interest."""
    exactly = part.fractions
    if exactly is None or not held(part.M[0]).any() or not any(held(X).any() for X in part.C):
        return part
    of_M, of_B, of_K = exactly
    for planes, at in _planes(names):
        if not (_alike(of_M, at) and _alike(of_K, at) and _across(of_B, at)):
            continue
        M, B, K = ([X[at[k]] for X in terms] for terms, k in ((part.M, 0), (part.C, 1), (part.K, 0)))
        return _turned(replace(part, planes=planes), M, B, K, rest, top)
    return part


def _damped_in_frame(part: Part, names: Sequence[str], top: Fraction) -> Part:
    """The same in a limit of vanishing damping that is alike in both planes, and from one to the other but for the
    sign."""
    exactly, beside = part.fractions, part.beside or Beside([], [])
    if exactly is None or (part.beside and part.letters and not beside.letters):
        return part
    if arb_mat([[arb(v) for v in row] for row in part.M[0].tolist()]).det().contains(0):
        return part
    (of_M, of_C, of_K), (of_G, of_S) = exactly, beside.letters or (beside.G, beside.S)
    for planes, at in _planes(names):
        if not (_alike(of_M, at) and _alike(of_K, at) and _across(of_G, at)):
            continue
        if all((X[at[0]] == X[at[3]]).all() and (X[at[1]] == -X[at[2]]).all() for X in (*of_C, *of_S)):
            M, K, C = ([X[at[0]] for X in terms] for terms in (part.M, part.K, part.C))
            B, S = ([X[at[1]] for X in terms] for terms in (beside.G, beside.S))
            return _whirling(replace(part, planes=planes, beside=None), M, B or [fmpq(0) * M[0]], K, top, C, S)
    return part


def _planes(names: Sequence[str]) -> Iterator[tuple[Planes, list[Any]]]:
    """All ways to say which rows are of one plane and which of the other, with where the four blocks of these are."""
    for planes in _pairs(list(dict.fromkeys(names))):
        one, two = ([i for of in plane for i, name in enumerate(names) if name == of] for plane in planes)
        if len(one) == len(two):
            yield planes, [np.ix_(r, c) for r in (one, two) for c in (one, two)]


def _alike(terms: Powers, at: list[Any]) -> bool:
    """Whether matrices are the same of both planes and couple them nowhere."""
    return all(
        (X[at[0]] == X[at[3]]).all() and not any((X[place] != 0).any() for place in at[1:3]) for X in terms
    )  # fmt: skip


def _across(terms: Powers, at: list[Any]) -> bool:
    """Whether they couple the planes alone, one as the other but for the sign."""
    return all(
        (X[at[1]] == -X[at[2]]).all() and not any((X[place] != 0).any() for place in (at[0], at[3])) for X in terms
    )  # fmt: skip


def _of_frame(part: Part, names: Sequence[str], rest: bool, top: Fraction) -> list[Part]:
    """Where only roots tell motions apart that rates couple: those of one plane as seen from a frame; none where it is
    none of two such planes."""
    seen = replace(_seen_from_frame(part, list(names), rest, top), before=True)
    return [motion for motion, _ in _motions(seen, list(names), False)] if seen.turn else []


def _pairs(names: list[str]) -> Iterator[Planes]:
    """All ways to say which names are of one plane, and which of the other is of the same kind as each."""
    half = len(names) // 2
    if len(names) % 2 or not 0 < len(names) <= MOST_PLANES:
        return
    for rest in combinations(names[1:], half - 1):
        one = names[0], *rest
        yield from ((one, two) for two in permutations(name for name in names if name not in one))


def _turned(part: Part, M: Powers, B: Powers, K: Powers, rest: bool, top: Fraction) -> Part:
    mass = M[0]
    i, j = next(zip(*np.nonzero(held(mass)), strict=True))
    rate = B[0][i, j] / mass[i, j] / 2
    if rate < 0:  # of the other one
        one, two = part.planes or ((), ())
        return _turned(replace(part, planes=(two, one)), M, [-b for b in B], K, rest, top)
    # from rest no rates are left, at any load: not so where they grow with it, of a frame that turns faster then
    left = [2 * rate * mass - B[0], *B[1:], *M[1:]]
    if not rest or rate == 0 or any(held(X).any() for X in left):
        return _whirling(part, M, B, K, top, [], [])
    stiff = [rate * b - rate * rate * m + k for m, b, k in zip_longest(M, B, K, fillvalue=fmpq(0) * mass)]
    return replace(_in_frame(part, rate), M=[mass], K=stiff)


def _in_frame(part: Part, rate: fmpq) -> Part:
    return replace(part, C=[], turn=Fraction(int(rate.p), int(rate.q)), known=None, letters=None)


def _whirling(part: Part, M: Powers, B: Powers, K: Powers, top: Fraction, C: Powers, S: Powers) -> Part:
    """(w, s w) has K − s M, with K = [[0, 1], [A_0, A_1]] and M = [[1, 0], [0, M]]; C, S: of damping that vanishes."""
    rate, none = fmpq(_fast(M, B, K, float(top))), fmpq(0) * M[0]
    one = none + np.array([[fmpq(int(i == j)) for j in range(len(none))] for i in range(len(none))])
    turned = [[rate * b - rate * rate * m + k, 2 * rate * m - b] for m, b, k in zip_longest(M, B, K, fillvalue=none)]
    stiff = [np.block([[none, none if k else one], [A, R]]) for k, (A, R) in enumerate(turned)]
    masses = [np.block([[none if k else one, none], [none, m]]) for k, m in enumerate(M)]
    rates = [np.block([[none, none], [s - rate * c, c]]) for c, s in zip_longest(C, S, fillvalue=none)]
    return replace(_in_frame(part, rate), whirls=True, M=masses, C=rates, K=stiff)


def _fast(M: Powers, B: Powers, K: Powers, top: float) -> int:
    """A rate from twice to four times all |ω| without load and at the highest, about: ω + rate is positive then, and
    stays so under loads that do not double a frequency."""

    def slowest(P: float) -> float:
        m, b, k = (np.sum([P**a * np.array(X, dtype=float) for a, X in enumerate(of)], axis=0) for of in (M, B, K))
        one = np.eye(len(m))
        pencil = np.block([[k, -b], [0 * one, one]]), np.block([[0 * one, m], [one, 0 * one]])
        inverse = np.abs(np.linalg.eigvals(np.linalg.pinv(pencil[0]) @ pencil[1]))  # 1/|ω|; of what has no mass nothing
        return min([1.0, *(float(v) for v in inverse if v > 1e-12)])

    return 1 << int(np.ceil(np.log2(2 / min(slowest(0.0), slowest(top)))))
