"""Check a certificate: a program of its own that shares no code with the one that wrote it.

Products of trial functions are integrated as the bilinear forms say, of modes by Arb's quadrature, of polynomials
exactly. Signs of determinants at the separators show that the column is stable below the load; a growing eigenvalue,
or the sign of det K, that it is not at the upper end of the load's interval. Numbers are balls: a comparison is true
only where it is proven. All is proven of the ends, forms and damping in the file; `column`, `parameters` and the sizes
of `alpha`, `beta` and `kappa` name where these come from, and are not read.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from fractions import Fraction
from functools import cache
from itertools import pairwise
from pathlib import Path
from typing import Any

import flint
from flint import acb, acb_mat, arb, arb_mat, arb_poly, arb_series, fmpq, fmpq_mat, fmpq_poly, fmpq_series

ORDERS = {"free": (2, 3), "clamped": (0, 1), "pinned": (0, 2), "sliding": (1, 3)}
Basis = tuple[Callable[..., arb], Callable[..., arb]]
Line = tuple[Fraction, Fraction]


class Refused(Exception):
    """The certificate does not prove what it claims; the message says where."""


def require(condition: bool, claim: str) -> None:
    if not condition:
        raise Refused(claim)


def ball(value: str | Fraction) -> arb:
    value = Fraction(value)
    return arb(fmpq(value.numerator, value.denominator))


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


def roots(ends: list[str], count: int) -> list[arb]:
    """The first positive roots of the characteristic determinant, each alone in its ball, none left out."""
    # up to an order all derivatives vanish at γ = 0, exactly; while the next one keeps its sign there is no other root
    at_0 = determinant(conditions(fmpq_series([0, 1], 8), ends))
    order = next(k for k in range(8) if at_0[k] != 0)
    near_0 = (characteristic(arb(k).union(arb(k + 1)) / 256, ends, order + 1)[order] for k in range(128))
    require(not any(c.contains(0) for c in near_0), "the characteristic determinant may vanish close to γ = 0")
    found: list[arb] = []
    low = arb(1) / 2
    while len(found) < count:
        found, low = found + within(low, low + arb(1) / 8, ends), low + arb(1) / 8
    return found[:count]


def within(low: arb, high: arb, ends: list[str]) -> list[arb]:
    """The roots from low to high, by bisection, then by interval Newton to the precision in hand."""
    box, middle = low.union(high), (low + high) / 2
    value, slope = (characteristic(box, ends)[k] for k in (0, 1))
    if not value.contains(0):
        return []
    if slope.contains(0):
        require(high - low > arb("1e-9"), f"roots near γ = {float(low):.8g} could not be told apart")
        return within(low, middle, ends) + within(middle, high, ends)
    change = characteristic(low, ends)[0] * characteristic(high, ends)[0]
    require(not change.contains(0), "a root lies on the edge of a box")
    if change > 0:
        return []
    while True:
        middle = arb(box.mid())
        step = characteristic(middle, ends)[0] / characteristic(box, ends)[1]
        image = (middle - step).intersection(box)
        if not image.rad() < box.rad() * arb("0.9"):
            return [box]
        box = image


def modes(ends: list[str], count: int) -> Basis:
    """Derivatives of the first modes at a place; integrals of x^power times derivatives of two of them."""
    gammas, factors = roots(ends, count), []
    for g in gammas:
        # the determinant vanishes: its cofactors along the last row solve all four equations, and nothing else does
        rows = conditions(g, ends)[:3]
        cofactors = [(-1) ** k * determinant([row[:k] + row[k + 1 :] for row in rows]) for k in range(4)]
        leading = [c for c in cofactors if not c.contains(0)]
        require(bool(leading), "a mode could not be computed")
        factors.append([c / leading[0] for c in cofactors])

    def value(n: int, d: int, z: acb) -> acb:
        (a, b, c, e), u = factors[n], gammas[n] * z
        sine, cosine = turned(u.sin(), u.cos(), d)
        waves = a * sine + b * cosine + (-1) ** d * c * (-u).exp() + e * (u - gammas[n]).exp()
        return waves * gammas[n] ** d  # type: ignore[no-any-return]

    def integral(power: int, one: tuple[int, int], other: tuple[int, int]) -> arb:
        return acb.integral(lambda z, _: z**power * value(*one, z) * value(*other, z), 0, 1).real

    return lambda n, d, x: value(n, d, acb(x)).real, integral


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


def matrices(certificate: dict[str, Any]) -> dict[str, arb_mat]:
    """M, E, H from the bilinear forms."""
    N = certificate["modes"]
    require(type(N) is int and N > 0, "the number of trial functions is none")
    left, right = certificate["ends"]
    value, integral = BASES[certificate["basis"]]([left, right], N)
    integral = cache(integral)

    def entry(form: dict[str, Any], i: int, j: int) -> arb:
        along = [ball(v) * integral(k, *sorted([(i, p), (j, q)])) for k, p, q, v in form["along"]]
        return sum((ball(v) * value(i, p, x) * value(j, q, y) for x, p, y, q, v in form["points"]), sum(along, arb(0)))

    forms = certificate["forms"]
    return {name: arb_mat([[entry(forms[name], i, j) for j in range(N)] for i in range(N)]) for name in "MEH"}


# --- stability ----------------------------------------------------------------------------------------------


class Beam:
    """det(E + P H − x M + iω C) = h + iω g at ω = √x, from the matrices; C is zero without damping."""

    def __init__(self, certificate: dict[str, Any]) -> None:
        damping, (self.M, self.E, self.H) = certificate["damping"], matrices(certificate).values()
        self.N, self.damped = int(certificate["modes"]), damping is not None
        self.C = ball(damping["of_M"]) * self.M + ball(damping["of_E"]) * self.E if self.damped else 0 * self.M
        self.finite = self.damped and not damping["vanishing"]

    def stiffness(self, P: arb) -> arb:
        return (self.E + P * self.H).det()

    def h_and_g(self, P: arb, x: arb) -> tuple[arb, arb]:
        A = self.E + P * self.H - x * self.M
        if not self.finite or x == 0:
            # g to first order in the damping, which at x = 0 is all of it
            return A.det(), A.det() * (A.inv() * self.C).trace()
        omega = x.sqrt()
        d = (acb_mat(A) + acb(0, 1) * omega * acb_mat(self.C)).det()
        return d.real, d.imag / omega

    def check_stable(self, start: Fraction, end: Fraction, origin: Fraction, lines: list[Line]) -> None:
        """Hermite and Biehler: real, positive, simple, interlacing roots of h and g at every load of a stretch.

        lines: places x = point + slope (P − origin) between neighbouring roots, zero before them. Without damping h is
        of one sign more, and stability is that its N roots are real, positive and simple.
        """
        where = f"between the loads {float(start):.10g} and {float(end):.10g}"
        N, (near, far) = self.N, (ball(origin - P) for P in (end, start))
        require(len(lines) == (2 * N if self.damped else N + 1), f"there are too few separators {where}")
        for P in (start, end):
            places = [point + slope * (P - origin) for point, slope in lines]
            require(all(a < b for a, b in pairwise(places)), f"the separators do not ascend {where}")
        nodes = [start + (end - start) * k / N for k in range(N + 1)]
        for k, (point, slope) in enumerate(lines):
            values = [self.h_and_g(ball(P), ball(point + slope * (P - origin))) for P in nodes]
            # both are polynomials of degree N at most in P, on such a line too
            h, g = (arb_poly.interpolate([ball(origin - P) for P in nodes], v) for v in zip(*values, strict=True))
            sign_h, sign_g = (-1) ** ((k + 1) // 2 if self.damped else k), (-1) ** (k // 2)
            require(positive(sign_h * h, near, far), f"the roots of h are not separated {where}")
            if self.damped and 0 < k < max(2, 2 * N - 1):
                require(positive(sign_g * g, near, far), f"the roots of g are not separated {where}")

    def growing(self, P: arb) -> list[arb]:
        """Squared frequencies of eigenvalues that grow at a load."""
        K, C = (self.M.inv() * matrix for matrix in (self.E + P * self.H, self.C))
        if not self.finite:
            # λ² + cλ + x = 0 for each mode, c to first order in the damping: λ grows where x is not real, or c negative
            found, left, right = acb_mat(K).eig(left=True, right=True)
            c = left * acb_mat(C) * right
            return [x.real for k, x in enumerate(found) if not x.imag.contains(0) or c[k, k].real < 0]
        N = self.N
        rows: list[list[Any]] = [[int(j == N + i) for j in range(2 * N)] for i in range(N)]
        rows += [[-v for v in (*one, *other)] for one, other in zip(K.tolist(), C.tolist(), strict=True)]
        return [v.imag**2 for v in acb_mat(rows).eig(algorithm="rump") if v.real > 0]


def positive(polynomial: arb_poly, low: arb, high: arb) -> bool:
    """Whether a polynomial is positive from low to high, by bisection."""
    waiting = [(low, high)]
    for _ in range(8 * flint.ctx.prec):
        if not waiting:
            return True
        a, b = waiting.pop()
        value = polynomial(a.union(b))
        if not value > 0:
            # halves on a logarithmic scale: the polynomial goes to zero with P − origin towards a crossing
            middle = arb(((a * b).sqrt() if a > 0 and b > 4 * a else (a + b) / 2).mid())
            if value < 0 or not a < middle < b:
                return False
            waiting += [(a, middle), (middle, b)]
    return False


# --- the certificate ----------------------------------------------------------------------------------------


def verify(certificate: dict[str, Any]) -> str:
    """Check a certificate; a sentence of what it proves. Raises Refused where it does not."""
    try:
        require(certificate.get("format") == "freebeam certificate 1", "this is no certificate of a known format")
        low, high = map(Fraction, certificate["load"] or (0, 1))
        with flint.ctx.workprec(200 + 40 * int(certificate["modes"]) + 2 * int(high / (high - low)).bit_length()):
            return _verified(certificate)
    except (ArithmeticError, AttributeError, LookupError, TypeError, ValueError) as error:
        raise Refused(f"is not a certificate: {type(error).__name__}: {error}") from error


def _verified(certificate: dict[str, Any]) -> str:
    kind, load, squares, damping = (certificate[k] for k in ("kind", "load", "frequency_squared", "damping"))
    require(kind in ("none", "flutter", "divergence"), "the kind is neither flutter nor divergence")
    crosses = kind != "none"
    claims = {"crossing": crosses, "first": crosses, "stable_below": True, "kind": True}
    require(certificate["proof"] == claims, "what is said to be proven is not what is checked")
    given = [v is not None for v in (load, squares, certificate["load_max"])]
    require(given == [crosses, kind == "flutter", not crosses], "what is given does not fit the kind")
    alpha, beta, limit = Fraction(certificate["alpha"]), Fraction(certificate["beta"]), certificate["kappa"] is not None
    finite = alpha != 0 or beta != 0
    require(not (finite and limit), "the damping is finite and vanishes")
    require((damping is not None) == (finite or limit), "the damping does not fit alpha, beta and kappa")
    require(not damping or damping["vanishing"] is limit, "the damping does not fit kappa")

    beam, reached = Beam(certificate), Fraction(0)
    for stretch in certificate["stretches"]:
        start, end, origin = (Fraction(stretch[k]) for k in ("start", "end", "origin"))
        require(start == reached, "the stretches leave a gap")
        lines = [(Fraction(point), Fraction(slope)) for point, slope in ((0, 0), *stretch["separators"])]
        beam.check_stable(start, end, origin, lines)
        reached = end
    low, high = map(Fraction, load or 2 * [certificate["load_max"]])
    require(reached == low > 0, "stability is not shown up to the load")
    if not crosses:
        return f"stable up to the load {float(low):.10g}"

    proven = f"stable below the load {float(low):.10g}"
    if kind == "divergence":
        require(beam.stiffness(ball(high)) < 0, "det K does not change sign within the load's interval")
        return f"{proven}, diverges in the interval given"
    require(beam.stiffness(ball(low).union(ball(high))) > 0, "det K may vanish within the load's interval")
    x_low, x_high = map(ball, squares)
    found = beam.growing(ball(high))
    require(bool(found), "no eigenvalue is known to grow at the upper end of the load")
    require(any(0 < x_low < x < x_high for x in found), "the frequency does not fit")
    return f"{proven}, flutters from within the interval given"


def verify_file(path: Path | str) -> str:
    """Check a certificate file. Raises Refused with the reason in one line."""
    try:
        return verify(json.loads(Path(path).read_text(encoding="utf-8")))
    except OSError as error:
        raise Refused(f"{path}: cannot be read: {error.strerror}") from error
    except (ValueError, RecursionError) as error:
        raise Refused(f"{path}: is not a certificate: {error}") from error
    except Refused as error:
        raise Refused(f"{path}: {error}") from error
