"""What the lesson says of a column in numbers, each computed when it is first asked for."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from freebeam.proofs import enclosed_load
from freebeam_sym.checks import InputError
from freebeam_sym.question import Question
from freebeam_sym.spectra import spectrum
from freebeam_sym.stability.critical import CriticalLoad, answer

if TYPE_CHECKING:
    from freebeam.proofs import Certified
    from freebeam_sym.columns import Column
    from freebeam_sym.stability.pencil import Pencil

__all__ = ["MODES", "Facts"]

MODES = 8
"""Modes of the paper's series, section 3.2."""


@dataclass(frozen=True)
class Facts:
    """Numbers of a column, its own parameters at their defaults. polynomials: the same column over polynomials."""

    column: Column
    polynomials: Column

    @cached_property
    def question(self) -> Question:
        """The paper's number of modes, without damping."""
        return Question.of(self.column, MODES)

    @cached_property
    def critical(self) -> CriticalLoad:
        """Without damping."""
        return answer(self.question)

    @property
    def flutters(self) -> bool:
        return self.critical.kind == "flutter"

    @property
    def load(self) -> float:
        """The undamped critical load. Raises InputError where there is none."""
        if self.critical.load is None:
            raise InputError(f"{self.column.name}: is stable up to P = {self.question.load_max:g}")
        return self.critical.load

    @property
    def frequency(self) -> float:
        return float(self.critical.frequency or 0.0)

    def limit(self, kappa: float) -> CriticalLoad:
        """The limit of vanishing damping at β = κα."""
        return answer(Question.of(self.column, MODES, kappa=kappa))

    def damped(self, alpha: float, beta: float) -> CriticalLoad:
        """With damping; a damping that the column does not state is left at zero."""
        known = self.column.damping
        given = {"alpha": alpha, "beta": beta}
        return answer(self.question.at(**{name: value for name, value in given.items() if name in known}))

    @cached_property
    def exact(self) -> Certified | str:
        """The beam itself, undamped, or why it is not enclosed."""
        try:
            return enclosed_load(self.column, digits=12)
        except InputError as error:
            return str(error)

    @cached_property
    def pencil(self) -> Pencil:
        return self.question.pencil

    def squares(self, load: float) -> Any:
        """ω² of the undamped column at a load, ascending in the real part, (N,) complex."""
        p = self.pencil
        found = np.linalg.eigvals(np.diag(p.e) + load * p.H).astype(complex)
        return found[np.lexsort((found.imag, found.real))]

    def pair(self, load: float) -> tuple[complex, complex]:
        """The two ω² that meet at the critical load, below or above it."""
        s = self.squares(load)
        near = s[np.argsort(np.abs(s - self.frequency**2))[:2]]
        a, b = sorted((complex(v) for v in near), key=lambda v: (v.real, v.imag))
        return a, b

    def overlap(self, load: float) -> float:
        """|cosine| of the angle between the two shapes that meet, in the norm of the mass: 1 where they are one."""
        p = self.pencil
        values, vectors = np.linalg.eig(np.diag(p.e) + load * p.H)
        a, b = np.argsort(np.abs(values - self.frequency**2))[:2]
        u, v = vectors[:, a], vectors[:, b]
        return float(abs(np.vdot(u, v)) / np.linalg.norm(u) / np.linalg.norm(v))

    def growth(self, load: float, alpha: float = 0.0, beta: float = 0.0) -> float:
        """Largest real part of an eigenvalue at a load."""
        return spectrum(self.question.at(alpha=alpha, beta=beta).system(load)).growth_rate

    def ritz(self, modes: int, basis: str = "modes") -> float | None:
        """The undamped critical load at a number of functions; None where another kind of loss comes first."""
        try:
            found = answer(Question.of(self.column if basis == "modes" else self.polynomials, modes))
        except InputError:
            return None
        return found.load if found.kind == self.critical.kind else None

    @cached_property
    def beam_load(self) -> float | None:
        """The beam's own critical load, to a float."""
        if isinstance(self.exact, str) or self.exact.load is None:
            return None
        low, high = self.exact.load
        return (float(low) + float(high)) / 2

    @cached_property
    def circulatory(self) -> float:
        """Size of the part of H that is not symmetric, relative to H."""
        H = self.pencil.H
        return float(np.abs(H - H.T).max() / np.abs(H).max())
