"""The eigenvalues of Eq. (10): as floats, to judge a system by; and to more digits, to make many steps by."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from freebeam_sym.response.digits import Array, Complex, Double, Fixed, fixed, stacked
from freebeam_sym.spectra import inverse, state_matrix

if TYPE_CHECKING:
    from freebeam_sym.columns import System

CONDITION = 100.0
"""Condition of an eigenvalue above which coalescence or rigid motion is near, and powers of the whole matrix are taken:
rounding of the vectors costs this factor."""


@dataclass(frozen=True, eq=False)
class Spectrum:
    """The exact eigenvalues (2 n,) of the part of a system that is judged, and their vectors."""

    whole: tuple[Array, Array, Array]
    """M, C, K of the system."""
    rigid_count: int
    part: slice
    """That part of the coordinates: without the rigid ones where these have no share in the elastic spectrum."""
    values: Complex
    vectors: Complex
    decay: float
    """Fastest decay of the part that is not judged."""

    @cached_property
    def matrices(self) -> tuple[Array, Array, Array]:
        """M, C, K of the part that is judged, (n, n)."""
        M, C, K = (X[self.part, self.part] for X in self.whole)
        return M, C, K

    @cached_property
    def half(self) -> NDArray[np.bool_]:
        """Which of the eigenvalues have Im λ ≥ 0: what belongs to the others is conjugate."""
        return self.values.imag >= 0

    @cached_property
    def oscillating(self) -> NDArray[np.intp]:
        """Places of those with Im λ > 0, by their frequency."""
        found = np.flatnonzero(self.values.imag > 0)
        return found[np.argsort(self.values[found].imag)]

    @cached_property
    def inverse(self) -> Complex:
        """Of the vectors; a pseudoinverse where these are parallel."""
        return np.asarray(inverse(self.vectors))

    @cached_property
    def growing(self) -> complex | None:
        """The eigenvalue that grows fastest; None where none grows by more than rounding may have made of it."""
        worst = int(np.argmax(self.values.real))
        if not self.values[worst].real > 0:
            return None
        scale = scale_of(self.matrices[0], self.matrices[2])
        condition = np.linalg.norm(self.vectors[:, worst] / scale) * np.linalg.norm(self.inverse[worst] * scale)
        # first order in the backward error of the eigenvalues; 10 is generous where a few eps of the norm are usual
        rounding = 10 * np.finfo(float).eps * condition * np.abs(self.values).max()
        return complex(self.values[worst]) if self.values[worst].real > rounding else None

    @cached_property
    def refined(self) -> Refined | None:
        """Eigenvalues and vectors to more digits; None where they are ill conditioned.

        One step of Newton's method with the residual in twice the digits: what is left is its square.
        """
        (M, C, K), high = self.matrices, self.values[self.half]
        oscillating = high.imag > 0
        n, m = len(M), high.size

        def with_conjugates(V: Complex) -> Complex:
            X = np.concatenate([V, V * high])
            return np.concatenate([X, np.conj(X[:, oscillating])], axis=1)

        V = self.vectors[:n, self.half]
        X = with_conjugates(V)
        W: Complex = inverse(X).astype(complex)
        # G X − X Λ, real parts first: its upper half is exact rounding of V λ, its lower one M⁻¹ (…)
        a, b, parts = np.diag(high.real), np.diag(high.imag), np.concatenate([X.real[:, :m], X.imag[:, :m]], axis=1)
        turned = Double.of(parts) @ np.block([[a, b], [-b, a]])
        states = stacked(Double.of(parts), turned[n:])
        lower = (Double.of(np.concatenate([K, C, M], axis=1)) @ states).high
        residual = -np.concatenate([(turned[:n] - parts[n:]).high, np.linalg.solve(M, lower)])
        E = W @ (residual[:, :m] + 1j * residual[:, m:])
        own = np.arange(m)
        low, gaps = E[own, own], high - np.append(high, np.conj(high[oscillating]))[:, None]
        gaps[own, own] = np.inf
        with np.errstate(divide="ignore", invalid="ignore"):
            moves = E / gaps
        if not np.abs(moves).max() < 1e-8:  # its square would not be rounding
            return None
        X = with_conjugates(V + X[:n] @ moves)
        W = np.linalg.inv(X).astype(complex)
        scale = scale_of(M, K)
        condition = np.linalg.norm(X / scale[:, None], axis=0) * np.linalg.norm(W * scale, axis=1)
        if not condition.max() < CONDITION:
            return None
        pairs = zip(high.tolist(), low.tolist(), strict=True)
        exact = [(fixed(z.real) + fixed(rest.real), fixed(z.imag) + fixed(rest.imag)) for z, rest in pairs]
        return Refined(high, exact, X, W)


class Refined(NamedTuple):
    """Eigenvalues λ with Im λ ≥ 0, (m,), as floats and to more digits, and the vectors (q, λ q), (2 n, 2 n): theirs,
    then the conjugates'."""

    high: Complex
    exact: list[Fixed]
    vectors: Complex
    inverse: Complex


def scale_of(M: Array, K: Array) -> Array:
    """Sizes of q and dq, powers of two, (2 n,), with which the entries of a step's matrix are of one order."""
    stiffness, mass = np.abs(np.diag(K)), np.diag(M)
    rates = np.sqrt(np.where(stiffness > 0, stiffness, mass) / mass)
    return np.concatenate([np.ones(len(M)), np.exp2(np.round(np.log2(rates)))])


def spectrum_of(system: System) -> Spectrum:
    """The exact spectrum, kept from earlier calls, by value.

    Rigid functions of a free beam make λ = 0 defective, of a size that rounding decides: the elastic part is judged.
    """
    matrices = (np.asarray(part, dtype=float).tobytes() for part in (system.M, system.C, system.K))
    return _spectrum(len(system.M), system.rigid_count, *matrices)


@lru_cache(maxsize=64)
def _spectrum(size: int, r: int, *matrices: bytes) -> Spectrum:
    M, C, K = whole = tuple(np.frombuffer(part).reshape(size, size) for part in matrices)
    decay, part = 0.0, slice(0, None)
    if r and not _coupled(M, C, K, r):
        decay = float(np.abs(np.linalg.eigvals(np.linalg.solve(M[:r, :r], C[:r, :r]))).max())
        part = slice(r, None)
    A = state_matrix(*(X[part, part] for X in whole))
    values, vectors = (found.astype(complex) for found in np.linalg.eig(A))
    return Spectrum((M, C, K), r, part, values, vectors, decay)


def _coupled(M: Array, C: Array, K: Array, r: int) -> bool:
    """Whether the r rigid functions take part in the elastic spectrum; those of the free beam do not."""
    small = 1e-9 * np.abs(K[r:]).max(axis=1, keepdims=True)
    if (np.abs(K[r:, :r]) > small).any() or (np.abs(C[r:, :r]) > small).any():
        return True
    own = np.linalg.solve(M[:r, :r], K[:r, :r])
    return bool(np.abs(np.linalg.eigvals(own)).max() > 1e-6 * max(np.abs(own).max(), 1e-300))
