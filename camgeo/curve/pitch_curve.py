"""Pitch curve: the path of the roller centre in the turning cam, Z(phi)."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from camgeo.curve.blocks import in_blocks
from camgeo.errors import GeometryError
from camgeo.mechanism.follower import Follower, RelativeJet
from camgeo.motion.motion import Dwell, Motion, Side
from camgeo.motion.plan import in_turn
from camgeo.numeric.arrays import ComplexArray, FloatArray

STANDSTILL = 1e-13
"""|Z'| below this share of the largest length in it is a zero: its digits are rounding."""


@dataclass(frozen=True, slots=True)
class PitchCurve:
    """Pitch curve in cam coordinates: origin in the cam axis, axes fixed in the cam that coincide
    with the frame's axes at cam angle 0 (Wirsig eqs. 2.44 to 2.52).

    Attributes
    ----------
    motion : the lift as the follower makes it.
    follower : from lift to roller centre.
    rotation : sigma, +1 if the cam turns counter-clockwise, -1 clockwise. The curve itself is run
        through the other way, clockwise for sigma = +1.
    """

    motion: Motion
    follower: Follower
    rotation: int

    @property
    def breaks(self) -> FloatArray:
        """(m,) cam angles [rad] where a derivative up to Z''' may jump."""
        return self.motion.breaks

    @property
    def borders(self) -> FloatArray:
        """(k,) cam angles [rad] where the formula changes."""
        return self.motion.borders

    @property
    def dwells(self) -> tuple[Dwell, ...]:
        """Rests: the curve is a circle about the cam axis there."""
        return self.motion.dwells

    def relative_jet(self, phi: FloatArray, side: Side = "right") -> RelativeJet:
        """R_0 to R_3, u, v at the cam angles `phi` (n,) [rad], see `camgeo.mechanism.follower`."""
        return self.follower.relative_jet(self.motion.jet(phi, side), self.rotation)

    def jet(self, phi: FloatArray, side: Side = "right") -> ComplexArray:
        """(4, n) complex [mm/rad^k]: Z, Z', Z'', Z''' at the cam angles `phi` (n,) [rad]."""

        def block(angles: FloatArray) -> ComplexArray:
            relative = self.relative_jet(angles, side)
            turn = self.turn(angles)
            return np.stack(
                (relative.r0 * turn, relative.r1 * turn, relative.r2 * turn, relative.r3 * turn)
            )

        return in_blocks(block, np.atleast_1d(phi))

    def point(self, phi: FloatArray) -> ComplexArray:
        """(n,) complex [mm]: Z at the cam angles `phi` (n,) [rad]."""
        return in_blocks(lambda a: self.relative_jet(a).r0 * self.turn(a), np.atleast_1d(phi))

    def turn(self, phi: FloatArray) -> ComplexArray:
        """(n,) exp(-i sigma phi), from axes that do not turn to those of the cam."""
        return np.cos(phi) - 1j * (self.rotation * np.sin(phi))

    def curvature(self, phi: FloatArray, side: Side = "right") -> FloatArray:
        """(n,) [1/mm] signed curvature, positive where the curve is convex; an inflection is 0.

        kappa = -sigma Im(conj(Z') Z'') / |Z'|^3 (Wirsig eq. 3.35, sign added).

        Raises
        ------
        GeometryError
            Where the roller centre stands still in the cam, Z' = 0: a cusp of the pitch curve.
        """
        return in_blocks(
            lambda a: curvature(self.relative_jet(a, side), self.rotation), np.atleast_1d(phi)
        )

    def transmission_angle(self, phi: FloatArray, side: Side = "right") -> FloatArray:
        """(n,) [rad] in [0, pi/2]: acute angle between rocker, or guide normal, and curve normal.

        mu = atan2(|u|, |v|) (Wirsig section 3.3.4, corrected). Raises GeometryError where Z' = 0:
        there is no normal.
        """
        return self._angle(phi, side, pressure=False)

    def pressure_angle(self, phi: FloatArray, side: Side = "right") -> FloatArray:
        """(n,) [rad] in [0, pi/2]: pi/2 - mu, to its own last digits where it is tiny."""
        return self._angle(phi, side, pressure=True)

    def _angle(self, phi: FloatArray, side: Side, *, pressure: bool) -> FloatArray:
        def block(angles: FloatArray) -> FloatArray:
            relative = self.relative_jet(angles, side)
            speed(relative)
            u, v = np.abs(relative.u), np.abs(relative.v)
            return np.arctan2(v, u) if pressure else np.arctan2(u, v)

        return in_blocks(block, np.atleast_1d(phi))

    def speed_bounds(self, low: FloatArray, high: FloatArray) -> FloatArray:
        """(3, n) upper bounds of |Z'|, |Z''|, |Z'''| over cells [low, high] (n,) [rad]."""
        middle = self.motion.jet(0.5 * (low + high))
        return self.follower.speed_bounds(middle, self.motion.jet_bounds(low, high))

    def place(self, phi: float) -> float:
        """`phi` [rad] reduced to [0, 2 pi)."""
        return float(in_turn(np.array([phi]))[0])


def speed(relative: RelativeJet) -> FloatArray:
    """|Z'| (n,) [mm/rad], never zero.

    Raises
    ------
    GeometryError
        Where the roller centre stands still in the cam: the rocker lies on the line of centres and
        l_3 (1 - sigma psi') = l_1 (hard case HC18).
    """
    size = np.hypot(relative.u, relative.v)
    scale = np.abs(relative.r0) + np.abs(relative.r2)
    if np.any(size <= STANDSTILL * scale):
        raise GeometryError(
            "the roller centre stands still in the turning cam (Z' = 0): the pitch curve has a cusp"
            " and no normal there; the rocker lies on the line of centres and"
            " l_3 (1 - sigma psi') = l_1"
        )
    return size


def curvature(relative: RelativeJet, rotation: int) -> FloatArray:
    """kappa (n,) [1/mm] from R_1 and R_2, see `PitchCurve.curvature`."""
    r1, r2 = relative.r1, relative.r2
    size = speed(relative)
    cross = r1.real * r2.imag - r1.imag * r2.real
    return -rotation * cross / (size * size * size)


def curvature_slope(relative: RelativeJet, rotation: int) -> FloatArray:
    """dkappa/dphi (n,) [1/(mm rad)], by the chain rule from R_1 to R_3."""
    r1, r2, r3 = relative.r1, relative.r2, relative.r3
    square = speed(relative) ** 2
    cross = r1.real * r2.imag - r1.imag * r2.real
    # conj(Z') Z'' and conj(Z') Z''' do not see the rotation, so R_k stand for Z^(k).
    cross_slope = r1.real * r3.imag - r1.imag * r3.real
    dot = r1.real * r2.real + r1.imag * r2.imag
    return -rotation * (cross_slope - 3.0 * cross * dot / square) / (square * np.sqrt(square))


def degrees(phi: float) -> str:
    """A cam angle [rad] in degrees for a message."""
    return f"{math.degrees(phi):.10g}"
