"""What the verifier shows of a column besides F: energy, gaps, frequencies, touches, and cells between crossings."""

from __future__ import annotations

from fractions import Fraction
from math import cos, pi, sin, sqrt
from types import SimpleNamespace
from typing import Any

import flint
import numpy as np
import pytest
from flint import arb, arb_poly, fmpq_poly

from freebeam_derive.certify import verifier_lists, verifier_of_beam, verifier_of_sections, verifier_touches
from freebeam_derive.certify.verifier_claims import Damping, Refused
from freebeam_derive.certify.verifier_lists import WIDE
from freebeam_derive.certify.verifier_of_beam import First, High
from freebeam_derive.certify.verifier_of_sections import Frequencies, Gaps, square
from freebeam_derive.certify.verifier_plane import check_apart
from freebeam_derive.certify.verifier_sections import PIECES, Sections
from tests.certify.refusals import served

F = Fraction


# --- the energy and the gaps of a column ---------------------------------------------------------------------------


def column(**given: Any) -> Sections:
    fixed: Any = {
        "ends": ("clamped", "free"), "breaks": (F(0), F(1)), "EI": [fmpq_poly([3])], "m": [fmpq_poly([2])],
        "elastic": [{}], "load": [{}], "masses": {}, "springs": {}, "forces": {},
    }  # fmt: skip
    return Sections(**fixed | given)


def test_energy_is_less_by_what_a_negative_axial_force_takes() -> None:
    """y'² ≤ |x − e| ∫ y''² from an end e that holds y': c ∫ |x − e| dx over EI, |x − e| at its most on a piece."""
    half = 0.5 * (1 + 1 / PIECES)
    with flint.ctx.workprec(64):
        for ends, EI, force, lost in (
            (("clamped", "free"), 3, [-2], half), (("free", "clamped"), 3, [-2], half),
            (("pinned", "sliding"), 5, [-2], half), (("clamped", "free"), 3, [2], 0), (("free", "free"), 3, [2], 0),
        ):  # fmt: skip
            of = column(ends=ends, EI=[fmpq_poly([EI])], elastic=[{1: fmpq_poly(force)}])
            assert float(of.bending) == pytest.approx(1 - abs(force[0]) * lost / EI, rel=1e-9)
        assert served(lambda: column(EI=[fmpq_poly([1])], elastic=[{1: fmpq_poly([-1])}]).bending)
        for wrong in (
            {"elastic": [{0: fmpq_poly([-1])}]}, {"ends": ("pinned", "pinned"), "elastic": [{1: fmpq_poly([-1])}]},
            {"EI": [fmpq_poly([1])], "elastic": [{1: fmpq_poly([-2])}]},
            {"elastic": [{1: fmpq_poly([-1])}], "joints": {(1, 0): F(1)}},
        ):  # fmt: skip
            assert not served(lambda wrong=wrong: column(**wrong).bending)  # type: ignore[misc]


def test_stretches_of_x_lie_one_after_another_from_break_to_break() -> None:
    of = column(breaks=(F(0), F(1, 4), F(1)))
    for n, (low, high) in enumerate(((0, 0.25), (0.25, 1))):
        edges = np.linspace(low, high, PIECES + 1)
        for (x, width), a, b in zip(of.pieces(n), edges[:-1], edges[1:], strict=True):
            assert (float(x.mid()), float(x.rad()), float(width)) == pytest.approx(
                ((a + b) / 2, (b - a) / 2, b - a), rel=1e-6
            )


def gaps_of(known: list[tuple[float, float]], top: float, m: int, monkeypatch: pytest.MonkeyPatch, **given: Any) -> Any:
    """Of frequencies that are known, for a load of 2 that needs a gap of half the mean frequency times it."""
    it: Any = object.__new__(Gaps)
    it.columns, it.m, it.top, it.damping = [(SimpleNamespace(joints={}), None)], m, arb(top), None
    it.size = SimpleNamespace(at=lambda low, high: (low + high) / 80, constant=arb("0.25"), places=[])
    for name, value in given.items():
        setattr(it, name, value)
    asked: list[Any] = []

    def gap(needed: Any) -> Any:
        asked.append(float(needed(arb(40), arb(60))))
        return arb(1), arb(50)

    monkeypatch.setattr(verifier_of_sections, "Apart", lambda *columns: SimpleNamespace(gap=gap, whole=arb(7)))
    monkeypatch.setattr(it, "_frequencies", lambda beyond, length: asked.append((float(beyond), float(length))) or [
        (arb(low), arb(high)) for low, high in known
    ])  # fmt: skip
    it.asked = asked
    return it


def test_gaps_and_the_line_are_as_wide_as_the_load_needs(monkeypatch: pytest.MonkeyPatch) -> None:
    """2 (ω + ω')/80 < ω' − ω of all from the line on; at the line of a b = R about it; not of those below it."""
    equations: Any = SimpleNamespace(F=SimpleNamespace(on=lambda P, top: None, ready=lambda P, top: None))
    wide, known = 41 / 39, [(1.0, 1.001), (1.01, 1.02), (10.0, 10.1), (20.0, 20.1)]
    for third, right in ((20.1 * wide + 0.001, True), (20.1 * wide - 0.001, False)):
        it = gaps_of([*known, (third, third + 1)], 10.0, 2, monkeypatch)
        assert served(lambda it=it: it.check(F(2), equations)) is right  # type: ignore[misc]
        assert it.asked == [pytest.approx(2 * 100 / 80), (pytest.approx(10**0.25), 7)]
    it = gaps_of(known, 50.0, 4, monkeypatch)
    assert not served(lambda: it.check(F(2), equations))
    # a = max(ω_m, R/ω_m+1) and b = R/a are wide apart, within R/ω_m − ω_m and ω_m+1 − R/ω_m+1
    for top in np.linspace(4, 420, 60):
        it = gaps_of([(2.0, 2.1), (20.0, 20.1), (41.0, 41.1)], top, 1, monkeypatch)
        a = max(2.1, top / 20)
        right = bool(2 * (a + top / a) / 80 < min(top / 2.1 - 2.1, 20 - top / 20))
        assert served(lambda it=it: it.check(F(2), equations)) is right  # type: ignore[misc]


def test_with_damping_gaps_are_looked_for_that_are_wider_and_the_least_is_handed_on(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    equations: Any = SimpleNamespace(F=SimpleNamespace(on=lambda P, top: None, ready=lambda P, top: None))
    seen: list[Any] = []
    known = [(2.0, 2.1), (20.0, 20.1), (41.0, 41.1), (50.0, 50.1)]
    for bare in ({}, {(1, 0): F(1)}):
        damping = SimpleNamespace(
            of_mass=False,
            bare=bare,
            served_from=lambda loaded: arb(10**4) * loaded,
            check=lambda *given: seen.append(given),
        )
        it = gaps_of(known, 40.0, 1, monkeypatch, damping=damping)
        monkeypatch.setattr(it, "_motions", lambda damping, beyond, length: [float(beyond)])
        it.check(F(2), equations)
        reach = max(1, 40**0.25, sqrt(5000) if bare else 0)
        assert it.asked == [pytest.approx(4 * 2 * 100 / 80), (pytest.approx(reach), 7)]
        loaded, gap, frequency, modes = seen.pop()
        assert (float(loaded), float(frequency), modes) == (0.5, 2, [pytest.approx(reach)])
        assert float(gap) == pytest.approx(50 - 41.1)
    damping = SimpleNamespace(of_mass=True)
    it = gaps_of(known, 40.0, 1, monkeypatch, damping=damping)  # p is real
    it.check(F(2), equations)
    for places, joints, of_mass, right in (([1], {}, True, True), ([1], {}, False, False), ([], {1: 2}, False, False)):
        damping = SimpleNamespace(of_mass=of_mass, bare={}, check=lambda *_: None)
        columns = [(SimpleNamespace(joints=joints), None)]
        it = gaps_of(known, 40.0, 1, monkeypatch, damping=damping, columns=columns)
        it.size.places = places
        monkeypatch.setattr(it, "_motions", lambda *_: [])
        assert served(lambda it=it: it.check(F(2), equations)) is right  # type: ignore[misc]


def test_frequencies_of_two_columns_are_bounds_of_both_and_as_many() -> None:
    each = [[(1, 2), (5, 6), (9, 10)], [(0, 3), (5.5, 5.6)]]
    asked: list[int] = []

    class Stand:
        def __init__(self, F: Any, beyond: arb, length: arb) -> None:
            self.of = F

        def all(self, count: int = 1) -> Any:
            asked.append(count)
            found = each[self.of] if count == 1 else [*each[self.of], (8, 11)]
            return [(arb(a), arb(b)) for a, b in found]

    it: Any = object.__new__(Gaps)
    it.columns = [(None, 0), (None, 1)]
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(verifier_of_sections, "Frequencies", Stand)
        found = it._frequencies(arb(3), arb(7))
    assert [(float(a), float(b)) for a, b in found] == [(0, 3), (5, 6), (8, 11)] and asked == [1, 1, 3]


def frequencies(polynomial: Any, rest: float, beyond: float = 1.0) -> Any:
    it: Any = object.__new__(Frequencies)
    it.F, it.rest, it.scale, it.bits, it.beyond, it.step = (
        arb_poly(polynomial),
        arb(rest),
        arb(1024),
        128,
        arb(beyond),
        F(197, 1024),
    )
    return it


def test_frequencies_are_the_zeros_of_f_and_no_fewer() -> None:
    """(u − u_1)(u − u_2)…, u = γ⁴/S; up to the first beyond, and so many as are asked for."""
    gammas = [1.0, 1.9, 2.0, 2.6, 3.1]
    polynomial = np.polynomial.Polynomial.fromroots([g**4 / 1024 for g in gammas])
    for beyond, count, expected in ((1.9, 1, 3), (0.5, 1, 1), (0.5, 4, 4), (2.0, 3, 4)):
        it = frequencies([1e9 * float(c) for c in polynomial.coef], 1e-12, beyond)
        with flint.ctx.workprec(64):
            found = it.all(count)
        assert len(found) == expected
        for (low, high), g in zip(found, gammas, strict=False):
            assert float(low) - 1e-6 <= g**2 <= float(high) + 1e-6 and float(high) - float(low) < 1e-4
    # what is left out may be a zero
    for rest, right in ((0.49, True), (0.51, False)):
        it = frequencies([0.5], rest)
        assert served(lambda it=it: it._between(F(1), F(2), 0) == [] or None) is right  # type: ignore[misc]
        assert (it._sign(F(1)) == 1) is right


def test_how_a_mode_moves_at_a_place_is_how_its_frequency_rises_with_a_spring() -> None:
    """dω²/dk = −S F_k/F_u, in balls of the rests: F_k that of the stiffer, F_u with twice that of the column."""
    still, stiffer = frequencies([-1, 4], 1e-6), frequencies([-1.5, 4], 2e-6)  # zero at u = 1/4
    omega = 16.0  # ω² = S/4
    with flint.ctx.workprec(64):
        found = square([still], [stiffer], (arb(omega), arb(omega)))
        assert float(found.mid()) == pytest.approx(1024 * 0.5 / 4)
        assert float(found.rad()) == pytest.approx(128 * (2e-6 / 0.5 + 2 * 1e-6 / 4), rel=2e-3)
        wide = square([still], [stiffer], (arb(15.9), arb(16.1)))
        more = 4 * (16.1**2 - 15.9**2) / 1024 / 2  # of the stiffer, about the middle
        assert wide.contains(128) and float(wide.rad()) == pytest.approx(128 * more / 0.5, rel=0.02)
        other = frequencies([-1, 4], 1e-6)
        other.scale = arb(2048)
        assert not served(lambda: square([still], [other], (arb(omega), arb(omega))))


# --- of the beam itself ----------------------------------------------------------------------------------------------


def test_forms_are_taken_apart_as_their_signs_say() -> None:
    """What is not positive for itself: products of unlike factors, and squares times what is negative."""
    along = tuple((0, p, q, F(f)) for p, q, f in ((2, 2, 1), (1, 1, 3), (1, 1, -3), (0, 1, 3), (0, 0, F(1, 2))))
    points = tuple(
        (*key, F(f)) for key, f in (((1, 0, 1, 0), 2), ((1, 0, 1, 0), -2), ((1, 0, 0, 0), 2), ((1, 1, 1, 1), F(1, 2)))
    )
    form: Any = (along, points)
    assert verifier_of_beam._unbent(form) == (along[1:], points)
    assert verifier_of_beam._softening((along[1:], points)) == ((along[2], along[3]), (points[1], points[2]))


def test_damping_of_a_piece_goes_linearly_from_end_to_end() -> None:
    def of(M: Any, E: Any, vanishing: bool = False) -> Any:
        return SimpleNamespace(damping=Damping(F(M), F(E), vanishing))

    shares = F(1, 4), F(1, 2)
    found = verifier_of_beam._damping(of(1, 2), of(5, 10), shares)
    assert found == ((4, 6), (2, 3), False)
    none: Any = SimpleNamespace(damping=None)
    nothing = (0, 0), (0, 0), False
    assert (
        verifier_of_beam._damping(none, of(1, 2), shares)
        == verifier_of_beam._damping(of(1, 2), none, shares)
        == nothing
    )
    alone = of(1, 0, True)
    assert verifier_of_beam._damping(alone, alone, shares) == nothing
    assert verifier_of_beam._damping(alone, of(1, 2, True), shares) == ((F(1, 2), 1), (1, 1), True)
    assert verifier_of_beam._damping(of(1, 0), of(1, 0), shares) == ((0, 0), (1, 1), False)


def test_with_internal_damping_the_lines_are_free_for_as_much_more_load(monkeypatch: pytest.MonkeyPatch) -> None:
    """P (1 + 2 (R_m+1/R_m − 1)/(π (1 − s_0/R_m))), s_0 where a motion is not damped."""
    it: Any = object.__new__(High)
    it.m, it.top, it.norms = 2, arb(100), [("still", "loaded"), ("a", "b")]
    it.lines = SimpleNamespace(line=lambda k: arb({3: 300}[k]))
    seen: list[Any] = []
    monkeypatch.setattr(verifier_of_beam, "check_free", lambda *given: seen.append(given))
    for of_E, to, factor in ((F(0), F(0), 1.0), (F(1), F(0), 1 + 2 * 2 / pi), (F(1), F(20), 1 + 2 * 2.5 / pi)):
        it.check(F(7), SimpleNamespace(of_E=(of_E, of_E), undamped_to=to))
        assert [(m, *names) for m, _, *names in seen] == [(2, "still", "loaded"), (2, "a", "b")]
        assert all(float(rho) == pytest.approx(7 * factor, rel=2e-6) for _, rho, *_ in seen)
        assert all(float(rho) >= 7 * factor * (1 - 1e-15) for _, rho, *_ in seen)
        seen.clear()
    assert not served(lambda: it.check(F(7), SimpleNamespace(of_E=(F(1), F(1)), undamped_to=F(100))))


def test_beyond_a_frequency_no_low_mode_reaches_the_axis() -> None:
    """√(R/(1 − α β − α² R)), or max(1 − 2 min(αβ, 0), P N/(1/√2 − N_0))/α; R itself where unknowns are real."""
    it: Any = object.__new__(High)
    it.top, it._softening = arb(100), [SimpleNamespace(on=lambda k, x=x: arb([x, 9][k])) for x in (0.1, 0.2)]
    it.norms = [(None, SimpleNamespace(on=lambda k, x=x: arb([x, 9][k]))) for x in (0.3, 0.05)]
    spare = 1 / sqrt(2) - 0.2

    def top(alpha: float, beta: float, load: int) -> float:
        return float(it.highest(SimpleNamespace(real=False, alpha=arb(alpha), beta=arb(beta)), F(load)))

    assert float(it.highest(SimpleNamespace(real=True), F(1))) == 100
    assert top(0, 3, 9) == pytest.approx(10)
    assert top(0.01, 3, 9) == pytest.approx(sqrt(100 / (1 - 0.03 - 0.01)))
    for alpha, beta, load in ((0.2, 3.0, 9), (0.2, 3.0, 1), (0.2, -3.0, 1)):
        assert top(alpha, beta, load) == pytest.approx(max(load * 0.3 / spare, 1 - 2 * min(alpha * beta, 0)) / alpha)
    it._softening = [SimpleNamespace(on=lambda k: arb("0.8"))]
    assert not served(lambda: top(0.2, 3, 9)) and top(0.01, 3, 9) == pytest.approx(sqrt(100 / 0.96))


@pytest.mark.parametrize(("real", "undamped", "kind"), [
    (True, True, "flutter"), (True, True, "divergence"), (True, False, "flutter"), (True, False, "divergence"),
    (False, False, "flutter"), (False, False, "divergence"),
])  # fmt: skip
def test_of_a_first_crossing_all_is_asked_that_its_proof_needs(
    real: bool, undamped: bool, kind: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Signs up to it where unknowns are real, else at P = 0 and of F(P, 0); with damping also below what it acts on,
    and cells, with the crossing's box of a flutter."""
    asked: list[Any] = []
    box, stretches, flutter = [arb(2), arb(3)], ("stretch",), kind == "flutter"
    load, square_of = (F(2), F(201, 100)), (F(4), F(5))

    class Asked:
        def __init__(self, *given: Any) -> None:
            if len(given) == 3:
                asked.append(("cells", *given[1:]))

        def __getattr__(self, name: str) -> Any:
            return lambda *given: asked.append((name, *given))

    monkeypatch.setattr(verifier_of_beam, "Signs", Asked)
    monkeypatch.setattr(verifier_of_beam, "Cells", Asked)
    equations: Any = SimpleNamespace(
        real=real, undamped=undamped, limit=real and not undamped, bits=77, undamped_to=F(9),
        flutter=lambda load, square: asked.append(("flutter", load, square, flint.ctx.prec)) or (box, arb(1)),
        divergence=lambda load: asked.append(("divergence", load, flint.ctx.prec)) or arb(1),
    )  # fmt: skip
    high: Any = SimpleNamespace(
        top=arb(50),
        check=lambda *given: asked.append(("high", *given)),
        highest=lambda equations, top: ("highest", top),
    )
    claim: Any = SimpleNamespace(kind=kind, load=load, square=square_of if flutter else None)
    for ranged, bits in ((False, 77 + 8), (True, 77)):
        asked.clear()
        First(equations, high, claim, ranged).check(stretches)  # type: ignore[arg-type]
        names = {name: given for name, *given in asked}
        assert names["high"] == [load[1], equations]
        assert names[kind] == [load, square_of, bits] if flutter else [load, bits]
        assert ("check_order" in names) is ("stable" in names) is real
        if real:
            assert names["check_order"] == [stretches, undamped or not flutter]
            assert names["stable"][:2] == [stretches, load] and (names["stable"][2] is None) is (
                flutter and not undamped
            )
        assert ("at_rest" in names) is ("static" in names) is not real
        if not real:
            assert names["at_rest"] == [[*stretches]] and names["static"] == [load[1], [] if flutter else [load]]
        assert ("above" in names) is ("cells" in names) is not undamped
        if not undamped:
            assert names["above"] == [F(9), [*stretches]] and names["cells"] == [load[1], [box] if flutter else []]
            assert names["check"] == [("highest", load[1])]
    for change in (arb(-1), arb(0, 1), arb(0)):
        equations.flutter, equations.divergence = (lambda *_, c=change: (box, c)), (lambda *_, c=change: c)
        assert not served(lambda: First(equations, high, claim, False).check(stretches))  # type: ignore[arg-type]


# --- touches ---------------------------------------------------------------------------------------------------------


def test_touches_are_where_a_cosine_is_one_or_minus_one(monkeypatch: pytest.MonkeyPatch) -> None:
    for sign, load, expected in (
        (1, 9, []),
        (1, 10, [1]),
        (1, 88, [1]),
        (1, 100, [1, 3]),
        (-1, 39, []),
        (-1, 100, [2]),
        (-1, 158, [2, 4]),
    ):
        monkeypatch.setattr(verifier_touches, "_sign", lambda F, R, sign=sign: sign)
        assert verifier_touches.touches(None, 0, F(load)) == expected  # type: ignore[arg-type]


def test_solutions_at_rest_and_their_determinant_are_those_of_a_cosine_and_a_sine() -> None:
    k = 1.7

    def value(waves: Any) -> float:
        return sum(float(f) * k**a * cos(k) ** c * sin(k) ** s for (a, c, s), f in waves.items())

    for end in (0, 1):
        for order in range(4):
            x = np.polynomial.Polynomial([0, 1])
            wave = [(-1) ** ((order + 1) // 2) * (sin if order % 2 else cos)(k * end) * k**order]
            wave += [(-1) ** (order // 2) * (cos if order % 2 else sin)(k * end) * k**order]
            expected = [float(order == 0), (x.deriv(order) if order else x)(end), *wave]
            assert [value(w) for w in verifier_touches._solutions(end, order)] == pytest.approx(expected, abs=1e-12)
    rows = [
        [verifier_touches._solutions(end, order)[column] for column in range(4)]
        for end, order in ((0, 1), (0, 3), (1, 0), (1, 2))
    ]
    rows[1] = [{key: f * 3 for key, f in w.items()} | {(1, 1, 1): F(2)} for w in rows[1]]
    found = verifier_touches._determinant(rows)
    assert value(found) == pytest.approx(np.linalg.det([[value(w) for w in row] for row in rows]))
    assert all(s < 2 for _, _, s in found)


# --- between crossings -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("seed", range(8))
def test_a_common_root_of_two_functions_is_not_passed_over(seed: int) -> None:
    """h and g that vanish together at a load within, with x below 1 and above; not where it is moved from it."""
    draw = np.random.default_rng(seed)
    P, x = draw.uniform(2.1, 2.9), (draw.uniform(0.1, 0.9) if seed % 2 else draw.uniform(1.2, 4))
    both = []
    for _ in "hg":
        c = draw.integers(-5, 6, (3, 3)).astype(float)
        c[0, 0] -= sum(c[b, a] * P**a * x**b for a in range(3) for b in range(3))
        both.append([arb_poly([*map(float, row)]) for row in c])
    with flint.ctx.workprec(64):
        assert not served(lambda: check_apart(both[0], both[1], arb(2), arb(3), 12))
        near = [both[0], [p + v * p for p, v in zip(both[0], (0, 0, 0), strict=True)]]
        assert not served(lambda: check_apart(near[0], near[1], arb(2), arb(3), 12))
        lifted = [arb_poly([6]), arb_poly([0, 1]), arb_poly([1])]  # 6 + P x + x²
        assert served(lambda: check_apart(lifted, both[1], arb(2), arb(3), 12))


def test_about_a_crossing_a_wider_interval_is_shown_to_be_its_own_where_there_is_room() -> None:
    """As wide as a share of the load, and ω² by as much as it changes there: twice (|f_P/f_x| + x/P) times that."""
    asked: list[Any] = []
    P, x = F(10), F(3)
    reach = P * WIDE
    series: Any = SimpleNamespace(
        damped=True, h=[arb_poly([1, 2]), arb_poly([5])], g=[arb_poly([7, 3]), arb_poly([4])],
        check_crossing=lambda low, high, of: asked.append((low, high, of)),
    )  # fmt: skip
    narrow = P - reach / 4, P
    room = F(0), F(20)
    with flint.ctx.workprec(64):
        found = verifier_lists._widened(series, narrow, (x - reach, x), room)
        assert found == (narrow[0] - reach, P + reach)
        ((low, high, (left, right)),) = asked
        spread = 2 * (3 / 4 + 3 / 10) * float(reach)
        assert (low, high) == found
        assert float(x - reach - left) == pytest.approx(spread, rel=1e-6) and float(right - x) == pytest.approx(
            spread, rel=1e-6
        )
        series.g = [arb_poly([7, 3])]  # of one motion: h in place of g
        verifier_lists._widened(series, narrow, (x, x + reach), room)
        spread = 2 * (2 / 5 + 3 / 10) * float(reach)
        assert float(asked[1][2][1] - x - reach) == pytest.approx(spread, rel=1e-6)
        for square_of in (None, (F(0), F(0))):
            verifier_lists._widened(series, narrow, square_of, room)
            assert asked[-1][2] == square_of
        count = len(asked)
        for load, within in (
            ((P - 2 * reach, P), room), (narrow, (narrow[0] - reach, F(20))), (narrow, (F(0), P + reach)),
        ):  # fmt: skip
            assert verifier_lists._widened(series, load, None, within) == load and len(asked) == count

        def refused(*_: Any) -> None:
            raise Refused("another")

        series.check_crossing = refused
        assert verifier_lists._widened(series, narrow, None, room) == narrow
