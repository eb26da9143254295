"""Kernel graphs written as Python modules: templates for what does not vary, with SymPy's expressions put in.

`module.py.jinja` shows the shape of the module of a beam of one span, the template of a basis fills its blocks;
`segments.py.jinja` is that of any other column, and they share what they include. In all of them source.py prints the
expressions: with the templates it is all that knows NumPy's syntax. Paragraphs of docstrings are filled here, and
Ruff lays out the rest.

The text depends on the graph alone: no timestamp, no path, no hash order. What reads it is the runtime, or anyone
who takes the one file into a code of their own; it imports NumPy and nothing else, and works on the arrays of any
library that follows the Python array API: functions are pure, and their namespace is that of the arrays given.
"""

from __future__ import annotations

import ast
import re
import subprocess
import textwrap
from collections.abc import Iterable
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from sympy import Max, Poly

from freebeam_derive.emit import braces, source
from freebeam_derive.kernel import BeamKernel, Kernel
from freebeam_derive.latex import letter
from freebeam_derive.notation import NOTATION, QUANTITIES, x
from freebeam_derive.statement import GEOMETRIC, Parameter, StatementError, jets
from freebeam_derive.units import UNITS, told

if TYPE_CHECKING:
    from jinja2 import Environment

WIDTH = 120
_WORDS_OF_C = frozenset(
    "auto break case char const continue default do double else enum extern float for goto if inline int long register "
    "restrict return short signed sizeof static struct switch typedef union unsigned void volatile while".split()
)
_LETTERS = ("x", "t", "P", "alpha", "beta", "F_0", "x_F", "y")


def emit(kernel: Kernel) -> str:
    """The NumPy module of a column, as text. Deterministic to the byte for one version of SymPy and one of Ruff.

    Raises StatementError for a parameter whose name the module gives to something else.
    """
    template = _templates().get_template(f"{kernel.basis_name}.py.jinja")
    context = _context(kernel) | (_beam_context(kernel) if isinstance(kernel, BeamKernel) else {}) | kernel.context()
    text = template.render(context, called=())
    if called := source.own_functions(text):
        text = template.render(context, called=called)
    text = _formatted(_filled(text))
    _refuse_names(kernel, text)
    return text


LANGUAGES = ("python", *braces.PRINTERS)


def files(kernel: Kernel, language: str, name: str) -> dict[str, str]:
    """The module of a column in a language: texts by the names of files. Deterministic as `emit` is.

    name: of the module, an identifier, which C's functions begin with.
    language: python, c (C99, a header and a source) or javascript (an ES module). Raises StatementError for another
    one, for a parameter whose name is a word of C, and as `emit` does.
    """
    text = emit(kernel)
    if language == "python":
        return {f"{name}.py": text}
    refuse_language(language)
    column = kernel.column
    own = [parameter.name for parameter in column.parameters]
    if language == "c" and (taken := sorted(_WORDS_OF_C & {*own})):
        raise StatementError(f"parameter {taken[0]!r}: a word of C; choose another name for kernels in C")
    environment = _environment()
    environment.filters |= braces.filters(language, own)
    template = environment.get_template(f"{kernel.basis_name}.braces.jinja")
    context = _context(kernel) | (_beam_context(kernel) if isinstance(kernel, BeamKernel) else {}) | kernel.context()
    context |= {"w": braces.PRINTERS[language].words, "language": language, "name": name}
    headers = {f"{name}.h": True, f"{name}.c": False} if language == "c" else {f"{name}.mjs": False}
    return {file: braces.laid_out(template.render(context, header=header)) for file, header in headers.items()}


def refuse_language(language: str) -> None:
    """Raises StatementError for a language that kernels are not written in."""
    if language not in LANGUAGES:
        raise StatementError(f"language {language!r}: kernels are written in {', '.join(LANGUAGES)}")


@cache
def _templates() -> Environment:
    found = _environment()
    printers = "at code exact literal number plus polynomial quotient scalar shared times value".split()
    found.filters |= {name: getattr(source, name) for name in printers} | {"words": _words}
    return found


def _environment() -> Environment:
    from jinja2 import Environment, FileSystemLoader, StrictUndefined  # here: only emission pays for it

    return Environment(
        loader=FileSystemLoader(Path(__file__).parent), undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True
    )


def _context(kernel: Kernel) -> dict[str, Any]:
    """What every module is filled with."""
    column, newmark = kernel.column, kernel.newmark
    own, held = _typed(column.parameters), set().union(*(size.free_symbols for size in column.scales.values()))
    sizing = [p for p in column.parameters if p.symbol in held]
    limit = newmark.inverse_limit.args if isinstance(newmark.inverse_limit, Max) else (newmark.inverse_limit,)
    return {
        "kernel": kernel,
        "column": column,
        "newmark": newmark,
        "bounds_of_limit": [bound for bound in limit if not bound.is_number],
        "own": f", *{own}" if own else "",
        "own_any": f", *{own}".replace(": float = ", ": Any = ") if own else "",
        "passed": "".join(f", {p.name}={p.name}" for p in column.parameters),
        "scales": column.scales,
        "units": UNITS
        | {name: q.unit or "none: nothing says what the load is" for name, q in column.quantities.items()},
        "scaling": f", *{_typed(sizing)}" if sizing else "",
    }


def _typed(parameters: Iterable[Parameter]) -> str:
    return "".join(f", {p.name}: float = {float(p.default)!r}" for p in parameters)


def _beam_context(kernel: BeamKernel) -> dict[str, Any]:
    """What the module of a beam of one span is filled with beside."""
    return {
        "R": len(kernel.rigid),
        "system": kernel.system,
        "facts": _facts(kernel),
        "forms": {m.letter: _form(getattr(kernel.system, m.letter)) for m in kernel.matrices},
        "equation_of_motion": {
            (int(j.args[1]), int(j.args[2])): tuple(Poly(kernel.motion.strong.coeff(j), x).all_coeffs()[::-1])
            for j in jets(kernel.motion.strong)
        },
        "conditions": tuple(_conditions(kernel, end) for end in range(2)),
        "frequencies": None,
        "quantities": QUANTITIES,
    }


def _facts(kernel: BeamKernel) -> dict[str, Any]:
    """COLUMN: what the runtime must know of a column."""
    column = kernel.column
    parameters = [
        {"name": p.name, "latex": letter(p), "meaning": p.meaning}
        | {"default": float(p.default), "low": float(p.low), "high": float(p.high)}
        for p in column.parameters
    ]
    letters = sorted((*_LETTERS, *kernel.symbols), key=[*NOTATION].index)
    return {
        "name": column.name,
        "title": column.title,
        "basis": kernel.basis_name,
        "default": {"basis": column.basis, "modes": column.modes},
        "ends": column.ends,
        "rigid": len(kernel.rigid),
        "load": "P",
        **told(column.quantities),
        "damping": list(column.damping),
        "force": bool(kernel.system.forces),
        "parameters": parameters,
        "forms": {m.letter: m.text for m in kernel.matrices},
        "latex": {name: NOTATION[name].latex for name in letters},
        "meaning": {name: NOTATION[name].meaning for name in letters},
        "source": column.source,
    }


def _form(form: Any) -> tuple[dict[Any, Any], dict[Any, Any]]:
    return dict(sorted(form.along.items())), {(int(a), p, int(b), q): f for (a, p, b, q), f in form.points.items()}


def _conditions(kernel: BeamKernel, end: int) -> tuple[dict[tuple[int, int], Any], ...]:
    held = [{(order, 0): 1} for order in GEOMETRIC[kernel.column.ends[end]]]
    natural = [e for (at, _), e in sorted(kernel.motion.natural.items()) if at == end]
    return (*held, *({(int(j.args[1]), int(j.args[2])): e.coeff(j) for j in jets(e)} for e in natural))


# --- text ---------------------------------------------------------------------------------------------------


def _words(text: str) -> str:
    """What a user wrote, for a docstring: it stays as it was."""
    return text.replace("\\", "\\\\").replace('"""', '\\"\\"\\"')


def _filled(text: str) -> str:
    """The paragraphs of docstrings filled; a line that begins with a name and a colon, or is indented, stays apart."""
    lines, module = text.splitlines(), ast.parse(text)
    documented = (node for node in module.body if isinstance(node, ast.ClassDef | ast.FunctionDef))
    docs = [node.body[0] for node in (module, *documented) if ast.get_docstring(node)]
    for doc in reversed(docs):
        place, indent = slice(doc.lineno - 1, doc.end_lineno), " " * doc.col_offset
        given = textwrap.dedent(indent + "\n".join(lines[place]).strip()).removesuffix('"""').rstrip()
        given = re.sub(r"(?<=\S)\n(?=\S)(?!\w+: )", " ", re.sub(r"\n{3,}", "\n\n", given))
        # what is short in brackets, and an equation's number, is not broken
        given = re.sub(r"Eqs?\. \(|\([^()\n]{1,20}\)", lambda found: found[0].replace(" ", "\0"), given)
        filled = [
            textwrap.fill(line, WIDTH - len(indent + '"""'), subsequent_indent=" " * (len(line) - len(line.lstrip())))
            for line in given.split("\n")
        ]
        alone = len(filled) == 1 and "\n" not in filled[0]
        whole = "\n".join(filled).replace("\0", " ") + ('"""' if alone else '\n"""')
        lines[place] = textwrap.indent(whole, indent).split("\n")
    return "\n".join(lines) + "\n"


def _formatted(text: str) -> str:
    """The text as Ruff lays it out, whatever settings there are on the machine."""
    from ruff.__main__ import find_ruff_bin

    command = [find_ruff_bin(), "format", "--isolated", "--no-cache", f"--line-length={WIDTH}", "-"]
    return subprocess.run(command, input=text.encode(), capture_output=True, check=True).stdout.decode()


def _refuse_names(kernel: Kernel, text: str) -> None:
    """A parameter named as something that the module calls so, or that a function it is given to does."""
    module = ast.parse(text)
    taken = {node.name for node in module.body if isinstance(node, ast.FunctionDef | ast.ClassDef)}
    for function in (node for node in module.body if isinstance(node, ast.FunctionDef)):
        if function.args.kwonlyargs:
            inside = [node for node in ast.walk(function) if isinstance(node, ast.Name)]
            taken |= {node.id for node in inside if isinstance(node.ctx, ast.Store)}
            taken |= {argument.arg for argument in function.args.args}
    for parameter in kernel.column.parameters:
        if parameter.name in taken:
            raise StatementError(f"parameter {parameter.name!r}: emitted code calls something else so; choose another")
