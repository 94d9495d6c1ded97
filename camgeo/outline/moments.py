"""Area and first moments of the region inside a path, by Green's theorem on its exact curves.

With z = x + i y, and the boundary run counter-clockwise,

    area = contour integral of Im(conj(z) dz) / 2,
    integral of z dA = contour integral of |z|^2 dz / (2 i).

Both follow from the complex form of Green's theorem, contour integral of f dz = 2 i times the area
integral of df/dconj(z), with f = conj(z) and f = z conj(z).
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Final

import numpy as np

from camgeo.numeric.arrays import ComplexArray, FloatArray, merged
from camgeo.numeric.quadrature import gauss
from camgeo.outline.path import Path, Pivot, Stretch

NODES: Final = 16
"""Nodes of the Gauss-Legendre rule on a part; the rule on both halves gives its error."""

MOST_PARTS: Final = 4096
"""Most parts of a stretch that are refined at a time: more are due to rounding, which halving does
not reduce. Their error then enters the estimate."""

HALVINGS: Final = 60
"""Most rounds of halving: a part is then as short as doubles resolve."""

FLAT: Final = 0.1
"""Sweep [rad] below which the series of `segment_areas` is exact to rounding."""

SHARE: Final = 1e-9
"""Tolerance of an area alone, as for `path_moments`."""

ROUNDING: Final = 8.0 * float(np.finfo(np.float64).eps)
"""Tolerance of an integral, as a fraction of the integral of the magnitude."""


@dataclass(frozen=True, slots=True)
class Moments:
    """Area and first moments of a region.

    Attributes
    ----------
    area : [mm^2], positive if the boundary runs counter-clockwise.
    first : [mm^3], integral of z dA, with the sign of `area`; first / area is the centroid.
    area_error, first_error : estimates of the absolute errors [mm^2], [mm^3].
    """

    area: float
    first: complex
    area_error: float
    first_error: float

    def scaled(self, factor: float) -> Moments:
        """All values times `factor`, e.g. -1 for a hole, or the mass per unit of area."""
        size = abs(factor)
        return Moments(
            factor * self.area,
            factor * self.first,
            size * self.area_error,
            size * self.first_error,
        )

    def counter_clockwise(self) -> Moments:
        """The moments of the same region with a counter-clockwise boundary."""
        return self if self.area >= 0.0 else self.scaled(-1.0)


def total(parts: Iterable[Moments]) -> Moments:
    """The sum of `parts`; their errors add up."""
    each = tuple(parts)
    return Moments(
        math.fsum(part.area for part in each),
        complex(
            math.fsum(part.first.real for part in each), math.fsum(part.first.imag for part in each)
        ),
        math.fsum(part.area_error for part in each),
        math.fsum(part.first_error for part in each),
    )


def path_moments(path: Path, tolerance: float) -> Moments:
    """Moments of the region inside `path`.

    Parameters
    ----------
    path : closed, and free of crossings; else each part counts as often as the path goes round it.
    tolerance : a part of a stretch is halved until that changes its integrals by less than this
        share of the integrals of the magnitude over the stretch.

    Arcs about a pivot are in closed form.
    """
    pivots = [each for each in path.pivots if each.distance != 0.0]
    return total((*(_of_stretch(each, tolerance) for each in path.stretches), _of_arcs(pivots)))


def area(path: Path) -> float:
    """Signed area [mm^2] inside `path`, positive if it runs counter-clockwise; see `SHARE`."""
    return path_moments(path, SHARE).area


def _of_arcs(pivots: list[Pivot]) -> Moments:
    return piece_moments(
        np.array([each.start for each in pivots], dtype=np.complex128),
        np.array([each.end for each in pivots], dtype=np.complex128),
        np.array([each.sweep for each in pivots], dtype=np.float64),
        np.array([each.centre for each in pivots], dtype=np.complex128),
    )


def segment_areas(chord: FloatArray, radius: FloatArray, sweep: FloatArray) -> FloatArray:
    """(n,) [mm^2] areas between arcs and their chords, with the signs of the sweeps (n,) [rad].

    r^2 (a - sin a) / 2, see `piece_moments`; of a flat arc, where this cancels and the circle is
    huge, the same over the square of its chord (n,) [mm], as a series.
    """
    square = sweep * sweep
    series = 1.0 + square * (1.0 / 30.0 + square * (1.0 / 840.0 + square / 25200.0))
    flat = chord * chord * sweep / 12.0 * series
    curved = 0.5 * radius**2 * (sweep - np.sin(sweep))
    return np.where(np.abs(sweep) < FLAT, flat, curved)


def piece_moments(
    start: ComplexArray, end: ComplexArray, sweep: FloatArray, centre: ComplexArray
) -> Moments:
    """The contributions of lines and arcs to the contour integrals, in closed form.

    Parameters
    ----------
    start, end : (n,) complex [mm].
    sweep : (n,) angle turned along each piece [rad], positive counter-clockwise; 0 is a line.
    centre : (n,) complex [mm] of each arc; unused for lines.

    The triangle of origin and chord has its centroid at a third of the sum of its corners. To that
    an arc adds the segment of the circle beyond its chord: with radius r and sweep a its area is
    r^2 (a - sin a) / 2, its first moment about the circle's centre 2/3 r^3 sin^3(a/2), in the
    direction of its middle (any table of sections, e.g. Bronshtein and Semendyayev, "Handbook of
    Mathematics", chapter on plane geometry, for the area and the distance of the centroid).
    """
    triangle = 0.5 * (np.conj(start) * end).imag
    of_triangle = triangle * (start + end) / 3.0
    arc = sweep != 0.0
    arm = np.where(arc, start - centre, 0.0)
    radius = np.abs(arm)
    segment = segment_areas(np.abs(end - start), radius, sweep)
    towards = arm * radius * radius * np.exp(0.5j * sweep) * np.sin(0.5 * sweep) ** 3
    of_segment = np.where(arc, segment * centre, 0.0) + towards * (2.0 / 3.0)
    areas = np.concatenate((triangle, segment))
    firsts = np.concatenate((of_triangle, of_segment))
    return Moments(
        math.fsum(areas),
        complex(math.fsum(firsts.real), math.fsum(firsts.imag)),
        ROUNDING * math.fsum(np.abs(areas)),
        ROUNDING * math.fsum(np.abs(firsts)),
    )


def _of_stretch(stretch: Stretch, tolerance: float) -> Moments:
    """The contour integrals along the stretch, by quadrature."""
    edges = merged(stretch.marks)
    low, high = edges[:-1], edges[1:]
    area, first, area_sizes, first_sizes = _gauss(stretch, low, high)
    area_scale, first_scale = float(np.sum(area_sizes)), float(np.sum(first_sizes))
    span = stretch.end - stretch.start
    found = [Moments(0.0, 0j, ROUNDING * area_scale, ROUNDING * first_scale)]
    for halving in range(HALVINGS):
        if not len(low):
            break
        middle = 0.5 * (low + high)
        lows, highs = np.concatenate((low, middle)), np.concatenate((middle, high))
        areas, firsts, area_sizes, first_sizes = _gauss(stretch, lows, highs)
        count = len(low)
        finer_area = areas[:count] + areas[count:]
        finer_first = firsts[:count] + firsts[count:]
        area_change, first_change = np.abs(finer_area - area), np.abs(finer_first - first)
        allowed = max(tolerance, ROUNDING) * (high - low) / span
        done = (area_change <= allowed * area_scale) & (first_change <= allowed * first_scale)
        done |= 2 * np.count_nonzero(~done) > MOST_PARTS or halving == HALVINGS - 1
        found.append(
            _sum(finer_area[done], finer_first[done], area_change[done], first_change[done])
        )
        left = np.concatenate((~done, ~done))
        low, high, area, first = lows[left], highs[left], areas[left], firsts[left]
    return total(found)


def _sum(area: FloatArray, first: ComplexArray, wrong: FloatArray, off: FloatArray) -> Moments:
    moment = complex(math.fsum(first.real), math.fsum(first.imag))
    return Moments(math.fsum(area), moment, math.fsum(wrong), math.fsum(off))


def _gauss(
    stretch: Stretch, low: FloatArray, high: FloatArray
) -> tuple[FloatArray, ComplexArray, FloatArray, FloatArray]:
    """Contributions (m,) to area and first moment over [low, high] (m,), and of the magnitudes."""
    phi, half, weights = gauss(low, high, NODES)
    point, tangent, pace = stretch.curve.traced(phi.ravel())
    way = tangent * pace
    across = 0.5 * (np.conj(point) * way).imag.reshape(phi.shape)
    square = (point * np.conj(point)).real
    moment = (-0.5j * square * way).reshape(phi.shape)
    return (
        half * (across @ weights),
        half * (moment @ weights),
        half * (np.abs(across) @ weights),
        half * (np.abs(moment) @ weights),
    )
