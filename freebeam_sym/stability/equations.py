"""Polynomials of matrices in the load, and what ends stability near a guess: divergences, λ = 0, and flutters, λ = iω.

A polynomial is an array (k, n, n), its matrices by powers of the load P.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from freebeam_sym.stability.problem import CLOSE, Complex, Crossing, Event, Real

__all__ = ["divergence", "divergences", "moved", "newton", "shifted", "slope", "value"]

Matrix = NDArray[Any]
Motion = Callable[[Real, float], Complex]
"""What makes a motion in the column's coordinates of one in those of K, and its load."""
SINGULAR = 1e-14
"""Least singular value of K, relative to the norms of its terms, up to which it is singular but for rounding: matrices
are known to 2e-15 of their norms."""
ROUNDING = 1e-15
"""Of the matrices' entries, relative to the matrices' norms."""


def value(X: Real, P: float) -> Real:
    """A polynomial of matrices at a load."""
    total = X[-1]
    for A in X[-2::-1]:
        total = A + P * total
    return np.asarray(total)


def slope(X: Real) -> Real:
    """Derivative by the load, by powers of it."""
    return np.asarray(X[1:] * np.arange(1, len(X))[:, None, None]) if len(X) > 1 else np.zeros_like(X)


def shifted(X: Real, P: float, unit: float = 1.0) -> Real:
    """By powers of p, where the load is P + unit·p."""
    X = X.copy()
    for low in range(len(X) - 1):
        for k in range(len(X) - 2, low - 1, -1):
            X[k] += P * X[k + 1]
    return np.asarray(X * float(unit) ** np.arange(len(X))[:, None, None])


def divergences(P: NDArray[Any], K: Real, vector: Motion) -> tuple[Event, ...]:
    """Events where det K(P) = 0 of candidates for P, ascending, up to the first simple root, at which stability is lost
    if it was not before. Two roots are one event where K between them is singular but for rounding, real roots or not:
    a touch of λ = 0."""
    found: list[Event] = []
    while len(P):
        if len(P) > 1 and P[1].real < P[0].real * (1 + CLOSE):
            touch, least = divergence(float(P[:2].real.mean()), K, vector)
            if least <= SINGULAR:
                found.append(Event(touch, False))
                P = P[2:]
                continue
        if P[0].imag == 0:
            crossing, least = divergence(float(P[0].real), K, vector, steps=3)
            if least <= 100 * SINGULAR:
                found.append(Event(crossing, True))
                break
        P = P[1:]
    return tuple(found)


def divergence(load: float, K: Real, vector: Motion, steps: int = 1) -> tuple[Crossing, float]:
    """The crossing at ω = 0 near a load, and how singular K was there; with steps of Newton's method."""
    norms = [float(np.linalg.norm(X, 2)) for X in K]
    for _ in range(steps):
        A = value(K, load)
        left, sizes, right = np.linalg.svd(A)
        u, v = left[:, -1], right[-1]
        least = float(sizes[-1]) / sum(load**k * norm for k, norm in enumerate(norms))
        rate, residual = float(u @ value(slope(K), load) @ v), float(u @ A @ v)
        if abs(residual) < CLOSE * abs(rate * load):
            load -= residual / rate
        if least <= SINGULAR / 10:
            break
    return Crossing(load, 0.0, vector(v, load), "divergence"), least


def newton(
    M: Real, D: Real, K: Real, size: float, w: float, P: float, a: Real, b: Real, unit: float
) -> tuple[float, float, Complex] | None:
    """ω, P and v of the flutter near (ω² = w, P, v = a + iω·size·b), to rounding; None where the iteration does not
    settle, ω = −1 where ω² < 0. C = size · D; unit: ω² beside which a lesser one is judged.

    With G = K − wM the equation (G + iωC) v = 0 reads

        G a − w size² D b = 0,    G b + D a = 0,    c·a = 1,  c·b = 0

    real, polynomial, and regular down to size = 0, where it is the limit of vanishing damping: uᵀ D a = 0 with u the
    left null vector of G (D = M: two frequencies meet; of C = αE and K = E + P H the tangent rule P s′ = s, s = ω²).
    """
    n, share, tiny = len(a), size**2, 1e-7 * unit
    m, slopes = 2 * n, [slope(X) for X in (M, D, K)]
    c = a / (a @ a)
    x, J = np.concatenate([a, b - (c @ b) * a]), np.zeros((m + 2, m + 2))
    before, astray = math.nan, 0  # one step alone says nothing of the next
    for _ in range(25):
        a, b = x[:n], x[n:]
        A, C, G = value(M, P), value(D, P), value(K, P) - w * value(M, P)
        dA, dC, dK = (value(X, P) for X in slopes)
        dG = dK - w * dA
        J[:n, :n] = J[n:m, n:m] = G
        J[:n, n:m], J[n:m, :n] = -share * w * C, C
        J[:n, m], J[n:m, m] = -(A @ a) - share * (C @ b), -(A @ b)
        J[:n, m + 1], J[n:m, m + 1] = dG @ a - share * w * (dC @ b), dG @ b + dC @ a
        J[m, :n] = J[m + 1, n:m] = c
        r = J[:, :m] @ x
        r[m] -= 1
        rows = np.abs(J[:, :m]).max(axis=1).clip(1e-300)  # a motion left to itself may be met exactly
        try:
            change = np.linalg.solve(J / rows[:, None], r / rows)
        except np.linalg.LinAlgError:
            return None
        x, w, P = x - change[:m], w - float(change[m]), P - float(change[m + 1])
        astray = 0 if w > -tiny and P > 0 else astray + 1
        # where ω goes to zero its square is judged beside the unit
        step = abs(change[m]) / (abs(w) + tiny) + abs(change[m + 1] / P) if P else math.inf
        if astray > 3 or not step < 1e6:
            return None
        # rounding reached: the next step, by the law of the last two, would be below it, or steps no longer shrink
        if step < 1e-9 and (not step or step * (step / before) ** 2 < 1e-16 or step > before / 4):
            omega = 0.0 if abs(w) <= 1e-13 * unit else math.sqrt(w) if w > 0 else -1.0
            return (omega, P, x[:n] + 1j * omega * size * x[n:]) if P > 0 else None
        before = step
    return None


def moved(
    G: Matrix, G_P: Matrix, G_omega: Matrix | None, change: Real | float, meet: float = 0.0, rates: Real | None = None
) -> float:
    """By how much a load at which G = K + iωC − ω²M is singular moves, to first order, for a real change g of G: at
    most for one of this norm, as a rule for one of entries of these sizes, (n, n). With the null vectors u and v,
    uᴴ(g + G_P dP + G_ω dω)v = 0 in both parts. Where frequencies meet without damping uᴴG_ωv = 0, up to a share `meet`
    of its terms, and of a divergence ω stays 0: G_omega None, and one part is left. rates: sizes of changes of ωC. With
    these G v is rounded as by `newton`, in both parts of v = a + iωb: they are apart where v is nearly real alone."""
    left, sizes, right = np.linalg.svd(G)
    u, v = left[:, -1].conj(), right[-1].conj()
    v = v * np.exp(-0.5j * np.angle(v @ v))
    a, off = u @ G_P @ v, change * np.outer(u, v)
    if G_omega is not None and abs(b := u @ G_omega @ v) >= meet * (np.abs(u) @ np.abs(G_omega) @ np.abs(v)):
        a, u = (a * b.conj()).imag, b.conj() * u
        off = change * np.outer(u, v).imag
        if rates is not None:
            if abs(v @ v) < 0.9 or sizes[:-1].min(initial=1.0) < CLOSE:  # of two motions any whirl is one too
                u, v = np.abs(u) * (1 + 1j), np.abs(v) * (1 + 1j)
            real, imag = (change * np.abs(x) + rates * np.abs(y) for x, y in ((v.real, v.imag), (v.imag, v.real)))
            off = np.hypot(u.imag[:, None] * real, u.real[:, None] * imag)
    return float(np.linalg.norm(off) / abs(a)) if a else math.inf
