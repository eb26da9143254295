"""Problems of any damping: M(P) q̈ + C(P) q̇ + K(P) q = 0, each matrix a polynomial in P, nothing symmetric in general.

On the boundary two eigenvalues add up to zero. With A = [[−K, 0], [0, I]] and B = [[C, M], [I, 0]], where A z = λ B z
for z = (q, λq), that is so exactly where

    A X Bᵀ + B X Aᵀ = 0    for some antisymmetric X ≠ 0

(the bialternate product: Fuller 1968). In the eigenvectors of A⁻¹B at a load P₀ at which all eigenvalues decay, whose
eigenvalues are θ = 1/λ, the left-hand side is (θ_i + θ_j) X_ij and a polynomial in P − P₀ without constant term: 1/(P −
P₀) are the eigenvalues of one operator. Arnoldi's method finds the greatest, Newton's method on the whole matrices
makes the load exact. The inverse of the state matrix keeps the digits of the low modes, and lets a coordinate have no
mass: its eigenvalue is θ = 0.

Without damping the crossing is where two frequencies meet, and the problem is that of `proportional.py`, taken about P₀
where there is no stiffness at P = 0. Limits of vanishing damping, and undamped columns that are gyroscopic or whose
load enters beyond K = E + P H, are scanned: by counts at equal steps, blind between them.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import cached_property
from itertools import zip_longest

import numpy as np

from freebeam_sym.checks import InputError
from freebeam_sym.stability.pencil import SINGULAR, Pencil
from freebeam_sym.stability.problem import CLOSE, NEAR, Complex, Crossing, Event, Real
from freebeam_sym.stability.proportional import Proportional

__all__ = ["General"]

Terms = tuple[Real, ...]

LARGEST = 48
"""Modes that a crossing is looked for with; more are projected on the lowest ones of these, and Newton's method and the
counts take all. Twenty segments of twelve functions then take less than a second."""
STARTS = (0.0, 1e-3, 1e-2, 1e-1, 1.0)
"""Loads at which the search may begin, the first at which all that moves decays, and up to which nothing grows."""
STEPS = 200
"""Most steps of Arnoldi's method."""
TOLERANCE = 1e-8
"""Residual, relative, at which an eigenvalue is taken. Newton's method starts from it."""
GROWING = 1e-12
"""Re λ / |λ| above which an eigenvalue of a damped problem grows; below it is rounding."""
MARGINAL = 1e-6
"""The same without damping, where eigenvalues stand on the axis, and near a coalescence half of the digits are lost."""
SCANNED = 400
"""Equal steps at which a problem is scanned that no operator serves."""


def at(terms: Terms, load: float, size: int) -> Real:
    """Σ P^k terms[k]."""
    total = np.zeros((size, size))
    for term in reversed(terms):
        total = total * load + term
    return total


def slope(terms: Terms, load: float, size: int) -> Real:
    """The derivative of that by P."""
    return at(tuple(k * X for k, X in enumerate(terms))[1:], load, size)


def moved(terms: Terms, load: float) -> Terms:
    """The same polynomial in P − load."""
    out = list(terms)
    for low in range(len(out) - 1):
        for k in range(len(out) - 2, low - 1, -1):
            out[k] = out[k] + load * out[k + 1]
    return tuple(out)


class General:
    """The problem of matrices M, C, K by powers of the load, each (n, n); C empty without damping.

    vanishing: C of a limit of vanishing damping, by powers of the load, of which the direction alone counts. Raises
    InputError where the column is not stable under any small load.
    """

    def __init__(
        self, M: Sequence[Real], C: Sequence[Real], K: Sequence[Real], vanishing: Sequence[Real] | None = None
    ) -> None:
        self.M, self.C, self.K = (tuple(np.asarray(X, dtype=float) for X in terms) for terms in (M, C, K))
        self.direction = None if vanishing is None else tuple(vanishing)
        self.size = len(self.K[0])
        self.start = self._start()

    # --- what grows ---------------------------------------------------------------------------------------------

    @cached_property
    def gyroscopic(self) -> bool:
        """Whether C does no work at all, M and K are symmetric: all that is stable then stands on the axis."""
        even = all(np.array_equal(X, X.T) for X in (*self.M, *self.K))
        return even and all(np.array_equal(X, -X.T) for X in self.C)

    @property
    def damped(self) -> bool:
        return bool(self.C) and not self.gyroscopic

    def _states(self, load: float) -> tuple[Complex, Complex]:
        """θ = 1/λ at a load, times a frequency, and the states. Raises LinAlgError where λ = 0 is an eigenvalue."""
        n, (M, C, K) = self.size, self._matrices(load)
        half = np.linalg.solve(K, np.hstack([C * self.unit, M * self.unit**2]))
        A = np.zeros((2 * n, 2 * n))
        A[:n], A[n:, :n] = -half, np.eye(n)
        return np.linalg.eig(A)

    def _matrices(self, load: float) -> tuple[Real, Real, Real]:
        M, C, K = (at(terms, load, self.size) for terms in (self.M, self.C, self.K))
        return M, C, K

    @cached_property
    def unit(self) -> float:
        """A frequency in whose units the states are well scaled."""
        M, K = self.M[0], sum(self.K[1:], self.K[0])
        ratio = np.abs(np.diag(K)).sum() / max(np.abs(np.diag(M)).sum(), 1e-300)
        return float(math.sqrt(ratio / max(self.size, 1) ** 2)) or 1.0

    def unstable(self, load: float) -> int:
        """How many eigenvalues grow at a load, beyond rounding."""
        if self.direction is not None:
            return self._unstable_in_the_limit(load)
        if not self.C:
            s = np.linalg.eigvals(np.linalg.solve(self._matrices(load)[0], self._matrices(load)[2]))
            return int(((np.abs(s.imag) > 1e-13 * np.abs(s).max()) | (s.real <= 0)).sum())
        try:
            theta, _ = self._states(load)
        except np.linalg.LinAlgError:
            return 1
        size = np.abs(theta)
        limit = (GROWING if self.damped else MARGINAL) * np.maximum(size, 1e-3 * size.max())
        return int((theta.real > limit).sum())

    def _unstable_in_the_limit(self, load: float) -> int:
        """Branches whose square is not real and positive, or that grow to first order in the damping."""
        s, growth = self._branches(load)
        bad = int(((np.abs(s.imag) > 1e-13 * np.abs(s).max()) | (s.real <= 0)).sum())
        return bad or int((growth > 1e-13 * np.abs(growth).max()).sum())

    def _branches(self, load: float) -> tuple[Complex, Real]:
        """s = −λ² without damping, and the growth of each branch to first order in the damping, up to its size."""
        M, _, K = self._matrices(load)
        C = at(self.direction or (), load, self.size)
        s, V = np.linalg.eig(np.linalg.solve(M, K))
        try:
            U = np.linalg.inv(V)
        except np.linalg.LinAlgError:
            U = np.linalg.pinv(V)
        return s, -np.einsum("kj,ji,ik->k", U, np.linalg.solve(M, C), V).real

    def _start(self) -> float:
        """The first of STARTS at which all that moves decays, or nothing grows where there is no damping.

        Raises InputError where something grows at each of them.
        """
        for load in STARTS:
            try:
                if not self.unstable(load) and not self._marginal(load):
                    return load
            except np.linalg.LinAlgError:
                continue
        raise InputError("the column is not stable under a small load, so it has no first loss of stability")

    def _marginal(self, load: float) -> bool:
        """Whether, with damping, something stands on the axis at a load; without, λ = 0 is an eigenvalue."""
        if self.direction is not None or not self.C or self.gyroscopic:
            K = self._matrices(load)[2]
            return bool(np.linalg.cond(K / np.sqrt(np.outer(*[np.abs(np.diag(K)) + 1e-300] * 2))) > 1e13)
        theta, _ = self._states(load)
        seen = theta[np.abs(theta) > 1e-6 * np.abs(theta).max()]
        return bool((seen.real > -1e-11 * np.abs(seen)).any())

    # --- divergence ---------------------------------------------------------------------------------------------

    @cached_property
    def divergences(self) -> tuple[Event, ...]:
        """Where det K = 0, ascending, up to the first simple root; two roots are one event where K between them is
        singular but for rounding."""
        first, *rest = moved(self.K, self.start)
        try:
            blocks = [-np.linalg.solve(first, X) for X in rest]
        except np.linalg.LinAlgError:
            raise InputError("the column has no stiffness under a small load, so it is not stable") from None
        if not blocks:
            return ()
        n, count = self.size, len(blocks)
        A = np.zeros((n * count, n * count))
        A[:n] = np.hstack(blocks)
        A[n:, : n * (count - 1)] = np.eye(n * (count - 1))
        mu = np.linalg.eigvals(A)
        mu = mu[(np.abs(mu.imag) <= CLOSE * mu.real) & (mu.real > 1e-14 * np.abs(mu).max(initial=0.0))]
        mu = mu[np.argsort(-mu.real)]
        events: list[Event] = []
        while len(mu):
            load = self.start + 1 / float(mu[0].real)
            if len(mu) > 1 and mu[1].real > (1 - CLOSE) * mu[0].real:
                middle = self.start + 2 / float(mu[0].real + mu[1].real)
                if self._singular(middle):
                    events.append(Event(self._divergence(middle), False))
                    mu = mu[2:]
                    continue
            if abs(mu[0].imag) <= NEAR * mu[0].real:
                events.append(Event(self._divergence(load), True))
                break
            mu = mu[1:]
        return tuple(events)

    def _scaled(self, load: float) -> tuple[Real, Real]:
        """K at a load with its rows and columns scaled, and the scale."""
        scale = 1 / np.sqrt(np.abs(np.diag(at(self.K, self.start, self.size))) + 1e-300)
        return at(self.K, load, self.size) * np.outer(scale, scale), scale

    def _singular(self, load: float) -> bool:
        A, _ = self._scaled(load)
        values = np.linalg.svd(A, compute_uv=False)
        return bool(values[-1] <= SINGULAR * values[0] * self.size)

    def _divergence(self, load: float) -> Crossing:
        for _ in range(2):  # Newton's method with the null vectors
            A, scale = self._scaled(load)
            left, _, right = np.linalg.svd(A)
            u, v = left[:, -1], right[-1]
            rate = float(u @ (slope(self.K, load, self.size) * np.outer(scale, scale)) @ v)
            residual = float(u @ A @ v)
            if rate and abs(residual) < CLOSE * abs(rate * load):
                load -= residual / rate
        return Crossing(float(load), 0.0, _largest_one(scale * v), "divergence")

    # --- flutter ------------------------------------------------------------------------------------------------

    def flutters(self, bound: float) -> Iterator[Event]:
        """Flutters and their touches below `bound`, ascending, found when they are asked for."""
        if self.direction is None and not self.C and len(self.K) == 2 and len(self.M) == 1:
            yield from self._undamped(bound)
        elif self.direction is None and self.damped:
            yield from self._damped(bound)
        elif self.unstable(bound * (1 - NEAR)) or self.direction is not None or len(self.K) > 2 or self.gyroscopic:
            yield from self._scanned(bound)

    def _undamped(self, bound: float) -> Iterator[Event]:
        """Where frequencies meet: by the operator of `proportional.py`, about the load of the start."""
        M, (E, H) = self.M[0], moved(self.K, self.start)
        s, V = np.linalg.eig(np.linalg.solve(M, E))
        if (s.imag != 0).any():
            yield from self._scanned(bound)
            return
        order = np.argsort(s.real)
        s, V = s.real[order], V.real[:, order]
        pencil = Pencil.of_modes(s, V, np.linalg.solve(V, np.linalg.solve(M, H @ V)))
        for event in Proportional(pencil).flutters(bound - self.start):
            crossing = event.crossing
            yield Event(replace(crossing, load=crossing.load + self.start), event.simple)

    def _scanned(self, bound: float) -> Iterator[Event]:
        """The first load at which something grows, by counts at equal steps and bisection."""
        low = self.start
        for load in np.linspace(self.start, bound * (1 - NEAR), SCANNED + 1)[1:].tolist():
            if self.unstable(load):
                break
            low = load
        else:
            return
        high = load
        while high - low > 4e-16 * high:
            middle = (low + high) / 2
            if not low < middle < high:
                break
            low, high = (low, middle) if self.unstable(middle) else (middle, high)
        crossing = self.onset(high)
        if crossing.kind == "flutter":
            yield Event(crossing, True)

    def _damped(self, bound: float) -> Iterator[Event]:
        after = math.inf
        operator = _Operator(self)
        floor = (1 - NEAR) / max(bound - self.start, 1e-300)
        seen: list[Crossing] = []
        while True:
            mu = operator.values(floor, after)
            if not len(mu):
                return
            for value in mu:
                found = self._flutter(self.start + 1 / float(value))
                if found is not None and not any(abs(found.load - x.load) < NEAR * found.load for x in seen):
                    seen.append(found)
                    yield Event(found, True)
            after = float(mu[-1]) * (1 - NEAR)

    def _flutter(self, load: float) -> Crossing | None:
        """The flutter at a load that is known to few digits, by Newton's method; None where there is none."""
        theta, W = self._states(load)
        swinging = np.abs(theta.imag) > 1e-9 * np.abs(theta)
        if not swinging.any():
            return None
        off = np.where(swinging, np.abs(theta.real) / np.abs(theta), np.inf)
        k = int(off.argmin())
        omega = abs(float((self.unit / theta[k]).imag))
        v = W[: self.size, k] if theta[k].imag < 0 else W[: self.size, k].conj()
        return self.near(load, omega, v)

    def near(self, load: float, omega: float, v: Complex) -> Crossing | None:
        """The flutter near a load, a frequency and a motion, by Newton's method on a bordered determinant."""
        n = self.size
        scale = 1 / np.sqrt(np.abs(np.diag(at(self.K, self.start, n))) + 1e-300)
        c = (v / scale).conj() / np.linalg.norm(v / scale)
        b = c.conj()
        before = math.inf
        for _ in range(30):
            M, C, K = self._matrices(load)
            G = (K - omega**2 * M + 1j * omega * C) * np.outer(scale, scale)
            A = np.zeros((n + 1, n + 1), dtype=complex)
            A[:n, :n], A[:n, n], A[n, :n] = G, b, c
            right = np.zeros(n + 1, dtype=complex)
            right[n] = 1
            try:
                x, y = np.linalg.solve(A, right), np.linalg.solve(A.T, right)
            except np.linalg.LinAlgError:
                return None
            rates = [slope(terms, load, n) for terms in (self.M, self.C, self.K)]
            in_load = (rates[2] - omega**2 * rates[0] + 1j * omega * rates[1]) * np.outer(scale, scale)
            in_omega = (-2 * omega * M + 1j * C) * np.outer(scale, scale)
            f, u, w = x[n], y[:n], x[:n]
            J = np.array([-(u @ in_load @ w), -(u @ in_omega @ w)])
            J = np.array([J.real, J.imag])
            try:
                change = np.linalg.solve(J, [f.real, f.imag])
            except np.linalg.LinAlgError:
                return None
            load, omega = load - float(change[0]), omega - float(change[1])
            step = abs(change[0] / load) + abs(change[1] / omega) if load and omega else math.inf
            if not (load > 0 and omega > 0 and step < 10):
                return None
            if step < 1e-9 and (step < 1e-14 or step > before / 4):
                return Crossing(load, omega, _largest_one(scale * w), "flutter")
            before = step
            b, c = u.conj() / np.linalg.norm(u), w.conj() / np.linalg.norm(w)
        return None

    def onset(self, load: float) -> Crossing:
        """The crossing at which what grows most at a load, just beyond it, has begun to grow."""
        if self.direction is not None or not self.C:
            M, _, K = self._matrices(load)
            s, V = np.linalg.eig(np.linalg.solve(M, K))
            bad = (np.abs(s.imag) > 1e-13 * np.abs(s).max()) | (s.real <= 0)
            weight = np.where(bad, np.inf, self._branches(load)[1] if self.direction is not None else -np.inf)
            k = int(np.argmax(weight))
            omega = math.sqrt(max(0.0, float(s[k].real)))
            return Crossing(load, omega, _largest_one(V[:, k]), "flutter" if omega > 0 else "divergence")
        try:
            theta, W = self._states(load)
        except np.linalg.LinAlgError:
            return self._divergence(load)
        k = int(np.argmax(theta.real))
        omega, v = abs(float((self.unit / theta[k]).imag)), W[: self.size, k]
        if abs(theta[k].imag) < 1e-6 * abs(theta[k]):
            return self._divergence(load)
        found = self.near(load, omega, v if theta[k].imag < 0 else v.conj())
        if found is not None and abs(found.load - load) < 1e-3 * load:
            return found
        return Crossing(load, omega, _largest_one(v), "flutter")

    def rounding(self, crossing: Crossing) -> float:
        """By how much a crossing's load may be off, relative, for the rounding of the matrices, to first order."""
        n, load, omega = self.size, crossing.load, crossing.frequency
        M, C, K = self._matrices(load)
        rates = [slope(terms, load, n) for terms in (self.M, self.C, self.K)]
        scale = 1 / np.sqrt(np.abs(np.diag(K)) + 1e-300)
        both = np.outer(scale, scale)
        G, in_load = (
            (k - omega**2 * m + 1j * omega * c) * both for m, c, k in ((M, C, K), (rates[0], rates[1], rates[2]))
        )
        left, _, right = np.linalg.svd(G)
        u, v = left[:, -1].conj(), right[-1].conj()
        noise = 1e-15 * (np.abs(G).max() + load * np.abs(in_load).max())
        a = u @ in_load @ v
        if omega and self.C:
            w = u @ ((-2 * omega * M + 1j * C) * both) @ v
            bent = abs((a * w.conjugate()).imag) / max(abs(w), 1e-300)
        else:
            bent = abs(a)
        return float(min(noise / max(bent * load, 1e-300), 1.0))


def _largest_one(v: Complex | Real) -> Complex:
    v = np.asarray(v, dtype=complex)
    return np.asarray(v / v[np.abs(v).argmax()])


class _Operator:
    """X ↦ what P − P₀ multiplies, in the eigenvectors of the states at P₀; and Arnoldi's method on it."""

    def __init__(self, problem: General) -> None:
        M, C, K = (moved(terms, problem.start) for terms in (problem.M, problem.C, problem.K))
        M, C, K = self._reduced(M, C, K)
        n, unit = len(K[0]), problem.unit
        zero = np.zeros((n, n))
        A0 = np.block([[-K[0], zero], [zero, np.eye(n)]])
        powers = list(zip_longest(M, C, K, fillvalue=zero))
        B = [
            np.block([[c * unit, m * unit**2], [np.eye(n) if not k else zero, zero]])
            for k, (m, c, _) in enumerate(powers)
        ]
        theta, V = np.linalg.eig(np.linalg.solve(A0, B[0]))
        W = np.linalg.inv(V)
        a = [np.eye(2 * n)] + [
            W @ np.linalg.solve(A0, np.block([[-k, zero], [zero, zero]])) @ V for _, _, k in powers[1:]
        ]
        b = [np.diag(theta)] + [W @ np.linalg.solve(A0, X) @ V for X in B[1:]]
        self.products: list[list[tuple[Complex, Complex]]] = []
        for total in range(1, 2 * len(powers) - 1):
            pairs = [(a[i], b[total - i].T) for i in range(len(a)) if 0 <= total - i < len(b)]
            pairs = [(x, y) for x, y in pairs if x.any() and y.any()]
            self.products.append(pairs)
        while self.products and not self.products[-1]:
            self.products.pop()
        self.upper = np.triu_indices(2 * n, 1)
        self.sums = (theta[:, None] + theta)[self.upper]
        root = np.sqrt(np.abs(theta) + 1e-14 * np.abs(theta).max())
        self.scale = (root[:, None] * root)[self.upper]
        self.shape, self.count = 2 * n, len(self.upper[0])
        self.order = self.count * len(self.products)

    @staticmethod
    def _reduced(M: Terms, C: Terms, K: Terms) -> tuple[Terms, Terms, Terms]:
        """On the lowest modes where there are many."""
        if len(K[0]) <= LARGEST:
            return M, C, K
        even, mass = (K[0] + K[0].T) / 2, (M[0] + M[0].T) / 2
        scale = 1 / np.sqrt(np.abs(np.diag(even)))
        L = np.linalg.cholesky(even * np.outer(scale, scale))
        half = np.linalg.solve(L, mass * np.outer(scale, scale))
        values, Y = np.linalg.eigh(np.linalg.solve(L, half.T))
        B = scale[:, None] * np.linalg.solve(L.T, Y[:, np.argsort(-values)[:LARGEST]])
        M, C, K = (tuple(B.T @ X @ B for X in terms) for terms in (M, C, K))
        return M, C, K

    def __call__(self, z: Complex) -> Complex:
        parts = z.reshape(len(self.products), self.count)
        total = np.zeros((self.shape, self.shape), dtype=complex)
        X = np.zeros((self.shape, self.shape), dtype=complex)
        for part, pairs in zip(parts, self.products, strict=True):
            X[self.upper] = part * self.scale
            X.T[self.upper] = -part * self.scale
            for left, right in pairs:
                total += left @ X @ right
        first = -(total - total.T)[self.upper] / self.sums / self.scale
        return np.concatenate([first, *parts[:-1]])

    def values(self, floor: float, after: float) -> Real:
        """Real eigenvalues above `floor` and below `after`, descending: the greatest, and those close to it."""
        if not self.products:
            return np.zeros(0)
        if not hasattr(self, "_basis"):
            most = min(self.order, STEPS)
            rng = np.random.default_rng(0)
            start = rng.normal(size=self.order) + 1j * rng.normal(size=self.order)
            self._basis = np.empty((most + 1, self.order), dtype=complex)
            self._h = np.zeros((most + 1, most), dtype=complex)
            self._basis[0], self._steps, self._look, self._done = start / np.linalg.norm(start), 0, 12, False
        while True:
            while not self._done and self._steps < self._look:
                self._step()
            k = self._steps
            theta, s = np.linalg.eig(self._h[:k, :k])
            left = np.abs(self._h[k, k - 1]) * np.abs(s[-1])
            size = np.abs(theta)
            real = (np.abs(theta.imag) <= NEAR * size) & (theta.real > floor) & (theta.real < after)
            least = max(floor, float(theta.real[real].max(initial=0.0)) * (1 - 1e-3))
            need = size + left >= least
            if self._done or (left <= TOLERANCE * size)[need].all():
                break
            self._look = int(1.3 * k) + 1
        found = np.sort(theta.real[real & need])[::-1]
        return np.asarray(found)

    def _step(self) -> None:
        k = self._steps
        Q = self._basis[: k + 1]
        w = self(Q[k])
        for _ in range(2):
            c = Q.conj() @ w
            w = w - c @ Q
            self._h[: k + 1, k] += c
        b = self._h[k + 1, k] = float(np.linalg.norm(w))
        self._done = k == len(self._h) - 2 or b < 1e-14 * np.abs(self._h[: k + 1, : k + 1]).max()
        self._basis[k + 1] = w / b if b else w
        self._steps += 1
