"""The paper's equations (1) to (26) as its text prints them, from equations.toml, and what their letters stand for.

`typed` states the same as the string `latex` in SymPy, misprints kept: the reader must arrive at it from the string.
"""

from __future__ import annotations

import keyword
import tomllib
from dataclasses import dataclass
from importlib.resources import files
from itertools import pairwise
from typing import Any

from sympy import Derivative, Eq, Function, Integral, Symbol, symbols
from sympy.parsing.sympy_parser import parse_expr

from freebeam.paper.reader import Names, at, delta, differential, misprinted, read
from freebeam_derive import notation as n
from freebeam_derive.notation import EI, F_0, C_alpha, C_beta, L, alpha, beta, chi, gamma, m, t, x, x_F, y
from freebeam_derive.ritz import phi_i, phi_j, q_j

__all__ = ["EQUATIONS", "NAMES", "Printed"]

P_0 = n.P
dy = n.variation_of_y
axial, lateral = Function("P", real=True)(x), Function("F", real=True)(x, t)
moment = Function("M", real=True)(x, t)
q_i = Function("q_i", real=True)(t)
tau = Function("tau")(t)
T, V, W_c, W_nc, dW_nc = symbols("T V W_c W_nc delta_W_nc")
t_1, t_2 = symbols("t_1 t_2", real=True)
i, N = symbols("i N", integer=True, positive=True)
M_ij, C_ij, K_ij, KG_ij, Q_j = symbols("M_ij C_ij K_ij K^G_ij Q_j")
M, C, K, A, identity = (Symbol(name, commutative=False) for name in ("M", "C", "K", "A", "I"))
lambda_, lambda_R, lambda_I, lambda_0, lambda_01, lambda_02 = symbols(
    "lambda lambda_R lambda_I lambda_0 lambda_0_1 lambda_0_2"
)
lambda_bar, lambda_bar_R, lambda_bar_I, reference = symbols("lambda_bar lambda_bar_R lambda_bar_I lambda_0_I1")
qhat_j, unit = symbols("qhat_j i")
bar = {name: Symbol(f"{name}_bar", real=True) for name in ("y", "x", "t", "P_0", "F_0", "alpha", "beta")}
y_here = Symbol("y", real=True)

_GREEK = {"alpha": alpha, "beta": beta}
_BARRED = {"y": y, "x": x, "t": t, "P_0": P_0, "F_0": F_0, "x_F_0": x_F, "t_1": t_1, "t_2": t_2, **_GREEK}
_BARRED |= {"T": T, "V": V, "W_c": W_c, "W_nc": W_nc}

WITH_DIMENSIONS = Names(
    {"y": y, "x": x, "t": t, "EI": EI, "m": m, "L": L, "C_alpha": C_alpha, "C_beta": C_beta, "P_0": P_0, "F_0": F_0}
    | {"x_F_0": x_F, "P": axial, "F": lateral, "M": moment}
)
SCALES = Names(
    {f"{name}_bar": symbol for name, symbol in bar.items()}
    | {"y": y_here, "x": x, "t": t, "EI": EI, "m": m, "L": L, "C_alpha": C_alpha, "C_beta": C_beta, "P_0": P_0}
    | {"F_0": F_0}
)
FIELDS = Names(
    {f"{name}_bar": value for name, value in _BARRED.items()}
    # Eq. (19) has lost the bar of its beta
    | {"beta": beta, "varphi_i": phi_i, "varphi_j": phi_j, "q_i": q_i, "q_j": q_j, "chi": chi, "tau": tau}
    | {"q_j_dot": q_j.diff(t), "q_j_ddot": q_j.diff(t, 2), "i": i, "N": N, "gamma": gamma, "lambda_0": lambda_0}
    | {"M_ij": M_ij, "C_ij": C_ij, "K_ij": K_ij, "K_ij_G": KG_ij, "Q_j": Q_j}
    | {"lambda_0_1": lambda_01, "lambda_0_2": lambda_02}
)
VARIED = Names(FIELDS.values, {y: dy, W_nc: dW_nc})
EIGENVALUES = Names(
    {"q_j": q_j, "q_j_hat": qhat_j, "t_bar": t, "i": unit, "lambda": lambda_, "lambda_R": lambda_R}
    | {"lambda_I": lambda_I, "lambda_bar": lambda_bar, "lambda_R_bar": lambda_bar_R, "lambda_I_bar": lambda_bar_I}
    | {"lambda_0_I_1": reference, "A": A, "I": identity, "M_ij": M, "C_ij": C, "K_ij": K}
)
NAMES = {
    "dimensional": WITH_DIMENSIONS, "scales": SCALES, "nondimensional": FIELDS, "varied": VARIED,
    "eigenvalues": EIGENVALUES,
}  # fmt: skip
"""What the letters of an equation stand for, by the word that equations.toml has for it."""


@dataclass(frozen=True)
class Printed:
    """An equation as printed. repairs: (what the text has, what is read, why).

    misprint: what is wrong with it, in a line, and affects: what follows from that; empty where nothing is wrong.
    """

    number: int
    section: str
    latex: str
    names: Names
    typed: tuple[Eq, ...]
    repairs: tuple[tuple[str, str, str], ...] = ()
    misprint: str = ""
    affects: str = ""

    @property
    def reading(self) -> str:
        """The string with its repairs; each must find its place, once."""
        text = self.latex
        for found, meant, _ in self.repairs:
            if text.count(found) != 1:
                raise ValueError(f"Eq. ({self.number}): the repair of {found} does not find its place once")
            text = text.replace(found, meant)
        return text

    def read(self) -> tuple[Eq, ...]:
        """What the reader makes of the string."""
        return read(self.reading, self.names)


def _typed(equation: str, names: Names) -> tuple[Eq, ...]:
    """An equation of equations.toml, "a = b" or "a = b = c"; a name stands for what it stands for in the print."""
    unbarred = {name.removesuffix("_bar"): value for name, value in names.values.items()}
    words: dict[str, Any] = {"D": Derivative, "at": at, "integral": Integral, "misprinted": misprinted}
    words |= {"along": lambda density: Integral(density, (x, 0, 1)), "delta": delta, "differential": differential}
    words |= unbarred | dict(names.values) | {"dy": dy, "dW_nc": dW_nc}
    words = {f"{name}_" if keyword.iskeyword(name) else name: value for name, value in words.items()}
    sides = [parse_expr(side, words.copy()) for side in equation.split(" = ")]
    return tuple(Eq(a, b, evaluate=False) for a, b in pairwise(sides))


def _printed(entry: dict[str, Any]) -> Printed:
    names = NAMES[entry["names"]]
    typed = tuple(one for equation in entry["typed"] for one in _typed(equation, names))
    repairs = tuple((found, meant, why) for found, meant, why in entry.get("repairs", ()))
    return Printed(**{**entry, "names": names, "typed": typed, "repairs": repairs})


_DATA = files("freebeam.paper") / "equations.toml"
EQUATIONS: tuple[Printed, ...] = tuple(map(_printed, tomllib.loads(_DATA.read_text(encoding="utf-8"))["equation"]))
