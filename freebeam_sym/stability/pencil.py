"""The pencil E + P H − s M of a column: all of a problem that does not depend on the damping. Eqs. (24), (25)."""

from __future__ import annotations

from functools import cached_property, lru_cache
from threading import get_ident
from typing import Any

import numpy as np

from freebeam_sym.checks import Unstable
from freebeam_sym.massless import indefinite
from freebeam_sym.stability.equations import divergences
from freebeam_sym.stability.problem import CLOSE, Complex, Event, Real

__all__ = ["Pencil", "diagonalise", "pencil_of"]


class Pencil:
    """det(E + P H − s M) in the basis where M = I and E = diag(e): all that does not depend on the damping.

    M, E symmetric positive definite and H any, each (N, N). Attributes: `e` (N,) ascending, squared frequencies
    at P = 0; `H` (N, N); `relative` (N, N), H where E = I, whose norm decides what counts as rounding; `basis` (N, N),
    whose columns are the new basis in the old coordinates; `kept`, what other modules have made of it. Raises
    InputError where M or E is not positive definite: the unloaded column is then not stable, and there is no first loss
    of stability.
    """

    def __init__(self, M: Real, E: Real, H: Real) -> None:
        M, E, H = (np.asarray(a, dtype=float) for a in (M, E, H))
        e, basis = diagonalise(M, E)
        self.e: Real = e
        self.basis: Real = basis
        self.H: Real = np.ascontiguousarray(basis.T @ H @ basis)
        self.size = len(e)
        root = np.sqrt(e)
        self.relative: Real = self.H / np.outer(root, root)
        self.norm = float(np.linalg.norm(self.relative, 2))
        self.kept: dict[Any, Any] = {}

    @cached_property
    def conservative(self) -> bool:
        """H symmetric to rounding: the load has a potential, and damping or not, only divergence can come."""
        R = self.relative
        return bool(np.abs(R - R.T).max() <= 1e-13 * np.abs(R).max())

    @cached_property
    def divergences(self) -> tuple[Event, ...]:
        """Where det(E + P H) = 0 for real P > 0, with no regard to flutter before: see `equations.divergences`."""
        R = self.relative
        mu = np.linalg.eigvalsh(-(R + R.T) / 2) if self.conservative else np.linalg.eigvals(-R)
        mu = mu[(np.abs(mu.imag) <= CLOSE * mu.real) & (mu.real > 1e-14 * np.abs(mu).max(initial=0.0))]
        K, root = np.array([np.eye(self.size), R]), np.sqrt(self.e)
        return divergences(1 / mu[np.argsort(-mu.real)], K, lambda v, _: self.vector(v / root))

    def vector(self, v: Real | Complex) -> Complex:
        """v of this basis in the column's own coordinates, largest entry 1."""
        q = (self.basis @ v).astype(complex)
        return np.asarray(q / q[np.abs(q).argmax()])


def diagonalise(M: Real, E: Real) -> tuple[Real, Real]:
    """e ascending and B with Bᵀ M B = I, Bᵀ E B = diag(e), each to the digits of its own size.

    Raises InputError where M or E is not positive definite."""
    try:
        np.linalg.cholesky(M)
    except np.linalg.LinAlgError:
        raise indefinite() from None
    m, k = np.sqrt(np.diag(M)), np.diag(E)
    if (k > 0).all():
        rest = [np.abs(X / np.outer(d, d) - np.eye(len(d))).max() for X, d in ((M, m), (E, np.sqrt(k)))]
        if max(rest) <= 1e-13:  # comparison modes: a scaling, with no rounding of the lowest by the highest
            order = np.argsort(k / m**2)
            return (k / m**2)[order], np.diag(1 / m)[:, order]
    # 1/e from the elastic energy's side: the low modes, which decide, keep their relative accuracy
    try:
        np.linalg.cholesky(E - 1e-14 * np.diag(k))  # what rests with a factor such as exp(-x) has e of rounding alone
        L = np.linalg.cholesky(E)
        half = np.linalg.solve(L, M)
        inverse, Y = np.linalg.eigh(np.linalg.solve(L, half.T))
        if not (inverse > 0).all():  # E is singular but for rounding, which hides it from its factors
            raise np.linalg.LinAlgError
    except np.linalg.LinAlgError:
        raise Unstable(
            "E is not positive definite: the column is not stable at load 0, so it has no first loss of stability"
        ) from None
    e = 1 / inverse[::-1]
    return e, np.linalg.solve(L.T, Y[:, ::-1]) * np.sqrt(e)


def pencil_of(M: Real, E: Real, H: Real) -> Pencil:
    """The pencil of these matrices, kept from earlier calls: by value, so that no one's change of an array is
    missed, and by thread, as what a pencil holds is computed when it is first asked for."""
    return _kept(get_ident(), len(M), *(np.asarray(a, dtype=float).tobytes() for a in (M, E, H)))


@lru_cache(maxsize=64)
def _kept(thread: int, n: int, *matrices: bytes) -> Pencil:
    return Pencil(*(np.frombuffer(a).reshape(n, n) for a in matrices))
