"""Response in time: Newmark's method for Eq. (10), and the same system for control engineers.

The recurrence is the emitted `newmark_step`. It is linear, so it is applied once to unit states, which
gives the step as a matrix, and that matrix is then applied to blocks of steps at a time. All quantities are
nondimensional, Eq. (5).
"""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .checks import InputError, finite, nonnegative, positions, positive

if TYPE_CHECKING:
    from scipy.signal import StateSpace

    from .columns import System

__all__ = ["Response", "respond", "state_space"]

Array = NDArray[np.float64]
Function = Callable[[Any], Any]

OUTPUTS = ("y", "dy", "ddy")
# Rounding of log |ρ|: a double root, as at the stability limit of an undamped mode, has half the digits.
ROUNDING = 1e-8
# Growth that is real may come out larger by this factor: the method's error, not an instability.
FOLLOWED = 1.1


@dataclass(frozen=True)
class Response:
    """Response at the sensors, nondimensional. Arrays (steps + 1, sensors) unless said otherwise.

    Without rigid functions the elastic part is all there is and the rigid part is zero.
    """

    t: Array
    """Times, shape (steps + 1,)."""
    sensors: Array
    """Positions x_s, shape (sensors,)."""
    y: Array
    dy: Array
    ddy: Array
    y_elastic: Array
    dy_elastic: Array
    ddy_elastic: Array
    y_rigid: Array
    dy_rigid: Array
    ddy_rigid: Array
    q: Array | None
    """Generalised coordinates, shape (steps + 1, n), where `states` asked for them."""
    dq: Array | None
    step: float
    newmark: tuple[float, float]
    growth: float
    """Largest real part of the exact elastic spectrum; positive where the beam flutters or diverges."""
    frequencies: Array
    """Im λ > 0 of the elastic spectrum, ascending."""
    period_errors: Array
    """Newmark's relative period error, numerical period / exact period − 1, one a frequency."""
    initial_lost: float
    """‖y − Σ φᵢ qᵢ‖ / ‖y‖ over the beam, what the functions cannot hold of the initial shape; 0 for a given
    q.
    """
    velocity_lost: float
    """The same of the initial velocity."""

    @property
    def period_error(self) -> float:
        """Newmark's relative period error of the lowest frequency; NaN where nothing oscillates."""
        return float(self.period_errors[0]) if self.period_errors.size else math.nan


def respond(
    system: System,
    duration: float,
    step: float,
    *,
    force: Function | ArrayLike | None = None,
    force_position: float | None = None,
    newmark: tuple[float, float] = (0.25, 0.5),
    initial: Function | ArrayLike | None = None,
    initial_velocity: Function | ArrayLike | None = None,
    sensors: ArrayLike = (0.1,),
    states: bool = False,
    progress: Callable[[float], object] | None = None,
) -> Response:
    """Response of `system` by Newmark's method, at times 0, step, 2 step, … up to `duration`. Eqs. (9), (10).

    force: F₀ as a function of time (of an array of times or of one time), as an array of shape
        (steps + 1,), one value a time, or as one constant; zero by default.
    force_position: x_F, needed with a force.
    newmark: (b, g); the default is average acceleration, stable at any step.
    initial, initial_velocity: q and dq/dt at t = 0, shape (n,), or functions of x, the shape y(x) and the
        velocity dy/dt(x), projected on the trial functions. Where neither is given: rest with a force,
        else the first elastic mode with q₁ = 0.01. The initial acceleration follows from Eq. (10).
    sensors: x_s, shape (sensors,).
    states: keep q and dq of every step too.
    progress: called with the fraction done, from 0 to 1, now and then.

    Raises InputError for bad input, for a step beyond the stability limit of `newmark` (roots that grow
    where the exact ones do not; decided on the elastic part), where the arrays exceed memory, and for a
    response that grows past the range of floats.
    """
    duration, h = positive("duration", duration), positive("step", step)
    b, g = _parameters(newmark)
    x_s = positions("sensors", sensors)
    t = _times(duration, h, x_s.size, system, states)
    history = _history(force, t)
    if force is not None and force_position is None:
        raise InputError("force_position is missing: a force needs the place x_F where it acts, from 0 to 1")
    q, initial_lost = _start(system, "initial", initial)
    dq, velocity_lost = _start(system, "initial_velocity", initial_velocity)
    if force is None and initial is None and initial_velocity is None:
        q[system.rigid_count] = 0.01
    n, rigid = q.size, system.rigid_count
    M, C, K = system.M, system.C, system.K
    Q = np.zeros(n)
    if force_position is not None:
        Q = np.asarray(system.Q(_position("force_position", force_position)), dtype=float)

    recurrence = system.column.kernel.newmark_step
    exact, frequencies, period_errors = _checked_step(recurrence, system, h, (b, g))

    # x = (q, dq) obeys x⁺ = A x + B₀ F₀ + B₁ F₀⁺; w = x − B₁ F₀ needs the force at the old time only.
    A, before, after = _step_matrix(recurrence, M, C, K, Q, h, (b, g))
    B = A @ after + before
    shapes = np.asarray(system.shapes(x_s), dtype=float).T
    output, direct = _output(M, C, K, Q, shapes, rigid)
    propagated = _propagate(
        A,
        B,
        np.concatenate([q, dq]) - after * history[0],
        history,
        after,
        output,
        direct,
        states,
        lambda k: _overflow(t[k], exact),
        progress,
    )
    s = x_s.size
    columns = [propagated[0][:, k * s : (k + 1) * s] for k in range(len(output) // s)]
    elastic = columns[:3]
    falling = columns[3:] if rigid else [np.broadcast_to(0.0, (t.size, s))] * 3
    total = [u + v for u, v in zip(elastic, falling, strict=True)] if rigid else elastic
    kept = propagated[1]
    return Response(
        t=t,
        sensors=x_s,
        y=total[0],
        dy=total[1],
        ddy=total[2],
        y_elastic=elastic[0],
        dy_elastic=elastic[1],
        ddy_elastic=elastic[2],
        y_rigid=falling[0],
        dy_rigid=falling[1],
        ddy_rigid=falling[2],
        q=None if kept is None else kept[:, :n],
        dq=None if kept is None else kept[:, n:],
        step=h,
        newmark=(b, g),
        growth=float(exact.real.max()),
        frequencies=frequencies,
        period_errors=period_errors,
        initial_lost=initial_lost,
        velocity_lost=velocity_lost,
    )


def state_space(
    system: System, force_position: float, sensors: ArrayLike = (0.1,), outputs: Sequence[str] = ("y",)
) -> StateSpace:
    """The same system as a `scipy.signal.StateSpace`: state (q, dq), input F₀, outputs at sensors. Eq. (25).

    The outputs are those named, of "y", "dy", "ddy", each at all sensors, in that order. Raises InputError
    for positions off the beam and for an unknown output.
    """
    unknown = [name for name in outputs if name not in OUTPUTS]
    if isinstance(outputs, str) or unknown or not len(outputs):
        raise InputError(f'outputs = {outputs!r}: must be a sequence of names from "y", "dy", "ddy"')
    x_s = positions("sensors", sensors)
    Q = np.asarray(system.Q(_position("force_position", force_position)), dtype=float)
    from scipy.signal import StateSpace  # half a second, so only where it is used

    n = Q.size
    shapes = np.asarray(system.shapes(x_s), dtype=float).T
    output, direct = _output(system.M, system.C, system.K, Q, shapes, 0)
    rows = np.concatenate([OUTPUTS.index(name) * x_s.size + np.arange(x_s.size) for name in outputs])
    A = np.zeros((2 * n, 2 * n))
    A[:n, n:] = np.eye(n)
    A[n:], force = _acceleration(system.M, system.C, system.K, Q)
    return StateSpace(A, np.concatenate([np.zeros(n), force])[:, None], output[rows], direct[rows, None])


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


def _times(duration: float, h: float, sensors: int, system: System, states: bool) -> Array:
    ratio = duration / h
    if ratio < 1 - 1e-9:
        raise InputError(f"step = {h:g}: must not be longer than the duration, {duration:g}")
    ratio = min(ratio, 1e300)
    near = round(ratio)
    steps = near if abs(ratio - near) <= 1e-9 * ratio else math.floor(ratio)
    columns = 2 + 3 * sensors * (3 if system.rigid_count else 1) + (2 * len(system.M) if states else 0)
    needed, held = 8 * (steps + 1) * columns, _memory()
    if needed > held:
        raise InputError(
            f"duration / step = {steps:.3g} steps at {sensors} sensors: needs {needed / 2**30:.3g} GiB, "
            f"more than the {held / 2**30:.3g} GiB that this machine can give; use fewer sensors, a "
            "longer step or parts"
        )
    return h * np.arange(steps + 1, dtype=np.float64)


def _memory() -> float:
    """Bytes that one response may take: half of the machine's memory."""
    try:
        return 0.5 * os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    except (AttributeError, ValueError, OSError):  # no such call, as on Windows
        return 4.0 * 2**30


def _evaluate(name: str, function: Function, points: Array) -> Array:
    """Values of a function that may take an array of points or one point at a time, shape of `points`."""
    values: Any
    try:
        values = np.asarray(function(points.copy()))
        whole = values.shape == points.shape
        for k in (0, points.size // 2, points.size - 1) if whole else ():
            one = np.asarray(_single(function, points[k]))
            whole = whole and (one.shape != () or bool(np.isclose(one, values[k], rtol=1e-9, equal_nan=True)))
    except Exception:  # written for one number: math.sin, if t < 1
        whole = False
    if not whole:
        values = np.asarray([function(point) for point in points.tolist()])
    return _real(name, values, points)


def _single(function: Function, point: float) -> Any:
    try:
        return function(float(point))
    except Exception:  # written for arrays only
        return np.empty(1)


def _real(name: str, values: NDArray[Any], points: Array) -> Array:
    if values.shape != points.shape or values.dtype.kind not in "biuf":
        raise InputError(
            f"{name} gives values of shape {values.shape} and type {values.dtype}: must give one real number a point"
        )
    result = values.astype(float)
    bad = np.flatnonzero(~np.isfinite(result))
    if bad.size:
        raise InputError(f"{name} = {result[bad[0]]:g} at {points[bad[0]]:g}: must be finite")
    return result


def _history(force: Function | ArrayLike | None, t: Array) -> Array:
    if force is None:
        return np.broadcast_to(0.0, t.shape)
    if callable(force):
        return _evaluate("force", force, t)
    values = np.asarray(force)
    if values.ndim == 0:
        return np.full(t.shape, finite("force", force))
    if values.shape != t.shape:
        raise InputError(
            f"force has shape {values.shape}: must be a function of time, one number, or an array of shape "
            f"({t.size},), a value at each of the {t.size - 1} steps' ends and at t = 0"
        )
    return _real("force", values, t)


def _start(system: System, name: str, value: Function | ArrayLike | None) -> tuple[Array, float]:
    n = len(system.M)
    if value is None:
        return np.zeros(n), 0.0
    if callable(value):
        return _project(system, name, value)
    values = np.asarray(value)
    if values.shape != (n,):
        raise InputError(
            f"{name} has shape {values.shape}: must be of shape ({n},), one value a trial function, or a function of x"
        )
    return _real(name, values, np.arange(n, dtype=float)), 0.0


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


# The step


def _acceleration(M: Array, C: Array, K: Array, Q: Array) -> tuple[Array, Array]:
    """ddq = a (q, dq) + f F₀, the equation of motion (10) solved: a of shape (n, 2n), f of shape (n,)."""
    n = len(M)
    solved = np.linalg.solve(M, np.concatenate([-K, -C, Q[:, None]], axis=1))
    return solved[:, : 2 * n], solved[:, 2 * n]


def _output(M: Array, C: Array, K: Array, Q: Array, shapes: Array, rigid: int) -> tuple[Array, Array]:
    """Rows that give y, dy, ddy at the sensors from (q, dq) and F₀: elastic parts, then rigid ones."""
    state, force = _acceleration(M, C, K, Q)
    rows, direct = [], []
    for part in (slice(rigid, None), slice(0, rigid))[: 2 if rigid else 1]:
        own = np.zeros_like(shapes)
        own[:, part] = shapes[:, part]
        none = np.zeros_like(own)
        rows += [np.hstack([own, none]), np.hstack([none, own]), own @ state]
        direct += [np.zeros(2 * len(own)), own @ force]
    return np.concatenate(rows), np.concatenate(direct)


def _step_matrix(
    recurrence: Callable[..., Any],
    M: Array,
    C: Array,
    K: Array,
    Q: Array,
    h: float,
    newmark: tuple[float, float],
) -> tuple[Array, Array, Array]:
    """A, B₀, B₁ of one step of (q, dq): the recurrence applied to unit states and unit forces."""
    n = len(M)
    state, force = _acceleration(M, C, K, Q)
    unit = np.zeros((2 * n, 2 * n + 2))
    unit[:, :-2] = np.eye(2 * n)
    ddq = np.hstack([state, force[:, None], np.zeros((n, 1))])
    F = np.zeros((n, 2 * n + 2))
    F[:, -1] = Q
    q, dq, _ = recurrence(M, C, K, unit[:n], unit[n:], ddq, F, h, newmark)
    step = np.vstack([q, dq])
    return step[:, :-2], step[:, -2], step[:, -1]


def _coupled(system: System) -> bool:
    """Whether the rigid functions take part in the elastic spectrum; those of the free beam do not."""
    r = system.rigid_count
    K, C = system.K, system.C
    small = 1e-9 * np.abs(K[r:]).max(axis=1, keepdims=True)
    if (np.abs(K[r:, :r]) > small).any() or (np.abs(C[r:, :r]) > small).any():
        return True
    own = np.linalg.solve(system.M[:r, :r], K[:r, :r])
    return bool(np.abs(np.linalg.eigvals(own)).max() > 1e-6 * max(np.abs(own).max(), 1e-300))


def _checked_step(
    recurrence: Callable[..., Any], system: System, h: float, newmark: tuple[float, float]
) -> tuple[NDArray[np.complex128], Array, Array]:
    """Exact eigenvalues, their frequencies, Newmark's period errors; InputError where roots grow that
    should not.

    Rigid functions of a free beam make λ = 0 defective, of a size that rounding decides: the elastic part
    is judged.
    """
    r = system.rigid_count
    part = slice(0 if r and _coupled(system) else r, None)
    M, C, K = (matrix[part, part] for matrix in (system.M, system.C, system.K))
    n = len(M)
    Q = np.zeros(n)
    generator = np.zeros((2 * n, 2 * n))
    generator[:n, n:] = np.eye(n)
    generator[n:] = _acceleration(M, C, K, Q)[0]
    exact = np.linalg.eigvals(generator).astype(complex)
    rates = np.sort(np.maximum(exact.real, 0))[::-1]
    fastest = 0.0  # the rigid part's own decay, β, which a step may overshoot where g < 1/2
    if part.start:
        fastest = float(np.abs(np.linalg.eigvals(np.linalg.solve(system.M[:r, :r], system.C[:r, :r]))).max())
    b, g = newmark
    hopeless = g < 0.5 and not C.any()  # damping of the wrong sign at any step

    def roots(h: float) -> NDArray[np.complex128] | None:
        try:
            with np.errstate(all="ignore"):
                found = np.linalg.eigvals(_step_matrix(recurrence, M, C, K, Q, h, newmark)[0])
        except np.linalg.LinAlgError:  # a singular effective matrix, or overflow
            return None
        return found.astype(complex)

    # The step multiplies K by h² and takes it off again: rounding grows with (ω h)² (measured factor: 1).
    stiffness = np.abs(np.linalg.eigvals(np.linalg.solve(M, K))).max()
    noise = 4 * np.finfo(float).eps * max(float(stiffness), 1e-300)
    if h > math.sqrt(1e-5 / noise):
        raise InputError(
            f"step = {h:g}: the fastest part, ω = {math.sqrt(stiffness):.6g}, would lose its digits to "
            f"rounding, which grows with (ω step)²; choose a step below {math.sqrt(1e-5 / noise):.3g} or "
            "fewer modes"
        )

    def stable(h: float, found: NDArray[np.complex128] | None) -> bool:
        if found is None or not np.isfinite(found).all() or (1 - 2 * g) * fastest * h > 2:
            return False
        growth = np.sort(np.log(np.maximum(np.abs(found), 1e-300)))[::-1]
        return bool((growth <= FOLLOWED * h * rates + ROUNDING + noise * h**2).all())

    found = roots(h)
    if hopeless or not stable(h, found):
        growth = math.exp(min(700.0, h * rates[0]))
        radius = math.nan if found is None else float(np.abs(found).max())
        raise InputError(
            f"step = {h:g}: beyond the stability limit of newmark = ({b:g}, {g:g}): a step multiplies a "
            f"part of the response by up to {radius:.6g}, the exact growth is {growth:.6g}; "
            + _cure(None if hopeless else _largest(lambda h: stable(h, roots(h)), h), rates[0] > 0)
        )
    oscillating = exact[exact.imag > 0]
    oscillating = oscillating[np.argsort(oscillating.imag)]
    assert found is not None  # stable
    return exact, oscillating.imag, _period_errors(recurrence, oscillating, found, h, newmark)


def _cure(largest: float | None, growing: bool) -> str:
    if largest is None:
        return "no step is stable with these parameters: choose g ≥ 1/2, such as newmark = (0.25, 0.5)"
    digits = 5 - math.floor(math.log10(largest))
    # rounded down, so that it may be used as printed
    shown = math.floor(largest * 10.0**digits) / 10.0**digits
    cure = f"the largest stable step is {shown:.6g}"
    return cure if growing else cure + "; newmark = (0.25, 0.5) has no limit here"


def _largest(stable: Callable[[float], bool], h: float) -> float | None:
    low = h
    for _ in range(80):
        low /= 2
        if stable(low):
            break
    else:
        return None
    high = 2 * low
    for _ in range(40):
        middle = (low + high) / 2
        low, high = (middle, high) if stable(middle) else (low, middle)
    return low


def _period_errors(
    recurrence: Callable[..., Any],
    exact: NDArray[np.complex128],
    roots: NDArray[np.complex128],
    h: float,
    newmark: tuple[float, float],
) -> Array:
    """Numerical period / exact period − 1 of each λ.

    Its root of the step is the one nearest to where the method takes a single oscillator of that λ, which
    is the root itself where the system decouples.
    """
    if not exact.size:
        return np.empty(0)
    one = np.ones((exact.size, 1, 1))
    M, C, K = one, -2 * exact.real[:, None, None], (np.abs(exact) ** 2)[:, None, None]
    q, dq = one * [1.0, 0.0], one * [0.0, 1.0]
    q, dq, _ = recurrence(M, C, K, q, dq, -K * q - C * dq, 0 * q, h, newmark)
    single = np.linalg.eigvals(np.concatenate([q, dq], axis=1))
    single = single[np.arange(exact.size), np.argmax(single.imag, axis=1)]
    nearest = roots[np.argmin(np.abs(roots - single[:, None]), axis=1)]
    with np.errstate(divide="ignore"):
        errors: Array = exact.imag * h / np.abs(np.angle(nearest)) - 1
    return errors


# Many steps


def _propagate(
    A: Array,
    B: Array,
    w: Array,
    f: Array,
    after: Array,
    output: Array,
    direct: Array,
    keep: bool,
    overflow: Callable[[int], InputError],
    progress: Callable[[float], object] | None,
) -> tuple[Array, Array | None]:
    """output x + direct f, and x itself where kept, for x = w + after f and w⁺ = A w + B f from `w` on.

    Blocks of steps: one matrix product gives all outputs of a block from its first state and its forces,
    another its last state. Memory beyond the results is bounded. With more outputs than states the blocks
    give the states and the outputs follow from these.
    """
    with np.errstate(over="ignore", invalid="ignore"):
        length = max(32, len(A))
        while length > 1 and not np.abs(np.linalg.matrix_power(A, length)).max() < 1e100:
            length //= 2
        through = keep or len(output) > len(A)
        rows, at_once = (np.eye(len(A)), after) if through else (output, direct + output @ after)
        m, d, count = len(rows), len(A), f.size
        free, forced, last = _block(A, B, rows, at_once, length)
        whole = np.linalg.matrix_power(A, length)
        active = bool(f.any())
        results = np.empty((count, len(output)))
        states = np.empty((count, d)) if keep else None
        blocks = max(1, min(2**22 // (length * m), 2**16 // length))
        for begin in range(0, count, blocks * length):
            end = min(count, begin + blocks * length)
            number = -(-(end - begin) // length)
            forces = np.zeros((number, length))
            forces.ravel()[: end - begin] = f[begin:end]
            starts = _scan(whole, w, forces @ last.T)
            values = starts[:-1] @ free.T
            if active:
                values += forces @ forced.T
            values = values.reshape(-1, m)[: end - begin]
            results[begin:end] = values @ output.T + f[begin:end, None] * direct if through else values
            if states is not None:
                states[begin:end] = values
            finite_rows = np.isfinite(results[begin:end])
            if not finite_rows.all():
                raise overflow(begin + int(np.argmin(finite_rows.all(axis=1))))
            w = starts[-1]
            if progress is not None:
                progress(end / count)
    return results, states


def _block(A: Array, B: Array, rows: Array, direct: Array, length: int) -> tuple[Array, Array, Array]:
    """Outputs of a block from its first state (length m, d) and from its forces (length m, length), and its
    last state from its forces (d, length)."""
    m, d = rows.shape
    free, impulse = np.empty((length, m, d)), np.empty((length + 1, m))
    impulse[0] = direct
    response, last = rows, np.empty((d, length))
    column = B
    for k in range(length):
        free[k] = response
        impulse[k + 1] = response @ B
        last[:, length - 1 - k] = column
        response, column = response @ A, A @ column
    forced = np.zeros((length, m, length))
    for k in range(length):
        forced[k, :, : k + 1] = impulse[: k + 1][::-1].T
    return free.reshape(length * m, d), forced.reshape(length * m, length), last


def _scan(A: Array, w: Array, r: Array) -> Array:
    """All states of w⁺ = A w + r, (len(r) + 1, d): groups of steps side by side, their ends the same way."""
    count, d = r.shape
    group = 16
    states = np.empty((count + 1, d))
    done = 0
    if count >= 4 * group:
        whole = np.linalg.matrix_power(A, group)
        if np.abs(whole).max() < 1e100:  # else zero times infinity could come in where the response is small
            done = count // group * group
            body = r[:done].reshape(-1, group, d)
            total = body[:, 0]
            for k in range(1, group):
                total = total @ A.T + body[:, k]
            starts = _scan(whole, w, total)
            inner = states[:done].reshape(-1, group, d)
            inner[:, 0] = starts[:-1]
            for k in range(1, group):
                inner[:, k] = inner[:, k - 1] @ A.T + body[:, k - 1]
            w = starts[-1]
    states[done] = w
    for k in range(done, count):
        states[k + 1] = A @ states[k] + r[k]
    return states


def _overflow(t: float, exact: NDArray[np.complex128]) -> InputError:
    worst = exact[np.argmax(exact.real)]
    if worst.real * t < 1:
        return InputError(
            f"the response passes the range of floats at t = {t:.6g}: the force or the initial state is too large"
        )
    kind = "flutter" if worst.imag else "divergence"
    return InputError(
        f"the response passes the range of floats at t = {t:.6g}: {kind} grows as exp({worst.real:.6g} "
        "t); choose a shorter duration or a load below the critical one"
    )
