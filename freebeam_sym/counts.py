"""How many eigenvalues grow at a load: what every first loss of stability is confirmed by. Eqs. (24), (25)."""

from __future__ import annotations

import math

import numpy as np

from freebeam_sym.pencil import Complex, Damping, Pencil, Real

__all__ = ["growing", "unstable", "unstable_count"]

LIGHTEST_STATE = 1e-7
"""Damping ratio of mode 1 below which growth is counted to first order and not from the 2N eigenvalues."""


def unstable_count(pencil: Pencil, alpha: float, beta: float, load: float, kappa: float | None = None) -> int:
    """Elastic eigenvalues λ that grow at this load; where damping is too small for the 2N eigenvalues to show it,
    or zero in a limit, branches s_j that are not real and positive or whose growth to first order is positive."""
    return unstable(pencil, Damping.of(pencil.e, alpha, beta, kappa), load, kappa is not None)


def unstable(pencil: Pencil, damping: Damping, load: float, limit: bool) -> int:
    """The same of a `Damping`; limit: that it vanishes."""
    if damping.size / math.sqrt(pencil.e[0]) < LIGHTEST_STATE:
        s, V = np.linalg.eig(np.diag(pencil.e) + load * pencil.H)
        bad = int(((s.imag != 0) | (s.real <= 0)).sum())
        if bad == 0 and (damping.size > 0 or limit):
            growth = -np.einsum("jn,n,nj->j", np.linalg.inv(V), damping.shape, V)
            bad = int((growth > 0).sum())
        return bad
    try:
        A = _inverse_state(pencil, damping, load)
    except np.linalg.LinAlgError:  # K singular to the last digit: λ = 0
        return 1
    return int((np.linalg.eigvals(A).real > 1e-14 * np.linalg.norm(A)).sum())


def growing(pencil: Pencil, damping: Damping, load: float) -> tuple[float, Real | Complex]:
    """Frequency and motion, in the basis of the pencil, of what grows most at a load; frequency 0 where it does not
    swing."""
    if damping.size / math.sqrt(pencil.e[0]) < LIGHTEST_STATE:
        s, V = np.linalg.eig(np.diag(pencil.e) + load * pencil.H)
        growth = -np.einsum("jn,n,nj->j", np.linalg.inv(V), damping.shape, V).real
        worst = int(np.argmax(np.where((s.real <= 0) | (s.imag != 0), np.inf, growth)))
        return math.sqrt(max(0.0, float(s[worst].real))), V[:, worst]
    try:
        theta, W = np.linalg.eig(_inverse_state(pencil, damping, load))
    except np.linalg.LinAlgError:
        _, _, right = np.linalg.svd(np.eye(pencil.size) + load * pencil._relative)
        return 0.0, right[-1] / np.sqrt(pencil.e)
    worst = int(np.argmax(theta.real))
    return abs(float((math.sqrt(pencil.e[0]) / theta[worst]).imag)), W[: pencil.size, worst]


def _inverse_state(pencil: Pencil, damping: Damping, load: float) -> Real:
    """Inverse of the state matrix of Eq. (25), times ω₁, in the basis of the pencil, (2N, 2N). Its eigenvalues
    are ω₁/λ: those of the low modes, which decide, are not lost in the rounding of the fast ones, however strong
    the damping."""
    n, first = pencil.size, math.sqrt(pencil.e[0])
    inverse = np.linalg.inv(np.diag(pencil.e / pencil.e[0]) + (load / pencil.e[0]) * pencil.H)
    A = np.zeros((2 * n, 2 * n))
    A[:n, :n] = -inverse * (damping.size / first * damping.shape)
    A[:n, n:] = -inverse
    A[n:, :n] = np.eye(n)
    return A
