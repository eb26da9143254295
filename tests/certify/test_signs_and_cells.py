"""Signs, cells and equations of a crossing, on polynomials in place of F whose zeros are known in closed form."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from itertools import product
from math import comb, prod
from types import SimpleNamespace
from typing import Any

import flint
import numpy as np
import pytest
from flint import acb, arb, fmpq_mpoly_ctx

from freebeam_derive.certify import verifier_equations, verifier_signs, verifier_spectrum
from freebeam_derive.certify.beam_cells import OpenStep
from freebeam_derive.certify.beam_stability import Below
from freebeam_derive.certify.verifier_cells import Cells
from freebeam_derive.certify.verifier_claims import Refused
from freebeam_derive.certify.verifier_equations import Equations
from freebeam_derive.certify.verifier_signs import Signs, Stretch
from freebeam_derive.certify.verifier_spectrum import Circle, Enclosed, Function

F = Fraction
P, S = fmpq_mpoly_ctx.get(("P", "s"), "lex").gens()
MEETING = ((S - 5) ** 2 - (1 - P)) * (20 - S)  # at P = 1 two eigenvalues s meet in 5; the third is 20
BUCKLING = (S - (1 - P)) * (20 - S)  # at P = 1 an eigenvalue is zero
NONE = F(0)
ZERO = NONE, NONE


class Polynomial:
    """What stands for F: of a beam, of a series on a box, and of the verifier."""

    ranged = False

    def __init__(self, of: Any) -> None:
        self.terms = {tuple(map(int, power)): F(int(c.p), int(c.q)) for power, c in of.to_dict().items()}

    def value(self, p: Any, s: Any, i: int = 0, j: int = 0) -> Any:
        """A Taylor coefficient, from those at the middle."""
        at, by = (p.mid(), s.mid()), (p - p.mid(), s - s.mid())
        around: dict[tuple[int, int], Any] = {}
        for (a, b), c in self.terms.items():
            for k, n in product(range(i, a + 1), range(j, b + 1)):
                factor = c * comb(a, k) * comb(b, n) * comb(k, i) * comb(n, j)
                start = around.get((k - i, n - j), arb(0))
                number = arb(factor.numerator) / factor.denominator
                around[k - i, n - j] = start + prod([at[0]] * (a - k) + [at[1]] * (b - n), start=number)
        # flint's own powers of a ball that holds 0 are not finite
        return sum((prod([by[0]] * k + [by[1]] * n, start=c) for (k, n), c in around.items()), p * 0 + s * 0)

    def taylor(self, p: Any, s: Any, orders: Any) -> dict[tuple[int, int], Any]:
        return {order: self.value(p, s, *order) for order in orders}


@pytest.fixture(autouse=True)
def polynomials_are_their_own_boxes(monkeypatch: pytest.MonkeyPatch) -> None:
    for module in (verifier_equations, verifier_signs, verifier_spectrum):
        monkeypatch.setattr(module, "Box", lambda whole, *_, **__: whole)


def equations(of: Any, R: int = 0, of_E: Fraction = NONE, of_M: Fraction = NONE, limit: bool = False) -> Equations:
    return Equations(Polynomial(of), R, (of_E, of_E), (of_M, of_M), limit)  # type: ignore[arg-type]


def still(start: Any, end: Any, *points: Any, moving: int | None = None, slope: Any = 0) -> Stretch:
    return Stretch(F(start), F(end), tuple(map(F, points)), moving, F(slope))


def is_stable(
    of: Any, stretches: list[Stretch], load: tuple[Any, Any], crossing: Any, R: int = 0, top: int = 40
) -> bool:
    with flint.ctx.workprec(128):
        try:
            Signs(equations(of, R), arb(top)).stable(stretches, tuple(map(F, load)), crossing)  # type: ignore[arg-type]
        except Refused:
            return False
    return True


ONE = [arb(1), arb(5)]  # where they meet
FIXED = still(0, F(9, 10), 0, 5, 12, 30)
LAST = still(F(9, 10), 1, 0, 5, 12, 30, moving=1, slope=F(1, 2))
AT = F(999, 1000), F(1001, 1000)


def test_the_lowest_are_stable_up_to_where_two_meet() -> None:
    """And are not known to be where a stretch, a point, the line or the load is another."""
    assert is_stable(MEETING, [FIXED, LAST], AT, ONE)
    assert is_stable(-MEETING, [FIXED, LAST], AT, ONE)
    halves = [still(0, F(1, 2), 0, 5, 12, 30), still(F(1, 2), F(9, 10), 0, 5, 19, 21)]
    assert is_stable(MEETING, [*halves, LAST], AT, ONE) and is_stable(MEETING, [FIXED], (0, F(9, 10)), None)
    for stretches, load in (
        ([LAST], AT),
        ([FIXED], AT),
        ([], AT),
        ([FIXED, FIXED], AT),
        ([halves[0], LAST], AT),
        ([*halves, still(F(9, 10), F(9, 10), 0, 5, 12, 30), LAST], AT),
        ([FIXED, still(F(9, 10), 1, 0, 5, 12, 30)], AT),
        ([LAST, FIXED], AT),
        ([FIXED, LAST], (F(1001, 1000), F(1002, 1000))),
        ([FIXED, still(F(9, 10), 1, 0, 5, 12, 30, moving=2, slope=F(1, 2))], AT),
        ([FIXED, still(F(9, 10), 1, 0, 5, 12, 30, moving=1, slope=80)], AT),
        ([FIXED, still(F(9, 10), 1, 0, 5, 12, 30, moving=1, slope=-80)], AT),
        ([FIXED, still(F(9, 10), 1, 0, 5, 12, 30, moving=1, slope=4)], AT),  # steeper than either branch there
        ([FIXED, still(F(9, 10), 1, 0, 5, 12, 41, moving=1, slope=F(1, 2))], AT),
        ([still(0, F(9, 10), 0, 5, 7, 12), LAST], AT),
        ([still(0, F(9, 10), 0, 5, 12, 15), LAST], AT),
        ([still(0, F(9, 10), 0, F(11, 2), 12, 30), LAST], AT),  # where an eigenvalue passes
    ):
        assert not is_stable(MEETING, stretches, load, ONE)
    assert not is_stable(MEETING, [FIXED], (0, 1), None)
    # another that meets before
    earlier = ((S - 5) ** 2 * 11 - (9 - 11 * P)) * (20 - S)
    assert not is_stable(earlier, [FIXED, LAST], AT, ONE)


@pytest.mark.parametrize("R", [0, 1, 2])
def test_the_lowest_are_stable_up_to_where_one_is_zero(R: int) -> None:
    """Beside rigid motions, which put a factor s^R into F."""
    of, none = BUCKLING * S**R, [arb(1), arb(0)]
    first, last = still(0, F(9, 10), 0, 10, 30), still(F(9, 10), 1, 0, 10, 30, moving=0)
    assert is_stable(of, [first, last], AT, none, R) and is_stable(-of, [first, last], AT, none, R)
    for stretches in ([last], [first], [first, still(F(9, 10), 1, 0, 10, 30, moving=1)], [first, first]):
        assert not is_stable(of, stretches, AT, none, R)
    assert not is_stable(of, [first, last], AT, none, R + 1) and not is_stable(
        of * (S - 15), [first, last], AT, none, R
    )


def test_static_zeros_are_each_known_or_found() -> None:
    """Of (P − 1)(P − 3): all in their intervals, on all of the way."""
    of = (P - 1) * (P - 3) * (20 - S) + S
    known = [(F(99, 100), F(101, 100)), (F(299, 100), F(301, 100))]
    for R, top, given, holds in (
        (0, F(4), known, True),
        (1, F(4), known, True),
        (0, F(2), known[:1], True),
        (0, F(1, 2), [], True),
        (0, F(4), known[:1], False),
        (0, F(4), known[1:], False),
        (0, F(4), [], False),
        (0, F(4), [(F(1, 2), F(7, 2))], False),
    ):
        with flint.ctx.workprec(128):
            signs = Signs(equations(of * S**R, R), arb(40))
            if holds:
                signs.static(top, given)
            else:
                with pytest.raises(Refused, match="not known to differ from zero"):
                    signs.static(top, given)


# ------------------------------------------------------------ the same of the prover


def below(of: Any, m: int, load: float, estimates: Callable[[float], list[complex]], R: int = 0) -> Below:
    strips = SimpleNamespace(
        rigid=R, line=lambda _: arb(40), estimates=lambda P, count: np.sort_complex(np.array(estimates(P)))[:count]
    )
    return Below(Polynomial(of), strips, m, arb(load))  # type: ignore[arg-type]


def meeting(P: float) -> list[complex]:
    root = complex(1 - P) ** 0.5
    return [5 - root, 5 + root, 20, 90]


def seen(of: Any, m: int, square: float | None, estimates: Any, R: int = 0) -> list[Stretch]:
    with flint.ctx.workprec(128):
        return list(below(of, m, 1.0, estimates, R).real_and_simple(None if square is None else arb(square)))  # type: ignore[arg-type]


@pytest.mark.parametrize("sign", [1, -1])
def test_the_prover_s_stretches_are_what_the_verifier_accepts(sign: int) -> None:
    found = seen(sign * MEETING, 3, 5.0, meeting)
    given = [still(s.start, s.end, *s.separators, moving=s.moving[0], slope=s.moving[1]) if s.moving else
             still(s.start, s.end, *s.separators) for s in found]  # type: ignore[attr-defined]  # fmt: skip
    assert is_stable(MEETING, given, (F(999, 1000), 1), ONE)
    for R in (0, 1):
        stretches = seen(sign * BUCKLING * S**R, 2, None, lambda P: [1 - P, 20, 90], R)
        given = [still(s.start, s.end, *s.separators, moving=s.moving and s.moving[0]) for s in stretches]  # type: ignore[attr-defined]
        assert is_stable(BUCKLING * S**R, given, (F(999, 1000), 1), [arb(1), arb(0)], R)


def test_the_prover_does_not_see_stability_where_signs_do_not_alternate() -> None:
    """Where the signs are not as they should be: with one more, and of two that part at P = 1."""
    with pytest.raises(OpenStep, match="low frequencies"):
        seen(MEETING * (S - 15), 3, 5.0, meeting)
    with pytest.raises(OpenStep, match="low frequencies"):
        seen(((S - 5) ** 2 - (P - 1)) * (20 - S), 3, 5.0, meeting)


def test_static_zeros_are_seen_by_the_prover() -> None:
    for R, of, load, kind, free in (
        (0, BUCKLING, 1.0, "divergence", True),
        (1, BUCKLING * S, 1.0, "divergence", True),
        (0, BUCKLING, 0.75, "flutter", True),
        (0, BUCKLING, 1.0, "flutter", False),
        (0, BUCKLING, 1.25, "flutter", False),
        (0, BUCKLING * (3 * P - 1), 0.75, "flutter", False),
    ):
        with flint.ctx.workprec(128):
            it = below(of, 2, load, lambda P: [1 - P, 20, 90], R)
            if free:
                it.no_divergence(kind)
            else:
                with pytest.raises(OpenStep, match="divergence"):
                    it.no_divergence(kind)
            assert it.rising(arb(0), arb(1) / 8) == (-1 if of.degrees()[0] > 1 else 1)


# ------------------------------------------------------------ a crossing, and cells about it


@pytest.mark.parametrize("turned", [False, True])
def test_where_a_flutter_is_and_which_way(turned: bool) -> None:
    """Without damping at P = 1, s = 5; with external damping where (Im s)² = β² Re s. With P turned round it ends."""
    of = ((S - 5) ** 2 - (1 - (2 - P if turned else P))) * (20 - S)
    for beta in (F(0), F(1, 10), F(1, 2)):
        load = 1 - 5 * beta**2 if turned else 1 + 5 * beta**2
        hair = F(1, 1000)
        with flint.ctx.workprec(128):
            found, change = equations(of, 0, F(0), beta).flutter(
                (load - hair, load + hair), (5 - 4 * hair, 5 + 4 * hair)
            )
            assert abs(found[0] - arb(float(load))) < 1e-3 and (change < 0 if turned else change > 0)
            square = found[1] if beta == 0 else found[1] ** 2
            assert square.overlaps(arb(5)) and square.rad() < 1e-2
            for move in ((load + 2 * hair, load + 3 * hair), (load - 3 * hair, load - 2 * hair)):
                with pytest.raises(Refused, match="no crossing in the interval"):
                    equations(of, 0, F(0), beta).flutter(move, (5 - 4 * hair, 5 + 4 * hair))
            with pytest.raises(Refused, match="no crossing in the interval"):
                equations(of, 0, F(0), beta).flutter((load - hair, load + hair), (5 + 4 * hair, 5 + 8 * hair))


@pytest.mark.parametrize("R", [0, 2])
def test_where_a_divergence_is_and_which_way(R: int) -> None:
    near, hair = (F(99, 100), F(101, 100)), F(1, 100)
    for of, way in ((BUCKLING, 1), (-BUCKLING, 1), ((S - (P - 1)) * (20 - S), -1)):
        for of_E, of_M in (ZERO, (F(0), F(1, 3)), (F(1, 7), F(0))):
            with flint.ctx.workprec(128):
                change = equations(of * S**R, R, of_E, of_M).divergence(near)
                assert change * way > 0 or (way < 0 and of_E > 0)
                with pytest.raises(Refused, match="no crossing in the interval"):
                    equations(of * S**R, R, of_E, of_M).divergence((1 + hair, 1 + 2 * hair))


@pytest.mark.parametrize("beta", [F(0), F(1, 2)])
def test_cells_hold_no_crossing_but_the_known(beta: Fraction) -> None:
    load, top, hair = 1 + 5 * beta**2, F(3) if beta else F(7), F(1, 1000)
    with flint.ctx.workprec(64):
        of = equations(MEETING, 0, F(0), beta)
        known, _ = of.flutter((load - hair, load + hair), (F(499, 100), F(501, 100)))
        Cells(of, load + F(1, 8), [known]).check(top)
        Cells(of, load - F(1, 8), []).check(top)
        with pytest.raises(Refused, match="another crossing could be near"):
            Cells(of, load + F(1, 8), []).check(top)


# ------------------------------------------------------------ all eigenvalues within a circle


@pytest.mark.parametrize(("of_E", "of_M"), [(F(0), F(3)), (F(1, 20), F(1, 5)), (F(1, 20), F(-1))])
def test_a_circle_holds_as_many_zeros_as_are_within(of_E: Fraction, of_M: Fraction) -> None:
    """λ² + βλ + s (1 + αλ) = 0 for each of the s of the load; one zero is in a square about each of these λ alone."""
    load = F(1, 4)  # p is no number where α is not zero
    roots = [np.roots([1 - 0 * s, float(of_M) + float(of_E) * s, s]) for s in (5, 20, 90)]
    F_of = (S - 5) * (S - 20) * (S - 90)
    places = sorted(np.concatenate(roots), key=abs)
    with flint.ctx.workprec(128):
        f: Any = Function(Polynomial(F_of), load, of_E, of_M)  # type: ignore[arg-type]
        for radius in (F(3), F(6)):
            if abs(np.abs(places) - float(radius)).min() > 0.05 and radius * of_E < 1:
                assert Circle(f, radius).zeros() == sum(abs(v) < radius for v in places)
        for v in places[:4]:
            re, im = (F(round(part * 2**40), 2**40) for part in (v.real, v.imag))
            for shift, holds in ((F(0), True), (F(1, 1100), True), (F(1, 900), False)):
                assert f.one_in(Enclosed(re + shift, im, F(1, 1000))) == holds
                assert f.one_in(Enclosed(re, im - shift, F(1, 1000))) == holds
            at = f.near(acb(v.real, v.imag) + acb(arb(0, 0.1), arb(0, 0.1)))
            h, here = acb(1e-12, 1e-12), acb(v.real + 0.01, v.imag - 0.02)
            difference = (at(here + h)[0] - at(here - h)[0]) / (2 * h)
            assert abs(difference / at(here)[1] - 1) < 1e-6


def test_a_circle_through_a_zero_is_refused() -> None:
    with flint.ctx.workprec(128):
        f: Any = Function(Polynomial((S - 4) * (S - 20)), NONE, NONE, NONE)  # type: ignore[arg-type]
        with pytest.raises(Refused, match="too near an eigenvalue"):
            Circle(f, F(2)).zeros()
        whole = Circle(f, F(3))
        quarters = [whole.turned(F(k, 24), F(k + 1, 24)) for k in range(24)]
        assert all(turn is not None for turn in quarters)
        assert abs(sum((turn for turn in quarters if turn), arb(0)) / arb.pi() - 2) < 1e-20
