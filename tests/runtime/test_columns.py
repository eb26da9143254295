"""Columns and systems as the user asks for them: lookup, parameters, matrices, bad input, SI units."""

from __future__ import annotations

import math
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import freebeam as fb
import freebeam_sym
from freebeam import cli

NAMES = ("free-free", "beck", "euler-pinned")


def refused(call: Any, *words: str) -> str:
    """The message of the InputError that `call` must raise: one line that holds these words."""
    with pytest.raises(fb.InputError) as caught:
        call()
    message = str(caught.value)
    assert "\n" not in message and len(message) < 300
    for word in words:
        assert word in message
    return message


# Lookup


def test_each_listed_name_gives_the_column_of_that_name() -> None:
    assert set(NAMES) <= set(freebeam_sym.column_names()) <= set(fb.column_names())
    for name in freebeam_sym.column_names():
        column = fb.column(name, "modes")
        assert column.name == name and column.title
        assert fb.column(name, "modes") is column


@pytest.mark.parametrize(
    ("name", "near"), [("free-fre", "free-free"), ("Beck", "beck"), ("euler_pinned", "euler-pinned")]
)
def test_a_near_miss_is_named(name: str, near: str) -> None:
    refused(lambda: fb.column(name, "modes"), repr(name), f"did you mean {near}?", "`freebeam columns` lists")
    refused(lambda: freebeam_sym.columns.column(name), f"did you mean {near}?", *freebeam_sym.column_names())


@pytest.mark.parametrize("name", ["", "wing", "a\nb", "x" * 5000])
def test_an_unknown_column_is_refused_with_those_there_are(name: str) -> None:
    there = f"there are {len(fb.column_names())}, which `freebeam columns` lists"
    assert "did you mean" not in refused(lambda: fb.column(name, "modes"), there)
    assert "did you mean" not in refused(lambda: freebeam_sym.columns.column(name), *freebeam_sym.column_names())


@pytest.mark.parametrize("name", NAMES)
def test_ends_decide_the_number_of_rigid_functions(name: str) -> None:
    """The rigid motions c₀ + c₁x are those that the geometric conditions at both ends leave free."""
    column = fb.column(name, "modes")
    rows = {"free": [], "pinned": [(1, 0)], "sliding": [(0, 1)], "clamped": [(1, 0), (0, 1)]}
    held = [(d, x) for x, end in enumerate(column.ends) for d in rows[end]]
    conditions = [[c, c * x + s] for (c, s), x in held]
    assert column.rigid_count == 2 - (np.linalg.matrix_rank(conditions) if conditions else 0)


# Parameters


def test_own_parameters_default_and_override() -> None:
    beck = fb.column("beck", "modes")
    assert {p.name: p.default for p in beck.parameters} == beck.system().parameters
    assert beck.system(eta=0.25).parameters == {"eta": 0.25}
    assert not fb.column("free-free", "modes").parameters


def test_the_load_matrix_is_affine_in_the_follower_share() -> None:
    H = {eta: fb.column("beck", "modes").system(6, eta=eta).H for eta in (0.0, 0.3, 1.0)}
    np.testing.assert_allclose(H[0.3], 0.7 * H[0.0] + 0.3 * H[1.0], rtol=0, atol=1e-13 * np.abs(H[1.0]).max())
    # a dead load has a potential, a follower has none
    np.testing.assert_allclose(H[0.0], H[0.0].T, rtol=0, atol=1e-13 * np.abs(H[0.0]).max())
    assert np.abs(H[1.0] - H[1.0].T).max() > 1
    assert fb.column("beck", "modes").system(6).H.tolist() == H[1.0].tolist()


@pytest.mark.parametrize("call", ["system", "critical_load"])
def test_unknown_and_meaningless_parameters_are_refused(call: str) -> None:
    def ask(name: str, **given: Any) -> Any:
        column = fb.column(name, "modes")
        return lambda: column.system(**given) if call == "system" else fb.critical_load(column, **given)

    refused(ask("beck", et=1.0), "et: ", "eta")
    refused(ask("free-free", eta=1.0), "eta: ", "none")
    for value in (math.nan, math.inf, "much", True, 1j, None):
        refused(ask("beck", eta=value), "eta = ")


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"load": math.nan}, "load = nan"),
        ({"load": -math.inf}, "load = -inf"),
        ({"load": "50"}, "load = '50'"),
        ({"alpha": -1e-9}, "alpha = -1e-09"),
        ({"alpha": math.nan}, "alpha = nan"),
        ({"beta": -0.1}, "beta = -0.1"),
        ({"beta": math.inf}, "beta = inf"),
        ({"beta": 1j}, "beta = 1j"),
    ],
)
def test_loads_and_dampings_without_meaning_are_refused(given: dict[str, Any], words: str) -> None:
    refused(lambda: fb.column("free-free", "modes").system(**given), words)


@pytest.mark.parametrize("modes", [0, -3, 8.0, np.float64(8), 8.5, True, False, "8", 10**9, math.nan])
def test_a_number_of_modes_is_a_whole_number_that_memory_has_room_for(modes: Any) -> None:
    column = fb.column("free-free", "modes")
    for kept in (1, 8):  # what is kept from earlier calls must not let its look-alikes pass
        column.system(kept)
    for call in (column.system, column.matrices, column.basis):
        refused(lambda call=call: call(modes), "modes = ")


def test_any_kind_of_number_will_do() -> None:
    column = fb.column("beck", "modes")
    plain = column.system(8, load=0.5, alpha=0.25, beta=2.0, eta=0.5)
    other = column.system(np.int64(8), load=Fraction(1, 2), alpha=np.float32(0.25), beta=2, eta=np.array(0.5))
    for matrix in "MCKEH":
        assert getattr(plain, matrix).tolist() == getattr(other, matrix).tolist()


# Systems


@settings(max_examples=60, deadline=None, derandomize=True)
@given(
    name=st.sampled_from(NAMES),
    modes=st.integers(1, 20),
    load=st.floats(-200, 200),
    alpha=st.floats(0, 10),
    beta=st.floats(0, 100),
    rigid=st.booleans(),
    eta=st.floats(-0.5, 1.5),
)
def test_system_identities(
    name: str, modes: int, load: float, alpha: float, beta: float, rigid: bool, eta: float
) -> None:
    """K = E + P H and C = βM + αE, Eq. (12), from systems at other loads and dampings."""
    own = {"eta": eta} if name == "beck" else {}
    column = fb.column(name, "modes")
    system = column.system(modes, load, alpha, beta, rigid, **own)
    n = modes + (column.rigid_count if rigid else 0)
    unloaded, unit = (column.system(modes, P, rigid=rigid, **own).K for P in (0.0, 1.0))
    internal, external = (column.system(modes, 0.0, *pair, rigid=rigid, **own).C for pair in ((1, 0), (0, 1)))
    assert system.K.shape == system.C.shape == system.Q(0.3).shape * 2 == (n, n)
    scale = np.abs(unloaded).max() + 200 * np.abs(unit - unloaded).max()
    np.testing.assert_allclose(system.K, unloaded + load * (unit - unloaded), rtol=0, atol=1e-13 * scale)
    np.testing.assert_allclose(system.C, alpha * internal + beta * external, rtol=1e-13, atol=0)
    np.testing.assert_allclose(external, system.M, rtol=1e-15)
    np.testing.assert_allclose(internal, unloaded, rtol=1e-15)
    assert (system.modes, system.load, system.alpha, system.beta) == (modes, load, alpha, beta)
    assert system.rigid_count == n - modes and len(system.gamma) == modes


@pytest.mark.parametrize("name", NAMES)
def test_symmetric_matrices_are_positive_definite_on_the_elastic_functions(name: str) -> None:
    system = fb.column(name, "modes").system(20, rigid=True)
    r = system.rigid_count
    for matrix in (system.M, system.E):
        assert matrix.tolist() == matrix.T.tolist()
    assert np.linalg.eigvalsh(system.M).min() > 0
    assert np.linalg.eigvalsh(system.E[r:, r:]).min() > 0
    assert not system.E[:r].any()  # a rigid motion bends nothing


@pytest.mark.parametrize("rigid", [False, True])
@pytest.mark.parametrize("name", NAMES)
def test_a_unit_force_works_on_the_deflection_where_it_acts(name: str, rigid: bool) -> None:
    system = fb.column(name, "modes").system(7, rigid=rigid)
    for x in (0, 0.25, 1):
        np.testing.assert_array_equal(system.Q(x), system.shapes(x))


def test_shapes_take_places_of_any_shape() -> None:
    system = fb.column("free-free", "modes").system(5, rigid=True)
    x = np.linspace(0, 1, 12).reshape(3, 4)
    whole = system.shapes(x, 2)
    assert whole.shape == (7, 3, 4) and system.shapes(0.5).shape == (7,)
    for k in np.ndindex(x.shape):
        # sums of few terms may be ordered otherwise for one place than for many
        np.testing.assert_allclose(whole[(slice(None), *k)], system.shapes(x[k], 2), rtol=1e-12, atol=1e-10)


def test_rigid_functions_come_first() -> None:
    column = fb.column("free-free", "modes")
    whole, elastic = column.system(6, 40.0, 1e-3, 0.2, rigid=True), column.system(6, 40.0, 1e-3, 0.2)
    x = np.linspace(0, 1, 5)
    np.testing.assert_allclose(whole.shapes(x, 2)[:2], 0, atol=1e-15)
    np.testing.assert_array_equal(whole.shapes(x)[2:], elastic.shapes(x))
    for matrix in "MCKEH":
        np.testing.assert_array_equal(getattr(whole, matrix)[2:, 2:], getattr(elastic, matrix))
    np.testing.assert_array_equal(whole.gamma, elastic.gamma)


def test_what_is_shared_cannot_be_written_to() -> None:
    """Matrices and modes are kept for later systems; one who writes to his copy must not change another's."""
    column = fb.column("beck", "modes")
    system = column.system(9, 3.0, 0.1, 0.1)
    vectors = [field for field in system.basis if isinstance(field, np.ndarray)]
    assert len(vectors) > 3
    for array in (*column.matrices(9), system.M, system.E, system.H, system.gamma, *vectors):
        assert not array.flags.writeable
    before = column.system(9, 3.0, 0.1, 0.1)
    system.K[...], system.C[...] = 0, 0  # the system's own
    after = column.system(9, 3.0, 0.1, 0.1)
    assert after.K.tolist() == before.K.tolist() and after.C.tolist() == before.C.tolist() and after.K.any()


def test_the_cache_keeps_parameters_apart() -> None:
    column = fb.column("beck", "modes")
    first = column.system(5, 1.0, eta=0.25).K
    for k in range(100):  # more than are kept
        column.system(5, 1.0, eta=k / 100)
    assert column.system(5, 1.0, eta=0.25).K.tolist() == first.tolist()
    assert column.system(5, 1.0, eta=0.26).K.tolist() != first.tolist()


@pytest.mark.parametrize("x", [-1e-9, 1.0000001, math.nan, math.inf, "tip", True, None, [0.1, 0.2]])
def test_a_force_off_the_beam_is_refused(x: Any) -> None:
    refused(lambda: fb.column("free-free", "modes").system().Q(x), "x_F")


# SI units, Eq. (5)


@settings(max_examples=40, deadline=None, derandomize=True)
@given(name=st.sampled_from(NAMES), EI=st.floats(1e-3, 1e9), m=st.floats(1e-3, 1e4), L=st.floats(1e-2, 1e3))
def test_scales_are_a_coherent_system_of_units(name: str, EI: float, m: float, L: float) -> None:
    """Any three independent quantities fix the rest by their dimensions: here length, time and load."""
    unit = fb.column(name, "modes").kernel.scales(EI, m, L)
    length, time, load = unit["length"], unit["time"], unit["load"]
    mass = load * time**2 / length
    expected = {
        "force": load,
        "alpha": time,  # strain rate times alpha is a strain
        "beta": mass / length / time,  # beta times velocity is a force per length
        "frequency": 1 / time,
        "velocity": length / time,
        "acceleration": length / time**2,
        "energy": load * length,
    }
    assert set(unit) == {"length", "time", "load", *expected}
    for quantity, value in expected.items():
        assert unit[quantity] == pytest.approx(value, rel=1e-12)
    # and the three measures of the beam are all 1 in these units
    assert length == L
    assert EI / (load * length**2) == pytest.approx(1, rel=1e-12)
    assert m / (mass / length) == pytest.approx(1, rel=1e-12)


def test_euler_load_and_first_frequency_of_a_steel_rod_in_newton_and_hertz() -> None:
    """Textbook formulas in SI: π²EI/L² and (π/2) √(EI/m)/L² hertz for a pinned rod."""
    radius, L = 0.005, 1.2
    EI, m = 210e9 * math.pi * radius**4 / 4, 7850 * math.pi * radius**2
    column = fb.column("euler-pinned", "modes")
    unit = column.kernel.scales(EI, m, L)
    load = fb.critical_load(column, modes=4).load * unit["load"]
    first = min(v for v in fb.spectrum(column.system(4)).eigenvalues.imag if v > 0)
    hertz = first * unit["frequency"] / (2 * math.pi)
    assert load == pytest.approx(math.pi**2 * EI / L**2, rel=1e-12)
    assert hertz == pytest.approx(math.pi / 2 * math.sqrt(EI / m) / L**2, rel=1e-12)


# --- the front door -------------------------------------------------------------------------------------------


def test_what_is_no_column_or_system_is_refused() -> None:
    beck = fb.column("beck")
    for ask in (fb.critical_load, fb.critical_loads, fb.eigenvalues, fb.certified_load, fb.exact_load):
        refused(lambda ask=ask: ask("beck"), "column = 'beck'", "fb.column(")
    refused(lambda: fb.branches("beck", [1, 2]), "column = 'beck'")
    refused(lambda: fb.stability_map("beck", alpha=[1, 2]), "column = 'beck'")
    refused(lambda: fb.trace_boundary("beck", "eta", 0, 1), "column = 'beck'")
    for ask in (fb.spectrum, lambda x: fb.respond(x, 1, 0.1), lambda x: fb.state_space(x, 1.0)):
        refused(lambda ask=ask: ask(beck), "system = Column", ".system(")
    refused(lambda: fb.critical_load(beck, N=8), "N: beck has no such parameter", "did you mean modes?")


def test_scalars_and_arrays_refuse_alike() -> None:
    """What `critical_load` refuses in a place, `critical_loads` refuses there in an array."""
    beck = fb.column("beck")
    dates = np.datetime64("2001-01-01"), np.timedelta64(1, "s")
    for value in ("1", b"1", True, np.True_, 1j, None, math.nan, math.inf, 10**400, -1.0, 1e60, *dates):
        refused(lambda v=value: fb.critical_load(beck, alpha=v), "alpha")
        refused(lambda v=value: fb.critical_loads(beck, alpha=[0.5, v]), "alpha")
    masked = np.ma.array([0.5, 1.0], mask=[False, True])
    for ask in (lambda x: fb.critical_loads(beck, alpha=x), lambda x: fb.eigenvalues(beck, load=x)):
        refused(lambda ask=ask: ask(masked), "masked")


def test_a_system_prints_in_a_few_lines_what_it_is() -> None:
    text = repr(fb.column("beck").system(modes=40, load=5, eta=0.7))
    assert len(text) < 200 and all(word in text for word in ("beck", "N=40", "load=5", "eta=0.7", "(40, 40)"))


def test_dir_shows_public_names_alone() -> None:
    assert set(dir(fb)) == {*fb.__all__, "figures"}


def test_a_range_of_interest_is_no_limit(capsys: pytest.CaptureFixture[str]) -> None:
    (eta,) = fb.column("beck").parameters
    assert fb.critical_load(fb.column("beck"), eta=eta.high + 1).kind != "none"
    assert cli.main(["columns"]) == 0
    assert "any value may be set" in capsys.readouterr().out
