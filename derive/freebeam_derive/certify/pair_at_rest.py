"""A pair of eigenvalues of the beam itself that leaves zero: two planes that are lost at rest, both at one load.

A shaft that turns has, as it sees itself, both of its planes at rest at its critical speed. At λ = 0 no rates act, and
the conditions on two planes that rates alone couple fall apart; where those on one are those on the other F(P, 0) is
f(P)², but for its sign, f the determinant of one plane's. Where f = 0 the matrix of all conditions takes two motions to
nothing, so that F = F_P = F_s = 0 exactly, and with s = −λ

    F = a (P − P*)² + b (P − P*) s + c s² + …,

so that b² < 4 a c says that a pair of conjugate λ leaves zero, at the speed b / (2 c) to the right.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from flint import arb

from freebeam_derive.certify.balls import Unproven, array, formal
from freebeam_derive.certify.beam import Taylor
from freebeam_derive.certify.beam_itself import ExactCrossing, NoOnset, Onset, onset
from freebeam_derive.certify.exact_system import ExactSystem
from freebeam_derive.certify.formal import Formal

SECOND = ((0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2))


def flutter(system: ExactSystem, near: float, digits: int) -> ExactCrossing:
    """Onset of flutter at λ = 0 with damping. Raises Unproven, NoOnset."""
    return onset(_Pair(system), (near,), digits)


class _Pair(Onset):
    """P with f(P) = 0 of one plane at rest."""

    sought = "a pair that leaves zero, two planes at rest at the load"
    of_value = ((0, 0),)
    of_slopes = ((0, 0), (1, 0))

    def __init__(self, system: ExactSystem) -> None:
        self.whole = system
        super().__init__(_one_plane(system))

    def frequency(self, x: list[arb]) -> arb:
        return arb(0)

    def place(self, x: list[arb]) -> tuple[arb, arb]:
        return x[0], arb(0)

    def equations(self, x: list[arb], t: Taylor) -> list[arb]:
        return [t[0, 0]]

    def matrix(self, x: list[arb], t: Taylor) -> list[list[arb]]:
        return [[t[1, 0]]]

    def onset(self, x: list[arb], t: Taylor) -> None:
        """The pair's growth rate rises through zero."""
        known = self.whole.taylor(x[0], arb(0), SECOND)
        a, b, c = known[2, 0], known[1, 1], known[0, 2]
        if not b * b < 4 * a * c:
            raise Unproven("whether the two eigenvalues that are zero there leave as a pair is not known")
        if b * c < 0:
            raise NoOnset("the growth rate falls with the load there, a restabilisation")
        if not b * c > 0:
            raise Unproven("the direction of the crossing is not known")


def _one_plane(system: ExactSystem) -> ExactSystem:
    """The first of two planes that are alike at rest, and coupled by rates alone. Raises Unproven."""
    if system.rigid:
        raise Unproven("two eigenvalues are zero at once beside rigid motions")
    own = {name: formal(value) for name, value in system.own.items()}
    try:
        given = (*map(formal, system.dampings), Formal(1))
        equations, conditions = system.kernel.equations(*given, **own), system.kernel.conditions(*given, **own)
        tables = [_at_rest(table, 3) for table in equations]
        rows = [_at_rest(row, 2) for row in conditions]
    except (AttributeError, TypeError) as error:
        raise Unproven(f"whether two planes are alike at rest is not known: {error}") from None
    groups = [{name} for name in (*system.sizes, *system.columns)]
    for names in [{row, of} for table in tables for row, of, *_ in table] + [{of[0] for of in row} for row in rows]:
        joined = [group for group in groups if group & names]
        groups = [group for group in groups if not group & names] + ([set().union(*joined)] if joined else [])
    planes = [[name for name in (*system.sizes, *system.columns) if name in group] for group in groups]
    if len(planes) == 2:
        each = [[n for n, row in enumerate(rows) if {of[0] for of in row} & set(plane)] for plane in planes]
        one, other = (
            _relabelled(tables, [rows[n] for n in numbers], plane) for numbers, plane in zip(each, planes, strict=True)
        )
        if one == other and len(each[0]) == len(each[1]) and sum(map(len, each)) == len(rows):
            return system.of(planes[0], frozenset(each[0]))
    raise Unproven(
        "two eigenvalues are zero at once, and the column is not two planes alike at rest that rates alone couple"
    )


def _at_rest(table: dict[Any, Any], place: int) -> dict[Any, str]:
    """What of a table has no rate, as text; place: where in a key its number of rates is."""
    found = {}
    for key, factor in table.items():
        if key[place] == 0:
            values = factor(array([Formal.named("x")])) if callable(factor) else factor
            told = [value + Formal(0) for value in (values if isinstance(values, tuple | np.ndarray) else (values,))]
            if any(value != 0 for value in told):
                found[key] = str(told)
    return found


def _relabelled(tables: Sequence[dict[Any, str]], rows: Sequence[dict[Any, str]], plane: Sequence[str]) -> Any:
    """What a plane's equations and conditions say, its names replaced by their numbers."""
    number = {name: n for n, name in enumerate(plane)}
    return (
        [
            sorted((number[row], number[of], *key, v) for (row, of, *key), v in table.items() if row in number)
            for table in tables
        ],
        sorted(sorted((number[of], *map(str, key), v) for (of, *key), v in row.items()) for row in rows),
    )
