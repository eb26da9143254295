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
# # Flutter
#
# As the follower force grows, two frequencies of the free-free beam approach, meet, and leave the imaginary axis to
# both sides: one motion decays, one grows. No force with a potential does that. This notebook follows the two
# frequencies, looks at the point where they meet, at the motion there, and at who pays for it.

# %%
import matplotlib.pyplot as plt
import numpy as np

import freebeam as fb

column = fb.column("free-free")
ax = fb.figures.beam(column)

# %% [markdown]
# ## Two frequencies meet
#
# $\omega^2$ against the load, without damping. Up to the meeting every motion is a bounded vibration.

# %%
critical = fb.critical_load(column, modes=8)
ax = fb.figures.frequency_load(column)
critical.load, critical.kind, critical.frequency

# %% [markdown]
# Just there the two modes have become one, and the frequencies depend on the load like a square root, on one side and
# on the other: an exceptional point. One per cent beyond it the growth rate is already a seventh of the frequency.

# %%
ax = fb.figures.coalescence(column)
beyond = fb.spectrum(column.system(8, load=1.01 * critical.load))
share = beyond.growth_rate / critical.frequency
share

# %% [markdown]
# How alike the two modes are: the angle between their shapes, which closes as the load comes near.

# %%
loads = critical.load * (1 - np.geomspace(0.5, 1e-6, 7))
angles = []
for load in loads:
    M, K = column.system(8, load).M, column.system(8, load).K
    s, V = np.linalg.eig(np.linalg.solve(M, K))
    v, w = (V[:, k].real for k in np.argsort(s.real)[:2])
    alike = abs(v @ M @ w) / np.sqrt((v @ M @ v) * (w @ M @ w))
    angles.append(np.degrees(np.arccos(min(alike, 1.0))))
np.round(angles, 3)

# %% [markdown]
# ## In the complex plane, with a little damping
#
# With damping nothing meets: one branch turns off to the right before. Each keeps its colour; what grows is dashed.

# %%
damping = {"alpha": 1e-3, "beta": 0.1}
damped = fb.critical_load(column, **damping)
ax = fb.figures.root_locus(column, 120, normalised=True, **damping)

# %% [markdown]
# ## The motion
#
# At the critical load, over half a period: nearly a standing wave, but not quite, and on what is missing hangs
# everything.

# %%
ax = fb.figures.mode_shape(column, **damping)

# %% [markdown]
# ## Who pays
#
# The part of the load that has no potential gives the beam energy in each period, at a constant rate; damping takes
# some out. Below the critical load damping takes more, at it both are equal, above it the beam gains.

# %%
from freebeam.figures import curves

with fb.figures.style():
    figure, axes = plt.subplots(1, 3, figsize=(11, 3.2), sharey=True)
    for ax, load in zip(axes, (70.0, damped.load, 95.0), strict=True):
        fb.figures.work(column, load, ax=ax, **damping)

cycles = {load: curves.cycle(damped.question, load) for load in (70.0, damped.load, 95.0)}
balance = {load: cycle.work[-1] - cycle.dissipated[-1] for load, cycle in cycles.items()}
balance

# %% [markdown]
# The same work as the area of a loop: the follower force's transversal part against the deflection of the end.

# %%
ax = fb.figures.work_loop(column, **damping)

# %% [markdown]
# ## Below and above, in time

# %%
with fb.figures.style():
    figure, axes = plt.subplots(1, 2, figsize=(9, 3))
    for ax, load, duration in ((axes[0], 80.0, 20.0), (axes[1], 95.0, 20.0)):
        response = fb.respond(column.system(8, load, **damping), duration, 0.01, sensors=[0.1])
        fb.figures.history(response, ax=ax)
        ax.set_title(f"$P_0$ = {load:g}")
