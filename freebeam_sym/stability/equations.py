"""Polynomials of matrices in the load, and the equations of a flutter, λ = iω, by Newton's method.

A polynomial is an array (k, n, n), its matrices by powers of the load P.
"""

from __future__ import annotations

import math

import numpy as np

from freebeam_sym.stability.problem import Complex, Real

__all__ = ["newton", "shifted", "slope", "value"]


def value(X: Real, P: float) -> Real:
    """A polynomial of matrices at a load."""
    total = X[-1]
    for A in X[-2::-1]:
        total = A + P * total
    return np.asarray(total)


def slope(X: Real) -> Real:
    """Derivative by the load, by powers of it."""
    return X[1:] * np.arange(1, len(X))[:, None, None] if len(X) > 1 else np.zeros_like(X)


def shifted(X: Real, P: float, unit: float = 1.0) -> Real:
    """By powers of p, where the load is P + unit·p."""
    X = X.copy()
    for low in range(len(X) - 1):
        for k in range(len(X) - 2, low - 1, -1):
            X[k] += P * X[k + 1]
    return np.asarray(X * float(unit) ** np.arange(len(X))[:, None, None])


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
        rows = np.abs(J[:, :m]).max(axis=1)
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
