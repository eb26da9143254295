"""The surface of first crossings over all damping: what a pencil's critical load is at every (α, β), tabulated.

With C = αE + βM, κ₀ = √(e₁e₂) and size = ακ₀ + β, the coordinates

    ξ = size²/(size² + κ₀),    χ = β/size

take all damping, from none to infinite, to the unit square, and there the load and the frequency of one crossing are
analytic: the limit of vanishing damping is the edge ξ = 0 (a boundary point depends on the square of the damping, as
λ = iω and λ = −iω cross together), the coalescence its corner χ = 1, and neither is a singular point. So the square is
cut into patches with a Chebyshev series each. The nodes of a patch are solved in one batch from a neighbour's series.

A patch is taken only where its series have converged and where, at loads just below the surface, every eigenvalue but
the crossing pair is damped, with a margin that varies too little between the places of the count for another branch
to come between them; at its middle loads further below are counted too. Else it is cut. What no patch of the least
size settles is left to the search of `freebeam_sym.stability.crossings`.

That a margin varies little is no proof. The constants below were chosen for speed on maps of the package's columns;
with them 54,216 points of 2,008 random maps (every column, own parameters, both bases, N = 2 to 12, any damping) agreed
with the search, 1.7e-11 apart at most.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import cache, cached_property

import numpy as np
from numpy.typing import NDArray

from freebeam_sym.stability.crossings import first_loss
from freebeam_sym.stability.pencil import Pencil
from freebeam_sym.stability.problem import Complex, Crossing, Real
from freebeam_sym.stability.proportional import Proportional

__all__ = ["FEW", "Surface", "first_crossing", "surface_of"]

NODES = 10
MOST = 20
"""Nodes of a patch in each direction, first and at most: as many as the decay of the first series asks for."""
TOLERANCE = 3e-11
"""Of the last coefficients of a patch's series for the load, relative."""
SMALLEST = 1 / 8192
"""Least width of a patch."""
ASKED = 4
"""Single questions that are left to a search each before a patch is made, which costs as much as some searches."""
FEW = 16
"""Points that are left to a search each: it costs less than a patch. In the surface as a whole, and in a patch whose
neighbourhood was not settled down to the width SMALL."""
SMALL = 1 / 64
_BLOCK = 8192  # points evaluated at a time: their arrays stay in the cache


@cache
def _gauss(n: int) -> Real:
    """Chebyshev's interior nodes on (0, 1), ascending: no node lies at vanishing or infinite damping."""
    return np.asarray((1 - np.cos(np.pi * (np.arange(n) + 0.5) / n)) / 2)


@cache
def _to_series(n: int) -> Real:
    """Values at n nodes to coefficients, (n, n)."""
    k = np.arange(n)[:, None]
    return np.asarray(np.cos(k * np.arccos(2 * _gauss(n) - 1)) * np.where(k == 0, 1, 2) / n)


_COARSE = 6
"""Nodes in each direction of the first guess."""
_COUNTED = _gauss(4)
"""Places in each direction at which the eigenvalues of a patch are counted, at least."""
_TERMS_COUNTED = 3.5
"""Terms of a series for each place of a count, in each direction: a longer series bends more."""
_VARIES = 6.0
"""Factor up to which the margin may vary from one place of a count to the next."""
_CORNERS = [(x, y) for x in _COUNTED[[0, -1]].tolist() for y in _COUNTED[[0, -1]].tolist()]
_PROBED = (0.02, 0.35, 0.7, 0.98)
"""Places along χ at which a patch that begins at vanishing damping is held against the undamped branches."""
_LEVELS = np.array([0.25, 0.5, 0.7, 0.85, 0.94, 0.98])
"""Shares of the critical load at which the middle of a patch must be stable."""


def chebyshev(x: Real, n: int = NODES) -> Real:
    """T_0 … T_(n−1) at 2x − 1, shape (n, *x.shape)."""
    t = 2 * x - 1
    if x.size < 100:
        return np.asarray(np.cos(np.multiply.outer(np.arange(n), np.arccos(np.clip(t, -1.0, 1.0)))))
    T = np.empty((n, *x.shape))
    T[0], T[1] = 1, t
    t2 = 2 * t
    for k in range(2, n):
        np.multiply(t2, T[k - 1], out=T[k])
        T[k] -= T[k - 2]
    return T


@cache
def _between(nodes: int, n: int) -> Real:
    """What takes a series of n terms to its values at the nodes, (n, nodes)."""
    return chebyshev(_gauss(nodes), n)


def _square(values: Real) -> Real:
    """Values at the nodes, (2, n²), as a grid (2, n, n)."""
    n = math.isqrt(values.shape[-1]) if values.ndim == 2 else values.shape[-1]
    return values.reshape(2, n, n)


def _filled(values: Real) -> Real | None:
    """Values on a grid (2, m, m), those missing taken from the nearest there are, for a guess; None of none."""
    known = np.isfinite(values[0])
    if known.all() or not known.any():
        return values if known.all() else None
    i, j = np.nonzero(known)
    out = values.copy()
    for a, b in np.argwhere(~known):
        k = int(((i - a) ** 2 + (j - b) ** 2).argmin())
        out[:, a, b] = values[:, i[k], j[k]]
    return out


@dataclass
class _Patch:
    """A rectangle of (ξ, χ). `state`: "new", "flutter" (with a series), "none" (no flutter below the bound), "cut"
    (into equal `parts` along `axis`) or "unsettled". `series` (m, 2, n, n), n from NODES to MOST: of load and
    ω²/(1 − ξ) of m crossings, of which the first is the one at the least load."""

    low: tuple[float, float]
    high: tuple[float, float]
    guess: Real | None
    """Load and ω²/(1 − ξ) at the nodes, to begin with, (2, NODES, NODES)."""
    tail: float = math.inf
    """Of the series that the guess is from."""
    state: str = "new"
    series: Real | None = None
    axis: int = 0
    parts: list[_Patch] = field(default_factory=list)
    asked: int = 0

    def nodes(self, t: Real) -> tuple[Real, Real]:
        """ξ and χ, each (m²,), at the places t × t of the patch."""
        (x, y), (X, Y) = self.low, self.high
        xi, chi = np.meshgrid(x + (X - x) * t, y + (Y - y) * t, indexing="ij")
        return xi.ravel(), chi.ravel()


def first_crossing(
    pencil: Pencil, alpha: float = 0.0, beta: float = 0.0, load_max: float = 1000.0, kappa: float | None = None
) -> Crossing | None:
    """First loss of stability of a pencil with damping C = alpha E + beta M, or in the limit of vanishing damping at
    kappa = beta/alpha."""
    return first_loss(Proportional(pencil, alpha, beta, kappa), load_max).crossing


def surface_of(pencil: Pencil, load_max: float) -> Surface:
    """The surface of a pencil up to `load_max` and beyond it, made once; its patches, where they are asked for."""
    bound = 10.0 ** max(3, math.ceil(math.log10(load_max)))
    if (Surface, bound) not in pencil.kept:
        pencil.kept[Surface, bound] = Surface(pencil, bound)
    found: Surface = pencil.kept[Surface, bound]
    return found


class Surface:
    """First crossings of a pencil that is not conservative, below `bound`, for any α ≥ 0 and β ≥ 0. Patches are made
    when first asked for."""

    def __init__(self, pencil: Pencil, bound: float) -> None:
        self.pencil = pencil
        self.first_divergence = next((x.crossing for x in pencil.divergences if x.simple), None)
        self.divergence = math.inf if self.first_divergence is None else self.first_divergence.load
        self.bound = bound
        self.kappa0 = math.sqrt(pencil.e[0] * pencil.e[1])
        self._root: _Patch | None = None
        self.asked = 0

    # --- asking ----------------------------------------------------------------------------------------------------

    def coordinates(self, alpha: Real, beta: Real) -> tuple[Real, Real, Real]:
        """ξ, 1 − ξ and χ of damping, each (n,)."""
        size = alpha * self.kappa0 + beta
        square = size * size
        rest = self.kappa0 / (square + self.kappa0)
        with np.errstate(invalid="ignore", divide="ignore"):
            chi = np.where(size > 0, beta / size, 1.0)
        return np.minimum(square / self.kappa0, 1e300) * rest, rest, chi

    def at(self, alpha: Real, beta: Real, single: bool = False) -> tuple[Real, Real, NDArray[np.bool_]]:
        """Load and frequency of the first flutter at damping (n,), nan where there is none below the bound, and which
        of them are settled: that hangs on these points alone. single: a question that is asked by itself; a patch is
        then made only after ASKED questions for it."""
        load, square = np.full(len(alpha), np.nan), np.full(len(alpha), np.nan)
        settled = np.zeros(len(alpha), dtype=bool)
        if self._root is None:
            self.asked += 1
            if single and self.asked <= ASKED:
                return load, square, settled
            self._root = self._first()
        for start in range(0, len(alpha), _BLOCK):
            part = slice(start, start + _BLOCK)
            xi, rest, chi = self.coordinates(alpha[part], beta[part])
            self._descend(self._root, np.arange(len(xi)), xi, chi, load[part], square[part], settled[part], single)
            square[part] *= rest
        settled &= ~(square < 0)  # where an eigenvalue starts at λ = 0, rounding decides the sign: the search is asked
        return load, np.sqrt(np.maximum(square, 0)), settled

    def _descend(
        self,
        patch: _Patch,
        which: NDArray[np.intp],
        xi: Real,
        chi: Real,
        load: Real,
        square: Real,
        settled: NDArray[np.bool_],
        single: bool,
    ) -> None:
        widths = [b - a for a, b in zip(patch.low, patch.high, strict=True)]
        if not single and len(which) < FEW and min(widths) < SMALL:
            return
        if patch.state == "new":
            patch.asked += 1
            if single and patch.asked <= ASKED:
                return
            self._make(patch)
        if patch.state == "cut":
            k = np.searchsorted([part.high[patch.axis] for part in patch.parts[:-1]], (xi, chi)[patch.axis][which])
            for number, part in enumerate(patch.parts):
                mine = which[k == number]
                if len(mine):
                    self._descend(part, mine, xi, chi, load, square, settled, single)
        elif patch.state in ("flutter", "none"):
            settled[which] = True
            if patch.series is not None:
                (x, y), (X, Y) = patch.low, patch.high
                n = patch.series.shape[-1]
                Tx, Ty = chebyshev((xi[which] - x) / (X - x), n), chebyshev((chi[which] - y) / (Y - y), n)
                rows = (patch.series.reshape(-1, n) @ Ty).reshape(-1, n, len(which))
                P, w = np.einsum("skn,kn->sn", rows, Tx).reshape(-1, 2, len(which)).transpose(1, 0, 2)
                if len(P) > 1:
                    first = P.argmin(axis=0)[None, :]
                    P, w = np.take_along_axis(P, first, 0), np.take_along_axis(w, first, 0)
                load[which], square[which] = P[0], w[0]

    # --- making patches ----------------------------------------------------------------------------------------------

    def _first(self) -> _Patch:
        """The whole square, cut along χ, with what continuation from the limit of vanishing damping finds on a coarse
        grid as a first guess."""
        t = _gauss(_COARSE)
        found = np.array([self._vanishing(chi) for chi in t]).T
        values, before = np.empty((2, _COARSE, _COARSE)), found
        for k, xi in enumerate(t):
            first = 2 * found - before if k > 1 else found
            before, found = found, self._solve(np.full(_COARSE, xi), t, first, steps=2, rough=True)
            values[:, k] = found
        filled = _filled(values)
        root = _Patch((0.0, 0.0), (1.0, 1.0), None, state="cut", axis=1)
        series = None
        if filled is not None:
            guess = self._finer(filled, NODES)
            finer = _square(self._solve(*root.nodes(_gauss(NODES)), guess.reshape(2, -1), rough=True))
            series = self._series(np.where(np.isnan(finer), guess, finer))
        root.parts = self._parts(root, 1, 2, series, math.inf)
        for part in root.parts:  # as much as has been asked for the whole
            part.asked = ASKED
        return root

    def _make(self, patch: _Patch) -> None:
        """Settle a patch or cut it."""
        values, tails = np.full((2, NODES * NODES), np.nan), (1e-7, 1e-7)
        if patch.guess is not None:
            values = self._solve_all(patch, patch.guess)
            values, tails = self._more(patch, values)
            if max(tails) < TOLERANCE and (patch.low[0] == 0 or len(self._others(patch, values)) == 1):
                if self._take(patch, [values]):
                    return
        # where the first guess fails in a few places only, in the halves it may do; and series that are too long say
        # nothing against the guess
        short = TOLERANCE <= max(tails) < 0.5 * patch.tail or (
            patch.tail == math.inf and 0 < np.isnan(values[0]).mean() < 0.2
        )
        if not short:
            found = self._search(patch, 0.5, 0.5)
            if found is None:
                corners = (self._search(patch, *place) is None for place in _CORNERS)
                if self._none_there(patch) and self._begins(patch, None) and all(corners):
                    patch.state = "none"
                    return
            else:
                values, tails = self._more(patch, self._follow(patch, 0.5, 0.5, found))
                if max(tails) < TOLERANCE:
                    sheets = self._others(patch, values)
                    ends = [self._tails(x) for x in sheets]
                    tails = max(a for a, _ in ends), max(b for _, b in ends)
                    if max(tails) < TOLERANCE and self._take(patch, sheets):
                        return
        self._cut(patch, values, tails if max(tails) < math.inf else (1e-7, 1e-7))

    def _more(self, patch: _Patch, values: Real) -> tuple[Real, tuple[float, float]]:
        """Values at as many nodes as the decay of their series asks for, if MOST are enough, and its tails."""
        tails = self._tails(values)
        if TOLERANCE <= max(tails) < TOLERANCE ** (NODES / MOST):
            more = math.ceil(NODES * math.log(TOLERANCE) / math.log(max(tails)))
            values = self._solve_all(patch, self._finer(values, more))
            tails = self._tails(values)
        return values, tails

    def _others(self, patch: _Patch, values: Real) -> list[Real]:
        """These crossings and those that come first in the corners of the patch, if they are others."""
        sheets = [values]
        for x, y in _CORNERS:
            found = self._search(patch, x, y)
            if found is None:
                continue
            Tx, Ty = chebyshev(np.array([[x], [y]]), MOST)[:, :, 0].T
            series = (self._series(sheet)[0] for sheet in sheets)
            here = (Tx[: len(s)] @ s @ Ty[: len(s)] for s in series)
            if not any(abs(load / found[0] - 1) < 1e-8 for load in here):
                sheets.append(self._more(patch, self._follow(patch, x, y, found))[0])
        return sheets

    def _take(self, patch: _Patch, sheets: list[Real]) -> bool:
        """Settle a patch with the values of one crossing or more, where the least is the first."""
        each = [self._series(values) for values in sheets]
        n = max(x.shape[-1] for x in each)
        series = np.stack([np.pad(x, ((0, 0), (0, n - x.shape[-1]), (0, n - x.shape[-1]))) for x in each])
        if self._begins(patch, series) and self._first_there(patch, series):
            patch.state, patch.series = "flutter", series
        return patch.state == "flutter"

    def _cut(self, patch: _Patch, values: Real, tails: tuple[float, float]) -> None:
        widths = [b - a for a, b in zip(patch.low, patch.high, strict=True)]
        # along the direction whose series is the longer
        axis = 0 if tails[0] > tails[1] or (tails[0] == tails[1] and widths[0] >= widths[1]) else 1
        axis = axis if widths[axis] > 2 * SMALLEST else 1 - axis
        if widths[axis] <= 2 * SMALLEST:
            patch.state = "unsettled"
            return
        # a series twice as good in each half would not do yet
        count = 4 if tails[axis] > math.sqrt(TOLERANCE) and widths[axis] > 4 * SMALLEST else 2
        filled = _filled(_square(values))
        patch.parts = self._parts(patch, axis, count, None if filled is None else self._series(filled), max(tails))
        patch.state, patch.axis = "cut", axis

    @staticmethod
    def _parts(patch: _Patch, axis: int, count: int, series: Real | None, tail: float) -> list[_Patch]:
        edges = np.linspace(patch.low[axis], patch.high[axis], count + 1).tolist()
        parts = []
        for k in range(count):
            low, high = list(patch.low), list(patch.high)
            low[axis], high[axis] = edges[k], edges[k + 1]
            guess = None
            if series is not None:
                n = series.shape[-1]
                whole, half = _between(NODES, n), chebyshev((_gauss(NODES) + k) / count, n)
                Tx, Ty = (half, whole) if axis == 0 else (whole, half)
                guess = Tx.T @ series @ Ty
            parts.append(_Patch((low[0], low[1]), (high[0], high[1]), guess, tail))
        return parts

    @staticmethod
    def _series(values: Real) -> Real:
        grid = _square(values)
        to = _to_series(grid.shape[-1])
        return np.asarray(to @ grid @ to.T)

    def _finer(self, values: Real, n: int) -> Real:
        """Values at n nodes in each direction, from a series through those at fewer."""
        series = self._series(values)
        T = _between(n, series.shape[-1])
        return np.asarray(T.T @ series @ T)

    def _tails(self, values: Real) -> tuple[float, float]:
        """Last coefficients along ξ and χ of values at the nodes, relative; of the frequency with a tenth of the
        weight. inf where values are missing."""
        if not np.isfinite(values).all():
            return math.inf, math.inf
        series = self._series(values)
        size = np.abs(series).max(axis=(1, 2))
        weight = np.array([1.0, 0.1]) / size
        a = np.abs(series) * weight[:, None, None]
        return float(a[:, -2:, :].max()), float(a[:, :, -2:].max())

    @cached_property
    def _undamped(self) -> tuple[tuple[float, float], Real, Real, Real]:
        """Where the undamped column flutters, load and ω² (inf, nan where it does not below the bound), and below that
        load P (m,), squared frequencies s and P s′ − s, (m, N): a branch grows where that is above β/α of vanishing
        damping."""
        p = self.pencil
        found = first_crossing(p, 0.0, 0.0, self.bound)
        flutters = found is not None and found.kind == "flutter"
        fold = (found.load, found.frequency**2) if found is not None and flutters else (math.inf, math.nan)
        top = self.bound if found is None else found.load
        P = top * (1 - (1 - np.linspace(0.02, 0.99, 48)) ** 2)  # closer together towards the coalescence
        s, V = np.linalg.eig(np.diag(p.e) + P[:, None, None] * p.H)
        slope = np.einsum("mij,jk,mki->mi", np.linalg.pinv(V), p.H, V).real
        order = s.real.argsort(axis=1)
        s, slope = np.take_along_axis(s.real, order, 1), np.take_along_axis(slope, order, 1)
        return fold, P, s, P[:, None] * slope - s

    def _vanishing(self, chi: float) -> tuple[float, float]:
        """Load and ω² of the first flutter of vanishing damping at this χ, to some digits."""
        fold, P, s, gain = self._undamped
        kappa = self.kappa0 * chi / (1 - chi)
        rows = np.flatnonzero((gain > kappa).any(axis=1))
        if not len(rows):
            return fold
        k = int(rows[0])
        j = int(gain[k].argmax())
        if k == 0:
            return float(P[0]), float(s[0, j])
        t = float((kappa - gain[k - 1, j]) / (gain[k, j] - gain[k - 1, j]))
        return float(P[k - 1] + t * (P[k] - P[k - 1])), float(s[k - 1, j] + t * (s[k, j] - s[k - 1, j]))

    # --- crossings in a batch ----------------------------------------------------------------------------------------

    def _damping(self, xi: Real, chi: Real) -> Real:
        """D of C = diag(D) in the basis of the pencil, (n, N)."""
        size = np.sqrt(self.kappa0 * xi / (1 - xi))
        return np.asarray(size[:, None] * ((1 - chi)[:, None] * (self.pencil.e / self.kappa0) + chi[:, None]))

    def _solve(self, xi: Real, chi: Real, guess: Real, steps: int = 7, rough: bool = False) -> Real:
        """Load and ω²/(1 − ξ) of the crossings near a guess (2, n); nan where the iteration does not settle.

        For det A = 0 in (P, ω), A = diag(e − ω² + iωD) + P H scaled to E = I: Newton's step from d ln det A =
        tr(A⁻¹ dA), corrected by the second differential, so that the third power of an error is left.
        """
        p, out = self.pencil, np.full(guess.shape, np.nan)
        live = np.flatnonzero(np.isfinite(guess).all(axis=0) & (guess > 0).all(axis=0))
        if not len(live):
            return out
        P, omega = guess[0, live], np.sqrt(guess[1, live] * (1 - xi[live]))
        i, D, before = np.arange(p.size), 1j * self._damping(xi[live], chi[live]) / p.e, np.full(len(live), np.inf)
        for number in range(steps):
            slope = omega[:, None] * (-1 / p.e)
            own, speed = 1 + omega[:, None] * (slope + D), D + 2 * slope
            A = np.zeros((len(live), p.size, p.size), dtype=complex)
            np.multiply(P[:, None, None], p.relative, out=A.real)
            A[:, i, i] += own
            try:
                B = np.linalg.inv(A)
            except np.linalg.LinAlgError:  # a root to the last digit
                A[:, i, i] *= 1 + 1e-14
                B = np.linalg.inv(A)
            diagonal = B[:, i, i]
            # P H is A without its diagonal part
            a, b = (p.size - (diagonal * own).sum(axis=1)) / P, (diagonal * speed).sum(axis=1)
            with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
                share = 1 / (a * b.conj()).imag
                change_P, change = b.imag * share, -a.imag * share
                # T = A⁻¹ dA of this step, whose trace is −1: dP/P less A⁻¹ times a diagonal, and tr T²
                part = change_P / P
                g = part[:, None] * own - change[:, None] * speed
                square = ((B * B.swapaxes(1, 2)) @ g[:, :, None])[:, :, 0]
                square = part * (p.size * part - 2 * (diagonal * g).sum(axis=1)) + (square * g).sum(axis=1)
                rest = square - 1 + 2 * change**2 * (diagonal @ (1 / p.e))
                bent = np.abs(rest) < 0.5
                rest = np.where(bent, rest / 2, 0)
                bend_P, bend = (rest * b.conj()).imag * share, -(rest * a.conj()).imag * share
                change_P, change = change_P + bend_P, change + bend
                step = np.abs(change_P / P) + np.abs(change / omega)
                # what the third order leaves, by the greatest second differential
                share = np.where(bent, np.abs(bend_P / P) + np.abs(bend / omega), np.inf) / step**2
                left = step**3 * share[step > 1e-7].max(initial=0.0) ** 2
                P, omega = P + change_P, omega + change
                good = (P > 0) & (omega > 0) & (step < 1e3)
            near, exact = (0.03 if number == steps - 1 else 1e-5, 1e-4) if rough else (1e-5, 1e-14)
            done = good & ((step < near) | (left < exact))
            out[:, live[done]] = P[done], omega[done] ** 2 / (1 - xi[live[done]])
            good &= ~done
            if number >= 3:  # no root is near
                good &= step < before / 2
            if not good.any():
                break
            live, P, omega, D, before = (x[good] for x in (live, P, omega, D, step))
        return out

    def _search(self, patch: _Patch, x: float, y: float) -> tuple[float, float] | None:
        """Load and ω²/(1 − ξ) of the first flutter at a place (0 to 1) of the patch, by a search; None where there is
        none."""
        (a, b), (A, B) = patch.low, patch.high
        xi, chi = a + (A - a) * x, b + (B - b) * y
        size = math.sqrt(self.kappa0 * xi / (1 - xi))
        found = first_crossing(self.pencil, (1 - chi) * size / self.kappa0, chi * size, self.bound)
        return None if found is None or found.kind == "divergence" else (found.load, found.frequency**2 / (1 - xi))

    def _follow(self, patch: _Patch, x: float, y: float, found: tuple[float, float]) -> Real:
        """Crossings at the nodes, followed from the one at a place (0 to 1) of the patch."""
        (a, b), (A, B) = patch.low, patch.high
        x, y = a + (A - a) * x, b + (B - b) * y
        xi, chi = patch.nodes(_gauss(_COARSE))
        before = value = np.repeat(np.array(found)[:, None], len(xi), axis=1)
        for t in (0.25, 0.5, 0.75, 1.0):
            now = self._solve(x + t * (xi - x), y + t * (chi - y), 2 * value - before, rough=True)
            before, value = value, np.where(np.isnan(now), value, now)
        return self._solve_all(patch, self._finer(value, NODES))

    def _solve_all(self, patch: _Patch, guess: Real) -> Real:
        """As `_solve`, for all nodes of a patch; those that do not settle try again from where their neighbours did."""
        xi, chi = patch.nodes(_gauss(guess.shape[-1]))
        values = self._solve(xi, chi, guess.reshape(2, -1))
        for _ in range(2):
            near = _filled(_square(values))
            lost = np.isnan(values[0])
            if near is None or not lost.any():
                break
            values[:, lost] = found = self._solve(xi[lost], chi[lost], near.reshape(2, -1)[:, lost], 10)
            if np.isnan(found[0]).mean() > 0.5:  # they have none, it seems
                break
        return values

    # --- whether they are the first --------------------------------------------------------------------------------

    def _eigenvalues(self, xi: Real, chi: Real, load: Real) -> Complex:
        """√e₁/λ of the 2N eigenvalues, (n, 2N): those of the low modes are exact however strong the damping."""
        p, n = self.pencil, self.pencil.size
        first, i = math.sqrt(p.e[0]), np.arange(p.size)
        K = load[:, None, None] * (p.H / p.e[0])
        K[:, i, i] += p.e / p.e[0]
        inverse = np.linalg.inv(K)
        A = np.zeros((len(load), 2 * n, 2 * n))
        A[:, :n, :n] = -inverse * (self._damping(xi, chi) / first)[:, None, :]
        A[:, :n, n:] = -inverse
        A[:, n + i, i] = 1
        return np.asarray(np.linalg.eigvals(A), dtype=complex)

    def _first_there(self, patch: _Patch, series: Real) -> bool:
        count = max(len(_COUNTED), math.ceil(series.shape[-1] / _TERMS_COUNTED))
        xi, chi = patch.nodes(_gauss(count))
        T, rows = _between(count, series.shape[-1]), np.arange(len(xi))
        load, square = (T.T @ series @ T).swapaxes(0, 1).reshape(2, len(series), -1)
        if not (load > 0).all() or not (square > 0).all():
            return False
        top = min(self.bound, self.divergence)
        if (load > top).all():
            return self._none_there(patch)
        first, least = load.argmin(axis=0), load.min(axis=0)
        below = least < top
        theta = self._eigenvalues(xi, chi, np.minimum(least, top) * (1 - 1e-7))
        damped = -theta.real / np.abs(theta)
        for number, frequency in enumerate(np.sqrt(square * (1 - xi))):
            crosses = below & (first == number)
            for sign in (1, -1):
                c = sign * -1j * math.sqrt(self.pencil.e[0]) / frequency
                k = np.abs(theta - c[:, None]).argmin(axis=1)
                near = np.abs(theta[rows, k] - c) < 1e-3 * np.abs(c)
                # a crossing that comes later is still damped, and known: no other needs to be feared from it
                if not np.where(crosses, near, damped[rows, k] > 0).all():
                    return False
                damped[rows, k] = np.inf
        if not below.all():  # λ = 0 comes first
            k = np.abs(theta).argmax(axis=1)
            damped[rows[~below], k[~below]] = np.inf
        return self._margin(damped, xi) and self._below(patch, float(least.min()))

    def _begins(self, patch: _Patch, series: Real | None) -> bool:
        """Whether at vanishing damping, if the patch has it, the first crossing is what the undamped branches say: one
        that ends as the damping grows may end before the first place counted."""
        if patch.low[0] > 0:
            return True
        top = min(self.bound, self.divergence)
        for t in _PROBED:
            chi = patch.low[1] + (patch.high[1] - patch.low[1]) * t
            first, _ = self._vanishing(chi)
            here = math.inf
            if series is not None:
                T = chebyshev(np.array([0.0, t]), series.shape[-1])
                here = float((T[:, 0] @ series[:, 0] @ T[:, 1]).min())
            if first < 0.98 * min(here, top):
                return False
        return True

    def _none_there(self, patch: _Patch) -> bool:
        xi, chi = patch.nodes(_COUNTED)
        top = min(self.bound, self.divergence)
        theta = self._eigenvalues(xi, chi, np.full(len(xi), top * (1 - 1e-7)))
        damped = -theta.real / np.abs(theta)
        if self.divergence <= self.bound:
            damped[np.arange(len(xi)), np.abs(theta).argmax(axis=1)] = np.inf
        return self._margin(damped, xi) and self._below(patch, top)

    @staticmethod
    def _margin(damped: Real, xi: Real) -> bool:
        """Whether the least damping ratios are positive and vary too little for a zero between the places counted."""
        least = damped.min(axis=1) / np.sqrt(xi)
        if not (least > 0).all():
            return False
        m = np.log(least.reshape(math.isqrt(len(least)), -1))
        return bool(max(np.abs(np.diff(m, axis=0)).max(), np.abs(np.diff(m, axis=1)).max()) < math.log(_VARIES))

    def _below(self, patch: _Patch, load: float) -> bool:
        """Whether the beam is stable in the middle of the patch at loads further below."""
        x, y = ((a + b) / 2 for a, b in zip(patch.low, patch.high, strict=True))
        m = len(_LEVELS)
        theta = self._eigenvalues(np.full(m, x), np.full(m, y), load * _LEVELS)
        return bool((theta.real < 0).all())
