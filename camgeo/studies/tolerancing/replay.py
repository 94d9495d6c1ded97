"""The motion of machines that deviate, on the flank that their cam was made with.

At each cam angle two equations are solved by Newton's method, for the parameter u of the place on
the flank and the lift q: the centre of a roller lies on the curve of `FlankCurve`, R(u) = W(q); a
flat face, a line through W(q) with the normal n(q), touches it,

    n . (R(u) - W(q)) = 0, n . R'(u) = 0.

Velocity and acceleration follow by differentiating these along the cam angle.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from functools import singledispatch
from typing import Final

import numpy as np

from camgeo.errors import GeometryError
from camgeo.geometry.pitch_curve import PitchCurve, curvature_slope
from camgeo.kinematics.mechanism.face import FlatFollower
from camgeo.kinematics.mechanism.follower import Follower, WithRoller
from camgeo.numeric.arrays import ComplexArray, FloatArray, dot
from camgeo.studies.tolerancing.sensitivity import Sensitivities
from camgeo.studies.tolerancing.sources import Deviations, Pose, Way

STEPS: Final = 20
"""Of Newton's method, which needs three or four."""

SETTLED: Final = 1e-13
"""Last step of the lift, relative to the base radius or to 1 rad; what remains is its square."""

FARTHEST: Final = 0.5
"""How far [rad] the contact may move along the flank: beyond, it is another one."""

BLOCK: Final = 16384
"""Machines times cam angles that are computed together."""

LOST: Final = (
    "a machine within the tolerances has no contact near the nominal one, at cam angle {:.6g} deg:"
    " the tolerances are too large"
)

HOLLOW: Final = (
    "a flat face cannot touch all of a flank that waves make hollow: make them lower, or fewer"
)


@dataclass(frozen=True, slots=True, eq=False)
class Placed:
    """The cam at cam angles: R and its derivatives along the flank, and with the cam angle.

    Attributes
    ----------
    place, along, bend : (m, n) R, dR/du and d^2R/du^2 [mm].
    spin : i sigma, with which the cam turns.
    axis : (m, 1) the cam axis [mm].
    """

    place: ComplexArray
    along: ComplexArray
    bend: ComplexArray
    spin: complex
    axis: ComplexArray

    @property
    def sweep(self) -> ComplexArray:
        """(m, n) dR/dphi [mm/rad]."""
        return self.spin * (self.place - self.axis)


class Touching(ABC):
    """How a follower touches the curve.

    Attributes
    ----------
    pose : of the roller centre, or of a point on the face.
    normal : (1, 1) or (m, 1) of a flat face at lift 0, away from the cam axis.
    """

    def __init__(self, pose: Pose, normal: ComplexArray) -> None:
        self.pose = pose
        self.normal = normal

    @abstractmethod
    def require_reach(self, cam: Placed) -> None:
        """GeometryError if the follower cannot touch the curve at all of these places."""

    @abstractmethod
    def step(self, cam: Placed, q: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Newton's steps of u and q (m, n)."""

    @abstractmethod
    def rates(self, cam: Placed, q: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """(m, n) velocity and acceleration of the lift, per unit of the cam angle, and the
        magnitude of n . dW/dq [1 or mm/rad].
        """

    @abstractmethod
    def radius(self, q: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Distance [mm] from the origin, as of the base radius, and its rate with the lift."""


class Rolling(Touching):
    """A roller's centre lies on the curve."""

    def require_reach(self, cam: Placed) -> None:
        """See `Touching`: it can, wherever the curve is smooth."""

    def step(self, cam: Placed, q: FloatArray) -> tuple[FloatArray, FloatArray]:
        """See `Touching`."""
        place = self.pose.at(q)
        speed = self.pose.velocity(place)
        apart = cam.place - place
        normal, pace = _normal(cam.along)
        dq = dot(normal, apart) / dot(normal, speed)
        du = dot(cam.along, dq * speed - apart) / (pace * pace)
        return du, dq

    def rates(self, cam: Placed, q: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """See `Touching`."""
        place = self.pose.at(q)
        speed, swerve = self.pose.velocity(place), self.pose.acceleration(place)
        normal, pace = _normal(cam.along)
        steep = dot(normal, speed)
        first = dot(normal, cam.sweep) / steep
        du = dot(cam.along, first * speed - cam.sweep) / (pace * pace)
        rest = -(cam.place - cam.axis) + 2.0 * cam.spin * cam.along * du + cam.bend * du * du
        second = dot(normal, rest - swerve * first * first) / steep
        return first, second, np.abs(steep)

    def radius(self, q: FloatArray) -> tuple[FloatArray, FloatArray]:
        """See `Touching`."""
        place = self.pose.at(q)
        size = np.abs(place)
        return size, dot(place, self.pose.velocity(place)) / size


class Flat(Touching):
    """A flat face is tangent to the curve."""

    def require_reach(self, cam: Placed) -> None:
        """See `Touching`: the curve, along which n = i sigma t, is bent inward everywhere."""
        if not np.all(dot(cam.spin * cam.along, cam.bend) < 0.0):
            raise GeometryError(HOLLOW)

    def step(self, cam: Placed, q: FloatArray) -> tuple[FloatArray, FloatArray]:
        """See `Touching`."""
        normal = self.normal * self.pose.turned(q)
        turning = 1j * self.pose.spin * normal
        apart = dot(normal, cam.place - self.pose.at(q))
        closing = -dot(normal, self.pose.velocity(cam.place))
        slope, tilt = dot(normal, cam.along), dot(turning, cam.along)
        bend = dot(normal, cam.bend)
        det = slope * tilt - closing * bend
        du = (closing * slope - tilt * apart) / det
        dq = (bend * apart - slope * slope) / det
        return du, dq

    def rates(self, cam: Placed, q: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """See `Touching`."""
        normal = self.normal * self.pose.turned(q)
        turning = 1j * self.pose.spin * normal
        closing = -dot(normal, self.pose.velocity(cam.place))
        first = -dot(normal, cam.sweep) / closing
        tilt = dot(turning, cam.along)
        swept = dot(normal, cam.spin * cam.along)
        bend = dot(normal, cam.bend)
        if not np.all(bend < 0.0):
            raise GeometryError(HOLLOW)
        du = -(swept + tilt * first) / bend
        pull = dot(turning, self.pose.velocity(cam.place))
        second = -dot(normal, cam.place - cam.axis) + swept * du
        second += 2.0 * dot(turning, cam.sweep) * first + tilt * du * first - pull * first * first
        return first, -second / closing, np.abs(closing)

    def radius(self, q: FloatArray) -> tuple[FloatArray, FloatArray]:
        """See `Touching`."""
        normal = self.normal * self.pose.turned(q)
        place = self.pose.at(q)
        rate = dot(normal, self.pose.velocity(place))
        return dot(normal, place), rate + dot(1j * self.pose.spin * normal, place)


@singledispatch
def touching(follower: Follower, pose: Pose, deviations: Deviations) -> Touching:
    """How the followers (m, ...) of machines touch the cam; `pose` is that of the nominal one."""
    del pose, deviations  # used by the registered ones
    message = f'of the kind "{follower.kind}" is not known to the analysis of tolerances'
    raise GeometryError(message, key="follower.kind")


@touching.register
def _(_: WithRoller, pose: Pose, deviations: Deviations) -> Touching:
    return Rolling(_placed(pose, deviations), np.ones((1, 1), complex))


@touching.register
def _(follower: FlatFollower, pose: Pose, deviations: Deviations) -> Touching:
    normal = follower.normal(np.zeros(1))[np.newaxis]
    turn = np.exp(1j * deviations.real(Way.TILT))
    return Flat(_placed(pose, deviations), normal * turn)


def _placed(pose: Pose, deviations: Deviations) -> Pose:
    held = pose.moved(deviations.of(Way.PIVOT), whole=True).moved(deviations.of(Way.BODY))
    return held.rotated(np.exp(1j * deviations.real(Way.TILT)))


@dataclass(frozen=True, slots=True, eq=False)
class Replayed:
    """The motions of m machines at n cam angles; derivatives per rad of the cam angle.

    Attributes
    ----------
    follower : (3, m, n) its lift [mm or rad], counted from the nominal zero, and two derivatives.
    position : (3, m, n) of the far end of a linkage, or of the follower if there is none.
    leverage : (m, n) magnitude of n . dW/dq [1 or mm/rad].
    zero : (m, 1) lift at the deviating base radius, from which the others are counted.
    """

    follower: FloatArray
    position: FloatArray
    leverage: FloatArray
    zero: FloatArray


def replayed(nominal: Sensitivities, deviations: Deviations) -> Replayed:
    """The motions of machines that deviate.

    Raises
    ------
    GeometryError
        If a machine has no contact near the nominal one, undercuts, or its linkage does not close.
    """
    machine = nominal.machine
    deviations = deviations.met_by(machine.hold, half_turn=machine.half_turn)
    size = max(1, BLOCK // len(nominal.phi))
    parts = []
    for first in range(0, deviations.count, size):
        some = {key: each[first : first + size] for key, each in deviations.values.items()}
        count = min(size, deviations.count - first)
        parts.append(_block(nominal, Deviations(count, some)))
    return Replayed(
        np.concatenate([each.follower for each in parts], axis=1),
        np.concatenate([each.position for each in parts], axis=1),
        np.concatenate([each.leverage for each in parts]),
        np.concatenate([each.zero for each in parts]),
    )


def _block(nominal: Sensitivities, deviations: Deviations) -> Replayed:
    machine = nominal.machine
    follower = machine.cam.follower
    found = touching(follower, machine.pose, deviations)
    lifts, leverage = _follower(nominal, deviations, found)
    zero = _setting(touching(follower, machine.pose, Deviations(1, {})), deviations, follower)
    lifts[0] -= zero
    if nominal.far_end is None:
        return Replayed(lifts, lifts, leverage, zero)
    start = np.broadcast_to(nominal.positions[0], lifts[0].shape)
    position = nominal.far_end.deviating(deviations).follow(lifts, start)
    return Replayed(lifts, position, leverage, zero)


def _follower(
    nominal: Sensitivities, deviations: Deviations, found: Touching
) -> tuple[FloatArray, FloatArray]:
    """(3, m, n) lift and two derivatives, counted from the nominal zero; and the leverage."""
    machine, phi = nominal.machine, nominal.phi
    disc = machine.cam.disc
    curve = FlankCurve(disc.pitch_curve, deviations)
    spin = 1j * disc.rotation
    turn = np.exp(spin * (phi + deviations.real(Way.TIMING)))
    seat, axis = deviations.of(Way.SEAT), deviations.of(Way.SHAFT)
    shape = (deviations.count, len(phi))
    u = np.broadcast_to(phi, shape) + deviations.real(Way.TIMING)
    q = np.broadcast_to(nominal.lifts[0], shape).copy()
    scale = SETTLED * machine.cam.follower.lift_scale
    last = np.inf
    for _ in range(STEPS):
        point, along, bend = curve.at(u)
        cam = Placed(axis + turn * (point + seat), turn * along, turn * bend, spin, axis)
        if last == np.inf:
            found.require_reach(cam)
        if last <= scale:
            first, second, leverage = found.rates(cam, q)
            return np.stack((q, first, second)), leverage
        with np.errstate(divide="ignore", invalid="ignore"):
            du, dq = found.step(cam, q)
        u, q = u + du, q + dq
        lost = ~(np.abs(u - phi) < FARTHEST)
        if np.any(lost):
            break
        last = max(float(np.max(np.abs(dq))), float(np.max(np.abs(du))) ** 2)
    off = np.where(np.any(lost), lost, np.abs(dq))  # where nothing is lost it does not settle
    place = float(np.degrees(phi[int(np.argmax(np.max(off, axis=0)))]))
    raise GeometryError(LOST.format(place))


def _setting(nominal: Touching, deviations: Deviations, follower: Follower) -> FloatArray:
    """(m, 1) lifts of the nominal follower at which the radii are the deviating base radii."""
    aimed = follower.base_radius + deviations.real(Way.SETTING)
    q = np.zeros_like(aimed)
    if not np.any(deviations.real(Way.SETTING)):
        return q
    for _ in range(STEPS):
        radius, rate = nominal.radius(q)
        with np.errstate(divide="ignore", invalid="ignore"):
            step = (aimed - radius) / rate
        q = q + step
        if np.all(np.abs(step) <= SETTLED * follower.lift_scale):
            return q
    message = "a machine within the tolerances would have one that its follower cannot reach"
    raise GeometryError(message, key="follower.base_radius")


def _normal(along: ComplexArray) -> tuple[ComplexArray, FloatArray]:
    """Unit normals of a curve, to either side, and its pace."""
    pace = np.abs(along)
    return 1j * along / pace, pace


# -- flank curve ----------------------------------------------------------------------------------
# The curve on which machines touch the cam: the pitch curve, grown and waved.
#
# With the pitch curve Z(u), its unit tangent t and normal N = i sigma t, its pace v = |Z'| and its
# curvature kappa, P = Z + c N has
#
#     P'  = v (1 + c kappa) t + c' N,
#     P'' = (v' (1 + c kappa) + v c kappa' + 2 v c' kappa) t + (c'' - v^2 kappa (1 + c kappa)) N.


@dataclass(frozen=True, slots=True, eq=False)
class FlankCurve:
    """The curves of m machines.

    Attributes
    ----------
    pitch : the nominal one.
    deviations : of the machines.
    """

    pitch: PitchCurve
    deviations: Deviations

    def at(self, u: FloatArray) -> tuple[ComplexArray, ComplexArray, ComplexArray]:
        """(m, n) each: P [mm] and two derivatives at the parameters u (m, n) [rad].

        Raises
        ------
        GeometryError
            Where a roller that is too large, or waves, undercut.
        """
        pitch, angles = self.pitch, u.ravel()
        follower, rotation = pitch.follower, pitch.rotation
        motion = pitch.motion.jet(angles)
        relative = follower.relative_jet(motion, rotation, 2)
        jet = pitch.in_cam(relative, angles, relative.along[:3], relative.across[:3])
        z, z1, z2 = jet.reshape(3, *u.shape)
        grown = self._growth(u)
        if grown is None:
            return z, z1, z2
        c, c1, c2 = grown
        v = np.abs(z1)
        kappa = follower.curvature(relative, v.ravel(), rotation).reshape(u.shape)
        slope = curvature_slope(follower.tangent_jet(motion, rotation), rotation).reshape(u.shape)
        t = z1 / v
        normal = 1j * rotation * t
        whole = 1.0 + c * kappa
        if not np.all(whole > 0.0):
            raise GeometryError(
                "within the tolerances the follower undercuts: a larger roller or a wave of the"
                " flank leaves no smooth curve; make the tolerances, or the waves, smaller"
            )
        first = v * whole * t + c1 * normal
        second = (dot(t, z2) * whole + v * c * slope + 2.0 * v * c1 * kappa) * t
        second += (c2 - v * v * kappa * whole) * normal
        return z + c * normal, first, second

    def _growth(self, u: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray] | None:
        """c [mm] and two derivatives; None if there is none anywhere."""
        growth, waves = self.deviations.real(Way.GROWTH), self.deviations.waves
        if not waves and not np.any(growth):
            return None
        c, c1, c2 = growth + np.zeros_like(u), np.zeros_like(u), np.zeros_like(u)
        for k, amplitude in waves.items():
            wave = amplitude * np.exp(-1j * k * u)
            c += wave.real
            c1 += k * wave.imag
            c2 -= k * k * wave.real
        return c, c1, c2
