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
# # The thrust that a launch vehicle bears
#
# A launch vehicle is a free beam whose stiffness and mass stand in tables, with its payload, engines and sloshing
# propellant on it. Its thrust follows the rear end and compresses it. Which thrust does it bear, how much of that does
# the gimbal's law take away, and what does the inertial unit feel? The vehicle here is synthetic: no real one.

# %%
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import freebeam as fb

here = Path("examples") if Path("examples/vehicle.toml").exists() else Path(".")
vehicle = fb.vehicle(here / "vehicle.toml")
vehicle.mass, vehicle.length, vehicle.settings["thrust"]

# %% [markdown]
# ## Its modes without thrust
#
# The lowest two are those of the propellant in its tanks, on springs; the third bends the vehicle.

# %%
hertz = vehicle.frequencies / (2 * np.pi)
for shape, frequency in zip(vehicle.unloaded.shape[:4], hertz, strict=False):
    plt.plot(vehicle.unloaded.x, shape.real, label=f"{frequency:.3g} Hz")
plt.xlabel("x, m")
plt.legend()
hertz, vehicle.unloaded.error

# %% [markdown]
# ## What the structure alone bears
#
# Without a gimbal law the thrust could grow a hundredfold: the structure is not what limits it. Rigid motion is left
# out here, a free vehicle tumbles at any thrust.

# %%
free = fb.vehicle(here / "vehicle.toml", gimbal={"gain": 0.0, "rate": 0.0})
free.load, free.kind, free.error, free.factor

# %% [markdown]
# ## What it bears when it is steered
#
# The gimbal turns the thrust by the slope and its rate at the sensor. It sees the bending modes too, and may feed them:
# where the sensor sits decides which.

# %%
places = np.arange(6.0, 36.0, 4.0)
law = {name: vehicle.settings[f"gimbal.{name}"] for name in ("gain", "rate", "actuator")}
borne = np.array([fb.vehicle(here / "vehicle.toml", gimbal={**law, "sensor": x}).load for x in places])
plt.figure()
plt.semilogy(places, borne, "o-")
plt.axhline(vehicle.settings["thrust"], ls="--")
plt.xlabel("place of the sensor, m")
plt.ylabel("thrust at the first loss of stability, N")
vehicle.load, vehicle.kind, vehicle.frequency, vehicle.error

# %% [markdown]
# ## What the inertial unit feels
#
# The gimbal is turned by one degree and back within half a second, beside the law, which brings the vehicle back.

# %%
felt = vehicle.respond(12.0, 0.005, lambda t: np.where(t < 0.5, np.radians(1) * np.sin(2 * np.pi * t) ** 2, 0.0))
plt.figure()
plt.plot(felt["t"], felt["ddy"])
plt.xlabel("time, s")
plt.ylabel("acceleration at the inertial unit, m/s²")
float(np.abs(felt["ddy"]).max())

# %% [markdown]
# ## For the control engineer
#
# The open loop, from the gimbal's angle to the angle and rate at the sensor, as a state space in seconds. Closed with
# the law by hand, without its actuator, it has the poles of the vehicle that is steered at once.

# %%
at_once = {"gain": law["gain"], "rate": law["rate"], "sensor": vehicle.settings["gimbal.sensor"]}
tables = {"parts": here / "vehicle-parts.csv", "damping": {"ratio": 0.005}, "thrust": vehicle.settings["thrust"]}
opened = fb.vehicle(here / "vehicle-stations.csv", **tables).state_space(
    outputs=("angle", "rate"), sensors=at_once["sensor"]
)
closed = np.linalg.eigvals(opened.A + opened.B @ np.array([[law["gain"], law["rate"]]]) @ opened.C)
steered = fb.vehicle(here / "vehicle-stations.csv", gimbal=at_once, **tables).modes(number=4)
poles = steered.growth + 1j * steered.frequency
difference = max(np.abs(closed - pole).min() / abs(pole) for pole in poles)
opened.A.shape, difference
