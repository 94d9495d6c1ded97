"""The interface of followers: from the lift to the roller centre, or to the contact of a flat face.

With W(phi) the roller centre minus the cam axis in the fixed frame and sigma = +1 for a cam that
turns counter-clockwise, the pitch curve in cam coordinates is Z = W exp(-i sigma phi), and

    Z^(k) = R_k exp(-i sigma phi),
    R_0 = W, R_1 = W' - i sigma W, R_2 = W'' - 2 i sigma W' - W,
    R_3 = W''' - 3 i sigma W'' - 3 W' + i sigma W.

Curvature and transmission angle need the R_k only, not the rotation. u and v are the parts of R_1
across and along the follower's own direction: |Z'|^2 = u^2 + v^2, and the transmission angle mu,
the acute angle between rocker (or the normal of the guide) and the normal of the pitch curve, is
tan mu = |u| / |v|.

For a flat face W is the point of contact, so that Z is the outline of the cam itself; u and v are
then the parts of R_1 that give the transmission angle, again with u^2 + v^2 = |Z'|^2.

The R_k are stored as two real arrays: a third of the cost of complex ones, as most terms are real.
"""

from __future__ import annotations

import cmath
import math
from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar, Literal

import numpy as np

from camgeo.kinematics.mechanism.sketch import Dimension, Guide, MechanismSketch, Places
from camgeo.kinematics.mechanism.values import Touching
from camgeo.kinematics.motion import FULL_ORDER, Jet
from camgeo.numeric.arrays import ComplexArray, FloatArray, phase
from camgeo.units import LiftUnit


@dataclass(frozen=True, slots=True, eq=False)
class RelativeJet:
    """The roller centre at n cam angles as seen from the turning cam, in axes that do not turn.

    Attributes
    ----------
    along, across : (order + 1, n) parts of R_0, R_1, ... [mm per rad^k] along two axes at right
        angles, the second counter-clockwise of the first.
    axis : angle of the first axis from the x axis [rad].
    u, v : (n,) [mm/rad], see the module.
    turning : (n,) or a number, rate at which the follower's direction turns in the fixed frame,
        per unit cam speed, counter-clockwise; 0 for a guide.
    reach : (n,) or a number, distance that the roller centre, or the point of contact, moves per
        unit of lift [1 or mm/rad], signed as `Follower.reach`.
    """

    along: FloatArray
    across: FloatArray
    axis: float
    u: FloatArray
    v: FloatArray
    turning: FloatArray | float
    reach: FloatArray | float


@dataclass(frozen=True, slots=True, eq=False)
class TangentJet:
    """Z' in axes along the follower's own direction, which turn with the rocker.

    R_1 = sigma (u + i w) times the direction across the follower's path. At rest all entries but u
    and w themselves vanish, so that the effect of a small motion on the curvature stays accurate.

    Attributes
    ----------
    u, w : (2, n) [mm/rad^k], with their derivatives.
    turning : (n,) rate at which the follower's direction turns in the fixed frame, per unit cam
        speed, counter-clockwise; 0 for a guide.
    swerve : (n,) [mm^2/rad^3] sigma (u w'' - w u'') + u u' + w w' + sigma turning' |Z'|^2, in which
        every term linear in the follower's acceleration has cancelled.
    """

    u: FloatArray
    w: FloatArray
    turning: FloatArray
    swerve: FloatArray


Mover = Literal["follower", "rocker"]
"""The part of a follower that moves."""


class Follower(ABC):
    """A follower; lengths in mm.

    Each kind of follower is a frozen dataclass of its dimensions. What it has in common with its
    family it inherits from the classes of `camgeo.kinematics.mechanism.follower` or
    `camgeo.kinematics.mechanism.flat`.

    Attributes
    ----------
    base_radius : r_G, from the cam axis to the roller centre, or to a flat face, at cam angle 0.
    roller_radius : r_R; 0 for a flat face, whose contact is the curve itself.
    pivot : the point about which it swings, seen from the cam axis, complex [mm]; None on a guide.
    offset : e, signed distance of the roller's guide from the cam axis [mm]; 0 if there is none.
    face : where a flat face begins and ends [mm], None if it is as long as needed; zeros for a
        roller.
    reach : distance that the roller centre moves per unit of lift [1 or mm/rad], positive if a
        positive lift turns the rocker counter-clockwise, or moves the roller outward along the
        guide. For a rocking flat face, whose contact wanders, the value at cam angle 0 in a dwell.
    farthest : base radius [mm] at which a rocker lies stretched out; infinite on a guide.
    lift_scale : a large lift [mm or rad], to which others are compared.
    way : direction of a positive lift, complex; 0 for a rocker.
    start_arm : vector at lift 0, complex [mm], from the pivot, or from the cam axis on a guide, to
        the roller centre, or to the foot of the perpendicular on a flat face.
    swing_sense : sense in which a positive lift turns it: +1 counter-clockwise, -1; 0 on a guide.
    has_edge : whether it is a knife edge, a roller without radius.
    kind : its name in scenes.
    lift_unit : unit of its lift.
    touching : the part that touches the cam, "roller" or "face", as messages call it.
    mover : the part that moves, "follower" or "rocker", as messages call it.
    rolls : whether what touches the cam rolls on it; a flat face slides.
    has_pitch_curve : whether the flanks are parallels of the curve that it traces, and may cross
        themselves; a flat face touches the outline itself, which must be convex.
    standstill : the consequence of Z' = 0, as a sentence of messages.
    ahead : how many derivatives of the lift R_k needs beyond the k-th. A flat face needs one, so
        it has no R_3: a motion has three derivatives.
    harmonic_is_round : whether Z turns rigidly about a point of the cam where s''' = -s'.
    """

    __slots__ = ()

    kind: ClassVar[str]
    lift_unit: ClassVar[LiftUnit]
    touching: ClassVar[Touching]
    mover: ClassVar[Mover]
    rolls: ClassVar[bool]
    has_pitch_curve: ClassVar[bool]
    standstill: ClassVar[str]
    ahead: ClassVar[int]
    harmonic_is_round: ClassVar[bool] = False

    if TYPE_CHECKING:  # at run time these would become defaults of the kinds' own fields
        base_radius: float
        roller_radius: float
        pivot: complex | None
        offset: float
        face: tuple[float, float] | None

        @property
        @abstractmethod
        def farthest(self) -> float:
            """See the class."""

        @property
        @abstractmethod
        def lift_scale(self) -> float:
            """See the class."""

        @property
        @abstractmethod
        def way(self) -> complex:
            """See the class."""

        @property
        @abstractmethod
        def swing_sense(self) -> int:
            """See the class."""

        @property
        @abstractmethod
        def has_edge(self) -> bool:
            """See the class."""

    @property
    @abstractmethod
    def reach(self) -> float:
        """See the class."""

    @property
    @abstractmethod
    def start_arm(self) -> complex:
        """See the class."""

    @abstractmethod
    def relative_jet(self, jet: Jet, rotation: int, order: int = FULL_ORDER) -> RelativeJet:
        """R_0 to R_`order`, order at least 1, for lifts `jet` (order + 1 or more, n).

        A flat face has no R_3: R_k needs `ahead` more derivatives of the lift than k, and there are
        three. `rotation` is sigma, +1 for a cam that turns counter-clockwise, -1 clockwise.
        """

    def traced(self, lifts: FloatArray) -> ComplexArray:
        """(n,) [mm] the roller centre, or the contact of a flat face that rests, in the fixed frame
        at lifts (n,).
        """
        jet = np.zeros((FULL_ORDER + 1, len(lifts)))
        jet[0] = lifts
        relative = self.relative_jet(jet, 1, 1)
        return np.asarray(
            (relative.along[0] + 1j * relative.across[0]) * cmath.exp(1j * relative.axis)
        )

    def traced_point(self, lift: float) -> complex:
        """The point of `traced` [mm] at one lift."""
        return complex(self.traced(np.array([lift]))[0])

    @abstractmethod
    def tangent_jet(self, jet: Jet, rotation: int) -> TangentJet:
        """Z' in the follower's own axes for lifts `jet` (4, n); `rotation` as in `relative_jet`."""

    @abstractmethod
    def speed_bounds(self, jet: Jet, bounds: Jet, half: FloatArray, rotation: int) -> FloatArray:
        """(3, n) upper bounds of |Z'|, |Z''|, |Z'''| [mm/rad^k] over cells of cam angle.

        `jet` is the lift in the middle of the cells, `bounds` those of `Motion.jet_and_bounds`,
        `half` (n,) half their widths [rad]. Where there is no Z''' the third one says how far Z''
        may be from its value in the middle, see `camgeo.kinematics.mechanism.flat`.
        """

    @abstractmethod
    def curvature(self, relative: RelativeJet, speed: FloatArray, rotation: int) -> FloatArray:
        """(n,) [1/mm] curvature of the pitch curve, from R_0 to R_k with k + `ahead` = 2, and from
        `speed` (n,) |Z'|.
        """

    @abstractmethod
    def contact_radius(self, kappa: FloatArray, half: float) -> FloatArray:
        """(n,) [mm] R of 1/R = 1/r_R + the curvature of the flank, as in Hertz's pressure.

        kappa (n,) [1/mm] is the curvature of the pitch curve seen from the flank, which lies `half`
        [mm] from it. Not above 0 where the flank undercuts.
        """

    @abstractmethod
    def sliding(self, jet: Jet, rotation: int) -> FloatArray:
        """(n,) [mm/rad] sliding velocity on the cam for lifts `jet` (4, n), along t = Z'/|Z'|."""

    @abstractmethod
    def on_one_side(self, lifts: FloatArray) -> bool:
        """Whether, at all these lifts, the roller is beyond the foot of its guide, or on its own
        side of the line of centres; False for a flat face, whose contact has no such side.
        """

    @abstractmethod
    def sketch(
        self, lifts: FloatArray, farthest: float, ends: tuple[float, float]
    ) -> MechanismSketch[Places]:
        """A sketch of the follower at `lifts` (n,) [mm or rad].

        `farthest` is the lift farthest from the cam; `ends` are where a flat face begins and ends
        [mm], measured as its contact is, and without meaning for a roller.
        """

    @abstractmethod
    def held(
        self, ends: tuple[float, float]
    ) -> tuple[Literal["guide", "pivot"], complex, tuple[complex, complex] | None]:
        """Whether a guide or a pivot holds it, a point there [mm], and the ends of a flat face, at
        cam angle 0.
        """

    @abstractmethod
    def linkage_joint(self, farthest: float) -> tuple[complex, complex]:
        """The point at which a linkage is connected to it at lift 0 [mm], and the direction of a
        positive lift; for a rocker the pivot and 0.
        """

    @abstractmethod
    def far_side(
        self, lifts: FloatArray, ends: tuple[float, float], breadth: float
    ) -> MechanismSketch[Places]:
        """The second side of a yoke of `breadth` [mm] at `lifts` (n,); nothing for a rocker."""

    @abstractmethod
    def return_sketch(
        self, first: ComplexArray, lifts: FloatArray, reach: float
    ) -> MechanismSketch[Places]:
        """The second roller of the body whose first one is at `first` (n,) [mm]; nothing for a
        face.

        `reach` [mm] is how far their centres come from the cam axis.
        """


def bend_of_path(relative: RelativeJet, speed: FloatArray, rotation: int) -> FloatArray:
    """(n,) [1/mm] curvature of the path of a roller centre, from R_1 and R_2."""
    (_, a1, a2), (_, b1, b2) = relative.along[:3], relative.across[:3]
    # conj(Z') Z'' is invariant under rotation, so R_k can stand for Z^(k).
    cross = b1 * a2
    cross -= a1 * b2
    kappa: FloatArray = cross
    kappa *= rotation
    kappa /= speed * speed * speed
    return kappa


# -- families -------------------------------------------------------------------------------------
# Base classes of followers on a guide, of followers on a pivot, and of followers with a roller.
#
# Flat faces are another family, see `camgeo.kinematics.mechanism.flat`.


GUIDE = 0.8
"""Distance from a carriage in its farthest position to its guide, as a multiple of the base
radius."""

ROD = 0.3
"""Length of the rod that protrudes from the guide at lift 0, as a multiple of the base radius."""

BRACKET = 1.2
"""Distance of the bracket between two rollers from the cam axis, as a multiple of the largest
radius of the discs."""


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

    def linkage_joint(self, farthest: float) -> tuple[complex, complex]:
        """See `Follower.linkage_joint`: the end of its rod."""
        return self.rod(np.zeros(1), farthest).position(0).links[0][-1], self.way

    def rod(self, lifts: FloatArray, farthest: float) -> MechanismSketch[Places]:
        """A sketch of its rod at `lifts` (n,) [mm], from the contact with the cam to the end beyond
        the guide.
        """
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
        """The far side (n,) [mm] of its yoke at `lifts` (n,), and a sketch of the bracket that
        joins both sides.
        """
        here = self.traced(lifts)
        there = here - breadth * here / np.abs(here)
        return there, MechanismSketch(links=(self.bracket(here, there, 0.6 * breadth),))

    @staticmethod
    def bracket(first: ComplexArray, second: ComplexArray, reach: float) -> tuple[Places, ...]:
        """The corners (n,) of a bracket from one side of the cam to the other that clears a disc of
        the radius `reach` [mm].
        """
        aside = 1j * (first - second) / np.abs(first - second) * BRACKET * reach
        return first, first + aside, second + aside, second


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

    def linkage_joint(self, _: float) -> tuple[complex, complex]:
        """See `Follower.linkage_joint`."""
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
        """The dimension of the radius of the roller at `centre` [mm], in the direction `way`; none
        for a knife edge.
        """
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

        1/R = 1/r_R + kappa/(1 - d kappa), where d is the distance of the flank from the pitch
        curve: r_R, except in a groove with play.
        """
        radius = self.roller_radius * (1.0 - half * kappa)
        share = 1.0 - (half - self.roller_radius) * kappa
        # Where the flank undercuts, the value is left as it is, not above 0.
        return np.divide(radius, share, out=radius, where=radius > 0.0)

    def sliding(self, jet: Jet, _: int) -> FloatArray:
        """See `Follower.sliding`: a roller rolls."""
        return np.zeros(jet.shape[1])
