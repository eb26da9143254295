"""Both methods against their recurrence in many digits, over up to a million steps.

That of Newmark is the textbook's; the exact one is the matrix exponential, from Taylor's series in 50 digits.
"""

from __future__ import annotations

import tracemalloc
from dataclasses import replace
from fractions import Fraction
from typing import Any

import mpmath as mp
import numpy as np
import pytest

import freebeam as fb
from freebeam_sym.checks import InputError
from freebeam_sym.response import digits

COLUMN = fb.column("free-free", "modes")
STEPS = 1_000_000
X = np.array([0.1, 0.6])


AVERAGE = {"newmark": (0.25, 0.5)}
EXACT = {"method": "exact"}
METHODS = pytest.mark.parametrize("method", [EXACT, AVERAGE], ids=["exact", "newmark"])


def generator(system: Any) -> tuple[Any, Any]:
    """G and B of x' = G x + B F for a force at x = 1, x = (q, dq), in the digits at hand."""
    M, C, K = (mp.matrix(np.asarray(part).tolist()) for part in (system.M, system.C, system.K))
    n, inverse = M.rows, M**-1
    G, B = mp.zeros(2 * n), mp.zeros(2 * n, 1)
    G[:n, n:], G[n:, :n], G[n:, n:] = mp.eye(n), -inverse * K, -inverse * C
    B[n:, 0] = inverse * mp.matrix(system.Q(1.0).tolist())
    return G, B


def exponential(X: Any) -> Any:
    """Taylor's series of the halved matrix, squared."""
    halvings = max(0, int(mp.ceil(mp.log(mp.norm(X, mp.inf), 2)))) + 8
    total = term = mp.eye(X.rows)
    for k in range(1, 26):  # 2⁻²⁰⁸ / 26!
        term = term * X / (k * mp.mpf(2) ** halvings)
        total = total + term
    for _ in range(halvings):
        total = total * total
    return total


def recurrence(system: Any, h: float, newmark: Any = None, method: str = "newmark") -> tuple[Any, Any, Any]:
    """A, B₀, B₁ of x⁺ = A x + B₀ F + B₁ F⁺, in 50 digits: from the textbook's two formulas, or from x' = G x + B F with
    F linear over a step."""
    G, B = generator(system)
    n, H = G.rows // 2, mp.mpf(h)
    if method == "exact":
        whole = mp.zeros(2 * n + 2)
        whole[: 2 * n, : 2 * n], whole[: 2 * n, 2 * n], whole[2 * n, 2 * n + 1] = H * G, H * B, 1
        whole = exponential(whole)
        slope = whole[: 2 * n, 2 * n + 1]
        return whole[: 2 * n, : 2 * n], whole[: 2 * n, 2 * n] - slope, slope
    b, g = (mp.mpf(value) for value in newmark)
    a, f = G[n:, :], B[n:, :]  # ddq = a x + f F

    def stacked(upper: Any, lower: Any) -> Any:
        whole = mp.zeros(2 * n, upper.cols)
        whole[:n, :], whole[n:, :] = upper, lower
        return whole

    one, old, left = mp.eye(n), mp.eye(2 * n), mp.eye(2 * n)
    old[:n, n:] = H * one
    old += stacked(H**2 * (mp.mpf(1) / 2 - b) * a, H * (1 - g) * a)
    left -= stacked(H**2 * b * a, H * g * a)
    inverse = left**-1
    before = inverse * stacked(H**2 * (mp.mpf(1) / 2 - b) * f, H * (1 - g) * f)
    return inverse * old, before, inverse * stacked(H**2 * b * f, H * g * f)


def waved(system: Any, h: float, frequency: float, method: dict[str, Any]) -> Any:
    """The step of (x, cos, sin) under the force sin, in 50 digits."""
    G, B = generator(system)
    d, theta = G.rows, mp.mpf(frequency) * mp.mpf(h)
    whole = mp.zeros(d + 2)
    if method == EXACT:
        whole[:d, :d], whole[:d, d + 1] = mp.mpf(h) * G, mp.mpf(h) * B
        whole[d, d + 1], whole[d + 1, d] = -theta, theta
        return exponential(whole)
    A, before, after = recurrence(system, h, **method)
    turned = mp.matrix([[mp.cos(theta), -mp.sin(theta)], [mp.sin(theta), mp.cos(theta)]])
    whole[:d, :d], whole[d:, d:] = A, turned
    whole[:d, d:] = before * mp.matrix([[0, 1]]) + after * mp.matrix([[0, 1]]) * turned
    return whole


def state_after(A: Any, x: Any, counts: list[int]) -> list[Any]:
    """A^n x for each n, by squaring."""
    states, power = [x for _ in counts], A
    for k in range(max(counts).bit_length()):
        states = [power * state if n >> k & 1 else state for n, state in zip(counts, states, strict=True)]
        power = power * power
    return states


def floats(matrix: Any) -> Any:
    return np.array(matrix.tolist(), dtype=float)


def worst(found: Any, states: list[Any], system: Any, counts: list[int] | None = None) -> float:
    """Largest difference in y and dy at some times, relative to the largest response."""
    n, errors = len(system.M), []
    for values, part in ((found.y, slice(0, n)), (found.dy, slice(n, 2 * n))):
        reference = np.array([state[part] @ system.shapes(X) for state in states])
        errors.append(np.abs(values[counts or COUNTS] - reference).max() / np.abs(values).max())
    return float(max(errors))


COUNTS = [1, 2, 1023, 1024, 77_777, 524_288, 999_999, STEPS]
STEP = 0.01


def start_of(system: Any) -> Any:
    """Elastic q and dq at first."""
    return 0.01 * system.mode(1) - 0.003 * system.mode(4), 0.1 * system.mode(2)


@pytest.fixture(scope="module", params=[False, True], ids=["elastic", "rigid"])
def light(request: pytest.FixtureRequest) -> Any:
    """Eight modes, light damping; with rigid functions λ = 0 is a double eigenvalue of one vector, or nearly."""
    return COLUMN.system(8, load=50, alpha=1e-7, beta=1e-3, rigid=request.param)


@pytest.fixture(scope="module", params=[EXACT, AVERAGE], ids=["exact", "newmark"])
def method(request: pytest.FixtureRequest) -> dict[str, Any]:
    return dict(request.param)


@pytest.fixture(scope="module")
def true(light: Any, method: dict[str, Any]) -> list[Any]:
    """The states after COUNTS steps, free, and under the force sin 3t from rest."""
    d = 2 * len(light.M)
    with mp.workdps(50):
        start = mp.zeros(d + 2, 2)  # both cases are columns of one matrix
        start[:d, 0], start[d, 1] = mp.matrix(np.concatenate(start_of(light)).tolist()), 1
        return [floats(state) for state in state_after(waved(light, STEP, 3.0, method), start, COUNTS)]


def test_a_million_free_steps_of_light_damping(light: Any, method: Any, true: Any) -> None:
    q, dq = start_of(light)
    found = fb.respond(light, STEPS * STEP, STEP, initial=q, initial_velocity=dq, sensors=X, **method)
    assert worst(found, [state[:-2, 0] for state in true], light) < 1e-13


def test_a_million_harmonic_steps_of_light_damping(light: Any, method: Any, true: Any) -> None:
    force = fb.Harmonic(1.0, 3.0)
    found = fb.respond(light, STEPS * STEP, STEP, force=force, force_position=1, sensors=X, **method)
    assert worst(found, [state[:-2, 1] for state in true], light) < 1e-13


@pytest.mark.skipif(np.finfo(np.longdouble).eps > 1e-18, reason="the loop needs more digits than floats have")
def test_any_force_is_the_plain_loop_over_stretches(light: Any, method: Any) -> None:
    """Against a loop in extended precision, whose own drift stays below 1e-14."""
    steps = 150_001
    f = np.random.default_rng(0).normal(size=steps + 1)
    with mp.workdps(50):
        A, before, after = (extended(part) for part in recurrence(light, STEP, **method))
    n = len(light.M)
    row = np.concatenate([light.shapes(X[:1])[:, 0], np.zeros(n)]).astype(np.longdouble)
    x, y = np.zeros(2 * n, dtype=np.longdouble), np.zeros(steps + 1, dtype=np.longdouble)
    drives = np.outer(f[:-1].astype(np.longdouble), before[:, 0]) + np.outer(f[1:].astype(np.longdouble), after[:, 0])
    for k, drive in enumerate(drives):
        x = A @ x + drive
        y[k + 1] = row @ x
    found = fb.respond(light, steps * STEP, STEP, force=f, force_position=1, sensors=X[:1], outputs=("y",), **method)
    assert float(np.abs(found.y[:, 0] - y).max() / np.abs(y).max()) < 1e-13


def extended(matrix: Any) -> Any:
    """Long doubles."""
    high = floats(matrix)
    low = floats(matrix - mp.matrix(high.tolist()))
    return high.astype(np.longdouble) + low.astype(np.longdouble)


@pytest.mark.parametrize(
    ("settings", "method", "initial"),
    [
        ({"modes": 4, "load": 109.0}, AVERAGE, "mode"),  # undamped, near coalescence
        ({"modes": 4, "load": 109.0}, EXACT, "mode"),
        ({"modes": 2, "load": 0.0, "rigid": True, "alpha": 1e-7}, AVERAGE, "turning"),  # linear
        ({"modes": 2, "load": 0.0, "rigid": True, "alpha": 1e-7}, EXACT, "turning"),
        ({"modes": 2, "load": 20.0, "rigid": True}, AVERAGE, "turning"),  # cubic
        ({"modes": 2, "load": 20.0, "rigid": True}, EXACT, "turning"),
        ({"modes": 3, "load": 50.0, "alpha": 1e-7}, {"newmark": (1 / 6, 0.5)}, "mode"),  # linear acceleration
        ({"modes": 3, "load": 50.0, "alpha": 0.05, "beta": 3.0}, AVERAGE, "mode"),  # overdamped modes
        ({"modes": 3, "load": 50.0, "alpha": 0.05, "beta": 3.0}, EXACT, "mode"),
        ({"modes": 4, "load": 40.0, "alpha": 10.0, "beta": 0.1, "rigid": True}, EXACT, "turning"),  # very stiff
    ],
)
def test_closed_form_at_the_awkward_ones(settings: dict[str, Any], method: Any, initial: str) -> None:
    system = COLUMN.system(**settings)
    n, h, steps = len(system.M), 0.001, 100_000
    start = np.zeros(2 * n)
    start[n + 1 if initial == "turning" else 0] = 0.01
    start[n - 1] = 0.002
    options = {"initial": start[:n], "initial_velocity": start[n:], "sensors": X, **method}
    found = fb.respond(system, steps * h, h, **options)
    counts = [3, 4097, steps]
    with mp.workdps(50):
        A, _, _ = recurrence(system, h, **method)
        states = [floats(state)[:, 0] for state in state_after(A, mp.matrix(start.tolist()), counts)]
    assert worst(found, states, system, counts) < 1e-12
    # rigid drift does not cost the elastic part its digits
    r = system.rigid_count
    expected = np.array([state[r:n] @ system.shapes(X)[r:] for state in states])
    assert np.abs(found.y_elastic[counts] - expected).max() < 1e-12 * np.abs(found.y_elastic).max()


@pytest.mark.parametrize("rigid", [False, True])
@METHODS
def test_at_a_coalescence(method: Any, rigid: bool) -> None:
    """Parallel vectors, to rounding: the elastic motion grows with time, and its error is at most what another rounding
    of K does to it. The rigid motion that it drives grows faster, and keeps eight digits."""
    system = COLUMN.system(4, load=fb.critical_load(COLUMN, modes=4).load, rigid=rigid)
    n, r, h, steps = len(system.M), system.rigid_count, 0.01, 100_000
    rng = np.random.default_rng(1)
    start, counts = rng.normal(size=2 * n), [3, 4097, steps // 3, steps]
    options = {"sensors": X, **method}
    free = fb.respond(system, steps * h, h, initial=start[:n], initial_velocity=start[n:], **options)
    forced = fb.respond(system, steps * h, h, force=fb.Harmonic(1.0, 3.0), force_position=1, **options)
    other = replace(system, K=system.K * (1 + np.finfo(float).eps * rng.choice([-1, 1], size=(n, n))))
    with mp.workdps(50):
        both = mp.zeros(2 * n + 2, 2)
        both[: 2 * n, 0], both[2 * n, 1] = mp.matrix(start.tolist()), 1
        true, moved = (
            np.array([floats(x) for x in state_after(waved(s, h, 3.0, method), both, counts)]) for s in (system, other)
        )
    for found, column in ((free, 0), (forced, 1)):
        states, others = true[..., column], moved[..., column]
        exact, rounded = (part[:, r:n] @ system.shapes(X)[r:] for part in (states, others))
        error = np.abs(found.y_elastic[counts] - exact).max()
        assert error < np.abs(rounded - exact).max()
        assert error < 1e-9 * np.abs(found.y_elastic).max() and worst(found, states, system, counts) < 1e-8
        assert worst(found, states[:2], system, counts[:2]) < 1e-12
    assert np.abs(free.y_elastic[-1000:]).max() > 50 * np.abs(free.y_elastic[:1000]).max()


@METHODS
def test_resonance_needs_no_care(method: Any) -> None:
    """Undamped at its own numerical frequency, and beside it: growth with time, from the recurrence in many digits."""
    system = COLUMN.system(2, load=30)
    h, steps = 0.01, 20_000
    with mp.workdps(50):
        A, _, _ = recurrence(system, h, **method)
        omega = min(abs(float(mp.arg(value))) for value in mp.eig(A, left=False, right=False))
        for frequency in (omega / h, omega / h * (1 + 1e-9), omega / h * 1.001):
            start, counts = mp.matrix([0, 0, 0, 0, 1, 0]), [steps // 3, steps]
            states = state_after(waved(system, h, frequency, method), start, counts)
            found = fb.respond(
                system, steps * h, h, force=fb.Harmonic(1.0, frequency), force_position=1, sensors=X, **method
            )  # fmt: skip
            assert worst(found, [floats(state)[:4, 0] for state in states], system, counts) < 1e-12


def test_closed_forms_are_the_blocks(light: Any) -> None:
    """The closed form of a harmonic and of a constant force against the blocks that take any force.

    Between the steps the exact method takes samples to be linear and a wave to be a wave: there, constants alone agree.
    """
    times = 0.01 * np.arange(5001)
    for system in (light, COLUMN.system(3, load=60, beta=0.1, rigid=True)):
        for closed, method in ((fb.Harmonic(0.3, 7.0, 0.4), AVERAGE), (0.2, AVERAGE), (0.2, EXACT)):
            sampled = closed(times) if callable(closed) else np.full(5001, closed)
            options: dict[str, Any] = {"force_position": 0.8, "sensors": X, "initial": np.full(len(system.M), 1e-3)}
            options |= method
            one, other = (fb.respond(system, 50, 0.01, force=force, **options) for force in (closed, sampled))
            for name in ("y", "dy", "ddy", "y_elastic"):
                a, b = getattr(one, name), getattr(other, name)
                assert np.abs(a - b).max() < 1e-12 * np.abs(b).max()


@METHODS
def test_energy_is_kept_over_a_long_time(method: Any) -> None:
    """Average acceleration keeps it as the equation does, for a symmetric undamped system: 300,000 steps, in parts."""
    system = COLUMN.system(4)
    drift: list[float] = []

    def energies(part: Any) -> None:
        found = np.einsum("ti,ij,tj->t", part.dq[::7], system.M, part.dq[::7])
        found += np.einsum("ti,ij,tj->t", part.q[::7], system.K, part.q[::7])
        drift.append(float(np.abs(found / first - 1).max()))

    q = np.array([1.0, -0.3, 0.2, 0.1])
    first = q @ system.K @ q
    fb.respond(system, 3000, 0.01, initial=q, outputs=("y",), states=True, target=energies, **method)
    assert len(drift) > 1 and max(drift) < 1e-13


# Load cases


def test_cases_are_responses_one_by_one() -> None:
    system = COLUMN.system(3, load=40, alpha=1e-3)
    rng = np.random.default_rng(5)
    force, initial = rng.normal(size=(2, 1, 1501)), 0.01 * rng.normal(size=(3, 3))
    options: dict[str, Any] = {"force_position": 1, "sensors": X}
    found = fb.respond(system, 15, 0.01, force=force, initial=initial, **options)
    assert found.y.shape == (2, 3, 1501, 2) and found.t.shape == (1501,)
    for i, j in np.ndindex(2, 3):
        alone = fb.respond(system, 15, 0.01, force=force[i, 0], initial=initial[j], **options)
        for name in ("y", "dy", "ddy"):
            a, b = getattr(found, name)[i, j], getattr(alone, name)
            assert np.abs(a - b).max() < 1e-12 * np.abs(b).max()
    free = fb.respond(system, 15, 0.01, initial=initial, sensors=X)
    waves = fb.respond(system, 15, 0.01, force=fb.Harmonic(np.array([1.0, 2.0]), 3.0), **options, **AVERAGE)
    moving = fb.respond(
        system, 15, 0.01, force=lambda t: np.sin(3 * t) * np.array([[1.0], [2.0]]), **options, **AVERAGE
    )
    assert free.y.shape == (3, 1501, 2) and waves.y.shape == moving.y.shape == (2, 1501, 2)
    assert np.abs(free.y[1] - fb.respond(system, 15, 0.01, initial=initial[1], sensors=X).y).max() < 1e-15
    assert np.abs(waves.y - moving.y).max() < 1e-12 * np.abs(moving.y).max()


# Longer than memory


@pytest.mark.parametrize("options", [{}, {"force": np.sin, "force_position": 1}])
def test_memory_is_bounded_by_a_stretch(options: dict[str, Any]) -> None:
    """The peak of a response four times as long is the same."""
    system, peaks = COLUMN.system(2, load=30, beta=0.1), []
    for steps in (1_200_000, 2_400_000):
        times: list[int] = []
        tracemalloc.start()
        fb.respond(
            system, steps * 0.01, 0.01, outputs=("y",), sensors=np.linspace(0, 1, 4),
            target=lambda part, times=times: times.extend((part.begin, part.end)), **options,
        )  # fmt: skip
        peaks.append(tracemalloc.get_traced_memory()[1])
        tracemalloc.stop()
        assert times[0] == 0 and times[-1] == steps + 1 and times[1:-1:2] == times[2::2]
    assert peaks[1] < 1.05 * peaks[0]


@pytest.mark.parametrize("options", [{}, {"force": np.sin, "force_position": 1}])
def test_targets_hold_what_memory_would(tmp_path: Any, options: dict[str, Any]) -> None:
    system = COLUMN.system(2, load=30, beta=0.1, rigid=True)
    steps = 300_000
    whole = fb.respond(system, steps * 0.01, 0.01, sensors=X, **options)
    parts: list[Any] = []
    last = fb.respond(system, steps * 0.01, 0.01, sensors=X, target=parts.append, **options)
    assert len(parts) > 1 and last is parts[-1] and parts[0].begin == 0 and last.end == steps + 1
    for name in ("t", "y", "ddy", "dy_elastic", "y_rigid"):
        np.testing.assert_array_equal(np.concatenate([getattr(part, name) for part in parts]), getattr(whole, name))
    file = np.lib.format.open_memmap(tmp_path / "y.npy", "w+", shape=(steps + 1, 2))
    found = fb.respond(system, steps * 0.01, 0.01, sensors=X, target={"y_rigid": file}, **options)
    assert found.y_rigid is file and found.y is None and found.t.size == steps + 1
    # alone an array is computed in longer stretches: the same to rounding
    assert np.abs(file - whole.y_rigid).max() < 1e-12 * np.abs(whole.y_rigid).max()


def test_outputs_that_were_not_asked_for_are_none() -> None:
    found = fb.respond(COLUMN.system(2), 1, 0.1, outputs=("dy",))
    assert found.y is None and found.ddy_rigid is None and found.dy.shape == (11, 1)
    whole = fb.respond(COLUMN.system(2), 1, 0.1)
    np.testing.assert_allclose(found.dy, whole.dy, atol=1e-14)


# Input


def late(t: Any) -> Any:
    return np.where(t < 2500, 1.0, np.nan)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"force": late, "force_position": 1}, "force = nan at 2500: must be finite"),
        ({"force": np.where(np.arange(300_001) == 299_999, np.inf, 0), "force_position": 1}, "force = inf at 2999.99"),
        ({"force": np.zeros((2, 3)), "force_position": 1}, r"shape \(2, 3\).*\(300001,\) or \(\*cases, 300001\)"),
        ({"force": fb.Harmonic(np.nan, 1.0), "force_position": 1}, "force.amplitude = nan"),
        ({"force": fb.Harmonic(1.0, np.inf), "force_position": 1}, "force.frequency = inf"),
        ({"force": fb.Harmonic(1.0, 1.0)}, "force_position is missing"),
        ({"initial": np.zeros((2, 2)), "initial_velocity": np.zeros((3, 2))}, r"load cases of shapes.*\(2,\).*\(3,\)"),
        ({"initial": np.zeros((0, 2))}, "must be one or more"),
        ({"initial": lambda x: np.stack([x, 2 * x])}, "must give one; cases are arrays"),
        ({"outputs": ("y", "speed")}, "outputs"),
        ({"outputs": "y"}, "outputs"),
        ({"target": {}}, "target = {}"),
        ({"target": {"speed": np.zeros((300_001, 1))}}, r"target\['speed'\]: there is no such array; there are y, dy"),
        ({"target": {"y_rigid": np.zeros((300_001, 1))}}, "no such array"),
        ({"target": {"y": np.zeros((300_001, 2))}}, r"target\['y'\] has shape \(300001, 2\).*\(300001, 1\)"),
        ({"target": {"y": [0.0]}}, "target"),
    ],
)
def test_bad_input(options: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message) as caught:
        fb.respond(COLUMN.system(2), 3000, 0.01, **options)
    assert "\n" not in str(caught.value)


def test_no_part_is_handed_on_with_a_force_that_is_not_finite() -> None:
    parts: list[Any] = []
    with pytest.raises(InputError, match="nan at 2500"):
        fb.respond(
            COLUMN.system(2),
            3000,
            0.01,
            force=late,
            force_position=1,
            sensors=np.linspace(0, 1, 9),
            target=parts.append,
        )
    assert parts and parts[-1].end <= 250_000 and all(np.isfinite(part.y).all() for part in parts)


# More digits


def test_products_of_twice_the_digits() -> None:
    """Against exact rational numbers: 2⁻⁹⁰ of the largest entries, through a few squarings."""
    rng = np.random.default_rng(7)
    x = digits.Double(0.4 * rng.normal(size=(5, 5)), 1e-18 * rng.normal(size=(5, 5)))

    def exactly(x: digits.Double) -> Any:
        return [np.vectorize(Fraction, otypes=[object])(part.tolist()) for part in (x.high, x.low)]

    reference = sum(exactly(x))
    for _ in range(3):
        x, reference = x @ x, reference @ reference
        assert np.abs(sum(exactly(x)) - reference).max() < Fraction(2.0**-90 * np.abs(x.high).max())


@pytest.mark.parametrize("z", [0j, 1e-9j, 0.3j, -2.5j, 1000j, 0.1 + 2j, -30 + 1j, -1e6 + 5j, 50 + 3j])
def test_exponentials(z: complex) -> None:
    with mp.workdps(80):
        found = digits.exponential((digits.fixed(z.real), digits.fixed(z.imag)))
        error = abs(mp.mpc(*found) / digits.ONE - mp.exp(mp.mpc(z)))
        assert error < mp.mpf(10) ** -32 * max(1, mp.exp(z.real))


def test_exponentials_of_matrices() -> None:
    """Against Taylor's series in many digits: block triangular, of a norm of some thousands, with a double zero."""
    rng = np.random.default_rng(3)
    X = np.triu(rng.normal(size=(6, 6)))
    X[:2, :2], X[2:4, 2:4] = [[0, 1], [0, 0]], [[-0.1, 3000.0], [-3000.0, -0.1]]
    found = digits.expm(digits.Double(X, np.zeros_like(X)))
    with mp.workdps(60):
        exact = exponential(mp.matrix(X.tolist()))
        error = max(abs(mp.mpf(found.high[i, j]) + mp.mpf(found.low[i, j]) - exact[i, j]) for i, j in np.ndindex(6, 6))
    assert error < 2.0**-90 * 3000 * 100 and not found.high[2:, :2].any()
