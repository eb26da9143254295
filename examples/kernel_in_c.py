# ---
# jupyter:
#   jupytext:
#     text_representation:
#       extension: .py
#       format_name: percent
#   kernelspec:
#     display_name: Python 3
#     language: python
#     name: python3
# ---

# %% [markdown]
# # Kernels in C
#
# A program in C, C++, Fortran or any other language that calls C can have the matrices of a column without Python. The
# kernel is derived and verified here, compiled, called through `ctypes`, and compared with the NumPy kernel.
#
# ## Write it
#
# On the command line this is `freebeam generate beck --language c --output kernels`. Nothing is written unless the
# compiled kernel has passed the same test as the NumPy one: matrices at 50 digits by another route.

# %%
import ctypes
import shutil
import subprocess
import tempfile
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import freebeam as fb
from freebeam_derive import pipeline

if shutil.which("cc") is None:
    raise SystemExit("This notebook needs a C compiler: no cc is on the path. Install one, such as gcc or clang.")

folder = tempfile.TemporaryDirectory()
here = Path(folder.name)
outcome = pipeline.generate(["beck"], here, only=["legendre"], language="c")
verified = outcome.figures["beck, legendre, c"]
[file.name for file in outcome.written], max(figure.error for figure in verified)

# %% [markdown]
# The header documents every function. The source needs the C99 library and nothing else, and allocates no memory.

# %%
header = (here / "beck_legendre.h").read_text()
paragraphs = header.split("\n\n")
for text in ("own parameters, nondimensional", "beck_legendre_stiffness_load("):
    print("\n\n".join(part for part in paragraphs if text in part))

# %% [markdown]
# ## Compile it
#
# Any compiler of C99 will do, with IEEE arithmetic: no `-ffast-math`.

# %%
library = here / "beck_legendre.so"
command = ["cc", "-std=c99", "-O2", "-fPIC", "-shared", str(here / "beck_legendre.c"), "-o", str(library), "-lm"]
subprocess.run(command, check=True)
beck = ctypes.CDLL(str(library))

# %% [markdown]
# ## Call it
#
# The caller gives the memory: `beck_legendre_bytes(N)` bytes for the functions of the series, and each result its
# array, row by row. `beck_legendre_parameters` is a struct of one double, the share η of the force that follows.

# %%
N = 8
double = ctypes.POINTER(ctypes.c_double)


def pointer(array):
    return array.ctypes.data_as(double)


beck.beck_legendre_bytes.restype = ctypes.c_size_t
memory = np.empty(beck.beck_legendre_bytes(N) // 8 + 1)
basis = ctypes.create_string_buffer(256)  # a beck_legendre_basis, which is smaller
assert beck.beck_legendre_make(basis, N, pointer(memory)) == 0

own = np.array([0.9])
M, E, H = (np.empty((N, N)) for _ in range(3))
beck.beck_legendre_mass(basis, 0, pointer(own), pointer(M))  # 0: without rigid functions, of which Beck's has none
beck.beck_legendre_stiffness_elastic(basis, 0, pointer(own), pointer(E))
beck.beck_legendre_stiffness_load(basis, 0, pointer(own), pointer(H))

# %% [markdown]
# ## Compare it with NumPy
#
# The same graph of operations was printed twice, so the matrices agree to rounding.

# %%
system = fb.column("beck", "legendre").system(N, eta=0.9)
difference = {
    name: np.abs(ours - theirs).max() / np.abs(theirs).max()
    for name, ours, theirs in (("M", M, system.M), ("E", E, system.E), ("H", H, system.H))
}
difference

# %% [markdown]
# ## Use it
#
# What the matrices are for: squared frequencies are the eigenvalues of $E + P H$ against $M$. The lowest two meet at
# the critical load. The dashed line is the load that freebeam finds.

# %%
loads = np.linspace(0.0, 25.0, 101)
squares = np.array([np.sort_complex(np.linalg.eigvals(np.linalg.solve(M, E + P * H)))[:2] for P in loads])
real = np.abs(squares.imag) < 1e-6 * np.abs(squares)
critical = fb.critical_load(fb.column("beck", "legendre"), modes=N, eta=0.9)
plt.plot(loads, np.where(real, squares.real, np.nan), "k")
plt.axvline(critical.load, ls="--")
plt.xlabel("load, P")
plt.ylabel("squared frequency")
last = loads[real.all(axis=1)].max()
folder.cleanup()
last, critical.load

# %% [markdown]
# JavaScript is the same command with `--language javascript`; the guide to
# [kernels in C and JavaScript](../docs/guides/languages.md) has both.
