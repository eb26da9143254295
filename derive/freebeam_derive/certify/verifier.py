"""Check a certificate: a program of its own that shares no code with the one that wrote it.

What acceptance proves, with C = of_M M + of_E E and K = E + P H, of the series of N functions:

    THEOREM. For every load 0 ≤ P ≤ low (the lower end of the load's interval; load_max where the kind is "none") the
    column is stable. Where the kind is "flutter" or "divergence", there is exactly one load P* with low ≤ P* ≤ high at
    which an eigenvalue λ is on the imaginary axis, and stability is lost there:
    - flutter: a pair λ = ±iω with ω > 0 and ω² within frequency_squared, and no other eigenvalue; det K > 0 for all
      low ≤ P ≤ high. Where frequency_squared is 0: two eigenvalues are 0, a conjugate pair at loads next to P*, and
      det K > 0 but for P*.
    - divergence: λ = 0, and no other eigenvalue; det K passes zero.
    The crossing is simple: with damping, and in its limit, the eigenvalue is simple and crosses at a speed that is not
    zero; without damping two frequencies meet, ω² of a double root of det(K − ω² M), and are no longer real above. So
    they may in the limit, and do where the damping is external alone.

Stable means: all eigenvalues of λ² M + λ C + K in the open left half plane; without damping all λ² real, negative and
simple; in the limit (vanishing) that this is so, and that damping of the given direction makes every motion decay to
first order.

Of forms on segments (format 2) M, K and C = C_1 + alpha C_alpha + beta C_beta are polynomials in P, of forms and of a
space in the file; undamped is where C is nothing, or where the determinant is even in λ (gyroscopic terms alone). Where
C is nothing at P = 0 alone, as in a pipe that conveys fluid, the theorem is one of 0 < P ≤ low, and at P = 0 all λ² are
real, negative and simple. Where K is singular at P = 0 (motions that the load alone restores) it is one of 0 < P ≤ low.
Where coordinates have no mass, eigenvalues are the finite ones, as many as the degree in λ. Rigid motions R are left
out: it is checked that M, C and K take them to M_0 R for every P, and that among them λ is 0 or −c, c ≥ 0. The
eigenvalues of the whole are these and those of the functions M_0-orthogonal to R, of which the theorem is; along R a
displacement may grow as a power of time.

PROOF, in full in docs/proofs.md. det(K − x M + iωC) = h(P, x) + iω g(P, x) with x = ω², polynomials of degree N in P
and x together (N − 1 for g; of forms by powers of P as many in P as rows of M, C and K can have, and of ⌊d/2⌋ and
⌊(d − 1)/2⌋ in x, where d is the degree in λ, found exactly by `verifier_degrees`); in the limit g is the first order in
C, without damping it stands for h_x. Where C is P^k times another, g is divided by P^k; on lines through P = x = 0 both
are by the power of P that they hold there. An eigenvalue on the imaginary axis is a common root of h and g with x > 0,
or a root of h at x = 0.
They are interpolated here from determinants of balls, and checked:

(i) On stretches from 0 to low, lines on which h, and g, have alternating signs leave a root of each between neighbours
    and use up the degrees: the roots are real, positive, simple and (with damping) interlace. Hermite and Biehler.
    Where motions rest at P = 0 and their damping vanishes with the load, the first stretch has a line more, and g − c h
    in place of g: about each root of h it has one sign, which is that of g there.
(ii) On [low, high], outside the box x_low < x < x_high, cells of x in [0, ∞), the last in 1/x, on each of which h or g
    is not zero (`apart`); next to the box g has no other root than that in it, for g_x is not zero there. det M ≠ 0.
(iii) In the box g has for each P one root ξ(P), and φ(P) = h(P, ξ(P)) has the slope (h_P g_x − h_x g_P) / g_x, not
    zero, and changes sign: one common root, simple, crossed at a speed. At x = 0: h(P, 0) = det K > 0. Where g is a
    function of P alone (one motion, with its damping) h and g change places.
(iv) Divergence has no box: h(P, 0) falls on all of [low, high], from > 0 to < 0. Of a pair that leaves zero it is known
    exactly that h = h_P = g = 0 at x = 0 and one load (`check_pair_at_rest`); (ii) and (iii) hold with a box about it,
    and (h_PP, g_P, h_x) there make both λ / (P − P*) of a positive real part, and no real numbers.
(v) Motions that leave each other alone in M, C and K (`apart`, `motions`) have stretches each, to low where stability
    is lost, to high of the others, but for those that are the first again (`alike`), or are so in another unit of time
    (`rescaled`), which lose it with that; (ii) to (iv) are of the first, and of others that are lost at P* too: both
    loads are roots of one polynomial that has no other from low to high (`check_one_load`). Of two planes that are
    alike and that rates alone couple, x is (ω + turn)² or ω + turn (`seen`): as seen from rest where a frame couples
    them which turns at that rate, so that two pairs meet at P*; else of one sense of whirl, and of the other at −ω.
    Frequencies of different parts, or senses, may be one.
(vi) In a limit of vanishing damping that acts on coordinates without mass these decay by themselves (`Fast`), at a rate
    of 1 over the damping; g has then the degree of h, and a root beyond all roots of h. ∎

Products of trial functions are integrated as the bilinear forms say, in closed form; on segments all is rational until
determinants are taken. Numbers are balls: a comparison is true only where it is proven. Where `column` is one of this
program's and of format 1, ends and forms are those that it has at `parameters`, and the factors of the damping are its
at alpha, beta and kappa; of any other column all is proven of what is in the file, and the statement says so.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import cache, cached_property
from itertools import pairwise, product, zip_longest
from pathlib import Path
from typing import Any

import flint
from flint import acb, acb_mat, arb, arb_mat, arb_poly, arb_series, fmpq, fmpq_mat, fmpq_poly, fmpq_series, fmpz_mat

from freebeam_derive.certify.decimals import roots
from freebeam_derive.certify.verifier_claims import (
    HIGHEST_POWER,
    MOST_MODES,
    ORDERS,
    Form,
    Lost,
    OfBeam,
    OfForms,
    Refused,
    Statement,
    ball,
    check_column,
    claims_of,
    contents,
    crossing,
    damping_of,
    direction,
    exact,
    form,
    is_ours,
    number,
    parsed,
    ratio,
    require,
    whirl,
)
from freebeam_derive.certify.verifier_degrees import Degrees, degrees, kernel
from freebeam_derive.certify.verifier_loads import check_one_load, check_pair_at_rest
from freebeam_derive.certify.verifier_motions import Motion, in_other_coordinates, motions
from freebeam_derive.certify.verifier_parts import alike, rescaled, seen, seen_damped, taken

FORMAT, GENERAL = "freebeam certificate 1", "freebeam certificate 2"
CLAIM = {"format", "column", "parameters", "modes", "forms", "alpha", "beta", "kind", "load", "frequency_squared",
         "load_max", "proof", "stretches"}  # fmt: skip
FIELDS = CLAIM | {"ends", "basis", "kappa", "damping"}
GENERAL_FIELDS = CLAIM | {"breaks", "fields", "coordinates", "rigid", "kappa"}
ACTS = {"K_alpha", "K_beta"}  # what a damping that vanishes does on displacements
APART = {"parts", "beside"}  # of motions that leave each other alone
Basis = tuple[Callable[..., arb], Callable[..., arb]]
Line = tuple[Fraction, Fraction]
Value = tuple[str, int, Fraction | None, int]  # name, order of derivative, place (None: a coordinate), side
GeneralForm = tuple[list[tuple[int, str, int, str, int, fmpq_poly]], list[tuple[Value, Value, fmpq]]]

# As in verifier_claims: more than any certificate holds that is written.
MOST_CELLS = 100_000
MOST_UNKNOWNS, MOST_PARTS, MOST_POWERS, MOST_NAMES, MOST_MOTIONS, HIGHEST_ORDER = 400, 1000, 9, 20, 10, 4
LONGEST, LONGEST_BREAKS = 200, 1000  # characters of a number of forms on segments, and of all breaks
MOST_WORK = 20_000_000  # terms times sizes times digits: a second; 5,000,000 are 20 segments of 12 functions


# --- what a certificate says ------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Stretch:
    """Lines x = point + slope (P − origin) for start ≤ P ≤ end, the first at x = 0."""

    start: Fraction
    end: Fraction
    origin: Fraction
    lines: tuple[Line, ...]


Checked = tuple[Callable[[], "System"], list[Stretch], Callable[["Series"], None] | None]
Read = tuple[Statement, int, Callable[[], "System"], list[Stretch], list[Checked]]
"""The statement, the number of functions, the matrices at the precision in hand, the stretches, and those of others; of
each of these that is lost at the same load a check that it is."""


def of_beam(data: dict[str, Any]) -> Read:
    """A certificate of M, E, H over one segment."""
    require(set(data) == FIELDS, f"fields are missing, or not known: {', '.join(sorted(FIELDS ^ set(data)))[:100]}")
    basis, N = data["basis"], data["modes"]
    require(basis in BASES, "the basis is not known")
    left, right = data["ends"]
    require(left in ORDERS and right in ORDERS, "the ends are not known")
    claims = claims_of(data)
    kappa, damping = damping_of(data, claims)
    require(set(data["forms"]) == set("MEH"), "the forms are not M, E and H")
    forms = {name: form(data["forms"][name]) for name in "MEH"}
    ours = is_ours(claims["column"])
    stated = OfBeam(**claims, ours=ours, ends=(left, right), basis=basis, kappa=kappa, damping=damping)
    if ours:
        check_column(stated, forms)

    def system() -> System:
        M, E, H = matrices([left, right], basis, N, forms).values()
        C = [ball(damping.of_M) * M + ball(damping.of_E) * E] if damping else []
        return System([M], C, [E, H], kappa is not None)

    return stated, N, system, _stretches(data["stretches"], stated.end, 2 * N if damping else N + 1), []


def _stretches(data: Any, end: Fraction, count: int, rests: bool = False, more: bool = False) -> list[Stretch]:
    """Stretches without a gap from 0 to the end, with so many ascending lines; rests: which may meet at P = x = 0;
    more: the first has one more."""
    stretches = [_stretch(stretch) for stretch in data]
    reached = Fraction(0)
    for s in stretches:
        where = f"between the loads {float(s.start):.10g} and {float(s.end):.10g}"
        require(s.start == reached < s.end, "the stretches leave a gap")
        require(len(s.lines) == count + (more and not reached), f"there are too few separators, or too many, {where}")
        for P in (s.start, s.end):
            places = [point + slope * (P - s.origin) for point, slope in s.lines]
            meet = rests and P == 0 == s.origin
            ascend = all(a < b or (meet and a == b == 0) for a, b in pairwise(places))
            require(ascend, f"the separators do not ascend {where}")
        reached = s.end
    require(reached == end > 0, "stability is not shown up to the load")
    return stretches


def _stretch(data: dict[str, Any]) -> Stretch:
    require(set(data) == {"start", "end", "origin", "separators"}, "a stretch has other parts than it should")
    start, end, origin = (number(data[k]) for k in ("start", "end", "origin"))
    lines = ((number(point), number(slope)) for point, slope in data["separators"])
    return Stretch(start, end, origin, ((Fraction(0), Fraction(0)), *lines))


# --- trial functions: modes of the comparison beam, of sin γx, cos γx, e^(−γx), e^(−γ(1−x)) ----------------------


def turned(sine: Any, cosine: Any, order: int) -> tuple[Any, Any]:
    """A derivative of sine and cosine."""
    return ((sine, cosine), (cosine, -sine), (-sine, -cosine), (-cosine, sine))[order]


def conditions(g: Any, ends: list[str]) -> list[list[Any]]:
    """The end conditions, each divided by γ^d, over the four functions; g a ball or a series."""
    s, c, e = g.sin(), g.cos(), (-g).exp()
    at_0 = [[*turned(0, 1, d), (-1) ** d, e] for d in ORDERS[ends[0]]]
    return at_0 + [[*turned(s, c, d), (-1) ** d * e, 1] for d in ORDERS[ends[1]]]


def determinant(m: list[list[Any]]) -> Any:
    """By expansion, for balls and series alike."""
    minors = ([row[:k] + row[k + 1 :] for row in m[1:]] for k in range(len(m)))
    return sum((-1) ** k * m[0][k] * determinant(minor) for k, minor in enumerate(minors)) if m else 1


def characteristic(g: arb, ends: list[str], terms: int = 2) -> Any:
    """Taylor coefficients about γ of the characteristic determinant times e^γ."""
    variable = arb_series([g, 1], terms)
    return determinant(conditions(variable, ends)) * variable.exp()


def gammas(ends: list[str], count: int) -> list[arb]:
    """The first positive roots of the characteristic determinant, each alone in its ball, none left out."""
    # up to an order all derivatives vanish at γ = 0, exactly; while the next one keeps its sign there is no other root
    at_0 = determinant(conditions(fmpq_series([0, 1], 8), ends))
    order = next(k for k in range(8) if at_0[k] != 0)
    found: list[arb] = []
    with flint.ctx.workprec(min(flint.ctx.prec, 128)):  # to tell them apart
        near_0 = (characteristic(arb(k).union(arb(k + 1)) / 256, ends, order + 1)[order] for k in range(128))
        require(not any(c.contains(0) for c in near_0), "the characteristic determinant may vanish close to γ = 0")
        low = arb(1) / 2
        while len(found) < count:
            found, low = found + within(low, low + arb(1) / 2, ends), low + arb(1) / 2
    return [refined(box, ends) for box in found[:count]]


def refined(box: arb, ends: list[str]) -> arb:
    """The one root in a ball, by interval Newton to the precision in hand."""
    while True:
        middle = arb(box.mid())
        step = characteristic(middle, ends)[0] / characteristic(box, ends)[1]
        image = (middle - step).intersection(box)
        if not image.rad() < box.rad() * arb("0.9"):
            return box
        box = image


def within(low: arb, high: arb, ends: list[str]) -> list[arb]:
    """Boxes with one root each from low to high, by bisection, and none besides."""
    box, middle = low.union(high), (low + high) / 2
    value, slope = (characteristic(box, ends)[k] for k in (0, 1))
    if not value.contains(0):
        return []
    if slope.contains(0):
        require(high - low > arb("1e-9"), f"roots near γ = {float(low):.8g} could not be told apart")
        return within(low, middle, ends) + within(middle, high, ends)
    change = characteristic(low, ends)[0] * characteristic(high, ends)[0]
    require(not change.contains(0), "a root lies on the edge of a box")
    return [] if change > 0 else [box]


def modes(ends: list[str], count: int, roots: list[arb] | None = None) -> Basis:
    """Derivatives of the first modes at a place; integrals of x^power times derivatives of two of them."""
    found, factors = roots or gammas(ends, count), []
    for g in found:
        # the determinant vanishes: its cofactors along the last row solve all four equations, and nothing else does
        rows = conditions(g, ends)[:3]
        cofactors = [(-1) ** k * determinant([row[:k] + row[k + 1 :] for row in rows]) for k in range(4)]
        leading = [c for c in cofactors if not c.contains(0)]
        require(bool(leading), "a mode could not be computed")
        factors.append([c / leading[0] for c in cofactors])

    def waves(n: int, d: int) -> list[tuple[acb, acb]]:
        """The d-th derivative of a mode as a sum of w exp(z x): pairs (z, w), z = iγ, −iγ, −γ, γ."""
        (a, b, c, e), g = factors[n], found[n]
        sums = (acb(0, g), acb(b, -a) / 2), (acb(0, -g), acb(b, a) / 2), (acb(-g), acb(c)), (acb(g), e * acb(-g).exp())
        return [(z, w * z**d) for z, w in sums]

    def value(n: int, d: int, x: int) -> arb:
        return sum((w * (z * x).exp() for z, w in waves(n, d)), acb(0)).real

    @cache
    def moments(power: int, one: int, other: int) -> list[list[acb]]:
        """∫ x^power exp((z + z') x) dx for each two exponents of two modes, by parts."""
        rows = []
        for k, (z, _) in enumerate(waves(one, 0)):
            row = []
            for m, (y, _) in enumerate(waves(other, 0)):
                if one == other and (k, m) in ((0, 1), (1, 0), (2, 3), (3, 2)):
                    row.append(acb(1) / (power + 1))  # the sum of exponents is zero
                    continue
                end, total = (z + y).exp(), ((z + y).exp() - 1) / (z + y)
                for n in range(1, power + 1):
                    total = (end - n * total) / (z + y)
                row.append(total)
            rows.append(row)
        return rows

    def integral(power: int, one: tuple[int, int], other: tuple[int, int]) -> arb:
        known = moments(power, one[0], other[0])
        left, right = waves(*one), waves(*other)
        terms = (w * v * known[k][m] for k, (_, w) in enumerate(left) for m, (_, v) in enumerate(right))
        return sum(terms, acb(0)).real

    return value, integral


# --- trial functions: polynomials that meet the geometric conditions, orthogonal to the rigid motions --------------


def polynomials(ends: list[str], count: int) -> Basis:
    """As `modes`. Any basis of these polynomials has the same eigenvalues; their degree follows from their number."""
    held = [(d, end) for end, kind in enumerate(ends) for d in ORDERS[kind] if d < 2]

    def meeting(degree: int, rigid: list[fmpq_poly]) -> list[fmpq_poly]:
        rows = [[k**d if end else int(k == d) for k in range(degree + 1)] for d, end in held]
        rows += [[(power(k) * r).integral()(1) for k in range(degree + 1)] for r in rigid]
        # a row of zeros, for there may be no condition
        found, size = fmpq_mat([*rows, [0] * (degree + 1)]).numer_denom()[0].nullspace()
        return [fmpq_poly([found[k, n] for k in range(degree + 1)]) for n in range(size)]

    rigid = meeting(1, [])
    found = meeting(count - 1 + len(held) + len(rigid), rigid)
    require(len(found) == count, "there are not so many polynomials of that degree")

    def derivative(n: int, d: int) -> fmpq_poly:
        return derivative(n, d - 1).derivative() if d else found[n]

    def integral(degree: int, one: tuple[int, int], other: tuple[int, int]) -> arb:
        return arb((power(degree) * derivative(*one) * derivative(*other)).integral()(1))

    return lambda n, d, x: arb(derivative(n, d)(x)), integral


def power(k: int) -> fmpq_poly:
    return fmpq_poly([0] * k + [1])


BASES = {"modes": modes, "legendre": polynomials}


def matrices(ends: list[str], basis: str, N: int, forms: dict[str, Form]) -> dict[str, arb_mat]:
    """M, E, H from the bilinear forms."""
    value, integral = (cache(function) for function in BASES[basis](ends, N))

    def entry(i: int, j: int, along: Any, points: Any) -> arb:
        inside = [ball(v) * integral(k, *sorted([(i, p), (j, q)])) for k, p, q, v in along]
        return sum((ball(v) * value(i, p, x) * value(j, q, y) for x, p, y, q, v in points), sum(inside, arb(0)))

    return {name: arb_mat([[entry(i, j, *forms[name]) for j in range(N)] for i in range(N)]) for name in "MEH"}


# --- any column: polynomials on segments, and coordinates ---------------------------------------------------------


@dataclass(frozen=True)
class Space:
    """Trial functions: on each segment polynomials of degree D − 1 in ξ, 0 ≤ ξ ≤ 1, for each field, and coordinates.

    Values and derivatives of an order below `joined` are continuous at breaks but where `opened` (break, order), and
    zero where `held` (end, order). Unknowns are all coefficients, those of a field and segment from `start` on.
    """

    breaks: tuple[Fraction, ...]
    fields: dict[str, tuple[int, set[tuple[int, int]], set[tuple[int, int]]]]
    coordinates: tuple[str, ...]
    D: int

    @property
    def size(self) -> int:
        return len(self.fields) * (len(self.breaks) - 1) * self.D + len(self.coordinates)

    def start(self, name: str, segment: int) -> int:
        if name in self.fields:
            return (list(self.fields).index(name) * (len(self.breaks) - 1) + segment) * self.D
        return self.size - len(self.coordinates) + self.coordinates.index(name)

    def ends(self, segment: int) -> tuple[fmpq, fmpq]:
        """Left end and length of a segment."""
        low, high = self.breaks[segment : segment + 2]
        return exact(low), exact(high - low)

    def value(self, name: str, order: int, place: Fraction | None, side: int) -> tuple[int, list[fmpq]]:
        """A derivative at a place, as factors of the unknowns from some number on; a coordinate where there is none."""
        if place is None:
            return self.start(name, 0), [fmpq(1)]
        segment = sum(low < place or (low == place and side >= 0) for low in self.breaks[1:-1])
        low, length = self.ends(segment)
        xi = (exact(place) - low) / length
        values = [math.perm(k, order) * xi ** max(k - order, 0) / length**order for k in range(self.D)]
        return self.start(name, segment), values

    def conditions(self) -> list[list[fmpq]]:
        """Rows of factors that vanish on the trial functions."""
        rows = []
        for name, (joined, held, opened) in self.fields.items():
            joints = {*product(range(1, len(self.breaks) - 1), range(joined))} - opened
            alone = [[((name, order, self.breaks[-end], 0), 1)] for end, order in held]
            pairs = [[((name, order, self.breaks[k], side), side) for side in (-1, 1)] for k, order in joints]
            for values in alone + pairs:
                row = [fmpq(0)] * self.size
                for value, sign in values:
                    start, factors = self.value(*value)
                    row[start : start + self.D] = [sign * factor for factor in factors]
                rows.append(row)
        return rows

    def matrix(self, *forms: tuple[fmpq, GeneralForm]) -> fmpq_mat:
        """Forms times numbers, as a matrix of all unknowns."""
        total = [[fmpq(0)] * self.size for _ in range(self.size)]
        for times, (along, points) in forms:
            for segment, test, p, trial, q, factor in along:
                rows, columns = (self.D if name in self.fields else 1 for name in (test, trial))
                low, length = self.ends(segment)
                weight = times * length ** (1 - p - q) * factor(fmpq_poly([low, length]))
                moments = [(power(k) * weight).integral()(1) for k in range(rows + columns)]
                first, other = self.start(test, segment), self.start(trial, segment)
                for i, j in product(range(p, rows), range(q, columns)):
                    total[first + i][other + j] += math.perm(i, p) * math.perm(j, q) * moments[i + j - p - q]
            for one, two, shared in points:
                (first, ones), (other, others) = self.value(*one), self.value(*two)
                for (i, u), (j, v) in product(enumerate(ones), enumerate(others)):
                    total[first + i][other + j] += times * shared * u * v
        return fmpq_mat(total)


def nothing(*matrices: fmpq_mat) -> bool:
    return all(v == 0 for X in matrices for v in X.entries())


def reduced(space: Space, motions: list[list[fmpq]], *terms: list[fmpq_mat]) -> tuple[fmpq_mat, list[list[fmpq_mat]]]:
    """Trial functions that are M_0-orthogonal to the rigid motions R, and their M, C, K; C empty where it is nothing.

    Checked is that R meets the conditions, that M_0 is regular on it, that M, C and K take it to M_0 R for every load,
    and that among these motions K² = 0 and C = c M_0 with c ≥ 0, so that λ is 0 or −c.
    """
    rows, R, M_0 = space.conditions(), fmpq_mat(motions).transpose(), terms[0][0]
    if motions:
        require(not rows or nothing(fmpq_mat(rows) * R), "a rigid motion does not meet the supports and joints")
        among = R.transpose() * M_0 * R
        require(among.det() != 0, "the rigid motions are not independent, or without mass")
        rows += (R.transpose() * M_0).tolist()
    whole = [fmpq_mat([row]).numer_denom()[0].tolist()[0] for row in [*rows, [fmpq(0)] * space.size]]
    found, N = fmpz_mat(whole).nullspace()
    require(0 < N <= MOST_MODES, f"the number of functions is not from 1 to {MOST_MODES}")
    units = [next(found[k, n] for k in reversed(range(space.size)) if found[k, n] != 0) for n in range(N)]
    W = fmpq_mat([[fmpq(found[k, n], units[n]) for n in range(N)] for k in range(space.size)])
    if motions:
        alone = nothing(*(W.transpose() * X * R for powers in terms for X in powers))
        require(alone, "a rigid motion is not left to itself by M, C and K")
        M, C, K = ([among.solve(R.transpose() * X * R) for X in powers] for powers in terms)
        decay = C[0][0, 0] if C else fmpq(0)
        rates = [C[0] - decay * M[0]] if C else []  # M[0] is the identity
        require(decay >= 0 and nothing(*M[1:], *C[1:], *rates), "a rigid motion is not known to rest, or to decay")
        require(nothing(*(one * other for one in K for other in K)), "the load or a spring acts on a rigid motion")
    M, C, K = ([W.transpose() * X * W for X in powers] for powers in terms)
    while C and nothing(C[-1]):
        C.pop()
    return W, [M, C, K]


# --- motions that leave each other alone --------------------------------------------------------------------------


def apart(space: Space, parts: Any, W: fmpq_mat, terms: list[list[fmpq_mat]], limit: bool) -> list[Part]:
    """The parts of a file. Those of different names: each trial function is of one, and no matrix couples two. Those of
    the same names are all that `motions` finds."""
    parts = _list(parts, MOST_NAMES)
    require(all(set(part) == {"names", "motion", "frame"} for part in parts), "a part is not names, motion and frame")
    names = [_list(part["names"], MOST_NAMES) for part in parts]
    groups = [group for k, group in enumerate(names) if group not in names[:k]]
    whole = [*space.fields, *space.coordinates]
    listed = sorted(name for group in groups for name in group)
    require(listed == sorted(whole) and all(groups), "the parts are not all fields and coordinates")
    segments = len(space.breaks) - 1
    of = [name for name in whole for _ in range(space.D * segments if name in space.fields else 1)]
    held = [[of[i] for i in range(space.size) if W[i, n] != 0] for n in range(W.ncols())]
    rows = [[n for n, each in enumerate(held) if set(each) <= set(group)] for group in groups]
    require(sum(map(len, rows)) == W.ncols(), "a trial function is of two parts")
    found: list[Part | None] = [None] * len(parts)
    for group, own in zip(groups, rows, strict=True):
        others = [n for n in range(W.ncols()) if n not in own]
        alone = not others or nothing(*(Y for powers in terms for Y in taken(powers, own, others)))
        require(bool(own) and alone, f"{' and '.join(group)} and the others do not leave each other alone")
        mine = [k for k, each in enumerate(names) if each == group]
        inner, stays = ([taken(powers, own, own) for powers in of] for of in (terms[:3], terms[3:]))
        frames = [parts[k]["frame"] for k in mine]
        frame = frames[0] if type(frames[0]) is dict and "before" in frames[0] else None
        turn, whirls = None, False
        if frame is not None:  # seen from a frame first, then taken apart
            alike = all(of == frame for of in frames) and not limit
            require(alike, "parts of two planes are not seen from one frame")
            inner, turn, whirls = _seen(inner, frame, [held[n][-1] for n in own], limit)
        rates = [] if nothing(*inner[1]) else inner[1]
        damped = bool(rates) if limit else not degrees(inner[0], rates, inner[2]).even
        each = motions(inner, damped) if len(mine) > 1 else [Motion(inner, list(range(len(own))))]
        order = sorted(_whole(parts[k]["motion"], 0, MOST_NAMES) for k in mine)
        require(order == list(range(len(each))), "the parts are not all of the motions that leave each other alone")
        for k in mine:
            motion = each[parts[k]["motion"]]
            if turn is None:
                require(len(mine) == 1 or nothing(*stays[0], *stays[1]), "rates that stay tell motions apart")
                rows_of = [held[own[n]][-1] for n in motion.stands]
                of_motion = Part.of(motion, limit, stays, frames[mine.index(k)], rows_of, group)
                found[k] = replace(of_motion, whole=inner[2])
            else:
                found[k] = replace(Part.of(motion, limit, names=group), turn=turn, whirls=whirls)
    return [part for part in found if part]


def of_forms(data: dict[str, Any]) -> Read:
    """A certificate of forms on segments."""
    differ = ", ".join(sorted(GENERAL_FIELDS ^ (set(data) - APART)))[:100]
    require(set(data) in (GENERAL_FIELDS, GENERAL_FIELDS | APART), f"fields are missing, or not known: {differ}")
    claims, space, given = claims_of(data, at_zero=True), _space(data), data["forms"]
    kappa = ratio(data["kappa"])
    acts = ACTS if kappa is not None and set(given) & ACTS else set()
    require(
        set(given) == {"M", "C_1", "C_alpha", "C_beta", "K"} | acts, "the forms are not M, C_1, C_alpha, C_beta and K"
    )
    powers = [form for name in given for form in _list(given[name], MOST_POWERS)]
    terms = [term for form in powers for part in ("along", "points") for term in _list(form[part], MOST_PARTS)]
    degree = max((len(term[-1]) for term in terms if type(term[-1]) is list), default=0)
    longest = max(map(len, _texts([data["breaks"], given, data["rigid"], data["alpha"], data["beta"]])))
    work = len(terms) * (space.D + degree) ** 3 * longest
    require(longest <= LONGEST and work <= MOST_WORK, "the forms have more terms, or longer ones, than any written")
    forms = {name: [_form(form, space) for form in given[name]] for name in given}
    motions = [_motion(motion, space) for motion in _list(data["rigid"], MOST_MOTIONS)]
    require(bool(forms["M"] and forms["K"]), "there is no mass, or no stiffness")
    M, K = ([space.matrix((fmpq(1), form)) for form in forms[name]] for name in "MK")
    dampings = (claims["alpha"], claims["beta"]) if kappa is None else direction(kappa)
    if kappa is not None:
        fits = kappa >= 0 == claims["alpha"] == claims["beta"]
        require(fits, "kappa is negative, or alpha and beta are not 0 in its limit")

    def summed(**sizes: fmpq) -> list[fmpq_mat]:
        each = [[(size, form) for form in forms.get(name, [])] for name, size in sizes.items()]
        return [space.matrix(*filter(None, of)) for of in zip_longest(*each)]

    split, limit, (one, other) = "parts" in data, kappa is not None, map(exact, dampings)
    C = summed(**{} if limit else {"C_1": fmpq(1)}, C_alpha=one, C_beta=other)
    W, whole = reduced(space, motions, M, C, K)
    stays = [summed(C_1=fmpq(1)), summed(K_alpha=one, K_beta=other)] if limit else [[], []]
    whole += [[W.transpose() * X * W for X in powers] for powers in stays]
    rates = whole[3] if limit and not nothing(*whole[3]) else [] if limit else whole[1]
    require(bool(whole[1]) or not limit, "there is no damping that could vanish")
    if limit and not nothing(*whole[3], *whole[4]):
        require(not motions, "a vanishing damping leaves rates, or acts on displacements, beside rigid motions")
        require(degrees(whole[0], rates, whole[2]).even, "the damping C_1 stays where alpha and beta vanish")
    each = apart(space, data["parts"], W, whole, limit) if split else [Part.of(Motion(whole[:3], []), limit, whole[3:])]
    beside = _list(data.get("beside", []), MOST_NAMES)
    require(len(beside) == len(each) - 1, "the stretches of each part are not there")
    first, damped = each[0], any(part.damped for part in each)
    lasting = tuple(tuple(part.names) for part in each if damped and not part.damped)
    again = [lines is None for lines in beside]
    those = [part for part, same in zip(each[1:], again, strict=True) if same]
    scales = [part.scale(first) for part in those]
    require(None not in scales, "a part without stretches is not the first again")
    others = list(zip(each[1:], beside, strict=True))
    lost = [part.lost(data["load"], of) if type(of) is dict else None for part, of in others]
    stated = OfForms(
        **claims, kappa=kappa, breaks=space.breaks, unknowns=(*space.fields, *space.coordinates), size=W.ncols(),
        motions=len(motions), damped=damped, lasting=lasting, gyroscopic=bool(rates) and (limit or not damped),
        above_zero=any(part.above_zero for part in each),
        parts=tuple(tuple(part["names"]) for part in data.get("parts", [])),
        scales=(Fraction(1), *filter(None, scales)), turn=first.turn, whirls=first.whirls,
        at_once=tuple(filter(None, lost)),
    )  # fmt: skip
    require(first.turn is None or stated.kind != "divergence", "a divergence is not one of a frame that turns")
    turns = stated.frequency is None or not first.whirls or stated.frequency[0] > 0
    require(turns, "the frequency of a whirl may be zero")
    besides = [
        part.beside(first, stated, of, how) for (part, of), how in zip(others, lost, strict=True) if of is not None
    ]
    return stated, W.ncols(), first.system, first.stretches(data["stretches"], stated.end), besides


@dataclass(frozen=True)
class Part:
    """Motions that leave all others alone: M, C and K by powers of the load, exact. motion: where they are those of all
    roots of a polynomial, which one is meant. limit: of vanishing damping. turn: the rate of a frame from which one of
    two planes is seen that rates couple; whirls: with ω + turn in place of ω². names: of fields and coordinates.
    whole: K of all motions of these names. stays: rates that stay where damping vanishes, and what that does on
    displacements."""

    M: list[fmpq_mat]
    C: list[fmpq_mat]
    K: list[fmpq_mat]
    motion: Motion
    limit: bool
    known: Degrees
    fast: Fast | None
    turn: fmpq | None = None
    whirls: bool = False
    names: Sequence[str] = ()
    whole: Sequence[fmpq_mat] = ()
    stays: Sequence[list[fmpq_mat]] = ()

    @staticmethod
    def of(
        motion: Motion,
        limit: bool,
        stays: Sequence[list[fmpq_mat]] = (),
        frame: Any = None,
        rows: Sequence[str] = (),
        names: Sequence[str] = (),
    ) -> Part:
        """frame: of a file, or none; rows: the field or coordinate that each row stands for."""
        M, C, K = motion.terms
        turn, whirls, fast = None, False, None
        C = [] if nothing(*C) else C
        limit, stays = limit and bool(C), [] if nothing(*(X for powers in stays for X in powers)) else stays
        if stays and not limit:
            require(nothing(*stays[1]), "what vanishes acts on displacements alone")
            C, stays = stays[0], []
        if frame is not None:
            require(motion.count == 1, "two planes are not seen from a frame where roots tell motions apart")
            (M, C, K), turn, whirls = _seen([M, C, K, *stays], frame, rows, limit)
            require(not limit or M[0].det() != 0, "a motion has no mass, beside damping that vanishes in a frame")
            stays = []
        known = degrees(M, [] if stays else C, K)
        if stays:
            regular = known.highest == 2 * M[0].nrows() and not known.resting
            require(regular, "a motion has no mass, or rests without load, beside rates that stay")
        elif limit:
            still = degrees(M, [], K).highest
            if known.highest > still:
                require(motion.count == 1, "damping acts on what has no mass, where roots tell motions apart")
                fast = Fast.of(M, C, K, still, known.highest - still)
            known = replace(known, highest=still + (fast is not None))
        known = known.each(motion.count, not limit and (not C or motion.even))
        require(known.highest > 1, "no motion has a frequency")
        return Part(M, C, K, motion, limit, known, fast, turn, whirls, names, motion.terms[2], stays)

    def scale(self, other: Part) -> Fraction | None:
        """λ² in it over those in another that it is again: 1 for the same motions, or the same matrices but for one
        factor; another number where it is so but for the unit of time. None where it is not."""
        if self.names == other.names and self.motion.kind == other.motion.kind >= 0:
            return Fraction(1)
        if not self.motion.count == other.motion.count == 1 or (self.turn, self.whirls) != (other.turn, other.whirls):
            return None
        if self.stays or other.stays:
            return None
        if alike(self._terms, other._terms):
            return Fraction(1)
        found = rescaled(other._terms, self._terms) if self.turn is None else None
        found = found or in_other_coordinates(other._terms, self._terms)
        if found is None or (found != 1 and self.turn is not None):
            return None
        return Fraction(int(found.p), int(found.q))

    @property
    def _terms(self) -> list[list[fmpq_mat]]:
        return [self.M, self.C, self.K]

    @property
    def damped(self) -> bool:
        return bool(self.C) and (self.limit or not self.known.even)

    @property
    def above_zero(self) -> bool:
        return bool(self.known.resting) or (self.damped and nothing(self.C[0]))

    def system(self) -> System:
        """At the precision in hand."""
        terms = [self.M, self.C, self.K]
        M, C, K = (
            [[arb_mat(X) for X in powers] for powers in terms] if self.motion.count == 1 else self.motion.matrices()
        )
        G, S = ([arb_mat(X) for X in powers] for powers in self.stays or ([], []))
        C = C[: len(self.C)]
        known = self.known, self.fast, self.turn, self.whirls, self._pair_at_rest
        return System(M, C if self.C else [], K, self.limit, *known, G, S)

    def _pair_at_rest(self, low: Fraction, high: Fraction) -> None:
        """At one load between two, two motions rest: exactly, of those of all roots of a polynomial together, and no
        others of these do."""
        require(self.turn is None and not self.limit, "no pair leaves zero there")
        load = check_pair_at_rest(self._terms, self.whole, low, high)
        for n in range(self.motion.count):
            others = _at_load(replace(self.motion, number=n).matrices()[2], load) if n != self.motion.number else None
            require(others is None or others.det() != 0, "which of several motions rest is not known")

    def lost(self, load: Any, data: Any) -> Lost:
        """What a file says of it, where that is that it is lost at the same load as the first."""
        require(set(data) == {"kind", "frequency_squared", "stretches"}, "a part beside has other parts than it should")
        claimed = crossing(data | {"load": load}, at_zero=True)
        require(claimed["load"] is not None, "a part beside is lost, and the first is not")
        square = claimed["square"]
        require(self.turn is None or square is not None, "a divergence is not one of a frame that turns")
        omega = square if square is None else roots(*square)
        if self.whirls and square is not None and self.turn is not None:
            omega = whirl(square, self.turn)
            require(omega[0] > 0, "the frequency of a whirl may be zero")
        return Lost(tuple(self.names), claimed["kind"], square, omega, None if self.whirls else self.turn)

    def beside(self, first: Part, stated: OfForms, data: Any, lost: Lost | None) -> Checked:
        """What is to be checked of it beside the first; data: its stretches, or how it is lost at the same load."""
        if lost is None or stated.load is None:
            return self.system, self.stretches(data, stated.top), None
        low, high = stated.load

        def check(series: Series) -> None:
            require(series.check_crossing(low, high, lost.square) > 0, "stability is not lost there")
            require(not (first.stays or self.stays), "two loads are not known to be one beside rates that stay")
            both = [
                (p._terms, bool(square and any(square))) for p, square in ((first, stated.square), (self, lost.square))
            ]
            check_one_load(both, first.limit or self.limit, ball(low).union(ball(high)))

        return self.system, self.stretches(data["stretches"], low), check

    def stretches(self, data: Any, end: Fraction) -> list[Stretch]:
        count = self.known.highest if self.damped else self.known.highest // 2 + 1
        more = self.damped and self.known.touching
        return _stretches(data, end, count, self.known.resting > 0, more)


def _seen(
    terms: list[list[fmpq_mat]], frame: Any, rows: Sequence[str], limit: bool
) -> tuple[list[list[fmpq_mat]], fmpq, bool]:
    """Two planes as seen from the frame of a file, its rate, and whether x is ω + turn; rows: of which field or
    coordinate each is."""
    keys = {"planes", "turn"} | ({"before"} if frame.get("before") is True else set())
    require(set(frame) == keys and (limit or not nothing(*terms[1])), "a frame is none of rates")
    planes = [_list(plane, MOST_NAMES) for plane in _list(frame["planes"], 2)]
    turn = exact(number(frame["turn"]))
    require(len(planes) == 2 and turn > 0, "a frame is not two planes, or does not turn")
    each = [[n for name in plane for n, of in enumerate(rows) if of == name] for plane in planes]
    if limit:
        return seen_damped([*terms, *([[], []] if len(terms) == 3 else [])], each, turn), turn, True
    found, whirls = seen(terms, each, turn)
    return found, turn, whirls


def _space(data: dict[str, Any]) -> Space:
    """Breaks, fields and coordinates, as few and small as any that are written."""
    places = _list(data["breaks"], MOST_UNKNOWNS)
    require(sum(map(len, places)) <= LONGEST_BREAKS, "the breaks are longer than any written")
    breaks = tuple(map(number, places))
    given, coordinates = data["fields"], tuple(_list(data["coordinates"], MOST_NAMES))
    ascend = len(breaks) > 1 and all(a < b for a, b in pairwise(breaks))
    require(ascend and breaks[0] == 0 and breaks[-1] == 1, "the breaks do not ascend from 0 to 1")
    names = [*given, *coordinates]
    require(0 < len(names) == len(set(names)) <= MOST_NAMES, "a name stands twice, or there are none, or too many")
    known = all(type(name) is str and name.isidentifier() and len(name) <= 200 for name in names)
    require(known, "a field or coordinate has no name")
    fields = {}
    for name, of in given.items():
        require(set(of) == {"joined", "held", "opened"}, "a field is not joined, held and opened")
        joined, last = _whole(of["joined"], 0, 2), len(breaks) - 2
        held = {(_whole(end, 0, 1), _whole(order, 0, joined - 1)) for end, order in _list(of["held"], 4)}
        opened = {(_whole(k, 1, last), _whole(order, 0, joined - 1)) for k, order in _list(of["opened"], 2 * last)}
        fields[name] = joined, held, opened
    space = Space(breaks, fields, coordinates, data["modes"] + 2)
    require(space.size <= MOST_UNKNOWNS, f"there are more than {MOST_UNKNOWNS} unknowns")
    return space


def _list(value: Any, most: int) -> list[Any]:
    require(type(value) is list and len(value) <= most, "what should be a list is none, or longer than any written")
    return list(value)


def _whole(value: Any, least: int, most: int) -> int:
    require(type(value) is int and least <= value <= most, f"a number is not a whole one from {least} to {most}")
    return int(value)


def _texts(data: Any) -> Iterator[str]:
    """All texts in lists and objects."""
    if isinstance(data, str):
        yield data
    elif isinstance(data, list | dict):
        for value in data.values() if isinstance(data, dict) else data:
            yield from _texts(value)


def _polynomial(factors: Any) -> fmpq_poly:
    require(len(factors) > 0, "a polynomial has no factors")
    return fmpq_poly([exact(number(v)) for v in _list(factors, HIGHEST_POWER)])


def _form(data: dict[str, Any], space: Space) -> GeneralForm:
    """Integrals over a segment of polynomials times Dᵖ test D^q trial, and products of values."""
    require(set(data) == {"along", "points"}, "a form has other parts than integrals and values")

    def of(name: str, order: Any) -> tuple[str, int]:
        known = name in (*space.fields, *space.coordinates)
        require(known, "a form is of a field or coordinate that there is not")
        return name, _whole(order, 0, HIGHEST_ORDER if name in space.fields else 0)

    def value(name: str, order: Any, place: Any, side: Any) -> Value:
        require((place is None) == (name in space.coordinates), "a value has no place, or a coordinate has one")
        if place is None:
            return *of(name, order), None, _whole(side, 0, 0)
        at = number(place)
        require(0 <= at <= 1, "a place lies off the beam")
        return *of(name, order), at, _whole(side, -1, 1)

    along = [
        (_whole(segment, 0, len(space.breaks) - 2), *of(test, p), *of(trial, q), _polynomial(f))
        for segment, test, p, trial, q, f in data["along"]
    ]
    return along, [(value(*test), value(*trial), exact(number(f))) for test, trial, f in data["points"]]


def _motion(data: dict[str, Any], space: Space) -> list[fmpq]:
    """A rigid motion by its unknowns: lines in x for each segment of a field, a number for a coordinate."""
    unknowns = [fmpq(0)] * space.size
    for name, given in data.items():
        if name in space.coordinates:
            unknowns[space.start(name, 0)] = exact(number(given))
            continue
        require(name in space.fields and len(given) == len(space.breaks) - 1, "a rigid motion is of other fields")
        for segment, factors in enumerate(given):
            line = _polynomial(factors)(fmpq_poly([*space.ends(segment)]))
            require(line.degree() < min(2, space.D), "a rigid motion is no line")
            for k, factor in enumerate(line.coeffs()):
                unknowns[space.start(name, segment) + k] = factor
    return unknowns


# --- stability ----------------------------------------------------------------------------------------------

Rows = list[arb_poly]  # over the powers of x, polynomials in P


@dataclass(frozen=True)
class Fast:
    """Coordinates without mass on which damping ε C acts: λ = μ/ε, to lowest order, with det(μ C + K) = 0 of them.

    C, K: of these alone, by powers of the load; count: how many such μ there are.
    """

    C: list[fmpq_mat]
    K: list[fmpq_mat]
    count: int

    @staticmethod
    def of(M: list[fmpq_mat], C: list[fmpq_mat], K: list[fmpq_mat], still: int, count: int) -> Fast:
        """still: the degree in λ without damping, which is to be all that mass gives."""
        rank = M[0].rank()
        require(still == 2 * rank, "damping that vanishes acts on what has neither mass nor stiffness")
        rows, columns = kernel(M[0]), kernel(M[0].transpose()).transpose()
        alone = nothing(*(Y for X in M[1:] for Y in (rows * X, X * columns)))
        require(alone, "damping that vanishes acts on what gets mass from the load")
        n = M[0].nrows() - rank  # without the row and column of zeros that `kernel` adds
        whole = [[(rows * X * columns).tolist() for X in terms] for terms in (C, K)]
        of_C, of_K = ([fmpq_mat([row[:n] for row in X[:n]]) for X in terms] for terms in whole)
        return Fast(of_C, of_K, count)

    def decay(self, end: Fraction) -> None:
        """Re μ < 0 for all loads from 0 to an end: Hurwitz's determinants on balls of loads."""
        waiting = [(Fraction(0), end)]
        while waiting:
            low, high = waiting.pop()
            if self._decay(ball(low).union(ball(high))):
                continue
            narrow = (high - low) * 10_000 < end
            require(not narrow, f"coordinates without mass may not decay at the load {float(low):.10g}")
            waiting += [((low + high) / 2, high), (low, (low + high) / 2)]

    def _decay(self, P: arb) -> bool:
        C, K = (_at_load([arb_mat(X) for X in terms], P) for terms in (self.C, self.K))
        places = [arb(k) for k in range(self.count + 1)]
        p = arb_poly.interpolate(places, [(K + mu * C).det() for mu in places])
        if not p[self.count] != 0:
            return False
        a = [p[self.count - k] / p[self.count] if k <= self.count else arb(0) for k in range(2 * self.count + 1)]
        H = [[a[2 * i - j + 1] if 2 * i >= j - 1 else arb(0) for j in range(self.count)] for i in range(self.count)]
        return all(arb_mat([row[:k] for row in H[:k]]).det() > 0 for k in range(1, self.count + 1))


@dataclass(frozen=True)
class System:
    """M, C and K by powers of the load; C empty without damping. vanishing: C is nothing but a direction. known: what
    holds exactly of their determinant; of none M is regular, and K without load. turn, whirls: as of a `Part`.
    pair_at_rest: checks that two λ are zero at one load between two. G, S: rates that stay where damping vanishes, and
    what that does on displacements."""

    M: list[arb_mat]
    C: list[arb_mat]
    K: list[arb_mat]
    vanishing: bool
    known: Degrees | None = None
    fast: Fast | None = None
    turn: fmpq | None = None
    whirls: bool = False
    pair_at_rest: Callable[[Fraction, Fraction], None] | None = None
    G: list[arb_mat] = field(default_factory=list)
    S: list[arb_mat] = field(default_factory=list)

    @property
    def centre(self) -> arb:
        """Of what whirls the x of ω = 0, about which a crossing is looked at: far from it most terms would cancel."""
        return arb(0) if self.turn is None or not self.whirls else arb(self.turn)

    @property
    def degrees(self) -> Degrees:
        return self.known or Degrees(2 * self.M[0].nrows(), not self.C, 0, True)


class Series:
    """h and g of det(K − x M + iωC) = h + iωg at ω = √x; without damping g is h_x.

    Where C is nothing at P = 0, g is divided by the power of P that it has then.
    """

    def __init__(self, system: System, end: Fraction, places: list[Fraction]) -> None:
        """places: between the roots of h at small loads, one more than these, where determinants are taken."""
        known = system.degrees
        self.system, self.odd, self.resting = system, bool(known.highest % 2), known.resting
        self.damped = bool(system.C) and not (known.even and not system.vanishing)
        self.touching = self.damped and known.touching
        self.N, self.of_g = known.highest // 2, (known.highest - 1) // 2
        vanishing = ((k, X) for terms in (system.C, system.S) for k, X in enumerate(terms))
        self.power = min((k for k, X in vanishing if any(not v == 0 for v in X.entries())), default=0)
        rows = system.M[0].nrows()
        count = max(1, sum(_powers_of_row(system, i) for i in range(rows)))
        loads = [end * (k + (self.resting > 0)) / count for k in range(count + 1)]  # where K is regular
        signs = ((-1) ** k for k in range(self.N + 1))
        values = []
        for x, sign in zip(places, signs, strict=True):
            values.append([self._determinant(ball(P), ball(x)) for P in loads[:1]])
            # before the rest of the work is begun
            separated = self.resting > 0 or bool(sign * values[-1][0][0] * self.sign > 0)
            require(separated, "the roots of h are not separated without load")
        for x, row in zip(places, values, strict=True):
            row += [self._determinant(ball(P), ball(x)) for P in loads[1:]]
        both = (system.M,), (system.C, system.G), (system.K, system.S)  # of as many λ in a row
        powers = [max(max(map(len, of)) - 1, 0) for of in both]
        tops = [min(count, highest(b, rows, *powers)) for b in range(self.N + 1)]
        self.h = _interpolated(places, loads, [[h for h, _ in row] for row in values], tops)
        self.h = self._without(self.h, 0, 0)
        self.g = by_x(self.h)
        if self.damped:
            tops = [min(count, powers[1] + highest(b, rows - 1, *powers)) - self.power for b in range(self.of_g + 1)]
            used = loads[min(self.power, 1) :]
            sizes = [ball(P) ** self.power for P in used]
            of_g = [[g / size for (_, g), size in zip(row[-len(used) :], sizes, strict=True)] for row in values]
            self.g = _interpolated(places[: self.of_g + 1], used, of_g[: self.of_g + 1], tops)
            self.g = self._without(self.g, self.power, 1)

    @cached_property
    def without_tangents(self) -> Rows:
        """g − c h, without the part of order r in P and x that h and g have in common where r motions rest."""
        r = self.resting
        require(self.h[r][0] != 0, "a motion that rests is not known to have mass")
        c = self.g[r][0] / self.h[r][0]
        pairs = zip_longest(self.g, self.h, fillvalue=arb_poly())
        both = [one - c * other for one, other in pairs]
        return [arb_poly([arb(0) if a + b <= r else p[a] for a in range(p.degree() + 1)]) for b, p in enumerate(both)]

    @cached_property
    def sign(self) -> int:
        """That of the determinant at λ = 1 without load, by which all is multiplied where it need not be positive."""
        if not self.system.known:
            return 1
        terms = self.system.M, self.system.K, [] if self.system.vanishing else self.system.C
        whole = sum((X[0] for X in terms if X), 0 * self.system.K[0]).det()
        require(whole != 0, "the determinant may vanish at λ = 1 without load")
        return 1 if whole > 0 else -1

    @property
    def leading(self) -> list[Rows]:
        """Of h and g those whose highest factor is that of the highest power of λ."""
        return [self.g, self.h] if self.system.fast else [self.g] if self.odd else [self.h]

    def _without(self, which: Rows, of_load: int, of_rate: int) -> Rows:
        """Multiplied by the sign; and what is known to have no part is exactly nothing."""
        absent, zero = self.system.degrees.absent, arb(0)
        return [
            arb_poly([
                zero if absent(a + of_load, 2 * b + of_rate) else self.sign * p[a] for a in range(p.degree() + 1)
            ])
            for b, p in enumerate(which)
        ]  # fmt: skip

    def _determinant(self, P: arb, x: arb) -> tuple[arb, arb]:
        system = self.system
        M, C, K, G, S = (_at_load(terms, P) for terms in (system.M, system.C, system.K, system.G, system.S))
        A = K - x * M
        if system.G or system.S:
            G, S = (X if X.nrows() else 0 * A for X in (G, S))
            return _first_order(A, C, G, S, x)
        if not self.system.C:
            return A.det(), arb(0)
        if self.system.vanishing or x == 0:
            # g to first order in the damping, which at x = 0 is all of it
            return A.det(), A.det() * (A.inv() * C).trace()
        omega = x.sqrt()
        d = (acb_mat(A) + acb(0, 1) * omega * acb_mat(C)).det()
        return d.real, d.imag / omega

    def check_stable(self, stretch: Stretch) -> None:
        """(i) of the proof: real, positive, simple roots of h, and with damping of g between them.

        The signs are those of polynomials in t = origin − P.
        """
        start, end, origin = stretch.start, stretch.end, stretch.origin
        where = f"between the loads {float(start):.10g} and {float(end):.10g}"
        near, far = (ball(origin - P) for P in (end, start))
        back = arb_poly([ball(origin), -1])
        h, g = ([p(back) for p in which] for which in (self.h, self.g))
        from_rest = self.resting > 0 and start == 0 == origin
        touching = self.touching and start == 0
        less = [p(back) for p in self.without_tangents] if touching else g
        last = 2 * self.N - 1 if touching else max(1, 2 * self.of_g)
        for k, (point, slope) in enumerate(stretch.lines[1:] if touching else stretch.lines):
            line = arb_poly([ball(point), ball(-slope)])
            sign_h, sign_g = (-1) ** ((k + 1) // 2 if self.damped else k), (-1) ** (k // 2)
            each = [(h, sign_h, "h")]
            if self.damped and (touching or k > 0):
                # where g − c h stands for g, the last root of an odd determinant's g is beyond all its roots
                each += [(less, sign_g, "g")] if k <= last else [(g, sign_g, "g")] if touching else []
            for which, sign, name in each:
                along = sign * _along(which, line)
                if from_rest and point == 0:
                    along = _divided(along)
                require(positive(along, near, far), f"the roots of {name} are not separated {where}")

    def check_crossing(self, low: Fraction, high: Fraction, square: tuple[Fraction, Fraction] | None) -> int:
        """(ii) to (iv) of the proof: exactly one crossing for low ≤ P ≤ high, with ω² in `square`, or λ = 0 (None).

        How many eigenvalues more are unstable above it: 2 or −2 of a pair, 1 or −1 of λ = 0.
        """
        start, end = ball(low), ball(high)
        over, centre = Over(start.union(end)), self.system.centre
        h, g = (_about(which, centre) for which in (self.h, self.g))
        h_P, g_P = by_load(h), by_load(g)
        turned_h, turned_g = h[::-1], g[::-1]  # x^N h(1/x), x^(N − 1) g(1/x)
        regular = all(over(which[-1:], arb(0)) != 0 for which in self.leading)
        if square is None:
            slope, rate = over(h_P, arb(0)), over(g, arb(0))
            require(slope != 0, "det K does not fall, or rise, throughout the load's interval")
            require(opposite(h[0](start), h[0](end)), "det K does not change sign within the load's interval")
            over.apart(h, g, arb(0), arb(1))
            over.apart(turned_h, turned_g, arb(0), arb(1))
            require(regular, "det M may vanish within the load's interval")
            require(rate != 0, "how an eigenvalue leaves zero is not known")
            return 1 if (slope * rate < 0) == self.damped else -1
        pair = not any(square)
        if pair:
            top = self._about_zero(low, high, over)
            bottom = -top
        else:
            require(over(h, -centre) != 0, "det K may vanish within the load's interval")
            bottom, top = (ball(x) - centre for x in square)
        box, h_x, alone = bottom.union(top), by_x(h), self.damped and len(g) == 1
        f, o = (h, g) if alone else (g, h)
        f_x = by_x(f)
        across = opposite(over(f, bottom), over(f, top))
        require(across, "the frequency's interval is not known to hold a root of g at each of the loads")
        size, lowest = top + centre, (bottom - centre) / 2
        around = (((bottom - size / 2**k).max(lowest), top + size / 2**k) for k in range(1, flint.ctx.prec))
        left, right = next((v for v in around if over(f_x, v[0].union(v[1])) != 0), (bottom, top))
        require(over(f_x, left.union(right)) != 0, "the frequency's interval may hold more than one crossing")
        far = right.max(centre)
        if not pair:
            over.apart(h, g, -centre, left)
        if centre > right:
            over.apart(h, g, right, far)
        over.apart(turned_h, turned_g, arb(0), 1 / far)
        require(regular, "det M may vanish within the load's interval")
        slope = over(by_load(o), box) - over(by_x(o), box) * over(by_load(f), box) / over(f_x, box)
        require(slope != 0, "the crossing is not known to be simple and alone")
        across = opposite(*(_along_root(o, f, P, box) for P in (start, end)))
        require(across, "nothing is known to cross within the intervals of load and frequency")
        if pair:
            apart = over(g_P, box) ** 2 + 2 * over(h_x, box) * over(by_load(h_P), box)
            require(apart < 0, "how two eigenvalues leave zero is not known")
        return 2 if (slope * over(f_x, box) < 0) == (self.damped and not alone) else -2

    def _about_zero(self, low: Fraction, high: Fraction, over: Over) -> arb:
        """A pair is zero at one load between two, exactly; and what the root of g is below for all of these."""
        check = self.system.pair_at_rest
        if check is None or not self.damped:
            raise Refused("no pair is known to leave zero")
        check(low, high)
        slope = over(by_load(self.g), arb(0)) / over(by_x(self.g), arb(0))
        return arb((2 * abs(slope) * ball(high - low)).upper())


def _along_root(h: Rows, g: Rows, P: arb, box: arb) -> arb:
    """φ(P) = h(P, ξ(P)), where ξ is the root of g(P, ·) in the box, on which g_x is not zero."""
    of_h, of_g = (arb_poly([p(P) for p in which]) for which in (h, g))
    slope = of_g.derivative()
    while True:
        middle = arb(box.mid())
        image = (middle - _near(of_g, middle) / _near(slope, box)).intersection(box)
        if not image.rad() < box.rad() * arb("0.9"):
            return _near(of_h, box)
        box = image


class Over:
    """Values of polynomials in P and x over all loads of an interval, and over a ball of x."""

    def __init__(self, loads: arb) -> None:
        self.middle = arb(loads.mid())
        self.width = loads - self.middle
        self.moved = cache(self._moved)

    def __call__(self, which: Rows, x: arb) -> arb:
        """By Taylor's theorem in P to second order, so that what cancels at the middle stays cancelled."""
        at_middle, first, second = self.moved(tuple(which))
        slope = _near(first, x) + self.width * _near(second, x)
        found: arb = _near(at_middle, x) + self.width * slope
        return found

    def _moved(self, which: tuple[arb_poly, ...]) -> tuple[arb_poly, arb_poly, arb_poly]:
        move = arb_poly([self.middle, 1])
        rows = [p(move) for p in which]
        rest = (arb_poly([p[k] for k in range(2, p.degree() + 1)])(self.width) for p in rows)
        return arb_poly([p[0] for p in rows]), arb_poly([p[1] for p in rows]), arb_poly(list(rest))

    def apart(self, h: Rows, g: Rows, low: arb, high: arb) -> None:
        """h and g have no common root from low to high at any of the loads: cells on which one of them is not zero."""
        waiting = [(low, high)]
        for _ in range(MOST_CELLS):
            if not waiting:
                return
            a, b = waiting.pop()
            cell = a.union(b)
            if self(h, cell).contains(0) and self(g, cell).contains(0):
                middle = arb(((a + b) / 2).mid())
                require(bool(a < middle < b), "another crossing may lie in the load's interval")
                waiting += [(a, middle), (middle, b)]
        raise Refused("another crossing may lie in the load's interval")


def opposite(one: arb, other: arb) -> bool:
    """Whether two numbers are known to have opposite signs."""
    return bool(one < 0 < other or other < 0 < one)


def _first_order(A: arb_mat, C: arb_mat, G: arb_mat, S: arb_mat, x: arb) -> tuple[arb, arb]:
    """h = det(A + λG), and the odd part of tr(adj(A + λG)(λC + S)) divided by λ, both at λ = i√x."""
    if x == 0:
        inverse, d = A.inv(), A.det()
        of_G, of_S = inverse * G, inverse * S
        return d, d * ((inverse * C).trace() + of_G.trace() * of_S.trace() - (of_G * of_S).trace())
    rate = acb(0, 1) * x.sqrt()
    whole = acb_mat(A) + rate * acb_mat(G)
    first = whole.det() * (whole.inv() * (rate * acb_mat(C) + acb_mat(S))).trace()
    return whole.det().real, first.imag / x.sqrt()


def _powers_of_row(system: System, i: int) -> int:
    """The highest power of P with which row i of M, C or K holds anything."""
    every = system.M, system.C, system.K, system.G, system.S
    each = [(k, X) for terms in every for k, X in enumerate(terms)]
    return max((k for k, X in each if any(not X[i, j] == 0 for j in range(X.ncols()))), default=0)


def _about(which: Rows, centre: arb) -> Rows:
    """The same in x − centre."""
    if centre == 0:
        return which
    table = [[p[a] for p in which] for a in range(1 + max(p.degree() for p in which))]
    moved = [arb_poly(row)(arb_poly([centre, 1])) for row in table]
    return [arb_poly([p[b] for p in moved]) for b in range(len(which))]


def by_load(which: Rows) -> Rows:
    return [p.derivative() for p in which]


def by_x(which: Rows) -> Rows:
    return [k * p for k, p in enumerate(which)][1:]


def highest(b: int, N: int, of_M: int, of_C: int, of_K: int) -> int:
    """The highest power of P that stands with x^b in the determinant of N rows, each of x M, √x C or K.

    So many rows of C as there may be, or none: in between the power is linear.
    """
    pairs = min(b, N - b)
    return max((b - s) * of_M + 2 * s * of_C + (N - b - s) * of_K for s in (0, pairs))


def _at_load(terms: list[arb_mat], P: arb) -> arb_mat:
    total = terms[-1] if terms else arb_mat(0, 0)
    for X in terms[-2::-1]:
        total = X + P * total
    return total


def _interpolated(places: list[Fraction], loads: list[Fraction], values: list[list[arb]], tops: list[int]) -> Rows:
    """The polynomial that has these values, a row for each x, in it one for each P; tops: of P, by powers of x."""
    nodes, across = [ball(P) for P in loads], [ball(x) for x in places]
    rows = [arb_poly.interpolate(nodes, row) for row in values]
    columns = [arb_poly.interpolate(across, [row[a] for row in rows]) for a in range(max(tops) + 1)]
    return [arb_poly([columns[a][b] for a in range(top + 1)]) for b, top in enumerate(tops)]


def _along(which: Rows, line: arb_poly) -> arb_poly:
    """The polynomial on a line."""
    total = arb_poly([0])
    for p in reversed(which):
        total = total * line + p
    return total


def _divided(along: arb_poly) -> arb_poly:
    """A polynomial in t = −P by the power of P that it is known to hold exactly: its sign for P > 0 stays."""
    none = next((k for k in range(along.degree() + 1) if not along[k].is_zero()), 0)
    found: arb_poly = (-1) ** none * arb_poly([along[k] for k in range(none, along.degree() + 1)])
    return found


def _near(polynomial: arb_poly, x: arb) -> arb:
    """The value over a ball, from the Taylor polynomial about its middle."""
    middle = arb(x.mid())
    found: arb = polynomial(arb_poly([middle, 1]))(x - middle)
    return found


def positive(polynomial: arb_poly, low: arb, high: arb) -> bool:
    """Whether a polynomial is positive from low to high, by bisection."""
    waiting = [(low, high)]
    for _ in range(8 * flint.ctx.prec):
        if not waiting:
            return True
        a, b = waiting.pop()
        value = _near(polynomial, a.union(b))
        if not value > 0:
            # halves on a logarithmic scale: the polynomial goes to zero with P − origin towards a crossing
            middle = arb(((a * b).sqrt() if a > 0 and b > 4 * a else (a + b) / 2).mid())
            if value < 0 or not a < middle < b:
                return False
            waiting += [(a, middle), (middle, b)]
    return False


# --- the certificate ----------------------------------------------------------------------------------------


Others = dict[str, Callable[[dict[str, Any]], Statement]]
"""Formats besides those of a series, and what checks them."""


def verify(certificate: dict[str, Any], others: Others | None = None) -> Statement:
    """Check a certificate; what it proves. Raises Refused where it does not."""
    try:
        kind = certificate.get("format") if type(certificate) is dict else None
        require(kind in (FORMAT, GENERAL, *(others or ())), "this is no certificate of a known format")
        if others and kind in others:
            return others[kind](certificate)
        return check(*(of_forms if kind == GENERAL else of_beam)(certificate))
    except ArithmeticError as error:
        raise Refused(f"could not be checked: {error}") from error
    except (AttributeError, LookupError, TypeError, ValueError) as error:
        reason = " ".join(str(error).split())[:100]
        raise Refused(f"is not a certificate, a field is missing or of the wrong kind: {reason}") from error


def check(
    stated: Statement, N: int, system: Callable[[], System], stretches: list[Stretch], beside: list[Checked]
) -> Statement:
    """The proof, of what was read; what it proves. Raises Refused."""
    given = [of for of in (stated.load, stated.square) if of and any(of)]
    widths = [int(high / (high - low)).bit_length() for low, high in given]
    # Free-free and Beck, polynomials and modes, damped and not: 8 bits a function suffice up to N = 20, 5 do not.
    with flint.ctx.workprec(200 + 20 * N + max(widths, default=0)):
        series = stable_series(system(), stretches, stated.end, stated.top)
        for of, separated, also in beside:
            other = stable_series(of(), separated, stated.top if also is None else stated.end, stated.top)
            if also is not None:
                also(other)
        if stated.load is not None:
            require(series.check_crossing(*stated.load, stated.square) > 0, "stability is not lost there")
    return stated


def stable_series(system: System, stretches: list[Stretch], end: Fraction, top: Fraction) -> Series:
    """The series, stable from no load to an end; coordinates without mass decay to the top."""
    if system.fast is not None:
        system.fast.decay(top)
    series = Series(system, end, _places(system, stretches[0]))
    for stretch in stretches:
        series.check_stable(stretch)
    return series


def _places(system: System, first: Stretch) -> list[Fraction]:
    """Places between the roots of h at the start of the first stretch; at its end where some come from 0 there."""
    known = system.degrees
    load = first.end if known.resting else first.start
    places = [point + slope * (load - first.origin) for point, slope in first.lines]
    if not system.C or (known.even and not system.vanishing):
        return places
    if known.touching:  # the second of the lines is below all roots of h
        places = places[1:]
    return places[::2] if known.highest % 2 else [*places[::2], places[-1]]


def verify_content(content: bytes, others: Others | None = None) -> Statement:
    """Check what stands in a certificate file. Raises Refused with the reason in one line."""
    try:
        return verify(parsed(content), others)
    except (ValueError, RecursionError) as error:
        raise Refused(f"is not a certificate: {error}") from error


def verify_file(path: Path | str, others: Others | None = None) -> Statement:
    """Check a certificate file. Raises Refused with the reason in one line."""
    try:
        return verify_content(contents(path), others)
    except OSError as error:
        raise Refused(f"{path}: cannot be read: {error.strerror}") from error
    except Refused as error:
        raise Refused(f"{path}: {error}") from error
