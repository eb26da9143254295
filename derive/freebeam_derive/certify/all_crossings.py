"""All crossings of a Ritz series up to a load, with the proof that none is left out. Eqs. (24), (25).

With h and g of `boundary_polynomials.py`, an eigenvalue is on the imaginary axis at a load P if and only if h(P, x) =
g(P, x) = 0 for some x = ω² > 0, or h(P, 0) = 0. (Without damping g is h_x: two eigenvalues meet. Where that happens at
x < 0, or off the real axis, nothing becomes stable or unstable, and none of it appears here.) So it is to be shown that
h and g have no common zero on a stretch of loads for any x from 0 to ∞: the half line is cut between neighbouring zeros
of h and of g at the stretch's middle, and in each strip one of the two keeps its sign, which its Bernstein coefficients
in P and x prove. A stretch that fails is searched for a crossing by Newton's method. Krawczyk's test proves one, on a
box as large as can be had it is shown to be alone, and the strips leave that box out. What remains is cut in half.

How many eigenvalues are unstable is counted from none at P = 0: the sign of the Jacobian of (h, g) says which way an
eigenvalue crosses. Motions that leave each other alone (`parts`) have lists of their own, merged by load: where
frequencies of two pass through one another there is nothing to tell.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from fractions import Fraction
from itertools import pairwise
from types import ModuleType

from flint import arb, arb_poly, fmpq

from freebeam_derive.certify.balls import Unproven, ball, ends, exact, precision, rational
from freebeam_derive.certify.bivariate import bernstein, keeps_sign, sign, signs_on, zeros
from freebeam_derive.certify.boundary_polynomials import Boundary, Question, boundaries, functions_of
from freebeam_derive.certify.first_crossing import (
    LOWEST_BITS,
    Enclosure,
    Stretch,
    alone,
    between,
    bits_for,
    certify_parts,
    check_fast,
    holds,
    refined,
    separators_at,
    spread_of,
    stretch_over,
)
from freebeam_derive.certify.krawczyk import enclose, newton
from freebeam_derive.certify.one_load import equal, undecided
from freebeam_derive.certify.parts import Part

MOST_BITS = 4000  # for telling crossings apart; their digits take what they take
FINEST = 80  # halvings of the load axis
HALVINGS = 5  # of a strip
BEYOND = 1 + Fraction(1, 10**6)  # times the highest load, where a crossing cannot be told from it
NEXT_TO = 1 - Fraction(1, 1000)  # about such a crossing all is open; of Ziegler's pendulum from 1e-9 below it on
PIECES = 16  # of the loads, on each of which signs of factors are told


@dataclass(frozen=True)
class Crossing:
    """One or two eigenvalues on the imaginary axis: an interval of loads, one of ω² (None for a divergence).

    change: how many eigenvalues more are unstable above it: 2 or −2 where a pair crosses, 1 or −1 where one does, so
    many times that as parts are the same; 0 where one touches zero (of the beam itself alone).
    unstable: how many are below it. part, place: of a series, which part it is of, and an interval of its x.
    """

    kind: str
    load: tuple[Fraction, Fraction]
    square: tuple[Fraction, Fraction] | None
    change: int
    unstable: int
    part: int = 0
    place: tuple[Fraction, Fraction] | None = None

    @property
    def stability(self) -> str:
        """lost, regained, or unchanged: what was unstable remains so. touched: zero is reached and not passed."""
        if self.change == 0:
            return "touched"
        if self.unstable == 0:
            return "lost"
        return "regained" if self.unstable + self.change == 0 else "unchanged"


class Crossings(list[Crossing]):
    """All up to a load. every, load_max: what a certificate states, up to a millionth beyond that load where balls do
    not tell whether one lies at it. parts, bits: how they were found."""

    def __init__(self, every: list[Crossing], load_max: Fraction, parts: list[Boundary], bits: int) -> None:
        super().__init__(every)
        self.every, self.load_max, self.parts, self.bits = every, load_max, parts, bits

    def below(self, question: Question) -> Enclosure:
        """That the series is stable up to a load below all of them. Raises Unproven."""
        first = min((crossing.load[0] for crossing in self.every), default=None)
        end = self.load_max if first is None else between(first * 7 / 8, first * 15 / 16)
        with precision(self.bits):
            return certify_parts(self.parts, question, None, 0, self.bits, end)


@dataclass
class _Found:
    """A crossing with the box about it, of loads and of x, in which there is no other of its part; square: None where
    one eigenvalue is zero, exactly 0 where a pair is."""

    load: arb
    square: arb | None
    low: Fraction
    high: Fraction
    bottom: Fraction
    top: Fraction
    change: int
    part: int = 0
    scales: list[fmpq] = field(default_factory=lambda: [fmpq(1)])


class Inseparable(Unproven):
    """A stretch of loads on which crossings could not be told apart. settled: those proven, below it or above."""

    def __init__(self, low: Fraction, high: Fraction, settled: list[_Found]) -> None:
        self.low, self.high = low, high
        below = ", ".join(f"{v:.10g}" for v in sorted(float(c.load.mid()) for c in settled) if v < low) or "none"
        self.settled = settled
        super().__init__(
            f"between the loads {float(low):.15g} and {float(high):.15g} crossings could not be told apart: two may "
            f"lie closer together than {FINEST} halvings at {MOST_BITS} bits resolve, or meet. Established: up to "
            f"there stability changes at these loads and no others: {below}"
        )


def survey(
    kernel: ModuleType,
    question: Question,
    load_max: Fraction,
    digits: int,
    progress: Callable[[str], None] | None = None,
) -> Crossings:
    """Every crossing for 0 < P ≤ load_max, ascending, each to a relative width below 10^−digits.

    One of which balls do not tell whether it lies at load_max or next to it is among them.
    Raises Unproven with what could not be established, Inseparable where crossings are too close to each other.
    """
    say = progress or (lambda _: None)
    try:
        return _survey(kernel, question, load_max, digits, say)
    except Inseparable as open_:
        if open_.high < load_max * NEXT_TO:
            raise
    found = _survey(kernel, question, load_max * BEYOND, digits, say)
    found[:] = [crossing for crossing in found if crossing.load[0] <= load_max]
    return found


def _survey(
    kernel: ModuleType, question: Question, load_max: Fraction, digits: int, say: Callable[[str], None]
) -> Crossings:
    functions = functions_of(kernel, question.modes)
    bits, fast = bits_for(functions, 0), True
    while True:
        with precision(bits):
            try:
                parts, rest, fast = _parts(kernel, question, bits, load_max)
                found = _merged(parts, load_max, say, question.kappa is not None)
                break
            except Unproven as error:
                if 2 * bits <= MOST_BITS:
                    pass
                elif fast or isinstance(error, Inseparable):
                    raise
                else:
                    raise Unproven(
                        f"{error}; two planes were not seen from a frame that turns either, because up to the highest "
                        "load a whirl may be as fast as the frame: give a lower load_max"
                    ) from error
        bits *= 2
    more = max(bits, bits_for(functions, digits))
    with precision(more):
        every = _refined(boundaries(kernel, question, more, rest, load_max), found, parts, digits, more)
    return Crossings(every, load_max, parts, bits)


def _parts(
    kernel: ModuleType, question: Question, bits: int, load_max: Fraction
) -> tuple[list[Boundary], bool | None, bool]:
    """All parts, and how planes that whirl are seen: not from a frame where that leaves something open; and whether all
    frames are known to turn fast."""
    fast = True
    try:
        parts = boundaries(kernel, question, bits, True, load_max)
        fast = all(turns_fast(of, load_max) for of in parts)
        if fast:
            return parts, True, True
    except Unproven:
        pass
    return boundaries(kernel, question, bits), None, fast


def turns_fast(of: Boundary, load_max: Fraction) -> bool:
    """Whether no ω + turn of two planes that whirl is real and 0 or less at any load, so that all x are positive: where
    (−1)^k times the factor of x^k in h has the same sign for all k."""
    if not (of.part and of.part.whirls):
        return True
    rows = [arb_poly([(-1) ** k * row[k] for row in of.h.rows]) for k in range(of.N + 1)]
    pieces = pairwise(load_max * k / PIECES for k in range(PIECES + 1))
    return {sign for piece in pieces for sign in signs_on(rows, *piece)} in ({1}, {-1})


def _merged(parts: list[Boundary], load_max: Fraction, say: Callable[[str], None], limit: bool = False) -> list[_Found]:
    """The crossings of all parts, ascending; of those that are the same but for the unit of time the first has them.
    limit: of vanishing damping."""
    found: list[_Found] = []
    left: list[Inseparable] = []
    for k, of in enumerate(parts):
        scales = {j: _scale(of.part, other.part) for j, other in enumerate(parts) if j != k}
        if any(scale is not None and j < k for j, scale in scales.items()):
            continue
        try:
            own = _Survey(of, load_max, say).run()
        except Inseparable as error:
            left.append(error)
            own = error.settled
        for c in own:
            c.part, c.scales = k, [fmpq(1), *(scale for scale in scales.values() if scale is not None)]
        found += own
    if left:
        lowest = min(left, key=lambda error: error.low)
        raise Inseparable(lowest.low, lowest.high, found)
    found.sort(key=lambda c: c.load.mid())
    for one, following in pairwise(found):
        pairs = [(parts[c.part].part, not (c.square is None or c.square == 0)) for c in (one, following)]
        both = [(part, flutter) for part, flutter in pairs if part]
        if one.load < following.load:
            continue
        low, high = ends(one.load.union(following.load))
        if not equal(both, limit, low, high):
            raise Unproven(undecided(both, low, high))
    return found


def _refined(
    fine: list[Boundary], found: list[_Found], parts: list[Boundary], digits: int, bits: int
) -> list[Crossing]:
    """The crossings of a survey to the digits asked for; fine: the same parts."""
    result, unstable = [], 0
    for crossing in found:
        of, before = fine[crossing.part], parts[crossing.part]
        z = [crossing.load] if crossing.square is None else [crossing.load, crossing.square]
        P, *places = refined(of, z, bits, 40)
        if crossing.square == 0:  # exactly
            places = [arb(0)]
        inside = all(exact(crossing.bottom) < x < exact(crossing.top) for x in places)
        pairs = zip(of.h.rows, before.h.rows, strict=True)
        again = all(v.contains(0) for p, q in pairs for v in (p - q).coeffs())
        if not (again and inside and exact(crossing.low) < P < exact(crossing.high)):
            raise Unproven(f"the crossing near {float(P.mid()):.10g} was lost in refining it")
        for square, times in _told(of.part, places, crossing.scales):
            if square is not None and not (square > 0 or square == 0):
                raise Unproven(f"whether the frequency at the load {float(P.mid()):.10g} is zero is not known")
            told = None if square is None else _interval(square, digits - 1)
            kind, change = "divergence" if square is None else "flutter", times * crossing.change
            load = _interval(P, digits)
            result.append(Crossing(kind, load, told, change, unstable, crossing.part, _place(of, load, places, digits)))
            unstable += change
    return result


def _told(part: Part | None, places: list[arb], scales: list[fmpq]) -> list[tuple[arb | None, int]]:
    """ω² of a crossing at x, None where it is 0, each with how many times the change of x it stands for.

    scales: of ω² in all parts that are this one but for the unit of time.

    In a frame that turns x = (ω + turn)² is of two ω, and each of ω and −ω, those of the other sense of whirl.
    """
    x, turn = places[0] if places else None, exact(part.turn) if part else arb(0)
    if x is None:
        return [(None, len(scales))] if turn == 0 else [(turn**2, 2 * len(scales))]
    if turn == 0 and x == 0:
        return [(x, len(scales))]
    if turn == 0:
        return [(scale * x, scales.count(scale)) for scale in sorted(set(scales))]
    whirls = [x - turn] if part and part.whirls else [x.sqrt() - turn, x.sqrt() + turn]
    return [(omega**2, len(scales)) for omega in whirls]


def _scale(part: Part | None, other: Part | None) -> fmpq | None:
    return part.scale(other) if part and other else None


def _interval(ball: arb, digits: int) -> tuple[Fraction, Fraction]:
    """A rational interval about a positive ball, of a relative width a little below 10^−digits; of 0 it alone."""
    if ball == 0:
        return Fraction(0), Fraction(0)
    middle = rational(ball, 400 + 4 * digits)
    spread = middle / 10 ** (digits + 2)
    if not (exact(middle - spread) < ball < exact(middle + spread)):
        raise Unproven(f"the crossing near {float(middle):.10g} could not be enclosed to {digits} digits")
    return middle - spread, middle + spread


def _place(
    of: Boundary, load: tuple[Fraction, Fraction], places: list[arb], digits: int
) -> tuple[Fraction, Fraction] | None:
    """An interval of x about a crossing in which the root of g stays for all loads of an interval."""
    if not places or places[0] == 0:
        return (Fraction(0), Fraction(0)) if places else None
    middle, point = (load[0] + load[1]) / 2, rational(places[0], 400 + 4 * digits)
    spread = spread_of(of.about(exact(middle), exact(point)), middle, point, (load[1] - load[0]) / middle)
    if not exact(point - spread) < places[0] < exact(point + spread):
        raise Unproven(f"the frequency at the load {float(middle):.10g} could not be enclosed to the digits asked for")
    return point - spread, point + spread


class _Survey:
    """The search on one set of balls."""

    def __init__(self, found: Boundary, load_max: Fraction, say: Callable[[str], None]) -> None:
        self.found, self.load_max, self.say = found, load_max, say
        self.crossings: list[_Found] = []

    def run(self) -> list[_Found]:
        zero = self._first_stable()
        check_fast(self.found, self.load_max)
        tops = [(self.found.g, self.found.between)] if self.found.odd else []
        tops += [(self.found.h, self.found.N)] if self.found.fast or not self.found.odd else []
        if 0 in signs_on([arb_poly([row[of] for row in top.rows]) for top, of in tops], zero, self.load_max):
            raise Unproven("det M is not known to keep its sign, and eigenvalues may come from infinity")
        for P in self.found.twice:
            if exact(zero) < P < exact(self.load_max):
                pair = self._box(P, arb(0), zero, self.load_max)
                if pair is None:
                    raise Unproven(f"how two eigenvalues leave zero at the load {float(P.mid()):.10g} is not known")
                self.crossings.append(pair)
        edges = [zero, *(v for c in self.crossings for v in (c.low, c.high)), self.load_max]
        try:
            for a, b in zip(edges[::2], edges[1::2], strict=True):
                self._divergences(a, b, 0)
        except Inseparable as open_:
            self._flutter(zero, open_.low)  # what there is below, so that it can be told
            raise Inseparable(open_.low, open_.high, self.crossings) from None
        self._flutter(zero, self.load_max)
        return self.crossings

    def _first_stable(self) -> Fraction:
        """The load from which on crossings are looked for: 0, or one up to which there is none where motions rest
        at 0. Raises Unproven where the column is not known to be stable up to it."""
        zero = Fraction(0)
        if self.found.rests:
            end = self.load_max
            for _ in range(FINEST):
                try:
                    if stretch_over(self.found, zero, end) is not None:
                        return end
                except Unproven:
                    pass
                end /= 2
            raise Unproven("the column is not known to be stable at small loads")
        at_zero = separators_at(self.found, zero)
        if at_zero is None or not holds(self.found, Stretch(zero, zero, zero, at_zero)):
            raise Unproven("the column is not known to be stable without load")
        return zero

    def _flutter(self, start: Fraction, end: Fraction) -> None:
        """Every common zero of h and g with x > 0 on a stretch."""
        waiting = [(start, end, 0)]
        while waiting:
            a, b, depth = waiting.pop()
            for c in self.crossings:
                if c.square is not None:  # its box is done with
                    a, b = (c.high if c.low <= a < c.high else a), (c.low if c.low < b <= c.high else b)
            if a >= b:
                continue
            place = self._doubtful(a, b)
            if place is None:
                continue
            self.say(f"{float(a):.6g} of {float(self.load_max):.6g}, {len(self.crossings)} crossings")
            box = self._crossing(a, b, float(place)) if depth >= 3 else None
            if box is not None:
                self.crossings.append(box)
                waiting += [(box.high, b, depth), (a, box.low, depth)]
            elif depth == FINEST:
                raise Inseparable(a, b, self.crossings)
            else:
                middle = a + (b - a) * Fraction(33, 64)  # crossings like round loads
                waiting += [(middle, b, depth + 1), (a, middle, depth + 1)]

    # --- no crossing on a stretch ---------------------------------------------------------------------------

    def _doubtful(self, a: Fraction, b: Fraction, hole: tuple[Fraction, Fraction] | None = None) -> Fraction | None:
        """A place x about which h and g may have a common zero for a ≤ P ≤ b; None where that is disproven for all.

        hole: an interval of x that is left out.
        """
        rows = []
        for table in (self.found.h.table, self.found.g.table):
            whole, n = bernstein(a, b, table.nrows() - 1) * table, table.ncols()
            of_x = [arb_poly([whole[i, j] for j in range(n)]) for i in range(whole.nrows())]
            ends = [of_x[0], of_x[-1]] if len(of_x) > 1 else of_x  # which fail first, most often
            rows.append(([*ends, *of_x[1:-1]], n - 1))
        for low, high, first in self._strips((a + b) / 2, hole):
            place = self._strip([rows[first], rows[1 - first]], low, high, HALVINGS)
            if place is not None:
                return place
        return None

    def _strip(
        self, rows: list[tuple[list[arb_poly], int]], low: Fraction, high: Fraction | None, halvings: int
    ) -> Fraction | None:
        if any(keeps_sign(which, low, high, n) for which, n in rows):
            return None
        if high is None or halvings == 0:
            return low if high is None else (low + high) / 2
        middle = (low + high) / 2
        place = self._strip(rows, low, middle, halvings - 1)
        return self._strip(rows, middle, high, halvings - 1) if place is None else place

    def _strips(
        self, P: Fraction, hole: tuple[Fraction, Fraction] | None
    ) -> list[tuple[Fraction, Fraction | None, int]]:
        """The half line x ≥ 0 in strips, each with what has no zeros there at one load: h (0) or g (1). The last
        reaches to ∞."""
        every = [_zeros(which.at(exact(P))) for which in (self.found.h, self.found.g)]
        marks: list[tuple[float, int]] = []
        more: set[float] = set()
        for which, other in ((0, 1), (1, 0)):
            for z in every[which]:
                near = min((abs(z.real - w.real) for w in every[other]), default=float("inf"))
                if z.real > 0 and abs(z.imag) < 0.5 * near:
                    # a pair that has just left the real axis, or is about to come to it, counts as if it were there
                    marks.append((z.real, which))
                elif abs(z.imag) > 0:
                    # strips about as wide as the pair is far away
                    more |= {x for x in (z.real - abs(z.imag), z.real + abs(z.imag)) if x > 0}
        marks.sort()
        top = Fraction(2 * max((abs(z) for group in every for z in group if abs(z) > 0), default=1.0))
        # upper end of a strip, and whose zeros it holds
        cuts = [(Fraction((x + y) / 2), which) for (x, which), (y, other) in pairwise(marks) if which != other]
        cuts.append((top, marks[-1][1] if marks else 1))
        strips: list[tuple[Fraction, Fraction | None, int]] = []
        low = Fraction(0)
        for high, which in cuts:
            between = [low, *sorted(Fraction(x) for x in more if low < x < high), high]
            strips += [(*part, 1 - which) for piece in pairwise(between) for part in _without(*piece, hole)]
            low = high
        return [*strips, (top, None, 0)]

    # --- a crossing on a stretch ----------------------------------------------------------------------------

    def _crossing(self, a: Fraction, b: Fraction, near: float) -> _Found | None:
        """A crossing on a stretch, found from a place where it could not be excluded, in a box of its own."""
        P = exact((a + b) / 2)
        for start in self._starts(P, near):
            z = [P, arb(start)]
            for _ in range(12):
                before = z[0]
                try:
                    z = newton(self.found, z)
                except Unproven:
                    break
                if not abs(z[0] - P) < 3 * exact(b - a):
                    break
                if abs(z[0] - before) < abs(z[0]) * arb(2) ** (-LOWEST_BITS // 2):
                    box = self._box(z[0], z[1], a, b)
                    if box is not None:
                        return box
                    break
        return None

    def _starts(self, P: arb, x: float) -> list[float]:
        """Zeros of h and g next to a place."""
        places = [z.real for which in (self.found.h, self.found.g) for z in _zeros(which.at(P)) if z.real > 0]
        return sorted(places, key=lambda z: abs(z - x))[:3]

    def _box(self, P: arb, x: arb, a: Fraction, b: Fraction) -> _Found | None:
        rests = x == 0
        if not (exact(a) <= P <= exact(b) and (rests or x > 0)):
            return None
        if any(
            c.square is not None and exact(c.low) < P < exact(c.high) and exact(c.bottom) < x < exact(c.top)
            for c in self.crossings
        ):
            return None
        try:
            P, x = enclose(self.found, [P, x], LOWEST_BITS)
        except Unproven:
            return None
        middle, place = rational(P, 60), Fraction(0) if rests else rational(x, 60)
        size = place or Fraction(min((z.real for z in _zeros(self.found.h.at(P)) if z.real > abs(x)), default=1.0))
        local = self.found.about(exact(middle), exact(place))
        # which way the eigenvalues cross
        det = sign(local.slopes([arb(0), arb(0)]).det())
        change = -2 * det if self.found.damped else 2 * det
        width = (b - a) / 2
        for halvings in range(0, 60, 2):
            r = width / 2**halvings
            rho = next((p for k in range(1, 40, 2) if alone(local, r, p := size / 2**k)), None)
            if rho is None or not (exact(middle - r) < P < exact(middle + r)):
                continue
            if rests and not local.leaves_as_pair(*(ball(0, exact(v)) for v in (r, rho))):
                continue
            low, high, bottom, top = middle - r, middle + r, place - rho, place + rho
            if exact(bottom) < x < exact(top) and self._doubtful(max(low, Fraction(0)), high, (bottom, top)) is None:
                return _Found(P, arb(0) if rests else x, low, high, bottom, top, change) if det else None
        return None

    def _divergences(self, a: Fraction, b: Fraction, depth: int) -> None:
        """Every root of det K on a stretch."""
        still = arb_poly([p[0] for p in self.found.h.rows])
        keeps, rising = signs_on([still, still.derivative()], a, b)
        if keeps:
            return
        ends = sign(still(exact(a))), sign(still(exact(b)))
        if rising and all(ends):
            if ends[0] != ends[1]:
                self.crossings.append(self._divergence(a, b, still, rising))
            return
        if depth == FINEST:
            raise Inseparable(a, b, [])
        middle = a + (b - a) * Fraction(33, 64)
        self._divergences(a, middle, depth + 1)
        self._divergences(middle, b, depth + 1)

    def _divergence(self, a: Fraction, b: Fraction, still: arb_poly, rising: int) -> _Found:
        low, high = a, b
        for _ in range(60):
            middle = (low + high) / 2
            there = sign(still(exact(middle)))
            if there == 0:
                break
            low, high = (low, middle) if there == rising else (middle, high)
        (P,) = enclose(self.found, [exact((low + high) / 2)], LOWEST_BITS)
        way = sign(self.found.g(P, arb(0))) * rising * (-1 if self.found.damped else 1)
        if way == 0 or not (exact(a) < P < exact(b)):
            raise Unproven(f"how the eigenvalue zero moves at the load {float(P.mid()):.10g} is not known")
        return _Found(P, None, a, b, Fraction(0), Fraction(0), way)


def _without(low: Fraction, high: Fraction, hole: tuple[Fraction, Fraction] | None) -> list[tuple[Fraction, Fraction]]:
    """An interval less another."""
    if hole is None or hole[1] <= low or hole[0] >= high:
        return [(low, high)]
    return [piece for piece in ((low, hole[0]), (hole[1], high)) if piece[0] < piece[1]]


def _zeros(polynomial: arb_poly) -> list[complex]:
    """All zeros, approximately: they decide where to cut, and the cuts prove themselves."""
    return [complex(z) for z in zeros(polynomial)]
