"""Areas, lengths and dense points of the exact flanks, without any of the fitting code.

Everything comes from the pitch curve's derivatives by textbook formulas: Gauss-Legendre over each
smooth piece, Green's theorem for the area. What is left of a flank that undercuts is found by
`tests.end_to_end.trimmed`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from camgeo.design.design import Design
from camgeo.numeric.arrays import ComplexArray, FloatArray

NODES = 200
"""Gauss points a smooth piece: the laws are analytic inside a piece, so sums agree to rounding."""

TURN = 2.0 * math.pi

POINT = 1e-9
"""An arc of a smaller radius [mm] is a corner."""


@dataclass(frozen=True)
class Kept:
    """What is left of a flank.

    Attributes
    ----------
    stretches : ranges (start, end) of cam angle [rad] in the order of the outline, end > start.
    hinges : between each stretch and the next the point [mm] about which a parallel turns: a
        corner of the outline, or where the velocity jumps the roller's centre. None for a flank
        that is whole.
    """

    stretches: tuple[tuple[float, float], ...] = ((0.0, TURN),)
    hinges: tuple[complex, ...] = ()


WHOLE = Kept()


@dataclass(frozen=True)
class Flank:
    """The parallel of a design's pitch curve at `distance` [mm], outwards positive."""

    design: Design
    distance: float
    kept: Kept = WHOLE

    def points(self, phi: FloatArray, *, left: bool = False) -> ComplexArray:
        """(n,) [mm] at the cam angles `phi` (n,) [rad]."""
        z, z1 = self.design.cam.disc.pitch_curve.jet(phi, "left" if left else "right")[:2]
        point: ComplexArray = z + self.distance * self._normal(z1)
        return point

    def dense(self, count: int) -> ComplexArray:
        """About `count` points in order, evenly over the cam angle; each corner exactly once."""
        whole = sum(end - start for start, end in self.kept.stretches)
        parts = []
        for k, (start, end) in enumerate(self.kept.stretches):
            phi = np.linspace(start, end, max(2, math.ceil(count * (end - start) / whole)))
            parts.append(self.points(phi[:-1]))
            if self.kept.hinges:
                hinge, first, sweep = self.turns[k]
                shares = np.linspace(0.0, 1.0, max(2, math.ceil(count * abs(sweep) / whole)))
                turned = hinge + first * np.exp(1j * sweep * shares)
                parts.append(turned[:-1] if abs(first) > POINT else turned[:1])
        return np.concatenate(parts)

    @cached_property
    def turns(self) -> tuple[tuple[complex, complex, float], ...]:
        """The turns between the stretches: hinge, first arm [mm], angle turned [rad]."""
        found = []
        stretches = self.kept.stretches
        for k, hinge in enumerate(self.kept.hinges):
            _, end = stretches[k]
            start, _ = stretches[(k + 1) % len(stretches)]
            first = complex(self.points(np.array([end]), left=True)[0]) - hinge
            last = complex(self.points(np.array([start]))[0]) - hinge
            sweep = float(np.angle(last / first)) if abs(first) > POINT else 0.0
            found.append((hinge, first, sweep))
        return tuple(found)

    @property
    def corners(self) -> ComplexArray:
        """(k,) [mm] where the stretches meet in a corner."""
        return np.array([h for h, first, _ in self.turns if abs(first) <= POINT], np.complex128)

    def _normal(self, z1: ComplexArray) -> ComplexArray:
        return 1j * self.design.cam.rotation * z1 / np.abs(z1)

    def rates(self, phi: FloatArray) -> tuple[ComplexArray, ComplexArray]:
        """Points and their derivative by the cam angle."""
        z, z1, z2 = self.design.cam.disc.pitch_curve.jet(phi)[:3]
        pace = np.abs(z1)
        # d/dphi of z1/|z1| is i z1 Im(conj(z1) z2)/|z1|^3.
        turning = (np.conj(z1) * z2).imag / pace**3
        rate = z1 + self.distance * (1j * self.design.cam.rotation) * 1j * z1 * turning
        return z + self.distance * self._normal(z1), rate

    def _integral_nodes(self) -> tuple[FloatArray, FloatArray]:
        nodes, weights = np.polynomial.legendre.leggauss(NODES)
        borders = np.unique(np.append(self.design.cam.drive.motion.borders, 0.0))
        borders = np.concatenate((borders, borders + TURN))
        found = []
        for start, end in self.kept.stretches:
            inside = borders[(borders > start) & (borders < end)]
            marks = np.concatenate(([start], inside, [end]))
            middle, half = 0.5 * (marks[1:] + marks[:-1]), 0.5 * np.diff(marks)
            phi = middle[:, None] + half[:, None] * nodes
            found.append((phi.ravel(), (half[:, None] * weights).ravel()))
        return np.concatenate([phi for phi, _ in found]), np.concatenate([w for _, w in found])

    @cached_property
    def area(self) -> float:
        """Enclosed area [mm^2], by Green's theorem."""
        phi, weights = self._integral_nodes()
        points, rates = self.rates(phi)
        twice = float(np.sum(weights * (np.conj(points) * rates).imag))
        for hinge, first, sweep in self.turns:
            chord = first * (np.exp(1j * sweep) - 1.0)
            twice += abs(first) ** 2 * sweep + float((np.conj(hinge) * chord).imag)
        return abs(0.5 * twice)

    @cached_property
    def length(self) -> float:
        """Length [mm]."""
        phi, weights = self._integral_nodes()
        arcs = sum(abs(first) * abs(sweep) for _, first, sweep in self.turns)
        return float(np.sum(weights * np.abs(self.rates(phi)[1]))) + arcs


def half_width(design: Design) -> float:
    """Distance of the flanks from the pitch curve [mm]: half of roller and play together."""
    diameter = 2.0 * design.cam.follower.roller_radius
    return (diameter + design.scene.side_clearance) / 2.0
