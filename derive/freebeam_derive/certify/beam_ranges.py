"""The critical load of the beam itself over a range of a parameter, proven for each value. Eqs. (6), (14), (15).

A damping enters F(p, s) by p and s alone. A parameter of the column's own is served where it stands in one condition,
linearly; of uniform columns also elsewhere, by a series in it (`parameter_series`). In one condition, at x = 1, F, a
determinant of the conditions, is linear in it as well, and lies between its values at the ends of the range (`Over`;
`system_ranges` of columns beyond the textbook's). Krawczyk's test on a box of P and s (or ω), with F at the middle of
the range and its slope over all of it, holds for all values at once: each has one crossing in the box. That it is the
first, and that the column is stable below, is shown by `beam_stability`, whose balls hold all values too.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from copy import copy
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from flint import acb, arb, arb_mat

from freebeam_derive.certify.balls import Exact, Range, Unproven, ball, ends, precision
from freebeam_derive.certify.beam import Beam, NoSeries
from freebeam_derive.certify.beam_itself import (
    Coalescence,
    Damped,
    ExactCrossing,
    Itself,
    Kind,
    Onset,
    Static,
    VanishingDamping,
    VanishingRates,
)
from freebeam_derive.certify.beam_stability import BITS, Evidence, complete
from freebeam_derive.certify.frequency_gaps import at_both
from freebeam_derive.certify.krawczyk import inside, inverse
from freebeam_derive.certify.local_series import Local
from freebeam_derive.certify.parameter_series import OverEquation, power, rows_of, straight
from freebeam_derive.certify.system_ranges import Half, OverSystem, middle_of

# of a box's image, by the change of the slopes: with 0.75, of a mass from 0.9 to 1, the verifier's balls are too wide
CURVED = 0.5
GROWTHS = 12  # of a box, before the range is said to be too wide


@dataclass(frozen=True)
class Piece:
    """What is proven for each value of a parameter from low to high: its first loss of stability and the kind of it.

    load, frequency: intervals that hold those of every value; the frequency of a divergence is zero. evidence: on which
    that it is the first stands.
    """

    low: Fraction
    high: Fraction
    load: tuple[Fraction, Fraction]
    frequency: tuple[Fraction, Fraction]
    kind: Kind
    evidence: Evidence


class Over(Beam):
    """A beam over a range of one of its own parameters: F and its derivatives are balls that hold those of each value.

    own: one of them a `Range`. Raises NoSeries where the parameter stands elsewhere than in one condition at x = 1.
    """

    def __init__(self, kernel: Any, own: Mapping[str, Any]) -> None:
        (name,) = (n for n, value in own.items() if isinstance(value, Range))
        ends = own[name]
        assert isinstance(ends, Range)
        super().__init__(kernel, {**own, name: ends.low})
        _linear(self, name)
        self.low, self.high = (Beam(kernel, {**own, name: value}) for value in (ends.low, ends.high))
        self.own = {**self.own, name: ends}

    def expanded(self, p: Any, s: Any, jets: Any) -> Any:
        low, high = (beam.expanded(p, s, jets) for beam in (self.low, self.high))
        entries = [a.union(b) for a, b in zip(low.entries(), high.entries(), strict=True)]
        return jets.matrix(low.nrows(), low.ncols(), entries)

    def damping(self, alpha: Exact, beta: Exact) -> tuple[arb, arb]:
        return self.low.damping(alpha, beta)  # which conditions where a load acts have no part in

    def terms(self, middle: Beam) -> list[Any]:
        return [middle, Half(self.low, self.high, middle)]


def over(kernel: Any, own: Mapping[str, Any]) -> Over | OverEquation:
    """A uniform column over a range of one of its own parameters. Raises NoSeries where none is served."""
    try:
        return Over(kernel, own)
    except NoSeries:
        return OverEquation(kernel, own)


def _linear(beam: Beam, name: str) -> None:
    """That a parameter stands in one condition at x = 1 alone, and is linear there. Raises NoSeries."""
    rows, place = rows_of(beam, name)
    holding = {k for k, row in enumerate(rows) if any(place in v.free_symbols for v in row)}
    if not straight(rows, place) or len(holding) > 1 or not holding <= {3, 4}:  # 0: the equation, 1, 2: at x = 0
        raise NoSeries(
            f"{beam.name}: a range of {name} is served where it stands in one condition at x = 1 alone, linearly"
        )


def linear_damping(beam: Beam, name: str) -> None:
    """That the equation is linear in alpha or beta. Raises NoSeries."""
    if not straight(*rows_of(beam, name)):
        raise NoSeries(f"{beam.name}: its damping is not linear in {name}, and its range is not served")


def crossing(
    beam: Itself, damping: tuple[Exact, Exact, Exact | None], near: tuple[float, float], kind: Kind
) -> ExactCrossing:
    """The onset of each value of the parameter that is a `Range`: among the dampings, or of a beam that is `Over` one.

    damping: alpha, beta, and kappa or None. near: load and frequency at the middle of the range, such as the runtime's.
    Raises Unproven where the range is too wide, or the crossing is none for all of it.
    """
    with precision(BITS):
        problem = _problem(beam, damping, kind)
        start = (
            [near[0]] if kind == "divergence" else [near[0], near[1] if isinstance(problem, Damped) else near[1] ** 2]
        )
        box = _enclosed(problem, _Family(beam, damping, kind), [arb(v) for v in start])
        if not all(side > 0 for side in box):
            raise Unproven(f"{problem.sought} is not known to be positive")
        problem.onset(box, _on(problem, box).slopes(box)[2])
        frequency = arb(0)
        if kind == "flutter":
            frequency = box[1] if isinstance(problem, Damped) else box[1].sqrt()
        return ExactCrossing(box[0], frequency, kind, 0, BITS)


def _problem(beam: Itself, damping: tuple[Exact, Exact, Exact | None], kind: Kind) -> Onset:
    alpha, beta, kappa = damping
    if kind == "divergence":
        return Static(beam)
    if kappa is not None:
        return VanishingDamping(beam, kappa) if isinstance(beam, Beam) else VanishingRates(beam)
    return Coalescence(beam) if beam.undamped(alpha, beta) else Damped(beam, alpha, beta)


class _Family:
    """The equations of each value of the range, at a point: value + Σ slope · δ, |δ| ≤ a radius.

    middle: the problem at the middle of the range.
    """

    def __init__(self, beam: Itself, damping: tuple[Exact, Exact, Exact | None], kind: Kind) -> None:
        at_middle: Itself = beam
        terms: list[Any] = [beam]
        thin: Any = tuple(middle_of(value) for value in damping)
        if isinstance(beam, Over | OverEquation | OverSystem):
            at_middle = (
                beam.middle
                if isinstance(beam, OverSystem)
                else Beam(beam.kernel, {name: middle_of(value) for name, value in beam.own.items()})
            )
            terms = beam.terms(at_middle)  # type: ignore[arg-type]
        self.over, self.middle = _problem(beam, damping, kind), _problem(at_middle, thin, kind)
        self.terms = [_with(self.middle, term) for term in terms]

    def newton(self, x: list[arb]) -> list[arb]:
        """The crossing at the middle of the range."""
        for _ in range(20):
            value, slopes, _ = self.middle.slopes(x)
            step = inverse(slopes) * arb_mat([[v] for v in value])
            before, x = x, [(side - step[i, 0]).mid() for i, side in enumerate(x)]
            if not all(abs(a - b) < abs(b) / 2 for a, b in zip(x, before, strict=True)):
                break
            if all(abs(a - b) < abs(a) * arb(2) ** -40 for a, b in zip(x, before, strict=True)):
                return x
        raise Unproven("Newton's method finds no crossing in the middle of the range")

    def moved(self, Y: arb_mat, x: list[arb]) -> arb_mat:
        """Y times the equations at a point, for each value of the range."""
        total = arb_mat(len(x), 1)
        for k, term in enumerate(self.terms):
            total = total + (Y * _column(term.value(x))) * power(k)
        for slope, away in self._by_damping(x):
            total = total + (Y * _column(slope)) * away
        return total

    def _by_damping(self, x: list[arb]) -> list[tuple[list[arb], arb]]:
        """Slopes in c_E and c_M over all of the range, and how far these go from the middle; in a limit in c_M/c_E.

        Over a range of alpha or beta one slope, along which both go linearly.
        """
        over, middle = self.over, self.middle
        if isinstance(over, VanishingDamping) and isinstance(middle, VanishingDamping):
            zero = arb(0)
            away = over.moved([zero, zero]) - middle.moved([zero, zero])
            return [([zero, over.beam.taylor(*over.place(x), ((0, 0), (0, 1)))[0, 1]], away)]
        if not (isinstance(over, Damped) and isinstance(middle, Damped) and isinstance(over.beam, Beam)):
            return []
        value = acb(0, x[1])
        p, s, _, _, inverse = over.beam.pencil(x[0], value, over.alpha, over.beta)
        t = over.beam.taylor(p, s, ((0, 0), (1, 0), (0, 1)))
        slopes = (-value * inverse * (p * t[1, 0] + s * t[0, 1]), -value * inverse * t[0, 1])
        dampings = (over.alpha, over.beta), (middle.alpha, middle.beta)
        ends = at_both({"alpha": over.alpha, "beta": over.beta})
        if len(ends) == 2:
            each = [over.beam.damping(of["alpha"], of["beta"]) for of in ends]
            slope = sum((f * (b - a) / 2 for f, a, b in zip(slopes, *each, strict=True)), acb(0))
            return [([slope.real, slope.imag], power(1))]
        pairs = zip(*(over.beam.damping(*given) for given in dampings), strict=True)
        return [([f.real, f.imag], whole - thin) for f, (whole, thin) in zip(slopes, pairs, strict=True)]


def _on(problem: Onset, box: list[arb]) -> Onset:
    """The same, with a series that stands for F on a box; a short one over a range of a damping, where that is dear."""
    short = 3 if isinstance(problem.beam, OverSystem) and problem.beam.by_damping else None
    return _with(problem, Local(problem.beam, *problem.place(box), isinstance(problem, VanishingRates), short))


def _with(problem: Onset, beam: Any) -> Onset:
    other = copy(problem)
    other.beam = beam
    return other


def _column(values: Sequence[arb]) -> arb_mat:
    return arb_mat([[v] for v in values])


def _enclosed(problem: Onset, family: _Family, start: list[arb]) -> list[arb]:
    """A box in which each value of the range has its crossing, one alone: Krawczyk's test."""
    x = family.newton(start)
    n, damped = len(x), isinstance(family.over.beam, OverSystem) and not isinstance(problem, Coalescence | Static)
    box = [ball(side, abs(side) * arb(2) ** -40) for side in x]
    for _ in range(GROWTHS):
        J = _on(problem, box).slopes(box)[1]
        Y = inverse(J.mid())
        rest = arb_mat(n, n, [int(i == j) for i in range(n) for j in range(n)]) - Y * J
        bent = rest * _column([side - m for side, m in zip(box, x, strict=True)])
        step = bent - family.moved(Y, x)
        found = [m + step[i, 0] for i, m in enumerate(x)]
        if damped and any(bent[i, 0].rad() > step[i, 0].rad() * CURVED for i in range(n)):
            break
        try:
            return inside(box, found)
        except Unproven:
            box = [ball(m, (abs(part - m).upper() * 1.125).upper()) for m, part in zip(x, found, strict=True)]
        if not all(side.is_finite() and side.rad() < abs(m) for m, side in zip(x, box, strict=True)):
            break
    raise Unproven("the range is too wide for one box to hold the crossing of each value")


def piece(
    beam: Itself,
    values: Range,
    damping: tuple[Exact, Exact, Exact | None],
    near: tuple[float, float],
    kind: Kind,
    width: Fraction | None = None,
) -> Piece:
    """The first loss of stability over a range, proven for each value. beam, damping, near and kind as in `crossing`.

    Raises Unproven with the step that failed, and where the loads are more than a share `width` of the highest apart.
    """
    found = crossing(beam, damping, near, kind)
    bottom, top = ends(found.load)
    if width is not None and top - bottom > width * top:
        raise Unproven("the loads of the range are too far apart")
    proven, evidence, missing = complete(beam, found, *damping)
    if evidence is None:
        raise Unproven(missing)
    return Piece(values.low, values.high, (bottom, top), ends(proven.frequency), kind, evidence)
