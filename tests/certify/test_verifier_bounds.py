"""The verifier's bounds are the formulas of docs/theorem.md, in floats, and not only above what they bound."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from itertools import combinations_with_replacement, product
from math import asin, exp, hypot, log, pi, sqrt
from types import SimpleNamespace
from typing import Any

import flint
import numpy as np
import pytest
from flint import acb, acb_poly, arb, fmpq_poly

from freebeam_derive.certify import verifier_load_size as load_size
from freebeam_derive.certify import verifier_waves
from freebeam_derive.certify.verifier_claims import Refused
from freebeam_derive.certify.verifier_damping import Damped, DampedOver
from freebeam_derive.certify.verifier_lines import Lines, Norms
from freebeam_derive.certify.verifier_load_size import PARTS, Beside, LoadSize
from freebeam_derive.certify.verifier_sections import Sections
from freebeam_derive.certify.verifier_waves import Apart
from tests.certify.refusals import served

BITS = 128
SAME = 1e-12
"""Of a bound in floats and the verifier's, which is rounded up."""


def edge(holds: Callable[[float], bool], value: float) -> bool:
    """Whether something holds just above a value and does not just below it."""
    return holds(value + 1e-9 * abs(value)) and not holds(value - 1e-9 * abs(value))


# --- Lemma 9 -------------------------------------------------------------------------------------------------------


def left_out(G: float, eta: float, segments: Any, stages: Any, joints: Any) -> float | None:
    """Of waves that go through segments, and joints of a number each. stages: of each segment, of each wave that comes
    in, what of it goes on as waves to either side, and the size of what does not."""
    rest, reached, e = 0.0, 0.0, 1 / G
    for (L, A, H), waves, joint in zip(segments, stages, joints, strict=True):
        far = exp(eta * reached)
        d, o = (
            rest + sum(size for size in sizes) * far for sizes in ([hypot(*w) for w, _ in waves], [v for _, v in waves])
        )
        most, whole = (e * A[k] + e**3 * H[k] for k in (0, 1))
        a = 5 / 8 * e * A[1] + e**3 * H[1]
        g = G - most
        if not (g > 0 and G > eta and 1 - a - most * whole / g > 0):
            return None
        X = (d + most * o / g) / (1 - a - most * whole / g)
        rest = exp(eta * L) * (rest + a * X + most / g * (o + whole * X) + exp(-g * L) * o + most / g * X) * joint
        reached += L
    return rest


def test_what_is_left_out_of_waves_is_what_lemma_9_says() -> None:
    draw = np.random.default_rng(7)
    units = [np.array([complex(v) for v in verifier_waves.UNITS[sign]]) for sign in (1, -1)]
    across = np.linalg.svd(np.conj(units))[2][2:].conj()  # orthonormal, and so to both
    for _ in range(12):
        G, eta = draw.uniform(4, 9), draw.choice([0.0, 0.3])
        segments = [(draw.uniform(0.5, 2), draw.uniform(0, 2, 2), draw.uniform(0, 30, 2)) for _ in "ab"]
        parts = [[(draw.normal(size=2), draw.normal(size=4)) for _ in range(n)] for n in (1, 2)]
        factors = draw.uniform(0.5, 3, 2)
        stages = [[(w, np.linalg.norm(v)) for w, v in waves] for waves in parts]
        them: Any = object.__new__(Apart)
        with flint.ctx.workprec(BITS):
            them.segments = [
                SimpleNamespace(length=arb(L), A=tuple(map(arb, A)), H=tuple(map(arb, H))) for L, A, H in segments
            ]
            them.stages = [
                {(n,): [acb_poly([v]) for v in w @ units + v @ across] for n, (w, v) in enumerate(waves)}
                for waves in parts
            ]
            them.joints = [None, *([[acb_poly([0, f])]] for f in factors)]
            found = them.rest(arb(G), arb(eta))
        # ε = 1/γ with Re γ ≥ G and |Im γ| ≤ η is at most 1/G, and its imaginary part η/G²
        expected = left_out(G, eta, segments, stages, factors * hypot(1 / G, eta / G**2))
        assert found is not None and float(found) == pytest.approx(expected, rel=1e-7)  # radii of balls have 30 bits


@pytest.mark.parametrize("which", ["eta", "g", "share"])
def test_no_bound_is_known_of_waves_where_lemma_9_knows_none(which: str) -> None:
    """Where η reaches G, or e reaches G, or X is not positive."""
    them: Any = object.__new__(Apart)
    L, unit = 1.0, verifier_waves.UNITS[1]

    def known(value: float) -> bool:
        """value: G."""
        A, eta = {"eta": ((0, 0), 3.0), "g": ((9, 0), 0.0), "share": ((2, 3), 0.0)}[which]
        with flint.ctx.workprec(BITS):
            them.segments = [SimpleNamespace(length=arb(L), A=tuple(map(arb, A)), H=(arb(0), arb(0)))]
            them.stages, them.joints = [{(): [acb_poly([v]) for v in unit]}], [None, [[acb_poly([1])] * 6]]
            return them.rest(arb(value), arb(eta)) is not None

    if which == "eta":
        assert edge(known, 3.0) and not known(3.0)
    elif which == "g":  # G = 9/G
        assert edge(known, 3.0) and not known(3.0)
    else:  # 1 = 5/8 · 3/G + (2/G)(3/G)/(G − 2/G)
        at = max(np.roots([1, -15 / 8, -2, 15 / 4 - 6]).real)
        assert edge(known, at)


def test_waves_are_along_the_two_minors_that_turn() -> None:
    """Of v_1 ∧ v_{±i}, 2 v_λ = (1, λ, λ², λ³)."""
    pairs = [(i, j) for i in range(4) for j in range(i + 1, 4)]
    for sign in (1, -1):
        v, w = ([complex(root) ** k / 2 for k in range(4)] for root in (1, 1j * sign))
        unit = [complex(x) for x in verifier_waves.UNITS[sign]]
        assert unit == pytest.approx([v[i] * w[j] - v[j] * w[i] for i, j in pairs])


def test_gaps_are_looked_for_where_they_are_wide_enough() -> None:
    """From G on, that is γ L = phase of the shortest part at least, π/(times L) is a gap that is wider than needed."""
    them: Any = object.__new__(Apart)
    asked: list[tuple[float, float]] = []
    with flint.ctx.workprec(BITS):
        them.lengths, them.whole = [arb(2), arb("0.5")], arb("2.5")
        them._all_apart = lambda G, apart: asked.append((float(G), float(apart))) or len(asked) > 7
        G, gap = them.gap(lambda low, high: arb(40))
    expected = []
    for times, phase in product(verifier_waves.TIMES, verifier_waves.SHORTEST):
        apart = pi / (float(times) * 2.5)
        start = max(float(phase) / 0.5, 40 * 1.001 / (2 * apart))
        if apart * (2 * start + apart) > 40:
            expected.append((start, apart))
    assert asked == [pytest.approx(pair) for pair in sorted(expected)[:8]]
    assert float(gap) == pytest.approx(asked[-1][1] * (2 * asked[-1][0] + asked[-1][1]), rel=SAME)
    assert float(G) == asked[-1][0]
    with flint.ctx.workprec(BITS):  # what rises with the upper frequency is asked for of it, and of G and the next
        them._all_apart = lambda G, apart: True
        G, gap = them.gap(lambda low, high: (high.sqrt() - low.sqrt()) * 12 + high.sqrt() / 2)
        apart = float((gap + G**2).sqrt() - G)
        assert float(gap) > 12 * apart + (float(G) + apart) / 2
        with pytest.raises(Refused):
            them.gap(lambda low, high: high)


def test_all_of_the_high_frequencies_are_looked_at() -> None:
    """In 1/γ from 0 to 1/G, in three halvings at most; a cell holds what is up to a gap further on."""
    for halvings, right in ((0, True), (1, True), (3, True), (4, False)):
        them: Any = object.__new__(Apart)
        seen: list[tuple[float, float]] = []

        def apart(epsilon: arb, G: arb, gap: arb, halvings: int = halvings, seen: Any = seen) -> bool:
            low, high = (float(epsilon.mid()) + side * float(epsilon.rad()) for side in (-1, 1))
            assert float(G) == pytest.approx(1 / high) and float(gap) == 3
            begin = low / (1 - 3 * low)  # γ + 3 is beyond
            if high - begin > 0.25 / 2**halvings * 1.001:
                return False
            seen.append((begin, high))
            return True

        them._cells_apart = apart
        with flint.ctx.workprec(BITS):
            assert them._all_apart(arb(4), arb(3)) is right
        if right:
            edges = np.linspace(0, 0.25, 2**halvings + 1)
            assert np.array(sorted(seen)) == pytest.approx(np.array([edges[:-1], edges[1:]]).T, abs=1e-6)


@pytest.mark.parametrize("L", [0.5, 2.0])
def test_a_wave_and_its_slope_are_apart_up_to_a_quarter_of_its_length(L: float) -> None:
    """cos θ and L sin θ, θ = γ L, in balls of r and of w over η = 1/L: π/2 less asin r and asin w."""
    for r, w in ((0.0, 0.0), (0.1, 0.2)):
        them: Any = object.__new__(Apart)

        def rest(G: arb, eta: arb, r: float = r, w: float = w) -> arb:
            assert (float(G), float(eta)) in ((5, 0), (5 - 1 / L, 1 / L))
            return arb(w if eta > 0 else r)

        them.rest, them.same, them.whole, them.lengths = rest, [0], arb(L), [arb(L)]
        them.waves = lambda epsilon: [((1,), acb(1), acb(0, L))]
        far = (pi / 2 - asin(r) - asin(w)) / L
        with flint.ctx.workprec(BITS):
            assert them._cells_apart(arb("0.1"), arb(5), arb(far * 0.999))
            assert not them._cells_apart(arb("0.1"), arb(5), arb(far * 1.001))
            them.rest = lambda G, eta: None
            assert not them._cells_apart(arb("0.1"), arb(5), arb(far / 2))


def test_parts_are_alike_that_are_uniform_and_of_one_length_and_kind() -> None:
    """The second is longer, the third and fourth are the first again, the fifth and sixth are not uniform."""
    breaks = tuple(Fraction(k, 8) for k in (0, 1, 3, 4, 5, 6, 7, 8))
    two, three, line = fmpq_poly([2]), fmpq_poly([3]), fmpq_poly([2, 1])
    of = column(breaks=breaks, m=[two] * 6 + [three], EI=[three] * 4 + [line, line, three], elastic=[{}] * 7)
    assert [verifier_waves._first_alike(of, n) for n in range(7)] == [0, 1, 0, 0, 4, 5, 6]
    of = column(
        breaks=breaks, m=[two] * 7, EI=[three] * 7, elastic=[{}, {}, {1: two}, {0: two}, {1: two}, {}, {0: two}]
    )
    assert [verifier_waves._first_alike(of, n) for n in range(7)] == [0, 1, 2, 3, 2, 0, 3]


def column(**given: Any) -> Sections:
    """Of two parts, with a foundation and an axial force on the second."""
    fixed: Any = {
        "ends": ("clamped", "free"), "breaks": (Fraction(0), Fraction(2, 5), Fraction(1)),
        "EI": [fmpq_poly([3, -1]), fmpq_poly([2, 1])], "m": [fmpq_poly([2, 1]), fmpq_poly([3, -2])],
        "elastic": [{}, {0: fmpq_poly([5, 2]), 1: fmpq_poly([1, 1])}], "load": [{}, {}], "masses": {}, "springs": {},
        "forces": {},
    }  # fmt: skip
    return Sections(**fixed | given)


def test_a_segment_is_turned_at_its_own_ends() -> None:
    """y = ρ w and ρ² = z'/m."""
    with flint.ctx.workprec(BITS):
        of = column()
        for n in (0, 1):
            for x, rows in zip(of.breaks[n : n + 2], verifier_waves.Segment(of, n).ends, strict=True):
                m, EI = (
                    float(np.polyval([float(c) for c in reversed(f[n].coeffs())], float(x))) for f in (of.m, of.EI)
                )
                assert float(rows[0][0]) == pytest.approx((m / EI) ** 0.125 / sqrt(m), rel=SAME)


@pytest.mark.parametrize("place", [(1, 0), (1, 1), (2, 0), (2, 1)])
@pytest.mark.parametrize("turns", [False, True])
def test_a_motion_beside_a_mass_has_the_mass_and_the_energy_that_are_said(place: tuple[int, int], turns: bool) -> None:
    """A cubic that is 1 with the derivative of the place, and nothing a length on: of a displacement at an end that may
    turn freely, with no moment there."""
    (node, order), spring = place, Fraction(7)
    of = column(springs={place: spring}, masses={place: Fraction(1)} | ({} if turns else {(2, 1): Fraction(1)}))
    it: Any = object.__new__(Damped)
    object.__setattr__(it, "column", of)
    free = turns and place == (2, 0)
    cubic = np.polynomial.Polynomial({0: [1, -1.5, 0, 0.5] if free else [1, 0, -3, 2], 1: [0, 1, -2, 1]}[order])
    t, weights = np.polynomial.legendre.leggauss(12)
    t, weights = (t + 1) / 2, weights / 2
    with flint.ctx.workprec(BITS):
        found = it._bumps(place)
    for part, (weight, energy) in zip(PARTS, found, strict=True):
        length = float(part) * (0.4 if node == 1 else 0.6)
        parts = [0.0, float(spring)]
        for n, sign in ((node - 1, -1), (node, 1)):
            if n > 1:
                continue
            x = float(of.breaks[node]) + sign * length * t
            factors = [(0, 0, of.m[n]), (1, 2, of.EI[n]), *((1, p, f) for p, f in of.elastic[n].items())]
            for which, p, f in factors:
                v = length ** (order - p) * cubic.deriv(p)(t) if p else length**order * cubic(t)
                at = np.polyval([float(c) for c in reversed(f.coeffs())], x)
                parts[which] += length * float(weights @ (at * v**2))
        assert [float(weight), float(energy)] == pytest.approx(parts, rel=1e-10)


def test_bounds_serve_from_where_they_are_looked_for() -> None:
    """Of a gap three times as wide as the load needs, from four times that on, and twice as far each time."""
    for reached in (0, 3, 15, 16):
        asked: list[list[float]] = []

        def check(omega: arb, squares: Any, *given: arb, asked: Any = asked, reached: int = reached) -> None:
            asked.append([*map(float, (omega, *given))])
            if squares or len(asked) <= reached:
                raise Refused("not yet")

        it: Any = SimpleNamespace(_check_from=check)
        if reached == 16:
            with pytest.raises(Refused, match="takes too much"):
                Damped.served_from(it, arb(5))
        else:
            assert float(Damped.served_from(it, arb(5))) == 20 * 2**reached
            assert asked == [[20 * 2**k, 15, 5, 5] for k in range(reached + 1)]


def test_between_two_dampings_numbers_are_between_theirs() -> None:
    each = [
        SimpleNamespace(
            of_E=arb(a), of_M=arb(b), of_mass=c, turning=arb(a), density=(arb(b), arb(a)), at_masses=[arb(a)]
        )
        for a, b, c in ((1, 5, True), (3, 2, False))
    ]
    it: Any = object.__new__(DampedOver)
    for both in (each, each[::-1]):
        it.__dict__.clear()
        object.__setattr__(it, "both", tuple(both))
        hull = {"of_E": (1, 3), "of_M": (2, 5)}
        for name, (low, high) in hull.items():
            found = getattr(it, name)
            assert (float(found.mid()), float(found.rad())) == pytest.approx(((low + high) / 2, (high - low) / 2))
        assert float(it.turning) == pytest.approx(3) and [*map(float, it.density)] == [2, 3] and not it.of_mass
        (at,) = it.at_masses
        assert (float(at.mid()), float(at.rad())) == pytest.approx((2, 1))
    it.__dict__.clear()
    object.__setattr__(it, "both", (each[0], each[0]))
    assert it.of_mass


# --- Lemma 12 ------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("order", [0, 1])
def test_a_value_beside_a_place_is_the_least_of_its_bounds(order: int) -> None:
    """(b u h² + m v) h^(−1/2 − i), with the roots u, v of energy and mass, over the lengths that are tried."""
    for bend, move, energy, mass in product((0.5, 40.0), (0.3, 7.0), (1.0, 90.0), (0.02, 1.0)):
        lengths = [0.7 * float(part) for part in PARTS]
        least = min((bend * energy * h**2 + move * mass) * h ** (-0.5 - order) for h in lengths)
        with flint.ctx.workprec(BITS):
            found = Beside(order, arb(bend), arb(move), arb("0.7")).most(arb(energy), arb(mass))
        assert float(found) == pytest.approx(least, rel=SAME)


def test_a_gap_is_as_wide_as_the_constant_and_all_places_ask_for() -> None:
    """C and for each place what v has there times the less of what y has, with the mass 1/ω², and what energy lets."""
    with flint.ctx.workprec(BITS):
        v, y, other = (Beside(0, arb(b), arb(m), arb(1)) for b, m in ((2, 3), (1, 5), (4, 1)))
        low, high = arb(20), arb(30)
        felt = other.most(arb(1), 1 / low) + y.most(arb(1), 1 / low)
        for still in (felt / 2, felt * 2):
            places = [([v], [[other], [y]], still), ([y], [[v]], arb(10**6))]
            found = LoadSize(arb("0.25"), [places]).at(low, high)
            assert found == LoadSize(arb("0.25"), [places[:1], places, places[1:]]).at(
                low, high
            )  # over a range the most
            expected = 0.25 + float(v.most(high, arb(1)) * min(still, felt, key=float))
            expected += float(y.most(high, arb(1)) * v.most(arb(1), 1 / low))
            assert float(found) == pytest.approx(expected, rel=SAME)


@pytest.mark.parametrize("order", [0, 1])
def test_a_value_at_an_end_is_an_integral_of_its_cubic(order: int) -> None:
    """±∫ y'' g − y g'': of g and g' all vanish at both ends but g' (of y), or g (of y'), at 0, which is 1."""
    g = np.polynomial.Polynomial(load_size.KERNELS[order])
    assert [g(0), g.deriv()(0), g(1), g.deriv()(1)] == [order, 1 - order, 0, 0]
    y = np.polynomial.Polynomial([2.0, 3, -1, 5, 7])
    whole = (y.deriv(2) * g - y * g.deriv(2)).integ()
    assert abs(whole(1) - whole(0)) == pytest.approx(abs(y.deriv(order)(0) if order else y(0)))


def test_a_value_is_bounded_from_either_side_of_a_place() -> None:
    """c² ∫ g²/EI and c² ∫ g''²/m of each part, over lengths up to the shorter; of what does not jump also from one."""
    with flint.ctx.workprec(BITS):
        of = column(EI=[fmpq_poly([3]), fmpq_poly([5])], m=[fmpq_poly([2]), fmpq_poly([7])])
        for order in (0, 1):
            g = np.polynomial.Polynomial(load_size.KERNELS[order])
            squares = [float((f * f).integ()(1)) for f in (g, g.deriv(2))]

            def bounds(each: dict[int, float], order: int = order, squares: Any = squares) -> Any:
                bend = sum(c**2 * squares[0] / (3, 5)[n] for n, c in each.items())
                move = sum(c**2 * squares[1] / (2, 7)[n] for n, c in each.items())
                return order, *(
                    pytest.approx(v, rel=1e-9) for v in (sqrt(bend), sqrt(move), min((0.4, 0.6)[n] for n in each))
                )

            found = {
                "right": (load_size.value(of, (1, order), {1: Fraction(3)}), [bounds({1: 3})]),
                "left": (load_size.value(of, (1, order), {-1: Fraction(3)}), [bounds({0: 3})]),
                "jump": (load_size.value(of, (1, order), {1: Fraction(3), -1: Fraction(-2)}), [bounds({0: 2, 1: 3})]),
                "both": (load_size.value(of, (1, order), {0: Fraction(3)}),
                         [*map(bounds, ({0: 3}, {1: 3}, {0: 1.5, 1: 1.5}))]),
                "tip": (load_size.value(of, (2, order), {0: Fraction(3)}), [bounds({1: 3})]),
            }  # fmt: skip
            for listed, expected in found.values():
                assert [(b.order, float(b.bend), float(b.move), float(b.length)) for b in listed] == expected


def test_what_energy_lets_at_a_place_is_what_lemma_12_says() -> None:
    """κ/√EI and 1/√k for each joint; of a jump itself 1/√k alone."""
    with flint.ctx.workprec(BITS):
        of = column(joints={(1, 1): Fraction(4)}, elastic=[{}, {}])
        each = 1 / sqrt(2.4), 0.5
        assert float(load_size._by_energy(of, arb(3))) == pytest.approx(3 * each[0] + each[1], rel=1e-9)
        for table, expected in (
            ({(2, 0, 0): 3}, 3 * (2 / 3 * each[0] + each[1])), ({(2, 1, 0): -3}, 3 * (each[0] + each[1])),
            ({(1, 1, 1): 2, (1, 1, -1): -2}, 2 * 0.5), ({(1, 1, -1): -2}, 2 * (each[0] + each[1])),
            ({(1, 1, 1): 2, (1, 1, -1): 1}, 2 * 0.5 + 3 * (each[0] + each[1])),
        ):  # fmt: skip
            given = {key: Fraction(f) for key, f in table.items()}
            assert float(load_size._still(of, given)) == pytest.approx(expected, rel=1e-9)


def test_rows_of_a_load_are_one_where_both_sides_of_a_joint_are_loaded_by_opposite_forces() -> None:
    one, f = {(2, 0, 0): Fraction(3)}, Fraction(1)
    both = load_size._rows({(1, 1, 1): one, (1, 1, -1): {(2, 0, 0): Fraction(-3)}})
    assert both == [({(1, 1, 1): f, (1, 1, -1): -f}, one)]
    apart = {(1, 1, 1): one, (1, 1, -1): {(2, 0, 0): Fraction(-2)}, (2, 0, 0): {(1, 0, 0): Fraction(0)}}
    assert load_size._rows(apart) == [({key: f}, apart[key]) for key in ((1, 1, 1), (1, 1, -1))]


@pytest.mark.parametrize("turned", [False, True])
def test_a_load_along_the_beam_is_as_large_as_its_parts(turned: bool) -> None:
    """∫ f y' v' + h y' v of f = a + b x is −∫ (f y'' + (b − h) y') v: √max f²/(m EI) and κ/√EI √max (b − h)²/m, and so
    with y and v exchanged. What acts on what is held, or by it, is left out."""
    a, b, h = 3, 2, 7
    given = {(1, 1): fmpq_poly([a, b]), (1, 0) if turned else (0, 1): fmpq_poly([h])}
    forces = {((2, 0), (0, 1)): Fraction(9), ((0, 0), (1, 0)): Fraction(9)}
    with flint.ctx.workprec(BITS):
        of = column(
            ends=("clamped", "pinned"), EI=[fmpq_poly([3])] * 2, m=[fmpq_poly([2])] * 2, elastic=[{}, {}],
            load=[dict(given), dict(given)], forces=forces,
        )  # fmt: skip
        found = load_size.size(of, turned)
    slopes = abs(b - h) * 0.7072 / sqrt(3 * 2)
    assert not found.places and float(found.constant) == pytest.approx((a + b) / sqrt(6) + slopes, rel=1e-6)


def test_of_sizes_of_a_load_the_one_without_places_is_taken(monkeypatch: pytest.MonkeyPatch) -> None:
    """With the derivatives off either factor; over a range that of each end, and none with a place."""
    none, place, two = ([], [[1]], [[1, 2]])

    def found(*columns: Any, forces: Any = None) -> Any:
        """columns: of each, the size and the places with the derivatives off one factor, and off the other."""

        def size(of: Any, turned: bool) -> LoadSize:
            if of.sizes[turned] is None:
                raise Refused(f"turned {turned}")
            return LoadSize(arb(of.sizes[turned][0]), of.sizes[turned][1])

        monkeypatch.setattr(load_size, "size", size)
        given = [SimpleNamespace(sizes=of, forces=forces and forces[n]) for n, of in enumerate(columns)]
        it = load_size.load_size(given)  # type: ignore[arg-type]
        return float(it.constant), it.places

    assert found(((3, none), (2, none))) == (3, none)
    assert found(((3, place), (2, none))) == (2, none)
    assert found(((3, two), (2, place))) == (2, place) and found(((3, place), (2, two))) == (3, place)
    assert found((None, (2, place))) == (2, place) and found(((2, place), None)) == (2, place)
    assert found(((3, none), (2, none)), ((5, none), (1, none))) == (5, none)
    assert found(((3, place), (2, none)), ((5, none), (1, none))) == (2, none)
    assert found((None, (2, none)), ((5, none), (4, none))) == (4, none)
    assert found(((3, place), None), ((5, two), None)) == (5, place + two)  # of forces that are the same
    with pytest.raises(Refused, match="turned False"):
        found((None, None))
    with pytest.raises(Refused, match="over a range of a force"):
        found(((1, place), None), ((1, place), None), forces=(1, 2))


# --- Lemmas 11 and 13 ----------------------------------------------------------------------------------------------


class Stand:
    """What of a damping the lemmas need, as numbers."""

    vanishing = False

    def __init__(self, **given: Any) -> None:
        self.of_M = self.of_E = self.turning = self.size = arb(0)
        self.takes = self.leaves = 0.0
        for name, value in given.items():
            setattr(self, name, value if name in ("takes", "leaves", "vanishing") else arb(value))
        self.asked: list[Any] = []

    def taken(self, omega: arb, blur: arb, r: arb, squares: Any) -> arb:
        self.asked.append((float(omega), float(blur), float(r), squares))
        return arb(self.takes)

    def least(self, omega: arb, blur: arb) -> arb:
        return arb(self.leaves)


def sigma(omega: float, gap: float, X: float) -> float:
    r = gap / omega
    return X * max((1 + r) / (gap * (2 + r) - X), 1 / (gap * (2 - r) - X))


def damped(it: Stand, omega: float, gap: float, X: float, loaded: float) -> bool:
    them: Any = it
    with flint.ctx.workprec(BITS):
        return served(lambda: Damped._check_from(them, arb(omega), {}, arb(gap), arb(X), arb(loaded)))


@pytest.mark.parametrize("seed", range(12))
def test_a_mode_is_damped_where_lemma_13_says_and_no_further(seed: int) -> None:
    draw = np.random.default_rng(seed)
    omega, c_E = draw.uniform(40, 90), draw.uniform(0.01, 0.3)
    gap, loaded = omega * draw.uniform(0.1, 0.7), draw.uniform(0.5, 1.5)
    X, turning, takes = loaded + draw.uniform(0, 1), draw.uniform(0, 0.2), draw.uniform(0, 0.2)
    s, given = sigma(omega, gap, X), (omega, gap, X, loaded)
    k, blur = 1 / (1 - 2 * s**2), s / sqrt(1 - s**2)
    h = c_E * (omega - X - loaded * k) - turning * k - takes
    asked = Stand(of_E=c_E, of_M=1e6, turning=turning, takes=takes)
    damped(asked, *given)
    assert asked.asked == [(pytest.approx(omega), pytest.approx(blur), pytest.approx(gap / omega), {})]
    for leaves in (-2.0, 0.0, 3.0):
        beside = {"of_E": c_E, "turning": turning, "takes": takes, "leaves": leaves}
        # h is not below 0, whatever external damping there is
        assert damped(Stand(**beside, of_M=1e6), *given) is (h > 0)
        if h > 0:
            beside["of_E"] = c_E
            needed = -omega * h - min(leaves, 0)
            assert edge(lambda c, beside=beside: damped(Stand(**beside, of_M=c), *given), needed)  # type: ignore[misc]
    zero = (turning * k + takes) / (omega - X - loaded * k)
    assert edge(lambda c: damped(Stand(of_E=c, turning=turning, takes=takes, of_M=1e6), *given), zero)


@pytest.mark.parametrize(("omega", "gap"), [(50.0, 10.0), (50.0, 40.0)])
def test_a_mode_is_told_from_others_up_to_where_two_sigma_squared_is_one(omega: float, gap: float) -> None:
    """Lemma 11, by X: at gaps of which the upper is nearer, and the lower."""
    low, high = 0.0, 2 * gap
    for _ in range(80):
        X = (low + high) / 2
        low, high = (X, high) if 2 * sigma(omega, gap, X) ** 2 < 1 else (low, X)
    assert edge(lambda x: not damped(Stand(of_M=1e12), omega, gap, x, 0), high)


@pytest.mark.parametrize("vanishing", [False, True])
@pytest.mark.parametrize("modes", [(), ((40.0, {(0, 0): arb(1)}), (60.0, {(1, 0): arb(2)}))])
def test_the_gaps_are_twice_as_wide_as_what_load_and_damping_do(vanishing: bool, modes: Any) -> None:
    """X = P C + C_R/c_E + δ √(1 + g/ω_m), in the limit of vanishing damping P C alone; of all modes that are known and
    of all from a gap beyond the last on."""
    more = 0.0 if vanishing else 0.6 / 0.2 + 0.5 * sqrt(1 + 12 / 30)
    seen: list[Any] = []

    def wide(loaded: float) -> bool:
        it: Any = Stand(of_E="0.2", turning="0.6", size="0.5", vanishing=vanishing)
        it._check_from = lambda *given: seen.append(given)
        with flint.ctx.workprec(BITS):
            known = [(arb(omega), of) for omega, of in modes]
            return served(lambda: Damped.check(it, arb(loaded), arb(12), arb(30), known))

    assert edge(lambda less: wide(-less), more - 6)
    seen.clear()
    assert wide(2.0)
    beyond = (modes[-1][0] if modes else 30) + 12
    assert [(float(omega), of) for omega, of, *_ in seen] == [*modes, (beyond, {})]
    for _, _, *given in seen:
        assert [*map(float, given)] == pytest.approx([12, 2 + more, 2], rel=SAME)


def test_a_slope_that_is_damped_needs_internal_damping() -> None:
    def right(**given: Any) -> bool:
        it: Any = Stand(size=0, **given)
        it._check_from = lambda *_: None
        return served(lambda: Damped.check(it, arb(1), arb(12), arb(30)))

    assert right(turning=1, of_E=1) and right(turning=0, of_E=0) and not right(turning=1, of_E=0)
    assert right(turning=1, of_E=0, vanishing=True)
    with flint.ctx.workprec(BITS):  # without a slope nothing of it is added
        it: Any = Stand(size=0)
        it._check_from = lambda omega, squares, gap, X, loaded: seen.append(float(X))
        seen: list[float] = []
        Damped.check(it, arb(1), arb(12), arb(30))
    assert seen == [1]


@pytest.mark.parametrize("seed", range(6))
def test_what_a_damper_without_a_mass_takes_is_what_lemma_13_says(seed: int) -> None:
    """|f| ((2 + r) b/(1 − b) most + what the mode has, where f < 0) over ω, of each."""
    draw = np.random.default_rng(seed)
    omega, blur, r = draw.uniform(5, 9), draw.uniform(0.1, 0.6), draw.uniform(0.1, 0.9)
    f, reach, own = draw.uniform(-2, 2, 2), draw.uniform(0.5, 2, 2), {(0, 0): draw.uniform(0, 5)}
    bare = {(n, 0): Fraction(x) for n, x in enumerate(f)}
    it: Any = SimpleNamespace(bare=bare, reach=lambda key, _: arb(reach[key[0]]))
    total = 0.0
    for n in (0, 1):
        most = reach[n] ** 2
        total += abs(f[n]) * most * (2 + r) * blur / (1 - blur)
        total += abs(f[n]) * min(most, own.get((n, 0), most)) if f[n] < 0 else 0
    with flint.ctx.workprec(BITS):
        found = Damped.taken(it, *map(arb, (omega, blur, r)), {key: arb(v) for key, v in own.items()})
    assert float(found) == pytest.approx(total / omega, rel=SAME)


def test_what_is_left_of_the_damping_is_what_lemma_11_says() -> None:
    """low + S min(0, r_e − low), less (2 √(a² + S p²) b + (δ + a + S p) b²)/(1 − b²)."""
    for (low, high), masses, share, blur in product(
        ((-1.0, 2.0), (0.5, 0.7)), ((), (-3.0, 4.0)), (0.2, 0.9), (0.1, 0.5)
    ):
        it: Any = SimpleNamespace(
            share=lambda _, share=share: arb(share),
            density=(arb(low), arb(high)),
            at_masses=[*map(arb, masses)],
            size=arb(5),
        )
        along, points = max(abs(low), abs(high)), max([0.0, *map(abs, masses)])
        value = low + share * min([0.0, *(m - low for m in masses)])
        missed = 2 * sqrt(along**2 + share * points**2) * blur + (5 + along + share * points) * blur**2
        with flint.ctx.workprec(BITS):
            found = Damped.least(it, arb(3), arb(blur))
        assert float(found) == pytest.approx(value - missed / (1 - blur**2), rel=SAME)


# --- Lemmas 4 and 5 ------------------------------------------------------------------------------------------------


def lines_of(n: int = 6) -> Any:
    with flint.ctx.workprec(BITS):
        return Lines(["clamped", "free"], n)


def test_the_bound_of_all_lines_is_what_lemma_5_says() -> None:
    """Of a form a ∫ y'' v + b ∫ y' v + c ∫ y v and end terms, in either factor's part alone."""
    lines = lines_of()
    start, away, steep, longest = (float(v) for v in (lines.start, lines.away, lines.steepest, lines.longest))
    inner = [0.7, 0.4, 1.3]
    end = [((1, p, 1, q), f) for p, q, f in ((0, 0, 0.3), (1, 0, 0.2), (0, 1, 0.9), (1, 1, 0.6))]
    for k in (3, 7):
        G, t, T = start + pi * (k + 0.5), pi / 2 - away, pi / 2 + away
        L, Q = 1 / t + log(G / t) / pi, 1 / t**2 + 1 / (pi * t)
        W, d = 1 / (2 * G * t) + log(1 + 2 * G / t) / (2 * pi * G), 4 * t * (G - T) ** 3
        single = L / G**3 + W / (2 * G**2), L / (4 * G) + W
        double = L / (G**3 * d) + Q / (13 * G**6), L / (4 * G * d) + Q / (13 * G**4), G * L / (4 * d) + Q / (13 * G**2)
        both = []
        for of_inner, of_end in ((inner, []), ([0, 0, 0], end), (inner, end)):
            part = sum(f * size * sqrt(x) for f, size, x in zip(of_inner, (1, longest, 1), double, strict=True))
            part += sum(f * (2, steep)[p] * (2, steep)[q] * sqrt(single[p] * single[q]) for (_, p, _, q), f in of_end)
            both.append(part)
            norms: Any = object.__new__(Norms)
            norms.lines = lines
            norms._sides = [([*map(arb, of_inner)], [(key, arb(f)) for key, f in of_end])]
            with flint.ctx.workprec(BITS):
                assert float(norms.on_all_from(k)) == pytest.approx(part, rel=SAME)
        norms._sides = [([*map(arb, inner)], []), ([arb(0)] * 3, [(key, arb(f)) for key, f in end])]
        with flint.ctx.workprec(BITS):
            assert float(norms.on_all_from(k)) == pytest.approx(hypot(both[0], both[1]), rel=SAME)


def test_all_lines_are_bounded_from_three_times_half_a_turn_on() -> None:
    """Γ > 3 (π/2 + δ), above e t from which on the bounds fall."""
    for away in (0.0, 0.5, 1.2):

        def known(G: float, away: float = away) -> bool:
            norms: Any = object.__new__(Norms)
            with flint.ctx.workprec(BITS):
                norms.lines = SimpleNamespace(
                    start=arb(G) - arb.pi() * arb("2.5"), away=arb(away), steepest=arb(2), longest=arb(1)
                )
                norms._sides = [([arb(1)] * 3, [])]
                return served(lambda: norms.on_all_from(2))

        assert edge(known, 3 * (pi / 2 + away))


def test_the_bound_of_a_line_is_what_lemma_4_says() -> None:
    """Entries between the first modes over D_i D_j, what is beyond for each, and what is beyond in both."""
    lines = lines_of()
    n, gamma = lines.n, [float(g) for g in lines.gamma]
    slope, stretch = float(lines.slope), float(lines.stretch)
    inner = [0.7, 0.4, 1.3]
    end = [((1, p, 1, q), f) for p, q, f in ((0, 0, 0.3), (1, 0, 0.2), (0, 1, 0.9), (1, 1, 0.6))]
    for k, (of_inner, of_end) in product((0, 2, 4), ((inner, []), ([0, 0, 0], end), (inner, end))):
        R = float(lines.line(k))
        D, share = [abs(g**4 - R) for g in gamma], 1 - R / gamma[-1] ** 4
        g = float(lines.start) + pi * n - float(lines.beyond)
        beyond = {s: 1 / ((s - 1) * pi * g ** (s - 1)) for s in (2, 4, 6, 8)}
        far = sqrt(4 * beyond[4] / share), slope * sqrt(beyond[2] / share)
        squares = np.random.default_rng(k).uniform(0, 9, (n, n))
        total = float(np.sum(squares / np.outer(D, D)))
        for i in range(n):
            size = of_inner[0] + of_inner[1] * float(lines.norms[i]) + of_inner[2] * gamma[i] ** 2
            tail = size / sqrt(share * gamma[-1] ** 4)
            tail += sum(f * abs(float(lines.at[a, p][i])) * far[q] for (a, p, _, q), f in of_end)
            total += tail**2 / D[i]
        both = of_inner[0] * sqrt(beyond[8]) + of_inner[1] * stretch * sqrt(beyond[6]) + of_inner[2] * sqrt(beyond[4])
        total += (both / share + sum(f * far[p] * far[q] for (_, p, _, q), f in of_end)) ** 2
        norms: Any = object.__new__(Norms)
        norms.lines, norms._squares = lines, flint.arb_mat(squares.tolist())
        norms._sides = [([*map(arb, of_inner)], [(key, arb(f)) for key, f in of_end])]
        with flint.ctx.workprec(BITS):
            assert float(norms.on(k)) == pytest.approx(sqrt(total), rel=SAME)


KINDS = [*combinations_with_replacement(("free", "clamped", "pinned", "sliding"), 2)]


@pytest.mark.parametrize("ends", KINDS)
def test_what_is_known_of_modes_is_what_lemmas_1_and_2_say(ends: tuple[str, str]) -> None:
    """With ε = exp(−γ_n): A² = 2/(1 − 4ε/(1 − ε)²); free ends at which |φ'| ≤ 2 γ √(A² − 1), and ‖φ'‖² ≤ γ² + what
    there are of |φφ'|; |γ − γ⁰| ≤ π 24 ε/(√8 A), ε taken where it is known to be smaller."""
    with flint.ctx.workprec(96):
        n, lines = 3, Lines([*ends], 3)
        g, last, entries = [*map(float, lines.gamma)], float(lines.gamma[-1]), lines.integrals(0, 0, 0).tolist()
        assert all(abs(float(entries[i][j]) - (i == j)) < 1e-9 for i in range(n) for j in range(n))
        e = exp(-last)
        slope = 2 * sqrt(2 / (1 - 4 * e / (1 - e) ** 2) - 1)
        assert float(lines.slope) == pytest.approx(slope, rel=1e-9)
        assert float(lines.stretch) == pytest.approx(sqrt(1 + 2 * slope * ends.count("free") / last), rel=1e-9)
        at = {key: [*map(float, of)] for key, of in lines.at.items()}
        assert all(
            abs(v) == pytest.approx(2 * (ends[e] == "free")) for e in (0, 1) for v in at[e, 0] if ends[e][0] in "fc"
        )
        norms = [sqrt(g[i] ** 2 + at[1, 0][i] * at[1, 1][i] - at[0, 0][i] * at[0, 1][i]) for i in range(n)]
        assert all(x**2 >= float(lines.integrals(0, 1, 1)[i, i]) for i, x in enumerate(norms))
        assert [*map(float, lines.norms)] == pytest.approx(norms, rel=1e-9)
        steep = max(abs(at[e, 1][i]) / g[i] for e in (0, 1) for i in range(n))
        assert float(lines.steepest) == pytest.approx(max(slope, steep), rel=1e-9)
        longest = max(float(lines.stretch), *(norm / k for norm, k in zip(norms, g, strict=True)))
        assert float(lines.longest) == pytest.approx(longest, rel=1e-9)
        # γ − kπ goes to start, a quarter of π times a number
        start, quarters = float(lines.start), range(8)
        right = [q for q in quarters if abs((start - q * pi / 4) / pi - round((start - q * pi / 4) / pi)) < 1e-9]
        assert abs(last - n * pi - start) < 0.02 and len(right) == 2
        for q in quarters:  # a determinant that is not 0 there, or as large as it may be a quarter on, is refused
            assert served(lambda q=q: lines._amplitude(q)) is (q in right)  # type: ignore[misc]
        A = float(lines._amplitude(right[0]))
        beyond = 24 * exp(1 - last) * pi / (sqrt(8) * A)
        assert float(lines.beyond) == pytest.approx(beyond, rel=1e-9)
        away = max(beyond, *(abs(k - start - pi * i) for i, k in enumerate(g, 1)))
        assert float(lines.away) == pytest.approx(away, rel=1e-9)
        assert float(lines.line(0)) == 0
        assert float(lines.line(3)) == pytest.approx((start + 3.5 * pi) ** 4, rel=SAME)


def test_modes_are_known_from_the_third_on_where_lemma_1_says() -> None:
    """72 ε < A/√2, with A = 2 of a cantilever and ε = exp(1 − γ): 1.8 > 1.4 of the second root, 0.08 of the third."""
    with flint.ctx.workprec(96):
        assert [served(lambda n=n: Lines(["clamped", "free"], n)) for n in (1, 2, 3)] == [False, False, True]  # type: ignore[misc]
