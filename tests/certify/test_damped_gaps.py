"""Damping beyond the uniform beam: the constants of Lemmas 10 and 11 above what they bound, and the proofs on them.

    python -m tests.certify.test_damped_gaps

proves the table in docs/theorem.md again, in a minute and a half.
"""

from __future__ import annotations

from fractions import Fraction
from itertools import permutations
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from flint import acb, acb_mat, arb
from scipy.linalg import eig, eigh
from scipy.optimize import minimize_scalar

import freebeam as fb
from freebeam_derive.certify import beam_cells, beam_itself, beam_stability, damped_gaps
from freebeam_derive.certify.balls import Range, Unproven, precision
from freebeam_derive.certify.beam_cells import Cells
from freebeam_derive.certify.beam_itself import Damped
from freebeam_derive.certify.column_forms import ColumnForms
from freebeam_derive.certify.damped_gaps import LeftOver
from freebeam_derive.certify.exact_system import ExactSystem
from freebeam_derive.certify.local_series import Local
from freebeam_derive.certify.stepped_section import motion
from freebeam_derive.certify.strips import NoStrips
from freebeam_derive.certify.taylor_steps import Jets
from tests.certify.test_frequency_gaps import table
from tests.reference import elements
from tests.reference.systems import At, Beam, Segment, energy, follower, uniform

BITS = 64
# column, own parameters, alpha, beta, a load up to which Lemma 11 is asked for
CASES: dict[str, tuple[str, dict[str, str], str, str, float]] = {
    "mass undamped": ("pflueger", {}, "0", "0.5", 16.13),
    "rotary inertia": ("pflueger", {"J": "0.1"}, "0.01", "0.1", 8.0),
    "weight undamped": ("beck-self-weight", {"g": "2"}, "0.01", "0.1", 12.0),
    "mass per length": ("step", {"s": "1", "r": "1.5"}, "0.01", "0.5", 12.0),
}


class Series:
    """A column as its proofs see it, and as a series: modes without load, orthonormal, and forms on them."""

    def __init__(self, name: str, own: dict[str, str], alpha: str, beta: str, load: float) -> None:
        kernel = fb.column(name).kernel
        self.still = ExactSystem(kernel, {key: Fraction(value) for key, value in own.items()})
        self.alpha, self.beta, self.load = Fraction(alpha), Fraction(beta), arb(load)
        forms = ColumnForms(kernel, self.still.own)
        self.left = LeftOver(forms, kernel, self.still.own, self.alpha, self.beta)
        self.found = damped_gaps.damped_gaps(self.still, self.load, self.alpha, self.beta, False)
        floats = {key: float(value) for key, value in self.still.own.items()}
        basis = kernel.basis(34)
        M, E, K = kernel.mass(basis, 0.0, **floats), *(kernel.stiffness(basis, P, **floats) for P in (0.0, 1.0))
        C = kernel.damping(basis, 0.0, float(self.alpha), float(self.beta), **floats)
        of_inverse, modes = eigh(M, E)
        order = np.argsort(-of_inverse)
        self.omega = of_inverse[order] ** -0.5
        modes = modes[:, order] * self.omega  # M-orthonormal
        self.B, self.C = (modes.T @ part @ modes for part in (K - E, C))
        self.R = self.C - float(self.left.c_E) * np.diag(self.omega**2) - float(self.left.c_M) * np.eye(len(order))


@pytest.fixture(scope="module", params=CASES)
def series(request: pytest.FixtureRequest) -> Series:
    with precision(BITS):
        return Series(*CASES[request.param])


def test_what_damping_leaves_over_is_within_its_bounds(series: Series) -> None:
    size, turning = float(series.left.size), float(series.left.turning)
    few = slice(0, 20)
    if turning == 0:
        values = np.linalg.eigvalsh(series.R[few, few])
        low = min(float(v.lower()) for v in (series.left.low, *series.left.at.values()))
        assert values.min() > low - 1e-9 and abs(values).max() <= size + 1e-9
    else:
        felt = np.linalg.norm(series.R[few, few] / series.omega[few], 2)
        assert felt <= turning * (1 + 1e-9) and turning < 4 * felt


def test_the_share_of_point_masses_is_above_that_of_each_mode(series: Series) -> None:
    (forms,) = series.left.forms
    if not forms.masses:
        pytest.skip("without masses")
    # their share falls with every frequency as a mass grows: d ln ω² / d ln m
    name = "mu" if (Fraction(1), 1) not in forms.masses else "J"
    base = {key: float(value) for key, value in series.still.own.items()}
    kernel, squares = series.still.kernel, []
    basis = kernel.basis(34)
    for factor in (1 - 1e-4, 1 + 1e-4):
        floats = base | {name: base[name] * factor}
        M, E = kernel.mass(basis, 0.0, **floats), kernel.stiffness(basis, 0.0, **floats)
        squares.append(1 / eigh(M, E, eigvals_only=True)[::-1])
    shares = np.abs(np.log(squares[1] / squares[0]))[:10] / 2e-4
    with precision(BITS):
        bounds = [float(series.left.share(arb(w))) for w in series.omega[:10]]
    assert all(0 < share <= bound for share, bound in zip(shares, bounds, strict=True)) and min(bounds) < 0.7


def test_eigenvalues_are_in_their_discs_and_their_vectors_near_the_modes(series: Series) -> None:
    """Of A + p B + q R at factors of the largest modulus; R₁ with the share of q that internal damping leaves it."""
    found, left = series.found, series.left
    with precision(BITS):
        m = found.lowest
        X, g = (float(f) for f in (damped_gaps._load(found.gaps, left, m, series.load, False), found.gaps.gap(m)))
        C = float(found.gaps.size)
        omega_m = float(found.gaps.frequency(m)) + g
        r = g / omega_m
        sigma = X * max((1 + r) / (g * (2 + r) - X), 1 / (g * (2 - r) - X))
        blur, k = sigma / (1 - sigma**2) ** 0.5, 1 / (1 - 2 * sigma**2)
        least = float(left.least(arb(omega_m), arb(blur)))
    assert 2 * X < g and 2 * sigma**2 < 1
    load, c_E, size = float(series.load), float(left.c_E), float(left.size)
    furthest = 0.0
    for turn in (0, 0.7, 2.2, np.pi):
        for rate in (0.3, np.pi / 2):
            q = np.exp(1j * rate)
            for j in range(m, m + 4):
                w = series.omega[j]
                length = 1 / c_E if left.turning > 0 else w * (1 + X / w) ** 0.5
                S = np.diag(series.omega**2) + load * np.exp(1j * turn) * series.B + q * length * series.R
                values, z, u = eig(S, left=True)
                at = np.argmin(abs(values - w**2))
                furthest = max(furthest, abs(values[at] - w**2) / (X * w))
                inner = z[:, at].conj() @ u[:, at]
                assert abs(z[:, at].conj() @ series.B @ u[:, at] / inner) <= C * w * k * (1 + 1e-9)
                if not left.turning > 0:
                    felt = (z[:, at].conj() @ series.R @ u[:, at] / inner).real
                    assert least - 1e-9 <= felt <= size * k + 1e-9
    assert 0.4 < furthest <= 1  # and the bound is not idle


def test_the_share_of_the_load_is_above_that_in_a_series_and_not_idle(series: Series) -> None:
    """Of X in the limit of vanishing damping: ‖p B Ω⁻¹‖."""
    size = float(series.load) * np.linalg.norm(series.B / series.omega, 2)
    with precision(BITS):
        X = float(damped_gaps._load(series.found.gaps, series.left, series.found.lowest, series.load, True))
    assert size <= X * (1 + 1e-6) < 1.2 * size  # rounding of the series


def test_no_high_eigenvalue_reaches_the_axis(series: Series) -> None:
    """Of the series, at loads up to the one of Lemma 11; the low ones do at some."""
    m, n = series.found.lowest, len(series.omega)
    edge = float(series.found.gaps.line(m))
    c_E, c_M = float(series.left.c_E), float(series.left.c_M)
    for share in (0, 0.5, 1):
        K = np.diag(series.omega**2) + share * float(series.load) * series.B
        values = np.linalg.eigvals(np.block([[np.zeros((n, n)), np.eye(n)], [-K, -series.C]]))
        values = values[(values.imag > 0) & (values.imag < series.omega[12])]
        squares = -(values**2 + c_M * values) / (1 + c_E * values)
        high = values[squares.real > edge]
        assert len(high) > 0 and high.real.max() < 0


@pytest.mark.parametrize(("name", "key", "place"), [("elastic-root", "c", (0, 1)), ("tip-spring", "k", (1, 0))])
def test_what_damping_takes_where_no_mass_is_is_within_its_bound(name: str, key: str, place: tuple[int, int]) -> None:
    """In the limit, of modes at a load; and of any motion with a mass of 1 and an energy of ω²."""
    kernel, load = fb.column(name).kernel, 6.0
    stiff = {p["name"]: p["default"] for p in kernel.COLUMN["parameters"]}[key]
    with precision(BITS):
        found = damped_gaps.damped_gaps(ExactSystem(kernel, {}), arb(load), Fraction(1), Fraction(1), True)
    basis, left, m = kernel.basis(34), found.damping, found.lowest
    M, E, K = kernel.mass(basis, 0.0), *(kernel.stiffness(basis, P) for P in (0.0, load))
    softer = kernel.stiffness(basis, 0.0, **{key: stiff - 1})
    of_inverse, modes = eigh(M, E)
    omega = of_inverse[::-1] ** -0.5
    modes = modes[:, ::-1] * omega
    B, one = modes.T @ (K - E) @ modes, modes.T @ (E - softer) @ modes  # y⁽ⁱ⁾ v⁽ⁱ⁾ at the place
    values, z, u = eig(np.diag(omega**2) + B, left=True)
    at_place = np.sqrt(np.diag(one)) * np.sign(one[0])
    ((where, f),) = left.bare.items()
    assert where == place and f == -stiff
    X, g = load * float(found.gaps.size), float(found.gaps.gap(m))
    for j in range(m, m + 3):
        w, at = omega[j], np.argmin(abs(values - omega[j] ** 2))
        r = g / w
        sigma = X * max((1 + r) / (g * (2 + r) - X), 1 / (g * (2 - r) - X))
        felt = stiff * (z[:, at].conj() @ one @ u[:, at] / (z[:, at].conj() @ u[:, at])).real
        energy = at_place[:30] / (1 + (omega[:30] / w) ** 2)  # of all motions it has the most there for both together
        norm = max(energy @ energy, energy @ (omega[:30] ** 2 * energy) / w**2) ** 0.5
        with precision(BITS):
            square = motion(left._parts, arb(w, w * 1e-9), place)
            most, reach = (
                left.taken(arb(w), arb(sigma / (1 - sigma**2) ** 0.5), arb(r), arb(w)),
                damped_gaps._reach(left.forms[0], Fraction(place[0]), place[1], arb(w)),
            )
            assert left.taken(arb(w), arb(0), arb(r)) > left.taken(arb(2 * w), arb(0), arb(r / 2)) / 2
        assert float(square.mid()) == pytest.approx(one[j, j], rel=1e-5) and float(square.rad()) < 1e-4 * one[j, j]
        assert 0.05 * w * float(most) < felt <= w * float(most)
        assert 0.4 * float(reach) < abs(at_place[:30] @ energy) / norm <= float(reach)


def test_the_factor_of_a_bound_that_is_too_small_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    """Half of X puts an eigenvalue outside of its disc."""
    right = damped_gaps._load
    with precision(BITS):
        series = Series(*CASES["mass per length"])
    monkeypatch.setattr(damped_gaps, "_load", lambda *given: right(*given) / 3)
    with pytest.raises(AssertionError):
        test_eigenvalues_are_in_their_discs_and_their_vectors_near_the_modes(series)


REFUSED: dict[str, tuple[str, dict[str, Any], str]] = {
    "a spring without internal damping": ("elastic-root", {"alpha": "0.01"}, "where no mass is"),
    "bending": ("step", {"alpha": "0.01"}, "not the bending stiffness times a number"),
    "a part undamped": ("partial-damping", {}, "has a part without damping"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_damping_that_is_not_served_is_named(name: str) -> None:
    column, own, message = REFUSED[name]
    found = fb.exact_load(fb.column(column), **own)
    assert found.proof["crossing"] and not found.proof["first"] and message in found.missing


# ------------------------------------------------------------ the proofs

MASS = energy(((At("y", Fraction(1)), 1),), mass=Fraction(1))
PFLUEGER = Beam(
    (Segment(axial=lambda x, P: P + 0 * x, damping=lambda x: uniform(0.1, x)),),
    terms=(*MASS, follower()),
    alpha=Fraction(1, 100),
)


def damped(alpha: str = "0.01", beta: str = "0.1") -> tuple[ExactSystem, Any, Fraction, Fraction]:
    a, b = Fraction(alpha), Fraction(beta)
    it = ExactSystem(fb.column("pflueger").kernel, {}, a, b)
    return it, beam_itself.flutter_damped(it, a, b, (9.6601, 2.68159), 20), a, b


def test_the_first_loss_with_damping_is_proven_and_is_that_of_elements() -> None:
    found = fb.exact_load(fb.column("pflueger"), alpha="0.01", beta="0.1", digits=12)
    assert all(found.proof.values()) and found.missing == "" and found.load is not None
    independent = elements.first_loss(PFLUEGER, 14.0)
    assert independent is not None and independent.kind == found.kind == "flutter"
    assert abs(float(found.load[0]) / independent.load - 1) < 1e-5


def refused(monkeypatch: pytest.MonkeyPatch, thing: Any, name: str, wrong: Any) -> str:
    it, crossing, a, b = damped()
    monkeypatch.setattr(thing, name, wrong)
    found, evidence, why = beam_stability.complete(it, crossing, a, b)
    assert evidence is None and not found.proof.first
    return why


def test_a_crossing_that_is_not_named_is_not_passed_over() -> None:
    it, crossing, a, b = damped()
    P, frequency = ((Fraction(low), Fraction(high)) for low, high in (("9.64", "9.68"), ("2.66", "2.7")))
    with precision(BITS):
        known = [+crossing.load, +crossing.frequency]
        for boxes in ([known], []):
            cells = Cells(it, 0, +crossing.load, boxes)
            assert cells._with_one_series(Damped(it, a, b), P, frequency, 6) == bool(boxes)


def test_a_cell_left_out_proves_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    right = beam_cells._halves
    monkeypatch.setattr(Cells, "_excluded", lambda self, problem, P, x: None)
    wrong = lambda side: right(side)[:1]  # noqa: E731
    assert "do not cover" in refused(monkeypatch, beam_cells, "_halves", wrong)


def test_a_gap_that_is_too_narrow_is_not_taken(monkeypatch: pytest.MonkeyPatch) -> None:
    right = damped_gaps._load
    wrong = lambda *given: 400 * right(*given)  # noqa: E731
    assert "not known to stay on their side" in refused(monkeypatch, damped_gaps, "_load", wrong)


# ------------------------------------------------------------ series on boxes


def test_the_inverse_of_leading_jets_is_one_order_by_order() -> None:
    """Of two equations that share their accelerations; and no order is blurred by the widths of another."""
    with precision(BITS):
        jets = Jets(acb(3), acb(0, arb(2, 0.25)), ((0, 0), (1, 0), (0, 1), (1, 1), (0, 2)), is_complex=True)
        one, tenth, small = jets.monomial(0, 0), arb("0.1"), arb("0.001")
        pairs = [*zip(one, jets.monomial(1, 1), strict=True)]
        L = {
            (i, j): [(tenth if i != j else 1) * a + small * (i + 1) * b for a, b in pairs]
            for i in range(2)
            for j in range(2)
        }
        whole = jets.whole(L, 2, 2)
        found = jets.inverted(whole, 2)
        product = whole * found
        size = product.ncols()
        assert product.contains(acb_mat(size, size, [int(i == j) for i in range(size) for j in range(size)]))
        assert all(found[i, j].is_zero() for i in range(2) for j in range(2, size))


def test_a_determinant_of_wide_balls_is_not_blown_up() -> None:
    """It is as wide as its products, where quotients by a wide ball would make it a hundred times as wide."""
    draw = np.random.default_rng(2)
    with precision(BITS):
        jets = Jets(arb(1), arb(1), ((0, 0),), is_complex=False)
        for _ in range(10):
            middle = draw.uniform(-1, 1, (3, 3))
            wide = [{j: [arb(float(v), 0.3)] for j, v in enumerate(row)} for row in middle]
            found = jets.determinant([*wide, {3: [arb(7)], 0: [arb(1)]}])[0]
            products = sum(abs(middle[0, i] * middle[1, j] * middle[2, k]) for i, j, k in permutations(range(3)))
            corners = [7 * np.linalg.det(middle + 0.3 * draw.choice([-1, 1], (3, 3))) for _ in range(50)]
            assert all(found.contains(float(v)) for v in corners)
            most = 7 * sum(np.prod([abs(middle[i, o[i]]) + 0.3 for i in range(3)]) for o in permutations(range(3)))
            assert found.rad() <= most - 7 * products + 1e-6


def test_a_series_with_the_rate_of_a_vanishing_damping_is_that_of_the_system() -> None:
    it = ExactSystem(fb.column("pflueger").kernel, {}, Fraction(1), Fraction(0), vanishing=True)
    orders = ((0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (0, 1, 1))
    with precision(BITS):
        local = Local(it, arb(7, 0.5), arb(9, 1), rates=True)
        for place in ((arb("6.7"), arb("9.3")), (arb(7), arb(8))):
            right, found = it.taylor(*place, orders), local.taylor(*place, orders)
            assert all(found[order].contains(right[order].mid()) for order in orders)
            assert float(found[0, 0, 1].rad()) < 1e-3 * abs(float(right[0, 0, 1].mid()))
        with pytest.raises(Unproven, match="outside"):
            local.taylor(arb(6), arb(9), orders)


def test_a_damping_that_is_no_fraction_is_refused() -> None:
    it = ExactSystem(fb.column("pflueger").kernel, {})
    with precision(BITS), pytest.raises(NoStrips, match="no fraction"):
        forms = ColumnForms(it.kernel, it.own)
        LeftOver(forms, it.kernel, it.own, Range(Fraction(0), Fraction(1)), Fraction(0))


@pytest.mark.parametrize(
    ("order", "turns", "cubic"), [(0, True, [1, -1.5, 0, 0.5]), (0, False, [1, 0, -3, 2]), (1, False, [0, 1, -2, 1])]
)
def test_the_share_of_a_mass_is_that_of_a_motion_beside_it(order: int, turns: bool, cubic: list[float]) -> None:
    """At the tip: (‖v‖ + √a(v, v)/ω)² over the mass, ‖v‖² = ∫ m v², of a cubic v with 1 at the tip and 0 a length on;
    of a displacement the length for which that is least where there is no foundation. An axial force and a foundation
    add to a(v, v)."""
    omega, mass, m, EI = 4000.0, 50.0, 2.0, 3.0
    v = np.polynomial.Polynomial(cubic)
    squares = [float((f * f).integ()(1)) for f in (v, v.deriv(), v.deriv(2))]

    def bound(length: float, force: float, foundation: float) -> float:
        factors = (foundation * length, force / length, EI / length**3)
        energy = sum(f * square for f, square in zip(factors, squares, strict=True))
        return length ** (2 * order) * ((m * squares[0] * length) ** 0.5 + energy**0.5 / omega) ** 2 / mass

    for force, foundation in ((0, 0), (1000, 0), (0, 10**6), (1000, 10**6)):
        left: Any = object.__new__(LeftOver)
        elastic = {p: [Fraction(f)] for p, f in ((1, force), (0, foundation)) if f}
        forms: Any = SimpleNamespace(
            masses={(Fraction(1), order): Fraction(mass)}, springs={}, breaks=(Fraction(0), Fraction(1)),
            m=[[Fraction(m)]], EI=[[Fraction(EI)]], elastic=[elastic],
            pieces=lambda: [(0, arb(0).union(arb(1)))], is_held=lambda place, order: not turns,
        )  # fmt: skip
        left.forms = [forms]
        with precision(BITS):
            share = float(left.share(arb(omega)))
        free, here = (
            minimize_scalar(bound, bounds=(1e-3, 0.2), args=f, options={"xatol": 1e-12})
            for f in ((0, 0), (force, foundation))
        )
        assert here.fun * (1 - 1e-9) <= share
        if order == 0:
            assert share == pytest.approx(bound(free.x, force, foundation), rel=1e-6)


def test_beyond_the_highest_frequency_none_is_of_the_low_ones() -> None:
    """For λ = iω and ω from there on Re s ≥ R_m, or what load and damping do is less than 2(|s| − Re s) leaves room."""
    random, ways = np.random.default_rng(3), [0, 0]
    for _ in range(200):
        c_E, load, size, turning = 10 ** random.uniform(-2, [0.5, 2, 0, 0])
        c_M, R = random.uniform(0, 1), 10 ** random.uniform(1, 3)
        gaps: Any = SimpleNamespace(line=lambda _, R=R: arb(R), size=arb(2))
        left: Any = SimpleNamespace(c_E=arb(c_E), c_M=arb(c_M), size=arb(size), turning=arb(turning))
        with precision(BITS):
            top = float(damped_gaps.DampedGaps(gaps, left, 1, arb(0), arb(load), False).top)
        for omega in top * np.array([1, 1.1, 1.5, 2, 10, 1000]):
            s = (omega**2 - 1j * c_M * omega) / (1 + 1j * c_E * omega)
            p, q = load / abs(1 + 1j * c_E * omega), omega / abs(1 + 1j * c_E * omega)
            x = np.linspace(0, 2, 400) * abs(s) ** 0.5
            felt = (2 * p + turning * q) * max(x / abs(x**2 - s)) + size * q * max(1 / abs(x**2 - s))
            assert s.real >= R * (1 - 1e-9) or felt <= 1
            ways[int(s.real < R)] += 1
    assert min(ways) > 100
    left.c_E = arb(0)
    assert float(damped_gaps.DampedGaps(gaps, left, 1, arb(0), arb(load), False).top) == pytest.approx(R**0.5)


if __name__ == "__main__":
    table("## Damping of these columns", "## Theorem 4", 12, "cells")
