"""The beam itself in balls: its characteristic function, and what is proven of critical loads and frequencies."""

from __future__ import annotations

import math
from collections.abc import Callable
from fractions import Fraction
from types import ModuleType, SimpleNamespace
from typing import Any

import mpmath as mp
import numpy as np
import pytest
from flint import acb, arb, arb_mat

import freebeam_kernels.beck as beck
import freebeam_kernels.euler_pinned as euler
import freebeam_kernels.free_free as free_free
from freebeam_derive.certify import balls, beam, beam_itself
from freebeam_derive.certify.balls import Unproven, precision
from freebeam_derive.certify.beam import Beam, Coefficient, NoSeries

NONE = Fraction(0)
HALF = Fraction(1, 2)


def column(equation: Any, ends: Any, rigid: int = 0) -> Any:
    """What a kernel is to the exact beam, by hand; equation and ends: functions of (P, alpha, beta)."""
    return SimpleNamespace(
        COLUMN={"name": "own", "rigid": rigid, "parameters": []},
        equation=lambda P, alpha=0, beta=0: equation(P, alpha, beta),
        end_conditions=lambda P, alpha=0, beta=0: ends(P, alpha, beta),
    )


CLAMPED = ({(0, 0): 1}, {(1, 0): 1})


def free(alpha: Any) -> Any:
    return {(3, 0): -1, (3, 1): -alpha}, {(2, 0): 1, (2, 1): alpha}


LEIPHOLZ = column(
    lambda P, a, b: {(0, 1): (b,), (0, 2): (1,), (2, 0): (P, -P), (4, 0): (1,), (4, 1): (a,)},
    lambda P, a, b: (CLAMPED, free(a)),
)
TIP_MASS = column(  # on an elastic foundation, which internal damping does not act in; the tip is damped as the beam is
    lambda P, a, b: {(0, 0): (7,), (0, 1): (b,), (0, 2): (1,), (2, 0): (P,), (4, 0): (1,), (4, 1): (a,)},
    lambda P, a, b: (
        CLAMPED,
        ({(0, 1): 0.5 * (b - 7 * a), (0, 2): 0.5, (3, 0): -1, (3, 1): -a}, {(2, 0): 1, (2, 1): a}),
    ),
)


def contains(ball: arb, value: Any) -> bool:
    """Whether a ball and an mpmath number's neighbourhood of 1e-10 of the ball's radius meet."""
    digits = mp.nstr(value, mp.mp.dps)
    with precision(4 * mp.mp.dps):
        return bool(ball.overlaps(arb(digits) + ball.rad() * arb(0, 1e-10)))


# ------------------------------------------------------------ an independent route, about the other end, in mpmath


def backwards(kernel: str, p: Any, s: Any) -> Any:
    """The determinant of the conditions at x = 0 on two solutions from x = 1, by powers of z = 1 − x."""
    a: list[list[Any]] = [[mp.mpf(1), mp.mpf(0), 0, 0], [mp.mpf(0), mp.mpf(1), 0, 0]]  # y'' = y''' = 0 at x = 1
    for n in range(int(40 + 1.6 * mp.mp.dps)):
        for c in a:
            if kernel == "free-free":  # y'''' + p ((1 − z) y')' = s y
                load = (n + 2) * (n + 1) * c[n + 2] - (n + 1) ** 2 * c[n + 1]
            else:  # Leipholz: y'''' + p z y'' = s y
                load = (n + 1) * n * c[n + 1]
            c.append((s * c[n] - p * load) / ((n + 1) * (n + 2) * (n + 3) * (n + 4)))
    orders = (2, 3) if kernel == "free-free" else (0, 1)
    (e, f), (g, h) = ([sum(mp.ff(n, j) * v for n, v in enumerate(c)) for j in orders] for c in a)
    return e * h - f * g


def independent(system: Callable[..., Any], start: tuple[float, ...], digits: int = 40) -> Any:
    with mp.workdps(digits):
        return mp.findroot(system, start, tol=mp.mpf(10) ** (6 - digits))


def double(kernel: str) -> Callable[..., Any]:
    return lambda p, s: [backwards(kernel, p, s), mp.diff(lambda v: backwards(kernel, p, v), s)]


def test_a_stiffness_of_two_is_one_of_half_the_load_and_half_the_square() -> None:
    """2 y'''' + 2 P y'' = 2 s y is the equation at P and s; the follower's conditions have neither."""
    two: Any = SimpleNamespace(
        COLUMN=beck.COLUMN, end_conditions=beck.end_conditions,
        equation=lambda *at, **own: {
            key: tuple(2 * v for v in row) if key == (4, 0) else row for key, row in beck.equation(*at, **own).items()
        },
    )  # fmt: skip
    with precision(128):
        one, other = (Beam(kernel).taylor(*at, ((0, 0),))[0, 0] for kernel, at in (
            (beck, (arb(17), arb(90))), (two, (arb(34), arb(180)))
        ))  # fmt: skip
        assert one.overlaps(other) and not one.contains(0) and one.rad() < 1e-20 * abs(one)


@pytest.mark.parametrize(
    ("kernel", "name", "near"),
    [(free_free, "free-free", (109.69, 23.07)), (LEIPHOLZ, "leipholz", (40.05, 11.0))],
    ids=["free-free", "leipholz"],
)
def test_undamped_flutter_holds_what_mpmath_finds_from_the_other_end(
    kernel: Any, name: str, near: tuple[float, float]
) -> None:
    found = beam_itself.flutter_undamped(Beam(kernel), near, 20)
    p, s = independent(double(name), (float(found.load), float(found.frequency**2)))
    with mp.workdps(40):
        assert contains(found.load, p)
        assert contains(found.frequency, mp.sqrt(s))
    assert found.kind == "flutter"


def test_damped_flutter_holds_what_mpmath_finds_from_the_other_end() -> None:
    alpha, beta = Fraction(1, 1000), Fraction(1, 10)
    found = beam_itself.flutter_damped(Beam(free_free), alpha, beta, (90.84, 11.95), 20)

    def system(P: Any, w: Any) -> list[Any]:
        turned = 1 + mp.mpc(0, 1) * w / 1000
        F = backwards("free-free", P / turned, (w * w - mp.mpc(0, 1) * w / 10) / turned)
        return [F.real, F.imag]

    P, w = independent(system, (float(found.load), float(found.frequency)))
    with mp.workdps(40):
        assert contains(found.load, P)
        assert contains(found.frequency, w)


def test_vanishing_damping_holds_what_mpmath_finds_from_the_other_end() -> None:
    kappa = Fraction(50)
    found = beam_itself.flutter_limit(Beam(free_free), kappa, (90.0, 11.8), 15)

    def system(p: Any, s: Any) -> list[Any]:
        F = lambda p, s: backwards("free-free", p, s)  # noqa: E731
        return [F(p, s), p * mp.diff(F, (p, s), (1, 0)) + (s + 50) * mp.diff(F, (p, s), (0, 1))]

    p, s = independent(system, (float(found.load), float(found.frequency**2)))
    with mp.workdps(40):
        assert contains(found.load, p)
        assert contains(found.frequency, mp.sqrt(s))


# ------------------------------------------------------------ closed forms


def becks_determinant(p: Any, s: Any) -> Any:
    """Beck's characteristic function, (p² + 4 s) times the determinant of the two solutions at the tip."""
    root = mp.sqrt(p * p / 4 + s)
    a, b = mp.sqrt(root - p / 2), mp.sqrt(root + p / 2)
    w = mp.sqrt(s)
    return p * p + 2 * s * (1 + mp.cosh(a) * mp.cos(b)) + p * w * mp.sinh(a) * mp.sin(b)


@pytest.mark.parametrize("bits", [64, 256])
@pytest.mark.parametrize(("p", "s"), [(3, 5), (20, 121), (-7, 40), (150, 90000)])
def test_the_characteristic_function_is_becks(p: int, s: int, bits: int) -> None:
    with precision(bits), mp.workdps(90):
        F = Beam(beck).taylor(arb(p), arb(s), ((0, 0),))[0, 0]
        assert contains(F, becks_determinant(mp.mpf(p), mp.mpf(s)) / (p * p + 4 * s))


def test_becks_load_holds_the_double_root_of_becks_determinant() -> None:
    found = beam_itself.flutter_undamped(Beam(beck), (20.05, 11.02), 45)
    p, s = independent(
        lambda p, s: [becks_determinant(p, s), mp.diff(lambda v: becks_determinant(p, v), s)], (20.05, 121.35), 70
    )
    with mp.workdps(60):
        assert contains(found.load, p)
        assert contains(found.frequency, mp.sqrt(s))


def exponentials(p: Any, s: Any, mass: Any, foundation: Any) -> Any:
    """A constant axial force: the determinant of all four conditions on e^(kx), over that of the solutions' start."""
    k = mp.polyroots([1, 0, p, 0, foundation - s], maxsteps=200, extraprec=200)
    rows = [
        [1, 1, 1, 1],
        list(k),
        [(-(r**3) - s * mass) * mp.exp(r) for r in k],
        [r**2 * mp.exp(r) for r in k],
    ]
    return mp.det(mp.matrix(rows)) / mp.det(mp.matrix([[r**n for r in k] for n in range(4)]))


@pytest.mark.parametrize(("p", "s"), [(8, 30), (31, 700)])
def test_elastic_foundation_and_tip_mass_enter_as_they_should(p: int, s: int) -> None:
    with mp.workdps(60), precision(160):
        F = Beam(TIP_MASS).taylor(arb(p), arb(s), ((0, 0),))[0, 0]
        assert contains(F, exponentials(mp.mpf(p), mp.mpf(s), mp.mpf(1) / 2, 7).real)


def test_damping_is_read_off_the_equation() -> None:
    """The foundation is elastic but not damped: C = α E + (β − 7 α) M."""
    with precision(64):
        c_E, c_M = Beam(TIP_MASS).damping(HALF, Fraction(10))
        assert c_E == arb(0.5) and c_M == arb(6.5)


@pytest.mark.parametrize("order", [1, 2, 3])
def test_euler_s_loads_are_multiples_of_pi_squared(order: int) -> None:
    found = beam_itself.divergence(Beam(euler), 9.87 * order**2, 60)
    with precision(300):
        assert found.load.contains((arb.pi() * order) ** 2)
    assert found.kind == "divergence" and found.frequency == 0


def test_a_dead_load_on_becks_column_buckles_it_at_a_quarter_of_eulers() -> None:
    found = beam_itself.divergence(Beam(beck, {"eta": NONE}), 2.467, 60)
    with precision(300):
        assert found.load.contains((arb.pi() / 2) ** 2)


def test_a_follower_load_has_no_divergence() -> None:
    with pytest.raises(Unproven, match="divergence at the load 10"):
        beam_itself.divergence(Beam(beck), 10.0, 10)


# ------------------------------------------------------------ the series and its tail


def test_derivatives_are_those_of_the_function() -> None:
    """The Taylor polynomial about (p, s), evaluated a little off, is the function there to the order it has."""
    orders = tuple((i, j) for i in range(4) for j in range(4) if i + j < 4)
    with precision(200):
        for kernel in (beck, free_free, LEIPHOLZ, TIP_MASS):
            column, p, s, h = Beam(kernel), arb(31), arb(200), arb(2) ** -30
            t = column.taylor(p, s, orders)
            off = column.taylor(p + h, s - 3 * h, ((0, 0),))[0, 0]
            approximate = sum((t[i, j] * h**i * (-3 * h) ** j for i, j in orders), arb(0))
            assert abs(off - approximate) < 1000 * h**4
            assert not abs(off - approximate + t[1, 2] * h * 9 * h * h) < 1000 * h**4  # one term of the last order less


@pytest.mark.parametrize("kernel", [beck, free_free, LEIPHOLZ], ids=["beck", "free-free", "leipholz"])
def test_the_tail_bound_covers_what_is_cut_off(kernel: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    with precision(400):
        column, p, s = Beam(kernel), arb(60), arb(300)
        true = column.taylor(p, s, ((0, 0), (0, 1)))
        everything = beam._sizes

        def cut(count: int, bound: bool) -> Any:
            monkeypatch.setattr(beam, "_sizes", lambda norms, bits: everything(norms, bits)[:count])
            tail = (lambda *a: [arb(0)] * len(a[-1])) if not bound else original
            monkeypatch.setattr(beam, "_tail", tail)
            return column.taylor(p, s, ((0, 0), (0, 1)))

        original = beam._tail
        for count in (30, 36, 42, 60):
            short, longer, bare = cut(count, True), cut(2 * count, True), cut(count, False)
            for order in true:
                assert short[order].contains(true[order]) and short[order].overlaps(longer[order])
                assert not bare[order].contains(true[order])  # the bound is needed
                error = abs(bare[order] - true[order])
                assert short[order].rad() < 1e12 * error  # and says something


def test_the_tail_bound_covers_the_derivatives_of_what_is_cut_off(monkeypatch: pytest.MonkeyPatch) -> None:
    """Without load and motion the solutions are polynomials: all that is cut off is in the derivatives. Beck's
    function is then (1 + cosh k cos k) / 2 = 1 + Σ (−4)^m s^m / (2 (4m)!), s = k⁴."""
    everything = beam._sizes
    with precision(200):
        for count in (10, 14, 18, 40):
            monkeypatch.setattr(beam, "_sizes", lambda norms, bits, n=count: (everything(norms, bits) + 40 * [0])[:n])
            t = Beam(beck).taylor(arb(0), arb(0), tuple((0, m) for m in range(6)))
            assert t[0, 0].contains(1)
            for m in range(1, 6):
                assert t[0, m].contains(arb(-4) ** m / (2 * arb(4 * m).fac()))
        assert t[0, 5].rel_accuracy_bits() > 100


def test_the_tail_bound_is_little_more_than_the_largest_tail() -> None:
    """That of |aₘ| = T 2^(N − m), which is all that is known of them."""
    N, T = 30, 3
    with precision(100):
        terms = [arb_mat([[T * arb(N).fac()] * 2])] * (N - 2)  # n! aₙ of two solutions, of which the last counts
        for j, error in enumerate(beam._tail({(3, 0): arb(1)}, terms, 1, (0, 1, 2, 3))):
            rest = sum(Fraction(math.perm(m, j) * T, 2 ** (m - N)) for m in range(N + 1, N + 200))
            assert (1 - 1e-25) * float(rest) <= float(error) < 1.3 * float(rest)


def mirrored(kernel: Any) -> Any:
    """A column of constant axial force seen from its other end."""

    def ends(P: Any, a: Any, b: Any) -> Any:
        turned = [
            tuple({(p, r): (-1) ** p * v for (p, r), v in row.items()} for row in end)
            for end in kernel.end_conditions(P, a, b)
        ]
        return turned[1], turned[0]

    return column(lambda P, a, b: kernel.equation(P, a, b), ends)


SPRING = column(  # a spring and an inertia against rotation of the tip, and a load that acts on both conditions
    lambda P, a, b: {(0, 2): (1,), (2, 0): (P,), (4, 0): (1,)},
    lambda P, a, b: (CLAMPED, ({(1, 0): -P, (3, 0): -1}, {(0, 0): 2 * P, (1, 0): 3, (1, 2): 0.25, (2, 0): 1})),
)

SLIDING = column(  # a sliding end, on whose shear force the load acts, and a spring there
    lambda P, a, b: {(0, 2): (1,), (2, 0): (P,), (4, 0): (1,)},
    lambda P, a, b: (({(0, 0): 1}, {(2, 0): 1}), ({(1, 0): 1}, {(0, 0): 2, (1, 0): -P, (3, 0): -1})),
)


@pytest.mark.parametrize(
    "kernel",
    [beck, euler, TIP_MASS, SPRING, SLIDING],
    ids=["beck", "euler", "tip mass", "spring", "sliding"],
)
def test_a_column_is_the_same_from_its_other_end(kernel: Any) -> None:
    """Conditions at x = 0 that hold the load and the motion give the same function, but for its sign."""
    orders = ((0, 0), (1, 0), (0, 1), (1, 1), (0, 2))
    other = SimpleNamespace(**vars(kernel))
    if kernel is beck:
        other.end_conditions = lambda P, a=0, b=0, **own: beck.end_conditions(P, a, b, eta=0.25)
    kernel = column(lambda P, a, b: other.equation(P, a, b), lambda P, a, b: other.end_conditions(P, a, b))
    with precision(128):
        for p, s in ((arb(7), arb(90)), (acb(12, 3), acb(-40, 5))):
            seen, turned = (Beam(k).taylor(p, s, orders) for k in (kernel, mirrored(kernel)))
            sign = 1 if (seen[0, 0] / turned[0, 0]).real > 0 else -1
            for order in orders:
                assert seen[order].overlaps(sign * turned[order]) and seen[order].rel_accuracy_bits() > 80


def test_a_series_cut_before_it_converges_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(beam, "_sizes", lambda norms, bits: [0] * 8)
    with precision(64), pytest.raises(Unproven, match="too early"):
        Beam(free_free).taylor(arb(100), arb(1000), ((0, 0),))


def test_values_on_a_box_hold_the_values_at_its_points() -> None:
    with precision(128):
        column = Beam(free_free)
        wide = column.taylor(arb(50, 1e-3), acb(arb(300, 1e-2), arb(5, 1e-2)), ((0, 0), (1, 0), (0, 1)))
        for x, y, z in np.random.default_rng(3).uniform(-1, 1, (6, 3)):
            s = acb(300 + 1e-2 * float(y), 5 + 1e-2 * float(z))
            point = column.taylor(arb(50 + 1e-3 * float(x)), s, ((0, 0), (1, 0), (0, 1)))
            assert all(wide[order].contains(point[order]) for order in wide)


def test_rigid_motions_put_their_power_of_s_into_the_function() -> None:
    with precision(128):
        assert Beam(free_free).trivial() == 2
        assert Beam(beck).trivial() == 0
        t = Beam(free_free).taylor(arb(50), arb(0), ((0, 0), (0, 1), (0, 2)))
        assert t[0, 0].contains(0) and t[0, 1].contains(0) and not t[0, 2].contains(0)


# ------------------------------------------------------------ what is proven, and what is not

CROSSINGS: dict[str, Callable[[int], beam_itself.ExactCrossing]] = {
    "undamped": lambda digits: beam_itself.flutter_undamped(Beam(free_free), (109.69, 23.07), digits),
    "damped": lambda digits: beam_itself.flutter_damped(Beam(beck), Fraction(1, 100), HALF, (16.0, 7.0), digits),
    "external": lambda digits: beam_itself.flutter_damped(Beam(beck), NONE, HALF, (20.05, 11.0), digits),
    "limit": lambda digits: beam_itself.flutter_limit(Beam(free_free), NONE, (88.2, 11.7), digits),
    "sub-tangential": lambda digits: beam_itself.flutter_undamped(
        Beam(beck, {"eta": Fraction(4, 5)}), (17.6, 9.9), digits
    ),
    "divergence": lambda digits: beam_itself.divergence(Beam(beck, {"eta": Fraction(1, 3)}), 3.5, digits),
}


@pytest.mark.parametrize("name", CROSSINGS)
def test_enclosures_nest_and_are_as_narrow_as_asked(name: str) -> None:
    before = None
    for digits in (1, 12, 40, 150):
        found = CROSSINGS[name](digits)
        with precision(found.bits):
            assert found.load.rad() * 2 < abs(found.load) * arb(10) ** -digits
            assert found.frequency.rad() * 2 <= abs(found.frequency) * arb(10) ** -digits
        if before is not None:
            assert before.load.contains(found.load) and before.frequency.contains(found.frequency)
        assert found.proof.crossing and found.proof.kind
        assert not found.proof.first and not found.proof.stable_below
        before = found


def problems() -> list[tuple[str, Any, tuple[float, ...]]]:
    return [
        ("undamped", beam_itself.Coalescence(Beam(beck)), (20.05, 121.3)),
        ("damped", beam_itself.Damped(Beam(free_free), Fraction(1, 1000), Fraction(1, 10)), (90.84, 11.95)),
        ("limit", beam_itself.VanishingDamping(Beam(free_free), NONE), (88.15, 137.4)),
        ("divergence", beam_itself.Static(Beam(euler)), (9.87,)),
        ("eigenvalue", beam_itself.Eigenvalue(Beam(beck), Fraction(10), NONE, HALF, "plane"), (-0.25, 5.2)),
    ]


@pytest.mark.parametrize(("name", "problem", "near"), problems(), ids=[name for name, *_ in problems()])
def test_a_box_without_the_zero_is_refused(name: str, problem: Any, near: tuple[float, ...]) -> None:
    found, _, bits = beam_itself.enclose(problem, near, 40)
    with precision(bits + 64):
        middle = [side.mid() for side in found]
        around = arb(0, 1e-24)
        assert all(
            a.overlaps(b)
            for a, b in zip(beam_itself.krawczyk(problem, [m + around for m in middle]), found, strict=True)
        )
        with pytest.raises(Unproven):  # so wide that there may be two
            beam_itself.krawczyk(problem, [m + arb(0, 0.5) * abs(m) for m in middle])
        for shifted in range(len(middle)):
            box = [m + around + (arb("1e-20") if k == shifted else 0) for k, m in enumerate(middle)]
            with pytest.raises(Unproven, match="not proven"):
                beam_itself.krawczyk(problem, box)


def blown(kernel: Any, radius: float) -> Any:
    """The same column with a mass that is known only so well."""
    return column(
        lambda P, a, b: {**kernel.equation(P, a, b), (0, 2): (arb(1, radius),)},
        lambda P, a, b: kernel.end_conditions(P, a, b),
        kernel.COLUMN["rigid"],
    )


@pytest.mark.parametrize(("radius", "digits"), [(1e-3, 3), (1e-9, 12), (1e-30, 40)])
def test_a_coefficient_blown_up_proves_nothing_narrower(radius: float, digits: int) -> None:
    with pytest.raises(Unproven, match="undamped flutter"):
        beam_itself.flutter_undamped(Beam(blown(beck, radius)), (20.05, 11.02), digits)


def test_what_is_known_of_a_blown_up_column_is_still_proven() -> None:
    found = beam_itself.flutter_undamped(Beam(blown(beck, 1e-30)), (20.05, 11.02), 20)
    assert found.load.overlaps(beam_itself.flutter_undamped(Beam(beck), (20.05, 11.02), 40).load)


def reversed_load(kernel: ModuleType, top: int) -> Any:
    """The column under the load top − P: what was an onset is then a restabilisation, at the complement."""
    return column(
        lambda P, a, b: kernel.equation(top - P, a, b),
        lambda P, a, b: kernel.end_conditions(top - P, a, b),
        kernel.COLUMN["rigid"],
    )


def test_a_restabilisation_is_refused() -> None:
    with pytest.raises(beam_itself.NoOnset, match="restabilisation"):
        beam_itself.flutter_undamped(Beam(reversed_load(beck, 50)), (50 - 20.05, 11.02), 20)
    with pytest.raises(beam_itself.NoOnset, match="restabilisation"):
        beam_itself.divergence(Beam(reversed_load(euler, 30)), 30 - 9.87, 20)
    with pytest.raises(beam_itself.NoOnset, match="restabilisation"):
        beam_itself.flutter_damped(Beam(reversed_load(beck, 50)), NONE, HALF, (50 - 20.1, 11.0), 20)


def test_an_enclosure_that_gets_no_finer_is_given_up(monkeypatch: pytest.MonkeyPatch) -> None:
    """As where rounding outweighs what more bits give: here the second image of a box is the box."""
    _, problem, start = problems()[0]
    right, images = beam_itself.image, iter(range(9))
    monkeypatch.setattr(
        beam_itself, "image", lambda x, value, slopes, box: [*box] if next(images) else right(x, value, slopes, box)
    )
    with pytest.raises(Unproven, match="does not shrink"):
        beam_itself._enclose(problem, start, 400, 96)


def test_a_start_that_leads_nowhere_is_reported() -> None:
    with pytest.raises(
        beam_itself.NoZero, match=r"undamped flutter at the load \(and ω²\) 5, 9 is not proven: Newton's method"
    ):
        beam_itself.flutter_undamped(Beam(beck), (5.0, 3.0), 10)


@pytest.mark.parametrize("damping", [(Fraction(1, 1000), Fraction(1, 10)), (NONE, HALF)], ids=["both", "external"])
def test_growth_changes_sign_at_the_damped_load(damping: tuple[Fraction, Fraction]) -> None:
    alpha, beta = damping
    found = beam_itself.flutter_damped(Beam(free_free), alpha, beta, (90.84, 11.95) if alpha else (109.7, 23.0), 20)
    load, start = Fraction(float(found.load)), complex(0, float(found.frequency))
    step = Fraction(1, 10**6)
    (below,) = beam_itself.frequencies(Beam(free_free), load - step, alpha, beta, [start], 15)
    (above,) = beam_itself.frequencies(Beam(free_free), load + step, alpha, beta, [start], 15)
    assert below.real < 0 < above.real


def test_two_frequencies_become_a_complex_pair_at_the_undamped_load() -> None:
    found = beam_itself.flutter_undamped(Beam(beck), (20.05, 11.02), 20)
    load, w = Fraction(float(found.load)), float(found.frequency)
    bend = 0.04  # about how far the two are apart at a load lower by 1/1000
    low, high = beam_itself.frequencies(
        Beam(beck), load - Fraction(1, 1000), NONE, NONE, [1j * (w - bend), 1j * (w + bend)], 15
    )
    assert low.real == 0 == high.real and low.imag < found.frequency < high.imag
    (grown,) = beam_itself.frequencies(Beam(beck), load + Fraction(1, 1000), NONE, NONE, [complex(bend, w)], 15)
    assert grown.real > 0


@pytest.mark.parametrize("kappa", [NONE, Fraction(30)])
def test_small_damping_tends_to_its_limit(kappa: Fraction) -> None:
    """To first order: the distance goes with α², for the growth rate is odd in the damping."""
    column = Beam(free_free)
    limit = beam_itself.flutter_limit(column, kappa, (89.0, 11.8), 30)
    near = (float(limit.load), float(limit.frequency))
    away = []
    for power in (4, 5, 12):
        alpha = Fraction(1, 10**power)
        found = beam_itself.flutter_damped(column, alpha, kappa * alpha, near, 30)
        away.append(float(found.load - limit.load))
    assert away[0] / away[1] == pytest.approx(100, rel=0.05)
    assert abs(away[2]) < 1e-16


# ------------------------------------------------------------ frequencies


@pytest.mark.parametrize("kernel", [beck, free_free, euler], ids=["beck", "free-free", "euler"])
def test_frequencies_without_load_are_those_of_the_comparison_beam(kernel: ModuleType) -> None:
    alpha, beta = Fraction(1, 1000), Fraction(1, 10)
    with precision(160):
        quarter, _, delta = balls.roots(kernel, 6)
        gamma = [q * arb.pi() / 4 + d for q, d in zip(quarter, delta, strict=True)]
        starts = [1j * float(g) ** 2 for g in gamma]
        for value, g in zip(beam_itself.frequencies(Beam(kernel), NONE, NONE, NONE, starts, 30), gamma, strict=True):
            assert value.real == 0 and value.imag.overlaps(g * g)
        starts = [complex(v) for v in kernel.frequencies(np.array([float(g) for g in gamma]), 1e-3, 0.1)[1]]
        for value, g in zip(beam_itself.frequencies(Beam(kernel), NONE, alpha, beta, starts, 30), gamma, strict=True):
            # Eq. (23)
            damped = value * value + (balls.exact(alpha) * g**4 + balls.exact(beta)) * value + g**4
            assert damped.contains(0) and abs(damped) < 1e-20 * abs(g**4)


def test_high_modes_get_the_bits_that_they_need() -> None:
    with precision(300):
        quarter, _, delta = balls.roots(beck, 30)
        g = quarter[-1] * arb.pi() / 4 + delta[-1]
        (value,) = beam_itself.frequencies(Beam(beck), NONE, NONE, NONE, [1j * float(g * g)], 30)
        assert value.imag.overlaps(g * g) and value.imag.rad() < 1e-29 * g * g


def test_overdamped_eigenvalues_are_known_to_be_real() -> None:
    """Eq. (23) with so much damping that the first mode does not oscillate."""
    with precision(128):
        quarter, _, delta = balls.roots(beck, 1)
        g = quarter[0] * arb.pi() / 4 + delta[0]
        for start in beck.frequencies(np.array([float(g)]), 1.0, 0.0):
            (value,) = beam_itself.frequencies(Beam(beck), NONE, Fraction(1), NONE, [complex(start[0])], 20)
            assert value.imag == 0 and value.real < 0
            assert (value * value + g**4 * (value + 1)).contains(0)


@pytest.mark.parametrize("kernel", [beck, free_free], ids=["beck", "free-free"])
def test_ritz_values_are_near_zeros_of_the_function(kernel: ModuleType) -> None:
    """One Newton step from a Ritz value of 24 modes is a part in 10^4 of it; the enclosure is where it leads."""
    basis = kernel.basis(24)
    load = 15.0 if kernel is beck else 60.0
    stiffness = kernel.stiffness_elastic(basis) + load * kernel.stiffness_load(basis)
    ritz = np.sort(np.linalg.eigvals(np.linalg.solve(kernel.mass(basis), stiffness)).real)[:4]
    starts = [1j * float(v) ** 0.5 for v in ritz]
    found = beam_itself.frequencies(Beam(kernel), Fraction(load), NONE, NONE, starts, 12)
    with precision(128):
        for s, value in zip(ritz, found, strict=True):
            t = Beam(kernel).taylor(arb(load), arb(float(s)), ((0, 0), (0, 1)))
            step = t[0, 0] / t[0, 1]
            assert abs(step) < 1e-4 * float(s)
            assert abs(float(s) - step - value.imag**2) < 1e-7 * float(s)


def test_two_starts_for_one_eigenvalue_are_refused() -> None:
    with pytest.raises(Unproven, match="lead to one eigenvalue"):
        beam_itself.frequencies(Beam(beck), NONE, NONE, NONE, [3.51j, 3.52j], 10)


# ------------------------------------------------------------ columns that the series does not serve

PLAIN = {(0, 2): (1,), (2, 0): (1,), (4, 0): (1,)}


@pytest.mark.parametrize(
    ("equation", "message"),
    [
        (lambda P, a, b: {(0, 2): (1,), (2, 0): (P,), (4, 0): (1, 1)}, "bending stiffness must be constant"),
        (lambda P, a, b: {(0, 2): (1,), (2, 0): (P * P,), (4, 0): (1,)}, "linear in the load"),
        (lambda P, a, b: {(0, 2): (1,), (2, 0): (P / 3 * 2.0,), (0, 0): (2 / 3,), (4, 0): (1,)}, "rounded"),
    ],
)
def test_other_columns_are_refused(equation: Any, message: str) -> None:
    with pytest.raises(NoSeries, match=message):
        Beam(column(equation, lambda P, a, b: (CLAMPED, free(a))))


def test_damping_of_another_kind_is_refused() -> None:
    other = column(
        lambda P, a, b: {(0, 2): (1,), (1, 1): (b,), (2, 0): (P,), (4, 0): (1,), (4, 1): (a,)},
        lambda P, a, b: (CLAMPED, free(a)),
    )
    with pytest.raises(NoSeries, match="damping is not of the form"):
        beam_itself.flutter_damped(Beam(other), HALF, HALF, (20.0, 11.0), 10)


def test_bad_input_is_named() -> None:
    with pytest.raises(ValueError, match="zeta: beck has no such parameter"):
        Beam(beck, {"zeta": HALF})
    with pytest.raises(ValueError, match="digits = 0: must be 1 or greater"):
        beam_itself.flutter_undamped(Beam(beck), (20.05, 11.02), 0)
    undamped = column(
        lambda P, a, b: {(0, 1): (b,), (0, 2): (1,), (2, 0): (P,), (4, 0): (1,)}, lambda P, a, b: (CLAMPED, free(0))
    )
    with pytest.raises(ValueError, match="no internal damping"):
        beam_itself.flutter_limit(Beam(undamped), NONE, (20.0, 11.0), 10)


@pytest.mark.parametrize(("a", "d"), [((1, 1, 0), (1, 0, 0)), ((1, 1, 0), (1, 1, 0)), ((1, 1, 0), (1, -1, 0)),
                                      ((1, 0, 1), (1, 0, -1)), ((1, 0, 0), (1, 0, 1))])  # fmt: skip
def test_a_condition_whose_leading_factor_hangs_on_the_load_or_the_frequency_is_refused(a: Any, d: Any) -> None:
    """Dividing by such a determinant would put zeros into F, or take them out: (1 + p)², 1 − p², 1 + s, …"""
    beam = Beam(beck)
    left = ({3: Coefficient(*map(arb, a))}, {2: Coefficient(*map(arb, d))})
    beam._known = {bits: parts._replace(left=left) for bits, parts in beam._known.items()}
    with pytest.raises(NoSeries, match="do not determine two derivatives"):
        beam.taylor(arb(1), arb(1), ((0, 0),))


def test_roots_beside_the_one_near_an_asymptote_are_told() -> None:
    """δ (δ² − 0.09) has three roots within π/4 of the asymptote: none is said to be the only one there."""

    def characteristic(delta: Any, *_: Any) -> tuple[Any, Any]:
        return delta * (delta * delta - arb("0.09")), 3 * delta * delta - arb("0.09")

    three = ModuleType("three")
    three.basis = lambda modes: SimpleNamespace(quarter=[2], sigma=[1], delta=[0.0])  # type: ignore[attr-defined]
    for sign in (1, -1):
        three.characteristic = lambda *given, by=sign: [by * v for v in characteristic(*given)]  # type: ignore[attr-defined]
        balls._isolated.cache_clear()
        with pytest.raises(Unproven, match="root 1 is not known to be the only one"):
            balls._isolated(three, 1)


def test_a_root_of_another_asymptote_is_not_taken() -> None:
    """sin δ has one root near each of its asymptotes, π from each other: a start may lead to that of the next."""
    sine = ModuleType("sine")
    sine.characteristic = lambda delta, *_: ([delta[0].sin()], [delta[0].cos()])  # type: ignore[attr-defined]
    for start, taken in ((1e-14, True), (np.pi, False), (-np.pi, False)):
        sine.basis = lambda modes, at=start: SimpleNamespace(quarter=[2], sigma=[1], delta=[at])  # type: ignore[attr-defined]
        if taken:
            assert balls.roots(sine, 1)[2][0].contains(0)
        else:
            with pytest.raises(Unproven, match="does not lie near its asymptote"):
                balls.roots(sine, 1)


@pytest.mark.parametrize("curvature", [-1, 1])
@pytest.mark.parametrize("factor", [-7, 0, 7])
def test_the_growth_rate_of_a_limit_rises_where_its_branch_bends_upwards(curvature: int, factor: int) -> None:
    """F = (s − f(p)) (1 + c (s − s₀)), whose zero is s = f(p) whatever c: an onset where f″ > 0, and only there."""
    slope = 3
    t = {(1, 0): -slope, (0, 1): 1, (2, 0): Fraction(-curvature, 2), (1, 1): -factor * slope, (0, 2): factor}
    limit = beam_itself.VanishingDamping(Beam(beck), Fraction(0))
    taylor = {order: arb(balls.exact(Fraction(value))) for order, value in t.items()}
    if curvature > 0:
        limit.onset([arb(1), arb(1)], taylor)
    else:
        with pytest.raises(Unproven, match="a restabilisation"):
            limit.onset([arb(1), arb(1)], taylor)


@pytest.mark.parametrize("factor", ["-70", "-0.01", "0.01", "70"])
@pytest.mark.parametrize("rises", [True, False])
def test_the_direction_of_a_crossing_is_that_of_the_branch_whatever_the_function_is_multiplied_by(
    factor: str, rises: bool
) -> None:
    """F = a (s² + c p) parts into a complex pair, a (s + c p) into s < 0, a (s + c p w) grows with w: where c > 0."""
    a, c = arb(factor), 3 if rises else -3
    asked: list[tuple[Any, dict[Any, Any]]] = [
        (beam_itself.Coalescence(Beam(beck)), {(0, 2): a, (1, 0): a * c}),
        (beam_itself.Static(Beam(beck)), {(0, 1): a, (1, 0): a * c}),
        (object.__new__(beam_itself.VanishingRates), {(0, 1, 0): a, (1, 0, 0): a * 0, (1, 0, 1): a * c, (0, 1, 1): a}),
    ]
    for problem, taylor in asked:
        if rises:
            problem.onset([arb(1), arb(1)], taylor)
        else:
            with pytest.raises(beam_itself.NoOnset):
                problem.onset([arb(1), arb(1)], taylor)


def test_conditions_are_solved_for_derivatives_that_no_load_and_no_frequency_takes_away() -> None:
    """Of two conditions at x = 0 those two derivatives whose determinant is one number, other than zero."""
    one, load, mass, zero = (Coefficient(*map(arb, of)) for of in ((1, 0, 0), (0, 1, 0), (0, 0, 1), (0, 0, 0)))
    beam: Any = object.__new__(Beam)
    for rows, pivots in (
        (({3: one}, {2: one}), (3, 2)),
        (({3: one, 2: load}, {2: one}), (3, 2)),
        (({3: one, 2: load}, {3: load, 2: one}), None),
        (({3: one, 2: load}, {3: mass, 2: one}), None),
        (({3: one, 2: load, 1: one}, {3: load, 2: one, 0: one}), (3, 0)),
        (({3: one, 2: mass}, {3: mass, 2: one, 1: one}), (3, 1)),
        (({3: one, 2: one}, {3: one, 2: one}), None),
        (({3: load, 1: one}, {2: mass, 0: one}), (1, 0)),
        (({3: one, 2: zero}, {1: one}), (3, 1)),
    ):
        beam._parts = lambda rows=rows: SimpleNamespace(left=rows)
        beam.name = "one"
        if pivots is None:
            with pytest.raises(NoSeries):
                beam.pivots()
        else:
            assert beam.pivots() == pivots
