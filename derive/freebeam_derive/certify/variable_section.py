"""A column of variable section with a mass at an end, as its proofs need it: a uniform beam and a small remainder.

The elastic energy is ∫ EI y''² dx and what is of lower order (springs, a foundation, a dead load), the mass m(x) and
at most one point mass at an end. With dz/dx = c (m/EI)^(1/4), z(1) = 1 and y = ρ w, ρ² = z'/m, it is

    ∫ m y² dx = ∫ w² dz,    ∫ EI y''² dx = c⁴ ∫ (w'' + g₁ w' + g₀ w)² dz,

a uniform beam whose eigenvalues are 1/c⁴ times those of the column, and a form T of orders 0 and 1. docs/theorem.md has
the lemmas: `far_gap` is a bound of Lemma 7, `load_size` of Lemma 6.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction
from functools import cached_property, lru_cache
from math import comb
from typing import Any

import flint
from flint import acb, arb, arb_series

from freebeam_derive.certify.balls import exact, parameters
from freebeam_derive.certify.comparison_form import ORDERS, Bounds, Modes
from freebeam_derive.certify.strips import Form, NoStrips, modes_of, rigid_motions

PIECES = 64  # of the beam, on each of which coefficients are one ball
MODES = 40  # of the uniform beam, for bounds that hold of all
Polynomial = list[Fraction]  # of x, ascending
Place = tuple[int, int]  # end, order of the derivative there
HELD = {("free", 0): "pinned", ("pinned", 1): "clamped", ("free", 1): "sliding"}
"""The kind of an end once the displacement of an order is held there."""


def _value(f: Polynomial, x: Any) -> Any:
    total = x * 0
    for a in reversed(f):
        total = total * x + exact(a)
    return total


def _over(f: Polynomial, x: arb, order: int = 1) -> list[arb]:
    """f and its first derivatives over j!, each in Taylor's form about the middle of x."""
    middle = x.mid()
    found = []
    for j in range(order):
        total = arb(0)
        for i in reversed(range(j, len(f))):
            total = total * (x - middle) + comb(i, j) * _value([comb(n, i) * f[n] for n in range(i, len(f))], middle)
        found.append(total)
    return found


def _never_negative(f: Polynomial) -> bool:
    """Whether all of Bernstein's coefficients on [0, 1] are at least zero."""
    n = len(f) - 1
    bernstein = [sum(Fraction(comb(i, j), comb(n, j)) * f[j] for j in range(i + 1)) for i in range(n + 1)]
    return all(b >= 0 for b in bernstein)


def _pieces() -> Iterator[arb]:
    for k in range(PIECES):
        yield arb(k).union(arb(k + 1)) / PIECES


class VariableSection:
    """What a kernel of one segment and the one field y says, at the precision in force.

    own: its parameters as rational numbers. Raises NoStrips for a column that is not of the kind above.
    """

    def __init__(self, kernel: Any, own: Mapping[str, Fraction]) -> None:
        self.name, self._own = kernel.COLUMN["name"], parameters(kernel, own)
        if list(kernel.FIELDS) != ["y"] or kernel.COORDINATES or len(kernel.COLUMN["breaks"]) != 2:
            raise self._other("is more than one segment with the one field y")
        try:
            forms = kernel.forms(Fraction(1), **self._own)
        except (AttributeError, TypeError, ValueError) as error:
            raise self._other(f"has a factor that is no fraction: {error}") from None
        if len(forms["M"]) != 1 or len(forms["K"]) != 2:
            raise self._other("has a mass that changes with the load, or a load that enters squared")
        self.kinds = (str(kernel.COLUMN["ends"][0]), str(kernel.COLUMN["ends"][1]))
        if rigid_motions(self.kinds):
            raise self._other("is held by springs alone, or not at all")
        (mass, points), (elastic, springs), (load, at_ends) = (self._read(*part) for part in (*forms["M"], *forms["K"]))
        self.m, self.EI = mass.pop((0, 0), []), elastic.pop((2, 2), [])
        if mass or any(max(pair) > 1 for pair in (*elastic, *load)):
            raise self._other("has an energy of another order than ∫ m yₜ² and ∫ EI y''²")
        for f in (self.m, self.EI):
            if not all(_over(f, x)[0] > 0 for x in _pieces()):
                raise self._other("has a mass or a stiffness that is not known to be positive")
        self.masses, self.springs = self._own_places(points), self._own_places(springs)
        if any(p != q for p, q in elastic):
            raise self._other("has an elastic energy that is not symmetric")
        self.elastic = {p: f for (p, _), f in elastic.items()}
        self.load, self.load_points = load, at_ends
        self._bending_share()

    def _other(self, what: str) -> NoStrips:
        return NoStrips(f"{self.name} {what}, which the comparison with a uniform beam does not serve")

    def _read(self, along: Any, points: Any) -> tuple[dict[Place, Polynomial], dict[tuple[Place, Place], Fraction]]:
        """(test order, trial order) -> polynomial; (test end, order), (trial end, order) -> factor."""
        inner: dict[Place, Polynomial] = {}
        for _, _, p, _, q, factors in along:
            inner[p, q] = _sum(inner.get((p, q), []), [Fraction(v) for v in factors])
        ends: dict[tuple[Place, Place], Fraction] = {}
        for (_, p, a, _), (_, q, b, _), factor in points:
            if a not in (0, 1) or b not in (0, 1) or max(p, q) > 1:
                raise self._other("has a force, a sensor or a mass that is not at an end")
            if not (self._is_held(int(a), p) or self._is_held(int(b), q)):
                key = (int(a), p), (int(b), q)
                ends[key] = ends.get(key, Fraction(0)) + Fraction(factor)
        return {key: f for key, f in inner.items() if any(f)}, {key: f for key, f in ends.items() if f}

    def _is_held(self, end: int, order: int) -> bool:
        return order in ORDERS[self.kinds[end]]

    def _own_places(self, points: Mapping[tuple[Place, Place], Fraction]) -> dict[Place, Fraction]:
        """Springs or masses, each of a place of its own."""
        if any(row != of or factor < 0 for (row, of), factor in points.items()):
            raise self._other("has a mass or a spring that couples two places or is negative")
        return {row: factor for (row, _), factor in points.items()}

    # ---------------------------------------------------------------- the load

    @cached_property
    def _reach(self) -> tuple[dict[int, arb], dict[int, arb]]:
        """κ with ‖y^(q)‖ ≤ κ ‖y''‖ on (0, 1), and with |y^(q)(x)| ≤ κ ‖y''‖ at any x."""
        one = arb(1)
        if "clamped" in self.kinds:  # y'(x)² ≤ |x − e| ‖y''‖²
            return {0: one / 3, 1: (one / 2).sqrt()}, {0: 2 * one / 3, 1: one}
        if "sliding" in self.kinds:  # the same, and y vanishes at the other end
            return {0: one / 2, 1: (one / 2).sqrt()}, {0: 2 * one / 3, 1: one}
        return {0: one / 2, 1: one}, {0: one / 2, 1: one}  # y' has a zero between two ends that are held

    @cached_property
    def _least(self) -> arb:
        """Of EI."""
        return min((_over(self.EI, x)[0].lower() for x in _pieces()), key=float)

    def _bending_share(self) -> None:
        """θ with a(y, y) ≥ θ ∫ EI y''² dx: 1 unless a dead load is part of the energy."""
        lost = arb(0)
        for p, f in self.elastic.items():
            if _never_negative(f):
                continue
            turned = [e for e in (0, 1) if self._is_held(e, 1)]
            if p == 0 or not turned or not _never_negative([-v for v in f]):
                raise self._other("has an elastic energy that is not known to be positive")
            away = [Fraction(0), Fraction(1)] if turned[0] == 0 else [Fraction(1), Fraction(-1)]
            lost -= exact(sum((v / (n + 1) for n, v in enumerate(_product(f, away))), Fraction(0)))
        self.share = 1 - lost / self._least
        if not self.share > 0:
            raise self._other("has an elastic energy that is not known to be positive")

    @cached_property
    def load_size(self) -> arb:
        """C with |b(y, v)| ≤ C a(y, y)^(1/2) (mass of v)^(1/2), or the same with y and v exchanged. Raises NoStrips."""
        try:
            return self._size(0)
        except NoStrips:
            return self._size(1)

    def _size(self, turned: int) -> arb:
        """turned: 1 for the form with y and v exchanged. All derivatives go off the factor of bounded mass."""
        inner: dict[int, Polynomial] = {}
        ends = {key[:: -1 if turned else 1]: f for key, f in self.load_points.items()}
        for orders, f in self.load.items():
            p, q = orders[:: -1 if turned else 1]
            if p == 1:  # ∫ f y^(q) v' = [f y^(q) v] − ∫ (f y^(q))' v
                for e, sign in ((0, -1), (1, 1)):
                    key = (e, 0), (e, q)
                    ends[key] = ends.get(key, Fraction(0)) + sign * (sum(f) if e else f[0])
                slope = [n * v for n, v in enumerate(f)][1:]
                for order, part in ((q, slope), (q + 1, f)):
                    inner[order] = _sum(inner.get(order, []), [-v for v in part])
            else:
                inner[q] = _sum(inner.get(q, []), f)
        least = self._least
        norms, points = self._reach
        along = arb(0)
        for q, f in inner.items():
            square = arb(0)
            for x in _pieces():
                share = _over(f, x)[0] ** 2 / _over(self.m, x)[0]
                square = square.max((share / _over(self.EI, x)[0] if q == 2 else share * norms[q] ** 2 / least).upper())
            along += square.sqrt()
        total = along * along
        for place in {row for (row, _), f in ends.items() if f and not self._is_held(*row)}:
            felt = sum((abs(exact(f)) * points[of[1]] for (row, of), f in ends.items() if row == place), arb(0))
            if place not in self.masses:
                raise self._other("has a load that acts on an end that carries no mass and is not of the follower kind")
            total += felt * felt / least / exact(self.masses[place])
        return (total / self.share).sqrt().upper()

    # ---------------------------------------------------------------- the uniform beam beside it

    @property
    def uniform(self) -> bool:
        return not any(self.m[1:]) and not any(self.EI[1:])

    @cached_property
    def scale(self) -> arb:
        """c: 1/c = ∫ (m/EI)^(1/4) dx."""
        if self.uniform:
            return (exact(self.EI[0]) / exact(self.m[0])).sqrt().sqrt()

        def fourth_root(x: acb, analytic: bool) -> acb:
            ratio: acb = _value(self.m, x) / _value(self.EI, x)
            return ratio.sqrt(analytic=analytic).sqrt(analytic=analytic)

        return 1 / acb.integral(fourth_root, 0, 1, rel_tol=arb(2) ** -40).real

    def _local(self, x: arb) -> tuple[arb, arb, arb, arb, arb, arb, arb]:
        """A, B, G of T = ∫ A w'v' + B (w'v + w v') + G w v dz + [g₁ w'v' + g₀ (w'v + w v')], then g₁, g₀, z', ρ'/ρ."""
        m, EI = (arb_series(_over(f, x, 5), prec=5) for f in (self.m, self.EI))
        e, f = EI.derivative() / EI, m.derivative() / m
        h = (f - e) / 4  # z''/z'
        r = (h - f) / 2  # ρ'/ρ
        a, b = 2 * r + h, r.derivative() + r * r
        da, db = a.derivative()[0], b.derivative()[0]
        H, R, a0, b0 = h[0], r[0], a[0], b[0]
        z = self.scale * (m[0] / EI[0]).sqrt().sqrt()
        A, B, G = (a0 * a0 - da + H * a0 - 2 * b0) / z**2, (a0 * b0 - db + 2 * H * b0) / z**3, b0 * b0 / z**4
        share = 1 / (m[0] * self.scale**4)
        for order, poly in self.elastic.items():
            k = _over(poly, x)[0] * share
            A, B, G = (A + k * z * z, B + k * z * R, G + k * R * R) if order else (A, B, G + k)
        return A, B, G, a0 / z, b0 / z**2, z, R

    @cached_property
    def _remainder(self) -> tuple[tuple[arb, arb, arb], dict[tuple[int, int, int], arb]]:
        """Bounds of |A|, |B|, |G| over the beam; (end, order, order) -> |factor| of T's end terms."""
        bounds = [arb(0)] * 3
        for x in _pieces():
            bounds = [old.max(abs(new).upper()) for old, new in zip(bounds, self._local(x)[:3], strict=True)]
        ends: dict[tuple[int, int, int], arb] = {}
        for e in (0, 1):
            *_, g1, g0, z, R = self._local(arb(e))
            sign = 1 if e else -1
            found = {(1, 1): sign * g1, (0, 1): sign * g0, (1, 0): sign * g0}
            size = z / _value(self.m, arb(e)) / self.scale**4  # ρ²/c⁴
            for (place, order), k in self.springs.items():
                if place == e:
                    turn = (z, R) if order else (arb(0), arb(1))  # y^(order) = ρ (turn₀ w' + turn₁ w)
                    for p in (0, 1):
                        for q in (0, 1):
                            found[p, q] = found.get((p, q), arb(0)) + exact(k) * size * turn[1 - p] * turn[1 - q]
            ends |= {(e, *pair): abs(f).upper() for pair, f in found.items() if not f.is_zero()}
        return (bounds[0], bounds[1], bounds[2]), ends

    def families(self) -> list[tuple[str, str]]:
        """The ends of the beam without the mass; with one also those of the beam that is held where the mass is."""
        if "sliding" in self.kinds and not self.uniform:
            raise self._other("slides at an end, and is not uniform")
        if not self.masses:
            return [self.kinds]
        if len(self.masses) > 1:
            raise self._other("has more than one mass at its ends, or one with a rotary inertia")
        ((end, order),) = self.masses
        held = list(self.kinds)
        held[end] = HELD[held[end], order]
        if held[end] == "sliding" and not self.uniform:
            raise self._other("has a rotary inertia at a free end, and is not uniform")
        return [self.kinds, (held[0], held[1])]

    def far_gap(self, k: int) -> tuple[arb, arb]:
        """R with k eigenvalues below, and a gap of frequencies about √R without any; for all later k it is wider.

        Of the column without load; the gap 0 where none is known. Raises NoStrips, Unproven.
        """
        kinds = self.families()
        modes = [modes_of(ends, MODES, flint.ctx.prec) for ends in kinds]
        numbers = [k, k - 1][: len(modes)]
        left, right = ([f.lattice(n + step) for f, n in zip(modes, numbers, strict=True)] for step in (0, 1))
        low, high = max(left, key=float), min(right, key=float)
        G = (low + high) / 2
        rest = min((_free(f, G, (near, far), self._remainder, ends) for f, near, far, ends in
                    zip(modes, left, right, kinds, strict=True)), key=float)  # fmt: skip
        return self.scale**4 * G**4, (self.scale**2 * rest / G**2).lower()


@lru_cache(maxsize=8)
def _every(kinds: tuple[str, str], bits: int) -> Bounds:
    """Bounds that hold of all modes; bits is the precision in force."""
    return Form(modes_of(kinds, MODES, bits), {}, {}).every


def _free(modes: Modes, G: arb, beside: tuple[arb, arb], remainder: Any, kinds: Sequence[str]) -> arb:
    """η with no eigenvalue of a uniform beam and T within η of Γ⁴, Γ = G between two asymptotes; 0 where none is known.

    With t the least distance of a root from Γ, Lemma 5's sums; its bounds fall with Γ for Γ > e t.
    """
    pi, away = arb.pi(), modes.spread
    t, further = (G - beside[0]).min(beside[1] - G) - away, G - beside[0] + away
    if not (t > 0 and G > 3 * t and G > further):
        return arb(0)
    least = 4 * t * (G - further) ** 3  # of all |μ_j − Γ⁴|
    logarithm = 1 / t + (G / t).log() / pi
    beyond = 1 / (2 * G * t) + (1 + 2 * G / t).log() / (2 * pi * G)
    sums = logarithm / G**3 + beyond / (2 * G**2), logarithm / (4 * G) + beyond  # Σ γ^(2p) / D
    every = _every(modes.kinds, flint.ctx.prec)
    at_end = [bound * total.sqrt() for bound, total in zip(every.end, sums, strict=True)]
    size = 1 / least.sqrt()  # of ‖w‖, and ‖w‖ ‖w''‖ ≤ product, where Σ D_j w_j² = 1
    product = (1 / (least * (1 - (1 + t / G) ** -4))).sqrt()
    slope = (product + kinds.count("free") * at_end[0] * at_end[1]).sqrt()
    (A, B, C), ends = remainder
    norm = A * slope**2 + 2 * B * slope * size + C * size**2
    felt = [(f, p, q) for (e, p, q), f in ends.items() if not {p, q} & {*ORDERS[kinds[e]]}]
    norm += sum((f * at_end[p] * at_end[q] for f, p, q in felt), arb(0))
    free: arb = ((1 - norm) * least).lower()
    return free if free > 0 else arb(0)


def _sum(f: Polynomial, g: Polynomial) -> Polynomial:
    return [(f[n] if n < len(f) else Fraction(0)) + (g[n] if n < len(g) else 0) for n in range(max(len(f), len(g)))]


def _product(f: Polynomial, g: Polynomial) -> Polynomial:
    total = [Fraction(0)] * (len(f) + len(g) - 1)
    for i, a in enumerate(f):
        for j, b in enumerate(g):
            total[i + j] += a * b
    return total
