"""Section 5, Conclusions: what is said there and not in section 4."""

from __future__ import annotations

import numpy as np
import pytest

import freebeam as fb


@pytest.mark.parametrize(("alpha", "beta"), [(1e-3, 0.0), (0.0, 0.1), (1e-3, 0.1)])
def test_damping_of_either_kind_ends_the_oscillation_and_without_it_it_persists(alpha: float, beta: float) -> None:
    column = fb.column("free-free")

    def late(alpha: float, beta: float) -> float:
        """Peak over the last of five spans of time, relative to the first."""
        response = fb.respond(column.system(8, 9.0, alpha, beta), 200.0, 0.01, sensors=[0.1])
        spans = [np.abs(span).max() for span in np.array_split(response.y[:, 0], 5)]
        return float(spans[-1] / spans[0])

    assert late(alpha, beta) < 1e-3
    assert late(0.0, 0.0) == pytest.approx(1, abs=0.02)


@pytest.mark.parametrize(("alpha", "beta"), [(0.0, 0.0), (1e-6, 0.0), (0.1, 0.0), (0.0, 1.0), (1e-3, 0.1), (0.1, 1.0)])
def test_critical_loads_cause_flutter(alpha: float, beta: float) -> None:
    """The pair that grows just above the load oscillates, and no eigenvalue is zero."""
    column = fb.column("free-free")
    found = fb.critical_load(column, alpha=alpha, beta=beta)
    values = fb.spectrum(column.system(8, 1.01 * found.load, alpha, beta)).eigenvalues
    growing = values[values.real > 1e-9]
    assert found.kind == "flutter" and len(growing) == 2
    assert growing[0] == pytest.approx(np.conj(growing[1])) and abs(growing[0].imag) > 1
