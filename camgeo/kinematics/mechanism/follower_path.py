"""The path along which a follower guides its roller, seen from the cam, and where it meets a curve.

At a cam angle phi the roller centre can move along one path only: a straight guide, or a circle
about the rocker's pivot. A coordinate q along it grows outward: the height h above the cam
axis on a guide, or the angle psi_t from the line pivot -> cam axis to the arm. It is linear in the
lift. As long as the follower stays on its own side (h > 0; psi_t in (0, pi)), the distance from the
cam axis gives q and the polar angle gives phi: (phi, q) are coordinates of the plane, and a curve
of roller centres is a lift over the cam angle.

Behind a linkage the follower is the rocker, and its lift the rocker's angle.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass
from functools import singledispatch
from typing import Any

import numpy as np

from camgeo.errors import GeometryError
from camgeo.kinematics.mechanism.follower import Follower
from camgeo.kinematics.mechanism.rollers import OscillatingRoller, TranslatingRoller
from camgeo.numeric.arrays import BoolArray, ComplexArray, FloatArray, IntArray, dot, phase
from camgeo.units import TURN

ROUNDING = 1e-9
"""Amount by which the square of a cosine may be negative: curves that miss each other by this
fraction of their size count as touching."""

PLACE = 2.0**-46
"""Relative accuracy of a point, 64 ulps, which the sums of this module lose."""


@dataclass(frozen=True, slots=True, eq=False)
class Bows:
    """Lines and circles, each given by one of its points, so that flat arcs are well conditioned.

    A point Z lies on it if Re(conj(n) d) + kappa |d|^2 / 2 = 0, d = Z - A; its normal there is
    n + kappa d.

    Attributes
    ----------
    points : (n,) A, complex [mm].
    normals : (n,) n, complex unit normals at A.
    curvatures : (n,) kappa [1/mm], positive where the normal points away from the centre, 0 for a
        line.
    """

    points: ComplexArray
    normals: ComplexArray
    curvatures: FloatArray

    def __len__(self) -> int:
        return len(self.points)

    def take(self, index: IntArray) -> Bows:
        """The bows with the indices `index` (k,)."""
        return Bows(self.points[index], self.normals[index], self.curvatures[index])

    def evaluate(self, t: FloatArray) -> ComplexArray:
        """(n,) [mm] the points at the parameters t (n,) [mm]: 2 tan(beta/2) / kappa.

        beta is the angle turned from A; on a line t is the distance from A, in the direction i n.
        """
        return self.points + 1j * self.normals * t / (1.0 - 0.5j * self.curvatures * t)

    def unit_normals(self, points: ComplexArray) -> ComplexArray:
        """(n,) unit normals at `points` (n,) [mm], which lie on them."""
        return self.normals + self.curvatures * (points - self.points)

    def crossings(self, others: Bows) -> FloatArray:
        """(2, n) parameters at which each bow meets its partner in `others`; infinite if it does
        not.
        """
        return _roots(*self._meeting_quadratic(others))

    def crossing(self, others: Bows, rising: FloatArray) -> FloatArray:
        """(n,) that of the two parameters at which each bow enters (`rising` = 1) or leaves (-1)
        the side of its partner to which the partner's normal points.

        Raises GeometryError where they do not meet.
        """
        square, linear, value = self._meeting_quadratic(others)
        radicand = linear * linear - 4.0 * square * value
        # A small circle is known only to the rounding of its position, which grows with its
        # curvature.
        lost = ROUNDING + PLACE * np.abs(others.curvatures * others.points)
        _require_meeting(radicand >= -lost)
        root = rising * np.sqrt(np.maximum(radicand, 0.0))
        # (root - linear) / (2 square) and -2 value / (linear + root) are the same root; the form is
        # taken in which nothing cancels.
        alike = rising * linear >= 0.0
        top = np.where(alike, -2.0 * value, root - linear)
        bottom = np.where(alike, linear + root, 2.0 * square)
        _require_meeting((bottom != 0.0) | (top == 0.0))
        return np.divide(top, bottom, out=np.zeros_like(top), where=bottom != 0.0)

    def _meeting_quadratic(self, others: Bows) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Square, linear and constant coefficient (n,) of the quadratic equation for the parameters
        at which each bow meets its partner in `others`.
        """
        offset = others.points - self.points
        turned = others.normals - others.curvatures * offset
        value = 0.5 * others.curvatures * dot(offset, offset) - dot(others.normals, offset)
        kappa = self.curvatures
        square = 0.5 * (others.curvatures - kappa * dot(turned, self.normals))
        square += 0.25 * value * kappa * kappa
        return square, dot(turned, 1j * self.normals), value

    def at_distance(self, radius: float, shift: float = 0.0) -> FloatArray:
        """(2, n) parameters at which the parallel at -`shift` is `radius` from the cam axis [mm].

        Infinite where there is no such place.
        """
        kappa = self.curvatures
        a = self.points - shift * self.normals
        b = 1j * (self.normals - 0.5 * kappa * (self.points + shift * self.normals))
        return _roots(
            dot(b, b) - (0.5 * radius * kappa) ** 2,
            2.0 * dot(a, b),
            (np.abs(a) - radius) * (np.abs(a) + radius),
        )

    def lift_jet(
        self,
        path: FollowerPath,
        phi: FloatArray,
        q: FloatArray,
        slopes: FloatArray | float = 0.0,
    ) -> FloatArray:
        """(4, n) lift and three derivatives [mm or rad per rad^k] where `path` meets the bows at q.

        For the bows of curvature of another curve, `slopes` (n,) are the changes of its curvature
        along it [1/mm^2], with the normal on the right.

        By implicit differentiation of F(phi, q) = 0: q' = -F_phi / F_q, and twice more. Along the
        path d^3Z/dq^3 follows from the second derivative by the same factor as that from the first.

        Raises
        ------
        GeometryError
            Where the path is tangent to the bow: the lift has no velocity there.
        """
        point = path.point(phi, q)
        along, bend = path.along(phi, q)
        normal = self.unit_normals(point)
        turn = -1j * path.rotation
        steep = dot(normal, along)
        if np.any(steep == 0.0):
            raise GeometryError(
                "the contour runs along the path of the follower: its lift jumps there"
            )
        first = -dot(normal, turn * point) / steep
        speed = turn * point + along * first
        # What Z'' has besides the term of q'': turn is the factor -i sigma of a derivative by phi
        # in the cam.
        rest = -point + 2.0 * turn * along * first + bend * first * first
        second = -(self.curvatures * dot(speed, speed) + dot(normal, rest)) / steep
        pace = rest + along * second
        # turn^2 = -1 and turn^3 = -turn; the same for Z''', without the term of q'''.
        jolt = -turn * point - 3.0 * along * first
        jolt += 3.0 * turn * (bend * first * first + along * second)
        jolt += first * bend * (bend / along * first * first + 3.0 * second)
        twist = slopes * dot(1j * normal, speed) ** 3
        third = -(3.0 * self.curvatures * dot(speed, pace) + twist + dot(normal, jolt)) / steep
        return path.outward * np.stack((q - path.start, first, second, third))


@dataclass(frozen=True, slots=True)
class FollowerPath(ABC):
    """The path of the roller centre at each cam angle, in cam coordinates.

    Attributes
    ----------
    follower : the follower that has the path.
    rotation : sigma, +1 if the cam turns counter-clockwise, -1 clockwise.
    """

    follower: Any
    rotation: int

    @property
    @abstractmethod
    def start(self) -> float:
        """q at lift 0 [mm or rad]."""

    @property
    @abstractmethod
    def outward(self) -> int:
        """+1 if a positive lift moves the roller outward, else -1; q = start + outward * lift."""

    @property
    @abstractmethod
    def reach(self) -> tuple[float, float]:
        """Smallest and largest distance from the cam axis [mm] that the roller centre can have."""

    @abstractmethod
    def coordinate(self, distance: FloatArray) -> FloatArray:
        """(n,) q where the roller centre is `distance` (n,) [mm] from the cam axis.

        For a distance beyond the `reach`, q at the end of it.
        """

    @property
    @abstractmethod
    def axis(self) -> float:
        """Direction [rad] of the first axis of `centre`, at cam angle 0."""

    @abstractmethod
    def centre(self, q: FloatArray) -> ComplexArray:
        """(n,) the roller centre [mm] in axes that do not turn with the cam."""

    def frame(self, phi: FloatArray) -> ComplexArray:
        """(n,) unit vectors of the first axis of `centre` in the cam."""
        return np.asarray(np.exp(1j * (self.axis - self.rotation * phi)))

    def cam_coordinates(self, points: ComplexArray) -> tuple[FloatArray, FloatArray]:
        """Cam angle (n,) [rad] in [0, 2 pi) and q (n,) of roller centres at `points` (n,) [mm].

        Raises GeometryError for a point beyond the reach.
        """
        distance = np.abs(points)
        _require_reach(distance, self.reach)
        q = self.coordinate(distance)
        return _reduce_to_turn(
            self.rotation * (self.axis + np.angle(self.centre(q)) - np.angle(points))
        ), q

    def point(self, phi: FloatArray, q: FloatArray) -> ComplexArray:
        """(n,) complex [mm] Z."""
        return self.frame(phi) * self.centre(q)

    @abstractmethod
    def along(self, phi: FloatArray, q: FloatArray) -> tuple[ComplexArray, ComplexArray]:
        """(n,), (n,) dZ/dq and d^2Z/dq^2 [mm, or mm/rad^k for a rocker]."""

    @abstractmethod
    def meet(self, phi: FloatArray, bows: Bows, facing: FloatArray) -> FloatArray:
        """(n,) q at which the path at `phi` (n,) [rad] meets each of `bows`.

        Of two such points, the one where the bow's normal has a component along the path that is
        outward (`facing` = 1) or inward (-1). Raises GeometryError where they do not meet.
        """

    @abstractmethod
    def touching(self, bows: Bows) -> FloatArray:
        """(4, n) parameters of `bows` at which a path is tangent to them; infinite where there is
        none.

        They include tangency with the part of a path on the side where the follower never is.
        """


@singledispatch
def path_of(follower: Follower, rotation: int) -> FollowerPath:
    """The path of `follower` on a cam that turns in the sense `rotation`, +1 counter-clockwise.

    Raises GeometryError if no path is registered for the class of the follower.
    """
    del rotation  # only the registered functions use it
    raise GeometryError(
        f'this needs a roller follower, and this one is "{follower.kind}"',
        key="follower.kind",
        value=follower.kind,
    )


class GuidePath(FollowerPath):
    """The guide of a translating follower: Z = u (e + i h), u = exp(i (axis - sigma phi))."""

    __slots__ = ()

    follower: TranslatingRoller

    @property
    def start(self) -> float:
        return self.follower.start_height

    @property
    def outward(self) -> int:
        return self.follower.direction

    @property
    def reach(self) -> tuple[float, float]:
        return abs(self.follower.offset), math.inf

    @property
    def axis(self) -> float:
        return self.follower.guide_angle - math.pi / 2.0

    def centre(self, q: FloatArray) -> ComplexArray:
        return np.asarray(self.follower.offset + 1j * q)

    def coordinate(self, distance: FloatArray) -> FloatArray:
        e = abs(self.follower.offset)
        return np.asarray(np.sqrt(np.maximum(distance - e, 0.0) * (distance + e)))

    def along(self, phi: FloatArray, q: FloatArray) -> tuple[ComplexArray, ComplexArray]:
        direction = 1j * self.frame(phi)
        return direction, np.zeros_like(direction)

    def meet(self, phi: FloatArray, bows: Bows, facing: FloatArray) -> FloatArray:
        frame = self.frame(phi)
        level = (frame.conj() * bows.points).imag
        guide = Bows(frame * (self.follower.offset + 1j * level), frame, np.zeros(len(phi)))
        return np.asarray(level + guide.crossing(bows, facing))

    def touching(self, bows: Bows) -> FloatArray:
        turned = bows.normals.conj() * bows.points
        kappa, e = bows.curvatures, self.follower.offset
        return np.concatenate(
            [
                _roots(
                    0.5 * kappa - 0.25 * kappa * kappa * (turned.real + side),
                    kappa * turned.imag,
                    turned.real - side,
                )
                for side in (e, -e)
            ]
        )


class SwingPath(FollowerPath):
    """The circle about a rocker's pivot: Z = u (l_3 exp(i chi) - l_1).

    u = exp(i (alpha - sigma phi)), chi = h psi_t, h the arm's side.
    """

    __slots__ = ()

    follower: OscillatingRoller

    @property
    def start(self) -> float:
        return self.follower.start_angle

    @property
    def outward(self) -> int:
        return self.follower.arm_side * self.follower.swing_sense

    @property
    def reach(self) -> tuple[float, float]:
        follower = self.follower
        return abs(follower.excess), follower.centre_distance + follower.arm

    @property
    def axis(self) -> float:
        return phase(-self.follower.pivot)

    def coordinate(self, distance: FloatArray) -> FloatArray:
        low, high = self.reach
        near = np.maximum(distance - low, 0.0) * (distance + low)
        far = np.maximum(high - distance, 0.0) * (high + distance)
        return np.asarray(2.0 * np.arctan2(np.sqrt(near), np.sqrt(far)))

    def centre(self, q: FloatArray) -> ComplexArray:
        """W (n,) in axes along the line pivot -> cam axis, without cancellation of l_3 and l_1."""
        half = 0.5 * self.follower.arm_side * q
        bow: ComplexArray = 2j * self.follower.arm * np.sin(half) * np.exp(1j * half)
        bow += self.follower.excess
        return bow

    def _tip(self, phi: FloatArray, q: FloatArray) -> ComplexArray:
        follower = self.follower
        tip: ComplexArray = self.frame(phi) * np.exp(1j * follower.arm_side * q)
        tip *= follower.arm
        return tip

    def along(self, phi: FloatArray, q: FloatArray) -> tuple[ComplexArray, ComplexArray]:
        tip = self._tip(phi, q)
        return 1j * self.follower.arm_side * tip, -tip

    def meet(self, phi: FloatArray, bows: Bows, facing: FloatArray) -> FloatArray:
        arm, side, frame = self.follower.arm, self.follower.arm_side, self.frame(phi)
        # The circle is given by its point at the same distance from the cam axis as that of the
        # bow, so that both points are close together if the bow is near the path.
        near = self.coordinate(np.abs(bows.points))
        towards = frame * np.exp(1j * side * near)
        circle = Bows(self.point(phi, near), towards, np.full(len(phi), 1.0 / arm))
        turn = 2.0 * np.arctan(0.5 * circle.crossing(bows, facing * side) / arm)
        return np.asarray(np.remainder(near + side * turn + math.pi, TURN) - math.pi)

    def touching(self, bows: Bows) -> FloatArray:
        arm, distance = self.follower.arm, self.follower.centre_distance
        return np.concatenate([bows.at_distance(distance, side) for side in (arm, -arm)])


path_of.register(TranslatingRoller, GuidePath)
path_of.register(OscillatingRoller, SwingPath)


def _reduce_to_turn(angle: FloatArray) -> FloatArray:
    """(n,) `angle` reduced to [0, 2 pi); 0 for a tiny negative one, whose remainder would round to
    a full turn.
    """
    turned = np.remainder(angle, TURN)
    return np.where(turned < TURN, turned, 0.0)


def _roots(square: FloatArray, linear: FloatArray, constant: FloatArray) -> FloatArray:
    """(2, n) real roots of square t^2 + linear t + constant; infinite where there is none."""
    radicand = linear * linear - 4.0 * square * constant
    root = np.sqrt(np.maximum(radicand, 0.0))
    # Both terms have the same sign, so nothing cancels; the other root follows from the product of
    # both.
    half = -0.5 * (linear + np.where(linear < 0.0, -root, root))
    roots = np.full((2, len(square)), np.inf)
    real = radicand >= 0.0
    np.divide(half, square, out=roots[0], where=real & (square != 0.0))
    np.divide(constant, half, out=roots[1], where=real & (half != 0.0))
    return roots


def _require_meeting(good: BoolArray) -> None:
    if not np.all(good):
        raise GeometryError("the follower's path does not meet the contour there")


def _require_reach(distance: FloatArray, reach: tuple[float, float]) -> None:
    low, high = reach
    slack = ROUNDING * (low if math.isinf(high) else high)
    if not np.all((distance >= low - slack) & (distance <= high + slack)):
        allowed = f"at least {low:.6g} mm" if math.isinf(high) else f"{low:.6g} mm to {high:.6g} mm"
        raise GeometryError(
            "the follower cannot reach that place: the roller centre must lie"
            f" {allowed} from the cam axis"
        )
