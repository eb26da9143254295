"""What follows of any column after its variation, as a record: series, matrices, shapes on segments, rigid motions.
Eqs. (9)-(13).

Each step has its proof with it. Forms are evaluated on motions that are polynomials on segments (motions.py), and never
by the rules that made them.
"""

from __future__ import annotations

from collections.abc import Iterable
from functools import partial
from itertools import combinations_with_replacement
from typing import Any

from sympy import (
    Add,
    Expr,
    Function,
    Integer,
    Matrix,
    Poly,
    Rational,
    S,
    Subs,
    Symbol,
    cancel,
    expand,
    legendre,
    reduced,
)

from freebeam_derive import motions, pieces
from freebeam_derive.assembly import bounded
from freebeam_derive.derivation import GeneralDerivation
from freebeam_derive.forms import BilinearForm, Value
from freebeam_derive.jets import ALWAYS, beside, leap, name_of, segment_of, trial, varying, virtual
from freebeam_derive.motions import Motion
from freebeam_derive.notation import F_0, P, t, x
from freebeam_derive.record import Step, equal
from freebeam_derive.statement import Functional, display, jet, jets, show
from freebeam_derive.variation import leaping
from freebeam_derive.variation_proofs import displaced, own_values

SERIES, SHAPES, RIGID = "series", "shapes", "rigid"
ORDERS = 6
"""First functions on a segment of which something is shown."""

q_j = Function("q_j")(t)
xi, k, length = Symbol("xi", real=True), Symbol("k", integer=True), Symbol("l", positive=True)


def steps(d: GeneralDerivation) -> tuple[Step, ...]:
    """From the weak form to the matrices, the shapes that they are made of, and what is left out of them."""
    return (*_series(d), *shapes(d), *_rigid(d))


# --- forms in trial functions ---------------------------------------------------------------------------------------


def component(name: str, index: str, coordinates: Iterable[str] = ()) -> Expr:
    """What trial function i or j is of an unknown: φ_i of the deflection, ψ_i of ψ, a number of a coordinate."""
    function = Function(f"phi_{index}" if name == "y" else f"trial_{name}_{index}", real=True)
    return function(t if name in coordinates else x)


def unknown_of(d: GeneralDerivation, name: str) -> Expr:
    """An unknown as a function of x and t, or of t."""
    where = ALWAYS if name in d.column.coordinates else d.motion.beam.along(0)
    return show(jet(trial(name), Integer(0), Integer(0), where))


def expression(d: GeneralDerivation, form: BilinearForm) -> Expr:
    """A form in the trial functions i and j: integrals over neighbouring segments as one, and products of values."""
    whole = functional(d, form)
    names = d.column.coordinates
    written: dict[Expr, Expr] = {}
    found = Functional(whole.density, leaping(whole.points))
    for j in jets(found.density + found.points):
        which, order, _, place = j.args
        function = component(name_of(which), "i" if virtual(which) else "j", names)
        derivative = function.diff(x, int(order)) if int(order) else function
        if place == ALWAYS or segment_of(place) is not None:
            written[show(j)] = derivative
        else:
            inside = int(order) or place.func in (beside, leap)
            written[show(j)] = Subs(derivative, x, place) if inside else derivative.subs(x, place)
    return display(found, S.One, d.motion.beam.cuts).xreplace(written)


def functional(d: GeneralDerivation, form: BilinearForm) -> Functional:
    """A form in jets: the test function as a variation, the trial function as a motion."""
    beam, names = d.motion.beam, d.column.coordinates

    def seen(value: Value, which: Expr) -> Expr:
        if value.place is None:
            return jet(which, Integer(0), Integer(0), ALWAYS)
        where = beside(value.place, Integer(value.side)) if value.side else value.place
        return jet(which, Integer(value.order), Integer(0), where)

    def along(name: str, order: int, which: Expr, segment: int) -> Expr:
        return jet(which, Integer(order), Integer(0), ALWAYS if name in names else beam.along(segment))

    density = S.Zero
    for key, factor in form.along.items():
        test = along(key.test, key.p, varying(key.test), key.segment)
        density += factor * test * along(key.trial, key.q, trial(key.trial), key.segment)
    points = Add(*(f * seen(a, varying(a.of)) * seen(b, trial(b.of)) for (a, b), f in form.points.items()))
    return Functional(expand(density), expand(points))


def form_value(d: GeneralDerivation, form: BilinearForm, test: Motion, of: Motion) -> Expr:
    """A form of two motions."""
    return motions.on(functional(d, form), d.motion.beam, of, test)


# --- the series -----------------------------------------------------------------------------------------------------


def _trials(d: GeneralDerivation) -> tuple[Motion, tuple[tuple[Motion, Expr], ...]]:
    """A test function, and two trial functions with their coordinates."""
    rates = (motions.polynomial(1, 3, t), motions.polynomial(4, 2, t))
    return displaced(d, 3), tuple(zip((displaced(d, 5), displaced(d, 8)), rates, strict=True))


def _bounded_weak(d: GeneralDerivation) -> Functional:
    return Functional(d.motion.weak.density, bounded(d.motion))


def _left(d: GeneralDerivation, found: Expr) -> Any:
    return motions.settled(found, own_values(d.column))


def _series(d: GeneralDerivation) -> tuple[Step, ...]:
    found = (_approximated(d), *_natural(d), _substituted(d), _collected(d))
    return (*found, *_unsymmetric(d))


def _approximated(d: GeneralDerivation) -> Step:
    coordinates = d.column.coordinates
    series = []
    for name in (*d.column.fields, *coordinates):
        series.append(equal(unknown_of(d, name), Symbol("Sigma_j") * component(name, "j", coordinates) * q_j))

    def linear() -> Any:
        test, terms = _trials(d)
        free = _bounded_weak(d).map(lambda part: part.subs(F_0, 0))
        whole, each = motions.scaled(test, S.Zero), S.Zero
        for phi, q in terms:
            whole = motions.added(whole, motions.scaled(phi, q))
            each += motions.on(free, d.motion.beam, motions.scaled(phi, q), test)
        return _left(d, motions.on(free, d.motion.beam, whole, test) - each)

    return Step(
        SERIES,
        "Approximate all unknowns by one series",
        "trial function j is a motion of the whole column, with a share in each unknown; how large "
        "it is at each time is its coordinate",
        d.column.name,
        tuple(series),
        "Eq. (9)",
        "the weak form of a sum of two terms is the sum of their weak forms, on polynomials",
        linear,
    )


def _natural(d: GeneralDerivation) -> tuple[Step, ...]:
    """Where a value that no energy bounds is replaced by what a natural condition says of it."""
    instead = bounded(d.motion)
    if expand(instead - d.motion.weak.points) == 0:
        return ()

    def divided() -> Any:
        difference = expand(d.motion.weak.points - instead)
        conditions = [c.factor for c in d.motion.conditions if c.factor != 0]
        _, rest = reduced(difference, conditions, *jets(Add(difference, *conditions)), domain="EX")
        return rest

    return (
        Step(
            SERIES,
            "Use a natural condition where no energy bounds a value",
            "a series of functions that need not meet the condition would not converge there",
            show(leaping(d.motion.weak.points)),
            show(leaping(instead)),
            "",
            "the difference is a multiple of a natural condition: divided by the conditions nothing is left",
            divided,
        ),
    )


def _matrices(d: GeneralDerivation) -> dict[str, tuple[BilinearForm, ...]]:
    return {"M": d.system.M, "C": d.system.C, "K": d.system.K}


def _entry(letter: str, power: int, count: int) -> Symbol:
    return Symbol(f"{letter}^{power}_ij" if count > 1 else f"{letter}_ij")


def _substituted(d: GeneralDerivation) -> Step:
    stated = [
        equal(_entry(letter, power, len(forms)), expression(d, form))
        for letter, forms in _matrices(d).items()
        for power, form in enumerate(forms)
        if form
    ]
    names = d.column.coordinates
    pushed = ((component(v.of, "i", names), v.place, factor) for v, factor in d.system.force)
    force = Add(*(factor * (f if place is None else f.subs(x, place)) for f, place, factor in pushed))
    if d.system.force:
        stated.append(equal(Symbol("Q_i"), F_0 * force))
    return Step(
        SERIES,
        "Substitute it into the weak form",
        "what multiplies accelerations, rates and coordinates are the matrices, sorted by powers of the load; row i is "
        "the test function, column j the motion",
        equal(display(_bounded_weak(d), S.One, d.motion.beam.cuts), 0),
        tuple(stated),
        "Eq. (11)",
        "the weak form with polynomials for the functions and the coordinates",
        partial(_as_matrices, d),
    )


def _as_matrices(d: GeneralDerivation) -> Any:
    """Σ P^k (M_k q̈ + C_k q̇ + K_k q) less the force, less the weak form."""
    test, terms = _trials(d)
    total, whole = S.Zero, motions.scaled(test, S.Zero)
    for phi, q in terms:
        for forms, rate in ((d.system.M, 2), (d.system.C, 1), (d.system.K, 0)):
            for power, form in enumerate(forms):
                total += P**power * form_value(d, form, test, phi) * (q.diff(t, rate) if rate else q)
        whole = motions.added(whole, motions.scaled(phi, q))
    forces = Add(*(factor * F_0 * _seen(d, value) for value, factor in d.system.force))
    total -= motions.on(Functional(S.Zero, forces), d.motion.beam, whole, test)
    return _left(d, total - motions.on(_bounded_weak(d), d.motion.beam, whole, test))


def _seen(d: GeneralDerivation, value: Value) -> Expr:
    place = ALWAYS if value.place is None else value.place
    return jet(varying(value.of), Integer(value.order), Integer(0), place)


def _collected(d: GeneralDerivation) -> Step:
    left = S.Zero
    for rate, (letter, forms) in zip((2, 1, 0), _matrices(d).items(), strict=True):
        whole = Add(*(P**power * _entry(letter, power, len(forms)) for power, form in enumerate(forms) if form))
        left += whole * (q_j.diff(t, rate) if rate else q_j)
    right = Symbol("Q_i") if d.system.force else S.Zero
    return Step(
        SERIES,
        "Collect the equation of the coordinates",
        "one equation for each test function; repeated indices are summed",
        d.column.name,
        equal(left, right),
        "Eq. (10)",
        "the weak form with polynomials for the functions and the coordinates",
        partial(_as_matrices, d),
    )


def _less_transposed(form: BilinearForm) -> BilinearForm:
    """A form less its transpose."""
    other = form.transposed
    along, points = dict(form.along), dict(form.points)
    for key, factor in other.along.items():
        along[key] = along.get(key, S.Zero) - factor
    for pair, factor in other.points.items():
        points[pair] = points.get(pair, S.Zero) - factor
    return BilinearForm(
        {key: f for key, v in along.items() if (f := expand(v)) != 0},
        {key: f for key, v in points.items() if (f := expand(v)) != 0},
    )


def _unsymmetric(d: GeneralDerivation) -> tuple[Step, ...]:
    """What is left of C and K when their transposes are taken off: gyroscopic and circulatory parts."""
    found: list[tuple[str, int, int, BilinearForm, BilinearForm]] = []
    for letter in "CK":
        forms = _matrices(d)[letter]
        skew = [(power, form, _less_transposed(form)) for power, form in enumerate(forms)]
        found += [(letter, power, len(forms), form, part) for power, form, part in skew if part]
    if not found:
        return ()

    def apart() -> Any:
        f, g = displaced(d, 3), displaced(d, 6)
        return tuple(
            _left(d, form_value(d, part, f, g) - form_value(d, form, f, g) + form_value(d, form, g, f))
            for *_, form, part in found
        )

    def transposed(symbol: Symbol) -> Symbol:
        return Symbol(str(symbol).replace("_ij", "_ji"))

    entries = [_entry(letter, power, count) for letter, power, count, *_ in found]
    return (
        Step(
            SERIES,
            "Take the transposes off",
            "a symmetric matrix leaves nothing. What C leaves is gyroscopic and does no work; what K leaves is "
            "circulatory, and gives or takes work over a cycle",
            tuple(equal(entry, expression(d, form)) for entry, (*_, form, _) in zip(entries, found, strict=True)),
            tuple(
                equal(entry - transposed(entry), expression(d, part))
                for entry, (*_, part) in zip(entries, found, strict=True)
            ),
            "",
            "the form less its transpose, on polynomials",
            apart,
        ),
    )


# --- shapes on a segment --------------------------------------------------------------------------------------------

CORNERS = {1: (1 - xi, xi), 2: tuple(map(expand, (
    1 - 3 * xi**2 + 2 * xi**3, xi - 2 * xi**2 + xi**3, 3 * xi**2 - 2 * xi**3, xi**3 - xi**2,
)))}  # fmt: skip
"""Functions of unit value (and slope) at an end of a segment, 0 ≤ ξ ≤ 1."""


def bubble(joined: int, order: Any) -> Expr:
    """The function of an order k ≥ joined that vanishes, with its slope if joined twice, at both ends."""
    p = Function("P")
    n, place = order, 2 * xi - 1
    if joined == 0:
        return p(n, place)
    if joined == 1:
        return p(n + 1, place) - p(n - 1, place)
    return (2 * n - 1) * p(n + 2, place) - (4 * n + 2) * p(n, place) + (2 * n + 3) * p(n - 2, place)


def _written(joined: int, order: int) -> Expr:
    return expand(bubble(joined, order).replace(Function("P"), legendre))


def shapes(d: GeneralDerivation) -> tuple[Step, ...]:
    """The functions on each segment, how they are joined, and why they will do. Section 3.1."""
    found: list[Step] = []
    for joined in sorted({space.joined for space in d.motion.spaces}, reverse=True):
        names = [space.name for space in d.motion.spaces if space.joined == joined]
        found += _on_a_segment(joined, ", ".join(names))
    return tuple(found)


def _on_a_segment(joined: int, names: str) -> tuple[Step, ...]:
    corners = CORNERS.get(joined, ())
    bubbles = equal(Symbol("b_k"), bubble(joined, k))

    def ends() -> Any:
        left: list[Any] = []
        for n in range(max(joined, 0), joined + ORDERS):
            f = _written(joined, n)
            left += [f.diff(xi, r).subs(xi, end) if r else f.subs(xi, end) for r in range(joined) for end in (0, 1)]
        for number, f in enumerate(corners):
            values = [f.diff(xi, r).subs(xi, end) if r else f.subs(xi, end) for end in (0, 1) for r in range(joined)]
            left += [value - int(number == n) for n, value in enumerate(values)]
        return tuple(left)

    def independent() -> Any:
        functions = [*corners, *(_written(joined, n) for n in range(joined, joined + ORDERS))]
        rows = [Poly(f, xi).all_coeffs()[::-1] for f in functions]
        size = len(functions)
        square = Matrix(size, size, lambda i, n: rows[i][n] if n < len(rows[i]) else 0)
        return Integer(0 if square.det() != 0 and max(map(len, rows)) == size else 1)

    def orthogonal() -> Any:
        order = joined
        some = [_written(joined, n) for n in range(joined, joined + ORDERS)]
        high = [f.diff(xi, order) if order else f for f in some]
        pairs = [(f, g) for i, f in enumerate(high) for g in high[:i]]
        return tuple(motions.integral(expand(f * g), xi, S.One) for f, g in pairs)

    steps: list[Step] = []
    what = {0: "Take Legendre's polynomials", 1: "Take values at both ends and bubbles", 2: "Take values and slopes at "
            "both ends and bubbles"}[joined]  # fmt: skip
    steps.append(
        Step(
            SHAPES,
            f"{what} for {names}",
            "ξ runs from 0 to 1 along a segment; "
            + ("nothing need be continuous" if not joined else "what two segments share at a break is one coordinate")
            + "; P with an index is Legendre's polynomial",
            names,
            (*(equal(Symbol(f"e_{n}"), f) for n, f in enumerate(corners, 1)), bubbles),
            "",
            "values and slopes of the first six bubbles vanish at both ends, and those of the others are one or zero"
            if joined
            else "nothing is asked of them",
            ends,
        )
    )
    steps.append(
        Step(
            SHAPES,
            f"Count them for {names}",
            "as many functions as a polynomial has coefficients, and none is a sum of others: with N every polynomial "
            "of degree N + 1 is among them, so that the series can come as near to any motion as one likes",
            names,
            names,
            "",
            "the determinant of the coefficients of the first of them is not zero",
            independent,
        )
    )
    steps.append(
        Step(
            SHAPES,
            f"Integrate products of the bubbles for {names}",
            "their highest derivatives that the energy holds are multiples of Legendre's polynomials, so that two "
            "different bubbles do not couple in a uniform segment, and all numbers stay of one size",
            names,
            names,
            "",
            "integrals of the products of the first six, two by two",
            orthogonal,
        )
    )
    if joined == 2:
        steps.append(_beam_element())
    return tuple(steps)


def _beam_element() -> Step:
    """Bending stiffness of a segment in the four functions of its ends: the beam element of every textbook."""
    cubics = CORNERS[2]
    sizes = (S.One, length, S.One, length)

    def entry(i: int, j: int) -> Expr:
        whole = motions.integral(expand(cubics[i].diff(xi, 2) * cubics[j].diff(xi, 2)), xi, S.One)
        return sizes[i] * sizes[j] * whole / length**3

    matrix = Matrix(4, 4, entry)

    def tables() -> Any:
        table = pieces._moment((2, 2), (2, 2), 8, 0)
        return tuple(
            cancel(matrix[i, j] * length**3 / sizes[i] / sizes[j] - Rational(int(table[i][j].p), int(table[i][j].q)))
            for i, j in combinations_with_replacement(range(4), 2)
        )

    return Step(
        SHAPES,
        "Write the bending stiffness of a segment",
        "for the values and slopes at its ends, with the length l and EI = 1: the stiffness matrix of the beam element "
        "of any textbook. The bubbles are what this method has beyond it",
        "values and slopes",
        equal(Symbol("K_e"), matrix.as_immutable()),
        "",
        "integrals of polynomials made by Rodrigues' formula, in fractions",
        tables,
    )


# --- rigid motions --------------------------------------------------------------------------------------------------


def _as_motion(d: GeneralDerivation, rigid: dict[tuple[str, Any], Expr]) -> Motion:
    count = len(d.motion.beam.segments)
    found: dict[str, Any] = {
        space.name: tuple(rigid.get((space.name, n), S.Zero) for n in range(count)) for space in d.motion.spaces
    }
    return found | {name: rigid.get((name, None), S.Zero) for name in d.column.coordinates}


def _rigid(d: GeneralDerivation) -> tuple[Step, ...]:
    """The rigid motions that decide nothing, with what the load makes of them."""
    if not d.system.rigid:
        return ()
    rigid = [_as_motion(d, r) for r in d.system.rigid]
    rows = [displaced(d, seed) for seed in range(3, 3 + 2 * len(rigid) + 2)]
    mass = Matrix([[form_value(d, d.system.M[0], f, r) for r in rigid] for f in rows])

    def among(form: BilinearForm) -> Any:
        """What is left of K r when the inertia forces of rigid motions that fit it best are taken off."""
        forces = Matrix([[form_value(d, form, f, r) for r in rigid] for f in rows])
        first = mass[: len(rigid), :]
        if first.det() == 0:
            raise AssertionError("rigid: the test functions do not tell the motions apart")
        fit = first.LUsolve(forces[: len(rigid), :])
        return tuple(cancel(e) for e in (forces - mass * fit))

    def invariant() -> Any:
        elastic = (form_value(d, d.system.K[0], f, r) for f in rows for r in rigid)
        return (*(cancel(e) for e in elastic), *(e for form in d.system.K[1:] if form for e in among(form)))

    shown = [
        equal(unknown_of(d, name), u[0] if isinstance(u, tuple) else u)
        for r in rigid
        for name, u in r.items()
        if not isinstance(u, tuple) or len(set(u)) == 1
        if u not in (S.Zero, (S.Zero,) * len(d.motion.beam.segments))
    ]
    return (
        Step(
            RIGID,
            "Leave out the rigid motions that decide nothing",
            "they bend nothing, and the load turns them into inertia forces of rigid motions alone: with them in front "
            "the matrices are block triangular, and the other eigenvalues are what they are without them",
            d.column.name,
            tuple(shown) or len(rigid),
            "section 3.1",
            "elastic forces of these motions on test functions, which vanish; and forces of the load, less inertia "
            "forces of rigid motions",
            invariant,
        ),
    )
