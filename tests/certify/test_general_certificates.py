"""Certificates of any column: true ones are accepted, and forged ones refused, by code that shares nothing with the
prover. What is true of a column is found apart from both, by a dense scan of its eigenvalues in floats."""

from __future__ import annotations

import copy
import json
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from itertools import pairwise
from pathlib import Path
from typing import Any

import flint
import numpy as np
import pytest
from flint import fmpq

import freebeam as fb
from freebeam_derive.certify import all_crossings, certificate, first_crossing, verifier
from freebeam_derive.certify.balls import Unproven, parameters
from freebeam_derive.certify.boundary_polynomials import Question
from tests.stated import FREE, TIMOSHENKO, file_of

F = Fraction
Data = dict[str, Any]
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
    alpha: Fraction = F(0)
    beta: Fraction = F(0)
    top: int = 60


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
        {"V": "V + 100 * integral(y ** 2, half, 1) / 2", "dW_nc": "follower + external + internal"}, 3, F(1, 100), F(1, 10)
    ),
    "free with a mass": case(FREE_MASS, 4, F(0), F(0), 200),
    "free with a mass, damped": case(FREE_MASS, 4, F(1, 100), F(0), 200),
    "pipe": case({"W_c": "P ** 2 * integral(y.diff(x) ** 2) / 2", "dW_nc": ANY_PIPE, "parameters": "(own(b, 0.3),)"},
                 4, F(0), F(0), 12),
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
    "tip spring": case({"V": "V + k * at(y, 0.9) ** 2 / 2", "parameters": "(own(k, 60.0),)"}, 4),
    "rayleigh": case({"T": "T + b * integral(y.diff(x, t) ** 2) / 2", "parameters": "(own(b, 0.01),)"}),
}  # fmt: skip

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
    M, C, K = matrices(name, N or CASES[name].modes).at(load)
    if not C.any():
        half = np.sqrt(np.linalg.eigvals(-np.linalg.solve(M, K)).astype(complex))
        return np.concatenate([half, -half])
    C, K = np.linalg.solve(M, C), np.linalg.solve(M, K)
    return np.linalg.eigvals(np.block([[np.zeros_like(K), np.eye(len(K))], [-K, -C]]))


def unstable(name: str, load: float, N: int | None = None) -> int:
    values = eigenvalues(name, load, N)
    damped = matrices(name, N or CASES[name].modes).C
    return int((values.real > (1e-11 if damped else 1e-6) * np.abs(values).max()).sum())


@cache
def crossings(name: str, N: int | None = None) -> list[tuple[float, float, int, int]]:
    """Loads at which the number of unstable eigenvalues changes, with the frequency of the one that does, and numbers."""
    loads = np.linspace(0, CASES[name].top, 1500)[1:]
    counts = [unstable(name, P, N) for P in loads]
    found = []
    for (a, before), (b, after) in pairwise(zip(loads, counts, strict=True)):
        if before != after:
            low, high = a, b
            for _ in range(45):
                middle = (low + high) / 2
                low, high = (middle, high) if unstable(name, middle, N) == before else (low, middle)
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
    damped = bool(matrices(name, asked.modes).C)
    assert before == 0 and found.damped == damped
    assert float(found.load[0]) == pytest.approx(load, rel=1e-7)
    assert (found.kind == "divergence") == (omega < 1e-3)
    if found.frequency is not None:
        assert float(found.frequency[0]) == pytest.approx(omega, rel=1e-3)
    assert found.size == len(matrices(name, asked.modes).M[0])
    said = str(found)
    assert "of the forms in this file" in said and f"N = {asked.modes} ({found.size} functions)" in said
    assert "\n" not in said and all(v in said for v in verifier.shown(*found.load))
    assert ("above 0 up to" in said) == (name == "pipe") and ("left out" in said) == ("free" in name)
    assert ("undamped" in said) != damped and all(breaks in said for breaks in ("0, ", " 1,"))
    record = found.record()
    assert record["load_lower"] in said and record["of"] == "the forms in this file"
    assert record["stable_at_zero_load"] is (None if name == "pipe" else True)


@pytest.mark.parametrize("name", CASES)
def test_the_verifier_s_matrices_have_the_kernel_s_eigenvalues(name: str) -> None:
    data, asked = written(name), CASES[name]
    _, N, system, _ = verifier._of_forms(data)
    load = 0.7 * crossings(name)[0][0]
    with flint.ctx.workprec(300):
        found = system()
        M, C, K = (
            sum((load**k * np.array(X.tolist(), dtype=float) for k, X in enumerate(powers)), np.zeros((N, N)))
            for powers in (found.M, found.C, found.K)
        )
    A = np.block([[np.zeros((N, N)), np.eye(N)], [-np.linalg.solve(M, K), -np.linalg.solve(M, C)]])
    theirs = np.sort_complex(np.round(eigenvalues(name, load), 9))
    ours = np.linalg.eigvals(A)
    for value in theirs:
        assert np.abs(ours - value).min() < 1e-6 * max(1, abs(value)), asked
    assert len(ours) == len(theirs)


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
    """The claim kept, and a column that does not fulfil it: breaks, supports, joints, rigid motions, N, damping, forms."""
    divergence = data["kind"] == "divergence"
    for k in range(1, len(data["breaks"]) - 1):
        yield altered(data, ("breaks", k), str(F(data["breaks"][k]) + F(1, 1000)))
    for field, space in data["fields"].items():
        for part in ("held", "opened"):
            for k in range(len(space[part])):
                yield altered(data, ("fields", field, part), space[part][:k] + space[part][k + 1 :])
        joints = [[k, order] for k in range(1, len(data["breaks"]) - 1) for order in range(space["joined"])]
        for joint in joints:
            if joint not in space["opened"]:
                more = altered(data, ("fields", field, "opened"), [*space["opened"], joint])
                yield more
                yield more | {"stretches": with_lines(data, 1 + damped(data))}
        for support in ([0, 0], [0, 1], [1, 0], [1, 1]):
            if support not in space["held"] and support[1] < space["joined"]:
                less = altered(data, ("fields", field, "held"), [*space["held"], support])
                yield less
                yield less | {"stretches": with_lines(data, -1 - damped(data))}
    segments = len(data["breaks"]) - 1
    motion: Data = {field: [["1"]] * segments for field in data["fields"]}
    if data["rigid"]:
        for k in range(len(data["rigid"])):
            fewer = data | {"rigid": data["rigid"][:k] + data["rigid"][k + 1 :]}
            yield fewer
            yield fewer | {"stretches": with_lines(data, 1 + damped(data))}
        yield data | {"rigid": [*data["rigid"], data["rigid"][0]]}
        yield data | {"rigid": [*data["rigid"], {field: [["0", "0"]] * segments for field in data["fields"]}]}
    else:
        for rigid in (motion, {name: "1" for name in data["coordinates"]}):
            yield data | {"rigid": [rigid]}
            yield data | {"rigid": [rigid], "stretches": with_lines(data, -1 - damped(data))}
    if data["fields"]:
        count = len(data["fields"]) * segments
        for more in (-1, 1):
            yield data | {"modes": data["modes"] + more}
            yield data | {"modes": data["modes"] + more, "stretches": with_lines(data, more * count * (1 + damped(data)))}
    if not divergence:
        for rate, part in (("alpha", "C_alpha"), ("beta", "C_beta")):
            if any(form["along"] or form["points"] for form in data["forms"][part]):
                yield data | {rate: str(F(data[rate]) * F(1001, 1000) + F(1, 10**6))}
                yield data | {rate: "0" if F(data[rate]) else "1/10"}
    for place in factors(data["forms"]):
        still = divergence and place[0] != "K"  # det K alone decides
        if not still and (place[0] not in ("C_alpha", "C_beta") or F(data[place[0][2:]])):
            value = F(at(data["forms"], place)) * F(1000001, 1000000)
            yield altered(data, ("forms", *place), str(value))


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
    for forgery in (*other_claims(name, data), *other_columns(name, data)):
        with pytest.raises(verifier.Refused):
            pytest.fail(f"accepted: {differences(data, forgery)}: {verifier.verify(forgery)}")
        count += 1
    assert count >= 12


def differences(one: Any, other: Any) -> Any:
    if isinstance(one, dict) and isinstance(other, dict):
        return {k: differences(one[k], other.get(k)) for k in one if one[k] != other.get(k)}
    return one, other
