"""What a linkage is: a motion from a motion, as long as it closes.

At one end of a linkage a member makes the motion that the scene demands: a slider, a lever or a
crank. At the other end is the follower, on a pivot or on a guide, whose motion the linkage computes
backwards. Positions of the demanded motion are in mm for a slider and in rad for what turns.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final, Literal, Protocol

import numpy as np

from camgeo.errors import GeometryError
from camgeo.kinematics.mechanism.sketch import MechanismSketch, Places
from camgeo.kinematics.motion import FULL_ORDER, Jet, pieces, turning_angles
from camgeo.numeric.arrays import BoolArray, ComplexArray, FloatArray, IntArray, merged, read_only
from camgeo.numeric.extremes import bracketed_roots
from camgeo.numeric.kept import Answers, kept_with_owner
from camgeo.units import LiftUnit

if TYPE_CHECKING:
    from camgeo.kinematics.motion import Motion
    from camgeo.kinematics.plan import MotionPlan


Member = Literal["slider", "lever", "crank"]

Size = Literal["crank", "coupler"]

OUT, BACK = 0, 1
"""Ways of the force through a linkage: from the follower to the far end, and from there back."""


class Linkage(Protocol):
    """A linkage with a crank and a coupler; lengths in mm.

    Attributes
    ----------
    crank, coupler : their lengths.
    member : whose motion is demanded.
    unit : of the demanded positions.
    coupler_tilt : angle between the coupler at position 0 and the direction that the definition of
        the dimensions gives it [rad], in [0, pi/2].
    """

    @property
    def crank(self) -> float: ...

    @property
    def coupler(self) -> float: ...

    @property
    def member(self) -> Member: ...

    @property
    def unit(self) -> LiftUnit: ...

    @property
    def coupler_tilt(self) -> float: ...

    def transform(self, jet: Jet, order: int = FULL_ORDER) -> Jet:
        """(order + 1, n) the follower's motion for demanded positions and derivatives `jet` (4, n).

        Measured from the demanded position 0; a rocker's angle is positive counter-clockwise.
        order is at least 1. GeometryError with key "linkage" at a dead centre not passed at rest.
        """

    def transform_bounds(self, jet: Jet, bounds: Jet) -> Jet:
        """(4, n) bounds for the follower of what `Motion.jet_and_bounds` bounds for `jet`, the
        demanded motion in the middle of each cell; infinite where a cell may touch a dead centre.
        """

    def missing_length(self, position: FloatArray) -> FloatArray:
        """(n,) [mm] by how much the linkage fails to close; <= 0 where it closes, 0 at a dead
        centre.
        """

    def turning_positions(self, low: float, high: float) -> tuple[float, ...]:
        """The positions in [low, high] at which the missing length may have an extreme."""

    def dead_positions(self, low: float, high: float) -> tuple[float, ...]:
        """The positions in [low, high] at which the missing length is 0."""

    def size_limits(self, size: Size, low: float, high: float) -> tuple[float, ...]:
        """Lengths [mm] of that member at which the linkage just closes at one position of the
        range.

        With all other lengths unchanged. Between two neighbouring values the linkage closes at all
        positions in [low, high] for every length, or for none. Empty if they are not known.
        """

    def resized(self, size: Size, length: float) -> Linkage:
        """The linkage with another `length` [mm] of that member, everything else unchanged.

        GeometryError with key "linkage" if it does not close at position 0.
        """

    def joints(self, position: FloatArray) -> tuple[ComplexArray, ComplexArray]:
        """The coupler's far pin P and the crank's tip T (n,) [mm], seen from the crank's shaft with
        axes as in the drawing of the cam.
        """

    def sketch(
        self, place: complex, outward: complex, position: FloatArray
    ) -> MechanismSketch[Places]:
        """The linkage with its far end at `position` (n,) [mm or rad], in the frame of the cam.

        `place` and `outward` are as of `Follower.linked_at`.
        """

    def joint_rates(
        self, position: FloatArray, demanded: FloatArray, own: FloatArray
    ) -> tuple[ComplexArray, ComplexArray]:
        """(2, n) first and second derivatives of P and of T.

        With respect to the same variable as those of the demanded coordinate and of the
        follower's `own`, both (2, n).
        """

    def transmission_sines(self, position: FloatArray) -> FloatArray:
        """(2, n) sines of the transmission angles, by the way of the force.

        `OUT` is between coupler and far member, `BACK` between coupler and the follower's member:
        a crank or lever itself, or the perpendicular to the guide of a slider. Each changes its
        sign where its member cannot be driven, `OUT` in the `locked_positions`, `BACK` in the
        `dead_positions`.
        """

    def far_turning_positions(self, low: float, high: float) -> tuple[float, ...]:
        """The positions in [low, high] at which the magnitude of the sine `OUT` of
        `transmission_sines` may have a minimum, besides those at which it is 0, the
        `locked_positions`; what the `turning_positions` are to `BACK`.
        """

    def per_follower(self, position: FloatArray) -> FloatArray:
        """(n,) dx/dq: change of the demanded motion x per unit of the follower's coordinate q.

        The reciprocal of `transform`, from the velocities of the closed loop: so it is not 0/0
        at rest, and 0 at a dead centre. GeometryError with key "linkage" where the follower cannot
        move the far end, see `locked_positions`.
        """

    def locked_positions(self, low: float, high: float) -> tuple[float, ...]:
        """The positions in [low, high] at which the follower cannot move the far end."""


# -- far end --------------------------------------------------------------------------------------
# The far end of a linkage whose follower is anywhere, whether or not it touches the cam.


STEPS: Final = 40
"""Most Newton steps; the follower is near where the demanded motion has it."""

SETTLED: Final = 2.0**-48
"""A step below this share of the position and of what one radian moves it is the last one."""


@dataclass(frozen=True, slots=True, eq=False)
class FarEnd:
    """Where the far end of a linkage is, given the follower's coordinate q; at `phi` it is near the
    demanded position, from which it is sought.

    Attributes
    ----------
    demanded : the motion of the far end.
    linkage : from it to the follower.
    """

    demanded: Motion
    linkage: Linkage
    _jets: Answers[Jet] = field(default_factory=Answers, init=False, repr=False)

    def place(self, phi: FloatArray, q: FloatArray) -> FloatArray:
        """(n,) demanded position s [mm or rad] with the follower at `q` (n,), see `jet`."""
        place: FloatArray = self.jet(phi, q)[0]
        return place

    def jet(self, phi: FloatArray, q: FloatArray) -> Jet:
        """(4, n) s, ds/dq, d^2s/dq^2 [mm or rad per that of q^k] and 0, read-only.

        By Newton's method; the derivatives from those of the linkage, q' = 1 and q'' = 0.

        Raises
        ------
        GeometryError
            With key "linkage", if it does not close there, or at a dead centre.
        """

        def made() -> Jet:
            place = self._sought(phi, q)
            way = self.linkage.per_follower(place)
            still = np.zeros_like(place)
            bend = self.linkage.transform(np.stack((place, way, still, still)), 2)[2]
            return read_only(np.stack((place, way, -bend * way, still)))

        return self._jets.recall(made, None, phi, q)

    def _sought(self, phi: FloatArray, q: FloatArray) -> FloatArray:
        linkage = self.linkage
        place = np.array(self.demanded.jet(phi, "right", 1)[0])
        still = np.zeros_like(place)
        for _ in range(STEPS):
            now = linkage.transform(np.stack((place, still, still, still)), 1)[0]
            way = linkage.per_follower(place)
            step = (q - now) * way
            place = place + step
            if np.all(np.abs(step) <= SETTLED * (np.abs(place) + np.abs(way))):
                return np.asarray(place)
        raise GeometryError("the follower is where the linkage does not close", key="linkage")


@kept_with_owner
def far_end(plan: MotionPlan, linkage: Linkage) -> FarEnd:
    """The far end of `linkage` with the demanded motion `plan`."""
    return FarEnd(plan, linkage)


# -- positions ------------------------------------------------------------------------------------
# Positions of a demanded motion: where it passes them, and how messages write them.


POSITIONS: Final[dict[Member, str]] = {
    "slider": "stroke",
    "lever": "lever angle",
    "crank": "crank angle",
}
"""What the demanded position is called."""


@dataclass(frozen=True, slots=True, eq=False)
class MonotoneRuns:
    """A motion cut into runs, on each of which it has one formula and one direction.

    Attributes
    ----------
    motion : the demanded motion.
    ends : (k,) cam angles [rad], ascending from 0 to a turn, where the runs begin and end.
    at_ends : (k,) positions there [mm or rad].
    """

    motion: Motion
    ends: FloatArray
    at_ends: FloatArray

    @property
    def range(self) -> tuple[float, float]:
        """Smallest and largest position [mm or rad]."""
        return float(np.min(self.at_ends)), float(np.max(self.at_ends))

    def cuts(self, marks: tuple[float, ...]) -> FloatArray:
        """(n,) the ends, and the cam angles at which the motion is at one of `marks`; ascending."""
        found = [self.ends]
        for mark in marks:
            passes = np.flatnonzero(self._passes(mark))
            found.append(self._between(mark, passes))
        return merged(np.concatenate(found))

    def first_angle(self, position: float) -> float:
        """The first cam angle [rad] at which the motion is at `position`, or nearest to it."""
        nearest = int(np.argmin(np.abs(self.at_ends - position)))
        passes = np.flatnonzero(self._passes(position))[:1]
        there = self.ends[self.at_ends == position][:1]
        found = np.concatenate((there, self._between(position, passes)))
        return float(np.min(found)) if len(found) else float(self.ends[nearest])

    def _passes(self, mark: float) -> BoolArray:
        beyond = np.sign(self.at_ends - mark)
        return np.asarray(beyond[:-1] * beyond[1:] < 0.0)

    def _between(self, mark: float, places: IntArray) -> FloatArray:
        def beyond(phi: FloatArray) -> FloatArray:
            return np.asarray(self.motion.jet(phi)[0] - mark)

        return bracketed_roots(beyond, self.ends[places], self.ends[places + 1])


def monotone_runs(motion: Motion) -> MonotoneRuns:
    """`motion` cut where its formula changes and where it turns back."""
    ends = merged(np.array([0.0, *(end for _, end in pieces(motion)), *turning_angles(motion)]))
    return MonotoneRuns(motion, ends, np.asarray(motion.jet(ends)[0]))


def locked_at(linkage: Linkage, demanded: Motion) -> tuple[float, float] | None:
    """First cam angle [rad] and position [mm or rad] at which the follower cannot move the far end.

    There dx/dq of `Linkage.per_follower` is infinite: a mass or a load at the far end needs an
    infinite force of the follower. None if the motion `demanded` of the far end stays clear of all
    such positions.
    """
    runs = monotone_runs(demanded)
    found = linkage.locked_positions(*runs.range)
    return min(((runs.first_angle(each), each) for each in found), default=None)


def position_text(linkage: Linkage, position: float) -> str:
    """A position of the demanded motion [mm or rad], in words."""
    if linkage.unit == "mm":
        return f"stroke {position:.6g} mm"
    return f"{POSITIONS[linkage.member]} {math.degrees(position):.6g} deg"
