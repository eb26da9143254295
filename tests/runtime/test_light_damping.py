"""Light damping: loads are off by no more than the error that they state, or refused. Against eigenvalues at 60 digits.

`python -m tests.runtime.test_light_damping` asks of more columns, and prints what states less error than there is.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest
from mpmath import eig, matrix, mpf, workdps

import freebeam as fb
from freebeam_sym.checks import InputError
from freebeam_sym.stability.pencil import diagonalise
from tests.runtime.test_rotors import column

LIGHT = (1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-10, 1e-14)


def grows(column: fb.Column, modes: int, dampings: dict[str, float], P: float, **own: float) -> bool:
    """Whether an eigenvalue has a positive real part, of the matrices' parts added up at 60 digits."""
    bare = column.coefficients(modes, **own)
    n = len(bare.M[0])

    def at(part: int, **given: float) -> matrix:
        total = matrix(n, n)
        for k, X in enumerate(column.coefficients(modes, **given, **own)[part]):
            total += matrix(X.tolist()) * mpf(P) ** k
        return total

    M, C, K = (at(part) for part in range(3))
    C, K = (
        X + sum((mpf(size) * (at(part, **{name: 1.0}) - at(part)) for name, size in dampings.items()), matrix(n, n))
        for part, X in ((1, C), (2, K))
    )
    A, inverse = matrix(2 * n, 2 * n), M**-1
    A[n:, :n], A[n:, n:] = -inverse * K, -inverse * C
    for k in range(n):
        A[k, n + k] = 1
    return bool(max(x.real for x in eig(A, left=False, right=False)) > mpf(10) ** -32)


def less_error_than_there_is(column: fb.Column, modes: int, dampings: dict[str, float], **own: float) -> str | None:
    """What is wrong with an answer: None where it is right to the error that it states, or refused."""
    try:
        found = fb.critical_load(column, modes, **dampings, load_max=100, **own)
    except InputError as refused:
        return None if "lost in rounding" in str(refused) else str(refused)
    top = found.load or 100.0
    with workdps(60):
        for share in (0.25, 0.5, 0.75, 0.9, 1 - max(found.rounding, 4e-16)):
            if grows(column, modes, dampings, share * top, **own):
                return f"{found.load} states {found.rounding:.1e}, but something grows at {share * top}"
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
