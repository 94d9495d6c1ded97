"""Joints of a closed contour: where they are, and by how much the direction turns there."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from camgeo.contour.contour import Contour
from camgeo.contour.spline import Arc, CubicSpline, SplineContour
from camgeo.numeric.arrays import ComplexArray, FloatArray


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
