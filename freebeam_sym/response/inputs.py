"""What a response is asked with: forces, initial states, times; checked, and as arrays. Nondimensional."""

from __future__ import annotations

import math
import os
from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from freebeam_sym.checks import InputError, array, finite, nonnegative, positions, reals, refusal
from freebeam_sym.response.double import BITS, Fixed, exponential, fixed
from freebeam_sym.response.messages import Message

if TYPE_CHECKING:
    from freebeam_sym.columns import System

Array = NDArray[np.float64]
Function = Callable[[Any], Any]

LOST = 1e-5 / np.finfo(float).eps  # radians, of which the digits of a frequency leave 1e-5 undecided


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


class Wave(NamedTuple):
    """A force Re(size e^(iθn)) after n steps, with size (*cases,), its frequency θ/h, and e^(iθ) to more digits."""

    size: NDArray[np.complex128]
    frequency: float
    rotation: Fixed


def checked_parameters(newmark: tuple[float, float]) -> tuple[float, float]:
    try:
        b, g = newmark
    except (TypeError, ValueError):
        raise refusal("newmark", newmark, "must be two numbers (b, g), such as (0.25, 0.5)") from None
    return nonnegative("newmark[0]", b), nonnegative("newmark[1]", g)


def position_of(name: str, value: object) -> float:
    finite(name, value)  # one number, no sequence
    return float(positions(name, value)[0])  # type: ignore[arg-type]


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
        found: Array = np.arange(begin, end, dtype=np.float64) * top / bottom
        return found
    return float(step) * np.arange(begin, end, dtype=np.float64)


def check_memory(times: int, columns: int, sensors: int) -> None:
    needed, held = 8 * times * (2 + columns), _memory()
    if needed > held:
        raise InputError(Message(
            f"duration / step = {times - 1:.3g} steps at {sensors} sensors: needs {needed / 2**30:.3g} GiB, "
            f"more than the {held / 2**30:.3g} GiB that this machine can give; use fewer sensors, a longer step, or a "
            "target that takes the response in parts (a file, on the command line)"
        ))  # fmt: skip


def _memory() -> float:
    """Bytes that one response may take: half of the machine's memory."""
    try:
        return 0.5 * os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    except (AttributeError, ValueError, OSError):  # no such call, as on Windows
        return 4.0 * 2**30


def _evaluate(name: str, function: Function, points: Array) -> Array:
    """Values (*cases, points) of a function that may take an array of points or one point at a time."""
    values: Any
    try:
        values = np.asarray(function(points.copy()))
        whole = values.ndim > 0 and values.shape[-1] == points.size
        for k in (0, points.size // 2, points.size - 1) if whole else ():
            one, here = _single(function, points[k]), values[..., k]
            whole = whole and (
                one is None or np.shape(one) != here.shape or np.allclose(one, here, rtol=1e-9, atol=0, equal_nan=True)
            )
    except Exception:  # written for one number: math.sin, if t < 1
        whole = False
    if not whole:
        values = np.stack([np.asarray(function(point)) for point in points.tolist()], axis=-1)
    return checked(name, values, points.size, lambda k: points[k])


def _single(function: Function, point: float) -> Any:
    try:
        return function(float(point))
    except Exception:  # written for arrays only
        return None


def _floats(name: str, values: NDArray[Any], count: int) -> Array:
    """Values (*cases, count), one a point, as floats."""
    if values.shape[-1:] != (count,) or values.dtype.kind not in "iuf":
        raise InputError(
            f"{name} gives values of shape {values.shape} and type {values.dtype}: must give one real number a point"
        )
    return values.astype(float, copy=False)


def checked(name: str, values: NDArray[Any], count: int, place: Callable[[int], float]) -> Array:
    """Values (*cases, count), one a point, as finite floats. place: of a point, for the message."""
    result = _floats(name, values, count)
    flat = result.ravel()
    if not math.isfinite(np.vdot(flat, flat)):  # or too large to be squared
        bad = np.argwhere(~np.isfinite(result))
        if bad.size:
            at = tuple(bad[0])
            raise InputError(f"{name} = {result[at]:g} at {place(at[-1]):g}: must be finite")
    return result


def force_of(force: Any, times: int, h: float) -> tuple[Wave | Callable[[int, int], Array] | None, tuple[int, ...]]:
    """What gives the force after any number of steps, and the shape of its cases; an array's values are not checked."""
    if force is None:
        return None, ()
    if isinstance(force, Harmonic):
        frequency = finite("force.frequency", force.frequency)
        if LOST < abs(frequency) * h * times:
            raise InputError(Message(
                "force.frequency = {omega:frequency}: turns by more radians in this response than its digits tell; "
                "choose a shorter duration", omega=frequency,
            ))  # fmt: skip
        size, phase = (reals(f"force.{name}", getattr(force, name)) for name in ("amplitude", "phase"))
        whole = np.asarray(size * (np.sin(phase) - 1j * np.cos(phase)))
        return Wave(whole, frequency, exponential((0, fixed(frequency) * fixed(h) >> BITS))), whole.shape
    if callable(force):
        step = Fraction(repr(h))
        cases = _evaluate("force", force, moments(step, 0, 2)).shape[:-1]

        def sampled(begin: int, end: int) -> Array:
            found = _evaluate("force", force, moments(step, begin, end))
            if found.shape[:-1] != cases:
                raise InputError(
                    f"force gives values of shape {found.shape[:-1]} at one time and {cases} at another: must be one "
                    "number at each time, or one for each load case"
                )
            return found

        return sampled, cases
    values = array("force", force)
    if values.ndim == 0:
        return Wave(np.asarray(complex(finite("force", force))), 0.0, exponential((0, 0))), ()
    if values.shape[-1] != times:
        raise InputError(
            f"force has shape {values.shape}: must be a function of time, one number, or an array of shape "
            f"({times},) or (*cases, {times}), a value at each of the {times - 1} steps' ends and at t = 0"
        )

    def given(begin: int, end: int) -> Array:
        return _floats("force", values[..., begin:end], end - begin)

    return given, values.shape[:-1]


def start_of(system: System, name: str, value: Function | ArrayLike | None) -> tuple[Array, float]:
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
    """Least squares over the beam, ∫ φᵢ (y − Σ φⱼ qⱼ) dx = 0, and the part of y that is lost.

    M-orthogonal for a uniform beam, where M holds the integrals of φᵢ φⱼ. Gauss-Legendre in panels, each at
    most two half-waves of the highest mode.
    """
    nodes, weights = np.polynomial.legendre.leggauss(16)
    edges = np.linspace(0, 1, system.modes // 2 + 9)
    x = (edges[:-1, None] + np.diff(edges)[:, None] * (nodes + 1) / 2).ravel()
    w = (np.diff(edges)[:, None] * weights / 2).ravel()
    y = _evaluate(name, function, x)
    if y.ndim > 1:
        raise InputError(f"{name} gives values of shape {y.shape[:-1]} at a point: must give one; cases are arrays")
    shapes = np.asarray(system.shapes(x), dtype=float)
    weighted = shapes * w
    q = np.linalg.solve(weighted @ shapes.T, weighted @ y)
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


def cases_of(*shapes: tuple[int, ...]) -> tuple[int, ...]:
    try:
        found = np.broadcast_shapes(*shapes)
    except ValueError:
        raise InputError(
            f"load cases of shapes {shapes[0]} (force), {shapes[1]} (initial) and {shapes[2]} (initial_velocity): must "
            "broadcast to one shape"
        ) from None
    if 0 in found:
        raise InputError(f"load cases of shape {found}: must be one or more")
    return found


def spread(values: NDArray[Any], shape: tuple[int, ...]) -> NDArray[Any]:
    """As np.broadcast_to, which takes its time where there is nothing to do."""
    return values if values.shape == shape else np.broadcast_to(values, shape)
