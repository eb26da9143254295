"""Checks of what the paper says of motion: section 4.5, and where the abstract, sections 1 and 5 repeat it."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from functools import lru_cache
from typing import Any

import numpy as np

from freebeam.ledger.finding import FLOATS, IDENTITY, PROVEN, RANGE, Finding, Interval, check, enclosure, number
from freebeam.ledger.proven import amplitude, eigenvalues, interval, ritz
from freebeam.ledger.scanned import MODES
from freebeam_sym.columns import System, column
from freebeam_sym.response import respond

__all__ = ["drift"]

ALPHA, BETA = "0.001", "0.1"  # section 4.5


def _system(load: float, basis: str = "modes", modes: int = MODES, rigid: bool = False) -> System:
    return column("free-free", basis).system(modes, load, float(ALPHA), float(BETA), rigid)


def _rate(load: str, alpha: str = ALPHA, beta: str = BETA) -> Interval:
    """Largest real part of the eigenvalues."""
    return max((real for real, _ in eigenvalues(load, alpha, beta)), key=lambda part: part[1])


@check
def decays(loads: Sequence[str], alpha: str = ALPHA, beta: str = BETA) -> Finding:
    """All eigenvalues have negative real parts: free motion dies out, whatever its beginning."""
    rates = [_rate(load, alpha, beta) for load in loads]
    listed = ", ".join(f"{enclosure(rate, 8)} at P = {load}" for load, rate in zip(loads, rates, strict=True))
    return Finding(all(rate[1] < 0 for rate in rates), f"largest Re λ: {listed}", PROVEN)


@check
def stable_by_lyapunov(load: str) -> Finding:
    """A quadratic function of the state that falls along every motion: its matrix, and the largest eigenvalues."""
    from scipy.linalg import solve_continuous_lyapunov

    from freebeam_sym.spectra import state_matrix

    s = _system(float(load))
    # in coordinates of equal energies, so that the matrices are of one size
    scale = np.diag(1 / np.sqrt(np.concatenate([np.diag(s.E), np.diag(s.M)])))
    A = np.linalg.inv(scale) @ state_matrix(s.M, s.C, s.K) @ scale
    X = solve_continuous_lyapunov(A.T, -np.eye(len(A)))
    fall = np.linalg.eigvalsh(A.T @ X + X @ A)
    least = np.linalg.eigvalsh(X)[0]
    rate = _rate(load)
    return Finding(
        bool(least > 0 and fall[-1] < 0) and rate[1] < 0,
        f"AᵀX + XA = −1 has a solution X, least eigenvalue {number(least, 3)} > 0, so that xᵀXx falls along every "
        f"motion; largest Re λ = {enclosure(rate, 8)}. One trajectory of one point would not show it",
        PROVEN,
    )


@check
def unstable(load: str) -> Finding:
    """An eigenvalue with a positive real part."""
    rate = _rate(load)
    return Finding(rate[0] > 0, f"largest Re λ = {enclosure(rate, 8)} at P = {load}", PROVEN)


@check
def small_force(force: str, load: str) -> Finding:
    """The transversal force against the follower force."""
    share = Fraction(force) / Fraction(load)
    return Finding(share < Fraction(1, 100), f"{force} / {load} = {number(float(share), 3)} at most", IDENTITY)


@check
def slow_force(frequency: str, loads: Sequence[str]) -> Finding:
    """The force's frequency lies below all of the beam's."""
    lowest = [min(bounds[0] for _, bounds in eigenvalues(load, ALPHA, BETA) if bounds[0] > 0) for load in loads]
    upper = [min(bounds[1] for _, bounds in eigenvalues(load, ALPHA, BETA) if bounds[0] > 0) for load in loads]
    listed = ", ".join(f"{enclosure((a, b), 8)} at P = {load}" for a, b, load in zip(lowest, upper, loads, strict=True))
    return Finding(min(lowest) > Fraction(frequency), f"lowest frequency {listed}", PROVEN)


def _transfer(s: System, x_s: float, w: float) -> float:
    """Elastic amplitude at x_s under sin ωt at the end."""
    Z = -w * w * s.M + 1j * w * s.C + s.K
    return float(abs(s.shapes(np.array([x_s]))[:, 0] @ np.linalg.solve(Z, s.Q(1.0))))


@check
def more_load(low: str, high: str) -> Finding:
    """Fig. 10: the amplitude at x_s = 0.1 rises with the load between its two loads; by how much, three ways."""
    here = amplitude()
    signs = here.slope_signs(low, high)
    beam = [_transfer(_system(float(load), "legendre", 20), 0.1, 3.0) for load in (low, high)]
    return Finding(
        [sign for *_, sign in signs] == [1],
        f"amplitude at x_s = 0.1, elastic part, P = {low} to {high}: × {enclosure(here.ratio(high, low), 8)} at N = "
        f"{MODES}, "
        f"rising throughout (proven); × {number(beam[1] / beam[0], 8)} with 20 polynomials, converged; with Eq. (11) "
        f"as printed × {enclosure(amplitude(transposed=True).ratio(high, low), 8)}",
        RANGE,
    )


@check
def more_force(first: str, second: str) -> Finding:
    """Eq. (10) is linear in the force; the responses differ by the factor of the forces."""
    s = _system(50.0)
    wave = np.sin(3 * np.linspace(0.0, 10.0, 1001))
    motions = [respond(s, 10.0, 0.01, force=float(a) * wave, force_position=1.0).y for a in (first, second)]
    factor = float(second) / float(first)
    gap = float(np.abs(motions[1] - factor * motions[0]).max() / np.abs(motions[1]).max())
    return Finding(
        factor > 1 and gap < 1e-12,
        f"Eq. (10) is linear: F₀ = {second} sin 3t gives {number(factor)} times the motion of {first} sin 3t",
        IDENTITY,
    )


@check
def more_is_more(places: Sequence[str]) -> Finding:
    """Whether more follower force is more motion, up to the critical load and at several places."""
    top = ritz(ALPHA, BETA).load
    assert top is not None
    found, good = [], True
    for place in places:
        signs = amplitude(place).slope_signs("0", top[0])
        runs = [(a, b, sign) for a, b, sign in signs if sign]
        good &= all(sign == 1 for *_, sign in runs)
        arrow = {1: "rises", -1: "falls"}
        found.append(
            f"at x_s = {place} it "
            + ", ".join(f"{arrow[s]} from P = {number(float(a), 4)} to {number(float(b), 4)}" for a, b, s in runs)
        )
    small = amplitude(places[0]).ratio("85", "0")
    return Finding(
        good,
        f"amplitude under sin 3t at the end, elastic part: {'; '.join(found)}; at x_s = {places[0]} and P = 85 it is "
        f"{enclosure(small, 5)} of that at P = 0. Between the two loads of Fig. 10 it does rise",
        RANGE,
    )


@check
def can_be_more() -> Finding:
    """Section 5's weaker form: it can lead to an increase."""
    one, two = more_load("5", "50"), more_force("0.001", "0.002")
    return Finding(one.holds and two.holds, f"{one.computed}; {two.computed}", one.by)


@lru_cache(maxsize=1)
def drift() -> dict[str, float]:
    """The free beam under sin 3t at the end, P = 5, at t = 40: the sensor's motion and its elastic part, exactly in
    time: exp(40 B) of the system with the oscillator that drives it."""
    from scipy.linalg import expm

    s = _system(5.0, rigid=True)
    n = len(s.M)
    B = np.zeros((2 * n + 2, 2 * n + 2))
    B[:n, n : 2 * n] = np.eye(n)
    B[n : 2 * n, : 2 * n] = -np.linalg.solve(s.M, np.hstack([s.K, s.C]))
    B[n : 2 * n, 2 * n] = 0.001 * np.linalg.solve(s.M, s.Q(1.0))
    B[2 * n, 2 * n + 1], B[2 * n + 1, 2 * n] = 3.0, -3.0
    start = np.zeros(2 * n + 2)
    start[-1] = 1.0  # cos 0; its integral drives with sin
    shapes = s.shapes(np.array([0.1]))[:, 0]

    def at(t: float) -> Any:
        return (expm(B * t) @ start)[:n]

    end, later = at(40.0), at(80.0)
    r = s.rigid_count
    return {
        "whole": float(shapes @ end),
        "later": float(shapes @ later),
        "elastic": float(0.001 * _transfer(_system(5.0), 0.1, 3.0)),
        "elastic part": float(shapes[r:] @ end[r:]),
        "coupling": float(max(np.abs(X[r:, :r]).max() for X in (s.M, s.E, s.H))),
    }


@check
def fixed_amplitude(loads: Sequence[str]) -> Finding:
    """Whether the amplitude at the sensor tends to a fixed value: that of the elastic part does."""
    found = drift()
    settles = all(_rate(load)[1] < 0 for load in loads)
    fixed = settles and abs(found["later"]) < 2 * found["elastic"]
    return Finding(
        fixed,
        f"the elastic part settles to the amplitude {number(found['elastic'], 3)} at P = 5; but the free beam also "
        "turns and "
        f"drifts: at t = 40 the sensor is at y = {number(found['whole'], 4)}, at t = 80 at {number(found['later'], 4)}",
        FLOATS,
    )


@check
def follows_the_force(frequency: str, other: str) -> Finding:
    """Whether the motion is proportional to the force's amplitude and to its frequency."""
    here, there = amplitude().at("5"), amplitude(frequency=other).at("5")
    ratio = there[0] / here[1], there[1] / here[0]
    factor = Fraction(other) / Fraction(frequency)
    return Finding(
        ratio[0] <= factor <= ratio[1],
        "to the amplitude exactly, Eq. (10) being linear, and at the force's frequency; but not to the frequency: "
        f"from ω = {frequency} to {other} the amplitude grows by × {enclosure(ratio, 8)}, not × {factor}",
        PROVEN,
    )


def persists(loads: Sequence[str]) -> Finding:
    """Without damping, below the critical load, every eigenvalue is imaginary and simple: motion persists."""
    found = ritz()
    below = all(Fraction(load) < interval(found.load)[0] for load in loads)
    frequencies = [min(b for _, b in eigenvalues(load) if b[0] > 0) for load in loads]
    listed = ", ".join(f"{enclosure(w, 8)} at P = {load}" for w, load in zip(frequencies, loads, strict=True))
    return Finding(
        below and found.proof["stable_below"],
        f"all ω² are real, positive and simple up to P = {enclosure(interval(found.load))} (proven); lowest ω {listed}",
        PROVEN,
    )


@check
def dies_and_persists(loads: Sequence[str]) -> Finding:
    """Damping of either kind ends free motion; without it, it persists."""
    cases = {"α = 0.001": (ALPHA, "0"), "β = 0.1": ("0", BETA), "both": (ALPHA, BETA)}
    found = {name: decays(loads, *case) for name, case in cases.items()}
    still = persists(loads)
    return Finding(
        still.holds and all(one.holds for one in found.values()),
        "; ".join(f"{name}: {one.computed}" for name, one in found.items()) + f"; without damping {still.computed}",
        PROVEN,
    )
