"""The lesson: its steps as laws, its formats valid, its text true of the column, its notebook open to change."""

from __future__ import annotations

import dataclasses
import json
import re
from functools import cache
from pathlib import Path
from typing import Any, get_args

import html5lib
import pytest
import sympy as sp

import freebeam_sym as fb
from freebeam_derive import emit, latex, legendre, pipeline, proofs, statement, verify
from freebeam_derive.record import Step
from freebeam_sym.cli import main
from freebeam_sym.columns import Column
from freebeam_sym.lesson import FORMATS, lesson, printed
from freebeam_sym.lesson.blocks import (
    Block,
    Cell,
    Check,
    Equation,
    Erratum,
    Exercise,
    Figure,
    Heading,
    Lesson,
    Prose,
    walk,
)
from freebeam_sym.lesson.errata import entries
from freebeam_sym.lesson.facts import Facts
from freebeam_sym.lesson.mathematics import mathml, typst
from freebeam_sym.lesson.notebook import unexecuted
from freebeam_sym.lesson.tex import text_of
from freebeam_sym.lesson.writer import Writer

ROOT = Path(__file__).parents[2]
OWN = ROOT / "tests" / "derive" / "columns"
COLUMNS = ("free-free", "euler-pinned", "hauger")


def file_of(name: str) -> Path:
    return {**statement.columns(), "hauger": OWN / "hauger.py"}[name]


@cache
def derived(name: str) -> pipeline.Derivation:
    return pipeline.derive(statement.load_column(file_of(name)))


@cache
def residuals(name: str) -> dict[str, float]:
    """What each step's proof leaves."""
    return {f"{step.stage}: {step.what}: {step.why}": step.residual() for step in derived(name).steps}


@cache
def compiled(name: str, basis: str) -> Column:
    """A user's column without the half minute that verifying its kernels takes; test_verify.py has that."""
    built = derived(name).kernel if basis == "modes" else derived(name).polynomials
    return Column(verify.load(emit.emit(built), f"{basis}_{name.replace('-', '_')}"))


@cache
def made(name: str) -> Lesson:
    residuals(name)  # before what computes it is replaced
    with pytest.MonkeyPatch.context() as patch:
        if name not in statement.columns():
            patch.setattr("freebeam_sym.columns.column", lambda _, basis=None: compiled(name, basis or "modes"))
        patch.setattr(Step, "residual", lambda step: residuals(name)[f"{step.stage}: {step.what}: {step.why}"])
        patch.setattr("freebeam_derive.pipeline.derive", lambda _: derived(name))
        return lesson(name if name in statement.columns() else file_of(name))


@pytest.fixture(params=COLUMNS)
def name(request: pytest.FixtureRequest) -> str:
    return str(request.param)


def blocks_of(name: str, kind: type) -> list[Any]:
    return [block for block in made(name).all_blocks if isinstance(block, kind)]


# --- steps ----------------------------------------------------------------------------------------------------


def test_every_step_is_proven_by_another_route(name: str) -> None:
    """Exact steps leave nothing; those with 40 digits leave less than 10^-20."""
    assert len(residuals(name)) > 50
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
    (proven,) = proofs.attach(derived("free-free"), [bad])
    with pytest.raises(AssertionError, match="leaves"):
        proven.residual()


def test_a_wrong_form_is_not_proven() -> None:
    """The paper's transposed follower term, put in the derivation's place."""
    right = derived("free-free")
    H = right.system.H
    printed_H = dataclasses.replace(H, points=H.transposed.points)
    wrong = dataclasses.replace(right, system=dataclasses.replace(right.system, H=printed_H))
    step = next(s for s in right.steps if s.what == "Write the load's matrix in closed form")
    (proven,) = proofs.attach(wrong, [dataclasses.replace(step, proof=None)])
    with pytest.raises(AssertionError, match="leaves"):
        proven.residual()


def test_a_step_without_proof_is_refused() -> None:
    with pytest.raises(AssertionError, match="no proof"):
        Step("variation", "Guess", "it looks right", sp.S.Zero, sp.S.One).residual()
    with pytest.raises(KeyError):
        list(proofs.attach(derived("free-free"), [Step("variation", "Guess", "", sp.S.Zero, sp.S.One)]))


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
                            # a part after a name has less room, and is broken elsewhere
                            known.add(re.sub(r"[&\s]|\\quad", "", "".join(printer.lines(inner))))
    whole = "".join(sorted(known))
    for block in blocks_of(name, Equation):
        text = re.sub(r"[&\s]|\\quad", "", "".join(block.lines))
        # what stands before the equals sign is the name of a part, or printed with the rest of its relation
        rights = [line.split("&=")[-1] for line in block.lines]
        for right in rights:
            kept = re.sub(r"[&\s]|\\quad", "", right).lstrip("-+")
            assert len(kept) < 30 or kept in whole, f"{kept} of {text[:80]}"


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
    source = (ROOT / "docs" / "errata.md").read_text(encoding="utf-8")
    assert all(f"## {title}" in source for title in told)


# --- physics ------------------------------------------------------------------------------------------------------


def test_text_is_true_of_the_column() -> None:
    """Flutter is said of the column that flutters, divergence of the one that diverges; numbers are the runtime's."""
    for name, kind in (("free-free", "flutter"), ("euler-pinned", "divergence")):
        load = fb.critical_load(fb.column(name)).load
        assert made(name).subtitle == f"Derived from its energies, to the {kind} load {load:.6g}"
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


# --- formats --------------------------------------------------------------------------------------------------------


@cache
def page(name: str) -> str:
    (data,) = printed(made(name), "html", Path("lesson.html")).values()
    return data.decode()


def test_html_is_valid_and_alone() -> None:
    text = page("free-free")
    html5lib.HTMLParser(strict=True, namespaceHTMLElements=False).parse(text)
    assert "://" not in text and "<script" not in text and not re.search(r'(src|href)="(?!#)', text)
    assert not re.search(r"url\((?!#)|@import", text)
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
    monkeypatch.setattr("freebeam_sym.lesson._display", seen.append)
    monkeypatch.setattr("freebeam_sym.lesson.compiled", lambda column: kernels)
    monkeypatch.setattr("freebeam_derive.pipeline.derive", lambda column: derived(column.name))
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


# --- command line -----------------------------------------------------------------------------------------------------


@pytest.fixture
def quick(monkeypatch: pytest.MonkeyPatch) -> None:
    """The lesson that was made, and a printer that is quick."""
    monkeypatch.setattr("freebeam_sym.lesson.lesson", lambda column, report=None: made("euler-pinned"))
    monkeypatch.setattr("freebeam_sym.lesson.printed", lambda found, format, output: {output: b"text"})


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


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--format", "doc", "--output", "a.doc"], "must be one of html, md, tex, ipynb, pdf"),
        (["--format", "html", "--output", "no/such/a.html"], "folder does not exist"),
        (["--column", "bek", "--format", "html", "--output", "a.html"], "did you mean beck"),
        (["--format", "html"], "--output"),
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
    kernel.write_text(emit.emit(derived("hauger").kernel), encoding="utf-8")
    with pytest.raises(fb.InputError, match="needs the statement that it was derived from"):
        lesson(kernel)


def test_every_kind_of_block_is_printed() -> None:
    assert {kind.__name__.lower() for kind in get_args(Block)} == Writer.__abstractmethods__ | {"prose", "cell"}


def test_formats_have_printers() -> None:
    for module in FORMATS.values():
        assert (ROOT / "freebeam_sym" / "lesson" / f"{module}.py").is_file()
