"""Checks of what the paper says of the model and the method: sections 1 to 3."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

import numpy as np

from freebeam.ledger.finding import FLOATS, IDENTITY, PROVEN, Finding, check, enclosure, number
from freebeam.ledger.proven import eigenvalues, equations, exact, interval, ritz
from freebeam.ledger.scanned import MODES
from freebeam.maps.known import critical_load
from freebeam_sym.columns import column

MANY = 20  # polynomials: enough for ten digits and more


@check
def as_equations(numbers: Sequence[int], what: str) -> Finding:
    """A claim that numbered equations settle."""
    rows = [row for row in equations() if row.printed.number in numbers]
    return Finding(len(rows) == len(numbers) and all(row.passed for row in rows), what, IDENTITY)


# --- section 1 ----------------------------------------------------------------------------------------------


@check
def dead_force() -> Finding:
    """Columns under an axial force of fixed direction lose stability by divergence."""
    cases: tuple[tuple[str, dict[str, str]], ...] = (("euler-pinned", {}), ("beck", {"eta": "0"}))
    found = {name: ritz(name=name, **own) for name, own in cases}
    titles = {"euler-pinned": "pinned column", "beck": "cantilever"}
    return Finding(
        all(one.kind == "divergence" and all(one.proof.values()) for one in found.values()),
        "; ".join(f"{titles[name]}: divergence at {enclosure(interval(one.load))}" for name, one in found.items()),
        PROVEN,
    )


@check
def both_kinds() -> Finding:
    """A follower force makes flutter, or divergence where it follows in part."""
    part, whole = ritz(name="beck", eta="0.4"), ritz(name="beck")
    return Finding(
        part.kind == "divergence" and whole.kind == "flutter" and ritz().kind == "flutter",
        f"Beck's column: flutter at {enclosure(interval(whole.load))} where the force follows the slope, divergence at "
        f"{enclosure(interval(part.load))} where it follows 0.4 of it; the free beam: flutter at "
        f"{enclosure(interval(ritz().load))}",
        PROVEN,
    )


@check
def zero_frequency() -> Finding:
    """At a divergence an eigenvalue is zero."""
    found = ritz(name="euler-pinned")
    load = float(interval(found.load)[0])
    column_ = column("euler-pinned")
    squares = []
    for factor in (0.99, 0.9999):
        s = column_.system(MODES, factor * load)
        squares.append(float(np.linalg.eigvals(np.linalg.solve(s.M, s.K)).real.min()))
    return Finding(
        found.kind == "divergence" and squares[0] > squares[1] > 0,
        f"pinned column: det K = 0 at {enclosure(interval(found.load))} (proven); the lowest ω² is "
        f"{number(squares[0], 4)} one per cent below and {number(squares[1], 4)} a hundredth of a per cent below",
        PROVEN,
    )


@check
def only_coalescence(alpha: str) -> Finding:
    """Whether frequencies converge wherever flutter begins: with internal damping they do not."""
    found = ritz(alpha)
    load = found.load
    assert load is not None
    frequencies = [bounds for _, bounds in eigenvalues(load[0], alpha) if bounds[0] > 0][:2]
    converge = frequencies[1][0] < frequencies[0][1] * Fraction(101, 100)
    return Finding(
        converge,
        f"without damping they do, at {enclosure(interval(ritz().load))}; at α = {alpha} flutter begins at "
        f"{enclosure(interval(load))} with the two lowest frequencies at {enclosure(frequencies[0], 8)} and "
        f"{enclosure(frequencies[1], 8)}",
        PROVEN,
    )


@check
def frequencies_change(low: str, high: str) -> Finding:
    """The lowest frequency at two loads, without damping."""
    first = [min(bounds for _, bounds in eigenvalues(load) if bounds[0] > 0) for load in (low, high)]
    share = float(first[1][0] / first[0][0])
    return Finding(
        abs(share - 1) > 0.1,
        f"lowest frequency {enclosure(first[0], 8)} at P = {low}, {enclosure(first[1], 8)} at P = {high}",
        PROVEN,
    )


@check
def lowest_two_meet() -> Finding:
    """Beal: the critical follower force is where the two lowest bending frequencies coalesce; of the beam itself."""
    found, beam = ritz(), exact()
    return Finding(
        found.kind == "flutter" and beam.proof["crossing"] and beam.proof["kind"],
        f"a double root of the beam's own characteristic function at P = {enclosure(interval(beam.load))}, "
        f"ω = {enclosure(interval(beam.frequency))}; the two are the lowest, see section 4.1",
        PROVEN,
    )


@check
def tumbling() -> Finding:
    """The rigid block of the equations: its follower force turns into a lateral one, and nothing holds it back."""
    s = column("free-free").system(MODES, 1.0, rigid=True)
    K, M = s.K[:2, :2], s.M[:2, :2]
    power = np.linalg.matrix_power(np.linalg.solve(M, K), 2)
    return Finding(
        bool(abs(K[0, 1] - 1) < 1e-12 and abs(K[0, 0]) + abs(K[1, 0]) + abs(K[1, 1]) < 1e-12 and not power.any()),
        "translation and rotation obey z̈ + P θ = 0, θ̈ = 0 without damping: λ = 0 is fourfold and has one "
        "eigenvector, so that the slightest turn grows into a drift as t³",
        IDENTITY,
    )


@check
def without_modes() -> Finding:
    """Whether mode shapes must be known: polynomials do better."""
    load = critical_load(column("free-free", "legendre"), MANY).load
    beam = interval(exact().load)
    assert load is not None
    gap = abs(load - float(beam[0]))
    same = gap < 1e-9
    return Finding(
        not same,
        f"{MANY} Legendre polynomials, which need no mode shape, give {number(load, 10)}, the beam itself is "
        f"{enclosure(beam)}; eight modes give {enclosure(interval(ritz().load))}",
        FLOATS,
    )


# --- sections 2 and 3 ---------------------------------------------------------------------------------------


@check
def without_approximation() -> Finding:
    """Whether an approximation must be used: the equation has a convergent power series, whose load is enclosed."""
    beam = exact()
    solved = beam.proof["crossing"] and beam.proof["kind"]
    return Finding(
        not solved,
        f"two power series in x solve it for every P and λ; their determinant at x = 1 encloses the flutter load, "
        f"{enclosure(interval(beam.load), 18)}, to as many digits as are asked for",
        PROVEN,
    )


@check
def galerkin() -> Finding:
    """Galerkin's method on Eq. (6) with these modes gives the same matrices: its end conditions hold no load."""
    s = column("free-free").system(MODES, 50.0)
    nodes, weights = np.polynomial.legendre.leggauss(64)
    x, w = (nodes + 1) / 2, weights / 2
    d = [s.shapes(x, order) for order in range(5)]
    K = (d[0] * w) @ (d[4] + s.load * (d[1] + x * d[2])).T
    gap = float(np.abs((K - s.K) / np.outer(s.gamma, s.gamma) ** 2).max())
    rows = as_equations((15,), "")
    return Finding(
        gap < 1e-11 and rows.holds,
        "Galerkin's method on Eq. (6) with the modes of Eq. (22) gives the matrices of Eq. (11), for the natural end "
        "conditions of the loaded beam, Eq. (15), hold no load; the Ritz method itself does not need Eq. (6)",
        FLOATS,
    )


def _rigid_coupling() -> tuple[float, float]:
    """Largest entry of M, E, H in an elastic row and a rigid column, and the reverse."""
    M, E, H = column("free-free").matrices(MODES, rigid=True)
    return (
        float(max(np.abs(X[2:, :2]).max() for X in (M, E, H))),
        float(max(np.abs(X[:2, 2:]).max() for X in (M, E, H))),
    )


@check
def rigid_apart() -> Finding:
    """The elastic rows do not see the rigid coordinates, so the elastic spectrum is what it is without them."""
    down, up = _rigid_coupling()
    elastic = column("free-free").matrices(MODES)
    whole = column("free-free").matrices(MODES, rigid=True)
    same = all(np.array_equal(a, b[2:, 2:]) for a, b in zip(elastic, whole, strict=True))
    return Finding(
        down == 0 and same,
        "the matrices with rigid functions are block triangular: −∫x φᵢ′ r′ dx + φᵢ(1) r′(1) = r′ ∫φᵢ dx = 0, for φᵢ "
        f"is orthogonal to 1. The reverse coupling is not zero ({number(up, 4)} at most): the rigid motion feels the "
        "elastic one",
        IDENTITY,
    )


@check
def complete() -> Finding:
    """Whether the modes used satisfy the four conditions: without the rigid functions they are not complete."""
    s = column("free-free").system(MODES)
    nodes, weights = np.polynomial.legendre.leggauss(64)
    x, w = (nodes + 1) / 2, weights / 2
    overlap = float(max(np.abs(s.shapes(x) @ (w * f)).max() for f in (np.ones_like(x), x - 0.5)))
    return Finding(
        not overlap < 1e-12,
        "1), 2) and 4) hold; 3) holds with the two rigid modes only: every bending mode is orthogonal to 1 and to x, "
        "so that without them no translation or turn is represented. It does no harm: see the next claim",
        FLOATS,
    )


@check
def second_term(alpha: str) -> Finding:
    """Whether the second term of Eq. (23) is a frequency: not where the mode is overdamped."""
    gamma = column("free-free").basis(1).gamma[0]
    first, last = column("free-free").kernel.frequencies(np.array([gamma]), float(alpha), 0.0)
    oscillates = bool(abs(first[0].imag) > 0)
    return Finding(
        oscillates,
        f"so long as β + αγ⁴ < 2γ²; at α = {alpha}, inside Fig. 4, mode 1 has the real eigenvalues "
        f"{number(first[0].real, 6)} and {number(last[0].real, 6)}: no frequency (at β = 0 from α = 2/γ₁² = "
        f"{number(2 / gamma**2, 4)} on)",
        FLOATS,
    )
