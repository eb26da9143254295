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
# # The best place for a spring
#
# A cantilever under a follower force gets a spring of stiffness $k$ at a place $a$. Where must it stand so that the
# column bears most? The column is stated here, in the words of a textbook, and its critical load comes with its
# derivatives with respect to $k$ and $a$.

# %%
import tempfile
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from scipy.optimize import minimize

import freebeam as fb

STATEMENT = """
from sympy import Symbol

from freebeam_derive.notation import P, t, x, y
from freebeam_derive.statement import Column, Parameter, at, delta, integral

k, a = Symbol("k", positive=True), Symbol("a", positive=True)

column = Column(
    name="propped",
    title="Cantilever under a follower force, with a spring at a place along it",
    T=integral(y.diff(t) ** 2) / 2,
    V=integral(y.diff(x, 2) ** 2) / 2 + k * at(y, a) ** 2 / 2,
    W_c=P * integral(y.diff(x) ** 2) / 2,
    dW_nc=-P * at(y.diff(x), 1) * at(delta(y), 1),
    ends=("clamped", "free"),
    parameters=(
        Parameter(k, "stiffness of the spring", 100, 0, 1000),
        Parameter(a, "its place", 0.5, 0.05, 0.95),
    ),
)
"""
with tempfile.TemporaryDirectory() as folder:
    file = Path(folder) / "propped.py"
    file.write_text(STATEMENT)
    column = fb.column(file)


# %% [markdown]
# With the spring at mid-span, in twelve polynomials on each of the two segments:

# %%
found = fb.critical_load(column, modes=12)
found.load, found.kind, found.gradient

# %% [markdown]
# ## Uphill
#
# At a simple crossing $\lambda = i\omega$ the load's derivative needs no other critical load: with the left and right
# null vectors $u$, $v$ of $G = K + i\omega C - \omega^2 M$,
#
# $$u^H \left(G_P\, dP + G_\omega\, d\omega + G_a\, da\right) v = 0 .$$
#
# An optimiser that takes gradients goes uphill with it. No stiffness above 100 is to be had.


# %%
def falls(values):
    """Minus the critical load, and minus its gradient."""
    k, a = values
    critical = fb.critical_load(column, modes=12, k=k, a=a)
    return -critical.load, [-critical.gradient["k"], -critical.gradient["a"]]


start = (50.0, 0.5)
best = minimize(falls, start, jac=True, method="L-BFGS-B", bounds=[(0, 100), (0.05, 0.95)])
k_best, a_best = best.x
top = fb.critical_load(column, modes=12, k=k_best, a=a_best)
(k_best, a_best), top.load, top.gradient

# %% [markdown]
# All the stiffness is used, and at this place the derivative with respect to $a$ is zero.
#
# ## What the optimiser does not see
#
# The curve over all places, with the slope at each point:

# %%
curve = fb.trace_boundary(column, "a", 0.05, 0.95, modes=12, k=100.0)
jump = curve.events[0]

fig, (ax, below) = plt.subplots(2, 1, sharex=True, figsize=(6, 6))
for kind in ("flutter", "divergence"):
    ax.plot(curve.values, np.where(curve.kind == kind, curve.load, np.nan), label=kind)
ax.plot(a_best, top.load, "o", color="black", label="found uphill")
ax.set_ylabel("$P_{cr}$")
ax.legend()
below.plot(curve.values, np.where(np.abs(curve.slope) < 500, curve.slope, np.nan))
below.axhline(0, color="black", lw=0.5)
below.set(xlabel="place of the spring, $a$", ylabel="$dP_{cr}/da$")
jump

# %% [markdown]
# Uphill leads to a summit, not to the highest one. Where flutter gives way to divergence the load jumps: just beyond
# that place the column bears far more, and just before it far less. A design that stands there is the best on paper and
# the worst to build. The derivative says nothing of it: what the search for the first loss of stability finds at
# each point by itself does.

# %%
beyond = fb.critical_load(column, modes=12, k=100.0, a=jump.value + 1e-3)
before = fb.critical_load(column, modes=12, k=100.0, a=jump.value - 1e-3)
before.load, top.load, beyond.load
