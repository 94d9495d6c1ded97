"""The exact outlines that a file is compared with, and the joints of what is compared."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from camgeo.contour.contour import Contour
from camgeo.contour.spline import Arc, CubicSpline, SplineContour
from camgeo.numeric.arrays import ComplexArray, FloatArray
from camgeo.outline.moments import area as area_of_path
from camgeo.outline.path import Path
from camgeo.part.boundaries import CurveBoundary, ExactBoundary
from camgeo.part.part import Boundary
from camgeo.printing.scaled import ScaledBoundary

LOOSE = 1e-3
"""Tolerance of an outline's coarse polygon, as a fraction of its extent; it gives sizes, and
lengths for limits."""

FLAT = 1e-5
"""Kinks of an outline of lines and arcs up to this angle [rad] are not corners: those from rounding
are far smaller, those of an intended corner far larger."""


@dataclass(frozen=True, slots=True, eq=False)
class Shape:
    """One exact outline.

    Attributes
    ----------
    name : of the boundary or the operation.
    deviation : proved bound [mm] on a contour's distance from it; raises GeometryError if the
        contour does not follow it.
    polygon : straight pieces within a tolerance [mm] of it.
    corners : (k,) complex [mm].
    length : [mm], to within the fraction `LOOSE` of the extent.
    area : [mm^2]; None where it is not known exactly.
    """

    name: str
    deviation: Callable[[Contour | SplineContour], float]
    polygon: Callable[[float], Contour]
    corners: ComplexArray
    length: float
    area: float | None


def shapes_of(boundaries: tuple[Boundary, ...], extent: float, tolerance: float) -> list[Shape]:
    """The shapes of a part's boundaries.

    Parameters
    ----------
    extent : size of the part [mm], for limits.
    tolerance : of the files [mm]; shorter arcs of an outline count as corners.
    """
    return [_shape(boundary, LOOSE * extent, tolerance) for boundary in boundaries]


def _shape(boundary: Boundary, loose: float, tolerance: float) -> Shape:
    if isinstance(boundary, ScaledBoundary):
        return _scaled(boundary, loose, tolerance)

    def polygon(within: float) -> Contour:
        return boundary.polyline(within, "fast").contour

    length = polygon(loose).length
    if isinstance(boundary, CurveBoundary):
        corners = corners_of_path(boundary.path, tolerance)
        area: float | None = abs(area_of_path(boundary.path))
    else:
        exact = isinstance(boundary, ExactBoundary)
        contour = boundary.arcs(tolerance, "fast").contour
        corners = corners_of_contour(contour)
        area = abs(contour.area) if exact else None
    return Shape(boundary.name, boundary.deviation, polygon, corners, length, area)


def _scaled(boundary: ScaledBoundary, loose: float, tolerance: float) -> Shape:
    own, by = _shape(boundary.unscaled, loose / boundary.factor, tolerance), boundary.factor
    return replace(
        own,
        deviation=boundary.deviation,
        polygon=lambda within: boundary.polyline(within, "fast").contour,
        corners=own.corners * by,
        length=own.length * by,
        area=None if own.area is None else own.area * by**2,
    )


def corners_of_path(path: Path, tolerance: float) -> ComplexArray:
    """(k,) complex [mm] corners of `path`, and the ends of its arcs shorter than `tolerance`."""
    slight = [each for each in path.pivots if abs(each.distance * each.sweep) <= tolerance]
    points = [point for each in slight for point in (each.start, each.end)]
    return np.array(points, dtype=np.complex128)


def corners_of_contour(contour: Contour) -> ComplexArray:
    """(k,) complex [mm] vertices at which a contour of tangent pieces still has a kink."""
    joints = joints_of(contour)
    corners: ComplexArray = joints.places[joints.kinks > FLAT]
    return corners


@dataclass(frozen=True, slots=True, eq=False)
class Joints:
    """The joints of a contour; joint k is where piece k begins.

    Attributes
    ----------
    places : (n,) complex [mm].
    kinks : (n,) [rad] angle between the pieces on both sides, from 0.
    before, after : (n,) [mm] lengths of the pieces on both sides.
    """

    places: ComplexArray
    kinks: FloatArray
    before: FloatArray
    after: FloatArray


def joints_of(contour: Contour | SplineContour) -> Joints:
    """The joints of `contour`; each cubic of a spline counts as a piece, as a file's splines need
    not be smooth inside.
    """
    if isinstance(contour, Contour):
        return _of_pieces(contour)
    parts = [_of_strand(strand) for strand in contour.strands]
    places, starts, ends, lengths = (np.concatenate([part[k] for part in parts]) for k in range(4))
    return _joints(places, starts, ends, lengths.real)


def _of_pieces(contour: Contour) -> Joints:
    chords = contour.ends - contour.vertices
    turning = 1j * np.sign(contour.sweeps)
    arcs = contour.sweeps != 0.0
    starts = np.where(arcs, (contour.vertices - contour.centres) * turning, chords)
    ends = np.where(arcs, (contour.ends - contour.centres) * turning, chords)
    return _joints(contour.vertices, starts, ends, contour.lengths)


def _joints(
    places: ComplexArray, starts: ComplexArray, ends: ComplexArray, lengths: FloatArray
) -> Joints:
    """From the directions of the pieces at their starts and ends, of any length."""
    kinks = np.abs(np.angle(starts * np.conj(np.roll(ends, 1))))
    return Joints(places, kinks, np.roll(lengths, 1), lengths)


def _of_strand(strand: CubicSpline | Arc) -> tuple[ComplexArray, ...]:
    """Starts of its pieces, their directions at start and end, and their lengths."""
    if isinstance(strand, CubicSpline):
        pieces = strand.beziers
        first, last = pieces[:, :1], pieces[:, 3:]
        starts = _first_leg(pieces[:, 1:] - first)
        ends = _first_leg(last - pieces[:, 2::-1])
        return pieces[:, 0], starts, ends, np.abs(np.diff(pieces, axis=1)).sum(axis=1) + 0j
    starts, ends = (np.array([strand.heading(end)]) for end in (strand.start, strand.end))
    return np.array([strand.start]), starts, ends, np.array([strand.length + 0j])


def _first_leg(legs: ComplexArray) -> ComplexArray:
    """(n,) the first of `legs` (n, 3) that is not 0: control points may coincide."""
    index = np.argmax(legs != 0.0, axis=1)
    leg: ComplexArray = np.take_along_axis(legs, index[:, None], axis=1)[:, 0]
    return leg
