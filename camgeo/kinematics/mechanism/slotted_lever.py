"""Crank and slotted lever: the crank's pin runs in the slot of a lever with an axis of its own.

The inversion of the slider-crank in which the guide turns: it swings in a shaper, and turns round
in a Whitworth quick return. The crank of radius R turns about A_0, the lever about C at a distance
a, beta = a/R. theta is the angle of the crank from the direction A_0 -> C; phi is the angle of the
lever, that of the line C -> pin from the direction C -> A_0, measured in the opposite sense:
clockwise where theta is counter-clockwise.
With s = sin(theta/2), shares p = R/(a + R), q = a/(a + R) and d = (a - R)/(a + R) = q - p

    phi   = atan2(p sin theta, q - p cos theta)
    phi'  = p (q cos theta - p)/N,    N = d^2 + 4 p q s^2
    phi'' = -p q d sin theta/N^2,

which are equations (1) to (3) of the SAM exercise divided by the crank's speed. For nearly equal
lengths a - R is exact, and near theta = 0 so are the differences q cos theta - p = d - 2 q s^2 and
q - p cos theta = d + 2 p s^2: nothing else loses digits there.

a > R: the lever swings. a < R: it turns round with the crank. a = R: phi = pi/2 - theta/2, and at
theta = 0 the pin is on the lever's axis, where phi is undefined.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from numbers import Real
from typing import Annotated, Any, Final, Literal

import numpy as np

from camgeo.errors import GeometryError
from camgeo.numeric.arrays import FloatArray
from camgeo.numeric.checked import CheckedFields, check_fields, value_text
from camgeo.numeric.extremes import Extreme, Extremes
from camgeo.units import TURN

NEAR = 0.5
"""Above this cosine the differences are taken by the half angle, below it directly: either way no
term exceeds twice the result, whether a and R are nearly equal or far apart."""


def any_size(key: str, value: Any) -> float:
    """A number above 0 of any size, for formulas that use ratios only."""
    real = isinstance(value, Real) and not isinstance(value, bool)
    if not (real and 0.0 < value <= sys.float_info.max):
        raise GeometryError("must be a positive number", key, value_text(value))
    return float(value)


AnySize = Annotated[float, any_size]


@dataclass(frozen=True, slots=True)
class SlottedLever(CheckedFields):
    """A crank with a slotted lever, seen from the crank at any number of turns.

    Attributes
    ----------
    crank : R, radius of the crank [mm].
    distance : a, from the crank's axis A_0 to the lever's axis C [mm].

    Raises
    ------
    GeometryError
        With key "crank" or "distance", if a length is not a positive number.
    """

    crank: AnySize
    distance: AnySize

    @property
    def ratio(self) -> float:
        """beta = a/R."""
        return self.distance / self.crank

    @property
    def swings(self) -> bool:
        """True if the lever swings to and fro, a > R; False if it turns round, a <= R."""
        return self.distance > self.crank

    def angle(self, theta: FloatArray) -> FloatArray:
        """phi (n,) [rad] at the crank angles `theta` (n,) [rad], continuous over all turns.

        In (-pi/2, pi/2) for a lever that swings. A lever that turns round loses a turn with each of
        the crank, and half a turn if a = R; over the first it runs from pi (pi/2) to -pi (-pi/2).

        Raises
        ------
        GeometryError
            Where the pin is on the lever's axis (a = R, theta a multiple of 2 pi), or a crank angle
            is not a finite number.
        """
        theta, half = self._angles(theta)
        p, q, d = self._shares()
        # The sum turns -0 into 0: arctan2 would take the other side for it.
        sine, cosine = np.sin(theta) + 0.0, np.cos(theta)
        if d == 0.0:
            # Between 0 and 2 pi the arc cotangent is the angle; beyond, it is the angle of the same
            # line up to half turns, of which the nearest is added.
            line = np.arctan(np.cos(0.5 * theta) / half)
            line += math.pi * np.rint((0.5 * (math.pi - theta) - line) / math.pi)
            return np.asarray(line)
        along = np.where(cosine > NEAR, d + 2.0 * p * half * half, q - p * cosine)
        phi = np.arctan2(p * sine, along)
        if d < 0.0:
            # pi - theta - phi is the angle of the lever with a and R exchanged, within +-pi/2.
            phi += 2.0 * math.pi * np.rint((math.pi - theta - phi) / (2.0 * math.pi))
        return np.asarray(phi)

    def velocity(self, theta: FloatArray) -> FloatArray:
        """phi' = omega_2/omega_0 (n,) [rad/rad] at `theta` (n,) [rad]; raises as `angle` does."""
        theta, half = self._angles(theta)
        p, q, d = self._shares()
        if d == 0.0:
            return np.full_like(theta, -0.5)
        cosine = np.cos(theta)
        lead = np.where(cosine > NEAR, d - 2.0 * q * half * half, q * cosine - p)
        return np.asarray(p * lead / self._square(half))

    def acceleration(self, theta: FloatArray) -> FloatArray:
        """phi'' = eps_2/omega_0^2 (n,) [rad/rad^2] at a constant crank speed.

        `theta` (n,) [rad]; raises as `angle` does.
        """
        theta, half = self._angles(theta)
        p, q, d = self._shares()
        if d == 0.0:
            return np.zeros_like(theta)
        square = self._square(half)
        return np.asarray(-p * q * d * np.sin(theta) / (square * square))

    def in_time(self, theta: FloatArray, speed: float) -> FloatArray:
        """(3, n): phi [rad], omega_2 [rad/s], eps_2 [rad/s^2] at a constant crank `speed` [rad/s].

        `theta` (n,) [rad]; raises as `angle` does.
        """
        velocity, acceleration = self.velocity(theta), self.acceleration(theta)
        return np.stack((self.angle(theta), speed * velocity, speed * speed * acceleration))

    @property
    def largest_angle(self) -> Extreme:
        """phi_max = arcsin(R/a) [rad] at theta = arccos(R/a) [rad]; -phi_max lies at -theta.

        Raises
        ------
        GeometryError
            If the lever turns round, a <= R.
        """
        self._must_swing("no largest angle")
        root = math.sqrt(self.distance - self.crank) * math.sqrt(self.distance + self.crank)
        return Extreme(math.atan2(self.crank, root), math.atan2(root, self.crank))

    @property
    def velocity_extremes(self) -> Extremes:
        """Smallest and largest phi' [rad/rad]: -1/(beta + 1) at theta = pi, 1/(beta - 1) at 0.

        For a lever that turns round the one at 0 is the smallest. Both are the same for a = R.
        """
        difference = self.distance - self.crank
        far = Extreme(-self.crank / (self.distance + self.crank), math.pi)
        if difference == 0.0:
            return Extremes(far, far)
        near = Extreme(self.crank / difference, 0.0)
        return Extremes(far, near) if self.swings else Extremes(near, far)

    @property
    def largest_acceleration(self) -> Extreme:
        """phi'' [rad/rad^2] of the largest magnitude, with theta in (0, pi] [rad].

        Negative for a lever that swings, positive for one that turns round; at -theta the sign is
        opposite. 0 for a = R.

        cos theta is the root of 2 beta c^2 + (beta^2 + 1) c - 4 beta; written for s^2, the same
        root is d^2/(B + 4 p q + sqrt(B^2 + 32 p^2 q^2)), B = p^2 + q^2, in which nothing cancels.
        """
        p, q, d = self._shares()
        if d == 0.0:
            return Extreme(0.0, math.pi)
        squares, product = p * p + q * q, p * q
        half = abs(d) / math.sqrt(
            squares + 4.0 * product + math.hypot(squares, math.sqrt(32.0) * product)
        )
        theta = 2.0 * math.asin(half)
        square = d * d + 4.0 * product * half * half
        # From the sine of the half angle itself, so that a tiny theta keeps all its digits.
        sine = 2.0 * half * math.sqrt((1.0 - half) * (1.0 + half))
        return Extreme(-product * d * sine / (square * square), theta)

    @property
    def time_ratio(self) -> float:
        """Duration of the slow stroke over that of the quick one, arccos(-1/beta)/arccos(1/beta).

        Raises
        ------
        GeometryError
            If the lever turns round, a <= R: there are no strokes.
        """
        self._must_swing("no strokes")
        quick = self.largest_angle.place
        return (math.pi - quick) / quick

    def _shares(self) -> tuple[float, float, float]:
        """p, q, d, see the module."""
        total = 0.5 * self.distance + 0.5 * self.crank  # halved against overflow
        return (
            0.5 * self.crank / total,
            0.5 * self.distance / total,
            0.5 * (self.distance - self.crank) / total,
        )

    def _square(self, half: FloatArray) -> FloatArray:
        """N (n,): square of the distance from C to the pin over (a + R)^2."""
        p, q, d = self._shares()
        return np.asarray(d * d + 4.0 * p * q * half * half)

    def _angles(self, theta: FloatArray) -> tuple[FloatArray, FloatArray]:
        """`theta` as an array, and sin(theta/2); raises where phi is undefined."""
        theta = np.atleast_1d(np.asarray(theta, dtype=np.float64))
        if not np.all(np.isfinite(theta)):
            raise GeometryError("crank angles must be finite numbers")
        half = np.sin(0.5 * theta)
        # A multiple of 2 pi, converted from degrees, is rounded twice: by two spacings at most.
        if self.distance == self.crank and np.any(np.abs(half) <= np.spacing(np.abs(theta))):
            raise GeometryError(
                "the crank is as long as the distance between the axes: at a crank angle of 0 its"
                " pin is on the axis of the lever, whose angle is undefined there",
                key="distance",
                value=f"{self.distance:g}",
            )
        return theta, half

    def _must_swing(self, what: str) -> None:
        if not self.swings:
            raise GeometryError(
                f"there is {what}: the lever turns round, because the distance between the axes,"
                f" {self.distance:g} mm, does not exceed the crank, {self.crank:g} mm",
                key="distance",
                value=f"{self.distance:g}",
            )

    @staticmethod
    def crank_for_swing(distance: float, swing: float) -> float:
        """R = a sin(swing/2) [mm]: equation (4) of the SAM exercise, for the whole swing 2 phi_max.

        R is rounded, and with it the swing: near 180 degrees by about an ulp over the cosine of
        half the swing.

        Parameters
        ----------
        distance : a, between the axes [mm], positive.
        swing : from one end to the other [deg], above 0, at most 180.

        Raises
        ------
        GeometryError
            With key "swing", outside this range, or so close to 180 that R rounds to a.
        """
        if not 0.0 < swing <= 180.0:
            raise GeometryError(
                "the swing of a slotted lever must be above 0 and at most 180 degrees; a lever that"
                " turns round has none: its crank is longer than the distance between the axes",
                key="swing",
                value=f"{swing:.17g}",
            )
        # Of all rational angles between 0 and 90 degrees only 30 has a rational sine, and sin(pi/6)
        # misses it by one spacing.
        share = 0.5 if swing == 60.0 else math.sin(math.radians(0.5 * swing))
        crank = distance * share
        if crank >= distance and swing < 180.0:
            raise GeometryError(
                "so close to 180 degrees the crank is not distinguishable from the distance between"
                " the axes; give the crank instead",
                key="swing",
                value=f"{swing:.17g}",
            )
        return crank


# -- slotted lever drive --------------------------------------------------------------------------
# A slotted lever whose crank turns at constant speed: motion in time, extremes, strokes, table.
#
# All angles are positive in the sense in which the crank turns, as in the table and the text of the
# SAM exercise. `camgeo.kinematics.mechanism.slotted_lever` takes the lever's angle in the opposite
# sense, as equation (1) of the exercise does: here phi, omega_2 and eps_2 are the negatives of its
# values.


Quantity = Literal["phi", "omega2", "eps2"]
"""Angle, velocity, acceleration of the lever: the rows of `DrivenLever.output`, in this order."""

UNITS: Final[Mapping[Quantity, str]] = {"phi": "rad", "omega2": "rad/s", "eps2": "rad/s^2"}


@dataclass(frozen=True, slots=True)
class LeverExtreme:
    """A largest or smallest value over one turn of the crank.

    Attributes
    ----------
    quantity : the quantity that is extreme.
    largest : True for the largest value with its sign, False for the smallest.
    value : of the quantity, by its closed form.
    crank : crank angle theta in [0, 2 pi) [rad].
    angle : phi at theta [rad]; -pi where a lever that turns round is at theta = 0.
    time : from theta = 0 to theta [s].
    """

    quantity: Quantity
    largest: bool
    value: float
    crank: float
    angle: float
    time: float

    @property
    def unit(self) -> str:
        """Unit of the value."""
        return UNITS[self.quantity]


@dataclass(frozen=True, slots=True)
class Stroke:
    """The swing of the lever from one of its ends to the other.

    Attributes
    ----------
    start, end : crank angles [rad], ascending; `end` may exceed a turn.
    duration : [s].
    """

    start: float
    end: float
    duration: float


@dataclass(frozen=True, slots=True)
class DrivenLever:
    """A slotted lever and the constant speed of its crank.

    Attributes
    ----------
    lever : the mechanism.
    speed : omega_0 [rad/s], positive.

    Raises
    ------
    GeometryError
        With key "speed", if that is not a positive number, or is so large that a velocity or an
        acceleration overflows.
    """

    lever: SlottedLever
    speed: AnySize

    def __post_init__(self) -> None:
        check_fields(self)
        largest = (
            self.turn_time,
            self.speed * self.lever.velocity_extremes.magnitude,
            self.speed * self.speed * self.lever.largest_acceleration.value,
        )
        if not all(math.isfinite(value) for value in largest):
            raise GeometryError(
                "at this speed a time, a velocity or an acceleration of the lever is too large for"
                " a floating-point number",
                key="speed",
                value=f"{self.speed:g}",
            )

    @property
    def turn_time(self) -> float:
        """Duration of one turn of the crank [s]."""
        return TURN / self.speed

    def output(self, theta: FloatArray) -> FloatArray:
        """(3, n): phi [rad], omega_2 [rad/s], eps_2 [rad/s^2] at crank angles `theta` (n,) [rad].

        Raises
        ------
        GeometryError
            Where phi is undefined, or a crank angle is not finite: see `SlottedLever.angle`.
        """
        return np.asarray(0.0 - self.lever.in_time(theta, self.speed))

    @property
    def extremes(self) -> tuple[LeverExtreme, ...]:
        """All extremes of one turn: angle, velocity, acceleration, each by ascending crank angle.

        No angle for a lever that turns round. None at all for a = R, where the velocity is half the
        crank's throughout, and the acceleration 0.
        """
        lever, speed = self.lever, self.speed
        if lever.crank == lever.distance:
            return ()
        collected = []
        if lever.swings:
            angle = lever.largest_angle
            collected += self._pair("phi", -angle.value, angle.place)
        velocities = lever.velocity_extremes
        # The smallest phi' is the largest omega_2, because phi and omega_2 have opposite senses.
        at_ends = [
            self._extreme("omega2", largest, -speed * end.value, end.place)
            for largest, end in ((True, velocities.lowest), (False, velocities.highest))
        ]
        collected += sorted(at_ends, key=lambda extreme: extreme.crank)
        acceleration = lever.largest_acceleration
        collected += self._pair("eps2", -speed * speed * acceleration.value, acceleration.place)
        return tuple(collected)

    @property
    def strokes(self) -> tuple[Stroke, Stroke] | None:
        """The slow stroke, with the crank, and the quick one, against it; None if a <= R."""
        if not self.lever.swings:
            return None
        first = self.lever.largest_angle.place
        slow = Stroke(first, TURN - first, 2.0 * (math.pi - first) / self.speed)
        return slow, Stroke(TURN - first, TURN + first, 2.0 * first / self.speed)

    def _pair(self, quantity: Quantity, value: float, theta: float) -> list[LeverExtreme]:
        """The extreme at `theta` in (0, pi), and its counterpart at 2 pi - theta."""
        one = self._extreme(quantity, value > 0.0, value, theta)
        mirrored = TURN - theta
        time = mirrored / self.speed
        return [one, LeverExtreme(quantity, value < 0.0, -value, mirrored, -one.angle, time)]

    def _extreme(
        self, quantity: Quantity, largest: bool, value: float, theta: float
    ) -> LeverExtreme:
        # The lever's angle at pi is exactly 0, but sin(pi) is not in floating point.
        angle = 0.0 if theta == math.pi else float(self.output(np.array([theta]))[0, 0])
        if quantity == "phi":
            angle = value
        return LeverExtreme(quantity, largest, value, theta, angle, theta / self.speed)
