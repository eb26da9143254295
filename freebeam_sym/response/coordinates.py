"""Coordinates of a response: its states over their sizes, or in the eigenvectors where these serve."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from functools import lru_cache
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from freebeam_sym.response.double import Double, Fixed
from freebeam_sym.response.inputs import Wave
from freebeam_sym.response.modal import Modes, steady
from freebeam_sym.response.powers import MatrixPowers, ModalPowers, Powers, augmented
from freebeam_sym.response.stepping import Method, Steps, acceleration, scale_of

if TYPE_CHECKING:
    from freebeam_sym.columns import System

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]


class Start(NamedTuple):
    """What a response goes on from by powers, and how to see the modes in its states."""

    powers: Powers
    states: Any
    """(cases, d)"""
    rows: dict[str, Any]
    """Of each output, (s, d)."""
    modes_in: Callable[[Array], Complex]
    """Coordinates of the modes with Im λ ≥ 0, (…, modes), in states (…, d) as floats."""
    sizes: Array
    """Of these, where they are one, in the first output, (modes,)."""
    steady_error: float | None = None
    """Where a steady state is one more of these: its relative error."""


class Scaled:
    """States over their sizes; powers of the step's matrix, which serve every system."""

    def __init__(self, system: System, steps: Steps) -> None:
        self.matrices = [np.asarray(part, dtype=float) for part in (system.M, system.C, system.K)]
        self.steps, self.scale = steps, scale_of(self.matrices[0], self.matrices[2])
        bytes_of = (part.tobytes() for part in self.matrices)
        self.exact, self.powers = _powers(steps.method, len(system.M), *bytes_of, steps.step)

    def free(self, start: Array, rows: Mapping[str, Array]) -> Start:
        spectrum, row = self.steps.spectrum, next(iter(rows.values()))
        half = spectrum.values.imag >= 0
        judged = np.arange(self.scale.size).reshape(2, -1)[:, spectrum.part].ravel()
        # a pair counts twice in a real part
        into = (spectrum.inverse[half] * np.where(spectrum.values[half].imag > 0, 2.0, 1.0)[:, None]).T
        into *= self.scale[judged, None]
        return Start(
            self.powers, start / self.scale, {name: part * self.scale for name, part in rows.items()},
            lambda states: states[..., judged] @ into,
            np.linalg.norm(row[:, judged] @ spectrum.vectors[:, half], axis=0),
        )  # fmt: skip

    def driven(
        self, start: Array, rows: Mapping[str, Array], direct: Mapping[str, Array], Q: Array, wave: Wave, size: Complex,
        duration: float,
    ) -> Start:  # fmt: skip
        """With a wave's real and imaginary part among the states. size: of the force, (cases, 1)."""
        M, C, K = self.matrices
        pushes = self.steps.method.pushes(M, C, K, Q, self.steps.step, self.scale, wave)
        free = self.free(start, rows)
        return free._replace(
            powers=MatrixPowers(augmented(self.exact, pushes, wave.rotation)),
            states=np.hstack([free.states, size.real, size.imag]),
            rows={name: np.hstack([part, np.outer(direct[name], [1, 0])]) for name, part in free.rows.items()},
        )

    def pushes(self, Q: Array) -> tuple[Array, Array]:
        M, C, K = self.matrices
        before, after = self.steps.method.pushes(M, C, K, Q, self.steps.step, self.scale, None).T
        return before, after


class Modal:
    """States in the eigenvectors; powers of the step's roots, which cost less."""

    def __init__(self, steps: Steps, modes: Modes, powers: ModalPowers) -> None:
        self.steps, self.modes, self.powers = steps, modes, powers

    def free(self, start: Array, rows: Mapping[str, Array]) -> Start:
        vectors = self.modes.vectors[:, : self.modes.high.size]
        own = {name: part @ vectors for name, part in rows.items()}
        sizes = np.linalg.norm(next(iter(own.values())), axis=0)
        return Start(self.powers, self.modes.coordinates(start), own, lambda states: states.view(np.complex128), sizes)

    def driven(
        self, start: Array, rows: Mapping[str, Array], direct: Mapping[str, Array], Q: Array, wave: Wave, size: Complex,
        duration: float,
    ) -> Start | None:  # fmt: skip
        """With the size of the steady state as one more coordinate; None at resonance."""
        found = _steady(self.steps, self.powers, Q.tobytes(), wave.frequency, wave.rotation, duration)
        if found is None:
            return None
        powers, state, off = found
        free, name = self.free(start - (size * state).real, rows), next(iter(rows))
        steadily = {name: part @ state + direct[name] for name, part in rows.items()}
        height, wrong = (math.sqrt(np.vdot(part, part).real) for part in (steadily[name], rows[name] @ off))
        return free._replace(
            powers=powers,
            states=np.concatenate([free.states, size], axis=1),
            rows={name: np.hstack([part, steadily[name][:, None]]) for name, part in free.rows.items()},
            sizes=np.append(free.sizes, height),
            steady_error=wrong / max(height, 1e-300),
        )

    def pushes(self, Q: Array) -> tuple[Complex, Complex]:
        M, C, K = self.steps.spectrum.matrices
        drive = self.modes.coordinates(np.concatenate([np.zeros(len(M)), acceleration(M, C, K, Q)[1]]))
        before, after = self.steps.method.gains(self.steps.step * self.modes.high, self.powers[0])
        return self.steps.step * drive * before, self.steps.step * drive * after


def coordinates_of(system: System, steps: Steps) -> Scaled | Modal:
    modes, powers = (None, None) if system.rigid_count else (steps.spectrum.modes, steps.powers)
    return Scaled(system, steps) if modes is None or powers is None else Modal(steps, modes, powers)


@lru_cache(maxsize=16)
def _powers(
    method: Method, n: int, mass: bytes, damping: bytes, elasticity: bytes, h: float
) -> tuple[Double, MatrixPowers]:
    """The step's matrix and its powers, kept by value."""
    M, C, K = (np.frombuffer(part).reshape(n, n) for part in (mass, damping, elasticity))
    exact = method.matrix(M, C, K, h, scale_of(M, K))
    return exact, MatrixPowers(exact)


@lru_cache(maxsize=16)
def _steady(
    steps: Steps, own: ModalPowers, Q: bytes, frequency: float, rotation: Fixed, duration: float
) -> tuple[ModalPowers, Complex, Complex] | None:
    """Powers of the step's roots and of a wave's rotation, the steady state that it drives, and what this is off from
    that of the differential equation; see `steady`. Kept, by the steps that were kept."""
    modes = steps.spectrum.modes
    M, C, K = steps.spectrum.matrices
    assert modes is not None  # its powers are there
    drive = np.concatenate([np.zeros(len(M)), acceleration(M, C, K, np.frombuffer(Q))[1]])
    rate = steps.method.rate(Wave(np.ones(1, dtype=complex), frequency, rotation), steps.step)
    found = None if rate is None else steady(modes, drive, rate, duration)
    if found is None:
        return None
    found.flags.writeable = False
    true = found if rate == (frequency, 0.0) else steady(modes, drive, (frequency, 0.0), duration)
    return ModalPowers([rotation], own), found, found if true is None else found - true
