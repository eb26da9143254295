"""Certified critical loads of the Ritz series: the crossing enclosed, stability below it proven. Eqs. (10), (24), (25).

Hermite and Biehler: all λ lie in the left half plane if and only if the roots of h(P, ·) and g(P, ·)
(`boundary_polynomials.py`) are real, positive, simple and interlace. That is shown for a whole interval of P at once by
points x between neighbouring roots (separators): N + (N − 1) changes of sign use up the degrees, so that nothing but
the signs of polynomials in P need be proven. Towards the crossing, where a root of h meets a root of g, the separator
between them moves with P. A crossing is a common root of h and g: Krawczyk's test encloses it and proves that it is
the only one near; that the test's Jacobian is regular means that the eigenvalue crosses with a speed, so the beam is
unstable just above.

No damping: stability is that the roots of h alone are real, positive and simple; the crossing is a double root.
Divergence: h(P, 0) = det K / det M = 0.

Motions that the load alone restores rest at P = 0: roots of h, and of g where nothing damps them, come from x = 0
there. Separators between them pass through P = x = 0, and signs on these and at x = 0 are those of what is left after
division by the power of P that they hold. Stability is then said of P > 0. Where their damping vanishes with the load
roots of h and g leave x = 0 along the same tangents: on the first stretch g − c h (`g_without_tangents`) takes the
place of g, with a separator more, below all roots of h. It is g at the roots of h, which is what counts.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import cycle, pairwise, zip_longest
from types import ModuleType

from flint import arb, arb_poly

from freebeam_derive.certify.balls import Unproven, ball, exact, precision, rational
from freebeam_derive.certify.bivariate import Bivariate, real_zeros, signs_on
from freebeam_derive.certify.boundary_polynomials import Boundary, Question, boundaries, from_rest, functions_of
from freebeam_derive.certify.decimals import roots
from freebeam_derive.certify.krawczyk import contracts, enclose, newton
from freebeam_derive.certify.one_load import equal, undecided
from freebeam_derive.certify.parts import Part

LOWEST_BITS = 160
MOST_BITS = 60_000
DEEPEST = 120  # bisections of the load axis before a proof is given up
MOST_STRETCHES = 2000  # some tens are usual; a file of so many has 2 MB at eight functions
FAST_HALVINGS = 12  # of it where all that is asked is the sign of some determinants
NEAR = arb("1e-3")  # of a load: how far from where it is looked for a crossing may be
MOST_APART = 400  # digits to which two loads are told apart
Separator = tuple[Fraction, Fraction]


@dataclass(frozen=True)
class Stretch:
    """Stability for start ≤ P ≤ end: separators x = point + slope (P − origin), ascending.

    Slopes are zero but towards a crossing, and where frequencies are so close that separators must move with them.
    """

    start: Fraction
    end: Fraction
    origin: Fraction
    separators: tuple[Separator, ...]


@dataclass(frozen=True)
class Enclosure:
    """A certified critical load. load, square: intervals of P and of ω² (None where kind is "none").

    A pair of eigenvalues that leaves zero is a flutter, and square (0, 0).
    parts: motions that leave the others alone, first those that lose stability; beside: stretches of the others, up to
    the upper end of load, None for one that is the first again, but for the unit of time, and the enclosure of one that
    is lost at exactly the same load. From a frame that turns square is an interval of (ω + turn)², or of ω + turn of
    what whirls.
    proof: crossing (it exists, alone in its box), first, stable_below, kind: true only where proven. Of "none" there is
    no crossing: proven is that the column is stable up to load_max. above_zero: of loads above 0 alone, for at 0 a
    motion rests, or nothing is damped.
    """

    question: Question
    kind: str
    load: tuple[Fraction, Fraction] | None
    square: tuple[Fraction, Fraction] | None
    load_max: Fraction | None
    stretches: tuple[Stretch, ...]
    proof: Mapping[str, bool]
    above_zero: bool = False
    parts: tuple[Part, ...] = ()
    beside: tuple[tuple[Stretch, ...] | Enclosure | None, ...] = ()

    @property
    def lasting(self) -> tuple[tuple[str, ...], ...]:
        """Names of parts that nothing damps beside others that are damped."""
        damped = [part.damped(self.question.kappa is not None) for part in self.parts]
        return tuple(part.names for part, of in zip(self.parts, damped, strict=True) if any(damped) and not of)

    @property
    def at_once(self) -> tuple[tuple[str, tuple[Fraction, Fraction] | None], ...]:
        """Kind and rational interval of ω of each other part that is lost at exactly this load; as `frequency`."""
        found: list[tuple[str, tuple[Fraction, Fraction] | None]] = []
        for part, of in zip(self.parts[1:], self.beside, strict=True):
            if of is None:
                scale = self.parts[0].scale(part)
                assert scale is not None
                factor, omega = Fraction(int(scale.p), int(scale.q)), self.frequency
                found.append((self.kind, omega and (roots(*(factor * v * v for v in omega)) if factor != 1 else omega)))
            elif isinstance(of, Enclosure):
                found.append((of.kind, of.frequency))
        return tuple(found)

    @property
    def frequency(self) -> tuple[Fraction, Fraction] | None:
        """A rational interval of ω, of the slower of two that a turning frame makes of one; None as square is."""
        if self.square is None:
            return None
        turn, whirls = (self.parts[0].turn, self.parts[0].whirls) if self.parts else (Fraction(0), False)
        low, high = self.square if whirls else roots(*self.square)
        ends = sorted((abs(low - turn), abs(high - turn)))
        return (Fraction(0), ends[1]) if low < turn < high else (ends[0], ends[1])


class Together(Unproven):
    """Two parts are lost in one interval of loads, and whether at one load is not known; more digits may do."""


# --- stability on an interval -------------------------------------------------------------------------------


def holds(found: Boundary, stretch: Stretch) -> bool:
    """Whether the signs at the separators prove stability for all P of a stretch, P > 0 where motions rest at 0."""
    start, end = stretch.start - stretch.origin, stretch.end - stretch.origin
    separators, roots = stretch.separators, found.N + (found.between if found.damped else 0)
    leave_zero = bool(found.rests) and stretch.start == 0 == stretch.origin
    tangent = leave_zero and found.tangent
    if len(separators) != roots + tangent:
        return False
    lines = [(Fraction(0), Fraction(0)), *separators]
    # positive and ascending all along the stretch
    if not all(_ascend(lines, t, leave_zero and t == 0) for t in (start, end)):
        return False

    def have(which: Bivariate, lines: Sequence[Separator], expected: Sequence[int]) -> bool:
        along = (which.along(exact(stretch.origin), exact(point), exact(slope)) for point, slope in lines)
        if leave_zero:
            along = (p if point else _without_powers(p) for p, (point, _) in zip(along, lines, strict=True))
        pairs = zip(signs_on(along, start, end), expected, strict=True)
        return all(sign == told for sign, told in pairs)  # the first that differs ends it

    if not found.damped:
        return have(found.h, lines, [(-1) ** k for k in range(found.N + 1)])
    # after 0: u_1, w_1, u_2, …: a root of h before each u, a root of g before each w
    alternating = [(-1) ** ((k + 1) // 2) for k in range(roots + 1)]
    if tangent:
        # the first is below all roots of h; two neighbours about one of these have one sign of g − c h, and N − 1
        # changes between them leave it no root there. The last root of g, if any, is beyond: there it is g that counts
        told, inner = [(-1) ** (k // 2) for k in range(roots + 1)], 2 * found.N
        return (
            have(found.h, separators, alternating)
            and have(found.g_without_tangents, separators[:inner], told[:inner])
            and have(found.g, separators[inner:], told[inner:])
        )
    of_g = separators[: max(1, 2 * found.between)]
    return have(found.h, lines, alternating) and have(found.g, of_g, alternating[: len(of_g)])


def _ascend(lines: Sequence[Separator], t: Fraction, may_meet: bool) -> bool:
    places = [point + slope * t for point, slope in lines]
    return all(a < b or (may_meet and a == b == 0) for a, b in pairwise(places))


def _without_powers(along: arb_poly) -> arb_poly:
    """A polynomial divided by the power of its variable that it is known to hold exactly."""
    none = next((k for k in range(along.degree() + 1) if not along[k].is_zero()), 0)
    return arb_poly([along[k] for k in range(none, along.degree() + 1)])


def interlacing(found: Boundary, P: Fraction) -> list[arb] | None:
    """Roots of h, and with damping those of g between them, at one load; None where they do not interlace: the beam is
    not stable there."""
    merged = h = real_zeros(found.h.at(exact(P)))
    if len(h) != found.N or not float(h[0]) > 0:
        return None
    if found.damped:
        g = real_zeros(found.g.at(exact(P)))
        if len(g) != found.between:
            return None
        merged = [r for pair in zip_longest(h, g) for r in pair if r is not None]
    return None if any(not a < b for a, b in pairwise(merged)) else merged


def separators_at(found: Boundary, P: Fraction) -> tuple[Separator, ...] | None:
    """Points between neighbouring roots at one load; None as of `interlacing`."""
    roots = interlacing(found, P)
    return None if roots is None else _between_roots(roots)


def _between_roots(roots: Sequence[arb]) -> tuple[Separator, ...]:
    middles = (*((a + b) / 2 for a, b in pairwise(roots)), 2 * roots[-1])
    return tuple((rational(m, 100), Fraction(0)) for m in middles)


def _moving(found: Boundary, P: Fraction, roots: Sequence[arb], lines: Sequence[Separator]) -> tuple[Separator, ...]:
    """Lines that move as the roots beside them do at that load: frequencies that are close for a long way need one
    stretch then, and not one for each step that is as long as they are apart."""
    load, of = exact(P), cycle((found.h, found.g) if found.damped else (found.h,))
    speeds = [-f.by_P(load, r) / f.by_x(load, r) for r, f in zip(roots, of, strict=False)]
    slopes = (*((u + v) / 2 for u, v in pairwise(speeds)), arb(0))
    return tuple((point, rational(v if v.is_finite() else 0, 30)) for (point, _), v in zip(lines, slopes, strict=True))


def stretch_over(found: Boundary, a: Fraction, b: Fraction, centre: Boundary | None = None) -> Stretch | None:
    """A stretch that proves stability for a ≤ P ≤ b, None where none was found. Raises Unproven where it is not stable
    in the middle."""
    middle = between(a, b)
    roots = interlacing(centre or found, middle)
    if roots is None:
        raise Unproven(f"the column is not known to be stable at the load {float(middle):.10g}")
    separators = _between_roots(roots)
    tried = [Stretch(a, b, middle, of) for of in (separators, _moving(centre or found, middle, roots, separators))]
    if a == 0 and found.rests:
        lines = _with_lowest(found, middle, separators) if found.tangent else separators
        tried = [
            Stretch(a, b, a, (*((a, point / middle) for point, _ in lines[:count]), *lines[count:]))
            for count in range(min(2 * found.rests + found.tangent, len(lines)) + 1)
        ]
    return next((stretch for stretch in tried if holds(found, stretch)), None)


def _with_lowest(found: Boundary, P: Fraction, separators: Sequence[Separator]) -> Sequence[Separator]:
    """Points between the roots of h and of g − c h, the first of them below all roots of h."""
    h, g = (real_zeros(which.at(exact(P))) for which in (found.h, found.g_without_tangents))
    low = max([arb(0), *(x for x in g if 0 < x < h[0])], key=float)
    places = sorted([low, *h, *(x for x in g if h[0] < x < h[-1])], key=float)
    middles = [(one + other) / 2 for one, other in pairwise(places)]
    upper = separators[2 * found.N - 2 :]  # beyond the last root of h, where the last root of g may be
    return (*((rational(m, 100), Fraction(0)) for m in middles), *upper)


def between(a: Fraction, b: Fraction) -> Fraction:
    """A rational of few bits near the middle of an interval."""
    width = (b - a) / 8
    grid = Fraction(1, 2) ** max(0, (width.denominator // max(1, width.numerator)).bit_length())
    return round((a + b) / 2 / grid) * grid


def cover(
    found: Boundary, start: Fraction, end: Fraction, deepest: int = DEEPEST, centre: Boundary | None = None
) -> list[Stretch]:
    """Stretches that prove stability from start to end. Raises Unproven with the load where it could not be shown.

    centre: where to take the separators from, where `found` stands for more than one system.
    """
    done: list[Stretch] = []
    waiting = [(start, end, 0)]
    while waiting:
        a, b, depth = waiting.pop()
        stretch = stretch_over(found, a, b, centre)
        if stretch is not None:
            done.append(stretch)
            continue
        if len(done) == MOST_STRETCHES:
            raise Unproven(f"stability is not shown on {MOST_STRETCHES} stretches, for frequencies stay too close")
        if depth == deepest:
            raise Unproven(f"stability could not be shown between the loads {float(a):.12g} and {float(b):.12g}")
        middle = between(a, b)
        waiting += [(middle, b, depth + 1), (a, middle, depth + 1)]
    return sorted(done, key=lambda s: s.start)


def _slopes_through(found: Boundary, P: Fraction, x: Fraction, start: Fraction, share: float) -> list[Fraction]:
    """Slopes of the separators that pass through a crossing: one between the root of h and that of g that meet there,
    and, in a limit of vanishing damping, two where two roots of h do, on either side of the root of g."""
    if not found.damped:
        return [Fraction(0)]
    if not found.between:  # g has no root, and nothing closes in
        return []
    J, bend = found.slopes([exact(P), exact(x)]), found.h.by_x.by_x(exact(P), exact(x))
    if abs(J[0, 1]) < abs(bend) * exact(x) * arb(2) ** (-LOWEST_BITS // 2):
        # h is h_P (P − P*) + h_xx (x − x*)² / 2, or about so
        apart = (abs(2 * J[0, 0] / bend) / exact(P - start)).sqrt() * share
        return [rational(-J[1, 0] / J[1, 1] + apart * side, 30) for side in (1, -1)]
    flat, steep = sorted((-J[i, 0] / J[i, 1] for i in range(2)), key=lambda v: float(abs(v)))
    return [rational(flat + (steep - flat) * share, 30)]


def check_fast(found: Boundary, end: Fraction) -> None:
    """Coordinates without mass on which damping ε C acts decay by themselves, at a rate of 1/ε, for 0 ≤ P ≤ end.

    By Routh's scheme on balls of loads. Raises Unproven.
    """
    waiting = [(Fraction(0), end)] if found.fast else []
    while waiting:
        a, b = waiting.pop()
        P = exact(a).union(exact(b))
        upper, lower = ([p(P) / found.fast[-1](P) for p in found.fast[k::-2]] for k in (-1, -2))
        while lower and lower[0] > 0:
            left = [u - upper[0] / lower[0] * v for u, v in zip_longest(upper[1:], lower[1:], fillvalue=arb(0))]
            upper, lower = lower, left
        if lower:
            if (b - a) * 2**FAST_HALVINGS < end:
                raise Unproven(
                    f"coordinates without mass are not known to decay at the load {float(a):.10g} in the limit of "
                    "vanishing damping, which acts on them"
                )
            middle = (a + b) / 2
            waiting += [(middle, b), (a, middle)]


def _towards(
    found: Boundary, P: Fraction, x: Fraction | None, start: Fraction, end: Fraction, share: float
) -> Stretch | None:
    """A stretch that runs up to a crossing at (P, x), or to a divergence (x None).

    share: of the way from the flatter of the two meeting curves to the steeper one, for the separator between them.
    """
    separators = separators_at(found, start)
    if separators is None:
        return None
    if x is not None:
        # separators that the crossing closes in on pass through it
        slopes = _slopes_through(found, P, x, start, share)
        there = [float(x + slope * (start - P)) for slope in slopes]
        places = [float(point) for point, _ in separators]
        first = min(
            range(len(places) + 1 - len(there)),
            key=lambda k: sum(abs(a - b) for a, b in zip(places[k:], there, strict=False)),
        )
        separators = (*separators[:first], *((x, slope) for slope in slopes), *separators[first + len(slopes) :])
    stretch = Stretch(start, end, P, separators)
    return stretch if holds(found, stretch) else None


# --- the proof ----------------------------------------------------------------------------------------------


def bits_for(functions: int, digits: int) -> int:
    """Bits to begin with; where a proof fails for want of them they are doubled.

    Of 12, 16, 20 a function none was doubled up to N = 28 (free-free and Beck; α = 0, 0.001 and 1; 20 digits). 8 do for
    18 to 50 functions on three segments, 6 do not for 50.
    """
    return LOWEST_BITS + int(3.33 * digits) + 12 * functions


def certify(
    kernel: ModuleType,
    question: Question,
    near: tuple[float | Fraction, float] | None,
    digits: int,
    load_max: Fraction = Fraction(1000),
    progress: Callable[[str], None] | None = None,
) -> Enclosure:
    """Enclose the first loss of stability near a candidate (load, frequency), or prove that none is up to `load_max`.

    near: what to start from, None for none. digits: decimal digits; the relative width is below 10^−digits. The
    working precision follows from the digits and is doubled where a proof fails for want of it.

    Raises Unproven with what could not be established.
    """
    say = progress or (lambda _: None)

    def seen(rest: bool) -> Enclosure:
        """Two planes that a turning frame couples from rest, or, where that does not do, from a frame."""
        try:
            return _with_bits(kernel, question, near, digits, load_max, say, rest)
        except Unproven as error:
            if isinstance(error, Together) or not rest or not from_rest(kernel, question):
                raise
        # a top falls where its frequencies are zero as seen from rest, which is no divergence
        return seen(False)

    while True:
        try:
            return seen(True)
        except Together:
            if 2 * digits > MOST_APART:
                raise
            digits *= 2


def _with_bits(
    kernel: ModuleType,
    question: Question,
    near: tuple[float | Fraction, float] | None,
    digits: int,
    load_max: Fraction,
    say: Callable[[str], None],
    rest: bool,
) -> Enclosure:
    """As `certify`; rest: two planes that a turning frame couples are seen from rest."""
    bits = bits_for(functions_of(kernel, question.modes), digits)
    reason = ""
    while bits <= MOST_BITS:
        with precision(bits):
            say(f"{bits} bits")
            try:
                top = load_max if near is None else Fraction(near[0])
                parts = boundaries(kernel, question, bits, rest, top)
                return certify_parts(parts, question, near, digits, bits, load_max)
            except Together:
                raise
            except Unproven as error:
                if reason == str(error):
                    raise
                reason = str(error)
        bits *= 2
    raise Unproven(reason)


def certify_parts(
    parts: list[Boundary],
    question: Question,
    near: tuple[float | Fraction, float] | None,
    digits: int,
    bits: int,
    load_max: Fraction,
) -> Enclosure:
    """As `certify`, of parts that leave each other alone, in balls of so many bits: one loses stability, and none of
    the others up to there."""
    if near is None:
        proof = {"crossing": False, "first": False, "stable_below": True, "kind": True}
        first, others, end = parts[0], parts[1:], load_max
        stretches = _stable(first, end)
        found = Enclosure(question, "none", None, None, end, stretches, proof, first.above_zero)
    else:
        first, start = _place(parts, near)
        others = [part for part in parts if part is not first]
        found = _certify_near(first, question, near, start, digits, bits)
        assert found.load is not None
        end = found.load[1]
    if not first.part or not (others or first.part.turn):
        return found
    found = replace(found, parts=(first.part,))
    try:
        beside = tuple(_beside(of, found, end, digits, bits) for of in others)
    except Together:
        raise
    except Unproven as error:
        raise Unproven(f"{error}; of motions that others leave alone") from error
    every = (first.part, *(of.part for of in others if of.part))
    return replace(found, above_zero=any(of.above_zero for of in parts), parts=every, beside=beside)


def _beside(
    part: Boundary, first: Enclosure, end: Fraction, digits: int, bits: int
) -> tuple[Stretch, ...] | Enclosure | None:
    """What an enclosure of the first part holds of another; that is the first again, but for the unit of time, or loses
    stability at exactly the same load, or is stable up to an end."""
    assert part.part is not None
    if first.parts[0].scale(part.part) is not None:
        return None
    also = None if first.load is None else _lost_within(part, first, digits, bits)
    return also or _stable(part, end)


def _lost_within(part: Boundary, first: Enclosure, digits: int, bits: int) -> Enclosure | None:
    """Where another part is lost in the first one's interval of loads: at exactly the same load. Raises Together where
    that is not known."""
    assert first.load is not None and part.part is not None
    low, high = first.load
    middle = (low + high) / 2
    P = exact(middle)
    tops = (part.h, part.g) if part.damped else (part.g,)
    starts = [[load, arb(0)] for load in part.twice] + ([[P]] if not part.part.turn else [])
    starts += [[P, x] for of in tops for x in real_zeros(of.at(P)) if x > 0]
    for start in starts:
        try:
            z = start
            for _ in range(0 if start[-1] == 0 else 6):
                z = [v.mid() for v in newton(part, z)]
            if not (exact(low) < z[0] < exact(high) and all(x >= 0 for x in z[1:])):
                continue
            found = _certify_near(part, first.question, (middle, 0), z, digits, bits, middle)
        except Unproven:
            continue
        each = tuple((p, bool(of.square and any(of.square))) for p, of in ((first.parts[0], first), (part.part, found)))
        if not equal(each, first.question.kappa is not None, low, high):
            raise Together(undecided(each, low, high))
        return replace(found, parts=(part.part,))
    return None


def _stable(part: Boundary, end: Fraction) -> tuple[Stretch, ...]:
    check_fast(part, end)
    return tuple(cover(part, Fraction(0), end))


def _place(parts: list[Boundary], near: tuple[float | Fraction, float]) -> tuple[Boundary, list[arb]]:
    """Which part has a crossing near a candidate, and where Newton's method for it starts."""
    load, omega = exact(Fraction(near[0])), arb(near[1])
    each: list[tuple[Boundary, list[arb]]] = []
    for found in parts:
        turn, whirls = (exact(found.part.turn), found.part.whirls) if found.part else (arb(0), False)
        if turn == 0:
            rests = near[1] == 0 and any(abs(P - load) < load * NEAR for P in found.twice)
            each.append((found, [load, omega**2] if near[1] > 0 or rests else [load]))
        elif near[1] > 0:  # x = 0 is no divergence there
            seen = turn + omega, turn - omega
            each += [(found, [load, x if whirls else x**2]) for x in seen]
    if not each:
        raise Unproven("a divergence is not one of a frame that turns")

    def distance(item: tuple[Boundary, list[arb]]) -> float:
        part, z = item
        try:
            for _ in range(4):
                z = [v.mid() for v in newton(part, z)]
        except Unproven:
            return math.inf
        found = sum(float(abs(v - w) / (abs(w) if w != 0 else 1)) for v, w in zip(z, item[1], strict=True))
        return found if math.isfinite(found) else math.inf

    return each[0] if len(each) == 1 else min(each, key=distance)


def refined(found: Boundary, z: Sequence[arb], bits: int, reached: int) -> list[arb]:
    """Newton's method from an approximation of so many bits, which each step doubles; then balls about the zero."""
    while reached < 2 * bits:
        z = newton(found, z)
        reached *= 2
    return enclose(found, z, bits)


def _certify_near(
    found: Boundary,
    question: Question,
    near: tuple[float | Fraction, float],
    z: list[arb],
    digits: int,
    bits: int,
    middle: Fraction | None = None,
) -> Enclosure:
    """middle: of the interval of loads, where it is given."""
    start, flutter, rests = z[0], len(z) > 1, z[-1] == 0
    P, *squares = refined(found, z, bits, 20)
    if not abs(P - start) < abs(start) * NEAR:
        raise Unproven(f"no crossing was found near the load {float(near[0]):.10g}")
    if not rests and any(not x > 0 for x in squares):
        raise Unproven("the crossing's frequency is not known to be positive")
    tolerance = Fraction(1, 10 ** (max(digits, 8) + 2))
    middle = rational(P, bits) if middle is None else middle
    low, high = middle - abs(middle) * tolerance / 2, middle + abs(middle) * tolerance / 2
    if not exact(low) < P < exact(high):
        raise Unproven(f"the crossing near {float(near[0]):.10g} could not be enclosed to {digits} digits")
    check_fast(found, high)
    point = Fraction(0) if rests else rational(squares[0], bits) if flutter else None
    kind, there = "flutter" if flutter else "divergence", f"{float(middle):.10g}"
    try:
        last = _last_stretch(found, middle, point, tolerance)
        # of stability away from the crossing the digits do not matter
        with precision(bits * bits_for(found.N, 0) // bits_for(found.N, digits)):
            stretches = (*cover(found, Fraction(0), last.start), last)
    except Unproven as error:
        raise Unproven(
            f"{error}; established is that there is a crossing, of {kind}, at {there}, not that it is the first"
        ) from error
    square = None
    if point is None:
        single = not found.slopes([exact(low).union(exact(high))])[0, 0].contains(0)
    else:
        local = found.about(exact(middle), exact(point))
        spread = spread_of(local, middle, point, tolerance)
        square = point - spread, point + spread
        if not exact(square[0]) < squares[0] < exact(square[1]):
            raise Unproven("the frequency could not be enclosed to the digits asked for")
        if found.part and found.part.whirls and square[0] <= found.part.turn <= square[1]:
            raise Unproven(f"whether the frequency of the whirl at the load {there} is zero is not known")
        single = alone(local, middle * tolerance / 2, spread)
        if rests:
            radii = (exact(middle * tolerance / 2), exact(spread))
            single, square = single and local.leaves_as_pair(*(ball(0, r) for r in radii)), (point, point)
    if not single:
        raise Unproven(
            f"a second crossing may lie with the one at {there} in the interval of {digits} digits; established "
            "is that the column is stable below; ask for more digits to tell them apart"
        )
    proof = {"crossing": True, "first": True, "stable_below": True, "kind": True}
    return Enclosure(question, kind, (low, high), square, None, stretches, proof, found.above_zero)


def spread_of(local: Boundary, load: Fraction, point: Fraction, tolerance: Fraction) -> Fraction:
    """So far the root of g that passes through a crossing at (load, x = point) stays from there for all loads within
    this share of it, and farther; that of h where g is a function of P alone. local: P and x counted from the
    crossing."""
    J, row = local.slopes([arb(0), arb(0)]), int(local.between > 0)
    return tolerance * (point + load * rational(abs(J[row, 0] / J[row, 1]).upper(), 60))


def alone(local: Boundary, r: Fraction, rho: Fraction) -> bool:
    """Whether (h, g) is one to one on the box |P| ≤ r, |x| ≤ ρ about the point from which P and x are counted."""
    radii = [exact(r), exact(rho)]
    return contracts(local.slopes([arb(0), arb(0)]), local.slopes([ball(0, radius) for radius in radii]), radii)


def _last_stretch(found: Boundary, load: Fraction, point: Fraction | None, tolerance: Fraction) -> Stretch:
    """A stretch to just below a crossing at (load, x = point), or a divergence (None). Raises Unproven."""
    end, reach = load * (1 - tolerance / 2), Fraction(1, 8)
    while reach > tolerance:
        begin = between(load * (1 - reach), load * (1 - reach / 2))
        # the curves bend, the more so near a coalescence: a line close to the flatter one stays between them longest
        for share in (0.5, 2.0**-6, 2.0**-16):
            last = _towards(found, load, point, begin, end, share)
            if last is not None:
                return last
        reach /= 4
    raise Unproven(f"stability just below the load {float(load):.10g} could not be shown")
