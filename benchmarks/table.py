"""Run the benchmarks and print one table: time, ratio to the first of the group, promise kept or not, accuracy.

python benchmarks/table.py [pytest arguments]     without arguments writes docs/benchmarks.md and docs/growth.svg too
"""

from __future__ import annotations

import json
import os
import platform
import subprocess
import sys
import tempfile
import time
from datetime import UTC, datetime
from importlib.metadata import PackageNotFoundError, version
from itertools import groupby
from pathlib import Path
from typing import Any

import numpy as np

from freebeam.figures.look import INK, MUTED, figure, style
from freebeam.figures.saving import image_of

ROOT = Path(__file__).resolve().parent.parent
PAGE, PICTURE = "benchmarks.md", "growth.svg"
PACKAGES = (
    "numpy", "scipy", "sympy", "mpmath", "python-flint", "numba", "scikit-fem", "xarray", "dask", "distributed", "zarr",
    "playwright", "pytest-benchmark",
)  # fmt: skip
AGAIN, PAUSE = 5, 60
"""Times that what missed its promise is measured again, and seconds to wait before."""
OF = "cost in N of "
"""How the heading of a group begins whose rows, by their number of modes, make a curve of the picture."""


def measured(arguments: list[str]) -> list[dict[str, Any]]:
    """Results of pytest-benchmark, in the order of the files."""
    with tempfile.TemporaryDirectory() as folder:
        target = Path(folder) / "results.json"
        command = [
            sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "-p", "no:xdist", "--benchmark-only",
            "-o", "python_files=bench_*.py", "-o", "python_functions=bench_*", "-o", "testpaths=benchmarks",
            f"--benchmark-json={target}", "--benchmark-disable-gc",
            *(arguments or map(str, sorted((ROOT / "benchmarks").glob("bench_*.py")))),
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


def least(result: dict[str, Any]) -> float:
    """Seconds of the quickest round, or what a benchmark has made of its rounds itself."""
    return float(result["extra_info"].get("seconds") or result["stats"]["min"])


def missed(result: dict[str, Any]) -> bool:
    """Whether it took longer than promised."""
    bound = result["extra_info"].get("bound")
    return bound is not None and least(result) > bound


def once_more(results: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """The results with those that missed their promise measured again, of which the quicker ones stand."""
    again = [r["fullname"] for r in results if missed(r)]
    if not again:
        return results
    time.sleep(PAUSE)
    found = {r["fullname"]: r for r in measured(again)}
    return [min(r, found.get(r["fullname"], r), key=least) for r in results]


def table(results: list[dict[str, Any]]) -> tuple[str, bool]:
    """The table in Markdown, and whether every promise was kept."""
    lines, kept = [], True
    ordered = sorted(results, key=lambda r: r["group"])
    for claim, members in groupby(ordered, key=lambda r: r["group"]):
        lines += [
            f"\n## {claim[0].upper()}{claim[1:]}\n",
            "| | least | median | against ours | promised | accuracy |",
            "|---|---|---|---|---|---|",
        ]
        rows = list(members)
        first = least(rows[0])
        for r in rows:
            info, seconds = r["extra_info"], least(r)
            bound = info.get("bound")
            kept &= not missed(r)
            promise = "" if bound is None else f"{duration(bound)}: {'MISSED' if missed(r) else 'kept'}"
            median = duration(float(r["stats"]["median"])) if r["stats"]["rounds"] > 1 else ""
            lines.append(
                f"| {info['name']} | {duration(seconds)} | {median} | {seconds / first:.3g} | {promise} "
                f"| {info['error']} |"
            )
    return "\n".join(lines) + "\n", kept


# --- growth with N -----------------------------------------------------------------------------------------------


def curves(results: list[dict[str, Any]]) -> dict[str, tuple[Any, Any]]:
    """N and the least seconds of each thing whose cost in N was measured, in the order of N."""
    found: dict[str, list[tuple[int, float]]] = {}
    for r in results:
        if r["group"].startswith(OF) and "modes" in r["extra_info"]:
            points = found.setdefault(r["group"].removeprefix(OF), [])
            points.append((int(r["extra_info"]["modes"]), float(r["extra_info"]["seconds"])))
    sets = {what: np.array(sorted(points)).T for what, points in found.items()}
    return {what: (modes, seconds) for what, (modes, seconds) in sets.items()}


def slope(modes: Any, seconds: Any) -> float:
    """The exponent of N: of the straight line through the logarithms that is nearest."""
    return float(np.polyfit(np.log(modes), np.log(seconds), 1)[0])


def picture(found: dict[str, tuple[Any, Any]]) -> bytes:
    """Seconds over N, a curve a kind, each with N³ through its first point."""
    with style():
        drawn = figure((6.4, 3.9))
        ax = drawn.subplots()
        for marker, (what, (modes, seconds)) in zip("os^D", found.items(), strict=False):
            ax.loglog(modes, seconds, marker=marker, markersize=5, zorder=3)
            ax.loglog(modes, seconds[0] * (modes / modes[0]) ** 3, color=MUTED, linewidth=1.0, linestyle=(0, (4, 3)))
            ax.annotate("$N^3$", (modes[-1], seconds[0] * (modes[-1] / modes[0]) ** 3), (5, 0), color=MUTED,
                        textcoords="offset points", va="center")  # fmt: skip
            ax.annotate(f"{what}:\n$N^{{{slope(modes, seconds):.2f}}}$ measured", (modes[-1], seconds[-1]), (9, 0),
                        color=INK, textcoords="offset points", va="center")  # fmt: skip
        every = sorted({int(n) for modes, _ in found.values() for n in modes})
        ax.set_xticks(every, [str(n) for n in every])
        ax.minorticks_off()
        ax.set_xlim(every[0] / 1.15, every[-1] * 3.2)
        ax.set_xlabel("number of modes N", color=INK)
        ax.set_ylabel("seconds, least of the rounds", color=INK)
        ax.set_title("What more modes cost")
        return image_of(drawn, "svg", "What more modes cost")


def caption(found: dict[str, tuple[Any, Any]]) -> str:
    """The picture in the page, and in words."""
    said = [
        f"{what} N^{slope(modes, seconds):.2f} from N = {modes[0]:.0f} to {modes[-1]:.0f}"
        for what, (modes, seconds) in found.items()
    ]
    words = f"seconds over the number of modes, both logarithmic, with N³ through each first point: {'; '.join(said)}"
    return f"\n![{words[0].upper()}{words[1:]}]({PICTURE})\n"


# --- the page ----------------------------------------------------------------------------------------------------


def machine() -> str:
    """Processor, cores and memory, as far as the system says."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        lines = []
    models = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    said = [models[0] if models else platform.processor() or "processor unknown", platform.machine()]
    said.append(f"{os.cpu_count()} cores")
    try:
        said.append(f"{os.sysconf('SC_PAGE_SIZE') * os.sysconf('SC_PHYS_PAGES') / 2**30:.0f} GiB of memory")
    except (AttributeError, ValueError, OSError):  # not on every system
        pass
    return f"{', '.join(said)}; {platform.system()}"


def installed() -> str:
    """Python and the packages measured, ours and the peers', with their versions."""
    found = [f"Python {platform.python_version()}"]
    for name in PACKAGES:
        try:
            found.append(f"{name} {version(name)}")
        except PackageNotFoundError:
            continue
    return ", ".join(found)


def page(results: list[dict[str, Any]], text: str) -> str:
    """The whole page; the picture of the growth with N before the tables, where there is one."""
    found = curves(results)
    return (
        "# Benchmarks\n\nOne run on one core, `OMP_NUM_THREADS=1`. The least time of the rounds is what the work "
        "takes, the median tells what else the machine did; ratios and promises go by the least. What missed its "
        f"promise is measured again when all is done, {AGAIN} times at most, minutes apart: a machine that is "
        "shared may change its speed by a factor of two meanwhile. `make bench` makes this page again.\n\n"
        f"Measured on {datetime.now(UTC).date().isoformat()}: {machine()}.\n\n{installed()}.\n"
        f"{caption(found) if found else ''}{text}"
    )


def publish(folder: Path, results: list[dict[str, Any]], text: str) -> None:
    """Page and picture, both or neither: each is made and written beside before the first takes its place."""
    found = curves(results)
    files = {PICTURE: picture(found)} if found else {}
    files[PAGE] = page(results, text).encode()
    beside = {name: folder / f"{name}.new" for name in files}
    try:
        for name, content in files.items():
            beside[name].write_bytes(content)
        for name, path in beside.items():
            os.replace(path, folder / name)
    finally:
        for path in beside.values():
            path.unlink(missing_ok=True)


def main() -> int:
    results = measured(sys.argv[1:])
    for _ in range(AGAIN):
        results = once_more(results)
    text, kept = table(results)
    print(text)
    if not sys.argv[1:]:
        publish(ROOT / "docs", results, text)
    return 0 if kept else 1


if __name__ == "__main__":
    sys.exit(main())
