"""Every symbol once: code name, LaTeX, meaning, the equation that introduces it.

Bars over nondimensional quantities are left out: in this project everything is nondimensional (Eq. (5))
unless it stands in a dimensional statement, whose own symbols are `m`, `EI`, `L`, `C_alpha`, `C_beta`.
"""

from __future__ import annotations

from dataclasses import dataclass

from sympy import Expr, Function, Symbol


@dataclass(frozen=True)
class Notation:
    """A symbol with what a reader must know of it."""

    symbol: Expr
    latex: str
    meaning: str
    equation: str

    @property
    def name(self) -> str:
        """Code name."""
        return str(self.symbol.func if self.symbol.is_Function else self.symbol)


NOTATION: dict[str, Notation] = {}

QUANTITIES = ("deflection", "slope", "moment", "shear")  # a trial function and its derivatives, by their order
PRIMES = ("", "′", "″", "‴")


def _symbol(name: str, latex: str, meaning: str, equation: str, **assumptions: bool) -> Symbol:
    symbol = Symbol(name, **({"real": True} | assumptions))
    NOTATION[name] = Notation(symbol, latex, meaning, equation)
    return symbol


def _function(name: str, arguments: tuple[Symbol, ...], latex: str, meaning: str, equation: str) -> Expr:
    applied: Expr = Function(name, real=True)(*arguments)
    NOTATION[name] = Notation(applied, latex, meaning, equation)
    return applied


x = _symbol("x", "x", "place along the beam, 0 to 1", "Eq. (5)")
t = _symbol("t", "t", "time", "Eq. (5)")
P = _symbol("P", "P_0", "load: the axial or follower force", "Eq. (5)")
alpha = _symbol("alpha", r"\alpha", "internal (Kelvin-Voigt) damping", "Eq. (5)", nonnegative=True)
beta = _symbol("beta", r"\beta", "external (viscous) damping", "Eq. (5)", nonnegative=True)
x_F = _symbol("x_F", "x_F", "place of the transversal (controller) force", "Eq. (4)")
x_s = _symbol("x_s", "x_s", "place of the sensor", "Fig. 1")
gamma = _symbol("gamma", r"\gamma", "root of the characteristic equation", "Eq. (19)", positive=True)
omega = _symbol("omega", r"\omega", "circular frequency", "Eq. (24)", nonnegative=True)
lambda_ = _symbol("lambda", r"\lambda", "eigenvalue", "Eq. (24)", real=None)  # type: ignore[arg-type]

y = _function("y", (x, t), "y", "deflection", "Eq. (2)")
variation_of_y = _function("delta_y", (x, t), r"\delta y", "virtual displacement", "Eq. (7)")
F_0 = _function("F_0", (t,), "F_0", "transversal (controller) force", "Eq. (4)")
chi = _function("chi", (x,), r"\chi", "mode shape of the comparison beam", "Eq. (16)")

m = _symbol("m", "m", "mass per unit length", "Eq. (2)", positive=True)
EI = _symbol("EI", "EI", "bending stiffness", "Eq. (1)", positive=True)
L = _symbol("L", "L", "length", "Eq. (3)", positive=True)
C_alpha = _symbol("C_alpha", r"C_\alpha", "internal damping coefficient", "Eq. (1)", nonnegative=True)
C_beta = _symbol("C_beta", r"C_\beta", "external damping coefficient", "Eq. (2)", nonnegative=True)
