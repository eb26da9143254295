"""A million steps, eight modes, one sensor, of Newmark's and of the exact method: ours against what a user would run.

Light damping (α = 1e-7, β = 1e-3), so that nothing dies away before the end. The accuracy is against the recurrence in
extended precision, with the step's matrix from 40 digits: largest difference over all steps, relative to the largest
response. Everybody computes the displacement alone; setup is part of the time, except compiling.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any

import mpmath as mp
import numpy as np
import pytest
from numba import njit
from scipy.integrate import solve_ivp
from scipy.signal import cont2discrete, dlsim

import freebeam as fb

STEPS, STEP, SENSOR, RATE = 1_000_000, 0.01, 0.1, 3.0
CLAIMS = {
    "any": "a million Newmark steps under any force history, N = 8, one sensor",
    "free": "a million free Newmark steps, N = 8, one sensor",
    "harmonic": "a million Newmark steps under a harmonic force, N = 8, one sensor",
}
BOUNDS = {"any": 12e-9 * STEPS, "free": 2e-9 * STEPS, "harmonic": 2e-9 * STEPS}
SYSTEM = fb.column("free-free").system(8, load=50.0, alpha=1e-7, beta=1e-3)
SHAPE = SYSTEM.shapes(np.array([SENSOR]))[:, 0]
START = np.concatenate([[0.01], np.zeros(15)])


@cache
def history(kind: str) -> Any:
    """The force after every step, and the state at first."""
    if kind == "any":
        return np.random.default_rng(0).normal(size=STEPS + 1), np.zeros(16)
    if kind == "free":
        return np.zeros(STEPS + 1), START
    return np.sin(RATE * STEP * np.arange(STEPS + 1)), np.zeros(16)


def generator() -> tuple[Any, Any]:
    n = len(SYSTEM.M)
    A, B = np.zeros((2 * n, 2 * n)), np.zeros((2 * n, 1))
    A[:n, n:] = np.eye(n)
    A[n:] = np.linalg.solve(SYSTEM.M, -np.hstack([SYSTEM.K, SYSTEM.C]))
    B[n:, 0] = np.linalg.solve(SYSTEM.M, SYSTEM.Q(1.0))
    return A, B


def trapezoidal() -> tuple[Any, Any]:
    """The matrix of a step, and what the force after it adds, in floats."""
    A, B = generator()
    left = np.linalg.inv(np.eye(16) - STEP / 2 * A)
    return left @ (np.eye(16) + STEP / 2 * A), STEP / 2 * left @ B[:, 0]


@cache
def reference(kind: str, method: str = "newmark") -> Any:
    """The recurrence in long doubles. Average acceleration is the trapezoidal rule, (1 − hG/2) x⁺ = (1 + hG/2) x + …;
    the exact step is the exponential of h [G, B, 0; 0, 0, 1/h; 0, 0, 0] or, under a wave, of h [G, B; 0, S]."""
    with mp.workdps(40):
        M, C, K = (mp.matrix(np.asarray(part).tolist()) for part in (SYSTEM.M, SYSTEM.C, SYSTEM.K))
        inverse, h = M**-1, mp.mpf(STEP)
        G, B = mp.zeros(16), mp.zeros(16, 1)
        G[:8, 8:], G[8:, :8], G[8:, 8:] = mp.eye(8), -inverse * K, -inverse * C
        B[8:, 0] = inverse * mp.matrix(SYSTEM.Q(1.0).tolist())
        theta = mp.mpf(RATE) * h
        turn = mp.matrix([[mp.cos(theta), -mp.sin(theta)], [mp.sin(theta), mp.cos(theta)]])
        if method == "exact":
            whole = mp.zeros(18)
            whole[:16, :16], whole[:16, 16] = h * G, h * B
            if kind == "harmonic":
                whole[16, 17], whole[17, 16] = -theta, theta
            else:
                whole[16, 17] = 1
            whole = mp.expm(whole, method="taylor")
            A, drive = whole[:16, :16], whole[:16, 16:]
            if kind != "harmonic":  # of F and of what it grows by
                drive = drive * mp.matrix([[1, 0], [-1, 1]])
        else:
            left = (mp.eye(16) - h / 2 * G) ** -1
            A, drive = left * (mp.eye(16) + h / 2 * G), left * B * (h / 2) * mp.matrix([[1, 1]])
            if kind == "harmonic":
                drive = drive[:, 0] * mp.matrix([[1, 0]]) + drive[:, 1] * turn[0, :]
        A, drive, turns = extended(A), extended(drive), extended(turn)
    force, x = history(kind)
    force, x, row = force.astype(np.longdouble), x.astype(np.longdouble), SHAPE.astype(np.longdouble)
    pairs = np.stack([force[:-1], force[1:]], axis=1)
    if kind == "harmonic":  # sin(3 t) itself, and not of rounded times: the real part of −i e^(3it)
        wave = np.array([0, -1], dtype=np.longdouble)
        for k in range(STEPS):
            pairs[k] = wave
            wave = turns @ wave
    y = np.empty(STEPS + 1, dtype=np.longdouble)
    y[0] = row @ x[:8]
    for k, push in enumerate(pairs @ drive.T):
        x = A @ x + push
        y[k + 1] = row @ x[:8]
    return y


def extended(matrix: Any) -> Any:
    high = np.array(matrix.tolist(), dtype=float)
    low = np.array((matrix - mp.matrix(high.tolist())).tolist(), dtype=float)
    return high.astype(np.longdouble) + low


def error(kind: str, steps: int = STEPS, method: str = "newmark") -> Callable[[Any], str]:
    def off(y: Any) -> str:
        exact = reference(kind, method)[: steps + 1]
        return f"{float(np.abs(np.asarray(y).ravel()[: steps + 1] - exact).max() / np.abs(exact).max()):.0e}"

    return off


def excitation_of(kind: str) -> dict[str, Any]:
    if kind == "free":
        return {"initial": START[:8]}
    return {"force": history(kind)[0] if kind == "any" else fb.Harmonic(1.0, RATE), "force_position": 1}


@pytest.mark.parametrize("method", ["newmark", "exact"])
@pytest.mark.parametrize("kind", CLAIMS)
def bench_ours(contender: Any, kind: str, method: str) -> None:
    options = {**excitation_of(kind), "sensors": [SENSOR], "method": method}
    y = contender(
        CLAIMS[kind],
        "ours" if method == "newmark" else "ours, the exact method",
        lambda: fb.respond(SYSTEM, STEPS * STEP, STEP, outputs=("y",), **options).y,
        error=error(kind, method=method),
        bound=BOUNDS[kind],
    )
    assert float(error(kind, method=method)(y)) < 1e-12


@pytest.mark.parametrize("kind", CLAIMS)
def bench_ours_all_outputs(contender: Any, kind: str) -> None:
    options = {**excitation_of(kind), "sensors": [SENSOR], "method": "newmark"}
    contender(
        CLAIMS[kind],
        "ours, displacement, velocity and acceleration",
        lambda: fb.respond(SYSTEM, STEPS * STEP, STEP, **options).y,
        error=error(kind),
    )


def bench_textbook(contender: Any) -> None:
    """Predictor, solution with the inverse at hand, corrector; a loop in Python."""
    M, C, K, h = SYSTEM.M, SYSTEM.C, SYSTEM.K, STEP
    force, _ = history("any")
    Q = SYSTEM.Q(1.0)

    def loop() -> Any:
        inverse = np.linalg.inv(M + h / 2 * C + h * h / 4 * K)
        q, dq, ddq = np.zeros(8), np.zeros(8), np.linalg.solve(M, Q * force[0])
        y = np.empty(STEPS + 1)
        y[0] = 0
        for k in range(STEPS):
            q_star, dq_star = q + h * dq + h * h / 4 * ddq, dq + h / 2 * ddq
            ddq = inverse @ (Q * force[k + 1] - C @ dq_star - K @ q_star)
            q, dq = q_star + h * h / 4 * ddq, dq_star + h / 2 * ddq
            y[k + 1] = SHAPE @ q
        return y

    contender(CLAIMS["any"], "textbook loop in NumPy", loop, error=error("any"), rounds=1)


def bench_dlsim(contender: Any) -> None:
    force, _ = history("any")

    def run() -> Any:
        A, B = generator()
        system = cont2discrete((A, B, np.concatenate([SHAPE, np.zeros(8)])[None], [[0.0]]), STEP, "bilinear")
        # at rest: x̂ = (1 − hG/2) x − h/2 B F is the state of this transform
        return dlsim(system, force, x0=-STEP / 2 * B[:, 0] * force[0])[1]

    contender(CLAIMS["any"], "scipy.signal.dlsim of the bilinear transform", run, error=error("any"), rounds=1)


def bench_lsoda(contender: Any, benchmark: Any) -> None:
    """The differential equation itself to 1e-6, at the first 10,000 times: off by Newmark's period error, mostly."""
    A, _ = generator()
    part = 10_000

    def run() -> Any:
        times = STEP * np.arange(part + 1)
        span = (0.0, times[-1])
        found = solve_ivp(lambda _, x: A @ x, span, START, method="LSODA", t_eval=times, rtol=1e-6, atol=1e-9)
        return SHAPE @ found.y[:8]

    name = f"scipy solve_ivp, LSODA, 1e-6 ({part:,} steps, times {STEPS // part})"
    contender(CLAIMS["free"], name, run, error=error("free", part), rounds=1)
    benchmark.extra_info["seconds"] = benchmark.stats.stats.min * STEPS / part


@njit
def compiled(inverse: Any, C: Any, K: Any, Q: Any, force: Any, h: float, shape: Any, start: Any, ddq: Any) -> Any:
    n = len(Q)
    q, dq = start[:n].copy(), start[n:].copy()
    y, right = np.empty(len(force)), np.empty(n)
    y[0] = shape @ q
    for k in range(len(force) - 1):
        for i in range(n):
            q[i] += h * dq[i] + h * h / 4 * ddq[i]
            dq[i] += h / 2 * ddq[i]
        for i in range(n):
            total = Q[i] * force[k + 1]
            for j in range(n):
                total -= C[i, j] * dq[j] + K[i, j] * q[j]
            right[i] = total
        value = 0.0
        for i in range(n):
            total = 0.0
            for j in range(n):
                total += inverse[i, j] * right[j]
            ddq[i] = total
            dq[i] += h / 2 * total
            q[i] += h * h / 4 * total
            value += shape[i] * q[i]
        y[k + 1] = value
    return y


@pytest.mark.parametrize("kind", ["any", "free"])
def bench_numba_loop(contender: Any, kind: str) -> None:
    force, start = history(kind)
    M, C, K = SYSTEM.M, SYSTEM.C, SYSTEM.K

    def run(force: Any = force) -> Any:
        inverse = np.linalg.inv(M + STEP / 2 * C + STEP**2 / 4 * K)
        Q = SYSTEM.Q(1.0)
        ddq = np.linalg.solve(M, Q * force[0] - C @ start[8:] - K @ start[:8])
        return compiled(inverse, C, K, Q, force, STEP, SHAPE, start, ddq)

    run(force[:3])
    contender(CLAIMS[kind], "numba-compiled loop", run, error=error(kind))


@njit(fastmath=True)
def compiled_modes(roots: Any, drive: Any, force: Any, row: Any, w: Any, direct: float) -> Any:
    y, a, b = np.empty(len(force)), w.real.copy(), w.imag.copy()
    c, d, e, f = roots.real.copy(), roots.imag.copy(), drive.real.copy(), drive.imag.copy()
    g, h = row.real.copy(), row.imag.copy()
    for k in range(len(force)):
        push, value = force[k], direct * force[k]
        for j in range(len(a)):
            value += g[j] * a[j] - h[j] * b[j]
            a[j], b[j] = c[j] * a[j] - d[j] * b[j] + e[j] * push, c[j] * b[j] + d[j] * a[j] + f[j] * push
        y[k] = value
    return y


@pytest.mark.parametrize("kind", ["any", "free"])
def bench_numba_modes(contender: Any, kind: str) -> None:
    """x = w + B₁ F in the basis of the step's eigenvectors, from float64 eigenvalues."""
    force, start = history(kind)

    def run(force: Any = force) -> Any:
        step, after = trapezoidal()
        roots, vectors = np.linalg.eig(step)
        half = np.flatnonzero(roots.imag > 0)
        into = 2 * np.linalg.inv(vectors)[half]
        row = np.concatenate([SHAPE, np.zeros(8)]).astype(complex)
        w = into @ (start - after * force[0])
        return compiled_modes(
            roots[half], into @ (step @ after + after), force, row @ vectors[:, half], w, float((row @ after).real)
        )

    run(force[:3])
    contender(CLAIMS[kind], "numba-compiled loop over diagonalised modes", run, error=error(kind))


@pytest.mark.parametrize("kind", ["any", "free"])
def bench_blocked(contender: Any, kind: str) -> None:
    """Blocks of 32 steps as one product of matrices, the blocks' states in a loop; powers in floats."""
    force, start = history(kind)
    length = 32

    def run() -> Any:
        step, after = trapezoidal()
        push, row = step @ after + after, np.concatenate([SHAPE, np.zeros(8)])
        powers = [np.linalg.matrix_power(step, k) for k in range(length + 1)]
        free = np.array([row @ power for power in powers[:-1]])
        impulse = np.concatenate([[row @ after], free[:-1] @ push])
        table = np.array([[impulse[i - j] if i >= j else 0.0 for j in range(length)] for i in range(length)])
        last = np.array([power @ push for power in powers[-2::-1]])
        number = -(-(STEPS + 1) // length)
        forces = np.zeros((number, length))
        forces.ravel()[: STEPS + 1] = force
        states = np.empty((number, 16))
        drives, w, whole = forces @ last, start - after * force[0], powers[-1]
        for k in range(number):
            states[k] = w
            w = whole @ w + drives[k]
        return (states @ free.T + forces @ table.T).ravel()[: STEPS + 1]

    contender(CLAIMS[kind], "blocks of 32 steps as products of matrices", run, error=error(kind))
