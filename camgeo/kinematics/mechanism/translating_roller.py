"""Translating roller follower: the roller centre moves along a straight guide."""

from __future__ import annotations

import cmath
import math
from dataclasses import dataclass
from typing import ClassVar, Literal

import numpy as np

from camgeo.errors import GeometryError
from camgeo.kinematics.mechanism.follower import (
    Guided,
    RelativeJet,
    TangentJet,
    WithRoller,
)
from camgeo.kinematics.mechanism.sketch import Dimension, MechanismSketch, Places
from camgeo.kinematics.mechanism.values import Angle, Coordinate, Length, Radius, Sense
from camgeo.kinematics.motion import FULL_ORDER, Jet
from camgeo.numeric.arrays import ComplexArray, FloatArray
from camgeo.numeric.checked import check_fields


@dataclass(frozen=True, slots=True)
class TranslatingRoller(Guided, WithRoller):
    """Translating roller follower (Wirsig eqs. 2.56 to 2.63, sign of e corrected).

    With the guide upright (`guide_angle` pi/2) the guide line is x = e and the follower lies above
    the cam axis: W = e + i (s_G + kappa_F s), s_G = sqrt(r_G^2 - e^2). Other guide angles turn
    this about the cam axis.

    Attributes
    ----------
    base_radius : r_G, cam axis to roller centre at cam angle 0 [mm].
    roller_radius : r_R [mm].
    offset : e [mm], positive to the right of the cam axis when looking along the guide; |e| <= r_G.
    guide_angle : direction of the guide away from the cam, from the x axis [rad], -2 pi to 2 pi.
    direction : kappa_F, +1 if a positive lift moves the roller outward (F-cam), -1 inward (P-cam).

    Raises
    ------
    GeometryError
        With the key, if a value is invalid, or the offset exceeds the base radius.
    """

    kind: ClassVar = "translating-roller"

    base_radius: Length
    roller_radius: Radius
    offset: Coordinate = 0.0
    guide_angle: Angle = math.pi / 2.0
    direction: Sense = 1

    def __post_init__(self) -> None:
        check_fields(self, "follower.")
        if abs(self.offset) > self.base_radius:
            raise GeometryError(
                "the roller cannot lie on the base circle: the offset must not exceed"
                f" the base radius, {self.base_radius:g} mm",
                key="follower.offset",
                value=f"{self.offset:g}",
            )

    @property
    def start_arm(self) -> complex:
        """See `Follower`."""
        return complex(self.offset, self.start_height) * cmath.rect(
            1.0, self.guide_angle - 0.5 * math.pi
        )

    @property
    def start_height(self) -> float:
        """s_G, height of the roller centre over the cam axis at cam angle 0 [mm]."""
        return math.sqrt((self.base_radius - self.offset) * (self.base_radius + self.offset))

    def relative_jet(self, jet: Jet, rotation: int, order: int = FULL_ORDER) -> RelativeJet:
        """See `Follower.relative_jet`."""
        e, sense = self.offset, float(rotation * self.direction)
        along, across = np.empty((2, order + 1, jet.shape[1]))
        height, v = across[0], across[1]  # R_1 = sigma (u + i v), u the height
        np.multiply(jet[0], float(self.direction), out=height)
        height += self.start_height
        along[0] = e
        np.multiply(height, float(rotation), out=along[1])
        np.multiply(jet[1], float(self.direction), out=v)
        v -= rotation * e
        if order > 1:
            np.multiply(jet[1], 2.0 * sense, out=along[2])
            along[2] -= e
            np.multiply(jet[2], float(self.direction), out=across[2])
            across[2] -= height
        if order > 2:
            np.multiply(jet[2], 3.0 * sense, out=along[3])
            along[3] -= along[1]
            np.multiply(jet[1], -3.0 * self.direction, out=across[3])
            across[3] += self.direction * jet[3]
            across[3] += rotation * e
        axis = self.guide_angle - math.pi / 2.0
        return RelativeJet(along, across, axis, height, v, 0.0, self.reach)

    def tangent_jet(self, jet: Jet, rotation: int) -> TangentJet:
        """See `Follower.tangent_jet`."""
        u = self.direction * jet[:2]
        u[0] += self.start_height
        w = (rotation * self.direction) * jet[1:3]
        w[0] -= self.offset
        swerve = u[0] * (self.direction * (jet[1] + jet[3]))
        return TangentJet(u, w, np.zeros_like(swerve), swerve)

    def speed_bounds(self, jet: Jet, bounds: Jet, half: FloatArray, rotation: int) -> FloatArray:
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

    def on_one_side(self, lifts: FloatArray) -> bool:
        """See `Follower.on_one_side`."""
        return bool(np.all(self.start_height + self.direction * lifts > 0.0))

    def sketch(
        self, lifts: FloatArray, farthest: float, _: tuple[float, float]
    ) -> MechanismSketch[Places]:
        """See `Follower.sketch`."""
        here = self.traced(lifts)
        sizes: list[Dimension[Places]] = [Dimension("base_radius", 0j, self.traced_point(0.0))]
        if self.offset != 0.0:
            aside = -1j * self.outward * self.offset
            sizes.append(Dimension("offset", 0j, aside, negative=self.offset < 0.0))
        roller = MechanismSketch(
            rollers=((here, self.roller_radius),),
            dimensions=(*sizes, *self.roller_size(here, -1j * self.outward)),
        )
        return self.rod(lifts, farthest) + roller

    def held(self, _: tuple[float, float]) -> tuple[Literal["guide"], complex, None]:
        """See `Follower.held`."""
        height = self.start_height + 2.0 * self.base_radius
        return "guide", -1j * self.outward * self.offset + self.outward * height, None

    def far_side(
        self, lifts: FloatArray, _: tuple[float, float], breadth: float
    ) -> MechanismSketch[Places]:
        """See `Follower.far_side`."""
        there, joined = self.across(lifts, breadth)
        return joined + MechanismSketch(rollers=((there, self.roller_radius),))

    def return_sketch(
        self, first: ComplexArray, lifts: FloatArray, reach: float
    ) -> MechanismSketch[Places]:
        """See `Follower.return_sketch`: joined by a bracket."""
        here = self.traced(lifts)
        along = self.outward * ((here - first) * self.outward.conjugate()).real
        sizes = [Dimension("spacing", first, first + along)]
        return MechanismSketch(
            links=(self.bracket(first, here, reach),),
            rollers=((here, self.roller_radius),),
            dimensions=(*sizes, *self.roller_size(here, -1j * self.outward)),
        )
