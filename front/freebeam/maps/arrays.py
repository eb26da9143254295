"""Critical loads and eigenvalues of many points at once: arrays in, arrays out. What maps are computed with.

`solve` takes any number of dampings of one question. They share a pencil, and with it the surface of first crossings
over all damping (`surface.py`), which settles most points by a series; the rest are searched one by one, as all of a
column beyond the textbook's. `solve_points` does so for any points.

An answer hangs on the arrays of its own call alone, never on earlier calls, and nothing is drawn at random: work cut
into the same blocks gives the same bits, in whatever order or process the blocks run.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from freebeam.maps.surface import FEW, first_crossing, surface_of
from freebeam_sym.checks import InputError, computable, reals
from freebeam_sym.columns import Column, is_column
from freebeam_sym.question import Question
from freebeam_sym.spectra import coordinates, elastic_motion, sorting
from freebeam_sym.stability.convergence import KINDS, Answers
from freebeam_sym.stability.crossings import first_loss
from freebeam_sym.stability.pencil import Pencil
from freebeam_sym.stability.problem import Complex, Crossing, Real

__all__ = [
    "CriticalLoads", "alike", "broadcast", "checked_axes", "critical_loads", "eigenvalues", "put", "shaped", "solve",
    "solve_points", "with_values",
]  # fmt: skip


def shaped(answers: Answers, *shape: int) -> Answers:
    """The same as arrays of another shape."""
    return Answers(answers.load.reshape(shape), answers.frequency.reshape(shape), answers.kind.reshape(shape))


def put(answers: Answers, at: Any, found: Crossing | None) -> None:
    """Write down the answer of a point."""
    plain = (np.nan, np.nan, 0) if found is None else (found.load, found.frequency, KINDS.index(found.kind))
    answers.load[at], answers.frequency[at], answers.kind[at] = plain


def checked_axes(column: Column, values: Mapping[str, Any]) -> dict[str, Real]:
    """Arrays of alpha, beta and the column's own parameters by name, as floats. Raises InputError for a name that the
    column has not and for values that are not finite, or negative damping."""
    is_column(column)
    own = {p.name: p.default for p in column.parameters}
    found: dict[str, Real] = {}
    for name, given in values.items():
        if name not in ("alpha", "beta", *own):
            raise column.no_such(name)
        array = reals(name, given)
        if array.size:
            computable(name, float(array.max()))
            computable(name, float(array.min()))
        if name in ("alpha", "beta"):
            if (array < 0).any():
                raise InputError(f"{name} = {array.min()}: must be zero or greater (damping)")
            if array.any() and name not in column.damping:
                raise InputError(f"{name} = {array.max()}: {column.name} states no such damping; leave it at 0")
        found[name] = array
    return found


@dataclass(frozen=True)
class CriticalLoads:
    """Critical loads over arrays, each of the shape that the parameters broadcast to; nondimensional.

    `load` and `frequency`: nan where there is none up to the largest load; frequency 0 in divergence. `kind`: "none",
    "flutter" or "divergence". `question`: what was asked, but for the arrays.
    """

    load: NDArray[np.float64]
    frequency: NDArray[np.float64]
    kind: NDArray[np.str_]
    question: Question


def critical_loads(
    column: Column,
    modes: int | None = None,
    alpha: ArrayLike = 0.0,
    beta: ArrayLike = 0.0,
    *,
    load_max: float = 1000.0,
    **parameters: ArrayLike,
) -> CriticalLoads:
    """`critical_load` over arrays of alpha, beta and the column's own parameters, which broadcast like NumPy's.

    >>> import freebeam as fb
    >>> loads = fb.critical_loads(fb.column("beck"), alpha=[[1e-3], [1e-2]], beta=[0.1, 0.5, 1.0])
    >>> loads.load.shape
    (2, 3)

    alpha = beta = 0 is no damping, whose flutter is the coalescence of two frequencies. Points that share their own
    parameters share most of the work. Raises InputError for bad values and shapes that do not broadcast.
    """
    question = Question.of(column, modes, load_max=load_max)
    values = checked_axes(column, {"alpha": alpha, "beta": beta, **parameters})
    points, shape = broadcast(values)
    found = shaped(solve_points(question, points), *shape)
    return CriticalLoads(found.load, found.frequency, np.array(KINDS)[found.kind], question)


def broadcast(values: Mapping[str, Real]) -> tuple[dict[str, Real], tuple[int, ...]]:
    """Arrays that broadcast, each (n,), by name, and their shape. Raises InputError where they do not."""
    try:
        arrays = np.broadcast_arrays(*values.values())
    except ValueError:
        shapes = ", ".join(f"{name} {array.shape}" for name, array in values.items())
        raise InputError(f"shapes do not broadcast: {shapes}") from None
    return dict(zip(values, (array.ravel() for array in arrays), strict=True)), arrays[0].shape


def solve(question: Question, alpha: Real, beta: Real) -> Answers:
    """First loss of stability at each of n dampings, (n,), whatever those of the question. Section 3.2, Eqs. (24)-(25).

    alpha, beta: (n,) internal and external damping, nondimensional, as `checked_axes` leaves them; both 0 is no damping
    at all, whose flutter is the coalescence of two frequencies. Raises InputError where the column is not stable
    without load.
    """
    if question.column.general:
        answers = Answers.none(len(alpha))
        for k, (a, b) in enumerate(zip(alpha.tolist(), beta.tolist(), strict=True)):  # each of them searched
            problem = replace(question, alpha=a, beta=b).problem
            put(answers, k, first_loss(problem, question.load_max).crossing)
        return answers
    factors = question.column.kernel.damping_factors(alpha, beta, **question.parameters)
    c_M, c_E = (np.broadcast_to(c, alpha.shape) for c in factors)
    return _of_pencil(question.pencil, c_E, c_M, question.load_max)


def solve_points(
    question: Question, points: Mapping[str, Real], step: Callable[[float], None] | None = None
) -> Answers:
    """First loss of stability at points, arrays (n,) by name, of alpha, beta and own parameters; those that
    share their own are solved together. step: told which part is done, 0 to 1. The rest as in `solve`."""
    n = len(next(iter(points.values())))
    alpha, beta = (points.get(x, np.full(n, question.values[x])) for x in ("alpha", "beta"))
    answers, done = Answers.none(n), 0
    for own, which in alike({x: points[x] for x in points if x not in ("alpha", "beta")}, n):
        found = solve(with_values(question, own), alpha[which], beta[which])
        answers.load[which], answers.frequency[which], answers.kind[which] = found
        done += len(which)
        if step is not None:
            step(done / n)
    return answers


def with_values(question: Question, values: Mapping[str, float]) -> Question:
    """The question with other values of alpha, beta and own parameters, which `checked_axes` has seen."""
    alpha, beta = (values.get(name, question.values[name]) for name in ("alpha", "beta"))
    own = {name: values.get(name, value) for name, value in question.parameters.items()}
    return replace(question, alpha=alpha, beta=beta, parameters=own)


def alike(own: Mapping[str, Real], n: int) -> Iterator[tuple[dict[str, float], NDArray[np.intp]]]:
    """The different sets of own parameters and the points that have them."""
    if not own:
        yield {}, np.arange(n)
        return
    table = np.stack(list(own.values()), axis=1)
    unique, member = np.unique(table, axis=0, return_inverse=True)
    order = np.argsort(member.ravel(), kind="stable")
    ends = np.cumsum(np.bincount(member.ravel(), minlength=len(unique)))[:-1]
    for values, which in zip(unique, np.split(order, ends), strict=True):
        yield dict(zip(own, values.tolist(), strict=True)), which


def _of_pencil(pencil: Pencil, alpha: Real, beta: Real, load_max: float) -> Answers:
    """First crossings of one pencil at damping C = alpha E + beta M, each (n,)."""
    n = len(alpha)
    answers = Answers.none(n)
    load, frequency, kind = answers
    if pencil.conservative:  # damping or not, divergence
        ask, same = np.arange(min(n, 1)), np.arange(n)
    else:
        damped = (alpha > 0) | (beta > 0)
        same, which = np.flatnonzero(~damped), np.flatnonzero(damped)
        ask = same[:1]
        covered = (alpha[which] >= 0) & (beta[which] >= 0)  # a column's energies may shift them below zero
        if covered.sum() >= FEW:
            ask, which = np.append(ask, which[~covered]), which[covered]
            surface = surface_of(pencil, load_max)
            P, omega, settled = surface.at(alpha[which], beta[which])
            load[which], frequency[which] = P, omega
            with np.errstate(invalid="ignore"):
                flutter = P < min(surface.divergence, load_max)
            kind[which] = flutter
            other = which[~flutter]
            divergent = surface.divergence <= load_max
            load[other] = surface.divergence if divergent else np.nan
            frequency[other] = 0.0 if divergent else np.nan
            kind[other] = 2 if divergent else 0
            which = which[~settled]
        ask = np.append(ask, which)
    for k in ask:
        put(answers, k, first_crossing(pencil, float(alpha[k]), float(beta[k]), load_max))
    if len(same):
        load[same], frequency[same], kind[same] = load[same[0]], frequency[same[0]], kind[same[0]]
    return answers


def eigenvalues(
    column: Column,
    load: ArrayLike = 0.0,
    alpha: ArrayLike = 0.0,
    beta: ArrayLike = 0.0,
    modes: int | None = None,
    **parameters: ArrayLike,
) -> Complex:
    """Eigenvalues λ of the elastic motion over arrays of load, alpha, beta and own parameters, which broadcast like
    NumPy's: complex, of their shape and (2N,) more, each row sorted as `spectrum` sorts. Eqs. (24)-(25).

    >>> import freebeam as fb
    >>> fb.eigenvalues(fb.column("beck", "modes"), modes=8, load=[[5.0], [10.0]], beta=[0.1, 0.2, 0.3]).shape
    (2, 3, 16)

    Raises InputError for bad values and for shapes that do not broadcast.
    """
    is_column(column)
    modes = column.number(modes)
    P = reals("load", load)
    computable("load", float(np.abs(P).max(initial=0.0)))
    values = {"load": P, **checked_axes(column, {"alpha": alpha, "beta": beta, **parameters})}
    points, shape = broadcast(values)
    n = len(points["load"])
    if column.general:
        each_given: list[dict[str, Any]] = [{name: float(x[k]) for name, x in points.items()} for k in range(n)]
        systems = (column.system(modes, **each) for each in each_given)
        rows = [elastic_motion(system, vectors=False)[2] for system in systems]
        if len({len(row) for row in rows}) > 1:
            raise InputError(f"{column.name}: at some of these points a coordinate has no mass, and fewer eigenvalues")
        return np.array([row[sorting(row)] for row in rows]).reshape(*shape, -1)
    size = 2 * modes
    found = np.empty((n, size), dtype=complex)
    block = max(1, 2**20 // size**2)  # states at a time
    for own, which in alike({x: points[x] for x in parameters}, n):
        given = column.own_parameters(dict(own))
        M, E, H = column.matrices(modes, False, **given)
        E, B = coordinates(M, E)
        H = B.T @ H @ B
        for part in (which[k : k + block] for k in range(0, len(which), block)):
            c_M, c_E = column.kernel.damping_factors(points["alpha"][part], points["beta"][part], **given)
            c_M, c_E = (np.broadcast_to(c, part.shape)[:, None, None] for c in (c_M, c_E))
            K = E + points["load"][part, None, None] * H
            found[part] = _values(K, c_M * np.eye(modes) + c_E * E)
    for row in found:
        row[:] = row[sorting(row)]
    return found.reshape(*shape, size)


def _values(K: Real, C: Real) -> Complex:
    """λ (m, 2n) of q̈ + C q̇ + K q = 0, each (m, n, n). Undamped ones from s = −λ², as in `eigen`."""
    m, n = len(K), K.shape[1]
    values = np.empty((m, 2 * n), dtype=complex)
    free = ~C.any(axis=(1, 2))
    if free.any():
        root = np.sqrt(-np.linalg.eigvals(K[free]).astype(complex))
        values[free] = np.concatenate([root, -root], axis=1) + 0j
    A = np.zeros((int((~free).sum()), 2 * n, 2 * n))
    A[:, :n, n:] = np.eye(n)
    A[:, n:, :n], A[:, n:, n:] = -K[~free], -C[~free]
    if len(A):
        values[~free] = np.linalg.eigvals(A)
    return values


def record(question: Question) -> dict[str, Any]:
    """Settings of a question by name, as files keep them."""
    own = question.column
    return {"column": own.name, "basis": own.basis_name, "modes": question.modes, "load_max": question.load_max}
