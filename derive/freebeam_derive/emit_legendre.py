"""The module of a column with polynomials as trial functions, as source. Eqs. (9), (11).

Constants are integers, and quotients are taken in the arrays' own numbers: on arrays of rational numbers or
intervals these modules compute exactly, or with proof.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from functools import reduce

from sympy import Expr, S, cancel, factor, fraction, lcm, together

from freebeam_derive.kernel import QUANTITIES, PolynomialKernel, SeriesProgram
from freebeam_derive.legendre import products, series
from freebeam_derive.modes import integral_polynomials
from freebeam_derive.notation import x
from freebeam_derive.source import (
    BASIS,
    INDENT,
    KIND,
    KIND_DOC,
    NAMESPACE,
    body,
    code,
    docstring,
    header,
    matrix_head,
    metadata,
    signature,
)

_NORMS = "_diagonal(basis.norm, basis.order[: basis.norm.shape[0]])"


def _quotient(expression: Expr) -> str:
    """A rational expression as one quotient of polynomials with whole coefficients."""
    above, below = fraction(factor(expression))
    if below == 1:
        return code(above)
    return re.sub(r"^\((\w+)\) / ", r"\1 / ", f"({code(above)}) / ({code(below)})")


def _times(factor_: Expr, term: str) -> str:
    """A term times a factor in the column's parameters."""
    above, below = fraction(together(factor_))
    text = {S.One: term, S.NegativeOne: f"-{term}"}.get(above)
    if text is None:
        text = f"{f'({code(above)})' if above.is_Add else code(above)} * {term}"
    return text if below == 1 else f"{text} / {code(below) if below.is_Atom else f'({code(below)})'}"


def _sum(terms: Iterable[str]) -> str:
    return " + ".join(terms).replace("+ -", "- ")


def polynomial_parts(kernel: PolynomialKernel) -> list[str]:
    """The parts of a module that depend on its functions: head, functions and matrices."""
    more = (
        "Each is the polynomial of its degree that meets the geometric conditions and is orthogonal to all of lower "
        "degree that do, in a series of Legendre's polynomials P_k(2x − 1)."
    )
    names = ("x", "t", "P", "alpha", "beta", "F_0", "x_F", "y")
    return [
        header(kernel, "polynomials", more),
        metadata(kernel, names, {"basis": "legendre"}),
        NAMESPACE,
        _polynomial_basis(kernel),
        _polynomial_shapes(kernel),
        *(_integrals(power) for power in kernel.powers),
        *(_series_matrix(kernel, matrix) for matrix in kernel.matrices),
    ]


def _polynomial_basis(kernel: PolynomialKernel) -> str:
    R, first = len(kernel.rigid), kernel.basis.first
    listed = f"({R} + N,)" if R else "(N,)"
    fields = [
        ("order", f"orders k of Legendre's polynomials P_k(2x − 1), ({first} + N,)"),
        ("sigma", f"(−1)^k, ({first} + N,)"),
        ("norm", f"∫ φ² dx, {listed}"),
        *(
            (name, f"{('φ', 'φ′', 'φ″', 'φ‴')[order]}({end}), {listed}")
            for name, end, order, _ in kernel.values
        ),
        *(
            (QUANTITIES[p], f"{('φ', 'φ′', 'φ″', 'φ‴')[p]} in P_0, P_1, …, {listed[:-1].rstrip(',')}, {first} + N)")
            for p in kernel.orders
        ),
    ]  # fmt: skip
    text = "class Basis(NamedTuple):\n"
    what = f"The {R} rigid function{'s' if R > 1 else ''}, then the first" if R else "The first"
    listing = "\n".join(f"{name}: {meaning}" for name, meaning in fields)
    text += docstring(f"{what} N elastic functions: polynomials of degree {first}, {first + 1}, …\n\n{listing}\n")
    text += "\n" + "".join(f"{INDENT}{name}: Array\n" for name, _ in fields)

    text += "\n\ndef complete(order: Array, sigma: Array) -> Basis:\n"
    text += docstring(
        "All that is known of the functions, from the orders 0, 1, …, D − 1 and their signs (−1)^k: N = "
        f"D − {first}. Eq. (9).\n\nThe arrays may hold floats, or any numbers that can be divided, such as fractions "
        "or intervals: then so does the result.\n"
    )
    lines = ["xp = _namespace(order)", f"degree, zero = order[{first}:], 0 * order", *_series_lines(kernel)]
    if R:
        lines.append("unit = order[1:2]  # 1, in the numbers at hand")
        rows = []
        for f in kernel.rigid:
            terms = [f"xp.where(order == {k}, {_times(c, 'unit')}, zero)" for k, c in enumerate(series(f)) if c != 0]
            rows.append(_sum(terms))
        lines += [f"rigid = xp.stack([{', '.join(rows)}])", "deflection = xp.concat([rigid, deflection])"]
    if len(kernel.orders) > 1:
        lines.append("derivative = _derivative(order, sigma)")
    lines += [f"{QUANTITIES[p]} = {QUANTITIES[p - 1]} @ derivative" for p in kernel.orders[1:]]
    squares = [integral_polynomials(f, f) for f in kernel.rigid]
    lines += _vector("norm", squares, kernel.basis.norm, "")
    for name, end, order, value in kernel.values:
        at_end = [f.diff(x, order).subs(x, end) for f in kernel.rigid]
        lines += _vector(name, at_end, value, "" if end else f"sigma[{first}:] * ")
    lines.append(f"return Basis({', '.join(name for name, _ in fields)})")
    text += body(lines) + "\n\n"

    text += "def _derivative(order: Array, sigma: Array) -> Array:\n"
    text += docstring(
        "What a series is multiplied by, from the right, to give its derivative: P_k′ = Σ 2 (2m + 1) P_m."
    )
    lines = [
        "lower = (1 - sigma[:, None] * sigma) * (2 * order + 1)",
        "value: Array = _namespace(order).where(order < order[:, None], lower, 0 * lower)",
        "return value",
    ]
    text += body(lines) + "\n\n"
    text += BASIS + docstring(
        f"The functions of degree up to N + {first - 1}, N of them elastic. Eq. (9), section 3.1.\n\n{KIND_DOC}\n"
    )
    return text + body([f"order = xp.arange({first} + N, {KIND})", "return complete(order, 1 - 2 * (order % 2))"])


def _series_lines(kernel: PolynomialKernel) -> list[str]:
    """The elastic functions in Legendre's polynomials: 1 for their own degree, and what the ends take away below it."""
    first, conditions = kernel.basis.first, kernel.basis.conditions
    if conditions:
        lines = [f"weight_{n} = {_quotient(c.weight)}" for n, c in enumerate(conditions, start=1)]
        shares = ["", ""]
        for n, c in enumerate(conditions, start=1):
            term = f"weight_{n}[:, None]" + ("" if c.of == 1 else f" * ({code(c.of)})")
            shares[c.end] += f" + {term}" if shares[c.end] else term
        if shares[0]:
            shares[0] = f"sigma[{first}:, None] * sigma * ({shares[0]})"
        lines.append(f"share = {' + '.join(share for share in shares if share)}")
        lines.append("below = -(2 * order + 1) * share")
        lines.append("deflection = xp.where(order < degree[:, None], below, 0 * below)")
    else:
        lines = ["deflection = 0 * degree[:, None] * order"]
    return [*lines, "deflection = xp.where(order == degree[:, None], zero + 1, deflection)"]


def _vector(name: str, rigid: list[Expr], elastic: Expr, sign: str) -> list[str]:
    """A quantity of each function, of the rigid ones first."""
    value = f"{sign}{_quotient(elastic)}" if elastic.free_symbols else f"{sign}(0 * degree + 1)"
    if elastic.is_number and elastic != 1:
        raise AssertionError(f"{name}: {elastic} at every degree is not written")
    if not rigid:
        return [f"{name} = {value}"]
    return [f"{name} = xp.concat([{', '.join([*(_times(c, 'unit') for c in rigid), value])}])"]


def _polynomial_shapes(kernel: PolynomialKernel) -> str:
    R = len(kernel.rigid)
    doc = (
        "Trial functions or a derivative of them, shape (N, *x.shape). Eq. (9).\n\n"
        "x: places in units of the length, any shape. derivative: its order, 0 or more. "
        + (
            f"rigid: with the {R} rigid function{'s' if R > 1 else ''} first, shape ({R} + N, *x.shape).\n"
            if R
            else "rigid: this column has no rigid functions, so it changes nothing.\n"
        )
    )
    lines = [
        "xp, places = _namespace(basis.order), _like(x, basis.order)",
        "series = basis.deflection",
        "for _ in range(derivative):",
        "    series = series @ _derivative(basis.order, basis.sigma)",
        f"value: Array = series{_elastic(R)} @ _legendre(basis.order.shape[0], xp.reshape(places, (-1,)))",
        "found: Array = xp.reshape(value, (value.shape[0], *places.shape))",
        "return found",
    ]
    text = signature("shapes", "basis: Basis, x: ArrayLike, derivative: int = 0, rigid: bool = False", "Array")
    text += docstring(doc) + body(lines) + "\n\n"
    text += "def _legendre(count: int, x: Array) -> Array:\n" + docstring(
        "P_k(2x − 1) for k below count, shape (count, x.size).\n\n"
        "By their differences, in the distance from the nearer end, so that nothing cancels there.\n"
    )
    lines = [
        "xp = _namespace(x)",
        "near = xp.minimum(x, 1 - x)",
        "value = 0 * x + 1",
        "odd = xp.where(x < 0.5, -value, value)  # sign of the odd ones",
        "step = -2 * near",
        "rows = [value]",
        "for k in range(1, count):",
        "    value = value + step",
        "    step = (k * step - 2 * (2 * k + 1) * near * value) / (k + 1)",
        "    rows.append(value * odd if k % 2 else value)",
        "found: Array = xp.reshape(xp.concat(rows), (count, x.shape[0]))",
        "return found",
    ]
    return text + body(lines)


def _elastic(R: int) -> str:
    """Subscript that leaves the rigid functions out unless they are asked for."""
    return f"[0 if rigid else {R} :, :]" if R else ""


def _integrals(power: int) -> str:
    bands = products(power)
    text = f"def _integrals_{power}(order: Array) -> Array:\n"
    text += docstring(f"∫ {'' if power == 0 else 'x ' if power == 1 else f'x^{power} '}P_m P_n dx, shape (D, D).")
    lines = [f"value: Array = _diagonal({_quotient(bands[0])}, order)"]
    if len(bands) > 1:
        lines.append("where, row = _namespace(order).where, order[:, None]")
    for n, band in enumerate(bands[1:], start=1):
        lines.append(f"band = {_quotient(band)}")
        lines.append(f"value = where(order == row + {n}, band[:, None], where(row == order + {n}, band, value))")
    return text + body([*lines, "return value"])


def _series_matrix(kernel: PolynomialKernel, matrix: SeriesProgram) -> str:
    letter, R = matrix.letter, len(kernel.rigid)
    terms: list[tuple[str, Expr]] = []  # what is added, and its factor
    if matrix.diagonal != 0:
        terms.append((_NORMS, matrix.diagonal))
    lines: list[str] = []
    for (p, q), factors in matrix.along.items():
        if len(factors) == 1:
            ((power, c),) = factors.items()
            terms.append((f"(basis.{QUANTITIES[p]} @ _integrals_{power}(basis.order) @ basis.{QUANTITIES[q]}.T)", c))
        else:
            below = reduce(lcm, (fraction(together(c))[1] for c in factors.values()))
            name = f"between_{p}{q}"
            between = (_times(cancel(c * below), f"_integrals_{power}(basis.order)") for power, c in factors.items())
            lines.append(f"{name} = {_sum(between)}")
            terms.append((f"(basis.{QUANTITIES[p]} @ {name} @ basis.{QUANTITIES[q]}.T)", 1 / below))
    terms += [(f"basis.{row}[:, None] * basis.{column}", c) for c, row, column in matrix.points]
    for n, (term, c) in enumerate(terms):
        added = _times(c, term)
        if n == 0:
            added = added[1:-1] if added == term and term.startswith("(") else added
            lines.append(f"{letter}: Array = {added}")
        else:
            lines.append(f"{letter} = {_sum([letter, added])}")
    if not terms:
        lines.append(f"{letter}: Array = {_NORMS.replace('basis', '0 * basis', 1)}")
    if matrix.symmetric and (matrix.along or matrix.points):
        lines.append(f"{letter} = ({letter} + {letter}.mT) / 2  # to the last bit")
    cut = f"return {letter} if rigid else {letter}[..., {R}:, {R}:]" if R else f"return {letter}"
    return matrix_head(kernel, matrix) + body([*lines, cut])
