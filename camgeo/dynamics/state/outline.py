"""The motion that a trimmed flank makes as the state: the replay of the real outline."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from camgeo.dynamics.state.state import Model, order_with
from camgeo.dynamics.state.written import OnDisc
from camgeo.errors import GeometryError
from camgeo.geometry.outline.replay import DiscLift
from camgeo.geometry.outline.roller import AS_DEMANDED
from camgeo.kinematics.motion import FULL_ORDER, Dwell, Jet, Motion
from camgeo.kinematics.plan import breaks
from camgeo.numeric.arrays import BoolArray, FloatArray, Side, ascending
from camgeo.units import TURN


@dataclass(frozen=True)
class OfOutline(OnDisc):
    """The motion of a follower on its real flank; see `camgeo.dynamics.state.state.State`.

    The roller that turns about a corner of the disc touches it along the normal of the path of its
    centre, as it does on a flank, so that path alone gives the direction of the contact force. A
    flat face rocks over the corner, and is pushed along its own normal, see `FaceCurve`.

    The only flank of its `cam` is trimmed, and on its `replay` the lift does not jump.
    """

    @property
    def model(self) -> Model:
        """See `State`."""
        return "outline"

    @property
    def sense(self) -> int:
        """See `State`."""
        return self.cam.contact.push

    @cached_property
    def motion(self) -> ReplayedMotion:
        """See `State`."""
        return ReplayedMotion(self.cam.drive.motion, self.replay.lift)

    @property
    def is_followed(self) -> bool:
        """Whether the far end of a linkage follows over each corner, at the replay's samples."""
        phi = self.replay.phi[self.motion.on_corner(self.replay.phi, "right")]
        try:
            self.output.jet(phi, "right", 1)
        except GeometryError:
            return False
        return True

    @property
    def order(self) -> int:
        """See `State`: at both ends of a corner the acceleration jumps."""
        free = self.motion.breaks
        kept = [each.order for each in breaks(self.cam.drive.plan) if each.cam_angle in free]
        own = min([0 if self.shocks else 1, *kept])
        return min(own, order_with(self.output, self.course))

    def on_corner(self, phi: FloatArray, side: Side) -> BoolArray:
        """See `State`."""
        return self.motion.on_corner(phi, side)


# -- replayed -------------------------------------------------------------------------------------
# The motion of a follower that is pressed against what remains of its flank.


SEAM = 1e-9
"""Ranges of the cam angle [rad] this short are rounding."""


@dataclass(frozen=True)
class ReplayedMotion:
    """The demanded motion where the flank is whole, and the motion over its corners; see `Motion`.

    On a corner the roller turns about a point of the disc, over which a flat face rocks, so the
    lift and three derivatives are known in closed form
    (`camgeo.kinematics.mechanism.follower_path.lift_jet`,
    `camgeo.geometry.outline.face.GuidedFace.jet`).

    Attributes
    ----------
    demanded : the follower's demanded motion.
    lift : on the disc, without play.
    """

    demanded: Motion
    lift: DiscLift

    @cached_property
    def ranges(self) -> tuple[tuple[float, float], ...]:
        """Start in [0, 2 pi) and end [rad] of each range over which one corner holds the roller; an
        end may be beyond a turn.
        """
        starts = self.lift.borders
        if not len(starts):
            return ()
        ends = np.append(starts[1:], starts[0] + TURN)
        held = (self.lift.numbers != AS_DEMANDED) & (ends - starts > SEAM)
        return tuple(zip(starts[held].tolist(), ends[held].tolist(), strict=True))

    @cached_property
    def breaks(self) -> FloatArray:
        """See `Motion`."""
        return self._with_corners(self.demanded.breaks)

    @cached_property
    def borders(self) -> FloatArray:
        """See `Motion`."""
        return self._with_corners(self.demanded.borders)

    def _with_corners(self, places: FloatArray) -> FloatArray:
        """(k,) those of `places` [rad] at which no corner holds the roller, and ends of corners."""
        free = np.ones(len(places), dtype=np.bool_)
        for start, end in self.ranges:
            free &= np.remainder(places - start, TURN) >= end - start
        ends = np.array(self.ranges).ravel() % TURN
        return ascending(np.concatenate((places[free], ends)))

    @cached_property
    def dwells(self) -> tuple[Dwell, ...]:
        """What is left of the demanded dwells, see `Motion`."""
        return tuple(part for dwell in self.demanded.dwells for part in self._left_of(dwell))

    def _left_of(self, dwell: Dwell) -> Iterator[Dwell]:
        start, end = dwell.start, dwell.start + dwell.span
        corners = [
            (low + turn, high + turn) for low, high in self.ranges for turn in (-TURN, 0.0, TURN)
        ]
        for low, high in sorted(corners):
            if high <= start or low >= end:
                continue
            if low - start > SEAM:
                yield Dwell(start % TURN, low - start)
            start = high
        if end - start > SEAM:
            yield Dwell(start % TURN, end - start)

    def on_corner(self, phi: FloatArray, side: Side) -> BoolArray:
        """(n,) whether a corner of the disc holds the follower at `phi` (n,) [rad]."""
        return np.asarray(self.lift.number(phi, side) != AS_DEMANDED)

    def jet(self, phi: FloatArray, side: Side = "right", order: int = FULL_ORDER) -> Jet:
        """See `Motion`."""
        return self.lift.jet(phi, side, 3)[: order + 1]

    def jet_and_bounds(self, low: FloatArray, high: FloatArray) -> tuple[Jet, Jet]:
        """See `Motion`; the bounds are infinite where a corner holds the roller."""
        jet, bounds = self.demanded.jet_and_bounds(low, high)
        middle = 0.5 * (low + high)
        held = self.on_corner(middle, "right")
        jet, bounds = jet.copy(), bounds.copy()
        jet[:, held] = self.jet(middle[held])
        bounds[:, held] = np.inf
        return jet, bounds
