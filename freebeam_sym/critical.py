"""Critical loads: what `crossings.py` finds for a column, with a verdict on its convergence in N. Section 3.2."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from freebeam_sym.checks import InputError, count, nonnegative, positive
from freebeam_sym.crossings import LIGHTEST_SCAN, first_crossing, polished
from freebeam_sym.pencil import Complex, Crossing, Damping, Kind, Pencil, pencil_of
from freebeam_sym.surface import surface_of

if TYPE_CHECKING:
    from freebeam_sym.columns import Column

__all__ = ["Convergence", "CriticalLoad", "critical_load"]

LOAD_TOLERANCE = 1e-2
FREQUENCY_TOLERANCE = 5e-2
"""Relative changes from N to more modes up to which a critical load counts as converged in N."""


def more_modes(modes: int) -> int:
    """The number of modes at which convergence in N is judged."""
    return max(modes + 8, min(2 * modes, modes + 24))


@dataclass(frozen=True)
class Convergence:
    """The same question at more modes: `modes`, `load`, `kind`, `frequency` there, `change` = |load − load at N|
    / load (None where either has no load), and `converged`."""

    modes: int
    load: float | None
    kind: Kind
    frequency: float | None
    change: float | None
    converged: bool


@dataclass(frozen=True)
class CriticalLoad:
    """First loss of stability of the elastic spectrum as the load grows from 0 to `load_max`. All nondimensional.

    `load` and `frequency` are None where `kind` is "none"; `frequency` is ω ("flutter") or 0 ("divergence");
    `mode` (N,) complex are the generalised coordinates of the motion in the column's own modes, largest entry 1.
    `kappa` is the ratio β/α of a limit of vanishing damping, None where none was asked for.
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
    column: Column = field(kw_only=True, repr=False, compare=False)
    parameters: Mapping[str, float] = field(kw_only=True)

    @cached_property
    def convergence(self) -> Convergence:
        """Verdict on N, computed when first asked for, at min(2N, N + 24) modes but at least N + 8.

        Converged where the kind is the same, the load changes by LOAD_TOLERANCE at most and a flutter's frequency by
        FREQUENCY_TOLERANCE. Values of a non-self-adjoint Ritz series are no bounds; crossings that the truncation
        invents wander with N or are gone at more modes.
        """
        more = critical_load(
            self.column,
            more_modes(self.modes),
            self.alpha,
            self.beta,
            load_max=self.load_max,
            kappa=self.kappa,
            **self.parameters,
        )
        change = None
        converged = more.kind == self.kind
        if self.load is not None and more.load is not None:
            change = abs(more.load - self.load) / self.load
            converged = converged and change <= LOAD_TOLERANCE
            if self.frequency and more.frequency:
                converged = converged and abs(more.frequency / self.frequency - 1) <= FREQUENCY_TOLERANCE
        return Convergence(more.modes, more.load, more.kind, more.frequency, change, converged)

    @property
    def converged(self) -> bool:
        """Whether more modes give the same answer; see `convergence`."""
        return self.convergence.converged


def critical_load(
    column: Column,
    modes: int = 8,
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
    modes = count("modes", modes, hint="elastic functions in the series")
    alpha, beta = column.dampings(alpha, beta)
    load_max = positive("load_max", load_max, "largest load to look at")
    pencil, c_E, c_M, ratio = _posed(column, modes, alpha, beta, kappa, parameters)
    found = first_loss(pencil, c_E, c_M, load_max, ratio)
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
        column=column,
        parameters=dict(parameters),
    )


def _posed(
    column: Column, modes: int, alpha: float, beta: float, kappa: float | None, parameters: Mapping[str, float]
) -> tuple[Pencil, float, float, float | None]:
    """What `critical_load` asks, as `first_crossing` takes it: a pencil and its damping C = c_E E + c_M M, or the ratio
    kappa = c_M / c_E of a limit. Raises InputError."""
    if kappa is not None:
        if not (isinstance(kappa, float) and math.isinf(kappa) and kappa > 0):
            kappa = nonnegative("kappa", kappa, "ratio beta/alpha of vanishing damping; math.inf is allowed")
        if alpha or beta:
            raise InputError(
                f"kappa = {kappa}: is the limit of vanishing damping; alpha and beta must be 0, not {alpha} and {beta}"
            )
    pencil = pencil_of(*column.matrices(modes, False, **parameters))
    direction = (alpha, beta) if kappa is None else (0.0, 1.0) if math.isinf(kappa) else (1.0, kappa)
    c_M, c_E = column.damping_factors(*direction, **parameters)
    if not max(c_E, c_M) < 1e100:  # its square times e must stay a float
        raise InputError(f"alpha = {alpha}, beta = {beta}: must be below 1e100 to be computed with")
    if kappa is None:
        return pencil, c_E, c_M, None
    return pencil, 0.0, 0.0, c_M / c_E if c_E else math.inf


def first_loss(
    pencil: Pencil, alpha: float, beta: float, load_max: float, kappa: float | None = None
) -> Crossing | None:
    """As `first_crossing`, from the pencil's surface where it has been asked for often enough."""
    once = not pencil.kept
    pencil.kept["asked"] = True
    if (alpha > 0 or beta > 0) and min(alpha, beta) >= 0 and not pencil.conservative:
        damping = Damping.of(pencil.e, alpha, beta, kappa)
        settled, found = _tabulated(pencil, damping, alpha, beta, load_max)
        if settled:
            return found
    return first_crossing(pencil, alpha, beta, load_max, kappa, once=once)


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
        return True, pencil.divergence(surface.divergence) if surface.divergence <= load_max else None
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
        found = Crossing(P + float(b.imag) * share, omega - float(a.imag) * share, pencil.vector(v))
    if found is None or not abs(found.load - P) < 1e-8 * P:
        return False, None
    return True, found if found.load <= load_max else None
