"""Where the eigenvalues s of a column with a load are, from the gaps between its frequencies without load.

Without load they are ω_k², ω₁ < ω₂ < …; where the load's form is |b(y, v)| ≤ C a(y, y)^(1/2) (mass of v)^(1/2), no
eigenvalue s has Re s = ω_k ω_{k+1} for |p| C < ω_{k+1} − ω_k (Lemma 6; Lemma 12 at places). Of a
column on one segment the lowest K are told by its own F(0, s), K changes of sign; that there are no more below R_K, and
how wide the later gaps are, by the uniform beam beside it (variable_section.py, Lemma 7). Of one in uniform parts both
are told by its characteristic function in closed form (stepped_section.py, Lemma 8). docs/theorem.md has the proofs.
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import Any

import numpy as np
from flint import arb

from freebeam_derive.certify.balls import Exact, Range, Unproven, exact, greatest, precision, rational
from freebeam_derive.certify.column_forms import ColumnForms, over_both
from freebeam_derive.certify.exact_system import ExactSystem
from freebeam_derive.certify.load_size import load_size
from freebeam_derive.certify.stepped_section import SteppedSection
from freebeam_derive.certify.strips import NoStrips
from freebeam_derive.certify.variable_section import VariableSection

MOST = 60  # lines that are tried for the first from which on all gaps are wide enough
BITS = 128, 256  # for signs of F: what cancels grows with the frequency, of a cone's twentieth beyond the first
WIDTH = Fraction(1, 10**6)  # relative, of the interval about a frequency squared in which F changes sign
FLOATS = 30  # functions of the series that starts are taken from, beyond two for each eigenvalue


class FrequencyGaps:
    """The lines of a column between its frequencies without load, as `Strips` has them for a uniform beam.

    system: a column without damping. load: the largest |p|. lowest: m, from which on every line is free of eigenvalues
    for |p| ≤ load; reach: up to which |p| they are. count: K, from which on all are known to be free together.
    beyond: the gaps from there on are to be so many times as wide. Raises NoStrips for a column that is not served,
    and Unproven.
    """

    rigid = 0

    def __init__(self, system: ExactSystem, load: arb, beyond: int = 1) -> None:
        self.system = system
        self._float = {name: float(value) for name, value in system.own.items()}
        at_ends = [ColumnForms(system.kernel, own) for own in at_both(system.own)]
        forms = at_ends[0]
        self._sizes = [load_size(each) for each in at_ends]  # which fall with masses and the springs of joints
        self.size = greatest(each.constant for each in self._sizes)
        if len(at_ends) == 2 or forms.stepped or self._sizes[0].places or not system.undamped(Fraction(0), Fraction(0)):
            known, gap, self.reach = self._of_parts(at_ends, beyond * load)
            self._lines: dict[int, arb] = {}
        else:
            K, (top, gap) = self._first_far(VariableSection(forms), beyond * load * self.size)
            known = [tuple(exact(side).sqrt() for side in sides) for sides in self._enclosed(K, top)]
            self._lines, self.reach = {K: top}, (gap / self.size).lower()
        self.count = self.lowest = len(known)
        self._known, self._gaps = known, {self.count: gap}
        for k in range(self.count - 1, 0, -1):
            low, high = known[k - 1][1], known[k][0]
            reach = ((high - low) / self.needed(low, high)).lower()
            if not reach > load:
                break
            self.lowest, gap, self.reach = k, gap.min((high - low).lower()), self.reach.min(reach)
            self._lines[k], self._gaps[k] = low * high, gap
        if self.lowest not in self._lines:
            raise NoStrips("the gaps between frequencies are too narrow for such a load")

    def needed(self, low: arb, high: arb) -> arb:
        """What the gap between two frequencies must be wider than, over the load."""
        return greatest(each.at(low, high) for each in self._sizes)

    def _first_far(self, section: VariableSection, needed: arb) -> tuple[int, tuple[arb, arb]]:
        for k in range(2, MOST):
            R, gap = section.far_gap(k)
            if gap > needed:
                return k, (R, gap)
        raise NoStrips("the gaps between high frequencies could not be shown to be wide enough for such a load")

    def _of_parts(self, at_ends: list[ColumnForms], load: arb) -> tuple[list[tuple[arb, ...]], arb, arb]:
        """Bounds of all frequencies ω up to the first beyond which all gaps are as wide as needed; those gaps; and up
        to which load they are.

        Over a range masses and springs are between those at its ends, and so is each frequency (Courant and Fischer).
        """
        whole = at_ends[0] if len(at_ends) == 1 else over_both(*at_ends)
        beyond, gap = SteppedSection(whole).gap_beyond(lambda *pair: load * self.needed(*pair))
        parts = [SteppedSection(forms) for forms in at_ends]
        found = [each.lowest(beyond) for each in parts]
        count = max(map(len, found))
        both = (
            low if len(low) == count else part.lowest(beyond, count) for low, part in zip(found, parts, strict=True)
        )
        shared = zip(*both, strict=False)
        known: list[tuple[arb, ...]] = [
            (min(g.lower() for g in each) ** 2, max(g.upper() for g in each) ** 2) for each in shared
        ]
        return known, gap, (gap / self.needed(beyond**2, beyond**2 + gap)).lower()

    def _enclosed(self, count: int, top: arb) -> list[tuple[Fraction, Fraction]]:
        """Intervals in each of which F(0, s) changes sign, all below `top`: so many eigenvalues are there at least."""
        found: list[tuple[Fraction, Fraction]] = []
        for start in self.estimates(0.0, count).real:
            sides = [rational(float(start), 53) * (1 + sign * WIDTH) for sign in (-1, 1)]
            low = found[-1][1] if found else Fraction(0)
            if not (sides[0] > low and exact(sides[1]) < top and self._changes(*sides)):
                raise Unproven(f"the frequency {float(abs(start)) ** 0.5:.6g} without load could not be enclosed")
            found.append((sides[0], sides[1]))
        return found

    def _changes(self, *sides: Fraction) -> bool:
        """Whether F(0, s) is of one sign at one of two s, and of the other at the other."""
        for bits in BITS:
            with precision(bits):
                one, other = (self.system.taylor(arb(0), exact(side), ((0, 0),))[0, 0] for side in sides)
                if not (one.contains(0) or other.contains(0)):
                    return bool(one * other < 0)
        return False

    def line(self, k: int) -> arb:
        """R_k, from the lowest m to K: ω_k ω_{k+1} up to how closely these are known."""
        return self._lines[k]

    @property
    def lines(self) -> list[int]:
        """The k of all lines that are known, ascending."""
        return sorted(self._lines)

    def gap(self, k: int) -> arb:
        """At most ω_{n+1} − ω_n, for all n ≥ k."""
        return self._gaps[k]

    def frequency(self, k: int) -> arb:
        """At most ω_k, for k up to K."""
        return self._known[k - 1][0].lower()

    def interval(self, k: int) -> arb:
        """A ball that holds ω_k, for k up to K."""
        low, high = self._known[k - 1]
        return low.union(high)

    def estimates(self, P: float, count: int) -> Any:
        """The lowest eigenvalues s at a load of a series, in floats: 1/s are the largest of K⁻¹M, which s of M⁻¹K are
        not and so lose their digits to those that are."""
        kernel = self.system.kernel
        basis = kernel.basis(2 * count + FLOATS)
        M, K = (np.asarray(f(basis, P, **self._float), dtype=float) for f in (kernel.mass, kernel.stiffness))
        found = np.linalg.eigvals(np.linalg.solve(K, M))
        return np.sort_complex(1 / found[np.argsort(-abs(found))[:count]])


def at_both(own: Mapping[str, Exact]) -> list[dict[str, Fraction]]:
    """Values by their names, at both ends of the range where one is one."""
    found: list[dict[str, Any]] = [
        {name: (value.low, value.high)[n] if isinstance(value, Range) else value for name, value in own.items()}
        for n in (0, 1)
    ]
    return found if found[0] != found[1] else found[:1]
