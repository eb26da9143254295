"""The kernel graph of a column: what is computed for each mode, for each pair of modes, and in which order.

Neutral between languages: expressions in SymPy, split into statements on modes (vectors of length N) and on pairs of
modes (N × N). In a pair expression `f_i` and `f_j` are the values of a mode's quantity `f` in row and column.

With polynomials as trial functions the graph is another one: series in Legendre's polynomials, a derivative of a
series, and each matrix as products of series with the integrals ∫ x^k P_m P_n between them.
"""

from __future__ import annotations

from dataclasses import dataclass

import mpmath
from sympy import Add, Expr, Mul, S, Symbol, cos, cse, expand, factor_terms, lambdify, numbered_symbols, pi, sin, sqrt

from freebeam_derive.integrals import (
    end_values,
    integral_modes,
    integral_rigid,
    integral_same,
    operations,
)
from freebeam_derive.legendre import Polynomials, polynomials
from freebeam_derive.modes import (
    ComparisonBeam,
    DampedModes,
    comparison_beam,
    epsilon,
    eta,
    integral_polynomials,
    sigma,
)
from freebeam_derive.newmark import Newmark
from freebeam_derive.notation import x
from freebeam_derive.ritz import Form, RitzSystem, display_form
from freebeam_derive.statement import Column, StatementError
from freebeam_derive.variation import EquationOfMotion

delta = Symbol("delta", real=True)  # root less its asymptote
APART = 9  # operations that 1 / (γ_i⁴ − γ_j⁴) takes: see _apart in emit.py

Statements = tuple[tuple[str, Expr], ...]


@dataclass(frozen=True)
class RootProgram:
    """Roots γ = quarter π/4 + δ: Newton on function(δ), from start; no correction where function is None."""

    first: int
    function: Expr | None
    derivative: Expr | None
    start: Expr | None
    iterations: int


@dataclass(frozen=True)
class BasisProgram:
    """Per-mode quantities: fields in order (name, expression, meaning), after the roots."""

    roots: RootProgram
    common: Statements
    fields: tuple[tuple[str, Expr, str], ...]
    coefficients: tuple[Expr, ...]  # of sin, cos, e^(−γx), e^(−γ(1−x)): a number or the symbol of a field


@dataclass(frozen=True)
class MatrixProgram:
    """One matrix: statements on modes, then on pairs, off-diagonal entries, diagonal, and the rigid border.

    entry: the factors of the powers 0, 1, … of 1 / (γ_i⁴ − γ_j⁴). operations: on whole N × N matrices, counted.
    corner, rows (rigid by mode), columns (mode by rigid): expressions
    in per-mode quantities and parameters, zero where nothing stands.
    """

    name: str
    letter: str
    text: str
    equation: str
    mode_statements: Statements
    pair_statements: Statements
    entry: tuple[Expr, ...]
    diagonal: Expr
    corner: tuple[tuple[Expr, ...], ...]
    rows: tuple[Expr, ...]
    columns: tuple[Expr, ...]
    operations: int


@dataclass(frozen=True)
class SeriesProgram:
    """One matrix over polynomials: a factor of the diagonal of ∫ φ², sums over series, products of end values.

    along: (p, q) -> factors of ∫ x^k φ_i^(p) φ_j^(q) by the power k. points: factor, row and column, each a field
    of the basis (`slope_1`).
    """

    name: str
    letter: str
    text: str
    equation: str
    diagonal: Expr
    along: dict[tuple[int, int], dict[int, Expr]]
    points: tuple[tuple[Expr, str, str], ...]
    symmetric: bool


@dataclass(frozen=True)
class Kernel:
    """What is emitted for a column in any basis."""

    column: Column
    motion: EquationOfMotion
    system: RitzSystem
    newmark: Newmark
    rigid: tuple[Expr, ...]
    matrices: tuple[MatrixProgram | SeriesProgram, ...]


@dataclass(frozen=True)
class ColumnKernel(Kernel):
    """All that is emitted for a column with its comparison modes."""

    matrices: tuple[MatrixProgram, ...]
    beam: ComparisonBeam
    basis: BasisProgram
    damped: DampedModes | None

    @property
    def operations(self) -> int:
        """Most operations that one matrix entry takes."""
        return max(matrix.operations for matrix in self.matrices)


@dataclass(frozen=True)
class PolynomialKernel(Kernel):
    """All that is emitted for a column with polynomials as trial functions.

    orders: the derivatives whose series are needed, 0 first. values: (name, end, order, factor) of the end values:
    a function of the degree, times (−1)^degree at x = 0.
    """

    matrices: tuple[SeriesProgram, ...]
    basis: Polynomials
    values: tuple[tuple[str, int, int, Expr], ...]

    @property
    def orders(self) -> tuple[int, ...]:
        used = {order for matrix in self.matrices for pair in matrix.along for order in pair}
        return tuple(range(max(used, default=0) + 1))

    @property
    def powers(self) -> tuple[int, ...]:
        """Powers of x in the matrices' sums over series."""
        return tuple(sorted({k for m in self.matrices for factors in m.along.values() for k in factors}))

    @property
    def products(self) -> int:
        """Most matrix products that one matrix takes, beside the series."""
        return max(2 * len(matrix.along) for matrix in self.matrices)


MATRICES = (
    ("mass", "M", "Eq. (11), first line"),
    ("stiffness_elastic", "E", "Eq. (11), third line at zero load"),
    ("stiffness_load", "H", "Eq. (11), third line, divided by the load; Eq. (13)"),
)


def build(
    column: Column, motion: EquationOfMotion, system: RitzSystem, damped: DampedModes | None, newmark: Newmark
) -> ColumnKernel:
    """Lower the forms of a column to programs over its comparison modes. Eq. (11)."""
    beam = comparison_beam(column.ends)
    matrices = tuple(
        _matrix(name, letter, getattr(system, letter), beam, equation) for name, letter, equation in MATRICES
    )
    _refuse_coupled(column, beam, {matrix.letter: matrix.columns for matrix in matrices})
    return ColumnKernel(column, motion, system, newmark, beam.rigid, matrices, beam, _basis(beam), damped)


def build_polynomials(
    column: Column, motion: EquationOfMotion, system: RitzSystem, newmark: Newmark
) -> PolynomialKernel:
    """Lower the forms of a column to programs over its trial polynomials. Eq. (11)."""
    basis, beam = polynomials(column.ends), comparison_beam(column.ends)
    _refuse_coupled(column, beam, {m: _rigid_border(getattr(system, m), beam, True) for _, m, _ in MATRICES})
    held = {(c.end, c.order) for c in basis.conditions}
    matrices: list[SeriesProgram] = []
    ends: set[tuple[int, int]] = set()
    for name, letter, equation in MATRICES:
        form: Form = getattr(system, letter)
        along: dict[tuple[int, int], dict[int, Expr]] = {}
        for (power, p, q), factor in sorted(form.along.items()):
            if (power, p, q) != (0, 0, 0):
                along.setdefault((p, q), {})[power] = factor
        points = []
        for (a, p, b, q), factor in form.points.items():
            pair = (int(a), p), (int(b), q)
            if not held & set(pair):
                row, column_ = (f"{QUANTITIES[order]}_{end}" for end, order in pair)
                points.append((factor, row, column_))
                ends |= set(pair)
        diagonal = form.along.get((0, 0, 0), S.Zero)
        matrices.append(
            SeriesProgram(name, letter, display_form(form), equation, diagonal, along, tuple(points), form.symmetric)
        )
    values = tuple((f"{QUANTITIES[p]}_{end}", end, p, basis.value(end, p)) for end, p in sorted(ends))
    return PolynomialKernel(column, motion, system, newmark, basis.rigid, tuple(matrices), basis, values)


# --- modes --------------------------------------------------------------------------------------------------


def _roots(beam: ComparisonBeam) -> RootProgram:
    """The characteristic equation in the distance δ from the asymptote: no digits cancel in it. Eq. (21)."""
    s_0, c_0 = sin(beam.first * pi / 4), cos(beam.first * pi / 4)
    u = expand(c_0 * beam.q - s_0 * beam.p)
    v = expand(c_0 * beam.p + s_0 * beam.q)
    scale = u.subs(epsilon, 0)
    u, v, r = (expand(f / scale) for f in (u, v, beam.r))
    if v == 0 and r == 0:
        return RootProgram(beam.first, None, None, None, 0)
    function = u * sin(delta) + v * cos(delta) + sigma * r
    derivative = function.diff(delta) - epsilon * function.diff(epsilon)  # dε/dδ = −ε
    start = expand(-(v + sigma * r))
    return RootProgram(beam.first, function, derivative, start, _newton_steps(beam.first, function, derivative, start))


def _newton_steps(first: int, function: Expr, derivative: Expr, start: Expr) -> int:
    """Newton steps until the first mode's correction, the slowest, is beyond a float's last digit."""
    with mpmath.workdps(40):
        asymptote = first * mpmath.pi / 4

        value = lambdify((delta, epsilon, sigma), (function, derivative, start), "mpmath")
        d, steps = value(0, mpmath.exp(-asymptote), 1)[2], 0
        while True:
            found, slope, _ = value(d, mpmath.exp(-asymptote - d), 1)
            if abs(found / slope) < mpmath.mpf(2) ** -60:
                return steps
            d, steps = d - found / slope, steps + 1


QUANTITIES = ("deflection", "slope", "moment", "shear")
_COEFFICIENTS = (
    ("sine", "coefficient of sin γx"),
    ("cosine", "coefficient of cos γx"),
    ("left", "coefficient of e^(−γx)"),
    ("right", "coefficient of e^(−γ(1−x))"),
)


def _basis(beam: ComparisonBeam) -> BasisProgram:
    coefficients, fields = [], []
    for (name, meaning), value in zip(_COEFFICIENTS, beam.coefficients, strict=True):
        if value.is_number:
            coefficients.append(value)
        else:
            coefficients.append(Symbol(name, real=True))
            fields.append((name, value, meaning))
    for symbol, value in end_values(beam).named:
        what, end = str(symbol).split("_")
        order = QUANTITIES.index(what)
        fields.append(
            (str(symbol), value, f"{'φ φ′ φ″ φ‴'.split()[order]}({end}) / γ{'⁰¹²³'[order]}".replace(" / γ⁰", ""))
        )
    common: Statements = (("root", sqrt(beam.square.subs(epsilon, eta))),) if beam.square != 1 else ()
    return BasisProgram(_roots(beam), common, tuple(fields), tuple(coefficients))


# --- matrices -----------------------------------------------------------------------------------------------


def _end(beam: ComparisonBeam, place: Expr, order: int, suffix: str) -> Expr:
    """φ^(order) at an end, of mode i or j."""
    return end_values(beam).of(suffix).at[int(place)][order] * Symbol(f"gamma_{suffix}", positive=True) ** order


def _plain(expression: Expr) -> Expr:
    """An expression in the quantities of mode i or j alone, without the suffix."""
    names = {s: Symbol(str(s)[:-2], **s.assumptions0) for s in expression.free_symbols if str(s)[-2:] in ("_i", "_j")}
    return expression.xreplace(names)


def _matrix(name: str, letter: str, form: Form, beam: ComparisonBeam, equation: str) -> MatrixProgram:
    parts: dict[int, Expr] = {}
    diagonal = S.Zero
    for (k, p, q), factor in form.along.items():
        for n, part in enumerate(integral_modes(beam, k, p, q)):
            parts[n] = parts.get(n, S.Zero) + factor * part
        diagonal += factor * integral_same(beam, k, p, q)
    for (a, p, b, q), factor in form.points.items():
        parts[0] = parts.get(0, S.Zero) + factor * _end(beam, a, p, "i") * _end(beam, b, q, "j")
        diagonal += factor * _end(beam, a, p, "i") * _end(beam, b, q, "i")
    listed = [parts.get(n, S.Zero) for n in range(max(parts, default=0) + 1)]
    listed = [min((part, factor_terms(part)), key=operations) for part in listed]
    diagonal = factor_terms(expand(_signs_squared(_plain(diagonal))))

    rigid = beam.rigid
    corner = tuple(tuple(rigid_pair(form, first, second) for second in rigid) for first in rigid)
    rows, columns = _rigid_border(form, beam, False), _rigid_border(form, beam, True)

    lowered, mode_statements = _lower(listed)
    replaced, reduced = cse(lowered, symbols=numbered_symbols("pair_", start=1, real=True), order="canonical")
    pair_statements = tuple((str(s), e) for s, e in replaced)
    count = sum(int(e.count_ops()) for e in (*(e for _, e in pair_statements), *reduced))
    if len(listed) > 1:
        count += APART + sum(2 if reduced[n] != 0 else 1 for n in range(len(listed) - 1))
    return MatrixProgram(
        name,
        letter,
        display_form(form),
        equation,
        mode_statements,
        pair_statements,
        tuple(reduced),
        diagonal,
        corner,
        rows,
        columns,
        count,
    )


def _signs_squared(expression: Expr) -> Expr:
    return expression.replace(
        lambda e: e.is_Pow and e.base == sigma and e.exp.is_Integer, lambda e: sigma ** (int(e.exp) % 2)
    )


def rigid_pair(form: Form, first: Expr, second: Expr) -> Expr:
    """Entry of two rigid functions: a number times parameters."""
    along = Add(
        *(f * integral_polynomials(x**k * first.diff(x, p), second.diff(x, q)) for (k, p, q), f in form.along.items())
    )
    return along + Add(
        *(f * first.diff(x, p).subs(x, a) * second.diff(x, q).subs(x, b) for (a, p, b, q), f in form.points.items())
    )


def _rigid_border(form: Form, beam: ComparisonBeam, trial: bool) -> tuple[Expr, ...]:
    """Entries of each rigid function against an elastic mode; `trial`: the rigid functions are the columns."""
    return tuple(rigid_mode(form, beam, function, trial) for function in beam.rigid)


def _refuse_coupled(column: Column, beam: ComparisonBeam, columns: dict[str, tuple[Expr, ...]]) -> None:
    """The elastic spectrum decides stability alone only where rigid motion does not act on the elastic one."""
    for letter, entries in columns.items():
        for function, entry in zip(beam.rigid, entries, strict=True):
            if entry != 0:
                what = {"M": "inertia", "E": "springs or foundation", "H": "load"}[letter]
                raise StatementError(
                    f"ends {column.ends[0]} and {column.ends[1]} let the beam move rigidly as {function}, and its "
                    f"{what} couples that to the bending, so that the elastic spectrum alone does not decide "
                    "stability; this is not supported"
                )


def rigid_mode(form: Form, beam: ComparisonBeam, function: Expr, trial: bool) -> Expr:
    """Entry of a rigid function against an elastic mode; `trial`: the rigid function is the column."""
    total = S.Zero
    for (k, p, q), factor in form.along.items():
        of_rigid, of_mode = (q, p) if trial else (p, q)
        total += factor * integral_rigid(beam, expand(x**k * function.diff(x, of_rigid)), of_mode)
    for (a, p, b, q), factor in form.points.items():
        (rigid_place, of_rigid), (mode_place, of_mode) = ((b, q), (a, p)) if trial else ((a, p), (b, q))
        total += factor * function.diff(x, of_rigid).subs(x, rigid_place) * _end(beam, mode_place, of_mode, "i")
    return factor_terms(expand(_signs_squared(_plain(total))))


def _name(plain: Expr) -> str:
    """A name for a per-mode quantity, from what it is: gamma2_slope_1 for γ² slope_1; empty where it has none."""
    number, rest = plain.as_coeff_Mul()
    pieces = []
    for f in Mul.make_args(rest):
        base, power = f.as_base_exp()
        if not base.is_Symbol or not power.is_Integer or power < 1:
            return ""
        pieces.append(f"{base}{'' if power == 1 else power}")
    times = [] if number == 1 else [f"times_{number}"] if number.is_Integer else [f"times_{number.p}_over_{number.q}"]
    return "_".join(sorted(pieces) + times)


def _sides(e: Expr) -> dict[str, list[Expr]]:
    """The arguments of a sum or product by what they depend on: one mode alone ("_i", "_j"), both, or none ("")."""
    groups: dict[str, list[Expr]] = {"_i": [], "_j": [], "both": [], "": []}
    for f in e.args:
        suffixes = {str(s)[-2:] for s in f.free_symbols} & {"_i", "_j"}
        alone = len(suffixes) == 1 and all(str(s)[-2:] in suffixes for s in f.free_symbols)
        groups["" if not suffixes else next(iter(suffixes)) if alone else "both"].append(f)
    return groups


def _lower(entries: list[Expr]) -> tuple[list[Expr], Statements]:
    """Take what depends on one mode only out of pair expressions, as named per-mode quantities."""
    known: dict[Expr, Symbol] = {}

    def quantity(expression: Expr, suffix: str) -> Expr:
        number, rest = _plain(expression).as_coeff_Mul()
        plain, sign = (-number * rest, -1) if number < 0 else (number * rest, 1)
        if not plain.is_Symbol and plain not in known:
            known[plain] = Symbol(_name(plain) or f"quantity_{len(known) + 1}", real=True)
        return sign * Symbol(f"{known.get(plain, plain)}{suffix}", real=True)

    def lower(e: Expr) -> Expr:
        wrapped = _sides(Mul(e, 1, evaluate=False))
        for side in ("_i", "_j"):
            if wrapped[side] and not wrapped["both"]:
                return quantity(e, side)
        groups = _sides(e)
        if isinstance(e, Mul):
            number, parameters = Mul(*groups[""]).as_coeff_Mul()
            for side in ("_i", "_j"):
                if groups[side]:
                    # the number goes into the vector, where it costs least
                    groups[side].append(number)
                    number = S.One
                    break
            return Mul(
                number,
                parameters,
                *(quantity(Mul(*groups[s]), s) for s in ("_i", "_j") if groups[s]),
                *map(lower, groups["both"]),
            )
        if isinstance(e, Add):
            return Add(
                *groups[""],
                *(quantity(Add(*groups[s]), s) for s in ("_i", "_j") if groups[s]),
                *map(lower, groups["both"]),
            )
        return e.func(*map(lower, e.args)) if e.args else e

    lowered = [lower(entry) for entry in entries]
    return lowered, tuple((str(symbol), plain) for plain, symbol in known.items())
