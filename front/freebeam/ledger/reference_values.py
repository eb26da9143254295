"""The columns' reference values against what the program proves of them, and how a printed number follows from it."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from decimal import ROUND_DOWN, ROUND_HALF_EVEN, Decimal, localcontext
from functools import cache
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np

from freebeam import own
from freebeam.maps.known import critical_load
from freebeam.proofs import enclosed_load
from freebeam_sym.checks import InputError
from freebeam_sym.question import Question
from freebeam_sym.stability.crossings import first_loss as search
from freebeam_sym.stability.general import General

if TYPE_CHECKING:
    from freebeam_derive.statement import Column as Statement
    from freebeam_derive.statement import Reference
    from freebeam_sym.columns import Column

__all__ = ["Case", "Checked", "Loss", "first_loss", "statements", "validate"]

ROUNDINGS = {"rounded": ROUND_HALF_EVEN, "cut off": ROUND_DOWN}
ENCLOSED, CONVERGED = "crossing enclosed", "converged"
LEAST, SPARE = 12, 3  # digits that are proven, in all and beyond those that are compared
MANY = 16  # polynomials in which modes are known to all digits that are compared


@dataclass(frozen=True)
class Case:
    """What is asked of a column: its own parameters, all of them, and dampings; kappa of their limit, else None."""

    own: Mapping[str, float] = field(default_factory=dict)
    alpha: float = 0.0
    beta: float = 0.0
    kappa: float | None = None

    @property
    def given(self) -> dict[str, Any]:
        """As keywords."""
        limit = {} if self.kappa is None else {"kappa": self.kappa}
        return {"alpha": self.alpha, "beta": self.beta, **limit, **self.own}


@dataclass(frozen=True)
class Loss:
    """The first loss of stability of a beam itself, nondimensional: load and frequency as (lower, upper) decimal text.

    proof: "crossing enclosed": a crossing is proven to be there, alone, and of this kind; that it is the first is the
    word of series that agree. "converged": the load is their word too, within its estimated error.
    """

    load: tuple[str, str]
    frequency: tuple[str, str]
    kind: str
    proof: str


@dataclass(frozen=True)
class Checked:
    """A reference value with what is computed, of the beam itself. explained: the computed load, or that of as few
    modes as the reference is of, printed by the reference's rule, or why there is none."""

    column: str
    family: str
    reference: Reference
    computed: Loss | None
    explained: str
    passed: bool


@cache
def statements() -> Mapping[str, Statement]:
    """All columns that come with freebeam, by their names, family by family; read once a process, none derived."""
    from freebeam_derive import pipeline
    from freebeam_derive.references import FAMILIES
    from freebeam_derive.statement import load_column

    stated = [load_column(path) for path in pipeline.known().values()]
    in_order = sorted(stated, key=lambda column: FAMILIES.index(column.family))
    return MappingProxyType({column.name: column for column in in_order})


def first_loss(column: Column, case: Case, digits: int) -> Loss | None:
    """The first loss of stability with its enclosure, of relative width below 10^-digits where it is proven; None up
    to the load 1000 where there is none. Raises InputError where series do not agree."""
    near = critical_load(column, **case.given).beam
    if near is None:
        raise InputError(f"{column.name}: its series do not agree on a first loss of stability")
    if near.load is None or near.frequency is None:
        return None
    try:
        proven = enclosed_load(column, digits=digits, **case.given)
    except InputError:  # no limits of damping, say, of a column beyond the textbook's
        width = near.uncertainty
        return Loss(_around(near.load, width), _around(near.frequency, width), near.kind, CONVERGED)
    if proven.load is None or proven.frequency is None or not math.isclose(float(proven.load[0]), near.load):
        raise InputError(f"{column.name}: the crossing that is enclosed is not the one that its series find")
    return Loss(proven.load, proven.frequency, proven.kind, ENCLOSED)


def in_modes(column: Column, case: Case, count: int) -> tuple[str, str] | None:
    """The first loss of a series of the first modes of the unloaded, undamped column, which many have computed by hand,
    within rounding; None where there is none. Raises InputError where it has no such modes."""
    question = Question.of(column, MANY, case.alpha, case.beta, **case.own)
    terms = column.coefficients(MANY, False, case.alpha, case.beta, **case.own)
    M, E = terms.M[0], terms.K[0]
    try:
        L = np.linalg.inv(np.linalg.cholesky(M))
    except np.linalg.LinAlgError:
        raise InputError(f"{column.name}: has no modes without load that all have a mass") from None
    V = L.T @ np.linalg.eigh(L @ E @ L.T)[1][:, :count]
    mass, damping, stiffness = ([V.T @ X @ V for X in part] for part in (terms.M, terms.C, terms.K))
    found = search(General(mass, damping, stiffness), question.load_max).crossing
    return None if found is None else _around(found.load, 1e-9)


def _around(value: float, error: float) -> tuple[str, str]:
    """A float with its relative error, as decimals."""
    return repr(value * (1 - error)), repr(value * (1 + error))


def printed(ends: tuple[str, str], like: str, rule: str) -> str:
    """A load to as many places as another has, by a rule; both bounds where they differ.

    >>> printed(("7.83734743", "7.83734744"), "7.83", "cut off")
    '7.83'
    """
    unit = Decimal(1).scaleb(Decimal(like).as_tuple().exponent)  # type: ignore[arg-type]
    with localcontext(prec=60):
        texts = [f"{Decimal(end).quantize(unit, ROUNDINGS[rule]):f}" for end in ends]
    return " to ".join(dict.fromkeys(texts))


def validate(progress: Callable[[str], None] | None = None) -> list[Checked]:
    """Compute each reference value of each column, with proofs to more digits than it has."""
    rows, stated = [], statements()
    for number, (name, statement) in enumerate(stated.items(), 1):
        if progress:
            progress(f"{name}, {number} of {len(stated)}")
        column = own.column(name, "legendre")
        rows += [_checked(statement, column, reference) for reference in statement.references]
    return rows


def _checked(statement: Statement, column: Column, reference: Reference) -> Checked:
    case = Case({**reference.own}, reference.alpha, reference.beta, reference.kappa)
    try:
        found = first_loss(column, case, max(reference.digits + SPARE, LEAST))
        ends = None if found is None else found.load
        if reference.modes:
            ends = in_modes(column, case, reference.modes)
        explained = "none" if ends is None else printed(ends, reference.load, reference.rule)
    except InputError as error:
        found, explained = None, f"not computed: {error}"
    passed = found is not None and found.kind == reference.kind and explained == reference.load
    return Checked(statement.name, statement.family, reference, found, explained, passed)
