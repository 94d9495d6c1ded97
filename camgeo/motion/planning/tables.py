"""Lift tables in a plan: the spline of each, and the values it gives to its joints."""

from __future__ import annotations

import numpy as np

from camgeo.errors import GeometryError
from camgeo.motion.boundary import over_span
from camgeo.motion.plan import SplineMove
from camgeo.motion.planning.chain import Chain
from camgeo.motion.planning.request import TableRequest
from camgeo.motion.points import (
    FitReport,
    clamped_spline,
    periodic_spline,
    report,
    smooth_clamped_spline,
    smooth_periodic_spline,
)
from camgeo.motion.spline import Spline
from camgeo.numeric.arrays import FloatArray

CLOSED = 1e-9
"""Fraction of the largest lift by which the last row of a turn may miss the first one."""


def settle_tables(chain: Chain) -> None:
    """Give the joints of every table its own velocity and acceleration where none is stated."""
    for number, link in enumerate(chain.links):
        if not isinstance(link.request, TableRequest) or len(chain.links) == 1:
            continue
        spline, _ = _fitted(chain, number, link.request)
        ends = np.array([0.0, 1.0])
        values = spline.values(ends, 2, "left")
        for joint, column in ((chain.before(number), 0), (chain.after(number), 1)):
            if joint.velocity is None:
                joint.velocity = float(values[1, column]) / link.length
            if joint.acceleration is None:
                joint.acceleration = float(values[2, column]) / link.length**2


def fit(chain: Chain, number: int) -> SplineMove:
    """The segment of a table, once its joints are settled."""
    link = chain.links[number]
    assert isinstance(link.request, TableRequest)
    spline, found = _fitted(chain, number, link.request)
    start = chain.before(number).position
    shift = start - float(link.request.lifts[0])
    return SplineMove(link.request.span, start + link.stroke, spline, found, shift)


def _fitted(chain: Chain, number: int, request: TableRequest) -> tuple[Spline, FitReport]:
    """The spline over the normalised span, and its deviation from the rows."""
    link = chain.links[number]
    shares, lifts = request.shares, request.lifts - request.lifts[0]
    try:
        if len(chain.links) == 1 and not chain.joints[0].rests:
            if request.smoothing is None:
                gap = CLOSED * float(np.max(np.abs(lifts)))
                spline = periodic_spline(shares, lifts, 1.0, gap=gap)
                return spline, report(spline, shares, lifts)
            return smooth_periodic_spline(
                shares, lifts, 1.0, largest_deviation=request.smoothing, gap=request.smoothing
            )
        if len(chain.links) == 1:
            shares, lifts = _closed(shares, lifts)
        start, end = (
            over_span(joint.values, link.length)
            for joint in (chain.before(number), chain.after(number))
        )
        if request.smoothing is None:
            spline = clamped_spline(shares, lifts, start, end)
            return spline, report(spline, shares, lifts)
        return smooth_clamped_spline(shares, lifts, start, end, largest_deviation=request.smoothing)
    except GeometryError as error:
        raise GeometryError(error.message, key=f"{link.key}.file", value=error.value) from error


def _closed(shares: FloatArray, lifts: FloatArray) -> tuple[FloatArray, FloatArray]:
    """The rows of a turn, with the closing one added if missing."""
    if shares[-1] < 1.0:
        return np.append(shares, 1.0), np.append(lifts, 0.0)
    gap = CLOSED * float(np.max(np.abs(lifts)))
    if abs(lifts[-1]) > gap:
        raise GeometryError(
            f"the last row lies {lifts[-1]:g} off the first one; allowed: up to {gap:g}",
            value=f"{lifts[-1]:g}",
        )
    return shares, np.append(lifts[:-1], 0.0)
