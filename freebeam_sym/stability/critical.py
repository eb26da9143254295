"""Critical loads: the first loss of stability that is found for a question, with its error against the beam itself.
Section 3.2."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from freebeam_sym.checks import InputError, Unstable
from freebeam_sym.columns import Column
from freebeam_sym.question import Question
from freebeam_sym.stability.convergence import CONVERGED, KINDS, Answers, BeamLoss, beam_losses, judge
from freebeam_sym.stability.crossings import FirstLoss, first_loss
from freebeam_sym.stability.derivatives import crossing_derivative
from freebeam_sym.stability.general import General
from freebeam_sym.stability.problem import Complex, Crossing, Kind, Real

__all__ = ["CriticalLoad", "Search", "Touch", "answer", "critical_load"]

Search = Callable[[Any, float], FirstLoss]
"""What finds the first loss of stability of a problem up to a load, as `first_loss` does."""


class Touch(NamedTuple):
    """A load at which an eigenvalue comes to the imaginary axis and goes back, no loss of stability; nondimensional.
    frequency: 0 where K is singular there, None where rounding hides it."""

    load: float
    frequency: float | None


@dataclass(frozen=True)
class CriticalLoad:
    """First loss of stability of the elastic spectrum as the load grows from 0 to the largest of the question. All
    nondimensional.

    `load` and `frequency` are None where `kind` is "none"; `frequency` is ω ("flutter", 0 where the eigenvalue leaves
    λ = 0 as a growing pair) or 0 ("divergence"); `mode` (N,) complex are the generalised coordinates of the motion in
    the column's own functions, largest entry 1. `touches`: below it, or below the largest load, where the axis is
    touched and stability not lost. `question`: what was asked, with its column, modes, alpha, beta, and so on.
    """

    load: float | None
    kind: Kind
    frequency: float | None
    mode: Complex | None = field(repr=False, compare=False)
    touches: tuple[Touch, ...]
    question: Question
    search: Search = field(default=first_loss, repr=False, compare=False)
    """What found it, and finds `beam`."""
    manner: tuple[bool, float] | None = field(default=None, repr=False, compare=False)
    """How its problem counts what grows, where it is of any damping."""

    @cached_property
    def beam(self) -> BeamLoss | None:
        """The first loss of stability of the beam itself, as far as polynomials tell, computed when first asked for;
        None where series of growing N do not agree, or where the column has no polynomials."""
        polynomials = self.question.column.polynomials
        if polynomials is None:
            return None

        known = self

        def ask(modes: int, _: Any) -> Answers:
            nonlocal known
            asked = self.question.over(polynomials, modes)
            known = self if asked == self.question else known._of(asked) or answer(asked, self.search)
            return _as_arrays(known)

        try:
            found, change = beam_losses(ask, 1)
        except Unstable:  # of a longer series something grows at the smallest loads
            return None
        if math.isinf(change[0]):
            return None
        kind: Kind = KINDS[found.kind[0]]
        if kind == "none":
            return BeamLoss(None, kind, None, 0.0)
        load, frequency = float(found.load[0]), float(found.frequency[0])
        return BeamLoss(load, kind, frequency, float(change[0]) + self.rounding)

    def _of(self, question: Question) -> CriticalLoad | None:
        """The answer of another number of functions where the crossing goes over into one of theirs; else None."""
        if not question.column.general or self._crossing is None:
            return None
        found = question.general.followed(self._crossing, CONVERGED, self.manner)
        if found is None or found.load > question.load_max:
            return None
        load, frequency, mode = found.load, found.frequency, found.vector
        return replace(self, load=load, frequency=frequency, mode=mode, question=question)

    @property
    def _crossing(self) -> Crossing | None:
        if self.load is None or self.frequency is None or self.mode is None or self.kind == "none":
            return None
        return Crossing(self.load, self.frequency, self.mode, self.kind)

    @cached_property
    def rounding(self) -> float:
        """By how much `load` may be off, relative, for the rounding of its matrices; 0 where there is no load."""
        return 0.0 if self._crossing is None else self.question.problem.rounding(self._crossing)

    @cached_property
    def gradient(self) -> dict[str, float]:
        """Derivatives of `load` by alpha, beta and the column's own parameters, by name: from the left and right null
        vectors at the crossing, and central differences of the matrices. nan where there is none: by a damping where
        two frequencies meet or damping vanishes. Raises InputError where there is no load.
        """
        return {name: self.derivative(name)[0] for name in (*self.question.column.damping, *self.question.parameters)}

    def derivative(self, parameter: str) -> tuple[float, float]:
        """Derivatives of `load` and of `frequency` by alpha, beta or one of the column's own parameters, as `gradient`
        has them. Raises InputError where there is no load, and for a parameter that the column has not."""
        q, P = self.question, self.load
        if P is None or self.frequency is None:
            raise InputError(
                f"load_max = {q.load_max:g}: no load is found up to there that has a derivative; take a larger load_max"
            )
        if parameter not in q.values:
            raise q.column.no_such(parameter)
        if q.kappa is not None and parameter in ("alpha", "beta"):
            return math.nan, math.nan
        low, high = (value := q.values[parameter]), value + 1  # C is linear in alpha and beta
        if parameter in q.parameters:
            h = 1e-5 * max(abs(value), 1e-2)  # the crack's place, N = 16: off by 2e-10; by 2e-8 with ten times as much
            low, high = value - h, value + h
        if (at := self._crossing) and at.frequency and q.kappa is not None and q.general.perturbed:
            ends = [replace(q, parameters={**q.parameters, parameter: x}).general.near(at) for x in (low, high)]
            a, b = (np.array([c.load, c.frequency] if c else [math.nan] * 2) for c in ends)
            load, frequency = ((b - a) / (high - low)).tolist()
            return load, frequency
        still = {"alpha": 0.0, "beta": 0.0} if q.kappa is not None and not self.frequency else {}
        terms, *beside = (q.coefficients(**{**still, parameter: x}) for x in (value, low, high))
        M, C, K = ((b - a) / (high - low) for a, b in zip(*(x.at(P) for x in beside), strict=True))
        try:
            return crossing_derivative(self.frequency, terms.at(P), terms.slope.at(P), (M, C, K), q.kappa is not None)
        except InputError:
            return math.nan, math.nan

    @property
    def error(self) -> float | None:
        """Estimated error of `load` against the beam itself, relative to the beam's load; None where there is no load
        to compare, of the series or of the beam."""
        error = float(self._verdict[0][0])
        return None if math.isnan(error) else error

    @property
    def converged(self) -> bool:
        """Whether the beam itself loses stability alike: of the same kind, and the error is at most 1e-3."""
        return bool(self._verdict[1][0])

    @cached_property
    def _verdict(self) -> tuple[Real, NDArray[np.bool_]]:
        beam = self.beam
        uncertainty = np.array([math.inf if beam is None else beam.uncertainty])
        return judge(_as_arrays(self), _as_arrays(beam or self), uncertainty)


def _as_arrays(found: CriticalLoad | BeamLoss) -> Answers:
    """The answer as arrays of one point."""
    load, frequency = (np.array([math.nan if x is None else x]) for x in (found.load, found.frequency))
    return Answers(load, frequency, np.array([KINDS.index(found.kind)], dtype=np.int8))


def critical_load(
    column: Column,
    modes: int | None = None,
    alpha: float = 0.0,
    beta: float = 0.0,
    *,
    load_max: float = 1000.0,
    kappa: float | None = None,
    **parameters: float,
) -> CriticalLoad:
    """First loss of stability of `column` at N = `modes` as its load grows from 0 to `load_max`. Section 3.2,
    Eqs. (24)-(25).

    `alpha`, `beta`: internal and external damping, Eq. (5). Without damping, flutter is the coalescence of two
    frequencies. The limit of vanishing damping is another question, whose answer hangs on the ratio β/α: ask it
    with alpha = beta = 0 and `kappa` = β/α (0 for internal damping alone, math.inf for external alone).
    `parameters` are the column's own. Everything is nondimensional. Raises InputError for bad values, or where
    the column is not stable without load.
    """
    return answer(Question.of(column, modes, alpha, beta, load_max=load_max, kappa=kappa, **parameters))


def answer(question: Question, search: Search = first_loss) -> CriticalLoad:
    """The first loss of stability that a question asks for. Raises InputError, as `critical_load` does."""
    problem = question.problem
    outcome = search(problem, question.load_max)
    touches = tuple(Touch(t.load, None if math.isnan(t.frequency) else t.frequency) for t in outcome.touches)
    manner = problem.manner if isinstance(problem, General) else None
    found = outcome.crossing
    if found is None:
        return CriticalLoad(None, "none", None, None, touches, question, search, manner)
    return CriticalLoad(found.load, found.kind, found.frequency, found.vector, touches, question, search, manner)
