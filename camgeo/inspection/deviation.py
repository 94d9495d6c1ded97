"""Deviations of measured points from the exact flank, over the cam angle.

Their scatter is that of single readings: the part of each deviation that a straight line between
its neighbours along the flank does not explain. Form errors that extend over many points hardly
count in it, whatever their size.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from statistics import NormalDist
from typing import Final

import numpy as np

from camgeo.errors import GeometryError
from camgeo.inspection.alignment import CONFIDENCE
from camgeo.inspection.exact_flank import ExactFlank, Feet, Places
from camgeo.numeric.arrays import FloatArray
from camgeo.numeric.extremes import Extremes, extremes_of

FEWEST: Final = 12
"""Points of which deviations have a scatter."""

TOLD: Final = 1.2
"""Where the root mean square exceeds the scatter by this factor, there are errors of form."""

ONE: Final = 1e-6
"""Points whose feet are closer than this [rad] are one, with the mean of their deviations."""


@dataclass(frozen=True, slots=True)
class Gap:
    """A range of the path without a point.

    Attributes
    ----------
    width : [rad].
    place : cam angle [rad] at which it begins.
    """

    width: float
    place: float


@dataclass(frozen=True, slots=True, eq=False)
class Deviations:
    """Deviations in the order of the path, in which no place occurs twice.

    Attributes
    ----------
    places : (n,) feet.
    values : (n,) [mm], positive where there is more material than there should be.
    widest : gap between neighbours.
    """

    places: Places
    values: FloatArray
    widest: Gap

    @property
    def extremes(self) -> Extremes:
        """Smallest and largest [mm], each with its cam angle [rad]."""
        return extremes_of(self.places.phi, self.values)

    @property
    def profile(self) -> float:
        """Width [mm] of the zone about the flank, half of it on each side, that holds all points:
        what a profile tolerance of ISO 1101 limits.
        """
        return 2.0 * self.extremes.magnitude

    @property
    def root_mean_square(self) -> float:
        """[mm]."""
        return float(np.sqrt(np.mean(self.values**2)))

    @property
    def scatter(self) -> float:
        """Standard deviation [mm] of a single reading, from each deviation and its neighbours."""
        values, course = self.values, self.places.course
        before, after = course[1:-1] - course[:-2], course[2:] - course[1:-1]
        share = after / (before + after)
        rest = values[1:-1] - share * values[:-2] - (1.0 - share) * values[2:]
        variances = rest * rest / (1.0 + share * share + (1.0 - share) ** 2)
        return float(np.sqrt(np.mean(variances)))

    @property
    def form(self) -> float:
        """Root mean square [mm] of what is not scatter; 0 where it is too small to be told from
        it, which is so up to a fifth more than the scatter in all.
        """
        total, scatter = self.root_mean_square, self.scatter
        return math.sqrt(total * total - scatter * scatter) if total > TOLD * scatter else 0.0

    @property
    def uncertainty(self) -> float:
        """[mm] within which all deviations at once are known, at `CONFIDENCE`, where readings
        scatter independently, normally, and no systematic error of the measurement is counted.
        """
        outside = (1.0 - CONFIDENCE) / (2.0 * len(self.values))
        return -NormalDist().inv_cdf(outside) * self.scatter


def deviations_of(flank: ExactFlank, feet: Feet, values: FloatArray) -> Deviations:
    """The deviations `values` (n,) [mm] at `feet` (n,), ordered.

    Raises GeometryError if fewer than `FEWEST` places have been measured.
    """
    order = np.argsort(feet.places.course, kind="stable")
    course, values = feet.places.course[order], values[order]
    first = np.concatenate(([True], np.diff(course) > ONE))
    starts = np.flatnonzero(first)
    if len(starts) < FEWEST:
        raise GeometryError(
            f"points at {FEWEST} places of the flank or more are needed, and there are"
            f" {len(starts)}"
        )
    counts = np.diff(np.append(starts, len(course)))
    means = np.add.reduceat(values, starts) / counts
    course = course[starts]
    places = flank.at(course)
    widths = np.diff(np.append(course, course[0] + flank.total))
    widest = int(np.argmax(widths))
    gap = Gap(float(widths[widest]), float(places.phi[widest]))
    return Deviations(places, means, gap)
