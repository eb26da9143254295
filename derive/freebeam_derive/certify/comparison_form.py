"""The load's form in the normalised modes of the comparison beam, as balls, and what is known of all modes beyond.

A mode of any two ends that are free, clamped, pinned or sliding, φ'''' = γ⁴ φ with ∫ φ² dx = 1, is u + v with

    u = b e^(−γx) + c e^(−γ(1−x)),    v = v₀ cos γx + V₀ sin γx,    a² = v₀² + V₀².

G = φ' φ''' − φ''²/2 − γ⁴ φ²/2 is constant along it, and parts give ∫ G = −2γ⁴, for φ' φ'' vanishes at such ends and
∫ φ''² = γ⁴. At x = 0 that reads a² + 4 b c e^(−γ) = 2, which sets the size. The rest follows for every mode, with
ε = e^(−γ) (docs/theorem.md has the proof):

    a² ≤ A² = 2 / (1 − 4ε/(1 − ε)²),   |φ| ≤ 2 and |φ'| ≤ 2 γ √(A² − 1) at the ends,
    ‖φ'‖² ≤ γ² + |φ φ'|(0) + |φ φ'|(1),   ‖φ''‖ = γ².

(p, q) stand for φᵢ^(p) φⱼ^(q): i is the row and test function, j the column and trial function, as in Eq. (11).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import permutations
from math import factorial
from typing import Any

import flint
from flint import acb, arb, arb_mat, arb_series, fmpz_poly

from freebeam_derive.certify.balls import Unproven, ball

ORDERS = {"free": (2, 3), "clamped": (0, 1), "pinned": (0, 2), "sliding": (1, 3)}
"""Orders of the derivatives that vanish at an end of a kind. Eq. (20)."""
Along = Mapping[tuple[int, int, int], Any]  # (k, p, q) -> factor of ∫ x^k φᵢ^(p) φⱼ^(q) dx
Points = Mapping[tuple[int, int, int, int], Any]  # (a, p, b, q) -> factor of φᵢ^(p)(a) φⱼ^(q)(b)

# derivatives over γ^d of cos and sin at a place, in terms of (cos, sin) there
_TURNS = (((1, 0), (0, 1)), ((0, -1), (1, 0)), ((-1, 0), (0, -1)), ((0, 1), (-1, 0)))


# --- the roots ----------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Characteristic:
    """p(ε) cos γ + q(ε) sin γ + r(ε) = 0 with ε = e^(−γ): the determinant of the four end conditions. Eq. (21).

    quarter: its asymptotes are (quarter + 4 n) π/4. amplitude: |A| of p(0) cos γ + q(0) sin γ = A sin(γ − asymptote).
    excess: Σ of the absolute coefficients of positive powers of ε, and Σ of (power + 1) times these.
    """

    p: fmpz_poly
    q: fmpz_poly
    r: fmpz_poly
    quarter: int

    def asymptote(self, number: int) -> arb:
        """Numbered from 0."""
        return (self.quarter + 4 * number) * arb.pi() / 4

    @property
    def amplitude(self) -> arb:
        return arb(int(self.p[0]) ** 2 + int(self.q[0]) ** 2).sqrt()

    @property
    def excess(self) -> tuple[int, int]:
        parts = [(n, abs(int(f[n]))) for f in (self.p, self.q, self.r) for n in range(1, f.degree() + 1)]
        return sum(size for _, size in parts), sum((n + 1) * size for n, size in parts)

    def __call__(self, g: arb) -> tuple[arb, arb]:
        """The function and its derivative at γ."""
        e, sine, cosine = (-g).exp(), g.sin(), g.cos()
        p, q, r = (_at(f, e) for f in (self.p, self.q, self.r))
        dp, dq, dr = (-e * _at(f.derivative(), e) for f in (self.p, self.q, self.r))
        return p * cosine + q * sine + r, (dp + q) * cosine + (dq - p) * sine + dr

    def scaled_series(self, g: arb, order: int) -> list[arb]:
        """Taylor coefficients at γ of the function times e^γ."""
        before = flint.ctx.cap
        flint.ctx.cap = order + 1
        try:
            x = arb_series([g, arb(1)])
            total = arb_series([0])
            for f, wave in ((self.p, x.cos()), (self.q, x.sin()), (self.r, arb_series([1]))):
                for n in range(f.degree() + 1):
                    total = total + int(f[n]) * wave * ((1 - n) * x).exp()
            return [total[n] for n in range(order + 1)]
        finally:
            flint.ctx.cap = before


def _at(polynomial: fmpz_poly, e: arb) -> arb:
    total = arb(0)
    for n in range(polynomial.degree(), -1, -1):
        total = total * e + int(polynomial[n])
    return total


@lru_cache(maxsize=16)
def characteristic(ends: tuple[str, str]) -> Characteristic:
    """The characteristic function of a pair of ends; p, q and r from three angles, for it is linear in cos and sin."""
    e = fmpz_poly([0, 1])

    def determinant(cosine: int, sine: int) -> fmpz_poly:
        rows: list[list[Any]] = []
        for end, kind in enumerate(ends):
            c, s = ((1, 0), (cosine, sine))[end]
            for d in ORDERS[kind]:
                (cc, cs), (sc, ss) = _TURNS[d]
                left, right = (fmpz_poly([(-1) ** d]), e) if end == 0 else ((-1) ** d * e, fmpz_poly([1]))
                rows.append([fmpz_poly([cc * c + cs * s]), fmpz_poly([sc * c + ss * s]), left, right])
        total = fmpz_poly([0])
        for order in permutations(range(4)):
            sign = (-1) ** sum(order[i] > order[j] for i in range(4) for j in range(i + 1, 4))
            total += sign * rows[0][order[0]] * rows[1][order[1]] * rows[2][order[2]] * rows[3][order[3]]
        return total

    at_0, at_half, at_1 = determinant(1, 0), determinant(0, 1), determinant(-1, 0)
    p, r = ([int(v) // 2 for v in (at_0 + sign * at_1).coeffs()] for sign in (-1, 1))
    P, R = fmpz_poly(p), fmpz_poly(r)
    Q = at_half - R
    if R[0] != 0:
        raise AssertionError(f"the characteristic function of {ends} is not of the form that is known")
    # p(0) cos γ + q(0) sin γ = 0
    quarter = {(0, 1): 0, (1, 1): 3, (1, 0): 2, (1, -1): 1}[_direction(int(P[0]), int(Q[0]))]
    return Characteristic(P, Q, R, quarter)


def _direction(p: int, q: int) -> tuple[int, int]:
    size = max(abs(p), abs(q)) * (1 if p > 0 or (p == 0 and q > 0) else -1)
    return p // size, q // size


def _settled(f: Characteristic, g: arb) -> bool:
    """Whether from γ = g on there is one root, and only one, within π/2 of each asymptote, and a simple one.

    |f − A sin(γ − asymptote)| ≤ excess · ε, and so for the derivatives: further than π/4 from an asymptote f is not
    zero, and nearer it is monotonic.
    """
    e, (size, slope) = (-g).exp(), f.excess
    least = f.amplitude / arb(2).sqrt()
    return bool(size * e < least) and bool(slope * e < least)


@lru_cache(maxsize=64)
def roots(ends: tuple[str, str], count: int, bits: int) -> tuple[tuple[arb, ...], int]:
    """The lowest roots γ > 0, each alone in its ball and none left out; and the number of the last one's asymptote.

    Raises Unproven. bits: the precision in force, which the result depends on.
    """
    f, half = characteristic(ends), arb.pi() / 2
    start = next(k for k in range(8) if f.asymptote(k) > 2 and _settled(f, f.asymptote(k) - half))
    edge = (f.asymptote(start) - half).upper()
    _none_up_to_one(f)
    lowest = _isolated(f, arb(1), edge)
    found = lowest[:count]
    last = start - 1 - len(lowest) + len(found)
    while len(found) < count:
        last += 1
        found.append(_enclosed(f, f.asymptote(last)))
    return tuple(found), last


def _none_up_to_one(f: Characteristic) -> None:
    """No root for 0 < γ ≤ 1: of f e^γ all derivatives at 0 below some order vanish and that one keeps its sign.

    n! times a Taylor coefficient at 0 is a whole number, so one that a small ball about 0 holds is 0.
    """
    at_zero = f.scaled_series(arb(0), 8)
    order = next(n for n in range(9) if not at_zero[n].contains(0))
    signs = set()
    for piece in range(64):
        value = f.scaled_series(ball(arb(2 * piece + 1) / 128, arb(1) / 128), order)[order]
        signs.add(1 if value > 0 else -1 if value < 0 else 0)
    if len(signs) != 1 or 0 in signs:
        raise Unproven("the neighbourhood of γ = 0 could not be shown to hold no root")


def _isolated(f: Characteristic, low: arb, high: arb, depth: int = 0) -> list[arb]:
    """Balls about the roots between two points, by bisection to stretches without a zero of f or of its derivative."""
    between = low.union(high)
    value, slope = f(between)
    if not value.contains(0):
        return []
    if not slope.contains(0):
        ends = f(low)[0], f(high)[0]
        if ends[0] * ends[1] < 0:
            return [_enclosed(f, between)]
        if ends[0] * ends[1] > 0:
            return []
    if depth > 40:
        raise Unproven("the lowest roots of the comparison beam could not be told apart")
    middle = ((low + high) / 2).mid()
    return _isolated(f, low, middle, depth + 1) + _isolated(f, middle, high, depth + 1)


def _enclosed(f: Characteristic, near: arb) -> arb:
    """Newton's method, then the interval Newton test."""
    middle = near.mid()
    for _ in range(60):
        value, slope = f(middle)
        step = (value / slope).mid()
        middle = (middle - step).mid()
        if abs(step) < arb(2) ** (8 - flint.ctx.prec):
            break
    for wider in (12, 20, 28, 40):
        trial = ball(middle, arb(2) ** (wider - flint.ctx.prec))
        image = middle - f(middle)[0] / f(trial)[1]
        if trial.contains_interior(image):
            if not abs(image - near) < arb.pi() / 2:
                break
            return image
    raise Unproven("a root of the comparison beam could not be enclosed")


# --- the modes ----------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Bounds:
    """What holds of every normalised mode with γ ≥ g: |φ| ≤ end[0], |φ'| ≤ γ end[1] at the ends, ‖φ'‖ ≤ γ slope."""

    end: tuple[arb, arb]
    slope: arb


def bounds(ends: Sequence[str], g: arb) -> Bounds:
    """See the head of the file. Raises Unproven where g is too small for them."""
    e = (-g).exp()
    square = 2 / (1 - 4 * e / (1 - e) ** 2)
    if not square > 0:
        raise Unproven("the lowest modes are too low for their bounds")
    slope = 2 * (square - 1).sqrt()
    return Bounds((arb(2), slope), (1 + 2 * slope * ends.count("free") / g).sqrt())


class Modes:
    """The lowest modes of the comparison beam, normalised, at the precision in force. Eqs. (20)-(22).

    gamma: their roots. ends[e][d]: φ^(d) / γ^d at x = e, a ball a mode. spread: no root, of all there are, is further
    from its asymptote. lattice(k): the asymptote of root k (from 1), also beyond.
    """

    def __init__(self, kinds: tuple[str, str], count: int) -> None:
        self.kinds, self.count = kinds, count
        found, self._last = roots(kinds, count, flint.ctx.prec)
        self.gamma, self._f = list(found), characteristic(kinds)
        if not _settled(self._f, self.gamma[-1] - arb(1)):
            raise Unproven("more modes are needed for the bounds of those beyond")
        e = (1 - self.gamma[-1]).exp()
        # beyond: A sin(away) ≤ excess · ε, and sin(away) ≥ away · 2√2/π within π/4
        self.beyond = (self._f.excess[0] * e * arb.pi() / (arb(8).sqrt() * self._f.amplitude)).upper()
        self.spread = self.beyond
        for k, g in enumerate(self.gamma, 1):
            self.spread = self.spread.max(abs(g - self.lattice(k)).upper())
        waves = [self._mode(g) for g in self.gamma]
        self.parts = [parts for parts, _ in waves]
        self.ends = [[[values[e][d] for _, values in waves] for d in range(4)] for e in range(2)]

    def lattice(self, k: int) -> arb:
        return self._f.asymptote(self._last - self.count + k)

    def _mode(self, g: arb) -> tuple[list[arb], list[list[arb]]]:
        """v₀, V₀, b, c of a mode, and its end values."""
        e, cosine, sine = (-g).exp(), g.cos(), g.sin()

        def row(end: int, d: int) -> list[arb]:
            (cc, cs), (sc, ss) = _TURNS[d]
            c, s = ((arb(1), arb(0)), (cosine, sine))[end]
            left, right = ((-1) ** d * arb(1), e) if end == 0 else ((-1) ** d * e, arb(1))
            return [cc * c + cs * s, sc * c + ss * s, left, right]

        rows = [row(end, d) for end, kind in enumerate(self.kinds) for d in ORDERS[kind]]
        # on a root the rows are dependent: the minors of three of them are the mode up to its size
        vectors = [[(-1) ** c * _minor(rows, left, c) for c in range(4)] for left in range(4)]
        vector = max(vectors, key=lambda v: float(sum(x.mid() ** 2 for x in v)))
        v, V, b, c = vector
        size = v * v + V * V + 4 * b * c * e
        if not size > 0:
            raise Unproven("a mode of the comparison beam could not be enclosed")
        vector = [x * (2 / size).sqrt() for x in vector]
        values = [[sum((x * y for x, y in zip(vector, row(end, d), strict=True)), arb(0)) for d in range(4)]
                  for end in range(2)]  # fmt: skip
        for end, kind in enumerate(self.kinds):
            for d in ORDERS[kind]:
                values[end][d] = arb(0)
        return vector, values

    def derivative(self, end: int, order: int) -> list[arb]:
        """φ^(order) at an end, of every mode."""
        return [value * g**order for value, g in zip(self.ends[end][order % 4], self.gamma, strict=True)]

    # ---------------------------------------------------------------- integrals

    def form(self, along: Along, points: Points) -> arb_mat:
        """The matrix of a form."""
        n = self.count
        total = arb_mat(n, n)
        for (k, p, q), f in along.items():
            total = total + f * self.integral(k, p, q)
        for (a, p, b, q), f in points.items():
            total = total + f * _outer(self.derivative(a, p), self.derivative(b, q))
        return total

    def integral(self, k: int, p: int, q: int) -> arb_mat:
        """∫ x^k φᵢ^(p) φⱼ^(q) dx.

        With X, Y for d/dx of the first and of the second factor, X⁴ = γᵢ⁴ and Y⁴ = γⱼ⁴, so that
        (X + Y)⁻¹ = (X³ − X² Y + X Y² − Y³) / (γᵢ⁴ − γⱼ⁴) gives an antiderivative of a product; x^k goes by parts.
        """
        n = self.count
        fourth = [g**4 for g in self.gamma]
        total = arb_mat(n, n)
        power = {(0, 0): 1}
        divisor = [[arb(1)] * n for _ in range(n)]
        apart = [[a - b if i != j else arb(1) for j, b in enumerate(fourth)] for i, a in enumerate(fourth)]
        for r in range(k + 1):
            raised: dict[tuple[int, int], int] = {}
            for (x, y), f in power.items():
                for t in range(4):
                    raised[x + 3 - t, y + t] = raised.get((x + 3 - t, y + t), 0) + (-1) ** t * f
            power = raised
            divisor = [[d * a for d, a in zip(*rows, strict=True)] for rows in zip(divisor, apart, strict=True)]
            part = arb_mat(n, n)
            for end in (0, 1) if r == k else (1,):
                for (x, y), f in power.items():
                    product = _outer(self.derivative(end, p + x), self.derivative(end, q + y))
                    part = part + (f if end else -f) * product
            factor = (-1) ** r * factorial(k) // factorial(k - r)
            flat = zip(part.entries(), (d for row in divisor for d in row), strict=True)
            total = total + factor * arb_mat(n, n, [value / d for value, d in flat])
        for i in range(n):
            total[i, i] = self._own(i, k, p, q)
        return total

    def _own(self, i: int, k: int, p: int, q: int) -> arb:
        """∫ x^k φ^(p) φ^(q) dx of one mode, from its exponentials e^(z γ x − γ·shift)."""
        (v, V, b, c), g = self.parts[i], self.gamma[i]
        turning, decaying = (acb(0, 1), 0, acb(v, -V) / 2), (acb(-1), 0, acb(b))
        waves = [turning, (acb(0, -1), 0, acb(v, V) / 2), decaying, (acb(1), 1, acb(c))]
        total = acb(0)
        for z, up, f in waves:
            for w, more, h in waves:
                factor = f * h * z**p * w**q
                rate, shift = z + w, -(up + more) * g
                if rate == 0:
                    total += factor * acb(shift).exp() / (k + 1)
                    continue
                rate *= g
                at_1, at_0 = (rate + shift).exp(), acb(shift).exp()
                for r in range(k + 1):
                    part = at_1 - at_0 if r == k else at_1
                    total += factor * (-1) ** r * (factorial(k) // factorial(k - r)) * part / rate ** (r + 1)
        return (total * g ** (p + q)).real


def _outer(first: list[arb], second: list[arb]) -> arb_mat:
    return arb_mat([[v] for v in first]) * arb_mat([second])


def _minor(rows: list[list[arb]], row: int, column: int) -> arb:
    (a, b, c), (d, e, f), (g, h, i) = (
        [v for c, v in enumerate(r) if c != column] for k, r in enumerate(rows) if k != row
    )
    return a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g)


__all__ = ["Along", "Bounds", "Characteristic", "Modes", "ORDERS", "Points", "bounds", "characteristic", "roots"]
