"""Check certificates of all eigenvalues of the beam itself at a load, up to a bound of |λ| (format 7).

Of the verifier of certificates of the beam itself (`verifier_of_beam`); it shares no code with the prover. In a file
are ends, forms, damping, the load, the bound r, and for each eigenvalue a centre and a radius. f(λ) = F(p(λ), s(λ)) is
analytic for |λ| ≤ r. Newton's method on intervals shows that each square about a centre holds one simple zero, and
the argument of f along the circle |λ| = r how many zeros there are in all. docs/theorem.md has the statement.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from itertools import combinations, pairwise
from typing import Any

import flint
from flint import acb, arb

from freebeam_derive.certify import verifier_beam_claims as claims
from freebeam_derive.certify import verifier_claims as v
from freebeam_derive.certify.decimals import said, shown
from freebeam_derive.certify.verifier_beam_claims import Forms, OfBeamItself
from freebeam_derive.certify.verifier_boxes import Box
from freebeam_derive.certify.verifier_claims import Damping, Refused, ball, require
from freebeam_derive.certify.verifier_of_beam import added, rigid, shooting
from freebeam_derive.certify.verifier_shooting import Shooting
from freebeam_derive.certify.verifier_signs import BITS

SPECTRUM = "freebeam certificate 7"
OF_SPECTRUM = claims.COLUMN | {"load", "complete_to", "eigenvalues"}
LARGEST, FARTHEST = 10_000, 10**9  # bounds of |λ|, some 15 s, and of |s|
MOST_EIGENVALUES, NARROWEST = 500, Fraction(1, 10**1010)  # radius of a square, in parts of its centre: 2 s
FIRST, MOST_ARCS = 16, 2000  # of the half circle
SHORTEST = Fraction(1, 2**14)  # of them: two |λ| 1e-4 apart leave room between for a circle
PARTS = 8  # of an arc, on each of which f must stay in a half-plane


# --- what is claimed -----------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Enclosed:
    """An eigenvalue λ with |Re λ − re| and |Im λ − im| ≤ radius; where im > 0 its conjugate is another."""

    re: Fraction
    im: Fraction
    radius: Fraction

    @property
    def count(self) -> int:
        return 2 if self.im > 0 else 1

    def apart(self, other: Enclosed) -> bool:
        reach = self.radius + other.radius
        return abs(self.re - other.re) > reach or abs(self.im - other.im) > reach

    def contains(self, real: Fraction) -> bool:
        return abs(self.re - real) <= self.radius and self.im <= self.radius


@dataclass(frozen=True)
class OfSpectrum(OfBeamItself):
    """A statement of all eigenvalues with |λ| ≤ complete_to at the load P.

    kind: "spectrum".
    """

    at: Fraction
    complete_to: Fraction
    eigenvalues: tuple[Enclosed, ...]

    @property
    def count(self) -> int:
        return sum(each.count for each in self.eigenvalues)

    def parts(self, of: Enclosed) -> tuple[tuple[str, str], tuple[str, str]]:
        """Real and imaginary part, each between two decimals. Zero where a square about an axis holds one alone."""
        still = of.re == 0 and self.damping is None
        real, imaginary = (
            ("0", "0") if zero else shown(middle - of.radius, middle + of.radius)
            for middle, zero in ((of.re, still), (of.im, of.im == 0))
        )
        return real, imaginary

    def __str__(self) -> str:
        return (
            f"proven of {self.of}, at P = {said(self.at)}, over all modes: with |lambda| up to "
            f"{said(self.complete_to)} the elastic motion has exactly {self.count} eigenvalues, each simple"
            + "".join(map(self._said, self.eigenvalues))
        )

    def _said(self, of: Enclosed) -> str:
        where = zip(("Re", "Im"), self.parts(of), strict=True)
        texts = [f"{name} = 0" if low == high else f"{name} between {low} and {high}" for name, (low, high) in where]
        return f"; {', '.join(texts)}" + (", and its conjugate" if of.im > 0 else "")

    def record(self) -> dict[str, Any]:
        boxes = [self.parts(each) for each in self.eigenvalues]
        lower, upper = ([[re[end], im[end]] for re, im in boxes] for end in (0, 1))
        return {"column": self.column, "kind": self.kind, **self.of_column} | {
            "load": said(self.at), "complete_to": said(self.complete_to), "count": self.count,
            "eigenvalues_lower": lower, "eigenvalues_upper": upper,
        }  # fmt: skip


def _read(data: dict[str, Any]) -> tuple[OfSpectrum, Forms]:
    """What is claimed, and the forms. Raises Refused."""
    claims.fields(data, OF_SPECTRUM)
    at, r = v.number(data["load"]), v.number(data["complete_to"])
    require(abs(at) < claims.HIGHEST, f"a spectrum is certified at loads below {claims.HIGHEST}")
    require(0 < r <= LARGEST, f"a spectrum is certified up to |lambda| = {LARGEST} at most")
    found = tuple(map(_enclosed, claims.listed(data["eigenvalues"], MOST_EIGENVALUES, "eigenvalues")))
    require(all(one.apart(other) for one, other in combinations(found, 2)), "two eigenvalues are not apart")
    given = {"kind": "spectrum", "modes": 1, "at": at, "complete_to": r, "eigenvalues": found}
    stated, forms = claims.column(data | {"modes": 1}, OfSpectrum, **given)
    require(stated.kappa is None, "a spectrum is none of a limit of vanishing damping")
    return stated, forms


def _enclosed(data: dict[str, Any]) -> Enclosed:
    claims.fields(data, {"re", "im", "radius"})
    re, im, radius = (v.number(data[k]) for k in ("re", "im", "radius"))
    require(0 < radius <= LARGEST and max(abs(re), abs(im)) <= LARGEST, "an eigenvalue is nowhere")
    require(radius > max(abs(re), abs(im)) * NARROWEST, "an enclosure is narrower than any that is written")
    require(im == 0 or im > radius, "an eigenvalue is neither real nor above the real axis")
    return Enclosed(re, im, radius)


# --- what is checked -----------------------------------------------------------------------------------------------


class Function:
    """f(λ) = F(p(λ), s(λ)) at a load, where 1 + alpha λ is not zero."""

    def __init__(self, F: Shooting, load: Fraction, of_E: Fraction, of_M: Fraction) -> None:
        self.F, self.load, self.of_E, self.of_M = F, load, of_E, of_M

    def near(self, whole: acb) -> Callable[[acb], tuple[acb, acb]]:
        """f and f' at λ within a box."""
        p, s = (side + (side - side.mid()) / 64 for side in self._place(whole)[:2])  # wider than what is rounded
        box = Box(self.F, p, s)

        def at(value: acb) -> tuple[acb, acb]:
            p, s, below, by_s = self._place(value)
            slope = box.value(p, s, 1, 0) * (-self.alpha * p / below) + box.value(p, s, 0, 1) * by_s
            return box.value(p, s), slope

        return at

    @property
    def alpha(self) -> arb:
        return ball(self.of_E)

    def _place(self, value: acb) -> tuple[acb, acb, acb, acb]:
        """p, s, 1 + alpha λ and s'."""
        beta, below = ball(self.of_M), 1 + self.alpha * value
        p, s = ball(self.load) / below, -value * (value + beta) / below
        return acb(p), acb(s), acb(below), -(2 * value + beta + self.alpha * s) / below

    def one_in(self, of: Enclosed) -> bool:
        """Whether one zero is in a square, and it is simple: Newton's method on intervals."""
        middle, radius = acb(ball(of.re), ball(of.im)), arb(0, 1) * ball(of.radius)
        square = middle + acb(radius, radius)
        at = self.near(square)
        value, slope = at(middle)[0], at(square)[1]
        if slope.contains(0):
            return False
        step = value / slope  # of Newton's image, middle - step
        return bool(abs(step.real) < ball(of.radius) and abs(step.imag) < ball(of.radius))


class Circle:
    """How many zeros f has with |λ| < r, by its argument along the upper half of the circle: f(conj λ) = conj f(λ)."""

    def __init__(self, f: Function, radius: Fraction) -> None:
        self.f, self.radius = f, ball(radius)

    def zeros(self) -> int:
        arcs, turns = 0, arb(0)
        waiting = [(Fraction(k, FIRST), Fraction(k + 1, FIRST)) for k in range(FIRST)]
        while waiting:
            low, high = waiting.pop()
            arcs += 1
            require(arcs <= MOST_ARCS, "it would take too long to count the eigenvalues")
            turned = self.turned(low, high)
            if turned is None:
                require(high - low > SHORTEST, "the bound is too near an eigenvalue to count those within")
                middle = (low + high) / 2
                waiting += [(low, middle), (middle, high)]
            else:
                turns += turned
        count = (turns / arb.pi()).unique_fmpz()
        if count is None:
            raise Refused("the eigenvalues could not be counted")
        return int(count)

    def turned(self, low: Fraction, high: Fraction) -> arb | None:
        """By how much the argument of f grows from low to high, in parts of the half; None where it is not known."""
        try:
            at = self.f.near(self._on(ball(low).union(ball(high))))
        except ArithmeticError:  # near -1/alpha p and s are too large on a long arc
            return None
        total = arb(0)
        edges = [low + (high - low) * Fraction(k, PARTS) for k in range(PARTS + 1)]
        first = at(self._on(ball(low)))[0]
        for a, b in pairwise(edges):
            last = at(self._on(ball(b)))[0]
            middle, along = self._on(ball((a + b) / 2)), self._on(ball(a).union(ball(b)))
            value = at(middle)[0]
            slope = at(along)[1]
            # all values are in the half-plane about the one in the middle
            if not (1 + slope * (along - middle) / value).real > 0:
                return None
            total += (last / value).arg() - (first / value).arg()
            first = last
        return total

    def _on(self, turn: arb) -> acb:
        return self.radius * acb(turn.cos_pi(), turn.sin_pi())


def verify_spectrum(data: dict[str, Any]) -> OfSpectrum:
    """Check a certificate of a spectrum; what it proves. Raises Refused, ArithmeticError."""
    stated, forms = _read(data)
    r, found = stated.complete_to, stated.eigenvalues
    none = Damping(Fraction(0), Fraction(0), vanishing=False)
    of_E, of_M = (stated.damping or none).of_E, (stated.damping or none).of_M
    left = 1 - of_E * r
    require(left > 0, "eigenvalues accumulate at -1/alpha, which is not beyond the bound")
    p, s = abs(stated.at) / left, (r * r + abs(of_M) * r) / left  # at most
    require(p < claims.HIGHEST and s < FARTHEST, "F is not computed for so large a load, damping or bound")
    with flint.ctx.workprec(BITS):
        R = rigid(stated, forms)
    # f has at least R zeros at 0 and as many at -beta, of rigid motions; they are no eigenvalues of the elastic one
    resting = R * (2 if abs(of_M) < r else 1)
    require(R == 0 or abs(of_M) != r, "a rigid motion is on the circle")
    rest = [Fraction(0), -of_M] if R else []
    require(not any(each.contains(place) for each in found for place in rest), "an eigenvalue is one of a rigid motion")
    load = stated.at
    if of_E == 0:  # then p is one number, and F a function of s alone
        forms, load = forms | {"E": added(forms["E"], forms["H"], Fraction(1), load), "H": ((), ())}, Fraction(0)
    f = Function(shooting(stated, forms), load, of_E, of_M)
    more = 64 + int(2 * float(s) ** 0.25 + 3 * float(p) ** 0.5)  # for what F loses where its terms cancel
    narrow = max((int(max(abs(each.re), abs(each.im)) / each.radius).bit_length() for each in found), default=0)
    for each in found:
        with flint.ctx.workprec(more + narrow):
            reach = acb(ball(abs(each.re) + each.radius), ball(each.im + each.radius))
            require(bool(abs(reach) < ball(r)), "an eigenvalue is not within the bound")
            where = f"{float(each.re):.6g} + {float(each.im):.6g} i"
            require(f.one_in(each), f"near {where} is no eigenvalue, or more than one")
    with flint.ctx.workprec(more):
        count = Circle(f, r).zeros()
    require(count == stated.count + resting, f"{count - resting} eigenvalues are within the bound, not {stated.count}")
    return stated


FORMATS = {SPECTRUM: verify_spectrum}
