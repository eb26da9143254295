"""M, E and H of the free-free beam at N = 8: the emitted C kernel, a loop written by hand in C, and the NumPy kernel.

All fill their matrices 2000 times; the C contenders inside one call, so that the way from Python is no part of it. The
promise: no more than twice the loop written by hand, in the same run, and faster than NumPy.
"""

from __future__ import annotations

import ctypes
import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import freebeam as fb
from freebeam_derive import emit, pipeline

CLAIM = "M, E and H at N = 8 of the free-free beam, modes at hand, 2000 times"
N, TIMES = 8, 2000
DRIVER = """
#include "free_free.h"

#include <string.h>

void emitted(const free_free_basis *basis, int times, double *M, double *E, double *H)
{
    for (int k = 0; k < times; k++) {
        free_free_mass(basis, 0, M);
        free_free_stiffness_elastic(basis, 0, E);
        free_free_stiffness_load(basis, 0, H);
    }
}

/* as one would write it: powers of each mode once, one division a pair */
static void matrices(int n, const double *g, const double *s, const double *d, double *M, double *E, double *H)
{
    double g3[64], g4[64];
    memset(M, 0, sizeof(double) * (size_t)(n * n));
    memset(E, 0, sizeof(double) * (size_t)(n * n));
    for (int i = 0; i < n; i++) {
        g3[i] = g[i] * g[i] * g[i];
        g4[i] = g3[i] * g[i];
        M[i * n + i] = d[i] * d[i] / 4;
        E[i * n + i] = M[i * n + i] * g4[i];
        H[i * n + i] = -g[i] * (d[i] + g[i]) / 2;
    }
    for (int i = 0; i < n; i++) {
        for (int j = 0; j < n; j++) {
            if (i == j) continue;
            double r = 1 / (g4[i] - g4[j]);
            double value = -4 * d[i] * d[j] * g4[i] * g4[j] * (s[i] * s[j] - 1) * r;
            value = (value - 2 * g[i] * s[i] * g[j] * s[j] * (d[j] * g3[j] - d[i] * g3[i])) * r;
            H[i * n + j] = value - 2 * d[i] * s[i] * g[j] * s[j];
        }
    }
}

void by_hand(const free_free_basis *basis, int times, double *M, double *E, double *H)
{
    for (int k = 0; k < times; k++) {
        matrices(basis->N, basis->gamma, basis->sigma, basis->deflection_0, M, E, H);
        __asm__ volatile("" : : "r"(H) : "memory"); /* the next one is not the same work */
    }
}

void prepare(free_free_basis *basis, int N, void *memory)
{
    free_free_make(basis, N, memory);
}
"""


@pytest.fixture(scope="module")
def library(tmp_path_factory: pytest.TempPathFactory) -> Any:
    if shutil.which("cc") is None:
        pytest.skip("no C compiler on the path")
    folder: Path = tmp_path_factory.mktemp("c")
    kernel = pipeline.derive(pipeline.find("free-free")).kernel("modes")
    for file, text in {**emit.files(kernel, "c", "free_free"), "driver.c": DRIVER}.items():
        (folder / file).write_text(text, encoding="utf-8")
    # two files: what is timed is what a user links, with nothing folded into the loop that calls it
    command = ["cc", "-std=gnu99", "-O2", "-fPIC", "-shared", "free_free.c", "driver.c", "-o", "library.so", "-lm"]
    subprocess.run(command, cwd=folder, check=True)
    return ctypes.CDLL(str(folder / "library.so"))


def filled(library: Any, name: str) -> Callable[[], Any]:
    """A function that fills M, E and H so many times, and gives them."""
    basis, memory, matrices = (ctypes.c_byte * 4096)(), np.empty(100 * N), np.empty((3, N, N))
    library.prepare(basis, N, ctypes.c_void_p(memory.ctypes.data))
    places = [ctypes.c_void_p(matrix.ctypes.data) for matrix in matrices]
    function = getattr(library, name)

    def run() -> Any:
        function(basis, TIMES, *places)
        return matrices, memory

    return run


def of_numpy() -> Callable[[], Any]:
    kernel = fb.column("free-free").kernel
    basis = kernel.basis(N)

    def run() -> Any:
        for _ in range(TIMES):
            found = kernel.mass(basis), kernel.stiffness_elastic(basis), kernel.stiffness_load(basis)
        return found

    return run


def off(H: Any) -> str:
    kernel = fb.column("free-free").kernel
    exact = kernel.stiffness_load(kernel.basis(N))
    return f"H off the NumPy kernel's by {np.abs(H - exact).max() / np.abs(exact).max():.0e} of its largest entry"


@pytest.mark.parametrize("name, label", [("emitted", "ours, emitted C"), ("by_hand", "peer: by hand in C")])
def bench_c(contender: Any, library: Any, name: str, label: str) -> None:
    contender(CLAIM, label, filled(library, name), error=lambda found: off(found[0][2]), rounds=200)


def bench_numpy(contender: Any) -> None:
    contender(CLAIM, "ours, NumPy", of_numpy(), rounds=20)
