"""What the followers of a family share: those on a guide, those on a pivot, those with a roller.

Flat faces are another family, see `camgeo.mechanism.face`.
"""

from __future__ import annotations

import cmath
import math
from typing import TYPE_CHECKING

import numpy as np

from camgeo.mechanism.follower import Follower, RelativeJet, bend_of_path
from camgeo.mechanism.sketch import Dimension, Guide, MechanismSketch, Places
from camgeo.motion.motion import Jet
from camgeo.numeric.arrays import ComplexArray, FloatArray, phase

GUIDE = 0.8
"""Distance from a carriage in its farthest position to its guide, in base radii."""

ROD = 0.3
"""How far the rod of a carriage protrudes from its guide at lift 0, in base radii."""

BRACKET = 1.2
"""How far the bracket between two rollers clears the discs, in their largest radii."""


class Guided(Follower):
    """A follower on a straight guide.

    Attributes
    ----------
    guide_angle : direction of the guide away from the cam, from the x axis [rad].
    direction : kappa_F, +1 if a positive lift moves it outward (F-cam), -1 inward (P-cam).
    """

    __slots__ = ()

    lift_unit = "mm"
    mover = "follower"
    pivot = None
    farthest = math.inf
    swing_sense = 0

    if TYPE_CHECKING:  # fields that every kind has
        guide_angle: float
        direction: int

    @property
    def outward(self) -> complex:
        """Unit direction of the guide away from the cam."""
        return cmath.rect(1.0, self.guide_angle)

    @property
    def way(self) -> complex:
        """See `Follower`."""
        return self.direction * self.outward

    @property
    def reach(self) -> float:
        """See `Follower`: kappa_F."""
        return float(self.direction)

    @property
    def lift_scale(self) -> float:
        """See `Follower`."""
        return self.base_radius

    def linked_at(self, farthest: float) -> tuple[complex, complex]:
        """See `Follower.linked_at`: the end of its rod."""
        return self.rod(np.zeros(1), farthest).at(0).links[0][-1], self.way

    def rod(self, lifts: FloatArray, farthest: float) -> MechanismSketch[Places]:
        """Its rod at `lifts` (n,) [mm], from where it touches the cam, in its guide."""
        held, start, here = (
            self.traced_point(farthest), self.traced_point(0.0), self.traced(lifts),
        )  # fmt: skip
        middle = held + GUIDE * self.base_radius * self.outward
        end = middle + here - start + ROD * self.base_radius * self.outward
        guide = Guide(middle, self.outward, block=False)
        return MechanismSketch(links=((here, end),), guides=(guide,))

    def across(
        self, lifts: FloatArray, breadth: float
    ) -> tuple[ComplexArray, MechanismSketch[Places]]:
        """The far side (n,) of its yoke at `lifts` (n,), and the bracket that joins both."""
        here = self.traced(lifts)
        there = here - breadth * here / np.abs(here)
        return there, MechanismSketch(links=(bracket(here, there, 0.6 * breadth),))


class Rocking(Follower):
    """A follower that swings about a fixed pivot.

    Attributes
    ----------
    pivot : B_0 seen from the cam axis, complex [mm].
    arm_side : +1 if its arm or face lies counter-clockwise of the line pivot -> cam axis, -1
        clockwise.
    direction : +1 if a positive lift [rad] moves it outward (F-cam), -1 inward (P-cam); None if the
        lift is its own angle, counter-clockwise positive, as behind a linkage.
    """

    __slots__ = ()

    lift_unit = "rad"
    mover = "rocker"
    offset = 0.0
    lift_scale = 1.0
    way = 0j

    if TYPE_CHECKING:  # fields that every kind has
        pivot: complex
        arm_side: int
        direction: int | None

    @property
    def centre_distance(self) -> float:
        """l_1, cam axis to pivot [mm]."""
        return abs(self.pivot)

    @property
    def line_angle(self) -> float:
        """Direction of the line pivot -> cam axis, from the x axis [rad]."""
        return phase(-self.pivot)

    @property
    def swing_sense(self) -> int:
        """Sense in which a positive lift turns the rocker: +1 counter-clockwise, -1 clockwise."""
        return 1 if self.direction is None else self.direction * self.arm_side

    def linked_at(self, _: float) -> tuple[complex, complex]:
        """See `Follower.linked_at`."""
        return self.pivot, 0j

    def far_side(
        self, _: FloatArray, __: tuple[float, float], ___: float
    ) -> MechanismSketch[Places]:
        """See `Follower.far_side`."""
        return MechanismSketch()


class WithRoller(Follower):
    """A follower with a roller, whose centre follows the pitch curve."""

    __slots__ = ()

    touching = "roller"
    face = (0.0, 0.0)
    rolls = True
    has_pitch_curve = True
    standstill = (
        "the roller centre stands still in the turning cam (Z' = 0): the pitch curve has a cusp and"
        " no normal there; the rocker lies on the line of centres and l_3 (1 - sigma psi') = l_1"
    )
    ahead = 0

    def roller_size(self, centre: Places, way: Places) -> tuple[Dimension[Places], ...]:
        """The radius of the roller at `centre` [mm], shown along `way`; none of a knife edge."""
        radius = self.roller_radius
        return (Dimension("roller_radius", centre, centre + radius * way),) if radius else ()

    @property
    def has_edge(self) -> bool:
        """See `Follower`."""
        return self.roller_radius == 0.0

    def curvature(self, relative: RelativeJet, speed: FloatArray, rotation: int) -> FloatArray:
        """See `Follower.curvature`."""
        return bend_of_path(relative, speed, rotation)

    def contact_radius(self, kappa: FloatArray, half: float) -> FloatArray:
        """See `Follower.contact_radius`.

        1/R = 1/r_R + kappa/(1 - d kappa), d the flank's distance: r_R except in a groove with play.
        """
        radius = self.roller_radius * (1.0 - half * kappa)
        share = 1.0 - (half - self.roller_radius) * kappa
        return np.divide(radius, share, out=radius, where=radius > 0.0)

    def sliding(self, jet: Jet, _: int) -> FloatArray:
        """See `Follower.sliding`: a roller rolls."""
        return np.zeros(jet.shape[1])


def bracket(first: ComplexArray, second: ComplexArray, reach: float) -> tuple[Places, ...]:
    """From one side of the cam to the other, clear of a disc of the radius `reach`; all (n,)."""
    aside = 1j * (first - second) / np.abs(first - second) * BRACKET * reach
    return first, first + aside, second + aside, second
