"""The polynomials h and g, whose common zeros are the eigenvalues on the imaginary axis. Eqs. (10), (24), (25).

On λ = iω, with x = ω²,

    det(λ² M + λ C + K) / det M = h(P, x) + iω g(P, x).

Determinants are taken at real λ, as polynomials in P, and interpolated. In the limit of vanishing damping g is of the
first order in C, tr(adj(K − x M) C) / det M; beside rates G that stay, and where the damping acts on displacements by S
too, what tr(adj(λ² M + λ G + K)(λ C + S)) has of odd powers of λ. Without damping g stands for ∂h/∂x: h and g vanish
together where two frequencies meet. So it does of a gyroscopic column whose determinant is even in λ. Where coordinates
have no mass, det M is 0, and h and g are divided by another number; their degrees follow from that in λ
(`structure.py`).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from itertools import zip_longest
from types import ModuleType
from typing import Any

import numpy as np
from flint import arb, arb_mat, arb_poly

from freebeam_derive.certify.balls import (
    Exact,
    Unproven,
    ball_matrices,
    matrices_of_any,
    matrices_with_rates,
    parameters,
    precision,
)
from freebeam_derive.certify.balls import coefficients as coefficients_of
from freebeam_derive.certify.bivariate import Bivariate
from freebeam_derive.certify.one_load import zeros_twice
from freebeam_derive.certify.parts import Part, split
from freebeam_derive.certify.structure import Beside, Structure, held, null_space, of_balls, structure

LARGE = 24
"""Rows from which on elimination takes less time than FLINT's characteristic polynomial."""


@dataclass(frozen=True)
class Question:
    """What is to be certified. kappa: the limit of vanishing damping at β = κα (then alpha = beta = 0), math.inf where
    β alone vanishes and α is 0; else None."""

    modes: int
    alpha: Exact = Fraction(0)
    beta: Exact = Fraction(0)
    kappa: Exact | float | None = None
    own: Mapping[str, Fraction] | None = None

    @property
    def undamped(self) -> bool:
        return self.kappa is None and self.alpha == 0 == self.beta

    @property
    def dampings(self) -> tuple[Exact, Exact]:
        """α and β, or in the limit the direction in which they vanish."""
        if self.kappa is None:
            return self.alpha, self.beta
        return (Fraction(0), Fraction(1)) if isinstance(self.kappa, float) else (Fraction(1), self.kappa)


@dataclass(frozen=True)
class Boundary:
    """h and g, polynomials in P and x, of degree N and below in x; `damped` is False where g is ∂h/∂x.

    odd: g is of degree N too, for the determinant's degree in λ is odd. rests: how many motions rest at P = 0; tangent:
    g has the same tangents as h where these leave x = 0. none: the power of P that g was divided by. Where rests or
    none is not 0, what is said of the roots is said of P > 0. fast: polynomials in P by powers of μ, of whose roots
    eigenvalues λ = μ/ε come where damping ε C vanishes that acts on coordinates without mass; odd then too. part: what
    of the column it is of, see `parts`; from a frame that turns x is (ω + turn)², or ω + turn of what whirls. As a
    system of equations: h = g = 0 in the unknowns (P, x), or det K = h(P, 0) = 0 in the one unknown (P,).
    """

    N: int
    h: Bivariate
    g: Bivariate
    damped: bool
    odd: bool = False
    rests: int = 0
    none: int = 0
    tangent: bool = False
    fast: tuple[arb_poly, ...] = ()
    part: Part | None = None

    @cached_property
    def g_without_tangents(self) -> Bivariate:
        """g − c h, which is g at the roots of h; c such that it has no part of order `rests` in P and x together.

        With D = det(λ² M + λ C + K), P counted twice: where C does not act on the motions that rest, D is
        (1 + c λ) times a form of degree 2 rests in λ, and what is of higher order than that. Raises Unproven.
        """
        r, zero = self.rests, arb(0)
        if self.h.rows[0][r].contains(0):
            raise Unproven("a motion that rests without load is not known to have mass")
        less = self.g.combined(arb(1), self.h, -self.g.rows[0][r] / self.h.rows[0][r])
        return Bivariate([
            arb_poly([zero if a + b <= r else p[b] for b in range(p.degree() + 1)]) for a, p in enumerate(less.rows)
        ])  # fmt: skip

    @property
    def above_zero(self) -> bool:
        """Whether what is said of stability is not said of P = 0."""
        return self.rests > 0 or self.none > 0

    @cached_property
    def twice(self) -> list[arb]:
        """Loads at which two eigenvalues are known to be zero at once: h = h_P = g = 0 at x = 0, exactly."""
        return zeros_twice(self.part) if self.part and self.damped else []

    def leaves_as_pair(self, P: arb, x: arb) -> bool:
        """Whether these two leave zero as a conjugate pair, and det K is zero at no other load of a ball. x: about 0.

        With λ = μ (P − P*) the determinant is h_PP / 2 + g_P μ − h_x μ² to lowest order, times (P − P*)².
        """
        return bool(self.g.by_P(P, x) ** 2 + 2 * self.h.by_x(P, x) * self.h.by_P.by_P(P, x) < 0)

    @property
    def between(self) -> int:
        """How many roots g has where they interlace with those of h."""
        return self.N if self.odd else self.N - 1

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
        return replace(self, h=self.h.about(P, x), g=self.g.about(P, x))


def expansion(
    M: Sequence[arb_mat],
    C: Sequence[arb_mat],
    K: Sequence[arb_mat],
    vanishing: bool = False,
    known: Structure | None = None,
    beside: Beside | None = None,
) -> Boundary:
    """h and g of λ² M + λ C + K, each a polynomial in P, lists by its powers; regular at P = 0 for λ > 0.

    C: empty without damping; vanishing: only its direction counts. known: what holds exactly; without it M is regular
    and, without damping alone, odd powers of λ are none. Where C is nothing at P = 0, g is divided by the power of P
    that it holds: what is said of its roots is then said of P > 0. beside: as of a part. Raises Unproven.
    """
    n, known = M[0].nrows(), known or Structure(2 * M[0].nrows(), not C)
    G, S = _in_balls(beside.G if beside else []), _in_balls(beside.S if beside else [])
    N, damped = known.degree // 2, bool(C) and not (known.even and not vanishing)
    if N < 1:
        raise Unproven("no motion of it has a frequency: without mass there is none")
    regular = known.degree == 2 * n and not (C and known.even)
    scale, step = _sizes(M, () if vanishing or regular else C, K, 2 * N if vanishing else known.degree)
    odd: list[arb_poly] = []
    if damped and not vanishing:
        places = [step * k for k in range(1, known.degree + 2)]
        whole = _through(places, [determinant(_at(p, M, K, C)) for p in places])
        even, odd = ([arb_poly([p[j] for j in range(k, p.degree() + 1, 2)]) for p in whole] for k in (0, 1))
    else:
        still = [_at(step * k, M, K, G if vanishing else C) for k in range(1, N + 2)]
        places = [(step * k) ** 2 for k in range(1, N + 2)]
        even = _through(places, [determinant(terms) for terms in still])
        if damped:
            count = N + known.degree % 2
            if beside:
                each = [
                    [_first_order(_at(p, M, K, G), _at(p, [], S, C)) for p in (step * k, -step * k)]
                    for k in range(1, count + 1)
                ]
                rows = [
                    [(v - w) / (2 * step * k) for v, w in zip(*both, strict=True)] for k, both in enumerate(each, 1)
                ]
            else:
                rows = [_first_order(terms, C) for terms in still[:count]]
            odd = _through(places[:count], rows)
    of_C, of_K = max(len(C), len(G)) - 1, max(len(K), len(S)) - 1
    highest = [highest_power(a, n, len(M) - 1, of_C, of_K) for a in range(max(len(even), len(odd)))]
    degrees = [min(power, known.degree) for power in highest]
    h = _in_square(even, [d // 2 + 1 for d in degrees], scale, known, 0)
    if not damped:
        return Boundary(N, h, h.by_x, False, False, known.rests)
    none = next(
        k for k, Xs in enumerate(zip_longest(C, S)) if any(not v == 0 for X in Xs if X is not None for v in X.entries())
    )
    g = _in_square(odd, [(d + 1) // 2 for d in degrees], scale, known, 1)
    return Boundary(N, h, Bivariate(g.rows[none:]), True, bool(known.degree % 2), known.rests, none, known.tangent)


def _sizes(M: Sequence[arb_mat], C: Sequence[arb_mat], K: Sequence[arb_mat], degree: int) -> tuple[arb, arb]:
    """What h and g are multiplied by, and the distance of the places where determinants are taken. Raises Unproven."""
    whole = _at(arb(1), M, K, C)[0].det()
    if degree == 2 * M[0].nrows():
        scale = leading = 1 / M[0].det()
    else:  # some coordinate has no mass: about what the determinant is over λ^degree, far out
        far = arb(2) ** 30
        scale, leading = 1 / whole, far**degree / _at(far, M, K, C)[0].det()
    # An eighth of the mean frequency: of 1/8, 1 and 4 it lost the fewest bits (free-free and Beck, N = 8 and 20, light
    # and heavy damping).
    size = (whole * leading).log() / (degree * arb(2).log())
    if not size.is_finite():
        raise Unproven("mass and elastic stiffness are not known to be positive definite")
    return scale, arb(2) ** (round(float(size)) - 3)


def _at(p: arb, M: Sequence[arb_mat], K: Sequence[arb_mat], C: Sequence[arb_mat] = ()) -> list[arb_mat]:
    """p² M + p C + K by powers of P."""
    count = max(map(len, (M, K, C)))
    none = 0 * (M or C or K)[0]
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

    A_k = E X_k, X_k the rows in which a term beyond the first is not exactly nothing, E the columns of 1 that belong to
    them. The sum has the determinant det(A_0) det(1 + Σ P^k G_k), G_k = X_k A_0⁻¹ E: with
    B = [[−G_1, −G_2, …], [1, 0, …], …] det(A_0) det(1 − P B).
    """
    A, *others = terms
    rows = [i for i in range(A.nrows()) if any(not X[i, j] == 0 for X in others for j in range(A.nrows()))]
    n, d = len(rows), max(len(others), 1)
    try:
        inverse = A.inv()
    except ZeroDivisionError:
        raise Unproven("a matrix is not known to be regular") from None
    E = type(A)([[inverse[i, j] for j in rows] for i in range(A.nrows())])
    G = [type(A)([[X[i, j] for j in range(A.nrows())] for i in rows]) * E for X in others if rows]
    B = type(A)(n * d, n * d)
    for k, X in enumerate(G):
        for i in range(n):
            for j in range(n):
                B[i, k * n + j] = -X[i, j]
    for i in range(n * (d - 1)):
        B[n + i, i] = arb(1)
    powers, scale = characteristic(B), A.det()
    return [scale * powers[n * d - a] for a in range(n * d + 1)]


def characteristic(A: Any) -> Any:
    """The characteristic polynomial of a matrix of balls. Raises Unproven.

    Large real ones by elimination to Hessenberg's form, n³ operations, and not FLINT's n⁴: at n = 34 and 50 it took a
    third and a fifth of the time and left no fewer bits of the low coefficients.
    """
    n = A.nrows()
    if n < LARGE or not isinstance(A, arb_mat):
        return A.charpoly()
    H = np.array(A.tolist(), dtype=object)
    for k in range(n - 2):
        if all(v == 0 for v in H[k + 1 :, k]):
            continue
        pivot = max(range(k + 1, n), key=lambda i: (not H[i, k].contains(0), abs(H[i, k]).mid()))
        H[[k + 1, pivot]] = H[[pivot, k + 1]]
        H[:, [k + 1, pivot]] = H[:, [pivot, k + 1]]
        if H[k + 1, k].contains(0):
            raise Unproven("a matrix could not be eliminated")
        factors = H[k + 2 :, k] / H[k + 1, k]
        H[k + 2 :, k + 1 :] -= factors[:, None] * H[k + 1, k + 1 :]
        H[:, k + 1] += H[:, k + 2 :] @ factors
    found = [arb_poly([1])]  # of the leading minors; what is below the subdiagonal is eliminated
    for k in range(n):
        minor, product = arb_poly([-H[k, k], 1]) * found[k], arb(1)
        for i in range(k - 1, -1, -1):
            product = product * H[i + 1, i]
            minor -= product * H[i, k] * found[i]
        found.append(minor)
    return found[n]


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


def _in_square(factors: Sequence[arb_poly], counts: Sequence[int], scale: arb, known: Structure, odd: int) -> Bivariate:
    """From λ² to x = −λ², so many powers of each; those beyond cancel, and what is known to vanish does so exactly.
    odd: how many factors λ stand before."""
    zero = arb(0)
    return Bivariate([
        arb_poly([
            zero if known.vanishes(a, 2 * b + odd) else (-1) ** b * scale * p[b] for b in range(count)
        ])
        for a, (p, count) in enumerate(zip(factors, counts, strict=False))
    ])  # fmt: skip


MOST_FUNCTIONS = 100
"""Time grows as the fifth power of their number: 12 s at 50, of one core, and some ten minutes at 100."""


def functions_of(kernel: ModuleType, modes: int) -> int:
    """How many functions a question of a column has. Raises Unproven where they are too many for a proof."""
    general = kernel.COLUMN.get("general")
    count = int(kernel.basis(modes).size) - int(kernel.COLUMN["rigid"]) if general else modes
    if count > MOST_FUNCTIONS:
        raise Unproven(
            f"a proof of {count} functions takes more than ten minutes by far; up to {MOST_FUNCTIONS} are feasible: "
            f"give N = {modes * MOST_FUNCTIONS // count} or less"
        )
    return count


def boundary(kernel: ModuleType, question: Question, bits: int) -> Boundary:
    """h and g of a question, in balls of so many bits. Raises Unproven."""
    own, limit = parameters(kernel, question.own), question.kappa is not None
    with precision(bits):
        if kernel.COLUMN.get("general"):
            return _of_any(*matrices_of_any(kernel, question.modes, own, question.dampings, limit), limit)
        return expansion(*coefficients_of(kernel, question.modes, own, question.dampings, limit), limit)


def boundaries(
    kernel: ModuleType, question: Question, bits: int, rest: bool | None = None, top: Fraction = Fraction(0)
) -> list[Boundary]:
    """The same of each part that leaves the others alone, as `parts.split` gives them. Raises Unproven."""
    if not kernel.COLUMN.get("general"):
        return [boundary(kernel, question, bits)]
    with precision(bits):
        parts = _parts(kernel, question, rest, top)
        limit = question.kappa is not None
        if limit and not any(p.damped(limit) for p in parts):
            raise Unproven("kappa: there is no damping that could vanish")
        words = [f"of {' and '.join(p.names)} " for p in parts]
        found = [
            replace(_of_part(p, limit and p.damped(limit), of), part=p) for p, of in zip(parts, words, strict=True)
        ]
    if any(of.rests for of, p in zip(found, parts, strict=True) if p.turn):
        raise Unproven("a frequency in a frame that turns is its rate, without load")
    return found


def from_rest(kernel: ModuleType, question: Question) -> bool:
    """Whether some part is seen from rest. Raises Unproven."""
    parts = _parts(kernel, question, True) if kernel.COLUMN.get("general") else []
    return any(part.turn and not part.whirls for part in parts)


def _parts(kernel: ModuleType, question: Question, rest: bool | None, top: Fraction = Fraction(0)) -> list[Part]:
    limit = question.kappa is not None
    own = parameters(kernel, question.own)
    M, C, K, names, letters, beside = matrices_with_rates(kernel, question.modes, own, question.dampings, limit)
    return split(M, C, K, names, letters, limit, rest, beside, top)


def _of_part(part: Part, limit: bool, of: str) -> Boundary:
    """h and g of a part; limit: of vanishing damping that acts on it. Raises Unproven."""
    beside = part.beside
    if not beside:
        return _of_any(part.M, part.C, part.K, limit, part.known, of)
    if not limit:
        even = replace(structure(part.M, beside.G, part.K), even=True)
        return _of_any(part.M, beside.G, part.K, False, even, of)
    if not any(held(X).any() for X in part.C):
        raise Unproven(f"the damping {of}that vanishes acts on displacements alone, and damps nothing to first order")
    known = (of_balls if part.letters else structure)(part.M, [], part.K)
    if known.degree != 2 * len(part.M[0]) or known.rests:
        what = "rests without load" if known.rests else "has no mass"
        raise Unproven(f"a motion {of}{what}, beside rates that stay or a vanishing damping on displacements")
    known = replace(known, even=False)
    return expansion(*ball_matrices(part.M, part.C, part.K), True, known, beside)


def _in_balls(terms: list[Any]) -> list[arb_mat]:
    return [arb_mat([[arb(v) for v in row] for row in X.tolist()]) for X in terms]


def _of_any(
    M: list[Any], C: list[Any], K: list[Any], limit: bool, exactly: Structure | None = None, of: str = ""
) -> Boundary:
    """h and g of matrices of fractions or balls; exactly: what is known of these; of: which they are, in words. Raises
    Unproven."""
    known, fast = (exactly, 0) if exactly else _structure((M, C, K), limit)
    of_M, of_C, of_K = ball_matrices(M, C, K)
    found = expansion(of_M, of_C, of_K, limit, known)
    if not known.rests and found.h.rows[0][0].contains(0) and any(isinstance(v, arb) for v in K[0].flat):
        raise Unproven(
            f"without load a motion {of}rests, as far as balls tell, and that is known exactly of motions of fractions "
            "alone; where a factor such as exp(-1) ties a coordinate, take the product of the two for the coordinate"
        )
    return replace(found, fast=_fast(M, C, K, fast)) if fast else found


def _structure(terms: tuple[list[Any], list[Any], list[Any]], limit: bool) -> tuple[Structure, int]:
    """What holds exactly of matrices, and how many eigenvalues go to infinity in a limit of vanishing damping, which
    make g of as high a degree as h. Raises Unproven."""
    balls = any(isinstance(v, arb) for powers in terms for X in powers for v in X.flat)
    of = of_balls if balls else structure
    known = of(*terms)
    if not limit:
        return known, 0
    M, _, K = terms
    still = of(M, [], K).degree
    fast = known.degree - still
    if fast and balls:
        raise Unproven("damping that vanishes acts on a coordinate without mass, beside a factor that is no fraction")
    if fast and still != 2 * (len(M[0]) - null_space(M[0]).shape[1]):
        raise Unproven("damping that vanishes acts on a coordinate that has neither mass nor stiffness")
    return replace(known, even=False, degree=still + min(fast, 1)), fast


def _fast(M: list[Any], C: list[Any], K: list[Any], degree: int) -> tuple[arb_poly, ...]:
    """det(μ C + K) of coordinates without mass, polynomials in P by powers of μ up to a degree, in balls.

    ε^2m det((μ/ε)² M + μ C + K), with M of rank m, is that times μ^2m and a constant for ε → 0. Raises Unproven.
    """
    right, left = null_space(M[0]), null_space(M[0].T).T
    if any((Y != 0).any() for X in M[1:] for Y in (left @ X, X @ right)):
        raise Unproven("damping that vanishes acts on a coordinate whose mass comes with the load")
    of_C, of_K = ([arb_mat([[arb(v) for v in row] for row in (left @ X @ right).tolist()]) for X in Y] for Y in (C, K))
    places = [arb(k) for k in range(1, degree + 2)]
    none = 0 * of_K[0]
    whole = [
        determinant([mu * a + b for a, b in zip_longest(of_C, of_K, fillvalue=none)]) for mu in places
    ]  # fmt: skip
    in_mu = _through(places, whole)
    return tuple(arb_poly([p[j] for p in in_mu]) for j in range(degree + 1))
