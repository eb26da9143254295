"""That a crossing of the beam itself is the first: what is proven, and that a broken step proves nothing."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from itertools import pairwise
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from flint import acb, arb, arb_mat

import freebeam as fb
import freebeam_kernels.beck as beck
import freebeam_kernels.euler_pinned as euler
import freebeam_kernels.free_free as free_free
from freebeam_derive.certify import beam_cells, beam_itself, beam_stability
from freebeam_derive.certify.balls import Unproven, precision
from freebeam_derive.certify.beam import Beam
from freebeam_derive.certify.beam_itself import ExactCrossing
from freebeam_derive.certify.beam_stability import complete, complete_to
from freebeam_derive.certify.complete_spectrum import _Circle, counted_to
from freebeam_derive.certify.exact_system import ExactSystem
from freebeam_derive.certify.local_series import Local
from freebeam_derive.certify.strips import Strips

NONE, HALF = Fraction(0), Fraction(1, 2)
Asked = tuple[Beam, ExactCrossing, Fraction, Fraction, Fraction | None]


def undamped(kernel: Any, load: float, frequency: float, **own: Fraction) -> Asked:
    beam = Beam(kernel, own)
    return beam, beam_itself.flutter_undamped(beam, (load, frequency), 30), NONE, NONE, None


def damped(kernel: Any, alpha: Fraction, beta: Fraction, load: float, frequency: float) -> Asked:
    beam = Beam(kernel)
    return beam, beam_itself.flutter_damped(beam, alpha, beta, (load, frequency), 30), alpha, beta, None


def static(kernel: Any, load: float, alpha: Fraction = NONE, beta: Fraction = NONE, **own: Fraction) -> Asked:
    beam = Beam(kernel, own)
    return beam, beam_itself.divergence(beam, load, 30), alpha, beta, None


def limit(kernel: Any, kappa: Fraction, load: float, frequency: float) -> Asked:
    beam = Beam(kernel)
    return beam, beam_itself.flutter_limit(beam, kappa, (load, frequency), 30), NONE, NONE, kappa


FIRST: dict[str, Callable[[], Asked]] = {
    "the paper's beam": lambda: undamped(free_free, 109.69, 23.07),
    "Beck": lambda: undamped(beck, 20.05, 11.02),
    "sub-tangential, flutter": lambda: undamped(beck, 16.108, 7.76, eta=Fraction(11, 20)),
    "sub-tangential, divergence": lambda: static(beck, 4.055, eta=Fraction(3, 10)),
    "Euler": lambda: static(euler, 9.87),
    "Euler, damped": lambda: static(euler, 9.87, Fraction(1, 100), Fraction(1, 10)),
    "Beck, damped": lambda: damped(beck, Fraction(1, 100), HALF, 16.188, 7.05),
    "Beck, damped outside": lambda: damped(beck, NONE, HALF, 20.064, 11.01),
    "Beck, heavily damped": lambda: damped(beck, Fraction(1, 10), NONE, 13.639, 5.505),
    "Beck, hardly damped": lambda: damped(beck, Fraction(1, 10**9), NONE, 10.9388, 5.3986),
    "Beck, vanishing damping": lambda: limit(beck, NONE, 10.9388, 5.3986),
}


@pytest.mark.parametrize("name", FIRST)
def test_the_first_loss_of_stability_of_the_beam_itself_is_proven(name: str) -> None:
    beam, crossing, *damping = FIRST[name]()
    found, evidence, missing = complete(beam, crossing, *damping)
    assert missing == "" and evidence is not None and all(vars(found.proof).values())
    assert (found.load, found.frequency) == (crossing.load, crossing.frequency)
    assert evidence.reach > Fraction(float(crossing.load))
    whole = [evidence.stretches[0].start, *(s.end for s in evidence.stretches)]
    assert [s.start for s in evidence.stretches] == whole[:-1] and whole[0] == 0
    if damping == [NONE, NONE, None]:
        assert abs(float(whole[-1]) - float(crossing.load)) < 1e-12
        assert evidence.cells == evidence.frequency == 0  # it needs none
    else:
        assert evidence.cells > 0 and evidence.frequency > 0


LATER: dict[str, Callable[[], Asked]] = {
    "Euler's second load": lambda: static(euler, 39.478),
    "Euler's second load, damped": lambda: static(euler, 39.478, Fraction(1, 100), HALF),
    "flutter of Beck's column beyond its divergence": lambda: undamped(beck, *second(), eta=Fraction(2, 5)),
    "Beck's column at vanishing damping, though there is damping": lambda: (
        *undamped(beck, 20.05, 11.02)[:2], NONE, NONE, NONE
    ),
    "Beck's column without damping, though there is some": lambda: (
        *undamped(beck, 20.05, 11.02)[:2], Fraction(1, 100), NONE, None
    ),
}  # fmt: skip


def second() -> tuple[float, float]:
    """Where two frequencies of the column with η = 2/5 meet, roughly."""
    basis = beck.basis(24)
    E, H, M = beck.stiffness_elastic(basis), beck.stiffness_load(basis, eta=0.4), beck.mass(basis)
    for P in np.arange(14.0, 40.0, 0.01):
        values = np.linalg.eigvals(np.linalg.solve(M, E + P * H))
        pair = values[np.abs(values.imag) > 0.1]
        if len(pair):
            return float(P), float(np.sqrt(pair[0].real))
    raise AssertionError


@pytest.mark.parametrize("name", LATER)
def test_what_is_not_the_first_is_not_said_to_be(name: str) -> None:
    beam, crossing, *damping = LATER[name]()
    found, evidence, missing = complete(beam, crossing, *damping)
    assert found == crossing and not found.proof.first and not found.proof.stable_below
    assert evidence is None and missing


# ------------------------------------------------------------ broken steps


def refused(asked: Asked) -> str:
    found, evidence, missing = complete(*asked)
    assert evidence is None and not found.proof.first
    return missing


def test_a_strip_moved_over_an_eigenvalue_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    asked = FIRST["Beck"]()
    right = Strips.line
    monkeypatch.setattr(beam_stability, "COUNTS", (40,))
    for k in (2, 20):
        monkeypatch.setattr(Strips, "line", lambda self, n, k=k: self.modes.gamma[k] ** 4 if n == k else right(self, n))
        assert refused(asked).startswith("strips")


def test_too_few_lowest_eigenvalues_are_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    """With m = 1 the line is not free; taken for free, one change of sign cannot be had up to the flutter load."""
    asked = FIRST["Beck"]()
    monkeypatch.setattr(
        beam_stability, "strips_for", lambda beam, load, growing: (Strips(beam.kernel, beam.own), 1, load)
    )
    assert refused(asked).startswith("low frequencies")


def test_a_sign_that_is_not_known_is_none(monkeypatch: pytest.MonkeyPatch) -> None:
    asked = FIRST["Beck"]()
    monkeypatch.setattr(beam_stability.Below, "sign", lambda self, low, high, s: 0)
    assert refused(asked).startswith("low frequencies")
    monkeypatch.setattr(beam_stability.Below, "sign", lambda self, low, high, s: 1)
    assert refused(asked).startswith("low frequencies")


def test_a_line_through_the_crossing_of_unknown_direction_proves_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    asked = FIRST["Beck"]()
    right = beam_stability.Below._rising
    for wrong in (lambda *given: 0, lambda *given: -right(*given)):
        monkeypatch.setattr(beam_stability.Below, "_rising", wrong)
        assert refused(asked).startswith("low frequencies: those just below")


def test_a_cell_with_another_crossing_is_not_excluded(monkeypatch: pytest.MonkeyPatch) -> None:
    """Beck's column with this damping has a second crossing, P = 110.9 and ω = 20.7 (freebeam critical --all)."""
    monkeypatch.setattr(beam_cells, "MOST_CUTS", 2)
    beam, crossing, alpha, beta, _ = FIRST["Beck, damped"]()
    problem = beam_itself.Damped(beam, alpha, beta)
    with precision(beam_stability.BITS):
        there, away = [+crossing.load, +crossing.frequency], [arb(60), arb(15)]
        proof = beam_cells.Cells(beam, 0, arb(112), [there])
        first, second, third = (
            tuple((Fraction(a), Fraction(b)) for a, b in place)
            for place in (((13, 17), (6, 8)), ((108, 112), (20, 21)), ((108, 112), (22, 24)))
        )
        proof._tile(problem, *first, 0)
        proof._tile(problem, *third, 0)
        assert proof._checked > 0
        for place, known in ((second, there), (first, away)):
            proof.known = [known]
            with pytest.raises(beam_cells.OpenStep, match="cells: that there is no other crossing"):
                proof._tile(problem, *place, 0)


def test_a_cell_that_is_left_out_is_missed(monkeypatch: pytest.MonkeyPatch) -> None:
    """Cells are counted by their areas, in fractions: whichever half is dropped, they do not cover all."""
    halves, asked = beam_cells._halves, static(beck, 2.4674, beta=HALF, eta=NONE)
    assert complete(*asked)[1] is not None
    for kept in (0, 1):
        monkeypatch.setattr(beam_cells, "_halves", lambda side, kept=kept: [halves(side)[kept]])
        assert refused(asked).startswith("cells: they do not cover all loads and frequencies")


def test_where_few_bits_do_not_tell_a_series_is_taken_to_all(monkeypatch: pytest.MonkeyPatch) -> None:
    asked, taken = static(beck, 2.4674, beta=HALF, eta=NONE), []
    right = beam_cells.Cells._with_one_series

    def seen(self: Any, problem: Any, P: Any, x: Any, degree: Any, bits: Any) -> bool:
        taken.append((bits, right(self, problem, P, x, degree, bits)))
        return taken[-1][1]

    monkeypatch.setattr(beam_cells, "BITS_OF_SERIES", 8)
    monkeypatch.setattr(beam_cells.Cells, "_with_one_series", seen)
    assert complete(*asked)[1] is not None
    assert (8, False) in taken and (None, True) in taken


def test_the_estimate_of_high_modes_is_needed_with_internal_damping_alone() -> None:
    with precision(beam_stability.BITS):
        beam = Beam(beck)
        load = arb(20)
        few, many = (beam_stability.strips_for(beam, load, grows)[1] for grows in (None, arb(0)))
        assert few < many
        for grows in (arb(0), arb(5000)):  # up to there motions are not damped
            strips, m, reach = beam_stability.strips_for(beam, load, grows)
            # sup |s'| P < R_{m} less that, by Cauchy's estimate over the disc that is left
            slope = 2 / arb.pi() * (strips.line(m + 1) - strips.line(m)) / (reach - load)
            assert slope * load < strips.line(m) - grows


@pytest.mark.parametrize("vanishing", [True, False])
def test_cells_reach_to_a_frequency(vanishing: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    """Their second unknown is its square where damping vanishes."""
    gaps = SimpleNamespace(gaps=SimpleNamespace(count=5), lowest=3, reach=arb(9), top=arb(400))
    below = SimpleNamespace(
        real_and_simple_throughout=lambda: [], no_divergence=lambda _: None, real_and_simple_at=lambda _: None
    )
    for name, value in (
        ("damped_gaps", gaps), ("Below", below), ("VanishingRates", None), ("Damped", None),
        ("Cells", SimpleNamespace(no_other_zero=lambda problem, top: 7 if top == 400 else 0)),
    ):  # fmt: skip
        monkeypatch.setattr(beam_stability, name, lambda *_, value=value: value)
    system: Any = SimpleNamespace(dampings=(0, 0), vanishing=vanishing, undamped=lambda *_: False, still=lambda: None)
    crossing: Any = SimpleNamespace(load=arb(8), frequency=arb(2), kind="flutter")
    with precision(64):
        found = beam_stability._prove_of_any(system, crossing)
    assert (found.frequency, found.cells, found.lowest) == (20 if vanishing else 400, 7, 3)


def test_no_crossing_is_beyond_the_highest_frequency() -> None:
    """Eigenvalues of a long series on the boundary's side of it: Re s > R_m, or none at all."""
    on_foundation = Beam(
        fb.column("foundation").kernel, {"k": Fraction(100)}
    )  # here C = alpha E + (beta − 100 alpha) M
    for beam, alpha, beta in (
        (Beam(beck), Fraction(1, 10), NONE),
        (Beam(beck), Fraction(1, 1000), HALF),
        (Beam(beck), Fraction(3), HALF),
        (on_foundation, Fraction(1, 100), NONE),
        (on_foundation, Fraction(1, 10), NONE),
    ):
        with precision(beam_stability.BITS):
            strips, m, _ = beam_stability.strips_for(beam, arb(20), arb(0))
            proof = beam_stability.Below(beam, strips, m, arb(20))
            top = proof.highest_frequency(*beam.damping(alpha, beta))
            w = top * arb("1.001")
            p, s, *_ = beam.pencil(arb(20), acb(0, w), alpha, beta)
            none = abs(p) * strips.B.norm(arb(0)) * arb(2).sqrt() < 1 and s.real < abs(s.imag)
            assert s.real > strips.line(m) or none


def test_what_the_foundation_has_no_damping_for_is_damped_inside() -> None:
    """Internal damping alpha of the beam, of which a foundation has none: c_M = beta − alpha k < 0; by two routes."""
    found = fb.exact_load(fb.column("foundation"), "0.01", "0.1", k=100, digits=10)
    assert all(found.proof.values())
    assert Fraction(found.load[0]) < Fraction("13.0572701169") + Fraction(1, 10**10)
    assert Fraction("13.0572701169") - Fraction(1, 10**10) < Fraction(found.load[1])


def test_a_motion_that_is_not_damped_without_load_is_found() -> None:
    """Beck's lowest frequency squared is 12.36 there."""
    beam = Beam(beck)
    with precision(beam_stability.BITS):
        proof = beam_stability.Below(beam, Strips(beck, {}), 3, arb(20))
        proof.above(arb("12.3"))
        for undamped in ("12.4", "300", "600"):
            with pytest.raises(Unproven, match="known to damp the lowest frequency"):
                proof.above(arb(undamped))


def test_columns_that_are_not_served_are_named() -> None:
    crossing = FIRST["Euler"]()[1]
    shears = ExactSystem(fb.column("timoshenko").kernel, {})
    missing = complete(shears, crossing, NONE, NONE)[2]
    assert missing.startswith("frequency gaps: timoshenko has more than the one deflection")


def test_the_touch_at_one_half_is_left_open() -> None:
    """ω² falls to zero at π² and rises again: F(P, 0) has no sign there. `beam_crossings` knows it by a closed form."""
    assert "between the loads 9.8" in refused(undamped(beck, 16.0525, 7.055, eta=HALF))


# ------------------------------------------------------------ complete spectra


def test_a_spectrum_is_complete_up_to_the_first_that_is_missing(monkeypatch: pytest.MonkeyPatch) -> None:
    """Without load eigenvalues are known: λ² + βλ + γ⁴ = 0. No circle is needed."""
    monkeypatch.setattr(beam_stability, "counted_to", None)
    beam = Beam(beck)
    with precision(128):
        gamma = Strips(beck, {}, 40).modes.gamma[:6]
        known = []
        for g in gamma:
            root = (g**4 - arb(1) / 16).sqrt()
            known += [acb(-0.25, root), acb(-0.25, -root)]
    top, missing = complete_to(beam, NONE, NONE, HALF, known)
    assert missing == "" and top is not None and abs(known[-1]) < top < gamma[-1] ** 2 * 2
    for lost in range(12):
        fewer, _ = complete_to(beam, NONE, NONE, HALF, known[:lost] + known[lost + 1 :])
        assert fewer is None or fewer < abs(known[lost])
    assert complete_to(beam, Fraction(20), NONE, HALF, known[:2])[1] == "fewer than the 4 lowest are known"
    # with much damping, where λ² alone would take one of them for a slower one
    known = with_damping(0, 400, 6)
    fewer, _ = complete_to(beam, NONE, NONE, Fraction(400), known[:4] + known[6:])
    assert fewer is None or fewer < min(abs(known[4]), abs(known[5]))


def with_damping(alpha: float, beta: float, count: int) -> list[acb]:
    """Eigenvalues of Beck's column without load, λ² + (β + αγ⁴) λ + γ⁴ = 0."""
    known = []
    for g in Strips(beck, {}, 40).modes.gamma[:count]:
        half = (arb(beta) + arb(alpha) * g**4) / 2
        root = acb(half * half - g**4).sqrt()
        known += [-half + root, -half - root]
    return known


def test_a_circle_holds_as_many_eigenvalues_as_are_known_without_load() -> None:
    with precision(192):
        beam, known = Beam(beck), with_damping(1 / 64, 0.5, 12)
        circle = _Circle(beam, NONE, Fraction(1, 64), HALF)
        for radius in (2, 10):
            assert circle.zeros(arb(radius)) == sum(bool(abs(v) < radius) for v in known)
        with pytest.raises(Unproven, match="accumulate"):
            circle.zeros(arb(65))
        free = _Circle(Beam(free_free), NONE, Fraction(1, 64), HALF)  # rigid: 0 and −β, twice each
        assert [free.zeros(arb(r)) for r in (0.25, 1)] == [2, 4] == [free.inside([], arb(r)) for r in (0.25, 1)]
        driven = _Circle(Beam(free_free), NONE, NONE, Fraction(-124))  # two at 124, and bending ones from 4.2 on
        assert driven.zeros(arb(3)) == 2 == driven.inside([], arb(3)) and driven.inside([], arb(125)) == 4


def test_a_rigid_motion_that_is_listed_is_counted_once() -> None:
    """λ = 0 and −β, twice each, are in the count whether they are among the known or not, and nothing else is."""
    circle = _Circle(Beam(free_free), NONE, Fraction(1, 64), HALF)
    rigid, others = [acb(0), acb(arb(-1) / 2)], [acb(0, 3), acb(0, -3), acb(-0.25), acb(1), acb(9)]
    for radius, still in ((arb("0.3"), 2), (arb(2), 4), (arb(5), 4)):
        for known in (others, [*others, *rigid], [*rigid, *rigid, *others]):
            assert circle.inside(known, radius) == still + sum(bool(abs(value) < radius) for value in others)


def test_circles_go_between_eigenvalues_and_a_little_beyond_the_last() -> None:
    circle = object.__new__(_Circle)
    circle.c_E = arb(0)
    for sizes in ((0.1, 0.2, 0.4), (30, 50, 51, 90), (0.2, 7, 7, 900)):
        radii = [float(r) for r in circle.radii([acb(0, size) for size in sizes])]
        assert sizes[-1] < radii[0] < 1.1 * sizes[-1]
        apart = sorted({*sizes})
        assert all(low < r < high for r, (low, high) in zip(radii[:0:-1], pairwise(apart), strict=True))


def test_what_turns_on_a_circle_is_a_function_and_its_derivative() -> None:
    with precision(192):
        circle = _Circle(Beam(beck), Fraction(10), Fraction(1, 64), HALF)
        radius, turn, h = arb(5), arb("0.3"), arb(2) ** -40
        series = circle._series(radius, turn - h, turn + h, 2**30)
        assert series is not None
        at = radius * acb(turn.cos_pi(), turn.sin_pi())
        _, slope = circle._value(series, at)
        ends = [circle._value(series, at + side * h)[0] for side in (1, -1)]
        assert abs((ends[0] - ends[1]) / (2 * h) - slope) < 1e-15 * abs(slope)


def test_with_internal_damping_a_spectrum_lacks_none_up_to_what_is_said() -> None:
    with precision(192):
        known = with_damping(1 / 64, 0.5, 1)
    beam = Beam(beck)
    top, missing = counted_to(beam, NONE, Fraction(1, 64), HALF, known)
    assert missing == "" and top is not None and top > abs(known[-1])
    fewer, why = counted_to(beam, NONE, Fraction(1, 64), HALF, known[1:])
    assert fewer is None and why.startswith("of 2 with")


def test_a_spectrum_near_a_coalescence_lacks_none() -> None:
    """Few modes see a complex pair where the beam has two frequencies 0.008 apart; polynomials do not."""
    found = fb.exact_spectrum(fb.column("beck", "modes"), "20.05095", digits=10, modes=4)
    assert {low[1][:8] for low in found.lower} >= {"11.01142", "11.01969"} and found.unproven == ()
    assert found.complete_to is not None and float(found.complete_to) > 112.4 and len(found.lower) == 8


# ------------------------------------------------------------ one series for a box


@pytest.mark.parametrize(
    ("p", "s"),
    [
        (arb(50, 25), arb(5000, 800)),
        (acb(arb(50, 25), arb(1, 1)), acb(arb(50000, 5000), arb(300, 300))),
        (arb(0, 5), arb(0, 90)),
    ],
    ids=["real", "complex", "about zero"],
)
def test_a_series_on_a_box_holds_the_function_and_its_derivatives(p: Any, s: Any) -> None:
    orders = ((0, 0), (1, 0), (0, 1), (1, 1), (0, 2), (2, 0))
    random = np.random.default_rng(1)
    with precision(128):
        beam = Beam(free_free)
        local = Local(beam, p, s)

        def within(side: Any) -> Any:
            a, b = random.uniform(-0.99, 0.99, 2)
            if isinstance(side, acb):
                return acb(side.real.mid() + side.real.rad() * float(a), side.imag.mid() + side.imag.rad() * float(b))
            return side.mid() + side.rad() * float(a)

        for _ in range(4):
            point = within(p), within(s)
            ours, theirs = local.taylor(*point, orders), beam.taylor(*point, orders)
            assert all(ours[order].contains(theirs[order].mid()) for order in orders)
            assert abs(ours[0, 0] - theirs[0, 0]) < 1e-2 * abs(theirs[0, 0]) + arb("1e-6")
        with pytest.raises(Unproven, match="outside of the box"):
            local.taylor(p.mid() + 100, s.mid(), ((0, 0),))


@pytest.mark.parametrize(("slope", "excluded"), [(2, True), (1, True), (0, False), (-1, True)])
def test_at_the_bottom_of_a_damped_column_the_imaginary_part_excludes_by_its_slope(slope: int, excluded: bool) -> None:
    """It is nothing at ω = 0 alone, where it does not stand still; of other columns no such thing is said."""
    cells = object.__new__(beam_cells.Cells)
    cells.rigid, cells.load = 1, arb(1)
    J = arb_mat([[arb(0), arb(0)], [arb(0), arb(slope)]])
    for kind in (beam_itself.Damped, object):
        problem: Any = type("Problem", (kind,), {
            "__init__": lambda self: None, "beam": None, "value": lambda self, z: [arb(0)] * 2,
            "slopes": lambda self, z: ([arb(0)] * 2, J, None),
        })()  # fmt: skip
        with precision(64):
            way = cells._excluded_at_bottom(problem, arb("1.1", "0.2"), arb(0))
        assert (way is None) == (excluded and kind is beam_itself.Damped)


@pytest.mark.parametrize("place", range(2))
def test_a_cell_with_a_zero_at_its_bottom_is_not_excluded(place: int) -> None:
    """One equation is P = 1, the other holds everywhere: seen by the slope in P, where the middle alone is no zero."""

    class Problem:
        beam = None

        def value(self, z: list[Any]) -> list[arb]:
            return [z[0] - 1 if k == place else arb(0) for k in range(2)]

        def slopes(self, z: list[Any]) -> tuple[list[arb], arb_mat, None]:
            return self.value(z), arb_mat([[arb(k == place), arb(0)] for k in range(2)]), None

    cells = object.__new__(beam_cells.Cells)
    cells.rigid, cells.load = 1, arb(1)
    with precision(64):
        for P, excluded in ((arb("1.1", "0.2"), False), (arb("1.5", "0.2"), True)):
            way = cells._excluded_at_bottom(Problem(), P, arb(0))  # type: ignore[arg-type]
            assert (way is None) == excluded


@pytest.mark.parametrize(("other", "single"), [(-1, True), (0.99, False)])
def test_a_divergence_just_below_another_is_seen(other: float, single: bool) -> None:
    """F = (P − 1)(P − other) − 2 s P: its zeros at s = 0 count, and not how F goes elsewhere."""

    class Beam:
        def taylor(self, P: arb, s: arb, orders: tuple[tuple[int, int], ...]) -> dict[tuple[int, int], arb]:
            terms = {(0, 0): (P - 1) * (P - other) - 2 * s * P, (1, 0): 2 * P - 1 - other - 2 * s, (0, 1): -2 * P}
            return {pair: terms.get(pair, arb({(2, 0): 1, (1, 1): -2}.get(pair, 0))) for pair in orders}

    proof = object.__new__(beam_stability.Below)
    proof.beam, proof.load, proof.trivial = Beam(), arb(1), 0  # type: ignore[assignment]

    def sign(low: arb, high: arb, s: arb) -> int:
        value = Beam().taylor(low.union(high), s, ((0, 0),))[0, 0]
        return 1 if value > 0 else -1 if value < 0 else 0

    proof.sign = sign  # type: ignore[assignment, method-assign]
    with precision(64):
        if single:
            proof.no_divergence("divergence")
        else:
            with pytest.raises(Unproven, match=r"is not known to differ from zero at the load 0\.98"):
                proof.no_divergence("divergence")


def test_zeros_near_a_circle_are_counted_on_their_side(monkeypatch: pytest.MonkeyPatch) -> None:
    """f = (λ − a)(λ − ā), a just within the circle or just outside it, at any angle: 2, 0, or not known."""
    random, counted = np.random.default_rng(5), []
    circle = object.__new__(_Circle)
    for _ in range(60):
        off = float(random.choice([-1, 1]) * 10 ** random.uniform(-4.5, -0.5))
        a = (1 + off) * np.exp(1j * np.pi * random.uniform(0, 1))
        b, c = arb(2 * a.real), arb(abs(a) ** 2)
        circle.c_E, circle._made = arb(0), 0
        monkeypatch.setattr(circle, "_series", lambda *_: SimpleNamespace(arcs=10**9))
        monkeypatch.setattr(circle, "_value", lambda _, z, b=b, c=c: (z * z - b * z + c, 2 * z - b))
        with precision(64):
            try:
                counted.append(circle.zeros(arb(1)) == (2 if off < 0 else 0))
            except Unproven:
                continue
    assert all(counted) and len(counted) > 40
