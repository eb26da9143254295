"""Check a certificate of matrices that are known within balls: `verifier.py`'s theorem, of every M, C and K within.

A factor such as exp(-x) leaves no fractions: what the file holds are M, C and K by powers of the load, each entry a
fraction, or a middle and a radius. That the matrices are those of a column is not checked. Each entry may be any
number of its ball, by itself: nothing is taken for symmetric, and exactly nothing is what is written as 0 alone. Of a
part without stretches M, C and K are the first's, K times a number where there is no C; and where M and K of a part
are written symmetric and C skew, they are so: no others are meant, and the statement says it. All that is checked holds
of every such choice, for it is computed with the balls.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

from flint import arb, arb_mat

from freebeam_derive.certify import verifier
from freebeam_derive.certify.decimals import said
from freebeam_derive.certify.verifier import CLAIM, MOST_NAMES, MOST_POWERS, System
from freebeam_derive.certify.verifier_claims import (
    LASTING,
    MOST_MODES,
    Statement,
    ball,
    claims_of,
    number,
    ratio,
    require,
    vanishing,
)
from freebeam_derive.certify.verifier_degrees import Degrees, of_entries

FORMAT = "freebeam certificate 9"
FIELDS = (CLAIM - {"forms"}) | {"names", "M", "C", "K", "kappa", "parts", "beside"}
Entry = tuple[Fraction, Fraction]  # middle and radius
Table = list[list[Entry]]
NOTHING = Fraction(0), Fraction(0)


@dataclass(frozen=True)
class OfMatrices(Statement):
    """A statement of all M, C and K within the balls of a file; size: their rows; widest: the largest radius. The rest
    as of `OfForms`."""

    kappa: Fraction | float | None
    size: int
    widest: Fraction
    damped: bool
    above_zero: bool
    parts: tuple[tuple[str, ...], ...]
    lasting: tuple[tuple[str, ...], ...]
    scales: tuple[Fraction, ...]
    gyroscopic: bool

    @property
    def times(self) -> int:
        """How many of the parts are the first."""
        return len(self.scales)

    @property
    def of_one(self) -> str:
        return " of one of these" if len(self.parts) > 1 else ""

    @property
    def of(self) -> str:
        what = f"every M, C and K within those in this file (which names them {self.named}; that they are its is not "
        what += f"checked), N = {self.modes} ({self.size} functions), entries within {float(self.widest):.1e}"
        of = f", said to be at alpha = {said(self.alpha)}, beta = {said(self.beta)}" if self.damped else ", undamped"
        of += " but for gyroscopic terms, M and K symmetric and C skew" if self.gyroscopic else ""
        if self.kappa is not None:
            of = f", in the limit of vanishing damping along C, said to be {vanishing(self.kappa)}"
        if len(self.parts) > 1:
            of += f", {' and '.join('-'.join(names) for names in self.parts)} leaving each other alone"
        if self.lasting:
            of += f", {' and '.join('-'.join(names) for names in self.lasting)} undamped ({LASTING})"
        if self.times > 1:
            but = " but for the unit of time" if set(self.scales) != {1} else ""
            of += f", {self.times} of them with the same numbers{but}, of which each is lost at a load where one is"
        return what + of

    def __str__(self) -> str:
        return self.proven(self.damped, self.above_zero, lasting=bool(self.lasting))

    def record(self) -> dict[str, Any]:
        return super().record() | {
            "of": "every M, C and K within those in this file", "parameters": None, "functions": self.size,
            "radius": f"{float(self.widest):.1e}", "damped": self.damped,
            "stable_at_zero_load": None if self.above_zero else True, "parts": [*map(list, self.parts)],
            "lasting": [*map(list, self.lasting)], "times": self.times,
            "gyroscopic": self.gyroscopic,
        }  # fmt: skip


def read(data: dict[str, Any]) -> verifier.Read:
    """A certificate of matrices in balls. Raises Refused."""
    require(set(data) == FIELDS, f"fields are missing, or not known: {', '.join(sorted(FIELDS ^ set(data)))[:100]}")
    claims, names, kappa = claims_of(data), data["names"], ratio(data["kappa"])
    size = len(names)
    require(0 < size <= MOST_MODES and all(type(of) is str for of in names), "the rows have no names, or are too many")
    tables = {letter: _tables(data[letter], size) for letter in "MCK"}
    require(bool(tables["M"] and tables["K"]), "there is no mass, or no stiffness")
    if kappa is not None:
        fits = kappa >= 0 == claims["alpha"] == claims["beta"]
        require(fits, "kappa is negative, or alpha and beta are not 0 in its limit")
    given, beside = data["parts"], data["beside"]
    require(type(given) is list and 0 < len(given) <= MOST_NAMES, "there are no parts, or too many")
    listed = sorted(name for part in given for name in part)
    require(listed == sorted(set(names)) and all(given), "the parts are not all fields and coordinates")
    require(type(beside) is list and len(beside) == len(given) - 1, "the stretches of each part are not there")
    parts = [_Part.of(tables, [n for n, name in enumerate(names) if name in part], kappa is not None) for part in given]
    damped = [part.damped for part in parts]
    require(kappa is None or any(damped), "there is no damping that could vanish")
    lasting = (names for names, of in zip(given, damped, strict=True) if any(damped) and not of)
    widest = max(radius for of in tables.values() for table in of for row in table for _, radius in row)
    others = list(zip(parts[1:], beside, strict=True))
    scales = [part.scale(parts[0]) for part, of in others if of is None]
    stated = OfMatrices(
        **claims, kappa=kappa, size=size, widest=widest, damped=any(damped),
        above_zero=any(part.above_zero for part in parts), parts=tuple(map(tuple, given)),
        lasting=tuple(map(tuple, lasting)), scales=(Fraction(1), *scales),
        gyroscopic=any(part.skew for part in parts),
    )  # fmt: skip
    besides: list[verifier.Checked] = [
        (part.system, part.stretches(of, stated.top), None) for part, of in others if of is not None
    ]
    return stated, size, parts[0].system, parts[0].stretches(data["stretches"], stated.end), besides


def verify(data: dict[str, Any]) -> Statement:
    """Check a certificate of matrices in balls. Raises Refused."""
    return verifier.check(*read(data))


FORMATS: verifier.Others = {FORMAT: verify}


@dataclass(frozen=True)
class _Part:
    """Rows and columns that are nothing in all others."""

    M: list[Table]
    C: list[Table]
    K: list[Table]
    limit: bool
    known: Degrees
    skew: bool

    @staticmethod
    def of(tables: dict[str, list[Table]], own: list[int], limit: bool) -> _Part:
        M, C, K = ([[[table[i][j] for j in own] for i in own] for table in tables[letter]] for letter in "MCK")
        for table in (table for powers in tables.values() for table in powers):
            others = (i for i in range(len(table)) if i not in own)
            alone = all(table[i][j] == table[j][i] == NOTHING for i in others for j in own)
            require(alone, "parts do not leave each other alone")
        C = C if any(entry != NOTHING for table in C for row in table for entry in row) else []
        limit = limit and bool(C)
        held = [[[[entry != NOTHING for entry in row] for row in table] for table in powers] for powers in (M, C, K)]
        known = of_entries(held[0], held[1], held[2])
        skew = bool(C) and not limit and _mirrored((*M, *K), 1) and _mirrored(C, -1)
        if skew:
            known = replace(known, even=True, highest=known.highest - known.highest % 2)
        if limit:
            still = of_entries(held[0], [], held[2])
            require(still.highest == known.highest, "damping that vanishes acts on what has no mass")
        require(known.highest > 1, "no motion has a frequency")
        return _Part(M, C, K, limit, known, skew)

    def scale(self, first: _Part) -> Fraction:
        """ω² in it over that in the first: 1 where all numbers are the same; where there is no C, K may be a number of
        times as large. Raises Refused."""
        require(self.M == first.M and self.C == first.C, "a part without stretches is not the first again")
        own, others = ([e for table in of.K for row in table for e in row] for of in (self, first))
        factor = next((a[0] / b[0] for a, b in zip(own, others, strict=False) if b[0] != 0), Fraction(1))
        same = own == [(factor * middle, factor * radius) for middle, radius in others]
        same = same and (factor == 1 or (factor > 0 and not self.C))
        require(same and len(self.K) == len(first.K), "a part without stretches is not the first again")
        return factor

    @property
    def damped(self) -> bool:
        return bool(self.C) and (self.limit or not self.known.even)

    @property
    def above_zero(self) -> bool:
        return bool(self.known.resting) or (self.damped and all(v == NOTHING for row in self.C[0] for v in row))

    def system(self) -> System:
        """At the precision in hand."""
        M, C, K = ([_balls(table) for table in powers] for powers in (self.M, self.C, self.K))
        return System(M, C, K, self.limit, self.known)

    def stretches(self, data: Any, end: Fraction) -> list[verifier.Stretch]:
        count = self.known.highest if self.damped else self.known.highest // 2 + 1
        return verifier._stretches(data, end, count, self.known.resting > 0)


def _mirrored(tables: Sequence[Table], side: int) -> bool:
    """Whether entries on both sides of the diagonal are written as the same, or with another sign."""
    return all(
        table[i][j] == (side * table[j][i][0], table[j][i][1])
        for table in tables
        for i in range(len(table))
        for j in range(len(table))
    )


def _balls(table: Table) -> arb_mat:
    return arb_mat([[ball(middle) + ball(radius) * arb(0, 1) for middle, radius in row] for row in table])


def _tables(data: Any, size: int) -> list[Table]:
    """Square matrices by powers of the load."""
    require(type(data) is list and len(data) <= MOST_POWERS, "matrices are no list by powers of the load, or too many")
    square = all(type(table) is list and [*map(len, table)] == [size] * size for table in data)
    require(square, "a matrix has not as many rows and columns as there are names")
    return [[[_entry(v) for v in row] for row in table] for table in data]


def _entry(data: Any) -> Entry:
    if type(data) is str:
        return number(data), Fraction(0)
    require(type(data) is list and len(data) == 2, "an entry is no number, and no middle and radius")
    middle, radius = map(number, data)
    require(radius > 0, "the radius of an entry is not positive")
    return middle, radius
