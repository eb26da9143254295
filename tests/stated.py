"""Columns of the literature as a user would state them, by the names of tests/reference/values.py.

Each is Beck's column with changes, as the text of a file; beside it is what is asked: alpha and beta.
"""

from __future__ import annotations

from pathlib import Path

HEAD = """
from sympy import Piecewise, Rational, Symbol, exp, pi, sqrt
from freebeam_derive.notation import F_0, P, alpha, beta, t, x, x_F, y
from freebeam_derive.statement import Column, Coordinate, Field, Parameter, at, delta, hinge, integral, jump

mu, k, c, b, g, a = (Symbol(name, real=True) for name in ("mu", "k", "c", "b", "g", "a"))
psi, q, p = Field("psi", r"\\psi"), Coordinate("q"), Coordinate("p")
half = Rational(1, 2)
T = integral(y.diff(t) ** 2) / 2
V = integral(y.diff(x, 2) ** 2) / 2
W_c = P * integral(y.diff(x) ** 2) / 2
follower = -P * at(y.diff(x), 1) * at(delta(y), 1)
external = -integral(beta * y.diff(t) * delta(y))
internal = -integral(alpha * y.diff(x, 2, t) * delta(y.diff(x, 2)))


def own(symbol, value):
    return Parameter(symbol, str(symbol), value, 0.0, 1000.0)

"""
BECK = {"T": "T", "V": "V", "W_c": "W_c", "dW_nc": "follower", "ends": '("clamped", "free")', "parameters": "()"}
FREE = {"ends": '("free", "free")', "W_c": "P * integral(x * y.diff(x) ** 2) / 2"}
PANEL = {"W_c": "0", "dW_nc": "-P * integral(y.diff(x) * delta(y))"}
TIMOSHENKO = {
    "T": "integral(y.diff(t) ** 2 + psi.diff(t) ** 2 * b) / 2",
    "V": "integral(psi.diff(x) ** 2 + k * (y.diff(x) - psi) ** 2) / 2",
}

Asked = dict[str, float]
STATED: dict[str, tuple[dict[str, str], Asked]] = {
    "beck": ({}, {}),
    "pflueger": ({"T": "T + mu * at(y.diff(t), 1) ** 2 / 2", "parameters": "(own(mu, 1.0),)"}, {}),
    "pflueger, beam damped": (
        {"T": "T + mu * at(y.diff(t), 1) ** 2 / 2", "dW_nc": "follower + external", "parameters": "(own(mu, 1.0),)"},
        {"beta": 0.5},
    ),
    "rotary tip mass": ({"T": "T + at(y.diff(t), 1) ** 2 / 2 + 0.1 * at(y.diff(x, t), 1) ** 2 / 2"}, {}),
    "mass at mid-span": ({"T": "T + at(y.diff(t), a) ** 2 / 4", "parameters": "(own(a, 0.5),)"}, {}),
    "tip spring 10": ({"V": "V + 10 * at(y, 1) ** 2 / 2"}, {}),
    "tip spring 35": ({"V": "V + k * at(y, 1) ** 2 / 2", "parameters": "(own(k, 35.0),)"}, {}),
    "elastic root": ({"V": "V + 5 * at(y.diff(x), 0) ** 2 / 2", "ends": '("pinned", "free")'}, {}),
    "free-free with a point mass": (
        FREE
        | {
            "T": "T + mu * at(y.diff(t), 0) ** 2 / 2",
            "W_c": "P * integral((x + mu) / (1 + mu) * y.diff(x) ** 2) / 2",
            "parameters": "(own(mu, 0.5),)",
        },
        {},
    ),
    **{
        f"beal, sensor at {name}": (
            FREE
            | {
                "dW_nc": f"-P * (at(y.diff(x), 1) + k * at(y.diff(x), {place})) * at(delta(y), 1)",
                "parameters": "(own(k, 0.1), own(a, 0.25))",
            },
            {},
        )
        for name, place in (("0", "0"), ("1/4", "a"), ("1/2", "0.5"), ("1", "1"))
    },
    "taper": (
        {"T": "integral((1 - x / 2) * y.diff(t) ** 2) / 2", "V": "integral((1 - x / 2) ** 3 * y.diff(x, 2) ** 2) / 2"},
        {},
    ),
    "cone": (
        {
            "T": "integral((1 - x / 2) ** 2 * y.diff(t) ** 2) / 2",
            "V": "integral((1 - x / 2) ** 4 * y.diff(x, 2) ** 2) / 2",
        },
        {},
    ),
    "step": ({"V": "integral(Piecewise((1, x < half), (half, True)) * y.diff(x, 2) ** 2) / 2"}, {}),
    "tip damper": (
        {"dW_nc": "follower - c * at(y.diff(t), 1) * at(delta(y), 1)", "parameters": "(own(c, 0.5),)"},
        {},
    ),
    "weight": ({"V": "V - g * integral((1 - x) * y.diff(x) ** 2) / 2", "parameters": "(own(g, 3.0),)"}, {}),
    "dead load beside": ({"V": "V - b * integral(y.diff(x) ** 2) / 2", "parameters": "(own(b, 1.0),)"}, {}),
    "foundation": (
        {"V": "V + 100 * integral(y ** 2) / 2", "dW_nc": "follower + external + internal"},
        {"alpha": 0.01, "beta": 0.1},
    ),
    "pipe": (
        {
            "W_c": "P ** 2 * integral(y.diff(x) ** 2) / 2",
            "dW_nc": "-P ** 2 * at(y.diff(x), 1) * at(delta(y), 1)"
            " - 2 * sqrt(b) * P * integral(y.diff(x, t) * delta(y))",
            "parameters": "(own(b, 0.1),)",
        },
        {},
    ),
    "panel, pinned": (PANEL | {"ends": '("pinned", "pinned")'}, {}),
    "panel, clamped": (PANEL | {"ends": '("clamped", "clamped")'}, {}),
    "panel, cantilevered": (PANEL, {}),
    "gravity": ({"W_c": "P * integral((1 - x) * y.diff(x) ** 2) / 2", "dW_nc": "0"}, {}),
    "euler, pinned": ({"dW_nc": "0", "ends": '("pinned", "pinned")'}, {}),
    "euler, clamped": ({"dW_nc": "0", "ends": '("clamped", "clamped")'}, {}),
    "euler, clamped and pinned": ({"dW_nc": "0", "ends": '("clamped", "pinned")'}, {}),
    "euler, cantilever": ({"dW_nc": "0"}, {}),
    "rayleigh": ({"T": "T + b * integral(y.diff(x, t) ** 2) / 2", "parameters": "(own(b, 0.01),)"}, {}),
    "crack": ({"V": "V + k * jump(y.diff(x), 0.4) ** 2 / 2", "parameters": "(own(k, 10.0),)"}, {}),
    "elastic hinge at mid-span": ({"V": "V + 2 * jump(y.diff(x), half) ** 2 / 2"}, {}),
    "shear joint": ({"V": "V + 50 * jump(y, 0.5) ** 2 / 2"}, {}),
    "leipholz": (
        {
            "W_c": "P * integral((1 - x) * y.diff(x) ** 2) / 2",
            "dW_nc": "-P * integral(y.diff(x) * delta(y))",
        },
        {},
    ),
    "hauger": (
        {
            "W_c": "P * integral((1 - x) ** 2 * y.diff(x) ** 2) / 4",
            "dW_nc": "-P * integral((1 - x) * y.diff(x) * delta(y))",
        },
        {},
    ),
    "follower at 7/10": (
        {
            "W_c": "P * integral(y.diff(x) ** 2, 0, a) / 2",
            "dW_nc": "-P * at(y.diff(x), a) * at(delta(y), a)",
            "parameters": "(own(a, 0.7),)",
        },
        {},
    ),
    "step with a mass": (
        {
            "T": "integral(Piecewise((1, x < 0.6), (half, True)) * y.diff(t) ** 2) / 2"
            " + 0.3 * at(y.diff(t), 0.6) ** 2 / 2",
            "V": "integral(Piecewise((1, x < 0.6), (half, True)) * y.diff(x, 2) ** 2) / 2",
        },
        {},
    ),
    "absorber": (
        {
            "T": "T + 0.1 * q.diff(t) ** 2 / 2",
            "V": "V + 10 * (at(y, 0.7) - q) ** 2 / 4",
            "dW_nc": "follower + external + internal - 0.1 * (at(y.diff(t), 0.7) - q.diff(t)) * delta(at(y, 0.7) - q)",
        },
        {"alpha": 0.01, "beta": 0.1},
    ),
    "pipe on a foundation": (
        {
            "V": "V + 50 * integral(y ** 2) / 2",
            "W_c": "0",
            "dW_nc": "-P ** 2 * integral(y.diff(x, 2) * delta(y))"
            " - 2 * sqrt(b) * P * integral(y.diff(x, t) * delta(y))",
            "parameters": "(own(b, 0.3),)",
        },
        {},
    ),
    "exponential taper": ({"V": "integral(exp(-x) * y.diff(x, 2) ** 2) / 2"}, {}),
    "panel, clamped at its rear": (PANEL | {"ends": '("free", "clamped")'}, {}),
    "partial damping": ({"dW_nc": "follower - integral(y.diff(t) * delta(y), half, 1)"}, {}),
    "force by a remote slope": (
        {"dW_nc": "follower + external + internal - P / 5 * at(y.diff(x), 0.4) * at(delta(y), 1)"},
        {"alpha": 0.01, "beta": 0.1},
    ),
    **{
        f"timoshenko, s = {s}, r = 1/{s}, turning with {turns}": (
            TIMOSHENKO
            | {"dW_nc": f"-P * at({sees}, 1) * at(delta(y), 1)", "parameters": f"(own(k, {s}.0), own(b, {1 / s}))"},
            {},
        )
        for s in (100, 1000)
        for turns, sees in (("ψ", "psi"), ("y'", "y.diff(x)"))
    },
}


def stated(folder: Path, name: str) -> tuple[Path, Asked]:
    """The file of a column, and what is asked of it."""
    changes, asked = STATED[name]
    return file_of(folder, name, changes), asked


def file_of(folder: Path, title: str, changes: dict[str, str]) -> Path:
    """The file of Beck's column with changes."""
    fields = {"name": '"sample"', "title": repr(title.replace("'", "")), **BECK, **changes}
    path = folder / "sample.py"
    body = ",\n    ".join(f"{key}={value}" for key, value in fields.items())
    path.write_text(f"{HEAD}\ncolumn = Column(\n    {body},\n)\n", encoding="utf-8")
    return path
