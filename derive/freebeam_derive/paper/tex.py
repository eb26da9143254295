"""The forms of the ledger as LaTeX, near to how the paper prints them. Eqs. (1)-(26).

Bars are left out, as everywhere in this project; where barred and plain quantities meet, Eq. (5), they are kept.
"""

from __future__ import annotations

from typing import Any

from sympy import Basic, Derivative, Eq
from sympy.core.function import AppliedUndef
from sympy.printing.latex import LatexPrinter

from freebeam_derive.notation import NOTATION, t, x

_NAMES = {
    "delta_W_nc": r"\delta W_{nc}", "W_nc": "W_{nc}", "K^G_ij": "K^G_{ij}", "qhat_j": r"\hat{q}_j", "tail": r"\eta",
    "sigma": r"\sigma", "lambda_bar": r"\bar{\lambda}", "lambda_bar_R": r"\bar{\lambda}_R", "i": r"\mathrm{i}",
    "lambda_bar_I": r"\bar{\lambda}_I", "lambda_0_I1": r"\lambda_{0 I_1}", "lambda_0_1": r"\lambda_{0_1}",
    "lambda_0_2": r"\lambda_{0_2}", "P_0_bar": r"\bar{P}_0", "F_0_bar": r"\bar{F}_0", "alpha_bar": r"\bar{\alpha}",
    "beta_bar": r"\bar{\beta}", "x_bar": r"\bar{x}", "t_bar": r"\bar{t}", "y_bar": r"\bar{y}",
}  # fmt: skip
_FIELDS = {
    "P": "P",
    "F": "F",
    "M": "M",
    "phi_i": r"\varphi_i",
    "phi_j": r"\varphi_j",
    "q_i": "q_i",
    "q_j": "q_j",
    "tau": r"\tau",
}


class _Printer(LatexPrinter):  # type: ignore[misc]
    def __init__(self) -> None:
        super().__init__({"fold_short_frac": False, "mul_symbol": None})

    def _print_Symbol(self, expr: Any, style: str = "plain") -> str:
        name = str(expr)
        if name == "i" and expr.is_integer:  # the counter of a sum
            return name
        if name in _NAMES:
            return _NAMES[name]
        return NOTATION[name].latex if name in NOTATION else str(super()._print_Symbol(expr))

    def _letter(self, function: Any) -> str:
        name = function.func.__name__
        return _FIELDS.get(name) or (NOTATION[name].latex if name in NOTATION else name)

    def _print_Function(self, expr: Any, exp: Any = None) -> str:
        name = expr.func.__name__
        if not isinstance(expr, AppliedUndef):
            return str(super()._print_Function(expr, exp))
        if name.startswith("order_"):  # a derivative printed with another order than it has
            return self._fraction(expr.args[0], int(name.removeprefix("order_")))
        inside = ", ".join(map(self._print, expr.args))
        if name == "undefined":
            return rf"\text{{undefined where }} {inside}"
        if name == "delta":
            return rf"\delta {inside}"
        if name == "d":
            return f"d{inside}"
        text = self._letter(expr)
        if len(expr.args) == 2 and expr.args[1] == t:  # a field: at a place, or anywhere
            inside = "" if expr.args[0] == x else self._print(expr.args[0])
        elif expr.args[0] in (x, t) and name not in ("P", "F", "M"):
            inside = ""
        text += rf"({inside})" if inside else ""
        return rf"\left({text}\right)^{{{exp}}}" if exp else text

    def _print_Derivative(self, expr: Any) -> str:
        inner = expr.expr
        if isinstance(inner, AppliedUndef) and len(inner.args) == 1 and inner.args[0] == x:
            return self._letter(inner) + "'" * sum(int(n) for _, n in expr.variable_count)
        return self._fraction(expr, sum(int(n) for _, n in expr.variable_count))

    def _fraction(self, expr: Any, order: int) -> str:
        inner = expr.expr
        of = self._letter(inner) if isinstance(inner, AppliedUndef) else self._print(inner)
        sign = "d" if len(inner.args) == 1 else r"\partial "
        power = f"^{order}" if order > 1 else ""
        by = r"\,".join(f"{sign}{v}" + (f"^{n}" if n > 1 else "") for v, n in sorted(expr.variable_count, key=str))
        return rf"\frac{{{sign.rstrip()}{power} {of}}}{{{by}}}"

    def _print_Subs(self, expr: Any) -> str:
        inner, (variable,), (place,) = expr.args
        if inner.expr.args == (x,):
            return f"{self._print(inner)}({self._print(place)})"
        return rf"\left.{self._print(inner)}\right|_{{{self._print(variable)}={self._print(place)}}}"

    def _print_Integral(self, expr: Any) -> str:
        ((variable, low, high),) = expr.limits
        inside = self._print(expr.function)
        inside = rf"\left({inside}\right)" if expr.function.is_Add else inside
        low, high, variable = map(self._print, (low, high, variable))
        return rf"\int_{{{low}}}^{{{high}}} {inside}\,d{variable}"

    def _print_DiracDelta(self, expr: Any, exp: Any = None) -> str:
        return rf"\delta({self._print(expr.args[0])})"

    def _print_Pow(self, expr: Any) -> str:
        if isinstance(expr.base, Derivative) and expr.exp.is_Integer:
            return rf"\left({self._print(expr.base)}\right)^{expr.exp}"
        return str(super()._print_Pow(expr))


def latex(form: Basic) -> str:
    """LaTeX of a form: an equation or a difference."""
    printer = _Printer()
    if isinstance(form, Eq):
        return f"{printer.doprint(form.lhs)} = {printer.doprint(form.rhs)}"
    return str(printer.doprint(form))
