"""Columns and their matrices, from the emitted kernels."""

from __future__ import annotations

import difflib
import os
from collections import OrderedDict
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from functools import cache, cached_property, partial
from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import Any, NamedTuple, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from freebeam_sym.checks import (
    LARGEST,
    InputError,
    computable,
    count,
    finite,
    memory,
    nonnegative,
    place,
    positions,
    positive,
    reals,
    refusal,
)
from freebeam_sym.kernels import load, read_kernel, text_of
from freebeam_sym.massless import condensed

__all__ = ["Column", "Parameter", "System", "column", "column_names"]

Array = NDArray[np.float64]
T = TypeVar("T")
USUAL = {"modes": 8}
USUAL_ELSE = 16
"""N in a basis where none is asked for and the column states another basis."""
_MOST_POLYNOMIALS = 128  # their stiffness grows with the eighth power of N, and from 180 or so rounding decides
_MOST_ON_A_SEGMENT = 256
_KEPT = 256  # matrices, or lists of them, that a column remembers
_FEW_PLACES = 8  # whose shapes are kept
_SETTINGS = ("alpha", "beta", "basis", "kappa", "load", "load_max", "modes", "rigid")


@dataclass(frozen=True)
class Parameter:
    """A parameter of a column's own, nondimensional. low, high: where it is of interest, not limits."""

    name: str
    latex: str
    meaning: str
    default: float
    low: float
    high: float


class Coefficients(NamedTuple):
    """M, C and K of a column by powers of the load P, arrays (n, n), nondimensional: K = Σ P^k K[k]."""

    M: tuple[Array, ...]
    C: tuple[Array, ...]
    K: tuple[Array, ...]

    def at(self, load: float) -> tuple[Array, Array, Array]:
        """M, C and K at a load, each (n, n)."""
        M, C, K = (
            terms[0] if len(terms) == 1 else sum((load**k * X for k, X in enumerate(terms)), np.zeros_like(self.M[0]))
            for terms in self
        )
        return M, C, K

    @property
    def slope(self) -> Coefficients:
        """Their derivatives by the load."""
        return Coefficients(*(tuple(k * X for k, X in enumerate(terms))[1:] or (0 * self.M[0],) for terms in self))


@dataclass(frozen=True, eq=False)
class Column:
    """A column: name, ends, parameters and the emitted kernels that compute its matrices."""

    kernel: ModuleType
    path: Path | None = None
    """Its file, of a column of one's own."""
    relative: Callable[[str], Column] | None = field(default=None, repr=False)
    """What gives the same column in another basis, by the basis's name."""
    _cache: OrderedDict[Any, Any] = field(default_factory=OrderedDict, repr=False)

    def __reduce__(self) -> tuple[Any, ...]:
        """A column is sent to another process as what it is made of: name and basis, or the text of its kernel."""
        if self.kernel.__name__.startswith("freebeam_kernels."):
            return column, (self.name, self.basis_name)
        return _sent, (Path(str(self.kernel.__file__)).name, text_of(self.kernel))

    @property
    def name(self) -> str:
        """Name, such as "free-free"."""
        return str(self.kernel.COLUMN["name"])

    @property
    def title(self) -> str:
        """What the column is, in one line."""
        return " ".join(str(self.kernel.COLUMN["title"]).split())

    @property
    def ends(self) -> tuple[str, ...]:
        """Kinds of the ends at x = 0 and x = 1, of the first of several fields; empty where there is no field."""
        return tuple(self.kernel.COLUMN["ends"])

    @property
    def basis_name(self) -> str:
        """The trial functions of the Ritz series: "modes" of the unloaded beam, Eq. (22), or "legendre" polynomials."""
        return str(self.kernel.COLUMN.get("basis", "modes"))

    @cached_property
    def polynomials(self) -> Column | None:
        """The same column in polynomials, whose series converge exponentially; None where it is a kernel's file in
        another basis, with none of polynomials beside it."""
        if self.basis_name == "legendre":
            return self
        if self.relative is not None:
            return self.relative("legendre")
        beside = self.path and self.path.with_stem(f"{self.path.stem}_legendre")
        return column(beside) if beside and beside.is_file() else None

    def number(self, modes: int | None) -> int:
        """N: the number of elastic functions, checked, where none is given the column's own.

        Raises InputError where it is below 1 or beyond the memory.
        """
        if modes is None:
            stated = self.kernel.COLUMN.get("default", {})
            usual = USUAL.get(self.basis_name, USUAL_ELSE)
            modes = int(stated["modes"] if stated.get("basis") == self.basis_name else usual)
        if self.basis_name == "legendre":
            least, most, hint = 1, _MOST_POLYNOMIALS, "number N of elastic polynomials; 20 give ten digits"
            if self.general:
                least, most = int(self.kernel.COLUMN["least"]), _MOST_ON_A_SEGMENT
                hint = "functions a segment and a field; 16 give ten digits"
            return count("modes", modes, least, most, hint)
        # a spectrum takes some twelve matrices of twice the size
        largest = int((memory() / (12 * 4 * 8)) ** 0.5)
        hint = "number N of elastic functions that this machine's memory has room for"
        return count("modes", modes, 1, largest, hint)

    @property
    def general(self) -> bool:
        """Whether it goes beyond the textbook's M, C = c_M M + c_E E and K = E + P H over one segment."""
        return bool(self.kernel.COLUMN.get("general"))

    def textbook(self, what: str) -> None:
        """InputError where the column is `general`, and something is computed that is known of the others alone."""
        if self.general:
            raise InputError(
                f"{self.name}: {what} is known of columns with C = c_M M + c_E E and K = E + P H over one segment alone"
            )

    @property
    def load_unit(self) -> str:
        """The load's SI unit: "N", of a torque "N m", of a flow "m/s"; "" where the statement gives it none."""
        return str(self.kernel.COLUMN.get("quantities", {}).get("load", {"unit": "N"})["unit"])

    @property
    def fields(self) -> tuple[str, ...]:
        """Names of the fields along the beam."""
        return tuple(each["name"] for each in self.kernel.COLUMN.get("fields", [{"name": "y"}]))

    @property
    def unknowns(self) -> tuple[str, ...]:
        """Names of the fields, and then of the coordinates of time alone."""
        return (*self.fields, *(each["name"] for each in self.kernel.COLUMN.get("coordinates", [])))

    @property
    def rigid_count(self) -> int:
        """Number of rigid functions that are left out of the elastic spectrum."""
        return int(self.kernel.COLUMN["rigid"])

    @property
    def damping(self) -> tuple[str, ...]:
        """The dampings that the column's virtual work holds, of "alpha" and "beta"."""
        return tuple(self.kernel.COLUMN["damping"])

    @property
    def forced(self) -> bool:
        """Whether a transversal force F₀ at x_F is part of the column."""
        return bool(self.kernel.COLUMN["force"])

    @cached_property
    def parameters(self) -> tuple[Parameter, ...]:
        """The column's own parameters, beside load and dampings."""
        return tuple(Parameter(**p) for p in self.kernel.COLUMN["parameters"])

    def own_parameters(self, given: dict[str, Any]) -> dict[str, float]:
        """All own parameters, those not given at their default. Raises InputError for an unknown or non-finite one."""
        known = {p.name: p.default for p in self.parameters}
        for name, value in given.items():
            if name not in known:
                raise self.no_such(name)
            known[name] = computable(name, finite(name, value))
        return known

    def no_such(self, name: str) -> InputError:
        """The error that there is no parameter of this name."""
        own = ", ".join(p.name for p in self.parameters) or "none"
        near = "modes" if name.lower() in ("n", "nmodes", "n_modes", "terms") else ""
        near = near or next(iter(difflib.get_close_matches(name, [*own.split(", "), *_SETTINGS], 1)), "")
        cure = f" (did you mean {near}?)" if near and near != name else ""
        return InputError(f"{name}: {self.name} has no such parameter{cure}; its own parameters: {own}")

    def dampings(self, alpha: float, beta: float) -> tuple[float, float]:
        """alpha and beta, checked. Raises InputError where one is negative or the column has no such damping."""
        checked = nonnegative("alpha", alpha, "internal damping"), nonnegative("beta", beta, "external damping")
        for name, value in zip(("alpha", "beta"), checked, strict=True):
            computable(name, value)
            if value and name not in self.damping:
                raise InputError(f"{name} = {value}: {self.name} states no such damping; leave it at 0")
        return checked

    def basis(self, modes: int | None = None) -> Any:
        """The first `modes` trial functions, Eq. (9), as the kernel's named tuple: of comparison modes, Eq. (22),
        vectors of shape (modes,); of polynomials their series in Legendre's."""
        modes = self.number(modes)

        def build() -> Any:
            basis = self.kernel.basis(modes)
            for vector in basis:
                if isinstance(vector, np.ndarray):
                    vector.flags.writeable = False
            return basis

        return self._remembered(("basis", modes), build)

    def matrices(
        self, modes: int | None = None, rigid: bool = False, **parameters: float
    ) -> tuple[Array, Array, Array]:
        """M, E, H of M q̈ + C q̇ + (E + P H) q = Q, each (n, n), nondimensional. Eq. (11).

        n = modes, or the number of rigid functions more with `rigid`, which then come first. The arrays are kept and
        shared: they cannot be written to. Raises InputError for a number of modes below 1 or beyond the memory.
        """
        self.textbook("the form M, E, H of its matrices")
        own, modes = self.own_parameters(parameters), self.number(modes)

        def build() -> tuple[Array, Array, Array]:
            basis, kernel = self.basis(modes), self.kernel
            with np.errstate(all="ignore"):
                found = tuple(
                    f(basis, rigid, **own) for f in (kernel.mass, kernel.stiffness_elastic, kernel.stiffness_load)
                )
            M, E, H = _sound(found, own)
            return M, E, H

        return self._remembered((modes, rigid, *own.values()), build)

    def coefficients(
        self, modes: int | None = None, rigid: bool = False, alpha: float = 0.0, beta: float = 0.0, **parameters: float
    ) -> Coefficients:
        """M, C and K by powers of the load, as tuples of arrays (n, n), nondimensional. Eqs. (10), (11).

        Of the elastic functions, or with the rigid ones, which then come first. Raises InputError as `system` does.
        """
        own, modes = self.own_parameters(parameters), self.number(modes)
        alpha, beta = self.dampings(alpha, beta)
        if not self.general:
            M, E, H = self.matrices(modes, rigid, **own)
            c_M, c_E = self.damping_factors(alpha, beta, **own)
            return Coefficients((M,), (c_M * M + c_E * E,) if c_M or c_E else (), (E, H))
        given = {"alpha": alpha, "beta": beta}
        if coupled := [name for name in self.kernel.COLUMN["coupled"] if given[name]]:
            raise InputError(
                f"{coupled[0]} = {given[coupled[0]]}: this damping couples the rigid motions of {self.name} to its "
                "bending, so that the elastic spectrum alone does not decide stability; leave it at 0"
            )

        def part(name: str, **shares: float) -> tuple[Array, ...]:
            each = [
                [share * X for X in self._remembered((name, of, *key), partial(self._built, name, of, modes, own))]
                for of, share in ({"": 1.0} | shares).items()
                if share
            ]
            return tuple(sum(terms[1:], terms[0]) for terms in zip(*each, strict=True))

        key = (modes, *own.values())
        held = given if self.kernel.COLUMN.get("circulatory") else {}  # internal damping of a shaft that turns, say
        mass, C, K = part("mass"), part("rate", **given), part("stiffness", **held)
        while C and not C[-1].any():
            C = C[:-1]
        e = slice(None) if rigid else slice(self.rigid_count, None)
        return Coefficients(*(tuple(X[e, e] for X in terms) for terms in (mass, C, K)))

    def _built(self, name: str, damping: str, modes: int, own: dict[str, float]) -> tuple[Array, ...]:
        """M, C or K without alpha and beta, or what one of these adds, by powers of the load, in the functions of
        `frame`."""
        of, basis, key = getattr(self.kernel, f"{name}_terms"), self.basis(modes), ("frame", modes, *own.values())
        T = self._remembered(key, partial(self.frame, modes, **own))
        given = (float(damping == "alpha"), float(damping == "beta"))
        with np.errstate(all="ignore"), self._sound_places():
            terms = of(basis, *(given if damping or name == "rate" else ()), **own)
            if damping:
                bare = of(basis, 0.0, 0.0, **own)
                terms = tuple(x - y for x, y in zip(terms, bare, strict=True))
        moved = tuple(terms) if T is None else tuple(_moved(X, T) for X in terms)
        return _sound(moved, own)

    def frame(self, modes: int, **own: float) -> Array | None:
        """The functions of a column's systems in those of its kernel, (n, n): the rigid motions first, the others
        M-orthogonal to them. None where there is no rigid motion, and both are alike."""
        r = self.rigid_count
        if not self.general or not r:
            return None
        from scipy.linalg import qr

        basis = self.basis(modes)
        with self._sound_places():
            R, M = self.kernel.rigid_motions(basis, **own), self.kernel.mass_terms(basis, **own)[0]
        # coordinates that the rigid motions can take the place of
        dropped = qr(R.T, mode="r", pivoting=True)[1][:r]
        others = np.delete(np.eye(len(R)), dropped, axis=1)
        return np.hstack([R, others - R @ np.linalg.solve(R.T @ M @ R, R.T @ M @ others)])

    @contextmanager
    def _sound_places(self) -> Iterator[None]:
        """A kernel's refusal of places that are off the beam or out of their order, as an InputError."""
        try:
            yield
        except ValueError as error:
            raise InputError(f"{self.name}: {error}") from None

    def _remembered(self, key: Any, build: Callable[[], T]) -> T:
        if key not in self._cache:
            self._cache[key] = build()
            while len(self._cache) > _KEPT:
                self._cache.popitem(last=False)
        return self._cache[key]  # type: ignore[no-any-return]

    def damping_factors(self, alpha: float, beta: float, **parameters: float) -> tuple[float, float]:
        """c_M and c_E of C = c_M M + c_E E, Eq. (12): beta and alpha, unless the column's energies shift them."""
        self.textbook("the form C = c_M M + c_E E")
        c_M, c_E = self.kernel.damping_factors(alpha, beta, **self.own_parameters(parameters))
        return float(c_M), float(c_E)

    def scales(self, bending_stiffness: float, mass_per_length: float, length: float, **own: float) -> dict[str, float]:
        """SI size of one nondimensional unit of each quantity, for a beam in SI units (N m², kg/m, m). Eq. (5).

        Keys: length (m), time (s), load (`load_unit`), force (N), alpha (s), beta (kg/(m s)), frequency (rad/s),
        velocity (m/s), acceleration (m/s²), energy (J), and by the names of the dimensional statement what it has for
        parameters. An SI value is the nondimensional one times its size, at the column's own parameters.

        >>> beam = column("free-free").scales(bending_stiffness=2e6, mass_per_length=50, length=20)
        >>> beam["load"]  # newtons in one unit of P
        5000.0

        Raises InputError where one is not positive and finite, or a size beyond a float's range, and without any.
        """
        if not self.load_unit:
            raise InputError(
                f"the load of {self.name} has no SI unit: Eq. (5) has none for a flow's velocity or what acts on "
                "coordinates; state the column in SI quantities too (dimensional=...), or ask in nondimensional ones"
            )
        EI = positive("bending_stiffness", bending_stiffness, "EI in N m²")
        m = positive("mass_per_length", mass_per_length, "m in kg/m")
        L = positive("length", length, "L in m")
        parameters, sizes = self.own_parameters(own), dict[str, float]()
        with suppress(ArithmeticError), np.errstate(all="ignore"):
            sizes = self.kernel.scales(EI, m, L, **{k: parameters[k] for k in self.kernel.scales.__kwdefaults__ or ()})
        if not sizes or not all(1 / LARGEST < size < LARGEST for size in sizes.values()):
            raise InputError(
                f"bending_stiffness = {EI:g}, mass_per_length = {m:g}, length = {L:g}: the units of Eq. (5) that they "
                f"give{f' at {own}' if own else ''} must lie between 1e-60 and 1e60 to be computed with"
            )
        return sizes

    def system(
        self,
        modes: int | None = None,
        load: float = 0.0,
        alpha: float = 0.0,
        beta: float = 0.0,
        rigid: bool = False,
        **parameters: float,
    ) -> System:
        """The system M q̈ + C q̇ + K q = Q F₀(t) at a load, nondimensional. Eqs. (10), (11).

        modes: number N of elastic functions, the column's own number where None. load: P. rigid: with the rigid
        functions, first; stability is a question of the elastic spectrum and leaves them out. parameters: the column's
        own, such as eta = 0.7.

        Raises InputError for values that are not finite, negative damping, and unknown parameters.
        """
        own, modes = self.own_parameters(parameters), self.number(modes)
        if not isinstance(rigid, bool | np.bool_):
            raise refusal("rigid", rigid, "must be True or False")
        load = computable("load", finite("load", load, "nondimensional load P"))
        alpha, beta = self.dampings(alpha, beta)
        terms = self.coefficients(modes, bool(rigid), alpha, beta, **own)
        M, C, K = terms.at(load)
        E, H = terms.K[0], terms.K[1] if len(terms.K) > 1 else np.zeros_like(M)
        return System(self, modes, load, alpha, beta, bool(rigid), own, M, C, K, E, H)


def _sound(matrices: tuple[Array, ...], own: dict[str, float]) -> tuple[Array, ...]:
    """Matrices that are kept and shared, no more to be written to. Raises InputError where they are not finite."""
    for X in matrices:
        if not np.isfinite(X).all():
            given = ", ".join(f"{name} = {value:g}" for name, value in own.items())
            raise InputError(f"{given}: the matrices are beyond the range of a float")
        X.flags.writeable = False
    return matrices


def _moved(X: Array, T: Array) -> Array:
    """Tᵀ X T; symmetric to the last bit where X is."""
    found = T.T @ X @ T
    return (found + found.T) / 2 if np.array_equal(X, X.T) else found


@dataclass(frozen=True, eq=False)
class System:
    """M q̈ + C q̇ + K q = Q F₀(t) of a column at one load: matrices (n, n), nondimensional. Eqs. (10)-(13).

    n = modes + rigid_count; the rigid functions come first. K = E + load H.
    """

    column: Column
    modes: int
    load: float
    alpha: float
    beta: float
    rigid: bool
    parameters: dict[str, float]
    M: Array
    C: Array
    K: Array
    E: Array
    H: Array

    def __repr__(self) -> str:
        own = "".join(f", {name}={value:g}" for name, value in self.parameters.items())
        rigid = f", rigid: {self.rigid_count} functions more" if self.rigid else ""
        return (
            f"<System of {self.column.name}: N={self.modes} ({self.column.basis_name}), load={self.load:g}, "
            f"alpha={self.alpha:g}, beta={self.beta:g}{own}{rigid}; M, C, K, E, H of shape {self.M.shape}>"
        )

    @property
    def rigid_count(self) -> int:
        """Number of leading rows that belong to rigid functions."""
        return self.column.rigid_count if self.rigid else 0

    @property
    def basis(self) -> Any:
        """The trial functions that the system is written in."""
        return self.column.basis(self.modes)

    @property
    def gamma(self) -> Array:
        """Roots of the characteristic equation, (modes,). Eq. (21). Raises InputError where polynomials have none."""
        if self.column.basis_name != "modes":
            raise InputError(f"gamma: the basis is {self.column.basis_name}, whose functions have no roots; use modes")
        return np.asarray(self.basis.gamma)

    def mode(self, number: int = 1) -> Array:
        """Generalised coordinates of a mode of the unloaded beam, (n,): normalised as in Eq. (22) where the trial
        functions are the modes, to unit modal mass where they are polynomials. Raises InputError."""
        r = self.rigid_count
        _, follow, (M, _, E) = condensed(self.M[None], self.C[None], self.E[None])
        moving = np.flatnonzero(np.diag(M[0]))[r:]  # what has no mass follows, or is at rest where it has a damper
        k = count("mode", number, 1, len(moving), "number of a mode, no more than elastic functions") - 1
        if self.column.basis_name == "modes":
            return np.asarray(np.eye(len(self.M))[r + k])
        from freebeam_sym.stability.pencil import diagonalise

        v = diagonalise(*(X[0][np.ix_(moving, moving)] for X in (M, E)))[1][:, k]
        return np.asarray(follow[0][:, moving] @ (v * np.sign(v[np.abs(v).argmax()])))

    def Q(self, x_F: float) -> Array:
        """Generalised force of a unit transversal force at x_F, (n,). Eq. (11), last line.

        Raises InputError where the column has no transversal force or x_F lies off the beam.
        """
        if not self.column.forced:
            raise InputError(f"x_F = {x_F}: {self.column.name} states no transversal force F_0")
        at, kernel = place("x_F", x_F), self.column.kernel

        def build() -> Array:
            if self.column.general:
                return self._framed(kernel.force(self.basis, at, **self.parameters))
            return np.asarray(kernel.force(self.basis, at, self.rigid))

        return self._kept(build, "force", at)

    def _framed(self, values: Array) -> Array:
        """Values of the kernel's functions (n, …) as those of this system's."""
        T = self.column.frame(self.modes, **self.parameters)
        return values if T is None else np.tensordot(T.T, values, 1)[0 if self.rigid else self.column.rigid_count :]

    def shapes(self, x: ArrayLike, derivative: int = 0, field: str = "", side: int = 0) -> Array:
        """The trial functions or a derivative of them at places x, shape (n, *x.shape). Eq. (22).

        field: the field whose functions they are, the deflection y or the only one where left out; or a coordinate,
        whose value is the same at every place. side: −1 or 1 for values just left or right of a place at which they
        jump. Raises InputError for places off the beam, an order that is no whole number and a field that the column
        does not have.
        """
        places = reals("x", x)
        positions("x", places.ravel())
        derivative = count("derivative", derivative, 0)
        fields, kernel = self.column.unknowns, self.column.kernel
        field = field or fields[0]
        if field not in fields:
            raise refusal("field", field, f"must be one of {', '.join(fields)}")

        def build() -> Array:
            if not self.column.general:
                return np.asarray(kernel.shapes(self.basis, places, derivative, self.rigid))
            with self.column._sound_places():
                return self._framed(kernel.shapes(self.basis, places, field, derivative, side, **self.parameters))

        if places.size > _FEW_PLACES:
            return build()
        return self._kept(build, "shapes", field, derivative, side, places.shape, places.tobytes())

    def _kept(self, build: Callable[[], Array], *key: Any) -> Array:
        """An array of this system's functions, kept for other loads and dampings; a copy."""
        return self.column._remembered((*key, self.modes, self.rigid, *self.parameters.values()), build).copy()


def is_column(value: object) -> Column:
    """`value`, which must be a column. Raises InputError."""
    if not isinstance(value, Column):
        raise refusal("column", value, "must be a column, such as fb.column('free-free')")
    return value


def is_system(value: Any) -> Any:
    """`value`, which must be a system, or have the matrices of one. Raises InputError."""
    if not all(hasattr(value, name) for name in ("M", "C", "K")):
        raise refusal("system", value, "must be a system, such as fb.column('free-free').system(load=50)")
    return value


def column_names() -> tuple[str, ...]:
    """Names of the columns whose kernels come with the package."""
    return tuple(import_module("freebeam_kernels").COLUMNS)


def column(name: str | os.PathLike[str], basis: str | None = None) -> Column:
    """A column by its name, or by the path of a kernel that was emitted for it.

    basis: the trial functions, "modes" of the unloaded beam or "legendre": polynomials, with which critical loads
    converge exponentially in their number; where None, what the column states: polynomials, if nothing else. A kernel's
    file has the one that it was emitted for.

    >>> column("free-free", basis="legendre").basis_name
    'legendre'

    Raises InputError for a name that no column has, a file that is no kernel and a basis that there is not.
    """
    known = import_module("freebeam_kernels").COLUMNS
    path = file_of(name, basis)
    if path is not None:
        found = Column(read_kernel(path), path)
        if basis not in (None, found.basis_name):
            cure = "give the column's file"
            raise InputError(f"{path}: is a kernel in the basis {found.basis_name}, not {basis}; {cure}")
        return found
    assert isinstance(name, str)
    found = _tree(known[name][basis or "legendre"])
    stated = found.kernel.COLUMN["default"]["basis"]
    return found if basis or stated == found.basis_name else _tree(known[name][stated])


def file_of(name: object, basis: object = None, stated: Mapping[str, Path] | None = None) -> Path | None:
    """The file that names a column; None where `name` is that of a kernel of the package. stated: names of further
    columns, and the files that state them. Raises InputError where it is none of these, and for a basis that there is
    not."""
    stated = stated or {}
    known = (*column_names(), *stated)
    there = ", ".join(known) if len(known) < 10 else f"{len(known)}, which `freebeam columns` lists"
    if not isinstance(name, str | os.PathLike):
        raise refusal("column", name, f"must be a name, such as {known[0]}, or the path of a column's file")
    text = os.fspath(name)
    kernels = import_module("freebeam_kernels").COLUMNS
    bases = kernels.get(text) or dict.fromkeys(basis for each in kernels.values() for basis in each)
    if basis not in (None, *bases):
        raise refusal("basis", basis, f"must be one of {', '.join(bases)}")
    if text in known:
        return stated.get(text)
    if isinstance(name, os.PathLike) or text.endswith(".py") or os.sep in text or Path(text[:200]).is_file():
        return Path(text)
    near = difflib.get_close_matches(text, known, 1)
    raise InputError(
        f"column {text if len(text) < 60 else text[:57] + '...'!r} is not known; there are {there}"
        + (f" (did you mean {near[0]}?)" if near else "")
        + "; a column of your own is named by its file, such as path/to/column.py"
    )


@cache
def _tree(module: str) -> Column:
    """A column of the package, by the module of its kernel."""
    kernel = import_module(f"freebeam_kernels.{module}")
    return Column(kernel, relative=lambda basis: column(str(kernel.COLUMN["name"]), basis))


def _sent(name: str, text: str) -> Column:
    """A column from the text of its kernel, where that has been sent to."""
    return Column(load(Path(name), text.encode()))
