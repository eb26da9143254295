"""Run the benchmarks and print one table: time, ratio to the first of the group, promise kept or not, accuracy.

python benchmarks/table.py [pytest arguments]     writes docs/benchmarks.md too
"""

from __future__ import annotations

import json
import os
import platform
import subprocess
import sys
import tempfile
from importlib.metadata import version
from itertools import groupby
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parent.parent
TARGET = ROOT / "docs" / "benchmarks.md"
PACKAGES = ("numpy", "scipy", "sympy", "mpmath")


def measured(arguments: list[str]) -> list[dict[str, Any]]:
    """Results of pytest-benchmark, in the order of the files."""
    with tempfile.TemporaryDirectory() as folder:
        target = Path(folder) / "results.json"
        command = [
            sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "-p", "no:xdist", "--benchmark-only",
            "-o", "python_files=bench_*.py", "-o", "python_functions=bench_*", "-o", "testpaths=benchmarks",
            f"--benchmark-json={target}", "--benchmark-disable-gc", *(arguments or ["benchmarks"]),
        ]  # fmt: skip
        environment = {**os.environ, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "MKL_NUM_THREADS": "1"}
        subprocess.run(command, cwd=ROOT, env=environment, check=True, stdout=sys.stderr)
        return list(json.loads(target.read_text())["benchmarks"])


def duration(seconds: float) -> str:
    """Three digits with a unit."""
    for unit, size in (("s", 1.0), ("ms", 1e-3), ("µs", 1e-6), ("ns", 1e-9)):
        if seconds >= size:
            return f"{seconds / size:.3g} {unit}"
    return f"{seconds:.1e} s"


def table(results: list[dict[str, Any]]) -> tuple[str, bool]:
    """The table in Markdown, and whether every promise was kept."""
    lines, kept = [], True
    ordered = sorted(results, key=lambda r: r["group"])
    for claim, members in groupby(ordered, key=lambda r: r["group"]):
        lines += [
            f"\n## {claim[0].upper()}{claim[1:]}\n",
            "| | time | against ours | promised | accuracy |",
            "|---|---|---|---|---|",
        ]
        rows = [(r["extra_info"], float(r["extra_info"].get("seconds") or r["stats"]["median"])) for r in members]
        first = rows[0][1]
        for info, seconds in rows:
            bound = info.get("bound")
            kept &= bound is None or seconds <= bound
            promise = "" if bound is None else f"{duration(bound)}: {'kept' if seconds <= bound else 'MISSED'}"
            lines.append(
                f"| {info['name']} | {duration(seconds)} | {seconds / first:.3g} | {promise} | {info['error']} |"
            )
    return "\n".join(lines) + "\n", kept


def main() -> int:
    text, kept = table(measured(sys.argv[1:]))
    tools = ", ".join(f"{name} {version(name)}" for name in PACKAGES)
    head = (
        "# Benchmarks\n\nMedians of one run on one core, `OMP_NUM_THREADS=1`; `make bench` makes this page again.\n\n"
        f"Python {platform.python_version()}, {tools}; {platform.machine()}, {os.cpu_count()} cores.\n"
    )
    print(text)
    if not sys.argv[1:]:
        beside = TARGET.with_suffix(".new")
        beside.write_text(head + text, encoding="utf-8")
        os.replace(beside, TARGET)
    return 0 if kept else 1


if __name__ == "__main__":
    sys.exit(main())
