"""Ziegler's double pendulum: two links on springs under a force along the second; alpha damps both joints alike."""

from sympy import Symbol

from freebeam_derive.notation import EI, C_alpha, L, P, alpha, m, t
from freebeam_derive.references import CLOSED_FORM
from freebeam_derive.statement import Column, Coordinate, Energies, Parameter, Reference, delta

mu, M_joint = Symbol("mu", real=True), Symbol("M_joint", real=True)
p, q = Coordinate("p", r"\varphi_{1}"), Coordinate("q", r"\varphi_{2}")  # angles of the links

column = Column(
    name="ziegler",
    title="Ziegler's double pendulum under a follower force",
    family="Links",
    T=(mu * p.diff(t) ** 2 + (p.diff(t) + q.diff(t)) ** 2) / 2,
    V=(p**2 + (q - p) ** 2) / 2,
    W_c=P * (p**2 + q**2) / 2,
    dW_nc=-alpha * (p.diff(t) * delta(p) + (q.diff(t) - p.diff(t)) * delta(q - p)) - P * q * delta(p + q),
    parameters=(Parameter(mu, "mass at the middle joint in units of that at the end", 2.0, 0.1, 10.0, r"\mu"),),
    # links of length L, a mass m L at the end and springs EI / L, damped by C_alpha EI / L, at both joints
    dimensional=Energies(
        T=L**2 * (M_joint * p.diff(t) ** 2 + m * L * (p.diff(t) + q.diff(t)) ** 2) / 2,
        V=EI / L * (p**2 + (q - p) ** 2) / 2,
        W_c=P * L * (p**2 + q**2) / 2,
        dW_nc=-C_alpha * EI / L * (p.diff(t) * delta(p) + (q.diff(t) - p.diff(t)) * delta(q - p))
        - P * L * q * delta(p + q),
        length=L,
        scaling={M_joint: mu * m * L},
    ),
    source="Kirillov, Structural optimization of the Ziegler's pendulum, arXiv:1101.0246",
    references=(
        Reference("2.08578643762690", "flutter", CLOSED_FORM),
        Reference("1.464285714286", "flutter", CLOSED_FORM, kappa=0.0),
        # Seen on 27 November 2026: with both dashpots alike the formula there is 41/28 + alpha^2/2.
        Reference(
            f"{41 / 28 + 0.1**2 / 2:.12f}",
            "flutter",
            "Semler et al. (1998), whose formula for the critical load a public post prints",
            alpha=0.1,
            seen="https://github.com/zhilongwei/zhilongwei.github.io, post on a double pendulum with a follower load",
        ),
    ),
)
