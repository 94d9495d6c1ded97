"""The motion that the contour makes as it is written into a file: its lines, arcs or cubics.

A written contour keeps to the exact curve within a tolerance, and its tangents and curvatures less
and less closely: the lift is off by the tolerance over the sine of the transmission angle, the
acceleration by the error of the curvature.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Final

import numpy as np

from camgeo.cam.cam import Cam
from camgeo.cam.drive import smooth_angles
from camgeo.contour.contour import Contour
from camgeo.contour.spline import SplineContour
from camgeo.curve.pitch_curve import PitchCurve
from camgeo.motion.kept import Answers
from camgeo.motion.motion import FULL_ORDER, Dwell, Jet, Motion
from camgeo.motion.time_course import TimeCourse, TimeExtremes, time_extremes
from camgeo.numeric.arrays import BoolArray, FloatArray, IntArray, Side, read_only
from camgeo.outline.replay_result import DiscLift, Replay
from camgeo.state.face_curve import FaceCurve
from camgeo.state.far import FarMotion
from camgeo.state.state import Model
from camgeo.units import TURN

KEY: Final = "state.motion"
MODEL: Final = "written"

RESTING = 1e-10
"""A piece over which the derivatives of the lift are below this share of the largest of the turn is
an arc about the cam axis: the follower rests."""


@dataclass(frozen=True)
class WrittenMotion:
    """The motion of a follower on a contour of pieces, without linkage; see `Motion`.

    Attributes
    ----------
    lift : on the contour, with all its pieces.
    """

    lift: DiscLift
    _jets: Answers[Jet] = field(default_factory=Answers, init=False, repr=False, compare=False)

    @property
    def breaks(self) -> FloatArray:
        """See `Motion`: where the follower passes from piece to piece."""
        return self.lift.borders

    @property
    def borders(self) -> FloatArray:
        """See `Motion`."""
        return self.lift.borders

    @cached_property
    def _rests(self) -> BoolArray:
        """(k,) whether the follower rests from each of the borders to the next."""
        starts = self.lift.borders
        middles = 0.5 * (starts + np.append(starts[1:], starts[0] + TURN))
        rates = np.abs(self.lift.jet(middles, "right", 3)[1:])
        most = np.max(rates, axis=1, keepdims=True)
        found: BoolArray = np.all(rates <= RESTING * most, axis=0)
        return found

    @cached_property
    def dwells(self) -> tuple[Dwell, ...]:
        """See `Motion`."""
        starts, rests = self.lift.borders, self._rests
        if np.all(rests):
            return (Dwell(0.0, TURN),)
        firsts = np.flatnonzero(rests & ~np.roll(rests, 1))
        ends = np.flatnonzero(~rests & np.roll(rests, 1))
        found = []
        for first in firsts.tolist():
            end = ends[np.argmin(np.remainder(ends - first, len(starts)))]
            span = float(starts[end] - starts[first]) % TURN
            found.append(Dwell(float(starts[first]), span))
        return tuple(found)

    def jet(self, phi: FloatArray, side: Side = "right", order: int = FULL_ORDER) -> Jet:
        """See `Motion`; the derivatives of a rest are 0, without rounding.

        Read-only, and the same values for recent requests, like those of a plan.
        """

        def made() -> Jet:
            jet = self.lift.jet(phi, side, 3)
            jet[1:, self._rests[self.piece(phi, side)]] = 0.0
            return read_only(jet)

        return self._jets.recall(made, side, phi)[: order + 1]

    def piece(self, phi: FloatArray, side: Side) -> IntArray:
        """(n,) number of the range between borders at `phi` (n,) [rad], from 0."""
        found = np.searchsorted(self.lift.borders, np.remainder(phi, TURN), side) - 1
        return np.asarray(found, dtype=np.intp)

    def on_corner(self, phi: FloatArray, side: Side) -> BoolArray:
        """(n,) whether a vertex of the contour holds the follower at `phi` (n,) [rad]."""
        elements, _ = self.lift.held_by(self.lift.number(phi, side))
        return np.asarray(elements < 0)

    def jet_and_bounds(self, low: FloatArray, high: FloatArray) -> tuple[Jet, Jet]:
        """See `Motion`: without any bound."""
        jet = self.jet(0.5 * (low + high))
        return jet, np.full_like(jet, np.inf)


@dataclass(frozen=True)
class Written:
    """The motion on a written contour; see `camgeo.state.state.State`.

    The roller touches a vertex of the contour as it does a piece, along the normal of the path of
    its centre. A flat face touches the convex hull of the contour, see `camgeo.outline.face_hull`.

    Attributes
    ----------
    cam : that sees the motion.
    contour : as files have it.
    replay : of the contour; the lift does not jump.
    deviation : proved, of the contour from the exact curve [mm].
    sense : see `State`.
    course : how the cam turns; None if that is not known.
    touches : whether it is this cam's contour, not that of the other disc of a pair.
    """

    cam: Cam
    contour: Contour | SplineContour
    replay: Replay
    deviation: float
    sense: int
    course: TimeCourse | None
    touches: bool = True

    @property
    def model(self) -> Model:
        """See `State`."""
        return MODEL

    @cached_property
    def motion(self) -> WrittenMotion:
        """See `State`."""
        return WrittenMotion(self.replay.lift)

    @cached_property
    def output(self) -> Motion:
        """See `State`."""
        drive = self.cam.drive
        if drive.linkage is None:
            return self.motion
        return FarMotion(self.motion, drive.linkage, drive.plan)

    @cached_property
    def smooth_angles(self) -> FloatArray:
        """See `State`."""
        return smooth_angles(self.motion, self.course)

    @property
    def order(self) -> int:
        """See `State`: from piece to piece the acceleration jumps. The cubics within a spline pass
        it on, but not across its ends, even if the contour is one spline that closes on itself.
        """
        return 0 if self.shocks else 1

    @property
    def shocks(self) -> tuple[float, ...]:
        """See `State`: where the roller touches two pieces in a corner that turns in, and where a
        flat face lies on a straight piece or bridges a hollow.
        """
        return tuple(self.replay.shocks.phi.tolist())

    @cached_property
    def curve(self) -> PitchCurve:
        """See `State`."""
        kind = PitchCurve if self.cam.follower.has_pitch_curve else FaceCurve
        return kind(self.motion, self.cam.follower, self.cam.rotation)

    def on_corner(self, phi: FloatArray, side: Side) -> BoolArray:
        """See `State`; another contour than the one of the motion is taken to be whole."""
        if not self.touches:
            return np.zeros(len(phi), dtype=np.bool_)
        return self.motion.on_corner(phi, side)

    def output_extremes(self, course: TimeCourse) -> TimeExtremes:
        """See `State`."""
        return time_extremes(self.output, course, self.cam.drive.unit)

    def turning(self, course: TimeCourse) -> Written:
        """See `State`."""
        return replace(self, course=course)
