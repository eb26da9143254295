"""How many small changes of the code the tests see: `make mutants`, or `python benchmarks/mutants.py COUNT SEED JOBS`.

Mutants are drawn at random by the seed from the places where an operator of cosmic-ray applies: arithmetic,
comparisons, signs, numbers, `and` and `or`, `not`, loops. Each is put into a copy of the tree, in which the tests of
its part are run until one fails. Those that survive are listed in build/mutants.json, with what was changed.
"""

from __future__ import annotations

import json
import os
import random
import shutil
import subprocess
import sys
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from difflib import unified_diff
from pathlib import Path
from queue import Queue

from cosmic_ray.ast import Visitor, get_ast
from cosmic_ray.mutating import mutate_code
from cosmic_ray.plugins import get_operator

ROOT = Path(__file__).parents[1]
PARTS = {
    "derive/freebeam_derive/certify/*.py": ["tests/certify", "tests/front/test_proofs.py"],
    "freebeam_sym/stability/{pencil,proportional,arnoldi,crossings,critical,convergence,grids,surface,boundaries}.py": [
        "tests/runtime/test_critical.py",
        "tests/runtime/test_maps.py",
    ],
    "freebeam_sym/stability/{general,derivatives,pulse}.py": [
        "tests/runtime/test_general.py",
        "tests/runtime/test_gradient.py",
        "tests/runtime/test_pulse.py",
        "tests/runtime/test_any_column.py",
    ],
    "derive/freebeam_derive/{bases,emit}/*.py": [
        "tests/derive/test_kernel.py",
        "tests/derive/test_emit.py",
        "tests/derive/test_legendre.py",
        "tests/derive/test_pipeline.py",
        "tests/derive/test_segments.py",
    ],
}
"""What is changed, and the tests that should see it, the quickest first."""
ARITHMETIC = ("Add_Sub", "Sub_Add", "Mul_Div", "Div_Mul", "Mul_Add", "Pow_Mul", "FloorDiv_Mul", "Mod_Mul")
COMPARISONS = ("Eq_NotEq", "NotEq_Eq", "Lt_LtE", "LtE_Lt", "Gt_GtE", "GtE_Gt", "Lt_Gt", "Gt_Lt", "LtE_GtE", "GtE_LtE")
OPERATORS = (
    *(f"core/ReplaceBinaryOperator_{name}" for name in ARITHMETIC),
    *(f"core/ReplaceComparisonOperator_{name}" for name in COMPARISONS),
    *(f"core/Replace{name}" for name in ("UnaryOperator_Delete_USub", "UnaryOperator_Delete_Not", "AndWithOr")),
    *(f"core/Replace{name}" for name in ("OrWithAnd", "TrueWithFalse", "FalseWithTrue", "BreakWithContinue")),
    *(f"core/{name}" for name in ("NumberReplacer", "AddNot", "ZeroIterationForLoop")),
)
LIMIT = 900.0
"""Seconds after which tests that do not end have seen the change: a search that no longer stops."""


@dataclass(frozen=True)
class Mutant:
    file: str
    operator: str
    occurrence: int
    tests: tuple[str, ...]


class _Places(Visitor):
    """How often an operator applies in a file."""

    def __init__(self, operator: object) -> None:
        self.operator, self.count = operator, 0

    def visit(self, node: object) -> object:
        self.count += len(list(self.operator.mutation_positions(node)))  # type: ignore[attr-defined]
        return node


def files(pattern: str) -> list[Path]:
    """Files of a pattern that may hold {one,another} of names."""
    if "{" in pattern:
        head, rest = pattern.split("{")
        names, tail = rest.split("}")
        return [file for name in names.split(",") for file in files(head + name + tail)]
    return sorted(ROOT.glob(pattern))


def mutants() -> list[Mutant]:
    """All there are."""
    found = []
    for pattern, tests in PARTS.items():
        for file in files(pattern):
            tree = get_ast(file.read_text(encoding="utf-8"))
            for name in OPERATORS:
                places = _Places(get_operator(name)())
                places.walk(tree)
                here = str(file.relative_to(ROOT))
                every = 2 if name.endswith("NumberReplacer") else 1  # of n + 1 and n − 1 the first
                found += [Mutant(here, name, k, tuple(tests)) for k in range(0, places.count, every)]
    return found


def survives(mutant: Mutant, copies: Queue[Path]) -> tuple[bool, str, float]:
    """Whether no test fails, the change, and the seconds it took."""
    copy = copies.get()
    try:
        file = copy / mutant.file
        before = file.read_text(encoding="utf-8")
        after = mutate_code(before, get_operator(mutant.operator)(), mutant.occurrence)
        change = "\n".join(unified_diff(before.split("\n"), after.split("\n"), lineterm="", n=1))
        file.write_text(after, encoding="utf-8")
        start = time.monotonic()
        command = [sys.executable, "-m", "pytest", "-q", "-x", "-p", "no:cacheprovider", "--no-header", *mutant.tests]
        settings = {**os.environ, "OMP_NUM_THREADS": "1", "PYTHONDONTWRITEBYTECODE": "1"}
        try:
            done = subprocess.run(command, cwd=copy, env=settings, capture_output=True, timeout=LIMIT, check=False)
            alive = done.returncode == 0
        except subprocess.TimeoutExpired:
            alive = False
        file.write_text(before, encoding="utf-8")
        return alive, change, time.monotonic() - start
    finally:
        copies.put(copy)


def main(count: int = 300, seed: int = 1, jobs: int = 2) -> int:
    chosen = random.Random(seed).sample(mutants(), count)
    listed = subprocess.run(["git", "ls-files"], cwd=ROOT, capture_output=True, text=True, check=True).stdout.split(
        "\n"
    )
    with tempfile.TemporaryDirectory() as folder:
        copies: Queue[Path] = Queue()
        for number in range(jobs):
            copy = Path(folder) / str(number)
            for name in filter(None, listed):
                (copy / name).parent.mkdir(parents=True, exist_ok=True)
                shutil.copy2(ROOT / name, copy / name)
            copies.put(copy)
        alive: list[dict[str, object]] = []
        with ThreadPoolExecutor(jobs) as pool:
            for number, (mutant, (left, change, seconds)) in enumerate(
                zip(chosen, pool.map(lambda mutant: survives(mutant, copies), chosen), strict=True), 1
            ):
                if left:
                    alive.append({"file": mutant.file, "operator": mutant.operator, "change": change})
                state = "survives" if left else "killed"
                print(f"{number}/{count} {state} {seconds:5.1f} s  {mutant.file}  {mutant.operator}", flush=True)
                if left:
                    print(change, flush=True)
    (ROOT / "build").mkdir(exist_ok=True)
    record = {"count": count, "seed": seed, "killed": count - len(alive), "survivors": alive}
    (ROOT / "build" / "mutants.json").write_text(json.dumps(record, indent=1, ensure_ascii=False), encoding="utf-8")
    print(f"{count - len(alive)} of {count} killed, seed {seed}; survivors in build/mutants.json")
    return 0 if count - len(alive) >= 0.9 * count else 1


if __name__ == "__main__":
    sys.exit(main(*map(int, sys.argv[1:])))
