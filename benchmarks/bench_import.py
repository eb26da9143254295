"""What `import freebeam` and `import freebeam_sym` cost beyond numpy, in fresh processes."""

from __future__ import annotations

import subprocess
import sys
from typing import Any

CODE = "import time, numpy; start = time.perf_counter(); import {}; print(time.perf_counter() - start)"
CLAIM = "an import, beyond numpy's"


def seconds(module: str) -> float:
    code = CODE.format(module)
    times = [
        float(subprocess.run([sys.executable, "-c", code], capture_output=True, check=True).stdout) for _ in range(7)
    ]
    return sorted(times)[3]


def _bench(contender: Any, benchmark: Any, module: str, name: str, bound: float | None) -> None:
    found: list[float] = []
    contender(CLAIM, name, lambda: found.append(seconds(module)), rounds=1)
    benchmark.extra_info.update(seconds=found[0], bound=bound)


def bench_ours(contender: Any, benchmark: Any) -> None:
    _bench(contender, benchmark, "freebeam_sym", "import freebeam_sym", 0.005)


def bench_all_of_ours(contender: Any, benchmark: Any) -> None:
    _bench(contender, benchmark, "freebeam", "import freebeam", 0.020)


def bench_scipy_linalg(contender: Any, benchmark: Any) -> None:
    _bench(contender, benchmark, "scipy.linalg", "import scipy.linalg (not loaded until used)", None)


def bench_scipy_signal(contender: Any, benchmark: Any) -> None:
    _bench(contender, benchmark, "scipy.signal", "import scipy.signal (not loaded until used)", None)
