"""Lines Re s = R_k that no eigenvalue of the beam itself passes, for the verifier; and its rigid motions.

Of the verifier of certificates of the beam itself (`verifier_of_beam`); it shares no code with the prover. The lemmas
are those of docs/theorem.md.
"""

from __future__ import annotations

from fractions import Fraction

from flint import arb, arb_mat, fmpq, fmpq_poly

from freebeam_derive.certify import verifier as v
from freebeam_derive.certify.verifier_claims import ORDERS, Form, ball, exact, greatest, require

# --- lines that no eigenvalue passes ---------------------------------------------------------------------------------


class Lines:
    """The lines R_k, R_0 = 0, and what of the modes the norms on them need. n: modes in balls."""

    def __init__(self, ends: list[str], n: int) -> None:
        self.ends, self.n = ends, n
        self.gamma = v.gammas(ends, n)
        value, self._integral = v.modes(ends, n, self.gamma)
        self._scale = [1 / self._integral(0, (i, 0), (i, 0)).sqrt() for i in range(n)]
        self.at = {(e, d): [self._scale[i] * value(i, d, e) for i in range(n)] for e in (0, 1) for d in (0, 1)}
        self._known: dict[tuple[int, int, int], arb_mat] = {}
        self._asymptotes()
        g = self.gamma[-1]
        e = (-g).exp()
        square = 2 / (1 - 4 * e / (1 - e) ** 2)
        self.slope = 2 * (square - 1).sqrt()  # |φ'| ≤ slope γ at the ends
        self.stretch = (1 + 2 * self.slope * ends.count("free") / g).sqrt()  # ‖φ'‖ ≤ stretch γ
        ends_of = [self.at[1, 0][i] * self.at[1, 1][i] - self.at[0, 0][i] * self.at[0, 1][i] for i in range(n)]
        self.norms = [(g * g + x).sqrt().upper() for g, x in zip(self.gamma, ends_of, strict=True)]  # of φ'
        slopes = (abs(self.at[e, 1][i]) / self.gamma[i] for e in (0, 1) for i in range(n))
        self.steepest = greatest([self.slope, *slopes]).upper()
        self.longest = greatest([self.stretch, *(s / g for s, g in zip(self.norms, self.gamma, strict=True))]).upper()

    def _asymptotes(self) -> None:
        """γ_k ≈ start + π k: Lemma 1 with c and c' from the determinant, that every coefficient of ε^n is at most.

        Times e^γ it is a determinant of sines, cosines, ±1 and ε; terms without ε are A sin(γ − asymptote).
        """
        ends, pi = self.ends, arb.pi()
        kinds = (min(ends), max(ends))
        quarter = {("free", "free"): 2, ("clamped", "clamped"): 2, ("clamped", "free"): 2, ("pinned", "pinned"): 0,
                   ("sliding", "sliding"): 0, ("free", "pinned"): 1, ("clamped", "pinned"): 1, ("free", "sliding"): 3,
                   ("clamped", "sliding"): 3, ("pinned", "sliding"): 2}[kinds]  # fmt: skip
        # 4 × 4, columns of entries of size 1 and ε: at most 24 products, 16 of them with ε, n ≤ 2
        excess, steep, A = arb(24), arb(72), self._amplitude(quarter)
        e = (1 - self.gamma[-1]).exp()
        require(bool(steep * e < A / arb(2).sqrt()), "more modes are needed for the bounds of those beyond")
        shift = ((self.gamma[-1] - quarter * pi / 4) / pi - self.n).mid()
        whole = round(float(shift))
        self.start = quarter * pi / 4 + whole * pi
        self.beyond = (excess * e * pi / (arb(8).sqrt() * A)).upper()
        far = (abs(g - self.start - pi * k) for k, g in enumerate(self.gamma, 1))
        self.away = greatest([self.beyond, *far]).upper()
        require(bool(self.away < pi / 2), "the modes are too far from their asymptotes")

    def _amplitude(self, quarter: int) -> arb:
        """|A|: the size of the determinant without ε a quarter of a period from the asymptote."""
        g = quarter * arb.pi() / 4 + arb.pi() / 2
        s, c, zero = g.sin(), g.cos(), arb(0)
        rows = [[*v.turned(0, 1, d), (-1) ** d, zero] for d in ORDERS[self.ends[0]]]
        rows += [[*v.turned(s, c, d), zero, 1] for d in ORDERS[self.ends[1]]]
        A, on = abs(v.determinant(rows)), g - arb.pi() / 2
        rows[2:] = [[*v.turned(on.sin(), on.cos(), d), zero, 1] for d in ORDERS[self.ends[1]]]
        require(
            bool(A > arb("0.9")) and abs(v.determinant(rows)) < arb("1e-20"),
            "the asymptotes are not where they should be",
        )
        return arb(A)

    def line(self, k: int) -> arb:
        return arb(0) if k == 0 else (self.start + arb.pi() * (arb(k) + arb("0.5"))) ** 4

    def integrals(self, k: int, p: int, q: int) -> arb_mat:
        """∫ x^k φ_i^(p) φ_j^(q) dx."""
        if (k, p, q) not in self._known:
            n, scale = self.n, self._scale
            self._known[k, p, q] = arb_mat([
                [scale[i] * scale[j] * self._integral(k, *sorted([(i, p), (j, q)])) for j in range(n)] for i in range(n)
            ])  # fmt: skip
        return self._known[k, p, q]


class Norms:
    """Of a form between modes: ‖D^(−1/2) B D^(−1/2)‖ on lines."""

    def __init__(self, lines: Lines, form: Form) -> None:
        self.lines = lines
        along, points = form
        total = arb_mat(lines.n, lines.n)
        for k, p, q, f in along:
            total += lines.integrals(k, p, q) * ball(f)
        for a, p, b, q, f in points:
            total += arb_mat([[ball(f) * x * y for y in lines.at[b, q]] for x in lines.at[a, p]])
        self._squares = arb_mat([[(x * x).upper() for x in row] for row in total.tolist()])
        self._sides = [_side(form, summed) for summed in (0, 1)]

    def on(self, k: int) -> arb:
        """On one line."""
        lines = self.lines
        R, n, pi = lines.line(k), lines.n, arb.pi()
        D = [abs(g**4 - R) for g in lines.gamma]
        share = 1 - R / lines.gamma[-1] ** 4
        require(bool(share > 0) and all(d > 0 for d in D), "a line is not between two modes")
        w = arb_mat([[1 / d for d in D]])
        total = (w * self._squares * w.transpose())[0, 0]
        g = lines.start + pi * n - lines.beyond

        def beyond(power: int) -> arb:  # Σ_{j>n} γ_j^−power
            return arb(1 / ((power - 1) * pi * g ** (power - 1)))

        far = [(4 * beyond(4) / share).sqrt(), lines.slope * (beyond(2) / share).sqrt()]
        for inner, end in self._sides:
            for i in range(n):
                size = inner[0] + inner[1] * lines.norms[i] + inner[2] * lines.gamma[i] ** 2
                tail = size / (share.sqrt() * lines.gamma[-1] ** 2)
                tail += sum((f * abs(lines.at[a, p][i]) * far[q] for (a, p, _, q), f in end), arb(0))
                total += tail * tail / D[i]
            both = (
                inner[0] * beyond(8).sqrt() + inner[1] * lines.stretch * beyond(6).sqrt() + inner[2] * beyond(4).sqrt()
            )
            both = both / share + sum((f * far[p] * far[q] for (_, p, _, q), f in end), arb(0))
            total += both * both
        return arb(total.sqrt().upper())

    def on_all_from(self, k: int) -> arb:
        """On all lines from one on: Lemma 5."""
        lines = self.lines
        pi, G = arb.pi(), lines.start + arb.pi() * (arb(k) + arb("0.5"))
        t, T = pi / 2 - lines.away, pi / 2 + lines.away
        require(bool(G > 3 * T), "a line is too low for the bound of all from there on")
        L, Q = 1 / t + (G / t).log() / pi, 1 / t**2 + 1 / (pi * t)
        W = 1 / (2 * G * t) + (1 + 2 * G / t).log() / (2 * pi * G)
        d = 4 * t * (G - T) ** 3
        single = [L / G**3 + W / (2 * G**2), L / (4 * G) + W]
        double = [
            L / (G**3 * d) + Q / (13 * G**6),
            L / (4 * G * d) + Q / (13 * G**4),
            G * L / (4 * d) + Q / (13 * G**2),
        ]
        ends = [arb(2), lines.steepest]
        total = arb(0)
        for inner, end in self._sides:
            part = sum(
                (
                    f * size * x.sqrt()
                    for f, size, x in zip(inner, (arb(1), lines.longest, arb(1)), double, strict=True)
                ),
                arb(0),
            )
            part += sum((f * ends[p] * ends[q] * (single[p] * single[q]).sqrt() for (_, p, _, q), f in end), arb(0))
            total += part * part
        return arb(total.sqrt().upper())


def _side(form: Form, summed: int) -> tuple[list[arb], list[tuple[tuple[int, int, int, int], arb]]]:
    """Of the index that is summed over, the derivatives off it by parts: ‖g‖ by orders, and end terms."""
    inner: list[Fraction] = [Fraction(0)] * 3
    end: dict[tuple[int, int, int, int], Fraction] = {}
    for k, p, q, f in form[0]:
        stays, goes = (p, q) if summed else (q, p)
        inner[stays + goes] += abs(f)
        if goes:
            inner[stays] += k * abs(f)
            for e in (0, 1):
                if e or k == 0:
                    end[e, stays, e, 0] = end.get((e, stays, e, 0), Fraction(0)) + f * (2 * e - 1)
    for a, p, b, q, f in form[1]:
        key = (a, p, b, q) if summed else (b, q, a, p)
        end[key] = end.get(key, Fraction(0)) + f
    return [ball(x) for x in inner], [(key, abs(ball(f))) for key, f in end.items() if f]


def check_free(m: int, rho: arb, still: Norms, load: Norms) -> None:
    """No eigenvalue on any line from m on, for |p| ≤ rho. still: of what is there without load."""
    n: int = load.lines.n
    last = max(m, 3 * n // 4)
    require(last < n, "more modes are needed than the certificate has")
    for k in range(m, last):
        require(bool(still.on(k) + rho * load.on(k) < 1), f"line {k} is not known to be free of eigenvalues")
    from_last = still.on_all_from(last) + rho * load.on_all_from(last)
    require(bool(from_last < 1), f"lines from {last} on are not known to be free of eigenvalues")


# --- rigid motions ---------------------------------------------------------------------------------------------------


def rigid_motions(ends: list[str]) -> list[fmpq_poly]:
    """Straight lines that the ends allow, orthogonal."""
    held = [(e, d) for e in (0, 1) for d in ORDERS[ends[e]] if d < 2]
    half = [fmpq_poly([1]), fmpq_poly([-1, 2]), fmpq_poly([0, 1]), fmpq_poly([1, -1])]
    return [f for f in half if all((f.derivative() if d else f)(e) == 0 for e, d in held)][:2]


def check_rigid(ends: list[str], E: Form, H: Form) -> int:
    """Bending is not acted on by rigid motions, and these have s = 0 alone. How many there are."""
    rigid = rigid_motions(ends)
    for form in (E, H):
        X = [[fmpq_poly([0])(0)] * len(rigid) for _ in rigid]
        for column, r in enumerate(rigid):
            inside = fmpq_poly([0])
            at_ends: dict[tuple[int, int], fmpq] = {}
            for k, i, j, f in form[0]:
                if j > 1:
                    continue
                part = exact(f) * fmpq_poly([0] * k + [1]) * (r.derivative() if j else r)
                if i == 0:
                    inside += part
                else:
                    require(i == 1, "a form acts on curvatures")
                    inside -= part.derivative()
                    for e in (0, 1):
                        at_ends[e, 0] = at_ends.get((e, 0), fmpq(0)) + (2 * e - 1) * part(e)
            for a, i, b, j, f in form[1]:
                at_ends[a, i] = at_ends.get((a, i), fmpq(0)) + exact(f) * (r.derivative() if j else r)(b)
            loose = [x for (e, d), x in at_ends.items() if d not in ORDERS[ends[e]]]
            require(not any(loose), "rigid motions act on the bending")
            rest = inside
            for row, test in enumerate(rigid):
                X[row][column] = (inside * test).integral()(1) / (test * test).integral()(1)
                rest -= X[row][column] * test
            require(rest == fmpq_poly([0]), "rigid motions act on the bending")
        require(form is H or not any(x != 0 for row in X for x in row), "rigid motions feel springs")
        n = len(rigid)
        require(sum((X[i][i] for i in range(n)), exact(Fraction(0))) == 0, "rigid motions feel the load")
        require(n < 2 or X[0][0] * X[1][1] == X[0][1] * X[1][0], "rigid motions feel the load")
    return len(rigid)
