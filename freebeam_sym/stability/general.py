"""Problems of any damping: M(P) q̈ + C(P) q̇ + K(P) q = 0, each matrix a polynomial in the load, nothing symmetric.

As in `proportional`: where x = (v, iωv) is a state, the antisymmetric X = Im(x xᴴ) solves A X Bᵀ + B X Aᵀ = 0 with
A = [[0, 1], [−K, −C]] and B = diag(1, M), and some X ≠ 0 does so exactly where two eigenvalues add up to zero. In the
eigenvectors of a stable reference load P₀ the part without p = P − P₀ is a division by λᵢ + λⱼ, and the powers of p
are a companion matrix, so that Arnoldi's method finds 1/p (`_States`). Without damping, where it vanishes or is very
light, λᵢ + λⱼ is zero or nearly so; S = a aᵀ and Y = a bᵀ − b aᵀ of the motion v = a + iωb then solve

    K S Mᵀ − M S Kᵀ = 0,    K Y Mᵀ − M Y Kᵀ = D S Mᵀ + M S Dᵀ

with D the damping, or D = M where there is none: frequencies then meet (`_Vanishing`). Newton's method ends both.
Where neither is to be had (gyroscopic without damping; two modes of one frequency; M singular) the loads are scanned.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from contextlib import suppress
from copy import copy
from functools import cached_property

import numpy as np

from freebeam_sym.checks import InputError, Unstable
from freebeam_sym.massless import condensed, without_mass
from freebeam_sym.spectra import inverse
from freebeam_sym.stability.arnoldi import Krylov, events
from freebeam_sym.stability.crossings import MARGIN, scan
from freebeam_sym.stability.equations import ROUNDING, divergence, divergences, moved, newton, shifted, slope, value
from freebeam_sym.stability.problem import CLOSE, NEAR, Complex, Crossing, Event, Real

__all__ = ["General"]

Matrices = Sequence[Real]
LIGHT = 1e-4
"""Largest entry of C in the four lowest modes, relative to 2√(ωᵢωⱼ), below which Newton's method starts from the limit
of vanishing damping: flutters move by its square. Of `_States` eigenvalues are then off by rounding over its square."""
HIDDEN = 1e-7
"""The same of coordinates, below which a load that `_Vanishing` has not is refused: rounding hides where it is."""
LIGHTEST = 1e-6
"""The same below which growth is counted from the motions without damping."""
COUPLED = 1e-3
"""Geometric mean of what the damping does between two motions, relative to what is between their 1/λ, from which they
are taken together: beside, it moves their growth by its square."""
GROWTH = 1e-13
"""Re 1/λ, relative to the greatest |1/λ|, from which an eigenvalue grows: below is rounding."""
SPLIT = 1e-7
"""Relative. The same where eigenvalues stay on the axis: rounding splits two that meet by its root."""
STRICT = 1e-10
"""Damping ratio from which every mode must be damped at the reference load of `_States`: a point dashpot damps the
high modes by little (120 Hermite elements with a tip damper pass), rounding damps the low modes by 1e-15."""
NOTHING = 1e-13
"""Diagonal stiffness over mass, relative to the largest, up to which it is rounding: of a rotation that a control law
restores by way of another coordinate."""


class General:
    """The problem of matrices M, C, K, each a sequence of (n, n) arrays by powers of the load P.

    vanishing: C is the direction of a damping that vanishes, C = small × C. beside: of one that does, the rates that
    stay, as they turn motions, and what it adds to K, small × that; by powers of the load. Raises InputError where
    K is singular at every load, where something grows at the smallest loads, and of what stands beside where some
    motion has no mass.
    """

    def __init__(self, M: Matrices, C: Matrices, K: Matrices, vanishing: bool = False, *beside: Matrices) -> None:
        turning, held = beside or ((), ())
        given = [np.array([np.asarray(a, dtype=float) for a in X]) for X in (M, [*C, *turning, *held], K)]
        self._moving, self._follow, parts = condensed(*given)
        n = len(self._moving)
        size = np.abs(np.diagonal(parts[2], axis1=1, axis2=2)).sum(axis=0)
        mass = np.abs(np.diagonal(parts[0][0]))
        rates = np.divide(size, mass, out=np.full(n, np.inf), where=mass > 0)  # squared, so to say
        low = rates < NOTHING * rates[np.isfinite(rates)].max(initial=0.0)
        size = np.where(low | (size == 0), mass * np.min(rates, where=~low & (rates > 0), initial=1.0), size)
        self._scale = 1 / np.sqrt(np.where(size > 0, size, 1.0))
        self.M, rates, self.K = (X * np.outer(self._scale, self._scale) for X in parts)
        ends = [len(C), len(C) + len(turning)]
        self.C, self.turning, self.held = (X if len(X) else 0 * rates[:1] for X in np.split(rates, ends))
        self.size, self.vanishing, self.perturbed = n, vanishing, bool(self.turning.any() or self.held.any())
        if self.perturbed and without_mass(self.M[0]):
            raise InputError("a limit of vanishing damping: some motion has no mass; give small alpha and beta instead")
        self.damped = bool(np.any(self.C))
        self._damping: float = float(np.abs(self.C).max()) if self.damped else 1.0  # its size, so that light is as any

    def _at(self, P: float) -> tuple[Real, Real, Real]:
        return value(self.M, P), value(self.C, P), value(self.K, P)

    def _vector(self, v: Real | Complex, load: float) -> Complex:
        q = (value(self._follow, load) @ (self._scale * v)).astype(complex)
        return np.asarray(q / q[np.abs(q).argmax()])

    def _own(self, vector: Complex) -> Complex:
        """v of a crossing's vector."""
        return np.asarray(vector[self._moving] / self._scale)

    # --- divergence ------------------------------------------------------------------------------------------------

    @cached_property
    def _roots(self) -> tuple[float, Complex]:
        """A load at which K is regular, and all P with det K(P) = 0."""
        for base in (0.0, 0.01, 0.0371, 0.293):
            near = shifted(self.K, base)
            if np.linalg.cond(near[0]) < 1e13:
                break
        else:
            raise InputError("K is singular at every load: rigid motions that nothing restores must be left out")
        R, n = -np.linalg.solve(near[0], near[1:]), self.size
        if not (d := len(R)):
            return base, np.zeros(0, complex)
        companion = np.eye(n * d, k=-n)
        companion[:n] = np.concatenate(list(R), axis=1)
        mu = np.linalg.eigvals(companion).astype(complex)
        return base, base + 1 / mu[np.abs(mu) > 1e-10 * np.abs(mu).max()]  # the rest is rounding

    @cached_property
    def unit(self) -> float:
        """The least |P| with det K(P) = 0, P complex; infinite where there is none."""
        base, roots = self._roots  # K is singular at the load 0 if that is no base
        return float(np.abs(roots[np.abs(roots) > 1e-6 * base]).min(initial=np.inf))

    @cached_property
    def divergences(self) -> tuple[Event, ...]:
        """Where det K(P) = 0 for real P > 0, as of a pencil: ascending, to the first simple root."""
        P = self._roots[1]
        P = P[(np.abs(P.imag) <= CLOSE * P.real) & (P.real > 1e-7 * np.abs(P).min(initial=np.inf)) & (P.real > 1e-9)]
        return divergences(P[np.argsort(P.real)], self.K, self._vector)

    @cached_property
    def quiet(self) -> float:
        """The first divergence, below which nothing grows, where M and K are symmetric to rounding and positive, and
        rates turn motions or damp them (Thomson and Tait; Chetayev, The Stability of Motion, 1961); else 0."""
        damps = self.C + self.C.transpose(0, 2, 1)
        odd = ((X - X.transpose(0, 2, 1), X) for X in (self.M, self.K))
        none = (*odd, (self.M[1:], self.M), (damps[1:], self.C), (self.held, self.K))
        if any(np.abs(a).max(initial=0.0) > 1e-13 * np.abs(X).max() for a, X in none):
            return 0.0
        first = min((event.crossing.load for event in self.divergences), default=math.inf)
        stiff = (value(self.K, P) for P in (min(self.unit, 1.0) / 2, min(first, 1e6) * (1 - 1e-6)))
        *positive, least = (np.linalg.eigvalsh(X)[0] for X in (self.M[0], *stiff, damps[0]))
        return first if min(positive) > 0 and least >= -1e-13 * np.abs(self.C).max() else 0.0

    # --- counts ----------------------------------------------------------------------------------------------------

    def inverse(self, P: float, light: bool = False) -> Real:
        """As `of_states`, the low eigenvalues to their own digits. light: without C, but with the rates that stay.

        Of light damping it is nearly skew where F = Gᵀ: rounding is then that of a normal matrix.
        """
        M, C, K = self._at(P)
        return of_states(value(self.turning, P) if light else C, K, *halves(M))

    def branches(self, P: float) -> tuple[Complex, Complex, Real]:
        """λ without damping, the motions as columns, and by how much each 1/λ grows with it, as `_grow` says:
        infinite where K lets it, or where damping is absent or vanishes and frequencies have met. Without mass 1/λ = 0.
        Of ±λ one is left, unless rates turn motions. Raises InputError where rounding hides what is one."""
        (M, _, K), both = self._at(P), self.perturbed
        z, V = (X.astype(complex) for X in (np.linalg.eig(self.inverse(P, True)) if both else motions(M, K)))
        z = -1j * z if both else z  # 1/(iλ), else 1/ω²
        rounding = np.linalg.norm(inverse(V), axis=1) * np.linalg.norm(V, axis=0)
        off = np.greater(grown(np.abs(z.imag) + 1j * z.real, SPLIT, rounding), 0)
        theta = 1j * (z if both else np.sqrt(z))
        out = (z.real < 0) & (not both) | off & (self.vanishing or not self.damped)
        v, growth = V[: self.size], np.zeros(len(z))
        if self.damped or both:
            order = np.argsort(np.where(out, np.inf, z.real))[: np.count_nonzero(~out)]
            v, growth = self._grow(P, z, theta, V, off, order.tolist())
        with np.errstate(divide="ignore", invalid="ignore"):
            rate: Complex = np.asarray(np.where(theta == 0, complex(0, math.inf), 1 / theta))
        return rate, v, np.where(out, np.where(both & (z.imag > 0), 0.0, np.inf), growth)

    def _grow(self, P: float, z: Complex, theta: Complex, V: Complex, off: Real, on: list[int]) -> tuple[Complex, Real]:
        """The motions, and by how much each 1/λ grows, relative to the terms of this, to first order in the damping;
        those are taken together which it couples by more than a share COUPLED of what is between their frequencies, or
        whose frequencies are one but for rounding (Kato 1966, chapter 2). off: what has met. on: those asked of."""
        (_, D, K), both, most = self._at(P), self.perturbed, np.abs(z).max()
        v, N, L = V[: self.size], value(self.held, P), np.linalg.inv(V)[:, : self.size] @ np.linalg.inv(K)
        L = L if both else L / 2
        B = -L @ (D @ v + theta * (N @ v))
        terms = np.einsum("ij,ji->i", np.abs(L), np.abs(D) @ np.abs(v) + np.abs(theta) * (np.abs(N) @ np.abs(v)))
        own = np.where(off, theta, 1j * theta.imag) * (not self.vanishing)
        least = np.clip(SPLIT * np.abs(z[on]), GROWTH * most, 100 * GROWTH * most)
        close = np.abs(np.subtract.outer(z[on], z[on])) <= least
        if not self.vanishing:
            gap = np.subtract.outer(own[on], own[on])
            close |= np.abs((B * B.T)[np.ix_(on, on)]) > COUPLED**2 * np.abs(gap) ** 2
        places, growth = np.arange(len(on)), (own + B.diagonal()).real
        ends = np.maximum.accumulate((close * places).max(axis=1, initial=0))
        for one in np.split(on, 1 + np.flatnonzero(ends <= places)):
            if len(one) > 1:
                values, shapes = np.linalg.eig(np.diag(own[one] - own[one].mean()) + B[np.ix_(one, one)])
                values, terms[one] = values.real + own[one].mean().real, terms[one].max()
                grow = [(x > 10 * NOTHING * terms[one]).sum() for x in (values, growth[one])]
                if self.vanishing and grow[0] != grow[1] and np.ptp(z[one].real) > GROWTH * most:
                    raise InputError(
                        f"two frequencies near {abs(1 / theta[one[0]]):.6g} at the load {P:.6g} are one but for "
                        "rounding: what a vanishing damping does to them is not told; give small alpha and beta"
                    )
                growth[one], v[:, one] = values, v[:, one] @ shapes
        return v, np.divide(growth, terms, out=np.zeros(len(z)), where=terms > 0)

    def _bad(self, P: float) -> tuple[Complex, Complex, Real]:
        """λ, the motions and by how much each grows, positive where it does."""
        light, threshold = self.manner
        if light:
            return self.branches(P)
        theta, V = np.linalg.eig(self.inverse(P))
        with np.errstate(divide="ignore", invalid="ignore"):
            rate: Complex = np.asarray(1 / theta.astype(complex), dtype=complex)
        with np.errstate(over="ignore"):  # of λ = ∞, without mass and damper; near another it has no bound
            rounding = np.linalg.norm(inverse(V), axis=1) * np.linalg.norm(V, axis=0) if threshold else np.inf
        return rate, V[: self.size].astype(complex), grown(np.asarray(theta, complex), threshold, rounding)

    @property
    def manner(self) -> tuple[bool, float]:
        """How growth is counted: whether from the motions without damping, and by how much else an eigenvalue must
        grow: by SPLIT, but for those known better, where some stay on the axis though C is not zero."""
        light = not self.damped or self.vanishing or getattr(self._operator, "ratio", 1.0) < LIGHTEST
        return light, 0.0 if light or self._operator is not None else SPLIT

    def unstable(self, load: float, manner: tuple[bool, float] | None = None) -> int:
        """manner: that of a problem of the same damping, or nearly so, which saves the work to find it."""
        if load < self.quiet:
            return 0
        light, threshold = manner or self.manner
        try:
            if light or threshold:
                growth = (self.branches if light else self._bad)(load)[2]
            else:
                growth = grown(np.asarray(np.linalg.eigvals(self.inverse(load)), complex), 0.0)
            return int((growth > (10 * NOTHING if light else 0)).sum())
        except np.linalg.LinAlgError:  # K singular to the last digit: λ = 0
            return 1

    def onset(self, load: float) -> Crossing:
        at = next((e.crossing for e in self.divergences if abs(e.crossing.load / load - 1) < NEAR), None)
        try:  # at λ = 0 rounding grows too: what does is told just above
            rate, V, growth = self._bad(load * (1 + 2 * NEAR) if at else load)
        except np.linalg.LinAlgError:
            return divergence(load, self.K, self._vector, steps=3)[0]
        worst = int(np.argmax(growth))
        v = V[:, worst].conj() if rate[worst].imag < 0 else V[:, worst]  # of λ = iω: a whirl's is not its conjugate's
        omega, v = abs(float(rate[worst].imag)), self._vector(v, load)
        slow = at is not None and self.perturbed and omega < 1e-4 * np.abs(rate).max()
        if slow or omega < 1e-6 * np.abs(rate).min() or omega == 0:
            return at or Crossing(load, 0.0, v, "divergence")
        guess = Crossing(load, omega, v, "flutter")
        found = self.near(guess)
        # not far off frequencies may pass one another, where Newton's method settles too, but on no digits
        off = math.inf if found is None else abs(found.load / load - 1)
        return guess if found is None or off > (NEAR if self.rounding(found) > NEAR else 1e-3) else found

    def near(self, guess: Crossing) -> Crossing | None:
        """The flutter that Newton's method finds from a guess; None where there is none. The motion of a guess of
        another number of functions is found again, by inverse iteration."""
        if self.perturbed:
            return self._followed(guess.load, guess.frequency)
        omega, P, v = guess.frequency, guess.load, np.ones(self.size, complex)
        if len(guess.vector) == self._follow.shape[1]:
            v = self._own(guess.vector)
        else:
            M, C, K = self._at(P)
            for _ in range(2):
                v = np.linalg.solve(K + (0 if self.vanishing else 1j) * omega * C - omega**2 * M, v)
                v /= np.linalg.norm(v)
        found = self._newton(omega**2, P, *self._parts(v, omega))
        return found if found is not None and found.frequency > 0 else None

    def followed(self, guess: Crossing, within: float, manner: tuple[bool, float] | None) -> Crossing | None:
        """The crossing that one of a neighbouring problem goes over into, its load off by a share `within` at most;
        None where there is none, or something grows just below it. manner: as of `unstable`."""
        if guess.kind == "divergence":
            found = next((event.crossing for event in self.divergences if event.simple), None)
        else:
            found = self.near(guess) if guess.frequency > 0 else None
        if found is None or not abs(found.load / guess.load - 1) < within:
            return None
        return None if self.unstable(found.load * (1 - MARGIN), manner) else found

    # --- flutter ---------------------------------------------------------------------------------------------------

    @cached_property
    def _operator(self) -> _States | _Vanishing | None:
        """At the load 0, else at one below which nothing crosses the axis; None where neither form is had."""
        unit = self.unit if math.isfinite(self.unit) else 1.0
        # of a pipe each undamped motion is an eigenvalue at 0, farther than the first loss from most of its way to it
        grows = (P for P in unit * np.geomspace(0.02, 20, 48) if self.unstable(float(P), (False, 0.0)))
        for f in () if self.perturbed else (0.0, math.nan, 0.1, 0.0271, 0.00713):
            P = 0.8 * float(next(grows, unit / 8)) if math.isnan(f) else unit * f
            if (operator := self._made(P, unit)) is None:
                continue
            back = Krylov(lambda z, of=operator: -of(z), operator.order)  # type: ignore[misc]
            mu = back.values(unit / P * (1 + 1e-3), math.inf)[0] if P else np.zeros(0)
            if not (np.abs(mu.imag) <= NEAR * mu.real).any():
                return operator
        return None

    def _made(self, P: float, unit: float) -> _States | _Vanishing | None:
        stays = self.damped and not self.vanishing
        with suppress(np.linalg.LinAlgError):
            return _Vanishing(self, P, unit, LIGHT if stays else math.inf)
        mass = np.diagonal(self.M[0])[low := np.argsort(-np.diagonal(self.M[0]))[:4]]
        with np.errstate(all="ignore"):  # rates that turn, C = −Cᵀ, damp nothing; no more does what has no mass here
            ratio = (np.abs(np.diagonal(self.C, axis1=1, axis2=2)).sum(axis=0)[low] / np.sqrt(mass)).max() / 2
        if stays and 0 < ratio < HIDDEN:
            raise InputError(
                f"damping ratio {ratio:.1e} of the low modes: is lost in rounding where rates turn motions or two have "
                "one frequency; give a larger damping of the same kind, by whose size the load hardly changes"
            )
        with suppress(np.linalg.LinAlgError):
            return _States(self, P, unit) if stays else None
        return None

    def flutters(self, bound: float) -> Iterator[Event]:
        """Raises Unstable where something grows at the smallest loads."""
        if bound <= self.quiet * (1 + NEAR):
            return iter(())
        operator = self._operator
        low = min(1e-4 * bound, math.inf if operator is None else operator.P / 2)
        if low and self.unstable(low) and self.unstable(low / 8):
            raise Unstable("something grows at the smallest loads: there is no first loss of stability")
        if operator is None:
            found = scan(self, 0.0, bound * (1 - NEAR))
            return iter((Event(found, True),) if found is not None and found.kind == "flutter" else ())
        if bound <= operator.P:
            return iter(())
        floor = (1 - NEAR) * operator.unit / (bound - operator.P)
        krylov, base, unit = Krylov(operator, operator.order), operator.P, operator.unit
        return events(krylov, floor, operator.flutter, lambda mu: base + unit / mu, self._follow.shape[1])

    @staticmethod
    def _parts(v: Complex, omega: float) -> tuple[Real, Real]:
        """a and b of a motion v = a + iωb, turned so that a is the greater."""
        v = v * np.exp(-0.5j * np.angle(v @ v)) / math.sqrt(abs(v @ v.conj()))
        return v.real.copy(), v.imag / omega

    def _newton(self, w: float, P: float, a: Real, b: Real, share: float = 1.0) -> Crossing | None:
        """The flutter near (ω² = w, P, v = a + iω share b), of negative frequency where ω² < 0; None where there is
        none. Without damping, and where it vanishes, v = a. share: of the damping, that is taken."""
        damping, size = (self.C / self._damping, share * self._damping) if self.damped else (self.M, 0.0)
        size = 0.0 if self.vanishing else size
        root = newton(self.M, damping, self.K, size, w, P, a, b / self._damping, abs(w))
        return None if root is None else Crossing(root[1], root[0], self._vector(root[2], root[1]), "flutter")

    def _followed(self, P: float, omega: float) -> Crossing | None:
        """Where a motion of a frequency near ω begins to grow to first order, by the secant method."""
        v, before, load = np.zeros(self.size, complex), math.nan, math.nan
        for _ in range(20):  # the last steps are rounding
            rate, V, growth = self.branches(P)
            close = np.flatnonzero(np.isfinite(growth) & (np.abs(rate - 1j * omega) < 0.1 * omega))
            if not len(close):
                return None
            V = V[:, close] / np.linalg.norm(V[:, close], axis=0)
            k = int(np.argmax(np.abs(v.conj() @ V)) if v.any() else np.argmin(np.abs(growth[close])))
            v, omega, grows = V[:, k], float(rate[close[k]].imag), float(growth[close[k]])
            step = 1e-7 * P if math.isnan(before) else -grows * (P - load) / (grows - before or math.inf)
            if abs(step) <= 4e-16 * P:
                break
            before, load, P = grows, P, P + step
        return Crossing(P, omega, self._vector(v, P), "flutter")

    def rounding(self, crossing: Crossing) -> float:
        """By how much a crossing's load may be off, relative, for the rounding of the matrices, to first order."""
        P, omega = crossing.load, crossing.frequency
        if self.perturbed and omega:  # by changes of all entries in their last digits
            size, most = self.size**2, 0.0
            for k in range(4):
                changed, last = copy(self), 1 + 2 * ROUNDING * np.cos(k * np.arange(1.0, size + 1))
                for name in ("M", "C", "K", "turning", "held"):
                    setattr(changed, name, getattr(self, name) * last.reshape(self.size, -1))
                found = changed._followed(P, omega)
                most = max(most, 1.0 if found is None else abs(found.load / P - 1))
            return min(2 * most + ROUNDING, 1.0)
        (M, C, K), (dM, dC, dK) = self._at(P), (value(slope(X), P) for X in (self.M, self.C, self.K))
        rate = 0.0 if self.vanishing else 1j
        G, G_P = K + rate * omega * C - omega**2 * M, dK + rate * omega * dC - omega**2 * dM
        G_omega = rate * C - 2 * omega * M if omega and self.damped and not self.vanishing else None
        # entry by entry: the norm of K is 100 times what rounding does to the low motions of 20 segments
        parts = ((2, self.M), (1, self.C), (0, self.K))
        inertia, rates, change = (ROUNDING * omega**j * value(np.abs(X), P) for j, X in parts)
        gyroscopic = self.damped and np.abs(C + C.T).max() <= ROUNDING * np.abs(C).max()
        if gyroscopic:  # frequencies may meet, and did where they are apart by SPLIT
            v = self._own(crossing.vector)
            change = change + (SPLIT * omega) ** 2 * np.linalg.norm(M @ v) / np.linalg.norm(v)
        return min(moved(G, G_P, G_omega, change + inertia, NEAR * gyroscopic, rates) / P, 1.0)


class _States:
    """z = (X₁ … X_d), X_k = p X_{k+1}, to (−L₀⁻¹(L₁X₁ + … + L_d X_d), X₁, …): eigenvalues are unit/(P − P₀).

    Any damping: X antisymmetric, (2n, 2n), in the eigenvectors at P₀, real: Re, Im of each pair, then real ones."""

    def __init__(self, problem: General, P: float, unit: float) -> None:
        self.problem, self.P, self.unit = problem, P, unit
        n = problem.size
        theta, V = np.linalg.eig(problem.inverse(P))
        if not (theta.real < -STRICT * np.abs(theta)).all() or np.linalg.cond(problem._at(P)[0]) > 1e13:
            raise np.linalg.LinAlgError("not strictly stable")
        up, real = np.flatnonzero(theta.imag > 0), np.flatnonzero(theta.imag == 0)
        self.k = k = len(up)
        lam = 1 / np.concatenate([theta[up], theta[real]])
        V = V[:, np.concatenate([up, real])]
        V = np.concatenate([V[:n], lam * V[:n]])  # (v, λv)
        V = V / np.sqrt(np.abs((V[:n].conj() * (problem._at(P)[0] @ V[:n])).sum(axis=0)))
        self.V = np.concatenate([V[:, :k].real, V[:, :k].imag, V[:, k:].real], axis=1)
        M, C, K = (shifted(X, P, unit) for X in (problem.M, problem.C, problem.K))
        W = np.linalg.inv(np.concatenate([self.V[:n], M[0] @ self.V[n:]]))
        self.A, self.B = [], []
        for j in range(max(len(M), len(C), len(K))):
            a = np.zeros((2 * n, 2 * n)) if j else np.eye(2 * n, 2 * n, n)
            for X, part in ((K, slice(n)), (C, slice(n, None))):
                a[n:, part] = -X[j] if j < len(X) else 0
            self.A.append(W @ a @ self.V)
            self.B.append(W[:, n:] @ M[j] @ self.V[n:] if 0 < j < len(M) else None)
        moving = max((j for j, b in enumerate(self.B) if b is not None and np.any(b)), default=0)
        self.degree = max(1, len(self.A) - 1 + moving)
        sums = lam[:, None] + lam
        self.uu, self.uv = 0.5 / sums[:k, :k], 0.5 / (lam[:k, None] + lam[:k].conj())
        self.ur, self.rr = 1 / sums[:k, k:], 1 / sums[k:, k:].real
        size = np.abs(np.concatenate([lam[:k], lam[:k], lam[k:]]))
        self.pairs = np.triu_indices(2 * n, 1)
        self.scale = size[self.pairs[0]] * size[self.pairs[1]]
        self.order = self.degree * len(self.scale)

    def _unpacked(self, z: Real) -> Real:
        Y = np.zeros(self.V.shape)
        Y[self.pairs] = z / self.scale
        return np.asarray(Y - Y.T)

    def _divided(self, R: Real) -> Real:
        """Y with Λ Y + Y Λᵀ = R."""
        k, Y = self.k, np.empty_like(R)
        a = R[:k] - 1j * R[k : 2 * k]
        uu = (a[:, :k] - 1j * a[:, k : 2 * k]) * self.uu
        uv = (a[:, :k] + 1j * a[:, k : 2 * k]) * self.uv
        ur, first, second = a[:, 2 * k :] * self.ur, uu + uv, 1j * (uu - uv)
        Y[:k] = np.concatenate([first.real, second.real, ur.real], axis=1)
        Y[k : 2 * k] = -np.concatenate([first.imag, second.imag, ur.imag], axis=1)
        Y[2 * k :, : 2 * k] = -Y[: 2 * k, 2 * k :].T
        Y[2 * k :, 2 * k :] = R[2 * k :, 2 * k :] * self.rr
        return Y

    def __call__(self, z: Real) -> Real:
        parts = z.reshape(self.degree, -1)
        Z = np.zeros(self.V.shape)
        for j, part in enumerate(parts, 1):
            Y = self._unpacked(part)
            if j < len(self.A):
                Z += self.A[j] @ Y
            for i, B in enumerate(self.B):
                if B is not None and 0 <= j - i < len(self.A):
                    Z += self.A[j - i] @ Y @ B.T
        new = self._divided(Z.T - Z)[self.pairs] * self.scale
        return np.concatenate([new, *parts[:-1]])

    def flutter(self, mu: float, z: Real) -> Crossing | None:
        X = self.V @ self._unpacked(z.reshape(self.degree, -1)[0]) @ self.V.T
        n = self.problem.size
        sizes, vectors = np.linalg.eigh(X[:n, n:] + X[:n, n:].T)
        top = int(np.abs(sizes).argmax())
        a = vectors[:, top]
        b, load = -2 * (X[:n, :n] @ a) / sizes[top], self.P + self.unit / mu
        M, C, K = self.problem._at(load)
        found = self.problem._newton(float(a @ (K @ a)) / float(a @ (M @ a + C @ b)), load, a, b)
        return found if found is not None and abs(found.load / load - 1) < CLOSE else None


class _Vanishing:
    """The same of damping that is absent, vanishes, or is light: X = S + Y, symmetric and antisymmetric, (n, n), in the
    modes at P₀."""

    def __init__(self, problem: General, P: float, unit: float, light: float = math.inf) -> None:
        self.problem, self.P, self.unit = problem, P, unit
        M, K = shifted(problem.M, P, unit), shifted(problem.K, P, unit)
        D = shifted(problem.C / problem._damping if problem.damped else problem.M, P, unit)
        inverse, V = motions(M[0], K[0])
        if np.iscomplexobj(inverse) or not (inverse > 0).all():
            raise np.linalg.LinAlgError("not stable")
        order = np.argsort(-inverse)
        e, V = 1 / inverse[order], V[:, order]
        V = V / np.sqrt(np.abs((V * (M[0] @ V)).sum(axis=0)))
        W = np.linalg.inv(M[0] @ V)
        self.V, self.M, self.D, self.K = V, W @ M @ V, W @ D @ V, W @ K @ V
        root = np.sqrt(np.sqrt(e))
        # of all powers of the load: the damping of a pipe by its flow is nothing at load 0 alone; of the low modes,
        # which decide: internal damping may be heavy for the highest where theirs is lost in the rounding of `_States`
        self.ratio = float(np.abs(self.D / np.outer(root, root))[:, :4, :4].max()) * problem._damping / 2
        if self.ratio > light or np.linalg.cond(M[0]) > 1e13:
            raise np.linalg.LinAlgError("not light")
        gap = e[:, None] - e
        close = np.triu(-gap < 2 * NEAR * e, 1)  # of these two T is nearly infinite
        if not P and light == math.inf and close.any():  # to first order: (gap + p slope)² < p² both²
            change = (value(self.K, NEAR) - value(self.M, NEAR) * e) / NEAR
            slope, both = (d := np.diagonal(change)) - d[:, None], 2 * np.sqrt(np.maximum(-change * change.T, 0))
            meets = both - np.where(-gap < 10 * GROWTH * e, np.abs(slope), slope)
            for i, j in np.argwhere(close & (meets > SPLIT * e) & (both > SPLIT * e))[:1]:
                raise Unstable(
                    f"two frequencies near {e[i] ** 0.5:.6g} are almost one without load, and grow near the load "
                    f"{-gap[i, j] / meets[i, j] * unit:.2g}: rounding hides where; critical --all proves it"
                )
        own = np.diagonal(self.D[0])
        if not (own > 1e-12 * np.abs(self.D[0]).max()).all() or close.any():
            raise np.linalg.LinAlgError("a mode is not damped, or two have one frequency")
        np.fill_diagonal(gap, 1.0)
        self.own, self.over = own, (1 - np.eye(len(e))) / gap
        self.degree = max(1, max(len(self.K), len(self.D)) - 1 + len(self.M) - 1)
        self.scale = np.sqrt(np.outer(e, e))
        self.order = self.degree * self.scale.size

    def _unpacked(self, z: Real) -> tuple[Real, Real]:
        X = z.reshape(self.V.shape) / self.scale
        return (X + X.T) / 2, (X - X.T) / 2

    def __call__(self, z: Real) -> Real:
        parts = z.reshape(self.degree, -1)
        first, second = np.zeros(self.V.shape), np.zeros(self.V.shape)
        for power, part in enumerate(parts, 1):
            S, Y = self._unpacked(part)
            for j in range(min(power, len(self.M) - 1) + 1):
                i, Mt = power - j, self.M[j].T
                if i < len(self.K):
                    second += self.K[i] @ S @ Mt
                    first += self.K[i] @ Y @ Mt
                if i < len(self.D):
                    first -= self.D[i] @ S @ Mt
        first, second = -(first + first.T), second.T - second
        S = second * self.over
        DS = self.D[0] @ S
        np.fill_diagonal(S, -(np.diagonal(first) / 2 + np.diagonal(DS)) / self.own)
        DS = self.D[0] @ S
        Y = (first + DS + DS.T) * self.over
        return np.concatenate([((S + Y) * self.scale).ravel(), *parts[:-1]])

    def flutter(self, mu: float, z: Real) -> Crossing | None:
        S, Y = (self.V @ X @ self.V.T for X in self._unpacked(z.reshape(self.degree, -1)[0]))
        sizes, vectors = np.linalg.eigh(S)
        top = int(np.abs(sizes).argmax())
        a = vectors[:, top]
        return self._grown(self.P + self.unit / mu, a, -self.problem._damping * (Y @ a) / sizes[top])

    def _grown(self, P: float, a: Real, b: Real) -> Crossing | None:
        """The crossing that the one of a damping that vanishes, near P with the motion a + iωb, goes over into as the
        damping grows to what it is, by its square; of negative frequency where it does not, as where two of them meet
        and are gone."""
        problem, square, step = self.problem, 0.0, 1.0
        M, _, K = problem._at(P)
        found = problem._newton(float(a @ (K @ a)) / float(a @ (M @ a)), P, a, b, 0.0)
        if found is None or abs(found.load / P - 1) > CLOSE:
            return None
        if not problem.damped or problem.vanishing:
            return found
        none = Crossing(P, -1.0, found.vector, "flutter")
        while square < 1 and step > max(1e-12, 1e-3 * square) and found.frequency > 0:
            share = math.sqrt(min(square + step, 1.0))
            further = problem._newton(found.frequency**2, found.load, a, b, share)
            if further is None or abs(further.load / found.load - 1) > 0.01:
                step /= 4
            else:
                found, square, step = further, share**2, 2 * step
                a, b = problem._parts(problem._own(found.vector), found.frequency)
                b = b / share
        return found if square == 1 else none


def halves(M: Real) -> tuple[Real, Real]:
    """G and F, M = GF; F = Gᵀ where M is symmetric and no motion is without mass."""
    with suppress(np.linalg.LinAlgError):
        if np.array_equal(M, M.T):
            return np.asarray(G := np.linalg.cholesky(M)), np.asarray(G.T)
    return M, np.eye(len(M))


def motions(M: Real, K: Real) -> tuple[Real, Real]:
    """1/ω² and the motions as columns, of no damping; rounding of K⁻¹M would split the highest of a short segment."""
    G, F = halves(M)
    z, V = np.linalg.eig(F @ np.linalg.solve(K, G))
    return z, np.linalg.solve(F, V)


def of_states(C: Real, K: Real, G: Real, F: Real) -> Real:
    """Inverse of the state matrix, (2n, 2n), of M = GF, C and K: its eigenvalues are 1/λ. A state is (q, λFq)."""
    return np.vstack([-np.linalg.solve(K, np.hstack([C, G])), np.hstack([F, 0 * F])])


def grown(theta: Complex, threshold: float, rounding: Real | float = np.inf) -> Real:
    """Re 1/λ by 1/λ, 0 where it is rounding or below: a share `threshold` of 1/λ, or less where `rounding` is."""
    least = GROWTH * np.abs(theta).max()
    with np.errstate(invalid="ignore"):
        limit = np.maximum(np.minimum(threshold * np.abs(theta), least * rounding), least)
    return np.asarray(np.where(theta.real > limit, theta.real, 0.0))
