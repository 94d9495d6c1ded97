"""Oscillating flat-faced follower: a flat face on a rocker with a fixed pivot."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar, Literal

import numpy as np

from camgeo.errors import GeometryError
from camgeo.kinematics.mechanism.face import (
    HIGHEST,
    FaceEnds,
    FlatFollower,
    Touch,
    face_line,
    spread,
)
from camgeo.kinematics.mechanism.follower import RelativeJet, Rocking, TangentJet
from camgeo.kinematics.mechanism.sketch import Dimension, MechanismSketch, Places
from camgeo.kinematics.mechanism.values import Coordinate, Length, Place, Sense
from camgeo.kinematics.motion import FULL_ORDER, Jet
from camgeo.numeric.arrays import ComplexArray, FloatArray
from camgeo.numeric.checked import check_fields


@dataclass(frozen=True, slots=True)
class OscillatingFlat(Rocking, FlatFollower):
    """Oscillating follower with a flat face.

    The face's direction d points from the foot of the pivot on it to the contact. chi is its angle
    from the line pivot -> cam axis, positive on the rocker's own side m = `arm_side`:
    d = exp(i (alpha + m chi)), alpha the direction of that line, and n = i m d. The face lies f
    (`face_offset`) beyond the parallel through the pivot, so that in
    `camgeo.kinematics.mechanism.face`

        h = l_1 sin chi + f, tau = 1 - sigma m chi'.

    With w = 1/tau the contact lies at q = l_1 w cos chi from the pivot's foot, and

        p = f tau + l_1 ((2 - w) sin chi + w^2 chi'' cos chi).

    Attributes
    ----------
    pivot : B_0 seen from the cam axis, complex [mm].
    base_radius : r_G, cam axis to face at cam angle 0 [mm].
    face_offset : f [mm], how far the face lies beyond the pivot, away from the cam axis; 0 if it
        runs through the pivot, negative if it lies towards the axis.
    arm_side : m, +1 if the face lies counter-clockwise of the line pivot -> cam axis, -1 clockwise.
    direction : +1 if a positive lift [rad] moves the face outward (F-cam), -1 inward (P-cam); None
        if the lift is the rocker's own angle, counter-clockwise positive, as behind a linkage.
    face : where the face begins and ends [mm], along d from the pivot's foot; None if it is as long
        as needed.

    Raises
    ------
    GeometryError
        With the key of an invalid value; with "follower.base_radius" also if the
        face cannot be that far from the cam axis, with "follower.pivot" or "follower.face_offset"
        if it can be at no distance.
    """

    kind: ClassVar = "oscillating-flat"
    origin: ClassVar = "pivot's foot"
    least_place: ClassVar = 0.0  # at the pivot's foot it has no lever about the pivot
    raised_by: ClassVar = ("follower.base_radius", "follower.face_offset")

    pivot: Place
    base_radius: Length
    face_offset: Coordinate = 0.0
    arm_side: Sense = 1
    direction: Sense | None = 1
    face: FaceEnds | None = None

    def __post_init__(self) -> None:
        check_fields(self, "follower.")
        l1, f = self.centre_distance, self.face_offset
        if l1 == 0.0:
            message = "the pivot lies on the cam axis, where no rocker can move its face outward"
            raise GeometryError(message, key="follower.pivot")
        if f <= -l1:
            raise GeometryError(
                f"the face cannot lie there: with the pivot {l1:.6g} mm from the cam axis it would"
                f" always lie beyond it; must be above {-l1:.6g} mm",
                key="follower.face_offset",
                value=f"{f:g}",
            )
        if not abs(self.base_radius - f) < l1:
            raise GeometryError(
                f"the face cannot lie there: with the pivot {l1:.6g} mm from the cam axis and a"
                f" face {f:.6g} mm beyond the pivot it must lie between {max(f - l1, 0.0):.6g} and"
                f" {f + l1:.6g} mm from the cam axis",
                key="follower.base_radius",
                value=f"{self.base_radius:g}",
            )

    @property
    def farthest(self) -> float:
        """See `Follower`."""
        return self.face_offset + self.centre_distance

    @property
    def start_arm(self) -> complex:
        """See `Follower`."""
        return complex(self._face(np.zeros(1))[0][0]) - self.pivot

    @property
    def start_angle(self) -> float:
        """chi at cam angle 0 [rad], in (-pi/2, pi/2)."""
        l1, over = self.centre_distance, self.base_radius - self.face_offset
        return math.atan2(over, math.sqrt((l1 - over) * (l1 + over)))

    @property
    def facing(self) -> int:
        """See `FlatFollower`: d = -i m n."""
        return self.arm_side

    @property
    def reach(self) -> float:
        """See `Follower`."""
        lever = self.centre_distance * math.cos(self.start_angle)
        return self.swing_sense * math.hypot(lever, self.face_offset)

    def face_angle(self, lift: FloatArray) -> FloatArray:
        """chi (n,) [rad] at lifts (n,)."""
        return self.start_angle + self.arm_side * self.swing_sense * lift

    def normal(self, lift: FloatArray) -> ComplexArray:
        """See `FlatFollower.normal`."""
        angle = self.line_angle + self.arm_side * (self.face_angle(lift) + 0.5 * math.pi)
        normals: ComplexArray = np.exp(1j * angle)
        return normals

    def touch(self, jet: Jet, rotation: int) -> Touch:
        """See `FlatFollower.touch`."""
        return self._touch(jet, rotation, 1)[0]

    def _touch(self, jet: Jet, rotation: int, order: int) -> tuple[Touch, FloatArray, FloatArray]:
        """The contact, p' only if `order` is 1, and sine and cosine of chi."""
        l1, f = self.centre_distance, self.face_offset
        own, sense = self.arm_side * self.swing_sense, rotation * self.arm_side
        chi, chi1, chi2 = own * jet[:3]
        chi = chi + self.start_angle
        sine, cosine = np.sin(chi), np.cos(chi)
        turn = 1.0 - sense * chi1
        w = np.divide(1.0, turn, out=np.full_like(turn, np.inf), where=turn != 0.0)
        with np.errstate(invalid="ignore"):  # where the face stands still in the cam
            square = w * w
            contact = np.stack((w * cosine, sense * chi2 * square * cosine - chi1 * w * sine))
            pace = np.empty((order + 1, len(chi)))
            pace[0] = f * turn + l1 * ((2.0 - w) * sine + square * chi2 * cosine)
            if order > 0:
                chi3 = own * jet[3]
                bend = (2.0 - w) * chi1 + square * (chi3 + 2.0 * sense * w * chi2 * chi2)
                sway = square * chi2 * (sense + chi1)
                pace[1] = -sense * f * chi2 + l1 * (bend * cosine - sway * sine)
        pace[:, turn == 0.0] = np.inf
        contact[:, turn == 0.0] = np.inf
        turns = np.stack((turn, -sense * chi2))
        return Touch(l1 * sine + f, l1 * contact, turns, pace), sine, cosine

    def relative_jet(self, jet: Jet, rotation: int, order: int = FULL_ORDER) -> RelativeJet:
        """See `Follower.relative_jet`. Axes along the line pivot -> cam axis and across it.

        R_0 = (q + i m f) exp(i m chi) - l_1, its first part sigma m chi' q cos chi - h sin chi so
        that a distant pivot costs no digits, R_1 = sigma m p exp(i m chi) and
        R_2 = (sigma m p' - i m tau p) exp(i m chi). u and v are p times sine and cosine of the
        angle between the lever, pivot -> contact, and the normal.
        """
        order, side = min(order, HIGHEST), self.arm_side
        touch, sine, cosine = self._touch(jet, rotation, order - 1)
        q, f, pace = touch.contact[0], self.face_offset, touch.pace
        along, across = np.empty((2, order + 1, jet.shape[1]))
        ahead = (rotation * self.swing_sense) * jet[1]  # sigma m chi'
        along[0] = ahead * q * cosine - touch.distance * sine
        across[0] = side * (q * sine + f * cosine)
        along[1] = (rotation * side) * pace[0] * cosine
        across[1] = rotation * pace[0] * sine
        if order > 1:
            turned = touch.turn[0] * pace[0]
            along[2] = (rotation * side) * pace[1] * cosine + turned * sine
            across[2] = rotation * pace[1] * sine - side * turned * cosine
        lever = np.hypot(q, f)
        share = np.divide(q, lever, out=np.zeros_like(q), where=lever > 0.0)
        rest = np.divide(f, lever, out=np.ones_like(q), where=lever > 0.0)
        return RelativeJet(
            along,
            across,
            self.line_angle,
            side * pace[0] * share,
            pace[0] * rest,
            self.swing_sense * jet[1],
            self.swing_sense * lever,
        )

    def tangent_jet(self, jet: Jet, rotation: int) -> TangentJet:
        """See `Follower.tangent_jet`: Z' lies along the face, w = 0.

        swerve = p p' + sigma nu'' p^2, nu'' = `swing_sense` times the lift's.
        """
        u = self._touch(jet, rotation, 1)[0].pace
        swing = self.swing_sense * jet[1:3]
        swerve = u[0] * (u[1] + rotation * swing[1] * u[0])
        return TangentJet(u, np.zeros_like(u), swing[0], swerve)

    def speed_bounds(self, jet: Jet, bounds: Jet, half: FloatArray, rotation: int) -> FloatArray:
        """See `Follower.speed_bounds`; infinite where the cell may reach tau = 0.

        Z'' = (p' - i sigma tau p) t and p' = a + b chi''' with b = l_1 w^2 cos chi and a free of
        chi'''. The rates of a, b, tau, p and of t, which turns by tau, are bounded term by term;
        chi''' changes by no more than the sum of its value in the middle and its bound.
        """
        l1, f = self.centre_distance, abs(self.face_offset)
        _, x1, x2, x3 = bounds
        sense = rotation * self.swing_sense
        middle = 1.0 - sense * jet[1]
        turn = np.abs(middle) + half * x2
        slowest = middle - half * x2
        w = np.divide(1.0, slowest, out=np.full_like(turn, np.inf), where=slowest > 0.0)
        with np.errstate(invalid="ignore", over="ignore"):  # 0 times infinity
            square = w * w
            sway = np.maximum(2.0, w)  # of 2 - w, as 0 < w
            rate = square * x2  # of w
            pace_rate = f * x2 + l1 * (
                sway * x1 + square * (x3 + x2 * (1.0 + x1)) + 2.0 * w * rate * x2
            )
            here = np.abs(self._touch(jet, rotation, 0)[0].pace[0])
            pace = here + half * pace_rate
            rate_of_a = f * x3 + l1 * (
                sway * (x2 + x1 * x1) + rate * x1  # of (2 - w) chi' cos chi
                + square * (x3 + x1 * x2) + 2.0 * w * rate * x2  # of w^2 chi'' sin chi
                + square * x1 * (x3 + x1 * x2) + square * x2 * x2 + 2.0 * w * rate * x1 * x2
                + 2.0 * w * square * x2 * (2.0 * x3 + x1 * x2) + 6.0 * square * rate * x2 * x2
            )  # fmt: skip
            rate_of_b = l1 * (2.0 * w * rate + square * x1)
            second = pace_rate + turn * pace
            third = rate_of_a + rate_of_b * x3 + x2 * pace + turn * pace_rate + turn * second
            jumps = spread(l1 * square * (np.abs(jet[3]) + x3), half)
            out = np.stack((pace, second, third + jumps))
        out[:, slowest <= 0.0] = np.inf
        return out

    def sliding(self, jet: Jet, rotation: int) -> FloatArray:
        """See `Follower.sliding`: g = h - sigma f nu'."""
        slide = self.touch(jet, rotation).distance
        return np.asarray(slide - rotation * self.face_offset * self.swing_sense * jet[1])

    def _face(self, lifts: FloatArray) -> tuple[ComplexArray, ComplexArray]:
        """The pivot's foot on the face (n,) [mm], and the direction in which places are measured,
        at lifts (n,).
        """
        line = -self.pivot / abs(self.pivot)
        along = line * np.exp(1j * self.arm_side * self.face_angle(lifts))
        return self.pivot + 1j * self.arm_side * along * self.face_offset, along

    def _face_line(
        self, lifts: FloatArray, ends: tuple[float, float]
    ) -> tuple[ComplexArray, ComplexArray]:
        """The ends of the face (n,) [mm], extended to the pivot's foot, at lifts (n,)."""
        return face_line(*self._face(lifts), (min(0.0, ends[0]), max(0.0, ends[1])))

    def sketch(
        self, lifts: FloatArray, _: float, ends: tuple[float, float]
    ) -> MechanismSketch[Places]:
        """See `Follower.sketch`."""
        foot, _along = self._face(lifts)
        start, along = (complex(each[0]) for each in self._face(np.zeros(1)))
        nearest = start - along * (start * along.conjugate()).real
        sizes: list[Dimension[Places]] = [
            Dimension("pivot", 0j, self.pivot, vector=True),
            Dimension("base_radius", 0j, nearest),
        ]
        if self.face_offset != 0.0:
            below = self.face_offset < 0.0
            sizes.append(Dimension("face_offset", self.pivot, foot, negative=below))
        return MechanismSketch(
            links=((self.pivot, foot),),
            shafts=(self.pivot,),
            faces=(self._face_line(lifts, ends),),
            dimensions=tuple(sizes),
        )

    def held(
        self, ends: tuple[float, float]
    ) -> tuple[Literal["pivot"], complex, tuple[complex, complex]]:
        """See `Follower.held`."""
        start, stop = self._face_line(np.zeros(1), ends)
        return "pivot", self.pivot, (complex(start[0]), complex(stop[0]))
