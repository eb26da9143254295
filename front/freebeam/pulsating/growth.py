"""Where motion grows under a load that pulsates, P (1 + ε cos Ωt): Floquet's multipliers, and regions of (Ω, ε).

The multipliers are the eigenvalues of the monodromy matrix: motion grows where one lies outside the unit circle.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from freebeam.maps.arrays import record
from freebeam.maps.labelled import labels, program
from freebeam.pulsating.monodromy import KNOWN, Pulsating, monodromy
from freebeam_sym.checks import InputError, computable, count, finite, nonnegative, reals, refusal
from freebeam_sym.columns import Column
from freebeam_sym.question import Question
from freebeam_sym.stability.problem import Complex, Real

if TYPE_CHECKING:
    import xarray

__all__ = ["KINDS", "PulsatingRegion", "PulsatingRegions", "grid", "judged", "pulse"]

KINDS = ("stable", "principal-2T", "principal-T", "combination")
"""What the numbers of `PulsatingRegions.kind` stand for: the multiplier that grows most is below −1 (the motion has
twice the load's period T), above 1 (the load's own period), or one of a complex pair (two frequencies)."""
GROWN = 1e-6
"""Growth in a period, ln |multiplier|, up to which nothing grows: where two multipliers meet on the unit circle, an
error of 1e-12 of the matrix moves them by its root."""
MOST_POINTS = 4_000_000
"""Points of a grid up to which is computed."""
CHECKED = 5
"""Frequencies at which the error is measured."""
BISECTIONS = 44
"""Halvings of a distance of two frequencies, to rounding."""


class Growth(NamedTuple):
    """Arrays of one shape: growth ln |multiplier| in a period of the multiplier that is largest, that multiplier
    (infinite where it is beyond a float), and the number of its kind in KINDS, int8."""

    growth: Real
    multiplier: Complex
    kind: NDArray[np.int8]


def judged(problem: Pulsating, load: float, frequency: float, amplitudes: Real) -> Growth:
    """How motion grows in a period at a frequency and amplitudes (m,). Raises InputError as `monodromy` does."""
    U, logarithm = monodromy(problem, load, frequency, amplitudes)
    values = np.linalg.eigvals(U).astype(complex)
    largest = values[np.arange(len(values)), np.abs(values).argmax(axis=1)]
    with np.errstate(over="ignore", invalid="ignore"):
        growth = np.log(np.abs(largest)) + logarithm
        real, imag = (
            np.where(part == 0, 0.0, part * np.exp(logarithm)) for part in (largest.real, np.abs(largest.imag))
        )
    multiplier = np.empty(len(largest), dtype=complex)
    multiplier.real, multiplier.imag = real, imag
    # of a pair, the upper; a double real one, which rounding has parted, is real
    alone = np.abs(largest.imag) <= GROWN * np.abs(largest)
    kind = np.where(alone, np.where(largest.real < 0, 1, 2), 3)
    grows = growth > threshold(problem, load, frequency)
    return Growth(growth, multiplier, np.where(grows, kind, 0).astype(np.int8))


def threshold(problem: Pulsating, load: float, frequency: float) -> float:
    """Growth in a period from which on motion is said to grow, for what is known of a multiplier: with damping the two
    that meet have parted by what the damping takes in a period before one of them grows."""
    decay = -float(np.linalg.eigvals(problem.state(load)).real.max()) * 2 * math.pi / frequency
    return max(10 * KNOWN, min(GROWN, KNOWN / decay)) if decay > 0 else GROWN


class PulsatingRegion(NamedTuple):
    """An interval of Ω in which motion grows at one amplitude: its ends, None where it goes beyond the frequencies
    looked at, its kind of KINDS, and the largest growth in a period that was found in it. Nondimensional."""

    low: float | None
    high: float | None
    kind: str
    growth: float


class Centre(NamedTuple):
    """A frequency Ω about which a region lies when ε and damping are small: 2ω_j/k or (ω_i ± ω_j)/k, as `label` says
    in LaTeX; combination: of two modes. k is the order: the width of a region falls as ε^k."""

    frequency: float
    label: str
    combination: bool
    k: int


@dataclass(frozen=True)
class PulsatingRegions:
    """Where the motion of a column grows under the load P (1 + ε cos Ωt), over a grid of Ω and ε. All nondimensional.

    `frequency` (n,) are Ω, `amplitude` (m,) are ε. Arrays (n, m): `growth`, ln |multiplier| in a period T = 2π/Ω of the
    multiplier that is largest; that `multiplier`, complex, Im ≥ 0; `kind`, numbers of KINDS. `error`: by how much a
    monodromy matrix changes, relative to its norm, when its steps are less than half as long; the largest of some
    frequencies at the largest amplitude. `question`: what was asked, at `load` P.

    A region that is narrower than the grid's step may lie between its points. Where the motion grows
    under the constant load P already (`constant_grows`), its flutter is a "combination" too, its divergence a
    "principal-T".
    """

    question: Question
    load: float
    frequency: Real
    amplitude: Real
    growth: Real
    multiplier: Complex
    kind: NDArray[np.int8]
    error: float

    @property
    def rate(self) -> Real:
        """Growth in a unit of time, Ω/2π times that in a period, (n, m)."""
        return self.growth * self.frequency[:, None] / (2 * math.pi)

    @cached_property
    def problem(self) -> Pulsating:
        """What moves, as the integrator sees it."""
        return Pulsating.of(self.question)

    @cached_property
    def eigenvalues(self) -> Complex:
        """λ under the constant load P, (2N,), sorted by |Im λ|."""
        values = np.linalg.eigvals(self.problem.state(self.load)).astype(complex)
        return values[np.lexsort((values.real, np.abs(values.imag)))]

    @property
    def constant_grows(self) -> bool:
        """Whether motion grows under the constant load P already."""
        values = self.eigenvalues
        return bool((values.real > 1e-9 * np.maximum(np.abs(values), 1.0)).any())

    def centres(self) -> tuple[Centre, ...]:
        """Where small regions lie within the frequencies looked at, of k = 1 and 2, ascending."""
        omega = sorted({float(x) for x in self.eigenvalues.imag if x > 0})
        found = [Centre(w, f"$\\omega_{j}$", False, 2) for j, w in enumerate(omega, 1)]
        found += [Centre(2 * w, f"$2\\omega_{j}$", False, 1) for j, w in enumerate(omega, 1)]
        for j, w in enumerate(omega, 1):
            for i, v in enumerate(omega[: j - 1], 1):
                for total, text in ((w + v, f"\\omega_{i}+\\omega_{j}"), (w - v, f"\\omega_{j}-\\omega_{i}")):
                    found += [Centre(total, f"${text}$", True, 1), Centre(total / 2, f"$({text})/2$", True, 2)]
        low, high = self.frequency[0], self.frequency[-1]
        return tuple(sorted(centre for centre in found if low <= centre.frequency <= high))

    def at(self, amplitude: float) -> tuple[PulsatingRegion, ...]:
        """The regions at one amplitude, ascending, their ends found by bisection between the frequencies of the grid.

        Where the column is damped an end is where a multiplier leaves the unit circle; without damping, where growth in
        a period passes 1e-6. Raises InputError for an amplitude below 0.
        """
        eps = np.array([nonnegative("amplitude", amplitude, "share of the load that pulsates")])
        known = np.flatnonzero(self.amplitude == eps)

        def look(frequency: float) -> tuple[int, float]:
            found = judged(self.problem, self.load, frequency, eps)
            return int(found.kind[0]), float(found.growth[0])

        if len(known):
            column = known[0]
            seen = list(zip(self.kind[:, column].tolist(), self.growth[:, column].tolist(), strict=True))
        else:
            seen = [look(w) for w in self.frequency.tolist()]
        regions: list[PulsatingRegion] = []
        low: float | None = None
        first = 0
        for k in range(1, len(seen) + 1):
            if k < len(seen) and seen[k][0] == seen[first][0]:
                continue
            kind = seen[first][0]
            high = None if k == len(seen) else _end(look, kind, *self.frequency[k - 1 : k + 1].tolist())
            if kind:
                regions.append(PulsatingRegion(low, high, KINDS[kind], max(growth for _, growth in seen[first:k])))
            low, first = high, k
        return tuple(regions)

    def table(self) -> dict[str, Any]:
        """The grid by name, (n, m) each: growth, multiplier_real, multiplier_imag, kind."""
        real, imag = self.multiplier.real, self.multiplier.imag
        kind = np.array(KINDS)[self.kind]
        return {"growth": self.growth, "multiplier_real": real, "multiplier_imag": imag, "kind": kind}

    def dataset(self) -> xarray.Dataset:
        """The grid with labels and settings, as `stability_map` has them; `kind` as numbers. Raises InputError without
        xarray (the extra "maps")."""
        question, values = self.question, self.question.values
        flags = {"flag_values": np.arange(len(KINDS), dtype=np.int8), "flag_meanings": " ".join(KINDS)}
        said: dict[str, tuple[str, dict[str, Any]]] = {
            "growth": ("growth in a period, ln |multiplier|", {}),
            "multiplier_real": ("largest multiplier, real part", {}),
            "multiplier_imag": ("largest multiplier, imaginary part", {}),
            "kind": ("kind of the growth", flags),
        }
        columns: dict[str, Any] = self.table() | {"kind": self.kind}
        axes = {"frequency": "frequency of the pulsation", "amplitude": "amplitude of the pulsation"}
        settings = {
            "title": f"Motion of the column {question.column.name} under the load P (1 + amplitude cos(frequency t))",
            **{name: value for name, value in record(question).items() if name != "load_max"},
            "column_title": question.column.title,
            "load": self.load,
            **values,
            "error": self.error,
            "fixed": " ".join(values),
            "units": "nondimensional, Eq. (5)",
            "source": f"freebeam {program()}",
        }
        held = {
            x: (list(axes), columns[x], {"long_name": text, "units": "1", **more}) for x, (text, more) in said.items()
        }
        coordinates = {x: (x, getattr(self, x), {"long_name": text, "units": "1"}) for x, text in axes.items()}
        labelled: xarray.Dataset = labels().Dataset(held, coordinates, settings)
        return labelled


def _end(look: Callable[[float], tuple[int, float]], kind: int, low: float, high: float) -> float:
    """Where a kind that is found at `low` ends before `high`, by bisection."""
    for _ in range(BISECTIONS):
        middle = (low + high) / 2
        if not low < middle < high:
            break
        if look(middle)[0] == kind:
            low = middle
        else:
            high = middle
    return (low + high) / 2


def pulse(
    column: Column,
    modes: int | None = None,
    alpha: float = 0.0,
    beta: float = 0.0,
    *,
    load: float,
    frequency: ArrayLike,
    amplitude: ArrayLike,
    step: Callable[[float], None] | None = None,
    **parameters: float,
) -> PulsatingRegions:
    """Where the motion of `column` grows under a load P (1 + ε cos Ωt), P = `load`, over a grid of Ω and ε.

    frequency: Ω, one number or ascending ones (n,), greater than 0; amplitude: ε, one or ascending ones (m,), 0 or
    greater; everything is nondimensional. Above ε = 1 the load changes its sign. The rest as in `critical_load`.
    `step` is told which part of the work is done, 0 to 1.

    >>> import freebeam as fb
    >>> column = fb.column("euler-pinned")
    >>> found = fb.pulse(column, beta=0.1, load=3, frequency=[15, 16.5, 18], amplitude=[0, 0.3])
    >>> found.kind.tolist()  # about twice the first frequency, 16.46
    [[0, 0], [0, 1], [0, 0]]

    Raises InputError for bad values, for load 0, which does not pulsate, for a frequency so low that its period takes
    too many steps, and where the column is not stable without load.
    """
    question = Question.of(column, modes, alpha, beta, **parameters)
    return grid(question, load, frequency, amplitude, step)


def grid(
    question: Question,
    load: float,
    frequency: ArrayLike,
    amplitude: ArrayLike,
    step: Callable[[float], None] | None = None,
) -> PulsatingRegions:
    """The regions of a question; all else as in `pulse`."""
    load = computable("load", finite("load", load, "nondimensional load P"))
    if not load:
        raise refusal("load", load, "must differ from 0: the amplitude is a share of it")
    Omega, eps = _axis("frequency", frequency, "of the pulsation"), _axis("amplitude", amplitude, "share of the load")
    if not Omega[0] > 0:
        raise refusal("frequency", float(Omega[0]), "must be greater than zero", "Ω of the load P (1 + ε cos Ωt)")
    if eps[0] < 0:
        raise refusal("amplitude", float(eps[0]), "must be zero or greater", "ε of the load P (1 + ε cos Ωt)")
    count("points of the grid", len(Omega) * len(eps), 1, MOST_POINTS)
    problem = Pulsating.of(question)
    rows = []
    for k, w in enumerate(Omega.tolist(), 1):
        rows.append(judged(problem, load, w, eps))
        if step is not None:
            step(k / len(Omega))
    growth, multiplier, kind = (np.array(part) for part in zip(*rows, strict=True))
    return PulsatingRegions(
        question, load, Omega, eps, growth, multiplier, kind, _error(problem, load, Omega, eps[-1:])
    )


def _axis(name: str, values: ArrayLike, hint: str) -> Real:
    """Ascending values, (n,), one or more. Raises InputError."""
    found = np.atleast_1d(reals(name, values, hint))
    if found.ndim != 1 or not len(found) or (np.diff(found) <= 0).any():
        raise InputError(f"{name}: must be one number, or numbers that ascend, in a sequence of shape (n,) ({hint})")
    computable(name, float(np.abs(found).max()))
    return found


def _error(problem: Pulsating, load: float, frequencies: Real, amplitude: Real) -> float:
    """Largest change of a monodromy matrix with steps of less than half the size, relative to its norm."""
    places = np.unique(np.linspace(0, len(frequencies) - 1, CHECKED).round().astype(int))
    changes = []
    for w in frequencies[places].tolist():
        (U, size), (V, other) = (monodromy(problem, load, w, amplitude, finer) for finer in (False, True))
        changes.append(float(np.linalg.norm(U - V * np.exp(other - size)[:, None, None], axis=(1, 2)).max()))
    return max(changes)
