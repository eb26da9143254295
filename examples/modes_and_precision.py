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
# # Modes, and what precision costs
#
# The Ritz series of the paper is written in the modes of the unloaded beam, Eq. (22). Typed as printed, that equation
# loses its digits; and the series itself converges slowly, because no mode meets the loaded beam's end conditions to
# all orders. Both can be seen, measured and mended.

# %%
import matplotlib.pyplot as plt
import mpmath
import numpy as np

import freebeam as fb

column = fb.column("free-free")

# %% [markdown]
# ## The modes

# %%
x = np.linspace(0, 1, 401)
system = column.system(modes=4, rigid=True)
with fb.figures.style():
    figure, axes = plt.subplots(2, 3, figsize=(8, 3.6), sharex=True)
    names = ["translation", "rotation", "mode 1", "mode 2", "mode 3", "mode 4"]
    for ax, shape, name in zip(axes.flat, system.shapes(x), names, strict=True):
        ax.plot(x, shape)
        ax.set_title(name)

# %% [markdown]
# ## Eq. (22) as printed
#
# $\cosh\gamma x - \sinh\gamma x$ cancels: each is as large as $e^{\gamma}$, their difference as small as $e^{-\gamma}$.
# So a digit and more is lost with every mode. The emitted kernels hold the decaying exponentials instead.


# %%
def as_printed(gamma, x):
    """χ of Eq. (22), with sinh and cosh; any numbers, floats or mpmath's."""
    m = mpmath if isinstance(gamma, mpmath.mpf) else np
    ratio = (m.sinh(gamma) - m.sin(gamma)) / (m.cos(gamma) - m.cosh(gamma))
    return m.sin(gamma * x) + m.sinh(gamma * x) + ratio * (m.cos(gamma * x) + m.cosh(gamma * x))


modes = 16
gammas = column.basis(modes).gamma
place = 0.83
kernel = column.system(modes).shapes(place)
lost = {"as printed": [], "kernel": []}
for n in range(modes):
    with mpmath.workdps(60):
        gamma = mpmath.findroot(lambda g: mpmath.cos(g) * mpmath.cosh(g) - 1, mpmath.mpf(gammas[n]))
        exact = as_printed(gamma, mpmath.mpf(place))
        for name, value in (("as printed", as_printed(gammas[n], place)), ("kernel", kernel[n])):
            lost[name].append(float(abs(mpmath.mpf(float(value)) - exact)))

with fb.figures.style():
    figure, ax = plt.subplots(figsize=(5.2, 3.2))
    for (name, errors), marker in zip(lost.items(), "os", strict=True):
        ax.semilogy(range(1, modes + 1), np.maximum(errors, 1e-17), marker=marker, ms=4, label=name)
    ax.set_xlabel("mode")
    ax.set_ylabel(f"error of the shape at x = {place}")
    ax.legend()

# %% [markdown]
# ## Convergence in N
#
# The critical load against the number of elastic functions, in two bases: modes, and polynomials (shifted Legendre),
# which a free beam admits because it has no geometric condition. The reference is the beam itself, no series at all,
# enclosed in ball arithmetic.

# %%
exact = fb.exact_load(column, digits=14)
reference = float(exact.load[0])
exact.load, exact.proof

# %%
polynomials = fb.column("free-free", basis="legendre")
counts = {"modes": [4, 8, 12, 16, 24, 32, 48], "legendre": [4, 6, 8, 10, 12, 14, 16, 18]}
errors = {
    name: [abs(fb.critical_load(c, modes=n).load - reference) for n in counts[name]]
    for name, c in (("modes", column), ("legendre", polynomials))
}
with fb.figures.style():
    figure, ax = plt.subplots(figsize=(5.2, 3.2))
    for (name, values), marker in zip(errors.items(), "os", strict=True):
        ax.loglog(counts[name], np.maximum(values, 1e-13), marker=marker, ms=4, label=name)
    ax.set_xlabel("elastic functions N")
    ax.set_ylabel("error of the critical load")
    ax.legend()

# %% [markdown]
# Modes converge like a power of $N$, polynomials exponentially, until rounding stops them. The paper's $N = 8$ gives
# 109.72; the beam has 109.689. Its printed 109.8 and 109.73 are the first steps of a scan above the first number.

# %%
order = np.polyfit(np.log(counts["modes"]), np.log(errors["modes"]), 1)[0]
critical = fb.critical_load(column, modes=8)
critical.load, critical.error, critical.converged, order

# %% [markdown]
# And a number with a proof: the load of the series at $N = 8$, to 30 digits, in an interval that is certain to hold it.

# %%
certified = fb.certified_load(column, modes=8, digits=30)
certified.load, certified.proof
