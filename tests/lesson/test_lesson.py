"""The lesson: its steps as laws, its formats valid, its text true of the column, its notebook open to change."""

from __future__ import annotations

import ast
import dataclasses
import json
import re
import unicodedata
from fnmatch import fnmatch
from functools import cache
from pathlib import Path
from types import SimpleNamespace
from typing import Any, get_args

import html5lib
import pytest
import sympy as sp
from fontTools.ttLib import TTFont
from markdown_it import MarkdownIt
from matplotlib.mathtext import MathTextParser

import freebeam as fb
from freebeam.cli import main
from freebeam.lesson import FORMATS, lesson, phrases, printed
from freebeam.lesson.blocks import (
    Block,
    Cell,
    Check,
    Equation,
    Erratum,
    Exercise,
    Figure,
    Heading,
    Lesson,
    Listing,
    Prose,
    Summary,
    Table,
    spans,
    walk,
)
from freebeam.lesson.errata import entries
from freebeam.lesson.facts import Facts
from freebeam.lesson.mathematics import mathml, typst
from freebeam.lesson.notebook import unexecuted
from freebeam.lesson.pdf import source as typeset
from freebeam.lesson.short import minutes
from freebeam.lesson.stages import Chapter
from freebeam.lesson.tex import _ESCAPES, text_of
from freebeam.lesson.theorem import theorem
from freebeam.lesson.writer import Writer
from freebeam_derive import emit, latex, pipeline, statement, step_proofs, verify
from freebeam_derive.bases import legendre
from freebeam_derive.certify.balls import precision
from freebeam_derive.certify.strips import Strips
from freebeam_derive.record import Step
from freebeam_sym.columns import Column

ROOT = Path(__file__).parents[2]
OWN = ROOT / "tests" / "derive" / "columns"
TIP = ROOT / "tests" / "explorer" / "tip_mass.py"
COLUMNS = ("free-free", "euler-pinned", "hauger", "panel", "tip-mass")


def file_of(name: str) -> Path:
    own = {"hauger": OWN / "hauger.py", "panel": OWN / "panel.py", "tip-mass": TIP}
    return {**statement.columns(), **own}[name]


@cache
def derived(name: str) -> pipeline.Derived:
    return pipeline.derive(statement.load_column(file_of(name)))


@cache
def residuals(name: str) -> dict[str, float]:
    """What each step's proof leaves."""
    return {f"{step.stage}: {step.what}: {step.why}": step.residual() for step in derived(name).steps}


@cache
def compiled(name: str, basis: str) -> Column:
    """A user's column without the half minute that verifying its kernels takes; test_verify.py has that."""
    built = derived(name).kernel(basis)
    return Column(verify.load(emit.emit(built), f"{basis}_{name.replace('-', '_')}"))


@cache
def made(name: str, short: bool = False, seed: int | None = None) -> Lesson:
    residuals(name)  # before what computes it is replaced
    with pytest.MonkeyPatch.context() as patch:
        if name not in statement.columns():
            patch.setattr("freebeam.own.column", lambda _, basis=None: compiled(name, basis or "modes"))
        patch.setattr(Step, "residual", lambda step: residuals(name)[f"{step.stage}: {step.what}: {step.why}"])
        patch.setattr("freebeam_derive.pipeline.derive", lambda _: derived(name))
        given = name if name in statement.columns() else file_of(name)
        return lesson(given, errata=name == "free-free", short=short, seed=seed)


@pytest.fixture(params=COLUMNS)
def name(request: pytest.FixtureRequest) -> str:
    return str(request.param)


def blocks_of(name: str, kind: type) -> list[Any]:
    return [block for block in made(name).all_blocks if isinstance(block, kind)]


# --- steps ----------------------------------------------------------------------------------------------------


def test_every_step_is_proven_by_another_route(name: str) -> None:
    """Exact steps leave nothing; those with 40 digits leave less than 10^-20."""
    assert len(residuals(name)) >= 50
    assert all(left < 1e-20 for left in residuals(name).values())
    assert sum(left == 0 for left in residuals(name).values()) > 30
    assert all(step.check for step in derived(name).steps)


def tampered(step: Step) -> Any:
    """Its result made wrong: a term more, or a factor of two."""
    first, *rest = step.after if isinstance(step.after, tuple) else (step.after,)
    if isinstance(first, sp.Eq):
        wrong = sp.Eq(first.lhs + 7, 0, evaluate=False) if first.rhs == 0 else sp.Eq(first.lhs, 2 * first.rhs)
    else:
        wrong = 2 * first + 1 if isinstance(first, sp.Expr) else 2 * first
    return (wrong, *rest) if isinstance(step.after, tuple) else wrong


@pytest.mark.parametrize(
    "what",
    [
        "Separate the variables", "Name the factor of χ", "Solve for the eigenvalues", "Set the determinant to zero",
        "Write the load's matrix in closed form", "Take the load and the force away", "stability conditions",
        "a change of coordinates", "errors of period and damping", "the equation of motion at the end of the step",
    ],
)  # fmt: skip
def test_a_wrong_result_is_not_proven(what: str) -> None:
    (step,) = (step for step in derived("free-free").steps if step.what == what)
    bad = dataclasses.replace(step, after=tampered(step), proof=None)
    (proven,) = step_proofs.attach(derived("free-free"), [bad])
    with pytest.raises(AssertionError, match="leaves"):
        proven.residual()


def test_a_wrong_form_is_not_proven() -> None:
    """The paper's transposed follower term, put in the derivation's place."""
    right = derived("free-free")
    H = right.system.H
    printed_H = dataclasses.replace(H, points=H.transposed.points)
    wrong = dataclasses.replace(right, system=dataclasses.replace(right.system, H=printed_H))
    step = next(s for s in right.steps if s.what == "Write the load's matrix in closed form")
    (proven,) = step_proofs.attach(wrong, [dataclasses.replace(step, proof=None)])
    with pytest.raises(AssertionError, match="leaves"):
        proven.residual()


def test_a_panel_of_any_ends_is_proven() -> None:
    """The load's matrix is skew where both ends hold the beam, its diagonal zero: nothing is divided by it."""
    stated = dataclasses.replace(statement.load_column(file_of("panel")), ends=("clamped", "clamped"))
    skew = pipeline.derive(stated)
    (step,) = (step for step in skew.steps if step.what == "Write the load's matrix in closed form")
    assert step.residual() < 1e-30 and step.after[1].rhs == 0
    bad = dataclasses.replace(step, after=(sp.Eq(step.after[0].lhs, 2 * step.after[0].rhs), step.after[1]), proof=None)
    (wrong,) = step_proofs.attach(skew, [bad])
    with pytest.raises(AssertionError, match="leaves"):
        wrong.residual()


def test_a_step_without_proof_is_refused() -> None:
    with pytest.raises(AssertionError, match="no proof"):
        Step("variation", "Guess", "it looks right", sp.S.Zero, sp.S.One).residual()
    with pytest.raises(KeyError):
        list(step_proofs.attach(derived("free-free"), [Step("variation", "Guess", "", sp.S.Zero, sp.S.One)]))


# --- what is displayed ------------------------------------------------------------------------------------------


def test_every_equation_is_followed_by_its_check(name: str) -> None:
    """In the part that a step makes, each formula comes before a check that was run."""
    for cell in blocks_of(name, Cell):
        inside = list(walk(cell.blocks))
        if any(isinstance(block, Equation) for block in inside):
            assert any(isinstance(block, Check) for block in inside)
    outside = [block for block in made(name).blocks if isinstance(block, Equation)]
    assert not outside
    assert len(made(name).checks) > 50
    assert {check.residual for check in made(name).checks} <= {*residuals(name).values()}


def test_every_equation_is_printed_from_the_record(name: str) -> None:
    """Each displayed line is what the printer makes of an object of the record (names of parts apart)."""
    printer = latex.printer(derived(name).column)
    known: set[str] = set()
    for stage_letter in (None, r"\lambda_{0}"):
        printer.own.pop("lambda", None)
        if stage_letter:
            printer.own["lambda"] = stage_letter
        for step in derived(name).steps:
            for part in (step.before, step.after):
                for item in part if isinstance(part, tuple) else (part,):
                    for inner in item if isinstance(item, tuple) else (item,):
                        if not isinstance(inner, str | int):
                            known |= {re.sub(r"[&\s]|\\quad", "", line) for line in printer.lines(inner)}
                            known |= {
                                re.sub(r"[&\s]|\\quad", "", line.replace("&=", "=")) for line in printer.lines(inner)
                            }
                            # a part after a name has less room, and is broken elsewhere
                            known.add(re.sub(r"[&\s]|\\quad", "", "".join(printer.lines(inner))))
    whole = "".join(sorted(known))
    for block in blocks_of(name, Equation):
        text = re.sub(r"[&\s]|\\quad", "", "".join(block.lines))
        # what stands before the equals sign is the name of a part, or printed with the rest of its relation
        rights = [line.split("&=")[-1].rpartition(r"\colon")[2] for line in block.lines]
        for right in rights:
            kept = re.sub(r"[&\s]|\\quad", "", right).lstrip("-+")
            assert len(kept) < 30 or kept in whole, f"{kept} of {text[:80]}"


def test_a_value_at_a_place_says_where(name: str) -> None:
    """Outside integrals each letter of a field is followed by its place; end conditions are nothing else."""
    seen = 0
    for block in blocks_of(name, Equation):
        if block.number not in ("7", "8", "15", "17", "18", "20"):
            continue
        for line in block.lines[block.number == "17" :]:  # whose first line is the equation along the beam
            points = re.sub(r"\\int.*?\\,dx", "", line)
            points = re.sub(r"\\d+ot\{y\}", "y", re.sub(r"\^\{(?:\\prime)+\}", "", points))
            assert not re.search(r"(?<![a-zA-Z])y(?!\((?:[01]|x_F)\))|\\chi(?!\([01]\))", points), line
            seen += 1
    assert seen > 8


def test_formulas_have_no_words_of_code(name: str) -> None:
    """Beside commands, subscripts and what is said to be text, a formula has single letters, EI and dx."""
    for block in blocks_of(name, Equation):
        plain = re.sub(r"\\(?:begin|end|mathrm|text|operatorname)\{[^}]*\}|_\{[^}]*\}", " ", block.latex)
        words = set(re.findall(r"[A-Za-z]{2,}", re.sub(r"\\[A-Za-z]+", " ", plain)))
        assert words <= {"EI", "dx"} and "^(" not in plain, block.latex


def test_modes_of_a_beam_that_carries_a_mass_are_not_called_orthogonal_in_its_mass() -> None:
    """What is proven of the integrals is not said of the column's matrices."""
    lines = [line for block in blocks_of("tip-mass", Equation) for line in block.lines]
    assert any(line.startswith("M_{ij} &= ") and r"\mu \varphi_{i}(1) \varphi_{j}(1)" in line for line in lines)
    assert not any(re.match(r"M_\{ij\} &= 0|M_\{ii\}", line) for line in lines)


def test_numbers_of_the_paper_are_in_the_index(name: str) -> None:
    index = (ROOT / "docs" / "equations.md").read_text(encoding="utf-8")
    rows = set(re.findall(r"^\| \((\d+)\)", index, re.MULTILINE))
    numbers = {block.number for block in blocks_of(name, Equation) if block.number}
    assert numbers <= rows
    text = " ".join(block.text for block in blocks_of(name, Prose))
    assert set(re.findall(r"Eqs?\. \((\d+)\)", text)) <= rows
    if name == "free-free":
        assert {str(n) for n in (*range(5, 16), *range(17, 27))} <= numbers


def test_errata_stand_where_they_arise() -> None:
    """Each once, after an equation of its number; other columns have no misprints to mark."""
    made_blocks = made("free-free").all_blocks
    told = [block.title for block in made_blocks if isinstance(block, Erratum)]
    placed = [entry for entry in entries() if entry.places]
    assert sorted(told) == sorted(entry.title for entry in placed) and len(told) > 8
    by_title = {entry.title: entry for entry in placed}
    for k, block in enumerate(made_blocks):
        if isinstance(block, Erratum):
            places = by_title[block.title].places
            numbers = {f"Eq. ({b.number})" for b in made_blocks[:k] if isinstance(b, Equation)}
            early = {"Eq. (1)", "Eq. (2)", "Eq. (3)", "Eq. (4)"}  # of the statement, which prints Eq. (8)
            assert any(p.startswith(("Section", "Abstract")) or p in numbers | early for p in places), block.title
    assert not [b for b in made("euler-pinned").all_blocks if isinstance(b, Erratum)]
    assert Chapter(derived("free-free"), True).errata("Eq. (11)") and not Chapter(derived("free-free"), False).errata(
        "Eq. (11)"
    )
    source = (ROOT / "docs" / "errata.md").read_text(encoding="utf-8")
    assert all(f"## {title}" in source for title in told)


# --- words --------------------------------------------------------------------------------------------------------


def calls() -> list[tuple[str, set[str]]]:
    """Keys of text.toml that the chapters ask for, in the branches that no column here takes too, and the values that
    they give; a part of a key that is computed is a star."""
    found = []
    for path in (ROOT / "front" / "freebeam" / "lesson").glob("*.py"):
        if path.stem == "phrases":
            continue
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            name = node.func if isinstance(node, ast.Call) else None
            known = ("prose", "text", "exercise", "summary", "at")
            if not isinstance(node, ast.Call) or getattr(name, "id", "") not in known:
                continue
            values = {word.arg for word in node.keywords if word.arg}
            if any(word.arg is None for word in node.keywords):  # needed functions, by basis
                values |= {"modes", "legendre"}
            first = node.args[0]
            for key in (first.body, first.orelse) if isinstance(first, ast.IfExp) else (first,):
                parts = key.values if isinstance(key, ast.JoinedStr) else [key]
                found.append(("".join(str(getattr(part, "value", "*")) if isinstance(part, ast.Constant) else "*"
                                      for part in parts), values))  # fmt: skip
    return found


def texts(table: Any, place: str = "") -> dict[str, str]:
    if isinstance(table, str | list):
        return {place: table if isinstance(table, str) else " ".join(table)}
    return {k: text for name, part in table.items() for k, text in texts(part, f"{place}.{name}".strip(".")).items()}


def test_every_text_is_asked_for_with_its_values() -> None:
    asked = calls()
    written = texts(phrases.words())
    for key, values in asked:
        meant = [text for place, text in written.items() if fnmatch(place, key) or place.startswith(f"{key}.")]
        assert meant, key
        if "*" not in key:
            for text in meant:
                assert set(re.findall(r"«(\w+)", text)) <= values, key
    for place in written:
        last = place.rpartition(".")[2]
        assert last in ("title", "opening", "summary") or any(
            fnmatch(place, key) or place.startswith(f"{key}.") for key, _ in asked
        ), place


def test_numbers_in_a_text() -> None:
    words = phrases.text("coalescence.gap.answer", far=0.5, near=1e-7, ratio=12.3456, power=0.50004)
    assert words.startswith(r"$0.5$ and $1.00 \cdot 10^{-7}$: a hundred times closer, the gap is $12.3$ times")
    with pytest.raises(KeyError):
        phrases.text("coalescence.gap.answer", far=0.5)


# --- physics ------------------------------------------------------------------------------------------------------


def test_text_is_true_of_the_column() -> None:
    """Flutter is said of the column that flutters, divergence of the one that diverges; numbers are the runtime's."""
    for name, kind in (("free-free", "flutter"), ("euler-pinned", "divergence")):
        series = fb.critical_load(fb.column(name, "modes"), 8)
        said = f"to the {kind} load {series.load:.6g} of eight modes; the beam itself: {kind} at "
        assert said in made(name).subtitle
        assert float(made(name).subtitle.split()[-1]) == pytest.approx(series.beam.load, rel=1e-5)
    pinned = " ".join(block.text for block in blocks_of("euler-pinned", Prose))
    assert "divergence" in pinned and "exceptional point" in pinned and "Physicists call it" not in pinned
    assert "nothing to leave out" in pinned
    free = " ".join(block.text for block in blocks_of("free-free", Prose))
    assert "It is a theorem" in free and f"{fb.critical_load(fb.column('free-free'), kappa=0).load:.6g}" in free
    own = " ".join(block.text for block in blocks_of("hauger", Prose))
    assert "states no internal damping" in own and "Physicists call it" in own and "It is a theorem" not in own
    assert f"$P_0 = {fb.critical_load(compiled('hauger', 'modes')).load:.6g}$" in own


def test_each_topic_ends_with_exercises_and_answers(name: str) -> None:
    found: dict[str, int] = {}
    section = ""
    for block in made(name).blocks:
        if isinstance(block, Heading):
            section = block.key
        if isinstance(block, Exercise):
            found[section] = found.get(section, 0) + 1
            assert block.question.strip() and block.answer.strip() and "nan" not in block.answer
    wanted = {"coalescence", "work", "rigid", "truncation"} | ({"damping"} if derived(name).column.damping else set())
    assert wanted <= set(found) and all(2 <= found[key] <= 3 for key in wanted)


def test_the_chapter_on_the_first_of_all_prints_what_was_proven() -> None:
    """Its bounds of the norm are below one from line m on, above before, and fall; m and the load are those proven."""
    blocks = theorem(Facts(fb.column("beck"), fb.column("beck", "legendre")))
    found = fb.exact_load(fb.column("beck"), digits=12)
    assert found.evidence is not None and found.load is not None
    (table,) = (block for block in blocks if isinstance(block, Table))
    norms = {int(row[0].strip("$R_{}")): float(row[2]) for row in table.rows}
    assert all((norm < 1) == (k >= found.evidence["lowest"]) for k, norm in norms.items())
    assert list(norms.values()) == sorted(norms.values(), reverse=True) and len(norms) > 3
    with precision(128):  # a bound is rounded up
        strips = Strips(fb.column("beck").kernel, {}, 40)
        bounds = {k: float(found.load[1]) * float(strips.B.norm(strips.line(k))) for k in norms}
    assert all(bounds[k] < norm < bounds[k] + 1.1e-3 for k, norm in norms.items())
    assert any(isinstance(block, Prose) and all(v in block.text for v in found.load) for block in blocks)
    assert not theorem(Facts(fb.column("foundation"), fb.column("foundation", "legendre")))


def test_facts_agree_with_independent_values() -> None:
    """The square root of the meeting; the balance of work; the tangent rule by differences of ω²(P)."""
    column = fb.column("beck")
    facts = Facts(column, fb.column("beck", "legendre"))
    near = [abs(a - b) for a, b in (facts.pair(facts.load * (1 - s)) for s in (1e-4, 4e-4))]
    assert near[1] / near[0] == pytest.approx(2, rel=1e-2)
    assert facts.overlap(facts.load * (1 - 1e-8)) > 0.999
    limit = fb.critical_load(column, kappa=0.0)
    assert limit.load is not None and limit.frequency is not None
    s = [float(facts.squares(limit.load * (1 + h))[0].real) for h in (-1e-5, 0.0, 1e-5)]
    assert limit.load * (s[2] - s[0]) / (2e-5 * limit.load) == pytest.approx(s[1], rel=1e-6)
    assert facts.beam_load == pytest.approx(20.0509536, rel=1e-8)  # Beck's load
    assert Facts(fb.column("euler-pinned"), fb.column("euler-pinned", "legendre")).circulatory < 1e-14


def test_a_short_lesson_fits_a_lecture_and_carries_the_argument() -> None:
    """Its chapters are some of the whole's, in their order; what it takes is an estimate."""
    short, whole = made("euler-pinned", True), made("euler-pinned")
    keys = [block.key for block in short.blocks if isinstance(block, Heading)]
    every = [block.key for block in whole.blocks if isinstance(block, Heading)]
    assert keys == [key for key in every if key in keys] and {"variation", "ritz", "stability", "work"} <= set(keys)
    assert 20 < minutes(short.blocks) < 45 < minutes(whole.blocks)
    answers = {block.answer for block in whole.all_blocks if isinstance(block, Exercise)}
    assert {block.answer for block in short.all_blocks if isinstance(block, Exercise)} <= answers


def test_a_seed_changes_what_is_asked_and_the_answers_with_it() -> None:
    one, usual = made("tip-mass", seed=3), made("tip-mass")
    assert "seed $3$" in " ".join(b.text for b in one.blocks if isinstance(b, Prose)) or "seed 3" in str(one.blocks)
    asked, before = ([b for b in x.all_blocks if isinstance(b, Exercise)] for x in (one, usual))
    assert len(asked) == len(before) and sum(a != b for a, b in zip(asked, before, strict=True)) > len(asked) / 2
    mass = float(re.search(r"\\mu = ([\d.]+)", " ".join(b.text for b in one.all_blocks if isinstance(b, Prose)))[1])  # type: ignore[index]
    assert mass != derived("tip-mass").column.parameters[0].default
    found = fb.critical_load(compiled("tip-mass", "modes"), 8, mu=mass)
    assert f"{found.load:.6g}" in one.subtitle


def test_every_exercise_has_a_method_and_every_chapter_a_summary(name: str) -> None:
    assert all(block.method for block in blocks_of(name, Exercise))
    chapter, summed = "", set()
    for block in made(name).blocks:
        if isinstance(block, Heading):
            chapter = block.key
        if isinstance(block, Summary):
            summed.add(chapter)
    without = {"errata"} | ({"damping"} if "alpha" not in derived(name).column.damping else set())
    assert summed == {b.key for b in made(name).blocks if isinstance(b, Heading)} - without


def test_proofs_are_folded_or_stand_at_the_end() -> None:
    kept = tuple(block for block in made("euler-pinned").blocks if not has_figure(block))
    plain = Lesson("T", "S", "euler-pinned", kept)
    (data,) = printed(plain, "html", Path("a.html")).values()
    assert data.decode().count('<details class="proof">') == len(plain.checks) > 30
    text, _ = typeset(plain)
    body, _, end = text.rpartition("How each result was proven")
    assert re.findall(r"#checked\[Proof (\d+)\]", body) == [str(k + 1) for k in range(len(plain.checks))]
    assert len(re.findall(r"^\+ ", end, re.MULTILINE)) == len(plain.checks)


# --- formats --------------------------------------------------------------------------------------------------------


@cache
def page(name: str) -> str:
    (data,) = printed(made(name), "html", Path("lesson.html")).values()
    return data.decode()


def test_html_is_valid_and_alone() -> None:
    text = page("free-free")
    html5lib.HTMLParser(strict=True, namespaceHTMLElements=False).parse(text)
    assert "://" not in text and "<script" not in text and not re.search(r'(src|href)="(?!#)', text)
    assert not re.search(r"url\((?!#|data:font/woff2;base64,)|@import", text)
    ids = re.findall(r'\bid="([^"]+)"', text)
    assert len(ids) == len(set(ids))
    links = set(re.findall(r'href="#([^"]+)"', text))
    assert links <= set(ids)
    headings = [b.key for b in made("free-free").all_blocks if isinstance(b, Heading)]
    assert headings and set(headings) <= links
    assert text.count("<math") > 200 and text.count("<svg") == len(blocks_of("free-free", Figure)) > 5
    assert "prefers-color-scheme: dark" in text and "@media print" in text and "<details>" in text


def test_colours_of_drawings_follow_the_page() -> None:
    svg = "".join(re.findall(r"<svg.*?</svg>", page("free-free"), re.DOTALL))
    assert not re.search(r"#(?:000000|ffffff|222222)", svg, re.IGNORECASE) and "var(--ink)" in svg


def test_mathematics_in_three_languages() -> None:
    for block in {b.latex for n in COLUMNS for b in blocks_of(n, Equation)}:
        assert block.count("{") == block.count("}")
        assert block.count(r"\left") == block.count(r"\right") and block.count("begin{") == block.count("end{")
        marked = mathml(block, True)
        assert "\\" not in re.sub(r"&#?\w+;", "", marked), block
        assert "\\begin" not in typst(block)
    assert typst(r"\frac{1}{2} \alpha^{2}") == "frac(1, 2) α^(2)"
    assert text_of("ω² − 1 & e_1") == r"$\omega ^{2}$ $-$ 1 \& e\_1"


def test_tex_asks_for_nothing_unusual(tmp_path: Path) -> None:
    only = Lesson("T", "S", "free-free", tuple(b for b in made("free-free").blocks if not has_figure(b)))
    (data,) = printed(only, "tex", tmp_path / "a.tex").values()
    text = data.decode()
    packages = {p for group in re.findall(r"\\usepackage(?:\[[^]]*\])?\{([^}]*)\}", text) for p in group.split(",")}
    assert packages == {"inputenc", "fontenc", "amsmath", "amssymb", "graphicx", "hyperref"}
    begun = re.findall(r"\\begin\{(\w+\*?)\}", text)
    assert sorted(begun) == sorted(re.findall(r"\\end\{(\w+\*?)\}", text))
    assert text.replace(r"\$", "").count("$") % 2 == 0
    outside = re.sub(r"\\begin\{verbatim\}.*?\\end\{verbatim\}", "", text, flags=re.DOTALL)
    assert outside.isascii()


def has_figure(block: Any) -> bool:
    return any(isinstance(inner, Figure) for inner in walk((block,)))


def test_pdf_is_typeset_or_says_what_is_missing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    kept = tuple(block for block in made("euler-pinned").blocks if not has_figure(block))
    small = Lesson("T", "S", "euler-pinned", kept)
    (data,) = printed(small, "pdf", tmp_path / "a.pdf").values()
    assert data.startswith(b"%PDF") and b"%%EOF" in data[-1024:]
    monkeypatch.setitem(__import__("sys").modules, "typst", None)
    with pytest.raises(
        fb.InputError, match=r"PDF needs typst, which is not installed: pip install 'freebeam\[lesson\]'"
    ):
        printed(small, "pdf", tmp_path / "a.pdf")


def test_notebook_runs_when_the_statement_is_changed(monkeypatch: pytest.MonkeyPatch) -> None:
    """The cells in order, in one namespace; the statement put in has other ends, no damping and no force."""
    from matplotlib import pyplot

    changed = "hauger"
    residuals(changed)  # before what they call is replaced
    kernels = compiled(changed, "modes")
    cells = [source for kind, source in unexecuted(made("free-free")) if kind == "code"]
    assert sum("column = Column(" in cell for cell in cells) == 1
    seen: list[Any] = []
    monkeypatch.setattr("freebeam.lesson._display", seen.append)
    monkeypatch.setattr("freebeam.lesson.compiled", lambda column: kernels)
    monkeypatch.setattr("freebeam_derive.pipeline.derived", lambda column: derived(column.name))
    monkeypatch.setattr(
        "freebeam_derive.record.Step.residual",
        lambda step: residuals(changed)[f"{step.stage}: {step.what}: {step.why}"],
    )
    space: dict[str, Any] = {}
    for cell in cells:
        code = file_of(changed).read_text(encoding="utf-8") if "column = Column(" in cell else cell
        exec(compile("\n".join(line for line in code.split("\n") if not line.startswith("%")), "cell", "exec"), space)
        pyplot.close("all")
    assert space["column"].name == changed and space["found"].kind == "flutter"
    assert space["found"].load == pytest.approx(fb.critical_load(kernels).load)
    assert len(seen) > 60
    assert len(legendre.polynomials(space["column"].ends).steps) > 4


# --- letters ------------------------------------------------------------------------------------------------------

FONT = ROOT / "front" / "freebeam" / "lesson" / "font" / "math.woff2"


def slanted(letter: str) -> str:
    """What a browser shows for a single letter that is not said to be upright."""
    if letter == "h":
        return "ℎ"
    words = unicodedata.name(letter).removeprefix("LATIN ").removeprefix("GREEK ").replace("LETTER ", "")
    try:
        return unicodedata.lookup(f"MATHEMATICAL ITALIC {words}")
    except KeyError:
        return letter


def test_the_font_has_every_letter_of_the_formulas() -> None:
    known = set(map(chr, TTFont(FONT).getBestCmap()))
    formulas = {block.latex for name in COLUMNS for block in blocks_of(name, Equation)}
    texts = {block.text for name in COLUMNS for block in blocks_of(name, Prose)}
    formulas |= {piece for text in texts for kind, piece in spans(text) if kind in ("math", "display")}
    formulas |= {rf"\{command}" for command in statement._GREEK.split()}
    assert len(formulas) > 150
    wanted: set[str] = set()
    for formula in formulas:
        root = html5lib.parse(mathml(formula), namespaceHTMLElements=False)
        for element in root.iter():
            text = "".join((element.text or "").split())
            single = element.tag.endswith("mi") and len(text) == 1 and element.get("mathvariant") != "normal"
            wanted |= set(slanted(text) if single else text)
    wanted.discard("\N{FUNCTION APPLICATION}")  # which is not shown
    assert wanted > {"𝜒", "𝑦", "′", "∫", "G"} and wanted <= known, wanted - known


def test_the_documentation_has_the_same_letters() -> None:
    docs = ROOT / "docs"
    settings = (docs / "conf.py").read_text(encoding="utf-8")
    folders = ast.literal_eval(re.search(r"^html_static_path = (.*)$", settings, re.MULTILINE)[1])  # type: ignore[index]
    style = (docs / "style" / "site.css").read_text(encoding="utf-8")
    (named,) = re.findall(r"url\((.*?)\)", style)
    assert [docs / folder / named for folder in folders if (docs / folder / named).is_file()] == [
        docs / "../front/freebeam/lesson/font" / FONT.name
    ]
    for family in (style, (ROOT / "front" / "freebeam" / "lesson" / "page.css").read_text(encoding="utf-8")):
        assert family.count('"Freebeam Math"') == 2


def test_primes_can_be_counted(browser: Any, tmp_path: Path) -> None:
    """The page's own font is in use, and each prime takes its width: four are a third wider than three."""
    file = tmp_path / "a.html"
    equation = Equation((r"\chi^{\prime\prime\prime} + \chi^{\prime\prime\prime\prime} = 0",))
    same = Prose(r"$\chi''' + \chi'''' = 0$")
    (data,) = printed(Lesson("T", "S", "free-free", (equation, same)), "html", file).values()
    file.write_bytes(data)
    shown = browser.new_page()
    shown.goto(file.as_uri())
    fonts = shown.evaluate("document.fonts.ready.then((all) => [...all].map((font) => [font.family, font.status]))")
    assert [[family.strip('"'), status] for family, status in fonts] == [["Freebeam Math", "loaded"]]
    three, four, *again = shown.evaluate(
        "[...document.querySelectorAll('.prime')].map((e) => e.getBoundingClientRect().width)"
    )
    assert four / three == pytest.approx(4 / 3, rel=0.02) and three > 9
    assert again == pytest.approx([three, four], rel=0.1)  # within a line of text
    shown.close()


@pytest.mark.parametrize("letter", ["y", r"\varphi_j", r"\varphi_{jk}"])
@pytest.mark.parametrize("count", [1, 2, 3, 4])
def test_primes_of_any_letter_stand_at_one_height(letter: str, count: int) -> None:
    """However they are written in LaTeX."""
    written = mathml(letter + "'" * count)
    assert written == mathml(letter + "^{" + r"\prime" * count + "}")
    assert re.findall("′+", written) == ["′" * count]


# --- words of a column --------------------------------------------------------------------------------------------

HOSTILE = (
    "<script>document.title='ran'</script></script><img src=x onerror=\"document.title='ran'\"> $\\input{/etc/passwd}$ "
    "$$x$$ $α `rm` ``` # * _a_ **b** [l](javascript:alert(1)) ]]> --> & &lt; \"q\" 'p' %c {d} ~ ^ | @COLUMN@ #eval(1) "
    "1. \\end{document} \\"
)
CODE = f"# {HOSTILE}\n```\n</code></pre>\n\\end{{verbatim}}\\input{{a}}\n]]>"
WORDS = Lesson(HOSTILE, HOSTILE, "free-free", (Heading("H", 2, "h"), Prose("P"), Listing(CODE)))


def test_a_title_is_one_line() -> None:
    kernel: Any = SimpleNamespace(COLUMN={"title": f"  a\n\n= {HOSTILE}\tb \n"})
    assert Column(kernel).title == f"a = {HOSTILE} b"
    assert made("hauger").title == derived("hauger").column.title


def test_words_in_html(browser: Any, tmp_path: Path) -> None:
    (data,) = printed(WORDS, "html", tmp_path / "a.html").values()
    tree = html5lib.HTMLParser(strict=True, namespaceHTMLElements=False).parse(data.decode())
    assert tree.find(".//title").text == tree.find(".//h1").text == HOSTILE
    assert tree.find(".//pre/code").text == CODE
    assert not [element for element in tree.iter() if element.tag in ("script", "img", "iframe")]
    (tmp_path / "a.html").write_bytes(data)
    shown = browser.new_page()
    shown.goto((tmp_path / "a.html").as_uri())
    assert shown.title() == shown.text_content("h1") == HOSTILE
    assert shown.evaluate("document.scripts.length + document.images.length") == 0
    shown.close()


def test_words_in_markdown_and_notebooks() -> None:
    (data,) = printed(WORDS, "md", Path("a.md")).values()
    text = data.decode()
    opening = next(source for kind, source in unexecuted(WORDS) if kind == "markdown")
    title, subtitle = text.split("\n\n")[:2]
    assert opening.startswith(f"{title}\n\n{subtitle}\n\n")
    for line in (title, subtitle):  # what readers of Markdown know beside the standard: mathematics, tables, mentions
        assert not set("$|~^@<>") & set(line)
    tree = html5lib.parse(MarkdownIt("commonmark").render(text), namespaceHTMLElements=False)
    assert tree.find(".//h1").text == tree.find(".//p/em").text == HOSTILE
    assert tree.find(".//pre/code").text == f"{CODE}\n"
    assert not [element for element in tree.iter() if element.tag in ("script", "img", "a", "math")]


def test_words_in_tex() -> None:
    (data,) = printed(WORDS, "tex", Path("a.tex")).values()
    text = data.decode()
    title = re.search(r"^\\title\{(.*)\}$", text, re.MULTILINE)
    assert title is not None
    plain = title[1].replace(r"$\alpha$", "α").replace(r"\textbackslash{}", "\0")
    for sign, command in _ESCAPES.items():
        if command.startswith(r"\text"):
            plain = plain.replace(command, sign)
    assert not re.search(r"(?<!\\)[{}$&%#_]", plain)
    plain = re.sub(r"\\([{}$&%#_])", r"\1", plain)
    assert "\\" not in plain and plain.replace("\0", "\\") == HOSTILE
    outside = re.sub(r"\\begin\{verbatim\}.*?\\end\{verbatim\}", "", text, flags=re.DOTALL)
    assert r"\input" not in outside and "verbatim" not in outside


def test_words_in_typst(tmp_path: Path) -> None:
    text, _ = typeset(WORDS)
    (title,) = re.findall(r"hyphenate: false\)\[(.*)\]\)$", text, re.MULTILINE)
    assert re.sub(r"\\([!-/:-@\[-`{-~])", r"\1", title) == HOSTILE
    assert not re.search(r"(?<!\\)(?:\\\\)*[][#$*_`<>@]", title)
    (data,) = printed(WORDS, "pdf", tmp_path / "a.pdf").values()
    assert data.startswith(b"%PDF")


@pytest.mark.parametrize(
    "formula",
    [r"\input{/etc/passwd}", "$", "k$", r"\mu$x$", "<b>", "k & l", "`", "#", "a\nb", r"\write18{rm}", "{", "k_", "\\",
     "%", '"', r"\mathrm{\input}", "~", r"\mu\begin", "]]>", 5],
)  # fmt: skip
def test_latex_of_a_parameter_that_is_no_letter_is_refused(formula: Any) -> None:
    tip = statement.load_column(TIP)
    with pytest.raises(statement.StatementError, match=r"^parameter mu: latex .* leave it out") as caught:
        dataclasses.replace(tip, parameters=(dataclasses.replace(tip.parameters[0], latex=formula),))
    assert "\n" not in str(caught.value)


def test_latex_of_a_parameter_is_shown_in_every_format(tmp_path: Path) -> None:
    """What a statement may use, and names without LaTeX, in mathtext, MathML and Typst; no name has two subscripts."""
    marks = ("mathrm", "mathsf", "mathbf", "hat", "bar", "tilde", "dot", "ddot")
    shown = [rf"\{name}" for name in statement._GREEK.split()]
    shown += [rf"\{mark}{{k}}_{{\mathrm{{w}},2}}^2" for mark in marks]
    shown += ["k_w", "K_1/K_2", r"\mu_{tip}"]
    assert all(statement._LETTER.fullmatch(formula) for formula in shown)
    for name in ("k_wall", "a_b_c", "mu", "kappa_2", "stiffness", "x__y", "μ_w"):
        parameter = statement.Parameter(sp.Symbol(name, real=True), "", 1.0, 0.0, 2.0)
        shown.append(latex.letter(parameter))
        assert shown[-1].count("_") <= 1
    for formula in shown:
        MathTextParser("path").parse(f"${formula}$")
        assert "\\" not in mathml(formula)
    pieces = Prose("; ".join(f"${formula}$" for formula in shown))
    (data,) = printed(Lesson("T", "S", "free-free", (pieces,)), "pdf", tmp_path / "a.pdf").values()
    assert data.startswith(b"%PDF")


# --- command line -----------------------------------------------------------------------------------------------------


@pytest.fixture
def quick(monkeypatch: pytest.MonkeyPatch) -> None:
    """The lesson that was made, and a printer that is quick."""
    monkeypatch.setattr("freebeam.lesson.lesson", lambda column, report=None, **asked: made("euler-pinned"))
    monkeypatch.setattr("freebeam.lesson.printed", lambda found, format, output: {output: b"text"})


def test_command_writes_once(tmp_path: Path, capsys: pytest.CaptureFixture[str], quick: None) -> None:
    output = tmp_path / "a.html"
    command = ["lesson", "--column", "euler-pinned", "--format", "html", "--output", str(output)]
    assert main([*command, "--json"]) == 0
    record = json.loads(capsys.readouterr().out)
    assert record["written"] == [str(output)] and record["checks"] > 50 and record["largest_residual"] < 1e-20
    output.write_bytes(b"mine")
    assert main(command) == 2
    assert capsys.readouterr().err.count("\n") == 1 and output.read_bytes() == b"mine"
    assert main([*command, "--force"]) == 0
    assert output.read_bytes() == b"text"
    capsys.readouterr()
    second, other = tmp_path / "answers.html", tmp_path / "b.html"
    assert main([*command, "--force", "--solutions", str(second), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["written"] == [str(output), str(second)]
    assert second.read_bytes() == b"text"
    assert main([*command[:-1], str(other), "--solutions", str(second)]) == 2 and not other.exists()


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--format", "doc", "--output", "a.doc"], "must be one of html, md, tex, ipynb, pdf"),
        (["--output", "a.doc"], "a.doc: must end in one of html, md, tex, ipynb, pdf; or give --format"),
        (["--output", "no/such/a.html"], "folder does not exist"),
        (["--column", "bek", "--format", "html", "--output", "a.html"], "did you mean beck"),
        (["--format", "html"], "--output"),
        (["--format", "html", "--output", "a.html", "--seed", "-1"], "seed = -1: must be a whole number"),
        (["--format", "html", "--output", "a.html", "--solutions", "a.html"], "is the lesson's own file"),
    ],
)  # fmt: skip
def test_bad_input_is_one_line(
    arguments: list[str], said: str, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["lesson", *arguments]) == 2
    error = capsys.readouterr().err
    assert said in error and error.count("\n") == 1 and not list(tmp_path.iterdir())


def test_a_kernel_has_no_lesson(tmp_path: Path) -> None:
    kernel = tmp_path / "kernel.py"
    kernel.write_text(emit.emit(derived("hauger").kernel("modes")), encoding="utf-8")
    with pytest.raises(fb.InputError, match="needs the statement that it was derived from"):
        lesson(kernel)


def test_every_kind_of_block_is_printed() -> None:
    assert {kind.__name__.lower() for kind in get_args(Block)} == Writer.__abstractmethods__ | {"prose", "cell"}


def test_formats_have_printers() -> None:
    for module in FORMATS.values():
        assert (ROOT / "front" / "freebeam" / "lesson" / f"{module}.py").is_file()
