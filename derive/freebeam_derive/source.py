"""Expressions as source: the printer, lines, docstrings and literals of readable length, and what modules have alike.

Emitted functions take arrays of any library that follows the Python array API: `xp` is its namespace. A column's own
parameters may be arrays too; what is a maximum, a minimum or piecewise in them takes numbers only.
"""

from __future__ import annotations

import re
import textwrap
from collections.abc import Iterable
from itertools import pairwise
from typing import Any

from sympy import Expr, Inverse, MatMul, Piecewise, S, Symbol, cse, numbered_symbols
from sympy.printing.pycode import PythonCodePrinter

from freebeam_derive.kernel import Kernel, MatrixProgram, SeriesProgram
from freebeam_derive.latex import letter
from freebeam_derive.notation import NOTATION
from freebeam_derive.statement import StatementError

INDENT = "    "
WIDTH = 110
_EXACT = (2, 4, 8, 16, 32, 64)  # denominators that a float holds exactly
_FUNCTIONS = {  # SymPy's name and the array API's
    **{name: name for name in ("exp", "log", "sin", "cos", "tan", "sinh", "cosh", "tanh", "sign", "floor")},
    **{f"a{name}": f"a{name}" for name in ("sin", "cos", "tan", "sinh", "cosh", "tanh")},
    "Abs": "abs",
    "ceiling": "ceil",
}
OWN = "own"  # namespace of functions of a column's own parameters: the module's, such as `_sqrt`


class _Printer(PythonCodePrinter):  # type: ignore[misc]
    """SymPy to Python on arrays of modes (f), of pairs of modes (f_i a column, f_j a row) and matrices."""

    def __init__(self, namespace: str) -> None:
        super().__init__({"fully_qualified_modules": False, "allow_unknown_functions": True})
        self.prefix = "_" if namespace == OWN else f"{namespace}."

    def _print_Function(self, e: Expr) -> str:
        if type(e).__name__ not in _FUNCTIONS:
            raise StatementError(
                f"the function {e.func} in {e} is none that kernels have; write it in terms of "
                f"{', '.join(sorted({*_FUNCTIONS, 'sqrt'}))}, Min, Max and Piecewise, or make {e} a parameter"
            )
        return f"{self.prefix}{_FUNCTIONS[type(e).__name__]}({self._print(e.args[0])})"

    def _print_Rational(self, e: Expr) -> str:
        return repr(float(e)) if e.q in _EXACT else f"{e.p} / {e.q}"

    def _print_Mul(self, e: Expr) -> str:
        below = [f for f in e.args if f.is_Pow and f.exp.is_Rational and f.exp.is_negative]
        if len(below) == 1 and below[0].exp.is_Integer and below[0].exp < -2 and below[0].exp % 2:
            # several factors below the stroke get brackets; one that is printed as a product does not
            return str(self._print(e.xreplace({below[0]: 1 / Symbol(f"({self._print(1 / below[0])})")})))
        number, rest = e.as_coeff_Mul()
        if number.is_Rational and number.q not in (1, *_EXACT):
            # division rounds once, and is exact in exact numbers
            return f"{self.parenthesize(number.p * rest, 50)} / {number.q}"
        return str(super()._print_Mul(e))

    def parenthesize(self, item: Expr, level: int, strict: bool = False) -> str:
        if item.is_Rational and item >= 0 and item.q in _EXACT:
            return str(self._print(item))
        return str(super().parenthesize(item, level, strict))

    def _print_Piecewise(self, e: Piecewise) -> str:
        text = str(self._print(e.args[-1][0]))
        for value, condition in reversed(e.args[:-1]):
            text = f"{self._print(value)} if {self._print(condition)} else {text}"
        return text

    def _print_Infinity(self, e: Expr) -> str:
        return "np.inf"

    def _print_Pi(self, e: Expr) -> str:
        return "np.pi"

    def _print_Symbol(self, e: Symbol) -> str:
        name = str(e.name)
        if name.endswith("_i"):
            return f"{name[:-2]}[:, None]"
        return name[:-2] if name.endswith("_j") else name

    def _print_Pow(self, e: Expr, rational: bool = False) -> str:
        base, power = e.as_base_exp()
        if power == S.Half:
            return f"{self.prefix}sqrt({self._print(base)})"
        if power.is_Integer and power > 2:
            # products of squares: NumPy's general power is slow and less exact
            half = self.parenthesize(e.func(base, power // 2), 60) if power > 3 else None
            printed = self.parenthesize(base, 60)
            if half is None:
                return f"{printed} * {printed} * {printed}"
            return f"{half}**2" + (f" * {printed}" if power % 2 else "")
        return str(super()._print_Pow(e, rational=rational))

    def _print_MatrixSymbol(self, e: Expr) -> str:
        return str(e.name)

    def _print_MatMul(self, e: MatMul) -> str:
        scalar, matrices = e.as_coeff_matrices()
        if isinstance(matrices[0], Inverse):
            # one linear solve, never an inverse formed
            left, right = matrices[0].arg, MatMul(*matrices[1:]).doit()
            product = f"{self.prefix}linalg.solve({self._print(left)}, {self._print(right)})"
        else:
            product = " @ ".join(self.parenthesize(m, 50) for m in matrices)
        if scalar == 1:
            return product
        if scalar == -1:
            return f"-{product}" if len(matrices) == 1 else f"-({product})"
        factor = self.parenthesize(scalar, 50)
        return f"{factor} * {product}" if len(matrices) == 1 else f"{factor} * ({product})"

    def _print_MatAdd(self, e: Expr) -> str:
        text = ""
        for term in e.args:
            printed = self._print(term)
            text += f" - {printed[1:]}" if text and printed.startswith("-") else f" + {printed}" if text else printed
        return text


for _name in {*PythonCodePrinter._kf, "sign"} - {"Min", "Max"}:  # none of Python's own `math`
    setattr(_Printer, f"_print_{_name}", _Printer._print_Function)


def code(expression: Expr, namespace: str = OWN) -> str:
    """An expression as source. Raises StatementError for a function that kernels do not have."""
    text = str(_Printer(namespace).doprint(expression))
    return re.sub(r" *(?<!\*)([*/])(?!\*) *", r" \1 ", text)


def shared(assignments: list[tuple[str, Expr]]) -> list[str]:
    """Assignments with their common parts computed once."""
    shared, reduced = cse([e for _, e in assignments], symbols=numbered_symbols("shared_", start=1), order="canonical")
    named = [*((str(s), e) for s, e in shared), *((name, e) for (name, _), e in zip(assignments, reduced, strict=True))]
    return [f"{name} = {code(e)}" for name, e in named]


def literal(value: Any, indent: int = 0) -> str:
    """A constant as source text, with double quotes, a line an entry where it is long."""
    if isinstance(value, str) and len(value) + indent > 90 and indent:
        pieces = textwrap.wrap(value, 90 - indent, drop_whitespace=False, break_on_hyphens=False)
        inner = "".join(f"{' ' * (indent + 4)}{literal(piece)}\n" for piece in pieces)
        return f"(\n{inner}{' ' * indent})"
    if isinstance(value, str):
        return '"' + value.replace("\\", "\\\\").replace('"', '\\"') + '"'
    if isinstance(value, dict | list | tuple):
        opening, closing = {dict: ("{", "}"), list: ("[", "]"), tuple: ("(", ")")}[type(value)]
        items = (
            [f"{literal(k)}: {literal(v, indent + 4)}" for k, v in value.items()]
            if isinstance(value, dict)
            else [literal(v, indent + 4) for v in value]
        )
        flat = opening + ", ".join(items) + ("," if isinstance(value, tuple) and len(items) == 1 else "") + closing
        if len(flat) + indent < 80 and "\n" not in flat:
            return flat
        inner = "".join(f"{' ' * (indent + 4)}{item},\n" for item in items)
        return f"{opening}\n{inner}{' ' * indent}{closing}"
    return repr(value)


def body(lines: Iterable[str]) -> str:
    """Statements of a function, each in lines that fit."""
    return "".join(f"{INDENT}{part}\n" for line in lines for part in _wrapped(line))


def signature(name: str, arguments: str, returns: str) -> str:
    """The first line of a function, or lines where it is long."""
    flat = f"def {name}({arguments}) -> {returns}:\n"
    if len(flat) <= WIDTH:
        return flat
    return f"def {name}(\n" + "".join(f"{part}\n" for part in _folded(f"{arguments},", 4)) + f") -> {returns}:\n"


def _wrapped(line: str) -> list[str]:
    """A statement, in brackets over several lines where it is too long for one."""
    indent = len(line) - len(line.lstrip())
    if len(line) + len(INDENT) <= WIDTH:
        return [line]
    name, equals, expression = line.partition(" = ")
    if not equals and line.lstrip().startswith("return "):
        name, equals, expression = line.partition("return ")
    if not equals:
        return _folded(line.lstrip(), indent)  # an entry of what is in brackets already
    return [f"{name}{equals}(", *_folded(expression, indent + 4), f"{' ' * indent})"]


def _folded(text: str, indent: int) -> list[str]:
    """What stands in brackets, broken at its outermost commas, conditions, sums, products, or else its own brackets."""
    if indent + len(text) + len(INDENT) <= WIDTH:
        return [f"{' ' * indent}{text}"]
    for marks in ((", ",), (" if ", " else "), (" + ", " - "), (" * ", " / ")):
        pieces = _split(text, marks)
        if len(pieces) > 1:
            pieces = _packed(pieces, WIDTH - len(INDENT) - indent) if marks == (", ",) else pieces
            return [line for piece in pieces for line in _folded(piece, indent)]
    groups = _groups(text)
    if not groups:
        return [f"{' ' * indent}{text}"]
    start, end = max(groups, key=lambda group: group[1] - group[0])
    head, tail = f"{' ' * indent}{text[: start + 1]}", f"{' ' * indent}{text[end:]}"
    return [head, *_folded(text[start + 1 : end], indent + 4), tail]


def _packed(pieces: list[str], width: int) -> list[str]:
    """As many pieces to a line as fit."""
    lines = pieces[:1]
    for piece in pieces[1:]:
        if len(lines[-1]) + 1 + len(piece) <= width:
            lines[-1] += f" {piece}"
        else:
            lines.append(piece)
    return lines


def _groups(text: str) -> list[tuple[int, int]]:
    """Where the outermost pairs of brackets open and close."""
    found, depth, start = [], 0, 0
    for n, sign in enumerate(text):
        if sign in "([{":
            start, depth = (start if depth else n), depth + 1
        elif sign in ")]}":
            depth -= 1
            if not depth:
                found.append((start, n))
    return found


def _split(text: str, marks: tuple[str, ...]) -> list[str]:
    """Pieces between marks outside brackets; a comma stays with the piece before it, another mark begins one."""
    inside = {n for start, end in _groups(text) for n in range(start, end)}
    places = [n for n in range(1, len(text)) if n not in inside and text.startswith(marks, n)]
    cuts = [0, *(n + 1 for n in places), len(text)]
    return [text[a:b].strip() for a, b in pairwise(cuts)]


def docstring(text: str, indent: str = INDENT) -> str:
    text = text.replace("\\", "\\\\").replace('"""', '\\"\\"\\"')  # what a user wrote stays as it was
    paragraphs = [
        textwrap.fill(line, WIDTH - len(indent), subsequent_indent=" " * (len(line) - len(line.lstrip())))
        for line in text.strip().split("\n")
    ]
    body = "\n".join(paragraphs)
    if "\n" not in body and len(body) + len(indent) + 6 <= WIDTH:
        return f'{indent}"""{body}"""\n'
    return textwrap.indent(f'"""{body}\n"""', indent, lambda line: bool(line.strip())) + "\n"


# --- what every module has alike ---------------------------------------------------------------------------


def header(kernel: Kernel, functions: str, more: str) -> str:
    column = kernel.column
    letters = "\n".join(f"    {m.letter}[i, j] = {m.text}" for m in kernel.matrices)
    source = f"Source: {column.source}.\n\n" if column.source else ""
    text = (
        f"{column.title}: ends {column.ends[0]} and {column.ends[1]}.\n\n"
        f"M q̈ + C q̇ + (E + P H) q = F_0 Q with trial functions that are {functions}, Eqs. (10), (11):\n\n"
        f"{letters}\n    C = {kernel.system.c_M} M + {kernel.system.c_E} E\n\n"
        f"{more} All quantities are nondimensional, Eq. (5).\n\n"
        "The load, the dampings and the column's own parameters may be arrays of shape (..., 1, 1): matrices are then "
        "(..., n, n).\n\n"
        f"{source}Derived from the energies and emitted by `freebeam generate {column.name}`; do not edit."
    )
    return docstring(text, "") + (
        "\nfrom __future__ import annotations\n\nfrom typing import Any, NamedTuple\n\nimport numpy as np\n"
        "from numpy.typing import ArrayLike, NDArray\n\n"
        "Array = NDArray[np.floating[Any]]  # or an array of another library that follows the Python array API\n"
    )


NAMESPACE = '''def _namespace(array: Any) -> Any:
    """NumPy, or the array API's functions of the library that an array is from."""
    if isinstance(array, np.ndarray):
        return np
    if hasattr(array, "__array_namespace__"):
        return array.__array_namespace__()
    library = __import__(type(array).__module__.partition(".")[0])  # PyTorch, whose tensors name no namespace, say
    return library if hasattr(library, "asarray") else np


def _diagonal(values: Any, order: Any) -> Array:
    """The diagonal matrix of values, one for each of some numbers, all different."""
    if isinstance(values, np.ndarray) and values.ndim == 1:
        return np.diag(values)  # faster
    matrix: Array = _namespace(values).where(order[:, None] == order, values, 0 * values)
    return matrix


def _like(x: Any, array: Any) -> Array:
    """x as an array of the library, the numbers and the device of another."""
    if isinstance(array, np.ndarray):
        return np.asarray(x, dtype=array.dtype)
    xp = _namespace(array)
    found: Array = (
        xp.asarray(x, dtype=array.dtype, device=getattr(array, "device", None))
        if _namespace(x) is not xp
        else x.to(array)  # PyTorch
        if hasattr(x, "to")
        else xp.astype(x, array.dtype)
    )
    return found
'''


def own_functions(text: str) -> str:
    """The functions of a column's own parameters that a module calls, each of a number or of any library's arrays."""
    called = sorted(set(re.findall(rf"\b_({'|'.join(sorted({*_FUNCTIONS.values(), 'sqrt'}))})\(", text)))
    heads = (signature(f"_{name}", "value: Any", "Any") for name in called)
    lines = "found = _namespace(value).{}(value)", "return float(found) if isinstance(value, int | float) else found"
    bodies = (body(line.format(name) for line in lines) for name in called)
    return "\n\n".join(map("".join, zip(heads, bodies, strict=True)))


BASIS = "def basis(N: int, xp: Any = np, dtype: Any = None, device: Any = None) -> Basis:\n"
KIND = "dtype=xp.float64 if dtype is None else dtype, device=device"
KIND_DOC = (
    "xp: the array API's functions in whose arrays the basis comes, such as jax.numpy or torch. dtype: its real "
    "numbers, float64 unless told. device: where the arrays are kept, as xp names it."
)


def metadata(kernel: Kernel, names: tuple[str, ...], more: dict[str, str]) -> str:
    column = kernel.column
    own = [
        {
            "name": p.name,
            "latex": letter(p),
            "meaning": p.meaning,
            "default": float(p.default),
            "low": float(p.low),
            "high": float(p.high),
        }
        for p in column.parameters
    ]
    data = {
        "name": column.name,
        "title": column.title,
        **more,
        "default": {"basis": column.basis, "modes": column.modes},
        "ends": column.ends,
        "rigid": len(kernel.rigid),
        "load": "P",
        "damping": list(column.damping),
        "force": bool(kernel.system.forces),
        "parameters": own,
        "forms": {m.letter: m.text for m in kernel.matrices},
        "latex": {name: NOTATION[name].latex for name in names},
        "meaning": {name: NOTATION[name].meaning for name in names},
        "source": column.source,
    }
    return "COLUMN: dict[str, Any] = " + literal(data) + "\n"


def matrix_signature(kernel: Kernel, name: str, arguments: str = "") -> str:
    """Every matrix takes all of the column's own parameters, so that a caller need not know which it depends on."""
    return signature(name, f"basis: Basis{arguments}, rigid: bool = False{own(kernel)}", "Array")


def _own_doc(kernel: Kernel) -> str:
    return "".join(f"\n{p.name}: {p.meaning}." for p in kernel.column.parameters)


def matrix_head(kernel: Kernel, matrix: MatrixProgram | SeriesProgram) -> str:
    """Signature and docstring of a matrix."""
    R = len(kernel.rigid)
    what = {
        "M": "Mass matrix M",
        "E": "Elastic stiffness matrix E of K = E + P H",
        "H": "Load matrix H of K = E + P H",
    }[matrix.letter]
    shape = f"(N, N), or ({R} + N, {R} + N) with the rigid functions first" if R else "(N, N)"
    doc = f"{what}, shape {shape}, nondimensional. {matrix.equation}.\n\n"
    doc += f"{matrix.letter}[i, j] = {matrix.text}\n{_own_doc(kernel)}"
    if matrix.letter == "H":
        doc = (
            doc.rstrip()
            + "\n\nRow i is the test function. The end term is transposed in the paper as printed: docs/errata.md.\n"
            if kernel.column.name == "free-free"
            else doc
        )
    return matrix_signature(kernel, matrix.name) + docstring(doc)


def own(kernel: Kernel, used: set[str] | None = None) -> str:
    """The column's own parameters as keyword arguments."""
    chosen = [p for p in kernel.column.parameters if used is None or p.name in used]
    return (", *" if chosen else "") + "".join(f", {p.name}: float = {float(p.default)!r}" for p in chosen)


def number(e: Expr) -> str:
    return code(e) if not e.is_number else repr(float(e))


def exact(expression: Expr) -> str:
    """Code in which a fraction that no float holds is made from `one`, a number of the caller's kind."""
    kept = (1, *_EXACT)
    return code(expression.replace(lambda e: e.is_Rational and e.q not in kept, lambda e: Symbol("one") * e))
