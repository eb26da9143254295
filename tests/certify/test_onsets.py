"""Which way crossings go, in which order they are told, and with which frequencies: on data that are known, on both
sides of each condition."""

from __future__ import annotations

from fractions import Fraction
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from flint import acb, arb, arb_poly, fmpq

from freebeam_derive.certify import (
    beam_crossings,
    beam_itself,
    beam_stability,
)
from freebeam_derive.certify.all_crossings import _interval, _scale, _told, turns_fast
from freebeam_derive.certify.balls import Unproven, exact, precision
from freebeam_derive.certify.beam_cells import OpenStep
from freebeam_derive.certify.beam_crossings import Survey, _Passing
from freebeam_derive.certify.beam_itself import Coalescence, Damped, NoOnset, Static, VanishingDamping, VanishingRates
from freebeam_derive.certify.boundary_polynomials import Boundary
from freebeam_derive.certify.exact_system import ExactSystem
from tests.certify.test_column_forms import F


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


class Rated(ExactSystem):
    """A column whose rates may let λ and −λ leave zero together, of which F at λ = 1 is known."""

    rated = True  # type: ignore[assignment]
    beyond = 0.0

    def taylor(self, P: Any, s: Any, orders: Any) -> Any:
        assert (P, s, orders) == (2, -1, ((0, 0),))
        return {(0, 0): arb(self.beyond)}


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
        # s falls through zero by −F_p/F_s; where F_s may be zero F has other signs at λ = 0 and at λ = 1 just above
        for R in (0, 1, 2):
            F = {(1, R): gP, (0, R + 1): g0}
            assert found(Static, F, order=R, beam=None) == pytest.approx(gP * g0, rel=1e-12)
            rates: Any = object.__new__(Rated)
            rates.beyond = gs
            assert found(Static, F, order=R, beam=rates) == pytest.approx(gP * g0, rel=1e-12)
            F[0, R + 1] = 0.0
            assert found(Static, F, order=R, beam=rates) == pytest.approx(-gP * gs * (-1) ** R, rel=1e-12)
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


@pytest.mark.parametrize("damping", [None, (2.0, 3.0)])
def test_an_eigenvalue_passes_zero_by_the_slopes_of_its_function(
    damping: tuple[float, float] | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    """F_λ at λ = 0 is −(c_E P F_P + c_M F_s) with damping, −F_s without: an eigenvalue comes in or leaves by its sign
    beside that of F_P."""
    monkeypatch.setattr(beam_crossings, "enclose", lambda problem, near, digits: ([arb(7)], None, 64))
    for R, by_load, by_s in (
        (0, 2.0, 5.0),
        (0, -2.0, 5.0),
        (1, 0.125, -5.0),
        (1, -0.5, 2.0),
        (0, 0.5, -4.0),
        (0, 2.0, -9.5),
    ):
        t = {(1, R): arb(by_load), (0, R + 1): arb(by_s)}
        monkeypatch.setattr(
            beam_crossings,
            "Static",
            lambda beam, t=t, R=R: SimpleNamespace(order=R, slopes=lambda box: (None, None, t)),
        )
        them: Any = object.__new__(Survey)
        them.found, them.load_max, them.digits, them.beam = [], F(10), 20, None
        low: Any = SimpleNamespace(sign=lambda a, b, s: 1 if float(a) > 7 else -1)
        given = damping and (arb(damping[0]), arb(damping[1]))
        Survey._divergence(them, low, F(6), F(8), 1, given)
        rate = by_s if damping is None else damping[0] * 7 * by_load + damping[1] * by_s
        ((box, change, flutter, bits),) = [(c.box, c.change, c.flutter, c.bits) for c in them.found]
        assert (change, flutter, bits) == (1 if by_load * rate > 0 else -1, False, 64) and box == [arb(7)]
        for a, b, error in ((F(7), F(8), OpenStep), (F(6), F(7), OpenStep), (F(7), F(10), beam_crossings.AtTheEnd)):
            with pytest.raises(error, match="not known to be below"):
                Survey._divergence(them, low, a, b, 1, given)
        t[1, R] = arb(0, 1)
        with pytest.raises(OpenStep, match="how the eigenvalue zero moves"):
            Survey._divergence(them, low, F(6), F(8), 1, given)
