"""Whether two parts of a column have the same frequencies at all loads: matrices that are the same but for factors, or
in other coordinates, or one the other's transposed, as Reut's column and Beck's are (adjoint problems).
"""

from __future__ import annotations

from typing import Any

import numpy as np
from flint import fmpq, fmpq_mat

from freebeam_derive.certify.commutant import alike
from freebeam_derive.certify.formal import Letters
from freebeam_derive.certify.structure import held


def scale_of(one: Letters, other: Letters, still: bool) -> fmpq | None:
    """ω² of another over that of one, where both have these at all loads, None where that is not known: 1 where the
    matrices are the same but for one factor; the quotient of two factors where M and K have one each, without C.

    one, other: M, C and K, of fractions, by powers of the load or letters. still: not as seen from a frame that turns.
    """
    of_M, of_C, of_K = (_factor(a, b) for a, b in zip(one, other, strict=True))
    if of_M is None or of_K is None or of_C is None:
        return _in_other_coordinates(one, other, still)
    if of_C != 0:
        return fmpq(1) if of_M == of_C == of_K else None
    return of_K / of_M if of_K == of_M or (of_K / of_M > 0 and still) else None


def _in_other_coordinates(first: Letters, second: Letters, still: bool) -> fmpq | None:
    """`Part.scale` of matrices in other coordinates. still: not as seen from a frame that turns."""
    sizes = [(len(of[0][0]), *map(len, of)) for of in (first, second)]
    if sizes[0] != sizes[1]:
        return None
    one, two = ([fmpq_mat(X.tolist()) for powers in of for X in powers] for of in (first, second))
    if alike(one, two) or alike(one, [X.transpose() for X in two]):
        return fmpq(1)
    # without C ω² may all be a number of times as large
    if any(held(X).any() for X in (*first[1], *second[1])) or not still or not (one[0].det() != 0 != two[0].det()):
        return None
    count = len(first[2])
    traces = [_trace(M.solve(sum(of[-count:], 0 * M))) for M, *of in (one, two)]
    if traces[0] == 0 or not traces[1] / traces[0] > 0:
        return None
    scale = traces[1] / traces[0]
    one = [*one[:-count], *(X * scale for X in one[-count:])]
    return scale if alike(one, two) or alike(one, [X.transpose() for X in two]) else None


def _trace(X: fmpq_mat) -> fmpq:
    return sum((X[i, i] for i in range(X.nrows())), fmpq(0))


def _factor(one: list[Any], other: list[Any]) -> Any:
    """What some matrices are times others, 0 where all are nothing; None where there is no one factor."""
    if [X.shape for X in one] != [X.shape for X in other]:
        return None
    a, b = (np.concatenate([np.array([fmpq(0)]), *(X.ravel() for X in each)]) for each in (one, other))
    first = np.flatnonzero(held(a))
    if not len(first):
        return None if held(b).any() else fmpq(0)
    factor = b[first[0]] / a[first[0]]
    return factor if factor != 0 and (a * factor == b).all() else None
