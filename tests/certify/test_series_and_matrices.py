"""Roots, power series, matrices of motions and ranges of a damping: what is said of them, on data that are known."""

from __future__ import annotations

import math
from fractions import Fraction
from itertools import pairwise
from types import SimpleNamespace
from typing import Any

import flint
import numpy as np
import pytest
from flint import arb, arb_poly, fmpq

from freebeam_derive.certify import (
    balls,
    certificate,
    one_load,
    ranges,
)
from freebeam_derive.certify.balls import Unproven, precision
from freebeam_derive.certify.beam import Beam, Coefficient, NoSeries
from freebeam_derive.certify.local_series import _orders, _shifts
from freebeam_derive.certify.parameter_series import _Linear
from freebeam_derive.certify.same_motions import _in_other_coordinates
from freebeam_derive.certify.structure import of_balls, structure
from tests.certify.test_beam import column
from tests.certify.test_column_forms import F


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


def square(values: Any) -> Any:
    return np.array([[fmpq(v) for v in row] for row in values], dtype=object)


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
