"""Shafts that turn, the speed the load: internal damping, seen from rest, acts on displacements. Against closed forms.

With w = y + iz, from rest: M ẅ + internal (ẇ − iΩ w) + external ẇ + K w = 0. A whirl w ~ e^(iωt) of the frequency ω of
a mode is lost at Ω = ω (1 + external/internal), both as shares of that mode (Jeffcott; Bolotin, 1963, chapter 3; Genta,
Dynamics of Rotating Systems, 2005, section 3.4).
"""

from __future__ import annotations

import json
import math
import tempfile
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from mpmath import det, findroot, matrix, mpc, mpf, workdps

import freebeam as fb
from freebeam.explorer import page
from freebeam_derive.certify import verifier
from freebeam_sym.stability.general import General

HEAD = """
from sympy import Symbol
from freebeam_derive.notation import P, alpha, beta, t, x, y
from freebeam_derive.statement import Column, Coordinate, Field, Parameter, at, delta, integral
z, q, p = Field("z"), Coordinate("q"), Coordinate("p")
r, k = Symbol("r", real=True), Symbol("k", real=True)
pinned = {y: ("pinned", "pinned"), z: ("pinned", "pinned")}

def bent(f):
    return f.diff(x, 2)
"""
STATED = {
    "shaft": """
V = integral(bent(y) ** 2 + bent(z) ** 2) / 2
T = integral(y.diff(t) ** 2 + z.diff(t) ** 2 + r * (y.diff(x, t) ** 2 + z.diff(x, t) ** 2)) / 2
internal = (bent(y).diff(t) + P * bent(z)) * delta(bent(y)) + (bent(z).diff(t) - P * bent(y)) * delta(bent(z))
discs = 2 * r * P * (z.diff(x, t) * delta(y.diff(x)) - y.diff(x, t) * delta(z.diff(x)))
external = y.diff(t) * delta(y) + z.diff(t) * delta(z)
column = Column(
    "shaft", "a shaft that turns, from rest", T, V, dW_nc=-integral(alpha * internal + discs + beta * external),
    ends=pinned, parameters=(Parameter(r, "radius of gyration, squared", 0, 0, 1),),
)
""",
    "turning shaft": """
V = integral(bent(y) ** 2 + bent(z) ** 2) / 2
Y, Z = y.diff(t) - P * z, z.diff(t) + P * y
internal = bent(y).diff(t) * delta(bent(y)) + bent(z).diff(t) * delta(bent(z))
column = Column(
    "turning-shaft", "a shaft that turns, as it sees itself", integral(Y**2 + Z**2) / 2, V,
    dW_nc=-integral(alpha * internal + beta * (Y * delta(y) + Z * delta(z))), ends=pinned,
)
""",
    "disc": """
internal = (q.diff(t) + P * p) * delta(q) + (p.diff(t) - P * q) * delta(p)
column = Column(
    "disc", "Jeffcott's rotor, from rest", (q.diff(t) ** 2 + p.diff(t) ** 2) / 2, k * (q**2 + p**2) / 2,
    dW_nc=-alpha * internal - beta * (q.diff(t) * delta(q) + p.diff(t) * delta(p)),
    parameters=(Parameter(k, "stiffness", 4, 0, 100),),
)
""",
    "turning disc": """
Q, R = q.diff(t) - P * p, p.diff(t) + P * q
column = Column(
    "turning-disc", "Jeffcott's rotor, as it sees itself", (Q**2 + R**2) / 2, k * (q**2 + p**2) / 2,
    dW_nc=-alpha * (q.diff(t) * delta(q) + p.diff(t) * delta(p)) - beta * (Q * delta(q) + R * delta(p)),
    parameters=(Parameter(k, "stiffness", 4, 0, 100),),
)
""",
    "turning beck": """
Y, Z = y.diff(t) - r * z, z.diff(t) + r * y
internal = bent(y).diff(t) * delta(bent(y)) + bent(z).diff(t) * delta(bent(z))
follower = at(y.diff(x), 1) * at(delta(y), 1) + at(z.diff(x), 1) * at(delta(z), 1)
column = Column(
    "turning-beck", "a clamped shaft that turns, as it sees itself, under a follower force",
    integral(Y**2 + Z**2) / 2, integral(bent(y) ** 2 + bent(z) ** 2) / 2,
    P * integral(y.diff(x) ** 2 + z.diff(x) ** 2) / 2,
    -P * follower - integral(alpha * internal + beta * (Y * delta(y) + Z * delta(z))),
    ends={y: ("clamped", "free"), z: ("clamped", "free")}, parameters=(Parameter(r, "speed", 1, 0, 3),),
)
""",
    "unequal disc": """
internal = (q.diff(t) + P * p) * delta(q) + (p.diff(t) - P * q) * delta(p)
column = Column(
    "unequal-disc", "Jeffcott's rotor on unequal bearings", (q.diff(t) ** 2 + p.diff(t) ** 2) / 2,
    2 * q**2 + 2 * (1 + k) * p**2, dW_nc=-alpha * internal - beta * (q.diff(t) * delta(q) + p.diff(t) * delta(p)),
    parameters=(Parameter(k, "by how much one bearing is stiffer", 0, 0, 1),),
)
""",
    "held by alpha": """
column = Column(
    "held-by-alpha", "Beck's column on what alpha holds", integral(y.diff(t) ** 2) / 2, integral(bent(y) ** 2) / 2,
    P * integral(y.diff(x) ** 2) / 2,
    -P * at(y.diff(x), 1) * at(delta(y), 1) - alpha * at(y, 1) * at(delta(y), 1),
    ends=("clamped", "free"),
)
""",
}


@cache
def column(name: str) -> fb.Column:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "column.py"
        path.write_text(HEAD + STATED[name])
        return fb.column(str(path))


@pytest.mark.parametrize("inner, outer", [(0.1, 0.3), (0.5, 0.5), (0.02, 0.0), (1e-6, 3e-6)])
def test_jeffcotts_rotor_is_lost_where_damping_says(inner: float, outer: float) -> None:
    """ω = 2. From its own frame the whirl is slower by the speed, a divergence or none without external damping."""
    wanted = 2 * (1 + outer / inner)
    slopes = {"alpha": -2 * outer / inner**2, "beta": 2 / inner, "k": wanted / 8}
    for name, frequency in (("disc", 2.0), ("turning disc", wanted - 2)):
        found = fb.critical_load(column(name), 1, inner, outer, load_max=100)
        assert found.load == pytest.approx(wanted, rel=1e-8)
        assert found.frequency == pytest.approx(frequency, rel=1e-7, abs=1e-7)
        for parameter, slope in found.gradient.items():
            if not (outer == 0 and name == "turning disc" and parameter == "beta"):
                assert slope == pytest.approx(slopes[parameter], rel=1e-6, abs=1e-6 * wanted)


def test_without_internal_damping_no_speed_is_too_high() -> None:
    """At the critical speed two motions are lost at once with internal damping alone, by external damping no more as
    divergences: by that the speed has no derivative there."""
    for name in ("disc", "turning disc"):
        for outer in (0.0, 0.2):
            found = fb.critical_load(column(name), 1, 0.0, outer, load_max=50)
            assert found.kind == "none"
    touches = fb.critical_load(column("turning disc"), 1, load_max=50).touches
    assert [(t.load, t.frequency) for t in touches] == [(pytest.approx(2), 0)]  # the critical speed
    both = fb.critical_load(column("turning disc"), 1, 0.1)
    assert math.isnan(both.gradient["beta"]) and both.gradient["k"] == pytest.approx(1 / 4)


def test_a_shaft_is_lost_at_one_speed_from_rest_and_as_it_sees_itself() -> None:
    alpha, beta = 0.01, 0.3
    rest, own = (fb.critical_load(column(name), 8, alpha, beta) for name in ("shaft", "turning shaft"))
    wanted = math.pi**2 * (1 + beta / (alpha * math.pi**4))
    assert rest.load == pytest.approx(wanted, rel=1e-8) and own.load == pytest.approx(rest.load, rel=1e-11)
    alphas = np.linspace(0.01, 0.05, 60)
    mapped = fb.critical_loads(column("shaft"), 8, alphas, beta)
    assert mapped.load == pytest.approx(math.pi**2 * (1 + beta / (alphas * math.pi**4)), rel=1e-8)
    assert rest.frequency is not None and own.frequency == pytest.approx(rest.load - rest.frequency, rel=1e-9)
    for parameter, slope in rest.gradient.items():
        if parameter != "r":
            assert own.gradient[parameter] == pytest.approx(slope, rel=1e-7)


def test_both_frames_are_proven_to_be_lost_at_that_speed() -> None:
    lost = []
    for name in ("shaft", "turning shaft"):
        found = fb.certified_load(column(name), 3, alpha="1/100", beta="3/10", digits=10)
        said = verifier.verify(json.loads(json.dumps(found.unverified)))
        assert found.proof["first"] and found.load is not None and said.load is not None
        lost.append([float(v) for v in found.load])
    assert max(low for low, _ in lost) < min(high for _, high in lost)
    exact = fb.exact_load(column("shaft"), alpha="1/100", beta="3/10", digits=10)
    low, high = (float(v) for v in exact.load)
    assert low <= math.pi**2 * (1 + 30 / math.pi**4) <= high and not exact.proof["first"]
    assert "acts on displacements" in exact.missing


def test_each_mode_is_lost_at_its_own_speed() -> None:
    """ωₙ (1 + β/(α ωₙ²)) of the series' own frequencies, each with both of its planes."""
    alpha, beta = 0.01, 2.0
    M, _, K = column("shaft").coefficients(3)
    squares = np.unique(np.linalg.eigvals(np.linalg.solve(M[0], K[0])).real.round(6))
    wanted = sorted(w * (1 + beta / (alpha * w**2)) for w in np.sqrt(squares))
    found = fb.certified_crossings(column("shaft"), 3, alpha="0.01", beta="2", load_max=int(wanted[-1]) + 1, digits=8)
    assert [float(c.load[0]) for c in found] == pytest.approx(wanted, rel=1e-7)
    assert [c.unstable_above for c in found] == [2, 4, 6]


@pytest.mark.parametrize("beta", [0.0, 0.3])
def test_a_shaft_with_rotary_inertia_is_lost_at_its_forward_whirl(beta: float) -> None:
    """Rayleigh's shaft, k = π: ω² (1 + r k²) − 2 r k² Ω ω − k⁴ = 0, and Ω = s ω with s = 1 + β/(α k⁴). Without external
    damping that is its first critical speed, k²/√(1 − r k²)."""
    alpha, r, k = 0.01, 0.02, math.pi
    s = 1 + beta / (alpha * k**4)
    omega = k**2 / math.sqrt(1 + r * k**2 - 2 * r * k**2 * s)
    found = fb.critical_load(column("shaft"), 10, alpha, beta, r=r)
    assert found.load == pytest.approx(s * omega, rel=1e-9) and found.frequency == pytest.approx(omega, rel=1e-9)


def test_the_critical_speeds_of_a_shaft_without_damping_are_its_frequencies() -> None:
    """As it sees itself K is singular there, at (n π)², but rates hold it: no stability is lost."""
    found = fb.critical_load(column("turning shaft"), 12, load_max=100)
    assert found.kind == "none" and all(touch.frequency == 0 for touch in found.touches)
    assert [touch.load for touch in found.touches] == pytest.approx([(n * math.pi) ** 2 for n in (1, 2, 3)], rel=1e-8)


def test_what_a_damping_does_on_a_displacement_is_a_stiffness() -> None:
    """A spring of the size alpha at the tip."""
    for stiffness in (0.0, 10.0):
        found = fb.critical_load(column("held by alpha"), 10, stiffness)
        tip = fb.critical_load(fb.column("tip-spring"), 10, k=stiffness)
        assert found.load == pytest.approx(tip.load, rel=1e-10) and found.kind == tip.kind
        assert found.gradient["alpha"] == pytest.approx(tip.gradient["k"], rel=1e-6)


@pytest.mark.parametrize("kappa", [0.0, 3.0])
def test_jeffcotts_rotor_in_the_limit_of_vanishing_damping(kappa: float) -> None:
    """2 (1 + κ), whichever frame it is seen from; as it sees itself, without external damping, a divergence."""
    wanted = 2 * (1 + kappa)
    for name, frequency in (("disc", 2.0), ("turning disc", wanted - 2)):
        found = fb.critical_load(column(name), 1, kappa=kappa, load_max=100)
        assert found.load == pytest.approx(wanted, rel=max(found.rounding, 4e-16)) and found.rounding < 1e-12
        assert found.frequency == pytest.approx(frequency, abs=1e-12)
        assert found.gradient["k"] == pytest.approx(wanted / 8, rel=1e-8)  # √k/8 of k = 4
        assert math.isnan(found.gradient["alpha"]) and math.isnan(found.gradient["beta"])


def test_a_shaft_in_the_limit_of_vanishing_damping() -> None:
    """ω (1 + κ/ω²) of the first mode; with rotary inertia, which turns motions, as of a damping of any size above."""
    kappa, r, k = 30.0, 0.02, math.pi
    s = 1 + kappa / k**4
    for name in ("shaft", "turning shaft"):
        found = fb.critical_load(column(name), 8, kappa=kappa, load_max=60)
        assert found.load == pytest.approx(k**2 * s, rel=1e-10)
    assert found.beam is not None and found.beam.load == pytest.approx(k**2 * s, rel=1e-12)

    def rayleigh(r: float) -> float:
        return s * k**2 / math.sqrt(1 + r * k**2 - 2 * r * k**2 * s)

    turned = fb.critical_load(column("shaft"), 10, kappa=kappa, r=r, load_max=60)
    assert turned.load == pytest.approx(rayleigh(r), rel=1e-12)
    assert turned.gradient["r"] == pytest.approx((rayleigh(r + 1e-5) - rayleigh(r - 1e-5)) / 2e-5, rel=1e-6)


@pytest.mark.parametrize("kappa", [0.0, 5.0])
def test_loads_of_little_damping_go_to_the_limit_with_its_square(kappa: float) -> None:
    """Of a gyroscopic column under a follower force, by its determinant at 60 digits; and of its float loads."""
    of, own = column("turning beck"), {"r": 0.5}
    found = fb.critical_load(of, 2, kappa=kappa, load_max=60, **own)
    assert found.load is not None and found.frequency is not None and found.kind == "flutter"
    bare, inner, outer = (of.coefficients(2, **given, **own) for given in ({}, {"alpha": 1.0}, {"beta": 1.0}))

    def load(size: mpf) -> mpf:
        def at(part: int, P: mpf) -> matrix:
            n = len(bare.M[0])
            total = matrix(n, n)
            for share, terms in ((1 - size - kappa * size, bare), (size, inner), (kappa * size, outer)):
                for power, X in enumerate(terms[part]):
                    total += share * P**power * matrix(X.tolist())
            return total

        def both(P: mpf, w: mpf) -> tuple[mpf, mpf]:
            value = det(at(2, P) + mpc(0, w) * at(1, P) - w**2 * at(0, P))
            return value.real, value.imag

        return findroot(both, (mpf(found.load), mpf(found.frequency)), tol=mpf(10) ** -50)[0]

    with workdps(60):
        limit, once, half = (load(mpf(size)) for size in ("1e-16", "1e-3", "5e-4"))
        assert abs(found.load / limit - 1) < max(found.rounding, 4e-16) and found.rounding < 1e-13
        assert abs((once - limit) / (half - limit) - 4) < 1e-3
        assert fb.critical_load(of, 2, 1e-3, kappa * 1e-3, **own).load == pytest.approx(float(once), rel=1e-10)


def test_what_rounding_cannot_tell_from_one_frequency_is_refused_in_the_limit() -> None:
    """On equal bearings a whirl is lost at 2 (1 + κ); on unequal ones a vanishing damping lets no motion grow."""
    of = column("unequal disc")
    assert fb.critical_load(of, 1, kappa=1.0, load_max=100).load == pytest.approx(4)
    assert fb.critical_load(of, 1, kappa=1.0, load_max=100, k=1e-6).kind == "none"
    with pytest.raises(fb.InputError, match="one but for rounding"):
        fb.critical_load(of, 1, kappa=1.0, load_max=100, k=1e-12)


def test_a_limit_beside_rates_is_refused_where_a_damper_stays_or_a_mass_is_missing() -> None:
    own = fb.column("pipe")
    with pytest.raises(fb.InputError, match="damper of its own, which stays"):
        fb.critical_load(own, 4, kappa=0.0)
    M, one, turn = np.diag([1.0, 0.0]), np.eye(2), np.array([[0.0, 1.0], [-1.0, 0.0]])
    with pytest.raises(fb.InputError, match="some motion has no mass; give small alpha and beta"):
        General([M], [one], [one], True, [turn], [])


def test_what_is_not_served_is_refused_in_one_line() -> None:
    without = fb.critical_load(column("held by alpha"), 10)
    held = fb.critical_load(column("held by alpha"), 10, kappa=0.0)  # a spring that vanishes
    assert held.load == pytest.approx(without.load, rel=held.rounding) and held.rounding < 1e-4
    with pytest.raises(fb.InputError, match="acts on displacements alone"):
        fb.certified_load(column("held by alpha"), 3, kappa=0)
    with pytest.raises(fb.InputError, match="acts on displacements"):
        fb.exact_range(column("held by alpha"), "alpha", "1", "2")
    assert not fb.exact_load(column("held by alpha"), alpha="1", digits=4).proof["first"]
    with pytest.raises(fb.InputError, match="acts on displacements is not drawn"):
        page(column("shaft"))
