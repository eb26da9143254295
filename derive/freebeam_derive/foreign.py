"""Kernels in C and JavaScript as modules with the functions of the NumPy one, so that verify.py measures them alike.

C is compiled by `cc` and called through ctypes; JavaScript runs in node, or in a headless Chromium where there is none.
What these languages do not have, exact fractions, is left out.
"""

from __future__ import annotations

import ctypes
import json
import re
import shutil
import subprocess
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from freebeam_derive.independent import VerificationError
from freebeam_derive.kernel import BeamKernel, Kernel
from freebeam_derive.statement import StatementError

Array = NDArray[np.float64]
COMPILE = ("cc", "-std=c99", "-O2", "-fPIC", "-shared")
"""What compiles a kernel's source into a library: these, the file, `-o` and a name, `-lm`."""
BROWSERS = ("chromium", "chromium-browser", "google-chrome")


class Runner(Protocol):
    """Runs a kernel's functions."""

    def make(self, N: int) -> Any:
        """A basis, with its fields as attributes."""

    def call(self, function: str, arguments: list[Any], sizes: list[int]) -> list[Array]:
        """What a function fills: arrays of these sizes. A number is an array of none: sizes are empty."""


@contextmanager
def loaded(texts: dict[str, str], language: str, kernel: Kernel) -> Iterator[ModuleType]:
    """The module that emitted texts make, by their files' names, for as long as it is used.

    Raises StatementError where nothing on this machine runs the language, VerificationError where it does not compile.
    """
    name = next(iter(texts)).rpartition(".")[0]
    runner = _c if language == "c" else _javascript
    with tempfile.TemporaryDirectory(prefix="freebeam-") as folder:
        for file, text in texts.items():
            (Path(folder) / file).write_text(text, encoding="utf-8")
        with runner(Path(folder), name) as running:
            module = _Beam(running, kernel) if isinstance(kernel, BeamKernel) else _Segments(running, kernel)
            yield module  # type: ignore[misc]


def missing(language: str) -> str:
    """What this machine lacks to run kernels in a language; empty where it lacks nothing."""
    if language == "c":
        return "" if shutil.which(COMPILE[0]) else "no C compiler: there is no cc on the path"
    if language == "javascript":
        return "" if shutil.which("node") or _browser() else "nothing runs JavaScript: there is no node on the path"
    return ""


# --- C ------------------------------------------------------------------------------------------------------


class Places:
    """Places along the beam, which C takes with their count."""

    def __init__(self, x: ArrayLike) -> None:
        self.x = np.ascontiguousarray(np.reshape(x, -1), dtype=float)


_TYPES = {
    "int ": ctypes.c_int,
    "double ": ctypes.c_double,
    "double *": ctypes.POINTER(ctypes.c_double),
    "int *": ctypes.POINTER(ctypes.c_int),
}


class _C:
    def __init__(self, library: Path, header: str, name: str) -> None:
        self.library, self.name = ctypes.CDLL(str(library)), name
        self.telling = set(re.findall(rf"^int {name}_(\w+)\(", header, re.MULTILINE))  # whether they succeed
        self.types = {kind: _structure(header, f"{name}_{kind}") for kind in ("basis", "parameters")}

    def make(self, N: int) -> Any:
        basis = self.types["basis"]()
        count = getattr(self.library, f"{self.name}_bytes")
        count.restype = ctypes.c_size_t
        basis.memory = np.empty(count(N) // 8 + 1)
        if getattr(self.library, f"{self.name}_make")(
            ctypes.byref(basis), N, ctypes.c_void_p(basis.memory.ctypes.data)
        ):
            raise ValueError(f"N = {N}: is too small")
        return basis

    def call(self, function: str, arguments: list[Any], sizes: list[int]) -> list[Array]:
        # what lies behind each result must stay as it is: nothing is written beyond an array's end
        results = [np.append(np.full(size, np.nan), 0.1234567) for size in sizes]
        found = getattr(self.library, f"{self.name}_{function}")
        found.restype = ctypes.c_int if sizes else ctypes.c_double
        passed = [given for argument in (*arguments, *results) for given in self._passed(argument)]
        status = found(*passed)
        if not sizes:
            return [np.array([status])]
        if function in self.telling and status:
            raise VerificationError(f"{function}: returns {status}")
        if any(result[-1] != 0.1234567 for result in results):
            raise VerificationError(f"{function}: writes beyond the end of its result")
        return [result[:-1] for result in results]

    def _passed(self, argument: Any) -> Iterator[Any]:
        if isinstance(argument, Places):
            yield from (len(argument.x), *self._passed(argument.x))
        elif isinstance(argument, np.ndarray):
            yield argument.ctypes.data_as(ctypes.POINTER(ctypes.c_double))
        elif isinstance(argument, dict):
            if self.types["parameters"] is not None:
                yield ctypes.byref(self.types["parameters"](**argument))
        elif isinstance(argument, ctypes.Structure):
            yield ctypes.byref(argument)
        else:
            yield ctypes.c_double(argument) if isinstance(argument, float) else ctypes.c_int(argument)


def _structure(header: str, name: str) -> Any:
    """The structure of a name, as a header declares it; None where there is none."""
    found = re.search(r"typedef struct \{([^{}]*)\} " + name + ";", header)
    if found is None:
        return None
    fields = re.findall(r"^ +(double \*|int \*|double |int )(\w+);", found[1], re.MULTILINE)
    return type(name, (ctypes.Structure,), {"_fields_": [(field, _TYPES[kind]) for kind, field in fields]})


@contextmanager
def _c(folder: Path, name: str) -> Iterator[Runner]:
    if lacking := missing("c"):
        raise StatementError(f"{lacking}; nothing is written that was not verified")
    library = folder / f"{name}.so"
    command = [*COMPILE, str(folder / f"{name}.c"), "-o", str(library), "-lm"]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode:
        raise VerificationError(f"{name}.c: does not compile: {done.stderr.strip().splitlines()[0]}")
    yield _C(library, (folder / f"{name}.h").read_text(encoding="utf-8"), name)


# --- JavaScript ---------------------------------------------------------------------------------------------

_ANSWER = """
const bases = [];
const plain = (value) => Number.isFinite(value) ? value : String(value);
const listed = (values) => Array.from(values, plain);
function answer([what, name, given]) {
  if (what === "make") {
    const basis = kernel.basis(given);
    bases.push(basis);
    return Object.entries(basis).map(([key, value]) => [key, typeof value === "number" ? plain(value) : listed(value)]);
  }
  const found = kernel[name](...given.map((one) => one?.basis === undefined ? one : bases[one.basis]));
  if (typeof found === "number") return [[plain(found)]];
  return Array.isArray(found) ? found.map(listed) : [listed(found)];
}
"""
_NODE = """
import { createInterface } from "node:readline";
for await (const line of createInterface({ input: process.stdin })) {
  let said;
  try { said = answer(JSON.parse(line)); } catch (error) { said = { error: String(error) }; }
  process.stdout.write(JSON.stringify(said) + "\\n");
}
"""
_TRY = "(request) => { try { return answer(request); } catch (error) { return { error: String(error) }; } }"
_PAGE = """async (text) => {
  globalThis.kernel = await import(URL.createObjectURL(new Blob([text], { type: "text/javascript" })));
}"""


class _JavaScript:
    def __init__(self, ask: Callable[[Any], Any]) -> None:
        self.ask, self.count = ask, 0

    def make(self, N: int) -> Any:
        fields = {key: np.array(value, dtype=float) for key, value in self._asked(["make", "", N])}
        self.count += 1
        return SimpleNamespace(**fields, handle={"basis": self.count - 1})

    def call(self, function: str, arguments: list[Any], sizes: list[int]) -> list[Array]:
        return [
            np.array(found, dtype=float) for found in self._asked(["call", function, [*map(self._passed, arguments)]])
        ]

    def _passed(self, argument: Any) -> Any:
        if isinstance(argument, Places):
            return argument.x.tolist()
        if isinstance(argument, np.ndarray):
            return argument.tolist()
        return argument.handle if isinstance(argument, SimpleNamespace) else argument

    def _asked(self, request: list[Any]) -> Any:
        found = self.ask(request)
        if isinstance(found, dict):
            raise VerificationError(f"{request[1] or request[0]}: {found['error']}")
        return found


@contextmanager
def _javascript(folder: Path, name: str) -> Iterator[Runner]:
    if lacking := missing("javascript"):
        raise StatementError(f"{lacking}; nothing is written that was not verified")
    if not (node := shutil.which("node")):
        with _in_browser((folder / f"{name}.mjs").read_text(encoding="utf-8")) as ask:
            yield _JavaScript(ask)
        return
    driver = folder / "driver.mjs"
    driver.write_text(f'import * as kernel from "./{name}.mjs";\n{_ANSWER}{_NODE}', encoding="utf-8")
    with subprocess.Popen([node, str(driver)], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdin is not None and process.stdout is not None
        writing, reading = process.stdin, process.stdout

        def ask(request: Any) -> Any:
            writing.write(json.dumps(request) + "\n")
            writing.flush()
            line = reading.readline()
            if not line:
                raise VerificationError(f"{name}.mjs: node stops at {request[:2]}")
            return json.loads(line)

        yield _JavaScript(ask)
        writing.close()


def _browser() -> str:
    """A Chromium that can be driven; empty where there is none."""
    try:
        import playwright.sync_api  # noqa: F401
    except ImportError:
        return ""
    return next((found for name in BROWSERS if (found := shutil.which(name))), "")


@contextmanager
def _in_browser(text: str) -> Iterator[Callable[[Any], Any]]:
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=_browser(), args=["--no-sandbox"])
        page = browser.new_page()
        page.evaluate(_PAGE, text)
        page.evaluate(f"() => {{ {_ANSWER} globalThis.answer = answer; }}")
        yield lambda request: page.evaluate(
            "(request) => { try { return answer(request); } catch (error) { return { error: String(error) }; } }",
            request,
        )
        browser.close()


# --- as the NumPy modules -----------------------------------------------------------------------------------


class _Any:
    """The functions that the modules of all columns have."""

    def __init__(self, runner: Runner, kernel: Kernel) -> None:
        self.runner, self.in_c = runner, isinstance(runner, _C)
        self.defaults = {p.name: float(p.default) for p in kernel.column.parameters}
        self.sizes = kernel.column.scales
        self.scaled = any(str(s) in self.defaults for size in self.sizes.values() for s in size.free_symbols)

    def _own(self, given: dict[str, float]) -> list[dict[str, float]]:
        return [self.defaults | {k: float(v) for k, v in given.items()}] if self.defaults else []

    def newmark_step(self, *given: Any) -> tuple[Array, ...]:
        *arrays, h, (b, g) = given
        n = len(arrays[0])
        state = [np.ascontiguousarray(a, dtype=float) for a in arrays]
        work = [np.empty(n * (n + 2))] if self.in_c else []
        lists = [a.ravel() for a in state]
        found = self.runner.call("newmark_step", [n, *lists, float(h), float(b), float(g), *work], [n] * 3)
        return tuple(values.reshape(state[3].shape) for values in found)

    def newmark_limit(self, xi: float, newmark: tuple[float, float]) -> float:
        return float(self.runner.call("newmark_limit", [float(xi), *map(float, newmark)], [])[0][0])

    def scales(self, *beam: float, **own: float) -> dict[str, float]:
        given = [*map(float, beam), *(self._own(own) if self.scaled else [])]
        return dict(zip(self.sizes, self.runner.call("scales", given, [len(self.sizes)])[0].tolist(), strict=True))


class _Beam(_Any):
    """Of a beam of one span: `basis`, `shapes`, M, E, H and C, `force` and `frequencies`."""

    def __init__(self, runner: Runner, kernel: BeamKernel) -> None:
        super().__init__(runner, kernel)
        self.rigid = len(kernel.rigid)

    def basis(self, N: int) -> Any:
        basis = self.runner.make(N)
        if not hasattr(basis, "gamma"):
            return basis
        return SimpleNamespace(made=basis, N=N, gamma=np.array(basis.gamma[:N]))

    def _made(self, basis: Any) -> tuple[Any, int]:
        made = getattr(basis, "made", basis)
        return made, int(made.N)

    def shapes(self, basis: Any, x: ArrayLike, derivative: int = 0, rigid: bool = False) -> Array:
        (made, N), places = self._made(basis), Places(x)
        n = N + self.rigid * rigid
        found = self.runner.call("shapes", [made, places, derivative, int(rigid)], [n * len(places.x)])[0]
        return found.reshape(n, *np.shape(x))

    def _matrix(self, function: str, basis: Any, before: list[float], rigid: bool, own: dict[str, float]) -> Array:
        made, N = self._made(basis)
        n = N + self.rigid * rigid
        return self.runner.call(function, [made, *before, int(rigid), *self._own(own)], [n * n])[0].reshape(n, n)

    def mass(self, basis: Any, rigid: bool = False, **own: float) -> Array:
        return self._matrix("mass", basis, [], rigid, own)

    def stiffness_elastic(self, basis: Any, rigid: bool = False, **own: float) -> Array:
        return self._matrix("stiffness_elastic", basis, [], rigid, own)

    def stiffness_load(self, basis: Any, rigid: bool = False, **own: float) -> Array:
        return self._matrix("stiffness_load", basis, [], rigid, own)

    def damping(self, basis: Any, alpha: float, beta: float, rigid: bool = False, **own: float) -> Array:
        return self._matrix("damping", basis, [float(alpha), float(beta)], rigid, own)

    def force(self, basis: Any, x_F: float, rigid: bool = False) -> Array:
        made, N = self._made(basis)
        return self.runner.call("force", [made, float(x_F), int(rigid)], [N + self.rigid * rigid])[0]

    def frequencies(self, gamma: Array, alpha: float = 0.0, beta: float = 0.0, **own: float) -> tuple[Any, Any]:
        N = len(gamma)
        given = [self.runner.make(N), float(alpha), float(beta), *self._own(own)]
        first, second = self.runner.call("frequencies", given, [2 * N, 2 * N])
        return first.view(complex), second.view(complex)


class _Segments(_Any):
    """Of any other column: `basis`, `shapes`, `places`, the terms of M, C and K, `force` and `rigid_motions`."""

    def __init__(self, runner: Runner, kernel: Any) -> None:
        super().__init__(runner, kernel)
        self.system = kernel.system
        self.names = [*(s.name for s in self.system.spaces), *(name for name, _ in self.system.coordinates)]
        self.powers = {letter: len(kernel.forms(letter)) for letter in "MCK"}

    def basis(self, N: int) -> Any:
        made = self.runner.make(N)
        shape = (len(self.names), len(self.system.breaks) - 1, N + 2)
        numbers = np.array(made.numbers[: np.prod(shape)], dtype=int).reshape(shape)
        of_fields = {s.name: numbers[k] for k, s in enumerate(self.system.spaces)}
        coordinates = {name: numbers[self.names.index(name), :, :1] for name, _ in self.system.coordinates}
        return SimpleNamespace(made=made, size=int(made.size), numbers={**of_fields, **coordinates})

    def _terms(self, function: str, letter: str, basis: Any, damping: list[float], own: dict[str, float]) -> Array:
        n, count = basis.size, self.powers[letter]
        found = self.runner.call(function, [basis.made, *damping, *self._own(own)], [count * n * n])[0]
        return found.reshape(count, n, n)

    def mass_terms(self, basis: Any, **own: float) -> Array:
        return self._terms("mass_terms", "M", basis, [], own)

    def rate_terms(self, basis: Any, alpha: float, beta: float, **own: float) -> Array:
        return self._terms("rate_terms", "C", basis, [float(alpha), float(beta)], own)

    def stiffness_terms(self, basis: Any, alpha: float = 0.0, beta: float = 0.0, **own: float) -> Array:
        given = [float(alpha), float(beta)] if self.system.circulatory else []
        return self._terms("stiffness_terms", "K", basis, given, own)

    def at_load(self, basis: Any, terms: Array, P: float) -> Array:
        n = basis.size
        given = [basis.made, len(terms), np.ascontiguousarray(terms).ravel(), float(P)]
        return self.runner.call("at_load", given, [n * n])[0].reshape(n, n)

    def places(self, **own: float) -> Array:
        return self.runner.call("places", self._own(own), [len(self.system.breaks)])[0]

    def shapes(self, basis: Any, x: ArrayLike, field: str, derivative: int = 0, side: int = 0, **own: float) -> Array:
        places = Places(x)
        given = [basis.made, places, self.names.index(field), derivative, side, *self._own(own)]
        found = self.runner.call("shapes", given, [basis.size * len(places.x)])[0]
        return found.reshape(basis.size, *np.shape(x))

    def force(self, basis: Any, x_F: float, **own: float) -> Array:
        return self.runner.call("force", [basis.made, float(x_F), *self._own(own)], [basis.size])[0]

    def rigid_motions(self, basis: Any, **own: float) -> Array:
        count = len(self.system.rigid)
        found = self.runner.call("rigid_motions", [basis.made, *self._own(own)], [count * basis.size])[0]
        return found.reshape(basis.size, count)
