"""Eq. (5): both statements of a column, evaluated for beams of random size in SI units."""

from __future__ import annotations

import dataclasses
import random
import re
from collections.abc import Callable
from fractions import Fraction
from importlib import import_module
from types import ModuleType
from typing import Any

import pytest
import sympy as sp

from freebeam_derive import scaling, units
from freebeam_derive.notation import EI, F_0, C_alpha, C_beta, L, P, alpha, beta, m, t, x, x_F, y
from freebeam_derive.pipeline import Derived
from freebeam_derive.statement import Column, Coordinate, Energies, Parameter, StatementError, at, delta, integral

Derived = Callable[[str], Derived]
DIMENSIONAL = ("free-free", "leipholz")


def stated(name: str) -> Column:
    module = import_module(f"freebeam_derive.columns.gallery.{name.replace('-', '_')}")
    return module.column  # type: ignore[no-any-return]


def beam(dice: random.Random) -> dict[Any, Any]:
    """EI, m and L whose time unit is rational."""
    return {EI: sp.Integer(dice.randint(2, 9)) ** 2, m: sp.Rational(dice.randint(2, 9), 3) ** 2, L: sp.Rational(7, 3)}


@pytest.mark.parametrize("column", DIMENSIONAL)
@pytest.mark.parametrize("work", ["T", "V", "W_c", "dW_nc"])
def test_energies_in_si_are_the_nondimensional_ones_times_EI_over_L(
    column: str, work: str, derived: Derived, evaluate: Any
) -> None:
    """Eq. (5) typed here: y = L ȳ, x = L x̄, t = t̄ (m L⁴ / EI)^½, P = P̄ EI / L², and so on."""
    dice, stated = random.Random(column + work), derived(column).column
    size = beam(dice)
    unit = sp.sqrt(size[m] * size[L] ** 4 / size[EI])
    assert unit.is_Rational
    now = sp.Rational(3, 7)
    names = (P, alpha, beta, x_F, *(p.symbol for p in stated.parameters))
    bare = {s: sp.Rational(dice.randint(1, 9), 10) for s in names} | {F_0: sp.Rational(2, 3)}
    physical = size | {
        P: bare[P] * size[EI] / size[L] ** 2,
        F_0: bare[F_0] * size[EI] / size[L] ** 2,
        C_alpha: bare[alpha] / sp.sqrt(size[EI] / (size[m] * size[L] ** 4)),
        C_beta: bare[beta] / sp.sqrt(size[L] ** 4 / (size[m] * size[EI])),
        x_F: bare[x_F] * size[L],
    }
    physical |= {p.symbol: bare[p.symbol] for p in stated.parameters}
    motion = sum(sp.Rational(dice.randint(1, 9), 5) * x**n * t ** (n % 3) for n in range(5))
    virtual = sum(sp.Rational(dice.randint(1, 9), 5) * x**n for n in range(4))
    moved = size[L] * motion.subs({x: x / size[L], t: t / unit}, simultaneous=True)
    displaced = size[L] * virtual.subs(x, x / size[L])
    assert stated.dimensional is not None
    small = evaluate(getattr(stated, work).xreplace(bare), motion, virtual).subs(t, now)
    large = evaluate(getattr(stated.dimensional, work).xreplace(physical), moved, displaced).subs(t, now * unit)
    assert small != 0
    assert large == small * size[EI] / size[L]


def test_scales_have_the_dimensions_that_they_say() -> None:
    """Other units of mass, length and time change each scale as its SI unit says."""
    mass, length, time = sp.symbols("mass length time", positive=True)
    si = {
        "m": length,
        "s": time,
        "kg": mass,
        "N": mass * length / time**2,
        "rad": sp.S.One,
        "J": mass * length**2 / time**2,
    }
    changed = {EI: EI * mass * length**3 / time**2, m: m * mass / length, L: L * length}
    assert set(units.SCALES) == set(units.UNITS)
    own = [
        q
        for name in ("pipe", "ziegler", "absorber", "pflueger", "panel-pinned")
        for q in stated(name).quantities.values()
    ]
    products = (EI**i * m**j * L**k for i in (-1, 0, 1) for j in (-1, 0, 1) for k in range(-4, 5))
    made = [
        units.Quantity(size, units.unit_of(size))
        for size in (*products, sp.sqrt(EI / m), sp.sqrt(EI / m) / L**2, sp.sqrt(EI * m) / L)
    ]
    assert {"N", "N m", "N/m", "m/s", "rad/s", "kg", "kg/m", "N s/m", "1"} <= {q.unit for q in (*own, *made)}
    sizes = [(name, units.UNITS[name], size) for name, size in units.SCALES.items()]
    for quantity, told, scale in sizes + [(str(q.size), q.unit, q.size) for q in (*own, *made)]:
        unit = re.sub(r"[a-zA-Z]+", lambda name: f"U['{name[0]}']", told.replace("^", "**"))
        expected = eval(unit.replace("(", "((").replace(")", "))").replace(" U[", " * U["), {"U": si})
        assert sp.simplify(scale.subs(changed, simultaneous=True) / scale - expected) == 0, quantity


def test_scales_invert_equation_5() -> None:
    """P̄ = P L²/EI, β̄ = C_β (L⁴/(m EI))^½, ᾱ = C_α (EI/(m L⁴))^½, t̄ = t (EI/(m L⁴))^½."""
    typed = {
        "load": L**2 / EI,
        "force": L**2 / EI,
        "beta": sp.sqrt(L**4 / (m * EI)),
        "alpha": sp.sqrt(EI / (m * L**4)),
        "time": sp.sqrt(EI / (m * L**4)),
        "length": 1 / L,
    }
    for quantity, factor in typed.items():
        assert sp.simplify(units.SCALES[quantity] * factor) == 1, quantity
    rate = units.SCALES["length"] / units.SCALES["time"]
    assert sp.simplify(units.SCALES["velocity"] / rate) == 1
    assert sp.simplify(units.SCALES["acceleration"] * units.SCALES["time"] / rate) == 1
    assert sp.simplify(units.SCALES["frequency"] * units.SCALES["time"]) == 1
    assert sp.simplify(units.SCALES["energy"] / (units.SCALES["load"] * units.SCALES["length"])) == 1


def test_emitted_scales_there_and_back(module_of: Callable[[str], ModuleType]) -> None:
    """A steel strip: load and dampings to nondimensional and back; the first frequency of a cantilever in rad/s."""
    bending, line, length = 210e9 * 1e-9, 7850 * 1.2e-4, 1.7
    scale = module_of("beck").scales(bending, line, length)
    numbers = {EI: bending, m: line, L: length}
    assert scale == pytest.approx({name: float(e.subs(numbers)) for name, e in units.SCALES.items()}, rel=1e-14)
    frequency = 1.8751040687119611**2 * (bending / (line * length**4)) ** 0.5  # textbook
    assert module_of("beck").basis(1).gamma[0] ** 2 * scale["frequency"] == pytest.approx(frequency, rel=1e-13)


@pytest.mark.parametrize("work", ["T", "V", "W_c", "dW_nc"])
def test_a_dimensional_statement_that_disagrees_is_refused(work: str, derived: Derived) -> None:
    stated = derived("free-free").column
    assert stated.dimensional is not None and scaling.derive_scaling(stated)
    wrong = dataclasses.replace(stated.dimensional, **{work: 2 * getattr(stated.dimensional, work)})
    with pytest.raises(StatementError) as caught:
        scaling.derive_scaling(dataclasses.replace(stated, dimensional=wrong))
    assert str(caught.value).startswith(work) and "correct one of them" in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("wrong", [L * P, P / L, EI * P])
def test_wrong_dimensions_are_refused(wrong: Any, derived: Derived) -> None:
    stated: Column = derived("leipholz").column
    assert stated.dimensional is not None
    other = dataclasses.replace(stated.dimensional, W_c=stated.dimensional.W_c.subs(P, wrong))
    with pytest.raises(StatementError, match=r"^W_c"):
        scaling.derive_scaling(dataclasses.replace(stated, dimensional=other))


def test_without_dimensions_there_is_nothing_to_derive(derived: Derived) -> None:
    assert scaling.derive_scaling(derived("hauger").column) == ()


# --- any column -------------------------------------------------------------------------------------------------------


def absorbed(changed: dict[Any, Any] | None = None) -> Column:
    """A cantilever with a tip mass and an absorber of its own, in SI units and without."""
    mu, nu, k, c = (sp.Symbol(name, positive=True) for name in ("mu", "nu", "k", "c"))
    tip, own, spring, dashpot = (sp.Symbol(name, positive=True) for name in ("m_tip", "m_q", "k_q", "c_q"))
    q = Coordinate("q")

    def statement(length: Any, line: Any, bending: Any, external: Any, *sizes: Any) -> dict[str, Any]:
        mass, absorber, stiffness, damper = sizes
        gap = at(y, length / 2) - q
        return {
            "T": integral(line * y.diff(t) ** 2, length) / 2
            + mass * at(y.diff(t), length) ** 2 / 2
            + absorber * q.diff(t) ** 2 / 2,
            "V": integral(bending * y.diff(x, 2) ** 2, length) / 2 + stiffness * gap**2 / 2,
            "W_c": P * integral(y.diff(x) ** 2, length) / 2,
            "dW_nc": -P * at(y.diff(x), length) * at(delta(y), length)
            - external * integral(y.diff(t) * delta(y), length)
            - damper * gap.diff(t) * delta(gap),
        }

    rate = EI ** sp.Rational(1, 2) * m ** sp.Rational(1, 2) / L
    scales = {tip: mu * m * L, own: nu * m * L, spring: k * EI / L**3, dashpot: c * rate, q: L * q} | (changed or {})
    return Column(
        name="absorbed",
        title="Cantilever with a tip mass and an absorber",
        **statement(1, 1, 1, beta, mu, nu, k, c),
        ends=("clamped", "free"),
        parameters=tuple(Parameter(symbol, str(symbol), 0.5, 0.0, 10.0) for symbol in (mu, nu, k, c)),
        dimensional=Energies(**statement(L, m, EI, C_beta, tip, own, spring, dashpot), length=L, scaling=scales),
    )


def test_a_column_of_points_and_coordinates_in_si_is_its_nondimensional_statement() -> None:
    steps = scaling.derive_scaling(absorbed())
    assert [step.equation for step in steps] == ["Eq. (5)"] * 4


def test_a_wrong_scale_of_its_own_is_refused() -> None:
    key = next(key for key in absorbed().dimensional.scaling if str(key) == "k_q")  # type: ignore[union-attr]
    for wrong in (sp.Symbol("k", positive=True) * EI / L**2, sp.Symbol("k", positive=True) * EI / L**3 / 2):
        with pytest.raises(StatementError, match=r"^V: the dimensional statement gives"):
            scaling.derive_scaling(absorbed({key: wrong}))


# --- quantities of a column's own -------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["pipe", "ziegler", "pflueger", "absorber"])
def test_columns_of_the_gallery_say_the_same_in_si(name: str) -> None:
    assert len(scaling.derive_scaling(stated(name))) == 4


def test_a_flow_is_a_velocity_that_the_fluids_share_makes_another() -> None:
    """u = U L (M_f / EI)^½ with M_f = b m; the column says so of a wrong size."""
    pipe = stated("pipe")
    assert pipe.dimensional is not None
    b, size = pipe.parameters[0].symbol, pipe.quantities["load"].size
    assert sp.simplify(size.subs(b, sp.Symbol("M_f", positive=True) / m) * L / sp.sqrt(EI)).free_symbols == {
        sp.Symbol("M_f", positive=True)
    }
    found = pipe.quantities
    assert {n: (q.unit, q.of) for n, q in found.items()} == {
        "load": ("m/s", ""),
        "M_f": ("kg/m", "b"),
        "k_f": ("N/m^2", "k"),
    }
    for wrong in ({P: P * sp.sqrt(EI / m) / L}, {P: P * EI / L**2}):
        given = dataclasses.replace(pipe.dimensional, scaling={**pipe.dimensional.scaling, **wrong})
        with pytest.raises(StatementError, match=r"^dW_nc: the dimensional statement gives"):
            scaling.derive_scaling(dataclasses.replace(pipe, dimensional=given))


@pytest.mark.parametrize(
    ("size", "says"),
    [
        ({P: P * (1 + EI)}, "no product of powers"),
        ({P: P * sp.cbrt(EI)}, "no product of powers"),
        ({P: P * sp.Symbol("g")}, "holds g"),
        ({sp.Symbol("length"): sp.Symbol("b", real=True) * L}, "name of another quantity"),
    ],
)
def test_a_quantity_without_a_unit_or_with_the_name_of_another_is_refused(size: dict[Any, Any], says: str) -> None:
    pipe = stated("pipe")
    assert pipe.dimensional is not None
    with pytest.raises(StatementError, match=says):
        _ = dataclasses.replace(pipe, dimensional=dataclasses.replace(pipe.dimensional, scaling=size)).quantities


def test_squares_of_sizes_are_those_of_the_statement() -> None:
    """In fractions, from what a module says; a parameter may be in the load's."""
    told = units.told(stated("pipe").quantities)
    size = Fraction(3, 2), Fraction(5), Fraction(7, 3)
    found = scaling.squares(told, size, {"b": Fraction(1, 8), "k": Fraction(0)})
    bending, line, length = size
    assert found["load"] == bending / (line / 8) / length**2 and found["M_f"] == line**2
    assert found["force"] == (bending / length**2) ** 2 and found["time"] == line * length**4 / bending
    assert scaling.squares({}, size)["load"] == found["force"]
    with pytest.raises(ValueError, match="no rational number"):
        scaling.squares({"quantities": {"load": {"size": "sqrt(sqrt(EI))"}}}, size)
