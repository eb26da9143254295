"""What a step does to the modes that carry a response: their error of phase, and how finely they are sampled."""

from __future__ import annotations

import math

import numpy as np

from freebeam_sym.response.coordinates import Start
from freebeam_sym.response.messages import Message
from freebeam_sym.response.propagation import Look
from freebeam_sym.response.stepping import Spectrum, Steps

CARRIES = 0.01  # share of the local amplitude from which on a mode carries the motion
OUT_OF_PHASE = 0.01  # radians, and about the error relative to the local amplitude
MOMENTS = 32  # of a stretch of steps, at which the modes' amplitudes are looked at


class Quality:
    """Amplitudes of the modes in the first output of a response, looked at now and then, and what follows from them.

    forgets: whether a force drives the modes all the time. What a step has put out of phase adds up for as long as a
    mode remembers: always in free motion, 1 / |Re λ| in forced motion. frequency: of a harmonic force.
    """

    def __init__(self, steps: Steps, start: Start, forgets: bool, frequency: float) -> None:
        self.start, self.step, self.frequency = start, steps.step, abs(frequency)
        values, self.rates, self.exact = steps.seen
        self.frequencies = values.imag
        self.memory = 1 / np.maximum(-values.real, 1e-300) if forgets else np.full(values.size, np.inf)
        self.once = 0.0
        if start.steady_error is not None:
            self.rates, self.memory = np.append(self.rates, 0.0), np.append(self.memory, 0.0)
            self.frequencies = np.append(self.frequencies, 0.0)
            self.once = start.steady_error
        self.largest = np.zeros(self.rates.size)
        self.phase_error = 0.0

    def see(self, moments: range, look: Look) -> None:
        """Look at states: after each of these numbers of steps, `look` gives every so many of them."""
        every = -(-len(moments) // MOMENTS)
        shares = np.abs(self.start.modes_in(look(every))) * self.start.sizes
        shares /= np.maximum(shares.sum(axis=-1, keepdims=True), 1e-300)
        self.largest = np.fmax(self.largest, shares.max(axis=(0, 1)))
        if self.exact:
            return
        times = self.step * np.asarray(moments[::every])[:, None]
        # relative to the motion or to what it should be, whichever is larger
        wrong = np.abs(1 - np.exp(self.rates * np.minimum(times, self.memory)))
        errors = (shares * wrong).sum(axis=-1)
        if self.once:
            errors += self.once * shares[..., -1]
        self.phase_error = max(self.phase_error, float(errors.max()))

    @property
    def samples(self) -> float:
        """A period of the fastest of the modes that carry, or of the force; infinite where none oscillates."""
        fastest = float(self.frequencies[self.largest > CARRIES].max(initial=self.frequency))
        return 2 * math.pi / fastest / self.step if fastest else math.inf


def warnings_of(spectrum: Spectrum, duration: float, quality: Quality) -> tuple[Message, ...]:
    """What a reader of a response should know before he trusts it."""
    found, step = [], quality.step
    growing = spectrum.growing
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
