"""From a statement's file to files in a folder: all of them, or none; and what --check says of a folder."""

from __future__ import annotations

import hashlib
import json
import os
import resource
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from freebeam_derive import emit, pipeline, rounding, verify
from freebeam_derive.pipeline import INDEX, MANIFEST, REPORT, Derived, generate
from freebeam_derive.statement import StatementError
from freebeam_derive.verify import VerificationError

StatementOf = Callable[[str], Path]


@pytest.fixture
def unverified(monkeypatch: pytest.MonkeyPatch, derived: Callable[[str], Derived]) -> None:
    """Verification is taken as passed, and each column is derived, emitted and bounded once: files are tested."""
    monkeypatch.setattr(verify, "verify", lambda *_: (verify.Figure("a", "b", 1e-16, 1e-14),))
    monkeypatch.setattr(emit, "emit", emitted)
    monkeypatch.setattr(rounding, "of_beam", bounded)
    known = {name: derived(name) for name in (*pipeline.columns(), "leipholz")}
    true = pipeline.derive

    def once(column: Any) -> Derived:
        found = known.get(column.name)
        return found if found is not None and found.column == column else true(column)

    monkeypatch.setattr(pipeline, "derive", once)


TEXTS: dict[int, tuple[Any, str]] = {}


def emitted(built: Any, true: Callable[[Any], str] = emit.emit) -> str:
    if id(built) not in TEXTS:
        TEXTS[id(built)] = built, true(built)  # the kernel is kept, so that its number stays its own
    return TEXTS[id(built)][1]


PROOFS: dict[str, float] = {}


def bounded(built: Any, text: str, *given: Any, true: Callable[..., float] = rounding.of_beam) -> float:
    if text not in PROOFS:
        PROOFS[text] = true(built, text, *given)
    return PROOFS[text]


def held(folder: Path) -> dict[str, bytes]:
    """Everything in a folder, by relative path, hidden files included."""
    return {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def modules(folder: Path) -> list[str]:
    """The modules of a folder by its manifest; a column's name stands in each."""
    return list(json.loads((folder / MANIFEST).read_text(encoding="utf-8"))["files"])


# --- the tree and a user's column ---------------------------------------------------------------------------


def test_the_tree_holds_what_is_derived() -> None:
    """generated/ is emitted from columns/ byte for byte, with nothing missing and nothing extra."""
    outcome = generate(check=True)
    assert outcome.difference == ""
    assert outcome.columns == tuple(pipeline.columns())
    assert outcome.written == ()
    manifest = json.loads((pipeline.tree() / MANIFEST).read_text(encoding="utf-8"))
    for name, entry in manifest["files"].items():
        assert hashlib.sha256((pipeline.tree() / name).read_bytes()).hexdigest() == entry["sha256"]
        assert entry.get("operations_per_entry", 0) <= 40
        assert all(0 < bound <= 4 for bound in entry["bounds"].values())


def test_a_user_s_column_is_emitted_and_verified(tmp_path: Path, statement_of: StatementOf) -> None:
    """All of it, at 50 digits: the statement's file in, a kernel, its index, manifest and measured errors out."""
    told: list[str] = []
    outcome = generate([statement_of("leipholz")], tmp_path / "deep" / "folder", told.append)
    assert outcome.difference == "" and outcome.columns == ("leipholz",)
    assert {path.name for path in outcome.written} == {*modules(outcome.output), INDEX, MANIFEST}
    assert set(held(outcome.output)) == {*modules(outcome.output), INDEX, MANIFEST, REPORT}
    figures = outcome.figures["leipholz, modes"]
    assert all(figure.error <= figure.bound for figure in figures)
    report = json.loads((outcome.output / REPORT).read_text(encoding="utf-8"))
    assert [entry["error"] for entry in report["leipholz, modes"]] == [figure.error for figure in figures]
    manifest = json.loads((outcome.output / MANIFEST).read_text(encoding="utf-8"))
    assert set(manifest) == {"tools", "files"} and set(manifest["tools"]) == {"sympy", "mpmath", "ruff"}
    text = (outcome.output / "leipholz.py").read_bytes()
    assert manifest["files"]["leipholz.py"]["sha256"] == hashlib.sha256(text).hexdigest()
    assert told[0] == "leipholz: derive" and "leipholz, modes: verify matrices" in told
    module = verify.load(text.decode(), "leipholz")
    # Leipholz's flutter load, 40.05 q l³/EI, from the emitted matrices: two frequencies meet
    basis = module.basis(8)
    M, E, H = module.mass(basis), module.stiffness_elastic(basis), module.stiffness_load(basis)
    import numpy as np

    def oscillates(load: float) -> bool:
        return bool(np.abs(np.linalg.eigvals(np.linalg.solve(M, E + load * H)).imag).max() > 1e-6)

    assert not oscillates(39.9) and oscillates(40.2)


@pytest.mark.usefixtures("unverified")
def test_generate_then_check_agree(tmp_path: Path, statement_of: StatementOf) -> None:
    files = [statement_of("leipholz"), "beck"]
    generate(files, tmp_path)
    before = held(tmp_path)
    assert generate(files, tmp_path, check=True).difference == ""
    assert generate(list(reversed(files)), tmp_path, check=True).difference == ""
    generate(list(reversed(files)), tmp_path)
    assert {n: t for n, t in held(tmp_path).items() if n != REPORT} == {n: t for n, t in before.items() if n != REPORT}


# --- --check ------------------------------------------------------------------------------------------------


@pytest.fixture
def tree(tmp_path: Path) -> Path:
    """A copy of the kernels that are checked in."""
    return Path(shutil.copytree(pipeline.tree(), tmp_path / "tree", ignore=shutil.ignore_patterns("__pycache__")))


def difference(folder: Path, targets: tuple[str, ...] = ()) -> str:
    """What --check says; it writes nothing."""
    before = held(folder) if folder.exists() else {}
    found = generate(targets, folder, check=True)
    assert (held(folder) if folder.exists() else {}) == before
    assert found.written == () and found.figures == {}
    return found.difference


@pytest.mark.usefixtures("unverified")
class TestCheck:
    def test_equal(self, tree: Path) -> None:
        assert difference(tree) == ""
        assert difference(tree, ("beck",)) == ""

    def test_a_changed_byte(self, tree: Path) -> None:
        path = tree / "beck.py"
        path.write_text(path.read_text(encoding="utf-8").replace("0.5 *", "0.6 *", 1), encoding="utf-8")
        found = difference(tree)
        assert "beck.py (in the tree)" in found and "beck.py (derived)" in found
        changed = [line for line in found.splitlines() if line[:1] in "+-" and line[:3] not in ("+++", "---")]
        assert len(changed) == 2 and "0.6 *" in changed[0] and "0.5 *" in changed[1]
        assert "free_free" not in found
        assert difference(tree, ("beck",)) == found
        assert difference(tree, ("free-free",)) == ""

    def test_line_ends_and_the_last_newline_count(self, tree: Path) -> None:
        path = tree / "beck.py"
        text = path.read_bytes()
        path.write_bytes(text.replace(b"\n", b"\r\n"))
        assert "beck.py" in difference(tree)
        path.write_bytes(text[:-1])
        assert "beck.py" in difference(tree)

    def test_a_missing_file(self, tree: Path) -> None:
        (tree / "euler_pinned.py").unlink()
        found = difference(tree)
        assert "--- missing" in found and "euler_pinned.py (derived)" in found

    def test_an_extra_file(self, tree: Path) -> None:
        (tree / "stray.py").write_text("x = 1\n", encoding="utf-8")
        found = difference(tree)
        assert ("stray.py" in found and "+++ extra" in found.replace(f"{tree}/stray.py ", "")) or "extra" in found
        assert difference(tree, ("beck",)) == ""  # one column was asked for; a foreign file is not its business

    def test_an_extra_file_that_is_no_text(self, tree: Path) -> None:
        (tree / "stray.py").write_bytes(bytes(range(256)))
        assert "stray.py" in difference(tree)

    def test_a_changed_manifest_and_index(self, tree: Path) -> None:
        for name in (MANIFEST, INDEX):
            text = (tree / name).read_text(encoding="utf-8")
            (tree / name).write_text(text.replace("beck", "bech"), encoding="utf-8")
            assert f"{name} (in the tree)" in difference(tree)
            (tree / name).write_text(text, encoding="utf-8")

    def test_an_empty_or_missing_folder(self, tmp_path: Path) -> None:
        found = difference(tmp_path / "nothing")
        for name in ("beck.py", "free_free.py", "euler_pinned.py", INDEX, MANIFEST):
            assert f"{name} (derived)" in found
        assert not (tmp_path / "nothing").exists()

    def test_measured_figures_are_not_compared(self, tree: Path) -> None:
        (tree / REPORT).write_text("{}", encoding="utf-8")
        assert difference(tree) == ""

    def test_another_sympy_is_named_and_no_diff_made(self, tree: Path) -> None:
        manifest = json.loads((tree / MANIFEST).read_text(encoding="utf-8"))
        manifest["tools"]["sympy"] = "1.13.3"
        (tree / MANIFEST).write_text(json.dumps(manifest), encoding="utf-8")
        (tree / "beck.py").unlink()
        found = difference(tree)
        assert "sympy" in found and "1.13.3" in found and "cannot compare" in found
        assert "mpmath" not in found and "beck.py" not in found and len(found.splitlines()) == 1


# --- writing ------------------------------------------------------------------------------------------------


def failing(built: Any, *_: Any) -> Any:
    raise VerificationError(f"{built.column.name}: entries of H at row 1 are off")


@pytest.mark.usefixtures("unverified")
class TestWriting:
    def test_a_kernel_that_fails_replaces_nothing(
        self, tmp_path: Path, statement_of: StatementOf, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        generate([statement_of("leipholz")], tmp_path)
        (tmp_path / "leipholz.py").write_text("# emitted by `freebeam generate: older\n", encoding="utf-8")
        before = held(tmp_path)
        monkeypatch.setattr(verify, "verify", failing)
        with pytest.raises(VerificationError, match="leipholz"):
            generate([statement_of("leipholz")], tmp_path)
        assert held(tmp_path) == before
        with pytest.raises(VerificationError):
            generate([statement_of("leipholz")], tmp_path / "new")
        assert not (tmp_path / "new").exists()

    def test_one_that_fails_of_two_replaces_nothing(
        self, tmp_path: Path, statement_of: StatementOf, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        monkeypatch.setattr(
            verify, "verify", lambda built, *rest: failing(built, *rest) if built.column.name == "leipholz" else ()
        )
        with pytest.raises(VerificationError, match="leipholz"):
            generate(["beck", statement_of("leipholz")], tmp_path / "new")
        assert not (tmp_path / "new").exists()

    def test_some_columns_leave_the_others(self, tmp_path: Path, statement_of: StatementOf) -> None:
        generate([statement_of("leipholz")], tmp_path)
        first = held(tmp_path)
        generate(["beck"], tmp_path)
        second = held(tmp_path)
        assert second["leipholz.py"] == first["leipholz.py"]
        manifest = json.loads(second[MANIFEST])["files"]
        assert {"beck.py", "leipholz.py"} <= set(manifest)
        assert all(name.startswith(("beck", "leipholz")) for name in manifest)
        assert manifest["leipholz.py"] == json.loads(first[MANIFEST])["files"]["leipholz.py"]
        namespace: dict[str, Any] = {}
        exec(second[INDEX], namespace)
        assert namespace["COLUMNS"] == {
            name: {"modes": name, "legendre": f"{name}_legendre"} for name in ("beck", "leipholz")
        }
        assert {"beck, modes", "leipholz, legendre"} <= set(json.loads(second[REPORT]))

    def test_all_columns_leave_nothing_else(self, tree: Path, statement_of: StatementOf) -> None:
        """What an earlier column emitted goes when the tree's are all generated; what nobody emitted stays."""
        true = held(tree)
        generate([statement_of("leipholz")], tree)
        (tree / "py.typed").touch()
        assert difference(tree) != ""
        generate((), tree)
        assert not (tree / "leipholz.py").exists()
        assert {n: t for n, t in held(tree).items() if n != REPORT} == {n: t for n, t in true.items() if n != REPORT}
        assert difference(tree) == ""

    @pytest.mark.parametrize("foreign", ["leipholz.py", INDEX, MANIFEST, REPORT])
    def test_a_foreign_file_in_the_way_is_kept(self, foreign: str, tmp_path: Path, statement_of: StatementOf) -> None:
        (tmp_path / foreign).write_text('["mine"]', encoding="utf-8")
        before = held(tmp_path)
        with pytest.raises(StatementError) as caught:
            generate([statement_of("leipholz")], tmp_path)
        assert held(tmp_path) == before
        message = str(caught.value)
        assert foreign in message and "--output" in message and "\n" not in message

    def test_the_statement_itself_is_never_overwritten(self, tmp_path: Path, statement_of: StatementOf) -> None:
        """my_column.py states "my-column", whose module would be my_column.py: with --output . it is in the way."""
        path = tmp_path / "leipholz.py"
        shutil.copy(statement_of("leipholz"), path)
        before = held(tmp_path)
        with pytest.raises(StatementError, match=r"leipholz\.py exists"):
            generate([path], tmp_path)
        assert held(tmp_path) == before
        generate([path], tmp_path / "kernels")
        assert held(tmp_path)["leipholz.py"] == before["leipholz.py"]

    def test_a_folder_in_the_way_is_kept(self, tmp_path: Path, statement_of: StatementOf) -> None:
        (tmp_path / "leipholz.py").mkdir()
        (tmp_path / "leipholz.py" / "note.txt").write_text("mine", encoding="utf-8")
        with pytest.raises(StatementError, match=r"leipholz\.py exists"):
            generate([statement_of("leipholz")], tmp_path)
        assert set(held(tmp_path)) == {"leipholz.py/note.txt"}

    def test_an_output_that_is_a_file_is_kept(self, tmp_path: Path, statement_of: StatementOf) -> None:
        path = tmp_path / "kernels"
        path.write_text("mine", encoding="utf-8")
        with pytest.raises(StatementError, match="cannot be written to") as caught:
            generate([statement_of("leipholz")], path)
        assert path.read_text(encoding="utf-8") == "mine" and "\n" not in str(caught.value)

    @pytest.mark.parametrize("at", [0, 1, 2, 3])
    @pytest.mark.parametrize("reason", [KeyboardInterrupt, OSError])
    def test_an_interrupted_write_leaves_whole_files(
        self,
        at: int,
        reason: type[BaseException],
        tmp_path: Path,
        statement_of: StatementOf,
        monkeypatch: pytest.MonkeyPatch,
    ) -> None:
        """Whatever the moment: each file is the old one or the new one, whole; nothing else lies about; again works."""
        generate([statement_of("leipholz")], tmp_path)
        new = held(tmp_path)
        for name in new:
            older = new[name].replace(b"\n", b"\n\n") if name.endswith(".json") else new[name] + b"# older\n"
            (tmp_path / name).write_bytes(older)
        old = held(tmp_path)
        true, calls = os.replace, []

        def replace(source: Any, target: Any) -> None:
            if len(calls) == at:
                raise reason(5, "Input/output error")
            calls.append(target)
            true(source, target)

        monkeypatch.setattr(os, "replace", replace)
        with pytest.raises(StatementError if reason is OSError else reason):
            generate([statement_of("leipholz")], tmp_path)
        monkeypatch.setattr(os, "replace", true)
        found = held(tmp_path)
        assert set(found) == set(old)
        assert all(found[name] in (old[name], new[name]) for name in found)
        if at == 0:
            assert found == old
        if at == 1:
            assert found != old
        assert any(found[name] == old[name] for name in found)  # the last of them was never reached
        generate([statement_of("leipholz")], tmp_path)
        assert held(tmp_path) == new

    def test_a_disk_that_fills_leaves_the_old(self, tmp_path: Path, statement_of: StatementOf) -> None:
        """A limit on the size of a file stands for it: the larger of the modules do not fit."""
        generate([statement_of("leipholz")], tmp_path)
        before = held(tmp_path)
        limits = resource.getrlimit(resource.RLIMIT_FSIZE)
        try:
            resource.setrlimit(resource.RLIMIT_FSIZE, (max(map(len, before.values())) // 2, limits[1]))
            with pytest.raises(StatementError, match="File too large"):
                generate(["beck"], tmp_path)
        finally:
            resource.setrlimit(resource.RLIMIT_FSIZE, limits)
        assert held(tmp_path) == before

    def test_two_columns_of_one_name_are_refused(self, tmp_path: Path, statement_of: StatementOf) -> None:
        copy = tmp_path / "copy.py"
        shutil.copy(statement_of("leipholz"), copy)
        with pytest.raises(StatementError, match=r"leipholz\.py; give each a name"):
            generate([statement_of("leipholz"), copy], tmp_path / "out")
        with pytest.raises(StatementError, match=r"beck\.py"):
            generate(["beck", "beck"], tmp_path / "out")
        assert not (tmp_path / "out").exists()

    def test_an_unsound_statement_writes_nothing(self, tmp_path: Path, statement_of: StatementOf) -> None:
        text = statement_of("leipholz").read_text(encoding="utf-8").replace("y.diff(x, 2) ** 2", "y.diff(x, 3) ** 2")
        path = tmp_path / "unsound.py"
        path.write_text(text.split("    dimensional=")[0] + ")\n", encoding="utf-8")
        for check in (False, True):
            with pytest.raises(StatementError, match="nothing higher"):
                generate(["beck", path], tmp_path / "out", check=check)
            assert not (tmp_path / "out").exists()


# --- what must not take another's place ---------------------------------------------------------------------


@pytest.mark.usefixtures("unverified")
def test_a_user_s_column_does_not_replace_the_tree_s(
    tmp_path: Path, tree: Path, statement_of: StatementOf, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A statement that calls itself beck, generated into the tree, would be everybody's beck."""
    monkeypatch.setattr(pipeline, "tree", lambda: tree)
    own = tmp_path / "mine.py"
    own.write_text(statement_of("hauger").read_text(encoding="utf-8").replace('"hauger"', '"beck"'), encoding="utf-8")
    before = held(tree)
    for output in (None, tree):
        with pytest.raises(
            StatementError, match=r"mine\.py: a column of its name, beck, comes with freebeam"
        ) as caught:
            generate([own], output)
        assert "\n" not in str(caught.value)
    assert held(tree) == before
    assert generate([own], tmp_path / "elsewhere").columns == ("beck",)
    assert generate([pipeline.columns()["beck"]], tree).columns == ("beck",)  # the tree's own file is its own


@pytest.mark.usefixtures("unverified")
def test_other_tools_do_not_sign_older_modules(tmp_path: Path, tree: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """One column of three under another SymPy would leave two whose tools the manifest misnames."""
    manifest = json.loads((tree / MANIFEST).read_text(encoding="utf-8"))
    manifest["tools"]["sympy"] = "1.13.3"
    (tree / MANIFEST).write_text(json.dumps(manifest), encoding="utf-8")
    before = held(tree)
    with pytest.raises(
        StatementError, match=r"euler_pinned\.py of other tools: sympy .* 1\.13\.3 made the kernels"
    ) as caught:
        generate(["beck"], tree)
    assert "\n" not in str(caught.value) and "--output" in str(caught.value)
    assert held(tree) == before
    generate((), tree)  # all of them anew
    assert json.loads((tree / MANIFEST).read_text(encoding="utf-8"))["tools"] == pipeline._tools()
