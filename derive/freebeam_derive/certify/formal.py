"""Numbers told by how they come about: sums of fractions times roots, functions and integrals, left as they are.

Two such sums are equal where all their terms are. So it is known exactly that a stiffness matrix with a factor such as
exp(−x) takes a motion to nothing, which balls do not tell from a small number.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from flint import fmpq, fmpq_mat, fmpz

from freebeam_derive.certify.structure import null_space

__all__ = ["Formal", "Letters", "Resting", "letters", "resting"]


def _with_formal(operation: Any) -> Any:
    """An operation with a number that is one of fractions; NumPy sees to arrays."""

    def of(self: Formal, other: Any) -> Any:
        if isinstance(other, Formal):
            return operation(self, other)
        if isinstance(other, int | np.integer | fmpz | fmpq):
            return operation(self, Formal(int(other) if isinstance(other, np.integer) else other))
        if isinstance(other, float) and (other * 2**20).is_integer():
            return operation(self, Formal(fmpq(*other.as_integer_ratio())))
        return NotImplemented

    return of


class Formal:
    """terms: a fraction under each product of names, that of 1 under the empty one. TypeError where a comparison, or
    what it is combined with, is not one of fractions."""

    __slots__ = ("terms",)

    def __init__(self, terms: dict[tuple[str, ...], fmpq] | fmpq | fmpz | int) -> None:
        given = terms if isinstance(terms, dict) else {(): fmpq(terms)}
        self.terms = {name: factor for name, factor in given.items() if factor != 0}

    @staticmethod
    def named(name: str) -> Formal:
        return Formal({(name,): fmpq(1)})

    def __repr__(self) -> str:
        return str(sorted((name, str(factor)) for name, factor in self.terms.items()))

    def __hash__(self) -> int:
        return hash(repr(self))

    @property
    def fraction(self) -> fmpq:
        """Where it is one. Raises TypeError."""
        if not self.terms.keys() <= {()}:
            raise TypeError("a number is no fraction")
        return self.terms.get((), fmpq(0))

    @_with_formal
    def __add__(self, other: Formal) -> Any:
        terms = dict(self.terms)
        for name, factor in other.terms.items():
            terms[name] = terms.get(name, fmpq(0)) + factor
        return Formal(terms)

    @_with_formal
    def __mul__(self, other: Formal) -> Any:
        terms = dict[tuple[str, ...], fmpq]()
        for one, a in self.terms.items():
            for two, b in other.terms.items():
                name = tuple(sorted((*one, *two)))
                terms[name] = terms.get(name, fmpq(0)) + a * b
        return Formal(terms)

    @_with_formal
    def __truediv__(self, other: Formal) -> Any:
        if other.terms.keys() <= {()}:
            return self * Formal(1 / other.fraction)
        return self * Formal.named(f"1/{other}")

    @_with_formal
    def __sub__(self, other: Formal) -> Any:
        return self + other * -1

    @_with_formal
    def __rsub__(self, other: Formal) -> Any:
        return other - self

    @_with_formal
    def __rtruediv__(self, other: Formal) -> Any:
        return other / self

    __radd__, __rmul__ = __add__, __mul__

    def __pow__(self, power: int) -> Any:
        whole = Formal(1)
        for _ in range(abs(power)):
            whole = whole * self
        return whole if power >= 0 else 1 / whole

    def __neg__(self) -> Any:
        return self * -1

    @_with_formal
    def __eq__(self, other: Formal) -> bool:
        return not (self - other).terms

    @_with_formal
    def __lt__(self, other: Formal) -> bool:
        return bool((self - other).fraction < 0)

    @_with_formal
    def __le__(self, other: Formal) -> bool:
        return bool((self - other).fraction <= 0)

    @_with_formal
    def __gt__(self, other: Formal) -> bool:
        return bool((self - other).fraction > 0)

    @_with_formal
    def __ge__(self, other: Formal) -> bool:
        return bool((self - other).fraction >= 0)

    def __abs__(self) -> Any:
        return -self if self < 0 else self

    def __float__(self) -> float:
        return int(self.fraction.p) / int(self.fraction.q)


def _function(name: str) -> Any:
    return lambda number: Formal.named(f"{name}({number})")


for _name in ("exp", "log", "sin", "cos", "tan", "sinh", "cosh", "tanh", "sqrt"):  # NumPy calls them by these names
    setattr(Formal, _name, _function(_name))
for _name in ("sin", "cos", "tan", "sinh", "cosh", "tanh"):
    setattr(Formal, f"arc{_name}", _function(f"arc{_name}"))


@dataclass(frozen=True)
class Resting:
    """Bases (n, n) of fractions such that these rows, and as many columns, of left' X right are known to be nothing."""

    left: Any
    right: Any
    rows: list[int]
    columns: list[int]

    def seen(self, motions: Any) -> Any:
        """Motions, as columns, in the basis of the right."""
        return np.array(fmpq_mat(self.right.tolist()).inv().tolist()) @ motions

    def holds(self, motions: Any) -> bool:
        """Whether motions are among these, from the left too."""
        others = np.delete(self.seen(motions), self.columns, axis=0)
        return bool((self.left == self.right).all()) and all(v == 0 for v in others.flat)


def resting(X: Any) -> Resting | None:
    """What a matrix of such numbers, (n, n), takes to nothing; None where no motion of fractions is known to be one, or
    not as many from either side."""
    parts = _by_name(X, _names(X))
    (left, rows), (right, columns) = (_with_units(np.concatenate(of)) for of in ([Y.T for Y in parts], parts))
    return Resting(left, right, rows, columns) if len(rows) == len(columns) > 0 else None


Letters = tuple[list[Any], list[Any], list[Any]]
"""M, C and K as sums over products of names, the same for all powers of the load: the fractions (n, n) of each."""


def letters(terms: list[list[Any]]) -> list[list[Any]]:
    """Of M, C, K and others by powers of the load, arrays (n, n) of such numbers."""
    names = sorted({name for powers in terms for X in powers for name in _names(X)})
    return [[Y for X in powers for Y in _by_name(X, names)] for powers in terms]


def _names(X: Any) -> list[tuple[str, ...]]:
    return sorted({name for value in X.flat for name in value.terms})


def _by_name(X: Any, names: list[tuple[str, ...]]) -> list[Any]:
    """The fractions that stand with each name."""
    zero = fmpq(0)
    return [np.array([v.terms.get(name, zero) for v in X.flat], dtype=object).reshape(X.shape) for name in names]


def _with_units(A: Any) -> tuple[Any, list[int]]:
    """Units, some replaced by vectors that A takes to nothing, each in the place where it alone is 1; and where."""
    space, n = null_space(A), A.shape[1]
    found, places = np.array([[fmpq(int(i == j)) for j in range(n)] for i in range(n)]), []
    for vector in space.T:
        place = next(i for i in range(n) if vector[i] == 1 and np.count_nonzero(space[i]) == 1)
        found[:, place] = vector
        places.append(place)
    return found, places
