"""Four-bar linkage between a lever, whose angle is demanded, and the rocker that follows the cam.

Frame of the formulas: the rocker shaft B_0 at the origin, axes as in the drawing of the cam. The
pin on the lever is P = D_0 + l_c exp(i chi), chi = chi_0 + h x with the demanded angle x; the
crank's tip is T = l_a exp(i theta), |P - T| = l_b.
"""

from __future__ import annotations

import cmath
import math
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar, Literal

import numpy as np

from camgeo.errors import GeometryError
from camgeo.kinematics.mechanism.sketch import Dimension, MechanismSketch, Places
from camgeo.kinematics.mechanism.triangle import (
    ROUNDING,
    SLACK,
    RockerCrank,
    Size,
    drawn,
    in_line,
    passed_at_rest,
    turning,
    within,
)
from camgeo.kinematics.mechanism.values import Angle, Branch, Length, Place, Sense
from camgeo.kinematics.motion import FULL_ORDER, Jet
from camgeo.numeric.arrays import ComplexArray, FloatArray, dot, phase
from camgeo.numeric.checked import check_fields
from camgeo.numeric.interval import Angles, about


@dataclass(frozen=True)
class FourBar(RockerCrank):
    """Crank on the rocker shaft, coupler, and output lever on a second fixed shaft.

    Attributes
    ----------
    crank : l_a, crank on the rocker shaft [mm].
    coupler : l_b, from the crank's tip to the lever's pin [mm].
    lever : l_c, from the second shaft to the pin [mm].
    shaft : D_0, the second shaft seen from the rocker shaft, complex [mm].
    lever_angle : chi_0, direction from the second shaft to the pin at motion 0, from the x axis
        [rad].
    lever_sense : h, +1 if a positive motion turns the lever counter-clockwise, -1 clockwise.
    branch : +1 if the crank tip lies clockwise of the pin seen from the rocker shaft, -1
        counter-clockwise; it does so throughout the motion.

    Raises
    ------
    GeometryError
        With the key of an invalid value; with "linkage", if the linkage does not
        close at motion 0.
    """

    member: ClassVar[Literal["lever"]] = "lever"
    unit: ClassVar[Literal["rad"]] = "rad"

    lever: Length
    shaft: Place
    lever_angle: Angle
    lever_sense: Sense
    branch: Branch

    def __post_init__(self) -> None:
        check_fields(self, "linkage.")
        gap = float(self.missing_length(np.zeros(1))[0])
        if gap > ROUNDING * (self.crank + self.coupler):
            distance = abs(self.shaft + cmath.rect(self.lever, self.lever_angle))
            least, most = abs(distance - self.crank), distance + self.crank
            raise GeometryError(
                f"the linkage does not close at motion 0: it misses by {gap:.6g} mm; the coupler"
                f" must be {least:.6g} to {most:.6g} mm long",
                key="linkage",
            )

    @cached_property
    def _start_bend(self) -> float:
        """beta at motion 0 [rad]: the lever's direction, measured from that of the second shaft."""
        return self.lever_angle - self._shaft_angle

    @cached_property
    def _shaft_angle(self) -> float:
        """arg D_0 [rad]."""
        return phase(self.shaft)

    @cached_property
    def _shaft_distance(self) -> float:
        """|D_0| [mm]."""
        return abs(self.shaft)

    @property
    def _far_shaft(self) -> bool:
        return self._shaft_distance > self.lever

    def _bend(self, motion: FloatArray) -> FloatArray:
        return self._start_bend + self.lever_sense * motion

    def _distance(self, motion: FloatArray) -> FloatArray:
        """d = |P| (n,) [mm] at `motion` (n,) [rad], without cancellation."""
        near = self._widest * np.cos(0.5 * self._bend(motion))
        return np.hypot(self.lever - self._shaft_distance, near)

    @cached_property
    def _widest(self) -> float:
        """2 sqrt(l_c |D_0|) [mm]."""
        return 2.0 * math.sqrt(self.lever * self._shaft_distance)

    @property
    def _least_square(self) -> float:
        """(l_c - |D_0|)^2 [mm^2]."""
        return (self.lever - self._shaft_distance) ** 2

    @property
    def _start_cosine(self) -> float:
        return math.cos(self._start_bend)

    @cached_property
    def _start_gaps(self) -> tuple[float, float]:
        """(l_a + l_b)^2 - d^2 and d^2 - (l_a - l_b)^2 [mm^2] at motion 0, without rounding.

        A gap that is only rounding is 0: a dead centre at the start remains one.
        """
        d = float(self._distance(np.zeros(1))[0])
        total, difference = self.crank + self.coupler, abs(self.crank - self.coupler)
        outer, inner = total - d, d - difference
        least = ROUNDING * total
        outer, inner = (gap if gap > least else 0.0 for gap in (outer, inner))
        return outer * (total + d), inner * (d + difference)

    def _growth(self, motion: FloatArray) -> FloatArray:
        """d^2 minus its value at motion 0 [mm^2], as a product."""
        half = 0.5 * self.lever_sense * motion
        growth = np.sin(self._start_bend + half) * np.sin(half)
        growth *= -4.0 * self.lever * self._shaft_distance
        return np.asarray(growth)

    def _farthest_and_nearest(
        self, motion: FloatArray, reach: FloatArray
    ) -> tuple[tuple[FloatArray, FloatArray], tuple[FloatArray, FloatArray]]:
        distance, lever = self._shaft_distance, self.lever
        found = about(self._bend(motion), reach).cosine
        least, start = self._least_square, self._start_cosine

        def at(level: FloatArray) -> tuple[FloatArray, FloatArray]:
            square = least + 2.0 * lever * distance * (1.0 + level)
            return 2.0 * lever * distance * (level - start), np.sqrt(square)

        return at(found.high), at(found.low)

    def _pin_heading(self, motion: FloatArray, reach: FloatArray) -> Angles:
        """The pin moves square to the lever."""
        return about(self.lever_angle + self.lever_sense * motion + 0.5 * math.pi, reach)

    @property
    def _pin_pace(self) -> tuple[float, float]:
        return self.lever_sense * self.lever, self.lever_sense

    def _pin_angle(self, motion: FloatArray) -> FloatArray:
        """arg P (n,) [rad], continuous over any motion: that of the longer of D_0 and l_c, with
        which P turns, plus less than a quarter turn.
        """
        bend, distance = self._bend(motion), self._shaft_distance
        if self._far_shaft:
            about = 1.0 + (self.lever / distance) * np.exp(1j * bend)
            return np.asarray(self._shaft_angle + np.angle(about))
        about = 1.0 + (distance / self.lever) * np.exp(-1j * bend)
        return np.asarray(self.lever_angle + self.lever_sense * motion + np.angle(about))

    def joints(self, motion: FloatArray) -> tuple[ComplexArray, ComplexArray]:
        """P and T (n,) [mm]: lever's pin and crank's tip at `motion` (n,) [rad]."""
        pin = self.shaft + self.lever * np.exp(1j * (self.lever_angle + self.lever_sense * motion))
        return pin, self.crank * np.exp(1j * self.crank_angle(motion))

    def sketch(self, place: complex, _: complex, position: FloatArray) -> MechanismSketch[Places]:
        """See `Linkage.sketch`."""
        joined, far = drawn(place, self.joints(position)), place + self.shaft
        pin = joined.joints[1]
        return joined + MechanismSketch(
            links=((far, pin),),
            shafts=(far,),
            dimensions=(Dimension("lever", far, pin), Dimension("shaft", place, far, vector=True)),
        )

    @property
    def coupler_tilt(self) -> float:
        """See `Linkage`: its dimensions say nothing of it."""
        return 0.0

    def joint_rates(
        self, motion: FloatArray, demanded: FloatArray, own: FloatArray
    ) -> tuple[ComplexArray, ComplexArray]:
        """See `Linkage.joint_rates`: P turns with the lever, T with the crank."""
        pin, tip = self.joints(motion)
        return turning(pin - self.shaft, self.lever_sense * demanded), turning(tip, own)

    def per_follower(self, motion: FloatArray) -> FloatArray:
        """(n,) dx/dpsi at `motion` (n,) [rad], see `Linkage.per_follower`.

        From Re(conj(D) (P' - T')) = 0 with P' = i h x' (P - D_0), T' = i psi' T: l_a over h l_c
        times the quotient of the sines.

        Raises
        ------
        GeometryError
            With key "linkage", where coupler and lever are in line, up to rounding.
        """
        far, own = self.transmission_sines(motion)
        if np.any(np.abs(far) <= ROUNDING * (1.0 + self.lever / self.coupler)):
            message = "coupler and lever are in line: the rocker cannot move the lever"
            raise GeometryError(message, key="linkage")
        return np.asarray(self.lever_sense * (self.crank / self.lever) * own / far)

    def _far_sine(self, motion: FloatArray) -> FloatArray:
        """Re(conj(D) i (P - D_0)) / (l_b l_c)."""
        pin, tip = self.joints(motion)
        return dot(pin - tip, 1j * (pin - self.shaft)) / (self.lever * self.coupler)

    def locked_positions(self, low: float, high: float) -> tuple[float, ...]:
        """See `Linkage.locked_positions`: coupler and lever are in line.

        The crank's tip is then l_c + l_b or |l_c - l_b| from the second shaft.
        """
        bends: list[float] = []
        for signed in (self.lever + self.coupler, self.lever - self.coupler):
            # In line with the tip as seen from D_0, or opposite to it.
            ahead = 0.0 if signed > 0.0 else math.pi
            bends += [bend + ahead for bend in _bends(abs(self.shaft), abs(signed), self.crank)]
        found = self._motions(bends, low - SLACK, high + SLACK)
        return in_line(found, self._far_sine(np.array(found)))

    def far_turning_positions(self, low: float, high: float) -> tuple[float, ...]:
        """See `Linkage.far_turning_positions`: the crank lies on the line of the shafts, its tip
        nearest to the second shaft or farthest from it.
        """
        bends: list[float] = []
        for tip in (self.crank, -self.crank):  # along the line, from the rocker shaft
            beyond = tip - abs(self.shaft)
            for bend in _bends(abs(beyond), self.lever, self.coupler):
                bend += math.pi if beyond > 0.0 else 0.0
                if self.branch * tip * math.sin(bend) >= 0.0:
                    bends.append(bend)
        return self._motions(bends, low, high)

    def transform(self, jet: Jet, order: int = FULL_ORDER) -> Jet:
        """(order + 1, n) rocker angle psi and derivatives [rad/rad^k] for lever angles `jet`.

        `jet` (4, n) is the demanded angle and its derivatives [rad/rad^k]; order is at least 1.
        psi is counted from motion 0, counter-clockwise positive, continuous over the motion.

        With the coupler D = P - T, N = Re(conj(D) i T) = l_a l_b sin(v - theta), and the
        derivatives of |D|^2 = l_b^2:

            theta'   = Re(conj(D) P') / N
            theta''  = (Re(conj(D) (P'' + theta'^2 T)) + |D'|^2) / N
            theta''' = (Re(conj(D) (P''' + (3 theta' theta'' + i theta'^3) T)) + 3 Re(conj(D') D''))
                       / N

        Raises
        ------
        GeometryError
            With key "linkage", at a dead centre that is not passed at rest: psi'' is infinite.
        """
        motion = jet[0]
        sine, cosine = self.half_angle_at(motion)
        theta = self._pin_angle(motion) - self.branch * 2.0 * np.arctan2(sine, cosine)
        leverage = passed_at_rest(
            0.5 * self.branch * (sine * cosine),
            jet,
            "crank and coupler are in line while the lever starts to move, the rocker's"
            " acceleration is",
        )
        arm = self.lever * np.exp(1j * (self.lever_angle + self.lever_sense * motion))
        tip = self.crank * np.exp(1j * theta)
        rod = self.shaft + arm - tip
        turn1 = self.lever_sense * jet[1]
        pin1 = 1j * turn1 * arm
        out = np.empty((order + 1, jet.shape[1]))
        np.subtract(theta, self.start_angle, out=out[0])
        theta1 = np.divide(dot(rod, pin1), leverage, out=out[1])
        if order > 1:
            turn2 = self.lever_sense * jet[2]
            pin2 = (1j * turn2 - turn1 * turn1) * arm
            rod1 = pin1 - 1j * theta1 * tip
            swing_in = theta1 * theta1 * tip
            theta2 = dot(rod, pin2 + swing_in) + dot(rod1, rod1)
            theta2 = np.divide(theta2, leverage, out=out[2])
        if order > 2:
            turn3 = self.lever_sense * jet[3]
            pin3 = (1j * (turn3 - turn1**3) - 3.0 * turn1 * turn2) * arm
            rod2 = pin2 + swing_in - 1j * theta2 * tip
            mixed = (3.0 * theta1 * theta2 + 1j * theta1**3) * tip
            theta3 = dot(rod, pin3 + mixed) + 3.0 * dot(rod1, rod2)
            np.divide(theta3, leverage, out=out[3])
        return out

    def turning_positions(self, low: float, high: float) -> tuple[float, ...]:
        """See `Linkage.turning_positions`: where the lever lies on the line of the shafts."""
        return self._motions((0.0, math.pi), low, high)

    def dead_positions(self, low: float, high: float) -> tuple[float, ...]:
        """See `Linkage.dead_positions`."""
        bends: list[float] = []
        for reach in (self.crank + self.coupler, abs(self.crank - self.coupler)):
            bends += _bends(abs(self.shaft), self.lever, reach)
        return self._motions(bends, low, high)

    def _motions(
        self, bends: tuple[float, ...] | list[float], low: float, high: float
    ) -> tuple[float, ...]:
        """The motions in [low, high] [rad] at which beta is one of `bends`, up to whole turns."""
        angles = [self.lever_sense * (bend - self._start_bend) for bend in bends]
        return within(angles, low, high)

    def size_limits(self, size: Size, low: float, high: float) -> tuple[float, ...]:
        """See `Linkage.size_limits`: |l_a - l_b| <= d <= l_a + l_b, d from least to most."""
        positions = np.array([low, high, *self.turning_positions(low, high)])
        d = self._distance(positions)
        least, most = float(np.min(d)), float(np.max(d))
        other = self.crank if size == "coupler" else self.coupler
        return most - other, other - least, other + least


def _bends(distance: float, arm: float, reach: float) -> tuple[float, ...]:
    """Angles [rad] of an `arm` [mm] whose end is `reach` [mm] from a point: from the direction that
    leads away from the point, which is `distance` [mm] off; none if that is 0.
    """
    # distance, arm and reach make a triangle; half its outer angle, no cancellation
    near = (reach - (arm - distance)) * (reach + (arm - distance))
    far = (arm + distance - reach) * (arm + distance + reach)
    if not distance or near < 0.0 or far < 0.0:
        return ()
    bend = 2.0 * math.atan2(math.sqrt(far), math.sqrt(near))
    return bend, -bend
