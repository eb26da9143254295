"""What proves each step of a derivation, by another route than the stage's own. Eqs. (5)-(23).

Energies and forms are evaluated on motions that are polynomials, exactly (motions.py); modes and integrals are
evaluated at the first roots with 40 digits; Newmark's method and the rest are identities. `attach` gives every step
its proof: `Step.residual` runs it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace
from functools import cache, lru_cache, partial
from typing import Any

import mpmath
from sympy import Add, Expr, Function, Integer, Poly, S, Symbol, cancel, exp, expand, lambdify, legendre

from freebeam_derive import comparison, integrals, motions, newmark_proofs, roots, variation, variation_proofs
from freebeam_derive.bases import legendre as polynomials
from freebeam_derive.derivation import Derivation, GeneralDerivation
from freebeam_derive.independent import gauss
from freebeam_derive.motions import DIGITS
from freebeam_derive.notation import F_0, P, alpha, beta, chi, gamma, lambda_, t, x, y
from freebeam_derive.record import Step
from freebeam_derive.ritz import Form
from freebeam_derive.statement import ALONG, GEOMETRIC, Energies, Functional, delta, integral, jet, jets, show
from freebeam_derive.variation_proofs import own_values

MODES = 3  # first modes at which closed forms are compared with numbers

Proof = Callable[[Any, Step], Any]


def attach(derivation: Derivation | GeneralDerivation, steps: Iterable[Step]) -> Iterator[Step]:
    """The steps, each with its proof, and in `check` what it does. Raises KeyError for one that nothing here proves."""
    exact = motions.polynomial_in_x(derivation.motion.weak.density)
    for step in steps:
        if step.proof is None:
            if step.stage == newmark_proofs.STAGE:
                run: Callable[..., Any] = newmark_proofs.PROOFS[step.what]
                proof = partial(run, step)
            else:
                run = _PROOFS[step.stage, step.why[:2] if step.why[1:2] == ")" else step.what]
                proof = partial(run, derivation, step)
            # the docstring of a proof says what it does
            said = " ".join(str(run.__doc__).split()).removesuffix(".")
            if not exact and step.stage in ("scaling", "variation"):
                said = said.replace(", exactly", f", to {DIGITS} digits")
            step = replace(step, proof=proof, check=said)
        yield step


def _virtual(order: int, place: Expr) -> Expr:
    """A derivative along the beam of the virtual displacement, at a place."""
    return jet(Integer(1), Integer(order), Integer(0), place)


# --- Ritz -----------------------------------------------------------------------------------------------------


def form_value(form: Form, test: Expr, trial: Expr) -> Expr:
    """A bilinear form of two polynomials."""

    def moved(order: int, place: Expr) -> Expr:
        return jet(Integer(0), Integer(order), Integer(0), place)

    along = (f * x**k * _virtual(p, ALONG) * moved(q, ALONG) for (k, p, q), f in form.along.items())
    points = (f * _virtual(p, a) * moved(q, b) for (a, p, b, q), f in form.points.items())
    return expand(motions.value(Functional(Add(*along), Add(*points)), trial, test))


def _series(d: Derivation) -> tuple[Expr, tuple[tuple[Expr, Expr], ...]]:
    """A test function, and two trial functions with their coordinates."""
    test = motions.admissible(d.column.ends, S.One, 3)
    trials = tuple(motions.admissible(d.column.ends, S.One, seed) for seed in (5, 8))
    return test, tuple(zip(trials, (motions.polynomial(1, 3, t), motions.polynomial(4, 2, t)), strict=True))


def _linear(d: Derivation, step: Step) -> Any:
    """the weak form of a sum of two terms is the sum of their weak forms, on polynomials, exactly."""
    test, terms = _series(d)
    free = Functional(d.motion.weak.density, d.motion.weak.points.subs(F_0, 0))
    whole = motions.value(free, Add(*(phi * q for phi, q in terms)), test)
    return expand(whole - sum(motions.value(free, expand(phi * q), test) for phi, q in terms))


def _coordinates(d: Derivation, step: Step) -> Any:
    """the weak form with polynomials for the functions and the coordinates, exactly."""
    test, terms = _series(d)
    system, left = d.system, S.Zero
    for phi, q in terms:
        for form, rate in ((system.M, 2), (system.C, 1), (system.K, 0)):
            left += form_value(form, test, phi) * q.diff(t, rate)
    force = sum((size * test.subs(x, place) for place, size in system.forces), S.Zero) * motions.force()
    weak = motions.value(d.motion.weak, expand(Add(*(phi * q for phi, q in terms))), test)
    return expand(left - force - weak)


def _geometric(d: Derivation, step: Step) -> Any:
    """K less K at zero load is P times the load's matrix, on polynomials, exactly."""
    test, ((phi, _), _) = _series(d)
    whole = form_value(d.system.K, test, phi)
    return expand(whole - whole.subs(P, 0) - P * form_value(d.system.H, test, phi))


def _proportional(d: Derivation, step: Step) -> Any:
    """both sides on polynomials, exactly."""
    test, ((phi, _), _) = _series(d)
    system = d.system
    M, C, K = (form_value(form, test, phi) for form in (system.M, system.C, system.K))
    return expand(C - system.c_M * M - system.c_E * (K - P * form_value(system.H, test, phi)))


# --- modes ----------------------------------------------------------------------------------------------------


def _unloaded(d: Derivation, step: Step) -> Any:
    """Hamilton's principle again, for the statement without load and force."""
    energies = d.column.energies
    bare = {P: S.Zero, F_0: S.Zero}
    without = Energies(energies.T, energies.V, energies.W_c.subs(bare), energies.dW_nc.subs(bare))
    again = variation.derive(without, d.column.ends)
    return expand(step.after.lhs - show(again.strong))


def _separated(d: Derivation, step: Step) -> Any:
    """y = χ(x) e^(λ₀t) put into the equation of motion; a polynomial for χ into its natural conditions, exactly."""
    separated, *conditions = (relation.lhs for relation in step.after)
    moving, shape = exp(lambda_ * t), motions.polynomial(2, 6)
    left = [expand(step.before.lhs.subs(y, chi * moving).doit() - separated * moving)]
    for (_, derived), found in zip(sorted(d.motion.natural.items()), conditions, strict=True):
        at_end = show(derived.subs(P, 0)).replace(y.func, lambda place, time: shape.subs(x, place) * moving).doit()
        left.append(expand(at_end - found.replace(chi.func, lambda place: shape.subs(x, place)).doit() * moving))
    return tuple(left)


def _named(d: Derivation, step: Step) -> Any:
    """χ″″ = γ⁴ χ put into the separated equation leaves nothing."""
    equation, quartic = step.after
    inertia = step.before.lhs.subs(chi.diff(x, 4), quartic.rhs * chi)
    return (cancel(inertia), expand(equation.lhs.subs(chi.diff(x, 4), gamma**4 * chi)))


def _eigenvalues(d: Derivation, step: Step) -> Any:
    """put back, both solve the quadratic; sum and product are those of its coefficients."""
    one, other = step.after
    numerator, _ = (step.before.rhs - gamma**4).together().as_numer_denom()
    quadratic = Poly(numerator, lambda_)
    a, b, c = quadratic.all_coeffs()
    return tuple(
        expand(e) for e in (quadratic.as_expr().subs(lambda_, one), a * (one + other) + b, a * one * other - c)
    )


def _damped_ends(d: Derivation, step: Step) -> Any:
    """the natural conditions of a damped beam with these ends, from its own variation."""
    bending = Energies(
        integral(y.diff(t) ** 2) / 2,
        integral(y.diff(x, 2) ** 2) / 2,
        S.Zero,
        -integral(beta * y.diff(t) * delta(y) + alpha * y.diff(x, 2, t) * delta(y.diff(x, 2))),
    )
    natural = variation.derive(bending, d.column.ends).natural
    shape = motions.polynomial(2, 6)
    derived = [
        e.xreplace({j: lambda_ ** j.args[2] * shape.diff(x, j.args[1]).subs(x, j.args[3]) for j in jets(e)})
        for e in natural.values()
    ]
    held = [shape.diff(x, k).subs(x, end) for end, kind in enumerate(d.column.ends) for k in GEOMETRIC[kind]]
    # each is, up to its sign, one of those derived, or one that the support holds
    known = [*derived, *(-e for e in derived), *held]
    found = [e.lhs.replace(chi.func, lambda place: shape.subs(x, place)).doit() for e in step.after]
    return tuple(_one_of(f, known) for f in found)


def _struck_out(d: Derivation, step: Step) -> Any:
    """each condition is the factor times the other, or equal to it."""
    factors = (1 + lambda_ * alpha, S.One)
    pairs = zip(step.before, step.after, strict=True)
    return tuple(_one_of(one.lhs, [f * other.lhs for f in factors]) for one, other in pairs)


def _one_of(found: Expr, known: Iterable[Expr]) -> Expr:
    """Zero where an expression is one of those known, else a difference."""
    return min((expand(found - e) for e in known), key=lambda e: e != 0)


def _root_values(d: Derivation) -> list[mpmath.mpf]:
    return [root_of(d.beam, k) for k in range(MODES)]


def _characteristic(d: Derivation, step: Step) -> Any:
    """at the first three roots, bracketed to 40 digits, the determinant and both forms vanish."""
    forms = [lambdify(gamma, e.lhs - e.rhs, "mpmath") for e in step.after]
    conditions = lambdify(gamma, step.before, "mpmath")
    with mpmath.workdps(DIGITS + 15):
        found = []
        for g in _root_values(d):
            scale = mpmath.cosh(g)
            found += [mpmath.det(conditions(g)), forms[0](g), forms[1](g) / scale]
        return tuple(found)


@dataclass(frozen=True)
class Sampled:
    """The first modes at the nodes of a quadrature rule: nodes and weights, values[k][p] of φ_k^(p) there, and
    ends[k][p] at x = 0 and 1. 48 nodes leave 10^-60 of what is smooth to this degree."""

    nodes: list[Any]
    weights: list[Any]
    values: list[list[list[Any]]]
    ends: list[list[tuple[Any, Any]]]

    def integral(self, *factors: list[Any]) -> Any:
        """∫ of a product over the beam."""
        return mpmath.fsum(mpmath.fprod(row) for row in zip(self.weights, *factors, strict=True))

    def form(self, form: Form, i: int, j: int) -> Any:
        """A bilinear form of modes i and j (from 0); its factors are numbers."""
        return self._sum(form, self.values[i], self.ends[i], self.values[j], self.ends[j])

    def with_trial(self, form: Form, i: int, trial: Expr) -> Any:
        """The form of mode i as test function and a polynomial as trial function."""
        orders = [lambdify(x, trial.diff(x, q), "mpmath") for q in range(4)]
        values = [[mpmath.mpf(f(node)) for node in self.nodes] for f in orders]
        return self._sum(form, self.values[i], self.ends[i], values, [(f(0), f(1)) for f in orders])

    def _sum(self, form: Form, test: Any, test_ends: Any, trial: Any, trial_ends: Any) -> Any:
        total = mpmath.mpf(0)
        for (k, p, q), f in form.along.items():
            powers = [node**k for node in self.nodes]
            total += mpmath.mpf(f.p) / f.q * self.integral(powers, test[p], trial[q])
        for (a, p, b, q), f in form.points.items():
            total += mpmath.mpf(f.p) / f.q * test_ends[p][int(a)] * trial_ends[q][int(b)]
        return total


@cache
def sampled(beam: comparison.ComparisonBeam) -> Sampled:
    """The first MODES modes of a comparison beam, sampled with DIGITS digits. Eq. (22)."""
    with mpmath.workdps(DIGITS + 15):
        pairs = gauss(48, mpmath.mp.prec)
        values, ends = [], []
        for k in range(MODES):
            g, row, at_ends = root_of(beam, k), [], []
            for order in range(4):
                f = lambdify((x, gamma), beam.numeric(beam.mode(order), k + 1) * gamma**order, "mpmath")
                row.append([f(node, g) for node, _ in pairs])
                at_ends.append((f(mpmath.mpf(0), g), f(mpmath.mpf(1), g)))
            values.append(row)
            ends.append(at_ends)
        return Sampled([node for node, _ in pairs], [w for _, w in pairs], values, ends)


def _shapes(d: Derivation, step: Step) -> Any:
    """the fourth derivative is γ⁴ times the mode identically; at the first three roots all end conditions hold to 40
    digits."""
    found = [expand(d.beam.mode(4) - d.beam.mode())]
    with mpmath.workdps(DIGITS + 15):
        for row, g in zip(sampled(d.beam).ends, _root_values(d), strict=True):
            found += [row[order][end] / g**order for end, orders in enumerate(d.beam.orders) for order in orders]
    for order in range(4):
        found.append(expand(d.beam.mode(order + 1) - d.beam.mode(order).diff(x) / gamma))
    return tuple(found)


def _rigid(d: Derivation, step: Step) -> Any:
    """no fourth derivative, all end conditions, orthogonal: exactly."""
    left = [f.diff(x, 4) for f in d.beam.rigid]
    for f in d.beam.rigid:
        left += [f.diff(x, k).subs(x, end) for end, orders in enumerate(d.beam.orders) for k in orders]
    left += [motions.integral(expand(f * g), x, S.One) for i, f in enumerate(d.beam.rigid) for g in d.beam.rigid[:i]]
    return tuple(left)


def _geometric_ends(d: Derivation, step: Step) -> Any:
    """values at the supports of the first modes, 40 digits."""
    held = [(end, k) for end, kind in enumerate(d.beam.ends) for k in GEOMETRIC[kind]]
    return tuple(row[k][end] for row in sampled(d.beam).ends for end, k in held)


def _self_adjoint(d: Derivation, step: Step) -> Any:
    """the bracket of two polynomials that meet the conditions vanishes at both ends, exactly."""
    u, v = (Poly(motions.polynomial(seed, 9), x) for seed in (1, 2))
    left = []
    for end, orders in enumerate(d.beam.orders):
        # a Taylor polynomial about the end, without the orders that vanish there
        kept = ({k: c for (k,), c in w.terms() if k not in orders} for w in (u, v))
        f, g = (Poly(terms, x).compose(Poly(x - end, x)) for terms in kept)
        left.append(Add(*((-1) ** r * (f.diff((x, 3 - r)) * g.diff((x, r))).eval(end) for r in range(4))))
    return tuple(left)


def _positive_mass(d: Derivation, step: Step) -> Any:
    """Gram's matrix of the first modes by quadrature is diagonal and positive, 40 digits."""
    with mpmath.workdps(DIGITS):
        mass, found = Form({(0, 0, 0): S.One}), sampled(d.beam)
        gram = [[found.form(mass, i, j) for j in range(MODES)] for i in range(MODES)]
        bad = [gram[i][j] for i in range(MODES) for j in range(i)]
        return (*bad, *(mpmath.mpf(0 if gram[i][i] > 0 else 1) for i in range(MODES)))


# --- integrals and polynomials -----------------------------------------------------------------------------------


def closed_form(d: Derivation, expression: Expr, i: int, j: int) -> Any:
    """An integral's closed form at modes i and j (from 0), DIGITS digits."""
    values = {**_mode_values(d.beam, "i", i), **_mode_values(d.beam, "j", j)}
    symbols, function = _lambdified(expression)
    return function(*(values[s] for s in symbols))


@lru_cache(maxsize=64)
def _lambdified(expression: Expr) -> tuple[tuple[Symbol, ...], Callable[..., Any]]:
    symbols = tuple(sorted(expression.free_symbols, key=str))
    return symbols, lambdify(symbols, expression, "mpmath")


@cache
def _mode_values(beam: comparison.ComparisonBeam, suffix: str, k: int) -> dict[Symbol, Any]:
    """What the closed forms know of mode k: its root, its sign, its end values."""
    g = root_of(beam, k)
    values: dict[Symbol, Any] = {
        Symbol(f"gamma_{suffix}", positive=True): g,
        Symbol(f"sigma_{suffix}", real=True): mpmath.mpf((-1) ** k),
    }
    plain, named = integrals.end_values(beam).named, integrals.end_values(beam).of(suffix).named
    with mpmath.workdps(DIGITS + 15):
        for (_, e), (symbol, _) in zip(plain, named, strict=True):
            values[symbol] = lambdify(gamma, beam.numeric(e, k + 1), "mpmath")(g)
    return values


@cache
def root_of(beam: comparison.ComparisonBeam, k: int) -> mpmath.mpf:
    """The root of mode k (from 0), to more digits than are needed. Eq. (21)."""
    return roots.root(beam, k + 1, DIGITS + 10)


def _orthogonal(d: Derivation, step: Step) -> Any:
    """the closed forms against quadrature of the first three modes, 40 digits."""
    mass, bending, of_mass, of_bending = step.after
    with mpmath.workdps(DIGITS):
        left = []
        for different, same, p in ((mass, of_mass, 0), (bending, of_bending, 2)):
            form = Form({(0, p, p): S.One})
            left.append(sampled(d.beam).form(form, 0, 1) - closed_form(d, different, 0, 1))
            left += [sampled(d.beam).form(form, k, k) / closed_form(d, same, k, k) - 1 for k in range(MODES)]
        return tuple(left)


def _load_matrix(d: Derivation, step: Step) -> Any:
    """the closed forms against quadrature of the first three modes, all nine entries, 40 digits."""
    own = own_values(d.column)
    different, same = (relation.rhs.subs(own) for relation in step.after)
    form = d.system.H.map(lambda f: f.subs(own))
    pairs = [(i, j) for i in range(MODES) for j in range(MODES)]
    with mpmath.workdps(DIGITS):
        terms = [Form({key: f}) for key, f in form.along.items()] + [
            Form({}, {key: f}) for key, f in form.points.items()
        ]
        # an entry may vanish, and so may the sum of terms that do not: what is left is measured by the largest of terms
        size = max((abs(sampled(d.beam).form(term, i, j)) for term in terms for i, j in pairs), default=0) or 1
        found = (closed_form(d, same if i == j else different, i, j) for i, j in pairs)
        return tuple((sampled(d.beam).form(form, i, j) - f) / size for (i, j), f in zip(pairs, found, strict=True))


@cache
def trial_polynomials(ends: tuple[str, str], count: int = 6) -> tuple[Expr, ...]:
    basis = polynomials.polynomials(ends)
    return tuple(
        expand(sum(c * legendre(n, 2 * x - 1) for n, c in enumerate(polynomials.coefficients(basis, degree))))
        for degree in range(basis.first, basis.first + count)
    )


def _polynomials_taken(d: Derivation, step: Step) -> Any:
    """the formula written out for the first six; they meet the conditions and are orthogonal to one another and to the
    rigid functions, exactly."""
    formula, *weights = step.after
    right = formula.rhs.xreplace({weight.lhs: weight.rhs for weight in weights})
    first = polynomials.polynomials(d.column.ends).first
    left = []
    for degree, function in enumerate(trial_polynomials(d.column.ends), first):
        written = right.subs(polynomials.d, degree).doit()
        left.append(expand(written.replace(Function("P"), lambda n, _: legendre(n, 2 * x - 1)) - function))
    return (*left, *_polynomials_held(d, step))


def _polynomials_held(d: Derivation, step: Step) -> Any:
    """the first six meet the conditions and are orthogonal to one another and to the rigid functions, exactly."""
    functions, basis = trial_polynomials(d.column.ends), polynomials.polynomials(d.column.ends)
    left = [f.diff(x, c.order).subs(x, c.end) for f in functions for c in basis.conditions]
    everything = [*basis.rigid, *functions]
    left += [comparison.integral_polynomials(f, g) for i, f in enumerate(everything) for g in everything[:i]]
    return tuple(left)


def _norms(d: Derivation, step: Step) -> Any:
    """the squares of the first six integrated, exactly."""
    basis = polynomials.polynomials(d.column.ends)
    return tuple(
        comparison.integral_polynomials(f, f) - basis.norm.subs(polynomials.d, basis.first + n)
        for n, f in enumerate(trial_polynomials(d.column.ends))
    )


def _degrees(d: Derivation, step: Step) -> Any:
    """as many functions as dimensions, for every degree."""
    return step.before - step.after


def _differentiable(d: Derivation, step: Step) -> Any:
    """Legendre's identity for the slope, for the first four orders."""
    left = []
    for n in range(1, 5):
        p = [legendre(n + s, 2 * x - 1) for s in (-1, 0, 1)]
        left.append(expand(p[2].diff(x) - p[0].diff(x) - 2 * (2 * n + 1) * p[1]))
    return tuple(left)


_PROOFS: dict[tuple[str, str], Proof] = {
    **variation_proofs.PROOFS,
    ("Ritz series", "Approximate the deflection by a series"): _linear,
    ("Ritz series", "Substitute it into the weak form"): _coordinates,
    ("Ritz series", "Collect the equation of the coordinates"): _coordinates,
    ("Ritz series", "Split the geometric stiffness off"): _geometric,
    ("Ritz series", "Compare the damping with mass and elastic stiffness"): _proportional,
    ("modes", "Take the load and the force away"): _unloaded,
    ("modes", "Separate the variables"): _separated,
    ("modes", "Name the factor of χ"): _named,
    ("modes", "Solve for the eigenvalues"): _eigenvalues,
    ("modes", "Put the separated motion into the end conditions"): _damped_ends,
    ("modes", "Strike out the damping"): _struck_out,
    ("modes", "Set the determinant to zero"): _characteristic,
    ("modes", "Solve for the coefficients"): _shapes,
    ("modes", "Keep what the ends let move as a rigid body"): _rigid,
    ("modes", "1)"): _geometric_ends,
    ("modes", "2)"): _shapes,
    ("modes", "3)"): _self_adjoint,
    ("modes", "4)"): _positive_mass,
    ("integrals", "Integrate products of two modes"): _orthogonal,
    ("integrals", "Write the load's matrix in closed form"): _load_matrix,
    ("polynomials", "Take a polynomial of each degree that meets the geometric conditions"): _polynomials_taken,
    ("polynomials", "Integrate their squares"): _norms,
    ("polynomials", "1)"): _polynomials_held,
    ("polynomials", "2)"): _differentiable,
    ("polynomials", "3)"): _degrees,
    ("polynomials", "4)"): _norms,
}
