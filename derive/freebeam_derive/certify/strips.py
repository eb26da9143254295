"""Where the eigenvalues s of the beam itself are: one in each of infinitely many strips, and m to the left of them.

In the normalised modes of the comparison beam the elastic motion under a load p, which may be complex, is

    (diag(μ) + T + p B − s) q = 0 on ℓ²,    μ_j = γ_j⁴,

B the load's form and T what the elastic energy holds besides bending, in the sense of forms: natural conditions that
hold the load are part of it. For the line Re s = R_k, μ_k < R_k < μ_{k+1}, let D_j = |μ_j − R_k|. On the line
|μ_j − s| ≥ D_j, so that no eigenvalue is on it where

    ‖D^(−1/2) T D^(−1/2)‖ + |p| ‖D^(−1/2) B D^(−1/2)‖ < 1.

The norms are bounded by those of Hilbert and Schmidt: entries in balls for i, j ≤ n, and Bessel's inequality beyond
(`Form`). From some line on one bound serves all (`Form.beyond`). docs/theorem.md has the proof.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property, lru_cache
from types import ModuleType
from typing import Any

import flint
import numpy as np
from flint import arb, arb_mat

from freebeam_derive.certify.balls import Exact, Range, Unproven, exact, parameters, stated_exactly
from freebeam_derive.certify.comparison_form import ORDERS, Along, Bounds, Modes, Points, bounds
from freebeam_derive.certify.numbers import reason

FLOATS = 40  # modes of the series that starts are taken from


class NoStrips(Unproven):
    """The eigenvalues could not be told apart for such a load, or the column is of a kind that is not served."""


@dataclass(frozen=True)
class _Side:
    """Σ over one index of |B_ij|²/D for the other, moved onto it: what a form is after parts took its derivatives off
    one factor φⱼ (or φᵢ) and put them on the other.

    inner: (order, factor) with ‖g‖ ≤ Σ factor γ^order for B_ij = ⟨g_i, φ_j⟩ + end terms, where order 1 stands for
    ‖φ'‖ ≤ γ · slope. ends: (end, order of the mode that stays, end, order of the mode that is summed over, factor).
    """

    inner: tuple[tuple[int, arb], ...]
    ends: tuple[tuple[int, int, int, int, arb], ...]


def _moved(along: Along, points: Points, summed: int) -> _Side:
    """All derivatives off the factor that is summed over (1: the trial function φⱼ, 0: the test function φᵢ)."""
    inner: dict[int, arb] = {}
    ends: dict[tuple[int, int, int, int], arb] = {}

    def add(table: dict[Any, arb], key: Any, value: arb) -> None:
        table[key] = table.get(key, arb(0)) + value

    for (k, *orders), f in along.items():
        stays, goes = orders[1 - summed], orders[summed]
        if goes == 0:
            add(inner, stays, _upper(abs(arb(f))))
        else:  # ∫ w φ' = [w φ] − ∫ w' φ with w = x^k φ^(stays)
            add(inner, stays + 1, _upper(abs(arb(f))))
            if k:
                add(inner, stays, k * _upper(abs(arb(f))))
            add(ends, (1, stays, 1, 0), arb(f))
            if k == 0:
                add(ends, (0, stays, 0, 0), -arb(f))
    for (a, p, b, q), f in points.items():
        add(ends, (a, p, b, q) if summed else (b, q, a, p), arb(f))
    kept = tuple((*key, _upper(abs(f))) for key, f in ends.items() if not f.is_zero())
    return _Side(tuple(inner.items()), kept)


def _upper(value: arb) -> arb:
    """An upper bound as an exact ball, and never below zero."""
    return arb(0).max(value.upper())


@lru_cache(maxsize=4)
def modes_of(kinds: tuple[str, str], count: int, bits: int) -> Modes:
    """The modes; bits is the precision in force."""
    return Modes(kinds, count)


class Form:
    """A bounded form in the comparison modes, and bounds of ‖D^(−1/2) B D^(−1/2)‖, at the precision in force.

    along, points: as a kernel's `forms` has them, orders 0 and 1 alone. Raises NoStrips for others.
    """

    def __init__(self, modes: Modes, along: Along, points: Points) -> None:
        if any(p > 1 or q > 1 for _, p, q in along) or any(p > 1 or q > 1 for _, p, _, q in points):
            raise NoStrips("the load acts on curvatures, which the bound of high modes does not serve")
        self.modes = modes
        self.nothing = not along and not points
        self.B = modes.form(along, points)
        n, w = modes.count, self.B.entries()
        self._squares = arb_mat(n, n, [_upper(v * v) for v in w])
        self._sides = _moved(along, points, 1), _moved(along, points, 0)
        # all modes beyond n, and (`every`) all modes there are
        self._beyond = bounds(modes.kinds, modes.gamma[-1])
        self.every = self._of_every()

    def _of_every(self) -> Bounds:
        """Bounds that hold of every mode."""
        modes, low = self.modes, self._beyond
        top = [arb(2), low.end[1], low.slope]
        for i in range(modes.count):
            for e in (0, 1):
                top[1] = top[1].max(_upper(abs(modes.ends[e][1][i])))
            top[2] = top[2].max(self._slopes[i])
        return Bounds((top[0], top[1]), top[2])

    @cached_property
    def _slopes(self) -> list[arb]:
        """‖φ'‖ / γ of each mode, from above: ∫ φ'² = [φ φ'] − ∫ φ φ''."""
        modes, found = self.modes, []
        for i, g in enumerate(modes.gamma):
            parts = [modes.ends[e][0][i] * modes.ends[e][1][i] for e in (0, 1)]
            found.append(_upper((1 + (parts[1] - parts[0]) / g).sqrt()))
        return found

    # ---------------------------------------------------------------- one line

    def norm(self, R: arb) -> arb:
        """An upper bound of ‖D^(−1/2) B D^(−1/2)‖ with D_j = |μ_j − R|, R < μ_n (R = 0: μ_j). Raises Unproven."""
        if self.nothing:
            return arb(0)
        modes, n = self.modes, self.modes.count
        gaps = [abs(g**4 - R) for g in modes.gamma]
        share = 1 - R / modes.gamma[-1] ** 4  # D_j ≥ share · μ_j for j > n
        if not share > 0 or not all(gap > 0 for gap in gaps):
            raise Unproven("a line is not known to pass between two modes")
        weights = [_upper(1 / gap) for gap in gaps]
        row = arb_mat([weights])
        total = (row * self._squares * row.transpose())[0, 0]
        # Σ_{j>n} γ_j^−s ≤ 1 / ((s−1) π g^(s−1)), for γ_j ≥ g + π (j − n)
        g = modes.lattice(n) - modes.beyond
        sums = {s: 1 / ((s - 1) * arb.pi() * g ** (s - 1)) for s in (2, 3, 4, 5, 6, 8)}
        far = [(self._beyond.end[q] ** 2 * sums[4 - 2 * q] / share).sqrt() for q in (0, 1)]  # √Σ_{j>n} |φⱼ^(q)|²/D_j
        first = modes.gamma[-1]
        for side in self._sides:
            for i in range(n):
                inner = sum((f * self._size(i, order) for order, f in side.inner), arb(0))
                along = inner / (share * first**4).sqrt()
                at_ends = sum((f * abs(modes.ends[a][p][i]) * modes.gamma[i] ** p * far[q]
                               for a, p, _, q, f in side.ends), arb(0))  # fmt: skip
                total += weights[i] * (along + at_ends) * (along + at_ends)
            # both beyond n, the index summed over the larger one
            inner = sum((f * self._far_size(order) * sums[8 - 2 * order].sqrt() for order, f in side.inner), arb(0))
            corner = inner / share
            corner += sum((f * far[p] * far[q] for _, p, _, q, f in side.ends), arb(0))
            total += corner * corner
        return _upper(total.sqrt())

    def _size(self, i: int, order: int) -> arb:
        """‖φ^(order)‖ of a mode."""
        g = self.modes.gamma[i]
        return (arb(1), self._slopes[i] * g, g * g)[order]

    def _far_size(self, order: int) -> arb:
        return (arb(1), self._beyond.slope, arb(1))[order]

    # ---------------------------------------------------------------- all lines from some on

    def beyond(self, k: int) -> arb:
        """An upper bound of the norm on the lines R = Γ⁴ of k and of every greater number."""
        if self.nothing:
            return arb(0)
        pi, away, every = arb.pi(), self.modes.spread, self.every
        G = self.modes.lattice(k) + pi / 2
        near, further = pi / 2 - away, pi / 2 + away
        if not (near > 0 and G > 3 * further):
            raise Unproven("the modes are too far from their asymptotes")
        logarithm = 1 / near + (G / near).log() / pi  # Σ_{j≤k} 1/(Γ − γ_j)
        squares = 1 / near**2 + 1 / (pi * near)  # Σ_{j>k} 1/(γ_j − Γ)²
        right = 1 / (2 * G * near) + (1 + 2 * G / near).log() / (2 * pi * G)  # Σ_{j>k} 1/(γ_j² − Γ²)
        sums = [logarithm / G**3 + right / (2 * G**2), logarithm / (4 * G) + right]  # Σ γ^(2p) / D
        least = 4 * near * (G - further) ** 3  # of all D_j
        # Σ γ^(2·order) / (D_i min_{j≥i} D_j)
        inner = (
            logarithm / (G**3 * least) + squares / (13 * G**6),
            logarithm / (4 * G * least) + squares / (13 * G**4),
            G * logarithm / (4 * least) + squares / (13 * G**2),
        )
        total = arb(0)
        for side in self._sides:
            sizes = (arb(1), every.slope, arb(1))
            part = sum((f * sizes[order] * inner[order].sqrt() for order, f in side.inner), arb(0))
            part += sum((f * every.end[p] * every.end[q] * (sums[p] * sums[q]).sqrt()
                         for _, p, _, q, f in side.ends), arb(0))  # fmt: skip
            total += part * part
        return _upper(total.sqrt())


# --- the strips of a column ---------------------------------------------------------------------------------


class Strips:
    """The lines of a column, and up to which |p| each is free of eigenvalues.

    kernel: an emitted module of the textbook's kind, in any basis. own: its parameters; where one is a range, all that
    is known holds of each value. Raises NoStrips for a column that is not of the kind above, Unproven.
    """

    def __init__(self, kernel: ModuleType, own: Mapping[str, Exact], count: int = 60) -> None:
        name, held = kernel.COLUMN["name"], parameters(kernel, own)
        ranged = any(isinstance(value, Range) for value in held.values())
        try:
            stated_exactly(kernel, {n: v.low if isinstance(v, Range) else v for n, v in held.items()})
            stated = kernel.forms(arb(1), **{n: exact(v) for n, v in held.items()}) if ranged else None
            stated = stated or kernel.forms(Fraction(1), **held)
            mass, elastic, load = ([_kept(part) for part in stated[letter]] for letter in ("M", "E", "H"))
        except (AttributeError, TypeError, ValueError) as error:
            raise NoStrips(f"{name}: a factor of its forms is no fraction: {reason(error)}") from None
        if mass != [{(0, 0, 0): 1}, {}] or not elastic[0].pop((0, 2, 2), 0) == 1:
            raise NoStrips(f"{name}: its mass or its bending stiffness is not that of the uniform comparison beam")
        self.kinds = (str(kernel.COLUMN["ends"][0]), str(kernel.COLUMN["ends"][1]))
        self.rigid = int(kernel.COLUMN["rigid"])
        if self.rigid and ranged:
            raise NoStrips(f"{name}: moves rigidly, which is not served over a range of its own parameters")
        self._rigid_rest(name, elastic, load)
        self.modes = modes_of(self.kinds, count, flint.ctx.prec)
        self.count = count
        self.T, self.B = (Form(self.modes, *(_balls(part) for part in form)) for form in (elastic, load))
        self._elastic = elastic

    def _rigid_rest(self, name: str, elastic: list[Any], load: list[Any]) -> None:
        """That the rigid motions have s = 0 alone, each once, at every load: their own forms are nilpotent.

        That bending does not act on them, nor they on it, was derived with the column.
        """
        functions = rigid_motions(self.kinds)
        if len(functions) != self.rigid:
            raise NoStrips(f"{name}: its rigid motions are not those of its ends")
        for form in (elastic, load):
            X = [[_of_lines(form, test, trial) / mass for trial, _ in functions] for test, mass in functions]
            trace = sum((X[i][i] for i in range(len(X))), Fraction(0))
            if trace != 0 or (len(X) == 2 and X[0][0] * X[1][1] != X[0][1] * X[1][0]):
                raise NoStrips(f"{name}: its rigid motions feel the load or springs")
            if form is elastic and any(v != 0 for row in X for v in row):
                raise NoStrips(f"{name}: its rigid motions feel springs")

    @cached_property
    def softening(self) -> Form:
        """Of T what is not known to be positive: all but squares of a deflection or slope times a factor that is so."""
        along, points = map(_balls, self._elastic)
        return Form(
            self.modes,
            {(k, p, q): f for (k, p, q), f in along.items() if p != q or not f >= 0},
            {(a, p, b, q): f for (a, p, b, q), f in points.items() if (a, p) != (b, q) or not f >= 0},
        )

    def estimates(self, P: complex, count: int) -> Any:
        """The lowest eigenvalues s at a load of a series, in floats: where to look."""
        return np.sort_complex(np.linalg.eigvals(self._floats[0] + P * self._floats[1]))[:count]

    @cached_property
    def _floats(self) -> tuple[Any, Any]:
        n = min(FLOATS, self.count)
        T, B = (
            np.array([[float(form.B[i, j].mid()) for j in range(n)] for i in range(n)]) for form in (self.T, self.B)
        )
        return np.diag([float(g) ** 4 for g in self.modes.gamma[:n]]) + T, B

    def line(self, k: int) -> arb:
        """R_k, k ≥ 1: the fourth power of the middle between the asymptotes of γ_k and γ_{k+1}; R_0 = 0."""
        return arb(0) if k == 0 else (self.modes.lattice(k) + arb.pi() / 2) ** 4

    def reach(self, k: int) -> arb:
        """Up to which |p| there is no eigenvalue on line k, from below; 0 where none is known."""
        R = self.line(k)
        return _reach(self.T.norm(R), self.B.norm(R))

    def reach_from(self, k: int) -> arb:
        """The same for all lines from k on."""
        return _reach(self.T.beyond(k), self.B.beyond(k))

    def reaches(self, load: arb) -> dict[int, arb]:
        """For each m from which all lines are free for |p| ≤ load: up to which |p| they all are. Raises NoStrips."""
        last = max(1, 3 * self.modes.count // 4)
        found: dict[int, arb] = {}
        least = self.reach_from(last)
        for k in range(last - 1, 0, -1):
            if not least > load:
                break
            found[k + 1] = least
            least = _least(least, self.reach(k))
        else:
            if least > load:
                found[1] = least
        if not found:
            raise NoStrips("high modes could not be told apart for such a load")
        return found


def _reach(still: arb, loaded: arb) -> arb:
    if loaded.is_zero():
        return arb(10) ** 30 if still < 1 else arb(0)
    value: arb = ((1 - still) / loaded).lower()
    return value if value > 0 else arb(0)


def _least(a: arb, b: arb) -> arb:
    value: arb = a.min(b).lower()
    return value


def _kept(part: Mapping[Any, Any]) -> dict[Any, Any]:
    """The factors that are not zero, as fractions, or as balls over a range."""
    return {
        key: value if isinstance(value, arb) else Fraction(value)
        for key, value in part.items()
        if not (value.is_zero() if isinstance(value, arb) else value == 0)
    }


def _balls(part: Mapping[Any, Any]) -> dict[Any, arb]:
    return {key: value if isinstance(value, arb) else exact(value) for key, value in part.items()}


Line = tuple[Fraction, Fraction]  # constant, slope


def rigid_motions(kinds: tuple[str, str]) -> list[tuple[Line, Fraction]]:
    """Straight lines that the ends allow, orthogonal, and ∫ of their squares."""
    held = [(e, d) for e, kind in enumerate(kinds) for d in ORDERS[kind] if d < 2]
    one, third = Fraction(1), Fraction(1, 3)
    lines = [(one, one * 0, one), (-one / 2, one, third / 4), (one * 0, one, third), (one, -one, third)]
    found = [((a, b), mass) for a, b, mass in lines if all((a + b * e if d == 0 else b) == 0 for e, d in held)]
    return found[:2]


def _of_lines(form: list[Any], test: Line, trial: Line) -> Fraction:
    """A form on two straight lines."""
    along, points = form

    def value(line: Line, d: int, x: Fraction) -> Fraction:
        return line[0] + line[1] * x if d == 0 else line[1] if d == 1 else Fraction(0)

    def coefficients(line: Line, d: int) -> tuple[Fraction, Fraction]:
        return (line[0], line[1]) if d == 0 else (line[1] if d == 1 else Fraction(0), Fraction(0))

    total = Fraction(0)
    for (k, p, q), f in along.items():
        (a, b), (c, d) = coefficients(test, p), coefficients(trial, q)
        total += f * (a * c / (k + 1) + (a * d + b * c) / (k + 2) + b * d / (k + 3))
    for (a, p, b, q), f in points.items():
        total += f * value(test, p, Fraction(a)) * value(trial, q, Fraction(b))
    return total
