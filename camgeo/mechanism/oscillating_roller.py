"""Oscillating roller follower: a rocker carries the roller about a fixed pivot."""

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
class OscillatingRoller:
    """Oscillating roller follower (Wirsig eqs. 2.43 to 2.52).

    The rocker's angle chi is counted counter-clockwise from the line pivot -> cam axis:
    chi = h psi_G + (its swing), h = `arm_side`, with psi_G in (0, pi) from the triangle of l_1
    (pivot to cam axis), l_3 (`arm`) and r_G; W = exp(i alpha) (l_3 exp(i chi) - l_1), alpha the
    direction of that line.

    Attributes
    ----------
    pivot : B_0 seen from the cam axis, complex [mm].
    arm : l_3, pivot to roller centre [mm].
    base_radius : r_G, cam axis to roller centre at cam angle 0 [mm].
    roller_radius : r_R [mm].
    arm_side : h, +1 if the arm lies counter-clockwise of the line pivot -> cam axis, -1 clockwise.
    direction : +1 if a positive lift [rad] moves the roller outward (F-cam), -1 inward (P-cam);
        None if the lift is the rocker's own angle, counter-clockwise positive, as a linkage gives.

    Raises
    ------
    GeometryError
        With key "follower.base_radius", if the triangle cannot close, or closes only stretched out.
    """

    pivot: complex
    arm: float
    base_radius: float
    roller_radius: float
    arm_side: int = 1
    direction: int | None = 1

    def __post_init__(self) -> None:
        low, high = abs(self.centre_distance - self.arm), self.centre_distance + self.arm
        if not low < self.base_radius < high:
            raise GeometryError(
                f"pivot, cam axis and roller form no triangle: with the pivot"
                f" {self.centre_distance:.6g} mm from the cam axis and an arm of {self.arm:.6g} mm"
                f" it must lie between {low:.6g} and {high:.6g} mm",
                key="follower.base_radius",
                value=f"{self.base_radius:g}",
            )

    @property
    def centre_distance(self) -> float:
        """l_1, cam axis to pivot [mm]."""
        return abs(self.pivot)

    @property
    def start_angle(self) -> float:
        """psi_G, angle between arm and the line pivot -> cam axis at cam angle 0 [rad], (0, pi)."""
        l1, l3, base = self.centre_distance, self.arm, self.base_radius
        return 2.0 * math.atan2(
            math.sqrt((base - (l1 - l3)) * (base + (l1 - l3))),
            math.sqrt((l1 + l3 - base) * (l1 + l3 + base)),
        )

    @property
    def swing_sense(self) -> int:
        """Sense in which a positive lift turns the rocker: +1 counter-clockwise, -1 clockwise."""
        return 1 if self.direction is None else self.direction * self.arm_side

    def rocker_angle(self, lift: FloatArray) -> FloatArray:
        """psi_t (n,), angle from the line pivot -> cam axis to the arm, on the arm's own side."""
        return self.start_angle + self.arm_side * self.swing_sense * lift

    def relative_jet(self, jet: Jet, rotation: int) -> RelativeJet:
        """See `Follower.relative_jet`."""
        l1, l3 = self.centre_distance, self.arm
        alpha = cmath.phase(-self.pivot)
        chi = self.arm_side * self.start_angle + self.swing_sense * jet[0]
        cosine, sine = np.cos(chi), np.sin(chi)
        chi1, chi2, chi3 = (self.swing_sense * jet[k] for k in (1, 2, 3))
        turn = cmath.exp(1j * alpha)
        tip = turn * l3 * (cosine + 1j * sine)
        axis = turn * l1
        omega = chi1 - rotation  # of the rocker relative to the cam, per unit cam speed
        square = omega * omega
        return RelativeJet(
            r0=tip - axis,
            r1=tip * (1j * omega) + 1j * rotation * axis,
            r2=tip * (-square + 1j * chi2) + axis,
            r3=tip * (-3.0 * omega * chi2 + 1j * (chi3 - square * omega)) - 1j * rotation * axis,
            u=l1 * sine,
            v=-rotation * l3 * omega - l1 * cosine,
            u1=l1 * cosine * chi1,
            v1=-rotation * l3 * chi2 + l1 * sine * chi1,
        )

    def speed_bounds(self, jet: Jet, bounds: Jet) -> FloatArray:
        """See `Follower.speed_bounds`."""
        l1, l3 = self.centre_distance, self.arm
        omega = 1.0 + bounds[1]
        return np.stack(
            (
                l3 * omega + l1,
                l3 * (omega**2 + bounds[2]) + l1,
                l3 * (omega**3 + 3.0 * omega * bounds[2] + bounds[3]) + l1,
            )
        )
