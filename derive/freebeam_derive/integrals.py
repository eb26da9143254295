"""Exact integrals of x^k φ_i^(p) φ_j^(q) over the beam, without integrating. Eq. (11).

The products φ_i^(p) φ_j^(q), p, q = 0…3, span a space that d/dx maps into itself, because φ'''' = γ⁴ φ. For i ≠ j
its matrix is invertible, so an antiderivative is an exact linear solve; for i = j the symmetric products with
polynomial coefficients do the same; against a rigid function (a polynomial) φ itself is φ''''/γ⁴. What is left are
end values, most of which the end conditions strike out.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache, lru_cache

from sympy import (
    QQ,
    Add,
    Expr,
    Function,
    Integral,
    Mul,
    Poly,
    S,
    Symbol,
    cancel,
    expand,
    factor,
    factor_terms,
    factorial,
    fraction,
    symbols,
)
from sympy.polys.matrices import DomainMatrix

from freebeam_derive.comparison import ComparisonBeam, canonical, integral_polynomials, sigma
from freebeam_derive.notation import QUANTITIES, x
from freebeam_derive.record import Step
from freebeam_derive.ritz import HIGHEST_POWER, Form, NotTextbook, RitzSystem

gamma_i, gamma_j = symbols("gamma_i gamma_j", positive=True)
_a, _b, _apart = symbols("a b apart", positive=True)  # γ_i⁴, γ_j⁴, their difference

Antiderivative = tuple[tuple[int, int, int, Expr], ...]  # (power of x, order on i, order on j, factor in a, b)


@lru_cache(maxsize=1)
def _inverse_derivative() -> DomainMatrix:
    """Inverse of d/dx on the products φ_i^(p) φ_j^(q), at 4 p + q, over Q(a, b)."""
    field = QQ.frac_field(_a, _b)
    rows = [[field.zero] * 16 for _ in range(16)]
    for p in range(4):
        for q in range(4):
            # (φ_i^(p) φ_j^(q))' = φ_i^(p+1) φ_j^(q) + φ_i^(p) φ_j^(q+1), columns hold the image
            rows[4 * ((p + 1) % 4) + q][4 * p + q] += field.from_sympy(_a) if p == 3 else field.one
            rows[4 * p + (q + 1) % 4][4 * p + q] += field.from_sympy(_b) if q == 3 else field.one
    return DomainMatrix(rows, (16, 16), field).inv()


@cache
def antiderivative(k: int, p: int, q: int) -> Antiderivative:
    """Antiderivative of x^k φ_i^(p) φ_j^(q), i ≠ j, as terms in x^m φ_i^(r) φ_j^(s)."""
    inverse = _inverse_derivative()
    field = inverse.domain
    vector = DomainMatrix([[field.one if n == 4 * p + q else field.zero] for n in range(16)], (16, 1), field)
    terms: list[tuple[int, int, int, Expr]] = []
    for order in range(k + 1):
        # parts: each further solve takes one power of x with it
        vector = inverse * vector
        scale = (-1) ** order * factorial(k) / factorial(k - order)
        for n in range(16):
            value = field.to_sympy(vector.to_list()[n][0])
            if value != 0:
                terms.append((k - order, n // 4, n % 4, scale * value))
    return tuple(terms)


@cache
def antiderivative_same(k: int, p: int, q: int) -> Antiderivative:
    """Antiderivative of x^k φ^(p) φ^(q) of one mode, as terms in x^m φ^(r) φ^(s), r ≤ s."""
    pairs = [(r, s) for r in range(4) for s in range(r, 4)]
    index = {pair: n for n, pair in enumerate(pairs)}
    degrees = k + 2
    field = QQ.frac_field(_a)
    size = len(pairs)
    rows = [[field.zero] * (size * degrees) for _ in range(size * degrees)]
    for m in range(degrees):
        for (r, s), n in index.items():
            column = m * size + n
            if m:
                rows[(m - 1) * size + n][column] += field(m)
            for first, second in ((r + 1, s), (r, s + 1)):
                pair = tuple(sorted((first % 4, second % 4)))
                rows[m * size + index[pair]][column] += field.from_sympy(_a) if 4 in (first, second) else field.one  # type: ignore[index]
    target = [[field.zero] for _ in range(size * degrees)]
    target[k * size + index[tuple(sorted((p, q)))]] = [field.one]  # type: ignore[index]
    augmented = DomainMatrix(rows, (size * degrees,) * 2, field).hstack(
        DomainMatrix(target, (size * degrees, 1), field)
    )
    reduced, pivots = augmented.rref()
    if size * degrees in pivots:
        raise AssertionError(f"x^{k} φ^({p}) φ^({q}) has no antiderivative of the assumed form")
    listed = reduced.to_list()
    solution = {pivot: field.to_sympy(listed[row][-1]) for row, pivot in enumerate(pivots)}
    return tuple((n // size, *pairs[n % size], value) for n, value in sorted(solution.items()) if value != 0)


@dataclass(frozen=True)
class EndValues:
    """End values φ^(d)(end) / γ^d of a mode in as few named quantities as there are independent ones.

    named: symbol -> its expression in η, σ and root. at[end][d]: in σ and the named symbols.
    """

    named: tuple[tuple[Symbol, Expr], ...]
    at: tuple[tuple[Expr, ...], tuple[Expr, ...]]

    def of(self, suffix: str) -> EndValues:
        """The same for mode i or j."""
        rename = {s: Symbol(f"{s}_{suffix}", real=True) for s in (sigma, *(n for n, _ in self.named))}
        at = tuple(tuple(v.xreplace(rename) for v in values) for values in self.at)
        return EndValues(tuple((rename[s], e) for s, e in self.named), at)  # type: ignore[arg-type]


@cache
def end_values(beam: ComparisonBeam) -> EndValues:
    """Name the end values of a comparison beam that are neither constants nor ± another."""
    named: list[tuple[Symbol, Expr]] = []
    at: list[tuple[Expr, ...]] = []
    for end in range(2):
        row = []
        for d, value in enumerate(beam.values[end]):
            for known, expression in [(S.One, S.One), *named]:
                ratio = canonical(value / expression, beam.square)
                if not ratio.free_symbols - {sigma}:
                    row.append(ratio * known)
                    break
            else:
                symbol = Symbol(f"{QUANTITIES[d]}_{end}", real=True)
                named.append((symbol, value))
                row.append(symbol)
        at.append(tuple(row))
    return EndValues(tuple(named), (at[0], at[1]))


def _signs(*values: EndValues) -> tuple[list[Symbol], list[Symbol]]:
    """The sign symbols and the named end values of some modes."""
    signs = [
        sign
        for v in values
        for sign in sorted({s for at in v.at for e in at for s in e.free_symbols}, key=str)
        if str(sign).startswith("sigma")
    ]
    return signs, [symbol for v in values for symbol, _ in v.named]


def _collected(expression: Expr, signs: list[Symbol], named: list[Symbol]) -> Expr:
    """An expression with the squares of signs struck out, written in few operations."""
    if expression == 0:
        return S.Zero
    gathered: dict[Expr, Expr] = {}
    for powers, coefficient in (
        Poly(expand(expression), *signs, *named).terms() if signs or named else [((), expression)]
    ):
        product = Mul(*(s ** (n % 2 if s in signs else n) for s, n in zip((*signs, *named), powers, strict=True)))
        gathered[product] = gathered.get(product, S.Zero) + coefficient
    total = Add(*(factor(c) * product for product, c in sorted(gathered.items(), key=lambda item: str(item[0]))))
    written = (total, factor(total), factor_terms(total)) if total.is_Add else (total,)
    return min(written, key=lambda e: (int(e.count_ops()), str(e)))


@cache
def integral_modes(beam: ComparisonBeam, k: int, p: int, q: int) -> tuple[Expr, ...]:
    """∫ x^k φ_i^(p) φ_j^(q) dx, i ≠ j, as the factors (N_0, N_1, …) of powers of 1 / (γ_i⁴ − γ_j⁴). Eq. (11).

    Each N is a sum of products of a function of mode i and one of mode j, in gamma_i, gamma_j, the signs and the
    named end values: nothing cancels in it for neighbouring modes.

    Raises ValueError for a power of x above 3 or an order above 3.
    """
    _within(k, p, q)
    values = end_values(beam)
    of_i, of_j = values.of("i"), values.of("j")
    signs, named = _signs(of_i, of_j)
    # factor of each product of end values, rational in a = γ_i⁴, b = γ_j⁴
    ends: dict[Expr, Expr] = {}
    for m, r, s, coefficient in antiderivative(k, p, q):
        at_1 = of_i.at[1][r] * of_j.at[1][s]
        at_0 = of_i.at[0][r] * of_j.at[0][s] if m == 0 else S.Zero
        for term in Add.make_args(expand(at_1 - at_0)):
            if term != 0:
                number, product = term.as_coeff_Mul()
                product *= gamma_i**r * gamma_j**s
                ends[product] = ends.get(product, S.Zero) + number * coefficient
    quotients: dict[Expr, tuple[Expr, int]] = {}  # numerator, power of a − b below it
    for product, coefficient in ends.items():
        numerator, denominator = fraction(cancel(coefficient))
        power = Poly(denominator, _a).degree()
        quotients[product] = cancel(numerator * (_a - _b) ** power / denominator), power
    choices = []
    # (γ_i⁴ − γ_j⁴) may take a power of either γ⁴ with it, or none: whichever leaves the fewest operations
    for eliminated, by in ((_a, _a), (_a, _b + _apart), (_b, _a - _apart)):
        parts: dict[int, Expr] = {}
        for product, (numerator, power) in quotients.items():
            for (n,), c in Poly(numerator.subs(eliminated, by), _apart).terms():
                parts[power - n] = parts.get(power - n, S.Zero) + product * c
        least = min(parts, default=0)
        if least < 0:
            raise AssertionError("an integral of modes holds a positive power of γ_i⁴ − γ_j⁴")
        written = tuple(
            _collected(parts.get(n, S.Zero).subs({_a: gamma_i**4, _b: gamma_j**4}), signs, named)
            for n in range(max(parts, default=0) + 1)
        )
        choices.append(written)
    return min(choices, key=lambda c: sum(operations(e) for e in c))


def operations(expression: Expr) -> int:
    """Operations on whole matrices: what depends on one mode only is a vector and costs nothing."""
    suffixes = {str(s)[-2:] for s in expression.free_symbols} & {"_i", "_j"}
    if len(suffixes) < 2:
        return 0
    mixed = [
        a for a in expression.args if operations(a) or len({str(s)[-2:] for s in a.free_symbols} & {"_i", "_j"}) == 2
    ]
    plain = {str(s)[-2:] for a in expression.args if a not in mixed for s in a.free_symbols} & {"_i", "_j"}
    return len(mixed) + len(plain) - 1 + sum(operations(a) for a in mixed) + (1 if expression.is_Pow else 0)


def assembled(parts: tuple[Expr, ...]) -> Expr:
    """The integral of two different modes as one expression."""
    return Add(*(part / (gamma_i**4 - gamma_j**4) ** n for n, part in enumerate(parts)))


@cache
def integral_same(beam: ComparisonBeam, k: int, p: int, q: int) -> Expr:
    """∫ x^k φ_i^(p) φ_i^(q) dx in gamma_i, the sign and the named end values of mode i. Eq. (11)."""
    _within(k, p, q)
    of_i = end_values(beam).of("i")
    total = S.Zero
    for m, r, s, coefficient in antiderivative_same(k, p, q):
        at_1 = of_i.at[1][r] * of_i.at[1][s]
        at_0 = of_i.at[0][r] * of_i.at[0][s] if m == 0 else S.Zero
        total += coefficient.subs(_a, gamma_i**4) * gamma_i ** (r + s) * (at_1 - at_0)
    return _collected(total, *_signs(of_i))


@cache
def integral_rigid(beam: ComparisonBeam, polynomial: Expr, order: int) -> Expr:
    """∫ polynomial(x) φ_i^(order) dx in gamma_i, the sign and the named end values of mode i.

    polynomial: x^k times a derivative of a rigid function, say.
    """
    of_i = end_values(beam).of("i")
    total, factor_, r, a = S.Zero, expand(polynomial), order, gamma_i**4
    while factor_ != 0:
        # ∫ f φ^(r) = [f F] − ∫ f' F with F' = φ^(r): F = φ^(r−1), or φ'''/γ⁴ where r = 0
        r, scale = (r - 1, S.One) if r else (3, 1 / a)
        total += scale * gamma_i**r * (factor_.subs(x, 1) * of_i.at[1][r] - factor_.subs(x, 0) * of_i.at[0][r])
        factor_ = expand(-factor_.diff(x) * scale)
    return _collected(total, *_signs(of_i))


def _within(k: int, p: int, q: int) -> None:
    if not (0 <= k <= HIGHEST_POWER and 0 <= p <= 3 and 0 <= q <= 3):
        raise ValueError(
            f"x^{k} φ^({p}) φ^({q}): powers of x up to {HIGHEST_POWER} and derivatives up to the third are known"
        )


# --- forms of rigid functions -------------------------------------------------------------------------------


def at_end(beam: ComparisonBeam, place: Expr, order: int, suffix: str) -> Expr:
    """φ^(order) at an end, of mode i or j."""
    return end_values(beam).of(suffix).at[int(place)][order] * Symbol(f"gamma_{suffix}", positive=True) ** order


def plain(expression: Expr) -> Expr:
    """An expression in the quantities of one mode, without its suffix; squares of signs are struck out."""
    names = {s: Symbol(str(s)[:-2], **s.assumptions0) for s in expression.free_symbols if str(s)[-2:] in ("_i", "_j")}
    return expression.xreplace(names).replace(
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


def rigid_mode(form: Form, beam: ComparisonBeam, function: Expr, trial: bool) -> Expr:
    """Entry of a rigid function against an elastic mode; `trial`: the rigid function is the column."""
    total = S.Zero
    for (k, p, q), f in form.along.items():
        of_rigid, of_mode = (q, p) if trial else (p, q)
        total += f * integral_rigid(beam, expand(x**k * function.diff(x, of_rigid)), of_mode)
    for (a, p, b, q), f in form.points.items():
        (rigid_place, of_rigid), (mode_place, of_mode) = ((b, q), (a, p)) if trial else ((a, p), (b, q))
        total += f * function.diff(x, of_rigid).subs(x, rigid_place) * at_end(beam, mode_place, of_mode, "i")
    return factor_terms(expand(plain(total)))


def refuse_coupled(system: RitzSystem, beam: ComparisonBeam) -> None:
    """The elastic spectrum decides stability alone only where rigid motion does not act on the elastic one.

    Raises NotTextbook where it does.
    """
    for letter, what in (("M", "inertia"), ("E", "springs or foundation"), ("H", "load")):
        for function in beam.rigid:
            if rigid_mode(getattr(system, letter), beam, function, trial=True) != 0:
                raise NotTextbook(
                    f"ends {beam.ends[0]} and {beam.ends[1]} let the beam move rigidly as {function}, and its "
                    f"{what} couples that to the bending, so that the elastic spectrum alone does not decide "
                    "stability; this is not supported"
                )


def orthogonality(beam: ComparisonBeam) -> tuple[Step, ...]:
    """Modes are orthogonal in mass and in bending, and to the rigid functions; E = γ⁴ M. Eqs. (11), (22).

    Raises AssertionError where a closed form does not give it.
    """
    mass, bending = integral_modes(beam, 0, 0, 0), integral_modes(beam, 0, 2, 2)
    against_rigid = tuple(integral_rigid(beam, function, 0) for function in beam.rigid)
    ratio = cancel(integral_same(beam, 0, 2, 2) / integral_same(beam, 0, 0, 0) / gamma_i**4)
    if any((*mass, *bending, *against_rigid)) or ratio != 1:
        raise AssertionError(f"the modes of {beam.ends} are not orthogonal")
    phi_i, phi_j = (Function(f"phi_{letter}", real=True)(x) for letter in "ij")
    return (
        Step(
            "integrals",
            "Integrate products of two modes",
            "the products span a space that d/dx maps into itself, so an "
            "antiderivative is a linear solve; the end conditions strike out what is left; "
            "i and j are different modes",
            tuple(Integral(phi_i.diff(x, p) * phi_j.diff(x, p), (x, 0, 1)) for p in (0, 2)),
            (assembled(mass), assembled(bending), integral_same(beam, 0, 0, 0), integral_same(beam, 0, 2, 2)),
            "Eq. (11)",
            "zero for i ≠ j in mass and in bending; for i = j the ratio is γ⁴",
        ),
    )
