"""A response's arrays, and where they go: memory, the caller's arrays, or a function that takes part after part."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np

from freebeam_sym.checks import InputError, memory, refusal
from freebeam_sym.response.digits import Array
from freebeam_sym.response.inputs import Message, moments
from freebeam_sym.response.propagation import Stretch

OUTPUTS = ("y", "dy", "ddy")


@dataclass(frozen=True, eq=False, repr=False)
class Response:
    """Response at the sensors, nondimensional. Arrays (*cases, steps + 1, sensors) unless said otherwise.

    None stands for what was not asked for. Without rigid functions the elastic part is all there is and the rigid part
    is zero.
    """

    sensors: Array
    """Positions x_s, shape (sensors,)."""
    step: float
    method: str
    """"exact" or "newmark"."""
    newmark: tuple[float, float] | None
    """Newmark's parameters (b, g), where it is his method."""
    growth: float
    """Largest real part of the exact elastic spectrum; positive where the beam flutters or diverges."""
    frequencies: Array
    """Im λ > 0 of the elastic spectrum, ascending."""
    period_errors: Array
    """The method's relative period error, numerical period / exact period − 1, one a frequency; 0 of the exact one."""
    phase_error: float
    """Estimate of the error of phase (and of growth) that the method's steps add up to, in radians: about the error
    relative to the local amplitude, and no more than 2. Of the first output, largest over time and cases, of modes
    weighed by their amplitudes. Close in free and harmonic motion; of other forces, and of harmonic ones with rigid
    functions, more than there is: a mode then keeps what adds up in 1 / |Re λ|. 0 of the exact method."""
    samples_per_period: float
    """Samples a period of the fastest mode that has more than 1 % of the local amplitude, or of the harmonic force if
    that is faster; infinite where nothing oscillates."""
    warnings: tuple[Message, ...]
    """Sentences, strings: what should be known before the response is trusted, such as growth, or a step too coarse
    for what carries the motion."""
    initial_lost: float
    """‖y − Σ φᵢ qᵢ‖ / ‖y‖ over the beam, what the functions cannot hold of the initial shape; 0 for a given q."""
    velocity_lost: float
    """The same of the initial velocity."""
    measured: str = "y"
    """What the sensors read as y: the name of a field or coordinate, with a prime for each derivative by x."""
    begin: int = 0
    """Number of steps before the first time: 0, or more in a part of a response."""
    end: int = 0
    """Number of steps before the last time, and one."""
    y: Any = None
    dy: Any = None
    ddy: Any = None
    y_elastic: Any = None
    dy_elastic: Any = None
    ddy_elastic: Any = None
    y_rigid: Any = None
    dy_rigid: Any = None
    ddy_rigid: Any = None
    q: Any = None
    """Generalised coordinates, shape (*cases, steps + 1, n), where `states` asked for them."""
    dq: Any = None

    @property
    def t(self) -> Array:
        """Times k · step, shape (steps + 1,): the floats nearest to these multiples of the step as it prints."""
        return moments(Fraction(repr(self.step)), self.begin, self.end)

    @property
    def period_error(self) -> float:
        """The method's relative period error of the lowest frequency; NaN where nothing oscillates."""
        return float(self.period_errors[0]) if self.period_errors.size else math.nan


Target = Callable[[Response], object] | Mapping[str, Any]


def names_of(outputs: Sequence[str], rigid: bool, states: bool, target: Target | None) -> list[str]:
    """Names of the arrays that are asked for. Raises InputError for those that there are not."""
    named = isinstance(outputs, Sequence) and not isinstance(outputs, str) and len(outputs)
    if not named or any(name not in OUTPUTS for name in outputs):
        raise refusal("outputs", outputs, 'must be a sequence of names from "y", "dy", "ddy"')
    parts = ("", "_elastic", "_rigid") if rigid else ("",)
    names = [name + part for part in parts for name in OUTPUTS if name in outputs]
    names += ["q", "dq"] if states else []
    if target is None or callable(target):
        return names
    known = [name + part for name in OUTPUTS for part in parts] + ["q", "dq"]
    for name in target:
        if name not in known:
            raise InputError(f"target[{name!r}]: there is no such array; there are {', '.join(known)}")
    if not target:
        raise InputError("target = {}: must name an array, such as y, to be filled")
    return list(target)


class Results:
    """Takes a response, a stretch of times after another: widths names the arrays, (*cases, count, width) each."""

    def __init__(
        self, widths: Mapping[str, int], rigid: bool, cases: tuple[int, ...], count: int, target: Target | None
    ) -> None:
        self.widths, self.rigid, self.cases, self.count, self.target = widths, rigid, cases, count, target
        self.parts: dict[str, Array] = {}
        self.last: Response | None = None
        self.arrays: Mapping[str, Any] = {} if target is None or callable(target) else target
        if target is None:
            _check_memory(count, sum(widths.values()) * math.prod(cases))
            self.arrays = {name: np.empty((*cases, count, width)) for name, width in widths.items()}
        for name, array in self.arrays.items():
            shape, wanted = getattr(array, "shape", None), (*cases, count, widths[name])
            if shape != wanted:
                raise InputError(f"target[{name!r}] has shape {shape}: must be an array of shape {wanted}")

    def fill(self, stretch: Stretch, fill: Callable[[Stretch, str, Array], None]) -> int | None:
        """Fill the times of a stretch; the number of the first one that is not finite, if any."""
        begin, end = stretch.begin, stretch.end
        self.last, self.parts = None, {}  # no two parts at once
        for name, width in self.widths.items():
            if self.target is None:
                part = self.arrays[name].reshape(-1, self.count, width)[:, begin:end]
            else:
                part = np.empty((math.prod(self.cases), end - begin, width))
            self.parts[name] = part
            fill(stretch, name, part)
        if stretch.finite:
            return None
        finite = np.logical_and.reduce([np.isfinite(part).all(axis=(0, 2)) for part in self.parts.values()])
        return None if finite.all() else begin + int(np.argmin(finite))

    def hand_on(self, stretch: Stretch, about: Callable[..., Response]) -> None:
        """Give what was filled to the target. about: makes a `Response` of arrays and the rest."""
        if self.target is None:
            return
        begin, end = stretch.begin, stretch.end
        shaped = {name: part.reshape(*self.cases, end - begin, -1) for name, part in self.parts.items()}
        if callable(self.target):
            self.last = about(begin=begin, end=end, **self._named(shaped))
            self.target(self.last)
        else:
            for name, part in shaped.items():
                self.arrays[name][..., begin:end, :] = part

    def response(self, about: Callable[..., Response]) -> Response:
        """The whole of it; of what a function took, the last part."""
        return self.last or about(begin=0, end=self.count, **self._named(self.arrays))

    def _named(self, arrays: Mapping[str, Any]) -> dict[str, Any]:
        """Arrays by their names; without rigid functions the elastic part is all there is."""
        found = dict(arrays)
        for name in () if self.rigid else set(OUTPUTS) & set(arrays):
            found[f"{name}_elastic"] = arrays[name]
            found[f"{name}_rigid"] = np.broadcast_to(0.0, arrays[name].shape)
        return found


def _check_memory(times: int, columns: int) -> None:
    """InputError where a response takes more than half of the machine's memory."""
    held, needed = memory() / 2, 8 * times * (2 + columns)
    if needed > held:
        raise InputError(Message(
            f"duration / step = {times - 1:.3g} steps, {columns} numbers each: needs {needed / 2**30:.3g} GiB, "
            f"more than the {held / 2**30:.3g} GiB that this machine can give; use fewer sensors, a longer step, or a "
            "target that takes the response in parts (a file, on the command line)"
        ))  # fmt: skip
