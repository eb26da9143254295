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
# # Proving a critical load
#
# A critical load in floating-point numbers is a good number without a guarantee: the search may have missed an
# earlier loss of stability, and the series may not have converged. This notebook goes from such a number to one that is
# proven, in three steps, and keeps the proof in a file that others can check.
#
# ## The number
#
# Beck's column with a little internal and external damping. `error` is an estimate, from series that agree.

# %%
import json
import tempfile
from fractions import Fraction
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import freebeam as fb

column = fb.column("beck")
damping = {"alpha": "1e-3", "beta": "0.1"}  # as text: the decimals themselves, not their nearest floats
floating = fb.critical_load(column, modes=8, alpha=1e-3, beta=0.1)
floating.load, floating.kind, floating.error

# %% [markdown]
# ## Step 1: the load of the series, with a certificate
#
# An interval that is proven to hold the critical load of the series of eight functions. `proof` says what was proven:
# there is a crossing, it is the first, the column is stable below it, and it is flutter.

# %%
series = fb.certified_load(column, 8, **damping, digits=30)
series.load, series.kind, series.proof

# %% [markdown]
# ## Step 2: let another program check it
#
# The certificate holds the data of the proof. The verifier shares no code with what made it, and says in full what
# it found proven. On the command line: `freebeam verify load.json`.

# %%
folder = tempfile.TemporaryDirectory()
file = Path(folder.name) / "load.json"
file.write_text(json.dumps(series.certificate))
verified = fb.verify_certificate(str(file))
print(verified)

# %% [markdown]
# A certificate that claims something else is refused, with the reason. Here it claims the same load for
# twice the external damping.

# %%
forged = json.loads(file.read_text())
forged["beta"] = forged["damping"]["of_M"] = "1/5"
other = Path(folder.name) / "forged.json"
other.write_text(json.dumps(forged))
try:
    refused = f"accepted: {fb.verify_certificate(str(other))}"
except fb.InputError as reason:
    refused = str(reason)
folder.cleanup()
refused

# %% [markdown]
# ## Step 3: the beam itself
#
# A series is not the beam. `exact_load` encloses the load of the differential equation with its end conditions, and
# proves over all modes, infinitely many, that it is the first ([the theorem](../docs/theorem.md)).

# %%
beam = fb.exact_load(column, **damping, digits=30)
beam.load, beam.proof

# %% [markdown]
# The difference of the two is the error of the series, now proven and no longer estimated:

# %%
error = fb.truncation_error(column, 8, **damping)
error.difference, error.relative

# %% [markdown]
# ## What a longer series gains
#
# The proven load of the beam is the mark against which the series are measured, down to the rounding of floats.

# %%
exact = Fraction(beam.load[0])
numbers = np.arange(3, 15)
loads = [fb.critical_load(column, modes=int(N), alpha=1e-3, beta=0.1).load for N in numbers]
off = np.array([abs(float((Fraction(load) - exact) / exact)) for load in loads])
plt.semilogy(numbers, off, "o-")
plt.axhline(np.finfo(float).eps, ls="--")
plt.xlabel("number of functions, N")
plt.ylabel("relative distance from the beam's load")
off
