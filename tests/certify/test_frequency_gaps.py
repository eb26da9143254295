"""Gaps between frequencies without load, proven of variable sections and masses, and the proofs that stand on them."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from flint import arb

import freebeam as fb
from freebeam import cli
from freebeam_derive.certify import beam_itself, beam_stability, frequency_gaps
from freebeam_derive.certify.balls import precision
from freebeam_derive.certify.exact_system import ExactSystem
from freebeam_derive.certify.frequency_gaps import FrequencyGaps
from freebeam_derive.certify.strips import NoStrips
from freebeam_derive.certify.variable_section import VariableSection

BITS = 64
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
    return np.sqrt(np.sort(np.linalg.eigvals(np.linalg.solve(M, E)).real))[:count]


@pytest.mark.parametrize("name", CASES)
def test_the_gaps_of_high_frequencies_are_no_wider_than_they_are(name: str) -> None:
    it = system(*CASES[name])
    omega = frequencies(it, 22)
    with precision(BITS):
        section = VariableSection(it.kernel, it.own)
        known = [(k, *map(float, section.far_gap(k))) for k in (2, 3, 4, 5, 6, 8, 10, 12, 16, 20)]
    begun = [gap for *_, gap in known if gap > 0]
    assert len(begun) > 5 and begun == sorted(begun)  # once known they grow
    for k, R, gap in known:
        if gap:
            assert omega[k - 1] < np.sqrt(R) - gap / 2.01 and np.sqrt(R) + gap / 2.1 < omega[k]


@pytest.mark.parametrize("name", CASES)
def test_the_load_is_no_larger_than_its_bound(name: str) -> None:
    """‖M^(−1/2) H A^(−1/2)‖ of a series is at most C, and C is not idle."""
    it = system(*CASES[name])
    M, E, K = matrices(it, 16)
    left, right = (np.linalg.inv(np.linalg.cholesky(part)) for part in (M, E))
    size = np.linalg.norm(left @ (K - E) @ right.T, 2)
    with precision(BITS):
        bound = float(VariableSection(it.kernel, it.own).load_size)
    assert size * (1 - 1e-12) <= bound < 2 * size  # rounding of the series


def test_the_energy_of_a_variable_section_is_that_of_a_uniform_beam_and_a_remainder() -> None:
    """∫ EI y''² dx = c⁴ (∫ w''² dz + T(w, w)) for y = ρ w, w = z² − z³/2, by quadrature."""
    it = system("cone", {"tau": "0.6"})
    nodes, weights = np.polynomial.legendre.leggauss(24)
    nodes, weights = (nodes + 1) / 2, weights / 2
    with precision(BITS):
        section = VariableSection(it.kernel, it.own)
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
    assert abs(energy / (c**4 * (uniform + rest)) - 1) < 1e-9


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


PROVEN: dict[str, tuple[str, dict[str, str]]] = {
    "Pflueger": ("pflueger", {}),
    "a spring, divergence": ("tip-spring", {"k": "40"}),
}


@pytest.mark.parametrize("name", PROVEN)
def test_the_first_loss_of_stability_is_proven_beyond_the_textbook(name: str) -> None:
    column, own = PROVEN[name]
    found = fb.exact_load(fb.column(column), digits=20, **own)
    assert all(found.proof.values()) and found.missing == "" and found.certificate is None
    assert found.evidence is not None and found.evidence["reach"] > float(found.load[0])  # type: ignore[index]


REFUSED: dict[str, tuple[str, dict[str, Any], str]] = {
    "two segments": ("point-mass", {}, "frequency gaps: point-mass is more than one segment"),
    "rotary inertia": ("pflueger", {"J": "0.1"}, "more than one mass at its ends"),
    "damping": ("pflueger", {"beta": "0.5"}, "damping: with it"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_is_not_served_is_named(name: str) -> None:
    column, own, message = REFUSED[name]
    found = fb.exact_load(fb.column(column), **own)
    assert found.proof["crossing"] and not found.proof["first"] and message in found.missing


def test_a_load_on_an_end_without_a_mass_is_not_bounded() -> None:
    """The same forms with ends (test, trial) of a dead load: |v(1)| is not bounded by the mass of v."""
    it = system("pflueger", {"mu": "0"})
    with precision(BITS):
        section = VariableSection(it.kernel, it.own)
        section.load_points = {}  # −∫ v' y' dx alone
        with pytest.raises(NoStrips, match="acts on an end that carries no mass"):
            _ = section.load_size


def test_no_certificate_is_written_that_the_verifier_could_not_check(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    file = tmp_path / "proof.json"
    arguments = ["critical", "--column", "pflueger", "--digits", "12", "--exact", "--certificate", str(file)]
    assert cli.main(arguments) == 2 and not file.exists()
    assert "the verifier checks no proof by frequency gaps" in capsys.readouterr().err


# ------------------------------------------------------------ broken steps


def missing(monkeypatch: pytest.MonkeyPatch, thing: Any, name: str, wrong: Any) -> str:
    it = system("pflueger", {})
    crossing = beam_itself.flutter_undamped(it, (16.212, 6.27), 20)
    monkeypatch.setattr(thing, name, wrong)
    found, evidence, why = beam_stability.complete(it, crossing, Fraction(0), Fraction(0))
    assert evidence is None and not found.proof.first
    return why


def test_half_the_load_proves_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    """Half of C lets m = 1, whose one eigenvalue meets another below R₁."""
    right = VariableSection._size
    wrong = lambda self, turned: right(self, turned) / 2  # noqa: E731
    assert missing(monkeypatch, VariableSection, "_size", wrong).startswith("low frequencies")


def test_a_line_on_the_wrong_side_of_a_frequency_proves_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    right = VariableSection.far_gap
    wrong = lambda self, k: right(self, k - 1) if k > 3 else (arb(1), arb(0))  # noqa: E731
    assert "could not be enclosed" in missing(monkeypatch, VariableSection, "far_gap", wrong)


def test_a_frequency_left_out_proves_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    right = FrequencyGaps.estimates
    wrong = lambda self, P, count: np.delete(right(self, P, count + 1), 1)  # noqa: E731
    assert "could not be enclosed" in missing(monkeypatch, FrequencyGaps, "estimates", wrong)


def test_gaps_that_are_too_narrow_are_not_taken(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(frequency_gaps, "MOST", 3)
    with precision(BITS), pytest.raises(NoStrips, match="wide enough"):
        FrequencyGaps(system("pflueger", {}), arb(100))
