"""Which place of a path a vertex of a contour belongs to: its foot point on the exact curve."""

from __future__ import annotations

from typing import Protocol

import numpy as np

from camgeo.contour.chain import Run
from camgeo.contour.contour import Contour
from camgeo.contour.legs import Leg, StretchLeg, legs_of
from camgeo.errors import GeometryError
from camgeo.motion.motion import Side
from camgeo.numeric.arrays import ComplexArray, FloatArray, IntArray
from camgeo.outline.path import Path
from camgeo.units import TURN

SAMPLES = 4096
"""Points of a leg from which the search for foot points starts."""

STEPS = 30
"""Newton steps at most; from a good start four do."""


class HasFeet(Protocol):
    """A curve over a parameter: a leg, or a parallel over the cam angle."""

    def point(self, t: FloatArray, side: Side = "right") -> ComplexArray: ...

    def tangent(self, t: FloatArray, side: Side = "right") -> ComplexArray: ...

    def pace(self, t: FloatArray) -> FloatArray: ...


def foot_points(curve: HasFeet, points: ComplexArray, guess: FloatArray) -> FloatArray:
    """Parameters (n,) [rad] of the feet of perpendiculars from `points` (n,) near `guess` (n,).

    Where the curve does not go forwards at its present place a search stops.
    """
    t = guess
    for _ in range(STEPS):
        tangent = curve.tangent(t)
        ahead = points - curve.point(t)
        along = ahead.real * tangent.real + ahead.imag * tangent.imag
        pace = curve.pace(t)
        forward = pace > 0.0
        step = np.where(forward, along, 0.0) / np.where(forward, pace, 1.0)
        step = np.clip(step, -0.2, 0.2)
        t = t + step
        if np.max(np.abs(step), initial=0.0) < 1e-15 * TURN:
            break
    return t


def locate(path: Path, contour: Contour) -> tuple[Run, ...]:
    """Run `contour` the way of `path`, cut it where legs meet, and find the feet of its vertices.

    A vertex belongs to each corner of the path and to each end of an arc: the nearest one.

    Raises
    ------
    GeometryError
        If the contour does not follow the path once round.
    """
    legs = legs_of(path)
    courses = [_samples(leg) for leg in legs]
    course = np.concatenate([points[:-1] for points in courses])
    area = 0.5 * float(np.sum((np.conj(course) * np.roll(course, -1)).imag))
    if area * contour.area < 0.0:
        contour = contour.reversed()
    if legs[0].closed:
        return (_closed_run(legs[0], courses[0], contour),)
    corners = np.array([_first(leg) for leg in legs])
    nearest = np.array([int(np.argmin(np.abs(contour.vertices - corner))) for corner in corners])
    contour = _rolled(contour, int(nearest[0]))
    counts = _counts(legs, nearest, len(contour))
    stops = np.cumsum(counts)
    return tuple(
        _open_run(leg, points, contour, int(stop - count), int(stop))
        for leg, points, count, stop in zip(legs, courses, counts, stops, strict=True)
    )


def _samples(leg: Leg) -> ComplexArray:
    grid = np.linspace(leg.start, leg.end, SAMPLES + 1)
    return np.append(leg.point(grid[:-1]), leg.point(grid[-1:], "left"))


def _first(leg: Leg) -> complex:
    if leg.first is not None:
        return leg.first
    return complex(leg.point(np.array([leg.start]))[0])


def _rolled(contour: Contour, first: int) -> Contour:
    return Contour(
        np.roll(contour.vertices, -first),
        np.roll(contour.sweeps, -first),
        np.roll(contour.centres, -first),
    )


def _counts(legs: tuple[Leg, ...], nearest: IntArray, pieces: int) -> IntArray:
    """Number of pieces along each leg, of `pieces`; none along one too short to have its own."""
    counts: IntArray = (np.roll(nearest, -1) - nearest) % pieces
    if not np.any(counts):
        stretches = [k for k, leg in enumerate(legs) if isinstance(leg, StretchLeg)]
        if len(stretches) == 1:
            counts[stretches[0]] = pieces
    if int(np.sum(counts)) != pieces:
        raise GeometryError("the contour does not follow the exact outline from corner to corner")
    return counts


def _open_run(leg: Leg, points: ComplexArray, contour: Contour, start: int, stop: int) -> Run:
    """The run of the pieces `start` to `stop` along a leg of which `points` are samples."""
    vertices = np.append(contour.vertices, contour.vertices[0])[start : stop + 1]
    along_contour = np.concatenate(([0.0], np.cumsum(contour.lengths[start:stop])))
    angles = np.full(len(vertices), leg.end)
    if stop > start:
        grid = np.linspace(leg.start, leg.end, SAMPLES + 1)
        along_leg = np.concatenate(([0.0], np.cumsum(np.abs(np.diff(points)))))
        place = along_contour * (along_leg[-1] / along_contour[-1])
        angles[0] = leg.start
        guess = np.interp(place[1:-1], along_leg, grid)
        angles[1:-1] = foot_points(leg, vertices[1:-1], guess)
        if np.any(np.diff(angles) <= 0.0):
            raise GeometryError("the contour does not follow the exact curve once round")
    return Run(leg, angles, vertices, contour.sweeps[start:stop], contour.centres[start:stop])


def _closed_run(leg: Leg, points: ComplexArray, contour: Contour) -> Run:
    """The run of a contour without corners, along a leg of which `points` are samples."""
    grid = np.linspace(leg.start, leg.end, SAMPLES + 1)
    first = int(np.argmin(np.abs(points - contour.vertices[0])))
    along_curve = np.concatenate(([0.0], np.cumsum(np.abs(np.diff(points)))))
    along_contour = np.concatenate(([0.0], np.cumsum(contour.lengths)))
    share = along_contour[:-1] / along_contour[-1]
    place = along_curve[first] + share * along_curve[-1]
    turns, rest = np.divmod(place, along_curve[-1])
    guess = np.interp(rest, along_curve, grid) + TURN * turns
    phi = foot_points(leg, contour.vertices, guess)
    if np.any(np.diff(phi) <= 0.0) or phi[-1] - phi[0] >= TURN:
        raise GeometryError("the contour does not follow the exact curve once round")
    phi = phi - TURN * np.floor(phi[0] / TURN)
    vertices = np.append(contour.vertices, contour.vertices[0])
    return Run(leg, np.append(phi, phi[0] + TURN), vertices, contour.sweeps, contour.centres)
