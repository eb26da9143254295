"""Motions that leave each other alone: matrices that fall into parts, each with its own determinant.

Frequencies of different parts may pass through one another: their determinants' product has a double root there, and
nothing happens. So each part is proven by itself. Parts are told by names of fields and coordinates, exactly.

Of a part of two that are alike, y and ψ, and that a frame alone couples which turns at a rate c, with w = y ± iψ and
M ẅ ∓ 2ic M ẇ + K w = 0, frequencies are ±c ± √s with det(K + c² M − s M) = 0: what is to be proven is of this s.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np
from flint import arb

from freebeam_derive.certify.structure import is_even

Powers = list[Any]
"""A matrix of fractions by powers of the load, arrays (n, n)."""


@dataclass(frozen=True)
class Part:
    """names of its fields and coordinates; M, C, K; turn: the rate c of a frame, of which K holds c² M then."""

    names: tuple[str, ...]
    M: Powers
    C: Powers
    K: Powers
    turn: Fraction = Fraction(0)


def split(M: Powers, C: Powers, K: Powers, names: Sequence[str], limit: bool, from_rest: bool) -> list[Part]:
    """The parts, in the order of their names; one where damping is finite, with which frequencies may cross as they
    are, where a part had no mass, and where not all is exact.

    names: of the field or coordinate of each row. limit: of vanishing damping, so that C is but a direction. from_rest:
    what a turning frame alone couples is given as seen from rest.
    """
    every = [*M, *C, *K]
    whole = Part(tuple(dict.fromkeys(names)), M, C, K)
    exact = not any(isinstance(v, arb) for X in every for v in X.flat)
    if not exact or not (limit or is_even(M, C, K)):
        return [whole]
    linked = np.any([(X != 0) | (X != 0).T for X in every], axis=0)
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
        parts.append(_seen_from_rest(part, [names[int(i)] for i in rows]) if from_rest and not limit else part)
    massless = any(all(v == 0 for X in part.M for v in X.flat) for part in parts)
    return [whole] if massless else parts


def _seen_from_rest(part: Part, names: Sequence[str]) -> Part:
    """Of two that are alike in a frame that turns one of them, as it moves where nothing turns; else the part."""
    if len(part.names) != 2 or not any((X != 0).any() for X in part.C):
        return part
    one, two = ([i for i, name in enumerate(names) if name == side] for side in part.names)
    if len(one) != len(two):
        return part

    def blocks(X: Any) -> list[Any]:
        return [X[np.ix_(rows, columns)] for rows in (one, two) for columns in (one, two)]

    each = [blocks(X) for X in part.M + part.K]
    alike = all((a == d).all() and not (b != 0).any() and not (c != 0).any() for a, b, c, d in each)
    a, b, c, d = blocks(part.C[0])
    mass, more = blocks(part.M[0])[0], [X for X in (*part.M[1:], *part.C[1:]) if (X != 0).any()]
    i, j = next(zip(*np.nonzero(mass != 0), strict=True), (0, 0))
    if not alike or more or mass[i, j] == 0:
        return part
    rate = b[i, j] / mass[i, j] / 2
    turns = (b == 2 * rate * mass).all() and (c == -b).all() and not (a != 0).any() and not (d != 0).any()
    if not turns:
        return part
    K = [blocks(X)[0] for X in part.K]
    K[0] = K[0] + rate * rate * mass
    return Part(part.names, [mass], [], K, abs(Fraction(int(rate.p), int(rate.q))))
