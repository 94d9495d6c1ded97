"""What makes machines deviate: dimensions, clearances and errors of form, each at random."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Protocol

import numpy as np

from camgeo.numeric.arrays import FloatArray
from camgeo.tolerancing.distribution import Distribution
from camgeo.tolerancing.freedoms import Freedom, Hold, Unit, Way
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
