"""A linkage in front of the follower: a motion made from another motion, by the chain rule."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import partial

import numpy as np

from camgeo.errors import GeometryError
from camgeo.mechanism.slider_crank import SliderCrank
from camgeo.motion.extremes import SAMPLES, lift_range, pieces
from camgeo.motion.motion import FULL_ORDER, Dwell, Jet, Motion, Side
from camgeo.numeric.arrays import FloatArray
from camgeo.numeric.roots import roots_on_grid

ROUNDING = 8.0 * 2.0**-52
"""A missing length of this share of crank and coupler is a dead centre, rounded."""


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
        linkage = self.linkage
        _, gap = self.tightest()
        if gap <= ROUNDING * (linkage.crank + linkage.coupler):
            return
        first, last = self._open_range()
        raise GeometryError(
            f"the linkage does not close between cam angles {math.degrees(first):.10g} and"
            f" {math.degrees(last):.10g} degrees: up to {gap:.6g} mm are missing; shorten the"
            " stroke or lengthen crank or coupler",
            key="linkage",
        )

    def tightest(self) -> tuple[float, float]:
        """The stroke [mm] nearest to a dead centre, or beyond it, with the missing length [mm].

        The length is negative where there is some to spare.

        The pin's distance from the shaft is extreme at an end of the stroke, or where it passes the
        shaft.
        """
        linkage = self.linkage
        ends = np.array(lift_range(self.slider))
        passing = np.clip(-linkage.stroke_direction * linkage.start_position, *ends)
        strokes = np.append(ends, passing)
        missing = linkage.missing_length(strokes)
        worst = int(np.argmax(missing))
        return float(strokes[worst]), float(missing[worst])

    def _open_range(self) -> tuple[float, float]:
        """First and last cam angle [rad] at which crank and coupler just reach the pin.

        Where the stroke passes one of those at which they do: however short the range in which they
        do not, the stroke itself runs steadily through it.
        """
        linkage = self.linkage
        found: list[FloatArray] = []
        for start, end in pieces(self.slider):
            grid = np.linspace(start, end, SAMPLES)
            for reach in linkage.dead_strokes:
                found.append(roots_on_grid(partial(self._beyond, reach), grid))
        angles = np.concatenate(found)
        return float(np.min(angles)), float(np.max(angles))

    def _beyond(self, stroke: float, phi: FloatArray) -> FloatArray:
        return np.asarray(self.slider.jet(phi)[0] - stroke)

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

    def jet(self, phi: FloatArray, side: Side = "right", order: int = FULL_ORDER) -> Jet:
        """(order + 1, n) rocker angle and derivatives, see `Motion.jet`."""
        return self.linkage.transform(self.slider.jet(phi, side, order), order)

    def jet_and_bounds(self, low: FloatArray, high: FloatArray) -> tuple[Jet, Jet]:
        """See `Motion.jet_and_bounds`."""
        middle, bounds = self.slider.jet_and_bounds(low, high)
        linkage = self.linkage
        return linkage.transform(middle, FULL_ORDER), linkage.transform_bounds(middle, bounds)
