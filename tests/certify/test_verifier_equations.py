"""The verifier's equations, of functions F that are polynomials: their values, their slopes, and the tests on boxes."""

from __future__ import annotations

from fractions import Fraction
from itertools import product
from math import comb
from types import SimpleNamespace
from typing import Any

import flint
import numpy as np
import pytest
from flint import acb, arb, fmpq_poly

from freebeam_derive.certify import verifier_equations, verifier_rates
from freebeam_derive.certify.verifier_boxes import Box, power
from freebeam_derive.certify.verifier_claims import Refused
from freebeam_derive.certify.verifier_damping import Damped
from freebeam_derive.certify.verifier_equations import Equations, _within, krawczyk, one_to_one
from freebeam_derive.certify.verifier_rates import Powers, Rates, RatesOver, RatesOverDamping
from freebeam_derive.certify.verifier_shooting import majorants

BITS = 256
STEP = arb(2) ** -60
"""Of central differences: what they leave out is of the size of its square."""


def polynomial(seed: int) -> Any:
    """∂^{i+j+k} F / ∂p^i ∂s^j ∂q^k / (i! j! k!) of a polynomial F in p, s and q."""
    c = np.random.default_rng(seed).integers(-4, 5, (4, 4, 3))

    def f(p: Any, s: Any, i: int = 0, j: int = 0, q: Any = 0, k: int = 0) -> Any:
        total = 0 * p + 0 * s
        for (a, b, d), factor in np.ndenumerate(c):
            if a >= i and b >= j and d >= k:
                term = int(factor) * comb(a, i) * comb(b, j) * comb(d, k) * p ** (a - i) * s ** (b - j)
                total = total + (term if d == k else term * q ** (d - k))
        return total

    return f


def same(one: Any, other: Any, size: float = 1e-20) -> bool:
    return all(bool(abs(a - b) < size) for a, b in zip(one, other, strict=True))


def are_slopes(J: Any, values: Any, P: arb, x: arb) -> bool:
    """Whether rows of a matrix are the slopes of two values by P and x."""
    for k, (u, w) in enumerate(((STEP, 0), (0, STEP))):
        up, down = values(P + u, x + w), values(P - u, x - w)
        if not same([row[k] for row in J], [(a - b) / (2 * STEP) for a, b in zip(up, down, strict=True)]):
            return False
    return True


def equations(of_E: Any, of_M: Any, limit: bool) -> Equations:
    return Equations(SimpleNamespace(ranged=False), 0, of_E, of_M, limit)  # type: ignore[arg-type]


def point() -> tuple[arb, arb]:
    """P and x, at the precision in hand."""
    return arb("1.3"), arb("0.7")


def twice(value: str) -> tuple[Fraction, Fraction]:
    return Fraction(value), Fraction(value)


@pytest.mark.parametrize("which", ["undamped", "limit", "damped"])
def test_the_equations_are_those_of_a_double_root_a_rate_and_an_axis(which: str) -> None:
    f = polynomial(1)
    E, M = (twice("0"), twice("0")) if which == "undamped" else (twice("0.3"), twice("0.2"))
    it = equations(E, M, which == "limit")
    with flint.ctx.workprec(BITS):
        P, x = point()
        a, b = arb("0.3"), arb("0.2")
        if which == "undamped":
            assert same(it.place(P, x), (P, x))
            expected = [f(P, x), f(P, x, 0, 1)]
        elif which == "limit":
            assert same(it.place(P, x), (P, x))
            expected = [f(P, x), P * f(P, x, 1, 0) + (x + b / a) * f(P, x, 0, 1)]
        else:
            lam = acb(0, x)
            p, s = P / (1 + a * lam), -(lam**2 + b * lam) / (1 + a * lam)
            assert same(it.place(P, x), (p, s))
            expected = [f(p, s).real, f(p, s).imag]
        values, J = it.system(f, P, x)
        assert same(values, expected)
        assert are_slopes(J, lambda P, x: it.system(f, P, x)[0], P, x)


@pytest.mark.parametrize("limit", [False, True])
def test_the_equations_with_what_damping_leaves_are_those_of_a_rate_and_an_axis(limit: bool) -> None:
    f = polynomial(2)
    it: Any = object.__new__(Rates)
    Equations.__init__(it, SimpleNamespace(ranged=False), 0, twice("0.3"), twice("0.2"), limit)  # type: ignore[arg-type]
    with flint.ctx.workprec(BITS):
        P, x = point()
        a, b, it.scale = arb("0.3"), arb("0.2"), arb("1.7")
        if limit:
            q = arb(0)
            expected = [
                f(P, x, 0, 0, q),
                a * P * f(P, x, 1, 0, q) + (a * x + b) * f(P, x, 0, 1, q) - f(P, x, 0, 0, q, 1),
            ]
        else:
            lam = acb(0, x)
            p, s, q = P / (1 + a * lam), -(lam**2 + b * lam) / (1 + a * lam), it.scale * lam / (1 + a * lam)
            expected = [f(p, s, 0, 0, q).real, f(p, s, 0, 0, q).imag]
        values, J = it.system(f, P, x)
        assert same(values, expected)
        assert are_slopes(J, lambda P, x: it.system(f, P, x)[0], P, x)
        # in the limit the slope of the rate along F = 0, over F_s: that of the real part, but for a positive factor
        it.box = lambda p, s: SimpleNamespace(value=f)
        found = it._direction([P, x])
        if limit:
            (F_p, F_s), (of_p, of_s) = J
            assert bool(abs(found - (of_s * F_p / F_s - of_p) / F_s) < 1e-20)
        else:
            by_P, by_x = (acb(J[0][k], J[1][k]) for k in (0, 1))
            assert bool(abs(found + (by_x * by_P.conjugate()).imag) < 1e-20)


def test_over_a_range_of_damping_the_equations_grow_as_their_numbers_do() -> None:
    """From the middle to the high end: the slope by each of c_E, c_M and what R is multiplied by."""
    f = polynomial(3)
    with flint.ctx.workprec(BITS):
        P, x = point()

        def at(share: arb) -> Any:
            it: Any = object.__new__(Rates)
            Equations.__init__(it, SimpleNamespace(ranged=False), 0, twice("0"), twice("0.1"), False)  # type: ignore[arg-type]
            of: Any = SimpleNamespace(real=False, undamped=False, limit=False)
            of.alpha, of.beta, of.scale = (
                arb("0.3") + share * arb("0.1"),
                arb("0.2") - share * arb("0.05"),
                1 + share * arb("0.4"),
            )
            of.place = lambda P, x: Equations.place(of, P, x)
            return Rates.system(of, f, P, x)[0]

        it: Any = object.__new__(RatesOverDamping)
        Equations.__init__(it, SimpleNamespace(ranged=False), 0, twice("0.3"), twice("0.2"), False)  # type: ignore[arg-type]
        it.middle = SimpleNamespace(c_E=Fraction("0.3"), c_M=Fraction("0.2"))
        it.grown, it.scale = (Fraction("0.1"), Fraction("-0.05"), Fraction("0.4")), arb(1)
        (values, weight), (slope, unit) = it._from_middle(f, P, x)
        assert weight == 1 and unit.contains(1) and unit.contains(-1) and not unit.contains(1.01)
        assert same(values, at(arb(0)))
        assert same(slope, [(a - b) / (2 * STEP) for a, b in zip(at(STEP), at(-STEP), strict=True)])


@pytest.mark.parametrize("limit", [False, True])
def test_over_a_range_of_damping_of_one_form_the_equations_grow_as_its_numbers_do(limit: bool) -> None:
    f = polynomial(4)
    E, M = (Fraction("0.2"), Fraction("0.4")), (Fraction("0.5"), Fraction("0.1"))
    with flint.ctx.workprec(BITS):
        P, x = point()

        def at(share: Fraction) -> Any:
            one = equations(twice("0.3"), twice("0.3"), limit)
            one.of_E, one.of_M = (((of[0] + of[1]) / 2 + share * (of[1] - of[0]) / 2,) * 2 for of in (E, M))
            return one.system(f, P, x)[0]

        it, small = equations(E, M, limit), Fraction(1, 2**60)
        near: Any = SimpleNamespace(value=f)
        # on one value in the middle, where the range is that alone
        middle = equations(twice("0.3"), twice("0.3"), limit)
        middle.of_E, middle.of_M = (Fraction("0.3"),) * 2, (Fraction("0.3"),) * 2
        ((slope, weight),) = Equations._by_damping(_narrow(it, middle), near, P, x)
        by_share = [(a - b) / (2 * STEP) for a, b in zip(at(small), at(-small), strict=True)]
        if limit:  # F_s times what the ratio is more or less by than in the middle, on all of the range
            # b/a from 2.5 to 1/4, in the middle 1
            ends = float(weight.mid()) - float(weight.rad()), float(weight.mid()) + float(weight.rad())
            assert ends == pytest.approx((-0.75, 1.5), abs=1e-7)
            assert same(slope, [arb(0), f(P, x, 0, 1)])
        else:
            assert same(slope, by_share) and weight.contains(1) and weight.contains(-1)


def _narrow(it: Equations, middle: Equations) -> Any:
    """The equations of a range whose places are those of its middle."""
    return SimpleNamespace(
        place=middle.place,
        limit=it.limit,
        of_E=it.of_E,
        of_M=it.of_M,
        alpha=middle.alpha,
        ratio=it.ratio if it.limit else None,
    )


def test_how_fast_an_eigenvalue_leaves_zero_is_told_with_what_damping_leaves(monkeypatch: pytest.MonkeyPatch) -> None:
    """c_E P dF/dP + c_M F_s − F_q at P and s = q = 0, R as large as it is said to be; in the limit s = 0 is simple."""

    def value(p: Any, s: Any, i: int, j: int, q: Any, k: int) -> arb:
        assert (p, s, i, j, q, k) == (P, 0, 0, 0, 0, 1)
        return arb(11)

    P, whole = arb(5), object()
    monkeypatch.setattr(verifier_rates, "Powers", lambda F, p, s: SimpleNamespace(value=value) if F is whole else None)
    it: Any = object.__new__(Rates)
    for limit in (False, True):
        Equations.__init__(it, SimpleNamespace(ranged=False), 0, twice("0.5"), twice("0.25"), limit)  # type: ignore[arg-type]
        it.whole, it.scale = whole, arb(2)
        for by_s in (arb(3), arb(0, 1)):
            box: Any = SimpleNamespace(
                value=lambda p, s, i, j, by_s=by_s: by_s if (p, s, i, j) == (P, 0, 0, 1) else None
            )
            if limit and by_s.contains(0):
                with pytest.raises(Refused, match="simple"):
                    it.rate(box, P, arb(7))
            else:
                assert it.rate(box, P, arb(7)).overlaps(arb("0.5") * 5 * 7 + by_s / 4 - 22)
                assert float(it.rate(box, P, arb(7)).mid()) == pytest.approx(17.5 + float(by_s.mid()) / 4 - 22)


def test_between_two_columns_equations_are_over_both_of_their_dampings() -> None:
    of: Any = [
        SimpleNamespace(of_E=twice(a), of_M=twice(b), limit=True, rate=lambda *_, a=a: arb(a))
        for a, b in (("1", "4"), ("2", "3"))
    ]
    for both in (of, of[::-1]):
        it = RatesOver(SimpleNamespace(), *both)  # type: ignore[arg-type]
        assert (it.of_E, it.of_M, it.R, it.limit) == ((1, 2), (3, 4), 0, True)
        rate = it.rate(None, arb(1), arb(1))  # type: ignore[arg-type]
        assert (float(rate.mid()), float(rate.rad())) == pytest.approx((1.5, 0.5))


def test_a_range_of_damping_grows_from_its_middle() -> None:
    """R of the low end is 2/3 of that in the middle."""
    left = [[{0: fmpq_poly([c])}] for c in (2, 4)]
    low, high = (
        Damped(None, Fraction(E), Fraction(M), False, along, {(1, 0): Fraction(c)}, ([], {}))  # type: ignore[arg-type]
        for E, M, along, c in zip((1, 4), (7, 5), left, (6, 12), strict=True)
    )
    it: Any = object.__new__(RatesOverDamping)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(verifier_rates, "Pieces", lambda *_: None)
        RatesOverDamping.__init__(it, SimpleNamespace(column=None), low, high)  # type: ignore[arg-type]
    assert it.grown == (Fraction(3, 2), -1, Fraction(1, 3)) and (it.of_E, it.of_M) == ((1, 4), (5, 7))
    assert (it.middle.c_E, it.middle.c_M, it.middle.points) == (Fraction(5, 2), 6, {(1, 0): 9})
    assert (float(it.scale.mid()), float(it.scale.rad())) == pytest.approx((1, 1 / 3))


def test_motions_below_some_s_are_not_damped_where_external_damping_drives() -> None:
    """alpha s + beta > 0 from −beta/alpha on, at either end."""
    for E, M, expected in (
        (("1", "1"), ("-2", "-3"), 3), (("1", "2"), ("-3", "-2"), 3), (("1", "1"), ("1", "2"), 0),
        (("0", "1"), ("-1", "-1"), 0), (("1", "1"), ("-1/2", "1"), Fraction(1, 2)),
    ):  # fmt: skip
        it = equations(*(tuple(map(Fraction, of)) for of in (E, M)), False)
        assert it.undamped_to == expected


def test_krawczyks_image_is_that_of_its_formula() -> None:
    """m − Y f(m) + (1 − Y J)(X − m), Y the inverse of J at its middle; more values add with their balls."""
    with flint.ctx.workprec(BITS):
        X, middle = [arb(1, 0.25), arb(2, 0.5)], [arb(1), arb(2)]
        J = [[arb(3), arb(1)], [arb(-1), arb(2)]]
        at = [([arb(7), arb(14)], arb(1)), ([arb(7), arb(0)], power(1))]
        image = krawczyk(X, middle, at, J)
        assert image is not None  # Y = [[2, -1], [1, 3]] / 7; Y (7, 14) = (0, 7), Y (7, 0) = (2, 1)
        assert same([v.mid() for v in image], [1, 2 - 7]) and same([v.rad() for v in image], [2, 1], 1e-7)
        J[0][0] = arb(3, 0.5)  # 1 − Y J is [[±1/7, 0], [±1/14, 0]]
        image = krawczyk(X, middle, [([arb(0), arb(0)], arb(1))], J)
        assert image is not None and same([v.rad() for v in image], [0.25 / 7, 0.25 / 14], 1e-7)
        assert krawczyk(X, middle, at, [[arb(1), arb(2)], [arb(2), arb(4)]]) is None


@pytest.mark.parametrize(("a", "b", "c", "d", "right"), [
    (0.9, 0, 0, 0.9, True), (1.1, 0, 0, 0.1, False), (0.1, 0, 0, 1.1, False), (0.5, 0.49, 0.49, 0.5, True),
    (0.5, 0.51, 0.51, 0.5, False), (0.2, 0.7, 1.1, 0.02, True), (1.5, 0.1, 0.1, 1.5, False), (0, 3, 0.3, 0, True),
    (0, 3, 0.4, 0, False),
])  # fmt: skip
def test_two_points_have_no_equal_values_where_eigenvalues_are_below_one(
    a: float, b: float, c: float, d: float, right: bool
) -> None:
    """Of |1 − Y J|, entry by entry: here J is 1 and as much as these on either side."""
    largest = max(abs(np.linalg.eigvals([[a, b], [c, d]])))
    assert bool(largest < 1) is right
    with flint.ctx.workprec(BITS):
        assert one_to_one([[arb(1, a), arb(0, b)], [arb(0, c), arb(1, d)]]) is right


@pytest.mark.parametrize("which", ["undamped", "limit", "damped"])
def test_which_way_eigenvalues_go_is_told_by_slopes(which: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """F_p F_ss of two that meet; −2 p (F_pp + F_ps σ + F_ss σ²)/F_s, σ = ds/dp, in the limit; else Im F_P F_x*."""
    f = polynomial(5)
    monkeypatch.setattr(verifier_equations, "Box", lambda F, p, s: SimpleNamespace(value=f))
    E, M = (twice("0"), twice("0")) if which == "undamped" else (twice("0.3"), twice("0.2"))
    it = equations(E, M, which == "limit")
    with flint.ctx.workprec(BITS):
        P, x = point()
        found = it._direction([P, x])
        if which == "undamped":
            expected = f(P, x, 1, 0) * f(P, x, 0, 2)
        elif which == "limit":
            along = -f(P, x, 1, 0) / f(P, x, 0, 1)
            bend = f(P, x, 2, 0) + f(P, x, 1, 1) * along + f(P, x, 0, 2) * along**2
            expected = -2 * P * bend / f(P, x, 0, 1)
        else:
            ((a, b), (c, d)) = it.system(f, P, x)[1]
            expected = c * b - a * d
        assert same([found], [expected])


@pytest.mark.parametrize("R", [0, 1])
def test_a_divergence_is_a_zero_of_the_r_th_derivative_that_is_passed_at_a_speed(
    R: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """F(P, 0)/s^R = c (P − 3), and F_s: the sign is that of c F_s without damping, else of c (alpha P c + beta F_s)."""
    for slope, by_s, damped, at in (
        (2, 3, False, 3), (2, -3, False, 3), (2, 3, True, 3), (-2, 3, True, 3), (2, 3, False, 9), (0, 3, False, 3),
        (2, 0, False, 3), (2, 0, True, 3),
    ):  # fmt: skip
        asked: list[Any] = []

        class Straight:
            def __init__(self, F: Any, p: Any, s: Any, order: int) -> None:
                asked.append((s == 0, order))  # noqa: B023

            def value(
                self, p: Any, s: Any, i: int = 0, j: int = 0, slope: int = slope, by_s: int = by_s, at: int = at
            ) -> arb:
                known = {(0, R): slope * (p - at), (1, R): arb(slope, 0.1), (0, R + 1): arb(by_s, 0.1)}
                return arb(known[i, j])

        monkeypatch.setattr(verifier_equations, "Box", Straight)
        it = equations(*((twice("0.5"), twice("0.25")) if damped else (twice("0"), twice("0"))), False)
        it.R = R
        wrong = at == 9 or slope == 0 or (by_s == 0 and not damped)
        with flint.ctx.workprec(64):
            if wrong:
                with pytest.raises(Refused):
                    it.divergence((Fraction(2), Fraction(4)))
            else:
                found = it.divergence((Fraction(2), Fraction(4)))
                expected = slope * ((0.5 * 3 * slope + 0.25 * by_s) if damped else by_s)
                assert float(found.mid()) == pytest.approx(expected, abs=0.2)
        assert asked == [(True, R + 1)]


def test_equations_at_a_point_are_those_of_each_power_and_of_a_range_of_damping(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(verifier_equations, "Box", lambda F, p, s, of=None: SimpleNamespace(value=of))
    monkeypatch.setattr(Equations, "system", lambda self, value, P, x: ((self.of_E, self.of_M, value), None))
    monkeypatch.setattr(Equations, "_by_damping", lambda self, box, P, x: ["by damping", box.value])
    for ranged, E, M in (
        (False, (1, 1), (2, 2)), (False, (1, 1), (2, 4)), (False, (1, 5), (2, 2)), (True, (1, 1), (2, 2)),
        (True, (1, 5), (2, 4)),
    ):  # fmt: skip
        it = Equations(SimpleNamespace(ranged=ranged), 0, *(tuple(map(Fraction, of)) for of in (E, M)), False)  # type: ignore[arg-type]
        found: Any = it.at(arb(1), arb(1), (arb(1), arb(1)))
        middle = ((E[0] + E[1]) / 2,) * 2, ((M[0] + M[1]) / 2,) * 2
        count = 5 if ranged else 1
        assert [values for values, _ in found[:count]] == [(*middle, n) for n in range(count)]
        assert all(weight.rad() == power(n).rad() for n, (_, weight) in enumerate(found[:count]))
        assert found[count:] == (["by damping", None] if E[0] != E[1] or M[0] != M[1] else [])


def test_next_to_zero_f_without_its_rigid_zeros_is_on_all_of_the_way_there(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[Any] = []

    def box(F: Any, p: Any, s: Any) -> Any:
        asked.append(s)
        return SimpleNamespace(value=lambda p, s, i, j: (s, i, j))

    monkeypatch.setattr(verifier_equations, "Box", box)
    it = equations(twice("0"), twice("0"), False)
    it.R = 2
    s, i, j = it.reduced(arb(1), arb(3, 1))(arb(1), arb(3), 4, 5)
    assert s is asked[0] and s.contains(0) and s.contains(4) and not s.contains(4.1) and not s.contains(-0.1)
    assert (i, j) == (4, 7)


def test_a_value_is_within_an_interval_and_not_on_its_ends() -> None:
    sides = Fraction(1), Fraction(3)
    assert [_within(arb(v), sides) for v in (0, 1, 2, 3, 4)] == [False, False, True, False, False]


# --- boxes -------------------------------------------------------------------------------------------------------


def known(c: Any, P: Any, S: Any, s: Any = 0, rest: float = 0.0) -> Any:
    """A function F for a box: for each power of t factors of (p/P)^j ((s − s₀)/S)^k, with what it was asked for."""
    asked: list[Any] = []
    levels = [flint.arb_mat([[int(v) for v in row] for row in of]) for of in c]
    whole = SimpleNamespace(P=arb(P), s=arb(s), S=arb(S), levels=levels, rest=arb(rest), precision=BITS)

    def given(*sides: Any) -> Any:
        asked.append(sides)
        return whole

    return SimpleNamespace(on=given, at=given, asked=asked)


def derived(c: Any, P: float, S: float, p: complex, s: complex, i: int, j: int) -> complex:
    total = 0j
    for (a, b), factor in np.ndenumerate(c):
        if a >= i and b >= j:
            total += int(factor) * comb(a, i) * comb(b, j) * (p / P) ** (a - i) * (s / S) ** (b - j) / P**i / S**j
    return total


@pytest.mark.parametrize("size", [(4, 3), (18, 17)])
@pytest.mark.parametrize("complexes", [(False, False), (True, False), (False, True)])
def test_a_polynomial_is_what_it_is_on_a_box(size: tuple[int, int], complexes: tuple[bool, bool]) -> None:
    """And so its derivatives; beyond the degree it is in the ball of what these terms are at most."""
    c = np.random.default_rng(1).integers(-9, 10, (2, *size))
    F = known(c, 16, 64, s=2)
    with flint.ctx.workprec(BITS):
        p, s = (
            acb(arb(v, 0.25), arb(v / 2, 0.25)) if of else arb(v, 0.25) for v, of in zip((3, 5), complexes, strict=True)
        )
        for of in (None, 0, 1, 2):
            box = Box(F, p, s, of=of)
            for (i, j), shift in product(((0, 0), (1, 0), (0, 1), (2, 1), (1, 2), (0, 4)), (0.0, 0.2)):
                x, y = (v.mid() + shift for v in (p, s))
                found = acb(box.value(x, y, i, j))
                values = [derived(c[n], 16, 64, complex(x), complex(y) - 2, i, j) for n in (0, 1)]
                expected = {None: values[0], 0: values[0], 1: values[1], 2: 0}[of]
                off = abs(complex(found.mid()) - expected)
                wide = float(found.real.rad())
                # coefficients about the centre are in balls: there the sum is as wide as it must be
                more = abs(values[1].real) if of is None else 0
                if size == (4, 3):
                    assert off < 1e-12 and (
                        wide >= more * (1 - 1e-6) if shift else wide == pytest.approx(more, abs=1e-7)
                    )
                assert off <= wide + 1e-12 and (shift or wide <= more + 1e-2)
        reach = [float(abs(side - side.mid()).upper()) for side in (p, s)]
        sizes = [float(abs(side.mid()).upper()) for side in (p, s)]
        assert [*map(float, F.asked[0])] == pytest.approx([a + 2 * r + 1 for a, r in zip(sizes, reach, strict=True)])


def test_a_box_is_asked_for_no_more_than_is_known_of_it() -> None:
    F = known([[[1, 2], [3, 4]]], 8, 8)
    point, wide = Box(F, arb(1, 0.5), arb(2), 2), Box(F, arb(1, 0.5), arb(2, 0.5), 2)
    assert [len(sides) for sides in F.asked] == [3, 2] and F.asked[0][2] == 2
    for box, most in ((point, 2), (wide, 4)):
        box.value(arb(1), arb(2), 0, most)
        with pytest.raises(ArithmeticError, match="of a higher order"):
            box.value(arb(1), arb(2), 0, most + 1)
        for p, s in ((1.6, 2.0), (0.4, 2.0), (1.0, 2.6), (1.0, 1.4)):
            with pytest.raises(ArithmeticError, match="outside"):
                box.value(arb(p), arb(s))


@pytest.mark.parametrize("axis", [0, 1])
def test_a_box_is_not_larger_than_half_of_where_f_is_known(axis: int) -> None:
    """P − |p| − 2 r > 1/2, and S − |s − s₀| − 2 r' > 1/2."""
    for far, right in ((6.51, True), (6.49, False)):
        F = known([[[1, 2], [3, 4]]], *((far, 100) if axis == 0 else (100, far)), s=0 if axis == 0 else -1)
        sides = [arb(3, 1.5), arb(2, 1.5)]  # 3 + 3 + 1/2, and as much from s₀ = −1

        def made(F: Any = F, sides: Any = sides) -> bool:
            try:
                Box(F, *sides)
            except ArithmeticError:
                return False
            return True

        assert made() is right


def test_the_rest_of_a_box_is_that_of_cauchys_estimate() -> None:
    """r r' ρ/((r − 1)^(i+1) (r' − 1)^(j+1)) in units of the box, and the terms beyond the degree, derived."""
    it: Any = object.__new__(Box)
    with flint.ctx.workprec(BITS):
        it._rest, it._room, it._units = arb("0.01"), [arb(4), arb(6)], (arb("0.5"), arb("0.2"))
        it._beyond, it._left_out = [(9, 8, arb("0.03"))], {}
        for i, j in ((0, 0), (1, 0), (0, 1), (2, 1), (1, 2)):
            rest = 0.01 * 4 / 3 ** (i + 1) * 6 / 5 ** (j + 1)
            assert float(it._of_rest(i, j)) == pytest.approx(rest, rel=1e-12)
            assert float(it.rest(i, j)) == pytest.approx(rest / (0.5**i * 0.2**j), rel=1e-12)
            for _ in "ab":
                assert float(it._error(i, j)) == pytest.approx(rest + comb(9, i) * comb(8, j) * 0.03, rel=1e-12)


def test_powers_of_t_are_in_their_balls() -> None:
    for n, (low, high) in enumerate(((1, 1), (-1, 1), (0, 1), (-1, 1), (0, 1))):
        found = power(n)
        assert found.contains(low) and found.contains(high)
        assert float(found.mid()) == (low + high) / 2 and float(found.rad()) == pytest.approx((high - low) / 2)


def test_powers_of_q_are_summed_with_what_is_beyond_them() -> None:
    """Σ F_n (q/Q)^n and its slope by q, in a ball that is the rest; with the slope what it is over Q − |q| at most."""
    values = {(0, 0): (2, 3, 5), (1, 0): (7, 11, 13)}
    it: Any = object.__new__(Powers)
    with flint.ctx.workprec(BITS):
        it.Q = arb(4)
        it._boxes = [
            SimpleNamespace(value=lambda p, s, i, j, n=n: arb(values[i, j][n]), rest=lambda i, j: arb("0.5") * (i + 1))
            for n in range(3)
        ]
        for q, i in ((arb(1), 0), (arb(-2), 1), (acb(1, 2), 0)):
            t = complex(q) / 4
            a, b, c = values[i, 0]
            value, slope = it.value(0, 0, i, 0, q), it.value(0, 0, i, 0, q, 1)
            assert abs(complex(acb(value).mid()) - (a + b * t + c * t**2)) < 1e-12
            assert abs(complex(acb(slope).mid()) - (b + 2 * c * t) / 4) < 1e-12
            assert float(acb(value).real.rad()) < 1e-12
            for part in (slope.real, slope.imag) if isinstance(slope, acb) else (slope,):
                assert float(part.rad()) == pytest.approx(0.5 * (i + 1) / (1 - abs(t)) / 4, rel=1e-6)
        it.value(0, 0, 0, 0, arb("2.99"))
        with pytest.raises(ArithmeticError, match="outside of its box"):
            it.value(0, 0, 0, 0, arb("3.01"))


def test_coefficients_of_a_series_fall_as_those_that_bound_them_say() -> None:
    """Of y'''' + 3 x y'' + 5 x² y = 0: |a_{n+4}| (n+4)!/n! = 3 (n + 1) n |a_{n+1}| + 5 |a_{n-2}|, up to where it is
    nothing at a precision; what is beyond is T b^(N−n) from there on, with derivatives."""
    norms = [(2, 1, arb(3)), (0, 2, arb(5))]
    for base in (2, arb(5) / 4):
        with flint.ctx.workprec(BITS):
            sizes, rests = majorants(norms, 40, base)
        b = float(base)
        for r, found in enumerate(sizes):
            a = [float(n == r) for n in range(4)]
            for n in range(len(found) - 4):
                total = (5 * a[n - 2] if n > 1 else 0) + 3 * (n + 1) * n * a[n + 1]
                a.append(total / ((n + 4) * (n + 3) * (n + 2) * (n + 1)))
            assert [*map(float, found)] == pytest.approx(a, rel=1e-12, abs=0)
            last = len(a) - 1
            top = max(a[last - i] * b**-i for i in range(6))
            assert last > 20 and top < 2**-48
            for d, rest in enumerate(rests[r]):
                perm = np.prod([last + 1 - k for k in range(d)])
                assert float(rest) == pytest.approx(top * perm / b / (1 - (last + 2) / (b * (last + 2 - d))), rel=1e-12)
