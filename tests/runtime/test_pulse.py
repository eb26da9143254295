"""A load that pulsates: against Mathieu's equation, Hill's method, perturbation and a Runge-Kutta method."""

from __future__ import annotations

import csv
import json
import math
from collections.abc import Callable
from itertools import product
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import eig, expm
from scipy.optimize import brentq
from scipy.special import mathieu_a, mathieu_b

import freebeam as fb
from freebeam import cli
from freebeam.pulsating.growth import KINDS, grid, judged
from freebeam.pulsating.monodromy import Pulsating, _Period, monodromy
from freebeam_sym.question import Question

EULER = fb.column("euler-pinned", "modes")


def asked(name: str, modes: int, alpha: float = 0.0, beta: float = 0.0, basis: str = "modes", **own: float) -> Question:
    return Question.of(fb.column(name, basis), modes, alpha, beta, **own)


def matrix(problem: Pulsating, load: float, frequency: float, amplitudes: list[float]) -> np.ndarray:
    """Monodromy matrices (m, 2n, 2n)."""
    U, logarithm = monodromy(problem, load, frequency, np.array(amplitudes))
    return U * np.exp(logarithm)[:, None, None]


# --- other ways -------------------------------------------------------------------------------------------------


def hill(question: Question, load: float, frequency: float, amplitude: float, harmonics: int) -> np.ndarray:
    """Multipliers (2N,) by Hill's method: z = e^(λt) Σ z_k e^(ikΩt) in the first-order form of the column's matrices,
    an eigenvalue problem of 2N(2K+1) unknowns. Of the eigenvalues λ + ikΩ the 2N whose harmonics lie about k = 0."""
    system = question.system(load)
    n = 2 * question.modes
    zero, one = np.zeros((n // 2, n // 2)), np.eye(n // 2)
    A = np.block([[zero, one], [-np.linalg.solve(system.M, system.K), -np.linalg.solve(system.M, system.C)]])
    B = np.block([[zero, zero], [-load * np.linalg.solve(system.M, system.H), zero]]) * amplitude / 2
    orders = np.arange(-harmonics, harmonics + 1)
    whole = np.kron(np.eye(len(orders)), A) - 1j * frequency * np.kron(np.diag(orders), np.eye(n))
    whole = whole + np.kron(np.eye(len(orders), k=1) + np.eye(len(orders), k=-1), B)
    values, vectors = np.linalg.eig(whole)
    sizes = (np.abs(vectors.reshape(len(orders), n, -1)) ** 2).sum(axis=1)
    centres = np.abs(orders @ sizes / sizes.sum(axis=0))
    kept = values[centres < harmonics / 2]
    multipliers = np.exp(kept * 2 * math.pi / frequency)
    distinct: list[complex] = []
    for value in multipliers:
        if all(abs(value - other) > 1e-6 for other in distinct):
            distinct.append(value)
    return np.array(distinct)


def runge_kutta(state: Callable[[float], np.ndarray], period: float) -> np.ndarray:
    """The monodromy matrix of z' = A(t) z by steps of order 8."""
    size = len(state(0.0))

    def rate(t: float, z: np.ndarray) -> np.ndarray:
        return (state(t) @ z.reshape(size, size)).ravel()

    found = solve_ivp(rate, (0, period), np.eye(size).ravel(), method="DOP853", rtol=1e-13, atol=1e-14)
    return found.y[:, -1].reshape(size, size)


def forms(question: Question, load: float) -> tuple[np.ndarray, np.ndarray]:
    """Frequencies ω_j (n,) at a load without damping, and H between left and right vectors of unit modal mass."""
    M, E, H = question.column.matrices(question.modes, **question.parameters)
    squares, left, right = eig(E + load * H, M, left=True, right=True)
    order = np.argsort(squares.real)
    left, right = left[:, order].real, right[:, order].real
    masses = np.einsum("ij,ik,kj->j", left, M, right)
    return np.sqrt(squares[order].real), (left.T @ H @ right) / masses[:, None]


# --- Mathieu ----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("load", [3.0, -5.0])
@pytest.mark.parametrize("amplitude", [0.05, 0.4, 0.9])
def test_one_mode_is_mathieus_equation(load: float, amplitude: float) -> None:
    """q̈ + (π⁴ − P π² − P π² ε cos Ωt) q = 0: with τ = Ωt/2, a = 4ω²/Ω² and q = 2 P π² ε/Ω²."""
    square = math.pi**4 - load * math.pi**2
    omega = math.sqrt(square)

    def edge(characteristic: Callable[[int, float], float], order: int) -> float:
        def apart(frequency: float) -> float:
            q = 2 * abs(load) * math.pi**2 * amplitude / frequency**2
            return float(characteristic(order, q)) - 4 * square / frequency**2

        return brentq(apart, 1.2 * omega / order, 3 * omega / order, xtol=1e-14, rtol=1e-14)

    for order, kind in ((1, "principal-2T"), (2, "principal-T")):
        low, high = sorted((edge(mathieu_a, order), edge(mathieu_b, order)))
        around = np.linspace(low - 0.3 * (high - low), high + 0.3 * (high - low), 9)
        found = fb.pulse(EULER, 1, load=load, frequency=around, amplitude=amplitude)
        (region,) = found.at(amplitude)
        assert region.kind == kind
        # growth is an ellipse over Ω, for a narrow region, and passes 1e-6 so far within
        within = (high - low) / 4 * (1e-6 / region.growth) ** 2
        assert (region.low, region.high) == pytest.approx((low, high), rel=1e-11, abs=1.5 * within)


# --- Hill -------------------------------------------------------------------------------------------------------


# of eight modes two alone: Hill's determinant at the lowest frequency takes as long as all the others
@pytest.mark.parametrize(
    ("modes", "frequency", "amplitude"),
    [*product([2], [4.0, 11.4, 12.2, 23.4, 35.0], [0.1, 0.6]), (8, 12.2, 0.6), (8, 35.0, 0.1)],
)
def test_multipliers_are_those_of_hills_method(modes: int, frequency: float, amplitude: float) -> None:
    question = asked("beck", modes, 1e-3, 0.1)
    other = hill(question, 12.0, frequency, amplitude, 8 + math.ceil(90 / frequency))
    ours = np.linalg.eigvals(matrix(Pulsating.of(question), 12.0, frequency, [amplitude])[0])
    for some, all_ in ((ours, other), (other, ours)):
        for value in some[np.abs(some) > 1e-3]:  # those that are not damped away
            assert np.abs(all_ - value).min() < 1e-9


def test_the_ends_of_damped_regions_are_those_of_hills_method() -> None:
    question = asked("beck", 2, 1e-3, 0.1)
    found = grid(question, 12.0, np.linspace(9, 15, 25), 0.3)

    def growth(frequency: float) -> float:
        return math.log(np.abs(hill(question, 12.0, frequency, 0.3, 20)).max())

    regions = found.at(0.3)
    ends = [regions[0].low, regions[-1].high]
    assert {region.kind for region in regions} == {"principal-2T", "combination"}
    for end in ends:
        assert end is not None
        assert end == pytest.approx(brentq(growth, end - 0.05, end + 0.05, xtol=1e-12), rel=1e-9)


# --- small amplitudes -------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("eta", "load", "pair", "sign", "largest"),
    [
        (1.0, 12.0, (0, 0), 1, 4e-3),
        (1.0, 12.0, (1, 1), 1, 4e-2),
        (1.0, 12.0, (0, 1), -1, 4e-3),
        (0.0, 1.5, (0, 1), 1, 0.16),
    ],
)
def test_regions_begin_with_the_slope_of_perturbation(
    eta: float, load: float, pair: tuple[int, int], sign: int, largest: float
) -> None:
    """Averaging two motions with Ω = ω_i ± ω_j + σ, for H between left and right vectors of unit modal mass:
    s² = ±(εP)² h_ij h_ji/(16 ω_i ω_j) − σ²/4. So they grow where ±h_ij h_ji > 0, about the sum for a load with a
    potential, for |σ| < (εP/2) √(±h_ij h_ji/(ω_i ω_j)); i = j is the principal region, |σ| < εP |h_jj|/(2ω_j)."""
    question = asked("beck", 4, eta=eta)
    omega, h = forms(question, load)
    i, j = pair
    centre = omega[j] + sign * omega[i]
    product = sign * h[i, j] * h[j, i] / (omega[i] * omega[j])
    assert product > 0
    off = []
    for amplitude in (largest, largest / 2):
        half = amplitude * load / 2 * math.sqrt(product)
        found = grid(question, load, centre + half * np.linspace(-3, 3, 13), amplitude)
        (region,) = found.at(amplitude)
        assert region.kind == ("principal-2T" if i == j else "combination")
        assert region.low is not None and region.high is not None
        rate = float(found.rate.max())
        assert rate == pytest.approx(half / 2, rel=0.02)
        off.append(abs((region.high - region.low) / (2 * half) - 1))
    assert off[0] < 1e-3 and off[1] < 0.4 * off[0]  # of the second order in ε


def test_the_other_combination_does_not_grow() -> None:
    """Beck's load takes from two modes about their sum what it gives about their difference; a dead load inversely."""
    for eta, load, sign in ((1.0, 12.0, 1), (0.0, 1.5, -1)):
        question = asked("beck", 2, eta=eta)
        omega, _ = forms(question, load)
        found = grid(question, load, omega[1] + sign * omega[0] + np.linspace(-0.2, 0.2, 41), 0.02)
        assert not found.kind.any()


def test_centres_are_named_with_their_frequencies() -> None:
    question = asked("beck", 2, eta=1.0)
    omega, _ = forms(question, 12.0)
    found = grid(question, 12.0, [1.0, 100.0], 0.0)
    named = {centre.label: centre.frequency for centre in found.centres()}
    expected = {r"$\omega_1$": omega[0], r"$2\omega_2$": 2 * omega[1], r"$\omega_1+\omega_2$": omega.sum()}
    expected |= {r"$(\omega_2-\omega_1)/2$": (omega[1] - omega[0]) / 2}
    assert len(named) == 8
    for label, value in expected.items():
        assert named[label] == pytest.approx(value, rel=1e-9)


def test_what_does_not_oscillate_has_no_centre() -> None:
    """External damping that lets the first mode creep and the second swing: its frequency is the first that is."""
    question = asked("beck", 2, beta=10.0, eta=1.0)
    found = grid(question, 1.0, [1.0, 100.0], 0.0)
    omega = sorted({abs(v) for v in found.eigenvalues.imag})
    assert len(omega) == 2 and omega[0] == 0
    named = {centre.label: centre.frequency for centre in found.centres()}
    assert named == pytest.approx({r"$\omega_1$": omega[1], r"$2\omega_1$": 2 * omega[1]})


# --- laws of the monodromy matrix -------------------------------------------------------------------------------


@pytest.mark.parametrize(("name", "basis", "modes"), [("beck", "legendre", 8), ("free-free", "modes", 8)])
@pytest.mark.parametrize("damping", [(0.0, 0.0), (1e-3, 0.1)])
def test_without_amplitude_it_is_the_exponential(
    name: str, basis: str, modes: int, damping: tuple[float, float]
) -> None:
    problem = Pulsating.of(asked(name, modes, *damping, basis=basis))
    found = matrix(problem, 10.0, 7.0, [0.0])[0]
    expected = expm(problem.state(10.0) * 2 * math.pi / 7.0)
    np.testing.assert_allclose(found, expected, atol=1e-11 * np.abs(expected).max())


@pytest.mark.parametrize("amplitude", [0.2, 0.8, 2.0])
def test_its_determinant_is_liouvilles(amplitude: float) -> None:
    """det U = exp(−T tr C), C in modal coordinates."""
    question = asked("beck", 4, 1e-4, 0.3)
    system = question.system(0.0)
    trace = np.trace(np.linalg.solve(system.M, system.C))
    found = np.linalg.det(matrix(Pulsating.of(question), 12.0, 6.0, [amplitude])[0])
    assert found == pytest.approx(math.exp(-trace * 2 * math.pi / 6.0), rel=1e-9)


@pytest.mark.parametrize("name", ["beck", "free-free"])
def test_without_damping_multipliers_come_with_their_reciprocals(name: str) -> None:
    """The load is the same backwards in time."""
    question = asked(name, 3)
    for frequency in (5.0, 12.0, 40.0):
        values = np.linalg.eigvals(matrix(Pulsating.of(question), 12.0, frequency, [0.7])[0])
        for value in values:
            assert np.abs(values * value - 1).min() < 1e-7  # its root where two meet


def test_any_matrices_that_are_polynomials_in_the_load() -> None:
    """M, C and K of degrees 2, 1 and 3, nothing symmetric but the mass without load; one amplitude and many."""
    random = np.random.default_rng(3)
    n, load, frequency = 3, 1.3, 3.0

    def draw(size: float) -> np.ndarray:
        return size * random.normal(size=(n, n))

    half, other = draw(1.0), draw(1.0)
    M = [half @ half.T + np.eye(n), draw(0.05), draw(0.01)]
    C = [draw(0.1), draw(0.2)]
    K = [20 * (other @ other.T + np.eye(n)) + draw(1.0), draw(1.0), draw(1.0), draw(0.1)]

    def state(t: float) -> np.ndarray:
        P = load * (1 + 0.7 * math.cos(frequency * t))
        m, c, k = (sum(P**j * X for j, X in enumerate(part)) for part in (M, C, K))
        return np.block([[np.zeros((n, n)), np.eye(n)], [-np.linalg.solve(m, k), -np.linalg.solve(m, c)]])

    expected = np.linalg.eigvals(runge_kutta(state, 2 * math.pi / frequency))
    for amplitudes in ([0.7], np.linspace(0, 0.7, 150).tolist()):
        found = np.linalg.eigvals(matrix(Pulsating(M, C, K), load, frequency, amplitudes)[-1])
        for value in found:
            assert np.abs(expected - value).min() < 1e-10


def test_a_column_in_matrices_of_its_own_is_the_same_column() -> None:
    """What a general column will hand over: M, C and K by powers of P, in the coordinates of its trial functions."""
    question = asked("beck", 6, 1e-3, 0.1, basis="legendre")
    M, E, H = question.column.matrices(6, **question.parameters)
    given = Pulsating([M], [1e-3 * E + 0.1 * M], [E, H])
    for frequency in (5.0, 12.0):
        two = [judged(problem, 12.0, frequency, np.array([0.5])) for problem in (given, Pulsating.of(question))]
        assert two[0].growth == pytest.approx(two[1].growth, rel=1e-8)


def test_amplitudes_together_are_amplitudes_alone() -> None:
    problem = Pulsating.of(asked("beck", 4, 1e-3, 0.1))
    many = np.linspace(0, 1.5, 120)
    together = judged(problem, 12.0, 4.0, many).growth
    for k in (0, 17, 80, 119):
        assert together[k] == pytest.approx(judged(problem, 12.0, 4.0, many[[k]]).growth[0], abs=1e-11)


def test_steps_are_cut_by_all_that_the_load_changes() -> None:
    """The size by which a period is cut is that of the largest difference of the state matrices in it."""
    problem = Pulsating.of(asked("beck", 4, 1e-3, 0.1))
    load, frequency, amplitude = 12.0, 4.0, 0.5
    loads = load * (1 + amplitude * np.cos(np.linspace(0, 2 * math.pi, 17)))
    largest = max(float(np.linalg.norm(problem.state(P) - problem.state(load), 2)) for P in loads)
    period = _Period.of(problem, load, frequency, amplitude, False)
    assert period.kick == pytest.approx(largest * 2 * math.pi / frequency, rel=1e-9)


@pytest.mark.parametrize(("basis", "modes"), [("modes", 1), ("modes", 8), ("legendre", 16)])
def test_the_error_that_is_told_is_small(basis: str, modes: int) -> None:
    question = asked("euler-pinned", modes, basis=basis)
    found = grid(question, 3.0, [2.0, 16.0], [0.4])
    assert 0 < found.error < 1e-10


def test_what_grows_for_long_stays_within_a_float() -> None:
    """Buckled at four times Euler's load: growth in a long period is that of the constant load, beyond e^700."""
    question = asked("euler-pinned", 1)
    found = grid(question, 4 * math.pi**2, [0.02], [0.0])
    rate = math.sqrt(3 * math.pi**4)
    assert found.growth[0, 0] == pytest.approx(rate * 2 * math.pi / 0.02, rel=1e-9) and found.growth[0, 0] > 700
    assert np.isinf(found.multiplier[0, 0]) and found.constant_grows and found.kind[0, 0] == KINDS.index("principal-T")


# --- verdicts ---------------------------------------------------------------------------------------------------


def test_undamped_motion_that_does_not_grow_is_stable() -> None:
    found = fb.pulse(fb.column("free-free"), load=40, frequency=[5.0, 27.0, 44.0], amplitude=[0.0, 0.01])
    assert not found.kind.any() and np.abs(found.growth).max() < 1e-8 and not found.constant_grows


def test_beyond_the_critical_load_the_constant_load_is_told() -> None:
    question = asked("beck", 4)
    assert grid(question, 19.0, [50.0], [0.0]).constant_grows is False
    found = grid(question, 21.0, [50.0], [0.0])
    assert found.constant_grows and KINDS[found.kind[0, 0]] == "combination"
    rate = max(fb.spectrum(question.system(21.0)).eigenvalues.real)
    assert found.rate[0, 0] == pytest.approx(rate, rel=1e-9)


def test_damping_raises_the_least_amplitude() -> None:
    """ε₀ = 4 δ ω/(P h) to first order, with decay δ = β/2: half-width √((εPh/2ω)² − 4δ²)."""
    load, beta = 3.0, 0.2
    omega = math.sqrt(math.pi**4 - load * math.pi**2)
    least = 2 * beta * omega / (load * math.pi**2)
    found = fb.pulse(EULER, 1, beta=beta, load=load, frequency=2 * omega, amplitude=[0.98 * least, 1.02 * least])
    assert found.kind.tolist() == [[0, 1]]


def test_the_error_that_is_told_is_of_the_size_of_the_error(monkeypatch: pytest.MonkeyPatch) -> None:
    """With a first step that is too long for the method, against a Runge-Kutta method."""
    monkeypatch.setattr("freebeam.pulsating.monodromy.START", 1.0)
    question = asked("beck", 2)
    problem = Pulsating.of(question)

    def state(t: float) -> np.ndarray:
        return problem.state(12.0 * (1 + 0.5 * math.cos(11.0 * t)))

    right = runge_kutta(state, 2 * math.pi / 11.0)
    wrong = matrix(problem, 12.0, 11.0, [0.5])[0]
    error = float(np.linalg.norm(wrong - right) / np.linalg.norm(right))
    assert error > 1e-9
    assert grid(question, 12.0, [11.0], 0.5).error == pytest.approx(error, rel=0.1)


def test_a_region_that_leaves_the_range_says_so() -> None:
    found = fb.pulse(EULER, 1, load=3.0, frequency=[16.3, 16.5], amplitude=[0.3])
    (region,) = found.at(0.3)
    assert (region.low, region.high) == (None, None)


# --- bad input --------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"frequency": 0.0}, "frequency = 0.0: must be greater than zero"),
        ({"frequency": [-1.0, 2.0]}, "frequency = -1.0: must be greater"),
        ({"frequency": [2.0, 1.0]}, "frequency: must be one number, or numbers that ascend"),
        ({"frequency": [[1.0]]}, "frequency: must be one number"),
        ({"frequency": "x"}, "frequency"),
        ({"frequency": 1e-9}, "too much happens in a period"),
        ({"amplitude": -0.1}, "amplitude = -0.1: must be zero or greater"),
        ({"amplitude": []}, "amplitude: must be one number"),
        ({"amplitude": float("nan")}, "amplitude = nan: must be finite"),
        ({"amplitude": 1e50}, "too much happens in a period"),
        ({"load": 0.0}, "load = 0.0: must differ from 0"),
        ({"load": 1e59}, "too much happens in a period"),
        ({"load": 1e70}, "load = 1e+70: must be below 1e60"),
        ({"modes": 0}, "modes = 0: must be a whole number"),
        ({"alpha": -1.0}, "alpha = -1.0: must be zero or greater"),
        ({"theta": 1.0}, "theta: beck has no such parameter"),
    ],
)
def test_what_makes_no_sense_is_refused_in_one_line(given: dict, message: str) -> None:
    with pytest.raises(fb.InputError) as refused:
        fb.pulse(fb.column("beck"), **{"load": 12.0, "frequency": 5.0, "amplitude": 0.1, **given})
    assert message in str(refused.value) and "\n" not in str(refused.value)


def test_an_amplitude_below_zero_has_no_regions() -> None:
    found = fb.pulse(EULER, 1, load=3.0, frequency=[16.3, 16.5], amplitude=[0.3])
    with pytest.raises(fb.InputError, match="amplitude = -1"):
        found.at(-1)


# --- the command ------------------------------------------------------------------------------------------------

COMMAND = ["pulse", "--column", "beck", "--modes", "2", "--load", "12", "--beta", "0.1"]
GRID = ["--frequency", "9", "15", "7", "--amplitude", "0", "0.4", "5"]


def told(capsys: pytest.CaptureFixture[str], *words: str) -> dict:
    assert cli.main([*words, "--json"]) == 0
    out, err = capsys.readouterr()
    assert err == ""
    return json.loads(out)


def test_every_format_holds_the_same_floats(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    xr = pytest.importorskip("xarray")
    found = told(capsys, *COMMAND, *GRID)
    expected = fb.pulse(
        fb.column("beck"), 2, beta=0.1, load=12, frequency=np.linspace(9, 15, 7), amplitude=np.linspace(0, 0.4, 5)
    )
    np.testing.assert_array_equal(found["growth"], expected.growth)
    assert np.array(found["kind"]).tolist() == np.array(KINDS)[expected.kind].tolist()
    assert found["load"] == 12 and found["grows_under_the_constant_load"] is False
    assert [tuple(region.values()) for region in found["regions"]["found"]] == [*map(tuple, expected.at(0.4))]
    for suffix in ("csv", "nc", "png"):
        file = tmp_path / f"regions.{suffix}"
        record = told(capsys, *COMMAND, *GRID, "--output", str(file))
        assert record["points"] == 35 and "growth" not in record and file.stat().st_size > 500
    head, *rows = (tmp_path / "regions.csv").read_text(encoding="utf-8").splitlines()
    settings = json.loads(head.removeprefix("# freebeam pulse "))
    assert settings["load"] == 12 and settings["error"] < 1e-10
    table = [*csv.DictReader(rows)]
    assert [float(row["growth"]) for row in table] == expected.growth.ravel().tolist()
    assert [row["kind"] for row in table] == np.array(KINDS)[expected.kind].ravel().tolist()
    with xr.open_dataset(tmp_path / "regions.nc", engine="h5netcdf") as stored:
        np.testing.assert_array_equal(stored["growth"].values, expected.growth)
        np.testing.assert_array_equal(stored["kind"].values, expected.kind)
        assert stored.attrs["load"] == 12 and stored["growth"].dims == ("frequency", "amplitude")


def test_si_units_are_a_change_of_scale(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    xr = pytest.importorskip("xarray")
    sizes = fb.column("beck").scales(2e6, 50, 20)
    beam = ["--bending-stiffness", "2e6", "--mass-per-length", "50", "--length", "20"]
    load, beta = repr(12 * sizes["load"]), repr(0.1 * sizes["beta"])
    low, high = (repr(x * sizes["frequency"]) for x in (9, 15))
    words = ["pulse", "--column", "beck", "--modes", "2", "--load", load, "--beta", beta, *beam]
    words += ["--frequency", low, high, "7", "--amplitude", "0", "0.4", "5"]
    si, bare = told(capsys, *words), told(capsys, *COMMAND, *GRID)
    np.testing.assert_allclose(si["growth"], bare["growth"], atol=1e-9)
    for one, other in zip(si["regions"]["found"], bare["regions"]["found"], strict=True):
        for end in ("low", "high"):
            expected = other[end] and other[end] * sizes["frequency"]
            assert one[end] == (expected and pytest.approx(expected, rel=1e-9))
    told(capsys, *words, "--output", str(tmp_path / "si.nc"))
    with xr.open_dataset(tmp_path / "si.nc", engine="h5netcdf") as stored:
        assert stored["frequency"].attrs["units"] == "rad/s"
        assert stored["frequency"].values[0] == pytest.approx(9 * sizes["frequency"])


def test_the_command_prints_regions(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main([*COMMAND, *GRID]) == 0
    out, err = capsys.readouterr()
    assert err == "" and "7 frequency x 5 amplitude" in out and "Regions at the amplitude 0.4" in out
    assert "principal-2T" in out and "without pulsation" not in out
    beyond = "pulse --column beck --modes 4 --load 25 --frequency 50 60 2 --amplitude 0 0 1"
    assert cli.main(beyond.split()) == 0
    out, _ = capsys.readouterr()
    assert "motion grows at the load 25 too" in out and "beyond the range" in out


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--frequency", "0", "15", "7", "--amplitude", "0", "1", "3"], "frequency: LO = 0: must be above 0"),
        (["--frequency", "9", "15", "7", "--amplitude", "-1", "1", "3"], "amplitude: LO = -1: is a share of the load"),
        (["--frequency", "9", "15", "--amplitude", "0", "1", "3"], "COUNT is missing; for example --frequency 3 40"),
        (["--frequency", "9", "15", "x", "--amplitude", "0", "1", "3"], "frequency: COUNT = x must be a whole number"),
        (["--frequency", "9", "5", "7", "--amplitude", "0", "1", "3"], "frequency: HI = 5 must be above LO = 9"),
        (["--frequency", "9", "15", "300", "--amplitude", "0", "1", "300", "--json"], "90000 points: JSON holds"),
        ([*GRID, "--output", "regions.txt"], "must end in .csv, .nc, .png"),
        (["--frequency", "9", "9", "1", "--amplitude", "0", "1", "3", "--output", "a.png"], "two values or more"),
        ([*GRID, "--load", "0"], "load = 0: must differ from 0"),
        (["--amplitude", "0", "1", "3"], "--frequency"),
    ],
)
def test_the_command_refuses_in_one_line(words: list[str], message: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main([*COMMAND, *words]) == 2
    out, err = capsys.readouterr()
    assert out == "" and err.count("\n") == 1 and message in err


@pytest.mark.parametrize("suffix", ["csv", "nc", "png"])
def test_an_interruption_leaves_nothing(
    suffix: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def interrupted(*_: object, **__: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("freebeam.pulsating.growth.judged", interrupted)
    assert cli.main([*COMMAND, *GRID, "--output", str(tmp_path / f"regions.{suffix}")]) == 130
    assert capsys.readouterr().out == "" and not [*tmp_path.iterdir()]
