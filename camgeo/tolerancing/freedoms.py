"""The ways in which an assembled machine can deviate from the one that its cam was made for.

Angles count counter-clockwise, and places are complex, in mm. A freedom takes a number: real, or
complex where it says so.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from enum import Enum, StrEnum

import numpy as np

from camgeo.numeric.arrays import ComplexArray, FloatArray


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
