"""How far apart the high frequencies without load are, for the verifier: waves on segments and a rest that is bounded.

Of the verifier of certificates of the beam itself (`verifier_of_sections`); it shares no code with the prover. With
ω = γ², dz/dx = (m/EI)^(1/4), y = ρ w, ρ² = z'/m the equation of a segment is w'''' − (A w')' + H w = γ⁴ w in z. The
minors of u = (w, w'/γ, w''/γ², (w''' − A w')/γ³) of two solutions, times e^(−γz), go by

    ∂M/∂z = (γ K + E) M,   K normal with the eigenvalues ±i, −1, −1, −2 ± i,   ‖E‖ ≤ |A|/|γ| + |H|/|γ|³.

Joints multiply minors by polynomials in ε = 1/γ. So f(γ), a minor of the conditions at x = 1, is Σ B_σ(ε) e^(iσ·θ) and
a rest; cells of the phases θ show that no two zeros are near each other. docs/theorem.md, Lemma 9.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from functools import reduce
from itertools import combinations, product
from typing import Any

from flint import acb, acb_poly, arb, arb_poly, arb_series, fmpq_poly

from freebeam_derive.certify.verifier_claims import ORDERS, Refused, ball, greatest, least
from freebeam_derive.certify.verifier_sections import Sections

MINORS = tuple(combinations(range(4), 2))
TIMES = [
    Fraction(n, 2) for n in (5, 6, 8, 12, 16, 24, 48, 96, 192)
]  # zeros are to be so much less apart than on average
SHORTEST = [Fraction(n, 2) for n in (12, 18, 24, 36, 48)]  # γ L of the shortest segment, tried in turn: e^−6 = 0.002
FARTHEST = 2000  # γ L beyond which no G is looked for: below are more frequencies than are looked at one by one
CUTS = 3  # halvings of 1/γ
DEEPEST = 21  # halvings of phases: seven of each of three
MOST_WAVES = 400_000  # of cells together, in one look at all of them
COUPLED = arb(5) / 8  # ‖E‖/|ε A| between e^(iγz) and e^(−iγz): √2/4 on the diagonal and 1/4 beside it
Waves = dict[tuple[int, ...], list[Any]]
"""σ -> six polynomials in ε."""


def _wedge(a: list[acb], b: list[acb]) -> list[acb]:
    return [a[i] * b[j] - a[j] * b[i] for i, j in MINORS]


def _unit(turn: int) -> list[acb]:
    """The eigenvector of K of ±i: of u = (1, λ, λ², λ³)/2 for λ = 1 and λ = ±i."""
    one, other = ([acb(0, k) ** d / 2 if k else acb(1) / 2 for d in range(4)] for k in (0, turn))
    return _wedge(one, other)


UNITS: dict[int, list[acb]] = {sign: _unit(sign) for sign in (1, -1)}


class Segment:
    """length: in z. A, H: their largest size, and their integral over z. ends: what carries u, at either end, to
    (y, y', EI y'', −(EI y'')' + N y'), in units of powers of ε; N: an axial force that is there without load."""

    def __init__(self, column: Sections, n: int) -> None:
        self.length, self.A, self.H = arb(0), (arb(0), arb(0)), (arb(0), arb(0))
        for x, width in column.pieces(n):
            A, H, rate = _local(column, n, x)
            A, H = abs(A).upper(), abs(H).upper()
            self.length += rate * width
            self.A = self.A[0].max(A), (self.A[1] + A * rate * width).upper()
            self.H = self.H[0].max(H), (self.H[1] + H * rate * width).upper()
        self.ends = [_turned(column, n, ball(column.breaks[n + side])) for side in (0, 1)]


def _local(column: Sections, n: int, x: arb) -> tuple[arb, arb, arb]:
    """A, H and z' on a stretch. e = EI'/EI, f = m'/m, h = z''/z', r = ρ'/ρ; g₁ = a/z', g₀ = b/z'²."""
    m, EI = (_about(f, x) for f in (column.m[n], column.EI[n]))
    e, f = EI.derivative() / EI, m.derivative() / m
    h = (f - e) / 4
    r = (h - f) / 2
    a, b = 2 * r + h, r.derivative() + r * r
    rate = (m[0] / EI[0]).sqrt().sqrt()
    A = (a * a - a.derivative() + h * a - 2 * b)[0] / rate**2
    B = a * b - b.derivative() + 2 * h * b  # times z'^3
    H = (b[0] ** 2 - B.derivative()[0] + 3 * h[0] * B[0]) / rate**4
    for order, poly in column.elastic[n].items():
        share = _about(poly, x) / m
        if order:
            q = share * r
            A += share[0] * rate**2
            H += (q * r)[0] - q.derivative()[0] - (h * q)[0]
        else:
            H += share[0]
    return A, H, rate


def _about(f: fmpq_poly, x: arb) -> arb_series:
    """Its powers about a stretch, from those about the middle, which are sharper."""
    middle = f(fmpq_poly([x.mid().fmpq(), 1]))
    return arb_series(arb_poly(middle)(arb_poly([x - x.mid(), 1])).coeffs() or [0], prec=7)


def _turned(column: Sections, n: int, x: arb) -> list[list[arb]]:
    """Row i, column k: the factor of ε^(i−k) u_k in the i-th of the four, which are in units of γ^i."""
    A, _, _ = _local(column, n, x)
    m, EI = (_about(f, x) for f in (column.m[n], column.EI[n]))
    rate = (m / EI).sqrt().sqrt()
    z, rho = rate.integral(), (rate / m).sqrt()
    rows = [[arb(0)] * 4 for _ in range(4)]
    power, N = arb_series([1], prec=7), column.elastic[n].get(1, fmpq_poly([0]))
    for k in range(4):  # w = z^k/k!
        y = rho * power
        M = EI * y.derivative().derivative()
        values = [y[0], y[1], M[0], arb_poly(N)(x) * y[1] - M.derivative()[0]]
        for i in range(k, 4):
            rows[i][k] = values[i]
        power = power * z / (k + 1)
    rows[3][1] += rows[3][3] * A
    return rows


def _inverse(rows: list[list[arb]]) -> list[list[arb]]:
    """Of a matrix with nothing above the diagonal."""
    found = [[arb(0)] * 4 for _ in range(4)]
    for k in range(4):
        for i in range(k, 4):
            total = sum((rows[i][j] * found[j][k] for j in range(k, i)), arb(0))
            found[i][k] = (int(i == k) - total) / rows[i][i]
    return found


def _of_minors(rows: list[list[arb]]) -> list[list[arb_poly]]:
    """What a matrix as of `_turned` does to minors."""
    found = []
    for a, b in MINORS:
        line = []
        for c, d in MINORS:
            value, power = rows[a][c] * rows[b][d] - rows[a][d] * rows[b][c], a + b - c - d
            line.append(arb_poly([0] * power + [value]) if power >= 0 else arb_poly([]))
        found.append(line)
    return found


def _joint(columns: Sequence[Sections], node: int) -> list[list[arb_poly]]:
    """What springs, masses and a joint at a place do to minors, in balls that hold those of all columns.

    EI y'' jumps by (c − J ω²) y', −(EI y'')' + N y' by (k − μ ω²) y; times ε³ where J and times ε where μ is there. At
    a joint nothing acts on what jumps: y' by EI y'', or y by −(EI y'')' + N y', over its spring; times ε, or ε³.
    """
    tables = [column.springs for column in columns], [column.masses for column in columns]
    k, c, mu, J = (
        reduce(arb.union, (ball(t.get((node, d), Fraction(0))) for t in of)) for of in tables for d in (0, 1)
    )
    bend = arb_poly([0, c]) if J == 0 else arb_poly([-J, 0, 0, 0, c])
    push = arb_poly([0, 0, 0, k]) if mu == 0 else arb_poly([-mu, 0, 0, 0, k])
    by_turn, by_mass = (arb_poly([1]) if x == 0 else arb_poly([0] * n + [1]) for x, n in ((J, 3), (mu, 1)))
    joints = {at: reduce(arb.union, (ball(of.joints[at]) for of in columns)) for at in columns[0].joints}
    turned, moved = (2, 1), (3, 0)
    if (node, 1) in joints:
        turned, by_turn, bend = (1, 2), arb_poly([0, 1]), arb_poly([1 / joints[node, 1]])
    if (node, 0) in joints:
        moved, by_mass, push = (0, 3), arb_poly([0, 0, 0, 1]), arb_poly([1 / joints[node, 0]])
    found = []
    for i in MINORS:
        line = []
        for j in MINORS:
            # of I + a E + b E', each with a single 1, whose minors have a and b once at most
            at = {(a, b): _minor(i, j, {turned: a, moved: b}) for a in (0, 1) for b in (0, 1)}
            plain, by_a, by_b = at[0, 0], at[1, 0] - at[0, 0], at[0, 1] - at[0, 0]
            both = at[1, 1] - by_a - by_b - plain
            line.append(plain * by_turn * by_mass + by_a * bend * by_mass + by_b * push * by_turn + both * bend * push)
        found.append(line)
    return found


def _minor(rows: tuple[int, int], columns: tuple[int, int], more: dict[tuple[int, int], int]) -> int:
    X = [[int(i == j) + more.get((i, j), 0) for j in columns] for i in rows]
    return X[0][0] * X[1][1] - X[0][1] * X[1][0]


def _product(X: list[list[Any]], Y: list[list[Any]]) -> list[list[Any]]:
    columns = [*zip(*Y, strict=True)]
    return [[sum((a * b for a, b in zip(row, c, strict=True)), row[0] * 0) for c in columns] for row in X]


class Apart:
    """f of a column without load: its waves, what joins them, and bounds of the rest. Of two columns: f of each whose
    masses, springs and joints are between theirs, which differ in nothing else."""

    def __init__(self, *columns: Sections) -> None:
        column = columns[0]
        self.segments = [Segment(column, n) for n in range(len(column.m))]
        self.lengths = [s.length for s in self.segments]
        self.whole = sum(self.lengths, arb(0))
        self.same = [_first_alike(column, n) for n in range(len(self.segments))]
        last = len(self.segments)
        joints = []
        for node in range(last + 1):
            X = _joint(columns, node)
            if node:
                X = _product(X, _of_minors(self.segments[node - 1].ends[1]))
            if node < last:
                X = _product(_of_minors(_inverse(self.segments[node].ends[0])), X)
            joints.append([[acb_poly(p) for p in row] for row in X])
        start = [acb_poly([int(not {*pair} & {*_held(column, 0)})]) for pair in MINORS]
        self.joints = [*joints[:-1], [joints[-1][MINORS.index(_held(column, 1))]]]
        waves: Waves = {(): [line[0] for line in _product(self.joints[0], [[v] for v in start])]}
        self.stages = [waves]
        for joint in self.joints[1:]:
            grown = {(*wave, sign): _along(sign, z) for wave, z in waves.items() for sign in (1, -1)}
            waves = {wave: [line[0] for line in _product(joint, [[v] for v in z])] for wave, z in grown.items()}
            self.stages.append(waves)

    def gap(self, needed: Callable[[arb, arb], arb]) -> tuple[arb, arb]:
        """G, and a gap between any two neighbours ω ≥ G² that is wider than needed. Raises Refused.

        needed: for two ω; over the √ω of the upper one it does not rise, so that what serves at G serves beyond.
        """
        tried = []
        for times, phase in product(TIMES, SHORTEST):
            apart = arb.pi() / (ball(times) * self.whole)
            G = (ball(phase) / least(self.lengths)).upper()
            G = (needed(G**2, (G + apart) ** 2) * arb("1.001") / (2 * apart)).max(G).upper()
            while G * self.whole < FARTHEST and not apart * (2 * G + apart) > needed(G**2, (G + apart) ** 2):
                G = (G * arb(9) / 8).upper()
            if apart * (2 * G + apart) > needed(G**2, (G + apart) ** 2):
                tried.append((G, apart))
        for G, apart in sorted(tried, key=lambda pair: (float(pair[0]), float(pair[1]))):
            if self._all_apart(G, apart):
                return G, (apart * (2 * G + apart)).lower()
        raise Refused("the high frequencies are not known to be apart")

    def _all_apart(self, G: arb, apart: arb) -> bool:
        """Whether any two zeros of f beyond G are more than `apart` from each other, and each is simple."""
        waiting = [(arb(0), 1 / G, 0)]
        while waiting:
            low, high, depth = waiting.pop()
            if not self._cells_apart((low / (1 + low * apart)).union(high), (1 / high).lower(), apart):
                if depth == CUTS:
                    return False
                middle = (low + high) / 2
                waiting += [(low, middle, depth + 1), (middle, high, depth + 1)]
        return True

    def rest(self, G: arb, eta: arb) -> arb | None:
        """What |f − Σ B e^(iσ·θ)| is at most where Re γ ≥ G, |Im γ| ≤ eta; None where it is not known."""
        size = 1 / G
        epsilon = acb(arb(0).union(size), eta * size * size * arb(0, 1))
        rest, reached = arb(0), arb(0)
        for n, (segment, joint) in enumerate(zip(self.segments, self.joints[1:], strict=True)):
            more = (eta * reached).exp()
            main, other = arb(0), arb(0)
            for z in self.stages[n].values():
                values = [v(epsilon) for v in z]
                inside = [_dot(UNITS[sign], values) for sign in (1, -1)]
                main += sum((abs(v).upper() ** 2 for v in inside), arb(0)).sqrt() * more
                left = [v - sum((c * u[i] for c, u in zip(inside, UNITS.values(), strict=True)), acb(0))
                        for i, v in enumerate(values)]  # fmt: skip
                other += sum((abs(v).upper() ** 2 for v in left), arb(0)).sqrt() * more
            main, other = main + rest, other + rest
            E = [(segment.A[k] * size + segment.H[k] * size**3).upper() for k in (0, 1)]
            a = (COUPLED * segment.A[1] * size + segment.H[1] * size**3).upper()
            g = G - E[0]
            share = 1 - a - E[0] * E[1] / g
            if not (g > 0 and G > eta and share > 0):
                return None
            most = (main + E[0] * other / g) / share  # of the waves, at any z
            moved = a * most + E[0] / g * (other + E[1] * most)
            fallen = (-g * segment.length).exp() * other + E[0] / g * most
            rest = (eta * segment.length).exp() * (rest + moved + fallen)
            rest = (rest * _norm([[v(epsilon) for v in row] for row in joint])).upper()
            reached += segment.length
        return rest

    def waves(self, epsilon: arb) -> list[tuple[tuple[int, ...], acb, acb]]:
        """σ, and what e^(iσ·θ) is multiplied by in f and in its slope by γ: of two conjugate waves one, twice."""
        found = []
        for wave, (B,) in self.stages[-1].items():
            turn = sum((sign * L for sign, L in zip(wave, self.lengths, strict=True)), arb(0))
            if wave[0] > 0:
                value = 2 * B(epsilon)
                found.append((wave, value, acb(0, 1) * turn * value - 2 * epsilon**2 * B.derivative()(epsilon)))
        return found

    def _cells_apart(self, epsilon: arb, G: arb, apart: arb) -> bool:
        """Whether from each point of the phases on, up to `apart` further, f or its slope is not zero.

        Half a turn of a phase changes the sign of the waves alone, and the wave of −σ is the conjugate of that of σ.
        """
        eta = 1 / self.whole
        value, wide = self.rest(G, arb(0)), self.rest(G - eta, eta)
        if value is None or wide is None:
            return False
        blurs = [size * arb(0, 1) for size in (value, wide / eta)]  # of the slope by Cauchy's estimate
        kept, values, slopes = zip(*self.waves(epsilon), strict=True)
        own = sorted({*self.same})
        further = {n: self.lengths[n] * arb(0).union(apart) for n in own}
        cells, looked = [([(arb(0), arb(1))] * len(own), 0)], 0  # ends that halve exactly
        while cells:
            cell, depth = cells.pop()
            phases = {n: a.union(b) * arb.pi() + further[n] for n, (a, b) in zip(own, cell, strict=True)}
            on = [phases[n] for n in self.same]
            units = [acb(0, sum((s * v for s, v in zip(wave, on, strict=True)), arb(0))).exp() for wave in kept]
            both = (
                sum(((term * unit).real for term, unit in zip(terms, units, strict=True)), blur)
                for terms, blur in zip((values, slopes), blurs, strict=True)
            )
            if not all(total.contains(0) for total in both):
                continue
            looked += len(kept)
            if looked > MOST_WAVES:
                raise Refused("the segments are too many, or too unlike, for high frequencies to be told apart")
            if depth == DEEPEST:
                return False
            n = depth % len(cell)
            a, b = cell[n]
            for half in ((a, (a + b) / 2), ((a + b) / 2, b)):
                cells.append(([*cell[:n], half, *cell[n + 1 :]], depth + 1))
        return True


def _first_alike(column: Sections, n: int) -> int:
    """The first segment that is uniform and as long and of the same kind as the n-th: their phases are always one."""

    def kind(k: int) -> Any:
        factors = column.m[k], column.EI[k], *(column.elastic[k].get(order, fmpq_poly([])) for order in (0, 1))
        plain = all(f.degree() < 1 for f in factors)
        return (column.breaks[k + 1] - column.breaks[k], *map(str, factors)) if plain else k

    return next(k for k in range(n + 1) if kind(k) == kind(n))


def _held(column: Sections, end: int) -> tuple[int, ...]:
    return ORDERS[column.ends[end]]


def _dot(unit: list[acb], z: list[Any]) -> Any:
    return sum((u.conjugate() * v for u, v in zip(unit, z, strict=True)), z[0] * 0)


def _along(sign: int, z: list[Any]) -> list[Any]:
    """What of the minors is a wave."""
    size = _dot(UNITS[sign], z)
    return [u * size for u in UNITS[sign]]


def _norm(X: list[list[Any]]) -> arb:
    """What a matrix makes larger, at most: the smaller of two bounds."""
    sizes = [[abs(v).upper() for v in row] for row in X]
    whole = sum((v * v for row in sizes for v in row), arb(0)).sqrt().upper()
    rows, columns = (greatest(sum(line, arb(0)) for line in lines) for lines in (sizes, zip(*sizes, strict=True)))
    return least([whole, (rows * columns).sqrt()]).upper()
