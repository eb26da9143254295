"""Kernels in C and JavaScript: compiled and run, held to the oracle and bounds of the NumPy ones, and their texts."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

import numpy as np
import pytest
import sympy as sp

from freebeam import cli
from freebeam_derive import emit, foreign, pieces, pipeline, verify
from freebeam_derive.bases import legendre, modes
from freebeam_derive.bases.segments import kernel_of
from freebeam_derive.forms import BilinearForm
from freebeam_derive.kernel import Kernel
from freebeam_derive.statement import StatementError
from freebeam_derive.verify import VerificationError
from tests.derive.test_segments import ABSORBER, BEAL, EXPONENTIAL, SHEAR, TIMOSHENKO, TIP, Facts, column, parameter

LANGUAGES = ("c", "javascript")
# fields that are joined once and not at all, a coordinate under an integral and at places, powers of the load
SEVERAL = replace(
    TIMOSHENKO,
    coordinates=ABSORBER.coordinates,
    parameters=ABSORBER.parameters,
    M=(BilinearForm(TIMOSHENKO.M[0].along, ABSORBER.M[0].points),),
    C=(BilinearForm(TIMOSHENKO.C[0].along, ABSORBER.C[0].points), ABSORBER.C[1]),
    K=(BilinearForm({**TIMOSHENKO.K[0].along, **ABSORBER.K[0].along}, ABSORBER.K[0].points), TIMOSHENKO.K[1]),
)
Derived = Callable[[str], pipeline.Derived]


@pytest.fixture(params=LANGUAGES)
def language(request: pytest.FixtureRequest) -> str:
    if lacking := foreign.missing(request.param):
        pytest.skip(lacking)
    return str(request.param)


@pytest.fixture
def few(monkeypatch: pytest.MonkeyPatch) -> None:
    """A short verification; `freebeam generate` makes the whole one of what it writes."""
    for module, name, value in (
        (modes, "MATRIX_MODES", 8), (modes, "EXACT_MODES", 8), (modes, "HIGH_MODES", (12,)),
        (legendre, "POLYNOMIALS", 8), (pieces, "MODES", 5), (foreign, "COMPILE", ("cc", *foreign.COMPILE[1:], "-O0")),
    ):  # fmt: skip
        monkeypatch.setattr(module, name, value)


def built(name: str, derived: Derived) -> Kernel:
    """A kernel by the name of a column and its basis, or of a system on segments."""
    if system := {"several": SEVERAL, "exponential": EXPONENTIAL}.get(name):
        return kernel_of(Facts(system.parameters), system)
    column, basis = name.split()
    return derived(column).kernel(basis)


OF_EACH_KIND = ("free-free modes", "sprung-tip legendre", "several", "exponential")


@pytest.mark.parametrize("name", OF_EACH_KIND)
def test_kernels_keep_the_bounds_of_the_numpy_ones(few: None, name: str, language: str, derived: Derived) -> None:
    """Every figure that verify.py measures of the NumPy module, from the same oracle, within the same bound."""
    kernel = built(name, derived)
    with foreign.loaded(emit.files(kernel, language, "any"), language, kernel) as module:
        found = verify.measure(kernel, module)
    assert all(figure.error <= figure.bound for figure in found)
    if name == "sprung-tip legendre":  # no figure is left out, and no bound is another
        expected = verify.verify(kernel, emit.emit(kernel))
        assert [(f.what, f.bound) for f in found] == [(f.what, f.bound) for f in expected]


TAMPERED = {
    "free-free modes": ((r"\(0\.25 \*", "(0.2500000000001 *", "entries of"), (r"= 6 \+", "= 10 +", "first root")),
    "sprung-tip legendre": ((r"\(2\.0 \* m \+ 1\.0\) \* near;", "(2.0 * m + 1.000001) * near;", "derivative 1"),),
    "exponential": ((r"/ \(slope \* slope\)", "/ (slope * slope * 1.000000000001)", "entries of"),),
}


@pytest.mark.parametrize("name, language", [*zip(TAMPERED, ("javascript", "c", "c"), strict=True)])
def test_tampered_kernels_are_refused(few: None, name: str, language: str, derived: Derived) -> None:
    if lacking := foreign.missing(language):
        pytest.skip(lacking)
    kernel = built(name, derived)
    texts = emit.files(kernel, language, "any")
    for pattern, changed, said in TAMPERED[name]:
        tampered = {file: re.sub(pattern, changed, text) for file, text in texts.items()}
        assert tampered != texts
        with foreign.loaded(tampered, language, kernel) as module, pytest.raises(VerificationError, match=said):
            verify.measure(kernel, module)


def numpy_of(kernel: Kernel) -> ModuleType:
    return verify.load(emit.emit(kernel), "any")


@pytest.mark.parametrize("system", [BEAL, SHEAR], ids=["beal", "shear joint"])
def test_what_the_oracle_leaves_out_is_as_in_numpy(few: None, language: str, system: Any) -> None:
    """Rigid motions, the generalised force and a matrix at a load, of kernels on segments."""
    kernel = kernel_of(Facts(system.parameters), system)
    numpy, own = numpy_of(kernel), {p.name: float(p.default) for p in system.parameters}
    with foreign.loaded(emit.files(kernel, language, "any"), language, kernel) as other:
        a, b = numpy.basis(4), other.basis(4)
        assert np.abs(other.force(b, 0.37, **own) - numpy.force(a, 0.37, **own)).max() < 1e-14
        if system.rigid:
            assert np.array_equal(other.rigid_motions(b, **own), numpy.rigid_motions(a, **own))
        K, exact = other.at_load(b, other.stiffness_terms(b, **own), 3.0), numpy.stiffness(a, 3.0, **own)
        assert np.abs(K - exact).max() < 1e-14 * np.abs(exact).max()


def test_what_makes_no_sense_is_told(few: None, language: str) -> None:
    """Breaks that do not ascend, a place off the beam, a derivative that is not kept: an error, never a number."""
    kernel = kernel_of(Facts(SHEAR.parameters), SHEAR)
    with foreign.loaded(emit.files(kernel, language, "any"), language, kernel) as module:
        basis = module.basis(4)
        for asked in (
            lambda: module.places(a=1.5),
            lambda: module.mass_terms(basis, a=-0.1),
            lambda: module.shapes(basis, 1.5, "y"),
            lambda: module.shapes(basis, 0.5, "y", 4),
            lambda: module.basis(1),
        ):
            with pytest.raises((VerificationError, ValueError)):
                asked()


def test_javascript_runs_in_a_browser(few: None, derived: Derived, monkeypatch: pytest.MonkeyPatch) -> None:
    """Where there is no node, the same in a headless Chromium."""
    if not foreign._browser():
        pytest.skip("no Chromium that playwright can drive")
    kernel = derived("beck").kernel("legendre")
    which = shutil.which
    monkeypatch.setattr(foreign.shutil, "which", lambda name: None if name == "node" else which(name))
    with foreign.loaded(emit.files(kernel, "javascript", "beck_legendre"), "javascript", kernel) as module:
        assert verify.measure(kernel, module)


# --- text ---------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["beck modes", "free-free legendre", "several", "exponential"])
def test_c_is_strict_and_does_not_allocate(name: str, derived: Derived, tmp_path: Path) -> None:
    """C99 without a warning, in a C++ program too; what it calls is of the mathematics alone, and memset."""
    if lacking := foreign.missing("c"):
        pytest.skip(lacking)
    for file, text in emit.files(built(name, derived), "c", "any").items():
        (tmp_path / file).write_text(text)
    strict = ["-std=c99", "-pedantic-errors", "-Wall", "-Wextra", "-Wconversion", "-Werror", "-O0"]
    subprocess.run(["cc", *strict, "-c", "any.c"], cwd=tmp_path, check=True)
    if shutil.which("nm"):
        said = subprocess.run(["nm", "-u", "any.o"], cwd=tmp_path, check=True, capture_output=True, text=True).stdout
        called = {line.split()[-1].lstrip("_").split("@")[0] for line in said.splitlines()} - {"GLOBAL_OFFSET_TABLE_"}
        allowed = {"exp", "sin", "cos", "sincos", "sqrt", "pow", "nearbyint", "memset", "stack_chk_fail"}
        assert called <= allowed
    if shutil.which("c++"):
        (tmp_path / "user.cpp").write_text('#include "any.h"\nint main() { return any_newmark_limit(0, 0, 0) > 1; }\n')
        subprocess.run(["c++", "user.cpp", "any.o", "-lm", "-o", "user"], cwd=tmp_path, check=True)


@pytest.mark.parametrize("name", OF_EACH_KIND)
def test_texts_are_clean(name: str, derived: Derived) -> None:
    for language in LANGUAGES:
        for file, text in emit.files(built(name, derived), language, "any").items():
            assert text.endswith("\n") and not text.endswith("\n\n") and "\n\n\n" not in text and "\t" not in text
            assert all(line == line.rstrip() and len(line) <= 120 for line in text.splitlines()), file
            assert "emitted by `freebeam generate" in text


def test_a_parameters_name_meets_no_other(few: None, language: str) -> None:
    """A column may call its parameters as the emitted functions call things of their own."""
    symbols = [sp.Symbol(name, real=True) for name in ("i", "n", "at", "factors", "own")]
    known = tuple(parameter(s, 0.5 + k, 0, 9) for k, s in enumerate(symbols))
    system = column(masses={(TIP, TIP): sum((k + 1) * s for k, s in enumerate(symbols))}, parameters=known)
    kernel = kernel_of(Facts(system.parameters), system)
    own = {p.name: float(p.default) for p in system.parameters}
    with foreign.loaded(emit.files(kernel, language, "any"), language, kernel) as module:
        found = module.mass_terms(module.basis(4), **own)
    numpy = numpy_of(kernel)
    assert np.abs(found[0] - numpy.mass(numpy.basis(4), **own)).max() < 1e-12


def test_words_of_c_are_refused_and_comments_stay_comments() -> None:
    taken = parameter(sp.Symbol("register", real=True), 1, 0, 2)
    system = column(masses={(TIP, TIP): taken.symbol}, parameters=(taken,))
    with pytest.raises(StatementError, match="parameter 'register': a word of C"):
        emit.files(kernel_of(Facts(system.parameters), system), "c", "any")
    kernel = kernel_of(replace(Facts(), title="A column */ int evil; /*"), column())
    texts = emit.files(kernel, "c", "any")
    bare = re.sub(r"/\*.*?\*/", "", texts["any.h"], flags=re.DOTALL)
    assert "evil" in texts["any.h"] and "evil" not in bare


def test_the_guides_programs_run(tmp_path: Path, derived: Derived) -> None:
    """What docs/guides/languages.md says, in C, through ctypes and in JavaScript, gives the NumPy kernel's numbers."""
    if lacking := foreign.missing("c"):
        pytest.skip(lacking)
    guide = (Path(__file__).parents[2] / "docs/guides/languages.md").read_text(encoding="utf-8")
    blocks = dict(re.findall(r"```(c|python|html)\n(.*?)```", guide, re.DOTALL))
    commands = re.findall(r"^\$ (cc .*)$", guide, re.MULTILINE)
    kernel = derived("beck").kernel("modes")
    (tmp_path / "kernels").mkdir()
    for language in LANGUAGES:
        for file, text in emit.files(kernel, language, "beck").items():
            (tmp_path / "kernels" / file).write_text(text)
    (tmp_path / "main.c").write_text(blocks["c"])
    for command in commands:
        subprocess.run(command.split(), cwd=tmp_path, check=True)
    said = subprocess.run([tmp_path / "main"], check=True, capture_output=True, text=True).stdout.split()
    numpy = numpy_of(kernel)
    basis = numpy.basis(8)
    E, H = numpy.stiffness_elastic(basis), numpy.stiffness_load(basis, eta=0.9)
    assert [float(number) for number in said] == pytest.approx([E[0, 0], H[0, 1]], rel=1e-14)
    script = blocks["python"] + "\nprint(K.tolist())\n"
    done = subprocess.run([sys.executable, "-c", script], cwd=tmp_path, check=True, capture_output=True, text=True)
    assert np.abs(np.array(json.loads(done.stdout)) - E - 15 * H).max() <= 1e-13 * np.abs(E).max()
    if node := shutil.which("node"):
        module = re.search(r'<script type="module">(.*)</script>', blocks["html"], re.DOTALL)
        assert module is not None
        (tmp_path / "page.mjs").write_text(module[1])
        said = subprocess.run(
            [node, "page.mjs"], cwd=tmp_path, check=True, capture_output=True, text=True
        ).stdout.split()
        assert float(said[0]) == pytest.approx(E[0, 0], rel=1e-14) and float(said[1]) == pytest.approx(
            H[0, 1], rel=1e-14
        )


# --- the command --------------------------------------------------------------------------------------------


@pytest.fixture
def unmeasured(few: None, derived: Derived, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pipeline, "derive", lambda column: derived(column.name))
    monkeypatch.setattr(pipeline, "_measured", lambda *_: (verify.Figure("a", "b", 1e-16, 1e-14),))


def test_languages_share_a_folder_and_nothing_foreign_is_overwritten(unmeasured: None, tmp_path: Path) -> None:
    pipeline.generate(["beck"], tmp_path, only=["modes"])
    for language in LANGUAGES:
        pipeline.generate(["beck"], tmp_path, only=["modes"], language=language)
    files = {"beck.py", "beck.c", "beck.h", "beck.mjs"}
    assert files < {path.name for path in tmp_path.iterdir()}
    assert files == set(json.loads((tmp_path / "MANIFEST.json").read_text())["files"])
    assert "beck.mjs" not in (tmp_path / "__init__.py").read_text()
    for language in ("python", *LANGUAGES):
        assert pipeline.generate(["beck"], tmp_path, check=True, only=["modes"], language=language).difference == ""
    (tmp_path / "beck.mjs").write_text("// my own\n")
    with pytest.raises(StatementError, match=r"beck\.mjs exists and was not emitted"):
        pipeline.generate(["beck"], tmp_path, only=["modes"], language="javascript")
    assert (tmp_path / "beck.mjs").read_text() == "// my own\n"


@pytest.mark.parametrize(
    "arguments, said",
    [
        (["--language", "fortran"], "language 'fortran': kernels are written in python, c, javascript"),
        (["--language", "c"], "in c with --output"),
    ],
)
def test_bad_input_is_one_line(arguments: list[str], said: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["generate", *arguments]) == 2
    line = capsys.readouterr().err
    assert said in line and line.count("\n") == 1


@pytest.mark.parametrize("language, lacking", [("c", "there is no cc on the path"), ("javascript", "no node")])
def test_nothing_is_written_that_cannot_be_verified(
    language: str, lacking: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(foreign, "shutil", SimpleNamespace(which=lambda _: None))
    with pytest.raises(StatementError, match=lacking):
        pipeline.generate(["beck"], tmp_path / "kernels", language=language)
    assert not (tmp_path / "kernels").exists()
