"""What a linkage is: a motion from a motion, as long as it closes.

At one end of a linkage a member makes the motion that the scene demands: a slider, a lever or a
crank. At the other end is the follower, on a pivot or on a guide, whose motion the linkage computes
backwards. Positions of the demanded motion are in mm for a slider and in rad for what turns.
"""

from __future__ import annotations

from typing import Literal, Protocol

from camgeo.mechanism.sketch import MechanismSketch, Places
from camgeo.motion.motion import FULL_ORDER, Jet
from camgeo.numeric.arrays import ComplexArray, FloatArray
from camgeo.units import LiftUnit

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
