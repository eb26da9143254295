"""Critical loads: what `crossings.py` finds for a column, with its error against the beam itself. Section 3.2."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from freebeam_sym.checks import LARGEST, InputError, computable, nonnegative, positive
from freebeam_sym.columns import is_column
from freebeam_sym.convergence import BeamLoss, beam_losses, judge
from freebeam_sym.crossings import LIGHTEST_SCAN, FirstLoss, first_loss, polished, rounding
from freebeam_sym.grids import KINDS, Answers
from freebeam_sym.pencil import Complex, Crossing, Damping, Kind, Pencil, Real, pencil_of
from freebeam_sym.surface import surface_of

if TYPE_CHECKING:
    from freebeam_sym.columns import Column

__all__ = ["CriticalLoad", "Touch", "critical_load"]


class Touch(NamedTuple):
    """A load at which an eigenvalue comes to the imaginary axis and goes back, no loss of stability; nondimensional.
    frequency: 0 where K is singular there."""

    load: float
    frequency: float


@dataclass(frozen=True)
class CriticalLoad:
    """First loss of stability of the elastic spectrum as the load grows from 0 to `load_max`. All nondimensional.

    `load` and `frequency` are None where `kind` is "none"; `frequency` is ω ("flutter", 0 where the eigenvalue leaves
    λ = 0 as a growing pair) or 0 ("divergence"); `mode` (N,) complex are the generalised coordinates of the motion in
    the column's own modes, largest entry 1. `touches`: below it, or below `load_max`, where the axis is touched and
    stability not lost. `kappa` is the ratio β/α of a limit of vanishing damping, None where none was asked for.
    """

    load: float | None
    kind: Kind
    frequency: float | None
    mode: Complex | None = field(repr=False, compare=False)
    modes: int
    alpha: float
    beta: float
    load_max: float
    kappa: float | None = None
    touches: tuple[Touch, ...] = ()
    column: Column = field(kw_only=True, repr=False, compare=False)
    parameters: Mapping[str, float] = field(kw_only=True)

    @cached_property
    def beam(self) -> BeamLoss | None:
        """The first loss of stability of the beam itself, as far as polynomials tell, computed when first asked for;
        None where series of growing N do not agree, or where the column has no polynomials."""
        polynomials = self.column.polynomials
        if polynomials is None:
            return None

        def ask(modes: int, _: object) -> Answers:
            more = critical_load(
                polynomials,
                modes,
                self.alpha,
                self.beta,
                load_max=self.load_max,
                kappa=self.kappa,
                **self.parameters,
            )
            return _as_arrays(more)

        found, change = beam_losses(ask, 1)
        if math.isinf(change[0]):
            return None
        kind: Kind = KINDS[found.kind[0]]
        if kind == "none":
            return BeamLoss(None, kind, None, 0.0)
        load, frequency = float(found.load[0]), float(found.frequency[0])
        return BeamLoss(load, kind, frequency, float(change[0]) + self.rounding)

    @cached_property
    def rounding(self) -> float:
        """By how much `load` may be off, relative, for the rounding of its matrices; 0 where there is no load."""
        if self.load is None or self.frequency is None or self.mode is None or self.kind == "none":
            return 0.0
        pencil, c_E, c_M, ratio = _posed(self.column, self.modes, self.alpha, self.beta, self.kappa, self.parameters)
        crossing = Crossing(self.load, self.frequency, self.mode, self.kind)
        return rounding(pencil, Damping.of(pencil.e, c_E, c_M, ratio), crossing)

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
    is_column(column)
    modes = column.number(modes)
    alpha, beta = column.dampings(alpha, beta)
    load_max = computable("load_max", positive("load_max", load_max, "largest load to look at"))
    pencil, c_E, c_M, ratio = _posed(column, modes, alpha, beta, kappa, parameters)
    outcome = _settled(pencil, c_E, c_M, load_max, ratio)
    found = outcome.crossing
    return CriticalLoad(
        None if found is None else found.load,
        "none" if found is None else found.kind,
        None if found is None else found.frequency,
        None if found is None else found.vector,
        modes,
        alpha,
        beta,
        load_max,
        None if kappa is None else float(kappa),
        tuple(Touch(touch.load, touch.frequency) for touch in outcome.touches),
        column=column,
        parameters=dict(parameters),
    )


def _posed(
    column: Column, modes: int, alpha: float, beta: float, kappa: float | None, parameters: Mapping[str, float]
) -> tuple[Pencil, float, float, float | None]:
    """What `critical_load` asks, as `first_loss` takes it: a pencil and its damping C = c_E E + c_M M, or the ratio
    kappa = c_M / c_E of a limit. Raises InputError."""
    if kappa is not None:
        if not (isinstance(kappa, float) and math.isinf(kappa) and kappa > 0):
            kappa = nonnegative("kappa", kappa, "ratio beta/alpha of vanishing damping; math.inf is allowed")
            computable("kappa", kappa)
        if alpha or beta:
            raise InputError(
                f"kappa = {kappa}: is the limit of vanishing damping; alpha and beta must be 0, not {alpha} and {beta}"
            )
    pencil = pencil_of(*column.matrices(modes, False, **parameters))
    direction = (alpha, beta) if kappa is None else (0.0, 1.0) if math.isinf(kappa) else (1.0, kappa)
    c_M, c_E = column.damping_factors(*direction, **parameters)
    if not max(c_E, c_M) < LARGEST:  # its square times e must stay a float
        raise InputError(f"alpha = {alpha}, beta = {beta}: must be below 1e60 to be computed with")
    if kappa is None:
        return pencil, c_E, c_M, None
    return pencil, 0.0, 0.0, c_M / c_E if c_E else math.inf


def _settled(pencil: Pencil, alpha: float, beta: float, load_max: float, kappa: float | None = None) -> FirstLoss:
    """As `first_loss`, from the pencil's surface where it has been asked for often enough."""
    if (alpha > 0 or beta > 0) and min(alpha, beta) >= 0 and not pencil.conservative:
        damping = Damping.of(pencil.e, alpha, beta, kappa)
        settled, found = _tabulated(pencil, damping, alpha, beta, load_max)
        if settled:
            top = load_max if found is None else found.load
            return FirstLoss(found, tuple(x.crossing for x in pencil.divergences if x.crossing.load < top))
    return first_loss(pencil, alpha, beta, load_max, kappa)


def _tabulated(
    pencil: Pencil, damping: Damping, alpha: float, beta: float, load_max: float
) -> tuple[bool, Crossing | None]:
    """Whether the pencil's surface settles this damping, and what it says."""
    surface = surface_of(pencil, load_max)
    point = surface.point(alpha, beta)
    if point is None:
        return False, None
    P, omega = point
    if not P < min(surface.divergence, load_max * (1 + 1e-9)):
        return True, surface.first_divergence if surface.divergence <= load_max else None
    light = damping.size < 1e-4 * math.sqrt(pencil.e[0])
    scan = max(damping.size, LIGHTEST_SCAN * math.sqrt(pencil.e[0]))
    D = 1j * scan * damping.shape
    A = P * pencil._relative + np.diag(1 + omega * (D - omega) / pencil.e)
    try:
        B = np.linalg.inv(A)
    except np.linalg.LinAlgError:
        return False, None
    v = B @ B.sum(axis=1)
    v = v / np.sqrt(pencil.e) / np.abs(v).max()
    if light:
        found = polished(pencil, damping, scan, omega, P, np.asarray(v))
    else:  # one more step of Newton's method for det A = 0, as the surface was made
        a, b = (B * pencil._relative.T).sum(), (B.diagonal() * ((D - 2 * omega) / pencil.e)).sum()
        share = 1 / float((a * b.conj()).imag)
        found = Crossing(P + float(b.imag) * share, omega - float(a.imag) * share, pencil.vector(v), "flutter")
    if found is None or not abs(found.load - P) < 1e-8 * P:
        return False, None
    return True, found if found.load <= load_max else None
