"""Translating roller follower: the roller centre slides on a straight guide beside the cam axis."""

from __future__ import annotations

import cmath
import math
from dataclasses import dataclass

import numpy as np

from camgeo.errors import GeometryError
from camgeo.mechanism.follower import RelativeJet
from camgeo.motion.motion import Jet
from camgeo.numeric.arrays import FloatArray


@dataclass(frozen=True, slots=True)
class TranslatingRoller:
    """Translating roller follower (Wirsig eqs. 2.56 to 2.63, sign of e corrected).

    With the guide upwards (`guide_angle` pi/2) the guide line is x = e and the follower lies above
    the cam axis: W = e + i (s_G + kappa_F s), s_G = sqrt(r_G^2 - e^2). Other guide angles turn
    this about the cam axis.

    Attributes
    ----------
    base_radius : r_G, cam axis to roller centre at cam angle 0 [mm].
    roller_radius : r_R [mm].
    offset : e [mm], positive to the right of the cam axis when looking along the guide; |e| <= r_G.
    guide_angle : direction of the guide away from the cam, from the x axis [rad].
    direction : kappa_F, +1 if a positive lift moves the roller outward (F-cam), -1 inward (P-cam).

    Raises
    ------
    GeometryError
        With key "offset", if the offset exceeds the base radius.
    """

    base_radius: float
    roller_radius: float
    offset: float = 0.0
    guide_angle: float = math.pi / 2.0
    direction: int = 1

    def __post_init__(self) -> None:
        if abs(self.offset) > self.base_radius:
            raise GeometryError(
                "the roller cannot lie on the base circle: the offset must not exceed"
                f" the base radius, {self.base_radius:g} mm",
                key="follower.offset",
                value=f"{self.offset:g}",
            )

    @property
    def start_height(self) -> float:
        """s_G, height of the roller centre over the cam axis at cam angle 0 [mm]."""
        return math.sqrt((self.base_radius - self.offset) * (self.base_radius + self.offset))

    def relative_jet(self, jet: Jet, rotation: int) -> RelativeJet:
        """See `Follower.relative_jet`."""
        turn = self._turn
        e = self.offset
        y = self.start_height + self.direction * jet[0]
        y1, y2, y3 = self.direction * jet[1], self.direction * jet[2], self.direction * jet[3]
        v = rotation * y1 - e
        return RelativeJet(
            r0=turn * (e + 1j * y),
            r1=turn * (rotation * y + 1j * (y1 - rotation * e)),
            r2=turn * ((2.0 * rotation * y1 - e) + 1j * (y2 - y)),
            r3=turn * (rotation * (3.0 * y2 - y) + 1j * (y3 - 3.0 * y1 + rotation * e)),
            u=y,
            v=v,
            u1=y1,
            v1=rotation * y2,
        )

    @property
    def _turn(self) -> complex:
        """From the frame with the guide upwards to the real one."""
        if self.guide_angle == math.pi / 2.0:
            return 1.0 + 0.0j
        return cmath.exp(1j * (self.guide_angle - math.pi / 2.0))

    def speed_bounds(self, jet: Jet, bounds: Jet) -> FloatArray:
        """See `Follower.speed_bounds`."""
        height = np.abs(self.start_height + self.direction * jet[0]) + bounds[0]
        radius = np.hypot(self.offset, height)
        return np.stack(
            (
                bounds[1] + radius,
                bounds[2] + 2.0 * bounds[1] + radius,
                bounds[3] + 3.0 * (bounds[2] + bounds[1]) + radius,
            )
        )
