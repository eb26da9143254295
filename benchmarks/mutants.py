"""How many small changes of the code the tests see: `make mutants`, or `python benchmarks/mutants.py COUNT SEED JOBS`;
with more words, such as `beam strips gaps`, of files alone whose names hold one of them.

Mutants are drawn at random by the seed from the places where an operator of cosmic-ray applies: arithmetic,
comparisons, signs, numbers, `and` and `or`, `not`, loops. The tests of each part run once with coverage, which tells
the tests that reach a line. Each mutant is put into a copy of the tree, in which the tests that reach its statement
run, those of files that name the module first, until one fails or half a minute has passed; those that reach the file
where it runs on import.
Tests that do not end within a limit of time tell nothing: such a change is counted apart, neither killed nor alive.
Those that are not killed are listed in build/mutants.json, with what was changed. A change that docs/mutants.md lists
as equivalent, with the reason, is passed over and the next one drawn: it tells nothing of the tests.
"""

from __future__ import annotations

import ast
import importlib
import json
import os
import random
import re
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Generator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from difflib import unified_diff
from itertools import accumulate
from pathlib import Path
from queue import Queue

import coverage
import pytest
from cosmic_ray.ast import Visitor, get_ast
from cosmic_ray.mutating import mutate_code
from cosmic_ray.plugins import get_operator

ROOT = Path(__file__).parents[1]
PARTS = {
    "derive/freebeam_derive/certify/*.py": ["tests/certify", "tests/front/test_proofs.py", "tests/paper"],
    "freebeam_sym/stability/{pencil,proportional,arnoldi,crossings,critical,convergence}.py": [
        "tests/runtime/test_critical.py",
        "tests/runtime/test_maps.py",
    ],
    "freebeam_sym/stability/{general,derivatives,equations}.py": [
        "tests/runtime/test_critical.py",
        "tests/runtime/test_general.py",
        "tests/runtime/test_gradient.py",
        "tests/runtime/test_any_column.py",
    ],
    "front/freebeam/maps/{surface,known,arrays}.py": ["tests/runtime/test_critical.py", "tests/runtime/test_maps.py"],
    "front/freebeam/maps/{grid,boundaries}.py": ["tests/runtime/test_maps.py", "tests/runtime/test_gradient.py"],
    "front/freebeam/pulsating/*.py": ["tests/runtime/test_pulse.py"],
    "derive/freebeam_derive/{bases,emit}/*.py": [
        "tests/derive/test_kernel.py",
        "tests/derive/test_emit.py",
        "tests/derive/test_legendre.py",
        "tests/derive/test_pipeline.py",
        "tests/derive/test_segments.py",
    ],
}
"""What is changed, and the tests that should see it, beside the file's own doctests."""
ARITHMETIC = ("Add_Sub", "Sub_Add", "Mul_Div", "Div_Mul", "Mul_Add", "Pow_Mul", "FloorDiv_Mul", "Mod_Mul")
COMPARISONS = ("Eq_NotEq", "NotEq_Eq", "Lt_LtE", "LtE_Lt", "Gt_GtE", "GtE_Gt", "Lt_Gt", "Gt_Lt", "LtE_GtE", "GtE_LtE")
OPERATORS = (
    *(f"core/ReplaceBinaryOperator_{name}" for name in ARITHMETIC),
    *(f"core/ReplaceComparisonOperator_{name}" for name in COMPARISONS),
    *(f"core/Replace{name}" for name in ("UnaryOperator_Delete_USub", "UnaryOperator_Delete_Not", "AndWithOr")),
    *(f"core/Replace{name}" for name in ("OrWithAnd", "TrueWithFalse", "FalseWithTrue", "BreakWithContinue")),
    *(f"core/{name}" for name in ("NumberReplacer", "AddNot", "ZeroIterationForLoop")),
)
OUTCOMES = "killed", "survives", "out of time"
LIMIT = 120.0, 6.0
"""Seconds, and multiples of the tests' own time, after which tests that do not end are halted. It may be a search that
no longer stops, or a machine with other work: the change is counted as out of time, not as killed."""

MOST = 30.0
"""Seconds of tests that a change is given: one that lives through them is a survivor, whatever slower tests see."""

KEPT = 0.3
"""Seconds: a test that takes longer is taken to have computed what it sees."""


@dataclass(frozen=True)
class Mutant:
    file: str
    operator: str
    occurrence: int
    part: str
    """The key of PARTS."""


def equivalents() -> list[tuple[str, str, str]]:
    """The end of a file's name, what is changed and into what: the tables of docs/mutants.md."""
    page = (ROOT / "docs" / "mutants.md").read_text(encoding="utf-8")
    return re.findall(r"^\| `([^`]+)` \| `(.*?)` → `(.*?)` \|", page, re.MULTILINE)


def is_equivalent(file: str, before: str, after: str, listed: list[tuple[str, str, str]]) -> bool:
    """Whether a change of one line is among those listed."""
    line, other = next(pair for pair in zip(before.split("\n"), after.split("\n"), strict=False) if pair[0] != pair[1])
    return any(file.endswith(name) and old in line and line.replace(old, new, 1) == other for name, old, new in listed)


class _Places(Visitor):
    """How often an operator applies in a file."""

    def __init__(self, operator: object) -> None:
        self.operator, self.count = operator, 0

    def visit(self, node: object) -> object:
        self.count += len(list(self.operator.mutation_positions(node)))  # type: ignore[attr-defined]
        return node


class Reach:
    """The plugin of pytest that writes down which tests reach which lines, and the seconds that each takes."""

    def __init__(self, sources: list[Path]) -> None:
        self.sources = sources
        self.coverage = coverage.Coverage(data_file=None, include=[str(file) for file in sources], config_file=False)
        self.seconds: dict[str, float] = {}

    def pytest_sessionstart(self) -> None:
        self.coverage.start()
        for file in self.sources:  # what runs on import belongs to no test, whichever imports it first
            importlib.import_module(
                ".".join(file.relative_to(Path.cwd()).with_suffix("").parts).removeprefix("derive.")
            )

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_protocol(self, item: pytest.Item) -> Generator[None, object, object]:
        self.coverage.switch_context(item.nodeid)
        start = time.process_time()
        done = yield
        self.seconds[item.nodeid] = time.process_time() - start
        return done

    def record(self) -> dict[str, object]:
        """The tests that reach each line of each file (null: on import), and the seconds of each test."""
        self.coverage.stop()
        data = self.coverage.get_data()
        lines = {}
        for file in self.sources:
            reached = data.contexts_by_lineno(str(file))
            lines[str(file.relative_to(Path.cwd()))] = {
                line: None if "" in tests else tests for line, tests in reached.items()
            }
        return {"lines": lines, "seconds": self.seconds}


def record_reach(part: str, output: str) -> int:
    """Run the tests of a part and write what `Reach` records: in a process of its own, in a copy of the tree."""
    plugin = Reach(files(part, Path.cwd()))
    own = map(str, plugin.sources)
    status = pytest.main(["-q", "-p", "no:cacheprovider", "--all-cases", *PARTS[part], *own], plugins=[plugin])
    Path(output).write_text(json.dumps(plugin.record()), encoding="utf-8")
    return int(status)


def files(pattern: str, root: Path = ROOT) -> list[Path]:
    """Files of a pattern that may hold {one,another} of names."""
    if "{" in pattern:
        head, rest = pattern.split("{")
        names, tail = rest.split("}")
        return [file for name in names.split(",") for file in files(head + name + tail, root)]
    return sorted(root.glob(pattern))


def mutants() -> list[Mutant]:
    """All there are."""
    found = []
    for part in PARTS:
        for file in files(part):
            tree = get_ast(file.read_text(encoding="utf-8"))
            for name in OPERATORS:
                places = _Places(get_operator(name)())
                places.walk(tree)
                here = str(file.relative_to(ROOT))
                every = 2 if name.endswith("NumberReplacer") else 1  # of n + 1 and n − 1 the first
                found += [Mutant(here, name, k, part) for k in range(0, places.count, every)]
    return found


def mutated(mutant: Mutant) -> tuple[str, str]:
    """A file before and after the change."""
    before = (ROOT / mutant.file).read_text(encoding="utf-8")
    return before, mutate_code(before, get_operator(mutant.operator)(), mutant.occurrence)


def drawn(count: int, seed: int, names: tuple[str, ...]) -> list[Mutant]:
    """Mutants in an order that the seed decides, without those that are listed as equivalent."""
    every = [mutant for mutant in mutants() if not names or any(name in Path(mutant.file).stem for name in names)]
    random.Random(seed).shuffle(every)
    listed, chosen = equivalents(), []
    for mutant in every:
        if len(chosen) < count and not is_equivalent(mutant.file, *mutated(mutant), listed):
            chosen.append(mutant)
    return chosen


def statement(source: str, line: int) -> range:
    """Lines of the innermost statement at a line; of one that holds others, those before the first of them."""
    lines = range(line, line + 1)
    for node in ast.walk(ast.parse(source)):  # from the outside to the inside
        if isinstance(node, ast.stmt) and node.lineno <= line <= (node.end_lineno or 0):
            body = getattr(node, "body", None)
            last = body[0].lineno - 1 if isinstance(body, list) else node.end_lineno or 0
            if line <= last or not isinstance(body, list):
                lines = range(node.lineno, max(last, node.lineno) + 1)
    return lines


def tests_of(mutant: Mutant, before: str, after: str, reach: dict[str, dict[str, dict[str, object]]]) -> list[str]:
    """The tests that reach what is changed, those of files that name the module first and of these the quickest, then
    those that see it in what is kept, as many as fit into `MOST`, one at least; of what runs on import those that reach
    anything of the file."""
    pairs = zip(before.split("\n"), after.split("\n"), strict=False)
    changed = next(number for number, (old, new) in enumerate(pairs, 1) if old != new)
    lines = reach[mutant.part]["lines"][mutant.file]
    reached = [lines[str(line)] for line in statement(before, changed) if str(line) in lines]
    if None in reached:
        reached = [tests for tests in lines.values() if tests is not None]
    seconds = reach[mutant.part]["seconds"]
    found = {test for tests in reached for test in tests}
    holding = {test.split("::")[0] for test in found}
    # what is computed once and kept is reached by the first test that asks alone; others that see it take no time
    kept = {test for test, time in seconds.items() if time < KEPT and test.split("::")[0] in holding} - found
    name = re.compile(rf"\b{Path(mutant.file).stem}\b")
    far = {file for file in holding if not name.search((ROOT / file).read_text(encoding="utf-8"))}
    tests = [*sorted(found, key=lambda test: (test.split("::")[0] in far, seconds[test])), *sorted(kept)]
    sums = accumulate(seconds[test] for test in tests)
    return [test for test, total in zip(tests, sums, strict=True) if total <= MOST] or tests[:1]


def outcome(
    mutant: Mutant, copies: Queue[Path], reach: dict[str, dict[str, dict[str, object]]]
) -> tuple[str, str, str]:
    """One of `OUTCOMES`, the change, and what ran for how long."""
    copy = copies.get()
    try:
        file = copy / mutant.file
        before, after = mutated(mutant)
        change = "\n".join(unified_diff(before.split("\n"), after.split("\n"), lineterm="", n=1))
        tests = tests_of(mutant, before, after, reach)
        if not tests:
            return "survives", change, "no test reaches it"
        seconds = reach[mutant.part]["seconds"]
        usual = sum(seconds.get(test, 0.0) for test in tests) or sum(seconds.values())
        file.write_text(after, encoding="utf-8")
        (copy / "build" / "tests").write_text("\n".join(tests), encoding="utf-8")
        start = time.monotonic()
        options = ["-q", "-x", "-p", "no:cacheprovider", "--no-header", "--all-cases"]
        command = [sys.executable, "-m", "pytest", *options, "@build/tests"]
        try:
            done = subprocess.run(command, **_settings(copy), timeout=LIMIT[0] + LIMIT[1] * usual)
            state = "killed" if done.returncode else "survives"
        except subprocess.TimeoutExpired:
            state = "out of time"
        file.write_text(before, encoding="utf-8")
        return state, change, f"{len(tests)} tests of {usual:.0f} s in {time.monotonic() - start:.1f} s"
    finally:
        copies.put(copy)


def _settings(copy: Path) -> dict[str, object]:
    environment = {**os.environ, "OMP_NUM_THREADS": "1", "PYTHONDONTWRITEBYTECODE": "1"}
    return {"cwd": copy, "env": environment, "capture_output": True, "check": False}


def copy_tree(copy: Path) -> Path:
    """What git lists, in another folder."""
    listed = subprocess.run(["git", "ls-files"], cwd=ROOT, capture_output=True, text=True, check=True).stdout
    for name in filter(None, listed.split("\n")):
        (copy / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy2(ROOT / name, copy / name)
    (copy / "build").mkdir(exist_ok=True)
    return copy


def reach_of(part: str, copies: Queue[Path]) -> dict[str, dict[str, object]]:
    """What the tests of a part reach."""
    copy = copies.get()
    try:
        output = copy / "build" / "reach.json"
        done = subprocess.run([sys.executable, __file__, "reach", part, str(output)], **_settings(copy))
        if done.returncode:
            raise SystemExit(f"tests of {part} fail without a change:\n{done.stdout.decode()[-3000:]}")
        return dict(json.loads(output.read_text(encoding="utf-8")))
    finally:
        copies.put(copy)


def main(count: int = 300, seed: int = 1, jobs: int = 2, *names: str) -> int:
    chosen = drawn(count, seed, names)
    counts, left = dict.fromkeys(OUTCOMES, 0), []
    with tempfile.TemporaryDirectory() as folder, ThreadPoolExecutor(jobs) as pool:
        copies: Queue[Path] = Queue()
        for number in range(jobs):
            copies.put(copy_tree(Path(folder) / str(number)))
        reach = dict(zip(PARTS, pool.map(lambda part: reach_of(part, copies), PARTS), strict=True))
        (ROOT / "build").mkdir(exist_ok=True)
        (ROOT / "build" / "reach.json").write_text(json.dumps(reach), encoding="utf-8")
        results = pool.map(lambda mutant: outcome(mutant, copies, reach), chosen)
        for number, (mutant, (state, change, what)) in enumerate(zip(chosen, results, strict=True), 1):
            print(f"{number}/{count} {state}: {what}  {mutant.file}  {mutant.operator}", flush=True)
            counts[state] += 1
            if state != "killed":
                left.append({"file": mutant.file, "operator": mutant.operator, "outcome": state, "change": change})
                print(change, flush=True)
    record = {"count": count, "seed": seed, **counts, "left": left}
    (ROOT / "build" / "mutants.json").write_text(json.dumps(record, indent=1, ensure_ascii=False), encoding="utf-8")
    told = ", ".join(f"{number} {state}" for state, number in counts.items())
    print(f"{count} changes of seed {seed}: {told}; those not killed are in build/mutants.json")
    return 0 if counts["killed"] >= 0.9 * count else 1


if __name__ == "__main__":
    if sys.argv[1:2] == ["reach"]:
        sys.exit(record_reach(*sys.argv[2:]))
    sys.exit(main(*map(int, sys.argv[1:4]), *sys.argv[4:]))
