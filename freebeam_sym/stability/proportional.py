"""Problems of damping C = αE + βM, Eq. (12): their flutters as the real eigenvalues of one operator, and counts.

With K = E + P H and C = size · diag(D) in the basis where M = I and E = diag(e): where x = (v, iωv) is a state of
Eq. (25) with A x = iωx, the antisymmetric X = Im(x xᴴ) solves A X + X Aᵀ = 0, and some X ≠ 0 does so exactly where two
eigenvalues of A add up to zero (the bialternate product of A with I is singular: Fuller 1968; Guckenheimer, Myers and
Sturmfels 1997). The blocks of X are made of S = −ω Re(v vᴴ) = Sᵀ and Y = Im(v vᴴ)/size = −Yᵀ, for which

    Y Kᵀ − K Y + S D + D S = 0
    S Kᵀ − K S = size² (D W + W D),    W = (Y Kᵀ + K Y + S D − D S)/2

linear in P, and regular down to size = 0, the limit of vanishing damping. At P = 0 each pair of modes stands alone, so
this is z = P T z, and T z costs two products of N × N matrices (`_Operator`). Arnoldi's method finds the eigenvalues
1/P of greatest modulus (`Krylov`), Newton's method makes them exact (`equations.newton`).
On the boundary λ = iω the equations are real and regular down to vanishing damping, so that the limit is no special
case. Eqs. (12), (24), (25).
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache, partial

import numpy as np
from numpy.typing import NDArray

from freebeam_sym.checks import InputError
from freebeam_sym.stability.arnoldi import Krylov, events
from freebeam_sym.stability.equations import ROUNDING, moved, newton
from freebeam_sym.stability.general import LIGHTEST, General, grown, of_states
from freebeam_sym.stability.pencil import Pencil
from freebeam_sym.stability.problem import CLOSE, NEAR, Crossing, Event, Real

__all__ = ["LIGHTEST_SCAN", "Proportional"]

LIGHTEST_SCAN = 1e-5
"""Damping ratio of mode 1 below which boundary points are computed at this ratio first: they move by its square only,
and Newton's method ends at the true damping. Far below it their imaginary parts are rounding."""


@dataclass(frozen=True)
class Proportional:
    """The problem of a pencil with damping C = alpha E + beta M, Eq. (12); where both are 0, the limit of vanishing
    damping at the ratio kappa = beta/alpha, or no damping at all where kappa is None.

    size, shape: C = size · diag(shape) in the basis of the pencil. A limit has a shape too: the ratio it is taken at.
    Raises InputError where the damping does not take energy from every mode.
    """

    pencil: Pencil
    alpha: float = 0.0
    beta: float = 0.0
    kappa: float | None = None
    size: float = field(init=False, default=0.0)
    shape: Real = field(init=False)

    def __post_init__(self) -> None:
        e, alpha, beta = self.pencil.e, self.alpha, self.beta
        if alpha or beta:
            top = max(alpha, abs(beta))
            a, b = alpha / top, beta / top
            if a < 0 or not a * e[0] + b > 0:
                raise InputError(f"damping {alpha} E + {beta} M: must take energy from every mode")
            object.__setattr__(self, "size", top * float(a * e[0] + b))
        elif self.kappa is None or math.isinf(self.kappa):  # without damping, frequencies meet where they do for D = I
            a, b = 0.0, 1.0
        else:
            a, b = 1.0, self.kappa
        object.__setattr__(self, "shape", (a * e + b) / (a * e[0] + b))

    @property
    def divergences(self) -> tuple[Event, ...]:
        return self.pencil.divergences

    def flutters(self, bound: float) -> Iterator[Event]:
        """None where the load has a potential. Raises InputError where two modes have one frequency and hardly any
        damping."""
        if self.pencil.conservative or self.pencil.size == 1:
            return iter(())
        operator = _Operator(self)
        found = partial(_flutter, self, operator)
        return events(Krylov(operator, operator.order), (1 - NEAR) / bound, found, lambda mu: 1 / mu, self.pencil.size)

    def unstable(self, load: float) -> int:
        """Elastic eigenvalues λ that grow at a load. Where damping vanishes, or is too small for the 2N eigenvalues to
        show its effect: branches s_j that are not real and positive, or whose growth to first order is positive."""
        p, light = self.pencil, self.size / math.sqrt(self.pencil.e[0]) < LIGHTEST
        with suppress(np.linalg.LinAlgError):  # K singular
            if not light:  # where E = I
                F, K = np.diag(p.e**-0.5), np.eye(p.size) + load * p.relative
                states = of_states(np.diag(self.size * self.shape / p.e), K, F, F)
                return int((grown(np.asarray(np.linalg.eigvals(states), complex), 0.0) > 0).sum())
        return self._of_any.unstable(load, (light, 0.0))

    def onset(self, load: float) -> Crossing:
        found = self._of_any.onset(load)
        return replace(found, vector=self.pencil.vector(found.vector))

    @cached_property
    def _of_any(self) -> General:
        """The same as a problem of any damping: of one that vanishes, or without, of any size."""
        p, direction = self.pencil, np.diag(self.shape)
        matrices = [np.eye(p.size)], [(self.size or 1.0) * direction], [np.diag(p.e), p.H]
        return General(*matrices, vanishing=not self.size)

    def newton(self, w: float, P: float, a: Real, b: Real) -> Crossing | None:
        """The flutter near (ω² = w, P, v = a + iω·size·b) in the basis of the pencil, of negative frequency where
        ω² < 0; None where there is none."""
        p = self.pencil
        M, D, K = np.eye(p.size)[None], np.diag(self.shape)[None], np.array([np.diag(p.e), p.H])
        root = newton(M, D, K, self.size, w, P, a, b, float(p.e[0]))
        return None if root is None else Crossing(root[1], root[0], p.vector(root[2]), "flutter")

    def rounding(self, crossing: Crossing) -> float:
        """By how much a crossing's load may be off, relative, for the rounding of E + P H, to first order."""
        p, load, omega = self.pencil, crossing.load, crossing.frequency
        first = math.sqrt(p.e[0])
        size = max(self.size, LIGHTEST_SCAN * first)  # what is left of both parts as damping vanishes
        if crossing.kind == "flutter":
            omega = max(omega, 1e-3 * first)  # as well, where ω vanishes
        slope = (1j * size * self.shape - 2 * omega) / p.e
        G = np.diag(1 + omega * (1j * size * self.shape - omega) / p.e) + load * p.relative
        off = moved(G, p.relative, np.diag(slope) if omega else None, ROUNDING * (1 + load * p.norm))
        return min(off / load, 1.0)


class _Operator:
    """T. A vector holds Y above its diagonal, and there too q = S Hᵀ − H S, which is all that P multiplies."""

    def __init__(self, problem: Proportional) -> None:
        pencil = problem.pencil
        e, D, square = pencil.e, problem.shape, problem.size**2
        self.H, n = pencil.H, pencil.size
        if square < 1e-6 * e[0] and (np.diff(e) < CLOSE / 10 * e[1:]).any():  # T is nearly infinite
            raise InputError(
                "two modes have almost one frequency without load: with so little damping their first loss is not "
                "computed"
            )
        gap, both = e - e[:, None], D + D[:, None]
        half = square / 2 * both
        # the two equations of each pair of modes at P = 0: both S + gap Y = first, slope S − weight Y = second
        slope, weight = gap - half * (D - D[:, None]), half * (e + e[:, None])
        determinant = gap**2 + square * both * (np.outer(e, D) + np.outer(D, e))
        np.fill_diagonal(weight, 1.0)  # a mode by itself: S = first / both, at vanishing damping too
        np.fill_diagonal(determinant, np.diag(both))
        self._half = half
        self._weight, self._gap = weight / determinant, gap / determinant
        self._slope, self._both = slope / determinant, both / determinant
        self._upper, self._lower, i, j = _pairs(n)
        # entries of an eigenvector fall as 1/√(e_i e_j); unscaled, the lowest modes drown in the rounding of the
        # others, and q, of the size of H, beside Y or Y beside q: units of load and stiffness would matter
        root = np.sqrt(e[i] * e[j])
        self._scale = np.concatenate([root, root / np.maximum(e[i], e[j]) / (e[0] * pencil.norm)])
        self._unpacked = np.zeros(2 * n * n)
        self.order = len(self._scale)

    def matrices(self, z: Real) -> tuple[Real, Real]:
        """S and Y, each (N, N), that z is taken to."""
        self._unpacked[self._upper] = z = z / self._scale
        self._unpacked[self._lower] = -z
        Y, q = self._unpacked.reshape(2, *self.H.shape)
        HY = self.H @ Y
        first, second = HY + HY.T, self._half * (HY - HY.T) - q
        return self._weight * first + self._gap * second, self._slope * first - self._both * second

    def __call__(self, z: Real) -> Real:
        S, Y = self.matrices(z)
        HS = self.H @ S
        return np.asarray(np.concatenate([Y.ravel(), (HS.T - HS).ravel()])[self._upper] * self._scale)


@lru_cache(maxsize=8)
def _pairs(n: int) -> tuple[NDArray[np.intp], ...]:
    """Places of the pairs i < j and of their mirror images in two n × n matrices, flat; i; j."""
    i, j = np.triu_indices(n, 1)
    return *(np.concatenate([a * n + b, n * n + a * n + b]) for a, b in ((i, j), (j, i))), i, j


def _flutter(problem: Proportional, operator: _Operator, mu: float, z: Real) -> Crossing | None:
    """The flutter at an eigenvalue of T, by Newton's method; None where that does not settle there. Of negative
    frequency where two real λ add up to zero, which is no crossing."""
    load, pencil = 1 / mu, problem.pencil
    # S ~ a aᵀ + ω² size² b bᵀ with a and b at right angles, and Y ~ a bᵀ − b aᵀ
    S, Y = operator.matrices(z)
    sizes, vectors = np.linalg.eigh((S + S.T) / 2)
    top = int(np.abs(sizes).argmax())
    a = vectors[:, top]
    b = -(Y @ a) / sizes[top]
    square = a @ (pencil.e * a + load * (pencil.H @ a)) / (a @ a + problem.size**2 * (a @ (problem.shape * b)))
    found = problem.newton(float(square), load, a, b)
    return found if found is not None and abs(found.load * mu - 1) < NEAR else None
