"""Eigenvalues of a system, Eqs. (24)-(26), and their branches followed along the load.

"Stable" means the elastic spectrum. With rigid functions the matrices are block triangular, so the elastic
eigenvalues stay what they are, and λ = 0 joins them, defective: the free beam drifts at any load.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from freebeam_sym.checks import InputError, computable, reals, refusal
from freebeam_sym.columns import is_column, is_system
from freebeam_sym.stability.pencil import diagonalise

if TYPE_CHECKING:
    from freebeam_sym.columns import Column, System

__all__ = ["Branches", "Spectrum", "branches", "eigenvalues", "spectrum", "state_matrix"]

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
"""Polynomials that eigenvalues are compared with, at most."""
MOST_STEPS = 5_000
"""Loads between two given ones at which `branches` looks, at most; a coalescence takes some forty."""
MOST_CUTS = 40
"""How often `branches` halves an interval between two given loads before it takes the match as it stands."""


def state_matrix(M: Any, C: Any, K: Any) -> Real:
    """A = [[0, I], [−M⁻¹K, −M⁻¹C]], shape (2n, 2n), of the state (q, q̇). Eq. (25). Raises InputError where M is
    singular."""
    n = len(M)
    try:
        block = np.linalg.solve(M, np.hstack([K, C]))
    except np.linalg.LinAlgError:
        raise InputError("M is singular: the trial functions must be independent") from None
    A = np.zeros((2 * n, 2 * n))
    A[:n, n:] = np.eye(n)
    A[n:] = -block
    return A


@dataclass(frozen=True)
class Spectrum:
    """Eigenvalues and eigenvectors of a system, nondimensional. Eqs. (24)-(26).

    `eigenvalues` (2n,) complex, sorted by |Im λ|, then Re λ, then Im λ; `vectors` (n, 2n) complex, the columns q̂
    of Eq. (24) in generalised coordinates, largest entry 1; `reference_frequency` is λ₀ of Eq. (26), None where
    mode 1 of the unloaded beam is overdamped and Eq. (26) says nothing. "Stable" means the elastic spectrum.
    `system`: whose spectrum it is.
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
        E, _, found, V = _elastic(self.system)
        size = np.abs(found).max()
        # states in the norm of the energy, in which all modes weigh alike
        W = np.vstack([np.sqrt(np.abs(np.diag(E)))[:, None] * V, V * found])
        W = W / np.linalg.norm(W, axis=0)
        condition = np.linalg.norm(_left(W), axis=1)
        # to first order; where two meet, the root of rounding
        off = size * np.minimum(EPSILON * condition, math.sqrt(EPSILON))
        relative = np.divide(off, np.abs(found), out=np.zeros(len(found)), where=found != 0)
        return self._of_all(relative[_order(found)])

    @cached_property
    def error(self) -> Real:
        """Estimated error of each of `eigenvalues` against the beam's own, relative, (2n,): by polynomials at two N
        that agree; nan where these do not, or the column has none. Rigid motion has none: 0."""
        s = self.system
        found = self.elastic
        off = beam_errors(s.column, found[None, :], np.array([s.load]), s.modes, s.alpha, s.beta, s.parameters)[0]
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
    def growth_rate(self) -> float:
        """Largest Re λ of the elastic eigenvalues: negative where the beam is asymptotically stable."""
        return float(self.elastic.real.max())

    @property
    def unstable(self) -> int:
        """How many elastic eigenvalues grow: Re λ > 0 beyond rounding."""
        size = np.maximum(np.abs(self.elastic), 1e-4 * np.abs(self.elastic).max())
        return int((self.elastic.real > ROUNDING * size).sum())


def spectrum(system: System) -> Spectrum:
    """Eigenvalues and eigenvectors of the state matrix. Eqs. (24)-(26). Raises InputError where M is singular.

    The reference frequency of Eq. (26) is the imaginary part in Eq. (23) of the first mode.

    Elastic and rigid blocks are solved apart: λ = 0 of the rigid motion is defective, and rounding would scatter
    it by the square root of a float's precision, into the elastic eigenvalues too.
    """
    is_system(system)
    r, n = system.rigid_count, len(system.M)
    M, C, K = system.M, system.C, system.K
    e = slice(r, n)
    E, B, elastic, vectors = _elastic(system)
    vectors = B @ vectors
    eigenvalues, full = elastic, vectors
    if r:
        eigenvalues, full = _with_rigid(M, C, K, r, elastic, vectors)
    order, order_e = _order(eigenvalues), _order(elastic)
    full = full[:, order]
    peak = full[np.abs(full).argmax(axis=0), np.arange(2 * n)]
    reference = _reference(E, B.T @ C[e, e] @ B)
    places = np.argsort(order)[order_e]
    return Spectrum(eigenvalues[order], full / peak, elastic[order_e], reference, system, places)


def beam_errors(
    column: Column, found: Complex, loads: Real, modes: int, alpha: float, beta: float, own: Mapping[str, float]
) -> Real:
    """Errors of elastic eigenvalues (m, k) at loads (m,) against the beam's own, relative, (m, k): from the nearest
    that series of polynomials at two N agree on, their difference added; nan where the nearest is not agreed on."""
    polynomials = column.polynomials
    if polynomials is None:
        return np.full(found.shape, np.nan)
    fewer = min(2 * modes + 8, MOST_COMPARED)
    first, second = (eigenvalues(polynomials, loads, alpha, beta, n, **own) for n in (fewer, fewer + 8))
    errors = np.empty(found.shape)
    for row, (given, one, two) in enumerate(zip(found, first, second, strict=True)):
        apart = np.abs(two[:, None] - one).min(axis=1)
        nearest = np.abs(given[:, None] - two).argmin(axis=1)
        size = np.maximum(np.abs(two[nearest]), 1e-300)
        off = (np.abs(given - two[nearest]) + apart[nearest]) / size
        errors[row] = np.where(apart[nearest] <= AGREED * size, off, np.nan)
    return errors


def _elastic(system: System) -> tuple[Real, Real, Complex, Complex]:
    """E and B of `_coordinates` for the elastic functions, and λ and q̂ in these coordinates."""
    e = slice(system.rigid_count, None)
    E, B = _coordinates(system.M[e, e], system.E[e, e])
    C, load = (B.T @ X[e, e] @ B for X in (system.C, system.K - system.E))
    return E, B, *_eigen(np.eye(len(E)), C, E + load)


def _coordinates(M: Real, E: Real) -> tuple[Real, Real]:
    """Coordinates in which M = I: E there and the change of coordinates B, (n, n) each. E is diagonal where it is
    positive definite: the low modes are then not rounded beside the highest. Raises InputError where M is singular."""
    try:
        e, B = diagonalise(M, E)
        return np.diag(e[::-1]), np.ascontiguousarray(B[:, ::-1])
    except InputError:
        try:
            B = np.linalg.inv(np.linalg.cholesky(M)).T
        except np.linalg.LinAlgError:
            raise InputError("M is singular: the trial functions must be independent") from None
        return B.T @ E @ B, B


def _eigen(M: Real, C: Real, K: Real) -> tuple[Complex, Complex]:
    """λ (2n,) and q̂ (n, 2n), any order. Without damping from s = −λ², n × n: Re λ of a stable beam is then
    exactly 0."""
    if not C.any():
        found = np.linalg.eig(np.linalg.solve(M, K))
        s, V = found.eigenvalues.astype(complex), found.eigenvectors.astype(complex)
        root = np.sqrt(-s)
        values = np.append(root, -root) + 0j  # the sum leaves no negative zeros
        return values.astype(complex), np.hstack([V, V]).astype(complex)
    found = np.linalg.eig(state_matrix(M, C, K))
    return found.eigenvalues.astype(complex), found.eigenvectors[: len(M)].astype(complex)


def _with_rigid(M: Real, C: Real, K: Real, r: int, elastic: Complex, vectors: Complex) -> tuple[Complex, Complex]:
    """Eigenvalues and q̂ of the whole system, whose elastic rows do not see the rigid coordinates."""
    n, e = len(M), slice(r, len(M))
    coupling = max(float(np.abs(X[e, :r]).max()) for X in (M, C, K))
    if coupling > 1e-9 * max(float(np.abs(K[e, e]).max()), 1.0):
        return _eigen(M, C, K)  # not block triangular: no theorem to use
    rigid, shapes = _eigen(M[:r, :r], C[:r, :r], K[:r, :r])
    full = np.zeros((n, 2 * n), dtype=complex)
    full[:, : len(elastic)] = _lift(M, C, K, r, elastic, vectors)
    full[:r, len(elastic) :] = shapes
    return np.concatenate([elastic, rigid]), full


def _lift(M: Real, C: Real, K: Real, r: int, elastic: Complex, vectors: Complex) -> Complex:
    """Elastic eigenvectors with the rigid motion that they drive, (n, 2(n − r))."""
    full = np.zeros((len(M), len(elastic)), dtype=complex)
    full[r:] = vectors
    for k, lam in enumerate(elastic):
        block = lam**2 * M + lam * C + K
        full[:r, k] = _solve(block[:r, :r], -block[:r, r:] @ vectors[:, k])
    return full


def _solve(A: Complex, b: Complex) -> Complex:
    try:
        return np.asarray(np.linalg.solve(A, b))
    except np.linalg.LinAlgError:  # an elastic λ at 0 too
        return np.asarray(np.linalg.lstsq(A, b, rcond=None)[0])


def _order(values: Complex) -> NDArray[np.intp]:
    """By |Im|, Re, Im; |Im| compared to rounding, so that a conjugate pair stays together."""
    size = np.abs(values).max(initial=0.0)
    digits = np.round(np.abs(values.imag) / (size * 1e-13)) if size > 0 else values.imag
    return np.lexsort((values.imag, values.real, digits))


def _reference(E: Real, C: Real) -> float | None:
    """|Im λ| of mode 1 at P = 0: Eq. (23) with γ₁⁴ the least eigenvalue of E, in coordinates where M = I, and
    β + α γ₁⁴ the damping of its mode."""
    s, V = np.linalg.eigh(E)
    square = float(s[0]) - (float(V[:, 0] @ C @ V[:, 0]) / 2) ** 2
    return math.sqrt(square) if square > 0 else None


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
    from freebeam_sym.stability.grids import alike, checked_axes

    is_column(column)
    modes = column.number(modes)
    P = reals("load", load)
    computable("load", float(np.abs(P).max(initial=0.0)))
    values = {"load": P, **checked_axes(column, {"alpha": alpha, "beta": beta, **parameters})}
    try:
        arrays = np.broadcast_arrays(*values.values())
    except ValueError:
        shapes = ", ".join(f"{name} {array.shape}" for name, array in values.items())
        raise InputError(f"shapes do not broadcast: {shapes}") from None
    points = {name: array.ravel() for name, array in zip(values, arrays, strict=True)}
    n, size = arrays[0].size, 2 * modes
    found = np.empty((n, size), dtype=complex)
    block = max(1, 2**20 // size**2)  # states at a time
    for own, which in alike({x: points[x] for x in parameters}, n):
        given = column.own_parameters(dict(own))
        M, E, H = column.matrices(modes, False, **given)
        E, B = _coordinates(M, E)
        H = B.T @ H @ B
        for part in (which[k : k + block] for k in range(0, len(which), block)):
            c_M, c_E = column.kernel.damping_factors(points["alpha"][part], points["beta"][part], **given)
            c_M, c_E = (np.broadcast_to(c, part.shape)[:, None, None] for c in (c_M, c_E))
            K = E + points["load"][part, None, None] * H
            found[part] = _values(K, c_M * np.eye(modes) + c_E * E)
    for row in found:
        row[:] = row[_order(row)]
    return found.reshape(*arrays[0].shape, size)


def _values(K: Real, C: Real) -> Complex:
    """λ (m, 2n) of q̈ + C q̇ + K q = 0, each (m, n, n). Undamped ones from s = −λ², as in `_eigen`."""
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


@dataclass(frozen=True)
class Branches:
    """Eigenvalues followed along the load: `loads` (m,), `eigenvalues` (m, 2n), column k the same branch at every
    load, and `vectors` (m, n, 2n) alike, or None. Columns are numbered as `spectrum` sorts them at the first
    load. Nondimensional."""

    loads: Real
    eigenvalues: Complex
    vectors: Complex | None = field(repr=False, default=None)
    errors: Callable[[], Real] | None = field(repr=False, compare=False, default=None)

    @cached_property
    def error(self) -> Real:
        """Estimated error of each of `eigenvalues` (m, 2n) against the beam's own, relative, as `Spectrum.error` but
        for rounding; computed when first asked for."""
        return np.full(self.eigenvalues.shape, np.nan) if self.errors is None else self.errors()


def branches(
    column: Column,
    loads: ArrayLike,
    modes: int | None = None,
    alpha: float = 0.0,
    beta: float = 0.0,
    rigid: bool = False,
    vectors: bool = False,
    **parameters: float,
) -> Branches:
    """The eigenvalues at each of `loads` (m,), any order, so arranged that each column is continuous along the load.

    From each load to the next, eigenvalues are matched by the trapezoid rule with dλ/dP from left and right
    eigenvectors, and the interval is halved where the match is not clear. Where two meet and part on other axes (an
    undamped coalescence, a pair that becomes overdamped), no labelling is the right one; then, of the two that part,
    the one with the greater real part, or imaginary part where real parts agree, goes on with the smaller number.
    Raises InputError for loads that are not finite, or too far apart to follow branches from one to the next.
    """
    is_column(column)
    P = np.atleast_1d(reals("loads", loads))
    if P.ndim != 1 or not len(P):
        raise refusal("loads", loads, "must be finite numbers, one or more, in a sequence of shape (m,)")
    computable("loads", float(np.abs(P).max()))
    modes = column.number(modes)
    system = column.system(modes, 0.0, alpha, beta, rigid, **parameters)
    e = slice(system.rigid_count, None)
    follower = _Follower(*(np.asarray(X)[e, e] for X in (system.M, system.C, system.E, system.H)))
    state = follower.at(P[0])
    states = [state]
    for load in P[1:]:
        follower.left = MOST_STEPS
        state = follower.follow(state, follower.at(load))
        states.append(state)
    values = np.array([x.values for x in states])
    shapes = np.array([x.vectors for x in states]) if vectors else None
    if system.rigid_count:
        values, shapes = _join_rigid(system, P, values, shapes)
    order = _order(values[0])
    values = values[:, order]
    if shapes is not None:
        shapes = shapes[:, :, order]
        peak = np.take_along_axis(shapes, np.abs(shapes).argmax(axis=1)[:, None, :], axis=1)
        shapes = shapes / peak
    rigid_ones = values.shape[1] - 2 * modes

    def errors() -> Real:
        own = {name: float(value) for name, value in parameters.items()}
        elastic = order < 2 * modes if rigid_ones else np.ones(len(order), dtype=bool)
        found = np.zeros(values.shape)
        found[:, elastic] = beam_errors(column, values[:, elastic], P, modes, alpha, beta, own)
        return found

    return Branches(P, values, shapes, errors)


def _join_rigid(system: Any, loads: Real, values: Complex, shapes: Complex | None) -> tuple[Complex, Complex | None]:
    """Branches of the whole system: the rigid block's eigenvalues come after, those at every load in their order."""
    r = system.rigid_count
    all_values, all_shapes = [], []
    for k, load in enumerate(loads):
        K = system.E + load * system.H
        rigid, ones = _eigen(system.M[:r, :r], system.C[:r, :r], K[:r, :r])
        order = _order(rigid)
        all_values.append(np.concatenate([values[k], rigid[order]]))
        if shapes is not None:
            full = _lift(system.M, system.C, K, r, values[k], shapes[k])
            motion = np.zeros((len(K), 2 * r), dtype=complex)
            motion[:r] = ones[:, order]
            all_shapes.append(np.hstack([full, motion]))
    return np.array(all_values), np.array(all_shapes) if shapes is not None else None


@dataclass(frozen=True)
class _State:
    """Eigenvalues at a load, each at its branch's place, with dλ/dP and q̂ in columns."""

    load: float
    values: Complex
    rates: Complex
    vectors: Complex

    def take(self, order: NDArray[np.intp]) -> _State:
        return _State(self.load, self.values[order], self.rates[order], self.vectors[:, order])


class _Follower:
    """Follows the eigenvalues of M q̈ + C q̇ + (E + P H) q = 0 along P."""

    def __init__(self, M: Real, C: Real, E: Real, H: Real) -> None:
        self.n = len(M)
        self.E, self.basis = _coordinates(M, E)
        self.C, self.H = (self.basis.T @ X @ self.basis for X in (C, H))
        self.unit = np.eye(self.n)
        self.left = MOST_STEPS

    def at(self, load: float) -> _State:
        """Eigenvalues at a load, sorted as `spectrum` sorts them."""
        n, K = self.n, self.E + load * self.H
        if not self.C.any():
            s, V = np.linalg.eig(np.asarray(K))
            ds = np.einsum("kj,ji,ik->k", _left(V), self.H, V)
            root = np.sqrt(-s.astype(complex))
            values = np.concatenate([root, -root]) + 0.0
            with np.errstate(divide="ignore", invalid="ignore"):
                rates = -np.concatenate([ds, ds]) / (2 * values)
            vectors = np.hstack([V, V]).astype(complex)
        else:
            values, W = np.linalg.eig(state_matrix(self.unit, self.C, K))
            rates = -np.einsum("kj,ji,ik->k", _left(W)[:, n:], self.H, W[:n])
            vectors = W[:n].astype(complex)
        vectors = self.basis @ vectors
        state = _State(float(load), values.astype(complex), np.nan_to_num(rates.astype(complex)), vectors)
        return state.take(_order(state.values))

    def follow(self, a: _State, b: _State, depth: int = 0) -> _State:
        """State b in the order of a."""
        order = self._match(a, b, last=depth >= MOST_CUTS)
        if order is not None:
            return b.take(order)
        self.left -= 1
        if self.left < 0:
            raise InputError(
                f"loads: from {a.load:g} on, branches cannot be told apart in {MOST_STEPS} steps to the next load; "
                "give loads that are closer to one another"
            )
        middle = self.follow(a, self.at((a.load + b.load) / 2), depth + 1)
        return self.follow(middle, b, depth + 1)

    def _match(self, a: _State, b: _State, last: bool) -> NDArray[np.intp] | None:
        """For each branch the place in b that goes on with it; None where that is not clear."""
        h = b.load - a.load
        if h == 0:
            last = True
        with np.errstate(over="ignore", invalid="ignore"):  # of rates without bound, where two meet
            gap = np.nan_to_num(np.abs(b.values - a.values[:, None] - h / 2 * (a.rates[:, None] + b.rates)), nan=np.inf)
        order: NDArray[np.intp] = gap.argmin(axis=1)
        k = np.arange(len(order))
        room = np.minimum(_room(a.values), _room(b.values)[order])
        good = (gap.argmin(axis=0)[order] == k) & (gap[k, order] <= 0.1 * room)
        if good.all():
            return order
        loose_a, loose_b = k[~good], np.setdiff1d(k, order[good])
        paired = _part(a, b, loose_a, loose_b)
        if paired is not None:
            order[loose_a] = paired
            return order
        if not last:
            return None
        from scipy.optimize import linear_sum_assignment

        order[loose_a] = loose_b[linear_sum_assignment(np.abs(b.values[loose_b] - a.values[loose_a][:, None]))[1]]
        return order


def _left(V: Any) -> Any:
    try:
        return np.linalg.inv(V)
    except np.linalg.LinAlgError:  # at a coalescence to the last digit
        return np.linalg.pinv(V)


def _room(values: Complex) -> Real:
    """Distance of each value from its nearest neighbour."""
    gap = np.abs(values - values[:, None])
    np.fill_diagonal(gap, np.inf)
    return np.asarray(gap.min(axis=0))


def _part(a: _State, b: _State, ka: NDArray[np.intp], kb: NDArray[np.intp]) -> NDArray[np.intp] | None:
    """Places in b for the branches ka where they meet in pairs and part on other axes; None where they do not.

    Then (λ₁ − λ₂)² is real and changes its sign, while λ₁ + λ₂ stays smooth.
    """
    if len(ka) > 2:  # the same above the real axis and below it
        result = np.zeros(len(ka), dtype=np.intp)
        for side in (1, -1):
            ia, ib = a.values[ka].imag * side > 0, b.values[kb].imag * side > 0
            if ia.sum() != 2 or ib.sum() != 2 or len(ka) != 4:
                return None
            half = _part(a, b, ka[ia], kb[ib])
            if half is None:
                return None
            result[ia] = half
        return result
    if len(ka) != 2 or len(kb) != 2:
        return None
    da, db = ((x.values[k[0]] - x.values[k[1]]) ** 2 for x, k in ((a, ka), (b, kb)))
    if max(abs(da.imag) / abs(da), abs(db.imag) / abs(db)) > 1e-6 if da and db else True:
        return None
    if da.real * db.real >= 0:
        return None
    sum_a, sum_b = a.values[ka].sum(), b.values[kb].sum()
    others = np.setdiff1d(np.arange(len(a.values)), ka), np.setdiff1d(np.arange(len(b.values)), kb)
    room = min(
        (np.abs(x.values[o] - m / 2).min(initial=np.inf) for x, o, m in ((a, others[0], sum_a), (b, others[1], sum_b))),
    )
    slope = (a.rates[ka].sum() + b.rates[kb].sum()) / 2
    spread = max(abs(da), abs(db)) ** 0.5
    if abs(sum_b - sum_a - (b.load - a.load) * slope) > 0.2 * room or spread > 2 * room:
        return None
    return np.asarray(kb[np.lexsort((-b.values[kb].imag, -b.values[kb].real))])
