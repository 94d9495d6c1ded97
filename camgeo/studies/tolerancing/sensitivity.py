"""Ways in which a machine deviates, and exact sensitivities: how far its position errs per unit of
each.

By virtual displacements; nothing is sampled but the cam angle. With R the place on the cam, in the
frame, of what touches it, n the unit normal there and W the same place on the follower, contact is
R = W; a flat face touches where it is tangent. Where R is displaced by dR and W, at the same lift,
by dW,

    dq = n . (dR - dW) / (n . dW/dq),

q the lift; n . dW/dq is `PitchCurve.leverage`, in which the transmission angle is. So a roller that
is too large, whose centre is pushed outward, raises it by its excess over the leverage.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from enum import Enum, StrEnum
from functools import cached_property
from typing import Final, Self

import numpy as np

from camgeo.cam.cam import Cam
from camgeo.errors import GeometryError
from camgeo.geometry.outline.path import Flank
from camgeo.kinematics.mechanism.linkage import Linkage
from camgeo.kinematics.motion import Jet
from camgeo.numeric.arrays import ComplexArray, FloatArray, dot

# -- freedoms -------------------------------------------------------------------------------------
# The ways in which an assembled machine can deviate from the one that its cam was made for.
#
# Angles count counter-clockwise, and places are complex, in mm. A freedom takes a number: real, or
# complex where it says so.


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
    """Which of the two sides that hold a follower; a follower on one flank has none of them."""

    ANY = "any"
    MAIN = "main"
    RETURN = "return"


@dataclass(frozen=True, slots=True)
class Freedom:
    """One way to deviate.

    Attributes
    ----------
    way : what deviates.
    waves : k, of a `WAVE`; 0 for all others.
    hold : the side that deviates, of a follower that two sides hold.
    """

    way: Way
    waves: int = 0
    hold: Hold = Hold.ANY

    def met_by(self, hold: Hold) -> bool:
        """Whether a side deviates."""
        return self.hold in (Hold.ANY, hold)


@dataclass(frozen=True, slots=True)
class Unit:
    """How a dimension deviates by one: in a freedom, by a factor."""

    freedom: Freedom
    factor: complex = 1.0

    def of_side(self, hold: Hold) -> Unit:
        """The same of one side alone."""
        return replace(self, freedom=replace(self.freedom, hold=hold))


@dataclass(frozen=True, slots=True, eq=False)
class Deviations:
    """The deviations of m machines.

    Attributes
    ----------
    count : m.
    values : (m,) complex of each freedom; 0 of one that is missing.
    """

    count: int
    values: Mapping[Freedom, ComplexArray]

    def met_by(self, hold: Hold, *, half_turn: bool) -> Deviations:
        """As one side has them: by its own freedoms; if it lies half a turn from the main side of
        the same disc, it meets each wave as much later.
        """
        values: dict[Freedom, ComplexArray] = {}
        for freedom, found in self.values.items():
            if freedom.met_by(hold):
                bare = replace(freedom, hold=Hold.ANY)
                sign = -1.0 if half_turn and freedom.waves % 2 else 1.0
                values[bare] = values.get(bare, 0.0) + sign * found
        return Deviations(self.count, values)

    def of(self, way: Way) -> ComplexArray:
        """(m, 1) complex deviations; zeros if there are none."""
        found = self.values.get(Freedom(way))
        return np.zeros((self.count, 1), complex) if found is None else found[:, np.newaxis]

    def real(self, way: Way) -> FloatArray:
        """(m, 1) deviations in a freedom that takes real numbers."""
        return np.asarray(self.of(way).real)

    @property
    def waves(self) -> Mapping[int, ComplexArray]:
        """(m, 1) complex amplitudes by the number of waves."""
        return {
            freedom.waves: found[:, np.newaxis]
            for freedom, found in self.values.items()
            if freedom.way is Way.WAVE
        }


# -- pose -----------------------------------------------------------------------------------------
# How a body moves with one coordinate: along a line, or about a point.


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
    def of_rates(cls, start: complex, first: complex, second: complex) -> Self:
        """From the place [mm] at q = 0 and two derivatives; Z'' = -(Z - C) if it turns."""
        turns = second != 0.0
        centre = start + second if turns else 0.0
        spin = float(np.sign((first / (start - centre)).imag)) if turns else 0.0
        way = 0.0 if turns else first
        start_at, centre_at, along = (
            np.full((1, 1), each, complex) for each in (start, centre, way)
        )
        return cls(start_at, centre_at, spin, along)

    def at(self, q: FloatArray) -> ComplexArray:
        """The places [mm] at the coordinates q."""
        turned: ComplexArray = self.centre + (self.start - self.centre) * self.turned(q)
        return turned + self.way * q

    def turned(self, q: FloatArray) -> ComplexArray:
        """exp(i s q)."""
        found: ComplexArray = np.exp(1j * self.spin * q)
        return found

    def velocity(self, place: ComplexArray) -> ComplexArray:
        """Of a point of the body that is at `place` [mm], per unit of q."""
        return self.way + 1j * self.spin * (place - self.centre)

    def acceleration(self, place: ComplexArray) -> ComplexArray:
        """The derivative of that."""
        return -(self.spin**2) * (place - self.centre)

    def moved(self, by: ComplexArray, *, whole: bool = False) -> Pose:
        """With the point displaced `by` [mm] at q = 0, with the centre if the `whole` is."""
        centre = self.centre + by if whole else self.centre
        return replace(self, start=self.start + by, centre=centre)

    def rotated(self, turn: ComplexArray) -> Pose:
        """Multiplied by `turn`, of magnitude 1: about the origin."""
        return replace(
            self, start=self.start * turn, centre=self.centre * turn, way=self.way * turn
        )


# -- sensitivity ---------------------------------------------------------------------------------
# How far the position errs where the machine deviates by a unit.


@dataclass(frozen=True)
class Machine:
    """The nominal machine, where one flank carries the follower.

    Attributes
    ----------
    cam : of one disc.
    flank : that carries the follower.
    hold : the side that it is of a follower that two sides hold: the main disc or the return disc
        of a pair, or the first or the second side of a yoke.
    """

    cam: Cam
    flank: Flank
    hold: Hold = Hold.ANY

    def __post_init__(self) -> None:
        if self.flank not in self.cam.contact.flanks:
            used = " or ".join(f'"{each}"' for each in self.cam.contact.flanks)
            message = f"is not where the follower runs; must be {used}"
            raise GeometryError(message, "tolerance.flank", self.flank)

    def require_whole(self) -> None:
        """GeometryError if the flank is not the whole curve: at its corners the follower's motion
        is no smooth function of any dimension.
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
        """Behind the follower."""
        return self.cam.drive.linkage

    @cached_property
    def pose(self) -> Pose:
        """Of the roller's centre, or of the foot of the cam axis on a flat face, with the lift."""
        follower = self.cam.follower
        start, centre, way = (
            np.full((1, 1), each, complex)
            for each in (follower.traced_point(0.0), follower.pivot or 0.0, follower.way)
        )
        return Pose(start, centre, float(follower.swing_sense), way)

    def nominal(self, phi: FloatArray) -> Nominal:
        """The contact at the cam angles `phi` (n,) [rad], right-hand.

        Raises GeometryError where the roller centre stands still in the cam.
        """
        pitch = self.cam.disc.pitch_curve
        relative = pitch.relative_jet(phi, order=1)
        places, rates = pitch.in_cam(relative, phi, relative.along[:2], relative.across[:2])
        leverage = pitch.leverage(phi)
        if np.any(leverage == 0.0):
            place = float(np.degrees(phi[np.argmin(np.abs(leverage))]))
            message = f"the cam cannot move the follower at cam angle {place:.6g} deg"
            raise GeometryError(f"{message}: its position there is no function of any dimension")
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
        """(n,) [mm] part of a displacement in the frame along the normals."""
        return dot(self.normals, displacement)


@dataclass(frozen=True, eq=False)
class Sensitivities:
    """Of a machine at cam angles.

    Attributes
    ----------
    machine : the nominal one.
    phi : (n,) cam angles [rad].
    """

    machine: Machine
    phi: FloatArray

    @cached_property
    def nominal(self) -> Nominal:
        """The contact."""
        return self.machine.nominal(self.phi)

    @cached_property
    def lifts(self) -> Jet:
        """(4, n) of the follower, and derivatives."""
        return self.machine.cam.drive.motion.jet(self.phi)

    @cached_property
    def positions(self) -> Jet:
        """(4, n) of the far end, or of the follower if there is no linkage."""
        return self.machine.cam.drive.plan.jet(self.phi)

    @cached_property
    def far_end(self) -> FarEnd | None:
        """Of the linkage, if there is one."""
        linkage = self.machine.linkage
        return None if linkage is None else FarEnd.of(linkage)

    def of(self, unit: Unit) -> FloatArray:
        """(n,) error of the position [mm or rad] per unit of a dimension [mm or rad].

        Raises GeometryError with key "linkage" where the follower cannot move the far end.
        """
        follower = self.of_follower(unit)
        if self.far_end is None:
            return follower
        return self.far_end.sensitivity(unit, self.lifts[0], self.positions[0], follower)

    def of_follower(self, unit: Unit) -> FloatArray:
        """(n,) error of the follower's own lift, where this side carries it."""
        if not unit.freedom.met_by(self.machine.hold):
            return np.zeros(len(self.phi))
        if unit.freedom.way is Way.SETTING:
            return np.full(len(self.phi), -unit.factor.real / self._setting)
        return self._pushed(unit) / self.nominal.leverage

    @property
    def _setting(self) -> float:
        """Rate of the radius at lift 0, at which it is the base radius, per unit of lift.

        Raises GeometryError if it is 0.
        """
        pose = self.machine.pose
        place = complex(pose.start[0, 0])
        rate = complex(pose.velocity(pose.start)[0, 0])
        found = (place.conjugate() * rate).real / abs(place)
        if found == 0.0:
            message = "does not say where the follower is: at lift 0 it is nearest to the cam axis"
            raise GeometryError(message, "follower.base_radius")
        return found

    def _pushed(self, unit: Unit) -> FloatArray:
        """(n,) [mm] n . (dR - dW) per unit."""
        nominal, pose = self.nominal, self.machine.pose
        factor = unit.factor
        match unit.freedom.way:
            case Way.GROWTH:
                return np.full(len(self.phi), factor.real)
            case Way.WAVE:
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
                return -nominal.across(factor * pose.turned(self.lifts[0]))
            case Way.TILT:
                return -factor.real * nominal.across(1j * nominal.places)
        return np.zeros(len(self.phi))


# -- far end --------------------------------------------------------------------------------------
# The linkage of a machine that deviates: from the follower's coordinate q to the far end's x.
#
# The pin J_f(x) on the far member and the joint J_n(q) on the follower's member are the ends of the
# coupler of length c: with D = J_f - J_n, |D| = c. Where the joints are displaced by dJ at the same
# coordinates,
#
#     Re(conj(D) (J_f' dx + dJ_f - J_n' dq - dJ_n)) = c dc.
#
# The frame is that of the far end: if the rocker's shaft is displaced, the far member's shaft or
# guide stays where it is.


ONE: Final = np.array([[1.0], [0.0]])
NONE: Final = np.zeros((2, 1))
"""Rates of a coordinate that moves, and of one that rests."""

STEPS: Final = 12
"""Of Newton's method, which needs three or four."""

SETTLED: Final = 1e-12
"""Residual of the coupler, relative to its length."""


@dataclass(frozen=True, slots=True, eq=False)
class FarEnd:
    """The joints of a linkage, in the axes of its drawing, seen from the crank's nominal shaft.

    Attributes
    ----------
    linkage : the nominal one.
    near, far : joints on the follower's member and on the far one.
    coupler : c (m, 1) or (1, 1) [mm].
    driven_crank : whether the crank is the far member.
    """

    linkage: Linkage
    near: Pose
    far: Pose
    coupler: FloatArray
    driven_crank: bool

    @classmethod
    def of(cls, linkage: Linkage) -> Self:
        """Of the nominal linkage."""
        places = [complex(each[0]) for each in linkage.joints(np.zeros(1))]
        moved = linkage.joint_rates(np.zeros(1), ONE, NONE)
        own = linkage.joint_rates(np.zeros(1), NONE, ONE)
        poses = []
        for place, demanded, follows in zip(places, moved, own, strict=True):
            first, second = (complex(each) for each in (demanded + follows)[:, 0])
            poses.append(Pose.of_rates(place, first, second))
        driven = bool(moved[0][0, 0] == 0.0)  # the pin goes with the follower
        near, far = poses if driven else poses[::-1]
        return cls(linkage, near, far, np.full((1, 1), linkage.coupler), driven)

    def sensitivity(
        self, unit: Unit, lift: FloatArray, x: FloatArray, follower: FloatArray
    ) -> FloatArray:
        """(n,) dx of the far end per unit of a dimension.

        Parameters
        ----------
        lift, x : (n,) coordinates of the follower and of the far end.
        follower : (n,) dq of the follower's coordinate, at its own place.

        Raises GeometryError with key "linkage" where the follower cannot move the far end.
        """
        per_follower = self.linkage.per_follower(x)
        near, far = self.near.at(lift)[0], self.far.at(x)[0]
        apart = far - near
        moved = np.zeros_like(apart)
        longer = 0.0
        factor = unit.factor
        match unit.freedom.way:
            case Way.COUPLER:
                longer = factor.real * self.linkage.coupler
            case Way.CRANK:
                tip = far if self.driven_crank else -near
                moved = factor * tip / np.abs(tip)
            case Way.LEVER:
                arm = far - self.far.centre[0]
                moved = factor * arm / np.abs(arm)
            case Way.FAR_SHAFT:
                moved = moved + factor
            case Way.FAR_ANGLE:
                moved = factor * 1j * (far - self.far.centre[0])
            case Way.PIVOT:
                moved = moved - factor
        rest = (longer - dot(apart, moved)) / dot(apart, self.far.velocity(far)[0])
        return per_follower * follower + rest

    def deviating(self, deviations: Deviations) -> FarEnd:
        """The linkages (m, ...) of machines that deviate."""
        near, far = self.near, self.far
        tip = far if self.driven_crank else near
        longer = tip.moved(tip.start / np.abs(tip.start) * deviations.real(Way.CRANK))
        near, far = (near, longer) if self.driven_crank else (longer, far)
        arm = (far.start - far.centre) * np.exp(1j * deviations.real(Way.FAR_ANGLE))
        if not self.driven_crank and far.spin != 0.0:
            arm = arm + arm / np.abs(arm) * deviations.real(Way.LEVER)
        far = replace(far, start=far.centre + arm)
        shifted = deviations.of(Way.FAR_SHAFT) - deviations.of(Way.PIVOT)
        far = far.moved(shifted, whole=True)
        coupler = self.coupler + deviations.real(Way.COUPLER)
        return replace(self, near=near, far=far, coupler=coupler)

    def follow(self, lifts: FloatArray, x: FloatArray) -> FloatArray:
        """(3, m, n) x and two derivatives for lifts and derivatives (3, m, n) of the follower.

        Parameters
        ----------
        x : (m, n) near the answer.

        Raises
        ------
        GeometryError
            With key "linkage", if the linkage of a machine does not close.
        """
        near = self.near.at(lifts[0])
        for _ in range(STEPS):
            far = self.far.at(x)
            apart = far - near
            rate = dot(apart, self.far.velocity(far))
            miss = 0.5 * (dot(apart, apart) - self.coupler**2)
            with np.errstate(divide="ignore", invalid="ignore"):
                x = x - miss / rate
            if not np.all(np.isfinite(x)):
                break
            if np.all(np.abs(miss) <= SETTLED * self.coupler**2):
                return np.stack((x, *self._rates(lifts, near, self.far.at(x))))
        raise GeometryError(
            "the linkage of a machine within the tolerances does not close: its dimensions are too"
            " close to a dead centre for them",
            key="linkage",
        )

    def _rates(
        self, lifts: FloatArray, near: ComplexArray, far: ComplexArray
    ) -> tuple[FloatArray, FloatArray]:
        apart = far - near
        along = self.far.velocity(far)
        own = self.near.velocity(near)
        rate = dot(apart, along)
        first = dot(apart, own) * lifts[1] / rate
        parting = along * first - own * lifts[1]
        bend = self.far.acceleration(far) * first**2 - self.near.acceleration(near) * lifts[1] ** 2
        rest = dot(apart, own) * lifts[2] - dot(parting, parting) - dot(apart, bend)
        return first, rest / rate
