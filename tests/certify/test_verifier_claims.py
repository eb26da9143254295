"""What certificates claim, in words and as records, and what of a claim the verifier reads or refuses at once."""

from __future__ import annotations

import math
from collections.abc import Callable
from fractions import Fraction
from types import SimpleNamespace
from typing import Any

import pytest
from flint import fmpq

from freebeam_derive.certify import verifier_claims as v
from freebeam_derive.certify import verifier_of_matrices
from freebeam_derive.certify.verifier_claims import Damping, Lost, OfBeam, OfForms
from tests.certify import refusals

F = Fraction
CLAIM: dict[str, Any] = {
    "column": "own", "parameters": {"k": F(3, 2)}, "modes": 5, "alpha": F(0), "beta": F(1, 4), "kind": "flutter",
    "load": (F(2), F(201, 100)), "square": (F(4), F(401, 100)), "load_max": None,
}  # fmt: skip
FORMS: dict[str, Any] = {
    "breaks": (F(0), F(1, 3), F(1)), "unknowns": ("y", "q"), "kappa": None, "size": 7, "motions": 0, "damped": True,
    "above_zero": False,
}  # fmt: skip


def served(check: Callable[[], object]) -> bool:
    return refusals.served(check, ValueError)


# --- in words --------------------------------------------------------------------------------------------------------


def test_a_statement_of_forms_says_of_what_it_is() -> None:
    def of(**given: Any) -> OfForms:
        return OfForms(**CLAIM | FORMS | given)

    named = "the forms in this file (which names them own, k = 1.5; that they are its is not checked), of y and q, "
    plain = named + "breaks at 0, 1/3, 1, N = 5 (7 functions)"
    for given, text in (
        ({}, ", alpha = 0, beta = 0.25"), ({"damped": False}, ", undamped"),
        ({"damped": False, "gyroscopic": True}, ", undamped but for gyroscopic terms"),
        ({"motions": 1}, ", 1 rigid motion left out, alpha = 0, beta = 0.25"),
        ({"motions": 2}, ", 2 rigid motions left out, alpha = 0, beta = 0.25"),
        ({"kappa": F(3)}, ", in the limit of vanishing damping, alpha -> 0+ at beta = 3 alpha"),
        ({"kappa": math.inf}, ", in the limit of vanishing damping, beta -> 0+ at alpha = 0"),
        ({"parts": (("y",), ("q", "r"))}, ", alpha = 0, beta = 0.25, y and q-r leaving each other alone"),
        ({"parts": (("y",),)}, ", alpha = 0, beta = 0.25"),
        ({"parts": (("y",), ("y",),
        ("q",))}, ", alpha = 0, beta = 0.25, 2 motions of y and q leaving each other alone"),
        ({"lasting": (("q",),)}, f", alpha = 0, beta = 0.25, q undamped ({v.LASTING})"),
    ):  # fmt: skip
        assert of(**given).of == plain + text
    again = ", of which each is lost at a load where one is"
    assert of(scales=(F(1), F(1))).of == f"{plain}, alpha = 0, beta = 0.25, 2 of them the same{again}"
    assert (
        of(scales=(F(1), F(4))).of
        == f"{plain}, alpha = 0, beta = 0.25, 2 of them the same but for the unit of time{again}"
    )
    assert of(scales=(F(1), F(1))).times == 2 and of().of_one == ""
    assert (
        of(parts=(("y",), ("q",))).of_one == " of one of these" and of(whirls=True).of_one == " of one sense of whirl"
    )
    assert of(parts=(("y",),)).of_one == ""


def test_a_frequency_of_what_whirls_is_less_by_the_turn_of_the_frame() -> None:
    given = CLAIM | FORMS | {"turn": fmpq(1, 2)}
    assert OfForms(**given, whirls=True).frequency == (F(7, 2), F(351, 100))
    low, high = OfForms(**given).frequency or (0, 0)
    assert low == 2 and high == pytest.approx(math.sqrt(4.01))
    assert OfForms(**given | {"square": None}, whirls=True).frequency is None
    assert OfForms(**given | {"turn": None}, whirls=True).frequency == (low, high)
    half = F(1, 2)
    for square, omega in (
        ((3, 4), (2, 3)), ((F(1, 4), half), (half, F(3, 4))), ((half, 3), (0, 2)), ((1, 2), (0, 1)),
        ((half, 1), (0, half)),
    ):  # fmt: skip
        assert v.whirl((F(square[0]), F(square[1])), fmpq(1)) == omega


def test_what_is_lost_is_said_with_all_that_is_lost_there() -> None:
    given = CLAIM | FORMS
    text = str(OfForms(**given))
    assert (
        "stable at every load P from 0 to" in text
        and "with omega between" in text
        and "no other eigenvalue has Re = 0" in text
    )
    assert "every load P above 0 up to" in str(OfForms(**given | {"above_zero": True}))
    assert "no other frequencies meet" in str(OfForms(**given | {"damped": False}))
    seen = " as seen from rest (in the frame each omega is omega - 1/2 and omega + 1/2)"
    assert (seen in str(OfForms(**given, turn=fmpq(1, 2)))) and seen not in str(
        OfForms(**given, turn=fmpq(1, 2), whirls=True)
    )
    at_once = (
        Lost(("r", "s"), "divergence", None, None),
        Lost(("t",), "flutter", (F(9), F(10)), (F(3), F(4)), fmpq(1, 2)),
    )
    both = OfForms(**given, at_once=at_once)
    assert ", and at exactly that load by divergence of motions of r-s, where det K = 0" in str(both)
    assert f", and at exactly that load by flutter of motions of t, {v.at_frequency((F(3), F(4)))}{seen}" in str(both)
    record = both.record()
    names = "of", "kind", "frequency_lower", "frequency_upper", "turn"
    assert [tuple(of[name] for name in names) for of in record["at_once"]] == [
        (["r", "s"], "divergence", "0", "0", None), (["t"], "flutter", *v.shown(F(3), F(4)), "1/2"),
    ]  # fmt: skip
    assert record["turn"] is None and record["functions"] == 7 and record["rigid_motions_left_out"] == 0
    assert OfForms(**given, turn=fmpq(1, 2)).record()["turn"] == "1/2"
    assert OfForms(**given, turn=fmpq(1, 2), whirls=True).record()["turn"] is None
    assert record["stable_at_zero_load"] is True
    assert OfForms(**given | {"above_zero": True}).record()["stable_at_zero_load"] is None
    zero = OfForms(**given | {"square": (F(0), F(0))})
    assert "where a pair of eigenvalues leaves zero" in str(zero)
    none = OfForms(**given | {"kind": "none", "load": None, "square": None, "load_max": F(7)})
    assert str(none).endswith("stable at every load P from 0 to 7") and (none.end, none.top) == (7, 7)
    assert none.record()["load_lower"] is None and none.record()["stable_to"] == "7"
    assert (OfForms(**given).end, OfForms(**given).top) == (2, F(201, 100))
    divergence = OfForms(**given | {"kind": "divergence", "square": None})
    assert "where det K = 0" in str(divergence) and divergence.record()["frequency_upper"] == "0"
    lasting = str(OfForms(**given, lasting=(("q",),)))
    assert (
        "no other eigenvalue of a damped part has Re = 0, and no frequencies of an undamped one meet, up to" in lasting
    )


def test_a_statement_of_a_beam_says_of_what_it_is() -> None:
    given = CLAIM | {"ours": True, "ends": ("clamped", "free"), "basis": "modes", "kappa": None, "damping": None}
    assert OfBeam(**given).of == "column own, k = 1.5, clamped at x = 0 and free at x = 1, N = 5 (modes), undamped"
    damping = Damping(F(2), F(1, 3), vanishing=False)
    for more, text in (
        ({"damping": damping}, "C = 2 M + 1/3 E (alpha = 0, beta = 0.25)"),
        ({"damping": damping, "ours": False}, "C = 2 M + 1/3 E"),
        ({"damping": damping, "kappa": F(6)},
         "in the limit of vanishing damping in the direction of C = 2 M + 1/3 E (alpha -> 0+ at beta = 6 alpha)"),
        ({"damping": damping, "kappa": F(6), "ours": False},
         "in the limit of vanishing damping in the direction of C = 2 M + 1/3 E"),
    ):  # fmt: skip
        assert OfBeam(**given | more).damped == text
    ours, other = OfBeam(**given | {"damping": damping}).record(), OfBeam(**given | {"ours": False}).record()
    assert (ours["alpha"], ours["beta"], ours["kappa"], ours["parameters"]) == ("0", "0.25", None, {"k": "1.5"})
    assert ours["damping"] == {"of_M": "2", "of_E": "1/3", "vanishing": False} and other["damping"] is None
    assert other["alpha"] is other["beta"] is other["kappa"] is other["parameters"] is None
    assert OfBeam(**given | {"kappa": math.inf}).record()["kappa"] == "inf"
    assert "no other frequencies meet" in str(OfBeam(**given)) and "Re = 0" in str(
        OfBeam(**given | {"damping": damping})
    )


def test_a_statement_of_matrices_says_of_what_it_is() -> None:
    given = CLAIM | {
        "kappa": None, "size": 7, "widest": F(1, 10**9), "damped": True, "above_zero": False, "parts": (("y",),),
        "lasting": (), "scales": (F(1),), "gyroscopic": False,
    }  # fmt: skip

    def of(**more: Any) -> verifier_of_matrices.OfMatrices:
        return verifier_of_matrices.OfMatrices(**given | more)

    assert of().of.endswith("N = 5 (7 functions), entries within 1.0e-09, said to be at alpha = 0, beta = 0.25")
    assert of(damped=False, gyroscopic=True).of.endswith(
        ", undamped but for gyroscopic terms, M and K symmetric and C skew"
    )
    two = (("y",), ("q", "r"))
    assert (
        of(parts=two).of.endswith(", y and q-r leaving each other alone") and of(parts=two).of_one == " of one of these"
    )
    assert of().of_one == "" and "leaving" not in of().of and "numbers" not in of().of
    assert ", 2 of them with the same numbers, of which each" in of(scales=(F(1), F(1))).of
    assert ", 2 of them with the same numbers but for the unit of time, of which each" in of(scales=(F(1), F(2))).of
    assert of(above_zero=True).record()["stable_at_zero_load"] is None and of().record()["stable_at_zero_load"] is True
    assert of(lasting=(("q",),)).of.endswith(f", q undamped ({v.LASTING})") and "above 0" in str(of(above_zero=True))


# --- what is read ----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("field", "right", "wrong"), [
    ("modes", (1, 200), (0, 201, -1, True, "5", 5.0)), ("column", ("", "a" * 200), ("a" * 201, 7, "a\nb")),
    ("parameters", ({}, {"k" * 200: "1"}, {f"k{n}": "1" for n in range(100)}),
     ({"k" * 201: "1"}, {"k l": "1"}, {f"k{n}": "1" for n in range(101)}, {"k": 1}, {"k": "x"})),
    ("alpha", ("0", "-1"), (0, "x", None)), ("beta", ("0", "-1"), (0, "x", None)),
])  # fmt: skip
def test_what_a_certificate_names_is_of_its_kind_and_size(field: str, right: Any, wrong: Any) -> None:
    data = {"column": "own", "modes": 5, "parameters": {"k": "1"}, "alpha": "0", "beta": "1/2"}
    for value in right:
        v.named(data | {field: value})
    for value in wrong:
        assert not served(lambda value=value: v.named(data | {field: value})), value  # type: ignore[misc]


def test_a_crossing_has_a_load_and_a_frequency_as_its_kind_says() -> None:
    load, square = ["1", "2"], ["3", "4"]
    sides = (F(1), F(2)), (F(3), F(4))
    for kind, given, at_zero, expected in (
        ("flutter", (load, square), False, sides), ("divergence", (load, None), False, (sides[0], None)),
        ("none", (None, None), False, (None, None)), ("flutter", (load, None), False, 0),
        ("divergence", (load, square), False, 0),
        ("none", (load, None), False, 0), ("flutter", (None, square), False, 0), ("touch", (load, None), False, 0),
        ("flutter", (load, ["0", "0"]), True, (sides[0], (0, 0))), ("flutter", (load, ["0", "0"]), False, 0),
        ("flutter", (load, ["0", "1"]), True, 0), ("flutter", (load, square), True, sides),
        ("divergence", (["2", "2"], None), False, 0), ("divergence", (["0", "2"], None), False, 0),
        ("divergence", (["-1", "2"], None), False, 0), ("divergence", (["1", "1." + "0" * 250 + "1"], None), False, 1),
    ):  # fmt: skip
        data = {"kind": kind, "load": given[0], "frequency_squared": given[1]}
        if expected == 0:
            assert not served(lambda data=data, z=at_zero: v.crossing(data, z))  # type: ignore[misc]
        elif expected != 1:
            assert v.crossing(data, at_zero) == {"kind": kind, "load": expected[0], "square": expected[1]}


def test_a_damping_fits_alpha_beta_and_kappa() -> None:
    def given(of_M: str, of_E: str, vanishing: Any) -> dict[str, Any]:
        return {"of_M": of_M, "of_E": of_E, "vanishing": vanishing}

    for alpha, beta, kappa, damping, right in (
        (0, 0, None, None, True), (1, 0, None, given("1", "1", False), True),
        (0, 1, None, given("1", "0", False), True),
        (0, 0, "2", given("1", "1", True), True), (0, 0, "inf", given("1", "0", True), True),
        (0, 0, "inf", given("0", "0", True), False),
        (0, 0, "2", given("-1", "1", True), True), (0, 0, "2", given("-1", "0", True), False),
        (0, 0, "2", given("1", "-1", True), False),
        (1, 0, "2", given("1", "1", True), False), (0, 0, None, given("1", "1", False), False),
        (1, 0, None, None, False),
        (0, 0, "2", given("1", "1", False), False), (1, 0, None, given("1", "1", True), False),
        (0, 0, "2", None, False),
        (0, 0, "2", given("1", "1", 1), False), (1, 0, None, {"of_M": "1"}, False),
        (1, 0, None, given("0", "0", False), True),
    ):  # fmt: skip
        data = {"kappa": kappa, "damping": damping}
        claims = {"alpha": F(alpha), "beta": F(beta)}
        assert served(lambda data=data, claims=claims: v.damping_of(data, claims)) is right  # type: ignore[misc]
    assert v.damping_of({"kappa": "2", "damping": given("3", "4", True)}, {"alpha": 0, "beta": 0}) == (
        2,
        Damping(F(3), F(4), True),
    )
    assert v.direction(math.inf) == (0, 1) and v.direction(F(3)) == (1, 3)


def test_numbers_are_below_what_is_written() -> None:
    assert v.number("9.99e299") < 10**300 and served(lambda: v.number("-9e299"))
    assert not served(lambda: v.number("1e300")) and not served(lambda: v.number("-1e300"))


def test_powers_orders_and_ends_of_a_form_are_in_their_bounds() -> None:
    for along, points, right in (
        ((100, 3, 3), (1, 3, 1, 3), True), ((0, 0, 0), (0, 0, 0, 0), True), ((101, 0, 0), None, False),
        ((-1, 0, 0), None, False),
        ((0, 4, 0), None, False), ((0, 0, 4), None, False), ((0, -1, 0), None, False), (None, (2, 0, 0, 0), False),
        (None, (0, 4, 0, 0), False), (None, (0, 0, 2, 0), False), (None, (0, 0, 0, 4), False),
        (None, (0, 0, -1, 0), False),
        (("0", 0, 0), None, False), (None, (0, True, 0, 0), False),
    ):  # fmt: skip
        data = {"along": [[*along, "1"]] if along else [], "points": [[*points, "2"]] if points else []}
        assert served(lambda data=data: v.form(data)) is right  # type: ignore[misc]
    most = {"along": [[0, 0, 0, "1"]] * 60, "points": [[0, 0, 0, 0, "1"]] * 40}
    assert served(lambda: v.form(most)) and not served(lambda: v.form(most | {"points": [[0, 0, 0, 0, "1"]] * 41}))


def test_a_parameter_stands_linearly_in_forms_and_damping(monkeypatch: pytest.MonkeyPatch) -> None:
    """As polynomials of it; kappa as beta at alpha 1."""
    seen: list[Any] = []

    def kernel(square: bool) -> Any:
        def forms(P: Any, k: Any) -> Any:
            return {"E": ({(0, 2, 2): 1}, {(1, 0, 1, 0): k * k if square else k})}

        def damping_factors(alpha: Any, beta: Any, k: Any) -> Any:
            seen.append((alpha, beta, k))
            return beta, alpha

        return SimpleNamespace(forms=forms, damping_factors=damping_factors)

    monkeypatch.setattr(v, "COLUMNS", {"own": {"modes": "own"}})
    stated: Any = SimpleNamespace(column="own", parameters={"k": F(2)}, alpha=F(3), beta=F(5), kappa=None)
    for square, name, right in ((False, "k", True), (True, "k", False), (True, "beta", True), (False, "alpha", True)):
        monkeypatch.setattr(v, "import_module", lambda _, square=square: kernel(square))
        assert served(lambda name=name: v.check_linear(stated, name)) is right  # type: ignore[misc]
        alpha, beta, k = seen[-1]
        expected = [[3], [5], [2]]
        expected[("alpha", "beta", "k").index(name)] = [0, 1]
        assert [[int(c) for c in f.coeffs()] for f in (alpha, beta, k)] == expected
    stated.kappa = F(7)
    v.check_linear(stated, "kappa")
    assert [[int(c) for c in f.coeffs()] for f in seen[-1]] == [[1], [0, 1], [2]]


def test_json_is_of_names_that_stand_once_short_integers_and_no_floats() -> None:
    assert v.parsed(b'{"a": 123456789, "b": ["1.5", null, true]}') == {"a": 123456789, "b": ["1.5", None, True]}
    for wrong in (b'{"a": 1234567890}', b'{"a": 1, "a": 2}', b'{"a": 1.5}', b'{"a": NaN}', b'{"a": 1e3}', b"{"):
        assert not served(lambda wrong=wrong: v.parsed(wrong))  # type: ignore[misc]
    text = b'"' + b"x" * (v.LARGEST_FILE - 2) + b'"'
    assert served(lambda: v.parsed(text)) and not served(lambda: v.parsed(text + b" "))
