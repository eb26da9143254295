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
# # From energies to matrices
#
# A column is stated by its energies and virtual work, as Eq. (8) of the paper is printed. Everything else follows:
# the equation of motion, the end conditions that nobody stated, and the matrices of the Ritz series. This notebook
# lets the program derive them, looks at what came out, and then changes the statement.

# %%
import numpy as np

import freebeam as fb
from freebeam_derive import pipeline
from freebeam_derive.notation import P, alpha, beta, t, x, y
from freebeam_derive.ritz import display_form
from freebeam_derive.statement import Column, at, delta, integral

# %% [markdown]
# ## The statement
#
# The paper's beam: free at both ends, pushed at $x = 1$ by a force $P_0$ that follows the slope there. The axial force
# $P_0 x$ accelerates the beam along itself. What the follower force does is virtual work and no energy: no potential
# gives $-P_0\,y'(1)\,\delta y(1)$.

# %%
statement = pipeline.find("free-free")
statement.T, statement.V, statement.W_c

# %%
statement.dW_nc

# %% [markdown]
# ## Hamilton's principle
#
# The first variation, integrated by parts until no derivative of $\delta y$ is left, gives the equation of motion
# (Eq. 6; the printed $\partial^3$ stands for $\partial^5$) and what must hold at the ends (Eq. 15). At $x = 1$ neither
# condition holds the load: a follower force has no component across the beam's end.

# %%
derived = pipeline.derive(statement)
derived.motion.equation

# %%
conditions = [derived.motion.condition(end, order) for end in (0, 1) for order in (0, 1)]
conditions

# %% [markdown]
# ## Ritz
#
# With $y = \sum_j \varphi_j(x)\,q_j(t)$ and $\delta y = \varphi_i\,\delta q_i$ the weak form becomes
# $M\ddot q + C\dot q + (E + P_0 H)\,q = Q$. The row is the test function: in Eq. (11) as printed the end term is
# transposed. Its form is what the derivation decides.

# %%
forms = {name: display_form(getattr(derived.system, name)) for name in ("M", "E", "H")}
forms

# %% [markdown]
# $H$ is not symmetric, and that is all there is to flutter: a load with a potential has a symmetric $H$, real
# $\omega^2$, and can only buckle.

# %%
derived.system.H.symmetric, derived.system.E.symmetric

# %% [markdown]
# The trial functions are the modes of the unloaded beam; their characteristic equation and shape are derived too.

# %%
derived.beam.equation, derived.beam.mode()

# %% [markdown]
# ## From the form to numbers
#
# The integrals are done in closed form and emitted as NumPy. Here is $H$ by quadrature, straight from the form above,
# beside the emitted kernel.

# %%
column = fb.column("free-free")
M, E, H = column.matrices(8)
nodes, weights = np.polynomial.legendre.leggauss(120)
nodes, weights = (nodes + 1) / 2, weights / 2
system = column.system(8)
slopes = system.shapes(nodes, 1)
by_quadrature = -(slopes * weights * nodes) @ slopes.T + np.outer(system.shapes(1.0), system.shapes(1.0, 1))
difference = np.abs(by_quadrature - H).max() / np.abs(H).max()
difference

# %% [markdown]
# ## Another statement
#
# Change the virtual work, and all of it changes. Let the force at the end keep its direction: then it has a potential.
# The load then appears in the natural
# condition at $x = 1$, and $H$ is symmetric.

# %%
dead = Column(
    name="dead-load",
    title="Cantilever under a dead load",
    T=integral(y.diff(t) ** 2) / 2,
    V=integral(y.diff(x, 2) ** 2) / 2,
    W_c=P * integral(y.diff(x) ** 2) / 2,
    dW_nc=-integral(beta * y.diff(t) * delta(y) + alpha * y.diff(x, 2, t) * delta(y.diff(x, 2))),
    ends=("clamped", "free"),
)
follower = Column(
    name="follower",
    title="Cantilever under a follower load",
    T=dead.T,
    V=dead.V,
    W_c=dead.W_c,
    dW_nc=dead.dW_nc - P * at(y.diff(x), 1) * at(delta(y), 1),
    ends=("clamped", "free"),
)
changed = {c.name: pipeline.derive(c) for c in (dead, follower)}
{name: (found.motion.condition(1, 0), found.system.H.symmetric) for name, found in changed.items()}

# %% [markdown]
# Saved as a file `my_column.py`, such a statement is a column like any other:
# `freebeam critical --column my_column.py`.
