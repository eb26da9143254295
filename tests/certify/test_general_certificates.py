"""Certificates of any column: true ones are accepted, and forged ones refused, by code that shares nothing with the
prover. What is true of a column is found apart from both, by a dense scan of its eigenvalues in floats.

    PYTHONPATH=. python -m tests.certify.test_general_certificates

leaves out each part of each certificate, and puts one of another kind there.
"""

from __future__ import annotations

import copy
import json
import math
import resource
import tempfile
import time
from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from itertools import pairwise
from pathlib import Path
from typing import Any

import flint
import mpmath
import numpy as np
import pytest
from scipy.linalg import eigvals

import freebeam as fb
from freebeam.cli import main
from freebeam_derive.certify import (
    all_crossings,
    certificate,
    first_crossing,
    verifier,
    verifier_of_matrices,
    verifier_parts,
)
from freebeam_derive.certify.balls import Unproven, matrices_of_any, parameters, precision
from freebeam_derive.certify.boundary_polynomials import Question, _of_any, boundary, functions_of
from freebeam_derive.certify.decimals import shown
from tests.stated import FREE, TIMOSHENKO, file_of

F = Fraction
Data = dict[str, Any]
NONE = F(0)
MASS = "T + mu * at(y.diff(t), 1) ** 2 / 2"
CRACK = "V + k * jump(y.diff(x), 0.4) ** 2 / 2"
LINKS = {
    "T": "(2 * p.diff(t) ** 2 + (p.diff(t) + q.diff(t)) ** 2) / 2",
    "V": "(p ** 2 + (q - p) ** 2) / 2",
    "W_c": "P * (p ** 2 + q ** 2) / 2",
    "dW_nc": "-P * q * (delta(p) + delta(q)) - alpha * (p.diff(t) * delta(p) + (q - p).diff(t) * delta(q - p))",
    "ends": "()",
}
FREE_MASS = FREE | {
    "T": "T + mu * at(y.diff(t), 0) ** 2 / 2",
    "W_c": "P * integral((x + mu) / (1 + mu) * y.diff(x) ** 2) / 2",
    "dW_nc": "follower + internal",
    "parameters": "(own(mu, 0.5),)",
}
ANY_PIPE = "-P ** 2 * at(y.diff(x), 1) * at(delta(y), 1) - 2 * b * P * integral(y.diff(x, t) * delta(y))"


@dataclass(frozen=True)
class Case:
    """What a column's statement changes of Beck's column, what is asked, and loads that go beyond what is first."""

    changes: tuple[tuple[str, str], ...]
    modes: int = 4
    alpha: Fraction = NONE
    beta: Fraction = NONE
    top: int = 200


def case(changes: dict[str, str], *asked: Any) -> Case:
    return Case(tuple(changes.items()), *asked)


CASES: dict[str, Case] = {
    "Pflueger": case(  # with a spring inside: alone it is a textbook's column
        {"T": MASS, "V": "V + k * at(y, 0.5) ** 2 / 2", "parameters": "(own(mu, 1.0), own(k, 5.0))"}
    ),
    "Pflueger, beam damped": case(
        {"T": MASS, "dW_nc": "follower + external", "parameters": "(own(mu, 1.0),)"}, 4, F(0), F(1, 2)
    ),
    "mass inside": case({"T": "T + at(y.diff(t), a) ** 2 / 4", "parameters": "(own(a, 0.5),)"}, 3),
    "crack": case({"V": CRACK, "parameters": "(own(k, 10.0),)"}, 3),
    "damped crack": case(
        {
            "V": CRACK,
            "dW_nc": "follower + internal + external - c * jump(y.diff(x, t), 0.4) * delta(jump(y.diff(x), 0.4))",
            "parameters": "(own(k, 10.0), own(c, 0.1))",
        },
        2, F(1, 1000), F(1, 10),
    ),
    "step": case({"V": "integral(Piecewise((1, x < half), (half, True)) * y.diff(x, 2) ** 2) / 2"}, 3),
    "tip damper": case(
        {"dW_nc": "follower - c * at(y.diff(t), 1) * at(delta(y), 1) - integral(k * y.diff(t) * delta(y))",
         "parameters": "(own(c, 0.5), own(k, 0.1))"},
    ),
    "foundation": case(
        {"V": "V + 50 * integral(y ** 2, half, 1)", "dW_nc": "follower + external + internal"}, 3, F(1, 100), F(1, 10)
    ),
    "free with a mass": case(FREE_MASS, 4),
    "free with a crack": case(FREE | {"V": CRACK, "parameters": "(own(k, 10.0),)"}, 3),
    "free with a mass, damped": case(FREE_MASS, 4, F(1, 100)),
    "pipe": case({"W_c": "P ** 2 * integral(y.diff(x) ** 2) / 2", "dW_nc": ANY_PIPE, "parameters": "(own(b, 0.3),)"},
                 4, F(0), F(0), 40),
    "two links": case(LINKS, 1, F(0), F(0), 8),
    "two links, damped": case(LINKS, 1, F(1, 100), F(0), 8),
    "Timoshenko": case(
        TIMOSHENKO | {"dW_nc": "-P * at(psi, 1) * at(delta(y), 1)", "parameters": "(own(k, 100.0), own(b, 0.01))"}, 2
    ),
    "absorber": case(
        {
            "T": "T + 0.1 * q.diff(t) ** 2 / 2",
            "V": "V + 10 * (at(y, 0.7) - q) ** 2 / 4",
            "dW_nc": "follower + external - 0.1 * (at(y.diff(t), 0.7) - q.diff(t)) * delta(at(y, 0.7) - q)",
        },
        2, F(0), F(1, 10),
    ),
    "spring near the tip": case(  # with a dead load: else the tip stays straight, and its stiffness decides nothing
        {"V": "V + k * at(y, 0.9) ** 2 / 2 - integral(y.diff(x) ** 2) / 2", "parameters": "(own(k, 60.0),)"}, 3
    ),
    "remote slope": case(
        {"dW_nc": "follower + external + internal - P / 5 * at(y.diff(x), 0.4) * at(delta(y), 1)"},
        4, F(1, 100), F(1, 10),
    ),
}  # fmt: skip

CONTROL = "-P * (at(y.diff(x), 1) + k * at(y.diff(x), a)) * at(delta(y), 1)"
TURNED = "-P * q * at(delta(y), 1) - (c * q.diff(t) + q - at(y.diff(x), 1)) * delta(q) + external"
SHAFT = {
    "T": "integral(y.diff(t) ** 2 + psi.diff(t) ** 2) / 2",
    "V": "integral(y.diff(x, 2) ** 2 + 6 * psi.diff(x, 2) ** 2 / 5 - c ** 2 * (y ** 2 + psi ** 2)) / 2",
    "W_c": "P * integral(y.diff(x) ** 2 + psi.diff(x) ** 2) / 2",
    "dW_nc": "follower - P * at(psi.diff(x), 1) * at(delta(psi), 1)"
    " + 2 * c * integral(psi.diff(t) * delta(y) - y.diff(t) * delta(psi))",
    "parameters": "(own(c, 1.0),)",
}
TOP = {
    "T": "(p.diff(t) ** 2 + q.diff(t) ** 2) / 2",
    "V": "-((1 + P) * p ** 2 + (1 + P) * q ** 2) / 2",
    "W_c": "0",
    "dW_nc": "-k * (p.diff(t) * delta(q) - q.diff(t) * delta(p))",
    "ends": "()",
    "parameters": "(own(k, 4.0),)",
}
TORQUE = "follower - P * k * at(y.diff(x), a) * delta(at(y.diff(x), a))"
RESTING = {  # p and q have no spring; r has, and a damper
    "T": "(p.diff(t) ** 2 + q.diff(t) ** 2 + (r := Coordinate('r')).diff(t) ** 2) / 2",
    "V": "5 * r ** 2",
    "W_c": "-P * (p ** 2 / 2 + q ** 2 + (p + q) * r)",
    "dW_nc": "-alpha * r.diff(t) * delta(r)",
    "ends": "()",
}
FROM_REST = {
    "torque": case(FREE | {"dW_nc": TORQUE, "parameters": "(own(k, 2.0), own(a, 0.25))"}, 3, F(0), F(0), 200),
    "torque, damped": case(
        FREE | {"dW_nc": f"{TORQUE} + external", "parameters": "(own(k, 2.0), own(a, 0.25))"}, 3, F(0), F(1, 10), 200
    ),
    "two links that the load restores": case(
        LINKS | {"V": "(q - p) ** 2 / 2", "dW_nc": "P * q * delta(p) - P * (2 * p + 4 * q) * delta(q)"},
        1, F(0), F(0), 8,
    ),
    "torque, damped inside": case(
        FREE | {"dW_nc": f"{TORQUE} + internal", "parameters": "(own(k, 2.0), own(a, 0.25))"},
        2, F(1, 100), F(0), 200,
    ),
    "two that rest, damped beside": case(RESTING, 1, F(1, 10), F(0), 8),
}  # fmt: skip
GYROSCOPIC = {
    "pipe held at both ends": case(
        {"W_c": "P ** 2 * integral(y.diff(x) ** 2) / 2", "dW_nc": "-2 * b * P * integral(y.diff(x, t) * delta(y))",
         "ends": '("clamped", "pinned")', "parameters": "(own(b, 0.3),)"},
        3, F(0), F(0), 7,
    ),
    "spinning shaft": case(SHAFT, 3, F(0), F(0), 30),
    "top": case(TOP, 1, F(0), F(0), 8),
}  # fmt: skip
MASSLESS = {
    "thrust that turns late": case({"dW_nc": TURNED, "parameters": "(own(c, 0.001),)"}, 3, F(0), F(1, 2), 40),
    "thrust that turns at once": case({"dW_nc": TURNED, "parameters": "(own(c, 0),)"}, 3, F(0), F(0), 40),
    "damper on a spring": case(
        {"V": "V + 5 * (at(y, 1) - q) ** 2", "dW_nc": "follower - q.diff(t) * delta(q) + external"},
        3, F(0), F(1, 10), 40,
    ),
}  # fmt: skip
CASES |= FROM_REST | GYROSCOPIC | MASSLESS


@cache
def column(name: str) -> fb.Column:
    with tempfile.TemporaryDirectory() as folder:
        return fb.column(file_of(Path(folder), name, dict(CASES[name].changes)))


def question(name: str) -> Question:
    asked = CASES[name]
    return Question(asked.modes, asked.alpha, asked.beta, None, parameters(column(name).kernel))


# --- what is true, by floats ------------------------------------------------------------------------------------


@cache
def matrices(name: str, N: int) -> Any:
    asked = CASES[name]
    return column(name).coefficients(N, False, float(asked.alpha), float(asked.beta))


def eigenvalues(name: str, load: float, N: int | None = None) -> Any:
    return of_matrices(*matrices(name, N or CASES[name].modes).at(load))


def of_matrices(M: Any, C: Any, K: Any) -> Any:
    """The finite eigenvalues."""
    (found,) = of_each(M[None], C[None], K[None])
    return found[np.isfinite(found)]


def of_each(M: Any, C: Any, K: Any) -> Any:
    """Eigenvalues of each system of a stack, (loads, 2 n); not a number where one is infinite."""
    if not C.any():
        half = np.sqrt(finite(-K, M).astype(complex))
        return np.concatenate([half, -half], axis=1)
    one = np.broadcast_to(np.eye(M.shape[-1]), M.shape)
    return finite(np.block([[0 * M, one], [-K, -C]]), np.block([[one, 0 * M], [0 * M, M]]))


def finite(A: Any, B: Any) -> Any:
    if np.linalg.cond(B).max() < 1e8:
        found = np.linalg.eigvals(np.linalg.solve(B, A))
    else:
        found = np.array([eigvals(a, b) for a, b in zip(A, B, strict=True)])
    return np.where(np.isfinite(found) & (np.abs(found) < 1e12), found, np.nan)


def unstable(name: str, loads: Any, N: int | None = None) -> Any:
    """How many eigenvalues grow at each load, (loads,)."""
    N = N or CASES[name].modes
    loads = np.asarray(loads)[:, None, None]
    n = matrices(name, N).M[0].shape
    values = of_each(*(np.broadcast_to(X, (len(loads), *n)) for X in matrices(name, N).at(loads)))
    damped = matrices(name, N).C and name not in GYROSCOPIC
    largest = np.nanmax(np.abs(values), axis=1, keepdims=True)
    return (values.real > (1e-11 if damped else 1e-6) * largest).sum(axis=1)


@cache
def crossings(name: str, N: int | None = None) -> list[tuple[float, float, int, int]]:
    """Loads at which the number of unstable eigenvalues changes, the frequency of what does, and the numbers."""
    loads = np.linspace(0, CASES[name].top, 2500)[1:]
    counts = unstable(name, loads, N)
    found = []
    for (a, before), (b, after) in pairwise(zip(loads, counts, strict=True)):
        if before != after:
            low, high = a, b
            for _ in range(45):
                middle = (low + high) / 2
                low, high = (middle, high) if unstable(name, [middle], N) == before else (low, middle)
            here = eigenvalues(name, high if after > before else low, N)
            found.append((high, abs(here[here.real.argmax()].imag), before, after))
    return found


@cache
def proven(name: str) -> first_crossing.Enclosure:
    """The prover's, from the scan's first crossing."""
    load, omega, *_ = crossings(name)[0]
    near = load, 0.0 if omega < 1e-3 else omega
    return first_crossing.certify(column(name).kernel, question(name), near, 12, F(CASES[name].top))


@cache
def text(name: str) -> str:
    return json.dumps(certificate.write(column(name).kernel, proven(name)))


def written(name: str) -> Data:
    data: Data = json.loads(text(name))
    return data


def refused(data: Data, match: str | None = None) -> None:
    with pytest.raises(verifier.Refused, match=match):
        verifier.verify(data)


# --- true certificates --------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", CASES)
def test_a_true_certificate_is_accepted_and_says_what_it_proves(name: str) -> None:
    data, asked = written(name), CASES[name]
    found = verifier.verify(data)
    assert isinstance(found, verifier.OfForms) and found.load is not None
    load, omega, before, _ = crossings(name)[0]
    damped = any(X.any() for X in matrices(name, asked.modes).C) and name not in GYROSCOPIC
    assert before == 0 and found.damped == damped and found.gyroscopic == (name in GYROSCOPIC)
    assert float(found.load[0]) == pytest.approx(load, rel=1e-5)  # a divergence by the root of what grows
    assert (found.kind == "divergence") == (omega < 1e-3)
    if found.frequency is not None:
        assert float(found.frequency[0]) == pytest.approx(omega, rel=1e-3)
    assert found.size == len(matrices(name, asked.modes).M[0])
    said, above_zero = str(found), ("pipe", *FROM_REST)
    assert "of the forms in this file" in said and f"N = {asked.modes} ({found.size} functions)" in said
    assert "\n" not in said and all(v in said for v in shown(*found.load))
    assert ("above 0 up to" in said) == (name in above_zero)
    assert ("left out" in said) == ("free" in name or "torque" in name)
    assert ("undamped" in said) != damped and all(breaks in said for breaks in ("0, ", " 1,"))
    record = found.record()
    assert record["load_lower"] in said and record["of"] == "the forms in this file"
    assert proven(name).above_zero == (name in above_zero)
    assert record["stable_at_zero_load"] is (None if name in above_zero else True)


@pytest.mark.parametrize("name", CASES)
def test_the_verifier_s_matrices_have_the_kernel_s_eigenvalues(name: str) -> None:
    data, asked = written(name), CASES[name]
    _, N, system, *_ = verifier.of_forms(data)
    load = 0.7 * crossings(name)[0][0]
    with flint.ctx.workprec(300):
        found = system()
        M, C, K = (
            sum((load**k * np.array(X.tolist(), dtype=float) for k, X in enumerate(powers)), np.zeros((N, N)))
            for powers in (found.M, found.C, found.K)
        )
    theirs = np.sort_complex(np.round(eigenvalues(name, load), 9))
    ours = of_matrices(M, C, K)
    for part in data.get("parts", [])[:1]:
        if part["frame"]:  # ω + turn stands for ω²
            omega = -(ours**2).real - float(F(part["frame"]["turn"]))
            ours = np.concatenate([1j * omega, -1j * omega])
    for value in theirs:
        assert np.abs(ours - value).min() < 1e-6 * max(1, abs(value)), asked
    assert len(np.unique(ours.round(9))) == len(np.unique(theirs.round(9)))


def test_a_column_without_a_crossing() -> None:
    name = "damped crack"
    data = written(name)
    enclosure = first_crossing.certify(column(name).kernel, question(name), None, 12, F(5))
    none = json.loads(json.dumps(certificate.write(column(name).kernel, enclosure)))
    assert "from 0 to 5" in str(verifier.verify(none))
    refused(none | {"load_max": "6"}, "not shown up to")
    refused(none | {k: data[k] for k in ("kind", "load", "frequency_squared", "load_max", "proof")}, "not shown up to")


def test_alpha_and_beta_are_those_of_the_file_s_own_parts() -> None:
    """C = C_1 + alpha C_alpha + beta C_beta: the parts are independent of the alpha and beta that were asked."""
    data = written("damped crack")
    other = first_crossing.certify(
        column("damped crack").kernel, Question(2, F(1, 50), F(0), None, question("damped crack").own), None, 8, F(1)
    )
    assert certificate.write(column("damped crack").kernel, other)["forms"] == data["forms"]
    assert verifier.verify(data).record()["alpha"] == "0.001"


@pytest.mark.parametrize(("place", "damping"), [("0", F(0)), ("0.25", F(1, 100)), ("1", None)])
def test_beals_control_diverges_alike_wherever_its_sensor_is(
    place: str, damping: Fraction | None, tmp_path: Path
) -> None:
    """At 25.6381813768019637, of a motion that the load alone restores; internal damping, and its limit (None), vanish
    with the load there, and decide nothing of a divergence."""
    changes = FREE | {"dW_nc": f"{CONTROL} + internal", "parameters": f"(own(k, 0.1), own(a, {place}))"}
    kernel = fb.column(file_of(tmp_path, "sample", changes)).kernel
    asked = Question(12, damping or F(0), kappa=F(0) if damping is None else None, own=parameters(kernel))
    found = first_crossing.certify(kernel, asked, (25.638181, 0.0), 15)
    assert found.kind == "divergence" and found.load is not None
    assert float(found.load[0]) == pytest.approx(25.6381813768019637, rel=1e-15)
    assert "above 0 up to" in str(verifier.verify(json.loads(json.dumps(certificate.write(kernel, found)))))


def test_a_thrust_that_turns_at_once_is_becks_and_a_top_falls_at_three() -> None:
    """A coordinate without mass or rate is eliminated exactly; and 4 (1 + P) = k² at k = 4, with ω² = 4."""
    both = [proven("thrust that turns at once").load, beck().load]
    (a, b), (c, d) = filter(None, both)
    assert max(a, c) < min(b, d)
    found = fb.critical_load(column("thrust that turns at once"), 3).load  # floats see it too
    assert found == pytest.approx(float(a), rel=1e-9)
    top = proven("top")
    assert top.load is not None and top.load[0] < 3 < top.load[1]
    assert top.frequency is not None and top.frequency[0] < 2 < top.frequency[1]


def test_a_proof_of_too_many_functions_is_refused_with_what_is_feasible() -> None:
    with pytest.raises(Unproven, match=r"a proof of 121 functions .* up to 100 are feasible: give N = 49 or less"):
        first_crossing.certify(column("crack").kernel, Question(60), None, 8)
    assert functions_of(column("crack").kernel, 49) <= 100
    assert functions_of(column("torque").kernel, 3) == len(matrices("torque", 3).M[0])


def beck() -> first_crossing.Enclosure:
    kernel, name = fb.column("beck", "legendre").kernel, "thrust that turns at once"
    asked = Question(CASES[name].modes, own=parameters(kernel))
    return first_crossing.certify(kernel, asked, crossings(name)[0][:2], 12)


# --- forgeries --------------------------------------------------------------------------------------------------------


def about(value: float) -> list[str]:
    return [str(F(value) * F(999, 1000)), str(F(value) * F(1001, 1000))]


def with_lines(data: Data, more: int) -> list[Data]:
    """The stretches with so many lines more above all others, or fewer."""
    result = []
    for s in data["stretches"]:
        lines = list(s["separators"])
        while len(lines) < len(s["separators"]) + more:
            lines.append([str(3 * F(lines[-1][0])), "0"])
        result.append(s | {"separators": lines[: len(s["separators"]) + more]})
    return result


def altered(data: Data, place: tuple[Any, ...], value: Any) -> Data:
    data = copy.deepcopy(data)
    inner: Any = data
    for key in place[:-1]:
        inner = inner[key]
    inner[place[-1]] = value
    return data


def at(data: Any, place: tuple[Any, ...]) -> Any:
    for key in place:
        data = data[key]
    return data


def other_claims(name: str, data: Data) -> Iterator[Data]:
    """Wrong kind, later crossing, another branch's frequency, intervals that hold more, stability beyond."""
    low, high = map(F, data["load"])
    kind, later = data["kind"], [c for c in crossings(name) if c[0] > 1.0001 * float(high)]
    flutter, divergence = {"kind": "flutter"}, {"kind": "divergence", "frequency_squared": None}
    none = {"kind": "none", "load": None, "frequency_squared": None,
            "proof": {"crossing": False, "first": False, "stable_below": True, "kind": True}}  # fmt: skip

    def reaching(load: Fraction) -> list[Data]:
        return [*data["stretches"][:-1], data["stretches"][-1] | {"end": str(load)}]

    for load in (high, high * F(11, 10), *(F(c[0]) for c in later)):
        yield data | none | {"load_max": str(load), "stretches": reaching(load)}
    squares = sorted({round(abs(v.imag) ** 2, 6) for v in eigenvalues(name, float(low)) if abs(v.imag) > 1e-3})
    if kind == "flutter":
        true = sum(map(F, data["frequency_squared"])) / 2
        squares = [s for s in squares if abs(F(s) / true - 1) > F(1, 100)]
        yield data | divergence
        yield data | {"frequency_squared": [str(F(v) * F(11, 10)) for v in data["frequency_squared"]]}
    for square in squares or [1.0]:
        yield data | flutter | {"frequency_squared": about(square)}
    for edge in [F(c[0]) * F(10001, 10000) for c in later]:
        wide = data | {"load": [str(low), str(edge)]}
        if kind == "flutter":
            yield wide | divergence
        yield wide | flutter | {"frequency_squared": ["1/1000000", "1000000000"]}
    for load, omega, *_ in later:
        place = [str(F(load) * (1 + k * F(1, 10**6))) for k in (-1, 1)]
        claim = {"kind": "flutter", "frequency_squared": about(omega**2)} if omega > 1e-3 else divergence
        yield data | claim | {"load": place}
        yield data | claim | {"load": place, "stretches": reaching(F(place[0]))}
    moved = str(low * F(999, 1000)), str(low * F(9999, 10000))
    yield data | {"load": moved, "stretches": reaching(F(moved[0]))}


def other_columns(name: str, data: Data) -> Iterator[Data]:
    """The claim kept, and a column that does not fulfil it: other breaks, N, damping, factors, places."""
    divergence, count = data["kind"] == "divergence", len(data["fields"]) * (len(data["breaks"]) - 1)
    for k in range(1, len(data["breaks"]) - 1):
        yield altered(data, ("breaks", k), str(F(data["breaks"][k]) + F(1, 1000)))
    for more in (-1, 1) if data["fields"] else ():
        lines = more * count * (1 + damped(data))
        yield data | {"modes": data["modes"] + more}
        yield data | {"modes": data["modes"] + more, "stretches": with_lines(data, lines)}
    for rate, part in (("alpha", "C_alpha"), ("beta", "C_beta")):
        there = any(form["along"] or form["points"] for form in data["forms"][part])
        if there and not divergence:  # which det K alone decides
            yield data | {rate: str(F(data[rate]) * F(1001, 1000) + F(1, 10**6))}
            yield data | {rate: "0" if F(data[rate]) else "1/10"}
    for place in factors(data["forms"]):
        still = divergence and place[0] != "K"
        if not still and (place[0] not in ("C_alpha", "C_beta") or F(data[place[0][2:]])):
            value = F(at(data["forms"], place)) * F(1000001, 1000000)
            yield altered(data, ("forms", *place), str(value))


def other_spaces(name: str, data: Data) -> Iterator[Data]:
    """The claim kept, and other joints, supports or rigid motions; with as many lines as before, and as fit."""
    each, segments = 1 + damped(data), len(data["breaks"]) - 1

    def with_fitting(changed: Data, more: int) -> Iterator[Data]:
        yield changed
        yield changed | {"stretches": with_lines(data, more * each)}

    for field, space in data["fields"].items():
        joints = [[k, order] for k in range(1, segments) for order in range(space["joined"])]
        supports = [[end, order] for end in (0, 1) for order in range(space["joined"])]
        for part, every, sign in (("opened", joints, 1), ("held", supports, -1)):
            for one in every:
                there = one in space[part]
                other = [v for v in space[part] if v != one] if there else [*space[part], one]
                yield from with_fitting(altered(data, ("fields", field, part), other), -sign if there else sign)
    for k in range(len(data["rigid"])):
        yield from with_fitting(data | {"rigid": data["rigid"][:k] + data["rigid"][k + 1 :]}, 1)
    rest: Data = {field: [["0", "0"]] * segments for field in data["fields"]}
    shift: Data = {field: [["1"]] * segments for field in data["fields"]}
    turn: Data = {field: [["0", "1"]] * segments for field in data["fields"]}
    for motion in (rest, shift, turn, dict.fromkeys(data["coordinates"], "1")):
        yield from with_fitting(data | {"rigid": [*data["rigid"], motion]}, -1)


def factors(forms: Data) -> Iterator[tuple[Any, ...]]:
    """Places of the factors of all forms that are not zero, and of the values' places on the beam."""
    for letter, powers in forms.items():
        for k, form in enumerate(powers):
            for n, (*_, coefficients) in enumerate(form["along"]):
                yield from ((letter, k, "along", n, 5, m) for m, value in enumerate(coefficients) if F(value))
            for n, (*values, _) in enumerate(form["points"]):
                yield (letter, k, "points", n, 2)
                inner = (i for i, value in enumerate(values) if value[2] is not None and 0 < F(value[2]) < 1)
                yield from ((letter, k, "points", n, i, 2) for i in inner)


def damped(data: Data) -> bool:
    found = verifier.verify(data)
    assert isinstance(found, verifier.OfForms)
    return found.damped


@pytest.mark.parametrize("name", CASES)
def test_forgeries_are_refused(name: str) -> None:
    data, count = written(name), 0
    for forgery in (*other_claims(name, data), *other_columns(name, data), *other_spaces(name, data)):
        with pytest.raises(verifier.Refused):
            pytest.fail(f"accepted: {differences(data, forgery)}: {verifier.verify(forgery)}")
        count += 1
    assert count >= 12


def differences(one: Any, other: Any) -> Any:
    if isinstance(one, dict) and isinstance(other, dict):
        return {k: differences(one[k], other.get(k)) for k in one if one[k] != other.get(k)}
    return one, other


@pytest.mark.parametrize("name", ["damped crack", "free with a mass", "two links, damped", "pipe"])
def test_any_part_left_out_or_of_another_kind_is_refused(name: str) -> None:
    """Of parts that only their numbers in a list tell apart, the first."""
    data, seen = written(name), set()
    for place in places(data):
        of = (*(key if isinstance(key, str) else "" for key in place[:-1]), place[-1])
        if of not in seen and counts(data, place):
            seen.add(of)
            refused_without(data, place)


def counts(data: Data, place: tuple[Any, ...]) -> bool:
    return place[0] not in ("column", "parameters") and heavy(data, place)


def refused_without(data: Data, place: tuple[Any, ...]) -> None:
    left = copy.deepcopy(data)
    del at(left, place[:-1])[place[-1]]
    refused(left)
    for value in (None, {}, -1, 1.5, "x"):
        if value != at(data, place):
            refused(altered(data, place, value))


def places(data: Any, here: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    """All places in a certificate, of numbers, words, lists and objects."""
    for key, value in data.items() if isinstance(data, dict) else enumerate(data) if isinstance(data, list) else ():
        yield (*here, key)
        yield from places(value, (*here, key))


def heavy(data: Data, place: tuple[Any, ...]) -> bool:
    """Whether a part is there to change something: no zero, no form of nothing, no side of what is continuous."""
    if at(data, place) == "0" or (place[0] == "forms" and place[-1] == 3):
        return False
    if place[0] != "forms" or len(place) < 3:
        return True
    powers = data["forms"][place[1]]
    factor = data[place[1][2:]] if place[1] in ("C_alpha", "C_beta") else "1"
    still = data["kind"] == "divergence" and place[1] != "K"
    return not still and F(factor) != 0 and any(f["along"] or f["points"] for f in powers[place[2] :])


def test_lines_through_the_origin_are_those_of_a_motion_that_rests_there() -> None:
    """Of a column without such a motion the first stretch may not begin with lines that meet."""
    for name in ("crack", "torque", "two links that the load restores"):
        data = written(name)
        first, second = data["stretches"][0]["separators"][:2]
        meeting = [["0", str(F(point) + F(slope) or F(1))] for point, slope in (first, second)]
        meeting[1][1] = str(2 * F(meeting[0][1]))
        stretch = data["stretches"][0] | {"origin": "0"}
        forged = stretch | {"separators": [*meeting, *stretch["separators"][2:]]}
        match = None if name in FROM_REST else "do not ascend"
        refused(data | {"stretches": [forged, *data["stretches"][1:]]}, match)


@pytest.mark.parametrize("rate", ["-1/1" + 100 * "0", "-1/1000"])
def test_damping_too_small_for_balls_is_not_taken_for_none(rate: str) -> None:
    """λ² + (P + rate) λ + P = 0: what the load restores grows up to the load −rate, however small that is."""

    def of(value: str) -> Data:
        return {"along": [], "points": [[["a", 0, None, 0], ["a", 0, None, 0], value]]}

    forms = {"M": [of("1")], "C_1": [of(rate), of("1")], "C_alpha": [], "C_beta": [], "K": [of("0"), of("1")]}
    given = {"parameters": {}, "modes": 1, "alpha": "0", "beta": "0", "kappa": None, "kind": "none", "load": None}
    space = {"breaks": ["0", "1"], "fields": {}, "coordinates": ["a"], "rigid": [], "frequency_squared": None}
    stretch = {"start": "0", "end": "1", "origin": "0", "separators": [["0", "2"]]}
    proof = {"crossing": False, "first": False, "stable_below": True, "kind": True}
    data = {"format": verifier.GENERAL, "column": "own", "forms": forms, "load_max": "1", "proof": proof}
    data |= given | space | {"stretches": [stretch]}
    refused(data, "not separated")
    without = forms | {"C_1": [of("0"), of("1")]}
    assert "above 0 up to 1" in str(verifier.verify(data | {"forms": without}))
    M, C, K = ([np.array([[flint.fmpq(*F(v).as_integer_ratio())]]) for v in terms]
               for terms in (["1"], [rate, "1"], ["0", "1"]))  # fmt: skip
    with precision(200):
        whole = _of_any(M, C, K, False)
        lines = ((NONE, F(2)),)
        assert whole.rests == 1 and not first_crossing.holds(whole, first_crossing.Stretch(NONE, F(1), NONE, lines))
        whole = _of_any(M, [0 * C[0], C[1]], K, False)
        assert first_crossing.holds(whole, first_crossing.Stretch(NONE, F(1), NONE, lines))


def test_a_line_more_is_that_of_damping_that_vanishes_with_the_load() -> None:
    """The first stretch alone has it, from P = x = 0 on, and it stands for what the signs of g − c h prove."""
    data = written("two that rest, damped beside")
    first, second, *others = data["stretches"]
    low, *lines = first["separators"]
    for separators in (lines, [["0", "0"], *lines], [lines[0], *lines], [low, lines[1], *lines[1:]]):
        refused(data | {"stretches": [first | {"separators": separators}, second, *others]})
    moved = [["1/1000", "1/1000"], *second["separators"]]
    refused(data | {"stretches": [first, second | {"separators": moved}, *others]}, "too many")
    apart = [[str(F(point) + F(slope)), "0"] for point, slope in first["separators"]]
    refused(data | {"stretches": [first | {"separators": apart}, second, *others]})
    without = written("torque, damped")
    first, *others = without["stretches"]
    more = first | {"separators": [["0", "1/1000"], *first["separators"]]}
    refused(without | {"stretches": [more, *others]}, "too many")


def test_a_motion_that_rests_and_then_grows_is_refused(tmp_path: Path) -> None:
    """The same frequencies at small loads, and damping that drives one of the motions to second order in P."""
    grows = RESTING | {
        "W_c": "-P * (p ** 2 / 2 + q ** 2)",
        "dW_nc": RESTING["dW_nc"] + " - P * (p + q) * delta(r) + P * r * delta(p) / 10",
    }
    kernel = fb.column(file_of(tmp_path, "sample", grows)).kernel
    asked = Question(1, F(1, 10), own={})
    with pytest.raises(Unproven, match="not known to be stable"):
        first_crossing.certify(kernel, asked, None, 8, F(1, 100))
    M, C, K = (sum(float(v) * np.array(X, dtype=float) for v, X in zip((1, 1 / 100), terms, strict=False))
               for terms in matrices_of_any(kernel, 1, {}, (F(1, 10), F(0))))  # fmt: skip
    assert of_matrices(M, C, K).real.max() > 1e-10
    stretches = first_crossing.certify(
        column("two that rest, damped beside").kernel, asked, None, 8, F(1, 100)
    )  # of a column that differs in nothing but what couples
    refused(json.loads(json.dumps(certificate.write(kernel, stretches))), "not separated")


def test_damping_that_vanishes_with_the_load_where_a_coordinate_has_no_mass(tmp_path: Path) -> None:
    """The degree in λ is odd: the last root of g lies beyond all roots of h."""
    lag = RESTING | {
        "V": "5 * r ** 2 + (r - (s := Coordinate('s'))) ** 2 / 2", "dW_nc": "-alpha * s.diff(t) * delta(s)"
    }  # fmt: skip
    kernel = fb.column(file_of(tmp_path, "sample", lag)).kernel
    found = first_crossing.certify(kernel, Question(1, F(1, 10), own={}), None, 8, F(1, 2))
    said = verifier.verify(json.loads(json.dumps(certificate.write(kernel, found))))
    assert "above 0 up to 0.5" in str(said) and len(found.stretches[0].separators) == 7


def test_external_damping_alone_vanishes_where_it_acts_on_all_mass_and_where_it_does_not() -> None:
    """Where C is a part of M the crossing is that without damping; with a mass that is not damped it is another."""
    for name in ("foundation", "Pflueger, beam damped"):
        kernel, own = column(name).kernel, question(name).own
        near = fb.critical_load(column(name), 2, kappa=math.inf)
        assert near.load is not None and near.frequency is not None
        found = first_crossing.certify(kernel, Question(2, kappa=math.inf, own=own), (near.load, near.frequency), 12)
        said = verifier.verify(json.loads(json.dumps(certificate.write(kernel, found))))
        assert "beta -> 0+ at alpha = 0" in str(said) and said.record()["kappa"] == "inf"
        small, none = (fb.critical_load(column(name), 2, beta=beta).load for beta in (1e-4, 0))
        assert found.load is not None and small is not None and none is not None
        assert float(found.load[0]) == pytest.approx(small, rel=1e-6)
        assert (abs(small / none - 1) < 1e-6) == (name == "foundation")


def limit_of(changes: dict[str, str], N: int, near: tuple[float, float] | None, top: int = 40) -> Data:
    """The certificate of the limit of vanishing internal damping."""
    with tempfile.TemporaryDirectory() as folder:
        kernel = fb.column(file_of(Path(folder), "sample", changes)).kernel
    found = first_crossing.certify(kernel, Question(N, kappa=F(0), own=parameters(kernel)), near, 12, F(top))
    data: Data = json.loads(json.dumps(certificate.write(kernel, found)))
    return data


def test_damping_that_vanishes_may_act_on_a_coordinate_without_mass(tmp_path: Path) -> None:
    """A spring that relaxes: the load is the limit of those of small damping. With a negative stiffness of its own the
    coordinate runs away, at a rate of 1/alpha, though without damping nothing does."""
    relaxing = {"V": "V + 5 * (at(y, 1) - q) ** 2", "dW_nc": "follower - alpha * q.diff(t) * delta(q)"}
    column_ = fb.column(file_of(tmp_path, "sample", relaxing))
    limit, small = fb.critical_load(column_, 3, kappa=0), fb.critical_load(column_, 3, alpha=1e-3)
    assert limit.load is not None and limit.frequency is not None
    assert limit.load == pytest.approx(small.load, rel=1e-8)
    data = limit_of(relaxing, 3, (limit.load, limit.frequency))
    found = verifier.verify(data)
    assert found.load is not None and float(found.load[0]) == pytest.approx(limit.load, rel=1e-9)
    spring = next(n for n, (*_, v) in enumerate(data["forms"]["K"][0]["points"]) if v == "10")
    for value in ("-10", "1"):
        refused(altered(data, ("forms", "K", 0, "points", spring, 2), value))
    refused(altered(data, ("forms", "C_alpha", 0, "points", 0, 2), "-1"))
    refused(altered(data, ("forms", "C_alpha", 0, "points"), []), "no damping that could vanish")
    away = relaxing | {"V": "V + 5 * (at(y, 1) - q) ** 2 - 8 * q ** 2"}
    with pytest.raises(fb.InputError, match="grows at the smallest loads"):
        fb.critical_load(fb.column(file_of(tmp_path, "sample", away)), 3, kappa=0)
    with pytest.raises(Unproven, match="not known to decay at the load 0 in the limit"):
        limit_of(away, 3, None, 1)


def test_what_has_no_mass_but_damping_that_vanishes_needs_stiffness_and_no_mass_from_the_load() -> None:
    """Else there are other powers of the damping than 1/ε, which `Fast` does not see."""

    def of(M: list[list[list[int]]], K: list[list[int]]) -> verifier.Fast:
        C = [flint.fmpq_mat([[0, 0], [0, 1]])]
        masses, stiff = [flint.fmpq_mat(X) for X in M], [flint.fmpq_mat(K)]
        still, highest = (verifier.degrees(masses, X, stiff).highest for X in ([], C))
        return verifier.Fast.of(masses, C, stiff, still, highest - still)

    heavy, none = [[1, 0], [0, 0]], [[0, 0], [0, 0]]
    with flint.ctx.workprec(100):
        of([heavy], [[2, 1], [1, 3]]).decay(F(1))
        for K, match in (([[2, 1], [1, -3]], "may not decay"), ([[2, 1], [1, 0]], "neither mass nor stiffness")):
            with pytest.raises(verifier.Refused, match=match):
                of([heavy], K).decay(F(1))
        of([heavy, none], [[2, 1], [1, 3]])
        for more in ([[0, 1], [0, 0]], [[0, 0], [1, 0]], [[0, 0], [0, 1]]):
            with pytest.raises(verifier.Refused, match="gets mass from the load"):
                verifier.Fast.of(
                    [flint.fmpq_mat(heavy), flint.fmpq_mat(more)], [flint.fmpq_mat([[0, 0], [0, 1]])],
                    [flint.fmpq_mat([[2, 1], [1, 3]])], 2, 1,
                )  # fmt: skip


RING = {  # three lags that drive each other in a ring: (μ + 1)³ + k = 0, stable for k < 8
    "T": "p.diff(t) ** 2 / 2",
    "V": "p ** 2 / 2",
    "W_c": "P * p ** 2 / 2",
    "dW_nc": "-alpha * (p.diff(t) * delta(p) + q.diff(t) * delta(q) + (r := Coordinate('r')).diff(t) * delta(r)"
    " + (s := Coordinate('s')).diff(t) * delta(s)) - (q + (k + c * P) * s) * delta(q) - (r - q) * delta(r)"
    " - (s - r) * delta(s)",
    "ends": "()",
}


def test_coordinates_without_mass_may_swing_up_among_themselves() -> None:
    """Which neither h nor g of first order in the damping tells: their stiffness and trace are positive."""

    def ring(k: str, c: str = "0") -> dict[str, str]:
        return RING | {"parameters": f"(own(k, {k}), own(c, {c}))"}

    data = limit_of(ring("7.99"), 1, (1.0, 0.0), 3)
    assert "stability is first lost by divergence" in str(verifier.verify(data))
    for k, c, load in (("8.01", "0", "0"), ("7", "1.5", "0.")):
        with pytest.raises(Unproven, match=f"decay at the load {load}"):
            limit_of(ring(k, c), 1, (1.0, 0.0), 3)
    limit_of(ring("7", "0.999"), 1, (1.0, 0.0), 3)
    by_k = next(n for n, (*_, v) in enumerate(data["forms"]["K"][0]["points"]) if v == "799/100")
    refused(altered(data, ("forms", "K", 0, "points", by_k, 2), "801/100"), "may not decay at the load 0")
    wide = limit_of(ring("7", "0.95"), 1, (1.0, 0.0), 3)  # (7 + 0.95 P) reaches 8 at P = 1.053
    wide["stretches"] = [wide["stretches"][0] | {"end": "9/10"}]
    verifier.verify(wide | {"load": ["9/10", "26/25"]})
    refused(wide | {"load": ["9/10", "53/50"]}, "may not decay at the load 1.0")
    data["forms"]["K"][1]["points"].append([["q", 0, None, 0], ["s", 0, None, 0], "1/10"])
    refused(data, "may not decay at the load 0.")


# --- frequencies that pass through one another ------------------------------------------------------------------------

PLANES = {
    "T": SHAFT["T"],
    "V": "integral(y.diff(x, 2) ** 2 + 3 * psi.diff(x, 2) ** 2) / 2",
    "W_c": SHAFT["W_c"],
    "dW_nc": "follower - P * at(psi.diff(x), 1) * at(delta(psi), 1)",
}
EQUAL = SHAFT | {"V": SHAFT["V"].replace("6 * psi.diff(x, 2) ** 2 / 5", "psi.diff(x, 2) ** 2")}


@pytest.mark.parametrize(("changes", "turn"), [(PLANES, 0), (EQUAL, 1)])
def test_frequencies_may_pass_through_one_another(changes: dict[str, str], turn: int, tmp_path: Path) -> None:
    """Two planes that nothing couples, and a shaft that spins and is equally stiff both ways: the load is Beck's of as
    many functions, and below it two frequencies change their order while no eigenvalue grows."""
    column_ = fb.column(file_of(tmp_path, "sample", changes))
    found, terms = fb.certified_load(column_, 3, digits=12), column_.coefficients(3, False, 0.0, 0.0)
    alone = beck()
    assert (
        found.load is not None and alone.load is not None and alone.square is not None and found.frequency is not None
    )
    assert F(found.load[0]) < alone.load[1] and alone.load[0] < F(found.load[1])
    assert float(found.frequency[0]) == pytest.approx(float(alone.square[0]) ** 0.5 - turn, rel=1e-9)
    gaps = []
    for share in np.linspace(0.6, 0.999, 400):
        values = of_matrices(*terms.at(share * float(found.load[0])))
        assert abs(values.real).max() < 1e-5 * abs(values).max()
        gaps.append(np.diff(np.sort(values.imag)[-6:] if turn else np.sort(values.imag**2)[::2]).min())
    least = int(np.argmin(gaps))
    assert 0 < least < 399 and gaps[least] < min(gaps[0], gaps[-1]) / 10  # which they pass on either side of
    assert of_matrices(*terms.at(1.0001 * float(found.load[1]))).real.max() > 1e-3
    said = verifier.verify(json.loads(json.dumps(found.unverified)))
    assert ("seen from rest" in str(said)) == bool(turn) == ("leaving each other alone" not in str(said))
    assert isinstance(said, verifier.OfForms) and said.times == 1
    listed = fb.certified_crossings(column_, 3, load_max=21, digits=10)
    assert [c.kind for c in listed] == ["flutter"] * (1 + turn) and listed[-1].unstable_above == 2 + 2 * turn
    for c, side in zip(listed, (-1, 1), strict=False):  # in the frame both at one load
        assert F(c.load[0]) < F(found.load[1]) and F(found.load[0]) < F(c.load[1])
        assert float(c.frequency[0]) == pytest.approx(float(alone.square[0]) ** 0.5 + side * turn, rel=1e-9)
    with pytest.raises(Unproven, match=r"could not be shown|not known to be stable"):  # of all in one
        whole = boundary(column_.kernel, Question(3, own=parameters(column_.kernel)), 300)
        first_crossing.cover(whole, F(0), alone.load[0], 40)


def names_of(data: Data) -> list[list[str]]:
    return [part["names"] for part in data["parts"]]


def test_forged_parts_are_refused() -> None:
    data = parted(PLANES)
    assert names_of(data) == [["y"], ["psi"]]
    refused({key: value for key, value in data.items() if key not in ("parts", "beside")})
    y, psi = data["parts"]
    for parts in (
        [psi, y],
        [y],
        [y | {"names": ["y", "psi"]}],
        [y, y],
        [y, y | {"motion": 1}],
        [y, psi | {"motion": 1}],
        [y, psi, psi | {"names": []}],
        [y, psi | {"names": ["q"]}],
        [y, psi | {"frame": {"planes": [["psi"], ["psi"]], "turn": "1"}}],
        [y, {"names": ["psi"], "motion": 0}],
        None,
    ):
        refused(data | {"parts": parts})
    for beside in ([], [[]], [None], [data["stretches"]], [data["beside"][0][:-1]], data["beside"] * 2, None):
        refused(data | {"beside": beside})
    short = data["beside"][0][-1] | {"end": data["load"][0]}
    refused(data | {"beside": [[*data["beside"][0][:-1], short]]}, "not shown up to the load")
    stiff = next(n for n, term in enumerate(data["forms"]["K"][0]["along"]) if term[1] == "psi")
    for value in ("1", "9/10", "-3"):
        refused(altered(data, ("forms", "K", 0, "along", stiff, 5), [value]))
    for form in ("M", "K"):
        coupled = copy.deepcopy(data)
        coupled["forms"][form][0]["along"].append([0, "y", 0, "psi", 0, ["1/1000000"]])
        refused(coupled, "do not leave each other alone")
    W = flint.fmpq_mat([[flint.fmpq(i % 5 == n) for n in range(5)] for i in range(10)])  # y and psi move alike
    with pytest.raises(verifier.Refused, match="a trial function is of two parts"):
        verifier.apart(
            verifier._space(data), data["parts"], W, [[flint.fmpq_mat(5, 5)], [], [flint.fmpq_mat(5, 5)]], False
        )
    damped_ = copy.deepcopy(data)
    damped_["forms"]["C_1"] = [{"along": [[0, "y", 0, "y", 0, ["1"]]], "points": []}]
    refused(damped_)


def test_forged_frames_are_refused() -> None:
    data = parted(EQUAL)
    assert names_of(data) == [["y", "psi"]] and data["beside"] == []
    frame = data["parts"][0]["frame"]
    assert sorted(frame["planes"]) == [["psi"], ["y"]] and frame["turn"] == "1"
    refused({key: value for key, value in data.items() if key not in ("parts", "beside")})
    refused(data | {"kind": "divergence", "frequency_squared": None}, "not one of a frame")
    in_frame = [str(F(v) - 20) for v in data["frequency_squared"]]
    refused(data | {"frequency_squared": in_frame})
    for other in (
        None,
        {},
        {"turn": "1"},
        *(frame | {"turn": turn} for turn in ("0", "-1", "9/10", "1000001/1000000", "64", 1)),
        *(frame | {"planes": planes} for planes in ([], [["y"]], [["y"], ["y"]], [["y", "psi"], []], [["q"], ["y"]])),
    ):
        refused(altered(data, ("parts", 0, "frame"), other))
    for form, power in (("M", 0), ("C_1", 0), ("K", 0), ("K", 1)):
        for n in range(len(data["forms"][form][power]["along"])):
            place = ("forms", form, power, "along", n, 5, 0)
            refused(altered(data, place, str(F(at(data, place)) * F(1000001, 1000000) or F(1, 10**6))))
    tied = copy.deepcopy(data)
    tied["forms"]["K"][0]["along"].append([0, "y", 0, "psi", 0, ["1/1000000"]])
    refused(tied)


def test_a_frame_that_turns_couples_two_that_are_alike_and_nothing_else_does() -> None:
    """M = 1, K = 2, C = 2c [[0, 1], [−1, 0]] at c = 3/2: (ω ± c)² = K + c². With other blocks it is no frame."""

    def of(*rows: list[Any]) -> Any:
        return flint.fmpq_mat(list(rows))

    one = of([1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1])
    C = of([0, 0, 3, 0], [0, 0, 0, 3], [-3, 0, 0, 0], [0, -3, 0, 0])
    planes, turn = [[0, 1], [2, 3]], flint.fmpq(3, 2)
    (_, rates, stiff), whirls = verifier_parts.seen([[one], [C], [2 * one]], planes, turn)
    assert stiff == [flint.fmpq(17, 4) * of([1, 0], [0, 1])] and not rates and not whirls
    whole = (flint.fmpq_mat(4, 4) + C, 2 * one)
    for omega in (-5, 1, 7):  # det(K − ω² M + iω C) = (17/4 − (ω + c)²)² (17/4 − (ω − c)²)²
        A = flint.acb_mat(whole[1] - omega**2 * one) + flint.acb(0, omega) * flint.acb_mat(whole[0])
        parts = [flint.fmpq(17, 4) - (omega + side * flint.fmpq(3, 2)) ** 2 for side in (1, -1)]
        assert abs(A.det() - flint.acb(parts[0] ** 2 * parts[1] ** 2)) < 1e-6
    within = of([0, 1, 0, 0], [-1, 0, 0, 0], [0, 0, 0, 0], [0, 0, 0, 0])
    beside = of([0, 0, 0, 1], [0, 0, 0, 0], [0, 0, 0, 0], [0, 0, 0, 0])
    others = [([one], [C + more], [2 * one]) for more in (within, beside, within.transpose(), beside.transpose())]
    others += [
        ([one + beside], [C], [one]),
        ([one], [C], [one + beside]),
        ([one], [C], [one + beside.transpose()]),
        ([one], [C], [one + within * within]),
    ]
    for terms in others:
        with pytest.raises(verifier.Refused, match="two planes are not"):
            verifier_parts.seen([*terms], planes, turn)
    nothing = [[flint.fmpq_mat(0, 0)]] * 3
    for of, two in ((nothing, [[], []]), ([[one], [C], [2 * one]], [[0, 1], [2]])):
        with pytest.raises(verifier.Refused, match="two planes are not of as many motions"):
            verifier_parts.seen(of, two, turn)


def parted(changes: dict[str, str]) -> Data:
    with tempfile.TemporaryDirectory() as folder:
        found = fb.certified_load(fb.column(file_of(Path(folder), "sample", changes)), 3, digits=12)
    data: Data = json.loads(json.dumps(found.unverified))
    verifier.verify(data)
    return data


# --- factors that are no fractions ---------------------------------------------------------------------------------


def test_a_root_is_held_by_balls_and_in_a_certificate_of_matrices(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Between the loads of fractions on either side; as a fraction where it is one."""
    parameters_ = {"parameters": "(own(b, 0.3),)"}
    root = {"W_c": "P ** 2 * integral(y.diff(x) ** 2) / 2", "dW_nc": ANY_PIPE.replace("2 * b", "2 * sqrt(b)")}
    path = file_of(tmp_path, "root", root | parameters_)
    asked, plain = fb.column(path), column("pipe")
    found = fb.certified_load(asked, 4, digits=12)
    assert found.load is not None and found.unverified is not None
    low, high = (fb.certified_load(plain, 4, digits=12, b=b).load for b in ("0.547722", "0.547723"))  # √0.3
    assert low is not None and high is not None and F(low[1]) < F(found.load[0]) < F(found.load[1]) < F(high[0])
    quarter = fb.certified_load(asked, 4, digits=12, b="1/4")
    assert quarter.unverified is not None and quarter.load == fb.certified_load(plain, 4, digits=12, b="1/2").load
    file = tmp_path / "proof.json"
    assert main(["critical", "--column", str(path), "--modes", "4", "--digits", "8", "--certificate", str(file)]) == 0
    capsys.readouterr()
    assert main(["verify", str(file)]) == 0
    told = capsys.readouterr().out
    assert "of every M, C and K within those in this file" in told and "above 0 up to" in told


def test_roots_of_numbers_and_pi_are_what_they_are(tmp_path: Path) -> None:
    """√2 e^(−1/2) (k/3) + π b of a spring, by parameters; against the factor as a fraction of thirty digits."""
    factor = "(sqrt(2) * exp(-half) * k / 3 + pi * b) * at(y, half) ** 2 / 2"
    stated = {"V": f"V + {factor}", "parameters": "(own(k, 30.0), own(b, 1.0))"}
    plain = fb.column(file_of(tmp_path, "plain", {"V": "V + k * at(y, half) ** 2 / 2", "parameters": "(own(k, 1.0),)"}))
    found = fb.certified_load(fb.column(file_of(tmp_path, "roots", stated)), 3, digits=20)
    with flint.ctx.workprec(200):
        middle = (10 * flint.arb(2).sqrt() * (flint.arb(-1) / 2).exp() + flint.arb.pi()).str(30, radius=False)
    other = fb.certified_load(plain, 3, digits=20, k=middle)
    assert found.load is not None and other.load is not None
    assert max(F(found.load[0]), F(other.load[0])) < min(F(found.load[1]), F(other.load[1]))


# --- rigid motions, by hand -----------------------------------------------------------------------------------------


def beside(**forms: list[tuple[int, str, str, str]]) -> Data:
    """The two links and a coordinate r of mass 1 that is left out; forms: more terms, (power, test, trial, factor)."""
    data = written("two links")
    for letter, terms in ({"M": [(0, "r", "r", "1")]} | {k: [*v] for k, v in forms.items() if k != "M"}).items():
        for power, test, trial, factor in [*terms, *(forms.get("M", []) if letter == "M" else [])]:
            powers = data["forms"][letter]
            while len(powers) <= power:
                powers.append({"along": [], "points": []})
            powers[power]["points"].append([[test, 0, None, 0], [trial, 0, None, 0], factor])
    return data | {"coordinates": [*data["coordinates"], "r"], "rigid": [{"r": "1"}]}


def test_a_motion_that_rests_or_decays_is_left_out() -> None:
    for true in (beside(), beside(C_1=[(0, "r", "r", "1/2")]), beside(K=[(1, "r", "p", "3")])):
        found = verifier.verify(true)
        assert "1 rigid motion left out" in str(found) and found.load == tuple(map(F, written("two links")["load"]))


@pytest.mark.parametrize(
    ("forms", "match"),
    [
        ({"K": [(0, "r", "r", "1")]}, "acts on a rigid motion"),
        ({"K": [(0, "r", "r", "-1")]}, "acts on a rigid motion"),
        ({"K": [(1, "r", "r", "-1/1000000")]}, "acts on a rigid motion"),
        ({"C_1": [(0, "r", "r", "-1/1000000")]}, "known to rest, or to decay"),
        ({"C_1": [(1, "r", "r", "1")]}, "known to rest, or to decay"),
        ({"M": [(1, "r", "r", "1/1000")]}, "known to rest, or to decay"),
        ({"M": [(0, "r", "r", "-1")]}, "without mass"),
        ({"K": [(0, "p", "r", "1/1000000")]}, "not left to itself"),
        ({"K": [(1, "p", "r", "1")]}, "not left to itself"),
        ({"C_1": [(0, "p", "r", "1")]}, "not left to itself"),
        ({"M": [(0, "p", "r", "1/10")]}, "not left to itself"),
    ],
)
def test_a_motion_that_decides_is_not_left_out(forms: Any, match: str) -> None:
    refused(beside(**forms), match)


def test_a_motion_meets_the_supports_and_joints() -> None:
    free = written("free with a crack")
    refused(free | {"rigid": [*free["rigid"], {"y": [["1"], ["0"]]}]}, "does not meet the supports and joints")
    refused(written("crack") | {"rigid": [{"y": [["1"], ["1"]]}]}, "does not meet the supports and joints")


def test_two_motions_that_drive_each_other_are_not_left_out() -> None:
    """K takes r to s and s to r: λ⁴ = 1. Where it takes r to s alone both rest."""
    data = beside(K=[(0, "s", "r", "1")], M=[(0, "s", "s", "1")])
    data |= {"coordinates": [*data["coordinates"], "s"], "rigid": [{"r": "1"}, {"s": "1"}]}
    assert "2 rigid motions" in str(verifier.verify(data))
    data["forms"]["K"][0]["points"].append([["r", 0, None, 0], ["s", 0, None, 0], "1"])
    refused(data, "acts on a rigid motion")
    refused(data | {"rigid": [{"r": "1"}, {"r": "2"}]}, "not independent")


@pytest.mark.parametrize("degrees", [(0, 0, 1), (0, 1, 2), (1, 0, 1), (1, 2, 0), (0, 3, 1), (2, 1, 1)])
@pytest.mark.parametrize("empty", [0, 1])
def test_h_and_g_are_the_determinant_s_whatever_the_powers_of_the_load(degrees: tuple[int, ...], empty: int) -> None:
    """Of full matrices; C may begin with a power of P, which g is divided by."""
    dice, N, P, x = np.random.default_rng(5), 3, F(7, 10), F(3, 2)
    M, C, K = (
        [flint.arb_mat([[int(v) for v in row] for row in dice.integers(-9, 10, (N, N))]) for _ in range(d + 1)]
        for d in degrees
    )
    M[0] = flint.arb_mat([[int(i == j) for j in range(N)] for i in range(N)])
    K[0] = flint.arb_mat([[(2 * i + 1) * int(i == j) for j in range(N)] for i in range(N)])
    with flint.ctx.workprec(200):
        C = [flint.arb_mat(N, N)] * empty + [X / 100 for X in C]  # small, so that h is separated at P = 0
        found = verifier.Series(verifier.System(M, C, K, False), F(1), [F(0), F(2), F(4), F(6)])
        at_P = [sum((X * verifier.ball(P**k) for k, X in enumerate(terms)), flint.arb_mat(N, N)) for terms in (M, C, K)]
        A = flint.acb_mat(at_P[2] - at_P[0] * verifier.ball(x))
        whole = (A + flint.acb_mat(at_P[1]) * flint.acb(0, 1) * verifier.ball(x).sqrt()).det()
        h, g = (
            sum((p(verifier.ball(P)) * verifier.ball(x**k) for k, p in enumerate(which)), flint.arb(0))
            for which in (found.h, found.g)
        )
        assert abs(h - whole.real) < 1e-20
        assert abs(g * verifier.ball(P**empty) * verifier.ball(x).sqrt() - whole.imag) < 1e-20


def test_a_mass_that_vanishes_is_told() -> None:
    """An eigenvalue passes through infinity at P = 1, beside one that crosses there."""
    P, one = flint.arb_poly([0, 1]), flint.arb_poly([1])
    for leading, seen in ((one - P, True), (3 * one - P, False)):
        series = object.__new__(verifier.Series)
        series.system = verifier.System([], [], [], False)
        series.N, series.damped, series.odd = 3, True, False
        # h = (P − x) (1 − leading x) (7 + x), g = (1 − x) (3 − x)
        series.h = [7 * P, P - 7 * one - 7 * P * leading, 7 * leading - one - P * leading, leading]
        series.g = [3 * one, -4 * one, one]
        asked = F(999, 1000), F(1001, 1000), (F(19, 20), F(21, 20))
        for odd, fast in ((False, None), (True, verifier.Fast([], [], 1))):
            # in a limit in which coordinates without mass decay g has a root more, beyond
            series.odd, series.system = odd, verifier.System([], [], [], True, None, fast)
            series.g = [9 * one, -15 * one, 7 * one, -one] if odd else [3 * one, -4 * one, one]
            if seen:
                with pytest.raises(verifier.Refused, match="det M may vanish"):
                    series.check_crossing(*asked)
            else:
                series.check_crossing(*asked)


# --- files that would use up time or memory -----------------------------------------------------------------------


def test_hostile_files_are_refused_soon(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Before a matrix is computed."""
    data, path = written("damped crack"), tmp_path / "file.json"
    monkeypatch.setattr(verifier.Space, "matrix", lambda *_: pytest.fail("a matrix was computed"))
    form, coordinates = data["forms"]["K"][0], [f"q{k}" for k in range(50)]
    term, value = form["along"][0], ["y", 0, "1/2", 0]
    breaks = [str(F(k, 1000)) for k in range(1001)]
    long, wide = "1/" + "7" * 5000, ["1"] * 500
    hostile: list[Data] = [
        data | {"breaks": given}
        for given in (
            [],
            ["0"],
            ["0", "1/2"],
            ["1", "0"],
            ["0", "0", "1"],
            ["0", "2", "1"],
            breaks,
            ["0", long, "1"],
            None,
        )
    ]
    hostile += [data | {"coordinates": given} for given in (coordinates, ["q", "q"], ["y"], [""], [5], None)]
    hostile += [data | {"modes": given} for given in (199, 10**6, 0, True, "2")]
    hostile += [
        data | {"rigid": given} for given in ([{"z": "1"}], [{"y": []}], [{"y": [["1"]]}], [{}] * 1000, None, [5])
    ]
    hostile += [data | {"rigid": [{"y": [given, ["1"]]}]} for given in ([], wide, ["1", "1", "1"], [long])]
    hostile += [altered(data, ("forms", "K"), [form] * n) for n in (0, 10, 1000)]
    hostile += [altered(data, ("forms", "K", 0, "along"), [term] * 30_000)]
    hostile += [altered(data, ("forms", "K", 0, "points"), [[value, value, "1"]] * 20_000)]
    for at_, values in {
        0: (-1, 2, True, "0"),
        1: ("z", 5),
        2: (-1, 5, 10**9),
        4: (-1, 5),
        5: ([], wide, ["x"], [long]),
    }.items():
        hostile += [altered(data, ("forms", "K", 0, "along", 0, at_), given) for given in values]
    for at_, many in {0: ("z", None), 1: (-1, 5), 2: ("-1", "2", None, long), 3: (-2, 2, 0.5)}.items():
        for given in many:
            wrong = [*value[:at_], given, *value[at_ + 1 :]]
            hostile.append(altered(data, ("forms", "K", 0, "points"), [[wrong, value, "1"]]))
    for part in ("held", "opened"):
        given = ([[0, 0]] * 2 + [[2, 0]], [[0, 2]], [[-1, 0]], [[0]], None)
        hostile += [altered(data, ("fields", "y", part), v) for v in given]
    hostile += [altered(data, ("fields", "y", "joined"), v) for v in (3, -1, "2", True)]
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    for case_ in hostile:
        path.write_text(json.dumps(case_))
        start = time.perf_counter()
        with pytest.raises(verifier.Refused) as caught:
            verifier.verify_file(path)
        assert time.perf_counter() - start < 5, caught.value  # a second where the machine has nothing else to do
        assert "\n" not in str(caught.value) and len(str(caught.value)) < 500
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 200_000


def test_forms_that_take_too_long_are_refused_by_terms_sizes_and_digits_together(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """None of the three is too large by itself: a certificate has as many terms, and one as long numbers."""
    data, long = written("damped crack"), "1/" + "7" * 150
    monkeypatch.setattr(verifier.Space, "matrix", lambda *_: pytest.fail("a matrix was computed"))
    term = data["forms"]["K"][0]["along"][0]
    many = altered(data, ("forms", "K", 0, "along"), [term] * 900)
    with pytest.raises(pytest.fail.Exception):
        verifier.verify(many)
    with pytest.raises(pytest.fail.Exception):
        verifier.verify(altered(data, ("forms", "K", 0, "along", 0, 5), [long]))
    refused(altered(many, ("forms", "K", 0, "along", 0, 5), [*["1"] * 5, long]), "more terms, or longer ones")


@pytest.mark.parametrize("size", [F(1), F(1, 10)])
def test_damping_that_couples_rigid_motions_is_refused_whatever_its_size(size: Fraction) -> None:
    """A force in proportion to the velocity of a free beam with a mass at an end, which it is not of the rest."""
    changes = FREE_MASS | {"dW_nc": "follower + internal + external"}
    with tempfile.TemporaryDirectory() as folder:
        kernel = fb.column(file_of(Path(folder), "sample", changes)).kernel
    asked = Question(3, F(1, 100), size, own=parameters(kernel))
    with pytest.raises(Unproven, match="beta: this damping couples the rigid motions"):
        first_crossing.certify(kernel, asked, None, 8, F(1))
    asked = Question(3, F(1, 100), F(0), own=parameters(kernel))
    assert first_crossing.certify(kernel, asked, None, 8, F(1)).kind == "none"


SAMPLED: dict[str, tuple[dict[str, str], Any, Any]] = {  # changes, bending stiffness and mass
    "exponential": (
        {"V": "integral(exp(-x) * y.diff(x, 2) ** 2) / 2"}, lambda x: mpmath.exp(-x), lambda x: mpmath.mpf(1)
    ),
    "powers": (
        {
            "V": "integral((1 + x) ** a * y.diff(x, 2) ** 2) / 2",
            "T": "integral(sqrt(1 - x / 2) * log(3 + x) / (2 + sin(x)) * y.diff(t) ** 2) / 2",
            "parameters": "(Parameter(a, 'a', 0.5, 0.0, 3.0),)",
        },
        lambda x: (1 + x) ** mpmath.mpf("0.5"),
        lambda x: mpmath.sqrt(1 - x / 2) * mpmath.log(3 + x) / (2 + mpmath.sin(x)),
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", SAMPLED)
def test_a_factor_that_is_no_polynomial_is_integrated_in_balls(name: str, tmp_path: Path) -> None:
    """Two frequencies of the series x², x³, … in mpmath's quadrature meet between the ends of the load's interval."""
    changes, stiffness, mass = SAMPLED[name]
    path = file_of(tmp_path, "sample", changes)
    path.write_text(path.read_text().replace("exp, pi", "exp, log, pi, sin"))
    found, N = fb.certified_load(fb.column(path), 3, digits=15), 3
    assert found.load is not None and found.unverified is not None
    verifier.verify(json.loads(json.dumps(found.unverified)), verifier_of_matrices.FORMATS)

    def integral(f: Any) -> Any:
        return mpmath.quad(f, [0, 1])

    with mpmath.workdps(50):
        powers = range(2, N + 2)
        M = mpmath.matrix([[integral(lambda x: mass(x) * x ** (i + j)) for j in powers] for i in powers])  # noqa: B023
        E = mpmath.matrix([
            [integral(lambda x: stiffness(x) * i * (i - 1) * j * (j - 1) * x ** (i + j - 4)) for j in powers]  # noqa: B023
            for i in powers
        ])  # fmt: skip
        H = mpmath.matrix([[j - mpmath.mpf(i * j) / (i + j - 1) for j in powers] for i in powers])
        still, grows = (
            mpmath.eig(mpmath.inverse(M) * (E + mpmath.mpf(load) * H), left=False, right=False) for load in found.load
        )
        assert max(abs(s.imag) for s in still) < 1e-30 < max(abs(s.imag) for s in grows)
        omega = min(abs(mpmath.sqrt(s).real - mpmath.mpf(found.frequency[0])) for s in grows)
        assert omega < 1e-6  # of two that meet it moves with the root of the load's interval


# --- all crossings ----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["damped crack", "free with a mass", "pipe", "Timoshenko", "two links, damped"])
def test_all_crossings_are_those_of_a_dense_scan(name: str) -> None:
    listed = all_crossings.survey(column(name).kernel, question(name), F(CASES[name].top), 10)
    edges = [0.0, *(float(c.load[0]) for c in listed), float(CASES[name].top)]
    count = 0
    for k, (low, high) in enumerate(pairwise(edges)):
        if high - low > high / 1000:
            for share in np.linspace(0.02, 0.98, 25):
                assert unstable(name, [low + share * (high - low)]) == count
        if k < len(listed):
            assert listed[k].unstable == count
            count += listed[k].change
    assert listed and len(listed) >= len(crossings(name))


# --- refusals -----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("changes", "match"),
    [
        ({"T": "T + at(y.diff(t), sqrt(2) / 2) ** 2"}, "a place is no fraction"),
        (TOP | {"dW_nc": TOP["dW_nc"] + " - P * p * delta(q)"}, "not known to be"),
        (LINKS | {"dW_nc": "-P * q * delta(p) - p.diff(t) * delta(q) + q.diff(t) * delta(p)"}, "not known to be"),
    ],
)  # fmt: skip
def test_what_cannot_be_stated_in_fractions_or_is_not_stable_is_refused(
    changes: dict[str, str], match: str, tmp_path: Path
) -> None:
    kernel = fb.column(file_of(tmp_path, "sample", changes)).kernel
    with pytest.raises(Unproven, match=match):
        first_crossing.certify(kernel, Question(3, F(1, 10), own=parameters(kernel)), None, 8, F(1))


def every_part() -> None:
    for name in CASES:
        data = written(name)
        parts = [place for place in places(data) if counts(data, place)]
        for place in parts:
            refused_without(data, place)
        print(f"{name}: {len(parts)} parts", flush=True)


if __name__ == "__main__":
    every_part()
