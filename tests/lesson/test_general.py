"""The lesson on a column of segments, fields and coordinates: what is printed is what was stated, and is proven."""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Mapping
from functools import cache
from itertools import pairwise
from pathlib import Path
from typing import Any

import html5lib
import pytest
import sympy as sp
from sympy import Add, Expr, Integral, Rational, S, expand, integrate

import freebeam as fb
from freebeam.lesson import lesson, printed, solutions
from freebeam.lesson.blocks import Cell, Equation, Exercise, Figure, Heading, Lesson, Prose, Summary
from freebeam.lesson.draws import USUAL, drawn
from freebeam.lesson.stages import Chapter
from freebeam_derive import general_steps, latex, motions, pipeline, statement, step_proofs, variation
from freebeam_derive.forms import BilinearForm
from freebeam_derive.jets import ALONG, beside, jet, leap, trial, varying
from freebeam_derive.notation import P, alpha, beta, x, y
from freebeam_derive.pipeline import GeneralDerived
from freebeam_derive.record import Step
from freebeam_derive.statement import Functional, at, delta, integral, jets
from freebeam_sym.columns import Column
from tests.derive.test_language import CASES, NUMBERS, at_motion, over, polynomials
from tests.lesson.reading import DIRAC, Reader

READ = ("crack", "Timoshenko", "absorber", "pipe", "Ziegler")
VALUES = {P: 7, alpha: 11, beta: 13}


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


def evaluated(d: GeneralDerived, read: Expr, moving: Mapping[str, Any], moved: Mapping[str, Any]) -> Expr:
    """What was read, integrals and jumps in it, on motions."""
    motion, total = d.motion, S.Zero
    places = [place.subs(NUMBERS) for place in motion.beam.places]
    for term in Add.make_args(expand(sided(read.subs(VALUES)))):
        inside = [f for f in sp.Mul.make_args(term) if isinstance(f, Integral)]
        if not inside:
            total += at_motion(term, motion, moving, moved)
            continue
        (found,) = inside
        low, high = (bound.subs(NUMBERS) for bound in found.limits[0][1:])
        for segment, (left, right) in enumerate(pairwise(places)):
            if low <= left and right <= high:
                density = along(d, term / found * found.function, segment, moving, moved)
                total += integrate(density, (x, left, right))
    return expand(total)


def sided(read: Expr) -> Expr:
    """Jumps as differences of both sides."""

    def both(which: Expr, p: Expr, r: Expr, place: Expr) -> Expr:
        if place.func != leap:
            return jet(which, p, r, place)
        return jet(which, p, r, beside(place.args[0], 1)) - jet(which, p, r, beside(place.args[0], -1))

    return read.replace(jet, both)


def along(d: GeneralDerived, density: Expr, segment: int, moving: Mapping[str, Any], moved: Mapping[str, Any]) -> Expr:
    """A density in jets along the beam, on a segment."""
    place = d.motion.beam.along(segment)
    here = {j: jet(*j.args[:3], place) for j in jets(density) if j.args[3] == ALONG}
    return at_motion(density.subs(VALUES).xreplace(here), d.motion, moving, moved)


def numbered(work: Functional) -> Functional:
    """With numbers for the load and the dampings, which need not be letters here."""
    return work.map(lambda part: part.subs(VALUES))


def same_but_for_sign(one: Expr, other: Expr) -> bool:
    """An equation with zero on its right says the same with its signs changed."""
    return expand(one - other) == 0 or expand(one + other) == 0


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
    """Each printed line, read back by its signs alone, gives on motions of all unknowns what the derivation gives.

    That is held against the statement in tests/derive/test_language.py. The places before a line say where it holds.
    """
    d = derived(name)
    motion, printer = d.motion, latex.printer(d.column)
    read = reader(d, printer)
    moving, moved = polynomials(d.column, motion, 2, False), polynomials(d.column, motion, 4, True)
    (weak,) = lines_of(d, "Read off the weak form")
    assert same_but_for_sign(
        evaluated(d, read.read(weak), moving, moved), over(numbered(motion.weak), motion, moving, moved)
    )
    wanted: dict[str, Expr] = {}
    edges = [printer.place(place) for place in motion.beam.places]
    equations = [(k, f) for (_, k), f in motion.equations.items()]
    count = 0
    for line in lines_of(d, "State the equation of motion"):
        where, _, equation = line.rpartition(r"\colon")
        found = read.read(equation)
        force = found.coeff(DIRAC)
        segments = [edges.index(a) for a in re.findall(r"([\w.\\]+) < x <", where)] if where else [0]
        for segment in segments if count < len(equations) else []:
            k, factor = equations[count]
            assert k == segment
            difference = along(d, found.subs(DIRAC, 0), segment, moving, moved)
            assert same_but_for_sign(difference, at_motion(factor.subs(VALUES), motion, moving, moved))
            assert force == sum(-f for _, f in motion.forces) * (1 if "y" in d.column.fields and force else 0)
            count += 1
        if count == len(equations) and not where and d.column.coordinates:
            wanted[equation] = found
    assert count == len(equations)
    works = list(motion.of_coordinates.values())
    for found, work in zip(list(wanted.values())[-len(works) :] if works else [], works, strict=True):
        assert same_but_for_sign(evaluated(d, found, moving, moved), over(numbered(work), motion, moving, moved))
    if motion.spaces:
        conditions = lines_of(d, "State the natural end conditions")
        labels = [place for line in conditions for place in line.rpartition(r"\colon")[0].split(r",\; ")]
        assert [label.removeprefix("x = ") for label in labels] == [edges[c.place] for c in motion.conditions]
        for line, condition in zip(conditions, motion.conditions, strict=True):
            found = evaluated(d, read.read(line.rpartition(r"\colon")[2]), moving, moved)
            assert same_but_for_sign(found, at_motion(condition.factor.subs(VALUES), motion, moving, moved)), line


def test_printed_matrices_are_the_forms(name: str) -> None:
    d = derived(name)
    printer = latex.printer(d.column)
    read = reader(d, printer)
    moving, moved = polynomials(d.column, d.motion, 6, False), polynomials(d.column, d.motion, 1, True)
    forms = {
        printer.doprint(general_steps._entry(letter, power, len(powers))): form
        for letter, powers in general_steps._matrices(d).items()
        for power, form in enumerate(powers)
        if form
    }
    seen = 0
    for line in lines_of(d, "Substitute it into the weak form"):
        left, _, right = line.partition(" &= ")
        if left.startswith("Q"):
            continue
        wanted = general_steps.functional(d, forms[left])
        assert (
            expand(evaluated(d, read.read(right), moving, moved) - over(numbered(wanted), d.motion, moving, moved)) == 0
        ), line
        seen += 1
    assert seen == len(forms)


def test_a_formula_that_is_misread_is_noticed() -> None:
    """The reader knows signs, places, sides and orders."""
    d = derived("crack")
    read = reader(d, latex.printer(d.column))
    moving, moved = polynomials(d.column, d.motion, 2, False), polynomials(d.column, d.motion, 4, True)
    lines = [line.rpartition(r"\colon")[2] for line in lines_of(d, "State the natural end conditions")]
    for old, new in ((r"0.4^{-}", r"0.4^{+}"), (r"\prime\prime", r"\prime"), ("- k", "+ k"), (r"\dot{y}", "y")):
        line = next(line for line in lines if old in line)
        one, other = (evaluated(d, read.read(text), moving, moved) for text in (line, line.replace(old, new, 1)))
        assert not same_but_for_sign(one, other)


# --- steps are proven, and wrong ones are not -----------------------------------------------------------------------


@pytest.mark.parametrize("case", ["Timoshenko", "pipe", "Ziegler"])
def test_every_step_is_proven_by_another_route(case: str) -> None:
    """A column with segments is in the lesson below."""
    left = [step.residual() for step in derived(case).steps if step.stage != "newmark"]
    assert len(left) > 10 and max(left) == 0


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
    for case in ("shear joint", "two hinges of one field each way", "Timoshenko"):
        motion = variation.derive_column(CASES[case]())
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
