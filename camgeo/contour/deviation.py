"""Proof of a contour: an upper bound of its distance from the exact curve, for every point.

Each leg of the path is held against its own run of pieces. Over cells of its parameter
`camgeo.contour.enclosure` encloses the distance and the angle alpha between leg and piece; cells
that decide the largest distance are halved until the bound is sharp.

Contour to curve: as long as alpha stays far from a right angle, each normal of a piece meets the
curve once between the feet of the piece's ends; the tangential gaps at the feet are added. A leg's
own ends stand for the feet of a run's first and last vertex, so that no corner goes unseen.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from camgeo.contour.chain import Run
from camgeo.contour.contour import Contour
from camgeo.contour.enclosure import Taylor, arc_cells, line_cells
from camgeo.contour.legs import TurnLeg
from camgeo.contour.locate import locate
from camgeo.errors import GeometryError
from camgeo.motion.motion import Side
from camgeo.numeric.arrays import BoolArray, ComplexArray, FloatArray, IntArray, ascending
from camgeo.outline.path import Path

SHARPNESS = 0.01
"""The bound exceeds the largest distance found by at most this share, and rounding."""

STEEPEST = 0.5
"""Largest sin(alpha) for which a piece counts as following the curve: 30 degrees."""

CELLS = 4
"""Cells a piece to begin with."""

HALVINGS = 40
"""Rounds of halving at most."""

MAX_CELLS = 4_000_000
"""Cells at most; a contour within its tolerance needs a few for each piece."""

ROUNDING = 2.0**-52 * 32.0
"""Rounding of a distance, as a share of the largest length that enters it."""


@dataclass(frozen=True, slots=True, eq=False)
class _Cells:
    """Cells of cam angle [low, high], each inside one piece of the contour and one formula."""

    low: FloatArray
    high: FloatArray
    piece: IntArray

    def halved(self, which: BoolArray) -> _Cells:
        low, high, piece = self.low[which], self.high[which], self.piece[which]
        middle = 0.5 * (low + high)
        return _Cells(
            np.concatenate((low, middle)),
            np.concatenate((middle, high)),
            np.concatenate((piece, piece)),
        )


def deviation(path: Path, contour: Contour) -> float:
    """Upper bound [mm] of the distance between `contour` and `path`, in both directions.

    Parameters
    ----------
    path : the exact path; regular, 1 + d kappa > 0 but for single points.
    contour : closed, once round the path, in either direction.

    Raises
    ------
    GeometryError
        If the contour does not follow the path once round, so that no bound can be given.
    """
    return proved_bound(locate(path, contour))


def proved_bound(runs: tuple[Run, ...]) -> float:
    """Upper bound [mm] of the distance between the contour of `runs` and their legs.

    Each run is held against its own leg; its ends against those of the leg, so that a corner of
    the path is one of the contour.

    Raises
    ------
    GeometryError
        If a run does not follow its leg.
    """
    found, largest = 0.0, 0.0
    for run in runs:
        if not len(run.sweeps):
            largest = max(largest, _reach_from(run))
            continue
        found, bound = _run_bound(run, found)
        largest = max(largest, bound)
    return largest


def _reach_from(run: Run) -> float:
    """Bound of the distance of a leg without pieces from the one vertex it has."""
    if not isinstance(run.leg, TurnLeg):
        raise GeometryError("the contour leaves out a stretch of the exact outline")
    return float(abs(run.vertices[0] - run.leg.last)) + run.leg.length


def _run_bound(run: Run, found: float) -> tuple[float, float]:
    """Largest distance found by now, `found` of other runs included, and bound for this run."""
    cells = _first_cells(run)
    _check_sweeps(run, cells)
    sizes = np.abs(run.centres) + run.radii
    reach = float(np.max(np.abs(run.vertices)) + np.max(sizes) + abs(run.leg.distance))
    rounding = ROUNDING * reach
    for _ in range(HALVINGS):
        lower, bound, steepness, steep = _distances(run, cells)
        if np.max(steep) > STEEPEST:  # no halving would mend that
            break
        found = max(found, float(np.max(lower)))
        target = (1.0 + SHARPNESS) * found + rounding
        loose = (bound > target) | (steepness > STEEPEST)
        if not np.any(loose):
            return found, target + _gaps(run)
        if np.count_nonzero(loose) > MAX_CELLS // 2:
            break
        cells = cells.halved(loose)
    raise GeometryError("the contour cannot be compared with the exact curve")


def _first_cells(run: Run) -> _Cells:
    """Each piece's range in equal parts, cut at the borders of the leg's formulas."""
    angles, ends = run.angles[:-1], run.angles[1:]
    parts = np.arange(CELLS) / CELLS
    cuts = (angles[:, None] + (ends - angles)[:, None] * parts).ravel()
    borders = run.leg.borders
    borders = borders[(borders > angles[0]) & (borders < ends[-1])]
    cuts = ascending(np.concatenate((cuts, borders, ends[-1:])))
    low, high = cuts[:-1], cuts[1:]
    piece = np.searchsorted(angles, 0.5 * (low + high), side="right") - 1
    return _Cells(low, high, piece)


def _distances(run: Run, cells: _Cells) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """For each cell: distance found in its middle and bound of it, bound of sin alpha and sin alpha
    found in its middle; 1 where the piece runs backwards.
    """
    middle, half = 0.5 * (cells.low + cells.high), 0.5 * (cells.high - cells.low)
    leg = run.leg
    jet = leg.jet(middle)
    v1, v2, v3 = leg.speed_bounds(cells.low, cells.high)
    is_arc = run.sweeps[cells.piece] != 0.0

    lower, bound, steepness, steep = (np.empty(len(middle)) for _ in range(4))
    for which, kind in ((is_arc, arc_cells), (~is_arc, line_cells)):
        if np.any(which):
            taylor = Taylor(jet[:, which], v1[which], v2[which], v3[which], half[which])
            lower[which], bound[which], steepness[which], steep[which] = kind(
                taylor, run, cells.piece[which]
            )
    return lower, bound, steepness, steep


def _gaps(run: Run) -> float:
    """Largest distance [mm] by which a vertex is off its place along its pieces.

    For both pieces of a vertex its tangential distance from its foot, and how far an arc's end is
    from the circle about its centre.
    """
    is_arc = run.sweeps != 0.0
    chord = run.ends - run.starts
    largest = float(np.max(np.where(is_arc, np.abs(np.abs(run.ends - run.centres) - run.radii), 0)))
    sides: tuple[tuple[ComplexArray, FloatArray, Side], ...] = (
        (run.starts, run.angles[:-1], "right"),
        (run.ends, run.angles[1:], "left"),
    )
    for vertices, angles, side in sides:
        along = np.where(is_arc, 1j * (vertices - run.centres), chord)
        along = along / np.abs(along)
        ahead = run.leg.point(angles, side) - vertices
        gap = np.abs(ahead.real * along.real + ahead.imag * along.imag)
        largest = max(largest, float(np.max(gap)))
    return largest


def _check_sweeps(run: Run, cells: _Cells) -> None:
    """Each arc turns about its centre as far as the curve beside it, not the long way round."""
    first, last = run.leg.point(cells.low), run.leg.point(cells.high, "left")
    centre = run.centres[cells.piece]
    turned = np.angle((last - centre) * np.conj(first - centre))
    total = np.bincount(cells.piece, weights=turned, minlength=len(run.sweeps))
    arcs = run.sweeps != 0.0
    if np.any(np.abs(total[arcs] - run.sweeps[arcs]) > STEEPEST):
        raise GeometryError("an arc of the contour does not run beside the exact curve")
