"""Frequencies without load of a column in uniform parts, with masses and springs where they meet and at the ends.

On a part y'''' = (κγ)⁴ y with κ⁴ = m/EI and ω = γ². The state z = (y, y'/γ, EI y''/γ², EI y'''/γ³) of two solutions
that meet the conditions at x = 0 is followed by its six minors, in units of e^θ, θ = κLγ, which keeps them of size one:

    e^(−θ) K∧K = e^(iθ) V Uᵀ + e^(−iθ) V̄ Ūᵀ + e^(−θ) (…) + e^(−2θ) (…).

f(γ), the minor of the conditions at x = 1, vanishes at the frequencies and nowhere else. Without what is as small as
e^(−θ) it is a trigonometric polynomial of the parts' phases θ, with coefficients that hang on 1/γ alone: so finitely
many cells of phases tell of all γ from some on how near two zeros come. docs/theorem.md, Lemma 8.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from copy import copy
from fractions import Fraction
from functools import reduce
from itertools import combinations, pairwise
from math import prod
from typing import Any

from flint import acb, acb_series, arb

from freebeam_derive.certify.balls import Unproven, ball, exact, least
from freebeam_derive.certify.column_forms import ColumnForms, Place
from freebeam_derive.certify.comparison_form import ORDERS

PARTS = 8  # at most: there are as many waves as a power of two by it
APART = 6  # zeros are looked for to be 1/6 of their mean distance apart, or
TRIES = 6  # times half of it
SMALLEST = 8  # θ of each part from which on e^(−θ) is left to a bound: 3e-4
CUTS = 3  # of 1/γ, to both sides of each of which cells are tried
DEEPEST = 21  # halvings of phases: seven of each of three
MOST_WAVES = 400_000  # of cells together, some seconds: four steps stay below, five do not
FINEST = 40  # halvings of a stretch of γ
LONGEST = 3000  # phase of the beam up to which low frequencies are looked for: a thousand of them, in some seconds
STEP = Fraction(3, 16)  # of the beam's phase, in which the low frequencies are looked for

MINORS = tuple(combinations(range(4), 2))
_ROOTS = (1, 1j, -1j, -1)  # λ of the solutions e^(λθ)
Wave = tuple[int, ...]
"""σ of e^(iσ·θ): 1 or −1 for each part."""


def _wedge(a: Sequence[complex], b: Sequence[complex]) -> list[complex]:
    return [a[i] * b[j] - a[j] * b[i] for i, j in MINORS]


def _of_pair(pair: tuple[int, int]) -> tuple[complex, list[complex], list[complex]]:
    """λ − 1, V and U of a term of e^(−θ) K∧K: K = Σ e^(λθ) v uᵀ. Exact in floats."""
    roots = [complex(_ROOTS[n]) for n in pair]
    V = _wedge(*([root**d for d in range(4)] for root in roots))
    U = _wedge(*([root.conjugate() ** d / 4 for d in range(4)] for root in roots))
    return sum(roots) - 1, V, U


_MIXED = {0: (0, 0, 1), 1: (0, 1, 1), 4: (1, 0, -1), 5: (1, 1, -1)}
"""Minors of one of z₀, z₃ and one of z₁, z₂: which of either pair, and −1 where z₃ comes after these."""
_TERMS = {pair: _of_pair(pair) for pair in MINORS}


class SteppedSection:
    """The parts of a column and what stands between them, at the precision in force.

    forms: of the column. Raises NoStrips for one whose parts are not uniform, or that has more than eight.
    """

    def __init__(self, forms: ColumnForms) -> None:
        if len(forms.m) > PARTS:
            raise forms.other(f"is made of more than {PARTS} parts")
        if any(any(f[1:]) for f in (*forms.m, *forms.EI)):
            raise forms.other(
                "has more than one segment or mass, or springs alone to hold it, and a part that is not uniform"
            )
        if any(forms.elastic):
            raise forms.other(
                "has more than one segment or mass, or springs alone to hold it, and a foundation or a dead load"
            )
        self.forms = forms
        self._sizes = []  # of the minors, beside those of κ = EI = 1
        self.rates: list[arb] = []  # of the phases, by γ
        alike = [
            (m[0] / f[0], high - low)
            for m, f, (low, high) in zip(forms.m, forms.EI, pairwise(forms.breaks), strict=True)
        ]
        self.same = [alike.index(part) for part in alike]  # of each part the first whose phase is always its own
        for m, f, (low, high) in zip(forms.m, forms.EI, pairwise(forms.breaks), strict=True):
            EI = exact(f[0])
            k = (exact(m[0]) / EI).sqrt().sqrt()
            of = (arb(1), k, EI * k**2, EI * k**3)
            self._sizes.append([of[i] * of[j] for i, j in MINORS])
            self.rates.append(k * exact(high - low))
        held = [ORDERS[kind] for kind in forms.kinds]
        self._start = [int(not {*pair} & {*held[0]}) for pair in MINORS]
        self._end = MINORS.index(held[1])

    # ---------------------------------------------------------------- parts and joints

    def _through(self, part: int, pair: tuple[int, int], z: Sequence[Any]) -> list[Any]:
        """V Uᵀ z of a part."""
        _, V, U = _TERMS[pair]
        sizes = self._sizes[part]
        felt = sum((acb(u) / size * v for u, size, v in zip(U, sizes, z, strict=True)), acb_series([0]))
        return [acb(v) * size * felt for v, size in zip(V, sizes, strict=True)]

    def _joint(self, node: int, e: Any) -> list[tuple[int, int, Any]]:
        """What masses, springs and a joint there do to the minors, as (row, column, factor); e = 1/γ.

        EI y'' jumps by (c − Jω²) y', EI y''' by −(k − μω²) y; where a joint k' is, y' by EI y''/k' or y by −EI y'''/k'.
        All times ε³ where J or a joint of y is, and times ε where μ or a joint of y' is.
        """
        place, forms = self.forms.breaks[node], self.forms
        mu, J, k, c = (
            acb(_ball(table.get((place, d), Fraction(0)))) for table in (forms.masses, forms.springs) for d in (0, 1)
        )
        by_turn, by_mass = (0 if J == 0 else 3), (0 if mu == 0 else 1)
        bend = _block(_power(e, by_turn), None, c * _power(e, by_turn + 1) - J)  # of y'/γ and EI y''/γ²
        push = _block(_power(e, by_mass), None, mu - k * _power(e, by_mass + 3))  # of the two others
        if (place, 1) in forms.joints:
            bend = _block(_power(e, 1), acb(1 / _ball(forms.joints[place, 1])), None)
        if (place, 0) in forms.joints:
            push = _block(_power(e, 3), acb(-1 / _ball(forms.joints[place, 0])), None)
        whole = bend[0][0] * push[0][0]
        found = [(2, 2, whole), (3, 3, whole)]
        for i, (p, q, sign) in _MIXED.items():
            for j, (r, s, other) in _MIXED.items():
                if push[p][r] is not None and bend[q][s] is not None:
                    found.append((i, j, sign * other * push[p][r] * bend[q][s]))
        return found

    # ---------------------------------------------------------------- the low frequencies

    def value(self, g: arb) -> tuple[arb, arb]:
        """f and its slope by γ, on a stretch."""
        x = acb_series([g, 1], prec=2)
        z: list[Any] = [acb_series([v], prec=2) for v in self._start]
        for node in range(len(self.forms.breaks)):
            if node:
                total = [acb_series([0], prec=2)] * 6
                for pair, (power, *_) in _TERMS.items():
                    grown = (acb(power) * self.rates[node - 1] * x).exp()
                    total = [t + grown * v for t, v in zip(total, self._through(node - 1, pair, z), strict=True)]
                z = total
            z = _applied(self._joint(node, 1 / x), z)
        return z[self._end][0].real, z[self._end][1].real

    def lowest(self, above: arb, count: int = 1) -> list[arb]:
        """γ of all frequencies, ascending, each alone in its ball, until one is above a bound and there are so many.

        Raises Unproven.
        """
        low = Fraction(float(self.forms.lowest.sqrt().lower())) * Fraction(63, 64)
        width = STEP / Fraction(float(sum(self.rates, arb(0)).mid()))
        found: list[arb] = []
        while len(found) < count or not found[-1] > above:
            found += self._between(low, low + width, 0)
            low += width
        return found

    def _between(self, low: Fraction, high: Fraction, depth: int) -> list[arb]:
        a, b = exact(low), exact(high)
        g = a.union(b)
        middle = g.mid()
        value, slope = self.value(g)
        if not (value.contains(0) and (self.value(middle)[0] + slope * (g - middle)).contains(0)):
            return []
        if not slope.contains(0):
            sides = self.value(a)[0] * self.value(b)[0]
            if sides > 0:
                return []
            if sides < 0:
                return [self._narrow(g, slope)]
        if depth == FINEST:
            raise Unproven(f"the frequencies about {float(middle) ** 2:.6g} without load could not be told apart")
        at = low + (high - low) * Fraction(33, 64)
        return self._between(low, at, depth + 1) + self._between(at, high, depth + 1)

    def _narrow(self, g: arb, slope: arb) -> arb:
        """The zero in a stretch that holds one, by Newton's steps."""
        for _ in range(6):
            middle = g.mid()
            g = g.intersection(middle - self.value(middle)[0] / slope)
            slope = self.value(g)[1]
        return g

    # ---------------------------------------------------------------- the high ones

    def gap_beyond(self, needed: Callable[[arb, arb], arb]) -> tuple[arb, arb]:
        """G, and a gap between any two neighbours ω ≥ G² that is wider than needed. Raises Unproven.

        needed: for two ω; over the √ω of the upper one it does not rise, so that what serves at G serves beyond.
        """
        apart = arb.pi() / (APART * sum(self.rates, arb(0)))
        for _ in range(TRIES):
            G = SMALLEST / least(self.rates)
            G = (needed(G**2, (G + apart) ** 2) / (2 * apart)).max(G).upper()
            while G < LONGEST and not apart * (2 * G + apart) > needed(G**2, (G + apart) ** 2):
                G = (G * arb(9) / 8).upper()
            if not G * sum(self.rates, arb(0)) < LONGEST:
                raise Unproven(
                    "a part is so short, or the load so high, that too many low ones had to be found one by one"
                )
            if self._all_apart(G, apart):
                return G, (apart * (2 * G + apart)).lower()
            apart = apart / 2
        raise Unproven(
            "the high ones are not known to be apart, as where a mass with a rotary inertia parts the column"
        )

    def _all_apart(self, G: arb, apart: arb) -> bool:
        """Whether any two zeros of f beyond G are more than `apart` from each other, and each is simple."""
        waiting = [(arb(0), 1 / G, 0)]
        while waiting:
            low, high, depth = waiting.pop()
            # on the way to γ + apart, ε falls to ε / (1 + ε apart)
            waves, rest = self._waves((low / (1 + low * apart)).union(high), G)
            if not _cells_apart(waves, rest, self.rates, apart, self.same):
                if depth == CUTS:
                    return False
                middle = (low + high) / 2
                waiting += [(low, middle, depth + 1), (middle, high, depth + 1)]
        return True

    def _waves(self, e: arb, G: arb) -> tuple[dict[Wave, Any], tuple[arb, arb]]:
        """f = Σ B e^(iσ·θ) + rest for ε in a stretch: σ -> B with its slope by γ; bounds of the rest and its slope."""
        series = acb_series([e, -e * e], prec=2)
        waves: dict[Wave, list[Any]] = {(): [acb_series([v], prec=2) for v in self._start]}
        rest = ([arb(0)] * 6, [arb(0)] * 6)
        for node in range(len(self.forms.breaks)):
            if node:
                rest = self._rest(node - 1, G, waves, rest)
                waves = {
                    (*wave, sign): self._through(node - 1, (0, 1 if sign > 0 else 2), z)
                    for wave, z in waves.items()
                    for sign in (1, -1)
                }
            joint = self._joint(node, series)
            waves = {wave: _applied(joint, z) for wave, z in waves.items()}
            values, slopes = ([(i, j, abs(f[n]).upper()) for i, j, f in joint] for n in (0, 1))
            rest = _applied(values, rest[0]), _sum(_applied(values, rest[1]), _applied(slopes, rest[0]))
        end = self._end
        return {wave: z[end] for wave, z in waves.items()}, (rest[0][end].upper(), rest[1][end].upper())

    def _rest(
        self, part: int, G: arb, waves: dict[Wave, Any], rest: tuple[list[arb], list[arb]]
    ) -> tuple[list[arb], list[arb]]:
        """Bounds of what a part's terms with e^(−θ) make of the waves, and all of its terms of the rest.

        A term e^((λ−1)θ) and its slope are at most e^(−θ Re(1−λ)), θ ≥ rate G, and |λ − 1| rate times that.
        """
        rate = self.rates[part].upper()
        fall = (-self.rates[part] * G).exp().upper()
        values, slopes = [arb(0)] * 6, [arb(0)] * 6
        main, main_slope = [arb(0)] * 6, [arb(0)] * 6
        for wave, z in waves.items():
            turn = abs(_along(wave, self.rates)).upper()
            main = _sum(main, [abs(v[0]).upper() for v in z])
            main_slope = _sum(main_slope, [abs(v[1]).upper() + turn * abs(v[0]).upper() for v in z])
        sizes = self._sizes[part]
        for power, V, U in _TERMS.values():
            small = power.real < 0  # the others make waves of waves
            felt = [_sum(rest[0], main), _sum(rest[1], main_slope)] if small else rest
            size = fall ** round(-power.real)
            value, slope = (
                size * sum((abs(acb(u)) / s * v for u, s, v in zip(U, sizes, y, strict=True)), arb(0)) for y in felt
            )
            turn = abs(acb(power)) * rate
            out = [abs(acb(v)) * s for v, s in zip(V, sizes, strict=True)]
            values = _sum(values, [(v * value).upper() for v in out])
            slopes = _sum(slopes, [(v * (slope + turn * value)).upper() for v in out])
        return values, slopes


def motion(sections: Sequence[SteppedSection], omega: arb, at: Place) -> arb:
    """The square of y⁽ⁱ⁾ at a place in the mode of mass 1 with a frequency: dω²/dk of a spring k there.

    sections: the column, or both ends of a range. f is linear in k and in the range's parameter, and nothing at the
    frequency.
    """
    g, grown, slopes = omega.sqrt(), [], []
    for section in sections:
        stiffer, forms = copy(section), copy(section.forms)
        forms.springs = forms.springs | {at: forms.springs.get(at, Fraction(0)) + 1}
        stiffer.forms = forms
        grown.append(stiffer.value(g)[0])
        slopes.append(section.value(g)[1])
    found: arb = -4 * g**3 * reduce(arb.union, grown) / reduce(arb.union, slopes)
    return found


def _cells_apart(
    waves: dict[Wave, Any], rest: tuple[arb, arb], rates: list[arb], apart: arb, same: Sequence[int]
) -> bool:
    """Whether from each point of the phases on, up to `apart` further, f or its slope is not zero. same: as of
    `SteppedSection`.

    Half a turn of a phase changes the sign of the waves alone, and the wave of −σ is the conjugate of that of σ.
    """
    own = sorted({*same})
    kept = [
        (wave, 2 * B[0], 2 * (B[1] + acb(0, 1) * _along(wave, rates) * B[0]))
        for wave, B in waves.items()
        if wave[0] > 0
    ]
    blurs = [ball(arb(0), size) for size in rest]
    waiting: list[tuple[list[tuple[Fraction, Fraction]], int]] = [([(Fraction(0), Fraction(1))] * len(own), 0)]
    summed = 0
    while waiting:
        cell, depth = waiting.pop()
        phases = {n: exact(a).union(exact(b)) * arb.pi() + rates[n] * arb(0).union(apart)
                  for n, (a, b) in zip(own, cell, strict=True)}  # fmt: skip
        on = [phases[n] for n in same]
        turned = [(acb(0, _along(wave, on)).exp(), B, slope) for wave, B, slope in kept]
        if not sum(((B * unit).real for unit, B, _ in turned), blurs[0]).contains(0):
            continue
        if not sum(((slope * unit).real for unit, _, slope in turned), blurs[1]).contains(0):
            continue
        summed += len(kept)
        if summed > MOST_WAVES:
            raise Unproven("its parts are too many, or too unlike, for the high ones to be told apart")
        if depth == DEEPEST:
            return False
        n = depth % len(cell)
        a, b = cell[n]
        for half in ((a, (a + b) / 2), ((a + b) / 2, b)):
            waiting.append(([*cell[:n], half, *cell[n + 1 :]], depth + 1))
    return True


def _ball(value: Any) -> arb:
    return value if isinstance(value, arb) else exact(value)


def _along(wave: Wave, values: Sequence[arb]) -> arb:
    """σ · values."""
    return sum((sign * v for sign, v in zip(wave, values, strict=False)), arb(0))


def _applied(matrix: list[tuple[int, int, Any]], z: Sequence[Any]) -> list[Any]:
    found = [z[0] * 0] * 6
    for i, j, factor in matrix:
        found[i] = found[i] + factor * z[j]
    return found


def _sum(a: Sequence[arb], b: Sequence[arb]) -> list[arb]:
    return [u + v for u, v in zip(a, b, strict=True)]


def _block(size: Any, above: Any, below: Any) -> list[list[Any]]:
    return [[size, above], [below, size]]


def _power(e: Any, n: int) -> Any:
    """Of a ball that may hold zero, of which flint's own powers are not finite."""
    return prod([e] * n, start=acb_series([1], prec=2))
