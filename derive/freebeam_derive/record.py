"""The record that every stage keeps of what it did: a lesson is printed from it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from sympy import Eq, Expr


@dataclass(frozen=True)
class Step:
    """One step of the derivation.

    `before` and `after` are the SymPy objects that the program computed with (an expression, a relation,
    a matrix or a tuple of these), never a text about them. `equation` is the paper's number, such as
    "Eq. (11)", empty where the paper has none. `check` names in words what proved the step.
    """

    stage: str
    what: str
    why: str
    before: Any
    after: Any
    equation: str = ""
    check: str = ""


def equal(left: Expr, right: Expr | int) -> Eq:
    """The relation left = right as it is written; its truth is nobody's question here, and dear to decide."""
    return Eq(left, right, evaluate=False)
