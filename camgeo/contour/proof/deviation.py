"""Proof of a contour: an upper bound of its distance from the exact curve, for every point.

Each leg of the path is compared with its own run of pieces, and each piece with the part of the leg
between the two places given for its ends. Over cells of the leg's parameter
`camgeo.contour.proof.enclosure` encloses the distance of the leg from the line or circle of the
piece, and the angle alpha between both; cells that decide the largest distance b are halved until
the bound is sharp.

Why b and the distances of the ends bound the distance in both directions: as long as alpha stays
far from a right angle, the place square across on the line or circle moves steadily forward along
the part of the leg, and it turns about the centre by the sweep and not by a further turn.

- A point of the piece that some point of the part lies square across from is within b of it. What
  is left of the piece lies between one of its ends, A, and the place square across from the given
  place P of A, and is no farther from P than A itself.
- A point of the part that lies square across from a point of the piece is within b of it. What is
  left of the part lies between P and the place square across from A, beyond the end of the piece:
  it is within b across and, along, no farther from A than P is.

Either way the distance is at most sqrt(b^2 + c^2), c the chord of the circle of the piece between A
and the place square across from P, drawn at the distance b outside. It does not matter that
neighbours share A and P, as each piece and its part of the leg answer for themselves; nor how far A
lies off the leg across, as this is within b; and P may be any place, only c is small where it is
the foot of A. A leg's own ends are the places of a run's first and last vertex, so that no corner
goes unseen.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from camgeo.contour.chain import Run
from camgeo.contour.contour import Contour
from camgeo.contour.legs import SNAP, TurnLeg
from camgeo.contour.proof.enclosure import Enclosure, Taylor, enclose
from camgeo.contour.proof.locate import locate
from camgeo.errors import GeometryError
from camgeo.numeric.arrays import (
    BoolArray,
    ComplexArray,
    FloatArray,
    IntArray,
    grouped,
    joined,
    taken,
)
from camgeo.outline.path import Path
from camgeo.units import TURN

SHARPNESS = 0.01
"""The bound exceeds the largest distance found by at most this fraction, plus rounding; that of a
fit, or by this fraction of its tolerance."""

ENOUGH = 1e-9
"""A bound [mm] that is never made sharper: a hundredth of the finest tolerance of a file. What lies
on the curve, but for rounding, would take millions of cells."""

STEEPEST = 0.5
"""Largest sin(alpha) for which a piece counts as following the curve: 30 degrees."""

ARC_CELLS = 10
"""Initial cells per arc, on average over a run, all of one width: the uncertainty of the distance
is the cube of the width times the bound of its third derivative, the same fraction of the largest
distance whatever the tolerance."""

FEWEST, MOST = 4, 256
"""Fewest and most initial cells of one arc."""

HALVINGS = 40
"""Rounds of halving at most; then, or after `MAX_CELLS`, the bound is not sharp, but still one."""

MAX_CELLS = 400_000
"""Cells at most [some 80 MB], unless there are as many pieces; a contour within its tolerance needs
a few for each."""

BLOCK = 16_384
"""Cells enclosed at a time [some 15 MB]."""

ROUNDING = 2.0**-52 * 32.0
"""Rounding of a distance, as a fraction of the largest length that enters it."""

HUGE = 1e3
"""Radius of an arc that may count as a line, as a multiple of the contour's reach."""

SHORT = 1e-3
"""Range of a formula [rad] that a message suspects."""

BEFORE = 2.0 * SNAP
"""Distance before a border at which its left-hand value is taken [rad]: a few ulps, so that the
point there is within its rounding, and beyond the reach of the border."""


@dataclass(frozen=True, slots=True, eq=False)
class _Cells:
    """Cells of the parameter [low, high], each inside one piece of the contour and one formula."""

    low: FloatArray
    high: FloatArray
    piece: IntArray
    poles: ComplexArray

    @property
    def have_middles(self) -> BoolArray:
        """(n,) whether there is a number between the ends of each."""
        middle = 0.5 * (self.low + self.high)
        found: BoolArray = (self.low < middle) & (middle < self.high)
        return found

    def halved(self, which: BoolArray) -> _Cells:
        cells = taken(self, which)
        middle = 0.5 * (cells.low + cells.high)
        return joined([replace(cells, high=middle), replace(cells, low=middle)])


def deviation(path: Path, contour: Contour) -> float:
    """Upper bound [mm] of the distance between `contour` and `path`, in both directions.

    Parameters
    ----------
    path : the exact path; regular, 1 + d kappa > 0 except for single points.
    contour : closed, once round the path, in either direction.

    Raises
    ------
    GeometryError
        If the contour does not follow the path once round, so that no bound can be given.
    """
    return proved_bound(locate(path, contour))


def proved_bound(
    runs: tuple[Run, ...], arc_cells: int = ARC_CELLS, enough: float = ENOUGH
) -> float:
    """Upper bound [mm] of the distance between the contour of `runs` and their legs.

    Each run is compared with its own leg, and its ends with those of the leg, so that a corner of
    the path is one of the contour. `arc_cells` are the initial cells per arc: fewer suffice where
    the arcs are much finer than the distance requires; they only affect the time. A bound of up to
    `enough` [mm] is not made sharper.

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
        found, bound = _run_bound(run, found, arc_cells, enough)
        largest = max(largest, bound)
    return largest


def _reach_from(run: Run) -> float:
    """Bound of the distance of a leg without pieces from its only vertex."""
    if not isinstance(run.leg, TurnLeg):
        raise GeometryError("the contour leaves out a stretch of the exact outline")
    return float(abs(run.vertices[0] - run.leg.last)) + run.leg.length


def _run_bound(run: Run, found: float, arc_cells: int, enough: float) -> tuple[float, float]:
    """Largest distance found so far, including `found` of other runs, and bound for this run.

    Rounding is charged to each piece with the lengths that enter its own distances: the circle of a
    nearly straight arc is large, and no other piece is measured from it.
    """
    run, rounding = _without_flat_arcs(run)
    cells = _first_cells(run, arc_cells)
    most = max(MAX_CELLS, len(cells.low)) // 2
    enclosure, places = _first_enclosure(run, cells)
    largest = 0.0
    turned = np.zeros((2, len(run.sweeps)))
    for halving in range(HALVINGS):
        if np.max(enclosure.steep) > STEEPEST:  # halving would not help
            break
        found = max(found, float(np.max(enclosure.found)))
        own = rounding[cells.piece]
        bound = enclosure.bound + own
        steep = enclosure.steepness > STEEPEST
        loose = steep | (bound > np.maximum((1.0 + SHARPNESS) * found + 2.0 * own, enough))
        if np.count_nonzero(loose) > most or halving + 1 == HALVINGS:
            loose = steep
        settled = ~loose
        largest = max(largest, float(np.max(bound[settled], initial=0.0)))
        for total, part in zip(turned, (enclosure.least_turn, enclosure.most_turn), strict=True):
            total += np.bincount(cells.piece[settled], part[settled], len(total))
        if not np.any(loose):
            _check_turns(run, turned[0], turned[1])
            return found, _with_ends(run, places, largest)
        if np.count_nonzero(loose) > most or not np.any(loose & cells.have_middles):
            break
        cells = cells.halved(loose)
        blocks = range(0, len(cells.low), BLOCK)
        enclosure = joined([_enclosed(run, taken(cells, slice(k, k + BLOCK))) for k in blocks])
    raise _uncompared(run, float(cells.low[np.argmax(enclosure.steepness)]))


def _uncompared(run: Run, place: float) -> GeometryError:
    """The error for a contour that does not follow the leg at `place` [rad]; it is the motion's if
    a formula of it holds there for no longer than `SHORT`.
    """
    message = "the contour cannot be compared with the exact curve"
    if run.leg.closed:  # its pieces may begin anywhere, and end a turn later
        place %= TURN
    ends = np.concatenate(([run.leg.start], run.leg.borders, [run.leg.end]))
    start, end = np.max(ends[ends <= place]), np.min(ends[ends > place], initial=run.leg.end)
    if isinstance(run.leg, TurnLeg) or end - start > SHORT:
        here = complex(run.leg.point(np.array([place]))[0])
        return GeometryError(
            f"{message} near X {here.real:.6g}, Y {here.imag:.6g} mm, where it may run across it"
        )
    first, span = math.degrees(start % TURN), math.degrees(end - start)
    return GeometryError(
        f"{message} from {first:.12g} to {first + span:.12g} deg of the cam angle: what moves there"
        f" within {span:.3g} deg takes few of the cam angles that can be told apart, or turns too"
        " sharply; give it a longer span or a shorter way",
        "motion",
    )


def _without_flat_arcs(run: Run) -> tuple[Run, FloatArray]:
    """The run with lines in place of the arcs whose huge circles round by more than their sagittas,
    and (n,) [mm] what its distances then miss: rounding, and those sagittas.
    """
    reach = float(np.max(np.abs(run.vertices))) + abs(run.leg.distance)
    rounding = ROUNDING * (np.abs(run.centres) + run.radii + reach)
    sagittas = 0.5 * np.abs((run.ends - run.starts) * np.tan(0.25 * run.sweeps))
    flat = (run.radii > HUGE * reach) & (sagittas < rounding)
    if not np.any(flat):
        return run, rounding
    sweeps, centres = np.where(flat, 0.0, run.sweeps), np.where(flat, 0.0, run.centres)
    missed = np.where(flat, ROUNDING * reach + sagittas, rounding)
    return replace(run, sweeps=sweeps, centres=centres), missed


def _first_cells(run: Run, arc_cells: int) -> _Cells:
    """The range of each piece in equal parts, cut at the borders of the leg's formulas.

    One part for a line, from which the curve departs like a parabola, and for an arc.
    """
    angles, ends = run.angles[:-1], run.angles[1:]
    borders = run.leg.borders
    borders = borders[(borders > angles[0]) & (borders < ends[-1])]
    poles = run.leg.poles(0.5 * (angles + ends))
    spans = np.where((run.sweeps != 0.0) & np.isnan(poles), ends - angles, 0.0)
    width = float(np.sum(spans)) / max(1, arc_cells * int(np.count_nonzero(spans)))
    parts = np.where(
        spans > 0.0, np.clip(np.ceil(spans / (width or 1.0)), min(FEWEST, arc_cells), MOST), 1
    )
    parts = parts.astype(np.intp)
    piece, part = grouped(parts)
    low = angles[piece] + (ends - angles)[piece] * (part / parts[piece])
    if len(borders):
        place = np.searchsorted(low, borders)
        new = borders[low[np.minimum(place, len(low) - 1)] != borders]
        place = np.searchsorted(low, new)
        low = np.insert(low, place, new)
        piece = np.insert(piece, place, piece[place - 1])
        poles = run.leg.poles(0.5 * (low + np.append(low[1:], ends[-1])))
    else:
        poles = poles[piece]
    return _Cells(low, np.append(low[1:], ends[-1]), piece, poles)


def _first_enclosure(run: Run, cells: _Cells) -> tuple[Enclosure, ComplexArray]:
    """The first cells, and (2, n) [mm] the places of the pieces' starts and ends on the leg.

    All from one evaluation, because calls cost more than numbers: a place is a cell of zero width.
    """
    starts, ends = run.angles[:-1], run.angles[1:]
    at_border = _near(ends, run.leg.borders)
    at_border[-1] = True
    before = ends[at_border] - BEFORE
    low = np.concatenate((cells.low, starts, ends[-1:], before))
    high = np.concatenate((cells.high, starts, ends[-1:], before))
    jet, speeds = run.leg.jet_and_bounds(low, high)
    count, pieces = len(cells.low), len(starts)
    tangent = jet[1, count:] / np.abs(jet[1, count:])
    places = jet[0, count:] + (1j * run.leg.rotation * run.leg.distance) * tangent
    reached = places[1 : pieces + 1].copy()
    reached[at_border] = places[pieces + 1 :]
    both = np.stack((places[:pieces], reached))
    return _enclosed(run, cells, (jet[:, :count], speeds[:, :count])), both


def _near(angles: FloatArray, borders: FloatArray) -> BoolArray:
    """(n,) which of `angles` (n,) count as one of the ascending `borders`."""
    if not len(borders):
        return np.zeros(len(angles), dtype=np.bool_)
    place = np.searchsorted(borders, angles)
    after = np.abs(borders[np.minimum(place, len(borders) - 1)] - angles)
    return np.minimum(after, np.abs(borders[place - 1] - angles)) <= SNAP


def _enclosed(
    run: Run, cells: _Cells, known: tuple[ComplexArray, FloatArray] | None = None
) -> Enclosure:
    """The cells compared with their pieces; `known` are their jets and speeds, if there are any."""
    jet, (v1, v2, v3) = known or run.leg.jet_and_bounds(cells.low, cells.high)
    taylor = Taylor(jet, v1, v2, v3, 0.5 * (cells.high - cells.low), cells.poles)
    return enclose(taylor, run, cells.piece)


def _with_ends(run: Run, places: ComplexArray, bound: float) -> float:
    """The bound of the distance across [mm], including the contribution of the ends of the pieces.

    With g and n the distance of the place from the end along and across the piece, n outward, the
    chord c of the circle of radius rho + b is c^2 = 2 rho (rho + b) g^2 / (r (r + rho + n)), r the
    distance of the place from the centre: the law of cosines without its cancellation. The distance
    of an arc's end from the circle about its centre through its start is added.
    """
    is_arc = run.sweeps != 0.0
    radii = np.where(is_arc, run.radii, 1.0)
    off_circle = np.where(is_arc, np.abs(np.abs(run.ends - run.centres) - radii), 0.0)
    chord = run.ends - run.starts
    largest = 0.0
    for vertices, on_leg in zip((run.starts, run.ends), places, strict=True):
        outward = np.where(is_arc, vertices - run.centres, -1j * chord)
        local = (on_leg - vertices) * np.conj(outward / np.abs(outward))
        square = local.imag * local.imag
        across = np.where(is_arc, radii + local.real, radii)
        reach = np.hypot(across, local.imag)
        bottom = reach * (reach + across)
        with np.errstate(divide="ignore", invalid="ignore"):
            share = np.where(is_arc, 2.0 * radii * (radii + bound) / bottom, 1.0)
        share = np.where(bottom > 0.0, share, np.inf)
        largest = max(largest, float(np.max(np.where(square > 0.0, square * share, 0.0))))
    ends = float(np.max(off_circle))
    return float(np.hypot(bound, np.sqrt(largest))) + ends


def _check_turns(run: Run, least: FloatArray, most: FloatArray) -> None:
    """GeometryError unless each arc turns about its centre as far as the curve, not the long way
    round.

    `least` and `most` (n,) [rad] bound how far the curve turns. It is the sweep, except for the
    deviations of the ends and whole turns: only one such value lies between the bounds.
    """
    arcs = run.sweeps != 0.0
    sweep, least, most = np.abs(run.sweeps[arcs]), least[arcs], most[arcs]
    plausible = (least <= sweep + STEEPEST) & (most >= sweep - STEEPEST)
    single = (least > sweep - TURN + STEEPEST) & (most < sweep + TURN - STEEPEST)
    if not np.all(plausible & single):
        raise GeometryError("an arc of the contour does not run along the exact curve")
