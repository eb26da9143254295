"""Bounds of docs/theorem.md are the numbers that its formulas give, evaluated again in floats from the same data: not
above, which would be false, and not below, where a factor or a power that is another would not be seen."""

from __future__ import annotations

import math
from collections import Counter
from itertools import product
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from flint import arb
from numpy.polynomial.legendre import leggauss

from freebeam_derive.certify import variable_section
from freebeam_derive.certify.balls import precision
from freebeam_derive.certify.comparison_form import ORDERS, Modes, _settled, bounds, characteristic
from freebeam_derive.certify.load_size import CUBICS, LoadSize, Value, load_size
from freebeam_derive.certify.strips import Form, Strips
from tests.certify.test_column_forms import HALF, ONE, F, along, at, read

PI = math.pi
ENDS = [(a, b) for a in ORDERS for b in ORDERS]


def near(value: float) -> Any:
    return pytest.approx(value, rel=1e-9, abs=1e-30)


def drawn(seed: int) -> Any:
    return np.random.default_rng(seed)


# --- Lemmas 1 to 5 -------------------------------------------------------------------------------------------


@pytest.mark.parametrize("ends", ENDS, ids=["-".join(e) for e in ENDS])
def test_bounds_of_all_modes_are_those_of_lemmas_1_and_2(ends: tuple[str, str]) -> None:
    with precision(128):
        f, modes, g = characteristic(ends), Modes(ends, 6), 5.25
        e = math.exp(-g)
        A = math.sqrt(2 / (1 - 4 * e / (1 - e) ** 2))
        slope = 2 * math.sqrt(A * A - 1)
        found = bounds(ends, arb(g))
        assert float(found.end[0]) == 2 and float(found.end[1]) == near(slope)
        assert float(found.slope) == near(math.sqrt(1 + 2 * slope * ends.count("free") / g))
        # the determinant is A sin(γ − γ⁰) and rests, of which c and c' are the sizes
        amplitude = math.hypot(int(f.p[0]), int(f.q[0]))
        powers = [(n, abs(int(part[n]))) for part in (f.p, f.q, f.r) for n in range(1, 9)]
        c, slopes = sum(v for _, v in powers), sum((n + 1) * v for n, v in powers)
        assert float(f.amplitude) == near(amplitude) and f.excess == (c, slopes)
        last = float(modes.gamma[-1])
        assert float(modes.beyond) == near(c * math.exp(1 - last) * PI / math.sqrt(8) / amplitude)
        least = amplitude / math.sqrt(2)
        edge = math.log(max(c, slopes) / least) if c else 0.0  # from where on both are below
        for further in (1e-9, 0.5):
            assert not c or (_settled(f, arb(edge + further)) and not _settled(f, arb(edge - further)))
        away = [abs(float(root) - float(f.asymptote(k))) for k, root in enumerate(modes.gamma, modes._last - 5)]
        assert float(modes.spread) == near(max(*away, float(modes.beyond)))


@pytest.mark.parametrize("ends", ENDS[::3], ids=["-".join(e) for e in ENDS[::3]])
def test_integrals_of_modes_are_those_of_gauss(ends: tuple[str, str]) -> None:
    nodes, weights = leggauss(40)
    x, weights = (nodes + 1) / 2, weights / 2
    with precision(128):
        modes = Modes(ends, 4)
        values = []
        for (v, V, b, c), root in zip(modes.parts, modes.gamma, strict=True):
            v, V, b, c, g = (float(n) for n in (v, V, b, c, root))
            at_x = [
                g**d * (v * np.cos(g * x + d * PI / 2) + V * np.sin(g * x + d * PI / 2)
                        + (-1) ** d * b * np.exp(-g * x) + c * np.exp(g * (x - 1)))
                for d in range(3)
            ]  # fmt: skip
            values.append(at_x)
        for k, p, q in product(range(4), range(3), range(3)):
            found = modes.integral(k, p, q)
            for i, j in product(range(4), repeat=2):
                size = (1 + float(modes.gamma[i])) ** p * (1 + float(modes.gamma[j])) ** q
                wanted = float(np.sum(weights * x**k * values[i][p] * values[j][q]))
                assert float(found[i, j]) / size == pytest.approx(wanted / size, abs=1e-11)


FORMS: list[tuple[tuple[str, str], dict[Any, Any], dict[Any, Any]]] = [
    (("clamped", "free"), {(0, 1, 1): -1}, {(1, 0, 1, 1): 1}),
    (("free", "free"), {(1, 1, 1): -1, (0, 1, 0): 3}, {}),
    (("pinned", "free"), {(0, 0, 1): 2, (2, 0, 0): -3}, {(1, 0, 1, 1): -1, (0, 1, 0, 1): 4}),
    (("sliding", "free"), {(3, 1, 0): 2, (2, 1, 1): -1, (0, 0, 0): 3}, {(1, 1, 1, 1): 1, (0, 0, 1, 1): -2}),
]


def moved(along: Any, points: Any, summed: int) -> tuple[list[tuple[int, float]], list[tuple[Any, float]]]:
    """Lemma 4: terms of ‖g‖, and of the ends: what multiplies φ⁽ᵖ⁾(a) of the mode that stays and φ⁽ᑫ⁾(b) of the
    other."""
    inner: list[tuple[int, float]] = []
    ends: Counter[Any] = Counter()
    for (k, p, q), f in along.items():
        stays, goes = (p, q) if summed else (q, p)
        if goes == 1:
            inner += [(stays + 1, abs(f)), (stays, k * abs(f))]
            ends[1, stays, 1, 0] += f
            ends[0, stays, 0, 0] -= f * (k == 0)
        else:
            inner.append((stays, abs(f)))
    for (a, p, b, q), f in points.items():
        ends[(a, p, b, q) if summed else (b, q, a, p)] += f
    return inner, [(key, abs(float(f))) for key, f in ends.items()]


def slope_of(modes: Modes, i: int) -> float:
    """Lemma 2, of a mode that is known: the root of 1 + [φ φ'] / γ²."""
    at_ends = [float(modes.derivative(e, 0)[i] * modes.derivative(e, 1)[i]) for e in (0, 1)]
    return math.sqrt(1 + (at_ends[1] - at_ends[0]) / float(modes.gamma[i]) ** 2)


@pytest.mark.parametrize(("kinds", "along", "points"), FORMS)
def test_the_norm_on_a_line_is_that_of_lemma_4(kinds: tuple[str, str], along: Any, points: Any) -> None:
    with precision(128):
        form = Form(Modes(kinds, 5), along, points)
        modes, n = form.modes, 5
        g = [float(v) for v in modes.gamma]
        for R in (0.0, float(Strips.line(SimpleNamespace(modes=modes), 2))):  # type: ignore[arg-type]
            D = [abs(v**4 - R) for v in g]
            total = sum(float(form.B[i, j]) ** 2 / D[i] / D[j] for i in range(n) for j in range(n))
            share, first = 1 - R / g[-1] ** 4, float(modes.lattice(n) - modes.beyond)
            of_ends = 2.0, float(bounds(kinds, modes.gamma[-1]).end[1])
            beyond = float(bounds(kinds, modes.gamma[-1]).slope)

            def power(s: int, first: float = first) -> float:
                return 1 / ((s - 1) * PI * first ** (s - 1))

            far = [math.sqrt(of_ends[q] ** 2 * power(4 - 2 * q) / share) for q in (0, 1)]
            for summed in (0, 1):
                inner, ends = moved(along, points, summed)
                for i in range(n):
                    sizes = 1.0, g[i] * slope_of(modes, i), g[i] ** 2
                    part = sum(f * sizes[r] for r, f in inner) / math.sqrt(share) / g[-1] ** 2
                    part += sum(f * abs(float(modes.derivative(a, p)[i])) * far[q] for (a, p, _, q), f in ends)
                    total += part**2 / D[i]
                corner = sum(f * (1, beyond, 1)[r] * math.sqrt(power(8 - 2 * r)) for r, f in inner) / share
                corner += sum(f * far[p] * far[q] for (_, p, _, q), f in ends)
                total += corner**2
            assert float(form.norm(arb(R))) == near(math.sqrt(total))


@pytest.mark.parametrize(("kinds", "along", "points"), FORMS)
def test_the_norm_on_all_later_lines_is_that_of_lemma_5(kinds: tuple[str, str], along: Any, points: Any) -> None:
    with precision(128):
        form = Form(Modes(kinds, 12), along, points)
        modes = form.modes
        every = [[abs(float(modes.ends[e][1][i])) for e in (0, 1)] for i in range(12)]
        slopes = [slope_of(modes, i) for i in range(12)]
        later = bounds(kinds, modes.gamma[-1])
        e = 2.0, max(float(later.end[1]), *(v for pair in every for v in pair))
        slope = max(float(later.slope), *slopes)
        for k in (4, 9):
            G, delta = float(modes.lattice(k)) + PI / 2, float(modes.spread)
            t = PI / 2 - delta
            L, Q = 1 / t + math.log(G / t) / PI, 1 / t**2 + 1 / (PI * t)
            W, d = 1 / (2 * G * t) + math.log(1 + 2 * G / t) / (2 * PI * G), 4 * t * (G - PI / 2 - delta) ** 3
            ends = L / G**3 + W / (2 * G**2), L / (4 * G) + W
            both = (
                L / (G**3 * d) + Q / (13 * G**6),
                L / (4 * G * d) + Q / (13 * G**4),
                G * L / (4 * d) + Q / (13 * G**2),
            )
            total = 0.0
            for summed in (0, 1):
                inner, terms = moved(along, points, summed)
                part = sum(f * (1, slope, 1)[r] * math.sqrt(both[r]) for r, f in inner)
                part += sum(f * e[p] * e[q] * math.sqrt(ends[p] * ends[q]) for (_, p, _, q), f in terms)
                total += part**2
            assert float(form.beyond(k)) == near(math.sqrt(total))


# --- Lemmas 6 to 8 and 12 ------------------------------------------------------------------------------------


@pytest.mark.parametrize("kinds", [("clamped", "free"), ("free", "pinned"), ("sliding", "clamped")])
def test_what_is_free_about_a_line_is_that_of_lemma_7(kinds: tuple[str, str]) -> None:
    draw = drawn(7)
    with precision(128):
        modes = variable_section.modes_of(kinds, variable_section.MODES, 128)
        every = Form(modes, {}, {}).every
        for k in (5, 11):
            A, B, C, *f = draw.uniform(0.1, 1, 11)
            keys = list(product((0, 1), (0, 1), (0, 1)))
            ends = {key: arb(v) for key, v in zip(keys, f, strict=True)}
            delta = float(modes.spread)
            left, right = (float(modes.lattice(n)) for n in (k, k + 1))
            for G in (0.4 * left + 0.6 * right, 0.7 * left + 0.3 * right):
                t, away = min(G - left, right - G) - delta, G - left + delta
                d = 4 * t * (G - away) ** 3
                L = 1 / t + math.log(G / t) / PI
                W = 1 / (2 * G * t) + math.log(1 + 2 * G / t) / (2 * PI * G)
                e = [2 * math.sqrt(L / G**3 + W / (2 * G**2)), float(every.end[1]) * math.sqrt(L / (4 * G) + W)]
                n = d**-0.5
                u2 = (d * (1 - (1 + t / G) ** -4)) ** -0.5 + kinds.count("free") * e[0] * e[1]
                tau = A * u2 + 2 * B * math.sqrt(u2) * n + C * n**2
                for (end, p, q), size in zip(keys, f, strict=True):
                    if p not in ORDERS[kinds[end]] and q not in ORDERS[kinds[end]]:
                        tau += size * e[p] * e[q]
                wanted = max((1 - tau) * d, 0.0)
                given = (arb(A), arb(B), arb(C)), ends
                sides = modes.lattice(k), modes.lattice(k + 1)
                assert float(variable_section._free(modes, arb(G), sides, given, kinds)) == near(wanted)
                tau *= 0.9 / tau  # and where it is not free


def test_a_gap_far_out_is_of_the_line_between_the_asymptotes(monkeypatch: pytest.MonkeyPatch) -> None:
    """Γ is half way between the last asymptote on the left and the first on the right, of both beams; the least that is
    free counts."""
    tip = read(places=(F(0), ONE), mass=[along(0, 0, 3, on=(0,))], bending=[along(2, 2, 2, on=(0,))],
               masses=[at(ONE, 0, F(1, 2))], load=[along(1, 1, -1, on=(0,))])  # fmt: skip
    asked = []

    def free(modes: Any, G: Any, beside: Any, remainder: Any, kinds: Any) -> arb:
        asked.append((kinds, float(G), *map(float, beside)))
        return arb(5 if len(asked) % 2 else 3)

    monkeypatch.setattr(variable_section, "_free", free)
    with precision(128):
        section = variable_section.VariableSection(tip)
        R, gap = section.far_gap(4)
        c = (2 / 3) ** 0.25
        assert float(section.scale) == near(c)
        (one, G, a, b), (other, _, left, right) = asked
        assert (one, other) == (("clamped", "free"), ("clamped", "pinned"))
        assert [a, b, left, right] == [near(v) for v in (3.5 * PI, 4.5 * PI, 3.25 * PI, 4.25 * PI)]
        assert near((3.5 + 4.25) / 2 * PI) == G
        assert float(R) == near(c**4 * math.sqrt(G**8 - 9)) and float(gap) == near(c**2 * 3 / G**2)


@pytest.mark.parametrize(("order", "beside"), [(0, (0,)), (1, (1,)), (0, (0, 1)), (1, (0, 1))])
def test_a_value_at_a_place_is_that_of_lemma_12(order: int, beside: tuple[int, ...]) -> None:
    """The sum a u₁ + b u₀ at the length ℓ at which it is least, or at that of the shortest part beside it."""
    draw = drawn(11 + order)
    with precision(128):
        forms = read(places=(F(0), F(1, 4), ONE), mass=[along(0, 0, 2, on=(0,)), along(0, 0, 3, on=(1,))],
                     bending=[along(2, 2, 5, on=(0,)), along(2, 2, 4, on=(1,)), along(1, 1, -1)])  # fmt: skip
        share = 1 - (0.5 * ONE / 4)  # ∫ x of the weight, over the least EI
        assert float(forms.share) == near(float(share))
        EI, m = min((5, 4)[n] for n in beside), min((2, 3)[n] for n in beside)
        room = min((0.25, 0.75)[n] for n in beside)
        for u1, u0 in draw.uniform(0.1, 2, (4, 2)) * [[1, 1], [1, 0.001], [200, 0.1], [1, 1]]:
            a, b = u1 / math.sqrt(share * EI), u0 / math.sqrt(m)
            if order:
                sums = lambda x, a=a, b=b: math.sqrt(13 / 35 * x) * a + math.sqrt(12) / x**1.5 * b  # noqa: E731
            else:
                sums = lambda x, a=a, b=b: x**1.5 / math.sqrt(105) * a + 2 / math.sqrt(x) * b  # noqa: E731
            grid = np.geomspace(1e-6, room, 20001)
            wanted = 0.7 * min(map(sums, grid))
            found = Value(order, arb("0.7"), beside).most(forms, arb(u1), arb(u0))
            assert float(found) == pytest.approx(wanted, rel=1e-6)


def test_what_gaps_must_be_wider_than_is_the_constant_and_products_at_places() -> None:
    values = [SimpleNamespace(most=lambda forms, a, b, k=k: k * a + b) for k in (2, 3, 5)]
    size = LoadSize(None, arb(7), ((values[0], (values[1], values[2]), arb(11)),))  # type: ignore[arg-type]
    with precision(128):
        for low, high in ((0.5, 4.0), (0.125, 4.0), (0.0, 4.0)):
            felt = min(11.0, 3 + 5 + 2 / low) if low else 11.0
            assert float(size.at(arb(low), arb(high))) == near(7 + (2 * high + 1) * felt)


def test_the_size_of_a_load_is_the_root_of_the_sum_of_its_squares() -> None:
    """C² θ of Lemma 6 where all coefficients are numbers: ‖g m^(−1/2)‖ of each order, and q² over each mass."""
    with precision(128):
        forms = read(mass=[along(0, 0, 2)], bending=[along(2, 2, 3)], masses=[at(ONE, 0, F(1, 3)), at(ONE, 1, F(1, 7))],
                     load=[along(1, 1, -5), along(0, 0, 2), along(0, 1, F(1, 3))],
                     forces=[at(ONE, 0, 5, (ONE, 1)), at(ONE, 0, 1, (ONE, 0)), at(ONE, 1, 2, (HALF, 0))])  # fmt: skip
        EI, m = 3.0, 2.0
        slope, deflection = 0.7072 / math.sqrt(EI), 1 / (3 * math.sqrt(EI))
        # b = ∫ (5 y'' + y'/3 + 2 y) v + (−5 y'(1) + 5 y'(1) + y(1)) v(1) + 2 y(1/2) v'(1)
        # the load's term of orders (test 0, trial 1) is a factor of v y'
        along_all = (5 / math.sqrt(EI) + slope / 3 + 2 * deflection) / math.sqrt(m)
        point = 2 / (3 * math.sqrt(EI))
        total = along_all**2 + point**2 * 3 + (2 * point) ** 2 * 7
        found = load_size(forms)
        assert not found.places and float(found.constant) == near(math.sqrt(total))


@pytest.mark.parametrize(
    ("ends", "norms", "points"),
    [
        (("clamped", "free"), (1 / 3, 0.7072), (2 / 3, 1)),
        (("pinned", "sliding"), (1 / 2, math.sqrt(0.5)), (2 / 3, 1)),
        (("pinned", "pinned"), (1 / 2, 1), (1 / 2, 1)),
    ],
)
def test_no_frequency_is_below_that_of_the_bounds_of_displacements(
    ends: tuple[str, str], norms: tuple[float, float], points: tuple[float, float]
) -> None:
    """θ min EI over M, with ‖y‖ and values at places in parts of ‖y''‖, and 1/√k more of each joint."""
    jump = [at(HALF, 1, 16 * s * t, None, s, t) for s in (-1, 1) for t in (-1, 1)]
    for joint in (False, True):
        changes: dict[str, Any] = {"fields": {"y": (2, (), ((1, 1),))}, "springs": jump} if joint else {}
        with precision(128):
            forms = read(ends=ends, mass=[along(0, 0, 2), along(0, 0, 3, on=(1,))],
                         masses=[at(F(1, 2), 0, 4), at(ONE if ends[1] == "free" else F(0), 1, F(1, 5))]
                         if ends != ("pinned", "sliding") else [at(F(1, 2), 0, 4)],
                         bending=[along(2, 2, 9)], forces=[], **changes)  # fmt: skip
            more = 0.25 if joint else 0.0
            M = 5 * (norms[0] / 3 + more) ** 2 + 4 * (points[0] / 3 + more) ** 2
            if ends != ("pinned", "sliding"):
                M += (points[1] / 3 + more) ** 2 / 5
            assert float(forms.lowest) == pytest.approx(1 / math.sqrt(M), rel=1e-9)


def test_cubics_are_the_integrals_of_their_polynomials() -> None:
    shapes = {(0, True): [1, 0, -3, 2], (1, True): [0, 1, -2, 1], (0, False): [1, F(-3, 2), 0, F(1, 2)]}
    for key, factors in shapes.items():
        f = np.polynomial.Polynomial(list(map(float, factors)))
        assert [float(v) for v in CUBICS[key]] == [
            pytest.approx((w * w).integ()(1.0) - (w * w).integ()(0.0), rel=1e-14) for w in (f, f.deriv(), f.deriv(2))
        ]
        assert f(1.0) == f.deriv()(1.0) == 0 and (f(0.0), f.deriv()(0.0))[key[0]] == 1
