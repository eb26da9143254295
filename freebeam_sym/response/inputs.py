"""What a response is asked with: forces, initial states, times; checked, and as arrays. Nondimensional."""

from __future__ import annotations

import math
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, replace
from fractions import Fraction
from string import Formatter
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from freebeam_sym.checks import InputError, array, finite, place, reals
from freebeam_sym.response.digits import Array, Complex

if TYPE_CHECKING:
    from freebeam_sym.columns import System

Function = Callable[[Any], Any]

LOST = 1e-5 / np.finfo(float).eps
"""Radians, of which the digits of a frequency leave 1e-5 undecided."""


@dataclass(frozen=True)
class Harmonic:
    """The force F₀(t) = amplitude sin(frequency t + phase), whose response has a closed form.

    amplitude, phase: one number or an array of shape (*cases,), one a load case. frequency: angular, one number.

    >>> float(Harmonic(2.0, frequency=3.0)(0.5))
    1.994989973208109
    """

    amplitude: ArrayLike
    frequency: float
    phase: ArrayLike = 0.0

    def __call__(self, t: ArrayLike) -> Any:
        """F₀ at times t, shape (*cases, *t.shape)."""
        t = np.asarray(t, dtype=float)
        amplitude, phase = (np.reshape(v, np.shape(v) + (1,) * t.ndim) for v in (self.amplitude, self.phase))
        return amplitude * np.sin(self.frequency * t + phase)


@dataclass(frozen=True)
class Load:
    """A force F₀ with its vector Q, (n,), in load cases: Re(size e^(iωt)), or values at the steps, or none."""

    Q: Array
    cases: tuple[int, ...] = ()
    size: Complex | None = None
    """(*cases,)"""
    frequency: float = 0.0
    sampled: Callable[[int, int], Array] | None = None
    """F₀ at the times begin, …, end − 1, (*cases, end − begin)."""

    @property
    def acts(self) -> bool:
        return self.size is not None or self.sampled is not None

    def over(self, cases: tuple[int, ...]) -> Load:
        """The same in all load cases of a response, their axes as one: size (cases, 1), values (cases, times)."""
        size, sampled = self.size, self.sampled

        def values(begin: int, end: int) -> Array:
            assert sampled is not None
            return np.broadcast_to(sampled(begin, end), (*cases, end - begin)).reshape(-1, end - begin)

        whole = None if size is None else np.broadcast_to(size, cases).reshape(-1, 1)
        return replace(self, size=whole, sampled=sampled and values)

    @property
    def first(self) -> Array:
        """F₀ at t = 0 in these cases."""
        if self.sampled is not None:
            return self.sampled(0, 1)[:, 0]
        return np.zeros(1) if self.size is None else self.size[:, 0].real


@dataclass(frozen=True)
class Start:
    """States (q, dq) at t = 0, (number of cases, 2 n), and what the trial functions could not hold of them."""

    states: Array
    cases: tuple[int, ...]
    """Of the response."""
    initial_lost: float
    velocity_lost: float


def times_of(duration: float, h: float) -> int:
    """Number of times, the first one included."""
    ratio = duration / h
    if ratio < 1 - 1e-9:
        raise InputError(Message(
            "step = {h:time}: must not be longer than the duration, {duration:time}", h=h, duration=duration
        ))  # fmt: skip
    ratio = min(ratio, 1e300)
    near = round(ratio)
    return 1 + (near if abs(ratio - near) <= 1e-9 * ratio else math.floor(ratio))


def moments(step: Fraction, begin: int, end: int) -> Array:
    """k · step for k = begin, …, end − 1, each the float that is nearest, so that it prints as that multiple does."""
    top, bottom = step.numerator, step.denominator
    # where both are floats the quotient is rounded once
    if end * top < 2**53 and int(float(min(bottom, 10**300))) == bottom:
        return np.asarray(np.arange(begin, end, dtype=np.float64) * top / bottom)
    return float(step) * np.arange(begin, end, dtype=np.float64)


def _evaluate(name: str, function: Function, points: Array) -> Array:
    """Values (*cases, points) of a function that may take an array of points or one point at a time."""
    values: Any
    try:
        values = np.asarray(function(points.copy()))
        whole = values.ndim > 0 and values.shape[-1] == points.size
        for k in (0, points.size // 2, points.size - 1) if whole else ():
            one, here = None, values[..., k]
            with suppress(Exception):  # written for arrays only
                one = function(float(points[k]))
            whole = whole and (
                one is None or np.shape(one) != here.shape or np.allclose(one, here, rtol=1e-9, atol=0, equal_nan=True)
            )
    except Exception:  # written for one number: math.sin, if t < 1
        whole = False
    if not whole:
        values = np.stack([np.asarray(function(point)) for point in points.tolist()], axis=-1)
    found = _floats(name, values, points.size)
    check_finite(name, found, points)
    return found


def _floats(name: str, values: NDArray[Any], count: int) -> Array:
    """Values (*cases, count), one for each of some points, as floats."""
    if values.shape[-1:] != (count,) or values.dtype.kind not in "iuf":
        raise InputError(
            f"{name} gives values of shape {values.shape} and type {values.dtype}: must give one real number a point"
        )
    return values.astype(float, copy=False)


def check_finite(name: str, values: Array, points: Array) -> None:
    """InputError for values (*cases, points) that are not all finite."""
    flat = values.ravel()
    if not math.isfinite(np.vdot(flat, flat)):  # or too large to be squared
        for at in np.argwhere(~np.isfinite(values))[:1]:
            raise InputError(f"{name} = {values[tuple(at)]:g} at {points[at[-1]]:g}: must be finite")


def force_of(system: System, force: Any, position: Any, times: int, h: float) -> Load:
    """A force as it was asked for. Whether an array's values are finite is seen in the response."""
    if force is not None and position is None:
        raise InputError("force_position is missing: a force needs the place x_F where it acts, from 0 to 1")
    Q = np.zeros(len(system.M))
    if position is not None:
        Q = np.asarray(system.Q(place("force_position", position)), dtype=float)
    if force is None:
        return Load(Q)
    if isinstance(force, Harmonic):
        return _wave(Q, force, h * times)
    if callable(force):
        return _sampled(Q, force, h)
    values = array("force", force)
    if values.ndim == 0:
        return Load(Q, (), np.asarray(complex(finite("force", force))))
    if values.shape[-1] != times:
        raise InputError(
            f"force has shape {values.shape}: must be a function of time, one number, or an array of shape "
            f"({times},) or (*cases, {times}), a value at each of the {times - 1} steps' ends and at t = 0"
        )

    return Load(Q, values.shape[:-1], sampled=lambda begin, end: _floats("force", values[..., begin:end], end - begin))


def _wave(Q: Array, force: Harmonic, duration: float) -> Load:
    frequency = finite("force.frequency", force.frequency)
    if LOST < abs(frequency) * duration:
        raise InputError(Message(
            "force.frequency = {omega:frequency}: turns by more radians in this response than its digits tell; "
            "choose a shorter duration", omega=frequency,
        ))  # fmt: skip
    size, phase = (reals(f"force.{name}", getattr(force, name)) for name in ("amplitude", "phase"))
    whole = np.asarray(size * (np.sin(phase) - 1j * np.cos(phase)))
    return Load(Q, whole.shape, whole, frequency)


def _sampled(Q: Array, force: Function, h: float) -> Load:
    step = Fraction(repr(h))
    cases = _evaluate("force", force, moments(step, 0, 2)).shape[:-1]

    def values(begin: int, end: int) -> Array:
        found = _evaluate("force", force, moments(step, begin, end))
        if found.shape[:-1] != cases:
            raise InputError(
                f"force gives values of shape {found.shape[:-1]} at one time and {cases} at another: must be one "
                "number at each time, or one for each load case"
            )
        return found

    return Load(Q, cases, sampled=values)


def start_of(system: System, initial: Any, initial_velocity: Any, load: Load) -> Start:
    """The initial states as asked for: rest under a force, else 0.01 of mode 1, where neither is given."""
    q, initial_lost = _coordinates(system, "initial", initial)
    dq, velocity_lost = _coordinates(system, "initial_velocity", initial_velocity)
    if initial is None and initial_velocity is None and not load.acts:
        q += 0.01 * system.mode(1)
    shapes = (load.cases, q.shape[:-1], dq.shape[:-1])
    try:
        cases = np.broadcast_shapes(*shapes)
    except ValueError:
        raise InputError(
            f"load cases of shapes {shapes[0]} (force), {shapes[1]} (initial) and {shapes[2]} (initial_velocity): must "
            "broadcast to one shape"
        ) from None
    if 0 in cases:
        raise InputError(f"load cases of shape {cases}: must be one or more")
    n = q.shape[-1]
    states = np.concatenate([np.broadcast_to(part, (*cases, n)) for part in (q, dq)], axis=-1)
    return Start(states.reshape(-1, 2 * n), cases, initial_lost, velocity_lost)


def _coordinates(system: System, name: str, value: Any) -> tuple[Array, float]:
    """Initial q or dq, (*cases, n), and what was lost of a function."""
    n = len(system.M)
    if value is None:
        return np.zeros(n), 0.0
    if callable(value):
        return _project(system, name, value)
    values = reals(name, value)
    if values.shape[-1:] != (n,):
        raise InputError(
            f"{name} has shape {values.shape}: must be of shape ({n},) or (*cases, {n}), one value a trial function, "
            "or a function of x"
        )
    return values, 0.0


def _project(system: System, name: str, function: Function) -> tuple[Array, float]:
    """Least squares over the beam, ∫ φᵢ (y − Σ φⱼ qⱼ) dx = 0, and the part of y that is lost. What moves no point of
    the beam (other fields, coordinates) is at rest: of all solutions it is the least.

    M-orthogonal for a uniform beam, where M holds the integrals of φᵢ φⱼ. Gauss-Legendre in panels, each at
    most two half-waves of the highest mode.
    """
    nodes, weights = np.polynomial.legendre.leggauss(16)
    general = getattr(getattr(system, "column", None), "general", False)  # a system may be no more than its matrices
    breaks = system.column.kernel.places(**system.parameters) if general else ()  # trial functions may have kinks there
    edges = np.union1d(np.linspace(0, 1, system.modes // 2 + 9), breaks)
    x = (edges[:-1, None] + np.diff(edges)[:, None] * (nodes + 1) / 2).ravel()
    w = (np.diff(edges)[:, None] * weights / 2).ravel()
    y = _evaluate(name, function, x)
    if y.ndim > 1:
        raise InputError(f"{name} gives values of shape {y.shape[:-1]} at a point: must give one; cases are arrays")
    shapes = np.asarray(system.shapes(x), dtype=float)
    q = np.linalg.lstsq((shapes * np.sqrt(w)).T, np.sqrt(w) * y)[0]
    size = math.sqrt(w @ y**2)
    if size == 0:
        return q, 0.0
    fitted = q @ shapes
    if math.sqrt(w @ fitted**2) < 1e-9 * size:
        raise InputError(
            f"{name}: the trial functions hold no part of this shape, so the beam would rest; a rigid "
            "motion needs a system with rigid=True"
        )
    return q, math.sqrt(w @ (y - fitted) ** 2) / size


# Sentences with quantities in them, for errors and warnings: nondimensional, or in a beam's SI units

Say = Callable[[str, float, str], str]


@dataclass(frozen=True)
class _Told(Formatter):
    say: Say

    def format_field(self, value: Any, format_spec: str) -> str:
        kind, _, digits = format_spec.partition(" ")
        return self.say(kind, value, digits or ".6g")


class Message(str):
    """A template such as "step = {h:time}: …" with its quantities. As a string, it has them nondimensional, Eq. (5).

    After the colon stands the kind of the quantity (time, length, frequency, rate, …) and, after a blank, the format.
    """

    template: str
    quantities: dict[str, float]

    def __new__(cls, template: str, **quantities: float) -> Message:
        told = _Told(lambda _, value, digits: format(value, digits)).vformat(template, (), quantities)
        text = super().__new__(cls, told)
        text.template, text.quantities = template, quantities
        return text

    def told(self, say: Say) -> str:
        """The sentence with each quantity as `say` has it: from its kind, its nondimensional value and the format."""
        return _Told(say).vformat(self.template, (), self.quantities)
