"""Pitch curve, the path of the roller centre in the turning cam, Z(phi), and its parallels.

For a flat face it is the path of the contact: the outline of the cam itself.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import wraps
from typing import Any, TypeVar, cast

import numpy as np
from numpy.typing import NDArray

from camgeo.errors import GeometryError
from camgeo.kinematics.mechanism.follower import Follower, RelativeJet, TangentJet, bend_of_path
from camgeo.kinematics.mechanism.values import Coordinate, able, sense
from camgeo.kinematics.motion import FULL_ORDER, MergedDwell, Motion
from camgeo.numeric.arrays import ComplexArray, FloatArray, Side, ascending, frozen
from camgeo.numeric.checked import CheckedFields, hold
from camgeo.numeric.kept import Kept, kept_with_owner
from camgeo.record import Pickled

# -- closure --------------------------------------------------------------------------------------
# Closure: how a curve joins at its breaks and after a full turn.


@dataclass(frozen=True, slots=True, eq=False)
class JointJumps:
    """What jumps at the joints of the turn, including cam angle 0.

    Attributes
    ----------
    phi : (m,) cam angles [rad].
    gaps : (m,) distance between the curve's two ends [mm].
    turns : (m,) angle between their two tangents [rad], in [0, pi].
    """

    phi: FloatArray
    gaps: FloatArray
    turns: FloatArray


@kept_with_owner
def joints(curve: PitchCurve) -> JointJumps:
    """Compare the one-sided values at each break of `curve` and at cam angle 0."""
    phi = ascending(np.append(curve.breaks, 0.0))
    right, left = curve.jet(phi, "right"), curve.jet(phi, "left")
    # The argument of the product is the angle from the left-hand to the right-hand tangent.
    turned = right[1] * np.conj(left[1])
    return JointJumps(
        phi=frozen(phi, np.float64),
        gaps=frozen(np.abs(right[0] - left[0]), np.float64),
        turns=frozen(np.abs(np.angle(turned)), np.float64),
    )


# -- blocks ---------------------------------------------------------------------------------------
# Long arrays evaluated in blocks that fit the processor's cache.


Method = TypeVar("Method", bound=Callable[..., NDArray[Any]])

BLOCK = 8192
"""Points per block: a dozen real arrays of that length fit into a second-level cache of 1 MB, and
the overhead of numpy's calls is spread over many points."""


def in_blocks(method: Method) -> Method:
    """`method(self, phi, side)`, (n,) -> (..., n), evaluated in blocks; a number becomes (1,).

    Or `method(self, low, high)`, of the cells between two arrays (n,).
    """

    @wraps(method)
    def whole(owner: Any, phi: FloatArray, side: Side | FloatArray = "right") -> NDArray[Any]:
        phi = np.atleast_1d(phi)
        if len(phi) <= BLOCK:
            return method(owner, phi, side)
        count = math.ceil(len(phi) / BLOCK)
        sides = [side] * count if isinstance(side, str) else np.array_split(side, count)
        # Split alike, so that each block has its own sides, or its own upper ends.
        blocks = zip(np.array_split(phi, count), sides, strict=True)
        return np.concatenate([method(owner, *block) for block in blocks], axis=-1)

    return cast("Method", whole)


# -- pitch curve ----------------------------------------------------------------------------------


STANDSTILL = 1e-13
"""|Z'| below this fraction of the base radius, per rad, is zero: its digits are rounding."""


@dataclass(frozen=True, slots=True)
class PitchCurve(Pickled):
    """Pitch curve in cam coordinates: origin in the cam axis, axes fixed in the cam that coincide
    with the frame's axes at cam angle 0 (Wirsig eqs. 2.44 to 2.52).

    Attributes
    ----------
    motion : the lift as the follower makes it.
    follower : from lift to roller centre.
    rotation : sigma, +1 if the cam turns counter-clockwise, -1 clockwise. The curve itself is
        traversed in the opposite sense, clockwise for sigma = +1.
    kept : the last result of each function of the curve, see `kept_with_owner`.

    Raises
    ------
    GeometryError
        With key "motion", "follower" or "cam.rotation", if that value is invalid.
    """

    motion: Motion
    follower: Follower
    rotation: int
    kept: Kept = field(default_factory=dict, init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        able("motion", self.motion, "jet_and_bounds", "a motion over the cam angle")
        able("follower", self.follower, "relative_jet", "a follower")
        hold(self, rotation=sense("cam.rotation", self.rotation))

    @property
    def breaks(self) -> FloatArray:
        """(m,) cam angles [rad] where a derivative up to Z''' may jump."""
        return self.motion.breaks

    @property
    def borders(self) -> FloatArray:
        """(k,) cam angles [rad] where the formula changes."""
        return self.motion.borders

    @property
    def dwells(self) -> tuple[MergedDwell, ...]:
        """Dwells: there the curve is an arc about the cam axis."""
        return self.motion.dwells

    def relative_jet(
        self, phi: FloatArray, side: Side = "right", order: int = FULL_ORDER
    ) -> RelativeJet:
        """R_0 to R_`order`, u, v at `phi` (n,) [rad], see `kinematics.mechanism.follower`."""
        # Some followers need the motion to a higher order than their own jet.
        jet = self.motion.jet(phi, side, min(order + self.follower.ahead, FULL_ORDER))
        return self.follower.relative_jet(jet, self.rotation, order)

    @in_blocks
    def jet(self, phi: FloatArray, side: Side = "right") -> ComplexArray:
        """(4, n) complex [mm/rad^k]: Z, Z', Z'', Z''' at the cam angles `phi` (n,) [rad].

        (3, n) for a flat face, which has no Z'''.
        """
        relative = self.relative_jet(phi, side)
        return self.in_cam(relative, phi, relative.along, relative.across)

    @in_blocks
    def point(self, phi: FloatArray, side: Side = "right") -> ComplexArray:
        """(n,) complex [mm]: Z at the cam angles `phi` (n,) [rad]."""
        relative = self.relative_jet(phi, side, order=1)
        return self.in_cam(relative, phi, relative.along[0], relative.across[0])

    def in_cam(
        self, relative: RelativeJet, phi: FloatArray, along: FloatArray, across: FloatArray
    ) -> ComplexArray:
        """Complex (..., n): vectors in the axes of `relative`, turned into those of the cam."""
        angle = relative.axis - self.rotation * phi
        cosine, sine = np.cos(angle), np.sin(angle)
        turned = np.empty(along.shape, dtype=np.complex128)
        np.subtract(along * cosine, across * sine, out=turned.real)
        np.add(along * sine, across * cosine, out=turned.imag)
        return turned

    @in_blocks
    def curvature(self, phi: FloatArray, side: Side = "right") -> FloatArray:
        """(n,) [1/mm] signed curvature, positive where the curve is convex; an inflection is 0.

        kappa = -sigma Im(conj(Z') Z'') / |Z'|^3 (Wirsig eq. 3.35, sign added). The tangent under a
        flat face is the face: kappa = (1 - sigma nu') / |Z'|.

        Raises
        ------
        GeometryError
            Where the roller centre stands still in the cam, Z' = 0: a cusp of the pitch curve.
        """
        relative = self.relative_jet(phi, side, order=2 - self.follower.ahead)
        return self.follower.curvature(relative, self.speed(relative), self.rotation)

    @in_blocks
    def curvature_slope(self, phi: FloatArray, side: Side = "right") -> FloatArray:
        """(n,) dkappa/dphi [1/(mm rad)] at `phi` (n,) [rad], by the chain rule."""
        motion = self.motion.jet(phi, side)
        # Called only for its error where the roller centre stands still.
        self.speed(self.follower.relative_jet(motion, self.rotation, 1))
        return curvature_slope(self.follower.tangent_jet(motion, self.rotation), self.rotation)

    @in_blocks
    def transmission_angle(self, phi: FloatArray, side: Side = "right") -> FloatArray:
        """(n,) [rad] in [0, pi/2]: acute angle between rocker, or guide normal, and curve normal.

        mu = atan2(|u|, |v|) (Wirsig section 3.3.4, corrected). Raises GeometryError where Z' = 0,
        for there is no normal.
        """
        relative = self.relative_jet(phi, side, order=1)
        self.speed(relative)
        return np.arctan2(np.abs(relative.u), np.abs(relative.v))

    @in_blocks
    def pressure_angle(self, phi: FloatArray, side: Side = "right") -> FloatArray:
        """(n,) [rad] in [0, pi/2]: pi/2 - mu, accurate where it is tiny."""
        relative = self.relative_jet(phi, side, order=1)
        self.speed(relative)
        return np.arctan2(np.abs(relative.v), np.abs(relative.u))

    @in_blocks
    def leverage(self, phi: FloatArray, side: Side = "right") -> FloatArray:
        """(n,) [1 or mm/rad] dn/dq: displacement of the roller centre along the outward normal of
        the pitch curve per unit of lift q, at `phi` (n,) [rad].

        A normal force N of the cam on the roller, positive outwards, does the work N dn on the
        follower, and requires the torque N dn/dq q' at the cam (principle of virtual work). The
        magnitude of dn/dq is sin mu, or l_3 sin mu for an oscillating follower; for a rocking flat
        face it is the lever of the contact about the pivot. It is positive where a positive lift
        moves the follower outwards. Raises GeometryError where Z' = 0.
        """
        relative = self.relative_jet(phi, side, order=1)
        return np.asarray(relative.reach * relative.u / self.speed(relative))

    def speed(self, relative: RelativeJet) -> FloatArray:
        """|Z'| (n,) [mm/rad], never zero.

        Raises
        ------
        GeometryError
            Where the roller centre stands still in the cam: the rocker lies on the line of centres
            and l_3 (1 - sigma psi') = l_1 (hard case HC18); or where the contact of a flat face
            does.
        """
        size = np.sqrt(relative.u * relative.u + relative.v * relative.v)
        if np.any(size <= STANDSTILL * self.follower.base_radius):
            raise GeometryError(self.follower.standstill)
        return size

    @in_blocks
    def speed_bounds(self, low: FloatArray, high: FloatArray) -> FloatArray:
        """(3, n) upper bounds of |Z'|, |Z''|, |Z'''| over cells [low, high] (n,) [rad]."""
        middle, bounds = self.motion.jet_and_bounds(low, high)
        return self.follower.speed_bounds(middle, bounds, 0.5 * (high - low), self.rotation)

    def jet_and_bounds(self, low: FloatArray, high: FloatArray) -> tuple[ComplexArray, FloatArray]:
        """(4, n) Z to Z''' in the middle of the cells [low, high] (n,) [rad], and `speed_bounds`.

        (3, n) for a flat face, as `jet`. The motion, most of the work, is evaluated once for both.
        """
        middle, bounds = self.motion.jet_and_bounds(low, high)
        relative = self.follower.relative_jet(middle, self.rotation)
        jet = self.in_cam(relative, 0.5 * (low + high), relative.along, relative.across)
        half = 0.5 * (high - low)
        return jet, self.follower.speed_bounds(middle, bounds, half, self.rotation)


def curvature_slope(tangent: TangentJet, rotation: int) -> FloatArray:
    """dkappa/dphi (n,) [1/(mm rad)].

    kappa = (1 - sigma (turning + q)) / |Z'| with q = (u w' - w u') / |Z'|^2: the tangent turns with
    the cam, with the follower, and relative to the follower. Every part of the slope vanishes at
    rest, so nothing cancels where the motion is small.
    """
    (u, u1), (w, w1) = tangent.u, tangent.w
    square = u * u + w * w
    # growth is |Z'| |Z'|', as |Z'|^2 = u^2 + w^2.
    growth = u * u1 + w * w1
    relative_turning = (u * w1 - w * u1) / square
    slope: FloatArray = (
        rotation * growth * (3.0 * relative_turning + tangent.turning) - tangent.swerve
    )
    slope /= square * np.sqrt(square)
    return slope


# -- working curve ---------------------------------------------------------------------------------
# Working curves and other offsets: parallels of the pitch curve.
#
# One scalar characterizes an offset by d: 1 + d kappa. It is positive where the offset is regular,
# zero at a cusp and negative in undercut. The inner working curve is the offset by -r_R, the outer
# one by +r_R; the path of a cutter is another offset.


@dataclass(frozen=True, slots=True)
class WorkingCurve(Pickled, CheckedFields):
    """The parallel of a pitch curve at a signed distance (Wirsig eqs. 2.53, 2.54, sign corrected).

    With t = Z'/|Z'| the outward normal is n = i sigma t, and the curve is Z + d n: outward means
    away from the cam axis, also where the polar angle runs backwards.

    Attributes
    ----------
    pitch : the pitch curve.
    distance : d [mm], positive outward; -r_R gives the inner, +r_R the outer working curve.
    kept : the last result of each function of the curve, see `kept_with_owner`.

    Raises
    ------
    GeometryError
        With key "pitch" or "distance", if that value is invalid.
    """

    pitch: PitchCurve
    distance: Coordinate
    kept: Kept = field(default_factory=dict, init=False, repr=False, compare=False)

    @property
    def breaks(self) -> FloatArray:
        """(m,) cam angles [rad] where a derivative may jump."""
        return self.pitch.breaks

    @property
    def borders(self) -> FloatArray:
        """(k,) cam angles [rad] where the formula changes."""
        return self.pitch.borders

    @property
    def dwells(self) -> tuple[MergedDwell, ...]:
        """Dwells: arcs about the cam axis."""
        return self.pitch.dwells

    @in_blocks
    def point(self, phi: FloatArray, side: Side = "right") -> ComplexArray:
        """(n,) complex [mm] points at the cam angles `phi` (n,) [rad]."""
        if self.distance == 0.0:
            return self.pitch.point(phi, side)
        relative = self.pitch.relative_jet(phi, side, order=1)
        along, across = self.offset_parts(relative, self.pitch.speed(relative))
        return self.pitch.in_cam(relative, phi, along, across)

    def offset_parts(
        self, relative: RelativeJet, speed: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """Components (n,), (n,) [mm] of the curve's points in the axes of `relative`."""
        scale = (self.distance * self.pitch.rotation) / speed
        along = relative.along[0] - scale * relative.across[1]
        across = relative.across[0] + scale * relative.along[1]
        return along, across

    @in_blocks
    def tangent(self, phi: FloatArray, side: Side = "right") -> ComplexArray:
        """(n,) complex unit tangents of the pitch curve, in the direction of increasing cam angle.

        They are those of this curve wherever it is regular; in undercut it runs against them.
        """
        relative = self.pitch.relative_jet(phi, side, order=1)
        speed = self.pitch.speed(relative)
        along, across = relative.along[1] / speed, relative.across[1] / speed
        return self.pitch.in_cam(relative, phi, along, across)

    def regularity(self, phi: FloatArray, side: Side = "right") -> FloatArray:
        """(n,) 1 + d kappa: positive where regular, 0 at a cusp, negative in undercut."""
        return 1.0 + self.distance * self.pitch.curvature(phi, side)

    def curvature(self, phi: FloatArray, side: Side = "right") -> FloatArray:
        """(n,) [1/mm] signed curvature kappa / (1 + d kappa); the curve must be regular there."""
        kappa = self.pitch.curvature(phi, side)
        return kappa / (1.0 + self.distance * kappa)

    def points_and_tangents(self, phi: FloatArray) -> tuple[ComplexArray, ComplexArray]:
        """`point` and `tangent` (n,) at `phi` (n,) [rad], right-hand, from one evaluation.

        Not in blocks, like `traced`; needs no curvature.
        """
        pitch = self.pitch
        relative = pitch.relative_jet(phi, order=1)
        speed = pitch.speed(relative)
        along, across = self.offset_parts(relative, speed)
        # Points and tangents are stacked, so that one call turns both into the axes of the cam.
        parts = np.stack((along, relative.along[1] / speed))
        others = np.stack((across, relative.across[1] / speed))
        points, tangents = pitch.in_cam(relative, phi, parts, others)
        return points, tangents

    def traced(
        self, phi: FloatArray, side: Side = "right"
    ) -> tuple[ComplexArray, ComplexArray, FloatArray]:
        """`point`, `tangent` and pace (n,) at `phi` (n,) [rad], for little more than one of them.

        The pace is ds/dphi = |Z'| (1 + d kappa) [mm/rad], negative in undercut. Not in blocks: for
        up to some thousand points, where calls cost more than arithmetic.
        """
        pitch = self.pitch
        relative = pitch.relative_jet(np.atleast_1d(phi), side, order=2)
        speed = pitch.speed(relative)
        jet = pitch.in_cam(relative, phi, relative.along[:2], relative.across[:2])
        tangents = jet[1] / speed
        points = jet[0]
        if self.distance != 0.0:
            # The outward normal is n = i sigma t.
            points = points + (1j * pitch.rotation * self.distance) * tangents
        kappa = bend_of_path(relative, speed, pitch.rotation)
        return points, tangents, speed * (1.0 + self.distance * kappa)
