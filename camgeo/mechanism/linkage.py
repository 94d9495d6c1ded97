"""A linkage ahead of the follower: a motion derived from another by the chain rule."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from camgeo.errors import GeometryError
from camgeo.mechanism.triangle import ROUNDING
from camgeo.mechanism.values import able
from camgeo.motion.extremes import lift_range
from camgeo.motion.kept import Answers, Kept, kept_with_owner
from camgeo.motion.motion import FULL_ORDER, Dwell, Jet, Motion
from camgeo.numeric.arrays import FloatArray, Side, read_only
from camgeo.pickled import Pickled

if TYPE_CHECKING:
    from camgeo.mechanism.linkage_protocol import Linkage
    from camgeo.motion.plan import MotionPlan


@dataclass(frozen=True, slots=True)
class LinkedMotion(Pickled):
    """The follower's motion, given the motion demanded of the far end of its linkage.

    Attributes
    ----------
    demanded : the motion of the linkage's far end [mm or rad, see `Linkage.unit`].
    linkage : turns it into the follower's own motion: a rocker's angle [rad], counter-clockwise
        positive, or a stroke [mm].
    kept : the last result of each function of the motion, see `kept_with_owner`.

    Raises
    ------
    GeometryError
        With key "motion" or "linkage", if the value is no such thing; with "linkage" also if the
        linkage fails to close somewhere in the turn, with each range of cam angles, the missing
        length, and what would close it.
    """

    demanded: Motion
    linkage: Linkage
    _jets: Answers[Jet] = field(default_factory=Answers, init=False, repr=False, compare=False)
    _bounds: Answers[tuple[Jet, Jet]] = field(
        default_factory=Answers, init=False, repr=False, compare=False
    )
    kept: Kept = field(default_factory=dict, init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        able("motion", self.demanded, "jet_and_bounds", "a motion over the cam angle")
        able("linkage", self.linkage, "transform_bounds", "a linkage")
        _, gap = self.tightest()
        if gap <= ROUNDING * (self.linkage.crank + self.linkage.coupler):
            return
        from camgeo.mechanism.closing import why_open  # a linkage that closes needs no cure

        raise GeometryError(why_open(self.linkage, self.demanded), key="linkage")

    def tightest(self, within: tuple[float, float] | None = None) -> tuple[float, float]:
        """The position [mm or rad] nearest to a dead centre, or farthest beyond it, and the missing
        length there [mm], negative if there is some to spare.

        `within` is the range of the demanded motion, if it is already known.
        """
        low, high = lift_range(self.demanded) if within is None else within
        positions = np.array([low, high, *self.linkage.turning_positions(low, high)])
        missing = self.linkage.missing_length(positions)
        worst = int(np.argmax(missing))
        return float(positions[worst]), float(missing[worst])

    @property
    def breaks(self) -> FloatArray:
        """See `Motion`."""
        return self.demanded.breaks

    @property
    def borders(self) -> FloatArray:
        """See `Motion`."""
        return self.demanded.borders

    @property
    def dwells(self) -> tuple[Dwell, ...]:
        """See `Motion`."""
        return self.demanded.dwells

    def jet(self, phi: FloatArray, side: Side = "right", order: int = FULL_ORDER) -> Jet:
        """(order + 1, n) follower's motion and derivatives, see `Motion.jet`.

        Read-only, and the same array for recent requests, like those of a plan.
        """
        phi = np.array(phi, dtype=np.float64, ndmin=1)  # a copy of our own

        def made() -> Jet:
            return read_only(self.linkage.transform(self.demanded.jet(phi, side, order), order))

        return self._jets.recall(made, (side, order), phi)

    def jet_and_bounds(self, low: FloatArray, high: FloatArray) -> tuple[Jet, Jet]:
        """See `Motion.jet_and_bounds`; recalled as `jet` is."""

        def made() -> tuple[Jet, Jet]:
            middle, bounds = self.demanded.jet_and_bounds(low, high)
            jet = self.linkage.transform(middle, FULL_ORDER)
            return read_only(jet), read_only(self.linkage.transform_bounds(middle, bounds))

        return self._bounds.recall(made, None, low, high)


@kept_with_owner
def linked(plan: MotionPlan, linkage: Linkage) -> LinkedMotion:
    """The follower's motion for a `plan` of the far end of `linkage`; GeometryError if it does not
    close.
    """
    return LinkedMotion(plan, linkage)
