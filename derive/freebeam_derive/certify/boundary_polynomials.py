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

from freebeam_derive.certify.balls import Exact, Unproven, coefficients, parameters, precision
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


def expansion(M: Sequence[arb_mat], C: Sequence[arb_mat], K: Sequence[arb_mat], vanishing: bool = False) -> Boundary:
    """h and g of λ² M + λ C + K, each a polynomial in P, lists by its powers; K regular at P = 0 with λ² M for λ > 0.

    C: empty without damping; vanishing: only its direction counts. Where C is nothing at P = 0, g is divided by the
    power of P that it holds: what is said of its roots is then said of P > 0.
    """
    N = M[0].nrows()
    # An eighth of the mean frequency: of 1/8, 1 and 4 it lost the fewest bits (free-free and Beck, N = 8 and 20, light
    # and heavy damping).
    size = ((K[0] + M[0]).det() / M[0].det()).log() / (2 * N * arb(2).log())
    if not size.is_finite():
        raise Unproven("mass and elastic stiffness are not known to be positive definite")
    step = arb(2) ** (round(float(size)) - 3)
    odd: list[arb_poly] = []
    if C and not vanishing:
        places = [step * k for k in range(1, 2 * N + 2)]
        whole = _through(places, [determinant(_at(p, M, K, C)) for p in places])
        even, odd = ([arb_poly([p[j] for j in range(k, p.degree() + 1, 2)]) for p in whole] for k in (0, 1))
    else:
        still = [_at(step * k, M, K) for k in range(1, N + 2)]
        places = [(step * k) ** 2 for k in range(1, N + 2)]
        even = _through(places, [determinant(terms) for terms in still])
        if C:
            odd = _through(places[:N], [_first_order(terms, C) for terms in still[:N]])
    degrees = [highest_power(a, N, len(M) - 1, len(C) - 1, len(K) - 1) for a in range(max(len(even), len(odd)))]
    h = _in_square(even, [d // 2 + 1 for d in degrees], 1 / M[0].det())
    if not C:
        return Boundary(N, h, h.by_x, False)
    none = next(k for k, X in enumerate(C) if any(v != 0 for v in X.entries()))
    g = _in_square(odd, [(d + 1) // 2 for d in degrees], 1 / M[0].det())
    return Boundary(N, h, Bivariate(g.rows[none:]), True)


def _at(p: arb, M: Sequence[arb_mat], K: Sequence[arb_mat], C: Sequence[arb_mat] = ()) -> list[arb_mat]:
    """p² M + p C + K by powers of P."""
    count = max(map(len, (M, K, C)))
    none = arb_mat(M[0].nrows(), M[0].nrows())
    return [sum((f * X[k] for f, X in ((p**2, M), (p, C), (arb(1), K)) if k < len(X)), none) for k in range(count)]


def highest_power(a: int, N: int, of_M: int, of_C: int, of_K: int) -> int:
    """The highest power of λ that stands with P^a in det(λ² M + λ C + K), by the degrees of M, C and K in P."""
    if of_M > 0:
        return 2 * N
    best = -1
    for rows_K in range(N + 1):
        left = max(a - rows_K * max(of_K, 0), 0)
        rows_C = -(-left // of_C) if of_C > 0 else 0
        if rows_K + rows_C <= N and (of_C > 0 or not left):
            best = max(best, 2 * N - 2 * rows_K - rows_C)
    return best


def determinant(terms: Sequence[Any]) -> list[Any]:
    """Coefficients of det(Σ P^k terms[k]) in P, matrices of balls, real or complex, the first regular. Raises Unproven.

    With G_k = A_0⁻¹ A_k it is det(A_0) det(I − P B) with B = [[−G_1, −G_2, …], [I, 0, …], …].
    """
    A, *others = terms
    n, d = A.nrows(), max(len(others), 1)
    try:
        G = [A.solve(X) for X in others]
    except ZeroDivisionError:
        raise Unproven("a matrix is not known to be regular") from None
    B = type(A)(n * d, n * d)
    for k, X in enumerate(G):
        for i in range(n):
            for j in range(n):
                B[i, k * n + j] = -X[i, j]
    for i in range(n * (d - 1)):
        B[n + i, i] = arb(1)
    powers, scale = B.charpoly(), A.det()
    return [scale * powers[n * d - a] for a in range(n * d + 1)]


def _first_order(terms: Sequence[arb_mat], C: Sequence[arb_mat]) -> list[arb]:
    """Coefficients in P of tr(adj(A) C), A = Σ P^k terms[k]: what det(A + ε C) has of the first order in ε.

    It is det(A) tr(A⁻¹ C), where A⁻¹ C = Σ P^j S_j as a series; powers beyond those of a product of N rows, one of them
    of C, cancel.
    """
    A, *others = terms
    inverse, last = A.inv(), (A.nrows() - 1) * len(others) + len(C) - 1
    S: list[arb_mat] = []
    for j in range(last + 1):
        known = [A_k * S[j - k] for k, A_k in enumerate(others, 1) if k <= j]
        S.append(inverse * (sum((-X for X in known), C[j] if j < len(C) else 0 * A)))
    product = arb_poly(determinant(terms)) * arb_poly([X.trace() for X in S])
    return [product[a] for a in range(last + 1)]


def _through(places: Sequence[arb], rows: Sequence[Sequence[arb]]) -> list[arb_poly]:
    """Polynomials through the columns of some values."""
    return [arb_poly.interpolate(list(places), list(column)) for column in zip(*rows, strict=True)]


def _in_square(factors: Sequence[arb_poly], counts: Sequence[int], scale: arb) -> Bivariate:
    """From λ² to x = −λ², so many powers of each; those beyond cancel."""
    return Bivariate([
        arb_poly([(-1) ** b * scale * p[b] for b in range(count)]) for p, count in zip(factors, counts, strict=False)
    ])  # fmt: skip


def boundary(kernel: ModuleType, question: Question, bits: int) -> Boundary:
    """h and g of a question, in balls of so many bits. Raises Unproven."""
    own, limit = parameters(kernel, question.own), question.kappa is not None
    alpha, beta = (question.alpha, question.beta) if question.kappa is None else (Fraction(1), question.kappa)
    with precision(bits):
        M, C, K = coefficients(kernel, question.modes, own, (alpha, beta), limit)
        if limit and not C:
            raise Unproven(f"kappa: {kernel.COLUMN['name']} has no damping that could vanish")
        return expansion(M, C, K, limit)
