"""Damping of a column of variable or stepped section, for the verifier: what it is, and what it does to high modes.

Of the verifier of certificates of the beam itself (`verifier_of_sections`); it shares no code with the prover. The
form of damping in a file is C = c_E E + c_M M + R: R is what is left, such as masses or a weight that are not damped.
docs/theorem.md, Lemmas 10, 11 and 13, say when no high mode reaches the axis.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from typing import Any

from flint import arb, fmpq, fmpq_poly

from freebeam_derive.certify import verifier_claims as v
from freebeam_derive.certify.decimals import said
from freebeam_derive.certify.verifier_claims import ball, exact, greatest, least, require
from freebeam_derive.certify.verifier_load_size import PARTS, load_size, most, value
from freebeam_derive.certify.verifier_sections import Place, Sections, at

CUBICS: dict[tuple[int, bool], list[Any]] = {
    (0, True): [1, 0, -3, 2],
    (1, True): [0, 1, -2, 1],
    (0, False): [1, Fraction(-3, 2), 0, Fraction(1, 2)],
}
"""By the order that is 1 at 0, and whether the other of v and v' is nothing there; at 1 both are."""


@dataclass(frozen=True)
class Damped:
    """C = c_E E + c_M M + R, c_E and c_M at least 0; vanishing: only its direction.

    along: of R, order -> polynomial, a table a segment. points: of R at places. beside: C − c_E E likewise.
    """

    column: Sections
    c_E: Fraction
    c_M: Fraction
    vanishing: bool
    along: list[dict[int, fmpq_poly]]
    points: dict[Place, Fraction]
    beside: tuple[list[dict[int, fmpq_poly]], dict[Place, Fraction]]

    @property
    def of_E(self) -> arb:
        """c_E"""
        return ball(self.c_E)

    @property
    def of_M(self) -> arb:
        """c_M"""
        return ball(self.c_M)

    @property
    def of_mass(self) -> bool:
        """Whether it is external damping alone, by which all of the mass is damped alike."""
        return self.plain and self.c_E == 0 < self.c_M

    # ---------------------------------------------------------------- in words

    @property
    def plain(self) -> bool:
        """Whether R is nothing."""
        return not (any(f.degree() >= 0 for table in self.along for f in table.values()) or any(self.points.values()))

    @property
    def words(self) -> list[str]:
        """C − c_E E of a test function v and a motion y."""
        along, points = self.beside
        found = []
        for (low, high), table in zip(
            zip(self.column.breaks, self.column.breaks[1:], strict=False), along, strict=True
        ):
            for order, f in table.items():
                if f.degree() >= 0:
                    found.append(f"the integral of {_written(f)} {_product(order)} over {said(low)} < x < {said(high)}")
        last = [said(place) for place in self.column.breaks]
        return found + [f"{said(f)} {_product(order)} at x = {last[n]}" for (n, order), f in points.items() if f]

    # ---------------------------------------------------------------- how large R is

    @cached_property
    def turning(self) -> arb:
        """C_R: |R₁(y, v)| ≤ C_R a(y, y)^(1/2) (mass of v)^(1/2) of the part with y'v'. Raises Refused."""
        turning = [{(1, 1): table[1]} if 1 in table and table[1].degree() >= 0 else {} for table in self.along]
        if not any(turning):
            return arb(0)
        size = load_size([replace(self.column, load=turning, forces={})])
        require(not size.places, "a slope is damped up to a place without a mass")
        return size.constant

    @cached_property
    def density(self) -> tuple[arb, arb]:
        """Of the part along the beam with y v the least and the largest, over the mass."""
        return ratios(self.column, [table.get(0, fmpq_poly([0])) for table in self.along])

    @cached_property
    def at_masses(self) -> list[arb]:
        """R over the mass, at places with one."""
        return [ball(self.points.get(key, Fraction(0)) / mass) for key, mass in self.column.masses.items() if mass]

    @property
    def size(self) -> arb:
        """δ: |R₀(y, v)| ≤ δ times the roots of the masses of y and v, of the part without y'v'."""
        return _most([abs(value) for value in (*self.density, *self.at_masses)])

    def share(self, omega: arb) -> arb:
        """What part of its mass a mode without load has at places, at most, for all frequencies from ω on.

        With v⁽ⁱ⁾ = 1 at a place, nothing at others: |m φ⁽ⁱ⁾| ≤ a(v, v)^(1/2)/ω + (∫ m v² dx)^(1/2).
        """
        total = arb(0)
        for place, mass in self.column.masses.items():
            if mass:
                bounds = [
                    (weight.sqrt() + energy.sqrt() / omega) ** 2 / ball(mass) for weight, energy in self._bumps(place)
                ]
                total += least(bounds).upper()
        return total.min(arb(1)).upper()

    def _bumps(self, place: Place) -> list[tuple[arb, arb]]:
        """∫ m v² dx and a(v, v) of a cubic beside a place, of several lengths."""
        (node, order), of = place, self.column
        sides = [(n, sign) for n, sign in ((node - 1, -1), (node, 1)) if 0 <= n < len(of.m)]
        reach = min(of.breaks[n + 1] - of.breaks[n] for n, _ in sides)
        slope = node, 1
        turns = len(sides) == 1 and order == 0 and not (of.held(slope) or of.masses.get(slope) or of.springs.get(slope))
        bump = fmpq_poly([exact(Fraction(c)) for c in CUBICS[order, not turns]])
        squares = [f * f for f in (bump, bump.derivative(), bump.derivative().derivative())]
        found = []
        for length in (reach * part for part in PARTS):
            weight, energy = Fraction(0), of.springs.get(place, Fraction(0))
            for n, sign in sides:
                local = fmpq_poly([exact(of.breaks[node]), exact(sign * length)])
                terms = [(0, of.m[n]), (2, of.EI[n]), *of.elastic[n].items()]
                whole = [(f(local) * squares[p]).integral()(1) for p, f in terms]
                parts = [fraction(f) * length ** (1 + 2 * (order - p)) for (p, _), f in zip(terms, whole, strict=True)]
                weight, energy = weight + parts[0], energy + sum(parts[1:], Fraction(0))
            found.append((ball(weight), ball(energy)))
        return found

    def least(self, omega: arb, blur: arb) -> arb:
        """At most Re R₀(u, z)/(z, u), where u and z are modes from ω on, of mass 1, and rests of size `blur`."""
        share, (low, high) = self.share(omega), self.density
        along, points = _most([abs(low), abs(high)]), _most([abs(value) for value in self.at_masses])
        of_mode = low + share * least([arb(0), *(value - low for value in self.at_masses)])
        felt = (along**2 + share * points**2).sqrt()
        missed = 2 * felt * blur + (self.size + along + share * points) * blur**2
        return arb((of_mode - missed / (1 - blur**2)).lower())

    # ---------------------------------------------------------------- at places without a mass

    @property
    def bare(self) -> dict[Place, Fraction]:
        """R there."""
        return {key: f for key, f in self.points.items() if f and not self.column.masses.get(key)}

    def reach(self, place: Place, omega: arb) -> arb:
        """A bound of |y⁽ⁱ⁾| at a place, y of mass 1 and energy ω²; it grows as ω^((2i+1)/4) at most."""
        return most(value(self.column, place, {0: Fraction(1)}), omega, arb(1))

    def taken(self, omega: arb, blur: arb, r: arb, squares: dict[Place, arb]) -> arb:
        """At least −Re R(u, z)/(z, u) of these places over ω. squares: of φ⁽ⁱ⁾, where they are known of a mode φ."""
        total = arb(0)
        for place, f in self.bare.items():
            most = self.reach(place, omega) ** 2
            itself = most.min(squares[place].upper()) if place in squares else most
            total += abs(ball(f)) * (most * (2 + r) * blur / (1 - blur) + (itself if f < 0 else 0))
        return (total / omega).upper()

    def served_from(self, loaded: arb) -> arb:
        """An ω from which the bounds alone make Lemma 13 hold, for gaps somewhat wider than it needs."""
        omega = 4 * loaded.upper()
        for _ in range(16):
            try:
                self._check_from(omega, {}, 3 * loaded, loaded, loaded)
                return omega
            except v.Refused:
                omega *= 2
        raise v.Refused("a damper or a spring where no mass is takes too much of the damping")

    # ---------------------------------------------------------------- high modes

    def check(self, loaded: arb, gap: arb, frequency: arb, modes: Sequence[tuple[arb, dict[Place, arb]]] = ()) -> None:
        """Lemmas 11 and 13: no mode beyond line m reaches the axis. loaded: load times C of Lemma 6; gap: at most all
        gaps from m on; frequency: at most ω_m. modes: at most ω_j, and the squares at places, of some from m + 1 on.
        Raises Refused."""
        c_E, turning = self.of_E, self.turning
        X = loaded
        if not self.vanishing:
            require(bool(turning.is_zero() or c_E > 0), "a slope is damped without internal damping")
            X += (turning / c_E if c_E > 0 else arb(0)) + self.size * (1 + gap / frequency).sqrt()
        require(bool(2 * X < gap), "the gaps between high frequencies are too narrow for such a load and damping")
        beyond = (modes[-1][0] if modes else frequency) + gap
        for omega, squares in (*modes, (beyond, {})):
            self._check_from(omega, squares, gap, X, loaded)

    def _check_from(self, omega: arb, squares: dict[Place, arb], gap: arb, X: arb, loaded: arb) -> None:
        """The same for a mode with such squares, or without them for all from ω on."""
        c_E, r, undamped = self.of_E, gap / omega, "high frequencies are not known to be damped"
        sigma = (((1 + r) / (gap * (2 + r) - X)).max(1 / (gap * (2 - r) - X)) * X).upper()
        require(bool(2 * sigma**2 < 1), undamped)
        blur, k = sigma / (1 - sigma**2).sqrt(), 1 / (1 - 2 * sigma**2)
        h = c_E * (omega - X - loaded * k) - self.turning * k - self.taken(omega, blur, r, squares)
        rest = self.least(omega, blur).min(arb(0))
        require(bool(h >= 0) and bool(self.of_M + omega * h + rest > 0), undamped)

    def highest(self, line: arb, loaded: arb) -> arb:
        """Ω: no eigenvalue iω, ω ≥ Ω, is left of a line, or none is there at all. loaded: as above."""
        if self.c_E == 0:
            return line.sqrt().upper()
        c_E, bounds = self.of_E, []
        rest = 1 - c_E * self.of_M - c_E**2 * line
        if rest > 0:
            bounds.append((line / rest).sqrt().upper())
        omega = (1 / (8 * c_E)).upper()
        for _ in range(140):
            h = (1 + (c_E * omega) ** 2).sqrt()  # |1 + c_E λ|; λ/(1 + c_E λ) has the size ω/h
            of_load = (loaded + self.turning * omega) / h * _beside_squares(omega, h)
            of_rest = self.size * omega / h / (c_E * omega**3 / h**2)
            if of_load + of_rest < 1:
                bounds.append(omega)
                break
            omega = (omega * arb(9) / 8).upper()
        require(bool(bounds), "no bound of the frequency is known")
        return least(bounds)


class DampedOver(Damped):
    """Of each column and damping between two that go linearly into one another; R of each for one c_E and one c_M.

    Places have masses at both ends of the range, or at none. Raises Refused.
    """

    both: tuple[Damped, Damped]

    @staticmethod
    def of(one: Damped, other: Damped) -> DampedOver:
        masses, springs = (
            {key: side([part.get(key, Fraction(0)) for part in parts]) for key in {**parts[0], **parts[1]}}
            for side, parts in ((min, (one.column.masses, other.column.masses)),
                                (max, (one.column.springs, other.column.springs)))
        )  # fmt: skip
        require(all(masses[key] > 0 for column in (one.column, other.column) for key, m in column.masses.items() if m),
                "a mass is nothing at an end of the range, with damping")  # fmt: skip
        column = replace(one.column, masses=masses, springs=springs)  # of which a mode has most at a place
        points = {key: _worse(one.points.get(key, Fraction(0)), other.points.get(key, Fraction(0)))
                  for key in {**one.points, **other.points}}  # fmt: skip
        found = DampedOver(column, one.c_E, one.c_M, one.vanishing, one.along, points, one.beside)
        object.__setattr__(found, "both", (one, other))
        return found

    @property
    def of_E(self) -> arb:
        return self.both[0].of_E.union(self.both[1].of_E)

    @property
    def of_M(self) -> arb:
        return self.both[0].of_M.union(self.both[1].of_M)

    @property
    def of_mass(self) -> bool:
        return all(each.of_mass for each in self.both)

    @cached_property
    def turning(self) -> arb:
        return _most([each.turning for each in self.both])

    @cached_property
    def density(self) -> tuple[arb, arb]:
        low, high = zip(*(each.density for each in self.both), strict=True)
        return least(low), greatest(high)

    @cached_property
    def at_masses(self) -> list[arb]:
        """Between its values at the ends, a quotient of what is linear."""
        return [a.union(b) for a, b in zip(*(each.at_masses for each in self.both), strict=True)]


def _beside_squares(omega: arb, h: arb) -> arb:
    """At least x/|x² − s| for every x, on the axis: (2 (|s| − Re s))^(−1/2)."""
    return 1 / (2 * omega**2 * (1 / h - 1 / h**2)).sqrt()


def _worse(f: Fraction, g: Fraction) -> Fraction:
    """What takes as much of the damping as any number between two."""
    most = max(abs(f), abs(g))
    return -most if min(f, g) < 0 else most


def fraction(value: fmpq) -> Fraction:
    return Fraction(int(value.p), int(value.q))


def _most(values: list[arb]) -> arb:
    return greatest([arb(0), *values]).upper()


def ratios(column: Sections, parts: list[fmpq_poly]) -> tuple[arb, arb]:
    values = [at(f, x) / at(column.m[n], x) for n, f in enumerate(parts) for x, _ in column.pieces(n)]
    return least(values).lower(), greatest(values).upper()


def _product(order: int) -> str:
    return "v y" if order == 0 else "v' y'"


def _written(f: fmpq_poly) -> str:
    powers = [(fraction(f[k]), ["", " x"][k] if k < 2 else f" x^{k}") for k in range(f.degree() + 1)]
    terms = [said(c) + power for c, power in powers if c]
    return terms[0] if len(terms) == 1 else f"({' + '.join(terms)})".replace("+ -", "- ")
