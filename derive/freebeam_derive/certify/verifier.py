"""Check a certificate: a program of its own that shares no code with the one that wrote it.

It reads the bilinear forms and the ends, integrates products of trial functions rigorously (of modes by Arb's
quadrature, of polynomials exactly), and then checks that the signs of determinants at the separators prove stability
below the load, that an eigenvalue has a positive real part at the upper end of the load's interval, and that this is
flutter or divergence as claimed.
"""

from __future__ import annotations

import json
from fractions import Fraction
from itertools import pairwise
from pathlib import Path
from typing import Any

import flint
from flint import acb, acb_mat, arb, arb_mat, arb_poly, arb_series, fmpq, fmpq_mat, fmpq_poly

ORDERS = {"free": (2, 3), "clamped": (0, 1), "pinned": (0, 2), "sliding": (1, 3)}


class Refused(ValueError):
    """The certificate does not prove what it claims; the message says where."""


def ball(value: Fraction) -> arb:
    return arb(fmpq(value.numerator, value.denominator))


def require(condition: bool, claim: str) -> None:
    if not condition:
        raise Refused(claim)


# --- modes of the comparison beam: sin γx, cos γx, e^(−γx), e^(−γ(1−x)) ---------------------------------------


def rows(g: Any, ends: list[str], zero: Any) -> list[list[Any]]:
    """End conditions, each divided by γ^d, over the four functions; g a ball or a series."""
    s, c, small = g.sin(), g.cos(), (-g).exp()
    at_0 = [(zero, zero + 1), (zero + 1, zero), (zero, zero - 1), (zero - 1, zero)]
    at_1 = [(s, c), (c, -s), (-s, -c), (-c, s)]
    found = [[*at_0[d], zero + (-1) ** d, small] for d in ORDERS[ends[0]]]
    return found + [[*at_1[d], (-1) ** d * small, zero + 1] for d in ORDERS[ends[1]]]


def determinant(m: list[list[Any]]) -> Any:
    """By expansion, for balls and series alike."""
    if len(m) == 1:
        return m[0][0]
    minors = [[row[:k] + row[k + 1 :] for row in m[1:]] for k in range(len(m))]
    terms = [m[0][k] * determinant(minors[k]) for k in range(len(m))]
    total = terms[0]
    for k, term in enumerate(terms[1:], start=1):
        total = total - term if k % 2 else total + term
    return total


def taylor(g: arb, ends: list[str], order: int, scaled: bool = False) -> list[arb]:
    """Taylor coefficients of the characteristic determinant at γ (times e^γ where scaled), up to an order."""
    before, flint.ctx.cap = flint.ctx.cap, order + 1
    try:
        variable = arb_series([g, 1])
        series = determinant(rows(variable, ends, arb_series([0]))) * (variable.exp() if scaled else 1)
        return [arb_series(series)[k] for k in range(order + 1)]
    finally:
        flint.ctx.cap = before


def roots(ends: list[str], modes: int) -> list[arb]:
    """The first `modes` positive roots of the characteristic determinant, each alone in its ball, none left out."""
    # at γ = 0 the determinant may vanish; its first derivative that does not keeps its sign up to γ = 1/2
    order = next(k for k, c in enumerate(taylor(arb(0), ends, 7, scaled=True)) if not c.contains(0))
    signs = set()
    for k in range(512):
        c = taylor((k + arb(0.5, 0.5)) / 1024, ends, order, scaled=True)[order]
        signs.add(1 if c > 0 else -1 if c < 0 else 0)
    require(len(signs) == 1 and 0 not in signs, "the determinant may vanish close to γ = 0")
    found: list[arb] = []
    low, width = arb("0.5"), arb(1) / 8
    while len(found) < modes:
        high = low + width
        box = low.union(high)
        value, slope = taylor(box, ends, 1)
        if value.contains(0):
            if slope.contains(0):
                require(width > arb("1e-9"), f"roots near γ = {float(low):.8g} could not be told apart")
                width = width / 2
                continue
            a, b = taylor(low, ends, 0)[0], taylor(high, ends, 0)[0]
            require(not (a * b).contains(0), "a root lies on the edge of a box")
            if a * b < 0:
                found.append(refined(box, ends))
        low, width = high, min(width * 2, arb(1) / 8)
    return found


def refined(box: arb, ends: list[str]) -> arb:
    """Interval Newton in a box that holds one root, to the precision in hand."""
    for _ in range(200):
        middle = box.mid()
        slope = taylor(box, ends, 1)[1]
        image = (middle - taylor(middle, ends, 0)[0] / slope).intersection(box)
        if not image.rad() < box.rad() * arb("0.9"):
            return image
        box = image
    return box


def modes(ends: list[str], count: int) -> Any:
    """The products of two modes' derivatives at places or integrated, as a function (i, p, j, q, k or places)."""
    gammas, factors = roots(ends, count), []
    for g in gammas:
        conditions = rows(g, ends, arb(0))
        for lead in (0, 1):
            size = 3 - lead
            left = arb_mat([row[lead + 1 :] for row in conditions[:size]])
            try:
                solution = left.solve(arb_mat([[-row[lead]] for row in conditions[:size]]))
            except ZeroDivisionError:
                continue
            factors.append([arb(0)] * lead + [arb(1), *solution.entries()])
            break
        require(len(factors) > gammas.index(g), "a mode could not be computed")

    def value(n: int, d: int, z: acb) -> acb:
        (a, b, c, e), u = factors[n], gammas[n] * z
        s, k = ((u.sin(), u.cos()), (u.cos(), -u.sin()), (-u.sin(), -u.cos()), (-u.cos(), u.sin()))[d]
        return (a * s + b * k + (-1) ** d * c * (-u).exp() + e * (u - gammas[n]).exp()) * gammas[n] ** d  # type: ignore[no-any-return]

    def product(i: int, p: int, j: int, q: int, power: int | None, x: int = 0, y: int = 0) -> arb:
        if power is None:
            return (value(i, p, acb(x)) * value(j, q, acb(y))).real
        return acb.integral(lambda z, _: z**power * value(i, p, z) * value(j, q, z), 0, 1).real

    return product


def polynomials(ends: list[str], count: int) -> Any:
    """As `modes`, of polynomials that meet the geometric conditions and are orthogonal to the rigid motions.

    Any basis of theirs has the same eigenvalues; the degree follows from how many there are.
    """

    def condition(order: int, end: int, degree: int) -> list[fmpq]:
        powers = [fmpq_poly([0] * k + [1]) for k in range(degree + 1)]
        for _ in range(order):
            powers = [power.derivative() for power in powers]
        return [fmpq(power(end)) for power in powers]

    held = [(order, end) for end, kind in enumerate(ends) for order in ORDERS[kind] if order < 2]
    rigid = kernel([condition(*h, 1) for h in held], 2)
    degree = count - 1 + len(held) + len(rigid)
    orthogonal = [[(fmpq_poly([0] * k + [1]) * r).integral()(1) for k in range(degree + 1)] for r in rigid]
    found = kernel([condition(*h, degree) for h in held] + orthogonal, degree + 1)
    require(len(found) == count, "there are not so many polynomials of that degree")

    def product(i: int, p: int, j: int, q: int, power: int | None, x: int = 0, y: int = 0) -> arb:
        f, g = found[i], found[j]
        for _ in range(p):
            f = f.derivative()
        for _ in range(q):
            g = g.derivative()
        total = f(x) * g(y) if power is None else (fmpq_poly([0] * power + [1]) * f * g).integral()(1)
        return arb(fmpq(total))

    return product


def kernel(conditions: list[list[fmpq]], unknowns: int) -> list[fmpq_poly]:
    """Polynomials whose coefficients solve linear equations, as many as are independent."""
    if not conditions:
        return [fmpq_poly([0] * k + [1]) for k in range(unknowns)]
    reduced, rank = fmpq_mat(conditions).rref()
    pivots = [next(c for c in range(unknowns) if reduced[r, c] != 0) for r in range(rank)]
    found = []
    for free in (c for c in range(unknowns) if c not in pivots):
        solution = [fmpq(int(c == free)) for c in range(unknowns)]
        for r, pivot in enumerate(pivots):
            solution[pivot] = -reduced[r, free]
        found.append(fmpq_poly(solution))
    return found


def matrices(certificate: dict[str, Any]) -> dict[str, arb_mat]:
    """M, E, H from the bilinear forms."""
    N, product = int(certificate["modes"]), BASES[certificate["basis"]](certificate["ends"], int(certificate["modes"]))

    def entry(form: dict[str, Any], i: int, j: int) -> arb:
        along = (ball(Fraction(v)) * product(i, p, j, q, k) for k, p, q, v in form["along"])
        points = (ball(Fraction(v)) * product(i, p, j, q, None, x, y) for x, p, y, q, v in form["points"])
        return sum((*along, *points), arb(0))

    found = {}
    for letter, form in certificate["forms"].items():
        symmetric = not form["points"] and all(p == q for _, p, q, _ in form["along"])
        half = {(i, j): entry(form, i, j) for i in range(N) for j in range(N) if j >= i or not symmetric}
        found[letter] = arb_mat([[half[(i, j) if (i, j) in half else (j, i)] for j in range(N)] for i in range(N)])
    return found


BASES = {"modes": modes, "legendre": polynomials}


# --- stability ----------------------------------------------------------------------------------------------


class Beam:
    """det(E + P H − x M + iω C) = h + iω g at ω = √x, from the matrices."""

    def __init__(self, certificate: dict[str, Any]) -> None:
        found = matrices(certificate)
        self.M, self.E, self.H = found["M"], found["E"], found["H"]
        self.N = int(certificate["modes"])
        damping = certificate["damping"]
        self.C = (
            None
            if damping is None
            else ball(Fraction(damping["of_M"])) * self.M + ball(Fraction(damping["of_E"])) * self.E
        )
        self.vanishing = damping is not None and damping["vanishing"]

    def h_and_g(self, P: arb, x: arb) -> tuple[arb, arb]:
        A = self.E + P * self.H - x * self.M
        if self.C is None:
            return A.det(), arb(0)
        if self.vanishing or x.contains(0):
            # to first order in the damping; at x = 0 that is h alone
            inverse = A.inv()
            return A.det(), A.det() * (inverse * self.C).trace()
        omega = x.sqrt()
        d = (acb_mat(A) + acb(0, 1) * omega * acb_mat(self.C)).det()
        return d.real, d.imag / omega

    def signs(self, stretch: dict[str, Any], point: Fraction, slope: Fraction) -> tuple[int, int]:
        """Signs of h and g along x = point + slope (P − origin) for all P of a stretch, 0 where one is not kept."""
        start, end, origin = (Fraction(stretch[k]) for k in ("start", "end", "origin"))
        nodes = [start + (end - start) * k / self.N for k in range(self.N + 1)]
        values = [self.h_and_g(ball(P), ball(point + slope * (P - origin))) for P in nodes]
        # both are polynomials of degree N at most in P, on such a line too; t = origin − P
        t = [ball(origin - P) for P in nodes]
        near, far = ball(origin - end), ball(origin - start)
        h, g = (
            kept(arb_poly.interpolate(t, [v[k] for v in values]), near, far) if k == 0 or self.C is not None else 0
            for k in (0, 1)
        )
        return h, g

    def eigenvalues(self, P: arb) -> list[acb]:
        """Eigenvalues λ at a load, as balls."""
        N, inverse = self.N, self.M.inv()
        K = inverse * (self.E + P * self.H)
        C = arb_mat(N, N) if self.C is None else inverse * self.C
        A = acb_mat(2 * N, 2 * N)
        for i in range(N):
            A[i, N + i] = 1
            for j in range(N):
                A[N + i, j], A[N + i, N + j] = -K[i, j], -C[i, j]
        return list(A.eig(algorithm="rump"))


def kept(polynomial: arb_poly, low: arb, high: arb) -> int:
    """The sign that a polynomial keeps from low to high, by bisection; 0 where it does not, or is not seen to."""
    sign, waiting = 0, [(low, high, 0)]
    while waiting:
        a, b, depth = waiting.pop()
        value = polynomial(a.union(b))
        if value.contains(0):
            if depth > 4 * flint.ctx.prec:
                return 0
            # halves on a logarithmic scale: the polynomial goes to zero with t towards a crossing
            middle = ((a * b).sqrt() if a > 0 and b > 4 * a else (a + b) / 2).mid()
            if not (a < middle < b):
                return 0
            waiting += [(a, middle, depth + 1), (middle, b, depth + 1)]
            continue
        here = 1 if value > 0 else -1
        if sign == -here:
            return 0
        sign = here
    return sign


def check_stable(beam: Beam, stretch: dict[str, Any]) -> None:
    """Hermite and Biehler: real, positive, simple, interlacing roots of h and g at every load of the stretch."""
    where = f"between the loads {float(Fraction(stretch['start'])):.10g} and {float(Fraction(stretch['end'])):.10g}"
    lines = [(Fraction(0), Fraction(0)), *((Fraction(a), Fraction(b)) for a, b in stretch["separators"])]
    for P in (Fraction(stretch["start"]), Fraction(stretch["end"])):
        places = [a + b * (P - Fraction(stretch["origin"])) for a, b in lines]
        require(all(a < b for a, b in pairwise(places)), f"the separators do not ascend {where}")
    damped = beam.C is not None
    require(len(lines) == (2 * beam.N if damped else beam.N + 1), f"there are too few separators {where}")
    signs = [beam.signs(stretch, *line) for line in lines]
    if not damped:
        require(
            all(h == (-1) ** k for k, (h, _) in enumerate(signs)), f"a sign at a separator is not as claimed {where}"
        )
        return
    require(signs[0][0] == 1, f"det K is not known to be positive {where}")
    changes_h = [k for k in range(1, len(signs)) if signs[k][0] * signs[k - 1][0] == -1]
    require(changes_h == list(range(1, len(signs), 2)), f"the roots of h are not separated {where}")
    changes_g = [k for k in range(2, len(signs) - 1) if signs[k][1] * signs[k - 1][1] == -1]
    require(
        signs[1][1] == 1 and changes_g == list(range(2, len(signs) - 1, 2)), f"the roots of g are not separated {where}"
    )


def verify(certificate: dict[str, Any]) -> str:
    """Check a certificate; a sentence of what it proves. Raises Refused where it does not."""
    require(certificate.get("format") == "freebeam certificate 1", "this is no certificate of a known format")
    require(certificate["basis"] in BASES, "the trial functions are neither modes nor polynomials")
    claimed = certificate["load"]
    digits = (
        0 if claimed is None else len(str(Fraction(claimed[1]) / (Fraction(claimed[1]) - Fraction(claimed[0])))) // 2
    )
    N = int(certificate["modes"])
    before, flint.ctx.prec = flint.ctx.prec, 200 + 40 * N + max(0, 8 * digits)
    try:
        return _verified(certificate)
    finally:
        flint.ctx.prec = before


def _verified(certificate: dict[str, Any]) -> str:
    beam = Beam(certificate)
    stretches = certificate["stretches"]
    require(bool(stretches) and Fraction(stretches[0]["start"]) == 0, "the stretches do not begin at the load zero")
    for one, following in pairwise(stretches):
        require(Fraction(one["end"]) == Fraction(following["start"]), "the stretches leave a gap")
    for stretch in stretches:
        check_stable(beam, stretch)
    last = Fraction(stretches[-1]["end"])
    if certificate["kind"] == "none":
        require(last >= Fraction(certificate["load_max"]), "stability is not shown up to the largest load")
        return f"stable up to the load {float(last):.10g}"
    low, high = (Fraction(v) for v in certificate["load"])
    require(last >= low, "stability is not shown up to the lower end of the load")
    K_low, K_high = ((beam.E + ball(P) * beam.H).det() for P in (low, high))
    if certificate["kind"] == "divergence":
        require(K_low > 0 and K_high < 0, "det K does not change sign within the load's interval")
        return f"stable below the load {float(low):.10g}, diverges in the interval given"
    require(certificate["kind"] == "flutter", "the kind is neither flutter nor divergence")
    require((beam.E + ball(low).union(ball(high)) * beam.H).det() > 0, "det K may vanish within the load's interval")
    check_flutter(beam, certificate, ball(high))
    return f"stable below the load {float(low):.10g}, flutters from within the interval given"


def check_flutter(beam: Beam, certificate: dict[str, Any], high: arb) -> None:
    """An oscillation that grows at the upper end of the load's interval."""
    x_low, x_high = (ball(Fraction(v)) for v in certificate["frequency_squared"])
    require(x_low > 0, "the frequency is not positive")
    if beam.vanishing:
        # the growth of a branch, −g / f_x to first order, has changed sign: h and g no longer interlace
        (h, g), (h_above, g_above) = (beam.h_and_g(high, x) for x in (x_low, x_high))
        require(h * h_above < 0 or g * g_above < 0, "no branch is known to gain energy at the frequency given")
        return
    growing = [v for v in beam.eigenvalues(high) if v.real > 0]
    require(bool(growing), "no eigenvalue is known to grow at the upper end of the load")
    near = (abs(v.imag**2 - (x_low + x_high) / 2) < (x_high - x_low) / 2 + 3 * v.real * abs(v) for v in growing)
    require(any(near), "the frequency does not fit")


def verify_file(path: Path | str) -> str:
    """Check a certificate file. Raises Refused with the reason in one line."""
    try:
        certificate = json.loads(Path(path).read_text(encoding="utf-8"))
        return verify(certificate)
    except OSError as error:
        raise Refused(f"{path}: cannot be read: {error.strerror}") from error
    except (AttributeError, KeyError, TypeError, IndexError, ZeroDivisionError) as error:
        raise Refused(f"{path}: is not a certificate: {type(error).__name__} {error}") from error
    except Refused as error:
        raise Refused(f"{path}: {error}") from error
    except ValueError as error:
        raise Refused(f"{path}: is not a certificate: {error}") from error
