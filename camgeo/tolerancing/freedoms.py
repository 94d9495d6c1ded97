"""The ways in which an assembled machine can deviate from the one that its cam was made for.

Angles count counter-clockwise, and places are complex, in mm. A freedom takes a number: real, or
complex where it says so.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum

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


@dataclass(frozen=True, slots=True)
class Freedom:
    """One way to deviate.

    Attributes
    ----------
    way : what deviates.
    waves : k, of a `WAVE`; 0 for all others.
    """

    way: Way
    waves: int = 0


@dataclass(frozen=True, slots=True)
class Unit:
    """How a dimension deviates by one: in a freedom, by a factor."""

    freedom: Freedom
    factor: complex = 1.0


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
