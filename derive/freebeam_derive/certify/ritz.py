"""Certified critical loads of the Ritz series: the crossing enclosed, stability below it proven. Eqs. (10), (24), (25).

With f(P, s) = det(E + P H − s M) and C = β M + α E, on λ = iω with x = ω²,

    det(λ² M + λ C + E + P H) = (1 + αλ)^N f(P / (1 + αλ), −(λ² + βλ) / (1 + αλ)) = h(P, x) + iω g(P, x).

Hermite and Biehler: all λ lie in the left half plane if and only if the roots of h(P, ·) and g(P, ·) are real,
positive, simple and interlace. That is shown for a whole interval of P at once by points x between neighbouring roots
(separators): N + (N − 1) changes of sign use up the degrees, so that nothing but the signs of polynomials in P need be
proven. Towards the crossing, where a root of h meets a root of g, the separator between them moves with P. A crossing
is a common root of h and g: Krawczyk's test encloses it and proves that it is the only one near; that the test's
Jacobian is regular means that the eigenvalue crosses with a speed, so the beam is unstable just above.

Vanishing damping at β = κα: g becomes N f − P f_P − (x + κ) f_x (first order in α). No damping: h = f alone, its
roots real and simple; the crossing is a double root, f = f_x = 0. Divergence: h(P, 0) = det K = 0.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache
from itertools import pairwise
from math import comb, perm
from types import ModuleType
from typing import Any

import numpy as np
from flint import acb, acb_poly, arb, arb_mat, arb_poly, fmpq, fmpz

from freebeam_derive.certify.balls import Exact, Unproven, exact, matrices, parameters, precision

LOWEST_BITS = 160
MOST_BITS = 60_000
DEEPEST = 120  # bisections of the load axis before a proof is given up


@dataclass(frozen=True)
class Question:
    """What is to be certified. kappa: the limit of vanishing damping at β = κα (then alpha = beta = 0), else None."""

    modes: int
    alpha: Exact = Fraction(0)
    beta: Exact = Fraction(0)
    kappa: Exact | None = None
    own: Mapping[str, Fraction] | None = None

    @property
    def undamped(self) -> bool:
        return self.kappa is None and self.alpha == 0 == self.beta


@dataclass(frozen=True)
class Stretch:
    """Stability for start ≤ P ≤ end: separators x = point + slope (P − origin), ascending.

    Slopes are zero but towards a crossing.
    """

    start: Fraction
    end: Fraction
    origin: Fraction
    separators: tuple[tuple[Fraction, Fraction], ...]


@dataclass(frozen=True)
class Enclosure:
    """A certified critical load. load, square: balls of P and of ω² (None where kind is "none").

    proof: crossing (it exists, alone in its box), first, stable_below, kind: true only where proven. Of "none" there is
    no crossing: proven is that the column is stable up to load_max.
    """

    question: Question
    kind: str
    load: tuple[Fraction, Fraction] | None
    square: tuple[Fraction, Fraction] | None
    load_max: Fraction | None
    stretches: tuple[Stretch, ...]
    proof: Mapping[str, bool]
    reason: str = ""


class Boundary:
    """h and g as lists over the powers of P of polynomials in x; g is None without damping."""

    def __init__(self, f: list[arb_poly], question: Question, factors: tuple[arb, arb]) -> None:
        self.N = question.modes
        c_M, c_E = factors
        self.g: list[arb_poly] | None
        if question.undamped:
            self.h, self.g = f, None
        elif question.kappa is not None:
            # C = c_E E + c_M M: the direction in which damping vanishes
            x = arb_poly([0, 1])
            self.h = f
            g = [c_E * (self.N - a) * p - (c_E * x + c_M) * p.derivative() for a, p in enumerate(f)]
            # the highest coefficients cancel identically: g is of degree N − 1
            self.g = [arb_poly([q[b] for b in range(self.N - a)]) for a, q in enumerate(g)]
        else:
            self.h, self.g = _damped(f, self.N, c_E, c_M)

    def along(self, which: list[arb_poly], origin: arb, point: arb, slope: arb) -> arb_poly:
        """h or g on the line P = origin + t, x = point + slope t, as a polynomial in t."""
        t = arb_poly([origin, 1])
        x = arb_poly([point, slope])
        total, power = arb_poly([0]), arb_poly([1])
        for p in which:
            total += power * (p(x) if not slope == 0 else arb_poly([p(point)]))
            power *= t
        return total

    def at(self, which: list[arb_poly], P: arb) -> arb_poly:
        """h(P, ·) or g(P, ·) as a polynomial in x."""
        total = arb_poly([0])
        for p in reversed(which):
            total = total * P + p
        return total

    def value(self, which: list[arb_poly], P: arb, x: arb, in_P: int = 0, in_x: int = 0) -> arb:
        """A derivative of h or g at a point or over a box."""
        return derivative(which, P, x, in_P, in_x)


def derivative(which: list[arb_poly], P: arb, x: arb, in_P: int = 0, in_x: int = 0) -> arb:
    """A derivative of a polynomial in P, its factors polynomials in x, at a point or over a box."""
    total = arb(0)
    for a in range(len(which) - 1, in_P - 1, -1):
        p = which[a]
        for _ in range(in_x):
            p = p.derivative()
        total = total * P + perm(a, in_P) * p(x)
    return total


def _damped(f: list[arb_poly], N: int, alpha: arb, beta: arb) -> tuple[list[arb_poly], list[arb_poly]]:
    """Even and odd part of Σ_ab c_ab P^a (−λ² − βλ)^b (1 + αλ)^(N − a − b) on λ = iω."""
    quadratic, linear = arb_poly([0, -beta, -1]), arb_poly([1, alpha])
    quadratics, linears = [arb_poly([1])], [arb_poly([1])]
    for _ in range(N):
        quadratics.append(quadratics[-1] * quadratic)
        linears.append(linears[-1] * linear)
    h, g = [], []
    for a, p in enumerate(f):
        total = arb_poly([0])
        for b in range(N - a + 1):
            if b <= p.degree():
                total += p[b] * quadratics[b] * linears[N - a - b]
        coefficients = [total[k] for k in range(2 * N + 1)]
        h.append(arb_poly([(-1) ** j * coefficients[2 * j] for j in range(N + 1)]))
        g.append(arb_poly([(-1) ** j * coefficients[2 * j + 1] for j in range(N)]))
    return h, g


@lru_cache(maxsize=16)
def _characteristic(kernel: ModuleType, modes: int, own: tuple[tuple[str, Fraction], ...], bits: int) -> list[arb_poly]:
    """f(P, s) = det(E + P H − s M) / det M: its factors of the powers of P, polynomials in s; by interpolation in P."""
    with precision(bits):
        M, E, H = matrices(kernel, modes, dict(own))
        solve = M.inv()
        E, H = solve * E, solve * H
        size = float(E[0, 0].mid()) / max(float(abs(H[0, 0]).mid()), 1e-3)
        unit = fmpq(fmpz(max(1, round(4 * size))), fmpz(4 * max(1, modes)))
        nodes = [arb(unit * k) for k in range(modes + 1)]
        sign = (-1) ** modes
        rows = [(E + node * H).charpoly() for node in nodes]
        columns = [arb_poly.interpolate(nodes, [sign * row[b] for row in rows]) for b in range(modes + 1)]
        # total degree N in P and s together
        return [arb_poly([columns[b][a] for b in range(modes - a + 1)]) for a in range(modes + 1)]


def boundary(kernel: ModuleType, question: Question, bits: int) -> Boundary:
    """h and g of a question, in balls of so many bits."""
    own = parameters(kernel, question.own)
    f = _characteristic(kernel, question.modes, tuple(sorted(own.items())), bits)
    alpha, beta = (Fraction(1), question.kappa) if question.kappa is not None else (question.alpha, question.beta)
    with precision(bits):
        given = {name: exact(value) for name, value in own.items()}
        c_M, c_E = map(arb, kernel.damping_factors(exact(alpha), exact(beta), **given))
        if question.kappa is not None and not c_E > 0:
            raise Unproven(f"{kernel.COLUMN['name']} has no internal damping that could vanish")
        return Boundary(f, question, (c_M, c_E))


# --- signs --------------------------------------------------------------------------------------------------


def sign_on(polynomial: arb_poly, start: arb, end: arb) -> int:
    """+1 or −1 where a polynomial keeps that sign for start ≤ t ≤ end, else 0: signs of its Bernstein coefficients."""
    n = polynomial.degree()
    if n <= 0:
        value = polynomial[0]
        return 1 if value > 0 else -1 if value < 0 else 0
    moved = polynomial(arb_poly([start, end - start]))
    powers = [moved[k] / comb(n, k) for k in range(n + 1)]
    signs = set()
    for i in range(n + 1):
        b = arb(0)
        for k in range(i + 1):
            b += comb(i, k) * powers[k]
        signs.add(1 if b > 0 else -1 if b < 0 else 0)
        if len(signs) > 1 or 0 in signs:
            return 0
    return signs.pop()


def rational(value: arb | float, bits: int) -> Fraction:
    """A dyadic rational near a ball's middle. Raises Unproven for a ball that has none."""
    if not arb(value).is_finite():
        raise Unproven("a number that the proof steps by is not finite")
    mantissa, exponent = (int(part) for part in arb(value).mid().man_exp())
    excess = mantissa.bit_length() - bits
    if excess > 0:
        mantissa, exponent = mantissa >> excess, exponent + excess
    return Fraction(mantissa << exponent) if exponent >= 0 else Fraction(mantissa, 1 << -exponent)


def zeros(polynomial: arb_poly) -> list[acb]:
    """Approximations of all zeros."""
    degree = polynomial.degree()
    if degree < 1:
        return []
    try:
        return list(acb_poly(polynomial).roots())
    except (ValueError, ArithmeticError):
        # double zeros, or about so: floats will do
        coefficients = [float(polynomial[k].mid()) for k in range(degree, -1, -1)]
        found: Any = np.roots(coefficients) if np.isfinite(coefficients).all() else []
        return [acb(z.real, 0 if abs(z.imag) < 1e-9 * abs(z) else z.imag) for z in map(complex, found)]


def _real_roots(polynomial: arb_poly) -> list[arb]:
    """Approximations of the real roots, ascending: where to put separators, which then prove themselves."""
    found = zeros(polynomial)
    slope = polynomial.derivative()
    real = []
    for root in (r.real.mid() for r in found if r.imag.contains(0)):
        for _ in range(4):
            root = (root - polynomial(root) / slope(root)).mid()
        real.append(root)
    return sorted(real, key=float)


# --- stability on an interval -------------------------------------------------------------------------------


def holds(found: Boundary, stretch: Stretch) -> bool:
    """Whether the signs at the separators prove stability for all P of a stretch."""
    start, end = exact(stretch.start - stretch.origin), exact(stretch.end - stretch.origin)
    origin = exact(stretch.origin)

    def sign(which: list[arb_poly], point: Fraction, slope: Fraction) -> int:
        line = found.along(which, origin, exact(point), exact(slope))
        return sign_on(line, start, end)

    separators = stretch.separators
    # separators are positive and ascend all along the stretch
    for t in (stretch.start - stretch.origin, stretch.end - stretch.origin):
        places = [Fraction(0), *(point + slope * t for point, slope in separators)]
        if any(b <= a for a, b in pairwise(places)):
            return False
    if sign(found.h, Fraction(0), Fraction(0)) != 1:
        return False
    if found.g is None:
        if len(separators) != found.N:
            return False
        return all(sign(found.h, *s) == (-1) ** (k + 1) for k, s in enumerate(separators))
    if len(separators) != 2 * found.N - 1:
        return False
    for k, s in enumerate(separators):
        # after 0: u_1, w_1, u_2, …: a root of h before each u, a root of g before each w
        if sign(found.h, *s) != (-1) ** (k // 2 + 1):
            return False
        if (k < 2 * found.N - 2 or found.N == 1) and sign(found.g, *s) != (-1) ** ((k + 1) // 2):
            return False
    return True


def separators_at(found: Boundary, P: Fraction) -> tuple[tuple[Fraction, Fraction], ...] | None:
    """Points between neighbouring roots at one load, None where they do not interlace: the beam is not stable there."""
    load = exact(P)
    h = _real_roots(found.at(found.h, load))
    N = found.N
    if len(h) != N or not float(h[0]) > 0:
        return None
    merged = h
    if found.g is not None:
        g = _real_roots(found.at(found.g, load))
        if len(g) != N - 1:
            return None
        merged = [r for pair in zip(h, g, strict=False) for r in pair] + [h[-1]]
    if any(not a < b for a, b in pairwise(merged)):
        return None
    middles = [(a + b) / 2 for a, b in pairwise(merged)]
    middles.append(2 * merged[-1])
    return tuple((rational(m, 100), Fraction(0)) for m in middles)


def _between(a: Fraction, b: Fraction) -> Fraction:
    """A rational of few bits near the middle of an interval."""
    width = (b - a) / 8
    grid = Fraction(1, 2) ** max(0, (width.denominator // max(1, width.numerator)).bit_length())
    return round((a + b) / 2 / grid) * grid


def _cover(found: Boundary, start: Fraction, end: Fraction) -> list[Stretch]:
    """Stretches that prove stability from start to end. Raises Unproven with the load where it could not be shown."""
    done: list[Stretch] = []
    waiting = [(start, end, 0)]
    while waiting:
        a, b, depth = waiting.pop()
        middle = _between(a, b)
        separators = separators_at(found, middle)
        if separators is None:
            raise Unproven(f"the column is not known to be stable at the load {float(middle):.10g}")
        stretch = Stretch(a, b, middle, separators)
        if holds(found, stretch):
            done.append(stretch)
            continue
        if depth == DEEPEST:
            raise Unproven(f"stability could not be shown between the loads {float(a):.12g} and {float(b):.12g}")
        waiting += [(middle, b, depth + 1), (a, middle, depth + 1)]
    return sorted(done, key=lambda s: s.start)


# --- the crossing -------------------------------------------------------------------------------------------


def _equations(found: Boundary) -> tuple[Any, Any]:
    """The two functions of (P, x) that vanish at a flutter crossing, each as (list, order in x)."""
    return ((found.h, 0), (found.g, 0)) if found.g is not None else ((found.h, 0), (found.h, 1))


def _jacobian(found: Boundary, P: arb, x: arb) -> list[list[arb]]:
    return [[found.value(w, P, x, 1, d), found.value(w, P, x, 0, d + 1)] for w, d in _equations(found)]


def newton(found: Boundary, P: arb, x: arb | None) -> tuple[arb, arb | None]:
    """One step of Newton's method from the middles of P and x; x None: towards a divergence."""
    P = P.mid()
    if x is None:
        zero = arb(0)
        return P - found.value(found.h, P, zero) / found.value(found.h, P, zero, 1), None
    x = x.mid()
    (w, d), (v, e) = _equations(found)
    r = found.value(w, P, x, 0, d), found.value(v, P, x, 0, e)
    (a, b), (c, k) = _jacobian(found, P, x)
    det = a * k - b * c
    return P - (k * r[0] - b * r[1]) / det, x - (a * r[1] - c * r[0]) / det


def enclose_flutter(found: Boundary, P: arb, x: arb, bits: int) -> tuple[arb, arb]:
    """Krawczyk's test around an approximation: balls of P and x that hold exactly one crossing. Raises Unproven."""
    P, x = P.mid(), x.mid()
    (w, d), (v, e) = _equations(found)
    r = found.value(w, P, x, 0, d), found.value(v, P, x, 0, e)
    (a, b), (c, k) = [[entry.mid() for entry in row] for row in _jacobian(found, P, x)]
    det = a * k - b * c
    if det.contains(0):
        raise Unproven("the crossing is not known to be simple")
    inverse = [[k / det, -b / det], [-c / det, a / det]]
    shift = [inverse[0][0] * r[0] + inverse[0][1] * r[1], inverse[1][0] * r[0] + inverse[1][1] * r[1]]
    for slack in range(4, bits // 2, 12):
        radius_P = 2 * abs(shift[0]).upper() + abs(P).upper() * arb(2) ** (slack - bits)
        radius_x = 2 * abs(shift[1]).upper() + abs(x).upper() * arb(2) ** (slack - bits)
        box = P + radius_P * arb(0, 1), x + radius_x * arb(0, 1)
        J = _jacobian(found, *box)
        rest = [
            [(1 if i == j else 0) - sum((inverse[i][n] * J[n][j] for n in range(2)), arb(0)) for j in range(2)]
            for i in range(2)
        ]
        offset = radius_P * arb(0, 1), radius_x * arb(0, 1)
        image = [m - shift[i] + rest[i][0] * offset[0] + rest[i][1] * offset[1] for i, m in enumerate((P, x))]
        if box[0].contains_interior(image[0]) and box[1].contains_interior(image[1]):
            return image[0], image[1]
    raise Unproven("no box around the candidate could be shown to hold a crossing")


def tables(found: Boundary) -> list[arb_mat]:
    """Coefficients of h and of g (of h_x without damping), by powers of P in rows and of x in columns."""
    n = found.N + 1
    g = found.g if found.g is not None else [p.derivative() for p in found.h]
    return [
        arb_mat([[which[a][b] if a < len(which) else 0 for b in range(n)] for a in range(n)]) for which in (found.h, g)
    ]


def shifted_to(table: arb_mat, P: arb, x: arb) -> arb_mat:
    """Taylor coefficients about a point."""
    n = table.nrows() - 1

    def pascal(t: arb) -> arb_mat:
        powers = [t**k for k in range(n + 1)]
        return arb_mat([[comb(j, i) * powers[j - i] if j >= i else 0 for j in range(n + 1)] for i in range(n + 1)])

    return pascal(P) * table * pascal(x).transpose()


def alone(shifted: list[arb_mat], r: Fraction, rho: Fraction) -> bool:
    """Whether (h, g) is one to one on the box |P − P₀| ≤ r, |x − x₀| ≤ ρ: 1 − J(centre)⁻¹ J is a contraction there."""
    u, v = exact(r), exact(rho)
    n = shifted[0].nrows()
    us, vs = [u**k for k in range(n)], [v**k for k in range(n)]
    centre, spread = [], []
    for s in shifted:
        by_P = by_x = arb(0)
        for i in range(n):
            for j in range(n):
                if i + j > 1:
                    size = abs(s[i, j]).upper() * us[i] * vs[j]
                    by_P, by_x = by_P + i * size, by_x + j * size
        centre.append([s[1, 0] * u, s[0, 1] * v])
        spread.append([by_P, by_x])
    (a, b), (c, d) = centre
    det = a * d - b * c
    if det.contains(0):
        return False
    inverse = [[abs(d / det), abs(b / det)], [abs(c / det), abs(a / det)]]
    rest = [sum((row[k] * spread[k][j] for k in range(2) for j in range(2)), arb(0)) for row in inverse]
    return all(value < 1 for value in rest)


def enclose_divergence(found: Boundary, P: arb, bits: int) -> arb:
    """Interval Newton for det K = 0: a ball of P that holds exactly one root. Raises Unproven."""
    P, zero = P.mid(), arb(0)
    shift = found.value(found.h, P, zero) / found.value(found.h, P, zero, 1)
    for slack in range(4, bits // 2, 12):
        radius = 2 * abs(shift).upper() + abs(P).upper() * arb(2) ** (slack - bits)
        box = P + radius * arb(0, 1)
        slope = found.value(found.h, box, zero, 1)
        if slope.contains(0):
            continue
        image = P - found.value(found.h, P, zero) / slope
        if box.contains_interior(image):
            return image
    raise Unproven("no interval around the candidate could be shown to hold a divergence load")


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
        # the separator that the crossing closes in on passes through it
        middle = exact(x)
        places = [float(point) for point, _ in separators]
        slope = Fraction(0)
        if found.g is not None:
            load = exact(P)
            slopes = [
                -found.value(w, load, middle, 1, 0) / found.value(w, load, middle, 0, 1) for w in (found.h, found.g)
            ]
            flat, steep = sorted(slopes, key=lambda v: float(abs(v)))
            slope = rational(flat + (steep - flat) * share, 30)
        there = float(x + slope * (start - P))
        nearest = min(range(len(places)), key=lambda k: abs(places[k] - there))
        separators = (*separators[:nearest], (x, slope), *separators[nearest + 1 :])
    stretch = Stretch(start, end, P, separators)
    return stretch if holds(found, stretch) else None


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
    bits = LOWEST_BITS + int(3.33 * digits) + 24 * question.modes
    reason = ""
    while bits <= MOST_BITS:
        with precision(bits):
            say(f"{bits} bits")
            try:
                found = boundary(kernel, question, bits)
                if near is None:
                    stretches = _cover(found, Fraction(0), load_max)
                    return Enclosure(
                        question,
                        "none",
                        None,
                        None,
                        load_max,
                        tuple(stretches),
                        {"crossing": False, "first": False, "stable_below": True, "kind": True},
                    )
                return _certify_near(found, question, near, digits, bits)
            except Unproven as error:
                if reason == str(error):
                    raise
                reason = str(error)
        bits *= 2
    raise Unproven(reason)


def _certify_near(
    found: Boundary, question: Question, near: tuple[float | Fraction, float], digits: int, bits: int
) -> Enclosure:
    flutter = near[1] > 0
    P, x = exact(Fraction(near[0])), arb(near[1]) ** 2 if flutter else None
    start = P.mid()
    reached = 20
    while reached < 2 * bits:
        P, x = newton(found, P, x)
        reached *= 2
    if not P.is_finite() or abs(P - start) > abs(start) * arb("1e-3"):
        raise Unproven(f"no crossing was found near the load {float(near[0]):.10g}")
    if x is not None:
        P, x = enclose_flutter(found, P, x, bits)
        if not x > 0:
            raise Unproven("the crossing's frequency is not known to be positive")
    else:
        P = enclose_divergence(found, P, bits)
    tolerance = Fraction(1, 10 ** (max(digits, 8) + 2))
    middle = rational(P, bits)
    end = middle - abs(middle) * tolerance / 2
    top = middle + abs(middle) * tolerance / 2
    if not (exact(end) < P < exact(top)):
        raise Unproven(f"the crossing near {float(near[0]):.10g} could not be enclosed to {digits} digits")
    point = None if x is None else rational(x, bits)
    kind = "divergence" if x is None else "flutter"
    there = f"{float(middle):.10g}"
    try:
        stretches = _stable_below(found, middle, point, tolerance)
    except Unproven as error:
        raise Unproven(
            f"{error}; established is that there is a crossing, of {kind}, at {there}, not that it is the first"
        ) from error
    proof = {"crossing": True, "first": True, "stable_below": True, "kind": True}
    squared = None
    if x is not None and point is not None:
        # the root of g that passes through the crossing stays within for all loads of the interval
        _, (by_P, by_x) = _jacobian(found, exact(middle), exact(point))
        spread = tolerance * (point + middle * rational(abs(by_P / by_x).upper(), 60))
        squared = (point - spread, point + spread)
        if not (exact(squared[0]) < x < exact(squared[1])):
            raise Unproven("the frequency could not be enclosed to the digits asked for")
        shifted = [shifted_to(table, exact(middle), exact(point)) for table in tables(found)]
        single = alone(shifted, middle * tolerance / 2, spread)
    else:
        single = not found.value(found.h, exact(end).union(exact(top)), arb(0), 1).contains(0)
    if not single:
        raise Unproven(
            f"a second crossing may lie with the one at {there} in the interval of {digits} digits; established "
            "is that the column is stable below; ask for more digits to tell them apart"
        )
    return Enclosure(question, kind, (end, top), squared, None, tuple(stretches), proof)


def _stable_below(found: Boundary, load: Fraction, point: Fraction | None, tolerance: Fraction) -> list[Stretch]:
    """Stretches from P = 0 to just below a crossing at (load, x = point), or a divergence (None). Raises Unproven."""
    end, reach = load * (1 - tolerance / 2), Fraction(1, 8)
    while reach > tolerance:
        begin = _between(load * (1 - reach), load * (1 - reach / 2))
        # the curves bend, the more so near a coalescence: a line close to the flatter one stays between them longest
        for share in (0.5, 2.0**-6, 2.0**-16):
            last = _towards(found, load, point, begin, end, share)
            if last is not None:
                return [*_cover(found, Fraction(0), last.start), last]
        reach /= 4
    raise Unproven(f"stability just below the load {float(load):.10g} could not be shown")
