"""Which lines between frequencies are free, of which load and damping: on data that are known, on both sides of each
condition."""

from __future__ import annotations

import math
from contextlib import nullcontext
from types import SimpleNamespace
from typing import Any

import pytest
from flint import arb

from freebeam_derive.certify import (
    damped_gaps,
    frequency_gaps,
    strips,
)
from freebeam_derive.certify.balls import precision
from freebeam_derive.certify.column_forms import ColumnForms
from freebeam_derive.certify.frequency_gaps import FrequencyGaps
from freebeam_derive.certify.load_size import _size, _together, _values
from freebeam_derive.certify.stepped_section import SteppedSection
from freebeam_derive.certify.strips import Form, NoStrips
from tests.certify.test_column_forms import HALF, ONE, F, along, at, kernel, read


def test_lines_are_free_from_the_last_gap_on_that_is_too_narrow(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of the frequencies 1, 3, 4, 7, 12 and gaps of 6 beyond, C = 1: a load of 2 is more than the gap from 3 to 4."""
    monkeypatch.setattr(FrequencyGaps, "_of_parts", lambda self, at_ends, load: (known, arb(6), arb(5) + 0 * load))
    known = [(arb(v), arb(v) + arb(2) ** -20) for v in (1, 3, 4, 7, 12)]
    it = SimpleNamespace(kernel=None, own={}, undamped=lambda *of: False)
    monkeypatch.setattr(frequency_gaps, "ColumnForms", lambda kernel, own: read())
    with precision(128):
        for load, lowest, reach in (("2", 3, 3), ("3.5", 4, 5), ("0.9", 1, 1)):
            found = FrequencyGaps(it, arb(load))  # type: ignore[arg-type]
            assert (found.lowest, found.count) == (lowest, 5) and found.lines == list(range(lowest, 5))
            assert float(found.reach) == pytest.approx(reach, rel=1e-5)
            values = [1, 3, 4, 7, 12]
            for k in found.lines:
                assert float(found.line(k)) == pytest.approx(values[k - 1] * values[k], rel=1e-5)
                wanted = min(6, *(b - a for a, b in zip(values[k - 1 :], values[k:], strict=False)))
                assert float(found.gap(k)) == pytest.approx(wanted, rel=1e-5)
                assert float(found.frequency(k)) == pytest.approx(values[k - 1])
                assert found.interval(k).contains(known[k - 1][0]) and found.interval(k).contains(known[k - 1][1])
        with pytest.raises(NoStrips, match="too narrow"):
            FrequencyGaps(it, arb("5.5"))  # type: ignore[arg-type]


def test_a_sign_changes_where_both_are_known_and_opposite() -> None:
    for one, other, changes in ((1, -1, True), (-2, 3, True), (1, 1, False), (-1, -1, False), (2, 0.5, False)):
        asked = []

        def taylor(P: arb, s: arb, orders: Any, values: Any = (one, other), asked: Any = asked) -> Any:
            asked.append((P, s))
            rad = 0.1 if len(asked) > 2 else 5  # wide at first
            return {(0, 0): arb(values[int(s == 7)], rad)}

        them: Any = object.__new__(FrequencyGaps)
        them.system = SimpleNamespace(taylor=taylor)
        assert FrequencyGaps._changes(them, F(3), F(7)) == changes and len(asked) == 4
    them.system = SimpleNamespace(taylor=lambda P, s, orders: {(0, 0): arb(1 if s == 3 else -1, 1)})
    assert not FrequencyGaps._changes(them, F(3), F(7))


def test_no_more_than_all_of_the_mass_is_at_points() -> None:
    with precision(64):
        small = read(masses=[at(ONE, 0, F(1, 10**6))])
        assert damped_gaps._share(small, arb(1)) == 1
        assert damped_gaps._share(read(masses=[at(ONE, 0, 5)]), arb(10) ** 4) < 1


def test_a_jump_is_told_from_two_values_at_its_sides() -> None:
    """Values of v with the factors of what is seen of y: of one jump where both sides have opposite ones."""
    place, seen = (HALF, 1), ((ONE, 0), 0)
    two = {seen: F(3)}, {seen: F(-3)}
    one, other = {(place, 1): F(1)}, {(place, -1): F(1)}
    jump = {(place, 1): F(1), (place, -1): F(-1)}
    assert _together({(place, 1): two[0], (place, -1): two[1]}) == [(jump, two[0])]
    assert _together({(place, 1): two[1], (place, -1): two[0]}) == [(jump, two[1])]
    assert _together({(place, 1): two[0], (place, -1): two[0]}) == [(other, two[0]), (one, two[0])]
    assert _together({(place, 1): two[0]}) == [(one, two[0])]
    assert _together({(place, 0): two[0]}) == [({(place, 0): F(1)}, two[0])]
    with precision(64):
        forms = read()
        weigh = lambda table: [(v.order, float(v.weight), v.beside) for v in _values(forms, table)]  # noqa: E731
        assert weigh({(place, 0): F(3)}) == [(1, pytest.approx(3 / math.sqrt(2)), (0, 1))]
        assert weigh({((ONE, 0), 0): F(-3)}) == [(0, 3, (1,))] and weigh({((F(0), 1), 0): F(2)}) == [(1, 2, (0,))]
        assert weigh({(place, 1): F(-2)}) == [(1, 2, (1,))] and weigh({(place, -1): F(2)}) == [(1, 2, (0,))]
        assert weigh(jump) == [(1, pytest.approx(math.sqrt(2)), (0, 1))]


def test_loads_on_curvatures_are_refused_along_the_beam_and_at_places() -> None:
    modes: Any = SimpleNamespace(count=0)
    for where in ({(0, 2, 0): 1}, {(0, 0, 2): 1}), ({}, {(1, 2, 1, 0): 1}, {(1, 0, 1, 2): 1}):
        for form in where:
            parts = (form, {}) if len(next(iter(form), (0, 0, 0))) == 3 else ({}, form)
            if form:
                with pytest.raises(NoStrips, match="acts on curvatures"):
                    Form(modes, *parts)


def test_the_least_line_that_stays_is_taken_with_its_reach(monkeypatch: pytest.MonkeyPatch) -> None:
    """Gaps that are as many times as wide are tried in turn, with twice the load; the reach of a line is the load times
    its gap over X."""
    tried = []

    def gaps(still: Any, load: arb, beyond: int = 1) -> Any:
        tried.append((float(load), beyond))
        return SimpleNamespace(lines=[2, 3, 5], gap=lambda m: arb(m), beyond=beyond)

    monkeypatch.setattr(damped_gaps, "FrequencyGaps", gaps)
    monkeypatch.setattr(damped_gaps, "ColumnForms", lambda kernel, own: read())
    monkeypatch.setattr(damped_gaps, "of_mass_alone", lambda *of: False)
    monkeypatch.setattr(damped_gaps, "_load", lambda gaps, damping, m, load, vanishing: arb("0.25"))
    left: Any = SimpleNamespace(c_E=arb(1), c_M=arb(0), low=arb(0), bare={}, forms=[read()])
    monkeypatch.setattr(damped_gaps, "over_range", lambda each: left)
    monkeypatch.setattr(damped_gaps, "LeftOver", lambda *of: None)
    still: Any = SimpleNamespace(kernel=None, own={})
    widths = damped_gaps.BEYOND
    for least, times in ((2, widths[0]), (3, widths[0]), (5, widths[1])):
        tried.clear()
        monkeypatch.setattr(
            damped_gaps, "_stays", lambda gaps, d, m, load, v, k=least, n=times: m == k and gaps.beyond == n
        )
        found = damped_gaps.damped_gaps(still, arb(7), F(1), F(0), False)
        assert found.lowest == least and float(found.reach) == pytest.approx(7 * least / 0.25)
        assert tried == [(14.0, n) for n in widths[: widths.index(times) + 1]]
    for c_E, c_M, low, served in ((0, 1, -0.5, True), (0, 1, -1, False), (0, 1, -2, False), (0, 0, 0, False),
                                  (1, 1, -2, True), (0.5, 0, -1, True), (0, 0.25, 0.5, True)):  # fmt: skip
        left.c_E, left.c_M, left.low = arb(c_E), arb(c_M), arb(low)
        monkeypatch.setattr(damped_gaps, "_stays", lambda *of: True)
        if served:
            assert damped_gaps.damped_gaps(still, arb(7), F(1), F(0), False).lowest == 2
        else:
            with pytest.raises(NoStrips, match="a part without damping"):
                damped_gaps.damped_gaps(still, arb(7), F(1), F(0), False)


def test_later_modes_are_asked_one_by_one_where_places_are_bare(monkeypatch: pytest.MonkeyPatch) -> None:
    """All from ω_m + g on; where that fails mode m + 1 alone, at its own frequency, and all from the next line on."""
    asked: list[Any] = []
    gaps: Any = SimpleNamespace(count=5, frequency=lambda m: arb(10 * m), gap=lambda m: arb(m))

    def damped(g: Any, d: Any, m: int, omega: arb, load: Any, v: Any, mode: int | None = None) -> bool:
        asked.append((m, float(omega), mode))
        return (m, mode) in holds

    holds: Any = {}
    monkeypatch.setattr(damped_gaps, "_damped", damped)
    bare: Any = SimpleNamespace(bare={1: 1})
    for kept, fine, order in (
        ({(3, None)}, True, [(3, 33, None)]),
        ({(3, 4), (4, None)}, True, [(3, 33, None), (3, 40, 4), (4, 44, None)]),
        ({(3, 4), (4, 5), (5, None)}, True, [(3, 33, None), (3, 40, 4), (4, 44, None), (4, 50, 5), (5, 55, None)]),
        ({(3, 4), (4, 5)}, False, [(3, 33, None), (3, 40, 4), (4, 44, None), (4, 50, 5), (5, 55, None)]),
        ({(4, None)}, False, [(3, 33, None), (3, 40, 4)]),
    ):
        asked.clear()
        holds = kept
        assert damped_gaps._stays(gaps, bare, 3, arb(1), False) == fine and asked == order
    asked.clear()
    assert not damped_gaps._stays(gaps, SimpleNamespace(bare={}), 3, arb(1), False) and len(asked) == 1  # type: ignore[arg-type]


def test_gaps_of_one_segment_and_of_parts_are_asked_for_as_the_load_needs(monkeypatch: pytest.MonkeyPatch) -> None:
    """C = 4: a gap of 4 times the load and times what is asked beyond; parts have the constant in what they need."""
    asked: list[Any] = []
    monkeypatch.setattr(FrequencyGaps, "_of_parts", lambda self, ends, load: (asked.append(float(load)), parts)[1])
    monkeypatch.setattr(FrequencyGaps, "_first_far", lambda self, s, needed: (asked.append(float(needed)), far)[1])
    monkeypatch.setattr(FrequencyGaps, "_enclosed", lambda self, K, top: [(F(1), F(1)), (F(49), F(49))])
    far = (2, (arb(70), arb(18)))
    parts = ([(arb(1), arb(1)), (arb(7), arb(7))], arb(18), arb("4.5"))
    one = {"places": (F(0), ONE), "mass": [along(0, 0, F(1, 16), on=(0,))], "bending": [along(2, 2, 1, on=(0,))],
           "load": [along(1, 1, -1, on=(0,))], "forces": [at(ONE, 0, 1, (ONE, 1))]}  # fmt: skip
    two = {"mass": [along(0, 0, F(1, 16))]}
    with precision(128):
        for undamped, changes, needed in (
            (True, one, 3 * 0.5 * 4), (False, one, 1.5), (True, two, 1.5), (True, one | {"masses": [at(ONE, 0, 1)]}, 6),
        ):  # fmt: skip
            asked.clear()
            monkeypatch.setattr(frequency_gaps, "ColumnForms", lambda kernel, own, c=changes: read(**c))
            still: Any = SimpleNamespace(kernel=None, own={}, undamped=lambda a, b, u=undamped: u and a == b == 0)
            found = FrequencyGaps(still, arb("0.5"), 3)
            assert asked == [needed] and float(found.size) == pytest.approx(4)
            assert found.lowest == 1 and float(found.reach) == pytest.approx(1.5)
            assert float(found.gap(1)) == pytest.approx(6) and float(found.line(1)) == pytest.approx(7)
            assert found.lines == ([1, 2] if needed == 6 else [1])
            asked.clear()
            FrequencyGaps(still, arb("0.5"))
            assert asked == [needed / 3]
            with pytest.raises(NoStrips, match="too narrow") if needed != 6 else nullcontext():
                assert FrequencyGaps(still, arb("1.5")).lowest == 2


def test_of_an_elastic_energy_what_is_not_known_to_be_positive_softens(monkeypatch: pytest.MonkeyPatch) -> None:
    """All terms but squares of one displacement or slope with a factor that is not negative."""
    monkeypatch.setattr(strips, "Form", lambda modes, along, points: (along, points))
    them: Any = object.__new__(strips.Strips)
    them.modes = None
    kept = (
        {(0, 0, 0): F(-1), (1, 0, 1): F(2), (0, 1, 0): F(3)},
        {(0, 0, 1, 0): F(2), (1, 0, 1, 1): F(1), (1, 1, 1, 1): F(-4)},
    )
    them._elastic = [{**kept[0], (2, 0, 0): F(5), (0, 1, 1): HALF}, {**kept[1], (0, 0, 0, 0): F(7), (1, 0, 1, 0): HALF}]
    along_it, points = strips.Strips.softening.func(them)
    assert ({key: F(float(f)) for key, f in along_it.items()}, {key: F(float(f)) for key, f in points.items()}) == kept


def test_what_internal_damping_leaves_over_of_a_foundation_is_less_than_external_damping() -> None:
    """c_E a is EI y'' and its share of the foundation: (5 − 6/2)/2 of the mass, where the mass is 2."""
    column = kernel(mass=[along(0, 0, 2)], bending=[along(2, 2, 1), along(0, 0, 6)],
                    damping=[along(2, 2, HALF), along(0, 0, 5)])  # fmt: skip
    with precision(64):
        found = damped_gaps.LeftOver(ColumnForms(column, {}), column, {}, ONE, ONE)
        assert (found.c_E, found.c_M, found.low, found.high, found.size) == (0.5, 1, 0, 0, 0)
        # without external damping what is left is negative, and c_M at least nothing
        column = kernel(mass=[along(0, 0, 2)], bending=[along(2, 2, 1), along(0, 0, 6, 2)], damping=[along(2, 2, HALF)],
                        masses=[at(ONE, 0, F(1, 4))], springs=[at(ONE, 0, 3)])  # fmt: skip
        found = damped_gaps.LeftOver(ColumnForms(column, {}), column, {}, ONE, ONE)
        assert (found.c_E, found.c_M) == (0.5, 0) and (found.low <= -2 < -1.5 <= found.high)
        assert float(found.low) == pytest.approx(-2, rel=0.01) and float(found.high) == pytest.approx(-1.5, rel=0.01)
        assert found.at == {(ONE, 0): -6}


def test_low_frequencies_are_looked_for_from_below_the_first_bound() -> None:
    """The bound may be the first frequency itself: that of a clamped beam, 3.516…"""
    with precision(128):
        section = SteppedSection(read())
        (first,) = section.lowest(arb(1))
        assert float(first) == pytest.approx(1.8751040687, rel=1e-9)
        section.forms.__dict__["lowest"] = (first * first * (1 - arb(2) ** -20)).lower()
        assert section.lowest(arb(1))[0].overlaps(first) and len(section.lowest(arb(1), 3)) == 3
        assert [float(g) for g in section.lowest(arb(7))] == pytest.approx([1.87510407, 4.69409113, 7.85475744])


@pytest.mark.parametrize(
    ("ends", "norms", "points"),
    [
        (("clamped", "pinned"), (1 / 3, 0.7072), (2 / 3, 1)), (("free", "clamped"), (1 / 3, 0.7072), (2 / 3, 1)),
        (("pinned", "sliding"), (1 / 2, math.sqrt(0.5)), (2 / 3, 1)), (("pinned", "pinned"), (1 / 2, 1), (1 / 2, 1)),
    ],
)  # fmt: skip
def test_displacements_and_slopes_are_bounded_by_the_curvature_as_lemma_6_says(
    ends: Any, norms: Any, points: Any
) -> None:
    with precision(64):
        found = read(ends=ends, forces=[]).reach
        for table, wanted in zip(found, (norms, points), strict=True):
            assert {order: float(bound) for order, bound in table.items()} == pytest.approx(dict(enumerate(wanted)))


def test_what_one_end_of_a_range_alone_damps_is_nothing_at_the_other() -> None:
    none = damped_gaps.LeftOver
    with precision(64):
        one, other = (object.__new__(none) for _ in range(2))
        for of, bare in ((one, {(ONE, 0): arb(2)}), (other, {(HALF, 1): arb(-3)})):
            of.forms, of.c_E, of.c_M, of.low, of.high, of.turning = [], arb(1), arb(0), arb(0), arb(0), arb(0)
            of.at, of.bare = {}, bare
        both = damped_gaps.over_range([one, other]).bare
        ends = {key: (float(f.lower()), float(f.upper())) for key, f in both.items()}
        assert ends == {(ONE, 0): pytest.approx((0, 2), abs=1e-8), (HALF, 1): pytest.approx((-3, 0), abs=1e-8)}


@pytest.mark.parametrize(("place", "where"), [(F(0), "an end"), (HALF, "a place"), (ONE, "an end")])
def test_a_moment_where_no_rotary_inertia_is_is_refused_by_where_it_is(place: Any, where: str) -> None:
    with precision(64):
        forms = read(ends=("pinned", "pinned"), load=[], forces=[at(place, 1, 1, (ONE if place != 1 else HALF, 1))])
        with pytest.raises(NoStrips, match=f"has a moment as a load on {where}"):
            _size(forms, forms.load, forms.load_points, False)
