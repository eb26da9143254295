"""Gaps between frequencies without load, proven of variable sections and masses, and the proofs that stand on them.

    python -m tests.certify.test_frequency_gaps

proves the table of Lemma 8 in docs/theorem.md again, in half a minute.
"""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from itertools import product
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from flint import acb, arb
from numpy.polynomial import Legendre
from numpy.polynomial.legendre import leggauss
from scipy.linalg import eigh, eigvalsh, null_space

import freebeam as fb
from freebeam_derive.certify import beam_itself, beam_stability, frequency_gaps, stepped_section, variable_section
from freebeam_derive.certify.balls import Unproven, precision
from freebeam_derive.certify.beam import Beam
from freebeam_derive.certify.column_forms import ColumnForms
from freebeam_derive.certify.comparison_form import ORDERS
from freebeam_derive.certify.exact_system import ExactSystem
from freebeam_derive.certify.frequency_gaps import FrequencyGaps
from freebeam_derive.certify.load_size import load_size, size_along
from freebeam_derive.certify.stepped_section import SteppedSection
from freebeam_derive.certify.strips import NoStrips, modes_of
from freebeam_derive.certify.textbook import OfAny, of_any
from freebeam_derive.certify.variable_section import VariableSection, _free
from freebeam_sym.spectra import spectrum
from tests.stated import file_of

BITS = 64
ROUNDING = 1e-9
"""Of quotients with the curvatures of twelve polynomials, in floats: another BLAS left 2e-12."""
CASES: dict[str, tuple[str, dict[str, str]]] = {
    "tip mass": ("pflueger", {}),
    "cone": ("cone", {"tau": "0.3"}),
    "wedge": ("wedge", {}),
    "spring": ("tip-spring", {"k": "30"}),
    "dead load": ("beck-self-weight", {}),
    "hanging": ("beck-self-weight", {"g": "-15"}),
}


def system(name: str, own: dict[str, str]) -> ExactSystem:
    return ExactSystem(fb.column(name).kernel, {key: Fraction(value) for key, value in own.items()})


def matrices(it: ExactSystem, size: int) -> tuple[Any, Any, Any]:
    """M, and K at the loads 0 and 1, of a series."""
    kernel, own = it.kernel, {name: float(value) for name, value in it.own.items()}
    basis = kernel.basis(size)
    return kernel.mass(basis, 0.0, **own), *(kernel.stiffness(basis, P, **own) for P in (0.0, 1.0))


def frequencies(it: ExactSystem, count: int) -> Any:
    M, E, _ = matrices(it, count + 24)
    return 1 / np.sqrt(eigh(M, E, eigvals_only=True)[::-1][:count])


@pytest.mark.parametrize("name", [*CASES, "mass on an end that slides"])
def test_the_gaps_of_high_frequencies_are_no_wider_than_they_are(name: str, tmp_path: Path) -> None:
    slides = {"T": "T + at(y.diff(t), 1) ** 2 / 2", "ends": '("clamped", "sliding")', "dW_nc": "external"}
    it = system(*CASES[name]) if name in CASES else system(str(file_of(tmp_path, "slides", slides)), {})
    omega = frequencies(it, 22)
    with precision(BITS):
        section = VariableSection(ColumnForms(it.kernel, it.own))
        known = [(k, *map(float, section.far_gap(k))) for k in (2, 3, 4, 5, 6, 8, 10, 12, 16, 20)]
    begun = [gap for *_, gap in known if gap > 0]
    assert len(begun) > 5 and begun == sorted(begun)  # once known they grow
    for k, R, gap in known:
        if gap:
            assert omega[k - 1] < np.sqrt(R) - gap / 2.01 and np.sqrt(R) + gap / 2.1 < omega[k]


def test_gaps_of_high_frequencies_are_as_many_times_as_wide_as_is_asked() -> None:
    """Of one part and of more."""
    for name, load in (("pflueger", arb(16)), ("point-mass", arb(1))):
        with precision(BITS):
            gaps = FrequencyGaps(system(name, {}), load, 4)
            assert gaps.gap(gaps.count) > 4 * load * gaps.size


def test_far_gaps_are_in_the_units_of_the_column() -> None:
    """With bending and springs 81 times as stiff each frequency is 9 times as high, and so is each gap."""
    found = []
    for stiff in (1, 81):
        forms: Any = SimpleNamespace(
            kinds=("clamped", "free"), masses={}, m=[[Fraction(4), Fraction(-1)]], elastic=[{0: [Fraction(7 * stiff)]}],
            EI=[[Fraction(3 * stiff), Fraction(-stiff)]], springs={(Fraction(1), 0): Fraction(5 * stiff)},
            pieces=lambda: [(0, (arb(k) / 32).union(arb(k + 1) / 32)) for k in range(32)],
        )  # fmt: skip
        with precision(BITS):
            found.append([*map(float, VariableSection(forms).far_gap(9))])
    (R, gap), stiffer = found
    assert gap > 0 and stiffer == pytest.approx([81 * R, 9 * gap], rel=1e-9)


@pytest.mark.parametrize("name", CASES)
def test_the_load_is_no_larger_than_its_bound(name: str) -> None:
    """‖M^(−1/2) H A^(−1/2)‖ of a series is at most C, and C is not idle."""
    it = system(*CASES[name])
    M, E, K = matrices(it, 16)
    left, right = (np.linalg.inv(np.linalg.cholesky(part)) for part in (M, E))
    size = np.linalg.norm(left @ (K - E) @ right.T, 2)
    with precision(BITS):
        bound = float(load_size(ColumnForms(it.kernel, it.own)).constant)
    assert size * (1 - 1e-12) <= bound < 2 * size  # rounding of the series


def test_the_size_of_a_form_of_slopes_is_above_that_of_a_quarter_wave() -> None:
    """|∫ y' v| ≤ ‖y'‖ ‖v‖, and ‖y'‖ / ‖y''‖ = 2/π for y' = sin(π x/2), the largest of a cantilever."""
    it = system("pflueger", {})
    with precision(BITS):
        bound = float(size_along(ColumnForms(it.kernel, it.own), [{(0, 1): [Fraction(1)]}]))
    assert 2 / np.pi <= bound < 4 / np.pi


@pytest.mark.parametrize("kinds", [("clamped", "free"), ("pinned", "pinned"), ("sliding", "free")])
@pytest.mark.parametrize("k", [4, 20])
def test_the_constants_of_lemma_7_are_above_what_they_bound(kinds: tuple[str, str], k: int) -> None:
    """With Σ D w² = 1: ‖w'‖², ‖w‖² and w, w' at the right end, of 60 modes; the bounds read off what they take away."""
    h, none = arb("0.01"), arb(0)
    with precision(BITS):
        modes = modes_of(kinds, 60, BITS)
        beside = modes.lattice(k), modes.lattice(k + 1)
        G = (beside[0] + beside[1]) / 2

        def free(A: arb, C: arb, ends: dict[tuple[int, int, int], arb]) -> float:
            return float(_free(modes, G, beside, ((A, none, C), ends), kinds))

        least = free(none, none, {})
        bounds = [(1 - free(*given) / least) / 0.01 for given in (
            (h, none, {}), (none, h, {}), (none, none, {(1, 0, 0): h}), (none, none, {(1, 1, 1): h})
        )]  # fmt: skip
        # as the page has them
        t, at_ends = np.pi / 2 - float(modes.spread), [float(v) for v in variable_section._every(kinds, BITS).end]
        W = 1 / (2 * G * t) + (1 + 2 * G / t).log() / (2 * np.pi * G)
        L = 1 / t + (G / t).log() / np.pi
        sums = [float(L / G**3 + W / (2 * G**2)), float(L / (4 * G) + W)]
        slope = (least * (1 - (1 + t / float(G)) ** -4)) ** -0.5
        slope += kinds.count("free") * at_ends[0] * at_ends[1] * (sums[0] * sums[1]) ** 0.5
        told = [slope, 1 / least, *(bound**2 * total for bound, total in zip(at_ends, sums, strict=True))]
        assert least == pytest.approx(float(4 * t * (G - arb.pi() + t) ** 3), rel=1e-9)
        assert bounds == pytest.approx(
            [0 if bound == 0 else of for bound, of in zip(bounds, told, strict=True)], rel=1e-9
        )
        both = (1 - float(_free(modes, G, beside, ((none, h, none), {}), kinds)) / least) / 0.01
        assert both == pytest.approx(2 * (slope / least) ** 0.5, rel=1e-9)
        slopes = np.array(modes.form({(0, 1, 1): 1}, {}).tolist(), dtype=float)
        gamma = np.array([float(g) for g in modes.gamma])
        at_end = [np.array([float(v) for v in modes.derivative(1, d)]) for d in (0, 1)]
        line = float(G) ** 4
    D = abs(gamma**4 - line)
    values = [np.linalg.norm(slopes / np.sqrt(np.outer(D, D)), 2), 1 / D.min(), *((v**2 / D).sum() for v in at_end)]
    assert 0 < least <= D.min() * (1 + 1e-12)
    for bound, value in zip(bounds, values, strict=True):
        assert value <= bound * (1 + 1e-6) + 1e-12 and (bound < 60 * value or value == bound == 0)


def test_the_energy_of_a_variable_section_is_that_of_a_uniform_beam_and_a_remainder() -> None:
    """∫ EI y''² dx = c⁴ (∫ w''² dz + T(w, w)) for y = ρ w, w = z² − z³/2, by quadrature."""
    it = system("cone", {"tau": "0.6"})
    nodes, weights = np.polynomial.legendre.leggauss(24)
    nodes, weights = (nodes + 1) / 2, weights / 2
    with precision(BITS):
        section = VariableSection(ColumnForms(it.kernel, it.own))
        c = float(section.scale)

        def local(x: float) -> list[float]:
            return [float(v) for v in section._local(arb(x))]

        energy = uniform = rest = 0.0
        for x, weight in zip(nodes, weights, strict=True):
            A, B, G, g1, g0, slope, _ = local(x)
            z = x * sum(f * local(x * u)[5] for u, f in zip(nodes, weights, strict=True))
            w, dw, ddw = z**2 - z**3 / 2, 2 * z - 1.5 * z**2, 2 - 3 * z
            rho = (slope / (1 - 0.6 * x) ** 2) ** 0.5
            curvature = rho * slope**2 * (ddw + g1 * dw + g0 * w)
            energy += weight * (1 - 0.6 * x) ** 4 * curvature**2
            uniform += weight * slope * ddw**2
            rest += weight * slope * (A * dw**2 + 2 * B * w * dw + G * w**2)
            # ρ and z' are those of y = ρ w: y''/(ρ z'²) by differences
            h = 1e-3
            y = []
            for at in (x - h, x, x + h):
                z_at = at * sum(f * local(at * u)[5] for u, f in zip(nodes, weights, strict=True))
                y.append((local(at)[5] / (1 - 0.6 * at) ** 2) ** 0.5 * (z_at**2 - z_at**3 / 2))
            assert abs((y[0] - 2 * y[1] + y[2]) / h**2 - curvature) < 1e-3 * (1 + abs(curvature))
        *_, g1, g0, _, _ = local(1.0)
        rest += g1 * 0.5**2 + 2 * g0 * 0.5 * 0.5
        largest, at_ends = section._remainder
        for n, of in enumerate(largest):
            assert max(abs(local(x)[n]) for x in nodes) <= float(of) < 5 * max(abs(local(x)[n]) for x in (0.0, 1.0))
        for end in (0, 1):
            *_, g1, g0, _, _ = local(float(end))
            told = {(end, 1, 1): abs(g1), (end, 0, 1): abs(g0), (end, 1, 0): abs(g0)}
            assert {key: float(f) for key, f in at_ends.items() if key[0] == end} == pytest.approx(told, rel=1e-9)
    assert abs(energy / (c**4 * (uniform + rest)) - 1) < 1e-9


def test_what_springs_along_a_variable_section_add_is_in_the_remainder() -> None:
    """∫ k y² + n y'² dx = c⁴ ∫ (what they add to A w'² + 2B w w' + G w²) dz for y = ρ w: the two densities in x."""
    m, EI = [Fraction(2), Fraction(-3, 2)], [Fraction(3), Fraction(-1), Fraction(-1, 2)]
    springs = {0: [Fraction(5), Fraction(7)], 1: [Fraction(-4), Fraction(6)]}
    forms = [
        SimpleNamespace(kinds=("clamped", "free"), masses={}, m=[m], EI=[EI], elastic=[of]) for of in ({}, springs)
    ]
    with precision(BITS):
        bare, held = (VariableSection(of) for of in forms)  # type: ignore[arg-type]
        c = float(held.scale)
        for x, w, dw in product((0.2, 0.5, 0.9), (1.0, -2.0), (0.0, 3.0)):
            A, B, G = (float(a - b) for a, b in zip(held._local(arb(x))[:3], bare._local(arb(x))[:3], strict=True))

            def rho(at: float) -> float:
                return float((held._local(arb(at))[5] / arb(2 - 1.5 * at)).sqrt())

            rate, h = float(held._local(arb(x))[5]), 1e-4
            slope = rho(x) * rate * dw + (rho(x + h) - rho(x - h)) / (2 * h) * w
            density = (5 + 7 * x) * (rho(x) * w) ** 2 + (-4 + 6 * x) * slope**2
            assert density == pytest.approx(c**4 * rate * (A * dw**2 + 2 * B * w * dw + G * w**2), rel=1e-6)


def test_a_wave_and_its_slope_are_not_both_small() -> None:
    """2 b cos(L γ + φ) and its slope: at any phase one is larger than what is left out, if that is in their ellipse."""
    b, L = 0.5, 3
    for value, slope in ((0.9, 0.3), (0.2, 0.9), (0.9, 0.5), (0.6, 0.9)):
        waves = {(sign,): (acb(0, sign).exp() * b, acb(0)) for sign in (1, -1)}
        rest = arb(2 * b * value), arb(2 * b * L * slope)
        apart = stepped_section._cells_apart(waves, rest, [arb(L)], arb("0.001"), [0])
        assert apart == (value**2 + slope**2 < 1)


@pytest.mark.parametrize(
    "kinds", [("clamped", "free"), ("sliding", "pinned"), ("clamped", "pinned"), ("pinned", "pinned")]
)
def test_displacements_and_slopes_are_bounded_by_the_curvature(kinds: tuple[str, str]) -> None:
    """By the largest quotients over polynomials that meet the conditions: the slope's bound, at its point, within 2."""
    lengths, points = ColumnForms.reach.func(SimpleNamespace(lines=[], kinds=kinds))  # type: ignore[attr-defined]
    basis = [Legendre.basis(n, domain=[0, 1]) for n in range(12)]

    def at(x: Any, order: int) -> np.ndarray:
        return np.array([f.deriv(order)(x) if order else f(x) for f in basis])

    held = np.array([at(end, order) for end, kind in enumerate(kinds) for order in ORDERS[kind] if order < 2])
    free = null_space(held)
    x, weight = leggauss(20)
    x, weight = (x + 1) / 2, weight / 2

    def square(order: int) -> np.ndarray:
        f = free.T @ at(x, order)
        return np.asarray((f * weight) @ f.T)

    for order in (0, 1):
        assert eigvalsh(square(order), square(2))[-1] <= float(lengths[order]) ** 2
        of = [free.T @ at(place, order) for place in np.linspace(0, 1, 41)]
        largest = max(float(f @ np.linalg.solve(square(2), f)) for f in of)
        share = largest / float(points[order]) ** 2  # 1/4 exactly of a slope that is held by two deflections
        assert share <= 1 + ROUNDING and (order == 0 or share >= 0.25 - ROUNDING)
        # with one end that neither bends nor is held again, hardly more than they are: 1/3 beside 4/9
        assert order or kinds not in (("clamped", "free"), ("sliding", "pinned")) or share > 0.7


def test_no_eigenvalue_meets_a_line_for_any_load_up_to_the_reach() -> None:
    it = system("pflueger", {"mu": "1/2"})
    with precision(BITS):
        gaps = FrequencyGaps(it, arb(16))
        lines = {k: float(gaps.line(k)) for k in range(gaps.lowest, gaps.count + 1)}
        reach = float(gaps.reach)
    assert gaps.lowest == 2 and reach > 16
    M, E, K = matrices(it, 24)
    for share in (0.5, 0.98):
        for turn in np.linspace(0, np.pi, 7):
            s = np.linalg.eigvals(np.linalg.solve(M, E + share * reach * np.exp(1j * turn) * (K - E)))
            assert all(np.sum(s.real < R) == k for k, R in lines.items())


def test_starts_of_low_frequencies_keep_their_digits_among_many() -> None:
    gaps: Any = object.__new__(FrequencyGaps)
    gaps.system, gaps._float = system("cone", {}), {"tau": 0.5}
    few, many = (gaps.estimates(0.0, count)[:10].real for count in (10, 40))
    assert np.allclose(few, many, rtol=1e-9) and np.all(np.diff(few) > 0)


@pytest.mark.parametrize("name", ["foundation", "hauger"])
def test_a_textbooks_kernel_read_as_of_any_column_has_the_same_eigenvalues(name: str) -> None:
    """A foundation that shifts the damping, a load with a factor of x. What it is read for is in test_proofs.py."""
    column = fb.column(name)
    dampings = (Fraction(1, 100), Fraction(1, 10)) if column.kernel.COLUMN["damping"] else (Fraction(0),) * 2
    values = spectrum(column.system(modes=14, load=20.0, alpha=float(dampings[0]), beta=float(dampings[1]))).eigenvalues
    near = sorted(values[values.imag > 0], key=abs)[:2]
    assert of_any(column.kernel, {}) is column.kernel
    one, other = (
        beam_itself.frequencies(beam, Fraction(20), *dampings, near, 12)
        for beam in (Beam(column.kernel), ExactSystem(OfAny(column.kernel), {}, *dampings))
    )
    assert all(a.overlaps(b) for a, b in zip(one, other, strict=True))


# ------------------------------------------------------------ uniform parts

PARTS: dict[str, tuple[str, dict[str, str]]] = {
    "rotary inertia": ("pflueger", {"J": "0.1"}),
    "step": ("step", {}),
    "step and mass": ("step", {"a": "0.6", "r": "0.5", "mu": "0.3"}),
    "mass": ("point-mass", {"a": "0.3"}),
    "a root on a spring": ("elastic-root", {"c": "0.2"}),
    "a crack": ("crack", {"k": "2", "a": "0.6"}),
    "a joint": ("shear-joint", {"k": "20", "a": "0.3"}),
}


def parts(name: str, own: dict[str, str]) -> SteppedSection:
    it = system(name, own)
    return SteppedSection(ColumnForms(it.kernel, it.own))


@pytest.mark.parametrize("name", PARTS)
def test_all_frequencies_of_uniform_parts_are_those_of_a_series(name: str) -> None:
    """None is left out, and beyond G² neighbours are as far apart as is said, up to those that the series has."""
    omega = frequencies(system(*PARTS[name]), 30)
    with precision(BITS):
        them = parts(*PARTS[name])
        found = [float(g) ** 2 for g in them.lowest(arb(20))]
        assert 0.1 * omega[0] < them.forms.lowest < omega[0]
        G, gap = map(float, them.gap_beyond(lambda *_: arb(4)))
    assert found[-2] < 400 < found[-1]
    assert np.allclose(found, omega[: len(found)], rtol=1e-9)
    high = omega[omega > G**2]
    assert len(high) > 15 and 4 < gap < np.diff(high).min()
    # of γ as far apart as was looked for, or half of it, …
    share = (np.sqrt(G**2 + gap) - G) * stepped_section.APART * float(sum(them.rates, arb(0))) / np.pi
    assert min(abs(share * 2**k - 1) for k in range(stepped_section.TRIES)) < 1e-9


def test_gaps_are_wider_than_what_grows_with_the_frequency_needs() -> None:
    with precision(BITS):
        them = parts(*PARTS["rotary inertia"])
        G, gap = them.gap_beyond(lambda *_: arb(0))
        rate = 3 * gap / G.sqrt()
        far, wide = them.gap_beyond(lambda _, high: rate * high.sqrt().sqrt())
        assert far > 2 * G and wide > rate * far.sqrt()


@pytest.mark.parametrize("name", PARTS)
def test_waves_and_a_rest_are_the_characteristic_function(name: str) -> None:
    """At some γ, where the rest is not small; and its slope by differences."""
    with precision(BITS):
        them = parts(*PARTS[name])
        for g in (3.0, 7.5):
            waves, (rest, rest_slope) = them._waves(1 / arb(g), arb(g))
            value, slope = map(float, them.value(arb(g)))
            total = turned = 0j
            for wave, B in waves.items():
                turn = sum(sign * float(rate) for sign, rate in zip(wave, them.rates, strict=True))
                unit = np.exp(1j * turn * g)
                total += complex(B[0]) * unit
                turned += (complex(B[1]) + 1j * turn * complex(B[0])) * unit
            assert abs(total.imag) < 1e-12 and 1e-9 < abs(value - total.real) <= float(rest)
            assert 1e-9 < abs(slope - turned.real) <= float(rest_slope)
            if len(them.rates) == 1 and g > 7:  # of one part, where e^(−2γ) is nothing beside e^(−γ), hardly more
                assert float(rest) < 1.05 * abs(value - total.real)
                assert float(rest_slope) < 1.1 * abs(slope - turned.real)
            h = 1e-5
            sides = [float(them.value(arb(g + sign * h))[0]) for sign in (-1, 1)]
            assert abs((sides[1] - sides[0]) / (2 * h) - slope) < 1e-6 * (1 + abs(slope))


def test_a_column_on_two_springs_has_no_frequency_below_the_bound() -> None:
    """Free at both ends, a spring and a mass there; against polynomials."""
    n = np.arange(10)
    power = n[:, None] + n
    M = 1 / (power + 1) + 0.3 * np.outer(n == 0, n == 0)
    bend = np.outer(n * (n - 1), n * (n - 1)) / np.maximum(power - 3, 1)
    K = bend + 2 * np.outer(n == 0, n == 0) + 0.5
    with precision(BITS):
        forms = parts("elastic-root", {}).forms
        forms.kinds, forms.masses = ("free", "free"), {(Fraction(0), 0): Fraction(3, 10)}
        forms.springs = {(Fraction(0), 0): Fraction(2), (Fraction(1), 0): Fraction(1, 2)}
        first = 1 / np.sqrt(eigh(M, K, eigvals_only=True)[-1])
        assert 0.3 * first < forms.lowest < first


def test_parts_that_a_mass_with_a_rotary_inertia_holds_apart_are_refused() -> None:
    """Both halves, clamped where the mass is, may have one high frequency."""
    with precision(BITS):
        them = parts("point-mass", {})
        them.forms.masses[Fraction(1, 2), 1] = Fraction(1, 10)
        with pytest.raises(Unproven, match="not known to be apart"):
            them.gap_beyond(lambda *_: arb(20))
        them = parts("point-mass", {"a": "0.999"})
        with pytest.raises(Unproven, match="so short"):
            them.gap_beyond(lambda *_: arb(20))


REFUSED: dict[str, tuple[str, dict[str, Any], str]] = {
    "a crack and damping": ("crack", {"alpha": "0.01"}, "damping: crack has a joint"),
    "damping": ("tip-damper", {}, "damping: tip-damper has a damper"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_is_not_served_is_named(name: str) -> None:
    column, own, message = REFUSED[name]
    found = fb.exact_load(fb.column(column), **own)
    assert found.proof["crossing"] and not found.proof["first"] and message in found.missing


def test_springs_at_a_tip_are_in_the_remainder() -> None:
    """Of a uniform beam with m and EI: ∫ EI y''² + k y(1)² + c y'(1)² = (EI/m) (∫ w''² + (k w(1)² + c w'(1)²)/EI)."""
    for m, EI, k, c in ((1, 1, 30, 7), (4, 9, 5, 2), (2, 1, 0, 3)):
        springs = {(Fraction(1), order): Fraction(f) for order, f in ((0, k), (1, c)) if f}
        forms: Any = SimpleNamespace(
            kinds=("clamped", "free"), masses={}, springs=springs, m=[[Fraction(m)]], EI=[[Fraction(EI)]], elastic=[{}],
            pieces=lambda: [(0, arb(0).union(arb(1)))],
        )  # fmt: skip
        with precision(BITS):
            along, ends = VariableSection(forms)._remainder
            assert all(float(v) == 0 for v in along)
            assert {key[1:]: float(f) for key, f in ends.items()} == pytest.approx(
                {(order, order): float(f) / EI for (_, order), f in springs.items()}, rel=1e-9
            )


def test_forces_and_sensors_where_an_end_holds_them_are_nothing() -> None:
    for kinds in product(ORDERS, ORDERS):
        forms: Any = object.__new__(ColumnForms)
        forms.kinds, forms.breaks = kinds, (Fraction(0), Fraction(1, 2), Fraction(1))
        every = [(place, order) for place in forms.breaks for order in (0, 1)]
        free = [(x, d) for x, d in every if x == Fraction(1, 2) or d not in ORDERS[kinds[int(x)]]]
        points = [(("y", p, a, 0), ("y", q, b, 0), 1) for (a, p), (b, q) in product(every, every)]
        assert forms.read([], points)[1] == dict.fromkeys(product(free, free), 1)


# ------------------------------------------------------------ broken steps


def missing(monkeypatch: pytest.MonkeyPatch, thing: Any, name: str, wrong: Any, J: str = "0") -> str:
    it = system("pflueger", {"J": J})
    crossing = beam_itself.flutter_undamped(it, (16.212, 6.27) if J == "0" else (8.8697, 4.16), 20)
    monkeypatch.setattr(thing, name, wrong)
    found, evidence, why = beam_stability.complete(it, crossing, Fraction(0), Fraction(0))
    assert evidence is None and not found.proof.first
    return why


def test_half_the_load_proves_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    """Half of C lets m = 1, whose one eigenvalue meets another below R₁."""
    right = frequency_gaps.load_size
    wrong = lambda forms: replace(right(forms), constant=right(forms).constant / 2)  # noqa: E731
    assert missing(monkeypatch, frequency_gaps, "load_size", wrong).startswith("low frequencies")


def test_a_line_on_the_wrong_side_of_a_frequency_proves_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    right = VariableSection.far_gap
    wrong = lambda self, k: right(self, k - 1) if k > 3 else (arb(1), arb(0))  # noqa: E731
    assert "could not be enclosed" in missing(monkeypatch, VariableSection, "far_gap", wrong)


def test_a_frequency_left_out_proves_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    right = FrequencyGaps.estimates
    wrong = lambda self, P, count: np.delete(right(self, P, count + 1), 1)  # noqa: E731
    assert "could not be enclosed" in missing(monkeypatch, FrequencyGaps, "estimates", wrong)


def test_a_frequency_of_parts_left_out_proves_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    right = SteppedSection.lowest
    wrong = lambda self, *given: [g for n, g in enumerate(right(self, *given)) if n != 1]  # noqa: E731
    assert missing(monkeypatch, SteppedSection, "lowest", wrong, "0.1").startswith("low frequencies")


def test_a_wave_left_out_would_prove_too_much() -> None:
    with precision(BITS):
        them = parts("point-mass", {})
        waves, rest = them._waves(arb("0.019").union(arb("0.02")), arb(50))
        both = [0, 1]  # of any two parts
        assert stepped_section._cells_apart(waves, rest, them.rates, arb("0.2"), both)
        assert not stepped_section._cells_apart(waves, rest, them.rates, arb("1.2"), both)
        fewer = {wave: B for wave, B in waves.items() if wave[0] == wave[1]}
        assert stepped_section._cells_apart(fewer, rest, them.rates, arb("1.2"), both)


def test_gaps_that_are_too_narrow_are_not_taken(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(frequency_gaps, "MOST", 3)
    with precision(BITS), pytest.raises(NoStrips, match="wide enough"):
        FrequencyGaps(system("pflueger", {}), arb(100))


def table(head: str, end: str, digits: int, counted: str) -> None:
    """Compute the rows of a table of docs/theorem.md again: those of columns between two of its heads."""
    page = (Path(__file__).parents[2] / "docs" / "theorem.md").read_text(encoding="utf-8")
    for line in page[page.index(head) : page.index(end)].splitlines():
        if line.startswith("| `"):
            said, load, kind, lowest, count = [cell.strip(" `") for cell in line.split("|")[1:6]]
            name, *own = said.split()
            found = fb.exact_load(fb.column(name), digits=digits, **dict(item.split("=") for item in own))  # type: ignore[arg-type]
            assert all(found.proof.values()) and found.load is not None and found.evidence is not None
            numbers = found.evidence["lowest"], found.evidence[counted]
            assert found.load[0].startswith(load) and (found.kind, *numbers) == (kind, int(lowest), int(count))
            print(said, found.load[0])


if __name__ == "__main__":
    table("## Variable sections", "## Damping of these columns", 20, "stretches")
