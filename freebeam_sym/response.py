"""Response in time: Newmark's method for Eq. (10), and the same system for control engineers.

All quantities are nondimensional, Eq. (5).
"""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .checks import InputError, finite, nonnegative, positions, positive
from .double import BITS, Fixed, fixed, turn
from .modal import steady, trapezoidal
from .powers import MatrixPowers, ModalPowers, augmented
from .propagation import Fill, forced, free
from .results import OUTPUTS, Response, Results, Target, names_of
from .stepping import Spectrum, acceleration, checked_step, exact_step, overflow, scale_of, step_matrix

if TYPE_CHECKING:
    from scipy.signal import StateSpace

    from .columns import System

__all__ = ["Harmonic", "Response", "respond", "state_space"]

Array = NDArray[np.float64]
Function = Callable[[Any], Any]


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
    """A force Re(size e^(iθn)) after n steps, with size (*cases,) and e^(iθ) to more digits."""

    size: NDArray[np.complex128]
    rotation: Fixed


def respond(
    system: System,
    duration: float,
    step: float,
    *,
    force: Function | ArrayLike | Harmonic | None = None,
    force_position: float | None = None,
    newmark: tuple[float, float] = (0.25, 0.5),
    initial: Function | ArrayLike | None = None,
    initial_velocity: Function | ArrayLike | None = None,
    sensors: ArrayLike = (0.1,),
    outputs: Sequence[str] = OUTPUTS,
    states: bool = False,
    target: Target | None = None,
    progress: Callable[[float], object] | None = None,
) -> Response:
    """Response of `system` by Newmark's method, at times 0, step, 2 step, … up to `duration`. Eqs. (9), (10).

    The recurrence is the textbook's, without its loop and with less of its rounding. Leading axes of `force`, `initial`
    and `initial_velocity` are load cases, `cases`, and broadcast like NumPy's; so are those of the results.

    force: F₀ as a function of time (of an array of times, (*cases, times) then, or of one time), as an array of shape
        (*cases, steps + 1), one value a time, as one constant, or a `Harmonic`; zero by default. Without a force, with
        a constant or harmonic one the response has a closed form, which is faster.
    force_position: x_F, needed with a force.
    newmark: (b, g); the default is average acceleration, stable at any step.
    initial, initial_velocity: q and dq/dt at t = 0, shape (*cases, n), or functions of x, the shape y(x) and the
        velocity dy/dt(x), projected on the trial functions. Where neither is given: rest with a force,
        else the first elastic mode with q₁ = 0.01. The initial acceleration follows from Eq. (10).
    sensors: x_s, shape (sensors,).
    outputs: of "y", "dy", "ddy", those to compute.
    states: keep q and dq of every step too.
    target: where a response goes that is longer than memory: a function, called with one part of the response after
        another, itself a `Response` of the times begin, …, end − 1 (`respond` returns the last part); or a mapping of
        names ("y", "ddy", "y_rigid", "q", …) to arrays of the results' shapes, such as np.memmap, h5py's or zarr's,
        which are filled and are all that is computed. Memory is bounded by a stretch of some 10⁶ numbers.
    progress: called with the fraction done, from 0 to 1, now and then.

    Raises InputError for bad input, for a step beyond the stability limit of `newmark` (roots that grow
    where the exact ones do not; decided on the elastic part), where the arrays exceed memory, and for a
    response that grows past the range of floats.
    """
    duration, h = positive("duration", duration), positive("step", step)
    b, g = _parameters(newmark)
    x_s = positions("sensors", sensors)
    times = _times(duration, h)
    n, r = len(system.M), system.rigid_count
    names = names_of(outputs, bool(r), states, target)
    if force is not None and force_position is None:
        raise InputError("force_position is missing: a force needs the place x_F where it acts, from 0 to 1")
    source, force_cases = _force(force, times, h)
    q, initial_lost = _start(system, "initial", initial)
    dq, velocity_lost = _start(system, "initial_velocity", initial_velocity)
    if force is None and initial is None and initial_velocity is None:
        q[r] = 0.01
    cases = _cases(force_cases, q.shape[:-1], dq.shape[:-1])
    shape = (*cases, n)
    start = np.concatenate([np.broadcast_to(q, shape), np.broadcast_to(dq, shape)], axis=-1).reshape(-1, 2 * n)
    widths = {name: n if name in ("q", "dq") else x_s.size for name in names}
    if target is None:
        _fits(times, sum(widths.values()) * len(start), x_s.size)
    Q = np.zeros(n)
    if force_position is not None:
        Q = np.asarray(system.Q(_position("force_position", force_position)), dtype=float)
    spectrum = checked_step(system, h, (b, g))
    about = Response(
        sensors=x_s, step=h, newmark=(b, g), growth=float(spectrum.values.real.max()),
        frequencies=spectrum.frequencies, period_errors=spectrum.period_errors,
        initial_lost=initial_lost, velocity_lost=velocity_lost,
    )  # fmt: skip
    results = Results(about, widths, bool(r), cases, times, target)

    def store(begin: int, end: int, fill: Fill, safe: bool) -> None:
        def filled(name: str, part: Array) -> None:
            fill(name, part)
            if not begin:  # without rounding: what rests at first is at rest
                part[:, 0] = start @ rows[name].T + np.multiply.outer(first, direct[name])

        results.take(begin, end, filled, safe, lambda k: overflow(k * h, spectrum.values))
        if progress is not None:
            progress(end / times)

    rows, direct = _rows(system, names, x_s, Q)
    if progress is not None:
        progress(0.0)
    with np.errstate(over="ignore", invalid="ignore"):
        if source is None or isinstance(source, Wave):
            first = np.zeros(1) if source is None else np.broadcast_to(source.size.real, cases).reshape(-1)
            free(*_closed(system, spectrum, h, (b, g), start, Q, source, cases, rows, direct, duration), times, store)
        else:
            powers, before, after, scale = _matrix_powers(system, h, (b, g), Q)
            scaled = {name: part * scale for name, part in rows.items()}

            def sample(begin: int, end: int) -> Array:
                return np.broadcast_to(source(begin, end), (*cases, end - begin)).reshape(-1, end - begin)

            first = sample(0, 1)[:, 0]
            forced(powers, start / scale, before, after, scaled, direct, sample, times, store)
    return results.response()


def state_space(
    system: System, force_position: float, sensors: ArrayLike = (0.1,), outputs: Sequence[str] = ("y",)
) -> StateSpace:
    """The same system as a `scipy.signal.StateSpace`: state (q, dq), input F₀, outputs at sensors. Eq. (25).

    The outputs are those named, of "y", "dy", "ddy", each at all sensors, in that order. Raises InputError
    for positions off the beam and for an unknown output.
    """
    names_of(outputs, False, False, None)
    x_s = positions("sensors", sensors)
    Q = np.asarray(system.Q(_position("force_position", force_position)), dtype=float)
    from scipy.signal import StateSpace  # half a second, so only where it is used

    n = Q.size
    rows, direct = _rows(system, outputs, x_s, Q)
    A = np.zeros((2 * n, 2 * n))
    A[:n, n:] = np.eye(n)
    A[n:], force = acceleration(system.M, system.C, system.K, Q)
    C, D = (np.concatenate([part[name] for name in outputs]) for part in (rows, direct))
    return StateSpace(A, np.concatenate([np.zeros(n), force])[:, None], C, D[:, None])


# Input


def _parameters(newmark: tuple[float, float]) -> tuple[float, float]:
    try:
        b, g = newmark
    except (TypeError, ValueError):
        raise InputError(f"newmark = {newmark!r}: must be two numbers (b, g), such as (0.25, 0.5)") from None
    return nonnegative("newmark[0]", b), nonnegative("newmark[1]", g)


def _position(name: str, value: object) -> float:
    finite(name, value)  # one number, no sequence
    return float(positions(name, value)[0])  # type: ignore[arg-type]


def _times(duration: float, h: float) -> int:
    """Number of times, the first one included."""
    ratio = duration / h
    if ratio < 1 - 1e-9:
        raise InputError(f"step = {h:g}: must not be longer than the duration, {duration:g}")
    ratio = min(ratio, 1e300)
    near = round(ratio)
    return 1 + (near if abs(ratio - near) <= 1e-9 * ratio else math.floor(ratio))


def _fits(times: int, columns: int, sensors: int) -> None:
    needed, held = 8 * times * (2 + columns), _memory()
    if needed > held:
        raise InputError(
            f"duration / step = {times - 1:.3g} steps at {sensors} sensors: needs {needed / 2**30:.3g} GiB, "
            f"more than the {held / 2**30:.3g} GiB that this machine can give; use fewer sensors, a longer step, or a "
            "target that takes the response in parts (a file, on the command line)"
        )


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
    return _real(name, values, points.size, lambda k: points[k])


def _single(function: Function, point: float) -> Any:
    try:
        return function(float(point))
    except Exception:  # written for arrays only
        return None


def _real(name: str, values: NDArray[Any], count: int, place: Callable[[int], float]) -> Array:
    """Values (*cases, count), one a point, as finite floats. place: of a point, for the message."""
    if values.shape[-1:] != (count,) or values.dtype.kind not in "biuf":
        raise InputError(
            f"{name} gives values of shape {values.shape} and type {values.dtype}: must give one real number a point"
        )
    result = values.astype(float, copy=False)
    flat = result.ravel()
    if not math.isfinite(np.vdot(flat, flat)):  # or too large to be squared
        bad = np.argwhere(~np.isfinite(result))
        if bad.size:
            at = tuple(bad[0])
            raise InputError(f"{name} = {result[at]:g} at {place(at[-1]):g}: must be finite")
    return result


def _force(force: Any, times: int, h: float) -> tuple[Wave | Callable[[int, int], Array] | None, tuple[int, ...]]:
    """What gives the force after any number of steps, and the shape of its cases."""
    if force is None:
        return None, ()
    if isinstance(force, Harmonic):
        angle = fixed(finite("force.frequency", force.frequency)) * fixed(h) >> BITS
        size, phase = (np.asarray(getattr(force, name)) for name in ("amplitude", "phase"))
        for name, value in (("amplitude", size), ("phase", phase)):
            _real(f"force.{name}", value.reshape(-1), value.size, float)
        whole = np.asarray(size * (np.sin(phase) - 1j * np.cos(phase)))
        return Wave(whole, turn(angle)), whole.shape
    if callable(force):

        def sampled(begin: int, end: int) -> Array:
            return _evaluate("force", force, h * np.arange(begin, end, dtype=float))

        return sampled, _evaluate("force", force, h * np.arange(2.0)).shape[:-1]
    values = np.asarray(force)
    if values.ndim == 0:
        return Wave(np.asarray(complex(finite("force", force))), turn(0)), ()
    if values.shape[-1] != times:
        raise InputError(
            f"force has shape {values.shape}: must be a function of time, one number, or an array of shape "
            f"({times},) or (*cases, {times}), a value at each of the {times - 1} steps' ends and at t = 0"
        )

    def given(begin: int, end: int) -> Array:
        return _real("force", values[..., begin:end], end - begin, lambda k: h * (begin + k))

    return given, values.shape[:-1]


def _start(system: System, name: str, value: Function | ArrayLike | None) -> tuple[Array, float]:
    n = len(system.M)
    if value is None:
        return np.zeros(n), 0.0
    if callable(value):
        return _project(system, name, value)
    values = np.asarray(value)
    if values.shape[-1:] != (n,):
        raise InputError(
            f"{name} has shape {values.shape}: must be of shape ({n},) or (*cases, {n}), one value a trial function, "
            "or a function of x"
        )
    return _real(name, values, n, float), 0.0


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


def _cases(*shapes: tuple[int, ...]) -> tuple[int, ...]:
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


# Rows and powers


def _rows(system: System, names: Sequence[str], x_s: Array, Q: Array) -> tuple[dict[str, Array], dict[str, Array]]:
    """What gives each output from (q, dq), (s, 2 n), and from F₀, (s,)."""
    n, r = len(Q), system.rigid_count
    shapes = np.asarray(system.shapes(x_s), dtype=float).T
    rows, direct = {}, {}
    if any(name.startswith("ddy") for name in names):
        state, force = acceleration(system.M, system.C, system.K, Q)
    for name in names:
        order, _, part = name.partition("_")
        own = np.eye(n) if order in ("q", "dq") else shapes.copy()
        own[:, {"": slice(0), "elastic": slice(0, r), "rigid": slice(r, None)}[part]] = 0
        none = np.zeros_like(own)
        if order == "ddy":
            rows[name], direct[name] = own @ state, own @ force
        else:
            rows[name] = np.hstack([none, own] if order.startswith("d") else [own, none])
            direct[name] = np.zeros(len(own))
    return rows, direct


def _matrix_powers(
    system: System, h: float, newmark: tuple[float, float], Q: Array, rotation: Fixed | None = None
) -> tuple[MatrixPowers, Array, Array, Array]:
    """Powers of the step, what the force before and after it adds, the state's scale. With a rotation, augmented."""
    M, C, K = (np.asarray(part, dtype=float) for part in (system.M, system.C, system.K))
    recurrence, scale = system.column.kernel.newmark_step, scale_of(M, K)
    A, before, after = step_matrix(recurrence, M, C, K, Q, h, newmark)
    before, after = before / scale, after / scale
    if rotation is not None:
        exact = exact_step(M, C, K, h, newmark, A, scale)
        return MatrixPowers(augmented(exact, before, after, rotation)), before, after, scale
    return _powers(len(M), M.tobytes(), C.tobytes(), K.tobytes(), h, newmark, A.tobytes()), before, after, scale


@lru_cache(maxsize=16)
def _powers(
    size: int, mass: bytes, damping: bytes, elasticity: bytes, h: float, newmark: tuple[float, float], step: bytes
) -> MatrixPowers:
    """Powers of a system's step, kept from earlier calls, by value."""
    M, C, K = (np.frombuffer(part).reshape(size, size) for part in (mass, damping, elasticity))
    A = np.frombuffer(step).reshape(2 * size, 2 * size)
    return MatrixPowers(exact_step(M, C, K, h, newmark, A, scale_of(M, K)))


def _closed(
    system: System,
    spectrum: Spectrum,
    h: float,
    newmark: tuple[float, float],
    start: Array,
    Q: Array,
    wave: Wave | None,
    cases: tuple[int, ...],
    rows: dict[str, Array],
    direct: dict[str, Array],
    duration: float,
) -> tuple[MatrixPowers | ModalPowers, Any, dict[str, Any]]:
    """Powers, states and rows of a free or harmonic response: eigenvalues' where they serve, else the matrix's."""
    M, C, K = system.M, system.C, system.K
    modes = None
    if newmark == (0.25, 0.5) and not system.rigid_count:
        modes = spectrum.modes
    size = None if wave is None else np.broadcast_to(wave.size, cases).reshape(-1, 1)
    if modes is not None:
        roots = trapezoidal(modes, h)
        vectors = modes.vectors[:, : modes.high.size]
        if wave is None or size is None:
            states = modes.coordinates(start)
            return ModalPowers(roots), states, {name: part @ vectors for name, part in rows.items()}
        drive = np.concatenate([np.zeros(len(M)), acceleration(M, C, K, Q)[1]])
        found = steady(modes, drive, wave.rotation, h, duration)
        if found is not None:
            states = np.concatenate([modes.coordinates(start - (size * found).real), size], axis=1)
            wide = {
                name: np.hstack([part @ vectors, (part @ found + direct[name])[:, None]]) for name, part in rows.items()
            }
            return ModalPowers([*roots, wave.rotation]), states, wide
    powers, _, _, scale = _matrix_powers(system, h, newmark, Q, None if wave is None else wave.rotation)
    rows = {name: part * scale for name, part in rows.items()}
    if size is None:
        return powers, start / scale, rows
    rows = {name: np.hstack([part, np.outer(direct[name], [1, 0])]) for name, part in rows.items()}
    return powers, np.hstack([start / scale, size.real, size.imag]), rows
