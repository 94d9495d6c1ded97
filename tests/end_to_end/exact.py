"""Areas, lengths and dense points of the exact flanks, by none of the fitting code.

Everything comes from the pitch curve's derivatives by textbook formulas: Gauss-Legendre over each
smooth piece, Green's theorem for the area.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from camgeo.design import Design
from camgeo.numeric.arrays import ComplexArray, FloatArray
from camgeo.part.spec import Keyway, PartSpec

NODES = 200
"""Gauss points a smooth piece: the laws are analytic inside a piece, so sums agree to rounding."""

TURN = 2.0 * math.pi


@dataclass(frozen=True)
class Flank:
    """The parallel of a design's pitch curve at `distance` [mm], outwards positive."""

    design: Design
    distance: float

    def points(self, phi: FloatArray) -> ComplexArray:
        """(n,) [mm] at the cam angles `phi` (n,) [rad]."""
        z, z1 = self.design.pitch_curve.jet(phi)[:2]
        point: ComplexArray = z + self.distance * self._normal(z1)
        return point

    def _normal(self, z1: ComplexArray) -> ComplexArray:
        return 1j * self.design.rotation * z1 / np.abs(z1)

    def _rates(self, phi: FloatArray) -> tuple[ComplexArray, ComplexArray]:
        """Points and their derivative by the cam angle."""
        z, z1, z2 = self.design.pitch_curve.jet(phi)[:3]
        pace = np.abs(z1)
        # d/dphi of z1/|z1| is i z1 Im(conj(z1) z2)/|z1|^3.
        turning = (np.conj(z1) * z2).imag / pace**3
        rate = z1 + self.distance * (1j * self.design.rotation) * 1j * z1 * turning
        return z + self.distance * self._normal(z1), rate

    def _integral_nodes(self) -> tuple[FloatArray, FloatArray]:
        nodes, weights = np.polynomial.legendre.leggauss(NODES)
        borders = np.append(np.unique(np.append(self.design.motion.borders, 0.0)), TURN)
        middle, half = 0.5 * (borders[1:] + borders[:-1]), 0.5 * np.diff(borders)
        phi = middle[:, None] + half[:, None] * nodes
        return phi.ravel(), (half[:, None] * weights).ravel()

    @property
    def area(self) -> float:
        """Enclosed area [mm^2], by Green's theorem."""
        phi, weights = self._integral_nodes()
        points, rates = self._rates(phi)
        return abs(0.5 * float(np.sum(weights * (np.conj(points) * rates).imag)))

    @property
    def length(self) -> float:
        """Length [mm]."""
        phi, weights = self._integral_nodes()
        return float(np.sum(weights * np.abs(self._rates(phi)[1])))


def bore_area(spec: PartSpec) -> float:
    """Area [mm^2] of the bore with its keyway: the circle and the slot beyond it."""
    if spec.bore is None:
        return 0.0
    radius = spec.bore / 2.0
    return math.pi * radius**2 + (_slot(radius, spec.keyway) if spec.keyway else 0.0)


def _slot(radius: float, keyway: Keyway) -> float:
    """The slot up to its bottom, less the part of the circle between its sides."""
    half = keyway.width / 2.0
    reach = math.sqrt(radius**2 - half**2)
    under_arc = half * reach + radius**2 * math.asin(half / radius)
    return keyway.width * (radius + keyway.depth) - under_arc


def bore_length(spec: PartSpec) -> float:
    """Length [mm] of the bore's outline, keyway included."""
    if spec.bore is None:
        return 0.0
    radius = spec.bore / 2.0
    if spec.keyway is None:
        return TURN * radius
    half, depth = spec.keyway.width / 2.0, spec.keyway.depth
    sides = 2.0 * (radius + depth - math.sqrt(radius**2 - half**2))
    return radius * (TURN - 2.0 * math.asin(half / radius)) + sides + spec.keyway.width
