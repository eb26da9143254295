"""Section 2, Mathematical modeling: Eqs. (1)-(6), in SI units and in nondimensional ones."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import freebeam as fb

EI, m, L = 2.3e6, 41.0, 17.5  # N m², kg/m, m
C_alpha, C_beta, P_0 = 3.1e-3, 55.0, 9.4e4  # s, kg/(m s), N


def unit() -> dict[str, float]:
    return fb.column("free-free").kernel.scales(EI, m, L)


def motion(x: Any, t: Any, dx: int, dt: int) -> Any:
    """Some smooth nondimensional motion and its derivatives."""
    return 3.0**dx * np.sin(3 * x + 1 + dx * np.pi / 2) * 2.0**dt * np.cos(2 * t + dt * np.pi / 2)


def motion_SI(x: Any, t: Any, dx: int, dt: int) -> Any:
    """The same motion of the beam of length L: y(x, t) = L ȳ(x/L, t/t₁)."""
    return L * motion(x / L, t / unit()["time"], dx, dt) / L**dx / unit()["time"] ** dt


X = np.linspace(0, 1, 7)  # places and times, nondimensional
T = np.linspace(0, 2, 7)


def test_equation_5_as_printed() -> None:
    """Each nondimensional quantity of Eq. (5) from its dimensional one."""
    rate = (EI / (m * L**4)) ** 0.5
    assert 1 / unit()["length"] == pytest.approx(1 / L, rel=1e-14)
    assert 1 / unit()["time"] == pytest.approx(rate, rel=1e-14)
    assert P_0 / unit()["load"] == pytest.approx(P_0 * L**2 / EI, rel=1e-14)
    assert 7.0 / unit()["force"] == pytest.approx(7.0 * L**2 / EI, rel=1e-14)
    assert C_beta / unit()["beta"] == pytest.approx(C_beta * (L**4 / (m * EI)) ** 0.5, rel=1e-14)
    assert C_alpha / unit()["alpha"] == pytest.approx(C_alpha * rate, rel=1e-14)


def test_equation_1_the_bending_moment() -> None:
    """M = EI (y'' + C_α ẏ'') is EI/L times its nondimensional form with ᾱ."""
    alpha = C_alpha / unit()["alpha"]
    x, t = X * L, T * unit()["time"]
    moment = EI * (motion_SI(x, t, 2, 0) + C_alpha * motion_SI(x, t, 2, 1))
    np.testing.assert_allclose(moment, EI / L * (motion(X, T, 2, 0) + alpha * motion(X, T, 2, 1)), rtol=1e-12)
    assert unit()["energy"] == pytest.approx(EI / L, rel=1e-14)  # a moment is measured as an energy is


def test_equations_2_and_6_are_the_same_equation() -> None:
    """Eq. (2) with the axial force of Eq. (3) is EI/L³ times Eq. (6), with ∂⁵ in the internal damping (printed ∂³)."""
    alpha, beta, P = C_alpha / unit()["alpha"], C_beta / unit()["beta"], P_0 / unit()["load"]
    x, t = X * L, T * unit()["time"]

    def equation_2(y: Any) -> Any:
        axial, slope_of_axial = P_0 * x / L, P_0 / L  # Eq. (3)
        return (
            m * y(x, t, 0, 2)
            + C_beta * y(x, t, 0, 1)
            + C_alpha * EI * y(x, t, 4, 1)
            + EI * y(x, t, 4, 0)
            + slope_of_axial * y(x, t, 1, 0)
            + axial * y(x, t, 2, 0)
        )

    equation_6 = (
        motion(X, T, 0, 2)
        + beta * motion(X, T, 0, 1)
        + alpha * motion(X, T, 4, 1)
        + motion(X, T, 4, 0)
        + P * (motion(X, T, 1, 0) + X * motion(X, T, 2, 0))
    )
    np.testing.assert_allclose(equation_2(motion_SI), EI / L**3 * equation_6, rtol=1e-11)


def test_equation_3_the_axial_force_holds_the_beam_in_its_own_acceleration() -> None:
    """P(x) = P₀ x/L: the free beam's load matrix by quadrature with this force; constant force gives another."""
    system = fb.column("free-free").system(8)
    nodes, weights = np.polynomial.legendre.leggauss(80)
    x, w = (nodes + 1) / 2, weights / 2
    slope, end = system.shapes(x, 1), np.outer(system.shapes(1.0), system.shapes(1.0, 1))
    linear, constant = (end - (slope * w * force) @ slope.T for force in (x, np.ones_like(x)))
    np.testing.assert_allclose(system.H, linear, rtol=0, atol=1e-11 * np.abs(system.H).max())
    assert np.abs(system.H - constant).max() > 0.1 * np.abs(system.H).max()


def test_equation_4_a_force_accelerates_the_mass_of_the_beam() -> None:
    """Newton's law in SI: m L ÿ_G = F₀ wherever the force acts. Eq. (4) as printed, with a delta in x and 1/L, would be
    a force F₀/L, which is no force; the delta of x/L makes it right."""
    F_0, x_F = 12.0, 0.3
    system = fb.column("free-free").system(8, load=0.0, rigid=True)
    ddq = np.linalg.solve(system.M, system.Q(x_F) * F_0 / unit()["force"])
    centre = ddq[0] * unit()["acceleration"]  # the first rigid function is 1, the rest move no centre of mass
    assert centre == pytest.approx(F_0 / (m * L), rel=1e-12)
    # and its moment turns it: J θ̈ = F₀ (x_F − L/2)
    turning = ddq[1] * unit()["acceleration"] / L
    assert turning == pytest.approx(F_0 * (x_F - 0.5) * L / (m * L**3 / 12), rel=1e-12)


def test_the_critical_load_in_newtons() -> None:
    """Eq. (2) in SI, multiplied by the modes and integrated over the length: its eigenvalues, per second, cross the
    axis at the nondimensional critical load times EI/L²."""
    column = fb.column("free-free")
    found = fb.critical_load(column, alpha=C_alpha / unit()["alpha"], beta=C_beta / unit()["beta"])
    M, E, H = column.matrices(8)  # integrals over 0 to 1 of functions of x/L
    mass, bending, axial = m * L * M, EI / L**3 * E, H / L
    damping = C_beta * L * M + C_alpha * bending

    def eigenvalues(newtons: float) -> Any:
        K = bending + newtons * axial
        A = np.block([[np.zeros((8, 8)), np.eye(8)], [-np.linalg.solve(mass, K), -np.linalg.solve(mass, damping)]])
        return np.linalg.eigvals(A)

    load = found.load * unit()["load"]
    assert eigenvalues(load * (1 - 1e-6)).real.max() < 0 < eigenvalues(load * (1 + 1e-6)).real.max()
    values = eigenvalues(load)
    crossing = values[np.argmax(values.real)]
    assert abs(crossing.imag) == pytest.approx(found.frequency * unit()["frequency"], rel=1e-6)
