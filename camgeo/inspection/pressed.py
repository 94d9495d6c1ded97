"""The follower pressed against a disc as it was measured.

Between neighbouring points the deviation is linear along the path, and the disc is bent as the
exact flank is: it is joined from arcs that turn as the exact normal does, over cells of at most a
quarter of a degree. On deviations of zero the follower makes the motion of the exact disc to
0.00002 mm at the corners of a trimmed flank, and ten times better on a whole one, so that what
remains is the effect of the deviations.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

import numpy as np

from camgeo.contour.contour import Contour
from camgeo.inspection.deviation import Deviations
from camgeo.inspection.exact_flank import ExactFlank, Places
from camgeo.numeric.arrays import FloatArray, Side, joined, taken
from camgeo.numeric.extremes import Extremes, piecewise_extremes
from camgeo.outline.replay import replay_contour, replay_outline
from camgeo.outline.replay_result import edges_between
from camgeo.units import TURN

STEP: Final = math.radians(1.0)
"""Of the samples [rad] of the replays themselves, which are not used."""

SAMPLES: Final = 3600
"""Cam angles at which lifts are compared for a picture, besides those of the points."""

SAME: Final = 1e-12
"""Nodes closer than this [rad] on a stretch are one."""


@dataclass(frozen=True, slots=True, eq=False)
class LiftErrors:
    """What deviations do to the follower.

    Attributes
    ----------
    phi : (n,) cam angles [rad] in [0, 2 pi), ascending, for a picture.
    errors : (n,) lift on the measured disc less that on the exact one [mm or rad].
    extremes : smallest and largest error of the turn with their cam angles [rad].
    """

    phi: FloatArray
    errors: FloatArray
    extremes: Extremes


def measured_contour(flank: ExactFlank, deviations: Deviations) -> Contour:
    """The disc, or the hole, as measured: closed, counter-clockwise."""
    nodes = flank.nodes
    if flank.path.is_whole:
        nodes = taken(nodes, slice(None, -1))  # the last is the first
    measured = deviations.places
    near = np.searchsorted(nodes.course, measured.course)
    apart = np.minimum(
        np.abs(measured.course - nodes.course[np.maximum(near - 1, 0)]),
        np.abs(measured.course - nodes.course[np.minimum(near, len(nodes) - 1)]),
    )
    every: Places = joined([nodes, taken(measured, apart > SAME)])
    # Stable, so that of the two nodes at a corner the first one stays the first.
    every = taken(every, np.argsort(every.course, kind="stable"))
    amounts = np.interp(every.course, measured.course, deviations.values, period=flank.total)
    vertices = every.points + amounts * every.normals
    turns = np.angle(np.roll(every.normals, -1) * every.normals.conj())
    corner = every.course == np.roll(every.course, -1)
    if not flank.path.is_whole:
        corner[-1] = True
    return Contour.through(vertices, np.where(corner, 0.0, turns)).counter_clockwise()


def lift_errors(flank: ExactFlank, deviations: Deviations, *, clearance: float = 0.0) -> LiftErrors:
    """Press the follower against the measured disc and against the exact one.

    `clearance` [mm] is the groove's, see `replay_outline`.

    Raises
    ------
    GeometryError
        If the follower does not find its way round the measured disc.
    """
    pitch = flank.curve.pitch
    exact = replay_outline(pitch, flank.path, step=STEP, clearance=clearance).lift
    contour = measured_contour(flank, deviations)
    actual = replay_contour(pitch, contour, flank.side, step=STEP).lift
    grid = np.arange(SAMPLES) * (TURN / SAMPLES)
    phi = np.unique(np.concatenate((grid, deviations.places.phi)))

    def error(phi: FloatArray, side: Side = "right") -> FloatArray:
        return actual.at(phi, side) - exact.at(phi, side)

    found = piecewise_extremes(error, edges_between(actual, exact))
    return LiftErrors(phi, error(phi), found)
