"""Arnoldi's method, and the flutters that the real eigenvalues of an operator stand for."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np

from freebeam_sym.stability.problem import CLOSE, NEAR, Complex, Crossing, Event, Real

__all__ = ["Krylov", "events"]

TOLERANCE = 1e-12
"""Residual, relative, at which an eigenvalue of T is taken: two that are closer are one to Arnoldi's method."""
DOUBLE = 1e-13
"""The same for eigenvalues of T that are close together, whose errors are as the root of their residuals."""
STEPS = 400
"""Most steps of Arnoldi's method. Of 4,000 random questions of the package's columns (N to 40, any damping) 91 % were
answered at the first look, after 20, or needed none; the longest took 262."""


class Krylov:
    """Arnoldi's method, taken as many steps as is asked for."""

    def __init__(self, apply: Callable[[Real], Real], order: int) -> None:
        self._apply, self.most = apply, min(order, STEPS)
        start = np.cos(np.arange(order) + 0.3)  # any vector
        self._basis, self._h = np.empty((self.most + 1, order)), np.zeros((self.most + 1, self.most))
        self._basis[0] = start / np.linalg.norm(start)
        self.steps, self._look = 0, 20  # so many serve the paper's column at N = 8; a look costs some five steps
        self.done, self._size = False, 0.0

    def _step(self) -> None:
        """One more vector of the basis."""
        k = self.steps
        Q = self._basis[: k + 1]
        w = self._apply(Q[k])
        self._size = max(self._size, math.sqrt(w @ w))
        for _ in range(2):  # once more, so that the basis stays orthogonal to rounding
            c = Q @ w
            w = w - c @ Q
            self._h[: k + 1, k] += c
        b = self._h[k + 1, k] = math.sqrt(w @ w)
        self.done = k == self.most - 1 or b < 1e-14 * self._size
        self._basis[k + 1] = w / b if b else w
        self.steps += 1

    def values(self, floor: float, after: float) -> tuple[Complex, Complex]:
        """Eigenvalues of positive real part and modulus above `floor`, descending, (m,), and their vectors (m, order):
        among them the greatest real one below `after`, and all of greater modulus than it."""
        while True:
            while not self.done and self.steps < self._look:
                self._step()
            k = self.steps
            self._look = int(1.25 * k) + 1  # to look costs k³, a step k: a quarter more steps each time
            theta, s = np.linalg.eig(self._h[:k, :k])
            size, left = np.abs(theta), self._h[k, k - 1] * np.abs(s[-1])
            real = (np.abs(theta.imag) <= NEAR * size) & (theta.real > floor) & (theta.real < after)
            least = max(floor, float(theta.real[real].max(initial=0.0)) * (1 - 1e-3))
            need = size + left >= least
            near = np.abs(theta[:, None] - theta) + np.diag(np.full(k, np.inf)) < CLOSE * size
            tolerance = np.where(real & near.any(axis=1), DOUBLE, TOLERANCE)
            if self.done or (left <= tolerance * size)[need].all():
                break
        found = np.flatnonzero(need & (theta.real > floor))
        found = found[np.argsort(-theta.real[found])]
        return theta[found], np.asarray(s[:, found].T @ self._basis[:k], dtype=complex)


def events(
    krylov: Krylov,
    floor: float,
    flutter: Callable[[float, Real], Crossing | None],
    load: Callable[[float], float],
    size: int,
) -> Iterator[Event]:
    """Flutters and their touches at the real eigenvalues above `floor`, descending, found when they are asked for.

    flutter: the crossing at an eigenvalue and its vector, None where it cannot be had, of negative frequency where it
    is none; load: the load that an eigenvalue stands for; size: N.
    """
    after = math.inf
    while True:
        mu, vectors = krylov.values(floor, after)
        real = np.flatnonzero((np.abs(mu.imag) <= NEAR * mu.real) & (mu.real < after))
        if not len(real):
            return
        real = real[mu.real[real] >= mu.real[real[0]] * (1 - 2 * NEAR)]
        yield from _told_apart(mu[real], [flutter(float(mu[k].real), vectors[k].real) for k in real], load, size)
        after = float(mu.real[real[-1]]) * (1 - NEAR / 10)


def _told_apart(mu: Complex, roots: list[Crossing | None], load: Callable[[float], float], size: int) -> list[Event]:
    """Close eigenvalues as simple flutters, ascending, where Newton's method tells them apart, by their loads or, of
    different motions, by their frequencies, else as one event: where it finds one load of all, as of equal planes, at
    that, else at the mean of what rounding has split."""
    found = sorted((root for root in roots if root), key=lambda root: root.load)
    loads, omega = np.array([(root.load, root.frequency) for root in found]).reshape(-1, 2).T
    if (mu.imag == 0).all() and None not in roots:
        different = (omega[1:] > 0) & (omega[:-1] > 0) & (np.abs(np.diff(omega)) > CLOSE * omega[1:])
        if (different | (np.diff(loads) > NEAR / 10 * loads[:-1])).all():
            return [Event(root, True) for root in found if root.frequency >= 0]
    none = Crossing(0.0, math.nan if None in roots else -1.0, np.ones(size, complex), "flutter")
    root = next((root for root in found if root.frequency >= 0), none)
    one = len(found) == len(mu) and np.ptp(loads) * abs(mu[0]) < np.abs(mu - mu.mean()).max() / 10 * loads.mean()
    at = float(loads.mean()) if one else load(float(mu.real.mean()))
    return [Event(replace(root, load=at), False)]
