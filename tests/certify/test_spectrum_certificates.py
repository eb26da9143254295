"""Certificates of all eigenvalues of the beam itself up to a bound: true ones accepted, forgeries refused.

    PYTHONPATH=. python -m tests.certify.test_spectrum_certificates 20 1

draws so many random columns, loads and dampings by a seed, writes a certificate of each, and tries every forgery of it.
"""

from __future__ import annotations

import json
import random
import sys
from collections import Counter
from collections.abc import Callable, Iterator
from fractions import Fraction
from functools import cache
from math import pi
from pathlib import Path
from time import process_time
from typing import Any

import flint
import numpy as np
import pytest
from flint import acb, arb

import freebeam as fb
import freebeam_kernels.beck as beck
from freebeam_derive.certify import verifier, verifier_of_beam, verifier_spectrum
from freebeam_derive.certify.verifier_claims import Refused, ball
from freebeam_derive.certify.verifier_shooting import Shooting
from freebeam_derive.certify.verifier_spectrum import Circle, Enclosed, Function
from freebeam_sym.checks import InputError
from tests.certify.test_beam_certificates import of_kernel, shooting
from tests.front.test_proofs import run

Data = dict[str, Any]
F = Fraction


def verify(data: Data) -> Any:
    return verifier.verify(data, verifier_spectrum.FORMATS)


def refused(data: Data, match: str) -> None:
    with pytest.raises(Refused, match=match):
        verify(data)


@pytest.fixture(autouse=True)
def computed_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """F of the same ends and forms, for all the forgeries that leave these."""
    monkeypatch.setattr(verifier_of_beam, "Shooting", lambda ends, *forms: shooting(tuple(ends), *forms))


CASES: dict[str, tuple[str, dict[str, Any]]] = {
    "two": ("beck", {"load": 10, "modes": 2}),
    "two near one another": ("beck", {"load": "20.05095", "modes": 2, "digits": 2}),
    "beyond flutter": ("beck", {"load": 25, "modes": 3}),
    "beyond divergence": ("beck", {"eta": "0", "load": 10, "modes": 2}),
    "external damping": ("beck", {"eta": "0", "load": 10, "beta": "0.5", "modes": 2}),
    "overdamped": ("beck", {"load": 5, "beta": 30, "modes": 2}),
    "rigid motions": ("free-free", {"load": 60, "beta": "0.3", "modes": 2}),
    "internal damping": ("beck", {"load": 10, "alpha": "0.02", "beta": "0.3", "modes": 1}),
}


@cache
def found(case: str) -> Any:
    name, given = CASES[case]
    return fb.exact_spectrum(fb.column(name), **given)


def certificate(case: str) -> Data:
    data: Data = json.loads(json.dumps(found(case).unverified))
    return data


# ------------------------------------------------------------ true ones


@pytest.mark.parametrize("case", CASES)
def test_a_certificate_is_accepted_and_holds_what_a_long_series_has(case: str) -> None:
    stated, (name, given) = verify(certificate(case)), CASES[case]
    other = {key: float(value) for key, value in given.items() if key not in ("modes", "digits", "load")}
    system = fb.Question.of(fb.column(name, "legendre"), 20, **other).system(float(given["load"]))
    values = [v for v in fb.spectrum(system).eigenvalues if abs(v) <= stated.complete_to]
    assert stated.count == len(values) >= 2
    for each in stated.eigenvalues:
        centre = complex(each.re, each.im)
        near = [v for v in values if abs(v - centre) < 1e-6 * abs(centre) + 2e-4 * (case == "two near one another")]
        assert len(near) == 1
        assert each.count == (2 if abs(near[0].imag) > 1e-3 else 1)
    text, record = str(stated), stated.record()
    assert f"exactly {len(values)} eigenvalues, each simple" in text and "over all modes" in text
    assert text.count("and its conjugate") == sum(each.count == 2 for each in stated.eigenvalues)
    assert record["of"].startswith("the beam itself") and record["count"] == len(values)
    assert len(record["eigenvalues_lower"]) == len(stated.eigenvalues)


def test_squares_of_many_digits_are_as_wide_as_the_verifier_takes() -> None:
    proven = fb.exact_spectrum(fb.column("beck"), 10, modes=2, digits=1100)
    assert proven.unverified is not None
    square = proven.unverified["eigenvalues"][0]
    middle, radius = F(square["im"]), F(square["radius"])
    assert (
        middle - radius < F(proven.lower[0][1]) < F(proven.upper[0][1]) < middle + radius < middle * (1 + F(1, 10**999))
    )
    assert verifier_spectrum._enclosed(square).radius == radius


def test_what_is_on_an_axis_is_said_to_be_on_it() -> None:
    """A zero that is alone in a square about a point of the real axis; without damping of the imaginary one too."""
    stated = verify(certificate("beyond divergence"))
    parts = [stated.parts(each) for each in stated.eigenvalues]
    assert sorted((re == ("0", "0"), im == ("0", "0")) for re, im in parts) == [
        (False, True),
        (False, True),
        (True, False),
    ]
    assert "Re = 0, Im between" in str(stated) and ", Im = 0" in str(stated)
    damped = certificate("external damping")
    damped["eigenvalues"] = [{"re": "0", "im": "18", "radius": "1"}, *damped["eigenvalues"][1:]]
    claimed, _ = verifier_spectrum._read(damped)
    assert claimed.parts(claimed.eigenvalues[0])[0] != ("0", "0")


def test_without_load_each_is_where_it_is_known_to_be() -> None:
    """λ² + (β + αγ⁴) λ + γ⁴ = 0 with cos γ cosh γ = −1: a certificate that no prover wrote."""
    gammas, data = [1.8751040687119611, 4.694091132974175, 7.854757438237613], certificate("internal damping")
    roots = [r for g in gammas for r in np.roots([1, 0.3 + 0.02 * g**4, g**4])]
    squares = [
        {"re": f"{r.real:.9f}", "im": f"{r.imag:.9f}" if r.imag else "0", "radius": "0.0000001"}
        for r in roots
        if r.imag >= 0
    ]
    for radius in (10, 30):
        inside = [s for s, r in zip(squares, (r for r in roots if r.imag >= 0), strict=True) if abs(r) < radius]
        known = data | {"load": "0", "complete_to": str(radius), "eigenvalues": inside}
        assert verify(known).count == sum(abs(r) < radius for r in roots)
        refused(known | {"eigenvalues": inside[1:]}, "within the bound, not")
    refused(data | {"load": "0", "complete_to": "50"}, "accumulate")


# ------------------------------------------------------------ forgeries


def moved(each: Data, share: Fraction) -> Data:
    """An eigenvalue moved by a share of its size, along the axis on which it is."""
    part = "re" if each["im"] == "0" else "im"
    return each | {part: str(F(each[part]) * (1 + share))}


def size(each: Data) -> float:
    return abs(complex(float(F(each["re"])), float(F(each["im"]))))


def forgeries(data: Data) -> Iterator[tuple[str, Data]]:
    """The same certificate of something that is not so, with what is not."""
    found, r = data["eigenvalues"], F(data["complete_to"])
    other = data | {"column": "another"}  # of which the forms alone count

    def listed(eigenvalues: list[Data]) -> Data:
        return data | {"eigenvalues": eigenvalues}

    for k, each in enumerate(found):
        rest, width = [*found[:k], *found[k + 1 :]], F(each["radius"])
        yield "left out", listed(rest)
        for share in (F(1, 10), F(1, 10**6), 4 * width / F(size(each))):
            yield "moved", listed([*rest, moved(each, share)])
        yield "doubled", listed([*found, each])
        yield "doubled beside it", listed([*found, moved(each, F(1, 1000))])
        for next_ in found[k + 1 : k + 2]:
            one, two = ((F(at["re"]), F(at["im"])) for at in (each, next_))
            reach = max(abs(a - b) for a, b in zip(one, two, strict=True)) / 2
            square = {key: str((a + b) / 2) for key, a, b in zip(("re", "im"), one, two, strict=True)}
            others = [at for at in rest if at is not next_]
            yield "two in one", listed([*others, square | {"radius": str(reach * F(11, 10))}])
        if each["im"] != "0":
            yield "without its conjugate", listed([*rest, each | {"im": "0"}])
            yield "its conjugate", listed([*found, each | {"im": str(-F(each["im"]))}])
        else:
            yield "real as a pair", listed([*rest, each | {"im": str(2 * width)}])
    last = max(map(size, found), default=0.0)
    yield "none", listed([])
    yield "bound larger", data | {"complete_to": str(9 * r)}
    yield "bound smaller", data | {"complete_to": str(F(last) * F(9999, 10000))}
    yield "one more", listed([*found, {"re": "0", "im": str(F(last) / 3), "radius": "1/1000000"}])
    yield "one more, real", listed([*found, {"re": str(-F(last) / 3), "im": "0", "radius": "1/1000000"}])
    yield "one at zero", listed([*found, {"re": "0", "im": "0", "radius": "1/1000000"}])
    load = F(data["load"])
    yield "load", data | {"load": str(load * F(1001, 1000) + F(1, 1000))}
    yield "load, the other way", data | {"load": str(-load - F(1, 1000))}
    of_M, of_E = (F(0) if data["damping"] is None else F(data["damping"][key]) for key in ("of_M", "of_E"))
    for more, further in ((F(1, 100), F(0)), (F(0), F(1, 10**6))):
        damping = {"of_M": str(of_M + more), "of_E": str(of_E + further), "vanishing": False}
        yield "damping", other | {"alpha": "1", "damping": damping}
    if data["damping"] is not None:
        yield "undamped", other | {"alpha": "0", "beta": "0", "damping": None}
    for ends in (["clamped", "pinned"], ["clamped", "clamped"], ["pinned", "sliding"]):
        if ends != data["ends"]:
            yield "ends", other | {"ends": ends}
    forms = data["forms"]
    terms: list[tuple[str, list[Any]]] = [("E", [0, 0, 0, "1/100"])]
    terms += [("H", [0, 1, 1, "1/100"]), ("H", [0, 2, 2, "1/100"])] if load else []
    for name, term in terms:
        along = [*forms[name]["along"], term]
        yield "forms", other | {"forms": forms | {name: forms[name] | {"along": along}}}


def refusal(data: Data) -> str:
    """Why it is refused; nothing where it is accepted."""
    try:
        verify(data)
    except Refused as error:
        return str(error)
    return ""


@pytest.mark.parametrize("case", ["beyond flutter", "beyond divergence", "rigid motions", "internal damping"])
def test_certificates_of_what_is_not_so_are_refused(case: str) -> None:
    costly = {"ends", "forms", "bound larger"} if case == "internal damping" else set()  # and no matter of that damping
    for what, forged in forgeries(certificate(case)):
        assert what in costly or refusal(forged), what


def test_rigid_motions_are_no_eigenvalues_of_the_elastic_one() -> None:
    """F has s² from two of them: zeros of f at 0 and at −β, twice each."""
    data = certificate("rigid motions")
    for place in ("0", "-0.3"):
        refused(
            data | {"eigenvalues": [*data["eigenvalues"], {"re": place, "im": "0", "radius": "0.1"}]}, "a rigid motion"
        )
    refused(data | {"complete_to": "0.3", "eigenvalues": []}, "a rigid motion is on the circle")
    for bound in ("0.29", "0.31"):
        assert verify(data | {"complete_to": bound, "eigenvalues": []}).count == 0


def test_a_square_holds_a_real_number_that_is_in_it_and_not_one_below_it() -> None:
    for re, im in ((0, 0), (0, 5), (3, F(1, 10)), (3, 0), (F(-1, 10), F(1, 20)), (3, 5)):
        each = Enclosed(re=F(re), im=F(im), radius=F(1, 10))
        for real in (F(0), F(3), F(-1, 5)):
            assert each.contains(real) == (max(abs(each.re - real), abs(each.im)) <= each.radius)


def test_a_limit_of_vanishing_damping_has_no_spectrum() -> None:
    data = certificate("internal damping")
    damping = {"of_M": "0", "of_E": "1", "vanishing": True}
    refused(data | {"alpha": "0", "beta": "0", "kappa": "0", "damping": damping}, "limit of vanishing damping")


def test_hostile_files_are_refused_before_anything_is_computed(monkeypatch: pytest.MonkeyPatch) -> None:
    data, damped = certificate("two"), certificate("internal damping")

    def begun(*given: Any) -> Any:
        raise AssertionError("it was begun")

    for name in ("Function", "Circle"):
        monkeypatch.setattr(verifier_spectrum, name, begun)
    with pytest.raises(AssertionError, match="begun"):
        verify(data)
    first = data["eigenvalues"][0]
    for hostile in (
        *(data | {"load": load} for load in ("1e299", "-1e299", "nan", "1e5", 10, None)),
        *(data | {"complete_to": bound} for bound in ("0", "-1", "1e299", "10001", "inf", 100, None, ["1"])),
        *(data | {"eigenvalues": given} for given in (None, {}, "", [first] * 501, [first] * 100, [[]], [{}], [None])),
        *(data | {"eigenvalues": [first | {part: value}]} for part in ("re", "im", "radius")
          for value in ("1e299", "nan", "-1e9", 1, None, [])),
        *(data | {"eigenvalues": [first | {"radius": value}]} for value in ("0", "-1", "1e-1020", "1e9")),
        data | {"eigenvalues": [first | {"im": "1e-30"}]},
        data | {"eigenvalues": [first | {"more": "1"}]},
        data | {"modes": 8},
        data | {"ends": ["clamped"]},
        *(damped | {"column": "another", "damping": damped["damping"] | changed} for changed in (
            {"of_M": "1e40"}, {"of_M": "1e299"}, {"of_E": "1e40"}, {"of_E": "-1"}, {"of_E": "0", "of_M": "-1"},
            {"of_E": str(F(10**12 - 1, 10**12) / F(damped["complete_to"]))},
        )),
        damped | {"damping": None},
    ):  # fmt: skip
        refused(hostile, ".")


# ------------------------------------------------------------ its own steps


class Known:
    """In place of `Function`: (λ − a₁) (λ − a₂) …"""

    def __init__(self, *zeros: complex) -> None:
        self.zeros = zeros

    def near(self, whole: acb) -> Callable[[acb], tuple[acb, acb]]:
        def at(value: acb) -> tuple[acb, acb]:
            f, slope = acb(1), acb(0)
            for a in self.zeros:
                f, slope = f * (value - a), slope * (value - a) + f
            return f, slope

        return at


def test_as_many_zeros_are_counted_as_a_polynomial_has_within_the_circle() -> None:
    """With their multiplicity, and close to the circle too."""
    chance = np.random.default_rng(3)
    for _ in range(3):
        pairs = chance.uniform(0.2, 2, 4) * np.exp(1j * pi * chance.uniform(0, 1, 4))
        zeros = [*pairs, *pairs.conjugate(), *chance.uniform(-2, 2, 3), pairs[0], pairs[0].conjugate()]
        count = Circle(Known(*map(complex, zeros)), F(1)).zeros()  # type: ignore[arg-type]
        assert count == sum(abs(z) < 1 for z in zeros)
    for near, inside in ((0.999, 1), (1.001, 0)):
        assert Circle(Known(near, 5), F(1)).zeros() == inside  # type: ignore[arg-type]
    for on in ([1], [-1], [1j, -1j]):
        with pytest.raises(Refused, match="too near an eigenvalue"):
            Circle(Known(*on), F(1)).zeros()  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("zeros", "alone"),
    [
        ([1 + 2j], True),
        ([1.009 + 1.991j, 5], True),  # next to a corner
        ([1.011 + 2j], False),  # beside it
        ([1 + 1.989j], False),
        ([1 + 2j, 1 + 2j], False),  # double
        ([1.005 + 2j, 0.995 + 2j], False),
        ([5], False),
    ],
)
def test_one_simple_zero_is_told_from_none_and_from_two(zeros: list[complex], alone: bool) -> None:
    f = Function(None, F(0), F(0), F(0))  # type: ignore[arg-type]
    f.near = Known(*zeros).near  # type: ignore[method-assign]
    assert f.one_in(Enclosed(F(1), F(2), F(1, 100))) == alone


def test_the_function_on_a_box_has_the_slope_of_its_values() -> None:
    with flint.ctx.workprec(128):
        f = Function(Shooting(*of_kernel(beck)), F(10), F(1, 50), F(3, 10))
        centre, h = acb(-1, 6), acb(1, 1) * arb(2) ** -40
        at = f.near(centre + acb(arb(0, 1), arb(0, 1)) / 100)
        ahead, back = (at(centre + side * h)[0] for side in (1, -1))
        value, slope = at(centre)
        assert abs((ahead - back) / (2 * h) / slope - 1) < 1e-12
        assert at(centre + acb(arb(0, 1), arb(0, 1)) / 200)[0].contains(value)
        p, s = ball(F(10)) / (1 + centre / 50), -centre * (centre + ball(F(3, 10))) / (1 + centre / 50)
        assert all(one.overlaps(two) for one, two in zip(f._place(centre), (p, s), strict=False))


def test_a_form_of_the_load_that_acts_on_curvatures_is_refused() -> None:
    """Without internal damping it is added to that of E, whose bending stiffness must stay 1."""
    data = certificate("two")
    forms = data["forms"]
    along = [*forms["H"]["along"], [0, 2, 2, "1/100"]]
    refused(data | {"column": "another", "forms": forms | {"H": forms["H"] | {"along": along}}}, "acts on curvatures")


def test_the_command_line_writes_what_it_verifies(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file, asked = tmp_path / "spectrum.json", ["spectrum", "--load", "10", "--column", "beck", "-N", "2"]
    assert run(capsys, *asked, "--certificate", str(file))[0] == 2 and not file.exists()  # without --exact
    status, text, _ = run(capsys, *asked, "--exact", "--certificate", str(file), "--json")
    assert status == 0 and text["certificate"] == str(file)
    status, text, _ = run(capsys, "verify", str(file))
    assert status == 0 and "at P = 10, over all modes" in " ".join(text.split())
    status, text, _ = run(capsys, "verify", str(file), "--json")
    assert text["complete_to"] == found("two").complete_to
    status, _, error = run(capsys, *asked, "--exact", "--certificate", str(file))
    assert status == 2 and "exists; choose another file" in error
    missing = tmp_path / "none.json"
    status, _, error = run(capsys, *asked, "--exact", "--load", "30000", "--certificate", str(missing))
    assert status == 2 and "is not written, for it is not proven up to which" in " ".join(error.split())
    assert not missing.exists()


# ------------------------------------------------------------ random columns

COLUMNS: dict[str, dict[str, tuple[float, float]]] = {
    "beck": {"eta": (0, 1.5)}, "foundation": {"k": (0, 500)}, "free-free": {}, "hauger": {}, "leipholz": {}, "reut": {},
    "panel-pinned": {}, "panel-cantilevered": {}, "panel-trailing": {}, "euler-clamped-pinned": {},
}  # fmt: skip


def drawn(chance: random.Random) -> tuple[str, dict[str, Any]]:
    name = chance.choice([*COLUMNS])
    given: dict[str, Any] = {p: f"{chance.uniform(*ends):.4g}" for p, ends in COLUMNS[name].items()}
    given |= {"load": f"{chance.choice((0, 20, 100, -20)) * chance.random():.5g}", "modes": chance.randint(1, 6)}
    given |= {"beta": f"{10 ** chance.uniform(-2, 1.5):.3g}"} if chance.random() < 0.5 else {}
    given |= {"alpha": f"{10 ** chance.uniform(-4, -1):.3g}"} if chance.random() < 0.4 else {}
    return name, given | {"digits": chance.choice((2, 15, 15, 40))}


def main(count: int, seed: int) -> int:
    chance, told, wrong = random.Random(seed), Counter[str](), 0
    for _ in range(count):
        name, given = drawn(chance)
        begun = process_time()
        try:
            proven = fb.exact_spectrum(fb.column(name), **given)
        except InputError as error:
            print(f"{name} {given}: {error}")
            continue
        prover, begun = process_time() - begun, process_time()
        if proven.unverified is None:
            told["no proof"] += 1
            print(f"{name} {given}: {proven.missing}, {prover:.1f} s")
            continue
        data: Data = json.loads(json.dumps(proven.unverified))
        why = refusal(data)
        verified, begun = process_time() - begun, process_time()
        told["refused, true" if why else "accepted, true"] += 1
        wrong += bool(why)
        said = f"to {proven.complete_to}, {len(data['eigenvalues'])} squares: {why or 'accepted'}"
        print(f"{name} {given}: {said}; {prover:.1f} s, {verified:.1f} s", flush=True)
        for what, forged in forgeries(data) if not why else ():
            ok = not refusal(forged)
            told["accepted, forged" if ok else "refused, forged"] += 1
            if ok:
                wrong += 1
                print(f"    ACCEPTED: {what}: {json.dumps(forged)}")
        print(f"    forgeries: {process_time() - begun:.1f} s", flush=True)
    print(dict(told))
    return wrong


if __name__ == "__main__":
    sys.exit(main(*map(int, sys.argv[1:])))
