"""The path of the contact of a flat face on a contour with vertices, on which it stands still."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from camgeo.curve.pitch_curve import PitchCurve
from camgeo.mechanism.face import FlatFollower, flat_follower
from camgeo.mechanism.follower import RelativeJet
from camgeo.motion.motion import FULL_ORDER, Jet
from camgeo.numeric.arrays import FloatArray, Side

POINT: Final = 1e-9
"""Radius, over the base radius, of the arc for which a vertex counts: far above the rounding of the
contact's pace, and far below any radius that is made."""


@dataclass(frozen=True, slots=True)
class FaceCurve(PitchCurve):
    """The path of the contact of a flat face that is pressed against a contour.

    On a vertex the contact stands still, and the path has no tangent of its own there, but the
    contact has one: the face. So the pace p (`camgeo.mechanism.face`) is not below that on an arc
    of the radius `POINT` r_b.
    """

    def relative_jet(
        self, phi: FloatArray, side: Side = "right", order: int = FULL_ORDER
    ) -> RelativeJet:
        """See `PitchCurve`; u, v and R_1 have the direction of the face everywhere."""
        follower = flat_follower(self.follower)
        jet = self._moving(follower, self.motion.jet(phi, side))
        return follower.relative_jet(jet, self.rotation, order)

    def _moving(self, follower: FlatFollower, jet: Jet) -> Jet:
        """The jet (4, n) with the second derivative that gives at least the least pace, to which
        it is in proportion.
        """
        touch = follower.touch(jet, self.rotation)
        lacking = POINT * follower.base_radius * touch.turn[0] - touch.pace[0]
        short = lacking > 0.0
        if not np.any(short):
            return jet
        more = jet[:, short]
        more[2] += 1.0
        gain = follower.touch(more, self.rotation).pace[0] - touch.pace[0][short]
        moved = jet.copy()
        moved[2, short] += lacking[short] / gain
        return moved
