"""Mechanisms in minimal coordinates, written by hand: nothing here comes from symhyb.

Slider-crank of models/slider_crank.toml in phi alone, four-bar of models/four_bar.toml in alpha
alone: positions of everything as functions of one angle, with first and second derivatives.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
G = 9.81


@dataclass(frozen=True)
class Reduced:
    """A mechanism at one angle: dependent coordinates with slopes and curvatures by the angle, the
    reduced inertia M and its half slope C (M q'' + C q'² = Q + torque), and potential energy."""

    q: Array
    slope: Array
    curve: Array
    mass: float
    turn: float
    pull: float
    potential: float

    def acceleration(self, rate: float, torque: float) -> float:
        return (self.pull + torque - self.turn * rate**2) / self.mass

    def energy(self, rate: float) -> float:
        return self.mass * rate**2 / 2 + self.potential


def _reduced(
    q: Array,
    slope: Array,
    curve: Array,
    parts: list[tuple[float, float, float]],
    heights: list[tuple[float, float, float]],
    spring: tuple[float, float, float, float] | None,
) -> Reduced:
    """``parts``: (inertia or mass, first, second derivative of what it moves with); ``heights``:
    (mass, height, slope); ``spring``: (stiffness, stretch, its slope, 0)."""
    mass = sum(m * one**2 for m, one, _ in parts)
    turn = sum(m * one * two for m, one, two in parts)
    pull = -sum(m * G * rise for m, _, rise in heights)
    potential = sum(m * G * height for m, height, _ in heights)
    if spring is not None:
        pull -= spring[0] * spring[1] * spring[2]
        potential += spring[0] * spring[1] ** 2 / 2
    return Reduced(q, slope, curve, mass, turn, pull, potential)


def slider_crank(phi: float) -> Reduced:
    r, rod_l, J_1, m_2, J_2, m_3, k, x_0 = 0.10, 0.30, 6e-3, 0.30, 3e-3, 0.80, 120.0, 0.30
    s, c = np.sin(phi), np.cos(phi)
    sp = r * s / rod_l
    psi = np.arcsin(sp)
    cp = np.cos(psi)
    psi_1 = r * c / (rod_l * cp)
    psi_2 = (-r * s + rod_l * sp * psi_1**2) / (rod_l * cp)
    x, x_1 = r * c + rod_l * cp, -r * s - rod_l * sp * psi_1
    x_2 = -r * c - rod_l * cp * psi_1**2 - rod_l * sp * psi_2
    rod = rod_l / 2
    cx_1, cx_2 = -r * s - rod * sp * psi_1, -r * c - rod * (cp * psi_1**2 + sp * psi_2)
    cy, cy_1 = r * s - rod * sp, r * c - rod * cp * psi_1
    cy_2 = -r * s + rod * (sp * psi_1**2 - cp * psi_2)
    parts = [(J_1, 1.0, 0.0), (m_2, cx_1, cx_2), (m_2, cy_1, cy_2), (J_2, psi_1, psi_2)]
    return _reduced(
        np.array([phi, psi, x]),
        np.array([1.0, psi_1, x_1]),
        np.array([0.0, psi_2, x_2]),
        [*parts, (m_3, x_1, x_2)],
        [(m_2, cy, cy_1)],
        (k, x - x_0, x_1, 0.0),
    )


def four_bar(alpha: float) -> Reduced:
    """The coupler end by the intersection of two circles, the upper of the two points."""
    a, b, c, d = 0.10, 0.25, 0.20, 0.22
    m_1, J_1, m_2, J_2, m_3, J_3 = 0.30, 4e-3, 0.25, 1.3e-3, 0.40, 1.5e-3
    pin = a * np.array([np.cos(alpha), np.sin(alpha)])
    apart = np.array([d, 0.0]) - pin
    length = np.hypot(*apart)
    ahead = (b**2 - c**2 + length**2) / (2 * length)
    side = np.sqrt(b**2 - ahead**2)
    end = pin + ahead * apart / length + side * np.array([-apart[1], apart[0]]) / length
    theta, gamma = np.arctan2(*(end - pin)[::-1]), np.arctan2(end[1], end[0] - d)
    # b sin, cos of theta and c sin, cos of gamma close the loop: two linear equations for the rates
    matrix = np.array(
        [[-b * np.sin(theta), c * np.sin(gamma)], [b * np.cos(theta), -c * np.cos(gamma)]]
    )
    first = np.linalg.solve(matrix, a * np.array([np.sin(alpha), -np.cos(alpha)]))
    bend = a * np.array([np.cos(alpha), np.sin(alpha)])
    bend += b * first[0] ** 2 * np.array([np.cos(theta), np.sin(theta)])
    bend -= c * first[1] ** 2 * np.array([np.cos(gamma), np.sin(gamma)])
    second = np.linalg.solve(matrix, bend)
    (t_1, g_1), (t_2, g_2) = first, second
    cx_1 = -a * np.sin(alpha) - b / 2 * np.sin(theta) * t_1
    cy_1 = a * np.cos(alpha) + b / 2 * np.cos(theta) * t_1
    cx_2 = -a * np.cos(alpha) - b / 2 * (np.cos(theta) * t_1**2 + np.sin(theta) * t_2)
    cy_2 = -a * np.sin(alpha) + b / 2 * (np.cos(theta) * t_2 - np.sin(theta) * t_1**2)
    parts = [
        (J_1 + m_1 * a**2 / 4, 1.0, 0.0),
        (m_2, cx_1, cx_2),
        (m_2, cy_1, cy_2),
        (J_2, t_1, t_2),
        (J_3 + m_3 * c**2 / 4, g_1, g_2),
    ]
    heights = [
        (m_1, a / 2 * np.sin(alpha), a / 2 * np.cos(alpha)),
        (m_2, pin[1] + b / 2 * np.sin(theta), cy_1),
        (m_3, c / 2 * np.sin(gamma), c / 2 * np.cos(gamma) * g_1),
    ]
    return _reduced(
        np.array([alpha, theta - alpha, gamma]),
        np.array([1.0, t_1 - 1.0, g_1]),
        np.array([0.0, t_2, g_2]),
        parts,
        heights,
        None,
    )


MECHANISMS: dict[str, Callable[[float], Reduced]] = {
    "slider_crank": slider_crank,
    "four_bar": four_bar,
}
