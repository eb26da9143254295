"""What a step does to the modes that carry a response: their error of phase, and how finely they are sampled."""

from __future__ import annotations

import math

import numpy as np

from freebeam_sym.response.digits import Array
from freebeam_sym.response.inputs import Load, Message
from freebeam_sym.response.propagation import Stretch
from freebeam_sym.response.recurrence import Recurrence, Steps

CARRIES = 0.01
"""Share of the local amplitude from which on a mode carries the motion."""
OUT_OF_PHASE = 0.01
"""Radians, and about the error relative to the local amplitude."""
MOMENTS = 32
"""Of a stretch of steps, at which the modes' amplitudes are looked at."""


class Quality:
    """Amplitudes of the modes in the first output of a response, looked at now and then, and what follows from them.

    row: of the first output, (s, 2 n), and `direct` of a force, (s,). What a step has put out of phase adds up for as
    long as a mode remembers: always in free motion, 1 / |Re λ| in forced motion. A steady state is one more of the
    modes, of no error but its own.
    """

    def __init__(self, steps: Steps, recurrence: Recurrence, row: Array, direct: Array, load: Load) -> None:
        spectrum, self.modes, self.step = steps.spectrum, recurrence.modes, steps.step
        values, errors = spectrum.values[spectrum.half], steps.errors[spectrum.half]
        self.exact, self.frequencies = not errors.any(), values.imag
        self.frequency = abs(load.frequency)
        judged = row.reshape(len(row), 2, -1)[:, :, spectrum.part].reshape(len(row), -1)
        self.sizes = np.linalg.norm(judged @ spectrum.vectors[:, spectrum.half], axis=0)
        # logarithm, in a unit of time, of what the motion is to what it should be or the other way; a root may be zero
        self.rates = np.maximum(-np.abs(errors.real), -1e300) + 1j * errors.imag
        forgets = load.acts and recurrence.unsteady is None
        self.memory = 1 / np.maximum(-values.real, 1e-300) if forgets else np.full(values.size, np.inf)
        self.steady_error = 0.0
        if recurrence.steady is not None and recurrence.unsteady is not None:
            height = float(np.linalg.norm(row @ recurrence.steady + direct))
            self.steady_error = float(np.linalg.norm(row @ recurrence.unsteady)) / max(height, 1e-300)
            self.sizes, self.rates, self.memory, self.frequencies = (
                np.append(numbers, more)
                for numbers, more in ((self.sizes, height), (self.rates, 0), (self.memory, 0), (self.frequencies, 0))
            )
        self.largest = np.zeros(self.rates.size)
        self.phase_error = 0.0

    def see(self, stretch: Stretch) -> None:
        """Look at some of a stretch's states."""
        moments = np.arange(stretch.begin, stretch.end, stretch.length)
        every = -(-moments.size // MOMENTS)
        shares = np.abs(stretch.states(every) @ self.modes) * self.sizes
        shares /= np.maximum(shares.sum(axis=-1, keepdims=True), 1e-300)
        self.largest = np.fmax(self.largest, shares.max(axis=(0, 1)))
        if self.exact:
            return
        times = self.step * moments[::every, None]
        # relative to the motion or to what it should be, whichever is larger
        wrong = np.abs(1 - np.exp(self.rates * np.minimum(times, self.memory)))
        errors = (shares * wrong).sum(axis=-1) + self.steady_error * shares[..., -1]
        self.phase_error = max(self.phase_error, float(errors.max()))

    @property
    def samples(self) -> float:
        """A period of the fastest of the modes that carry, or of the force; infinite where none oscillates."""
        fastest = float(self.frequencies[self.largest > CARRIES].max(initial=self.frequency))
        return 2 * math.pi / fastest / self.step if fastest else math.inf


def warnings_of(quality: Quality, growing: complex | None, duration: float) -> tuple[Message, ...]:
    """What should be known before a response is trusted. growing: the eigenvalue that grows fastest, if any does."""
    found, step = [], quality.step
    if growing is not None:
        kind = "flutter" if growing.imag else "divergence"
        decades = growing.real * duration / math.log(10)
        factor = f"{10**decades:.3g}" if decades < 300 else f"1e+{decades:.0f}"
        found.append(Message(
            f"the beam is unstable at this load: {kind} grows as exp(r t), r = {{rate:rate}}, by a factor of "
            f"{factor} in this response", rate=growing.real,
        ))  # fmt: skip
    if quality.phase_error > OUT_OF_PHASE:
        found.append(Message(
            f"step = {{step:time}}: Newmark's method puts the modes that carry the motion out of phase by up to about "
            f"{quality.phase_error:.2g} rad, and the response is wrong by that share of its amplitude; take the exact "
            "method, or a shorter step", step=step,
        ))  # fmt: skip
    if quality.exact and quality.samples < 2:
        found.append(Message(
            f"step = {{step:time}}: samples the fastest mode that carries the motion {quality.samples:.2g} times a "
            "period; each value is right, but below 2 the motion between them cannot be told", step=step,
        ))  # fmt: skip
    return tuple(found)
