"""Exact systems: z' = A(x; λ, P) z by Taylor steps in mpmath from place to place, with the jumps of the forces between.

z = (y, slope, M, S): M and S are what multiplies δ(slope) and δy at an end in the virtual work. A cut at x gives
S(left) + (what acts there on y) = S(right), likewise M. What jumps, what is seen from elsewhere and coordinates are
unknowns beside z, each with an equation; the determinant of all equations is F(λ, P).
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from typing import Any

from mpmath import det, eye, matrix, mp, mpc, mpf, workdps
from mpmath import exp as mp_exp

from tests.reference.systems import At, Beam, Segment

DIGITS = 45  # steps of differences are 1e-14 of the scale, so some 28 digits of a derivative hold
SIZE = mpf("0.25")  # of a step; the nearest singular point of the tapers used is at distance 1 from the tip
TERMS = 90
Rows = list[list[Any]]


class Series:
    """A truncated Taylor series about a place; the operations that coefficients of columns need."""

    def __init__(self, terms: list[Any]):
        self.terms = terms

    def __add__(self, other: Any) -> Series:
        if not isinstance(other, Series):
            return Series([self.terms[0] + other, *self.terms[1:]])
        pairs = max(len(self.terms), len(other.terms))
        a, b = (t + [mpf(0)] * (pairs - len(t)) for t in (self.terms, other.terms))
        return Series([u + v for u, v in zip(a, b, strict=True)])

    def __mul__(self, other: Any) -> Series:
        if not isinstance(other, Series):
            return Series([t * other for t in self.terms])
        out = [mpf(0)] * min(TERMS, len(self.terms) + len(other.terms) - 1)
        for i, u in enumerate(self.terms):
            for j, v in enumerate(other.terms[: len(out) - i]):
                out[i + j] += u * v
        return Series(out)

    def __neg__(self) -> Series:
        return self * -1

    def __sub__(self, other: Any) -> Series:
        return self + -other

    def __rsub__(self, other: Any) -> Series:
        return -self + other

    def __pow__(self, power: int) -> Series:
        out = Series([mpf(1)])
        for _ in range(power):
            out = out * self
        return out

    __radd__, __rmul__ = __add__, __mul__

    def inverse(self) -> Series:
        a = self.trimmed()
        if len(a) == 1:
            return Series([1 / a[0]])
        out = [1 / a[0]]
        for n in range(1, TERMS):
            out.append(-sum((a[k] * out[n - k] for k in range(1, min(n, len(a) - 1) + 1)), mpf(0)) / a[0])
        return Series(out)

    def exp(self) -> Series:
        a, out = self.trimmed(), [mp_exp(self.terms[0])]
        for n in range(1, TERMS):
            out.append(sum((k * a[k] * out[n - k] for k in range(1, min(n, len(a) - 1) + 1)), mpf(0)) / n)
        return Series(out)

    def trimmed(self) -> list[Any]:
        last = max((i for i, t in enumerate(self.terms) if t), default=0)
        return self.terms[: last + 1]


def coefficients(beam: Beam, part: Segment, x: Any, lam: Any, P: Any) -> dict[tuple[int, int], list[Any]]:
    """Taylor coefficients of A about x, by place in the matrix."""
    at = Series([x, mpf(1)])
    bending = part.EI(at).inverse() * (1 / (1 + number(beam.alpha) * lam))
    inertia = part.mass(at) * lam**2 + part.damping(at) * lam + part.spring(at)
    along, rotary = part.axial(at, P), part.rotary(at) * lam**2
    one = Series([mpf(1)])
    if beam.shear is None:
        flow = part.gyro(at, P) * lam + part.flow(at, P)
        out = {(0, 1): one, (1, 2): bending, (2, 3): -one, (2, 1): rotary - along, (3, 0): inertia, (3, 1): flow}
    else:  # S = σ(y' − ψ) − N y', so y' = (S + σψ)/(σ − N) and σ(y' − ψ) = σ(S + N ψ)/(σ − N)
        sigma = number(beam.shear) * (1 + number(beam.alpha) * lam)
        give = (sigma - along).inverse()
        out = {
            (0, 1): give * sigma,
            (0, 3): give,
            (1, 2): bending,
            (2, 3): give * -sigma,
            (2, 1): rotary - give * along * sigma,
            (3, 0): inertia,
        }
    return {place: terms for place, series in out.items() if any(terms := series.trimmed())}


def scaled(terms: list[Any], h: Any) -> list[Any]:
    """a_k h^k, up to the last that counts."""
    out = [a * h**k for k, a in enumerate(terms)]
    least = max(abs(a) for a in out) * mp.eps / 16
    return out[: 1 + max(k for k, a in enumerate(out) if abs(a) > least)]


def step(A: dict[tuple[int, int], list[Any]], z: Rows, h: Any) -> Rows:
    """z(x + h), by the recurrence (n + 1) z_(n+1) = Σ A_k z_(n−k)."""
    entries = [(i, j, scaled(terms, h)) for (i, j), terms in A.items()]
    history = [[[value] for value in row] for row in z]  # of each entry z_n hⁿ
    total, small = [row[:] for row in z], 0
    for n in range(TERMS - 1):
        factor = h / (n + 1)
        news = [
            [
                factor
                * mp.fdot(
                    (a, v)
                    for i, j, A_ij in entries
                    if i == k
                    for a, v in zip(A_ij, reversed(history[j][c]), strict=False)
                )
                for c in range(len(z[0]))
            ]
            for k in range(4)
        ]
        for row, old, more in zip(total, history, news, strict=True):
            row[:] = [u + v for u, v in zip(row, more, strict=True)]
            for values, v in zip(old, more, strict=True):
                values.append(v)
        largest = max(mp.mag(u) for row in news for u in row)
        small = small + 1 if largest < max(mp.mag(u) for row in total for u in row) - mp.prec - 1 else 0
        if small == 4:
            return total
    raise ArithmeticError("the Taylor series of a step does not end: take smaller steps")


def number(value: Any) -> Any:
    return mpf(value.numerator) / value.denominator


class Passage:
    """One way from x = 0 to 1: unknowns are the two free parts of z at 0, then everything else that is unknown."""

    def __init__(self, beam: Beam, lam: Any, P: Any):
        self.beam, self.lam, self.P = beam, lam, P
        held = {"clamped": (0, 1), "pinned": (0, 2), "free": (2, 3)}
        start = [i for i in range(4) if i not in held[beam.ends[0]]]
        self.end = held[beam.ends[1]]
        remote = [t.sees for t in beam.terms if (t.sees.place, t.sees.side) != (t.moves.place, t.moves.side)]
        alone = [a for a in beam.sights if a.kind[0] in "jq"]
        self.extra = list(dict.fromkeys(alone + [a for a in remote if a not in alone]))
        width = 2 + len(self.extra)
        self.z = [[mpf(int(i in start and start.index(i) == j)) for j in range(width)] for i in range(4)]
        self.unit = {at: [mpf(int(j == 2 + n)) for j in range(width)] for n, at in enumerate(self.extra)}
        self.equations: Rows = []

    def sight(self, at: At) -> list[Any]:
        """What is seen, as a row over the unknowns."""
        return self.unit[at] if at in self.unit else self.here(at)

    def here(self, at: At) -> list[Any]:
        if at.kind == "dy":
            A = coefficients(self.beam, self.part, number(at.place), self.lam, self.P)
            return self.sum([(A[0, j][0], self.z[j]) for j in range(4) if (0, j) in A])
        return self.z[{"y": 0, "slope": 1}[at.kind]]

    def sum(self, parts: list[tuple[Any, list[Any]]]) -> list[Any]:
        return [sum((f * row[j] for f, row in parts), mpf(0)) for j in range(2 + len(self.extra))]

    def force(self, at: At) -> list[Any]:
        """What the terms do on δ(at)."""
        terms = [t for t in self.beam.terms if t.moves == at]
        factors = [number(t.mass) * self.lam**2 + number(t.damping) * self.lam + t.stiffness(self.P) for t in terms]
        return self.sum([(f, self.sight(t.sees)) for f, t in zip(factors, terms, strict=True)])

    def side(self, place: Any, side: int) -> None:
        for at in self.beam.sights:
            if at.kind in ("y", "slope", "dy") and (at.place, at.side) == (place, side):
                if at in self.unit:
                    self.equations.append(self.sum([(1, self.here(at)), (-1, self.unit[at])]))
                if at.kind != "dy":
                    row = {"y": 3, "slope": 2}[at.kind]
                    self.forces.append((row, self.force(at)))
        for row, force in self.forces:
            self.z[row] = self.sum([(1, self.z[row]), (1, force)])
        self.forces = []

    def pass_place(self, place: Any) -> None:
        self.forces: list[tuple[int, list[Any]]] = []
        self.side(place, -1)
        for at in self.extra:
            if at.kind.startswith("jump") and at.place == place:
                row, dual = (0, 3) if at.kind == "jump y" else (1, 2)
                self.equations.append(self.sum([(-1, self.z[dual]), (1, self.force(at))]))
                self.z[row] = self.sum([(1, self.z[row]), (1, self.unit[at])])
        self.side(place, +1)

    def equation(self) -> Any:
        """F(λ, P)."""
        beam = self.beam
        stops = {at.place for at in beam.sights if at.kind != "q"} | {s.low for s in beam.segments} | {1}
        places = sorted(stops)
        self.part = beam.segments[0]
        self.pass_place(places[0])
        for low, high in pairwise(places):
            self.part = next(s for s in beam.segments if s.low <= low < s.high)
            count = int(mp.ceil(number(high - low) / SIZE))
            h = number(high - low) / count
            for n in range(count):
                self.z = step(coefficients(beam, self.part, number(low) + n * h, self.lam, self.P), self.z, h)
            self.pass_place(high)
        for at in self.extra:
            if at.kind == "q":
                self.equations.append(self.force(at))
        return det(matrix([*self.equations, *(self.z[i] for i in self.end)]))


def equation(beam: Beam, lam: Any, P: Any) -> Any:
    """F(λ, P), whose zeros λ are the eigenvalues at load P."""
    return Passage(beam, lam, P).equation()


class Root:
    """The λ² of an undamped column in place of λ, a real number: mpf where λ itself would be imaginary."""

    def __init__(self, square: Any):
        self.square = square

    def __pow__(self, power: int) -> Any:
        assert power == 2
        return self.square

    def __mul__(self, other: Any) -> Any:
        return 0 * self.square

    __rmul__ = __mul__


def of_square(beam: Beam, square: Any, P: Any) -> Any:
    return Passage(beam, Root(square), P).equation()


def newton(equations: Callable[[Any, Any], tuple[Any, Any]], a: Any, b: Any) -> tuple[Any, Any]:
    """The root of two real equations in (a, b), near a start, with the Jacobian there, by differences."""
    h, k = abs(a) * mpf("1e-14"), abs(b) * mpf("1e-14")
    start = equations(a, b)
    fa, ga = (u - v for u, v in zip(equations(a + h, b), start, strict=True))
    fb, gb = (u - v for u, v in zip(equations(a, b + k), start, strict=True))
    full, (f, g) = fa * gb - fb * ga, start
    for _ in range(20):
        da, db = (f * gb - g * fb) / full * h, (fa * g - ga * f) / full * k
        a, b = a - da, b - db
        if abs(da) < abs(a) * mpf("1e-20") and abs(db) < abs(b) * mpf("1e-20"):
            return a, b
        f, g = equations(a, b)
    raise ArithmeticError("Newton's method does not end")


def flutter(beam: Beam, omega: Any, P: Any) -> tuple[Any, Any]:
    """P, ω of F(iω, P) = 0, from a start."""

    def parts(w: Any, p: Any) -> tuple[Any, Any]:
        F = equation(beam, mpc(0, w), p)
        return F.real, F.imag

    with workdps(DIGITS):
        w, p = newton(parts, mpf(omega), mpf(P))
        return p, w


def coalescence(beam: Beam, omega: Any, P: Any) -> tuple[Any, Any]:
    """P, ω of F = ∂F/∂s = 0, s = λ² = −ω²: two frequencies of an undamped column meet."""

    def parts(s: Any, p: Any) -> tuple[Any, Any]:
        h = abs(s) * mpf("1e-12")
        up, down = of_square(beam, s + h, p), of_square(beam, s - h, p)
        return (up + down) / 2, (up - down) / (2 * h)

    with workdps(DIGITS):
        s, p = newton(parts, -(mpf(omega) ** 2), mpf(P))
        return p, mp.sqrt(-s)


def divergence(beam: Beam, P: Any) -> Any:
    """P of F(0, P) = 0; the factor s^rigid of motions that are left out is divided away."""

    def stiffness(p: Any) -> Any:
        if beam.rigid == 0:
            return of_square(beam, mpf(0), p)
        h = mpf("1e-12")
        up, down = of_square(beam, h, p), of_square(beam, -h, p)
        return (up - down) / h if beam.rigid == 1 else (up + down) / h**2

    with workdps(DIGITS):
        return mp.findroot(stiffness, (mpf(P), mpf(P) * (1 + mpf("1e-4"))), tol=mpf("1e-50"), maxsteps=30, verify=False)


def exponential(beam: Beam, lam: Any, P: Any) -> Any:
    """F of a column with one uniform segment and no term but a follower force at the tip, by the matrix exponential."""
    with workdps(DIGITS):
        A = matrix(4, 4)
        for (i, j), terms in coefficients(beam, beam.segments[0], mpf(0), lam, P).items():
            A[i, j] = terms[0]
        held = {"clamped": (0, 1), "pinned": (0, 2), "free": (2, 3)}
        T = mp.expm(A)
        for term in beam.terms:
            force = matrix(4, 4)
            row = A[0, :] if term.sees.kind == "dy" else eye(4)[1, :]
            force[3, :] = term.stiffness(P) * row
            T = T + force * T
        start = [i for i in range(4) if i not in held[beam.ends[0]]]
        return det(matrix([[T[i, j] for j in start] for i in held[beam.ends[1]]]))
