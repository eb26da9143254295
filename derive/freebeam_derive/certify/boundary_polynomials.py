"""The polynomials h and g, whose common zeros are the eigenvalues on the imaginary axis. Eqs. (10), (24), (25).

On λ = iω, with x = ω²,

    det(λ² M + λ C + K) / det M = h(P, x) + iω g(P, x).

Determinants are taken at real λ, as polynomials in P, and interpolated. In the limit of vanishing damping g is of the
first order in C, tr(adj(K − x M) C) / det M. Without damping g stands for ∂h/∂x: h and g vanish together where two
frequencies meet.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from types import ModuleType
from typing import Any

from flint import arb, arb_mat, arb_poly

from freebeam_derive.certify.balls import Exact, Unproven, coefficients, exact, matrices, parameters, precision
from freebeam_derive.certify.bivariate import Bivariate


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
class Boundary:
    """h and g of N functions, each a polynomial in P and x; `damped` is False where g is ∂h/∂x.

    As a system of equations: h = g = 0 in the unknowns (P, x), or det K = h(P, 0) = 0 in the one unknown (P,).
    """

    N: int
    h: Bivariate
    g: Bivariate
    damped: bool

    def value(self, z: Sequence[arb]) -> list[arb]:
        """The equations at a point or over a box."""
        if len(z) == 1:
            return [self.h(z[0], arb(0))]
        P, x = z
        return [self.h(P, x), self.g(P, x)]

    def slopes(self, z: Sequence[arb]) -> arb_mat:
        """Their derivatives by P, and by x."""
        if len(z) == 1:
            return arb_mat([[self.h.by_P(z[0], arb(0))]])
        P, x = z
        return arb_mat([[f.by_P(P, x), f.by_x(P, x)] for f in (self.h, self.g)])

    def about(self, P: arb, x: arb) -> Boundary:
        """The same, P and x counted from a point."""
        return Boundary(self.N, self.h.about(P, x), self.g.about(P, x), self.damped)


def expansion(M: arb_mat, C: arb_mat | None, E: arb_mat, H: arb_mat, vanishing: bool = False) -> Boundary:
    """h and g where K = E + P H, of any matrices for which λ² M + λ C + E is regular at real λ > 0.

    C: None without damping; vanishing: only its direction counts.
    """
    N = M.nrows()
    # An eighth of the mean frequency: of 1/8, 1 and 4 it lost the fewest bits (free-free and Beck, N = 8 and 20, light
    # and heavy damping).
    size = ((E + M).det() / M.det()).log() / (2 * N * arb(2).log())
    if not size.is_finite():
        raise Unproven("mass and elastic stiffness are not known to be positive definite")
    step = arb(2) ** (round(float(size)) - 3)
    if C is not None and not vanishing:
        places = [step * k for k in range(1, 2 * N + 2)]
        whole = _through(places, [determinant(p**2 * M + p * C + E, H) for p in places])
        even, odd = ([arb_poly([p[j] for j in range(k, p.degree() + 1, 2)]) for p in whole] for k in (0, 1))
    else:
        places = [(step * k) ** 2 for k in range(1, N + 2)]
        even = _through(places, [determinant(p * M + E, H) for p in places])
        odd = [] if C is None else _through(places[:N], [_first_order(p * M + E, H, C) for p in places[:N]])
    scale = 1 / M.det()
    h = _in_square(even, N, scale)
    return Boundary(N, h, h.by_x if C is None else _in_square(odd, N - 1, scale), C is not None)


def _of_any(kernel: ModuleType, question: Question, own: Mapping[str, Fraction], bits: int) -> Boundary:
    """h and g of any column."""
    if question.kappa is not None:
        raise Unproven(
            f"{kernel.COLUMN['name']}: the limit of vanishing damping is proven of the textbook's columns alone"
        )
    with precision(bits):
        M, C, K = coefficients(kernel, question.modes, own, (question.alpha, question.beta))
        return general_expansion(M, C, K)


def general_expansion(M: Sequence[arb_mat], C: Sequence[arb_mat], K: Sequence[arb_mat]) -> Boundary:
    """h and g of λ² M + λ C + K, each a polynomial in P, lists by its powers; K regular at P = 0 with λ² M for λ > 0.

    C: empty without damping. Where C is nothing at P = 0, g is divided by the power of P that it holds: what is said of
    its roots is then said of P > 0.
    """
    N = M[0].nrows()
    size = ((K[0] + M[0]).det() / M[0].det()).log() / (2 * N * arb(2).log())
    if not size.is_finite():
        raise Unproven("mass and elastic stiffness are not known to be positive definite")
    step = arb(2) ** (round(float(size)) - 3)

    def at(p: arb, powers: tuple[arb, ...]) -> list[arb]:
        """Coefficients in P of the determinant, M, C and K times numbers."""
        terms = []
        for k in range(max(len(M), len(C), len(K))):
            parts = [f * X[k] for f, X in zip(powers, (M, C, K), strict=True) if k < len(X)]
            terms.append(sum(parts[1:], parts[0]) if parts else arb_mat(N, N))
        return polynomial_determinant(terms)

    if C:
        places = [step * k for k in range(1, 2 * N + 2)]
        whole = _through(places, [at(p, (p**2, p, arb(1))) for p in places])
        even, odd = ([arb_poly([p[j] for j in range(k, p.degree() + 1, 2)]) for p in whole] for k in (0, 1))
    else:
        places = [(step * k) ** 2 for k in range(1, N + 2)]
        even, odd = _through(places, [at(p, (p, arb(0), arb(1))) for p in places]), []
    scale = 1 / M[0].det()
    degrees = [highest_power(a, N, len(M) - 1, len(C) - 1, len(K) - 1) for a in range(len(even))]
    h = Bivariate([
        arb_poly([(-1) ** b * scale * p[b] for b in range(d // 2 + 1)]) for p, d in zip(even, degrees, strict=True)
    ])  # fmt: skip
    if not C:
        return Boundary(N, h, h.by_x, False)
    rows = [
        arb_poly([(-1) ** b * scale * p[b] for b in range((d + 1) // 2)]) for p, d in zip(odd, degrees, strict=True)
    ]
    none = next(k for k, X in enumerate(C) if any(v != 0 for v in X.entries()))
    return Boundary(N, h, Bivariate(rows[none:]), True)


def highest_power(a: int, N: int, of_M: int, of_C: int, of_K: int) -> int:
    """The highest power of λ that stands with P^a in det(λ² M + λ C + K), by the degrees of M, C and K in P."""
    if of_M > 0:
        return 2 * N
    best = -1
    for rows_K in range(N + 1):
        for rows_C in range(N + 1 - rows_K):
            if rows_K * max(of_K, 0) + rows_C * max(of_C, 0) >= a:
                best = max(best, 2 * N - 2 * rows_K - rows_C)
    return best


def polynomial_determinant(terms: Sequence[arb_mat]) -> list[arb]:
    """Coefficients of det(Σ P^k terms[k]) in P, the first regular. Raises Unproven.

    With G_k = A_0⁻¹ A_k it is det(A_0) det(I − P B) with B = [[−G_1, −G_2, …], [I, 0, …], …].
    """
    A, *others = terms
    n, d = A.nrows(), max(len(others), 1)
    try:
        G = [A.solve(X) for X in others]
    except ZeroDivisionError:
        raise Unproven("a matrix is not known to be regular") from None
    B = arb_mat(n * d, n * d)
    for k, X in enumerate(G):
        for i in range(n):
            for j in range(n):
                B[i, k * n + j] = -X[i, j]
    for i in range(n * (d - 1)):
        B[n + i, i] = arb(1)
    powers, scale = B.charpoly(), A.det()
    return [scale * powers[n * d - a] for a in range(n * d + 1)]


def determinant(A: Any, H: Any) -> list[Any]:
    """Coefficients of det(A + P H) in P, for matrices of balls, real or complex, A regular. Raises Unproven."""
    try:
        powers, scale = A.solve(H).charpoly(), A.det()
    except ZeroDivisionError:
        raise Unproven("a matrix is not known to be regular") from None
    return [(-1) ** a * scale * powers[A.nrows() - a] for a in range(A.nrows() + 1)]


def _first_order(A: arb_mat, H: arb_mat, C: arb_mat) -> list[arb]:
    """Coefficients in P of tr(adj(A + P H) C), what det(A + P H + ε C) has of the first order in ε.

    With G = A⁻¹ H and D = A⁻¹ C it is det(A + P H) Σ (−P)^j tr(G^j D), of which powers from N on cancel.
    """
    N, G, power = A.nrows(), A.solve(H), A.solve(C)
    traces = [power.trace()]
    for j in range(1, N):
        power = G * power
        traces.append((-1) ** j * power.trace())
    product = arb_poly(determinant(A, H)) * arb_poly(traces)
    return [product[a] for a in range(N)]


def _through(places: Sequence[arb], rows: Sequence[Sequence[arb]]) -> list[arb_poly]:
    """Polynomials through the columns of some values."""
    return [arb_poly.interpolate(list(places), list(column)) for column in zip(*rows, strict=True)]


def _in_square(factors: Sequence[arb_poly], degree: int, scale: arb) -> Bivariate:
    """From λ² to x = −λ²; powers of P and x that are together above a degree cancel."""
    return Bivariate([
        arb_poly([(-1) ** b * scale * p[b] for b in range(degree - a + 1)]) for a, p in enumerate(factors[: degree + 1])
    ])  # fmt: skip


def boundary(kernel: ModuleType, question: Question, bits: int) -> Boundary:
    """h and g of a question, in balls of so many bits."""
    own = parameters(kernel, question.own)
    vanishing = question.kappa is not None
    if kernel.COLUMN.get("general"):
        return _of_any(kernel, question, own, bits)
    alpha, beta = (question.alpha, question.beta) if question.kappa is None else (Fraction(1), question.kappa)
    with precision(bits):
        M, E, H = matrices(kernel, question.modes, own)
        if question.undamped:
            return expansion(M, None, E, H)
        given = {name: exact(value) for name, value in own.items()}
        c_M, c_E = map(arb, kernel.damping_factors(exact(alpha), exact(beta), **given))
        if vanishing and not c_E > 0:
            raise Unproven(f"{kernel.COLUMN['name']} has no internal damping that could vanish")
        return expansion(M, c_M * M + c_E * E, E, H, vanishing)
