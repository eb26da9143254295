"""The pencil E + P H − s M of a column: undamped branches, boundary equations and their Newton iteration.

On the boundary λ = iω the equations are real and regular down to vanishing damping (`newton`), so that the limit is
no special case. All damping of the kind of Eq. (12) is served by one pencil. Eqs. (12), (24), (25).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property, lru_cache
from threading import get_ident
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from freebeam_sym.checks import InputError

__all__ = ["CLOSE", "NEAR", "Crossing", "Damping", "Event", "Pencil", "diagonalise", "newton", "pencil_of"]

Real = NDArray[np.float64]
Complex = NDArray[np.complex128]
Kind = Literal["flutter", "divergence", "none"]

SINGULAR = 1e-14
"""Least singular value of E + P H, relative to its norm (in the basis where E = I), up to which it is singular but for
rounding: matrices are known to 2e-15 of their norms."""


CLOSE = 1e-4
"""Relative distance of loads from which on they are looked at together."""
NEAR = 1e-6
"""Relative. Two roots of a matrix's determinant are known apart from here on: they are off by the root of rounding."""


@dataclass(frozen=True)
class Crossing:
    """A load at which an eigenvalue λ = iω stands on the imaginary axis. All nondimensional.

    `vector` (N,) complex are the generalised coordinates of the motion, largest entry 1. A flutter's frequency is 0
    where an eigenvalue comes to λ = 0 and leaves as a pair that grows.
    """

    load: float
    frequency: float
    vector: Complex
    kind: Literal["flutter", "divergence"]


@dataclass(frozen=True)
class Event:
    """A crossing that may end stability. simple: of a single root, which an eigenvalue passes; else of roots that
    rounding cannot tell apart, so that it may come back."""

    crossing: Crossing
    simple: bool


@dataclass(frozen=True)
class Damping:
    """C = size · diag(shape) in the basis of `Pencil`. A limit (size 0) still has a shape: the ratio it is taken
    at. alpha, kappa: C = alpha (E + kappa M) where there is internal damping; else alpha = 0, and kappa = inf unless
    this is a limit."""

    size: float
    shape: Real
    alpha: float
    kappa: float

    @staticmethod
    def of(e: Real, alpha: float, beta: float, kappa: float | None) -> Damping:
        """alpha = beta = 0 is the limit at β = κα; κ = None is no damping at all, whose fold is that of κ = ∞."""
        if alpha or beta:
            top = max(alpha, abs(beta))
            a, b = alpha / top, beta / top
            if a < 0 or not a * e[0] + b > 0:
                raise InputError(f"damping {alpha} E + {beta} M: must take energy from every mode")
            ratio = beta / alpha if alpha else math.inf
            return Damping(top * float(a * e[0] + b), (a * e + b) / (a * e[0] + b), alpha, ratio)
        if kappa is None or math.isinf(kappa):
            return Damping(0.0, np.ones_like(e), 0.0, math.inf)
        return Damping(0.0, (e + kappa) / (e[0] + kappa), 0.0, kappa)


class Pencil:
    """det(E + P H − s M) in the basis where M = I and E = diag(e): all that does not depend on the damping.

    M, E symmetric positive definite and H any, each (N, N). Attributes: `e` (N,) ascending, squared frequencies
    at P = 0; `H` (N, N), `basis` (N, N) whose columns are the new basis in the old coordinates; `kept`, what other
    modules have made of it. Raises InputError where M or E is not positive definite: the unloaded column is then not
    stable, and there is no first loss of stability.
    """

    def __init__(self, M: Real, E: Real, H: Real) -> None:
        M, E, H = (np.asarray(a, dtype=float) for a in (M, E, H))
        if not (np.isfinite(M).all() and np.isfinite(E).all() and np.isfinite(H).all()):
            raise InputError("M, E, H: must be finite; fewer modes keep them within a float's range")
        e, basis = diagonalise(M, E)
        self.e: Real = e
        self.basis: Real = basis
        self.H: Real = np.ascontiguousarray(basis.T @ H @ basis)
        self.size = len(e)
        # the load matrix relative to the elastic energies; its norm decides what counts as rounding
        root = np.sqrt(e)
        self._relative: Real = self.H / np.outer(root, root)
        self.norm = float(np.linalg.norm(self._relative, 2))
        self.kept: dict[Any, Any] = {}

    @cached_property
    def conservative(self) -> bool:
        """H symmetric to rounding: the load has a potential, and damping or not, only divergence can come."""
        R = self._relative
        return bool(np.abs(R - R.T).max() <= 1e-13 * np.abs(R).max())

    @cached_property
    def divergences(self) -> tuple[Event, ...]:
        """Where det(E + P H) = 0 for real P > 0, ascending, with no regard to flutter before. Two roots are one event
        where E + P H between them is singular but for rounding, real roots or not: a touch of λ = 0."""
        R = self._relative
        mu = np.linalg.eigvalsh(-(R + R.T) / 2) if self.conservative else np.linalg.eigvals(-R)
        mu = mu[(np.abs(mu.imag) <= CLOSE * mu.real) & (mu.real > 1e-14 * np.abs(mu).max(initial=0.0))]
        mu = mu[np.argsort(-mu.real)]
        events: list[Event] = []
        while len(mu):
            load, pair = float(1 / mu[0].real), len(mu) > 1 and mu[1].real > (1 - CLOSE) * mu[0].real
            if pair:
                middle = float(2 / (mu[0].real + mu[1].real))
                least = np.linalg.svd(np.eye(self.size) + middle * R, compute_uv=False)[-1]
                if least <= SINGULAR * (1 + middle * self.norm):
                    events.append(Event(self._divergence(middle), False))
                    mu = mu[2:]
                    continue
            if mu[0].imag == 0:
                events.append(Event(self._divergence(load), True))
            mu = mu[1:]
        return tuple(events)

    def _divergence(self, load: float) -> Crossing:
        """The crossing at ω = 0 whose load is near `load`."""
        A = np.eye(self.size) + load * self._relative
        left, _, right = np.linalg.svd(A)
        u, v = left[:, -1], right[-1]
        # one step of Newton's method: the eigenvalue of the whole pencil knew the load to the norm of H only
        slope, residual = float(u @ self._relative @ v), float(u @ A @ v)
        if abs(residual) < CLOSE * abs(slope * load):
            load -= residual / slope
        return Crossing(float(load), 0.0, self.vector(v / np.sqrt(self.e)), "divergence")

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
        raise InputError("M is not positive definite: the trial functions must be independent") from None
    m, k = np.sqrt(np.diag(M)), np.diag(E)
    if (k > 0).all():
        rest_M = np.abs(M / np.outer(m, m) - np.eye(len(m))).max()
        rest_E = np.abs(E / np.sqrt(np.outer(k, k)) - np.eye(len(m))).max()
        if max(rest_M, rest_E) <= 1e-13:  # comparison modes: a scaling, with no rounding of the lowest by the highest
            order = np.argsort(k / m**2)
            return (k / m**2)[order], np.diag(1 / m)[:, order]
    # 1/e from the elastic energy's side: the low modes, which decide, keep their relative accuracy
    try:
        L = np.linalg.cholesky(E)
    except np.linalg.LinAlgError:
        raise InputError(
            "E is not positive definite: the column is not stable at load 0, so it has no first loss of stability"
        ) from None
    half = np.linalg.solve(L, M)
    inverse, Y = np.linalg.eigh(np.linalg.solve(L, half.T))
    e = 1 / inverse[::-1]
    return e, np.linalg.solve(L.T, Y[:, ::-1]) * np.sqrt(e)


def newton(
    pencil: Pencil, damping: Damping, w: float, P: float, a: Real, b: Real, steps: int = 25
) -> tuple[float, float, Real, Real] | None:
    """Root of the boundary equations near (w = ω², P, a, b), to rounding; None where the iteration does not settle.

    With v = a + iω·size·b, A = diag(e − w) + P H and D = diag(shape), (A + iω·size·D) v = 0 reads

        A a − w size² D b = 0,    A b + D a = 0,    c·a = 1,  c·b = 0

    real, polynomial, and regular down to size = 0, where it is the limit of vanishing damping: uᵀ D a = 0 with u
    the left null vector of A (D = I: the coalescence; D = E: the tangent rule P s′ = s).
    """
    n, e, D = pencil.size, pencil.e, damping.shape
    m, i = 2 * n, np.arange(n)
    c = a / (a @ a)
    x = np.concatenate([a, b - (c @ b) * a])
    # all equations at once are (F + w G + P L) x = (0, …, 0, 1, 0), rows scaled to the size of their mode
    F, G, L = (np.zeros((m + 2, m)) for _ in range(3))
    scale = 1 / (e + abs(w))
    F[i, i] = F[n + i, n + i] = scale * e
    F[n + i, i] = scale * D
    F[m, :n] = F[m + 1, n:] = c
    G[i, i] = G[n + i, n + i] = -scale
    G[i, n + i] = -scale * damping.size**2 * D
    L[:n, :n] = L[n:m, n:] = scale[:, None] * pencil.H
    J = np.empty((m + 2, m + 2))
    before, astray, tiny = math.inf, 0, 1e-7 * float(e[0])
    for _ in range(steps):
        J[:, :m] = F + w * G + P * L
        r = J[:, :m] @ x
        r[m] -= 1
        J[:, m], J[:, m + 1] = G @ x, L @ x
        try:
            change = np.linalg.solve(J, r)
        except np.linalg.LinAlgError:
            return None
        x = x - change[:m]
        w, P = w - float(change[m]), P - float(change[m + 1])
        astray = 0 if w > -tiny and P > 0 else astray + 1
        # where ω goes to zero its square is judged beside that of mode 1
        step = abs(change[m]) / (abs(w) + tiny) + abs(change[m + 1] / P) if P else math.inf
        if astray > 3 or not step < 1e6:
            return None
        # rounding reached: the next step, by the law of the last two, would be below it, or steps no longer shrink
        if step < 1e-9 and (step * (step / before) ** 2 < 1e-16 or step > before / 4):
            return w, P, x[:n], x[n:]
        before = step
    return None


def pencil_of(M: Real, E: Real, H: Real) -> Pencil:
    """The pencil of these matrices, kept from earlier calls: by value, so that no one's change of an array is
    missed, and by thread, as what a pencil holds is computed when it is first asked for."""
    return _kept(get_ident(), len(M), *(np.asarray(a, dtype=float).tobytes() for a in (M, E, H)))


@lru_cache(maxsize=64)
def _kept(thread: int, n: int, *matrices: bytes) -> Pencil:
    return Pencil(*(np.frombuffer(a).reshape(n, n) for a in matrices))
