"""The paper's equations (1) to (26) as its text prints them, and the typed form of each: data, and nothing else.

`latex` is the text's own string, letter by letter, faults of its transcription included. Where these make it unreadable,
`repairs` lists what is read for what, and why. `typed` states the same in SymPy, misprints kept: the reader must arrive
at it from the string.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

from sympy import (
    Derivative,
    DiracDelta,
    Eq,
    Expr,
    Function,
    I,
    Integral,
    Matrix,
    Subs,
    Sum,
    Symbol,
    cos,
    cosh,
    exp,
    sin,
    sinh,
    sqrt,
    symbols,
)

from freebeam.paper.reader import Names, delta, differential, misprinted, read
from freebeam_derive import notation as n
from freebeam_derive.notation import EI, F_0, C_alpha, C_beta, L, alpha, beta, chi, gamma, m, t, x, x_F, y
from freebeam_derive.ritz import phi_i, phi_j, q_j

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


def _eq(*sides: Any) -> tuple[Eq, ...]:
    return tuple(Eq(a, b, evaluate=False) for a, b in pairwise(sides))


def _along(density: Expr) -> Expr:
    return Integral(density, (x, 0, 1))


D: Callable[..., Expr] = Derivative
_end_slope = Subs(D(y, x), x, 1)
_ends = (*_eq(x, 0), *_eq(x, 1))
_bending = _along(D(phi_i, (x, 2)) * D(phi_j, (x, 2)))
_geometric = -P_0 * _along(x * D(phi_i, x) * D(phi_j, x)) + P_0 * Subs(D(phi_i, x), x, 1) * phi_j.subs(x, 1)
_rate = beta + alpha * gamma**4
_ratio = (cos(gamma) - cosh(gamma)) / (sin(gamma) + sinh(gamma))

EQUATIONS: tuple[Printed, ...] = (
    Printed(
        1,
        "2",
        r"""M(x,t) = EI\left[\frac{\partial^2 y(x,t)}{\partial x^2} + C_{\alpha} \frac{\partial^3 y(x,t)}{\partial t \partial x^2}\right]""",
        WITH_DIMENSIONS,
        _eq(moment, EI * (D(y, (x, 2)) + C_alpha * D(y, t, (x, 2)))),
    ),
    Printed(
        2,
        "2",
        r"""m\frac{\partial^2 y}{\partial t^2} + C_{\beta}\frac{\partial y}{\partial t} + C_{\alpha}EI\frac{\partial^5 y}{\partial t\partial x^4} + EI\frac{\partial^4 y}{\partial x^4} + \frac{\partial}{\partial x}\left(P(x)\frac{\partial y}{\partial x}\right) - F(x,t) = 0""",
        WITH_DIMENSIONS,
        _eq(
            m * D(y, (t, 2))
            + C_beta * D(y, t)
            + C_alpha * EI * D(y, t, (x, 4))
            + EI * D(y, (x, 4))
            + D(axial * D(y, x), x)
            - lateral,
            0,
        ),
    ),
    Printed(3, "2", r"""P(x) = P_0 \frac{x}{L} \tag{3}""", WITH_DIMENSIONS, _eq(axial, P_0 * x / L)),
    Printed(
        4,
        "2",
        r"""F(x,t) = \frac{F_0(t)\delta(x - x_{F_0})}{L}""",
        WITH_DIMENSIONS,
        _eq(lateral, F_0 * DiracDelta(x - x_F) / L),
        misprint="one length too many below: the delta is of a dimensional place",
        affects="Nothing: Eq. (6) follows from the derived form, with the delta in the nondimensional place.",
    ),
    Printed(
        5,
        "2",
        r"""\overline{y} = \frac{y}{L}, \quad \overline{x} = \frac{x}{L}, \quad \overline{t} = t \left(\frac{EI}{mL^4}\right)^{0.5}, \quad \overline{P}_0 = \frac{P_0 L^2}{EI}$$

$$\overline{F}_0 = \frac{F_0(t)L^2}{EI}, \quad \overline{\beta} = C_\beta \left(\frac{L^4}{mEI}\right)^{0.5}, \quad \overline{\alpha} = C_\alpha \left(\frac{EI}{mL^4}\right)^{0.5}""",
        SCALES,
        (
            *_eq(bar["y"], y_here / L),
            *_eq(bar["x"], x / L),
            *_eq(bar["t"], t * sqrt(EI / (m * L**4))),
            *_eq(bar["P_0"], P_0 * L**2 / EI),
            *_eq(bar["F_0"], F_0 * L**2 / EI),
            *_eq(bar["beta"], C_beta * sqrt(L**4 / (m * EI))),
            *_eq(bar["alpha"], C_alpha * sqrt(EI / (m * L**4))),
        ),
    ),
    Printed(
        6,
        "2",
        r"""\frac{\partial^2 \overline{y}}{\partial \overline{t}^2} + \overline{\beta} \frac{\partial \overline{y}}{\partial \overline{t}} + \overline{\alpha} \frac{\partial^3 \overline{y}}{\partial \overline{t} \partial \overline{x}^4} + \frac{\partial^4 \overline{y}}{\partial \overline{x}^4} + \overline{P}_0 \frac{\partial}{\partial \overline{x}} \left( \overline{x} \frac{\partial \overline{y}}{\partial \overline{x}} \right) - \overline{F}_0 \delta(\overline{x} - \overline{x}_{F_0}) = 0""",
        FIELDS,
        _eq(
            D(y, (t, 2))
            + beta * D(y, t)
            + alpha * misprinted(3, D(y, t, (x, 4)))
            + D(y, (x, 4))
            + P_0 * D(x * D(y, x), x)
            - F_0 * DiracDelta(x - x_F),
            0,
        ),
        misprint="the internal damping is of fifth order, not third",
        affects="Nothing: Eqs. (2) and (14) have it right.",
    ),
    Printed(
        7,
        "3",
        r"""\delta \int_{\overline{t}_1}^{\overline{t}_2} (\overline{T} - \overline{V} + \overline{W}_c) d\overline{t} + \int_{\overline{t}_1}^{\overline{t}_2} d\overline{W}_{nc} d\overline{t} = 0""",
        VARIED,
        _eq(delta(Integral(T - V + W_c, (t, t_1, t_2))) + Integral(differential(W_nc), (t, t_1, t_2)), 0),
        misprint="δ is meant where d stands: the work has no differential",
        affects="Nothing.",
    ),
    Printed(
        8,
        "3",
        r"""\begin{cases}
\overline{T} = \frac{1}{2} \int_{0}^{1} \left(\frac{\partial \overline{y}}{\partial \overline{t}}\right)^{2} d\overline{x} \\
\overline{V} = \frac{1}{2} \int_{0}^{1} \left(\frac{\partial^{2} \overline{y}}{\partial \overline{x}^{2}}\right)^{2} d\overline{x} \\
\overline{W}_{c} = \frac{1}{2} \overline{P}_{0} \int_{0}^{1} \overline{x} \left(\frac{\partial \overline{y}}{\partial \overline{x}}\right)^{2} d\overline{x} \\
\delta \overline{W}_{nc} = \underbrace{-\int_{0}^{1} \left[\overline{\beta} \frac{\partial \overline{y}}{\partial \overline{t}} \delta \overline{y} + \overline{\alpha} \frac{\partial^{3} \overline{y}}{\partial \overline{t} \partial \overline{x}^{2}} \delta \left(\frac{\partial^{2} \overline{y}}{\partial \overline{x}^{2}}\right)\right] d\overline{x} - \underbrace{\overline{P}_{0} \left(\frac{\partial \overline{y}}{\partial \overline{x}}\right)\Big|_{\overline{x} = 1} + \overline{F}_{0} \delta \overline{y}\Big|_{\overline{x} = \overline{x}_{F_{0}}}}_{\delta \overline{W}_{nc3}}
\end{cases}""",
        VARIED,
        (
            *_eq(T, _along(D(y, t) ** 2) / 2),
            *_eq(V, _along(D(y, (x, 2)) ** 2) / 2),
            *_eq(W_c, P_0 * _along(x * D(y, x) ** 2) / 2),
            *_eq(
                dW_nc,
                -_along(beta * D(y, t) * dy + alpha * D(y, t, (x, 2)) * D(dy, (x, 2)))
                - P_0 * _end_slope
                + F_0 * dy.subs(x, x_F),
            ),
        ),
        repairs=(
            (r"\underbrace{-\int", r"-\int", "a brace below that is never closed; it names a part of the work"),
            (r"\underbrace{\overline{P}_{0}", r"\overline{P}_{0}", "the same; a name, no factor"),
            (r"}_{\delta \overline{W}_{nc3}}", "", "the end of these braces"),
        ),
        misprint="the virtual displacement is missing in the follower force's work",
        affects="Nothing that follows: Eq. (11) holds two factors there.",
    ),
    Printed(
        9,
        "3",
        r"""\overline{y}(\overline{x},\overline{t}) = \sum_{i=1}^{N} \varphi_i(\overline{x}) q_i(\overline{t})""",
        FIELDS,
        _eq(y, Sum(phi_i * q_i, (i, 1, N))),
    ),
    Printed(
        10,
        "3",
        r"""[M_{ij}][\ddot{q}_j] + [C_{ij}][\dot{q}_j] + [K_{ij}][q_j] = [Q_j]""",
        FIELDS,
        _eq(M_ij * D(q_j, (t, 2)) + C_ij * D(q_j, t) + K_ij * q_j, Q_j),
        misprint="the equation is that of the test function i, and so is its force",
        affects="Nothing.",
    ),
    Printed(
        11,
        "3",
        r"""\begin{cases}
M_{ij} = \int_{0}^{1} \varphi_{i} \varphi_{j} d\overline{x} \\
C_{ij} = \int_{0}^{1} \left[ \overline{\beta} \varphi_{i} \varphi_{j} + \overline{\alpha} \varphi_{i}^{"} \varphi_{j}^{"} \right] d\overline{x} \\
K_{ij} = \int_{0}^{1} \varphi_{i}^{"} \varphi_{j}^{"} d\overline{x} - \overline{P}_{0} \int_{0}^{1} \overline{x} \varphi_{i}^{'} \varphi_{j}^{'} d\overline{x} + \overline{P}_{0} \varphi_{i}^{'}(1) \varphi_{j}(1) \\
Q_{j} = \overline{F}_{0} \varphi_{j}(\overline{x}_{F_{0}})
\end{cases}""",
        FIELDS,
        (
            *_eq(M_ij, _along(phi_i * phi_j)),
            *_eq(C_ij, _along(beta * phi_i * phi_j + alpha * D(phi_i, (x, 2)) * D(phi_j, (x, 2)))),
            *_eq(K_ij, _bending + _geometric),
            *_eq(Q_j, F_0 * phi_j.subs(x, x_F)),
        ),
        misprint="the follower term is transposed: the row is the test function",
        affects="Not the eigenvalues, nor a critical load: M and C are symmetric and the printed K is the derived one transposed. The eigenvectors, and with them the responses of Figs. 8 to 10.",
    ),
    Printed(
        12,
        "3",
        r"""[C_{ij}] = \overline{\beta}[M_{ij}] + \overline{\alpha}([K_{ij}] - [K_{ij}^G])""",
        FIELDS,
        _eq(C_ij, beta * M_ij + alpha * (K_ij - KG_ij)),
    ),
    Printed(
        13,
        "3",
        r"""K_{ij}^{G} = -\overline{P}_{0} \int_{0}^{1} \overline{x} \,\varphi_{i}^{\,\prime} \,\varphi_{j}^{\,\prime} \,d\overline{x} + \overline{P}_{0} \,\varphi_{i}^{\,\prime}(1) \,\varphi_{j}(1) \tag{13}""",
        FIELDS,
        _eq(KG_ij, _geometric),
        misprint="transposed as in Eq. (11)",
        affects="As Eq. (11).",
    ),
    Printed(
        14,
        "3.1",
        r"""\frac{\partial^2 \overline{y}}{\partial \overline{t}^2} + \overline{\beta} \frac{\partial \overline{y}}{\partial \overline{t}} + \overline{\alpha} \frac{\partial^5 \overline{y}}{\partial \overline{t} \partial \overline{x}^4} + \frac{\partial^4 \overline{y}}{\partial \overline{x}^4} = 0""",
        FIELDS,
        _eq(D(y, (t, 2)) + beta * D(y, t) + alpha * D(y, t, (x, 4)) + D(y, (x, 4)), 0),
    ),
    Printed(
        15,
        "3.1",
        r"""\begin{cases} \frac{\partial^2 \overline{y}}{\partial \overline{x}^2} + \overline{\alpha} \frac{\partial^3 \overline{y}}{\partial \overline{t} \partial \overline{x}^2} = 0\\ \frac{\partial^3 \overline{y}}{\partial \overline{x}^3} + \overline{\alpha} \frac{\partial^4 \overline{y}}{\partial \overline{t} \partial \overline{x}^3} = 0 \end{cases} \quad \text{at} \quad \overline{x} = 0, \overline{x} = 1 \tag{15}""",
        FIELDS,
        (
            *_eq(D(y, (x, 2)) + alpha * D(y, t, (x, 2)), 0),
            *_eq(D(y, (x, 3)) + alpha * D(y, t, (x, 3)), 0),
            *_ends,
        ),
    ),
    Printed(
        16,
        "3.1",
        r"""\overline{y}(\overline{x},\overline{t}) = \chi(\overline{x})\,\tau(\overline{t}) = \chi(\overline{x})e^{\lambda_0\overline{t}}""",
        FIELDS,
        _eq(y, chi * tau, chi * exp(lambda_0 * t)),
    ),
    Printed(
        17,
        "3.1",
        r"""\lambda_0^2 \chi + \lambda_0 (\overline{\beta} \chi + \overline{\alpha} \chi''') + \chi''' = 0""",
        FIELDS,
        _eq(lambda_0**2 * chi + lambda_0 * (beta * chi + alpha * D(chi, (x, 3))) + D(chi, (x, 3)), 0),
        misprint="the fourth derivative is meant (it may be a fault of transcription)",
        affects="Nothing: Eq. (19) is right.",
    ),
    Printed(
        18,
        "3.1",
        r"""\begin{cases} (1 + \lambda_0 \overline{\alpha}) \chi'' = 0\\ (1 + \lambda_0 \overline{\alpha}) \chi''' = 0 \end{cases} \quad \text{at} \quad \overline{x} = 0, \overline{x} = 1""",
        FIELDS,
        (
            *_eq((1 + lambda_0 * alpha) * D(chi, (x, 2)), 0),
            *_eq((1 + lambda_0 * alpha) * D(chi, (x, 3)), 0),
            *_ends,
        ),
    ),
    Printed(
        19,
        "3.1",
        r"""\chi'''' - \gamma^{4} \chi = 0, \quad \gamma^{4} = -\left(\frac{\lambda_{0}^{2} + \lambda_{0}\beta}{1 + \lambda_{0}\overline{\alpha}}\right)""",
        FIELDS,
        (
            *_eq(D(chi, (x, 4)) - gamma**4 * chi, 0),
            *_eq(gamma**4, -((lambda_0**2 + lambda_0 * beta) / (1 + lambda_0 * alpha))),
        ),
    ),
    Printed(
        20,
        "3.1",
        r"""\begin{cases} \chi'' = 0\\ \chi''' = 0 \end{cases} \quad \text{at} \quad \overline{x} = 0, \overline{x} = 1 \end{cases}""",
        FIELDS,
        (*_eq(D(chi, (x, 2)), 0), *_eq(D(chi, (x, 3)), 0), *_ends),
        repairs=((r"1 \end{cases}", "1", "a second end of the same cases"),),
    ),
    Printed(21, "3.1", r"""\cos\gamma\cosh\gamma = 1 \tag{21}""", FIELDS, _eq(cos(gamma) * cosh(gamma), 1)),
    Printed(
        22,
        "3.1",
        r"""\chi(\overline{x}) = \sin\gamma\overline{x} + \sinh\gamma\overline{x} + \left(\frac{\cos\gamma - \cosh\gamma}{\sin\gamma + \sinh\gamma}\right)(\cos\gamma\overline{x} + \cosh\gamma\overline{x})""",
        FIELDS,
        _eq(chi, sin(gamma * x) + sinh(gamma * x) + _ratio * (cos(gamma * x) + cosh(gamma * x))),
    ),
    Printed(
        23,
        "3.1",
        r"""\lambda_{0_1}, \lambda_{0_2} = \frac{-(\overline{\beta} + \overline{\alpha}\gamma^4)}{2} \pm \frac{\sqrt{(\overline{\beta} + \overline{\alpha}\gamma^4)^2 - 4\gamma^4}}{2}""",
        FIELDS,
        (
            *_eq(lambda_01, -_rate / 2 + sqrt(_rate**2 - 4 * gamma**4) / 2),
            *_eq(lambda_02, -_rate / 2 - sqrt(_rate**2 - 4 * gamma**4) / 2),
        ),
    ),
    Printed(
        24,
        "3.2",
        r"""[q_j] = [\hat{q}_j] e^{\lambda \vec{\imath}}, \quad \lambda = \lambda_R + i\lambda_I, \quad i = \sqrt{-1}""",
        EIGENVALUES,
        (*_eq(q_j, qhat_j * exp(lambda_ * t)), *_eq(lambda_, lambda_R + unit * lambda_I), *_eq(unit, I)),
        repairs=((r"\vec{\imath}", r"\overline{t}", "the exponent's time, badly transcribed"),),
    ),
    Printed(
        25,
        "3.2",
        r"""A = \begin{bmatrix} 0 & I \\ -[M_{ij}]^{-1}[K_{ij}] & -[M_{ij}]^{-1}[C_{ij}] \end{bmatrix}""",
        EIGENVALUES,
        _eq(A, Matrix([[0, identity], [-(M**-1) * K, -(M**-1) * C]]).as_immutable()),
    ),
    Printed(
        26,
        "3.2",
        r"""\overline{\lambda} = \left(\frac{\lambda}{\lambda_{0_{I_{1}}}}\right) = \left(\frac{\lambda_{R} + i\lambda_{I}}{\lambda_{0_{I_{1}}}}\right) = \overline{\lambda}_{R} + i\overline{\lambda}_{I}""",
        EIGENVALUES,
        _eq(
            lambda_bar,
            lambda_ / reference,
            (lambda_R + unit * lambda_I) / reference,
            lambda_bar_R + unit * lambda_bar_I,
        ),
        misprint="undefined where the first mode is overdamped, which is inside the range of Fig. 4",
        affects="No critical load; eigenvalues there have no printed scale.",
    ),
)
