"""Response in time: Newmark's method for Eq. (10), and the same system for control engineers.

All quantities are nondimensional, Eq. (5).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache, partial
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from freebeam_sym.checks import InputError, positions, positive
from freebeam_sym.response.double import Fixed
from freebeam_sym.response.inputs import (
    Function,
    Harmonic,
    Wave,
    cases_of,
    check_memory,
    checked,
    checked_parameters,
    force_of,
    position_of,
    spread,
    start_of,
    times_of,
)
from freebeam_sym.response.modal import Modes, steady
from freebeam_sym.response.powers import MatrixPowers, ModalPowers, augmented
from freebeam_sym.response.propagation import Fill, forced, free
from freebeam_sym.response.results import OUTPUTS, Response, Results, Target, names_of
from freebeam_sym.response.stepping import (
    Spectrum,
    acceleration,
    checked_step,
    exact_step,
    overflow,
    scale_of,
    step_matrix,
)

if TYPE_CHECKING:
    from scipy.signal import StateSpace

    from freebeam_sym.columns import System

__all__ = ["respond", "state_space"]

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]


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
    b, g = checked_parameters(newmark)
    x_s = positions("sensors", sensors)
    times = times_of(duration, h)
    n, r = len(system.M), system.rigid_count
    names = names_of(outputs, bool(r), states, target)
    if force is not None and force_position is None:
        raise InputError("force_position is missing: a force needs the place x_F where it acts, from 0 to 1")
    source, force_cases = force_of(force, times, h)
    q, initial_lost = start_of(system, "initial", initial)
    dq, velocity_lost = start_of(system, "initial_velocity", initial_velocity)
    if force is None and initial is None and initial_velocity is None:
        q[r] = 0.01
    cases = cases_of(force_cases, q.shape[:-1], dq.shape[:-1])
    shape = (*cases, n)
    start = np.concatenate([spread(q, shape), spread(dq, shape)], axis=-1).reshape(-1, 2 * n)
    widths = {name: n if name in ("q", "dq") else x_s.size for name in names}
    if target is None:
        check_memory(times, sum(widths.values()) * len(start), x_s.size)
    Q = np.zeros(n)
    if force_position is not None:
        Q = np.asarray(system.Q(position_of("force_position", force_position)), dtype=float)
    spectrum = checked_step(system, h, (b, g))
    about = partial(
        Response, sensors=x_s, step=h, newmark=(b, g), growth=float(spectrum.values.real.max()),
        frequencies=spectrum.frequencies, period_errors=spectrum.period_errors,
        initial_lost=initial_lost, velocity_lost=velocity_lost,
    )  # fmt: skip
    results = Results(about, widths, bool(r), cases, times, target)

    def sample(begin: int, end: int) -> Array:
        assert callable(source)
        return spread(source(begin, end), (*cases, end - begin)).reshape(-1, end - begin)

    def store(begin: int, end: int, fill: Fill, safe: bool) -> None:
        def filled(name: str, part: Array) -> None:
            fill(name, part)
            if not begin:  # without rounding: what rests at first is at rest
                part[:, 0] = start @ rows[name].T + np.multiply.outer(first, direct[name])

        if not safe and callable(source):  # whether it is the force's own doing
            checked("force", sample(begin, end), end - begin, lambda k: h * (begin + k))
        results.take(begin, end, filled, safe, lambda k: overflow(k * h, spectrum.values))
        if progress is not None:
            progress(end / times)

    rows, direct = _rows(system, names, x_s, Q)
    if progress is not None:
        progress(0.0)
    first = np.zeros(1)
    with np.errstate(over="ignore", invalid="ignore"):
        basis = _basis(system, spectrum, h, (b, g))
        if source is None:
            free(basis.powers, basis.states(start), basis.rows(rows), times, store)
        elif isinstance(source, Wave):
            size = spread(source.size, cases).reshape(-1, 1)
            first = size[:, 0].real
            asked = _harmonic(system, spectrum, basis, h, (b, g), start, Q, source, size, rows, direct, duration)
            free(*asked, times, store)
        else:
            _, *pushes = step_matrix(system.column.kernel.newmark_step, system.M, system.C, system.K, Q, h, (b, g))
            first = sample(0, 1)[:, 0]
            state, before, after = (basis.states(part) for part in (start, *pushes))
            forced(basis.powers, state, before, after, basis.rows(rows), direct, sample, times, store)
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
    Q = np.asarray(system.Q(position_of("force_position", force_position)), dtype=float)
    from scipy.signal import StateSpace  # half a second, so only where it is used

    n = Q.size
    rows, direct = _rows(system, outputs, x_s, Q)
    A = np.zeros((2 * n, 2 * n))
    A[:n, n:] = np.eye(n)
    A[n:], force = acceleration(system.M, system.C, system.K, Q)
    C, D = (np.concatenate([part[name] for name in outputs]) for part in (rows, direct))
    return StateSpace(A, np.concatenate([np.zeros(n), force])[:, None], C, D[:, None])


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


@dataclass(frozen=True, eq=False)
class _Scaled:
    """States over their sizes; powers of the step's matrix, which serve every system."""

    powers: MatrixPowers
    scale: Array

    def states(self, states: Array) -> Array:
        return states / self.scale

    def rows(self, rows: dict[str, Array]) -> dict[str, Array]:
        return {name: part * self.scale for name, part in rows.items()}


@dataclass(frozen=True, eq=False)
class _Modal:
    """States in the eigenvectors; powers of the step's eigenvalues, which cost less."""

    powers: ModalPowers
    modes: Modes

    def states(self, states: Array) -> Complex:
        return self.modes.coordinates(states)

    def rows(self, rows: dict[str, Array]) -> dict[str, Any]:
        vectors = self.modes.vectors[:, : self.modes.high.size]
        return {name: part @ vectors for name, part in rows.items()}


def _basis(system: System, spectrum: Spectrum, h: float, newmark: tuple[float, float]) -> _Scaled | _Modal:
    """Coordinates of a response: in the eigenvectors where these serve. Kept from earlier calls, by value."""
    if newmark == (0.25, 0.5) and not system.rigid_count:
        modes, powers = spectrum.modes, spectrum.powers
        if modes is not None and powers is not None:
            return _Modal(powers, modes)
    M, C, K = (np.asarray(part, dtype=float) for part in (system.M, system.C, system.K))
    recurrence = system.column.kernel.newmark_step
    powers_of = _powers(recurrence, len(M), M.tobytes(), C.tobytes(), K.tobytes(), h, newmark)
    return _Scaled(powers_of, scale_of(M, K))


@lru_cache(maxsize=16)
def _powers(
    recurrence: Callable[..., Any], n: int, mass: bytes, damping: bytes, elasticity: bytes, h: float,
    newmark: tuple[float, float],
) -> MatrixPowers:  # fmt: skip
    M, C, K = (np.frombuffer(part).reshape(n, n) for part in (mass, damping, elasticity))
    A, _, _ = step_matrix(recurrence, M, C, K, np.zeros(n), h, newmark)
    return MatrixPowers(exact_step(M, C, K, h, newmark, A, scale_of(M, K)))


@lru_cache(maxsize=16)
def _driven(spectrum: Spectrum, Q: bytes, rotation: Fixed, duration: float) -> tuple[ModalPowers, Complex] | None:
    """Powers of the step's roots and of a wave's rotation, and the steady state that it drives; see `steady`. Kept, by
    the spectrum that was kept."""
    M, C, K = spectrum.matrices
    if spectrum.modes is None or spectrum.powers is None:
        return None
    drive = np.concatenate([np.zeros(len(M)), acceleration(M, C, K, np.frombuffer(Q))[1]])
    found = steady(spectrum.modes, drive, rotation, spectrum.step, duration)
    if found is None:
        return None
    found.flags.writeable = False
    return ModalPowers([rotation], spectrum.powers), found


def _harmonic(
    system: System,
    spectrum: Spectrum,
    basis: _Scaled | _Modal,
    h: float,
    newmark: tuple[float, float],
    start: Array,
    Q: Array,
    wave: Wave,
    size: Complex,
    rows: dict[str, Array],
    direct: dict[str, Array],
    duration: float,
) -> tuple[MatrixPowers | ModalPowers, Any, dict[str, Any]]:
    """Powers, states and rows with the force among the states. size: of the force, (cases, 1)."""
    M, C, K = system.M, system.C, system.K
    driven = _driven(spectrum, Q.tobytes(), wave.rotation, duration) if isinstance(basis, _Modal) else None
    if driven is not None:
        modal, found = driven
        states = np.concatenate([basis.states(start - (size * found).real), size], axis=1)
        forced_rows = {name: (part @ found + direct[name])[:, None] for name, part in rows.items()}
        wide = {name: np.hstack([part, forced_rows[name]]) for name, part in basis.rows(rows).items()}
        return modal, states, wide
    scale = scale_of(M, K)
    A, before, after = step_matrix(system.column.kernel.newmark_step, M, C, K, Q, h, newmark)
    exact = exact_step(M, C, K, h, newmark, A, scale)
    powers = MatrixPowers(augmented(exact, before / scale, after / scale, wave.rotation))
    wide = {name: np.hstack([part * scale, np.outer(direct[name], [1, 0])]) for name, part in rows.items()}
    return powers, np.hstack([start / scale, size.real, size.imag]), wide
