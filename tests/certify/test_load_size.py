"""How large a load is at places without a mass, as at joints: Lemma 12 of docs/theorem.md."""

from __future__ import annotations

import random
from fractions import Fraction
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from flint import arb, fmpq, fmpq_poly
from numpy.polynomial import Polynomial as Numeric

import freebeam as fb
from freebeam_derive.certify.balls import precision
from freebeam_derive.certify.column_forms import ColumnForms, at
from freebeam_derive.certify.exact_system import ExactSystem
from freebeam_derive.certify.frequency_gaps import FrequencyGaps
from freebeam_derive.certify.load_size import Value, _by_parts, _size, load_size
from freebeam_derive.certify.strips import NoStrips
from freebeam_derive.certify.verifier_load_size import size
from freebeam_derive.certify.verifier_sections import Sections
from tests.certify.test_column_forms import along, kernel
from tests.certify.test_column_forms import at as at_place

BITS = 64
JOINTS = {"crack": {"k": Fraction(2), "a": Fraction(2, 5)}, "shear-joint": {"k": Fraction(50), "a": Fraction(3, 5)}}


def forms_of(name: str) -> Any:
    return ColumnForms(fb.column(name).kernel, JOINTS[name])


def derived(f: list[Fraction], order: int) -> list[Fraction]:
    for _ in range(order):
        f = [i * v for i, v in enumerate(f)][1:]
    return f


def integral(low: Fraction, high: Fraction, *factors: list[Fraction]) -> Fraction:
    total = [Fraction(1)]
    for f in factors:
        total = [sum((total[i] * f[k - i] for i in range(len(total)) if 0 <= k - i < len(f)), Fraction(0))
                 for k in range(len(total) + len(f) - 1)] if f else []  # fmt: skip
    whole = [Fraction(0), *(v / (i + 1) for i, v in enumerate(total))]
    return at(whole, high) - at(whole, low)


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("name", JOINTS)
def test_by_parts_the_load_is_what_it_was(name: str, turned: bool) -> None:
    """For all orders along the beam and a follower's end, y and v of two pieces that go on but where they may jump."""
    dice = random.Random(name)
    with precision(BITS):
        forms = forms_of(name)
    place, end = forms.breaks[1], Fraction(1)
    load = [{(p, q): [Fraction(dice.randint(-5, 5)) for _ in range(3)] for p in (0, 1) for q in (0, 1)} for _ in "ab"]
    points = {((end, 0), (end, 1)): Fraction(3)}

    def piecewise() -> list[list[Fraction]]:
        """Clamped at 0; at the joint y, or y', goes on."""
        left, right = ([Fraction(0)] * 2 + [Fraction(dice.randint(-5, 5)) for _ in range(3)] for _ in "ab")
        for order in (1, 0):
            if (place, order) not in forms.opened:
                gap = at(derived(left, order), place) - at(derived(right, order), place)
                right = [v + gap * (i == order) for i, v in enumerate(right)]
        return [left, right]

    y, v = piecewise(), piecewise()
    stated = points[(end, 0), (end, 1)] * at(v[1], end) * at(derived(y[1], 1), end)
    for n, (low, high) in enumerate(pairwise(forms.breaks)):
        stated += sum(integral(low, high, f, derived(v[n], p), derived(y[n], q)) for (p, q), f in load[n].items())
    if turned:
        y, v = v, y

    def seen(of: list[list[Fraction]], where: Any) -> Fraction:
        (place, order), side = where
        return at(derived(of[0 if place == 0 or (place < 1 and side < 0) else 1], order), place)

    inner, found = _by_parts(forms, load, points, turned)
    moved = sum(
        (f * seen(v, row) * seen(y, of) for row, table in found.items() for of, f in table.items()), Fraction(0)
    )
    for n, (low, high) in enumerate(pairwise(forms.breaks)):
        moved += sum(integral(low, high, f, v[n], derived(y[n], q)) for q, f in inner[n].items())
    assert moved == stated


@pytest.mark.parametrize("order", [0, 1])
@pytest.mark.parametrize("jump", [False, True])
def test_a_value_at_a_place_is_below_its_bound(order: int, jump: bool) -> None:
    """The largest of polynomials on two parts with ‖w''‖²/u² + ‖w‖²/v² = 1, as such or with a jump, for all u and v."""
    with precision(BITS):
        forms = forms_of("crack")
        place = float(forms.breaks[1])
    basis = [Numeric.basis(n, domain=[0, 1], window=[-1, 1]) for n in range(14)]
    x, weight = np.polynomial.legendre.leggauss(24)
    parts = [(low + (high - low) * (x + 1) / 2, (high - low) / 2 * weight) for low, high in ((0, place), (place, 1))]

    def gram(points: Any, weights: Any, order: int) -> Any:
        values = np.array([f.deriv(order)(points) if order else f(points) for f in basis])
        return (values * weights) @ values.T

    at_place = np.array([f.deriv(order)(place) if order else f(place) for f in basis])
    blocks = [[gram(*part, d) for part in parts] for d in (0, 2)]
    for u, v in ((1.0, 1.0), (30.0, 1.0), (1e3, 2.0), (1.0, 1e-2)):
        if jump:
            each = [at_place @ np.linalg.solve(B / u**2 + A / v**2, at_place) for A, B in zip(*blocks, strict=True)]
            largest, value = sum(each) ** 0.5, Value(order, arb(2).sqrt(), (0, 1))
        else:
            A, B = (sum(of) for of in blocks)
            largest = (at_place @ np.linalg.solve(B / u**2 + A / v**2, at_place)) ** 0.5
            value = Value(order, 1 / arb(2).sqrt(), (0, 1))
        with precision(BITS):
            bound = float(value.most(forms, arb(u), arb(v)))
        assert largest * (1 - 1e-6) <= bound < 6 * largest


@pytest.mark.parametrize(("name", "load"), [("crack", "8"), ("shear-joint", "8")])
def test_no_eigenvalue_of_a_jointed_column_meets_a_line(name: str, load: str) -> None:
    it = ExactSystem(fb.column(name).kernel, JOINTS[name])
    with precision(BITS):
        gaps = FrequencyGaps(it, arb(load))
        lines, reach = {k: float(gaps.line(k)) for k in gaps.lines[:5]}, float(gaps.reach)
    basis, own = it.kernel.basis(24), {key: float(value) for key, value in JOINTS[name].items()}
    M, E, K = (
        f(basis, P, **own) for f, P in ((it.kernel.mass, 0.0), (it.kernel.stiffness, 0.0), (it.kernel.stiffness, 1.0))
    )
    assert len(lines) > 3 and reach > float(load)
    for turn in np.linspace(0, np.pi, 7):
        s = 1 / np.linalg.eigvals(np.linalg.solve(E + 0.98 * reach * np.exp(1j * turn) * (K - E), M))
        assert all(np.sum(s.real < R) == k for k, R in lines.items())


@pytest.mark.parametrize("ends", [("clamped", "free"), ("pinned", "clamped")])
def test_both_programs_find_one_size_of_a_load(ends: tuple[str, str]) -> None:
    """Of two parts with a mass and a rotary inertia at each place: loads of all orders, forces, moments."""
    draw, (left, right) = random.Random(3), ((Fraction(2), Fraction(5)), (Fraction(3), Fraction(4)))
    places = [(Fraction(1, 2), 0), (Fraction(1, 2), 1), (Fraction(1), 0), (Fraction(1), 1)]
    for _ in range(3):
        loads = [(n, p, q, Fraction(draw.randint(-5, 5))) for n in (0, 1) for p in (0, 1) for q in (0, 1)]
        masses = {place: Fraction(draw.randint(1, 9), 10) for place in places}
        forces = {(draw.choice(places), draw.choice(places)): Fraction(draw.randint(-5, 5)) for _ in range(3)}
        stub = kernel(
            ends=ends, mass=[along(0, 0, f, on=(n,)) for n, f in enumerate(left)],
            bending=[along(2, 2, f, on=(n,)) for n, f in enumerate(right)],
            masses=[at_place(*place, f) for place, f in masses.items()],
            load=[along(p, q, f, on=(n,)) for n, p, q, f in loads],
            forces=[at_place(*row, f, of) for (row, of), f in forces.items()],
        )  # fmt: skip
        with precision(BITS):
            forms = ColumnForms(stub, {})
            tables: list[Any] = [{(p, q): fmpq_poly([fmpq(int(f))]) for m, p, q, f in loads if m == n} for n in (0, 1)]
            other = Sections(
                ends, forms.breaks, *([fmpq_poly([int(f)]) for f in of] for of in (right, left)), [{}, {}], tables,
                {numbered(place): f for place, f in masses.items() if not forms.is_held(*place)}, {},
                {(numbered(row), numbered(of)): f for (row, of), f in forces.items()},
            )  # fmt: skip
            for turned in (False, True):
                found, checked = _size(forms, forms.load, forms.load_points, turned), size(other, turned)
                assert not (found.places or checked.places)
                assert float(found.constant) == pytest.approx(float(checked.constant), rel=1e-9)
            assert load_size(forms).constant == _size(forms, forms.load, forms.load_points, False).constant


def numbered(place: tuple[Fraction, int]) -> tuple[int, int]:
    return int(2 * place[0]), place[1]


def test_a_moment_where_no_rotary_inertia_is_has_no_bound() -> None:
    with precision(BITS):
        forms = forms_of("crack")
        forms.load_points = {((Fraction(1), 1), (Fraction(1), 1)): Fraction(1)}
        with pytest.raises(NoStrips, match="has a moment as a load on an end"):
            load_size(forms)
