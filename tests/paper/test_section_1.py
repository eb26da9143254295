"""Section 1, Introduction: what it says of kinds of instability."""

from __future__ import annotations

import numpy as np
import pytest

import freebeam as fb


def growing(system: fb.System) -> np.ndarray:
    values = fb.spectrum(system).eigenvalues
    return values[values.real > 1e-6]


@pytest.mark.parametrize(("name", "own"), [("euler-pinned", {}), ("beck", {"eta": 0.0})])
def test_a_dead_axial_force_causes_divergence(name: str, own: dict[str, float]) -> None:
    """It "normally causes the static instability (divergence)": an eigenvalue grows without oscillating."""
    column = fb.column(name, "modes")
    found = fb.critical_load(column, **own)
    assert found.kind == "divergence"
    for alpha, beta in ((0.0, 0.0), (0.01, 0.2)):
        above = growing(column.system(8, 1.01 * found.load, alpha, beta, **own))
        assert len(above) == 1 and above.imag == 0
        assert not len(growing(column.system(8, 0.99 * found.load, alpha, beta, **own)))


@pytest.mark.parametrize("name", ["free-free", "beck"])
def test_undamped_flutter_is_where_the_two_lowest_frequencies_meet(name: str) -> None:
    """As section 1 defines flutter, and as it reports of Beal (1965)."""
    column = fb.column(name, "modes")
    load = fb.critical_load(column).load

    def frequencies(P: float) -> np.ndarray:
        values = fb.spectrum(column.system(8, P)).eigenvalues
        return np.sort(values.imag[values.imag > 0])

    gaps = []
    for distance in (1e-2, 1e-4, 1e-6):
        w = frequencies(load * (1 - distance))
        assert len(w) == 8
        gaps.append(w[1] - w[0])
        assert w[1] - w[0] < 0.2 * (w[2] - w[1])
    # they meet as a square root does: the gap falls by 10 where the distance falls by 100
    np.testing.assert_allclose(np.array(gaps[:-1]) / gaps[1:], 10, rtol=0.02)
    assert len(growing(column.system(8, load * (1 + 1e-6)))) == 2


def test_flutter_with_internal_damping_is_no_coalescence() -> None:
    """The definition does not hold for section 4.2's 88.2: there one pair crosses, its frequency far from the next."""
    column = fb.column("free-free")
    found = fb.critical_load(column, alpha=1e-6)
    assert found.kind == "flutter"
    values = fb.spectrum(column.system(8, found.load, 1e-6)).eigenvalues
    frequencies = np.sort(values.imag[values.imag > 0])
    assert frequencies[0] == pytest.approx(found.frequency, rel=1e-6)
    assert frequencies[1] > 2 * frequencies[0]
    assert len(growing(column.system(8, 1.2 * found.load, 1e-3))) == 2  # one conjugate pair
