"""First losses of stability against dense eigenvalues and roots at 200 bits, over random questions.

`python -m tests.reference.dense COUNT SEED` asks so many and prints each disagreement; the tests ask some. Nothing here
is the program's but the column's exact matrices, which have tests of their own.
"""

from __future__ import annotations

import math
import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction

import numpy as np
from flint import arb, arb_mat

import freebeam as fb
from freebeam_derive.certify import balls

BITS = 200
COLUMNS = ("free-free", "beck", "beck", "euler-pinned")


@dataclass(frozen=True)
class Case:
    name: str
    basis: str
    modes: int
    own: dict[str, float]
    alpha: float
    beta: float
    kappa: float | None
    load_max: float = 1000.0


def cases(count: int, seed: int, most: int = 40) -> Iterator[Case]:
    """Random questions over every column, both bases and all damping, many next to the touch at η = 1/2."""
    rng = np.random.default_rng(seed)
    for _ in range(count):
        name, basis = rng.choice(COLUMNS), rng.choice(["modes", "legendre"])
        where = rng.random()
        if where < 0.5:
            eta = rng.uniform(-1, 2)
        elif where < 0.9:
            eta = 0.5 + rng.choice([-1, 1]) * 10 ** rng.uniform(-12, -3)
        else:
            eta = rng.choice([-1, 0, 0.3, 0.45, 0.5, 0.55, 1, 2])
        alpha, beta, kappa, kind = 10 ** rng.uniform(-14, 3), 10 ** rng.uniform(-12, 5), None, rng.random()
        if kind < 0.15:
            alpha = 0.0
        elif kind < 0.3:
            beta = 0.0
        elif kind < 0.5:
            alpha = beta = 0.0
            kappa = None if kind < 0.4 else float(rng.choice([0.0, math.inf, 10 ** rng.uniform(-3, 4)]))
        own = {"eta": float(eta)} if name == "beck" else {}
        yield Case(str(name), str(basis), int(rng.integers(1, most + 1)), own, float(alpha), float(beta), kappa)


def matrices(case: Case) -> tuple[arb_mat, ...]:
    """M, E, H with an error of 200 bits, of the parameters' binary values."""
    kernel = fb.column(case.name, case.basis).kernel
    with balls.precision(BITS):
        return balls.matrices(kernel, case.modes, {name: Fraction(value) for name, value in case.own.items()})


def middle(matrix: arb_mat) -> arb_mat:
    return arb_mat(matrix.nrows(), matrix.ncols(), [x.mid() for x in matrix.entries()])


def root(case: Case, found: fb.CriticalLoad) -> float:
    """The load of the boundary equations near what was found, by Newton's method at 200 bits. With v = a + iωb,

        A a − ω² C b = 0,   A b + C a = 0,   A = E − ω² M + P H,   a and b normed at one place

    hold on the boundary; in a limit of vanishing damping without the term ω² C b. Divergence: A a = 0 with ω = 0."""
    n, k = case.modes, int(np.abs(found.mode).argmax())
    limit = case.alpha == case.beta == 0
    with balls.precision(BITS):
        M, E, H = (middle(x) for x in matrices(case))
        if limit:
            C = M if case.kappa is None or math.isinf(case.kappa) else E + M * arb(case.kappa)
        else:
            C = E * arb(case.alpha) + M * arb(case.beta)
        C = C * (1 / arb(float(abs(C[0, 0]).mid()))) if limit else C
        a = [arb(float(x)) for x in (found.mode / found.mode[k]).real]
        P, w = arb(found.load), arb(found.frequency**2)
        flutter = found.kind == "flutter"
        if flutter and not limit and found.frequency:
            b = [arb(float(x)) for x in (found.mode / found.mode[k]).imag / found.frequency]
        elif flutter:  # what A b = −C a leaves, where the equation of the greatest entry is left out
            A = E - M * w + H * P
            rows = [i for i in range(n) if i != k]
            right = -(C * arb_mat(n, 1, a))
            inner = arb_mat([[A[i, j] for j in rows] for i in rows])
            some = inner.solve(arb_mat([[right[i, 0]] for i in rows]))
            b = [arb(0)] * n
            for place, i in enumerate(rows):
                b[i] = some[place, 0].mid()
        for _ in range(12):
            A = E - M * w + H * P
            size = 2 * n + 2 if flutter else n + 1
            J, r = arb_mat(size, size), arb_mat(size, 1)
            first = A * arb_mat(n, 1, a)
            if flutter:
                Cb, Ab, Ca = C * arb_mat(n, 1, b), A * arb_mat(n, 1, b), C * arb_mat(n, 1, a)
                Ma, Mb, Ha, Hb = (X * arb_mat(n, 1, y) for X, y in ((M, a), (M, b), (H, a), (H, b)))
                turn = arb(0 if limit else 1)
                for i in range(n):
                    for j in range(n):
                        J[i, j] = J[n + i, n + j] = A[i, j]
                        J[i, n + j], J[n + i, j] = -turn * w * C[i, j], C[i, j]
                    J[i, 2 * n], J[n + i, 2 * n] = Ha[i, 0], Hb[i, 0]
                    J[i, 2 * n + 1], J[n + i, 2 * n + 1] = -Ma[i, 0] - turn * Cb[i, 0], -Mb[i, 0]
                    r[i, 0], r[n + i, 0] = first[i, 0] - turn * w * Cb[i, 0], Ab[i, 0] + Ca[i, 0]
                J[2 * n, k], J[2 * n + 1, n + k] = arb(1), arb(1)
            else:
                Ha = H * arb_mat(n, 1, a)
                for i in range(n):
                    for j in range(n):
                        J[i, j] = A[i, j]
                    J[i, n], r[i, 0] = Ha[i, 0], first[i, 0]
                J[n, k] = arb(1)
            step = middle(middle(J).solve(middle(r)))
            a = [(x - step[i, 0]).mid() for i, x in enumerate(a)]
            P = (P - step[2 * n if flutter else n, 0]).mid()
            if flutter:
                b = [(x - step[n + i, 0]).mid() for i, x in enumerate(b)]
                w = (w - step[2 * n + 1, 0]).mid()
            if abs(float(step[2 * n if flutter else n, 0])) < 1e-25 * abs(float(P)):
                break
        return float(P)


def growing(case: Case, loads: np.ndarray) -> np.ndarray:
    """At which loads an eigenvalue grows, beyond rounding: of the state matrix's inverse, so that low modes keep their
    digits; to first order in the damping where it is too light for those to show it."""
    M, E, H = (np.array([[float(x) for x in row] for row in m.tolist()]) for m in matrices(case))
    d = 1 / np.sqrt(np.diag(E))
    M, E, H = (X * np.outer(d, d) for X in (M, E, H))  # now E's diagonal is 1
    n, first = len(M), 1 / math.sqrt(np.linalg.eigvals(np.linalg.solve(E, M)).real.max())
    out = np.zeros(len(loads), dtype=bool)
    light = (case.alpha * first + case.beta / first) < 1e-6
    for at, P in enumerate(loads):
        K = E + P * H
        if not light:
            C = case.alpha * E + case.beta * M
            back = np.hstack([-np.linalg.solve(K, C) * first, -np.linalg.solve(K, M) * first**2])
            theta = np.linalg.eigvals(np.vstack([back, np.eye(n, 2 * n)]))  # first/λ
            out[at] = (theta.real > 1e-11 * np.abs(theta).max()).any()
            continue
        t, V = np.linalg.eig(np.linalg.solve(K, M))  # 1/s
        big = np.abs(t) > 1e-7 * np.abs(t).max()
        t = t[big]
        if (np.abs(t.imag) > 1e-6 * np.abs(t)).any() or (t.real < 0).any():
            out[at] = True
        elif case.alpha or case.beta or case.kappa is not None:
            s = 1 / t.real
            v, u = V[:, big], np.linalg.inv(V)[big]
            rise = (u @ np.linalg.solve(K, H) @ v).diagonal().real * s  # s′, as 1/s is an eigenvalue of K⁻¹ M
            c_E, c_M = (case.alpha, case.beta) if case.kappa is None else (1, case.kappa)
            c_E, c_M = (0, 1) if case.kappa is not None and math.isinf(case.kappa) else (c_E, c_M)
            power = c_E * (P * rise - s) - c_M  # twice the growth, to first order
            out[at] = (power > 1e-9 * (c_E * s + c_M)).any()
    return out


def answer(case: Case) -> fb.CriticalLoad:
    column = fb.column(case.name, case.basis)
    return fb.critical_load(
        column, case.modes, case.alpha, case.beta, load_max=case.load_max, kappa=case.kappa, **case.own
    )


def disagreement(case: Case, found: fb.CriticalLoad) -> tuple[str, float] | None:
    """Why an answer is not that of the reference, and by how much; None where it is."""
    top = case.load_max if found.load is None else found.load
    touches = [touch.load for touch in found.touches]
    parts = np.append(np.linspace(0.03, 0.96, 24), [0.99, 0.998])
    below = np.array([x for x in parts * top if all(abs(x / touch - 1) > 2e-3 for touch in touches)])
    grows = growing(case, below)
    if grows.any():
        return "grows below", float(below[grows.argmax()])
    if found.load is None:
        return None
    true = root(case, found)
    off = abs(found.load / true - 1)
    return None if off < 1e-8 else ("load off", off)


if __name__ == "__main__":
    count, seed = int(sys.argv[1]), int(sys.argv[2])
    worst, bad, begin = 0.0, 0, time.perf_counter()
    for number, one in enumerate(cases(count, seed)):
        start = time.perf_counter()
        why = disagreement(one, answer(one))
        worst = max(worst, time.perf_counter() - start)
        if why is not None:
            bad += 1
            print(number, one, *why, flush=True)
    print(f"{count} questions, {bad} disagreements, {time.perf_counter() - begin:.0f} s")
