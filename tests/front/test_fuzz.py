"""Whatever is typed or handed over: an answer or one line, never a traceback, a warning or JSON that is none.

FREEBEAM_FUZZ=10000 draws so many examples of each, at random; else a fixed few hundred are.
"""

from __future__ import annotations

import contextlib
import datetime
import decimal
import fractions
import io
import json
import os
import warnings
from collections.abc import Callable
from typing import Any

import numpy as np
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st

import freebeam as fb
from freebeam import cli

EXAMPLES = int(os.environ.get("FREEBEAM_FUZZ", "200"))
fuzz = settings(
    max_examples=EXAMPLES, deadline=None, derandomize="FREEBEAM_FUZZ" not in os.environ, database=None,
    suppress_health_check=[*HealthCheck],
)  # fmt: skip

# --- command lines ----------------------------------------------------------------------------------------------

WORDS = [
    "nan", "inf", "-inf", "1e308", "-1e308", "1e309", "1e-308", "5e-324", "1e-400", "1e5000", "1e100", "1e60", "9e59",
    "1e-60", "1e-160", "0", "-0", "0+", "1", "-1", "0.5", "1/3", "1/0", "0/0", "1e-14",
    "1e-3", "10", "88", "120", "1e3", "1e4", "x",
    "", " ", "0x10", "1_0", "1e", "--", "٣", "1+0j", "True", "1,5", "'", "[red]", "9" * 5000,
]  # fmt: skip
plain = st.sampled_from(["0", "0.01", "0.1", "1", "1e-3", "10", "50", "100"])
number = st.one_of(plain, plain, st.sampled_from(WORDS), st.floats().map(repr), st.floats(0, 200).map(repr))
whole = st.one_of(
    st.integers(1, 9).map(str), st.sampled_from(["0", "-1", "1e1", "2.5", "x", "9" * 30, "1000000", "12"])
)
column = st.sampled_from(["free-free", "beck", "euler-pinned", "beck", "beam", "", "no/such.py", "/", ".", "x" * 300])
basis = st.sampled_from(["modes", "legendre", "legendre", "fourier", ""])
assigned = st.one_of(
    number.map(lambda x: f"eta={x}"), st.sampled_from(["eta", "=1", "eta=", "theta=1", "eta=1=2", "N=8", "alpha=1"])
)
case = {"--column": column, "--basis": basis, "--modes": whole, "-N": whole, "--set": assigned}
damping = {"--alpha": number, "--beta": number}
units = {"--bending-stiffness": number, "--mass-per-length": number, "--length": number}
flag = st.just(None)
OPTIONS: dict[str, dict[str, st.SearchStrategy[Any]]] = {
    "critical": {
        **case, **damping, "--load-max": number, "--kappa": number, "--exact": flag, "--all": flag,
        "--truncation": flag, "--digits": st.sampled_from(["1", "5", "20", "0", "-3", "x"]),
        "--certificate": st.sampled_from(["no/such.json", ".", ""]),
    },
    "spectrum": {
        **case, **damping, "--load": number, "--rigid": flag, "--exact": flag,
        "--digits": st.sampled_from(["1", "5", "20", "0", "x"]),
    },
    "respond": {
        **case, **damping, "--load": number, "--rigid": flag, "--sensor": number, "--force-amplitude": number,
        "--force-frequency": number, "--force-position": number, "--initial-mode": whole, "--initial-amplitude": number,
        "--initial-velocity": number, "--quantity": st.sampled_from(["y", "dy", "ddy", "z"]),
        "--method": st.sampled_from(["exact", "newmark", "euler"]), "--output": st.sampled_from(["r.txt", "no/r.csv"]),
    },
    "map": {
        **case, "--load-max": number, "--linear": flag, "--no-convergence": flag, "--workers": whole,
        "--store": st.just("no/such"), "--output": st.sampled_from(["m.txt", "no/m.csv", "m"]),
        "--alpha": st.tuples(number, number, whole), "--beta": st.tuples(number, number, whole),
        "--axis": st.tuples(st.sampled_from(["eta", "alpha", "beta", "load", ""]), number, number, whole),
    },
    "pulse": {
        **case, **damping, "--load": number, "--frequency": st.tuples(number, number, whole),
        "--amplitude": st.tuples(number, number, whole), "--output": st.sampled_from(["p.txt", "no/p.csv", "p"]),
    },
    "show": {**case, **damping, "--load-max": number, "--output": st.sampled_from(["s.txt", "no/s.png", "."])},
    "columns": {},
    "validate": {"--loads": st.just(None), "--output": st.sampled_from(["no/such.md", "."])},
    "verify": {},
    "figures": {"--output": st.just("/dev/null/no"), "--format": st.sampled_from(["gif", "pdf"])},
    "explore": {"--output": st.sampled_from(["no/such.html", "x.txt", "."]), "--column": column, "--basis": basis},
    "lesson": {"--output": st.just("no/such.md"), "--format": st.sampled_from(["md", "doc"]), "--column": column},
    "generate": {"--output": st.sampled_from(["", "no"]), "--check": flag},
}  # fmt: skip
NEEDED = {
    "spectrum": ["--load"],
    "pulse": ["--load", "--frequency", "--amplitude"],
    "respond": ["--load"],
    "validate": ["--loads"],
}
NAMED = {"verify": ["no/such.json", "/dev/null", "."], "figures": ["99", "x"], "generate": ["no-such", "no/such.py"]}


@st.composite
def lines(draw: st.DrawFn) -> list[str]:
    """A command with options, contradicting and repeated ones among them."""
    command = draw(st.sampled_from([*["critical", "spectrum", "respond", "map", "pulse"] * 4, *OPTIONS]))
    options = OPTIONS[command]
    names = draw(st.lists(st.sampled_from([*options]), max_size=6)) if options else []
    words = [
        command,
        *draw(st.lists(st.sampled_from(NAMED[command]), min_size=1, max_size=2) if command in NAMED else st.just([])),
    ]
    if command == "validate" or draw(st.integers(0, 9)):  # all of it takes half a minute
        names += [name for name in NEEDED.get(command, []) if name not in names]
    if draw(st.integers(0, 5)) == 0:
        names += [*units]
    if command == "map" and not {"--alpha", "--beta", "--axis"} & {*names} and draw(st.booleans()):
        names.append("--beta")
    for name in names:
        value = draw({**options, **units}[name])
        words += [name, *([] if value is None else [value] if isinstance(value, str) else value)]
    if command == "respond":
        step = draw(number)
        words += ["--step", step, "--duration", draw(st.one_of(number, st.just(f"{step}e2"), st.just("1")))]
        assume(_rows(words) < 1e5)
    if draw(st.booleans()):
        words.append("--json")
    if draw(st.integers(0, 19)) == 0:
        words.append(draw(st.sampled_from(["--help", "--no-such", "extra", "-x", "--json=1"])))
    return words


def _rows(words: list[str]) -> float:
    """Rows of a response, where it is not refused for being too long: what costs minutes is no subject here."""
    try:
        rows = float(words[words.index("--duration") + 1]) / float(words[words.index("--step") + 1])
    except (ValueError, ZeroDivisionError):
        return 0
    return 0 if rows > 1e12 else rows


def run(words: list[str]) -> tuple[int, str, str]:
    """Exit status, standard output and standard error. A warning fails the test."""
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err), warnings.catch_warnings():
        warnings.simplefilter("error")
        status = cli.main(words)
    return status, out.getvalue(), err.getvalue()


def refuse(name: str) -> None:
    raise AssertionError(f"{name} in JSON")


@fuzz
@given(lines())
def test_every_command_line_ends_well(words: list[str]) -> None:
    status, out, err = run(words)
    assert status in (0, 1, 2)
    if status == 2:
        assert out == "" and err.count("\n") == 1 and err.startswith("freebeam: ") and len(err) < 1000
    else:  # a response may have its warnings told
        assert all(line.startswith("warning: ") for line in err.splitlines())
        if "--json" in words and "--help" not in words:
            json.loads(out, parse_constant=refuse)


def test_a_usage_error_points_to_the_help_of_its_command() -> None:
    for words in (["critical", "--no-such"], ["spectrum"], ["map", "--modes", "x"], ["respond", "--load", "x"]):
        status, _, err = run(words)
        assert status == 2 and err.endswith(f"; see freebeam {words[0]} --help\n")
    assert run(["no-such"])[2].endswith("; see freebeam --help\n")


# --- Python -----------------------------------------------------------------------------------------------------

ODD = [
    None, True, np.True_, "1", b"1", 1j, np.complex128(1), [True, 1.0], ["1"], [1, "1"], [[1, 2], [3]], [1j],
    np.ma.masked, np.ma.array([1.0, 2.0], mask=[0, 1]), np.ma.array(1.0), np.datetime64("2001-01-01"),
    np.timedelta64(1, "s"), datetime.timedelta(1), np.array(["2001-01-01"], dtype="M8"), np.array([True]), {}, {1.0},
    object(), object, len, [None], np.array([None]), 10**400, -(10**400), 10**5000, fractions.Fraction(10**400),
    [10**400], math_nan := float("nan"), float("inf"), [1.0, math_nan], np.array([np.inf]), decimal.Decimal("NaN"),
    decimal.Decimal("1e999"), np.float64(1e308), -1e308, [1e308], 1e101, np.empty((0,)), np.empty((2, 0)),
    np.zeros((1, 1, 1)), range(3), iter([1.0]), fb, fb.column("beck"), np.longdouble("1e400"), "",
]  # fmt: skip
FINE = [
    0, 1, 0.5, 5e-324, 1e-308, 1e-160, -0.0, np.float32(0.1), np.int8(3), fractions.Fraction(1, 3),
    decimal.Decimal("0.1"), 9e59, 1e50, np.array(0.25), [0.1, 0.2], [[0.1], [0.2]], np.array([1e-3, 1e3]), (1, 2.5),
]  # fmt: skip
value = st.one_of(st.sampled_from(FINE), st.sampled_from(FINE), st.sampled_from(ODD), st.floats())
own_column = st.sampled_from(
    [fb.column("beck"), fb.column("beck"), fb.column("free-free"), fb.column("beck", "legendre"), *ODD[:3]]
)


def systems(ask: Callable[..., Any]) -> Callable[..., Any]:
    """A question of a column's system as one of the column; what is no column is handed on."""

    def asked(own: Any, **given: Any) -> Any:
        of = {"modes": 3, **{key: given.pop(key) for key in SYSTEM if key in given}}
        return ask(own.system(**of) if isinstance(own, fb.Column) else own, **given)

    return asked


SYSTEM = ["load", "alpha", "beta", "eta", "rigid", "modes"]
ASKED: dict[str, tuple[Callable[..., Any], list[str], dict[str, Any]]] = {
    "critical_load": (fb.critical_load, ["modes", "alpha", "beta", "load_max", "kappa", "eta", "N"], {}),
    "critical_loads": (fb.critical_loads, ["modes", "alpha", "beta", "load_max", "eta"], {}),
    "eigenvalues": (fb.eigenvalues, ["load", "alpha", "beta", "modes", "eta"], {}),
    "branches": (fb.branches, ["loads", "alpha", "beta", "eta", "rigid"], {"loads": [1, 2]}),
    "spectrum": (systems(fb.spectrum), SYSTEM, {}),
    "spectrum of": (fb.spectrum, [], {}),
    "shapes": (systems(lambda system, **given: system.shapes(**given)), ["x", "derivative"], {"x": 0.5}),
    "Q": (systems(lambda system, **given: system.Q(**given)), ["x_F"], {"x_F": 1.0}),
    "scales": (
        fb.Column.scales,
        ["bending_stiffness", "mass_per_length", "length"],
        {"bending_stiffness": 1.0, "mass_per_length": 1.0, "length": 1.0},
    ),
    "stability_map": (fb.stability_map, ["alpha", "beta", "eta", "load_max", "chunks"], {"modes": 3}),
    "trace_boundary": (
        fb.trace_boundary,
        ["parameter", "low", "high", "tolerance", "load_max"],
        {"parameter": "beta", "low": 0.1, "high": 1.0, "modes": 2},
    ),
    "respond": (
        systems(fb.respond),
        ["duration", "step", "initial", "initial_velocity", "sensors", "outputs", "force", "force_position", "method"],
        {"duration": 0.4, "step": 0.1},
    ),
    "state_space": (systems(fb.state_space), ["force_position", "sensors", "outputs"], {"force_position": 1.0}),
    "certified_load": (fb.certified_load, ["modes", "alpha", "beta", "digits", "eta", "load_max"], {}),
    "exact_spectrum": (fb.exact_spectrum, ["load", "alpha", "beta", "eta"], {"load": 1, "digits": 5, "modes": 2}),
}
METHODS = ("shapes", "Q", "scales")  # which only a column has


@st.composite
def questions(draw: st.DrawFn) -> tuple[str, Any, dict[str, Any]]:
    name = draw(st.sampled_from([*ASKED]))
    _, known, given_ = ASKED[name]
    drawn = draw(st.lists(st.sampled_from(known), max_size=3)) if known else []
    own = draw(own_column)
    assume(name not in METHODS or isinstance(own, fb.Column))
    return name, own, given_ | {key: draw(value) for key in drawn}


@fuzz
@given(questions())
def test_every_question_is_answered_or_refused_in_one_line(question: tuple[str, Any, dict[str, Any]]) -> None:
    name, own, given_ = question
    if name == "respond":  # what takes minutes is no subject here
        with contextlib.suppress(TypeError, ValueError, ArithmeticError, RuntimeWarning):
            assume(not 1e5 < given_["duration"] / given_["step"] < 1e12)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        try:
            ASKED[name][0](own, **given_)
        except fb.InputError as error:
            assert "\n" not in str(error) and len(str(error)) < 1000
