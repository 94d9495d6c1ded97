"""How a flat face lies on a circle or a point of the cam, at each cam angle.

A face touches what is convex of an outline: its vertices and its arcs, circles of radius R >= 0
about a centre C. In the frame, with the pivot or the guide at rest, the circle turns with the cam
to C exp(i sigma phi), and the face is tangent to it on the inside. In closed form

- on a guide h = Re(conj(n) C exp(i sigma phi)) + R, n the direction of the guide;
- on a rocker, with V the circle's centre seen from the pivot, in the axis from the pivot to the cam
  axis, and f the face's offset,

      chi = m arg V - asin((f - R) / |V|), q = sqrt(|V|^2 - (f - R)^2):

  the contact lies q from the pivot's foot on the face, on its own side.

The lift is linear in h, or in chi. Seen from the cam, the face is the line at the distance h from
the axis whose normal has the angle theta; its lift and theta determine the cam angle.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import singledispatch
from typing import Protocol

import numpy as np

from camgeo.errors import GeometryError
from camgeo.mechanism.face import Touch
from camgeo.mechanism.follower import Follower
from camgeo.mechanism.oscillating_flat import OscillatingFlat
from camgeo.mechanism.translating_flat import TranslatingFlat
from camgeo.numeric.arrays import ComplexArray, FloatArray, phase

ROUNDING = 1e-12
"""How far rounding may take a sine beyond 1: the face is square to the line of centres there."""


class FacePath(Protocol):
    """The places that a flat face can have, in cam coordinates.

    Attributes
    ----------
    rotation : sigma, +1 if the cam turns counter-clockwise, -1 clockwise.
    outward : +1 if a positive lift moves the face outward, else -1.
    """

    @property
    def rotation(self) -> int: ...

    @property
    def outward(self) -> int: ...

    def lift_of(self, distance: FloatArray) -> FloatArray:
        """(n,) lift [mm or rad] of the face at `distance` (n,) [mm] from the cam axis.

        Raises GeometryError where it cannot be there.
        """

    def angle_of(self, theta: FloatArray, lift: FloatArray) -> FloatArray:
        """(n,) cam angles [rad] at which the face of that `lift` (n,) has the normal at theta (n,)
        [rad] in the cam; as continuous as theta, not reduced to a turn.
        """

    def jet(self, phi: FloatArray, centres: ComplexArray, radii: FloatArray) -> FloatArray:
        """(4, n) lift and three derivatives [mm or rad per rad^k] at `phi` (n,) [rad] with the face
        on the circles about `centres` (n,) of `radii` (n,) [mm], in cam coordinates.
        """

    def contact(self, phi: FloatArray, centres: ComplexArray, radii: FloatArray) -> FloatArray:
        """(n,) [mm] place of the contact along the face, as of `FlatFollower`.

        NaN where a rocker's face cannot reach the circle.
        """

    def turning(self, centres: ComplexArray) -> FloatArray:
        """(2, n) cam angles [rad] at which the place of the contact with circles about `centres`
        (n,) is extreme.
        """

    def wander(self, touch: Touch) -> FloatArray:
        """(n,) how far the contact lies along the face per unit of the velocity of the lift."""


@singledispatch
def face_path_of(follower: Follower, rotation: int) -> FacePath:
    """The path of a flat-faced `follower` on a cam that turns in the sense `rotation`.

    Raises GeometryError if none is registered for its class.
    """
    del rotation  # used by the registered ones
    message = f'this needs a flat-faced follower, and this one is "{follower.kind}"'
    raise GeometryError(message, key="follower.kind", value=follower.kind)


@dataclass(frozen=True, slots=True)
class GuidedFace:
    """The face of a translating follower."""

    follower: TranslatingFlat
    rotation: int

    @property
    def outward(self) -> int:
        return self.follower.direction

    def lift_of(self, distance: FloatArray) -> FloatArray:
        """See `FacePath`."""
        return np.asarray(self.outward * (distance - self.follower.base_radius))

    def angle_of(self, theta: FloatArray, _: FloatArray) -> FloatArray:
        """See `FacePath`."""
        return np.asarray(self.rotation * (self.follower.guide_angle - theta))

    def _turned(self, phi: FloatArray, centres: ComplexArray) -> ComplexArray:
        """The centres against the direction of the guide."""
        axis = self.follower.guide_angle
        turned: ComplexArray = centres * np.exp(1j * (self.rotation * phi - axis))
        return turned

    def jet(self, phi: FloatArray, centres: ComplexArray, radii: FloatArray) -> FloatArray:
        """See `FacePath`."""
        turned = self._turned(phi, centres)
        rise = turned.real + (radii - self.follower.base_radius)
        slope = -self.rotation * turned.imag
        return self.outward * np.stack((rise, slope, -turned.real, -slope))

    def contact(self, phi: FloatArray, centres: ComplexArray, _: FloatArray) -> FloatArray:
        """See `FacePath`."""
        return np.asarray(-self._turned(phi, centres).imag)

    def turning(self, centres: ComplexArray) -> FloatArray:
        """See `FacePath`: with the centre at the height of the cam axis."""
        angle = self.follower.guide_angle - np.angle(centres)
        return self.rotation * np.stack((angle - 0.5 * math.pi, angle + 0.5 * math.pi))

    def wander(self, touch: Touch) -> FloatArray:
        """See `FacePath`."""
        return np.ones_like(touch.distance)


@dataclass(frozen=True, slots=True)
class RockingFace:
    """The face of an oscillating follower."""

    follower: OscillatingFlat
    rotation: int

    @property
    def outward(self) -> int:
        return self.follower.arm_side * self.follower.swing_sense

    @property
    def _axis(self) -> float:
        """Angle of the line from the pivot to the cam axis [rad]."""
        return phase(-self.follower.pivot)

    def lift_of(self, distance: FloatArray) -> FloatArray:
        """See `FacePath`."""
        follower = self.follower
        sine = (distance - follower.face_offset) / follower.centre_distance
        if np.any(~(np.abs(sine) <= 1.0 + ROUNDING)):
            raise GeometryError(
                "the rocker's face cannot lie on the contour all round: it reaches from"
                f" {np.min(distance):.6g} to {np.max(distance):.6g} mm from the cam axis, the face"
                f" from {follower.face_offset - follower.centre_distance:.6g} to"
                f" {follower.farthest:.6g} mm"
            )
        chi = np.arcsin(np.clip(sine, -1.0, 1.0))
        return np.asarray(self.outward * (chi - follower.start_angle))

    def angle_of(self, theta: FloatArray, lift: FloatArray) -> FloatArray:
        """See `FacePath`."""
        chi = self.follower.face_angle(lift)
        normal = self._axis + self.follower.arm_side * (chi + 0.5 * math.pi)
        return np.asarray(self.rotation * (normal - theta))

    def _seen(self, phi: FloatArray, centres: ComplexArray) -> ComplexArray:
        """The centres seen from the pivot, against the line to the cam axis."""
        turned = centres * np.exp(1j * (self.rotation * phi - self._axis))
        seen: ComplexArray = turned + self.follower.centre_distance
        return seen

    def jet(self, phi: FloatArray, centres: ComplexArray, radii: FloatArray) -> FloatArray:
        """See `FacePath`.

        With g = V'/V the rates of arg V and ln |V| are its imaginary and its real part.
        """
        follower, side = self.follower, self.follower.arm_side
        seen = self._seen(phi, centres)
        over = follower.face_offset - radii
        turned = seen - follower.centre_distance
        g = 1j * self.rotation * turned / seen
        share = turned / seen
        g1 = -share - g * g
        g2 = -g * (1.0 - share + 2.0 * g1)
        place = self.contact(phi, centres, radii)
        ratio = over / place
        square = (np.abs(seen) / place) ** 2
        chi = side * np.angle(seen) - np.arctan(ratio)
        first = side * g.imag + ratio * g.real
        bend = g1.real - square * g.real * g.real
        second = side * g1.imag + ratio * bend
        # ratio' = -square Re(g) ratio, square' = 2 square (1 - square) Re(g)
        turn = g2.real - 2.0 * square * g.real * (g1.real + (1.0 - square) * g.real * g.real)
        third = side * g2.imag + ratio * (turn - square * g.real * bend)
        return self.outward * np.stack((chi - follower.start_angle, first, second, third))

    def contact(self, phi: FloatArray, centres: ComplexArray, radii: FloatArray) -> FloatArray:
        """See `FacePath`."""
        away, over = np.abs(self._seen(phi, centres)), np.abs(self.follower.face_offset - radii)
        square = (away - over) * (away + over)
        return np.sqrt(np.where(square >= 0.0, square, np.nan))

    def turning(self, centres: ComplexArray) -> FloatArray:
        """See `FacePath`: with the centre on the line of centres, between axis and pivot first."""
        angle = self._axis + math.pi - np.angle(centres)
        return self.rotation * np.stack((angle, angle + math.pi))

    def wander(self, touch: Touch) -> FloatArray:
        """See `FacePath`: q = l_1 cos chi / tau."""
        return np.asarray(np.abs(touch.contact[0] / touch.turn[0]))


face_path_of.register(TranslatingFlat, GuidedFace)
face_path_of.register(OscillatingFlat, RockingFace)
