"""Working curves and other offsets: parallels of the pitch curve.

One scalar characterizes an offset by d: 1 + d kappa. It is positive where the offset is regular,
zero at a cusp and negative in undercut. The inner working curve is the offset by -r_R, the outer
one by +r_R; the path of a cutter is another offset.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from camgeo.geometry.pitch_curve import PitchCurve, in_blocks
from camgeo.kinematics.mechanism.follower import RelativeJet, bend_of_path
from camgeo.kinematics.mechanism.values import Coordinate
from camgeo.kinematics.motion import Dwell
from camgeo.numeric.arrays import ComplexArray, FloatArray, Side
from camgeo.numeric.checked import CheckedFields
from camgeo.numeric.kept import Kept
from camgeo.record import Pickled


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
    def dwells(self) -> tuple[Dwell, ...]:
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
            points = points + (1j * pitch.rotation * self.distance) * tangents
        kappa = bend_of_path(relative, speed, pitch.rotation)
        return points, tangents, speed * (1.0 + self.distance * kappa)
