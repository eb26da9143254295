"""Polynomials on segments: exact matrices, joints and jumps of the functions, spectra and critical loads of columns."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from types import ModuleType
from typing import Any

import numpy as np
import pytest
import sympy as sp
from flint import fmpq
from scipy.linalg import eigvals

import freebeam_kernels.beck_legendre as beck_legendre
from freebeam_derive import emit, verify
from freebeam_derive.bases.segments import kernel_of
from freebeam_derive.forms import Along, BilinearForm, GeneralSystem, Space, Value
from freebeam_derive.notation import alpha, beta, x, x_F
from freebeam_derive.statement import Parameter, StatementError
from freebeam_derive.units import SCALES, Quantity
from freebeam_derive.verify import VerificationError
from freebeam_sym.stability.pencil import diagonalise

ZERO, ONE, HALF = sp.S.Zero, sp.S.One, sp.S.Half
CLAMPED = frozenset({(0, 0), (0, 1)})
TIP, TURN = Value("y", 0, ONE), Value("y", 1, ONE)
a, b, mu, c, k = (sp.Symbol(name, real=True) for name in ("a", "b", "mu", "c", "k"))


@dataclass(frozen=True)
class Facts:
    """What a module says of its column."""

    parameters: tuple[Parameter, ...] = ()
    name: str = "any"
    title: str = "Any column"
    module: str = "any"
    damping: tuple[str, ...] = ("alpha", "beta")
    source: str = ""
    basis: str = "segments"
    modes: int = 12
    ends: Any = ("clamped", "free")
    quantities: Mapping[str, Quantity] = field(default_factory=dict)
    scales: Mapping[str, sp.Expr] = field(default_factory=lambda: SCALES)

    def supports(self, name: str) -> tuple[str, str]:
        return self.ends


def parameter(symbol: sp.Symbol, default: float, low: float, high: float) -> Parameter:
    return Parameter(symbol, "of the test", default, low, high)


def along(p: int, q: int, factors: Sequence[Any], of: str = "y", by: str = "y") -> dict[Along, sp.Expr]:
    """∫ factor Dᵖ of D^q by dx, factors by the segment."""
    return {Along(s, of, p, by, q): sp.sympify(f) for s, f in enumerate(factors) if f != 0}


def column(
    breaks: Sequence[Any] = (ZERO, ONE),
    stiffness: Sequence[Any] | None = None,
    mass: Sequence[Any] | None = None,
    masses: dict[Any, Any] | None = None,
    springs: dict[Any, Any] | None = None,
    held: frozenset[tuple[int, int]] = CLAMPED,
    opened: frozenset[tuple[int, int]] = frozenset(),
    parameters: tuple[Parameter, ...] = (),
    load: BilinearForm | None = None,
    **more: Any,
) -> GeneralSystem:
    """Beck's column, with what makes it another."""
    each = [ONE] * (len(breaks) - 1)
    EI, m = stiffness or each, mass or each
    follower = BilinearForm(along(1, 1, [-f for f in each]), {(TIP, TURN): ONE})
    return GeneralSystem(
        tuple(map(sp.sympify, breaks)),
        (Space("y", "y", 2, held, opened),),
        (),
        (BilinearForm(along(0, 0, m), masses or {}),),
        (BilinearForm({**along(0, 0, [beta * f for f in m]), **along(2, 2, [alpha * f for f in EI])}, {}),),
        (BilinearForm(along(2, 2, EI), springs or {}), load or follower),
        ((Value("y", 0, x_F), ONE),),
        parameters=parameters,
        **more,
    )


def jump(place: Any, order: int, factor: Any) -> dict[Any, Any]:
    """factor · (jump of the order-th derivative)²/2 as a form."""
    right, left = Value("y", order, place, 1), Value("y", order, place, -1)
    return {(r, s): factor * (1 if r == s else -1) for r in (right, left) for s in (right, left)}


def emitted(system: GeneralSystem) -> ModuleType:
    return verify.load(emit.emit(kernel_of(Facts(system.parameters), system)), "any")


PFLUEGER = column(masses={(TIP, TIP): mu}, parameters=(parameter(mu, 1, 0, 2),))
CRACKED = column(
    (0, a, 1), springs=jump(a, 1, k), opened=frozenset({(1, 1)}),
    parameters=(parameter(a, 0.4, 0.1, 0.9), parameter(k, 10, 1, 100)),
)  # fmt: skip
STEPPED = column((0, HALF, 1), stiffness=[ONE, HALF])
TAPERED = column(
    stiffness=[(1 - c * x) ** 3], mass=[1 - c * x], parameters=(parameter(c, 0.5, 0, 0.75),),
)  # fmt: skip
EXPONENTIAL = column((0, HALF, 1), stiffness=[sp.exp(-c * x), ONE], parameters=(parameter(c, 0.5, 0, 2),))
SHEAR = column((0, a, 1), springs=jump(a, 0, k), opened=frozenset({(1, 0)}), parameters=CRACKED.parameters)
POINT = Value("y", 0, b)
MASS_ANYWHERE = column(
    (0, HALF, 1), masses={(POINT, POINT): mu}, parameters=(parameter(mu, 0.5, 0, 2), parameter(b, 0.5, 0, 1)),
)  # fmt: skip
BEAL = column(
    (0, HALF, 1), held=frozenset(), parameters=(parameter(k, 0.1, 0, 1), parameter(b, 0.25, 0, 1)),
    load=BilinearForm(along(1, 1, [-x, -x]), {(TIP, TURN): ONE, (TIP, Value("y", 1, b)): k}),
    rigid=({("y", 0): ONE, ("y", 1): ONE}, {("y", 0): x, ("y", 1): x}),
)  # fmt: skip
_q = Value("q")
ABSORBER = replace(
    column((0, HALF, 1), parameters=(parameter(b, 0.5, 0, 1), parameter(mu, 0.1, 0, 1), parameter(k, 3, 0, 9))),
    coordinates=(("q", "q"),),
    M=(BilinearForm(along(0, 0, [1, 1]), {(_q, _q): mu}),),
    C=(
        BilinearForm({**along(0, 0, [beta, beta])}, {(_q, TIP): ONE, (TIP, _q): -ONE}),
        BilinearForm({}, {(TIP, TIP): k}),
    ),
    K=(
        BilinearForm(
            {**along(2, 2, [1, 1]), **along(0, 1, [x, 1], "q", "y")},
            {(_q, _q): k, (_q, POINT): -k, (POINT, _q): -k, (POINT, POINT): k},
        ),
        BilinearForm(along(1, 1, [-1, -1]), {(TIP, TURN): ONE}),
    ),
)
TIMOSHENKO = GeneralSystem(
    (ZERO, HALF, ONE),
    (Space("y", "y", 1, frozenset({(0, 0)})), Space("psi", r"\psi", 1, frozenset({(0, 0)})), Space("w", "w", 0)),
    (),
    (
        BilinearForm(
            {**along(0, 0, [1, 1]), **along(0, 0, [mu, mu], "psi", "psi"), **along(0, 0, [1, x], "w", "w")}, {}
        ),
    ),
    (BilinearForm({**along(0, 0, [1 + x, 1], "y", "psi"), **along(0, 0, [-1 - x, -1], "psi", "y")}, {}),),
    (
        BilinearForm(
            {
                **along(1, 1, [1, 1], "psi", "psi"), **along(0, 0, [k, k], "psi", "psi"), **along(1, 1, [k, k]),
                **along(1, 0, [-k, -k], "y", "psi"), **along(0, 1, [-k, -k], "psi", "y"),
                **along(0, 0, [1, 1], "w", "w"),
            },
            {},
        ),
        BilinearForm(along(1, 1, [-1, -1]), {(TIP, Value("psi", 0, ONE)): ONE}),
    ),
    parameters=(parameter(mu, 0.001, 0, 1), parameter(k, 1000, 1, 1e6)),
)  # fmt: skip
TWENTY = column([sp.Rational(n, 20) for n in range(21)])
SYSTEMS = {
    "pflueger": PFLUEGER, "cracked": CRACKED, "stepped": STEPPED, "tapered": TAPERED, "exponential": EXPONENTIAL,
    "shear joint": SHEAR, "mass anywhere": MASS_ANYWHERE, "beal": BEAL, "absorber": ABSORBER, "timoshenko": TIMOSHENKO,
}  # fmt: skip


@pytest.mark.parametrize("system", SYSTEMS.values(), ids=[*SYSTEMS])
def test_matrices_are_the_integrals(system: GeneralSystem) -> None:
    """Exactly in fractions for polynomial data; within the bounds in floats."""
    kernel = kernel_of(Facts(system.parameters), system)
    figures = verify.verify(kernel, emit.emit(kernel))
    assert all(figure.error <= figure.bound for figure in figures)


def test_twenty_segments_of_the_same_beam_are_that_beam() -> None:
    """No digit is lost to twenty pieces, nor to polynomials of degree 201."""
    whole = beck_legendre.basis(16)
    squares, _ = diagonalise(beck_legendre.mass(whole), beck_legendre.stiffness_elastic(whole))
    lowest = np.sqrt(squares[:3])
    for system, N in ((TWENTY, 12), (column(), 200)):
        module = emitted(system)
        basis = module.basis(N)
        squares, _ = diagonalise(module.mass(basis), module.stiffness(basis, 0))
        assert np.sqrt(squares[:3]) == pytest.approx(lowest, rel=1e-11)


@pytest.mark.parametrize(("system", "N"), [(column(), 200), (TWENTY, 12)], ids=["N = 200", "20 x 12"])
def test_well_conditioned_after_diagonal_scaling(system: GeneralSystem, N: int) -> None:
    """The bending stiffness, each function scaled to energy 1, has the condition of cubic elements alone."""
    module = emitted(system)
    K = module.stiffness(module.basis(N), 0)
    root = np.sqrt(np.diag(K))
    elements = module.stiffness(module.basis(2), 0)
    few = np.sqrt(np.diag(elements))
    bare = np.linalg.cond(elements / np.outer(few, few))
    assert np.linalg.cond(K / np.outer(root, root)) <= 1.01 * bare < 1e7


@pytest.mark.parametrize("P", [0.0, 7.0, 19.0])
def test_one_segment_spans_what_the_polynomials_of_the_whole_beam_do(P: float) -> None:
    """Beck's column in either basis has the same matrices but for the coordinates, so the same spectrum."""
    module, N = emitted(column()), 10
    basis, other = module.basis(N), beck_legendre.basis(N)
    K = beck_legendre.stiffness_elastic(other) + P * beck_legendre.stiffness_load(other)
    found = np.sort_complex(eigvals(np.linalg.solve(module.stiffness(basis, P), module.mass(basis))))
    expected = np.sort_complex(eigvals(np.linalg.solve(K, beck_legendre.mass(other))))
    assert np.abs(found - expected).max() <= 1e-12 * np.abs(expected).max()


def first_flutter(module: ModuleType, N: int, low: float, high: float, **own: float) -> float:
    """The load between two where an undamped pair of frequencies meets: λ² of M λ² + K becomes complex."""
    basis = module.basis(N)
    M, terms = module.mass(basis, **own), module.stiffness_terms(basis, **own)
    squares, vectors = diagonalise(M, terms[0])
    load = vectors.T @ terms[1] @ vectors / np.sqrt(np.outer(squares, squares))

    def growing(P: float) -> bool:
        inverse = eigvals(np.diag(1 / squares) @ np.linalg.inv(np.eye(len(squares)) + P * load))
        lead = inverse[np.argsort(-np.abs(inverse))[:2]]
        return bool(np.abs(lead.imag).max() > 0)

    for _ in range(60):
        middle = (low + high) / 2
        low, high = (low, middle) if growing(middle) else (middle, high)
    return (low + high) / 2


@pytest.mark.parametrize(
    ("system", "N", "own", "near", "expected"),
    [
        (column(), 12, {}, 20, 20.0509536189),
        (PFLUEGER, 12, {"mu": 1.0}, 16, 16.2121289425),
        (MASS_ANYWHERE, 12, {"mu": 0.5, "b": 0.5}, 23, 22.8770428843),
        (STEPPED, 12, {}, 12.7, 12.7155928090377),
        (TAPERED, 14, {"c": 0.5}, 8.4, 8.4207877434),
        (column(springs={(TIP, TIP): 10 * ONE}), 12, {}, 24, 24.2240402684),
        (column((0, HALF, 1), springs={(TIP, TIP): 10 * ONE}), 10, {}, 24, 24.2240402684),
    ],
    ids=["beck", "pflueger", "mass at mid-span", "stepped", "tapered", "tip spring", "tip spring, two segments"],
)
def test_flutter_loads_to_the_digits_that_are_known(
    system: GeneralSystem, N: int, own: dict[str, float], near: float, expected: float
) -> None:
    """Issue 13's values; a double root in floats splits at 1e-8 of its size, which the load feels to second order."""
    assert first_flutter(emitted(system), N, 0.9 * near, 1.1 * near, **own) == pytest.approx(expected, rel=1e-11)


def test_functions_are_joined_and_jump_as_stated() -> None:
    module = emitted(CRACKED)
    basis, own = module.basis(8), {"a": 0.4, "k": 3.0}

    def step(order: int) -> Any:
        return module.shapes(basis, 0.4, "y", order, 1, **own) - module.shapes(basis, 0.4, "y", order, -1, **own)

    assert (step(0) == 0).all()
    assert sorted(set(step(1).tolist())) == [-1, 0, 1]
    assert np.count_nonzero(step(2))
    assert (module.shapes(basis, [0.0], "y", 0, **own) == 0).all()
    assert basis.size == 2 * 10 - 2 - 1


def test_derivatives_of_shapes_are_derivatives() -> None:
    module = emitted(STEPPED)
    basis, places, h = module.basis(6), np.array([[0.1, 0.37], [0.6, 0.9]]), 1e-5
    for order in range(4):
        slope = (module.shapes(basis, places + h, "y", order) - module.shapes(basis, places - h, "y", order)) / (2 * h)
        found = module.shapes(basis, places, "y", order + 1)
        assert found.shape == (basis.size, 2, 2)
        assert np.abs(slope - found).max() <= 1e-6 * np.abs(found).max()


def test_symmetric_forms_are_symmetric_to_the_last_bit() -> None:
    for system in SYSTEMS.values():
        module = emitted(system)
        basis = module.basis(9)
        for matrix in (module.mass(basis), module.stiffness(basis, 0.0), module.damping(basis, 0.3, 0.1, 0.2)):
            assert (matrix == matrix.T).all() or system is ABSORBER
        C = module.gyroscopic(basis, 0.3, 0.1, 0.2)
        assert (C == -C.T).all()


def test_damping_and_gyroscopic_parts_are_the_rates_matrix() -> None:
    module = emitted(ABSORBER)
    basis = module.basis(5)
    C_0, C_1 = module.rate_terms(basis, 0.1, 0.2)
    whole = module.damping(basis, 3.0, 0.1, 0.2) + module.gyroscopic(basis, 3.0, 0.1, 0.2)
    assert np.abs(whole - (C_0 + 3 * C_1)).max() <= 1e-15 * np.abs(whole).max()
    assert np.abs(module.gyroscopic(basis, 3.0, 0.1, 0.2)).max() == pytest.approx(1.0)


def test_matrices_are_polynomials_in_the_load() -> None:
    square = replace(column(), K=(*column().K, BilinearForm({}, {(TIP, TURN): 2 * ONE})))
    module = emitted(square)
    basis = module.basis(4)
    K_0, K_1, K_2 = module.stiffness_terms(basis)
    assert module.stiffness(basis, 3.0) == pytest.approx(K_0 + 3 * K_1 + 9 * K_2, rel=1e-15)
    loads = np.array([1.0, 2.0]).reshape(2, 1, 1)
    assert (module.stiffness(basis, loads)[1] == module.stiffness(basis, 2.0)).all()


def test_rigid_motions_cost_nothing_and_are_the_functions_stated() -> None:
    module = emitted(BEAL)
    basis, places = module.basis(6), np.linspace(0, 1, 13)
    R = module.rigid_motions(basis)
    assert np.abs(module.stiffness(basis, 0.0) @ R).max() <= 1e-12
    lines = R.T @ module.shapes(basis, places, "y")
    assert lines == pytest.approx(np.array([places**0, places]), abs=1e-15)
    assert R.T @ module.mass(basis) @ R == pytest.approx(np.array([[1, 1 / 2], [1 / 2, 1 / 3]]), rel=1e-14)


def test_a_force_does_the_work_of_the_deflection_there() -> None:
    module = emitted(CRACKED)
    basis = module.basis(6)
    for place in (0.0, 0.2, 0.9, 1.0):
        assert (module.force(basis, place) == module.shapes(basis, place, "y")).all()


def test_coordinates_are_one_everywhere() -> None:
    module = emitted(ABSORBER)
    basis = module.basis(4)
    found = module.shapes(basis, [0.0, 0.7], "q")
    assert found.sum() == 2 and (found[basis.numbers["q"][0]] == 1).all()


def test_a_coordinate_alone_has_a_system_without_fields() -> None:
    q, r = Value("q"), Value("r")
    ziegler = GeneralSystem(
        (ZERO, ONE), (), (("q", "q"), ("r", "r")),
        (BilinearForm({}, {(q, q): 3 * ONE, (q, r): ONE, (r, q): ONE, (r, r): ONE}),), (),
        (BilinearForm({}, {(q, q): 2 * ONE, (q, r): -ONE, (r, q): -ONE, (r, r): ONE}),
         BilinearForm({}, {(q, q): -ONE, (q, r): ONE})),
    )  # fmt: skip
    verify.verify(kernel_of(Facts(), ziegler), emit.emit(kernel_of(Facts(), ziegler)))
    module = emitted(ziegler)
    basis = module.basis(2)
    critical = 7 / 2 - math.sqrt(2)
    for load, sign in ((critical - 1e-6, 1), (critical + 1e-6, -1)):
        squares = eigvals(np.linalg.solve(module.mass(basis), module.stiffness(basis, load)))
        assert (np.abs(squares.imag).max() == 0) == (sign == 1)


def test_text_depends_on_the_system_alone() -> None:
    for system in (CRACKED, TIMOSHENKO):
        texts = {emit.emit(kernel_of(Facts(system.parameters), replace(system))) for _ in range(2)}
        assert len(texts) == 1


def test_breaks_out_of_order_are_named() -> None:
    two = column((0, a, HALF, 1), parameters=(parameter(a, 0.3, 0.1, 0.45),))
    module = emitted(two)
    assert module.places(a=0.25) == (0.0, 0.25, 0.5, 1.0)
    assert module.places(fmpq(1), a=fmpq(1, 4)) == (0, fmpq(1, 4), fmpq(1, 2), 1)
    for value in (0.5, 0.7, -0.1):
        with pytest.raises(ValueError, match=rf"a = {value:g}: the break at .* must lie before") as caught:
            module.stiffness(module.basis(4), 0.0, a=value)
        assert "\n" not in str(caught.value)
    with pytest.raises(ValueError, match=r"place 1\.5: lies off the beam"):
        emitted(MASS_ANYWHERE).mass(emitted(MASS_ANYWHERE).basis(3), b=1.5)
    with pytest.raises(ValueError, match="N = 1: must be 2 or more"):
        module.basis(1)


@pytest.mark.parametrize("factor", [1 / (x - HALF + c), sp.sqrt(x), sp.exp(300 * x), 1 / x])
def test_a_factor_that_no_rule_integrates_is_refused(factor: sp.Expr) -> None:
    module = emitted(column(stiffness=[factor], parameters=(parameter(c, 0.0, 0, 1),)))
    with np.errstate(all="ignore"), pytest.raises(ValueError, match="not smooth"):
        module.stiffness(module.basis(6), 0.0)


def test_functions_of_x_have_no_exact_fractions() -> None:
    module = emitted(EXPONENTIAL)
    order = np.array([fmpq(n) for n in range(6)], dtype=object)
    with pytest.raises(ValueError, match="no exact fractions"):
        module.stiffness_terms(module.complete(order))


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("2 * rate * (2 * k + 1)", "2 * rate * (2 * k + 2)"),
        ("length ** (1 - test[1] - trial[1])", "length ** (2 - test[1] - trial[1])"),
        ("sizes[[1, 3]] = length", "sizes[[1, 2]] = length"),
        ("table[segment, order] = table[segment - 1, joined + order]", "new.append(order)"),
        ("(30, -36, 0, 6)", "(30, -36, 0, 7)"),
        ("return sum(before)", "return 0"),
    ],
)
def test_faults_in_a_module_are_found(old: str, new: str) -> None:
    kernel = kernel_of(Facts(STEPPED.parameters), STEPPED)
    text = emit.emit(kernel)
    assert old in text or old.replace(" ** ", "**") in text
    with pytest.raises(VerificationError):
        verify.verify(kernel, text.replace(old.replace(" ** ", "**") if old not in text else old, new))


def test_what_a_kernel_cannot_hold_is_refused() -> None:
    wrong = replace(column(), spaces=(Space("y", "y", 3),))
    with pytest.raises(StatementError, match="joined 3 times"):
        kernel_of(Facts(), wrong)
    with pytest.raises(StatementError, match="psi: the system has no such field"):
        kernel_of(Facts(), replace(column(), M=(BilinearForm(along(0, 0, [1], "psi", "psi"), {}),)))
    curved = replace(column(), rigid=({("y", 0): x**2},))
    with pytest.raises(StatementError, match="degree 1 at most"):
        emit.emit(kernel_of(Facts(), curved))
