"""Kernel graphs written as Python modules: with source.py and emit_legendre.py all that knows NumPy's syntax.

The text depends on the graph alone: no timestamp, no path, no hash order. What reads it is the runtime, or anyone
who takes the one file into a code of their own; it imports NumPy and nothing else, and works on the arrays of any
library that follows the Python array API: functions are pure, and their namespace is that of the arrays given.
"""

from __future__ import annotations

import ast
from collections.abc import Iterable

from sympy import Expr, Max, Poly, Pow, Symbol, cos, horner, sin

from freebeam_derive.emit_legendre import polynomial_parts
from freebeam_derive.kernel import ColumnKernel, Kernel, MatrixProgram, PolynomialKernel, delta
from freebeam_derive.modes import eta
from freebeam_derive.newmark import Newmark
from freebeam_derive.notation import gamma, x
from freebeam_derive.scaling import SCALES, UNITS
from freebeam_derive.source import (
    BASIS,
    INDENT,
    KIND,
    KIND_DOC,
    NAMESPACE,
    body,
    code,
    docstring,
    exact,
    header,
    matrix_head,
    matrix_signature,
    metadata,
    number,
    own,
    own_functions,
    shared,
    signature,
)
from freebeam_derive.statement import GEOMETRIC, StatementError, jets

# --- parts of a module --------------------------------------------------------------------------------------


def _equation(kernel: ColumnKernel) -> str:
    """The characteristic equation as text."""
    equation = kernel.beam.equation
    return f"{equation.lhs} = {equation.rhs}".replace("gamma", "γ").replace("*", " ")


def _powers(expressions: Iterable[Expr]) -> tuple[list[str], dict[Expr, Expr]]:
    """Statements for the powers of γ that expressions hold, and what to put in their place."""
    needed = {
        int(p.exp) for e in expressions for p in e.atoms(Pow) if p.base == gamma and p.exp.is_Integer and p.exp > 1
    }
    lines: list[str] = []
    names: dict[int, str] = {1: "gamma"}
    highest = max(needed, default=1)
    for n in range(2, highest + 1):
        # each power from two known ones
        if n in needed or any(n < m for m in needed):
            half = n // 2
            names[n] = f"gamma{n}"
            lines.append(f"gamma{n} = {names[n - half]} * {names[half]}")
    keep = set(needed)
    for n in range(highest, 1, -1):
        if n in keep:
            keep |= {n // 2, n - n // 2}
    lines = [line for line in lines if int(line.split(" = ")[0][5:]) in keep]
    return lines, {gamma**n: Symbol(names[n], real=True) for n in keep if n > 1}


def _basis(kernel: ColumnKernel) -> str:
    program = kernel.basis
    corrected = program.roots.function is not None
    fields = [
        ("gamma", "root of the characteristic equation, Eq. (21)"),
        ("quarter", "asymptote of the root in units of π/4"),
        *([("delta", "root less its asymptote")] if corrected else []),
        ("sigma", "sign (−1)^(n−1)"),
        *((name, meaning) for name, _, meaning in program.fields),
        ("turn", "π/4"),
    ]
    listing = "\n".join(f"{name}: {meaning}" for name, meaning in fields)
    text = "class Basis(NamedTuple):\n"
    text += docstring(f"The first N modes: each field of shape (N,), but for `turn`.\n\n{listing}\n") + "\n"
    text += "".join(f"{INDENT}{name}: {'Any' if name == 'turn' else 'Array'}\n" for name, _ in fields)
    if corrected:
        text += "\n\n" + _characteristic(kernel)
    given = (
        "quarter: Array, sigma: Array, delta: Array, turn: Any"
        if corrected
        else "quarter: Array, sigma: Array, turn: Any"
    )
    text += f"\n\ndef complete({given}) -> Basis:\n" + docstring(
        "All that is known of the modes, from their roots γ = quarter · turn + delta. Eq. (22).\n\n"
        "The arrays may hold floats, or any numbers that know `exp`, such as intervals: then so does the result.\n"
        if corrected
        else "All that is known of the modes, from their roots γ = quarter · turn. Eq. (22).\n"
    )
    lines = ["gamma = quarter * turn" + (" + delta" if corrected else "")]
    if any(e.has(eta) for _, e, _ in program.fields) or program.common:
        lines += ["xp = _namespace(gamma)", "tail = sigma * xp.exp(-gamma)"]
    lines += [f"{name} = {code(value, 'xp')}" for name, value in program.common]
    lines += shared([(name, value) for name, value, _ in program.fields])
    lines.append(f"return Basis({', '.join(name for name, _ in fields)})")
    text += body(lines) + f"\n\n{BASIS}"
    how = (
        "asymptotes, corrected by Newton's method, so that there is no table to run out of.\n"
        if corrected
        else "known in closed form.\n"
    )
    text += docstring(
        f"The first N modes of the unloaded, undamped beam. Eqs. (19)-(22).\n\nRoots of {_equation(kernel)}: {how}\n"
        f"{KIND_DOC}\n"
    )
    lines = [
        f"n = xp.arange(N, {KIND})",
        f"quarter = {program.roots.first} + 4 * n",
        "sigma = 1 - 2 * (n % 2)",
    ]
    if not corrected:
        return text + body([*lines, "return complete(quarter, sigma, np.pi / 4)"])
    assert program.roots.start is not None
    lines += [
        "asymptote = quarter * (np.pi / 4)",
        "epsilon = xp.exp(-asymptote)",
        f"delta = {code(program.roots.start)}",
        f"for _ in range({program.roots.iterations}):",
        "    value, slope = characteristic(delta, asymptote, sigma)",
        "    delta = delta - value / slope",
        "return complete(quarter, sigma, delta, np.pi / 4)",
    ]
    return text + body(lines)


def _characteristic(kernel: ColumnKernel) -> str:
    """The characteristic function, which is zero at a root, and its derivative."""
    roots = kernel.basis.roots
    assert roots.function is not None and roots.derivative is not None
    sine, cosine = Symbol("sine", real=True), Symbol("cosine", real=True)
    written = [e.subs({sin(delta): sine, cos(delta): cosine}) for e in (roots.function, roots.derivative)]
    lines = ["xp = _namespace(delta)", "epsilon = xp.exp(-asymptote - delta)"]
    for symbol, name in ((sine, "sin"), (cosine, "cos")):
        if any(e.has(symbol) for e in written):
            lines.append(f"{symbol} = xp.{name}(delta)")
    lines += [*shared([("value", written[0]), ("slope", written[1])]), "return value, slope"]
    doc = (
        f"{_equation(kernel)} at γ = asymptote + delta, written so that no digits cancel, and its slope in delta. "
        "Eq. (21).\n"
    )
    head = "def characteristic(delta: Array, asymptote: Array, sigma: Array) -> tuple[Array, Array]:\n"
    return head + docstring(doc) + body(lines)


def _shapes(kernel: ColumnKernel) -> str:
    A, B, C, D = kernel.basis.coefficients
    rigid = kernel.rigid
    column = "basis.{}[:, None]"
    corrected = kernel.basis.roots.function is not None

    def factor(c: Expr) -> str:
        return "" if c == 1 else "-" if c == -1 else (column.format(c) if c.is_Symbol else code(c)) + " * "

    trig = []
    if A != 0:
        trig.append(factor(A) + "rotated[0]")
    if B != 0:
        trig.append(factor(B) + "rotated[1]")
    doc = (
        "Modes or a derivative of them, shape (N, *x.shape). Eq. (22).\n\n"
        "x: places in units of the length, any shape. derivative: its order, 0 or more. "
        + (
            f"rigid: put the {len(rigid)} rigid function{'s' if len(rigid) > 1 else ''} first, "
            f"shape ({len(rigid)} + N, *x.shape)."
            if rigid
            else "rigid: this column has no rigid functions, so it changes nothing."
        )
        + "\n\nsinh and cosh are written in decaying exponentials, and whole turns are struck off γ x exactly, "
        "so that no digits cancel in high modes.\n"
    )
    lines = [
        "xp = _namespace(basis.gamma)",
        "places = _like(x, basis.gamma)",
        "place = xp.reshape(places, (1, -1))",
        "gamma, quarter = basis.gamma[:, None], basis.quarter[:, None]",
        "half = 2.0 ** (26 if place.dtype == xp.float64 else 12)  # of the digits: quarter * coarse is exact",
        "coarse = xp.round(place * half) / half",
        "turns = quarter * coarse",
        "turns = turns - 8 * xp.round(turns / 8)",
        "phase = (turns + quarter * (place - coarse)) * basis.turn"
        + (" + basis.delta[:, None] * place" if corrected else ""),
        "sine, cosine = xp.sin(phase), xp.cos(phase)",
        "rotated = ((sine, cosine), (cosine, -sine), (-sine, -cosine), (-cosine, sine))[derivative % 4]",
        f"value: Array = {' + '.join(trig)}",
    ]
    if C != 0:
        lines.append(f"value = value + (-1) ** (derivative % 2) * {factor(C)}xp.exp(-gamma * place)")
    if D != 0:
        lines.append(f"value = value + {factor(D)}xp.exp(-gamma * (1 - place))")
    lines.append("value = value * gamma**derivative if derivative else value")
    if rigid:
        lines.append("if rigid:")
        lines.append("    value = xp.concat([_rigid_shapes(place, derivative), value])")
    lines += ["found: Array = xp.reshape(value, (value.shape[0], *places.shape))", "return found"]
    text = signature("shapes", "basis: Basis, x: ArrayLike, derivative: int = 0, rigid: bool = False", "Array")
    text += docstring(doc) + body(lines)
    if rigid:
        derivatives: list[list[Expr]] = [list(rigid)]
        while any(derivatives[-1]):
            derivatives.append([f.diff(x) for f in derivatives[-1]])
        place = Symbol("place", real=True)

        def written(f: Expr) -> str:
            return code(horner(f.subs(x, place))) if f.has(x) else f"zero + {code(f)}" if f != 0 else "zero"

        rows = [list(map(written, functions)) for functions in derivatives[:-1]]
        lines = [
            "zero = 0 * place",
            f"rows = [{', '.join('[' + ', '.join(row) + ']' for row in rows)}]",
            f"found = rows[derivative] if derivative < {len(rows)} else [zero] * {len(rigid)}",
            "value: Array = _namespace(place).concat(found)",
            "return value",
        ]
        doc = f"The {len(rigid)} rigid functions, roots γ = 0, or a derivative of them; place (1, n), result (R, n)."
        head = signature("_rigid_shapes", "place: Array, derivative: int", "Array")
        text = head + docstring(doc) + body(lines) + "\n\n" + text
    return text


def _apart(kernel: ColumnKernel) -> str:
    corrected = kernel.basis.roots.function is not None
    lines = [f"{name} = basis.{name}" for name in ("gamma", "quarter", *(["delta"] if corrected else []))]
    lines += [
        "squares = gamma * gamma",
        "apart = quarter[:, None] - quarter",
        "difference = apart * basis.turn" + (" + (delta[:, None] - delta)" if corrected else ""),
        "difference = difference * (gamma[:, None] + gamma) * (squares[:, None] + squares)",
        "inverse: Array = 1 / _namespace(gamma).where(apart == 0, 1.0, difference)",
        "return inverse",
    ]
    doc = (
        "1 / (γᵢ⁴ − γⱼ⁴), shape (N, N); 1 for i = j, where it has no part.\n\n"
        "The roots are subtracted before they are rounded: asymptotes and corrections apart.\n"
    )
    return "def _apart(basis: Basis) -> Array:\n" + docstring(doc) + body(lines)


def _matrix(kernel: ColumnKernel, matrix: MatrixProgram) -> str:
    R = len(kernel.rigid)
    modes = [e for _, e in matrix.mode_statements]
    border = [*matrix.rows, *matrix.columns]
    powers, replace = _powers([*modes, matrix.diagonal, *border])
    lines: list[str] = []
    every = (*modes, matrix.diagonal, *border, *(e for _, e in matrix.pair_statements), *matrix.entry)
    held = {str(s).removesuffix("_i").removesuffix("_j") for e in every for s in e.free_symbols}
    known = ["quarter", "gamma", "sigma", *(name for name, _, _ in kernel.basis.fields)]
    for name in known:
        if name in held or name == "quarter" or (name == "gamma" and powers):
            lines.append(f"{name} = basis.{name}")
    lines += powers
    lines += [
        f"{name} = {code(e.xreplace(replace))}"
        for name, e in matrix.mode_statements
        if e.xreplace(replace) != Symbol(name, real=True)
    ]
    diagonal = code(matrix.diagonal.xreplace(replace))
    letter = matrix.letter
    lines += [f"{name} = {code(e)}" for name, e in matrix.pair_statements]
    lines += _horner(letter, matrix.entry) if any(matrix.entry) else []
    if matrix.diagonal.is_number:
        diagonal = f"0 * quarter + {diagonal}"
    if any(matrix.entry):
        lines.append(f"{letter} = _namespace(quarter).where(quarter[:, None] == quarter, {diagonal}, {letter})")
    else:
        lines.append(f"{letter}: Array = _diagonal({diagonal}, quarter)")
    if R:
        lines += ["if rigid:"]
        if any(c != 0 for row in matrix.corner for c in row):
            lines += ["    one = 0 * basis.turn + 1  # in the numbers at hand"]
        corner = {(i, j): c for i, row in enumerate(matrix.corner) for j, c in enumerate(row) if c != 0}
        listed = ", ".join(f"{place}: {code(Symbol('one') * c)}" for place, c in corner.items())
        if any(matrix.rows):
            rows = [code(row.xreplace(replace)) if row != 0 else "0 * quarter" for row in matrix.rows]
            lines.append(f"    rows = ({', '.join(rows)},)")
        parameters = {p.symbol for p in kernel.column.parameters}
        varying = sorted(parameters & {s for e in (*corner.values(), *matrix.rows) for s in e.free_symbols}, key=str)
        if varying:  # as many matrices as parameters in the border
            lines.append(f"    {letter} = {letter} + {' + '.join(f'0 * {s}' for s in varying)}")
        lines.append(f"    {letter} = _bordered({letter}, {{{listed}}}{', rows' if any(matrix.rows) else ''})")
    lines.append(f"return {letter}")
    return matrix_head(kernel, matrix) + body(lines)


def _bordered(kernel: Kernel) -> str:
    """The function that puts the rigid functions first."""
    R = len(kernel.rigid)
    arguments = "matrix: Array, corner: dict[tuple[int, int], Any], rows: tuple[Array, ...] = ()"
    text = signature("_bordered", arguments, "Array")
    text += docstring(
        f"An elastic matrix with the corner and the rows of the {R} rigid function{'s' if R > 1 else ''} before it; "
        "what stands under the corner is zero, for rigid motion does not act on the elastic one.\n"
    )
    return text + body(
        [
            "N, xp = matrix.shape[-1], _namespace(matrix)",
            "if xp is np and matrix.ndim == 2:  # in place, which is faster",
            f"    whole = np.zeros(({R} + N, {R} + N), dtype=matrix.dtype)",
            f"    whole[{R}:, {R}:] = matrix",
            "    for place, entry in corner.items():",
            "        whole[place] = entry",
            "    for n, row in enumerate(rows):",
            f"        whole[n, {R}:] = row",
            "    return whole",
            "batch = matrix.shape[:-2]",
            'kind = {"dtype": matrix.dtype, "device": getattr(matrix, "device", None)}',
            "cell, wide = xp.zeros((*batch, 1, 1), **kind), xp.zeros((*batch, 1, N), **kind)",
            "above = []",
            f"for i in range({R}):",
            f"    cells = [cell + corner.get((i, j), 0.0) for j in range({R})]",
            "    above.append(xp.concat([*cells, wide + rows[i] if rows else wide], axis=-1))",
            f"below = xp.concat([xp.zeros((*batch, N, {R}), **kind), matrix], axis=-1)",
            "value: Array = xp.concat([*above, below], axis=-2)",
            "return value",
        ]
    )


def _horner(letter: str, parts: tuple[Expr, ...]) -> list[str]:
    """Σ parts[n] apartⁿ, a line a power."""
    if len(parts) == 1:
        return [f"{letter}: Array = {code(parts[0])}"]
    lines = ["apart = _apart(basis)"]
    for n in range(len(parts) - 1, -1, -1):
        annotated = f"{letter}: Array" if n == len(parts) - 1 else letter
        if n == len(parts) - 1:
            lines.append(f"{annotated} = {code(parts[n])}")
        elif parts[n] == 0:
            lines.append(f"{letter} = {letter} * apart")
        else:
            written = code(parts[n])
            added = (
                f"- {written[1:]}"
                if written.startswith("-") and parts[n].is_Mul
                else f"+ ({written})"
                if parts[n].is_Add
                else f"+ {written}"
            )
            lines.append(f"{letter} = {letter} * apart {added}")
    return lines


def _damping(kernel: Kernel) -> str:
    system = kernel.system
    passed = "".join(f", {p.name}={p.name}" for p in kernel.column.parameters)
    text = signature("damping_factors", f"alpha: float, beta: float{own(kernel)}", "tuple[float, float]")
    text += docstring("c_M and c_E of C = c_M M + c_E E: the external and the internal damping. Eq. (12).")
    text += body([f"return {number(system.c_M)}, {number(system.c_E)}"]) + "\n\n"
    text += matrix_signature(kernel, "damping", ", alpha: float, beta: float")
    text += docstring(
        f"Damping matrix C = c_M M + c_E E with c_M = {system.c_M}, c_E = {system.c_E}, nondimensional. "
        "Eqs. (11), (12)."
    )
    return text + body(
        [
            f"c_M, c_E = damping_factors(alpha, beta{passed})",
            f"return c_M * mass(basis, rigid{passed}) + c_E * stiffness_elastic(basis, rigid{passed})",
        ]
    )


def _force(kernel: Kernel) -> str:
    if not kernel.system.forces:
        return ""
    ((_, size),) = kernel.system.forces
    factor = "" if size == 1 else f"{code(size)} * "
    doc = (
        "Generalised force Q of Q F_0(t), shape (N,) or with the rigid functions first, nondimensional. "
        "Eq. (11), last line.\n\nQ[i] = φᵢ(x_F)\n\nx_F: place of the transversal force, 0 to 1.\n"
    )
    return (
        "def force(basis: Basis, x_F: float, rigid: bool = False) -> Array:\n"
        + docstring(doc)
        + f"{INDENT}return {factor}shapes(basis, x_F, rigid=rigid)\n"
    )


def _frequencies(kernel: ColumnKernel) -> str:
    if kernel.damped is None:
        return ""
    half, product = kernel.damped.half, kernel.damped.product
    used = {str(s) for e in (half, product) for s in e.free_symbols}
    arguments = f"gamma: Array, alpha: float = 0.0, beta: float = 0.0{own(kernel, used)}"
    text = signature("frequencies", arguments, "tuple[Any, Any]")
    text += docstring(
        "Both eigenvalues λ₀ of each mode of the unloaded beam, complex, each (N,), nondimensional. Eq. (23).\n\n"
        "The imaginary part is the damped frequency; where it vanishes the mode is overdamped. The first comes from "
        "the product of both, so that no digits cancel in heavy damping.\n"
    )
    lines = [
        "xp = _namespace(gamma)",
        "gamma = gamma.astype(np.complex128) if isinstance(gamma, np.ndarray) else gamma + 0j",
        *shared([("half", half), ("product", product)]),
    ]
    lines += ["second = -half - xp.sqrt(half * half - product)", "return product / second, second"]
    return text + body(lines)


def _forms(kernel: Kernel) -> str:
    """The bilinear forms as data."""
    text = signature("forms", f"one: Any = 1{own(kernel).replace(': float = ', ': Any = ')}", "dict[str, Any]")
    text += docstring(
        "The bilinear forms M, E, H: factors of ∫ xᵏ φᵢ⁽ᵖ⁾ φⱼ⁽ᑫ⁾ dx under (k, p, q), and of φᵢ⁽ᵖ⁾(a) φⱼ⁽ᑫ⁾(b) under "
        "(a, p, b, q). Eq. (11).\n\none: 1 as a number of the kind wanted, such as a fraction or an interval.\n"
    )
    lines = ["return {"]
    for letter, form in (("M", kernel.system.M), ("E", kernel.system.E), ("H", kernel.system.H)):
        along = ", ".join(f"{key}: {exact(value)}" for key, value in sorted(form.along.items()))
        points = ", ".join(f"({a}, {p}, {b}, {q}): {exact(value)}" for (a, p, b, q), value in form.points.items())
        lines.append(f'    "{letter}": ({{{along}}}, {{{points}}}),')
    return text + body([*lines, "}"])


def _equation_of_motion(kernel: Kernel) -> str:
    """The unforced equation of motion and the end conditions as data, for work without a series."""
    motion = kernel.motion
    arguments = f"P: Any, alpha: Any = 0, beta: Any = 0, one: Any = 1{own(kernel)}".replace(": float = ", ": Any = ")
    terms = []
    for j in jets(motion.strong):
        powers = Poly(motion.strong.coeff(j), x).all_coeffs()[::-1]
        terms.append(f"({j.args[1]}, {j.args[2]}): ({', '.join(exact(c) for c in powers)},)")
    text = signature("equation", arguments, "dict[tuple[int, int], tuple[Any, ...]]")
    text += docstring(
        "The equation of motion without force: (p, r) -> factor of ∂ᵖ⁺ʳy/∂xᵖ∂tʳ, ascending in powers of x. Eq. (6).\n"
    )
    text += body(["return {", *(f"    {term}," for term in terms), "}"]) + "\n\n"
    conditions = []
    for end, kind in enumerate(kernel.column.ends):
        rows = ["{(" + str(order) + ", 0): 1}" for order in GEOMETRIC[kind]]
        for order in range(2):
            if (end, order) in motion.natural:
                natural = motion.natural[end, order]
                rows.append(
                    "{"
                    + ", ".join(f"({j.args[1]}, {j.args[2]}): {exact(natural.coeff(j))}" for j in jets(natural))
                    + "}"
                )
        conditions.append(rows)
    text += signature("end_conditions", arguments, "tuple[Any, Any]")
    text += docstring("Two conditions at x = 0 and two at x = 1: (p, r) -> factor of ∂ᵖ⁺ʳy/∂xᵖ∂tʳ there. Eq. (15).\n")
    lines = ["return ("]
    for rows in conditions:
        lines += ["    (", *(f"        {row}," for row in rows), "    ),"]
    return text + body([*lines, ")"])


def _newmark(newmark: Newmark) -> str:
    vectors = ", ".join(f"{name}: Array" for name in ("M", "C", "K", "q", "dq", "ddq", "F"))
    method = "newmark: tuple[float, float] = (0.25, 0.5)"
    text = signature("newmark_step", f"{vectors}, h: float, {method}", "tuple[Array, Array, Array]")
    text += docstring(
        "One step of Newmark's method for Eq. (10): q, dq, ddq after a time h.\n\n"
        "M, C, K: (n, n). q, dq, ddq: (n,) or (n, cases), the state before. F: force after the step, like q. Matrices "
        "(..., n, n) want states (..., n, cases).\n"
        "newmark: its two parameters (b, g); (1/4, 1/2) is average acceleration. Order 2 for g = 1/2, else 1.\n"
    )
    lines = [
        "b, g = newmark",
        *(f"{name} = {code(expression, '_namespace(M)')}" for name, expression in newmark.formulas),
    ]
    text += body([*lines, "return q_next, dq_next, ddq_next"]) + "\n\n"
    text += signature("newmark_limit", f"xi: float, {method}", "float")
    text += docstring(
        "Largest stable ω h of Newmark's method for damping ratio xi; infinite where every step is stable.\n"
    )
    bounds = newmark.inverse_limit.args if isinstance(newmark.inverse_limit, Max) else (newmark.inverse_limit,)
    text += f"{INDENT}b, g = newmark\n"
    names = [f"bound_{n}" for n, bound in enumerate(bounds, start=1) if not bound.is_number]
    varying = [bound for bound in bounds if not bound.is_number]
    text += body(f"{name} = {code(bound, 'np')}" for name, bound in zip(names, varying, strict=True))
    text += f"{INDENT}inverse = max({', '.join(['0.0', *names])})\n"
    return text + f"{INDENT}return float(1 / inverse) if inverse else np.inf\n"


def _scales() -> str:
    listing = "\n".join(f"{name}: {UNITS[name]}" for name in SCALES)
    text = "def scales(bending_stiffness: float, mass_per_length: float, length: float) -> dict[str, float]:\n"
    text += docstring(
        "SI size of one nondimensional unit of each quantity, for a beam in SI units (N m², kg/m, m). Eq. (5).\n\n"
        + listing
        + "\n"
    )
    text += f"{INDENT}EI, m, L = bending_stiffness, mass_per_length, length\n"
    text += f"{INDENT}return {{\n"
    text += "".join(f'{INDENT}{INDENT}"{name}": float({code(e, "np")}),\n' for name, e in SCALES.items())
    return text + f"{INDENT}}}\n"


# --- modules ------------------------------------------------------------------------------------------------


def emit(kernel: Kernel) -> str:
    """The NumPy module of a column, as text. Deterministic to the byte for one version of SymPy.

    Raises StatementError for a parameter whose name the module gives to something else.
    """
    parts = polynomial_parts(kernel) if isinstance(kernel, PolynomialKernel) else _mode_parts(kernel)
    parts += [_damping(kernel), _force(kernel), _forms(kernel), _equation_of_motion(kernel)]
    parts += [_frequencies(kernel)] if isinstance(kernel, ColumnKernel) else []
    parts += [_newmark(kernel.newmark), _scales()]
    parts.append(own_functions("".join(parts)))
    text = "\n\n".join(part if part.endswith("\n") else part + "\n" for part in parts if part)
    _refuse_names(kernel, text)
    return text


def _refuse_names(kernel: Kernel, text: str) -> None:
    """A parameter named as something that the module calls so, or that a function it is given to does."""
    module = ast.parse(text)
    taken = {node.name for node in module.body if isinstance(node, ast.FunctionDef | ast.ClassDef)}
    for function in (node for node in module.body if isinstance(node, ast.FunctionDef)):
        if function.args.kwonlyargs:
            inside = [node for node in ast.walk(function) if isinstance(node, ast.Name)]
            taken |= {node.id for node in inside if isinstance(node.ctx, ast.Store)}
            taken |= {argument.arg for argument in function.args.args}
    for parameter in kernel.column.parameters:
        if parameter.name in taken:
            raise StatementError(f"parameter {parameter.name!r}: emitted code calls something else so; choose another")


def _mode_parts(kernel: Kernel) -> list[str]:
    assert isinstance(kernel, ColumnKernel)
    parts = [
        header(kernel, "the modes of the unloaded beam", f"Roots of {_equation(kernel)}."),
        metadata(kernel, ("x", "t", "P", "alpha", "beta", "F_0", "x_F", "gamma", "y"), {}),
        NAMESPACE,
        _basis(kernel),
        _shapes(kernel),
    ]
    if kernel.rigid:
        parts.append(_bordered(kernel))
    if any(len(m.entry) > 1 for m in kernel.matrices):
        parts.append(_apart(kernel))
    return [*parts, *(_matrix(kernel, matrix) for matrix in kernel.matrices)]
