"""Coordinates without mass: spectra, branches, responses and state spaces against the problem as it stands."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from mpmath import mp, mpf
from scipy.integrate import solve_ivp
from scipy.linalg import eig, eigvals, expm

import freebeam as fb
from freebeam.pulsating.monodromy import Pulsating, monodromy
from freebeam_sym.question import Question
from freebeam_sym.stability.general import General
from tests.reference import transfer
from tests.reference.values import Q, timoshenko
from tests.stated import TIMOSHENKO, file_of

# spring, damper and spring in a row from the tip to the ground: three of the four states of q and p are decided
CHANGES = {
    "V": "V + k * (at(y, 1) - q) ** 2 / 2 + 3 * p ** 2 / 2",
    "dW_nc": "follower + external + F_0 * at(delta(y), x_F) - c * (q.diff(t) - p.diff(t)) * delta(q - p)",
    "parameters": "(own(k, 5.0), own(c, 0.5))",
}
CONTROL = {
    "dW_nc": "follower + external + F_0 * at(delta(y), x_F)"
    " - g * q * at(delta(y), 1) - (q.diff(t) + q - at(y, half)) * delta(q)",
    "parameters": "(own(g, 0.5),)",
}
SHEAR = TIMOSHENKO | {
    "T": "integral(y.diff(t) ** 2) / 2",
    "dW_nc": "-P * at(psi, 1) * at(delta(y), 1) + external + F_0 * at(delta(y), x_F)",
    "parameters": "(own(k, 100.0),)",
}


@pytest.fixture(scope="module", params=[CHANGES, CONTROL, SHEAR], ids=["damper between springs", "controller", "shear"])
def column(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> fb.Column:
    return fb.column(file_of(tmp_path_factory.mktemp("massless"), "massless", request.param))


@pytest.fixture(scope="module")
def missing(column: fb.Column, system: fb.System) -> int:
    """Of 2n, the states that there are not: the controller's rate, p and both rates, or all of ψ."""
    if len(column.parameters) == 1 and column.parameters[0].name == "k":
        return 2 * int((np.diag(system.M) == 0).sum())
    return 1 if column.parameters[0].name == "g" else 3


@pytest.fixture(scope="module")
def system(column: fb.Column) -> fb.System:
    return column.system(5, load=8.0, beta=0.3)


def test_the_eigenvalues_are_the_finite_ones_of_the_quadratic_problem(system: fb.System, missing: int) -> None:
    """The others of 2n are at infinity; all by the QZ algorithm."""
    n = len(system.M)
    A = np.block([[np.zeros((n, n)), np.eye(n)], [-system.K, -system.C]])
    values = eig(A, np.block([[np.eye(n), np.zeros((n, n))], [np.zeros((n, n)), system.M]]), right=False)
    values = values[np.isfinite(values)]
    values = values[np.argsort(np.abs(values))][: 2 * n - missing]
    found = fb.spectrum(system)
    assert found.eigenvalues.shape == (2 * n - missing,) and found.vectors.shape == (n, 2 * n - missing)
    assert np.abs(found.eigenvalues[:, None] - values).min(axis=1) / np.abs(found.eigenvalues) == pytest.approx(
        0, abs=1e-9
    )
    for rate, q in zip(found.eigenvalues, found.vectors.T, strict=True):
        terms = np.array([rate**2 * system.M @ q, rate * system.C @ q, system.K @ q])
        assert np.abs(terms.sum(axis=0)).max() < 1e-10 * np.abs(terms).max()


def test_what_has_no_mass_is_the_limit_of_little_mass(system: fb.System) -> None:
    """The low eigenvalues with a mass ε of both coordinates come to those without as ε, and so to first order."""
    lowest, off = fb.spectrum(system).eigenvalues[:4], []
    for small in (1e-4, 1e-5):
        M = system.M + small * np.diag(np.diag(system.M) == 0)
        n = len(M)
        A = np.block([[np.zeros((n, n)), np.eye(n)], [-np.linalg.solve(M, system.K), -np.linalg.solve(M, system.C)]])
        off.append(np.abs(np.linalg.eigvals(A)[:, None] - lowest).min(axis=0))
    assert (off[0] < 0.1).all() and off[0] / off[1] == pytest.approx(10, rel=0.1)


def test_branches_pass_through_the_spectra(column: fb.Column) -> None:
    loads = np.linspace(0, 20, 9)
    found = fb.branches(column, loads, 5, beta=0.3)
    for load, values in zip(loads, found.eigenvalues, strict=True):
        wanted = fb.spectrum(column.system(5, load, beta=0.3)).eigenvalues
        off = np.abs(values[:, None] - wanted) / np.abs(wanted)
        assert len(values) == len(wanted) and off.min(axis=0).max() < 1e-8 and off.min(axis=1).max() < 1e-8


@pytest.mark.parametrize("outputs", [("y",), ("dy",), ("ddy",)])
def test_the_state_space_has_the_transfer_function_of_the_matrices(
    system: fb.System, missing: int, outputs: tuple[str]
) -> None:
    """y/F = φ(x_s) · (s²M + sC + K)⁻¹ Q, of velocities s times and of accelerations s² times that."""
    states = fb.state_space(system, 0.6, (0.5, 1.0), outputs)
    assert states.A.shape == (2 * len(system.M) - missing,) * 2
    for s in (0.3 + 1j, -0.1 + 4j, 2.0 + 0j):
        own = system.shapes(np.array([0.5, 1.0])).T @ np.linalg.solve(
            s**2 * system.M + s * system.C + system.K, system.Q(0.6)
        )
        got = states.C @ np.linalg.solve(s * np.eye(len(states.A)) - states.A, states.B) + states.D
        assert got[:, 0] == pytest.approx(own * s ** {"y": 0, "dy": 1, "ddy": 2}[outputs[0]], rel=1e-8)


def test_a_response_is_that_of_its_states(system: fb.System) -> None:
    """Against the exponential of the state space, which forgets no relation; free, and under a constant force."""
    states = fb.state_space(system, 0.6, (1.0,))
    n = len(states.A)
    whole = np.zeros((n + 1, n + 1))
    whole[:n, :n], whole[:n, n:] = states.A, states.B
    forced = fb.respond(system, 4.0, 0.05, force=1.0, force_position=0.6, sensors=(1.0,))
    wanted = [(states.C @ (expm(time * whole)[:n, n])).item() for time in 0.5 * np.arange(9)]
    assert forced.y[::10, 0] == pytest.approx(wanted, abs=1e-10)
    assert not forced.warnings and forced.growth == pytest.approx(fb.spectrum(system).growth_rate, rel=1e-8)
    free = fb.respond(system, 4.0, 0.5, initial=lambda x: 0.01 * x**2, states=True)
    relation = free.dq @ system.C.T + free.q @ system.K.T
    still = np.diag(system.M) == 0
    assert np.abs(relation[:, still]).max() < 1e-12 and np.abs(free.q[-1]).max() > 1e-4
    # the motion of what has no inertia along the beam is stiff
    fine = 8 if np.count_nonzero(still) > 2 else 1
    steps = [h / fine for h in (0.002, 0.001)]
    stepped = [fb.respond(system, 4.0, h, method="newmark", initial=lambda x: 0.01 * x**2).y[-1] for h in steps]
    off = np.abs(np.array(stepped) - free.y[-1])
    assert off[0] / off[1] == pytest.approx(4, rel=0.2)


def test_a_motion_that_nothing_decides_is_refused(tmp_path: Path) -> None:
    """A coordinate that drives the beam, and that nothing drives: every motion of it would do."""
    path = file_of(tmp_path, "undecided", {"dW_nc": "follower - q.diff(t) * at(delta(y), 1)"})
    with pytest.raises(fb.InputError, match="its motion is not determined"):
        fb.spectrum(fb.column(path).system(4, 1.0))


def test_the_multipliers_under_a_pulsating_load_are_those_of_the_states(column: fb.Column) -> None:
    """The states integrated over a period, step by step."""
    load, frequency, amplitude = 8.0, 9.0, 0.4
    problem = Pulsating.of(Question.of(column, 3, beta=0.3))
    (matrix,), (logarithm,) = monodromy(problem, load, frequency, np.array([amplitude]))
    multipliers = np.exp(logarithm) * np.linalg.eigvals(matrix)

    at_0, at_1 = (fb.state_space(column.system(3, P, beta=0.3), 0.6).A for P in (0.0, 1.0))  # linear in P

    def rates(t: float, x: np.ndarray) -> np.ndarray:
        P = load * (1 + amplitude * np.cos(frequency * t))
        return ((at_0 + P * (at_1 - at_0)) @ x.reshape(size, size)).ravel()

    size = len(at_0)
    found = solve_ivp(rates, (0, 2 * np.pi / frequency), np.eye(size).ravel(), rtol=1e-9, atol=1e-11)
    wanted = np.linalg.eigvals(found.y[:, -1].reshape(size, size))
    assert np.abs(wanted[:, None] - multipliers).min(axis=1).max() < 1e-6


@pytest.mark.parametrize("mass", [-5.0, -0.3])
def test_a_negative_mass_is_refused(mass: float) -> None:
    """With a negative entry on M's diagonal, and with none though M is indefinite."""
    system = fb.column("pflueger").system(4, 1.0, mu=mass)
    assert np.linalg.eigvalsh(system.M)[0] < 0
    for ask in (fb.spectrum, lambda s: fb.respond(s, 1.0, 0.1), lambda s: fb.state_space(s, 1.0)):
        with pytest.raises(fb.InputError, match="M is not positive definite: no mass may be negative"):
            ask(system)


def test_springs_in_a_row_are_one_where_nothing_damps_what_is_between(tmp_path: Path) -> None:
    """A coordinate with springs alone, where alpha = 0: of 15 and 30 in a row is 10."""
    changes = {
        "V": "V + 15 * (at(y, 1) - q) ** 2 / 2 + 30 * q ** 2 / 2",
        "dW_nc": "follower + external - alpha * q.diff(t) * delta(q)",
    }
    between, alone = fb.column(file_of(tmp_path, "between", changes)), fb.column("tip-spring")
    for asked in ({}, {"beta": 0.1}, {"kappa": np.inf}):
        found, expected = (fb.critical_load(column, 8, **asked) for column in (between, alone))
        assert (found.load, found.kind) == (pytest.approx(expected.load, rel=1e-12), expected.kind)
        assert found.frequency == pytest.approx(expected.frequency, rel=1e-7)


def test_an_integral_controller_without_stiffness_has_its_digits(tmp_path: Path) -> None:
    """Its state has neither mass nor energy; what grows by 7e-4 of its frequency is told, at any N."""
    changes = {"dW_nc": "follower - 0.1 * q * at(delta(y), 1) - (q.diff(t) - at(y, half)) * delta(q)"}
    column = fb.column(file_of(tmp_path, "integral", changes))
    few, many = (fb.spectrum(column.system(modes, load=5.0)) for modes in (12, 24))
    one, two = (found.eigenvalues[:3] for found in (few, many))
    assert few.error[:3].max() < 1e-6 and many.error[:3].max() < 1e-6
    assert (np.abs(one - two) <= (few.error[:3] + many.error[:3]) * np.abs(two)).all()
    assert min(many.damping_ratio[:3]) == pytest.approx(-6.812e-4, rel=1e-3)


def test_a_field_without_inertia_has_the_load_and_the_spectrum_of_the_beam_itself(tmp_path: Path) -> None:
    """Of the exact equations at 30 digits, where its inertia is nought too; the mode has both fields."""
    column = fb.column(file_of(tmp_path, "shear", SHEAR))
    beam = timoshenko(Q(100), Q(0), "slope")
    found = fb.critical_load(column)
    assert found.load is not None and found.error is not None and found.mode is not None
    spectrum = fb.spectrum(column.system(load=5.0))
    with mp.workdps(25):
        load, omega = transfer.coalescence(beam, mpf(9), mpf(15))
        assert abs(found.load / load - 1) < found.error < 1e-12 and found.frequency == pytest.approx(
            float(omega), rel=1e-7
        )
        for rate, error in zip(spectrum.eigenvalues[:4:2], spectrum.error[:4:2], strict=True):
            sides = (mpf(-(rate.imag**2)) * (1 + side * mpf(2 * error)) for side in (-1, 1))
            low, high = (transfer.of_square(beam, square, mpf(5)) for square in sides)
            assert low * high < 0 and error < 1e-9
    M, _, K = column.coefficients().at(found.load)
    residual = (K - found.frequency**2 * M) @ found.mode
    assert np.abs(residual).max() < 1e-6 * np.abs(K * found.mode).max()


def test_a_field_without_inertia_that_the_load_presses_is_refused(tmp_path: Path) -> None:
    """Its stiffness would vanish at a load, and a frequency pass through infinity there."""
    pressed = SHEAR | {"W_c": "P * integral(psi ** 2) / 2"}
    with pytest.raises(fb.InputError, match="the load multiplies in no product with itself"):
        fb.column(file_of(tmp_path, "pressed", pressed))


@pytest.mark.parametrize("seed", range(3))
def test_growth_to_first_order_is_that_of_little_damping(seed: int) -> None:
    """Of symmetric M and K, and of any C, two coordinates without mass: the signs of dense eigenvalues with ε C."""
    rng, little = np.random.default_rng(seed), 1e-6
    M, A = np.diag([1.0, 2.0, 3.0, 0.0, 0.0]), rng.normal(size=(5, 5))
    K, C = A @ A.T + np.eye(5), rng.normal(size=(5, 5)) + np.eye(5)
    none, one = np.zeros((5, 5)), np.eye(5)
    found, _, growth = General([M], [C], [K, none], vanishing=True).branches(1.0)
    values = eigvals(np.block([[none, one], [-K, -little * C]]), np.block([[one, none], [none, M]]))
    values = values[np.isfinite(values)]
    has_mass = np.abs(found) < 1e3
    assert has_mass.sum() == 3
    for each, grows in zip(found[has_mass], growth[has_mass], strict=True):
        near = values[np.abs(values - 1j * abs(each)).argmin()]
        assert np.sign(near.real) == np.sign(grows)
    alone = values[np.abs(values) > 1e3]  # of the two without mass, −1/ε times something
    assert sorted(np.sign(alone.real)) == sorted(np.sign(growth[~has_mass]))
