"""What the stages hand on: all that follows from a column's statement, as data. pipeline.py makes it."""

from __future__ import annotations

from dataclasses import dataclass

from freebeam_derive.comparison import ComparisonBeam, DampedModes
from freebeam_derive.forms import GeneralSystem
from freebeam_derive.newmark import Newmark
from freebeam_derive.record import Step
from freebeam_derive.ritz import RitzSystem
from freebeam_derive.statement import Column
from freebeam_derive.variation import EquationOfMotion


@dataclass(frozen=True)
class Derivation:
    """All that follows from a column's statement, before a line of code is written.

    scaling: the steps of Eq. (5). damped: None where damping changes the modes' shapes.
    """

    column: Column
    scaling: tuple[Step, ...]
    motion: EquationOfMotion
    system: RitzSystem
    beam: ComparisonBeam
    damped: DampedModes | None
    newmark: Newmark


@dataclass(frozen=True)
class GeneralDerivation:
    """What follows from the statement of a column beyond the textbook's: fields, segments, points, any damping."""

    column: Column
    scaling: tuple[Step, ...]
    motion: EquationOfMotion
    system: GeneralSystem
    newmark: Newmark
