"""Columns of the literature, from their statement to the critical load, against independent codes. Section 3.2."""

from __future__ import annotations

import inspect
import math
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest
from scipy import optimize

import freebeam as fb
from freebeam import cli
from freebeam.ledger.reference_values import statements
from freebeam_derive.references import Reference
from freebeam_sym.checks import Unstable
from freebeam_sym.question import Question
from freebeam_sym.stability.critical import answer
from freebeam_sym.stability.crossings import FirstLoss, first_loss
from freebeam_sym.stability.problem import Problem

GALLERY = [
    (name, reference)
    for name, column in statements().items()
    for reference in column.references
    if reference.modes is None  # of the column, not of a series of few modes
]


@pytest.mark.parametrize(
    ("name", "reference"), GALLERY, ids=[f"{name} {reference.load}" for name, reference in GALLERY]
)
def test_a_column_as_it_is_stated_has_its_critical_load(name: str, reference: Reference) -> None:
    """With sixteen functions a segment, to ten digits at least, of the right kind, and it is said to be converged."""
    limit = {} if reference.kappa is None else {"kappa": reference.kappa}
    column = fb.column(name, "legendre")
    found = fb.critical_load(column, 16, reference.alpha, reference.beta, **limit, **reference.own)
    assert found.kind == reference.kind
    last = 10.0 ** -len(reference.load.partition(".")[2])  # one unit of it, be it rounded or cut off
    assert found.load == pytest.approx(float(reference.load), rel=2e-10, abs=last)
    assert found.converged and found.error is not None and found.error < 1e-8
    short = fb.critical_load(column, 8, reference.alpha, reference.beta, **limit, **reference.own)
    for one in (found, short):  # the error bounds the true one, as far as that is printed
        assert one.load is not None and one.error is not None
        assert abs(one.load - float(reference.load)) <= one.error * one.load + last


@pytest.mark.parametrize(("name", "place"), [("crack", 0.99), ("point-mass", 0.97), ("absorber", 0.99)])
def test_the_error_of_a_load_is_had_without_another_search(name: str, place: float) -> None:
    """Longer series are followed from the crossing that is known. Of a short segment the loads differ from N to N by
    rounding, which the error bounds."""
    column, searched = fb.column(name), []

    def search(problem: Problem, load_max: float) -> FirstLoss:
        searched.append(problem)
        return first_loss(problem, load_max)

    found = answer(Question.of(column, 10, a=place), search)
    assert found.error is not None and found.converged and len(searched) == 1
    loads = [found.load, *(fb.critical_load(column, modes, a=place).load for modes in (14, 16, 20))]
    assert max(loads) / min(loads) - 1 < found.error < 1e-9


def test_the_motions_of_a_short_segment_are_damped_however_little() -> None:
    """A twentieth of the beam behind an absorber: its highest frequencies are beyond 10^7, and rounding of what damps
    them would be growth, or growth from the smallest loads on."""
    column = fb.column("absorber")
    proven = [float(bound) for bound in fb.exact_load(column, a="0.95", digits=12).load]
    for modes in (12, 16, 20, 24):
        assert fb.critical_load(column, modes, a=0.95).load == pytest.approx(proven[0], rel=1e-10)


@pytest.mark.parametrize("damper", [9.28e-4, 1e-5])
def test_a_damper_too_light_for_the_high_modes_is_not_overlooked(damper: float) -> None:
    """An absorber's dashpot damps the high modes by less than rounding; the load is that at which one eigenvalue
    passes the axis all the same."""
    column, own = fb.column("absorber"), {"mu": 1.762, "k": 28.85, "c": damper}
    found = fb.critical_load(column, 10, **own)
    assert found.load is not None and found.frequency is not None
    rates = []
    for load in (found.load * (1 - 1e-4), found.load, found.load * (1 + 1e-4)):
        values = fb.spectrum(column.system(10, load, **own)).elastic
        rates.append(float(values[np.abs(values - 1j * found.frequency).argmin()].real))
    assert rates[0] < 0 < rates[2] and abs(rates[1]) < 1e-3 * (rates[2] - rates[0])


PLANES = """
from sympy import Symbol

from freebeam_derive.notation import P, alpha, t, x, y
from freebeam_derive.statement import Column, Field, Parameter, at, delta, integral

z, s = Field("z"), Symbol("s", real=True)
column = Column(
    name="two-planes",
    title="Beck's column, free to bend in two planes, in a frame that turns with it",
    T=integral((y.diff(t) - s * z) ** 2 + (z.diff(t) + s * y) ** 2) / 2,
    V=integral(y.diff(x, 2) ** 2 + z.diff(x, 2) ** 2) / 2,
    W_c=P * integral(y.diff(x) ** 2 + z.diff(x) ** 2) / 2,
    dW_nc=-P * (at(y.diff(x), 1) * at(delta(y), 1) + at(z.diff(x), 1) * at(delta(z), 1))
    - integral(alpha * (y.diff(x, 2, t) * delta(y.diff(x, 2)) + z.diff(x, 2, t) * delta(z.diff(x, 2)))),
    ends=("clamped", "free"),
    parameters=(Parameter(s, "speed of turning", 0, 0, 3),),
)
"""


def test_a_column_of_two_equal_planes_is_that_of_one_twice(tmp_path: Path) -> None:
    """The clamped end holds both. Without damping each frequency is double, and so are eigenvalues and branches."""
    (tmp_path / "planes.py").write_text(PLANES)
    both, one = fb.column(str(tmp_path / "planes.py")), fb.column("beck", "legendre")
    found, wanted = fb.critical_load(both, 6), fb.critical_load(one, 6)
    assert found.kind == "flutter" and found.load == pytest.approx(wanted.load, rel=1e-9)
    assert found.error == pytest.approx(wanted.error, rel=1e-3)
    loads = np.linspace(0, 30, 7)
    twice, once = (fb.branches(column, loads, 6).eigenvalues for column in (both, one))
    for values in once.T:
        off = np.abs(twice - values[:, None]).max(axis=0)
        assert (off < 1e-7 * np.abs(values).max()).sum() == 2


@pytest.mark.parametrize("spin", [0.3, 2.0])
def test_a_shaft_that_turns_without_damping_loses_stability_as_at_rest(tmp_path: Path, spin: float) -> None:
    """Seen from a frame that turns, every frequency is that at rest, less or more the speed: two pass one another at
    20.032 where the speed is 0.3, and nothing grows there."""
    (tmp_path / "planes.py").write_text(PLANES)
    turning = fb.critical_load(fb.column(str(tmp_path / "planes.py")), 8, s=spin)
    rest = fb.critical_load(fb.column("beck", "legendre"), 8)
    assert turning.load is not None and rest.load is not None and rest.frequency is not None
    assert turning.frequency == pytest.approx(rest.frequency - spin, rel=1e-6)
    assert abs(turning.load / rest.load - 1) < turning.rounding < 1e-13
    assert turning.error == pytest.approx(rest.error, rel=1e-3)


@pytest.mark.parametrize("alpha", [1e-6, 0.01])
def test_equal_planes_have_the_digits_of_one(tmp_path: Path, alpha: float) -> None:
    """Each load is double: rounding splits the two in Arnoldi's method, not in Newton's."""
    (tmp_path / "planes.py").write_text(PLANES)
    both, one = fb.column(str(tmp_path / "planes.py")), fb.column("beck", "legendre")
    for modes in (8, 16, 20):
        loads = [fb.critical_load(column, modes, alpha).load for column in (both, one)]
        assert loads[0] == pytest.approx(loads[1], rel=1e-11)


@pytest.mark.parametrize(
    ("name", "unit"),
    [("pipe", "m/s"), ("ziegler", "N"), ("reut", "N"), ("hauger", "N"), ("beal", "N"), ("panel-pinned", "N/m")],
)
def test_a_load_has_the_unit_that_its_work_or_its_statement_gives_it(name: str, unit: str) -> None:
    column = fb.column(name)
    assert column.load_unit == unit
    sizes = [column.scales(2e6, 50, length)["load"] for length in (10, 20)]
    assert sizes[0] / sizes[1] == pytest.approx({"N": 4, "N/m": 8, "m/s": 2}[unit])


TORQUE = (
    PLANES.replace("+ z.diff(x, 2) ** 2)", "+ (1 + e) * z.diff(x, 2) ** 2)")
    .replace("    W_c=P * integral(y.diff(x) ** 2 + z.diff(x) ** 2) / 2,\n", "")
    .replace(
        "-P * (at(y.diff(x), 1) * at(delta(y), 1) + at(z.diff(x), 1) * at(delta(z), 1))",
        "P * integral(z.diff(x) * delta(y.diff(x, 2)) - y.diff(x) * delta(z.diff(x, 2)))",
    )
    .replace("z, s = Field", 'e = Symbol("e", real=True)\nz, s = Field')
    .replace("parameters=(", 'parameters=(Parameter(e, "bending stiffness that the second plane has more", 0, 0, 2), ')
)
"""Nicolai's shaft: a torque that turns with its tip."""


def test_a_torque_bears_what_sets_the_two_planes_apart(tmp_path: Path) -> None:
    """Nicolai's paradox: two equal planes bear no torque. With stiffness 1 and 1 + e they bear e ω² / (2 ∫φ′φ″), which
    is e (ω / φ′(1))² of the lowest mode φ of the cantilever with ∫φ² = 1; what it lacks is of second order."""
    (tmp_path / "torque.py").write_text(TORQUE)
    column = fb.column(str(tmp_path / "torque.py"))
    with pytest.raises(Unstable):
        fb.critical_load(column, 8)
    gamma = optimize.brentq(lambda g: math.cos(g) * math.cosh(g) + 1, 1.5, 2)  # ω = γ², φ′(1) = 2 γ σ
    sigma = (math.sinh(gamma) - math.sin(gamma)) / (math.cosh(gamma) + math.cos(gamma))
    off = []
    for e in (0.02, 0.01):
        found = fb.critical_load(column, 8, e=e)
        assert found.kind == "flutter" and found.load is not None
        off.append(found.load / e / (gamma / (2 * sigma)) ** 2 - 1)
    assert abs(off[0]) < 1e-4 and off[0] / off[1] == pytest.approx(4, rel=0.05)


CHAIN = """
from sympy import Rational

from freebeam_derive.notation import P, t
from freebeam_derive.statement import Column, Coordinate, delta

h = Rational(1, {links})
q = [Coordinate(f"q{{i}}", f"q_{{i}}") for i in range({links})]
middle = [h * (sum((one.diff(t) for one in q[:i]), 0) + q[i].diff(t) / 2) for i in range({links})]
column = Column(
    name="chain",
    title="Chain of uniform links with springs between them under a follower force",
    T=sum(h * v**2 / 2 + h**3 * one.diff(t) ** 2 / 24 for v, one in zip(middle, q)),
    V=(2 * q[0] ** 2 + sum((one - other) ** 2 for one, other in zip(q, q[1:]))) / (2 * h),
    dW_nc=P * h * sum((one - q[-1]) * delta(one) for one in q),
)
"""


def test_a_chain_of_links_tends_to_becks_column(tmp_path: Path) -> None:
    """With the second order of a link's length: Ziegler's pendulum of ever more links."""
    beck, off = fb.critical_load(fb.column("beck")).load, []
    assert beck is not None
    for links in (3, 6):
        (tmp_path / f"chain{links}.py").write_text(CHAIN.format(links=links))
        found = fb.critical_load(fb.column(str(tmp_path / f"chain{links}.py")))
        assert found.kind == "flutter" and found.load is not None
        off.append(1 - found.load / beck)
    assert 1.7 < math.log2(off[0] / off[1]) < 2


SHAFT = """
from sympy import sqrt
from freebeam_derive.notation import EI, C_alpha, C_beta, L, P, alpha, beta, m, t, x, y
from freebeam_derive.statement import Column, Energies, Field, delta, integral

z = Field("z")


def works(line, bending, internal, external, length):
    one, other = y.diff(x, 2, t) + P * z.diff(x, 2), z.diff(x, 2, t) - P * y.diff(x, 2)
    stretched = one * delta(y).diff(x, 2) + other * delta(z).diff(x, 2)
    return {
        "T": line * integral(y.diff(t) ** 2 + z.diff(t) ** 2, length) / 2,
        "V": bending * integral(y.diff(x, 2) ** 2 + z.diff(x, 2) ** 2, length) / 2,
        "dW_nc": -internal * bending * integral(stretched, length)
        - external * integral(y.diff(t) * delta(y) + z.diff(t) * delta(z), length),
    }


pinned = ("pinned", "pinned")
column = Column(
    name="shaft",
    title="Shaft with internal and external damping, seen from rest; the load is its speed",
    **works(1, 1, alpha, beta, 1),
    ends={y: pinned, z: pinned},
    dimensional=Energies(**works(m, EI, C_alpha, C_beta, L), length=L, scaling={P: P * sqrt(EI / (m * L**4))}),
)
"""


def test_a_speed_of_turning_is_in_radians_a_second(tmp_path: Path) -> None:
    """Both planes are lengths. It is lost at ω + C_β / (m C_α ω), of ω² = π⁴ EI / (m L⁴)."""
    (tmp_path / "shaft.py").write_text(SHAFT)
    column, (EI, m, L), (internal, external) = fb.column(str(tmp_path / "shaft.py")), (6.0, 5.0, 3.0), (0.01, 0.1)
    sizes = column.scales(EI, m, L)
    found = fb.critical_load(column, 8, internal / sizes["alpha"], external / sizes["beta"])
    omega = math.pi**2 * math.sqrt(EI / m) / L**2
    assert column.load_unit == "rad/s" and found.load is not None
    assert found.load * sizes["load"] == pytest.approx(omega + external / (m * internal * omega), rel=1e-9)


def test_a_load_that_nothing_gives_a_unit_is_refused_in_si(tmp_path: Path) -> None:
    """Links alone are no beam of any length."""
    (tmp_path / "chain.py").write_text(CHAIN.format(links=2))
    with pytest.raises(fb.InputError, match=r"no SI unit.*state the column in SI quantities too"):
        fb.column(str(tmp_path / "chain.py")).scales(2e6, 50, 20)


def test_a_torque_is_told_as_one(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """EI/L times a number."""
    (tmp_path / "torque.py").write_text(TORQUE)
    column = fb.column(str(tmp_path / "torque.py"))
    assert column.load_unit == "N m" and column.scales(6.0, 5.0, 3.0)["load"] == pytest.approx(2.0)
    asked = ["critical", "--column", str(tmp_path / "torque.py"), "--bending-stiffness", "6", "--mass-per-length", "5"]
    assert cli.main([*asked, "--length", "3", "--set", "e=1"]) == 0
    load = fb.critical_load(column, e=1.0).load
    assert load is not None and f"{2 * load:.10g} N m" in capsys.readouterr().out


def test_what_sensors_read_is_called_by_its_name(capsys: pytest.CaptureFixture[str]) -> None:
    """A pendulum has no y: its first angle is read, which has no place."""
    column = fb.column("ziegler")
    first = column.unknowns[0]
    assert first != "y" and first not in column.fields
    found = fb.respond(column.system(load=0.1), 1.0, 0.5)
    assert found.measured == first
    asked = ["respond", "--column", "ziegler", "--load", "0.1", "--duration", "1"]
    told = []
    for step in ("0.5", "0.001"):
        assert cli.main([*asked, "--step", step]) == 0
        told.append(capsys.readouterr().out)
    few, many = told
    assert few.splitlines()[0] == f"t,{first},d{first},dd{first}"
    assert f"\n{first}\n" in many and "y(" not in many
    assert first in fb.figures.history(found, "dy").get_ylabel()


@pytest.mark.parametrize("place", ["1", "0.5"])
def test_a_parameter_may_be_an_exponent(tmp_path: Path, place: str) -> None:
    """A spring of the stiffness 2^k is one of 8 where k = 3; in fractions there is no such power, which proofs say."""
    text = inspect.getsource(import_module("freebeam_derive.columns.gallery.tip_spring")).replace(
        "at(y, 1)", f"at(y, {place})"
    )
    (tmp_path / "plain.py").write_text(text)
    (tmp_path / "power.py").write_text(text.replace("k * at(y", "2**k * at(y"))
    plain, power = (fb.column(str(tmp_path / name), "legendre") for name in ("plain.py", "power.py"))
    load = fb.critical_load(plain, 8, k=8.0).load
    assert load is not None and fb.critical_load(power, 8, k=3.0).load == pytest.approx(load, rel=1e-12)
    if not power.general:  # a general column's matrices are balls then
        with pytest.raises(fb.InputError, match="no fraction"):
            fb.certified_load(power, 6, k=3)


@pytest.mark.parametrize("b", [0.05, 0.25, 0.6])
def test_an_undamped_pipe_is_searched_from_most_of_the_way_to_its_loss(b: float) -> None:
    """At 0 each of its motions is undamped: from a load near that Arnoldi's method has to find all of these first."""
    question = Question.of(fb.column("pipe"), 8, b=b)
    found = answer(question)
    assert found.load is not None
    assert found.load / 2 < question.general._operator.P < found.load  # type: ignore[union-attr]
