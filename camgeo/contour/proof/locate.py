"""The place of a path for a vertex of a contour: the one across from it on the curve."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from camgeo.contour.chain import Run
from camgeo.contour.contour import Contour
from camgeo.contour.legs import Leg, StretchLeg, legs_of
from camgeo.errors import GeometryError
from camgeo.numeric.arrays import ComplexArray, FloatArray, IntArray, grouped
from camgeo.outline.path import Path
from camgeo.units import TURN

SAMPLES = 4096
"""Samples of a leg from which the search for places starts."""

A_FORMULA = 64
"""Least number of samples between two borders: a whole steep move may lie within a degree."""

STEPS = 30
"""Most Newton steps; from a good start three suffice."""

SMALL = 1e-9
"""A step [rad] below this is the last one: the remaining error is its square."""

ASKEW = 0.5
"""Least cosine of the angle between a vertex's direction and the leg for it to count."""


def _places(leg: Leg, points: ComplexArray, ahead: ComplexArray, guess: FloatArray) -> FloatArray:
    """Parameters (n,) [rad] of the places of `leg` next to `points` (n,), near `guess` (n,).

    The place lies square to the direction `ahead` (n,) of the contour, which leaves the proof no
    gap along it; where that is too oblique, it is the foot of the perpendicular. A search stops
    where the leg does not move forward.
    """
    t = guess
    for _ in range(STEPS):
        at, tangent, pace = leg.traced(t)
        cosine = ahead.real * tangent.real + ahead.imag * tangent.imag
        along = np.where(cosine >= ASKEW, ahead, tangent)
        apart = points - at
        forward = pace > 0.0
        way = apart.real * along.real + apart.imag * along.imag
        rate = np.where(cosine >= ASKEW, cosine, 1.0) * pace
        step = np.where(forward, way, 0.0) / np.where(forward, rate, 1.0)
        step = np.clip(step, -0.2, 0.2)
        t = t + step
        if np.max(np.abs(step), initial=0.0) < SMALL:
            break
    return t


def _directions(vertices: ComplexArray, contour: Contour) -> ComplexArray:
    """(n - 1,) unit directions at the inner ones of `vertices` (n,), the ends of the pieces of an
    open `contour`: half way between those of the two pieces.
    """
    chord = vertices[1:] - vertices[:-1]
    chord = np.where(chord == 0.0, 1.0, chord)
    turned = np.exp(0.5j * contour.sweeps)
    arriving, leaving = (chord * turned)[:-1], (chord * np.conj(turned))[1:]
    both = arriving / np.abs(arriving) + leaving / np.abs(leaving)
    size = np.abs(both)
    directions: ComplexArray = np.where(size > 0.0, both / np.where(size > 0.0, size, 1.0), 0.0)
    return directions


def locate(path: Path, contour: Contour) -> tuple[Run, ...]:
    """Orient `contour` as `path`, cut it where legs meet, and find the places of its vertices.

    A vertex belongs to each corner of the path and to each end of an arc: the nearest one.

    Raises
    ------
    GeometryError
        If the contour does not follow the path once round.
    """
    legs = legs_of(path)
    samples = [_samples(leg) for leg in legs]
    points = np.concatenate([each.points[:-1] for each in samples])
    area = 0.5 * float(np.sum((np.conj(points) * np.roll(points, -1)).imag))
    if area * contour.area < 0.0:
        contour = contour.reversed()
    if legs[0].closed:
        return (_closed_run(legs[0], samples[0], contour),)
    corners = np.array([_first(leg) for leg in legs])
    nearest = np.array([int(np.argmin(np.abs(contour.vertices - corner))) for corner in corners])
    contour = contour.rolled(int(nearest[0]))
    counts = _counts(legs, nearest, len(contour))
    stops = np.cumsum(counts)
    return tuple(
        _open_run(leg, sampled, contour, int(stop - count), int(stop))
        for leg, sampled, count, stop in zip(legs, samples, counts, stops, strict=True)
    )


@dataclass(frozen=True, slots=True, eq=False)
class _Samples:
    """Samples of a leg: parameters (n,) [rad], points (n,) [mm] and arc lengths (n,) [mm]."""

    grid: FloatArray
    points: ComplexArray
    along: FloatArray

    def at(self, along: FloatArray) -> FloatArray:
        """Parameters near the places that are `along` (n,) [mm] of the leg from its start."""
        return np.interp(along, self.along, self.grid)


def _samples(leg: Leg) -> _Samples:
    inner = leg.borders[(leg.borders > leg.start) & (leg.borders < leg.end)]
    ends = np.concatenate(([leg.start], inner, [leg.end]))
    spans = np.diff(ends)
    parts = np.maximum(A_FORMULA, np.ceil(SAMPLES * spans / (leg.end - leg.start))).astype(int)
    span, part = grouped(parts)
    inside = ends[:-1][span] + (spans / parts)[span] * part
    grid = np.append(inside, leg.end)
    points = np.append(leg.point(inside), leg.point(grid[-1:], "left"))
    along = np.concatenate(([0.0], np.cumsum(np.abs(np.diff(points)))))
    return _Samples(grid, points, along)


def _first(leg: Leg) -> complex:
    if leg.first is not None:
        return leg.first
    return complex(leg.point(np.array([leg.start]))[0])


def _counts(legs: tuple[Leg, ...], nearest: IntArray, pieces: int) -> IntArray:
    """Number of pieces along each leg, of `pieces`; none along a leg too short to have its own."""
    counts: IntArray = (np.roll(nearest, -1) - nearest) % pieces
    if not np.any(counts):
        stretches = [k for k, leg in enumerate(legs) if isinstance(leg, StretchLeg)]
        if len(stretches) == 1:
            counts[stretches[0]] = pieces
    if int(np.sum(counts)) != pieces:
        raise GeometryError("the contour does not follow the exact outline from corner to corner")
    return counts


def _open_run(leg: Leg, sampled: _Samples, contour: Contour, start: int, stop: int) -> Run:
    """The run of the pieces `start` to `stop` along a leg."""
    vertices = np.append(contour.vertices, contour.vertices[0])[start : stop + 1]
    along_contour = np.concatenate(([0.0], np.cumsum(contour.lengths[start:stop])))
    angles = np.full(len(vertices), leg.end)
    if stop > start:
        place = along_contour * (sampled.along[-1] / along_contour[-1])
        angles[0] = leg.start
        guess = sampled.at(place[1:-1])
        pieces = Contour(
            contour.vertices[start:stop], contour.sweeps[start:stop], contour.centres[start:stop]
        )
        ahead = _directions(vertices, pieces)
        angles[1:-1] = _places(leg, vertices[1:-1], ahead, guess)
        if np.any(np.diff(angles) <= 0.0):
            raise GeometryError("the contour does not follow the exact curve once round")
    return Run(leg, angles, vertices, contour.sweeps[start:stop], contour.centres[start:stop])


def _closed_run(leg: Leg, sampled: _Samples, contour: Contour) -> Run:
    """The run of a contour without corners, along a closed leg."""
    first = int(np.argmin(np.abs(sampled.points - contour.vertices[0])))
    along_contour = np.concatenate(([0.0], np.cumsum(contour.lengths)))
    share = along_contour[:-1] / along_contour[-1]
    place = sampled.along[first] + share * sampled.along[-1]
    turns, rest = np.divmod(place, sampled.along[-1])
    guess = sampled.at(rest) + TURN * turns
    around = Contour(
        np.append(contour.vertices[-1], contour.vertices),
        np.append(contour.sweeps[-1], contour.sweeps),
        np.append(contour.centres[-1], contour.centres),
    )
    ahead = _directions(np.append(around.vertices, contour.vertices[0]), around)
    phi = _places(leg, contour.vertices, ahead, guess)
    if np.any(np.diff(phi) <= 0.0) or phi[-1] - phi[0] >= TURN:
        raise GeometryError("the contour does not follow the exact curve once round")
    phi = phi - TURN * np.floor(phi[0] / TURN)
    phi = phi - TURN if phi[0] >= TURN else phi  # a tiny negative angle rounds to a full turn
    vertices = np.append(contour.vertices, contour.vertices[0])
    return Run(leg, np.append(phi, phi[0] + TURN), vertices, contour.sweeps, contour.centres)
