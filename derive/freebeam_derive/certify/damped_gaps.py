"""Which high modes of a column with damping stay away from the imaginary axis, from the gaps between its frequencies.

With C = c_E E + c_M M + R, y = Y e^(λt), p = P/(1 + c_E λ), q = λ/(1 + c_E λ), s = −(λ² + c_M λ)/(1 + c_E λ) it is

    (E + p B + q R) Y = s M Y,

E, B, M as of the column without damping (frequency_gaps.py). R is what damping leaves out or adds: point masses, a
foundation or a weight that are not damped, external damping where the mass is not uniform. docs/theorem.md, Lemmas 10,
11 and 13 and Theorem 2, has the proofs; `LeftOver` is R, `DampedGaps` the line beyond which none is on the axis.
"""

from __future__ import annotations

from collections.abc import Sequence
from copy import copy
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from itertools import pairwise
from typing import Any

from flint import arb

from freebeam_derive.certify.balls import Exact, exact, greatest, least
from freebeam_derive.certify.column_forms import ColumnForms, added, over
from freebeam_derive.certify.exact_system import ExactSystem
from freebeam_derive.certify.frequency_gaps import FrequencyGaps, at_both
from freebeam_derive.certify.load_size import CUBICS, Value, load_size, size_along
from freebeam_derive.certify.stepped_section import SteppedSection, motion
from freebeam_derive.certify.strips import NoStrips

BEYOND = (2, 4)  # times twice the load for which high gaps are asked for; of those listed in the tests all take 2
BEYOND_BARE = (2, 4, 16, 64)  # the same with damping at places without a mass, whose bounds grow less than ω² alone


def of_mass_alone(kernel: Any, own: Any, alpha: Exact = Fraction(0), beta: Exact = Fraction(1)) -> bool:
    """Whether damping, external alone where none is given, is the mass times a positive number, of any column."""
    try:
        stated = kernel.forms(Fraction(1), alpha, beta, **own)
        (C,), (M,) = (map(_terms, stated[letter]) for letter in "CM")
    except (AttributeError, TypeError, ValueError):  # more than one form, or factors that are no fractions
        return False
    ratios = {C[key] / M[key] for key in M} if C.keys() == M.keys() else {Fraction(0)}
    return len(ratios) == 1 and ratios.pop() > 0


def _terms(form: Any) -> dict[Any, Fraction]:
    """Its terms: (segment, fields, orders, power of x), or (test, trial) at places -> factor."""
    along, points = form
    found: dict[Any, Fraction] = {}
    for segments, *what, factors in along:
        for key, f in (((n, *what, k), f) for n in segments for k, f in enumerate(factors)):
            found[key] = found.get(key, Fraction(0)) + Fraction(f)
    for test, trial, f in points:
        found[test, trial] = found.get((test, trial), Fraction(0)) + Fraction(f)
    return {key: f for key, f in found.items() if f}


class LeftOver:
    """The damping of a column as c_E E + c_M M + R, at the precision in force; `over_range` of a range of columns.

    c_E, c_M: at least 0. low, high: of R over the mass along the beam. at: (place, order) -> the same at masses.
    turning: C_R with |R₁(y, v)| ≤ C_R a(y, y)^(1/2) (mass of v)^(1/2) of the part R₁ = ∫ f y'v'. bare: (place, order)
    -> f of R₂ = Σ f y⁽ⁱ⁾ v⁽ⁱ⁾ at places without a mass, which are served in the limit alone. Raises NoStrips.
    """

    def __init__(
        self, forms: ColumnForms, kernel: Any, own: Any, alpha: Exact, beta: Exact, vanishing: bool = False
    ) -> None:
        if not isinstance(alpha, Fraction) or not isinstance(beta, Fraction):
            raise forms.other("has a damping that is no fraction")
        self.forms = [forms]
        stated, at_rest = (kernel.forms(Fraction(1), *of, **own) for of in ((alpha, beta), (Fraction(0), Fraction(0))))
        if any(stated[part] != at_rest[part] for part in "MK") or len(stated["C"]) != 1:
            raise forms.other("has a damping that is no form of its own")
        along, points = forms.read(*stated["C"][0])
        if any(row != of or f < 0 for (row, of), f in points.items()) or any(
            p != q or p > 2 or not forms.never_negative(n, f)
            for n, part in enumerate(along)
            for (p, q), f in part.items()
        ):
            raise forms.other("has a damping that couples motions, or is not known to take energy")
        bending = {_ratio(part.get((2, 2), []), EI) for part, EI in zip(along, forms.EI, strict=True)}
        if len(bending) != 1 or None in bending:
            raise forms.other("has an internal damping that is not the bending stiffness times a number")
        share = bending.pop()
        assert share is not None
        self.c_E = exact(share)

        def less(part: dict[Any, Any], elastic: dict[int, Any], p: int) -> list[Fraction]:
            return added(part.get((p, p), []), [-share * f for f in elastic.get(p, [])])

        turning, density = ([less(*parts, p) for parts in zip(along, forms.elastic, strict=True)] for p in (1, 0))
        self.turning = arb(0)
        if any(map(any, turning)):
            if any((1, 1) in part for part in along):
                raise forms.other("has a damping of the slope along the beam")
            self.turning = size_along(forms, [{(1, 1): f} for f in turning])
        values = [over(density[n], x)[0] / over(forms.m[n], x)[0] for n, x in forms.pieces()]
        low, high = least(values).lower(), greatest(values).upper()
        self.c_M = ((low + high) / 2).mid().max(arb(0))
        self.low, self.high = low - self.c_M, high - self.c_M
        left = {key: points.get((key, key), Fraction(0)) - share * forms.springs.get(key, Fraction(0))
                for key in {row for row, _ in points} | {*forms.springs} | {*forms.masses}}  # fmt: skip
        self.bare = {key: exact(f) for key, f in left.items() if f and key not in forms.masses}
        if self.bare and not (vanishing and share > 0):
            raise forms.other(
                "has a damper, or a spring without internal damping, where no mass is, and other than in the limit of "
                "vanishing internal damping"
            )
        self.at = {key: exact(left[key] / mass) - self.c_M for key, mass in forms.masses.items()}

    @property
    def size(self) -> arb:
        """δ with |R(y, v)| ≤ δ times the roots of the masses of y and v, R₁ apart."""
        return greatest(abs(v).upper() for v in (self.low, self.high, *self.at.values()))

    def share(self, omega: arb) -> arb:
        """Of the motion's mass at most this is at points, for every mode without load and with a frequency from ω on.

        Over a range it grows with springs, and falls with masses.
        """
        return greatest(_share(forms, omega) for forms in self.forms)

    def least(self, omega: arb, blur: arb) -> arb:
        """A lower bound of Re R(u, z)/(z, u), R₁ apart, where u and z are modes from ω on and rests of size `blur`."""
        share, beam = self.share(omega), abs(self.low).max(abs(self.high))
        points = greatest([arb(0), *(abs(v).upper() for v in self.at.values())])
        at_mode = self.low + share * least([arb(0), *(v - self.low for v in self.at.values())])
        felt = (beam**2 + points**2 * share).sqrt()
        missed = 2 * felt * blur + (self.size + (beam + points * share)) * blur**2
        found: arb = (at_mode - missed / (1 - blur**2)).lower()
        return found

    def taken(self, omega: arb, blur: arb, r: arb, mode: arb | None = None) -> arb:
        """At least −Re R₂(u, z)/(z, u) over ω, of such modes; it falls with ω beside c_E ω. r: the gap over ω.
        mode: the frequency of one of them, of which alone it is."""
        total = arb(0)
        for (place, order), f in self.bare.items():
            most = greatest(_reach(forms, place, order, omega) for forms in self.forms)
            blurred = most**2 * (2 + r) * blur / (1 - blur)
            itself = most**2
            if mode is not None:
                itself = itself.min(motion(self._parts, mode, (place, order)).upper())
            total += abs(f) * (blurred + (arb(0) if f > 0 else itself))
        return (total / omega).upper()

    @cached_property
    def _parts(self) -> list[SteppedSection]:
        """Raises NoStrips where the column is not of uniform parts."""
        return [SteppedSection(forms) for forms in self.forms]


def _reach(forms: ColumnForms, place: Fraction, order: int, omega: arb) -> arb:
    """A bound of |y⁽ⁱ⁾| at a place, where y has a mass of 1 and an energy of ω²."""
    beside = (n for n, ends in enumerate(pairwise(forms.breaks)) if place in ends)
    return least(Value(order, arb(1), (n,)).most(forms, omega, arb(1)) for n in beside).upper()


def _share(forms: ColumnForms, omega: arb) -> arb:
    """With v one at the place and no more than a length about it, m φ(e) = a(φ, v)/ω² − ∫ m φ v."""
    total = arb(0)
    for (place, order), mass in forms.masses.items():
        near = [abs(place - other) for other in forms.breaks if other != place]
        beside = [n for n, part in enumerate(pairwise(forms.breaks)) if place in part]
        m, EI = (greatest(over(f[n], x)[0].upper() for n, x in forms.pieces() if n in beside)
                 for f in (forms.m, forms.EI))  # fmt: skip
        slope = place, 1
        turns = len(beside) == 1 and not (slope in forms.masses or slope in forms.springs or forms.is_held(*slope))
        bumps = [exact(b) for b in CUBICS[order, not turns]]
        length = (3 * (EI * bumps[2] / (m * bumps[0])).sqrt() / omega).sqrt().min(exact(min(near))).lower()
        power = length ** (2 * order)
        energy = exact(forms.springs.get((place, order), Fraction(0)))
        energy += len(beside) * EI * bumps[2] * power / length**3
        for n in beside:
            for p, f in forms.elastic[n].items():
                most = greatest(abs(over(f, x)[0]).upper() for at, x in forms.pieces() if at == n)
                energy += most * bumps[p] * power * length ** (1 - 2 * p)
        weight = len(beside) * m * bumps[0] * power * length
        total += (weight.sqrt() + energy.sqrt() / omega) ** 2 / exact(mass)
    return total.min(arb(1)).upper()


def over_range(each: Sequence[LeftOver]) -> LeftOver:
    """Of all between two columns and dampings that go linearly from one to the other: what is said of both.

    c_E a and R are linear then, and a place's R over its mass is between those at the ends. Raises NoStrips.
    """
    if len(each) == 1:
        return each[0]
    one, other = each
    if one.at.keys() != other.at.keys():
        raise one.forms[0].other("has a mass that is nothing at an end of the range, and damping")
    found = copy(one)
    found.forms = [*dict.fromkeys([*one.forms, *other.forms])]
    found.c_E, found.c_M = one.c_E.union(other.c_E), one.c_M.union(other.c_M)
    found.low, found.high = one.low.min(other.low), one.high.max(other.high)
    found.turning = one.turning.max(other.turning)
    found.at, found.bare = (
        {key: a.get(key, arb(0)).union(b.get(key, arb(0))) for key in {**a, **b}}
        for a, b in ((one.at, other.at), (one.bare, other.bare))
    )
    return found


@dataclass(frozen=True)
class DampedGaps:
    """gaps: those of the column without damping. lowest: m, such that for 0 ≤ P ≤ load no eigenvalue λ = iω has
    Re s ≥ R_m, and none in Re λ ≥ 0 passes the line R_m. reach: a load up to which the lines are free. vanishing: the
    same to first order in the damping."""

    gaps: FrequencyGaps
    damping: LeftOver
    lowest: int
    reach: arb
    load: arb
    vanishing: bool

    @property
    def top(self) -> arb:
        """Ω such that no eigenvalue iω with ω ≥ Ω has Re s < R_m, or none is there at all; in the limit R_m itself.
        Raises NoStrips."""
        c_E, c_M, R = self.damping.c_E, self.damping.c_M, self.gaps.line(self.lowest)
        if self.vanishing:
            return R.upper()
        if not c_E > 0:
            return R.sqrt().upper()
        found = []
        rest = 1 - c_E * c_M - c_E * c_E * R  # Re s = ω² (1 − c_E c_M) / (1 + c_E² ω²) ≥ R from there on
        if rest > 0:
            found.append((R / rest).sqrt().upper())
        omega = (1 / (8 * c_E)).upper()
        while omega < 2**20 / c_E:  # |1 + iz| = h, 2 (|s| − Re s) ≥ 2 ω² (h − 1)/h², |Im s| ≥ ω² z/h²
            z = c_E * omega
            h = (1 + z * z).sqrt()
            loads = self.load * self.gaps.size / omega + self.damping.turning
            if loads / (2 * (h - 1)).sqrt() + self.damping.size * h / (z * omega) < 1:
                found.append(omega)
                break
            omega = (omega * arb(9) / 8).upper()
        if not found:
            raise NoStrips("no frequency is known beyond which there is no crossing")
        return least(found)


def damped_gaps(still: ExactSystem, load: arb, alpha: Exact, beta: Exact, vanishing: bool) -> DampedGaps:
    """The least m that is found; still: the column with no alpha and beta. vanishing: in the limit of this damping
    times a factor that falls to zero. Raises NoStrips, Unproven."""
    columns = [(own, ColumnForms(still.kernel, own)) for own in at_both(still.own)]
    given = [(of["alpha"], of["beta"]) for of in at_both({"alpha": alpha, "beta": beta})]
    of_mass = all(of_mass_alone(still.kernel, own, *of) for own, _ in columns for of in given)
    for _, forms in columns:
        if not of_mass and (forms.joints or load_size(forms).places):
            raise forms.other("has a joint, or a load where no mass is, and other than external damping alone")
    damping = over_range([LeftOver(forms, still.kernel, own, *of, vanishing) for of in given for own, forms in columns])
    if of_mass:  # p is real, and high eigenvalues with it
        gaps = FrequencyGaps(still, load)
        return DampedGaps(gaps, damping, gaps.lowest, gaps.reach, load, vanishing)
    if not (damping.c_E > 0 or damping.c_M + damping.low > 0):
        raise damping.forms[0].other("has a part without damping")
    for beyond in BEYOND_BARE if damping.bare else BEYOND:
        gaps = FrequencyGaps(still, 2 * load, beyond)
        for m in gaps.lines:
            if _stays(gaps, damping, m, load, vanishing):
                reach = load * (gaps.gap(m) / _load(gaps, damping, m, load, vanishing))
                return DampedGaps(gaps, damping, m, reach.lower(), load, vanishing)
    raise NoStrips("high modes are not known to stay on their side of the boundary")


def _load(gaps: FrequencyGaps, damping: LeftOver, m: int, load: arb, vanishing: bool) -> arb:
    """X of Lemma 10: all of p B + q R on the modes beyond line m, per frequency."""
    X = load * gaps.size
    if vanishing:
        return X
    if damping.turning > 0:
        X += damping.turning / damping.c_E
    return X + damping.size * (1 + gaps.gap(m) / gaps.frequency(m)).sqrt()


def _stays(gaps: FrequencyGaps, damping: LeftOver, m: int, load: arb, vanishing: bool) -> bool:
    """The inequality of Lemmas 11 and 13, for all modes beyond line m, of the first of them."""
    omega = gaps.frequency(m) + gaps.gap(m)  # at most that of mode m + 1
    if _damped(gaps, damping, m, omega, load, vanishing):
        return True
    if not damping.bare or m == gaps.count:
        return False
    try:  # R₂ is known better of a mode of which the frequency is
        return _damped(gaps, damping, m, gaps.frequency(m + 1), load, vanishing, m + 1) and _stays(
            gaps, damping, m + 1, load, vanishing
        )
    except NoStrips:
        return False


def _damped(
    gaps: FrequencyGaps, damping: LeftOver, m: int, omega: arb, load: arb, vanishing: bool, mode: int | None = None
) -> bool:
    """The same for modes beyond line m from ω on, or for one alone."""
    g, X = gaps.gap(m), _load(gaps, damping, m, load, vanishing)
    if not 2 * X < g:
        return False
    r = g / omega
    of_rest = ((1 + r) / (g * (2 + r) - X)).max(1 / (g * (2 - r) - X)) * X
    if not 2 * of_rest**2 < 1:
        return False
    blur = of_rest / (1 - of_rest**2).sqrt()
    grows = 1 / (1 - 2 * of_rest**2)
    first = damping.c_E * (omega - X - load * gaps.size * grows) - damping.turning * grows
    first -= damping.taken(omega, blur, r, None if mode is None else gaps.interval(mode))
    if not first >= 0:
        return False
    here: arb = damping.least(omega, blur).min(arb(0))
    return bool(damping.c_M + omega * first + here > 0)


def _ratio(f: list[Fraction], g: list[Fraction]) -> Fraction | None:
    """c with f = c g."""
    c = f[0] / g[0] if f and g[0] else Fraction(0)
    return c if not any(added(f, [-c * v for v in g])) else None
