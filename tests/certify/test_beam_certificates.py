"""Certificates of the beam itself: accepted as written, refused where they claim what is not so; and the verifier's own
function, entries and bounds beside those of the prover."""

from __future__ import annotations

import json
from copy import deepcopy
from fractions import Fraction
from functools import cache
from itertools import combinations_with_replacement, product
from math import comb, factorial, perm
from types import SimpleNamespace
from typing import Any

import flint
import numpy as np
import pytest
from flint import acb, arb, arb_poly, fmpq, fmpq_poly

import freebeam as fb
import freebeam_kernels.beck as beck
import freebeam_kernels.free_free as free_free
from freebeam_derive.certify import (
    beam_cells,
    beam_stability,
    strips,
    verifier,
    verifier_cells,
    verifier_of_beam,
    verifier_signs,
)
from freebeam_derive.certify.balls import precision
from freebeam_derive.certify.beam import Beam
from freebeam_derive.certify.beam_itself import Coalescence, Damped, VanishingDamping, flutter_damped
from freebeam_derive.certify.comparison_form import bounds as of_modes_beyond
from freebeam_derive.certify.strips import modes_of
from freebeam_derive.certify.verifier_boxes import Box
from freebeam_derive.certify.verifier_cells import Cells
from freebeam_derive.certify.verifier_claims import ORDERS, Form, Refused, form, greatest
from freebeam_derive.certify.verifier_equations import Equations
from freebeam_derive.certify.verifier_lines import Lines, Norms, check_rigid
from freebeam_derive.certify.verifier_of_beam import Bounds
from freebeam_derive.certify.verifier_shooting import Part, Shooting, majorants
from tests.front.test_proofs import run

Data = dict[str, Any]
CASES: dict[str, tuple[str, dict[str, Any]]] = {
    "Beck": ("beck", {}),
    "dead load": ("beck", {"eta": "0"}),
    "dead load, limit": ("beck", {"eta": "0", "kappa": 2}),
    "dead load, damped": ("beck", {"eta": "0", "beta": "0.5"}),
    "Beck, damped": ("beck", {"alpha": "0.01"}),
    "foundation, damped": ("foundation", {"k": "100", "alpha": "0.01", "beta": "0.1"}),  # C = 0.01 E - 0.9 M
}


@cache
def found(case: str) -> Any:
    """Proven as a whole; but of two the prover's cells are left out, for the verifier makes its own."""
    name, given = CASES[case]
    with pytest.MonkeyPatch.context() as to:
        to.setattr(beam_stability, "COUNTS", (40, 40))  # more modes would only take the verifier's time here
        if case in ("Beck, damped", "foundation, damped"):
            to.setattr(beam_cells.Cells, "no_other_zero", lambda *_: 1)
        return fb.exact_load(fb.column(name), digits=20, **given)


def certificate(case: str) -> Data:
    data: Data = json.loads(json.dumps(found(case).unverified))
    return data


CROSSING = (Fraction("20.0509536189737612214072583"), Fraction("20.0509536189737612214072584"))  # of Beck's column


@cache
def bounds(ends: tuple[str, str]) -> Bounds:
    return Bounds(ends)


@cache
def shooting(ends: tuple[str, ...], E: Form, H: Form, moved: tuple[Form, ...] = ()) -> Shooting:
    return Shooting(list(ends), E, H, moved)


@pytest.fixture(autouse=True)
def computed_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """What follows from ends and forms alone, for all the forgeries that leave these."""
    monkeypatch.setattr(verifier_of_beam, "Bounds", bounds)
    monkeypatch.setattr(verifier_of_beam, "Shooting", lambda ends, *forms: shooting(tuple(ends), *forms))


def verify(data: Data) -> Any:
    return verifier.verify(data, verifier_of_beam.FORMATS)


def refused(data: Data, match: str) -> None:
    with pytest.raises(Refused, match=match):
        verify(data)


@pytest.mark.parametrize("case", CASES)
def test_a_certificate_is_accepted_as_it_was_written(case: str) -> None:
    stated, proven = verify(certificate(case)), found(case)
    assert stated.kind == proven.kind
    assert stated.load[0] < Fraction(proven.load[1]) and Fraction(proven.load[0]) < stated.load[1]
    assert "the beam itself" in str(stated) and "it is the first over all modes" in str(stated)
    assert stated.record()["of"].startswith("the beam itself")


def forged(case: str, **changes: Any) -> Data:
    return certificate(case) | changes


def shifted(pair: list[str], factor: str) -> list[str]:
    return [str(Fraction(v) * Fraction(factor)) for v in pair]


def test_a_claim_that_is_moved_is_refused() -> None:
    data = certificate("Beck")
    refused(forged("Beck", load=shifted(data["load"], "1.0001")), "no crossing in the interval")
    refused(
        forged("Beck", frequency_squared=shifted(data["frequency_squared"], "1.0001")), "no crossing in the interval"
    )
    refused(forged("Beck", load=shifted(data["load"], "2")), "not known to be free")
    refused(forged("Beck", kind="divergence", frequency_squared=None), "no crossing in the interval")
    refused(forged("Beck", alpha="0.1"), "damping does not fit")
    refused(forged("Beck", proof=data["proof"] | {"first": False}), "what is said to be proven")
    refused(forged("dead load", kind="flutter", frequency_squared=["100", "101"]), "no crossing in the interval")


def test_an_interval_that_ends_a_hair_short_of_the_crossing_is_refused() -> None:
    """A ball about it is wider than the interval by rounding, and holds the crossing."""
    data, (low, high) = certificate("Beck"), CROSSING
    width = Fraction(1, 10**12)
    for ends, accepted in (
        ((low - width / 10**11, high + width), True),
        ((high + width / 10**11, high + width), False),
    ):
        forged = data | {"load": [str(v) for v in ends]}
        forged["stretches"][-1]["end"] = str(ends[1])
        if accepted:
            assert verify(forged).load == ends
        else:
            refused(forged, "no crossing in the interval")


def test_lines_that_are_not_free_are_refused() -> None:
    """A strip moved over an eigenvalue: one line less, and one mode more left of the first."""
    data = certificate("Beck")
    for lowest in (1, 3):
        changed = forged("Beck", lowest=lowest)
        for stretch in changed["stretches"]:
            if lowest == 1:
                del stretch["points"][1]
            else:
                stretch["points"].append(str(2 * Fraction(stretch["points"][-1])))
        refused(changed, "not known to be free|not known to change sign|moves")
    refused(forged("Beck", modes=6), "more modes are needed|not known to be free|too low")
    assert data["modes"] >= 40


def test_stretches_and_points_that_are_altered_are_refused() -> None:
    def altered(change: Any) -> Data:
        data = certificate("Beck")
        change(data["stretches"])
        return data

    refused(altered(lambda s: s.pop(0)), "leave a gap")
    refused(altered(lambda s: s.pop(1)), "leave a gap")
    refused(altered(lambda s: s.pop()), "moves that should not, or does not")
    refused(altered(lambda s: s[0]["points"].__setitem__(1, "1400")), "not known to change sign")
    refused(altered(lambda s: s[0]["points"].__setitem__(1, "5")), "not known to change sign")
    refused(altered(lambda s: s[0]["points"].__setitem__(2, "1600")), "beyond the line that is free")
    refused(altered(lambda s: s[0]["points"].__setitem__(0, "1")), "too few points")
    refused(altered(lambda s: s[-1].update(slope="100")), "not known on the line|does not stay")
    refused(altered(lambda s: s[-1].update(moving=None)), "moves that should not, or does not")
    refused(altered(lambda s: s[-1].update(moving=0)), "another point moves|not known to change sign")
    refused(altered(lambda s: s[0].update(moving=1)), "moves that should not")
    refused(altered(lambda s: s[0].update(start="1")), "leave a gap")


def test_forms_that_are_not_the_columns_are_refused() -> None:
    data = certificate("Beck")
    half = deepcopy(data["forms"])
    half["H"]["along"][0][3] = "-1/2"
    refused(forged("Beck", forms=half), "the form H is not those of the column")
    refused(forged("Beck", forms=half, column="another"), "no crossing in the interval")
    free = forged("Beck", ends=["free", "free"], column="another")
    refused(free, "rigid motions")
    heavy = deepcopy(data["forms"])
    heavy["M"]["along"].append([0, 1, 1, "1"])
    refused(forged("Beck", forms=heavy, column="another"), "the mass is not")
    stated = verify(forged("Beck", column="another"))
    assert not stated.ours and "that they are its is not checked" in str(stated)


def test_the_second_load_of_a_column_is_not_certified_as_the_first() -> None:
    """Of the dead load: 9 times the first, (3π/2)²."""
    for case in ("dead load", "dead load, limit"):
        data = certificate(case)
        second = forged(case, load=shifted(data["load"], "9"), lowest=2)
        point = data["stretches"][-1]["points"][-1]
        for stretch in second["stretches"]:
            stretch["points"] = ["0", "300", "1500"] if float(Fraction(point)) < 1500 else stretch["points"]
        second["stretches"][-1]["end"] = second["load"][0]
        refused(second, "not known|s does not fall")


def test_another_crossing_in_a_cell_is_not_overlooked(monkeypatch: pytest.MonkeyPatch) -> None:
    """As of the prover: Beck's column with damping and its second crossing at P = 110.9, ω = 20.7."""
    monkeypatch.setattr(verifier_cells, "MOST_CUTS", 1)
    alpha, beta = Fraction(1, 100), Fraction(1, 2)
    first = flutter_damped(Beam(beck), alpha, beta, (16.188, 7.05), 20)
    equations = Equations(Shooting(*of_kernel(beck)), 0, (alpha, alpha), (beta, beta), False)
    there, around = [first.load, first.frequency], ((15, 17), (Fraction(13, 2), Fraction(15, 2)))
    again = (Fraction(1104, 10), Fraction(1114, 10)), (Fraction(205, 10), Fraction(209, 10))
    with flint.ctx.workprec(128):
        Cells(equations, Fraction(112), [there]).tile(*around, 0)
        for place, known in ((again, there), (around, [arb(60), arb(15)])):
            with pytest.raises(Refused, match="another crossing could be near"):
                Cells(equations, Fraction(112), [known]).tile(*place, 0)


# ------------------------------------------------------------ the verifier's own mathematics beside the prover's


def of_kernel(kernel: Any, **own: Fraction) -> tuple[list[str], Form, Form]:
    forms = kernel.forms(Fraction(1), **own)
    E, H = (
        form({
            "along": [[*key, str(Fraction(f))] for key, f in forms[name][0].items()],
            "points": [[*key, str(Fraction(f))] for key, f in forms[name][1].items()],
        })
        for name in "EH"
    )  # fmt: skip
    return list(kernel.COLUMN["ends"]), E, H


@pytest.mark.parametrize("kernel", [beck, free_free], ids=["beck", "free-free"])
def test_both_functions_have_the_same_zeros(kernel: Any) -> None:
    """Their quotient is one number for all p and s."""
    ends, E, H = of_kernel(kernel)
    quotients = []
    with flint.ctx.workprec(160):
        shooting, beam = Shooting(ends, E, H), Beam(kernel)
        for p, s in ((3, 50), (17.5, 400), (acb(8, 1), acb(30, -7)), (acb(90), acb(5000, 300))):
            p, s = acb(p), acb(s)
            ours = Box(shooting, p, s).value(p, s)
            quotients.append(ours / beam.taylor(p, s, ((0, 0),))[0, 0])
    assert all(q.overlaps(quotients[0]) and q.rad() < 1e-25 for q in quotients) and abs(quotients[0]) > 0


def test_a_box_holds_values_and_derivatives() -> None:
    """Those of a point are those of the prover's function, times the number that the two differ by."""
    ends, E, H = of_kernel(beck)
    random = np.random.default_rng(2)
    orders = ((0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2))
    with flint.ctx.workprec(128):
        shooting, beam = Shooting(ends, E, H), Beam(beck)
        p, s = acb(arb(15, 5), arb(1, 1)), acb(arb(300, 60), arb(5, 5))
        box, ratio = Box(shooting, p, s), None
        for a, b in random.uniform(-0.9, 0.9, (3, 2)):
            at = acb(15 + 5 * float(a), 1), acb(300 + 60 * float(b), 5)
            point, theirs = Box(shooting, *at), beam.taylor(*at, orders)
            ratio = ratio or point.value(*at) / theirs[0, 0]
            for i, j in orders:
                value = point.value(*at, i, j)
                assert value.overlaps(ratio * theirs[i, j]) and value.rad() < 1e-12 * (1 + abs(value))
                assert box.value(*at, i, j).overlaps(value)
            assert abs(box.value(*at) - point.value(*at)) < abs(point.value(*at)) / 1000
        with pytest.raises(ArithmeticError):
            box.value(acb(30), acb(300))


def test_what_the_polynomial_leaves_out_is_in_the_rest() -> None:
    """With few bits the rest is large, and holds the difference from the value with many."""
    ends, E, H = of_kernel(beck)
    with flint.ctx.workprec(40):
        coarse = Shooting(ends, E, H).on(arb(20), arb(400))
    with flint.ctx.workprec(300):
        whole = Shooting(ends, E, H).on(arb(20), arb(400))
        ratios = []
        for u, w in ((1, 1), (-1, 1), (0.5, -1), (0, 0.25)):
            values = []
            for one in (coarse, whole):
                p, s = u * 20 / one.P, w * 400 / one.S
                values.append(sum((one.levels[0][j, k].mid() * p**j * s**k for j in range(one.levels[0].nrows())
                                   for k in range(one.levels[0].ncols())), arb(0)))  # fmt: skip
            ratios.append(abs(values[0] - values[1]) / coarse.rest)
        assert all(r < 1 for r in ratios) and 0 < whole.rest < coarse.rest * arb(2) ** -200


def test_a_box_holds_all_that_the_rest_could_be() -> None:
    """F and any ε (p/P)^j (s/S)^k, with their derivatives, where the rest is ε."""
    ends, E, H = of_kernel(beck)
    with flint.ctx.workprec(128):
        shooting = Shooting(ends, E, H)
        p, s = acb(arb(15, 5), arb(1, 1)), acb(arb(300, 60), arb(5, 5))
        exact = Box(shooting, p, s)
        (whole,) = shooting._known.values()
        whole.rest = epsilon = arb("1e-6")
        box = Box(shooting, p, s)
        for x, y in ((acb(15, 1), acb(300, 5)), (acb(18, 1), acb(350, 5))):
            for i, j, a, b in ((0, 0, 0, 0), (0, 0, 3, 2), (1, 0, 4, 1), (0, 1, 1, 5), (1, 1, 2, 2), (2, 0, 6, 0)):
                change = comb(a, i) * comb(b, j) * epsilon * (x / whole.P) ** (a - i) * (y / whole.S) ** (b - j)
                change = change / (whole.P**i * whole.S**j)
                assert box.value(x, y, i, j).contains(exact.value(x, y, i, j) + change)


@pytest.mark.parametrize("ends", [*product(ORDERS, repeat=2)], ids="-".join)
def test_the_equation_and_its_conditions_are_the_weak_form(ends: tuple[str, str]) -> None:
    """Of any motion and any test function that the ends allow, E and H are what Shooting has: exactly."""
    x, one = fmpq_poly([0, 1]), fmpq_poly([1])
    E: Form = ((0, 2, 2, Fraction(1)), (1, 1, 1, Fraction(3)), (2, 0, 1, Fraction(-2)), (0, 0, 0, Fraction(5))), ()
    H: Form = (
        ((0, 1, 1, Fraction(-1)), (3, 1, 0, Fraction(4)), (0, 0, 1, Fraction(7)), (1, 0, 0, Fraction(1, 2))),
        ((1, 0, 1, 1, Fraction(2)), (0, 1, 0, 1, Fraction(-3)), (1, 1, 0, 0, Fraction(6)), (0, 0, 1, 0, Fraction(9))),
    )
    held = [(e, d) for e in (0, 1) for d in (0, 1) if d in ORDERS[ends[e]]]
    it, y = Shooting(list(ends), E, H), fmpq_poly([2, -1, 3, 1, 2, -1])
    v = fmpq_poly([1, 2, -1])
    for e, d in held:  # v and its slope are nothing where the motion's are held
        v = v * (x - e * one) ** (2 if d else 1)

    def of(f: Any, order: int) -> Any:
        for _ in range(order):
            f = f.derivative()
        return f

    def whole(f: Any) -> Any:
        return f.integral()(1)

    for which, (along, points) in enumerate((E, H)):
        wanted = sum((f.numerator * whole(x**k * of(v, i) * of(y, j)) / f.denominator for k, i, j, f in along), fmpq(0))
        wanted += sum((f.numerator * of(v, i)(a) * of(y, j)(b) / f.denominator for a, i, b, j, f in points), fmpq(0))
        found = whole(v * of(y, 4)) if which == 0 else fmpq(0)
        for (d, k), parts in it.terms.items():
            found += parts[which].numerator * whole(x**k * v * of(y, d)) / parts[which].denominator
        natural = [row for row in it.conditions if max(q for _, q in row) > 1]
        assert len(natural) == 4 - len(held) and len(it.conditions) == 4
        for row in natural:
            ((e, order),) = (
                at for at in row if at[1] > 1
            )  # the third derivative stands with v, the second with its slope
            for (b, q), f in row.items():
                found += fmpq(f[which].numerator, f[which].denominator) * of(v, 3 - order)(e) * of(y, q)(b)
        assert found == wanted


@pytest.mark.parametrize(("P", "s"), [(1e6, 1.0), (1.0, 1e11), (1.0, -1e11)])
def test_of_a_load_or_an_s_beyond_all_sense_no_series_is_begun(P: float, s: float) -> None:
    with flint.ctx.workprec(64), pytest.raises(ArithmeticError, match="the power series is too long"):
        Shooting(*of_kernel(beck)).whole(arb(P), arb(s), arb(1), 3)


def test_coefficients_that_are_left_out_go_to_the_rest() -> None:
    tiny = arb(2) ** -200
    with flint.ctx.workprec(64):
        part = Part([[arb_poly([1, tiny]), arb_poly([tiny])], [arb_poly([tiny])]], arb(1), tiny).short()
        assert [[row.length() for row in rows] for rows in part.levels] == [[1]] and part.rest >= 4 * tiny


@pytest.mark.parametrize("bits", [128, 2000])
def test_what_a_power_series_leaves_out_is_bounded_however_small_it_is(bits: int) -> None:
    """Of y⁗ = s y, the solution x^r + … has the coefficients s^k r!/(4k + r)!. Many bits are beyond all floats."""
    s = arb(300)
    with flint.ctx.workprec(bits + 64):
        sizes, rests = majorants([(0, 0, s)], bits)
        for r in range(4):
            first = (len(sizes[r]) - 1 - r) // 4 + 1
            for d in range(4):
                terms = (s**k * factorial(r) / factorial(4 * k + r - d) for k in range(first, first + 20))
                assert 0 < sum(terms, arb(0)) < rests[r][d]


@pytest.mark.parametrize("base", [2, 5])
def test_what_a_power_series_leaves_out_is_at_most_a_geometric_series(base: int) -> None:
    """Of coefficients that fall by the base the rest is top / (base − 1) at x = 1; of derivatives a little more."""
    with flint.ctx.workprec(192):
        sizes, rests = majorants([(0, 0, arb(300))], 128, base)
        for of_one, rest in zip(sizes, rests, strict=True):
            last = len(of_one) - 1
            top = greatest(of_one[last - i] / arb(base) ** i for i in range(4))
            for d, bound in enumerate(rest):
                falling = (perm(last + j, d) / arb(base) ** j for j in range(1, 300))
                ratio = bound / (top * sum(falling, arb(0)))
                assert abs(ratio - 1) < 1e-20 if d == 0 else 1 < ratio < 1.1


@pytest.mark.parametrize(("d", "k"), [(0, 0), (1, 0), (2, 3), (3, 1), (0, 2)])
def test_of_one_positive_factor_majorants_are_the_coefficients(d: int, k: int) -> None:
    """Of y⁗ = 7 x^k y^(d): integrated four times, from x^r on."""
    with flint.ctx.workprec(192):
        sizes, _ = majorants([(d, k, arb(7))], 64)
        for r, of_one in enumerate(sizes):
            term = whole = fmpq_poly([0] * r + [1])
            while term.degree() < len(of_one) and term != 0:
                for _ in range(d):
                    term = term.derivative()
                term = 7 * term * fmpq_poly([0] * k + [1])
                for _ in range(4):
                    term = term.integral()
                whole += term
            for n, size in enumerate(of_one):
                assert abs(size - arb(whole[n])) <= 1e-40 * size and (n > 3 or size == int(n == r))


FORMS: dict[str, tuple[dict[Any, int], dict[Any, int]]] = {
    "a weight": ({(0, 0, 0): 3}, {}),
    "a wind": ({(0, 0, 1): 2}, {}),
    "a tension that changes": ({(2, 1, 1): -1, (1, 1, 0): 4}, {}),
    "springs": ({}, {(0, 0, 0, 0): 2, (1, 1, 1, 1): 5}),
    "a follower": ({(0, 1, 1): -1}, {(1, 0, 1, 1): 1, (0, 1, 1, 0): -3}),
}


@pytest.mark.parametrize("ends", [*combinations_with_replacement(ORDERS, 2)], ids="-".join)
def test_both_bound_the_same_norms(ends: tuple[str, str]) -> None:
    """Two programs, one theorem, one number: of derivatives of each order along the beam and at its ends, and of so few
    modes that much is left to the tail."""
    with precision(128):
        modes, lines = modes_of(ends, 12, 128), Lines(list(ends), 12)
        for along, points in FORMS.values():
            one = strips.Form(modes, {key: arb(f) for key, f in along.items()}, {k: arb(f) for k, f in points.items()})
            other = Norms(lines, (
                tuple((*key, Fraction(f)) for key, f in along.items()),
                tuple((*key, Fraction(f)) for key, f in points.items()),
            ))  # fmt: skip
            for k in (0, 3):
                R = strips.Strips.line(SimpleNamespace(modes=modes), k)  # type: ignore[arg-type]
                assert lines.line(k).overlaps(R) and abs(other.on(k) - one.norm(R)) < 1e-12
            for k in (4, 9):
                assert abs(other.on_all_from(k) - one.beyond(k)) < 1e-12 * one.beyond(k)


@pytest.mark.parametrize("ends", [*combinations_with_replacement(ORDERS, 2)][1::3], ids="-".join)
def test_of_as_few_modes_as_may_be_both_bound_the_rest_alike(ends: tuple[str, str]) -> None:
    """Where e^−γ is no rounding error yet; with fewer neither has bounds."""
    with precision(128):
        few = 3 if ends == ("free", "clamped") else 2
        lines, bound = Lines(list(ends), few), of_modes_beyond(ends, modes_of(ends, few, 128).gamma[-1])
        for ours, theirs in ((lines.slope, bound.end[1]), (lines.stretch, bound.slope)):
            assert abs(ours - theirs) < 1e-30 and ours >= 1
        with pytest.raises(Refused, match="more modes are needed"):
            Lines(list(ends), few - 1)


@pytest.mark.parametrize(("i", "j"), [(2, 0), (0, 2), (2, 1), (2, 2)])
def test_forms_of_curvatures_are_no_loads(i: int, j: int) -> None:
    bending: Form = ((0, 2, 2, Fraction(1)),), ()
    for load in ((((0, i, j, Fraction(1)),), ()), ((), ((0, i, 1, j, Fraction(1)),))):
        with pytest.raises(Refused, match="a form acts on curvatures"):
            Shooting(["clamped", "free"], bending, load)


def test_both_end_the_frequencies_at_one_place() -> None:
    """Beyond which no eigenvalue on the axis is one of the m lowest: by the line, or by load and internal damping."""
    draw, ways, loaded = np.random.default_rng(2), {True: 0, False: 0, None: 0}, 0.6
    theirs: Any = object.__new__(strips.Strips)
    high: Any = object.__new__(verifier_of_beam.High)

    def norm(size: float) -> Any:
        return SimpleNamespace(norm=lambda R: arb(size), on=lambda k: arb(size))

    with precision(128):
        high.top, theirs.B, high.norms = arb(20000), norm(loaded), [(None, norm(loaded / 2)), (None, norm(loaded))]
        for soft in (0.0, 0.4, 0.8):
            theirs.softening, high._softening = norm(soft), [norm(soft), norm(soft / 2)]
            for _ in range(40):
                a, b, P = (
                    10 ** draw.uniform(-5, 1),
                    draw.uniform(-5, 5),
                    int(draw.integers(1, 60)) / draw.choice([1, 64]),
                )
                below: Any = SimpleNamespace(strips=theirs, R=high.top, load=arb(float(P)))
                equations: Any = SimpleNamespace(real=False, alpha=arb(a), beta=arb(b))
                rest = 1 - a * b - a * a * 20000
                by_line = (20000 / rest) ** 0.5 if rest > 0 else np.inf
                if soft == 0.8 and rest < 0:  # more than 1/√2, for any load
                    with pytest.raises(beam_cells.OpenStep, match="no bound is known"):
                        beam_stability.Below.highest_frequency(below, arb(a), arb(b))
                    with pytest.raises(Refused, match="no bound of the frequency"):
                        high.highest(equations, Fraction(P))
                    ways[None] += 1
                    continue
                w = float(beam_stability.Below.highest_frequency(below, arb(a), arb(b)))
                assert float(high.highest(equations, Fraction(P))) == pytest.approx(w, rel=1e-9)
                ways[by_line > w * (1 + 1e-9)] += 1
                # Re s ≥ R_m from there on, or Re s ≤ |Im s| and what load and softening do is less than 1/√2
                s = (w**2 - 1j * b * w) / (1 + 1j * a * w)
                felt = P / abs(1 + 1j * a * w) * loaded + soft
                assert s.real >= 20000 * (1 - 1e-9) or (s.real <= abs(s.imag) and felt <= 0.5**0.5)
    assert min(ways.values()) > 8


def test_of_high_modes_lines_are_free_in_the_disc_that_cauchys_estimate_takes(monkeypatch: pytest.MonkeyPatch) -> None:
    """|s'| P < R_m less what is not damped needs ρ with (ρ − P) π/2 (R_m − s₀) > P (R_{m+1} − R_m)."""
    asked: list[arb] = []
    monkeypatch.setattr(verifier_of_beam, "check_free", lambda m, rho, *_: asked.append(rho))
    high: Any = object.__new__(verifier_of_beam.High)
    high.m, high.norms, high.top = 3, [(None, None)], arb(100)
    high.lines = SimpleNamespace(line=lambda k: arb(100 if k == 3 else 260))
    with precision(128):
        for undamped, of_E in ((0, 1), (60, 1), (0, 0)):
            equations: Any = SimpleNamespace(of_E=(0, of_E), undamped_to=Fraction(undamped))
            high.check(Fraction(7), equations)
            rho = asked.pop()
            left = (rho - 7) * arb.pi() / 2 * (100 - undamped) - 7 * 160
            assert (left > 0 and left < 1) if of_E else rho == 7
        with pytest.raises(Refused, match="not known to be damped at P = 0"):
            high.check(Fraction(7), SimpleNamespace(of_E=(0, 1), undamped_to=Fraction(100)))


def test_a_cell_that_holds_a_zero_is_never_excluded_and_small_ones_without_are() -> None:
    """P − 1 and ω − ω₀ at (1, ω₀); at ω = 0 alone, where the imaginary part is nothing, its slope excludes."""
    for at in ("0.25", "0.75", "3"):
        equations: Any = SimpleNamespace(
            R=0, real=False, reduced=None,
            system=lambda _, P, x, at=at: ([P - 1, x - arb(at)], [[arb(1), arb(0)], [arb(0), arb(1)]]),
            centre=lambda _, P, x, at=at: [P - 1, x - arb(at)],
        )  # fmt: skip
        cells, box = Cells(equations, Fraction(2), []), SimpleNamespace(value=None)
        x = arb(at)
        for r in ("0.2", "0.001"):
            near = [ball_about(side, r) for side in (arb(1), x)]
            assert cells.excluded(box, *near, []) in (0, 1)
            for P, w in ((near[0] + 1, near[1]), (near[0], near[1] + 1)):
                assert cells.excluded(box, P, w, []) is None
        assert cells.excluded(box, ball_about(arb(1), "0.2"), arb(0).union(x), []) is None  # as it would be of ω F_ω


def ball_about(middle: arb, radius: str) -> arb:
    return middle + arb(radius) * arb(0, 1)


def test_the_command_line_writes_what_it_verifies(tmp_path: Any, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "euler.json"
    asked = ["critical", "--digits", "12", "--exact", "--column", "beck", "--certificate", str(file)]
    assert run(capsys, *asked, "--set", "eta=0")[0] == 0
    status, text, _ = run(capsys, "verify", str(file))
    assert status == 0 and "the beam itself, column beck, eta = 0" in " ".join(text.split())
    asked[-1] = str(tmp_path / "touch.json")  # of all up to just above the load
    assert run(capsys, *asked, "--set", "eta=0.5")[0] == 0
    status, text, _ = run(capsys, "verify", asked[-1])
    text = " ".join(text.split())
    assert status == 0 and "for P from 0 to 16.0524" in text
    assert "changes at exactly 1 of these loads: flutter between 16.05246157716" in text
    assert "touches zero and goes back at a touch between 9.8696044010" in text


def test_damping_must_be_what_the_certificate_says() -> None:
    data = certificate("dead load, damped")
    refused(data | {"damping": data["damping"] | {"of_M": "0.4"}}, "the damping is not those of the column")
    refused(data | {"damping": data["damping"] | {"of_M": "-0.5"}, "column": "another"}, "negative")
    refused(data | {"stretches": []}, "not known to be stable at P = 0")
    with_alpha = certificate("Beck, damped")
    refused(with_alpha | {"load": shifted(with_alpha["load"], "1.0001")}, "no crossing in the interval")
    refused(with_alpha | {"lowest": 2}, "not known to be free|too few points")


def test_a_motion_that_is_not_damped_without_load_is_found() -> None:
    """C = E + c M at s₁ = 12.36; with c = −300 two motions are not damped, and F has its sign at 0 again."""
    points = tuple(map(Fraction, (0, 400, 600)))
    rest = verifier_signs.Stretch(Fraction(0), Fraction(0), points, None, Fraction(0))
    for of_M, damps in ((12, True), (13, False), (300, False), (500, False)):
        one, other = Fraction(1), Fraction(-of_M)
        equations = Equations(Shooting(*of_kernel(beck)), 0, (one, one), (other, other), False)
        with flint.ctx.workprec(128):
            signs = verifier_signs.Signs(equations, arb(700))
            if damps:
                signs.above(equations.undamped_to, [rest])
                continue
            with pytest.raises(Refused, match="lowest frequency is not known to be damped"):
                signs.above(equations.undamped_to, [rest])


def test_the_derivative_on_a_line_is_that_of_the_values_there() -> None:
    ends, E, H = of_kernel(beck)
    P, s, slope, h = arb(12), arb(150), arb(-7), arb(2) ** -30
    with flint.ctx.workprec(128):
        box = Box(Shooting(ends, E, H), arb(12, 1), arb(150, 10))
        ahead, back = (box.value(P + k * h, s + k * slope * h) for k in (1, -1))
        found = verifier_signs.along(box, P, s, slope)
        assert abs((ahead - back) / (2 * h) / found - 1) < 1e-12


def test_rigid_motions_of_the_papers_beam_rest_and_others_are_refused() -> None:
    ends, E, H = of_kernel(free_free)
    bare: Form = (E[0][1:], E[1])
    assert check_rigid(ends, bare, H) == 2
    with pytest.raises(Refused, match="rigid motions"):
        check_rigid(ends, bare, (H[0], ()))
    with pytest.raises(Refused, match="rigid motions"):
        check_rigid(ends, (((0, 0, 0, Fraction(1)),), ()), H)


@pytest.mark.parametrize("kind", ["undamped", "damped", "limit"])
def test_both_have_the_same_equations_of_a_crossing(kind: str) -> None:
    """The verifier's two equations and their derivatives, of the prover's F, against the prover's own."""
    beam, alpha, beta = Beam(beck), Fraction(1, 50), Fraction(3, 10)
    of_E, of_M = ((alpha, alpha), (beta, beta)) if kind != "undamped" else ((Fraction(0), Fraction(0)),) * 2
    check = Equations(Shooting(*of_kernel(beck)), 0, of_E, of_M, kind == "limit")
    problem: Any = {
        "undamped": lambda: Coalescence(beam),
        "damped": lambda: Damped(beam, alpha, beta),
        "limit": lambda: VanishingDamping(beam, beta / alpha),
    }[kind]()
    x = [arb(15), arb(8 if kind == "damped" else 90)]
    with precision(128):
        theirs, matrix, _ = problem.slopes(x)
        orders = ((0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2))
        ours, J = check.system(lambda p, s, i, j: beam.taylor(p, s, orders)[i, j], *x)
        for one, two in [*zip(ours, theirs, strict=True), *((J[i][j], matrix[i, j]) for i in (0, 1) for j in (0, 1))]:
            assert one.overlaps(two) and one.rad() < 1e-20 * abs(one)


@pytest.mark.parametrize("ends", [(a, b) for a in ORDERS for b in ORDERS], ids="-".join)
def test_lengths_of_the_modes_derivatives_are_bounded(ends: tuple[str, str]) -> None:
    with precision(128):
        lines = Lines(list(ends), 9)
        squares = lines.integrals(0, 1, 1)
        for i, (bound, g) in enumerate(zip(lines.norms, lines.gamma, strict=True)):
            assert squares[i, i].sqrt() < bound + arb("1e-30") and bound < lines.longest * g + arb("1e-30")
        modes = modes_of(ends, 9, 128)
        for end in (0, 1):  # and their slopes, as the prover has them
            for slope, g in zip(modes.derivative(end, 1), modes.gamma, strict=True):
                assert abs(slope) < lines.steepest * g + arb("1e-30")


def test_a_certificate_of_the_limit_says_so() -> None:
    """Of external damping alone: all is as without damping."""
    data, of_M = certificate("Beck"), {"of_M": "1", "of_E": "0", "vanishing": True}
    limit = data | {"kappa": "inf", "damping": of_M}
    stated = verify(limit)
    assert stated.load == verify(data).load
    assert "in the limit of vanishing damping in the direction of C = 1 M + 0 E (beta -> 0+ at alpha = 0)" in str(
        stated
    )
    refused(limit | {"damping": of_M | {"of_E": "1"}}, "the damping")
    refused(data | {"kappa": "1", "damping": of_M | {"of_E": "1"}}, "a point moves that should not")
    for factor in ("0", "-1"):
        refused(limit | {"damping": of_M | {"of_M": factor}}, "damping")
    refused(limit | {"load": ["20.06", "20.07"]}, "no crossing in the interval")
    refused(data | {"damping": of_M}, "the damping does not fit")


def test_a_product_is_off_by_no_more_than_its_rest() -> None:
    """Of two numbers, each known but for a rest, the product where both are as far off as they may be."""
    for sizes in ((2.0, 3.0), (0.25, 0.5)):
        for rests in ((5.0, 7.0), (0.5, 3.0), (0.0, 2.0), (1e-9, 1e-12)):
            one, other = (Part([[arb_poly([a])]], arb(a), arb(r)) for a, r in zip(sizes, rests, strict=True))
            most = (sizes[0] + rests[0]) * (sizes[1] + rests[1]) - sizes[0] * sizes[1]
            rest = float(one.times(other, 4).rest)
            assert most * (1 - 1e-15) - 1e-15 <= rest <= most * (1 + 1e-6) + 1e-15


def test_what_may_soften_is_all_but_positive_squares() -> None:
    """Of the remainder of an energy: k, p, q and the factor along the beam; places and orders at the ends."""
    F = Fraction
    along = {(0, 0, 0, F(2)): False, (1, 0, 0, F(-2)): True, (0, 1, 1, F(3)): False, (0, 0, 1, F(3)): True}
    ends = {(1, 0, 1, 0, F(2)): False, (1, 1, 1, 1, F(-2)): True, (1, 0, 1, 1, F(3)): True, (0, 1, 1, 1, F(3)): True}
    softens = [tuple(term for term, kept in terms.items() if kept) for terms in (along, ends)]
    assert list(verifier_of_beam._softening((tuple(along), tuple(ends)))) == softens
