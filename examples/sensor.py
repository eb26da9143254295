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
# # The sensor of a thrusting structure
#
# A long light structure in space, a boom of a hundred metres, is pushed from behind by its motor, steered by a
# transversal force, and measures its own motion with an inertial unit. What does the unit feel, in metres and seconds,
# and where should it sit? The rigid motion is what it is there for; the elastic motion is what disturbs it.

# %%
import matplotlib.pyplot as plt
import numpy as np

import freebeam as fb

column = fb.column("free-free")

# %% [markdown]
# ## The structure, in SI units
#
# Eq. (5) of the paper gives the size of one nondimensional unit of everything.

# %%
EI, m, L = 2.0e5, 5.0, 100.0  # N m², kg/m, m
unit = column.scales(bending_stiffness=EI, mass_per_length=m, length=L)
unit

# %% [markdown]
# Damping: 1 % of critical in the first bending mode from the material ($C_\alpha$), and a little from outside.

# %%
gamma = column.basis(1).gamma[0]
frequency_1 = gamma**2 * unit["frequency"] / (2 * np.pi)  # Hz
alpha = 2 * 0.01 / gamma**2
beta = 0.02
C_alpha, C_beta = alpha * unit["alpha"], beta * unit["beta"]
frequency_1, C_alpha, C_beta

# %% [markdown]
# ## The thrust that it bears

# %%
critical = fb.critical_load(column, alpha=alpha, beta=beta)
critical_thrust = critical.load * unit["load"]  # N
thrust = 0.4 * critical_thrust
flutter_frequency = critical.frequency * unit["frequency"] / (2 * np.pi)
critical_thrust, flutter_frequency, critical.converged

# %% [markdown]
# ## What the sensor feels
#
# The controller gives a pulse at the rear end, up to half a newton for 25 seconds. The sensor sits at a tenth of the
# length. Its motion has a rigid part, which the controller wants, and an elastic part.

# %%
load = thrust / unit["load"]
system = column.system(8, load=load, alpha=alpha, beta=beta, rigid=True)
pulse, lasting = 0.5 / unit["force"], 25.0 / unit["time"]
response = fb.respond(
    system,
    duration=200.0 / unit["time"],
    step=0.05 / unit["time"],
    force=lambda t: pulse * np.where(t < lasting, np.sin(np.pi * t / lasting) ** 2, 0.0),
    force_position=1.0,
    sensors=[0.1, 0.5],
)
seconds = response.t * unit["time"]
with fb.figures.style():
    figure, axes = plt.subplots(1, 2, figsize=(9, 3.2))
    for ax, part, title in zip(axes, (response.ddy_rigid, response.ddy_elastic), ("rigid", "elastic"), strict=True):
        for k, (position, colour) in enumerate(zip(response.sensors, ("#0072B2", "#E69F00"), strict=True)):
            ax.plot(
                seconds, 1e3 * part[:, k] * unit["acceleration"], color=colour, lw=1.0, label=f"at {position * L:.0f} m"
            )
        ax.set_title(f"{title} part of the acceleration")
        ax.set_xlabel("time, s")
        ax.set_ylabel("mm/s²")
        ax.legend()

# %% [markdown]
# ## How thrust raises it
#
# The amplitude at the sensor per newton of a sinusoidal force, from the equation of motion at each frequency; beside it
# the same numbers from the state-space form, a `scipy.signal.StateSpace`, from which a control engineer goes on.

# %%
hertz = np.geomspace(0.01, 1.2, 600)
omega = 2 * np.pi * hertz / unit["frequency"]
per_newton = unit["length"] / unit["force"]
gains = {}
with fb.figures.style():
    figure, ax = plt.subplots(figsize=(6.4, 3.6))
    for share, colour in ((0.0, "#000000"), (0.4, "#0072B2"), (0.8, "#E69F00")):
        s = column.system(8, load=share * critical.load, alpha=alpha, beta=beta)
        gains[share] = np.array(
            [abs(s.shapes(0.1) @ np.linalg.solve(-(w**2) * s.M + 1j * w * s.C + s.K, s.Q(1.0))) for w in omega]
        )
        ax.loglog(hertz, gains[share] * per_newton, color=colour, label=f"{share:.0%} of the critical thrust")
    ax.set_xlabel("frequency of the force, Hz")
    ax.set_ylabel("elastic amplitude, m per N")
    ax.legend()
space = fb.state_space(s, force_position=1.0, sensors=[0.1])
unit_matrix = np.eye(len(space.A))
transfer = [(space.C @ np.linalg.solve(1j * w * unit_matrix - space.A, space.B))[0, 0] for w in omega]
agreement = np.abs(np.abs(transfer) / gains[0.8] - 1).max()
agreement

# %% [markdown]
# ## Where the sensor should sit
#
# An inertial unit measures acceleration, and often the rate of turn. Where the lowest elastic motion has a node it
# disturbs an accelerometer least, and where its slope vanishes a gyroscope. Both places move with the thrust.

# %%
x = np.linspace(0, 1, 1001)
places = {}
for share in (0.0, 0.4, 0.8):
    s = column.system(8, load=share * critical.load, alpha=alpha, beta=beta)
    found = fb.spectrum(s)
    first = np.flatnonzero(found.eigenvalues.imag > 0)[0]
    shape, slope = (np.abs(found.vectors[:, first] @ s.shapes(x, k)) for k in (0, 1))
    inner = (x > 0.02) & (x < 0.5)
    places[f"{share:.0%}"] = (L * x[inner][shape[inner].argmin()], L * x[slope.argmin()])
places  # metres from the front: accelerometer in the front half, gyroscope
