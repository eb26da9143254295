"""Dampings and columns between two, motions without mass, and matrices: what the verifier takes and refuses."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from types import SimpleNamespace
from typing import Any

import flint
import numpy as np
import pytest
from flint import arb, arb_mat, fmpq, fmpq_mat, fmpq_poly

from freebeam_derive.certify import verifier, verifier_over_sections
from freebeam_derive.certify.verifier_claims import Refused
from freebeam_derive.certify.verifier_damping_forms import split
from freebeam_derive.certify.verifier_degrees import of_entries
from freebeam_derive.certify.verifier_of_matrices import _entry, _Part
from freebeam_derive.certify.verifier_over_sections import Between, between, check_one_condition
from freebeam_derive.certify.verifier_sections import Sections
from tests.certify.refusals import served

F = Fraction


def column(**given: Any) -> Sections:
    fixed: Any = {
        "ends": ("clamped", "free"), "breaks": (F(0), F(1, 2), F(1)), "EI": [fmpq_poly([3]), fmpq_poly([3])],
        "m": [fmpq_poly([2]), fmpq_poly([4, 2])], "elastic": [{}, {}], "load": [{}, {}], "masses": {(2, 0): F(5)},
        "springs": {}, "forces": {},
    }  # fmt: skip
    return Sections(**fixed | given)


# --- damping ---------------------------------------------------------------------------------------------------------


def parts(c_E: Any, c_M: Any, *beside: Any) -> list[Any]:
    """Forms of damping of the column, c_E E + c_M M along the beam, and more with v y."""
    E, M = (fmpq(F(c).numerator, F(c).denominator) for c in (c_E, c_M))
    tables = []
    for n, EI in enumerate(([3], [3])):
        f = fmpq_poly([[2], [4, 2]][n]) * M + (beside[n] if beside else fmpq_poly([]))
        tables.append({key: g for key, g in (((2, 2), fmpq_poly(EI) * E), ((0, 0), f)) if g.coeffs()})
    return tables


def test_a_damping_is_what_its_form_says() -> None:
    with flint.ctx.workprec(64):
        found = split(parts("1/3", "1/2"), {((2, 0), (2, 0)): F(7)}, False, column())
        assert (found.c_E, found.c_M, found.vanishing, found.points) == (F(1, 3), F(1, 2), False, {(2, 0): 7 - F(5, 2)})
        assert all(not f.coeffs() for table in found.along for f in table.values()) and not found.plain
        assert split(parts("1/3", "1/2"), {((2, 0), (2, 0)): F(5, 2)}, False, column()).plain
        springs = column(springs={(2, 0): F(6)})
        assert split(parts("1/3", "1/2"), {((2, 0), (2, 0)): F(7)}, False, springs).points == {(2, 0): 7 - 2 - F(5, 2)}
        # where it is no number times the mass, one in the middle
        more = split(parts(1, 0, fmpq_poly([2]), fmpq_poly([12, 6])), {}, False, column())
        assert float(more.c_M) == pytest.approx(2, rel=1e-3)
        assert [float(f(0)) for table in more.along for f in table.values()] == pytest.approx([-2, 4], abs=0.02)


@pytest.mark.parametrize(("tables", "points", "vanishing", "right"), [
    (parts(1, 0), {}, False, True), (parts(0, 1), {}, False, True), (parts(0, 0), {}, False, False),
    (parts(1, 0), {(1, 0): 3}, True, True), (parts(1, 0), {(1, 0): 3}, False, False),
    (parts(0, 1), {(1, 0): 3}, True, False),
    (parts(0, 1), {(2, 0): 3}, False, True), (parts(1, 0), {(2, 0): -3}, False, False),
    (parts(1, 0), {(1, 0): 0}, False, True),
    (parts(1, 0, fmpq_poly([2, -2]), fmpq_poly([1])), {}, False, True),
    (parts(1, 0, fmpq_poly([1]), fmpq_poly([1, -2])), {}, False, False),
    (parts(1, 0, fmpq_poly([1]), fmpq_poly([-1])), {}, False, False),
    ([{(2, 2): fmpq_poly([3])}, {(2, 2): fmpq_poly([6])}], {}, False, False),
    ([{(2, 2): fmpq_poly([3])}, {(2, 2): fmpq_poly([3, 1])}], {}, False, False),
    ([{(2, 2): fmpq_poly([3]), (0, 1): fmpq_poly([1])}, {(2, 2): fmpq_poly([3])}], {}, False, False),
])  # fmt: skip
def test_a_damping_takes_energy_and_acts_on_what_has_mass(
    tables: Any, points: Any, vanishing: bool, right: bool
) -> None:
    with flint.ctx.workprec(64):
        at = {(key, key): F(f) for key, f in points.items()}
        assert served(lambda: split(tables, at, vanishing, column())) is right


# --- between two columns ---------------------------------------------------------------------------------------------


def test_two_columns_of_a_range_differ_in_one_condition() -> None:
    one = column(springs={(1, 0): F(1)}, forces={((2, 0), (2, 1)): F(2)})
    for other, right in (
        ({}, True), ({"masses": {(2, 0): F(9)}}, True), ({"masses": {}}, True), ({"springs": {}}, True),
        ({"masses": {(2, 0): F(5), (2, 1): F(0)}}, True), ({"masses": {(2, 0): F(9), (2, 1): F(1)}}, False),
        ({"masses": {(2, 0): F(9)}, "springs": {}}, False),
        ({"springs": {(1, 0): F(1), (2, 0): F(1)}, "masses": {}}, True),
        ({"forces": {((2, 0), (2, 1)): F(3)}, "masses": {(2, 0): F(9)}}, True), ({"forces": {}, "springs": {}}, False),
        ({"forces": {((2, 0), (2, 1)): F(3), ((2, 0), (1, 0)): F(1)}}, True), ({"EI": [fmpq_poly([4])] * 2}, False),
        ({"forces": {((2, 0), (2, 1)): F(2), ((2, 1), (2, 1)): F(1)}, "masses": {}}, False),
    ):  # fmt: skip
        assert served(lambda other=other: check_one_condition(one, replace(one, **other))) is right  # type: ignore[misc]


def test_dampings_of_a_range_differ_in_one_condition_with_the_columns() -> None:
    one, other = column(), column(masses={(2, 0): F(9)})
    still = [{0: fmpq_poly([1])}]

    def damping(c_E: int = 1, c_M: int = 1, along: Any = still, **points: int) -> Any:
        of = {(int(name[1]), int(name[2])): F(f) for name, f in points.items()}
        return SimpleNamespace(c_E=c_E, c_M=c_M, along=along, points=of)

    for second, right in (
        (damping(), True), (damping(_20=3), True), (damping(_21=3), False), (damping(_21=0), True),
        (damping(c_E=2), False),
        (damping(c_M=2), False), (damping(along=[{}]), False),
    ):  # fmt: skip
        for both in ((damping(), second), (second, damping())):
            assert served(lambda both=both: check_one_condition(one, other, *both)) is right  # type: ignore[misc]
        check_one_condition(one, one, damping(), second)


def test_between_two_columns_all_is_linear() -> None:
    one = column(springs={(1, 0): F(1)}, forces={((2, 0), (2, 1)): F(2)})
    other = column(masses={(2, 0): F(9), (2, 1): F(4)}, forces={((2, 0), (2, 1)): F(6)})
    found = between(one, other, F(1, 4))
    assert found == replace(
        one, masses={(2, 0): F(6), (2, 1): F(1)}, springs={(1, 0): F(3, 4)}, forces={((2, 0), (2, 1)): F(3)}
    )


def test_f_between_two_is_half_their_sum_and_half_their_difference() -> None:
    low, high = (
        SimpleNamespace(P=arb(2), s=arb(0), S=arb(3), precision=p, rest=arb(rest), levels=[arb_mat(rows)])
        for p, rest, rows in ((70, 1, [[1, 2, 3]]), (80, 3, [[5], [6]]))
    )
    for one, two, way in ((low, high, 1), (high, low, -1)):
        found = Between(one, two)  # type: ignore[arg-type]
        assert (found.precision, float(found.rest)) == (80, 3)
        middle, half = (np.array([[float(v) for v in row] for row in X.tolist()]) for X in found.levels)
        assert np.array_equal(middle, [[3, 1, 1.5], [3, 0, 0]])
        assert np.array_equal(half * way, [[2, -1, -1.5], [3, 0, 0]])


def test_a_piece_of_a_range_is_as_long_as_its_share() -> None:
    """Columns at both ends of each piece, and of one column one alone; all pieces are looked at before any is begun."""
    one, other = column(), column(masses={(2, 0): F(9)})
    with pytest.MonkeyPatch.context() as patch:
        done: list[Any] = []

        class Stand:
            def __init__(self, *given: Any, **_: Any) -> None:
                self.given = given

            def check_order(self, stretches: Any) -> None:
                done.append(("order", stretches))

            def check(self, stretches: Any) -> None:
                done.append(("check", stretches))

        for name in ("Pieces", "OverPieces", "Gaps", "First", "Equations"):
            patch.setattr(verifier_over_sections, name, type(name, (Stand,), {}))
        built: list[Any] = []
        patch.setattr(verifier_over_sections, "Gaps", lambda *given: built.append(given))
        pieces = tuple(
            verifier_over_sections.OfPiece(F(low), F(high), 9, k, "flutter", (F(1), F(2)), None, (k,), F(50))  # type: ignore[arg-type]
            for k, (low, high) in enumerate(((10, 11), (11, 14)))
        )
        for columns, count in (((one, other), 2), ((one, one), 1)):
            stated = SimpleNamespace(low=F(10), high=F(14), pieces=pieces)
            patch.setattr(verifier_over_sections, "read", lambda data, c=columns, s=stated: (s, c, []))
            built.clear()
            done.clear()
            assert verifier_over_sections.verify_over_sections({}) is stated  # type: ignore[comparison-overlap]
            for (each, m, line, over), k, shares in zip(built, (0, 1), ((0, F(1, 4)), (F(1, 4), 1)), strict=True):
                assert (m, line, over) == (k, 50, None)
                expected = [between(*columns, share) for share in shares][:count]
                assert [of for of, _ in each] == expected and [F.given for _, F in each] == [(of,) for of in expected]
            assert done == [("order", (0,)), ("order", (1,)), ("check", (0,)), ("check", (1,))]


@pytest.mark.parametrize(("vanishing", "two", "kind"), [
    (True, True, "RatesOver"), (True, False, "RatesOver"), (False, True, "RatesOver"),
    (False, False, "RatesOverDamping"),
])  # fmt: skip
def test_dampings_of_a_piece_are_those_at_its_shares(vanishing: bool, two: bool, kind: str) -> None:
    one = column()
    columns = one, column(masses={(2, 0): F(9)}) if two else one
    piece = verifier_over_sections.OfPiece(F(11), F(14), 9, 3, "flutter", (F(1), F(2)), None, (), F(50))
    stated = SimpleNamespace(low=F(10), high=F(14), pieces=(piece,))
    names = "Pieces", "OverPieces", "First", "Equations", "Rates", "RatesOver", "RatesOverDamping", "Gaps"
    made: dict[str, list[Any]] = {name: [] for name in names}
    with pytest.MonkeyPatch.context() as patch:
        of = verifier_over_sections
        for name in names:
            patch.setattr(of, name, lambda *given, name=name, **_: made[name].append(given) or SimpleNamespace(
                name=name, given=given, check_order=lambda _: None, check=lambda _: None))  # fmt: skip
        patch.setattr(of, "read", lambda data: (stated, columns, ["low", "high"]))
        patch.setattr(of.verifier_damping_forms, "between", lambda a, b, share: (f"{a}-{b}", share))
        patch.setattr(of, "split", lambda form, share, vanishing, column: (form, share, vanishing, column))
        patch.setattr(of, "DampedOver", SimpleNamespace(of=lambda *both: ("over", *both)))
        of.verify_over_sections({"damping": [{"vanishing": vanishing}, {}]})
    shares = F(1, 4), F(1)
    each = [("low-high", share, vanishing, between(*columns, share)) for share in shares]
    ((gaps, m, line, over),) = made["Gaps"]
    assert over == ("over", *each) and (m, line, len(gaps)) == (3, 50, 1 + two)
    ((given),) = made[kind]
    assert len(made["RatesOver"]) + len(made["RatesOverDamping"]) == 1
    if kind == "RatesOver":
        assert given[0].name == "OverPieces" and [rates.given[1] for rates in given[1:]] == each
        assert [rates.given[0].given[0] for rates in given[1:]] == [damping[3] for damping in each]
    else:
        assert given[0].name == "Pieces" and given[0].given == (one,) and [*given[1:]] == each


# --- motions without mass, determinants, matrices in balls -----------------------------------------------------------


def test_a_determinant_is_that_of_its_rows() -> None:
    draw = np.random.default_rng(4)
    for n in (1, 2, 3, 4):
        rows = draw.integers(-9, 10, (n, n))
        assert float(verifier.determinant([[arb(int(v)) for v in row] for row in rows])) == pytest.approx(
            np.linalg.det(rows)
        )


@pytest.mark.parametrize("seed", range(24))
def test_coordinates_without_mass_decay_where_all_their_rates_are_negative(seed: int) -> None:
    """det(μ C + K) of two or three of them, with C and K by powers of the load."""
    draw = np.random.default_rng(seed)
    n = 2 + seed % 2
    C, K = ([draw.integers(-3, 4, (n, n)) + 3 * np.eye(n, dtype=int) * (k == 0) for k in range(2)] for _ in "ck")
    P = 0.25
    at = [of[0] + P * of[1] for of in (C, K)]
    rates = np.linalg.eigvals(np.linalg.solve(at[0], -at[1])) if abs(np.linalg.det(at[0])) > 1e-9 else [1]
    fast = verifier.Fast(*([fmpq_mat(X.tolist()) for X in of] for of in (C, K)), count=n)
    with flint.ctx.workprec(64):
        assert fast._decay(arb(P)) is bool(max(np.real(rates)) < 0)


def test_all_loads_are_looked_at_for_coordinates_without_mass() -> None:
    seen: list[Any] = []

    class Narrow(verifier.Fast):
        def _decay(self, P: arb) -> bool:
            wide = 2 * float(P.rad())
            if wide <= width * 1.001:
                seen.append((float(P.mid()) - wide / 2, float(P.mid()) + wide / 2))
            return wide <= width * 1.001

    width = 2.0
    Narrow([], [], 1).decay(F(8))
    edges = sorted(seen)
    assert [*edges[0], *edges[1], *edges[2], *edges[3]] == pytest.approx([0, 2, 2, 4, 4, 6, 6, 8], abs=1e-6)
    width = 0.0
    with pytest.raises(Refused, match="may not decay at the load"):
        Narrow([], [], 1).decay(F(8))


def test_a_place_on_a_break_is_seen_from_the_side_that_is_meant() -> None:
    space = verifier.Space((F(0), F(1, 3), F(1)), {"y": (2, set(), set())}, ("q",), 4)
    assert [space.value("y", 0, F(1, 3), side)[0] for side in (-1, 0, 1)] == [0, 4, 4]
    assert [space.value("y", 0, place, 0)[0] for place in (F(0), F(1, 4), F(1, 2), F(1))] == [0, 0, 4, 4]
    assert space.value("y", 1, F(1, 3), -1)[1] == [0, 3, 6, 9] and space.value("q", 0, None, 0) == (8, [1])


def table(rows: list[list[int]]) -> Any:
    return [[(F(v), F(0)) for v in row] for row in rows]


def test_gyroscopic_terms_are_those_written_as_skew_beside_what_is_symmetric() -> None:
    M, K, skew, turn = (
        [table(rows)] for rows in ([[2, 1], [1, 3]], [[5, 2], [2, 7]], [[0, 4], [-4, 0]], [[0, 4], [4, 0]])
    )
    other = [table([[5, 2], [3, 7]])]
    for given, limit, found, damped in (
        ((M, skew, K), False, True, False), ((M, turn, K), False, False, True), ((M, skew, other), False, False, True),
        ((other, skew, K), False, False, True), ((M, skew, K), True, False, True), ((M, [], K), False, False, False),
    ):  # fmt: skip
        part = _Part.of(dict(zip("MCK", given, strict=True)), [0, 1], limit)
        assert (
            (part.skew, part.damped, part.known.highest) == (found, damped, 4) and part.known.even is not damped
        ) or limit


def test_a_part_is_the_first_again_or_so_but_for_the_unit_of_time() -> None:
    M, C, K = [table([[2, 0], [0, 2]])], [table([[1, 0], [0, 1]])], [table([[3, 0], [0, 6]])]
    first = _Part.of({"M": M, "C": [], "K": K}, [0], False)
    again = _Part.of({"M": M, "C": [], "K": K}, [1], False)
    assert first.scale(first) == 1 and again.scale(first) == 2 and first.scale(again) == F(1, 2)
    damped = [_Part.of({"M": M, "C": C, "K": K}, [n], False) for n in (0, 1)]
    assert damped[0].scale(damped[0]) == 1 and not served(lambda: damped[1].scale(damped[0]))
    falling = _Part.of({"M": M, "C": [], "K": [table([[-3, 0], [0, 6]])]}, [0], False)
    assert not served(lambda: falling.scale(again)) and not served(lambda: damped[0].scale(first))


def test_an_entry_is_a_number_or_a_middle_and_a_radius() -> None:
    assert _entry("1/2") == (F(1, 2), 0) and _entry(["1/2", "1/8"]) == (F(1, 2), F(1, 8))
    for wrong in (["1/2", "0"], ["1/2", "-1/8"], ["1/2"], ["1", "2", "3"], 1):
        assert not served(lambda wrong=wrong: _entry(wrong))  # type: ignore[misc]


def test_opposite_numbers_are_on_either_side_of_zero_and_not_zero() -> None:
    values = {"-": arb(-1), "0": arb(0), "+": arb(1), "?": arb(0, 1)}
    opposite = {a + b for a in values for b in values if verifier.opposite(values[a], values[b])}
    assert opposite == {"-+", "+-"}


def test_what_entries_tell_of_rest_is_of_rates_without_load() -> None:
    """A row of K without load that is nothing is a motion that rests, apart from rates where C has nothing there."""
    M, K, some = [[True, False], [False, True]], [[False, False], [False, True]], [[True, False], [False, True]]
    below = [[False, False], [False, True]]
    for C, apart in (([below], True), ([some], False), ([below, some], True), ([some, below], False), ([], True)):
        found = of_entries([M], C, [K, some])  # type: ignore[arg-type]
        assert (found.resting, found.apart, found.highest, found.even) == (1, apart, 4, not C)


def test_entries_tell_that_a_determinant_is_even_where_signs_can_be_given() -> None:
    """M and K link coordinates of one sign, C those of different ones: along a chain, and not around three."""

    def linked(*pairs: tuple[int, int]) -> list[list[bool]]:
        return [[(i, j) in pairs or (j, i) in pairs or i == j for j in range(3)] for i in range(3)]

    diagonal = linked()
    for of_K, of_C, even in (
        ((), ((0, 1), (1, 2)), True), (((0, 1),), ((1, 2),), True), (((0, 1),), ((0, 1),), False),
        ((), ((0, 1), (1, 2), (0, 2)), False), (((0, 2),), ((0, 1), (1, 2)), True),
        (((0, 2), (0, 1)), ((1, 2),), False),
    ):  # fmt: skip
        C = [[here and i != j for j, here in enumerate(row)] for i, row in enumerate(linked(*of_C))]
        assert of_entries([diagonal], [C], [linked(*of_K)]).even is even  # type: ignore[arg-type]


def test_motions_of_gyroscopic_terms_have_determinants_that_are_even() -> None:
    """Two pairs: with C skew, and M and K symmetric; not where C damps, or K is not symmetric, or damping vanishes."""

    def of(C: list[int], K: list[int]) -> Any:
        """Of each pair what is above and below the diagonal; K has more on it."""
        found = []
        for above, below, diagonal in ((0, 0, (1, 1, 1, 1)), (C[0], C[1], (0,) * 4), (K[0], K[1], (2, 5, 3, 7))):
            rows = [[diagonal[i] * (i == j) for j in range(4)] for i in range(4)]
            for n in (0, 2):
                rows[n][n + 1], rows[n + 1][n] = above * (n + 1), below * (n + 1)
            found.append([fmpq_mat(rows)])
        return found

    for C, K, limit, even in (
        ([1, -1], [0, 0], False, True), ([1, 1], [0, 0], False, False), ([1, -1], [1, 2], False, False),
        ([1, -1], [1, 1], False, True), ([1, 1], [0, 0], True, False), ([0, 0], [1, 1], False, False),
    ):  # fmt: skip
        each = verifier.motions(of(C, K), limit)
        assert [motion.even for motion in each] == [even] * len(each) and len(each) >= 2
