"""What makes machines deviate: dimensions, clearances and errors of form, each at random."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from enum import Enum, StrEnum
from typing import ClassVar, Final, Literal, Protocol, Self

import numpy as np

from camgeo.numeric.arrays import ComplexArray, FloatArray
from camgeo.units import TURN


@dataclass(frozen=True, slots=True)
class Moments:
    """Of a random number: its mean and its variance."""

    mean: float
    variance: float


class Source(Protocol):
    """Something random that machines deviate by.

    Attributes
    ----------
    name : its key.
    sense : what a positive deviation is, in words.
    units : of the numbers by which machines deviate.
    moments : of each of these numbers, which are uncorrelated; of two, in a random direction, the
        mean is 0.
    draws : uniformly distributed numbers that make one machine.
    limits : of what is stated [mm or rad].
    shape : of its distribution, in a word.
    is_angle : whether it is in rad.
    """

    @property
    def name(self) -> str: ...

    @property
    def sense(self) -> str: ...

    @property
    def units(self) -> tuple[Unit, ...]: ...

    @property
    def moments(self) -> Moments: ...

    @property
    def draws(self) -> int: ...

    @property
    def limits(self) -> tuple[float, float]: ...

    @property
    def shape(self) -> str: ...

    @property
    def is_angle(self) -> bool: ...

    def numbers(self, shares: FloatArray) -> FloatArray:
        """(units, m) numbers from shares (draws, m), within (0, 1)."""


@dataclass(frozen=True, slots=True)
class ToleratedDimension:
    """A dimension with its tolerance.

    Attributes
    ----------
    unit : how the machine deviates by 1 mm or rad of it.
    distribution : of its deviation.
    is_angle : whether that is in rad.
    """

    name: str
    sense: str
    unit: Unit
    distribution: Distribution
    is_angle: bool = False

    @property
    def units(self) -> tuple[Unit, ...]:
        """See `Source`."""
        return (self.unit,)

    @property
    def moments(self) -> Moments:
        """See `Source`."""
        return Moments(self.distribution.mean, self.distribution.variance)

    @property
    def draws(self) -> int:
        """See `Source`."""
        return 1

    @property
    def limits(self) -> tuple[float, float]:
        """See `Source`."""
        return self.distribution.low, self.distribution.high

    @property
    def shape(self) -> str:
        """See `Source`."""
        return self.distribution.shape

    def numbers(self, shares: FloatArray) -> FloatArray:
        """See `Source`."""
        return self.distribution.quantile(shares)


@dataclass(frozen=True, slots=True)
class Fit:
    """The clearance of a hole on a shaft, which leave one at all their limits."""

    hole: Distribution
    shaft: Distribution

    @property
    def half(self) -> Moments:
        """Of half the clearance [mm], by which one may lie off the other."""
        mean = 0.5 * (self.hole.mean - self.shaft.mean)
        return Moments(mean, 0.25 * (self.hole.variance + self.shaft.variance))

    @property
    def limits(self) -> tuple[float, float]:
        """Of the clearance [mm]."""
        return self.hole.low - self.shaft.high, self.hole.high - self.shaft.low

    def halves(self, shares: FloatArray) -> FloatArray:
        """(m,) [mm] from shares (2, m); a normal distribution may pass its limits, not 0."""
        clearance = self.hole.quantile(shares[0]) - self.shaft.quantile(shares[1])
        return 0.5 * np.maximum(clearance, 0.0)


@dataclass(frozen=True, slots=True)
class Clearance:
    """What clearances have in common.

    Attributes
    ----------
    fit : that leaves it.
    hold : the side that has it, of a follower that two sides hold.
    """

    is_angle: ClassVar = False

    name: str
    sense: str
    fit: Fit
    hold: Hold

    @property
    def limits(self) -> tuple[float, float]:
        """See `Source`."""
        return self.fit.limits

    @property
    def shape(self) -> str:
        """See `Source`: of both diameters."""
        return self.fit.hole.shape


@dataclass(frozen=True, slots=True)
class PressedClearance(Clearance):
    """A clearance in which the load of the contact pushes cam and follower apart.

    Attributes
    ----------
    flank_sign : of the flank that carries, +1 if the contact pushes the follower inward.
    """

    flank_sign: int

    @property
    def units(self) -> tuple[Unit, ...]:
        """See `Source`: the follower comes nearer to the material by half the clearance."""
        return (Unit(Freedom(Way.GROWTH, hold=self.hold), float(self.flank_sign)),)

    @property
    def moments(self) -> Moments:
        """See `Source`."""
        return self.fit.half

    @property
    def draws(self) -> int:
        """See `Source`."""
        return 2

    def numbers(self, shares: FloatArray) -> FloatArray:
        """See `Source`."""
        return self.fit.halves(shares)[np.newaxis]


@dataclass(frozen=True, slots=True)
class LooseClearance(Clearance):
    """A clearance in which the cam lies anywhere, in a direction that turns with it."""

    @property
    def units(self) -> tuple[Unit, ...]:
        """See `Source`: in x and y of the cam."""
        freedom = Freedom(Way.SEAT, hold=self.hold)
        return Unit(freedom), Unit(freedom, 1j)

    @property
    def moments(self) -> Moments:
        """See `Source`: half the mean square of the distance in each direction."""
        half = self.fit.half
        return Moments(0.0, 0.5 * (half.mean**2 + half.variance))

    @property
    def draws(self) -> int:
        """See `Source`."""
        return 3

    def numbers(self, shares: FloatArray) -> FloatArray:
        """See `Source`."""
        return _in_direction(self.fit.halves(shares[:2]), shares[2])


@dataclass(frozen=True, slots=True)
class FormError:
    """Waves of the flank.

    Attributes
    ----------
    height : above and below the exact flank [mm].
    waves : in a turn.
    hold : the side whose disc has them, of a conjugate pair.
    """

    is_angle: ClassVar = False
    shape: ClassVar = "random phase"

    name: str
    sense: str
    height: float
    waves: int
    hold: Hold

    @property
    def units(self) -> tuple[Unit, ...]:
        """See `Source`: in phase and a quarter of a wave later."""
        freedom = Freedom(Way.WAVE, self.waves, self.hold)
        return Unit(freedom), Unit(freedom, 1j)

    @property
    def moments(self) -> Moments:
        """See `Source`: at any place the phase is uniformly distributed."""
        return Moments(0.0, 0.5 * self.height**2)

    @property
    def draws(self) -> int:
        """See `Source`."""
        return 1

    @property
    def limits(self) -> tuple[float, float]:
        """See `Source`."""
        return -self.height, self.height

    def numbers(self, shares: FloatArray) -> FloatArray:
        """See `Source`."""
        return _in_direction(np.full(shares.shape[1], self.height), shares[0])


def _in_direction(sizes: FloatArray, shares: FloatArray) -> FloatArray:
    """(2, m) components of vectors of these sizes (m,), at shares (m,) of a turn."""
    angle = TURN * shares
    return np.stack((sizes * np.cos(angle), sizes * np.sin(angle)))


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


# -- distribution ---------------------------------------------------------------------------------
# How a deviation is distributed between its limits.


Shape = Literal["normal", "uniform", "triangular"]

SHAPES: Final[tuple[Shape, ...]] = ("normal", "uniform", "triangular")

SIGMAS: Final = 3.0
"""Standard deviations of a normal distribution from its mean to a limit, unless one is stated."""

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
    low, high : its limits; a normal distribution goes beyond them.
    shape : symmetric about the middle of the limits.
    stated : the standard deviation, if it is not what limits and shape say; else None.
    """

    low: float
    high: float
    shape: Shape = "normal"
    stated: float | None = None

    @property
    def mean(self) -> float:
        """Its expected value."""
        return 0.5 * (self.low + self.high)

    @property
    def sigma(self) -> float:
        """Its standard deviation."""
        if self.stated is not None:
            return self.stated
        return 0.5 * (self.high - self.low) / WIDTHS[self.shape]

    @property
    def variance(self) -> float:
        """Its variance."""
        return self.sigma**2

    def quantile(self, share: FloatArray) -> FloatArray:
        """(n,) values below which the shares (n,), within (0, 1), of all values lie."""
        unit = _NORMALISED[self.shape](share)
        return self.mean + self.sigma * unit


def _normal(share: FloatArray) -> FloatArray:
    from scipy.special import ndtri  # where nothing is drawn, nothing is loaded

    return np.asarray(ndtri(share))


def _uniform(share: FloatArray) -> FloatArray:
    return WIDTHS["uniform"] * (2.0 * share - 1.0)


def _triangular(share: FloatArray) -> FloatArray:
    low = share < 0.5
    tail = np.where(low, share, 1.0 - share)
    rest = WIDTHS["triangular"] * (1.0 - np.sqrt(2.0 * tail))
    return np.where(low, -rest, rest)


_NORMALISED: Final = {"normal": _normal, "uniform": _uniform, "triangular": _triangular}
"""Quantiles with the mean 0 and the standard deviation 1."""
