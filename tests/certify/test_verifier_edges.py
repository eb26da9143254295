"""What the verifier refuses at the edge: signs, cells, and what it reads, one step to either side of a bound."""

from __future__ import annotations

from fractions import Fraction
from types import SimpleNamespace
from typing import Any

import flint
import pytest
from flint import arb

from freebeam_derive.certify import verifier_cells, verifier_signs, verifier_spectrum
from freebeam_derive.certify import verifier_claims as v
from freebeam_derive.certify.verifier_cells import Cells
from freebeam_derive.certify.verifier_claims import Refused
from freebeam_derive.certify.verifier_equations import over
from freebeam_derive.certify.verifier_signs import Signs, Stretch
from freebeam_derive.certify.verifier_spectrum import Circle, Enclosed
from tests.certify.refusals import served

F = Fraction


# --- signs ---------------------------------------------------------------------------------------------------------


def signs_of(R: int = 0, top: int = 40) -> Any:
    return Signs(SimpleNamespace(F=None, R=R), arb(top))  # type: ignore[arg-type]


@pytest.mark.parametrize("R", [0, 2])
def test_a_sign_is_that_of_all_loads_and_none_where_it_is_not_known(R: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """At s = 0 of F/s^R."""
    asked: list[Any] = []
    values, now = {"+": arb(1, 0.5), "-": arb(-1, 0.5), "?": arb(0, 1), "0": arb(0)}, {"which": "+"}

    def box(F: Any, P: arb, s: arb, order: int) -> Any:
        asked.append((P, order))
        return SimpleNamespace(value=lambda p, s, i, j: asked.append((i, j)) or values[now["which"]])

    monkeypatch.setattr(verifier_signs, "Box", box)
    for s, order in ((arb(0), R), (arb(3), 0)):
        for which, sign in (("+", 1), ("-", -1), ("?", 0), ("0", 0)):
            asked.clear()
            now["which"] = which
            assert signs_of(R).sign(arb(2), arb(5), s) == sign
            assert (
                asked[0][1] == order and asked[1] == (0, order) and asked[0][0].contains(2) and asked[0][0].contains(5)
            )


def test_at_rest_signs_are_those_without_load_at_all_points() -> None:
    it, asked = signs_of(), []
    it.sign = lambda low, high, s: asked.append((low, high, float(s))) or (-1) ** len(asked)
    it.at_rest([Stretch(F(0), F(0), (F(0), F(3), F(7)), None, F(0))])
    assert asked == [(0, 0, s) for s in (0, 3, 7)]
    for given in (F(0), F(1), None), (F(0), F(0), 1):
        start, end, moving = given
        assert not served(lambda: it.at_rest([Stretch(start, end, (F(0), F(3), F(7)), moving, F(0))]))  # noqa: B023
    it.sign = lambda *_: 1
    assert not served(lambda: it.at_rest([Stretch(F(0), F(0), (F(0), F(3), F(7)), None, F(0))]))


def test_points_alternate_but_for_one_that_moves() -> None:
    """Its sign follows from the others; a sign that is not known does not alternate."""
    points = tuple(map(F, (0, 3, 7, 9)))
    for given, moving, expected in (
        ("+-+-", None, [1, -1, 1, -1]), ("-+-+", None, [-1, 1, -1, 1]), ("++-+", None, None), ("+-+0", None, None),
        ("0-+-", 0, [1, -1, 1, -1]), ("+++-", 1, [1, -1, 1, -1]), ("+0+-", 1, [1, -1, 1, -1]), ("+0--", 1, None),
        ("0+-+", None, None), ("+-+0", 3, [1, -1, 1, -1]),
    ):  # fmt: skip
        it = signs_of()
        known = dict(zip(map(float, points), given, strict=True))
        it.sign = lambda low, high, s, known=known: {"+": 1, "-": -1, "0": 0}[known[float(s)]]

        def found(it: Any = it, moving: int | None = moving) -> Any:
            return it.alternate(arb(1), arb(2), points, moving)

        if expected is None:
            assert not served(found)
        else:
            assert found() == expected


def test_stretches_are_without_gap_and_left_of_the_line() -> None:
    def stretch(start: int, end: int, *points: int, moving: int | None = None) -> Stretch:
        return Stretch(F(start), F(end), tuple(map(F, points)), moving, F(0))

    one, two = stretch(0, 1, 0, 3, 39), stretch(1, 2, 0, 3, 39)
    last = stretch(1, 2, 0, 3, 39, moving=1)
    for stretches, moves, right in (
        ([one], False, True), ([one, two], False, True), ([one, last], True, True), ([], False, False),
        ([stretch(1, 2, 0, 3)], False, False), ([one, stretch(2, 3, 0, 3)], False, False), ([one, one], False, False),
        ([one, stretch(1, 1, 0, 3)], False, False), ([one, two], True, False), ([one, last], False, False),
        ([last, two], True, False), ([stretch(0, 1, 0, 3, 40)], False, False), ([stretch(0, 1, 0, 41)], False, False),
    ):  # fmt: skip
        assert served(lambda s=stretches, m=moves: signs_of().check_order(s, m)) is right  # type: ignore[misc]


def test_the_lowest_frequency_is_damped_where_f_does_not_change_up_to_it() -> None:
    """From 0 to an s below the first point; of a column without rigid motions."""
    stretches = [Stretch(F(0), F(1), (F(0), F(3), F(7)), None, F(0))]
    for s, given, R, right in (
        (F(0), "--", 0, True), (F(0), "+-", 1, True), (F(2), "++", 0, True), (F(2), "--", 0, True),
        (F(2), "+-", 0, False), (F(2), "+0", 0, False), (F(3), "++", 0, False), (F(2), "++", 1, False),
        (F(1), "+-", 0, False),
    ):  # fmt: skip
        it, asked = signs_of(R), []
        it.sign = lambda low, high, s, given=given, asked=asked: (
            asked.append((low, high)) or {"+": 1, "-": -1, "0": 0}[given[int(not s.is_zero())]]
        )
        assert served(lambda it=it, s=s: it.above(s, stretches)) is right  # type: ignore[misc]
        assert all(low == high == 0 for low, high in asked)


def test_a_zero_at_rest_is_the_one_of_an_interval_that_is_known(monkeypatch: pytest.MonkeyPatch) -> None:
    """F(P, 0) = P − 4: monotonic on the cell, of which the interval is a part, and no other is near."""
    now = {"slope": 1}
    box = SimpleNamespace(value=lambda P, s, i, j: arb(1) if now["slope"] else arb(0, 1))
    monkeypatch.setattr(verifier_signs, "Box", lambda *_: box)
    it = signs_of()
    it.sign = lambda low, high, s: (float(low) > 4) - (float(low) < 4)
    for cell, known, now["slope"], right in (
        ((3, 5), [(F(7, 2), F(9, 2))], 1, True), ((3, 5), [(F(3), F(5))], 1, True),
        ((3, 5), [(F(2), F(9, 2))], 1, False), ((3, 5), [(F(7, 2), F(6))], 1, False),
        ((3, 5), [(F(7, 2), F(9, 2))], 0, False), ((3, 5), [], 1, False), ((5, 6), [], 1, True),
        ((5, 6), [(F(4), F(5))], 1, False), ((5, 6), [(F(6), F(7))], 1, False),
        ((5, 6), [(F(1), F(2)), (F(7), F(8))], 1, True),
        ((3, 5), [(F(7, 2), F(15, 4)), (F(31, 8), F(9, 2))], 1, False), ((4, 5), [], 1, False),
    ):  # fmt: skip
        assert it._one_zero(*map(F, cell), known) is right


def test_on_the_line_through_a_crossing_f_falls_or_rises_as_it_must(monkeypatch: pytest.MonkeyPatch) -> None:
    """Up to P* against the sign that the moving point has below, between its neighbours; of a flutter not the first."""
    now = {"rising": 0}
    box = SimpleNamespace(value=lambda P, s, i, j: arb(now["rising"]))
    monkeypatch.setattr(verifier_signs, "Box", lambda F, P, s, order: box)
    monkeypatch.setattr(verifier_signs, "along", lambda box, P, s, slope: box.value(P, s, 1, 0))
    points = tuple(map(F, (0, 3, 7, 20)))
    wanted = [1, -1, 1, -1]
    for moving, slope, s, now["rising"], right in (
        (1, F(1), arb(5), 2, True), (1, F(1), arb(5), -2, False), (2, F(1), arb(5), -2, True),
        (1, F(1), arb(5), 0, False),
        (1, F(-3), arb(5), 2, False), (1, F(6), arb(5), 2, False), (1, F(1), arb(7), 2, False),
        (0, F(1), arb(5), -2, False),
        (0, F(0), arb(0), -2, True), (1, F(0), arb(0), 2, False), (0, F(0), arb(0), 2, False),
    ):  # fmt: skip
        stretch = Stretch(F(3), F(4), points, moving, slope)
        with flint.ctx.workprec(64):
            crossing = [arb(4, 0.001), s]
            check = lambda stretch=stretch, crossing=crossing: signs_of()._through(arb(3), stretch, wanted, crossing)  # noqa: E731
            assert served(check) is right


# --- cells ---------------------------------------------------------------------------------------------------------


class Still:
    """Equations without a zero but at given points: on a cell their values are how far it is from these."""

    real, R = True, 0

    def __init__(self, *zeros: tuple[float, float], too_large: float = 100.0) -> None:
        self.zeros, self.too_large, self.boxes = zeros, too_large, 0

    def place(self, P: arb, x: arb) -> tuple[arb, arb]:
        return P, x

    def box(self, P: arb, x: arb) -> Any:
        self.boxes += 1
        if float(P.rad()) > self.too_large:
            raise ArithmeticError("the box is too large")
        return SimpleNamespace(value=None)

    def system(self, value: Any, P: arb, x: arb) -> Any:
        hit = any(P.contains(p) and x.contains(s) for p, s in self.zeros)
        return [arb(0, 1) if hit else arb(1)] * 2, [[arb(1), arb(0)], [arb(0), arb(1)]]

    def centre(self, value: Any, P: arb, x: arb) -> Any:
        return [arb(0), arb(0)]


def test_cells_are_all_of_a_rectangle() -> None:
    """Boxes that are too large are cut; what is cut too often, or takes too long, is refused; none is left out."""
    for too_large in (100.0, 1.0, 0.3):
        it = Cells(Still(too_large=too_large), F(4), [])  # type: ignore[arg-type]
        it.check(F(81))
        assert it.covered == 4 * 81
    it = Cells(Still(too_large=0.0), F(4), [])  # type: ignore[arg-type]
    with pytest.raises(Refused, match="near the load"):
        it.check(F(81))
    it = Cells(Still(), F(4), [])  # type: ignore[arg-type]
    it.tile = lambda P, x, cuts: None  # type: ignore[method-assign]
    with pytest.raises(Refused, match="do not cover"):
        it.check(F(81))


def test_a_part_is_cut_so_often_and_no_more(monkeypatch: pytest.MonkeyPatch) -> None:
    for cuts, right in ((verifier_cells.MOST_CUTS, True), (verifier_cells.MOST_CUTS + 1, False)):
        it = Cells(Still(), F(4), [])  # type: ignore[arg-type]
        # only where both are least does it go so deep
        monkeypatch.setattr(it, "_with_one_box", lambda P, x, cuts=cuts: P[0] + x[0] > 0 or P[1] <= F(4, 2**cuts))
        assert served(lambda it=it: it.tile((F(0), F(4)), (F(0), F(1)), 0)) is right  # type: ignore[misc]
        it.boxes, it.covered = 0, F(0)
    for most, right in ((5, True), (4, False)):
        it = Cells(Still(), F(4), [])  # type: ignore[arg-type]
        monkeypatch.setattr(it, "_with_one_box", lambda P, x: P[1] - P[0] <= 2)
        monkeypatch.setattr(verifier_cells, "MOST_BOXES", most)
        assert served(lambda it=it: it.tile((F(0), F(4)), (F(0), F(1)), 0)) is right  # type: ignore[misc]
        assert not right or it.covered == 4


def test_a_cell_with_a_known_crossing_alone_is_passed_and_with_another_not() -> None:
    known = [arb(1, 0.01), arb(5, 0.01)]
    crossing = Cells(Still((1.0, 5.0)), F(4), [known])  # type: ignore[arg-type]
    assert crossing._near([arb(1.5, 0.3), arb(5)]) == [known] and not crossing._near([arb(1.7, 0.3), arb(5, 1)])
    assert crossing._known_alone(SimpleNamespace(value=None), [arb(1, 0.5), arb(5, 1)], [])
    assert crossing._known_alone(SimpleNamespace(value=None), [arb(9, 0.5), arb(5, 1)], [known])
    assert not crossing._known_alone(SimpleNamespace(value=None), [arb(9, 0.5), arb(5, 1)], [])
    two = Cells(Still(), F(4), [known, [arb(1.1, 0.01), arb(5, 0.01)]])  # type: ignore[arg-type]
    assert not two._known_alone(SimpleNamespace(value=None), [arb(1, 0.5), arb(5, 1)], [])


def test_a_zero_is_led_out_of_a_cell_by_its_values() -> None:
    """Krawczyk's image is the zero: J is the identity, and values at the middle say how far it is."""
    it, J = Cells(Still(), F(4), []), [[arb(1), arb(0)], [arb(0), arb(1)]]  # type: ignore[arg-type]
    X, middle = [arb(1, 0.5), arb(5, 1)], [arb(1), arb(5)]
    for at, out in (((0.4, 0.9), False), ((0.6, 0), True), ((0, 1.1), True), ((-0.6, 0), True), ((0, -1.1), True)):
        assert it._led_out(X, middle, [arb(w) for w in at], J) is out


def test_cells_are_excluded_by_values_or_by_slopes_and_cut_where_they_change_more() -> None:
    class Slopes(Still):
        values, J, at = [arb(0, 1)] * 2, [[arb(0), arb(0)], [arb(0), arb(0)]], [arb(0)] * 2

        def system(self, value: Any, P: arb, x: arb) -> Any:
            return self.values, self.J

        def centre(self, value: Any, P: arb, x: arb) -> Any:
            return self.at

    of = Slopes()
    it = Cells(of, F(4), [])  # type: ignore[arg-type]
    P, x, box = arb(2, 0.5), arb(5, 0.25), SimpleNamespace(value=None)

    def cut(values: Any, J: Any, at: Any) -> int | None:
        of.values, of.J, of.at = ([*map(arb, values)] if values else [arb(0, 1)] * 2), J, [*map(arb, at)]
        return it.excluded(box, P, x, [])

    flat = [[arb(1, 2), arb(1, 2)], [arb(1, 2), arb(1, 2)]]
    assert cut((1, 1), flat, (0, 0)) is None and cut(None, flat, (0, 0)) == 0
    wide = [[arb(0, 1), arb(0, 3)], [arb(0, 1), arb(0, 3)]]
    assert cut(None, wide, (0.1, 0.1)) == 1  # 1/2 and 3/4
    assert (
        cut(None, wide, (1.2, 0.1)) == 1
        and cut(None, wide, (1.26, 0.1)) is None
        and cut(None, wide, (0.1, -1.26)) is None
    )
    even = [[arb(0, 1), arb(0, 2)], [arb(0, 1), arb(0, 2)]]
    assert cut(None, even, (0.1, 0.1)) == 0  # as much


# --- spectra -------------------------------------------------------------------------------------------------------


def test_an_eigenvalue_in_a_file_is_somewhere_and_as_narrow_as_may_be() -> None:
    for re, im, radius, right in (
        ("-1", "2", "1/10", True), ("1", "0", "1/10", True), ("-1", "1/10", "1/10", False), ("-1", "1/9", "1/10", True),
        ("-1", "-2", "1/10", False), ("10000", "0", "1", True), ("10001", "0", "1", False), ("0", "10001", "1", False),
        ("-10001", "0", "1", False), ("0", "0", "10000", True), ("0", "0", "10001", False), ("1", "2", "0", False),
        ("1", "2", "-1", False), ("0", "0", "1/10", True),
    ):  # fmt: skip
        data = {"re": re, "im": im, "radius": radius}
        assert served(lambda data=data: verifier_spectrum._enclosed(data)) is right  # type: ignore[misc]


def test_squares_are_apart_and_hold_numbers_up_to_their_edges() -> None:
    one = Enclosed(F(1), F(2), F(1, 4))
    for re, im, apart in (
        (1, 2, False),
        (F(3, 2), F(5, 2), False),
        (F(7, 4), 2, True),
        (1, F(11, 4), True),
        (0, 2, True),
    ):
        assert one.apart(Enclosed(F(re), F(im), F(1, 4))) is apart
    assert Enclosed(F(1), F(2), F(1, 4)).count == 2 and Enclosed(F(1), F(0), F(1, 4)).count == 1
    real = Enclosed(F(1), F(0), F(1, 4))
    assert [real.contains(F(x)) for x in (0, F(3, 4), 1, F(5, 4), 2)] == [False, True, True, True, False]
    assert Enclosed(F(1), F(1, 4), F(1, 4)).contains(F(1)) and not one.contains(F(1))


def test_arcs_are_counted_and_halved_up_to_a_bound(monkeypatch: pytest.MonkeyPatch) -> None:
    """Each turns by 3π of its part of the half circle, where it is short enough."""
    for shortest, most, right in (
        (F(1, 32), 16 + 32, True), (F(1, 32), 16 + 31, False), (F(1, 16), 16, True), (F(1, 16), 15, False),
        (F(1, 2**14), 2000, False),
    ):  # fmt: skip
        monkeypatch.setattr(verifier_spectrum, "MOST_ARCS", most)
        circle = Circle(None, F(1))  # type: ignore[arg-type]
        circle.turned = lambda low, high, shortest=shortest: (
            3 * arb.pi() * v.ball(high - low) if high - low <= shortest else None
        )  # type: ignore[method-assign]
        assert served(circle.zeros) is right
        if right:
            assert circle.zeros() == 3
    monkeypatch.setattr(verifier_spectrum, "MOST_ARCS", 10**6)
    for shortest, right in ((verifier_spectrum.SHORTEST, True), (verifier_spectrum.SHORTEST / 2, False)):
        circle.turned = lambda low, high, shortest=shortest: (  # type: ignore[method-assign]
            None if low == 0 and high > shortest else arb.pi() * v.ball(high - low)
        )
        assert served(circle.zeros) is right


def test_ends_of_an_interval_are_in_its_ball() -> None:
    found = over((F(1, 3), F(5, 7)))
    assert found.contains(v.ball(F(1, 3))) and found.contains(v.ball(F(5, 7))) and not found.contains(arb("0.72"))
