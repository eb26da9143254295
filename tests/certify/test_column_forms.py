"""Which columns the proofs by gaps between frequencies serve: what is next to them, by one term or one number, is
refused by its name; and what those that are served are read as."""

from __future__ import annotations

from copy import deepcopy
from fractions import Fraction
from types import SimpleNamespace
from typing import Any

import pytest
from flint import arb

from freebeam_derive.certify.balls import precision
from freebeam_derive.certify.column_forms import ColumnForms, over_both
from freebeam_derive.certify.damped_gaps import LeftOver, of_mass_alone, over_range
from freebeam_derive.certify.load_size import size_along
from freebeam_derive.certify.stepped_section import PARTS, SteppedSection
from freebeam_derive.certify.strips import NoStrips
from freebeam_derive.certify.variable_section import VariableSection

F = Fraction
HALF, ONE = F(1, 2), F(1)


def along(p: int, q: int, *factors: Any, on: tuple[int, ...] = (0, 1)) -> Any:
    return (on, "y", p, "y", q, factors)


def at(place: Any, order: int, factor: Any, other: Any = None, side: int = 0, across: int = 0) -> Any:
    """A square of a value at a place, or the product with that of another place and order."""
    of, q = other or (place, order)
    return (("y", order, place, side), ("y", q, of, across), factor)


def kernel(**changes: Any) -> Any:
    """A cantilever of two like segments under a follower force at its tip, or what is changed of it."""
    given: dict[str, Any] = {
        "ends": ("clamped", "free"), "rigid": 0, "fields": {"y": (2, (), ())}, "coordinates": (), "column": {},
        "places": (F(0), HALF, ONE), "mass": [along(0, 0, 1)], "masses": [], "bending": [along(2, 2, 1)],
        "springs": [], "load": [along(1, 1, -1)], "forces": [at(ONE, 0, 1, (ONE, 1))], "more": {},
        "damping": [along(2, 2, 1), along(0, 0, 3)], "dampers": [],
    }  # fmt: skip
    assert changes.keys() <= given.keys()
    given |= changes

    def forms(one: Any, alpha: Any = 0, beta: Any = 0) -> dict[str, Any]:
        stated = {
            "M": [(given["mass"], given["masses"])],
            "K": [(given["bending"], given["springs"]), (given["load"], given["forces"])],
            "C": [(given["damping"] if alpha or beta else [], given["dampers"] if alpha or beta else [])],
        }
        return {letter: [*parts, *given["more"].get(letter, [])] for letter, parts in stated.items()}

    column = {"name": "it", "ends": given["ends"], "rigid": given["rigid"], "parameters": []} | given["column"]
    return SimpleNamespace(
        COLUMN=column, FIELDS=given["fields"], COORDINATES=given["coordinates"],
        places=lambda one: given["places"], forms=forms,
    )  # fmt: skip


SERVED: dict[str, dict[str, Any]] = {
    "as it is": {},
    "a mass and a spring": {"masses": [at(HALF, 0, F(1, 3)), at(ONE, 1, 1)], "springs": [at(HALF, 1, 2)]},
    "a spring that an end holds": {"springs": [at(F(0), 0, -1)]},
    "a force of nothing": {"forces": [at(F(1, 3), 0, 0)]},
    "a foundation": {"bending": [along(2, 2, 1), along(0, 0, 0, 1)]},
    "tension": {"bending": [along(2, 2, 1), along(1, 1, 1, -1)]},
    "a dead load": {"bending": [along(2, 2, 1), along(1, 1, -1)]},
    "a joint": {
        "fields": {"y": (2, (), ((1, 1),))},
        "springs": [at(HALF, 1, 2 * s * t, None, s, t) for s in (-1, 1) for t in (-1, 1)],
    },
}
JOINT = SERVED["a joint"]
REFUSED: dict[str, tuple[dict[str, Any], str]] = {
    "circulatory": ({"column": {"circulatory": True}}, "damping that acts on displacements"),
    "a second field": ({"fields": {"y": (2, (), ()), "z": (2, (), ())}}, "more than the one deflection"),
    "a coordinate": ({"coordinates": ("q",)}, "more than the one deflection"),
    "rigid": ({"rigid": 1}, "moves rigidly"),
    "a root": ({"places": (F(0), "half", ONE)}, "a factor that is no fraction"),
    "a second mass": ({"more": {"M": [([], [])]}}, "mass that changes with the load"),
    "a load squared": ({"more": {"K": [([], [])]}}, "or a load that enters squared"),
    "a mass of slopes": ({"mass": [along(0, 0, 1), along(1, 1, 1)]}, "a rotary inertia along the beam"),
    "a mass that couples": ({"mass": [along(0, 0, 1), along(0, 1, 1)]}, "energy of another order"),
    "a load on curvatures": ({"load": [along(2, 1, 1)]}, "energy of another order"),
    "a third derivative": ({"bending": [along(2, 2, 1), along(0, 3, 1)]}, "energy of another order"),
    "no mass at the tip": ({"mass": [along(0, 0, 1, -1)]}, "mass or a stiffness that is not known to be positive"),
    "half a stiffness": ({"bending": [along(2, 2, 1, on=(0,))]}, "a stiffness that is not known to be positive"),
    "not symmetric": ({"bending": [along(2, 2, 1), along(0, 1, 1)]}, "elastic energy that is not symmetric"),
    "softened": ({"bending": [along(2, 2, 1), along(0, 0, -1)]}, "elastic energy that is not known to be positive"),
    "of both signs": ({"bending": [along(2, 2, 1), along(1, 1, -1, 3)]}, "energy that is not known to be positive"),
    "too dead a load": ({"bending": [along(2, 2, 1), along(1, 1, -2)]}, "energy that is not known to be positive"),
    "a dead load on a pinned column": (
        {"ends": ("pinned", "pinned"), "bending": [along(2, 2, 1), along(1, 1, -1)]},
        "energy that is not known to be positive",
    ),
    "a dead load and a joint": (
        JOINT | {"bending": [along(2, 2, 1), along(1, 1, -1)]}, "energy that is not known to be positive",
    ),
    "a negative spring": ({"springs": [at(HALF, 0, -1)]}, "couples two places or is negative"),
    "a negative mass": ({"masses": [at(HALF, 0, -1)]}, "couples two places or is negative"),
    "two places": ({"springs": [at(HALF, 0, 1, (ONE, 0))]}, "couples two places or is negative"),
    "a force between": ({"forces": [at(F(1, 3), 0, 1)]}, "not at an end or where segments meet"),
    "a sensor between": ({"forces": [at(ONE, 0, 1, (F(1, 3), 0))]}, "not at an end or where segments meet"),
    "a sensor of curvature": ({"forces": [at(ONE, 0, 1, (HALF, 2))]}, "not at an end or where segments meet"),
    "a joint without a spring": (JOINT | {"springs": []}, "joint that is no spring"),
    "a joint of one side": (JOINT | {"springs": JOINT["springs"][:3]}, "joint that is no spring"),
    "a joint the wrong way": (
        JOINT | {"springs": [(one, other, abs(f)) for one, other, f in JOINT["springs"]]}, "joint that is no spring",
    ),
    "a joint of negative stiffness": (
        JOINT | {"springs": [(one, other, -f) for one, other, f in JOINT["springs"]]}, "joint that is no spring",
    ),
    "a mass on a joint": (JOINT | {"masses": [at(HALF, 1, 1)]}, "on what jumps at a joint"),
    "a force by a joint's slope": (
        JOINT | {"forces": [at(ONE, 0, 1, (HALF, 1))]}, "on what jumps at a joint",
    ),
}  # fmt: skip


def read(**changes: Any) -> ColumnForms:
    return ColumnForms(kernel(**deepcopy(changes)), {})


@pytest.mark.parametrize("name", SERVED)
def test_what_is_served_is_read_as_it_is(name: str) -> None:
    with precision(64):
        forms = read(**SERVED[name])
        assert forms.m == [[F(1)]] * 2 and forms.EI == [[F(1)]] * 2
        # ∫ (1 − x) y'² of y' = 0 at x = 0 is no more than ∫ x of the bending
        assert forms.share.overlaps(arb(1) / 2 if name == "a dead load" else arb(1))
        assert forms.stepped and forms.lines == []


@pytest.mark.parametrize("name", REFUSED)
def test_what_is_not_served_is_named(name: str) -> None:
    changes, message = REFUSED[name]
    with precision(64), pytest.raises(NoStrips, match=message):
        read(**changes)


def test_terms_of_one_kind_add_up_and_those_that_cancel_are_none() -> None:
    with precision(64):
        forms = read(mass=[along(0, 0, 1), along(0, 0, 1, 1, on=(1,))], masses=[at(ONE, 0, 1), at(ONE, 0, 2)],
                     springs=[at(ONE, 0, 5), at(ONE, 0, -5), at(ONE, 1, 4)],
                     load=[along(1, 1, -1), along(1, 1, 1, on=(0,))])  # fmt: skip
    assert forms.m == [[1], [2, 1]] and forms.masses == {(1, 0): 3} and forms.springs == {(1, 1): 4}
    assert forms.load == [{}, {(1, 1): [-1]}] and forms.load_points == {((1, 0), (1, 1)): 1}


def single(**changes: Any) -> ColumnForms:
    """Of one segment."""
    parts = {"mass": [along(0, 0, 1, on=(0,))], "bending": [along(2, 2, 1, on=(0,))], "load": []}
    return read(**(parts | {"places": (F(0), ONE), "forces": []} | changes))


TAPERED = {"mass": [along(0, 0, 2, -1, on=(0,))]}


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"ends": ("clamped", "sliding"), **TAPERED}, "slides at an end, and is not uniform"),
        ({"masses": [at(ONE, 0, 1), at(ONE, 1, 1)]}, "has more than one mass"),
        ({"masses": [at(ONE, 1, 1)], **TAPERED}, "has a rotary inertia at a free end, and is not uniform"),
    ],
)
def test_a_variable_section_that_is_not_served_is_named(changes: Any, message: str) -> None:
    with precision(64), pytest.raises(NoStrips, match=message):
        VariableSection(single(**changes)).families()


def test_the_beam_beside_one_with_a_mass_is_held_where_the_mass_is() -> None:
    with precision(64):
        for order, held in ((0, "pinned"), (1, "sliding")):
            families = VariableSection(single(masses=[at(ONE, order, 1)])).families()
            assert families == [("clamped", "free"), ("clamped", held)]
        assert VariableSection(single(masses=[at(ONE, 0, 1)], **TAPERED)).families()[1] == ("clamped", "pinned")
        assert VariableSection(single(ends=("clamped", "sliding"))).families() == [("clamped", "sliding")]


def test_parts_that_are_not_uniform_or_too_many_are_named() -> None:
    with precision(64):
        nodes = [tuple(F(k, n) for k in range(n + 1)) for n in (PARTS, PARTS + 1)]
        every = [
            {"places": places, **{key: [(range(len(places) - 1), *term[1:]) for term in terms] for key, terms in (
                ("mass", [along(0, 0, 1)]), ("bending", [along(2, 2, 1)]), ("load", [])
            )}} for places in nodes
        ]  # fmt: skip
        assert len(SteppedSection(read(**every[0])).rates) == PARTS
        for changes, message in (
            (every[1], f"more than {PARTS} parts"),
            ({"mass": [along(0, 0, 2, -1)]}, "a part that is not uniform"),
            ({"bending": [along(2, 2, 2, -1)]}, "a part that is not uniform"),
            ({"bending": [along(2, 2, 1), along(0, 0, 1, on=(1,))]}, "a foundation or a dead load"),
        ):
            with pytest.raises(NoStrips, match=message):
                SteppedSection(read(**changes))


# ------------------------------------------------------------ over a range


def test_over_a_range_masses_or_springs_alone_change_and_one_way() -> None:
    """Frequencies rise with springs and fall with masses; each value's is between those at the ends only then."""
    with precision(64):
        soft, stiff = (read(springs=[at(HALF, 0, k)], masses=[at(ONE, 0, 1)]) for k in (1, 3))
        for pair in ((soft, stiff), (stiff, soft)):
            whole = over_both(*pair)
            (spring,), (mass,) = whole.springs.values(), whole.masses.values()
            assert spring.contains(1) and spring.contains(3) and mass == 1 and spring.rad() < 1.001
        added = over_both(soft, read(springs=[at(HALF, 0, 1), at(HALF, 1, 2)], masses=[at(ONE, 0, 1)]))
        assert added.springs[HALF, 1].contains(0) and added.springs[HALF, 1].contains(2)
        light = read(springs=[at(HALF, 0, 3)], masses=[at(ONE, 0, F(1, 2))])
        assert over_both(soft, light).masses[ONE, 0].contains(arb("0.75"))
        heavy = read(springs=[at(HALF, 0, 3)], masses=[at(ONE, 0, 2)])
        for other in (heavy, soft):
            with pytest.raises(NoStrips, match="not all frequencies rise, or all fall"):
                over_both(soft, other)
        for changes in ({"mass": [along(0, 0, 2)]}, {"forces": []}, {"ends": ("clamped", "pinned")}):
            with pytest.raises(NoStrips, match="more than masses and springs hang on"):
                over_both(read(), read(**changes))


# ------------------------------------------------------------ damping


def left(dampers: Any = (), vanishing: bool = False, **changes: Any) -> LeftOver:
    it = kernel(**changes, dampers=list(dampers))
    return LeftOver(ColumnForms(it, {}), it, {}, F(1), F(0), vanishing)


TERMS: list[tuple[Any, str]] = [
    ({"damping": [along(2, 2, 1), along(0, 1, 1)]}, "couples motions"),
    ({"damping": [along(2, 2, 1), along(0, 0, -1)]}, "not known to take energy"),
    ({"damping": [along(2, 2, 1), along(3, 3, 1)]}, "couples motions"),
    ({"dampers": [at(HALF, 0, 1, (ONE, 0))]}, "couples motions"),
    ({"dampers": [at(HALF, 0, -1)]}, "not known to take energy"),
    ({"damping": [along(2, 2, 1), along(2, 2, 1, on=(1,))]}, "not the bending stiffness times a number"),
    ({"damping": [along(2, 2, 1), along(1, 1, 1)]}, "a damping of the slope along the beam"),
    ({"dampers": [at(HALF, 0, 1)]}, "where no mass is, and other than in the limit"),
    ({"dampers": [at(HALF, 0, 1)], "damping": [along(0, 0, 1)], "vanishing": True}, "where no mass is, and other"),
    ({"more": {"C": [([], [])]}}, "a damping that is no form of its own"),
]


@pytest.mark.parametrize(("changes", "message"), TERMS)
def test_a_damping_that_is_not_served_is_named(changes: Any, message: str) -> None:
    with precision(64), pytest.raises(NoStrips, match=message):
        left(**changes)


def test_what_is_left_of_a_damping_is_what_bending_and_mass_do_not_say() -> None:
    """C = E + 3 ∫ y v + dampers: of the mass 2 and a mass of 1/4 at the tip, with a spring of 5 there."""
    given = {"mass": [along(0, 0, 2)], "masses": [at(ONE, 0, F(1, 4))], "springs": [at(ONE, 0, 5)]}
    with precision(64):
        R = left([at(ONE, 0, 7)], **given)
        assert R.c_E == 1 and R.c_M.overlaps(arb("1.5")) and R.turning == 0 and R.bare == {}
        assert abs(R.low) < 1e-15 and abs(R.high) < 1e-15  # 3 over 2 all along
        assert R.at[ONE, 0].overlaps((arb(7) - 5) * 4 - R.c_M) and R.size.overlaps(arb("6.5"))
        # a weight that takes part in the energy, undamped: R₁
        weight = left(bending=[along(2, 2, 1), along(1, 1, 1, -1)])
        forms = weight.forms[0]
        assert weight.turning.overlaps(size_along(forms, [{(1, 1): [F(-1), F(1)]}] * 2)) and weight.turning > 0
        # without a mass there, in the limit alone
        bare = left([at(HALF, 1, 7)], vanishing=True, springs=[at(HALF, 1, 5), at(ONE, 0, 1)])
        assert bare.bare == {(HALF, 1): 2, (ONE, 0): -1} and bare.at == {}


def test_over_a_range_what_is_left_of_a_damping_is_of_both_ends() -> None:
    with precision(64):
        one, other = (
            left([at(ONE, 0, f)], masses=[at(ONE, 0, 1)], damping=[along(2, 2, e), along(0, 0, c, d)])
            for e, c, d, f in ((1, 3, 0, 2), (2, 1, 4, 9))
        )
        both = over_range([one, other])
        assert all(both.c_E.contains(of.c_E) and both.c_M.contains(of.c_M) for of in (one, other))
        assert both.low <= other.low and both.high >= other.high and both.at[ONE, 0].contains(other.at[ONE, 0])
        assert over_range([one]) is one and both.forms == [*one.forms, *other.forms]
        with pytest.raises(NoStrips, match="a mass that is nothing at an end of the range"):
            over_range([one, left()])


def test_a_damping_of_mass_alone_is_told_from_others() -> None:
    mass = {"mass": [along(0, 0, 2, 1)], "masses": [at(ONE, 0, 3)]}
    of = [({"damping": [along(0, 0, 4, 2)], "dampers": [at(ONE, 0, 6)]}, True), ({"damping": mass["mass"]}, False),
          ({"damping": [along(0, 0, 4, 2)], "dampers": [at(ONE, 0, 5)]}, False),
          ({"damping": [along(0, 0, -4, -2)], "dampers": [at(ONE, 0, -6)]}, False),
          ({"damping": [along(0, 0, 4, 2)], "dampers": [at(ONE, 1, 6)]}, False),
          ({"damping": mass["mass"], "dampers": mass["masses"], "more": {"C": [([], [])]}}, False)]  # fmt: skip
    for changes, told in of:
        assert of_mass_alone(kernel(**(mass | changes)), {}) == told
