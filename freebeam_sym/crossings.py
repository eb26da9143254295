"""First loss of stability of a column as its load grows from zero: flutter, divergence, or none up to a stated load.

With K = E + P H and C = beta M + alpha E, in the basis where M = I and E = diag(e), λ = iω is an eigenvalue at
the load P exactly when det(diag(z(ω)) + P H) = 0, z = e − ω² + iω(αe + β). At each ω the candidate loads are N
complex numbers P_k(ω); the beam is stable at P = 0, so the least real positive P_k(ω) over all ω ≥ 0 is the first
loss of stability, whatever branch it lies on. These steps find it:

1. `Ladder.start`: where a branch first gains energy, and from there Newton's method (`newton`) on equations that
   stay regular as the damping vanishes. Any root bounds the answer from above.
2. `Ladder.clear`: without damping and with light damping, nothing crosses below that bound, from what is kept of the
   undamped branches. Where it cannot say so:
3. `direct_crossing`: all flutter loads as the eigenvalues of one matrix, where there are few modes. Where there are
   many, or loads too close to be told apart, `_search`:
4. `_excluded`: intervals of ω that hold no root below the bound, by an M-matrix inequality, whatever the damping.
5. `_examine`: what is left is covered by cells whose ends carry P_k and dP_k/dω, bisected until each load that could
   cross is followed through its cell. A lower root replaces the bound.

A count of unstable eigenvalues just below the load confirms the search; `reference_crossing` (a scan in P) is
the last resort and the tests' other route. "Stable" means the elastic spectrum: rigid motion of a free beam
drifts at any load.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from freebeam_sym.bialternate import MOST, direct_crossing
from freebeam_sym.counts import LIGHTEST_STATE, inverse_state, unstable
from freebeam_sym.ladder import bezier, bezier_root, ladder_of
from freebeam_sym.pencil import Complex, Crossing, Damping, Pencil, Real, inverse, newton

__all__ = ["LIGHTEST_SCAN", "first_crossing", "polished", "reference_crossing"]

LIGHTEST_SCAN = 1e-5
"""Damping ratio of mode 1 below which the cells are laid out at this ratio: first crossings move by its square
only, and Newton's method ends at the true damping. Far below it the sign of Im P_k would be rounding."""


@dataclass
class _Nodes:
    """Loads P_k(ω) at some frequencies: mu = 1/P (c, N), rate = d ln P/dω (c, N), vectors (c, N, N) in columns."""

    omega: Real
    mu: Complex
    rate: Complex
    vectors: Complex

    @staticmethod
    def at(pencil: Pencil, D: Real, omega: Real) -> _Nodes:
        z = pencil.e - omega[:, None] ** 2 + 1j * omega[:, None] * D
        root = 1 / np.sqrt(z)
        mu, Y = np.linalg.eig(-root[:, :, None] * pencil.H * root[:, None, :])
        X = inverse(Y)
        rate = ((X * ((1j * D - 2 * omega[:, None]) / z)[:, None, :]) * np.swapaxes(Y, 1, 2)).sum(axis=2)
        return _Nodes(omega, mu, rate, root[:, :, None] * Y)

    def join(self, other: _Nodes) -> _Nodes:
        return _Nodes(
            np.concatenate([self.omega, other.omega]),
            np.concatenate([self.mu, other.mu]),
            np.concatenate([self.rate, other.rate]),
            np.concatenate([self.vectors, other.vectors]),
        )


def _excluded(pencil: Pencil, D: Real, low: Real, high: Real, load: float) -> NDArray[np.bool_]:
    """Which intervals low ≤ ω ≤ high, (c,), hold no real P_k(ω) in (0, load]. A proof, but for rounding.

    |z_j + P H_jj| ≥ d_j on the interval. If diag(d) − P|H| (off-diagonal) is an M-matrix, G = diag(z) + P H is
    regular. Else take out the mode j nearest its resonance: W = (diag(d) − P|H|)⁻¹ of the others bounds the
    inverse R of their block, and Im R = −ω R D R̄, so that the imaginary part ω D_j of the Schur complement
    cannot vanish while D_j > P² |H_j·| W D W |H_·j|, however small D is. All bounds are least at P = load.
    """
    e, shift = pencil.e, load * pencil.diagonal
    below = (e + np.minimum(0.0, shift)) - high[:, None] ** 2
    above = low[:, None] ** 2 - (e + np.maximum(0.0, shift))
    d = np.hypot(np.maximum(0.0, np.maximum(below, above)), low[:, None] * D)
    cell, i = np.arange(len(low)), np.arange(pencil.size)
    j = d.argmin(axis=1)
    least = d[cell, j]
    d[cell, j] = 1.0
    sure = d.min(axis=1) > 0
    row, column = load * pencil.off[j], load * pencil.off.T[j]
    A = np.empty((len(low), pencil.size, pencil.size))
    A[:] = -load * pencil.off
    A[cell, j, :] = A[cell, :, j] = 0.0
    A[:, i, i] = np.where(sure[:, None], d, 1.0)
    try:
        W = np.linalg.inv(A)
    except np.linalg.LinAlgError:
        return np.zeros(len(low), dtype=bool)
    sure &= W.min(axis=(1, 2)) >= 0
    x = (W @ column[:, :, None])[:, :, 0]
    y = (row[:, None, :] @ W)[:, 0, :]
    margin = 1 + 1e-9
    dominant = least > margin * (row * x).sum(axis=1)
    damped = D[j] > margin * (y * D * x).sum(axis=1)
    return np.asarray(sure & (dominant | damped))


def _intervals(pencil: Pencil, D: Real, load: float, pieces: int) -> tuple[Real, Real]:
    """Intervals of ω (low, high), disjoint, outside which no real P_k(ω) lies in (0, load]."""
    e = pencil.e
    top = math.sqrt(float((e + load * np.abs(pencil.H).sum(axis=1)).max()))
    high = np.append(np.sqrt((e[1:] + e[:-1]) / 2), top)
    high = np.unique(np.minimum(high, top))
    low = np.append(0.0, high[:-1])
    kept = ~_excluded(pencil, D, low, high, load)
    low, high = low[kept], high[kept]
    # geometric pieces: internal damping can bring the frequency far below all resonances
    inner = np.where(low > 0, low, high / 1024)
    edges = inner * (high / inner) ** (np.arange(2 * pieces + 1)[:, None] / (2 * pieces))
    if len(low):
        edges[0], edges[-1] = low, high
    low, high = edges[:-1].T.ravel(), edges[1:].T.ravel()
    kept = ~_excluded(pencil, D, low, high, load)
    low, high = low[kept], high[kept]
    apart = np.flatnonzero(low[1:] > high[:-1])
    return low[np.append(0, apart + 1)] if len(low) else low, high[np.append(apart, -1)] if len(low) else high


@dataclass
class _Findings:
    """What `_examine` says of cells: crossings (cell, ω, P, node, column), which cells must be cut, and where
    best (a fraction of the cell; nan where anywhere will do)."""

    crossings: list[tuple[int, float, float, int, int]]
    cut: NDArray[np.bool_]
    where: Real


def _examine(nodes: _Nodes, a: NDArray[np.intp], b: NDArray[np.intp], load: float, finest: float) -> _Findings:
    """Follow each load P_k(ω) through cells from node a to node b, and say where it meets the real axis in (0, load].

    Loads at the ends are matched by the trapezoid rule (the residual r is third order in the cell's width), the
    cubic through values and derivatives is enclosed by its Bézier points; r/4 is taken for its error, which is
    fourth order. Loads that meet within a cell could interact too briefly for its ends to tell, so such a cell is
    cut where they meet, down to a relative width `finest`.
    """
    far = 1e-9 / load
    h = (nodes.omega[b] - nodes.omega[a])[:, None]
    mu_a, mu_b = nodes.mu[a], nodes.mu[b]
    rate_a, rate_b = h * nodes.rate[a], h * nodes.rate[b]
    P_all: Complex = np.asarray(1 / np.where(np.abs(nodes.mu) < far, far, nodes.mu), dtype=complex)
    room_all = _nearest(P_all)
    Pa, Pb = P_all[a], P_all[b]
    da, db = Pa * rate_a, Pb * rate_b
    residual = (Pb[:, None, :] - Pa[:, :, None]) - (da[:, :, None] + db[:, None, :]) / 2
    distance = np.abs(residual)
    cells, k = np.arange(len(a))[:, None], np.arange(Pa.shape[1])[None, :]
    match = distance.argmin(axis=2)
    best = distance[cells, k, match]
    back = distance.argmin(axis=1)[cells, match] == k
    room = np.minimum(room_all[a], room_all[b][cells, match])
    good = back & (best < 0.15 * room)
    r = residual[cells, k, match]
    Pe, de = Pb[cells, match], db[cells, match]
    points = np.stack([Pa, Pa + da / 3, Pe - de / 3, Pe])
    # P real at ω = 0 leaves the axis along its derivative
    rest = (nodes.omega[a] == 0)[:, None] & (np.abs(Pa.imag) <= 1e-9 * np.abs(Pa))
    points.imag[0] = np.where(rest, points.imag[1], points.imag[0])
    m_re, m_im = np.abs(r.real) / 4, np.abs(r.imag) / 4
    within = (points.real.min(axis=0) - m_re <= load) & (points.real.max(axis=0) + m_re > 0)
    clear = (points.imag.min(axis=0) > m_im) | (points.imag.max(axis=0) < -m_im)
    cc, kk = np.nonzero(good & within & ~clear)
    p = points.imag[:, cc, kk]
    once = (p[0] * p[3] < 0) & ((np.sign(p[1:]) != np.sign(p[:-1])).sum(axis=0) == 1)
    once &= np.minimum(np.abs(p[0]), np.abs(p[3])) > m_im[cc, kk]
    cut = np.zeros(len(a), dtype=bool)
    cut[cc[~once]] = True
    where = np.full(len(a), np.nan)
    wide = h[:, 0] > finest * nodes.omega[b]
    near = good & within & (wide & ~cut)[:, None]
    if (near.sum(axis=1) > 1).any():
        c_, t_ = _meetings(Pa, Pe, near)
        cut[c_], where[c_] = True, t_
    crossings: list[tuple[int, float, float, int, int]] = []
    for c, i in zip(cc[once], kk[once], strict=True):
        t = bezier_root(points.imag[:, c, i])
        P = float(bezier(points.real[:, c, i], t))
        if -m_re[c, i] < P < load + m_re[c, i]:
            omega = float(nodes.omega[a[c]] + t * h[c, 0])
            start = (int(a[c]), int(i)) if t < 0.5 and nodes.omega[a[c]] > 0 else (int(b[c]), int(match[c, i]))
            crossings.append((int(c), omega, P, *start))
    # loads not matched matter where they may come to the real segment within the cell
    loose_a = ~good & _within_reach(Pa, mu_a, rate_a, load)
    taken = np.zeros(Pb.shape, dtype=bool)
    taken[np.nonzero(good)[0], match[good]] = True
    loose_b = ~taken & _within_reach(Pb, mu_b, rate_b, load)
    for c in np.flatnonzero((loose_a.any(axis=1) | loose_b.any(axis=1)) & ~cut):
        pair_a, pair_b = np.flatnonzero(~good[c]), np.flatnonzero(~taken[c])
        if len(pair_a) > 2:
            pair_a, pair_b = np.flatnonzero(loose_a[c]), np.flatnonzero(loose_b[c])
        met = None
        if len(pair_a) == len(pair_b) == 2:
            beside = good[c] & within[c] & wide[c]
            met = _follow_pair(Pa[c], da[c], Pb[c], db[c], pair_a, pair_b, Pa[c, beside], Pe[c, beside])
        if met is None:
            cut[c] = True
            continue
        for t, P in met:
            if 0 < P < 1.05 * load:
                omega = float(nodes.omega[a[c]] + t * h[c, 0])
                at_a = t < 0.5 and nodes.omega[a[c]] > 0
                ends, pair = (Pa[c], pair_a) if at_a else (Pb[c], pair_b)
                crossings.append(
                    (int(c), omega, P, int(a[c] if at_a else b[c]), int(pair[np.abs(ends[pair] - P).argmin()]))
                )
    return _Findings([x for x in crossings if not cut[x[0]]], cut, where)


def _meetings(Pa: Complex, Pb: Complex, use: NDArray[np.bool_]) -> tuple[NDArray[np.intp], Real]:
    """Cells in which two of the loads that go from Pa to Pb (c, N) pass each other closely, and where there (0 to
    1)."""
    c, i, j = np.nonzero(np.triu(use[:, :, None] & use[:, None, :], 1))
    d, e = Pa[c, i] - Pa[c, j], Pb[c, i] - Pb[c, j]
    turn = e - d
    t = np.clip(-(d * turn.conj()).real / np.maximum(np.abs(turn) ** 2, 1e-300), 0.0, 1.0)
    size_d, size_e = np.abs(d), np.abs(e)
    close = np.abs(d + t * turn) < 0.2 * np.minimum(size_d, size_e)
    close &= np.abs((Pa[c, i] + t * (Pb[c, i] - Pa[c, i])).imag) < 2 * np.maximum(size_d, size_e)
    return c[close], t[close]


def _nearest(P: Complex) -> Real:
    """Distance of each load from its nearest neighbour, (c, N)."""
    gap = np.abs(P[:, :, None] - P[:, None, :])
    i = np.arange(P.shape[1])
    gap[:, i, i] = np.inf
    return np.asarray(gap.min(axis=2))


def _within_reach(P: Complex, mu: Complex, rate: Complex, load: float) -> NDArray[np.bool_]:
    """Whether P could come to the real segment [0, load] in a cell, by twice its motion at constant rate."""
    gap = np.abs(P - np.clip(P.real, 0.0, load))
    enters = np.abs(mu) * (1 + 2 * np.abs(rate)) * load >= 1
    return np.asarray(enters & (gap <= 2 * np.abs(P * rate)))


_PLACES = np.linspace(0.0, 1.0, 33)
_BERNSTEIN = bezier(np.eye(4)[:, :, None], _PLACES).T
"""Values of a cubic at _PLACES from its Bézier points, (33, 4)."""


def _follow_pair(
    Pa: Complex,
    da: Complex,
    Pb: Complex,
    db: Complex,
    ka: NDArray[np.intp],
    kb: NDArray[np.intp],
    beside_a: Complex,
    beside_b: Complex,
) -> list[tuple[float, float]] | None:
    """Where two loads that run into each other (a branch point of P_k: s_j(P) has an extremum) meet the real
    axis: (t, P) with t from 0 to 1 through the cell; None where the cell is too wide to tell. `beside`: other
    loads, at both ends, that they must not meet on the way.

    Their sum S and product Q are smooth there. P² − S P + Q has a real root, P = Im Q / Im S, exactly where ρ =
    (Im Q)² − Re S Im S Im Q + (Im S)² Re Q vanishes; ρ ~ Im P₁ Im P₂, so its sign is settled however small both
    are.
    """
    (a, a_), (b, b_) = ka, kb
    S, dS, Se, dSe = Pa[a] + Pa[a_], da[a] + da[a_], Pb[b] + Pb[b_], db[b] + db[b_]
    Q, dQ, Qe, dQe = Pa[a] * Pa[a_], Pa[a] * da[a_] + Pa[a_] * da[a], Pb[b] * Pb[b_], Pb[b] * db[b_] + Pb[b_] * db[b]
    rs, rq = (Se - S - (dS + dSe) / 2) / 4, (Qe - Q - (dQ + dQe) / 2) / 4
    away = np.abs(Pa - S / 2), np.abs(Pb - Se / 2)
    away[0][ka] = away[1][kb] = np.inf
    room = float(min(away[0].min(), away[1].min()))
    if abs(rs) > 0.1 * room or abs(rq) > 0.1 * room * max(abs(S), room):
        return None
    t = _PLACES
    st = _BERNSTEIN @ np.array([S, S + dS / 3, Se - dSe / 3, Se])
    qt = _BERNSTEIN @ np.array([Q, Q + dQ / 3, Qe - dQe / 3, Qe])
    if len(beside_a):
        other = beside_a[:, None] + t * (beside_b - beside_a)[:, None]
        apart = np.abs(other**2 - st * other + qt)
        if (apart.min(axis=1) < 0.2 * np.minimum(apart[:, 0], apart[:, -1])).any():
            return None
    rho = qt.imag**2 - st.real * st.imag * qt.imag + st.imag**2 * qt.real
    slack = (
        np.abs(2 * qt.imag - st.real * st.imag) * abs(rq.imag)
        + np.abs(2 * st.imag * qt.real - st.real * qt.imag) * abs(rs.imag)
        + np.abs(st.imag * qt.imag) * abs(rs.real)
        + st.imag**2 * abs(rq.real)
    )
    sure = np.abs(rho) > slack
    sign = np.sign(rho[sure])
    turns = np.flatnonzero(sign[1:] != sign[:-1])
    if sure.sum() < 29 or not sure[0] or not sure[-1] or len(turns) > 1 or (len(turns) == 0 and not sure.all()):
        return None
    if len(turns) == 0:
        return []
    k, m = np.flatnonzero(sure)[[turns[0], turns[0] + 1]]
    if m - k - 1 < 32 - (sure.sum() - 1):  # an unsure stretch away from the turn
        return None
    x = rho[k] / (rho[k] - rho[m])
    P = (qt.imag[k] * (1 - x) + qt.imag[m] * x) / (st.imag[k] * (1 - x) + st.imag[m] * x)
    return [(float(t[k] * (1 - x) + t[m] * x), float(P))]


def _grid(pencil: Pencil, D: Real, low: float, high: float, load: float, step: float, beside: Real) -> Real:
    """Frequencies from low to high at which to begin: about as far apart as z(ω) takes to change by `step` of
    itself, no finer near a resonance than the loads (0, load] can tell; and the resonances, where the branches
    start at P = 0."""
    start = max(low, high / 4096)
    fine = start * (high / start) ** np.linspace(0.0, 1.0, 48)
    w = fine[:, None]
    rate = np.hypot(2 * w, D) / (np.hypot(pencil.e - w * w, w * D) + load * np.abs(np.diag(pencil.H)))
    top = rate.max(axis=1)
    way = np.append(0.0, np.cumsum((top[1:] + top[:-1]) / 2 * np.diff(fine)))
    inner = np.interp(np.linspace(0.0, way[-1], max(3, math.ceil(way[-1] / step) + 1)), way, fine)
    extra = np.append(np.sqrt(pencil.e), beside)
    grid = np.concatenate([[low, high], inner[1:-1], extra[(extra > low) & (extra < high)]])
    grid.sort()
    grid = grid[np.append(True, np.diff(grid) > 1e-6 * high)]
    long = grid[1:] > 2 * grid[:-1]
    return np.sort(np.append(grid, (0.6 * grid[:-1] + 0.4 * grid[1:])[long]))


def _search(
    pencil: Pencil, damping: Damping, bound: float, known: Crossing | None, pieces: int
) -> tuple[Crossing | None, bool]:
    """Least crossing with ω > 0 below `bound`, or `known`; and whether every cell was settled."""
    ratio = damping.size / math.sqrt(pencil.e[0])
    scan = damping.size if ratio >= LIGHTEST_SCAN else LIGHTEST_SCAN * math.sqrt(pencil.e[0])
    D = scan * damping.shape
    low, high = _intervals(pencil, D, bound, pieces)
    if not len(low):
        return known, True
    beside = np.array([0.96, 1.04]) * (known.frequency if known is not None else 0.0)
    grids = [_grid(pencil, D, float(x), float(y), bound, 3.0 / pieces, beside) for x, y in zip(low, high, strict=True)]
    nodes = _Nodes.at(pencil, D, np.concatenate(grids))
    last = np.zeros(len(nodes.omega), dtype=bool)
    last[np.cumsum([len(grid) for grid in grids]) - 1] = True
    a = np.flatnonzero(~last)
    b = a + 1
    settled = True
    finest = 0.05 * float(D.min()) / math.sqrt(pencil.e[0])
    for _ in range(45):
        findings = _examine(nodes, a, b, bound, finest)
        cut = findings.cut
        seen = known is None
        near = known.load if known is not None else 0.0
        for c, omega, P, node, column in sorted(findings.crossings, key=lambda x: abs(x[2] - near)):
            wa, wb = nodes.omega[a[c]], nodes.omega[b[c]]
            slack = 0.3 * (wb - wa)
            if not seen and known is not None and wa <= known.frequency <= wb and abs(P - near) < 0.02 * near:
                seen = True  # the known crossing itself
                continue
            if P > bound * 1.01:
                continue
            found = polished(pencil, damping, scan, omega, P, nodes.vectors[node, :, column])
            if found is None or not wa - slack < found.frequency < wb + slack or abs(found.load - P) > 0.1 * P:
                cut[c] = True
            elif found.load < bound * (1 - 1e-9):
                bound, known = found.load, found
        if not cut.any():
            return known, settled
        a, b, where = a[cut], b[cut], findings.where[cut]
        wa, wb = nodes.omega[a], nodes.omega[b]
        middle = np.where(wa == 0, wb / 4, np.where(wb > 4 * wa, np.sqrt(wa * wb), (wa + wb) / 2))
        middle = np.where(np.isnan(where), middle, wa + np.clip(where, 0.05, 0.95) * (wb - wa))
        fine = (wb - wa) > 1e-9 * wb
        settled &= bool(fine.all())
        a, b, wa, wb, middle = a[fine], b[fine], wa[fine], wb[fine], middle[fine]
        closed = _excluded(pencil, D, np.concatenate([wa, middle]), np.concatenate([middle, wb]), bound)
        left, right = ~closed[: len(a)], ~closed[len(a) :]
        need = left | right
        new = _Nodes.at(pencil, D, middle[need])
        index = np.cumsum(need) - 1 + len(nodes.omega)
        nodes = nodes.join(new)
        a, b = np.concatenate([a[left], index[right]]), np.concatenate([index[left], b[right]])
        if not len(a):
            return known, settled
    return known, False


def polished(pencil: Pencil, damping: Damping, scan: float, omega: float, P: float, v: Complex) -> Crossing | None:
    """The crossing near (ω, P) with eigenvector v of the scan (made at damping size `scan`), at the true damping."""
    square = v @ v
    v = v * np.exp(-0.5j * np.angle(square)) / math.sqrt(np.abs(v @ v.conj()))
    root = newton(pencil, damping, omega**2, P, v.real.copy(), v.imag / (omega * scan))
    return _crossing(pencil, damping, root)


def _crossing(pencil: Pencil, damping: Damping, root: tuple[float, float, Real, Real] | None) -> Crossing | None:
    """The flutter that a root of `newton` stands for; None where ω² or P is not positive."""
    if root is None or root[0] <= 0 or root[1] <= 0:
        return None
    omega = math.sqrt(root[0])
    return Crossing(root[1], omega, pencil.vector(root[2] + 1j * omega * damping.size * root[3]))


def first_crossing(
    pencil: Pencil,
    alpha: float = 0.0,
    beta: float = 0.0,
    load_max: float = 1000.0,
    kappa: float | None = None,
    search: bool = False,
    once: bool = False,
) -> Crossing | None:
    """First loss of stability for 0 < P ≤ load_max; None where there is none. `once`: a question of a pencil
    that will not be asked many, so that it gets no ladder. `search`: by the search alone."""
    damping = Damping.of(pencil.e, alpha, beta, kappa)
    known, bound = None, load_max
    loads = pencil.divergence_loads
    if len(loads) and loads[0] <= bound * (1 + 1e-9):
        known = pencil.divergence(loads[0])
        known, bound = (known, known.load) if known.load <= load_max else (None, bound)
    if pencil.conservative:
        return known
    if once and pencil.size <= MOST:
        settled, found = direct_crossing(pencil, damping, load_max, kappa is not None)
        if settled:
            return found
    ladder = ladder_of(pencil)
    for start in (ladder.start, ladder.start_beyond):
        guess = start(damping)
        found = None if guess is None else _crossing(pencil, damping, newton(pencil, damping, *guess))
        if found is not None:
            if found.load < bound:
                known, bound = found, found.load
            break
    if not search:
        if ladder.clear(damping, bound, known):
            return known
        if pencil.size <= MOST and not once:
            settled, found = direct_crossing(pencil, damping, load_max, kappa is not None)
            if settled:
                return found
    for pieces in (4, 8, 16):
        known, settled = _search(pencil, damping, bound, known, pieces)
        bound = known.load if known is not None else load_max
        witness = _witness(pencil, damping, bound, kappa is not None)
        if witness is None and settled:
            return known
        if witness is not None:
            known = _bisect(pencil, damping, 0.0, witness, kappa is not None)
            bound = known.load
    slow = reference_crossing(pencil, alpha, beta, bound, kappa=kappa)
    return known if slow is None or (known is not None and slow.load > known.load * (1 - 1e-9)) else slow


def _witness(pencil: Pencil, damping: Damping, bound: float, limit: bool) -> float | None:
    """A load below `bound` at which the beam is unstable after all: just below, or between there and where the
    undamped beam is known to be stable. None where there is none."""
    top = float(ladder_of(pencil).rungs.load[-1]) * 1.05
    loads = [bound * (1 - 1e-5)]
    if damping.size < 0.1 * math.sqrt(pencil.e[0]):
        loads += ladder_of(pencil).suspects(damping.shape, loads[0])
    if 0 < top < 0.97 * bound and damping.size > 0:
        steps = min(8, 1 + int(math.log(bound / top) / 0.2))
        loads += list(top * (bound / top) ** (np.arange(steps) / steps))
    return next((load for load in loads if unstable(pencil, damping, load, limit)), None)


def reference_crossing(
    pencil: Pencil,
    alpha: float = 0.0,
    beta: float = 0.0,
    load_max: float = 1000.0,
    *,
    step: float | None = None,
    kappa: float | None = None,
) -> Crossing | None:
    """As `first_crossing`, by stepping P until an eigenvalue grows, then bisection: slow, plain, and blind
    between steps."""
    damping, limit = Damping.of(pencil.e, alpha, beta, kappa), kappa is not None
    high = 0.0
    step = load_max / 2000 if step is None else step
    while high < load_max:
        low, high = high, min(high + step, load_max)
        if unstable(pencil, damping, high, limit):
            return _bisect(pencil, damping, low, high, limit)
    return None


def _bisect(pencil: Pencil, damping: Damping, low: float, high: float, limit: bool) -> Crossing:
    """A crossing between a stable load and an unstable one."""
    while high - low > 4e-16 * high:
        middle = (low + high) / 2
        if not low < middle < high:
            break
        if unstable(pencil, damping, middle, limit):
            high = middle
        else:
            low = middle
    if damping.size / math.sqrt(pencil.e[0]) < LIGHTEST_STATE:
        s, V = np.linalg.eig(np.diag(pencil.e) + high * pencil.H)
        growth = -np.einsum("jn,n,nj->j", np.linalg.inv(V), damping.shape, V).real
        worst = int(np.argmax(np.where((s.real <= 0) | (s.imag != 0), np.inf, growth)))
        omega, v = math.sqrt(max(0.0, float(s[worst].real))), V[:, worst]
    else:
        try:
            theta, W = np.linalg.eig(inverse_state(pencil, damping, high))
        except np.linalg.LinAlgError:
            return pencil.divergence(high)
        worst = int(np.argmax(theta.real))
        omega = abs(float((math.sqrt(pencil.e[0]) / theta[worst]).imag))
        v = W[: pencil.size, worst]
    if omega > 0:
        found = polished(pencil, damping, damping.size or 1.0, omega, high, v.astype(complex))
        if found is not None and abs(found.load - high) < 1e-3 * high:
            return found
    return Crossing(high, omega, pencil.vector(v))
