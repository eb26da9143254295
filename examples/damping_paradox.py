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
# # The damping paradox
#
# Without damping the free-free beam flutters at $P_0 = 109.72$. Give it internal damping, however little, and it
# flutters at 88.16. The limit of vanishing damping is not the case without damping. Ziegler found this in 1952 on a
# double pendulum; the paper finds it in its Fig. 4. There is a construction that gives the number from the undamped
# curve alone.

# %%
import matplotlib.pyplot as plt
import numpy as np

import freebeam as fb

column = fb.column("free-free")
undamped = fb.critical_load(column)
little = [fb.critical_load(column, alpha=alpha).load for alpha in (1e-3, 1e-6, 1e-9, 1e-12)]
undamped.load, little

# %% [markdown]
# ## The tangent
#
# To first order in the damping $C = \beta M + \alpha E$ each undamped frequency $\omega^2 = s(P)$ gets the growth rate
# $\tfrac12[\alpha(P s' - s) - \beta]$. With $\beta = \kappa\alpha$ the first branch to grow does so where
#
# $$P\,s'(P) - s(P) = \kappa,$$
#
# that is, where the tangent to the curve $s(P)$ meets the axis $P = 0$ at $-\kappa$. With internal damping alone the
# tangent goes through the origin.

# %%
ax = fb.figures.tangent(column)
limit = fb.critical_load(column, kappa=0.0)
limit.load

# %% [markdown]
# The rule, checked by its own terms: the growth rate of the touching branch over $\alpha$, from eigenvalues at
# $\alpha = 10^{-6}$ and from the slope of the undamped curve.

# %%
alpha = 1e-6


def slowest(load):
    s = np.linalg.eigvals(np.linalg.solve(column.system(8).M, column.system(8, load).K))
    return np.sort(s.real)[0]


rates = []
for load in (40.0, 70.0, 85.0, 92.0, 100.0):
    h = 1e-3
    slope = (slowest(load + h) - slowest(load - h)) / (2 * h)
    values = fb.spectrum(column.system(8, load, alpha=alpha)).eigenvalues
    first = values[values.imag > 0][np.argmin(values[values.imag > 0].imag)]
    rates.append((load, (load * slope - slowest(load)) / 2, first.real / alpha))
rates

# %% [markdown]
# ## External damping brings it back
#
# With more and more external damping beside the internal, $\kappa = \beta/\alpha$ grows, the tangent's foot sinks, its
# point of contact climbs the curve, and for $\kappa\to\infty$ it reaches the coalescence.

# %%
ax = fb.figures.tangent(column, kappa=500.0)

# %%
kappas = np.array([0, 10, 100, 1e3, 1e4, 1e5, 1e6])
limits = [fb.critical_load(column, kappa=kappa).load for kappa in kappas]
dict(zip(kappas.tolist(), limits, strict=True))

# %% [markdown]
# ## More than a little
#
# Fig. 6 of the paper: at a given $\beta$ internal damping first lowers the critical load and then raises it.

# %%
alphas, betas = np.geomspace(1e-6, 1e-1, 21), np.geomspace(1e-2, 1, 9)
loads = np.array([[fb.critical_load(column, alpha=a, beta=b).load for b in betas] for a in alphas])
labels = {"xlabel": r"internal damping $\alpha$", "ylabel": r"external damping $\beta$"}
ax = fb.figures.stability_map(loads, alphas, betas, **labels)

# %% [markdown]
# ## Beck's column
#
# The cantilever loses nearly half: 20.05 becomes 10.94. And a force that follows the slope only in part, $\eta < 1$?
# Below $\eta \approx 0.5$ the column buckles instead, and a potential force ($\eta = 0$) knows no paradox.

# %%
beck = fb.column("beck")
ax = fb.figures.tangent(beck)

# %%
etas = np.linspace(0, 1.2, 49)
with fb.figures.style():
    figure, ax = plt.subplots(figsize=(5.2, 3.4))
    fb.figures.critical_curve(beck, "eta", etas, ax=ax, label="no damping")
    vanishing = [fb.critical_load(beck, kappa=0.0, eta=eta).load for eta in etas]
    ax.plot(etas, vanishing, color="#E69F00", zorder=1, label=r"$\alpha\to 0^+$")
    ax.legend()
