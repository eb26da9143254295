"""First loss of stability of a column as its load grows from zero: flutter, divergence, or none up to a stated load.

With K = E + P H and C = size · diag(D), in the basis where M = I and E = diag(e), the column is stable at P = 0. What
can end that is a divergence, det(E + P H) = 0, or a flutter, two eigenvalues that add up to zero.

Flutter loads are the real eigenvalues of one operator. Where x = (v, iωv) is a state of Eq. (25) with A x = iωx, the
antisymmetric X = Im(x xᴴ) solves A X + X Aᵀ = 0, and some X ≠ 0 does so exactly where two eigenvalues of A add up to
zero (the bialternate product of A with I is singular: Fuller 1968; Guckenheimer, Myers and Sturmfels 1997). The blocks
of X are made of S = −ω Re(v vᴴ) = Sᵀ and Y = Im(v vᴴ)/size = −Yᵀ, for which

    Y Kᵀ − K Y + S D + D S = 0
    S Kᵀ − K S = size² (D W + W D),    W = (Y Kᵀ + K Y + S D − D S)/2

linear in P, and regular down to size = 0, the limit of vanishing damping. At P = 0 each pair of modes stands alone, so
this is z = P T z, and T z costs two products of N × N matrices (`_Operator`). Arnoldi's method finds the eigenvalues
1/P of greatest modulus (`_Krylov`), Newton's method makes them exact (`pencil.newton`).

`first_loss` takes divergences and flutters in the order of their loads and decides of each, in one place, whether
stability is lost there: a simple root loses it; two roots that rounding cannot tell apart are a touch, unless
eigenvalues grow beyond it. A count of the eigenvalues that grow just below the answer confirms that none was missed.
"Stable" means the elastic spectrum: rigid motion of a free beam drifts at any load.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from freebeam_sym.checks import InputError
from freebeam_sym.counts import growing, unstable
from freebeam_sym.pencil import CLOSE, NEAR, Complex, Crossing, Damping, Event, Pencil, Real, newton

__all__ = ["LIGHTEST_SCAN", "FirstLoss", "first_crossing", "first_loss", "polished", "rounding", "scan"]

LIGHTEST_SCAN = 1e-5
"""Damping ratio of mode 1 below which boundary points are computed at this ratio first: they move by its square only,
and Newton's method ends at the true damping. Far below it their imaginary parts are rounding."""
TOLERANCE = 1e-9
"""Residual, relative, at which an eigenvalue of T is taken. Newton's method starts from it."""
DOUBLE = 1e-13
"""The same for eigenvalues of T that are close together, whose errors are as the root of their residuals."""
MARGIN = 1e-3
"""Relative. So far below a load it is confirmed that nothing grows, and so far above a touch, or half the way to its
neighbour: far enough for the counts, since at a touch ω² falls as the square of the distance."""
ROUNDING = 1e-15
"""Of the matrices' entries, relative to the matrices' norms."""
STEPS = 400
"""Most steps of Arnoldi's method. 10,000 random questions of the package's columns (N to 40, any damping) took 12 in
the median and 214 at most."""


@dataclass(frozen=True)
class FirstLoss:
    """`crossing`: the first loss of stability, None where there is none. `touches`: loads below it at which an
    eigenvalue comes to the imaginary axis and goes back, or passes it and returns within rounding: no loss."""

    crossing: Crossing | None
    touches: tuple[Crossing, ...] = ()


class _Operator:
    """T. A vector holds Y above its diagonal, and there too q = S Hᵀ − H S, which is all that P multiplies."""

    def __init__(self, pencil: Pencil, damping: Damping) -> None:
        e, D, square = pencil.e, damping.shape, damping.size**2
        self.H, n = pencil.H, pencil.size
        if square < 1e-6 * e[0] and (np.diff(e) < 1e-8 * e[1:]).any():  # T is infinite, or nearly so
            raise InputError(
                "two modes have one frequency without load: with so little damping their first loss of stability is "
                "not computed"
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
        # entries of an eigenvector fall as 1/√(e_i e_j); unscaled, the lowest modes drown in the rounding of the others
        root = np.sqrt(e[i] * e[j])
        self._scale = np.concatenate([root, root / np.maximum(e[i], e[j])])
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


class _Krylov:
    """Arnoldi's method, taken as many steps as is asked for."""

    def __init__(self, apply: Callable[[Real], Real], order: int) -> None:
        self._apply, self.most = apply, min(order, STEPS)
        start = np.cos(np.arange(order) + 0.3)  # any vector
        self._basis, self._h = [start / np.linalg.norm(start)], np.zeros((self.most + 1, self.most))
        self._look = 9
        self.done = False

    def _step(self) -> None:
        """One more vector of the basis."""
        k = len(self._basis) - 1
        Q = np.asarray(self._basis)
        w = self._apply(Q[k])
        for _ in range(2):  # once more, so that the basis stays orthogonal to rounding
            c = Q @ w
            w = w - c @ Q
            self._h[: k + 1, k] += c
        b = self._h[k + 1, k] = float(np.linalg.norm(w))
        self.done = k == self.most - 1 or b < 1e-14 * np.abs(self._h[: k + 1, : k + 1]).max()
        self._basis.append(w / b if b else w)

    def values(self, floor: float, after: float) -> tuple[Complex, Complex]:
        """Eigenvalues of positive real part and modulus above `floor`, descending, (m,), and their vectors (m, order):
        among them the greatest real one below `after`, and all of greater modulus than it."""
        while True:
            while not self.done and len(self._basis) <= self._look:
                self._step()
            k = len(self._basis) - 1
            self._look = int(1.25 * k) + 1
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
        return theta[found], s[:, found].T @ np.asarray(self._basis[:k])


def first_loss(
    pencil: Pencil, alpha: float = 0.0, beta: float = 0.0, load_max: float = 1000.0, kappa: float | None = None
) -> FirstLoss:
    """First loss of stability for 0 < P ≤ load_max at damping C = alpha E + beta M, or in the limit of vanishing
    damping at the ratio kappa = beta/alpha.

    Raises InputError where damping feeds energy in, and where two modes have one frequency and hardly any damping.
    """
    damping, limit = Damping.of(pencil.e, alpha, beta, kappa), kappa is not None
    touches: list[Crossing] = []
    stable = 0.0
    events = _in_order(pencil, damping, load_max)
    event = next(events, None)
    while event is not None:
        crossing = event.crossing
        if not event.simple:
            following = next(events, None)
            ahead = math.inf if following is None else following.crossing.load / crossing.load - 1
            beyond = crossing.load * (1 + min(MARGIN, ahead / 2))
            if ahead < 2 * NEAR or not unstable(pencil, damping, beyond, limit):
                touches.append(crossing)
                event, stable = following, stable if ahead < 2 * NEAR else crossing.load
                continue
        below = crossing.load * (1 - min(MARGIN, (1 - stable / crossing.load) / 2))
        if unstable(pencil, damping, below, limit):
            return FirstLoss(scan(pencil, damping, stable, below, limit), tuple(touches))
        return FirstLoss(crossing if crossing.load <= load_max else None, tuple(touches))
    top = load_max * (1 - MARGIN)
    if stable < top and unstable(pencil, damping, top, limit):
        return FirstLoss(scan(pencil, damping, stable, top, limit), tuple(touches))
    return FirstLoss(None, tuple(touches))


def first_crossing(
    pencil: Pencil, alpha: float = 0.0, beta: float = 0.0, load_max: float = 1000.0, kappa: float | None = None
) -> Crossing | None:
    """The crossing of `first_loss`."""
    return first_loss(pencil, alpha, beta, load_max, kappa).crossing


def _in_order(pencil: Pencil, damping: Damping, load_max: float) -> Iterator[Event]:
    """Divergences, flutters and touches, ascending, up to `load_max` and the first simple divergence, beyond which
    nothing can be the first loss; found when they are asked for."""
    waiting = [event for event in pencil.divergences if event.crossing.load <= load_max * (1 + NEAR)]
    last = next((event.crossing.load for event in waiting if event.simple), load_max)
    if not pencil.conservative and pencil.size > 1:
        for flutter in _flutters(pencil, damping, last):
            while waiting and waiting[0].crossing.load <= flutter.crossing.load:
                yield waiting.pop(0)
            yield flutter
    yield from waiting


def _flutters(pencil: Pencil, damping: Damping, bound: float) -> Iterator[Event]:
    """Flutters and their touches below `bound`, ascending, found when they are asked for."""
    operator = _Operator(pencil, damping)
    krylov = _Krylov(operator, operator.order)
    floor, after = (1 - NEAR) / bound, math.inf
    while True:
        mu, vectors = krylov.values(floor, after)
        real = np.flatnonzero((np.abs(mu.imag) <= NEAR * mu.real) & (mu.real < after))
        if not len(real):
            return
        real = real[mu.real[real] >= mu.real[real[0]] * (1 - 2 * NEAR)]
        yield from _told_apart(pencil, damping, operator, mu[real], vectors[real])
        after = float(mu.real[real[-1]]) * (1 - NEAR / 10)


def _told_apart(pencil: Pencil, damping: Damping, operator: _Operator, mu: Complex, vectors: Complex) -> list[Event]:
    """Close eigenvalues of T as simple flutters, ascending, where Newton's method tells them apart, else as one
    event."""
    roots = [_flutter(pencil, damping, operator, float(m.real), z.real) for m, z in zip(mu, vectors, strict=True)]
    if (mu.imag == 0).all() and None not in roots:
        events = sorted((Event(root, True) for root in roots if root), key=lambda event: event.crossing.load)
        loads = np.array([event.crossing.load for event in events])
        if (np.diff(loads) > NEAR / 10 * loads[:-1]).all():
            return [event for event in events if event.crossing.frequency >= 0]
    root = next((root for root in roots if root), None)
    omega, vector = (0.0, np.ones(pencil.size, complex)) if root is None else (max(root.frequency, 0.0), root.vector)
    return [Event(Crossing(float(1 / mu.real.mean()), omega, vector, "flutter"), False)]


def _flutter(pencil: Pencil, damping: Damping, operator: _Operator, mu: float, z: Real) -> Crossing | None:
    """The flutter at an eigenvalue of T, by Newton's method; None where that does not settle there. Of negative
    frequency where two real λ add up to zero, which is no crossing."""
    load = 1 / mu
    # S ~ a aᵀ + ω² size² b bᵀ with a and b at right angles, and Y ~ a bᵀ − b aᵀ
    S, Y = operator.matrices(z)
    sizes, vectors = np.linalg.eigh((S + S.T) / 2)
    top = int(np.abs(sizes).argmax())
    a = vectors[:, top]
    b = -(Y @ a) / sizes[top]
    square = a @ (pencil.e * a + load * (pencil.H @ a)) / (a @ a + damping.size**2 * (a @ (damping.shape * b)))
    root = newton(pencil, damping, float(square), load, a, b)
    if root is None or not abs(root[1] * mu - 1) < NEAR:
        return None
    return _crossing(pencil, damping, root)


def _crossing(pencil: Pencil, damping: Damping, root: tuple[float, float, Real, Real]) -> Crossing:
    """The flutter that a root of `newton` stands for; its frequency is −1 where ω² < 0."""
    square, load, a, b = root
    rounding = 1e-13 * float(pencil.e[0])
    omega = 0.0 if abs(square) <= rounding else math.sqrt(square) if square > 0 else -1.0
    return Crossing(load, omega, pencil.vector(a + 1j * omega * damping.size * b), "flutter")


def polished(pencil: Pencil, damping: Damping, size: float, omega: float, P: float, v: Complex) -> Crossing | None:
    """The flutter near (ω, P) with eigenvector v at damping of this size, at the true damping; None where there is
    none."""
    square = v @ v
    v = v * np.exp(-0.5j * np.angle(square)) / math.sqrt(np.abs(v @ v.conj()))
    root = newton(pencil, damping, omega**2, P, v.real.copy(), v.imag / (omega * size))
    if root is None or root[1] <= 0:
        return None
    found = _crossing(pencil, damping, root)
    return found if found.frequency > 0 else None


def scan(pencil: Pencil, damping: Damping, low: float, high: float, limit: bool, count: int = 256) -> Crossing:
    """A crossing between a stable load and one where something grows, by counts at equal steps and bisection: slow,
    plain, and blind between steps. What is left where Arnoldi's method has missed a crossing."""
    steps = np.linspace(low, high, count + 1).tolist()
    k = next(k for k, load in enumerate(steps) if load > 0 and (load == high or unstable(pencil, damping, load, limit)))
    low, high = steps[max(k - 1, 0)], steps[k]
    while high - low > 4e-16 * high:
        middle = (low + high) / 2
        if not low < middle < high:
            break
        if unstable(pencil, damping, middle, limit):
            high = middle
        else:
            low = middle
    omega, v = growing(pencil, damping, high)
    if omega > 0:
        found = polished(pencil, damping, damping.size or 1.0, omega, high, v.astype(complex))
        if found is not None and abs(found.load - high) < 1e-3 * high:
            return found
    return Crossing(high, omega, pencil.vector(v), "flutter" if omega > 0 else "divergence")


def rounding(pencil: Pencil, damping: Damping, crossing: Crossing) -> float:
    """By how much a crossing's load may be off, relative, for the rounding of E + P H, to first order.

    With G = (E − ω² + iω C + P H) and its null vectors u and v, a change of G by g, real, changes P and ω by
    uᴴ g v + (uᴴ H v) dP + (uᴴ G_ω v) dω = 0, of which both parts hold."""
    first, load, omega = math.sqrt(pencil.e[0]), crossing.load, crossing.frequency
    size = max(damping.size, LIGHTEST_SCAN * first)  # what is left of both parts as damping vanishes
    if crossing.kind == "flutter":
        omega = max(omega, 1e-3 * first)  # as well, where ω vanishes
    slope = (1j * size * damping.shape - 2 * omega) / pencil.e
    G = np.diag(1 + omega * (1j * size * damping.shape - omega) / pencil.e) + load * pencil._relative
    left, _, right = np.linalg.svd(G)
    u, v = left[:, -1].conj(), right[-1].conj()
    a, b = u @ pencil._relative @ v, u @ (slope * v)
    change = ROUNDING * (1 + load * pencil.norm)
    if omega == 0:
        moved = change / abs(a)
    else:
        moved = change * np.linalg.norm((b.conj() * np.outer(u, v)).imag) / abs((a * b.conj()).imag)
    return float(min(moved / load, 1.0))
