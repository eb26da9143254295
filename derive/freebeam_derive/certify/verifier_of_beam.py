"""Check certificates of the beam itself (formats 3, 4 and 5): code of its own, which shares none with the prover.

What acceptance proves, and why, stands in docs/theorem.md. In a file are ends, forms, damping, the claim, the number m
of lowest eigenvalues, how many modes the bounds take, and points between which F(P, s) changes sign. Everything else is
computed here:

- F(p, s) is the determinant of all four conditions on four solutions, which follow from the forms by parts
  (`verifier_shooting`, on boxes in `verifier_boxes`).
- The load's entries between modes come from integrals of exponentials, the rest of the norms from the lemmas
  (`verifier_lines`).
- Each crossing is enclosed by Krawczyk's test in the box of the file (`verifier_equations`).
- The eigenvalues below are told by signs (`verifier_signs`), and every other crossing is excluded by cells
  (`verifier_cells`).

`verifier_beam_claims` reads the files and says what acceptance proves.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from typing import Any

import flint
from flint import arb

from freebeam_derive.certify import verifier_beam_claims as claims
from freebeam_derive.certify.verifier_beam_claims import Forms, OfAllCrossings, OfBeamItself, OverRange, Passing, Piece
from freebeam_derive.certify.verifier_boxes import Box
from freebeam_derive.certify.verifier_cells import Cells
from freebeam_derive.certify.verifier_claims import Damping, Form, Statement, ball, greatest, least, require
from freebeam_derive.certify.verifier_equations import Equations, Interval
from freebeam_derive.certify.verifier_lines import Lines, Norms, check_free, check_rigid
from freebeam_derive.certify.verifier_shooting import Shooting
from freebeam_derive.certify.verifier_signs import BITS, Signs, Stretch
from freebeam_derive.certify.verifier_touches import touches


class Bounds:
    """Norms between modes for forms, each computed once."""

    def __init__(self, ends: tuple[str, str]) -> None:
        self.ends = ends
        self._lines: dict[int, Lines] = {}
        self._norms: dict[tuple[int, Form], Norms] = {}

    def lines(self, n: int) -> Lines:
        if n not in self._lines:
            self._lines[n] = Lines(list(self.ends), n)
        return self._lines[n]

    def norms(self, n: int, form: Form) -> Norms:
        if (n, form) not in self._norms:
            self._norms[n, form] = Norms(self.lines(n), form)
        return self._norms[n, form]


class High:
    """All eigenvalues but the m lowest, up to a load: each alone in a strip, and none reaches the boundary.

    forms: those at both ends of a range in which they are linear, or those there are; norms between are no larger.
    """

    def __init__(self, bounds: Bounds, modes: int, forms: list[Forms], m: int) -> None:
        self.lines, self.m = bounds.lines(modes), m
        self.norms = [(bounds.norms(modes, _unbent(each["E"])), bounds.norms(modes, each["H"])) for each in forms]
        self._softening = [bounds.norms(modes, _softening(_unbent(each["E"]))) for each in forms]
        self.top = self.lines.line(m)

    def check(self, load: Fraction, equations: Equations) -> None:
        """Lemmas 3 to 5; with internal damping the inequality of Theorems 2 and 3."""
        rho = ball(load)
        if equations.of_E[1] > 0:
            damped = 1 - ball(equations.undamped_to) / self.top
            require(bool(damped > 0), "high frequencies are not known to be damped at P = 0")
            ratio = (self.lines.line(self.m + 1) / self.top - 1) / damped
            rho = (rho * (1 + ratio * 2 / arb.pi()) * (1 + arb(2) ** -20)).upper()
        for still, loaded in self.norms:
            check_free(self.m, rho, still, loaded)

    def highest(self, equations: Equations, load: Fraction) -> Fraction:
        """A value of the second unknown beyond which no eigenvalue that is on the boundary is one of the m lowest."""
        top = self.top
        if not equations.real:
            a, b = equations.alpha, equations.beta
            bounds, rest = [], 1 - a * b - a * a * top
            if rest > 0:
                bounds.append((top / rest).sqrt())
            still = greatest(norms.on(0) for norms in self._softening)
            loaded = greatest(pair[1].on(0) for pair in self.norms)
            spare = 1 / arb(2).sqrt() - still
            if a > 0 and spare > 0:
                bounds.append((ball(load) * loaded / spare).max(1 - 2 * (a * b).min(arb(0))) / a)
            require(bool(bounds), "no bound of the frequency is known")
            top = least(bounds)
        upper = top.upper().fmpq()
        return Fraction(int(upper.p), int(upper.q))


def _unbent(E: Form) -> Form:
    return tuple(t for t in E[0] if t[:3] != (0, 2, 2)), E[1]


def _softening(T: Form) -> Form:
    """What is not positive for itself: all but squares of a deflection or slope times a positive factor."""
    along = tuple(t for t in T[0] if t[1] != t[2] or t[3] < 0)
    return along, tuple(t for t in T[1] if t[:2] != t[2:4] or t[4] < 0)


def rigid(stated: OfBeamItself, forms: Forms) -> int:
    return check_rigid(list(stated.ends), _unbent(forms["E"]), forms["H"])


def shooting(stated: OfBeamItself, forms: Forms) -> Shooting:
    return Shooting(list(stated.ends), forms["E"], forms["H"])


def _damping(one: OfBeamItself, other: OfBeamItself, shares: Interval) -> tuple[Interval, Interval, bool]:
    """alpha and beta in C = alpha E + beta M, each at one share of the way between two statements and at another, to
    which they go linearly, and whether only their direction counts. None where beta M alone vanishes: it damps all
    motions alike."""
    if one.damping is None or other.damping is None or (_of_M_alone(one.damping) and _of_M_alone(other.damping)):
        return (Fraction(0), Fraction(0)), (Fraction(0), Fraction(0)), False
    found = []
    for a, b in ((one.damping.of_E, other.damping.of_E), (one.damping.of_M, other.damping.of_M)):
        low, high = (a + share * (b - a) for share in shares)
        found.append((low, high))
    return found[0], found[1], one.damping.vanishing


def _of_M_alone(damping: Damping) -> bool:
    return damping.vanishing and damping.of_E == 0


ALONE = Fraction(0), Fraction(0)  # shares of one value
HALF = Fraction(1, 2)


# --- the first crossing --------------------------------------------------------------------------------------------


class First:
    """The first crossing of one value of all, or of each value of a parameter in a piece of a range."""

    def __init__(self, equations: Equations, high: High, claim: OfBeamItself | Piece, ranged: bool) -> None:
        assert claim.load is not None
        self.equations, self.high, self.claim, self.ranged, self.load = equations, high, claim, ranged, claim.load

    def crossing(self) -> list[arb]:
        """P, and s or ω (0 at a divergence), with the proof that stability is lost there."""
        low, high = map(ball, self.load)
        found = [low.union(high), arb(0)]
        if self.claim.square is None:
            change = self.equations.divergence(self.load)
        else:
            found, change = self.equations.flutter(self.load, self.claim.square)
        require(bool(change > 0), "stability is not lost there")
        return found

    def check_order(self, stretches: tuple[Stretch, ...]) -> None:
        """What is seen of the stretches before anything is computed. Raises Refused."""
        with flint.ctx.workprec(BITS):
            signs, moves = (
                Signs(self.equations, self.high.top),
                self.claim.kind != "flutter" or not self.equations.limit,
            )
            if self.equations.real:
                signs.check_order(stretches, moves)

    def check(self, stretches: tuple[Stretch, ...]) -> None:
        self.check_order(stretches)
        equations, flutter, top = self.equations, self.claim.kind == "flutter", self.load[1]
        digits = 0 if self.ranged else _bits(self.load)
        with flint.ctx.workprec(BITS):
            self.high.check(top, equations)
            signs = Signs(equations, self.high.top)
        with flint.ctx.workprec(digits + equations.bits):
            crossing = self.crossing()
        with flint.ctx.workprec(BITS + digits):
            if equations.real:
                signs.stable(stretches, self.load, None if equations.limit and flutter else crossing)
        with flint.ctx.workprec(BITS):
            if not equations.real:
                signs.at_rest(list(stretches))
                signs.static(top, [] if flutter else [self.load])
            if not equations.undamped:
                signs.above(equations.undamped_to, list(stretches))
        with flint.ctx.workprec(equations.bits):
            if not equations.undamped:
                Cells(equations, top, [crossing] if flutter else []).check(self.high.highest(equations, top))


def _bits(interval: Interval) -> int:
    """In which the ends of an interval agree."""
    return int(interval[1] / (interval[1] - interval[0])).bit_length()


def verify_first(data: dict[str, Any]) -> OfBeamItself:
    """Check a certificate of the first crossing; what it proves. Raises Refused, ArithmeticError."""
    stated, forms, m, stretches = claims.first(data)
    assert stated.load is not None
    with flint.ctx.workprec(BITS):
        equations = Equations(shooting(stated, forms), rigid(stated, forms), *_damping(stated, stated, ALONE))
        high = High(Bounds(stated.ends), stated.modes, [forms], m)
    First(equations, high, stated, ranged=False).check(stretches)
    return stated


# --- over a range of a parameter -----------------------------------------------------------------------------------


def verify_range(data: dict[str, Any]) -> OverRange:
    """Check a certificate over a range of a parameter; what it proves. Raises Refused, ArithmeticError."""
    stated, forms = claims.over_range(data)
    low, high = stated.low, stated.high
    moves = forms[0] != forms[1]
    with flint.ctx.workprec(BITS):
        R, bounds = rigid(stated, forms[0]), Bounds(stated.ends)
        require(R == 0 or not moves, "forms of a column with rigid motions change with the parameter")
    F = shooting(stated, forms[0])
    for piece in stated.pieces:
        shares = (piece.low - low) / (high - low), (piece.high - low) / (high - low)
        each = [{name: added(forms[0][name], forms[1][name], 1 - t, t) for name in "EH"} for t in shares]
        if moves:
            E, H, *moved = (added(each[0][name], each[1][name], f, HALF) for f in (HALF, -HALF) for name in "EH")
            F = Shooting(list(stated.ends), E, H, tuple(moved))
        equations = Equations(F, R, *_damping(stated, stated.other, shares))
        with flint.ctx.workprec(BITS):
            above = High(bounds, piece.modes, each if moves else [forms[0]], piece.lowest)
        First(equations, above, piece, ranged=True).check(piece.stretches)
    return stated


def added(one: Form, other: Form, *weights: Fraction) -> Form:
    """One form times a weight and another times another."""
    found: list[dict[Any, Fraction]] = []
    for parts in zip(one, other, strict=True):
        total: dict[Any, Fraction] = {}
        for part, weight in zip(parts, weights, strict=True):
            for *key, f in part:
                total[tuple(key)] = total.get(tuple(key), Fraction(0)) + weight * f
        found.append(total)
    along, points = ([(*key, f) for key, f in total.items() if f] for total in found)
    return tuple(along), tuple(points)


# --- all crossings up to a load ------------------------------------------------------------------------------------


def verify_list(data: dict[str, Any]) -> OfAllCrossings:
    """Check a certificate of all crossings; what it proves. Raises Refused, ArithmeticError."""
    stated, forms, m, at_rest = claims.crossings(data)
    load = stated.load_max
    assert load is not None
    with flint.ctx.workprec(BITS):
        F = shooting(stated, forms)
        equations = Equations(F, rigid(stated, forms), *_damping(stated, stated, ALONE))
        high = High(Bounds(stated.ends), stated.modes, [forms], m)
        high.check(load, equations)
        signs = Signs(equations, high.top)
        signs.at_rest([at_rest])
        signs.above(equations.undamped_to, [at_rest])
    boxes = [box for passing in stated.passings if (box := _passing(equations, passing)) is not None]
    with flint.ctx.workprec(BITS):
        if any(p.kind == "touch" for p in stated.passings):
            _touches(equations, F, [p for p in stated.passings if p.square is None], load)
        else:
            signs.static(load, [p.load for p in stated.passings if p.kind == "divergence"])
        Cells(equations, load, boxes).check(high.highest(equations, load))
    return stated


def _passing(equations: Equations, passing: Passing) -> list[arb] | None:
    """That one crossing is in its intervals, alone, and changes the number of unstable eigenvalues as is said; its box
    where it is a flutter."""
    if passing.kind == "touch":
        return None
    box = None
    with flint.ctx.workprec(3 * _bits(passing.load) + BITS):
        if passing.square is None:
            change = equations.divergence(passing.load)
        else:
            box, change = equations.flutter(passing.load, passing.square)
    right = bool(change > 0) if passing.change > 0 else bool(change < 0)
    require(right, "the number of unstable eigenvalues is not known to change so")
    return box


def _touches(equations: Equations, F: Shooting, passings: Sequence[Passing], load: Fraction) -> None:
    """At s = 0 there are touches alone, these and no others, in each of which a simple eigenvalue is zero."""
    numbers = touches(F, equations.R, load)
    require(len(numbers) == len(passings), "a touch is left out, or there is none")
    require(equations.undamped or equations.of_M[0] > 0, "how an eigenvalue leaves zero is not known")
    for n, passing in zip(numbers, passings, strict=True):
        with flint.ctx.workprec(BITS + _bits(passing.load)):
            P = (n * arb.pi()) ** 2
            require(ball(passing.load[0]) < P < ball(passing.load[1]), "a touch is not in its interval")
            by_s = Box(F, P, arb(0), 1).value(P, arb(0), 0, 1)
        require(passing.kind == "touch" and not by_s.contains(0), "an eigenvalue is not known to touch zero there")


FORMATS: dict[str, Callable[[dict[str, Any]], Statement]] = {
    claims.FIRST: verify_first, claims.LIST: verify_list, claims.RANGE: verify_range,
}  # fmt: skip
