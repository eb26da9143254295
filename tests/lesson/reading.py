"""Reads a printed formula back: LaTeX of the lesson into jets, by the signs alone, so that it can be evaluated."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

from sympy import Add, Expr, Integer, Integral, Mul, Symbol, nsimplify, sqrt

from freebeam_derive.jets import ALONG, ALWAYS, beside, leap
from freebeam_derive.notation import F_0, P, alpha, beta, x, x_F
from freebeam_derive.statement import jet

DIRAC = Symbol("dirac")
"""What stands for δ(x − x_F)."""
KNOWN = {"P_0": P, r"\alpha": alpha, r"\beta": beta, "x": x, "F_0": F_0, "x_F": x_F}
_TOKEN = re.compile(r"\\[a-zA-Z]+|dx|[PF]_0|x_F|\d+(?:\.\d+)?|[A-Za-z]|[-+^_{}()\[\]=<:,]")


class Reader:
    """fields: LaTeX letter -> what stands for the unknown in jets, and whether it is a coordinate; own: LaTeX of
    parameters -> symbols."""

    def __init__(self, fields: Mapping[str, tuple[Expr, bool]], own: Mapping[str, Expr]) -> None:
        self.fields, self.own = fields, {**KNOWN, **own}
        self.tokens: list[str] = []

    def read(self, latex: str) -> Expr:
        """A sum, or an equation with zero on its right."""
        latex = re.sub(r"\\(?:left|right|bigl|bigr|quad|,|;)(?![a-zA-Z])|[&\s]|\\,|\\;", " ", latex)
        self.tokens = _TOKEN.findall(latex.removesuffix("= 0").strip())
        found = self.sum()
        assert not self.tokens, f"left of {latex}: {self.tokens}"
        return found

    def next(self) -> str:
        return self.tokens[0] if self.tokens else ""

    def take(self, wanted: str = "") -> str:
        token = self.tokens.pop(0)
        assert not wanted or token == wanted, f"{token} is not {wanted}: {self.tokens[:8]}"
        return token

    def braced(self) -> Expr:
        self.take("{")
        found = self.sum()
        self.take("}")
        return found

    def sum(self) -> Expr:
        terms = []
        while self.next() and self.next() not in ")}]" and self.next() != "dx":
            sign = -1 if self.next() == "-" else 1
            if self.next() in "+-":
                self.take()
            terms.append(sign * self.product())
        return Add(*terms)

    def product(self) -> Expr:
        factors: list[Expr] = []
        while self.next() and self.next() not in "+-)}]" and self.next() != "dx":
            factors.append(self.power())
        return Mul(*factors)

    def power(self) -> Expr:
        base = self.factor()
        if self.next() == "^":
            self.take()
            return base ** (self.braced() if self.next() == "{" else Integer(self.take()))
        return base

    def factor(self) -> Expr:
        token = self.next()
        letter = self.letter()
        if letter is not None:
            return letter
        self.take()
        if token[0].isdigit():
            return nsimplify(token, rational=True)
        if token == r"\frac":
            return self.braced() / self.braced()
        if token == r"\sqrt":
            return sqrt(self.braced())
        if token == "(":
            found = self.sum()
            self.take(")")
            return found
        if token == "[":
            inner = self.factor()
            self.take("]")
            self.take("_")
            place = leap(self.braced())
            return inner.replace(jet, lambda which, p, r, _: jet(which, p, r, place))
        if token == r"\int":
            self.take("_")
            low = self.braced()
            self.take("^")
            high = self.braced()
            inside = self.product()
            self.take("dx")
            return Integral(inside, (x, low, high))
        raise AssertionError(f"{token} before {self.tokens[:8]}")

    def letter(self) -> Expr | None:
        """A field with its dots, primes and place, a coordinate, a parameter; None where none is next."""
        before = list(self.tokens)
        varied = self.next() == r"\delta"
        if varied:
            self.take()
            if self.next() == "(":
                while self.take() != ")":
                    pass
                return DIRAC
        dots = {r"\dot": 1, r"\ddot": 2}.get(self.next(), 0)
        if dots:
            self.take()
            self.take("{")
        name = self.name()
        if dots:
            self.take("}")
        name += self.subscript()
        key = rf"\delta {name}" if varied else name
        if key not in self.fields:
            self.tokens = before
            if varied or dots:
                raise AssertionError(f"{key} is not known: {before[:8]}")
            return self.parameter()
        which, coordinate = self.fields[key]
        primes = 0
        if self.next() == "^" and self.tokens[2] == r"\prime":
            self.take()
            self.take("{")
            while self.next() == r"\prime":
                self.take()
                primes += 1
            self.take("}")
        place: Any = ALWAYS if coordinate else ALONG
        if self.next() == "(" and not coordinate:
            place = self.place()
        return jet(which, Integer(primes), Integer(dots), place)

    def name(self) -> str:
        token = self.take() if self.tokens else ""
        if token == r"\hat":
            self.take("{")
            token = rf"\hat{{{self.take()}}}"
            self.take("}")
        return token

    def subscript(self) -> str:
        if self.next() != "_" or self.tokens[1] != "{":
            return ""
        self.take()
        self.take("{")
        inside = ""
        while self.next() != "}":
            inside += self.take()
        self.take("}")
        return f"_{{{inside}}}"

    def place(self) -> Expr:
        self.take("(")
        token = self.take()
        where = nsimplify(token, rational=True) if token[0].isdigit() else self.own[token]
        side = 0
        if self.next() == "^":
            self.take()
            self.take("{")
            side = 1 if self.take() == "+" else -1
            self.take("}")
        self.take(")")
        return beside(where, Integer(side)) if side else where

    def parameter(self) -> Expr | None:
        token = self.next()
        if token in self.own:
            self.take()
            return self.own[token]
        return None
