"""Undamped branches s_j(P) up to the first loss of stability, and what they prove of damped ones.

By section 4's pencil, λ = iω is an eigenvalue at the load P exactly where a branch at the complex load
p = P/(1 + iτ), τ = αω, has (1 + iτ) s_j(p) = ω² − iβω. Its imaginary part over −τ reads K_j(P, τ) = κ = β/α, with

    K_j(P, τ) = P s_j′ − s_j − τ² (P² s_j″/2 + P³ s_j‴/6) + O(τ⁴)

the tangent rule and its correction. Round each rung P_m of the ladder every branch has a disc of complex loads in
which it provably stays apart from all others (`Rungs.radius`), so that Cauchy's inequality bounds all that a
truncated series leaves out. Where K_j < κ for all branches and loads, nothing crosses: `Ladder.clear`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, fields
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from freebeam_sym.pencil import Complex, Crossing, Damping, Pencil, Real, inverse, newton

__all__ = ["Ladder", "bezier", "bezier_root"]

Start = tuple[float, float, Real, Real]
"""ω², P, a, b of `newton`."""

_POWER = np.arange(6.0)


@dataclass(frozen=True)
class Rungs:
    """Branches at m loads, all squared frequencies s real and positive.

    `s` (m, N) ascending; `V` right vectors in columns, `U` left ones in rows, U V = I; `first`, `second`, `third`
    are Taylor's coefficients s′, s″/2, s‴/6; |s_j(p) − s_j − s_j′ (p − P)| < `room` for |p − P| < `radius`, where s_j
    stays a simple eigenvalue.
    """

    load: Real
    s: Real
    V: Real
    U: Real
    first: Real
    second: Real
    third: Real
    room: Real
    radius: Real

    @staticmethod
    def at(pencil: Pencil, load: Real) -> tuple[Rungs, float]:
        """The rungs below the first of these ascending loads that has none, and that load (inf: all have)."""
        i = np.arange(pencil.size)
        s, V = np.linalg.eig(np.diag(pencil.e) + load[:, None, None] * pencil.H)
        steady = ((s.imag == 0) & (s.real > 0)).all(axis=1)
        m = len(load) if steady.all() else int(steady.argmin())
        wall = math.inf if m == len(load) else float(load[m])
        load, s, V = load[:m], s[:m].real, V[:m].real
        order = s.argsort(axis=1)
        s, V = np.take_along_axis(s, order, 1), np.take_along_axis(V, order[:, None, :], 2)
        U = inverse(V)
        G = U @ pencil.H @ V
        first = G[:, i, i]
        gap = s[:, :, None] - s[:, None, :]
        gap[:, i, i] = np.inf
        tiny = 1e-150  # where branches touch: no disc, and no overflow
        share = 1 / np.where(gap == 0, tiny, gap)
        left, right = G * share, np.swapaxes(G, 1, 2) * share
        second = (left * np.swapaxes(G, 1, 2)).sum(axis=2)
        third = ((left @ G) * right).sum(axis=2) - first * (left * right).sum(axis=2)
        # |z − s_j| = room meets no eigenvalue of diag(s) + x (G − s_j′) while |x| B_j diag(1/d_j) has spectral radius
        # below 1, B_j = |G − s_j′|, d_j the distances from the circle; Collatz's bound of that radius, for all j at
        # once in the last axis
        size = np.abs(gap)
        room = size.min(axis=2) / 2
        d = np.maximum(np.swapaxes(size, 1, 2) - room[:, None, :], tiny)
        d[:, i, i] = np.maximum(room, tiny)
        off = np.abs(G)
        off[:, i, i] = 0.0
        diagonal = np.abs(first[:, :, None] - first[:, None, :])
        x = np.ones_like(d)
        for _ in range(4):
            y = x / d
            y = off @ y + diagonal * y
            bound = (y / x).max(axis=1, keepdims=True)
            x = y + bound / 2 * x
        bound = bound[:, 0, :]
        return Rungs(load, s, V, U, first, second, third, room, 1 / np.maximum(bound, tiny)), wall

    def join(self, other: Rungs) -> Rungs:
        """Both, in the order of their loads."""
        order = np.argsort(np.concatenate([self.load, other.load]))
        pairs = [(getattr(self, f.name), getattr(other, f.name)) for f in fields(self)]
        return Rungs(*(np.concatenate(pair)[order] for pair in pairs))

    def below(self, load: float) -> Rungs:
        """Those whose load is less."""
        count = int(np.searchsorted(self.load, load))
        return Rungs(*(getattr(self, f.name)[:count] for f in fields(self)))


def ladder_of(pencil: Pencil) -> Ladder:
    """The ladder of a pencil, made once."""
    if Ladder not in pencil.kept:
        pencil.kept[Ladder] = Ladder(pencil)
    found: Ladder = pencil.kept[Ladder]
    return found


class Ladder:
    """Rungs from load 0 up to the first loss of stability of the undamped column.

    `fold`: where two branches first meet, by `newton`; None where it was not found. `proven`: load up to which all
    squared frequencies are known to be real, positive and distinct, between the rungs too.
    """

    def __init__(self, pencil: Pencil) -> None:
        self.pencil = pencil
        self.fold: Start | None = None
        loads, wall = self._climb()
        rungs, found = Rungs.at(pencil, loads)
        wall, refined = min(wall, found), 0
        for _ in range(24):
            P, top = rungs.load, len(rungs.load) - 1
            new = np.empty(0)
            if self.fold is None and P[-1] < wall * (1 - 1e-9) < math.inf:
                self.fold = self._meeting(rungs, top, wall)
                if self.fold is not None:
                    rungs = rungs.below(self.fold[1] * (1 - 1e-9))
                    new = _halving(rungs.load[-1], self.fold[1])
                else:
                    new = np.linspace(P[-1], wall, 6)[1:-1]
            elif refined < 2:
                refined += 1
                new = _between(rungs)
                new = new[: 80 if len(new) <= 80 else 0]
            if not len(new) and (gaps := _uncovered(rungs))[0] < top:
                # two branches may meet and part again in a gap between the discs
                k, reach = int(gaps[0]), rungs.radius.min(axis=1)
                fold = self._meeting(rungs, k, float(P[k + 1]))
                if fold is not None:
                    self.fold, rungs, new = fold, rungs.below(float(P[k + 1])), _halving(P[k], fold[1])
                else:
                    a, b = P[gaps[:-1]] + 0.9 * reach[gaps[:-1]], P[gaps[:-1] + 1] - 0.9 * reach[gaps[:-1] + 1]
                    new = np.sort(np.concatenate([np.minimum(a, b), np.maximum(a, b)]))
            elif not len(new) and self.fold is not None and not self._alone(rungs):
                new = _halving(P[-1], self.fold[1])[:3] if self.fold[1] - P[-1] > 1e-9 * P[-1] else new
            if len(new) and len(rungs.load) < 300:
                more, found = Rungs.at(pencil, new)
                rungs = rungs.join(more)
                if found < math.inf:
                    rungs, self.fold, wall = rungs.below(found), None, found
            elif refined >= 2:
                break
        self.rungs = rungs
        self.proven = self._proven()
        # the other branches' discs reach past the fold by `_apart`: from `_fold_rung` on the pair that meets is alone
        self._fold_rung, self._apart = len(rungs.load), 0.0
        if self.fold is not None and self.proven >= self.fold[1]:
            j, _, _ = _ahead(rungs, -1)
            reach = rungs.load + np.delete(rungs.radius, [j, j + 1], axis=1).min(axis=1, initial=np.inf)
            self._apart = min(float(reach.max()) - self.fold[1], self.fold[1])
            self._fold_rung = max(1, int(np.searchsorted(rungs.load, self.fold[1] - 0.05 * self._apart)))

    def _steady(self, loads: Real, wall: float) -> tuple[Real, float]:
        """The loads before the first at which a squared frequency is not real and positive, and that load or `wall`."""
        s = np.linalg.eigvals(np.diag(self.pencil.e) + loads[:, None, None] * self.pencil.H)
        bad = ((s.imag != 0) | (s.real <= 0)).any(axis=1)
        return (loads[: bad.argmax()], float(loads[bad.argmax()])) if bad.any() else (loads, wall)

    def _climb(self) -> tuple[Real, float]:
        """Loads 0 … while all squared frequencies are real and positive, and the first one that was not so."""
        divergence = self.pencil.divergence_loads
        end = float(divergence[0]) * (1 - 1e-4) if len(divergence) else math.inf
        loads, wall, step = np.zeros(1), math.inf, 0.3 / self.pencil.norm
        while wall == math.inf and step < 1e9 and loads[-1] < end:
            more = np.minimum(step * 1.5 ** np.arange(6), end)
            steady, wall = self._steady(more[: int((more < end).sum()) + 1], wall)
            loads, step = np.append(loads, steady), step * 1.5**6
        return loads, wall

    def _meeting(self, rungs: Rungs, k: int, wall: float) -> Start | None:
        """(ω², P, a, b) of the first coalescence between rung k and `wall`, by Newton's method from there."""
        j, ahead, _ = _ahead(rungs, k)
        load, s, V = float(rungs.load[k]), rungs.s[k], rungs.V[k]
        if not math.isfinite(ahead):
            return None
        v, u = V[:, j], V[:, j + 1]
        u = u if v @ u > 0 else -u
        start = float(s[j] + s[j + 1]) / 2, load + ahead, v + u, -2 * (v - u) / (s[j + 1] - s[j])
        found = newton(self.pencil, Damping.of(self.pencil.e, 0.0, 0.0, None), *start)
        return (
            found if found is not None and found[0] > 0 and load * (1 - 1e-9) < found[1] <= wall * (1 + 1e-9) else None
        )

    def _alone(self, rungs: Rungs) -> bool:
        """Whether from the last rung the discs of the others reach past the fold, and the two that meet do so as two
        alone would."""
        assert self.fold is not None
        j, ahead, parting = _ahead(rungs, -1)
        left = self.fold[1] - float(rungs.load[-1])
        others = np.delete(rungs.radius[-1], [j, j + 1]).min(initial=np.inf)
        # nearer to where they meet than to where they part again, however short the flutter between
        return bool(abs(ahead - left) < 0.05 * min(left, parting - ahead) and others > 2 * left)

    def _proven(self) -> float:
        P, radius, k = self.rungs.load, self.rungs.radius, int(_uncovered(self.rungs)[0])
        if k == len(P) - 1 and self.fold is not None and self._alone(self.rungs):
            return self.fold[1]
        return float(P[k] + radius[k].min())

    # --- bounds between the rungs, each (m − 1, N): a row an interval, a column a branch ---------------------------

    @cached_property
    def _K(self) -> Real:
        return self.rungs.load[:, None] * self.rungs.first - self.rungs.s

    @cached_property
    def _quintic(self) -> Real:
        """Bézier points (6, m − 1, N) of the quintics through K_j(P, 0) and two derivatives at the rungs."""
        r, P = self.rungs, self.rungs.load[:, None]
        h = np.diff(P, axis=0)
        K, slope = self._series[0]
        d, dd = slope / 5, (2 * r.second + 6 * P * r.third) / 20
        return np.stack(
            [
                K[:-1],
                K[:-1] + h * d[:-1],
                K[:-1] + h * (2 * d[:-1] + h * dd[:-1]),
                K[1:] - h * (2 * d[1:] - h * dd[1:]),
                K[1:] - h * d[1:],
                K[1:],
            ]
        )

    @cached_property
    def _bounds(self) -> tuple[Real, ...]:
        """top, rise: greatest K_j(P, 0) and least increase of its quintic through the rungs, error added;
        error: that error; bend: |P² s″/2| + |P³ s‴/6|; radius: of discs round every load of the interval; room: in
        these discs; size: greatest s_j."""
        r, P = self.rungs, self.rungs.load[:, None]
        h = np.diff(P, axis=0)
        points = self._quintic
        radius = np.maximum(np.minimum(r.radius[:-1], r.radius[1:]) - h / 2, 1e-12 * P[1:])
        room = np.maximum(r.room[:-1], r.room[1:])
        # the quintic's error, h⁶/46080 max |d⁶K/dP⁶|, by Cauchy's inequality for s on the discs
        with np.errstate(over="ignore", invalid="ignore"):
            error = room * (0.11 * P[1:] / radius + 0.08) * (h / radius) ** 6
            size = np.maximum(r.s[:-1], r.s[1:]) + room * (h / radius) ** 2 / 4
        top = points.max(axis=0) + error
        rise = 5 * np.diff(points, axis=0).min(axis=0)
        bend = np.abs(P**2 * r.second) + np.abs(P**3 * r.third)
        return top, rise, error, np.maximum(bend[:-1], bend[1:]), radius, room, size

    @cached_property
    def _ceiling(self) -> tuple[Real, Real, Real, Real, Real]:
        """Intervals of ω² (upper ends, (I,)), the mode j that may resonate in each (its e_j, (I,)), and at some loads
        (l,) sums a, b (l, I): no crossing in an interval up to a load where e_j + κ > a + κ b.

        With mode j taken out, W = (diag(d) − P|H|)⁻¹ of the others, d the distance of ω² from e_k + P H_kk, bounds
        the inverse R of their block, and Im R = −ω R D R̄, D = e + κ: the imaginary part ω D_j of the Schur complement
        cannot vanish while D_j > P² |H_j·| W D W |H_·j|. Any x with (diag(d) − P|H|) x ≥ |H_·j| bounds W |H_·j|.
        """
        e, H, n = self.pencil.e, self.pencil.H, self.pencil.size
        loads = (self.rungs.load[-1] * np.array([0.3, 0.6, 0.75, 0.84, 0.92, 1.0]))[:, None, None]
        # the higher of two neighbours is the one to take out in most of their gap
        between = np.concatenate([[0.0], 0.7 * e[:-1] + 0.3 * e[1:], [2 * e[-1]]])
        part = np.array([0.0, 0.3, 0.6, 0.85])
        lower = between[:-1, None] + (e - between[:-1])[:, None] * part
        upper = e[:, None] + (between[1:] - e)[:, None] * (1 - part[::-1])
        edges = np.append(np.concatenate([lower, upper[:, :-1]], axis=1).ravel(), np.inf)
        j = np.repeat(np.arange(n), 7)
        shift = loads * np.diag(H)[:, None]
        d = np.maximum(
            e[:, None] + np.minimum(0.0, shift) - edges[1:], edges[:-1] - e[:, None] - np.maximum(0.0, shift)
        )
        out = np.arange(n)[:, None] == j
        d = np.where(out, np.inf, np.maximum(d, 1e-300))
        off = np.abs(H)
        np.fill_diagonal(off, 0.0)
        A = np.stack([off, off.T])[:, None]
        column = np.where(out, 0.0, np.stack([off[:, j], off.T[:, j]]) + 1e-9 * off.max())[:, None]
        with np.errstate(over="ignore", invalid="ignore"):
            x = column / d
            for _ in range(9):
                x = (column + loads * (A @ x)) / d
            x *= 1.08
            sure = (x >= (column + loads * (A @ x)) / d).all(axis=(0, 2))
            both = loads**2 * x[0] * x[1]
            a, b = (both * e[:, None]).sum(axis=1), both.sum(axis=1)
        sure &= np.isfinite(a) & np.isfinite(b)
        return edges[1:], e[j], loads[:, 0, 0], np.where(sure, a, np.inf), np.where(sure, b, 0.0)

    def _highest(self, kappa: float, load: float) -> float:
        """A frequency above which nothing crosses at loads up to this one; inf where none is known."""
        edges, e, loads, a, b = self._ceiling
        level = int(np.searchsorted(loads, load))
        if level == len(loads):
            return math.inf
        doubtful = np.flatnonzero(~(e + kappa > (1 + 1e-9) * (a[level] + kappa * b[level])))
        return math.sqrt(edges[doubtful[-1]]) if len(doubtful) else 0.0

    def clear(self, damping: Damping, load: float, known: Crossing | None) -> bool:
        """Whether no eigenvalue with ω > 0 stands on the imaginary axis below `load`. False: not known.

        `known` is a flutter at `load`, if there is one: the branch that it lies on may come to κ there."""
        alpha, kappa, r = damping.alpha, damping.kappa, self.rungs
        if math.isinf(kappa) and load <= self.proven * (1 + 1e-12):  # K_j < κ wherever s_j is a branch at all
            return True
        n, spare = int(np.searchsorted(r.load, load)), 0.0
        past = self._with_the_pair(load, known)
        if past:
            if math.isinf(kappa):
                return True
            n = self._fold_rung
        elif load > self.proven:
            return False
        elif n == len(r.load):  # divergence, next to the last rung
            n, spare = n - 1, load - float(r.load[-1])
            if spare > 0.01 * r.radius[-1].min():
                return False
        top, rise, error, bend, radius, room, size = (a[:n] for a in self._bounds)
        P = r.load[1 : n + 1, None]
        E = error + 2 * spare * np.abs(self._series[0][1][n])
        if alpha > 0:
            highest = alpha * self._highest(kappa, float(P[-1, 0]))
            if not (highest * P < radius).all():
                return False
            # τ of branch j, from Re (1 + iτ) s_j(p) = ω²; up to `highest` no other branch is there to be found
            speed = np.maximum(np.abs(r.first[:n]), np.abs(r.first[1 : n + 1])) * P
            tau = highest
            for _ in range(3):
                u = tau * P / radius
                with np.errstate(divide="ignore"):
                    s = size + tau * speed + room * np.minimum(u * u / (1 - u), 1.0)
                tau = np.minimum(tau, alpha * np.sqrt(s * np.hypot(1.0, tau)))
            v = (tau * P / radius) ** 2
            if not v.max() < 0.25:
                return False
            E = E + 2 * tau**2 * bend + room * v**2 * (3 / (1 - v) ** 2 + P / (radius * (1 - v)))
        unsafe = ~(top + E < kappa)
        branches = np.flatnonzero(unsafe.any(axis=0))
        if len(branches) == 0:
            return True
        if past or spare or len(branches) > 1 or known is None or known.frequency == 0:
            return False
        # the last stretch: K_j rises to κ at the known load and was not there before
        j = int(branches[0])
        at = unsafe[:, j]
        t = (load - r.load[n - 1]) / (r.load[n] - r.load[n - 1])
        w = float(bezier(self._points(*self._series[1], n - 1, j), t))
        K = float(np.array([1, 5, 10, 10, 5, 1]) * t**_POWER * (1 - t) ** (5 - _POWER) @ self._quintic[:, n - 1, j])
        near = abs(K - kappa) <= 2 * E[n - 1, j] + 1e-9 * w
        same = abs(known.frequency**2 - w) < 0.1 * room[n - 1, j]
        return bool(near and same and (rise[at, j] > 5 * E[at, j]).all())

    def _with_the_pair(self, load: float, known: Crossing | None) -> bool:
        """Whether a flutter known at `load` is that of the pair that meets, near the fold: alone with itself, it has
        no more than one there, before the fold (internal damping) or past it (external)."""
        if known is None or known.load != load or self._fold_rung >= len(self.rungs.load):
            return False
        assert self.fold is not None
        k = self._fold_rung
        j, _, _ = _ahead(self.rungs, -1)
        gap = float(self.rungs.s[k, j + 1] - self.rungs.s[k, j])
        same = abs(known.frequency**2 - self.fold[0]) < gap + 0.1 * self.fold[0]
        return bool(same and 0 < load - self.rungs.load[k] < 0.1 * self._apart)

    # --- where to begin ----------------------------------------------------------------------------------------------

    def start(self, damping: Damping) -> Start | None:
        """Starting point (ω², P, a, b) of `newton`: where light damping of this shape first gives energy to a branch
        instead of taking it. None where no branch of the ladder comes to that."""
        found = self._gaining(damping)
        if found is None:
            return self.fold
        w, P, k, j = found
        return w, P, *self._vectors(damping.shape, w, P, self.rungs.V[k, :, j])

    def first(self, damping: Damping) -> tuple[float, float] | None:
        """ω² and P of `start`."""
        found = self._gaining(damping) or self.fold
        return None if found is None else (found[0], found[1])

    def _gaining(self, damping: Damping) -> tuple[float, float, int, int] | None:
        """ω² and P of `start`, with the nearest rung and the branch; None where that is the fold."""
        r, kappa = self.rungs, damping.kappa
        gaining = np.argwhere(self._K[1:] > kappa)
        if not len(gaining):
            return None
        k, j = map(int, gaining[0])
        K, s = (self._points(f, slope, k, j) for f, slope in self._series)
        t = bezier_root(K, kappa)
        P, w = float(r.load[k] + t * (r.load[k + 1] - r.load[k])), float(bezier(s, t))
        second, third = (float(f[k, j] * (1 - t) + f[k + 1, j] * t) for f in (r.second, r.third))
        square = damping.alpha**2 * w
        bend = square * (P**2 * second + P**3 * third)
        if 0 < bend < (K[3] - kappa) / 2 or 0 > bend > (K[0] - kappa) / 2:
            t = bezier_root(K, kappa + bend)
            P, w = float(r.load[k] + t * (r.load[k + 1] - r.load[k])), float(bezier(s, t)) - square * P**2 * second
        return w, P, k + (t > 0.5), j

    def start_beyond(self, damping: Damping) -> Start | None:
        """As `start`, for external damping so heavy that flutter comes far beyond the fold: (Im s)² = β² Re s there."""
        if self.fold is None or math.isfinite(damping.kappa) or damping.size == 0:
            return None
        P, s, V, _ = self._beyond
        beta = damping.size
        f = np.where(s.imag == 0, np.inf, beta**2 * s.real - s.imag**2)
        j = f.argmin(axis=1)
        least = f.min(axis=1)
        if not (least < 0).any():
            return None
        k = int((least < 0).argmax())
        before = float(least[k - 1]) if k else beta**2 * self.fold[0]
        t = before / (before - float(least[k])) if math.isfinite(before) else 1.0
        z, v = s[k, j[k]], V[k, :, j[k]]
        im = abs(z.imag) * t + (1 - t) * (abs(s[k - 1, j[k - 1]].imag) if k else 0.0)
        v = v if z.imag < 0 else v.conj()
        v = v * np.exp(-0.5j * np.angle(v @ v))
        w, low = (im / beta) ** 2, float(P[k - 1]) if k else self.fold[1]
        return w, low + t * (float(P[k]) - low), v.real.copy(), v.imag / (math.sqrt(w) * beta)

    @cached_property
    def _beyond(self) -> tuple[Real, Complex, Complex, Complex]:
        """Loads beyond the ladder, with s, V and U there."""
        P: Real = self.rungs.load[-1] * 1.06 ** np.arange(1.0, 61.0)
        s, V = np.linalg.eig(np.diag(self.pencil.e) + P[:, None, None] * self.pencil.H)
        V = V.astype(np.complex128)
        return P, s.astype(np.complex128), V, inverse(V)

    def suspects(self, shape: Real, load: float) -> list[float]:
        """The first loads below this one, on the ladder and beyond it, where light damping of this shape gives energy
        to a branch that would be real and positive without."""
        r = self.rungs
        power = ((r.U * shape) * np.swapaxes(r.V, 1, 2)).sum(axis=2)
        found = [r.load[(power < 0).any(axis=1) & (r.load < load)]]
        if r.load[-1] < 0.97 * load:
            P, s, V, U = self._beyond
            power = ((U * shape) * np.swapaxes(V, 1, 2)).sum(axis=2).real
            found.append(P[((power < 0) & (s.imag == 0) & (s.real > 0)).any(axis=1) & (load > P)])
        return [float(loads[0]) for loads in found if len(loads)]

    def _vectors(self, shape: Real, w: float, P: float, a: Real) -> tuple[Real, Real]:
        """(a, b) for `newton` from a nearby null vector: a by inverse iteration, b from A b = −D a, but for what only
        the root removes."""
        H, e, n = self.pencil.H, self.pencil.e, self.pencil.size
        scale = 1 / (e + abs(w))
        J = np.zeros((n + 1, n + 1))
        J[:n, :n] = (P * H + np.diag(e - w)) * scale[:, None]
        J[:n, n] = scale * (H @ a)
        J[n, :n] = a
        try:
            a = np.linalg.solve(J, np.append(np.zeros(n), 1.0))[:n]
            return a, np.linalg.solve(J, np.append(-shape * a * scale, 0.0))[:n]
        except np.linalg.LinAlgError:
            return a, np.zeros(n)

    @cached_property
    def _series(self) -> tuple[tuple[Real, Real], tuple[Real, Real]]:
        """K_j(P, 0) and s_j at the rungs, each with its derivative."""
        r = self.rungs
        return (self._K, 2 * r.load[:, None] * r.second), (r.s, r.first)

    def _points(self, f: Real, slope: Real, k: int, j: int) -> Real:
        """Bézier points of branch j between the rungs k and k + 1."""
        h = (self.rungs.load[k + 1] - self.rungs.load[k]) / 3
        return np.array([f[k, j], f[k, j] + h * slope[k, j], f[k + 1, j] - h * slope[k + 1, j], f[k + 1, j]])


def _between(rungs: Rungs) -> Real:
    """Loads between the rungs where they stand wide apart for the least of the discs, spaced as its radius changes."""
    P, wide = rungs.load, np.diff(rungs.load)
    reach = (rungs.radius[1:] + rungs.radius[:-1]).argmin(axis=1)
    i = np.arange(len(wide))
    before, after = rungs.radius[i, reach], rungs.radius[i + 1, reach]
    # near the fold only so many as a proof for the undamped column takes
    fine = np.where(wide < 0.01 * P[-1], 1.4, 0.3)
    pieces = np.ceil(np.minimum(wide / np.maximum(fine * np.sqrt(before * after), 1e-150), 12.0)).astype(int)
    parts = []
    for k in np.flatnonzero(pieces > 1):
        ratio = min(max(after[k] / before[k], 1e-3), 1e3)
        t = np.arange(1, pieces[k]) / pieces[k]
        parts.append(P[k] + wide[k] * ((ratio**t - 1) / (ratio - 1) if abs(ratio - 1) > 1e-3 else t))
    return np.concatenate(parts) if parts else np.empty(0)


def _halving(low: float, high: float) -> Real:
    """Loads from low towards high, the rest halved each time, to within 5e-4 but three at least."""
    rest = (high - low) * 0.5 ** np.arange(1.0, 9.0)
    return high - rest[: max(3, int((rest > 5e-4 * high).sum()))]


def _uncovered(rungs: Rungs) -> NDArray[np.intp]:
    """The rungs whose discs do not meet those of the next, and the last."""
    apart = np.diff(rungs.load) >= (rungs.radius[1:] + rungs.radius[:-1]).min(axis=1)
    return np.flatnonzero(np.append(apart, True))


def _ahead(rungs: Rungs, k: int) -> tuple[int, float, float]:
    """Which branch j meets j + 1 first from rung k, and how far ahead, if the squares of their gaps are quadratic in
    P, which two branches by themselves have, and how far ahead they part again; inf where none do."""
    gap, opening, bend = (np.diff(f[k]) for f in (rungs.s, rungs.first, rungs.second))
    root = np.sqrt(np.maximum(-2 * gap * bend, 0.0))
    with np.errstate(divide="ignore", invalid="ignore"):
        ahead = np.where((root > opening) & (bend <= 0), gap / (root - opening), np.inf)
        parting = np.where(-root > opening, gap / (-root - opening), np.inf)
    j = int(np.argmin(ahead))
    return j, float(ahead[j]), float(parting[j])


def bezier(p: Any, t: Any) -> Any:
    """The cubic with these Bézier points at t, 0 to 1."""
    u = 1 - t
    return u * u * u * p[0] + 3 * u * u * t * p[1] + 3 * u * t * t * p[2] + t * t * t * p[3]


def bezier_root(p: Any, value: float = 0.0, steps: int = 12) -> float:
    """Where a cubic that takes `value` once between its ends takes it, 0 to 1."""
    a, b, c, d = (float(x) - value for x in p)
    low, high = 0.0, 1.0
    for _ in range(steps):
        t = (low + high) / 2
        if float(bezier((a, b, c, d), t)) * a > 0:
            low = t
        else:
            high = t
    return (low + high) / 2
