"""Columns of tables against the derived column, Hermite's elements, a statement in the language, and identities."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction as Q
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import freebeam as fb
from freebeam.vehicles.tabulated import Law, Part, Table, tabulated
from freebeam_sym import InputError
from tests.reference import elements
from tests.reference.systems import At, Beam, Segment, Term, energy, follower
from tests.reference.values import ISSUE

ONE = np.ones((1, 2))
UNIFORM = Table(np.array([0.0, 1.0]), ONE, ONE)
STEP = 0.6  # of the table, where a station is given twice
TABLE = Table(
    np.array([0.0, 0.25, STEP, 1.0]),
    np.array([[0.4, 1.0], [1.0, 1.4], [2.0, 1.5]]),
    np.array([[0.3, 0.8], [0.8, 1.2], [0.7, 1.1]]),
)
PARTS = (
    Part("mass", 0.0, 0.1),
    Part("mass", 0.25, 0.2, 0.01),
    Part("sprung", 0.45, 0.15, stiffness=30.0, damping=0.02),
    Part("mass", 1.0, 0.3, 0.02),
)


def reference(name: str) -> float:
    return next(float(value.printed) for value in ISSUE if value.name == name)


def hermite(table: Table, parts: tuple[Part, ...], alpha: float = 0.0, gain: float | None = None) -> Beam:
    """The same as data of the reference; the share of the mass ahead is summed here, station by station."""
    total = float(np.diff(table.x) @ table.mass.mean(axis=1)) + sum(part.mass for part in parts)
    segments, before = [], 0.0
    x = [Q(value) for value in table.x.tolist()]
    places = sorted({*x, *(Q(part.x) for part in parts)})
    for low, high in pairwise(places):
        k = int(np.searchsorted(table.x, float(low + high) / 2)) - 1
        a, h = table.x[k], table.x[k + 1] - table.x[k]
        EI, m = ((of[k, 0], (of[k, 1] - of[k, 0]) / h) for of in (table.bending, table.mass))
        before += sum(part.mass for part in parts if part.x == float(low))

        def linear(s: Any, of: Any = EI, a: Any = a) -> Any:
            return of[0] + of[1] * (s - a)

        def mass(s: Any, of: Any = m, a: Any = a) -> Any:
            return of[0] + of[1] * (s - a)

        def axial(s: Any, P: Any, of: Any = m, a: Any = a, low: Any = float(low), before: Any = before) -> Any:
            ahead = before + of[0] * (s - low) + of[1] * ((s - a) ** 2 - (low - a) ** 2) / 2
            return P * ahead / total

        segments.append(Segment(low, high, linear, mass, axial=axial))
        middle = (low + high) / 2
        before += float(high - low) * mass(float(middle))
    terms: list[Term] = [follower()]
    if gain is not None:
        terms.append(Term(At("y", Q(1)), At("slope", Q(3, 10)), stiffness=lambda P: gain * P))
    for part in parts:
        y, slope = At("y", Q(part.x)), At("slope", Q(part.x))
        if part.kind == "mass":
            terms += energy([(y, 1)], Q(part.mass)) + energy([(slope, 1)], Q(part.rotary))
        elif part.kind == "sprung":
            w = At("q", Q(part.x))  # its motion beside the beam, which rigid motion leaves at 0
            terms += energy([(y, 1), (w, 1)], Q(part.mass))
            terms += energy([(w, 1)], Q(0), Q(part.damping), Q(part.stiffness))
            # V = P (m / total) w y′: the thrust's share of the mass, which the beam carries beside its axis
            share = part.mass / total
            terms += [Term(a, b, stiffness=lambda P, share=share: share * P) for a, b in ((w, slope), (slope, w))]
    return Beam(tuple(segments), ("free", "free"), tuple(terms), Q(alpha), rigid=2 if gain is None else 1)


def lowest(values: Any, count: int) -> Any:
    values = np.asarray(values, dtype=complex)
    values = values[np.argsort(np.abs(values))][: 2 * count]
    return values[np.lexsort((values.imag, np.round(values.real, 6), np.round(np.abs(values), 6)))]


@pytest.mark.parametrize("degree", [11, 13])
def test_a_uniform_table_is_the_papers_beam(degree: int) -> None:
    beam, table = fb.column("free-free", "legendre"), tabulated(UNIFORM)
    one, two = fb.critical_load(beam, 24), fb.critical_load(table, degree)
    assert (two.load, two.kind) == (pytest.approx(one.load, rel=1e-12), one.kind)
    given = {"load": 60.0, "alpha": 1e-3, "beta": 0.1}
    wanted, found = (fb.spectrum(c.system(n, **given)).elastic for c, n in ((beam, 24), (table, degree)))
    np.testing.assert_allclose(lowest(found, 4), lowest(wanted, 4), rtol=1e-8)
    damped = [fb.critical_load(c, n, alpha=1e-3, beta=0.1).load for c, n in ((beam, 24), (table, degree))]
    assert damped[1] == pytest.approx(damped[0], rel=1e-9)


def test_reference_values_of_a_point_mass_and_of_beals_control() -> None:
    found = fb.critical_load(tabulated(UNIFORM, (Part("mass", 0.0, 0.5),)), 11)
    assert (found.load, found.kind) == (
        pytest.approx(reference("free-free with a point mass"), rel=1e-12),
        "divergence",
    )
    for place in (Q(0), Q(1, 4), Q(1, 2), Q(1)):
        steered = tabulated(UNIFORM, (), Law(float(place)))
        for degree in (8, 9, 11):  # near the divergence rounding must not split the highest frequencies
            found = fb.critical_load(steered, degree, gain=0.1)
            assert found.kind == "divergence"
            assert found.load == pytest.approx(reference(f"beal, sensor at {place}"), rel=1e-11)


@pytest.mark.parametrize("gain", [None, 0.4])
@pytest.mark.parametrize("load", [5.0, 25.0])
def test_hermites_elements_have_the_same_eigenvalues(gain: float | None, load: float) -> None:
    column = tabulated(TABLE, PARTS, None if gain is None else Law(0.3))
    own = {} if gain is None else {"gain": gain}
    found = fb.spectrum(column.system(8, load, **own)).elastic
    matrices = elements.assemble(hermite(TABLE, PARTS, gain=gain), 60)
    wanted = 1 / np.linalg.eigvals(elements.state(matrices, load))
    np.testing.assert_allclose(lowest(found, 4), lowest(wanted, 4), rtol=2e-6, atol=1e-6)


def test_timoshenkos_elements_have_the_same_eigenvalues() -> None:
    """But for the share of rotary inertia in the shear force, which is as small as `left_out` says."""
    GA, J = 400.0, 2e-4
    column = tabulated(replace(UNIFORM, shear=GA * ONE, rotary=J * ONE))
    found = fb.spectrum(column.system(11, 40.0))
    beam = Beam(
        (Segment(axial=lambda x, P: P * x, rotary=lambda x: J + 0 * x),), ("free", "free"),
        (follower(),), shear=Q(GA),
    )  # fmt: skip
    matrices = elements.assemble(beam, 60)
    wanted = np.linalg.eigvals(np.linalg.solve(matrices.stiffness(40.0) + 300 * matrices.M, matrices.M))
    wanted = np.sort(1 / wanted.real[wanted.real > 0])[:6] - 300
    wanted = np.sqrt(wanted[wanted > 1.0])[:3]
    mine = np.sort(found.elastic.imag[found.elastic.imag > 0])[:3]
    vectors = found.vectors[:, [int(np.abs(found.eigenvalues - 1j * w).argmin()) for w in mine]]
    frame = column.frame(11)
    assert frame is not None
    kernel: Any = column.kernel
    told = [kernel.left_out(column.basis(11), frame[:, 2:] @ v, 1j * w) for v, w in zip(vectors.T, mine, strict=True)]
    off = np.abs(mine / wanted[:3] - 1)
    assert (off < np.array(told)).all() and off[2] > 0.1 * told[2] and told[2] < 1e-3


def test_rigid_rotation_feels_the_thrust_as_one_body() -> None:
    """Turned as a whole, a vehicle is accelerated across as one body: H (x) = M (1) / mass, whatever hangs on it."""
    joint = Part("joint", 0.4, stiffness=20.0)
    shear = replace(TABLE, shear=50 * TABLE.bending, rotary=0.01 * TABLE.mass)
    for table, parts in ((TABLE, PARTS), (shear, (*PARTS, joint))):
        column = tabulated(table, parts)
        basis = column.basis(3)
        total = column.kernel.total  # type: ignore[attr-defined]
        np.testing.assert_allclose(basis.H[:, 1], basis.M[:, 0] / total, atol=1e-13)
        np.testing.assert_allclose(basis.H[:, 0], 0, atol=1e-13)
        assert total == pytest.approx(basis.M[0, 0], rel=1e-14)


def test_more_stations_on_the_same_lines_change_nothing() -> None:
    x = np.array([0.0, 0.1, 0.25, 0.4, STEP, 0.85, 1.0])
    rows = [0, 0, 1, 1, 2, 2]

    def cut(of: Any) -> Any:
        low, high = TABLE.x[rows], TABLE.x[np.array(rows) + 1]
        shares = [(ends - low) / (high - low) for ends in (x[:-1], x[1:])]
        return np.stack([of[rows, 0] * (1 - s) + of[rows, 1] * s for s in shares], axis=1)

    finer = Table(x, cut(TABLE.bending), cut(TABLE.mass))
    one, two = (fb.critical_load(tabulated(table, PARTS), 7, ratio=0.005) for table in (TABLE, finer))
    assert (two.load, two.frequency) == (pytest.approx(one.load, rel=1e-9), pytest.approx(one.frequency, rel=1e-8))


def test_stiff_in_shear_is_euler_and_a_stiff_joint_none() -> None:
    bare = fb.critical_load(tabulated(TABLE), 6).load
    off = [
        fb.critical_load(tabulated(replace(TABLE, shear=ratio * TABLE.bending)), 6).load / bare - 1
        for ratio in (1e4, 1e5)
    ]
    assert off[0] / off[1] == pytest.approx(10, rel=0.02) and abs(off[1]) < 1e-2
    soft = replace(TABLE, shear=500 * TABLE.bending)  # rotary inertia that vanishes leaves none
    alone = fb.critical_load(tabulated(soft), 9).load
    for inertia in (1e-5, 1e-6):
        with_it = fb.critical_load(tabulated(replace(soft, rotary=inertia * TABLE.mass)), 9).load
        assert with_it == pytest.approx(alone, rel=20 * inertia)
    off = [
        fb.critical_load(tabulated(TABLE, (Part("joint", 0.4, stiffness=k),)), 6).load / bare - 1 for k in (1e4, 1e5)
    ]
    assert off[0] / off[1] == pytest.approx(10, rel=0.02) and abs(off[1]) < 1e-2


def test_a_ratio_damps_every_mode_of_the_unloaded_beam_alike() -> None:
    found = fb.spectrum(tabulated(TABLE, PARTS[:2]).system(5, 0.0, ratio=0.01)).elastic
    found = lowest(found, 6)
    np.testing.assert_allclose(-found.real / np.abs(found), 0.01, rtol=1e-7)


def test_a_fast_actuator_follows_at_once() -> None:
    """Eigenvalues move from those of a law without one by 1/ω_a, the load of a divergence not at all."""
    own = {"gain": 0.2, "rate": 0.01, "ratio": 0.01, "alpha": 1e-4}
    wanted, *found = (tabulated(TABLE, PARTS[:2], Law(0.9, frequency)) for frequency in (None, 2e3, 4e3))
    rates = [lowest(fb.spectrum(column.system(5, 20.0, **own)).elastic, 3) for column in (wanted, *found)]
    off = [np.abs(rate - rates[0]) for rate in rates[1:]]
    np.testing.assert_allclose(off[0] / off[1], 2, rtol=0.05)
    loads = [fb.critical_load(column, 5, **own) for column in (wanted, *found)]
    assert {loss.kind for loss in loads} == {"divergence"}
    assert [loss.load for loss in loads] == pytest.approx([loads[0].load] * 3, rel=1e-11)
    assert max(loss.rounding for loss in loads) < 1e-11  # a rotation without stiffness of its own is scaled by its mass


def test_one_spring_to_the_ground_is_refused_and_two_hold_the_beam() -> None:
    spring = Part("spring", 0.0, stiffness=1e7)
    with pytest.raises(InputError, match="one spring"):
        tabulated(UNIFORM, (spring,))
    held = tabulated(UNIFORM, (spring, replace(spring, x=1.0)))
    assert held.rigid_count == 0
    pinned = fb.spectrum(held.system(9, 0.0)).eigenvalues
    assert np.abs(pinned).min() == pytest.approx(np.pi**2, rel=1e-4)


def test_a_few_stations_stated_in_the_language_have_the_same_load(tmp_path: Path) -> None:
    """The same vehicle as a user would state it: two tapers with a step between, a point mass and a sprung mass."""
    text = """
from sympy import Piecewise, Rational
from freebeam_derive.notation import P, t, x, y
from freebeam_derive.statement import Column, Coordinate, at, delta, integral

half, q = Rational(1, 2), Coordinate("q")
EI = Piecewise((1 + x, x < half), (3 - x, True))
ahead = Piecewise((1 + x, x < half), (2 + x, True)) / 3
gap = at(y, half) - q
column = Column(
    name="stated", title="Two tapers",
    T=integral(y.diff(t) ** 2) / 2 + at(y.diff(t), 0) ** 2 / 2 + q.diff(t) ** 2 / 2,
    V=integral(EI * y.diff(x, 2) ** 2) / 2 + 40 * gap**2 / 2,
    W_c=P * integral(ahead * y.diff(x) ** 2) / 2 + P / 3 * gap * at(y.diff(x), half),
    dW_nc=-P * at(y.diff(x), 1) * at(delta(y), 1), ends=("free", "free"), parameters=(),
)
"""
    file = tmp_path / "stated.py"
    file.write_text(text, encoding="utf-8")
    stated = fb.critical_load(fb.column(file), 10)
    table = Table(np.array([0.0, 0.5, 1.0]), np.array([[1.0, 1.5], [2.5, 2.0]]), np.ones((2, 2)))
    parts = (Part("mass", 0.0, 1.0), Part("sprung", 0.5, 1.0, stiffness=40.0))
    found = fb.critical_load(tabulated(table, parts), 9)
    assert (found.load, found.kind) == (pytest.approx(stated.load, rel=1e-9), stated.kind)
    assert found.frequency == pytest.approx(stated.frequency, rel=1e-7)
