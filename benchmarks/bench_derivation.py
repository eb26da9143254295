"""Deriving a column: ours against `sympy.integrate` on the three integrals of Eq. (11) and `lambdify`."""

from __future__ import annotations

import json
import subprocess
import sys
from functools import cache
from typing import Any

import numpy as np
import pytest
import sympy as sp
from scipy.integrate import quad_vec

import freebeam as fb
from freebeam_sym import column_names

CLAIM = "one column from its energies to emitted NumPy source, after imports"

# A fresh process, so that nothing is remembered from an earlier round; it reports the time after its imports.
FRESH = """
import json, sys, time
from freebeam_derive import emit, pipeline
column = pipeline.find(sys.argv[1])
start = time.perf_counter()
derived = pipeline.derive(column)
text = emit.emit(derived.kernel("modes"))
middle = time.perf_counter()
figures = ()
if len(sys.argv) > 2:
    from freebeam_derive import verify
    figures = verify.verify(derived.kernel("modes"), text)
end = time.perf_counter()
worst = max((f.error / f.bound for f in figures), default=0)
print(json.dumps([middle - start, end - middle, derived.kernel("modes").operations, worst]))
"""


def fresh(*arguments: str) -> list[float]:
    run = subprocess.run([sys.executable, "-c", FRESH, *arguments], capture_output=True, text=True, check=True)
    return [float(v) for v in json.loads(run.stdout)]


@pytest.mark.parametrize("column", column_names())
def bench_ours(contender: Any, benchmark: Any, column: str) -> None:
    found: list[list[float]] = []
    contender(CLAIM, f"ours, {column}", lambda: found.append(fresh(column)), rounds=3)
    inside = sorted(times[0] for times in found)[1]
    benchmark.extra_info.update(
        seconds=inside, bound=2.0, error=f"{int(found[0][2])} operations an entry at most", name=f"ours, {column}"
    )


@pytest.mark.parametrize("column", column_names())
def bench_verification(contender: Any, benchmark: Any, column: str) -> None:
    found: list[list[float]] = []
    claim = "verification of one column's kernels at 50 digits"
    contender(claim, f"ours, {column}", lambda: found.append(fresh(column, "verify")), rounds=1)
    benchmark.extra_info.update(
        seconds=found[0][1], bound=10.0, error=f"{found[0][3]:.2f} of the bound at most", name=f"ours, {column}"
    )


@cache
def integrated() -> tuple[Any, int]:
    """H of the free-free column by SymPy's integrals of Eq. (22), lambdified, and its count of operations."""
    x, a, b = sp.symbols("x a b", positive=True)

    def shape(g: sp.Symbol) -> sp.Expr:
        ratio = (sp.cos(g) - sp.cosh(g)) / (sp.sin(g) + sp.sinh(g))
        return sp.sin(g * x) + sp.sinh(g * x) + ratio * (sp.cos(g * x) + sp.cosh(g * x))

    first, second = shape(a), shape(b)
    mass = sp.integrate(sp.expand(first * second), (x, 0, 1))
    elastic = sp.integrate(sp.expand(first.diff(x, 2) * second.diff(x, 2)), (x, 0, 1))
    load = -sp.integrate(sp.expand(x * first.diff(x) * second.diff(x)), (x, 0, 1))
    load += first.subs(x, 1) * second.diff(x).subs(x, 1)
    entries = [sp.lambdify((a, b), e, "numpy") for e in (mass, elastic, load)]
    return entries[2], int(load.count_ops())


def _worst(entry: Any) -> str:
    """Relative error of H[5, 6] and H[8, 7] (modes from 1) against quadrature of the modes themselves."""
    system = fb.column("free-free").system(modes=8)
    texts = []
    for i, j in ((5, 6), (8, 7)):
        integral, _ = quad_vec(
            lambda x, i=i, j=j: -x * system.shapes(x, 1)[i - 1] * system.shapes(x, 1)[j - 1], 0, 1, epsrel=1e-13
        )
        exact = integral + system.shapes(1.0)[i - 1] * system.shapes(1.0, 1)[j - 1]
        value = entry(system.gamma[i - 1], system.gamma[j - 1])
        texts.append(f"H[{i}, {j}] off by {abs(float(value) / float(exact) - 1):.1e}")
    return ", ".join(texts)


def bench_sympy_integrate(contender: Any, benchmark: Any) -> None:
    contender(CLAIM, "sympy.integrate and lambdify, free-free, its three integrals", integrated, rounds=1)
    entry, operations = integrated()
    benchmark.extra_info["error"] = f"{operations} operations an entry of H; {_worst(entry)}"


def bench_accuracy_of_ours(contender: Any) -> None:
    H = fb.column("free-free").system(modes=8).H
    lookup = {float(g): n for n, g in enumerate(fb.column("free-free").basis(8).gamma)}
    claim = "the load matrix's entries in floating point"
    contender(claim, "ours", lambda: H, error=lambda _: _worst(lambda a, b: H[lookup[float(a)], lookup[float(b)]]))
    assert np.isfinite(H).all()
