"""The map: from a column's statement to its verified kernel, stage by stage, each from the one before.

stage         in                          out                                       where
statement     file                        Column                                    statement.py, columns/
scaling       dimensional energies        the nondimensional ones                   scaling.py       Eq. (5)
variation     energies, virtual work      weak and strong form, end conditions  variation.py     Eqs. (2), (6)-(8), (15)
Ritz          weak form                   M, C, E, H, Q as bilinear forms           ritz.py          Eqs. (9)-(13)
modes         ends                        comparison modes, rigid functions         modes.py         Eqs. (14)-(23)
integrals     forms, modes                closed forms                              integrals.py     Eq. (11)
polynomials   ends                        Legendre series, the second basis         legendre.py      Eqs. (9), (11)
stability     matrices                    pencil, meeting, tangent rule, work       eigenproblem.py  Eqs. (24)-(26)
Newmark       Eq. (10)                    recurrence, order, stability limit        newmark.py
proofs        all of these                every step by another route               step_proofs.py
kernel        closed forms                graph of operations                       kernel.py
emission      graph                       NumPy module                              emit.py, emit_legendre.py, source.py
verification  module, forms               measured errors within bounds             verify.py, independent.py
"""

from __future__ import annotations

import difflib
import hashlib
import importlib.util
import json
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from functools import cached_property, lru_cache, partial
from importlib.metadata import version
from pathlib import Path

from freebeam_derive import (
    eigenproblem,
    emit,
    integrals,
    kernel,
    legendre,
    modes,
    newmark,
    ritz,
    scaling,
    statement,
    step_proofs,
    variation,
    verify,
)
from freebeam_derive.files import written
from freebeam_derive.kernel import ColumnKernel, Kernel, PolynomialKernel
from freebeam_derive.record import Step
from freebeam_derive.statement import BASES, Column, StatementError

MANIFEST, REPORT, INDEX = "MANIFEST.json", "report.json", "__init__.py"
_MARK = "emitted by `freebeam generate"

Progress = Callable[[str], None]


@dataclass(frozen=True)
class Derivation:
    """All that follows from a column's statement, before a line of code is written."""

    column: Column
    scaling: tuple[Step, ...]
    motion: variation.EquationOfMotion
    system: ritz.RitzSystem
    beam: modes.ComparisonBeam
    damped: modes.DampedModes | None

    @cached_property
    def kernel(self) -> ColumnKernel:
        """The kernel graph over the comparison modes."""
        return kernel.build(self.column, self.motion, self.system, self.damped, newmark_method())

    @cached_property
    def polynomials(self) -> PolynomialKernel:
        """The kernel graph over polynomials, the second basis."""
        return kernel.build_polynomials(self.column, self.motion, self.system, newmark_method())

    @property
    def steps(self) -> tuple[Step, ...]:
        """The record of every stage, in order; each step with its proof."""
        damped = self.damped.steps if self.damped else ()
        made = (
            *self.scaling,
            *self.motion.steps,
            *self.system.steps,
            *damped,
            *self.beam.steps,
            *integrals.orthogonality(self.beam),
            eigenproblem.load_matrix(self.beam, self.system.H),
            *legendre.polynomials(self.column.ends).steps,
            *eigenproblem.steps(self),
            *newmark_method().steps,
        )
        return tuple(step_proofs.attach(self, made))


@dataclass(frozen=True)
class Outcome:
    """What a generation did. difference: a unified diff, or why there is none; empty where all agrees."""

    output: Path
    columns: tuple[str, ...]
    written: tuple[Path, ...]
    difference: str
    figures: dict[str, tuple[verify.Figure, ...]]


newmark_method = lru_cache(maxsize=1)(newmark.derive_newmark)


def columns() -> dict[str, Path]:
    """Names of the columns of this tree, and the files that state them."""
    return statement.columns()


def derive(column: Column) -> Derivation:
    """Every stage before emission, from a column's statement. Raises StatementError where it makes no sense."""
    scaled = scaling.derive_scaling(column)
    motion = variation.derive_column(column)
    system = ritz.derive(motion)
    beam = modes.comparison_beam(column.ends)
    damped = modes.damped_modes(motion)
    return Derivation(column, scaled, motion, system, beam, damped)


def find(target: str | Path) -> Column:
    """A column by its name, or by the path of its file. Raises StatementError."""
    known = columns()
    if str(target) in known:
        return statement.load_column(known[str(target)])
    if not str(target).endswith(".py") and not Path(target).exists():
        raise StatementError(
            f"column {str(target)!r} is not known; there are {', '.join(known)}, or give the file of your own"
        )
    return statement.load_column(target)


def tree() -> Path:
    """Folder of the kernels that are checked in."""
    spec = importlib.util.find_spec("freebeam_kernels")
    if spec is None or not spec.submodule_search_locations:
        raise StatementError("freebeam_kernels is not installed; name a folder with --output")
    return Path(next(iter(spec.submodule_search_locations)))


def generate(
    targets: Sequence[str | Path] = (),
    output: Path | None = None,
    progress: Progress | None = None,
    check: bool = False,
    bases: Sequence[str] = BASES,
) -> Outcome:
    """Derive, emit and verify columns; write their modules whole, or none of them.

    targets: names or files, all columns of this tree where empty. output: folder, this tree's own where None; an
    installed package has no tree, and needs one named.
    check: write nothing, compare with what is there. progress: told what is being done. bases: which trial functions
    a module is made for; those of polynomials are named `…_legendre.py`.

    Raises StatementError for a statement that makes no sense or a file in the way that was not emitted,
    VerificationError for a kernel that fails; then nothing is written.
    """
    say = progress or (lambda _: None)
    if output is None and not (Path(__file__).parents[2] / "pyproject.toml").is_file():
        raise StatementError("an installed freebeam is not written to: name a folder for the kernels with --output")
    output = tree() if output is None else Path(output)
    chosen = [find(target) for target in (targets or columns())]
    modules = [_module(column, basis) for column in chosen for basis in bases]
    doubled = {module for module in modules if modules.count(module) > 1}
    if doubled:
        raise StatementError(f"two columns would be written to {sorted(doubled)[0]}.py; give each a name of its own")
    _refuse_homonyms(chosen, targets, output)
    before = _manifest(output)
    names = tuple(c.name for c in chosen)
    if check and before and before[0] != _tools():
        return Outcome(output, names, (), f"cannot compare: {_other_tools(before[0])}\n", {})
    if before and before[0] != _tools() and targets and set(before[1]) - {f"{module}.py" for module in modules}:
        others = sorted(set(before[1]) - {f"{module}.py" for module in modules})
        raise StatementError(
            f"{output} holds {others[0]} of other tools: {_other_tools(before[0])}, or choose another --output"
        )

    texts: dict[str, str] = {}
    entries: dict[str, dict[str, object]] = {}
    figures: dict[str, tuple[verify.Figure, ...]] = {}
    for column in chosen:
        say(f"{column.name}: derive")
        derived = derive(column)
        for basis in bases:
            built = derived.kernel if basis == "modes" else derived.polynomials
            label = column.name if basis == "modes" else f"{column.name}, {basis}"
            text, file = emit.emit(built), f"{_module(column, basis)}.py"
            texts[file], entries[file] = text, _entry(built, basis, text)
            if not check:
                say(f"{label}: verify")
                figures[label] = verify.verify(built, text, partial(_say, say, label))
    # a part of the columns leaves the others of the folder as they are; all of them leave nothing else there
    kept = before[1] if before and targets else {}
    files = dict(sorted({**kept, **entries}.items()))
    texts[INDEX] = _index(files)
    texts[MANIFEST] = json.dumps({"tools": _tools(), "files": files}, indent=2, ensure_ascii=False) + "\n"

    if check:
        return Outcome(output, names, (), _difference(output, texts, set(kept), bool(targets)), {})
    obsolete = [output / name for name in (before[1] if before else {}) if name not in files]
    written = _write(output, texts, obsolete)
    _report(output, figures)
    return Outcome(output, names, written, "", figures)


def _say(say: Progress, name: str, what: str) -> None:
    say(f"{name}: verify {what}")


def _refuse_homonyms(chosen: Sequence[Column], targets: Sequence[str | Path], output: Path) -> None:
    """A user's column that would take the place of one of this tree's own."""
    own = columns()
    for column, target in zip(chosen, targets, strict=False):
        if column.name in own and str(target) not in own and output.resolve() == tree().resolve():
            if not Path(target).exists() or not Path(target).samefile(own[column.name]):
                raise StatementError(
                    f"{target}: a column of its name, {column.name}, comes with freebeam; "
                    "give it a name of its own, or choose another --output"
                )


# --- files --------------------------------------------------------------------------------------------------


def _tools() -> dict[str, str]:
    """What decides the emitted bytes."""
    return {"sympy": version("sympy"), "mpmath": version("mpmath")}


def _other_tools(recorded: dict[str, str]) -> str:
    here = _tools()
    differing = ", ".join(
        f"{n} {here[n]} is installed, {v} made the kernels" for n, v in recorded.items() if here.get(n) != v
    )
    return f"{differing}; install the pinned versions with `make`"


def _module(column: Column, basis: str) -> str:
    """Name of a column's module in a basis."""
    return column.module if basis == "modes" else f"{column.module}_{basis}"


def _entry(built: Kernel, basis: str, text: str) -> dict[str, object]:
    bounds: dict[str, float]
    if isinstance(built, PolynomialKernel):
        count = verify.POLYNOMIALS
        cost = {"matrix_products": built.products, "exact_in_fractions_up_to": count}
        bounds = {
            f"matrix entries up to N = {count}, of the norms of their terms": verify.BOUND,
            f"polynomials up to N = {count} and their derivatives to the third, of the largest value": verify.BOUND,
        }
    else:
        assert isinstance(built, ColumnKernel)
        cost = {"operations_per_entry": built.operations}
        bounds = {
            f"matrix entries up to N = {verify.MATRIX_MODES}, of the norms of their terms": verify.BOUND,
            f"modes up to {verify.EXACT_MODES} and their derivatives to the third, of the largest value": verify.BOUND,
            f"modes up to {max(verify.HIGH_MODES)}, of the largest value, in units of gamma times 2^-53": 4,
        }
    return {
        "column": built.column.name,
        "basis": basis,
        "sha256": hashlib.sha256(text.encode()).hexdigest(),
        **cost,
        "bounds": bounds,
    }


def _index(files: dict[str, dict[str, object]]) -> str:
    text = '"""Kernels of columns, derived from their energies and emitted by `freebeam generate`; do not edit."""\n'
    text += "\n# the module of a column in each basis\nCOLUMNS: dict[str, dict[str, str]] = {\n"
    for name in sorted({str(entry["column"]) for entry in files.values()}):
        modules = {e["basis"]: file.removesuffix(".py") for file, e in sorted(files.items()) if e["column"] == name}
        text += f'    "{name}": {{' + ", ".join(f'"{basis}": "{file}"' for basis, file in modules.items()) + "},\n"
    return text + "}\n"


def _manifest(output: Path) -> tuple[dict[str, str], dict[str, dict[str, object]]] | None:
    """Tools and files of a folder's manifest, None where there is none that can be read."""
    try:
        found = json.loads((output / MANIFEST).read_text(encoding="utf-8"))
        return dict(found["tools"]), dict(found["files"])
    except (OSError, ValueError, KeyError, TypeError):
        return None


def _difference(output: Path, texts: dict[str, str], kept: set[str], some: bool) -> str:
    """Unified diff of a folder against what it should hold, missing and extra modules included.

    some: only some columns were asked for; then a file that was not emitted is nobody's business here.
    """
    present = {path.name for path in output.glob("*.py") if not (some and _foreign(path))}
    parts: list[str] = []
    for name in sorted({*texts, *(present - kept)}):
        path = output / name
        old = path.read_bytes().decode(errors="replace") if path.is_file() else ""
        new = texts.get(name, "")
        parts += difflib.unified_diff(
            old.splitlines(keepends=True),
            new.splitlines(keepends=True),
            f"{path} (in the tree)" if path.is_file() else "missing",
            f"{path} (derived)" if name in texts else "extra",
        )
    return "".join(parts)


def _foreign(path: Path) -> bool:
    """Whether something stands at a path that this program did not emit."""
    if path.name in (MANIFEST, REPORT):
        return path.exists() and _manifest(path.parent) is None
    return path.is_dir() or (path.exists() and _MARK not in path.read_bytes().decode(errors="replace"))


def _write(output: Path, texts: dict[str, str], obsolete: list[Path]) -> tuple[Path, ...]:
    """Put the modules in their places, unless a file that was not emitted is in the way, and drop obsolete ones."""
    for path in (output / name for name in (*texts, REPORT)):
        if _foreign(path):
            raise StatementError(
                f"{path} exists and was not emitted by this program; move it, or choose another --output"
            )
    _put(output, texts)
    for path in obsolete:
        if not _foreign(path):
            path.unlink(missing_ok=True)
    return tuple(output / name for name in texts)


def _report(output: Path, figures: dict[str, tuple[verify.Figure, ...]]) -> None:
    """The measured errors, beside the kernels; they vary in the last digit from machine to machine."""
    listed = {name: [vars(figure) for figure in found] for name, found in figures.items()}
    try:
        known = dict(json.loads((output / REPORT).read_text(encoding="utf-8")))
    except (OSError, ValueError, TypeError):
        known = {}
    _put(output, {REPORT: json.dumps({**known, **listed}, indent=2, ensure_ascii=False) + "\n"})


def _put(output: Path, texts: dict[str, str]) -> None:
    """Write files beside their places, all of them whole, then put each in its place."""
    try:
        output.mkdir(parents=True, exist_ok=True)
        with ExitStack() as stack:
            for name, text in texts.items():
                path = output / name
                stream = stack.enter_context(written(path, path.exists()))
                stream.write(text.encode())
                stream.flush()  # all of them are on the disk before the first takes its place
    except OSError as error:
        text = f"cannot be written to: {error.filename or output}: {error.strerror}"
        raise StatementError(f"{output}: {text}; choose another --output") from error
