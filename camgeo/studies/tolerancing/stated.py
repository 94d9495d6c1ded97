"""How a machine may deviate, the resulting error of its position, and what scenes state of it."""

from __future__ import annotations

import math
import re
from bisect import bisect_left
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from enum import Enum, StrEnum
from functools import cache, cached_property, partial, singledispatch
from typing import Any, Final, Literal, Self

import numpy as np

from camgeo.cam.cam import Cam
from camgeo.design.design import Design
from camgeo.errors import GeometryError, SceneError, meant
from camgeo.geometry.outline.path import Flank
from camgeo.kinematics.mechanism.flat import OscillatingFlat, TranslatingFlat
from camgeo.kinematics.mechanism.follower import Follower
from camgeo.kinematics.mechanism.linkage import Linkage
from camgeo.kinematics.mechanism.linkages import FourBar
from camgeo.kinematics.mechanism.rollers import OscillatingRoller, TranslatingRoller
from camgeo.kinematics.motion import Jet
from camgeo.numeric.arrays import ComplexArray, FloatArray, dot
from camgeo.record import stored_schema
from camgeo.scene.keys import KeyPath, spelled
from camgeo.scene.rules import TOLERANCE
from camgeo.scene.scene import Scene
from camgeo.units import MM_PER, TURN, listed

# -- deviations ------------------------------------------------------------------------------------
# Ways in which a machine deviates, and exact sensitivities: the error of its position per unit of
# each.
#
# They follow from virtual displacements; only the cam angle is sampled. Let R be the point of
# contact on the cam, in the frame, n the unit normal there, and W the same point on the follower:
# contact means R = W, and a flat face touches where it is tangent. If R is displaced by dR and W,
# at the same lift, by dW, the lift q changes by
#
#     dq = n . (dR - dW) / (n . dW/dq).
#
# n . dW/dq is `PitchCurve.leverage`, which contains the transmission angle. A roller that is too
# large, for example, has its centre pushed outward, and raises the lift by the excess of its radius
# divided by the leverage.


# -- freedoms -------------------------------------------------------------------------------------
# The ways in which an assembled machine can deviate from the one for which its cam was made.
#
# Angles are positive counter-clockwise; places are complex numbers, in mm. The deviation in a
# freedom is a real number, or a complex one where it says so.


class Way(StrEnum):
    """What deviates.

    GROWTH : how far what touches the cam is pushed outward along the normal of the flank [mm].
    WAVE : the same over the flank, Re(A exp(-i k u)) at the cam angle u of its place, A complex.
    SEAT : place of the flank on its shaft, in the axes of the cam, complex.
    TIMING : angle by which the disc runs ahead of its shaft, in the sense in which it turns [rad].
    SHAFT : place of the cam axis in the frame, complex.
    PIVOT : place of the rocker's shaft in the frame, complex.
    BODY : place of what touches the cam on the rocker or carriage at lift 0, complex.
    TILT : direction of the guide, turned about the nominal cam axis [rad].
    SETTING : base radius from which the lift is counted [mm].
    CRANK, COUPLER, LEVER : lengths of the linkage [mm].
    FAR_SHAFT : place of the shaft at the far end of the linkage, complex.
    FAR_ANGLE : direction of the lever at the far end, at position 0 [rad].
    """

    GROWTH = "growth"
    WAVE = "wave"
    SEAT = "seat"
    TIMING = "timing"
    SHAFT = "shaft"
    PIVOT = "pivot"
    BODY = "body"
    TILT = "tilt"
    SETTING = "setting"
    CRANK = "crank"
    COUPLER = "coupler"
    LEVER = "lever"
    FAR_SHAFT = "far shaft"
    FAR_ANGLE = "far angle"


class Hold(Enum):
    """One of two sides that hold a follower; `ANY` for both, or for a follower on one flank."""

    ANY = "any"
    MAIN = "main"
    RETURN = "return"


@dataclass(frozen=True, slots=True)
class Freedom:
    """One way to deviate.

    Attributes
    ----------
    way : what deviates.
    waves : k, the number of waves of a `WAVE`; 0 for all others.
    hold : the side that deviates, of a follower that is held by two sides.
    """

    way: Way
    waves: int = 0
    hold: Hold = Hold.ANY

    def affects(self, hold: Hold) -> bool:
        """Whether a side has this deviation."""
        return self.hold in (Hold.ANY, hold)


@dataclass(frozen=True, slots=True)
class UnitDeviation:
    """The deviation of a machine per unit of a dimension: a freedom and a factor in it."""

    freedom: Freedom
    factor: complex = 1.0

    def of_side(self, hold: Hold) -> UnitDeviation:
        """The same deviation of one side alone."""
        return replace(self, freedom=replace(self.freedom, hold=hold))


@dataclass(frozen=True, slots=True, eq=False)
class Deviations:
    """The deviations of m machines.

    Attributes
    ----------
    count : m, the number of machines.
    values : (m,) complex deviations by freedom; 0 in a freedom that is missing.
    """

    count: int
    values: Mapping[Freedom, ComplexArray]

    def side_deviations(self, hold: Hold, *, half_turn: bool) -> Deviations:
        """The deviations of one side.

        With `half_turn` the side is on the same disc as the main one, half a turn later. It then
        meets each wave with a phase of half a turn of the disc, which reverses odd numbers of
        waves.
        """
        values: dict[Freedom, ComplexArray] = {}
        for freedom, amounts in self.values.items():
            if freedom.affects(hold):
                bare = replace(freedom, hold=Hold.ANY)
                # A phase of half a turn is exp(-i k pi) = (-1)^k.
                sign = -1.0 if half_turn and freedom.waves % 2 else 1.0
                values[bare] = values.get(bare, 0.0) + sign * amounts
        return Deviations(self.count, values)

    def amounts(self, way: Way) -> ComplexArray:
        """(m, 1) complex deviations in the freedom of a `way`; zeros if there are none."""
        stored = self.values.get(Freedom(way))
        return np.zeros((self.count, 1), complex) if stored is None else stored[:, np.newaxis]

    def real(self, way: Way) -> FloatArray:
        """(m, 1) deviations in a freedom with real numbers."""
        return np.asarray(self.amounts(way).real)

    @property
    def waves(self) -> Mapping[int, ComplexArray]:
        """(m, 1) complex amplitudes of waves on the flank, by their number."""
        return {
            freedom.waves: amplitudes[:, np.newaxis]
            for freedom, amplitudes in self.values.items()
            if freedom.way is Way.WAVE
        }


# -- pose -----------------------------------------------------------------------------------------
# The motion of a body with one coordinate: along a line, or about a point.


@dataclass(frozen=True, slots=True, eq=False)
class Pose:
    """The motion of a point of a body; arrays broadcast, machines along the first axis.

    Z(q) = C + (Z_0 - C) exp(i s q) + w q, where either s or w is 0.

    Attributes
    ----------
    start : Z_0 [mm].
    centre : C [mm].
    spin : s, +1 if the body turns counter-clockwise with q, -1 clockwise, 0 if it does not turn.
    way : w, displacement per unit of q.
    """

    start: ComplexArray
    centre: ComplexArray
    spin: float
    way: ComplexArray

    @classmethod
    def from_rates(cls, start: complex, first: complex, second: complex) -> Self:
        """The motion with a given place [mm] at q = 0 and two derivatives by q there."""
        # On a circle Z'' = -(Z - C), which gives the centre; on a line the second derivative is 0.
        turns = second != 0.0
        centre = start + second if turns else 0.0
        spin = float(np.sign((first / (start - centre)).imag)) if turns else 0.0
        way = 0.0 if turns else first
        start_point, centre_point, along = (
            np.full((1, 1), value, complex) for value in (start, centre, way)
        )
        return cls(start_point, centre_point, spin, along)

    def place(self, q: FloatArray) -> ComplexArray:
        """The places [mm] at the coordinates q."""
        turned: ComplexArray = self.centre + (self.start - self.centre) * self.turn_factor(q)
        return turned + self.way * q

    def turn_factor(self, q: FloatArray) -> ComplexArray:
        """exp(i s q), the factor by which vectors of the body turn."""
        factor: ComplexArray = np.exp(1j * self.spin * q)
        return factor

    def velocity(self, place: ComplexArray) -> ComplexArray:
        """Velocity of a point of the body that is at `place` [mm], per unit of q."""
        return self.way + 1j * self.spin * (place - self.centre)

    def acceleration(self, place: ComplexArray) -> ComplexArray:
        """Second derivative by q of a point of the body that is at `place` [mm]."""
        return -(self.spin**2) * (place - self.centre)

    def moved(self, by: ComplexArray, *, whole: bool = False) -> Pose:
        """The motion with the point displaced `by` [mm] at q = 0.

        If the `whole` body is displaced, its centre is too.
        """
        centre = self.centre + by if whole else self.centre
        return replace(self, start=self.start + by, centre=centre)

    def rotated(self, turn: ComplexArray) -> Pose:
        """The motion rotated about the origin by `turn`, a factor of magnitude 1."""
        return replace(
            self, start=self.start * turn, centre=self.centre * turn, way=self.way * turn
        )


# -- sensitivity ---------------------------------------------------------------------------------
# The error of the position where the machine deviates by one unit.


@dataclass(frozen=True)
class NominalMachine:
    """The nominal machine, with one flank that carries the follower.

    Attributes
    ----------
    cam : the cam of one disc.
    flank : the flank that carries the follower.
    hold : which side that is, of a follower that is held by two: the main disc or the return disc
        of a pair, or the first or the second side of a yoke.
    """

    cam: Cam
    flank: Flank
    hold: Hold = Hold.ANY

    def __post_init__(self) -> None:
        if self.flank not in self.cam.contact.flanks:
            used = " or ".join(f'"{flank}"' for flank in self.cam.contact.flanks)
            message = f"is not a flank on which the follower runs; must be {used}"
            raise GeometryError(message, "tolerance.flank", self.flank)

    def require_whole(self) -> None:
        """Raise GeometryError if the flank has corners: there the follower's motion is not a smooth
        function of any dimension.
        """
        outline = self.cam.disc.outline(self.flank)
        if outline.is_trimmed or not outline.path.is_whole:
            raise GeometryError(
                f"the {self.flank} flank of this {self.cam.follower.kind} follower has corners, by"
                " undercut or by a jump of the velocity: tolerances are analysed for flanks that"
                " are one smooth curve all round; `camgeo check` says what removes the corners,"
                " `camgeo replay` what the follower does there",
                key="follower",
            )

    @property
    def half_turn(self) -> bool:
        """Whether it is the side of a yoke that runs half a turn behind the first."""
        return self.hold is Hold.RETURN and self.cam.yoke is not None

    @property
    def linkage(self) -> Linkage | None:
        """The linkage behind the follower, if there is one."""
        return self.cam.drive.linkage

    @cached_property
    def pose(self) -> Pose:
        """The motion with the lift of the roller's centre, or of the foot of the cam axis on a flat
        face.
        """
        follower = self.cam.follower
        start, centre, way = (
            np.full((1, 1), value, complex)
            for value in (follower.traced_point(0.0), follower.pivot or 0.0, follower.way)
        )
        return Pose(start, centre, float(follower.swing_sense), way)

    def nominal(self, phi: FloatArray) -> Nominal:
        """The contact at the cam angles `phi` (n,) [rad], with right-hand values at jumps.

        Raises GeometryError where the roller centre stands still relative to the cam, and where the
        cam cannot move the follower.
        """
        pitch = self.cam.disc.pitch_curve
        relative = pitch.relative_jet(phi, order=1)
        places, rates = pitch.in_cam(relative, phi, relative.along[:2], relative.across[:2])
        leverage = pitch.leverage(phi)
        if np.any(leverage == 0.0):
            place = float(np.degrees(phi[np.argmin(np.abs(leverage))]))
            message = f"the cam cannot move the follower at cam angle {place:.6g} deg"
            raise GeometryError(f"{message}: its position there is no function of any dimension")
        # The normal i sigma t, with the unit tangent t, points outwards for either rotation.
        normals = 1j * pitch.rotation * rates / pitch.speed(relative)
        turn = np.exp(1j * pitch.rotation * phi)
        return Nominal(phi, places * turn, normals * turn, turn, leverage)


@dataclass(frozen=True, slots=True, eq=False)
class Nominal:
    """The contact of the nominal machine at n cam angles.

    Attributes
    ----------
    phi : (n,) [rad].
    places : (n,) W [mm], in the frame.
    normals : (n,) n, outward, in the frame.
    turn : (n,) exp(i sigma phi), from the axes of the cam to those of the frame.
    leverage : (n,) n . dW/dq [1 or mm/rad].
    """

    phi: FloatArray
    places: ComplexArray
    normals: ComplexArray
    turn: ComplexArray
    leverage: FloatArray

    def across(self, displacement: ComplexArray | complex) -> FloatArray:
        """(n,) component of a displacement in the frame along the normals [mm]."""
        return dot(self.normals, displacement)


@dataclass(frozen=True, eq=False)
class Sensitivities:
    """Sensitivities of a machine at cam angles.

    Attributes
    ----------
    machine : the nominal machine.
    phi : (n,) cam angles [rad].
    """

    machine: NominalMachine
    phi: FloatArray

    @cached_property
    def nominal(self) -> Nominal:
        """The contact of the nominal machine."""
        return self.machine.nominal(self.phi)

    @cached_property
    def lifts(self) -> Jet:
        """(4, n) lift of the follower and three derivatives."""
        return self.machine.cam.drive.motion.jet(self.phi)

    @cached_property
    def positions(self) -> Jet:
        """(4, n) position of the far end and three derivatives; without a linkage, the lift."""
        return self.machine.cam.drive.plan.jet(self.phi)

    @cached_property
    def far_end(self) -> FarEnd | None:
        """The far end of the linkage; None without a linkage."""
        linkage = self.machine.linkage
        return None if linkage is None else FarEnd.from_linkage(linkage)

    def position_error(self, unit: UnitDeviation) -> FloatArray:
        """(n,) error of the position [mm or rad] per unit of a dimension [mm or rad].

        Raises GeometryError with key "linkage" where the follower cannot move the far end.
        """
        follower = self.follower_error(unit)
        if self.far_end is None:
            return follower
        return self.far_end.sensitivity(unit, self.lifts[0], self.positions[0], follower)

    def follower_error(self, unit: UnitDeviation) -> FloatArray:
        """(n,) error of the follower's own lift per unit, where this side carries it."""
        if not unit.freedom.affects(self.machine.hold):
            return np.zeros(len(self.phi))
        if unit.freedom.way is Way.SETTING:
            return np.full(len(self.phi), -unit.factor.real / self._setting)
        return self._pushed(unit) / self.nominal.leverage

    @property
    def _setting(self) -> float:
        """Rate by the lift of the distance from the cam axis, at lift 0, where it is the base
        radius.

        Raises GeometryError if it is 0.
        """
        pose = self.machine.pose
        place = complex(pose.start[0, 0])
        rate = complex(pose.velocity(pose.start)[0, 0])
        radius_rate = (place.conjugate() * rate).real / abs(place)
        if radius_rate == 0.0:
            message = "does not say where the follower is: at lift 0 it is nearest to the cam axis"
            raise GeometryError(message, "follower.base_radius")
        return radius_rate

    def _pushed(self, unit: UnitDeviation) -> FloatArray:
        """(n,) n . (dR - dW) per unit of a dimension [mm]."""
        nominal, pose = self.nominal, self.machine.pose
        factor = unit.factor
        match unit.freedom.way:
            case Way.GROWTH:
                return np.full(len(self.phi), factor.real)
            case Way.WAVE:
                # The second side of a yoke meets the same flank half a turn later.
                later = np.pi if self.machine.half_turn else 0.0
                turned = np.exp(-1j * unit.freedom.waves * (self.phi + later))
                return np.asarray((factor * turned).real)
            case Way.SEAT:
                return nominal.across(factor * nominal.turn)
            case Way.TIMING:
                turn = 1j * self.machine.cam.rotation * nominal.places
                return factor.real * nominal.across(turn)
            case Way.SHAFT:
                return nominal.across(factor)
            case Way.PIVOT:
                return -nominal.across(factor)
            case Way.BODY:
                return -nominal.across(factor * pose.turn_factor(self.lifts[0]))
            case Way.TILT:
                return -factor.real * nominal.across(1j * nominal.places)
        return np.zeros(len(self.phi))


# -- far end --------------------------------------------------------------------------------------
# The linkage of a machine that deviates: from the follower's coordinate q to the far end's x.
#
# The pin J_f(x) on the far member and the joint J_n(q) on the follower's member are the ends of the
# coupler of length c: |D| = c with D = J_f - J_n. If the joints are displaced by dJ at the same
# coordinates,
#
#     Re(conj(D) (J_f' dx + dJ_f - J_n' dq - dJ_n)) = c dc.
#
# Displacements are relative to the frame of the far end: if the rocker's shaft is displaced, the
# far member's shaft or guide stays where it is.


ONE: Final = np.array([[1.0], [0.0]])
NONE: Final = np.zeros((2, 1))
"""Rates of a coordinate that moves, and of one that rests."""

STEPS: Final = 12
"""Largest number of Newton's steps; three or four are needed."""

SETTLED: Final = 1e-12
"""Residual of the coupler's length, relative to it, at which Newton's method has converged."""


@dataclass(frozen=True, slots=True, eq=False)
class FarEnd:
    """The joints of a linkage in the coordinates of its drawing, from the crank's nominal shaft.

    Attributes
    ----------
    linkage : the nominal linkage.
    near, far : joints on the follower's member and on the far member.
    coupler : its length c, (m, 1) or (1, 1) [mm].
    driven_crank : whether the crank is the far member.
    """

    linkage: Linkage
    near: Pose
    far: Pose
    coupler: FloatArray
    driven_crank: bool

    @classmethod
    def from_linkage(cls, linkage: Linkage) -> Self:
        """The joints of the nominal linkage."""
        places = [complex(joint[0]) for joint in linkage.joints(np.zeros(1))]
        demanded_rates = linkage.joint_rates(np.zeros(1), ONE, NONE)
        follower_rates = linkage.joint_rates(np.zeros(1), NONE, ONE)
        poses = []
        # Each joint is moved by one of the two coordinates alone, and the other adds nothing.
        for place, demanded, follows in zip(places, demanded_rates, follower_rates, strict=True):
            first, second = (complex(rate) for rate in (demanded + follows)[:, 0])
            poses.append(Pose.from_rates(place, first, second))
        driven = bool(demanded_rates[0][0, 0] == 0.0)  # the pin goes with the follower
        near, far = poses if driven else poses[::-1]
        return cls(linkage, near, far, np.full((1, 1), linkage.coupler), driven)

    def sensitivity(
        self, unit: UnitDeviation, lift: FloatArray, x: FloatArray, follower: FloatArray
    ) -> FloatArray:
        """(n,) displacement dx of the far end per unit of a dimension.

        Parameters
        ----------
        lift, x : (n,) coordinates of the follower and of the far end.
        follower : (n,) dq, the error of the follower's coordinate per unit.

        Raises GeometryError with key "linkage" where the follower cannot move the far end.
        """
        per_follower = self.linkage.per_follower(x)
        near, far = self.near.place(lift)[0], self.far.place(x)[0]
        coupler_vector = far - near
        displacement = np.zeros_like(coupler_vector)
        longer = 0.0  # of the coupler
        factor = unit.factor
        match unit.freedom.way:
            case Way.COUPLER:
                longer = factor.real * self.linkage.coupler
            case Way.CRANK:
                # A longer crank on the near side displaces J_n, which counts negatively.
                tip = far if self.driven_crank else -near
                displacement = factor * tip / np.abs(tip)
            case Way.LEVER:
                arm = far - self.far.centre[0]
                displacement = factor * arm / np.abs(arm)
            case Way.FAR_SHAFT:
                displacement = displacement + factor
            case Way.FAR_ANGLE:
                displacement = factor * 1j * (far - self.far.centre[0])
            case Way.PIVOT:
                # Relative to the rocker's shaft, the far joint is displaced the other way.
                displacement = displacement - factor
        rest = (longer - dot(coupler_vector, displacement)) / dot(
            coupler_vector, self.far.velocity(far)[0]
        )
        return per_follower * follower + rest

    def deviating(self, deviations: Deviations) -> FarEnd:
        """The joints (m, ...) of the linkages of machines that deviate."""
        near, far = self.near, self.far
        tip = far if self.driven_crank else near
        # The crank turns about the origin, so it becomes longer along the place of its pin.
        longer = tip.moved(tip.start / np.abs(tip.start) * deviations.real(Way.CRANK))
        near, far = (near, longer) if self.driven_crank else (longer, far)
        arm = (far.start - far.centre) * np.exp(1j * deviations.real(Way.FAR_ANGLE))
        if not self.driven_crank and far.spin != 0.0:
            arm = arm + arm / np.abs(arm) * deviations.real(Way.LEVER)
        far = replace(far, start=far.centre + arm)
        shifted = deviations.amounts(Way.FAR_SHAFT) - deviations.amounts(Way.PIVOT)
        far = far.moved(shifted, whole=True)
        coupler = self.coupler + deviations.real(Way.COUPLER)
        return replace(self, near=near, far=far, coupler=coupler)

    def follow(self, lifts: FloatArray, x: FloatArray) -> FloatArray:
        """(3, m, n) x and two derivatives for `lifts`, those of the follower (3, m, n).

        Parameters
        ----------
        x : (m, n) start of Newton's method.

        Raises
        ------
        GeometryError
            With key "linkage", if the linkage of a machine does not close.
        """
        near = self.near.place(lifts[0])
        for _ in range(STEPS):
            far = self.far.place(x)
            coupler_vector = far - near
            rate = dot(coupler_vector, self.far.velocity(far))
            # Half the difference of squares: its derivative by x is `rate`, without a square root.
            miss = 0.5 * (dot(coupler_vector, coupler_vector) - self.coupler**2)
            with np.errstate(divide="ignore", invalid="ignore"):
                x = x - miss / rate
            if not np.all(np.isfinite(x)):
                break
            if np.all(np.abs(miss) <= SETTLED * self.coupler**2):
                return np.stack((x, *self._rates(lifts, near, self.far.place(x))))
        raise GeometryError(
            "the linkage of a machine within the tolerances does not close: its dimensions are too"
            " close to a dead centre for them",
            key="linkage",
        )

    def _rates(
        self, lifts: FloatArray, near: ComplexArray, far: ComplexArray
    ) -> tuple[FloatArray, FloatArray]:
        """First and second derivative of x by the cam angle, from |D| = c differentiated twice."""
        coupler_vector = far - near
        far_velocity = self.far.velocity(far)
        near_velocity = self.near.velocity(near)
        rate = dot(coupler_vector, far_velocity)
        first = dot(coupler_vector, near_velocity) * lifts[1] / rate
        parting = far_velocity * first - near_velocity * lifts[1]
        bend = self.far.acceleration(far) * first**2 - self.near.acceleration(near) * lifts[1] ** 2
        rest = (
            dot(coupler_vector, near_velocity) * lifts[2]
            - dot(parting, parting)
            - dot(coupler_vector, bend)
        )
        return first, rest / rate


# -- stated ----------------------------------------------------------------------------------------
# The tolerances that a scene states in `[tolerance]`, with units converted.


Table = Mapping[str, Any]


@dataclass(frozen=True, slots=True)
class Moments:
    """Mean and variance of a random number."""

    mean: float
    variance: float


@dataclass(frozen=True, slots=True)
class Source:
    """A random cause of deviations: a dimension, a clearance, or an error of form.

    Attributes
    ----------
    name : its key in the scene.
    sense : the meaning of a positive deviation, in words.
    units : deviation of the machine per unit of each random number.
    moments : mean and variance of each of these numbers, which are uncorrelated; the two components
        of a random direction have the mean 0.
    draws : how many uniformly distributed numbers a machine needs.
    numbers : function that gives (units, m) numbers from shares (draws, m) in (0, 1).
    limits : limits of the stated deviation [mm or rad].
    shape : its distribution, in a word.
    is_angle : whether the deviation is an angle.
    """

    name: str
    sense: str
    units: tuple[UnitDeviation, ...]
    moments: Moments
    draws: int
    numbers: Callable[[FloatArray], FloatArray]
    limits: tuple[float, float]
    shape: str
    is_angle: bool = False


@dataclass(frozen=True)
class StatedTolerances:
    """The tolerances that a scene states, and the machine that they belong to.

    Attributes
    ----------
    machine : the nominal machine; if two sides hold the follower, with the main one carrying it.
    second : the same with the other side carrying it; None if there is only one.
    sources : the sources of deviations, in the order of the scene.
    limit : largest error of the position that is allowed [mm or rad]; None if there is none.
    zero_angle : cam angle [rad] at which the error is set to 0; None if it is not.
    """

    machine: NominalMachine
    second: NominalMachine | None
    sources: tuple[Source, ...]
    limit: float | None
    zero_angle: float | None

    @staticmethod
    def from_design(design: Design) -> StatedTolerances:
        """The tolerances of a design's scene.

        Raises
        ------
        SceneError
            If the scene states no tolerances, a key that is not a dimension of the machine (with
            the nearest one), an unknown tolerance class, a fit without clearance, or a side that
            the follower does not have.
        GeometryError
            If this kind of machine, or its flank, cannot be analysed.
        """
        scene = design.scene
        table: Table | None = scene.values.get(TOLERANCE)
        if table is None:
            message = "is missing: it states the tolerances, see docs/tolerance.md"
            raise _fault(scene, (TOLERANCE,), message)
        machine, second = side_machines(design, table.get("flank"))
        for side in (machine, second):
            if side is not None:
                side.require_whole()
        sides = Sides(scene, machine, second)
        sources = (*_dimensions(sides, table), *_fits(sides, table), *_forms(sides, table))
        limit, zero_angle = table.get("limit"), table.get("set_at")
        # The limit is stated in the unit of the position.
        per = math.radians(1.0) if design.drive.unit == "rad" else MM_PER[scene.unit]
        return StatedTolerances(
            machine,
            second,
            sources,
            None if limit is None else float(limit) * per,
            None if zero_angle is None else math.radians(zero_angle),
        )


def side_machines(
    design: Design, flank: str | None = None
) -> tuple[NominalMachine, NominalMachine | None]:
    """The machine of a design with the follower on a flank, by default its main one.

    The second machine is that with the other side carrying the follower; None if there is only one.
    """
    cam, *others = design.cams
    if cam.opposite is not None:
        others = [cam.opposite]
    main = Hold.MAIN if others else Hold.ANY
    second = [NominalMachine(other, Flank(other.contact.main), Hold.RETURN) for other in others]
    return NominalMachine(cam, Flank(flank or cam.contact.main), main), second[
        0
    ] if second else None


@dataclass(frozen=True)
class Sides:
    """The machine of a scene with each of the sides that hold its follower."""

    scene: Scene
    machine: NominalMachine
    second: NominalMachine | None

    def side_hold(self, place: KeyPath, table: Table, *, is_disc: bool) -> Hold:
        """The side that a fit or an error of form belongs to.

        Both sides of a yoke run on one disc, so an error of the disc (`is_disc`) belongs to both.
        """
        whole = self.second is None or (is_disc and self.second.cam.mount is None)
        if whole and "side" in table:
            what = "has one disc" if self.second is not None else "is held by one side"
            raise _fault(self.scene, (*place, "side"), f"belongs to two: this follower {what}")
        return Hold.ANY if whole else Hold(table.get("side", Hold.MAIN))


def _fault(scene: Scene, path: KeyPath, message: str, hint: str = "") -> SceneError:
    return SceneError([scene.stated.scene.fault(path, message, hint)], scene.source.file)


def _dimensions(sides: Sides, table: Table) -> Iterator[Source]:
    scene, machine = sides.scene, sides.machine
    known = machine_dimensions(machine, sides.second)
    for index, entry in enumerate(table.get("dimension", ())):
        key, place = entry["key"], (TOLERANCE, "dimension", index)
        if key not in known:
            kind = machine.cam.follower.kind
            message = f"is no dimension of this {kind} machine; it has {listed(sorted(known))}"
            raise _fault(scene, (*place, "key"), message, meant(key, known))
        dimension = known[key]
        distribution = _distribution(scene, place, entry, dimension)
        yield Source(
            key,
            dimension.sense,
            (dimension.unit,),
            Moments(distribution.mean, distribution.variance),
            1,
            distribution.quantile,
            (distribution.low, distribution.high),
            distribution.shape,
            dimension.is_angle,
        )


def _distribution(scene: Scene, place: KeyPath, table: Table, dimension: Dimension) -> Distribution:
    mm = MM_PER[scene.unit]
    per = math.radians(1.0) if dimension.is_angle else mm
    if "class" in table:
        if dimension.size is None:
            message = "belongs to lengths: this dimension takes plus_minus or limits"
            raise _fault(scene, (*place, "class"), message)
        # A class limits the size, as a diameter, of which the dimension may be half.
        low, high = (
            deviation * dimension.per_size
            for deviation in _class(scene, (*place, "class"), table["class"], dimension.size)
        )
    elif "limits" in table:
        low, high = (float(limit) * per for limit in table["limits"])
    else:
        high = float(table["plus_minus"]) * per
        low = -high
    shape: Shape = table.get("distribution", "normal")
    sigma = table.get("sigma")
    return Distribution(low, high, shape, None if sigma is None else float(sigma) * per)


def _class(scene: Scene, path: KeyPath, name: str, size: float) -> tuple[float, float]:
    try:
        return class_limits(name, size)
    except GeometryError as error:
        raise _fault(scene, path, error.message) from error


def _fits(sides: Sides, table: Table) -> Iterator[Source]:
    scene, machine = sides.scene, sides.machine
    for index, entry in enumerate(table.get("clearance", ())):
        place = (TOLERANCE, "clearance", index)
        size = _size(scene, place, entry)
        limits = {}
        for key, hole in (("hole", True), ("shaft", False)):
            if is_hole(entry[key]) is not hole:
                letters = "a capital letter" if hole else "a small letter"
                raise _fault(scene, (*place, key), f"must begin with {letters}")
            limits[key] = _class(scene, (*place, key), entry[key], size)
        if limits["hole"][0] < limits["shaft"][1]:
            interference = PER_MM * (limits["shaft"][1] - limits["hole"][0])
            message = (
                f"is no fit with clearance: {entry['hole']}/{entry['shaft']} may interfere by"
                f" {interference:.4g} micrometres; leave it out, or state a looser fit"
            )
            raise _fault(scene, place, message)
        hold = sides.side_hold(place, entry, is_disc=entry["at"] == "cam")
        yield _clearance(place, entry, hold, machine.flank, limits)


def _size(scene: Scene, place: KeyPath, table: Table) -> float:
    """The nominal diameter of a fit [mm]: as stated, or that of the bore."""
    if "size" in table:
        return float(table["size"]) * MM_PER[scene.unit]
    if scene.part is None or scene.part.bore is None:
        message = "is missing: the scene has no part.bore, whose diameter is the default"
        raise _fault(scene, (*place, "size"), message)
    return scene.part.bore


def _clearance(
    place: KeyPath,
    table: Table,
    hold: Hold,
    flank: Flank,
    limits: Mapping[str, tuple[float, float]],
) -> Source:
    """The source that a fit with clearance is: in the direction of the load, or in any."""
    shape: Shape = table.get("distribution", "normal")
    hole, shaft = (Distribution(*limits[key], shape) for key in ("hole", "shaft"))
    # Moments of half the clearance, by which the centre of one may be off that of the other.
    half = Moments(0.5 * (hole.mean - shaft.mean), 0.25 * (hole.variance + shaft.variance))
    ends = hole.low - shaft.high, hole.high - shaft.low
    name = f"{spelled(place[1:])} {table['hole']}/{table['shaft']}"
    at_cam = table["at"] == "cam"
    if at_cam and table.get("shifted", "anywhere") == "anywhere":
        axes = _both_axes(Freedom(Way.SEAT, hold=hold))
        # In a random direction, each component has half the mean square of the distance.
        moments = Moments(0.0, 0.5 * (half.mean**2 + half.variance))
        what, numbers = "the cam lies anywhere in its clearance", partial(_anywhere, hole, shaft)
        return Source(name, what, axes, moments, 3, numbers, ends, shape)
    what = f"the load pushes the {'cam' if at_cam else 'roller'} back"
    # The load pushes the follower towards the material by half the clearance.
    unit = UnitDeviation(Freedom(Way.GROWTH, hold=hold), float(flank.sign))
    return Source(name, what, (unit,), half, 2, partial(_pressed, hole, shaft), ends, shape)


def _forms(sides: Sides, table: Table) -> Iterator[Source]:
    for index, entry in enumerate(table.get("form", ())):
        height = float(entry["plus_minus"]) * MM_PER[sides.scene.unit]
        waves = int(entry["waves"])
        hold = sides.side_hold((TOLERANCE, "form", index), entry, is_disc=True)
        yield Source(
            f"form[{index + 1}]",
            f"{waves} waves on the flank",
            _both_axes(Freedom(Way.WAVE, waves, hold)),  # in phase and a quarter of a wave later
            Moments(0.0, 0.5 * height**2),  # at any place the phase is uniformly distributed
            1,
            partial(_wave_components, height),
            (-height, height),
            "random phase",
        )


def _both_axes(freedom: Freedom) -> tuple[UnitDeviation, ...]:
    return UnitDeviation(freedom), UnitDeviation(freedom, 1j)


def _pressed(hole: Distribution, shaft: Distribution, shares: FloatArray) -> FloatArray:
    """(1, m) half the clearance [mm].

    A normal distribution exceeds its limits, but a clearance is never negative.
    """
    clearance = hole.quantile(shares[0]) - shaft.quantile(shares[1])
    return (0.5 * np.maximum(clearance, 0.0))[np.newaxis]


def _anywhere(hole: Distribution, shaft: Distribution, shares: FloatArray) -> FloatArray:
    """(2, m) components of half the clearance [mm] in a random direction."""
    (sizes,) = _pressed(hole, shaft, shares[:2])
    return _vector_components(sizes, shares[2])


def _wave_components(height: float, shares: FloatArray) -> FloatArray:
    """(2, m) components of a wave of the amplitude `height` [mm] with a random phase."""
    return _vector_components(np.full(shares.shape[1], height), shares[0])


def _vector_components(sizes: FloatArray, shares: FloatArray) -> FloatArray:
    """(2, m) components of vectors with `sizes` (m,) and directions as shares (m,) of a turn."""
    angle = TURN * shares
    return np.stack((sizes * np.cos(angle), sizes * np.sin(angle)))


# -- distribution ---------------------------------------------------------------------------------
# The distribution of a deviation between its limits.


Shape = Literal["normal", "uniform", "triangular"]

SHAPES: Final[tuple[Shape, ...]] = ("normal", "uniform", "triangular")

SIGMAS: Final = 3.0
"""Standard deviations from the mean of a normal distribution to its limits, by default."""

WIDTHS: Final[dict[Shape, float]] = {
    "normal": SIGMAS,
    "uniform": math.sqrt(3.0),
    "triangular": math.sqrt(6.0),
}
"""Half the range between the limits, in standard deviations."""


@dataclass(frozen=True, slots=True)
class Distribution:
    """A random deviation [mm or rad].

    Attributes
    ----------
    low, high : its limits; a normal distribution exceeds them.
    shape : kind of distribution; all are symmetric about the middle of the limits.
    stated : the standard deviation, if it is stated; None if it follows from limits and shape.
    """

    low: float
    high: float
    shape: Shape = "normal"
    stated: float | None = None

    @property
    def mean(self) -> float:
        """Expected value of the deviation."""
        return 0.5 * (self.low + self.high)

    @property
    def sigma(self) -> float:
        """Standard deviation of the deviation."""
        if self.stated is not None:
            return self.stated
        return 0.5 * (self.high - self.low) / WIDTHS[self.shape]

    @property
    def variance(self) -> float:
        """Variance of the deviation."""
        return self.sigma**2

    def quantile(self, share: FloatArray) -> FloatArray:
        """(n,) quantiles: the values below which the shares (n,) in (0, 1) of all values lie."""
        unit = _NORMALISED[self.shape](share)
        return self.mean + self.sigma * unit


def _normal(share: FloatArray) -> FloatArray:
    """Quantile of the standard normal distribution of each `share` in (0, 1)."""
    from scipy.special import ndtri  # loaded only where random numbers are drawn

    return np.asarray(ndtri(share))


def _uniform(share: FloatArray) -> FloatArray:
    return WIDTHS["uniform"] * (2.0 * share - 1.0)


def _triangular(share: FloatArray) -> FloatArray:
    # From the nearer end, so that shares near 1 lose no digits.
    low = share < 0.5
    tail = np.where(low, share, 1.0 - share)
    rest = WIDTHS["triangular"] * (1.0 - np.sqrt(2.0 * tail))
    return np.where(low, -rest, rest)


_NORMALISED: Final = {"normal": _normal, "uniform": _uniform, "triangular": _triangular}
"""Quantiles with the mean 0 and the standard deviation 1."""


# -- dimensions -----------------------------------------------------------------------------------
# The dimensions of a machine that may have tolerances, and the freedoms in which they deviate.
#
# Dimensions of certain followers and linkages are registered by class.


@dataclass(frozen=True, slots=True)
class Dimension:
    """A dimension of the machine.

    Attributes
    ----------
    unit : deviation of the machine where the dimension is 1 mm or 1 rad too large.
    sense : the meaning of a positive deviation, in words.
    size : the nominal size [mm] for tolerance classes; None if they do not apply.
    per_size : deviation of the dimension per deviation of that size, as a radius of a diameter.
    is_angle : whether the dimension is an angle.
    """

    unit: UnitDeviation
    sense: str
    size: float | None = None
    per_size: float = 1.0
    is_angle: bool = False

    def of_side(self, hold: Hold) -> Dimension:
        """The same dimension of one side alone, of a follower that is held by two."""
        return replace(self, unit=self.unit.of_side(hold))


MOUNTING: Final[Mapping[str, Dimension]] = {
    "mounting.x": Dimension(
        UnitDeviation(Freedom(Way.SEAT)), "the flank lies farther along x of the cam, on its shaft"
    ),
    "mounting.y": Dimension(
        UnitDeviation(Freedom(Way.SEAT), 1j),
        "the flank lies farther along y of the cam, on its shaft",
    ),
    "mounting.angle": Dimension(
        UnitDeviation(Freedom(Way.TIMING)),
        "the disc runs ahead of its shaft, as it turns",
        is_angle=True,
    ),
    "shaft.x": Dimension(UnitDeviation(Freedom(Way.SHAFT)), "the cam axis lies farther along x"),
    "shaft.y": Dimension(
        UnitDeviation(Freedom(Way.SHAFT), 1j), "the cam axis lies farther along y"
    ),
}
"""Dimensions that every machine has but no scene states, by the keys that tolerances use."""


TOUCHING: Final = frozenset((Way.GROWTH, Way.BODY))
"""Freedoms of one side alone on any follower that is held by two sides."""

OF_A_DISC: Final = frozenset((Way.SEAT, Way.TIMING))
"""Freedoms of one side alone where each side has a disc."""


def machine_dimensions(
    machine: NominalMachine, second: NominalMachine | None = None
) -> dict[str, Dimension]:
    """All dimensions of the machine, by their keys; `second` is its other side, if there is one."""
    dimensions = dict(MOUNTING)
    side_dimensions = _follower(machine.cam.follower, machine)
    dimensions.update({f"follower.{key}": dimension for key, dimension in side_dimensions.items()})
    if second is not None:
        mount = second.cam.mount
        mine = TOUCHING if mount is None else TOUCHING | OF_A_DISC
        for key, dimension in dimensions.items():
            if dimension.unit.freedom.way in mine:
                dimensions[key] = dimension.of_side(Hold.MAIN)
        side_dimensions = (
            _yoke(second) if mount is None else _returning(second.cam.follower, second)
        )
        table = "follower.yoke" if mount is None else "follower.return"
        others = {f"{table}.{key}": dimension for key, dimension in side_dimensions.items()}
        if mount is not None:
            others |= {
                f"return.{key}": dimension for key, dimension in MOUNTING.items() if "mount" in key
            }
        dimensions.update(
            {key: dimension.of_side(Hold.RETURN) for key, dimension in others.items()}
        )
    if machine.linkage is not None:
        behind = _linkage(machine.linkage)
        dimensions.update({f"linkage.{key}": dimension for key, dimension in behind.items()})
    return dimensions


def _length(way: Way, sense: str, size: float, factor: complex = 1.0) -> Dimension:
    return Dimension(UnitDeviation(Freedom(way), factor), sense, size)


def _radius(follower: Follower, machine: NominalMachine) -> dict[str, Dimension]:
    if follower.has_edge:
        return {}
    unit = UnitDeviation(Freedom(Way.GROWTH), float(-machine.flank.sign))
    diameter = 2.0 * follower.roller_radius
    return {"roller_radius": Dimension(unit, "the roller is larger", diameter, 0.5)}


def _setting() -> dict[str, Dimension]:
    sense = "the lift is counted from farther outward"
    return {"base_radius": Dimension(UnitDeviation(Freedom(Way.SETTING)), sense)}


def _place(way: Way, key: str, what: str) -> dict[str, Dimension]:
    return {
        f"{key}[1]": Dimension(UnitDeviation(Freedom(way)), f"{what} lies farther along x"),
        f"{key}[2]": Dimension(UnitDeviation(Freedom(way), 1j), f"{what} lies farther along y"),
    }


@singledispatch
def _follower(_: Follower, __: NominalMachine) -> dict[str, Dimension]:
    """The dimensions of a follower, by their keys in its table."""
    return {}


def _guide_angle() -> dict[str, Dimension]:
    unit = UnitDeviation(Freedom(Way.TILT))
    sense = "the guide is turned counter-clockwise about the cam axis"
    return {"guide_angle": Dimension(unit, sense, is_angle=True)}


@_follower.register
def _(follower: TranslatingRoller, machine: NominalMachine) -> dict[str, Dimension]:
    right = -1j * follower.outward
    sense = "the roller's path lies farther to the right, looking along the guide"
    offset = {"offset": Dimension(UnitDeviation(Freedom(Way.BODY), right), sense)}
    return _radius(follower, machine) | _setting() | offset | _guide_angle()


@_follower.register
def _(follower: OscillatingRoller, machine: NominalMachine) -> dict[str, Dimension]:
    along = follower.start_arm / abs(follower.start_arm)
    arm = {"arm": _length(Way.BODY, "the arm is longer", follower.arm, along)}
    place = _place(Way.PIVOT, "pivot", "the rocker's shaft")
    return _radius(follower, machine) | _setting() | arm | place


@_follower.register
def _(_: TranslatingFlat, __: NominalMachine) -> dict[str, Dimension]:
    return _setting() | _guide_angle()


@_follower.register
def _(follower: OscillatingFlat, _: NominalMachine) -> dict[str, Dimension]:
    foot = follower.traced_point(0.0)
    unit = UnitDeviation(Freedom(Way.BODY), foot / abs(foot))
    sense = "the face lies farther from the cam axis on its rocker"
    face = {"face_offset": Dimension(unit, sense)}
    return _setting() | face | _place(Way.PIVOT, "pivot", "the rocker's shaft")


def _yoke(second: NominalMachine) -> dict[str, Dimension]:
    """The dimensions of the second side of a yoke, by their keys in its table."""
    follower = second.cam.follower
    place = follower.traced_point(0.0)
    breadth = _length(
        Way.BODY, "the second side lies farther from the first",
        second.cam.yoke_breadth, place / abs(place),
    )  # fmt: skip
    dimensions = _follower(follower, second)
    return {"breadth": breadth} | {
        key: dimensions[key] for key in dimensions if key == "roller_radius"
    }


@singledispatch
def _returning(_: Follower, __: NominalMachine) -> dict[str, Dimension]:
    """The dimensions of the return roller of a pair, by their keys in its table."""
    return {}


@_returning.register
def _(follower: TranslatingRoller, second: NominalMachine) -> dict[str, Dimension]:
    assert second.cam.mount is not None
    right = 1j * follower.outward  # the main roller looks the other way
    offset = UnitDeviation(Freedom(Way.BODY), right)
    spacing = dict(second.cam.mount.arguments)["spacing"]
    return {
        "spacing": _length(
            Way.BODY, "the return roller lies farther from the main one", spacing, follower.outward
        ),
        "offset": Dimension(offset, "the return roller's path lies farther to the right"),
        **_radius(follower, second),
    }


@_returning.register
def _(follower: OscillatingRoller, second: NominalMachine) -> dict[str, Dimension]:
    along = follower.start_arm / abs(follower.start_arm)
    turned = Dimension(
        UnitDeviation(Freedom(Way.BODY), 1j * follower.start_arm),
        "the return arm is turned counter-clockwise against the main one",
        is_angle=True,
    )
    return {
        "arm": _length(Way.BODY, "the return arm is longer", follower.arm, along),
        "arm_angle": turned,
        **_radius(follower, second),
    }


@singledispatch
def _linkage(linkage: Linkage) -> dict[str, Dimension]:
    """The dimensions that all linkages have, by their keys in the table."""
    return {
        "crank": _length(Way.CRANK, "the crank is longer", linkage.crank),
        "coupler": _length(Way.COUPLER, "the coupler is longer", linkage.coupler),
    }


@_linkage.register
def _(linkage: FourBar) -> dict[str, Dimension]:
    angle = Dimension(
        UnitDeviation(Freedom(Way.FAR_ANGLE)),
        "the lever's pin is turned counter-clockwise on the lever",
        is_angle=True,
    )
    return {
        **_linkage.dispatch(object)(linkage),
        "lever": _length(Way.LEVER, "the lever is longer", linkage.lever),
        **_place(Way.FAR_SHAFT, "shaft", "the lever's shaft"),
        "lever_angle": angle,
    }


# -- iso286 ---------------------------------------------------------------------------------------
# Tolerance classes of ISO 286-1, as "H7" of a hole and "g6" of a shaft. Values are in iso286.json.


FORM: Final = re.compile(r"(?P<letters>[A-Za-z]{1,2})(?P<grade>\d{1,2})")

SHAFTS: Final = (
    "a", "b", "c", "d", "e", "f", "g", "h", "js", "k", "m", "n", "p", "r", "s", "t", "u",
)  # fmt: skip

HOLES: Final = tuple(letter.upper() for letter in SHAFTS)

K_GRADES: Final = range(4, 8)
"""Grades in which a shaft k has a fundamental deviation other than 0."""

SMALLEST: Final = 3.0
"""Size [mm] up to which the deviations of all holes are those of the shafts, reversed."""

PER_MM: Final = 1000.0
"""Micrometres in a millimetre: values of the standard are in micrometres."""


def class_limits(name: str, size: float) -> tuple[float, float]:
    """Lower and upper deviation [mm] of a size [mm] in the tolerance class `name`.

    Raises
    ------
    GeometryError
        If the class is unknown, the size is not above 0 and up to 500 mm, or ISO 286-1 has no value
        of the class for this size.
    """
    data = _data()
    parts = FORM.fullmatch(name)
    letters, number = (parts["letters"], parts["grade"]) if parts else ("", "")
    if letters not in (*HOLES, *SHAFTS) or number not in data["grades"]:
        grades = [f"IT{number}" for number in data["grades"]]
        raise GeometryError(
            "is not a known tolerance class: allowed are a letter of holes"
            f" ({listed(HOLES)}) or of shafts ({listed(SHAFTS)}) and a grade from {grades[0]} to"
            f' {grades[-1]}, e.g. "H7"',
            value=name,
        )
    most = data["up_to"][-1]
    if not 0.0 < size <= most:
        message = f"belongs to sizes above 0 up to {most} mm, and this one is {size:g} mm"
        raise GeometryError(message, value=name)
    grade = int(number)
    _require_value(name, letters, grade, size)
    width = _standard(grade, size) / PER_MM
    letter = letters.lower()
    if letter == "js":  # symmetric about the size
        return -0.5 * width, 0.5 * width
    # Shafts of these letters lie below the size, and holes above it by as much.
    if letter in data["upper"]:
        high = _size_value(data["upper"][letter], size) / PER_MM
        return (0.0 - high, width - high) if is_hole(name) else (high - width, high)
    if is_hole(name):
        high = _highest(letters, grade, size) / PER_MM
        return high - width, high
    zero = letter == "k" and grade not in K_GRADES
    low = 0.0 if zero else _size_value(data["lower"][letter], size) / PER_MM
    return low, low + width


def _require_value(name: str, letters: str, grade: int, size: float) -> None:
    for absence in _data()["absent"]:
        (first, last), (lower, upper) = absence["grades"], absence["sizes"]
        known = letters in absence.get("letters", letters)
        if known and first <= grade <= last and lower < size <= upper:
            raise GeometryError(
                f"has no value in ISO 286-1: there are none of {letters}{first} to"
                f" {letters}{last} for sizes above {lower} up to {upper} mm, and this one is"
                f" {size:g} mm",
                value=name,
            )


def _highest(letters: str, grade: int, size: float) -> float:
    """Upper deviation [micrometres] of a hole K to U: that of its shaft, reversed, plus delta.

    With delta, the hole with a shaft of the next finer grade gives the same fit as in the basic
    hole system.
    """
    data = _data()
    high = 0.0 - _size_value(data["lower"][letters.lower()], size)
    if size <= SMALLEST:
        return high
    # Coarser grades have no delta; a hole N then ends at the size itself.
    if grade > data["delta_up_to"][letters]:
        return 0.0 if letters == "N" else high
    nearer = data["exceptions"].get(f"{letters}{grade}")
    if nearer and nearer["sizes"][0] < size <= nearer["sizes"][1]:
        return float(nearer["high"])
    return high + _standard(grade, size) - _standard(grade - 1, size)


def _standard(grade: int, size: float) -> float:
    """The standard tolerance IT of a grade [micrometres]."""
    return _size_value(_data()["grades"][str(grade)], size)


def _size_value(values: Sequence[float], size: float) -> float:
    """The value for the range of sizes that `size` is in; some letters have finer ranges."""
    data = _data()
    ranges = next(
        bounds for bounds in (data["up_to"], data["up_to_finely"]) if len(bounds) == len(values)
    )
    return float(values[bisect_left(ranges, size)])  # a range includes its upper end


def is_hole(name: str) -> bool:
    """Whether a valid tolerance class is one of holes, which have capital letters."""
    return name[:1].isupper()


@cache
def _data() -> dict[str, Any]:
    return stored_schema(__file__, "iso286")
