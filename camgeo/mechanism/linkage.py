"""A linkage in front of the follower: a motion made from another motion, by the chain rule."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from camgeo.errors import GeometryError
from camgeo.mechanism.slider_crank import SliderCrank
from camgeo.motion.extremes import SAMPLES, lift_range, pieces
from camgeo.motion.motion import Dwell, Jet, Motion, Side
from camgeo.numeric.arrays import FloatArray
from camgeo.numeric.roots import roots_on_grid


@dataclass(frozen=True, slots=True)
class LinkedMotion:
    """The rocker's motion behind a linkage whose slider makes the demanded motion.

    Attributes
    ----------
    slider : the demanded motion [mm].
    linkage : what turns it into the rocker's angle [rad], counter-clockwise positive.

    Raises
    ------
    GeometryError
        With key "linkage", if the linkage does not close somewhere in the turn; it names the first
        and last cam angle and the missing length.
    """

    slider: Motion
    linkage: SliderCrank

    def __post_init__(self) -> None:
        stroke = np.array(lift_range(self.slider))
        nearest = np.clip(-self.linkage.stroke_direction * self.linkage.start_position, *stroke)
        gap = float(np.max(self.linkage.missing_length(np.append(stroke, nearest))))
        if gap <= 0.0:
            return
        first, last = self._open_range()
        raise GeometryError(
            f"the linkage does not close between cam angles {math.degrees(first):.10g} and"
            f" {math.degrees(last):.10g} degrees: up to {gap:.6g} mm are missing; shorten the"
            " stroke or lengthen crank or coupler",
            key="linkage",
        )

    def _open_range(self) -> tuple[float, float]:
        """First and last cam angle [rad] at which crank and coupler just reach the pin."""
        found: list[FloatArray] = []
        for start, end in pieces(self.slider):
            grid = np.linspace(start, end, SAMPLES)
            found.append(roots_on_grid(self._missing, grid))
        angles = np.concatenate(found)
        return float(np.min(angles)), float(np.max(angles))

    def _missing(self, phi: FloatArray) -> FloatArray:
        return self.linkage.missing_length(self.slider.jet(phi)[0])

    @property
    def breaks(self) -> FloatArray:
        """See `Motion`."""
        return self.slider.breaks

    @property
    def borders(self) -> FloatArray:
        """See `Motion`."""
        return self.slider.borders

    @property
    def dwells(self) -> tuple[Dwell, ...]:
        """See `Motion`."""
        return self.slider.dwells

    def jet(self, phi: FloatArray, side: Side = "right") -> Jet:
        """(4, n) rocker angle and derivatives, see `Motion.jet`."""
        return self.linkage.transform(self.slider.jet(phi, side))

    def jet_bounds(self, low: FloatArray, high: FloatArray) -> Jet:
        """See `Motion.jet_bounds`."""
        middle = self.slider.jet(0.5 * (low + high))
        return self.linkage.transform_bounds(middle, self.slider.jet_bounds(low, high))
