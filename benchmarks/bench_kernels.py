"""All matrices of a column at N = 8: the emitted kernels against quadrature with the modes at hand."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import freebeam as fb
from freebeam_sym import column_names

CLAIM = "M, E, H and C at N = 8, modes at hand"


@pytest.mark.parametrize("name", column_names())
def bench_ours(contender: Any, name: str) -> None:
    kernel = fb.column(name).kernel
    basis = kernel.basis(8)

    def matrices() -> tuple[Any, ...]:
        M, E, H = kernel.mass(basis), kernel.stiffness_elastic(basis), kernel.stiffness_load(basis)
        return M, E, H, 0.1 * M + 1e-3 * E

    contender(CLAIM, f"ours, {name}", matrices, bound=100e-6)


def bench_quadrature(contender: Any) -> None:
    """Gauss-Legendre with 64 nodes, the values of the modes at the nodes given."""
    kernel = fb.column("free-free").kernel
    basis = kernel.basis(8)
    nodes, weights = np.polynomial.legendre.leggauss(64)
    nodes, weights = (nodes + 1) / 2, weights / 2
    phi, slope, moment = (kernel.shapes(basis, nodes, d) for d in range(3))
    end, end_slope = kernel.shapes(basis, 1.0), kernel.shapes(basis, 1.0, 1)

    def matrices() -> tuple[Any, ...]:
        M = (phi * weights) @ phi.T
        E = (moment * weights) @ moment.T
        H = -(slope * (weights * nodes)) @ slope.T + np.outer(end, end_slope)
        return M, E, H, 0.1 * M + 1e-3 * E

    def error(found: tuple[Any, ...]) -> str:
        exact = kernel.stiffness_load(basis)
        return f"H off by {np.abs(found[2] - exact).max() / np.abs(exact).max():.1e} of its largest entry"

    contender(CLAIM, "64-point quadrature, free-free", matrices, error=error)


@pytest.mark.parametrize("name", column_names())
def bench_basis(contender: Any, name: str) -> None:
    kernel = fb.column(name).kernel
    contender("the first eight modes: roots, coefficients, end values", f"ours, {name}", lambda: kernel.basis(8))
