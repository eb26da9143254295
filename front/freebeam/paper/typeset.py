"""The forms of the ledger as LaTeX, near to how the paper prints them: its fractions of ∂. Eqs. (1)-(26).

Bars are left out, as everywhere in this project; where barred and plain quantities meet, Eq. (5), they are kept.
"""

from __future__ import annotations

from typing import Any

from sympy import Basic
from sympy.core.function import AppliedUndef

from freebeam_derive.latex import Printer

_NAMES = {
    "W_nc": r"W_{\mathrm{nc}}", "qhat_j": r"\hat{q}_{j}", "tail": r"\eta", "lambda_0_I1": r"\lambda_{0 I_1}",
    "lambda_0_1": r"\lambda_{0_1}", "lambda_0_2": r"\lambda_{0_2}",
}  # fmt: skip


class _Printer(Printer):
    def _print_Symbol(self, expr: Any, style: str = "plain") -> str:
        if str(expr) == "i" and not expr.is_integer:  # not the counter of a sum
            return r"\mathrm{i}"
        return super()._print_Symbol(expr, style)

    def _print_Function(self, expr: Any, exp: Any = None) -> str:
        name = expr.func.__name__
        if isinstance(expr, AppliedUndef) and name.startswith("order_"):  # printed with another order than it has
            return self._fraction(expr.args[0], int(name.removeprefix("order_")))
        if name in _WORDS:
            return _WORDS[name] + ", ".join(map(self._print, expr.args))
        return super()._print_Function(expr, exp)

    def _print_Derivative(self, expr: Any) -> str:
        if isinstance(expr.expr, AppliedUndef) and len(expr.expr.args) == 1:
            return super()._print_Derivative(expr)
        return self._fraction(expr, sum(int(n) for _, n in expr.variable_count))

    def _fraction(self, expr: Any, order: int) -> str:
        of, after = self._print(expr.expr), ""
        if not isinstance(expr.expr, AppliedUndef):
            of, after = "", rf" \left({of}\right)"
        power = f"^{order} " if order > 1 else " "
        by = r"\,".join(rf"\partial {v}" + (f"^{n}" if n > 1 else "") for v, n in sorted(expr.variable_count, key=str))
        return rf"\frac{{\partial{power}{of}}}{{{by}}}{after}"

    def _print_Subs(self, expr: Any) -> str:
        inner, (variable,), (place,) = expr.args
        if len(inner.expr.args) == 1:
            return super()._print_Subs(expr)
        return rf"\left.{self._print(inner)}\right|_{{{self._print(variable)}={self._print(place)}}}"


_WORDS = {"undefined": r"\text{undefined where }", "delta": r"\delta ", "d": "d"}


def latex(form: Basic) -> str:
    """LaTeX of a form: an equation or a difference."""
    return str(_Printer(_NAMES).doprint(form))
