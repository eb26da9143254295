"""What the prover decides, on data for which the answer is known: on both sides of each condition, and in the order in
which things are told."""

from __future__ import annotations

import math
from contextlib import nullcontext
from fractions import Fraction
from itertools import pairwise
from types import SimpleNamespace
from typing import Any

import flint
import numpy as np
import pytest
from flint import acb, arb, arb_poly, fmpq

from freebeam_derive.certify import (
    balls,
    beam_crossings,
    beam_itself,
    beam_stability,
    certificate,
    damped_gaps,
    frequency_gaps,
    one_load,
    ranges,
    strips,
)
from freebeam_derive.certify.all_crossings import _interval, _scale, _told, turns_fast
from freebeam_derive.certify.balls import Unproven, exact, precision
from freebeam_derive.certify.beam import Beam, Coefficient, NoSeries
from freebeam_derive.certify.beam_cells import OpenStep
from freebeam_derive.certify.beam_crossings import Survey, _Passing
from freebeam_derive.certify.beam_itself import Coalescence, Damped, NoOnset, Static, VanishingDamping, VanishingRates
from freebeam_derive.certify.boundary_polynomials import Boundary
from freebeam_derive.certify.column_forms import ColumnForms
from freebeam_derive.certify.frequency_gaps import FrequencyGaps
from freebeam_derive.certify.load_size import _together, _values
from freebeam_derive.certify.local_series import _orders, _shifts
from freebeam_derive.certify.parameter_series import _Linear
from freebeam_derive.certify.same_motions import _in_other_coordinates
from freebeam_derive.certify.stepped_section import SteppedSection
from freebeam_derive.certify.strips import Form, NoStrips
from freebeam_derive.certify.structure import of_balls, structure
from tests.certify.test_beam import column
from tests.certify.test_column_forms import HALF, ONE, F, along, at, kernel, read

# --- roots of the kernel's characteristic function -----------------------------------------------------------


def test_a_root_is_in_the_image_of_newton_and_no_wider_than_the_slope_says(monkeypatch: pytest.MonkeyPatch) -> None:
    """16 (δ − 1/3) known up to 2^−100: 2^−104 about 1/3; of which a value wider than the balls tried tells nothing."""
    monkeypatch.setattr(balls, "_slope", lambda kernel, delta, quarter, sigma: arb(16))
    with precision(128):
        for rest, found in ((-100, True), (-40, False)):
            blur = arb(0, float(2.0**rest))
            monkeypatch.setattr(balls, "_value", lambda k, delta, q, s, b=blur: 16 * (delta - arb(1) / 3) + b)
            if found:
                root = balls._root(None, 1, 1, 0.3)  # type: ignore[arg-type]
                assert root.contains(arb(1) / 3) and 2.0**-104 <= float(root.rad()) < 2.0**-103
            else:
                with pytest.raises(Unproven, match="could not be enclosed"):
                    balls._root(None, 1, 1, 0.3)  # type: ignore[arg-type]


def test_the_image_of_newton_is_on_the_side_of_the_root(monkeypatch: pytest.MonkeyPatch) -> None:
    """A root that lies a little beside where Newton's steps end: at 1/3 + 2^−110."""
    monkeypatch.setattr(balls, "_slope", lambda kernel, delta, quarter, sigma: arb(16))
    with precision(128):
        beside = arb(2) ** -110
        monkeypatch.setattr(
            balls,
            "_value",
            lambda k, delta, q, s: 16 * (delta - arb(1) / 3 - (beside if flint.ctx.prec == 128 else 0)),
        )
        root = balls._root(None, 1, 1, 0.3)  # type: ignore[arg-type]
        assert root.overlaps(arb(1) / 3 + beside) and not root.overlaps(arb(1) / 3) and root.rad() < 2.0**-120


@pytest.mark.parametrize(("sign", "fine"), [(1.0, True), (-1.0, True), (0.5, True), (-0.5, True), (None, False)])
def test_there_is_no_root_before_the_first_where_one_coefficient_keeps_its_sign(
    monkeypatch: pytest.MonkeyPatch, sign: float | None, fine: bool
) -> None:
    """Of all derivatives at γ = 0 the first that is not nothing, on all of the way to γ = 1, of any size."""
    asked: list[tuple[float, float]] = []

    def series(kernel: Any, delta: arb, quarter: int, sigma: int, order: int) -> list[arb]:
        if order == 5:
            return [arb(0), arb(0), arb(1), arb(0), arb(0), arb(0)]
        assert order == 2
        asked.append((float(delta.lower()), float(delta.upper())))
        middle = float(delta.mid()) + 3 * math.pi / 4
        return [arb(0), arb(0), arb(sign) if sign is not None else arb(1 if middle < 0.99 else -1)]

    monkeypatch.setattr(balls, "_series", series)
    monkeypatch.setattr(balls, "_no_zero", lambda kernel, low, high, *of: asked.append((float(low), float(high))))
    with precision(64):
        if fine:
            balls._none_before(None, 3, 1)  # type: ignore[arg-type]
        else:
            with pytest.raises(Unproven, match="neighbourhood of γ = 0"):
                balls._none_before(None, 3, 1)  # type: ignore[arg-type]
    ends = sorted(asked)
    assert ends[0][0] <= -3 * math.pi / 4 and ends[-1][1] >= -math.pi / 4 - 1e-12
    assert all(a[1] >= b[0] for a, b in pairwise(ends))


# --- crossings in their order -------------------------------------------------------------------------------


def passing(low: float, high: float, change: int, flutter: bool = True, square: float = 4.0) -> _Passing:
    return _Passing([arb(low).union(arb(high)), arb(square)], change, flutter, 64)


def counted(found: list[_Passing], damped: bool = False) -> list[tuple[Any, ...]]:
    them: Any = object.__new__(Survey)
    them.found, them.load_max = found, F(10)
    return [(c.kind, float(c.load[0]), c.square and float(c.square[0]), c.change, c.unstable)
            for c in Survey._counted(them, damped)]  # fmt: skip


def test_crossings_of_a_beam_are_told_in_their_order_with_what_is_unstable_below_each() -> None:
    found = [passing(5, 5, -2), passing(1, 1, 1, False), passing(2, 2, 2, square=9), passing(11, 12, 2),
             passing(3, 3, 0, False), passing(7, 7, -1, False)]  # fmt: skip
    wanted = [("divergence", 1, None, 1, 0), ("flutter", 2, 9, 2, 1), ("touch", 3, None, 0, 3),
              ("flutter", 5, 4, -2, 3), ("divergence", 7, None, -1, 1)]  # fmt: skip
    assert counted(found) == wanted
    assert counted([passing(2, 2, 2, square=3)], damped=True) == [("flutter", 2, 9, 2, 0)]
    assert counted([passing(1, 2, 2), passing(2.5, 3, 2)])  # one after the other
    for other in (passing(1.5, 2.5, 2), passing(1.5, 1.7, 2), passing(0.5, 1.5, 2), passing(2, 3, 2)):
        with pytest.raises(OpenStep, match="which of two crossings"):
            counted([passing(1, 2, 2), other])
    with pytest.raises(OpenStep, match="fewer than no eigenvalue"):
        counted([passing(1, 1, -1, False)])
    for low, high in ((9, 10), (10, 10), (9, 11), (10, 11)):
        with pytest.raises(beam_crossings.AtTheEnd, match="whether the crossing"):
            counted([passing(low, high, 2)])


def test_the_scale_of_two_parts_is_asked_of_both() -> None:
    part: Any = SimpleNamespace(scale=lambda other: (part, other))
    assert _scale(part, 7) == (part, 7) and _scale(None, part) is None and _scale(part, None) is None  # type: ignore[arg-type,comparison-overlap]


@pytest.mark.parametrize("whirls", [False, True])
def test_frequencies_of_a_crossing_are_those_of_all_parts_that_are_alike(whirls: bool) -> None:
    scales = [fmpq(1), fmpq(3), fmpq(1)]
    still: Any = SimpleNamespace(turn=Fraction(0), whirls=whirls)
    turns: Any = SimpleNamespace(turn=Fraction(2), whirls=whirls)

    def told(part: Any, places: list[arb]) -> list[tuple[float | None, int]]:
        return [(None if square is None else float(square), times) for square, times in _told(part, places, scales)]

    assert told(None, []) == told(still, []) == [(None, 3)] and told(turns, []) == [(4, 6)]
    assert told(still, [arb(0)]) == [(0, 3)] and told(still, [arb(5)]) == [(5, 2), (15, 1)]
    if whirls:  # x = ω + turn
        assert told(turns, [arb(9)]) == [(49, 3)] and told(turns, [arb(0)]) == [(4, 3)]
    else:
        assert told(turns, [arb(9)]) == [(1, 3), (25, 3)] and told(turns, [arb(0)]) == [(4, 3), (4, 3)]


def test_an_interval_of_so_many_digits_is_about_the_ball() -> None:
    assert _interval(arb(0), 9) == (0, 0)
    with precision(300):
        for digits in (2, 20):
            low, high = _interval(arb(2).sqrt(), digits)
            assert exact(low) < arb(2).sqrt() < exact(high)
            assert float((high - low) * 10**digits / low) == pytest.approx(0.02, rel=1e-3)
            with pytest.raises(Unproven, match=f"to {digits} digits"):
                _interval(arb(3, 10.0 ** -(digits + 1)), digits)


# --- the direction of a crossing ----------------------------------------------------------------------------


def test_directions_of_crossings_are_derivatives_of_their_branches(monkeypatch: pytest.MonkeyPatch) -> None:
    """What the sign is asked of, from F's Taylor coefficients in u = P − P* and v = s − s*: of any factor of F."""
    asked: list[Any] = []
    monkeypatch.setattr(beam_itself, "_sign", lambda value, refusal: asked.append(value))
    draw = np.random.default_rng(3)

    def found(kind: Any, t: dict[Any, float], **known: Any) -> float:
        them: Any = object.__new__(kind)
        for name, value in known.items():
            setattr(them, name, value)
        them.onset([arb(2), arb(3)], {key: arb(float(value)) for key, value in t.items()})
        return float(asked.pop())

    for _ in range(3):
        slope, half, g0, gP, gs = draw.uniform(0.5, 2, 5) * draw.choice([-1, 1], 5)
        # F = (v − slope u − half u²)(g0 + gP u + gs v): s'' = 2 half
        F = {(1, 0): -slope * g0, (0, 1): g0, (2, 0): -half * g0 - slope * gP, (1, 1): gP - slope * gs, (0, 2): gs}
        assert found(VanishingDamping, F) == pytest.approx(2 * half, rel=1e-12)
        # F = g0 (v − slope u) + w (gP u + gs v): F_w / F_s along the branch grows by (gP + gs slope)/g0
        F = {(1, 0, 0): -slope * g0, (0, 1, 0): g0, (1, 0, 1): gP, (0, 1, 1): gs}
        assert found(VanishingRates, F) == pytest.approx((gP + gs * slope) / g0, rel=1e-12)
        # s parts into a pair where F_ss F_p > 0
        assert found(Coalescence, {(0, 2): g0, (1, 0): gP}) == pytest.approx(g0 * gP, rel=1e-12)
        for R in (0, 2):  # s falls through zero by −F_p/F_s, or s² by 2 F_p/F_ss
            F = {(1, R): gP, (0, R + 1): g0, (0, R + 2): gs}
            assert found(Static, F, order=R, next=R + 1) == pytest.approx(gP * g0, rel=1e-12)
            assert found(Static, F, order=R, next=R + 2) == pytest.approx(-gP * gs, rel=1e-12)
        # dλ/dP = −i G_P/G_ω
        of: Any = object.__new__(Damped)
        by_load, by_frequency = complex(slope, half), complex(g0, gP)
        of._chain = lambda x, t, c=(by_load, by_frequency): tuple(map(acb, c))
        of.onset([], {})
        assert float(asked.pop()) == pytest.approx((-1j * by_load / by_frequency).real * abs(by_frequency) ** 2)
    simple = {(1, 0): 1.0, (0, 1): 1.0, (2, 0): 1.0, (1, 1): 1.0, (0, 2): 1.0}
    double: Any = {key: arb(value) for key, value in simple.items()} | {(0, 1): arb(0.5, 1)}
    with pytest.raises(Unproven, match="not known to be simple"):
        object.__new__(VanishingDamping).onset([arb(1), arb(1)], double)
    with pytest.raises(Unproven, match="not known to be simple"):
        object.__new__(VanishingRates).onset([], {(1, 0, 0): arb(1), (0, 1, 0): arb(0.5, 1)})
    still: Any = object.__new__(Static)
    still.order, still.next = 0, 1
    with pytest.raises(Unproven, match="direction of the crossing"):
        still.onset([], {(1, 0): arb(1), (0, 1): arb(0.5, 1)})


def test_an_onset_is_asked_of_the_box_and_else_of_the_crossing(monkeypatch: pytest.MonkeyPatch) -> None:
    box, crossing = [arb(2, 0.5), arb(9, 1)], [arb(2), arb(9)]
    asked: list[Any] = []

    def problem(outcomes: list[Any]) -> Any:
        def onset(x: Any, t: Any) -> None:
            asked.append((x, t))
            if (outcome := outcomes.pop(0)) is not None:
                raise outcome

        return SimpleNamespace(
            sought="flutter at", kind="flutter", onset=onset, frequency=lambda x: x[1].sqrt(),
            slopes=lambda x: (None, None, "of the crossing"),
        )  # fmt: skip

    monkeypatch.setattr(beam_itself, "enclose", lambda p, near, digits: (crossing, (box, "of the box"), 70))
    for outcomes, wide in (([None], True), ([Unproven("wide"), None], False)):
        asked.clear()
        told = beam_itself.onset(problem(outcomes), (2.0, 9.0), 12)
        assert asked[-1] == ((box, "of the box") if wide else (crossing, "of the crossing"))
        assert (told.load, told.frequency, told.kind, told.digits, told.bits) == (2, 3, "flutter", 12, 70)
    with pytest.raises(NoOnset, match=r"flutter at 2 is a crossing, but it falls"):
        beam_itself.onset(problem([NoOnset("it falls")]), (2.0, 9.0), 12)
    for low in ([arb(0), arb(9)], [arb(2), arb(0, 1)], [arb(2), arb(-9)], [arb("0.5", 0.6), arb(9)]):
        monkeypatch.setattr(beam_itself, "enclose", lambda p, near, digits, low=low: (low, (box, ""), 70))
        with pytest.raises(Unproven, match="not known to be positive"):
            beam_itself.onset(problem([None]), (2.0, 9.0), 12)
    monkeypatch.setattr(beam_itself, "enclose", lambda p, near, digits: ([arb("0.5"), arb("0.25")], (box, ""), 70))
    assert beam_itself.onset(problem([None]), (2.0, 9.0), 12).load == arb("0.5")


def test_two_eigenvalues_at_zero_leave_as_a_pair_where_their_form_is_definite() -> None:
    """h_PP/2 + g_P μ − h_x μ²: no real μ where g_P² + 2 h_x h_PP < 0."""
    for g_P, h_x, h_PP in ((1, 1, -1), (2, 1, -1), (1, -1, -1), (1, -0.25, 2), (1, -0.25, 1), (1.5, 1, -1),
                           (-1.5, 1, -1), (-1, 1, -0.25), (0.5, 0.5, -0.5), (0.5, 0.5, -0.125)):  # fmt: skip
        h: Any = SimpleNamespace(
            by_x=lambda P, x, v=h_x: arb(v), by_P=SimpleNamespace(by_P=lambda P, x, v=h_PP: arb(v))
        )
        them: Any = object.__new__(Boundary)
        object.__setattr__(them, "h", h)
        object.__setattr__(them, "g", SimpleNamespace(by_P=lambda P, x, v=g_P: arb(v)))
        assert Boundary.leaves_as_pair(them, arb(1), arb(0)) == (g_P**2 + 2 * h_x * h_PP < 0)


# --- gaps ---------------------------------------------------------------------------------------------------


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


# --- motions that are the same, and loads that are one ------------------------------------------------------


def square(values: Any) -> Any:
    return np.array([[fmpq(v) for v in row] for row in values], dtype=object)


def test_stiffness_times_a_number_in_other_coordinates_is_told() -> None:
    """K by powers of the load, turned by T and times 3; without C alone, and of a number above zero."""
    T = square([[1, 2], [0, 1]])
    M, K, B = square([[2, 1], [1, 3]]), square([[5, 1], [1, 4]]), square([[1, 2], [0, 1]])
    none = square([[0, 0], [0, 0]])

    def turned(X: Any, times: int = 1) -> Any:
        return T.T.dot(X).dot(T) * fmpq(times)

    one = [M], [none], [K, B]
    for scale in (3, 1, -2):
        other = [turned(M)], [none], [turned(K, scale), turned(B, scale)]
        wanted = None if scale < 0 else scale
        assert _in_other_coordinates(one, other, True) == wanted
        assert _in_other_coordinates(one, other, False) == (1 if scale == 1 else None)
    assert _in_other_coordinates(one, ([turned(M)], [none], [turned(K, 3), turned(B, 2)]), True) is None
    assert _in_other_coordinates(one, ([turned(M)], [turned(M)], [turned(K, 3), turned(B, 3)]), True) is None
    # mirrored, and matrices that are no mirror of each other
    other = [turned(M)], [none], [turned(K, 3).T, turned(B, 3).T]
    assert _in_other_coordinates(one, other, True) == 3
    assert _in_other_coordinates(one, ([turned(M)], [none], [turned(K).T, turned(B).T]), True) == 1
    assert _in_other_coordinates(one, ([turned(M)], [none], [turned(K, 3)]), True) is None
    assert (
        _in_other_coordinates(([M], [none], [K, B, K]), ([turned(M)], [none], [turned(X, 5) for X in (K, B, K)]), True)
        == 5
    )
    assert _in_other_coordinates(([M, B], [none], [K]), ([turned(M), turned(B)], [none], [turned(K, 5)]), True) == 5
    unit = square([[1, 0], [0, 1]])  # of determinant one
    assert _in_other_coordinates(
        ([unit], [none], [K, B]), ([unit], [none], [K * fmpq(1, 3), B * fmpq(1, 3)]), True
    ) == fmpq(1, 3)
    wide = square([[1, 0, 0], [0, 1, 0], [0, 0, 1]])
    assert _in_other_coordinates(one, ([wide], [wide * 0], [wide, wide]), True) is None
    zero = square([[0, 1], [1, 0]])  # of no trace
    assert _in_other_coordinates(([square([[1, 0], [0, 1]])], [none], [zero]), ([M], [none], [K]), True) is None


def test_two_roots_a_hair_apart_are_told_by_more_bits() -> None:
    """P − 1 and P − 1 − 2^−900 on an interval that holds both: two loads; one of them alone and itself: one."""
    gap = F(1, 2**900)

    def part(root: Fraction) -> Any:
        K = [np.array([[fmpq(root.numerator, root.denominator)]], dtype=object), np.array([[fmpq(-1)]], dtype=object)]
        unit = [np.array([[fmpq(1)]], dtype=object)]
        return SimpleNamespace(together=None, M=unit, C=[], K=K, names=("y",))

    one, other = part(F(1)), part(1 + gap)
    wide = F(1) - 4 * gap, F(1) + 4 * gap
    assert not one_load.equal([(one, False), (other, False)], False, *wide)
    assert one_load.equal([(one, False), (one, False)], False, *wide)
    # far narrower than 500 bits tell from the root's rounding
    assert one_load.equal([(one, False), (one, False), (part(F(3)), False)], False, 1 - F(1, 2**700), 1 + F(1, 2**700))


def test_a_range_is_cut_where_it_is_not_shown_and_no_more(monkeypatch: pytest.MonkeyPatch) -> None:
    them: Any = object.__new__(ranges.Line)
    monkeypatch.setattr(ranges, "_Family", lambda line, a, b: (a, b))
    shown = []

    def show(family: Any) -> None:
        a, b = family
        if b - a > F(1, 4):
            raise Unproven("wide")
        shown.append(family)

    assert ranges.Line._throughout(them, F(0), F(1), show) == 4 == len(shown)
    assert sorted(shown) == [(F(k, 4), F(k + 1, 4)) for k in range(4)]
    assert ranges.Line._throughout(them, F(0), F(1, 5), show) == 1

    def never(family: Any) -> None:
        raise Unproven("never")

    with pytest.raises(Unproven, match="never"):
        ranges.Line._throughout(them, F(0), F(1), never)


# --- the power series ---------------------------------------------------------------------------------------


def test_conditions_at_the_left_end_may_be_combined_and_scaled() -> None:
    """y''' + 2 y − P y' = 0 and y'' − 3 y' + y = 0 there, or these in other combinations: F is the same."""

    def kernel(mixed: Any) -> Any:
        def ends(P: Any, a: Any, b: Any) -> Any:
            rows: Any = {(3, 0): 1, (0, 0): 2, (1, 0): -P}, {(2, 0): 1, (1, 0): -3, (0, 0): 1}
            left = tuple(
                {
                    key: sum(f * row.get(key, 0) for f, row in zip(of, rows, strict=True))
                    for key in {**rows[0], **rows[1]}
                }
                for of in mixed
            )
            return left, ({(3, 0): -1}, {(2, 0): 1})

        return column(lambda P, a, b: {(0, 2): (1,), (2, 0): (P,), (4, 0): (1,)}, ends)

    with precision(128):
        plain, *others = (Beam(kernel(mixed)) for mixed in (((1, 0), (0, 1)), ((2, 1), (1, -1)), ((0, 3), (5, 7))))
        orders = ((0, 0), (1, 0), (0, 1))
        for p, s in ((arb(3), arb(5)), (arb(-2), arb(70))):
            wanted = plain.taylor(p, s, orders)
            for other in others:
                found = other.taylor(p, s, orders)
                assert all(abs(found[order] - wanted[order]) < 1e-20 * (1 + abs(wanted[order])) for order in orders)


def test_coefficients_between_those_of_two_beams_are_linear_and_nothing_where_one_has_none() -> None:
    two: Any = object.__new__(_Linear)
    low, high = (Coefficient(*map(arb, v)) for v in ((2, 3, 7), (4, 9, 7)))
    nothing = Coefficient(arb(0), arb(0), arb(7))
    for whole in (False, True):
        two._whole = whole
        both, without, only = (
            two._between(*pair)["k"]
            for pair in (({"k": low}, {"k": high}), ({"k": low}, {}), ({}, {"k": high}))
        )  # fmt: skip
        for found, (a, b) in ((both, (low, high)), (without, (low, nothing)), (only, (nothing, high))):
            for value, slope, one, other in zip(found[:2], found[3:5], a[:2], b[:2], strict=True):
                assert float(slope) == (float(other) - float(one)) / 2
                if whole:
                    assert value.contains(one) and value.contains(other)
                else:
                    assert float(value) == (float(one) + float(other)) / 2 and value.is_exact()


@pytest.mark.parametrize("whirls", [True, False])
def test_planes_turn_fast_where_signs_alternate_at_all_loads(whirls: bool) -> None:
    """(−1)^k times the factor of x^k is of one sign for all k up to N, and for all loads."""
    for rows, fast in (
        ([[1, -2, 3]], True), ([[-1, 2, -3]], True), ([[1, -2, -3]], False), ([[1, 2, 3]], False),
        ([[-1, -2, 3]], False), ([[1, -2, 3], [0, 0, "-0.5"]], False), ([[1, -2, 3], [0, 0, "-0.25"]], True),
        ([[1, -2, 3], ["0.5", "-0.5", "0.5"]], True),
    ):  # fmt: skip
        of: Any = SimpleNamespace(
            part=SimpleNamespace(whirls=whirls),
            N=2,
            h=SimpleNamespace(rows=[arb_poly([arb(v) for v in row]) for row in rows]),
        )
        with precision(64):
            assert turns_fast(of, F(10)) == (fast or not whirls)
    assert turns_fast(SimpleNamespace(part=None), F(10))  # type: ignore[arg-type]


@pytest.mark.parametrize("part", ["h", "m"])
def test_a_stiffness_that_the_load_or_the_acceleration_changes_is_refused(part: str) -> None:
    changed = {"h": {(4, 0): lambda P: 1 + P}, "m": {(4, 0): lambda P: 1, (4, 2): lambda P: 1}}[part]
    equation = lambda P, a, b: {(0, 2): (1,), (2, 0): (P,)} | {key: (f(P),) for key, f in changed.items()}  # noqa: E731
    with precision(64), pytest.raises(NoSeries, match="bending stiffness must be constant"):
        Beam(column(equation, lambda P, a, b: (({(0, 0): 1}, {(1, 0): 1}), ({(3, 0): -1}, {(2, 0): 1}))))


def test_products_by_a_variable_are_gathered_from_the_power_below() -> None:
    for degree in (1, 3):
        orders = _orders(degree)
        assert sorted(orders) == [(i, j) for i in range(degree + 1) for j in range(degree + 1) if i + j <= degree]
        for n, shifts in enumerate(_shifts(degree)):
            for (i, j), source in zip(orders, shifts, strict=True):
                below = (i - 1, j) if n == 0 else (i, j - 1)
                assert source == (orders.index(below) if min(below) >= 0 else -1)


@pytest.mark.parametrize("bits", [30, 200])
def test_entries_in_balls_are_written_to_their_bits_and_hold_them(bits: int) -> None:
    with precision(bits + 60):
        values = [arb(1) / 3, -arb(2).sqrt() * 100, arb(3, 0.25), arb(0), fmpq(2, 7)]
        middle = certificate._entries(np.array([values], dtype=object), bits)[0]
        assert middle[3:] == ["0", "2/7"]
        for value, entry in zip(values[:3], middle, strict=False):
            m, r = map(Fraction, entry)
            low, high = balls.ends(value)
            assert m - r <= low and high <= m + r
            assert 0 < r <= (high - low) / 2 + Fraction(2, 10 ** (0.302 * bits).__ceil__())
            assert (m * 10 ** (math.floor(0.302 * bits) + 1)).denominator == 1


def test_a_line_that_moves_stays_between_its_neighbours() -> None:
    """From its start to the crossing, at both ends, between 2 and 9; F falls along it where it was positive."""
    asked: list[Any] = []

    def falls(low: arb, high: arb, point: arb, slope: arb) -> int:
        asked.append((float(low), float(high), float(point), float(slope)))
        return -1

    for slope, inside in ((1, True), (3, True), (4.5, False), (-1, True), (-3, False)):
        asked.clear()
        them: Any = object.__new__(beam_stability.Below)
        them.m, them.load = 2, arb(5)
        them._separators = lambda *of: ["any"]
        them._estimates = lambda load, v=slope: np.array([6 - v - 6, 6 - v + 6])  # on both sides of 6, their mean 6 − v
        them._fixed = lambda *of: [F(2), F(6), F(9)]
        them._alternate = lambda *of: {1: 1}
        them._rising = falls
        assert (beam_stability.Below._towards(them, F(4), F(5), arb(6)) is not None) == inside
        assert asked == ([(4, 5, 6, slope)] if inside else [])


def test_what_entries_tell_of_a_determinant_is_what_fractions_do() -> None:
    """Of diagonal matrices, whose degree, motions at rest and damping of these are read off: both ways alike."""
    for mass, damping, stiffness, wanted in (
        ((1, 1), (0, 0), (1, 1), (4, True, 0, True)), ((1, 0), (0, 0), (1, 1), (2, True, 0, True)),
        ((1, 1), (2, 0), (1, 0), (4, False, 1, True)), ((1, 1), (2, 3), (1, 0), (4, False, 1, False)),
        ((1, 0), (0, 3), (1, 1), (3, False, 0, True)), ((0, 0), (2, 3), (0, 1), (2, False, 1, False)),
        ((1, 1), (0, 0), (0, 0), (4, True, 2, True)),
    ):  # fmt: skip
        M, C, K = ([square(np.diag(v).tolist())] for v in (mass, damping, stiffness))
        for found in (structure(M, C, K), of_balls(M, C, K)):
            assert (found.degree, found.even, found.rests, found.left_alone) == wanted
        assert of_balls(M, [], K).left_alone and structure(M, [], K).left_alone
    assert not of_balls(*([square(np.diag(v).tolist())] for v in ((1, 1), (2, 3), (1, 1)))).even
    assert of_balls(*([square(np.diag(v).tolist())] for v in ((1, 0), (2, 3), (1, 1))), True).degree == 2


def test_of_an_elastic_energy_what_is_not_known_to_be_positive_softens(monkeypatch: pytest.MonkeyPatch) -> None:
    """All terms but squares of one displacement or slope with a factor that is not negative."""
    monkeypatch.setattr(strips, "Form", lambda modes, along, points: (along, points))
    them: Any = object.__new__(strips.Strips)
    them.modes = None
    kept = (
        {(0, 0, 0): F(-1), (1, 0, 1): F(2), (0, 1, 0): F(3)},
        {(0, 0, 1, 0): F(2), (1, 0, 1, 1): F(1), (1, 1, 1, 1): F(-4)},
    )
    them._elastic = [{**kept[0], (2, 0, 0): F(5), (0, 1, 1): F(1)}, {**kept[1], (0, 0, 0, 0): F(7), (1, 0, 1, 0): F(1)}]
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


def test_a_load_is_unstable_where_g_turns_before_h(monkeypatch: pytest.MonkeyPatch) -> None:
    """h = x − a with a minus, g = b − x: between b and the next of a, 2 b and g's second root, and nowhere else."""
    asked: list[float] = []

    def positive(which: Any, P: arb, start: Fraction, end: Fraction, depth: int) -> bool:
        asked.append(float(end))
        return True

    monkeypatch.setattr(ranges, "_positive", positive)

    def of(roots: list[float], sign: int) -> Any:
        p = arb_poly([sign])
        for root in roots:
            p = p * arb_poly([root, -1])

        class Both:
            def at(self, P: arb) -> arb_poly:
                return p

            def __call__(self, P: arb, x: arb) -> arb:
                return p(x)

        return Both()

    for h, g, between in (
        ([5.0], [2.0], 3.0), ([3.0], [2.0], 2.5), ([], [2.0], 3.0), ([9.0], [2.0, 3.0], 2.5), ([2.0], [3.0], None),
        ([2.0], [], None), ([], [], None),
    ):  # fmt: skip
        asked.clear()
        them: Any = object.__new__(ranges._Family)
        them.centre = them.over = SimpleNamespace(h=of(h, 1), g=of(g, 1))
        with precision(64):
            if between is None:
                with pytest.raises(Unproven, match="not known to be unstable"):
                    ranges._Family.unstable(them, F(1))
            else:
                ranges._Family.unstable(them, F(1))
        assert asked == ([] if between is None else [pytest.approx(between, rel=1e-6)])
