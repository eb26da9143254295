"""The map: from a column's statement to its verified kernel, stage by stage, each from the one before.

stage         in                          out                                       where
statement     file                        Column                                    statement.py, columns/
scaling       dimensional energies        the nondimensional ones                   scaling.py       Eq. (5)
variation     energies, virtual work      weak and strong form, end conditions  variation.py     Eqs. (2), (6)-(8), (15)
Ritz          weak form                   M, C, E, H, Q as bilinear forms           ritz.py          Eqs. (9)-(13)
assembly      weak form of any column     M, C, K by powers of P, rigid motions     assembly.py      Eqs. (9)-(13)
modes         ends                        comparison modes, rigid functions         comparison.py    Eqs. (14)-(23)
integrals     forms, modes                closed forms                              integrals.py     Eq. (11)
stability     matrices                    pencil, meeting, tangent rule, work       eigenproblem.py  Eqs. (24)-(26)
any column    forms, matrices             the same, as a record                     general_steps.py, -stability.py
pulsation     a load that pulsates        multipliers, edges of regions             pulsation.py
Newmark       Eq. (10)                    recurrence, order, stability limit        newmark.py
proofs        all of these                every step by another route               step_proofs.py, variation_proofs.py
bases         forms, trial functions      programs: modes, Legendre's polynomials   bases/           Eqs. (9), (11)
emission      programs                    NumPy, C or JavaScript module             emit/
verification  module, forms               measured errors within bounds             verify.py, independent.py
languages     C or JavaScript module      the NumPy module's functions              foreign.py
rounding      NumPy module                proven bounds                             rounding.py
"""

from __future__ import annotations

import difflib
import hashlib
import importlib.util
import json
from collections.abc import Iterable, Sequence
from contextlib import ExitStack, suppress
from dataclasses import dataclass
from functools import cached_property, partial
from importlib.metadata import version
from pathlib import Path

from freebeam_derive import (
    assembly,
    bases,
    comparison,
    eigenproblem,
    emit,
    foreign,
    general_stability,
    general_steps,
    integrals,
    newmark,
    pulsation,
    ritz,
    rounding,
    scaling,
    statement,
    step_proofs,
    variation,
    verify,
)
from freebeam_derive.bases import segments
from freebeam_derive.derivation import Derivation, GeneralDerivation
from freebeam_derive.files import written
from freebeam_derive.kernel import Figure, Kernel, Progress
from freebeam_derive.record import Step
from freebeam_derive.statement import Column, StatementError

POLYNOMIALS = "legendre"
MANIFEST, REPORT, INDEX = "MANIFEST.json", "report.json", "__init__.py"
_MARK = "emitted by `freebeam generate"


class Derived(Derivation):
    """A derivation with what is made of it: its kernels, and the record of all its steps."""

    def kernel(self, basis: str) -> Kernel:
        """The kernel graph in a basis, made once."""
        if basis not in self._kernels:
            self._kernels[basis] = bases.build(basis, self)
        return self._kernels[basis]

    @cached_property
    def _kernels(self) -> dict[str, Kernel]:
        return {}

    @cached_property
    def steps(self) -> tuple[Step, ...]:
        """The record of every stage, in order; each step with its proof."""
        made = (
            *self.scaling,
            *self.motion.steps,
            *self.system.steps,
            *(step for basis in statement.bases() for step in bases.steps(basis, self)),
            *eigenproblem.steps(self),
            *pulsation.steps(),
            *self.newmark.steps,
        )
        return tuple(step_proofs.attach(self, made))


class GeneralDerived(GeneralDerivation):
    """A derivation of any column with what is made of it: its kernel, and the record of all its steps."""

    @cached_property
    def kernel(self) -> Kernel:
        """The kernel graph in polynomials on segments, made once."""
        return segments.kernel_of(self.column, self.system, self.motion)

    @cached_property
    def steps(self) -> tuple[Step, ...]:
        """The record of every stage, in order; each step with its proof."""
        made = (
            *self.scaling,
            *self.motion.steps,
            *general_steps.steps(self),
            *general_stability.steps(self),
            *self.newmark.steps,
        )
        return tuple(step_proofs.attach(self, made))


@dataclass(frozen=True)
class Outcome:
    """What a generation did. difference: a unified diff, or why there is none; empty where all agrees."""

    output: Path
    columns: tuple[str, ...]
    written: tuple[Path, ...]
    difference: str
    figures: dict[str, tuple[Figure, ...]]


def columns() -> dict[str, Path]:
    """Names of the columns whose kernels are checked in, and the files that state them."""
    return statement.columns()


def known() -> dict[str, Path]:
    """Those and the gallery's."""
    return {**statement.columns(), **statement.gallery()}


def derive(column: Column) -> Derived:
    """Every stage before emission, from a column's statement. Raises StatementError where it makes no sense."""
    scaled = scaling.derive_scaling(column)
    motion = variation.derive_column(column)
    system = ritz.derive(motion)
    beam = comparison.comparison_beam(column.ends)
    integrals.refuse_coupled(system, beam)
    damped = comparison.damped_modes(motion)
    return Derived(column, scaled, motion, system, beam, damped, newmark.derive_newmark())


def general(column: Column) -> GeneralDerived:
    """Every stage before emission of any column, as forms on segments. Raises StatementError as `derive` does."""
    scaled = scaling.derive_scaling(column)
    motion = variation.derive_column(column)
    system = assembly.assemble(column, motion)
    return GeneralDerived(column, scaled, motion, system, newmark.derive_newmark())


def derived(column: Column) -> Derived | GeneralDerived:
    """`derive`, or `general` for a column beyond the textbook's."""
    try:
        return derive(column)
    except ritz.NotTextbook:
        return general(column)


def kernels(column: Column, in_bases: Sequence[str]) -> dict[str, Kernel]:
    """The kernel graphs of a column by the bases that are asked for and suit it.

    A column beyond the textbook's has polynomials on segments, under the name of the polynomials. Raises StatementError
    where it makes no sense, or no basis that is asked for suits it.
    """
    try:
        derived = derive(column)
    except ritz.NotTextbook as reason:
        if (column.basis in in_bases and column.basis != POLYNOMIALS) or POLYNOMIALS not in in_bases:
            wanted = column.basis if column.basis != POLYNOMIALS else in_bases[0]
            raise StatementError(f"basis {wanted}: does not suit {column.name}: {reason}; use {POLYNOMIALS}") from None
        found = general(column)
        return {POLYNOMIALS: found.kernel}
    return {basis: derived.kernel(basis) for basis in in_bases}


def find(target: str | Path) -> Column:
    """A column by its name, or by the path of its file. Raises StatementError."""
    named = known()
    if str(target) in named:
        return statement.load_column(named[str(target)])
    if not str(target).endswith(".py") and not Path(target).exists():
        raise StatementError(
            f"column {str(target)!r} is not known; there are {', '.join(columns())}, and the gallery's, which "
            "`freebeam columns` lists; or give the file of your own"
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
    only: Sequence[str] | None = None,
    language: str = "python",
    prove: bool = True,
) -> Outcome:
    """Derive, emit and verify columns; write their modules whole, or none of them.

    targets: names or files, all columns of this tree where empty. output: folder, this tree's own where None; an
    installed package has no tree, and needs one named.
    check: write nothing, compare with what is there. progress: told what is being done. only: the bases that modules
    are made for, all where None; those of polynomials are named `…_legendre.py`.
    language: of the modules, "python", "c" or "javascript"; this tree's own are Python's. prove: bound the rounding of
    NumPy modules by proof, for the manifest.

    Raises StatementError for a statement that makes no sense or a file in the way that was not emitted,
    VerificationError for a kernel that fails; then nothing is written.
    """
    emit.refuse_language(language)
    if lacking := "" if check else foreign.missing(language):
        raise StatementError(f"{lacking}; nothing is written that was not verified")
    if output is None and language != "python":
        raise StatementError(
            f"freebeam's own kernels are Python's; name a folder for those in {language} with --output"
        )
    if output is None and not (Path(__file__).parents[2] / "pyproject.toml").is_file():
        raise StatementError("an installed freebeam is not written to: name a folder for the kernels with --output")
    output = tree() if output is None else Path(output)
    chosen, in_bases = [find(target) for target in (targets or columns())], statement.bases() if only is None else only
    tools, before = _manifest(output) or ({}, {})
    names, say = tuple(column.name for column in chosen), progress or (lambda _: None)
    if check and tools not in ({}, _tools()):
        return Outcome(output, names, (), f"cannot compare: {_other_tools(tools)}\n", {})
    built = []
    for column in chosen:
        say(f"{column.name}: derive")
        built += [(bases.module_of(column, basis), k) for basis, k in kernels(column, in_bases).items()]
    _refuse_doubled([module for module, _ in built])
    _refuse_homonyms(chosen, targets, output)
    emitted = [(kernel, emit.files(kernel, language, module)) for module, kernel in built]
    texts = {file: text for _, found in emitted for file, text in found.items()}
    others = sorted(set(before) - set(texts))
    if targets and others and tools != _tools():
        raise StatementError(
            f"{output} holds {others[0]} of other tools: {_other_tools(tools)}, or choose another --output"
        )

    figures: dict[str, tuple[Figure, ...]] = {}
    for kernel, found in () if check else emitted:
        label = ", ".join([kernel.column.name, kernel.basis_name, *([language] if language != "python" else [])])
        figures[label] = _measured(kernel, found, language, partial(_told, say, label))
    # a part of the columns leaves the others of the folder as they are; all of them leave nothing else of the language
    kept = {file: entry for file, entry in before.items() if targets or Path(file).suffix not in _suffixes(texts)}
    prove = prove and language == "python"
    entries = {file: _entry(kernel, text, prove) for kernel, found in emitted for file, text in found.items()}
    files = dict(sorted({**kept, **entries}.items()))
    if language == "python":
        texts[INDEX] = _index(files)
    texts[MANIFEST] = json.dumps({"tools": _tools(), "files": files}, indent=2, ensure_ascii=False) + "\n"
    if check:
        return Outcome(output, names, (), _difference(output, texts, set(kept), bool(targets)), {})
    written = _write(output, texts, [output / name for name in before if name not in files])
    _report(output, figures)
    return Outcome(output, names, written, "", figures)


def _measured(kernel: Kernel, texts: dict[str, str], language: str, say: Progress) -> tuple[Figure, ...]:
    """What the verification of a column's module measures."""
    if language == "python":
        return verify.verify(kernel, next(iter(texts.values())), say)
    with foreign.loaded(texts, language, kernel) as module:
        return verify.measure(kernel, module, say)


def _told(say: Progress, label: str, what: str) -> None:
    say(f"{label}: verify {what}")


def _suffixes(files: Iterable[str]) -> set[str]:
    return {Path(file).suffix for file in files} - {".json"}


def _refuse_doubled(modules: Sequence[str]) -> None:
    doubled = sorted(module for module in modules if modules.count(module) > 1)
    if doubled:
        raise StatementError(f"two columns would be written to {doubled[0]}.py; give each a name of its own")


def _refuse_homonyms(chosen: Sequence[Column], targets: Sequence[str | Path], output: Path) -> None:
    """A user's column that would take the place of one of this tree's own."""
    own = known()
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
    return {name: version(name) for name in ("sympy", "mpmath", "ruff")}


def _other_tools(recorded: dict[str, str]) -> str:
    here = _tools()
    differing = ", ".join(
        f"{n} {here[n]} is installed, {v} made the kernels" for n, v in recorded.items() if here.get(n) != v
    )
    return f"{differing}; install the pinned versions with `make`"


def _entry(built: Kernel, text: str, prove: bool) -> dict[str, object]:
    proof: dict[str, object] = {}
    if prove:
        # a factor that is no polynomial, or a function that balls do not have: then nothing is said to be proven
        with suppress(ArithmeticError, TypeError):
            of, bound = built.proven(text)
            proof = {"proven": {"of": of, "bound": bound, "assuming": rounding.ASSUMING}}
    return {
        "column": built.column.name,
        "basis": built.basis_name,
        "sha256": hashlib.sha256(text.encode()).hexdigest(),
        **built.cost(),
        "bounds": built.bounds(),
        **proof,
    }


def _index(files: dict[str, dict[str, object]]) -> str:
    text = '"""Kernels of columns, derived from their energies and emitted by `freebeam generate`; do not edit."""\n'
    text += "\n# the module of a column in each basis\nCOLUMNS: dict[str, dict[str, str]] = {\n"
    files = {file: entry for file, entry in files.items() if file.endswith(".py")}
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
    modules = [path for suffix in sorted(_suffixes(texts)) for path in output.glob(f"*{suffix}")]
    present = {path.name for path in modules if not (some and _foreign(path))}
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


def _report(output: Path, figures: dict[str, tuple[Figure, ...]]) -> None:
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
