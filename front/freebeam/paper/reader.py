"""From the LaTeX of a printed equation to a SymPy form, with nothing put right on the way. Eqs. (1)-(26).

The reader knows what the paper uses and no more: fractions of derivatives, integrals, a sum, primes, values at a place,
cases, a block matrix. What names stand for is a table of the equation's own, `Names`. A derivative whose numerator and
denominator differ in order is kept as the misprint that it is: order_3(∂⁵y/∂t∂x⁴).
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from sympy import (
    Derivative,
    DiracDelta,
    Eq,
    Expr,
    Function,
    Integral,
    Matrix,
    Rational,
    Subs,
    Sum,
    cos,
    cosh,
    exp,
    sin,
    sinh,
    sqrt,
)

_TOKEN = re.compile(
    r"\\begin\{\w+\}|\\end\{\w+\}|\\[A-Za-z]+|\\[,;!|\\ ]|\d+(?:\.\d+)?|EI|[A-Za-z]|''''|'''|''|'|[-+=(){}\[\]^_&,\"|/]"
)
_SILENT = {"\\left", "\\right", "\\Big", "\\,", "\\;", "\\!", "\\ ", "\\quad", "\\hspace"}
_FUNCTIONS: dict[str, Any] = {"\\cos": cos, "\\cosh": cosh, "\\sin": sin, "\\sinh": sinh}
_ACCENTS = {"\\overline": "bar", "\\dot": "dot", "\\ddot": "ddot", "\\hat": "hat"}
_PRIMES = {"'": 1, '"': 2, "''": 2, "'''": 3, "''''": 4, "\\prime": 1}

delta = Function("delta")  # the variation of a quantity that no field is written out for, Eq. (7)
differential = Function("d")


class ReadingError(ValueError):
    """A printed form that the reader does not know; the message says where."""


def misprinted(order: int, derivative: Expr) -> Expr:
    """A derivative whose numerator is printed with another order than its denominator has."""
    return Function(f"order_{order}")(derivative)


@dataclass(frozen=True)
class Names:
    """What the names of an equation stand for.

    values: name -> SymPy object; a name is its letters with indices and accents, such as `y_bar` or `q_j_ddot`. A field
    may be printed with its arguments or without. varied: object -> its variation, where δ means that; otherwise δ is
    Dirac's.
    """

    values: Mapping[str, Any]
    varied: Mapping[Any, Any] = field(default_factory=dict)

    @property
    def coordinates(self) -> set[Any]:
        """What is integrated over."""
        return {self.values[name] for name in ("x", "t", "x_bar", "t_bar") if name in self.values}


def read(text: str, names: Names) -> tuple[Eq, ...]:
    """The equations that a printed form states, from left to right and top to bottom.

    a = b = c is two equations, a, b = c ± d is two, the places behind "at" are equations of their own.
    Raises ReadingError.
    """
    text = re.sub(r"\\tag\{\d+\}", "", text)
    text = re.sub(r"\\text\{at\}|\$\$", ",", text)  # a list goes on behind either
    tokens = [t for t in _TOKEN.findall(text) if t not in _SILENT]
    reader = _Reader(tokens, names)
    found = reader.statements()
    if reader.place != len(tokens):
        raise ReadingError(f"not read: {' '.join(tokens[reader.place :][:12])}")
    return tuple(found)


class _Reader:
    def __init__(self, tokens: list[str], names: Names) -> None:
        self.tokens, self.names, self.place = tokens, names, 0
        self.integrals = 0  # how many are open
        self.sign, self.doubled = 1, False  # what ± stands for, and whether one was met

    # --- tokens ---

    def peek(self, ahead: int = 0) -> str:
        return self.tokens[self.place + ahead] if self.place + ahead < len(self.tokens) else ""

    def take(self, expected: str = "") -> str:
        found = self.peek()
        if not found or (expected and found != expected):
            where = " ".join(self.tokens[max(0, self.place - 4) : self.place + 4])
            raise ReadingError(f"{expected or 'something'} is missing in: {where}")
        self.place += 1
        return found

    def accept(self, *options: str) -> str:
        if self.peek() in options:
            return self.take()
        return ""

    # --- statements ---

    def statements(self) -> list[Eq]:
        found: list[Eq] = []
        while self.place < len(self.tokens):
            if self.accept("\\begin{cases}"):
                while not self.accept("\\end{cases}"):
                    found += self.statement()
                    self.accept("\\\\")
            else:
                found += self.statement()
            while self.accept(",", "\\\\"):
                pass
        return found

    def statement(self) -> list[Eq]:
        left = [self.sum()]
        while self.accept(","):
            left.append(self.sum())
        sides: list[list[Expr]] = []
        while self.accept("="):
            begin = self.place
            self.doubled = False
            value = [self.sum()]
            if self.doubled:
                self.place, self.sign = begin, -1
                value.append(self.sum())
                self.sign = 1
            sides.append(value)
        if not sides:
            raise ReadingError(f"an expression without an equation: {left[0]}")
        pairs = []
        for one, other in zip([left, *sides], sides, strict=False):
            pairs += [Eq(a, b, evaluate=False) for a, b in zip(one, other, strict=True)]
        return pairs

    # --- expressions ---

    def sum(self) -> Any:
        total = -self.product() if self.accept("-") else self.product()
        while True:
            if self.accept("+"):
                total = total + self.product()
            elif self.accept("-"):
                total = total - self.product()
            elif self.accept("\\pm"):
                self.doubled = True
                total = total + self.sign * self.product()
            else:
                return total

    def product(self) -> Any:
        value = self.factor()
        while self.begins_factor():
            value = value * self.factor()
        return value

    def begins_factor(self) -> bool:
        token = self.peek()
        if token == "d" and self.ends_integral():
            return False
        return (
            bool(token)
            and token not in ("+", "-", "\\pm", "=", ",", ")", "]", "}", "&", "\\\\")
            and not (token.startswith("\\end"))
        )

    def factor(self) -> Any:
        value = self.atom()
        while True:
            if self.peek() == "^":
                self.take()
                value = value ** self.group()
            elif self.peek() == "|":  # value at a place
                self.take()
                self.take("_")
                self.take("{")
                variable = self.atom()
                self.take("=")
                value = at(value, variable, self.sum())
                self.take("}")
            else:
                return value

    def group(self) -> Any:
        if not self.accept("{"):
            return self.atom()
        value = self.sum()
        self.take("}")
        return value

    def atom(self) -> Any:
        token = self.peek()
        if re.match(r"\d", token):
            return Rational(self.take())
        if token in ("(", "[", "{"):
            self.take()
            value = self.sum()
            self.take({"(": ")", "[": "]", "{": "}"}[token])
            return value
        if token == "\\frac":
            return self.fraction()
        if token == "\\sqrt":
            self.take()
            return sqrt(self.group())
        if token == "\\int":
            return self.integral()
        if token == "\\sum":
            return self.series()
        if token == "\\begin{bmatrix}":
            return self.matrix()
        if token in _FUNCTIONS:
            self.take()
            return _FUNCTIONS[token](self.argument())
        if token == "\\delta":
            return self.delta()
        if token == "d" and self.peek(1) == "\\overline" and not self.ends_integral():
            self.take()
            return differential(self.atom())
        if token == "e" and self.peek(1) == "^":
            self.take(), self.take()
            return exp(self.group())
        return self.name()

    def argument(self) -> Any:
        """What a circular or hyperbolic function is taken of: the names that follow."""
        value = self.name()
        while self.peek() == "\\overline" or (re.match(r"[A-Za-z]$", self.peek()) and self.peek() != "d"):
            value = value * self.name()
        return value

    # --- names ---

    def name(self) -> Any:
        key, primes = self.key()
        if key not in self.names.values:
            raise ReadingError(f"the name {key} is not known")
        value = self.names.values[key]
        applied = bool(getattr(value, "is_Function", False))
        if primes:
            value = Derivative(value, (value.args[0], primes))
        if applied and self.peek() == "(":
            return self.applied(value, self.names.values[key])
        return value

    def applied(self, value: Any, function: Any) -> Any:
        self.take("(")
        places = [self.sum()]
        while self.accept(","):
            places.append(self.sum())
        self.take(")")
        for variable, place in zip(function.args, places, strict=True):
            value = at(value, variable, place)
        return value

    def key(self) -> tuple[str, int]:
        """A name with its accents and indices, and the number of its primes."""
        accents = []
        token = self.take()
        if token in _ACCENTS:
            accents.append(_ACCENTS[token])
            self.take("{")
            base, inner = self.key()
            self.take("}")
            if inner:
                raise ReadingError(f"a prime under an accent at {base}")
        elif re.match(r"[A-Za-z]|\\[A-Za-z]", token):
            base = token.lstrip("\\")
        else:
            raise ReadingError(f"a name is missing before {token} {self.peek()}")
        primes = 0
        while True:
            if self.peek() == "_":
                self.take()
                base += "_" + self.index()
            elif self.peek() in _PRIMES:
                primes += _PRIMES[self.take()]
            elif self.peek() == "^" and self.prime_ahead():
                self.take()
                braced = self.accept("{")
                while self.peek() in _PRIMES:
                    primes += _PRIMES[self.take()]
                if braced:
                    self.take("}")
            elif self.peek() == "^" and "G" in (self.peek(1), self.peek(2)):  # of a matrix, no power
                self.take()
                base += "_" + self.index()
            else:
                return "_".join([base, *accents]), primes

    def prime_ahead(self) -> bool:
        return self.peek(1) in _PRIMES or (self.peek(1) == "{" and self.peek(2) in _PRIMES)

    def index(self) -> str:
        """What stands in an index, braces left out."""
        text, depth = "", 0
        while True:
            token = self.take()
            depth += (token == "{") - (token == "}")
            text += token.strip("\\{}")
            if depth == 0:
                return text

    # --- what stands out of the line ---

    def fraction(self) -> Any:
        self.take("\\frac")
        if self.peek(1) in ("\\partial", "d") and self.peek() == "{":
            return self.derivative()
        numerator = self.group()
        return numerator / self.group()

    def derivative(self) -> Any:
        self.take("{")
        self.take()
        order = int(self.group()) if self.accept("^") else 1
        of = None if self.peek() == "}" else self.product()
        self.take("}")
        self.take("{")
        orders = []
        while self.accept("\\partial", "d"):
            variable = self.variable()
            orders.append((variable, int(self.group()) if self.accept("^") else 1))
        self.take("}")
        if of is None:
            of = self.factor()
        value = Derivative(of, *orders)
        return value if sum(n for _, n in orders) == order else misprinted(order, value)

    def variable(self) -> Any:
        """A name without the power that may stand at it."""
        key, _ = self.key()
        return self.names.values[key]

    def ends_integral(self) -> bool:
        """Whether `d` and a coordinate come next, with an integral open."""
        if not self.integrals or self.peek() != "d":
            return False
        here = self.place
        try:
            self.take()
            return self.names.values.get(self.key()[0]) in self.names.coordinates
        except ReadingError:
            return False
        finally:
            self.place = here

    def integral(self) -> Any:
        self.take("\\int")
        self.take("_")
        low = self.group()
        self.take("^")
        high = self.group()
        self.integrals += 1
        body = self.product()
        self.take("d")
        self.integrals -= 1
        return Integral(body, (self.variable(), low, high))

    def series(self) -> Any:
        self.take("\\sum")
        self.take("_")
        self.take("{")
        counter = self.name()
        self.take("=")
        low = self.sum()
        self.take("}")
        self.take("^")
        high = self.group()
        return Sum(self.product(), (counter, low, high))

    def matrix(self) -> Any:
        self.take("\\begin{bmatrix}")
        rows = [[self.sum()]]
        while not self.accept("\\end{bmatrix}"):
            if self.accept("\\\\"):
                rows.append([self.sum()])
            else:
                self.take("&")
                rows[-1].append(self.sum())
        return Matrix(rows).as_immutable()

    def delta(self) -> Any:
        self.take("\\delta")
        if not self.names.varied:
            self.take("(")
            value = DiracDelta(self.sum())
            self.take(")")
            return value
        if self.peek() == "\\int":
            return delta(self.integral())
        bracketed = self.accept("(")
        value = self.atom()
        if bracketed:
            self.take(")")
        field_ = value.expr if isinstance(value, Derivative) else value
        if field_ not in self.names.varied:
            raise ReadingError(f"the variation of {value} is not known")
        return value.xreplace({field_: self.names.varied[field_]})


def at(value: Any, variable: Any, place: Any) -> Any:
    """A value at a place; a derivative is taken first."""
    if place == variable:
        return value
    if value.has(Derivative):
        return Subs(value, variable, place)
    return value.subs(variable, place)
