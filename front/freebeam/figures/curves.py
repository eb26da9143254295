"""What the pictures show, as numbers: branches along the load, the tangent construction, a cycle of a motion.

Each function takes a question. Everything is nondimensional. Each result has a `table()`: its data by name.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from freebeam.loci import branches
from freebeam.maps.known import answer
from freebeam_sym.checks import InputError, Unstable, count, positive
from freebeam_sym.question import Question
from freebeam_sym.spectra import ROUNDING, spectrum
from freebeam_sym.stability.critical import CriticalLoad

if TYPE_CHECKING:
    from freebeam_sym.columns import Coefficients, System

__all__ = [
    "Coalescence", "CriticalCurve", "Cycle", "FrequencyLoad", "Locus", "Tangent",
    "coalescence", "critical_curve", "cycle", "frequency_load", "locus", "tangent",
]  # fmt: skip

Real = NDArray[np.float64]
Complex = NDArray[np.complex128]


def unstable(values: Complex) -> NDArray[np.bool_]:
    """Which of these eigenvalues grow, Re λ > 0 beyond rounding."""
    return np.asarray(values.real > ROUNDING * np.maximum(np.abs(values), 1.0))


@dataclass(frozen=True)
class Locus:
    """Eigenvalues followed along the load: `loads` (m,), `eigenvalues` (m, k), column j one branch, Im λ ≥ 0 at the
    first load. `critical` is the first loss of stability of the `question`, None where something grows at once.
    `reference` is λ₀ of Eq. (26), None where it says nothing.
    """

    loads: Real
    eigenvalues: Complex
    question: Question
    critical: CriticalLoad | None
    reference: float | None

    @property
    def unstable(self) -> NDArray[np.bool_]:
        """Which grow, (m, k)."""
        return unstable(self.eigenvalues)

    def scaled(self, normalised: bool) -> Complex:
        """λ, or λ/λ₀ as Eq. (26) has it. Raises InputError where λ₀ does not exist."""
        if not normalised:
            return self.eigenvalues
        return self.eigenvalues / self.scale(True)

    def scale(self, normalised: bool) -> float:
        """What the eigenvalues are divided by: λ₀ of Eq. (26), or 1. Raises InputError where λ₀ does not exist."""
        if normalised and self.reference is None:
            c = self.question
            raise InputError(
                f"alpha = {c.alpha:g}, beta = {c.beta:g}: mode 1 of the unloaded beam is overdamped, and Eq. (26) has "
                "no frequency to divide by; use normalised=False"
            )
        return self.reference if normalised and self.reference is not None else 1.0

    def table(self, normalised: bool = False) -> dict[str, Any]:
        """Columns P, Re and Im of each branch, and whether it grows (1) or not (0)."""
        values = self.scaled(normalised)
        found: dict[str, Any] = {"P": self.loads}
        for k in range(values.shape[1]):
            found[f"Re_lambda_{k + 1}"], found[f"Im_lambda_{k + 1}"] = values[:, k].real, values[:, k].imag
            found[f"unstable_{k + 1}"] = self.unstable[:, k].astype(int)
        return found


def locus(question: Question, loads: ArrayLike | None = None, *, count: int = 2, points: int = 240) -> Locus:
    """The first `count` eigenvalues along the load, each followed by continuity. Eqs. (24), (25). Of a pair that has
    become real the one that decays least is shown.

    loads: (m,), or the largest load, or None for a quarter beyond the critical load, with damping or without; where
    no sequence is given the loads lie closer near the critical one, which has a root there. Raises InputError for bad
    values.
    """
    q = question
    critical = first_loss(q)
    undamped = first_loss(q.at(alpha=0.0, beta=0.0)) if loads is None and (q.alpha or q.beta) else critical
    P = _loads(q, loads, points, [x.load for x in (critical, undamped) if x and x.load])
    values: dict[str, Any] = q.values
    followed = branches(q.column, P, q.modes, **values)
    start = followed.eigenvalues[0]
    # those that swing or grow, by |λ|, which is the mode's undamped frequency; then the overdamped, whose Im λ is 0
    still = np.abs(start.imag) <= 1e-12 * np.abs(start)
    order = np.lexsort((np.abs(start), still & ~unstable(start)))
    kept = order[(start.imag >= 0)[order] | still[order]][: _branches(count, q.modes)]
    shown = followed.eigenvalues[:, kept].copy()
    for k, branch in enumerate(kept):
        if not still[branch]:
            mirrored = followed.eigenvalues[:, np.abs(start - start[branch].conj()).argmin()].conj()
            shown[:, k] = np.where(mirrored.real > shown[:, k].real, mirrored, shown[:, k])
    shown.imag = np.abs(shown.imag)  # of a pair that comes to swing, or swings again, the upper one
    reference = spectrum(q.system(0.0)).reference_frequency
    return Locus(P, shown, q, critical, reference)


def first_loss(question: Question) -> CriticalLoad | None:
    """The first loss of stability; None where something grows at the smallest loads."""
    try:
        return answer(question)
    except Unstable:
        return None


def _branches(wanted: int, modes: int) -> int:
    return count("count", wanted, 1, modes, "branches to draw, no more than modes")


def _loads(question: Question, loads: ArrayLike | None, points: int, critical: list[float]) -> Real:
    """critical: loads that are critical, the question's own first."""
    if loads is not None and np.ndim(loads):
        P = np.asarray(loads, dtype=float)
        if P.ndim != 1 or len(P) < 2 or not np.isfinite(P).all():
            raise InputError(f"loads = {loads!r:.60}: must be two or more finite numbers, or the largest load")
        return P
    if loads is not None:
        top = positive("loads", loads, "the largest load")
    elif critical:
        top = 1.25 * max(critical)
    else:
        raise InputError(
            f"loads: {question.column.name} has no critical load up to P = {question.load_max:g}; give the largest "
            "load to draw"
        )
    P = np.linspace(0.0, top, points)
    for load in critical[:1]:
        near = np.geomspace(1e-9, 0.05, 18)
        P = np.concatenate([P, load * (1 - near), load * (1 + near)])
    return np.unique(P[P <= top])


@dataclass(frozen=True)
class FrequencyLoad:
    """Squared frequencies s = ω² of the undamped column along the load: `loads` (m,), `squares` (m, k) complex, each
    column one branch. Real as long as the branch is a free vibration; `critical` is the undamped critical load, None
    where something grows at once."""

    loads: Real
    squares: Complex
    critical: CriticalLoad | None

    @property
    def unstable(self) -> NDArray[np.bool_]:
        """Where a branch is no vibration that stays bounded, (m, k): s complex, or negative."""
        size = np.maximum(np.abs(self.squares), 1.0)
        return np.asarray((np.abs(self.squares.imag) > 1e-9 * size) | (self.squares.real < -1e-9 * size))

    def table(self) -> dict[str, Real]:
        """Columns P, real and imaginary part of ω² of each branch."""
        found = {"P": self.loads}
        for k, s in enumerate(self.squares.T):
            found[f"Re_omega2_{k + 1}"], found[f"Im_omega2_{k + 1}"] = s.real, s.imag
        return found


def frequency_load(
    question: Question, loads: ArrayLike | None = None, *, count: int = 2, points: int = 240
) -> FrequencyLoad:
    """ω²(P) of the first `count` frequencies of a question without damping. `loads` as `locus` has them."""
    found = locus(question, loads, count=count, points=points)
    return FrequencyLoad(found.loads, -(found.eigenvalues**2), found.critical)


@dataclass(frozen=True)
class Tangent:
    """The tangent rule: vanishing damping at β/α = κ destabilises where P s′(P) − s(P) = κ, that is, where the tangent
    to s = ω²(P) meets P = 0 at −κ. `load`, `square`: that point; `slope`: s′ there; `limit`: the critical load of
    vanishing damping; `curves`: the undamped branches, whose critical load is the coalescence.
    """

    curves: FrequencyLoad
    limit: CriticalLoad
    kappa: float
    load: float
    square: float
    slope: float

    @property
    def drop(self) -> float:
        """What vanishing damping takes from the undamped critical load, as a share of it."""
        critical = self.curves.critical
        return 1 - self.load / float((critical and critical.load) or math.nan)

    def line(self, loads: ArrayLike) -> Real:
        """The tangent at these loads."""
        return np.asarray(self.square + self.slope * (np.asarray(loads, dtype=float) - self.load))

    def table(self) -> dict[str, Real]:
        """The curves' columns, and the tangent's."""
        return {**self.curves.table(), "tangent": self.line(self.curves.loads)}


def tangent(question: Question, points: int = 240) -> Tangent:
    """The construction of the critical load of vanishing damping, a question with kappa, on the undamped curve ω²(P).

    Raises InputError where the column does not flutter, for κ = ∞, whose point is the coalescence itself, and where
    damping is not of the form C = c_M M + c_E E or the load enters beyond K = E + P H, so that there is no such rule.
    """
    column, kappa = question.column, question.kappa or 0.0
    if not kappa < math.inf:
        raise InputError(f"kappa = {kappa}: must be finite (external damping alone leaves the coalescence where it is)")
    c_M, c_E = _proportions(question, kappa)
    if not c_E:
        raise InputError(f"{column.name}: states no internal damping, so there is no limit of it to construct")
    curves = frequency_load(replace(question, kappa=None), points=points)
    limit = answer(question)
    if curves.critical is None or curves.critical.kind != "flutter" or limit.load is None or not limit.frequency:
        raise InputError(f"{column.name}: does not flutter, so there is no coalescence and no tangent to draw")
    square = limit.frequency**2
    return Tangent(curves, limit, c_M / c_E, limit.load, square, (square + c_M / c_E) / limit.load)


def _proportions(question: Question, kappa: float) -> tuple[float, float]:
    """c_M and c_E of the damping C = c_M M + c_E E at α = 1, β = κ. Raises InputError where it is none of this kind."""
    column, own = question.column, question.parameters
    if not column.general:
        return column.damping_factors(1.0, kappa, **own)
    dampings = {name: value for name, value in (("alpha", 1.0), ("beta", kappa)) if name in column.damping}
    terms = column.coefficients(question.modes, False, **dampings, **own)
    M, E = terms.M[0], terms.K[0]
    one = (len(terms.M), len(terms.C), len(terms.K)) == (1, 1, 2)
    if one and not undamped(question).C and not column.kernel.COLUMN.get("circulatory"):
        scale = 1 / np.sqrt(np.outer(np.diag(E), np.diag(E)))  # entries of high functions are large
        basis = np.stack([(scale * X).ravel() for X in (M, E)], axis=1)
        C = (scale * terms.C[0]).ravel()
        (c_M, c_E), *_ = np.linalg.lstsq(basis, C, rcond=None)
        if np.abs(basis @ (c_M, c_E) - C).max() < 1e-9 * np.abs(C).max():
            tiny = 1e-9 * max(abs(c_M), abs(c_E))
            return (float(c_M) if abs(c_M) > tiny else 0.0), float(c_E)
    raise InputError(
        f"{column.name}: its damping and load are not of the form C = c_M M + c_E E, K = E + P H, to which the tangent "
        "rule belongs"
    )


def undamped(question: Question) -> Coefficients:
    """M, C and K without alpha and beta, by powers of the load."""
    return question.column.coefficients(question.modes, False, 0.0, 0.0, **question.parameters)


@dataclass(frozen=True)
class Coalescence:
    """Two undamped eigenvalues near the load where they meet at λ = iω: `loads` (m,), `eigenvalues` (m, 2), `load`,
    `frequency` of the meeting, and `rate`: λ = iω ± √(rate (P − load)) to first order, an exceptional point."""

    loads: Real
    eigenvalues: Complex
    load: float
    frequency: float
    rate: float

    def law(self, loads: ArrayLike) -> Complex:
        """√(rate (P − load)), the departure from iω to first order."""
        return np.asarray(np.sqrt(self.rate * (np.asarray(loads, dtype=complex) - self.load)))

    def table(self) -> dict[str, Real]:
        """Columns P, Re and Im of λ₁ and λ₂ and of the square root's law."""
        a, b = self.eigenvalues.T
        law = self.law(self.loads)
        names = ("P", "Re_lambda_1", "Im_lambda_1", "Re_lambda_2", "Im_lambda_2", "Re_law", "Im_law")
        return dict(zip(names, (self.loads, a.real, a.imag, b.real, b.imag, law.real, law.imag), strict=True))


def coalescence(question: Question, *, width: float = 0.04, points: int = 201) -> Coalescence:
    """The pair that flutters, in a question without damping, at loads within a share `width` of its meeting.

    Raises InputError where the first loss of stability is not a coalescence.
    """
    critical = answer(question)
    if critical.kind != "flutter" or critical.load is None or critical.frequency is None:
        raise InputError(f"{question.column.name}: does not flutter without damping, so no two frequencies meet")
    if not 0 < width < 1:
        raise InputError(f"width = {width}: must lie between 0 and 1, a share of the load where the frequencies meet")
    P_c, target = critical.load, 1j * critical.frequency
    # squares of u on both sides make the square root of the load a straight line
    u = np.linspace(-1.0, 1.0, points)
    P = np.unique(np.append(P_c * (1 + width * u * np.abs(u)), P_c))
    terms = undamped(question)
    if terms.C:
        raise InputError(
            f"{question.column.name}: has dampers or gyroscopic forces of its own; no two frequencies meet"
        )

    def pair(load: float) -> Complex:
        M, _, K = terms.at(load)
        inverse = np.linalg.eigvals(np.linalg.solve(K, M)).astype(complex)
        values = 1j / np.sqrt(inverse[np.abs(inverse) > 1e-13 * np.abs(inverse).max()])  # what has no mass has no λ
        both = values[np.argsort(np.abs(values - target))[:2]]
        # the growing one first, else the faster one; past the meeting λ and −λ̄ are one pair's
        if np.abs(both.real).max() > 1e-6 * abs(target):
            r = np.abs(both.real).mean()
            return np.array([r + 1j * abs(both.imag).mean(), -r + 1j * abs(both.imag).mean()])
        ordered: Complex = both[np.argsort(-both.imag)]
        return ordered

    values = np.array([pair(load) for load in P])
    h = 1e-4 * P_c
    a, b = (((pair(P_c + side)[0] - pair(P_c + side)[1]) ** 2).real for side in (h, -h))
    return Coalescence(P, values, P_c, critical.frequency, float(a - b) / (8 * h))


@dataclass(frozen=True)
class CriticalCurve:
    """Critical loads along one parameter: `name` of it, `values` (m,), `loads` and `frequencies` (m,), NaN where there
    is none up to `load_max`; `kinds` (m,)."""

    name: str
    values: Real
    loads: Real
    frequencies: Real
    kinds: tuple[str, ...]

    def table(self) -> dict[str, Any]:
        """Columns: the parameter, the critical load, its frequency and kind."""
        return {self.name: self.values, "P_cr": self.loads, "omega": self.frequencies, "kind": list(self.kinds)}


def critical_curve(question: Question, name: str, values: ArrayLike) -> CriticalCurve:
    """The critical load along `name`, "alpha", "beta" or a parameter of the column's own, at `values` (m,).

    Raises InputError for an unknown name and bad values.
    """
    if name not in question.values:
        raise InputError(f"{name!r}: is no parameter of {question.column.name}; it has {', '.join(question.values)}")
    given = np.atleast_1d(np.asarray(values, dtype=float))
    found = [answer(question.at(**{name: value})) for value in given.tolist()]
    loads, frequencies = (
        np.array([math.nan if x is None else x for x in part])
        for part in zip(*((f.load, f.frequency) for f in found), strict=True)
    )
    return CriticalCurve(name, given, loads, frequencies, tuple(f.kind for f in found))


@dataclass(frozen=True)
class Cycle:
    """One period of y = Re(Y(x) e^(λt)), the least stable motion of a system: `phase` (m,) of 2π, `vector` (n,) q̂, and
    up to each phase `work`, what the part of the load without a potential has given, −P ∫ q̇ᵀ ½(H − Hᵀ) q dt, and
    `dissipated`, ∫ q̇ᵀ C q̇ dt; `energy` is that of motion, of bending and of the load's other part, so that
    energy = energy at the start + work − dissipated. All in shares of twice the mean kinetic energy at the start.
    """

    system: System = field(repr=False)
    eigenvalue: complex
    vector: Complex = field(repr=False)
    phase: Real
    work: Real
    dissipated: Real
    energy: Real

    def shape(self, x: ArrayLike, derivative: int = 0) -> Complex:
        """Y(x) or a derivative of it, largest |Y| on the beam 1, shape of x."""
        places = np.linspace(0.0, 1.0, 401)
        top = np.abs(self.vector @ self.system.shapes(places)).max()
        return np.asarray(self.vector @ self.system.shapes(x, derivative) / top)

    def table(self) -> dict[str, Real]:
        """Columns: phase, work of the load, dissipated, energy."""
        return {"phase": self.phase, "work": self.work, "dissipated": self.dissipated, "energy": self.energy}


def cycle(question: Question, load: float | None = None, *, rigid: bool = False, points: int = 361) -> Cycle:
    """The least stable motion at a load, by default the critical one, over one period.

    rigid: with the rigid motion that the elastic one drives. Raises InputError where the least stable motion does not
    oscillate, and where there is no critical load and none is given.
    """
    name, damped = question.column.name, bool(question.alpha or question.beta)
    if load is None:
        critical = answer(question)
        load = critical.load
        if load is None:
            raise InputError(f"load: {name} is stable up to P = {question.load_max:g}; give a load")
        if critical.kind == "divergence":
            raise InputError(f"load = {load:g}: the least stable motion of {name} there does not oscillate")
    system = question.system(load, rigid)
    found = spectrum(system)
    elastic = found.elastic
    swings = np.abs(elastic.imag) > 1e-6 * np.abs(elastic)  # of its own size: the largest may be far beyond
    above, still = elastic[swings & (elastic.imag > 0)], elastic[~swings]
    worst = above[above.real.argmax()] if len(above) else 0j
    if not len(above) or still.real.max(initial=-np.inf) > worst.real - 1e-6 * abs(worst):
        raise InputError(f"load = {load:g}: the least stable motion of {name} there does not oscillate")
    if not damped and abs(worst.real) < 1e-3 * abs(worst):
        # all decay alike: the pair that flutters is the one that the load brings together
        coalescence = first_loss(question)
        target = (coalescence and coalescence.frequency) or above.imag.min()
        worst = above[np.abs(above.imag - target).argmin()]
    k = int(np.abs(found.eigenvalues - worst).argmin())
    lam, v = complex(found.eigenvalues[k]), found.vectors[:, k]
    e = slice(system.rigid_count, None)
    u = v[e]
    M, C, K = (np.asarray(X)[e, e] for X in (system.M, system.C, system.K))
    r, w = lam.real, lam.imag
    phase = np.linspace(0.0, 2 * math.pi, points)
    t = phase / w

    def integral(A: Real, a: Complex, b: Complex) -> Real:
        """∫₀ᵗ Re(a e^(λt))ᵀ A Re(b e^(λt)) dt, in closed form."""
        steady = (np.conj(a) @ A @ b).real / 2
        swing = a @ A @ b / 2
        growth = np.expm1(2 * r * t) / (2 * r) if r else t
        return np.asarray(steady * growth + (swing * np.expm1(2 * lam * t) / (2 * lam)).real)

    def square(A: Real, a: Complex) -> Real:
        now = np.real(np.exp(lam * t)[:, None] * a)
        return np.asarray(np.einsum("ti,ij,tj->t", now, A, now))

    even, odd = (K + K.T) / 2, (K - K.T) / 2
    energy = (square(M, lam * u) + square(even, u)) / 2
    size = (np.conj(lam * u) @ M @ (lam * u)).real / 2
    given, taken = -integral(odd, lam * u, u), integral(C, lam * u, lam * u)
    return Cycle(system, lam, v, phase, given / size, taken / size, energy / size)


def follower_share(question: Question) -> float:
    """η, the share of the force at x = 1 that follows the slope there: 1 a follower, 0 a dead load or no force.

    From the equation of motion, whose axial force at the end is P a(1), and the end's condition, in which the
    shear takes up the rest, P (a(1) − η) y′.
    """
    kernel = question.column.kernel
    if question.column.general:
        rows = kernel.forms(1.0, **question.parameters)["K"][1:2] if hasattr(kernel, "forms") else []
        at_end = (("y", 0, 1.0, 0), ("y", 1, 1.0, 0))
        return float(sum(f for _, points in rows for test, trial, f in points if (test, trial) == at_end))
    axial = sum(kernel.equation(1.0, **question.parameters).get((2, 0), ()))
    for condition in kernel.end_conditions(1.0, **question.parameters)[1]:
        if (3, 0) in condition:
            return float(axial + condition.get((1, 0), 0.0) / condition[3, 0] * -1)
    return 0.0
