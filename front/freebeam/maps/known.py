"""Single questions, quicker where many have been asked of a column: what is known of its pencil answers them.

A pencil whose dampings have been asked for a few times has a surface of first crossings (`surface.py`), and of one
without damping, or of a limit of it, the first loss that was found serves every largest load.
"""

from __future__ import annotations

import math
from functools import wraps

import numpy as np

from freebeam.maps.surface import surface_of
from freebeam_sym.columns import Column
from freebeam_sym.question import Question
from freebeam_sym.stability import critical
from freebeam_sym.stability.critical import CriticalLoad
from freebeam_sym.stability.crossings import FirstLoss, first_loss
from freebeam_sym.stability.general import General
from freebeam_sym.stability.problem import Complex, Crossing
from freebeam_sym.stability.proportional import LIGHTEST_SCAN, Proportional

__all__ = ["answer", "critical_load", "near", "settled"]


@wraps(critical.critical_load, assigned=("__doc__",))
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
    return answer(Question.of(column, modes, alpha, beta, load_max=load_max, kappa=kappa, **parameters))


def answer(question: Question) -> CriticalLoad:
    """The first loss of stability that a question asks for. Raises InputError, as `critical_load` does."""
    return critical.answer(question, settled)


def settled(problem: Proportional | General, load_max: float) -> FirstLoss:
    """As `first_loss`, quicker where many questions have been asked of a pencil, or one without damping before."""
    if isinstance(problem, General):
        return first_loss(problem, load_max)
    if problem.size:
        return _from_surface(problem, load_max) or first_loss(problem, load_max)
    kept, key = problem.pencil.kept, (FirstLoss, problem.kappa)
    top: float
    found: FirstLoss
    top, found = kept.get(key, (0.0, FirstLoss(None)))
    if found.crossing is None and top < load_max:  # else what was found up to there serves any largest load
        found = first_loss(problem, load_max)
        kept[key] = load_max, found
    if found.crossing is not None and found.crossing.load <= load_max:
        return found
    return FirstLoss(None, tuple(touch for touch in found.touches if touch.load <= load_max))


def _from_surface(problem: Proportional, load_max: float) -> FirstLoss | None:
    """The answer from the pencil's surface of critical loads; None where that does not settle the question, or where
    too few have been asked for it to be worth making."""
    pencil = problem.pencil
    if min(problem.alpha, problem.beta) < 0 or pencil.conservative:
        return None
    surface = surface_of(pencil, load_max)
    load, frequency, known = surface.at(np.array([problem.alpha]), np.array([problem.beta]), single=True)
    if not known[0]:
        return None
    found = surface.first_divergence if surface.divergence <= load_max else None
    if load[0] < min(surface.divergence, load_max * (1 + 1e-9)):
        found = _refined(problem, float(load[0]), float(frequency[0]))
        if found is None:
            return None
        found = found if found.load <= load_max else None
    top = load_max if found is None else found.load
    return FirstLoss(found, tuple(x.crossing for x in pencil.divergences if x.crossing.load < top))


def _refined(problem: Proportional, P: float, omega: float) -> Crossing | None:
    """The flutter at a point of the surface, with its motion; None where it is not confirmed there."""
    pencil = problem.pencil
    lightest = LIGHTEST_SCAN * math.sqrt(pencil.e[0])
    size = max(problem.size, lightest)
    D = 1j * size * problem.shape
    A = P * pencil.relative + np.diag(1 + omega * (D - omega) / pencil.e)
    try:
        B = np.linalg.inv(A)
    except np.linalg.LinAlgError:
        return None
    v = B @ B.sum(axis=1)
    v = v / np.sqrt(pencil.e) / np.abs(v).max()
    if problem.size < 10 * lightest:
        found = near(problem, P, omega, v, size)
    else:  # one more step of Newton's method for det A = 0, as the surface was made
        a, b = (B * pencil.relative.T).sum(), (B.diagonal() * ((D - 2 * omega) / pencil.e)).sum()
        share = 1 / float((a * b.conj()).imag)
        found = Crossing(P + float(b.imag) * share, omega - float(a.imag) * share, pencil.vector(v), "flutter")
    return found if found is not None and abs(found.load - P) < 1e-8 * P else None


def near(problem: Proportional, load: float, omega: float, v: Complex, size: float | None = None) -> Crossing | None:
    """The flutter near a load, a frequency and a motion in the basis of the pencil, by Newton's method; None where
    there is none. size: of the damping that the motion belongs to, where that is another."""
    square = v @ v
    v = v * np.exp(-0.5j * np.angle(square)) / math.sqrt(np.abs(v @ v.conj()))
    found = problem.newton(omega**2, load, v.real.copy(), v.imag / (omega * (size or problem.size or 1.0)))
    return found if found is not None and found.frequency > 0 else None
