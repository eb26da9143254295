"""Critical loads that any code for these columns should find, each with the statement that gives its digits.

V and T are potential and kinetic energy, δW the virtual work of the rest, for y(x, t) on 0 ≤ x ≤ 1; m = EI = 1 and no
damping unless said, P the load. All is nondimensional. `ISSUE` are the values of issue 13, `OWN` were computed here.
Beck's column: T = ∫ẏ²/2, V = ∫y''²/2 − P∫y'²/2, δW = −P y'(1) δy(1), clamped at 0 and free at 1. α: C = αE of the
bending energy. β: δW = −β∫m ẏ δy. Kinds: "coalescence", two frequencies of an undamped column meet; "flutter", λ = iω
is an eigenvalue of a damped or gyroscopic column; "divergence", λ = 0 is one.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from fractions import Fraction as Q
from typing import Any

from tests.reference.systems import At, Beam, Segment, Term, energy, exp, follower, root, uniform

HALF, TENTH = Q(1, 2), Q(1, 10)
TIP, TIP_SLOPE = At("y", Q(1)), At("slope", Q(1))


@dataclass(frozen=True)
class Value:
    """One critical load, the first; `printed` is rounded and holds in all its digits."""

    name: str
    statement: str
    kind: str
    printed: str
    beam: Beam

    @property
    def places(self) -> int:
        """Digits behind the point."""
        return len(self.printed.partition(".")[2])


def squeezed(x: Any, P: Any) -> Any:
    return uniform(P, x)


PRESSED = Segment(axial=squeezed)
BECK = Beam((PRESSED,), terms=(follower(),))


def beck(*terms: Term, **changes: Any) -> Beam:
    """Beck's column with more terms, or with other coefficients of its one segment."""
    return replace(BECK, segments=(replace(PRESSED, **changes),), terms=(*BECK.terms, *terms))


def split(place: Q, *terms: Term, left: Any = None, right: Any = None) -> Beam:
    """Beck's column in two segments, each with its changes."""
    parts = (
        replace(PRESSED, high=place, **(left or {})),
        replace(PRESSED, low=place, **(right or {})),
    )
    return replace(BECK, segments=parts, terms=(*BECK.terms, *terms))


def beal(place: Q, k: Q = TENTH) -> Beam:
    """Free-free, driven at x = 1 by a thrust P turned by k·y'(place): N = P x."""
    turned = Term(TIP, At("slope", place), stiffness=lambda P: P * k)
    return Beam((Segment(axial=lambda x, P: x * P),), ("free", "free"), (follower(), turned), rigid=1)


def panel(*ends: str) -> Beam:
    return Beam((Segment(flow=squeezed),), (ends[0], ends[1]))


def dead(*ends: str) -> Beam:
    return Beam((PRESSED,), (ends[0], ends[1]))


def pipe(ratio: Q, foundation: Q = Q(0)) -> Beam:
    """The load is u: y'''' + u² y'' + 2 √ratio u ẏ' + ÿ + foundation·y = 0, y'' = y''' = 0 at the free end."""
    part = Segment(
        axial=lambda x, u: uniform(u * u, x),
        gyro=lambda x, u: uniform(u * root(ratio, u) * 2, x),
        spring=constant(foundation),
    )
    return Beam((part,), terms=(follower(share=lambda u: u * u),))


def absorber(place: Q, mass: Q, spring: Q, damper: Q) -> tuple[Term, ...]:
    """T = mass·q̇²/2, and a spring and damper between the beam and the coordinate q."""
    q = At("q")
    return energy([(q, 1)], mass) + energy([(At("y", place), 1), (q, -1)], damping=damper, spring=spring)


def timoshenko(stiffness: Q, rotary: Q, sees: str) -> Beam:
    part = replace(PRESSED, rotary=constant(rotary))
    return Beam((part,), terms=(follower(sees=sees),), shear=stiffness)


def constant(of: Q) -> Callable[[Any], Any]:
    return lambda x: uniform(of, x)


def taper(power: int) -> Callable[[Any], Any]:
    return lambda x: (1 - x * HALF) ** power


LEIPHOLZ = Segment(axial=lambda x, q: (1 - x) * q, flow=squeezed)
HAUGER = Segment(axial=lambda x, q: (1 - x) ** 2 * q * HALF, flow=lambda x, q: (1 - x) * q)
ROOT_SLOPE = At("slope", Q(0))
MASS = energy([(TIP, 1)], Q(1))

ISSUE = (
    Value("pflueger", "Beck and T += μẏ(1)²/2, μ = 1.", "coalescence", "16.2121289425", beck(*MASS)),
    Value(
        "pflueger, beam damped",
        "Pflüger's with μ = 1; δW += −β∫ẏ δy dx, β = 0.5: the mass is not damped.",
        "flutter",
        "16.1235358663",
        beck(*MASS, damping=constant(HALF)),
    ),
    Value(
        "rotary tip mass",
        "Beck and T += μẏ(1)²/2 + Jẏ'(1)²/2, μ = 1, J = 0.1.",
        "coalescence",
        "8.8696660652",
        beck(*MASS, *energy([(TIP_SLOPE, 1)], TENTH)),
    ),
    Value(
        "mass at mid-span",
        "Beck and T += ẏ(1/2)²/4: a mass 1/2.",
        "coalescence",
        "22.8770428843",
        beck(*energy([(At("y", HALF), 1)], HALF)),
    ),
    Value(
        "tip spring 10",
        "Beck and V += k y(1)²/2, k = 10.",
        "coalescence",
        "24.2240402684",
        beck(*energy([(TIP, 1)], spring=Q(10))),
    ),
    Value(
        "tip spring 35",
        "Beck and V += k y(1)²/2, k = 35.",
        "divergence",
        "32.0547602231",
        beck(*energy([(TIP, 1)], spring=Q(35))),
    ),
    Value(
        "elastic root",
        "Beck, but pinned at 0 with V += k y'(0)²/2, k = 5.",
        "coalescence",
        "16.6761695961",
        replace(beck(*energy([(ROOT_SLOPE, 1)], spring=Q(5))), ends=("pinned", "free")),
    ),
    Value(
        "free-free with a point mass",
        "Free at both ends, T += μẏ(0)²/2, μ = 1/2, V −= ∫N y'²/2, N = P(x + μ)/(1 + μ), δW = −P y'(1) δy(1).",
        "divergence",
        "45.4509031990150885",
        Beam(
            (Segment(axial=lambda x, P: (x + HALF) * P * Q(2, 3)),),
            ("free", "free"),
            (follower(), *energy([(At("y"), 1)], HALF)),
            rigid=2,
        ),
    ),
    *(
        Value(
            f"beal, sensor at {place}",
            f"Free at both ends, V −= ∫P x y'²/2, δW = −P (y'(1) + k y'({place})) δy(1), k = 0.1. Translation is "
            "left out (a factor λ² of F); the rotation stays.",
            "divergence",
            "25.6381813768019637",
            beal(place),
        )
        for place in (Q(0), Q(1, 4), HALF, Q(1))
    ),
    Value(
        "taper",
        "Beck with EI = (1 − x/2)³, m = 1 − x/2.",
        "coalescence",
        "8.4207877434",
        beck(EI=taper(3), mass=taper(1)),
    ),
    Value(
        "cone",
        "Beck with EI = (1 − x/2)⁴, m = (1 − x/2)².",
        "coalescence",
        "6.50560305109434",
        beck(EI=taper(4), mass=taper(2)),
    ),
    Value(
        "step",
        "Beck with EI = 1 up to x = 1/2, then 1/2; m = 1.",
        "coalescence",
        "12.7155928090377",
        split(HALF, right={"EI": constant(HALF)}),
    ),
    Value(
        "tip damper",
        "Beck and δW += −c ẏ(1) δy(1), c = 1/2. Nothing else is damped, so no c > 0 changes the load.",
        "flutter",
        "16.0524615771634",
        beck(*energy([(TIP, 1)], damping=HALF)),
    ),
    Value(
        "weight",
        "Beck and V −= g∫(1 − x) y'²/2, g = 3: it stands upright on its clamped end.",
        "coalescence",
        "19.0417033100",
        beck(axial=lambda x, P: (1 - x) * 3 + P),
    ),
    Value(
        "dead load beside",
        "Beck and V −= W∫y'²/2, W = 1: W keeps its direction, N = P + W.",
        "coalescence",
        "18.2946320604",
        beck(axial=lambda x, P: uniform(P + 1, x)),
    ),
    Value(
        "foundation",
        "Beck and V += k∫y²/2, k = 100, α = 0.01 on ∫y''²/2 alone, β = 0.1.",
        "flutter",
        "13.0572701169",
        replace(beck(spring=constant(Q(100)), damping=constant(TENTH)), alpha=Q(1, 100)),
    ),
    Value(
        "pipe",
        "y'''' + u² y'' + 2 √b u ẏ' + ÿ = 0, b = 0.1, clamped and free (y'' = y''' = 0). The load is u. "
        "The issue prints …7312 in place of …7311(34).",
        "flutter",
        "4.74989677311",
        pipe(TENTH),
    ),
    Value("panel, pinned", "y'''' + P y' + ÿ = 0, pinned.", "coalescence", "343.356426280", panel("pinned", "pinned")),
    Value(
        "panel, clamped", "y'''' + P y' + ÿ = 0, clamped.", "coalescence", "636.569131260", panel("clamped", "clamped")
    ),
    Value(
        "panel, cantilevered",
        "y'''' + P y' + ÿ = 0, clamped at 0 and free at 1.",
        "coalescence",
        "135.341758311",
        panel("clamped", "free"),
    ),
    Value(
        "gravity",
        "V = ∫y''²/2 − P∫(1 − x) y'²/2, clamped at 0 and free at 1: P is the whole weight.",
        "divergence",
        "7.83734743894",
        Beam((Segment(axial=lambda x, P: (1 - x) * P),)),
    ),
    Value("euler, pinned", "V −= P∫y'²/2, pinned: π².", "divergence", "9.86960440109", dead("pinned", "pinned")),
    Value("euler, clamped", "V −= P∫y'²/2, clamped: 4π².", "divergence", "39.4784176044", dead("clamped", "clamped")),
    Value(
        "euler, clamped and pinned",
        "V −= P∫y'²/2, clamped at 0 and pinned at 1: tan √P = √P.",
        "divergence",
        "20.1907285564",
        dead("clamped", "pinned"),
    ),
    Value(
        "euler, cantilever",
        "V −= P∫y'²/2, clamped at 0 and free at 1: π²/4.",
        "divergence",
        "2.46740110027",
        dead("clamped", "free"),
    ),
    Value(
        "rayleigh",
        "Beck and T += r∫ẏ'²/2, r = 0.01.",
        "coalescence",
        "18.1684874096",
        beck(rotary=constant(Q(1, 100))),
    ),
)

CRACK, SHEARED = At("jump slope", Q(2, 5)), At("jump y", HALF)

OWN = (
    Value(
        "beck",
        "T = ∫ẏ²/2, V = ∫y''²/2 − P∫y'²/2, δW = −P y'(1) δy(1).",
        "coalescence",
        "20.050953618974",
        BECK,
    ),
    Value(
        "reut",
        "T and V as Beck's, δW = −P y(1) δy'(1): the force stays on the line y = 0.",
        "coalescence",
        "20.050953618974",
        Beam((PRESSED,), terms=(Term(TIP_SLOPE, TIP, stiffness=lambda P: P),)),
    ),
    Value(
        "free-free",
        "Free at both ends, V = ∫y''²/2 − ∫P x y'²/2, δW = −P y'(1) δy(1).",
        "coalescence",
        "109.68919195874",
        Beam((Segment(axial=lambda x, P: x * P),), ("free", "free"), (follower(),), rigid=2),
    ),
    Value(
        "crack",
        "Beck and V += k [y'](2/5)²/2, k = 10, [·] the jump: a rotational spring inside.",
        "coalescence",
        "16.994377060550",
        beck(*energy([(CRACK, 1)], spring=Q(10))),
    ),
    Value(
        "elastic hinge at mid-span",
        "Beck and V += k [y'](1/2)²/2, k = 2.",
        "coalescence",
        "8.6850375767349",
        beck(*energy([(At("jump slope", HALF), 1)], spring=Q(2))),
    ),
    Value(
        "shear joint",
        "Beck and V += k [y](1/2)²/2, k = 50.",
        "coalescence",
        "15.255492277668",
        beck(*energy([(SHEARED, 1)], spring=Q(50))),
    ),
    Value(
        "leipholz",
        "V = ∫y''²/2 − P∫(1 − x) y'²/2, δW = −P∫y' δy: y'''' + P(1 − x) y'' + ÿ = 0.",
        "coalescence",
        "40.053736514940",
        Beam((LEIPHOLZ,)),
    ),
    Value(
        "hauger",
        "V = ∫y''²/2 − P∫(1 − x)² y'²/4, δW = −P∫(1 − x) y' δy: y'''' + P(1 − x)² y''/2 + ÿ = 0.",
        "coalescence",
        "150.64159540449",
        Beam((HAUGER,)),
    ),
    Value(
        "follower at 7/10",
        "V = ∫y''²/2 − P∫y'²/2 over 0 < x < 7/10, δW = −P y'(7/10) δy(7/10).",
        "coalescence",
        "21.433028408332",
        Beam(
            (replace(PRESSED, high=Q(7, 10)), Segment(low=Q(7, 10))),
            terms=(follower(Q(7, 10)),),
        ),
    ),
    Value(
        "step with a mass",
        "Beck with EI = m = 1 up to x = 3/5, then EI = m = 1/2; T += 0.3 ẏ(3/5)²/2.",
        "coalescence",
        "25.919950122601",
        split(
            Q(3, 5),
            *energy([(At("y", Q(3, 5)), 1)], Q(3, 10)),
            right={"EI": constant(HALF), "mass": constant(HALF)},
        ),
    ),
    Value(
        "absorber",
        "Beck with α = 0.01, β = 0.1; T += 0.1 q̇²/2, V += 5 (y(7/10) − q)²/2, damper 0.1 in parallel to that spring.",
        "flutter",
        "17.512540396912",
        replace(
            beck(*absorber(Q(7, 10), TENTH, Q(5), TENTH), damping=constant(TENTH)),
            alpha=Q(1, 100),
        ),
    ),
    Value(
        "pipe on a foundation",
        "y'''' + u² y'' + 2 √b u ẏ' + ÿ + 50 y = 0, b = 0.3, clamped and free. The load is u.",
        "flutter",
        "8.4376423464509",
        pipe(Q(3, 10), Q(50)),
    ),
    Value(
        "exponential taper",
        "Beck with EI = e^(−x), m = 1.",
        "coalescence",
        "12.237286729359",
        beck(EI=lambda x: exp(-x)),
    ),
    Value(
        "panel, clamped at its rear",
        "y'''' + P y' + ÿ = 0, free at 0 and clamped at 1.",
        "divergence",
        "6.3297031101732",
        panel("free", "clamped"),
    ),
    Value(
        "partial damping",
        "Beck with δW += −∫ẏ δy over 1/2 < x < 1: c = 1 on the outer half alone.",
        "flutter",
        "20.067842660665",
        split(HALF, right={"damping": constant(Q(1))}),
    ),
    Value(
        "force by a remote slope",
        "Beck and δW += −(P/5) y'(2/5) δy(1), with ∫y''²/2 damped, α = 0.01, and β = 0.1.",
        "flutter",
        "14.895892307888",
        replace(
            beck(Term(TIP, At("slope", Q(2, 5)), stiffness=lambda P: P / 5), damping=constant(TENTH)),
            alpha=Q(1, 100),
        ),
    ),
    *(
        Value(
            f"timoshenko, s = {s}, r = 1/{1 / r}, turning with {turns}",
            "T = ∫(ẏ² + r ψ̇²)/2, V = ∫(ψ'² + s(y' − ψ)²)/2 − P∫y'²/2, clamped (y = ψ = 0) at 0, free at 1, "
            f"δW = −P {turns}(1) δy(1). Shear s(y' − ψ) = 0 at the tip either way, so both have the same loads.",
            "coalescence",
            printed,
            timoshenko(s, r, sees),
        )
        for s, r, printed in ((Q(100), Q(1, 100), "14.391089106038"), (Q(1000), Q(1, 1000), "19.258001279356"))
        for turns, sees in (("ψ", "slope"), ("y'", "dy"))
    ),
)
