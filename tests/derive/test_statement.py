"""Statements that make no sense, each refused in one line that names what is wrong and what to do. Eq. (8)."""

from __future__ import annotations

import inspect
from pathlib import Path

import pytest
from sympy import Derivative, Expr, Lambda, Subs, Symbol, expand, sin
from sympy.core.cache import clear_cache

from freebeam_derive import pipeline, ritz, statement, variation
from freebeam_derive.jets import fields_of
from freebeam_derive.notation import P, t, variation_of_y, x, x_F, y
from freebeam_derive.statement import Column, Parameter, StatementError, at, integral, jump

SOUND = {
    "name": '"sample"',
    "title": '"A sample"',
    "T": "integral(y.diff(t) ** 2) / 2",
    "V": "integral(y.diff(x, 2) ** 2) / 2",
    "W_c": "P * integral(y.diff(x) ** 2) / 2",
    "dW_nc": "damping - P * at(y.diff(x), 1) * at(delta(y), 1) + F_0 * at(delta(y), x_F)",
    "ends": '("clamped", "free")',
    "parameters": "(Parameter(k, 'a stiffness', 1.0, 0.0, 2.0),)",
}

HEAD = """
from sympy import Derivative, Float, Function, I, Integral, Limit, Piecewise, Rational, Subs, Symbol
from sympy import cos, exp, oo, sin, sqrt
from freebeam_derive.notation import EI, F_0, L, P, alpha, beta, gamma, m, t, x, x_F, y
from freebeam_derive.statement import Column, Coordinate, Field, Parameter, at, delta, hinge, integral, jump
k, c = Symbol("k", real=True), Symbol("c", real=True)
w, G = Function("w")(x, t), Function("G")(t)
u, q = Field("u"), Coordinate("q")
damping = -integral(beta * y.diff(t) * delta(y) + alpha * y.diff(x, 2, t) * delta(y.diff(x, 2)))
"""


def written(folder: Path, **changes: str) -> Path:
    fields = SOUND | changes
    body = ", ".join(f"{name}={value}" for name, value in fields.items())
    path = folder / "sample.py"
    path.write_text(f"{HEAD}column = Column({body})\n", encoding="utf-8")
    return path


def considered(path: Path) -> Column:
    """All stages that judge a statement."""
    column = statement.load_column(path)
    try:
        pipeline.derive(column)
    except ritz.NotTextbook:
        pipeline.general(column)
    return column


def refusal(path: Path) -> str:
    with pytest.raises(StatementError) as caught:
        considered(path)
    message = str(caught.value)
    assert isinstance(caught.value, ValueError)
    assert "\n" not in message
    assert str(path) in message or "file" not in message
    return message


def test_an_energy_may_be_a_derivative_in_a_parameter(tmp_path: Path) -> None:
    """Nothing of y is lost by it: k y′²/2 in k is y′²/2."""
    plain = considered(written(tmp_path)).energies.functional("W_c")
    stated = considered(written(tmp_path, W_c="P * integral((k * y.diff(x) ** 2 / 2).diff(k))"))
    assert stated.energies.functional("W_c") == plain


def test_the_sound_statement_is_accepted(tmp_path: Path) -> None:
    """Beck's: the load stands in W_c and in dW_nc, and is not counted twice. Every case below departs from it."""
    assert considered(written(tmp_path)).ends == ("clamped", "free")


FREE = {"ends": '("free", "free")', "dW_nc": "damping"}

REFUSED: dict[str, tuple[dict[str, str], tuple[str, ...]]] = {
    # work that is not linear in the variation
    "work without variation": ({"dW_nc": "damping + P * at(y, 1)"}, ("dW_nc", "not linear", "delta(...)")),
    "variation squared": ({"dW_nc": "damping + P * integral(delta(y) ** 2)"}, ("dW_nc", "not linear", "delta(...)")),
    "sine of the variation": ({"dW_nc": "damping + P * integral(sin(delta(y)))"}, ("dW_nc", "not linear")),
    "one term of two without": ({"dW_nc": "damping + P * integral(y * delta(y) + y)"}, ("dW_nc", "not linear")),
    "bare force": ({"dW_nc": "damping + P * at(delta(y), 1) + F_0"}, ("dW_nc", "not linear")),
    "constant": ({"dW_nc": "damping + P * at(delta(y), 1) + 1"}, ("dW_nc", "not linear")),
    "work not linear in y": ({"dW_nc": "damping - P * integral(y**2 * delta(y))"}, ("dW_nc", "linear in y")),
    "rate of the variation": ({"dW_nc": "damping + P * integral(y * delta(y).diff(t))"}, ("virtual", "no rate")),
    # a field never varied
    "second field in V": (
        {"V": "integral(y.diff(x, 2)**2 + w**2) / 2"},
        ("V", "w(x, t)", "never varied", "not supported"),
    ),
    "second field in dW_nc": ({"dW_nc": "damping + P * integral(w * delta(y))"}, ("w(x, t)", "never varied")),
    "function of time": ({"dW_nc": "damping + P * integral(y * delta(y)) + G * at(delta(y), 1)"}, ("G(t)",)),
    "stiffness as a function": ({"V": "integral(Function('B')(x) * y.diff(x, 2)**2) / 2"}, ("B(x)", "never varied")),
    "y outside an integral": ({"V": "integral(y.diff(x, 2)**2) / 2 + y**2"}, ("V", "at(..., place)")),
    # no motion, no bending
    "no kinetic energy": ({"T": "0"}, ("T", "y.diff(t)**2", "not supported")),
    "mass at a point alone": ({"T": "at(y.diff(t), 1)**2 / 2"}, ("T", "along the beam")),
    "kinetic energy of y": ({"T": "integral(y**2) / 2"}, ("T", "no rate", "y.diff(t)")),
    "a rate that was forgotten": (
        {"T": "integral(y.diff(t)**2) / 2 + k * at(y, 1)**2 / 2"},
        ("T", "k*y(1, t)**2/2", "no rate", "in V"),
    ),
    "a root of what is negative": (
        {"dW_nc": "damping - integral(sqrt(x - 0.5) * y.diff(t) * delta(y))"},
        ("dW_nc", "sqrt(x - 1/2)", "no finite real number at x = 0"),
    ),
    "a pole at an end": (
        {"dW_nc": "damping - integral(y.diff(t) * delta(y) / x)"},
        ("dW_nc", "1/x", "no finite real number at x = 0"),
    ),
    "stiffness that vanishes inside": (
        {"V": "integral(abs(x - 0.5) * y.diff(x, 2)**2) / 2"},
        ("V", "bending stiffness", "is 0 at x = 0.5"),
    ),
    "stiffness that vanishes where the slope is held": (
        {"V": "integral(x * y.diff(x, 2)**2) / 2", "ends": '("clamped", "free")', "dW_nc": "damping"},
        ("V", "bending stiffness", "is 0 at x = 0"),
    ),
    "sides that may jump": (
        {"V": "integral(y.diff(x, 2)**2) / 2 + k * (at(y, 0.5, 1)**2 + at(y, 0.5, -1)**2) / 2"},
        ("both sides of y(x, t) at 1/2", "jump(y(x, t), 1/2)"),
    ),
    "constant kinetic energy": ({"T": "integral(x)"}, ("T", "quadratic")),
    "accelerations in T": ({"T": "integral(y.diff(t)**2 + y.diff(t, 2)**2) / 2"}, ("T", "first rates")),
    "no bending energy": ({"V": "integral(y.diff(x)**2) / 2"}, ("V", "y.diff(x, 2)**2", "not supported")),
    "bending not squared": (
        {"V": "integral(y * y.diff(x, 2))", "ends": '("clamped", "clamped")', "dW_nc": "damping"},
        ("V", "y.diff(x, 2)**2"),
    ),
    "negative bending energy": ({"V": "-integral(y.diff(x, 2)**2) / 2"}, ("V", "negative", "sign")),
    "negative kinetic energy": ({"T": "-integral(y.diff(t)**2) / 2"}, ("T", "negative", "sign")),
    # degrees
    "cubic energy": ({"V": "integral(y.diff(x, 2)**2 + y.diff(x, 2)**3)"}, ("V", "second degree")),
    "quartic work": ({"W_c": "P * integral(y.diff(x)**2 + y.diff(x)**4)"}, ("W_c", "second degree")),
    "exact curvature": ({"V": "integral(sqrt(1 + y.diff(x, 2)**2) + y.diff(x, 2)**2)"}, ("V", "second degree")),
    "square of an integral": ({"V": "integral(y.diff(x, 2)**2) / 2 + integral(y)*integral(y)"}, ("V",)),
    "product of integrals": ({"dW_nc": "damping + P * integral(y) * integral(delta(y))"}, ("dW_nc", "integral")),
    # what belongs elsewhere
    "rate in V": ({"V": "integral(y.diff(x, 2)**2 + y.diff(t)**2)"}, ("V", "without rates")),
    "rate in W_c": ({"W_c": "P * integral(y.diff(x) * y.diff(t))"}, ("W_c", "without rates")),
    "load in T": ({"T": "P * integral(y.diff(t)**2)"}, ("T", "mass 2*P is 0", "positive")),
    "damping in V": ({"V": "(1 + alpha) * integral(y.diff(x, 2)**2) / 2"}, ("V", "alpha", "dW_nc")),
    "damping in W_c": ({"W_c": "(1 + beta) * P * integral(y.diff(x)**2) / 2"}, ("W_c", "beta", "dW_nc")),
    "damping times an acceleration": (
        {"dW_nc": "damping + alpha * at(y.diff(t, 2), 1) * at(delta(y), 1)"},
        ("alpha", "rates", "displacements"),
    ),
    "third rate": ({"dW_nc": "damping - P * integral(y.diff(t, 3) * delta(y))"}, ("dW_nc", "second")),
    "variation in an energy": ({"V": "integral(y.diff(x, 2)**2 + y * delta(y))"}, ("V", "delta(...)", "dW_nc")),
    "no load": ({"W_c": "0", "dW_nc": "damping"}, ("load P", "no work")),
    "inverse load": ({"W_c": "integral(y.diff(x)**2) / P"}, ("W_c", "polynomial")),
    "pulsating load": ({"W_c": "cos(t) * P * integral(y.diff(x)**2)"}, ("W_c", "time t")),
    "ageing beam": ({"V": "integral((1 + t) * y.diff(x, 2)**2)"}, ("V", "time t")),
    # the same force in W_c and in dW_nc
    "the same term": ({"dW_nc": "damping + P * integral(y.diff(x) * delta(y.diff(x)))"}, ("P", "twice", "W_c")),
    "a share of it": ({"dW_nc": "damping + P / 4 * integral(y.diff(x) * delta(y).diff(x))"}, ("P", "twice")),
    "the same after parts": ({"dW_nc": "damping - P * integral(y.diff(x, 2) * delta(y))"}, ("P", "twice")),
    "after parts, opposite": ({"dW_nc": "damping + P * integral(y.diff(x, 2) * delta(y))"}, ("P", "twice")),
    "after parts, with a tip force": (
        {"dW_nc": "damping - P * integral(y.diff(x, 2) * delta(y)) - P * at(y.diff(x), 1) * at(delta(y), 1)"},
        ("P", "twice"),
    ),
    "after parts, with another load": ({"dW_nc": "damping - P * integral((y.diff(x, 2) + y) * delta(y))"}, ("twice",)),
    "after parts, by a parameter": ({"dW_nc": "damping - k * P * integral(y.diff(x, 2) * delta(y))"}, ("twice",)),
    "after parts, along the beam": (
        {
            "W_c": "P * integral((1 - x) * y.diff(x)**2) / 2",
            "dW_nc": "damping - P * integral(((1 - x) * y.diff(x)).diff(x) * delta(y))",
        },
        ("P", "twice"),
    ),
    "at a point": (
        {"W_c": "P * at(y, 1)**2 / 2", "dW_nc": "damping + P * at(y, 1) * at(delta(y), 1)"},
        ("P", "twice"),
    ),
    "at a point, as an integral": (
        {"W_c": "P * (at(y, 1)**2 - at(y, 0)**2) / 2", "dW_nc": "damping + P * integral((y * delta(y)).diff(x))"},
        ("P", "twice"),
    ),
    "the transversal force": (
        {"W_c": "P * integral(y.diff(x)**2) / 2 + F_0 * at(y, x_F)", "dW_nc": "damping + F_0 * at(delta(y), x_F)"},
        ("F_0", "twice"),
    ),
    # ends that contradict
    "follower at a clamped end": ({"ends": '("free", "clamped")'}, ("x = 1", "clamped")),
    "follower at a pinned end": ({"ends": '("clamped", "pinned")'}, ("x = 1", "pinned")),
    "follower at a sliding end": ({"ends": '("clamped", "sliding")'}, ("x = 1", "sliding")),
    "moment at a sliding end": (
        {"ends": '("clamped", "sliding")', "dW_nc": "damping + P * at(y, 1) * at(delta(y.diff(x)), 1)"},
        ("x = 1", "sliding"),
    ),
    "spring at a clamped end": ({"V": "integral(y.diff(x, 2)**2) / 2 + k * at(y, 0)**2"}, ("x = 0", "clamped")),
    "turning spring at a sliding end": (
        {"V": "integral(y.diff(x, 2)**2) / 2 + k * at(y.diff(x), 0)**2", "ends": '("sliding", "free")'},
        ("x = 0", "sliding"),
    ),
    "mass at a clamped end": ({"T": "integral(y.diff(t)**2) / 2 + k * at(y.diff(t), 0)**2"}, ("x = 0", "clamped")),
    "dashpot at a clamped end": ({"dW_nc": "damping - k * at(y.diff(t), 0) * at(delta(y), 0)"}, ("x = 0", "clamped")),
    "bending that ends before the beam": (
        {"V": "integral(k * y.diff(x)**2 + (1 - x) * y.diff(x, 2)**2) / 2", **FREE},
        ("x = 1", "free", "bending stiffness"),
    ),
    "third derivative": ({"V": "integral(y.diff(x, 2)**2 + y.diff(x, 3)**2)"}, ("force or a moment",)),
    # what Ritz's series cannot take
    "external damping that drives": (
        {"dW_nc": "integral(beta * y.diff(t) * delta(y)) - P * at(y.diff(x), 1) * at(delta(y), 1)"},
        ("C = −beta ∫ φᵢ φⱼ dx", "feeds energy in", "not supported", "a parameter of its own"),
    ),
    "internal damping that drives": (
        {"dW_nc": "damping + 2 * alpha * integral(y.diff(x, 2, t) * delta(y.diff(x, 2)))"},
        ("C = −alpha ∫ φᵢ″ φⱼ″ dx", "feeds energy in"),
    ),
    "dashpot that drives": (
        {"dW_nc": "-P * at(y.diff(x), 1) * at(delta(y), 1) + at(y.diff(t), 1) * at(delta(y), 1)"},
        ("C = −φᵢ(1) φⱼ(1)", "feeds energy in"),
    ),
    "force beyond the beam": ({"dW_nc": "damping - P * at(y.diff(x), 2) * at(delta(y), 2)"}, ("off the beam",)),
    "force on the slope": ({"dW_nc": "damping + F_0 * at(delta(y.diff(x)), x_F)"}, ("transversal",)),
    "force at a fixed place": ({"dW_nc": "damping + F_0 * at(delta(y), 1)"}, ("F_0 * at(delta(y), x_F)",)),
    "force times two": ({"dW_nc": "damping + 2 * F_0 * at(delta(y), x_F)"}, ("F_0 * at(delta(y), x_F)",)),
    "force times a parameter": ({"dW_nc": "damping + k * F_0 * at(delta(y), x_F)"}, ("F_0 * at(delta(y), x_F)",)),
    "force along the beam": ({"dW_nc": "damping + integral(F_0 * delta(y))"}, ("force along the beam",)),
    # integrals
    "half the beam": ({"V": "Integral(y.diff(x, 2)**2, (x, 0, Rational(1, 2)))"}, ("V", "stiffness 0", "positive")),
    "integral over time": ({"V": "Integral(y.diff(x, 2)**2, (t, 0, 1))"}, ("V", "run over the beam")),
    "x before an integral": ({"W_c": "P * x * integral(y.diff(x)**2)"}, ("W_c", "constants")),
    "value inside an integral": ({"V": "integral(y.diff(x, 2)**2 + at(y, 1)**2)"}, ("V", "under the integral")),
    # a term that would vanish, or be another
    "derivative of a value": (
        {"dW_nc": "damping - P * y.func(1, t).diff(x) * at(delta(y), 1)"},
        ("derivative of y(1, t) is zero", "at(y.diff(x), 1)"),
    ),
    "derivative after subs": (
        {"dW_nc": "damping - P * y.subs(x, 1).diff(x) * delta(y.subs(x, 1))"},
        ("derivative of y(1, t) is zero", "at(y.diff(x), 1)"),
    ),
    "derivative after at": ({"dW_nc": "damping - P * at(y, 1).diff(x) * at(delta(y), 1)"}, ("Subs(y(x, t), x, 1)",)),
    "derivative of a product at a place": (
        {"dW_nc": "damping - (P * y).subs(x, 1).diff(x) * at(delta(y), 1)"},
        ("derivative of P*y(1, t) is zero",),
    ),
    "derivative of a varied value": (
        {"dW_nc": "damping - P * at(y, 1) * delta(y.subs(x, 1)).diff(x)"},
        ("derivative of delta_y(1, t) is zero",),
    ),
    "derivative in another x": (
        {"dW_nc": "damping - P * at(y.diff(Symbol('x')), 1) * at(delta(y), 1)"},
        ("derivative of y(x, t) is zero", "freebeam_derive.notation"),
    ),
    "derivative not taken": (
        {"dW_nc": "damping - P * Derivative(y.func(1, t), x, evaluate=False) * delta(y.func(1, t))"},
        ("dW_nc", "Derivative(y(1, t), x)", "at(y.diff(x), 1)"),
    ),
    "derivative in a parameter": (
        {"V": "integral(y.diff(x, 2)**2 + Derivative(y, k, evaluate=False)**2)"},
        ("derivative of y(x, t) is zero",),
    ),
    "another y": (
        {"dW_nc": "damping - P * at(y.diff(x), 1) * delta(Function('y')(x, t)).subs(x, 1)"},
        ("delta(y(x, t)) is zero", "the y of freebeam_derive.notation"),
    ),
    "variation of the load": ({"dW_nc": "damping - at(y.diff(x), 1) * delta(P)"}, ("delta(P) is zero",)),
    "variation of a variation": ({"dW_nc": "damping - P * at(y, 1) * delta(delta(y))"}, ("delta(delta_y(x, t))",)),
    "variation of nothing": ({"dW_nc": "damping - P * at(y, 1) * delta(0 * y)"}, ("delta(0) is zero",)),
    "nothing at a place": ({"dW_nc": "damping - P * at(0 * y, 1) * at(delta(y), 1)"}, ("at(0)",)),
    "integral of nothing": ({"V": "integral(y.diff(x, 2)**2) / 2 + k * integral(0 * y)"}, ("integral(0)",)),
    "a term that is zero": (
        {"dW_nc": "damping - P * at(y.diff(x), 1) * at(delta(y), 1) + k * at(x * y, 0) * at(delta(y), 1)"},
        ("dW_nc", "the term", "k*", "is zero"),
    ),
    "an integral that is zero": (
        {"V": "integral(y.diff(x, 2)**2) / 2 + k * Integral(0, (x, 0, 1))"},
        ("V", "the term", "k*Integral(0, (x, 0, 1))", "is zero"),
    ),
    "a term without y": ({"V": "integral(y.diff(x, 2)**2) / 2 + k"}, ("V", "the term k", "no work")),
    "y at an instant": ({"dW_nc": "damping - P * y.diff(x).subs(x, 1) * delta(y.func(1, 0))"}, ("y(1, 0)", "time t")),
    "y at a place that moves": ({"dW_nc": "damping - P * at(y, t) * at(delta(y), 1)"}, ("dW_nc", "fixed place")),
    "y on a stretched beam": ({"dW_nc": "damping - P * integral(y.func(2 * x, t) * delta(y))"}, ("y(2*x, t)",)),
    "y as a limit": (
        {"dW_nc": "damping - P * Limit(y.diff(x), x, 1) * delta(y.subs(x, 1))"},
        ("dW_nc", "outside an integral", "at(..., place)"),
    ),
    "integral at a place": ({"dW_nc": "damping - P * at(integral(y), 1) * at(delta(y), 1)"}, ("dW_nc", "Integral(y")),
    "no number": ({"dW_nc": "damping - P * at(y, 1) * at(delta(y), 1) * oo"}, ("dW_nc", "finite real")),
    "imaginary": ({"W_c": "I * P * integral(y.diff(x)**2)"}, ("W_c", "finite real")),
    "piecewise with a gap": (
        {"V": "integral(Piecewise((1, x < 0.25), (2, x > 0.5)) * y.diff(x, 2)**2)"},
        ("no value between x = 1/4 and x = 1/2", "(1, True)"),
    ),
    # fields, places, jumps
    "bending stiffness that becomes negative": (
        {"V": "integral((1 - 2 * x) * y.diff(x, 2)**2) / 2"},
        ("V", "bending stiffness 1 - 2*x", "at x = 0.5", "positive"),
    ),
    "mass that becomes negative": ({"T": "integral((x - 0.5) * y.diff(t)**2)"}, ("T", "mass", "positive")),
    "stiffness of no real number": (
        {"V": "integral(sqrt(0.4 - x) * y.diff(x, 2)**2) / 2"},
        ("V", "no real number", "x = 0.4"),
    ),
    "place off the beam": ({"T": "integral(y.diff(t)**2) / 2 + at(y.diff(t), 1.5)**2"}, ("T", "off the beam")),
    "parameter's place off the beam": (
        {"T": "integral(y.diff(t)**2) / 2 + at(y.diff(t), 2 * k)**2"},
        ("off the beam",),
    ),
    "two places of no order": (
        {
            "T": "integral(y.diff(t)**2) / 2 + at(y.diff(t), k / 2)**2 + at(y.diff(t), 0.5)**2",
        },
        ("1/2", "k/2", "0.5 at the parameters' defaults"),
    ),
    "integral off the beam": ({"V": "integral(y.diff(x, 2)**2, 0, 2) / 2"}, ("0 to 2", "inside")),
    "integral backwards": ({"V": "integral(y.diff(x, 2)**2) / 2 + integral(y**2, 1, 0)"}, ("lower one first",)),
    "jump of a square": (
        {"V": "integral(y.diff(x, 2)**2) / 2 + jump(y.diff(x)**2, 0.5)"},
        ("jump", "not linear", "jump(y.diff(x), a)**2"),
    ),
    "jump of the moment": (
        {"V": "integral(y.diff(x, 2)**2) / 2 + jump(y.diff(x, 2), 0.5)**2"},
        ("jump of y.diff(x, 2)", "value or slope"),
    ),
    "jump at an end": ({"V": "integral(y.diff(x, 2)**2) / 2 + jump(y.diff(x), 1)**2"}, ("jump", "inside the beam")),
    "slope where it jumps": (
        {
            "V": "integral(y.diff(x, 2)**2) / 2 + k * jump(y.diff(x), 0.5)**2",
            "dW_nc": "-P * at(y.diff(x), 0.5) * at(delta(y), 1)",
        },
        ("on which side", "-1"),
    ),
    "third side": ({"dW_nc": "damping - P * at(y.diff(x), 0.5, 2) * at(delta(y), 1)"}, ("side=2", "-1")),
    "two fields of one name": (
        {
            "T": "integral(y.diff(t)**2 + Field('u').diff(t)**2 + Field('u').diff(t)**2) / 2",
            "V": "integral(y.diff(x, 2)**2 + Field('u').diff(x)**2) / 2",
        },
        ("u: two unknowns have this name",),
    ),
    "field without mass that the load presses": (
        {"V": "integral(y.diff(x, 2)**2 + u.diff(x)**2) / 2", "W_c": "P * integral(u**2) / 2"},
        ("T", "u.diff(t)**2", "mass", "in no product with itself"),
    ),
    "field without stiffness": (
        {"T": "integral(y.diff(t)**2 + u.diff(t)**2) / 2", "V": "integral(y.diff(x, 2)**2 + u**2) / 2"},
        ("V", "u.diff(x)**2"),
    ),
    "coordinate that nothing moves": (
        {"V": "integral(y.diff(x, 2)**2) / 2 + (q - at(y, 1))**2"},
        ("coordinate q", "moved by nothing", "mass"),
    ),
    "field named y": ({"V": "integral(y.diff(x, 2)**2 + Field('y')**2) / 2"}, ("'y'", "not usable")),
    "jump of a coordinate": (
        {"V": "integral(y.diff(x, 2)**2) / 2 + jump(q, 0.5)**2"},
        ("q(t)", "does not vary along the beam"),
    ),
    "ends of one field of two": (
        {
            "T": "integral(y.diff(t)**2 + u.diff(t)**2) / 2",
            "V": "integral(y.diff(x, 2)**2 + u.diff(x)**2) / 2",
            "ends": '{y: ("clamped", "free")}',
        },
        ("ends", "y, u"),
    ),
    "no ends of a beam": ({"ends": "()"}, ("ends", "('clamped', 'free')")),
    "hinge off the beam": ({"releases": "(hinge(1.5),)"}, ("inside the beam",)),
    "releases of numbers": ({"releases": "(0.5,)"}, ("releases", "hinge(0.5)")),
    "damping times damping": (
        {"dW_nc": "damping - alpha * beta * integral(y.diff(t) * delta(y))"},
        ("alpha and beta", "linearly"),
    ),
    "piecewise in y": (
        {"V": "integral(y.diff(x, 2)**2 + Piecewise((y**2, y > 0), (0, True)))"},
        ("V", "piecewise", "not supported"),
    ),
    # symbols
    "another symbol of the name": ({"V": "integral(y.diff(x, 2)**2 + Symbol('k') * y**2)"}, ("V", "k", "one Symbol")),
    "unknown symbol": ({"V": "integral(y.diff(x, 2)**2 + c * y**2)"}, ("V", "c", "Parameter(c")),
    "another P": ({"W_c": "Symbol('P') * integral(y.diff(x)**2)"}, ("W_c", "P", "import P")),
    "symbol with dimensions": ({"V": "EI * integral(y.diff(x, 2)**2)"}, ("V", "EI", "nondimensional")),
    # the rest of the statement
    "unknown end": ({"ends": '("clamped", "guided")'}, ("guided", "sliding")),
    "one end": ({"ends": '("free",)'}, ("ends", "sliding")),
    "no ends": ({"ends": "None"}, ("ends", "sliding")),
    "ends in a list": ({"ends": '["clamped", "free"]'}, ("ends", "pair")),
    "name with capitals": ({"name": '"Beck"'}, ("Beck", "lower-case")),
    "name that leaves the folder": ({"name": '"../beck"'}, ("../beck", "lower-case")),
    "name of two lines": ({"name": '"beck\\n"'}, ("lower-case",)),
    "energy that is none": ({"T": "None"}, ("T", "integral")),
    "energy in a list": ({"V": "[integral(y.diff(x, 2)**2)]"}, ("V", "integral")),
    "one parameter, no tuple": ({"parameters": "Parameter(k, 'k', 1, 0, 2)"}, ("parameters", "tuple")),
    "parameter named as the load": ({"parameters": "(Parameter(P, 'p', 1, 0, 2),)"}, ("'P'", "taken")),
    "parameter named as an argument": ({"parameters": "(Parameter(Symbol('rigid'), 'p', 1, 0, 2),)"}, ("'rigid'",)),
    "parameter named by a keyword": ({"parameters": "(Parameter(Symbol('in'), 'p', 1, 0, 2),)"}, ("'in'",)),
    "parameter named as a call's keyword": (
        {"parameters": "(Parameter(Symbol('kappa'), 'p', 1, 0, 2),)"},
        ("'kappa'", "keyword", "such as kappa_0"),
    ),
    "parameter of no name": ({"parameters": "(Parameter(Symbol('k 1'), 'p', 1, 0, 2),)"}, ("'k 1'", "such as k_0")),
    "parameter of one mode": ({"parameters": "(Parameter(Symbol('k_i'), 'p', 1, 0, 2),)"}, ("'k_i'",)),
    "parameter twice": ({"parameters": "(Parameter(k, 'k', 1, 0, 2), Parameter(k, 'k', 1, 0, 2))"}, ("k", "twice")),
    "default out of range": ({"parameters": "(Parameter(k, 'k', 3, 0, 2),)"}, ("k", "3", "0 to 2")),
    "default not a number": ({"parameters": "(Parameter(k, 'k', float('nan'), 0, 2),)"}, ("k", "nan", "finite")),
    "endless range": ({"parameters": "(Parameter(k, 'k', 1, 0, float('inf')),)"}, ("k", "inf", "finite")),
    "default in words": ({"parameters": "(Parameter(k, 'k', 'one', 0, 2),)"}, ("k", "one", "finite")),
}


@pytest.mark.parametrize("case", REFUSED)
def test_refused_with_the_reason(case: str, tmp_path: Path) -> None:
    changes, words = REFUSED[case]
    message = refusal(written(tmp_path, **changes))
    assert all(word in message for word in words), message


SLOPES = (
    "at(y.diff(x), 1)",
    "y.diff(x).subs(x, 1)",
    "y.diff(x).subs({x: 1.0})",
    "Subs(y.diff(x), x, 1)",
    "Subs(Derivative(y, x), x, 1).doit()",
    "y.func(c, t).diff(c).subs(c, 1)",
)
VARIED = (
    "at(delta(y), 1)",
    "delta(at(y, 1))",
    "delta(y).subs(x, 1)",
    "delta(y.subs(x, 1))",
    "delta(y.subs(x, Float(1)))",
    "Subs(delta(y), x, 1)",
    "delta(Subs(y, x, 1))",
    "delta(y.func(1, t))",
    "delta(y.subs(x, 1)**2) / y.func(1, t) / 2",
)
PRODUCTS = (
    *(f"{slope} * {VARIED[0]}" for slope in SLOPES),
    *(f"{SLOPES[0]} * {varied}" for varied in VARIED[1:]),
    "at(y.diff(x) * delta(y), 1)",
    "(y.diff(x) * delta(y)).subs(x, 1)",
    "at(y.diff(x) * at(delta(y), 1), 1)",
    "Subs(y.diff(x) * delta(y), x, 1)",
)


@pytest.mark.parametrize("product", PRODUCTS)
def test_a_follower_force_is_the_same_however_it_is_spelled(product: str, tmp_path: Path) -> None:
    reference = considered(written(tmp_path)).energies.functional("dW_nc")
    column = statement.load_column(written(tmp_path, dW_nc=f"damping - P * {product} + F_0 * at(delta(y), x_F)"))
    assert column.energies.functional("dW_nc") == reference


def test_the_name_of_the_place_in_a_value_does_not_matter() -> None:
    """SymPy takes values that differ in it for equal, and its cache hands out either."""
    clear_cache()
    c = Symbol("c", real=True)
    value = Subs(Derivative(y.func(c, t), c), c, 1)
    assert value.variables == (c,)
    assert fields_of(value, "V") == fields_of(statement.at(y.diff(x), 1), "V")
    for moving in (Subs(x * Derivative(y.func(c, t), c), c, 1), Subs(y.func(x, c), c, 1)):
        with pytest.raises(StatementError, match=r"not taken at a fixed place|does not vary|time t"):
            fields_of(moving, "V")


def test_a_tip_force_as_an_integral_is_the_same_column(tmp_path: Path) -> None:
    """∫ (y' δy)' dx is y'(1) δy(1) where x = 0 is clamped."""
    conditions = [
        variation.derive_column(statement.load_column(written(tmp_path, dW_nc=f"damping - P * {product}"))).natural
        for product in (PRODUCTS[0], "integral((y.diff(x) * delta(y)).diff(x))")
    ]
    assert conditions[0] == conditions[1]


@pytest.mark.parametrize(
    "form",
    [
        y,
        y.subs(x, 1) ** 2,
        y.func(0, t) * y.diff(x).subs(x, 1),
        statement.at(x * y * y.diff(x, 2), x_F),
        statement.integral(x**2 * y.diff(x) ** 2) + y.diff(t).subs(x, 1) ** 2,
        P * y.diff(x) + statement.at(y, 1) * y,
    ],
)
def test_delta_is_the_derivative_along_the_virtual_displacement(form: Expr) -> None:
    """Eq. (7), on motions that are written out: d/dε of the form at y + ε δy, ε = 0."""
    epsilon = Symbol("epsilon")
    motion, virtual = x**4 * sin(t) + x**2, x**3 + 2 * x + t * x**2

    def on(expression: Expr, deflection: Expr) -> Expr:
        for field, value in ((y, deflection), (variation_of_y, virtual)):
            expression = expression.replace(field.func, Lambda((x, t), value))
        return expression.doit()

    moved = on(form, motion + epsilon * virtual).diff(epsilon).subs(epsilon, 0)
    assert expand(on(statement.delta(form), motion) - moved) == 0


def test_reading_a_file_leaves_sympy_as_it_was(tmp_path: Path) -> None:
    """Derivatives that are zero are refused in a column's file alone, and a file may load another."""
    other = written(tmp_path).rename(tmp_path / "other.py")
    path = written(tmp_path)
    path.write_text(
        f"from freebeam_derive.statement import load_column\nload_column({str(other)!r})\n{path.read_text('utf-8')}",
        encoding="utf-8",
    )
    assert considered(path).name == "sample"
    for lost in ("y.func(1, t).diff(x)", "at(y, 1).diff(x)"):
        assert "is zero" in refusal(written(tmp_path, dW_nc=f"damping - P * {lost} * at(delta(y), 1)"))
        assert y.func(1, t).diff(x) == 0


ACCEPTED = {
    "tip force as an integral": {"dW_nc": "damping - P * integral((y.diff(x) * delta(y)).diff(x))"},
    "distributed follower": {
        "W_c": "P * integral((1 - x) * y.diff(x)**2) / 2",
        "dW_nc": "damping - P * integral(y.diff(x) * delta(y))",
    },
    "follower along half a parameter": {"dW_nc": "damping - k * P * at(y.diff(x), 1) * at(delta(y), 1)"},
    "spring at a free end": {"V": "integral(y.diff(x, 2)**2) / 2 + k * at(y, 1)**2 / 2", "dW_nc": "0"},
    "spring with its share of the damping": {
        "V": "integral(y.diff(x, 2)**2) / 2 + k * at(y, 1)**2 / 2",
        "dW_nc": "damping - alpha * k * at(y.diff(t), 1) * at(delta(y), 1)",
    },
    "turning spring at a pinned end": {
        "V": "integral(y.diff(x, 2)**2) / 2 + k * at(y.diff(x), 0)**2 / 2",
        "ends": '("pinned", "pinned")',
        "dW_nc": "-beta * integral(y.diff(t) * delta(y))",
    },
    "taut string at a free end": {"V": "integral(y.diff(x, 2)**2 + k * y.diff(x)**2) / 2", "dW_nc": "0"},
    "foundation": {"V": "integral(y.diff(x, 2)**2 + k * y**2) / 2"},
    "moment at a pinned end": {
        "ends": '("clamped", "pinned")',
        "dW_nc": "damping + P * at(y.diff(x), 1) * at(delta(y.diff(x)), 1)",
    },
    "force with a potential": {"W_c": "P * integral(y.diff(x)**2) / 2 + F_0 * at(y, x_F)", "dW_nc": "damping"},
    "turning inertia, undamped": {"T": "integral(y.diff(t)**2 + k * y.diff(x, t)**2) / 2", "dW_nc": "0"},
    "dashpot at the tip": {
        "dW_nc": "damping + P * at(delta(y), 1) * at(y, 1) - k * at(y.diff(t), 1) * at(delta(y), 1)"
    },
    "spring that is not damped in proportion": {"V": "integral(y.diff(x, 2)**2) / 2 + k * at(y, 1)**2 / 2"},
    "spring inside": {"V": "integral(y.diff(x, 2)**2) / 2 + k * at(y, Rational(1, 2))**2"},
    "force inside": {"dW_nc": "damping - P * at(y.diff(x), Rational(1, 2)) * at(delta(y), 1)"},
    "fourth power of x": {"W_c": "P * integral(x**4 * y.diff(x)**2)"},
    "sine of x": {"W_c": "P * integral(sin(x) * y.diff(x)**2)"},
    "circulatory foundation": {
        "dW_nc": "damping - P * at(y, 1) * at(delta(y), 1) - k * integral(y.diff(x) * delta(y))"
    },
    "load in V": {"V": "integral(y.diff(x, 2)**2) - P * integral(y.diff(x)**2)", "W_c": "0"},
    "load times a rate": {"dW_nc": "damping - P * integral(y.diff(t) * delta(y))"},
    "load squared": {"W_c": "P**2 * integral(y.diff(x)**2)"},
    "piecewise along the beam": {"V": "integral(Piecewise((1, x < Rational(1, 2)), (2, True)) * y.diff(x, 2)**2)"},
    "half of the beam on a foundation": {"V": "integral(y.diff(x, 2)**2) / 2 + integral(y**2, 0.5, 1)"},
    "tapered, undamped": {"V": "integral((1 + x)**3 * y.diff(x, 2)**2) / 2", "dW_nc": "0"},
}


@pytest.mark.parametrize("case", ACCEPTED)
def test_sense_is_not_refused(case: str, tmp_path: Path) -> None:
    considered(written(tmp_path, **ACCEPTED[case]))


def test_decimals_are_what_they_say(tmp_path: Path) -> None:
    """0.1 in a statement is one tenth; the derivation holds no rounded number."""
    column = statement.load_column(written(tmp_path, W_c="0.1 * P * integral(y.diff(x)**2)", dW_nc="damping"))
    (factor,) = ritz.derive(variation.derive_column(column)).H.along.values()
    assert factor == -1 * factor.func(1) / 5 if factor.is_Integer else factor.p * 5 == -factor.q


@pytest.mark.parametrize(
    ("data", "words"),
    [
        (b"column = (", ("line 1", "does not parse")),
        (b"x = 1\n  y = 2\n", ("line 2", "does not parse")),
        (b"column = 1\0\n", ("does not parse",)),
        (bytes(range(256)), ("does not parse",)),
        (b"raise RuntimeError('one\\ntwo')", ("fails", "RuntimeError", "one two")),
        (b"1 / 0", ("fails", "ZeroDivisionError")),
        (b"import sys\nsys.exit(3)", ("fails", "SystemExit")),
        (b"from freebeam_derive.notation import nothing", ("fails", "nothing")),
        (b"", ("states no column", "column = Column")),
        (b"column = 'beck'", ("states no column", "column = Column")),
        (b"from freebeam_derive.statement import Column\ncolumn = Column", ("states no column",)),
    ],
)
def test_files_that_state_nothing(data: bytes, words: tuple[str, ...], tmp_path: Path) -> None:
    path = tmp_path / "sample.py"
    path.write_bytes(data)
    message = refusal(path)
    assert str(path) in message
    assert "None" not in message
    assert all(word in message for word in words), message


def test_places_where_no_file_is(tmp_path: Path) -> None:
    assert "cannot be read" in refusal(tmp_path / "missing.py")
    assert "is a folder" in refusal(tmp_path)
    assert "is a folder" in refusal(tmp_path / "..")


def test_unknown_name_lists_the_known(tmp_path: Path) -> None:
    with pytest.raises(StatementError) as caught:
        pipeline.find("bech")
    assert all(known in str(caught.value) for known in ("'bech'", "beck", "free-free", "euler-pinned"))
    assert pipeline.find("beck").name == "beck"
    assert pipeline.find(written(tmp_path)).name == "sample"
    assert pipeline.find(str(written(tmp_path))).name == "sample"


def test_no_keyword_of_a_public_call_can_be_a_parameter(tmp_path: Path) -> None:
    """Every name that a call takes beside a column's own parameters, and what a map's dataset holds, are refused."""
    import freebeam as fb

    calls = [getattr(fb, name) for name in fb.__all__ if name != "__version__"]
    calls += [
        method
        for kind in (fb.Column, fb.Question, fb.System)
        for _, method in inspect.getmembers(kind, inspect.isfunction)
    ]
    calls += [getattr(fb.figures, name) for name in fb.figures.__all__]
    calls += [call for _, call in inspect.getmembers(fb.figures.curves, inspect.isfunction)]
    taken = set()
    for call in calls:
        try:
            given = inspect.signature(call).parameters.values()
        except ValueError:  # an error's class has none
            continue
        if any(p.kind is p.VAR_KEYWORD for p in given):
            taken |= {p.name for p in given if p.kind in (p.POSITIONAL_OR_KEYWORD, p.KEYWORD_ONLY)}
    assert {"kappa", "load_max", "chunks", "tolerance", "vectors", "rigid", "progress"} <= taken
    assert taken >= statement.KEYWORDS
    found = fb.stability_map(fb.column("euler-pinned", "modes"), 2, alpha=[0.1, 0.2])
    for name in sorted(taken | {*found.data_vars, *found.attrs}):
        message = refusal(written(tmp_path, parameters=f"(Parameter(Symbol({name!r}), 'p', 1, 0, 2),)"))
        assert f"parameter {name!r}: the name is taken" in message and message.count(";") == 1, message


def test_a_statement_is_checked_when_it_is_made() -> None:
    """No method need be called first: an unsound Column cannot be had."""
    integral = statement.integral
    energies = {"T": integral(y.diff(t) ** 2), "V": integral(y.diff(x, 2) ** 2), "W_c": P * integral(y.diff(x) ** 2)}
    Column("sample", "", **energies, dW_nc=0, ends=("pinned", "pinned"))
    with pytest.raises(StatementError, match="load P"):
        Column("sample", "", **energies | {"W_c": 0}, dW_nc=0, ends=("pinned", "pinned"))


def test_a_letter_of_another_column_is_another_symbol() -> None:
    """SymPy's cache knows values at places by the names of the places alone."""
    for assumptions in ({"real": True}, {"positive": True}):
        k, a = Symbol("k", positive=True), Symbol("a", **assumptions)
        sprung = Column(
            name="sprung",
            title="A spring at a place",
            T=integral(y.diff(t) ** 2) / 2,
            V=integral(y.diff(x, 2) ** 2) / 2 + k * at(y, a) ** 2 / 2 + k * jump(y.diff(x), a) ** 2,
            W_c=P * integral(y.diff(x) ** 2) / 2,
            ends=("clamped", "free"),
            parameters=(Parameter(k, "a stiffness", 1, 0, 2), Parameter(a, "its place", 0.5, 0.1, 0.9)),
        )
        assert sprung.cuts == (a,)
