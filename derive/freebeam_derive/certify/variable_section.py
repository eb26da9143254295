"""A column of variable section with a mass at an end, as its proofs need it: a uniform beam and a small remainder.

The elastic energy is ∫ EI y''² dx and what is of lower order (springs, a foundation, a dead load), the mass m(x) and
at most one point mass at an end. With dz/dx = c (m/EI)^(1/4), z(1) = 1 and y = ρ w, ρ² = z'/m, it is

    ∫ m y² dx = ∫ w² dz,    ∫ EI y''² dx = c⁴ ∫ (w'' + g₁ w' + g₀ w)² dz,

a uniform beam whose eigenvalues are 1/c⁴ times those of the column, and a form T of orders 0 and 1. docs/theorem.md has
the lemmas: `far_gap` is a bound of Lemma 7, `load_size` of Lemma 6.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property, lru_cache
from typing import Any

import flint
from flint import acb, arb, arb_series

from freebeam_derive.certify.balls import exact, greatest, least
from freebeam_derive.certify.column_forms import ColumnForms, over, value
from freebeam_derive.certify.comparison_form import ORDERS, Bounds, Modes
from freebeam_derive.certify.strips import Form, modes_of

MODES = 40  # of the uniform beam, for bounds that hold of all
HELD = {("free", 0): "pinned", ("pinned", 1): "clamped", ("free", 1): "sliding", ("sliding", 0): "clamped"}
"""The kind of an end once the displacement of an order is held there."""


class VariableSection:
    """A column on one segment, at the precision in force. forms: of it, with one mass at most."""

    def __init__(self, forms: ColumnForms) -> None:
        self.forms, self.kinds, self.masses = forms, forms.kinds, forms.masses
        (self.m,), (self.EI,), (self.elastic,) = forms.m, forms.EI, forms.elastic

    @property
    def uniform(self) -> bool:
        return not any(self.m[1:]) and not any(self.EI[1:])

    @cached_property
    def scale(self) -> arb:
        """c: 1/c = ∫ (m/EI)^(1/4) dx."""
        if self.uniform:
            return (exact(self.EI[0]) / exact(self.m[0])).sqrt().sqrt()

        def fourth_root(x: acb, analytic: bool) -> acb:
            ratio: acb = value(self.m, x) / value(self.EI, x)
            return ratio.sqrt(analytic=analytic).sqrt(analytic=analytic)

        return 1 / acb.integral(fourth_root, 0, 1, rel_tol=arb(2) ** -40).real

    def _local(self, x: arb) -> tuple[arb, arb, arb, arb, arb, arb, arb]:
        """A, B, G of T = ∫ A w'v' + B (w'v + w v') + G w v dz + [g₁ w'v' + g₀ (w'v + w v')], then g₁, g₀, z', ρ'/ρ."""
        m, EI = (arb_series(over(f, x, 5), prec=5) for f in (self.m, self.EI))
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
            k = over(poly, x)[0] * share
            A, B, G = (A + k * z * z, B + k * z * R, G + k * R * R) if order else (A, B, G + k)
        return A, B, G, a0 / z, b0 / z**2, z, R

    @cached_property
    def _remainder(self) -> tuple[tuple[arb, arb, arb], dict[tuple[int, int, int], arb]]:
        """Bounds of |A|, |B|, |G| over the beam; (end, order, order) -> |factor| of T's end terms."""
        bounds = [arb(0)] * 3
        for _, x in self.forms.pieces():
            bounds = [old.max(abs(new).upper()) for old, new in zip(bounds, self._local(x)[:3], strict=True)]
        ends: dict[tuple[int, int, int], arb] = {}
        for e in (0, 1):
            *_, g1, g0, z, R = self._local(arb(e))
            sign = 1 if e else -1
            found = {(1, 1): sign * g1, (0, 1): sign * g0, (1, 0): sign * g0}
            size = z / value(self.m, arb(e)) / self.scale**4  # ρ²/c⁴
            for (place, order), k in self.forms.springs.items():
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
            raise self.forms.other("slides at an end, and is not uniform")
        if not self.masses:
            return [self.kinds]
        if len(self.masses) > 1:
            raise self.forms.other("has more than one mass")
        ((end, order),) = self.masses
        held = list(self.kinds)
        held[int(end)] = HELD[held[int(end)], order]
        if held[int(end)] == "sliding" and not self.uniform:
            raise self.forms.other("has a rotary inertia at a free end, and is not uniform")
        return [self.kinds, (held[0], held[1])]

    def far_gap(self, k: int) -> tuple[arb, arb]:
        """R with k eigenvalues below, and a gap of frequencies about √R without any; for all later k it is wider.

        Of the column without load; the gap 0 where none is known. Raises NoStrips, Unproven.
        """
        kinds = self.families()
        modes = [modes_of(ends, MODES, flint.ctx.prec) for ends in kinds]
        numbers = [k, k - 1][: len(modes)]
        left, right = ([f.lattice(n + step) for f, n in zip(modes, numbers, strict=True)] for step in (0, 1))
        low, high = greatest(left), least(right)
        G = (low + high) / 2
        rest = least(
            _free(f, G, (near, far), self._remainder, ends)
            for f, near, far, ends in zip(modes, left, right, kinds, strict=True)
        )
        # the line of Lemma 6 is the product of the two bounds of frequencies, √(R − η) and √(R + η)
        return self.scale**4 * (G**8 - rest * rest).sqrt(), (self.scale**2 * rest / G**2).lower()


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
