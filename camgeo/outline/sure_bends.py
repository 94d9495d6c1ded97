"""No undercut missed: the known extremes of the curvature held against enclosures of the pace.

The extremes are found where the slope of the curvature changes its sign from one sample to the
next; two changes between neighbouring samples would escape. Over a cell whose pace surely keeps its
sign there is no cusp. What remains uncertain is halved, and where the pace is found to have another
sign than the known extremes tell, the extremes there are added.
"""

from __future__ import annotations

import numpy as np

from camgeo.curve.extremes import Extremes
from camgeo.curve.working_curve import WorkingCurve
from camgeo.numeric.arrays import BoolArray, FloatArray, frozen
from camgeo.numeric.roots import roots_on_grid
from camgeo.outline.cells import Cells, halved
from camgeo.outline.cusps import CUSP, backward_ranges
from camgeo.outline.division import first_cells
from camgeo.outline.envelope import Envelope
from camgeo.units import TURN

HALVINGS = 14
"""Rounds of halving: cells of less than 1e-5 rad, in which a motion does nothing of its own."""

SAMPLES = 65
"""Places in which an added extreme is looked for."""


def sure_bends(flank: WorkingCurve, bends: Extremes) -> Extremes:
    """`bends` with the extremes that undercut of `flank` shows to be missing; mostly none."""
    envelope = Envelope(flank)
    known = backward_ranges(envelope, bends)
    cells = first_cells(envelope, np.empty(0))
    missed: list[FloatArray] = []
    for _ in range(HALVINGS):
        cells = cells.some(cells.sign == 0.0)
        if not len(cells):
            break
        middle = 0.5 * (cells.low + cells.high)
        wrong = (cells.pace < 0.0) != _inside(middle, known, envelope.total)
        wrong &= np.abs(cells.pace) > CUSP * _speeds(envelope, middle)
        for k in np.flatnonzero(wrong):
            missed.append(_extremes_near(envelope, cells, int(k)))
        cells = halved(envelope, cells.some(~wrong))
    return _with(flank, bends, np.concatenate(missed)) if missed else bends


def _inside(places: FloatArray, ranges: list[tuple[float, float]], total: float) -> BoolArray:
    inside: BoolArray = np.zeros(len(places), dtype=np.bool_)
    for start, end in ranges:
        inside |= (places - start) % total < end - start
    return inside


def _speeds(envelope: Envelope, places: FloatArray) -> FloatArray:
    """|Z'| at path parameters; 1 on the turns about a corner, whose pace is no difference."""
    index = envelope.element_at(places)
    speeds: FloatArray = np.ones(len(places))
    along = ~envelope.is_pivot[index]
    angles = places[along] + envelope.angle_offsets[index[along]]
    speeds[along] = np.abs(envelope.curve.pitch.jet(angles)[1])
    return speeds


def _extremes_near(envelope: Envelope, cells: Cells, k: int) -> FloatArray:
    """Cam angles of the middle of a cell and of the extremes of the curvature in it."""
    shift = envelope.angle_offsets[envelope.element_at(cells.low[k : k + 1])][0]
    grid = np.linspace(cells.low[k], cells.high[k], SAMPLES + 2)[1:-1] + shift
    found = roots_on_grid(envelope.curve.pitch.curvature_slope, grid)
    middle = 0.5 * (cells.low[k : k + 1] + cells.high[k : k + 1]) + shift
    return np.concatenate((found, middle))


def _with(flank: WorkingCurve, bends: Extremes, angles: FloatArray) -> Extremes:
    """`bends` and the curvature at `angles`, in their order."""
    first = float(bends.phi[0])
    added = first + np.mod(angles - first, TURN)
    phi = np.concatenate((bends.phi, added))
    values = np.concatenate((bends.values, flank.pitch.curvature(added)))
    order = np.argsort(phi, kind="stable")
    return Extremes(frozen(phi[order], np.float64), frozen(values[order], np.float64))
