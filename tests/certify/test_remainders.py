"""What a series leaves out is bounded by the formula that the head of its module proves, evaluated again in floats."""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from flint import arb, arb_mat

from freebeam_derive.certify import beam, floquet
from freebeam_derive.certify.balls import Unproven, precision
from freebeam_derive.certify.beam_itself import NoOnset
from freebeam_derive.certify.floquet import Motion, Pulsation
from freebeam_derive.certify.pair_at_rest import _Pair
from freebeam_derive.certify.taylor_steps import Local


def near(value: float, rel: float = 1e-9) -> Any:
    return pytest.approx(value, rel=rel)


# --- the power series of the uniform beam --------------------------------------------------------------------


@pytest.mark.parametrize(("size", "count"), [(1, 30), (2, 16), (4, 9)])
def test_the_tail_of_a_power_series_is_that_of_the_largest_of_its_last_terms(size: int, count: int) -> None:
    """T = max |a_(N−i)| 2^(−i), i < d_max, over both solutions; the first term that is left out of the j-th derivative
    is (N+1)…(N+2−j) T/2, and those after it fall by (N+2)/(2 (N+2−j))."""
    draw = np.random.default_rng(size)
    N = 3 + (count - 1) * size
    norms = {(3, 0): arb(1), (2, 1): arb(2), (0, 1): arb(5)}  # d = 1, 3, 5
    reach = 5
    with precision(128):
        for largest in range(reach + 1):
            a = draw.uniform(0.5, 1.5, (N + 1, 4)) * draw.choice([-1, 1], (N + 1, 4))
            a[N - largest, 2:] *= 100 * 2.0**largest
            a *= 1e-3 if largest % 2 else 1
            b = [[arb(float(v)) * math.factorial(n) for v in row] for n, row in enumerate(a)]
            begins = [0, *range(4, N + 2, size)]
            blocks = [
                arb_mat(b[begin:end]) for begin, end in zip(begins, [*begins[1:], N + 1], strict=False) if b[begin:end]
            ]
            assert sum(block.nrows() for block in blocks) == N + 1 and len(blocks) == count
            sums = [max(sum(abs(row[:2])), sum(abs(row[2:]))) for row in a]
            T = max(sums[N - i] / 2**i for i in range(reach))
            errors = beam._tail(norms, blocks, size, (0, 1, 2, 3))
            assert len(errors) == 4
            for j, found in enumerate(errors):
                first = math.perm(N + 1, j) * T / 2
                assert float(found) == near(first / (1 - (N + 2) / (2 * (N + 2 - j))))


def test_a_recurrence_contracts_where_its_factors_sum_to_one() -> None:
    """Σ |c| 2^d / ((N+1−q)…(N+1−3)) ≤ 1, on both sides of the factor at which it is one."""
    with precision(128):
        for q, k in ((3, 0), (2, 0), (2, 2), (1, 1), (0, 3)):
            for N in (9, 20):
                edge = math.prod(N + 1 - i for i in range(q, 4)) / 2 ** (4 + k - q)
                assert beam._contracts({(q, k): arb(edge) / 2, (3, 0): arb(N - 2) / 4}, N)
                assert not beam._contracts({(q, k): arb(edge) * (1 + arb(2) ** -60)}, N)
                assert beam._contracts({(q, k): arb(edge) * (1 - arb(2) ** -40)}, N)


# --- Taylor steps -------------------------------------------------------------------------------------------


def test_a_step_leaves_out_what_cauchy_says() -> None:
    them: Any = object.__new__(Local)
    with precision(128):
        for size, radius, reach, terms in ((3.0, 0.5, 0.125, 7), (0.25, 2.0, 1.5, 40)):
            wanted = math.exp(size * radius) * (reach / radius) ** terms / (1 - reach / radius)
            assert float(them.remainder(arb(size), arb(radius), arb(reach), terms)) == near(wanted)


def test_the_norm_on_a_disc_is_that_of_the_powers_and_of_the_weights() -> None:
    """a = Σ ‖N_q‖ ρ^q / (1 − Σ_{q>0} ‖L_q‖ ρ^q), at least 2^(w_(i+1) − w_i) of rows that name the next; none where the
    leading coefficients change by half."""
    them: Any = object.__new__(Local)
    them.segment = SimpleNamespace(smooth=True, width=4, tops=[1, 3])
    them.weights = [0, 2, 5, 1]
    with precision(128):
        them.norms = [(arb(3), arb(9)), (arb(2), arb(0.5)), (arb(1), arb(0.25))]
        for radius in (0.25, 0.5):
            lower, changed = 3 + 2 * radius + radius**2, 0.5 * radius + 0.25 * radius**2
            wanted = max(lower / (1 - changed), 4.0)  # of row 0: 2^(2 − 0); of row 2 less
            assert float(them.size(arb(radius))) == near(wanted)
        assert 0.5 < 0.5 * 0.9 + 0.25 * 0.9**2 and them.size(arb("0.9")) is None
        assert 0.5 > 0.5 * 0.7 + 0.25 * 0.7**2 and them.size(arb("0.7")) is not None
        them.weights = [0, 2, 1, 6]
        assert float(them.size(arb(0.25))) == 32.0
        them.norms = [(arb(0), arb(9))]
        them.weights = [0, -3, 0, -5]
        assert float(them.size(arb(1))) == 0.125


# --- a load that pulsates -----------------------------------------------------------------------------------


def moving(*norms: float) -> Any:
    them: Any = object.__new__(Motion)
    them.norms = [arb(v) for v in norms]
    them.n = 1
    return them


@pytest.mark.parametrize("bits", [20, 90])
def test_a_step_leaves_out_the_tails_of_the_cosine_and_of_the_motion(bits: int) -> None:
    """J is the first degree at which both conditions hold, m a multiple of four; of the discs of radius 2^j h the
    smallest that serves counts."""
    for norms, h, omega in (((7.0, 3.0, 5.0), 0.25, 2.0), ((1.0, 2.0), 0.5, 6.0)):
        with precision(200):
            them = moving(*norms)
            J, m, left = them._rest(arb(h), arb(omega), bits)
        tolerance = 2.0**-bits
        x = (len(norms) - 1) * omega * h
        least = 1
        while not (x / (least + 2) < 0.5 and x ** (least + 1) / math.factorial(least) / (least + 1) < tolerance):
            least += 1
        assert least == J
        rest = sum(norms[1:]) * 2 * x ** (J + 1) / math.factorial(J + 1)
        of_cosine = h * rest * math.exp((sum(norms) + rest) * h)

        def tails(m: int, norms: Any = norms, h: float = h, omega: float = omega) -> list[float]:
            found = []
            for j in range(1, 6):  # greater ones are far from the least
                r = h * 2**j
                bound = norms[0] * r
                bound += sum(v * np.expm1(d * omega * r) / (d * omega) for d, v in enumerate(norms[1:], 1))
                found.append(math.exp(bound) * (h / r) ** (m + 1) / (1 - h / r) if bound < 600 else math.inf)
            return found

        least = next(m for m in range(8, 10**4, 4) if min(tails(m)) < tolerance)
        assert least == m
        assert float(left) == near(of_cosine + next(tail for tail in tails(m) if tail < tolerance))


@pytest.mark.parametrize(("norm", "steps"), [(0.5, 8), (16 * 8 + 1.0, 9), (16 * 11 - 1.0, 11), (16 * 21 - 1.0, 21)])
def test_the_steps_of_a_period_are_multiplied_the_later_on_the_left(norm: float, steps: int) -> None:
    """As many as leave each an exponent of 16, eight at least, at phases that part the period alike."""
    them = moving(norm / 2, norm / 2)
    them.pulsation = Pulsation(None, None, 2)  # type: ignore[arg-type]
    them._rest = lambda h, frequency, bits: "rest"
    asked = []

    def step(h: arb, frequency: arb, phase: arb, rest: Any) -> arb_mat:
        asked.append((float(h), float(frequency), float(phase)))
        k = len(asked)
        return arb_mat([[1, k], [0, 2]])

    them._step = step
    with precision(100):
        them.pulsation = SimpleNamespace(frequency=floquet.Fraction(2))
        them.norms = [v / arb.pi() for v in them.norms]  # of a period π
        U, count = them.monodromy(100)
    assert count == steps and asked == [
        (near(math.pi / steps), 2.0, pytest.approx(2 * math.pi * k / steps, rel=1e-12)) for k in range(steps)
    ]
    whole = np.eye(2)
    for k in range(1, steps + 1):
        whole = np.array([[1.0, k], [0, 2]]) @ whole
    assert [[float(U[i, j]) for j in (0, 1)] for i in (0, 1)] == whole.tolist()


def test_more_steps_than_are_feasible_are_refused() -> None:
    for norm, refused in ((floquet.REACH * floquet.MOST_STEPS * 1.001, True), (1.0, False)):
        them = moving(norm)
        them.pulsation = SimpleNamespace(frequency=floquet.Fraction(1))
        them.norms = [arb(norm) / (2 * arb.pi())]
        them._rest = lambda *of: "rest"
        them._step = lambda *of: arb_mat([[1]])
        if refused:
            with pytest.raises(Unproven, match="takes more than 20000 steps"):
                them.monodromy(64)
        else:
            assert them.monodromy(64)[1] == floquet.LEAST_STEPS


# --- a pair of eigenvalues at zero --------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("a", "b", "c", "refused"),
    [
        (1, 1, 1, None), (-1, -1, -1, None), (2, 3, 2, None),
        (1, -1, 1, "growth rate falls"), (-1, 1, -1, "growth rate falls"),
        (1, 2, 1, "leave as a pair"), (1, 3, 1, "leave as a pair"), (-1, 1, 1, "leave as a pair"),
        (1, 0, 1, "direction of the crossing"), (1, "0 +/- 0.5", 1, "direction of the crossing"),
        ("1 +/- 2", 1, 1, "leave as a pair"),
    ],
)  # fmt: skip
def test_a_pair_leaves_zero_where_its_form_is_definite_and_rises(a: Any, b: Any, c: Any, refused: str | None) -> None:
    """a (P − P*)² + b (P − P*) s + c s², b² < 4 a c: to the right where b and c are of one sign."""
    pair: Any = object.__new__(_Pair)
    known = {(2, 0): arb(a), (1, 1): arb(b), (0, 2): arb(c)}
    pair.whole = SimpleNamespace(taylor=lambda P, s, orders: known)
    if refused is None:
        pair.onset([arb(3)], {})
    else:
        with pytest.raises(NoOnset if "falls" in refused else Unproven, match=refused):
            pair.onset([arb(3)], {})
