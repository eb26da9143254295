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
# # A column from a paper
#
# You have a column from a paper, or one of your own that nobody computed, and you want its critical load. Here it is
# a cantilever on an elastic root, with a mass at its tip, under a force of which a share follows the slope there.
# The steps are the same for any other: state it, read what follows from the statement, test limits that you know,
# test one number by another route, and only then draw curves.
#
# ## State it
#
# The energies are copied as a paper has them: kinetic energy $T$, elastic energy $V$, the work $W_c$ of what has a
# potential, and the virtual work of all else.

# %%
import tempfile
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from scipy.optimize import least_squares

import freebeam as fb
from freebeam_derive.definition import formulas
from freebeam_derive.statement import load_column

STATEMENT = """
from sympy import Symbol

from freebeam_derive.notation import P, t, x, y
from freebeam_derive.statement import Column, Parameter, at, delta, integral

mu, c, eta = (Symbol(name, real=True) for name in ("mu", "c", "eta"))

column = Column(
    name="rooted",
    title="Cantilever on an elastic root with a tip mass, under a tip force",
    T=integral(y.diff(t) ** 2) / 2 + mu * at(y.diff(t), 1) ** 2 / 2,
    V=integral(y.diff(x, 2) ** 2) / 2 + c * at(y.diff(x), 0) ** 2 / 2,
    W_c=P * integral(y.diff(x) ** 2) / 2,
    dW_nc=-eta * P * at(y.diff(x), 1) * at(delta(y), 1),
    ends=("pinned", "free"),
    parameters=(
        Parameter(mu, "tip mass in units of the beam's", 0.5, 0, 5),
        Parameter(c, "stiffness of the root's rotational spring", 20, 0.1, 100),
        Parameter(eta, "share of the force that follows the slope", 1, 0, 1),
    ),
)
"""
folder = tempfile.TemporaryDirectory()
file = Path(folder.name) / "rooted.py"
file.write_text(STATEMENT)
column = fb.column(file)
fb.figures.beam(column, x_s=None)

# %% [markdown]
# The picture is drawn from the statement: a first test of what you wrote.
#
# ## Read what follows
#
# The equation of motion and the end conditions follow from Hamilton's principle. Compare them with the paper's, term
# by term. They are LaTeX; `IPython.display.Math` shows them.

# %%
found = formulas(load_column(file))
found["equations"], found["conditions"]

# %% [markdown]
# ## Test limits
#
# Without the mass and on a stiff root this is Beck's column. With a share 0 the force keeps its direction, and the
# column buckles at the root of $\sqrt{P}\tan\sqrt{P} = c$.

# %%
stiff = fb.critical_load(column, mu=0, c=1e8)
beck = fb.critical_load(fb.column("beck"))
dead = fb.critical_load(column, eta=0, c=20)
(stiff.load, beck.load), (dead.kind, dead.load, np.sqrt(dead.load) * np.tan(np.sqrt(dead.load)))

# %% [markdown]
# ## Test one number by another route
#
# Papers solve $y'''' + P y'' - \omega^2 y = 0$ by four exponentials, and set the determinant $D(P, \omega^2)$ of the
# conditions at the ends to zero. At flutter two roots meet: $D$ and its derivative by $\omega^2$ both vanish.


# %%
def determinant(P, square, mu=0.5, c=20.0, eta=1.0):
    """D of the conditions at the ends for y = exp(r x), four rows."""
    r = np.roots([1, 0, P, 0, -square]).astype(complex)
    end = np.exp(r)
    rows = [r**0, r**2 - c * r, r**2 * end, (r**3 + (1 - eta) * P * r + mu * square) * end]
    return np.linalg.det(rows) / np.linalg.det(np.vander(r))  # the order of the roots r does not matter


def meets(unknown, step=1e-3):
    P, square = unknown
    below, at, above = (determinant(P, square + shift).real for shift in (-step, 0, step))
    return [at, (above - below) / (2 * step)]


critical = fb.critical_load(column)
start = [critical.load * 1.01, critical.frequency**2 * 1.01]
by_determinant = least_squares(meets, start, x_scale=start, xtol=1e-14, ftol=1e-14, gtol=1e-14).x
(critical.kind, critical.load, critical.frequency, critical.error), (by_determinant[0], np.sqrt(by_determinant[1]))

# %% [markdown]
# `error` says how far the series may be from the beam itself. Here another route agrees with it.
#
# ## Then draw
#
# How the load moves with the share that follows: the curve of a paper, and where its kind changes.

# %%
curve = fb.trace_boundary(column, "eta", 0.0, 1.0)
fig, ax = plt.subplots()
for kind in ("divergence", "flutter"):
    ax.plot(curve.values, np.where(curve.kind == kind, curve.load, np.nan), label=kind)
ax.set(xlabel=r"share that follows, $\eta$", ylabel="$P_{cr}$")
ax.legend()
folder.cleanup()
curve.events

# %% [markdown]
# The file is as good as the package's own columns wherever a column's name is taken, on the command line too:
# `freebeam show rooted.py`, `freebeam critical --column rooted.py --exact`, `freebeam lesson --column rooted.py`.
