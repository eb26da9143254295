"""The comparison modes in balls, the bounds of the load's form, and where the strips say that eigenvalues are."""

from __future__ import annotations

from fractions import Fraction
from itertools import pairwise
from types import ModuleType, SimpleNamespace
from typing import Any

import numpy as np
import pytest
from flint import arb, arb_mat

import freebeam_kernels.beck as beck
import freebeam_kernels.beck_legendre as polynomials
import freebeam_kernels.euler_pinned as euler
import freebeam_kernels.free_free as free_free
from freebeam_derive.certify import balls
from freebeam_derive.certify.balls import Unproven, precision
from freebeam_derive.certify.comparison_form import (
    ORDERS,
    Modes,
    _none_up_to_one,
    _settled,
    bounds,
    characteristic,
    roots,
)
from freebeam_derive.certify.strips import Form, NoStrips, Strips, _of_lines, _reach, rigid_motions

ENDS = [(a, b) for a in ORDERS for b in ORDERS]
BITS = 128


@pytest.mark.parametrize("ends", ENDS, ids=["-".join(e) for e in ENDS])
def test_modes_are_orthonormal_in_mass_and_in_bending(ends: tuple[str, str]) -> None:
    with precision(BITS):
        modes = Modes(ends, 8)
        M, E, G = modes.integral(0, 0, 0), modes.integral(0, 2, 2), modes.integral(0, 1, 1)
        for i, g in enumerate(modes.gamma):
            assert all(modes.ends[e][d][i] == 0 for e, kind in enumerate(ends) for d in ORDERS[kind])
            for j in range(8):
                assert M[i, j].contains(int(i == j)) and M[i, j].rad() < 1e-30
                assert E[i, j].contains(g**4 if i == j else 0) and E[i, j].rad() < 1e-24 * modes.gamma[-1] ** 4
                assert (G[i, j] - G[j, i]).contains(0)
            # what the theorem takes of every mode beyond, at this one
            if i:
                held = bounds(ends, g)
                assert all(abs(modes.ends[e][d][i]) < held.end[d] + arb("1e-30") for e in (0, 1) for d in (0, 1))
                assert (G[i, i].sqrt() / g) < held.slope + arb("1e-30")
        assert all(abs(g - modes.lattice(k)) <= modes.spread for k, g in enumerate(modes.gamma, 1))


@pytest.mark.parametrize("kernel", [beck, free_free, euler], ids=["beck", "free-free", "euler"])
def test_roots_and_entries_are_those_of_the_kernel(kernel: ModuleType) -> None:
    """Closed forms that were derived symbolically, of modes of another size and sign."""
    with precision(BITS):
        modes = Modes(kernel.COLUMN["ends"], 12)
        form = modes.form(*kernel.forms(arb(1))["H"])
        M, _, H = balls.matrices(kernel, 12)
        quarter, _, delta = balls.roots(kernel, 12)
        for i in range(12):
            assert modes.gamma[i].overlaps(quarter[i] * arb.pi() / 4 + delta[i])
            for j in range(12):
                assert abs(form[i, j]).overlaps(abs(H[i, j]) / (M[i, i] * M[j, j]).sqrt())


def test_few_roots_are_the_first_of_many() -> None:
    with precision(BITS):
        for ends in (("clamped", "free"), ("pinned", "pinned")):
            few, many = roots(ends, 1, BITS), roots(ends, 12, BITS)
            assert few[0][0].overlaps(many[0][0]) and many[1] - few[1] == 11


@pytest.mark.parametrize("ends", ENDS[1::3], ids=["-".join(e) for e in ENDS[1::3]])
def test_the_series_of_the_characteristic_function_is_that_of_its_values(ends: tuple[str, str]) -> None:
    """Of f e^γ at a γ: summed a little further on, and its first slope beside that of f."""
    with precision(BITS):
        f = characteristic(ends)
        for g, h in ((arb("0.7"), arb(1) / 64), (arb(5), arb(-1) / 64)):
            series = f.scaled_series(g, 16)
            (value, slope), (there, _) = f(g), f(g + h)
            assert series[0].overlaps(value * g.exp()) and series[1].overlaps((value + slope) * g.exp())
            total = sum((c * h**n for n, c in enumerate(series)), arb(0))
            assert abs(total - there * (g + h).exp()) < 1e-30 * g.exp()


@pytest.mark.parametrize("known", [True, False])
def test_that_no_root_is_near_zero_is_asked_for_on_all_of_the_way_to_one(known: bool) -> None:
    """In balls without a gap; a sign that is not known in the last of them is not passed over."""
    asked: list[arb] = []

    def series(x: arb, order: int) -> list[arb]:
        asked.append(x)
        return [arb(0), arb(0), arb(3) if known or not x.contains(1) else arb(0, 1)] + [arb(7)] * 7

    f: Any = SimpleNamespace(scaled_series=series)
    with precision(BITS):
        if known:
            _none_up_to_one(f)
        else:
            with pytest.raises(Unproven, match="neighbourhood of γ = 0"):
                _none_up_to_one(f)
        pieces = sorted(asked[1:], key=lambda x: float(x.mid()))
        assert pieces[0].contains(0) and pieces[-1].contains(1)
        assert all(a.upper() >= b.lower() for a, b in pairwise(pieces))


def test_modes_that_are_too_low_for_the_bounds_have_none() -> None:
    """2/(1 − 4ε/(1 − ε)²) bounds no mode where 4 ε > (1 − ε)², below γ = 1.7627…; nor are few settled."""
    with precision(BITS):
        least = (3 + 2 * arb(2).sqrt()).log()
        for ends in ENDS:
            assert bounds(ends, least + arb("0.01")).end[1] > 1
            with pytest.raises(Unproven, match="too low for their bounds"):
                bounds(ends, least - arb("0.01"))
        for ends, count in ((("free", "free"), 1), (("clamped", "free"), 1), (("clamped", "free"), 2)):
            settled = _settled(characteristic(ends), roots(ends, count, BITS)[0][-1] - 1)
            if settled:
                assert Modes(ends, count).spread < arb.pi() / 4
            else:
                with pytest.raises(Unproven, match="more modes are needed"):
                    Modes(ends, count)


def squares(form: Form, R: arb) -> arb:
    """The Hilbert-Schmidt norm of the block that is known, squared."""
    row = arb_mat([[1 / abs(g**4 - R) for g in form.modes.gamma]])
    return (row * form._squares * row.transpose())[0, 0]


LOADS: dict[str, tuple[tuple[str, str], Any, Any]] = {
    "beck": (("clamped", "free"), {(0, 1, 1): -1}, {(1, 0, 1, 1): 1}),
    "free-free": (("free", "free"), {(1, 1, 1): -1}, {(1, 0, 1, 1): 1}),
    "panel": (("clamped", "pinned"), {(0, 0, 1): 1}, {}),
    "of every kind": (
        ("sliding", "free"),
        {(3, 1, 0): 2, (2, 1, 1): -1, (0, 0, 0): 3},
        {(1, 1, 1, 1): 1, (0, 0, 1, 1): -2},
    ),
}


@pytest.mark.parametrize("name", LOADS)
def test_the_tail_is_above_the_entries_far_out_and_not_by_much(name: str) -> None:
    ends, along, points = LOADS[name]
    with precision(BITS):
        few, many = (Form(Modes(ends, n), along, points) for n in (16, 128))
        for k in (0, 1, 3, 8):
            R = Strips.line(SimpleNamespace(modes=few.modes), k)  # type: ignore[arg-type]
            tail, bound = squares(many, R) - squares(few, R), few.norm(R) ** 2 - squares(few, R)
            assert 0 < tail < bound
            assert few.norm(R) >= many.norm(R)
            # not more than a halved one would still hold, where it matters
            if name in ("beck", "free-free") and k == 3:
                assert bound < 8 * tail


def test_half_a_tail_would_be_too_little() -> None:
    """Of Beck's column the bound is within a factor of two of the entries: half of it would be false."""
    ends, along, points = LOADS["beck"]
    with precision(BITS):
        few, many = (Form(Modes(ends, n), along, points) for n in (40, 240))
        R = Strips.line(SimpleNamespace(modes=few.modes), 2)  # type: ignore[arg-type]
        tail, bound = squares(many, R) - squares(few, R), few.norm(R) ** 2 - squares(few, R)
        assert bound / 2 < tail < bound


@pytest.mark.parametrize("name", LOADS)
def test_one_bound_serves_all_lines_from_some_on(name: str) -> None:
    ends, along, points = LOADS[name]
    with precision(BITS):
        form = Form(Modes(ends, 80), along, points)
        lines = SimpleNamespace(modes=form.modes)
        before = form.beyond(6)
        for k in (8, 12, 20, 40):
            assert form.norm(Strips.line(lines, k)) < form.beyond(k) < before  # type: ignore[arg-type]
            before = form.beyond(k)


CASES = [(beck, {}), (polynomials, {"eta": Fraction(1, 3)}), (free_free, {}), (euler, {})]


@pytest.mark.parametrize(("kernel", "own"), CASES, ids=["beck", "sub-tangential", "free-free", "euler"])
def test_eigenvalues_of_long_series_are_where_the_strips_say(kernel: ModuleType, own: dict[str, Fraction]) -> None:
    """For complex loads as large as each line allows: k eigenvalues to its left."""
    with precision(BITS):
        strips = Strips(kernel, own)
        lines = [(k, float(strips.line(k)), float(strips.reach(k))) for k in range(1, 9)]
    name = kernel.COLUMN["name"].replace("-", "_")
    series = __import__(f"freebeam_kernels.{name}_legendre", fromlist=["basis"])
    basis, given = series.basis(30), {key: float(v) for key, v in own.items()}
    M, E, H = (f(basis, **given) for f in (series.mass, series.stiffness_elastic, series.stiffness_load))
    random = np.random.default_rng(5)
    for k, R, reach in lines:
        for turn in (0.0, np.pi, *random.uniform(0, 2 * np.pi, 3)):
            values = np.linalg.eigvals(np.linalg.solve(M, E + reach * np.exp(1j * turn) * H))
            assert np.sum(values.real < R) == k
    # and the lines are not free for every load
    far = np.linalg.eigvals(np.linalg.solve(M, E + 30 * lines[0][2] * H))
    assert np.sum(far.real < lines[0][1]) != 1


def test_reaches_grow_with_m_and_none_is_above_that_of_a_line() -> None:
    with precision(BITS):
        strips = Strips(free_free, {})
        found = strips.reaches(arb(100))
        assert list(found) == sorted(found, reverse=True)
        assert all(found[m] <= strips.reach(k) for m in found for k in (m, m + 1, m + 5) if k < 45)
        assert all(found[m] <= found[m + 1] for m in found if m + 1 in found)
        with pytest.raises(NoStrips, match="could not be told apart"):
            strips.reaches(arb(10) ** 6)


def test_a_line_that_is_not_free_is_below_every_m() -> None:
    """Whichever line it is: m is said of lines that are all free."""
    for line in range(1, 9):
        them: Any = object.__new__(Strips)
        them.modes, them.reach_from = SimpleNamespace(count=12), lambda k: arb(50)
        them.reach = lambda k, line=line: arb(3) if k == line else arb(70)
        assert [*them.reaches(arb(40))] == [*range(9, line, -1)]
        assert all(reach <= (50 if m > line else 3) for m, reach in them.reaches(arb(2)).items())


def stated(kernel: ModuleType, **changes: Any) -> Any:
    """A kernel with other forms."""
    forms = kernel.forms(Fraction(1)) | changes
    return SimpleNamespace(
        COLUMN=dict(kernel.COLUMN, name="other", parameters=[]),
        forms=lambda one=1: forms,
        damping_factors=lambda a, b: (b, a),
    )


@pytest.mark.parametrize(
    ("other", "message"),
    [
        (stated(euler, M=({(0, 0, 0): 1, (0, 1, 1): 1}, {})), "mass or its bending stiffness"),
        (stated(euler, E=({(0, 2, 2): 2}, {})), "mass or its bending stiffness"),
        (stated(euler, H=({(0, 2, 1): 1}, {})), "acts on curvatures"),
        (stated(free_free, H=({(0, 1, 1): -1}, {})), "rigid motions feel the load"),
        # a translation and a rotation that the load drives apart, each alone: opposite rates
        (stated(free_free, H=({(0, 0, 0): 2, (1, 0, 0): -15, (2, 0, 0): 15}, {})), "rigid motions feel the load"),
        (stated(free_free, E=({(0, 2, 2): 1, (0, 0, 0): 1}, {})), "rigid motions feel"),
    ],
)
def test_columns_of_another_kind_are_refused(other: Any, message: str) -> None:
    with precision(BITS), pytest.raises(NoStrips, match=message):
        Strips(other, {})


def test_an_elastic_energy_besides_bending_narrows_the_reach() -> None:
    """A foundation of stiffness 100 moves every eigenvalue by 100, which the strips know."""
    sprung = stated(euler, E=({(0, 2, 2): 1, (0, 0, 0): 100}, {}))
    with precision(BITS):
        plain, other = Strips(euler, {}), Strips(sprung, {})
        assert 0 < other.reach(2) < plain.reach(2)
        assert other.T.norm(other.line(2)) > 100 / abs(other.modes.gamma[2] ** 4 - other.line(2))


@pytest.mark.parametrize("still", ["0", "0.3", "0.99", "1", "1.01", "7"])
def test_lines_are_free_up_to_the_reach_and_no_further(still: str) -> None:
    """‖T‖ + |p| ‖B‖ ≤ 1 is what makes a line free; where ‖T‖ is 1 none is, whatever the load."""
    with precision(BITS):
        norm, rate = arb(still), arb(1) / 50
        reach = _reach(norm, rate)
        if norm < 1:
            assert (norm + reach * rate).lower() <= 1 < norm + reach * rate * arb("1.0001")
        else:
            assert reach == _reach(norm, arb(0)) == 0


def test_a_form_on_two_lines_is_its_integral() -> None:
    """The derivatives of lines multiplied and integrated, and their values at places, by polynomials of NumPy."""
    draw = np.random.default_rng(3)
    for k, p, q in ((0, 0, 0), (1, 0, 0), (2, 0, 1), (3, 1, 0), (1, 1, 1), (0, 2, 0)):
        test, trial = (tuple(map(Fraction, draw.integers(-5, 6, 2).tolist())) for _ in range(2))
        one, two = (np.polynomial.Polynomial(list(map(float, line))) for line in (test, trial))
        one, two = (y.deriv(d) if d else y for y, d in ((one, p), (two, q)))
        whole = (one * two * np.polynomial.Polynomial([0.0] * k + [1.0])).integ()
        wanted = 3 * (whole(1.0) - whole(0.0)) + 2 * one(1.0) * two(0.0)
        found = _of_lines([{(k, p, q): Fraction(3)}, {(1, p, 0, q): Fraction(2)}], test, trial)
        assert float(found) == pytest.approx(wanted, rel=1e-12, abs=1e-12)


@pytest.mark.parametrize("kinds", [("free", "free"), ("pinned", "free"), ("free", "pinned"), ("sliding", "free")])
def test_rigid_motions_are_orthogonal_and_of_the_mass_that_is_said(kinds: tuple[str, str]) -> None:
    found = rigid_motions(kinds)
    product = [{(0, 0, 0): Fraction(1)}, {}]
    assert found and all(_of_lines(product, line, line) == mass for line, mass in found)
    assert all(_of_lines(product, one, two) == 0 for (one, _), (two, _) in pairwise(found))
