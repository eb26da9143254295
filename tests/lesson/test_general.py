"""The lesson on a column of segments, fields and coordinates: what is printed is what was stated, and is proven."""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Mapping
from functools import cache
from importlib import import_module
from pathlib import Path
from typing import Any

import html5lib
import pytest
import sympy as sp
from sympy import Add, Expr, Integral, Rational, S, expand, integrate

import freebeam as fb
from freebeam.lesson import lesson, printed, solutions
from freebeam.lesson.blocks import Cell, Equation, Exercise, Figure, Heading, Lesson, Prose, Summary, Table
from freebeam.lesson.draws import USUAL, drawn
from freebeam.lesson.stages import Chapter
from freebeam_derive import general_steps, latex, motions, pipeline, statement, step_proofs, variation
from freebeam_derive.forms import BilinearForm
from freebeam_derive.jets import ALONG, beside, jet, leap, segment_of, trial, varying
from freebeam_derive.notation import F_0, P, t, x, y
from freebeam_derive.pipeline import GeneralDerived
from freebeam_derive.record import Step
from freebeam_derive.statement import Functional, at, delta, integral, jets
from freebeam_sym.columns import Column
from tests.derive.test_language import CASES, at_motion, polynomials
from tests.derive.test_language import stated as on_statement
from tests.lesson.reading import DIRAC, Reader

READ = ("crack", "Timoshenko", "absorber", "pipe", "Ziegler")


@cache
def derived(name: str) -> GeneralDerived:
    return pipeline.general(CASES[name]())


@pytest.fixture(params=READ)
def name(request: pytest.FixtureRequest) -> str:
    return str(request.param)


# --- what is printed re-evaluates to the statement ------------------------------------------------------------------


def reader(d: GeneralDerived, printer: latex.Printer) -> Reader:
    fields: dict[str, tuple[Expr, bool]] = {}
    for unknown in (*d.column.fields, *d.column.coordinates):
        letter, coordinate = printer.own.get(unknown, unknown), unknown in d.column.coordinates
        fields[letter] = (trial(unknown), coordinate)
        fields[rf"\delta {letter}"] = (varying(unknown), coordinate)
        own = (r"\varphi_{i}", r"\varphi_{j}")
        if unknown != "y":
            own = (printer.own[f"trial_{unknown}_i"], printer.own[f"trial_{unknown}_j"])
        fields |= {own[0]: (varying(unknown), coordinate), own[1]: (trial(unknown), coordinate)}
    return Reader(fields, {printer.own[p.name]: p.symbol for p in d.column.parameters})


Parts = dict[int | None, Expr]
"""Densities in jets by segments, and under None what stands outside of integrals."""


def parts(d: GeneralDerived, read: Expr) -> Parts:
    """What was read: the densities of its integrals on each segment, and its values at places, jumps as differences."""
    places, found = d.motion.beam.places, {}
    for term in Add.make_args(expand(sided(read))):
        inside = [f for f in sp.Mul.make_args(term) if isinstance(f, Integral)]
        segments: list[int | None] = [None]
        if inside:
            low, high = (places.index(bound) for bound in inside[0].limits[0][1:])
            segments, term = list(range(low, high)), term / inside[0] * inside[0].function
        for segment in segments:
            found[segment] = found.get(segment, S.Zero) + term
    return cleaned(found)


def of_functional(d: GeneralDerived, work: Functional) -> Parts:
    """The same of a functional."""
    found: Parts = {None: work.points}
    for term in Add.make_args(work.density) if work.density != 0 else ():
        (segment,) = {k for j in jets(term) if (k := segment_of(j.args[3])) is not None}
        found[segment] = found.get(segment, S.Zero) + bare(d, term)
    return cleaned(found)


def cleaned(found: Parts) -> Parts:
    return {key: whole for key, value in found.items() if (whole := expand(value)) != 0}


def bare(d: GeneralDerived, density: Expr) -> Expr:
    """A density of a segment with jets ALONG, as they are read."""
    return density.xreplace({j: jet(*j.args[:3], ALONG) for j in jets(density) if segment_of(j.args[3]) is not None})


def sided(read: Expr) -> Expr:
    """Jumps as differences of both sides."""

    def both(which: Expr, p: Expr, r: Expr, place: Expr) -> Expr:
        if place.func != leap:
            return jet(which, p, r, place)
        return jet(which, p, r, beside(place.args[0], 1)) - jet(which, p, r, beside(place.args[0], -1))

    return read.replace(jet, both)


def same_but_for_sign(one: Parts, other: Parts) -> bool:
    """An equation with zero on its right says the same with its signs changed."""
    return one == other or one == {key: expand(-value) for key, value in other.items()}


def lines_of(d: GeneralDerived, what: str) -> list[str]:
    """The lines of a step's result as the lesson prints them, what is broken put together."""
    step = next(step for step in d.steps if step.what == what)
    found: list[str] = []
    for line in Chapter(d, False).lines(step, step.after):
        if line.startswith(("& \\quad", "&\\quad")):
            found[-1] += " " + line
        else:
            found.append(line)
    return found


def test_printed_equations_and_conditions_are_those_of_the_statement(name: str) -> None:
    """Each printed line, read back by its signs alone, is what the derivation gives, at the places before it.

    tests/derive/test_language.py evaluates that and the statement on motions that are polynomials on segments.
    """
    d = derived(name)
    motion, printer = d.motion, latex.printer(d.column)
    read = reader(d, printer)
    (weak,) = lines_of(d, "Read off the weak form")
    assert same_but_for_sign(parts(d, read.read(weak)), of_functional(d, motion.weak))
    edges = [printer.place(place) for place in motion.beam.places]
    stated = [(k, bare(d, factor)) for (_, k), factor in motion.equations.items()]
    works = [of_functional(d, work) for work in motion.of_coordinates.values()]
    for line in lines_of(d, "State the equation of motion"):
        where, _, equation = line.rpartition(r"\colon")
        found = read.read(equation)
        pushed, along = found.coeff(DIRAC), found.subs(DIRAC, 0)
        assert pushed in (S.Zero, -F_0)
        for segment in [edges.index(low) for low in re.findall(r"([\w.]+) < x <", where)] if where else [0]:
            if stated:
                number, factor = stated.pop(0)
                assert number == segment and same_but_for_sign(parts(d, along), cleaned({None: factor}))
                assert bool(pushed) == bool(motion.forces)
            else:
                assert same_but_for_sign(parts(d, found), works.pop(0))
    assert not stated and not works
    if motion.spaces:
        conditions = lines_of(d, "State the natural end conditions")
        labels = [line.rpartition(r"\colon")[0].removeprefix("x = ") for line in conditions]
        assert labels == [edges[c.place] for c in motion.conditions]
        for line, condition in zip(conditions, motion.conditions, strict=True):
            found = parts(d, read.read(line.rpartition(r"\colon")[2]))
            assert same_but_for_sign(found, cleaned({None: condition.factor})), line


def test_printed_matrices_are_the_forms(name: str) -> None:
    d = derived(name)
    printer = latex.printer(d.column)
    read = reader(d, printer)
    forms = {
        printer.doprint(general_steps._entry(letter, power, len(powers))): form
        for letter, powers in general_steps._matrices(d).items()
        for power, form in enumerate(powers)
        if form
    }
    seen = 0
    for line in lines_of(d, "Substitute it into the weak form"):
        left, _, right = line.partition(" &= ")
        if not left.startswith("Q"):
            assert parts(d, read.read(right)) == of_functional(d, general_steps.functional(d, forms[left])), line
            seen += 1
    assert seen == len(forms)


def test_the_printed_weak_form_on_motions_is_the_statement() -> None:
    """Hamilton's principle for the statement as it stands, by SymPy alone, on polynomials; δy = 0 at t = 0 and 1."""
    d = derived("pipe")
    motion, column = d.motion, d.column
    moving, still = polynomials(column, motion, 3, False), polynomials(column, motion, 5, True)
    moved = {name: [t * (1 - t) * piece for piece in pieces] for name, pieces in still.items()}
    total = on_statement(column, "dW_nc", motion, moving, moved)
    for name, sign in (("T", 1), ("V", -1), ("W_c", 1)):
        sides = [motions.added(as_motion(moving), as_motion(moved), side) for side in (1, -1)]
        above, below = (on_statement(column, name, motion, {k: list(u) for k, u in of.items()}) for of in sides)
        total += sign * (above - below) / 2
    (weak,) = lines_of(d, "Read off the weak form")
    found = parts(d, reader(d, latex.printer(column)).read(weak))
    printed_form = at_motion(found.get(None, S.Zero), motion, moving, moved)
    printed_form += integrate(at_motion(found[0], motion, moving, moved), (x, 0, 1))
    left, right = (integrate(expand(e), (t, 0, 1)) for e in (total, printed_form))
    assert expand(left - right) == 0 or expand(left + right) == 0
    assert expand(left) != 0


def as_motion(of: Mapping[str, Any]) -> dict[str, Any]:
    return {name: tuple(pieces) for name, pieces in of.items()}


def test_a_formula_that_is_misread_is_noticed() -> None:
    """The reader knows signs, places, sides and orders."""
    d = derived("crack")
    read = reader(d, latex.printer(d.column))
    lines = [line.rpartition(r"\colon")[2] for line in lines_of(d, "State the natural end conditions")]
    for old, new in ((r"0.4^{-}", r"0.4^{+}"), (r"\prime\prime", r"\prime"), ("- k", "+ k"), (r"\dot{y}", "y")):
        line = next(line for line in lines if old in line)
        one, other = (parts(d, read.read(text)) for text in (line, line.replace(old, new, 1)))
        assert not same_but_for_sign(one, other)


# --- steps are proven, and wrong ones are not -----------------------------------------------------------------------


@pytest.mark.parametrize("case", ["pipe", "Ziegler"])
def test_every_step_is_proven_by_another_route(case: str) -> None:
    """A column with segments is in the lesson below."""
    left = [step.residual() for step in derived(case).steps if step.stage != "newmark"]
    assert len(left) > 10 and max(left) == 0


@pytest.mark.parametrize("name", ["pipe", "ziegler"])
def test_a_statement_in_si_is_shown_to_be_the_same_on_a_motion(name: str) -> None:
    """Also where the size of the load holds the root of a parameter; another size leaves something."""
    d = pipeline.general(import_module(f"freebeam_derive.columns.gallery.{name}").column)
    steps = [step for step in d.steps if step.stage == "scaling"]
    assert len(steps) == 4 and max(step.residual() for step in steps) == 0
    given = d.column.dimensional
    assert given is not None
    bad = {**given.scaling, P: 2 * d.column.scales["load"] * P}
    wrong = dataclasses.replace(
        d, column=dataclasses.replace(d.column, dimensional=dataclasses.replace(given, scaling=bad))
    )
    (proven,) = step_proofs.attach(wrong, [dataclasses.replace(steps[-1], proof=None)])
    with pytest.raises(AssertionError, match="leaves"):
        proven.residual()


def reproven(d: GeneralDerived, what: str) -> float:
    (step,) = (s for s in (*d.motion.steps, *general_steps.steps(d)) if s.what == what)
    (step,) = step_proofs.attach(d, [step])
    return step.residual()


def wrong_motion(d: GeneralDerived, **changes: Any) -> GeneralDerived:
    return dataclasses.replace(d, motion=dataclasses.replace(d.motion, **changes))


def test_a_wrong_equation_or_condition_is_not_proven() -> None:
    d = derived("crack")
    key, factor = next(iter(d.motion.equations.items()))
    bad = {**d.motion.equations, key: factor + next(iter(jets(factor)))}
    condition = d.motion.conditions[1]
    turned = (d.motion.conditions[0], dataclasses.replace(condition, factor=-condition.factor))
    for wrong, what in (
        (wrong_motion(d, equations=bad), "State the equation of motion"),
        (wrong_motion(d, conditions=(*turned, *d.motion.conditions[2:])), "State the natural end conditions"),
        (wrong_motion(d, weak=d.motion.weak.scaled(2)), "Read off the weak form"),
    ):
        assert reproven(d, what) == 0
        with pytest.raises(AssertionError, match="leaves"):
            reproven(wrong, what)


def test_a_wrong_form_is_not_proven() -> None:
    """The load's matrix transposed: a follower force that acts on the slope."""
    d = derived("Timoshenko")
    K = d.system.K
    wrong = dataclasses.replace(d, system=dataclasses.replace(d.system, K=(K[0], K[1].transposed)))
    assert reproven(d, "Substitute it into the weak form") == 0
    with pytest.raises(AssertionError, match="leaves"):
        reproven(wrong, "Substitute it into the weak form")


def test_functions_of_x_are_proven_to_40_digits() -> None:
    """exp(−x) under the integral: what is left is rounding, and a factor of 1 + 10⁻¹⁵ is noticed."""
    stated = CASES["Beck"]()
    tapered = dataclasses.replace(stated, V=integral(sp.exp(-x) * y.diff(x, 2) ** 2) / 2)
    d = pipeline.general(tapered)
    steps = [step for step in d.steps if step.stage == "variation"]
    assert all("40 digits" in step.check or "exactly" not in step.check for step in steps)
    assert 0 < max(step.residual() for step in steps) < 1e-40
    key, factor = next(iter(d.motion.equations.items()))
    wrong = wrong_motion(d, equations={key: expand(factor * (1 + Rational(1, 10**15)))})
    with pytest.raises(AssertionError, match="leaves"):
        reproven(wrong, "State the equation of motion")


def test_rigid_motions_that_decide_are_not_proven_to_be_left_out() -> None:
    """Beal's control restores the rotation: that it is left out is refused, the translation is right."""
    source = {"ends": ("free", "free")}
    k = sp.Symbol("k", real=True)
    beal = dataclasses.replace(
        CASES["Beck"](), W_c=P * integral(x * y.diff(x) ** 2) / 2,
        dW_nc=-P * (at(y.diff(x), 1) + k * at(y.diff(x), Rational(1, 4))) * at(delta(y), 1), **source,
    )  # fmt: skip
    d = pipeline.general(beal)
    what = "Leave out the rigid motions that decide nothing"
    assert d.system.rigid == ({("y", 0): sp.S.One},) and reproven(d, what) == 0
    more = dataclasses.replace(d, system=dataclasses.replace(d.system, rigid=(*d.system.rigid, {("y", 0): x})))
    with pytest.raises(AssertionError, match="leaves"):
        reproven(more, what)


def test_motions_are_joined_as_the_spaces_say() -> None:
    """A motion jumps where it may, and only there; a virtual one vanishes where it is held."""
    for case in ("shear joint", "crack", "Timoshenko"):
        motion = derived(case).motion if case in READ else variation.derive_column(CASES[case]())
        beam, spaces = motion.beam, motion.spaces
        for of, held in ((motions.moving(beam, spaces, ()), False), (motions.displaced(beam, spaces, ()), True)):
            for space in spaces:
                pieces = of[space.name]
                for number, place in enumerate(beam.cuts, 1):
                    for order in range(space.joined):
                        before, after = (taken(pieces[number - side], order, place) for side in (1, 0))
                        assert (expand(after - before) != 0) == ((number, order) in space.opened)
                for end, order in space.held if held else ():
                    assert expand(taken(pieces[-end], order, sp.Integer(end))) == 0


def taken(piece: Expr, order: int, place: Expr) -> Expr:
    return (piece.diff(x, order) if order else piece).subs(x, place)


# --- the lesson -------------------------------------------------------------------------------------------------------

STATED = """
from sympy import Symbol
from freebeam_derive.notation import P, beta, t, x, y
from freebeam_derive.statement import Column, Coordinate, Parameter, at, delta, integral

mu, g = Symbol("mu", real=True), Symbol("g", real=True)
q = Coordinate("q")
column = Column(
    name="steered",
    title="Cantilever with a point mass and an absorber, its thrust steered by a sensor",
    T=integral(y.diff(t) ** 2) / 2 + mu * at(y.diff(t), 0.5) ** 2 / 2 + q.diff(t) ** 2 / 20,
    V=integral(y.diff(x, 2) ** 2) / 2 + 20 * (at(y, 1) - q) ** 2 / 2,
    W_c=P * integral(y.diff(x) ** 2) / 2,
    dW_nc=-P * (at(y.diff(x), 1) + g * at(y.diff(x), 0.25)) * at(delta(y), 1) - beta * integral(y.diff(t) * delta(y)),
    ends=("clamped", "free"),
    parameters=(
        Parameter(mu, "point mass", 0.5, 0, 2, r"\\\\mu"),
        Parameter(g, "gain", 0.2, 0, 1),
    ),
)
"""


@pytest.fixture(scope="module")
def steered(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("columns") / "steered.py"
    path.write_text(STATED.replace("\\\\", "\\"), encoding="utf-8")
    return path


@pytest.fixture(scope="module")
def kernels(steered: Path) -> Column:
    """Emitted, and not verified: tests/derive has that."""
    from freebeam.lesson import compiled

    return compiled(statement.load_column(steered))


@pytest.fixture(scope="module")
def made(steered: Path, kernels: Column) -> Lesson:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("freebeam.own.column", lambda _, basis=None: kernels)
        return lesson(steered)


def blocks_of(made: Lesson, kind: type) -> list[Any]:
    return [block for block in made.all_blocks if isinstance(block, kind)]


def test_chapters_are_those_of_what_the_column_has(made: Lesson) -> None:
    keys = [block.key for block in blocks_of(made, Heading)]
    assert keys == [
        "statement", "variation", "segments", "series", "shapes", "stability", "coalescence", "small", "work",
        "control", "parameters", "pulsation", "truncation", "newmark",
    ]  # fmt: skip
    assert max(check.residual for check in made.checks) < 1e-20 and len(made.checks) > 30
    assert len(blocks_of(made, Summary)) == len(keys)


def test_numbers_are_the_runtime_s(made: Lesson, kernels: Column) -> None:
    found = fb.critical_load(kernels)
    text = " ".join(block.text for block in blocks_of(made, Prose))
    assert f"{found.kind} load {found.load:.6g}" in made.subtitle and f"$P_0 = {found.load:.6g}$" in text
    assert found.converged and "agree" in text and f"by {found.beam.kind}" in text
    off = next(b for b in blocks_of(made, Exercise) if "control switched off" in b.question)
    assert f"{fb.critical_load(kernels, g=0.0).load:.6g}" in off.answer
    edges = next(b for b in blocks_of(made, Exercise) if "Between which frequencies" in b.question)
    low, high, left, right = map(float, re.findall(r"\$([\d.]+)\$", edges.answer))
    assert low == pytest.approx(left, rel=2e-3) and high == pytest.approx(right, rel=2e-3) and right > left


def test_the_page_is_valid_and_nothing_is_cut(made: Lesson, browser: Any, tmp_path: Path) -> None:
    """In the width of a small screen, with all that folds open. Of the drawings, frames."""
    from matplotlib.figure import Figure as Empty

    def framed(block: Any) -> Any:
        if isinstance(block, Cell):
            return dataclasses.replace(block, blocks=tuple(map(framed, block.blocks)))
        return dataclasses.replace(block, draw=Empty) if isinstance(block, Figure) else block

    made = dataclasses.replace(made, blocks=tuple(map(framed, made.blocks)))
    (data,) = printed(made, "html", tmp_path / "a.html").values()
    html5lib.HTMLParser(strict=True, namespaceHTMLElements=False).parse(data.decode())
    assert data.decode().count("<svg") == len(blocks_of(made, Figure)) > 6
    (tmp_path / "a.html").write_bytes(data)
    shown = browser.new_page(viewport={"width": 1100, "height": 900})
    shown.goto((tmp_path / "a.html").as_uri())
    shown.evaluate("document.querySelectorAll('details').forEach((d) => { d.open = true })")
    boxes = "[...document.querySelectorAll('.formula, .wide, .table, pre')]"
    cut = f"{boxes}.filter((e) => e.scrollWidth > e.clientWidth + 1).map((e) => e.textContent.slice(0, 80))"
    assert shown.evaluate(cut) == []
    shown.close()


def test_solutions_have_every_exercise_with_its_method(made: Lesson) -> None:
    asked, worked = solutions(made)
    exercises = blocks_of(made, Exercise)
    text = " ".join(block.text for block in blocks_of(worked, Prose))
    assert [b.question for b in blocks_of(asked, Exercise)] == [b.question for b in exercises]
    assert not any(b.answer for b in blocks_of(asked, Exercise))
    for number, exercise in enumerate(exercises, 1):
        assert f"**Exercise {number}.** {exercise.question}" in text and exercise.answer in text
        assert exercise.method and exercise.method in text
    (data,) = printed(asked, "md", Path("a.md")).values() if not blocks_of(asked, Figure) else (b"",)
    assert b"Answer" not in data


def test_a_seed_draws_the_same_data_again_and_others_for_others(kernels: Column) -> None:
    assert drawn(kernels, None) == (USUAL, {})
    seen = set()
    for seed in range(8):
        data, own = drawn(kernels, seed)
        assert drawn(kernels, seed) == (data, own)
        for p in kernels.parameters:
            assert p.low <= own[p.name] <= p.high and own[p.name] == float(f"{own[p.name]:.3g}")
        seen.add((dataclasses.replace(data, seed=None), *own.values()))
    assert len(seen) == 8
    for bad in (-1, 1.5, True):
        with pytest.raises(fb.InputError, match="seed"):
            drawn(kernels, bad)  # type: ignore[arg-type]


def test_equations_of_a_general_lesson_are_proven(made: Lesson) -> None:
    """No formula without a proof behind it, and no words of code in one."""
    for block in blocks_of(made, Equation):
        plain = re.sub(r"\\(?:begin|end|mathrm|text|operatorname)\{[^}]*\}|_\{[^}]*\}", " ", block.latex)
        assert set(re.findall(r"[A-Za-z]{2,}", re.sub(r"\\[A-Za-z]+", " ", plain))) <= {"EI", "dx"}, block.latex


def test_a_form_of_nothing_prints_nothing() -> None:
    assert not BilinearForm() and general_steps.functional(derived("absorber"), BilinearForm()) == Functional(
        S.Zero, S.Zero
    )


def test_steps_are_named_once() -> None:
    """A notebook finds a step by its name."""
    for case in READ:
        names = [(s.stage, s.what) for s in derived(case).steps]
        assert len(names) == len(set(names))
    assert isinstance(derived("pipe").steps[0], Step)


def test_links_have_their_picture_and_no_shape_along_a_beam() -> None:
    made = lesson("ziegler")
    pictures = {figure.key: figure for figure in blocks_of(made, Figure)}
    assert "beam" in pictures and "meeting" in pictures and "shape" not in pictures
    assert {text.get_text() for text in pictures["beam"].draw().texts} >= {r"$\varphi_{1}$", r"$\varphi_{2}$", "$P_0$"}


def test_a_column_that_grows_at_once_has_a_lesson_that_says_so(tmp_path: Path) -> None:
    """Two links, the first damped negatively: no load is critical; the table of eigenvalues shows what grows."""
    (tmp_path / "negative.py").write_text(
        """
from freebeam_derive.notation import P
from freebeam_derive.statement import Column, Coordinate, delta
from freebeam_derive.notation import t
a, b = Coordinate("a"), Coordinate("b")
column = Column(
    name="negative", title="Two links, one damped negatively",
    T=(2 * a.diff(t) ** 2 + 2 * a.diff(t) * b.diff(t) + b.diff(t) ** 2) / 2, V=(a**2 + (b - a) ** 2) / 2,
    W_c=P * (a**2 + b**2) / 2, dW_nc=-P * b * delta(a + b) + a.diff(t) * delta(a) / 10,
)
"""
    )
    made = lesson(tmp_path / "negative.py", short=True)
    assert "unstable at the smallest loads" in made.subtitle
    assert any("eigenvalues with positive real parts" in b.text for b in made.blocks if isinstance(b, Prose))
    growing = fb.spectrum(fb.column(tmp_path / "negative.py").system(load=0.0)).growth_rate
    (table,) = (b for b in made.blocks if isinstance(b, Table) and "P_0" in b.header[1])
    assert growing > 0 and any(f"{growing:.3g}"[:4] in cell for row in table.rows for cell in row)
