"""Light damping: loads are off by no more than the error that they state, or refused. Against eigenvalues at 60 digits.

`python -m tests.runtime.test_light_damping` asks of more columns, and prints what states less error than there is.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
import pytest
from flint import acb, acb_mat, arb, arb_mat

import freebeam as fb
from freebeam_derive.certify.balls import precision
from freebeam_sym.checks import InputError
from freebeam_sym.stability.crossings import first_loss
from freebeam_sym.stability.general import General
from freebeam_sym.stability.pencil import Pencil, diagonalise
from freebeam_sym.stability.proportional import Proportional
from tests.runtime.test_rotors import column

LIGHT = (1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-10, 1e-14)


def grows(column: fb.Column, modes: int, dampings: dict[str, float], P: float, **own: float) -> bool:
    """Whether an eigenvalue has a positive real part, of the matrices' parts added up at 60 digits."""
    bare = column.coefficients(modes, **own)
    ones = {name: column.coefficients(modes, **{name: 1.0}, **own) for name in dampings}
    n = len(bare.M[0])

    def at(part: int) -> arb_mat:
        def of(given: Sequence[np.ndarray]) -> arb_mat:
            return sum((arb_mat(X.tolist()) * arb(P) ** k for k, X in enumerate(given)), arb_mat(n, n))

        each = (arb(size) * (of(ones[name][part]) - of(bare[part])) for name, size in dampings.items())
        return sum(each, of(bare[part]))

    M, C, K = (at(part) for part in range(3))
    lower = np.hstack([np.array(M.solve(X).tolist(), dtype=object) for X in (-K, -C)])
    upper = np.hstack([np.zeros((n, n)), np.eye(n)]).astype(object)
    A = acb_mat([[acb(x).mid() for x in row] for row in np.vstack([upper, lower]).tolist()])
    return bool(max(x.real.mid() for x in A.eig(algorithm="approx")) > arb(10) ** -32)


def met(column: fb.Column, modes: int, top: float, **own: float) -> list[float]:
    """Up to six loads below `top` at which squared frequencies without damping are not real."""
    M, _, K = column.coefficients(modes, **own)
    found = []
    for P in np.linspace(0, top, 402)[1:-1].tolist():
        inertia, stiffness = (sum(P**k * A for k, A in enumerate(X)) for X in (M, K))
        squares = 1 / np.linalg.eigvals(np.linalg.solve(stiffness, inertia))
        found += [P] if (np.abs(squares.imag) > 1e-7 * np.abs(squares)).any() else []
    return found[:: -(-len(found) // 6) or 1]


def less_error_than_there_is(
    column: fb.Column, modes: int, dampings: dict[str, float], windows: bool = False, **own: float
) -> str | None:
    """What is wrong with an answer: None where it is right to the error that it states, or refused. windows: look at
    loads too at which frequencies have met without damping."""
    try:
        found = fb.critical_load(column, modes, **dampings, load_max=100, **own)
    except InputError as refused:
        return None if "lost in rounding" in str(refused) else str(refused)
    top = found.load or 100.0
    between = met(column, modes, top, **own) if windows else [0.25 * top, 0.5 * top, 0.75 * top]
    with precision(200):
        for load in (*between, 0.9 * top, top * (1 - max(found.rounding, 4e-16))):
            if grows(column, modes, dampings, load, **own):
                return f"{found.load} states {found.rounding:.1e}, but something grows at {load}"
        if found.load and not grows(column, modes, dampings, top * (1 + max(found.rounding, 4e-16)), **own):
            return f"{found.load} states {found.rounding:.1e}, but nothing grows just above it"
    return None


@pytest.mark.parametrize("name", ["disc", "turning disc"])
@pytest.mark.parametrize("size", [1e-4, 1e-6, 1e-8, 1e-14])
def test_a_rotors_load_is_right_to_the_error_that_it_states(name: str, size: float) -> None:
    """Jeffcott's rotor is lost at 2 (1 + 3) = 8 however light its damping, whichever frame it is seen from."""
    if size < 1e-7:
        with pytest.raises(InputError, match="lost in rounding"):
            fb.critical_load(column(name), 1, size, 3 * size, load_max=100)
    else:
        assert less_error_than_there_is(column(name), 1, {"alpha": size, "beta": 3 * size}) is None


def test_a_load_that_is_off_by_more_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(fb.CriticalLoad, "rounding", 1e-15)
    said = less_error_than_there_is(column("turning disc"), 1, {"alpha": 1e-5, "beta": 3e-5})
    assert said is not None and "grows" in said


@pytest.mark.parametrize("seed", range(20))
def test_a_stiffness_that_is_singular_but_for_rounding_is_refused(seed: int) -> None:
    """Cholesky's factors exist of some of these: with them a frequency would be no number."""
    rng = np.random.default_rng(seed)
    L, half = rng.normal(size=(5, 5)), rng.normal(size=(5, 4))
    try:
        e, _ = diagonalise(np.eye(5) + L @ L.T, half @ half.T)
    except InputError as refused:
        assert "not stable at load 0" in str(refused)
    else:
        assert np.isfinite(e).all() and (e > 0).all()


WINDOW = np.diag([1.0, 4, 9, 16, 2000, 2001]), np.kron(np.diag([0.0, 0, 1]), [[1, 0.05], [-0.05, -1]])
WINDOW[1][:2, :2] = [[0, 0.5], [-0.5, 0]]
"""E and H of two high frequencies that meet at loads from 0.476 to 0.526, and of two low ones that do from 3 on."""


def growth_of_the_high(C: np.ndarray, P: float) -> float:
    K = (WINDOW[0] + P * WINDOW[1])[4:, 4:]
    return float(np.linalg.eigvals(np.block([[np.zeros((2, 2)), np.eye(2)], [-K, -C[4:, 4:]]])).real.max())


@pytest.mark.parametrize("each", [(1, 1), (2, 0.1), (0.1, 2)])
@pytest.mark.parametrize("size", [1e-10, 1e-8, 1e-7, 2.7e-7, 2.79e-7, 3e-7, 1e-6, 1e-5])
def test_light_damping_is_judged_for_two_high_frequencies_that_meet(size: float, each: tuple[float, float]) -> None:
    """They grow by 2.8e-4 at most without damping, so that one that is light for the low modes holds them or not."""
    E, H = WINDOW
    C = size * E * np.diag([1, 1, 1, 1, *each])
    lost = [P for P in np.linspace(0.4, 0.6, 401).tolist() if growth_of_the_high(C, P) > 1e-12]
    problems: list[General | Proportional] = [General([np.eye(6)], [C], [E, H])]
    problems += [Proportional(Pencil(np.eye(6), E, H), size)] if each == (1, 1) else []
    for problem in problems:
        outcome = first_loss(problem, 5.0)
        found = outcome.crossing
        assert found is not None and not outcome.touches
        if not lost:
            assert found.load == pytest.approx(2.4, rel=1e-5) and found.frequency < 2
            continue
        assert lost[0] - 5e-4 < found.load <= lost[0] and found.frequency == pytest.approx(44.7, rel=1e-2)
        off = found.load * max(problem.rounding(found), 1e-6)
        assert growth_of_the_high(C, found.load - off) < growth_of_the_high(C, found.load + off)
        assert growth_of_the_high(C, found.load + off) > 0


@pytest.mark.parametrize("seed", [114, 128])
def test_frequencies_that_are_almost_one_at_rest_hide_no_loss(seed: int) -> None:
    """Of random loads without damping, against the squared frequencies at equal steps of the load."""
    rng = np.random.default_rng(seed)
    n = int(rng.integers(2, 9))
    e = np.sort(10 ** rng.uniform(0, 3, n))
    H = 0.2 * rng.normal(size=(n, n)) * np.sqrt(np.outer(e, e))
    e[-1] = e[-2] * (1 + 1e-6)
    found = first_loss(General([np.eye(n)], [np.zeros((n, n))], [np.diag(e), H]), 50.0).crossing
    assert found is not None
    for P in np.linspace(0, 1.2 * found.load, 1200)[1:].tolist():
        squares = np.linalg.eigvals(np.diag(e) + P * H)
        if np.abs(squares.imag).max() > 1e-4 or squares.real.min() < 0:
            break
    assert found.load == pytest.approx(P, rel=2e-3)


@pytest.mark.parametrize("gap", [0.0, 1e-8, 1e-6])
@pytest.mark.parametrize("seed", [77, 88, 92, 148, 163, 213])
def test_a_load_at_which_what_is_almost_one_meets_is_told_or_refused(seed: int, gap: float) -> None:
    """Of a load without damping, by eigenvalues at 60 digits: nothing grows below one that is found. Where two meet in
    the plane of these two alone, at |gap + p slope| = 2 p √(−H₁₂ H₂₁), the refusal names that load."""
    rng = np.random.default_rng(seed)
    n = int(rng.integers(2, 9))
    e = np.sort(10 ** rng.uniform(0, 3, n))
    H = 0.2 * rng.normal(size=(n, n)) * np.sqrt(np.outer(e, e))
    e[-1] = e[-2] * (1 + gap)
    both, slope = 2 * np.sqrt(max(-H[-1, -2] * H[-2, -1], 0)), H[-1, -1] - H[-2, -2]

    def lost(P: float) -> bool:
        with precision(200):
            K = [
                [acb(arb(float(H[i, j])) * arb(P) + (float(e[i]) if i == j else 0)).mid() for j in range(n)]
                for i in range(n)
            ]
            squares = acb_mat(K).eig(algorithm="approx")
            return any(abs(x.imag.mid()) > arb(10) ** -25 or x.real.mid() < 0 for x in squares)

    try:
        found = first_loss(General([np.eye(n)], [np.zeros((n, n))], [np.diag(e), H]), 50.0).crossing
    except InputError as refused:
        assert both > (slope if gap else abs(slope)) and "almost one without load" in str(refused)
        first = (e[-1] - e[-2]) / (both - slope) if gap else 0.0
        said = float(str(refused).partition("near the load ")[2].partition(":")[0])
        assert said == pytest.approx(first, rel=0.05, abs=1e-12)
        if gap:
            assert lost(1.02 * first) and not lost(0.98 * first)
        return
    assert found is not None and not any(lost(P) for P in np.geomspace(gap / 10 or 1e-9, found.load * (1 - 1e-6), 25))
    assert lost(found.load * (1 + 1e-6))


@pytest.mark.parametrize("load", [0.0, 0.1, 0.36, 1.0, 5.0])
def test_the_motions_of_a_short_segment_do_not_grow_without_damping(load: float) -> None:
    """A crack at 0.99 of the length: rounding of K⁻¹M splits or turns the sign of the highest frequencies."""
    M, _, K = fb.column("crack").coefficients(20, a=0.99)
    assert General(M, [0 * M[0]], K).unstable(load) == 0


def windows() -> Iterator[tuple[fb.Column, int, dict[str, float]]]:
    """Of many numbers of functions, with dampings that are light."""
    for name in ("beck", "timoshenko", "rayleigh", "crack", "step", "cone", "leipholz", "free-free", "tip-spring"):
        for modes in (4, 8, 16, 24, 32):
            for alpha, beta in ((1e-6, 1e-6), (1e-7, 1e-9), (3e-8, 1e-8), (1e-9, 1e-9)):
                known = fb.column(name)
                yield known, modes, {k: v for k, v in (("alpha", alpha), ("beta", beta)) if k in known.damping}


def cases() -> Iterator[tuple[fb.Column, int, dict[str, float], dict[str, float]]]:
    for size in LIGHT:
        for name, modes, ratio in (("disc", 1, 3), ("turning disc", 1, 3), ("shaft", 3, 30), ("turning shaft", 3, 30)):
            yield column(name), modes, {"alpha": size, "beta": ratio * size}, {}
        yield column("shaft"), 3, {"alpha": size, "beta": 30 * size}, {"r": 0.02}
        for name in ("beck", "free-free", "ziegler", "pflueger", "pipe", "beal", "feedback", "absorber", "timoshenko"):
            known = fb.column(name)
            modes = max(5, int(known.kernel.COLUMN.get("least", 1)))
            for given in known.damping:
                yield known, modes, {given: size}, {}


if __name__ == "__main__":
    for each, modes, dampings, own in cases():
        said = less_error_than_there_is(each, modes, dampings, **own)
        print(each.name, dampings, own, said or "right, or refused", flush=True)
    for each, modes, dampings in windows():
        said = less_error_than_there_is(each, modes, dampings, windows=True)
        print(each.name, modes, dampings, said or "right, or refused", flush=True)
