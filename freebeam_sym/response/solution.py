"""Response in time: Eq. (10) by a method of steps.

All quantities are nondimensional, Eq. (5).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from freebeam_sym.checks import InputError, nonnegative, positions, positive, refusal
from freebeam_sym.columns import is_system
from freebeam_sym.massless import Reduced, accelerated, without_mass
from freebeam_sym.response.digits import Array
from freebeam_sym.response.eigen import Spectrum, spectrum_of
from freebeam_sym.response.inputs import (
    LOST,
    Function,
    Harmonic,
    Load,
    Message,
    Start,
    check_finite,
    force_of,
    start_of,
    times_of,
)
from freebeam_sym.response.methods import Exact, Method, Newmark
from freebeam_sym.response.propagation import Stretch, forced, free
from freebeam_sym.response.quality import Quality, warnings_of
from freebeam_sym.response.recurrence import Recurrence, recurrence_of, steps_of
from freebeam_sym.response.results import OUTPUTS, Response, Results, Target, names_of
from freebeam_sym.spectra import state_matrix

if TYPE_CHECKING:
    from freebeam_sym.columns import System

__all__ = ["respond", "rows_of", "with_masses"]

Rows = dict[str, Array]


def respond(
    system: System,
    duration: float,
    step: float,
    *,
    force: Function | ArrayLike | Harmonic | None = None,
    force_position: float | None = None,
    method: str | None = None,
    newmark: tuple[float, float] | None = None,
    initial: Function | ArrayLike | None = None,
    initial_velocity: Function | ArrayLike | None = None,
    sensors: ArrayLike = (0.1,),
    outputs: Sequence[str] = OUTPUTS,
    field: str = "",
    derivative: int = 0,
    states: bool = False,
    target: Target | None = None,
    progress: Callable[[float], object] | None = None,
) -> Response:
    """Response of `system` at times 0, step, 2 step, … up to `duration`. Eqs. (9), (10).

    The exact method solves Eq. (10) up to rounding: its step is how often the response is sampled, and no more.
    Newmark's is the textbook's recurrence, whose error depends on the step. Neither loops over the steps. Leading axes
    of `force`, `initial` and `initial_velocity` are load cases, `cases`, and broadcast like NumPy's; so are those of
    the results. Rounding leaves 1e-12 of the largest value over 10⁵ steps where the eigenvectors are well conditioned;
    at a coalescence, and with rigid functions, the step's matrix is raised to powers in more digits instead.

    force: F₀ as a function of time (of an array of times, (*cases, times) then, or of one time), as an array of shape
        (*cases, steps + 1), one value a time, as one constant, or a `Harmonic`; zero by default. To the exact method a
        constant and a `Harmonic` are what they say at all times; a function or an array is known at the steps, and
        linear between them, so that a jump becomes a ramp of one step. Newmark's method takes the values at the
        steps of any of them. Without a force, with a constant or harmonic one the response has a closed form, which
        is faster.
    force_position: x_F, needed with a force.
    method: "exact", the default, or "newmark".
    newmark: (b, g), which asks for Newmark's method; by default average acceleration, stable at any step.
    initial, initial_velocity: q and dq/dt at t = 0, shape (*cases, n), or functions of x, the shape y(x) and the
        velocity dy/dt(x), projected on the trial functions. Where neither is given: rest with a force,
        else 0.01 of mode 1 of the unloaded beam (`System.mode`). The initial acceleration follows from Eq. (10).
    sensors: x_s, shape (sensors,).
    outputs: of "y", "dy", "ddy", those to compute.
    field, derivative: what sensors read where it is not the deflection: another field of the column or a coordinate,
        and its derivative by x, such as 1 for the slope, as `System.shapes` has them. "y" is then this quantity.
    states: keep q and dq of every step too.
    target: where a response goes that is longer than memory: a function, called with one part of the response after
        another, itself a `Response` of the times begin, …, end − 1 (`respond` returns the last part); or a mapping of
        names ("y", "ddy", "y_rigid", "q", …) to arrays of the results' shapes, such as np.memmap, h5py's or zarr's,
        which are filled and are all that is computed. Memory is bounded by a stretch of some 10⁶ numbers.
    progress: called with the fraction done, from 0 to 1, now and then.

    The result's `warnings` say where the beam is unstable, where Newmark's step puts the motion out of phase by more
    than 1 % of its amplitude, and where the exact method samples it less than twice a period.

    Raises InputError for bad input, for a step beyond the stability limit of `newmark` (roots that grow
    where the exact ones do not; decided on the elastic part), where the arrays exceed memory, and for a
    response that grows past the range of floats or turns through more radians than its matrices have digits for.
    """
    is_system(system)
    duration, h = positive("duration", duration), positive("step", step)
    by = _method(system, method, newmark)
    x_s = positions("sensors", sensors)
    times, n = times_of(duration, h), len(system.M)
    names = names_of(outputs, bool(system.rigid_count), states, target)
    load = force_of(system, force, force_position, times, h)
    start = start_of(system, initial, initial_velocity, load)
    if without_mass(system.M):
        system, load, start = _with_accelerations(system, load, start)
    load = load.over(start.cases)
    widths = {name: n if name in ("q", "dq") else x_s.size for name in names}
    results = Results(widths, bool(system.rigid_count), start.cases, times, target)
    spectrum = spectrum_of(system)
    steps = steps_of(spectrum, by, h)
    if isinstance(by, Exact):
        _check_phase(spectrum, duration)
    if progress is not None:
        progress(0.0)
    rows, direct = rows_of(system, names, x_s, load.Q, field, derivative)

    def about(**parts: Any) -> Response:
        return Response(
            sensors=x_s, step=h, method="exact" if isinstance(by, Exact) else "newmark",
            newmark=(by.b, by.g) if isinstance(by, Newmark) else None, growth=float(spectrum.values.real.max()),
            frequencies=spectrum.values[spectrum.oscillating].imag, period_errors=steps.period_errors,
            phase_error=quality.phase_error, samples_per_period=quality.samples,
            warnings=warnings_of(quality, spectrum.growing, duration),
            initial_lost=start.initial_lost, velocity_lost=start.velocity_lost,
            measured=(field or system.column.unknowns[0]) + "'" * derivative, **parts,
        )  # fmt: skip

    def fill(stretch: Stretch, name: str, part: Array) -> None:
        stretch.fill(name, part)
        if not stretch.begin:  # without rounding: what rests at first is at rest
            part[:, 0] = start.states @ rows[name].T + np.multiply.outer(load.first, direct[name])

    with np.errstate(over="ignore", invalid="ignore"):
        recurrence = recurrence_of(steps, load, duration)
        quality = Quality(steps, recurrence, rows[names[0]], direct[names[0]], load)
        for stretch in _stretches(recurrence, start, load, rows, direct, times):
            quality.see(stretch)
            bad = results.fill(stretch, fill)
            if bad is not None:
                if load.sampled is not None:  # whether it is the force's own doing
                    begin, end = stretch.begin, stretch.end
                    check_finite("force", load.sampled(begin, end), h * np.arange(begin, end, dtype=float))
                raise _overflow(bad * h, spectrum)
            results.hand_on(stretch, about)
            if progress is not None:
                progress(stretch.end / times)
    return results.response(about)


def _stretches(
    recurrence: Recurrence, start: Start, load: Load, rows: Rows, direct: Rows, times: int
) -> Iterator[Stretch]:
    x, powers = recurrence.start(start.states, load.size), recurrence.powers
    own = {name: recurrence.rows(rows[name], direct[name]) for name in rows}
    if load.sampled is None:
        return free(powers, x, own, times)
    return forced(powers, x, (recurrence.before, recurrence.after), own, direct, load.sampled, times)


def _with_accelerations(system: System, load: Load, start: Start) -> tuple[System, Load, Start]:
    """A system with a singular M as one with M = I that moves alike, and what acts on it and starts it. Where the
    start breaks a relation of the states, what has no mass is set by it."""
    found = accelerated(system.M, system.C, system.K)
    alike, Q = with_masses(system, found, load.Q)
    return alike, replace(load, Q=Q), replace(start, states=start.states[:, found.free] @ found.states.T)


def with_masses(system: System, found: Reduced, Q: Array) -> tuple[System, Array]:
    """The system with M = I, and its force. Raises InputError where a force Q acts on what has no mass."""
    if np.abs(found.idle @ Q).max() > 1e-12 * (np.abs(found.idle) @ np.abs(Q)).max(initial=1e-300):
        raise InputError("force_position: the force acts on what has no mass, and its rate would count")
    return replace(system, M=np.eye(len(Q)), C=found.C, K=found.K), found.rows @ Q


def rows_of(
    system: System, names: Sequence[str], x_s: Array, Q: Array, field: str, derivative: int
) -> tuple[Rows, Rows]:
    """What gives each output from (q, dq), (s, 2 n), and from F₀, (s,)."""
    n, r = len(Q), system.rigid_count
    read = system.shapes(x_s, derivative, field) if field or derivative else system.shapes(x_s)
    shapes = np.asarray(read, dtype=float).T
    states: Rows = {"": np.eye(n, 2 * n), "d": np.eye(n, 2 * n, n)}
    if any(name.startswith("ddy") for name in names):
        states["dd"] = state_matrix(system.M, system.C, system.K)[n:]
    rows: Rows = {}
    direct: Rows = {}
    for name in names:
        quantity, _, part = name.partition("_")
        own = np.eye(n) if quantity in ("q", "dq") else shapes.copy()
        own[:, {"": slice(0), "elastic": slice(0, r), "rigid": slice(r, None)}[part]] = 0
        rows[name] = own @ states[quantity[:-1]]
        direct[name] = own @ np.linalg.solve(system.M, Q) if quantity == "ddy" else np.zeros(len(own))
    return rows, direct


def _method(system: System, method: str | None, newmark: tuple[float, float] | None) -> Method:
    if method not in (None, "exact", "newmark"):
        raise refusal("method", method, 'must be "exact" or "newmark"')
    if newmark is None and method != "newmark":
        return Exact()
    if method == "exact":
        raise InputError(f'newmark = {newmark!r}: are parameters of method="newmark", not of the exact one')
    try:
        b, g = (0.25, 0.5) if newmark is None else newmark
    except (TypeError, ValueError):
        raise refusal("newmark", newmark, "must be two numbers (b, g), such as (0.25, 0.5)") from None
    return Newmark(system.column.kernel.newmark_step, nonnegative("newmark[0]", b), nonnegative("newmark[1]", g))


def _check_phase(spectrum: Spectrum, duration: float) -> None:
    """InputError where an oscillation turns by more than the matrices can tell before it has died away."""
    values = spectrum.values
    turned = values.imag * np.minimum(duration, 40 / np.maximum(-values.real, 1e-300))
    worst = int(np.argmax(turned))
    if turned[worst] > LOST:
        raise InputError(Message(
            f"duration = {{duration:time}}: the part of frequency {{omega:frequency}} turns by {turned[worst]:.3g} "
            "radians, and would lose its digits: those of the matrices leave 1e-5 of its phase at {limit:time .3g}; "
            "choose a shorter duration",
            duration=duration, omega=values[worst].imag, limit=LOST / values[worst].imag,
        ))  # fmt: skip


def _overflow(t: float, spectrum: Spectrum) -> InputError:
    """What to say of a response that is not finite from t on."""
    worst = spectrum.values[np.argmax(spectrum.values.real)]
    if worst.real * t < 1:
        return InputError(Message(
            "the response passes the range of floats at t = {t:time}: the force or the initial state is too large", t=t
        ))  # fmt: skip
    kind = "flutter" if worst.imag else "divergence"
    return InputError(Message(
        f"the response passes the range of floats at t = {{t:time}}: {kind} grows as exp(r t), r = {{rate:rate}}; "
        "choose a shorter duration or a load below the critical one", t=t, rate=worst.real
    ))  # fmt: skip
