"""The exact system of any column in balls: its steps, its characteristic function, and what is proven with it.

    PYTHONPATH=. python -m tests.certify.test_exact_system

encloses the loads of all columns of the literature, of which the tests take those that differ in kind.
"""

from __future__ import annotations

import json
import math
from fractions import Fraction
from functools import cache
from itertools import permutations
from pathlib import Path
from tempfile import TemporaryDirectory
from types import ModuleType
from typing import Any

import numpy as np
import pytest
from flint import acb, arb
from sympy import Expr, Rational, Symbol, cos, cosh, exp, pi, sin, sinh, sqrt, tan

import freebeam as fb
from freebeam.cli import main
from freebeam_derive import emit, pipeline, statement, verify
from freebeam_derive.bases import segments
from freebeam_derive.certify import beam_itself, beam_stability
from freebeam_derive.certify.balls import Unproven, ends, precision
from freebeam_derive.certify.beam import Beam, NoSeries
from freebeam_derive.certify.exact_system import ExactSystem, _some
from freebeam_derive.certify.taylor_steps import Jets, Local, Segment, Term
from freebeam_derive.notation import P, alpha, beta, t, x, y
from freebeam_derive.statement import Column, Parameter, at, delta, integral
from freebeam_sym.columns import Column as RuntimeColumn
from freebeam_sym.columns import column as runtime_column
from tests.derive.test_language import FOLLOWER, HALF, beck, turning, ziegler
from tests.reference.values import ISSUE, OWN, Value
from tests.stated import STATED, file_of, stated

NONE = Fraction(0)
c = Symbol("c", real=True)
FREE = "free-free with a point mass"


def emitted(column: Column) -> ModuleType:
    """The kernel of a column as one beyond the textbook's, whatever it is."""
    found = pipeline.general(column)
    return verify.load(emit.emit(segments.kernel_of(column, found.system, found.motion)), column.name)


@cache
def of_literature(name: str) -> tuple[ModuleType, dict[str, Fraction]]:
    with TemporaryDirectory() as folder:
        path, asked = stated(Path(folder), name)
        return emitted(statement.load_column(path)), {k: Fraction(str(v)) for k, v in asked.items()}


@cache
def of_textbook(name: str) -> ModuleType:
    return emitted(statement.load_column(statement.columns()[name]))


def near(kernel: ModuleType, value: Value, asked: dict[str, Fraction]) -> float:
    """The frequency at a load, of sixteen functions a segment: of the two closest, or of the least decay."""
    column = RuntimeColumn(kernel)
    M, C, K = column.coefficients(16, False, **{k: float(v) for k, v in asked.items()}).at(float(value.printed))
    if value.kind == "coalescence":
        squares = np.sort_complex(np.linalg.eigvals(np.linalg.solve(M, K)))[:8]
        n = int(np.abs(np.diff(squares) / squares[:-1]).argmin())
        return math.sqrt(squares[n].real)
    n = len(M)
    A = np.block([[np.zeros((n, n)), np.eye(n)], [-np.linalg.solve(M, K), -np.linalg.solve(M, C)]])
    values = [v for v in np.linalg.eigvals(A) if v.imag > 1e-6]
    return float(min(values, key=lambda v: abs(v.real)).imag)


@pytest.mark.parametrize("dampings", [(NONE, NONE), (Fraction(1, 100), Fraction(1, 10))])
def test_slopes_of_p_and_s_are_those_of_differences(dampings: tuple[Fraction, Fraction]) -> None:
    """Of a uniform beam p = P/(1 + αλ) and s = −(λ² + βλ)/(1 + αλ); of any column the load is p, and s −λ² or −λ."""
    column = of_literature("beck")[0]
    with precision(300):
        h, P, value = arb(2) ** -100, arb(3), acb("0.3", "2")
        for of in (Beam(runtime_column("beck").kernel), ExactSystem(column, None, *dampings)):
            p, s, by_p, by_s, by_load = of.pencil(P, value, *dampings)
            after, load = of.pencil(P, value + h, *dampings), of.pencil(P + h, value, *dampings)
            for slope, off in ((by_p, after[0] - p), (by_s, after[1] - s), (by_load, load[0] - p)):
                assert abs(acb(off) / h - acb(slope)) < 1e-25


def enclosed(kernel: ModuleType, value: Value, asked: dict[str, Fraction], digits: int) -> beam_itself.ExactCrossing:
    system = ExactSystem(kernel, None, asked.get("alpha", NONE), asked.get("beta", NONE))
    load = float(value.printed)
    if value.kind == "divergence":
        return beam_itself.divergence(system, load, digits)
    start = load, near(kernel, value, asked)
    if value.kind == "coalescence":
        return beam_itself.flutter_undamped(system, start, digits)
    return beam_itself.flutter_damped(system, NONE, NONE, start, digits)


# ------------------------------------------------------------ values of the literature

VALUES = [v for v in (*ISSUE, *OWN) if v.name in STATED and v.name not in ("beal, sensor at 0", "beal, sensor at 1/2")]
ALIKE = {  # of a kind with one that is tested
    "cone", "pflueger", "pflueger, beam damped", "tip spring 10", "tip spring 35", "beal, sensor at 1", "weight",
    "hauger", "elastic hinge at mid-span", "panel, pinned", "panel, cantilevered", "panel, clamped at its rear",
    "euler, clamped", "euler, cantilever", "euler, pinned", "gravity", "exponential taper",
    "timoshenko, s = 100, r = 1/100, turning with ψ", "timoshenko, s = 1000, r = 1/1000, turning with y'",
}  # fmt: skip


@pytest.mark.parametrize("value", [v for v in VALUES if v.name not in ALIKE], ids=lambda value: value.name)
def test_an_enclosure_is_where_independent_codes_find_the_load(value: Value) -> None:
    kernel, asked = of_literature(value.name)
    digits = len(value.printed) + 2
    found = enclosed(kernel, value, asked, digits)
    low, high = ends(found.load)
    half = Fraction(1, 2 * 10**value.places)
    assert Fraction(value.printed) - half <= low <= high <= Fraction(value.printed) + half
    assert high - low < low / 10**digits
    assert found.kind == ("divergence" if value.kind == "divergence" else "flutter")
    assert (found.proof.crossing, found.proof.kind, found.proof.first, found.proof.stable_below) == (
        True,
        True,
        False,
        False,
    )


def test_the_parameters_may_be_given() -> None:
    """Pflüger's column without its mass is Beck's."""
    kernel, _ = of_literature("pflueger")
    found = beam_itself.flutter_undamped(ExactSystem(kernel, {"mu": NONE}), (20.05, 11.0), 30)
    same = beam_itself.flutter_undamped(ExactSystem(of_literature("beck")[0]), (20.05, 11.0), 30)
    assert found.load.overlaps(same.load)


def test_a_damping_of_zero_is_none_whatever_function_of_x_it_multiplies() -> None:
    """Else what has no rate would be sought as if it had one, at a load where two frequencies meet."""
    kernel = emitted(statement.load_column(statement.gallery()["exponential-taper"]))
    assert ExactSystem(kernel).undamped(NONE, NONE)
    assert not ExactSystem(kernel, None, Fraction(1, 100)).undamped(NONE, NONE)


@pytest.mark.parametrize(
    ("name", "near", "dampings"),
    [
        ("beck", (20.05, 11.02), (NONE, NONE)),
        ("beck", (17.86, 8.4), (Fraction(1, 100), Fraction(1, 10))),
        ("free_free", (109.69, 23.07), (NONE, NONE)),
        ("free_free", (90.84, 11.95), (Fraction(1, 1000), Fraction(1, 10))),
        ("euler_pinned", (9.87,), (NONE, NONE)),
        ("euler_pinned", (9.87,), (Fraction(1, 100), Fraction(1, 10))),
    ],
)
def test_a_textbook_column_has_the_load_that_power_series_enclose(
    name: str, near: tuple[float, ...], dampings: tuple[Fraction, Fraction]
) -> None:
    """Two ways that share Krawczyk's method alone: power series on the whole beam, and Taylor steps."""
    known = {column.stem: column for column in statement.columns().values()}
    column = statement.load_column(known[name])
    textbook, system = Beam(runtime_column(column.name).kernel), ExactSystem(emitted(column), None, *dampings)
    both = []
    for beam in (textbook, system):
        if len(near) == 1:
            both.append(beam_itself.divergence(beam, near[0], 30))
        elif dampings == (NONE, NONE):
            both.append(beam_itself.flutter_undamped(beam, near, 30))
        else:
            both.append(beam_itself.flutter_damped(beam, *dampings, near, 30))
    one, other = both
    assert one.load.overlaps(other.load) and one.frequency.overlaps(other.frequency)
    assert max(one.load.rad(), other.load.rad()) < one.load * 1e-30


@pytest.mark.parametrize("s", [10**4, 10**5])
def test_a_stiff_timoshenko_beam_is_becks_column_to_first_order(s: int) -> None:
    """Its load is below Beck's by a multiple of 1/s, shear stiffness s and rotary inertia 1/s."""
    kernel, _ = of_literature("timoshenko, s = 1000, r = 1/1000, turning with ψ")
    beck_load = beam_itself.flutter_undamped(ExactSystem(of_literature("beck")[0]), (20.05, 11.0), 20).load
    start = 20.0509536 - 831.6 / s, 11.0
    found = beam_itself.flutter_undamped(ExactSystem(kernel, {"k": Fraction(s), "b": Fraction(1, s)}), start, 15)
    assert float((beck_load - found.load) * s) == pytest.approx(831.6, rel=60 / s**0.99)


def test_internal_damping_does_not_move_a_divergence() -> None:
    """The rigid motions of a free column are then a factor λ⁴ of F, two of λ² each, which is struck out."""
    column = beck(
        ends=("free", "free"),
        T=(integral(y.diff(t) ** 2) + at(y.diff(t), 0) ** 2 / 2) / 2,
        W_c=P * integral((x + HALF) * y.diff(x) ** 2) / 3,
        dW_nc=FOLLOWER - integral(alpha * y.diff(x, 2, t) * delta(y.diff(x, 2))),
    )
    system = ExactSystem(emitted(column), None, Fraction(1, 100))
    found, still = (beam_itself.divergence(s, 45.45, 20) for s in (system, ExactSystem(of_literature(FREE)[0])))
    with precision(96):
        assert system.rigid == 2 and system.trivial() == 4 and still.load.overlaps(found.load)


@pytest.mark.parametrize(
    ("stiffness", "same"),
    [
        ((4 - 4 * x + x**2) / (2 - x), 2 - x),
        (cosh(x) + sinh(x), exp(c * x)),
        ((sin(x) ** 2 + cos(x) ** 2) * (2 + tan(x)), 2 + sin(x) / cos(x)),
        (sqrt(2) ** 2 * exp(-x / 3), 2 / exp(x / 3)),
    ],
)
def test_functions_of_x_are_what_they_are(stiffness: Expr, same: Expr) -> None:
    """Written otherwise, as a quotient, with a parameter or by another function, they give the same F."""
    own = (Parameter(c, "c", 1.0, 0.0, 2.0),)
    columns = [beck(V=integral(EI * y.diff(x, 2) ** 2) / 2, dW_nc=FOLLOWER, parameters=own) for EI in (stiffness, same)]
    with precision(96):
        one, other = (ExactSystem(emitted(column)).taylor(arb(9), arb(30), ((0, 0),))[0, 0] for column in columns)
        assert one.overlaps(other) and one.rad() < 1e-18 * abs(one)


def test_places_and_factors_are_to_be_exact() -> None:
    """Places are fractions from 0 to 1, and a factor in floats one of few bits."""
    them: Any = object.__new__(ExactSystem)
    them.name, them.own = "it", {}
    assert them._fractions(lambda one: (0 * one, one / 3, 1)) == (0, Fraction(1, 3), 1)
    for places, message in (
        ((Fraction(4, 3),), "the place 1.33333 is no fraction from 0 to 1"),
        ((Fraction(-1, 3),), "the place -0.333333 is no fraction"),
        ((0.5,), "the place 0.5 is no fraction"),
    ):
        with pytest.raises(NoSeries, match=message):
            them._fractions(lambda one, places=places: places)
    with pytest.raises(NoSeries, match="places are not to be had as fractions"):
        them._fractions(lambda one: (one ** Fraction(1, 2) @ one,))
    with precision(64):
        assert them._ball(2.0**-20) == arb(2) ** -20 and them._ball(arb(1) / 3).overlaps(arb(1) / 3)
        for value in (0.1, 2.0**-21):
            with pytest.raises(NoSeries, match="is a rounded number, not an exact one"):
                them._ball(value)


def test_a_factor_is_some_unless_it_is_known_to_be_nothing() -> None:
    with precision(64):
        for factor, some in (
            (0, False), (arb(0), False), (arb(0, 1), True), (1, True), ((0, 0), False), ((0, arb(0), 2), True),
            ((0, arb(0, 1e-9)), True),
            (lambda x: 0 * x, False), (lambda x: 1 + 0 * x, True), (lambda x: x, True),
        ):  # fmt: skip
            assert _some(factor) == some


def test_coordinates_alone_have_a_characteristic_polynomial() -> None:
    """Ziegler's double pendulum, masses 2 : 1, undamped: 7/2 − √2."""
    found = beam_itself.flutter_undamped(ExactSystem(emitted(ziegler())), (2.08, 0.84), 40)
    with precision(300):
        assert found.load.contains(arb(7) / 2 - arb(2).sqrt())


# ------------------------------------------------------------ the characteristic function


def test_balls_hold_what_points_give() -> None:
    """Loads and s in balls about zero, where a factor is not known to be anything."""
    kernel, asked = of_literature("absorber")
    system = ExactSystem(kernel, None, asked["alpha"], asked["beta"])
    orders = ((0, 0), (1, 0), (0, 1))
    with precision(96):
        wide = system.taylor(arb(0, 0.01), acb(arb(0, 0.01), arb(0, 0.01)), orders)
        for P, s in ((0.01, acb(0.01, -0.01)), (-0.01, acb(-0.01, 0.01)), (0.004, acb(0, 0.01)), (0, acb(0, 0))):
            at_point = system.taylor(arb(P), s, orders)
            assert all(wide[order].contains(at_point[order]) for order in orders)


@pytest.mark.parametrize(("name", "P", "s"), [("crack", 15, 70), ("pipe on a foundation", 8, 5), ("absorber", 15, -7)])
def test_derivatives_are_those_of_the_function(name: str, P: int, s: int) -> None:
    """Its Taylor polynomial of third order is off by the fourth power of the distance."""
    kernel, asked = of_literature(name)
    system = ExactSystem(kernel, None, asked.get("alpha", NONE), asked.get("beta", NONE))
    orders = tuple((i, j) for i in range(4) for j in range(4) if i + j < 4)
    errors = []
    with precision(160):
        about = system.taylor(arb(P), arb(s), orders)
        for k in (6, 7):
            u = arb(2) ** -k
            there = system.taylor(P + u, s + u, ((0, 0),))[0, 0]
            errors.append(float(there - sum(about[i, j] * u ** (i + j) for i, j in orders)))
    assert errors[0] / errors[1] == pytest.approx(16, rel=0.1)


def test_a_determinant_is_that_of_leibniz_where_rank_is_lost() -> None:
    """Of rank 2 in its constant terms, of five."""
    with precision(128):
        jets = Jets(arb(1), arb(2), tuple((i, j) for i in range(3) for j in range(4)), is_complex=False)
        count, size = 5, len(jets.orders)
        numbers = np.random.default_rng(5).integers(-9, 10, (count, count, size)).tolist()
        for i in range(count):
            for j in range(count):
                numbers[i][j][0] = (i + 1) * (j + 2) + (i % 2) * (j**2)
        rows = [{j: [arb(v) / 3 for v in jet] for j, jet in enumerate(row)} for row in numbers]
        total = [arb(0)] * size
        for order in permutations(range(count)):
            sign = round(np.linalg.det(np.eye(count)[list(order)]))
            value = [sign * v for v in jets.one]
            for i, j in enumerate(order):
                value = jets.times(value, rows[i][j])
            total = [a + b for a, b in zip(total, value, strict=True)]
        found = jets.determinant(rows)
        assert all(a.overlaps(b) and a.rad() < 1e-20 for a, b in zip(found, total, strict=True))
        assert all(abs(v) < 1e-20 for (i, j), v in zip(jets.orders, found, strict=True) if i + j < 3)
        assert any(abs(v) > 1 for v in found)


# ------------------------------------------------------------ the bound of a step

LEADS = Term(0, 0, 1, 0, 0, [1])  # z' of a field of first order
STEPS = {  # terms of equations whose solutions grow about as fast as the bound lets them, orders, P
    "z' = 5 z": ([LEADS, Term(0, 0, 0, 0, 0, [-5])], [1], 1),
    "z' = P z": ([LEADS, Term(0, 0, 0, 0, 1, [-1])], [1], 3),
    "z' = x³ z": ([LEADS, Term(0, 0, 0, 0, 0, [0, 0, 0, -1])], [1], 1),
    "(1 − x) z' = 50 z": ([Term(0, 0, 1, 0, 0, [1, -1]), Term(0, 0, 0, 0, 0, [-50])], [1], 1),
    "e^(−x) z' = (1 + 500 x) z": (
        [Term(0, 0, 1, 0, 0, lambda x: np.exp(-x)), Term(0, 0, 0, 0, 0, [-1, -500])],
        [1],
        1,
    ),
    "10⁶ y'' = y": ([Term(0, 0, 2, 0, 0, [10**6]), Term(0, 0, 0, 0, 0, [-1])], [2], 1),
    "bending": (
        [Term(0, 0, 4, 0, 0, [1, -1, 0.25]), Term(0, 0, 2, 0, 1, [1]), Term(0, 0, 0, 1, 0, [1])],
        [4],
        20,
    ),
}
RADII = [Fraction(math.ceil(64 * size), 64) for size in (*(2.0 ** (k / 2) for k in range(-12, 13)), 0.45)]


@pytest.mark.parametrize("name", STEPS)
def test_what_a_step_leaves_out_is_within_its_bound(name: str) -> None:
    """Steps of few terms, with discs of many sizes, hold what many fine steps at a higher precision give."""
    terms, sizes, P = STEPS[name]
    jets = Jets(arb(P), arb(70), ((0, 0), (1, 0), (0, 1)), is_complex=callable(terms[0].factor))
    segment = Segment(terms, sizes, jets)
    sharpest = 0.0
    for radius in RADII:
        reach, disc = radius / 64, arb(float(radius))
        with precision(400):
            local = Local(segment, NONE)
            size = local.size(disc)
            if size is None:
                continue
            fine = segment.start()
            for n in range(4):
                fine = segment.carry(reach * n / 4, reach * (n + 1) / 4, fine)
            for count in (1, 2, 5, 20, 50):
                coarse = local.step(reach, disc, count)
                assert all(a.contains(b) for a, b in zip(coarse.entries(), fine.entries(), strict=True)), (
                    count,
                    radius,
                )
                bound = local.remainder(size, disc, arb(float(reach)), count)
                sharpest = max(sharpest, float((abs(coarse.entries()[0].mid() - fine.entries()[0]) / bound).mid()))
    if name == "z' = 5 z":
        assert sharpest > 0.2  # so that a bound of one order less, or of half the radius, does not hold


def test_a_polynomial_beside_a_function_is_bounded_on_the_disc() -> None:
    """f z' = 2 x z with f = 1, a function: |2 x| reaches 2 r on a disc of radius r; the bound is below 4 r."""
    terms = [Term(0, 0, 1, 0, 0, lambda x: 1 + 0 * x), Term(0, 0, 0, 0, 0, [0, -2])]
    with precision(64):
        local = Local(Segment(terms, [1], Jets(arb(1), arb(1), ((0, 0),), is_complex=True)), Fraction(0))
        for r in (0.25, 1, 8):
            size = local.size(arb(r))
            assert size is not None and 2 * r <= size < 4 * r


def test_a_plan_keeps_the_precision() -> None:
    """Whatever disc and step are chosen, the balls are of the size of rounding."""
    kernel, _ = of_literature("cone")
    for bits in (64, 256, 1024):
        with precision(bits):
            F = ExactSystem(kernel).taylor(arb(6), arb(60), ((0, 0),))[0, 0]
            assert F.rad() < abs(F) * arb(2) ** (40 - bits)


def test_high_frequencies_are_reached() -> None:
    """λ = iω far up: of Beck's column without load the frequencies are those of cos γ cosh γ = −1."""
    system = ExactSystem(of_literature("beck")[0])
    gamma = math.pi * 59.5  # to all digits of a float
    (found,) = beam_itself.frequencies(system, NONE, NONE, NONE, [complex(0, gamma**2)], 15)
    assert float(found.imag) == pytest.approx(gamma**2, rel=1e-12)


# ------------------------------------------------------------ spectra


@pytest.mark.parametrize("dampings", [{}, {"alpha": "1/100", "beta": "1/10"}])
def test_a_spectrum_is_that_of_the_textbook(dampings: dict[str, str]) -> None:
    own = RuntimeColumn(of_textbook("beck"))
    (one, other) = (fb.exact_spectrum(c, 10, modes=3, digits=25, **dampings) for c in (own, fb.column("beck")))
    assert not one.unproven and len(one.lower) == len(other.lower) == 6
    for low, high, theirs in zip(one.lower, one.upper, other.lower, strict=True):
        for part in range(2):
            assert Fraction(low[part]) - Fraction(1, 10**20) <= Fraction(theirs[part]) <= Fraction(high[part])


def test_a_spectrum_of_a_gyroscopic_column_holds_the_ritz_values() -> None:
    column = RuntimeColumn(of_literature("pipe")[0])
    found = fb.exact_spectrum(column, 4, modes=4, digits=20)
    values = [complex(v) for v in fb.spectrum(column.system(20, 4)).eigenvalues]
    assert not found.unproven
    for low in found.lower:
        value = complex(*map(float, low))
        assert min(abs(value - v) for v in values) < 1e-7 * abs(value)


# ------------------------------------------------------------ from the front door


def test_an_exact_load_is_asked_for_as_any(tmp_path: Path) -> None:
    found = fb.exact_load(RuntimeColumn(of_literature("pflueger")[0]), digits=30, modes=12)
    assert found.load is not None and found.load[0].startswith("16.2121289424952617864363367849")
    assert dict(found.proof) == dict.fromkeys(("crossing", "kind", "first", "stable_below"), True)
    assert found.inputs["mu"] == "1.0 (default)"
    cracked = fb.exact_load(RuntimeColumn(of_literature("crack")[0]), digits=10, modes=12)
    assert all(cracked.proof.values()) and cracked.unverified is not None and not cracked.missing


def test_the_command_line_proves_any_column(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """The load of a cracked column, what five functions a segment are off by, and eigenvalues."""
    for name in ("XDG_CACHE_HOME", "LOCALAPPDATA"):
        monkeypatch.setenv(name, str(tmp_path))
    column = ["--column", str(stated(tmp_path, "crack")[0]), "--json", "--modes", "5"]
    outputs = []
    for asked in (["critical", "--digits", "20", "--exact"], ["critical", "--truncation"]):
        assert main([*asked, *column]) == 0
        outputs.append(json.loads(capsys.readouterr().out))
    exact, series = outputs
    assert exact["load_lower"].startswith("16.99437706055044426") and exact["exact"]
    assert float(series["truncation"]["difference_lower"]) == pytest.approx(
        series["load"] - 16.994377060550444, rel=1e-4
    )
    assert main(["spectrum", "--load", "10", "--exact", "--digits", "12", *column]) == 0
    assert not json.loads(capsys.readouterr().out)["unproven"]


def test_a_function_of_x_is_proven_from_the_front_door_too() -> None:
    """Of tables in floats nothing is; a column of functions of x is no such."""
    found = fb.exact_load(fb.column("exponential-taper"), digits=12, modes=12)
    assert found.kind == "flutter" and found.proof["crossing"] and found.load is not None
    series = fb.critical_load(fb.column("exponential-taper"), 12).load
    assert float(found.load[0]) == pytest.approx(series, rel=1e-8)


# ------------------------------------------------------------ limits of vanishing damping


@pytest.mark.parametrize(("name", "kappa"), [("free-free", 0), ("beck", 10)])
def test_a_limit_is_that_which_power_series_enclose(name: str, kappa: int) -> None:
    near = fb.critical_load(runtime_column(name), kappa=kappa)
    assert near.load and near.frequency
    start = near.load, near.frequency
    textbook = beam_itself.flutter_limit(Beam(runtime_column(name).kernel), Fraction(kappa), start, 20)
    system = ExactSystem(of_textbook(name), None, Fraction(1), Fraction(kappa), vanishing=True)
    found = beam_itself.flutter_limit(system, Fraction(kappa), start, 20)
    assert found.load.overlaps(textbook.load) and found.frequency.overlaps(textbook.frequency)
    assert found.load.rad() < found.load * 1e-20


def test_links_with_vanishing_dampers_flutter_at_41_28ths() -> None:
    """Ziegler's double pendulum, masses 2 : 1, equal dampers that vanish."""
    system = ExactSystem(emitted(ziegler()), None, Fraction(1), Fraction(0), vanishing=True)
    found = beam_itself.flutter_limit(system, Fraction(0), (1.4643, 0.7), 40)
    with precision(300):
        assert found.load.contains(arb(41) / 28)


def test_small_damping_tends_to_the_limit_by_its_square(tmp_path: Path) -> None:
    """Of a cracked column with a point mass, exactly at α and β = 10 α."""
    own = "(own(k, 10.0), own(mu, 0.5))"
    changes = {"V": STATED["crack"][0]["V"], "T": "T + mu * at(y.diff(t), 1) ** 2 / 2", "parameters": own}
    column = fb.column(file_of(tmp_path, "cracked", changes | {"dW_nc": "follower + internal + external"}))
    limit = fb.exact_load(column, kappa=10, digits=15, modes=10)
    assert limit.load is not None and limit.kind == "flutter" and limit.proof["crossing"] and not limit.proof["first"]
    at_limit, off = float(limit.load[0]), []
    for alpha_ in (Fraction(1, 10_000), Fraction(1, 20_000)):
        found = fb.exact_load(column, alpha_, 10 * alpha_, digits=15, modes=10).load
        assert found is not None
        off.append(float(found[0]) - at_limit)
    assert off[0] / off[1] == pytest.approx(4, rel=0.01)


@pytest.mark.parametrize("vanishing", [False, True])
def test_a_divergence_is_the_first_loss_with_vanishing_damping_too(vanishing: bool) -> None:
    """Of a spring without damping at a place without a mass; one of 35 takes four times as long."""
    column = beck(
        V=integral(y.diff(x, 2) ** 2) / 2 + 40 * at(y, 1) ** 2,
        dW_nc=FOLLOWER - integral(alpha * y.diff(x, 2, t) * delta(y.diff(x, 2))),
    )
    system = ExactSystem(emitted(column), None, Fraction(int(vanishing)), NONE, vanishing=vanishing)
    found, _, missing = beam_stability.complete(system, beam_itself.divergence(system, 22.957325558921, 12), NONE, NONE)
    assert found.proof.first and found.proof.stable_below and not missing


def test_a_damper_that_stays_has_no_limit() -> None:
    for kernel, reason in ((of_literature("tip damper")[0], "stays"), (of_literature("beck")[0], "no damping that")):
        with pytest.raises(NoSeries, match=reason):
            ExactSystem(kernel, None, Fraction(1), Fraction(1), vanishing=True)


# ------------------------------------------------------------ what is refused


@pytest.mark.parametrize(
    ("column", "reason"),
    [
        (turning, r"theta.* stands under an integral"),
        (lambda: beck(V=integral(sqrt(2 - x) * y.diff(x, 2) ** 2) / 2), "is not made of polynomials, quotients, exp"),
        (
            lambda: beck(V=integral(y.diff(x, 2) ** 2) / 2 + pi * at(y, 1) ** 2),
            r"the factor 2\*pi .* not to be had exactly",
        ),
        (
            lambda: beck(
                dW_nc=-P * at(y.diff(x, 4), c) * at(delta(y), 1),
                parameters=(Parameter(c, "c", 0.3, 0.0, 1.0),),
            ),
            "is beyond the derivatives of y",
        ),
    ],
)
def test_what_the_exact_system_does_not_serve_is_said_in_one_line(column: Any, reason: str) -> None:
    with pytest.raises(NoSeries, match=reason) as refused:
        ExactSystem(emitted(column()))
    assert "\n" not in str(refused.value)


def test_numbers_that_no_float_holds_are_exact() -> None:
    """√2 and e^(−1/3) in a statement are balls, not rounded floats."""
    spring_ = sqrt(2) + exp(Rational(-1, 3))
    kernel = emitted(beck(V=integral(y.diff(x, 2) ** 2) / 2 + spring_ * at(y, 1) ** 2))
    with precision(200):
        (spring,) = [
            v
            for row in ExactSystem(kernel)._tables().conditions
            for (_, p, *_), v in row.items()
            if p == 0 and len(row) > 1
        ]
        assert spring.overlaps(2 * (arb(2).sqrt() + (-arb(1) / 3).exp())) and spring.rad() < 1e-50


def test_a_shaft_of_two_stiffnesses_buckles_in_its_own_frame_between_its_critical_speeds(tmp_path: Path) -> None:
    """λ⁴ + (4 + 9 + 2 P²) λ² + (4 − P²) (9 − P²) = 0 of Jeffcott's rotor: unstable from P = 2 to 3."""
    planes = {
        "T": "((q.diff(t) - P * p) ** 2 + (p.diff(t) + P * q) ** 2) / 2",
        "V": "(4 * q ** 2 + 9 * p ** 2) / 2", "W_c": "0", "ends": "()",
        "dW_nc": "-alpha * (q.diff(t) * delta(q) + p.diff(t) * delta(p))",
    }  # fmt: skip
    system = ExactSystem(fb.column(file_of(tmp_path, "rotor", planes)).kernel)
    lost = beam_itself.divergence(system, 2.0, 12)
    assert lost.kind == "divergence" and lost.load.contains(2) and lost.frequency == 0
    with pytest.raises(beam_itself.NoOnset, match="a restabilisation"):
        beam_itself.divergence(system, 3.0, 12)
    with precision(100):
        t = system.taylor(arb(1), arb(0), ((0, 0), (0, 1), (0, 2)))
        assert t[0, 0].overlaps(arb(24)) and t[0, 1].contains(0) and t[0, 2].overlaps(arb(15))


def test_a_stiffness_that_vanishes_inside_is_refused() -> None:
    kernel = emitted(
        beck(
            V=integral((x - c) ** 2 * y.diff(x, 2) ** 2) / 2,
            dW_nc=-integral(beta * y.diff(t) * delta(y)) - integral(alpha * y.diff(x, 2, t) * delta(y.diff(x, 2))),
            parameters=(Parameter(c, "c", 0.3, 0.0, 1.0),),
        )
    )
    with precision(64), pytest.raises(Unproven, match="leading coefficients vanish near"):
        ExactSystem(kernel).taylor(arb(1), arb(1), ((0, 0),))


if __name__ == "__main__":
    for one in VALUES:
        test_an_enclosure_is_where_independent_codes_find_the_load(one)
        print(one.name, flush=True)
