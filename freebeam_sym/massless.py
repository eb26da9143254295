"""Coordinates without mass, such as the state of a controller: M is singular, and there are fewer than 2n states.

A combination u of rows with uᵀM = 0 is a relation of the states, uᵀC q̇ + uᵀK q = 0. Differentiated it holds
accelerations; when so many rows have been differentiated that none of these is left, all accelerations are known, and
the relations say which states there are.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from freebeam_sym.checks import InputError

__all__ = ["Reduced", "accelerated", "indefinite", "reduced", "without_mass"]

Array = NDArray[np.float64]

SINGULAR = 1e-14
"""Pivots of M with 1 on its diagonal, and other sizes relative to the largest, that are zero but for rounding. The
least eigenvalue, below all pivots, is 2e-13 of 256 polynomials on a segment."""
NEGATIVE = 1e-12
"""Eigenvalue of M with 1 on its diagonal, below zero by no more than rounding: 1e-15 of an entry, of 256 functions."""


class Reduced(NamedTuple):
    """q̈ + C q̇ + K q = Q F of a system with a singular M. rows (n, n): what of its rows makes these, Q = rows @ its Q;
    idle (z, n): what of its rows makes the relations, where no force may act, idle @ Q = 0.
    free (m,): which of (q, dq) are the states; states (2n, m): (q, dq) of them."""

    C: Array
    K: Array
    rows: Array
    idle: Array
    free: NDArray[np.intp]
    states: Array

    @property
    def matrix(self) -> Array:
        """A of x′ = A x, (m, m), of the states."""
        n = len(self.K)
        whole = np.concatenate([np.eye(n, 2 * n, n), -np.concatenate([self.K, self.C], axis=1)])
        return np.asarray((whole @ self.states)[self.free])


def without_mass(M: Array) -> bool:
    """Whether M, symmetric, is singular: some motion has no mass. Raises InputError where some motion has a negative
    one."""
    diagonal = np.diag(M)
    size = np.sqrt(np.where(diagonal > 0, diagonal, 1.0))
    scaled = M / np.outer(size, size)
    try:
        return bool(np.linalg.cholesky(scaled).diagonal().min() ** 2 < SINGULAR)
    except np.linalg.LinAlgError:
        if not np.linalg.eigvalsh(scaled)[0] > -NEGATIVE:
            raise indefinite() from None
        return True


def indefinite() -> InputError:
    """The error that some motion has a negative mass, or none."""
    return InputError("M is not positive definite: no mass may be negative, and trial functions must be independent")


def reduced(M: Array, C: Array, K: Array, rate: float = 0.0) -> Reduced:
    """A system with a singular M in the states that it has. What breaks a relation at first dies away as exp(−rate t).

    Raises InputError where its motion is not determined, and where M is regular.
    """
    left, follow, parts = condensed(M[None], C[None], K[None])
    found, n = _related(parts[0][0], parts[1][0], parts[2][0], rate), len(M)
    if len(left) == n and not len(found.idle):
        raise indefinite()
    F, own = follow[0], np.eye(n)[left]
    off = np.eye(n) - F @ own
    C, K = F @ found.C @ own + 2 * rate * off, F @ found.K @ own + rate**2 * off
    idle = np.concatenate([found.idle @ own, np.delete(np.eye(n), left, axis=0)])
    states = np.concatenate([F @ part for part in np.split(found.states, 2)])
    return Reduced(C, K, F @ found.rows @ own, idle, np.concatenate([left, n + left])[found.free], states)


def _related(M: Array, C: Array, K: Array, rate: float) -> Reduced:
    """The same one relation after the other, with none too."""
    n = len(M)
    whole, rows = np.concatenate([M, C, K], axis=1), np.eye(n)
    relations: list[Array] = []
    idle: list[Array] = []
    while (u := _none(whole[:, :n])) is not None:
        _, c, k = (u @ whole).reshape(3, n)
        terms = np.abs(u[:, None] * whole[:, n:]).max(initial=0.0)
        if len(relations) == 2 * n or not max(np.abs(c).max(), np.abs(k).max()) > SINGULAR * terms:
            raise InputError("M is singular, and nothing moves or holds some coordinate: its motion is not determined")
        relations.append(np.concatenate([k, c]))
        idle.append(u @ rows)
        place = int(np.argmax(np.abs(u)))
        whole[place] = np.concatenate([c, k + rate * c, rate * k])  # (d/dt + rate) of the relation
        rows[place] = 0.0
    found = np.linalg.solve(whole[:, :n], np.concatenate([whole[:, n:], rows], axis=1))
    C, K, rows = (found[:, k * n : (k + 1) * n] for k in range(3))
    related = np.array(relations).reshape(-1, 2 * n)
    return Reduced(C, K, rows, np.array(idle).reshape(-1, n), *_solved(related, np.diag(M) == 0))


def condensed(M: Array, C: Array, K: Array) -> tuple[NDArray[np.intp], Array, tuple[Array, Array, Array]]:
    """Matrices by powers of the load, (k, n, n) each, without the coordinates that have neither mass nor damper, as a
    field without inertia has: those that are left; q of all by theirs, (k, n, left); M, C and K of these. All are left
    where the load acts on what holds the others, or nothing does."""
    moved = [np.abs(X).sum(axis=0) for X in (M, C)]
    moving = np.logical_or.reduce([X.any(axis=axis) for X in moved for axis in (0, 1)])
    n, left, idle = len(moving), np.flatnonzero(moving), np.flatnonzero(~moving)
    own = K[:, idle[:, None], idle]
    if not len(idle) or not len(left) or own[1:].any() or np.linalg.cond(own[0]) > 1e13:
        return np.arange(n), np.eye(n)[None], (M, C, K)
    follow = np.zeros((len(K), n, len(left)))
    follow[0, left] = np.eye(len(left))
    follow[:, idle] = -np.linalg.solve(own[0], K[:, idle[:, None], left])
    whole = np.zeros((2 * len(K) - 1, len(left), len(left)))
    for i, j in np.ndindex(len(K), len(K)):
        whole[i + j] += K[i, left] @ follow[j]
    used = 1 + max((k for k, X in enumerate(whole) if X.any()), default=0)
    return left, follow, (M[:, left[:, None], left], C[:, left[:, None], left], whole[:used])


def accelerated(M: Array, C: Array, K: Array) -> Reduced:
    """The same for a method that wants an acceleration of each coordinate: what breaks a relation dies away faster than
    all that the system does by itself."""
    fastest = np.abs(np.linalg.eigvals(reduced(M, C, K).matrix)).max(initial=1.0)
    return reduced(M, C, K, 1.5 * float(fastest))


def _none(M: Array) -> Array | None:
    """u with uᵀM = 0; None where M is regular. Its rows and columns are brought to one size before."""
    rows = np.abs(M).max(axis=1)
    rows[rows == 0] = 1.0
    columns = np.abs(M / rows[:, None]).max(axis=0)
    columns[columns == 0] = 1.0
    left, sizes, _ = np.linalg.svd(M / rows[:, None] / columns)
    return left[:, -1] / rows if sizes[-1] < SINGULAR * sizes[0] else None


def _solved(relations: Array, massless: NDArray[np.bool_]) -> tuple[NDArray[np.intp], Array]:
    """`free` and `states` of relations N (q, dq) = 0, (z, 2n): solved for what has no mass first, rates before q."""
    from scipy.linalg import qr

    m = relations.shape[1]
    n = m // 2
    left = relations / np.abs(relations).max(axis=1, keepdims=True, initial=0.0)
    held: list[int] = []
    for part in (n + np.flatnonzero(massless), np.flatnonzero(massless), n + np.flatnonzero(~massless), np.arange(n)):
        if not part.size or not len(left):
            continue
        Q, R, order = qr(left[:, part], pivoting=True)
        rank = int((np.abs(np.diag(R)) > SINGULAR).sum())
        held += part[order[:rank]].tolist()
        left = Q[:, rank:].T @ left  # what does not hold these
    free = np.setdiff1d(np.arange(m), held)
    states = np.zeros((m, len(free)))
    states[free, np.arange(len(free))] = 1.0
    states[held] = -np.linalg.solve(relations[:, held], relations[:, free])
    return free, states
