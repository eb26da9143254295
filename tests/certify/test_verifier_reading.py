"""What the verifier reads of a file: each number up to its bound, and none beyond it, before anything is computed."""

from __future__ import annotations

from copy import deepcopy
from fractions import Fraction
from typing import Any

import pytest
from flint import fmpq

from freebeam_derive.certify import certificate, verifier, verifier_beam_claims, verifier_claims, verifier_of_matrices
from freebeam_derive.certify.verifier_claims import Refused

F = Fraction
Data = dict[str, Any]
SPACE: Data = {
    "breaks": ["0", "1/3", "2/3", "1"], "modes": 4, "coordinates": ["q"],
    "fields": {"y": {"joined": 2, "held": [[0, 0], [0, 1], [1, 1]], "opened": [[1, 1], [2, 0]]},
               "z": {"joined": 1, "held": [[1, 0]], "opened": [[2, 0]]}},
}  # fmt: skip
FIELD = ("fields", "y")


def altered(data: Data, path: Any, value: Any) -> Data:
    """With something else at a place, or nothing: gone."""
    data = deepcopy(data)
    *way, last = path if isinstance(path, tuple) else (path,)
    of: Any = data
    for key in way:
        of = of[key]
    if value == "gone":
        del of[last]
    else:
        of[last] = value
    return data


SPACES: list[tuple[Any, Any, Any]] = [
    # what is altered, what may stand there, what may not
    ("breaks", ["0", "1"], ["0"]),
    ("breaks", ["0", "1/3", "1/2", "1"], ["0", "1/3", "1/3", "1"]),
    ("breaks", ["0", "2/3", "3/4", "1"], ["0", "2/3", "1/3", "1"]),
    ("breaks", None, ["1/9", "1/3", "2/3", "1"]),
    ("breaks", None, ["0", "1/3", "2/3", "9/10"]),
    ("breaks", ["0", "1/" + "9" * 992, "9/10", "1"], ["0", "1/" + "9" * 993, "9/10", "1"]),
    ("coordinates", [], "q"),
    ("coordinates", ["q" * 200], ["q" * 201]),
    ("coordinates", ["r"], ["y"]),
    ("coordinates", ["r", "s"], ["r", "r"]),
    ("coordinates", [f"q{k}" for k in range(18)], [f"q{k}" for k in range(19)]),
    ("coordinates", ["r"], ["r s"]),
    ("coordinates", ["r"], [1]),
    ((*FIELD, "joined"), 2, 3),
    ((*FIELD, "joined"), 2, -1),
    ((*FIELD, "joined"), 2, True),
    ((*FIELD, "joined"), 2, 1),  # with a slope held
    ((*FIELD, "held"), [[1, 1]], [[2, 1]]),
    ((*FIELD, "held"), [[0, 0]], [[-1, 0]]),
    ((*FIELD, "held"), [[0, 0]], [[0, -1]]),
    ((*FIELD, "held"), [[0, 1]], [[0, 2]]),
    ((*FIELD, "held"), [[0, 1]] * 4, [[0, 1]] * 5),
    ((*FIELD, "opened"), [[1, 0]], [[0, 0]]),
    ((*FIELD, "opened"), [[2, 1]], [[3, 1]]),
    ((*FIELD, "opened"), [[2, 1]], [[2, 2]]),
    ((*FIELD, "opened"), [[2, 0]], [[2, -1]]),
    ((*FIELD, "opened"), [[2, 1]] * 4, [[2, 1]] * 5),
    (("fields", "z", "held"), [[1, 0]], [[1, 1]]),
    (("fields", "y"), {"joined": 2, "held": [], "opened": []}, {"joined": 2, "held": []}),
    (("fields", "y"), {"joined": 0, "held": [], "opened": []}, {"joined": 2, "held": [], "opened": [], "more": 0}),
    ("modes", 64, 65),  # 6 segments of 66 unknowns and a coordinate
]  # fmt: skip


@pytest.mark.parametrize(("path", "right", "wrong"), SPACES)
def test_a_space_is_read_up_to_its_bounds(path: Any, right: Any, wrong: Any) -> None:
    base = SPACE
    if path == "breaks" and right == ["0", "1"]:
        base = altered(altered(SPACE, (*FIELD, "opened"), []), ("fields", "z", "opened"), [])
    if right is not None:
        space = verifier._space(altered(base, path, right))
        assert space.size <= 400 and space.breaks[-1] == 1
    with pytest.raises((Refused, TypeError)):
        verifier._space(altered(base, path, wrong))


def test_unknowns_are_numbered_one_after_another() -> None:
    space = verifier._space(SPACE)
    assert space.D == 6 and space.size == 2 * 3 * 6 + 1
    starts = [space.start(name, n) for name in ("y", "z") for n in range(3)] + [space.start("q", 0)]
    assert starts == [*range(0, 36, 6), 36]
    assert space.fields["y"] == (2, {(0, 0), (0, 1), (1, 1)}, {(1, 1), (2, 0)})
    # y and y' at 0, y' at 1; y and y' go on at 1/3 and 2/3 but where they are opened. z is held at 1, and open at 2/3
    assert len(space.conditions()) == 3 + 2 + 1 + 1


FORM: Data = {
    "along": [[0, "y", 2, "y", 2, ["1", "1/2"]], [2, "y", 1, "q", 0, ["3"]]],
    "points": [[["y", 1, "1/3", -1], ["q", 0, None, 0], "2"], [["y", 0, "1", 0], ["z", 0, "1/2", 1], "-1"]],
}
FORMS: list[tuple[Any, Any, Any]] = [
    (("along", 0, 0), 2, 3), (("along", 0, 0), 0, -1), (("along", 0, 1), "z", "w"), (("along", 0, 2), 4, 5),
    (("along", 0, 2), 0, -1), (("along", 0, 3), "z", "w"), (("along", 0, 4), 4, 5), (("along", 0, 5), ["1"], []),
    (("along", 0, 5), ["1"] * 100, ["1"] * 101), (("along", 0, 5), ["1/3"], ["x"]), (("along", 1, 4), 0, 1),
    (("points", 0, 0, 0), "z", "q"), (("points", 0, 0, 1), 4, 5), (("points", 0, 0, 2), "0", "-1/3"),
    (("points", 0, 0, 2), "1", "4/3"), (("points", 0, 0, 2), "1/2", None), (("points", 0, 0, 3), 1, 2),
    (("points", 0, 0, 3), -1, -2), (("points", 0, 1, 0), "q", "y"), (("points", 0, 1, 1), 0, 1),
    (("points", 0, 1, 3), 0, 1), (("points", 0, 2), "1/7", "1,5"), (("points",), [], "gone"), (("along",), [], "gone"),
]  # fmt: skip


@pytest.mark.parametrize(("path", "right", "wrong"), FORMS)
def test_a_form_is_read_up_to_its_bounds(path: Any, right: Any, wrong: Any) -> None:
    space = verifier._space(SPACE)
    verifier._form(altered(FORM, path, right), space)
    with pytest.raises((Refused, ValueError)):
        verifier._form(altered(FORM, path, wrong), space)
    with pytest.raises(Refused, match="other parts"):
        verifier._form(FORM | {"more": []}, space)


def test_a_form_is_what_it_says() -> None:
    along, points = verifier._form(FORM, verifier._space(SPACE))
    assert [(*of[:-1], [*of[-1].coeffs()]) for of in along] == [
        (0, "y", 2, "y", 2, [1, fmpq(1, 2)]), (2, "y", 1, "q", 0, [3])
    ]  # fmt: skip
    assert points == [
        (("y", 1, F(1, 3), -1), ("q", 0, None, 0), fmpq(2)), (("y", 0, F(1), 0), ("z", 0, F(1, 2), 1), fmpq(-1)),
    ]  # fmt: skip


def test_a_rigid_motion_is_of_lines() -> None:
    """1 + 2x on each third of y in the unknowns of a segment, x = low + ξ/3."""
    space, line = verifier._space(SPACE), {"y": [["1", "2"]] * 3, "q": "5"}
    found = verifier._motion(line, space)
    thirds = [(1, fmpq(2, 3)), (fmpq(5, 3), fmpq(2, 3)), (fmpq(7, 3), fmpq(2, 3))]
    assert [tuple(found[6 * n : 6 * n + 2]) for n in range(3)] == thirds and found[36] == 5
    assert sum(v != 0 for v in found) == 7
    for wrong in ({"y": [["1"]] * 2}, {"y": [["1"]] * 4}, {"w": [["1"]] * 3}, {"y": [["1", "2", "3"]] * 3}):
        with pytest.raises(Refused, match="a rigid motion is"):
            verifier._motion(wrong, space)


# ------------------------------------------------------------ stretches

LINES = [["1", "0"], ["2", "1"]]
STRETCHES = [
    {"start": "0", "end": "1", "origin": "0", "separators": LINES},
    {"start": "1", "end": "3", "origin": "1", "separators": LINES},
]


def stretches(*changes: tuple[Any, Any], end: int = 3, rests: bool = False, more: bool = False) -> Any:
    data: Data = {"all": STRETCHES}
    for path, value in changes:
        data = altered(data, ("all", *path), value)
    return verifier._stretches(data["all"], F(end), 3, rests, more)


def test_stretches_are_without_a_gap_and_their_lines_ascend() -> None:
    one, two = stretches()
    assert (one.start, one.end, two.start, two.end) == (0, 1, 1, 3)
    assert two.lines == ((0, 0), (1, 0), (2, 1)) and two.origin == 1
    for changes, message in (
        ([((0, "start"), "1/9")], "leave a gap"), ([((1, "start"), "2")], "leave a gap"),
        ([((0, "end"), "2")], "leave a gap"), ([((1, "end"), "1")], "leave a gap"),
        ([((1, "separators"), LINES[:1])], "too few separators, or too many"),
        ([((1, "separators"), [*LINES, ["9", "0"]])], "too few separators, or too many"),
        ([((0, "separators", 0, 0), "2")], "do not ascend"), ([((0, "separators", 0, 0), "0")], "do not ascend"),
        ([((0, "separators", 1, 1), "-1")], "do not ascend"), ([((0, "separators", 0, 1), "-1")], "do not ascend"),
        ([((0, "more"), "1")], "other parts"),
    ):  # fmt: skip
        with pytest.raises(Refused, match=message):
            stretches(*changes)
    for end in (2, 4):
        with pytest.raises(Refused, match="not shown up to the load"):
            stretches(end=end)
    with pytest.raises(Refused, match="not shown up to the load"):
        verifier._stretches([], F(0), 3)


def test_lines_meet_at_rest_alone_and_the_first_stretch_has_one_more_where_it_must() -> None:
    through = [((0, "separators"), [["0", "1"], ["0", "2"]])]
    assert stretches(*through, rests=True)
    for changes, rests in ((through, False), ([((0, "separators"), [["0", "0"], ["0", "2"]])], True),
                           ([*through, ((0, "origin"), "1/2")], True), ([((0, "separators"), [["1", "1"]] * 2)], True),
                           ([((1, "separators"), [["0", "0"], ["1", "2"]])], True)):  # fmt: skip
        with pytest.raises(Refused, match="do not ascend"):
            stretches(*changes, rests=rests)
    third = ((0, "separators"), [["0", "1"], ["0", "2"], ["1", "2"]])
    assert stretches(third, rests=True, more=True)
    for changes in ([third, ((1, "separators"), [*LINES, ["9", "0"]])], []):
        with pytest.raises(Refused, match="too few separators, or too many"):
            stretches(*changes, rests=True, more=True)


# ------------------------------------------------------------ a crossing and numbers


def test_numbers_are_fractions_of_so_many_characters() -> None:
    for text, value in (("1/3", F(1, 3)), ("-2.5", F(-5, 2)), ("7e2", F(700)), ("9" * 300, 10**300 - 1)):
        assert verifier_claims.number(text) == value
    for wrong in ("", "1/0", "x", "1e", "nan", "1" + "0" * 300, "-1" + "0" * 300, " 1", 1, None, "1/3/5", "0x1"):
        with pytest.raises((Refused, ValueError, ArithmeticError, TypeError)):
            verifier_claims.number(wrong)


def test_matrices_are_lists_by_powers_of_the_load() -> None:
    row = ["1", ["2", "1/9"]]
    (table,) = verifier_of_matrices._tables([[row, row]], 2)
    assert [[(F(a), F(b)) for a, b in of] for of in table] == [[(1, 0), (2, F(1, 9))]] * 2
    most = verifier_of_matrices.MOST_POWERS
    assert len(verifier_of_matrices._tables([[row, row]] * most, 2)) == most
    for wrong in ([[row, row]] * (most + 1), [[row]], [[row, row, row]], [[row, row[:1]]], [[row, [*row, "1"]]],
                  [[row, ["1", ["2", "-1"]]]], [[row, ["1", ["2", "1", "1"]]]], {"0": [row, row]}):  # fmt: skip
        with pytest.raises((Refused, ValueError, TypeError)):
            verifier_of_matrices._tables(wrong, 2)


def test_a_list_of_crossings_ascends_and_its_numbers_fit(monkeypatch: pytest.MonkeyPatch) -> None:
    for name, value in (
        ("fields", lambda *_: None), ("lowest", lambda _: 1), ("points", lambda *_: ()),
        ("column", lambda data, of, **given: (given, None)),
    ):  # fmt: skip
        monkeypatch.setattr(verifier_beam_claims, name, value)

    def crossing(low: int, high: int, change: int, unstable: int) -> Data:
        at = {"load": [str(low), str(high)], "frequency_squared": ["4", "5"]}
        return {"kind": "flutter", "change": change, "unstable": unstable, **at}

    def read(*listed: Data, top: str = "50") -> Any:
        return verifier_beam_claims.crossings({"load_max": top, "points": [], "crossings": list(listed)})

    one, two, back = crossing(10, 12, 2, 0), crossing(13, 14, 2, 2), crossing(20, 21, -2, 4)
    stated, *_ = read(one, two, back)
    assert [(p.change, p.unstable, p.load[0]) for p in stated["passings"]] == [(2, 0, 10), (2, 2, 13), (-2, 4, 20)]
    for listed, message in (
        ((one, crossing(11, 14, 2, 2)), "do not ascend"), ((one, crossing(12, 14, 2, 2)), "do not ascend"),
        ((two, one), "do not fit"), ((one, crossing(13, 14, 2, 0)), "do not fit"),
        ((crossing(10, 12, -2, 0),), "fewer than no eigenvalue"),
        ((one, crossing(13, 14, -2, 2), crossing(15, 16, -2, 0)), "fewer than no"),
    ):  # fmt: skip
        with pytest.raises(Refused, match=message):
            read(*listed)
    for top in ("12", "11"):
        with pytest.raises(Refused, match="not below the end of the loads"):
            read(one, top=top)
    for top in ("0", "-1", str(verifier_beam_claims.HIGHEST)):
        with pytest.raises(Refused, match="end where they begin, or go on for too long"):
            read(one, top=top)


def test_a_form_is_written_less_another_of_the_same_terms() -> None:
    """Segment by segment and power by power; what is left of nothing is not written."""
    value, other = ("y", 0, fmpq(1), 0), ("y", 1, fmpq(1, 2), -1)
    along = [((0, 1), "y", 1, "y", 1, [5, fmpq(1, 3)]), ((1,), "y", 0, "y", 0, [2])]
    points = [(value, other, fmpq(7, 2)), (value, value, 1)]
    less = [((0, 1), "y", 1, "y", 1, [2]), ((1,), "y", 0, "y", 0, [2])], [(value, other, 3), (value, value, 1)]
    ends = [["y", 0, "1", 0], ["y", 1, "1/2", -1]]
    assert certificate._form((along, points), less) == {
        "along": [[n, "y", 1, "y", 1, ["3", "1/3"]] for n in (0, 1)],
        "points": [[*ends, "1/2"]],
    }
    whole = certificate._form((along, points))
    assert whole["along"][0][-1] == ["5", "1/3"] and [p[-1] for p in whole["points"]] == ["7/2", "1"]
