"""Roller followers, on a straight guide or on a rocker, and the second ones of conjugate cams."""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar, Final, Literal

import numpy as np

from camgeo.errors import GeometryError
from camgeo.kinematics.mechanism.follower import (
    Follower,
    Guided,
    RelativeJet,
    Rocking,
    TangentJet,
    WithRoller,
)
from camgeo.kinematics.mechanism.sketch import Dimension, MechanismSketch, Places
from camgeo.kinematics.mechanism.values import (
    Angle,
    Coordinate,
    Length,
    Place,
    Radius,
    Sense,
    angle,
    coordinate,
    length,
    radius,
)
from camgeo.kinematics.motion import FULL_ORDER, Jet
from camgeo.numeric.arrays import ComplexArray, FloatArray
from camgeo.numeric.checked import check_fields, instance
from camgeo.units import TURN


@dataclass(frozen=True, slots=True)
class TranslatingRoller(Guided, WithRoller):
    """Translating roller follower (Wirsig eqs. 2.56 to 2.63, sign of e corrected).

    With the guide upright (`guide_angle` pi/2) the guide line is x = e and the follower lies above
    the cam axis: W = e + i (s_G + kappa_F s), s_G = sqrt(r_G^2 - e^2). Other guide angles turn
    this about the cam axis.

    Attributes
    ----------
    base_radius : r_G, cam axis to roller centre at cam angle 0 [mm].
    roller_radius : r_R [mm].
    offset : e [mm], positive to the right of the cam axis when looking along the guide; |e| <= r_G.
    guide_angle : direction of the guide away from the cam, from the x axis [rad], -2 pi to 2 pi.
    direction : kappa_F, +1 if a positive lift moves the roller outward (F-cam), -1 inward (P-cam).

    Raises
    ------
    GeometryError
        With the key, if a value is invalid, or the offset exceeds the base radius.
    """

    kind: ClassVar = "translating-roller"

    base_radius: Length
    roller_radius: Radius
    offset: Coordinate = 0.0
    guide_angle: Angle = math.pi / 2.0
    direction: Sense = 1

    def __post_init__(self) -> None:
        check_fields(self, "follower.")
        if abs(self.offset) > self.base_radius:
            raise GeometryError(
                "the roller cannot lie on the base circle: the offset must not exceed"
                f" the base radius, {self.base_radius:g} mm",
                key="follower.offset",
                value=f"{self.offset:g}",
            )

    @property
    def start_arm(self) -> complex:
        """See `Follower`."""
        return complex(self.offset, self.start_height) * cmath.rect(
            1.0, self.guide_angle - 0.5 * math.pi
        )

    @property
    def start_height(self) -> float:
        """s_G, height of the roller centre over the cam axis at cam angle 0 [mm]."""
        return math.sqrt((self.base_radius - self.offset) * (self.base_radius + self.offset))

    def relative_jet(self, jet: Jet, rotation: int, order: int = FULL_ORDER) -> RelativeJet:
        """See `Follower.relative_jet`."""
        e, sense = self.offset, float(rotation * self.direction)
        along, across = np.empty((2, order + 1, jet.shape[1]))
        # Views of the rows of the result: what is written to them is written there.
        height, v = across[0], across[1]  # R_1 = sigma (u + i v), u the height
        np.multiply(jet[0], float(self.direction), out=height)
        height += self.start_height
        along[0] = e
        np.multiply(height, float(rotation), out=along[1])
        np.multiply(jet[1], float(self.direction), out=v)
        v -= rotation * e
        if order > 1:
            np.multiply(jet[1], 2.0 * sense, out=along[2])
            along[2] -= e
            np.multiply(jet[2], float(self.direction), out=across[2])
            across[2] -= height
        if order > 2:
            np.multiply(jet[2], 3.0 * sense, out=along[3])
            along[3] -= along[1]
            np.multiply(jet[1], -3.0 * self.direction, out=across[3])
            across[3] += self.direction * jet[3]
            across[3] += rotation * e
        axis = self.guide_angle - math.pi / 2.0
        return RelativeJet(along, across, axis, height, v, 0.0, self.reach)

    def tangent_jet(self, jet: Jet, rotation: int) -> TangentJet:
        """See `Follower.tangent_jet`."""
        u = self.direction * jet[:2]
        u[0] += self.start_height
        w = (rotation * self.direction) * jet[1:3]
        w[0] -= self.offset
        swerve = u[0] * (self.direction * (jet[1] + jet[3]))
        return TangentJet(u, w, np.zeros_like(swerve), swerve)

    def speed_bounds(self, jet: Jet, bounds: Jet, half: FloatArray, rotation: int) -> FloatArray:
        """See `Follower.speed_bounds`."""
        height = np.abs(self.start_height + self.direction * jet[0]) + bounds[0]
        radius = np.hypot(self.offset, height)
        return np.stack(
            (
                bounds[1] + radius,
                bounds[2] + 2.0 * bounds[1] + radius,
                bounds[3] + 3.0 * (bounds[2] + bounds[1]) + radius,
            )
        )

    def on_one_side(self, lifts: FloatArray) -> bool:
        """See `Follower.on_one_side`."""
        return bool(np.all(self.start_height + self.direction * lifts > 0.0))

    def sketch(
        self, lifts: FloatArray, farthest: float, _: tuple[float, float]
    ) -> MechanismSketch[Places]:
        """See `Follower.sketch`."""
        here = self.traced(lifts)
        sizes: list[Dimension[Places]] = [Dimension("base_radius", 0j, self.traced_point(0.0))]
        if self.offset != 0.0:
            aside = -1j * self.outward * self.offset
            sizes.append(Dimension("offset", 0j, aside, negative=self.offset < 0.0))
        roller = MechanismSketch(
            rollers=((here, self.roller_radius),),
            dimensions=(*sizes, *self.roller_size(here, -1j * self.outward)),
        )
        return self.rod(lifts, farthest) + roller

    def held(self, _: tuple[float, float]) -> tuple[Literal["guide"], complex, None]:
        """See `Follower.held`."""
        height = self.start_height + 2.0 * self.base_radius
        return "guide", -1j * self.outward * self.offset + self.outward * height, None

    def far_side(
        self, lifts: FloatArray, _: tuple[float, float], breadth: float
    ) -> MechanismSketch[Places]:
        """See `Follower.far_side`."""
        there, joined = self.across(lifts, breadth)
        return joined + MechanismSketch(rollers=((there, self.roller_radius),))

    def return_sketch(
        self, first: ComplexArray, lifts: FloatArray, reach: float
    ) -> MechanismSketch[Places]:
        """See `Follower.return_sketch`: both rollers are joined by a bracket."""
        here = self.traced(lifts)
        along = self.outward * ((here - first) * self.outward.conjugate()).real
        sizes = [Dimension("spacing", first, first + along)]
        return MechanismSketch(
            links=(self.bracket(first, here, reach),),
            rollers=((here, self.roller_radius),),
            dimensions=(*sizes, *self.roller_size(here, -1j * self.outward)),
        )


# -- oscillating roller ----------------------------------------------------------------------------
# Oscillating roller follower: a roller on a rocker with a fixed pivot.


@dataclass(frozen=True)
class OscillatingRoller(Rocking, WithRoller):
    """Oscillating roller follower (Wirsig eqs. 2.43 to 2.52).

    The rocker's angle chi is measured counter-clockwise from the line pivot -> cam axis:
    chi = h psi_G + (its swing), h = `arm_side`, with psi_G in (0, pi) from the triangle of l_1
    (pivot to cam axis), l_3 (`arm`) and r_G; W = exp(i alpha) (l_3 exp(i chi) - l_1), alpha the
    direction of that line. To lose no digits with a distant pivot, all is computed from
    l_3 - l_1 and l (1 - cos chi) = 2 l sin^2(chi/2).

    Attributes
    ----------
    pivot : B_0 seen from the cam axis, complex [mm].
    arm : l_3, pivot to roller centre [mm].
    base_radius : r_G, cam axis to roller centre at cam angle 0 [mm].
    roller_radius : r_R [mm].
    arm_side : h, +1 if the arm lies counter-clockwise of the line pivot -> cam axis, -1 clockwise.
    direction : +1 if a positive lift [rad] moves the roller outward (F-cam), -1 inward (P-cam);
        None if the lift is the rocker's own angle, counter-clockwise positive, as behind a linkage.

    Raises
    ------
    GeometryError
        With the key of an invalid value; with "follower.base_radius" also if the
        triangle cannot close, or closes only stretched out.
    """

    kind: ClassVar = "oscillating-roller"

    pivot: Place
    arm: Length
    base_radius: Length
    roller_radius: Radius
    arm_side: Sense = 1
    direction: Sense | None = 1

    def __post_init__(self) -> None:
        check_fields(self, "follower.")
        low, high = abs(self.excess), self.centre_distance + self.arm
        if not low < self.base_radius < high:
            raise GeometryError(
                f"pivot, cam axis and roller form no triangle: with the pivot"
                f" {self.centre_distance:.6g} mm from the cam axis and an arm of {self.arm:.6g} mm"
                f" it must lie between {low:.6g} and {high:.6g} mm",
                key="follower.base_radius",
                value=f"{self.base_radius:g}",
            )

    @cached_property
    def excess(self) -> float:
        """l_3 - l_1 [mm], arm minus distance of the pivot from the cam axis."""
        return arm_excess(self.pivot, self.arm)

    @cached_property
    def start_angle(self) -> float:
        """psi_G, angle between arm and the line pivot -> cam axis at cam angle 0 [rad], (0, pi)."""
        excess, total, base = self.excess, self.centre_distance + self.arm, self.base_radius
        return 2.0 * math.atan2(
            math.sqrt((base - excess) * (base + excess)),
            math.sqrt((total - base) * (total + base)),
        )

    @property
    def farthest(self) -> float:
        """See `Follower`."""
        return self.centre_distance + self.arm

    @property
    def start_arm(self) -> complex:
        """See `Follower`."""
        return cmath.rect(self.arm, self.line_angle + self.arm_side * self.start_angle)

    @property
    def reach(self) -> float:
        """See `Follower`: l_3, negative if a positive lift turns the rocker clockwise."""
        return self.swing_sense * self.arm

    def rocker_angle(self, lift: FloatArray) -> FloatArray:
        """psi_t (n,), angle from the line pivot -> cam axis to the arm, on the arm's own side."""
        return self.start_angle + self.arm_side * self.swing_sense * lift

    def relative_jet(self, jet: Jet, rotation: int, order: int = FULL_ORDER) -> RelativeJet:
        """See `Follower.relative_jet`.

        Axes along the line pivot -> cam axis and across it. Seen from the cam the rocker turns at
        omega = chi' - sigma: R_k = l_3 (e^{i gamma})^(k) e^{-i gamma} e^{i chi}
        plus the part that turns with the cam alone, gamma = chi - sigma phi.
        """
        l1, l3, sense = self.centre_distance, self.arm, float(self.swing_sense)
        excess = self.excess
        chi = sense * jet[0]
        chi += self.arm_side * self.start_angle
        tip_across, tip_along, bow = np.sin(chi), np.cos(chi), np.sin(0.5 * chi)
        bow *= 2.0 * bow  # 1 - cos chi
        u, v = l1 * tip_across, l1 * bow
        tip_along *= l3
        tip_across *= l3
        turning = sense * jet[1]
        # Angular velocity of the rocker as seen from the turning cam.
        omega = turning - rotation
        v += excess
        v -= (rotation * l3) * turning
        along, across = np.empty((2, order + 1, jet.shape[1]))
        bow *= l3
        np.subtract(excess, bow, out=along[0])
        across[0] = tip_across
        np.multiply(tip_across, omega, out=along[1])
        np.negative(along[1], out=along[1])
        np.multiply(tip_along, turning, out=across[1])
        across[1] -= rotation * along[0]
        if order > 1:
            chi2 = sense * jet[2]
            square = omega * omega
            along[2] = tip_along * (turning * (2.0 * rotation - turning)) - along[0]
            along[2] -= tip_across * chi2
            across[2] = tip_along * chi2 - tip_across * square
        if order > 2:
            # the third derivative of e^{i gamma} is (real + i imaginary) e^{i gamma}
            real = -3.0 * omega * chi2
            chi3 = sense * jet[3]
            along[3] = tip_along * real - tip_across * (chi3 - square * omega)
            # imaginary - sigma
            rest = chi3 - turning * (turning * (turning - 3.0 * rotation) + 3.0)
            across[3] = tip_across * real + tip_along * rest
            across[3] += rotation * along[0]
        return RelativeJet(along, across, self.line_angle, u, v, turning, self.reach)

    def tangent_jet(self, jet: Jet, rotation: int) -> TangentJet:
        """See `Follower.tangent_jet`."""
        l1, l3 = self.centre_distance, self.arm
        chi, chi1, chi2, chi3 = self.swing_sense * jet[:4]
        chi = chi + self.arm_side * self.start_angle
        along, across = l1 * np.cos(chi), l1 * np.sin(chi)
        relative = 1.0 - rotation * chi1
        # l_1 cos chi - l_3 (1 - sigma chi'), with cos chi as 1 - 2 sin^2(chi/2) so that l_1 and l_3
        # do not cancel.
        behind = rotation * l3 * chi1 - self.excess - 2.0 * l1 * np.sin(0.5 * chi) ** 2
        u = np.stack((across, along * chi1))
        w = np.stack((behind, rotation * l3 * chi2 - across * chi1))
        swerve = l3 * (w[0] * chi1 * chi2 + across * (chi3 + chi1 * relative * relative))
        return TangentJet(u, w, chi1, swerve)

    def speed_bounds(self, jet: Jet, bounds: Jet, half: FloatArray, rotation: int) -> FloatArray:
        """See `Follower.speed_bounds`: R_k as of `camgeo.kinematics.mechanism.follower`, W' = i
        chi' tip.
        """
        l1, l3 = self.centre_distance, self.arm
        middle = np.hypot(
            self.excess, 2.0 * np.sqrt(l1 * l3) * np.sin(0.5 * self.rocker_angle(jet[0]))
        )
        reach = np.minimum(middle + l3 * bounds[0], l1 + l3)  # |W|
        chi1, chi2, chi3 = bounds[1:]
        way1 = l3 * chi1
        way2 = l3 * (chi2 + chi1**2)
        way3 = l3 * (chi3 + 3.0 * chi1 * chi2 + chi1**3)
        return np.stack(
            (
                way1 + reach,
                way2 + 2.0 * way1 + reach,
                way3 + 3.0 * (way2 + way1) + reach,
            )
        )

    def on_one_side(self, lifts: FloatArray) -> bool:
        """See `Follower.on_one_side`."""
        rocker = self.rocker_angle(lifts)
        return bool(np.all((rocker > 0.0) & (rocker < np.pi)))

    def sketch(
        self, lifts: FloatArray, _: float, __: tuple[float, float]
    ) -> MechanismSketch[Places]:
        """See `Follower.sketch`."""
        sizes = (
            Dimension("pivot", 0j, self.pivot, vector=True),
            Dimension("base_radius", 0j, self.traced_point(0.0)),
        )
        held = MechanismSketch(shafts=(self.pivot,), dimensions=sizes)
        here = self.traced(lifts)
        return held + self.return_sketch(here, lifts, 0.0)

    def held(self, _: tuple[float, float]) -> tuple[Literal["pivot"], complex, None]:
        """See `Follower.held`."""
        return "pivot", self.pivot, None

    def return_sketch(
        self, _: ComplexArray, lifts: FloatArray, __: float
    ) -> MechanismSketch[Places]:
        """See `Follower.return_sketch`: both arms are on the pivot."""
        here = self.traced(lifts)
        arm = here - self.pivot
        return MechanismSketch(
            links=((self.pivot, here),),
            rollers=((here, self.roller_radius),),
            dimensions=(
                Dimension("arm", self.pivot, here),
                *self.roller_size(here, arm / np.abs(arm)),
            ),
        )


def arm_excess(pivot: complex, arm: float) -> float:
    """`arm` - |pivot| [mm], without the rounding error of |pivot|."""
    distance = abs(pivot)
    return (arm - distance) - hypot_rest(pivot, distance)


# -- doubled --------------------------------------------------------------------------------------
# The rounding error of an absolute value, computed with pairs of doubles.


SPLITTER: Final = 2.0**27 + 1.0


def hypot_rest(vector: complex, size: float) -> float:
    """|vector| - `size` to about twenty more digits, for a `size` that is |vector| up to rounding.

    From |vector|^2 - size^2 with the squares as exact sums of two doubles (Veltkamp, Dekker 1971).
    """
    squares = [_square(component) for component in (vector.real, vector.imag, size)]
    (x, x_low), (y, y_low), (h, h_low) = squares
    larger, smaller = max(x, y), min(x, y)
    # total + lost is x + y exactly (Dekker); total equals h up to rounding, so their difference is
    # exact, and |v| - s = (|v|^2 - s^2) / (2 s) but for a relative error of the rounding.
    total = larger + smaller
    lost = smaller - (total - larger)
    if not size:
        return 0.0
    return ((total - h) + (lost + (x_low + y_low - h_low))) / (2.0 * size)


def _square(number: float) -> tuple[float, float]:
    """number^2 as the exact sum of two doubles."""
    spread = SPLITTER * number
    high = spread - (spread - number)
    low = number - high
    product = number * number
    return product, ((high * high - product) + 2.0 * high * low) + low * low


# -- conjugate -------------------------------------------------------------------------------------
# Conjugate cams: a second roller on the follower, driven by a second disc on the same shaft.
#
# The main disc pushes the follower one way and the return disc pushes it back, so no spring is
# needed. Both rollers are fixed to one carriage or one lever and share its motion; the return
# roller is therefore a follower in its own right, with its own geometry and the same lift:
#
# - on a carriage its centre is B_2 = B_1 - spacing g, g the direction of the guide, possibly on a
#   parallel line: its guide points along -g, and what moves the main roller outward moves it
#   inward;
# - on a lever its arm is at a fixed angle to the main arm: same pivot, another triangle, same sense
#   of swing.


FLAT: Final = 1e-6
"""Angle [rad], and fraction of the spacing, by which the return roller must stay clear of positions
in which its disc cannot drive it; closer to them, the geometry has lost six of its sixteen
digits."""


@dataclass(frozen=True, slots=True)
class Mount:
    """How the return roller is fixed to the main one; dimensions that are not stated are those of
    the main roller.

    Attributes
    ----------
    make : `return_on_carriage` or `return_on_lever`.
    arguments : its arguments after the main roller, by their names.
    """

    make: Callable[..., Follower]
    arguments: tuple[tuple[str, float], ...]

    def roller(self, main: Follower) -> Follower:
        """The return roller; GeometryError as for `make`."""
        return self.make(main, **dict(self.arguments))

    def sized(self, **sizes: float) -> Mount:
        """The same mount with other values of some arguments."""
        return Mount(self.make, tuple({**dict(self.arguments), **sizes}.items()))


def return_on_carriage(
    main: TranslatingRoller,
    spacing: Length,
    offset: Coordinate | None = None,
    roller_radius: Radius | None = None,
) -> TranslatingRoller:
    """The return roller on the carriage of `main`.

    Parameters
    ----------
    spacing : distance of the roller centres along the guide [mm], positive; the return roller lies
        behind the main one, on the other side of the cam axis.
    offset : e of the return roller [mm], positive on the same side of the cam axis as that of
        `main`; None for the same offset.
    roller_radius : [mm]; None for that of `main`.

    Raises
    ------
    GeometryError
        With the key of an invalid value; with "follower.return.spacing" also if
        the return roller does not lie on the other side of the cam axis at cam angle 0.
    """
    instance("follower.kind", main, TranslatingRoller, "a roller on a carriage")
    spacing = length("follower.return.spacing", spacing)
    across = main.offset
    if offset is not None:
        across = coordinate("follower.return.offset", offset)
    size = _size(main, roller_radius)
    height = spacing - main.start_height
    if not height > FLAT * spacing:
        raise GeometryError(
            "the return roller must lie on the other side of the cam axis: the spacing must exceed"
            f" the height of the main roller over the cam axis at cam angle 0,"
            f" {main.start_height:.6g} mm",
            key="follower.return.spacing",
            value=f"{spacing:g}",
        )
    return TranslatingRoller(
        base_radius=math.hypot(across, height),
        roller_radius=size,
        offset=-across,  # the guide points the other way, which exchanges left and right
        guide_angle=main.guide_angle + (math.pi if main.guide_angle <= math.pi else -math.pi),
        direction=-main.direction,
    )


def return_on_lever(
    main: OscillatingRoller,
    arm_angle: Angle,
    arm: Length | None = None,
    roller_radius: Radius | None = None,
) -> OscillatingRoller:
    """The return roller on the lever of `main`.

    Parameters
    ----------
    arm_angle : from the main arm to the return arm [rad], counter-clockwise positive.
    arm : pivot to return roller [mm]; None for the arm of `main`.
    roller_radius : [mm]; None for that of `main`.

    Raises
    ------
    GeometryError
        With the key of an invalid value; with "follower.return.arm_angle" also if
        the return arm lies on the line from the pivot to the cam axis at cam angle 0: without a
        triangle its disc could not move it.
    """
    instance("follower.kind", main, OscillatingRoller, "a roller on a lever")
    arm_angle = angle("follower.return.arm_angle", arm_angle)
    return_arm = main.arm if arm is None else length("follower.return.arm", arm)
    size = _size(main, roller_radius)
    chi = math.remainder(main.arm_side * main.start_angle + arm_angle, TURN)
    side = 1 if chi > 0.0 else -1
    # |A_0 B_2| by the law of cosines, in the form that stays accurate for small angles.
    chord_square = 4.0 * main.centre_distance * return_arm * math.sin(0.5 * chi) ** 2
    base_radius = math.sqrt(arm_excess(main.pivot, return_arm) ** 2 + chord_square)
    # At 0 and pi the arm lies on the line of centres and has no lever.
    flat = not FLAT < abs(chi) < math.pi - FLAT
    try:
        if not flat:
            return OscillatingRoller(
                pivot=main.pivot,
                arm=return_arm,
                base_radius=base_radius,
                roller_radius=size,
                arm_side=side,
                direction=None if main.direction is None else main.swing_sense * side,
            )
    except GeometryError:
        pass  # the triangle is flat up to rounding: the same error as below
    raise GeometryError(
        "the return arm lies on the line from the pivot to the cam axis at cam angle 0, where its"
        f" disc cannot move it: the main arm is at {math.degrees(main.start_angle):.6g} degrees"
        f" {'counter-clockwise' if main.arm_side > 0 else 'clockwise'} of that line",
        key="follower.return.arm_angle",
        value=f"{math.degrees(arm_angle):g}",
    )


def _size(main: TranslatingRoller | OscillatingRoller, roller_radius: float | None) -> float:
    if roller_radius is None:
        return main.roller_radius
    return radius("follower.return.roller_radius", roller_radius)
