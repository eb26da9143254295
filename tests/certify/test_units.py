"""In other units of mass and force, and under another load, all bounds are the same quantities: of columns whose mass,
stiffness, springs and load are no numbers that are their own squares or inverses."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from fractions import Fraction
from types import SimpleNamespace
from typing import Any

import flint
import numpy as np
import pytest
from flint import acb_poly, arb, fmpq, fmpq_poly

from freebeam_derive.certify.column_forms import ColumnForms
from freebeam_derive.certify.damped_gaps import LeftOver, _reach, _share
from freebeam_derive.certify.load_size import load_size
from freebeam_derive.certify.parts import _fast
from freebeam_derive.certify.stepped_section import SteppedSection, motion
from freebeam_derive.certify.variable_section import VariableSection
from freebeam_derive.certify.verifier_claims import Refused
from freebeam_derive.certify.verifier_damping import Damped
from freebeam_derive.certify.verifier_equations import Equations
from freebeam_derive.certify.verifier_load_size import size
from freebeam_derive.certify.verifier_sections import Sections
from freebeam_derive.certify.verifier_waves import Apart
from tests.certify.test_column_forms import HALF, ONE, along, at, kernel

F = Fraction
BITS = 64
Quantity = tuple[arb, float, float, float]
"""A value, and the powers of the units of mass, force and load that it has."""


def stepped(a: int, b: int, c: int, **more: Any) -> Any:
    """Two uniform parts with masses and springs, in units of mass, force and load."""
    return kernel(**({
        "mass": [along(0, 0, 2 * a, on=(0,)), along(0, 0, 3 * a, on=(1,))],
        "bending": [along(2, 2, 5 * b, on=(0,)), along(2, 2, 7 * b, on=(1,))],
        "masses": [at(HALF, 0, F(a, 3)), at(ONE, 0, F(a, 2))],
        "springs": [at(HALF, 1, 11 * b), at(ONE, 0, 6 * b)],
        "load": [along(1, 1, -c)], "forces": [at(ONE, 0, c, (ONE, 1))],
        "damping": [along(2, 2, F(5 * b, 4), on=(0,)), along(2, 2, F(7 * b, 4), on=(1,))], "dampers": [],
    } | more))  # fmt: skip


def of_parts(a: int, b: int, c: int) -> Iterator[Quantity]:
    it = stepped(a, b, c)
    forms = ColumnForms(it, {})
    section, size = SteppedSection(forms), load_size(forms).constant
    yield forms.lowest, -0.5, 0.5, 0
    yield forms.least, 0, 1, 0
    yield size, -0.5, -0.5, 1
    yield from ((rate, 0.25, -0.25, 0) for rate in section.rates)
    omega = (arb(b) / a).sqrt()
    G, gap = section.gap_beyond(lambda *_: omega)
    yield G, -0.25, 0.25, 0
    yield gap, -0.5, 0.5, 0
    yield from ((g, -0.25, 0.25, 0) for g in section.lowest(2 * omega.sqrt()))
    yield _share(forms, 9000 * omega), 0, 0, 0
    for order in (0, 1):
        yield _reach(forms, HALF, order, 50 * omega), -0.5, 0, 0
        # a spring there makes the square of the frequency grow by this, over its stiffness
        first = section.lowest(omega.sqrt())[0] ** 2
        yield motion([section], first.mid(), (ONE, order)), -1, 0, 0


def where_no_mass_is(a: int, b: int, c: int) -> Iterator[Quantity]:
    """A load on a tip without a mass, which grows with the frequencies between which it acts."""
    size = load_size(ColumnForms(stepped(a, b, c, masses=[at(HALF, 0, F(a, 3))], forces=[]), {}))
    omega = (arb(b) / a).sqrt()
    assert size.places
    for low, high in ((0, 50), (40, 50), (4000, 5000)):
        yield size.at(low * omega, high * omega), -0.5, -0.5, 1
    for value, seen, _ in size.places:
        for one in (value, *seen):
            yield one.most(size.forms, arb(b).sqrt(), arb(a).sqrt() / 90) / one.weight, 0, 0, 0


def held_by_springs(a: int, b: int, c: int) -> Iterator[Quantity]:
    springs = [at(F(0), 0, 3 * b), at(HALF, 0, 2 * b), at(ONE, 1, 5 * b)]
    forms = ColumnForms(stepped(a, b, c, ends=("free", "free"), springs=springs), {})
    yield forms.lowest, -0.5, 0.5, 0
    hinged = ColumnForms(stepped(a, b, c, ends=("pinned", "free"), springs=springs), {})
    yield hinged.lowest, -0.5, 0.5, 0


def tapered(a: int, b: int, c: int) -> Iterator[Quantity]:
    it = kernel(
        places=(F(0), ONE), mass=[along(0, 0, 2 * a, -a, on=(0,))], load=[], forces=[], masses=[at(ONE, 0, F(a, 3))],
        bending=[along(2, 2, 3 * b, -b, on=(0,)), along(0, 0, 2 * b, b, on=(0,)), along(1, 1, F(b, 9), on=(0,))],
        springs=[at(ONE, 0, b), at(ONE, 1, F(b, 9))],
    )  # fmt: skip
    section = VariableSection(ColumnForms(it, {}))
    yield section.scale, -0.25, 0.25, 0
    for k in (20, 30):
        R, gap = section.far_gap(k)
        assert gap > 0
        yield R, -1, 1, 0
        yield gap, -0.5, 0.5, 0


def left_over(a: int, b: int, c: int) -> Iterator[Quantity]:
    """Of a damping whose coefficients keep the unit of time: the roots of the units of mass and force."""
    rate = F(round((a * b) ** 0.5))
    assert rate**2 == a * b
    damping = [along(2, 2, F(5 * b, 4), on=(0,)), along(2, 2, F(7 * b, 4), on=(1,)), along(0, 0, rate)]
    dampers = [at(ONE, 0, 3 * rate), at(HALF, 1, 2 * rate)]
    it = stepped(a, b, c, damping=damping, dampers=dampers, springs=[])
    R = LeftOver(ColumnForms(it, {}), it, {}, F(1), F(0), True)
    omega = (arb(b) / a).sqrt()
    yield R.c_E, 0, 0, 0
    for value in (R.c_M, R.low, R.high, R.size, R.least(50 * omega, arb("0.1"))):
        yield value, -0.5, 0.5, 0
    yield R.taken(50 * omega, arb("0.1"), arb("0.2")), 0, 0, 0


def sections(a: int, b: int, c: int) -> Iterator[Quantity]:
    """The same of the verifier."""
    of = Sections(
        ("clamped", "free"), (F(0), HALF, ONE), [fmpq_poly([5 * b, b]), fmpq_poly([7 * b, b])],
        [fmpq_poly([2 * a]), fmpq_poly([3 * a, -a])], [{0: fmpq_poly([b])}, {1: fmpq_poly([2 * b])}],
        [{(1, 1): fmpq_poly([-c])}] * 2, {(1, 0): F(a, 3), (2, 0): F(a, 2), (2, 1): F(a, 7)},
        {(1, 1): F(11 * b), (2, 0): F(6 * b)}, {((2, 0), (2, 1)): F(c)},
    )  # fmt: skip
    omega = (arb(b) / a).sqrt()
    for turned in (False, True):
        yield size(of, turned).constant, -0.5, -0.5, 1
    yield of.bending, 0, 0, 0
    yield replace(of, elastic=[{1: fmpq_poly([-b])}, {1: fmpq_poly([0, -b])}]).bending, 0, 0, 0
    apart = Apart(of)
    yield apart.whole, 0.25, -0.25, 0
    G = 40 * omega.sqrt()
    for segment in apart.segments:
        # in z the second derivative has the unit of ω, and in units of the segment's length none
        yield segment.A[0], -0.5, 0.5, 0
        yield segment.H[0], -1, 1, 0
        yield segment.A[1] / G, 0, 0, 0
    damping = Damped(of, F(1, 4), F(0), True, [{}, {}], {(2, 0): F(3), (0, 1): F(2)}, ([], {}))
    yield damping.share(9000 * omega), 0, 0, 0
    for order in (0, 1):
        yield damping.reach((1, order), 50 * omega), -0.5, 0, 0
    for weight, energy in damping._bumps((2, 0))[:3]:
        yield weight, 1, 0, 0
        yield energy, 0, 1, 0


@pytest.mark.parametrize("of", [of_parts, where_no_mass_is, held_by_springs, tapered, left_over, sections])
def test_bounds_are_quantities(of: Callable[[int, int, int], Iterator[Quantity]]) -> None:
    a, b, c = 2**4, 3**4, 5
    with flint.ctx.workprec(BITS):
        one, other = list(of(1, 1, 1)), list(of(a, b, c))
        assert len(one) == len(other) > 1
        for (plain, *powers), (value, *_) in zip(one, other, strict=True):
            unit = np.prod([float(x) ** power for x, power in zip((a, b, c), powers, strict=True)])
            assert float(value) == pytest.approx(float(plain) * unit, rel=1e-6, abs=1e-25) and float(plain) != 0


# ------------------------------------------------------------ estimates and refusals beside these


def test_a_frame_turns_at_twice_to_four_times_the_fastest_motion() -> None:
    draw = np.random.default_rng(4)
    for n in (1, 2, 3):
        half, other = draw.integers(-3, 4, (2, n, n))
        M, K = half @ half.T + np.eye(n, dtype=int), 20 * other @ other.T + np.eye(n, dtype=int)
        B = draw.integers(-9, 10, (n, n))
        B = B + B.T
        exact = [np.array([[fmpq(int(v)) for v in row] for row in X], dtype=object) for X in (M, B, K)]
        whole = np.block([[np.zeros((n, n)), np.eye(n)], [np.linalg.solve(M, K), -np.linalg.solve(M, B)]])
        fastest = max(1.0, abs(np.linalg.eigvals(whole)).max())
        assert 2 * fastest * (1 - 1e-9) <= _fast(*([X] for X in exact), 0.5) < 4 * fastest
        stiffer = np.block([[np.zeros((n, n)), np.eye(n)], [4 * np.linalg.solve(M, K), -np.linalg.solve(M, B)]])
        fastest = max(fastest, abs(np.linalg.eigvals(stiffer)).max())  # at a load of 3/2, or at 0
        assert 2 * fastest * (1 - 1e-9) <= _fast([exact[0]], [exact[1]], [exact[2], 2 * exact[2]], 1.5) < 4 * fastest


def test_what_is_damped_over_a_range_is_so_for_each_value() -> None:
    for of_E, of_M in (((1, 2), (-3, -1)), ((2, 2), (-1, 4)), ((1, 3), (1, 2)), ((0, 1), (-2, 3)), ((0, 0), (1, 1))):
        them: Any = object.__new__(Equations)
        them.of_E, them.of_M = (tuple(map(F, pair)) for pair in (of_E, of_M))
        worst = max((F(-m, e) for e in of_E for m in of_M if e), default=F(0)) if of_E[0] else F(0)
        assert them.undamped_to == max(worst, F(0))


def test_how_an_eigenvalue_leaves_zero_is_by_load_and_rates() -> None:
    """F of P/(1 + αλ) and s = −(λ² + βλ)/(1 + αλ) by −λ at 0: α P F_P + β F_s; without these, F_s."""
    them: Any = object.__new__(Equations)
    box: Any = SimpleNamespace(value=lambda P, s, i, j: arb(11) if (i, j) == (0, them.R + 1) and s == 0 else arb(0))
    for them.real, them.undamped, wanted in ((False, False, 2 * 3 * 5 + 7 * 11), (True, True, 11)):
        them.R, them.of_E, them.of_M = 1, (F(2), F(2)), (F(7), F(7))
        assert them.rate(box, arb(3), arb(5)) == wanted
    box.value = lambda *_: arb(0, 1)
    with pytest.raises(Refused, match="s = 0 is not known to be simple"):
        them.rate(box, arb(3), arb(5))


@pytest.mark.parametrize("unknown", ["value", "slope"])
def test_of_a_rest_that_is_not_known_nothing_is_said(unknown: str) -> None:
    them: Any = object.__new__(Apart)
    them.stages, them.lengths, them.whole, them.same = [{(1,): [acb_poly([1])]}], [arb(3)], arb(3), [0]
    them.rest = lambda G, eta: None if (eta > 0) == (unknown == "slope") else arb(0)
    assert not them._cells_apart(arb(0), arb(9), arb("0.001"))
    them.rest = lambda G, eta: arb(0)
    assert them._cells_apart(arb(0), arb(9), arb("0.001"))
