"""Translating flat-faced follower: a flat face square to a straight guide."""

from __future__ import annotations

import cmath
import math
from dataclasses import dataclass
from typing import ClassVar, Literal

import numpy as np

from camgeo.kinematics.mechanism.face import (
    HIGHEST,
    FaceEnds,
    FlatFollower,
    Touch,
    face_line,
    spread,
)
from camgeo.kinematics.mechanism.follower import Guided, RelativeJet, TangentJet
from camgeo.kinematics.mechanism.sketch import Dimension, MechanismSketch, Places
from camgeo.kinematics.mechanism.values import Angle, Length, Sense
from camgeo.kinematics.motion import FULL_ORDER, Jet
from camgeo.numeric.arrays import ComplexArray, FloatArray
from camgeo.numeric.checked import CheckedFields


@dataclass(frozen=True, slots=True)
class TranslatingFlat(Guided, FlatFollower, CheckedFields, path="follower."):
    """Translating follower whose face is square to the guide.

    With nu = `guide_angle` and h = r_G + kappa_F s in `camgeo.kinematics.mechanism.face` the turn
    is 1, and

        Z = (h - i sigma h') exp(i theta), rho = h + h''.

    The contact lies h' sigma to the right of the foot of the cam axis, looking along the guide
    outward: a cam that turns counter-clockwise lifts the follower with its right-hand side. Where
    the guide itself lies affects the moments in the guide, but not the cam.

    Attributes
    ----------
    base_radius : r_G, cam axis to face at cam angle 0 [mm].
    guide_angle : direction of the guide away from the cam, from the x axis [rad], -2 pi to 2 pi.
    direction : kappa_F, +1 if a positive lift moves the face outward (F-cam), -1 inward (P-cam).
    face : where the face begins and ends [mm], along the face from the foot of the cam axis on it,
        positive to the right when looking along the guide; None if it is as long as needed.

    Raises
    ------
    GeometryError
        With the key of an invalid value.
    """

    kind: ClassVar = "translating-flat"
    origin: ClassVar = "cam axis"
    least_place: ClassVar = -math.inf  # it moves on its guide wherever it is pushed
    raised_by: ClassVar = ("follower.base_radius",)
    facing: ClassVar = 1
    harmonic_is_round: ClassVar = True

    base_radius: Length
    guide_angle: Angle = math.pi / 2.0
    direction: Sense = 1
    face: FaceEnds | None = None

    @property
    def start_arm(self) -> complex:
        """See `Follower`."""
        return 1j * self.base_radius * cmath.rect(1.0, self.guide_angle - 0.5 * math.pi)

    def _distance(self, jet: Jet) -> Jet:
        """h and as many of its derivatives as the lift has."""
        distance = self.direction * jet
        distance[0] += self.base_radius
        return distance

    def normal(self, lift: FloatArray) -> ComplexArray:
        """See `FlatFollower.normal`."""
        return np.full(len(lift), self.outward, dtype=np.complex128)

    def touch(self, jet: Jet, rotation: int) -> Touch:
        """See `FlatFollower.touch`."""
        h = self._distance(jet)
        turn = np.stack((np.ones_like(h[0]), np.zeros_like(h[0])))
        return Touch(h[0], rotation * h[1:3], turn, h[:2] + h[2:4])

    def relative_jet(self, jet: Jet, rotation: int, order: int = FULL_ORDER) -> RelativeJet:
        """See `Follower.relative_jet`. The first axis points to the right of the guide."""
        order = min(order, HIGHEST)
        h = self._distance(jet[: order + 2])
        along, across = np.zeros((2, order + 1, jet.shape[1]))
        pace = h[0] + h[2]
        np.multiply(h[1], float(rotation), out=along[0])
        across[0] = h[0]
        np.multiply(pace, float(rotation), out=along[1])
        if order > 1:
            np.add(h[1], h[3], out=along[2])
            along[2] *= rotation
            np.negative(pace, out=across[2])
        axis = self.guide_angle - math.pi / 2.0
        return RelativeJet(along, across, axis, pace, np.zeros_like(pace), 0.0, self.reach)

    def tangent_jet(self, jet: Jet, rotation: int) -> TangentJet:
        """See `Follower.tangent_jet`: Z' lies along the face, w = 0."""
        h = self._distance(jet)
        u = h[:2] + h[2:4]
        none = np.zeros_like(u)
        return TangentJet(u, none, none[0], u[0] * u[1])

    def speed_bounds(self, jet: Jet, bounds: Jet, half: FloatArray, rotation: int) -> FloatArray:
        """See `Follower.speed_bounds`.

        Z'' = (sigma (h' + h''') - i (h + h'')) exp(i (axis - sigma phi)): with h''' fixed at
        its value in the middle the rate is at most |h| + 2 (|h'| + |h''| + |h'''|), and h'''
        changes by no more than the sum of that value and its bound.
        """
        height = np.abs(self.base_radius + self.direction * jet[0]) + bounds[0]
        rest = bounds[1] + bounds[2] + bounds[3]
        change = np.abs(jet[3]) + bounds[3]
        return np.stack(
            (height + bounds[2], height + rest, height + 2.0 * rest + spread(change, half))
        )

    def sliding(self, jet: Jet, rotation: int) -> FloatArray:
        """See `Follower.sliding`: g = h; that the contact wanders is no sliding."""
        return self.touch(jet, rotation).distance

    def _face(self, lifts: FloatArray) -> tuple[ComplexArray, ComplexArray]:
        """The foot of the cam axis on the face (n,) [mm], and the direction in which places count,
        at lifts (n,).
        """
        foot = self.traced(lifts)  # in a dwell the contact lies there
        return foot, -1j * foot / np.abs(foot)

    def sketch(
        self, lifts: FloatArray, farthest: float, ends: tuple[float, float]
    ) -> MechanismSketch[Places]:
        """See `Follower.sketch`."""
        return self.rod(lifts, farthest) + MechanismSketch(
            faces=(face_line(*self._face(lifts), ends),),
            dimensions=(Dimension("base_radius", 0j, self.base_radius * self.outward),),
        )

    def held(
        self, ends: tuple[float, float]
    ) -> tuple[Literal["guide"], complex, tuple[complex, complex]]:
        """See `Follower.held`."""
        start, stop = face_line(*self._face(np.zeros(1)), ends)
        return "guide", 2.0 * self.base_radius * self.outward, (complex(start[0]), complex(stop[0]))

    def far_side(
        self, lifts: FloatArray, ends: tuple[float, float], breadth: float
    ) -> MechanismSketch[Places]:
        """See `Follower.far_side`: the same face, half a turn on."""
        _, along = self._face(lifts)
        there, joined = self.across(lifts, breadth)
        return joined + MechanismSketch(faces=(face_line(there, -along, ends),))
