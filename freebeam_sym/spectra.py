"""Eigenvalues of a system, Eqs. (24)-(26).

"Stable" means the elastic spectrum. With rigid functions the matrices are block triangular, so the elastic
eigenvalues stay what they are, and λ = 0 joins them, defective: the free beam drifts at any load.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from freebeam_sym.checks import InputError
from freebeam_sym.columns import is_system
from freebeam_sym.massless import reduced, without_mass
from freebeam_sym.stability.pencil import diagonalise

if TYPE_CHECKING:
    from freebeam_sym.columns import Column, System

__all__ = ["Spectrum", "spectrum", "state_matrix"]

Real = NDArray[np.float64]
Complex = NDArray[np.complex128]

ROUNDING = 1e-9
"""Real parts of λ up to this, relative to |λ|, are rounding where there is no damping: a stable λ = iω is then
exact only to the square root of a float's precision near a coalescence, and to a float's precision elsewhere."""
EPSILON = 1e-15
"""Rounding of a state matrix, relative to its norm: a few units of a float's last digit."""
AGREED = 1e-4
"""Relative difference up to which eigenvalues of two series are the same one."""
MOST_COMPARED = 60
"""Polynomials that eigenvalues are compared with, at most: beyond, rounding grows faster than the error falls."""


def state_matrix(M: Any, C: Any, K: Any) -> Real:
    """A = [[0, I], [−M⁻¹K, −M⁻¹C]], shape (2n, 2n), of the state (q, q̇). Eq. (25). Raises InputError where M is
    singular."""
    n = len(M)
    try:
        block = np.linalg.solve(M, np.hstack([K, C]))
    except np.linalg.LinAlgError:
        raise InputError("M is singular: the trial functions must be independent") from None
    return np.vstack([np.eye(n, 2 * n, n), -block])


@dataclass(frozen=True)
class Spectrum:
    """Eigenvalues and eigenvectors of a system, nondimensional. Eqs. (24)-(26).

    `eigenvalues` (2n,) complex, sorted by |Im λ|, then Re λ, then Im λ, fewer where some coordinate has no mass;
    `vectors` (n, 2n) complex, the columns q̂ of Eq. (24) in generalised coordinates, largest entry 1;
    `reference_frequency` is λ₀ of Eq. (26), None where mode 1 of the unloaded beam is overdamped and Eq. (26) says
    nothing, and where some coordinate has no mass. "Stable" means the elastic spectrum. `system`: whose spectrum it is.
    """

    eigenvalues: Complex
    vectors: Complex = field(repr=False)
    elastic: Complex = field(repr=False)
    """Eigenvalues of the elastic functions alone, sorted alike."""
    reference_frequency: float | None
    system: System = field(repr=False, compare=False)
    places: NDArray[np.intp] = field(repr=False, compare=False)
    """Where each of `elastic` stands in `eigenvalues`."""

    @cached_property
    def rounding(self) -> Real:
        """By how much each of `eigenvalues` may be off, relative, for the rounding of a float, (2n,): near a
        coalescence half of the digits are lost. 0 where λ = 0."""
        E, _, found, V = elastic_motion(self.system)
        size = np.abs(found).max()
        # states in the norm of the energy, in which all modes weigh alike
        W = np.vstack([np.sqrt(np.abs(np.diag(E)))[:, None] * V, V * found])
        if len(idle := np.flatnonzero(np.diag(self.system.M)[self.system.rigid_count :] == 0)):
            # without mass (an integral controller's without energy): as much as the rest where it is most of a motion
            W[[*idle, *(idle + len(V))]] = 0
            share = np.abs(V[idle]) / np.maximum(np.linalg.norm(W, axis=0), 1e-300)
            W[idle] = V[idle] / np.maximum(share.max(axis=1, keepdims=True), 1e-300)
        W = W / np.linalg.norm(W, axis=0)
        condition = np.linalg.norm(inverse(W), axis=1)
        # to first order; where two meet, the root of rounding
        off = size * np.minimum(EPSILON * condition, math.sqrt(EPSILON))
        relative = np.divide(off, np.abs(found), out=np.zeros(len(found)), where=found != 0)
        return self._of_all(relative[sorting(found)])

    @cached_property
    def error(self) -> Real:
        """Estimated error of each of `eigenvalues` against the beam's own, relative, (2n,): by polynomials at two N
        that agree; nan where these do not, or the column has none. Rigid motion has none: 0."""
        s = self.system

        def ask(column: Column, modes: int) -> Complex:
            system = column.system(modes, s.load, s.alpha, s.beta, False, **s.parameters)
            return elastic_motion(system, vectors=False)[2][None, :]

        off = beam_errors(s.column, self.elastic[None, :], s.modes, ask)[0]
        return self._of_all(off + self.rounding[self.places])

    def _of_all(self, numbers: Real) -> Real:
        """Numbers of `elastic` at their places in `eigenvalues`, 0 at those of rigid motion."""
        out = np.zeros(len(self.eigenvalues))
        out[self.places] = numbers
        return out

    @property
    def normalised(self) -> Complex | None:
        """λ / λ₀, Eq. (26); None where λ₀ does not exist."""
        return None if self.reference_frequency is None else self.eigenvalues / self.reference_frequency

    @property
    def damping_ratio(self) -> Real:
        """ζ = −Re λ / |λ| of each of `eigenvalues`, (2n,): negative of what grows, 0 within rounding, nan of λ = 0."""
        size = np.abs(self.eigenvalues)
        ratio = np.divide(-self.eigenvalues.real, size, out=np.full(len(size), np.nan), where=size > 0)
        return np.asarray(np.where(np.abs(ratio) <= self.rounding, 0.0, ratio))

    @property
    def growth_rate(self) -> float:
        """Largest Re λ of the elastic eigenvalues: negative where the beam is asymptotically stable."""
        return float(self.elastic.real.max())

    @property
    def unstable(self) -> int:
        """How many elastic eigenvalues grow: Re λ > 0 beyond rounding."""
        size = np.maximum(np.abs(self.elastic), 1e-4 * np.abs(self.elastic).max())
        return int((self.elastic.real > ROUNDING * size).sum())


def spectrum(system: System) -> Spectrum:
    """Eigenvalues and eigenvectors of the state matrix. Eqs. (23)-(26). Raises InputError where M is singular and the
    motion of what has no mass is not determined.

    Elastic and rigid blocks are solved apart: λ = 0 of the rigid motion is defective, and rounding would scatter
    it by the square root of a float's precision, into the elastic eigenvalues too.
    """
    is_system(system)
    E, B, elastic, vectors = elastic_motion(system)
    eigenvalues, full = elastic, B @ vectors
    if system.rigid_count:
        eigenvalues, full = with_rigid(system, elastic, full)
    order, order_e = sorting(eigenvalues), sorting(elastic)
    e = slice(system.rigid_count, None)
    reference = None
    if not without_mass(system.M[e, e]):  # Eq. (26): Im λ of mode 1 in Eq. (23), γ₁⁴ the least eigenvalue of E
        s, V = np.linalg.eigh(E)
        square = float(s[0]) - (float(V[:, 0] @ B.T @ system.C[e, e] @ B @ V[:, 0]) / 2) ** 2
        reference = math.sqrt(square) if square > 0 else None
    places = np.argsort(order)[order_e]
    full = full[:, order]
    full = full / full[np.abs(full).argmax(axis=0), np.arange(len(order))]
    return Spectrum(eigenvalues[order], full, elastic[order_e], reference, system, places)


def beam_errors(column: Column, found: Complex, modes: int, ask: Callable[[Column, int], Complex]) -> Real:
    """Errors of elastic eigenvalues (m, k) at m loads against the beam's own, relative, (m, k): from the nearest that
    series of polynomials at two N agree on, their difference added; nan where the nearest is not agreed on. ask: for a
    column and N, its eigenvalues (m, 2N) at these loads."""
    polynomials = column.polynomials
    if polynomials is None:
        return np.full(found.shape, np.nan)
    fewer = min(2 * modes + 8, MOST_COMPARED)
    first, second = (ask(polynomials, n) for n in (fewer, fewer + 8))
    errors = np.empty(found.shape)
    for row, (given, one, two) in enumerate(zip(found, first, second, strict=True)):
        apart = np.abs(two[:, None] - one).min(axis=1)
        nearest = np.abs(given[:, None] - two).argmin(axis=1)
        size = np.maximum(np.abs(two[nearest]), 1e-300)
        off = (np.abs(given - two[nearest]) + apart[nearest]) / size
        errors[row] = np.where(apart[nearest] <= AGREED * size, off, np.nan)
    return errors


def elastic_motion(system: System, vectors: bool = True) -> tuple[Real, Real, Complex, Complex]:
    """E and B of `coordinates` for the elastic functions, and λ and q̂ in these coordinates, any order. Without
    `vectors`, which is quicker, q̂ has no columns."""
    e = slice(system.rigid_count, None)
    E, B = coordinates(system.M[e, e], system.E[e, e])
    M, C, load = (B.T @ X[e, e] @ B for X in (system.M, system.C, system.K - system.E))
    return E, B, *(massless(M, C, E + load, vectors) if without_mass(M) else eigen(C, E + load, vectors))


def coordinates(M: Real, E: Real) -> tuple[Real, Real]:
    """Coordinates in which M = I: E there and the change of coordinates B, (n, n) each. E is diagonal where it is
    positive definite: the low modes are then not rounded beside the highest. Coordinates without mass stay as they are.
    """
    if without_mass(M):
        moving, B = np.flatnonzero(np.diag(M)), np.eye(len(M))
        own = np.ix_(moving, moving)
        if len(moving) < len(M):
            B[own] = coordinates(M[own], E[own])[1]
        return B.T @ E @ B, B
    try:
        e, B = diagonalise(M, E)
        return np.diag(e[::-1]), np.ascontiguousarray(B[:, ::-1])
    except InputError:
        B = np.linalg.inv(np.linalg.cholesky(M)).T
        return B.T @ E @ B, B


def eigen(C: NDArray[Any], K: NDArray[Any], vectors: bool = True) -> tuple[Complex, Complex]:
    """λ (2n,) and q̂ (n, 2n) of q̈ + C q̇ + K q = 0, any order. Without damping from s = −λ², n × n: Re λ of a stable beam
    is then exactly 0, and q̂ are those of s, twice."""
    n = len(K)
    if C.any():
        values, W = _decomposed(state_matrix(np.eye(n), C, K), vectors)
        return values, W[:n]
    s, V = _decomposed(K, vectors)
    root = np.sqrt(-s)
    return np.append(root, -root) + 0j, np.hstack([V, V])  # the sum leaves no negative zeros


def massless(M: Real, C: Real, K: Real, vectors: bool = True) -> tuple[Complex, Complex]:
    """λ (m,) and q̂ (n, m) where M is singular."""
    found = reduced(M, C, K)
    values, W = _decomposed(found.matrix, vectors)
    return values, found.states[: len(M)] @ W


def _decomposed(A: NDArray[Any], vectors: bool) -> tuple[Complex, Complex]:
    values, V = np.linalg.eig(A) if vectors else (np.linalg.eigvals(A), np.empty((len(A), 0)))
    return values.astype(complex), V.astype(complex)


def inverse(V: Any) -> Any:
    """Of vectors, or of other matrices; a pseudoinverse where these are parallel."""
    try:
        return np.linalg.inv(V)
    except np.linalg.LinAlgError:  # at a coalescence to the last digit
        return np.linalg.pinv(V)


def with_rigid(system: System, elastic: Complex, vectors: Complex) -> tuple[Complex, Complex]:
    """λ (2n,) and q̂ (n, 2n) of the whole system from those of the elastic functions: these with the rigid motion that
    they drive, then the rigid block's in their order."""
    M, C, K, r = system.M, system.C, system.K, system.rigid_count
    n = len(K)
    coupling = max(float(np.abs(X[r:, :r]).max()) for X in (M, C, K))
    if coupling > 1e-9 * max(float(np.abs(K[r:, r:]).max()), 1.0):  # not block triangular: no theorem to use
        return massless(M, C, K) if without_mass(M) else eigen(np.linalg.solve(M, C), np.linalg.solve(M, K))
    rigid, shapes = eigen(np.linalg.solve(M[:r, :r], C[:r, :r]), np.linalg.solve(M[:r, :r], K[:r, :r]))
    order = sorting(rigid)
    full = np.zeros((n, len(elastic) + len(rigid)), dtype=complex)
    full[r:, : len(elastic)] = vectors
    lam = elastic[:, None, None]
    blocks = lam**2 * M[:r] + lam * C[:r] + K[:r]
    right = -blocks[:, :, r:] @ vectors.T[:, :, None]
    full[:r, : len(elastic)] = (inverse(blocks[:, :, :r]) @ right)[:, :, 0].T  # singular with an elastic λ at 0 too
    full[:r, len(elastic) :] = shapes[:, order]
    return np.concatenate([elastic, rigid[order]]), full


def sorting(values: Complex) -> NDArray[np.intp]:
    """By |Im|, Re, Im; |Im| compared to rounding, so that a conjugate pair stays together."""
    size = np.abs(values).max(initial=0.0)
    digits = np.round(np.abs(values.imag) / (size * 1e-13)) if size > 0 else values.imag
    return np.lexsort((values.imag, values.real, digits))
