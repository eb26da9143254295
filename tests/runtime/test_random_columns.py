"""Random columns of segments, masses, springs, dampers, gyroscopic and control terms, against Hermite's elements.

    PYTHONPATH=. python -m tests.runtime.test_random_columns 500 1

draws so many by a seed and prints where the two disagree.
"""

from __future__ import annotations

import random
import sys
from dataclasses import replace
from fractions import Fraction as Q
from typing import Any

import pytest
from sympy import Expr, Piecewise, Rational

from freebeam_derive import emit, pipeline, verify
from freebeam_derive.bases import segments
from freebeam_derive.notation import P, alpha, beta, t, x, y
from freebeam_derive.statement import Column, at, delta, integral, jump
from freebeam_sym.columns import Column as Runtime
from freebeam_sym.question import Question
from freebeam_sym.stability.critical import CriticalLoad, answer
from tests.reference import elements
from tests.reference.systems import At, Beam, Segment, Term, energy, follower

TOP = 60.0


def exact(value: Q) -> Rational:
    return Rational(value.numerator, value.denominator)


def stepped(values: list[Q], breaks: list[Q]) -> Expr:
    if len(values) == 1:
        return exact(values[0])
    pieces = [(exact(v), x < exact(b)) for v, b in zip(values[:-1], breaks, strict=True)]
    return Piecewise(*pieces, (exact(values[-1]), True))


def drawn(seed: int) -> tuple[Column, Beam, dict[str, float]]:
    """A column as it is stated, the same as data for the elements, and what is asked of it."""
    r = random.Random(seed)

    def number(low: int, high: int, of: int = 20) -> Q:
        return Q(r.randint(low, high), of)

    breaks = sorted(r.sample([Q(k, 20) for k in range(4, 17)], r.randint(0, 2)))
    EI, mass = ([number(12, 30) for _ in range(len(breaks) + 1)] for _ in range(2))
    places = [Q(0), *breaks, Q(1)]
    damped = r.random() < 0.6
    a, b = (number(1, 20, 4000), number(0, 20, 100)) if damped else (Q(0), Q(0))
    gyro = number(1, 10, 10) if damped and r.random() < 0.4 else Q(0)
    share = number(8, 24)
    T = integral(stepped(mass, breaks) * y.diff(t) ** 2) / 2
    V = integral(stepped(EI, breaks) * y.diff(x, 2) ** 2) / 2
    work = -exact(share) * P * at(y.diff(x), 1) * at(delta(y), 1)
    if damped:
        work -= integral(stepped(EI, breaks) * alpha * y.diff(x, 2, t) * delta(y.diff(x, 2)))
        work -= integral(beta * y.diff(t) * delta(y))
    parts = [
        Segment(
            low, high, lambda x, v=v: v + 0 * x, lambda x, m=m: m + 0 * x, axial=lambda x, P: P + 0 * x,
            damping=lambda x, b=b: b + 0 * x, gyro=lambda x, P, g=gyro: g * P / 5 + 0 * x,
        )
        for low, high, v, m in zip(places[:-1], places[1:], EI, mass, strict=True)
    ]  # fmt: skip
    if not damped:
        parts = [replace(p, damping=Segment().damping, gyro=Segment().gyro) for p in parts]
    if gyro:
        work -= exact(gyro) * P / 5 * integral(y.diff(x, t) * delta(y))
    terms: list[Term] = [follower(share=lambda P, s=share: P * s)]
    for _ in range(r.randint(0, 3)):
        place, size = Q(r.randint(3, 20), 20), number(1, 20, 10)
        kind = r.choice(["mass", "spring", "crack", "control", *(["damper"] if damped else [])])
        inside = place < 1
        if kind == "mass":
            T += exact(size) * at(y.diff(t), exact(place)) ** 2 / 2
            terms += energy([(At("y", place), 1)], size)
        elif kind == "spring":
            V += 5 * exact(size) * at(y, exact(place)) ** 2 / 2
            terms += energy([(At("y", place), 1)], spring=5 * size)
        elif kind == "damper":
            work -= exact(size) / 10 * at(y.diff(t), exact(place)) * at(delta(y), exact(place))
            terms += energy([(At("y", place), 1)], damping=size / 10)
        elif kind == "crack" and inside and not any(m.moves.place == place for m in terms):
            V += 10 * exact(size) * jump(y.diff(x), exact(place)) ** 2 / 2
            terms += energy([(At("jump slope", place), 1)], spring=10 * size)
        elif kind == "control":
            # a slope just left of its place, as the elements take it
            seen = at(y.diff(x), exact(place), -1) if inside else at(y.diff(x), 1)
            work -= exact(size) / 10 * P * seen * at(delta(y), 1)
            terms.append(Term(At("y", Q(1)), At("slope", place), stiffness=lambda P, s=size: P * s / 10))
    column = Column(
        "random", "Random", T=T, V=V, W_c=P * integral(y.diff(x) ** 2) / 2, dW_nc=work, ends=("clamped", "free")
    )
    return column, Beam(tuple(parts), terms=tuple(terms), alpha=a), {"alpha": float(a), "beta": float(b)}


def found(column: Column, asked: dict[str, float]) -> CriticalLoad:
    """The critical load from the kernel as it is emitted, without its verification."""
    kernel = segments.kernel_of(column, pipeline.general(column).system)
    runtime = Runtime(verify.load(emit.emit(kernel), column.module))
    given = {name: value for name, value in asked.items() if name in runtime.damping}
    return answer(Question.of(runtime, 10, load_max=TOP, **given))  # type: ignore[arg-type]


def disagreement(seed: int) -> str:
    """Where the two differ by more than the elements' error; nothing where they agree."""
    column, beam, asked = drawn(seed)
    ours, theirs = found(column, asked), elements.first_loss(beam, TOP)
    told = f"seed {seed}: {ours.kind} {ours.load}, elements {theirs}"
    if theirs is None or ours.load is None:
        near = ours.load if theirs is None else theirs.load
        return "" if (theirs is None and ours.load is None) or (near and near > 0.99 * TOP) else told
    same = ours.kind == theirs.kind and abs(ours.load / theirs.load - 1) < 2e-4
    return "" if same else told


# one has each of: segments, no damping, a mass, a spring, a crack, a damper, a gyroscopic term, control
@pytest.mark.parametrize("seed", [1000, 1001, 1002, 1003, 1005, 1009])
def test_random_columns_agree_with_elements(seed: int) -> None:
    assert disagreement(seed) == ""


def main(count: int, first: int = 0) -> Any:
    wrong = 0
    for seed in range(first, first + count):
        told = disagreement(seed)
        wrong += bool(told)
        if told:
            print(told, flush=True)
    print(f"{wrong} of {count} disagree")


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
