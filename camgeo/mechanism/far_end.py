"""The far end of a linkage whose follower is anywhere, whether or not it touches the cam."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final

import numpy as np

from camgeo.errors import GeometryError
from camgeo.motion.kept import Answers, kept_with_owner
from camgeo.numeric.arrays import FloatArray, read_only

if TYPE_CHECKING:
    from camgeo.mechanism.linkage_protocol import Linkage
    from camgeo.motion.motion import Jet, Motion
    from camgeo.motion.plan import MotionPlan

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
