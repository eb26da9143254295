"""Eigenvalues followed along the load: each column of the result is one branch."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from freebeam.maps.arrays import eigenvalues
from freebeam_sym.checks import InputError, computable, reals, refusal
from freebeam_sym.columns import Column, System, is_column
from freebeam_sym.massless import without_mass
from freebeam_sym.spectra import Complex, Real, beam_errors, coordinates, eigen, inverse, massless, sorting, with_rigid

__all__ = ["Branches", "branches"]

Places = NDArray[np.intp]

CLEAR = 0.1
"""Share of the distance to the nearest other eigenvalue, up to which a predicted eigenvalue is taken as found."""
MOST_STEPS = 5_000
"""Loads between two given ones at which `branches` looks, at most; a coalescence takes some forty."""
MOST_CUTS = 40
"""How often `branches` halves an interval between two given loads before it takes the match as it stands."""


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
    followers = [_Follower(system, part) for part in _parts(system)]
    pairs = [_together(states) for states in zip(*(follower.along(P) for follower in followers), strict=True)]
    if system.rigid_count:
        pairs = [with_rigid(followers[0].whole(load), *pair) for load, pair in zip(P, pairs, strict=True)]
    values, shapes = (np.array(part) for part in zip(*pairs, strict=True))
    order = sorting(values[0])

    def errors() -> Real:
        def ask(column: Column, modes: int) -> Complex:
            return eigenvalues(column, P, alpha, beta, modes, **parameters)

        elastic = order < 2 * (len(system.M) - system.rigid_count)
        found = np.zeros(values.shape)
        found[:, elastic] = beam_errors(column, values[:, order[elastic]], modes, ask)
        return found

    shapes = shapes[:, :, order]
    shapes = shapes / np.take_along_axis(shapes, np.abs(shapes).argmax(axis=1)[:, None], axis=1)
    return Branches(P, values[:, order], shapes if vectors else None, errors)


@dataclass(frozen=True)
class _State:
    """Eigenvalues at a load, each at its branch's place, with dλ/dP, and q̂ in columns."""

    load: float
    values: Complex
    rates: Complex
    vectors: Complex

    def take(self, order: Places) -> _State:
        return _State(self.load, self.values[order], self.rates[order], self.vectors[:, order])


def _together(states: tuple[_State, ...]) -> tuple[Complex, Complex]:
    """Eigenvalues and vectors of all parts at a load."""
    return np.concatenate([s.values for s in states]), np.concatenate([s.vectors for s in states], axis=1)


def _parts(system: System) -> list[Places]:
    """The elastic functions in parts that nothing couples, such as equal planes, whose eigenvalues agree at every
    load; all in one where a part has no mass of its own."""
    from scipy.sparse.csgraph import connected_components

    e = slice(system.rigid_count, None)
    terms = system.column.coefficients(system.modes, False, system.alpha, system.beta, **system.parameters)
    coupled = np.any([X != 0 for part in (terms.M, terms.C, terms.K) for X in part], axis=0)
    count, label = connected_components(coupled, directed=False)
    parts = [np.flatnonzero(label == k) for k in range(count)]
    if any(without_mass(system.M[e, e][np.ix_(part, part)]) for part in parts):
        return [np.arange(len(label))]
    return parts


class _Follower:
    """Follows the eigenvalues of a part of a system's elastic functions along the load."""

    def __init__(self, system: System, part: Places) -> None:
        e, own = slice(system.rigid_count, None), np.ix_(part, part)
        M, E = system.M[e, e][own], system.E[e, e][own]
        self.system, self.left = system, MOST_STEPS
        self.E, self.basis = coordinates(M, E)
        self.M = self.basis.T @ M @ self.basis if without_mass(M) else None
        self.whole_basis = np.zeros((len(system.M) - system.rigid_count, len(part)))
        self.whole_basis[part] = self.basis
        column, given = system.column, (system.alpha, system.beta)
        terms = column.coefficients(system.modes, False, *given, **system.parameters)
        if len(terms.M) > 1:
            raise InputError(f"{column.name}: its mass depends on the load, so that branches are not followed")
        self.C, self.K = (tuple(self.basis.T @ X[own] @ self.basis for X in of) for of in (terms.C, terms.K[1:]))

    def along(self, loads: Real) -> list[_State]:
        """The states at each load, in the order of those at the first."""
        states = [self.at(loads[0])]
        for load in loads[1:]:
            self.left = MOST_STEPS
            states.append(self.follow(states[-1], self.at(load)))
        return states

    def whole(self, load: float) -> System:
        """The system with its rigid functions at a load."""
        s = self.system
        return s.column.system(s.modes, load, s.alpha, s.beta, s.rigid, **s.parameters)

    def at(self, load: float) -> _State:
        """Eigenvalues at a load, sorted as `spectrum` sorts them."""
        nothing = np.zeros_like(self.E)
        C = sum((load**k * X for k, X in enumerate(self.C)), nothing)
        K = self.E + sum((load**k * X for k, X in enumerate(self.K, 1)), nothing)
        values, V = eigen(C, K) if self.M is None else massless(self.M, C, K)
        U = _left(C, values, V) if self.M is None else _left_massless(self.M, C, K, values, V)
        # dλ/dP = −û (λ dC/dP + dK/dP) q̂
        slopes = [
            sum((k * load ** (k - 1) * X for k, X in terms), nothing)
            for terms in ([*enumerate(self.C)][1:], [*enumerate(self.K, 1)])
        ]
        with np.errstate(invalid="ignore"):
            moved = np.einsum("kj,ji,ik->k", U, slopes[1], V)
            if len(self.C) > 1:
                moved = moved + values * np.einsum("kj,ji,ik->k", U, slopes[0], V)
            rates = np.nan_to_num(-moved)
        return _State(float(load), values, rates, self.whole_basis @ V).take(sorting(values))

    def follow(self, a: _State, b: _State, depth: int = 0) -> _State:
        """State b in the order of a."""
        order = _match(a, b, last=depth >= MOST_CUTS)
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


def _match(a: _State, b: _State, last: bool) -> Places | None:
    """For each branch the place in b that goes on with it; None where that is not clear and not the last chance."""
    h = b.load - a.load
    with np.errstate(over="ignore", invalid="ignore"):  # of rates without bound, where two meet
        off = np.nan_to_num(np.abs(b.values - a.values[:, None] - h / 2 * (a.rates[:, None] + b.rates)), nan=np.inf)
    order: Places = off.argmin(axis=1)
    k = np.arange(len(order))
    gap = np.minimum(_gap(a.values), _gap(b.values)[order])
    clear = (off.argmin(axis=0)[order] == k) & (off[k, order] <= CLEAR * gap)
    if clear.all():
        return order
    open_a, open_b = k[~clear], np.setdiff1d(k, order[clear])
    parted = _parted(a, b, open_a, open_b)
    if parted is not None:
        order[open_a] = parted
    elif last or h == 0:
        from scipy.optimize import linear_sum_assignment

        order[open_a] = open_b[linear_sum_assignment(np.abs(b.values[open_b] - a.values[open_a][:, None]))[1]]
    else:
        return None
    return order


def _gap(values: Complex) -> Real:
    """Distance of each value from its nearest neighbour."""
    gap = np.abs(values - values[:, None])
    np.fill_diagonal(gap, np.inf)
    return np.asarray(gap.min(axis=0))


def _parted(a: _State, b: _State, in_a: Places, in_b: Places) -> Places | None:
    """Places in b for the branches `in_a`, where they meet in pairs and part on other axes; None where they do not.

    Then (λ₁ − λ₂)² is real and changes its sign, while λ₁ + λ₂ stays smooth.
    """
    if len(in_a) == 4:  # the same above the real axis and below it
        found = np.zeros(4, dtype=np.intp)
        for side in (1, -1):
            here, there = a.values[in_a].imag * side > 0, b.values[in_b].imag * side > 0
            half = _parted(a, b, in_a[here], in_b[there]) if here.sum() == 2 else None
            if half is None:
                return None
            found[here] = half
        return found
    if len(in_a) != 2 or len(in_b) != 2:
        return None
    squares = np.array([(x.values[k[0]] - x.values[k[1]]) ** 2 for x, k in ((a, in_a), (b, in_b))])
    if (np.abs(squares.imag) > 1e-6 * np.abs(squares)).any() or not np.prod(squares.real) < 0:
        return None
    sums = [x.values[k].sum() for x, k in ((a, in_a), (b, in_b))]
    gap = min(
        np.abs(np.delete(x.values, k) - total / 2).min(initial=np.inf)
        for x, k, total in ((a, in_a, sums[0]), (b, in_b, sums[1]))
    )
    slope = (a.rates[in_a].sum() + b.rates[in_b].sum()) / 2
    # away from the others by twice their own distance; a tenth of the distance to these for the mean of the two
    if abs(sums[1] - sums[0] - (b.load - a.load) * slope) > 2 * CLEAR * gap or np.abs(squares).max() ** 0.5 > 2 * gap:
        return None
    return np.asarray(in_b[np.lexsort((-b.values[in_b].imag, -b.values[in_b].real))])


def _left(C: Real, values: Complex, V: Complex) -> Complex:
    """Left vectors û (2n, n) of what `eigen` gives, û (2λ + C) q̂ = 1."""
    n = len(C)
    if C.any():
        found: Complex = inverse(np.vstack([V, V * values]))[:, n:]
        return found
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(np.vstack([inverse(V[:, :n])] * 2) / (2 * values[:, None]))


def _left_massless(M: Real, C: Real, K: Real, values: Complex, V: Complex) -> Complex:
    """The same of what `massless` gives, û (m, n), û (2λM + C) q̂ = 1."""
    lam = values[:, None, None]
    U = np.linalg.svd(lam**2 * M + lam * C + K)[0][:, :, -1].conj()
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(U / np.einsum("kj,kji,ik->k", U, 2 * lam * M + C, V)[:, None])
