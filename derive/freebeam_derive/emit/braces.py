"""Expressions as source of languages with braces, C99 and JavaScript: what the templates `*.braces.jinja` print with.

Both are written from one template a basis. What they say otherwise, declarations and how a function gives its results,
stands in `c.jinja` and `javascript.jinja`. A column's own parameters are members of `own`, so that their names meet no
other.
"""

from __future__ import annotations

import re
import textwrap
from collections.abc import Iterable
from dataclasses import dataclass
from functools import partial
from typing import Any

from sympy import Expr, Inverse, MatAdd, MatMul, Piecewise, S, Symbol
from sympy.printing.codeprinter import CodePrinter

from freebeam_derive.emit import source
from freebeam_derive.statement import StatementError

WIDTH = 116


class Braces(source.Printer):
    """SymPy to expressions of numbers in double precision."""

    words: dict[str, str]  # what is called otherwise than in the array API, and types
    whole = "{}"  # a whole number

    def __init__(self, own: frozenset[str] = frozenset()) -> None:
        super().__init__(source.OWN)
        self.own, self.prefix = own, ""

    def _print_Function(self, e: Expr) -> str:
        text = str(super()._print_Function(e))
        name, rest = text.split("(", 1)
        return f"{self.words.get(name, name)}({rest}"

    def _print_Integer(self, e: Expr) -> str:
        return self.whole.format(int(e))

    _print_Zero = _print_One = _print_NegativeOne = _print_Integer

    def _print_Rational(self, e: Expr) -> str:
        return repr(float(e)) if e.q in source.EXACT else f"{self._print(S(e.p))} / {self._print(S(e.q))}"

    def _print_Half(self, e: Expr) -> str:
        return "0.5"

    def _print_Mul(self, e: Expr) -> str:
        number, rest = e.as_coeff_Mul()
        if number.is_Rational and number.q not in (1, *source.EXACT):  # division rounds once
            return f"{self.parenthesize(number.p * rest, 50)} / {self._print(S(number.q))}"
        return str(CodePrinter._print_Mul(self, e))

    def _print_Pow(self, e: Expr, rational: bool = False) -> str:
        base, power = e.base, e.exp
        if power.is_Rational and power < 0:
            return f"({self._print(S.One)} / {self.parenthesize(base**-power, 60)})"
        if power == S.Half:
            return f"sqrt({self._print(base)})"
        if power.is_Integer and base.is_Atom and power <= 8:
            return f"({' * '.join([self._print(base)] * int(power))})"
        return f"pow({self._print(base)}, {self._print(power)})"

    def _print_Piecewise(self, e: Piecewise) -> str:
        text = str(self._print(e.args[-1][0]))
        for value, condition in reversed(e.args[:-1]):
            text = f"({self._print(condition)} ? {self._print(value)} : {text})"
        return text

    def _print_And(self, e: Expr) -> str:
        return f"({' && '.join(map(self._print, e.args))})"

    def _print_Or(self, e: Expr) -> str:
        return f"({' || '.join(map(self._print, e.args))})"

    def _print_Not(self, e: Expr) -> str:
        return f"!({self._print(e.args[0])})"

    def _extreme(self, name: str, e: Expr) -> str:
        text = str(self._print(e.args[0]))
        for other in e.args[1:]:
            text = f"{self.words[name]}({text}, {self._print(other)})"
        return text

    def _print_Max(self, e: Expr) -> str:
        return self._extreme("max", e)

    def _print_Min(self, e: Expr) -> str:
        return self._extreme("min", e)

    def _print_Infinity(self, e: Expr) -> str:
        return self.words["inf"]

    def _print_Pi(self, e: Expr) -> str:
        return repr(float(S.Pi))

    def _print_Exp1(self, e: Expr) -> str:
        return repr(float(S.Exp1))

    def _print_Symbol(self, e: Symbol) -> str:
        return f"{self.words['own']}{e.name}" if e.name in self.own else str(e.name)


class C(Braces):
    """SymPy to C99. A whole number has a point, for two of them would be divided as whole numbers."""

    whole = "{}.0"
    words = {  # noqa: RUF012
        "abs": "fabs", "sign": "sign_of", "max": "fmax", "min": "fmin", "inf": "INFINITY", "own": "own->",
        "basis": "basis->", "whole": "int", "fixed_whole": "const int", "fixed": "const double", "changing": "double",
        "list": "const double *", "list_changed": "double *", "round": "nearbyint",
    }  # fmt: skip


class JavaScript(Braces):
    """SymPy to JavaScript, whose functions are those of `Math`."""

    words = {  # noqa: RUF012
        "max": "max", "min": "min", "inf": "Infinity", "own": "own.", "basis": "basis.", "whole": "let",
        "fixed_whole": "const", "fixed": "const", "changing": "let", "list": "const ", "list_changed": "const ",
        "round": "round", "abs": "abs",
    }  # fmt: skip


PRINTERS: dict[str, type[Braces]] = {"c": C, "javascript": JavaScript}


def code(printer: Braces, expression: Any) -> str:
    """An expression as source. Raises StatementError for a function that kernels do not have."""
    return re.sub(r" ?([*/]) ?", r" \1 ", str(printer.doprint(S(expression))))


def filters(language: str, own: Iterable[str]) -> dict[str, Any]:
    """What the templates print expressions of a column with; own: names of its parameters."""
    say, plain = (partial(code, PRINTERS[language](names)) for names in (frozenset(own), frozenset[str]()))
    return {
        "code": say,
        "plain": plain,
        "shared": source.shared,
        "quotient": partial(source.quotient, say=say),
        "times": partial(source.times, say=say),
        "element": partial(_element, say=plain),
        "modewise": partial(modewise, say=say),
        "comment": comment,
        "remark": lambda text: f"/**< {' '.join(text.split()).replace('*/', '* /')} */",
        "listed": lambda numbers: ", ".join(map(str, numbers)),
    }


def _element(e: Expr, say: Any) -> str:
    """Entry i of an expression of matrices and vectors; a product of both is a sum over a row."""
    if isinstance(e, MatAdd):
        return " + ".join(_element(term, say) for term in e.args).replace("+ -", "- ")
    scalar, matrices = e.as_coeff_matrices() if isinstance(e, MatMul) else (S.One, [e])
    if isinstance(matrices[0], Inverse):
        raise StatementError(f"{e}: is no sum over rows")
    names = [str(matrix.name) for matrix in matrices]
    text = f"{names[0]}[i]" if len(names) == 1 else f"row_times(n, {names[0]}, {names[1]}, i)"
    return text if scalar == 1 else f"-{text}" if scalar == -1 else f"{say(scalar)} * {text}"


# --- modes ---------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class OfModes:
    """Statements on mode i, on mode j, on the pair, its entry; the diagonal's on mode i and its value; rows' on j."""

    of_i: list[tuple[str, str]]
    of_j: list[tuple[str, str]]
    pairs: list[tuple[str, str]]
    entry: list[str]
    diagonal: str
    rows: list[str]
    of_rows: list[tuple[str, str]]


def modewise(matrix: Any, apart: list[str], say: Any) -> OfModes:
    """A matrix over modes (a MatrixProgram) as statements on single numbers; apart: fields that its division needs."""
    pairs = [*(e for _, e in matrix.pair_statements), *matrix.entry] if any(matrix.entry) else []
    division = apart if len(matrix.entry) > 1 else []

    def names(side: str) -> set[str]:
        return {s.name.removesuffix(side) for e in pairs for s in e.free_symbols if s.name.endswith(side)} | {*division}

    known = {*matrix.used, *apart, *(name for name, _ in matrix.mode_statements)}

    def on(side: str, e: Expr) -> Expr:
        return e.xreplace({s: Symbol(s.name + side, real=True) for s in e.free_symbols if s.name in known})

    def statements(side: str, wanted: set[str]) -> list[tuple[str, str]]:
        kept: list[tuple[str, str]] = []
        for name, e in reversed(matrix.mode_statements):
            if name in wanted:
                kept.insert(0, (name + side, say(on(side, e))))
                wanted = wanted | {s.name for s in e.free_symbols}
        computed = {name for name, _ in matrix.mode_statements}
        fields = sorted((wanted & known) - computed)
        return [*((f"{name}{side}", f"{{basis}}{name}[{side[1:]}]") for name in fields), *kept]

    def of(*expressions: Expr) -> set[str]:
        return {s.name for e in expressions for s in e.free_symbols} & known

    return OfModes(
        statements("_i", names("_i") | of(matrix.diagonal)),
        statements("_j", names("_j")) if pairs else [],
        [(name, say(e)) for name, e in matrix.pair_statements],
        [say(e) if e != 0 else "" for e in matrix.entry] if pairs else [],
        say(on("_i", matrix.diagonal)),
        [say(on("_j", row)) if row != 0 else "" for row in matrix.rows],
        statements("_j", of(*matrix.rows)),
    )


# --- text ----------------------------------------------------------------------------------------------------


def comment(text: str, indent: str = "") -> str:
    """A comment that says a text; its paragraphs are filled, lines that are indented or begin with a name stay."""
    text = re.sub(r"\n{3,}", "\n\n", text.strip()).replace("*/", "* /")
    text = re.sub(r"(?<=\S)\n(?=\S)(?!\w+: )", " ", text)
    lines: list[str] = []
    for given in text.split("\n"):
        inside = " " * (len(given) - len(given.lstrip()))
        lines += textwrap.wrap(given, WIDTH - 4, subsequent_indent=inside, break_on_hyphens=False) or [""]
    if len(lines) == 1:
        return f"{indent}/** {lines[0]} */"
    return "\n".join([f"{indent}/**", *(f"{indent} * {line}".rstrip() for line in lines), f"{indent} */"])


def laid_out(text: str) -> str:
    """Lines that are too long broken after an operator, and no two empty lines; comments are filled already."""
    found: list[str] = []
    text = re.sub(r"\n+(?=\n *[}])", "", re.sub(r"\n{3,}", "\n\n", text))
    for line in text.split("\n"):
        line = line.rstrip()
        indent = " " * (len(line) - len(line.lstrip()) + 4)
        while len(line) > WIDTH and not line.lstrip().startswith(("*", "/*")):
            ends = (m.end() for m in re.finditer(r"[^\w\s](?= )", line))
            places = [end for end in ends if len(indent) < end <= WIDTH and not _quoted(line[:end])]
            if not places:
                break
            found.append(line[: places[-1]])
            line = indent + line[places[-1] :].lstrip()
        found.append(line)
    return "\n".join(found).strip("\n") + "\n"


def _quoted(before: str) -> bool:
    return before.count('"') % 2 == 1 or before.count("`") % 2 == 1
