"""Proof of a spline contour: by lines and arcs that are proved to lie much closer to it."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np

from camgeo.contour.chain import Chain, runs_of
from camgeo.contour.contour import Contour
from camgeo.contour.cubics.arc_length import ArcLength
from camgeo.contour.cubics.lines_and_arcs import ApproximatingArcs, approximating_arcs
from camgeo.contour.cubics.parts import Part
from camgeo.contour.legs import Leg
from camgeo.contour.proof.deviation import ENOUGH, deviation, proved_bound
from camgeo.contour.spline import CubicSpline, SplineContour
from camgeo.errors import GeometryError
from camgeo.numeric.arrays import FloatArray
from camgeo.outline.path import Path

SHARE = 0.01
"""Distance of the arcs from the spline, as a fraction of the deviation: a larger one lengthens the
arcs only by its cube root."""

SHARPNESS = 0.015
"""Largest fraction of the bound that the arcs may add."""

COARSE = 1e-6
"""First guess of an unknown deviation, as a fraction of the contour's reach."""

FINEST = 2.0**-52 * 64.0
"""Fraction of the reach below which closer arcs are mere rounding."""

ROUNDS = 8
"""Most refinements of the arcs; two suffice where the scale is known."""

COARSER = 8.0
"""Factor of the distance of coarser arcs, tried where finer ones cannot be measured."""

ARC_CELLS = 4
"""Cells of an arc to begin with in the proof of a fit. What is not known over a cell falls with the
cube of its width; and these arcs are short enough for a hundredth of the distance, so that cells of
the same width are a fifth as many an arc as where the arcs themselves make the distance."""

Measure = Callable[[Contour], float]


def spline_deviation(path: Path, contour: SplineContour) -> float:
    """Upper bound [mm] of the distance between `contour` and `path`, in both directions.

    Parameters
    ----------
    path : the exact path, as for `camgeo.contour.proof.deviation.deviation`.
    contour : once round the path, in either direction.

    Raises
    ------
    GeometryError
        If the contour does not follow the path once round, so that no bound can be given.
    """
    return bound_by_arcs(lambda arcs: deviation(path, arcs), contour)


def bound_by_arcs(measure: Measure, contour: SplineContour) -> float:
    """Upper bound [mm] of a distance of `contour`, if `measure` gives one of lines and arcs.

    Raises what `measure` raises for arcs of any length.
    """
    finest = FINEST * contour.reach
    share = max(SHARE * (COARSE * contour.reach), finest)
    found, failed = math.inf, None
    for _ in range(ROUNDS):
        fine = approximating_arcs(contour, share)
        try:
            reached = measure(fine.contour)
        except GeometryError as fault:
            # Fine arcs follow each bend of the spline, also those that the proof of arcs cannot
            # handle.
            failed = fault
            if found < math.inf:
                break
            share *= COARSER
            continue
        found = min(found, reached + fine.apart)
        reached = max(reached, ENOUGH)
        if fine.apart <= SHARPNESS * reached or share <= finest:
            break
        if failed is not None:
            break
        share = max(min(0.25 * share, SHARE * reached), finest)
    if found == math.inf and failed is not None:
        raise failed
    return found


def fitted_deviation(
    legs: Sequence[Leg], parts: Sequence[Part], contour: SplineContour, scale: float, enough: float
) -> float:
    """As `spline_deviation`, for a contour whose place along the path is known.

    Parameters
    ----------
    legs : of the path, in order.
    parts : (strands,) the part of the path of each strand; the contour runs in its direction.
    scale : largest distance found [mm].
    enough : a bound [mm] that need not be made sharper.

    Raises
    ------
    GeometryError
        If the contour does not follow the path once round.
    """
    fine = approximating_arcs(contour, max(SHARE * max(scale, enough), FINEST * contour.reach))
    angles = _angles(parts, contour, fine)
    arcs = fine.contour
    ends = np.cumsum(fine.counts)
    chains: list[list[Chain]] = [[] for _ in legs]
    for part, end, count in zip(parts, ends, fine.counts, strict=True):
        which = slice(int(end - count), int(end))
        chains[part.leg].append(
            Chain(angles[which], arcs.vertices[which], arcs.sweeps[which], arcs.centres[which])
        )
    runs = runs_of(
        [(leg, found or [Chain.empty()]) for leg, found in zip(legs, chains, strict=True)]
    )
    if any(np.any(np.diff(run.angles) <= 0.0) for run in runs):
        raise GeometryError("the contour does not follow the exact curve once round")
    return proved_bound(runs, ARC_CELLS, enough) + fine.apart


def _angles(parts: Sequence[Part], contour: SplineContour, fine: ApproximatingArcs) -> FloatArray:
    """(n,) parameters [rad] of the legs at the feet of the vertices of the arcs.

    A spline runs over the arc length, except for its deviation along the curve, which is as small
    as that across: one Newton step is enough, and any other place would do, see
    `camgeo.contour.proof.deviation`.
    """
    angles = np.repeat([part.begin for part in parts], fine.counts)
    low, width = [], []
    courses: dict[int, ArcLength] = {}
    for part, strand in zip(parts, contour.strands, strict=True):
        if part.course is not None:
            courses[id(part.course)] = part.course
        if isinstance(strand, CubicSpline):
            begin = 0.0 if part.course is None else part.course.s[part.piece, 0]
            low.append(begin + strand.knots[3:-4])
            width.append(np.diff(strand.knots[3:-3]))
    of_strand = np.repeat(np.arange(len(parts)), fine.counts)
    inner = fine.cubics >= 0
    inner[np.cumsum(fine.counts) - fine.counts] = False  # a strand's own start is known
    owner = np.array([id(part.course) for part in parts])[of_strand]
    piece = np.array([part.piece for part in parts])[of_strand]
    for key, course in courses.items():
        which = np.flatnonzero(inner & (owner == key))
        if not len(which):
            continue
        cubic = fine.cubics[which]
        s = np.concatenate(low)[cubic] + fine.shares[which] * np.concatenate(width)[cubic]
        found = course.angles(piece[which], s)
        points, tangents, pace = course.curve.traced(found)
        apart = (np.conj(tangents) * (fine.contour.vertices[which] - points)).real
        forward = pace > 0.0
        angles[which] = found + np.where(forward, apart, 0.0) / np.where(forward, pace, 1.0)
    return angles
