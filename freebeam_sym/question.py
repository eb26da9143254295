"""What is asked of a column, as one value: checked where it is made, handed on whole, and kept by what answers it."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import zip_longest

import numpy as np

from freebeam_sym.checks import LARGEST, InputError, computable, nonnegative, positive
from freebeam_sym.columns import Coefficients, Column, System, is_column
from freebeam_sym.stability.general import General
from freebeam_sym.stability.pencil import Pencil, pencil_of
from freebeam_sym.stability.proportional import Proportional

__all__ = ["Question"]


@dataclass(frozen=True)
class Question:
    """A column at N = `modes`, its dampings and its own parameters (all of them), and the largest load of interest;
    nondimensional. kappa: the ratio beta/alpha of a limit of vanishing damping, None where none is asked for."""

    column: Column = field(repr=False, compare=False)
    modes: int
    alpha: float = 0.0
    beta: float = 0.0
    kappa: float | None = None
    parameters: Mapping[str, float] = field(default_factory=dict)
    load_max: float = 1000.0

    @staticmethod
    def of(
        column: Column,
        modes: int | None = None,
        alpha: float = 0.0,
        beta: float = 0.0,
        *,
        load_max: float = 1000.0,
        kappa: float | None = None,
        **parameters: float,
    ) -> Question:
        """A question, checked; what is left out is the column's own. Raises InputError for bad values."""
        is_column(column)
        modes = column.number(modes)
        alpha, beta = column.dampings(alpha, beta)
        load_max = computable("load_max", positive("load_max", load_max, "largest load to look at"))
        if kappa is not None:
            if not (isinstance(kappa, float) and math.isinf(kappa) and kappa > 0):
                kappa = nonnegative("kappa", kappa, "ratio beta/alpha of vanishing damping; math.inf is allowed")
                computable("kappa", kappa)
            if alpha or beta:
                raise InputError(
                    f"kappa = {kappa}: is the limit of vanishing damping; alpha and beta must be 0, not {alpha} and "
                    f"{beta}"
                )
            for name, stands in (("alpha", not math.isinf(kappa)), ("beta", kappa > 0)):
                if stands and name not in column.damping:
                    raise InputError(
                        f"kappa = {kappa}: {column.name} states no damping {name} that could vanish; kappa = 0 is "
                        "alpha alone, kappa = inf beta alone"
                    )
        return Question(column, modes, alpha, beta, kappa, column.own_parameters(parameters), load_max)

    def at(self, **values: float) -> Question:
        """The same with other values of alpha, beta or own parameters. Raises InputError for bad ones."""
        given = {**self.values, **values}
        return Question.of(self.column, self.modes, kappa=self.kappa, load_max=self.load_max, **given)

    def over(self, column: Column, modes: int) -> Question:
        """The same of so many functions of another basis of the column."""
        return replace(self, column=column, modes=modes)

    @property
    def values(self) -> dict[str, float]:
        """alpha, beta and the column's own parameters by name."""
        return {"alpha": self.alpha, "beta": self.beta, **self.parameters}

    @property
    def direction(self) -> dict[str, float]:
        """alpha and beta; of a limit of vanishing damping what they are in proportion to."""
        if self.kappa is None:
            return {"alpha": self.alpha, "beta": self.beta}
        return {"alpha": 0.0, "beta": 1.0} if math.isinf(self.kappa) else {"alpha": 1.0, "beta": self.kappa}

    @property
    def pencil(self) -> Pencil:
        """E + P H − s M of the column. Raises InputError where it is not stable without load."""
        return pencil_of(*self.column.matrices(self.modes, False, **self.parameters))

    @cached_property
    def factors(self) -> tuple[float, float, float | None]:
        """c_E and c_M of C = c_E E + c_M M, Eq. (12); in a limit of vanishing damping 0, 0 and the ratio c_M/c_E."""
        c_M, c_E = self.column.damping_factors(**self.direction, **self.parameters)
        if not max(c_E, c_M) < LARGEST:  # its square times e must stay a float
            raise InputError(f"alpha = {self.alpha}, beta = {self.beta}: must be below 1e60 to be computed with")
        return (c_E, c_M, None) if self.kappa is None else (0.0, 0.0, c_M / c_E if c_E else math.inf)

    def coefficients(self, **values: float) -> Coefficients:
        """M, C, K of the elastic functions by powers of the load, each (N, N), at other values of some parameters; C of
        a limit of vanishing damping is its direction. Eqs. (10), (11). Raises InputError."""
        return self.column.coefficients(self.modes, False, **{**self.values, **self.direction, **values})

    @property
    def problem(self) -> Proportional | General:
        """What a search for the first loss of stability sees. Raises InputError."""
        return self.general if self.column.general else Proportional(self.pencil, *self.factors)

    @property
    def general(self) -> General:
        """The same of a column beyond the textbook's, always as a problem of any damping. Raises InputError, of a limit
        of vanishing damping where a damper stays."""
        M, C, K = self.coefficients()
        none = (np.zeros_like(M[0]),)
        if self.kappa is None:
            return General(M, C or none, K)
        _, rates, still = self.coefficients(alpha=0.0, beta=0.0)
        if any(np.abs(X + X.T).max() > 1e-13 * np.abs(X).max() for X in rates):
            raise InputError(
                f"kappa = {self.kappa}: {self.column.name} has a damper of its own, which stays when alpha and beta "
                "vanish; give small alpha and beta instead"
            )
        D, N = ([a - b for a, b in zip_longest(*X, fillvalue=none[0])] for X in ((C, rates), (K, still)))
        return General(M, D or none, still, True, rates, N)

    def system(self, load: float, rigid: bool = False) -> System:
        """The system at a load, Eqs. (10), (11). Raises InputError."""
        return self.column.system(self.modes, load, self.alpha, self.beta, rigid, **self.parameters)
