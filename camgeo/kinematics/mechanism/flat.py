"""Flat faces, on a guide or on a rocker: the support function of the cam, and its envelope.

The face is the line Re(conj(n) F) = h in the fixed frame, n = exp(i nu) its normal away from the
cam axis and h its distance from it. In the cam the normal has the angle theta = nu - sigma phi, and
the point of contact follows from the face and its rate, theta' = nu' - sigma:

    Z = (h + i h'/theta') exp(i theta).

With the rotation tau = 1 - sigma nu' of the normal in the cam, against the sense in which the
cam turns,

    Z' = p t, t = -i sigma exp(i theta), p = tau h + (h'/tau)',

so that rho = p / tau is the signed radius of curvature of the outline. The cam is convex, and the
face can touch it everywhere, where tau > 0 and p > 0; p = 0 is a cusp, p < 0 undercut, and where
tau <= 0 the face turns back in the cam.

How Z''' can be bounded although it does not exist: Z'' contains the third derivative of the lift,
and a motion has no derivative of that. Let |Z''(x) - Z''(m)| <= A |x - m| + D over a cell of
half-width H about its middle m: A from all that is smooth, D from the change of the third
derivative. The value returned for |Z'''| is V = A + 3 D / H. All uses of such a bound remain valid:

- The remainder of the parabola that Z osculates in the middle is at most A H^3/6 + D H^2/2, which
  is V H^3/6.
- Z' is off the straight line of its parabola by at most A H^2/2 + D H <= V H^2/2.
- Z'' changes by at most A H + D <= V H.

The same three hold for a scalar product of Z with a fixed vector, for its distance from a point and
for the direction of Z', whose other parts are smooth: there A is the part that needs no Z'''.
"""

from __future__ import annotations

import cmath
import math
from abc import abstractmethod
from dataclasses import dataclass
from typing import Annotated, Any, ClassVar, Literal, cast

import numpy as np

from camgeo.errors import GeometryError
from camgeo.kinematics.mechanism.follower import Follower, Guided, RelativeJet, Rocking, TangentJet
from camgeo.kinematics.mechanism.sketch import Dimension, MechanismSketch, Places
from camgeo.kinematics.mechanism.values import Angle, Coordinate, Length, Place, Sense, coordinate
from camgeo.kinematics.motion import FULL_ORDER, Jet
from camgeo.numeric.arrays import ComplexArray, FloatArray
from camgeo.numeric.checked import CheckedFields, check_fields, value_text

HIGHEST = FULL_ORDER - 1
"""Order of the highest derivative of Z: each needs one more derivative of the lift."""


@dataclass(frozen=True, slots=True, eq=False)
class Touch:
    """The contact of a flat face at n cam angles.

    Attributes
    ----------
    distance : (n,) h [mm], cam axis to face.
    contact : (2, n) [mm/rad^k] place of the contact along the face, and its derivative, see
        `FlatFollower`.
    turn : (2, n) tau and tau' [1/rad]; tau is positive where the face turns forward in the cam.
    pace : (2, n) [mm/rad^k] p and p'; p is infinite where tau = 0.
    """

    distance: FloatArray
    contact: FloatArray
    turn: FloatArray
    pace: FloatArray


class FlatFollower(Follower):
    """A follower with a flat face; its `face` is measured as `Touch.contact` is.

    Attributes
    ----------
    origin : the point from which the position of the contact is measured, in words.
    least_place : position of the contact [mm] at and below which the cam cannot move the follower.
    raising_keys : keys of the lengths that, increased by the same amount, move the face outward by
        this amount.
    facing : +1 if the position of the contact is positive to the right, looking along the normal
        away from the cam axis, -1 to the left.
    """

    __slots__ = ()

    touching = "face"
    roller_radius = 0.0
    offset = 0.0
    rolls = False
    has_edge = False
    has_pitch_curve = False
    standstill = (
        "the contact of the flat face stands still in the turning cam (Z' = 0): the outline has a"
        " cusp and no normal there"
    )
    ahead = 1

    origin: ClassVar[str]
    least_place: ClassVar[float]
    raising_keys: ClassVar[tuple[str, ...]]

    @property
    @abstractmethod
    def facing(self) -> int:
        """See the class."""

    @abstractmethod
    def normal(self, lift: FloatArray) -> ComplexArray:
        """(n,) unit normals of the face away from the cam axis at lifts (n,), in the frame."""

    @abstractmethod
    def touch(self, jet: Jet, rotation: int) -> Touch:
        """The contact for lifts `jet` (4, n); `rotation` as in `Follower.relative_jet`."""

    def curvature(self, relative: RelativeJet, speed: FloatArray, rotation: int) -> FloatArray:
        """See `Follower.curvature`: that of the outline, whose tangent is the face.

        Nothing cancels where the face nearly stands still in the cam and Z'' is large.
        """
        return np.asarray((1.0 - rotation * relative.turning) / speed)

    def contact_radius(self, kappa: FloatArray, _: float) -> FloatArray:
        """See `Follower.contact_radius`: a face adds no curvature."""
        return 1.0 / kappa

    def on_one_side(self, _: FloatArray) -> bool:
        """See `Follower.on_one_side`."""
        return False

    def return_sketch(self, _: ComplexArray, __: FloatArray, ___: float) -> MechanismSketch[Places]:
        """See `Follower.return_sketch`."""
        return MechanismSketch()


def spread(change: FloatArray, half: FloatArray) -> FloatArray:
    """(n,) 3 D / H, see the module, from the `change` D and the `half` width H (n,); 0 for cells of
    zero width, in which nothing changes.
    """
    return np.divide(3.0 * change, half, out=np.zeros_like(change), where=half > 0.0)


def face_ends(key: str, face: Any) -> tuple[float, float]:
    """The start and the end [mm] of a face; GeometryError unless the end lies beyond the start."""
    if not isinstance(face, tuple | list) or len(face) != 2:
        raise GeometryError("must be two lengths, (from, to)", key, value_text(face))
    start, end = (coordinate(key, bound) for bound in face)
    if not start < end:
        raise GeometryError("must end beyond where it begins", key, value_text(face))
    return start, end


FaceEnds = Annotated[tuple[float, float], face_ends]


def face_line(
    start: ComplexArray, along: ComplexArray, ends: tuple[float, float]
) -> tuple[ComplexArray, ComplexArray]:
    """Both ends (n,) [mm] of a face, whose positions `ends` [mm] count from `start` (n,) in the
    direction `along` (n,).
    """
    return start + along * ends[0], start + along * ends[1]


def flat_follower(follower: Follower) -> FlatFollower:
    """`follower`, which has a flat face; GeometryError with key "follower.kind" if it has none."""
    if not hasattr(follower, "touch"):
        raise GeometryError(
            "this needs a flat-faced follower, and this one has a roller", key="follower.kind"
        )
    return cast("FlatFollower", follower)


# -- translating flat ------------------------------------------------------------------------------
# Translating flat-faced follower: a flat face square to a straight guide.


@dataclass(frozen=True, slots=True)
class TranslatingFlat(Guided, FlatFollower, CheckedFields, path="follower."):
    """Translating follower whose face is square to the guide.

    With nu = `guide_angle` and h = r_G + kappa_F s in `camgeo.kinematics.mechanism.flat` the turn
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
    raising_keys: ClassVar = ("follower.base_radius",)
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
        """h [mm] and as many of its derivatives as `jet` has of the lift."""
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
        """See `Follower.sliding`: h; the movement of the contact along the face is no sliding."""
        return self.touch(jet, rotation).distance

    def _face(self, lifts: FloatArray) -> tuple[ComplexArray, ComplexArray]:
        """The foot of the cam axis on the face (n,) [mm], and the direction in which places count,
        at lifts (n,).
        """
        foot = self.traced(lifts)  # the contact in a dwell, h' = 0
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
        """See `Follower.far_side`: the same face, rotated by half a turn."""
        _, along = self._face(lifts)
        there, joined = self.across(lifts, breadth)
        return joined + MechanismSketch(faces=(face_line(there, -along, ends),))


# -- oscillating flat ------------------------------------------------------------------------------
# Oscillating flat-faced follower: a flat face on a rocker with a fixed pivot.


@dataclass(frozen=True, slots=True)
class OscillatingFlat(Rocking, FlatFollower):
    """Oscillating follower with a flat face.

    The face's direction d points from the foot of the pivot on it to the contact. chi is its angle
    from the line pivot -> cam axis, positive on the rocker's own side m = `arm_side`:
    d = exp(i (alpha + m chi)), alpha the direction of that line, and n = i m d. The face lies f
    (`face_offset`) beyond the parallel through the pivot, so that in
    `camgeo.kinematics.mechanism.flat`

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
    raising_keys: ClassVar = ("follower.base_radius", "follower.face_offset")

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
            raise GeometryError(
                "the pivot lies on the cam axis, where no rocker can move its face outward",
                key="follower.pivot",
            )
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
        l1, height = self.centre_distance, self.base_radius - self.face_offset
        return math.atan2(height, math.sqrt((l1 - height) * (l1 + height)))

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
        return np.asarray(np.exp(1j * angle))

    def touch(self, jet: Jet, rotation: int) -> Touch:
        """See `FlatFollower.touch`."""
        return self._touch(jet, rotation, 1)[0]

    def _touch(self, jet: Jet, rotation: int, order: int) -> tuple[Touch, FloatArray, FloatArray]:
        """The contact, p' only if `order` is 1, and sine and cosine of chi."""
        l1, f = self.centre_distance, self.face_offset
        chi_sense, sense = self.arm_side * self.swing_sense, rotation * self.arm_side
        chi, chi1, chi2 = chi_sense * jet[:3]
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
                chi3 = chi_sense * jet[3]
                bend = (2.0 - w) * chi1 + square * (chi3 + 2.0 * sense * w * chi2 * chi2)
                sway = square * chi2 * (sense + chi1)
                pace[1] = -sense * f * chi2 + l1 * (bend * cosine - sway * sine)
        # tau = 0: the face stands still in the cam, and its envelope runs off to infinity.
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
            limits = np.stack((pace, second, third + jumps))
        # There tau may be 0 in the cell, and w is unbounded.
        limits[:, slowest <= 0.0] = np.inf
        return limits

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
        start, along = (complex(vector[0]) for vector in self._face(np.zeros(1)))
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
