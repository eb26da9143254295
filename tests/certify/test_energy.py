"""Gyroscopic columns whose energy is kept: a held pipe's divergence, and what forms by parts are against integrals."""

from __future__ import annotations

import math
from fractions import Fraction
from types import SimpleNamespace
from typing import Any

import pytest
from flint import arb, fmpq, fmpq_poly

import freebeam as fb
from freebeam import proofs
from freebeam_derive.certify import beam_itself, energy
from freebeam_derive.certify.balls import Unproven, precision
from freebeam_derive.certify.exact_system import ExactSystem
from freebeam_derive.certify.formal import Formal
from tests.runtime.test_rotors import STATED, column

STATED["held pipe"] = """
from sympy import sqrt
b = Symbol("b", real=True)
column = Column(
    "held-pipe", "a pipe held at both ends", integral(y.diff(t) ** 2) / 2,
    integral(bent(y) ** 2) / 2, P**2 * integral(y.diff(x) ** 2) / 2,
    -integral(2 * sqrt(b) * P * y.diff(x, t) * delta(y) + alpha * y.diff(t) * delta(y)),
    ends=("pinned", "pinned"), parameters=(Parameter(b, "mass ratio", 0.1, 0, 1),),
)
"""


STATED["sleeping top"] = """
column = Column(
    "sleeping-top", "a top", (q.diff(t) ** 2 + p.diff(t) ** 2) / 2, (q**2 + p**2) / 2, P * (q**2 + p**2) / 2,
    p.diff(t) * delta(q) - q.diff(t) * delta(p),
)
"""


def test_where_frequencies_of_a_gyroscopic_column_meet_it_is_said_what_is_proven() -> None:
    """λ⁴ + (1 + 2 k) λ² + k² = 0, k = 1 − P: two are i/2 at P = 5/4."""
    system = ExactSystem(column("sleeping top").kernel)
    with pytest.raises(Unproven, match="as of a gyroscopic column without damping, a series is proven alone"):
        beam_itself.flutter_damped(system, 0, 0, (1.25, 0.5), 8)


def test_a_held_pipe_buckles_at_the_load_of_a_column_whatever_its_flow() -> None:
    """u = π, the first loss by its energy."""
    found = fb.exact_load(column("held pipe"), digits=12, modes=4)
    assert found.load is not None and all(found.proof.values()) and found.kind == "divergence"
    assert float(found.load[0]) < math.pi < float(found.load[1]) and found.frequency == ("0", "0")
    assert found.certificate is None and "no certificate" in found.missing


def test_a_flutter_of_rounding_is_a_divergence_where_energy_is_kept() -> None:
    """Floats see motions grow just below the load, where frequencies are high and all are on the axis."""
    asked = proofs._Asked.of(column("held pipe"), 4, {"b": "9/10"}, alpha=0, beta=0, load_max=None)
    found = proofs._enclosed(asked, (3.14158, 67.6), "flutter", 10, True)
    assert found.kind == "divergence" and found.load is not None and abs(float(found.load[0]) - math.pi) < 1e-9


def test_energy_is_no_proof_beside_damping_nor_of_a_second_load() -> None:
    kernel = column("held pipe").kernel
    assert energy.kept(kernel, {"b": Fraction(9, 10)}, (0, 0)) and not energy.kept(kernel, {}, (1, 0))
    with precision(96), pytest.raises(Unproven, match=r"not known to differ from zero at the load 3\.14"):
        energy.positive_below(ExactSystem(kernel), 2 * arb.pi() + arb(0, 1e-9))


HALF = fmpq(1, 2)
BOTH = frozenset([(0, 0), (1, 0)])
FORMS: dict[str, tuple[Any, Any, int]] = {
    "flow": ([((0, 1), "y", 0, "y", 1, [3])], [], 1),
    "flow from the other side": ([((0, 1), "y", 1, "y", 0, [3])], [], 1),
    "swelling flow": ([((0, 1), "y", 0, "y", 1, [1, 2]), ((0, 1), "y", 0, "y", 0, [1])], [], 1),
    "swelling flow, all of it": ([((0, 1), "y", 0, "y", 1, [1, 2])], [], 1),
    "flow that steps": ([((0,), "y", 0, "y", 1, [1]), ((1,), "y", 0, "y", 1, [2])], [], 1),
    "flow that steps, turned": (
        [((0,), "y", 0, "y", 1, [1]), ((1,), "y", 0, "y", 1, [2])], [(("y", 0, HALF, 1), ("y", 0, HALF, -1), HALF)], 1
    ),
    "a gyroscope": ([], [(("y", 0, HALF, 0), ("y", 1, HALF, 0), 1), (("y", 1, HALF, 0), ("y", 0, HALF, 0), -1)], 1),
    "a dashpot": ([], [(("y", 0, HALF, 0), ("y", 0, HALF, 0), 1)], 1),
    "a slope held": ([((0, 1), "y", 1, "y", 2, [1])], [], 1),
    "thrust": ([((0, 1), "y", 1, "y", 1, [0, 1])], [], -1),
    "thrust by parts": ([((0, 1), "y", 0, "y", 2, [1])], [], -1),
    "thrust that grows, by parts": ([((0, 1), "y", 0, "y", 2, [0, 1])], [], -1),
}  # fmt: skip


def value(form: Any, u: list[fmpq_poly], v: list[fmpq_poly]) -> fmpq:
    """The form of two functions, a polynomial on each half, by integrals."""

    def slope(p: fmpq_poly, order: int) -> fmpq_poly:
        return slope(p.derivative(), order - 1) if order else p

    total = fmpq(0)
    for segments, _, p, _, q, factors in form[0]:
        for k in segments:
            whole = (fmpq_poly(factors) * slope(u[k], p) * slope(v[k], q)).integral()
            total += whole(HALF * (k + 1)) - whole(HALF * k)
    for (_, p, at, s), (_, q, other, r), factor in form[1]:
        total += factor * slope(u[s > 0], p)(at) * slope(v[r > 0], q)(other)
    return total


@pytest.mark.parametrize("held", [BOTH, frozenset([(0, 0)])])
@pytest.mark.parametrize("name", FORMS)
def test_by_parts_a_form_is_nothing_where_its_integrals_are(name: str, held: frozenset[tuple[int, int]]) -> None:
    along, points, side = FORMS[name]
    kernel = SimpleNamespace(FIELDS={"y": (2, held, frozenset())})
    formal = [(*term, [Formal(f) for f in factors]) for *term, factors in along]
    breaks = (Formal(0), Formal(HALF), Formal(1))
    found = energy._cancels(kernel, breaks, (formal, [(a, b, Formal(f)) for a, b, f in points]), side)
    x, bend = fmpq_poly([0, 1]), fmpq_poly([-HALF, 1]) ** 2
    held_at_1 = 1 - x if (1, 0) in held else fmpq_poly([1])
    functions = [[x * held_at_1 * x**k + bend * m * x * held_at_1 for m in (0, j)] for k in range(4) for j in (1, 2)]
    integrals = [
        value((along, points), u, v) + side * value((along, points), v, u) for u in functions for v in functions
    ]
    assert found == (not any(integrals))
