"""Check a certificate of all crossings of a series up to a load (format 10). docs/proofs.md has the theorem.

In the file is one of kind "none", of any series: the column, its parts, and that each is stable up to a load. Beyond
that load each part, but for those that are the first again, has a list of its crossings. Of each of these it is checked
that in its interval of loads nothing else reaches the imaginary axis, and how many eigenvalues more are unstable above
it (`Series.check_crossing`); between these intervals, that nothing reaches it (`verifier_plane`), for no root of h and
g with x ≥ 0, nor of det K, is there; and that det M, or the highest factor of the determinant, nowhere vanishes, so
that none comes from infinity. So the number of unstable eigenvalues is known between all crossings. In the limit of
vanishing damping it is that of h(-λ²) + s λ g(-λ²), the same for every s > 0, and without damping so with -h_x for g.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import pairwise
from typing import Any

import flint
from flint import arb_poly

from freebeam_derive.certify import verifier, verifier_of_matrices
from freebeam_derive.certify.decimals import roots, said
from freebeam_derive.certify.verifier import Over, Series, by_load, by_x, positive, stable_series
from freebeam_derive.certify.verifier_beam_claims import MOST_CROSSINGS, Passing, fields, listed, recorded
from freebeam_derive.certify.verifier_claims import Refused, Statement, ball, crossing, number, require
from freebeam_derive.certify.verifier_plane import check_apart

FORMAT = "freebeam certificate 10"
FIELDS = {"format", "below", "load_max", "crossings"}
OF_CROSSING = {"kind", "load", "frequency_squared"}
READERS = {
    verifier.FORMAT: verifier.of_beam, verifier.GENERAL: verifier.of_forms,
    verifier_of_matrices.FORMAT: verifier_of_matrices.read,
}  # fmt: skip
ONE = (Fraction(1),)
MORE = 64  # bits in which a cell next to an interval of loads may be finer than that
WIDE = Fraction(1, 2**40)  # of a load: how far about a crossing it is shown to be alone, where it is


@dataclass(frozen=True)
class OfCrossings(Statement):
    """A statement of every load up to load_max at which the number of unstable eigenvalues of a series changes.

    kind: "all". below: of the same series, stable up to a load. passings: ascending; of those whose intervals of loads
    overlap, of different parts, all have the numbers below and above all of them.
    """

    below: Statement
    passings: tuple[Passing, ...]

    def __str__(self) -> str:
        assert self.load_max is not None
        limit = getattr(self.below, "kappa", None) is not None
        those = "those that grow, to first order" if limit else "those with Re > 0"
        text = (
            f"proven of {self.below.of}: for every load P above 0 up to {said(self.load_max)} the number of unstable "
            f"eigenvalues, {those}, is 0 at first and changes "
        )
        if not self.passings:
            return text + "nowhere"
        n = len(self.passings)
        count = f"at {n} crossing{'s' * (n > 1)} and nowhere else: {'; '.join(map(str, self.passings))}"
        overlap = any(b.load[0] <= a.load[1] for a, b in pairwise(self.passings))
        return text + count + ("; where intervals of loads overlap, numbers are those below and above" * overlap)

    def record(self) -> dict[str, Any]:
        assert self.load_max is not None
        return self.below.record() | {
            "kind": "all", "load_lower": None, "load_upper": None, "frequency_lower": None, "frequency_upper": None,
            "stable_to": said(self.passings[0].load[0] if self.passings else self.load_max),
            "load_max": said(self.load_max),
            "crossings": [recorded(p) | {"unstable_below": p.unstable, "unstable_above": p.unstable + p.change}
                          for p in self.passings],
        }  # fmt: skip


def verify(data: dict[str, Any]) -> OfCrossings:
    """Check a certificate of all crossings of a series. Raises Refused."""
    fields(data, FIELDS)
    below, top = data["below"], number(data["load_max"])
    require(type(below) is dict and below.get("format") in READERS, "the column is in none of the formats of a series")
    stated, N, system, stretches, beside = READERS[below["format"]](below)
    require(stated.kind == "none" and stated.end <= top, "stability is not stated up to a load below the highest")
    each = [(system, stretches), *((of, separated) for of, separated, _ in beside)]
    given = listed(data["crossings"], MOST_CROSSINGS, "crossings of each part")
    require(len(given) == len(each), "the crossings of each part are not there")
    lists = [[_read(c) for c in listed(of, MOST_CROSSINGS, "crossings")] for of in given]
    for of in lists:
        edges = [stated.end, *(v for load, _ in of for v in load), top]
        require(all(a < b for a, b in pairwise(edges)) or edges == [top, top], "the crossings do not ascend")
    widths = [agreeing(load) for of in lists for load, _ in of]
    found: list[Passing] = []
    # as for one crossing
    with flint.ctx.workprec(200 + 20 * N + max(widths, default=0)):
        for k, ((of_part, separated), crossings) in enumerate(zip(each, lists, strict=True)):
            series = stable_series(of_part(), separated, top, top)
            scales = getattr(stated, "scales", ONE) if k == 0 else ONE
            found += check_list(series, stated.end, top, crossings, scales)
    return OfCrossings(
        stated.column, stated.parameters, stated.modes, stated.alpha, stated.beta, "all", None, None, top, stated,
        tuple(_counted(sorted(found, key=lambda p: p.load))),
    )  # fmt: skip


FORMATS: verifier.Others = {FORMAT: verify}
Interval = tuple[Fraction, Fraction]
Claim = tuple[Interval, Interval | None]


def _read(data: dict[str, Any]) -> Claim:
    """The intervals of a crossing's load and of x."""
    fields(data, OF_CROSSING)
    read = crossing(data, at_zero=True)
    require(read["load"] is not None, "a crossing is none")
    return read["load"], read["square"]


def agreeing(interval: Interval) -> int:
    """In how many bits the ends of an interval agree."""
    return int(interval[1] / (interval[1] - interval[0])).bit_length()


def _counted(passings: Sequence[Passing]) -> Iterator[Passing]:
    """Ascending ones with the numbers of unstable eigenvalues; those that overlap with what all of them change."""
    unstable, groups = 0, list[list[Passing]]()
    for p in passings:
        if groups and p.load[0] <= max(other.load[1] for other in groups[-1]):
            groups[-1].append(p)
        else:
            groups.append([p])
    for group in groups:
        change = sum(p.change for p in group)
        yield from (replace(p, unstable=unstable, change=change) for p in group)
        unstable += change


# --- one part -------------------------------------------------------------------------------------------------------


def check_list(
    series: Series, start: Fraction, top: Fraction, crossings: Sequence[Claim], scales: Sequence[Fraction]
) -> Iterator[Passing]:
    """These are all crossings of a part from a load on, up to which it is stable. Raises Refused.

    scales: of λ² in all parts that are the same but for the unit of time.
    """
    if top > start:
        leading = all(_sign(which[-1], start, top) for which in series.leading)
        require(leading, "det M may vanish below the highest load")
    if series.system.whirls:  # no s is real and not positive
        signs = {(-1) ** k * _sign(p, start, top) for k, p in enumerate(series.h)}
        require(len(signs) == 1 and 0 not in signs, "a whirl may be as fast as the frame, the other way round")
    reached, finest = start, max((agreeing(load) for load, _ in crossings), default=0) + MORE
    following = [*(load[0] for load, _ in crossings[1:]), top]
    for (load, square), end in zip(crossings, following, strict=False):
        change = series.check_crossing(*load, square)
        low, high = _widened(series, load, square, (reached, end))
        _check_between(series, reached, low, finest)
        reached = high
        for kind, of, times in _told(series, square, scales):
            yield Passing(kind, load, of, times * change, 0)
    _check_between(series, reached, top, finest)


def _sign(p: arb_poly, low: Fraction, high: Fraction) -> int:
    """That of a polynomial in P from one load to another, 0 where it is not known."""
    return next((side for side in (1, -1) if positive(side * p, ball(low), ball(high))), 0)


def _check_between(series: Series, low: Fraction, high: Fraction, finest: int) -> None:
    if low < high:
        require(bool(_sign(series.h[0], low, high)), "another divergence may lie between those that are listed")
        check_apart(series.h, series.g, ball(low), ball(high), finest)


def _widened(series: Series, load: Interval, square: Interval | None, room: Interval) -> Interval:
    """A wider interval of loads in which nothing but the one crossing is, or the same."""
    reach = load[1] * WIDE
    wide = load[0] - reach, load[1] + reach
    if load[1] - load[0] > reach or not room[0] < wide[0] < wide[1] < room[1]:
        return load
    try:
        if square is not None and any(square):
            over, (P, x) = Over(ball(load[1])), map(ball, (load[1], square[1]))
            f = series.h if series.damped and len(series.g) == 1 else series.g
            slope = abs(over(by_load(f), x) / over(by_x(f), x)) + x / P
            spread = (2 * slope * ball(reach)).upper().fmpq()
            room_of_x = Fraction(int(spread.p), int(spread.q))
            square = square[0] - room_of_x, square[1] + room_of_x
        series.check_crossing(*wide, square)
    except (Refused, ArithmeticError):
        return load
    return wide


def _told(
    series: Series, square: Interval | None, scales: Sequence[Fraction]
) -> Iterator[tuple[str, Interval | None, int]]:
    """Kind and ω² of a crossing at x, each with how many times the change it stands for: in a frame of several ω."""
    system = series.system
    if system.turn is None:
        for scale in sorted(set(scales)):
            of = None if square is None else (square[0] * scale, square[1] * scale)
            yield "divergence" if square is None else "flutter", of, scales.count(scale)
        return
    turn = Fraction(int(system.turn.p), int(system.turn.q))
    if square is None:  # x = 0, and ω is the rate of the frame, in both senses
        yield "flutter", (turn**2 * (1 - WIDE), turn**2 * (1 + WIDE)), 2 * len(scales)
        return
    low, high = square if system.whirls else roots(*square)
    for shift in (-turn,) if system.whirls else (-turn, turn):
        omega = low + shift, high + shift
        require(not omega[0] <= 0 <= omega[1], "a frequency may be zero in the frame")
        a, b = sorted(v * v for v in omega)
        yield "flutter", (a, b), len(scales)
