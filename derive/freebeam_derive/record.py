"""The record that every stage keeps of what it did: a lesson is printed from it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import mpmath
from sympy import Basic, Eq, Expr, MatrixBase, cancel, expand

ROUNDING = mpmath.mpf(10) ** -20
"""What a residual computed to 40 digits may leave; one of exact arithmetic leaves nothing."""


@dataclass(frozen=True)
class Step:
    """One step of the derivation.

    `before` and `after` are the SymPy objects that the program computed with (an expression, a relation,
    a matrix or a tuple of these), never a text about them. `equation` is the paper's number, such as
    "Eq. (11)", empty where the paper has none. `check` names in words what proved the step. `proof` computes, by
    another route than the step's own, what must vanish: expressions, matrices, mpmath numbers, or tuples of these.
    """

    stage: str
    what: str
    why: str
    before: Any
    after: Any
    equation: str = ""
    check: str = ""
    proof: Callable[[], Any] | None = field(default=None, compare=False, repr=False)

    def residual(self) -> float:
        """Run the proof; what is left of what must vanish: 0.0 where arithmetic is exact.

        Raises AssertionError where something is left, or the step has no proof.
        """
        if self.proof is None:
            raise AssertionError(f"{self.stage}: {self.what}: has no proof")
        left = 0.0
        for item in _flat(self.proof()):
            if isinstance(item, Basic):
                if expand(item) != 0 and cancel(item) != 0:
                    raise AssertionError(f"{self.stage}: {self.what}: leaves {str(item)[:200]}")
            elif not abs(item) < ROUNDING:
                raise AssertionError(f"{self.stage}: {self.what}: leaves {mpmath.nstr(item, 5)}")
            else:
                left = max(left, float(abs(item)))
        return left


def _flat(found: Any) -> list[Expr | mpmath.mpf]:
    if isinstance(found, MatrixBase | tuple | list):
        return [item for part in found for item in _flat(part)]
    return [found]


def equal(left: Expr, right: Expr | int) -> Eq:
    """The relation left = right as it is written; its truth is nobody's question here, and dear to decide."""
    return Eq(left, right, evaluate=False)
