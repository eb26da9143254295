"""Comparison modes as trial functions: roots, functions, end values and matrices as programs. Eqs. (11), (16)-(23).

Statements are on modes (vectors of length N) and on pairs of modes (N × N). In a pair expression `f_i` and `f_j` are
the values of a mode's quantity `f` in row and column.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import partial
from types import ModuleType
from typing import Any

import mpmath
import numpy as np
from sympy import (
    Add,
    Expr,
    Integer,
    Mul,
    Pow,
    S,
    Symbol,
    cos,
    cse,
    expand,
    factor_terms,
    lambdify,
    numbered_symbols,
    pi,
    sin,
    sqrt,
)

from freebeam_derive import rounding
from freebeam_derive.comparison import ComparisonBeam, DampedModes, eta, integral_polynomials, sigma
from freebeam_derive.derivation import Derivation
from freebeam_derive.eigenproblem import load_matrix
from freebeam_derive.independent import Mode, Products, independent_mode, none_skipped
from freebeam_derive.integrals import (
    at_end,
    end_values,
    integral_modes,
    integral_same,
    operations,
    orthogonality,
    plain,
    rigid_mode,
    rigid_pair,
)
from freebeam_derive.kernel import MATRICES, BeamKernel, Figure, Program, Progress
from freebeam_derive.notation import PRIMES, QUANTITIES, alpha, beta, gamma, x
from freebeam_derive.record import Step
from freebeam_derive.ritz import Form, display_form
from freebeam_derive.roots import epsilon
from freebeam_derive.verify import BOUND, PLACES, matrix_figures

delta = Symbol("delta", real=True)  # root less its asymptote
APART = 9  # operations that 1 / (γ_i⁴ − γ_j⁴) takes: see _apart in emit/modes.py.jinja

SUFFIX = ""
MATRIX_MODES = 64  # verified: all entries up to here,
EXACT_MODES = 40  # modes and derivatives within BOUND up to here,
HIGH_MODES = (48, 64, 100, 200)  # and within 4 u gamma at these
_UNIT = 2.0**-53

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
class MatrixProgram(Program):
    """One matrix: fields of the basis that are used, statements on modes, then on pairs, entries and rigid border.

    entry: the factors of the powers 0, 1, … of 1 / (γ_i⁴ − γ_j⁴), off the diagonal. corner, rows (rigid by mode),
    columns (mode by rigid): expressions in per-mode quantities and parameters, zero where nothing stands; varying: the
    parameters among them. operations: on whole N × N matrices, counted.
    """

    used: tuple[str, ...]
    mode_statements: Statements
    pair_statements: Statements
    entry: tuple[Expr, ...]
    diagonal: Expr
    corner: tuple[tuple[Expr, ...], ...]
    rows: tuple[Expr, ...]
    columns: tuple[Expr, ...]
    varying: tuple[str, ...]
    operations: int

    @property
    def border(self) -> dict[tuple[int, int], Expr]:
        """What stands in the corner, times `one`."""
        places = ((i, j, c) for i, row in enumerate(self.corner) for j, c in enumerate(row))
        return {(i, j): Symbol("one") * c for i, j, c in places if c != 0}


@dataclass(frozen=True)
class ModesKernel(BeamKernel):
    """All that is emitted for a column with its comparison modes."""

    basis_name = "modes"
    symbols = ("gamma",)

    matrices: tuple[MatrixProgram, ...]
    beam: ComparisonBeam
    basis: BasisProgram
    damped: DampedModes | None

    @property
    def operations(self) -> int:
        """Most operations that one matrix entry takes."""
        return max(matrix.operations for matrix in self.matrices)

    @property
    def fields(self) -> tuple[tuple[str, str], ...]:
        corrected = self.basis.roots.function is not None
        return (
            ("gamma", "root of the characteristic equation, Eq. (21)"),
            ("quarter", "asymptote of the root in units of π/4"),
            *([("delta", "root less its asymptote")] if corrected else []),
            ("sigma", "sign (−1)^(n−1)"),
            *((name, meaning) for name, _, meaning in self.basis.fields),
            ("turn", "π/4"),
        )

    def context(self) -> dict[str, Any]:
        equation = f"{self.beam.equation.lhs} = {self.beam.equation.rhs}".replace("gamma", "γ").replace("*", " ")
        sine, cosine = (Symbol(name, real=True) for name in ("sine", "cosine"))
        roots = self.basis.roots
        derivatives = [list(self.rigid)]
        while any(derivatives[-1]):
            derivatives.append([f.diff(x) for f in derivatives[-1]])
        place = Symbol("place", real=True)
        return {
            "equation": equation,
            "roots": roots,
            "characteristic": [
                (name, e.subs({sin(delta): sine, cos(delta): cosine}))
                for name, e in (("value", roots.function), ("slope", roots.derivative))
                if e is not None
            ],
            "tail": bool(self.basis.common) or any(e.has(eta) for _, e, _ in self.basis.fields),
            "assigned": [(name, e) for name, e, _ in self.basis.fields],
            "rigid_derivatives": [[f.subs(x, place) for f in row] for row in derivatives[:-1]],
            "apart": any(len(matrix.entry) > 1 for matrix in self.matrices),
            "frequencies": self.damped and [("half", self.damped.half), ("product", self.damped.product)],
        }

    def cost(self) -> dict[str, int]:
        return {"operations_per_entry": self.operations}

    def bounds(self) -> dict[str, float]:
        return {
            f"matrix entries up to N = {MATRIX_MODES}, of the norms of their terms": BOUND,
            f"modes up to {EXACT_MODES} and their derivatives to the third, of the largest value": BOUND,
            f"modes up to {max(HIGH_MODES)}, of the largest value, in units of gamma times 2^-53": 4,
        }

    def proven(self, text: str) -> tuple[str, float]:
        return next(iter(self.bounds())), rounding.of_beam(self, text, MATRIX_MODES, partial(_Sizes, self))

    def measured(self, module: ModuleType, say: Progress) -> Iterator[Figure]:
        orders = self.beam.orders
        say("roots")
        none_skipped(module, orders, 24)
        roots = module.basis(max(HIGH_MODES)).gamma
        indices = sorted({*range(1, MATRIX_MODES + 1), *HIGH_MODES})
        modes = {index: independent_mode(index, float(roots[index - 1]), orders) for index in indices}
        yield _roots_figure(roots, modes)
        say("modes")
        yield from _shapes_figures(module, modes)
        say("matrices")
        products = Products([modes[n] for n in range(1, MATRIX_MODES + 1)], self.rigid)
        yield from matrix_figures(self, module, products, MATRIX_MODES)
        if self.damped is not None:
            yield _frequencies_figure(self, self.damped, module, modes)


def build(derivation: Derivation) -> ModesKernel:
    """Lower the forms of a column to programs over its comparison modes. Eq. (11)."""
    d, beam = derivation, derivation.beam
    own = {parameter.symbol for parameter in d.column.parameters}
    matrices = tuple(
        _matrix(Program(name, letter, display_form(form), equation), form, beam, own)
        for name, letter, equation in MATRICES
        for form in [getattr(d.system, letter)]
    )
    return ModesKernel(d.column, d.newmark, d.motion, d.system, beam.rigid, matrices, beam, _basis(beam), d.damped)


def steps(derivation: Derivation) -> tuple[Step, ...]:
    """How the modes and their integrals were derived. Eqs. (11)-(23)."""
    beam, damped = derivation.beam, derivation.damped
    of_beam = (*(damped.steps if damped else ()), *beam.steps)
    return (*of_beam, *orthogonality(beam), load_matrix(beam, derivation.system.H))


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


_COEFFICIENTS = (
    ("sine", "coefficient of sin γx"),
    ("cosine", "coefficient of cos γx"),
    ("left", "coefficient of e^(−γx)"),
    ("right", "coefficient of e^(−γ(1−x))"),
)


def _basis(beam: ComparisonBeam) -> BasisProgram:
    named = list(zip(_COEFFICIENTS, beam.coefficients, strict=True))
    coefficients = tuple(e if e.is_number else Symbol(name, real=True) for (name, _), e in named)
    fields = [(name, e, meaning) for (name, meaning), e in named if not e.is_number]
    for symbol, value in end_values(beam).named:
        what, end = str(symbol).split("_")
        order = QUANTITIES.index(what)
        fields.append((str(symbol), value, f"φ{PRIMES[order]}({end})" + (f" / γ{'⁰¹²³'[order]}" if order else "")))
    common: Statements = (("root", sqrt(beam.square.subs(epsilon, eta))),) if beam.square != 1 else ()
    return BasisProgram(_roots(beam), common, tuple(fields), coefficients)


# --- matrices -----------------------------------------------------------------------------------------------


def _matrix(program: Program, form: Form, beam: ComparisonBeam, own: set[Symbol]) -> MatrixProgram:
    parts: dict[int, Expr] = {}
    diagonal = S.Zero
    for (k, p, q), factor in form.along.items():
        for n, part in enumerate(integral_modes(beam, k, p, q)):
            parts[n] = parts.get(n, S.Zero) + factor * part
        diagonal += factor * integral_same(beam, k, p, q)
    for (a, p, b, q), factor in form.points.items():
        first = factor * at_end(beam, a, p, "i")
        parts[0] = parts.get(0, S.Zero) + first * at_end(beam, b, q, "j")
        diagonal += first * at_end(beam, b, q, "i")
    listed = [parts.get(n, S.Zero) for n in range(max(parts, default=0) + 1)]
    listed = [min((part, factor_terms(part)), key=operations) for part in listed]
    rows, columns = (tuple(rigid_mode(form, beam, f, trial) for f in beam.rigid) for trial in (False, True))
    corner = tuple(tuple(rigid_pair(form, first, second) for second in beam.rigid) for first in beam.rigid)

    lowered, quantities = _lower(listed)
    replaced, entry = cse(lowered, symbols=numbered_symbols("pair_", start=1, real=True), order="canonical")
    count = sum(int(e.count_ops()) for e in (*(e for _, e in replaced), *entry))
    if len(listed) > 1:
        count += APART + sum(2 if part != 0 else 1 for part in entry[:-1])
    modes = [factor_terms(expand(plain(diagonal))), *rows, *(e for _, e in quantities)]
    powers, named = _powers((*modes, *columns))
    diagonal, *more = (e.xreplace(named) for e in modes)
    rows = tuple(more[: len(rows)])
    statements = [*powers, *((name, e) for (name, _), e in zip(quantities, more[len(rows) :], strict=True))]
    statements = [(name, e) for name, e in statements if e != Symbol(name, real=True)]
    pairs = tuple((str(s), e) for s, e in replaced)
    held = {s for e in (diagonal, *rows, *entry, *(e for _, e in (*statements, *pairs))) for s in e.free_symbols}
    names = {str(s).removesuffix("_i").removesuffix("_j") for s in held}
    known = ("gamma", "sigma", *(str(symbol) for symbol, _ in end_values(beam).named))
    border = {s for e in (*rows, *(c for row in corner for c in row)) for s in e.free_symbols}
    return MatrixProgram(
        **vars(program),
        used=("quarter", *(name for name in known if name in names)),
        mode_statements=tuple(statements),
        pair_statements=pairs,
        entry=tuple(entry),
        diagonal=diagonal,
        corner=corner,
        rows=rows,
        columns=columns,
        varying=tuple(sorted(map(str, own & border))),
        operations=count,
    )


def _powers(expressions: Iterable[Expr]) -> tuple[list[tuple[str, Expr]], dict[Expr, Symbol]]:
    """Statements for the powers of γ that expressions hold, each the product of two before it, and their names."""
    needed = {int(p.exp) for e in expressions for p in e.atoms(Pow) if p.base == gamma and p.exp.is_Integer}
    for n in range(max(needed, default=1), 1, -1):
        if n in needed:
            needed |= {n // 2, n - n // 2}
    named = {n: Symbol(f"gamma{n}", real=True) if n > 1 else gamma for n in sorted(needed) if n > 0}
    statements = [(str(name), named[n - n // 2] * named[n // 2]) for n, name in named.items() if n > 1]
    return statements, {gamma**n: name for n, name in named.items() if n > 1}


def _name(quantity: Expr) -> str:
    """A name for a per-mode quantity, from what it is: gamma2_slope_1 for γ² slope_1; empty where it has none."""
    number, rest = quantity.as_coeff_Mul()
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
        number, rest = plain(expression).as_coeff_Mul()
        value, sign = (-number * rest, -1) if number < 0 else (number * rest, 1)
        if not value.is_Symbol and value not in known:
            known[value] = Symbol(_name(value) or f"quantity_{len(known) + 1}", real=True)
        return sign * Symbol(f"{known.get(value, value)}{suffix}", real=True)

    def lower(e: Expr) -> Expr:
        wrapped = _sides(Mul(e, 1, evaluate=False))
        for side in ("_i", "_j"):
            if wrapped[side] and not wrapped["both"]:
                return quantity(e, side)
        groups = _sides(e)
        if isinstance(e, Mul):
            number, parameters = Mul(*groups[""]).as_coeff_Mul()
            for vector in [groups[s] for s in ("_i", "_j") if groups[s]][:1]:
                vector.append(number)  # where it costs least
                number = S.One
            vectors = (quantity(Mul(*groups[s]), s) for s in ("_i", "_j") if groups[s])
            return Mul(number, parameters, *vectors, *map(lower, groups["both"]))
        if isinstance(e, Add):
            vectors = (quantity(Add(*groups[s]), s) for s in ("_i", "_j") if groups[s])
            return Add(*groups[""], *vectors, *map(lower, groups["both"]))
        return e.func(*map(lower, e.args)) if e.args else e

    lowered = [lower(entry) for entry in entries]
    return lowered, tuple((str(symbol), value) for value, symbol in known.items())


# --- verification -------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class _Sizes:
    """How large the rigid functions and the modes are, from the closed forms, for `rounding.of_beam`."""

    kernel: ModesKernel
    module: ModuleType
    basis: Any

    def norms(self, order: int) -> Any:
        rigid = [integral_polynomials(f.diff(x, order), f.diff(x, order)) for f in self.kernel.rigid]
        return np.sqrt([*map(float, rigid), *self._of_modes(plain(integral_same(self.kernel.beam, 0, order, order)))])

    def at_end(self, end: int, order: int) -> Any:
        rigid = [float(f.diff(x, order).subs(x, end)) for f in self.kernel.rigid]
        return np.array([*rigid, *self._of_modes(plain(at_end(self.kernel.beam, Integer(end), order, "i")))])

    def _of_modes(self, quantity: Expr) -> Any:
        """A quantity of each mode in floats, of the balls at hand."""
        symbols = sorted(quantity.free_symbols, key=str)
        value = lambdify(symbols, quantity, "math")(*(getattr(self.basis, str(s)) for s in symbols))
        return np.broadcast_to(value, self.basis.gamma.shape).astype(float)


def _roots_figure(roots: Any, modes: dict[int, Mode]) -> Figure:
    errors = {n: float(abs(mpmath.mpf(float(roots[n - 1])) / mode.gamma - 1)) for n, mode in modes.items()}
    worst = max(errors, key=lambda n: errors[n])
    return Figure("relative error of the roots", f"mode {worst}", errors[worst], 4 * _UNIT)


def _shapes_figures(module: ModuleType, modes: dict[int, Mode]) -> Iterator[Figure]:
    """Modes and their derivatives up to the third, relative to the largest value along the beam."""
    basis, grid = module.basis(max(modes)), np.linspace(0, 1, 2001)
    exact = {n: mode.values([mpmath.mpf(place) for place in PLACES]) for n, mode in modes.items()}
    for d in range(4):
        computed, largest = module.shapes(basis, PLACES, d), np.abs(module.shapes(basis, grid, d)).max(axis=1)
        worst = {False: ("", 0.0, BOUND), True: ("", 0.0, BOUND)}
        for n, mode in modes.items():
            high = n > EXACT_MODES
            bound = max(BOUND, 4 * _UNIT * float(mode.gamma)) if high else BOUND
            for place, found, value in zip(PLACES, computed[n - 1], exact[n][d], strict=True):
                difference = mpmath.mpf(float(found)) - mpmath.mpf(value) * mode.gamma**d
                error = float(abs(difference) / mpmath.mpf(float(largest[n - 1])))
                if error / bound >= worst[high][1] / worst[high][2]:
                    worst[high] = (f"mode {n}, x = {place:.4g}", error, bound)
        for high, found in worst.items():
            reach = f"modes {'beyond' if high else 'up to'} {EXACT_MODES}"
            yield Figure(f"derivative {d} of {reach}, of the largest value", *found)


def _frequencies_figure(kernel: ModesKernel, damped: DampedModes, module: ModuleType, modes: dict[int, Mode]) -> Figure:
    """Eq. (23) against the roots of the quadratic, from light to heavy damping."""
    own = {p.name: float(p.default) for p in kernel.column.parameters}
    symbols = [gamma, alpha, beta, *(p.symbol for p in kernel.column.parameters)]
    quadratic = lambdify(symbols, (damped.half, damped.product), "mpmath")
    worst = ("", 0.0)
    for dampings in ((0.0, 0.0), (1e-6, 0.0), (1e-3, 0.1), (10.0, 1000.0)):
        computed = module.frequencies(module.basis(8).gamma, *dampings, **own)
        for n in range(1, 9):
            half, product = quadratic(modes[n].gamma, *map(mpmath.mpf, (*dampings, *own.values())))
            roots = mpmath.polyroots([1, 2 * half, product], maxsteps=200, extraprec=400)
            for value in (mpmath.mpc(complex(pair[n - 1])) for pair in computed):
                error = float(min(abs(value - root) / abs(root) for root in roots))
                if error >= worst[1]:
                    worst = (f"mode {n}, alpha = {dampings[0]}, beta = {dampings[1]}", error)
    return Figure("relative error of the eigenvalues of Eq. (23)", *worst, 1e-12)
